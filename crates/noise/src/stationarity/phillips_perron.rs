//! Phillips-Perron tests (Biometrika 75, 1988; Hamilton, Time Series Analysis, 1994, section 17.6),
//! Z-tau and Z-rho as Python's arch computes them: residual variance with divisor n − k in the
//! standard error, n in γ₀, Bartlett weights. (R's urca differs by terms of order 1/n.)
//!
//! Of the regression `x_t = ρ x_{t−1} + deterministic + u_t` the t of ρ − 1 is corrected by the long-run
//! variance of u (Bartlett weights, Newey & West 1987) in place of lagged differences. With a moving-average
//! root near 1, as white noise over a walk has, it over-rejects even more than the augmented Dickey-Fuller test
//! (Schwert 1989).

use super::mackinnon::{critical_tau, p_tau};
use super::{Critical, Deterministic, long_run_variance, schwert};
use crate::screening::record::{RecordError, check_varying, dot, mean, sum_of};
use crate::screening::trend::linear;
use serde::{Deserialize, Serialize};

/// Result of the Phillips-Perron tests. Small (very negative) rejects the unit root.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PhillipsPerron {
    /// Z-tau: the t of ρ − 1, corrected for serial correlation.
    #[serde(rename = "statistic")]
    pub z_tau: f64,
    /// Probability of a smaller Z-tau under a unit root, by MacKinnon (1994).
    pub p_value: f64,
    /// Critical values of Z-tau by MacKinnon (2010).
    pub critical: Critical,
    /// Z-rho: n (ρ − 1), corrected for serial correlation.
    #[serde(skip)]
    pub z_rho: f64,
    /// Number of lags of the long-run variance.
    pub lags: usize,
    /// Number of rows of the regression, n.
    #[serde(skip)]
    pub observations: usize,
}

/// The tests on a record, with ⌈12 (n/100)^¼⌉ lags where `lags` is `None`. The null hypothesis is a unit root, as in [`super::adf()`]; serial
/// correlation is allowed for in the statistic in place of lagged differences in the regression.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{stationarity::{Deterministic, phillips_perron}, synthesis::NoiseGenerator};
/// let walk: Vec<f64> = NoiseGenerator::new(&ShapingFilter::random_walk(1e-3, 0.01)?, 1).take(5000).collect();
/// let test = phillips_perron(&walk, Deterministic::Constant, None)?;
/// assert!(test.z_tau > test.critical.five, "a unit root is not rejected");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Fewer than 6 samples or than lags, a sample that is not finite, a constant record or an exact line.
pub fn phillips_perron(
    x: &[f64],
    deterministic: Deterministic,
    lags: Option<usize>,
) -> Result<PhillipsPerron, RecordError> {
    check_varying(x, 6)?;
    let lags = lags.unwrap_or(schwert(x.len(), 12.0).ceil() as usize);
    let rows = x.len() - 1;
    if lags >= rows {
        return Err(RecordError::TooShort {
            needed: lags.saturating_add(2),
            got: x.len(),
        });
    }
    // Regress Δx on x_{t−1} less what the deterministic part explains of either.
    let level = residual_of(x[..rows].to_vec(), deterministic);
    let mut change = residual_of(x.windows(2).map(|w| w[1] - w[0]).collect(), deterministic);
    let level_level = dot(&level, &level);
    let total = sum_of(&change, |v| v * v);
    let largest = x.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let rounding = rows as f64 * (16.0 * f64::EPSILON * largest).powi(2);
    if level_level <= rounding || total <= rounding {
        return Err(RecordError::Constant);
    }
    let gamma = dot(&level, &change) / level_level;
    for (change, level) in change.iter_mut().zip(&level) {
        *change -= gamma * level;
    }
    let residuals = change;
    let count = rows as f64;
    let freedom = count - 1.0 - deterministic.columns() as f64;
    let squares = sum_of(&residuals, |r| r * r);
    let long_run = long_run_variance(&residuals, lags);
    let (variance, gamma0) = (squares / freedom, squares / count);
    if !(long_run > 0.0 && squares > rounding) {
        return Err(RecordError::Argument(
            "the regression is degenerate: the recording is a straight line or a repeating pattern",
        ));
    }
    let error = (variance / level_level).sqrt();
    let excess = long_run - gamma0;
    let z_tau = (gamma0 / long_run).sqrt() * gamma / error
        - 0.5 * excess / long_run.sqrt() * count * error / variance.sqrt();
    let z_rho = count * gamma - 0.5 * count * count * error * error / variance * excess;
    Ok(PhillipsPerron {
        z_tau,
        p_value: p_tau(z_tau, deterministic),
        critical: critical_tau(deterministic, rows),
        z_rho,
        lags,
        observations: rows,
    })
}

/// What a constant or a trend leaves of a column.
fn residual_of(mut column: Vec<f64>, deterministic: Deterministic) -> Vec<f64> {
    match deterministic {
        Deterministic::None => column,
        Deterministic::Constant => {
            let centre = mean(&column);
            column.iter_mut().for_each(|value| *value -= centre);
            column
        }
        Deterministic::Trend => linear(&column).residuals,
    }
}
