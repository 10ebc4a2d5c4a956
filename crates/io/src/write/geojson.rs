//! The track as GeoJSON, RFC 7946: a `LineString` of longitude, latitude and height above the
//! ellipsoid for each span with and without GNSS, which the property `gnss` distinguishes, and its start and end in UTC where the log has a date;
//! after it the [ellipses](super::ellipses) as polygons with time and standard deviations.

use std::io::{self, Write};

use super::spans::Piece;
use super::text::place;
use super::text_writer::{Aside, Body, TextFormat};

pub(super) fn format(name: &str) -> TextFormat {
    TextFormat {
        head: format!(
            "{{\"type\":\"FeatureCollection\",\"name\":{},\"features\":[",
            serde_json::Value::from(name)
        ),
        body: Body::Lines(write_piece),
        tail: "\n]}\n",
    }
}

fn write_piece(buf: &mut Vec<u8>, piece: Piece<'_>, aside: &mut Aside) -> io::Result<()> {
    match piece {
        Piece::Begin { row, first, .. } => write!(
            buf,
            "{}\n{{\"type\":\"Feature\",\"geometry\":{{\"type\":\"LineString\",\"coordinates\":[\n[{}]",
            if first { "" } else { "," },
            place(&row.position)
        ),
        Piece::Point(row) => write!(buf, ",\n[{}]", place(&row.position)),
        Piece::End { start, end, outage } => {
            write!(
                buf,
                "\n]}},\"properties\":{{\"gnss\":{},\"start_s\":{start:.3},\"end_s\":{end:.3}",
                !outage
            )?;
            if let Some(epoch) = aside.epoch {
                let [start, end] = [start, end].map(|time| epoch.iso(time));
                write!(buf, ",\"start\":\"{start}\",\"end\":\"{end}\"")?;
            }
            write!(buf, "}}}}")?;
            for (row, polygon) in aside.ellipses.end() {
                let corners = polygon.iter().map(|corner| format!("[{}]", place(corner)));
                let corners = corners.collect::<Vec<_>>().join(",");
                write!(
                    buf,
                    ",\n{{\"type\":\"Feature\",\"geometry\":{{\"type\":\"Polygon\",\"coordinates\":[[{corners}]]}},\"properties\":{{\"gnss\":{},\"time_s\":{:.3},\"north_std_m\":{:.3},\"east_std_m\":{:.3}}}}}",
                    !outage, row.time, row.nav_std[0], row.nav_std[1]
                )?;
            }
            Ok(())
        }
    }
}
