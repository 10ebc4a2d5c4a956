//! The track as GPX 1.1: one segment, times in UTC where the log has a date, and the kind of fix,
//! `none` without GNSS. Elevations are heights above the ellipsoid.

use std::io::{self, Write};

use super::solution::SolutionRow;
use super::text::{map_degrees, xml};
use super::text_writer::{Beside, Body, TextFormat};

pub(super) fn format(name: &str) -> TextFormat {
    TextFormat {
        head: format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gpx version=\"1.1\" creator=\"undrift\" xmlns=\"http://www.topografix.com/GPX/1/1\">\n<trk><name>{}</name><trkseg>\n",
            xml(name)
        ),
        body: Body::Rows(SolutionRow::has_position, write_point),
        tail: "</trkseg></trk>\n</gpx>\n",
    }
}

fn write_point(buf: &mut Vec<u8>, row: &SolutionRow, beside: &Beside) -> io::Result<()> {
    let [lat, lon] = map_degrees(&row.position);
    let ele = row.position.height;
    write!(
        buf,
        "<trkpt lat=\"{lat:.9}\" lon=\"{lon:.9}\"><ele>{ele:.3}</ele>"
    )?;
    if let Some(epoch) = beside.epoch {
        write!(buf, "<time>{}</time>", epoch.iso(row.time))?;
    }
    let fix = if beside.outage { "none" } else { "3d" };
    writeln!(buf, "<fix>{fix}</fix></trkpt>")
}
