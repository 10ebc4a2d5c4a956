//! Several records of one sensor or type, identified together. Of an axis "unit" is rad/s or m/s².

use super::Number;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What several records show beyond their common model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Pool {
    /// The records.
    pub records: Vec<PooledRecord>,
    /// Probability that records of one process are taken for different ones, of all records and axes together.
    pub false_alarm: Number,
    /// Whether no record differs from the others.
    pub homogeneous: bool,
    /// Whether the sensor was laid down differently between the records, which gravity shows: then the
    /// accelerometers have no `turn_on`. Null where three accelerometers are missing.
    pub moved: Option<bool>,
    /// Largest angle between the specific forces of two records \[rad\].
    pub tilt: Number,
    /// Each axis by name: `gyro_x` … `accel_z`.
    pub axes: BTreeMap<String, AxisPool>,
}

impl Pool {
    /// The axes in the order of a sensor.
    pub fn in_order(&self) -> impl Iterator<Item = (&str, &AxisPool)> {
        super::in_order(&self.axes)
    }
}

/// A record of several.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct PooledRecord {
    /// What it is called.
    pub record: String,
    /// Samples of an axis.
    pub samples: u64,
}

/// One axis of several records.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct AxisPool {
    /// The constant at turn-on, if the records determine it.
    pub turn_on: Option<TurnOn>,
    /// Likelihood ratio of each record's own noise against that of all, allowing for `inflation`.
    pub likelihood_ratio: Number,
    /// Its degrees of freedom.
    pub degrees_of_freedom: Number,
    /// How much the halves of a record differ over what the model allows, 1 at least.
    pub inflation: Number,
    /// Probability of a likelihood ratio as large in records of one process.
    pub p_value: Number,
    /// The records in order.
    pub records: Vec<RecordShare>,
    /// Those that differ.
    pub differing: Vec<Differing>,
}

/// The spread of the turn-on constant between records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct TurnOn {
    /// Switch-ons.
    pub records: u64,
    /// Degrees of freedom of `sigma`.
    pub degrees_of_freedom: u64,
    /// Standard deviation between switch-ons \[unit\], the uncertainty of each constant allowed for.
    pub sigma: Number,
    /// Lower end of its 95 % interval \[unit\].
    pub low: Number,
    /// Upper end \[unit\].
    pub high: Number,
    /// Constant common to all switch-ons \[unit\], gravity removed.
    pub common: Number,
    /// Root mean square of the standard errors of the constants \[unit\].
    pub within: Number,
    /// Standard deviation for a filter \[unit\], which starts from zero and knows only so many switch-ons.
    pub for_filter: Number,
}

/// What is found of one record on an axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct RecordShare {
    /// Mean \[unit\].
    pub mean: Number,
    /// Constant at the start by the common model \[unit\].
    pub constant: Number,
    /// Its standard error within the record \[unit\].
    pub constant_error: Number,
    /// White noise in multiples of that of the other records.
    pub white: Number,
    /// Slow part in multiples of that of the others; null where the model has none.
    pub slow: Number,
    /// Probability of a difference as large in records of one process.
    pub p_value: Number,
    /// Outliers.
    pub outliers: u64,
    /// Groups of outliers a second and more apart.
    pub outlier_events: u64,
}

/// How a record differs from the others.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Differing {
    /// What it is called.
    pub record: String,
    /// The other record, where there are only two: either may be the unusual one.
    pub other: Option<String>,
    /// White noise in multiples of theirs; null where that does not differ.
    pub white: Number,
    /// Slow part in multiples of theirs.
    pub slow: Number,
    /// Rate of outliers in multiples of theirs; -1 where they have none, null where that does not differ.
    pub outliers: Number,
    /// Probability of such a difference in records of one process.
    pub p_value: Number,
}
