//! Whether positions alternate between two places: two receivers in one log.
//!
//! The slope from fix to fix, position difference over time, changes sign at every fix where two receivers take
//! turns. Its changes are compared with the changes one and two fixes before: of two places they are −1 and 1
//! times themselves, of one receiver's noise and of motion never both.

use super::APART;
use crate::derived::antenna;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{Vector3, earth::Geodetic, sample::GnssFix};

/// Changes of the slope from fix to fix that it takes to judge.
const LEAST: u32 = 30;
/// Autocorrelations of these changes over one fix and over two: −1 and 1 of two alternating places, −2/3 and 1/6 of white noise
/// of the positions, nearly 1 and 1 of motion.
const LAG_ONE: f64 = -0.8;
/// Autocorrelation over two fixes from which they do.
const LAG_TWO: f64 = 0.7;
/// Standard deviations as stated from which the distance matters.
const SIGMAS: f64 = 2.0;

/// What is known so far, of the horizontal positions.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Alternation {
    last: Option<(f64, Geodetic)>,
    /// Time \[s\] and displacement \[m\] to the last fix from the one before.
    step: Option<(f64, Vector3)>,
    /// The last change of the slope, and the one before \[m\].
    changes: [Option<Vector3>; 2],
    /// Sums of the products of a change with the one before, with the one before that, with itself \[m²\], and their number.
    sums: [f64; 3],
    count: u32,
    /// Sum of the stated horizontal variances \[m²\].
    stated: f64,
}

impl Alternation {
    /// Takes in a fix; one that repeats the last position is passed over.
    pub(super) fn fix(&mut self, fix: &GnssFix) {
        let (Some(place), Some((_, r))) = (antenna(fix), &fix.position) else {
            return;
        };
        if self.last.is_some_and(|(_, last)| last == place) {
            return;
        }
        let Some((time, last)) = self.last.replace((fix.time, place)) else {
            return;
        };
        let dt = fix.time - time;
        if !(dt > 0.0 && dt <= APART) {
            (self.step, self.changes) = (None, [None; 2]);
            return;
        }
        let mut moved = last.offset_to(&place);
        moved.z = 0.0;
        let Some((before, moved_before)) = self.step.replace((dt, moved)) else {
            return;
        };
        // By the slope, so that fixes at uneven times do not alternate by their motion.
        let change = (moved / dt - moved_before / before) * dt.min(before);
        if let [Some(one), Some(two)] = self.changes {
            for (sum, other) in self.sums.iter_mut().zip([one, two, change]) {
                *sum += change.dot(&other);
            }
            self.count += 1;
            self.stated += 0.5 * r.fixed_view::<2, 2>(0, 0).trace();
        }
        self.changes = [Some(change), self.changes[0]];
    }

    /// The distance between the two places \[m\], if the positions alternate between two.
    ///
    /// `None` for fewer than 30 changes, or where the distance is within two standard deviations as
    /// stated.
    pub(super) fn distance(&self) -> Option<f64> {
        let [one, two, square] = self.sums;
        let count = f64::from(self.count);
        // Places that are ±D/2 off, alternating, make changes of ±2 D.
        let distance = 0.5 * (square / count).sqrt();
        let matters = distance > SIGMAS * (self.stated / count).sqrt();
        let alternates = one < LAG_ONE * square && two > LAG_TWO * square;
        (self.count >= LEAST && alternates && matters).then_some(distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::earth::Geodetic;

    /// What is found of `count` fixes of a car that brakes and turns, at times `time(k)`, off by `off(k)` \[m\].
    fn found(count: u32, time: impl Fn(f64) -> f64, off: impl Fn(u32) -> Vector3) -> Option<f64> {
        let start = Geodetic::from_degrees(47.0, 8.0, 400.0);
        let mut all = Alternation::default();
        for k in 0..count {
            let t = time(f64::from(k));
            let moved = Vector3::new(
                12.0 * t - 40.0 * (0.05 * t).cos(),
                60.0 * (0.2 * t).sin(),
                0.0,
            );
            all.fix(&GnssFix::at(
                t,
                start.displaced(&(moved + off(k))),
                [0.02; 3],
            ));
        }
        all.distance()
    }

    fn sign(k: u32) -> f64 {
        if k.is_multiple_of(2) { 0.5 } else { -0.5 }
    }

    #[test]
    fn two_alternating_receivers_are_found_with_their_distance() {
        for (distance, hz) in [(1.0, 5.0), (5.0, 4.0), (10.0, 1.0)] {
            let off = |k| Vector3::new(0.6, -0.8, 3.0) * (distance * sign(k));
            let seen = found(120, |k| k / hz, off);
            assert!(
                seen.is_some_and(|seen| (seen / distance - 1.0).abs() < 0.1),
                "{distance}: {seen:?}"
            );
            // As few as it takes: three fixes before the first product of three changes.
            assert!(found(34, |k| k / hz, off).is_some() && found(33, |k| k / hz, off).is_none());
        }
        // By less than two stated standard deviations.
        assert_eq!(
            found(120, |k| k / 5.0, |k| Vector3::x() * (0.039 * sign(k))),
            None
        );
    }

    #[test]
    fn motion_noise_uneven_times_and_repeats_do_not_alternate() {
        let still = |_| Vector3::zeros();
        assert_eq!(found(300, |k| k, still), None);
        let uneven = |k: f64| 0.2 * k + if k % 2.0 == 0.0 { 0.05 } else { -0.05 };
        assert_eq!(found(300, uneven, still), None);
        // White: a scrambled counter.
        let white = |k: u32| {
            let value = |seed: u32| {
                f64::from(
                    k.wrapping_mul(2_654_435_761)
                        .wrapping_add(seed)
                        .rotate_left(13)
                        >> 8,
                ) / f64::from(1u32 << 24)
                    - 0.5
            };
            Vector3::new(value(1), value(77_777), 0.0) * 10.0
        };
        assert_eq!(found(1000, |k| 0.2 * k, white), None);
        // Each position twice, a tenth of a second apart.
        let twice = |k: f64| 0.2 * (k / 2.0).floor();
        let start = Geodetic::from_degrees(47.0, 8.0, 400.0);
        let mut all = Alternation::default();
        for k in 0..300 {
            let t = twice(f64::from(k));
            let place = start.displaced(&(Vector3::x() * (12.0 * t)));
            all.fix(&GnssFix::at(0.1 * f64::from(k), place, [0.02; 3]));
        }
        assert_eq!(all.distance(), None);
    }
}
