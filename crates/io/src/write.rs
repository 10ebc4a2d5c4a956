//! Writing results: the solution as CSV and in the formats of others, numbers with fixed decimals,
//! files that appear whole.

mod csv;
mod ellipses;
mod file;
mod fixed;
mod frame;
mod geojson;
mod gpx;
mod json_lines;
mod kf_gins;
mod kml;
mod mavlink;
pub mod mcap;
mod nmea;
#[cfg(feature = "parquet")]
mod parquet;
#[cfg(feature = "parquet")]
pub mod parquet_table;
mod pending;
pub mod recording;
mod sbet;
pub mod solution;
mod spans;
mod text;
mod text_writer;
mod thinning;
mod tum;

pub use file::{SolutionFile, SolutionFormat, SolutionOptions, UnknownSolutionFormat};
pub use fixed::write_fixed;
pub use frame::PoseFrame;
pub use pending::{PendingFile, remove_unfinished, write_whole};
pub use text_writer::TextWriter;
pub use thinning::Thinning;
