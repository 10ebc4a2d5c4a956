//! Static records into noise models.

use crate::{
    columns::{self, Named},
    error::{Failure, error},
    model::NoiseModel,
    navigate::Verdict,
    work::{self, Progress},
};
use pyo3::prelude::*;
use std::path::PathBuf;
use undrift::{
    identify::{self as identification, Prepared, RecordingError, Settings, Trend},
    io::{Memory, Opened, source::BytesRead, table::Column},
    noise::Provenance,
    record::{self, Record, RecordFormat},
    results,
};
use undrift_report::{say, sentence, verdict};

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

impl Which {
    fn column(self) -> Column {
        match self {
            Self::Number(number) => Column::Number(number),
            Self::Name(name) => Column::Name(name),
        }
    }
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
    time: Option<(Which, Option<String>)>,
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
        columns: columns.into_iter().map(Which::column).collect(),
        time: time.map(|(column, unit)| (column.column(), unit)),
        axis,
        units,
        temperature: false,
        topic,
    };
    let settings = Settings {
        rate_hz: rate,
        span: None,
        n_max,
        trend,
    };
    let source = |(path, named): (PathBuf, Option<Named<'_>>)| {
        let memory = named.map(|named| columns::columns(&path, named));
        Ok((path, memory.transpose()?))
    };
    let sources = records.into_iter().map(source);
    let sources = sources.collect::<PyResult<Vec<_>>>()?;
    let counted = Progress::default();
    let identify = || -> Result<Identified, Failure> {
        let mut warnings = Vec::new();
        let prepared = sources.into_iter().map(|(path, memory)| {
            let opened = match memory {
                Some(columns) => {
                    Opened::memory(&path, Memory::Columns(columns), &BytesRead::default())?
                }
                None => Opened::open(&path)?,
            };
            let record = record::read(opened, &format)?;
            prepare(record, &settings, force, &mut warnings)
        });
        let prepared = prepared.collect::<Result<Vec<_>, _>>()?;
        identified(&prepared, &settings, warnings, &counted)
    };
    work::run_with(py, progress.as_ref(), &counted, identify)?.map_err(error)
}

/// Makes a record ready; one that is not static is refused, or warned of if that is forced.
fn prepare(
    record: Record,
    settings: &Settings,
    force: bool,
    warnings: &mut Vec<String>,
) -> Result<Prepared, Failure> {
    let name = record.name.display().to_string();
    if !record.skipped.is_empty() {
        warnings.push(format!("{name}: {}", record.skipped));
    }
    warnings.extend(say::guessed(&record.guessed).map(|guessed| format!("{name}: {guessed}")));
    let prepared = identification::prepare(record, settings);
    let prepared = prepared.map_err(|problem| format!("{name}: {problem}"))?;
    let record = &prepared.record;
    warnings.extend(say::stamps(record.uneven()));
    warnings.extend(say::repeated(&record.repeated));
    match &prepared.not_static {
        Some(problem) if !force => {
            return Err(format!("{name}: {}", say::refused(&record.guessed, problem)).into());
        }
        Some(problem) => warnings.push(format!("{name}: {problem}")),
        None => {}
    }
    Ok(prepared)
}

/// What the recordings show together.
fn identified(
    prepared: &[Prepared],
    settings: &Settings,
    warnings: Vec<String>,
    counted: &Progress,
) -> Result<Identified, Failure> {
    let axes = prepared.iter().map(|one| one.record.axes.len() as u64);
    // Several records are identified axis by axis together.
    counted.set_total(axes.max().unwrap_or(0));
    let found = identification::recordings(prepared, settings, || counted.add(1))?;
    let names: Vec<&str> = prepared.iter().map(|one| one.name.as_str()).collect();
    let name = results::names(&names);
    let why = found
        .axes
        .iter()
        .filter_map(|(name, axis)| Some(format!("{name}: {}", axis.as_ref().err()?)));
    let why: Vec<String> = why.collect();
    if why.len() == found.axes.len() {
        return Err(format!("{}: {}", RecordingError::NoAxis, why.join("; ")).into());
    }
    Ok(Identified {
        provenance: identification::provenance(prepared, &name, found.rate_hz)?,
        found,
        name,
        warnings,
    })
}

#[pymethods]
impl Identified {
    /// Everything as JSON, and the verdict.
    fn result(&self, py: Python<'_>) -> (String, Verdict) {
        py.detach(|| {
            let result = self.found.result(&self.name, &sentence);
            (
                results::text(&result),
                (result.verdict().name(), verdict::identify(&result)),
            )
        })
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
