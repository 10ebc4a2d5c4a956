//! What can be wrong with a drive.

use undrift_io::ReadError;
use undrift_noise::ModelError;

/// What is wrong with a configuration file, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}{}{}: {message}", line.map_or(String::new(), |l| format!(" line {l}")), if key.is_empty() { String::new() } else { format!(", {key}") })]
pub struct ConfigError {
    /// The file as it was given.
    pub file: String,
    /// Line from 1, where it is known.
    pub line: Option<usize>,
    /// Dotted key.
    pub key: String,
    /// What is wrong and what was expected.
    pub message: String,
}

/// Why a drive cannot be set up.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// `DRIVE.toml` is invalid.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A log cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A log that a key names has to be looked into and cannot be read.
    #[error("{at}{error}")]
    Log {
        /// Where it is specified.
        at: ConfigError,
        /// Why it cannot be read.
        error: Box<ReadError>,
    },
    /// The model cannot be read.
    #[error(transparent)]
    Model(#[from] ModelError),
}
