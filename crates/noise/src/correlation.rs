//! Autocovariance, autocorrelation and partial autocorrelation with their bounds.
//!
//! Few lags are summed directly; many by FFT of blocks little longer than the lags, whose spectra are
//! added up: O(N log L) time and O(L) memory at any record length. Autocovariances are about the
//! mean with divisor n (biased, positive definite), as in Python's statsmodels and R.
//!
//! ```
//! let x: Vec<f64> = (0..300).map(|k| f64::from(k * 7919 % 101)).collect();
//! let acf = undrift_noise::correlation::autocorrelation(&x, 10)?;
//! assert_eq!((acf.len(), acf[0]), (11, 1.0));
//! # Ok::<(), undrift_noise::screening::RecordError>(())
//! ```

pub mod partial;

pub use partial::{Partial, partial_autocorrelation};

use crate::screening::record::{Compensated, RecordError, check_varying, dot};
use crate::transform::{Transform, add_product};
use realfft::RealFftPlanner;

/// Two-sided 95 % point of the normal distribution.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Lags from which on the FFT is faster.
const FFT_FROM: usize = 48;

/// Samples summed before the sums are added up with compensation.
const BLOCK: usize = 2048;

/// Autocovariances γ_0 … γ_lags \[unit²\] of a record about its mean, divisor n; `lags` in samples.
///
/// # Errors
/// Fewer than lags + 1 samples (2 at least), a sample that is not finite, a constant record.
///
/// ```
/// use undrift_noise::correlation::autocovariance;
/// let gamma = autocovariance(&[1.0, -1.0, 1.0, -1.0], 2)?;
/// assert_eq!(gamma, [1.0, -0.75, 0.5]); // Divisor n, whatever the lag.
/// # Ok::<(), undrift_noise::screening::RecordError>(())
/// ```
pub fn autocovariance(x: &[f64], lags: usize) -> Result<Vec<f64>, RecordError> {
    let (mean, squares) = check_varying(x, lags.saturating_add(1).max(2))?;
    let mut products = lagged_products(x, mean, lags);
    products[0] = squares;
    let count = x.len() as f64;
    products.iter_mut().for_each(|v| *v /= count);
    Ok(products)
}

/// Autocorrelations ρ_0 = 1 … ρ_lags of a record about its mean, divisor n; `lags` in samples.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{correlation::{autocorrelation, white_bound}, synthesis::NoiseGenerator};
/// // 10 samples to the correlation time: ρ falls as exp(−k/10).
/// let process = ShapingFilter::gauss_markov(1e-3, 0.1, 0.01)?;
/// let record: Vec<f64> = NoiseGenerator::new(&process, 1).take(50_000).collect();
/// let rho = autocorrelation(&record, 20)?;
/// assert!((rho[10] - (-1.0_f64).exp()).abs() < 0.03 && rho[20] > white_bound(50_000));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`autocovariance`].
pub fn autocorrelation(x: &[f64], lags: usize) -> Result<Vec<f64>, RecordError> {
    let mut values = autocovariance(x, lags)?;
    let variance = values[0];
    values.iter_mut().for_each(|v| *v /= variance);
    Ok(values)
}

/// 95 % bound of a (partial) autocorrelation of `samples` samples of white noise: 1.96 / √n. One value of twenty lies outside by chance.
///
/// ```
/// assert!((undrift_noise::correlation::white_bound(10_000) - 0.0196).abs() < 1e-5);
/// ```
pub fn white_bound(samples: usize) -> f64 {
    NORMAL_95 / (samples.max(1) as f64).sqrt()
}

/// Bartlett's 95 % bounds of ρ_1 … : at lag k of a moving average of order k − 1,
/// `1.96 √((1 + 2 Σ_{i<k} ρ_i²) / n)` (Box, Jenkins & Reinsel, equation 2.1.15).
/// `autocorrelation` begins with ρ_0 = 1, as [`autocorrelation()`] gives it; the first bound is that of lag 1.
///
/// ```
/// use undrift_noise::correlation::{bartlett_bounds, white_bound};
/// // Of a moving average with ρ_1 = 0.4 the later lags scatter more than those of white noise.
/// let bounds = bartlett_bounds(&[1.0, 0.4, 0.01, -0.02], 1000);
/// assert!((bounds[0] - white_bound(1000)).abs() < 1e-12);
/// assert!((bounds[1] / bounds[0] - (1.0 + 2.0 * 0.16_f64).sqrt()).abs() < 1e-12);
/// ```
pub fn bartlett_bounds(autocorrelation: &[f64], samples: usize) -> Vec<f64> {
    let mut sum = 1.0;
    let mut bounds = Vec::with_capacity(autocorrelation.len().saturating_sub(1));
    for value in autocorrelation.iter().skip(1) {
        bounds.push(NORMAL_95 * (sum / samples.max(1) as f64).sqrt());
        sum += 2.0 * value * value;
    }
    bounds
}

/// Σ (x_t − mean)(x_{t−k} − mean) for k = 0 … lags, which are fewer than the samples.
pub(crate) fn lagged_products(x: &[f64], mean: f64, lags: usize) -> Vec<f64> {
    if lags < FFT_FROM {
        direct(x, mean, lags)
    } else {
        by_fft(x, mean, lags)
    }
}

/// Lag by lag on blocks that stay in the cache.
fn direct(x: &[f64], mean: f64, lags: usize) -> Vec<f64> {
    let mut sums = vec![Compensated::default(); lags + 1];
    let mut block = vec![0.0; BLOCK + lags];
    for start in (0..x.len()).step_by(BLOCK) {
        let end = (start + BLOCK).min(x.len());
        let reach = (end + lags).min(x.len());
        for (slot, value) in block.iter_mut().zip(&x[start..reach]) {
            *slot = value - mean;
        }
        for (lag, sum) in sums.iter_mut().enumerate() {
            let pairs = (end - start).min((reach - start).saturating_sub(lag));
            sum.add(dot(&block[..pairs], &block[lag..lag + pairs]));
        }
    }
    sums.iter().map(|s| s.value()).collect()
}

/// The products by FFT: cross spectra of each stretch with itself continued by `lags` samples.
fn by_fft(x: &[f64], mean: f64, lags: usize) -> Vec<f64> {
    // No circular overlap: a stretch and its continuation by `lags` fit in `size`.
    let size = (4 * lags).next_power_of_two().max(4096);
    let stretch = size - lags;
    let transform = Transform::new(size / 2, &mut RealFftPlanner::new());
    let mut room = transform.room();
    let [mut short, mut long, mut sum] = [(); 3].map(|()| transform.empty());
    for start in (0..x.len()).step_by(stretch) {
        let part = &x[start..x.len().min(start + size)];
        let part: Vec<f64> = part.iter().map(|value| value - mean).collect();
        transform.spectrum(&part[..stretch.min(part.len())], &mut room, &mut short);
        transform.spectrum(&part, &mut room, &mut long);
        add_product(&mut sum, &short, &long);
    }
    let mut products = vec![0.0; lags + 1];
    transform.add_samples(&mut sum, &mut room, &mut products);
    products
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of few lags are those of a loop: of whole numbers they have no rounding, as an FFT's have.
    #[test]
    fn few_lags_of_whole_numbers_are_exact_and_many_to_rounding() {
        let x: Vec<f64> = (0..5000).map(|k| f64::from(k * 7919 % 101 - 50)).collect();
        let sum = |lag: usize| x.iter().zip(&x[lag..]).map(|(a, b)| a * b).sum::<f64>();
        for lags in [0, 5, FFT_FROM - 1, FFT_FROM, 300] {
            let exact: Vec<f64> = (0..=lags).map(sum).collect();
            let found = lagged_products(&x, 0.0, lags);
            if lags < FFT_FROM {
                assert_eq!(found, exact);
            }
            // Whole numbers below 5e6, of which an FFT keeps fifteen digits.
            let off = found.iter().zip(&exact).map(|(a, b)| (a - b).abs());
            assert!(found.len() == lags + 1 && off.fold(0.0, f64::max) < 1e-7);
        }
    }
}
