//! What can happen in a run that its user should know, as values.

use crate::{Alignment, FixErrors, Mounting};

/// An event of the navigation. One that lasts is reported at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum Event {
    /// Navigation began at this time \[s\], from this alignment.
    Started(f64, Alignment),
    /// Samples of an axis could not be right and were replaced.
    SampleFault(SampleFault),
    /// Consecutive fixes were rejected; reported when the last of them has passed.
    Rejected(Contradiction),
    /// The solution was reset to fixes that contradicted it, and its covariance was inflated by this.
    Doubted(Doubt),
    /// The course over ground contradicts the heading.
    HeadingOff(HeadingOff),
    /// Consecutive headings by two antennas were rejected; reported when the last of them has passed.
    HeadingsRejected(RejectedHeadings),
    /// The magnetic field was not the Earth's and not used; reported when it has passed.
    FieldDisturbed(DisturbedField),
    /// Innovations were biased to one side for a while.
    Leant(Lean),
    /// The solution ended at this time \[s\], for this reason, and is aligned again; [`Event::Resumed`] follows.
    AlignsAgain(f64, RestartCause),
    /// From this time \[s\] on the filter uses these errors of the fixes beyond what they state, as the fixes have shown them.
    FixErrors(f64, FixErrors),
    /// After this time \[s\] body axes are the vehicle's, by this mounting. A later one replaces it.
    Mounting(f64, Mounting),
    /// Another solution began at this time \[s\], after [`Event::AlignsAgain`].
    Resumed(f64),
    /// The solution diverged at this time \[s\]; without gating it is the last event.
    Diverged(f64),
    /// A measurement stamped so \[s\] came later than the horizon and was rejected.
    TooLate(f64),
}

impl Event {
    /// Time at which it began or happened \[s\], in the time base of the samples.
    pub fn time(&self) -> f64 {
        match self {
            Self::Started(time, _)
            | Self::AlignsAgain(time, _)
            | Self::FixErrors(time, _)
            | Self::Mounting(time, _)
            | Self::Resumed(time)
            | Self::Diverged(time)
            | Self::TooLate(time) => *time,
            Self::SampleFault(fault) => fault.start,
            Self::Rejected(fixes) => fixes.start,
            Self::Doubted(doubt) => doubt.end,
            Self::HeadingOff(off) => off.start,
            Self::HeadingsRejected(headings) => headings.start,
            Self::FieldDisturbed(field) => field.start,
            Self::Leant(lean) => lean.start,
        }
    }

    /// Whether `other` is this event, seen for longer: same kind and same start. Events that last are handed out again as they grow.
    ///
    /// ```
    /// use undrift_events::Event;
    /// assert_eq!(Event::Resumed(12.0).time(), 12.0);
    /// assert!(Event::Resumed(12.0).is_same(&Event::Resumed(12.0)));
    /// assert!(!Event::Resumed(12.0).is_same(&Event::Diverged(12.0)));
    /// ```
    pub fn is_same(&self, other: &Self) -> bool {
        let axis = |event: &Self| match event {
            Self::SampleFault(fault) => Some((fault.axis, None)),
            Self::Rejected(fixes) => Some((0, Some(fixes.part))),
            Self::Leant(lean) => Some((0, Some(lean.part))),
            _ => None,
        };
        core::mem::discriminant(self) == core::mem::discriminant(other)
            && self.time() == other.time()
            && axis(self) == axis(other)
    }
}

/// Part of a fix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Part {
    /// Position.
    Position,
    /// Velocity.
    Velocity,
}

/// Consecutive fixes that contradicted the solution and were rejected.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Contradiction {
    /// Part of the fixes that was rejected.
    pub part: Part,
    /// Whether it was the height alone; the rest of the positions was used.
    #[cfg_attr(feature = "serde", serde(default))]
    pub height: bool,
    /// Time of the first \[s\].
    pub start: f64,
    /// Time of the last \[s\], with those soon after the solution accepted the fixes.
    pub end: f64,
    /// Number of fixes.
    pub fixes: u64,
    /// Distance of the first from the solution \[m\], of a velocity [m/s].
    pub first: f64,
    /// Distance of the last, at the end or when the solution first accepted the fixes \[m\], of a velocity [m/s].
    pub last: f64,
    /// Rate at which the distance grew [m/s], of a velocity [m/s²].
    pub growth: f64,
    /// Largest distance \[m\], of a velocity [m/s].
    pub largest: f64,
    /// Whether the receiver repeated its fix while the solution moved.
    pub frozen: bool,
    /// Whether the solution was reset to them in the end.
    pub accepted_in_the_end: bool,
}

/// Samples of an axis that could not be right and were replaced.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SampleFault {
    /// Sensor axis: 0 to 2 for the gyros x, y, z of the sensor, 3 to 5 for the accelerometers.
    pub axis: usize,
    /// Time of the first sample replaced \[s\].
    pub start: f64,
    /// Time of the last sample replaced \[s\].
    pub end: f64,
    /// Whether the axis repeated a value while it should not (frozen or saturated); else it was a spike.
    pub stuck: bool,
}

/// A second alignment: the solution before it had ended or could not be trusted.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Restart {
    /// Time at which that was found \[s\].
    pub time: f64,
    /// Reason for it.
    pub why: RestartCause,
    /// Start of the next solution \[s\]; absent if there was none until the end.
    pub resumed: Option<f64>,
}

/// Reason for aligning again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum RestartCause {
    /// Position, velocity or covariance left the possible range.
    Impossible,
    /// No inertial samples came for more than a minute.
    NoSamples,
    /// The innovations were far beyond their predicted size for half a minute.
    LargeInnovations,
    /// Rejected fixes were accepted in the end again and again.
    RejectedThenAccepted,
    /// The solution began with the heading of a magnetometer, and motion showed another one.
    WrongHeading,
}

/// A span in which innovations of a kind leaned to one side far more than is usual in the log.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Lean {
    /// Part of the fixes whose innovations leaned.
    pub part: Part,
    /// Start of the span \[s\].
    pub start: f64,
    /// End of the span \[s\].
    pub end: f64,
    /// Largest mean of the innovations over a block, predicted less measured, north, east, down \[m\], of a velocity [m/s].
    pub mean: [f64; 3],
}

/// A configuration that cannot be right by what the data show: units, axes, signs or times.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Implausible {
    /// The mean specific force is not gravity: a unit of the accelerometers is wrong.
    Gravity {
        /// Mean specific force over gravity [–].
        ratio: f64,
        /// The gyros measure gravity in place of the accelerometers.
        exchanged: bool,
    },
    /// Gravity lies along this direction in body axes (a unit vector), not along down, `[0, 0, 1]`: axes are wrong.
    Down([f64; 3]),
    /// The course turns by this multiple of what the gyros turn [–]: a unit of the gyros is wrong; negative where a sign is.
    TurnScale(f64),
    /// The course turns with the gyro of this axis (0 to 2), not with the vertical one: axes are swapped.
    TurnAxis(usize),
    /// The gyros do not see the turns of the course.
    NoTurn,
    /// The gyros measure the turns this much later than the course's stamps \[s\].
    Late(f64),
    /// The body axis along which the vehicle accelerates and the one along which it is pushed in turns to
    /// the right: 1 forward, 2 right, with sign, as far as that is seen.
    Push {
        /// When it accelerates: to be 1.
        forward: Option<i8>,
        /// In turns to the right: to be 2.
        right: Option<i8>,
    },
    /// Positions and velocities agree only if something is changed; `None`: nothing simple.
    Velocity(Option<FixMend>),
    /// The positions alternate between two places so far apart, horizontally \[m\]: two receivers in one log.
    Alternates(f64),
    /// From some time on a sensor measures the motion over ground otherwise than before.
    Changed(SensorChange),
    /// The velocities are this multiple of the changes of position, with its standard deviation [–].
    VelocityScale([f64; 2]),
}

/// What of samples and fixes does not go together and is no error of the configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Mismatch {
    /// The velocities of the fixes show the turns of the gyros later than stamped.
    LateVelocities {
        /// By how much \[s\].
        delay: f64,
        /// How far positions may be off where the filter has another delay \[m\]; `None` within three of their standard deviations.
        beyond: Option<f64>,
    },
    /// The accelerometers are later than the gyros by so much \[s\].
    LateAccelerometers(f64),
    /// The receiver holds its position while it moves slowly; the largest step from there \[m\].
    HeldPositions(f64),
    /// The IMU nods in its mount, one standard deviation \[rad\].
    Nods(f64),
    /// The vehicle moves at this angle to body forward, and nothing says how the IMU sits in it \[rad\].
    MovesAside(f64),
}

/// A sensor that measures the motion over ground otherwise than before.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SensorChange {
    /// Between which times it changed \[s\].
    pub between: [f64; 2],
    /// What it does otherwise.
    pub what: ChangeOf,
}

/// What a sensor does otherwise than before.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum ChangeOf {
    /// The vertical gyro measures this multiple of what it measured before, of the same turns [–].
    TurnScale(f64),
    /// The gyros do not measure the turns any more.
    NoTurn,
    /// The sensor is turned about the vertical by this angle, positive clockwise seen from above \[rad\].
    Turned(f64),
    /// The accelerometer along body forward (0) or right (1) measures this multiple of what it measured before [–].
    ForceScale(usize, f64),
}

/// Change that makes positions and velocities of the fixes agree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum FixMend {
    /// The velocity is east, north, not north, east.
    VelocityEastNorth,
    /// Latitude and longitude are swapped.
    PositionSwapped,
    /// The velocity east, or the longitude, has the wrong sign.
    EastReversed,
    /// The velocity north, or the latitude, has the wrong sign.
    NorthReversed,
    /// The velocity has the wrong signs.
    VelocityReversed,
    /// The velocity is in km/h.
    KilometresPerHour,
    /// The velocity is in knots.
    Knots,
    /// The velocity is in ft/s.
    FeetPerSecond,
    /// The velocity is in cm/s.
    CentimetresPerSecond,
    /// The velocity is in mm/s.
    MillimetresPerSecond,
    /// Latitude and longitude are in radians, not in degrees.
    PositionInRadians,
}

/// A span in which the course contradicts the heading.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HeadingOff {
    /// First time that it was seen \[s\].
    pub start: f64,
    /// Last time that it was seen \[s\].
    pub end: f64,
    /// Largest value of course less heading, beyond what is usual \[rad\].
    pub angle: f64,
}

/// Consecutive headings by two antennas that contradicted the solution and were rejected.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RejectedHeadings {
    /// Time of the first \[s\].
    pub start: f64,
    /// Time of the last \[s\].
    pub end: f64,
    /// Number of headings.
    pub headings: u64,
    /// Measured less predicted heading of the last \[rad\].
    pub angle: f64,
    /// Whether they went on for so long that they were believed.
    pub accepted_in_the_end: bool,
}

/// State of a covariance after the rounding of a long log: a healthy one is symmetric and positive definite.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CovarianceHealth {
    /// Number of states with a variance: those of navigation, sensors and parameters.
    pub states: usize,
    /// Largest |P_ij − P_ji| over √(P_ii P_jj) [–].
    pub asymmetry: f64,
    /// Least eigenvalue of the matrix of correlations, P_ij over √(P_ii P_jj) [–]: negative where the matrix has ceased to be a
    /// covariance.
    pub least_eigenvalue: f64,
}

/// A span over which the solution may have gone wrong, as a pass over the log has found, with the error possible at its end, one
/// standard deviation of each axis. In a second pass (`Settings::doubts` of the engine) the covariance grows over the span, so that a smoother
/// spreads the error over it rather than at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Doubt {
    /// Time of the last fix that agreed with the solution \[s\].
    pub start: f64,
    /// Time of the fix that the solution then accepted \[s\].
    pub end: f64,
    /// Standard deviation of the position \[m\].
    pub position: f64,
    /// Standard deviation of the velocity [m/s].
    pub velocity: f64,
    /// Standard deviation of the tilt \[rad\].
    pub tilt: f64,
}

/// A span in which the magnetic field was not the Earth's or changed as it cannot.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DisturbedField {
    /// Time of the last reading before \[s\].
    pub start: f64,
    /// Time of the last one that was disturbed \[s\].
    pub end: f64,
    /// Largest difference of the mean of a second from the predicted field \[T\].
    pub strongest: f64,
}
