//! What can happen in a run that its user should know, as values.

use crate::{
    align::Alignment,
    mounting::Mounting,
    settings::{Doubt, fix_errors::FixErrors},
};

/// An event of the navigation. One that lasts is reported at its start.
///
/// Fixes that are suddenly 100 m off are rejected, and the solution does not follow them:
///
/// ```
/// use undrift_engine::{Event, Navigator, Part, settings::Settings};
/// use undrift_nav::sample::Position;
/// # use undrift_nav::shaping::ShapingFilter;
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
/// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
/// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
/// let mut navigator = Navigator::new(Settings::new(sensors));
/// for mut fix in log.gnss {
///     if let Some((Position::Geodetic(place), _)) = &mut fix.position
///         && (90.0..95.0).contains(&fix.time)
///     {
///         place.lat += 100.0 / 6.37e6; // North.
///     }
///     navigator.fix(fix)?;
/// }
/// for sample in log.imu {
///     navigator.imu(sample)?;
/// }
/// let rejected = navigator.events().into_iter().find_map(|event| match event {
///     Event::Rejected(run) if run.part == Part::Position => Some(run),
///     _ => None,
/// });
/// let rejected = rejected.expect("the gate");
/// assert_eq!((rejected.start, rejected.fixes, rejected.accepted_in_the_end), (90.0, 5, false));
/// assert!((rejected.first - 100.0).abs() < 2.0, "its distance from the solution [m]");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum Event {
    /// Navigation began at this time \[s\], aligned like this.
    Started(f64, Alignment),
    /// Samples of an axis could not be right.
    SampleFault(SampleFault),
    /// Consecutive fixes were rejected; reported when the last of them has passed.
    Rejected(Contradiction),
    /// The solution accepted fixes that contradict it, and its covariance was inflated by this.
    Doubted(Doubt),
    /// The course contradicts the heading.
    HeadingOff(HeadingOff),
    /// Innovations leant to one side.
    Leant(Lean),
    /// The solution ended at this time \[s\] and is aligned again, and why; [`Event::Resumed`] follows.
    AlignsAgain(f64, RestartCause),
    /// From this time \[s\] on the fixes are taken to be wrong by this beyond what they state, as they have shown it.
    FixErrors(f64, FixErrors),
    /// After this time \[s\] body axes are the vehicle's, by this mounting.
    Mounting(f64, Mounting),
    /// Another solution began at this time \[s\].
    Resumed(f64),
    /// The solution diverged at this time \[s\].
    Diverged(f64),
    /// A measurement of this time \[s\] came later than the horizon and was rejected.
    TooLate(f64),
}

impl Event {
    /// When it was seen first \[s\].
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
            Self::Leant(lean) => lean.start,
        }
    }

    /// Whether it is the same one, seen for longer.
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
    /// Which part of them.
    pub part: Part,
    /// Whether it was the height alone; the rest of the positions was used.
    #[cfg_attr(feature = "serde", serde(default))]
    pub height: bool,
    /// Time of the first \[s\].
    pub start: f64,
    /// Time of the last \[s\], with those soon after the solution accepted the fixes.
    pub end: f64,
    /// How many.
    pub fixes: u64,
    /// How far the first was from the solution \[m, m/s\].
    pub first: f64,
    /// How far the last was, at the end or when the solution first accepted the fixes \[m, m/s\].
    pub last: f64,
    /// How fast it grew \[m/s, m/s²\].
    pub growth: f64,
    /// How far the furthest was \[m, m/s\].
    pub largest: f64,
    /// Whether the receiver repeated its fix while the solution moved.
    pub frozen: bool,
    /// Whether they were accepted in the end.
    pub accepted_in_the_end: bool,
}

/// Samples of an axis that could not be right and were replaced.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SampleFault {
    /// 0 to 2 for the gyros x, y, z of the sensor, 3 to 5 for the accelerometers.
    pub axis: usize,
    /// Time of the first sample \[s\].
    pub start: f64,
    /// Time of the last \[s\].
    pub end: f64,
    /// Whether the axis repeated a value; else it was a spike.
    pub stuck: bool,
}

/// The solution was to be aligned again.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Restart {
    /// When that was found \[s\].
    pub time: f64,
    /// Why.
    pub why: RestartCause,
    /// When the new one began \[s\]; `None` if it never did.
    pub resumed: Option<f64>,
}

/// Why a solution was to be aligned again.
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
}

/// A span in which innovations of a kind leaned to one side far more than is usual in the log.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Lean {
    /// Of which part of the fixes.
    pub part: Part,
    /// Start \[s\].
    pub start: f64,
    /// End \[s\].
    pub end: f64,
    /// Largest mean of the innovations over a block, predicted less measured, north, east, down \[m, m/s\].
    pub mean: [f64; 3],
}

/// What cannot be: units, axes, signs or times that are wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Implausible {
    /// The mean specific force, as a multiple of gravity.
    Gravity(f64),
    /// Gravity lies along another axis than body down, which is `[0, 0, 1]` of it.
    Down([f64; 3]),
    /// The course turns by this multiple of the turns of the gyros.
    TurnScale(f64),
    /// The course turns with the gyro of this axis (0 to 2), which is not the vertical one.
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
}

/// What makes positions and velocities of the fixes agree.
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
    /// When it was seen first \[s\].
    pub start: f64,
    /// When it was seen last \[s\].
    pub end: f64,
    /// Course less heading, beyond what is usual, at most \[rad\].
    pub angle: f64,
}
