//! An identified static record. Of an axis "unit" is rad/s or m/s².

mod doubt;
mod fits;
mod pool;
mod used;

pub use doubt::AxisDoubt;
pub use fits::{
    Allan, ArmaOrigin, BoxJenkins, Candidate, GridFit, NotFitted, Order, OrderRow, OrderTest,
    Origin, PanditWuOrders, ParameterInterval,
};

pub use pool::{AxisPool, Differing, Pool, PooledRecord, RecordShare, TurnOn};
pub use used::{Omission, Omitted, Used};

use super::{Curve, Number};
use serde::{Deserialize, Serialize, Serializer};
use std::collections::BTreeMap;
use undrift_noise::{
    allan,
    identify::Detrend,
    model_file::AXES,
    normality,
    scales::Scales,
    screening::{Hanging, Motion, Outlier, Saturation, Timing},
    spectrum::Line,
    stationarity::{self, Kpss, PhillipsPerron},
    whiteness::Portmanteau,
};

/// An identified record.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, tag = "kind", rename = "identify")]
pub struct Identify {
    /// Version of the program.
    pub undrift: String,
    /// Version of this schema.
    pub schema: u32,
    /// What the record is called.
    pub record: String,
    /// Sample rate \[Hz\].
    pub rate_hz: Number,
    /// Timing from the time stamps, where there are any.
    pub timing: Option<Timing>,
    /// Rows of the record that were skipped.
    pub skipped_rows: u64,
    /// The parts of recordings that were used, of those that were not used whole.
    pub used: Vec<Used>,
    /// Units of raw counts whose range is a guess, as `--units` states them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub guessed_units: Option<String>,
    /// Each axis by name: `gyro_x` … `accel_z`.
    #[serde(serialize_with = "axes")]
    pub axes: BTreeMap<String, Axis>,
    /// What several records show beyond their common model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pool: Option<Pool>,
}

impl Identify {
    /// The axes in the order of a sensor.
    pub fn in_order(&self) -> impl Iterator<Item = (&str, &Axis)> {
        in_order(&self.axes)
    }
}

/// What is known by axis, in the order of a sensor; other names last.
fn in_order<T>(axes: &BTreeMap<String, T>) -> impl Iterator<Item = (&str, &T)> {
    let known = AXES.iter().filter_map(|name| axes.get_key_value(*name));
    let others = axes
        .iter()
        .filter(|(name, _)| !AXES.contains(&name.as_str()));
    known.chain(others).map(|(name, of)| (name.as_str(), of))
}

/// Of an axis that has an error there is nothing else.
fn axes<S: Serializer>(axes: &BTreeMap<String, Axis>, serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    #[serde(untagged)]
    enum AxisOrError<'a> {
        Error { error: &'a String },
        Axis(&'a Axis),
    }
    serializer.collect_map(axes.iter().map(|(name, axis)| match &axis.error {
        Some(error) => (name, AxisOrError::Error { error }),
        None => (name, AxisOrError::Axis(axis)),
    }))
}

/// One axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Axis {
    /// Why nothing was found of it, if so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Samples.
    pub samples: u64,
    /// Their mean \[unit\].
    pub mean: Number,
    /// "rad/s" or "m/s^2".
    pub unit: String,
    /// What was taken out beside the mean.
    pub detrend: Detrend,
    /// How the bias goes with temperature, where the recording has one that changes.
    pub temperature: Option<AxisTemperature>,
    /// Samples that were taken for outliers \[unit\].
    pub outliers: Vec<Outlier>,
    /// Whether the sensor moved.
    pub moving: Option<bool>,
    /// Where it moved.
    pub motion: Option<Motion>,
    /// Values at which the sensor is saturated \[unit\].
    pub saturation: Vec<Saturation>,
    /// Where the sensor repeats a value.
    pub hanging: Vec<Hanging>,
    /// Where the mean stays amid a step larger than the noise, the share of the noise at another mean that shows.
    pub noise_shown: Option<Number>,
    /// Augmented Dickey-Fuller test at fixed lags, and by rules that choose them.
    pub adf: Adf,
    /// Kwiatkowski-Phillips-Schmidt-Shin test.
    pub kpss: Kpss,
    /// Phillips-Perron test.
    pub phillips_perron: PhillipsPerron,
    /// The conclusion from these three, as a sentence.
    pub stationarity: String,
    /// Jarque-Bera test of normality.
    pub jarque_bera: normality::Test,
    /// Kolmogorov-Smirnov test of normality.
    pub ks: normality::Test,
    /// Lilliefors' test of normality.
    pub lilliefors: normality::Test,
    /// Skewness, 0 of a normal distribution.
    pub skewness: Number,
    /// Kurtosis beyond that of a normal distribution.
    pub kurtosis_excess: Number,
    /// Step of the grid that the samples lie on \[unit\].
    pub quantisation_step: Number,
    /// Autocorrelation at lags 0, 1, …
    pub acf: Vec<Number>,
    /// Partial autocorrelation at lags 0, 1, …
    pub pacf: Vec<Number>,
    /// Ljung and Box's test of whiteness.
    pub ljung_box: Portmanteau,
    /// Lines and narrow resonances of the spectrum, taken out of the record before all tests and fits.
    pub lines: Vec<Line>,
    /// Allan deviation.
    pub allan: Allan,
    /// The terms fitted to it.
    pub allan_terms: allan::Terms,
    /// Pandit and Wu's table of ARMA(2n, 2n−1).
    pub pandit_wu: Vec<OrderRow>,
    /// The F tests of the source paper's adequacy: (1,1) against (2,1), (2,1) against (3,2), (1,1) against (3,2).
    pub adequacy: Vec<OrderTest>,
    /// The orders that it chooses.
    pub pandit_wu_orders: Option<PanditWuOrders>,
    /// The grid of orders of Box and Jenkins.
    pub box_jenkins: Option<BoxJenkins>,
    /// Fits to block averages.
    pub scales: Option<Scales>,
    /// Models of the axis.
    pub candidates: Vec<Candidate>,
    /// Their names, the least drift first.
    pub ranking: Vec<String>,
    /// The recommended one.
    pub chosen: Candidate,
    /// 95 % intervals of its parameters, if it is a sum of terms.
    #[serde(default)]
    pub intervals: Vec<ParameterInterval>,
    /// Methods of the literature that have no model of the axis.
    pub not_fitted: Vec<NotFitted>,
    /// Remarks on the axis, in sentences.
    pub warnings: Vec<String>,
    /// For plots.
    pub series: AxisSeries,
}

/// A bias that goes with temperature, `slope·(T − reference) + quadratic·(T − reference)²`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct AxisTemperature {
    /// Whether it is significant; then it was taken out, and is in the model.
    pub determined: bool,
    /// [°C]
    pub reference_c: Number,
    /// Lowest and highest temperature of the recording [°C].
    pub range_c: [Number; 2],
    /// \[unit/K\]
    pub slope: Number,
    /// Its 95 % interval \[unit/K\].
    pub slope_interval: [Number; 2],
    /// \[unit/K²\], where the likelihood wants it.
    pub quadratic: Option<Number>,
    /// Its 95 % interval \[unit/K²\].
    pub quadratic_interval: Option<[Number; 2]>,
    /// The noise that the intervals are of.
    pub noise: String,
    /// Share of the variance of block averages that it explains.
    pub explained: Number,
}

/// The augmented Dickey-Fuller test.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Adf {
    /// At fixed lags.
    #[serde(flatten)]
    pub fixed: stationarity::Adf,
    /// By the rules that choose them.
    pub by_rule: BTreeMap<String, stationarity::Adf>,
}

/// For the plots of an axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct AxisSeries {
    /// The record over time \[unit\].
    pub record: Curve,
    /// Its distribution.
    pub histogram: Histogram,
    /// Its power spectral density.
    pub psd: Option<Psd>,
    /// 95 % bound of the correlations of white noise.
    pub correlation_bound: Number,
    /// What the models leave.
    pub residuals: Vec<Residuals>,
}

/// A histogram and the normal distribution beside it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Histogram {
    /// Centres of the bars \[unit\].
    pub centre: Vec<Number>,
    /// Densities \[1/unit\].
    pub density: Vec<Number>,
    /// Width of a bar \[unit\].
    pub width: Number,
    /// Mean of the normal distribution \[unit\].
    pub mean: Number,
    /// Its standard deviation \[unit\].
    pub sigma: Number,
}

/// A one-sided power spectral density.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Psd {
    /// Frequencies \[Hz\].
    pub frequency_hz: Vec<Number>,
    /// Densities \[unit²/Hz\].
    pub density: Vec<Number>,
}

/// What a model leaves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Residuals {
    /// Name of the model.
    pub model: String,
    /// Samples.
    pub samples: u64,
    /// Autocorrelation at lags 0, 1, …
    pub acf: Vec<Number>,
    /// Partial autocorrelation at lags 0, 1, …
    pub pacf: Vec<Number>,
    /// 95 % bound of both where the model is right.
    pub bound: Number,
}
