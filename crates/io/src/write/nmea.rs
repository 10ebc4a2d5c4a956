//! The solution as NMEA 0183: RMC, GGA, GST and HDT of every epoch.
//!
//! Heights are above the ellipsoid: GGA has them as its altitude with a geoid separation of 0, so that
//! their sum is right. Without GNSS the quality is 6 and the mode E, estimated. Without a GPS week the
//! date is empty and the time of day that of the row, no leap seconds taken off.

use std::io::{self, Write};

use super::block::Block;
use super::solution::SolutionRow;
use super::text::write_turn;
use super::thinning::Thinning;
use super::{SolutionOptions, write_fixed};
use crate::time::{self, Utc};

/// Knots of one m/s.
const KNOTS: f64 = 3600.0 / 1852.0;
/// Ten-millionths of a minute of arc in a degree: the last digit is 0.2 mm.
const UNITS: u64 = 600_000_000;

/// Writes rows as NMEA sentences.
#[derive(Debug)]
pub struct NmeaWriter<W: Write> {
    block: Block<W>,
    week: Option<u32>,
    thinning: Thinning,
}

impl<W: Write> NmeaWriter<W> {
    pub(super) fn new(out: W, options: &SolutionOptions, every: f64) -> Self {
        Self {
            block: Block::new(out),
            week: options.week,
            thinning: Thinning::new(every),
        }
    }

    pub(super) fn write(&mut self, row: &SolutionRow, outage: bool) -> io::Result<()> {
        if !row.has_position() || !self.thinning.takes(row.time) {
            return Ok(());
        }
        let utc = self.week.and_then(|week| time::utc(week, row.time));
        let Some(clock) = utc.or_else(|| time::time_of_clock(row.time)) else {
            return Ok(());
        };
        let place = Place::new(row, &clock);
        let buf = &mut self.block.bytes;
        sentence(buf, b"GNRMC", |buf| place.rmc(buf, utc.as_ref(), outage));
        sentence(buf, b"GNGGA", |buf| place.gga(buf, outage));
        if row.nav_std[..3].iter().all(|std| std.is_finite()) {
            sentence(buf, b"GNGST", |buf| place.gst(buf));
        }
        if row.rpy.z.is_finite() {
            sentence(buf, b"GNHDT", |buf| place.hdt(buf));
        }
        self.block.spill()
    }

    pub(super) fn into_inner(self) -> io::Result<W> {
        self.block.into_inner()
    }
}

/// One epoch.
struct Place<'a> {
    row: &'a SolutionRow,
    /// `hhmmss.sss`
    time: String,
    /// `ddmm.mmmmmmm,N,dddmm.mmmmmmm,E`
    position: String,
}

impl<'a> Place<'a> {
    fn new(row: &'a SolutionRow, clock: &Utc) -> Self {
        let [hour, minute, milli] = clock.hms();
        let (lat, south) = arc(row.position.lat);
        let (lon, west) = arc(row.position.lon);
        let position = format!(
            "{:02}{:02}.{:07},{},{:03}{:02}.{:07},{}",
            lat[0],
            lat[1],
            lat[2],
            if south { 'S' } else { 'N' },
            lon[0],
            lon[1],
            lon[2],
            if west { 'W' } else { 'E' },
        );
        let time = format!(
            "{hour:02}{minute:02}{:02}.{:03}",
            milli / 1000,
            milli % 1000
        );
        Self {
            row,
            time,
            position,
        }
    }

    fn rmc(&self, buf: &mut Vec<u8>, date: Option<&Utc>, outage: bool) {
        put(buf, &format!("{},A,{},", self.time, self.position));
        let v = &self.row.v_n;
        let speed = v.x.hypot(v.y);
        if speed.is_finite() {
            write_fixed(buf, speed * KNOTS, 3);
            buf.push(b',');
            write_turn(buf, v.y.atan2(v.x).to_degrees(), 2);
        } else {
            buf.push(b',');
        }
        buf.push(b',');
        if let Some(date) = date {
            let [year, month, day] = date.date();
            put(
                buf,
                &format!("{day:02}{month:02}{:02}", year.rem_euclid(100)),
            );
        }
        put(buf, if outage { ",,,E" } else { ",,,A" });
    }

    fn gga(&self, buf: &mut Vec<u8>, outage: bool) {
        let quality = if outage { 6 } else { 1 };
        put(
            buf,
            &format!("{},{},{quality},,,", self.time, self.position),
        );
        write_fixed(buf, self.row.position.height, 3);
        put(buf, ",M,0.0,M,,");
    }

    fn gst(&self, buf: &mut Vec<u8>) {
        put(buf, &format!("{},,,,", self.time));
        for std in &self.row.nav_std[..3] {
            buf.push(b',');
            write_fixed(buf, *std, 3);
        }
    }

    fn hdt(&self, buf: &mut Vec<u8>) {
        write_turn(buf, self.row.rpy.z.to_degrees(), 3);
        put(buf, ",T");
    }
}

/// Degrees, minutes and ten-millionths of a minute of an angle \[rad\], and whether it is negative.
fn arc(angle: f64) -> ([u64; 3], bool) {
    let units = (angle.abs().to_degrees() * UNITS as f64).round() as u64;
    let (degrees, rest) = (units / UNITS, units % UNITS);
    ([degrees, rest / 10_000_000, rest % 10_000_000], angle < 0.0)
}

fn put(buf: &mut Vec<u8>, text: &str) {
    buf.extend_from_slice(text.as_bytes());
}

/// A sentence with its checksum, the exclusive or of what is between `$` and `*`.
fn sentence(buf: &mut Vec<u8>, kind: &[u8], fields: impl FnOnce(&mut Vec<u8>)) {
    buf.push(b'$');
    let from = buf.len();
    buf.extend_from_slice(kind);
    buf.push(b',');
    fields(buf);
    let sum = buf[from..].iter().fold(0, |sum, byte| sum ^ byte);
    put(buf, &format!("*{sum:02X}\r\n"));
}
