//! What the verbs share in telling their results.

use crate::{output, style, terminal, terminal::warn};
use anyhow::{Context, Result};
use std::path::Path;
use undrift::{
    findings::{self, Finding},
    io::write,
    outages::{ModelRun, Outcome},
    replay::ReplayError,
    table::outage_table,
};
use undrift_report::say;

/// The runs that ended with a result, and the others' names and errors.
pub fn split(results: &[Outcome]) -> (Vec<&ModelRun>, Vec<(&str, &ReplayError)>) {
    let mut runs = Vec::new();
    let mut failed = Vec::new();
    for (name, result) in results {
        match result {
            Ok(run) => runs.push(run),
            Err(error) => failed.push((name.as_str(), error)),
        }
    }
    (runs, failed)
}

/// The table of the runs for the terminal.
pub fn shown(runs: &[&ModelRun]) -> String {
    style::tables(&table(runs), ERRORS)
}

/// Columns of the table.
const ERRORS: usize = 9;

/// The table of the runs.
fn table(runs: &[&ModelRun]) -> String {
    let rows: Vec<_> = runs.iter().map(|r| (r.name.clone(), &r.errors)).collect();
    outage_table(&rows)
}

/// Tells which models could not be run.
pub fn print_failed(failed: &[(&str, &ReplayError)]) {
    for (name, error) in failed {
        terminal::doubt();
        warn(format!("{name}: {error}"));
    }
}

/// Warns of results that cannot be trusted.
pub fn print_warnings(runs: &[&ModelRun]) {
    for run in runs {
        if let Some(finding) = &run.errors.finding {
            terminal::doubt();
            warn(format!("{}: {}", run.name, say::say(finding)));
        }
    }
}

/// Notes whether a result can be trusted.
pub fn judge(found: &[Finding]) {
    if findings::is_doubtful(found) {
        terminal::doubt();
    }
}

/// Writes a file whole or not at all.
pub fn write_whole(path: &Path, text: &str) -> Result<()> {
    output::spares_input(path)?;
    write::write_whole(path, text).with_context(|| format!("cannot write {}", path.display()))
}
