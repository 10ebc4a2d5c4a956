//! Errors of a solution: against a truth file, or against the fixes it was not shown.
//!
//! Error = solution less reference. Angles are wrapped to ±180°.

use crate::estimator::{Estimator, STAMP_ROUNDING};
use undrift_base::order_statistics;
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    attitude::{from_rpy, to_rpy},
    earth::{Geodetic, wrap_pi},
    mechanisation::NavState,
    sample::{GnssFix, Position, TruthSample},
};
pub use undrift_results::COMPONENTS;
use undrift_results::{Numbers, by_name};

/// Index of the horizontal error in [`Errors`].
pub const HORIZONTAL: usize = 3;

/// One value per component of [`COMPONENTS`], north-east-down \[m, m/s, deg\]; NaN where the reference does not have it.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::reference::{Errors, HORIZONTAL, max, rms, where_known};
/// let mut errors = [Errors::UNKNOWN; 3]; // The third has no reference.
/// errors[0].0[HORIZONTAL] = 3.0;
/// errors[1].0[HORIZONTAL] = 4.0;
/// assert_eq!(where_known(&errors, rms).0[HORIZONTAL], 12.5_f64.sqrt());
/// assert_eq!(where_known(&errors, max).0[HORIZONTAL], 4.0);
/// assert!(rms(&errors).0[HORIZONTAL].is_nan());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors(pub [f64; 10]);

impl Errors {
    /// The errors by the names of their components; unknown ones are absent.
    pub fn numbers(&self) -> Numbers {
        by_name(COMPONENTS.into_iter().zip(self.0))
    }

    /// Errors without a reference: all NaN.
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

    /// Errors of a navigation state against the truth at the same time; velocity and attitude stay unknown where the truth has
    /// none.
    pub fn against_truth(nav: &NavState, truth: &TruthSample) -> Self {
        let dr = truth.position.offset_to(&nav.position);
        let dv = truth.v_n.map(|v| nav.v_n - v);
        let rpy = truth.rpy.map(|rpy| to_rpy(&nav.q_nb) - rpy);
        Self::new(&dr, dv, rpy)
    }

    /// Errors of the predicted antenna against a fix, with the lever arm \[m\] in body axes; the attitude stays unknown.
    pub fn against_fix(filter: &dyn Estimator, fix: &GnssFix, lever_b: &Vector3) -> Self {
        let antenna = filter.antenna_position(lever_b);
        Self::of_antenna(&antenna, &filter.antenna_velocity(lever_b), fix)
    }

    /// Errors of an antenna's position and velocity [m/s] against a fix; the attitude stays unknown, and so do components that the
    /// fix leaves open, as the height of a receiver that gives latitude and longitude, or the vertical velocity beside a course.
    pub fn of_antenna(antenna: &Geodetic, velocity: &Vector3, fix: &GnssFix) -> Self {
        let dr = fix.position.map(|(measured, noise)| {
            let off = match measured {
                Position::Geodetic(measured) => measured.offset_to(antenna),
                Position::Baseline { base, ned } => base.ned_to(antenna) - ned,
            };
            measured_of(off, &noise)
        });
        let dv = fix
            .velocity
            .map(|(v, noise)| measured_of(velocity - v, &noise));
        Self::new(&dr.unwrap_or(Vector3::repeat(f64::NAN)), dv, None)
    }

    /// Errors against a pose: of its position `off` north, east, down \[m\], predicted less measured, and of its attitude, which is turned by
    /// `turn` about north, east, down against the predicted one \[rad\].
    pub fn of_pose(off: &Vector3, turn: Option<&Vector3>, q_nb: &Quaternion) -> Self {
        let mut errors = Self::new(off, None, None);
        if let Some(turn) = turn {
            let angles = -(angle_rates(q_nb) * turn);
            errors.0[7..10].copy_from_slice(angles.as_slice());
        }
        errors
    }

    /// These errors, with those of `others` in place of unknown components.
    #[must_use]
    pub fn or(self, others: Self) -> Self {
        Self(std::array::from_fn(|i| match self.0[i].is_finite() {
            true => self.0[i],
            false => others.0[i],
        }))
    }

    /// The larger magnitude of each component; unknown only where both are.
    pub fn max_abs(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| {
            self.0[i].abs().max(other.0[i].abs())
        }))
    }
}

/// A component of a fix is open where its standard deviation is so many times that of the best.
const OPEN: f64 = 50.0;

/// The components that a fix with this covariance measures; the others are unknown.
fn measured_of(error: Vector3, noise: &Matrix3) -> Vector3 {
    let variance = noise.diagonal();
    let most = OPEN * OPEN * variance.min();
    error.zip_map(
        &variance,
        |error, of| {
            if of < most { error } else { f64::NAN }
        },
    )
}

/// Covariances that a solution gives its position \[m²\], velocity \[m²/s²\] and misalignment \[rad²\],
/// north-east-down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Predicted(pub [Matrix3; 3]);

/// Groups of components in [`Predicted`]: name, and index of the first of three in [`Errors`].
pub const GROUPS: [(&str, usize); 3] = [("position", 0), ("velocity", 4), ("attitude", 7)];

impl Predicted {
    /// From the present covariance of a filter.
    pub fn from_filter(filter: &dyn Estimator) -> Self {
        let p = filter.covariance();
        Self([0, 3, 6].map(|at| p.fixed_view::<3, 3>(at, at).into_owned()))
    }

    /// Covariances of the difference to a fix, which has noise of its own.
    #[must_use]
    pub fn against_fix(mut self, fix: &GnssFix) -> Self {
        let noise = [fix.position.map(|p| p.1), fix.velocity.map(|v| v.1)];
        for (own, noise) in self.0.iter_mut().zip(noise) {
            *own += noise.unwrap_or_default();
        }
        self
    }

    /// Covariances of the components of [`Errors`], in their units; `q_nb` is the attitude.
    fn of_components(&self, q_nb: &Quaternion) -> [Matrix3; 3] {
        let angles = angle_rates(q_nb);
        let [position, velocity, attitude] = self.0;
        [position, velocity, angles * attitude * angles.transpose()]
    }

    /// Standard deviations by component; of the horizontal error its predicted root mean square.
    pub fn std(&self, q_nb: &Quaternion) -> Errors {
        let mut std = Errors::UNKNOWN;
        for ((_, at), p) in GROUPS.iter().zip(self.of_components(q_nb)) {
            for i in 0..3 {
                std.0[at + i] = p[(i, i)].max(0.0).sqrt();
            }
        }
        std.0[HORIZONTAL] = std.0[0].hypot(std.0[1]);
        std
    }

    /// Normalised error squared of each of [`GROUPS`] per degree of freedom, 1 on the average when the
    /// covariance is right, of the components that are known; NaN where none is.
    pub fn nees(&self, q_nb: &Quaternion, errors: &Errors) -> [f64; 3] {
        let all = self.of_components(q_nb);
        std::array::from_fn(|group| {
            let mut e = Vector3::from_column_slice(&errors.0[GROUPS[group].1..][..3]);
            let mut p = all[group];
            let unknown = Vec::from_iter((0..3).filter(|i| e[*i].is_nan()));
            for i in &unknown {
                p.row_mut(*i).fill(0.0);
                p.column_mut(*i).fill(0.0);
                (e[*i], p[(*i, *i)]) = (0.0, 1.0);
            }
            let known = (3 - unknown.len()) as f64;
            let factor = nalgebra::Cholesky::new(p);
            factor.map_or(f64::NAN, |factor| e.dot(&factor.solve(&e)) / known)
        })
    }
}

/// Rates of roll, pitch and yaw \[deg\] by a rate about north, east and down \[rad\].
fn angle_rates(q_nb: &Quaternion) -> Matrix3 {
    let rpy = to_rpy(q_nb);
    let ((sin_y, cos_y), (sin_p, cos_p)) = (rpy.z.sin_cos(), rpy.y.sin_cos());
    Matrix3::new(
        cos_y / cos_p,
        sin_y / cos_p,
        0.0,
        -sin_y,
        cos_y,
        0.0,
        cos_y * sin_p / cos_p,
        sin_y * sin_p / cos_p,
        1.0,
    ) * 1f64.to_degrees()
}

/// Counts of errors inside one, two and three predicted standard deviations, by group of [`GROUPS`]: each
/// component counts by itself. Of normal errors with the right covariance 0.683, 0.954 and 0.997 of all.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::reference::{Coverage, Errors};
/// let mut coverage = Coverage::default();
/// let (mut errors, mut std) = (Errors::UNKNOWN, Errors::UNKNOWN);
/// (errors.0[0], std.0[0]) = (1.5, 1.0); // North: between one and two standard deviations.
/// coverage.add(&errors, &std);
/// assert_eq!(coverage.shares(0), Some([0.0, 1.0, 1.0])); // Of positions.
/// assert_eq!(coverage.shares(1), None); // Of velocities nothing is known.
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    inside: [[u64; 3]; 3],
    all: [u64; 3],
}

impl Coverage {
    /// Counts errors against their standard deviations; those that are unknown count for nothing.
    pub fn add(&mut self, errors: &Errors, std: &Errors) {
        for (group, (_, at)) in GROUPS.iter().enumerate() {
            for i in *at..at + 3 {
                let scaled = errors.0[i].abs() / std.0[i];
                if scaled.is_finite() {
                    self.all[group] += 1;
                    for (k, inside) in self.inside[group].iter_mut().enumerate() {
                        *inside += u64::from(scaled <= (k + 1) as f64);
                    }
                }
            }
        }
    }

    /// Shares of a group of [`GROUPS`] inside one, two and three standard deviations; `None` without errors.
    pub fn shares(&self, group: usize) -> Option<[f64; 3]> {
        let all = self.all[group];
        (all > 0).then(|| self.inside[group].map(|inside| inside as f64 / all as f64))
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

/// A statistic of each component over the values that have it.
pub fn where_known(values: &[Errors], statistic: fn(&[Errors]) -> Errors) -> Errors {
    Errors(std::array::from_fn(|i| {
        let known = values.iter().filter(|e| e.0[i].is_finite()).copied();
        statistic(&known.collect::<Vec<_>>()).0[i]
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

/// The truth at `time` \[s\] between two of its samples: position by the cubic through positions and velocities
/// where there are velocities, else straight; velocity straight; attitude by the shortest turn.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::{Vector3, nav::{earth::Geodetic, sample::TruthSample}, reference::interpolate};
/// let position = Geodetic::from_degrees(47.0, 8.0, 400.0);
/// let a = TruthSample { time: 10.0, position, v_n: Some(Vector3::new(8.0, 0.0, 0.0)), rpy: None };
/// let b = TruthSample {
///     time: 11.0,
///     position: position.displaced(&Vector3::new(9.0, 0.0, 0.0)),
///     v_n: Some(Vector3::new(10.0, 0.0, 0.0)), // It speeds up by 2 m/s².
///     ..a
/// };
/// let middle = interpolate(&a, &b, 10.5);
/// assert!((position.offset_to(&middle.position).x - (8.0 * 0.5 + 0.25)).abs() < 1e-6);
/// assert_eq!(middle.v_n.map(|v| v.x), Some(9.0));
/// ```
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
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::{nav::{earth::Geodetic, sample::TruthSample}, reference::TruthCursor};
/// let at = |time: f64| TruthSample { time, position: Geodetic::from_degrees(47.0, 8.0, 400.0), v_n: None, rpy: None };
/// let mut truth = TruthCursor::new([0.0, 1.0, 5.0].map(at).into_iter());
/// assert!(truth.at(0.25).is_some());
/// assert!(truth.at(3.0).is_none()); // In a gap of 4 s.
/// ```
pub struct TruthCursor<I> {
    samples: I,
    before: Option<TruthSample>,
    after: Option<TruthSample>,
}

impl<I: Iterator<Item = TruthSample>> TruthCursor<I> {
    /// Starts at the first of samples in order of time.
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

    /// The iterator of the samples, as far as it was not read.
    pub fn into_inner(self) -> I {
        self.samples
    }
}

#[cfg(test)]
mod tests;
