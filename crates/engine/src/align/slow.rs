//! Craft that never get as fast as the course of others says their heading: walkers, small robots, boats.

use super::{
    Aligner, Heading, HeadingSource, MOVES,
    seen::{Seen, over_ground},
};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::{ComplexField, RealField};

/// A craft that moved for so long without getting faster is slow \[s\].
const LONG: f64 = 30.0;
/// It may seem faster for this share of the time.
const SELDOM: f64 = 0.1;
/// Fixes further apart than this say nothing of the time between \[s\].
const APART: f64 = 2.5;
/// Least speed of a course \[m/s\].
const LEAST_SPEED: f64 = 0.5;
/// Side slip of such a craft, or of the hand that holds the sensor, one standard deviation \[rad\].
const SLIP: f64 = 0.5;

impl Aligner {
    /// The course as heading where the vehicle is slow, however long it has moved.
    pub(super) fn course_of_slow(&self, seen: &Seen) -> Option<(f64, f64, HeadingSource)> {
        let (velocity, covariance) = &seen.velocity;
        let across = over_ground(covariance);
        let std = self.slow.course_std(self.speed, across, certain(seen));
        let std = std.filter(|_| self.settings.heading == Heading::Course)?;
        Some((velocity.y.atan2(velocity.x), std, HeadingSource::Course))
    }
}

/// The speed that is certain to be motion \[m/s\], whether it is measured or from positions.
pub(super) fn certain(seen: &Seen) -> f64 {
    let std = match seen.noise {
        0.0 => over_ground(&seen.velocity.1),
        noise => noise,
    };
    MOVES * std
}

/// How long a craft has moved.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Slow {
    moved: f64,
    /// As fast as the course of others says their heading.
    fast: f64,
    last: Option<f64>,
}

impl Slow {
    /// Takes up the speed of a fix \[m/s\], against the `least` that is certain to be motion and that from which on the course
    /// says the heading.
    pub(super) fn add(&mut self, time: f64, speed: f64, [least, fast]: [f64; 2]) {
        let before = self.last.replace(time);
        let span = time - before.unwrap_or(time);
        if speed >= LEAST_SPEED.max(least) && span <= APART {
            self.moved += span;
            self.fast += if speed >= fast { span } else { 0.0 };
        }
    }

    /// The standard deviation of a course as heading \[rad\] where the craft is slow, at this speed \[m/s\] with the standard
    /// deviation across; `None` where that is below the `least` that is certain to be motion.
    fn course_std(&self, speed: f64, across: f64, least: f64) -> Option<f64> {
        let is_slow = self.moved >= LONG && self.fast <= SELDOM * self.moved;
        let counts = is_slow && speed >= LEAST_SPEED.max(least);
        counts.then(|| (across / speed).hypot(SLIP))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_course_of_a_slow_craft_counts_after_half_a_minute_of_motion() {
        let mut slow = Slow::default();
        for second in 0..30 {
            slow.add(f64::from(second), 1.2, [0.3, 3.0]);
            assert_eq!(slow.course_std(1.2, 0.1, 0.3), None);
        }
        // Standing does not count, nor does a gap.
        slow.add(30.0, 0.4, [0.3, 3.0]);
        slow.add(60.0, 1.2, [0.3, 3.0]);
        assert_eq!(slow.course_std(1.2, 0.1, 0.3), None);
        slow.add(61.0, 1.2, [0.3, 3.0]);
        let std = slow.course_std(1.2, 0.3, 0.3).unwrap();
        assert!((std - 0.25_f64.hypot(SLIP)).abs() < 1e-12);
        assert_eq!(slow.course_std(0.49, 0.1, 0.3), None);
        assert_eq!(slow.course_std(0.9, 0.1, 1.0), None);
        // One that is fast now and then is not slow; a single speed is an error.
        for second in 62..66 {
            assert!(slow.course_std(1.2, 0.1, 0.3).is_some());
            slow.add(f64::from(second), 3.0, [0.3, 3.0]);
        }
        assert_eq!(slow.course_std(1.2, 0.1, 0.3), None);
    }
}
