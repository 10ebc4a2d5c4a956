//! Noise models of inertial sensors: the model file and its presets, the shaping filters they make,
//! and synthesis of such noise.
//!
//! [`model_file`] reads and writes `IMU.toml`; [`bias_model`] turns an axis of it into the
//! [`undrift_nav::shaping::ShapingFilter`] that the navigation filter takes; [`presets`] are model
//! files of well-known sensors; [`synthesis`] draws noise from any shaping filter.

pub mod bias_model;
pub mod model_file;
pub mod presets;
pub mod synthesis;

pub use bias_model::BiasModel;
pub use model_file::{Arma, AxisModel, ImuModel, Instability, ModelError, Provenance};
