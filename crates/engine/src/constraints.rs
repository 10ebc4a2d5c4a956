//! What is known of the vehicle, and when it is used: rests, what it cannot do, and sensors of one number.
//!
//! | knowledge | when | covariance |
//! |---|---|---|
//! | rest on the ground | the sensors are quiet ([`crate::rest`]) | as configured; ten times the standard deviation where GNSS does not confirm it |
//! | the Earth's rate | at the same time | white noise of the mean over the block, and what is configured |
//! | no slip, no lift | at an interval, above a speed | as configured, in proportion to the lateral acceleration, and to the slip that fixes show |
//! | drag of rotors, velocity that wings keep | in flight, at an interval | as configured, and what fixes show beyond it |
//! | course is heading | with each velocity of a fix, above a speed | of the course, and what is configured for slip |
//! | wheel speed, height | as measured | as measured |
//!
//! All go past one gate: down-weighted from a NIS of 9, rejected from 100. A constraint that contradicts a
//! solution by more is more likely to be wrong than the solution: a vehicle on a ferry, a wheel that spins.
//!
//! Fields of [`Vehicle`] are bookkeeping; the equations of each constraint are observations of the
//! filter ([`Aiding`]). Rules are applied at most once a block of half a second (rest) or once an
//! interval (no slip): more often would count correlated errors as independent.
//!
//! What they assume: rest, that the vehicle is not carried (ferry, train, turntable); no slip,
//! wheels on firm ground, axes of the vehicle known; course, that the vehicle points where it goes.
//! Profiles switch them ([`crate::vehicle`]).

mod air;
mod course;
mod non_holonomic;
mod zero_velocity;

use super::{
    aid::{Aiding, Measurement},
    observer::Observer,
    rest::{MOVES, RestDetector},
    summary::Summary,
};
use crate::{
    derived::{BRAKING, Positions},
    estimator::Estimator,
    settings::Settings,
    solution::Solution,
};
use air::Flight;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::{ComplexField, RealField};
use non_holonomic::Slip;
use undrift_nav::{
    Matrix3,
    filter::{Gate, Update},
    sample::{GnssFix, ImuSample},
};

/// The speed of a fix holds for this long \[s\].
const SPEED_HOLDS: f64 = 1.5;

/// What is known of the vehicle's motion beside the solution.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Vehicle {
    /// Detects rest by the sensors.
    rest: RestDetector,
    /// Time of the last fix, and the least and greatest speed over ground that it leaves possible.
    last_speed: Option<(f64, (f64, f64))>,
    /// Time of the last update by [`non_holonomic`] \[s\].
    last_constraint: f64,
    /// Whether it stood in the last block, or has begun to move as smoothly as it stood.
    stood: bool,
    /// Velocities derived from positions, where fixes have none.
    positions: Positions,
    /// How much the vehicle slips, as fixes show.
    slip: Slip,
    /// Motion through the air.
    flight: Flight,
}

impl Vehicle {
    /// White noise of the sensors gives the level of rest until one is learned.
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            rest: RestDetector::new(&settings.sensors),
            last_speed: None,
            last_constraint: f64::NEG_INFINITY,
            stood: false,
            positions: Positions::default(),
            slip: Slip::default(),
            flight: Flight::default(),
        }
    }

    /// Body axes turn by `c`.
    pub(super) fn turn(&mut self, c: &Matrix3) {
        self.rest.turn(c);
        self.flight.turn(c);
    }

    /// A fix that was shown to the filter: its speed, and its course where that is the heading.
    ///
    /// Without a measured velocity positions show at least how fast it was: twice the error of the derived
    /// velocity, and what a vehicle may have braked by since, are taken off.
    ///
    /// The speed is kept as a range [m/s]: a measured one less and plus the root of the sum of its
    /// horizontal variances; without a velocity the upper end is infinite.
    pub(super) fn fix(&mut self, filter: &mut dyn Estimator, fix: &GnssFix, settings: &Settings) {
        let Some((v_n, covariance)) = &fix.velocity else {
            let least = self.positions.add(fix).map(|derived| {
                let error = derived.covariance.fixed_view::<2, 2>(0, 0).trace().sqrt();
                let braking = BRAKING * (fix.time - derived.time);
                (derived.v_n.xy().norm() - 2.0 * error - braking).max(0.0)
            });
            // Positions show rest too late; too few show nothing.
            let least = least.unwrap_or(MOVES);
            self.last_speed = Some((fix.time, (least, f64::INFINITY)));
            return;
        };
        let error = covariance.fixed_view::<2, 2>(0, 0).trace().sqrt();
        let speed = v_n.xy().norm();
        self.last_speed = Some((fix.time, ((speed - error).max(0.0), speed + error)));
        course::update(filter, v_n, error, settings);
    }

    /// Whether fixes show the velocity at `time` \[s\].
    fn is_aided(&self, time: f64) -> bool {
        let last = self.last_speed.map(|(last, _)| last);
        last.is_some_and(|last| time - last < SPEED_HOLDS)
    }

    /// What the vehicle cannot do, at the end of a sample; `last_velocity` is the time of the last fix used
    /// with its velocity \[s\].
    ///
    /// Whether a block was at rest is reported to the observer. No-slip updates count time from one
    /// to the next, not samples.
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
                &zero_velocity::readings(filter),
                speed.map(|(_, speed)| speed),
            );
            if let Some(block) = block {
                let rest =
                    zero_velocity::update(filter, &block, &mut self.stood, settings, summary);
                observer.judged(filter, rest);
            }
        }
        if let Some(air) = &constraints.air {
            let aided = self.is_aided(sample.time);
            self.flight.sample(filter, (air, sample), aided, summary);
        }
        if let Some(rule) = &constraints.non_holonomic
            && sample.time - self.last_constraint >= rule.interval - 0.5 * sample.dt
            && filter.vehicle_velocity(&rule.lever).x.abs() > rule.min_speed
        {
            self.last_constraint = sample.time;
            let aided = self.is_aided(sample.time);
            non_holonomic::update(filter, rule, &mut self.slip, aided, summary);
        }
    }
}

/// A measurement of one number within the present sample; not in a long gap, where the attitude is not known.
///
/// It holds at its stamp: the filter is moved there first. One that the filter refuses is ignored.
pub(super) fn scalar(
    solution: &mut Solution,
    measurement: &Measurement,
    settings: &Settings,
    summary: &mut Summary,
) {
    let Some((measured, aid, aiding)) = measurement.scalar(&settings.constraints) else {
        return;
    };
    let unknown = solution.in_long_gap();
    solution.advance_to(measured.time);
    if !unknown
        && let Some(update) = constrain(&mut *solution.filter, &aiding, &isotropic(measured.std))
    {
        summary.innovations[aid].add(update);
    }
}

/// NIS from which a constraint, wheel speed or height is down-weighted, and from which it is rejected: it contradicts
/// the solution far beyond both.
const GATE: Gate = Gate {
    weaken: 9.0,
    reject: 100.0,
};

/// Noise of one standard deviation.
fn isotropic(std: f64) -> Matrix3 {
    Matrix3::identity() * (std * std)
}

/// Updates with something that is known of the vehicle.
///
/// `None` where the filter refuses it.
fn constrain(filter: &mut dyn Estimator, aiding: &Aiding, noise: &Matrix3) -> Option<Update> {
    filter.update(aiding, noise, &GATE).ok()?
}

#[cfg(test)]
mod tests;
