//! What was fitted to an axis.

use crate::{Number, Numbers};
use serde::{Deserialize, Serialize};
use std::fmt;
use undrift_noise::{GaussMarkov, composite::CompositeFit};

/// An Allan deviation with its 68 % interval and what the terms make of it \[unit\].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Allan {
    /// Averaging times \[s\].
    pub tau_s: Vec<Number>,
    /// Overlapping Allan deviation.
    pub adev: Vec<Number>,
    /// Lower end of its interval.
    pub lower: Vec<Number>,
    /// Upper end of its interval.
    pub upper: Vec<Number>,
    /// Deviation of the terms fitted.
    pub fit: Vec<Number>,
    /// From where on they were fitted \[s\].
    pub fit_from_s: Number,
}

/// A row of Pandit and Wu's table.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct OrderRow {
    /// Its order.
    #[serde(flatten)]
    pub order: Order,
    /// Residual sum of squares \[unit²\].
    pub rss: Number,
    /// Akaike's criterion.
    pub aic: Number,
    /// ln(A/N) + 2r/N, as the source paper prints it: A the sum of squares, N samples, r parameters.
    pub aic_per_sample: Number,
    /// Bayesian criterion.
    pub bic: Number,
    /// Autoregressive coefficients.
    pub ar: Vec<Number>,
    /// Coefficients of the moving average.
    pub ma: Vec<Number>,
    /// F of the step to this row.
    pub f: Number,
    /// Its critical value at 5 %.
    pub f_critical: Number,
    /// What the source paper compares it with.
    pub f_paper: Number,
}

/// An F test of an order against a larger one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct OrderTest {
    /// The smaller order.
    pub smaller: Order,
    /// The larger one.
    pub larger: Order,
    /// F.
    pub f: Number,
    /// Its critical value at 5 %.
    pub f_critical: Number,
    /// Probability of a larger F, were it F-distributed.
    pub p_value: Number,
}

/// Orders of an ARMA model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Order {
    /// Autoregressive order.
    pub p: u64,
    /// Order of the moving average.
    pub q: u64,
}

impl From<(usize, usize)> for Order {
    fn from((p, q): (usize, usize)) -> Self {
        let (p, q) = (p as u64, q as u64);
        Self { p, q }
    }
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({},{})", self.p, self.q)
    }
}

/// The orders that Pandit and Wu's table chooses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct PanditWuOrders {
    /// By F, stepping down.
    pub by_f: Order,
    /// By Akaike's criterion.
    pub by_aic: Order,
    /// By the Bayesian criterion.
    pub by_bic: Order,
}

/// Criteria over a grid of orders.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct BoxJenkins {
    /// Samples fitted.
    pub samples: u64,
    /// Largest autoregressive order.
    pub p_max: u64,
    /// Largest order of the moving average.
    pub q_max: u64,
    /// The order that Akaike's criterion chooses.
    pub by_aic: Order,
    /// The order that its correction for few samples chooses.
    pub by_aicc: Order,
    /// The order that the Bayesian criterion chooses.
    pub by_bic: Order,
    /// All orders.
    pub grid: Vec<GridFit>,
}

/// Criteria of one order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct GridFit {
    /// Its order.
    #[serde(flatten)]
    pub order: Order,
    /// Logarithm of the likelihood.
    pub log_likelihood: Number,
    /// Akaike's criterion.
    pub aic: Number,
    /// Its correction for few samples.
    pub aicc: Number,
    /// Bayesian criterion.
    pub bic: Number,
}

/// A candidate model; by horizon: keys in whole seconds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Candidate {
    /// Name, such as "ARMA(1,1)".
    pub name: String,
    /// Whether it is a method of the literature or an order by F tests or AIC: scored for comparison, never recommended.
    pub compared: bool,
    /// States of its shaping filter, the turn-on constant's included.
    pub states: u64,
    /// Parameters fitted.
    pub parameters: u64,
    /// Akaike's criterion of block averages of the record, comparable among all candidates.
    pub block_aic: Number,
    /// Ljung and Box's p-value of its residuals.
    pub ljung_box_p: Number,
    /// Drift of the integral by horizon, root mean square, fitted on one half of the record and scored on the other, both ways \[unit·s\].
    pub drift_score: Numbers,
    /// Standard error of it \[unit·s\].
    pub drift_score_error: Numbers,
    /// What the model predicts \[unit·s\].
    pub drift_predicted: Numbers,
    /// Remarks on the fit, in sentences.
    pub warnings: Vec<String>,
    /// Autoregressive order, if it is an ARMA model.
    pub p: Option<u64>,
    /// Order of the moving average.
    pub q: Option<u64>,
    /// Autoregressive coefficients.
    pub ar: Option<Vec<Number>>,
    /// Coefficients of the moving average.
    pub ma: Option<Vec<Number>>,
    /// Standard deviation of the innovations \[unit\].
    pub sigma: Number,
    /// White noise \[unit/√Hz\].
    pub white: Number,
    /// Quantisation noise \[unit·s\].
    pub quantisation: Number,
    /// Random walk \[unit/√s\].
    pub random_walk: Number,
    /// Coefficient B of flicker noise \[unit\], for which the Gauss-Markov processes and the random walk then stand.
    pub flicker: Number,
    /// Gauss-Markov processes.
    pub gauss_markov: Vec<GaussMarkov>,
    /// Standard deviation of the turn-on constant \[unit\].
    pub turn_on: Number,
    /// How it was fitted: "allan", "burg", "maximum likelihood" or, of likely models, "average"; of a method of the literature "power spectrum",
    /// "autocorrelation", "allan minimum" or "allan bound".
    pub method: String,
    /// What the fit reports of itself.
    #[serde(flatten)]
    pub origin: Option<Origin>,
    /// Why it is recommended, if it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// A method of the literature that has no model of the record.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct NotFitted {
    /// Name that its candidate would have.
    pub name: String,
    /// Why, as the rest of a sentence.
    pub reason: String,
}

/// What the record says of a parameter of the recommended model, with a probability of 95 %.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ParameterInterval {
    /// "N" \[unit/√Hz\], "Q" \[unit·s\], "K" \[unit/√s\], "B" \[unit\], or "σ" \[unit\] and "τ" \[s\] of a Gauss-Markov process,
    /// numbered if there are two.
    pub parameter: String,
    /// Most likely value, in the parameter's unit as the ends.
    pub estimate: Number,
    /// Lower end; 0 where the record does not bound it.
    pub low: Number,
    /// Upper end; null where the record does not bound it.
    pub high: Number,
}

/// What a fit reports of itself, by its method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum Origin {
    /// Maximum likelihood of an ARMA model.
    Arma(ArmaOrigin),
    /// Maximum likelihood of a composite model; that of block means, not comparable to an ARMA's.
    Composite(Box<CompositeFit>),
}

/// The fit of an ARMA model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ArmaOrigin {
    /// Logarithm of the likelihood.
    pub log_likelihood: f64,
    /// Akaike's criterion.
    pub aic: f64,
    /// Bayesian criterion.
    pub bic: f64,
    /// Standard errors of the coefficients.
    pub standard_errors: Option<Vec<Number>>,
    /// Whether a pole and a zero nearly cancel.
    pub near_cancelling: bool,
    /// Whether the likelihood is flat about its maximum.
    pub flat_likelihood: bool,
    /// Whether a pole is on the unit circle.
    pub unit_root: bool,
}
