//! Fitting ARMA(p, q) by exact maximum likelihood, and what the optimum is worth.

use super::diagnosis;
use super::kalman;
use super::likelihood::{Likelihood, Mean, screen};
use super::model::ArmaFit;
use super::optimise::{SCALES, newton};
use super::polynomial::{is_stable, multiply};
use super::search::{Ladder, Problem, TOLERANCE};
use super::{ArmaError, MAX_FIT_ORDER};
use crate::quasi_newton::Objective;

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// The record's mean: known, or estimated with the rest.
    pub mean: Mean,
    /// Fix one root of φ at exactly 1. The level is then free with a flat prior (diffuse start, so
    /// that an unbroken record has the likelihood of its differences) and `mean` is ignored.
    pub unit_root: bool,
    /// How hard to search, 1e-3 to 1e3: 1 is thorough. The number of likelihood evaluations is
    /// about proportional, with a floor for long records.
    pub effort: f64,
}

impl Default for FitOptions {
    /// Mean estimated, no unit root, full effort.
    fn default() -> Self {
        Self {
            mean: Mean::Estimated,
            unit_root: false,
            effort: 1.0,
        }
    }
}

/// Exact Gaussian log-likelihood at given coefficients, σ² at its best value for them, and the mean
/// too where it is [`Mean::Estimated`]. NaN marks a missing sample, exactly accounted for.
/// O(N) time; memory does not grow with the record.
///
/// With `unit_root`, φ must hold a root at 1 and is otherwise stationary; the level is diffuse.
///
/// # Errors
/// A record too short, constant or infinite; coefficients that are not stationary, or not inside the
/// invertible region (the likelihood of the invertible twin is the same: pass that).
pub fn log_likelihood(
    samples: &[f64],
    ar: &[f64],
    ma: &[f64],
    mean: Mean,
    unit_root: bool,
) -> Result<Likelihood, ArmaError> {
    if ar.len().max(ma.len()) > MAX_FIT_ORDER {
        return Err(ArmaError::OrderTooHigh);
    }
    if let Mean::Known(value) = mean
        && !value.is_finite()
    {
        return Err(ArmaError::NotFinite);
    }
    if !ma.iter().all(|c| c.is_finite()) || !is_stable(ma) {
        return Err(ArmaError::NotInvertible);
    }
    let stationary = if unit_root {
        without_unit_root(ar).is_some_and(|rest| is_stable(&rest))
    } else {
        is_stable(ar)
    };
    if !stationary {
        return Err(ArmaError::NotStationary);
    }
    let about = |centre, gaps| Problem {
        samples,
        mean,
        centre,
        gaps,
        unit_root,
    };
    // About a known mean one pass is enough: a missing or infinite sample leaves no likelihood.
    if mean != Mean::Estimated
        && !unit_root
        && samples.len() >= 3
        && samples.iter().any(|x| *x != samples[0])
        && let Some(likelihood) = about(0.0, false).likelihood(ar, ma)
    {
        return Ok(likelihood);
    }
    let (centre, present) = screen(samples, 0)?;
    let problem = about(centre, unit_root || present < samples.len());
    problem.likelihood(ar, ma).ok_or(ArmaError::NotStationary)
}

/// φ with the factor (1 − B) divided out, or `None` where 1 is not a root.
fn without_unit_root(ar: &[f64]) -> Option<Vec<f64>> {
    let sum: f64 = ar.iter().sum();
    if ar.is_empty() || sum.is_nan() || (sum - 1.0).abs() >= 1e-12 {
        return None;
    }
    // (1 − B)(1 − d1 B − …): d_k = φ_{k+1} + d_{k+1} from the end, i.e. tail sums with minus sign.
    let rest = (0..ar.len() - 1)
        .map(|k| -ar[k + 1..].iter().sum::<f64>())
        .collect();
    Some(rest)
}

/// ARMA(p, q) by exact maximum likelihood: many starts, best optimum, its curvature and its faults.
///
/// A record of 2 000 000 samples takes seconds for (1,1). NaN marks missing samples (slower).
///
/// # Errors
/// A record too short for the order, constant or infinite; an order above [`MAX_FIT_ORDER`]; p = 0
/// with a unit root; an option outside its range.
pub fn fit(
    samples: &[f64],
    p: usize,
    q: usize,
    options: &FitOptions,
) -> Result<ArmaFit, ArmaError> {
    climb_to(samples, p, q, options, &[], &mut Ladder::default())
}

/// As [`fit`], with further starts: coefficients (φ, θ) of models near which the optimum may lie,
/// of any order up to (p, q); missing coefficients count as zero.
///
/// # Errors
/// As [`fit`].
pub fn fit_from(
    samples: &[f64],
    p: usize,
    q: usize,
    options: &FitOptions,
    known: &[(Vec<f64>, Vec<f64>)],
) -> Result<ArmaFit, ArmaError> {
    climb_to(samples, p, q, options, known, &mut Ladder::default())
}

/// [`fit_from`] with the optima of other orders of the same record and options kept.
pub(crate) fn climb_to(
    samples: &[f64],
    p: usize,
    q: usize,
    options: &FitOptions,
    known: &[(Vec<f64>, Vec<f64>)],
    ladder: &mut Ladder,
) -> Result<ArmaFit, ArmaError> {
    if p.max(q) > MAX_FIT_ORDER {
        return Err(ArmaError::OrderTooHigh);
    }
    if options.unit_root && p == 0 {
        return Err(ArmaError::NoUnitRootWithoutAr);
    }
    if let Mean::Known(value) = options.mean
        && !value.is_finite()
    {
        return Err(ArmaError::NotFinite);
    }
    let (centre, present) = screen(samples, p + q)?;
    let gaps = present < samples.len();
    let differences: Vec<f64>;
    let searched = p - usize::from(options.unit_root);
    let problem = if options.unit_root && !gaps {
        differences = samples.windows(2).map(|w| w[1] - w[0]).collect();
        screen(&differences, searched + q)?;
        Problem {
            samples: &differences,
            mean: Mean::Known(0.0),
            centre: 0.0,
            gaps: false,
            unit_root: false,
        }
    } else {
        Problem {
            samples,
            mean: options.mean,
            centre: match options.mean {
                Mean::Known(value) if !options.unit_root => value,
                _ => centre,
            },
            gaps,
            unit_root: options.unit_root,
        }
    };
    let known: Vec<Vec<f64>> = known
        .iter()
        .filter_map(|(phi, theta)| {
            diagnosis::padded_start(phi, theta, searched, q, options.unit_root)
        })
        .collect();
    if !(1e-3..=1e3).contains(&options.effort) {
        return Err(ArmaError::BadOption("the effort of the search"));
    }
    let found = ladder.climb(&problem, searched, q, options.effort, &known)?;
    let mut best = found.first().ok_or(ArmaError::NoOptimum)?.clone();
    let local_optima = found.len();
    let function = |z: &[Vec<f64>]| problem.objective(z, searched);
    let covariance_z = newton(&mut Objective::new(&function, SCALES), &mut best, TOLERANCE);
    let lower = ladder.below(searched, q);
    let (phi, theta) = problem.coefficients(&best.z, searched);
    let at = problem
        .likelihood(&phi, &theta)
        .ok_or(ArmaError::NoOptimum)?;
    let mut ar = phi;
    let mut level = (at.mean, at.mean_standard_error);
    if options.unit_root && !gaps {
        ar = multiply(&ar, &[1.0]);
        let free = kalman::with_gaps(samples, Mean::Estimated, centre, &ar, &theta, true);
        level = free.map_or((centre, 0.0), |l| (l.mean, l.mean_standard_error));
    }
    let estimates_mean = !options.unit_root && options.mean == Mean::Estimated;
    let k = searched + q + 1 + usize::from(estimates_mean);
    let n = at.observations as f64;
    let deviance = -2.0 * at.log_likelihood;
    let small = 2.0 * (k * (k + 1)) as f64 / (n - k as f64 - 1.0);
    let aic = deviance + 2.0 * k as f64;
    let mut result = ArmaFit {
        ar,
        ma: theta,
        sigma: at.variance.sqrt(),
        variance: at.variance,
        mean: level.0,
        mean_standard_error: level.1,
        log_likelihood: at.log_likelihood,
        residual_sum_of_squares: at.sum_of_squares,
        parameters: k,
        aic,
        aicc: if small > 0.0 {
            aic + small
        } else {
            f64::INFINITY
        },
        bic: deviance + k as f64 * n.ln(),
        standard_errors: None,
        covariance: None,
        n: at.observations,
        has_unit_root: options.unit_root,
        local_optima,
        converged: best.converged,
        pair_likelihood_ratio: None,
        near_cancelling: false,
        flat_likelihood: false,
        unit_root: options.unit_root,
        warnings: Vec::new(),
    };
    diagnosis::examine(&problem, &best, covariance_z, searched, lower, &mut result);
    Ok(result)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_root_divides_out() {
        let ar = multiply(&[0.5, -0.3], &[1.0]);
        let rest = without_unit_root(&ar).unwrap();
        assert!((rest[0] - 0.5).abs() < 1e-15 && (rest[1] + 0.3).abs() < 1e-15);
        assert!(without_unit_root(&[0.9]).is_none());
    }
}
