//! Fitting ARMA(p, q) by exact maximum likelihood, and what the optimum is worth.

use super::diagnosis;
use super::kalman;
use super::likelihood::{Likelihood, Mean, screen};
use super::model::ArmaFit;
use super::optimise::{SCALES, newton};
use super::polynomial::{is_stable, less_unit_root, multiply};
use super::search::{Ladder, Problem, TOLERANCE};
use super::{ArmaError, MAX_FIT_ORDER};
use crate::quasi_newton::{Objective, Point, Scales, bfgs};
use crate::screening::bridge::bridge;

/// How to fit.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{arma::{FitOptions, fit}, synthesis::NoiseGenerator};
/// // A random walk under white noise is an ARMA(1,1) with φ = 1: hold that root, and θ is all there is to find.
/// let process = ShapingFilter::arma(&[1.0], &[0.9], 1e-3, 0.01)?;
/// let record: Vec<f64> = NoiseGenerator::new(&process, 1).take(3000).collect();
/// let model = fit(&record, 1, 1, &FitOptions { unit_root: true, ..FitOptions::default() })?;
/// assert_eq!(model.ar, [1.0]);
/// assert!((model.ma[0] - 0.9).abs() < 4.0 * ((1.0 - 0.81_f64) / 3000.0).sqrt()); // Its standard error, √((1 − θ²)/N).
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
///
/// Of an AR(1) the first sample has the variance σ²/(1 − φ²) of the process, and a sample after a missing one
/// that of a prediction over two steps, σ² (1 + φ²):
///
/// ```
/// use undrift_noise::arma::{Mean, log_likelihood};
/// let squares = |x: &[f64]| log_likelihood(x, &[0.5], &[], Mean::Known(0.0), false).map(|at| at.sum_of_squares);
/// let whole = squares(&[1.0, 2.0, 1.5])?;
/// assert!((whole - (0.75 * 1.0 + 1.5 * 1.5 + 0.5 * 0.5)).abs() < 1e-12);
/// let missing = squares(&[1.0, f64::NAN, 1.5, 0.75])?;
/// assert!((missing - (0.75 * 1.0 + 1.25 * 1.25 / 1.25)).abs() < 1e-12);
/// # Ok::<(), undrift_noise::arma::ArmaError>(())
/// ```
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
        bridged: None,
        unit_root,
        rest: &[],
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
    let found = if problem.gaps {
        kalman::filtered(samples, mean, centre, ar, ma, unit_root)
    } else {
        problem.likelihood(ar, ma)
    };
    found.ok_or(ArmaError::NotStationary)
}

/// φ with the factor (1 − B) divided out, or `None` where 1 is not a root.
fn without_unit_root(ar: &[f64]) -> Option<Vec<f64>> {
    let sum: f64 = ar.iter().sum();
    if ar.is_empty() || sum.is_nan() || (sum - 1.0).abs() >= 1e-12 {
        return None;
    }
    Some(less_unit_root(ar))
}

/// ARMA(p, q) by exact maximum likelihood: many starts, best optimum, its curvature and its faults.
///
/// A record of 2 000 000 samples takes seconds for (1,1). NaN marks missing samples (slower).
///
/// Read [`ArmaFit::warnings`] with the coefficients: where a pair of roots nearly cancels or a root is near 1, they are poorly
/// determined and their standard errors say little ([`super::profile_interval`] is for that), while predictions may be good.
///
/// # Errors
/// A record too short for the order, constant or infinite; an order above [`MAX_FIT_ORDER`]; p = 0
/// with a unit root; an option outside its range.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{arma::{FitOptions, fit}, synthesis::NoiseGenerator};
/// let process = ShapingFilter::ar(&[0.9], 1e-3, 0.01)?;
/// let mut record: Vec<f64> = NoiseGenerator::new(&process, 1).take(2000).collect();
/// record.iter_mut().step_by(50).for_each(|lost| *lost = f64::NAN); // 2 % missing: no need to interpolate.
/// let model = fit(&record, 1, 0, &FitOptions::default())?;
/// let errors = model.standard_errors.as_ref().ok_or("no standard errors")?;
/// assert!((model.ar[0] - 0.9).abs() < 4.0 * errors[0] && model.n == 1960);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit(
    samples: &[f64],
    p: usize,
    q: usize,
    options: &FitOptions,
) -> Result<ArmaFit, ArmaError> {
    climb_to(samples, p, q, options, &[], &mut Ladder::default())
}

/// Does [`fit`] with further starts: coefficients (φ, θ) of models near which the optimum may lie,
/// of any order up to (p, q); missing coefficients count as zero.
///
/// # Errors
/// As [`fit`].
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{arma::{FitOptions, fit, fit_from}, synthesis::NoiseGenerator};
/// let process = ShapingFilter::arma(&[0.99], &[0.9], 1e-3, 0.01)?;
/// let record: Vec<f64> = NoiseGenerator::new(&process, 1).take(1000).collect();
/// let quick = FitOptions { effort: 0.05, ..FitOptions::default() };
/// // A start more cannot make the optimum worse.
/// let helped = fit_from(&record, 1, 1, &quick, &[(vec![0.99], vec![0.9])])?;
/// assert!(helped.log_likelihood > fit(&record, 1, 1, &quick)?.log_likelihood - 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit_from(
    samples: &[f64],
    p: usize,
    q: usize,
    options: &FitOptions,
    known: &[(Vec<f64>, Vec<f64>)],
) -> Result<ArmaFit, ArmaError> {
    fit_several(&[samples], p, q, options, known)
}

/// Fits several independent records of one process: the likelihood is the product of
/// theirs, each with a start and a mean of its own. The first should be the longest: it gives the starts of the
/// search and the mean reported. Further starts are `known`, as in [`fit_from`].
///
/// # Errors
/// As [`fit`], of any of the records; no record at all.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{arma::{FitOptions, fit, fit_several}, synthesis::NoiseGenerator};
/// let process = ShapingFilter::ar(&[0.5], 1e-3, 0.01)?;
/// let switched_on = |seed, constant: f64| -> Vec<f64> { NoiseGenerator::new(&process, seed).take(1500).map(|x| x + constant).collect() };
/// let (first, second) = (switched_on(1, 0.0), switched_on(2, 0.02));
/// let joint = fit_several(&[&first, &second], 1, 0, &FitOptions::default(), &[])?;
/// assert!((joint.ar[0] - 0.5).abs() < 0.1);
/// // One after the other, the step between their constants looks like a slow error.
/// let one = fit(&[first, second].concat(), 1, 0, &FitOptions::default())?;
/// assert!(one.ar[0] > 0.95);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit_several(
    records: &[&[f64]],
    p: usize,
    q: usize,
    options: &FitOptions,
    known: &[(Vec<f64>, Vec<f64>)],
) -> Result<ArmaFit, ArmaError> {
    climb(records, p, q, options, known, &mut Ladder::default())
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
    climb(&[samples], p, q, options, known, ladder)
}

/// The fit of several records, with the optima of other orders kept in `ladder`.
fn climb(
    records: &[&[f64]],
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
    let searched = p - usize::from(options.unit_root);
    let held = Held::new(records, (p, q), options)?;
    let rest = held.problems(1);
    let problem = held.problem(0, &rest);
    let start = |(phi, theta): &(Vec<f64>, Vec<f64>)| {
        diagnosis::padded_start(phi, theta, searched, q, options.unit_root)
    };
    let known: Vec<Vec<f64>> = known.iter().filter_map(start).collect();
    if !(1e-3..=1e3).contains(&options.effort) {
        return Err(ArmaError::BadOption("the effort of the search"));
    }
    let found = ladder.climb(&problem, searched, q, options.effort, &known)?;
    let mut best = found.first().ok_or(ArmaError::NoOptimum)?.clone();
    let local_optima = found.len();
    let function = |z: &[Vec<f64>]| problem.objective(z, searched);
    let gradient = |z: &[f64]| problem.gradient(z, searched);
    let mut objective = Objective::new(&function, SCALES).with_gradient(&gradient);
    let covariance_z = newton(&mut objective, &mut best, TOLERANCE);
    let lower = ladder.below(searched, q);
    let (phi, theta) = problem.coefficients(&best.z, searched);
    let at = problem.likelihood(&phi, &theta);
    let mut at = at.ok_or(ArmaError::NoOptimum)?;
    let mut ar = phi;
    if !held.differences.is_empty() {
        ar = multiply(&ar, &[1.0]);
        let centre = held.screened[0].0;
        let free = kalman::with_gaps(records[0], Mean::Estimated, centre, &ar, &theta, true);
        (at.mean, at.mean_standard_error) =
            free.map_or((centre, 0.0), |l| (l.mean, l.mean_standard_error));
    }
    let estimates_mean = !options.unit_root && options.mean == Mean::Estimated;
    let means = if estimates_mean { records.len() } else { 0 };
    let parameters = searched + q + 1 + means;
    let mut fit = unexamined(ar, theta, &at, parameters);
    fit.has_unit_root = options.unit_root;
    fit.unit_root = options.unit_root;
    fit.local_optima = local_optima;
    fit.converged = best.converged;
    diagnosis::examine(&problem, &best, covariance_z, searched, lower, &mut fit);
    Ok(fit)
}

/// A search goes by the gradient of the bridged record where at most one in so many samples is missing.
const FEW: usize = 1000;

/// Records as the search sees them.
struct Held<'a> {
    records: &'a [&'a [f64]],
    /// Differences of unbroken records with a unit root, whose likelihood is that of the records.
    differences: Vec<Vec<f64>>,
    /// Records in which few samples are missing, bridged.
    bridged: Vec<Vec<f64>>,
    /// Where each is looked at from, and how many of its samples are present.
    screened: Vec<(f64, usize)>,
    options: FitOptions,
}

impl<'a> Held<'a> {
    fn new(
        records: &'a [&'a [f64]],
        (p, q): (usize, usize),
        options: &FitOptions,
    ) -> Result<Self, ArmaError> {
        if records.is_empty() {
            let (present, needed) = (0, p + q + 3);
            return Err(ArmaError::TooShort { present, needed });
        }
        let screened = records.iter().map(|samples| screen(samples, p + q));
        let screened: Vec<(f64, usize)> = screened.collect::<Result<_, _>>()?;
        let mut all = records.iter().zip(&screened);
        let missing = all.any(|(samples, (_, present))| *present < samples.len());
        let mut differences: Vec<Vec<f64>> = Vec::new();
        if options.unit_root && !missing {
            let less = |samples: &&[f64]| samples.windows(2).map(|w| w[1] - w[0]).collect();
            differences = records.iter().map(less).collect();
            for differences in &differences {
                screen(differences, p - 1 + q)?;
            }
        }
        let few = |(samples, (_, present)): (&&[f64], &(f64, usize))| {
            FEW * (samples.len() - present) <= samples.len()
        };
        let mut bridged = Vec::new();
        if missing && !options.unit_root && records.iter().zip(&screened).all(few) {
            let pairs = records.iter().zip(&screened);
            bridged = pairs
                .map(|(samples, (centre, _))| bridge(samples, *centre))
                .collect();
        }
        Ok(Self {
            records,
            differences,
            bridged,
            screened,
            options: *options,
        })
    }

    /// A record, with the further ones of its process.
    fn problem<'b>(&'b self, k: usize, rest: &'b [Problem<'b>]) -> Problem<'b> {
        let (centre, present) = self.screened[k];
        let samples = self.records[k];
        let options = &self.options;
        match self.differences.get(k) {
            Some(differences) => Problem {
                samples: differences,
                mean: Mean::Known(0.0),
                centre: 0.0,
                gaps: false,
                bridged: None,
                unit_root: false,
                rest,
            },
            None => Problem {
                samples,
                mean: options.mean,
                centre: match options.mean {
                    Mean::Known(value) if !options.unit_root => value,
                    _ => centre,
                },
                gaps: options.unit_root || present < samples.len(),
                bridged: self.bridged.get(k).map(Vec::as_slice),
                unit_root: options.unit_root,
                rest,
            },
        }
    }

    /// The records from `first` on, each alone.
    fn problems(&self, first: usize) -> Vec<Problem<'_>> {
        (first..self.records.len())
            .map(|k| self.problem(k, &[]))
            .collect()
    }
}

/// Log-likelihood within which [`refit`] is at its optimum: far below what a record shows of its own parameters.
const NEAR: f64 = 1e-2;

/// Fits the order of `known` to other records of the same process, means estimated: the optimum next to `known`, without
/// standard errors and diagnosis.
///
/// # Errors
/// A record too short for the order, constant or infinite; no record at all.
pub(crate) fn refit(records: &[&[f64]], known: &ArmaFit) -> Result<ArmaFit, ArmaError> {
    let (p, q) = (known.ar.len(), known.ma.len());
    let options = FitOptions {
        unit_root: known.has_unit_root,
        ..FitOptions::default()
    };
    let held = Held::new(records, (p, q), &options)?;
    let rest = held.problems(1);
    let problem = held.problem(0, &rest);
    let searched = p - usize::from(options.unit_root);
    let start = diagnosis::padded_start(&known.ar, &known.ma, searched, q, options.unit_root);
    let function = |z: &[Vec<f64>]| problem.objective(z, searched);
    let scales = Scales {
        curved: true,
        ..SCALES
    };
    let gradient = |z: &[f64]| problem.gradient(z, searched);
    let mut objective = Objective::new(&function, scales).with_gradient(&gradient);
    let start = start.ok_or(ArmaError::NoOptimum)?;
    let start = Point::new(start.clone(), objective.at(&start));
    let found = bfgs(&mut objective, &start, NEAR, 60);
    let (mut ar, ma) = problem.coefficients(&found.z, searched);
    let at = problem.likelihood(&ar, &ma).ok_or(ArmaError::NoOptimum)?;
    if !held.differences.is_empty() {
        ar = multiply(&ar, &[1.0]);
    }
    Ok(unexamined(ar, ma, &at, known.parameters))
}

/// A fit of which nothing is known but its likelihood.
fn unexamined(ar: Vec<f64>, ma: Vec<f64>, at: &Likelihood, parameters: usize) -> ArmaFit {
    let (k, n) = (parameters as f64, at.observations as f64);
    let aic = -2.0 * at.log_likelihood + 2.0 * k;
    let small = 2.0 * k * (k + 1.0) / (n - k - 1.0);
    ArmaFit {
        ar,
        ma,
        sigma: at.variance.sqrt(),
        variance: at.variance,
        mean: at.mean,
        mean_standard_error: at.mean_standard_error,
        log_likelihood: at.log_likelihood,
        residual_sum_of_squares: at.sum_of_squares,
        parameters,
        aic,
        aicc: if small > 0.0 {
            aic + small
        } else {
            f64::INFINITY
        },
        bic: -2.0 * at.log_likelihood + k * n.ln(),
        n: at.observations,
        ..ArmaFit::default()
    }
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
