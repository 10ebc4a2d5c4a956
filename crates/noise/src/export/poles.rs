//! An ARMA as a sum over its poles: slow real ones are bias processes, the rest is noise.
//!
//! With φ(z) = ∏(1 − λᵢz) and ψ = θ/φ, the autocovariance at lags from max(1, q − p + 1) on is Σ cᵢ λᵢᵏ, where
//! cᵢ = σ² rᵢ ψ(λᵢ) and rᵢ = θ(1/λᵢ)/∏_{l≠i}(1 − λ_l/λᵢ). A real λ between 0 and 1 with cᵢ > 0 is a sampled
//! Gauss-Markov process of variance cᵢ and correlation time −T/ln λ, for λ = 1 a random walk.

use crate::arma::inverse_roots;
use crate::bias_model::Slow;
use crate::composite::GaussMarkov;
use crate::model_file::Arma;
use realfft::num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Shortest correlation time of a bias \[s\]: what is faster averages out between fixes as white noise does.
pub(super) const SLOW: f64 = 1.0;
/// A pole this close to one is a unit root: its correlation time is 10⁹ samples.
const UNIT_ROOT: f64 = 1e-9;

/// What an ARMA is to programs that know white noise and a bias.
pub(super) struct Parts {
    /// Density at frequency 0 of all that is no bias, N² [unit²·s]; not above zero where that is anti-persistent.
    pub(super) white: f64,
    /// The bias.
    pub(super) slow: Slow,
    /// Frequencies of complex pairs of poles \[Hz\].
    pub(super) pairs: Vec<f64>,
    /// Correlation times of real poles that are too fast for a bias, or on the negative axis \[s\].
    pub(super) fast: Vec<f64>,
    /// Correlation times of slow poles that take from the spectrum and are no process of their own \[s\].
    pub(super) negative: Vec<f64>,
}

/// 1 − Σ cᵢ zⁱ.
fn polynomial(coefficients: &[f64], z: Complex64) -> Complex64 {
    let inner = coefficients.iter().rev();
    1.0 - inner.fold(Complex64::ZERO, |sum, c| (sum + c) * z)
}

/// A slow pole with its driving variance c(1 − λ²), which is finite at λ = 1.
struct Driven {
    pole: f64,
    variance: f64,
}

impl Driven {
    /// Spectrum at an angle, c(1 − λ²)/|1 − λe^{iω}|² [unit²].
    fn spectrum(&self, angle: f64) -> f64 {
        self.variance / (1.0 - Complex64::from_polar(self.pole, angle)).norm_sqr()
    }
}

pub(super) fn parts(arma: &Arma) -> Parts {
    let (interval, variance) = (1.0 / arma.rate_hz, arma.sigma * arma.sigma);
    let poles = inverse_roots(&arma.ar);
    let mut parts = Parts {
        white: 0.0,
        slow: Slow::default(),
        pairs: Vec::new(),
        fast: Vec::new(),
        negative: Vec::new(),
    };
    let mut driven = Vec::new();
    for (i, pole) in poles.iter().enumerate() {
        if pole.norm() == 0.0 {
            continue;
        }
        // Rounding leaves a trace of an imaginary part at a real root.
        if pole.im.abs() > 1e-9 {
            if pole.im > 0.0 {
                parts.pairs.push(pole.arg() / TAU * arma.rate_hz);
            }
            continue;
        }
        let lambda = pole.re;
        let tau_s = interval / lambda.abs().min(1.0).ln().abs();
        if lambda <= 0.0 || tau_s < SLOW {
            parts.fast.push(tau_s);
            continue;
        }
        let others = poles.iter().enumerate().filter(|(l, _)| *l != i);
        let others = others.map(|(_, other)| (1.0 - other / pole) * (1.0 - other * pole));
        let product: Complex64 = others.product();
        let numerator = polynomial(&arma.ma, pole.inv()) * polynomial(&arma.ma, *pole);
        let driving = variance * (numerator / product).re;
        if !(driving > 0.0 && driving.is_finite()) {
            parts.negative.push(tau_s);
            continue;
        }
        driven.push(Driven {
            pole: lambda,
            variance: driving,
        });
        if 1.0 - lambda < UNIT_ROOT {
            parts.slow.walk = Some((driving / interval).sqrt());
        } else {
            let sigma = (driving / ((1.0 - lambda) * (1.0 + lambda))).sqrt();
            parts.slow.processes.push(GaussMarkov { sigma, tau_s });
        }
    }
    parts.white = interval * rest(arma, &poles, &driven);
    parts
}

/// Spectrum at frequency 0 less that of the slow poles, over the sample interval [unit²]. Nothing large is subtracted:
/// the other poles' sums are 1/(1 − λ), and what is left is a polynomial of cosines of degree q − p, known from as
/// many frequencies away from 0.
fn rest(arma: &Arma, poles: &[Complex64], driven: &[Driven]) -> f64 {
    let variance = arma.sigma * arma.sigma;
    let is_driven = |pole: &Complex64| {
        let same = |of: &Driven| of.pole == pole.re && pole.im.abs() <= 1e-9;
        driven.iter().any(same)
    };
    let others: Vec<(Complex64, Complex64)> = poles
        .iter()
        .enumerate()
        .filter(|(_, pole)| pole.norm() > 0.0 && !is_driven(pole))
        .map(|(i, pole)| {
            let rest = poles.iter().enumerate().filter(|(l, _)| *l != i);
            let residue: Complex64 = rest.map(|(_, other)| 1.0 - other / pole).product();
            let psi = polynomial(&arma.ma, *pole) / polynomial(&arma.ar, *pole);
            (
                *pole,
                variance * polynomial(&arma.ma, pole.inv()) / residue * psi,
            )
        })
        .collect();
    // c (1 + Σ λᵏ(zᵏ + z⁻ᵏ)), its real part summed over the pairs.
    let of_others = |angle: f64| -> f64 {
        let z = Complex64::from_polar(1.0, angle);
        let one = |(pole, c): &(Complex64, Complex64)| {
            let (ahead, back) = (1.0 - pole * z, 1.0 - pole * z.conj());
            (c * (1.0 - pole * pole) / (ahead * back)).re
        };
        others.iter().map(one).sum()
    };
    let left = |angle: f64| {
        let z = Complex64::from_polar(1.0, angle);
        let all = (polynomial(&arma.ma, z) / polynomial(&arma.ar, z)).norm_sqr();
        let slow: f64 = driven.iter().map(|of| of.spectrum(angle)).sum();
        variance * all - slow - of_others(angle)
    };
    let degree = arma.ma.len().saturating_sub(arma.ar.len());
    let count = 2 * degree + 1;
    let at_zero = |n: usize| {
        let angle = PI * (2 * n + 1) as f64 / count as f64;
        let kernel: f64 = (1..=degree).map(|k| 2.0 * (k as f64 * angle).cos()).sum();
        left(angle) * (1.0 + kernel) / count as f64
    };
    (0..count).map(at_zero).sum::<f64>() + of_others(0.0)
}
