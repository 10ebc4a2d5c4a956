//! A fit between Python and Rust.

use crate::array::Array;
use pyo3::prelude::*;
use undrift::noise::arma::ArmaFit;
use undrift_report::say;

/// A fit on its way out, and back in for what is asked of it again.
#[derive(FromPyObject, IntoPyObject)]
pub struct Fit {
    ar: Array<f64>,
    ma: Array<f64>,
    sigma: f64,
    sigma2: f64,
    mean: f64,
    mean_standard_error: f64,
    log_likelihood: f64,
    residual_sum_of_squares: f64,
    parameters: usize,
    aic: f64,
    aicc: f64,
    bic: f64,
    standard_errors: Option<Array<f64>>,
    covariance: Option<Array<f64>>,
    n: usize,
    has_unit_root: bool,
    local_optima: usize,
    converged: bool,
    pair_likelihood_ratio: Option<f64>,
    near_cancelling: bool,
    flat_likelihood: bool,
    unit_root: bool,
    warnings: Vec<String>,
}

impl From<ArmaFit> for Fit {
    fn from(fit: ArmaFit) -> Self {
        Self {
            ar: Array(fit.ar),
            ma: Array(fit.ma),
            sigma: fit.sigma,
            sigma2: fit.variance,
            mean: fit.mean,
            mean_standard_error: fit.mean_standard_error,
            log_likelihood: fit.log_likelihood,
            residual_sum_of_squares: fit.residual_sum_of_squares,
            parameters: fit.parameters,
            aic: fit.aic,
            aicc: fit.aicc,
            bic: fit.bic,
            standard_errors: fit.standard_errors.map(Array),
            covariance: fit.covariance.map(Array),
            n: fit.n,
            has_unit_root: fit.has_unit_root,
            local_optima: fit.local_optima,
            converged: fit.converged,
            pair_likelihood_ratio: fit.pair_likelihood_ratio,
            near_cancelling: fit.near_cancelling,
            flat_likelihood: fit.flat_likelihood,
            unit_root: fit.unit_root,
            warnings: fit.warnings.iter().map(say::arma).collect(),
        }
    }
}

impl From<Fit> for ArmaFit {
    /// With what residuals and intervals are made of.
    fn from(fit: Fit) -> Self {
        Self {
            ar: fit.ar.0,
            ma: fit.ma.0,
            sigma: fit.sigma,
            mean: fit.mean,
            log_likelihood: fit.log_likelihood,
            parameters: fit.parameters,
            standard_errors: fit.standard_errors.map(|errors| errors.0),
            n: fit.n,
            has_unit_root: fit.has_unit_root,
            ..Self::default()
        }
    }
}
