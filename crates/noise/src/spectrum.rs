//! Power spectral density by Welch's method and its peaks; lines and narrow resonances of a record.
//!
//! ```
//! use undrift_noise::spectrum;
//! let x: Vec<f64> = (0..4096).map(|k| (0.2 * f64::from(k)).sin() + f64::from(k * 7919 % 101) / 101.0).collect();
//! let density = spectrum::welch(&x, 100.0, 1024)?;
//! let peaks = spectrum::peaks(&density, 20.0);
//! assert!((peaks[0].frequency_hz - 0.2 * 100.0 / std::f64::consts::TAU).abs() < 0.02);
//! # Ok::<(), undrift_noise::screening::RecordError>(())
//! ```

pub mod lines;
pub mod peaks;
pub mod welch;

pub use lines::{Line, remove_lines};
pub use peaks::{Peak, peaks};
pub use welch::{Density, default_segment, welch};
