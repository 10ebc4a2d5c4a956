//! Haar wavelet variance of a record and the generalised method of wavelet moments.
//!
//! Convention of Percival & Walden 2000 (chapter 8, MODWT, unbiased): at the scale of `m` samples the
//! wavelet coefficient is half the difference of neighbouring means over m samples, its variance
//! ν²(m) is half the Allan variance at τ = mT. Octave scales m = 1, 2, 4, … up to a quarter of the
//! record.
//!
//! [`fit_moments`] matches the model's wavelet variances ([`model_variance`], closed form) to the
//! record's: Guerrier, Skaloud, Stebler & Victoria-Feser 2013, J. Am. Stat. Assoc. 108. It gives the
//! starts of [`crate::composite::fit`], and is an estimator of its own, O(N) with one pass.
//!
//! ```
//! use undrift_noise::{allan, wavelet};
//! let record: Vec<f64> = (0..4096u32).map(|k| f64::from(k * 7919 % 101)).collect();
//! let curve = wavelet::wavelet_variance(&record, 0.01)?;
//! let allan = allan::deviations(&record, 100.0, allan::DeviationKind::Overlapping, allan::Grid::Octave)?;
//! assert_eq!((curve.points[3].m, allan.points[3].m), (8, 8));
//! let half = 0.5 * allan.points[3].deviation.powi(2);
//! assert!((curve.points[3].variance / half - 1.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod moments;
mod pyramid;
mod scatter;

pub use moments::{MomentFit, fit_moments};

use crate::allan::DeviationKind;
use crate::allan::confidence::edf;
use crate::allan::gauss_markov::{Ar1, ar1_variance};
use crate::terms::{self, CompositeError, CompositeTerms, GaussMarkov};

/// Wavelet variance at one scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveletPoint {
    /// Number of samples to a mean.
    pub m: usize,
    /// Scale m T \[s\].
    pub scale_s: f64,
    /// Wavelet variance ν² \[unit²\], half the Allan variance at τ = `scale_s`.
    pub variance: f64,
    /// Equivalent degrees of freedom, for the noise type that the slope at this scale shows.
    pub edf: f64,
    /// Number of coefficients whose squares were averaged (at m > 32 one in m/32 is used, which costs no
    /// information to speak of).
    pub coefficients: usize,
}

/// Wavelet variance of a record over scale.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveletVariance {
    /// Sample interval T \[s\].
    pub interval: f64,
    /// Number of samples of the record, missing ones counted.
    pub samples: usize,
    /// The scales, growing by octaves.
    pub points: Vec<WaveletPoint>,
}

/// Haar wavelet variance of a record at a sample interval \[s\] at octave scales, in one pass with
/// 2 kB of memory a scale. NaN is a missing sample: a coefficient is used where at most a tenth of
/// its 2m samples is missing, these counting with the mean of the last 32.
///
/// # Errors
/// Fewer than 16 samples present, an infinite or constant record, a bad interval.
///
/// The noise type that [`WaveletPoint::edf`] takes is from the slope between the neighbouring scales, −1 −
/// slope rounded.
pub fn wavelet_variance(record: &[f64], interval: f64) -> Result<WaveletVariance, CompositeError> {
    // Checks the interval as every model will.
    undrift_nav::shaping::ShapingFilter::none(interval)?;
    let (centre, present) = terms::present_mean(record)?;
    if present < 16 {
        return Err(CompositeError::TooShort {
            present,
            needed: 16,
        });
    }
    let mut points = Vec::new();
    for energy in pyramid::energies(record, centre) {
        if energy.coefficients < 2 {
            continue;
        }
        let width = energy.m as f64;
        let variance = energy.squares / (4.0 * width * width * energy.coefficients as f64);
        if !variance.is_finite() {
            return Err(CompositeError::NotFinite);
        }
        points.push(WaveletPoint {
            m: energy.m,
            scale_s: width * interval,
            variance,
            edf: 0.0,
            coefficients: energy.coefficients,
        });
    }
    if points.iter().all(|p| p.variance == 0.0) {
        return Err(CompositeError::Constant);
    }
    for i in 0..points.len() {
        let (low, high) = (i.saturating_sub(1), (i + 1).min(points.len() - 1));
        let rise = (points[high].variance / points[low].variance).log2();
        let slope = rise / (high - low).max(1) as f64;
        let alpha = if slope.is_finite() {
            (-1.0 - slope).round().clamp(-2.0, 2.0) as i32
        } else {
            0
        };
        points[i].edf = edf(DeviationKind::Overlapping, alpha, present, points[i].m);
    }
    Ok(WaveletVariance {
        interval,
        samples: record.len(),
        points,
    })
}

/// The wavelet variance of several records of one process, of the same sample interval: at each scale the average over all their
/// coefficients; their degrees of freedom add up. `None` of no record.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{synthesis::NoiseGenerator, wavelet::{pooled, wavelet_variance, white_variance}};
/// let white = ShapingFilter::white(1e-3, 0.01)?;
/// let curve = |seed| wavelet_variance(&NoiseGenerator::new(&white, seed).take(4000).collect::<Vec<_>>(), 0.01);
/// let both = pooled(&[curve(1)?, curve(2)?]).expect("two curves");
/// assert!((both.points[0].variance / white_variance(1e-3, 0.01) - 1.0).abs() < 0.1);
/// assert!((both.points[0].edf / curve(1)?.points[0].edf - 2.0).abs() < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn pooled(curves: &[WaveletVariance]) -> Option<WaveletVariance> {
    let longest = curves.iter().max_by_key(|curve| curve.points.len())?;
    let mut pooled = longest.clone();
    pooled.samples = curves.iter().map(|curve| curve.samples).sum();
    for (scale, point) in pooled.points.iter_mut().enumerate() {
        let (mut squares, mut coefficients, mut freedom) = (0.0, 0, 0.0);
        let all = curves.iter().flat_map(|curve| curve.points.get(scale));
        for other in all.filter(|other| other.m == point.m) {
            squares += other.variance * other.coefficients as f64;
            coefficients += other.coefficients;
            freedom += other.edf;
        }
        point.variance = squares / coefficients as f64;
        point.coefficients = coefficients;
        point.edf = freedom;
    }
    Some(pooled)
}

/// Wavelet variance \[unit²\] of white noise of density `density` [unit·√s] at scale `scale_s` \[s\]: N²/(2τ).
pub fn white_variance(density: f64, scale_s: f64) -> f64 {
    density * density / (2.0 * scale_s)
}

/// Wavelet variance \[unit²\] of quantisation `q` [unit·s] at scale `scale_s` \[s\]: 3Q²/(2τ²).
pub fn quantisation_variance(q: f64, scale_s: f64) -> f64 {
    1.5 * (q / scale_s) * (q / scale_s)
}

/// Wavelet variance \[unit²\] of a random walk `k` [unit/√s] sampled every `interval` \[s\] at a scale
/// of `m` samples: `K² T (2m² + 1)/(12m)`, K²τ/6 for large m.
///
/// ```
/// use undrift_noise::wavelet::{quantisation_variance, random_walk_variance, white_variance};
/// // Half the Allan variances N²/τ, 3Q²/τ² and, over many samples, K²τ/3.
/// assert_eq!((white_variance(2.0, 4.0), quantisation_variance(2.0, 4.0)), (0.5, 0.375));
/// assert!((random_walk_variance(2.0, 400, 0.01) / (0.5 * 4.0 * 4.0 / 3.0) - 1.0).abs() < 1e-5);
/// // At one sample the coefficient is half a step of the walk: a quarter of the step's variance K²T.
/// assert!((random_walk_variance(2.0, 1, 0.01) - 0.01).abs() < 1e-15);
/// ```
pub fn random_walk_variance(k: f64, m: usize, interval: f64) -> f64 {
    let width = m.max(1) as f64;
    k * k * interval * (2.0 * width * width + 1.0) / (12.0 * width)
}

/// Mean square \[unit²\] of the wavelet coefficients of a drift `rate` [unit/s] at scale `scale_s`
/// \[s\]: R²τ²/4.
///
/// It grows with τ² where all noise grows with τ at most, so a drift shows in the longest scales
/// alone.
///
/// ```
/// use undrift_noise::wavelet::drift_variance;
/// // A ramp of 2 a second: means of 3 s differ by 6, the coefficient is half of that.
/// assert_eq!(drift_variance(2.0, 3.0), 9.0);
/// ```
pub fn drift_variance(rate: f64, scale_s: f64) -> f64 {
    0.25 * (rate * scale_s) * (rate * scale_s)
}

/// Wavelet variance \[unit²\] of a Gauss-Markov process sampled every `interval` \[s\] at a scale of `m`
/// samples: closed form, a series where m T is below half of τ; exact at any ratio.
///
/// ```
/// use undrift_noise::{composite::GaussMarkov, wavelet::gauss_markov_variance};
/// // Over 1000 correlation times it is white noise of density² 2σ²τ: σ²τ/T.
/// let process = GaussMarkov { sigma: 1.0, tau_s: 1.0 };
/// let long = gauss_markov_variance(&process, 100_000, 0.01);
/// assert!((long / 1e-3 - 1.0).abs() < 0.01);
/// ```
pub fn gauss_markov_variance(process: &GaussMarkov, m: usize, interval: f64) -> f64 {
    if process.sigma == 0.0 {
        return 0.0;
    }
    0.5 * ar1_variance(m, process.sigma, interval / process.tau_s)
}

/// Wavelet variance \[unit²\] of composite terms at a scale of `m` samples of `interval` \[s\].
///
/// ```
/// use undrift_noise::{composite::{CompositeTerms, GaussMarkov}, wavelet::{gauss_markov_variance, model_variance, white_variance}};
/// let process = GaussMarkov { sigma: 1e-4, tau_s: 100.0 };
/// let terms = CompositeTerms { white: 1e-3, gauss_markov: [process, GaussMarkov::default()], ..CompositeTerms::default() };
/// // Independent terms: their variances add up, at 10 s as at any scale.
/// let sum = white_variance(1e-3, 10.0) + gauss_markov_variance(&process, 1000, 0.01);
/// assert!((model_variance(&terms, 1000, 0.01) / sum - 1.0).abs() < 1e-12);
/// ```
pub fn model_variance(terms: &CompositeTerms, m: usize, interval: f64) -> f64 {
    ModelCurve::new(terms, interval).at(m)
}

/// Wavelet variance of composite terms, to be asked for at several scales.
struct ModelCurve {
    interval: f64,
    white: f64,
    quantisation: f64,
    walk: f64,
    processes: Vec<Ar1>,
}

impl ModelCurve {
    fn new(terms: &CompositeTerms, interval: f64) -> Self {
        let (processes, walk) = terms.slow();
        let sampled = |process: &GaussMarkov| Ar1::new(process.sigma, interval / process.tau_s);
        Self {
            interval,
            white: terms.white,
            quantisation: terms.quantisation,
            walk,
            processes: processes.iter().map(sampled).collect(),
        }
    }

    /// Wavelet variance at `m` samples, by [`model_variance`].
    fn at(&self, m: usize) -> f64 {
        let scale_s = m.max(1) as f64 * self.interval;
        let processes = self.processes.iter();
        white_variance(self.white, scale_s)
            + quantisation_variance(self.quantisation, scale_s)
            + random_walk_variance(self.walk, m, self.interval)
            + processes.map(|g| 0.5 * g.variance(m)).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// E of the squared coefficient from the autocovariance of a model's shaping filter.
    fn by_sum(terms: &CompositeTerms, m: usize, interval: f64) -> f64 {
        let filter = terms.to_shaping(interval).unwrap();
        let mut lags = vec![0.0; 2 * m];
        filter.autocovariance(&mut lags);
        let mut sum = 0.0;
        for i in 0..2 * m {
            for j in 0..2 * m {
                let sign = if (i < m) == (j < m) { 1.0 } else { -1.0 };
                sum += sign * lags[i.abs_diff(j)];
            }
        }
        sum / (4.0 * (m * m) as f64)
    }

    #[test]
    fn stationary_terms_are_the_double_sum_of_their_autocovariance() {
        let process = |sigma, tau_s| GaussMarkov { sigma, tau_s };
        let none = GaussMarkov::default();
        for terms in [
            CompositeTerms {
                white: 0.3,
                ..CompositeTerms::default()
            },
            CompositeTerms {
                quantisation: 0.02,
                ..CompositeTerms::default()
            },
            CompositeTerms {
                gauss_markov: [process(0.4, 0.7), process(0.2, 0.004)],
                ..CompositeTerms::default()
            },
            CompositeTerms {
                white: 0.01,
                quantisation: 0.001,
                gauss_markov: [process(0.1, 0.05), none],
                ..CompositeTerms::default()
            },
        ] {
            for m in [1, 2, 5, 32] {
                let (sum, closed) = (by_sum(&terms, m, 0.01), model_variance(&terms, m, 0.01));
                // The sum cancels to 1/m² of its 4m² terms.
                let tolerance = 1e-13 * (m * m) as f64;
                assert!(
                    (closed / sum - 1.0).abs() < tolerance,
                    "{terms:?} {m}: {closed} {sum}"
                );
            }
        }
    }

    #[test]
    fn random_walk_is_the_limit_of_a_slow_process() {
        let (k, t) = (0.2, 0.01);
        for m in [1, 3, 64, 4096] {
            let tau_s = 1e12;
            let process = GaussMarkov {
                sigma: k * (0.5f64 * tau_s).sqrt(),
                tau_s,
            };
            let ratio = gauss_markov_variance(&process, m, t) / random_walk_variance(k, m, t);
            // The next term of the series is m T/τ = 4e-11 of it.
            assert!((ratio - 1.0).abs() < 1e-10, "{m}: {ratio}");
        }
    }

    #[test]
    fn the_record_variances_are_half_the_allan_variances() {
        let mut seed = 1u64;
        let record: Vec<f64> = (0..5000)
            .map(|_| {
                seed = seed
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                (seed >> 40) as f64
            })
            .collect();
        let curve = wavelet_variance(&record, 0.5).unwrap();
        let grid = crate::allan::Grid::Octave;
        let allan =
            crate::allan::deviations(&record, 2.0, DeviationKind::Overlapping, grid).unwrap();
        assert_eq!(curve.points.len(), 11); // up to 1024 of 5000
        for (ours, point) in curve.points.iter().zip(&allan.points) {
            assert_eq!((ours.m, ours.scale_s == point.tau_s), (point.m, true));
            let ratio = 2.0 * ours.variance / point.deviation.powi(2);
            // Equal up to m = 32; above, one coefficient in m/32 is left of the same sum, whose
            // neighbours are 95 % correlated: within a fifth of the estimate's own error.
            let tolerance = if ours.m <= 32 {
                1e-12
            } else {
                0.2 * (2.0 / ours.edf).sqrt()
            };
            assert!((ratio - 1.0).abs() < tolerance, "{}: {ratio}", ours.m);
        }
    }

    #[test]
    fn bad_records_are_errors() {
        assert!(wavelet_variance(&[1.0; 8], 0.01).is_err());
        assert_eq!(
            wavelet_variance(&[1.0; 100], 0.01),
            Err(CompositeError::Constant)
        );
        assert!(wavelet_variance(&[f64::NAN; 100], 0.01).is_err());
        let mut record: Vec<f64> = (0..100).map(|k| f64::from(k % 7)).collect();
        assert!(wavelet_variance(&record, 0.0).is_err());
        record[50] = f64::INFINITY;
        assert_eq!(
            wavelet_variance(&record, 0.01),
            Err(CompositeError::NotFinite)
        );
    }

    #[test]
    fn a_missing_sample_hides_the_short_coefficients_it_is_in() {
        let record: Vec<f64> = (0..2000u32).map(|k| f64::from(k * 7919 % 101)).collect();
        let mut gappy = record.clone();
        gappy[777] = f64::NAN;
        let (whole, gap) = (
            wavelet_variance(&record, 1.0).unwrap(),
            wavelet_variance(&gappy, 1.0).unwrap(),
        );
        let lost = |i: usize| whole.points[i].coefficients - gap.points[i].coefficients;
        // m = 1, 2, 4 have 2, 4, 8 samples: none may miss; from m = 8 one of 16 may.
        assert_eq!((lost(0), lost(1), lost(2), lost(3)), (2, 4, 8, 0));
    }

    fn point(m: usize, variance: f64, coefficients: usize, edf: f64) -> WaveletPoint {
        WaveletPoint {
            m,
            scale_s: m as f64,
            variance,
            edf,
            coefficients,
        }
    }

    #[test]
    fn pooled_scales_are_averages_over_all_coefficients() {
        let curve = |points: Vec<WaveletPoint>, samples| WaveletVariance {
            interval: 1.0,
            samples,
            points,
        };
        let short = curve(vec![point(1, 4.0, 10, 5.0)], 11);
        let long = curve(vec![point(1, 1.0, 30, 20.0), point(2, 3.0, 20, 7.0)], 31);
        let found = pooled(&[short, long]).unwrap();
        assert_eq!(found.samples, 42);
        // (4 · 10 + 1 · 30)/40.
        assert_eq!(
            found.points,
            [point(1, 1.75, 40, 25.0), point(2, 3.0, 20, 7.0)]
        );
        assert_eq!(pooled(&[]), None);
    }

    #[test]
    fn a_wavelet_variance_is_the_mean_square_of_half_differences_of_means() {
        let record: Vec<f64> = (0..64).map(|k| (k * k * 37 % 17) as f64).collect();
        let found = wavelet_variance(&record, 0.5).unwrap();
        assert_eq!((found.samples, found.interval), (64, 0.5));
        assert_eq!(found.points.len(), 5);
        for (j, of) in found.points.iter().enumerate() {
            let m = 1 << j;
            assert_eq!((of.m, of.scale_s), (m, 0.5 * m as f64));
            let mean = |from: usize| record[from..from + m].iter().sum::<f64>() / m as f64;
            let all = (0..=64 - 2 * m).map(|k| (0.5 * (mean(k + m) - mean(k))).powi(2));
            let all = Vec::from_iter(all);
            assert_eq!(of.coefficients, all.len());
            let exact = all.iter().sum::<f64>() / all.len() as f64;
            assert!((of.variance / exact - 1.0).abs() < 1e-9, "{m}");
        }
    }

    #[test]
    fn degrees_of_freedom_go_by_the_slope_between_the_neighbouring_scales() {
        let mut seed = 1u64;
        let mut walk = 0.0;
        let record: Vec<f64> = (0..20_000)
            .map(|_| {
                seed = seed
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                let white = (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
                walk += 0.03 * white;
                seed = seed
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                walk + (seed >> 11) as f64 / (1u64 << 53) as f64
            })
            .collect();
        let found = wavelet_variance(&record, 1.0).unwrap().points;
        let last = found.len() - 1;
        let edf_of =
            |alpha: i32, i: usize| edf(DeviationKind::Overlapping, alpha, 20_000, found[i].m);
        for i in 0..=last {
            let (low, high) = (
                if i > 0 { i - 1 } else { 0 },
                if i < last { i + 1 } else { last },
            );
            let slope = (found[high].variance / found[low].variance).log2() / (high - low) as f64;
            // ν² ∝ τ^(−1−α).
            let alpha = (-1.0 - slope).round().clamp(-2.0, 2.0) as i32;
            assert_eq!(found[i].edf, edf_of(alpha, i), "{i}");
        }
        // White noise first, a random walk at the end.
        assert_eq!(found[0].edf, edf_of(0, 0));
        assert_eq!(found[9].edf, edf_of(-2, 9));
    }

    #[test]
    fn a_record_without_sixteen_samples_or_a_variance_is_refused() {
        let record: Vec<f64> = (0..16).map(|k| f64::from(k % 3)).collect();
        assert!(wavelet_variance(&record, 1.0).is_ok());
        let mut missing = record.clone();
        missing[3] = f64::NAN;
        let short = Err(CompositeError::TooShort {
            present: 15,
            needed: 16,
        });
        assert_eq!(wavelet_variance(&missing, 1.0), short);
        assert_eq!(wavelet_variance(&record[..15], 1.0), short);
        assert_eq!(
            wavelet_variance(&[2.0; 16], 1.0),
            Err(CompositeError::Constant)
        );
        assert!(wavelet_variance(&record, 0.0).is_err());
    }
}
