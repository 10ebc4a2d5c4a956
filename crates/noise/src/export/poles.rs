//! An ARMA as a sum over its poles: slow ones are the bias, the rest is noise.
//!
//! With φ(z) = ∏(1 − λᵢz) and ψ = θ/φ, the autocovariance at lags from max(1, q − p + 1) on is Σ cᵢ λᵢᵏ, where
//! cᵢ = σ² rᵢ ψ(λᵢ) and rᵢ = θ(1/λᵢ)/∏_{l≠i}(1 − λ_l/λᵢ). A real λ between 0 and 1 with cᵢ > 0 is a sampled
//! Gauss-Markov process of variance cᵢ and correlation time −T/ln λ, for λ = 1 a random walk. Slow poles that are
//! complex or have cᵢ < 0 are no process of their own; over short times all slow ones together are a random walk, which moves in
//! a sample by the variance Σ qᵢ, qᵢ = −2 cᵢ ln λᵢ.
//!
//! Example: ARMA(2,1) with λ = 0.9999 and 0.5 at 100 Hz has a bias of τ = 100 s and a filter's
//! memory of 14 ms; the latter goes into the white density at frequency 0, the former into the
//! bias.
//!
//! Of a double pole the partial fractions do not exist: it is set apart into two ([`apart`]), whose sum is the same to four digits and more.

use crate::arma::inverse_roots;
use crate::bias_model::{SLOW, Slow};
use crate::composite::GaussMarkov;
use crate::model_file::Arma;
use realfft::num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// A pole this close to one is a unit root: its correlation time is 10⁹ samples.
const UNIT_ROOT: f64 = 1e-9;

/// Roots of double precision that are nearer than this are a double one, of which rounding leaves eight digits.
const DOUBLE: f64 = 1e-7;

/// What an ARMA is to programs that know white noise and a bias.
pub(super) struct Parts {
    /// Density at frequency 0 of all that is no bias, N² [unit²·s]; not above zero where that is anti-persistent.
    pub(super) white: f64,
    /// The bias, as processes and a random walk.
    pub(super) slow: Slow,
    /// Frequencies of complex pairs of poles that are no bias \[Hz\].
    pub(super) pairs: Vec<f64>,
    /// Correlation times of real poles that are too fast for a bias, or on the negative axis \[s\].
    pub(super) fast: Vec<f64>,
    /// The slow poles are a random walk over short times alone.
    pub(super) is_joined: bool,
}

/// 1 − Σ cᵢ zⁱ.
fn polynomial(coefficients: &[f64], z: Complex64) -> Complex64 {
    let inner = coefficients.iter().rev();
    1.0 - inner.fold(Complex64::ZERO, |sum, c| (sum + c) * z)
}

/// A pole with its share of the spectrum.
///
/// A complex pair is two of these, whose imaginary parts cancel in every sum.
struct PartialFraction {
    pole: Complex64,
    /// c(1 − λ²), which is finite at λ = 1 \[unit²\].
    drive: Complex64,
}

impl PartialFraction {
    /// The share of the pole number `at` of all of them.
    ///
    /// `poles` are all inverse roots of φ.
    fn new(arma: &Arma, poles: &[Complex64], at: usize) -> Self {
        let pole = poles[at];
        let others = poles.iter().enumerate().filter(|(l, _)| *l != at);
        let product: Complex64 = others
            .map(|(_, other)| (1.0 - other / pole) * (1.0 - other * pole))
            .product();
        let numerator = polynomial(&arma.ma, pole.inv()) * polynomial(&arma.ma, pole);
        let drive = arma.sigma * arma.sigma * numerator / product;
        Self { pole, drive }
    }

    /// Spectrum at an angle, c(1 − λ²)/((1 − λe^{iω})(1 − λe^{−iω})); its real part, summed over a pair \[unit²\].
    ///
    /// ω in rad/sample; the sum over all poles is the spectrum of the process less its
    /// moving-average remainder.
    fn spectrum(&self, angle: f64) -> f64 {
        let z = Complex64::from_polar(1.0, angle);
        (self.drive / ((1.0 - self.pole * z) * (1.0 - self.pole * z.conj()))).re
    }

    /// A real one of a slow process.
    fn is_process(&self) -> bool {
        is_real(self.pole) && self.drive.re > 0.0
    }

    /// −2c ln λ; its real part, summed over a pair \[unit²\].
    fn step(&self) -> f64 {
        let (decay, whole) = (-2.0 * self.pole.ln(), 1.0 - self.pole * self.pole);
        match whole.norm() < UNIT_ROOT {
            true => self.drive.re,
            false => (self.drive * decay / whole).re,
        }
    }
}

/// Rounding leaves a trace of an imaginary part at a real root.
fn is_real(pole: Complex64) -> bool {
    pole.im.abs() < 1e-9
}

/// Poles with those that are one but for rounding a fiftieth of their distance from 1 apart: nearer ones would cancel to nothing but rounding.
fn apart(mut poles: Vec<Complex64>) -> Vec<Complex64> {
    for first in 0..poles.len() {
        for second in first + 1..poles.len() {
            let (a, b) = (poles[first], poles[second]);
            if a.norm() > 0.0 && (a - b).norm() < DOUBLE {
                // Rounding makes a conjugate pair of a real one.
                let centre = 0.5 * (a + b);
                let off = (0.01 * (1.0 - centre).norm()).max(UNIT_ROOT);
                (poles[first], poles[second]) = (centre - off, centre + off);
            }
        }
    }
    poles
}

/// Splits an ARMA into white noise and a bias by its poles.
///
/// White noise is what remains of the density at frequency 0 when the slow poles are taken away.
pub(super) fn parts(arma: &Arma) -> Parts {
    let interval = 1.0 / arma.rate_hz;
    let poles = apart(inverse_roots(&arma.ar));
    let tau_s = |pole: Complex64| interval / pole.norm().min(1.0).ln().abs();
    // It decays slowly, and no oscillation is faster than that.
    let is_slow = |pole: Complex64| tau_s(pole) >= SLOW && pole.arg().abs() * SLOW <= interval;
    let all = (0..poles.len()).filter(|i| poles[*i].norm() > 0.0);
    let all = all.map(|i| PartialFraction::new(arma, &poles, i));
    let (slow, rest): (Vec<PartialFraction>, Vec<PartialFraction>) =
        all.partition(|part| is_slow(part.pole));
    let mut bias = Slow::default();
    let is_joined = !slow.iter().all(PartialFraction::is_process);
    if is_joined {
        let step: f64 = slow.iter().map(PartialFraction::step).sum();
        bias.walk = (step > 0.0).then(|| (step / interval).sqrt());
    } else {
        for part in &slow {
            let (lambda, drive) = (part.pole.re, part.drive.re);
            if 1.0 - lambda < UNIT_ROOT {
                bias.walk = Some((drive / interval).sqrt());
            } else {
                let sigma = (drive / ((1.0 - lambda) * (1.0 + lambda))).sqrt();
                let tau_s = tau_s(part.pole);
                bias.processes.push(GaussMarkov { sigma, tau_s });
            }
        }
    }
    let pairs = rest.iter().filter(|part| part.pole.im > 1e-9);
    let fast = rest.iter().filter(|part| is_real(part.pole));
    Parts {
        white: interval * density(arma, &slow, &rest),
        slow: bias,
        pairs: pairs
            .map(|part| part.pole.arg() / TAU * arma.rate_hz)
            .collect(),
        fast: fast.map(|part| tau_s(part.pole)).collect(),
        is_joined,
    }
}

/// Spectrum at frequency 0 less that of the slow poles \[unit²\]. Nothing large is subtracted: to the other poles' sums
/// comes a polynomial of cosines of degree q − p, known from as many frequencies away from 0.
fn density(arma: &Arma, slow: &[PartialFraction], rest: &[PartialFraction]) -> f64 {
    let sum = |parts: &[PartialFraction], angle: f64| -> f64 {
        parts.iter().map(|part| part.spectrum(angle)).sum()
    };
    let left = |angle: f64| {
        let z = Complex64::from_polar(1.0, angle);
        let all = (polynomial(&arma.ma, z) / polynomial(&arma.ar, z)).norm_sqr();
        arma.sigma * arma.sigma * all - sum(slow, angle) - sum(rest, angle)
    };
    let degree = arma.ma.len().saturating_sub(arma.ar.len());
    let count = 2 * degree + 1;
    let at_zero = |n: usize| {
        let angle = PI * (2 * n + 1) as f64 / count as f64;
        let kernel: f64 = (1..=degree).map(|k| 2.0 * (k as f64 * angle).cos()).sum();
        left(angle) * (1.0 + kernel) / count as f64
    };
    (0..count).map(at_zero).sum::<f64>() + sum(rest, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of the poles at 100 Hz, with a θ and innovations of 2.
    fn of(poles: [f64; 2], theta: f64) -> Parts {
        let [a, b] = poles;
        parts(&Arma {
            ar: vec![a + b, -a * b],
            ma: vec![theta],
            sigma: 2.0,
            rate_hz: 100.0,
        })
    }

    #[test]
    fn a_double_pole_is_that_of_two_next_to_each_other() {
        // A fast one: the density at frequency 0 is σ² T (1 − θ)²/(1 − λ)⁴.
        let found = of([0.5; 2], 0.2);
        let exact = 4.0 * 0.01 * 0.8f64.powi(2) / 0.5f64.powi(4);
        assert!((found.white / exact - 1.0).abs() < 3e-4, "{}", found.white);
        assert!(found.pairs.is_empty() && found.fast.len() == 2 && !found.is_joined);
        assert_eq!(found.slow, Slow::default());
        // A slow one: a walk over short times, of the variance a sample that two poles 1e-15 on either side have by mpmath (60 digits).
        for (lambda, theta, step) in [
            (0.9995, 0.99, 3.964_029_374_862_46),
            (0.9999, 0.995, 3.980_812_776_145_71),
            (0.99999, 0.999, 3.996_080_587_745_61),
        ] {
            let found = of([lambda; 2], theta);
            assert!(found.is_joined && found.pairs.is_empty() && found.fast.is_empty());
            let walk = found.slow.walk.unwrap();
            // Rounding of a variance that is a difference of some 10⁷ times as much.
            assert!((walk * walk * 0.01 / step - 1.0).abs() < 1e-3, "{walk}");
        }
        // A pole and its double on the negative axis, beside a bias that stays what it is.
        let single = of([0.9999, 0.0], 0.99);
        let arma = Arma {
            ar: vec![0.9999 - 0.8, 0.8 * 0.9999 - 0.16, 0.16 * 0.9999],
            ma: vec![0.99 - 0.8, 0.8 * 0.99 - 0.16, 0.16 * 0.99],
            sigma: 2.0,
            rate_hz: 100.0,
        };
        let found = parts(&arma);
        assert!((found.white / single.white - 1.0).abs() < 1e-3);
        let (a, b) = (found.slow.processes[0], single.slow.processes[0]);
        assert!((a.sigma / b.sigma - 1.0).abs() < 1e-3 && (a.tau_s / b.tau_s - 1.0).abs() < 1e-9);
    }
}
