//! Wheel speeds, heights, and what the vehicle cannot do.

use super::Run;
use crate::replay::{Observer, Scalar};
use undrift_nav::{
    Matrix3, Vector3,
    aiding::Observation,
    filter::{Filter, Gate, Outcome, Update},
    sample::ImuSample,
};

/// Constraints are left out where they contradict the solution far beyond both.
pub(super) const CONSTRAINT_GATE: Gate = Gate {
    weaken: 9.0,
    reject: 100.0,
};
/// The speed of a fix holds for so long [s].
const SPEED_HOLDS: f64 = 1.5;

impl<const N: usize> Run<'_, N> {
    /// Whether the present sample ends a gap too long to say how the vehicle moved in it.
    fn in_long_gap(&self) -> bool {
        let bridge = self.bridge.as_ref();
        bridge.is_some_and(|bridge| bridge.unknown_since.is_some())
    }

    /// A wheel speed within the present sample.
    pub(in crate::replay) fn odometer(&mut self, speed: &Scalar) {
        let lever = self.settings.constraints.odometer_lever;
        let done = self.scalar(speed, |filter| filter.observe_odometer(speed.value, &lever));
        if let Some(update) = done {
            self.summary.odometer.add(update);
        }
    }

    /// A barometric height within the present sample.
    pub(in crate::replay) fn barometer(&mut self, height: &Scalar) {
        let done = self.scalar(height, |filter| filter.observe_barometer(height.value));
        if let Some(update) = done {
            self.summary.barometer.add(update);
        }
    }

    /// Updates with a measurement of one number; not in a long gap, where the attitude is not known.
    fn scalar(
        &mut self,
        measured: &Scalar,
        observe: impl FnOnce(&Filter<N>) -> Observation<1, N>,
    ) -> Option<Update> {
        let unknown = self.in_long_gap();
        self.advance_to(measured.time);
        let filter = self.filter.as_mut().filter(|_| !unknown)?;
        let variance = nalgebra::Matrix1::new(measured.std * measured.std);
        let tape = self.tape.as_deref_mut();
        filter
            .update_recorded(&observe(filter), &variance, &CONSTRAINT_GATE, tape)
            .ok()
    }

    /// What the vehicle cannot do, at the end of a sample.
    pub(super) fn constrain(&mut self, sample: &ImuSample, observer: &mut impl Observer) {
        let Some(filter) = &mut self.filter else {
            return;
        };
        let constraints = &self.settings.constraints;
        if constraints.zero_velocity.is_some() || constraints.zero_angular_rate.is_some() {
            let error = filter.sensor_error();
            let [gyro, accel] = [0, 3].map(|i| Vector3::new(error[i], error[i + 1], error[i + 2]));
            let place = &filter.nav().position;
            let earth_rate = undrift_nav::earth::earth_rate_n(place.lat);
            let up = -undrift_nav::earth::gravity(place.lat, place.height) * Vector3::z();
            let to_body = |v_n: &Vector3| filter.c_nb().tr_mul(v_n);
            let expected = (gyro + to_body(&earth_rate), accel + to_body(&up));
            let speed = self
                .last_speed
                .filter(|(time, _)| {
                    sample.time - time < SPEED_HOLDS && self.last_fix == Some(*time)
                })
                .map(|(_, speed)| speed);
            if let Some(block) = self.rest.add(sample, &expected, speed) {
                let mut rest = block.rest;
                if let Some(std) = constraints.zero_velocity.filter(|_| rest) {
                    let observed = filter.observe_zero_velocity();
                    let r = Matrix3::identity() * (std * std);
                    let tape = self.tape.as_deref_mut();
                    if let Ok(done) = filter.update_recorded(&observed, &r, &CONSTRAINT_GATE, tape)
                    {
                        // A solution that is sure to move is believed.
                        rest = done.outcome != Outcome::Rejected;
                        self.summary.zero_velocity.add(done);
                    }
                }
                if let Some(std) = constraints.zero_angular_rate.filter(|_| rest) {
                    let observed = filter.observe_earth_rate(&block.rate);
                    let noise = Vector3::from_fn(|i, _| {
                        let axis = &self.settings.sensors[i];
                        axis.r * axis.interval / block.duration + std * std
                    });
                    let r = Matrix3::from_diagonal(&noise);
                    let tape = self.tape.as_deref_mut();
                    let _ = filter.update_recorded(&observed, &r, &CONSTRAINT_GATE, tape);
                }
                observer.judged(filter, rest);
            }
        }
        if let Some(rule) = &constraints.non_holonomic
            && sample.time - self.last_constraint >= rule.interval - 0.5 * sample.dt
            && filter.vehicle_velocity(&rule.lever).x.abs() > rule.min_speed
        {
            self.last_constraint = sample.time;
            let observed = filter.observe_non_holonomic(&rule.lever);
            let lateral = (filter.vehicle_velocity(&rule.lever).x * filter.omega_nb_b().z).abs();
            let right = rule.right + rule.slip * lateral;
            let r = nalgebra::Matrix2::new(right * right, 0.0, 0.0, rule.down * rule.down);
            let tape = self.tape.as_deref_mut();
            if let Ok(done) = filter.update_recorded(&observed, &r, &CONSTRAINT_GATE, tape) {
                self.summary.non_holonomic.add(done);
            }
        }
    }
}
