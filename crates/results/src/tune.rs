//! The noise of a sensor in its vehicle.

use super::{Drive, Number, findings::Finding};
use serde::{Deserialize, Serialize};

/// The noise estimated from drives.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, tag = "kind", rename = "tune")]
pub struct Tune {
    /// Version of the program.
    pub undrift: String,
    /// Version of this schema.
    pub schema: u32,
    /// The drives.
    pub drives: Vec<Drive>,
    /// The sensor at rest that it began from.
    pub start: String,
    /// Whether that is a guess from the first drive itself.
    pub guessed: bool,
    /// Share at the end of each drive that the drift was measured on.
    pub unseen: Number,
    /// Whether the noise is that of the rest alone; else of the whole drives, and the drift that of a fit of the rest.
    pub held_out: bool,
    /// Parameter by parameter.
    pub parameters: Vec<TunedParameter>,
    /// Drift on held-out outages, by length.
    pub drift: Vec<TunedDrift>,
    /// What errors of the sensors' axes change that are estimated beside the noise; null where they were not tried.
    pub axes: Option<TunedAxes>,
    /// What it changes if the white noise follows the vibration; null where it was not tried.
    pub vibration: Option<TunedVibration>,
    /// The file that the tuned drive was asked to be written to; filled in where results are shown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tuned: Option<String>,
    /// Positions in the unseen parts, where they are the reference.
    pub withheld: u64,
    /// Those of them that are rejected under every noise: they are no reference.
    pub rejected: u64,
    /// Windows whose fixes were scored.
    pub windows: u64,
    /// Evaluations of the objective.
    pub evaluations: u64,
    /// Whether nothing more was to be gained.
    pub converged: bool,
    /// Whether it was stopped before its end; the noise is the best so far.
    pub stopped: bool,
    /// Drives that cannot be aligned under the noise.
    pub unaligned: Vec<String>,
    /// What is wrong with the poses of drives by poses.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pose_faults: Vec<Finding>,
}

/// One parameter: a standard deviation, a density or a factor on one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct TunedParameter {
    /// Its key in the model file or the drive file.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// At rest, or as specified; null where that is unknown.
    pub start: Number,
    /// The most likely value before the drives, and the 95 % interval then.
    pub prior: Number,
    /// See there.
    pub prior_low: Number,
    /// See there.
    pub prior_high: Number,
    /// The most likely value with them, and its 95 % interval.
    pub value: Number,
    /// See there.
    pub low: Number,
    /// See there.
    pub high: Number,
    /// Whether the drives determine it: the interval is less than half as wide as before.
    pub determined: bool,
}

/// Errors of the sensors' axes that poses may show, tried as constants beside the noise.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct TunedAxes {
    /// Standard deviation of the misalignment of the axes of gyros and accelerometers \[rad\].
    pub misalignment_rad: Number,
    /// That of their scale factors \[–\]; null where they were tried without.
    pub scale_factor: Option<Number>,
    /// By how much the log-likelihood of the poses that the fit has not seen is larger with them.
    pub likelihood_gain: Number,
    /// Whether the tuned drive file has them (`states.misalignment`, `states.scale_factor`): what the fit has seen and what it has not
    /// are both likelier with them.
    pub kept: bool,
}

/// Drift on held-out outages with white noise that follows the vibration, over that with one density for the whole drive.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct TunedVibration {
    /// Length of the outages \[s\].
    pub length_s: Number,
    /// The ratio, and its 95 % interval by the bootstrap over outages.
    pub ratio: Number,
    /// See there.
    pub ratio_low: Number,
    /// See there.
    pub ratio_high: Number,
    /// By how much the log-likelihood of the fixes at the end of withheld spans is larger with it.
    pub likelihood_gain: Number,
    /// Whether the tuned drive file follows it: the fixes at the end of withheld spans are likelier with it.
    pub kept: bool,
}

/// Drift over outages of one length.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct TunedDrift {
    /// Length of the outages \[s\].
    pub length_s: Number,
    /// How many.
    pub outages: u64,
    /// Root mean square of the largest horizontal error of each, before: with the noise of the model and drive files \[m\].
    pub before_m: Number,
    /// With the noise found \[m\].
    pub after_m: Number,
    /// After over before, and its 95 % interval by the bootstrap over outages.
    pub ratio: Number,
    /// See there.
    pub ratio_low: Number,
    /// See there.
    pub ratio_high: Number,
    /// Shares of the position's errors at the ends inside one, two and three standard deviations, before.
    pub before_within: [Number; 3],
    /// With the noise found.
    pub after_within: [Number; 3],
    /// Normalised errors squared at the ends per degree of freedom against the reference, of its position and, of poses, of its attitude:
    /// mean and 95 % interval, before and after; 1 where standard deviations are right. Empty where there are no poses.
    pub nees: Vec<TunedNees>,
}

/// Normalised errors squared per degree of freedom at the ends of outages, of the position or the attitude of poses.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct TunedNees {
    /// `position` or `attitude`.
    pub of: String,
    /// Mean and 95 % interval with the noise of the model and drive files.
    pub before: [Number; 3],
    /// With the noise found.
    pub after: [Number; 3],
}
