//! Numbers that may be missing.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use undrift_base::number::OrNull;

/// Numbers by name.
pub type Numbers = BTreeMap<String, Number>;

/// A number; a missing one is NaN here and null in JSON. Two missing numbers are equal.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(inline))]
#[serde(transparent)]
pub struct Number(#[serde(with = "OrNull")] pub f64);

impl Number {
    /// The number, if there is one.
    pub fn get(self) -> Option<f64> {
        self.0.is_finite().then_some(self.0)
    }
}

impl Default for Number {
    fn default() -> Self {
        Self(f64::NAN)
    }
}

impl PartialEq for Number {
    fn eq(&self, other: &Self) -> bool {
        self.get() == other.get()
    }
}

impl From<f64> for Number {
    fn from(value: f64) -> Self {
        Self(value)
    }
}

impl From<Option<f64>> for Number {
    fn from(value: Option<f64>) -> Self {
        value.map_or_else(Self::default, Self)
    }
}

/// Values by name. Unlike `collect`, it does not sort first: one copy less of the sort in the program for each use.
pub fn by_name<N: Into<String>, V: Into<W>, W>(
    pairs: impl IntoIterator<Item = (N, V)>,
) -> BTreeMap<String, W> {
    let mut map = BTreeMap::new();
    for (name, value) in pairs {
        map.insert(name.into(), value.into());
    }
    map
}

/// Numbers of plain values.
pub fn numbers(values: impl IntoIterator<Item = f64>) -> Vec<Number> {
    values.into_iter().map(Number).collect()
}
