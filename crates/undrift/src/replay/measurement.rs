//! What the filter is aided with besides the samples: fixes, wheel speeds, barometric heights, merged in time.

pub use undrift_nav::sample::Scalar;

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

/// A merged stream given out by when each measurement holds: fixes by their stamps and an offset
/// that may change.
pub(super) struct Queue<I: Iterator> {
    stream: std::iter::Peekable<std::iter::Fuse<I>>,
    fixes: VecDeque<GnssFix>,
    others: VecDeque<Measurement>,
}

impl<E, I: Iterator<Item = Result<Measurement, E>>> Queue<I> {
    pub(super) fn new(stream: I) -> Self {
        Self {
            stream: stream.fuse().peekable(),
            fixes: VecDeque::new(),
            others: VecDeque::new(),
        }
    }

    /// The next measurement that holds at `time` \[s\] or before, where fixes hold `offset` \[s\] after
    /// their stamps.
    pub(super) fn next_until(&mut self, time: f64, offset: f64) -> Option<Result<Measurement, E>> {
        let ahead = time - offset.min(0.0);
        while let Some(next) = self
            .stream
            .next_if(|m| m.as_ref().map_or(true, |m| m.time() <= ahead))
        {
            match next {
                Ok(Measurement::Gnss(fix)) => self.fixes.push_back(fix),
                Ok(other) => self.others.push_back(other),
                error => return Some(error),
            }
        }
        let fix = self.fixes.front().map(|fix| fix.time + offset);
        let other = self.others.front().map(Measurement::time);
        let fix_first = fix.is_some_and(|fix| other.is_none_or(|other| fix <= other));
        if fix_first && fix <= Some(time) {
            self.fixes.pop_front().map(|fix| Ok(Measurement::Gnss(fix)))
        } else if !fix_first && other <= Some(time) {
            self.others.pop_front().map(Ok)
        } else {
            None
        }
    }

    /// Time of the next fix, whenever it comes \[s\].
    pub(super) fn next_fix(&mut self) -> Option<f64> {
        let held = self.fixes.front().map(|fix| fix.time);
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
            let mut queue = Queue::new(items.into_iter());
            let mut seen = Vec::new();
            for time in [1.05, 1.2, 1.75, 9.0] {
                while let Some(Ok(m)) = queue.next_until(time, offset) {
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
