//! Writing results: the solution as CSV, numbers with fixed decimals, files that appear whole.

mod fixed;
mod pending;
pub mod solution;

pub use fixed::write_fixed;
pub use pending::PendingFile;
