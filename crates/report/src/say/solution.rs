//! Sentences: how the solution went.

use super::words::{at, many};
use undrift::{
    findings::{self, Finding, NoError, Severity},
    replay::RestartCause,
};

/// Whether the result can be used, and why not: the first line of what is shown.
pub fn verdict(found: &[Finding]) -> String {
    let (severity, cause) = findings::verdict(found);
    let word = match severity {
        Severity::Note => "usable",
        Severity::Warning => "usable with care",
        Severity::Unusable => "not usable",
    };
    match cause {
        Some(cause) => format!("{word}: {}", super::say(cause)),
        None => word.into(),
    }
}

pub(super) fn diverged(time: f64) -> String {
    format!("the solution diverged at {} s and ends there", at(time))
}

pub(super) fn not_compared(
    why: NoError,
    truth: [f64; 2],
    started: Option<f64>,
    ended: f64,
) -> String {
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
        at(ended)
    )
}

pub(super) fn bridged(gaps: u64) -> String {
    format!("bridged {} between samples", many(gaps, "short gap"))
}

pub(super) fn long_gaps(gaps: u64, first: f64, longest: f64) -> String {
    format!(
        "{} between samples, the first at {} s, the longest {longest:.3} s; the covariance grew over each of up to a minute",
        many(gaps, "long gap"),
        at(first)
    )
}

pub(super) fn without_gnss(start: f64, length: f64) -> String {
    format!(
        "longest span without a usable fix: {length:.1} s from {} s",
        at(start)
    )
}

pub(super) fn restart(time: f64, why: RestartCause, resumed: Option<f64>) -> String {
    format!(
        "gave up the solution at {} s: {}; {}",
        at(time),
        cause(why),
        match resumed {
            Some(time) => format!("re-initialised at {} s", at(time)),
            None => "it could not be re-initialised".into(),
        }
    )
}

pub(super) fn large_innovations(start: f64) -> String {
    format!(
        "the innovations from {start:.1} s on are far beyond their predicted size: the solution diverges from the fixes, or the noise model or the stated GNSS accuracy is wrong"
    )
}

pub(super) fn started_late(time: f64) -> String {
    format!(
        "navigation began at {time:.1} s, after the start of the first outage; begin the outages later"
    )
}

pub(super) fn no_reference(outages: usize) -> String {
    format!(
        "{} without a reference inside",
        many(outages as u64, "outage")
    )
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
