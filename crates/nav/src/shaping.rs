//! Shaping filters: every noise model of a sensor axis as a linear filter driven by white noise.
//!
//! ```text
//! x_{k+1} = F x_k + G w_k,    ε_k = H x_k + D w_k,    w_k ~ N(0, I)
//! ```
//!
//! One step is one sample interval T. The driving noise enters only through its second moments
//! `q = G Gᵀ`, `s = G Dᵀ`, `r = D Dᵀ`, so these are what is stored; a sum of filters is then a sum
//! of blocks. `s` is the cross-covariance between the bias's noise and the measurement's own noise:
//! leaving it out is a different model. Hamilton 1994, chapter 13 (state space); Gardner, Harvey &
//! Phillips 1980 (ARMA companion form); Box, Jenkins & Reinsel for the sign of θ.
//!
//! ε is an angular-rate or specific-force error, [rad/s] or [m/s²]; "unit" below is either.
//!
//! ```
//! use undrift_nav::shaping::ShapingFilter;
//! // White noise of 2 deg/√h and a Gauss-Markov bias of 25 deg/h over an hour, at 200 Hz.
//! let (deg, hour) = (1f64.to_radians(), 3600.0);
//! let white = ShapingFilter::white(2.0 * deg / 60.0, 0.005)?;
//! let bias = ShapingFilter::gauss_markov(25.0 * deg / hour, hour, 0.005)?;
//! let gyro = white.plus(&bias)?;
//! assert_eq!(gyro.order, 1);
//! # Ok::<(), undrift_nav::shaping::ShapingError>(())
//! ```

pub mod innovations;
mod matrix;
pub mod rate;

use core::fmt;
use libm::{exp, expm1};
use matrix::{apply, dot, product, semidefinite_cholesky, transpose};

/// Most states that the model of one axis may have: an ARMA(6, 6), or sums such as two Gauss-Markov processes and a turn-on constant.
pub const MAX_ORDER: usize = 6;

/// A square matrix of one axis's states, by rows; only the leading `order` rows and columns are used.
pub type AxisMatrix = [[f64; MAX_ORDER]; MAX_ORDER];
/// A vector of one axis's states; only the leading `order` entries are used.
pub type AxisVector = [f64; MAX_ORDER];

/// The noise model of one sensor axis. Fields beyond `order` are zero.
///
/// Made by the constructors, from continuous quantities of a data sheet or a fit, and added with [`ShapingFilter::plus`]. By hand it
/// may be made, too: [`Filter::new`](crate::filter::Filter::new) checks the order, but not that the moments are those of a
/// noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapingFilter {
    /// Number of states.
    pub order: usize,
    /// Sample interval T \[s\] of one step.
    pub interval: f64,
    /// Transition F over one step [–, or of the states' units].
    pub f: AxisMatrix,
    /// Output row H: the part of ε that can be predicted is `h · x` \[unit\].
    pub h: AxisVector,
    /// Driving covariance `G Gᵀ` of the states over one step.
    pub q: AxisMatrix,
    /// Cross-covariance `G Dᵀ` of the states' noise with that of the measurement; zero unless the model is an ARMA.
    pub s: AxisVector,
    /// Direct variance `D Dᵀ` \[unit²\] of one sample.
    pub r: f64,
    /// Covariance of the state before the first sample: stationary, or of the turn-on.
    pub p0: AxisMatrix,
}

/// Why a shaping filter cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapingError {
    /// A parameter, named here, is not finite, or negative where it may not be, or the interval is not positive.
    BadParameter(&'static str),
    /// More states than [`MAX_ORDER`].
    TooManyStates {
        /// States asked for.
        order: usize,
    },
    /// The autoregressive part has a root outside the unit circle, or more than one on it.
    Unstable,
    /// Two filters of different sample intervals were added.
    IntervalsDiffer,
    /// F has no real logarithm (a pole at zero or on the negative real axis): the model exists at
    /// its own rate only; identify it again at the rate wanted.
    NoRealLogarithm,
    /// The coloured part alone has no valid spectrum at the rate wanted.
    NoModelAtRate,
}

impl fmt::Display for ShapingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadParameter(what) => write!(f, "{what} must be finite and not negative"),
            Self::TooManyStates { order } => {
                write!(f, "the noise model has {order} states, at most {MAX_ORDER} fit one axis")
            }
            Self::Unstable => f.write_str(
                "the autoregressive part is unstable: its roots must lie inside the unit circle, one may be 1",
            ),
            Self::IntervalsDiffer => f.write_str("noise models of different sample rates cannot be added"),
            Self::NoRealLogarithm => f.write_str(
                "the model cannot be converted to another sample rate (a pole at zero or on the negative real axis); identify it at the rate of use",
            ),
            Self::NoModelAtRate => f.write_str(
                "the model has no valid spectrum at the requested sample rate; identify it at the rate of use",
            ),
        }
    }
}

impl core::error::Error for ShapingError {}

fn not_negative(value: f64, what: &'static str) -> Result<f64, ShapingError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(ShapingError::BadParameter(what))
    }
}

impl ShapingFilter {
    /// No error at all: order 0, no noise. `interval` is T \[s\], the time between samples.
    ///
    /// # Errors
    /// [`ShapingError::BadParameter`] for an interval that is not positive and finite.
    pub fn none(interval: f64) -> Result<Self, ShapingError> {
        if !(interval.is_finite() && interval > 0.0) {
            return Err(ShapingError::BadParameter("the sample interval"));
        }
        Ok(Self {
            order: 0,
            interval,
            f: [[0.0; MAX_ORDER]; MAX_ORDER],
            h: [0.0; MAX_ORDER],
            q: [[0.0; MAX_ORDER]; MAX_ORDER],
            s: [0.0; MAX_ORDER],
            r: 0.0,
            p0: [[0.0; MAX_ORDER]; MAX_ORDER],
        })
    }

    fn single_state(f: f64, q: f64, p0: f64, interval: f64) -> Result<Self, ShapingError> {
        let mut filter = Self::none(interval)?;
        filter.order = 1;
        filter.f[0][0] = f;
        filter.h[0] = 1.0;
        filter.q[0][0] = q;
        filter.p0[0][0] = p0;
        Ok(filter)
    }

    /// White noise of density `density` [unit/√Hz = unit·√s], the angle or velocity
    /// random walk N: variance N²/T a sample of `interval` T \[s\], no state. IEEE Std 952, annex C.
    ///
    /// # Errors
    /// [`ShapingError::BadParameter`] for a density that is negative or not finite, or such an interval \[s\].
    ///
    /// ```
    /// use undrift_nav::shaping::ShapingFilter;
    /// // 0.15 deg/√h at 100 Hz: a sample scatters by N/√T, the sum over an hour by 0.15 deg.
    /// let white = ShapingFilter::white(0.15_f64.to_radians() / 60.0, 0.01)?;
    /// let angle_in_an_hour = (white.r * 0.01 * 0.01 * 360_000.0).sqrt();
    /// assert!((angle_in_an_hour.to_degrees() - 0.15).abs() < 1e-12);
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub fn white(density: f64, interval: f64) -> Result<Self, ShapingError> {
        let mut filter = Self::none(interval)?;
        let density = not_negative(density, "the white noise density")?;
        filter.r = density * density / interval;
        Ok(filter)
    }

    /// A turn-on constant with standard deviation `sigma` \[unit\]; `interval` \[s\]. One state, without noise.
    ///
    /// # Errors
    /// As [`ShapingFilter::white`], of `sigma`.
    pub fn constant(sigma: f64, interval: f64) -> Result<Self, ShapingError> {
        let sigma = not_negative(sigma, "the turn-on bias")?;
        Self::single_state(1.0, 0.0, sigma * sigma, interval)
    }

    /// Random walk of the bias with coefficient `k` `[unit/√s]`, starting at zero: variance K² t after t. `interval` \[s\]. IEEE Std 952,
    /// annex C.
    ///
    /// # Errors
    /// As [`ShapingFilter::white`], of `k`.
    pub fn random_walk(k: f64, interval: f64) -> Result<Self, ShapingError> {
        let k = not_negative(k, "the random walk coefficient")?;
        Self::single_state(1.0, k * k * interval, 0.0, interval)
    }

    /// First-order Gauss-Markov process with standard deviation `sigma` \[unit\] and correlation time
    /// `tau` \[s\], stationary: autocovariance `σ² exp(−|t|/τ)`. `interval` \[s\]. Groves section 14.2.6.
    ///
    /// Bias instability of a data sheet is modelled by it, with a correlation time of some minutes where none is given.
    ///
    /// # Errors
    /// As [`ShapingFilter::white`], of `sigma`; for a `tau` that is not positive and finite too.
    ///
    /// ```
    /// use undrift_nav::shaping::ShapingFilter;
    /// let bias = ShapingFilter::gauss_markov(1e-4, 100.0, 0.01)?;
    /// let mut lags = vec![0.0; 10_001]; // Up to the correlation time.
    /// bias.autocovariance(&mut lags);
    /// assert!((lags[0] / 1e-8 - 1.0).abs() < 1e-12);
    /// assert!((lags[10_000] / lags[0] - (-1.0_f64).exp()).abs() < 1e-9);
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub fn gauss_markov(sigma: f64, tau: f64, interval: f64) -> Result<Self, ShapingError> {
        let sigma = not_negative(sigma, "the Gauss-Markov standard deviation")?;
        if !(tau > 0.0 && tau.is_finite()) {
            return Err(ShapingError::BadParameter("the correlation time"));
        }
        let variance = sigma * sigma;
        // 1 − φ² by expm1: φ is 1 to ten digits for a slow process.
        let q = -variance * expm1(-2.0 * interval / tau);
        Self::single_state(exp(-interval / tau), q, variance, interval)
    }

    /// AR(p): `x_t − φ1 x_{t−1} − … = a_t`, `a_t ~ N(0, sigma²)` \[unit\], at the rate of `interval` \[s\]; [`ShapingFilter::arma`] without θ.
    ///
    /// # Errors
    /// As [`ShapingFilter::arma`].
    pub fn ar(phi: &[f64], sigma: f64, interval: f64) -> Result<Self, ShapingError> {
        Self::arma(phi, &[], sigma, interval)
    }

    /// ARMA(p, q) in innovations form with max(p, q) states, exact:
    /// `x_t − φ1 x_{t−1} − … − φp x_{t−p} = a_t − θ1 a_{t−1} − … − θq a_{t−q}`, `a_t ~ N(0, sigma²)` \[unit\].
    ///
    /// F is the companion matrix of φ (first column φ, ones above the diagonal),
    /// `G_i = (φ_i − θ_i) σ`, `H = [1 0 …]`, `D = σ`. One root of φ may be exactly 1: the random
    /// walk it makes starts at zero, the rest stationary.
    ///
    /// # Errors
    /// [`ShapingError::BadParameter`] for a number that is not finite, a negative `sigma` or an interval that
    /// is not positive; [`ShapingError::TooManyStates`]; [`ShapingError::Unstable`] for a root of φ outside
    /// the unit circle, or more than the one at 1 on it.
    ///
    /// ```
    /// use undrift_nav::shaping::ShapingFilter;
    /// // The source paper's gyro: ARMA(1, 1) with φ = 1, θ = 0.9994 at 100 Hz, that is white noise over a slow random walk.
    /// let gyro = ShapingFilter::arma(&[1.0], &[0.9994], 0.01, 0.01)?;
    /// assert_eq!(gyro.order, 1);
    /// let walk = (1.0 - 0.9994) * 0.01; // Standard deviation of a step, (1 − θ) σ.
    /// assert!((gyro.q[0][0] - walk * walk).abs() < 1e-20);
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub fn arma(
        phi: &[f64],
        theta: &[f64],
        sigma: f64,
        interval: f64,
    ) -> Result<Self, ShapingError> {
        let sigma = not_negative(sigma, "the innovations' standard deviation")?;
        if phi.iter().chain(theta).any(|c| !c.is_finite()) {
            return Err(ShapingError::BadParameter("every ARMA coefficient"));
        }
        let mut filter = Self::none(interval)?;
        let order = phi.len().max(theta.len());
        if order > MAX_ORDER {
            return Err(ShapingError::TooManyStates { order });
        }
        filter.order = order;
        let coefficient = |of: &[f64], i: usize| of.get(i).copied().unwrap_or(0.0);
        let mut g = [0.0; MAX_ORDER];
        for i in 0..order {
            filter.f[i][0] = coefficient(phi, i);
            if i + 1 < order {
                filter.f[i][i + 1] = 1.0;
            }
            g[i] = (coefficient(phi, i) - coefficient(theta, i)) * sigma;
        }
        for i in 0..order {
            filter.s[i] = g[i] * sigma;
            for j in 0..order {
                filter.q[i][j] = g[i] * g[j];
            }
        }
        filter.r = sigma * sigma;
        if order > 0 {
            filter.h[0] = 1.0;
        }
        filter.p0 = filter.stationary_covariance()?;
        Ok(filter)
    }

    /// Covariance of the stationary state, `P = F P Fᵀ + q`, by doubling. Where φ has one root at
    /// exactly 1 (companion form), that of the stable part: the unit root's mode is projected out.
    fn stationary_covariance(&self) -> Result<AxisMatrix, ShapingError> {
        let n = self.order;
        let mut f = self.f;
        let mut p = self.q;
        let sum: f64 = (0..n).map(|i| self.f[i][0]).sum();
        if n > 0 && (sum - 1.0).abs() < 1e-13 {
            // Left eigenvector of the companion matrix at 1: all ones. Right: 1, 1−φ1, 1−φ1−φ2, …
            let mut right = [0.0; MAX_ORDER];
            let mut tail = 1.0;
            for i in 0..n {
                right[i] = tail;
                tail -= self.f[i][0];
            }
            let norm: f64 = right[..n].iter().sum();
            if norm.abs() < 1e-9 {
                return Err(ShapingError::Unstable); // a double root at 1
            }
            let mut keep = [[0.0; MAX_ORDER]; MAX_ORDER];
            for i in 0..n {
                for j in 0..n {
                    keep[i][j] = f64::from(i == j) - right[i] / norm;
                }
            }
            f = product(&keep, &f, n);
            p = product(&product(&keep, &p, n), &transpose(&keep, n), n);
        }
        // P ← P + F P Fᵀ, F ← F²: 2^60 steps; a slower pole than that is no stationary one.
        for _ in 0..60 {
            let step = product(&product(&f, &p, n), &transpose(&f, n), n);
            let mut change = 0.0f64;
            let mut size = 0.0f64;
            for i in 0..n {
                for j in 0..n {
                    p[i][j] += step[i][j];
                }
                change = change.max(step[i][i].abs());
                size = size.max(p[i][i].abs());
            }
            if !size.is_finite() {
                return Err(ShapingError::Unstable);
            }
            f = product(&f, &f, n);
            let gain = (0..n)
                .flat_map(|i| (0..n).map(move |j| (i, j)))
                .fold(0.0f64, |m, (i, j)| m.max(f[i][j].abs()));
            if !gain.is_finite() || gain > 1e6 {
                return Err(ShapingError::Unstable);
            }
            if change <= 1e-17 * size && gain < 1e-8 {
                return Ok(p);
            }
        }
        Err(ShapingError::Unstable)
    }

    /// The sum of two independent errors. A random walk and a constant (or two of either) share
    /// one state, since their sum is again a random walk.
    ///
    /// # Errors
    /// [`ShapingError::IntervalsDiffer`]; [`ShapingError::TooManyStates`] where both do not fit one axis.
    ///
    /// ```
    /// use undrift_nav::shaping::{ShapingError, ShapingFilter};
    /// // A walk that starts at a turn-on constant: one state for both.
    /// let walk = ShapingFilter::random_walk(1e-5, 0.01)?.plus(&ShapingFilter::constant(1e-3, 0.01)?)?;
    /// assert_eq!((walk.order, walk.p0[0][0]), (1, 1e-6));
    /// let other_rate = ShapingFilter::white(1e-3, 0.005)?;
    /// assert_eq!(walk.plus(&other_rate), Err(ShapingError::IntervalsDiffer));
    /// # Ok::<(), ShapingError>(())
    /// ```
    pub fn plus(&self, other: &Self) -> Result<Self, ShapingError> {
        if self.interval != other.interval {
            return Err(ShapingError::IntervalsDiffer);
        }
        let mut sum = *self;
        sum.r += other.r;
        if let (Some(mine), Some(0), 1) = (self.integrator(), other.integrator(), other.order) {
            sum.q[mine][mine] += other.q[0][0];
            sum.s[mine] += other.s[0];
            sum.p0[mine][mine] += other.p0[0][0];
            return Ok(sum);
        }
        let (n, m) = (self.order, other.order);
        if n + m > MAX_ORDER {
            return Err(ShapingError::TooManyStates { order: n + m });
        }
        sum.order = n + m;
        for i in 0..m {
            for j in 0..m {
                sum.f[n + i][n + j] = other.f[i][j];
                sum.q[n + i][n + j] = other.q[i][j];
                sum.p0[n + i][n + j] = other.p0[i][j];
            }
            sum.h[n + i] = other.h[i];
            sum.s[n + i] = other.s[i];
        }
        Ok(sum)
    }

    /// The state that is a pure integrator read out with 1 and coupled to no other, if there is one.
    fn integrator(&self) -> Option<usize> {
        let n = self.order;
        (0..n).find(|&i| {
            self.h[i] == 1.0
                && (0..n).all(|j| {
                    let expected = f64::from(i == j);
                    self.f[i][j] == expected
                        && self.f[j][i] == expected
                        && (i == j || (self.q[i][j] == 0.0 && self.p0[i][j] == 0.0))
                })
        })
    }

    /// Autocovariance of ε at lags 0, 1, … samples \[unit²\], into `out`, as many as it has room for; started from `p0` as if it were
    /// stationary.
    ///
    /// ```
    /// use undrift_nav::shaping::ShapingFilter;
    /// let mut lags = [0.0; 3];
    /// ShapingFilter::ar(&[0.5], 1.0, 0.01)?.autocovariance(&mut lags);
    /// assert!((lags[0] - 4.0 / 3.0).abs() < 1e-12 && (lags[2] / lags[0] - 0.25).abs() < 1e-12); // σ²/(1 − φ²), φᵏ.
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub fn autocovariance(&self, out: &mut [f64]) {
        let n = self.order;
        // N = F P Hᵀ + S is the covariance of x_{k+1} with ε_k.
        let mut carried = [0.0; MAX_ORDER];
        let ph = apply(&self.p0, &self.h, n);
        let fph = apply(&self.f, &ph, n);
        for i in 0..n {
            carried[i] = fph[i] + self.s[i];
        }
        for (lag, slot) in out.iter_mut().enumerate() {
            if lag == 0 {
                *slot = dot(&self.h, &ph, n) + self.r;
            } else {
                *slot = dot(&self.h, &carried, n);
                carried = apply(&self.f, &carried, n);
            }
        }
    }

    /// Joint factor of one sample's noise: lower-triangular L with `L Lᵀ` the covariance of
    /// `[D w; G w]` (row 0 the measurement's own noise, rows 1… the states'), for simulation.
    /// Semi-definite is fine: a zero pivot leaves a zero column.
    pub fn noise_factor(&self) -> [[f64; MAX_ORDER + 1]; MAX_ORDER + 1] {
        semidefinite_cholesky(&self.noise_covariance(), self.order + 1)
    }

    /// Joint covariance of one sample's noise, of `[D w; G w]`.
    fn noise_covariance(&self) -> [[f64; MAX_ORDER + 1]; MAX_ORDER + 1] {
        let mut joint = [[0.0; MAX_ORDER + 1]; MAX_ORDER + 1];
        joint[0][0] = self.r;
        for i in 0..self.order {
            joint[i + 1][0] = self.s[i];
            joint[0][i + 1] = self.s[i];
            for j in 0..self.order {
                joint[i + 1][j + 1] = self.q[i][j];
            }
        }
        joint
    }

    /// Lower-triangular factor L of the initial covariance, `L Lᵀ = p0`, for simulation: the first state is `L` times standard normal numbers.
    pub fn initial_factor(&self) -> AxisMatrix {
        semidefinite_cholesky(&self.p0, self.order)
    }
}

#[cfg(test)]
mod tests;
