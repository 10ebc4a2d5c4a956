//! What the verbs share in telling their results.

use crate::{output, style, terminal, terminal::warn};
use anyhow::{Context, Result};
use std::path::Path;
use undrift::{
    io::write,
    outages::{ModelRun, Outcome},
    replay::{Implausible, ReplayError, Summary},
    table::outage_table,
};

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

/// Tells which results cannot be trusted.
pub fn print_warnings(runs: &[&ModelRun]) {
    for run in runs {
        if let Some(warning) = &run.errors.warning {
            terminal::doubt();
            warn(format!("{}: {warning}", run.name));
        }
    }
}

/// Notes whether a solution can be trusted.
pub fn judge(summary: &Summary) {
    if summary.diverged.is_some()
        || summary.suspect.is_some()
        || !summary.restarts.is_empty()
        || summary.wrong_signs().next().is_some()
        || (summary.implausible.iter()).any(|finding| !matches!(finding, Implausible::Down(_)))
    {
        terminal::doubt();
    }
}

/// Tells what should be said with a result.
pub fn print_remarks(remarks: impl IntoIterator<Item = String>) {
    for remark in remarks {
        warn(remark);
    }
}

/// Writes a file whole or not at all.
pub fn write_whole(path: &Path, text: &str) -> Result<()> {
    output::spares_input(path)?;
    write::write_whole(path, text).with_context(|| format!("cannot write {}", path.display()))
}
