//! What a user sets for an alignment.

use undrift_nav::Vector3;

/// Where the heading comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum Heading {
    /// Known \[rad\] with a standard deviation \[rad\].
    Given(f64, f64),
    /// The GNSS course, once the speed is above `min_speed` after a rest, for body axes that are the
    /// vehicle's; or as `Auto` where that comes first.
    Course,
    /// Velocity changes alone, for body axes of any mounting.
    Auto,
}

/// What is known of the start. The default knows nothing: attitude from rest or motion, the heading from the GNSS course above
/// 3 m/s.
///
/// Roll, pitch, yaw are those of the body axes against north-east-down: yaw 0 is north and grows eastwards.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct AlignSettings {
    /// Roll, pitch, yaw at the first fix used, with standard deviations \[rad\].
    pub attitude: Option<(Vector3, Vector3)>,
    /// Velocity at the first fix used, north-east-down, with standard deviations [m/s].
    pub velocity: Option<(Vector3, Vector3)>,
    /// Where the heading comes from when the attitude is not given.
    pub heading: Heading,
    /// Speed above which the course is the heading [m/s].
    pub min_speed: f64,
}

impl Default for AlignSettings {
    fn default() -> Self {
        Self {
            attitude: None,
            velocity: None,
            heading: Heading::Course,
            min_speed: 3.0,
        }
    }
}
