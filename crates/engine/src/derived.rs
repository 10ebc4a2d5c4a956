//! Position of the antenna at a fix, and its velocity where the receiver reports positions only.

use alloc::{collections::VecDeque, vec::Vec};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{
    Matrix3, Vector3,
    earth::Geodetic,
    sample::{GnssFix, Position},
};

/// Time from the first to the last of the positions that a velocity is derived from \[s\].
const SPAN: f64 = 2.0;
/// Longest such time, where it takes longer to have [`LEAST`] of them \[s\].
const LONGEST: f64 = 5.0;
/// Positions that a velocity is derived from, at least.
const LEAST: usize = 5;
/// Positions whose scatter is pooled.
const KEPT: usize = 60;
/// What the scatter of the positions does not show, one standard deviation \[m/s\].
const FLOOR: f64 = 0.1;
/// Deceleration that a vehicle may have had since the time of a derived velocity \[m/s²\].
pub(crate) const BRAKING: f64 = 2.0;

/// Place of the antenna at a fix, of a baseline that of its base plus the baseline; `None` of a fix without a position.
///
/// ```
/// use undrift_engine::derived::antenna;
/// use undrift_nav::{Matrix3, Vector3, earth::Geodetic, sample::{GnssFix, Position}};
/// let base = Geodetic::from_degrees(45.0, 7.0, 300.0);
/// let baseline = Position::Baseline { base, ned: Vector3::new(1000.0, 0.0, 0.0) };
/// let fix = GnssFix { position: Some((baseline, Matrix3::identity())), ..GnssFix::at(0.0, base, [1.0; 3]) };
/// let place = antenna(&fix).expect("a position");
/// // A kilometre north; the tangent plane leaves the ellipsoid by 8 cm.
/// assert!((place.lat - base.lat - 1000.0 / 6.367e6).abs() < 1e-6 && (place.height - 300.08).abs() < 0.01);
/// ```
pub fn antenna(fix: &GnssFix) -> Option<Geodetic> {
    match &fix.position.as_ref()?.0 {
        Position::Geodetic(geodetic) => Some(*geodetic),
        Position::Baseline { base, ned } => Some(Geodetic::from_ecef(
            &(base.to_ecef() + base.ned_from_ecef().transpose() * ned),
        )),
    }
}

/// A velocity and its covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct DerivedVelocity {
    /// When it held: the middle of the positions \[s\].
    pub(crate) time: f64,
    /// Over ground, north, east, down [m/s].
    pub(crate) v_n: Vector3,
    /// Covariance of the velocity [m²/s²].
    pub(crate) covariance: Matrix3,
}

/// The last positions, enough of them for their scatter.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Positions {
    last: VecDeque<(f64, Geodetic)>,
}

impl Positions {
    /// The slope of a straight line through the last positions; its covariance is that of what they scatter about it, so
    /// that a bend and white noise count and an error that lasts does not. A few positions may lie on a line by chance: their
    /// scatter is at least that of the last sixty, and what they state before that is known. `None` of a fix with a
    /// velocity and before there are enough.
    pub(crate) fn add(&mut self, fix: &GnssFix) -> Option<DerivedVelocity> {
        if fix.velocity.is_some() {
            return None;
        }
        let (place, (_, stated)) = (antenna(fix)?, fix.position?);
        if self.last.back().is_some_and(|(time, _)| fix.time <= *time) {
            return None;
        }
        self.last.push_back((fix.time, place));
        while self.last.len() > KEPT {
            self.last.pop_front();
        }
        let last = self.last.make_contiguous();
        let known = last.len();
        let near = |&(k, (time, _)): &(usize, &(f64, Geodetic))| {
            let age = fix.time - time;
            age <= SPAN || known - k <= LEAST && age <= LONGEST
        };
        let (from, _) = last.iter().enumerate().find(near)?;
        let (_, origin) = last[0];
        let track = last
            .iter()
            .map(|(time, place)| (*time, origin.offset_to(place)));
        let white = white_variance(&track.collect::<Vec<_>>());
        slope(&last[from..], &white.unwrap_or_else(|| stated.diagonal()))
    }
}

/// The slope of a straight line through positions, with the covariance that their scatter about it gives, of variances of at
/// least `white` \[m²\].
fn slope(places: &[(f64, Geodetic)], white: &Vector3) -> Option<DerivedVelocity> {
    let (first, origin) = *places.first()?;
    let (last, _) = *places.last()?;
    if places.len() < LEAST || last - first < 0.5 * SPAN {
        return None;
    }
    let track = places.iter();
    let track = track.map(|(time, place)| (time - first, origin.offset_to(place)));
    let track: Vec<(f64, Vector3)> = track.collect();
    let count = track.len() as f64;
    let middle = track.iter().map(|(t, _)| t).sum::<f64>() / count;
    let mean = track.iter().map(|(_, r)| r).sum::<Vector3>() / count;
    let power: f64 = track.iter().map(|(t, _)| (t - middle).powi(2)).sum();
    let slope = track.iter().map(|(t, r)| r * (t - middle));
    let v_n = slope.sum::<Vector3>() / power;
    let rest = track
        .iter()
        .map(|(t, r)| r - mean - v_n * (t - middle))
        .map(|rest| rest.component_mul(&rest));
    let variance = (rest.sum::<Vector3>() / (count - 2.0)).sup(white) / power;
    let floor = FLOOR * FLOOR;
    Some(DerivedVelocity {
        time: first + middle,
        v_n,
        covariance: Matrix3::from_diagonal(&variance.map(|v| v + floor)),
    })
}

/// Share of the squares that are taken to be no outliers, and that quantile of χ²(1): a median would be that of a rest,
/// where there was one for half of the time.
const SHARE: f64 = 0.8;
const QUANTILE: f64 = 1.642;
/// Steps that third differences need to be worth something.
const LEAST_DIFFERENCES: usize = 12;
/// Even intervals differ by no more than this share.
const EVEN: f64 = 0.1;

/// Variances of the white part of positions \[m²\] at these times \[s\], at most: from their third differences, whose
/// variance is 20 times that of each and which motion without a jerk does not enter (as the modified Allan variance's
/// second ones, without speed and acceleration). Quantiles, so that outliers do not count. `None` of too few even steps.
pub(crate) fn white_variance(track: &[(f64, Vector3)]) -> Option<Vector3> {
    let mut squares: [Vec<f64>; 3] = Default::default();
    for of in track.windows(4) {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| of[k]);
        let step = (d.0 - a.0) / 3.0;
        let even = |from: f64, to: f64| (to - from - step).abs() < EVEN * step;
        if even(a.0, b.0) && even(b.0, c.0) {
            let third = d.1 - a.1 - (c.1 - b.1) * 3.0;
            for i in 0..3 {
                squares[i].push(third[i] * third[i]);
            }
        }
    }
    let enough = squares[0].len() >= LEAST_DIFFERENCES;
    let last = (SHARE * squares[0].len() as f64) as usize;
    enough.then(|| {
        Vector3::from_fn(|i, _| {
            let (_, square, _) = squares[i].select_nth_unstable_by(last, f64::total_cmp);
            *square / (20.0 * QUANTILE)
        })
    })
}

/// Adds velocities to fixes none of which has one: the slope of the positions within a second about each, for what
/// may look ahead. Fixes of which any has a velocity are returned as they are. Slopes that
/// share their positions share their errors: the variance of each is that of one, times how many do.
///
/// ```
/// use undrift_engine::derived::with_velocities;
/// use undrift_nav::{Vector3, earth::Geodetic, sample::GnssFix};
/// let start = Geodetic::from_degrees(45.0, 7.0, 300.0);
/// // 8 m/s north, five positions a second.
/// let fixes = (0..100).map(|k| {
///     let time = 0.2 * f64::from(k);
///     GnssFix::at(time, start.displaced(&Vector3::new(8.0 * time, 0.0, 0.0)), [1.0; 3])
/// });
/// let fixes = with_velocities(fixes.collect());
/// let (v_n, _) = fixes[50].velocity.expect("enough positions about it");
/// assert!((v_n - Vector3::new(8.0, 0.0, 0.0)).norm() < 1e-3);
/// ```
pub fn with_velocities(mut fixes: Vec<GnssFix>) -> Vec<GnssFix> {
    if fixes.iter().any(|fix| fix.velocity.is_some()) {
        return fixes;
    }
    let place = |fix: &GnssFix| Some((fix.time, antenna(fix)?));
    let places: Vec<(f64, Geodetic)> = fixes.iter().filter_map(place).collect();
    let half = 0.5 * SPAN;
    for fix in &mut fixes {
        let from = places.partition_point(|(time, _)| *time < fix.time - half);
        let to = places.partition_point(|(time, _)| *time <= fix.time + half);
        let around = places.get(from..to);
        let around = around.and_then(|places| slope(places, &Vector3::zeros()));
        // At the ends the line has its middle elsewhere.
        let around = around.filter(|v| (v.time - fix.time).abs() < 0.25 * half);
        let sharing = (to - from) as f64;
        fix.velocity = around.map(|velocity| (velocity.v_n, velocity.covariance * sharing));
    }
    fixes
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::sample::FixQuality;

    fn fixes(rate: f64, wobble: f64) -> impl Iterator<Item = GnssFix> {
        let start = Geodetic::from_degrees(47.0, 8.0, 400.0);
        (0..40).map(move |k| {
            let time = f64::from(k) / rate;
            let side = if k % 2 == 0 { wobble } else { -wobble };
            let place = start.displaced(&Vector3::new(3.0 * time, -4.0 * time + side, 0.0));
            GnssFix {
                attitude: None,
                mean_velocity: None,
                time,
                position: Some((Position::Geodetic(place), Matrix3::identity())),
                velocity: None,
                quality: FixQuality::Unknown,
            }
        })
    }

    #[test]
    fn a_straight_track_has_its_velocity_in_the_middle() {
        let mut positions = Positions::default();
        let found: Vec<_> = fixes(5.0, 0.0)
            .filter_map(|fix| positions.add(&fix))
            .collect();
        let last = found.last().unwrap();
        // The span of the last positions is two seconds; an offset over the ellipsoid is exact to 1e-6 of it.
        assert!((last.time - (39.0 / 5.0 - 1.0)).abs() < 1e-9, "{last:?}");
        assert!(
            (last.v_n - Vector3::new(3.0, -4.0, 0.0)).norm() < 1e-4,
            "{last:?}"
        );
    }

    #[test]
    fn scatter_is_in_the_covariance_and_velocities_are_left_alone() {
        let mut positions = Positions::default();
        let found = fixes(5.0, 0.5).filter_map(|fix| positions.add(&fix)).last();
        let covariance = found.unwrap().covariance;
        // Third differences of 8 · 0.5 m, as white noise has them; eleven points, Σ(t − t̄)² = 0.04·110.
        let east = 16.0 / (20.0 * QUANTILE) / 4.4 + FLOOR * FLOOR;
        assert!(
            (covariance[(1, 1)] / east - 1.0).abs() < 0.02,
            "{covariance}"
        );
        assert!(covariance[(0, 0)] < 1.01 * FLOOR * FLOOR);
        let with_velocity = |fix: GnssFix| GnssFix {
            velocity: Some((Vector3::zeros(), Matrix3::identity())),
            ..fix
        };
        // Of few positions the scatter says little: it is as stated, 1 m, at least.
        let mut positions = Positions::default();
        let found = fixes(5.0, 0.0)
            .take(11)
            .filter_map(|fix| positions.add(&fix))
            .last();
        let covariance = found.unwrap().covariance;
        assert!(
            (covariance[(1, 1)] - 1.0 / 4.4 - FLOOR * FLOOR).abs() < 1e-6,
            "{covariance}"
        );
        let mut positions = Positions::default();
        assert!(fixes(5.0, 0.0).all(|fix| positions.add(&with_velocity(fix)).is_none()));
    }

    #[test]
    fn slopes_that_share_their_positions_are_as_good_as_one_together() {
        let found = with_velocities(fixes(5.0, 0.5).collect());
        let (_, covariance) = found[20].velocity.unwrap();
        // Eleven positions within a second to either side, as in the slope of them alone.
        let east = 0.25 * 11.0 / 9.0 / 4.4 + FLOOR * FLOOR;
        assert!(
            (covariance[(1, 1)] / (11.0 * east) - 1.0).abs() < 0.02,
            "{covariance}"
        );
    }

    #[test]
    fn third_differences_show_white_noise_and_no_motion() {
        // Speeding up, turning: differences of a cubic's third order are constant, here of 6 · 0.01 · 0.2³.
        let track = |count: u32, wobble: f64, step: f64| -> Vec<(f64, Vector3)> {
            let at = |k: u32| {
                let t = step * f64::from(k);
                let side = if k.is_multiple_of(2) { wobble } else { -wobble };
                let place = Vector3::new(5.0 * t + 2.0 * t * t, 0.01 * t.powi(3), side);
                (t, place)
            };
            (0..count).map(at).collect()
        };
        let white = white_variance(&track(40, 0.1, 0.2)).unwrap();
        // To either side in turn: differences of eight times as much.
        let expected = 64.0 * 0.01 / (20.0 * QUANTILE);
        assert!((white.z / expected - 1.0).abs() < 1e-9, "{white}");
        let jerk = (0.06f64 * 0.008).powi(2) / (20.0 * QUANTILE);
        assert!(white.x < 1e-20 && (white.y / jerk - 1.0).abs() < 1e-6);
        // Fifteen positions make twelve differences.
        assert!(white_variance(&track(15, 0.1, 0.2)).is_some());
        assert!(white_variance(&track(14, 0.1, 0.2)).is_none());
        // Steps that are not even are passed over: every second one here is twice as long.
        let mut uneven = track(60, 0.1, 0.2);
        let mut at = 0;
        uneven.retain(|_| {
            at += 1;
            at % 3 > 0
        });
        assert!(white_variance(&uneven).is_none());
    }

    #[test]
    fn positions_that_span_more_than_five_seconds_make_no_velocity() {
        for (interval, found) in [(1.2, true), (1.3, false)] {
            let late = fixes(1.0 / interval, 0.0).map(|fix| GnssFix {
                time: fix.time + 100.0,
                ..fix
            });
            let mut positions = Positions::default();
            let velocities: Vec<_> = late.filter_map(|fix| positions.add(&fix)).collect();
            // From the fifth of forty on.
            assert_eq!(velocities.len(), if found { 36 } else { 0 }, "{interval}");
        }
    }
}
