//! The one exception of the package.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::error::Error;

pyo3::create_exception!(
    undrift,
    UndriftError,
    PyValueError,
    "An invalid recording, file or argument, in the words of the terminal."
);

/// An [`UndriftError`] with the text that the terminal prints: the causes joined by ": ".
pub fn error(problem: impl Into<Box<dyn Error + Send + Sync>>) -> PyErr {
    let problem = problem.into();
    let mut text = problem.to_string();
    let mut cause = problem.source();
    while let Some(next) = cause {
        text = format!("{text}: {next}");
        cause = next.source();
    }
    UndriftError::new_err(text)
}

/// The text of an exception.
pub fn text(problem: &PyErr) -> String {
    Python::attach(|py| problem.value(py).to_string())
}
