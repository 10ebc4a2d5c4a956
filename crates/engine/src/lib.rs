//! The navigator: samples and measurements are pushed in, a solution comes out.
//!
//! A sample's way: [`Navigator::imu`] keeps it until the next one shows that it can be right (`inertial`), carries the
//! solution over it ([`estimator`]), and stops on the way at each measurement that falls due (`measurement`): a fix is
//! judged by `receiver`, any other is used in its module of `aid`, and what the vehicle cannot do when `constraints` says so. Before
//! there is a solution both go to the alignment ([`align`]). The watches (for faults of sensors, fixes, heading) change the filter
//! through [`estimator::Estimator`] alone: they inflate its covariance or re-initialise it. What happened is in [`Summary`].
//!
//! Measurements may come late, up to a horizon ([`Navigator::with_horizon`]): the solution is always that of the
//! measurements in order of their own time. No file, no clock, no thread; nothing grows with the length of a drive.
//!
//! SI units and radians. Samples are increments in body axes `b`, forward, right, down; the solution is latitude, longitude and
//! ellipsoidal height of the IMU on WGS-84, velocity north-east-down `v_n`, and `q_nb`, which turns body axes to north-east-down:
//! `v_n = q_nb * v_b`. Errors are estimate less truth, innovations predicted less measured (docs/conventions.md).
//!
//! | wanted | where |
//! |---|---|
//! | what is configured, with defaults | [`settings::Settings`], [`vehicle::Profile`] |
//! | what is pushed | [`Navigator::imu`], [`Navigator::measure`], [`Measurement`] |
//! | the solution and its standard deviations | [`Navigator::filter`], [`estimator::Estimator`] |
//! | what went wrong, as it happens | [`Navigator::events`], [`Event`] |
//! | how well solution and fixes agree | [`Summary`], [`Windows`] |
//!
//! ```
//! use undrift_engine::{Navigator, settings::Settings};
//! use undrift_nav::shaping::ShapingFilter;
//! use undrift_simulate::{GnssNoise, Trajectory, simulate};
//!
//! let white = |density| ShapingFilter::white(density, 0.01);
//! let (gyro, accel) = (white(1e-4)?, white(1e-3)?);
//! let sensors = [gyro, gyro, gyro, accel, accel, accel];
//! let log = simulate(&Trajectory::car(120.0, 1), 100.0, Some(&sensors), &GnssNoise::default(), 1)?;
//!
//! let mut navigator = Navigator::new(Settings::new(sensors));
//! let mut fixes = log.gnss.iter().peekable();
//! for sample in &log.imu {
//!     while let Some(fix) = fixes.next_if(|fix| fix.time <= sample.time) {
//!         navigator.fix(*fix)?;
//!     }
//!     navigator.imu(*sample)?;
//! }
//! let filter = navigator.filter().expect("aligned");
//! assert!(filter.nav_std()[0] < 5.0, "north, one standard deviation [m]");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![no_std]

extern crate alloc;
#[cfg(test)]
extern crate std;

mod aid;
pub mod align;
mod bridge;
mod checked;
#[cfg(feature = "checkpoint")]
mod checkpoint;
mod consensus;
mod constraints;
mod course;
pub mod derived;
pub mod estimator;
pub mod fixes;
mod forward;
mod gate;
mod heading;
mod health;
mod inertial;
#[cfg(feature = "checkpoint")]
mod kept;
mod magnetometer;
mod measurement;
mod median;
pub mod mounting;
mod navigator;
mod not_aligned;
mod observer;
mod plausible;
mod readings;
mod receiver;
mod rest;
mod rocking;
mod run;
pub mod settings;
mod solution;
mod summary;
#[cfg(test)]
mod tests;
pub mod vehicle;
mod vertical;
pub mod vibration;
mod watch;

pub use aid::{ByAid, Measurement};
#[cfg(feature = "checkpoint")]
pub use checkpoint::RestoreError;
pub use health::covariance_health;
pub use measurement::Scalar;
pub use navigator::{EndError, Navigator, PushError};
pub use not_aligned::NotAligned;
pub use observer::Observer;
pub use summary::{LateSamples, MOST_EVENTS, SideSlip, Summary};
pub use undrift_events::{
    Agreement, Aid, Contradiction, CovarianceHealth, Disagreement, DisturbedField, Event, FixMend,
    HeadingOff, Implausible, Innovations, Lean, Log, Mismatch, Part, RejectedHeadings, Restart,
    RestartCause, SampleFault, ScalarLog, Window, WindowPart, Windows,
};
