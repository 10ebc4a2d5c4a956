//! Many logs: how far they drift, and which stand out.

use super::{Number, Numbers};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Many logs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, tag = "kind", rename = "fleet")]
pub struct Fleet {
    /// Version of the program.
    pub undrift: String,
    /// Version of this schema.
    pub schema: u32,
    /// Logs by what was done with them: "outages", "navigate", "tune" or "identify".
    pub tasks: BTreeMap<String, u64>,
    /// Logs without a result.
    pub failed: Vec<Trouble>,
    /// Logs, bias models and axes whose result is missing or not usable.
    pub untrusted: Vec<Trouble>,
    /// Logs with warnings.
    pub warned: Vec<Warned>,
    /// The numbers that are compared.
    pub measures: Vec<FleetMeasure>,
    /// Log by log.
    pub logs: Vec<FleetLog>,
}

/// What went wrong.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Trouble {
    /// The log.
    pub log: String,
    /// Serial number of its IMU.
    pub unit: Option<String>,
    /// The bias model or axis, if it is one of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// Why, in words.
    pub why: String,
}

/// Warnings of a log.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Warned {
    /// The log.
    pub log: String,
    /// Serial number of its IMU.
    pub unit: Option<String>,
    /// Remarks, in sentences.
    pub warnings: Vec<String>,
}

/// What a measure depends on: unit, sensor, labels and temperature, each compared on its own, by the logarithms of the
/// logs. Probabilities are adjusted for everything that is compared. Causes that go together are not separated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FleetEffects {
    /// Logs that are compared.
    pub logs: u64,
    /// Units that are compared.
    pub units: u64,
    /// Probability of finding anything in units, sensors, labels and temperature where there is nothing.
    pub significance: Number,
    /// The same of single logs.
    pub significance_of_logs: Number,
    /// Growth with temperature, if temperatures are known and differ.
    pub temperature: Option<Slope>,
}

/// Growth with temperature.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Slope {
    /// By a kelvin \[%/K\].
    pub percent_per_k: Number,
    /// Lower end of the 95 % interval \[%/K\].
    pub low: Number,
    /// Upper end \[%/K\].
    pub high: Number,
    /// Degrees of freedom of the interval.
    pub freedom: Number,
    /// Probability of as large a slope if the true slope is zero.
    pub p: Number,
    /// Whether it is significant.
    pub found: bool,
}

/// A factor on a measure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Effect {
    /// The factor.
    pub times: Number,
    /// Lower end of the 95 % interval.
    pub low: Number,
    /// Upper end.
    pub high: Number,
    /// Degrees of freedom of the interval.
    pub freedom: Number,
    /// Probability of as large a difference if the true one is zero.
    pub p: Number,
    /// Whether it is significant.
    pub found: bool,
}

/// A value with its 95 % interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Level {
    /// The value.
    pub value: Number,
    /// Lower end of the interval.
    pub low: Number,
    /// Upper end.
    pub high: Number,
}

/// A number of every log that is compared.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FleetMeasure {
    /// Its name.
    pub name: String,
    /// What it is, in words.
    pub what: String,
    /// Its unit.
    pub unit: String,
    /// What was done with its logs: "outages", "navigate", "tune" or "identify".
    pub task: String,
    /// By bias model or axis.
    pub parts: Vec<FleetPart>,
    /// On how many of the logs that have all parts each one is the least.
    pub best: BTreeMap<String, u64>,
    /// What it depends on; without it there are too few logs.
    pub effects: Option<FleetEffects>,
    /// Logs that differ from the rest of their unit, the most significant first.
    pub outliers: Vec<FleetOutlier>,
    /// By serial number of the IMU.
    pub by_unit: Vec<FleetGroup>,
    /// By noise model of the IMU.
    pub by_sensor: Vec<FleetGroup>,
    /// By each label of the logs.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub by_label: Vec<FleetLabel>,
}

/// A bias model or axis over all logs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FleetPart {
    /// The bias model or axis.
    pub part: String,
    /// Logs that have a value.
    pub logs: u64,
    /// Their median.
    pub median: Number,
    /// Geometric mean over units; of a single unit, over its logs.
    pub level: Option<Level>,
    /// By temperature.
    pub temperature: Vec<Bin>,
}

/// An outlier among the logs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FleetOutlier {
    /// The log.
    pub log: String,
    /// Serial number of its IMU.
    pub unit: Option<String>,
    /// Its own report: the label `report` of the log.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub report: Option<String>,
    /// Temperature \[°C\].
    pub temperature_c: Number,
    /// Ratio to the geometric mean of the rest of its unit, or of all logs if no log has a unit.
    pub effect: Effect,
}

/// Logs of about the same temperature.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Bin {
    /// From this temperature \[°C\] …
    pub from_c: Number,
    /// … to this one \[°C\].
    pub to_c: Number,
    /// Logs.
    pub logs: u64,
    /// Median of their values.
    pub median: Number,
}

/// What a label of the logs, such as the firmware, does to a measure.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FleetLabel {
    /// The label.
    pub label: String,
    /// Why it is not compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_out: Option<LeftOut>,
    /// By value, of a label that is compared.
    pub by_value: Vec<FleetGroup>,
}

/// Why a label is not compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum LeftOut {
    /// All logs that have it have the same value.
    Constant,
    /// Each log has a value of its own.
    Unique,
    /// Most values belong to a single unit each.
    Unit,
    /// It has more than 50 values, or more than a third of the logs.
    Many,
}

/// Logs of one unit, sensor or value of a label.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FleetGroup {
    /// The unit, sensor or value.
    pub name: String,
    /// Its logs.
    pub logs: u64,
    /// Their medians by part.
    pub median: Numbers,
    /// Ratio of its geometric mean to that of the other units, sensors or values; of units if there are four.
    pub effect: Option<Effect>,
}

/// One log's numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FleetLog {
    /// The log.
    pub log: String,
    /// Serial number of its IMU.
    pub unit: Option<String>,
    /// Name of its noise model.
    pub sensor: Option<String>,
    /// Temperature \[°C\].
    pub temperature_c: Number,
    /// By measure and part.
    pub values: BTreeMap<String, Numbers>,
}
