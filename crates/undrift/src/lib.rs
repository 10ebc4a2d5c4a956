//! Make cheap inertial sensors trustworthy: identify their noise, navigate with GNSS, and measure how far the solution
//! drifts when GNSS is cut.
//!
//! From nothing to a navigated drive: samples and fixes as slices, a noise model, what is known of the vehicle. SI units and
//! radians; body axes are forward, right, down, the ground's north, east, down.
//!
//! ```
//! use undrift::{GnssFix, Geodetic, ImuModel, ImuSample, Setup, Vector3, navigate, vehicle::Profile};
//! # use undrift::{BiasModel, Trajectory, simulate, simulate::GnssNoise};
//! # let model = ImuModel::preset("adis16465").ok_or("no such preset")?;
//! # let log = simulate(&Trajectory::car(150.0, 1), 50.0, Some(&model.shaping(BiasModel::Arma, 0.02)?), &GnssNoise::default(), 1)?;
//! # struct Row { time: f64, gyro: [f64; 3], accel: [f64; 3] }
//! # let my_imu = log.imu.iter().map(|s| Row { time: s.time, gyro: (s.dtheta / s.dt).into(), accel: (s.dvel / s.dt).into() });
//! # struct Place { time: f64, lat_deg: f64, lon_deg: f64, height: f64 }
//! # let my_gnss = log.gnss.iter().map(|f| {
//! #     let Some((undrift::nav::sample::Position::Geodetic(p), _)) = f.position else { unreachable!() };
//! #     Place { time: f.time, lat_deg: p.lat.to_degrees(), lon_deg: p.lon.to_degrees(), height: p.height }
//! # });
//!
//! // Rates [rad/s] and specific forces [m/s²] over the 0.02 s up to each time [s].
//! let imu: Vec<ImuSample> =
//!     my_imu.map(|row| ImuSample::from_rates(row.time, 0.02, row.gyro, row.accel)).collect();
//! // Positions of the antenna with standard deviations [m].
//! let fixes: Vec<GnssFix> = my_gnss
//!     .map(|row| {
//!         let place = Geodetic::from_degrees(row.lat_deg, row.lon_deg, row.height);
//!         GnssFix::at(row.time, place, [1.5, 1.5, 3.0])
//!     })
//!     .collect();
//!
//! // A preset, a file (`ImuModel::load`), the numbers of a data sheet (`ImuModel::new`), or your own recording (`identify`).
//! let model = ImuModel::preset("adis16465").ok_or("no such preset")?;
//! let setup = Setup {
//!     lever_arm: Some(Vector3::new(0.3, 0.0, -1.2)), // From the IMU to the antenna [m].
//!     vehicle: Profile::Car,
//!     ..Setup::default()
//! };
//! let done = navigate(&imu, &fixes, &model, &setup)?;
//! println!("{}", done.verdict); // "usable", "usable with care", "not usable"
//! for finding in &done.findings {
//!     println!("{finding:?}"); // wrong units, axes, signs, clocks; gaps; outliers; …
//! }
//! for row in done.solution.iter().step_by(50) {
//!     println!("{:.2} s: {:?}, yaw {:.3} rad", row.time, row.position, row.rpy.z);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | wanted | way |
//! |---|---|
//! | the noise model of a sensor, from a recording at rest | [`identify`](fn@identify); of one axis, the others NaN |
//! | a solution, from slices | [`navigate`](fn@navigate) |
//! | the same in real time, sample by sample | [`Setup::navigator`]; to go on in another process [`Navigator::checkpoint`] |
//! | a solution, from files | [`Drive::load`], [`navigate_drive`] |
//! | all settings of a drive, in code | [`Drive::from_samples`] |
//! | how far it drifts without GNSS | [`outages::Logs`] |
//! | the noise of a sensor in its vehicle | [`tune::tune`] |
//! | the filter alone, `no_std` | [`nav::filter::Filter`] |
//! | a simulated drive | [`simulate()`] |
//!
//! `examples/` has a short program for each of the first three (`identify_record`, `navigate_slices`, `real_time`), and
//! longer ones on files (`identify`, `navigate`, `outages`).
//!
//! A log's way through the house: [`drive`] names files and columns, [`align`] finds the first
//! attitude, [`replay`] merges samples and fixes through the navigator of `undrift-engine`, and
//! [`mod@navigate`] or [`outages`] collect what comes out. [`mod@simulate`] makes logs with a known truth.

pub mod simulate;
mod slices;

pub use undrift_drive::{
    columns, consistency, drive, findings, identify, inspect, mounting, navigate, outages, record,
    reference, replay, smooth,
};
pub use undrift_experiments::{demo, montecarlo};
pub use undrift_fleet as fleet;
pub use undrift_results::{self as results, series, usability};
pub use undrift_tune as tune;

pub use undrift_base as base;
pub use undrift_engine::{self as engine, align, estimator, fixes, settings, vehicle};
pub use undrift_io as io;
pub use undrift_nav as nav;
pub use undrift_noise as noise;

pub use drive::Drive;
#[doc(inline)]
pub use engine::{Event, Navigator};
#[doc(inline)]
pub use findings::Finding;
pub use identify::Identified;
#[doc(inline)]
pub use io::write::solution::SolutionRow;
pub use nav::{
    Vector3,
    earth::Geodetic,
    mechanisation::NavState,
    sample::{GnssFix, ImuSample},
};
#[doc(inline)]
pub use navigate::navigate as navigate_drive;
pub use outages::{Logs, Schedule};
pub use record::Record;
pub use simulate::{Trajectory, simulate};
pub use slices::{Identification, Navigated, Setup, identify, navigate};
pub use undrift_noise::{AxisModel, BiasModel, GaussMarkov, ImuModel};
pub use usability::Usability;
