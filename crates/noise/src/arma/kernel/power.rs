//! Powers summed over a rational spectrum.
//!
//! Whittle's likelihood and its gradient are sums over frequencies of the periodogram over the model's spectrum
//! `|θ|²/|φ|²`; sixteen frequencies go side by side. Sine and cosine of each are computed once, since all
//! evaluations of a search share them.
//!
//! With w = e^{−iω} the model's spectrum over σ² is g(ω) = |θ(w)|²/|φ(w)|², θ(w) = 1 − θ1 w − … .
//! The sum over bins of I/g is what Whittle's likelihood needs ([`super::super::whittle`]); its
//! derivative by a coefficient is that of |φ|² or |θ|², d|C|²/dc_i = −2 Re(C̄ wⁱ). Polynomials by
//! Horner's rule, all derivatives of one frequency by one complex multiplication each: O(bins (p +
//! q)).

use super::{LANES, Row};
use crate::vector::{Task, total, vectorised};

/// Powers at frequencies, sixteen to a row.
///
/// Built once a record, then read by every evaluation. Unused lanes of the last row have power 0
/// and contribute nothing.
#[derive(Default)]
pub(crate) struct PowerSum {
    /// Frequencies so far.
    count: usize,
    /// cos ω, sin ω and the power.
    rows: Vec<[Row; 3]>,
}

impl PowerSum {
    /// Adds a frequency [rad/sample].
    ///
    /// `power` is summed over the bin \[unit²\], `omega` between 0 and π.
    pub(crate) fn push(&mut self, omega: f64, power: f64) {
        let lane = self.count % LANES;
        if lane == 0 {
            self.rows.push([[1.0; LANES], [0.0; LANES], [0.0; LANES]]);
        }
        if let Some(row) = self.rows.last_mut() {
            (row[1][lane], row[0][lane]) = omega.sin_cos();
            row[2][lane] = power;
        }
        self.count += 1;
    }

    /// Σ power |φ|²/|θ|², and |θ|²/|φ|² at the frequency `at`.
    ///
    /// Both have the unit of the powers, respectively none.
    pub(crate) fn over(&self, phi: &[f64], theta: &[f64], at: f64) -> (f64, f64) {
        let sum = vectorised(Sum {
            phi,
            theta,
            rows: &self.rows,
        });
        (total(sum), Self::gain(phi, theta, at))
    }

    /// Derivatives of the first by φ and by θ.
    ///
    /// Of p and of q numbers.
    pub(crate) fn gradient(&self, phi: &[f64], theta: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut by = vec![[0.0; LANES]; phi.len() + theta.len()];
        vectorised(Gradient {
            phi,
            theta,
            rows: &self.rows,
            by: &mut by,
        });
        let (by_phi, by_theta) = by.split_at(phi.len());
        let totals = |rows: &[Row]| rows.iter().map(|row| total(*row)).collect();
        (totals(by_phi), totals(by_theta))
    }

    /// Derivatives of the logarithm of the second.
    ///
    /// Of ln |θ|²/|φ|² at the frequency `at` [rad/sample], by φ and by θ.
    pub(crate) fn gain_gradient(phi: &[f64], theta: &[f64], at: f64) -> (Vec<f64>, Vec<f64>) {
        let (sin, cos) = at.sin_cos();
        let derivatives = |c: &[f64], sign: f64| {
            let [re, im] = value::<false, 1>(c, &[cos], &[sin]);
            let (re, im) = (re[0], im[0]);
            let scale = sign * 2.0 / (re * re + im * im);
            // d|C|²/dc_i = −2 Re(C̄ wⁱ).
            let power = |i: usize| ((i + 1) as f64 * at).sin_cos();
            let part = |(sin, cos): (f64, f64)| scale * (re * cos - im * sin);
            (0..c.len()).map(power).map(part).collect()
        };
        (derivatives(phi, 1.0), derivatives(theta, -1.0))
    }

    /// |θ|²/|φ|² at a frequency [rad/sample].
    ///
    /// Power gain of the filter θ(B)/φ(B) that makes the process from white noise \[–\].
    pub(crate) fn gain(phi: &[f64], theta: &[f64], at: f64) -> f64 {
        let (sin, cos) = at.sin_cos();
        let one = |c: &[f64]| squared::<false, 1>(c, &[cos], &[sin])[0];
        one(theta) / one(phi)
    }
}

/// Task of [`PowerSum::over`], a division and two polynomials a frequency.
struct Sum<'a> {
    phi: &'a [f64],
    theta: &'a [f64],
    rows: &'a [[Row; 3]],
}

impl Task for Sum<'_> {
    type Output = Row;
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Row {
        let mut sum = [0.0; LANES];
        for [cos, sin, power] in self.rows {
            let above = squared::<FUSED, LANES>(self.phi, cos, sin);
            let below = squared::<FUSED, LANES>(self.theta, cos, sin);
            for l in 0..LANES {
                sum[l] += power[l] * (above[l] / below[l]);
            }
        }
        sum
    }
}

/// Sums of the derivatives of power |φ|²/|θ|² by φ, then by θ.
struct Gradient<'a> {
    phi: &'a [f64],
    theta: &'a [f64],
    rows: &'a [[Row; 3]],
    by: &'a mut [Row],
}

impl Task for Gradient<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let (by_phi, by_theta) = self.by.split_at_mut(self.phi.len());
        for [cos, sin, power] in self.rows {
            let [re, im] = value::<FUSED, LANES>(self.phi, cos, sin);
            let [below_re, below_im] = value::<FUSED, LANES>(self.theta, cos, sin);
            let (mut above, mut below) = ([[0.0; LANES]; 2], [[0.0; LANES]; 2]);
            for l in 0..LANES {
                let size = below_re[l] * below_re[l] + below_im[l] * below_im[l];
                let weight = 2.0 * power[l] / size;
                let ratio = weight * (re[l] * re[l] + im[l] * im[l]) / size;
                // d|C|²/dc_i = −2 Re(C̄ wⁱ).
                above[0][l] = -weight * re[l];
                above[1][l] = -weight * im[l];
                below[0][l] = ratio * below_re[l];
                below[1][l] = ratio * below_im[l];
            }
            along::<FUSED>(above, cos, sin, by_phi);
            along::<FUSED>(below, cos, sin, by_theta);
        }
    }
}

/// Adds `Re(c̄ wⁱ)`, w = cos − i sin, i = 1, 2, ….
///
/// c is rotated by w̄ once a coefficient instead of evaluating sines.
#[inline(always)]
fn along<const FUSED: bool>([re, im]: [Row; 2], cos: &Row, sin: &Row, by: &mut [Row]) {
    // c w̄ⁱ has the same real part.
    let (mut re, mut im) = (re, im);
    for sum in by {
        for l in 0..LANES {
            let (a, b) = (re[l], im[l]);
            if FUSED {
                re[l] = a.mul_add(cos[l], -(b * sin[l]));
                im[l] = b.mul_add(cos[l], a * sin[l]);
            } else {
                re[l] = a * cos[l] - b * sin[l];
                im[l] = b * cos[l] + a * sin[l];
            }
            sum[l] += re[l];
        }
    }
}

/// |1 − c1 w − … − cn wⁿ|² at w = cos − i sin.
#[inline(always)]
fn squared<const FUSED: bool, const L: usize>(
    c: &[f64],
    cos: &[f64; L],
    sin: &[f64; L],
) -> [f64; L] {
    let [re, im] = value::<FUSED, L>(c, cos, sin);
    let mut out = [0.0; L];
    for l in 0..L {
        out[l] = re[l] * re[l] + im[l] * im[l];
    }
    out
}

/// Real and imaginary part of 1 − c1 w − … − cn wⁿ at w = cos − i sin, by Horner's rule.
#[inline(always)]
fn value<const FUSED: bool, const L: usize>(
    c: &[f64],
    cos: &[f64; L],
    sin: &[f64; L],
) -> [[f64; L]; 2] {
    let (mut re, mut im) = ([0.0; L], [0.0; L]);
    for c in c.iter().rev() {
        for l in 0..L {
            let a = re[l] - c;
            let b = im[l];
            if FUSED {
                re[l] = a.mul_add(cos[l], b * sin[l]);
                im[l] = b.mul_add(cos[l], -(a * sin[l]));
            } else {
                re[l] = a * cos[l] + b * sin[l];
                im[l] = b * cos[l] - a * sin[l];
            }
        }
    }
    for l in 0..L {
        re[l] += 1.0;
    }
    [re, im]
}

#[cfg(test)]
mod tests {
    use super::*;

    use realfft::num_complex::Complex64;

    const PHI: [f64; 3] = [1.1, -0.6, 0.2];
    const THETA: [f64; 2] = [0.5, -0.3];

    /// |1 − Σ c wⁱ|² at w = e^(−iω).
    fn exact(c: &[f64], omega: f64) -> f64 {
        let powers = (1i32..).map(|i| Complex64::from_polar(1.0, -omega * f64::from(i)));
        let sum: Complex64 = powers.zip(c).map(|(w, c)| w * *c).sum();
        (Complex64::new(1.0, 0.0) - sum).norm_sqr()
    }

    /// Of a number that fills no row: frequencies and powers.
    fn ordinates() -> Vec<(f64, f64)> {
        let of = |k: i32| (0.05 + 0.08 * f64::from(k), f64::from(1 + k % 5));
        (0..37).map(of).collect()
    }

    fn exact_sum(phi: &[f64], theta: &[f64]) -> f64 {
        let of = |(omega, power): (f64, f64)| power * exact(phi, omega) / exact(theta, omega);
        ordinates().into_iter().map(of).sum()
    }

    fn sums() -> PowerSum {
        let mut sums = PowerSum::default();
        for (omega, power) in ordinates() {
            sums.push(omega, power);
        }
        sums
    }

    /// Derivatives of a function of φ and θ by central differences.
    fn slopes(of: &dyn Fn(&[f64], &[f64]) -> f64) -> Vec<f64> {
        let step = 1e-6;
        let moved = |i: usize, by: f64| {
            let (mut phi, mut theta) = (PHI, THETA);
            match i {
                0..3 => phi[i] += by,
                _ => theta[i - 3] += by,
            }
            of(&phi, &theta)
        };
        let slope = |i| (moved(i, step) - moved(i, -step)) / (2.0 * step);
        (0..5).map(slope).collect()
    }

    #[test]
    fn powers_are_summed_over_the_polynomials_on_the_unit_circle() {
        let sums = sums();
        let expected = exact_sum(&PHI, &THETA);
        let (sum, gain) = sums.over(&PHI, &THETA, 0.7);
        assert!((sum / expected - 1.0).abs() < 1e-13, "{sum} {expected}");
        assert!((gain * exact(&PHI, 0.7) / exact(&THETA, 0.7) - 1.0).abs() < 1e-13);
        // As it is compiled for either kind of processor.
        let task = || Sum {
            phi: &PHI,
            theta: &THETA,
            rows: &sums.rows,
        };
        for row in [task().run::<false>(), task().run::<true>()] {
            assert!((total(row) / expected - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn gradients_are_the_slopes_of_what_they_are_of() {
        let sums = sums();
        let exact = slopes(&exact_sum);
        let (by_phi, by_theta) = sums.gradient(&PHI, &THETA);
        let mut rows = [[[0.0; LANES]; 5]; 2];
        let [plain, fused] = &mut rows;
        let task = |by| Gradient {
            phi: &PHI,
            theta: &THETA,
            rows: &sums.rows,
            by,
        };
        task(plain).run::<false>();
        task(fused).run::<true>();
        let of_rows = rows.map(|by| by.map(total).to_vec());
        for found in of_rows.into_iter().chain([[by_phi, by_theta].concat()]) {
            for (found, exact) in found.iter().zip(&exact) {
                // Rounding of a sum of some hundred over the step.
                assert!(
                    (found - exact).abs() < 1e-6 * (1.0 + exact.abs()),
                    "{found} {exact}"
                );
            }
        }
        let exact = slopes(&|phi, theta| PowerSum::gain(phi, theta, 0.7).ln());
        let (by_phi, by_theta) = PowerSum::gain_gradient(&PHI, &THETA, 0.7);
        for (found, exact) in [by_phi, by_theta].concat().iter().zip(exact) {
            assert!((found - exact).abs() < 1e-8, "{found} {exact}");
        }
    }
}
