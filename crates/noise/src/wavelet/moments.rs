//! The generalised method of wavelet moments.
//!
//! Weighted least squares `Σ w (ν̂² − ν²)²` with weights `w = edf/(2ν⁴)`, ν² the *fitted* curve:
//! weights from the record's own ν̂² favour the scales that happen to be low. Its fixed point is the
//! minimum of the χ² deviance `D = Σ edf (ν̂²/ν² − 1 − ln ν̂²/ν²)`, which is what is minimised, over
//! the logarithms of the terms. The scales are not independent (the Haar filter leaks), so standard
//! errors come from their covariance under the fitted model, `(JᵀWJ)⁻¹ JᵀWΣWJ (JᵀWJ)⁻¹` with J the
//! derivatives of ν²: Guerrier et al. 2013, theorem 3.

use super::scatter;
use super::{ModelCurve, WaveletPoint, WaveletVariance, drift_variance};
use crate::allan::nnls;
use crate::composite::search::SCALES;
use crate::composite::{CompositeError, CompositeTerms, GaussMarkov, TermSet, sort_processes};
use crate::quasi_newton::{Objective, best_of};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Ratio of neighbouring correlation times on the grid of starts.
const GRID: f64 = 3.0;
/// Starts that are finished.
const FINISHED: usize = 4;
/// Share of the curve that a term left out of a start is given in it, at the scale of its largest.
const TRACE: f64 = 1e-3;

/// Composite terms fitted to a wavelet variance.
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
    /// The search met its tolerance.
    #[serde(skip)]
    pub converged: bool,
}

/// Fits the terms of `set`, and with `drift` a deterministic drift R, to a wavelet variance, from
/// starts by non-negative least squares on a grid of correlation times.
///
/// # Errors
/// An empty set or too many processes; fewer scales than parameters.
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

fn usable(point: &WaveletPoint) -> bool {
    point.variance > 0.0 && point.edf.is_finite() && point.edf > 0.0
}

/// `flicker`: its variances at the points with B = 1.
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
mod tests {
    use super::*;
    use crate::synthesis::NoiseGenerator;
    use crate::wavelet::wavelet_variance;

    #[test]
    fn a_drift_is_found_and_an_empty_set_refused() {
        let truth = CompositeTerms {
            white: 0.01,
            ..CompositeTerms::default()
        };
        let mut record = vec![0.0; 50_000];
        NoiseGenerator::new(&truth.to_shaping(0.01).unwrap(), 3).fill(&mut record);
        for (k, value) in record.iter_mut().enumerate() {
            *value -= 1e-4 * 0.01 * k as f64;
        }
        let curve = wavelet_variance(&record, 0.01).unwrap();
        let found = fit_moments(&curve, truth.set(), true).unwrap();
        // At 164 and 82 s, with white noise of 6e-7 and 3e-7 unit² beside 2e-5 and 4e-6 of drift.
        assert!((found.drift / 1e-4 - 1.0).abs() < 0.1, "{found:?}");
        assert!((found.terms.white / 0.01 - 1.0).abs() < 0.02, "{found:?}");
        assert_eq!(
            fit_moments(&curve, TermSet::default(), true),
            Err(CompositeError::BadTerms)
        );
        let crowded = TermSet {
            gauss_markov: 2,
            random_walk: true,
            quantisation: true,
            white: true,
            flicker: false,
        };
        let short = wavelet_variance(&record[..40], 0.01).unwrap();
        assert!(fit_moments(&short, crowded, false).is_err());
    }

    const INTERVAL: f64 = 0.1;

    /// The wavelet variance of the terms themselves.
    fn exact(terms: &CompositeTerms, drift: f64) -> WaveletVariance {
        let model = ModelCurve::new(terms, INTERVAL);
        let point = |j: u32| {
            let (m, scale_s) = (1 << j, f64::from(1 << j) * INTERVAL);
            WaveletPoint {
                m,
                scale_s,
                variance: model.at(m) + drift_variance(drift, scale_s),
                edf: 2000.0 / f64::from(1 << j),
                coefficients: 1000,
            }
        };
        WaveletVariance {
            interval: INTERVAL,
            samples: 4096,
            points: (0..10).map(point).collect(),
        }
    }

    fn process(sigma: f64, tau_s: f64) -> GaussMarkov {
        GaussMarkov { sigma, tau_s }
    }

    #[test]
    fn an_exact_curve_gives_its_terms_back() {
        let terms = CompositeTerms {
            white: 0.02,
            quantisation: 0.003,
            random_walk: 0.005,
            ..CompositeTerms::default()
        };
        let slow = CompositeTerms {
            white: 0.02,
            gauss_markov: [process(0.03, 4.0), process(0.0, 0.0)],
            ..CompositeTerms::default()
        };
        let flat = CompositeTerms {
            white: 0.02,
            flicker: 0.01,
            ..CompositeTerms::default()
        };
        for (terms, drift) in [(terms, 0.0), (terms, 1e-3), (slow, 0.0), (flat, 0.0)] {
            let curve = exact(&terms, drift);
            let found = fit_moments(&curve, terms.set(), drift > 0.0).unwrap();
            let near = |found: f64, exact: f64| (found - exact).abs() <= 1e-3 * exact;
            assert!(near(found.terms.white, terms.white), "{found:?}");
            assert!(
                near(found.terms.quantisation, terms.quantisation),
                "{found:?}"
            );
            assert!(
                near(found.terms.random_walk, terms.random_walk),
                "{found:?}"
            );
            assert!(near(found.terms.flicker, terms.flicker), "{found:?}");
            let (a, b) = (found.terms.gauss_markov[0], terms.gauss_markov[0]);
            assert!(
                near(a.sigma, b.sigma) && near(a.tau_s, b.tau_s),
                "{found:?}"
            );
            assert!(near(found.drift, drift), "{found:?}");
            assert!(found.deviance < 1e-5 && found.converged, "{found:?}");
            let parameters = terms.set().parameters() + usize::from(drift > 0.0);
            assert_eq!(found.degrees_of_freedom, 10 - parameters);
        }
    }

    #[test]
    fn a_deviance_is_that_of_chi_squared_variances() {
        let terms = CompositeTerms {
            white: 0.02,
            flicker: 0.01,
            ..CompositeTerms::default()
        };
        let unit = CompositeTerms {
            flicker: 1.0,
            ..CompositeTerms::default()
        };
        let unit = ModelCurve::new(&unit, INTERVAL);
        let mut points = exact(&terms, 1e-3).points;
        let flicker: Vec<f64> = points.iter().map(|p| unit.at(p.m)).collect();
        let at = |points: &[WaveletPoint]| deviance(points, &terms, &flicker, 1e-3, INTERVAL);
        assert!(at(&points).abs() < 1e-9);
        points[2].variance *= 1.5;
        points[7].variance *= 0.4;
        let part = |edf: f64, ratio: f64| edf * (ratio - 1.0 - ratio.ln());
        let sum = part(points[2].edf, 1.5) + part(points[7].edf, 0.4);
        assert!((at(&points) / sum - 1.0).abs() < 1e-9);
        let nothing = CompositeTerms::default();
        assert_eq!(
            deviance(&points, &nothing, &flicker, 0.0, INTERVAL),
            f64::INFINITY
        );
    }

    #[test]
    fn the_error_of_one_amplitude_is_the_weighted_sum_of_the_scales_covariances() {
        let terms = CompositeTerms {
            white: 0.02,
            ..CompositeTerms::default()
        };
        let curve = exact(&terms, 0.0);
        let error = fit_moments(&curve, terms.set(), false).unwrap();
        let error = error.relative_errors.unwrap().white;
        // ν² ∝ N²: twice the relative error of N is that of Σ edf ν̂²/ν² over Σ edf.
        let covariance = scatter::covariance(&curve.points, &terms, INTERVAL, curve.samples);
        let (mut sum, mut edf) = (0.0, 0.0);
        for (i, p) in curve.points.iter().enumerate() {
            for (j, q) in curve.points.iter().enumerate() {
                sum += p.edf * q.edf * covariance[(i, j)] / (p.variance * q.variance);
            }
            edf += p.edf;
        }
        let expected = sum.sqrt() / edf / 2.0;
        assert!((error / expected - 1.0).abs() < 1e-3, "{error} {expected}");
    }

    #[test]
    fn starts_are_least_squares_at_each_choice_of_correlation_times() {
        let terms = CompositeTerms {
            white: 0.02,
            random_walk: 0.005,
            ..CompositeTerms::default()
        };
        let points = exact(&terms, 1e-3).points;
        let starts = grid(&points, terms.set(), true, INTERVAL);
        assert_eq!(starts.len(), 1);
        for (z, exact) in starts[0].iter().zip([0.02, 0.005, 1e-3f64]) {
            assert!((z - exact.ln()).abs() < 1e-6, "{starts:?}");
        }
        // A term that least squares leave out is a thousandth of the curve where it is largest: the first scale.
        let more = TermSet {
            quantisation: true,
            ..terms.set()
        };
        let start = &grid(&exact(&terms, 0.0).points, more, false, INTERVAL)[0];
        let left_out =
            0.5 * (TRACE * ModelCurve::new(&terms, INTERVAL).at(1) / quantisation(1.0)).ln();
        assert!((start[1] - left_out).abs() < 1e-6, "{start:?} {left_out}");
        // From half a sample to 20 times the longest scale: 0.05 s · 3^k below 1024 s.
        let slow = |gauss_markov| TermSet {
            gauss_markov,
            ..terms.set()
        };
        let one = grid(&points, slow(1), false, INTERVAL);
        assert_eq!(one.len(), 10);
        for (k, start) in one.iter().enumerate() {
            assert!((start[3].exp() / (0.05 * 3f64.powi(k as i32)) - 1.0).abs() < 1e-9);
        }
        let two = grid(&points, slow(2), false, INTERVAL);
        assert_eq!(two.len(), 45);
        assert!(
            two.iter()
                .all(|start| start.len() == 6 && start[4] < start[5])
        );
        // With the drive of a process of a grid's correlation time, σ √(2/τ).
        let tau_s = 0.05 * 81.0;
        let alone = CompositeTerms {
            white: 0.02,
            gauss_markov: [process(0.03, tau_s), process(0.0, 0.0)],
            ..CompositeTerms::default()
        };
        let start = &grid(&exact(&alone, 0.0).points, alone.set(), false, INTERVAL)[4];
        assert!((start[0] - 0.02f64.ln()).abs() < 1e-6, "{start:?}");
        assert!(
            (start[1] - (0.03 * (2.0 / tau_s).sqrt()).ln()).abs() < 1e-6,
            "{start:?}"
        );
    }

    fn quantisation(q: f64) -> f64 {
        super::super::quantisation_variance(q, INTERVAL)
    }

    #[test]
    fn scales_without_a_variance_or_its_certainty_are_left_out() {
        let good = exact(
            &CompositeTerms {
                white: 1.0,
                ..CompositeTerms::default()
            },
            0.0,
        )
        .points[0];
        assert!(usable(&good));
        for bad in [
            WaveletPoint {
                variance: 0.0,
                ..good
            },
            WaveletPoint { edf: 0.0, ..good },
            WaveletPoint {
                edf: f64::INFINITY,
                ..good
            },
            WaveletPoint {
                edf: f64::NAN,
                ..good
            },
        ] {
            assert!(!usable(&bad), "{bad:?}");
        }
        let terms = CompositeTerms {
            white: 0.02,
            ..CompositeTerms::default()
        };
        let mut curve = exact(&terms, 0.0);
        curve.points[3].variance = 0.0;
        assert_eq!(
            fit_moments(&curve, terms.set(), false)
                .unwrap()
                .degrees_of_freedom,
            8
        );
        // As many scales as parameters are enough.
        curve.points.truncate(1);
        assert!(fit_moments(&curve, terms.set(), false).is_ok());
        let error = fit_moments(&curve, terms.set(), true).unwrap_err();
        assert_eq!(
            error,
            CompositeError::TooShort {
                present: 4096,
                needed: 16
            }
        );
    }
}
