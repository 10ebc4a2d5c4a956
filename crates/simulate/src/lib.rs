//! A vehicle, its sensors and its GNSS receiver, with the truth beside them.
//!
//! The motion is analytic ([`trajectory`]), so the IMU's increments are exact ([`ideal_imu`]);
//! sensor errors are any six shaping filters ([`sensors`]), GNSS noise is white ([`gnss`]), and there
//! may be sensors of one number ([`scalars`]) and a magnetometer.
//! Flights in wind are sampled in place of integrated ([`fly`]).
//! Time runs from 0 at the trajectory's start. The same seed gives the same bytes.
//!
//! ```
//! use undrift_simulate::{GnssNoise, Trajectory, simulate};
//! let drive = Trajectory::car(120.0, 1);
//! let log = simulate(&drive, 100.0, None, &GnssNoise::default(), 1)?;
//! assert_eq!((log.imu.len(), log.truth.len(), log.gnss.len()), (12_000, 12_001, 120));
//! # Ok::<(), undrift_simulate::SimulationError>(())
//! ```

mod air;
pub mod gnss;
pub mod ideal_imu;
mod magnetometer;
mod poses;
pub mod profile;
pub mod recorded;
pub mod scalars;
mod scenarios;
pub mod sensors;
pub mod trajectory;

#[cfg(test)]
mod tests;

pub use air::{Craft, Flight, fly};
pub use gnss::{GnssFixes, GnssNoise};
pub use ideal_imu::{IdealImu, State, Stepper, antenna};
pub use magnetometer::{Magnet, Magnetometer};
pub use poses::{Pose, PoseNoise};
pub use profile::{Channel, Profile, Wave};
pub use recorded::RecordedErrors;
pub use scalars::*;
pub use scenarios::REST_BEFORE;
pub use sensors::{SensorErrors, stream_seed};
pub use trajectory::{MAX_DURATION, Motion, Trajectory};

use undrift_nav::Vector3;
use undrift_nav::sample::{GnssFix, ImuSample, Position, TruthSample};
use undrift_nav::shaping::ShapingFilter;

/// Most samples of one kind that [`simulate`] keeps in memory; use the iterators for more.
pub const MAX_SAMPLES: u64 = 100_000_000;

/// Everything that a simulated drive leaves behind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Simulation {
    /// Inertial samples; the first ends at one sampling interval.
    pub imu: Vec<ImuSample>,
    /// GNSS fixes of the antenna.
    pub gnss: Vec<GnssFix>,
    /// Truth at the IMU: at time 0, then at the end of each inertial sample.
    pub truth: Vec<TruthSample>,
}

impl Simulation {
    /// Puts a receiver's own filter before its fixes: a low-pass of first order with the time constant `tau` \[s\]. Positions and velocities
    /// are late by `tau`, and beyond that off by half of `tau²` times their second derivative. The antenna moves as the IMU does.
    pub fn filter_fixes(&mut self, tau: f64) {
        let Some(first) = self.truth.first() else {
            return;
        };
        let origin = first.position;
        let mut truth = self.truth.iter().peekable();
        let (mut before, mut slow) = (first.time, [Vector3::zeros(); 2]);
        slow[1] = first.v_n.unwrap_or_default();
        let mut off = [Vector3::zeros(); 2];
        for fix in &mut self.gnss {
            while let Some(row) = truth.next_if(|row| row.time < fix.time + 1e-6) {
                let seen = [origin.offset_to(&row.position), row.v_n.unwrap_or_default()];
                let gain = 1.0 - ((before - row.time) / tau).exp();
                before = row.time;
                for (slow, now) in slow.iter_mut().zip(seen) {
                    *slow += (now - *slow) * gain;
                }
                off = [0, 1].map(|k| slow[k] - seen[k]);
            }
            if let Some((Position::Geodetic(place), _)) = &mut fix.position {
                *place = place.displaced(&off[0]);
            }
            if let Some((v_n, _)) = &mut fix.velocity {
                *v_n += off[1];
            }
        }
    }
}

/// Why nothing can be simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SimulationError {
    /// The IMU's rate is not positive and finite.
    #[error("the sampling rate must be positive")]
    Rate,
    /// The start is no place on the Earth, or within a degree of a pole.
    #[error("the start must be at least one degree from the poles")]
    Start,
    /// More than [`MAX_SAMPLES`].
    #[error("more than {MAX_SAMPLES} samples: lower the rate or the duration")]
    TooLong,
    /// A shaping filter is not one for the sampling rate.
    #[error(
        "the noise model of sensor axis {axis} (0-2 gyros, 3-5 accelerometers) is not at the sampling rate"
    )]
    Filter {
        /// Index of the filter.
        axis: usize,
    },
    /// The GNSS receiver cannot be.
    #[error("GNSS: {0}")]
    Gnss(&'static str),
    /// A sensor of one number cannot be.
    #[error(
        "the errors of a sensor of one number must be finite, and standard deviations not negative"
    )]
    Scalar,
}

/// An error for a rate of samples \[Hz\] that cannot be.
fn check_rate(rate_hz: f64) -> Result<(), SimulationError> {
    match rate_hz > 0.0 && rate_hz.is_finite() {
        true => Ok(()),
        false => Err(SimulationError::Rate),
    }
}

/// Simulates a whole trajectory: the IMU at `rate_hz` with the sensor errors of `filters` (gyros
/// about x, y, z, accelerometers along x, y, z; `None` is free of errors), and the GNSS receiver.
///
/// # Errors
/// For a rate, start, filter or receiver that cannot be, and for more than [`MAX_SAMPLES`].
pub fn simulate(
    trajectory: &Trajectory,
    rate_hz: f64,
    filters: Option<&[ShapingFilter; 6]>,
    gnss: &GnssNoise,
    seed: u64,
) -> Result<Simulation, SimulationError> {
    check_rate(rate_hz)?;
    let start = &trajectory.start;
    if !start.is_valid() || start.lat.abs() > 89f64.to_radians() {
        return Err(SimulationError::Start);
    }
    gnss.check()?;
    let samples = ideal_imu::epochs(trajectory.duration, rate_hz);
    if samples.max(gnss::at_most(trajectory, gnss)) > MAX_SAMPLES {
        return Err(SimulationError::TooLong);
    }
    let errors = filters.map(|filters| SensorErrors::new(filters, rate_hz, seed));
    let mut errors = errors.transpose()?;
    let walk = IdealImu::new(trajectory, rate_hz);
    let mut imu = Vec::with_capacity(samples as usize);
    let mut truth = Vec::with_capacity(samples as usize + 1);
    truth.push(walk.state().truth());
    for (ideal, reference) in walk {
        undrift_base::interrupt::check();
        imu.push(match &mut errors {
            Some(errors) => errors.apply(&ideal),
            None => ideal,
        });
        truth.push(reference);
    }
    Ok(Simulation {
        imu,
        gnss: GnssFixes::new(trajectory, gnss, seed)?.collect(),
        truth,
    })
}
