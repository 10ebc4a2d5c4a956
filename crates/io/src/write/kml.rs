//! The track as KML 2.2: a line for each span with and without GNSS, in green and red; where the log has a
//! date a `gx:MultiTrack`, with the instants in UTC. [Ellipses](super::ellipses) are of the same colours.
//!
//! Lines lie on the ground, since KML counts absolute altitudes from the sea level and the heights
//! here are above the ellipsoid; the coordinates have them nevertheless.

use std::io::{self, Write};

use super::solution::SolutionRow;
use super::spans::Piece;
use super::text::{place, xml};
use super::text_writer::{Aside, Body, TextFormat};
use crate::epoch::Epoch;

/// Points of a track, whose places are held until its instants are written; the next one joins it.
const TRACK: usize = 1000;

pub(super) fn format(name: &str) -> TextFormat {
    let mut head = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\" xmlns:gx=\"http://www.google.com/kml/ext/2.2\">\n<Document>\n<name>{}</name>\n",
        xml(name)
    );
    // Colours are alpha, blue, green, red.
    for (id, colour) in [("gnss", "ff2ca02c"), ("no-gnss", "ff2827d6")] {
        head += &format!(
            "<Style id=\"{id}\"><LineStyle><color>{colour}</color><width>4</width></LineStyle><PolyStyle><color>40{}</color></PolyStyle></Style>\n",
            &colour[2..]
        );
    }
    TextFormat {
        head,
        body: Body::Lines(write_piece),
        tail: "</Document>\n</kml>\n",
    }
}

fn write_piece(buf: &mut Vec<u8>, piece: Piece<'_>, aside: &mut Aside) -> io::Result<()> {
    match (piece, aside.epoch) {
        (Piece::Begin { row, outage, .. }, epoch) => {
            let (name, style) = named(outage);
            writeln!(
                buf,
                "<Placemark><name>{name} from {:.1} s</name><styleUrl>#{style}</styleUrl>",
                row.time
            )?;
            let Some(epoch) = epoch else {
                let place = place(&row.position);
                return write!(
                    buf,
                    "<LineString><tessellate>1</tessellate><coordinates>\n{place}"
                );
            };
            write!(
                buf,
                "<gx:MultiTrack><gx:interpolate>1</gx:interpolate><gx:Track>"
            )?;
            write_instant(buf, row, epoch, aside)
        }
        (Piece::Point(row), Some(epoch)) => {
            if aside.points >= TRACK {
                end_track(buf, aside);
                buf.extend_from_slice(b"<gx:Track>");
            }
            write_instant(buf, row, epoch, aside)
        }
        (Piece::Point(row), None) => write!(buf, "\n{}", place(&row.position)),
        (Piece::End { outage, .. }, Some(_)) => {
            end_track(buf, aside);
            writeln!(buf, "</gx:MultiTrack></Placemark>")?;
            write_ellipses(buf, outage, aside)
        }
        (Piece::End { outage, .. }, None) => {
            writeln!(buf, "\n</coordinates></LineString></Placemark>")?;
            write_ellipses(buf, outage, aside)
        }
    }
}

/// What a span is called, and its style.
fn named(outage: bool) -> (&'static str, &'static str) {
    match outage {
        true => ("Without GNSS", "no-gnss"),
        false => ("With GNSS", "gnss"),
    }
}

/// The ellipses of a span that has ended.
fn write_ellipses(buf: &mut Vec<u8>, outage: bool, aside: &mut Aside) -> io::Result<()> {
    let (_, style) = named(outage);
    for (row, polygon) in aside.ellipses.end() {
        let [north, east] = [row.nav_std[0], row.nav_std[1]];
        let corners = polygon.iter().map(place).collect::<Vec<_>>().join(" ");
        writeln!(
            buf,
            "<Placemark><name>95 % at {:.1} s: 1σ north {north:.3} m, east {east:.3} m</name><styleUrl>#{style}</styleUrl><Polygon><outerBoundaryIs><LinearRing><coordinates>{corners}</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>",
            row.time
        )?;
    }
    Ok(())
}

/// An instant of a track, and its place for behind all of them.
fn write_instant(
    buf: &mut Vec<u8>,
    row: &SolutionRow,
    epoch: Epoch,
    aside: &mut Aside,
) -> io::Result<()> {
    aside.points += 1;
    let place = place(&row.position).replace(',', " ");
    write!(aside.later, "\n<gx:coord>{place}</gx:coord>")?;
    write!(buf, "\n<when>{}</when>", epoch.iso(row.time))
}

fn end_track(buf: &mut Vec<u8>, aside: &mut Aside) {
    buf.append(&mut aside.later);
    aside.points = 0;
    buf.extend_from_slice(b"\n</gx:Track>");
}
