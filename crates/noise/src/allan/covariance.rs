//! Covariance matrix of the overlapping Allan variances of one record at several averaging times.
//!
//! For Gaussian noise `Cov(σ²_i, σ²_j) = Σ_s Σ_t r_ij(t − s)² / (2 n_i n_j)`, r_ij the covariance of
//! the second differences of two averaging times, over τ (Greenhall & Riley, "Uncertainty of
//! stability variances based on finite differences", 35th PTTI, 2003, for i = j). r_ij is linear in the
//! squares of the terms, the covariance a quadratic form in them, whose sums over the lags are taken
//! once for a record. The ends of the record are in it: long averages have few differences.
//!
//! What for: neighbouring points of an Allan plot share samples, their errors are correlated, and a
//! least-squares fit that ignores it states errors that are too small. [`super::fit_terms`] and
//! [`super::fit_gauss_markov`] weight the points by this matrix, and take the errors of their terms from it.
//!
//! Units: σ² in \[unit²\], so the covariance in \[unit⁴\]; τ in s. Cost: O(points²) pairs, at most
//! about a thousand lags each.

use super::deviation::Point;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Terms that scatter: quantisation, white, bias instability, random walk. A ramp does not.
const NOISES: usize = 4;

/// Steps of the sum over lags to the shorter averaging time.
const FINE: usize = 8;

/// Steps to the longer one, where the two are far apart, and at least to the lags there are.
const COARSE: usize = 16;

/// From this ratio of averaging times on only random walks, smooth over the shorter one, have a
/// correlation worth counting: that of the others falls with the ratio's power 3/2, to 0.6 % here.
const APART: usize = 32;

/// Weights of a second difference.
const SECOND: [(usize, f64); 3] = [(0, 1.0), (1, -2.0), (2, 1.0)];

/// The sums over lags of one pair of averaging times.
#[derive(Clone, Copy, Default)]
struct Pair {
    /// Σ r_k r_l / (2 n_i n_j).
    products: [[f64; NOISES]; NOISES],
    /// Σ r_k τ_i τ_j / (n_i n_j): how the means of the differences, which a ramp moves, scatter.
    means: [f64; NOISES],
}

/// The covariance of the variances at some averaging times as a function of the terms.
pub(super) struct Covariance {
    /// Number of averaging times.
    count: usize,
    /// Pairs i ≤ j, row by row.
    pairs: Vec<Pair>,
}

impl Covariance {
    /// The sums for `points` of a record of `samples` at `rate_hz` \[Hz\].
    pub(super) fn new(points: &[Point], samples: usize, rate_hz: f64) -> Self {
        let row = |i: usize| points[i..].iter().map(move |far| (&points[i], far));
        let pairs = (0..points.len())
            .flat_map(row)
            .map(|(near, far)| Pair::new(near.m, far.m, samples, rate_hz))
            .collect();
        Self {
            count: points.len(),
            pairs,
        }
    }

    /// The covariance of the variances, for terms Q, N, B, K, R with these squares.
    ///
    /// The order of `squares` is Q² [unit²·s²], N² [unit²·s], B² \[unit²\], K² [unit²/s], R²
    /// [unit²/s²].
    pub(super) fn at(&self, squares: &DVector<f64>) -> DMatrix<f64> {
        let mut covariance = DMatrix::zeros(self.count, self.count);
        let mut pairs = self.pairs.iter();
        for i in 0..self.count {
            for (j, pair) in (i..self.count).zip(&mut pairs) {
                let mut sum = 0.0;
                for k in 0..NOISES {
                    let row: f64 = (0..NOISES).map(|l| pair.products[k][l] * squares[l]).sum();
                    sum += squares[k] * (row + pair.means[k] * squares[NOISES]);
                }
                covariance[(i, j)] = sum;
                covariance[(j, i)] = sum;
            }
        }
        covariance
    }
}

impl Pair {
    /// The sums of averaging factors `near` ≤ `far`.
    fn new(near: usize, far: usize, samples: usize, rate_hz: f64) -> Self {
        let terms = |m: usize| (samples + 1).saturating_sub(2 * m) as i64;
        let (terms_near, terms_far) = (terms(near), terms(far));
        // Pairs of differences at a lag, of all of them.
        let share = |lag: i64| {
            let pairs = terms_near.min(terms_far - lag) - (-lag).max(0);
            pairs.max(0) as f64 / (terms_near as f64 * terms_far as f64)
        };
        let taus = (near * far) as f64 / (rate_hz * rate_hz);
        let mut pair = Self::default();
        let mut add = |covariances: [f64; NOISES], weight: f64| {
            for k in 0..NOISES {
                for l in 0..NOISES {
                    pair.products[k][l] += 0.5 * weight * covariances[k] * covariances[l];
                }
                pair.means[k] += weight * taus * covariances[k];
            }
        };
        let (width, reach) = (near as i64, far as i64);
        let apart = far >= APART * near;
        let step = if apart { far / COARSE } else { near / FINE } as i64;
        let step = step.min((terms_near + terms_far) / COARSE as i64).max(1);
        // All but the bias instability end with the overlap of the two differences.
        let first = (-3 * reach).max(1 - terms_near).div_euclid(step);
        let last = (2 * width + reach).min(terms_far - 1).div_euclid(step);
        for lag in (first..=last).map(|k| k * step) {
            let mut covariances = [0.0; NOISES];
            for (a, weight_near) in SECOND {
                for (b, weight_far) in SECOND {
                    let distance = lag + b as i64 * reach - a as i64 * width;
                    let x = distance.unsigned_abs() as f64 / rate_hz;
                    let weight = weight_near * weight_far / taus;
                    if !apart {
                        covariances[1] -= weight * x / 2.0;
                        let log = if x > 0.0 { x.ln() } else { 0.0 };
                        covariances[2] += weight * x * x * log / (2.0 * PI);
                    }
                    covariances[3] += weight * x * x * x / 12.0;
                }
            }
            add(covariances, share(lag) * step as f64);
        }
        // Quantisation is white phase: it needs a common phase, at single lags.
        let mut lags: Vec<(i64, f64)> = Vec::new();
        for (a, weight_near) in SECOND {
            for (b, weight_far) in SECOND {
                let lag = a as i64 * width - b as i64 * reach;
                let weight = weight_near * weight_far / taus;
                match lags.iter_mut().find(|(known, _)| *known == lag) {
                    Some((_, sum)) => *sum += weight,
                    None => lags.push((lag, weight)),
                }
            }
        }
        for (lag, covariance) in lags {
            add([covariance, 0.0, 0.0, 0.0], share(lag));
        }
        pair
    }
}

#[cfg(test)]
mod tests {
    use super::super::confidence::edf;
    use super::super::deviation::{DeviationKind, Grid, deviations};
    use super::*;

    #[test]
    fn the_diagonal_has_the_degrees_of_freedom_of_a_pure_noise() {
        let zeros: Vec<f64> = (0..4096).map(|k| f64::from(k % 2)).collect();
        let curve = deviations(&zeros, 10.0, DeviationKind::Overlapping, Grid::Octave).unwrap();
        let covariance = Covariance::new(&curve.points, 4096, 10.0);
        let variance = |noise: usize, tau: f64| match noise {
            1 => 1.0 / tau,
            2 => 2.0 * 2f64.ln() / PI,
            _ => tau / 3.0,
        };
        for (noise, alpha) in [(1, 0), (2, -1), (3, -2)] {
            let mut squares = DVector::zeros(5);
            squares[noise] = 2.0;
            let matrix = covariance.at(&squares);
            for (i, point) in curve.points.iter().enumerate().skip(2) {
                let mean = 2.0 * variance(noise, point.tau_s);
                let ours = 2.0 * mean * mean / matrix[(i, i)];
                let theirs = edf(DeviationKind::Overlapping, alpha, 4096, point.m);
                // Below m = 4 the other sum is one of the continuous noise.
                assert!(
                    (ours / theirs - 1.0).abs() < 0.03,
                    "α {alpha}, m {}: {ours} {theirs}",
                    point.m
                );
            }
            assert!(matrix.cholesky().is_some(), "α {alpha}");
        }
    }
}
