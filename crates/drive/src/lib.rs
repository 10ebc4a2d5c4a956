//! One drive or record: opened, inspected, identified, navigated, cut, smoothed.
//!
//! What `undrift` is made of below its front door and below the work on many drives. [`drive`] names files and columns,
//! [`replay`] merges samples and fixes through the navigator of `undrift-engine`, and [`mod@navigate`] or [`outages`] collect
//! what comes out; [`inspect`] describes log files, [`record`] and [`mod@identify`] read and identify static recordings.

pub mod columns;
pub mod consistency;
pub mod drive;
pub mod findings;
mod hand_eye;
pub mod identify;
pub mod inspect;
pub mod mounting;
pub mod navigate;
pub mod outages;
pub mod record;
pub mod reference;
mod rejected;
pub mod replay;
pub mod smooth;
pub mod temperature;

pub use undrift_engine::{self as engine, align, estimator, fixes, settings, vehicle};
pub use undrift_io as io;
pub use undrift_nav as nav;
pub use undrift_noise as noise;
pub use undrift_results::{self as results, Usability, series, usability};

pub use drive::Drive;
#[doc(inline)]
pub use findings::Finding;
pub use identify::Identified;
#[doc(inline)]
pub use navigate::navigate as navigate_drive;
pub use outages::{Logs, Schedule};
pub use record::Record;
pub use undrift_nav::Vector3;
pub use undrift_noise::{BiasModel, ImuModel};
