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
