//! Noise terms of an Allan variance: quantisation, white noise, bias instability, random walk, ramp.
//!
//! `σ²(τ) = 3Q²/τ² + N²/τ + (2 ln 2/π) B² + K² τ/3 + R² τ²/2` (IEEE Std 952-1997 equation C.24), by
//! generalised non-negative least squares in the squares of the terms. How the points scatter, each
//! and together, follows from the *true* curve, so their covariance comes from the fitted one and is
//! iterated; weights from the measured points favour those that happen to be low and halve K.
//! Of all sets of terms the one with the least deviance + 4 a term is taken: five terms that must
//! not be negative share a random walk between B, K and R, and K comes out too low.

use super::confidence::edf;
use super::covariance::Covariance;
use super::deviation::{Curve, DeviationKind, Point};
use super::nnls;
use crate::screening::record::RecordError;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::f64::consts::{LN_2, PI};
use undrift_base::number::OrNull;

/// Least ratio of averaging times that the fit uses: an octave, a little less for rounding. Closer
/// points are so correlated that they add nothing.
const OCTAVE: f64 = 1.99;

/// Fewest points of a fit that leaves out the shortest τ.
const FEWEST: usize = 7;

/// Reduced χ² of a curve that is described. Simulated records of the terms leave 0.9 ± 0.35; a filter or
/// a resonance at the shortest τ of a long record, hundreds.
const DESCRIBES: f64 = 2.0;

/// Rounds of reweighting; the change is below 1e-10 after ten or so.
const ROUNDS: usize = 60;

/// Share of the measured variance that a fit takes for scatter and level where its terms leave none.
const FLOOR: f64 = 1e-6;

/// Deviance that a term must gain to be taken: two standard errors.
const PRICE: f64 = 4.0;

/// A coefficient below so many standard errors is not seen.
const SEEN: f64 = 2.0;

/// One term of the fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Term {
    /// Value of the term, 0 where the fit leaves it out.
    pub value: f64,
    /// Standard error of the value, from that of its square; NaN where the value is 0.
    #[serde(with = "OrNull")]
    pub standard_error: f64,
    /// One-sided 95 % upper bound of the value.
    #[serde(with = "OrNull")]
    pub upper_95: f64,
    /// Whether the square of the term is more than two standard errors from 0.
    pub seen: bool,
}

/// The terms of IEEE Std 952, in the unit of the samples ([rad/s] or [m/s²]; `u` below) and seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Terms {
    /// Quantisation Q [u·s].
    pub quantisation: Term,
    /// White noise N [u·√s, that is u/√Hz]: angle or velocity random walk.
    #[doc(
        alias = "angle random walk",
        alias = "velocity random walk",
        alias = "ARW",
        alias = "VRW"
    )]
    pub white: Term,
    /// Bias instability B \[u\]; the flat of the deviation is 0.664 B.
    #[doc(alias = "flicker", alias = "in-run bias stability")]
    pub bias_instability: Term,
    /// Rate random walk K [u/√s].
    #[doc(alias = "rate random walk", alias = "RRW")]
    pub random_walk: Term,
    /// Rate ramp R [u/s].
    pub ramp: Term,
    /// Shortest τ that was fitted \[s\].
    #[serde(skip)]
    pub from_s: f64,
    /// White variance of a sample σ² = N²·rate \[u²\].
    pub white_variance: f64,
    /// Squared residuals in units of their covariance, over the degrees of freedom; about 1 where
    /// the terms describe the curve.
    #[serde(skip)]
    pub reduced_chi2: f64,
}

impl Terms {
    /// The terms of a curve whose white noise is higher than the samples' by a factor of its variance, as lines over missing
    /// samples make it.
    pub(crate) fn with_less_white(mut self, factor: f64) -> Self {
        let white = &mut self.white;
        for value in [
            &mut white.value,
            &mut white.standard_error,
            &mut white.upper_95,
        ] {
            *value /= factor.sqrt();
        }
        self.white_variance /= factor;
        self
    }

    /// The fitted Allan variance at averaging time `tau_s` \[s\], \[u²\]: the sum of all terms, whose root is the curve to draw beside the
    /// measured one.
    ///
    /// ```
    /// use undrift_noise::allan::{Term, Terms};
    /// let term = |value| Term { value, ..Term::default() };
    /// let terms = Terms { white: term(1e-3), random_walk: term(1e-4), ..Terms::default() };
    /// // N²/τ and K²τ/3 are equal at τ = √3 N/K.
    /// let tau_s = 3f64.sqrt() * 1e-3 / 1e-4;
    /// assert!((terms.variance(tau_s) / (2.0 * 1e-6 / tau_s) - 1.0).abs() < 1e-12);
    /// ```
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

/// Allan variance over τ \[s\] of a term of unit size.
type Shape = fn(f64) -> f64;

/// Noise type α and shape of each term.
const SHAPES: [(i32, Shape); 5] = [
    (2, |tau| 3.0 / (tau * tau)),
    (0, |tau| 1.0 / tau),
    (-1, |_| 2.0 * LN_2 / PI),
    (-2, |tau| tau / 3.0),
    (-4, |tau| tau * tau / 2.0),
];

/// Fits the terms to an overlapping Allan deviation, from the shortest τ on from which they describe
/// it: below, a sensor's filter or resonance may add what none of the terms is.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{allan::{DeviationKind, Grid, deviations, fit_terms}, synthesis::NoiseGenerator};
/// let noise = ShapingFilter::white(1e-3, 0.01)?; // N of 1e-3 rad/√s at 100 Hz.
/// let record: Vec<f64> = NoiseGenerator::new(&noise, 1).take(50_000).collect();
/// let terms = fit_terms(&deviations(&record, 100.0, DeviationKind::Overlapping, Grid::Octave)?)?;
/// assert!((terms.white.value / 1e-3 - 1.0).abs() < 0.02);
/// assert!(!terms.random_walk.seen && terms.random_walk.value <= terms.random_walk.upper_95);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A curve that is not [`DeviationKind::Overlapping`], or fewer than 3 points with a positive deviation.
pub fn fit_terms(curve: &Curve) -> Result<Terms, RecordError> {
    described(curve, |from| {
        let terms = fit_terms_from(curve, from)?;
        Ok((terms.reduced_chi2, terms.white.seen, terms))
    })
}

/// The fit of [`fit_terms`] with the averaging times from `shortest_s` \[s\] on. Quantisation shows at the shortest τ of a curve: where
/// that is left out, so is the term.
///
/// # Errors
/// As [`fit_terms`], of the points that are left.
///
/// The τ in use is the first of the curve at or above `shortest_s` ([`Terms::from_s`]). A curve at every τ
/// is fitted at its octaves alone.
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
    let solution = problem.solve_sparse(points[0].m == curve.points[0].m);
    let errors = problem.standard_errors(&solution);
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
        from_s: points[0].tau_s,
        white_variance: solution.coefficients[1] * curve.rate_hz,
        reduced_chi2: if freedom > 0.0 {
            solution.chi2 / freedom
        } else {
            f64::NAN
        },
    })
}

/// The fit from the shortest τ on that leaves a reduced χ² below [`DESCRIBES`], else the one that
/// leaves the least; among those that see white noise, without which there is no model of a sensor.
/// `fit` is from a τ \[s\] on and gives its χ², whether it sees white noise, and itself.
pub(crate) fn described<T>(
    curve: &Curve,
    mut fit: impl FnMut(f64) -> Result<(f64, bool, T), RecordError>,
) -> Result<T, RecordError> {
    let points = points_for_fit(curve)?;
    let (mut least, _, mut best) = fit(0.0)?;
    let last = points.len().saturating_sub(FEWEST);
    for start in points.iter().take(last + 1).skip(1) {
        if least < DESCRIBES || least.is_nan() {
            break;
        }
        let (chi2, white, next) = fit(start.tau_s)?;
        if white && chi2 < least {
            (least, best) = (chi2, next);
        }
    }
    Ok(best)
}

/// The points of an overlapping Allan deviation that a fit uses: positive, one an octave.
pub(crate) fn points_for_fit(curve: &Curve) -> Result<Vec<Point>, RecordError> {
    if curve.kind != DeviationKind::Overlapping {
        return Err(RecordError::Argument(
            "the fit needs an overlapping Allan deviation",
        ));
    }
    let mut points: Vec<Point> = Vec::new();
    for point in &curve.points {
        let spaced = points
            .last()
            .is_none_or(|last| point.tau_s >= last.tau_s * OCTAVE);
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
    /// Points by columns: variance of each unit term.
    shapes: DMatrix<f64>,
    /// Covariance of the points under the IEEE terms.
    covariance: Covariance,
    /// Covariance of the points over the product of their variances, where no IEEE terms give it.
    relative: DMatrix<f64>,
}

/// Solution of a [`Problem`].
pub(crate) struct Solution {
    /// Squares of the terms, not negative.
    pub coefficients: DVector<f64>,
    /// rᵀ C⁻¹ r of the residuals r and their covariance C.
    pub chi2: f64,
    /// Σ ν (s/μ − 1 − ln(s/μ)), −2 log-likelihood of chi-squared variances up to a constant.
    pub deviance: f64,
    /// Covariance of the points over the product of their fitted variances.
    relative: DMatrix<f64>,
}

impl Problem {
    /// The problem of fitting the IEEE terms to the points.
    pub(crate) fn new(curve: &Curve, points: &[Point]) -> Self {
        let tau: Vec<f64> = points.iter().map(|p| p.tau_s).collect();
        let freedom = |p: &Point| edf(curve.kind, 0, curve.samples, p.m);
        let start = points.iter().map(|p| 2.0 / freedom(p));
        let mut problem = Self {
            measured: DVector::from_iterator(
                points.len(),
                points.iter().map(|p| p.deviation.powi(2)),
            ),
            shapes: DMatrix::from_fn(points.len(), SHAPES.len(), |i, j| SHAPES[j].1(tau[i])),
            covariance: Covariance::new(points, curve.samples, curve.rate_hz),
            relative: DMatrix::from_diagonal(&DVector::from_iterator(points.len(), start)),
            tau,
        };
        problem.relative = problem.solve_with(&problem.shapes, true).relative;
        problem
    }

    /// Puts other shapes in place: variance over τ \[s\] of unit terms.
    pub(crate) fn set_shapes(&mut self, columns: &[&dyn Fn(f64) -> f64]) {
        self.shapes = DMatrix::from_fn(self.tau.len(), columns.len(), |i, j| {
            columns[j](self.tau[i])
        });
    }

    /// The best of all sets of IEEE terms, the first of which is quantisation.
    fn solve_sparse(&self, quantised: bool) -> Solution {
        let mut best: Option<(f64, Solution)> = None;
        for set in (1u32..1 << self.shapes.ncols()).filter(|set| quantised || set & 1 == 0) {
            let mut shapes = self.shapes.clone();
            for j in (0..shapes.ncols()).filter(|j| set >> j & 1 == 0) {
                shapes.column_mut(j).fill(0.0);
            }
            let solution = self.solve_with(&shapes, true);
            let cost = solution.deviance + PRICE * f64::from(set.count_ones());
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, solution));
            }
        }
        best.map_or_else(|| self.solve_with(&self.shapes, true), |(_, best)| best)
    }

    /// The fit of the shapes put in place; the points scatter as under the IEEE terms.
    pub(crate) fn solve(&self) -> Solution {
        self.solve_with(&self.shapes, false)
    }

    /// Iteratively reweighted non-negative least squares. `ieee`: the shapes are those of the IEEE
    /// terms, which give the scatter of the points as they are found.
    ///
    /// Each round divides points and shapes by the fitted level, whitens by the Cholesky factor of the relative
    /// covariance, solves for the squares, and takes level and covariance from what was found.
    fn solve_with(&self, shapes: &DMatrix<f64>, ieee: bool) -> Solution {
        let mut level = self.measured.clone();
        let mut relative = self.relative.clone();
        let mut coefficients = DVector::zeros(shapes.ncols());
        for round in 0..ROUNDS {
            let (mut a, mut b) = (shapes.clone(), self.measured.clone());
            for i in 0..b.len() {
                a.row_mut(i).scale_mut(1.0 / level[i]);
                b[i] /= level[i];
            }
            let white = whitening(&relative);
            coefficients = nnls::solve(&(&white * a), &(white * b));
            let fitted = shapes * &coefficients;
            let mut change: f64 = 0.0;
            for i in 0..level.len() {
                // A term at 0 must not leave a point without any variance.
                let next = fitted[i].max(FLOOR * self.measured[i]);
                change = change.max((next / level[i] - 1.0).abs());
                level[i] = next;
            }
            if ieee {
                relative = self.covariance.at(&coefficients);
                for i in 0..level.len() {
                    relative.row_mut(i).scale_mut(1.0 / level[i]);
                    relative.column_mut(i).scale_mut(1.0 / level[i]);
                    relative[(i, i)] += FLOOR * FLOOR;
                }
            }
            if round > 0 && change < 1e-11 {
                break;
            }
        }
        let ratios = self.measured.component_div(&level);
        let deviance =
            |(i, ratio): (usize, &f64)| 2.0 / relative[(i, i)] * (ratio - 1.0 - ratio.ln());
        Solution {
            chi2: (whitening(&relative) * ratios.add_scalar(-1.0)).norm_squared(),
            deviance: ratios.iter().enumerate().map(deviance).sum(),
            coefficients,
            relative,
        }
    }

    /// Standard errors of the coefficients; of one at 0, as if it alone were added.
    fn standard_errors(&self, solution: &Solution) -> Vec<f64> {
        let fitted = &self.shapes * &solution.coefficients;
        let mut scaled = self.shapes.clone();
        for i in 0..self.tau.len() {
            let level = fitted[i].max(FLOOR * self.measured[i]);
            scaled.row_mut(i).scale_mut(1.0 / level);
        }
        let white = whitening(&solution.relative) * scaled;
        let error = |wanted: usize| {
            let set: Vec<usize> = (0..white.ncols())
                .filter(|&j| j == wanted || solution.coefficients[j] > 0.0)
                .collect();
            let mut a = white.select_columns(&set);
            let lengths: Vec<f64> = a.column_iter().map(|c| c.norm()).collect();
            for (j, &length) in lengths.iter().enumerate() {
                a.column_mut(j).scale_mut(1.0 / length);
            }
            let inverse = (a.transpose() * &a).try_inverse()?;
            let k = set.iter().position(|&j| j == wanted)?;
            Some(inverse[(k, k)].max(0.0).sqrt() / lengths[k])
        };
        (0..white.ncols())
            .map(|j| error(j).unwrap_or(f64::INFINITY))
            .collect()
    }
}

/// L⁻¹ of C = L Lᵀ, which makes the points independent and of unit scatter; of its diagonal alone
/// where rounding has left C indefinite.
fn whitening(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let size = covariance.nrows();
    let lower = covariance.clone().cholesky().map(|c| c.unpack());
    lower
        .and_then(|l| l.solve_lower_triangular(&DMatrix::identity(size, size)))
        .unwrap_or_else(|| {
            DMatrix::from_diagonal(&covariance.diagonal().map(|variance| variance.powf(-0.5)))
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points at every octave from 1 s on.
    fn curve(count: u32) -> Curve {
        let point = |k: u32| Point {
            m: 1 << k,
            tau_s: f64::from(1u32 << k),
            deviation: 1.0,
            terms: 1,
        };
        Curve {
            kind: DeviationKind::Overlapping,
            rate_hz: 1.0,
            samples: 1 << 14,
            points: (0..count).map(point).collect(),
        }
    }

    #[test]
    fn the_first_start_that_describes_the_curve_is_taken_or_the_one_that_leaves_least() {
        let of = |chi2: &[f64], blind: f64| {
            let mut tried = Vec::new();
            let best = described(&curve(10), |from| {
                tried.push(from);
                Ok((chi2[tried.len() - 1], from != blind, from))
            });
            (best.unwrap(), tried)
        };
        assert_eq!(of(&[1.9], -1.0), (0.0, vec![0.0]));
        assert_eq!(of(&[9.0, 1.9], -1.0), (2.0, vec![0.0, 2.0]));
        // Seven points are left at least: of ten none beyond the fourth is a start.
        assert_eq!(
            of(&[9.0, 5.0, 4.0, 6.0], -1.0),
            (4.0, vec![0.0, 2.0, 4.0, 8.0])
        );
        assert_eq!(of(&[9.0, 2.0, 2.0, 2.0], -1.0).0, 2.0);
        // A fit without white noise is rejected.
        assert_eq!(
            of(&[9.0, 1.0, 4.0, 6.0], 2.0),
            (4.0, vec![0.0, 2.0, 4.0, 8.0])
        );
        assert_eq!(of(&[f64::NAN], -1.0), (0.0, vec![0.0]));
    }

    #[test]
    fn points_of_a_fit_are_positive_and_an_octave_apart() {
        let mut all = curve(5);
        let between = Point {
            tau_s: 3.9,
            ..all.points[1]
        };
        all.points.insert(2, between);
        all.points[1].deviation = 0.0;
        all.points[5].deviation = f64::INFINITY;
        let taus = points_for_fit(&all).unwrap();
        assert_eq!(
            Vec::from_iter(taus.iter().map(|p| p.tau_s)),
            [1.0, 3.9, 8.0]
        );
        all.kind = DeviationKind::Modified;
        assert!(points_for_fit(&all).is_err());
    }
}
