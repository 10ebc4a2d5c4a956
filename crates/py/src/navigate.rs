//! Drives into solutions, and drives with their GNSS cut.

use crate::{
    columns,
    drive::Drive,
    error::{Failure, error},
    model::{NoiseModel, bias_model},
    work::{self, Progress},
};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use undrift::{
    findings::{self, Finding},
    io::write::{SolutionFile, SolutionFormat, SolutionOptions},
    navigate::{self as navigation, Hindsight, Wanted},
    outages::{ComparedModel, Logs, Schedule},
    results,
    usability::Usability,
};
use undrift_report::{say, sentence_of, text, verdict};

/// The verdict in a word, and the line that says why.
pub type Verdict = (&'static str, String);

/// Navigates a drive: its result as JSON, the same without the series for plots, the verdict, and the solution as arrays where
/// `solution` asks for it.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "each is one of the terminal's options"
)]
pub fn navigate<'py>(
    py: Python<'py>,
    drive: &Drive,
    bias: &str,
    smooth: bool,
    look_ahead: bool,
    output: Vec<PathBuf>,
    format: Option<&str>,
    every: Option<f64>,
    clock: Option<&str>,
    solution: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, String, Verdict, Bound<'py, PyDict>)> {
    let kind = bias_model(bias)?;
    let format: Option<SolutionFormat> = format.map(str::parse).transpose().map_err(error)?;
    let name = drive.file.file_stem().unwrap_or_default();
    let options = SolutionOptions {
        epoch: drive.drive.epoch,
        name: name.to_string_lossy().into_owned(),
        every,
        frame: drive.drive.pose_frame(),
    };
    let wanted = Wanted {
        files: SolutionFile::create_all(&output, format, &options).map_err(error)?,
        hindsight: Hindsight::asked(look_ahead, smooth),
        clock: clock
            .map(str::parse)
            .transpose()
            .map_err(error)?
            .unwrap_or_default(),
        recording: true,
        rows: solution,
        ..Wanted::default()
    };
    let counted = Progress::counted(&wanted.samples);
    let navigate = || {
        let report = navigation::navigate(&drive.drive, kind, wanted)
            .map_err(|error| say::unsolved(error.findings(), error))?;
        let about = drive.drive.result(&drive.file);
        let mut result = report.result(kind, about, &sentence_of(drive.drive.poses.is_some()));
        let json = results::text(&result);
        result.series = None;
        let brief = results::text(&result);
        Ok::<_, Failure>((
            report,
            json,
            brief,
            verdict_of(&result.findings, result.drive.posed),
        ))
    };
    let (report, json, brief, verdict) =
        work::run_with(py, progress.as_ref(), &counted, navigate)?.map_err(error)?;
    Ok((json, brief, verdict, columns::solution(py, &report.rows)?))
}

fn verdict_of(found: &[Finding], posed: bool) -> Verdict {
    let usability = Usability::from(findings::verdict(found).0);
    (usability.name(), verdict::of_findings(found, posed))
}

/// Start of an outage, times and errors.
pub type Curve<'py> = (f64, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);
/// A model's curves.
pub type Curves<'py> = (String, Vec<Curve<'py>>);

/// Cuts the GNSS of a drive and compares bias models, or noise models by their names: the result as JSON, the terminal's
/// table, the verdict, and for every model the start of each outage [s] with the horizontal error [m] over the time since
/// [s].
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "each is one of the terminal's options"
)]
pub fn outages<'py>(
    py: Python<'py>,
    drive: &Drive,
    bias_models: Vec<String>,
    models: Vec<(String, Py<NoiseModel>)>,
    without: bool,
    length: f64,
    count: Option<usize>,
    every: Option<f64>,
    start: Option<f64>,
    at: Option<Vec<f64>>,
    smooth: bool,
    look_ahead: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, String, Verdict, Vec<Curves<'py>>)> {
    let kinds = bias_models
        .iter()
        .map(|name| bias_model(name))
        .collect::<PyResult<Vec<_>>>()?;
    let models = models.into_iter();
    let models = models.map(|(name, model)| (name, model.get().0.clone()));
    let compared = match kinds.as_slice() {
        [kind] if models.len() > 0 => ComparedModel::each(models, *kind),
        kinds => kinds.iter().copied().map(Into::into).collect(),
    };
    let asked = Schedule::asked(at, every, count, start);
    let hindsight = Hindsight::asked(look_ahead, smooth);
    let counted = Progress::default();
    let cut = || {
        let logs = Logs::load(&drive.drive, hindsight)
            .map_err(|error| say::unsolved(error.findings(), error))?;
        let cuts = logs.plan_or_usual(asked, length, start)?;
        counted.set_total(logs.samples(compared.len(), without));
        let experiment = logs.compare(&compared, &cuts, hindsight, without, &|samples| {
            counted.add(samples);
        })?;
        let result = logs.result(
            &drive.file,
            &experiment,
            &sentence_of(drive.drive.poses.is_some()),
        );
        Ok::<_, Failure>((experiment.runs, result))
    };
    let (outcomes, result) =
        work::run_with(py, progress.as_ref(), &counted, cut)?.map_err(error)?;
    if result.models.is_empty() {
        let failed = result.failed.iter();
        let failed: Vec<String> = failed.map(|(name, why)| format!("{name}: {why}")).collect();
        let problem = match failed.as_slice() {
            [] => say::verdict(&result.findings),
            failed => format!("{}: {}", say::NO_MODEL, failed.join("; ")),
        };
        return Err(error(problem));
    }
    let runs = outcomes.into_iter().filter_map(|(_, outcome)| outcome.ok());
    let curves = runs
        .map(|run| {
            let of_model = run.errors.per_outage.iter().map(|outage| {
                let (times, drift): (Vec<f64>, Vec<f64>) = outage.drift.iter().copied().unzip();
                (
                    outage.start_s,
                    times.into_pyarray(py),
                    drift.into_pyarray(py),
                )
            });
            (run.name, of_model.collect())
        })
        .collect();
    Ok((
        results::text(&result),
        text::outages(&result, text::unmarked),
        verdict_of(&result.findings, result.drive.posed),
        curves,
    ))
}
