//! The solution as a smoothed best estimate of trajectory (SBET): records of 17 doubles, the lowest
//! byte first.
//!
//! Second of the GPS week in which the solution starts (of the log's own clock where it has no date), latitude, longitude \[rad\], height \[m\], velocity north, east, down [m/s], roll, pitch,
//! platform heading \[rad\], wander angle 0, so that the heading is the yaw; body accelerations and rates 0, since
//! the solution has none.

use std::io;

use super::solution::SolutionRow;
use super::text_writer::{Beside, Body, TextFormat};

pub(super) fn format() -> TextFormat {
    TextFormat {
        head: String::new(),
        body: Body::Rows(SolutionRow::is_whole, write_row),
        tail: "",
    }
}

fn write_row(buf: &mut Vec<u8>, row: &SolutionRow, beside: &Beside) -> io::Result<()> {
    let (_, second) = beside
        .epoch
        .map_or((0, beside.start), |epoch| epoch.week_second(beside.start));
    let time = second + (row.time - beside.start);
    let (p, v, a) = (&row.position, &row.v_n, &row.rpy);
    let heading = a.z.rem_euclid(std::f64::consts::TAU);
    let state = [
        time, p.lat, p.lon, p.height, v.x, v.y, v.z, a.x, a.y, heading,
    ];
    for value in state.into_iter().chain([0.0; 7]) {
        buf.extend_from_slice(&value.to_le_bytes());
    }
    Ok(())
}
