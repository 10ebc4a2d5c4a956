//! The summary of many logs.

use super::{Number, Numbers};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Many logs.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Fleet {
    pub tasks: BTreeMap<String, u64>,
    pub failed: Vec<Trouble>,
    pub untrusted: Vec<Trouble>,
    pub warned: Vec<Warned>,
    pub outlier_rule: OutlierRule,
    pub measures: Vec<Measure>,
    pub logs: Vec<Log>,
}

/// What went wrong.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Trouble {
    pub log: String,
    pub unit: Option<String>,
    pub part: Option<String>,
    pub why: String,
}

/// What should be said of a log.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Warned {
    pub log: String,
    pub unit: Option<String>,
    pub warnings: Vec<String>,
}

/// When a value is an outlier.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct OutlierRule {
    pub deviations: Number,
    pub share: Number,
    pub least: u64,
}

/// A number of every log that is compared.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Measure {
    pub name: String,
    pub what: String,
    pub unit: String,
    pub parts: Vec<Part>,
    pub best: BTreeMap<String, u64>,
    pub by_unit: Vec<Group>,
    pub by_sensor: Vec<Group>,
}

/// A bias model or axis over all logs.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Part {
    pub part: String,
    pub logs: u64,
    pub median: Number,
    pub limit: Number,
    pub outliers: Vec<Outlier>,
    pub temperature: Temperature,
}

/// A log that stands out.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Outlier {
    pub log: String,
    pub unit: Option<String>,
    pub temperature_c: Number,
    pub value: Number,
    pub times_median: Number,
}

/// How a number goes with temperature.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Temperature {
    pub correlation: Number,
    pub bound: Number,
    pub bins: Vec<Bin>,
}

/// Logs of about the same temperature.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Bin {
    pub from_c: Number,
    pub to_c: Number,
    pub logs: u64,
    pub median: Number,
}

/// Logs of one unit or sensor.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Group {
    pub name: String,
    pub logs: u64,
    pub median: Numbers,
    pub outlying: Vec<String>,
}

/// One log's numbers.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Log {
    pub log: String,
    pub unit: Option<String>,
    pub temperature_c: Number,
    pub values: BTreeMap<String, Numbers>,
}
