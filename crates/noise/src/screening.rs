//! Screening of a record before anything is identified from it: trends, stamps, outliers, motion,
//! saturation, steps and warm-ups.
//!
//! Nothing is repaired silently: each function returns what it found, with positions, beside the
//! cleaned series, in which a missing sample is NaN.
//!
//! ```
//! use undrift_noise::screening::{OutlierRule, outliers};
//! let mut x: Vec<f64> = (0..500).map(|k| f64::from(k * 7919 % 101)).collect();
//! x[250] = 1e4;
//! let found = outliers(&x, OutlierRule::default())?;
//! assert_eq!(found.outliers[0].index, 250);
//! assert!(found.cleaned[250].is_nan());
//! # Ok::<(), undrift_noise::screening::RecordError>(())
//! ```

pub(crate) mod bridge;
pub mod dead_band;
pub mod motion;
pub mod outlier;
pub mod record;
pub mod rounding;
pub mod saturation;
mod tail;
pub mod timing;
pub mod trend;
pub mod wander;

pub use dead_band::{DeadBand, dead_band};
pub use motion::{Hanging, Motion, MotionRule, constant_runs, motion};
pub use outlier::{Outlier, OutlierRule, Outliers, outliers};
pub use record::RecordError;
pub use saturation::{Saturation, saturation};
pub use timing::{Gap, Timing, timing};
pub use trend::{Detrended, Trend, remove_constant, remove_linear, remove_temperature};
pub use wander::{Disturbance, Shape, disturbances};
