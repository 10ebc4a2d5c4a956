//! Results read back from their JSON.

use super::{Demo, Fleet, Identify, MonteCarlo, Navigate, Outages, SCHEMA, Tune};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::path::Path;
use undrift_io::ReadError;

/// A result of any kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum Results {
    /// Of `identify`.
    Identify(Identify),
    /// Of `navigate`.
    Navigate(Box<Navigate>),
    /// Of `outages`.
    Outages(Box<Outages>),
    /// Of `montecarlo`.
    MonteCarlo(MonteCarlo),
    /// Of `demo`.
    Demo(Box<Demo>),
    /// Of `fleet`.
    Fleet(Fleet),
    /// Of `tune`.
    Tune(Tune),
}

/// What every result begins with.
#[derive(Deserialize)]
struct Head {
    #[expect(dead_code, reason = "without it, this is not a result")]
    undrift: String,
    kind: String,
    #[serde(default)]
    schema: u32,
}

impl Results {
    /// Reads a result; `path` is for messages.
    ///
    /// # Errors
    /// A text that is no result, or that of a later version, with line and key.
    pub fn read(path: &Path, text: &str) -> Result<Self, ReadError> {
        let head: Head = part(path, text)?;
        if head.schema > SCHEMA {
            let problem = format!("schema {} is from a later version of undrift", head.schema);
            return Err(ReadError::new(path, problem).key("schema"));
        }
        Ok(match head.kind.as_str() {
            "identify" => Self::Identify(part(path, text)?),
            "navigate" => Self::Navigate(part(path, text)?),
            "outages" => Self::Outages(part(path, text)?),
            "montecarlo" => Self::MonteCarlo(part(path, text)?),
            "demo" => Self::Demo(part(path, text)?),
            "fleet" => Self::Fleet(part(path, text)?),
            "tune" => Self::Tune(part(path, text)?),
            other => {
                let why = format!(
                    "unknown kind \"{other}\"; known: identify, navigate, outages, montecarlo, demo, fleet, tune"
                );
                return Err(not_a_result(path, &why).key("kind"));
            }
        })
    }

    /// Version of the program that made it.
    pub fn version(&self) -> &str {
        match self {
            Self::Identify(result) => &result.undrift,
            Self::Navigate(result) => &result.undrift,
            Self::Outages(result) => &result.undrift,
            Self::MonteCarlo(result) => &result.undrift,
            Self::Demo(result) => &result.undrift,
            Self::Fleet(result) => &result.undrift,
            Self::Tune(result) => &result.undrift,
        }
    }
}

fn not_a_result(path: &Path, why: &str) -> ReadError {
    ReadError::new(path, format!("not a result of undrift: {why}"))
}

fn part<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, ReadError> {
    let mut reader = serde_json::Deserializer::from_str(text);
    let read = serde_path_to_error::deserialize(&mut reader);
    let read = read.and_then(|value| {
        // Nothing may follow.
        let end = reader.end().map(|()| value);
        end.map_err(|error| {
            serde_path_to_error::Error::new(serde_path_to_error::Track::new().path(), error)
        })
    });
    read.map_err(|error| {
        let key = error.path().to_string();
        let error = error.into_inner();
        let full = error.to_string();
        if !text.trim_start().starts_with('{') {
            return not_a_result(path, "not JSON; give a file that --json wrote");
        }
        // The line is part of the error itself.
        let why = full.split(" at line ").next().unwrap_or(&full);
        let failed = not_a_result(path, why).at(error.line() as u64);
        match key.as_str() {
            "." | "?" => failed,
            key => failed.key(key),
        }
    })
}
