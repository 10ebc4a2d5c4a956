//! The solution as KF-GINS writes it, `writeNavResult` of its `src/kf_gins.cpp`: week, second of the
//! week \[s\], latitude, longitude \[deg\], height \[m\], velocity north, east, down [m/s], roll, pitch, yaw
//! \[deg\], between spaces, no header.
//!
//! Without a date the first column is 0, as KF-GINS itself writes, and the second the time of the log.

use std::io;

use super::solution::SolutionRow;
use super::text::write_turn;
use super::text_writer::{Beside, Body, TextFormat};
use super::write_fixed;

pub(super) fn format() -> TextFormat {
    TextFormat {
        head: String::new(),
        body: Body::Rows(SolutionRow::is_whole, write_row),
        tail: "",
    }
}

fn write_row(buf: &mut Vec<u8>, row: &SolutionRow, beside: &Beside) -> io::Result<()> {
    let dated = beside.epoch.map(|epoch| epoch.week_second(row.time));
    let (week, second) = dated.unwrap_or((0, row.time));
    let (p, v, a) = (&row.position, &row.v_n, &row.rpy);
    let deg = f64::to_degrees;
    // A micrometre in 1e-11 deg, a microsecond in the time.
    for (value, decimals) in [
        (week as f64, 0),
        (second, 6),
        (deg(p.lat), 11),
        (deg(p.lon), 11),
        (p.height, 4),
        (v.x, 5),
        (v.y, 5),
        (v.z, 5),
        (deg(a.x), 8),
        (deg(a.y), 8),
    ] {
        write_fixed(buf, value, decimals);
        buf.push(b' ');
    }
    write_turn(buf, deg(a.z), 8);
    buf.push(b'\n');
    Ok(())
}
