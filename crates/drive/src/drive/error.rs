//! Errors of setting up a drive: of its file, its logs, its noise model.

use undrift_io::ReadError;
use undrift_noise::ModelError;

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
        /// Place in the drive file that names the log.
        at: ConfigError,
        /// Reason why the log cannot be read.
        error: Box<ReadError>,
    },
    /// The model cannot be read.
    #[error(transparent)]
    Model(#[from] ModelError),
}
