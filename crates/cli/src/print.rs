//! What the verbs share in telling their results.

use anyhow::{Context, Result};
use std::path::Path;
use undrift::{
    io::write::PendingFile, outages::ModelRun, replay::ReplayError, table::outage_table,
};

type Outcome = (String, Result<ModelRun, ReplayError>);

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

/// The table of the runs.
pub fn table(runs: &[&ModelRun]) -> String {
    let rows: Vec<_> = runs.iter().map(|r| (r.name.clone(), &r.errors)).collect();
    outage_table(&rows)
}

/// Tells which models could not be run.
pub fn print_failed(failed: &[(&str, &ReplayError)]) {
    for (name, error) in failed {
        eprintln!("{name}: {error}");
    }
}

/// Tells which results cannot be trusted.
pub fn print_warnings(runs: &[&ModelRun]) {
    for run in runs {
        if let Some(warning) = &run.errors.warning {
            eprintln!("{}: {warning}", run.name);
        }
    }
}

/// Tells what should be said with a result.
pub fn print_remarks(remarks: impl IntoIterator<Item = String>) {
    for remark in remarks {
        eprintln!("{remark}");
    }
}

/// Prints to standard output; a reader that went away (`undrift … | head`) ends the program quietly.
pub fn say(text: impl std::fmt::Display) -> Result<()> {
    use std::io::Write;
    match writeln!(std::io::stdout(), "{text}") {
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => std::process::exit(0),
        other => Ok(other?),
    }
}

/// Writes a file whole or not at all.
pub fn write_whole(path: &Path, text: &str) -> Result<()> {
    use std::io::Write;
    let write = || {
        let mut file = PendingFile::create(path)?;
        file.write_all(text.as_bytes())?;
        file.finish()
    };
    write().with_context(|| format!("cannot write {}", path.display()))
}

/// Writes a result to a file, or to standard output for "-"; whether it went there.
pub fn result(path: Option<&Path>, text: &str) -> Result<bool> {
    match path {
        Some(path) if path.as_os_str() == "-" => say(text).map(|()| true),
        Some(path) => write_whole(path, text).map(|()| false),
        None => Ok(false),
    }
}
