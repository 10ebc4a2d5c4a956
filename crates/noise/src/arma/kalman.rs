//! The Kalman filter of an ARMA process in innovations form: records with missing samples, and
//! one-step residuals.
//!
//! State as in docs/theory.md, section 2, `x ← F x + G a`, `ε = x₁ + a`. With q = P₁₁ (in units of σ²) the
//! one-step variance is `V = 1 + q`, the gain `K = A P Hᵀ/V + G`, and since the measurement noise is
//! the driving noise, `P ← A (P − P HᵀH P/V) Aᵀ` with A the companion matrix of θ: P itself falls to
//! zero, with no difference of large numbers, so it is P, not V, whose size says when the filter has
//! settled. For (1,1) this is `q ← θ² q/(1+q)` from `q₀ = (φ−θ)²/(1−φ²)`. A missing sample only
//! predicts: `P ← F P Fᵀ + G Gᵀ`. Gardner, Harvey & Phillips 1980 (AS 154); Jones 1980.
//!
//! A unit root starts as a random walk at zero beside an unknown level with a flat prior (diffuse),
//! the rest stationary; for an unbroken record that is the likelihood of its differences.
//!
//! Three callers: the likelihood of records with gaps ([`with_gaps`]), the check that an optimum is
//! no rounding ([`filtered`]), and residuals ([`standardised`]). Unbroken records go through
//! [`super::likelihood`], which costs less. Up to order 6 a record with gaps is taken by the
//! steady-state pass of [`crate::steady`], beyond sample by sample: O(N r²) until the filter has
//! settled, O(N r) after.
//!
//! Letters: r = max(p, q) states; F companion matrix of φ, A of θ, first column the coefficients
//! and ones above the diagonal; G = φ − θ; H = (1, 0, …); all variances in units of σ².

use super::likelihood::{Likelihood, Mean, concentrated};
use super::linear::{initial_covariance, padded};
use crate::steady::{self, Innovations, Sums};

/// Trace of P below which the filter has settled: P adds to V = 1 + P₁₁, and what follows sums to
/// at most P/(1−θ²), rounding even for a moving-average root 1e-6 away from 1.
const SETTLED: f64 = 1e-20;

/// The filter's covariance side, shared by the record and the record of ones.
///
/// Plain loops: they run at every sample, and M P Mᵀ of a companion matrix M is r² operations instead of r³.
///
/// The covariance does not depend on the samples, only on which of them are missing; so one
/// `Filter` serves the record and the series of ones, whose generalised least squares gives the
/// mean.
struct Filter {
    /// Number of states, max(p, q).
    r: usize,
    /// First columns of the companion matrices of φ and θ.
    phi: Vec<f64>,
    /// First column of A, the closed loop F − G H.
    theta: Vec<f64>,
    /// Driving vector G = φ − θ.
    g: Vec<f64>,
    /// P, row by row.
    p: Vec<f64>,
    /// Room for a product.
    half: Vec<f64>,
    /// First column of P, before it is overwritten.
    column: Vec<f64>,
    /// P is below [`SETTLED`]: it is zero from here to the next missing sample, and the gain is G.
    settled: bool,
}

impl Filter {
    /// The filter before the first sample: P stationary, or as a unit root leaves it. `None` where φ is not stationary.
    fn new(phi: &[f64], theta: &[f64], unit_root: bool) -> Option<Self> {
        let r = phi.len().max(theta.len());
        let p = match r {
            0 => Vec::new(),
            _ => initial_covariance(phi, theta, unit_root)?
                .as_slice()
                .to_vec(),
        };
        let (phi, theta) = (padded(phi, r), padded(theta, r));
        Some(Self {
            r,
            g: phi
                .iter()
                .zip(&theta)
                .map(|(phi, theta)| phi - theta)
                .collect(),
            phi,
            theta,
            half: p.clone(),
            column: vec![0.0; r],
            p,
            settled: r == 0,
        })
    }

    /// Relative excess q of the next sample's variance, `V = 1 + q`.
    fn excess(&self) -> f64 {
        if self.settled {
            0.0
        } else {
            self.p[0].max(0.0)
        }
    }

    /// Takes in a sample: writes the gain, moves P on.
    ///
    /// The first row and column of `P − P Hᵀ H P/V` are `P/V`: written so, they lose no digits where P is small.
    ///
    /// O(r²). After it P is the covariance of the prediction of the sample after.
    fn observe(&mut self, gain: &mut [f64]) {
        gain.copy_from_slice(&self.g);
        if self.settled {
            return;
        }
        let r = self.r;
        let v = 1.0 + self.excess();
        for i in 0..r {
            self.column[i] = self.p[i * r];
        }
        let column = &self.column;
        for i in 0..r {
            let above = column.get(i + 1).copied().unwrap_or(0.0);
            gain[i] += (self.theta[i] * column[0] + above) / v;
            for j in 0..r {
                self.p[i * r + j] -= column[i] * column[j] / v;
            }
        }
        if r > 0 {
            // P − P Hᵀ H P/V in the first row and column is P/V: no difference.
            for i in 0..r {
                self.p[i * r] = column[i] / v;
                self.p[i] = column[i] / v;
            }
        }
        sandwich(&self.theta, &mut self.p, &mut self.half, r);
        let trace: f64 = (0..r).map(|i| self.p[i * r + i]).sum();
        if trace < SETTLED {
            self.settled = true;
            self.p.fill(0.0);
        }
    }

    /// Passes a missing sample.
    ///
    /// After it the filter has to settle again.
    ///
    /// No information comes in: the variance grows towards the stationary one, with a unit root
    /// without bound.
    fn skip(&mut self) {
        let r = self.r;
        if r == 0 {
            return;
        }
        sandwich(&self.phi, &mut self.p, &mut self.half, r);
        for i in 0..r {
            for j in 0..r {
                self.p[i * r + j] += self.g[i] * self.g[j];
            }
        }
        self.settled = false;
    }
}

/// `P ← M P Mᵀ` with M a companion matrix of first column `m`, ones above the diagonal.
///
/// `half` is room of r × r. O(r²), since all but the first column of M only shifts.
fn sandwich(m: &[f64], p: &mut [f64], half: &mut [f64], r: usize) {
    for i in 0..r {
        for j in 0..r {
            let above = if i + 1 < r { p[(i + 1) * r + j] } else { 0.0 };
            half[i * r + j] = m[i] * p[j] + above;
        }
    }
    for i in 0..r {
        for j in 0..r {
            let right = if j + 1 < r { half[i * r + j + 1] } else { 0.0 };
            p[i * r + j] = half[i * r] * m[j] + right;
        }
    }
}

/// The state's mean: predicts, then moves on with or without a sample.
///
/// x is the predicted state, its first element the prediction of the next sample less the centre
/// \[unit\].
struct Estimate {
    x: Vec<f64>,
}

impl Estimate {
    fn new(r: usize) -> Self {
        Self { x: vec![0.0; r] }
    }

    /// Prediction of the next sample about the centre.
    fn predicted(&self) -> f64 {
        self.x.first().copied().unwrap_or(0.0)
    }

    /// `x ← F x + K v`; v = 0 passes a missing sample.
    fn advance(&mut self, phi: &[f64], gain: &[f64], v: f64) {
        let r = self.x.len();
        let first = self.predicted();
        for i in 0..r {
            let above = if i + 1 < r { self.x[i + 1] } else { 0.0 };
            self.x[i] = phi.get(i).copied().unwrap_or(0.0) * first + above + gain[i] * v;
        }
    }
}

/// Runs the filter over a record about `centre`. `visit` gets the gain of each sample and, where it is not missing,
/// its innovation v and the relative excess q of its variance.
///
/// `None` where the initial covariance does not exist. A missing sample is NaN; `visit` is called
/// for it as well, without an innovation, so that a caller may keep a second series in step.
fn run(
    samples: &[f64],
    centre: f64,
    (phi, theta): (&[f64], &[f64]),
    unit_root: bool,
    mut visit: impl FnMut(&[f64], Option<(f64, f64)>),
) -> Option<()> {
    let mut filter = Filter::new(phi, theta, unit_root)?;
    let mut record = Estimate::new(filter.r);
    let mut gain = vec![0.0; filter.r];
    for &x in samples {
        if x.is_nan() {
            record.advance(phi, &gain, 0.0);
            filter.skip();
            visit(&gain, None);
            continue;
        }
        let q = filter.excess();
        let v = x - centre - record.predicted();
        filter.observe(&mut gain);
        record.advance(phi, &gain, v);
        visit(&gain, Some((v, q)));
    }
    Some(())
}

/// Exact log-likelihood of a record in which NaN marks missing samples. With `unit_root`, φ holds a
/// root at exactly 1 and `mean` is ignored (the level is free).
///
/// `centre` \[unit\] is a value near the mean that is taken off for the sake of digits. σ² is
/// concentrated out; an estimated mean, or the level of a unit root, is by generalised least
/// squares, exact.
///
/// `None` where φ is not stationary, where nothing determines the level of a unit root, or where
/// the sum of squares is not positive.
pub(super) fn with_gaps(
    samples: &[f64],
    mean: Mean,
    centre: f64,
    phi: &[f64],
    theta: &[f64],
    unit_root: bool,
) -> Option<Likelihood> {
    let order = phi.len().max(theta.len());
    likelihood(samples, mean, centre, (phi, theta), unit_root, order)
}

/// Does [`with_gaps`] by the filter, one sample after the other, whose digits last where roots crowd at 1.
pub(super) fn filtered(
    samples: &[f64],
    mean: Mean,
    centre: f64,
    phi: &[f64],
    theta: &[f64],
    unit_root: bool,
) -> Option<Likelihood> {
    likelihood(samples, mean, centre, (phi, theta), unit_root, usize::MAX)
}

/// The likelihood by whichever pass serves: the steady one, or sample by sample.
///
/// `order` chooses the pass: 1 to 6 the steady one, anything else sample by sample.
fn likelihood(
    samples: &[f64],
    mean: Mean,
    centre: f64,
    (phi, theta): (&[f64], &[f64]),
    unit_root: bool,
    order: usize,
) -> Option<Likelihood> {
    let free = unit_root || mean == Mean::Estimated;
    let centre = match mean {
        Mean::Known(value) if !unit_root => value,
        _ => centre,
    };
    let sums = match order {
        1 => steady::<1>(samples, centre, (phi, theta), unit_root),
        2 => steady::<2>(samples, centre, (phi, theta), unit_root),
        3 => steady::<3>(samples, centre, (phi, theta), unit_root),
        4 => steady::<4>(samples, centre, (phi, theta), unit_root),
        5 => steady::<5>(samples, centre, (phi, theta), unit_root),
        6 => steady::<6>(samples, centre, (phi, theta), unit_root),
        _ => one_by_one(samples, centre, (phi, theta), unit_root, free),
    }?;
    let Sums {
        mut squares,
        cross,
        ones: information,
        mut log_determinant,
        present,
    } = sums;
    let mut value = centre;
    let mut observations = present;
    if free && information > 0.0 {
        value += cross / information;
        squares -= cross * cross / information;
        if unit_root {
            // Flat prior on the level: its integral leaves n − 1 contrasts.
            observations -= 1;
            log_determinant += information.ln();
        }
    } else if unit_root {
        return None;
    }
    let likelihood = concentrated(observations, squares, log_determinant)?;
    Some(Likelihood {
        mean: value,
        mean_standard_error: if free && information > 0.0 {
            (likelihood.variance / information).sqrt()
        } else {
            0.0
        },
        ..likelihood
    })
}

/// The sums by the filter's steady state, which is the process itself.
///
/// Of order N = r exactly. Only the first column of `f` is not a shift, which the pass takes
/// advantage of.
fn steady<const N: usize>(
    samples: &[f64],
    centre: f64,
    (phi, theta): (&[f64], &[f64]),
    unit_root: bool,
) -> Option<Sums> {
    let start = initial_covariance(phi, theta, unit_root)?;
    let p0 = std::array::from_fn(|i| std::array::from_fn(|j| start[(i, j)]));
    let at = |c: &[f64], i: usize| c.get(i).copied().unwrap_or(0.0);
    let gain: [f64; N] = std::array::from_fn(|i| at(phi, i) - at(theta, i));
    let f = |i: usize, j: usize| match j {
        0 => at(phi, i),
        _ => f64::from(i + 1 == j),
    };
    let model = Innovations {
        f: std::array::from_fn(|i| std::array::from_fn(|j| f(i, j))),
        h: std::array::from_fn(|i| f64::from(i == 0)),
        gain,
        q: std::array::from_fn(|i| std::array::from_fn(|j| gain[i] * gain[j])),
        p: [[0.0; N]; N],
    };
    steady::sums(samples, centre, &model, &p0)
}

/// The sums by the filter, one sample after the other.
///
/// With `free` the series of ones runs beside the record; its innovations are the regressor of the
/// level.
fn one_by_one(
    samples: &[f64],
    centre: f64,
    (phi, theta): (&[f64], &[f64]),
    unit_root: bool,
    free: bool,
) -> Option<Sums> {
    let mut ones = Estimate::new(phi.len().max(theta.len()));
    let mut sums = Sums::default();
    run(samples, centre, (phi, theta), unit_root, |gain, seen| {
        let Some((v, q)) = seen else {
            ones.advance(phi, gain, 0.0);
            return;
        };
        sums.squares += v * v / (1.0 + q);
        sums.log_determinant += q.ln_1p();
        sums.present += 1;
        if free {
            let o = 1.0 - ones.predicted();
            ones.advance(phi, gain, o);
            sums.cross += v * o / (1.0 + q);
            sums.ones += o * o / (1.0 + q);
        }
    })?;
    Some(sums)
}

/// One-step innovations divided by their standard deviations, `v/√(σ² V)`: white with unit variance
/// when the model is right. NaN where the sample is missing. With `unit_root`, `level` is the
/// estimated starting level.
///
/// `None` where φ is not stationary to working precision.
pub(super) fn standardised(
    samples: &[f64],
    level: f64,
    phi: &[f64],
    theta: &[f64],
    sigma: f64,
    unit_root: bool,
) -> Option<Vec<f64>> {
    let mut residuals = Vec::with_capacity(samples.len());
    run(samples, level, (phi, theta), unit_root, |_, seen| {
        let residual = seen.map(|(v, q)| v / (sigma * (1.0 + q).sqrt()));
        residuals.push(residual.unwrap_or(f64::NAN));
    })?;
    Some(residuals)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_steady_state_and_the_filter_agree() {
        let mut seed = 1u64;
        let mut uniform = || {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let mut slow = 0.0;
        let mut x: Vec<f64> = (0..5000)
            .map(|_| {
                slow = 0.999 * slow + 0.05 * uniform();
                slow + uniform()
            })
            .collect();
        for missing in [0..1, 70..71, 72..90, 512..513, 2000..2700, 4999..5000] {
            x[missing].fill(f64::NAN);
        }
        for (phi, theta, unit_root) in [
            (&[0.9995][..], &[0.994][..], false),
            (&[0.5, -0.2], &[], false),
            (&[], &[0.6, -0.3, 0.2], false),
            (&[1.2, -0.5, 0.3, -0.1], &[0.6, -0.2, -0.1], false),
            (&[0.1, 0.0, 0.0, 0.0, 0.0, 0.3], &[0.2], false),
            (&[1.0], &[0.9], true),
            (&[1.3, -0.3], &[0.97], true),
        ] {
            for mean in [Mean::Known(0.01), Mean::Estimated] {
                let found = with_gaps(&x, mean, 0.02, phi, theta, unit_root).unwrap();
                let exact = filtered(&x, mean, 0.02, phi, theta, unit_root).unwrap();
                let miss = found.log_likelihood - exact.log_likelihood;
                // 5000 terms of 1e-16, and the start's variance of up to 1e3.
                assert!(miss.abs() < 1e-8, "{phi:?} {theta:?} {mean:?}: {miss:e}");
                assert!((found.mean - exact.mean).abs() < 1e-8 * exact.variance.sqrt());
                assert_eq!(found.observations, exact.observations);
            }
        }
    }
}
