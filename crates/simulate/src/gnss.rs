//! GNSS fixes of an antenna on the trajectory, with white noise.

use super::SimulationError;
use super::ideal_imu::{Stepper, antenna, epochs};
use super::sensors::{GNSS_STREAM, stream_seed};
use super::trajectory::Trajectory;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_nav::{
    Matrix3, Vector3,
    earth::Geodetic,
    sample::{FixQuality, GnssFix, Position},
};

/// What the receiver reports, when, and how well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GnssNoise {
    /// Standard deviation of the position, north, east, down \[m\].
    pub position_std: [f64; 3],
    /// Standard deviation of the velocity, north, east, down [m/s].
    pub velocity_std: [f64; 3],
    /// Factor on the noise that is drawn, not on the covariance that is reported: 1 is honest, 0
    /// gives exact fixes that still say their standard deviations.
    pub noise_scale: f64,
    /// Fixes per second \[Hz\].
    pub rate_hz: f64,
    /// Time of the first fix \[s\], before `time_offset`.
    pub start: f64,
    /// Offset of every epoch from `start + k/rate_hz` \[s\]; epochs before 0 are left out.
    pub time_offset: f64,
    /// Lever arm IMU → antenna in body axes \[m\].
    pub lever_arm: Vector3,
    /// Whether fixes have a position.
    pub with_position: bool,
    /// Whether fixes have a velocity.
    pub with_velocity: bool,
}

impl Default for GnssNoise {
    /// A carrier-phase receiver: 2, 2 and 4 cm, 3 cm/s, once a second from 1 s on, at the IMU.
    fn default() -> Self {
        Self {
            position_std: [0.02, 0.02, 0.04],
            velocity_std: [0.03; 3],
            noise_scale: 1.0,
            rate_hz: 1.0,
            start: 1.0,
            time_offset: 0.0,
            lever_arm: Vector3::zeros(),
            with_position: true,
            with_velocity: true,
        }
    }
}

impl GnssNoise {
    /// Whether every number is one that a receiver could have.
    ///
    /// # Errors
    /// With what is wrong.
    pub fn check(&self) -> Result<(), SimulationError> {
        let stds = self.position_std.iter().chain(&self.velocity_std);
        let wrong = if !stds
            .chain([&self.noise_scale])
            .all(|s| *s >= 0.0 && s.is_finite())
        {
            "standard deviations and the noise scale must be finite and not negative"
        } else if !(self.rate_hz > 0.0 && self.rate_hz.is_finite()) {
            "the rate must be positive"
        } else if !(self.start + self.time_offset).is_finite() {
            "the start and the time offset must be finite"
        } else if !self.lever_arm.iter().all(|l| l.is_finite()) {
            "the lever arm must be finite"
        } else {
            return Ok(());
        };
        Err(SimulationError::Gnss(wrong))
    }

    /// The fix at `time` \[s\] of an antenna at this position with this velocity, north, east, down [m/s].
    pub(super) fn fix(
        &self,
        time: f64,
        position: &Geodetic,
        velocity: &Vector3,
        generator: &mut Xoshiro256PlusPlus,
    ) -> GnssFix {
        // Six draws at every epoch, whatever is reported: one kind's noise does not move the other's.
        let mut draw = |std: &[f64; 3]| {
            Vector3::from_fn(|i, _| {
                let w: f64 = StandardNormal.sample(generator);
                w * std[i] * self.noise_scale
            })
        };
        let position = position.displaced(&draw(&self.position_std));
        let velocity = velocity + draw(&self.velocity_std);
        let covariance =
            |std: &[f64; 3]| Matrix3::from_diagonal(&Vector3::from_fn(|i, _| std[i] * std[i]));
        let position = (Position::Geodetic(position), covariance(&self.position_std));
        let velocity = (velocity, covariance(&self.velocity_std));
        GnssFix {
            attitude: None,
            mean_velocity: None,
            time,
            position: self.with_position.then_some(position),
            velocity: self.with_velocity.then_some(velocity),
            quality: FixQuality::Unknown,
        }
    }
}

/// The fixes of a trajectory one by one, up to its duration. Streamed: memory does not grow.
#[derive(Clone, Debug)]
pub struct GnssFixes<'a> {
    noise: GnssNoise,
    stepper: Stepper<'a>,
    generator: Xoshiro256PlusPlus,
    next: u64,
    end: u64,
}

impl<'a> GnssFixes<'a> {
    /// With the receiver's stream of `seed` ([`stream_seed`]).
    ///
    /// # Errors
    /// As [`GnssNoise::check`].
    pub fn new(
        trajectory: &'a Trajectory,
        noise: &GnssNoise,
        seed: u64,
    ) -> Result<Self, SimulationError> {
        noise.check()?;
        let first = noise.start + noise.time_offset;
        let left = Trajectory::sane(trajectory.duration) - first;
        let end = if left < 0.0 {
            0
        } else {
            // From the first on, whose time may be before 0.
            let whole = (left * noise.rate_hz * (1.0 + 1e-12)).floor();
            (whole as u64).saturating_add(1)
        };
        // Epochs before 0 have no place on the trajectory.
        let next = (-first * noise.rate_hz - 1e-9).ceil().max(0.0) as u64;
        Ok(Self {
            noise: *noise,
            stepper: Stepper::new(trajectory),
            generator: Xoshiro256PlusPlus::seed_from_u64(stream_seed(seed, GNSS_STREAM)),
            next,
            end,
        })
    }
}

impl Iterator for GnssFixes<'_> {
    type Item = GnssFix;

    fn next(&mut self) -> Option<GnssFix> {
        if self.next >= self.end {
            return None;
        }
        let noise = &self.noise;
        let epoch = noise.start + self.next as f64 / noise.rate_hz;
        let time = (epoch + noise.time_offset).max(0.0);
        self.next += 1;
        self.stepper.advance_to(time);
        let (position, velocity) = antenna(&self.stepper.state(), &noise.lever_arm);
        Some(noise.fix(time, &position, &velocity, &mut self.generator))
    }
}

/// How many fixes a receiver reports at most on a trajectory.
pub(super) fn at_most(trajectory: &Trajectory, noise: &GnssNoise) -> u64 {
    epochs(trajectory.duration, noise.rate_hz).saturating_add(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(fix: &GnssFix, exact: &GnssFix) -> [f64; 6] {
        let (Some((Position::Geodetic(a), _)), Some((Position::Geodetic(b), _))) =
            (fix.position, exact.position)
        else {
            return [f64::NAN; 6];
        };
        let (Some((v, _)), Some((w, _))) = (fix.velocity, exact.velocity) else {
            return [f64::NAN; 6];
        };
        let (p, v) = (b.offset_to(&a), v - w);
        [p.x, p.y, p.z, v.x, v.y, v.z]
    }

    #[test]
    fn noise_has_the_variance_that_is_reported() {
        let trajectory = Trajectory::constant_turn(10.0, 0.02, 2000.0);
        let noise = GnssNoise {
            position_std: [0.5, 1.0, 2.0],
            velocity_std: [0.01, 0.02, 0.3],
            rate_hz: 5.0,
            ..GnssNoise::default()
        };
        let quiet = GnssNoise {
            noise_scale: 0.0,
            ..noise
        };
        let mut sums = [0.0; 6];
        let mut n = 0.0;
        let fixes = GnssFixes::new(&trajectory, &noise, 5).unwrap();
        let exact = GnssFixes::new(&trajectory, &quiet, 5).unwrap();
        for (fix, exact) in fixes.zip(exact) {
            assert_eq!(fix.time, exact.time);
            assert_eq!(fix.position.unwrap().1[(1, 1)], 1.0);
            assert_eq!(exact.velocity.unwrap().1[(2, 2)], 0.09);
            let e = error(&fix, &exact);
            for i in 0..6 {
                sums[i] += e[i] * e[i];
            }
            n += 1.0;
        }
        assert_eq!(n, 9996.0);
        let stds = noise.position_std.iter().chain(&noise.velocity_std);
        for (sum, std) in sums.iter().zip(stds) {
            // Relative standard error √(2/n) = 1.4 %; 4 of those.
            let ratio = sum / n / (std * std);
            assert!((ratio - 1.0).abs() < 0.057, "{ratio}");
        }
    }

    #[test]
    fn epochs_are_where_they_were_asked_for() {
        let trajectory = Trajectory::straight(20.0, 1.0, 10.0);
        let times = |start, time_offset| -> Vec<f64> {
            let noise = GnssNoise {
                start,
                time_offset,
                ..GnssNoise::default()
            };
            let fixes = GnssFixes::new(&trajectory, &noise, 0).unwrap();
            fixes.map(|f| f.time).collect()
        };
        assert_eq!(times(0.0, 0.0), (0..=10).map(f64::from).collect::<Vec<_>>());
        assert_eq!(times(7.0, 0.25), [7.25, 8.25, 9.25]);
        assert_eq!(times(-1.0, -0.5)[0], 0.5);
        assert_eq!(times(-1.0, -0.5).len(), 10);
        assert!(times(10.5, 0.0).is_empty());
    }

    #[test]
    fn kinds_of_fix() {
        let trajectory = Trajectory::straight(20.0, 1.0, 10.0);
        let both = GnssNoise::default();
        let velocity_only = GnssNoise {
            with_position: false,
            ..both
        };
        let a: Vec<_> = GnssFixes::new(&trajectory, &both, 1).unwrap().collect();
        let b: Vec<_> = GnssFixes::new(&trajectory, &velocity_only, 1)
            .unwrap()
            .collect();
        assert!(a.len() == b.len() && b.iter().all(|f| f.position.is_none()));
        assert!(a.iter().zip(&b).all(|(a, b)| a.velocity == b.velocity));
    }

    #[test]
    fn odd_receivers_are_refused() {
        let good = GnssNoise::default();
        for bad in [
            GnssNoise {
                rate_hz: 0.0,
                ..good
            },
            GnssNoise {
                start: f64::NAN,
                ..good
            },
            GnssNoise {
                position_std: [-1.0; 3],
                ..good
            },
            GnssNoise {
                velocity_std: [f64::NAN; 3],
                ..good
            },
            GnssNoise {
                noise_scale: f64::INFINITY,
                ..good
            },
            GnssNoise {
                lever_arm: Vector3::repeat(f64::NAN),
                ..good
            },
        ] {
            assert!(bad.check().is_err(), "{bad:?}");
        }
    }
}
