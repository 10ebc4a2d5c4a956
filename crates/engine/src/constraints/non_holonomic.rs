//! Wheels neither slip sideways nor hop: no velocity along the vehicle's right and down axes.
//!
//! Slip grows with the lateral acceleration, speed times yaw rate, by what the rule states of the tyres; the
//! standard deviation to the right does, too. Groves 2013, section 15.4.1. Where the fixes show that the vehicle moves
//! across its axis all the same, the constraint holds as much less.
//!
//! σ_right = right + slip · |v_x ω_z|, σ_down as configured, both times the square root of
//! [`Slip::factor`]. The point is the axle that does not steer, at `lever` from the IMU: elsewhere
//! a turning vehicle does move sideways.

use super::constrain;
use crate::{
    aid::Aiding,
    estimator::Estimator,
    summary::{SideSlip, Summary},
    vehicle::NonHolonomic,
};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::Aid;
use undrift_nav::{Matrix3, Vector3, filter::Update};

/// NIS per degree of freedom of the updates of wheels that slip as [`NonHolonomic::CAR`] has it: its standard deviations are those of
/// white noise, √(2 τ/Δt) times the velocities' own, which last for about τ = 2 s and are seen every Δt = 0.2 s. Cars have 0.01 to 0.02.
const OF_WHEELS: f64 = 0.05;
/// Updates that the mean is of, and those that it begins with as of wheels.
const AVERAGED: f64 = 300.0;
const BEFORE: f64 = 25.0;
/// NIS from which an update says no more of the mean: it is rejected.
const MOST: f64 = 100.0;

/// How much a vehicle slips, while fixes show its velocity.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Slip {
    /// Mean of the squared velocities across, in variances of the constraint, and the number of updates that it is of.
    mean: f64,
    updates: f64,
}

impl Default for Slip {
    fn default() -> Self {
        Self {
            mean: OF_WHEELS,
            updates: BEFORE,
        }
    }
}

impl Slip {
    /// Factor on the variance of the constraint.
    ///
    /// At least 1: a vehicle that slips less than assumed does not tighten the constraint.
    pub(super) fn factor(&self) -> f64 {
        (self.mean / OF_WHEELS).max(1.0)
    }

    /// Learns from an update whose variance was multiplied by `factor`.
    pub(super) fn learn(&mut self, factor: f64, update: &Update) {
        self.add(factor * (update.nis / update.dof as f64).min(MOST));
    }

    /// Mean over up to 300 updates, a minute at 0.2 s, begun with 25 of an ordinary car.
    fn add(&mut self, squared: f64) {
        self.updates = (self.updates + 1.0).min(AVERAGED);
        self.mean += (squared - self.mean) / self.updates;
    }
}

/// Updates with what wheels do not do; `aided` is whether fixes show the velocity.
///
/// Learned only while `aided`: without fixes the innovation would say how the solution drifts, not
/// how the wheels slip.
pub(super) fn update(
    filter: &mut dyn Estimator,
    rule: &NonHolonomic,
    slip: &mut Slip,
    aided: bool,
    summary: &mut Summary,
) -> Option<Update> {
    let lateral = (filter.vehicle_velocity(&rule.lever).x * filter.omega_nb_b().z).abs();
    let right = rule.right + rule.slip * lateral;
    let factor = slip.factor();
    let noise = Vector3::new(right * right, rule.down * rule.down, 0.0) * factor;
    let aiding = Aiding::NonHolonomic(rule.lever);
    let update = constrain(filter, &aiding, &Matrix3::from_diagonal(&noise))?;
    summary.innovations[Aid::NonHolonomic].add(update);
    if aided {
        slip.learn(factor, &update);
        let speed = rule.right * slip.mean.sqrt();
        if slip.updates >= AVERAGED && speed > NonHolonomic::CAR.right {
            let start = filter.nav().time;
            let found = summary.side_slip.get_or_insert(SideSlip { start, speed });
            found.speed = found.speed.max(speed);
        }
    }
    Some(update)
}
