//! Innovations form of a shaping filter, and the ARMA coefficients it represents.
//!
//! Any filter's ε has the same second moments as one driven by a single noise, `G = K D`: its own
//! one-step predictor. Anderson & Moore 1979, Optimal Filtering, chapter 9.

use super::matrix::{apply, combine, dot, identity, norm, product, solve, transpose};
use super::{AxisMatrix, AxisVector, MAX_ORDER, ShapingError, ShapingFilter};
use libm::sqrt;

/// 2^40 steps: a zero nearer to the unit circle than their inverse counts as on it.
const DOUBLINGS: usize = 40;

/// Coefficients of an ARMA(n, n): `x_t − φ1 x_{t−1} − … = a_t − θ1 a_{t−1} − …`, `a_t ~ N(0, σ²)`. An ARMA(p, q) has zeros
/// behind its p and q.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmaCoefficients {
    /// Number n of coefficients used of `phi` and `theta`.
    pub order: usize,
    /// Autoregressive φ1…φn; zero beyond.
    pub phi: AxisVector,
    /// Moving-average θ1…θn, in the sign of the equation above; zero beyond.
    pub theta: AxisVector,
    /// Standard deviation σ of the innovations \[unit\].
    pub sigma: f64,
}

impl ShapingFilter {
    /// The filter driven by one noise (rank-one joint covariance, invertible) whose ε has the same
    /// autocovariance. The state becomes its own prediction from the past of ε; `p0` loses the
    /// prediction's steady variance, and is kept from becoming negative.
    ///
    /// # Errors
    /// [`ShapingError::NoModelAtRate`] if no spectrum belongs to the covariances, or it has a zero
    /// on the unit circle that the recursion cannot settle on.
    ///
    /// Useful where one noise a sample is wanted (simulation, an ARMA's coefficients), or to compare models by their one-step
    /// prediction error `r`.
    ///
    /// ```
    /// use undrift_nav::shaping::ShapingFilter;
    /// let (q, r) = (1e-4, 1.0); // Variance of a step of the walk and of the white noise, at 1 Hz.
    /// let sum = ShapingFilter::white(1.0, 1.0)?.plus(&ShapingFilter::random_walk(1e-2, 1.0)?)?;
    /// // The prediction's steady variance solves p² = q (p + r); the innovations have p + r.
    /// let p = 0.5 * (q + f64::sqrt(q * q + 4.0 * q * r));
    /// assert!((sum.innovations_form()?.r - (p + r)).abs() < 1e-12);
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub fn innovations_form(&self) -> Result<Self, ShapingError> {
        if !self.is_driven() {
            return Ok(*self);
        }
        // Any symmetric X gives an equal model (q + FXFᵀ − X, s + FXHᵀ, r + HXHᵀ, p0 − X). The
        // second choice reaches the models whose coloured part has a negative variance at lag 0.
        let zero = [[0.0; MAX_ORDER]; MAX_ORDER];
        self.shifted(&zero)
            .settle()
            .or_else(|| self.shifted(&self.p0).settle())
            .ok_or(ShapingError::NoModelAtRate)
    }

    /// The ARMA(n, n) with the autocovariance of ε; trailing coefficients may be zero.
    ///
    /// # Errors
    /// As [`ShapingFilter::innovations_form`]; [`ShapingError::NoModelAtRate`] too if there is no
    /// noise at all but there are noise-driven states.
    ///
    /// ```
    /// use undrift_nav::shaping::ShapingFilter;
    /// // White noise over a random walk is an ARMA(1, 1) with φ = 1 and θ just below.
    /// let walk = ShapingFilter::white(1e-3, 0.01)?.plus(&ShapingFilter::random_walk(1e-4, 0.01)?)?;
    /// let arma = walk.arma_coefficients()?;
    /// assert!((arma.phi[0] - 1.0).abs() < 1e-12);
    /// assert!((1.0 - arma.theta[0] - 1e-3).abs() < 1e-5); // K T / N: the walk of a step over the white noise.
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub fn arma_coefficients(&self) -> Result<ArmaCoefficients, ShapingError> {
        let n = self.order;
        let form = self.innovations_form()?;
        let mut arma = ArmaCoefficients {
            order: n,
            phi: [0.0; MAX_ORDER],
            theta: [0.0; MAX_ORDER],
            sigma: sqrt(form.r.max(0.0)),
        };
        if !form.is_driven() {
            arma.order = 0;
            return Ok(arma);
        }
        // Characteristic polynomial by Faddeev and LeVerrier.
        let mut m = identity(n);
        for k in 0..n {
            let fm = product(&form.f, &m, n);
            let trace: f64 = (0..n).map(|i| fm[i][i]).sum();
            arma.phi[k] = trace / (k + 1) as f64;
            m = combine(1.0, &fm, -arma.phi[k], &identity(n));
        }
        // ψ_j = H F^{j−1} K, and θ(B) = φ(B) ψ(B).
        let mut psi = [0.0; MAX_ORDER];
        let mut column = form.s.map(|s| s / form.r);
        for j in 0..n {
            psi[j] = dot(&form.h, &column, n);
            column = apply(&form.f, &column, n);
            let carried: f64 = (0..j).map(|i| arma.phi[i] * psi[j - 1 - i]).sum();
            arma.theta[j] = arma.phi[j] + carried - psi[j];
        }
        Ok(arma)
    }

    /// Whether any noise reaches the states.
    fn is_driven(&self) -> bool {
        norm(&self.q) != 0.0 || self.s.iter().any(|s| *s != 0.0)
    }

    fn shifted(&self, x: &AxisMatrix) -> Self {
        let n = self.order;
        let mut equal = *self;
        let xh = apply(x, &self.h, n);
        let fxh = apply(&self.f, &xh, n);
        let fxf = product(&product(&self.f, x, n), &transpose(&self.f, n), n);
        for i in 0..n {
            equal.s[i] += fxh[i];
            for j in 0..n {
                equal.q[i][j] += fxf[i][j] - x[i][j];
                equal.p0[i][j] -= x[i][j];
            }
        }
        equal.r += dot(&self.h, &xh, n);
        equal
    }

    /// The Riccati recursion `P ← FPFᵀ + q − (FPHᵀ + s)(HPHᵀ + r)⁻¹(…)ᵀ` from P = 0, run by
    /// doubling: step k is its 2^k-th iterate. Chu, Fan, Lin & Wang 2004. None if it does not
    /// settle on an invertible filter.
    fn settle(&self) -> Option<Self> {
        let n = self.order;
        if !(self.r > 0.0 && self.r.is_finite()) {
            return None;
        }
        // Without cross-covariance: A = (F − s r⁻¹ H)ᵀ, M = Hᵀ r⁻¹ H, P₁ = q − s r⁻¹ sᵀ.
        let (mut a, mut m, mut p) = (self.f, self.q, self.q);
        for i in 0..n {
            for j in 0..n {
                a[j][i] = self.f[i][j] - self.s[i] * self.h[j] / self.r;
                m[i][j] = self.h[i] * self.h[j] / self.r;
                p[i][j] = self.q[i][j] - self.s[i] * self.s[j] / self.r;
            }
        }
        let one = identity(n);
        let mut bounded = false;
        let mut best = (f64::INFINITY, p);
        for _ in 0..DOUBLINGS {
            let w = combine(1.0, &one, 1.0, &product(&m, &p, n));
            let wa = solve(&w, &a, n)?;
            let wm = solve(&w, &m, n)?;
            let at = transpose(&a, n);
            let dm = product(&product(&a, &wm, n), &at, n);
            let dp = product(&product(&at, &p, n), &wa, n);
            m = combine(1.0, &m, 1.0, &dm);
            p = combine(1.0, &p, 1.0, &dp);
            for i in 0..n {
                for j in 0..i {
                    p[i][j] = 0.5 * (p[i][j] + p[j][i]);
                    p[j][i] = p[i][j];
                }
            }
            a = product(&a, &wa, n);
            if !norm(&p).is_finite() || !norm(&m).is_finite() {
                return None;
            }
            // A grows where P = 0 is the fixed point of the wrong side, with zeros outside the unit
            // circle; it stays bounded for a constant, which nothing drives.
            let gain = norm(&a);
            if !gain.is_finite() {
                return None;
            }
            bounded = gain < 1e6;
            // Relative to P itself: P may be ten million times smaller than r.
            let step = norm(&dp);
            let change = if step == 0.0 { 0.0 } else { step / norm(&p) };
            if change <= best.0 {
                best = (change, p);
            }
            // Done, or at a zero on the circle, where rounding takes over at the root of its size.
            if (change <= 1e-16 && gain < 1e-3) || (best.0 < 1e-6 && change > 1e3 * best.0) {
                break;
            }
        }
        if !bounded || best.0 > 1e-6 {
            return None;
        }
        self.driven_by_innovations(&best.1)
    }

    fn driven_by_innovations(&self, p: &AxisMatrix) -> Option<Self> {
        let n = self.order;
        let ph = apply(p, &self.h, n);
        let fph = apply(&self.f, &ph, n);
        let variance = dot(&self.h, &ph, n) + self.r;
        if variance.is_nan() || variance <= 0.0 {
            return None;
        }
        let mut form = *self;
        form.r = variance;
        for i in 0..n {
            form.s[i] = fph[i] + self.s[i];
        }
        let fpf = product(&product(&self.f, p, n), &transpose(&self.f, n), n);
        for i in 0..n {
            for j in 0..n {
                form.q[i][j] = form.s[i] * form.s[j] / variance;
                form.p0[i][j] -= p[i][j];
                // The fixed point must hold: a recursion that ran off may still have stopped.
                let miss = fpf[i][j] + self.q[i][j] - form.q[i][j] - p[i][j];
                let size = fpf[i][j].abs() + self.q[i][j].abs() + form.q[i][j] + norm(p);
                if miss.is_nan() || miss.abs() > 1e-8 * size {
                    return None;
                }
            }
        }
        form.p0 = semidefinite_part(&form.p0, n);
        Some(form)
    }
}

/// The covariance as it is, if it is one; else its variances alone, what is negative set to zero.
fn semidefinite_part(p: &AxisMatrix, n: usize) -> AxisMatrix {
    let l = super::semidefinite_cholesky(p, n);
    let made = product(&l, &transpose(&l, n), n);
    let mut variances = [[0.0; MAX_ORDER]; MAX_ORDER];
    let mut valid = true;
    for i in 0..n {
        variances[i][i] = p[i][i].max(0.0);
        for j in 0..n {
            let size = sqrt((p[i][i] * p[j][j]).max(0.0));
            valid &= (made[i][j] - p[i][j]).abs() <= 1e-9 * size;
        }
    }
    if valid { made } else { variances }
}

#[cfg(test)]
mod tests {
    use super::*;
    const T: f64 = 0.01;

    #[test]
    fn white_and_gauss_markov_is_arma11() {
        // AR(1) + white as ARMA(1,1): θ solves θ² − bθ + 1 = 0 with b from the autocovariance of
        // (1 − φB)ε: c0 = q + r(1 + φ²), c1 = −φ r, b = −c0/c1. Hamilton 1994, section 4.7.
        let (sigma, tau, density) = (0.3, 2.0, 0.02);
        let white = ShapingFilter::white(density, T).unwrap();
        let bias = ShapingFilter::gauss_markov(sigma, tau, T).unwrap();
        let arma = white.plus(&bias).unwrap().arma_coefficients().unwrap();
        let (phi, q, r) = (bias.f[0][0], bias.q[0][0], white.r);
        let b = (q + r * (1.0 + phi * phi)) / (phi * r);
        let theta = 0.5 * b - sqrt(0.25 * b * b - 1.0);
        assert!((arma.phi[0] - phi).abs() < 1e-15);
        // b is near 2: its root loses six digits.
        assert!(
            (arma.theta[0] - theta).abs() < 1e-10,
            "{} {theta}",
            arma.theta[0]
        );
        assert!((arma.sigma * arma.sigma - r * phi / theta).abs() < 1e-10 * r);
    }

    #[test]
    fn innovations_form_keeps_the_autocovariance() {
        let sum = ShapingFilter::white(0.02, T)
            .unwrap()
            .plus(&ShapingFilter::gauss_markov(0.3, 2.0, T).unwrap())
            .unwrap()
            .plus(&ShapingFilter::ar(&[1.2, -0.5], 0.05, T).unwrap())
            .unwrap();
        let form = sum.innovations_form().unwrap();
        let (mut a, mut b) = ([0.0; 30], [0.0; 30]);
        sum.autocovariance(&mut a);
        form.autocovariance(&mut b);
        for (x, y) in a.iter().zip(b) {
            assert!((x - y).abs() < 1e-12 * a[0], "{x} {y}");
        }
        let l = form.noise_factor();
        assert!(
            (1..=3).all(|i| l[i][i] < 1e-6 * l[i][0].abs()),
            "one noise only: {l:?}"
        );
    }

    #[test]
    fn coefficients_of_an_arma_are_its_own() {
        let (phi, theta) = ([0.9, -0.3, 0.05], [0.4, 0.2]);
        let arma = ShapingFilter::arma(&phi, &theta, 0.7, T)
            .unwrap()
            .arma_coefficients()
            .unwrap();
        for i in 0..3 {
            assert!((arma.phi[i] - phi[i]).abs() < 1e-14);
            assert!((arma.theta[i] - theta.get(i).copied().unwrap_or(0.0)).abs() < 1e-13);
        }
        assert!((arma.sigma - 0.7).abs() < 1e-14);
    }

    #[test]
    fn noise_beyond_the_unit_circle_comes_back_inside() {
        // θ and 1/θ have the same autocovariance with σ² scaled by θ².
        let arma = ShapingFilter::arma(&[0.5], &[4.0], 1.0, T)
            .unwrap()
            .arma_coefficients()
            .unwrap();
        assert!(
            (arma.theta[0] - 0.25).abs() < 1e-12 && (arma.sigma - 4.0).abs() < 1e-12,
            "{arma:?}"
        );
    }

    #[test]
    fn a_zero_on_the_unit_circle_is_reached() {
        // Differenced white noise beside itself: ε_k = a_k − a_{k−1} through an AR(1).
        let arma = ShapingFilter::arma(&[0.5], &[1.0], 1.0, T).unwrap();
        let shifted = arma.shifted(&arma.p0); // the same model, no longer in innovations form
        assert!(shifted.s != arma.s);
        let found = shifted.arma_coefficients().unwrap();
        // A double zero of the spectrum moves by the root of rounding.
        let miss = (found.theta[0] - 1.0).abs().max((found.sigma - 1.0).abs());
        assert!(miss < 1e-7, "{found:?}");
    }

    #[test]
    fn a_constant_beside_the_noise_stays() {
        let noise = ShapingFilter::white(0.02, T).unwrap();
        let noise = noise
            .plus(&ShapingFilter::gauss_markov(0.3, 2.0, T).unwrap())
            .unwrap();
        let alone = noise.innovations_form().unwrap();
        let sum = noise
            .plus(&ShapingFilter::constant(3.0, T).unwrap())
            .unwrap();
        let form = sum.innovations_form().unwrap();
        assert!((form.r - alone.r).abs() < 1e-15 && (form.s[0] - alone.s[0]).abs() < 1e-15);
        assert_eq!((form.s[1], form.p0[1][1], form.f[1][1]), (0.0, 9.0, 1.0));
    }

    #[test]
    fn impossible_covariances_are_refused() {
        let mut filter = ShapingFilter::arma(&[0.9], &[0.5], 1.0, T).unwrap();
        filter.s[0] = 5.0; // correlation with ε's own noise far above one
        assert_eq!(filter.innovations_form(), Err(ShapingError::NoModelAtRate));
        filter.s[0] = f64::NAN;
        assert_eq!(filter.innovations_form(), Err(ShapingError::NoModelAtRate));
    }
}
