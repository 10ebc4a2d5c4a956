//! The solution as KF-GINS writes it, `writeNavResult` of its `src/kf_gins.cpp`: week, second of the
//! week \[s\], latitude, longitude \[deg\], height \[m\], velocity north, east, down [m/s], roll, pitch, yaw
//! \[deg\], between spaces, no header.

use std::io::{self, Write};

use super::block::Block;
use super::solution::SolutionRow;
use super::text::write_turn;
use super::thinning::Thinning;
use super::{SolutionOptions, write_fixed};
use crate::time::WEEK;

/// Writes rows as KF-GINS does. Without a week the first column is 0, as KF-GINS itself has it, and
/// the second the time as it is.
#[derive(Debug)]
pub struct KfGinsWriter<W: Write> {
    block: Block<W>,
    week: Option<u32>,
    thinning: Thinning,
}

impl<W: Write> KfGinsWriter<W> {
    pub(super) fn new(out: W, options: &SolutionOptions) -> Self {
        Self {
            block: Block::new(out),
            week: options.week,
            thinning: Thinning::new(options.every.unwrap_or(0.0)),
        }
    }

    pub(super) fn write(&mut self, row: &SolutionRow) -> io::Result<()> {
        let (p, v, a) = (&row.position, &row.v_n, &row.rpy);
        let finite = row.has_position() && v.iter().chain(a.iter()).all(|x| x.is_finite());
        if !finite || !self.thinning.takes(row.time) {
            return Ok(());
        }
        let (week, second) = match self.week {
            Some(week) => {
                let weeks = (row.time / WEEK).floor();
                (f64::from(week) + weeks, row.time - weeks * WEEK)
            }
            None => (0.0, row.time),
        };
        let deg = f64::to_degrees;
        let buf = &mut self.block.bytes;
        // A micrometre in 1e-11 deg, a microsecond in the time.
        for (value, decimals) in [
            (week, 0),
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
        self.block.spill()
    }

    pub(super) fn into_inner(self) -> io::Result<W> {
        self.block.into_inner()
    }
}
