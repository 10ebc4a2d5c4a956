//! Is a record stationary? Augmented Dickey-Fuller and Phillips-Perron ask for a unit root, KPSS for
//! its absence; [`verdict()`] weighs the three.
//!
//! Conventions: docs/theory.md, section 1. Statistics follow Python's statsmodels (ADF, KPSS) and arch
//! (Phillips-Perron), whose variants are named at each function; critical values and p of the
//! unit-root tests are MacKinnon's (1994, 2010), of KPSS those of Kwiatkowski et al. (1992).
//! Each test is O(N) a lag, whatever the record's length.
//!
//! ```
//! use undrift_nav::shaping::ShapingFilter;
//! use undrift_noise::stationarity::{Conclusion, Deterministic, KpssLags, Lags, adf, kpss, phillips_perron, verdict};
//! use undrift_noise::{screening::RecordError, synthesis::NoiseGenerator};
//! let conclusion = |x: &[f64]| {
//!     let unit_root = adf(x, Deterministic::Constant, Lags::Aic(None))?;
//!     let level = kpss(x, Deterministic::Constant, KpssLags::Short)?;
//!     let corrected = phillips_perron(x, Deterministic::Constant, None)?;
//!     Ok::<_, RecordError>(verdict(&unit_root, &level, &corrected, None).conclusion)
//! };
//! let white: Vec<f64> = NoiseGenerator::new(&ShapingFilter::white(1e-3, 0.01)?, 1).take(2000).collect();
//! let walk: Vec<f64> = white.iter().scan(0.0, |sum, x| { *sum += x; Some(*sum) }).collect();
//! assert_eq!(conclusion(&white)?, Conclusion::Stationary);
//! assert_eq!(conclusion(&walk)?, Conclusion::UnitRoot);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! White noise far above a slow bias makes ADF and Phillips-Perron reject a unit root that is there (an ARMA(1,1) with θ near
//! 1); [`verdict()`] takes θ to say so.

pub mod adf;
pub mod kpss;
pub mod mackinnon;
pub mod phillips_perron;
pub mod verdict;

use crate::correlation::lagged_products;
use serde::{Deserialize, Serialize};

pub(crate) use adf::adf_by_rules;
pub use adf::{Adf, Lags, adf};
pub use kpss::{Kpss, KpssLags, kpss};
pub use phillips_perron::{PhillipsPerron, phillips_perron};
pub use verdict::{Conclusion, Verdict, Weighed, verdict};

/// Deterministic part of a test regression, beside the lags.
///
/// For a gyro at rest [`Deterministic::Constant`] is right. A trend is for records that warm up, and costs
/// power: the critical values are farther out (−3.41 in place of −2.86 at 5 %).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Deterministic {
    /// Nothing: the mean is known to be 0.
    None,
    /// A constant.
    Constant,
    /// A constant and a linear trend.
    Trend,
}

impl Deterministic {
    /// Columns that it adds to a regression.
    pub(crate) fn columns(self) -> usize {
        match self {
            Self::None => 0,
            Self::Constant => 1,
            Self::Trend => 2,
        }
    }
}

/// Critical values of a test statistic at three levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Critical {
    /// Critical value at 1 %.
    #[serde(rename = "1%")]
    pub one: f64,
    /// Critical value at 5 %.
    #[serde(rename = "5%")]
    pub five: f64,
    /// Critical value at 10 %.
    #[serde(rename = "10%")]
    pub ten: f64,
}

/// Schwert's lag `factor · (n/100)^¼` (J. Business & Economic Statistics 7, 1989), not rounded.
pub(crate) fn schwert(samples: usize, factor: f64) -> f64 {
    factor * (samples as f64 / 100.0).powf(0.25)
}

/// Bartlett-weighted long-run variance `γ₀ + 2 Σ (1 − l/(L+1)) γ_l` of residuals \[unit²\], γ about 0
/// with divisor n (Newey & West, Econometrica 55, 1987).
pub(crate) fn long_run_variance(residuals: &[f64], lags: usize) -> f64 {
    let products = lagged_products(residuals, 0.0, lags.min(residuals.len().saturating_sub(1)));
    let mut sum = products[0];
    for (lag, product) in products.iter().enumerate().skip(1) {
        sum += 2.0 * (1.0 - lag as f64 / (lags as f64 + 1.0)) * product;
    }
    sum / residuals.len() as f64
}
