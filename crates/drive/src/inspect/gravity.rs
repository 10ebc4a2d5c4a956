//! Accelerometers whose numbers are without gravity.

use super::{Content, Known, Line, Part};
use undrift_nav::{Vector3, earth::STANDARD_GRAVITY};

/// Accelerometers that measure less than this times gravity on average have it removed.
const REMOVED: f64 = 0.5;

/// Times gravity that the mean specific force is, of accelerometers that measure too little at each instant. Where only the size of the numbers
/// shows the unit, also of those that measure too little on average: what a car adds and loses in speed may be as large in one unit as gravity in
/// another, but not its mean.
pub(super) fn removed_gravity(imu: &Part) -> Option<f64> {
    let measured = imu.measured.as_ref()?;
    let Some(Content::Force(mean)) = measured.content else {
        return None;
    };
    let ratio = Vector3::from(mean).norm() / STANDARD_GRAVITY;
    let is_guess =
        |line: &Line| line.key == "accel_unit" && matches!(line.known, Known::Gravity(_));
    let guessed = imu.lines.iter().any(is_guess);
    let removed = measured.size_of_force? < REMOVED * STANDARD_GRAVITY;
    (removed || guessed && ratio < REMOVED).then_some(ratio)
}

#[cfg(test)]
mod tests {
    use super::super::Measured;
    use super::*;

    #[test]
    fn a_mean_far_below_gravity_in_a_unit_that_is_a_guess_has_none() {
        let of = |known: Known, mean: f64, size: f64| {
            let measured = Measured {
                content: Some(Content::Force([0.0, 0.0, mean])),
                size_of_force: Some(size),
                ..Measured::default()
            };
            let part = Part {
                measured: Some(measured),
                ..Part::new("imu", vec![Line::new("accel_unit", "g", known)])
            };
            removed_gravity(&part).is_some()
        };
        let named = Known::Name { several: true };
        assert!(of(Known::Gravity(1.2), 4.9, 12.0) && !of(Known::Gravity(1.2), 5.0, 12.0));
        assert!(!of(named.clone(), 4.9, 12.0) && of(named, 2.4, 4.9));
    }
}
