//! The error of a key.

/// An error in a configuration file: which file, line and key, and what was expected there. Its text is one line with all four.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}{}{}: {message}", line.map_or(String::new(), |l| format!(" line {l}")), if key.is_empty() { String::new() } else { format!(", {key}") })]
pub struct ConfigError {
    /// Name of the file as it was given.
    pub file: String,
    /// Line from 1, where it is known.
    pub line: Option<usize>,
    /// Dotted key, such as `gnss.position_std`; empty of the file as a whole.
    pub key: String,
    /// What is wrong, what was expected, and the remedy where it is known.
    pub message: String,
}
