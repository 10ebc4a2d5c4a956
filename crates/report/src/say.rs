//! Sentences of findings: one place for terminal, report and Python.
//!
//! A sentence begins with a small letter and has no full stop, so that it can stand after a name.

mod fill;
mod fixes;
mod logs;
mod sensors;
mod solution;
mod start;
mod words;

pub use fill::{WHITE_CALIBRATED, all, cut, demo, navigated, outcome};
pub use solution::cause;
pub use start::{alignment, mounting, unsolved};

use undrift::findings::Finding;

/// The sentence of a finding.
pub fn say(finding: &Finding) -> String {
    let sentence = solution::say(finding).or_else(|| sensors::say(finding));
    let sentence = sentence.or_else(|| fixes::say(finding));
    let sentence = sentence.or_else(|| logs::say(finding));
    sentence.unwrap_or_else(|| format!("{finding:?}"))
}

#[cfg(test)]
mod tests;
