//! What a session needs to go on in another process.

use serde::{Deserialize, Serialize};
use std::{io, path::Path};
use undrift_io::write::write_whole;

/// The state of a session: the navigator and what its times mean.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Time of the last arrival \[ns\].
    pub(crate) at: u64,
    /// Interval of the samples \[s\].
    pub(crate) interval: f64,
    /// Unix time of the solution's time 0 \[s\], where there is a date.
    pub(crate) unix_zero: Option<f64>,
    /// Of each log what is added to its times, and its least delay \[s\].
    pub(crate) clocks: Vec<(String, (f64, f64))>,
    /// The navigator's checkpoint.
    #[serde(skip)]
    pub(crate) navigator: Vec<u8>,
}

/// Why a session does not go on from a state.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StateError {
    /// It is too old, or from the future.
    #[error("the checkpoint is {0:.0} s old")]
    Old(f64),
    /// The times of the logs count from another instant.
    #[error("the times of the logs count from another instant than those of the checkpoint")]
    OtherTimes,
    /// The bytes are no state.
    #[error("the file is no checkpoint of undrift live")]
    NoState,
    /// The navigator cannot be restored.
    #[error("{0}")]
    Navigator(String),
}

/// Begins the bytes of a state.
const MAGIC: &[u8] = b"undrift live state 1\n";

impl State {
    /// As bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let about = serde_json::to_vec(self).unwrap_or_default();
        [MAGIC, &about, b"\n", &self.navigator].concat()
    }

    /// From bytes.
    ///
    /// # Errors
    /// [`StateError::NoState`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, StateError> {
        let rest = bytes.strip_prefix(MAGIC).ok_or(StateError::NoState)?;
        let end = rest
            .iter()
            .position(|byte| *byte == b'\n')
            .ok_or(StateError::NoState)?;
        let (about, navigator) = rest.split_at(end);
        let state: Self = serde_json::from_slice(about).map_err(|_| StateError::NoState)?;
        Ok(Self {
            navigator: navigator.get(1..).unwrap_or_default().to_vec(),
            ..state
        })
    }

    /// Writes it as a file that appears whole.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        write_whole(path, self.to_bytes())
    }

    /// Reads a file; `None` if there is none.
    ///
    /// # Errors
    /// [`StateError::NoState`].
    pub fn read(path: &Path) -> Result<Option<Self>, StateError> {
        match std::fs::read(path) {
            Ok(bytes) => Self::from_bytes(&bytes).map(Some),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(_) => Err(StateError::NoState),
        }
    }
}
