//! Covariance of wavelet variances under a model: the scales overlap in frequency.
//!
//! For a Gaussian process of spectrum S and Haar filters H, `cov(ν̂_j², ν̂_k²) = (2/n) ∫ |H_j|² |H_k|² S² df`
//! over frequencies −½…½ a sample, n the coefficients of the longer scale: Percival & Walden 2000,
//! section 8.4, Serroukh & Walden 2000. `|H_m|² = sin⁴(πfm) / (m² sin²(πf))`.

use super::WaveletPoint;
use crate::composite::{CompositeTerms, GaussMarkov};
use nalgebra::DMatrix;
use std::f64::consts::PI;

/// Points an octave of frequency.
const POINTS: usize = 64;

/// Spectrum \[unit²\] at sin²(πf), f in cycles a sample; its mean over −½…½ is the variance. `slow`: the terms'
/// [`CompositeTerms::slow`].
fn spectrum(
    terms: &CompositeTerms,
    slow: &(Vec<GaussMarkov>, f64),
    sine2: f64,
    interval: f64,
) -> f64 {
    let (processes, walk) = slow;
    let mut sum = terms.white * terms.white / interval;
    sum += 4.0 * sine2 * (terms.quantisation / interval).powi(2);
    sum += walk * walk * interval / (4.0 * sine2);
    for process in processes {
        if process.sigma > 0.0 {
            let a = interval / process.tau_s;
            let (decay, driving) = (-(-a).exp_m1(), -(-2.0 * a).exp_m1());
            let gain = decay * decay + 4.0 * (1.0 - decay) * sine2;
            sum += process.sigma * process.sigma * driving / gain;
        }
    }
    sum
}

/// Covariance of the wavelet variances at `points` of a record of `samples` under the terms \[unit⁴\].
pub(super) fn covariance(
    points: &[WaveletPoint],
    terms: &CompositeTerms,
    interval: f64,
    samples: usize,
) -> DMatrix<f64> {
    let count = points.len();
    let mut sum = DMatrix::zeros(count, count);
    let mut gains = vec![0.0; count];
    let slow = terms.slow();
    let last = points.last().map_or(1, |p| p.m);
    // Octaves from ½ down to a hundredth of the longest filter's passband.
    let octaves = last.max(1).ilog2() + 8;
    for octave in 0..octaves {
        let width = 0.25 / f64::from(octave).exp2();
        for i in 0..POINTS {
            // Where a long filter oscillates within a step, steps off its period sample it evenly.
            let f = width * (1.0 + (i as f64 + 0.5) / POINTS as f64);
            let sine2 = (PI * f).sin().powi(2);
            for (gain, point) in gains.iter_mut().zip(points) {
                let m = point.m as f64;
                *gain = (PI * f * m).sin().powi(4) / (m * m * sine2);
            }
            let density = spectrum(terms, &slow, sine2, interval);
            // Twice for the negative frequencies.
            let weight = 2.0 * width / POINTS as f64 * density * density;
            for j in 0..count {
                for k in 0..=j {
                    sum[(j, k)] += weight * gains[j] * gains[k];
                }
            }
        }
    }
    for j in 0..count {
        for k in 0..=j {
            let coefficients = (samples + 1).saturating_sub(2 * points[j].m).max(1);
            sum[(j, k)] *= 2.0 / coefficients as f64;
            sum[(k, j)] = sum[(j, k)];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_noise_has_the_known_covariance() {
        // Coefficients of white noise at m = 1: autocovariances ½, −¼ of its variance, so
        // var = (2/n)(¼ + 2/16) = (2/n) 3/8; at m = 2: ¼, 1/16, −⅛, −1/16: (2/n)(1/16 + 2 (1 + 4 + 1)/256).
        let terms = CompositeTerms {
            white: 0.1,
            ..CompositeTerms::default()
        };
        let point = |m| WaveletPoint {
            m,
            scale_s: m as f64,
            variance: 1.0,
            edf: 1.0,
            coefficients: 1000,
        };
        let points: Vec<WaveletPoint> = [1, 2, 4, 256].map(point).to_vec();
        let found = covariance(&points, &terms, 0.01, 1_000_000);
        let scale = 2.0 / 1e6; // white variance 1
        assert!((found[(0, 0)] / (scale * 0.375) - 1.0).abs() < 1e-4);
        assert!((found[(1, 1)] / (scale * 7.0 / 64.0) - 1.0).abs() < 1e-4);
        // Cross-covariance of m = 1 with 2: ⅛ at the two middle lags, −⅛ at none: by the definition
        // s(l) = Σ h₁(i) h₂(i + l) with h₁ = (½, −½), h₂ = (¼, ¼, −¼, −¼): ⅛, 0, −¼, 0, ⅛.
        let cross = scale * (1.0 / 64.0 + 1.0 / 16.0 + 1.0 / 64.0);
        assert!(
            (found[(1, 0)] / cross - 1.0).abs() < 1e-4,
            "{}",
            found[(1, 0)] / cross
        );
        // A long scale: relative variance 2/edf with edf = 3/2 · n/(2·m)… to a few per cent.
        let relative = found[(3, 3)] / (0.25f64 / 128.0 / 1.0).powi(2);
        let edf = crate::allan::confidence::edf(
            crate::allan::DeviationKind::Overlapping,
            0,
            1_000_000,
            256,
        );
        assert!(
            (relative * edf / 2.0 - 1.0).abs() < 0.02,
            "{}",
            relative * edf / 2.0
        );
    }
}
