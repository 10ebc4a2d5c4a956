//! Errors of setting up a drive: of its file, its logs, its noise model.

pub use undrift_config::ConfigError;

use undrift_io::ReadError;
use undrift_noise::ModelError;

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
