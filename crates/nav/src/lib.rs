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
#![no_std]

#[cfg(test)]
extern crate std;

pub mod aiding;
pub mod attitude;
pub mod covariance;
pub mod earth;
pub mod filter;
pub mod mechanisation;
mod observation;
pub mod parameters;
pub mod preintegration;
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
