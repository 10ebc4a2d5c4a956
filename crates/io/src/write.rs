//! Writing results: the solution as CSV and in the formats of others, numbers with fixed decimals,
//! files that appear whole.

mod block;
mod file;
mod fixed;
mod geojson;
mod gpx;
mod kf_gins;
mod kml;
pub mod mcap;
mod nmea;
#[cfg(feature = "parquet")]
pub mod parquet;
#[cfg(feature = "parquet")]
pub mod parquet_table;
mod pending;
pub mod solution;
mod spans;
mod text;
mod thinning;

pub use file::{SolutionFile, SolutionFormat, SolutionOptions, UnknownSolutionFormat};
pub use fixed::write_fixed;
pub use geojson::GeoJsonWriter;
pub use gpx::GpxWriter;
pub use kf_gins::KfGinsWriter;
pub use kml::KmlWriter;
pub use nmea::NmeaWriter;
pub use pending::{PendingFile, write_whole};
