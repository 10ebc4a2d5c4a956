//! The track as KML 2.2: a line for each span with and without GNSS, in green and red; where the log has a
//! date a `gx:Track`, each place behind its instant in UTC.
//!
//! Lines lie on the ground, since KML counts absolute altitudes from the sea level and the heights
//! here are above the ellipsoid; the coordinates have them nevertheless.

use std::io::{self, Write};

use super::solution::SolutionRow;
use super::spans::Piece;
use super::text::{place, xml};
use super::text_writer::{Body, TextFormat};
use crate::epoch::Epoch;

pub(super) fn format(name: &str) -> TextFormat {
    let mut head = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\" xmlns:gx=\"http://www.google.com/kml/ext/2.2\">\n<Document>\n<name>{}</name>\n",
        xml(name)
    );
    // Colours are alpha, blue, green, red.
    for (id, colour) in [("gnss", "ff2ca02c"), ("no-gnss", "ff2827d6")] {
        head += &format!(
            "<Style id=\"{id}\"><LineStyle><color>{colour}</color><width>4</width></LineStyle></Style>\n"
        );
    }
    TextFormat {
        head,
        body: Body::Lines(write_piece),
        tail: "</Document>\n</kml>\n",
    }
}

fn write_piece(buf: &mut Vec<u8>, piece: Piece<'_>, epoch: Option<Epoch>) -> io::Result<()> {
    match (piece, epoch) {
        (Piece::Begin { row, outage, .. }, epoch) => {
            let (name, style) = match outage {
                true => ("Without GNSS", "no-gnss"),
                false => ("With GNSS", "gnss"),
            };
            writeln!(
                buf,
                "<Placemark><name>{name} from {:.1} s</name><styleUrl>#{style}</styleUrl>",
                row.time
            )?;
            match epoch {
                Some(epoch) => {
                    writeln!(buf, "<gx:Track>")?;
                    write_instant(buf, row, epoch)
                }
                None => write!(
                    buf,
                    "<LineString><tessellate>1</tessellate><coordinates>\n{}",
                    place(&row.position)
                ),
            }
        }
        (Piece::Point(row), Some(epoch)) => write_instant(buf, row, epoch),
        (Piece::Point(row), None) => write!(buf, "\n{}", place(&row.position)),
        (Piece::End { .. }, Some(_)) => writeln!(buf, "</gx:Track></Placemark>"),
        (Piece::End { .. }, None) => writeln!(buf, "\n</coordinates></LineString></Placemark>"),
    }
}

/// A place of a track and when that was.
fn write_instant(buf: &mut Vec<u8>, row: &SolutionRow, epoch: Epoch) -> io::Result<()> {
    let place = place(&row.position).replace(',', " ");
    let when = epoch.iso(row.time);
    writeln!(buf, "<when>{when}</when><gx:coord>{place}</gx:coord>")
}
