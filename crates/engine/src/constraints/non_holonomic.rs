//! Wheels neither slip sideways nor hop: no velocity along the vehicle's right and down axes.
//!
//! Slip grows with the lateral acceleration, speed times yaw rate, by what the rule states of the tyres; the
//! standard deviation to the right does, too. Groves 2013, section 15.4.1.

use super::constrain;
use crate::{
    aid::{Aid, Aiding},
    estimator::Estimator,
    summary::Summary,
    vehicle::NonHolonomic,
};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{Matrix3, Vector3, filter::Update};

/// Updates with what wheels do not do.
pub(crate) fn update(
    filter: &mut dyn Estimator,
    rule: &NonHolonomic,
    summary: &mut Summary,
) -> Option<Update> {
    let lateral = (filter.vehicle_velocity(&rule.lever).x * filter.omega_nb_b().z).abs();
    let right = rule.right + rule.slip * lateral;
    let noise = Vector3::new(right * right, rule.down * rule.down, 0.0);
    let aiding = Aiding::NonHolonomic(rule.lever);
    let update = constrain(filter, &aiding, &Matrix3::from_diagonal(&noise))?;
    summary.innovations[Aid::NonHolonomic].add(update);
    Some(update)
}
