//! KPSS test of stationarity (Kwiatkowski, Phillips, Schmidt & Shin, J. Econometrics 54, 1992), as
//! Python's statsmodels and R's urca do it.

use super::{Critical, Deterministic, long_run_variance, schwert};
use crate::correlation::lagged_products;
use crate::screening::record::{Compensated, RecordError, check_varying, sum_of};
use crate::screening::trend::linear;
use serde::{Deserialize, Serialize};

/// Number of lags of the long-run variance, by the rules of other software.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KpssLags {
    /// This number.
    Fixed(usize),
    /// ⌊4 (n/100)^¼⌋: "short" in R's urca and tseries.
    Short,
    /// ⌊12 (n/100)^¼⌋: "long" in R's urca.
    Long,
    /// ⌈12 (n/100)^¼⌉: "legacy" in statsmodels.
    Legacy,
    /// By the data (Hobijn, Franses & Ooms, Statistica Neerlandica 58, 2004): "auto" in statsmodels.
    Auto,
}

/// Result of the KPSS test. Large rejects stationarity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Kpss {
    /// η = Σ S_t² / (n² s²(L)).
    pub statistic: f64,
    /// Probability of a larger statistic of a stationary record, interpolated in the authors' table 1; 0.01 and 0.1 stand for what lies
    /// beyond it.
    pub p_value: f64,
    /// Whether `p_value` is only a bound, from an end of the table.
    pub p_is_bound: bool,
    /// Number of lags of the long-run variance.
    pub lags: usize,
    /// Critical values at 1, 5 and 10 %.
    pub critical: Critical,
}

/// The test about a level ([`Deterministic::Constant`]) or a trend ([`Deterministic::Trend`]). The null hypothesis is that the
/// record is stationary about it: reject at 5 % where `statistic` is above `critical.five`. With few lags correlated noise is
/// rejected too often; with many, a slow part is missed.
///
/// # Errors
/// Fewer than 4 samples, a sample that is not finite, a constant record (or an exact line), or
/// [`Deterministic::None`], which the test has no form for.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{stationarity::{Deterministic, KpssLags, kpss}, synthesis::NoiseGenerator};
/// let walk: Vec<f64> = NoiseGenerator::new(&ShapingFilter::random_walk(1e-3, 0.01)?, 1).take(5000).collect();
/// let test = kpss(&walk, Deterministic::Constant, KpssLags::Long)?;
/// assert!(test.statistic > test.critical.one && test.p_is_bound);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn kpss(x: &[f64], deterministic: Deterministic, lags: KpssLags) -> Result<Kpss, RecordError> {
    let (mean, _) = check_varying(x, 4)?;
    let count = x.len() as f64;
    // Critical values by falling p: 10, 5, 2.5, 1 %.
    let (residuals, table) = match deterministic {
        Deterministic::None => {
            return Err(RecordError::Argument("KPSS needs a constant or a trend"));
        }
        Deterministic::Constant => (
            x.iter().map(|value| value - mean).collect(),
            [0.347, 0.463, 0.574, 0.739],
        ),
        Deterministic::Trend => (linear(x).residuals, [0.119, 0.146, 0.176, 0.216]),
    };
    let largest = x.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    if sum_of(&residuals, |r| r * r) <= count * (16.0 * f64::EPSILON * largest).powi(2) {
        return Err(RecordError::Constant);
    }
    let lags = match lags {
        KpssLags::Fixed(lags) => lags,
        KpssLags::Short => schwert(x.len(), 4.0) as usize,
        KpssLags::Long => schwert(x.len(), 12.0) as usize,
        KpssLags::Legacy => schwert(x.len(), 12.0).ceil() as usize,
        KpssLags::Auto => automatic(&residuals),
    };
    let lags = lags.min(x.len() - 1);
    let (mut sum, mut squares) = (Compensated::default(), Compensated::default());
    for &residual in &residuals {
        sum.add(residual);
        squares.add(sum.value() * sum.value());
    }
    let statistic = squares.value() / (count * count * long_run_variance(&residuals, lags));
    let (p_value, p_is_bound) = interpolate(statistic, table);
    let critical = Critical {
        one: table[3],
        five: table[1],
        ten: table[0],
    };
    Ok(Kpss {
        statistic,
        p_value,
        p_is_bound,
        lags,
        critical,
    })
}

/// p by linear interpolation between 10, 5, 2.5 and 1 %.
fn interpolate(statistic: f64, table: [f64; 4]) -> (f64, bool) {
    const P: [f64; 4] = [0.10, 0.05, 0.025, 0.01];
    if statistic.is_nan() {
        return (f64::NAN, true);
    }
    for k in 0..3 {
        if statistic >= table[k] && statistic < table[k + 1] {
            let share = (statistic - table[k]) / (table[k + 1] - table[k]);
            return (P[k] + share * (P[k + 1] - P[k]), false);
        }
    }
    (if statistic < table[0] { P[0] } else { P[3] }, true)
}

/// `⌊1.1447 (s₁/s₀)^⅔ n^⅓⌋` with sums over ⌊n^{2/9}⌋ autocovariances.
fn automatic(residuals: &[f64]) -> usize {
    let count = residuals.len() as f64;
    let covariances = count.powf(2.0 / 9.0) as usize;
    let products = lagged_products(residuals, 0.0, covariances);
    let (mut zeroth, mut first) = (products[0], 0.0);
    for (lag, product) in products.iter().enumerate().skip(1) {
        zeroth += 2.0 * product;
        first += 2.0 * lag as f64 * product;
    }
    let ratio = first / zeroth;
    let lags = 1.1447 * (ratio * ratio).cbrt() * count.cbrt();
    if lags.is_finite() { lags as usize } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_all_lags_the_statistic_is_one_half_of_any_record() {
        // Kiefer & Vogelsang, Econometrica 70, 2002: Bartlett's weights of all lags make s² = 2 Σ S_t²/n².
        let x: Vec<f64> = (0..50).map(|k| f64::from(k * k).sin()).collect();
        for kind in [Deterministic::Constant, Deterministic::Trend] {
            for lags in [49, 50, 51, 1000, usize::MAX] {
                let found = kpss(&x, kind, KpssLags::Fixed(lags)).unwrap();
                assert_eq!(found.lags, 49, "{lags}");
                assert!((found.statistic - 0.5).abs() < 1e-12, "{found:?}");
            }
        }
    }
}
