//! A shaping filter at another sample interval.
//!
//! ε is the sum of a coloured part, a continuous process sampled every T, and of white noise. The
//! autocovariance at lags k ≥ 1, `H F^{k−1} N` with `N = FΣHᵀ + s`, is the coloured part's alone;
//! its value at lag 0 by continuity is `HΣHᵀ + H F⁻¹ s`, and what is left of the variance is white:
//! `W = r − H F⁻¹ s`. At the interval T' = ρT, with `L = log F`:
//!
//! ```text
//! F' = exp(ρL)    s' = F' F⁻¹ s    r' = H F⁻¹ s + W/ρ
//! q' = ∫₀^ρ e^{Lu} C e^{Lᵀu} du    where    q = ∫₀^1 e^{Lu} C e^{Lᵀu} du
//! ```
//!
//! This keeps Σ (where there is one), the white density, and every lag the two rates share. It
//! holds at a unit root, where there is no Σ. Van Loan 1978 for the integrals; Brockwell & Davis
//! 1991, section 3.1, and docs/theory.md, section 2.

use super::matrix::{combine, exponential, halvings, logarithm, norm, solve};
use super::{AxisMatrix, MAX_ORDER, ShapingError, ShapingFilter, apply, dot};
use super::{product, semidefinite_cholesky, transpose};
use libm::{ldexp, sqrt};

const ZERO: AxisMatrix = [[0.0; MAX_ORDER]; MAX_ORDER];
/// Entries of a symmetric matrix.
const PAIRS: usize = MAX_ORDER * (MAX_ORDER + 1) / 2;
type PairMatrix = nalgebra::SMatrix<f64, PAIRS, PAIRS>;
type PairVector = nalgebra::SVector<f64, PAIRS>;

impl ShapingFilter {
    /// The same noise sampled every `interval` \[s\]: white noise keeps its density, the coloured
    /// part its continuous-time process. Where the result has no joint covariance of its noises it
    /// is returned in innovations form, with the same autocovariance.
    ///
    /// # Errors
    /// [`ShapingError::NoRealLogarithm`] for a pole at zero or on the negative real axis,
    /// [`ShapingError::NoModelAtRate`] where the white part would be negative or no spectrum
    /// exists at the new rate.
    ///
    /// ```
    /// use undrift_nav::shaping::ShapingFilter;
    /// // Identified at 200 Hz, used at 50 Hz: a sample of four times the length has a quarter of the white variance.
    /// let model = ShapingFilter::white(1e-3, 0.005)?.plus(&ShapingFilter::gauss_markov(1e-4, 100.0, 0.005)?)?;
    /// let slower = model.at_interval(0.02)?;
    /// assert!((slower.r / model.r - 0.25).abs() < 1e-9);
    /// assert!((slower.f[0][0] - (-0.02_f64 / 100.0).exp()).abs() < 1e-12);
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub fn at_interval(&self, interval: f64) -> Result<Self, ShapingError> {
        let blank = Self::none(interval)?;
        if interval == self.interval {
            return Ok(*self);
        }
        let n = self.order;
        let ratio = interval / self.interval;
        if n == 0 {
            return finite(Self {
                r: self.r / ratio,
                ..blank
            });
        }
        let log = logarithm(&self.f, n).ok_or(ShapingError::NoRealLogarithm)?;
        let scaled = combine(ratio, &log, 0.0, &ZERO);
        let f = exponential(&scaled, n).ok_or(ShapingError::NoModelAtRate)?;

        let mut cross = ZERO;
        for i in 0..n {
            cross[i][0] = self.s[i];
        }
        let back = solve(&self.f, &cross, n).ok_or(ShapingError::NoRealLogarithm)?;
        let mut before = [0.0; MAX_ORDER]; // F⁻¹ s
        for i in 0..n {
            before[i] = back[i][0];
        }
        let coloured = dot(&self.h, &before, n);
        let mut white = self.r - coloured;
        if white.abs() <= 1e-12 * (self.r + coloured.abs()) {
            white = 0.0; // a pure AR has none; that is the rounding of it
        }
        if white.is_nan() || white < 0.0 {
            return Err(ShapingError::NoModelAtRate);
        }
        let density = continuous_density(&log, &self.q, n).ok_or(ShapingError::NoModelAtRate)?;
        let q = driving(&log, &density, ratio, n).ok_or(ShapingError::NoModelAtRate)?;
        let filter = finite(Self {
            order: n,
            f,
            h: self.h,
            q,
            s: apply(&f, &before, n),
            r: coloured + white / ratio,
            p0: self.p0,
            ..blank
        })?;
        if filter.is_semidefinite() {
            Ok(filter)
        } else {
            filter.innovations_form()
        }
    }

    /// Whether the joint covariance of `[D w; G w]` is one, to 1e-9 of its diagonal.
    fn is_semidefinite(&self) -> bool {
        let n = self.order + 1;
        let joint = self.noise_covariance();
        let l = semidefinite_cholesky(&joint, n);
        (0..n).all(|i| {
            (0..=i).all(|j| {
                let made: f64 = (0..n).map(|k| l[i][k] * l[j][k]).sum();
                let size = sqrt((joint[i][i] * joint[j][j]).max(0.0));
                (made - joint[i][j]).abs() <= 1e-9 * size
            })
        })
    }
}

fn finite(filter: ShapingFilter) -> Result<ShapingFilter, ShapingError> {
    let size = norm(&filter.f) + norm(&filter.q) + norm(&filter.p0) + filter.r;
    let cross: f64 = filter.s.iter().sum();
    if (size + cross).is_finite() {
        Ok(filter)
    } else {
        Err(ShapingError::NoModelAtRate)
    }
}

/// `∫₀^span e^{Lu} C e^{Lᵀu} du` by Taylor's series over a short part and doubling:
/// `J(2h) = J(h) + e^{Lh} J(h) e^{Lᵀh}`.
fn driving(log: &AxisMatrix, c: &AxisMatrix, span: f64, n: usize) -> Option<AxisMatrix> {
    let doublings = halvings(&combine(span, log, 0.0, &ZERO))?;
    let step = ldexp(span, -doublings);
    let mut term = combine(step, c, 0.0, &ZERO);
    let mut sum = term;
    // The operator LX + XLᵀ has norm at most 1 over the step: 1/20! is below rounding.
    for k in 2..20 {
        let half = product(log, &term, n);
        term = combine(
            step / k as f64,
            &combine(1.0, &half, 1.0, &transpose(&half, n)),
            0.0,
            &ZERO,
        );
        sum = combine(1.0, &sum, 1.0, &term);
    }
    let mut f = exponential(&combine(step, log, 0.0, &ZERO), n)?;
    for _ in 0..doublings {
        sum = combine(
            1.0,
            &sum,
            1.0,
            &product(&product(&f, &sum, n), &transpose(&f, n), n),
        );
        f = product(&f, &f, n);
    }
    Some(sum)
}

/// C of `q = ∫₀^1 e^{Lu} C e^{Lᵀu} du`: linear in the entries of C, solved for them.
fn continuous_density(log: &AxisMatrix, q: &AxisMatrix, n: usize) -> Option<AxisMatrix> {
    let mut system = PairMatrix::identity();
    let mut right = PairVector::zeros();
    for (column, (i, j)) in pairs(n).enumerate() {
        let mut unit = ZERO;
        unit[i][j] = 1.0;
        unit[j][i] = 1.0;
        let image = driving(log, &unit, 1.0, n)?;
        for (row, (k, l)) in pairs(n).enumerate() {
            system[(row, column)] = image[k][l];
        }
        right[column] = q[i][j];
    }
    let solution = system.lu().solve(&right)?;
    let mut c = ZERO;
    for (column, (i, j)) in pairs(n).enumerate() {
        c[i][j] = solution[column];
        c[j][i] = solution[column];
    }
    Some(c)
}

/// Index pairs of the lower triangle.
fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(|i| (0..=i).map(move |j| (i, j)))
}

#[cfg(test)]
mod tests {
    use super::*;
    const T: f64 = 0.005;

    /// Lags `every·k` of the autocovariance.
    fn lags(filter: &ShapingFilter, every: usize) -> [f64; 20] {
        let mut all = [0.0; 200];
        filter.autocovariance(&mut all);
        core::array::from_fn(|k| all[k * every])
    }

    /// Largest difference at lags ≥ 1, relative to the coloured variance at lag 1.
    fn miss(a: &[f64; 20], b: &[f64; 20]) -> f64 {
        (1..20)
            .map(|k| (a[k] - b[k]).abs() / a[1].abs())
            .fold(0.0, f64::max)
    }

    /// Spectral density at frequency zero [unit²/Hz]: T Σ γ_k over all lags, by transfer function.
    fn density(filter: &ShapingFilter) -> f64 {
        let n = filter.order;
        let mut h = ZERO;
        h[0] = filter.h;
        let gap = combine(1.0, &super::super::matrix::identity(n), -1.0, &filter.f);
        let row = solve(&transpose(&gap, n), &transpose(&h, n), n).unwrap(); // column 0: (I−F)⁻ᵀHᵀ
        let gain: [f64; MAX_ORDER] = core::array::from_fn(|i| row[i][0]);
        let driven = dot(&gain, &apply(&filter.q, &gain, n), n) + 2.0 * dot(&gain, &filter.s, n);
        (driven + filter.r) * filter.interval
    }

    #[test]
    fn gauss_markov_and_white_match_the_constructors() {
        let at = |interval| {
            ShapingFilter::white(0.02, interval)
                .unwrap()
                .plus(&ShapingFilter::gauss_markov(0.3, 7.0, interval).unwrap())
                .unwrap()
                .plus(&ShapingFilter::random_walk(0.01, interval).unwrap())
                .unwrap()
        };
        let mut filter = at(T);
        for interval in [2.0 * T, 4.0 * T, T / 3.0, T] {
            filter = filter.at_interval(interval).unwrap();
            let exact = at(interval);
            assert_eq!(
                (filter.f[1][1], filter.f[0][1], filter.p0),
                (1.0, 0.0, exact.p0)
            );
            for (ours, direct) in [
                (filter.f[0][0], exact.f[0][0]),
                (filter.q[0][0], exact.q[0][0]),
                (filter.q[1][1], exact.q[1][1]),
                (filter.r, exact.r),
            ] {
                // φ = 1 − 7e-4 is stored to 1.6e-13 of 1 − φ.
                assert!((ours / direct - 1.0).abs() < 1e-12, "{ours} {direct}");
            }
        }
        let white = ShapingFilter::white(0.02, T).unwrap();
        assert_eq!(white.at_interval(T).unwrap(), white);
        let slower = white.at_interval(0.1).unwrap();
        assert!((slower.r / (0.02 * 0.02 / 0.1) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn arma11_keeps_every_second_lag_and_its_white_density() {
        for (phi, theta, tolerance) in [
            (0.9, 0.5, 1e-13),
            (0.9, 0.0, 1e-13),
            (1.0 - 5e-5, 0.9994, 1e-10),
        ] {
            let arma = ShapingFilter::arma(&[phi], &[theta], 2.0, T).unwrap();
            let slow = arma.at_interval(2.0 * T).unwrap();
            let (a, b) = (lags(&arma, 2), lags(&slow, 1));
            // 1 − φ = 5e-5 is stored to 2e-12, and Σ is its inverse.
            assert!(miss(&a, &b) < tolerance, "{phi} {theta}: {}", miss(&a, &b));
            // What is not coloured is W = θ/φ σ² at T, half of that at 2T.
            let coloured = |g: &[f64; 20], phi: f64| g[1] / phi;
            let white = b[0] - coloured(&b, phi * phi);
            let expected = 0.5 * (theta / phi) * 4.0;
            assert!(
                (white - expected).abs() < 1e-10 * b[0].max(1.0),
                "{white} {expected}"
            );
        }
    }

    #[test]
    fn round_trips_keep_the_autocovariance() {
        // Complex poles of modulus 0.8 at 26° beside a real one.
        let complex: &[f64] = &[1.44, -0.64];
        for (phi, theta, tolerance) in [
            (&[0.9][..], &[0.5][..], 1e-10),
            (&[1.0 - 5e-5], &[0.9994], 1e-10),
            (complex, &[0.7], 1e-10),
            (&[1.5, -0.56], &[0.9], 1e-10),
        ] {
            let arma = ShapingFilter::arma(phi, theta, 0.5, T).unwrap();
            let expected = lags(&arma, 1);
            for middle in [T / 2.0, 2.0 * T, 0.7 * T] {
                let there = arma.at_interval(middle).unwrap();
                let back = there.at_interval(T).unwrap();
                let found = lags(&back, 1);
                assert!(
                    miss(&expected, &found) < tolerance,
                    "{phi:?} {theta:?} by {middle}: {}",
                    miss(&expected, &found)
                );
                assert!((found[0] / expected[0] - 1.0).abs() < tolerance);
            }
        }
    }

    #[test]
    fn unit_root_is_the_random_walk_and_white_of_its_decomposition() {
        let (theta, sigma) = (0.9994, 0.47);
        let arma = ShapingFilter::arma(&[1.0], &[theta], sigma, T).unwrap();
        let q = (1.0 - theta) * (1.0 - theta) * sigma * sigma;
        let r = theta * sigma * sigma;
        for ratio in [0.5, 2.0, 4.0, 20.0, 0.1] {
            let there = arma.at_interval(ratio * T).unwrap();
            assert_eq!(there.f[0][0], 1.0);
            // The differenced ε has variance q' + 2r' and lag-one covariance −r'.
            let variance = there.q[0][0] + 2.0 * there.r - 2.0 * there.s[0];
            let lag_one = there.s[0] - there.r;
            let (q_there, r_there) = (q * ratio, r / ratio);
            assert!(
                (lag_one / -r_there - 1.0).abs() < 1e-10,
                "{ratio}: {lag_one} {r_there}"
            );
            // q' is what is left of 2r', up to 5e5 times larger: it keeps 1e-16 · 5e6.
            let walk = variance + 2.0 * lag_one;
            assert!(
                (walk / q_there - 1.0).abs() < 1e-7,
                "{ratio}: {walk} {q_there}"
            );
            assert!((there.q[0][0] / q_there - 1.0).abs() < 1e-9 || ratio < 1.0);
        }
    }

    #[test]
    fn density_at_zero_frequency_is_kept_for_slow_noise() {
        // Slow against both intervals, so aliasing, which is (T/τ)², does not reach 1e-4.
        let arma = ShapingFilter::arma(&[0.999], &[0.98], 0.3, T).unwrap();
        for ratio in [0.5, 2.0, 3.0] {
            let there = arma.at_interval(ratio * T).unwrap();
            assert!(
                (density(&there) / density(&arma) - 1.0).abs() < 1e-4,
                "{ratio}"
            );
        }
    }

    #[test]
    fn poles_at_or_below_zero_have_no_other_rate() {
        for (phi, theta) in [
            (&[-0.5][..], &[0.2][..]),
            (&[], &[0.4]),
            (&[0.5, 0.0], &[0.2, 0.1]),
            (&[0.0, 0.25], &[]),
        ] {
            let arma = ShapingFilter::arma(phi, theta, 1.0, T).unwrap();
            assert_eq!(
                arma.at_interval(2.0 * T),
                Err(ShapingError::NoRealLogarithm),
                "{phi:?}"
            );
            assert_eq!(arma.at_interval(T), Ok(arma));
        }
        let arma = ShapingFilter::arma(&[0.9], &[0.5], 1.0, T).unwrap();
        for interval in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(arma.at_interval(interval).is_err());
        }
        for interval in [1e-300, 1e300] {
            if let Ok(there) = arma.at_interval(interval) {
                assert!(there.r.is_finite() && there.q[0][0].is_finite());
            }
        }
    }

    #[test]
    fn negative_coloured_part() {
        // φ < θ: white less a coloured part. Slow, it exists at a lower rate.
        let arma = ShapingFilter::arma(&[0.95], &[0.97], 1.0, T).unwrap();
        let slow = arma.at_interval(4.0 * T).unwrap();
        assert!(miss(&lags(&arma, 4), &lags(&slow, 1)) < 1e-12);
        assert!(slow.is_semidefinite());
        // φ = 0.5, θ = 0.9 at 2T: γ0 = 0.313, γ1 = −0.147 and φ' = 0.25 make a spectrum of
        // γ0 + 2γ1/(1 − φ') = −0.08 at frequency zero.
        let arma = ShapingFilter::arma(&[0.5], &[0.9], 1.0, T).unwrap();
        assert_eq!(arma.at_interval(2.0 * T), Err(ShapingError::NoModelAtRate));
        // φ = 0.9, θ = −0.3: smoother than white noise plus a Gauss-Markov process can be.
        let arma = ShapingFilter::arma(&[0.9], &[-0.3], 1.0, T).unwrap();
        assert_eq!(arma.at_interval(2.0 * T), Err(ShapingError::NoModelAtRate));
    }

    proptest::proptest! {
        /// Any model that exists at the other rate has the lags that both rates share.
        #[test]
        fn shared_lags_are_kept(
            slow in 0.5f64..0.9999, modulus in 0.2f64..0.95, angle in 0.1f64..0.9,
            theta in proptest::array::uniform3(-0.5f64..0.5), every in 2usize..5,
        ) {
            // Poles at `slow` and at modulus · exp(±i angle): (1 − a B)(1 − b B + c B²).
            let (b, c) = (2.0 * modulus * libm::cos(angle), modulus * modulus);
            let phi = [slow + b, -(slow * b + c), slow * c];
            let arma = ShapingFilter::arma(&phi, &theta, 1.0, T).unwrap();
            if let Ok(there) = arma.at_interval(every as f64 * T) {
                let (a, b) = (lags(&arma, every), lags(&there, 1));
                // Conditioning of the logarithm near a double pole: 1e-16 to the power 1/2.
                for k in 1..20 {
                    proptest::prop_assert!((a[k] - b[k]).abs() < 1e-7 * arma_variance(&arma), "lag {k}: {} {}", a[k], b[k]);
                }
                proptest::prop_assert!(there.is_semidefinite());
            }
        }
    }

    fn arma_variance(filter: &ShapingFilter) -> f64 {
        lags(filter, 1)[0]
    }
}
