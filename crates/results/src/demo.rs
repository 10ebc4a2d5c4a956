//! The demo: what was identified, and what the outages did.

use super::{Curve, Cut, Drift, Identify, Number, Numbers, OrderRow, OrderTest, Residuals, Track};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Data sheet of the sensor.
pub const PRESET: &str = "adis16405";
/// Rest at the start of a drive, over which the constants are averaged \[s\].
pub const REST: f64 = 60.0;

/// White noise alone: the baseline.
pub const WHITE: &str = "white";
/// The source paper's equations (3)-(9) to the letter.
pub const PAPER: &str = "paper literal";
/// The recommended model.
pub const RECOMMENDED: &str = "recommended";
/// The same on samples whose constants nobody removed.
pub const UNCALIBRATED: &str = "constants left in";
/// The simulation's own noise model, on samples without constants: no model to choose.
pub const BOUND: &str = "bound";

/// The source paper's ARMA(1,1), run exactly.
pub const PAPER_EXACT: &str = "paper exact";

/// The demo.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, tag = "kind", rename = "demo")]
pub struct Demo {
    /// Version of the program.
    pub undrift: String,
    /// Version of this schema.
    pub schema: u32,
    /// Seed of the drives, the sensors and the receiver.
    pub seed: u64,
    /// Drives.
    pub drives: u64,
    /// Whether the sensor's errors are played back from real records.
    pub recorded: bool,
    /// What was identified of the static record.
    pub identification: Identify,
    /// The models in the order of the tables, the ones to be set apart last.
    pub models: Vec<DemoModel>,
    /// What the outages of each length did.
    pub lengths: Vec<CutLength>,
    /// Ground track of the first drive.
    pub track: Track,
    /// Its outages of the first length.
    pub cuts: Vec<Cut>,
    /// The source paper's tables and figures, where they were asked for.
    pub paper: Option<Paper>,
    /// The conclusion in a sentence.
    pub conclusion: String,
}

/// A model of the demo.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct DemoModel {
    /// Its name.
    pub name: String,
    /// Whether it is no model to choose but a bound.
    pub bound: bool,
    /// Axes of which the method has no model: there it is white noise.
    pub without: Vec<String>,
}

/// The outages of one length, of all drives.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct CutLength {
    /// \[s\]
    pub length_s: Number,
    /// How many.
    pub cuts: u64,
    /// By the models' names.
    pub models: BTreeMap<String, PooledErrors>,
}

/// What outages did to a model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct PooledErrors {
    /// Largest magnitude over all outages.
    pub max: Numbers,
    /// RMS over the outages of the largest error of each.
    pub rms: Numbers,
    /// The same of the horizontal error alone \[m\].
    pub horizontal_m: Estimate,
    /// How many times less that is than of white noise, paired.
    pub less_than_white: Estimate,
    /// How many times more it is than the least of all models but the bounds, paired.
    pub over_least: Estimate,
    /// Largest horizontal error of each outage \[m\].
    pub largest_m: Vec<Number>,
    /// Drift since the cut.
    pub drift: Drift,
    /// Why a drive has no solution, if so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
}

/// A number with its 95 % interval by bootstrap over the outages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Estimate {
    /// The number.
    pub value: Number,
    /// Ends of the interval.
    pub interval: [Number; 2],
}

impl Estimate {
    /// Whether one lies in the interval: of a ratio, that it may be chance.
    pub fn is_one(&self) -> bool {
        let [low, high] = self.interval;
        low.0 <= 1.0 && 1.0 <= high.0
    }
}

/// What the source paper prints.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Paper {
    /// Its Table 3 of the z gyro.
    pub orders: Vec<OrderRow>,
    /// Its tests of adequacy.
    pub adequacy: Vec<OrderTest>,
    /// Its equation 2: the likeliest ARMA(1,1), and the one with φ = 1.
    pub one_one: Vec<OneOne>,
    /// What it leaves of the record.
    pub residuals: Option<Residuals>,
    /// Its Table 4: largest errors in the 10 s outages of the first drive, by model.
    pub largest: BTreeMap<String, Numbers>,
    /// Its Figures 4 and 5: the first drive, model by model.
    pub solutions: BTreeMap<String, PaperSolution>,
    /// RMS over all 10 s outages of the largest horizontal error \[m\] by equations (3)-(9), against the σ taken in units of the white
    /// noise of a sample.
    pub scan: Vec<ScanPoint>,
}

/// An ARMA(1,1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct OneOne {
    /// Whether φ is held at 1.
    pub unit_root: bool,
    /// φ
    pub phi: Number,
    /// θ
    pub theta: Number,
    /// Standard deviation of the innovations \[rad/s\].
    pub sigma: Number,
}

/// The first drive as estimated by a filter.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct PaperSolution {
    /// Ground track.
    pub track: Track,
    /// Position error north, east and down \[m\].
    pub error_m: [Curve; 3],
}

/// σ and what it leads to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ScanPoint {
    /// σ over the white noise of a sample.
    pub scale: Number,
    /// \[m\]
    pub horizontal_m: Number,
}
