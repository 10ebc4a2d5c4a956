//! The course over ground as heading, of a vehicle that points where it goes.
//!
//! The course's own variance is that of the velocity across it over the speed squared; half of the horizontal
//! variance of a fix is across. What is configured for side slip or crab angle is added.

use super::constrain;
use crate::{aid::Aiding, estimator::Estimator, settings::Settings};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::{ComplexField, RealField};
use undrift_nav::{Matrix3, Vector3};

/// A velocity over ground \[m/s\] with the horizontal standard deviation `error`, where its course is the heading
/// ([`crate::vehicle::Constraints::course`]).
pub(crate) fn update(filter: &mut dyn Estimator, v_n: &Vector3, error: f64, settings: &Settings) {
    let speed = v_n.xy().norm();
    if let Some((std, min_speed)) = settings.constraints.course
        && speed > min_speed
    {
        let noise = 0.5 * error * error / (speed * speed) + std * std;
        let course = Aiding::Course(v_n.y.atan2(v_n.x));
        let _ = constrain(filter, &course, &(Matrix3::identity() * noise));
    }
}
