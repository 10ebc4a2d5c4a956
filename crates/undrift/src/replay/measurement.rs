//! What the filter is aided with besides the samples: fixes, wheel speeds, barometric heights, merged in time.

pub use undrift_nav::sample::Scalar;

use super::events::Part;
use crate::settings::ReceiverSettings;
use std::collections::VecDeque;
use undrift_nav::sample::GnssFix;

/// One measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "passed on one by one; in memory most are fixes"
)]
pub enum Measurement {
    /// A GNSS fix.
    Gnss(GnssFix),
    /// Speed of a wheel, forward positive [m/s].
    Odometer(Scalar),
    /// Height by the barometer \[m\].
    Barometer(Scalar),
}

impl Measurement {
    /// Fixes as measurements.
    pub fn of_fixes(fixes: &[GnssFix]) -> Vec<Self> {
        fixes.iter().copied().map(Self::Gnss).collect()
    }

    /// Time as stamped \[s\].
    pub fn time(&self) -> f64 {
        match self {
            Self::Gnss(fix) => fix.time,
            Self::Odometer(s) | Self::Barometer(s) => s.time,
        }
    }
}

/// Two streams, each in order of time, as one. An error is passed on where it stands.
pub fn merge<E>(
    first: impl Iterator<Item = Result<Measurement, E>>,
    second: impl Iterator<Item = Result<Measurement, E>>,
) -> impl Iterator<Item = Result<Measurement, E>> {
    let (mut first, mut second) = (first.peekable(), second.peekable());
    std::iter::from_fn(move || match (first.peek(), second.peek()) {
        (Some(Ok(a)), Some(Ok(b))) if b.time() < a.time() => second.next(),
        (None, Some(_)) | (Some(Ok(_)), Some(Err(_))) => second.next(),
        _ => first.next(),
    })
}

/// By how much fixes hold later than their stamps \[s\], as estimated so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Latency {
    /// Of the whole fix, or of its position.
    pub(super) position: f64,
    /// Of its velocity, where that has its own: the two parts are then measurements of their own.
    pub(super) velocity: Option<f64>,
}

/// A measurement that is due, and which part of it where that is not all of it.
pub(super) type Due = (Measurement, Option<Part>);

/// A merged stream given out by when each measurement holds: fixes by their stamps and latencies
/// that may change.
pub(super) struct Queue<I: Iterator> {
    stream: std::iter::Peekable<std::iter::Fuse<I>>,
    fixes: VecDeque<GnssFix>,
    /// Fixes of which the other part was given out.
    positions: VecDeque<GnssFix>,
    velocities: VecDeque<GnssFix>,
    others: VecDeque<Measurement>,
    repeats: Repeats,
}

/// Tells fixes that repeat the one before.
#[derive(Default)]
pub(crate) struct Repeats {
    set: ReceiverSettings,
    /// The last fix that did not repeat the one before.
    last: Option<GnssFix>,
    /// Whether its position was another one than that before.
    moved: bool,
    count: u64,
}

impl Repeats {
    pub(crate) fn new(set: ReceiverSettings) -> Self {
        Self {
            set,
            ..Self::default()
        }
    }

    /// Whether a fix is the one before again.
    pub(crate) fn is(&mut self, fix: &GnssFix) -> bool {
        let again = self.last.is_some_and(|last| {
            let position = last.position.map(|p| p.0) == fix.position.map(|p| p.0);
            let velocity = last.velocity.map(|v| v.0) == fix.velocity.map(|v| v.0);
            let moves = fix
                .velocity
                .map_or(self.moved, |(v, _)| v.norm() > self.set.repeated_speed);
            fix.position.is_some()
                && position
                && velocity
                && moves
                && fix.time - last.time < self.set.repeated
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

impl<E, I: Iterator<Item = Result<Measurement, E>>> Queue<I> {
    pub(super) fn new(stream: I, set: ReceiverSettings) -> Self {
        Self {
            stream: stream.fuse().peekable(),
            fixes: VecDeque::new(),
            positions: VecDeque::new(),
            velocities: VecDeque::new(),
            others: VecDeque::new(),
            repeats: Repeats::new(set),
        }
    }

    /// The next measurement that holds at `time` \[s\] or before.
    pub(super) fn next_until(&mut self, time: f64, latency: Latency) -> Option<Result<Due, E>> {
        let earliest = latency.velocity.unwrap_or(0.0).min(latency.position);
        let ahead = time - earliest.min(0.0);
        let is_due = |m: &Result<Measurement, E>| m.as_ref().map_or(true, |m| m.time() <= ahead);
        // `next_if` would move the measurement to look at it.
        while self.stream.peek().is_some_and(is_due) {
            match self.stream.next() {
                Some(Ok(Measurement::Gnss(fix))) if self.repeats.is(&fix) => {}
                Some(Ok(Measurement::Gnss(fix))) => self.fixes.push_back(fix),
                Some(Ok(other)) => self.others.push_back(other),
                Some(Err(error)) => return Some(Err(error)),
                None => {}
            }
        }
        if latency.velocity.is_some() {
            for fix in self.fixes.drain(..) {
                if fix.position.is_some() || fix.velocity.is_none() {
                    self.positions.push_back(fix);
                }
                if fix.velocity.is_some() {
                    self.velocities.push_back(fix);
                }
            }
        }
        let fixes = [&self.fixes, &self.positions, &self.velocities];
        if self.others.is_empty() && fixes.iter().all(|fixes| fixes.is_empty()) {
            return None;
        }
        let stamp = |fixes: &VecDeque<GnssFix>| fixes.front().map(|fix| fix.time);
        let later = |stamp: Option<f64>, by: f64| stamp.map_or(f64::INFINITY, |time| time + by);
        // What is left of the parts when a solution ends goes on as before.
        let apart = latency.velocity.unwrap_or(latency.position);
        let due = [
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
        let next = match first {
            0 => self.fixes.pop_front().map(|fix| part(fix, None)),
            1 => {
                let fix = self.positions.pop_front();
                fix.map(|fix| part(fix, Some(Part::Position)))
            }
            2 => {
                let fix = self.velocities.pop_front();
                fix.map(|fix| part(fix, Some(Part::Velocity)))
            }
            _ => self.others.pop_front().map(|other| (other, None)),
        };
        next.map(Ok)
    }

    /// Fixes so far that were the one before again.
    pub(super) fn repeated(&self) -> u64 {
        self.repeats.count()
    }

    /// Takes the next fix, whenever it comes, and gives its time \[s\].
    pub(super) fn next_fix(&mut self) -> Option<f64> {
        let held = self.fixes.pop_front().map(|fix| fix.time);
        held.or_else(|| {
            self.stream.find_map(|m| match m {
                Ok(Measurement::Gnss(fix)) => Some(fix.time),
                _ => None,
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixes_are_given_out_at_their_stamps_and_the_offset() {
        let fix = |time| {
            Ok::<_, ()>(Measurement::Gnss(GnssFix {
                time,
                position: None,
                velocity: None,
                quality: Default::default(),
            }))
        };
        let speed = |time| {
            Ok(Measurement::Odometer(Scalar {
                time,
                value: 0.0,
                std: 1.0,
            }))
        };
        let order = |offset| {
            let items = [fix(1.0), speed(1.1), speed(1.3), fix(2.0), speed(2.1)];
            let mut queue = Queue::new(items.into_iter(), ReceiverSettings::default());
            let mut seen = Vec::new();
            let latency = Latency {
                position: offset,
                velocity: None,
            };
            for time in [1.05, 1.2, 1.75, 9.0] {
                while let Some(Ok((m, _))) = queue.next_until(time, latency) {
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
            Ok::<_, ()>(Measurement::Gnss(GnssFix {
                time,
                position: Some((
                    undrift_nav::sample::Position::Geodetic(Default::default()),
                    undrift_nav::Matrix3::identity(),
                )),
                velocity: Some((Default::default(), undrift_nav::Matrix3::identity())),
                quality: Default::default(),
            }))
        };
        let mut queue = Queue::new(
            [fix(1.0), fix(2.0)].into_iter(),
            ReceiverSettings::default(),
        );
        let latency = Latency {
            position: 0.2,
            velocity: Some(-0.1),
        };
        let mut next = |time: f64| {
            let due = queue.next_until(time, latency);
            due.map(|due| due.map(|(m, part)| (m.time(), part)))
        };
        assert_eq!(next(0.85), None);
        assert_eq!(next(0.95), Some(Ok((1.0, Some(Part::Velocity)))));
        assert_eq!(next(1.15), None);
        assert_eq!(next(5.0), Some(Ok((1.0, Some(Part::Position)))));
        assert_eq!(next(5.0), Some(Ok((2.0, Some(Part::Velocity)))));
        assert_eq!(next(5.0), Some(Ok((2.0, Some(Part::Position)))));
        assert_eq!(next(5.0), None);
    }

    #[test]
    fn merged_in_time() {
        let at = |time| {
            Ok::<_, ()>(Measurement::Odometer(Scalar {
                time,
                value: 0.0,
                std: 1.0,
            }))
        };
        let times = |items: Vec<Result<Measurement, ()>>| -> Vec<f64> {
            items
                .into_iter()
                .map(|m| m.map_or(-1.0, |m| m.time()))
                .collect()
        };
        let both = merge(
            [1.0, 2.0, 5.0].map(at).into_iter(),
            [0.5, 2.0, 3.0, 7.0].map(at).into_iter(),
        );
        assert_eq!(times(both.collect()), [0.5, 1.0, 2.0, 2.0, 3.0, 5.0, 7.0]);
        let broken = merge(
            [at(1.0), Err(())].into_iter(),
            [at(0.0), at(4.0)].into_iter(),
        );
        assert_eq!(times(broken.collect()), [0.0, 1.0, -1.0, 4.0]);
    }
}
