//! A Monte Carlo: whether the filter knows its own errors.

use super::Number;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, fmt};

/// A Monte Carlo.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, tag = "kind", rename = "montecarlo")]
pub struct MonteCarlo {
    /// Version of the program.
    pub undrift: String,
    /// Version of this schema.
    pub schema: u32,
    /// Runs.
    pub runs: u64,
    /// Seed they were drawn from.
    pub seed: u64,
    /// Beginning of the navigation that averages and shares exclude \[s\].
    pub settle_s: Number,
    /// What was simulated.
    pub drive: MonteCarloDrive,
    /// Times of the NEES series \[s\].
    pub time_s: Vec<Number>,
    /// Times of the NIS series \[s\].
    pub fix_time_s: Vec<Number>,
    /// Model by model.
    pub models: Vec<MonteCarloModel>,
}

/// What was simulated.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct MonteCarloDrive {
    /// Length \[s\].
    pub duration_s: Number,
    /// Inertial samples a second \[Hz\].
    pub rate_hz: Number,
    /// Bias model that the errors were drawn from.
    pub drawn_as: String,
    /// Noise model of the simulated IMU.
    pub model: String,
    /// Noise model of the filter.
    pub filter_model: String,
    /// From epoch to epoch of the NEES \[s\].
    pub every_s: Number,
}

/// One bias model of a Monte Carlo.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct MonteCarloModel {
    /// Its name.
    pub name: String,
    /// Runs whose solution diverged; they count as long as they lasted.
    pub diverged: u64,
    /// When the last of the runs began to navigate \[s\].
    pub started_s: Number,
    /// NEES, group by group.
    pub nees: Vec<Group>,
    /// Shares of all epochs and runs after the settling within 1, 2 and 3 standard deviations, by
    /// component: 0.683, 0.954 and 0.997 when the filter is right.
    pub coverage: BTreeMap<String, Vec<Number>>,
    /// NIS of position and velocity.
    pub nis: Vec<NisKind>,
}

/// The reported against the actual accuracy of the filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// As accurate as reported.
    Consistent,
    /// Less accurate than reported.
    Optimistic,
    /// More accurate than reported.
    Pessimistic,
}

impl Verdict {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Consistent, Self::Optimistic, Self::Pessimistic];
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Consistent => "consistent",
            Self::Optimistic => "optimistic",
            Self::Pessimistic => "pessimistic",
        })
    }
}

/// NEES of one group of states.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Group {
    /// Name of the group.
    pub name: String,
    /// Degrees of freedom of one run.
    pub freedom: u64,
    /// Average over epochs and runs after the settling, per degree of freedom …
    pub mean_per_freedom: Number,
    /// … and its standard error, from the scatter of the runs' own averages.
    pub mean_standard_error: Number,
    /// Share of the epochs after the settling whose average over the runs is within its bounds …
    pub share_inside: Number,
    /// … above …
    pub share_above: Number,
    /// … and below them.
    pub share_below: Number,
    /// Epochs after the settling.
    pub epochs: u64,
    /// How many independent ones they are worth, at most: their correlation lets the share of a
    /// perfect filter scatter about 0.95 …
    pub effective_epochs: Number,
    /// … with this standard deviation, at most.
    pub share_standard_error: Number,
    /// What it comes to.
    pub verdict: Option<Verdict>,
    /// Average over the runs at each epoch.
    pub average: Vec<Number>,
    /// Two-sided 95 % bounds of it.
    pub lower: Vec<Number>,
    /// Two-sided 95 % bounds of it.
    pub upper: Vec<Number>,
}

/// Innovations of one kind of measurement after the settling, all runs together.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct NisKind {
    /// "position" or "velocity".
    pub name: String,
    /// Updates.
    pub updates: u64,
    /// NIS per degree of freedom …
    pub nis_per_freedom: Number,
    /// … and its two-sided 95 % bounds.
    pub bounds: (Number, Number),
    /// Share of the updates above the 95 % point.
    pub share_above_95: Number,
    /// Share of the fixes whose average NIS over the runs is within its two-sided 95 % bounds.
    pub share_inside: Number,
    /// Autocorrelation at lags 1 to 10, by component.
    pub autocorrelation: Vec<Vec<Number>>,
    /// 95 % bound of it.
    pub autocorrelation_bound: Number,
    /// Whether NIS per degree of freedom is within its bounds.
    pub verdict: Option<Verdict>,
    /// Average over the runs at each fix.
    pub average: Vec<Number>,
}
