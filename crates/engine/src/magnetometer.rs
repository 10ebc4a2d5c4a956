//! Magnetic fields: which of them the filter is updated with, and how far they are believed.
//!
//! A compass has no error that is white. What the vehicle's iron adds is estimated ([`Parameter::HardIron`]); what is left lasts for as
//! long as the vehicle stays where it is and points where it points, and what other vehicles, bridges and motors add comes and goes.
//! So:
//!
//! * readings are averaged over a second, or less where the body turns; each mean has the whole variance of what lasts, times the number
//!   of means that see the same: at rest one says all;
//! * a mean is not used, nor any within the next seconds, where the field changed by more than it can against the gyros, or where
//!   strength or dip are not the Earth's: neither depends on the heading;
//! * where they are not for a minute and do not change, the hard iron has become another one and is made unknown again;
//! * a field that agrees with the heading shows that a course that does not is a way to move, and no wrong heading;
//! * at rest nothing else shows its heading: what fixes and rests say of it are errors of the gyros;
//! * strength and dip say nothing of the heading, and a heading that is far off makes them seem wrong: the second order of its error is
//!   added to the noise.

use crate::{
    aid::Aiding,
    estimator::Estimator,
    readings::Readings,
    settings::Settings,
    summary::{MOST_EVENTS, Summary},
};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::{ComplexField, RealField};
use nalgebra::{Matrix2, SMatrix, Vector2};
use undrift_events::{Aid, DisturbedField};
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    attitude::{from_rotation_vector, skew},
    filter::Gate,
    parameters::Parameter,
    sample::MagneticField,
};

/// NIS of three numbers from which a mean is down-weighted, and from which it is rejected.
const GATE: Gate = Gate {
    weaken: 12.0,
    reject: 36.0,
};
/// Readings closer than this to the one before are skipped \[s\].
const APART: f64 = 0.018;
/// Readings are averaged for so long \[s\], or until the body has turned by so much \[rad\].
const WINDOW: f64 = 1.0;
const TURN: f64 = 0.2;
/// Readings further apart are not compared \[s\].
const GAP: f64 = 3.0;
/// Time for which what lasts does so in motion \[s\].
const LASTS: f64 = 20.0;
/// Least time in motion between two updates \[s\].
const INTERVAL: f64 = 1.0;
/// Speed \[m/s\] and turn within a mean \[rad\] from which the vehicle is in motion.
const MOVES: f64 = 0.5;
const TURNS: f64 = 0.05;
/// Standard deviation of a heading that nothing turns but motion, and the field \[rad\].
const UNSURE: f64 = 0.1;
/// Part of the field that soft iron adds to a turned one [–].
const SOFT_IRON: f64 = 0.05;
/// Square of a change of three numbers, or of strength and dip, in their variance, that one in a thousand sound ones has.
const CHANGED: f64 = 16.3;
const NOT_EARTHS: f64 = 13.8;
/// Square of what a field is off by across the heading that agrees with it, in its variance.
const AGREES: f64 = 9.0;
/// Nothing is used for so long after a disturbance \[s\].
const HOLD: f64 = 5.0;
/// A field that is not the Earth's and does not change for so long is one of the vehicle's \[s\].
const PATIENCE: f64 = 60.0;
/// A disturbance that lasts for so long is an event \[s\].
const EVENT: f64 = 2.0;
/// Standard deviation of the heading up to which the second order of its error counts \[rad\].
const MOST_HEADING: f64 = 0.6;

/// Readings that are averaged: innovations, predicted less measured, in body axes.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Window {
    start: f64,
    last: f64,
    /// Attitude at the start.
    q_nb: Quaternion,
    /// The Earth's field, north, east, down.
    field: Vector3,
    readings: Readings,
}

/// A mean, north, east, down.
#[derive(Clone, Copy)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Mean {
    time: f64,
    q_nb: Quaternion,
    /// Predicted less measured.
    off: Vector3,
    /// Variance of its white noise.
    white: f64,
}

/// The magnetometer beside a solution.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Compass {
    window: Option<Window>,
    before: Option<Mean>,
    /// Time in motion since the last update \[s\].
    moved: f64,
    /// Nothing is used before this \[s\].
    quiet: f64,
    /// Since when the field has not been the Earth's without a change \[s\].
    strange: Option<f64>,
    open: Option<DisturbedField>,
    /// Last mean that agreed with the heading \[s\].
    agreed: f64,
}

impl Compass {
    pub(crate) fn new() -> Self {
        Self {
            window: None,
            before: None,
            moved: LASTS,
            quiet: f64::NEG_INFINITY,
            strange: None,
            open: None,
            agreed: f64::NEG_INFINITY,
        }
    }

    /// Another solution begins, which has been updated with the field already or not.
    pub(crate) fn restart(&mut self, used: bool, summary: &mut Summary) {
        self.close(summary);
        *self = Self {
            moved: if used { 0.0 } else { LASTS },
            ..Self::new()
        };
    }

    /// Takes a reading, in body axes; with the last one of a mean the filter is updated.
    pub(crate) fn update(
        &mut self,
        filter: &mut dyn Estimator,
        reading: &MagneticField,
        settings: &Settings,
        summary: &mut Summary,
    ) {
        let nav = filter.nav();
        let end = self.window.as_ref().map(|window| window.last);
        if end.is_some_and(|end| reading.time - end < APART) {
            return;
        }
        let fresh = |start| Window {
            start,
            last: reading.time,
            q_nb: nav.q_nb,
            field: settings.magnetometer.field(&nav.position),
            readings: Readings::default(),
        };
        let window = match &mut self.window {
            Some(window) if reading.time - window.last < GAP => {
                if window.readings.count == 0 {
                    *window = fresh(window.start);
                }
                window
            }
            window => window.insert(fresh(reading.time)),
        };
        // The filter may be at the start of the sample within which it was read.
        let since = from_rotation_vector(&(filter.omega_nb_b() * (reading.time - nav.time)));
        let aiding = Aiding::Magnetometer {
            measured: since * reading.field,
            field: window.field,
        };
        let Some(off) = filter.innovation(&aiding) else {
            return;
        };
        window.last = reading.time;
        window.readings.add(&off, reading.std);
        let turned = window.q_nb.angle_to(&nav.q_nb);
        if reading.time - window.start < WINDOW && turned < TURN {
            return;
        }
        let span = reading.time - window.start;
        let window = window.clone();
        let readings = &window.readings;
        let scatter = match readings.count {
            ..4 => 0.0,
            _ => readings.scatter() / (3.0 * (readings.number() - 1.0)),
        };
        let seen = Mean {
            time: reading.time,
            q_nb: nav.q_nb,
            off: nav.q_nb * readings.mean(),
            white: readings.white_of_mean(scatter),
        };
        let moves = nav.v_n.norm() > MOVES || turned > TURNS;
        if moves {
            self.moved += span;
        } else if filter.nav_std()[8] > UNSURE {
            filter.isolate_heading();
        }
        self.mean(filter, seen, &window.field, settings, summary);
        // The next mean begins where this one ends.
        self.window = Some(Window {
            start: window.last,
            readings: Readings::default(),
            ..window
        });
    }

    /// Updates the filter with a mean, or not.
    fn mean(
        &mut self,
        filter: &mut dyn Estimator,
        mean: Mean,
        field: &Vector3,
        settings: &Settings,
        summary: &mut Summary,
    ) {
        let lasting = settings.magnetometer.lasting_variance();
        let before = self.before.replace(mean);
        let before = before.filter(|before| mean.time - before.time < GAP);
        let predicted = covariance(filter, field);
        let changed = before.is_some_and(|before| {
            let span = mean.time - before.time;
            let turned = before.q_nb.angle_to(&mean.q_nb);
            let iron = hard_iron_variance(filter).max((SOFT_IRON * field.norm()).powi(2));
            let drift = filter.sensor_error_std()[..3].iter().sum::<f64>() * span;
            let variance = before.white
                + mean.white
                + lasting * (2.0 * span / LASTS).min(2.0)
                + iron * turned * turned
                + field.norm_squared() * drift * drift;
            (mean.off - before.off).norm_squared() > CHANGED * variance
        });
        let strange = is_not_earths(filter, &mean, field, &predicted, lasting);
        if changed || !strange {
            self.strange = None;
        }
        if strange {
            let since = *self.strange.get_or_insert(mean.time);
            if let Some(prior) = filter.parameters().prior(Parameter::HardIron)
                && mean.time - since > PATIENCE
            {
                filter.renew(Parameter::HardIron, prior.std.max(mean.off.norm()));
                self.strange = None;
            }
        }
        if changed || strange {
            self.quiet = mean.time + HOLD;
            let open = self.open.get_or_insert(DisturbedField {
                start: before.map_or(mean.time, |before| before.time),
                end: mean.time,
                strongest: 0.0,
            });
            open.end = mean.time;
            open.strongest = open.strongest.max(mean.off.norm());
        }
        if mean.time < self.quiet {
            summary.innovations[Aid::Magnetometer].rejected += 1;
            return;
        }
        self.close(summary);
        let across = Vector3::z().cross(&radial(field));
        let variance = across.dot(&(predicted * across)) + mean.white + lasting;
        if mean.off.dot(&across).powi(2) < AGREES * variance {
            self.agreed = mean.time;
        }
        if self.moved < INTERVAL {
            return;
        }
        let alike = (LASTS / self.moved).max(1.0);
        let c_nb = mean.q_nb.to_rotation_matrix().into_inner();
        let along = c_nb.tr_mul(&radial(field));
        let noise = Matrix3::identity() * (mean.white + lasting * alike)
            + along * along.transpose() * (second_order(filter, field) * alike);
        let aiding = |measured| Aiding::Magnetometer {
            measured,
            field: *field,
        };
        let Some(reading) = filter.innovation(&aiding(Vector3::zeros())) else {
            return;
        };
        let measured = aiding(reading - c_nb.tr_mul(&mean.off));
        let Ok(Some(update)) = filter.update(&measured, &noise, &GATE) else {
            return;
        };
        self.moved = 0.0;
        summary.innovations[Aid::Magnetometer].add(update);
        if let (Some(now), Some(before)) = (filter.innovation(&measured), &mut self.before) {
            before.off = c_nb * now;
        }
    }

    /// Whether the field has agreed with the heading just before `time` \[s\].
    pub(crate) fn agrees(&self, time: f64) -> bool {
        time - self.agreed < GAP
    }

    /// Ends the disturbance that is open, if any.
    pub(crate) fn close(&mut self, summary: &mut Summary) {
        if let Some(open) = self.open.take()
            && open.end - open.start >= EVENT
            && summary.disturbed_fields.len() < MOST_EVENTS
        {
            summary.disturbed_fields.push(open);
        }
    }
}

/// Unit vector along magnetic north over ground.
fn radial(field: &Vector3) -> Vector3 {
    let level = Vector3::new(field.x, field.y, 0.0);
    level.try_normalize(0.0).unwrap_or(Vector3::x())
}

/// Variance of the shortening of the field along magnetic north by a heading that is off, `(¾ σ⁴) H²`.
fn second_order(filter: &dyn Estimator, field: &Vector3) -> f64 {
    let heading = filter.nav_std()[8].min(MOST_HEADING);
    0.75 * heading.powi(4) * field.xy().norm_squared()
}

/// Mean variance of the three components of the hard iron.
fn hard_iron_variance(filter: &dyn Estimator) -> f64 {
    let p = filter.covariance();
    let at = filter.parameter_start(Parameter::HardIron);
    at.map_or(0.0, |at| {
        (p[(at, at)] + p[(at + 1, at + 1)] + p[(at + 2, at + 2)]) / 3.0
    })
}

/// Covariance of the predicted field, north, east, down, by those of attitude and hard iron.
fn covariance(filter: &dyn Estimator, field: &Vector3) -> Matrix3 {
    let p = filter.covariance();
    let turn = -skew(field);
    let Some(at) = filter.parameter_start(Parameter::HardIron) else {
        return turn * p.fixed_view::<3, 3>(6, 6) * turn.transpose();
    };
    let mut rows = SMatrix::<f64, 3, 6>::zeros();
    rows.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
    let c_nb = filter.nav().q_nb.to_rotation_matrix();
    rows.fixed_view_mut::<3, 3>(0, 3)
        .copy_from(&-c_nb.into_inner());
    let place = |i: usize| if i < 3 { 6 + i } else { at + i - 3 };
    let both = SMatrix::<f64, 6, 6>::from_fn(|i, j| p[(place(i), place(j))]);
    rows * both * rows.transpose()
}

/// Whether strength and dip are not those of the Earth's field and the hard iron.
fn is_not_earths(
    filter: &dyn Estimator,
    mean: &Mean,
    field: &Vector3,
    predicted: &Matrix3,
    lasting: f64,
) -> bool {
    let axes = SMatrix::<f64, 3, 2>::from_columns(&[radial(field), Vector3::z()]);
    let off: Vector2<f64> = axes.tr_mul(&mean.off);
    let mut variance: Matrix2<f64> = axes.transpose() * predicted * axes;
    variance += Matrix2::identity() * (mean.white + lasting);
    variance[(0, 0)] += second_order(filter, field);
    // Whether it is a covariance is checked elsewhere.
    let inverse = variance.try_inverse().unwrap_or_default();
    off.dot(&(inverse * off)) > NOT_EARTHS
}
