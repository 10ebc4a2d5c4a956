//! Partial autocorrelation.

use super::autocovariance;
use crate::screening::record::{RecordError, check_varying};
use crate::stationarity::dot;

/// How partial autocorrelations are estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Partial {
    /// Durbin-Levinson on autocovariances with divisor n: R's `pacf`, statsmodels' "ywmle" and
    /// "ldbiased". Never beyond ±1.
    YuleWalker,
    /// The same with divisor n − k at lag k: statsmodels' "ywadjusted". May leave ±1.
    YuleWalkerAdjusted,
    /// Burg's reflection coefficients of the record less its mean: statsmodels' "burg". O(N) a lag,
    /// and the one to trust near a unit root.
    Burg,
}

/// Partial autocorrelations at lags 1 … `lags` (element 0 is 1, as for the autocorrelation).
///
/// Errors: fewer than lags + 1 samples (2 at least), not finite, constant.
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
pub fn durbin_levinson(covariance: &[f64]) -> Vec<f64> {
    let mut partial = vec![1.0];
    let Some(&zeroth) = covariance.first() else {
        return partial;
    };
    let mut variance = zeroth;
    let mut phi: Vec<f64> = Vec::new();
    for lag in 1..covariance.len() {
        let predicted: f64 = phi
            .iter()
            .enumerate()
            .map(|(i, c)| c * covariance[lag - 1 - i])
            .sum();
        let reflection = if variance == 0.0 {
            f64::NAN
        } else {
            (covariance[lag] - predicted) / variance
        };
        let turned: Vec<f64> = phi.iter().rev().copied().collect();
        for (c, r) in phi.iter_mut().zip(&turned) {
            *c -= reflection * r;
        }
        phi.push(reflection);
        variance *= 1.0 - reflection * reflection;
        partial.push(reflection);
    }
    partial
}

/// Burg's method: the reflection that minimises forward and backward errors together at each lag.
fn burg(x: &[f64], lags: usize) -> Result<Vec<f64>, RecordError> {
    let (mean, _) = check_varying(x, lags.saturating_add(1).max(2))?;
    let mut forward: Vec<f64> = x.iter().map(|v| v - mean).collect();
    let mut backward = forward.clone();
    let mut partial = vec![1.0];
    for lag in 1..=lags {
        let (ahead, behind) = (&mut forward[lag..], &mut backward[lag - 1..x.len() - 1]);
        let (mut products, mut squares) = (0.0, 0.0);
        for (f, b) in ahead.chunks(1024).zip(behind.chunks(1024)) {
            products += dot(f, b);
            squares += dot(f, f) + dot(b, b);
        }
        let reflection = if squares > 0.0 {
            2.0 * products / squares
        } else {
            0.0
        };
        for (f, b) in ahead.iter_mut().zip(behind.iter_mut()) {
            (*f, *b) = (*f - reflection * *b, *b - reflection * *f);
        }
        // The backward error of sample t − 1 is that of sample t at the next lag.
        backward.copy_within(lag - 1..x.len() - 1, lag);
        partial.push(reflection);
    }
    Ok(partial)
}
