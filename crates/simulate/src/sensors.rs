//! Sensor errors drawn from shaping filters.

use super::SimulationError;
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_nav::{
    sample::ImuSample,
    shaping::{MAX_ORDER, ShapingFilter},
};
use undrift_noise::synthesis::NoiseGenerator;

/// Streams of one seed: six sensor axes, then this, then those of the sensors of one number.
pub(super) const GNSS_STREAM: usize = 6;
/// What is beyond has the seed of this one.
const LAST_STREAM: usize = 63;

/// Seed of a stream: the `stream`-th draw (from 0) of xoshiro256++ seeded by `seed`. Streams 0–2 are
/// the gyros about x, y, z, 3–5 the accelerometers along x, y, z, 6 is the GNSS receiver, the next ones
/// are the sensors of one number: each keeps its noise whatever the others are.
pub fn stream_seed(seed: u64, stream: usize) -> u64 {
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(seed);
    for _ in 0..stream.min(LAST_STREAM) {
        generator.next_u64();
    }
    generator.next_u64()
}

/// The errors of six sensor axes; turn-on constants are drawn from the filters' `p0`.
#[derive(Clone, Debug)]
pub struct SensorErrors {
    axes: [NoiseGenerator; 6],
}

impl SensorErrors {
    /// Of the gyros about x, y, z [rad/s], then the accelerometers along x, y, z [m/s²], at the
    /// sampling rate `rate_hz`. Each axis has its own stream, [`stream_seed`].
    ///
    /// # Errors
    /// Where a filter's interval is not `1/rate_hz` (to 1e-9 of it), or its order beyond what it can hold.
    pub fn new(
        filters: &[ShapingFilter; 6],
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self, SimulationError> {
        for (axis, filter) in filters.iter().enumerate() {
            let matches = (filter.interval * rate_hz - 1.0).abs() < 1e-9;
            if !matches || filter.order > MAX_ORDER {
                return Err(SimulationError::Filter { axis });
            }
        }
        Ok(Self {
            axes: std::array::from_fn(|i| NoiseGenerator::new(&filters[i], stream_seed(seed, i))),
        })
    }

    /// The next errors: gyros [rad/s], then accelerometers [m/s²].
    pub fn draw(&mut self) -> [f64; 6] {
        std::array::from_fn(|i| self.axes[i].sample())
    }

    /// What can be predicted of the next errors, h·x: the true biases, gyros [rad/s], then
    /// accelerometers [m/s²].
    pub fn bias(&self) -> [f64; 6] {
        std::array::from_fn(|i| self.axes[i].bias())
    }

    /// The sample as the sensors report it: each increment plus the next error times `dt`.
    pub fn apply(&mut self, ideal: &ImuSample) -> ImuSample {
        let error = self.draw();
        let mut sample = *ideal;
        for i in 0..3 {
            sample.dtheta[i] += error[i] * ideal.dt;
            sample.dvel[i] += error[i + 3] * ideal.dt;
        }
        sample
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::Vector3;

    const T: f64 = 0.01;

    fn filters(filter: ShapingFilter) -> [ShapingFilter; 6] {
        [filter; 6]
    }

    #[test]
    fn sample_autocovariance_is_the_filters() {
        let filter = ShapingFilter::arma(&[0.9, -0.2], &[0.5], 0.3, T).unwrap();
        let mut errors = SensorErrors::new(&filters(filter), 100.0, 7).unwrap();
        let mut theory = [0.0; 4];
        filter.autocovariance(&mut theory);
        let n = 200_000;
        let drawn: Vec<[f64; 6]> = (0..n).map(|_| errors.draw()).collect();
        for axis in 0..6 {
            for (lag, expected) in theory.iter().enumerate() {
                let sum: f64 = (lag..n)
                    .map(|k| drawn[k][axis] * drawn[k - lag][axis])
                    .sum();
                // Bartlett: the standard error is below γ0·√(2·correlation samples/n) = 0.7 % of γ0
                // with five of them; 4 of those.
                let miss = (sum / n as f64 - expected).abs();
                assert!(miss < 0.028 * theory[0], "{axis} {lag} {miss}");
            }
            // Axes are independent: standard error of the correlation √(5/n) = 0.5 %.
            let cross: f64 = drawn.iter().map(|e| e[axis] * e[(axis + 1) % 6]).sum();
            assert!((cross / n as f64).abs() < 0.02 * theory[0], "{axis}");
        }
    }

    #[test]
    fn constants_are_drawn_once_from_p0() {
        let filter = ShapingFilter::constant(2.0, T).unwrap();
        let mut sum = 0.0;
        for seed in 0..500 {
            let mut errors = SensorErrors::new(&filters(filter), 100.0, seed).unwrap();
            let first = errors.draw();
            assert_eq!(first, errors.draw());
            assert_eq!(first, errors.bias());
            sum += first.iter().map(|e| e * e).sum::<f64>();
        }
        // 3000 draws: relative standard error √(2/3000) = 2.6 %; 4 of those.
        assert!((sum / 3000.0 / 4.0 - 1.0).abs() < 0.105, "{sum}");
    }

    #[test]
    fn an_axis_keeps_its_noise_whatever_the_others_are() {
        let noisy = ShapingFilter::white(1.0, T).unwrap();
        let mut mixed = filters(noisy);
        mixed[0] = ShapingFilter::none(T).unwrap();
        let mut all = SensorErrors::new(&filters(noisy), 100.0, 3).unwrap();
        let mut but_one = SensorErrors::new(&mixed, 100.0, 3).unwrap();
        let ideal = ImuSample {
            time: T,
            dt: T,
            dtheta: Vector3::zeros(),
            dvel: Vector3::zeros(),
        };
        let (a, b) = (all.apply(&ideal), but_one.apply(&ideal));
        assert_eq!(b.dtheta.x, 0.0);
        assert_ne!(a.dtheta.x, 0.0);
        assert_eq!((a.dtheta.yz(), a.dvel), (b.dtheta.yz(), b.dvel));
    }

    #[test]
    fn a_filter_of_another_rate_is_refused() {
        let filter = ShapingFilter::white(1.0, T).unwrap();
        let mut set = filters(filter);
        assert!(SensorErrors::new(&set, 200.0, 0).is_err());
        assert!(SensorErrors::new(&set, f64::NAN, 0).is_err());
        set[4].order = MAX_ORDER + 1;
        let refused = SensorErrors::new(&set, 100.0, 0).map(|_| ());
        assert_eq!(refused, Err(SimulationError::Filter { axis: 4 }));
    }
}
