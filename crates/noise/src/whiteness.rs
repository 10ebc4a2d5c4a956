//! Is a series white? Portmanteau tests of its autocorrelations.
//!
//! They are blind to a slow bias far below the noise: at 100 000 samples of the source paper's case
//! no number of lags sees it (docs/theory.md, section 1).
//!
//! ```
//! use undrift_nav::shaping::ShapingFilter;
//! use undrift_noise::{synthesis::NoiseGenerator, whiteness::portmanteau};
//! let white: Vec<f64> = NoiseGenerator::new(&ShapingFilter::white(1e-3, 0.01)?, 1).take(2000).collect();
//! let averaged: Vec<f64> = white.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
//! assert!(portmanteau(&white, &[20], 0)?[0].ljung_box_p > 0.05);
//! assert!(portmanteau(&averaged, &[20], 0)?[0].ljung_box_p < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::correlation::autocorrelation;
use crate::screening::record::RecordError;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Ljung-Box and Box-Pierce tests of the autocorrelations up to one lag.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Portmanteau {
    /// Number of autocorrelations summed, from lag 1 on.
    pub lags: usize,
    /// Degrees of freedom: lags less the parameters fitted.
    #[serde(skip)]
    pub freedom: usize,
    /// Ljung & Box (Biometrika 65, 1978): n (n+2) Σ ρ_k² / (n − k).
    #[serde(rename = "statistic")]
    pub ljung_box: f64,
    /// Probability of a larger Ljung-Box statistic of a white series, by chi-squared; NaN without degrees of freedom.
    #[serde(rename = "p_value")]
    pub ljung_box_p: f64,
    /// Box & Pierce (J. American Statistical Association 65, 1970): n Σ ρ_k².
    #[serde(skip)]
    pub box_pierce: f64,
    /// Probability of a larger Box-Pierce statistic of a white series, by chi-squared; NaN without degrees of freedom.
    #[serde(skip)]
    pub box_pierce_p: f64,
}

/// The tests at each number of lags in `lags`, all from one set of autocorrelations. `fitted` is the
/// number of ARMA parameters (p + q) if `x` are a model's residuals, 0 for a record.
///
/// # Errors
/// As [`autocorrelation`] with the largest number of lags.
///
/// ```
/// use undrift_noise::whiteness::portmanteau;
/// // By hand: ρ_1 = −¾, so n Σρ² = 4 · 9/16 and n (n + 2) Σρ²/(n − k) = 24 · 9/16/3.
/// let test = portmanteau(&[1.0, -1.0, 1.0, -1.0], &[1], 0)?[0];
/// assert!((test.box_pierce - 2.25).abs() < 1e-12 && (test.ljung_box - 4.5).abs() < 1e-12);
/// // χ² with one degree of freedom exceeds 3.84 with 5 %.
/// assert!(test.box_pierce_p > 0.05 && test.ljung_box_p < 0.05);
/// # Ok::<(), undrift_noise::screening::RecordError>(())
/// ```
pub fn portmanteau(
    x: &[f64],
    lags: &[usize],
    fitted: usize,
) -> Result<Vec<Portmanteau>, RecordError> {
    let most = lags.iter().copied().max().unwrap_or(0);
    let correlation = autocorrelation(x, most)?;
    let count = x.len() as f64;
    let test = |&lags: &usize| {
        let (mut weighted, mut plain) = (0.0, 0.0);
        for (k, value) in correlation.iter().enumerate().take(lags + 1).skip(1) {
            weighted += value * value / (count - k as f64);
            plain += value * value;
        }
        let freedom = lags.saturating_sub(fitted);
        let (ljung_box, box_pierce) = (count * (count + 2.0) * weighted, count * plain);
        Portmanteau {
            lags,
            freedom,
            ljung_box,
            ljung_box_p: chi_squared_tail(ljung_box, freedom),
            box_pierce,
            box_pierce_p: chi_squared_tail(box_pierce, freedom),
        }
    };
    Ok(lags.iter().map(test).collect())
}

/// P(χ²_freedom > value).
fn chi_squared_tail(value: f64, freedom: usize) -> f64 {
    ChiSquared::new(freedom as f64).map_or(f64::NAN, |law| law.sf(value))
}
