//! Partial autocorrelation.

use super::autocovariance;
use crate::prediction::{self, Predictor};
use crate::screening::record::{RecordError, check_varying};

/// Method by which partial autocorrelations are estimated.
///
/// All three agree in long records of processes whose roots are far from the circle; near it Yule and Walker's are
/// pulled towards 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Partial {
    /// Durbin-Levinson on autocovariances with divisor n: R's `pacf`, statsmodels' "ywmle" and
    /// "ldbiased". Never beyond ±1.
    YuleWalker,
    /// Durbin-Levinson on autocovariances with divisor n − k at lag k: statsmodels' "ywadjusted". May leave ±1.
    YuleWalkerAdjusted,
    /// Burg's reflection coefficients of the record less its mean: statsmodels' "burg". O(N) a lag,
    /// and the one to trust near a unit root.
    Burg,
}

/// Partial autocorrelations at lags 1 … `lags` (element 0 is 1, as for the autocorrelation). Those of an AR(p) are 0 beyond lag
/// p, those of an ARMA fall off gradually; [`white_bound`](super::white_bound) is what 0 looks like.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::correlation::{Partial, partial_autocorrelation, white_bound};
/// use undrift_noise::synthesis::NoiseGenerator;
/// let process = ShapingFilter::ar(&[0.8], 1e-3, 0.01)?;
/// let record: Vec<f64> = NoiseGenerator::new(&process, 1).take(5000).collect();
/// let partial = partial_autocorrelation(&record, 3, Partial::Burg)?;
/// assert!((partial[1] - 0.8).abs() < 0.03);
/// assert!(partial[2..].iter().all(|value| value.abs() < 1.5 * white_bound(5000)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Fewer than lags + 1 samples (2 at least), a sample that is not finite, a constant record.
pub fn partial_autocorrelation(
    x: &[f64],
    lags: usize,
    method: Partial,
) -> Result<Vec<f64>, RecordError> {
    if method == Partial::Burg {
        return burg(x, lags);
    }
    let mut covariance = autocovariance(x, lags)?;
    if method == Partial::YuleWalkerAdjusted {
        let count = x.len() as f64;
        for (lag, value) in covariance.iter_mut().enumerate() {
            *value *= count / (count - lag as f64);
        }
    }
    Ok(durbin_levinson(&covariance))
}

/// Partial autocorrelations of autocovariances γ_0 …, by Durbin's recursion (Box, Jenkins & Reinsel,
/// appendix A3.2); 1 first. NaN from where the prediction variance is no longer positive.
///
/// ```
/// use undrift_noise::correlation::partial::durbin_levinson;
/// // An AR(1) with φ = 0.5 has one partial autocorrelation.
/// let partial = durbin_levinson(&[1.0, 0.5, 0.25, 0.125]);
/// assert_eq!(partial[..2], [1.0, 0.5]);
/// assert!(partial[2..].iter().all(|value| value.abs() < 1e-15));
/// ```
pub fn durbin_levinson(covariance: &[f64]) -> Vec<f64> {
    let mut partial = vec![1.0];
    let Some(&zeroth) = covariance.first() else {
        return partial;
    };
    let mut predictor = Predictor::new(zeroth);
    for _ in 1..covariance.len() {
        let reflection = predictor.reflection(covariance);
        predictor.extend(reflection);
        partial.push(reflection);
    }
    partial
}

/// Burg's reflections of a record less its mean; 1 first.
fn burg(x: &[f64], lags: usize) -> Result<Vec<f64>, RecordError> {
    let (mean, _) = check_varying(x, lags.saturating_add(1).max(2))?;
    let mut partial = vec![1.0];
    partial.extend(prediction::burg(x.iter().map(|v| v - mean).collect(), lags));
    Ok(partial)
}
