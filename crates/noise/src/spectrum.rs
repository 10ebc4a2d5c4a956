//! Power spectral density by Welch's method, and the narrow lines in it.
//!
//! ```
//! use undrift_noise::spectrum;
//! let x: Vec<f64> = (0..4096).map(|k| (0.2 * f64::from(k)).sin() + f64::from(k * 7919 % 101) / 101.0).collect();
//! let density = spectrum::welch(&x, 100.0, 1024)?;
//! let lines = spectrum::lines(&density, 20.0);
//! assert!((lines[0].frequency_hz - 0.2 * 100.0 / std::f64::consts::TAU).abs() < 0.02);
//! # Ok::<(), undrift_noise::screening::RecordError>(())
//! ```

pub mod lines;
pub mod welch;

pub use lines::{Line, lines};
pub use welch::{Density, default_segment, welch};
