//! Distinguishes rest from motion by the sensors alone, at a level learned while GNSS shows that the vehicle is at rest.
//!
//! A block of half a second is at rest where all of this holds:
//!
//! - its scatter, on the average of the six axes, is below three times the learned level of rest (below twice
//!   the sensor's own noise until one is learned), and below 0.7 of the least scatter seen in motion;
//! - its mean rate and mean specific force are what the solution expects of rest, and the two halves of the
//!   block agree;
//! - GNSS leaves a speed below 0.5 m/s possible, where it has one; without, motion must have been seen, or no
//!   rest learned.
//!
//! A block that GNSS calls slow is at rest even if it is not quiet, as long as its means fit: an engine shakes.
//! The level is learned from blocks that GNSS calls standing beyond doubt.

use super::vibration::turned_variances;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{Matrix3, Vector3, covariance::AXES, sample::ImuSample, shaping::ShapingFilter};

/// Length of the blocks that are judged \[s\].
const BLOCK: f64 = 0.5;
/// Rest while the scatter of a block is below this many times that of rest, on the average of the axes.
const LIMIT: f64 = 3.0;
/// Rest while it is below this many times that of the sensor's own noise, until rest has been seen.
const NOISE_LIMIT: f64 = 2.0;
/// The mean rate at rest is known to this much beyond the noise of the mean \[rad/s\].
const RATE: f64 = 0.004;
/// Means of the specific force in the two halves of a block agree to this much at rest \[m/s²\].
const FORCE: f64 = 0.06;
/// The mean specific force is the solution's gravity to this much at rest \[m/s²\]: 3° of wrong level, while a car
/// that pulls away smoothly has twice that.
const LEVEL: f64 = 0.5;
/// [`RATE`] and [`LEVEL`] grow by this factor where GNSS shows that the vehicle is at rest.
const UNSURE: f64 = 5.0;
/// Speed that GNSS calls standing, where its accuracy leaves no doubt \[m/s\].
const STANDS: f64 = 0.1;
/// Speed that GNSS calls moving \[m/s\].
pub(super) const MOVES: f64 = 0.5;
/// Weight of a block in the learned level.
const LEARN: f64 = 0.1;

/// What the last block was.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct RestBlock {
    /// Whether the vehicle stood.
    pub(super) rest: bool,
    /// Whether GNSS says so, too.
    pub(super) confirmed: bool,
    /// Mean angular rate as read [rad/s].
    pub(super) rate: Vector3,
    /// Length of the block \[s\].
    pub(super) duration: f64,
}

/// Sums over the present block and the learned level of rest.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct RestDetector {
    /// Variance of a sample's white noise, gyros [rad²/s²], then accelerometers [m²/s⁴].
    noise: [f64; AXES],
    /// Learned variance of a sample at rest; as many blocks.
    level: [f64; AXES],
    /// 0 while the sensor's own noise is the level.
    learned: u32,
    /// Least scatter, relative to the level, of blocks in which GNSS said that the vehicle moved.
    ///
    /// Infinite until motion was seen.
    moving: f64,
    count: f64,
    duration: f64,
    sum: [f64; AXES],
    squares: [f64; AXES],
    /// Samples of the first half of the block, and the sum of their specific force.
    first_half: (f64, Vector3),
}

impl RestDetector {
    /// Without noise in the model a variance of 1e-16 keeps ratios finite.
    pub(super) fn new(sensors: &[ShapingFilter; AXES]) -> Self {
        Self {
            noise: core::array::from_fn(|i| sensors[i].r.max(1e-16)),
            moving: f64::INFINITY,
            ..Self::default()
        }
    }

    /// Body axes turn by `c`: the level of rest is that of independent axes, the block begins again.
    pub(super) fn turn(&mut self, c: &Matrix3) {
        *self = Self {
            level: turned_variances(c, &self.level),
            count: 0.0,
            duration: 0.0,
            sum: [0.0; AXES],
            squares: [0.0; AXES],
            ..*self
        };
    }

    /// Adds a sample; the block it completes, if it does. `expected` is what the sensors should read at
    /// rest, rate [rad/s] and specific force [m/s²]: predicted errors, Earth rate and gravity; `speed` the
    /// least and greatest speed over ground [m/s] that GNSS leaves possible, where there is one now.
    ///
    /// A block ends with the first sample at which it is 0.5 s long; its sums then begin again.
    /// O(1) a sample.
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
        if self.duration < 0.5 * BLOCK {
            self.first_half = (self.count, Vector3::from_fn(|i, _| self.sum[3 + i]));
        }
        if self.duration < BLOCK {
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
            Some((least, _)) if least < STANDS && halves.norm() < 3.0 * FORCE => {
                let weight = LEARN.max(1.0 / f64::from(self.learned + 1));
                for (level, s) in self.level.iter_mut().zip(scatter) {
                    *level += weight * (s - *level);
                }
                self.learned += 1;
            }
            Some((least, _)) if least > 2.0 * MOVES => self.moving = self.moving.min(relative),
            _ => {}
        }
        let limit = if self.learned > 0 { LIMIT } else { NOISE_LIMIT };
        // A drive as smooth as rest leaves no room for a limit: then only GNSS can tell.
        let quiet = relative < limit.min(0.7 * self.moving);
        let (possible, slow) = match speed {
            Some((least, greatest)) => (least < MOVES, greatest < MOVES),
            // What motion looks like must be known, unless GNSS has no speeds at all.
            None => (self.moving.is_finite() || self.learned == 0, false),
        };
        // Where the readings and GNSS say rest, the solution's biases and level may be wrong.
        let trust = if quiet && slow { UNSURE } else { 1.0 };
        let tolerance = |axis: usize| 4.0 * (self.level(axis) / n).sqrt();
        let steady = (0..3).all(|i| {
            (block_rate[i] - expected.0[i]).abs() < trust * RATE + tolerance(i)
                && (block_force[i] - expected.1[i]).abs() < trust * LEVEL + tolerance(3 + i)
                && halves[i].abs() < FORCE + 2.0 * tolerance(3 + i)
        });
        Some(RestBlock {
            rest: possible && steady && (quiet || slow),
            confirmed: slow,
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
