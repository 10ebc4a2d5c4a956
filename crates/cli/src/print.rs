//! What the verbs share in telling their results.

use crate::{style, terminal, terminal::warn};
use undrift::{
    findings::{self, Finding},
    results::Outages,
};
use undrift_report::text::outage_table;

/// The table of an experiment's models for the terminal.
pub fn shown(result: &Outages, names: &[impl AsRef<str>]) -> String {
    style::tables(&outage_table(&result.models, names), ERRORS)
}

/// Columns of the table.
const ERRORS: usize = 9;

/// Tells which models could not be run, and which results cannot be trusted.
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
