//! Noise terms of an Allan variance: quantisation, white noise, bias instability, random walk, ramp.
//!
//! `σ²(τ) = 3Q²/τ² + N²/τ + (2 ln 2/π) B² + K² τ/3 + R² τ²/2` (IEEE Std 952-1997 equation C.24), by
//! non-negative least squares in the squares of the terms. An estimate with ν degrees of freedom
//! scatters by √(2/ν) of its *true* value, so the weights come from the fitted curve and are
//! iterated; weights from the measured points favour those that happen to be low and halve K.
//! Of all sets of terms the one with the least deviance + 4 a term is taken: five terms that must
//! not be negative share a random walk between B, K and R, and K comes out 20 % low.

use super::confidence::edf;
use super::deviation::{Curve, Kind, Point};
use super::nnls;
use crate::screening::record::RecordError;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{LN_2, PI};

/// Points an octave that the fit uses; more are so correlated that they add nothing.
const PER_OCTAVE: f64 = 4.0;

/// Rounds of reweighting; the change is below 1e-10 after ten or so.
const ROUNDS: usize = 60;

/// Deviance that a term must gain to be taken: two standard errors.
const PRICE: f64 = 4.0;

/// A coefficient below so many standard errors is not seen.
const SEEN: f64 = 2.0;

/// One term of the fit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Term {
    /// The term, 0 where the fit leaves it out.
    pub value: f64,
    /// Its standard error, from that of its square; NaN where the value is 0.
    pub standard_error: f64,
    /// One-sided 95 % upper bound.
    pub upper_95: f64,
    /// True where the square of the term is more than two standard errors from 0.
    pub seen: bool,
}

/// The terms of IEEE Std 952, in the unit of the samples ([rad/s] or [m/s²]; `u` below) and seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms {
    /// Quantisation Q [u·s].
    pub quantisation: Term,
    /// White noise N [u·√s, that is u/√Hz]: angle or velocity random walk.
    pub white: Term,
    /// Bias instability B [u]; the flat of the deviation is 0.664 B.
    pub bias_instability: Term,
    /// Rate random walk K [u/√s].
    pub random_walk: Term,
    /// Rate ramp R [u/s].
    pub ramp: Term,
    /// White variance of a sample σ² = N²·rate [u²].
    pub white_variance: f64,
    /// Weighted sum of squared residuals over the degrees of freedom; about 1 where the terms
    /// describe the curve (neighbouring points are correlated, so it is no test).
    pub reduced_chi2: f64,
}

impl Terms {
    /// The fitted Allan variance at `tau_s` [s], [u²].
    pub fn variance(&self, tau_s: f64) -> f64 {
        let terms = [
            self.quantisation,
            self.white,
            self.bias_instability,
            self.random_walk,
            self.ramp,
        ];
        let shapes = SHAPES.iter().zip(terms);
        shapes
            .map(|((_, shape), term)| shape(tau_s) * term.value * term.value)
            .sum()
    }
}

/// Allan variance over τ [s] of a term of unit size.
type Shape = fn(f64) -> f64;

/// Noise type α and shape of each term.
const SHAPES: [(i32, Shape); 5] = [
    (2, |tau| 3.0 / (tau * tau)),
    (0, |tau| 1.0 / tau),
    (-1, |_| 2.0 * LN_2 / PI),
    (-2, |tau| tau / 3.0),
    (-4, |tau| tau * tau / 2.0),
];

/// Fits the terms to an overlapping Allan deviation.
///
/// Errors: a curve that is not [`Kind::Overlapping`], or fewer than 3 points with a positive deviation.
pub fn fit_terms(curve: &Curve) -> Result<Terms, RecordError> {
    fit_terms_from(curve, 0.0)
}

/// As [`fit_terms`], from `shortest_s` [s] on: below it a sensor's filter or resonance may add what
/// none of the terms describes.
pub fn fit_terms_from(curve: &Curve, shortest_s: f64) -> Result<Terms, RecordError> {
    let mut points = points_for_fit(curve)?;
    points.retain(|p| p.tau_s >= shortest_s * (1.0 - 1e-9));
    if points.len() < 3 {
        return Err(RecordError::TooShort {
            needed: 3,
            got: points.len(),
        });
    }
    let problem = Problem::new(curve, &points);
    let solution = problem.solve_sparse();
    let errors = problem.standard_errors(&solution, curve.rate_hz);
    let term = |i: usize| {
        let (square, error) = (solution.coefficients[i], errors[i]);
        let value = square.sqrt();
        Term {
            value,
            standard_error: if value > 0.0 {
                error / (2.0 * value)
            } else {
                f64::NAN
            },
            upper_95: (square + 1.644_853_627 * error).sqrt(),
            seen: square > SEEN * error,
        }
    };
    let freedom =
        points.len() as f64 - solution.coefficients.iter().filter(|c| **c > 0.0).count() as f64;
    Ok(Terms {
        quantisation: term(0),
        white: term(1),
        bias_instability: term(2),
        random_walk: term(3),
        ramp: term(4),
        white_variance: solution.coefficients[1] * curve.rate_hz,
        reduced_chi2: if freedom > 0.0 {
            solution.chi2 / freedom
        } else {
            f64::NAN
        },
    })
}

/// The points of an overlapping Allan deviation that a fit uses: positive, at most four an octave.
pub(crate) fn points_for_fit(curve: &Curve) -> Result<Vec<Point>, RecordError> {
    if curve.kind != Kind::Overlapping {
        return Err(RecordError::Argument(
            "the fit needs an overlapping Allan deviation",
        ));
    }
    let mut points: Vec<Point> = Vec::new();
    let step = (0.999 / PER_OCTAVE).exp2();
    for point in &curve.points {
        let spaced = points
            .last()
            .is_none_or(|last| point.tau_s >= last.tau_s * step);
        if spaced && point.deviation > 0.0 && point.deviation.is_finite() {
            points.push(*point);
        }
    }
    Ok(points)
}

/// A non-negative fit of given shapes to the points.
pub(crate) struct Problem {
    tau: Vec<f64>,
    measured: DVector<f64>,
    freedom: Vec<f64>,
    /// Points by columns: variance of each unit term.
    shapes: DMatrix<f64>,
}

/// Solution of a [`Problem`].
pub(crate) struct Solution {
    /// Squares of the terms, not negative.
    pub coefficients: DVector<f64>,
    /// Σ ν/2 (measured/fitted − 1)².
    pub chi2: f64,
    /// Σ ν (s/μ − 1 − ln(s/μ)), −2 log-likelihood of chi-squared variances up to a constant.
    pub deviance: f64,
}

impl Problem {
    /// The problem of fitting the IEEE terms to the points. The degrees of freedom are those of the
    /// strongest term at each τ in a first, rough fit.
    pub(crate) fn new(curve: &Curve, points: &[Point]) -> Self {
        let tau: Vec<f64> = points.iter().map(|p| p.tau_s).collect();
        let measured =
            DVector::from_iterator(points.len(), points.iter().map(|p| p.deviation.powi(2)));
        let mut rough = Self {
            shapes: DMatrix::from_fn(points.len(), SHAPES.len(), |i, j| SHAPES[j].1(tau[i])),
            freedom: points
                .iter()
                .map(|p| edf(curve.kind, 0, curve.samples, p.m))
                .collect(),
            tau,
            measured,
        };
        let terms = rough.solve().coefficients;
        for (i, point) in points.iter().enumerate() {
            let share = |j: usize| rough.shapes[(i, j)] * terms[j];
            let strongest = (0..SHAPES.len()).max_by(|&a, &b| share(a).total_cmp(&share(b)));
            let alpha = strongest.map_or(0, |j| SHAPES[j].0);
            rough.freedom[i] = edf(curve.kind, alpha, curve.samples, point.m);
        }
        rough
    }

    /// Puts other shapes in place: variance over τ [s] of unit terms.
    pub(crate) fn set_shapes(&mut self, columns: &[&dyn Fn(f64) -> f64]) {
        self.shapes = DMatrix::from_fn(self.tau.len(), columns.len(), |i, j| {
            columns[j](self.tau[i])
        });
    }

    /// The best of all sets of terms. The deviance is scaled to one point an octave: closer ones
    /// repeat each other.
    fn solve_sparse(&self) -> Solution {
        let columns = self.shapes.ncols();
        let octaves = (self.tau[self.tau.len() - 1] / self.tau[0]).log2() + 1.0;
        let scale = (octaves / self.tau.len() as f64).min(1.0);
        let mut best: Option<(f64, Solution)> = None;
        for set in 1u32..1 << columns {
            let mut shapes = self.shapes.clone();
            for j in (0..columns).filter(|j| set >> j & 1 == 0) {
                shapes.column_mut(j).fill(0.0);
            }
            let solution = self.solve_with(&shapes);
            let cost = scale * solution.deviance + PRICE * f64::from(set.count_ones());
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, solution));
            }
        }
        best.map_or_else(|| self.solve(), |(_, solution)| solution)
    }

    /// The fit of all columns.
    pub(crate) fn solve(&self) -> Solution {
        self.solve_with(&self.shapes)
    }

    /// Iteratively reweighted non-negative least squares: the gamma likelihood of the variances.
    fn solve_with(&self, shapes: &DMatrix<f64>) -> Solution {
        let mut level = self.measured.clone();
        let mut coefficients = DVector::zeros(shapes.ncols());
        for round in 0..ROUNDS {
            let (mut a, mut b) = (shapes.clone(), self.measured.clone());
            for i in 0..b.len() {
                let weight = (0.5 * self.freedom[i]).sqrt() / level[i];
                a.row_mut(i).scale_mut(weight);
                b[i] *= weight;
            }
            coefficients = nnls::solve(&a, &b);
            let fitted = shapes * &coefficients;
            let mut change: f64 = 0.0;
            for i in 0..level.len() {
                // A term at 0 must not leave a point without any variance.
                let next = fitted[i].max(1e-6 * self.measured[i]);
                change = change.max((next / level[i] - 1.0).abs());
                level[i] = next;
            }
            if round > 0 && change < 1e-11 {
                break;
            }
        }
        let (mut chi2, mut deviance) = (0.0, 0.0);
        for i in 0..level.len() {
            let ratio = self.measured[i] / level[i];
            chi2 += 0.5 * self.freedom[i] * (ratio - 1.0).powi(2);
            deviance += self.freedom[i] * (ratio - 1.0 - ratio.ln());
        }
        Solution {
            coefficients,
            chi2,
            deviance,
        }
    }

    /// Standard errors of the coefficients; of one at 0, as if it alone were added. The correlation
    /// between the points is taken into account (sandwich of the weights and the covariance).
    fn standard_errors(&self, solution: &Solution, rate_hz: f64) -> Vec<f64> {
        let fitted = &self.shapes * &solution.coefficients;
        let deviations: Vec<f64> = (0..self.tau.len())
            .map(|i| fitted[i].max(1e-6 * self.measured[i]) * (2.0 / self.freedom[i]).sqrt())
            .collect();
        let correlation = correlations(&self.tau, &solution.coefficients, rate_hz);
        let active: Vec<usize> = (0..self.shapes.ncols())
            .filter(|&j| solution.coefficients[j] > 0.0)
            .collect();
        let error_with = |set: &[usize], wanted: usize| {
            let mut a = self.shapes.select_columns(set);
            for (i, &deviation) in deviations.iter().enumerate() {
                a.row_mut(i).scale_mut(1.0 / deviation);
            }
            let lengths: Vec<f64> = a.column_iter().map(|c| c.norm()).collect();
            for (j, &length) in lengths.iter().enumerate() {
                a.column_mut(j).scale_mut(1.0 / length);
            }
            let inverse = (a.transpose() * &a).try_inverse()?;
            let covariance = &inverse * a.transpose() * &correlation * &a * &inverse;
            let k = set.iter().position(|&j| j == wanted)?;
            Some(covariance[(k, k)].max(0.0).sqrt() / lengths[k])
        };
        let one = |j: usize| {
            let mut set = active.clone();
            if !set.contains(&j) {
                set.push(j);
            }
            error_with(&set, j).unwrap_or(f64::INFINITY)
        };
        (0..self.shapes.ncols()).map(one).collect()
    }
}

/// Correlation of the variances at two τ: `∫ |H_i|² |H_j|² S² df`, normalised, for Gaussian noise of
/// density S and Allan's transfer function |H|² = 2 sin⁴(πfτ)/(πfτ)² (long records; SP 1065 section 5.2).
fn correlations(tau: &[f64], squares: &DVector<f64>, rate_hz: f64) -> DMatrix<f64> {
    let count = tau.len();
    let longest = tau.iter().copied().fold(0.0, f64::max);
    let step = (1.0f64 / 24.0).exp2();
    let mut frequency = 0.02 / longest;
    let mut covariance = DMatrix::zeros(count, count);
    while frequency < 0.5 * rate_hz {
        let omega = 2.0 * PI * frequency;
        let powers = [
            omega * omega / rate_hz,
            1.0,
            1.0 / omega,
            omega.powi(-2),
            omega.powi(-3),
        ];
        let density: f64 = powers.iter().zip(squares.iter()).map(|(p, c)| p * c).sum();
        let transfer = DVector::from_fn(count, |i, _| {
            let angle = PI * frequency * tau[i];
            // Beyond a few periods the logarithmic grid aliases: the mean of sin⁴ instead.
            let fourth = if angle > 6.0 {
                0.375
            } else {
                angle.sin().powi(4)
            };
            fourth / (angle * angle)
        });
        covariance.ger(frequency * density * density, &transfer, &transfer, 1.0);
        frequency *= step;
    }
    DMatrix::from_fn(count, count, |i, j| {
        let scale = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
        if scale > 0.0 {
            covariance[(i, j)] / scale
        } else {
            f64::from(u8::from(i == j))
        }
    })
}
