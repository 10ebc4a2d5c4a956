//! Sentences: what was found of the logs.

use super::words::{at, many};
use undrift::findings::{Finding, Log};

/// The sentence of a finding of these.
pub(super) fn say(finding: &Finding) -> Option<String> {
    Some(match finding {
        Finding::Skipped { log, kinds, .. } => {
            format!("{} log: {}", name(*log), kinds.replace('\n', "; "))
        }
        Finding::Gaps {
            log,
            gaps,
            start,
            length,
        } => format!(
            "{} log: {}, the longest {length:.3} s from {} s",
            name(*log),
            many(*gaps, "gap"),
            at(*start)
        ),
        Finding::Unused { log } => format!(
            "{0} log: nothing of it was used; compare its times with the IMU's, {0}.time_offset moves them",
            name(*log)
        ),
        Finding::Outliers {
            log,
            rejected,
            weakened,
        } => format!(
            "{}: rejected {}, used {weakened} with less weight, all far from the prediction",
            name(*log),
            many(*rejected, "measurement")
        ),
        Finding::Uneven {
            gaps,
            jitter_rms,
            interval,
        } => format!(
            "the time stamps are not evenly spaced: {}, jitter {:.2} ms RMS of {:.2} ms; the recording is used as if they were",
            many(*gaps as u64, "gap"),
            jitter_rms * 1e3,
            interval * 1e3
        ),
        _ => return None,
    })
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
