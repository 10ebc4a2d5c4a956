//! Results of all kinds as one type.

use super::{Demo, Fleet, Identify, MonteCarlo, Navigate, Outages, Tune};
use serde::Serialize;

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

impl Results {
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

/// What `report` wrote, and of which results.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ReportFiles {
    /// The folder of its figures.
    pub figures: Option<String>,
    /// The page.
    pub report: Option<String>,
    /// The files of the results.
    pub results: Vec<String>,
}
