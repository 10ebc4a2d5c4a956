//! Whether a vehicle moves along body forward where nobody said how the IMU sits in it: else attitude and heading are those of the IMU
//! alone, by an angle that the motion shows.
//!
//! The direction of the velocity in body axes, once a second above 4 m/s, is summed while the heading is known. Vehicles that go one way
//! only have a long sum; those that move any way, as copters do, have none.

use crate::estimator::Estimator;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::Mismatch;
use undrift_nav::Vector3;

/// From one direction to the next \[s\].
const STEP: f64 = 1.0;
/// Speed from which there is one [m/s].
const SPEED: f64 = 4.0;
/// Directions that it takes.
const LEAST: u32 = 30;
/// Standard deviation of a heading that is known \[rad\].
const KNOWN: f64 = 0.1;
/// Mean length of the sum of directions that agree: a spread of about 10 degrees.
const ALIKE: f64 = 0.985;
/// An angle from which body forward is another axis than the vehicle's \[rad\].
const ASIDE: f64 = 0.35;

/// What is known so far.
#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct ForwardWatch {
    /// Time of the last direction \[s\].
    last: Option<f64>,
    /// Sum of the directions, body axes [–].
    sum: Vector3,
    count: u32,
}

impl ForwardWatch {
    /// Looks at the solution after a fix.
    pub(super) fn fix(&mut self, filter: &dyn Estimator) {
        let nav = filter.nav();
        let is_soon = self.last.is_some_and(|last| nav.time - last < STEP);
        if is_soon || nav.v_n.xy().norm() < SPEED || filter.nav_std()[8] > KNOWN {
            return;
        }
        self.last = Some(nav.time);
        self.sum += (nav.q_nb.inverse() * nav.v_n).normalize();
        self.count += 1;
    }

    /// The angle between the direction of motion and body forward, where it is steady and another one.
    pub(super) fn finding(&self) -> Option<Mismatch> {
        let steady = self.count >= LEAST && self.sum.norm() > ALIKE * f64::from(self.count);
        let angle = self.sum.angle(&Vector3::x());
        (steady && angle > ASIDE).then_some(Mismatch::MovesAside(angle))
    }
}

#[cfg(test)]
mod tests;
