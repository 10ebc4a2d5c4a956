//! Readers of inertial, GNSS, scalar and reference logs, and the writer of the solution.
//!
//! Everything is streamed: memory does not grow with the length of a file. Bad records are
//! skipped and counted in [`skipped::Skipped`] with the first position of each kind; what makes
//! a file unusable is a [`ReadError`] that names the file, the line and the mend.
//!
//! Numbers leave this crate in the units and frames of `undrift-nav`: SI and radians,
//! north-east-down and forward-right-down; whatever a file has is scaled and rotated on reading.

pub mod angle;
pub mod axis_faults;
pub mod epoch;
pub mod foreign;
pub mod format;
pub mod gaps;
pub mod gnss;
pub mod held;
pub mod imu;
pub mod layouts;
pub mod log;
pub mod magnetic;
pub mod nearby;
pub mod number;
pub mod poses;
pub mod reader;
pub mod recording;
pub mod scalar;
pub mod skipped;
pub mod source;
pub mod table;
pub mod truth;
pub mod utm;
pub mod write;

mod carrier;
mod clock;
mod detect;
mod entry;
mod error;
mod fix;
mod mcap_records;
mod opened;
mod rinex;
mod rotation;
mod time;
mod visible;
mod zstandard;

pub use error::{Key, ReadError};
pub use opened::{Memory, Opened};
pub use visible::{is_hidden, visible};
