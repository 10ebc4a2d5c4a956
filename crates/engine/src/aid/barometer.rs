//! Heights by a barometer.

use super::{Aid, Aiding, Measurement, constrain_scalar};
use crate::{
    navigator::{Navigator, PushError},
    solution::Solution,
    summary::Summary,
};
use undrift_nav::sample::Scalar;

/// A height within the present sample.
pub(super) fn update(solution: &mut Solution, height: &Scalar, summary: &mut Summary) {
    let aiding = Aiding::Barometer(height.value);
    if let Some(update) = constrain_scalar(solution, height, &aiding) {
        summary.innovations[Aid::Barometer].add(update);
    }
}

impl Navigator {
    /// Takes in a barometric height \[m\], as [`Navigator::fix`].
    ///
    /// # Errors
    /// As [`Navigator::fix`].
    pub fn barometer(&mut self, height: Scalar) -> Result<bool, PushError> {
        self.measure(Measurement::Barometer(height))
    }
}
