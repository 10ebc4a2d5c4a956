//! Make cheap inertial sensors trustworthy: simulate a drive, navigate a log with any noise model,
//! and measure how far the solution drifts when GNSS is cut.
//!
//! A log's way through this crate: [`drive`] names files and columns, [`align`] finds the first
//! attitude, [`replay`] merges samples and fixes through the filter of `undrift-nav`, and
//! [`navigate`] or [`outages`] collect what comes out. [`simulate`] makes logs with a known truth.

pub mod align;
pub mod columns;
pub mod consistency;
pub mod demo;
pub mod drive;
pub mod findings;
pub mod fleet;
mod hash;
pub mod identify;
pub mod inspect;
pub mod montecarlo;
pub mod mounting;
pub mod navigate;
pub mod outages;
pub mod record;
pub mod reference;
pub mod replay;
pub mod results;
pub mod series;
pub mod simulate;
pub mod size;
pub mod smooth;
pub mod vehicle;

pub use undrift_io as io;
pub use undrift_nav as nav;
pub use undrift_noise as noise;
