//! The track as KML 2.2: a line for each span with and without GNSS, in green and red.
//!
//! Lines lie on the ground, since KML counts absolute altitudes from the sea level and the heights
//! here are above the ellipsoid; the coordinates have them nevertheless.

use std::io::{self, Write};

use super::spans::Piece;
use super::text::{place, xml};
use super::text_writer::{Body, TextFormat};

pub(super) fn format(name: &str) -> TextFormat {
    let mut head = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\">\n<Document>\n<name>{}</name>\n",
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

fn write_piece(buf: &mut Vec<u8>, piece: Piece<'_>) -> io::Result<()> {
    match piece {
        Piece::Begin { row, outage, .. } => {
            let (name, style) = match outage {
                true => ("Without GNSS", "no-gnss"),
                false => ("With GNSS", "gnss"),
            };
            write!(
                buf,
                "<Placemark><name>{name} from {:.1} s</name><styleUrl>#{style}</styleUrl>\n<LineString><tessellate>1</tessellate><coordinates>\n{}",
                row.time,
                place(&row.position)
            )
        }
        Piece::Point(row) => write!(buf, "\n{}", place(&row.position)),
        Piece::End { .. } => writeln!(buf, "\n</coordinates></LineString></Placemark>"),
    }
}
