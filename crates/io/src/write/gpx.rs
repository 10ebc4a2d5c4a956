//! The track as GPX 1.1: one segment, times in UTC where the GPS week is known, and the kind of fix,
//! `none` without GNSS. Elevations are heights above the ellipsoid.

use std::io::{self, Write};

use super::block::Block;
use super::solution::SolutionRow;
use super::text::{map_degrees, xml};
use super::thinning::Thinning;
use super::{SolutionOptions, write_fixed};
use crate::time;

/// Writes rows as GPX.
#[derive(Debug)]
pub struct GpxWriter<W: Write> {
    block: Block<W>,
    week: Option<u32>,
    thinning: Thinning,
}

impl<W: Write> GpxWriter<W> {
    pub(super) fn new(out: W, options: &SolutionOptions, every: f64) -> Self {
        let mut block = Block::new(out);
        let head = format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gpx version=\"1.1\" creator=\"undrift\" xmlns=\"http://www.topografix.com/GPX/1/1\">\n<trk><name>{}</name><trkseg>\n",
            xml(&options.name)
        );
        block.bytes.extend_from_slice(head.as_bytes());
        Self {
            block,
            week: options.week,
            thinning: Thinning::new(every),
        }
    }

    pub(super) fn write(&mut self, row: &SolutionRow, outage: bool) -> io::Result<()> {
        if !row.has_position() || !self.thinning.takes(row.time) {
            return Ok(());
        }
        let [lat, lon] = map_degrees(&row.position);
        let buf = &mut self.block.bytes;
        buf.extend_from_slice(b"<trkpt lat=\"");
        write_fixed(buf, lat, 9);
        buf.extend_from_slice(b"\" lon=\"");
        write_fixed(buf, lon, 9);
        buf.extend_from_slice(b"\"><ele>");
        write_fixed(buf, row.position.height, 3);
        buf.extend_from_slice(b"</ele>");
        if let Some(utc) = self.week.and_then(|week| time::utc(week, row.time)) {
            buf.extend_from_slice(format!("<time>{}</time>", utc.iso()).as_bytes());
        }
        let fix: &[u8] = if outage { b"none" } else { b"3d" };
        buf.extend_from_slice(b"<fix>");
        buf.extend_from_slice(fix);
        buf.extend_from_slice(b"</fix></trkpt>\n");
        self.block.spill()
    }

    pub(super) fn into_inner(mut self) -> io::Result<W> {
        self.block
            .bytes
            .extend_from_slice(b"</trkseg></trk>\n</gpx>\n");
        self.block.into_inner()
    }
}
