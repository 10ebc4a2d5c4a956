//! Wheels neither slip sideways nor hop: no velocity along the vehicle's right and down axes.

use super::{Aid, Aiding, constrain};
use crate::{estimator::Estimator, summary::Summary};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{Matrix3, Vector3, filter::Update};

/// The non-holonomic constraint.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct NonHolonomic {
    /// Standard deviation of the velocity to the right [m/s] …
    pub right: f64,
    /// … and down [m/s].
    pub down: f64,
    /// Side slip: added to `right` for every m/s² of lateral acceleration [m/s per m/s²].
    pub slip: f64,
    /// From update to update \[s\].
    pub interval: f64,
    /// IMU → the middle of the axle that does not steer, body axes \[m\].
    pub lever: Vector3,
    /// Speed below which it is not applied [m/s].
    pub min_speed: f64,
}

impl NonHolonomic {
    /// Of a car.
    ///
    /// The velocity to the right of four smoothed drives of four cars scatters by 0.03 to 0.08 m/s and
    /// is correlated over two seconds, the one down by 0.06 to 0.08 m/s over four; in a turn the axle
    /// slips by 0.04 m/s for every m/s². White noise of the same power at one update every Δt has
    /// √(2 τ/Δt) times those standard deviations: 0.2, 0.4 and 0.15.
    pub const CAR: Self = Self {
        right: 0.2,
        down: 0.4,
        slip: 0.15,
        interval: 0.2,
        lever: Vector3::new(0.0, 0.0, 0.0),
        min_speed: 1.0,
    };
}

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
