//! Covariance of wavelet variances under a model: the scales overlap in frequency.
//!
//! For a Gaussian process of spectrum S and Haar filters H, `cov(ν̂_j², ν̂_k²) = (2/n) ∫ |H_j|² |H_k|² S² df`
//! over frequencies −½…½ a sample, n the coefficients of the longer scale: Percival & Walden 2000,
//! section 8.4, Serroukh & Walden 2000. `|H_m|² = sin⁴(πfm) / (m² sin²(πf))`.
//!
//! The integral is taken octave by octave of frequency, by the middles of 64 steps in each.

use super::WaveletPoint;
use crate::terms::{CompositeTerms, GaussMarkov};
use nalgebra::DMatrix;
use std::f64::consts::PI;

/// Points an octave of frequency.
const POINTS: usize = 64;

/// Spectrum \[unit²\] at sin²(πf), f in cycles a sample; its mean over −½…½ is the variance. `slow`: the terms'
/// [`CompositeTerms::slow`].
///
/// White noise is flat, N²/T; quantisation rises as 4 sin²(πf) (a difference of white noise); a walk falls as
/// 1/(4 sin²(πf)); an AR(1) of φ = e^{−a} has σ²(1 − φ²)/((1 − φ)² + 4φ sin²(πf)), whose small differences are
/// taken by `exp_m1`.
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
///
/// Symmetric, in the order of `points`. Assumes normal noise; heavy tails scatter more at the
/// shortest scales.
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

    /// By the definition: the coefficients' cross-covariances from the autocovariance of the terms, squared and summed over
    /// all lags.
    fn plainly(autocovariance: &[f64], (m, n): (usize, usize)) -> f64 {
        let filter = |m: usize| -> Vec<f64> {
            let half = 0.5 / m as f64;
            (0..2 * m)
                .map(|i| if i < m { half } else { -half })
                .collect()
        };
        let (a, b) = (filter(m), filter(n));
        let reach = autocovariance.len() as i64;
        let at = |lag: i64| {
            autocovariance
                .get(lag.unsigned_abs() as usize)
                .copied()
                .unwrap_or(0.0)
        };
        let lags = -reach - 2 * m as i64..=reach + 2 * n as i64;
        let covariance = |lag: i64| -> f64 {
            let terms = a.iter().enumerate().flat_map(|(i, a)| {
                let of = move |(j, b): (usize, &f64)| a * b * at(lag + i as i64 - j as i64);
                b.iter().enumerate().map(of)
            });
            terms.sum()
        };
        lags.map(|lag| covariance(lag).powi(2)).sum()
    }

    #[test]
    fn coloured_noise_has_the_covariance_of_its_definition() {
        let interval = 0.5;
        let terms = CompositeTerms {
            white: 0.3,
            quantisation: 0.2,
            gauss_markov: [
                GaussMarkov {
                    sigma: 0.7,
                    tau_s: 2.0,
                },
                GaussMarkov {
                    sigma: 0.4,
                    tau_s: 0.6,
                },
            ],
            ..CompositeTerms::default()
        };
        let mut autocovariance = [0.0; 100];
        let filter = terms.to_shaping(interval).unwrap();
        filter.autocovariance(&mut autocovariance);
        let point = |m| WaveletPoint {
            m,
            scale_s: m as f64 * interval,
            variance: 1.0,
            edf: 1.0,
            coefficients: 1,
        };
        let points = [1, 2, 4].map(point);
        let found = covariance(&points, &terms, interval, 1000);
        for j in 0..3 {
            for k in 0..=j {
                let longer = points[j].m;
                let coefficients = (1001 - 2 * longer) as f64;
                let exact = 2.0 / coefficients * plainly(&autocovariance, (points[k].m, longer));
                // A few dozen points an octave by the midpoint rule.
                assert!((found[(j, k)] / exact - 1.0).abs() < 1e-3, "{j} {k}");
                assert_eq!(found[(j, k)], found[(k, j)]);
            }
        }
    }

    #[test]
    fn the_mean_of_a_spectrum_is_the_variance_and_that_of_a_walks_steps_its_drive() {
        let interval = 0.5;
        let mean = |terms: &CompositeTerms, times: &dyn Fn(f64) -> f64| {
            let slow = terms.slow();
            let at = |k: usize| (PI * (k as f64 + 0.5) / 20_000.0).sin().powi(2);
            let density = |sine2: f64| spectrum(terms, &slow, sine2, interval) * times(sine2);
            (0..20_000).map(|k| density(at(k))).sum::<f64>() / 20_000.0
        };
        let none = CompositeTerms::default();
        let process = |sigma, tau_s| [GaussMarkov { sigma, tau_s }, GaussMarkov::default()];
        for (terms, variance) in [
            (CompositeTerms { white: 0.3, ..none }, 0.09 / 0.5),
            (
                CompositeTerms {
                    quantisation: 0.2,
                    ..none
                },
                2.0 * 0.16,
            ),
            (
                CompositeTerms {
                    gauss_markov: process(0.7, 4.0),
                    ..none
                },
                0.49,
            ),
        ] {
            assert!(
                (mean(&terms, &|_| 1.0) / variance - 1.0).abs() < 1e-9,
                "{terms:?}"
            );
        }
        // Differences have the gain 4 sin²(πf).
        let walk = CompositeTerms {
            random_walk: 0.6,
            ..none
        };
        assert!((mean(&walk, &|sine2| 4.0 * sine2) / (0.36 * 0.5) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_shortest_scale_alone_has_all_of_its_spectrum() {
        let terms = CompositeTerms {
            white: 0.1,
            ..CompositeTerms::default()
        };
        let point = WaveletPoint {
            m: 1,
            scale_s: 0.01,
            variance: 0.5,
            edf: 1.0,
            coefficients: 1000,
        };
        let found = covariance(&[point], &terms, 0.01, 1001);
        // Eight octaves: what is below them is a millionth, the midpoint rule errs by less than 1e-4.
        assert!((found[(0, 0)] / (2.0 / 1000.0 * 0.375) - 1.0).abs() < 1e-4);
    }
}
