//! Make cheap inertial sensors trustworthy: simulate a drive, navigate a log with any noise model,
//! and measure how far the solution drifts when GNSS is cut.
//!
//! A log's way through this crate: [`drive`] names files and columns, [`align`] finds the first
//! attitude, [`replay`] merges samples and fixes through the filter of `undrift-nav`, and
//! [`mod@navigate`] or [`outages`] collect what comes out. [`mod@simulate`] makes logs with a known truth.
//!
//! A first program:
//!
//! ```no_run
//! use undrift::{BiasModel, Drive, navigate, navigate::Wanted};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let drive = Drive::load("drive.toml".as_ref(), None)?;
//! let report = navigate(&drive, BiasModel::Arma, Wanted::default())?;
//! println!("{} fixes used", report.summary.fixes);
//! # Ok(())
//! # }
//! ```
//!
//! `examples/` has three of some fifty lines: `navigate`, `outages` and `identify`.

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
pub mod smooth;
mod temperature;
pub mod tune;

pub use undrift_engine::{self as engine, align, estimator, fixes, settings, vehicle};
pub use undrift_io as io;
pub use undrift_nav as nav;
pub use undrift_noise as noise;

pub use drive::Drive;
pub use identify::Identified;
pub use navigate::navigate;
pub use outages::{Logs, Schedule};
pub use record::Record;
pub use simulate::{Trajectory, simulate};
pub use undrift_noise::{BiasModel, ImuModel};
