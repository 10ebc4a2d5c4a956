//! A wheel's speed, a barometer's height and the heading of two antennas on a trajectory, with their errors.

use super::SimulationError;
use super::ideal_imu::{Stepper, epochs};
use super::sensors::{GNSS_STREAM, stream_seed};
use super::trajectory::Trajectory;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_nav::{Vector3, earth::wrap_pi, sample::Scalar};

/// Streams of one seed, behind the receiver's.
const ODOMETER_STREAM: usize = GNSS_STREAM + 1;
const BAROMETER_STREAM: usize = GNSS_STREAM + 2;
const HEADING_STREAM: usize = GNSS_STREAM + 3;
/// Least error of a heading by a wrong number of wavelengths [rad]: one in a metre.
const WRONG: f64 = 0.17;

/// A wheel that measures its speed along the body's forward axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Odometer {
    /// Measurements per second \[Hz\], the first after one interval.
    pub rate_hz: f64,
    /// Standard deviation of the white noise, drawn and reported [m/s].
    pub std: f64,
    /// Scale factor error s: it reads `(1 + s)` times the speed [–].
    pub scale_error: f64,
    /// IMU → wheel, body axes \[m\].
    pub lever_arm: Vector3,
}

impl Default for Odometer {
    /// Ten times a second, 5 cm/s, 2 % too fast, at the IMU.
    fn default() -> Self {
        Self {
            rate_hz: 10.0,
            std: 0.05,
            scale_error: 0.02,
            lever_arm: Vector3::zeros(),
        }
    }
}

/// A barometer that measures height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barometer {
    /// Measurements per second \[Hz\], the first after one interval.
    pub rate_hz: f64,
    /// Standard deviation of the white noise, drawn and reported \[m\].
    pub std: f64,
    /// Error at time 0 \[m\].
    pub bias: f64,
    /// Random walk of the error [m/√s].
    pub bias_walk: f64,
}

impl Default for Barometer {
    /// Five times a second, 0.3 m, 25 m too high at first, changing by 0.05 m/√s.
    fn default() -> Self {
        Self {
            rate_hz: 5.0,
            std: 0.3,
            bias: 25.0,
            bias_walk: 0.05,
        }
    }
}

/// Two antennas of a receiver that measures the azimuth of the second as seen from the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DualAntenna {
    /// Measurements per second \[Hz\], the first after one interval.
    pub rate_hz: f64,
    /// Standard deviation of the white noise, drawn and reported \[rad\].
    pub std: f64,
    /// Direction of the second antenna in the body, from forward to right \[rad\].
    pub baseline: f64,
    /// Share of headings by a wrong number of wavelengths: off by anything from 10° to 180° [–].
    pub wrong: f64,
}

impl Default for DualAntenna {
    /// Once a second, 0.3° as of half a metre, one antenna in front of the other, never wrong.
    fn default() -> Self {
        Self {
            rate_hz: 1.0,
            std: 0.3_f64.to_radians(),
            baseline: 0.0,
            wrong: 0.0,
        }
    }
}

impl DualAntenna {
    /// What it measures on a trajectory one by one, with its stream of `seed` ([`stream_seed`]).
    ///
    /// # Errors
    /// For a rate that is not positive, a standard deviation that is negative or not finite, or a share outside of 0 to 1.
    pub fn measure(
        self,
        trajectory: &Trajectory,
        seed: u64,
    ) -> Result<impl Iterator<Item = Scalar> + '_, SimulationError> {
        let finite = self.baseline.is_finite() && (0.0..=1.0).contains(&self.wrong);
        let times = times(trajectory, self.rate_hz, self.std, finite)?;
        let mut noise = noise(seed, HEADING_STREAM);
        let mut wrong = generator(seed, HEADING_STREAM + 1);
        let (sin, cos) = self.baseline.sin_cos();
        Ok(times.map(move |time| {
            let b = trajectory.motion(time).q_nb * Vector3::new(cos, sin, 0.0);
            let mut value = b.y.atan2(b.x) + self.std * noise();
            if wrong.random_bool(self.wrong) {
                value += wrong.random_range(WRONG..std::f64::consts::TAU - WRONG);
            }
            Scalar {
                time,
                value: wrap_pi(value),
                std: self.std,
            }
        }))
    }
}

impl Odometer {
    /// What it measures on a trajectory one by one, with its stream of `seed` ([`stream_seed`]).
    ///
    /// # Errors
    /// For a rate that is not positive, or a standard deviation that is negative or not finite.
    pub fn measure(
        self,
        trajectory: &Trajectory,
        seed: u64,
    ) -> Result<impl Iterator<Item = Scalar> + '_, SimulationError> {
        let finite = self.scale_error.is_finite() && self.lever_arm.iter().all(|l| l.is_finite());
        let times = times(trajectory, self.rate_hz, self.std, finite)?;
        let mut noise = noise(seed, ODOMETER_STREAM);
        Ok(times.map(move |time| {
            let motion = trajectory.motion(time);
            let v_b = motion.q_nb.inverse_transform_vector(&motion.v_n)
                + motion.omega_nb_b.cross(&self.lever_arm);
            Scalar {
                time,
                value: (1.0 + self.scale_error) * v_b.x + self.std * noise(),
                std: self.std,
            }
        }))
    }
}

impl Barometer {
    /// What it measures on a trajectory one by one, with its stream of `seed` ([`stream_seed`]).
    ///
    /// # Errors
    /// For a rate that is not positive, or a standard deviation that is negative or not finite.
    pub fn measure(
        self,
        trajectory: &Trajectory,
        seed: u64,
    ) -> Result<impl Iterator<Item = Scalar> + '_, SimulationError> {
        let finite = self.bias.is_finite() && self.bias_walk >= 0.0 && self.bias_walk.is_finite();
        let times = times(trajectory, self.rate_hz, self.std, finite)?;
        let mut noise = noise(seed, BAROMETER_STREAM);
        let mut stepper = Stepper::new(trajectory);
        let mut bias = self.bias;
        let step = self.bias_walk / self.rate_hz.sqrt();
        Ok(times.map(move |time| {
            stepper.advance_to(time);
            bias += step * noise();
            Scalar {
                time,
                value: stepper.state().position.height + bias + self.std * noise(),
                std: self.std,
            }
        }))
    }
}

/// The times k/rate, k = 1, 2, …, up to the trajectory's duration.
pub(super) fn times(
    trajectory: &Trajectory,
    rate_hz: f64,
    std: f64,
    finite: bool,
) -> Result<impl Iterator<Item = f64> + use<>, SimulationError> {
    if !(rate_hz > 0.0 && rate_hz.is_finite()) {
        return Err(SimulationError::Rate);
    }
    if !(std >= 0.0 && std.is_finite() && finite) {
        return Err(SimulationError::Scalar);
    }
    let count = epochs(trajectory.duration, rate_hz);
    Ok((1..=count).map(move |k| k as f64 / rate_hz))
}

/// Standard normal numbers of a stream.
fn noise(seed: u64, stream: usize) -> impl FnMut() -> f64 {
    let mut generator = generator(seed, stream);
    move || StandardNormal.sample(&mut generator)
}

pub(super) fn generator(seed: u64, stream: usize) -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(stream_seed(seed, stream))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_asked_for() {
        let car = Trajectory::car(2000.0, 4);
        let lever_arm = Vector3::new(-1.0, 0.8, 0.5);
        let odometer = Odometer {
            lever_arm,
            ..Odometer::default()
        };
        let exact = Odometer {
            std: 0.0,
            scale_error: 0.0,
            ..odometer
        };
        let pairs = odometer.measure(&car, 2).unwrap();
        let pairs: Vec<_> = pairs.zip(exact.measure(&car, 2).unwrap()).collect();
        let n = pairs.len() as f64;
        assert_eq!(n, 20_000.0);
        let squares: f64 = pairs
            .iter()
            .map(|(a, b)| (a.value - 1.02 * b.value).powi(2))
            .sum();
        // Relative standard error of a standard deviation 1/√(2n) = 0.5 %; 4 of those.
        assert!(((squares / n).sqrt() / 0.05 - 1.0).abs() < 0.02);
        // A wheel on the outside of a turn is faster by rate times track: here to the right of the
        // IMU, so by −0.8 m of the yaw rate, but for what pitch does to its height.
        let motion = car.motion(pairs[5000].1.time);
        let speed = motion.v_n.norm() - 0.8 * motion.omega_nb_b.z + 0.5 * motion.omega_nb_b.y;
        assert!((pairs[5000].1.value - speed).abs() < 0.01 * speed.abs() + 1e-9);

        let barometer = Barometer::default();
        let quiet = Barometer {
            std: 0.0,
            bias: 0.0,
            bias_walk: 0.0,
            ..barometer
        };
        let errors: Vec<f64> = barometer
            .measure(&car, 2)
            .unwrap()
            .zip(quiet.measure(&car, 2).unwrap())
            .map(|(a, b)| a.value - b.value)
            .collect();
        // Differences: the walk's step and two draws of white noise, of which neighbours share one;
        // their variance has a relative standard error of √(3/n) = 1.7 %; 4 of those.
        let n = errors.len() as f64 - 1.0;
        let squares: f64 = errors.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
        let expected = 0.05 * 0.05 / 5.0 + 2.0 * 0.3 * 0.3;
        assert!(
            (squares / n / expected - 1.0).abs() < 0.07,
            "{}",
            squares / n
        );
        // The walk over a thousand seconds is 1.6 m.
        assert!((errors[0] - 25.0).abs() < 1.5 && (errors[5000] - 25.0).abs() < 8.0);
        assert!((quiet.measure(&car, 9).unwrap().next().unwrap().value - 20.0).abs() < 1e-9);
    }

    #[test]
    fn a_share_of_headings_is_wrong_by_ten_degrees_and_more() {
        let car = Trajectory::car(2000.0, 4);
        let antennas = DualAntenna {
            baseline: 1.5,
            wrong: 0.05,
            ..DualAntenna::default()
        };
        let exact = DualAntenna {
            std: 0.0,
            wrong: 0.0,
            ..antennas
        };
        let pairs = antennas.measure(&car, 2).unwrap();
        let pairs = pairs.zip(exact.measure(&car, 2).unwrap());
        let errors: Vec<f64> = pairs
            .map(|(a, b)| wrap_pi(a.value - b.value).abs())
            .collect();
        let wrong = errors.iter().filter(|error| **error > 0.15).count();
        assert!((70..130).contains(&wrong), "{wrong} of 2000");
        let right = errors.iter().filter(|error| **error < 0.15);
        let squares: f64 = right.map(|error| error * error).sum();
        let std = (squares / (2000 - wrong) as f64).sqrt().to_degrees();
        assert!((std - 0.3).abs() < 0.02, "{std}");
        let odd = DualAntenna {
            wrong: 1.5,
            ..antennas
        };
        assert!(odd.measure(&car, 0).is_err());
    }

    #[test]
    fn the_same_seed_gives_the_same_numbers_and_another_others() {
        let car = Trajectory::car(90.0, 4);
        let all =
            |seed| -> Vec<Scalar> { Odometer::default().measure(&car, seed).unwrap().collect() };
        assert_eq!(all(3), all(3));
        assert_ne!(all(3), all(4));
        let other = Barometer::default().measure(&car, 3).unwrap().count();
        assert_eq!((all(3).len(), other), (900, 450));
    }

    #[test]
    fn odd_sensors_are_refused() {
        let car = Trajectory::car(90.0, 4);
        for odometer in [
            Odometer {
                rate_hz: 0.0,
                ..Odometer::default()
            },
            Odometer {
                std: -1.0,
                ..Odometer::default()
            },
            Odometer {
                scale_error: f64::NAN,
                ..Odometer::default()
            },
        ] {
            assert!(odometer.measure(&car, 0).is_err());
        }
        let barometer = Barometer {
            bias_walk: -1.0,
            ..Barometer::default()
        };
        assert!(barometer.measure(&car, 0).is_err());
    }
}
