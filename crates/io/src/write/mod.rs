//! Writing results: the solution as CSV, MCAP or Parquet, numbers with fixed decimals, files that appear whole.

mod fixed;
pub mod mcap;
#[cfg(feature = "parquet")]
pub mod parquet;
mod pending;
pub mod solution;

pub use fixed::write_fixed;
pub use pending::PendingFile;
