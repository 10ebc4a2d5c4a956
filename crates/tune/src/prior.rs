//! What is known before the drive: the sensor at rest, and that a vehicle never makes it quieter.

use super::{
    noise::{COUNT, FIX, Noise, RULE, Vector, WALK, WHITE},
    rest_noise::RestNoise,
};
use undrift_engine::{
    settings::{
        GnssUse, Settings,
        fix_errors::{FixErrors, StdFactors},
    },
    vehicle::NonHolonomic,
};
use undrift_nav::covariance::AXES;

/// Standard deviations to the ends of a 95 % interval.
pub const INTERVAL: f64 = 1.96;

/// Noise in a vehicle against noise at rest, the middle of what has been seen: 3 to 30 times, seldom less than once.
const LOUDER: f64 = 5.0;
/// Standard deviation of its logarithm downwards …
const LOUDER_BELOW: f64 = 0.8;
/// … and upwards, and of random walks' both ways.
const WIDE: f64 = 1.5;
/// Noise that navigation feels against that above the band of motion, where the samples show it: 0.2 to 1 times on
/// most drives.
const VIBRATING: f64 = 0.5;
/// Standard deviation of its logarithm upwards.
const VIBRATING_ABOVE: f64 = 1.0;
/// Driving noise against that of the vehicle standing with its engine running: never below, and this much above …
const DRIVING: f64 = 2.0;
/// … within so much of the logarithm downwards.
const DRIVING_BELOW: f64 = 0.4;
/// Least random walk that is expected of a sensor in a vehicle, gyro [rad/s/√s] and accelerometer [m/s²/√s].
const LEAST_WALK: [f64; 2] = [5e-6, 5e-4];
/// Standard deviation of the logarithm of what the fixes' errors are multiplied by: they have shown it themselves.
const FIX_STD: f64 = 0.2;
/// The same of poses, whose accuracy is read from their scatter: what lasts, or is smoothed, does not show there.
const POSE_STD: f64 = 1.0;
/// The same of the non-holonomic constraint.
const RULE_STD: f64 = 0.7;

/// Independent normal distributions of the logarithms, each of two halves.
#[derive(Clone, Debug)]
pub struct Prior {
    /// Most likely values.
    pub centre: Vector,
    /// Standard deviation below them.
    pub below: Vector,
    /// Standard deviation above them.
    pub above: Vector,
    /// Whether the drives have the parameter at all.
    pub used: [bool; COUNT],
}

impl Prior {
    /// Of a sensor, in drives with these settings; of white noise that follows the vibration where they say so.
    pub fn new(start: &RestNoise, drives: &[&Settings]) -> Self {
        let posed = drives.iter().any(|s| s.marker.is_some());
        let rule = drives.iter().find_map(|s| s.constraints.non_holonomic);
        let slip = rule.unwrap_or(NonHolonomic::CAR);
        let follows = drives.iter().any(|s| s.vibration.is_some());
        let idle = start.idle.unwrap_or([0.0; AXES]);
        let (louder, idle): ([f64; AXES], [f64; AXES]) = match start.vibrating {
            Some(vibrating) if follows => {
                let of_both = |i: usize| vibrating[i].max(start.white[i]);
                (
                    [VIBRATING; AXES],
                    std::array::from_fn(|i| idle[i] / of_both(i)),
                )
            }
            Some(vibrating) => {
                let louder = |i: usize| (VIBRATING * vibrating[i]).max(start.white[i]);
                (std::array::from_fn(louder), idle)
            }
            None => (start.white.map(|white| white * LOUDER), idle),
        };
        let centre = Noise {
            white: std::array::from_fn(|i| louder[i].max(idle[i] * DRIVING)),
            walk: std::array::from_fn(|i| start.walk[i].max(LEAST_WALK[i / 3])),
            factors: StdFactors::ONE,
            rule: [slip.right, slip.down, slip.slip.max(1e-3)],
        };
        let mut prior = Self {
            centre: centre.ln(),
            below: [WIDE; COUNT],
            above: [WIDE; COUNT],
            used: [true; COUNT],
        };
        if start.vibrating.is_some() {
            prior.above[WHITE..WHITE + AXES].fill(VIBRATING_ABOVE);
        }
        for i in 0..AXES {
            let heard = idle[i] * DRIVING >= louder[i];
            prior.below[WHITE + i] = if heard { DRIVING_BELOW } else { LOUDER_BELOW };
        }
        for std in [&mut prior.below, &mut prior.above] {
            std[FIX..RULE].fill(if posed { POSE_STD } else { FIX_STD });
            std[RULE..].fill(RULE_STD);
        }
        let any = |has: &dyn Fn(&Settings) -> bool| drives.iter().any(|s| has(s));
        prior.used[FIX] = any(&|s| s.gnss_use != GnssUse::Velocity);
        prior.used[FIX + 1] = any(&|s| s.gnss_use != GnssUse::Position);
        let errors = |has: fn(&FixErrors) -> bool| any(&|s: &Settings| has(&s.fix_errors));
        prior.used[FIX + 2] = errors(|errors| errors.correlated.is_some());
        prior.used[FIX + 3] = errors(|errors| errors.velocity_correlated.is_some());
        prior.used[RULE..].fill(rule.is_some());
        for i in (0..AXES).filter(|_| follows) {
            // Where the samples show no more than the sensor at rest there is nothing to follow.
            prior.used[WHITE + i] = start.shakes(i);
        }
        prior
    }

    /// Standard deviation on the side of a value.
    pub fn std(&self, i: usize, value: f64) -> f64 {
        if value < self.centre[i] {
            self.below[i]
        } else {
            self.above[i]
        }
    }

    /// 95 % interval of a logarithm before the drives.
    pub fn interval(&self, i: usize) -> (f64, f64) {
        let [below, above] = [self.below[i], self.above[i]].map(|std| INTERVAL * std);
        (self.centre[i] - below, self.centre[i] + above)
    }

    /// Minus the logarithm of the density, up to a constant, and its derivatives.
    pub fn penalty(&self, z: &Vector) -> (f64, Vector) {
        let mut value = 0.0;
        let mut slope = [0.0; COUNT];
        for i in 0..COUNT {
            let off = z[i] - self.centre[i];
            let std = self.std(i, z[i]);
            value += 0.5 * (off / std).powi(2);
            slope[i] = off / (std * std);
        }
        (value, slope)
    }
}

const _: () = assert!(WALK == WHITE + AXES && FIX == WALK + AXES);

#[cfg(test)]
mod tests;
