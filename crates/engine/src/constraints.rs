//! Wheel speeds, heights, and what the vehicle cannot do.

use super::{
    measurement::Scalar,
    observer::Observer,
    rest::{MOVES, RestBlock, RestDetector},
    solution::Solution,
    summary::Summary,
};
use crate::{
    derived::{BRAKING, Positions},
    estimator::{Aiding, Estimator},
    settings::Settings,
    vehicle::NonHolonomic,
};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::{ComplexField, RealField};
use undrift_nav::{
    Matrix3, Vector3,
    filter::{Gate, Outcome, Update},
    sample::{GnssFix, ImuSample},
};

/// NIS from which a constraint, wheel speed or height is down-weighted, and from which it is rejected: it contradicts
/// the solution far beyond both.
const GATE: Gate = Gate {
    weaken: 9.0,
    reject: 100.0,
};
/// What the standard deviation of a rest is multiplied by that only the sensors see: a soft start has begun before it
/// shows.
const REST_UNCONFIRMED: f64 = 10.0;
/// NIS from which a rest that only the sensors confirm is a start: χ² of three at p = 10⁻⁴.
const REJECT_REST: f64 = 21.1;
/// The speed of a fix holds for this long \[s\].
const SPEED_HOLDS: f64 = 1.5;

/// What is known of the vehicle's motion beside the solution.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Vehicle {
    rest: RestDetector,
    /// Time of the last fix, and the least and greatest speed over ground that it leaves possible.
    last_speed: Option<(f64, (f64, f64))>,
    last_constraint: f64,
    /// Whether it stood in the last block, or has begun to move as smoothly as it stood.
    stood: bool,
    positions: Positions,
}

/// Noise of one standard deviation.
fn isotropic(std: f64) -> Matrix3 {
    Matrix3::identity() * (std * std)
}

/// Updates with something that is known of the vehicle.
fn constrain(filter: &mut dyn Estimator, aiding: &Aiding, noise: &Matrix3) -> Option<Update> {
    filter.update(aiding, noise, &GATE).ok()?
}

impl Vehicle {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            rest: RestDetector::new(&settings.sensors),
            last_speed: None,
            last_constraint: f64::NEG_INFINITY,
            stood: false,
            positions: Positions::default(),
        }
    }

    /// Body axes turn by `c`.
    pub(super) fn turn(&mut self, c: &Matrix3) {
        self.rest.turn(c);
    }

    /// A wheel speed within the present sample.
    pub(super) fn odometer(
        solution: &mut Solution,
        speed: &Scalar,
        settings: &Settings,
        summary: &mut Summary,
    ) {
        let aiding = Aiding::Odometer {
            speed: speed.value,
            lever_arm: settings.constraints.odometer_lever,
        };
        if let Some(update) = scalar(solution, speed, &aiding) {
            summary.odometer.add(update);
        }
    }

    /// A barometric height within the present sample.
    pub(super) fn barometer(solution: &mut Solution, height: &Scalar, summary: &mut Summary) {
        if let Some(update) = scalar(solution, height, &Aiding::Barometer(height.value)) {
            summary.barometer.add(update);
        }
    }

    /// A fix that was shown to the filter: its speed, and its course where that is the heading.
    pub(super) fn fix(&mut self, filter: &mut dyn Estimator, fix: &GnssFix, settings: &Settings) {
        let Some((v_n, covariance)) = &fix.velocity else {
            let least = self.positions.add(fix).map(|derived| {
                let error = derived.covariance.fixed_view::<2, 2>(0, 0).trace().sqrt();
                let braking = BRAKING * (fix.time - derived.time);
                (derived.v_n.xy().norm() - 2.0 * error - braking).max(0.0)
            });
            // That it stands now, positions tell too late; of too few nothing is known.
            let least = least.unwrap_or(MOVES);
            self.last_speed = Some((fix.time, (least, f64::INFINITY)));
            return;
        };
        let error = covariance.fixed_view::<2, 2>(0, 0).trace().sqrt();
        let speed = v_n.xy().norm();
        self.last_speed = Some((fix.time, ((speed - error).max(0.0), speed + error)));
        if let Some((std, min_speed)) = settings.constraints.course
            && speed > min_speed
        {
            let noise = 0.5 * error * error / (speed * speed) + std * std;
            let course = Aiding::Course(v_n.y.atan2(v_n.x));
            let _ = constrain(filter, &course, &(Matrix3::identity() * noise));
        }
    }

    /// What the vehicle cannot do, at the end of a sample; `last_velocity` is the time of the last fix used
    /// with its velocity \[s\].
    pub(super) fn end_sample(
        &mut self,
        filter: &mut dyn Estimator,
        sample: &ImuSample,
        last_velocity: Option<f64>,
        settings: &Settings,
        summary: &mut Summary,
        observer: &mut dyn Observer,
    ) {
        let constraints = &settings.constraints;
        if constraints.zero_velocity.is_some() || constraints.zero_angular_rate.is_some() {
            let speed = self.last_speed.filter(|(time, _)| {
                sample.time - time < SPEED_HOLDS && last_velocity == Some(*time)
            });
            let block = self.rest.add(
                sample,
                &readings_at_rest(filter),
                speed.map(|(_, speed)| speed),
            );
            if let Some(block) = block {
                let rest = stand_still(filter, &block, &mut self.stood, settings, summary);
                observer.judged(filter, rest);
            }
        }
        if let Some(rule) = &constraints.non_holonomic
            && sample.time - self.last_constraint >= rule.interval - 0.5 * sample.dt
            && filter.vehicle_velocity(&rule.lever).x.abs() > rule.min_speed
        {
            self.last_constraint = sample.time;
            if let Some(update) = stay_on_track(filter, rule) {
                summary.non_holonomic.add(update);
            }
        }
    }
}

/// Updates with a measurement of one number; not in a long gap, where the attitude is not known.
fn scalar(solution: &mut Solution, measured: &Scalar, aiding: &Aiding) -> Option<Update> {
    let unknown = solution.in_long_gap();
    solution.advance_to(measured.time);
    if unknown {
        return None;
    }
    constrain(&mut *solution.filter, aiding, &isotropic(measured.std))
}

/// What the sensors should read at rest: rate \[rad/s\] and specific force \[m/s²\].
fn readings_at_rest(filter: &dyn Estimator) -> (Vector3, Vector3) {
    let error = filter.sensor_error();
    let [gyro, accel] = [0, 3].map(|i| Vector3::new(error[i], error[i + 1], error[i + 2]));
    let place = &filter.nav().position;
    let earth_rate = undrift_nav::earth::earth_rate_n(place.lat);
    let up = -undrift_nav::earth::gravity(place.lat, place.height) * Vector3::z();
    let c_nb = filter.nav().q_nb.to_rotation_matrix().into_inner();
    (gyro + c_nb.tr_mul(&earth_rate), accel + c_nb.tr_mul(&up))
}

/// Normalised innovation squared of a rest, by the diagonal of the velocity's covariance.
fn nis_of_rest(filter: &dyn Estimator, std: f64) -> f64 {
    let (v_n, sigma) = (&filter.nav().v_n, filter.nav_std());
    let term = |i: usize| v_n[i].powi(2) / (sigma[3 + i].powi(2) + std * std);
    (0..3).map(term).sum()
}

/// Updates at the end of a block; whether the vehicle stood.
fn stand_still(
    filter: &mut dyn Estimator,
    block: &RestBlock,
    stood: &mut bool,
    settings: &Settings,
    summary: &mut Summary,
) -> bool {
    let mut rest = block.rest;
    // A velocity that has come up since it stood is a start.
    let starts = *stood && rest && !block.confirmed;
    *stood = false;
    if let Some(std) = settings.constraints.zero_velocity.filter(|_| rest) {
        if starts && nis_of_rest(filter, std) > REJECT_REST {
            *stood = true;
            return false;
        }
        // What only the sensors see may be a start so soft that it does not show yet.
        let unsure = if block.confirmed {
            1.0
        } else {
            REST_UNCONFIRMED
        };
        let noise = isotropic(std * unsure);
        if let Some(done) = constrain(filter, &Aiding::ZeroVelocity, &noise) {
            // A solution that is sure to move is believed.
            rest = done.outcome != Outcome::Rejected;
            // One that is weakened had not known before that it stands.
            *stood = done.outcome == Outcome::Used;
            summary.zero_velocity.add(done);
        }
    }
    if let Some(std) = settings.constraints.zero_angular_rate.filter(|_| rest) {
        let noise = Vector3::from_fn(|i, _| {
            let axis = &settings.sensors[i];
            axis.r * axis.interval / block.duration + std * std
        });
        let _ = constrain(
            filter,
            &Aiding::EarthRate(block.rate),
            &Matrix3::from_diagonal(&noise),
        );
    }
    rest
}

/// Updates with what wheels do not do.
fn stay_on_track(filter: &mut dyn Estimator, rule: &NonHolonomic) -> Option<Update> {
    let lateral = (filter.vehicle_velocity(&rule.lever).x * filter.omega_nb_b().z).abs();
    let right = rule.right + rule.slip * lateral;
    let noise = Vector3::new(right * right, rule.down * rule.down, 0.0);
    let aiding = Aiding::NonHolonomic(rule.lever);
    constrain(filter, &aiding, &Matrix3::from_diagonal(&noise))
}

#[cfg(test)]
mod tests;
