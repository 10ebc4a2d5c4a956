//! Noise models of inertial sensors: the model file and its presets, the shaping filters they make,
//! and synthesis of such noise.
//!
//! [`model_file`] reads and writes `IMU.toml`; [`bias_model`] turns an axis of it into the
//! [`undrift_nav::shaping::ShapingFilter`] that the navigation filter takes; [`presets`] are model
//! files of well-known sensors; [`export`] writes a model as others read it; [`synthesis`] draws noise from any shaping filter.

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
