//! Results with their sentences.

use super::{alignment, all, found, mounting, say};
use undrift_engine::{Summary, mounting::Mounting};
use undrift_results as results;

/// A navigated drive with its sentences: `summary` is the navigator's, `ahead` the mounting that was estimated before.
pub fn navigated(
    mut result: results::Navigate,
    summary: &Summary,
    ahead: Option<&Mounting>,
) -> results::Navigate {
    result.warnings = all(&result.findings);
    result.mounting = found(&summary.mountings).or(ahead.map(mounting));
    let start = summary.alignment.as_ref();
    result.summary.alignment = start.map_or(String::new(), alignment);
    result
}

/// An experiment with outages.
pub fn cut(mut result: results::Outages) -> results::Outages {
    result.warnings = all(&result.findings);
    for errors in result.models.values_mut() {
        errors.warning = errors.finding.as_ref().map(say);
    }
    result
}
