//! Speeds of a wheel. Where the wheel is: [`crate::vehicle::Constraints::odometer_lever`].

use super::{Aid, Aiding, Measurement, constrain_scalar};
use crate::{
    navigator::{Navigator, PushError},
    settings::Settings,
    solution::Solution,
    summary::Summary,
};
use undrift_nav::sample::Scalar;

/// A wheel speed within the present sample.
pub(super) fn update(
    solution: &mut Solution,
    speed: &Scalar,
    settings: &Settings,
    summary: &mut Summary,
) {
    let aiding = Aiding::Odometer {
        speed: speed.value,
        lever_arm: settings.constraints.odometer_lever,
    };
    if let Some(update) = constrain_scalar(solution, speed, &aiding) {
        summary.innovations[Aid::Odometer].add(update);
    }
}

impl Navigator {
    /// Takes in a wheel speed, forward positive \[m/s\], as [`Navigator::fix`].
    ///
    /// # Errors
    /// As [`Navigator::fix`].
    pub fn odometer(&mut self, speed: Scalar) -> Result<bool, PushError> {
        self.measure(Measurement::Odometer(speed))
    }
}
