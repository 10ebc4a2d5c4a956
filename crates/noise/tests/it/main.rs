//! Statistics and identification against reference values, simulated truth and public records.

mod allan;
mod allan_fit;
mod arma_coverage;
mod arma_fit;
mod arma_likelihood;
mod arma_optima;
mod arma_pandit_wu;
mod arma_profile;
mod arma_real;
mod bias_models;
mod common;
mod compared;
mod composite;
mod correlation;
mod drift_score;
mod export;
mod identify;
mod lines;
mod model_file;
mod model_file_properties;
mod normality;
mod packages;
mod pool;
mod presets;
mod properties;
#[path = "../../../../tools/public_data.rs"]
mod public;
mod screening;
mod spectrum;
mod stationarity;
mod synthesis;
mod temperature;
