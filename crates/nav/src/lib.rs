//! Strapdown inertial navigation and an error-state Kalman filter whose sensor errors are
//! shaping filters of any order. `no_std`, no allocation, no `unsafe`.
//!
//! A sample's way through this crate: an [`sample::ImuSample`] is corrected by the filter's
//! predicted sensor error, integrated by [`mechanisation`], and its error covariance is carried
//! along by [`covariance`]; [`aiding`] turns a GNSS fix into an innovation; [`filter`] holds
//! them together.
//!
//! Frames, letters, units and signs: `docs/conventions.md`. SI units and radians everywhere,
//! navigation frame `n` north-east-down, body frame `b` forward-right-down, attitude `q_nb`
//! (rotates body to navigation).
//!
//! Where to begin: [`filter::Filter`] has an example of a whole run, [`shaping`] of the noise models it is made
//! with, [`aiding`] of measurements. Without a filter, dead reckoning is a state and its steps:
//!
//! ```
//! use undrift_nav::{Vector3, attitude, earth::Geodetic, mechanisation::{Increments, NavState}, sample::ImuSample};
//! let mut state = NavState {
//!     time: 0.0,
//!     position: Geodetic::from_degrees(47.0, 8.0, 400.0),
//!     v_n: Vector3::new(0.0, 10.0, 0.0), // [m/s], north, east, down
//!     q_nb: attitude::from_rpy(&Vector3::new(0.0, 0.0, 90f64.to_radians())), // Forward is east.
//! };
//! let start = state.position;
//! for k in 1..=100 {
//!     let sample = ImuSample::from_rates(0.01 * f64::from(k), 0.01, [0.0; 3], [0.0, 0.0, -9.807]);
//!     state.step(&Increments::from_raw(sample.dt, sample.dtheta, sample.dvel, None));
//! }
//! assert!((start.offset_to(&state.position) - Vector3::new(0.0, 10.0, 0.0)).norm() < 0.01); // A second later [m].
//! ```
#![no_std]

#[cfg(test)]
extern crate std;

pub mod aiding;
pub mod attitude;
pub mod covariance;
pub mod earth;
pub mod filter;
pub mod magnetic;
pub mod mechanisation;
mod observation;
pub mod parameters;
pub mod preintegration;
pub mod repeats;
pub mod sample;
pub mod shaping;
pub mod tape;
pub mod units;

/// Three-vector in double precision.
pub type Vector3 = nalgebra::Vector3<f64>;
/// Three-by-three matrix in double precision.
pub type Matrix3 = nalgebra::Matrix3<f64>;
/// Unit quaternion in double precision.
pub type Quaternion = nalgebra::UnitQuaternion<f64>;
