//! Names: kinds of measurements, by which updates are counted, and logs.

use alloc::string::String;

/// A kind of measurement, by which updates are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aid {
    /// GNSS positions.
    Position,
    /// GNSS velocities.
    Velocity,
    /// Non-holonomic constraint: no velocity across or through the road.
    NonHolonomic,
    /// Motion through the air: drag of rotors, velocity of an aircraft in trim.
    Air,
    /// Zero-velocity updates at rest, with those of the angular rate.
    ZeroVelocity,
    /// Wheel speeds.
    Odometer,
    /// Barometric heights.
    Barometer,
    /// Headings by two antennas.
    Heading,
    /// Magnetic fields, each the mean of up to a second.
    Magnetometer,
    /// Attitudes of a marker.
    Attitude,
}

impl Aid {
    /// Every kind, in the order in which they are reported.
    pub const ALL: [Self; 10] = [
        Self::Position,
        Self::Velocity,
        Self::NonHolonomic,
        Self::Air,
        Self::ZeroVelocity,
        Self::Odometer,
        Self::Barometer,
        Self::Heading,
        Self::Magnetometer,
        Self::Attitude,
    ];
    /// Number of kinds.
    pub const COUNT: usize = Self::ALL.len();

    /// Its name in tables, in lower case.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::NonHolonomic => "non-holonomic",
            Self::Air => "air",
            Self::ZeroVelocity => "zero velocity",
            Self::Odometer => "odometer",
            Self::Barometer => "barometer",
            Self::Heading => "heading",
            Self::Magnetometer => "magnetometer",
            Self::Attitude => "attitude",
        }
    }

    /// Its field in results: the name with underscores for spaces and hyphens.
    ///
    /// ```
    /// use undrift_events::Aid;
    /// assert_eq!((Aid::ZeroVelocity.key(), Aid::NonHolonomic.key()), ("zero_velocity".into(), "non_holonomic".into()));
    /// ```
    pub fn key(self) -> String {
        self.name().replace([' ', '-'], "_")
    }

    /// The updates of this kind, as a heading.
    pub const fn counted(self) -> &'static str {
        match self {
            Self::Position => "Position updates.",
            Self::Velocity => "Velocity updates.",
            Self::NonHolonomic => "Non-holonomic constraints.",
            Self::Air => "Constraints of the air.",
            Self::ZeroVelocity => "Zero-velocity updates.",
            Self::Odometer => "Odometer updates.",
            Self::Barometer => "Barometer updates.",
            Self::Heading => "Heading updates.",
            Self::Magnetometer => "Magnetometer updates.",
            Self::Attitude => "Attitude updates.",
        }
    }
}

/// A file of a drive by what it contains, as findings name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Log {
    /// Inertial samples.
    Imu,
    /// GNSS fixes.
    Gnss,
    /// Reference solution.
    Truth,
    /// Wheel speeds.
    Odometer,
    /// Barometric heights.
    Barometer,
    /// Headings by two antennas.
    Heading,
    /// Magnetic fields.
    Magnetometer,
    /// Static recording for identification.
    Recording,
}

impl Log {
    /// Its name in messages, in lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Imu => "IMU",
            Self::Gnss => "GNSS",
            Self::Truth => "truth",
            Self::Odometer => "odometer",
            Self::Barometer => "barometer",
            Self::Heading => "heading",
            Self::Magnetometer => "magnetometer",
            Self::Recording => "recording",
        }
    }
}

/// A sensor that measures one number, and the log of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScalarLog {
    /// Speeds of a wheel, forward positive \[m/s\].
    Odometer,
    /// Heights above any reference, up positive \[m\].
    Barometer,
    /// Azimuths of a second antenna as seen from the first, from north to east \[rad\].
    Heading,
}

impl ScalarLog {
    /// Every kind, in the order in which they are read.
    pub const ALL: [Self; 3] = [Self::Odometer, Self::Barometer, Self::Heading];

    /// Its table in a drive file.
    pub fn name(self) -> &'static str {
        self.log().name()
    }

    /// What the log contains, as a sentence.
    pub fn described(self) -> &'static str {
        match self {
            Self::Odometer => "The log of wheel speeds.",
            Self::Barometer => "The log of heights.",
            Self::Heading => "The log of headings.",
        }
    }

    /// The log that findings name for it.
    pub fn log(self) -> Log {
        match self {
            Self::Odometer => Log::Odometer,
            Self::Barometer => Log::Barometer,
            Self::Heading => Log::Heading,
        }
    }

    /// The kind of measurement that its updates are counted by.
    pub fn aid(self) -> Aid {
        match self {
            Self::Odometer => Aid::Odometer,
            Self::Barometer => Aid::Barometer,
            Self::Heading => Aid::Heading,
        }
    }
}
