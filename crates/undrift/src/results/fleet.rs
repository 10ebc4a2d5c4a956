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
    /// Logs by what was done with them: "outages", "navigate" or "identify".
    pub tasks: BTreeMap<String, u64>,
    /// Logs without a result.
    pub failed: Vec<Trouble>,
    /// Bias models and axes whose result is missing or cannot be trusted.
    pub untrusted: Vec<Trouble>,
    /// Logs with warnings.
    pub warned: Vec<Warned>,
    /// When a value is an outlier.
    pub outlier_rule: OutlierRule,
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

/// A value is an outlier beyond this many robust standard deviations of the logarithm, …
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct OutlierRule {
    /// So many, …
    pub deviations: Number,
    /// … if it is above the median by this share too, …
    pub share: Number,
    /// … among this many values or more.
    pub least: u64,
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
    /// By bias model or axis.
    pub parts: Vec<FleetPart>,
    /// On how many of the logs that have all parts each one is the least.
    pub best: BTreeMap<String, u64>,
    /// By serial number of the IMU.
    pub by_unit: Vec<FleetGroup>,
    /// By noise model of the IMU.
    pub by_sensor: Vec<FleetGroup>,
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
    /// Value above which one is an outlier.
    pub limit: Number,
    /// The outliers, the largest first.
    pub outliers: Vec<FleetOutlier>,
    /// How the value goes with temperature.
    pub temperature: Temperature,
}

/// A log that stands out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FleetOutlier {
    /// The log.
    pub log: String,
    /// Serial number of its IMU.
    pub unit: Option<String>,
    /// Temperature \[°C\].
    pub temperature_c: Number,
    /// Its value.
    pub value: Number,
    /// Its value over the median.
    pub times_median: Number,
}

/// How a number goes with temperature.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Temperature {
    /// Spearman's rank correlation.
    pub correlation: Number,
    /// Its 95 % bound by chance where there is none.
    pub bound: Number,
    /// By temperature.
    pub bins: Vec<Bin>,
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

/// Logs of one unit or sensor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FleetGroup {
    /// The unit or sensor.
    pub name: String,
    /// Its logs.
    pub logs: u64,
    /// Their medians by part.
    pub median: Numbers,
    /// The parts in which it stands out.
    pub outlying: Vec<String>,
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
