//! What findings are made of: how much one weighs, and why something is missing.

pub use undrift_events::Log;

use serde::{Deserialize, Serialize};

/// How much a finding weighs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Worth knowing; it leaves the result usable.
    Note,
    /// The result must not be trusted before this is looked at.
    Warning,
    /// There is no result, or none from some time on.
    Unusable,
}

/// Why a solution has no error although there is a truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum NoError {
    /// The truth covers another time.
    NoOverlap,
    /// The truth has no two samples within 2 s of each other during the solution.
    TooSparse,
}

/// Why an outage is excluded from an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum WhyLeftOut {
    /// It begins before the solution.
    NotStarted,
    /// It begins in a gap of the fixes, so that it would be longer than it is called.
    InGap,
    /// There is no reference at its end.
    NoReference,
    /// Inertial samples are missing in it.
    NoSamples,
}

/// Outages that an experiment is without.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LeftOut {
    /// Why.
    pub why: WhyLeftOut,
    /// How many.
    pub outages: u64,
    /// Of how many.
    pub of: u64,
    /// Start of the first \[s\].
    pub first: f64,
}

impl LeftOut {
    /// Whether no outage is left.
    pub fn is_all(&self) -> bool {
        self.outages == self.of
    }
}
