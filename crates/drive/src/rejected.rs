//! What a run without outages says of the fixes: those that it rejects are no reference.

use crate::{
    estimator::STAMP_ROUNDING,
    replay::{Measurement, Observer, ReplayError, Settings, replay},
};
use undrift_nav::{
    filter::{Outcome, Update},
    sample::{GnssFix, ImuSample, TruthSample},
};

/// Times of the fixes whose position or velocity a run rejected.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rejected {
    /// Times of the fixes \[s\], in order; of positions and of velocities.
    times: [Vec<f64>; 2],
}

impl Rejected {
    /// Finds them by a replay of the whole drive under these settings, without outages.
    ///
    /// # Errors
    /// As [`replay`].
    pub fn by_run(
        imu: &[ImuSample],
        aiding: &[Measurement],
        settings: &Settings,
    ) -> Result<Self, ReplayError> {
        let settings = Settings {
            outages: Vec::new(),
            nodes: None,
            ..settings.clone()
        };
        let mut rejected = Self::default();
        let samples = &mut imu.iter().copied().map(Ok);
        let measurements = &mut aiding.iter().copied().map(Ok);
        replay(samples, measurements, &settings, &mut rejected)?;
        Ok(rejected)
    }

    /// Notes whether position and velocity of the fix at this time \[s\] were rejected; in order of time.
    pub fn note(&mut self, time: f64, updates: [Option<Update>; 2]) {
        let is_rejected = |update: &Update| update.outcome == Outcome::Rejected;
        for (times, update) in self.times.iter_mut().zip(updates) {
            if update.as_ref().is_some_and(is_rejected) {
                times.push(time);
            }
        }
    }

    /// Fixes that two runs both rejected.
    #[must_use]
    pub fn by_both(&self, other: &Self) -> Self {
        let both = |k: usize| {
            let times = self.times[k].iter().copied();
            times.filter(|time| other.has(k, *time)).collect()
        };
        Self {
            times: [0, 1].map(both),
        }
    }

    fn has(&self, part: usize, time: f64) -> bool {
        let times = &self.times[part];
        let at = times.partition_point(|t| *t < time - STAMP_ROUNDING);
        times.get(at).is_some_and(|t| *t <= time + STAMP_ROUNDING)
    }

    /// The fix without what was rejected of it.
    #[must_use]
    pub fn rest(&self, fix: &GnssFix) -> GnssFix {
        GnssFix {
            position: fix.position.filter(|_| !self.has(0, fix.time)),
            velocity: fix.velocity.filter(|_| !self.has(1, fix.time)),
            ..*fix
        }
    }
}

/// Number of fixes with a position at times that `counts`, and how many of these positions are rejected.
pub fn withheld(
    aiding: &[Measurement],
    rejected: &Rejected,
    counts: impl Fn(f64) -> bool,
) -> [u64; 2] {
    let positions = aiding.iter().filter_map(|measurement| match measurement {
        Measurement::Gnss(fix) if fix.position.is_some() && counts(fix.time) => Some(fix),
        _ => None,
    });
    positions.fold([0; 2], |[all, out], fix| {
        let is_rejected = rejected.rest(fix).position.is_none();
        [all + 1, out + u64::from(is_rejected)]
    })
}

impl Observer for Rejected {
    fn updated(&mut self, time: f64, updates: [Option<Update>; 2]) {
        self.note(time, updates);
    }
}

/// Reference that errors inside outages are measured against.
#[derive(Clone, Copy, Debug)]
pub struct Reference<'a> {
    /// The truth in order of time; empty for the withheld fixes.
    pub truth: &'a [TruthSample],
    /// Withheld fixes that are no reference, since a run without outages rejects them.
    pub rejected: &'a Rejected,
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::{
        Matrix3, Vector3,
        earth::Geodetic,
        sample::{FixQuality, Position},
    };

    fn update(outcome: Outcome) -> Option<Update> {
        Some(Update {
            nis: 100.0,
            dof: 3,
            whitened: [0.0; 3],
            score: 0.0,
            information: 1.0,
            outcome,
        })
    }

    #[test]
    fn what_was_rejected_of_a_fix_is_taken_from_it() {
        let mut rejected = Rejected::default();
        rejected.note(1.0, [update(Outcome::Rejected), update(Outcome::Used)]);
        rejected.note(2.0, [update(Outcome::Weakened(4.0)), None]);
        rejected.note(3.0, [None, update(Outcome::Rejected)]);
        let fix = |time: f64| GnssFix {
            attitude: None,
            mean_velocity: None,
            time,
            position: Some((
                Position::Geodetic(Geodetic::from_degrees(45.0, 7.0, 0.0)),
                Matrix3::identity(),
            )),
            velocity: Some((Vector3::zeros(), Matrix3::identity())),
            quality: FixQuality::Unknown,
        };
        let left = |rejected: &Rejected, time: f64| {
            let rest = rejected.rest(&fix(time));
            (rest.position.is_some(), rest.velocity.is_some())
        };
        assert_eq!(
            [0.0, 1.0, 2.0, 3.0].map(|time| left(&rejected, time)),
            [(true, true), (false, true), (true, true), (true, false)]
        );
        let mut other = Rejected::default();
        other.note(1.0, [update(Outcome::Rejected), update(Outcome::Rejected)]);
        let both = rejected.by_both(&other);
        assert_eq!(left(&both, 1.0), (false, true));
        assert_eq!(left(&both, 3.0), (true, true));
    }

    fn at(time: f64) -> GnssFix {
        GnssFix::at(time, Geodetic::from_degrees(45.0, 7.0, 0.0), [1.0; 3])
    }

    #[test]
    fn a_fix_is_known_by_its_stamp_to_the_rounding_of_stamps() {
        let mut rejected = Rejected::default();
        for time in [1.0, 5.0, 9.0] {
            rejected.note(time, [update(Outcome::Rejected), None]);
        }
        for (off, is_it) in [
            (0.0, true),
            (0.9, true),
            (-0.9, true),
            (1.1, false),
            (-1.1, false),
        ] {
            let found = rejected.has(0, 5.0 + off * STAMP_ROUNDING);
            assert_eq!(found, is_it, "{off}");
        }
        assert!(!rejected.has(1, 5.0) && !rejected.has(0, 10.0) && rejected.has(0, 9.0));
    }

    #[test]
    fn withheld_positions_are_counted_with_those_that_are_rejected() {
        let mut rejected = Rejected::default();
        rejected.note(3.0, [update(Outcome::Rejected), None]);
        rejected.note(7.0, [update(Outcome::Rejected), None]);
        let mut aiding: Vec<Measurement> = (0..10)
            .map(|k| Measurement::Gnss(at(f64::from(k))))
            .collect();
        // A fix without a position does not count.
        aiding[4] = Measurement::Gnss(GnssFix {
            position: None,
            ..at(4.0)
        });
        let of =
            |from: f64, to: f64| withheld(&aiding, &rejected, |time| time >= from && time <= to);
        assert_eq!(of(0.0, 9.0), [9, 2]);
        assert_eq!(of(2.0, 5.0), [3, 1]);
        assert_eq!(of(4.0, 4.0), [0, 0]);
    }
}
