//! What the filter is aided with besides the samples ([`crate::aid`]), merged in time.
//!
//! Measurements wait twice: in [`Measured`] by their stamps, from where a navigator with a horizon may take
//! them again, and in [`Queue`] by when they hold, which the estimated latency of the fixes moves. A fix whose
//! velocity has a latency of its own becomes two.
//!
//! Order in time decides results; order of arrival must not. Hence [`Measured`] sorts by (stamp,
//! kind), with equal ones in order of arrival, and numbers count from the first measurement of all,
//! so that a snapshot may name the next one it needs by its number.
//!
//! A latency is that of the receiver: a fix stamped t holds at t + latency. A negative one makes
//! fixes due before their stamp, so that the queue looks ahead by that much.

pub use undrift_nav::sample::Scalar;

use super::aid::Measurement;
use alloc::collections::VecDeque;
use undrift_events::Part;
use undrift_nav::sample::GnssFix;

/// Measurements in order of time, as far as they may still be needed.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Measured {
    /// By stamp, then by kind.
    kept: VecDeque<Measurement>,
    /// How many went before the first one that is kept.
    ///
    /// Those are forgotten: nothing may ask for them any more.
    gone: u64,
}

impl Measured {
    /// Puts a measurement behind all that are as early: of one time by their [`Measurement::rank`].
    ///
    /// O(n) from the end in the worst case, O(1) for a measurement in order.
    pub(crate) fn insert(&mut self, measurement: Measurement) {
        let order = |m: &Measurement| (m.time(), m.rank());
        let (time, rank) = order(&measurement);
        let at = self.kept.iter().rposition(|kept| {
            let (before, kind) = order(kept);
            before < time || before == time && kind <= rank
        });
        self.kept.insert(at.map_or(0, |at| at + 1), measurement);
    }

    /// How many are kept.
    #[cfg(test)]
    pub(crate) fn len(&self) -> usize {
        self.kept.len()
    }

    /// The measurement of this number, counted from the first of all.
    ///
    /// `None` of one that has not come yet.
    fn get(&self, number: u64) -> Option<&Measurement> {
        self.kept.get(usize::try_from(number - self.gone).ok()?)
    }

    /// Drops those before this number.
    pub(crate) fn forget(&mut self, number: u64) {
        while self.gone < number && self.kept.pop_front().is_some() {
            self.gone += 1;
        }
    }

    /// Stamps of the fixes from this number on \[s\].
    pub(crate) fn fixes_from(&self, number: u64) -> impl Iterator<Item = f64> + '_ {
        let skipped = usize::try_from(number - self.gone).unwrap_or(usize::MAX);
        self.kept.iter().skip(skipped).filter_map(|m| match m {
            Measurement::Gnss(fix) => Some(fix.time),
            _ => None,
        })
    }
}

/// Delays of the fixes against their stamps \[s\], as estimated so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Latency {
    /// Delay of the whole fix, or of its position \[s\].
    pub(super) position: f64,
    /// Delay of the velocity where it has its own \[s\]: the two parts are then measurements of their own.
    pub(super) velocity: Option<f64>,
}

/// A measurement that is due, and which part of it where that is not all of it.
pub(super) type Due = (Measurement, Option<Part>);

/// Measurements given out by when each holds: fixes by their stamps and latencies that may change.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Queue {
    /// How many measurements were taken in, the number of the next one; and the latest stamp for which any were looked for \[s\].
    taken: u64,
    asked: f64,
    /// Whole fixes that are not due yet.
    fixes: VecDeque<GnssFix>,
    /// Fixes whose velocity was given out and whose position is still due.
    positions: VecDeque<GnssFix>,
    /// Fixes whose position was given out and whose velocity is still due.
    velocities: VecDeque<GnssFix>,
    /// Headings by the receiver's antennas, as late as its positions.
    headings: VecDeque<Scalar>,
    /// Wheel speeds and heights: due at their stamps.
    others: VecDeque<Measurement>,
    repeats: Repeats,
}

/// A receiver does not measure the same numbers twice: a fix equal to one within this time before \[s\] is that one, held
/// by the logger.
const REPEATED: f64 = 2.0;
/// A fix slower than this \[m/s\] may equal the one before: at rest positions and velocities do repeat.
const REPEATED_SPEED: f64 = 0.1;

/// Detects fixes that repeat the one before.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Repeats {
    /// The last fix that did not repeat the one before.
    last: Option<GnssFix>,
    /// Whether its position was another one than that before.
    moved: bool,
    count: u64,
}

impl Repeats {
    /// Whether a fix is the one before again.
    ///
    /// A receiver at rest may measure the same numbers twice; in motion, or with positions that moved before,
    /// equal numbers are one fix that was logged again.
    ///
    /// Compared are position and velocity to the last digit, within 2 s; covariances and attitudes
    /// are not.
    pub(crate) fn is(&mut self, fix: &GnssFix) -> bool {
        let again = self.last.is_some_and(|last| {
            let position = last.position.map(|p| p.0) == fix.position.map(|p| p.0);
            let velocity = last.velocity.map(|v| v.0) == fix.velocity.map(|v| v.0);
            let moves = fix
                .velocity
                .map_or(self.moved, |(v, _)| v.norm() > REPEATED_SPEED);
            fix.position.is_some()
                && position
                && velocity
                && moves
                && fix.time - last.time < REPEATED
        });
        if !again {
            let positions = self
                .last
                .and_then(|last| Some((last.position?.0, fix.position?.0)));
            self.moved = positions.is_some_and(|(a, b)| a != b);
            self.last = Some(*fix);
        }
        self.count += u64::from(again);
        again
    }

    /// How many did so far.
    pub(crate) fn count(&self) -> u64 {
        self.count
    }
}

impl Queue {
    pub(super) fn new() -> Self {
        Self {
            taken: 0,
            asked: f64::NEG_INFINITY,
            fixes: VecDeque::new(),
            positions: VecDeque::new(),
            velocities: VecDeque::new(),
            headings: VecDeque::new(),
            others: VecDeque::new(),
            repeats: Repeats::default(),
        }
    }

    /// How many measurements were taken in.
    pub(super) fn taken(&self) -> u64 {
        self.taken
    }

    /// The latest stamp for which measurements were looked for \[s\]: one of that time or before comes too late.
    pub(super) fn asked(&self) -> f64 {
        self.asked
    }

    /// The next measurement that holds at `time` \[s\] or before.
    ///
    /// With the part that it is of, where the fix was cut in two. Repeated fixes are counted and passed over.
    ///
    /// Measurements due at the same time come in the order headings, whole fixes, positions, velocities,
    /// others. Called until it gives `None` for a `time`.
    pub(super) fn next_until(
        &mut self,
        time: f64,
        latency: Latency,
        measured: &Measured,
    ) -> Option<Due> {
        let earliest = latency.velocity.unwrap_or(0.0).min(latency.position);
        let ahead = time - earliest.min(0.0);
        self.asked = self.asked.max(ahead);
        while let Some(next) = measured.get(self.taken)
            && next.time() <= ahead
        {
            self.taken += 1;
            match next {
                Measurement::Gnss(fix) if self.repeats.is(fix) => {}
                Measurement::Gnss(fix) => self.fixes.push_back(*fix),
                Measurement::Heading(heading) => self.headings.push_back(*heading),
                other => self.others.push_back(*other),
            }
        }
        if latency.velocity.is_some() {
            for fix in core::mem::take(&mut self.fixes) {
                if fix.mean_velocity.is_some() {
                    // Of one instant: the phases do not have the delay of the receiver's own velocities.
                    self.fixes.push_back(fix);
                    continue;
                }
                if fix.position.is_some() || fix.velocity.is_none() {
                    self.positions.push_back(fix);
                }
                if fix.velocity.is_some() {
                    self.velocities.push_back(fix);
                }
            }
        }
        let fixes = [&self.fixes, &self.positions, &self.velocities];
        let rest = self.others.is_empty() && self.headings.is_empty();
        if rest && fixes.iter().all(|fixes| fixes.is_empty()) {
            return None;
        }
        let stamp = |fixes: &VecDeque<GnssFix>| fixes.front().map(|fix| fix.time);
        let later = |stamp: Option<f64>, by: f64| stamp.map_or(f64::INFINITY, |time| time + by);
        // What is left of the parts when a solution ends goes on as before.
        let apart = latency.velocity.unwrap_or(latency.position);
        let due = [
            // Before a fix of the same time, which may align with it.
            later(self.headings.front().map(|h| h.time), latency.position),
            later(stamp(&self.fixes), latency.position),
            later(stamp(&self.positions), latency.position),
            later(stamp(&self.velocities), apart),
            later(self.others.front().map(Measurement::time), 0.0),
        ];
        let first = (0..due.len()).min_by(|a, b| due[*a].total_cmp(&due[*b]))?;
        if due[first] > time {
            return None;
        }
        let part = |fix, part| (Measurement::Gnss(fix), part);
        match first {
            0 => {
                let heading = self.headings.pop_front();
                heading.map(|heading| (Measurement::Heading(heading), None))
            }
            1 => self.fixes.pop_front().map(|fix| part(fix, None)),
            2 => {
                let fix = self.positions.pop_front();
                fix.map(|fix| part(fix, Some(Part::Position)))
            }
            3 => {
                let fix = self.velocities.pop_front();
                fix.map(|fix| part(fix, Some(Part::Velocity)))
            }
            _ => self.others.pop_front().map(|other| (other, None)),
        }
    }

    /// Fixes so far that were the one before again.
    pub(super) fn repeated(&self) -> u64 {
        self.repeats.count()
    }

    /// Stamps of the fixes that were taken in and not given out \[s\].
    pub(super) fn fixes(&self) -> impl Iterator<Item = f64> + '_ {
        self.fixes.iter().map(|fix| fix.time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn fixes_are_given_out_at_their_stamps_and_the_offset() {
        let fix = |time| {
            Measurement::Gnss(GnssFix {
                attitude: None,
                mean_velocity: None,
                time,
                position: None,
                velocity: None,
                quality: Default::default(),
            })
        };
        let speed = |time| {
            Measurement::Odometer(Scalar {
                time,
                value: 0.0,
                std: 1.0,
            })
        };
        let order = |offset| {
            let items = [fix(1.0), speed(1.1), speed(1.3), fix(2.0), speed(2.1)];
            let mut queue = Queue::new();
            let mut measured = Measured::default();
            items.into_iter().for_each(|item| measured.insert(item));
            let mut seen = Vec::new();
            let latency = Latency {
                position: offset,
                velocity: None,
            };
            for time in [1.05, 1.2, 1.75, 9.0] {
                while let Some((m, _)) = queue.next_until(time, latency, &measured) {
                    seen.push(m.time());
                }
                seen.push(0.0);
            }
            seen
        };
        assert_eq!(order(0.0), [1.0, 0.0, 1.1, 0.0, 1.3, 0.0, 2.0, 2.1, 0.0]);
        assert_eq!(order(0.2), [0.0, 1.1, 1.0, 0.0, 1.3, 0.0, 2.1, 2.0, 0.0]);
        assert_eq!(order(-0.3), [1.0, 0.0, 1.1, 0.0, 1.3, 2.0, 0.0, 2.1, 0.0]);
    }

    #[test]
    fn parts_of_a_fix_hold_at_their_own_times() {
        let fix = |time| {
            Measurement::Gnss(GnssFix {
                attitude: None,
                mean_velocity: None,
                time,
                position: Some((
                    undrift_nav::sample::Position::Geodetic(Default::default()),
                    undrift_nav::Matrix3::identity(),
                )),
                velocity: Some((Default::default(), undrift_nav::Matrix3::identity())),
                quality: Default::default(),
            })
        };
        let mut queue = Queue::new();
        let mut measured = Measured::default();
        measured.insert(fix(1.0));
        measured.insert(fix(2.0));
        let latency = Latency {
            position: 0.2,
            velocity: Some(-0.1),
        };
        let mut next = |time: f64| {
            let due = queue.next_until(time, latency, &measured);
            due.map(|(m, part)| (m.time(), part))
        };
        assert_eq!(next(0.85), None);
        assert_eq!(next(0.95), Some((1.0, Some(Part::Velocity))));
        assert_eq!(next(1.15), None);
        assert_eq!(next(5.0), Some((1.0, Some(Part::Position))));
        assert_eq!(next(5.0), Some((2.0, Some(Part::Velocity))));
        assert_eq!(next(5.0), Some((2.0, Some(Part::Position))));
        assert_eq!(next(5.0), None);
    }

    #[test]
    fn measurements_lie_in_order_of_time_and_kind() {
        let scalar = |time, value| Scalar {
            time,
            value,
            std: 1.0,
        };
        let mut measured = Measured::default();
        measured.insert(Measurement::Barometer(scalar(2.0, 0.0)));
        measured.insert(Measurement::Odometer(scalar(2.0, 1.0)));
        measured.insert(Measurement::Odometer(scalar(1.0, 0.0)));
        measured.insert(Measurement::Odometer(scalar(2.0, 2.0)));
        let seen = |number| match measured.get(number)? {
            Measurement::Odometer(s) => Some((s.time, s.value, true)),
            other => Some((other.time(), 0.0, false)),
        };
        let expected = [(1.0, 0.0, true), (2.0, 1.0, true), (2.0, 2.0, true)];
        assert_eq!([0, 1, 2].map(|k| seen(k).unwrap()), expected);
        assert_eq!((seen(3), seen(4)), (Some((2.0, 0.0, false)), None));
    }
}
