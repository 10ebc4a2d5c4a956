//! Errors of a solution: against a truth file, or against the fixes it was not shown.
//!
//! Error = solution less reference. Angles are wrapped to ±180°.

use crate::{
    estimator::{Estimator, STAMP_ROUNDING},
    results::{Number, Numbers},
};
use undrift_nav::{
    Vector3,
    attitude::{from_rpy, to_rpy},
    earth::{Geodetic, wrap_pi},
    mechanisation::NavState,
    sample::{GnssFix, Position, TruthSample},
};
use undrift_noise::order_statistics;

/// Names of the components of [`Errors`], as in the JSON: metres, metres a second, degrees.
pub const COMPONENTS: [&str; 10] = [
    "north_m",
    "east_m",
    "down_m",
    "horizontal_m",
    "vn_mps",
    "ve_mps",
    "vd_mps",
    "roll_deg",
    "pitch_deg",
    "yaw_deg",
];

/// Index of the horizontal error in [`Errors`].
pub const HORIZONTAL: usize = 3;

/// One value per component of [`COMPONENTS`]; NaN where the reference does not have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors(pub [f64; 10]);

impl Errors {
    /// By component.
    pub fn numbers(&self) -> Numbers {
        let named = COMPONENTS.iter().zip(self.0);
        named
            .map(|(name, value)| ((*name).to_owned(), Number(value)))
            .collect()
    }

    /// Nothing known.
    pub const UNKNOWN: Self = Self([f64::NAN; 10]);

    fn new(dr: &Vector3, dv: Option<Vector3>, rpy: Option<Vector3>) -> Self {
        let missing = Vector3::repeat(f64::NAN);
        let dv = dv.unwrap_or(missing);
        let angle = rpy.map_or(missing, |a| a.map(|x| wrap_pi(x).to_degrees()));
        Self([
            dr.x,
            dr.y,
            dr.z,
            dr.xy().norm(),
            dv.x,
            dv.y,
            dv.z,
            angle.x,
            angle.y,
            angle.z,
        ])
    }

    /// Of a navigation state against the truth at its time.
    pub fn against_truth(nav: &NavState, truth: &TruthSample) -> Self {
        let dr = truth.position.offset_to(&nav.position);
        let dv = truth.v_n.map(|v| nav.v_n - v);
        let rpy = truth.rpy.map(|rpy| to_rpy(&nav.q_nb) - rpy);
        Self::new(&dr, dv, rpy)
    }

    /// Of the predicted antenna against a fix; the attitude stays unknown.
    pub fn against_fix(filter: &dyn Estimator, fix: &GnssFix, lever_b: &Vector3) -> Self {
        let antenna = filter.antenna_position(lever_b);
        Self::of_antenna(&antenna, &filter.antenna_velocity(lever_b), fix)
    }

    /// Of an antenna's position and velocity [m/s] against a fix; the attitude stays unknown.
    pub fn of_antenna(antenna: &Geodetic, velocity: &Vector3, fix: &GnssFix) -> Self {
        let dr = match fix.position {
            Some((Position::Geodetic(measured), _)) => measured.offset_to(antenna),
            Some((Position::Baseline { base, ned }, _)) => base.ned_to(antenna) - ned,
            None => Vector3::repeat(f64::NAN),
        };
        let dv = fix.velocity.map(|(v, _)| velocity - v);
        Self::new(&dr, dv, None)
    }

    /// Component by component, the larger magnitude; unknown only where both are.
    pub fn max_abs(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| {
            self.0[i].abs().max(other.0[i].abs())
        }))
    }
}

/// A statistic of the magnitudes of each component; unknown where any is.
fn by_component(values: &[Errors], statistic: fn(&[f64]) -> f64) -> Errors {
    Errors(std::array::from_fn(|i| {
        let sizes: Vec<f64> = values.iter().map(|e| e.0[i].abs()).collect();
        if !sizes.is_empty() && sizes.iter().all(|size| size.is_finite()) {
            statistic(&sizes)
        } else {
            f64::NAN
        }
    }))
}

/// Root mean square of each component; unknown where any value is.
pub fn rms(values: &[Errors]) -> Errors {
    by_component(values, |sizes| {
        (sizes.iter().map(|e| e * e).sum::<f64>() / sizes.len() as f64).sqrt()
    })
}

/// Median of the magnitudes of each component; unknown where any is.
pub fn median(values: &[Errors]) -> Errors {
    by_component(values, order_statistics::median)
}

/// Largest magnitude of each component; unknown where any is.
pub fn max(values: &[Errors]) -> Errors {
    by_component(values, |sizes| sizes.iter().copied().fold(0.0, f64::max))
}

/// The truth between two of its samples: position by the cubic through positions and velocities
/// where there are velocities, else straight; velocity straight; attitude by the shortest turn.
pub fn interpolate(a: &TruthSample, b: &TruthSample, time: f64) -> TruthSample {
    let span = b.time - a.time;
    let s = if span > 0.0 {
        ((time - a.time) / span).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let chord = a.position.offset_to(&b.position);
    let offset = match (a.v_n, b.v_n) {
        (Some(va), Some(vb)) => {
            let (s2, s3) = (s * s, s * s * s);
            va * (span * (s3 - 2.0 * s2 + s))
                + chord * (3.0 * s2 - 2.0 * s3)
                + vb * (span * (s3 - s2))
        }
        _ => chord * s,
    };
    TruthSample {
        time,
        position: displaced_towards(&a.position, &b.position, &chord, &offset),
        v_n: a.v_n.zip(b.v_n).map(|(va, vb)| va + (vb - va) * s),
        rpy: a.rpy.zip(b.rpy).map(|(ra, rb)| {
            let (qa, qb) = (from_rpy(&ra), from_rpy(&rb));
            let turn = (qa.inverse() * qb).scaled_axis();
            to_rpy(&(qa * undrift_nav::attitude::from_rotation_vector(&(turn * s))))
        }),
    }
}

/// `a` displaced by `offset`, such that an offset of `chord` ends at `b` without rounding.
fn displaced_towards(a: &Geodetic, b: &Geodetic, chord: &Vector3, offset: &Vector3) -> Geodetic {
    if offset == chord {
        *b
    } else {
        a.displaced(offset)
    }
}

/// The truth at any time, from samples in order of time; asked in order of time, so that only two
/// samples are held.
pub struct TruthCursor<I> {
    samples: I,
    before: Option<TruthSample>,
    after: Option<TruthSample>,
}

impl<I: Iterator<Item = TruthSample>> TruthCursor<I> {
    /// Over samples in order of time.
    pub fn new(mut samples: I) -> Self {
        let after = samples.next();
        Self {
            samples,
            before: None,
            after,
        }
    }

    /// The truth at `time` \[s\]; `None` outside the samples or where they are more than 2 s apart.
    pub fn at(&mut self, time: f64) -> Option<TruthSample> {
        const LONGEST: f64 = 2.0;
        while let Some(after) = self.after.filter(|s| s.time <= time + STAMP_ROUNDING) {
            self.before = Some(after);
            self.after = self.samples.next();
        }
        let before = self.before?;
        if (before.time - time).abs() <= STAMP_ROUNDING {
            return Some(TruthSample { time, ..before });
        }
        let after = self.after?;
        (before.time <= time && after.time - before.time <= LONGEST)
            .then(|| interpolate(&before, &after, time))
    }

    /// The reader below.
    pub fn into_inner(self) -> I {
        self.samples
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(time: f64, north: f64, v: f64, yaw_deg: f64) -> TruthSample {
        TruthSample {
            time,
            position: Geodetic::from_degrees(45.0, 7.0, 0.0)
                .displaced(&Vector3::new(north, 0.0, 0.0)),
            v_n: Some(Vector3::new(v, 0.0, 0.0)),
            rpy: Some(Vector3::new(0.0, 0.0, f64::to_radians(yaw_deg))),
        }
    }

    #[test]
    fn truth_is_interpolated_through_acceleration_and_north() {
        // 2 m/s²: north = t², v = 2 t. The cubic is exact for it.
        let truth = [
            sample(0.0, 0.0, 0.0, 350.0),
            sample(1.0, 1.0, 2.0, 10.0),
            sample(2.0, 4.0, 4.0, 30.0),
        ];
        let mut cursor = TruthCursor::new(truth.iter().copied());
        assert!(cursor.at(-0.1).is_none());
        let back = cursor.at(0.5).unwrap();
        assert!(
            back.rpy.unwrap().z.abs() < 1e-12,
            "through north, not round by south"
        );
        let at = cursor.at(1.5).unwrap();
        let origin = Geodetic::from_degrees(45.0, 7.0, 0.0);
        // Curvature over metres and rounding of a latitude, 1.5e-9 m.
        assert!((origin.offset_to(&at.position).x - 2.25).abs() < 1e-6);
        assert!((at.v_n.unwrap().x - 3.0).abs() < 1e-12);
        assert!(cursor.at(2.1).is_none());
    }

    #[test]
    fn statistics_of_known_values() {
        let row = |x: f64| Errors([x; 10]);
        let values = [row(-3.0), row(1.0), row(2.0)];
        assert_eq!(max(&values).0[0], 3.0);
        assert_eq!(median(&values).0[0], 2.0);
        assert!((rms(&values).0[0] - (14.0f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!(max(&[row(1.0), Errors::UNKNOWN]).0[0].is_nan());
        assert!(median(&[]).0[0].is_nan());
    }
}
