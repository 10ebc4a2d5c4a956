//! A magnetometer on a trajectory: the Earth's field, iron of the vehicle, a magnet that passes by.

use super::SimulationError;
use super::ideal_imu::Stepper;
use super::scalars::{generator, times};
use super::sensors::GNSS_STREAM;
use super::trajectory::Trajectory;
use rand_distr::{Distribution, StandardNormal};
use undrift_nav::{Vector3, magnetic, sample::MagneticField};

/// Stream of one seed, behind those of the sensors of one number.
const STREAM: usize = GNSS_STREAM + 5;

/// A magnetometer in the body's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnetometer {
    /// Readings per second \[Hz\], the first after one interval.
    pub rate_hz: f64,
    /// Standard deviation of the white noise, drawn and reported, each axis \[T\].
    pub std: f64,
    /// Standard deviation of the hard iron, drawn once for each axis \[T\].
    pub hard_iron_std: f64,
    /// Standard deviation of an error that lasts, each axis \[T\], and its correlation time \[s\]: a Gauss-Markov process.
    pub lasting: (f64, f64),
    /// Year with its fraction, for the Earth's field.
    pub year: f64,
    /// A magnet that passes by.
    pub magnet: Option<Magnet>,
}

/// Iron that passes by: its field comes and goes as that of a dipole on a straight way, and turns while it does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnet {
    /// Time at which it is nearest \[s\].
    pub time: f64,
    /// Its field then, north, east, down \[T\].
    pub field: Vector3,
    /// Its distance then over its speed \[s\].
    pub passage: f64,
}

impl Magnet {
    /// Its field at `time` \[s\], north, east, down \[T\].
    fn at(&self, time: f64) -> Vector3 {
        let way = (time - self.time) / self.passage;
        let (sin, cos) = way.atan().sin_cos();
        let turned = Vector3::new(
            self.field.x * cos - self.field.y * sin,
            self.field.x * sin + self.field.y * cos,
            self.field.z,
        );
        turned / (1.0 + way * way).powf(1.5)
    }
}

impl Default for Magnetometer {
    /// Ten times a second, 0.5 µT, a hard iron of 5 µT, 2 µT that last for 20 s, no magnet.
    fn default() -> Self {
        Self {
            rate_hz: 10.0,
            std: 0.5e-6,
            hard_iron_std: 5e-6,
            lasting: (2e-6, 20.0),
            year: 2026.0,
            magnet: None,
        }
    }
}

impl Magnetometer {
    /// What it measures on a trajectory one by one, with its stream of `seed` ([`stream_seed`](super::stream_seed)).
    ///
    /// ```
    /// use undrift_simulate::{Magnetometer, Trajectory};
    /// let car = Trajectory::car(60.0, 1);
    /// let readings: Vec<_> = Magnetometer::default().measure(&car, 1)?.collect();
    /// assert_eq!(readings.len(), 600);
    /// let strength = readings[0].field.norm() * 1e6;
    /// assert!((20.0..75.0).contains(&strength)); // [µT]
    /// # Ok::<(), undrift_simulate::SimulationError>(())
    /// ```
    ///
    /// # Errors
    /// For a rate or times that are not positive, or standard deviations that are negative or not finite.
    pub fn measure(
        self,
        trajectory: &Trajectory,
        seed: u64,
    ) -> Result<impl Iterator<Item = MagneticField> + '_, SimulationError> {
        let (lasting, lasts) = self.lasting;
        let not_negative = [self.hard_iron_std, lasting];
        let passes =
            |magnet: Magnet| magnet.passage > 0.0 && magnet.field.iter().all(|b| b.is_finite());
        let finite = not_negative
            .iter()
            .all(|std| std.is_finite() && *std >= 0.0)
            && lasts > 0.0
            && self.year.is_finite()
            && self.magnet.is_none_or(passes);
        let times = times(trajectory, self.rate_hz, self.std, finite)?;
        let mut generator = generator(seed, STREAM);
        let mut noise = move || Vector3::from_fn(|_, _| StandardNormal.sample(&mut generator));
        let hard_iron = noise() * self.hard_iron_std;
        let mut drifts = noise() * lasting;
        let decay = (-1.0 / (self.rate_hz * lasts)).exp();
        let mut stepper = Stepper::new(trajectory);
        Ok(times.map(move |time| {
            stepper.advance_to(time);
            drifts = drifts * decay + noise() * (lasting * (1.0 - decay * decay).sqrt());
            let mut field = magnetic::field(&stepper.state().position, self.year);
            if let Some(magnet) = &self.magnet {
                field += magnet.at(time);
            }
            let felt = trajectory
                .motion(time)
                .q_nb
                .inverse_transform_vector(&field);
            MagneticField {
                time,
                field: felt + hard_iron + drifts + noise() * self.std,
                std: self.std,
            }
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_asked_for() {
        let rest = Trajectory::rest(2000.0);
        let exact = Magnetometer {
            std: 0.0,
            hard_iron_std: 0.0,
            lasting: (0.0, 20.0),
            ..Magnetometer::default()
        };
        let squares = |sensor: Magnetometer, seed| -> f64 {
            let pairs = sensor.measure(&rest, seed).unwrap();
            let pairs = pairs.zip(exact.measure(&rest, seed).unwrap());
            pairs
                .map(|(a, b)| (a.field - b.field).norm_squared())
                .sum::<f64>()
                / 3.0
                / 20_000.0
        };
        let white = Magnetometer {
            std: 0.5e-6,
            ..exact
        };
        assert!((squares(white, 2).sqrt() / 0.5e-6 - 1.0).abs() < 0.02);
        // A hundred independent spans of three axes: 6 % of the variance's root; three of those.
        let lasting = Magnetometer {
            lasting: (2e-6, 10.0),
            ..exact
        };
        assert!((squares(lasting, 2).sqrt() / 2e-6 - 1.0).abs() < 0.18);
        let iron = Magnetometer {
            hard_iron_std: 5e-6,
            ..exact
        };
        let short = |seed| {
            let first = iron.measure(&rest, seed).unwrap().next();
            let exact = exact.measure(&rest, seed).unwrap().next();
            (first.unwrap().field - exact.unwrap().field).norm_squared() / 3.0
        };
        let mean = (0..60).map(short).sum::<f64>() / 60.0;
        assert!((mean.sqrt() / 5e-6 - 1.0).abs() < 0.16, "{mean}");
        for odd in [
            Magnetometer {
                rate_hz: 0.0,
                ..exact
            },
            Magnetometer {
                hard_iron_std: -1.0,
                ..exact
            },
            Magnetometer {
                lasting: (1e-6, 0.0),
                ..exact
            },
        ] {
            assert!(odd.measure(&rest, 0).is_err());
        }
    }

    #[test]
    fn a_magnet_comes_and_goes() {
        let rest = Trajectory::rest(60.0);
        let magnet = Magnet {
            time: 30.0,
            field: Vector3::new(0.0, 30e-6, 0.0),
            passage: 2.0,
        };
        let with = Magnetometer {
            magnet: Some(magnet),
            ..Magnetometer::default()
        };
        let pairs = with.measure(&rest, 1).unwrap();
        let pairs = pairs.zip(Magnetometer::default().measure(&rest, 1).unwrap());
        let added: Vec<f64> = pairs.map(|(a, b)| (a.field - b.field).norm()).collect();
        assert!((added[299] - 30e-6).abs() < 1e-9 && added[99] < 0.1e-6 && added[499] < 0.1e-6);
    }
}
