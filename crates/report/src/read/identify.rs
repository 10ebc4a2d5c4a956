//! What a report needs of an identified record.

use super::{Curve, Number, Numbers};
use serde::Deserialize;
use std::collections::BTreeMap;

/// An identified record.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Identify {
    pub record: String,
    pub rate_hz: Number,
    pub skipped_rows: u64,
    pub axes: BTreeMap<String, Axis>,
}

/// One axis of it.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Axis {
    pub error: Option<String>,
    pub samples: u64,
    pub mean: Number,
    pub outliers: Vec<serde::de::IgnoredAny>,
    pub adf: Test,
    pub kpss: Test,
    pub phillips_perron: Test,
    pub stationarity: String,
    pub jarque_bera: Test,
    pub ks: Test,
    pub lilliefors: Test,
    pub skewness: Number,
    pub kurtosis_excess: Number,
    pub quantisation_step: Number,
    pub acf: Vec<Number>,
    pub pacf: Vec<Number>,
    pub ljung_box: Test,
    pub allan: Allan,
    pub allan_terms: BTreeMap<String, serde_json::Value>,
    pub pandit_wu: Vec<OrderRow>,
    pub candidates: Vec<Candidate>,
    pub ranking: Vec<String>,
    pub chosen: Chosen,
    pub warnings: Vec<String>,
    pub series: AxisSeries,
}

/// A statistical test.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Test {
    pub statistic: Number,
    pub p_value: Number,
    pub critical: Numbers,
    pub critical_5: Number,
}

/// An Allan deviation with its 68 % interval and what the terms make of it.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Allan {
    pub tau_s: Vec<Number>,
    pub adev: Vec<Number>,
    pub lower: Vec<Number>,
    pub upper: Vec<Number>,
    pub fit: Vec<Number>,
    pub fit_from_s: Number,
}

/// A row of the Pandit-Wu table.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct OrderRow {
    pub p: u64,
    pub q: u64,
    pub rss: Number,
    pub aic: Number,
    pub bic: Number,
    pub f: Number,
    pub f_critical: Number,
    pub f_paper: Number,
}

/// A candidate model.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Candidate {
    pub name: String,
    pub states: u64,
    pub parameters: u64,
    pub ljung_box_p: Number,
    pub drift_score: Numbers,
    pub drift_score_error: Numbers,
    pub drift_predicted: Numbers,
}

/// The recommended one.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Chosen {
    pub name: String,
    pub reason: String,
}

/// For the plots of an axis.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct AxisSeries {
    pub record: Curve,
    pub histogram: Histogram,
    pub psd: Option<Psd>,
    pub correlation_bound: Number,
    pub residuals: Vec<Residuals>,
}

/// A histogram and the normal distribution beside it.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Histogram {
    pub centre: Vec<Number>,
    pub density: Vec<Number>,
    pub mean: Number,
    pub sigma: Number,
}

/// A power spectral density.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Psd {
    pub frequency_hz: Vec<Number>,
    pub density: Vec<Number>,
}

/// What a model leaves.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Residuals {
    pub model: String,
    pub samples: u64,
    pub acf: Vec<Number>,
    pub pacf: Vec<Number>,
    pub bound: Number,
}
