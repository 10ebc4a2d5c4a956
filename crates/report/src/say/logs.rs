//! Sentences: what was found of the logs.

use super::words::{at, many};
use crate::numbers::short;
use undrift_results::findings::{Finding, Log};

/// A finding of one log.
pub(super) fn sentence(log: Log, finding: &Finding) -> String {
    use Finding as F;
    let name = log.name();
    match finding {
        F::Skipped { kinds, .. } => format!("{name} log: {}", kinds.replace('\n', "; ")),
        F::OutOfOrder { rows, line, .. } => format!(
            "{name} log: {rows} rows are out of time order, first at line {line}; sort the file by time"
        ),
        F::SharedStamps { rows, interval, .. } => {
            let stamps = if (interval - 1.0).abs() < 1e-6 {
                "time stamps are whole seconds".to_owned()
            } else {
                format!("time stamps are {} s apart", short(*interval))
            };
            let rate = match log {
                Log::Imu => {
                    ", or set imu.shared_stamps = \"spread\", or imu.rate instead of imu.time"
                }
                _ => "",
            };
            format!(
                "{name} log: {stamps} and {rows} rows repeat one: export times with more decimals{rate}"
            )
        }
        F::SetBack { line, step, .. } => format!(
            "{name} log: the clock steps back by {step:.3} s at row {line}, so all later rows are stamped early: add {step:.3} s to their times"
        ),
        F::Gaps {
            gaps,
            start,
            length,
            ..
        } => format!(
            "{name} log: {}, the longest {length:.3} s from {} s",
            many(*gaps, "gap"),
            at(*start)
        ),
        F::Unused { .. } => format!(
            "{name} log: no record was used; compare its times with the IMU's, or set {name}.time_offset"
        ),
        F::Outliers {
            rejected, weakened, ..
        } => format!(
            "{name}: rejected {} and down-weighted {weakened}, all far from the prediction",
            many(*rejected, "measurement")
        ),
        other => unreachable!("not one of a log: {other:?}"),
    }
}

pub(super) fn uneven(gaps: usize, jitter_rms: f64, interval: f64) -> String {
    format!(
        "time stamps are unevenly spaced ({}, jitter {:.2} ms RMS at an interval of {:.2} ms); they are treated as evenly spaced",
        many(gaps as u64, "gap"),
        jitter_rms * 1e3,
        interval * 1e3
    )
}
