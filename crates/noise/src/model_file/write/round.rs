//! As few digits as a model needs: six say more than any record does, but coefficients of an ARMA with a root
//! near 1 mean their difference from it.

use super::super::Arma;
use std::f64::consts::PI;
use undrift_base::number::rounded;
use undrift_nav::shaping::ShapingFilter;

/// Most that the power spectrum may change by rounded coefficients, relative: as six digits do.
const SPECTRUM: f64 = 1e-5;
/// Most digits that coefficients are rounded to.
const MOST: usize = 12;
/// Lowest frequency compared [rad/sample], and the frequencies.
const LOWEST: f64 = 1e-6;
const FREQUENCIES: usize = 1000;

/// The number in six significant digits.
pub(super) fn six_digits(number: f64) -> f64 {
    rounded(number, 6)
}

/// AR and MA coefficients with the fewest digits, six or more, that keep the power spectrum; those that have
/// up to twelve already, and those that would need more, as they are.
///
/// Compared are |φ|² and |θ|² separately, at 1000 frequencies from 1e-6 to π rad/sample.
pub(super) fn coefficients(arma: &Arma) -> [Vec<f64>; 2] {
    let exact = [arma.ar.clone(), arma.ma.clone()];
    let with = |digits| {
        let few = |all: &Vec<f64>| {
            all.iter()
                .map(|c| rounded(*c, digits))
                .collect::<Vec<f64>>()
        };
        exact.each_ref().map(few)
    };
    if with(MOST) == exact {
        return exact;
    }
    let is_same = |[ar, ma]: &[Vec<f64>; 2]| {
        ShapingFilter::arma(ar, ma, arma.sigma, 1.0 / arma.rate_hz).is_ok()
            && frequencies().all(|w| {
                let ratio = |a: &[f64], b: &[f64]| (gain(a, w) / gain(b, w) - 1.0).abs();
                ratio(ar, &arma.ar) < SPECTRUM / 2.0 && ratio(ma, &arma.ma) < SPECTRUM / 2.0
            })
    };
    (6..=MOST).map(with).find(is_same).unwrap_or(exact)
}

/// Half of them evenly spaced, half in their logarithm [rad/sample].
fn frequencies() -> impl Iterator<Item = f64> {
    let share = |k: usize| (k + 1) as f64 / FREQUENCIES as f64;
    (0..FREQUENCIES).map(move |k| match k % 2 {
        0 => PI * share(k),
        _ => LOWEST * (PI / LOWEST).powf(share(k)),
    })
}

/// |1 − Σ cᵢ e^{−iωi}|² at a frequency [rad/sample].
fn gain(coefficients: &[f64], frequency: f64) -> f64 {
    let (mut real, mut imaginary) = (1.0, 0.0);
    for (lag, c) in coefficients.iter().enumerate() {
        let angle = frequency * (lag + 1) as f64;
        real -= c * angle.cos();
        imaginary += c * angle.sin();
    }
    real * real + imaginary * imaginary
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gain_of_one_and_two_coefficients_is_in_closed_form() {
        for w in [0.0f64, 0.3, 1.0, PI / 2.0, 2.7, PI] {
            let one = |c: f64| 1.0 - 2.0 * c * w.cos() + c * c;
            assert!((gain(&[0.7], w) - one(0.7)).abs() < 1e-14, "{w}");
            // (1 − 0.7 B)(1 + 0.4 B) = 1 − 0.3 B − 0.28 B².
            let both = one(0.7) * one(-0.4);
            assert!((gain(&[0.3, 0.28], w) - both).abs() < 1e-14, "{w}");
            assert_eq!(gain(&[], w), 1.0);
        }
    }
}
