//! How an alignment ended: what it is based on, or why it failed.

use alloc::{
    format,
    string::{String, ToString},
};

/// Source and accuracy of the first attitude.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Alignment {
    /// Source of the attitude.
    pub source: AttitudeSource,
    /// Standard deviation of the tilt, the larger of its two axes \[rad\].
    pub level_std: f64,
    /// Standard deviation of the heading \[rad\].
    pub heading_std: f64,
    /// Standard deviation of the gyro bias, the largest of the axes \[rad/s\].
    pub gyro_bias_std: f64,
    /// Excess of the specific force at rest over gravity \[m/s²\], where that is more than the accelerometers' noise
    /// model has: the filter then starts with so large constant errors.
    pub force_excess: Option<f64>,
}

/// Source of the first attitude.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum AttitudeSource {
    /// The settings state it ([`AlignSettings::attitude`](crate::align::AlignSettings::attitude)).
    Given,
    /// The first pose, by the marker's rotation.
    Pose,
    /// Level and gyro bias from the mean over a rest.
    Rest {
        /// Length of the rest \[s\].
        duration: f64,
        /// Source of the heading, which rest does not show.
        heading: HeadingSource,
    },
    /// All of it from velocity changes seen by sensors and GNSS.
    Motion {
        /// Length of the window of motion \[s\].
        duration: f64,
        /// Whether the gyro bias is known from a rest before.
        bias_at_rest: bool,
    },
}

impl AttitudeSource {
    /// Whether the heading is by this after a rest.
    pub(crate) fn is_by(&self, source: HeadingSource) -> bool {
        matches!(self, Self::Rest { heading, .. } if *heading == source)
    }
}

/// Source of the heading after a rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum HeadingSource {
    /// The settings state it ([`Heading::Given`](crate::align::Heading::Given)).
    Given,
    /// The GNSS course once the vehicle moved.
    Course,
    /// Headings by two antennas.
    Antennas,
    /// A magnetometer, at rest.
    Magnetometer,
}

/// Why there was no alignment, and what to set or to change; its text is for the user.
///
/// ```
/// use undrift_engine::align::{AlignmentFailure, MotionFailure, RestFailure};
/// // Without speed there is no change of velocity either: one reason is enough.
/// let never = RestFailure::NeverMoved { fastest: 0.2 };
/// let failure = AlignmentFailure::NoAttitude(never, MotionFailure::TooFew);
/// assert_eq!(failure.to_string(), never.to_string());
/// assert!(failure.to_string().contains("initial.heading"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum AlignmentFailure {
    /// No fix within the inertial log has a usable position.
    #[error("no fix within the inertial log has a usable position")]
    NoPosition,
    /// No fix lies within the inertial log.
    #[error("no GNSS fix lies within the IMU log: check both time columns")]
    NoOverlap,
    /// The attitude is given, but no fix has a velocity and no two are close enough to make one.
    #[error("the fixes have no velocity and are too sparse to derive one; set initial.velocity")]
    NoVelocity,
    /// Neither rest nor motion gave the attitude.
    #[error("{}", no_attitude(.0, .1))]
    NoAttitude(RestFailure, MotionFailure),
}

/// Why there was no alignment after a rest, and what to set instead.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum RestFailure {
    /// There was no rest.
    #[error("no rest to level the IMU (set initial.attitude)")]
    NoRest,
    /// The course is the heading above a speed that was never reached.
    #[error(
        "the vehicle never reached {min_speed:.1} m/s (at most {fastest:.1} m/s), so the course gives no heading: set initial.min_speed or initial.heading"
    )]
    TooSlow {
        /// Speed above which the course is the heading \[m/s\].
        min_speed: f64,
        /// The highest speed \[m/s\].
        fastest: f64,
    },
    /// The course is the heading, and there was rest alone.
    #[error(
        "the vehicle never moved (at most {fastest:.1} m/s), so its heading is unknown: set initial.heading, or use a log with motion"
    )]
    NeverMoved {
        /// The highest speed \[m/s\].
        fastest: f64,
    },
    /// The course is the heading above a speed that no fix after the rest had.
    #[error(
        "no fix after a rest was faster than {min_speed:.1} m/s, so the course gives no heading (set initial.heading or initial.attitude)"
    )]
    NoFastFix {
        /// Speed above which the course is the heading \[m/s\].
        min_speed: f64,
    },
    /// Nothing gives the heading.
    #[error("no heading after the rest (set initial.heading or initial.attitude)")]
    NoHeading,
}

/// Why there was no alignment in motion, from what says least to what says most.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, thiserror::Error)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum MotionFailure {
    /// There were never enough fixes one after the other.
    #[default]
    #[error("alignment in motion needs more consecutive fixes")]
    TooFew,
    /// The velocity hardly changed.
    #[error(
        "alignment in motion needs speeding up, braking or turning: the velocity changed by at most {change:.1} m/s within {within:.0} s"
    )]
    TooSteady {
        /// Largest change of the velocity \[m/s\] …
        change: f64,
        /// … within so long \[s\].
        within: f64,
    },
    /// The velocity changes fit more than one attitude.
    #[error(
        "alignment in motion needs more speeding up, braking or turning: the velocity changes fit more than one attitude"
    )]
    Ambiguous,
    /// They give the attitude with too large a standard deviation \[rad\].
    #[error(
        "the attitude from velocity changes is uncertain by {:.1} deg: alignment in motion needs more speeding up, braking or turning, or the noise model is too pessimistic", .0.to_degrees()
    )]
    Uncertain(f64),
    /// The log ended while the attitude had this standard deviation \[rad\].
    #[error("the log ended while the attitude was still uncertain by {:.1} deg", .0.to_degrees())]
    Settling(f64),
    /// Samples and fixes do not fit together: the squared residuals over what they should be.
    #[error(
        "samples and fixes are inconsistent (squared residuals {0:.0} times the expected): check axes, units, time columns and standard deviations"
    )]
    Misfit(f64),
}

/// Text of a missing attitude. Without speed there is no change of velocity either: one reason is enough.
fn no_attitude(rest: &RestFailure, motion: &MotionFailure) -> String {
    match (rest, motion) {
        (
            RestFailure::TooSlow { .. } | RestFailure::NeverMoved { .. },
            MotionFailure::TooFew | MotionFailure::TooSteady { .. },
        ) => rest.to_string(),
        _ => format!("{rest}, and {motion}"),
    }
}

impl MotionFailure {
    /// Stage that the search reached, to keep the failure that says most.
    pub(super) fn stage(&self) -> u8 {
        match self {
            Self::TooFew => 0,
            Self::TooSteady { .. } => 1,
            Self::Ambiguous => 2,
            Self::Uncertain(_) => 3,
            Self::Settling(_) => 4,
            Self::Misfit(_) => 5,
        }
    }
}
