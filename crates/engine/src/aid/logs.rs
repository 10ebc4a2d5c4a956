//! The logs of a drive by what they contain.

use super::{Aid, Measurement};
use undrift_nav::sample::Scalar;

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

    /// `scalar`, in SI units, as the measurement that a [`Navigator`](crate::Navigator) is pushed.
    ///
    /// ```
    /// use undrift_engine::{Aid, Scalar, ScalarLog};
    /// let row = Scalar { time: 3.0, value: 412.0, std: 1.0 };
    /// assert_eq!(ScalarLog::Barometer.measurement(row).time(), 3.0);
    /// assert_eq!((ScalarLog::Barometer.aid(), ScalarLog::Odometer.name()), (Aid::Barometer, "odometer"));
    /// ```
    pub fn measurement(self, scalar: Scalar) -> Measurement {
        match self {
            Self::Odometer => Measurement::Odometer(scalar),
            Self::Barometer => Measurement::Barometer(scalar),
            Self::Heading => Measurement::Heading(scalar),
        }
    }
}
