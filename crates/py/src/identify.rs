//! Static records into noise models.

use crate::{
    columns::{self, Named},
    error::error,
    model::NoiseModel,
};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use undrift::{
    findings,
    identify::{self as identification, Trend},
    io::{Memory, Opened, source::BytesRead, table::Column},
    noise::Provenance,
    record::{self, Record, RecordFormat},
    results,
};
use undrift_report::say;

/// An identified record; `undrift.Identified` wraps it.
#[pyclass(frozen, module = "undrift._undrift")]
pub struct Identified {
    found: identification::Identified,
    name: String,
    provenance: Provenance,
    warnings: Vec<String>,
}

/// A column: its name, or its number from 1.
#[derive(FromPyObject)]
pub enum Which {
    Number(usize),
    Name(String),
}

/// Identifies a record: a file, or columns in memory under the name of a file.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "each is one of the terminal's options"
)]
pub fn identify(
    py: Python<'_>,
    path: PathBuf,
    memory: Option<Named<'_>>,
    columns: Vec<Which>,
    axis: Option<String>,
    units: Option<(String, String)>,
    topic: Option<String>,
    rate: Option<f64>,
    n_max: usize,
    detrend: &str,
    force: bool,
) -> PyResult<Identified> {
    let trend = Trend::named(detrend).ok_or_else(|| {
        error(format!(
            "unknown detrend \"{detrend}\"; available: constant, linear, temperature"
        ))
    })?;
    let format = RecordFormat {
        columns: columns
            .into_iter()
            .map(|column| match column {
                Which::Number(number) => Column::Number(number),
                Which::Name(name) => Column::Name(name),
            })
            .collect(),
        axis,
        units,
        temperature: false,
        topic,
    };
    let memory = memory
        .map(|named| columns::columns(&path, named))
        .transpose()?;
    let name = results::name(&path);
    let work = || -> Result<Identified, Box<dyn std::error::Error + Send + Sync>> {
        let opened = match memory {
            Some(columns) => {
                Opened::memory(&path, Memory::Columns(columns), &BytesRead::default())?
            }
            None => Opened::open(&path)?,
        };
        let record = record::read(opened, &format)?;
        let mut warnings = warnings(&path, &record);
        let rate = identification::rate(rate, record.timing.as_ref())
            .map_err(|problem| format!("{}: {problem}", path.display()))?;
        if let Some(problem) = identification::not_static(&record, rate) {
            let message = format!("{}: {problem}", path.display());
            if !force {
                let mend = say::mend(&problem);
                return Err(format!("{message}; {mend}; force=True identifies it as it is").into());
            }
            warnings.push(message);
        }
        let options = identification::options(&record, rate, n_max, trend);
        let found = identification::run(&record, &options, || ());
        if found.axes.iter().all(|(_, axis)| axis.is_err()) {
            let why = found
                .axes
                .iter()
                .filter_map(|(name, axis)| Some(format!("{name}: {}", axis.as_ref().err()?)));
            return Err(format!(
                "no axis could be identified: {}",
                why.collect::<Vec<_>>().join("; ")
            )
            .into());
        }
        let provenance = identification::provenance(&record, &name, rate)?;
        Ok(Identified {
            found,
            name: name.clone(),
            provenance,
            warnings,
        })
    };
    py.detach(work).map_err(error)
}

/// What should be said of a record.
fn warnings(path: &Path, record: &Record) -> Vec<String> {
    let mut said = Vec::new();
    if !record.skipped.is_empty() {
        said.push(format!("{}: {}", path.display(), record.skipped));
    }
    said.extend(record.guessed.iter().map(|(option, value)| {
        format!(
            "{}: guessed from the values: {option} {value}",
            path.display()
        )
    }));
    said.extend(
        findings::of_timing(record.timing.as_ref())
            .as_ref()
            .map(say::say),
    );
    said
}

#[pymethods]
impl Identified {
    /// Everything as JSON.
    fn json(&self, py: Python<'_>) -> String {
        py.detach(|| results::text(&self.found.result(&self.name)))
    }

    /// What should be said of the record.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// The model; `base` gives the axes that the record does not have.
    #[pyo3(signature = (base=None))]
    fn model(&self, base: Option<&NoiseModel>) -> PyResult<NoiseModel> {
        let base = base.map(|model| &model.0);
        let model = self.found.model(base, &self.name, self.provenance.clone());
        model.map(NoiseModel).map_err(error)
    }
}
