//! Exact Gaussian log-likelihood of an unbroken record: the state before the first sample as a regression.
//!
//! With the state x₀ before the first sample known, the innovations follow the plain recursion
//! `a_t = φ(B) ε_t / θ(B)` and have variance σ² from the first sample on. So with ã the recursion
//! started from zero, `a_t = ã_t − h_t x₀ − μ o_t`, where `h_t = H Aᵗ` (A the companion matrix of θ)
//! is the response to x₀, `h_t = (g_t, g_{t−1}, …)`, g the impulse response of 1/θ(B), and o the
//! recursion run over a record of ones. Integrating x₀ ~ N(0, σ² P), P = L Lᵀ, out of that
//! regression gives, exactly,
//!
//! ```text
//! S = ãᵀã − bᵀL (I + Lᵀ M L)⁻¹ Lᵀb,   |V| = |I + Lᵀ M L|,   b = Σ h_tᵀ ã_t,   M = Σ h_tᵀ h_t
//! −2 log L = N log(2π S/N) + N + log |V|
//! ```
//!
//! (Rosenberg 1973; Ljung & Box 1979; de Jong 1988.) There is no transient to wait for: one step
//! costs the same everywhere.
//!
//! Notation: N samples, r = max(p, q), P the stationary covariance of x₀ in units of σ², L its
//! factor. Assumes a Gaussian process. With other independent innovations it is a quasi-likelihood:
//! φ and θ keep their distribution in long records (Brockwell & Davis 1991, section 10.8), σ² does
//! not.

use super::ArmaError;
use super::kernel::{Accumulated, Coefficients, accumulate, sums_about};
use super::linear::{initial_covariance, semidefinite_cholesky};
use nalgebra::{DMatrix, DVector};

/// Mean of a record, as far as it is known. A constant that was removed as the record's own mean is estimated, not known.
///
/// [`crate::composite::Level`] is the same type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mean {
    /// Given [unit of the record]; 0 for a record whose constant has been removed for good.
    Known(f64),
    /// Estimated with the other parameters, by exact generalised least squares.
    Estimated,
}

/// The likelihood at given coefficients, with σ² (and the mean) at their best values for them.
///
/// Concentrated: what is left to vary are φ and θ. Two models of one record are compared by twice the
/// difference of their log-likelihoods, which for nested models has a χ² distribution with as many degrees of
/// freedom as coefficients were added, as long as no root cancels and none is on the unit circle.
///
/// ```
/// use undrift_noise::arma::{Mean, log_likelihood};
/// // White noise of variance 1 about a known mean: log L = −N/2 (ln 2π + ln σ² + 1).
/// let white = log_likelihood(&[1.0, -1.0, 1.0, -1.0], &[], &[], Mean::Known(0.0), false)?;
/// assert!((white.log_likelihood + 2.0 * (std::f64::consts::TAU.ln() + 1.0)).abs() < 1e-12);
/// assert_eq!((white.variance, white.observations), (1.0, 4));
/// # Ok::<(), undrift_noise::arma::ArmaError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Likelihood {
    /// Exact Gaussian log-likelihood, constants included. A density: it depends on the unit.
    pub log_likelihood: f64,
    /// Sum of squares of the standardised one-step prediction errors, `Σ v²/V` \[unit²\].
    pub sum_of_squares: f64,
    /// σ² = sum of squares over the number of samples \[unit²\].
    pub variance: f64,
    /// The mean, given or estimated \[unit\].
    pub mean: f64,
    /// Standard error of an estimated mean \[unit\]; 0 for a given one. Of a slow process it is far above σ/√N.
    pub mean_standard_error: f64,
    /// Observations that count: samples present, less one where a unit root's level is free.
    pub observations: usize,
}

impl Likelihood {
    /// The likelihood of two independent records with one σ²; the mean stays that of the first.
    ///
    /// Sums of squares and determinants add; σ² is that of all observations together.
    pub(super) fn and(self, other: Self) -> Option<Self> {
        let joint = concentrated(
            self.observations + other.observations,
            self.sum_of_squares + other.sum_of_squares,
            self.log_determinant() + other.log_determinant(),
        );
        joint.map(|joint| Self {
            mean: self.mean,
            mean_standard_error: self.mean_standard_error,
            ..joint
        })
    }

    /// log |V|, which the concentrated likelihood was made with.
    fn log_determinant(&self) -> f64 {
        let n = self.observations as f64;
        -2.0 * self.log_likelihood - n * ((core::f64::consts::TAU * self.variance).ln() + 1.0)
    }
}

/// Exact log-likelihood of `x_t − φ1 x_{t−1} − … = a_t − θ1 a_{t−1} − …` about the mean at several
/// points of the same order, for a record without gaps. `None` where φ is not stationary to working
/// precision or S vanishes.
///
/// One pass of O(N (p + q)) a point, points side by side; r × r matrices after it.
pub(super) fn unbroken(
    samples: &[f64],
    mean: Mean,
    centre: f64,
    points: &[Coefficients],
) -> Vec<Option<Likelihood>> {
    let estimated = mean == Mean::Estimated;
    let centre = match mean {
        Mean::Known(value) => value,
        Mean::Estimated => centre,
    };
    let sums = accumulate(samples, centre, points, estimated);
    points
        .iter()
        .zip(sums)
        .map(|((phi, theta), sums)| integrate(samples.len(), estimated, centre, phi, theta, &sums))
        .collect()
}

/// Integrates the state before the record out.
///
/// The estimated mean is generalised least squares in the same regression; `None` as in
/// [`unbroken`].
fn integrate(
    samples: usize,
    estimated: bool,
    centre: f64,
    phi: &[f64],
    theta: &[f64],
    sums: &Accumulated,
) -> Option<Likelihood> {
    let r = phi.len().max(theta.len());
    let mut squares = sums.squares;
    let mut ones_squares = sums.ones_squares;
    let mut ones_cross = sums.ones_cross;
    let mut log_determinant = 0.0;
    if r > 0 {
        let l = semidefinite_cholesky(&initial_covariance(phi, theta, false)?)?;
        let m = information(sums);
        let w = DMatrix::identity(r, r) + l.tr_mul(&(m * &l));
        let factor = w.cholesky()?.unpack();
        let project =
            |b: &[f64]| factor.solve_lower_triangular(&l.tr_mul(&DVector::from_column_slice(b)));
        let record = project(&sums.state_cross)?;
        squares -= record.norm_squared();
        if estimated {
            let ones = project(&sums.ones_state)?;
            ones_squares -= ones.norm_squared();
            ones_cross -= ones.dot(&record);
        }
        log_determinant = 2.0 * factor.diagonal().map(f64::ln).sum();
    }
    let mut value = centre;
    let mut information = 0.0;
    // With an AR root at 1 to working precision the mean is not identified: leave it.
    if estimated && ones_squares > 1e-13 * sums.ones_squares {
        value += ones_cross / ones_squares;
        squares -= ones_cross * ones_cross / ones_squares;
        information = ones_squares;
    }
    concentrated(samples, squares, log_determinant).map(|likelihood| Likelihood {
        mean: value,
        mean_standard_error: if information > 0.0 {
            (likelihood.variance / information).sqrt()
        } else {
            0.0
        },
        ..likelihood
    })
}

/// M, the information of the record about the state before it, from its first row: each step down the diagonal loses the newest
/// product.
pub(super) fn information(sums: &Accumulated) -> DMatrix<f64> {
    let r = sums.state_lags.len();
    let mut m = DMatrix::zeros(r, r);
    for lag in 0..r {
        let mut value = sums.state_lags[lag];
        for i in 0..r - lag {
            let j = i + lag;
            (m[(i, j)], m[(j, i)]) = (value, value);
            value -= sums.last_impulse[i] * sums.last_impulse[j];
        }
    }
    m
}

/// The concentrated likelihood of `n` observations from S and log |V|.
///
/// σ² = S/n. `None` where S is not positive or anything overflows. The mean is left at 0, for the
/// caller to fill in.
pub(super) fn concentrated(
    observations: usize,
    squares: f64,
    log_determinant: f64,
) -> Option<Likelihood> {
    let n = observations as f64;
    let variance = squares / n;
    let log_likelihood =
        -0.5 * (n * (core::f64::consts::TAU.ln() + variance.ln()) + n + log_determinant);
    (squares > 0.0 && log_likelihood.is_finite()).then_some(Likelihood {
        log_likelihood,
        sum_of_squares: squares,
        variance,
        mean: 0.0,
        mean_standard_error: 0.0,
        observations,
    })
}

/// Rejects what no ARMA likelihood can be computed for; returns the sample mean of what is present
/// and the number of samples present.
///
/// # Errors
/// [`ArmaError::NotFinite`] for an infinite sample; [`ArmaError::TooShort`] for fewer than
/// `parameters` + 3 present; [`ArmaError::Constant`] where all are equal.
pub(super) fn screen(samples: &[f64], parameters: usize) -> Result<(f64, usize), ArmaError> {
    let first = samples.iter().copied().find(|x| !x.is_nan());
    let first = first.unwrap_or(0.0);
    let (mut sum, mut size) = sums_about(samples, first);
    let mut present = samples.len();
    if size.is_nan() {
        // Samples are missing (or infinite): the slow way.
        let (mut sums, mut sizes, mut missing) = ([0.0; 8], [0.0; 8], 0);
        for eight in samples.chunks(8) {
            for (l, x) in eight.iter().enumerate() {
                let off = if x.is_nan() { 0.0 } else { x - first };
                sums[l] += off;
                sizes[l] += off.abs();
                missing += usize::from(x.is_nan());
            }
        }
        (sum, size) = (sums.iter().sum(), sizes.iter().sum());
        present = samples.len() - missing;
    }
    if !size.is_finite() {
        return Err(ArmaError::NotFinite);
    }
    if present < parameters + 3 {
        return Err(ArmaError::TooShort {
            present,
            needed: parameters + 3,
        });
    }
    if size == 0.0 {
        return Err(ArmaError::Constant);
    }
    let mean = first + sum / present as f64;
    if mean.is_finite() {
        Ok((mean, present))
    } else {
        Err(ArmaError::NotFinite)
    }
}
