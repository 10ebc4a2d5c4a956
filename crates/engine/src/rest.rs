//! Tells rest from motion by the sensors alone, at a level learned while GNSS says that the vehicle stands.

use crate::settings::RestSettings;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{Vector3, covariance::AXES, sample::ImuSample, shaping::ShapingFilter};

/// What the last block was.
#[derive(Clone, Copy, Debug)]
pub(super) struct RestBlock {
    /// Whether the vehicle stood.
    pub(super) rest: bool,
    /// Whether GNSS says so, too.
    pub(super) confirmed: bool,
    /// Mean angular rate as read [rad/s].
    pub(super) rate: Vector3,
    /// Length \[s\].
    pub(super) duration: f64,
}

/// Sums over the present block and the learned level of rest.
#[derive(Clone, Default)]
pub(super) struct RestDetector {
    set: RestSettings,
    /// Variance of a sample's white noise, gyros [rad²/s²], then accelerometers [m²/s⁴].
    noise: [f64; AXES],
    /// Learned variance of a sample at rest; as many blocks.
    level: [f64; AXES],
    learned: u32,
    /// Least scatter, relative to the level, of blocks in which GNSS said that the vehicle moved.
    moving: f64,
    count: f64,
    duration: f64,
    sum: [f64; AXES],
    squares: [f64; AXES],
    first_half: (f64, Vector3),
}

impl RestDetector {
    pub(super) fn new(sensors: &[ShapingFilter; AXES], set: RestSettings) -> Self {
        Self {
            set,
            noise: core::array::from_fn(|i| sensors[i].r.max(1e-16)),
            moving: f64::INFINITY,
            ..Self::default()
        }
    }

    /// Adds a sample; the block it completes, if it does. `expected` is what the sensors should read at
    /// rest, rate [rad/s] and specific force [m/s²]: predicted errors, Earth rate and gravity; `speed` the
    /// least and greatest speed over ground [m/s] that GNSS leaves possible, where there is one now.
    pub(super) fn add(
        &mut self,
        sample: &ImuSample,
        expected: &(Vector3, Vector3),
        speed: Option<(f64, f64)>,
    ) -> Option<RestBlock> {
        let (rate, force) = (sample.dtheta / sample.dt, sample.dvel / sample.dt);
        for i in 0..3 {
            for (axis, value) in [(i, rate[i]), (3 + i, force[i])] {
                self.sum[axis] += value;
                self.squares[axis] += value * value;
            }
        }
        self.count += 1.0;
        self.duration += sample.dt;
        if self.duration < 0.5 * self.set.block {
            self.first_half = (self.count, Vector3::from_fn(|i, _| self.sum[3 + i]));
        }
        if self.duration < self.set.block {
            return None;
        }
        let n = self.count;
        let mean = self.sum.map(|s| s / n);
        let scatter: [f64; AXES] =
            core::array::from_fn(|i| (self.squares[i] / n - mean[i] * mean[i]).max(0.0));
        let block_rate = Vector3::new(mean[0], mean[1], mean[2]);
        let block_force = Vector3::new(mean[3], mean[4], mean[5]);
        let (half, half_sum) = self.first_half;
        let halves = half_sum / half.max(1.0)
            - (Vector3::from_fn(|i, _| self.sum[3 + i]) - half_sum) / (n - half).max(1.0);
        let duration = self.duration;
        *self = Self {
            count: 0.0,
            duration: 0.0,
            sum: [0.0; AXES],
            squares: [0.0; AXES],
            ..*self
        };

        let relative = scatter
            .iter()
            .enumerate()
            .map(|(axis, s)| s / self.level(axis))
            .sum::<f64>()
            / AXES as f64;
        match speed {
            Some((least, _)) if least < self.set.stands && halves.norm() < 3.0 * self.set.force => {
                let weight = self.set.learn.max(1.0 / f64::from(self.learned + 1));
                for (level, s) in self.level.iter_mut().zip(scatter) {
                    *level += weight * (s - *level);
                }
                self.learned += 1;
            }
            Some((least, _)) if least > 2.0 * self.set.moves => {
                self.moving = self.moving.min(relative)
            }
            _ => {}
        }
        let limit = if self.learned > 0 {
            self.set.limit
        } else {
            self.set.noise_limit
        };
        // A drive as smooth as rest leaves no room for a limit: then only GNSS can tell.
        let quiet = relative < limit.min(0.7 * self.moving);
        let (possible, stands) = match speed {
            Some((least, greatest)) => (least < self.set.moves, greatest < self.set.moves),
            // What motion looks like must be known, unless GNSS tells no speeds at all.
            None => (self.moving.is_finite() || self.learned == 0, false),
        };
        // Where the readings and GNSS say rest, the solution's biases and level may be wrong.
        let trust = if quiet && stands {
            self.set.unsure
        } else {
            1.0
        };
        let tolerance = |axis: usize| 4.0 * (self.level(axis) / n).sqrt();
        let steady = (0..3).all(|i| {
            (block_rate[i] - expected.0[i]).abs() < trust * self.set.rate + tolerance(i)
                && (block_force[i] - expected.1[i]).abs()
                    < trust * self.set.level + tolerance(3 + i)
                && halves[i].abs() < self.set.force + 2.0 * tolerance(3 + i)
        });
        Some(RestBlock {
            rest: possible && steady && (quiet || stands),
            confirmed: stands,
            rate: block_rate,
            duration,
        })
    }

    /// Variance of a sample at rest.
    fn level(&self, axis: usize) -> f64 {
        if self.learned > 0 {
            self.level[axis].max(0.1 * self.noise[axis])
        } else {
            self.noise[axis]
        }
    }
}

#[cfg(test)]
mod tests;
