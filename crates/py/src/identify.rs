//! Static records into noise models.

use crate::{
    columns::{self, Named},
    error::{Failure, error},
    model::NoiseModel,
    work::{self, Progress},
};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use undrift::{
    findings,
    identify::{self as identification, Pooled, Trend},
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

/// Identifies records, each a file, or columns in memory under the name of a file: one, or several together.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "each is one of the terminal's options"
)]
pub fn identify(
    py: Python<'_>,
    records: Vec<(PathBuf, Option<Named<'_>>)>,
    columns: Vec<Which>,
    axis: Option<String>,
    units: Option<(String, String)>,
    topic: Option<String>,
    rate: Option<f64>,
    n_max: usize,
    detrend: &str,
    force: bool,
    progress: Option<Py<PyAny>>,
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
    let mut sources = Vec::with_capacity(records.len());
    for (path, memory) in records {
        let memory = memory
            .map(|named| columns::columns(&path, named))
            .transpose()?;
        sources.push((path, memory));
    }
    let counted = Progress::default();
    let identify = || -> Result<Identified, Failure> {
        let mut warnings = Vec::new();
        let mut taken = Vec::with_capacity(sources.len());
        for (path, memory) in sources {
            let opened = match memory {
                Some(columns) => {
                    Opened::memory(&path, Memory::Columns(columns), &BytesRead::default())?
                }
                None => Opened::open(&path)?,
            };
            let record = record::read(opened, &format)?;
            warnings.extend(of_record(&path, &record));
            let rate = identification::rate(rate, record.timing.as_ref())
                .map_err(|problem| format!("{}: {problem}", path.display()))?;
            if let Some(problem) = identification::not_static(&record, rate) {
                let message = format!("{}: {problem}", path.display());
                if !force {
                    let mend = say::mend(&problem);
                    let force = "or use force=True to identify it anyway";
                    return Err(format!("{message}; {mend}, {force}").into());
                }
                warnings.push(message);
            }
            taken.push((results::name(&path), record.with_gaps(), rate));
        }
        let axes = taken.iter().map(|(_, record, _)| record.axes.len() as u64);
        // Several records are identified axis by axis together.
        counted.of(axes.max().unwrap_or(0));
        let (found, name, provenance) = match &taken[..] {
            [(name, record, rate)] => {
                let options = identification::options(record, *rate, n_max, trend);
                let found = identification::run(record, &options, || counted.add(1));
                let provenance = identification::provenance(record, name, *rate)?;
                (found, name.clone(), provenance)
            }
            several => {
                let pooled = several.iter().map(|(name, record, rate_hz)| Pooled {
                    name,
                    record,
                    rate_hz: *rate_hz,
                });
                let pooled: Vec<Pooled<'_>> = pooled.collect();
                let names: Vec<&str> = pooled.iter().map(|one| one.name).collect();
                let name = results::names(&names);
                let found = identification::run_pool(&pooled, n_max, trend, || counted.add(1))?;
                let rate = found.rate_hz;
                let provenance = identification::provenance_of_several(&pooled, &name, rate)?;
                (found, name, provenance)
            }
        };
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
        Ok(Identified {
            found,
            name,
            provenance,
            warnings,
        })
    };
    work::run_with(py, progress.as_ref(), &counted, identify)?.map_err(error)
}

/// What should be said of a record.
fn of_record(path: &Path, record: &Record) -> Vec<String> {
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
