//! What the verbs share in warning of their results.

use crate::{terminal, terminal::warn};
use undrift::{
    findings::{self, Finding},
    results::Outages,
};

/// Warns of models that could not be run, and of results that cannot be trusted.
pub fn print_troubles(result: &Outages) {
    let names = result.order.iter();
    let doubtful =
        names.filter_map(|name| Some((name, result.models.get(name)?.warning.as_ref()?)));
    for (name, why) in result.failed.iter().chain(doubtful) {
        terminal::doubt();
        warn(format!("{name}: {why}"));
    }
}

/// Notes whether a result can be trusted.
pub fn judge(found: &[Finding]) {
    if findings::is_doubtful(found) {
        terminal::doubt();
    }
}
