//! Settings of an alignment: what is known of the first attitude and velocity.

use undrift_nav::Vector3;

/// Source of the first heading, which no rest shows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum Heading {
    /// Heading from north to east \[rad\], and its standard deviation \[rad\].
    Given(f64, f64),
    /// The GNSS course, once the speed is above `min_speed` after a rest, for body axes that are the
    /// vehicle's; or as `Auto` where that comes first.
    Course,
    /// Velocity changes alone, for body axes of any mounting: accelerometers and GNSS see the same ones in two frames.
    Auto,
}

/// What is known of the start. The default knows nothing: attitude from rest or motion, the heading from the GNSS course above
/// 3 m/s.
///
/// Roll, pitch, yaw are those of the body axes against north-east-down: yaw 0 is north and grows eastwards.
///
/// ```
/// use undrift_engine::align::{AlignSettings, Heading};
/// // Parked facing east to within 3°, as read from a compass: level comes from the rest.
/// let parked = AlignSettings {
///     heading: Heading::Given(90f64.to_radians(), 3f64.to_radians()),
///     ..AlignSettings::default()
/// };
/// assert!(parked.attitude.is_none() && parked.min_speed == 3.0); // [m/s]
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct AlignSettings {
    /// Roll, pitch, yaw at the first fix used, and their standard deviations \[rad\]; `None`: found from rest or motion.
    pub attitude: Option<(Vector3, Vector3)>,
    /// Velocity at the first fix used, north-east-down, and its standard deviations [m/s]; `None`: that of the fix.
    pub velocity: Option<(Vector3, Vector3)>,
    /// Where the heading comes from when the attitude is not given.
    pub heading: Heading,
    /// Speed over ground above which the course is the heading [m/s].
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
