//! The noise of a sensor in its vehicle.

use crate::{
    drive::Drive,
    error::{Failure, error},
    model::NoiseModel,
    navigate::Verdict,
    work::{self, Progress},
};
use pyo3::prelude::*;
use std::path::Path;
use undrift::{
    drive, results,
    tune::{self as tuning, Options},
};
use undrift_report::{say, text, verdict};

/// Identifies the noise that drives have in common: the result as JSON, the terminal's table, the verdict, what should be said of
/// the drives and of the fit, and the model of the sensor.
#[pyfunction]
pub fn tune(
    py: Python<'_>,
    drives: Vec<Py<Drive>>,
    start: Option<&NoiseModel>,
    hold_out: Option<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, String, Verdict, Vec<String>, NoiseModel)> {
    if let Some(problem) = say::hold_out("hold_out", hold_out) {
        return Err(error(problem));
    }
    let options = Options {
        start: start.map(|model| model.0.clone()),
        hold_out,
    };
    let given = drives.iter().map(Py::get);
    let (files, drives): (Vec<&Path>, Vec<drive::Drive>) = given
        .map(|of| (of.file.as_path(), of.drive.clone()))
        .unzip();
    let counted = Progress::default();
    let tune = || {
        let (found, logs) = tuning::tune(&drives, &options, &|_| {
            counted.add(1);
            true
        })
        .map_err(|error| say::unsolved(error.findings(), error))?;
        let result = found.result(files.iter().copied().zip(&drives));
        let names: Vec<String> = files.iter().map(|file| results::name(file)).collect();
        let mut warnings = Vec::new();
        for (name, logs) in names.iter().zip(&logs) {
            let said = say::all(&logs.read_findings()).into_iter();
            match drives.len() {
                1 => warnings.extend(said),
                _ => warnings.extend(said.map(|sentence| format!("{name}: {sentence}"))),
            }
        }
        warnings.extend(doubts(&result));
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        Ok::<_, Failure>((
            results::text(&result),
            text::tune(&result, text::unmarked),
            (
                verdict::tune_usability(&result).name(),
                verdict::tune(&result),
            ),
            warnings,
            NoiseModel(found.steady_model(&names)),
        ))
    };
    work::run_with(py, progress.as_ref(), &counted, tune)?.map_err(error)
}

/// Why the numbers are to be taken with care.
fn doubts(result: &results::Tune) -> Vec<String> {
    let doubts = [
        (
            result.guessed,
            "the noise at rest was guessed from the quietest seconds of the first drive",
        ),
        (!result.converged, "the fit stopped before it converged"),
        (
            result.unseen.0 > 0.0 && result.drift.is_empty(),
            "the drift was not measured: the drives are too short to hold out outages",
        ),
    ];
    let said = doubts.into_iter().filter(|(is_so, _)| *is_so);
    said.map(|(_, sentence)| sentence.to_owned()).collect()
}
