//! Positions and velocities of two topics as fixes in the order of their times.

use std::collections::VecDeque;

use undrift_nav::sample::FixQuality;

use crate::entry::Fix;

/// Fixes that wait for their other half or an earlier one: recordings are in the order of receipt,
/// which differs by a message or two.
const WAITING: usize = 8;

/// Fixes that wait, by time.
#[derive(Debug, Default)]
pub(super) struct Waiting(VecDeque<(u64, Fix)>);

impl Waiting {
    /// Takes the position or velocity of message `at` of a log that is read while it comes, and gives the earliest fix if it is
    /// whole or something newer has come: a position alone where no topic has velocities.
    pub(super) fn add_live(
        &mut self,
        at: u64,
        fix: Fix,
        has_velocities: bool,
    ) -> Option<(u64, Fix)> {
        let earliest = self.add(at, fix);
        let is_whole = |fix: &Fix| fix.position.is_some() && fix.velocity.is_some();
        let goes = self.0.len() > 1
            || self
                .0
                .front()
                .is_some_and(|(_, fix)| !has_velocities || is_whole(fix));
        earliest.or_else(|| goes.then(|| self.next()).flatten())
    }

    /// Takes the position or velocity of message `at`, and gives the earliest fix if enough wait.
    pub(super) fn add(&mut self, at: u64, fix: Fix) -> Option<(u64, Fix)> {
        let place = self.0.partition_point(|(_, other)| other.time < fix.time);
        match self.0.get_mut(place) {
            Some((_, other)) if other.time == fix.time && complement(other, &fix) => {
                other.position = other.position.or(fix.position);
                other.velocity = other.velocity.or(fix.velocity);
                if other.quality == FixQuality::Unknown {
                    other.quality = fix.quality;
                }
            }
            _ => self.0.insert(place, (at, fix)),
        }
        if self.0.len() > WAITING {
            self.next()
        } else {
            None
        }
    }

    /// The earliest.
    pub(super) fn next(&mut self) -> Option<(u64, Fix)> {
        self.0.pop_front()
    }
}

fn complement(a: &Fix, b: &Fix) -> bool {
    a.position.is_some() != b.position.is_some() && a.velocity.is_some() != b.velocity.is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::Vector3;
    use undrift_nav::earth::Geodetic;
    use undrift_nav::sample::Position;

    fn fix(time: f64, with_position: bool) -> Fix {
        let place = Position::Geodetic(Geodetic::from_degrees(48.0, 11.0, 500.0));
        Fix {
            mean_velocity: None,
            time,
            position: with_position.then_some((place, None)),
            velocity: (!with_position).then_some((Vector3::x(), None)),
            quality: if with_position {
                FixQuality::Single
            } else {
                FixQuality::Unknown
            },
        }
    }

    /// A receiver's fix must not wait for those of the next eight seconds.
    #[test]
    fn live_a_fix_waits_for_its_velocity_alone() {
        let times = |given: Option<(u64, Fix)>| given.map(|(_, fix)| fix.time);
        let mut waiting = Waiting::default();
        assert_eq!(times(waiting.add_live(1, fix(1.0, true), false)), Some(1.0));
        // From here on there are velocities.
        assert_eq!(times(waiting.add_live(2, fix(2.0, true), true)), None);
        let (at, whole) = waiting.add_live(3, fix(2.0, false), true).unwrap();
        assert!(at == 2 && whole.position.is_some() && whole.velocity.is_some());
        // One that never comes costs its own fix an epoch.
        assert_eq!(times(waiting.add_live(4, fix(3.0, true), true)), None);
        assert_eq!(times(waiting.add_live(5, fix(4.0, true), true)), Some(3.0));
        assert_eq!(times(waiting.next()), Some(4.0));
    }

    #[test]
    fn halves_meet_and_disorder_is_mended() {
        let mut waiting = Waiting::default();
        let mut out = Vec::new();
        // Velocities come before positions or after them, a pair late; one position is alone.
        let order = [
            (1.0, false),
            (1.0, true),
            (3.0, true),
            (2.0, true),
            (2.0, false),
        ];
        for (at, (time, with_position)) in order.into_iter().enumerate() {
            out.extend(waiting.add(at as u64, fix(time, with_position)));
        }
        // A position that comes twice stays two.
        for time in [4.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0] {
            out.extend(waiting.add(9, fix(time, true)));
        }
        assert_eq!(out.len(), 11 - WAITING);
        out.extend(std::iter::from_fn(|| waiting.next()));
        let times: Vec<f64> = out.iter().map(|(_, fix)| fix.time).collect();
        assert_eq!(times, [1., 2., 3., 4., 4., 5., 6., 7., 8., 9., 10.]);
        let whole = |fix: &Fix| fix.position.is_some() && fix.velocity.is_some();
        let both: Vec<bool> = out.iter().map(|(_, fix)| whole(fix)).collect();
        assert_eq!(both[..4], [true, true, false, false]);
        assert_eq!(out[0].1.quality, FixQuality::Single);
    }
}
