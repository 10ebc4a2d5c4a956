//! What findings are made of: how much one weighs, and why something is missing.

pub use undrift_events::Log;

use crate::inspect::PoseFault;
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

/// End of an inertial log that ends before the fixes do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LogEnd {
    /// Time of its last sample \[s\].
    pub end: f64,
    /// From there to the last fix \[s\].
    pub missing: f64,
}

/// How a model's bias over temperature was taken out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TemperatureUse {
    /// Samples that were corrected.
    pub corrected: u64,
    /// Samples that were not, for want of a temperature.
    pub without: u64,
    /// Time of the first of those \[s\].
    pub without_from: Option<f64>,
    /// Samples at temperatures that the model's recording did not cover.
    pub beyond: u64,
    /// Lowest and highest temperature of the drive [°C].
    pub seen_c: Option<[f64; 2]>,
}

/// An axis whose counts have too few bits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WrappedAxis {
    /// 0 to 2 for the sensor's gyros x, y, z, 3 to 5 for its accelerometers.
    pub axis: usize,
    /// Its largest size, as it is in the log.
    pub limit: f64,
    /// Time of the first jump \[s\].
    pub start: f64,
    /// How many jumps.
    pub jumps: u64,
}

/// Poses and samples that do not go together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PosesApart {
    /// What is wrong.
    pub fault: PoseFault,
    /// Whether the drive file that was made of the logs takes it into account.
    pub mended: bool,
}

/// An estimate that is far from what was known of the parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FarParameter {
    /// Which.
    pub parameter: String,
    /// Its estimate, in its own unit.
    pub value: f64,
    /// By how many prior standard deviations.
    pub sigmas: f64,
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
