//! Many logs: jobs and outcomes as the JSON that they are elsewhere too.

use crate::{error::error, model::write};
use pyo3::prelude::*;
use std::{collections::HashMap, path::PathBuf};
use undrift::{
    fleet::{self, Job, Manifest},
    results::{self, Results},
};
use undrift_report::{document, html, say};

fn manifest(text: &str, file: &str) -> PyResult<Manifest> {
    Manifest::from_toml(text, file, |_| {}).map_err(error)
}

fn parse(job: &str) -> PyResult<Job> {
    serde_json::from_str(job).map_err(|problem| error(format!("not a job: {problem}")))
}

/// The patterns of a manifest's text that stand for several files.
#[pyfunction]
pub fn fleet_patterns(text: &str, file: &str) -> PyResult<Vec<String>> {
    let logs = manifest(text, file)?.logs.into_iter();
    let patterns = logs.filter(|log| log.is_pattern());
    Ok(patterns.map(|log| log.pattern).collect())
}

/// The jobs of a manifest's text as JSON; `found` is what each pattern stands for, `None` to look here.
#[pyfunction]
pub fn fleet_jobs(
    text: &str,
    file: &str,
    folder: &str,
    found: Option<HashMap<String, Vec<String>>>,
) -> PyResult<Vec<String>> {
    let matching = |folder: &str, pattern: &str| match &found {
        None => Manifest::matching(folder, pattern),
        Some(found) => Ok(found.get(pattern).cloned().unwrap_or_default()),
    };
    let jobs = manifest(text, file)?
        .jobs(folder, matching)
        .map_err(error)?;
    jobs.iter()
        .map(|job| serde_json::to_string(job).map_err(error))
        .collect()
}

/// The files that a job reads, by what they are for.
#[pyfunction]
pub fn fleet_inputs(job: &str) -> PyResult<Vec<(String, PathBuf)>> {
    Ok(fleet::inputs(&parse(job)?))
}

/// SHA-256 of all that a job's outcome depends on.
#[pyfunction]
pub fn fleet_fingerprint(py: Python<'_>, job: &str) -> PyResult<String> {
    let job = parse(job)?;
    Ok(py.detach(|| fleet::fingerprint(&job)))
}

/// The outcome of a job as JSON, worked out on so many threads; 0 for as many as there are cores.
#[pyfunction]
pub fn fleet_process(py: Python<'_>, job: &str, threads: usize) -> PyResult<String> {
    let job = parse(job)?;
    let outcome = py.detach(|| fleet::process_on(&job, threads));
    let mut outcome = outcome.map_err(error)?;
    say::outcome(&mut outcome);
    Ok(outcome.to_json())
}

/// Makes table, summary and page of the outcomes in a folder; the summary as JSON.
#[pyfunction]
pub fn fleet_gather(
    py: Python<'_>,
    fingerprints: Vec<String>,
    folder: PathBuf,
) -> PyResult<String> {
    py.detach(|| {
        let fleet = fleet::gather(&fingerprints, &folder).map_err(error)?;
        let json = results::text(&fleet);
        let page = document(&[(PathBuf::new(), Results::Fleet(fleet))]);
        write(&folder.join("fleet.html"), &html::render(&page))?;
        Ok(json)
    })
}
