//! What the fixes of a window say of the antenna: velocities, or positions alone.
//!
//! Positions state what they are wrong by in all; what a window needs is what they scatter by from one to the
//! next, since an error that is common to all of them moves the window as a whole. Where the positions show
//! that scatter, it is taken, but never more than stated.
//!
//! Frames: `place` is in n at the first fix, north-east-down \[m\]; velocities in n at the fix;
//! over a window of a minute the difference of these frames is far below the noise.

use super::seen::over_ground;
use crate::{
    derived::{antenna, white_variance},
    estimator::STAMP_ROUNDING,
};
use alloc::{collections::VecDeque, vec::Vec};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{Vector3, sample::GnssFix};

/// Positions that a velocity about one of them is read from lie no further from it than this \[s\].
const NEAR: f64 = 1.1;
/// Least share of their stated variance that positions have in the search: nothing is exact.
const LEAST_SHARE: f64 = 4e-4;
/// Standard deviation of a position without information \[m\].
const NOTHING: f64 = 1e6;

/// How far apart the velocities of a search must be \[m/s\].
const SPREAD: f64 = 1.0;
/// Spread that velocities of positions alone must have \[m/s\]: slow craft have such receivers …
const SPREAD_OF_POSITIONS: f64 = 0.5;
/// … and, of those that are certain, in standard deviations of the velocities.
const CLEAR: f64 = 10.0;

/// What a fix says of the antenna.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sighting {
    /// When it holds, by its stamp and the delay assumed \[s\].
    pub(super) time: f64,
    /// Velocity [m/s]; where positions are what is measured, about.
    pub(super) v_n: Vector3,
    /// How the velocities change about it [m/s²], where they are what is measured.
    pub(super) accel: Vector3,
    /// Position in `n` against the first \[m\], where that is measured.
    pub(super) place: Vector3,
    /// Variances of what is measured.
    pub(super) variance: Vector3,
    /// Standard deviation of the velocity along an axis over ground \[m/s\].
    pub(super) speed_std: f64,
}

/// What the fixes of a window say: their velocities, or of positions `alone` their places, with the variance that they show by
/// their scatter times `looser`, at most what they state.
///
/// `looser` is 1, 10 or 100 ([`super::motion`]). Velocities about a position are read from the
/// fixes up to 1.1 s on either side; they serve for the spread, the Coriolis terms and a first
/// guess, not as measurements.
pub(super) fn sightings(fixes: &VecDeque<GnssFix>, alone: bool, looser: f64) -> Vec<Sighting> {
    if !alone {
        let velocity = |fix: &GnssFix| {
            fix.velocity.map(|(v_n, covariance)| Sighting {
                time: fix.time,
                v_n,
                variance: covariance.diagonal(),
                speed_std: over_ground(&covariance),
                ..Sighting::default()
            })
        };
        let mut seen: Vec<Sighting> = fixes.iter().filter_map(velocity).collect();
        for k in 0..seen.len() {
            let near = |of: &usize| (seen[*of].time - seen[k].time).abs() < NEAR;
            let from = seen[Some(k.saturating_sub(1)).filter(near).unwrap_or(k)];
            let to = seen[Some((k + 1).min(seen.len() - 1)).filter(near).unwrap_or(k)];
            if to.time > from.time {
                seen[k].accel = (to.v_n - from.v_n) / (to.time - from.time);
            }
        }
        return seen;
    }
    let Some(first) = fixes.front().and_then(antenna) else {
        return Vec::new();
    };
    let position = |fix: &GnssFix| {
        Some(Sighting {
            time: fix.time,
            place: first.offset_to(&antenna(fix)?),
            variance: fix.position?.1.diagonal(),
            ..Sighting::default()
        })
    };
    let mut seen: Vec<Sighting> = fixes.iter().filter_map(position).collect();
    let track: Vec<(f64, Vector3)> = seen.iter().map(|s| (s.time, s.place)).collect();
    // What is common to all of them is no matter here: where it is shown, their white part alone counts.
    let white = white_variance(&track);
    let (mut from, mut to) = (0, 0);
    for (k, of) in seen.iter_mut().enumerate() {
        while of.time - track[from].0 > NEAR && from < k {
            from += 1;
        }
        while to + 1 < track.len() && (track[to + 1].0 - of.time <= NEAR || to < k) {
            to += 1;
        }
        let ((begin, here), (end, there)) = (track[from], track[to]);
        if end > begin {
            of.v_n = (there - here) / (end - begin);
        }
        if let Some(white) = white {
            let least = white.sup(&(of.variance * LEAST_SHARE));
            of.variance = (least * looser).inf(&of.variance);
        }
        // Of two positions.
        of.speed_std = (of.variance.xy().sum()).sqrt() / (end - begin);
    }
    seen
}

/// Positions that hold `late` \[s\] after their stamps, those after the window's `end` \[s\] excluded; the last sighting is
/// that end, without information.
///
/// The end has to stay where the window ends, since that is where the filter begins; its variance
/// of 10¹² m² says nothing.
pub(super) fn held_late(seen: &[Sighting], late: f64, end: f64) -> Vec<Sighting> {
    let held = seen.iter().map(|of| Sighting {
        time: of.time + late,
        ..*of
    });
    let mut held: Vec<Sighting> = held.filter(|of| of.time < end - STAMP_ROUNDING).collect();
    let last = held.last().copied().unwrap_or_default();
    held.push(Sighting {
        time: end,
        variance: Vector3::repeat(NOTHING * NOTHING),
        ..last
    });
    held
}

/// How far apart velocities are over ground: the diagonal of the box that holds them \[m/s\].
///
/// A vehicle that drives straight at one speed has none, whatever the speed: then the velocities fit any heading.
pub(super) fn spread(seen: &[Sighting]) -> f64 {
    let wide = Vector3::repeat(f64::INFINITY);
    let (low, high) = seen.iter().fold((wide, -wide), |(low, high), fix| {
        (low.inf(&fix.v_n), high.sup(&fix.v_n))
    });
    (high - low).xy().norm()
}

/// How far apart velocities, or those of positions `alone`, have to be for a search to be worth it \[m/s\].
pub(super) fn least_spread(seen: &[Sighting], alone: bool) -> f64 {
    let worst = seen.iter().map(|of| of.speed_std).fold(0.0, f64::max);
    match alone {
        true => SPREAD_OF_POSITIONS.min(CLEAR * worst),
        false => SPREAD,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use undrift_nav::{Matrix3, earth::Geodetic};

    const PLACE: Geodetic = Geodetic {
        lat: 0.8,
        lon: 0.1,
        height: 300.0,
    };

    fn fix(time: f64, ned: Vector3, std: f64) -> GnssFix {
        GnssFix::at(time, PLACE.displaced(&ned), [std; 3])
    }

    #[test]
    fn velocities_are_taken_as_they_are_measured() {
        let with = |time: f64, v_n: Vector3| GnssFix {
            velocity: Some((v_n, Matrix3::from_diagonal(&Vector3::new(0.1, 0.2, 0.3)))),
            ..fix(time, Vector3::zeros(), 1.0)
        };
        let (a, b) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(4.0, -2.0, 9.0));
        let fixes = VecDeque::from([with(1.0, a), fix(2.0, a, 1.0), with(3.0, b)]);
        let seen = sightings(&fixes, false, 4.0);
        assert_eq!(seen.len(), 2);
        assert_eq!(
            (seen[0].time, seen[0].v_n, seen[1].time, seen[1].v_n),
            (1.0, a, 3.0, b)
        );
        assert_eq!(seen[1].variance, Vector3::new(0.1, 0.2, 0.3));
        assert_eq!(seen[1].place, Vector3::zeros());
        // 3 and 4 m/s over ground; down does not count.
        assert_eq!(spread(&seen), 5.0);
        assert_eq!(spread(&seen[..1]), 0.0);
    }

    #[test]
    fn of_positions_alone_the_velocity_is_that_of_the_second_around_each() {
        // North with the square of the time, every half second.
        let place = |t: f64| Vector3::new(t * t, 2.0 * t, 0.0);
        let times: Vec<f64> = (0..9).map(|k| 0.5 * f64::from(k)).collect();
        let fixes: VecDeque<GnssFix> = times
            .iter()
            .map(|t| fix(10.0 + t, place(*t), 2.0))
            .collect();
        let seen = sightings(&fixes, true, 1.0);
        assert_eq!(seen.len(), 9);
        for (k, (of, t)) in seen.iter().zip(&times).enumerate() {
            assert_eq!(of.time, 10.0 + t);
            // Against the first, to the rounding of an angle.
            assert!((of.place - place(*t)).norm() < 1e-6, "{k}");
            // From 1.1 s before at most to 1.1 s after: two fixes on either side.
            let (from, to) = (times[k.saturating_sub(2)], times[(k + 2).min(8)]);
            let slope = (place(to) - place(from)) / (to - from);
            assert!((of.v_n - slope).norm() < 1e-6, "{k}: {}", of.v_n);
            // Too few for their scatter: what is stated.
            assert_eq!(of.variance, Vector3::repeat(4.0));
        }
        // Further apart they say nothing of a velocity.
        let far: VecDeque<GnssFix> = [0.0, 2.0, 4.0].map(|t| fix(t, place(t), 2.0)).into();
        let seen = sightings(&far, true, 1.0);
        assert!(seen.len() == 3 && seen.iter().all(|of| of.v_n == Vector3::zeros()));
        assert!(sightings(&VecDeque::new(), true, 1.0).is_empty());
    }

    #[test]
    fn positions_count_by_their_scatter_at_most_by_what_they_state() {
        // 0.1 m up and down in turn: third differences of 0.8 m, half of Σ of whose coefficients' squares, 20.
        let sign = |k: i32| if k % 2 == 0 { 0.1 } else { -0.1 };
        let fixes: VecDeque<GnssFix> = (0..60)
            .map(|k| fix(f64::from(k), Vector3::new(0.0, 0.0, sign(k)), 5.0))
            .collect();
        let track: Vec<(f64, Vector3)> = (0..60)
            .map(|k| (f64::from(k), Vector3::new(0.0, 0.0, sign(k))))
            .collect();
        let white = white_variance(&track).unwrap();
        assert!(white.z > 0.01);
        for looser in [1.0, 9.0] {
            let seen = sightings(&fixes, true, looser);
            for of in &seen {
                // North and east do not scatter: a fiftieth of the stated standard deviation.
                assert!((of.variance.x / (25.0 * LEAST_SHARE * looser) - 1.0).abs() < 1e-6);
                assert!(
                    (of.variance.z / (white.z * looser) - 1.0).abs() < 1e-3,
                    "{}",
                    of.variance
                );
            }
        }
        let stated = sightings(&fixes, true, 1e6);
        assert!(stated.iter().all(|of| of.variance == Vector3::repeat(25.0)));
    }

    /// Two positions of 0.3 m, 2 s apart, make velocities of 0.21 m/s; of centimetres they tell a robot of 0.2 m/s.
    #[test]
    fn slow_craft_with_good_positions_move_enough() {
        let path = |std: f64| -> VecDeque<GnssFix> {
            let ned = |k: i32| Vector3::new(0.2 * f64::from(k), 0.0, 0.0);
            (0..5).map(|k| fix(f64::from(k), ned(k), std)).collect()
        };
        let of = |std: f64| sightings(&path(std), true, 1.0);
        assert!((of(0.3)[2].speed_std - 0.3 / 2f64.sqrt()).abs() < 1e-12);
        assert_eq!(least_spread(&of(0.3), true), SPREAD_OF_POSITIONS);
        let fine = least_spread(&of(0.02), true);
        assert!((fine - CLEAR * 0.02 * 2f64.sqrt()).abs() < 1e-9, "{fine}");
        assert_eq!(least_spread(&of(0.02), false), SPREAD);
    }

    #[test]
    fn late_positions_end_at_the_end_of_the_window() {
        let sighting = |time: f64| Sighting {
            accel: Vector3::zeros(),
            time,
            v_n: Vector3::repeat(time),
            place: Vector3::repeat(2.0 * time),
            variance: Vector3::repeat(1.0),
            speed_std: 0.1,
        };
        let seen = [1.0, 2.0, 3.0].map(sighting);
        for (late, end, count) in [
            (0.0, 3.5, 3),
            (0.4, 3.5, 3),
            (0.5, 3.5, 2),
            (0.5 - 0.5 * STAMP_ROUNDING, 3.5, 2),
            (0.5 - 2.0 * STAMP_ROUNDING, 3.5, 3),
            (-0.5, 2.0, 2),
        ] {
            let held = held_late(&seen, late, end);
            assert_eq!(held.len(), count + 1, "{late}");
            for (k, sighting) in held[..count].iter().enumerate() {
                assert_eq!(
                    (sighting.time, sighting.place),
                    (seen[k].time + late, seen[k].place)
                );
            }
            let last = held[count];
            assert_eq!((last.time, last.place), (end, seen[count - 1].place));
            assert_eq!(last.variance, Vector3::repeat(1e12));
        }
    }
}
