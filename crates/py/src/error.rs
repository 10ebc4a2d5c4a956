//! The one exception of the package.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::error::Error;

pyo3::create_exception!(
    undrift,
    UndriftError,
    PyValueError,
    "An invalid recording, file or argument. The base of all exceptions of the package."
);

/// Why something could not be done.
pub type Failure = Box<dyn Error + Send + Sync>;

/// An [`UndriftError`] with the text that the terminal prints, in Python's terms: the causes joined by ": ".
pub fn error(problem: impl Into<Failure>) -> PyErr {
    let problem = problem.into();
    let mut text = problem.to_string();
    let mut cause = problem.source();
    while let Some(next) = cause {
        text = format!("{text}: {next}");
        cause = next.source();
    }
    UndriftError::new_err(in_python(&text))
}

/// A text of the terminal with its options as the arguments that they are in Python: `--rate 100` is `rate=100`.
#[pyfunction]
pub fn in_python(text: &str) -> String {
    let text = text.replace(
        "`undrift model --list` shows the presets",
        "NoiseModel.presets() lists the presets",
    );
    let mut made = String::with_capacity(text.len());
    let mut rest = text.as_str();
    while let Some(at) = rest.find("--") {
        let (before, option) = (&rest[..at], &rest[at + 2..]);
        let is_name = |c: char| c.is_ascii_lowercase() || c == '-';
        let end = option.find(|c| !is_name(c)).unwrap_or(option.len());
        let (name, after) = option.split_at(end);
        made.push_str(before);
        rest = after;
        if !name.starts_with(|c: char| c.is_ascii_lowercase())
            || before.ends_with(|c: char| c.is_alphanumeric() || c == '-')
        {
            made.push_str("--");
            made.push_str(name);
            continue;
        }
        let value = after.strip_prefix(' ').filter(|value| {
            let word = value.split(' ').next().unwrap_or_default();
            word.starts_with(|c: char| c.is_ascii_digit() || "\"-…".contains(c))
                || word.trim_end_matches([',', ';', ')']).contains(',')
        });
        match (name, value) {
            // There is no such argument: a part of an array or table is taken by its index.
            ("span", Some(value)) => {
                made.push_str("the part from to [s] ");
                rest = value;
            }
            (_, Some(value)) => {
                made.push_str(&name.replace('-', "_"));
                made.push('=');
                rest = value;
            }
            ("force", None) => made.push_str("force=True"),
            (_, None) => made.push_str(&name.replace('-', "_")),
        }
    }
    made + rest
}
