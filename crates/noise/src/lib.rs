//! Noise models of inertial sensors: the model file and its presets, the shaping filters they make,
//! and synthesis of such noise.
//!
//! [`model_file`] reads and writes `IMU.toml`; [`bias_model`] turns an axis of it into the
//! [`undrift_nav::shaping::ShapingFilter`] that the navigation filter takes; [`presets`] are model
//! files of well-known sensors; [`export`] writes a model as others read it; [`synthesis`] draws noise from any shaping filter.
//!
//! Statistics take a record as a slice at a constant rate, in rad/s of a gyro axis or m/s² of an accelerometer axis, and
//! results have that unit ("unit" in the documentation of the modules). Where NaN may mark a missing sample, the function
//! says so; the others return an error on it.
//!
//! | question | answer |
//! |---|---|
//! | can the record be used: outliers, motion, gaps, saturation | [`screening`] |
//! | white noise, bias instability, random walk of a data sheet | [`allan`] |
//! | is it stationary, normal, white | [`stationarity`], [`normality`], [`whiteness`] |
//! | lines and resonances | [`spectrum`] |
//! | which ARMA | [`arma`], [`pandit_wu`] |
//! | which sum of independent processes | [`composite`], [`wavelet`] |
//! | how the bias follows the temperature | [`temperature`] |
//! | which model drifts least | [`drift_score`] |
//! | all of these for one axis | [`mod@identify`] |
//!
//! From the numbers of a data sheet to the filter that the navigator takes:
//!
//! ```
//! use undrift_noise::{AxisModel, BiasModel, GaussMarkov};
//! let gyro = AxisModel {
//!     white: Some(0.2_f64.to_radians() / 60.0), // Angle random walk of 0.2 deg/√h [rad/√s].
//!     instability: vec![GaussMarkov { sigma: 2e-5, tau_s: 300.0 }], // Standard deviation [rad/s], time [s].
//!     ..AxisModel::default()
//! };
//! let filter = gyro.shaping(BiasModel::GaussMarkov, 0.01)?; // At 100 Hz.
//! assert_eq!(filter.order, 1); // One state: the process; without a turn-on there is no constant.
//! # Ok::<(), undrift_noise::ModelError>(())
//! ```

pub mod allan;
pub mod arma;
pub mod bias_model;
pub mod compared;
pub mod composite;
pub mod correlation;
pub mod drift_score;
pub mod export;
pub mod identify;
pub mod model_file;
pub mod normality;
pub mod pandit_wu;
mod prediction;
pub mod presets;
mod quasi_newton;
pub mod scales;
pub mod screening;
pub mod spectrum;
pub mod stationarity;
mod steady;
pub mod synthesis;
pub mod temperature;
mod terms;
mod transform;
mod vector;
pub mod wavelet;
pub mod whiteness;

pub use bias_model::BiasModel;
pub use composite::GaussMarkov;
pub use export::ModelFormat;
pub use model_file::{Arma, AxisModel, ImuModel, ModelError, Provenance, Recording};
pub use undrift_base::interrupt;
