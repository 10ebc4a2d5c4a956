//! A vehicle, its sensors and its GNSS receiver, with the truth beside them, and the files of such a log.
//!
//! ```
//! use undrift::simulate::{GnssNoise, Trajectory, simulate};
//! let drive = Trajectory::car(120.0, 1);
//! let log = simulate(&drive, 100.0, None, &GnssNoise::default(), 1)?;
//! assert_eq!((log.imu.len(), log.truth.len(), log.gnss.len()), (12_000, 12_001, 120));
//! # Ok::<(), undrift::simulate::SimulationError>(())
//! ```

pub use undrift_experiments::{SimulatedLog, simulated_log as files};
pub use undrift_simulate::*;
