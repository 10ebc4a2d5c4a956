//! The solution as NMEA 0183: RMC, GGA, GST and HDT of every epoch.
//!
//! Heights are above the ellipsoid: GGA has them as its altitude with a geoid separation of 0, so that
//! their sum is right. Without GNSS the quality is 6 and the mode E, estimated. Where the log has no date it
//! is empty and the time of day that of the row, no leap seconds taken off.

use std::io::{self, Write};

use super::solution::SolutionRow;
use super::text::write_turn;
use super::text_writer::{Beside, Body, TextFormat};
use crate::time;

/// Knots of one m/s.
const KNOTS: f64 = 3600.0 / 1852.0;
/// Ten-millionths of a minute of arc in a degree: the last digit is 0.2 mm.
const UNITS: u64 = 600_000_000;

pub(super) fn format() -> TextFormat {
    TextFormat {
        head: String::new(),
        body: Body::Rows(SolutionRow::has_position, write_epoch),
        tail: "",
    }
}

fn write_epoch(buf: &mut Vec<u8>, row: &SolutionRow, beside: &Beside) -> io::Result<()> {
    let utc = beside.epoch.map(|epoch| epoch.utc(row.time));
    let Some(clock) = utc.or_else(|| time::time_of_clock(row.time)) else {
        return Ok(());
    };
    let [hour, minute, milli] = clock.hms();
    let (second, milli) = (milli / 1000, milli % 1000);
    let time = format!("{hour:02}{minute:02}{second:02}.{milli:03}");
    let (lat, lon) = (row.position.lat, row.position.lon);
    let place = format!("{},{}", arc(lat, 2, ["N", "S"]), arc(lon, 3, ["E", "W"]));
    // How many satellites there are is not known: a position takes four, without which gpsd and others take none.
    let (mode, quality, satellites) = if beside.outage {
        ("E", 6, "00")
    } else {
        ("A", 1, "04")
    };

    let speed = row.v_n.x.hypot(row.v_n.y);
    let motion = if speed.is_finite() {
        let course = turn(row.v_n.y.atan2(row.v_n.x), 2);
        format!("{:.3},{course}", speed * KNOTS)
    } else {
        ",".to_owned()
    };
    let date = utc.map_or(String::new(), |utc| {
        let [year, month, day] = utc.date();
        format!("{day:02}{month:02}{:02}", year.rem_euclid(100))
    });
    sentence(
        buf,
        &format!("GNRMC,{time},A,{place},{motion},{date},,,{mode}"),
    )?;
    let height = row.position.height;
    sentence(
        buf,
        &format!("GNGGA,{time},{place},{quality},{satellites},,{height:.3},M,0.0,M,,"),
    )?;
    let [north, east, down, ..] = row.nav_std;
    if [north, east, down].iter().all(|std| std.is_finite()) {
        let stds = format!("{north:.3},{east:.3},{down:.3}");
        sentence(buf, &format!("GNGST,{time},,,,,{stds}"))?;
    }
    if row.rpy.z.is_finite() {
        sentence(buf, &format!("GNHDT,{},T", turn(row.rpy.z, 3)))?;
    }
    Ok(())
}

/// An angle \[rad\] in degrees and minutes, and the letter of its sign: `dddmm.mmmmmmm,E`.
fn arc(angle: f64, width: usize, [positive, negative]: [&str; 2]) -> String {
    let units = (angle.abs().to_degrees() * UNITS as f64).round() as u64;
    let (degrees, rest) = (units / UNITS, units % UNITS);
    let (minutes, fraction) = (rest / 10_000_000, rest % 10_000_000);
    let letter = if angle < 0.0 { negative } else { positive };
    format!("{degrees:0width$}{minutes:02}.{fraction:07},{letter}")
}

/// An angle \[rad\] as degrees in [0, 360).
fn turn(angle: f64, decimals: usize) -> String {
    let mut text = Vec::new();
    write_turn(&mut text, angle.to_degrees(), decimals);
    String::from_utf8_lossy(&text).into_owned()
}

/// A sentence with its checksum, the exclusive or of what is between `$` and `*`.
fn sentence(buf: &mut Vec<u8>, body: &str) -> io::Result<()> {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    write!(buf, "${body}*{sum:02X}\r\n")
}
