//! Writing results: the solution as CSV or MCAP, numbers with fixed decimals, files that appear whole.

mod fixed;
pub mod mcap;
mod pending;
pub mod solution;

pub use fixed::write_fixed;
pub use pending::PendingFile;
