//! What is left of a record when a model has predicted it: white where the model is right.
//!
//! Under the right model correlations at lags ≥ 1 lie within ±1.96/√n 95 times in 100. A slow bias
//! far below white noise does not show in them (docs/theory.md, section 1): white residuals do not
//! prove a model.

use super::{LAGS, SEARCH_SAMPLES};
use crate::{
    arma::ArmaFit,
    correlation::{self, Partial},
    pandit_wu::PanditWu,
};

/// Correlations of the one-step prediction errors of a model over the samples it was searched on.
#[derive(Clone, Debug, PartialEq)]
pub struct Residuals {
    /// Name of the model, such as "ARMA(2,1)".
    pub model: String,
    /// Samples.
    pub samples: usize,
    /// Autocorrelation at lags 0…[`LAGS`].
    pub acf: Vec<f64>,
    /// Partial autocorrelation at lags 0…[`LAGS`].
    pub pacf: Vec<f64>,
}

/// Of the model that the paper's procedure chose and, where that is another ARMA, of the recommended one.
pub(super) fn of_models(
    table: Option<&PanditWu>,
    recommended: Option<&ArmaFit>,
    half: &[f64],
) -> Vec<Residuals> {
    let by_f = table.and_then(|table| table.fit(table.by_f));
    let other = |fit: &&ArmaFit| by_f.is_none_or(|by_f| by_f.order() != fit.order());
    let fits = by_f.into_iter().chain(recommended.filter(other));
    fits.filter_map(|fit| Residuals::new(fit, half)).collect()
}

impl Residuals {
    /// Of a fit over the start of a screened record, at most [`SEARCH_SAMPLES`] of it.
    /// `None` where φ is not stationary to working precision, or [`LAGS`] errors or fewer are present.
    ///
    /// `half` is the screened record \[unit\], NaN a missing sample.
    pub fn new(fit: &ArmaFit, half: &[f64]) -> Option<Self> {
        let searched = half.get(..SEARCH_SAMPLES).unwrap_or(half);
        let errors = fit.residuals(searched).ok()?;
        let present: Vec<f64> = errors.into_iter().filter(|e| e.is_finite()).collect();
        let (p, q) = fit.order();
        Some(Self {
            model: format!("ARMA({p},{q})"),
            samples: present.len(),
            acf: correlation::autocorrelation(&present, LAGS).ok()?,
            pacf: correlation::partial_autocorrelation(&present, LAGS, Partial::YuleWalker).ok()?,
        })
    }
}
