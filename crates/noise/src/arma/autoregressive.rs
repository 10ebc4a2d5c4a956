//! AR(p) without a search: Burg's method and Yule-Walker by the Levinson recursion. (By likelihood:
//! [`super::fit()`] with q = 0.)

use super::ArmaError;
use super::likelihood::screen;
use crate::correlation::lagged_products;
use crate::prediction::{self, Predictor};

/// An autoregression `x_t − φ1 x_{t−1} − … − φp x_{t−p} = a_t` of a record about its mean.
#[derive(Clone, Debug, PartialEq)]
pub struct ArFit {
    /// φ1 … φp; stationary.
    pub ar: Vec<f64>,
    /// Variance of a \[unit²\].
    pub variance: f64,
    /// Sample mean that was removed \[unit\].
    pub mean: f64,
    /// Partial autocorrelations at lags 1 … p (reflection coefficients).
    pub partial_autocorrelations: Vec<f64>,
    /// Variance of a at orders 0 … p \[unit²\].
    pub variance_by_order: Vec<f64>,
}

/// Mean of a record that can have an AR(p) without a search: unbroken, long enough, not constant.
fn checked(samples: &[f64], p: usize) -> Result<f64, ArmaError> {
    let (mean, present) = screen(samples, p)?;
    if present < samples.len() {
        return Err(ArmaError::Missing);
    }
    if present <= 2 * p {
        return Err(ArmaError::TooShort {
            present,
            needed: 2 * p + 1,
        });
    }
    Ok(mean)
}

impl ArFit {
    /// A predictor grown by one reflection after the other, about a mean.
    fn grown(mean: f64, variance: f64, p: usize, mut next: impl FnMut(&Predictor) -> f64) -> Self {
        let mut predictor = Predictor::new(variance);
        let mut partial_autocorrelations = Vec::with_capacity(p);
        let mut variance_by_order = vec![variance];
        for _ in 0..p {
            let kappa = next(&predictor);
            predictor.extend(kappa);
            partial_autocorrelations.push(kappa);
            variance_by_order.push(predictor.variance);
        }
        Self {
            ar: predictor.phi,
            variance: predictor.variance,
            mean,
            partial_autocorrelations,
            variance_by_order,
        }
    }
}

/// AR(p) by Burg's method: each reflection coefficient minimises the forward and backward
/// prediction errors together. Least biased of the direct methods for a slow pole. Burg 1967;
/// Percival & Walden 1993, section 9.5. O(N p) time, two copies of the record.
///
/// # Errors
/// A record too short, constant, infinite or with missing samples.
///
/// ```
/// use undrift_noise::arma::burg;
/// // Of 1, 0, −1, 0, … the second reflection is −1: the period is four, and nothing is left to predict.
/// let wave: Vec<f64> = [1.0, 0.0, -1.0, 0.0].repeat(10);
/// let fit = burg(&wave, 2)?;
/// assert!(fit.ar[0].abs() < 0.1 && (fit.partial_autocorrelations[1] + 1.0).abs() < 0.01);
/// assert!(fit.variance < 1e-2 * fit.variance_by_order[0]);
/// # Ok::<(), undrift_noise::arma::ArmaError>(())
/// ```
pub fn burg(samples: &[f64], p: usize) -> Result<ArFit, ArmaError> {
    let mean = checked(samples, p)?;
    let n = samples.len();
    let centred: Vec<f64> = samples.iter().map(|x| x - mean).collect();
    let variance = centred.iter().map(|x| x * x).sum::<f64>() / n as f64;
    let mut reflections = prediction::burg(centred, p).into_iter();
    Ok(ArFit::grown(mean, variance, p, |_| {
        reflections.next().unwrap_or(0.0)
    }))
}

/// AR(p) by the Yule-Walker equations, from the biased autocovariances (divisor N, so the result
/// is always stationary), solved by the Levinson-Durbin recursion. Box, Jenkins & Reinsel section
/// 3.2. Strongly biased towards zero for a slow pole: Burg or the likelihood are better there.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{arma::{burg, yule_walker}, synthesis::NoiseGenerator};
/// let process = ShapingFilter::arma(&[0.995], &[], 1e-3, 0.01)?; // Correlation time of 2 s, in 10 s of samples.
/// let record: Vec<f64> = NoiseGenerator::new(&process, 1).take(1000).collect();
/// let (burg, yule_walker) = (burg(&record, 1)?, yule_walker(&record, 1)?);
/// assert!(yule_walker.ar[0] < burg.ar[0] && burg.ar[0] < 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A record too short, constant, infinite or with missing samples.
pub fn yule_walker(samples: &[f64], p: usize) -> Result<ArFit, ArmaError> {
    let mean = checked(samples, p)?;
    let mut gamma = lagged_products(samples, mean, p);
    gamma
        .iter_mut()
        .for_each(|sum| *sum /= samples.len() as f64);
    Ok(ArFit::grown(mean, gamma[0], p, |so_far| {
        if so_far.variance > 0.0 {
            so_far.reflection(&gamma)
        } else {
            0.0
        }
    }))
}

/// The order up to `p_max` with the least AICc, `N ln σ²_p + 2 (p+2) N/(N−p−3)`, by Burg's variances: one pass of [`burg`] for all orders.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{arma::order_by_aicc, synthesis::NoiseGenerator};
/// let process = ShapingFilter::ar(&[0.5, 0.3], 1e-3, 0.01)?;
/// let record: Vec<f64> = NoiseGenerator::new(&process, 1).take(5000).collect();
/// assert!((2..=4).contains(&order_by_aicc(&record, 10)?)); // Rarely too low, at times too high.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`burg`].
pub fn order_by_aicc(samples: &[f64], p_max: usize) -> Result<usize, ArmaError> {
    let fit = burg(samples, p_max)?;
    let n = samples.len() as f64;
    let score = |p: usize| {
        let spare = (n - p as f64 - 3.0).max(0.5);
        n * fit.variance_by_order[p].max(f64::MIN_POSITIVE).ln()
            + 2.0 * (p as f64 + 2.0) * n / spare
    };
    let mut best = 0;
    for p in 1..=p_max {
        if score(p) < score(best) {
            best = p;
        }
    }
    Ok(best)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// Hurvich & Tsai: n ln σ² + 2 k n / (n − k − 1), k parameters: p coefficients, mean and variance.
    #[test]
    fn the_order_has_the_least_corrected_criterion() {
        for seed in 1..=10 {
            let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
            let (mut x, mut before) = (0.0, 0.0);
            let samples: Vec<f64> = (0..60)
                .map(|_| {
                    let next = 0.9 * x - 0.5 * before + rng.random::<f64>() - 0.5;
                    (x, before) = (next, x);
                    next
                })
                .collect();
            let n = samples.len() as f64;
            let criterion = |p: usize| {
                let k = p as f64 + 2.0;
                let variance = *burg(&samples, p).unwrap().variance_by_order.last().unwrap();
                n * variance.ln() + 2.0 * k * n / (n - k - 1.0)
            };
            let least = (0..=20).map(criterion).fold(f64::INFINITY, f64::min);
            let order = order_by_aicc(&samples, 20).unwrap();
            assert!((criterion(order) - least).abs() < 1e-9, "{seed}: {order}");
        }
    }
}
