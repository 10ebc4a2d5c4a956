//! ARMA models: fits, likelihood, simulation.

mod fit;

pub use fit::Fit;

use crate::array::{Array, Record, samples};
use crate::{error::error, work};
use pyo3::prelude::*;
use undrift::nav::shaping::ShapingFilter;
use undrift::noise::arma::{self, ArFit, ArmaError, ArmaFit, FitOptions, Mean, Root};
use undrift::noise::synthesis::NoiseGenerator;

fn mean_of(known: Option<f64>) -> Mean {
    known.map_or(Mean::Estimated, Mean::Known)
}

/// How to fit; without a mean it is estimated.
pub fn options(mean: Option<f64>, unit_root: bool, effort: f64) -> FitOptions {
    FitOptions {
        mean: mean_of(mean),
        unit_root,
        effort,
    }
}

#[pyfunction]
pub fn arma_fit(
    py: Python<'_>,
    x: Record<'_>,
    order: (usize, usize),
    mean: Option<f64>,
    unit_root: bool,
    effort: f64,
    starts: Vec<(Vec<f64>, Vec<f64>)>,
) -> PyResult<Fit> {
    let x = samples(&x)?;
    let options = options(mean, unit_root, effort);
    work::run(py, || {
        arma::fit_from(x, order.0, order.1, &options, &starts)
    })?
    .map(Fit::from)
    .map_err(error)
}

#[pyfunction]
pub fn arma_residuals(py: Python<'_>, fit: Fit, x: Record<'_>) -> PyResult<Array<f64>> {
    let x = samples(&x)?;
    let fit = ArmaFit::from(fit);
    py.detach(|| fit.residuals(x)).map(Array).map_err(error)
}

#[derive(IntoPyObject)]
pub struct Likelihood {
    log_likelihood: f64,
    sum_of_squares: f64,
    sigma2: f64,
    mean: f64,
    mean_standard_error: f64,
    n: usize,
}

#[pyfunction]
pub fn arma_log_likelihood(
    py: Python<'_>,
    x: Record<'_>,
    ar: Vec<f64>,
    ma: Vec<f64>,
    mean: Option<f64>,
    unit_root: bool,
) -> PyResult<Likelihood> {
    let x = samples(&x)?;
    let at = py
        .detach(|| arma::log_likelihood(x, &ar, &ma, mean_of(mean), unit_root))
        .map_err(error)?;
    Ok(Likelihood {
        log_likelihood: at.log_likelihood,
        sum_of_squares: at.sum_of_squares,
        sigma2: at.variance,
        mean: at.mean,
        mean_standard_error: at.mean_standard_error,
        n: at.observations,
    })
}

#[derive(IntoPyObject)]
pub struct Profile {
    estimate: f64,
    low: f64,
    high: f64,
}

#[pyfunction]
pub fn arma_profile_interval(
    py: Python<'_>,
    x: Record<'_>,
    fit: Fit,
    root: &str,
    level: f64,
) -> PyResult<Profile> {
    let x = samples(&x)?;
    let root = match root {
        "ar" => Root::Ar,
        "ma" => Root::Ma,
        _ => return Err(error(format!("unknown root {root:?}; available: ar, ma"))),
    };
    let fit = ArmaFit::from(fit);
    let interval =
        work::run(py, || arma::profile_interval(x, &fit, root, level))?.map_err(error)?;
    Ok(Profile {
        estimate: interval.estimate,
        low: interval.low,
        high: interval.high,
    })
}

#[pyfunction]
pub fn arma_simulate(
    py: Python<'_>,
    n: usize,
    ar: Vec<f64>,
    ma: Vec<f64>,
    sigma: f64,
    mean: f64,
    seed: u64,
) -> PyResult<Array<f64>> {
    // The interval plays no part in an ARMA at its own rate.
    let filter = ShapingFilter::arma(&ar, &ma, sigma, 1.0).map_err(error)?;
    let mut record = Vec::new();
    record
        .try_reserve_exact(n)
        .map_err(|_| error(format!("not enough memory for {n} samples")))?;
    py.detach(|| {
        let noise = NoiseGenerator::new(&filter, seed);
        record.extend(noise.take(n).map(|value| mean + value));
    });
    Ok(Array(record))
}

#[derive(IntoPyObject)]
pub struct Autoregression {
    ar: Array<f64>,
    sigma2: f64,
    mean: f64,
    partial_autocorrelations: Array<f64>,
    sigma2_by_order: Array<f64>,
}

fn autoregression(fit: Result<ArFit, ArmaError>) -> PyResult<Autoregression> {
    let fit = fit.map_err(error)?;
    Ok(Autoregression {
        ar: Array(fit.ar),
        sigma2: fit.variance,
        mean: fit.mean,
        partial_autocorrelations: Array(fit.partial_autocorrelations),
        sigma2_by_order: Array(fit.variance_by_order),
    })
}

#[pyfunction]
pub fn ar_burg(py: Python<'_>, x: Record<'_>, p: usize) -> PyResult<Autoregression> {
    let x = samples(&x)?;
    autoregression(py.detach(|| arma::burg(x, p)))
}

#[pyfunction]
pub fn ar_yule_walker(py: Python<'_>, x: Record<'_>, p: usize) -> PyResult<Autoregression> {
    let x = samples(&x)?;
    autoregression(py.detach(|| arma::yule_walker(x, p)))
}

#[pyfunction]
pub fn ar_order(py: Python<'_>, x: Record<'_>, max_p: usize) -> PyResult<usize> {
    let x = samples(&x)?;
    py.detach(|| arma::order_by_aicc(x, max_p)).map_err(error)
}
