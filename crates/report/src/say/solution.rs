//! Sentences: how the solution went.

use super::words::{at, many};
use undrift::{
    findings::{Finding, NoError},
    replay::RestartCause,
};

/// The sentence of a finding of these.
pub(super) fn say(finding: &Finding) -> Option<String> {
    Some(match finding {
        Finding::Diverged { time } => {
            format!("the solution diverged at {} s and ends there", at(*time))
        }
        Finding::NotCompared {
            why,
            truth,
            started,
            ended,
        } => {
            let why = match why {
                NoError::NoOverlap => "the truth does not overlap the solution",
                NoError::TooSparse => {
                    "the truth has no two samples within 2 s of each other during the solution"
                }
            };
            let started = started.map_or("nowhere".into(), at);
            format!(
                "no error against the truth: {why}; the truth runs from {} to {} s, the solution from {started} to {} s; compare the time columns, truth.time_offset moves one",
                at(truth[0]),
                at(truth[1]),
                at(*ended)
            )
        }
        Finding::Bridged { gaps } => {
            format!("bridged {} between samples", many(*gaps, "short gap"))
        }
        Finding::LongGaps {
            gaps,
            first,
            longest,
        } => format!(
            "{} between samples, the first at {} s, the longest {longest:.3} s; the covariance grew over each of up to a minute",
            many(*gaps, "long gap"),
            at(*first)
        ),
        Finding::WithoutGnss { start, length } => format!(
            "longest span without a usable fix: {length:.1} s from {} s",
            at(*start)
        ),
        Finding::Restart { time, why, resumed } => format!(
            "gave up the solution at {} s: {}; {}",
            at(*time),
            cause(*why),
            match resumed {
                Some(time) => format!("re-initialised at {} s", at(*time)),
                None => "it could not be re-initialised".into(),
            }
        ),
        Finding::LargeInnovations { start } => format!(
            "the innovations from {start:.1} s on are far beyond their predicted size: the solution diverges from the fixes, or the noise model or the stated GNSS accuracy is wrong"
        ),
        Finding::StartedLate { time } => format!(
            "navigation began at {time:.1} s, after the start of the first outage; begin the outages later"
        ),
        Finding::NoReference { outages } => {
            format!(
                "{} without a reference inside",
                many(*outages as u64, "outage")
            )
        }
        _ => return None,
    })
}

/// Why a solution was given up.
pub fn cause(cause: RestartCause) -> &'static str {
    match cause {
        RestartCause::Impossible => "position, velocity or covariance left the possible range",
        RestartCause::NoSamples => "no inertial samples for more than a minute",
        RestartCause::LargeInnovations => {
            "the innovations were far beyond their predicted size for half a minute"
        }
        RestartCause::GaveWayOften => "it rejected fixes and then accepted them again and again",
    }
}
