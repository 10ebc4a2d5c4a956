//! The generalised method of wavelet moments.
//!
//! Weighted least squares `Σ w (ν̂² − ν²)²` with weights `w = edf/(2ν⁴)`, ν² the *fitted* curve:
//! weights from the record's own ν̂² favour the scales that happen to be low. Its fixed point is the
//! minimum of the χ² deviance `D = Σ edf (ν̂²/ν² − 1 − ln ν̂²/ν²)`, which is what is minimised, over
//! the logarithms of the terms. The scales are not independent (the Haar filter leaks), so standard
//! errors come from their covariance under the fitted model, `(JᵀWJ)⁻¹ JᵀWΣWJ (JᵀWJ)⁻¹` with J the
//! derivatives of ν²: Guerrier et al. 2013, theorem 3.
//!
//! Beside maximum likelihood it is fast, since the record is seen once, by the wavelet variance; it
//! loses precision where two terms share their scales, as a Gauss-Markov process whose τ is a third
//! of the record and a random walk do.

use super::scatter;
use super::{ModelCurve, WaveletPoint, WaveletVariance, drift_variance};
use crate::allan::nnls;
use crate::quasi_newton::{Objective, best_of};
use crate::terms::{CompositeError, CompositeTerms, GaussMarkov, SCALES, TermSet, sort_processes};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Ratio of neighbouring correlation times on the grid of starts.
const GRID: f64 = 3.0;
/// Starts that are finished.
const FINISHED: usize = 4;
/// Share of the curve that a term left out of a start is given in it, at the scale of its largest.
const TRACE: f64 = 1e-3;

/// Composite terms fitted to a wavelet variance.
///
/// A deviance far above the degrees of freedom says that the set of terms lacks one, or that the record has a
/// line or a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MomentFit {
    /// The terms, Gauss-Markov processes by growing τ.
    pub terms: CompositeTerms,
    /// Drift |R| [unit/s]; 0 where it was not asked for.
    #[serde(skip)]
    pub drift: f64,
    /// Standard errors of the logarithms of each parameter; none where some direction is not
    /// determined.
    pub relative_errors: Option<CompositeTerms>,
    /// `Σ edf (ν̂²/ν² − 1 − ln ν̂²/ν²)`: of the size of the degrees of freedom where the model holds.
    pub deviance: f64,
    /// Scales less parameters.
    pub degrees_of_freedom: usize,
    /// Whether the search met its tolerance.
    #[serde(skip)]
    pub converged: bool,
}

/// Fits the terms of `set`, and with `drift` a deterministic drift R, to a wavelet variance, from
/// starts by non-negative least squares on a grid of correlation times.
///
/// ```
/// use undrift_noise::composite::{CompositeTerms, TermSet};
/// use undrift_noise::{synthesis::NoiseGenerator, wavelet::{fit_moments, wavelet_variance}};
/// let truth = CompositeTerms { white: 0.01, random_walk: 0.002, ..CompositeTerms::default() };
/// let record: Vec<f64> = NoiseGenerator::new(&truth.to_shaping(0.01)?, 1).take(50_000).collect();
/// let set = TermSet { white: true, random_walk: true, ..TermSet::default() };
/// let found = fit_moments(&wavelet_variance(&record, 0.01)?, set, false)?;
/// assert!((found.terms.white / 0.01 - 1.0).abs() < 0.02);
/// assert!((found.terms.random_walk / 0.002).ln().abs() < 0.3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// An empty set or too many processes; fewer scales than parameters.
///
/// The result is in SI terms of the record's unit: N [unit·√s], K [unit/√s], B \[unit\], Q
/// [unit·s], σ \[unit\], τ \[s\]. τ is searched from a twentieth of the interval to a thousand
/// records.
pub fn fit_moments(
    curve: &WaveletVariance,
    set: TermSet,
    drift: bool,
) -> Result<MomentFit, CompositeError> {
    set.check()?;
    let parameters = set.parameters() + usize::from(drift);
    let used: Vec<WaveletPoint> = curve.points.iter().copied().filter(usable).collect();
    if used.len() < parameters {
        return Err(CompositeError::TooShort {
            present: curve.samples,
            needed: 4 << parameters,
        });
    }
    let interval = curve.interval;
    // What does not change shape is computed once.
    let unit = CompositeTerms {
        flicker: f64::from(u8::from(set.flicker)),
        ..CompositeTerms::default()
    };
    let unit = ModelCurve::new(&unit, interval);
    let flicker: Vec<f64> = used.iter().map(|point| unit.at(point.m)).collect();
    let longest = 1e3 * curve.samples as f64 * interval;
    let tau_range = (0.05 * interval).ln()..longest.ln();
    let count = set.parameters();
    let found = |z: &[f64]| {
        let rate = if drift { z[count].exp() } else { 0.0 };
        (set.terms(&z[..count]), rate)
    };
    let cost = |z: &Vec<f64>| {
        let taus = &z[set.amplitudes()..count];
        if taus.iter().any(|t| !tau_range.contains(t)) || z.iter().any(|v| v.abs() > 300.0) {
            return f64::INFINITY;
        }
        let (terms, rate) = found(z);
        0.5 * deviance(&used, &terms, &flicker, rate, interval)
    };
    let costs = |z: &[Vec<f64>]| z.iter().map(cost).collect();
    let mut objective = Objective::new(&costs, SCALES);
    let starts = grid(&used, set, drift, interval);
    let best =
        best_of(&mut objective, starts, FINISHED, 1e-7, 200).ok_or(CompositeError::NoOptimum)?;
    // The drift is last: its row and column are passed over.
    let mut relative = sandwich(&used, &best.z, found, curve).map(|all| set.relative_errors(&all));
    let mut terms = set.terms(&best.z[..count]);
    sort_processes(&mut terms, relative.as_mut());
    Ok(MomentFit {
        terms,
        drift: found(&best.z).1,
        relative_errors: relative,
        deviance: 2.0 * best.value,
        degrees_of_freedom: used.len() - parameters,
        converged: best.converged,
    })
}

/// A scale counts where its variance and degrees of freedom are positive.
fn usable(point: &WaveletPoint) -> bool {
    point.variance > 0.0 && point.edf.is_finite() && point.edf > 0.0
}

/// `flicker`: its variances at the points with B = 1.
///
/// `drift` R [unit/s]; +∞ where the model's variance is not positive at some scale.
fn deviance(
    points: &[WaveletPoint],
    terms: &CompositeTerms,
    flicker: &[f64],
    drift: f64,
    interval: f64,
) -> f64 {
    let rest = CompositeTerms {
        flicker: 0.0,
        ..*terms
    };
    let rest = ModelCurve::new(&rest, interval);
    let mut sum = 0.0;
    for (point, flicker) in points.iter().zip(flicker) {
        let model = rest.at(point.m)
            + terms.flicker * terms.flicker * flicker
            + drift_variance(drift, point.scale_s);
        // The closed forms may leave a rounding below 0 of a process that is nearly absent.
        if model.is_nan() || model <= 0.0 {
            return f64::INFINITY;
        }
        let ratio = point.variance / model;
        sum += point.edf * (ratio - 1.0 - ratio.ln());
    }
    sum
}

/// Covariance of the search coordinates; none where the moments do not determine them all.
///
/// (JᵀWJ)⁻¹ JᵀWΣWJ (JᵀWJ)⁻¹ by central differences of the logarithms of the parameters.
fn sandwich(
    points: &[WaveletPoint],
    z: &[f64],
    found: impl Fn(&[f64]) -> (CompositeTerms, f64),
    curve: &WaveletVariance,
) -> Option<DMatrix<f64>> {
    let interval = curve.interval;
    let model = |z: &[f64]| -> Vec<f64> {
        let (terms, rate) = found(z);
        let curve = ModelCurve::new(&terms, interval);
        let at = |p: &WaveletPoint| curve.at(p.m) + drift_variance(rate, p.scale_s);
        points.iter().map(at).collect()
    };
    let at = model(z);
    let mut moved = z.to_vec();
    // W^½ J: the derivative of ν² over its scatter ν² √(2/edf).
    let mut slopes = DMatrix::zeros(points.len(), z.len());
    for j in 0..z.len() {
        for (sign, step) in [(1.0, 1e-4), (-1.0, -1e-4)] {
            moved[j] = z[j] + step;
            for (i, value) in model(&moved).iter().enumerate() {
                slopes[(i, j)] += sign * value / 2e-4;
            }
        }
        moved[j] = z[j];
    }
    let mut scatter = scatter::covariance(points, &found(z).0, interval, curve.samples);
    for (i, point) in points.iter().enumerate() {
        let weight = (0.5 * point.edf).sqrt() / at[i];
        slopes.row_mut(i).scale_mut(weight);
        scatter.row_mut(i).scale_mut(weight);
        scatter.column_mut(i).scale_mut(weight);
    }
    let normal: DMatrix<f64> = slopes.transpose() * &slopes;
    let inverse = normal.cholesky()?.inverse();
    let all: DMatrix<f64> = &inverse * slopes.transpose() * scatter * slopes * &inverse;
    all.iter().all(|v| v.is_finite()).then_some(all)
}

/// Starts: for correlation times of a grid, the amplitudes by non-negative least squares.
///
/// Correlation times in steps of 3 from half an interval to 20 times the longest scale, every pair
/// of them for two processes. An amplitude that least squares put at zero starts at a trace, so
/// that a search may raise it.
fn grid(points: &[WaveletPoint], set: TermSet, drift: bool, interval: f64) -> Vec<Vec<f64>> {
    let last = points.last().map_or(0.0, |p| p.scale_s);
    let mut taus = Vec::new();
    let mut tau = 0.5 * interval;
    while tau < 20.0 * last {
        taus.push(tau);
        tau *= GRID;
    }
    let mut choices: Vec<Vec<f64>> = match set.gauss_markov {
        0 => vec![Vec::new()],
        1 => taus.iter().map(|&t| vec![t]).collect(),
        _ => Vec::new(),
    };
    if set.gauss_markov == 2 {
        for i in 0..taus.len() {
            choices.extend(taus[i + 1..].iter().map(|&t| vec![taus[i], t]));
        }
    }
    let amplitudes = set.amplitudes();
    let mut starts = Vec::new();
    for taus in choices {
        // Unit amplitudes, one column each.
        let mut unit = vec![0.0; amplitudes];
        unit.extend(taus.iter().map(|t| t.ln()));
        let columns = amplitudes + usize::from(drift);
        let only = |j: usize| {
            let mut only = set.terms(&unit);
            let mut index = 0;
            let mut keep = |wanted: bool, value: &mut f64| {
                let mine = wanted && index == j;
                index += usize::from(wanted);
                if !mine {
                    *value = 0.0;
                }
            };
            keep(set.white, &mut only.white);
            keep(set.quantisation, &mut only.quantisation);
            keep(set.random_walk, &mut only.random_walk);
            keep(set.flicker, &mut only.flicker);
            for (i, GaussMarkov { sigma, .. }) in only.gauss_markov.iter_mut().enumerate() {
                keep(i < set.gauss_markov, sigma);
            }
            ModelCurve::new(&only, interval)
        };
        let shapes: Vec<ModelCurve> = (0..amplitudes).map(only).collect();
        let shape = |j: usize, point: &WaveletPoint| match shapes.get(j) {
            Some(only) => only.at(point.m),
            None => drift_variance(1.0, point.scale_s),
        };
        let weight = |p: &WaveletPoint| (0.5 * p.edf).sqrt() / p.variance;
        let a = DMatrix::from_fn(points.len(), columns, |i, j| {
            shape(j, &points[i]) * weight(&points[i])
        });
        let b = DVector::from_fn(points.len(), |i, _| (0.5 * points[i].edf).sqrt());
        let squares = nnls::solve(&a, &b);
        let mut z = unit.clone();
        for j in 0..columns {
            let largest = points
                .iter()
                .map(|p| shape(j, p) / p.variance)
                .fold(f64::MIN_POSITIVE, f64::max);
            let amplitude = 0.5 * squares[j].max(TRACE / largest).ln();
            if j < amplitudes {
                z[j] = amplitude;
            } else {
                z.push(amplitude);
            }
        }
        starts.push(z);
    }
    starts
}

#[cfg(test)]
mod tests;
