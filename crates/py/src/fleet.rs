//! Many logs: jobs and outcomes as the JSON that they are elsewhere too.

use crate::{error::error, model::write};
use pyo3::prelude::*;
use std::{collections::HashMap, path::PathBuf};
use undrift::{
    fleet::{self, FleetOutcome, Gathering, Job, Lookup, Manifest},
    results::{self, Results},
};
use undrift_report::{document, html, sentence};

fn manifest(text: &str, file: &str) -> PyResult<Manifest> {
    Manifest::from_toml(text, file, |_| {}).map_err(error)
}

fn parse(job: &str) -> PyResult<Job> {
    serde_json::from_str(job).map_err(|problem| error(format!("not a job: {problem}")))
}

fn named(lookup: &Lookup) -> (&'static str, String) {
    match lookup {
        Lookup::Files(pattern) => ("files", pattern.clone()),
        Lookup::Folders(pattern) => ("folders", pattern.clone()),
        Lookup::Text(name) => ("text", name.clone()),
    }
}

/// What a manifest's text needs looked up: "files" or "folders" by their pattern, or the "text" of a file.
#[pyfunction]
pub fn fleet_lookups(text: &str, file: &str) -> PyResult<Vec<(&'static str, String)>> {
    let lookups = manifest(text, file)?.lookups();
    Ok(lookups.iter().map(named).collect())
}

/// The jobs of a manifest's text as JSON; `found` is what was looked up, else it is looked up here.
#[pyfunction]
pub fn fleet_jobs(
    text: &str,
    file: &str,
    folder: &str,
    found: HashMap<(String, String), Vec<String>>,
) -> PyResult<Vec<String>> {
    let look = |folder: &str, lookup: &Lookup| {
        let (kind, name) = named(lookup);
        let found = found.get(&(kind.to_owned(), name));
        found.map_or_else(|| Manifest::look(folder, lookup), |found| Ok(found.clone()))
    };
    let jobs = manifest(text, file)?.jobs(folder, look).map_err(error)?;
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
    let outcome = py.detach(|| fleet::process_on(&job, threads, &sentence));
    Ok(outcome.map_err(error)?.to_json())
}

/// Whether an outcome is a failure. A text that is cut short or damaged raises.
#[pyfunction]
pub fn fleet_failed(outcome: &str) -> PyResult<bool> {
    let outcome = FleetOutcome::from_json(outcome, "outcome").map_err(error)?;
    Ok(outcome.failed.is_some())
}

/// Table, summary and page of outcomes in a folder, while outcomes are added.
#[pyclass(module = "undrift._undrift")]
pub struct FleetGathering(Option<Gathering>, PathBuf);

#[pymethods]
impl FleetGathering {
    #[new]
    fn new(folder: PathBuf) -> PyResult<Self> {
        let gathering = Gathering::start(&folder).map_err(error)?;
        Ok(Self(Some(gathering), folder))
    }

    /// Adds an outcome; one that is damaged raises and changes nothing.
    fn add(&mut self, fingerprint: &str, outcome: &str) -> PyResult<()> {
        let open = self.0.as_mut().ok_or_else(|| error("already finished"))?;
        open.add(fingerprint, outcome).map_err(error)
    }

    /// Writes the files; the summary as JSON.
    fn finish(&mut self, py: Python<'_>) -> PyResult<String> {
        let open = self.0.take().ok_or_else(|| error("already finished"))?;
        py.detach(|| {
            let fleet = open.finish().map_err(error)?;
            let json = results::text(&fleet);
            let page = document(&[(PathBuf::new(), Results::Fleet(fleet))]);
            write(&self.1.join("fleet.html"), &html::render(&page))?;
            Ok(json)
        })
    }
}
