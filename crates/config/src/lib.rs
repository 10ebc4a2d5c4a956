//! Tables of TOML files that people write: keys with their line, quantities with their unit, errors that name file, line, key and
//! remedy. Drive files, fleets, specifications of simulations and model files are read by it; it knows the keys of none of them.

mod error;
mod quantities;
mod section;
mod takes;
mod text;
mod value;

pub use error::ConfigError;
pub use section::Section;
pub use takes::Takes;
pub use text::{is_log, parse};
pub use value::{Table, Value};
