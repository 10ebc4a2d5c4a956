//! Sentences: what was found of the logs.

use super::words::{at, many};
use crate::numbers::short;
use undrift::findings::Log;

pub(super) fn skipped(log: Log, kinds: &str) -> String {
    format!("{} log: {}", name(log), kinds.replace('\n', "; "))
}

pub(super) fn out_of_order(log: Log, rows: u64, line: u64) -> String {
    format!(
        "{} log: {rows} rows are out of time order, first at line {line}; sort the file by time",
        name(log)
    )
}

/// Rows that share a stamp, at the usual interval of the stamps \[s\].
pub(super) fn shared_stamps(log: Log, rows: u64, interval: f64) -> String {
    let stamps = if (interval - 1.0).abs() < 1e-6 {
        "time stamps are whole seconds".to_owned()
    } else {
        format!("time stamps are {} s apart", short(interval))
    };
    let rate = match log {
        Log::Imu => ", or set imu.rate instead of imu.time",
        _ => "",
    };
    format!(
        "{} log: {stamps} and {rows} rows repeat one: export times with more decimals{rate}",
        name(log)
    )
}

pub(super) fn set_back(log: Log, line: u64, step: f64) -> String {
    format!(
        "{} log: the clock steps back by {step:.3} s at row {line}, so all later rows are stamped early: add {step:.3} s to their times",
        name(log)
    )
}

pub(super) fn gaps(log: Log, gaps: u64, start: f64, length: f64) -> String {
    format!(
        "{} log: {}, the longest {length:.3} s from {} s",
        name(log),
        many(gaps, "gap"),
        at(start)
    )
}

pub(super) fn unused(log: Log) -> String {
    format!(
        "{0} log: no record was used; compare its times with the IMU's, or set {0}.time_offset",
        name(log)
    )
}

pub(super) fn outliers(log: Log, rejected: u64, weakened: u64) -> String {
    format!(
        "{}: rejected {} and down-weighted {weakened}, all far from the prediction",
        name(log),
        many(rejected, "measurement")
    )
}

pub(super) fn uneven(gaps: usize, jitter_rms: f64, interval: f64) -> String {
    format!(
        "time stamps are unevenly spaced ({}, jitter {:.2} ms RMS at an interval of {:.2} ms); they are treated as evenly spaced",
        many(gaps as u64, "gap"),
        jitter_rms * 1e3,
        interval * 1e3
    )
}

fn name(log: Log) -> &'static str {
    match log {
        Log::Imu => "IMU",
        Log::Gnss => "GNSS",
        Log::Truth => "truth",
        Log::Odometer => "odometer",
        Log::Barometer => "barometer",
        Log::Recording => "recording",
    }
}
