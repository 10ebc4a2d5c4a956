//! A navigated drive.

use super::{
    Curve, Drive, Key, Keyed, Number, Numbers, Track,
    known::{known, known_findings},
};
use crate::findings::Finding;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use undrift_events::{
    Aid, Contradiction, CovarianceHealth, Implausible, Innovations, Lean, Restart, Window,
};

/// A navigated drive.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, tag = "kind", rename = "navigate")]
pub struct Navigate {
    /// Version of the program.
    pub undrift: String,
    /// Version of this schema.
    pub schema: u32,
    /// What was navigated.
    pub drive: Drive,
    /// Name of the bias model.
    pub bias_model: String,
    /// Whether the solution is the smoothed one.
    pub smooth: bool,
    /// Whether the solution knows more of the log than what came before: else it is that of a run while driving.
    pub look_ahead: bool,
    /// Whose times the solution has: "imu", those of the samples as stamped; "gnss", those of the fixes; "unstated", those of the
    /// samples, and the standard deviations contain by how much they differ from those of the fixes.
    pub clock: String,
    /// The mounting in words, where it was estimated.
    pub mounting: Option<String>,
    /// Innovations of the positions.
    pub position: Nis,
    /// Innovations of the velocities.
    pub velocity: Nis,
    /// Factors on the stated standard deviations that would make the innovations plausible.
    pub std_factors: StdFactors,
    /// Components of the velocity that seem to have the wrong sign.
    pub velocity_sign_wrong: Vec<String>,
    /// Root mean square of the errors against the truth, by component with its unit.
    pub rms_error: Option<Numbers>,
    /// Normalised estimation error squared against the truth, per degree of freedom, by group of states.
    pub nees_per_dof: Numbers,
    /// Samples compared with the truth.
    pub compared_samples: Option<u64>,
    /// Records that were skipped, by log.
    pub skipped: BTreeMap<String, String>,
    /// Counts and findings of the replay.
    pub summary: Summary,
    /// How well the solution and the fixes agree, window by window.
    #[serde(deserialize_with = "known")]
    pub windows: Vec<Window>,
    /// What was found out about logs and solution.
    #[serde(deserialize_with = "known_findings")]
    pub findings: Vec<Finding>,
    /// The same in sentences.
    pub warnings: Vec<String>,
    /// For plots.
    pub series: Option<NavigateSeries>,
}

/// Innovations of one kind of measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Nis {
    /// NIS per degree of freedom, 1 if the model is correct.
    pub nis_per_dof: Number,
    /// Autocorrelation of the whitened innovations from one update to the next.
    pub autocorrelation: Number,
    /// What it stays below 19 times out of 20 when the model is right.
    pub autocorrelation_bound: Number,
}

/// Factors on stated standard deviations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct StdFactors {
    /// Of the positions.
    pub position: Option<f64>,
    /// Of the velocities.
    pub velocity: Option<f64>,
}

impl Key for Aid {
    const ALL: &'static [Self] = &Self::ALL;

    fn key(self) -> String {
        Self::key(self)
    }

    fn describe(self) -> &'static str {
        self.counted()
    }
}

/// What a replay was like.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Summary {
    /// Samples processed after alignment.
    pub samples: u64,
    /// Samples used up by alignment.
    pub align_samples: u64,
    /// When navigation began \[s\].
    pub started: Number,
    /// How the first attitude was found, in words.
    pub alignment: String,
    /// Time of the last sample \[s\].
    pub ended: Number,
    /// Fixes used.
    pub fixes: u64,
    /// Fixes withheld by outages.
    pub withheld: u64,
    /// Fixes before the first sample or before alignment could use them.
    pub fixes_before: u64,
    /// Fixes that could not be used because their covariance is not one.
    pub bad_fixes: u64,
    /// Updates by kind of measurement, each under its own name.
    #[serde(flatten)]
    pub innovations: Keyed<Aid, Innovations>,
    /// Parameters estimated, by name.
    pub parameters: BTreeMap<String, Parameter>,
    /// Runs of rejected fixes, the first 1000.
    #[serde(deserialize_with = "known")]
    pub contradictions: Vec<Contradiction>,
    /// Runs of rejected fixes beyond those.
    pub more_contradictions: u64,
    /// Spans in which innovations leaned to one side, the first 1000.
    #[serde(deserialize_with = "known")]
    pub leans: Vec<Lean>,
    /// When and why the solution was re-initialised.
    #[serde(deserialize_with = "known")]
    pub restarts: Vec<Restart>,
    /// From when on the filter took the fixes to be wrong by what, beyond what they state: each time it changed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fix_errors: Vec<FixErrors>,
    /// Mean factors on the stated standard deviations of position and velocity, where they were adapted.
    pub adapted: [Option<f64>; 2],
    /// How many times the model's the white noise was, gyro x, y, z and accelerometer x, y, z, as the samples show; missing where
    /// it was the model's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub louder: Option<[Number; 6]>,
    /// Short gaps in the samples that were bridged by interpolation.
    pub bridged: u64,
    /// Gaps too long for that: their number, the first one's time \[s\], the longest \[s\].
    pub long_gaps: Option<(u64, Number, Number)>,
    /// Longest span without a fix, outages aside: start and length \[s\].
    pub longest_without_gnss: (Number, Number),
    /// Units, axes, signs or times that cannot be right.
    #[serde(deserialize_with = "known")]
    pub implausible: Vec<Implausible>,
    /// When the solution diverged for good \[s\].
    pub diverged: Option<f64>,
    /// The covariance at the end, if there is a solution.
    pub covariance: Option<CovarianceHealth>,
    /// Since when the innovations were far beyond their predicted size \[s\].
    pub suspect: Option<f64>,
}

/// What fixes are wrong by beyond what they state, as they have shown it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FixErrors {
    /// From when on \[s\].
    pub from: Number,
    /// Factor on the stated standard deviations of the positions.
    pub position_factor: Number,
    /// Factor on that of the heights, beside the one of the positions.
    pub height_factor: Number,
    /// Factors on those of the velocities north, east, down.
    pub velocity_factor: [Number; 3],
    /// Share of the position's variance that lasts, and its correlation time \[s\], where it has one.
    pub correlated: Option<(Number, Number)>,
    /// The same of the velocity's.
    pub velocity_correlated: Option<(Number, Number)>,
    /// Steps of the positions north, east, down \[m\].
    pub step: [Number; 3],
    /// Standard deviation of the stamps \[s\].
    pub jitter: Number,
    /// What the velocity reads too much north, east, down \[m/s\].
    pub velocity_bias: [Number; 3],
}

/// An estimated parameter: its last values and their standard deviations \[m, s, rad or no unit\].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Parameter {
    /// Values.
    pub value: Vec<Number>,
    /// Standard deviations.
    pub std: Vec<Number>,
}

/// A run over time; curves by component with its unit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct NavigateSeries {
    /// The ground track.
    pub track: Track,
    /// Velocity and attitude.
    pub motion: BTreeMap<String, Curve>,
    /// Standard deviations of position, velocity and attitude.
    pub std: BTreeMap<String, Curve>,
    /// Estimated errors of the six sensor axes.
    pub sensor_error: BTreeMap<String, Curve>,
    /// Their standard deviations.
    pub sensor_error_std: BTreeMap<String, Curve>,
    /// Errors against the truth.
    pub error: BTreeMap<String, Curve>,
    /// Whitened innovations and NIS of position and velocity.
    pub innovations: BTreeMap<String, BTreeMap<String, Curve>>,
    /// Spans without a fix used: start and end \[s\].
    pub without_gnss_s: Vec<(Number, Number)>,
    /// Spans in which the solution and a part of the fixes disagree: start and end \[s\].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub disagreements_s: Vec<(Number, Number)>,
    /// Positions of the fixes that were used, evenly thinned.
    #[serde(skip_serializing_if = "Fixes::is_empty")]
    pub fixes: Fixes,
    /// Those of the rejected ones.
    #[serde(skip_serializing_if = "Fixes::is_empty")]
    pub rejected_fixes: Fixes,
}

/// Positions of fixes with their stated standard deviations.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Fixes {
    /// Times \[s\].
    pub time_s: Vec<Number>,
    /// Latitudes \[deg\].
    pub lat_deg: Vec<Number>,
    /// Longitudes \[deg\].
    pub lon_deg: Vec<Number>,
    /// Standard deviations to the north \[m\].
    pub std_north_m: Vec<Number>,
    /// Standard deviations to the east \[m\].
    pub std_east_m: Vec<Number>,
}

impl Fixes {
    /// Whether there are no fixes.
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }
}
