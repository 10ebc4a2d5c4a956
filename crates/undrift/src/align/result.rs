//! How an alignment ended: what it rests on, or why there is none.

/// How the first attitude was found, and how well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// Where the attitude comes from.
    pub source: AttitudeSource,
    /// Standard deviation of the tilt, the larger of the two \[rad\].
    pub level_std: f64,
    /// Standard deviation of the heading \[rad\].
    pub heading_std: f64,
    /// Standard deviation of the gyro bias, the largest of the axes \[rad/s\].
    pub gyro_bias_std: f64,
}

/// Where the first attitude comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AttitudeSource {
    /// It is given.
    Given,
    /// Level and gyro bias from rest.
    Rest {
        /// Length of the rest \[s\].
        duration: f64,
        /// Where the heading comes from.
        heading: HeadingSource,
    },
    /// Velocity changes.
    Motion {
        /// Length of the window \[s\].
        duration: f64,
        /// Whether the gyro bias is known from a rest before.
        bias_at_rest: bool,
    },
}

/// Where the heading after a rest comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeadingSource {
    /// It is given.
    Given,
    /// The GNSS course.
    Course,
}

/// Why there was no alignment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlignmentFailure {
    /// No fix within the inertial log has a usable position.
    NoPosition,
    /// No fix lies within the inertial log.
    NoOverlap,
    /// The attitude is given, but no fix has a velocity and no two are close enough to make one.
    NoVelocity,
    /// Neither rest nor motion gave the attitude.
    NoAttitude(RestFailure, MotionFailure),
}

/// Why there was no alignment after a rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RestFailure {
    /// There was no rest.
    NoRest,
    /// The course is the heading above a speed that was never reached.
    TooSlow {
        /// That speed \[m/s\].
        min_speed: f64,
        /// The highest speed \[m/s\].
        fastest: f64,
    },
    /// The course is the heading above a speed that no fix after the rest had.
    NoFastFix {
        /// That speed \[m/s\].
        min_speed: f64,
    },
    /// Nothing gives the heading.
    NoHeading,
}

/// Why there was no alignment in motion, from what says least to what says most.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub enum MotionFailure {
    /// The fixes have no velocity.
    #[default]
    NoVelocity,
    /// There were never enough fixes with a velocity one after the other.
    TooFew,
    /// The velocity hardly changed.
    TooSteady {
        /// By how much at most \[m/s\] …
        change: f64,
        /// … within so long \[s\].
        within: f64,
    },
    /// The velocity changes fit more than one attitude.
    Ambiguous,
    /// They give the attitude with too large a standard deviation \[rad\].
    Uncertain(f64),
    /// The log ended while the attitude had this standard deviation \[rad\].
    Settling(f64),
    /// Samples and fixes do not fit together: the squared residuals over what they should be.
    Misfit(f64),
}

impl MotionFailure {
    /// How far the search came.
    pub(super) fn stage(&self) -> u8 {
        match self {
            Self::NoVelocity => 0,
            Self::TooFew => 1,
            Self::TooSteady { .. } => 2,
            Self::Ambiguous => 3,
            Self::Uncertain(_) => 4,
            Self::Settling(_) => 5,
            Self::Misfit(_) => 6,
        }
    }
}
