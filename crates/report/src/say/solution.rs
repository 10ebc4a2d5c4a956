//! Sentences: how the solution went.

use super::words::{at, many};
use undrift_events::{RestartCause, WindowPart};
use undrift_results::{
    findings::{self, Finding, NoError, Severity},
    usability::Usability,
};

/// The same of a drive by poses or by fixes.
pub fn verdict_of(found: &[Finding], posed: bool) -> String {
    super::words::worded(verdict(found), posed)
}

/// Whether the result can be used, and why not: the first line of what is shown.
pub fn verdict(found: &[Finding]) -> String {
    let (severity, cause) = findings::verdict(found);
    let word = usable(severity);
    match cause {
        Some(cause) => format!("{word}: {}{}", super::say(cause), worst(found, cause)),
        None => word.into(),
    }
}

/// Where it shows most, of a cause that does not say so and is not wrong everywhere.
fn worst(found: &[Finding], cause: &Finding) -> String {
    found
        .iter()
        .filter(|of| *of != cause)
        .find_map(|of| match of {
            Finding::Disagreement { start, end, .. } if of.severity() < Severity::Unusable => {
                Some(format!(" (worst from {} to {} s)", at(*start), at(*end)))
            }
            _ => None,
        })
        .unwrap_or_default()
}

/// How much of the log the solution knows at each instant.
pub fn hindsight(look_ahead: bool, smooth: bool) -> &'static str {
    match (look_ahead, smooth) {
        (_, true) => "smoothed: each instant also uses the fixes after it",
        (true, false) => {
            "look-ahead: the errors of all fixes were studied before the first one was used"
        }
        (false, false) => "causal: each instant uses only what came before it, as while driving",
    }
}

/// The word that a verdict begins with.
pub(crate) fn usable(severity: Severity) -> &'static str {
    Usability::from(severity).name()
}

/// That the solution ended at this time \[s\], and the likeliest cause.
pub fn ended(time: f64, found: &[Finding]) -> String {
    let ended = diverged(time);
    match findings::verdict(found).1 {
        None | Some(Finding::Diverged { .. }) => ended,
        Some(cause) => format!("{ended}: {}", super::say(cause)),
    }
}

pub(super) fn diverged(time: f64) -> String {
    format!("the solution diverged at {} s and ends there", at(time))
}

pub(super) fn covers_part(of: [f64; 2], log: [f64; 2]) -> String {
    let [from, to, first, last] = [of[0], of[1], log[0], log[1]].map(at);
    format!("the solution covers {from}-{to} s only, of a log from {first} to {last} s")
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
    let solution = started.map_or("no solution".into(), |started| {
        format!("solution {}-{} s", at(started), at(ended))
    });
    format!(
        "no errors against the truth: {why} (truth {}-{} s, {solution}); check the time columns, or set truth.time_offset",
        at(truth[0]),
        at(truth[1])
    )
}

pub(super) fn bridged(gaps: u64) -> String {
    format!("bridged {} between samples", many(gaps, "short gap"))
}

pub(super) fn long_gaps(gaps: u64, first: f64, longest: f64) -> String {
    let first = at(first);
    let gaps = match gaps {
        1 => format!("no samples for {longest:.1} s from {first} s"),
        n => {
            format!("{n} gaps without samples, the first at {first} s, the longest {longest:.1} s")
        }
    };
    format!("IMU log: {gaps}; do not trust the solution there, or leave it out with [span]")
}

pub(super) fn without_gnss(start: f64, length: f64) -> String {
    format!(
        "longest span without a usable fix: {length:.1} s from {} s",
        at(start)
    )
}

pub(super) fn ends_early(end: f64, missing: f64) -> String {
    format!(
        "IMU log: ends at {} s, {missing:.0} s before the last fix: it may be cut short",
        at(end)
    )
}

pub(super) fn restart(time: f64, why: RestartCause, resumed: Option<f64>) -> String {
    format!(
        "discarded the solution at {} s: {}; {}",
        at(time),
        cause(why),
        match resumed {
            Some(time) => format!("re-initialised at {} s", at(time)),
            None => "could not be re-initialised".into(),
        }
    )
}

pub(super) fn large_innovations(start: f64) -> String {
    format!(
        "innovations far exceed their predicted size from {start:.1} s on: the solution diverges from the fixes, or the noise model or the stated GNSS accuracy is wrong"
    )
}

/// A part of the fixes in the plural.
fn parts(part: WindowPart) -> &'static str {
    match part {
        WindowPart::Position => "positions",
        WindowPart::Height => "heights",
        WindowPart::Velocity => "velocities",
    }
}

pub(super) fn disagreement(
    part: WindowPart,
    [start, end]: [f64; 2],
    [inside, rms]: [f64; 2],
    more: u64,
) -> String {
    let further = match more {
        0 => String::new(),
        _ => format!("; {} more", many(more, "such span")),
    };
    format!(
        "from {} to {} s the solution and the {} of the fixes disagree: {:.0} % of the innovations are inside three standard deviations, they are {rms:.1} standard deviations large{further}",
        at(start),
        at(end),
        parts(part),
        100.0 * inside,
    )
}

pub(super) fn started_late(time: f64) -> String {
    format!(
        "navigation started at {time:.1} s, after the first outage began: start the outages later"
    )
}

pub(super) fn no_reference(outages: usize) -> String {
    format!(
        "{} without reference samples",
        many(outages as u64, "outage")
    )
}

/// Why a solution was given up.
pub fn cause(cause: RestartCause) -> &'static str {
    match cause {
        RestartCause::Impossible => "position, velocity or covariance out of range",
        RestartCause::NoSamples => "no inertial samples for more than a minute",
        RestartCause::LargeInnovations => {
            "the innovations far exceeded their predicted size for half a minute"
        }
        RestartCause::WrongHeading => {
            "motion shows another heading than the magnetometer at the start"
        }
        RestartCause::RejectedThenAccepted => "it repeatedly rejected fixes and then accepted them",
    }
}
