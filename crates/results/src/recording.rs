//! What is wrong with a recording before it is identified.

use crate::Finding;
use undrift_base::number::rounded;
use undrift_noise::screening::Timing;

/// What the accelerometers' numbers are, more likely than what they are said to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Likely {
    /// Specific forces in this unit.
    Unit(&'static str),
    /// Accelerations without gravity.
    GravityRemoved,
    /// The gyroscopes measure gravity in their place.
    Exchanged,
    /// Velocity increments.
    Increments,
    /// None of those.
    Unknown,
}

/// Why a record is no static recording.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotStatic {
    /// Gravity has a wrong size.
    #[error("the specific force is {} m/s², not 9.81", rounded(*force, 4))]
    Force {
        /// Median magnitude [m/s²].
        force: f64,
        /// What the numbers are instead.
        likely: Likely,
        /// Unit of the gyros as stated, if they have one.
        gyro_unit: String,
    },
    /// Raw counts called a unit.
    #[error("{axis} has whole numbers alone, from {} to {}, which are raw counts and not {unit}", range[0], range[1])]
    Counts {
        /// The axis.
        axis: &'static str,
        /// Unit as stated.
        unit: String,
        /// Unit of the accelerometers as stated.
        accel_unit: String,
        /// Least and largest number.
        range: [f64; 2],
    },
    /// An axis turns faster than a constant of the sensor explains.
    #[error("{axis} reads {} deg/s on average, more than any sensor at rest", rounded(rate.to_degrees(), 4))]
    Turning {
        /// The axis.
        axis: &'static str,
        /// Mean rate [rad/s].
        rate: f64,
    },
    /// Rates called rad/s that scatter as deg/s do.
    #[error("{axis} scatters by {} deg/s from sample to sample, more than any sensor at rest", rounded(scatter.to_degrees(), 3))]
    Scattering {
        /// The axis.
        axis: &'static str,
        /// Its quietest scatter [rad/s].
        scatter: f64,
        /// Unit of the accelerometers as stated.
        accel_unit: String,
    },
    /// The sensor moves.
    #[error("the IMU moves in {moving_s:.0} of {length_s:.0} s")]
    Moving {
        /// Time in motion \[s\].
        moving_s: f64,
        /// Length of the record \[s\].
        length_s: f64,
        /// Longest rest, from its start to its end after the record's first sample \[s\].
        rest: Option<(f64, f64)>,
    },
}

/// A sensor whose samples are fewer than the record's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slower {
    /// Whether it is the gyroscopes, else the accelerometers.
    pub gyro: bool,
    /// Its own rate \[Hz\]; 0 if all its samples are zero, and it is excluded.
    pub rate_hz: f64,
}

/// A sensor whose samples were repeated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repeated {
    /// Whether it is the gyroscopes, else the accelerometers.
    pub gyro: bool,
    /// Samples of the record to each of its own.
    pub times: f64,
}

/// Stamps that are not evenly spaced.
#[derive(Clone, Debug, PartialEq)]
pub struct Uneven<'a> {
    /// How they are spaced.
    pub timing: &'a Timing,
    /// Whether the gaps were filled, with samples that are not known.
    pub filled: bool,
    /// What was found.
    pub finding: Finding,
}
