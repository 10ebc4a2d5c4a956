//! What the filter takes in: inertial increments, GNSS fixes, and measurements of one number.

use crate::{Matrix3, Vector3, earth::Geodetic};

/// Sensor axes: gyro x, y, z, accelerometer x, y, z.
pub const AXES: usize = 6;

/// One inertial sample as increments over the interval `(time − dt, time]`, body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ImuSample {
    /// End of the interval \[s\], in the log's time base.
    pub time: f64,
    /// Length of the interval \[s\].
    pub dt: f64,
    /// Integrated angular rate ∫ω_ib^b dt \[rad\].
    pub dtheta: Vector3,
    /// Integrated specific force ∫f^b dt [m/s].
    pub dvel: Vector3,
}

impl ImuSample {
    /// The sample of a sensor that gives rates: angular rate [rad/s] and specific force [m/s²], body axes, that hold over the
    /// `dt` \[s\] up to `time` \[s\].
    pub fn from_rates(
        time: f64,
        dt: f64,
        omega_ib_b: impl Into<Vector3>,
        force_b: impl Into<Vector3>,
    ) -> Self {
        Self {
            time,
            dt,
            dtheta: omega_ib_b.into() * dt,
            dvel: force_b.into() * dt,
        }
    }
}

/// Where a position fix is, and relative to what.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Position {
    /// Antenna position on the ellipsoid.
    Geodetic(Geodetic),
    /// Antenna relative to a base station, in the base's own north-east-down frame \[m\].
    Baseline {
        /// The base station.
        base: Geodetic,
        /// Baseline base → antenna \[m\], north-east-down of the base.
        ned: Vector3,
    },
}

/// One GNSS epoch of the antenna: position, velocity, or both.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GnssFix {
    /// Time of validity \[s\], in the same base as the inertial samples.
    pub time: f64,
    /// Position with its covariance \[m²\]: north-east-down at the antenna, or of the base for a baseline.
    pub position: Option<(Position, Matrix3)>,
    /// Velocity over ground north-east-down [m/s] with its covariance [(m/s)²].
    pub velocity: Option<(Vector3, Matrix3)>,
    /// What kind of solution the receiver calls it.
    pub quality: FixQuality,
}

impl GnssFix {
    /// A position of the antenna at `time` \[s\], with standard deviations north, east, down \[m\].
    pub fn at(time: f64, place: Geodetic, std: impl Into<Vector3>) -> Self {
        Self {
            time,
            position: Some((Position::Geodetic(place), variances(std.into()))),
            velocity: None,
            quality: FixQuality::Unknown,
        }
    }

    /// The fix with a velocity of the antenna over ground [m/s], north, east, down, and standard deviations.
    pub fn with_velocity(self, v_n: impl Into<Vector3>, std: impl Into<Vector3>) -> Self {
        Self {
            velocity: Some((v_n.into(), variances(std.into()))),
            ..self
        }
    }

    /// Whether its time and every number of it is finite.
    pub fn is_finite(&self) -> bool {
        let of_position = |(position, r): &(Position, Matrix3)| {
            let (place, ned) = match position {
                Position::Geodetic(place) => (place, Vector3::zeros()),
                Position::Baseline { base, ned } => (base, *ned),
            };
            [place.lat, place.lon, place.height]
                .iter()
                .chain(ned.iter())
                .chain(r.iter())
                .all(|v| v.is_finite())
        };
        let of_velocity =
            |(v, r): &(Vector3, Matrix3)| v.iter().chain(r.iter()).all(|v| v.is_finite());
        self.time.is_finite()
            && self.position.as_ref().is_none_or(of_position)
            && self.velocity.as_ref().is_none_or(of_velocity)
    }
}

fn variances(std: Vector3) -> Matrix3 {
    Matrix3::from_diagonal(&std.component_mul(&std))
}

/// Kind of GNSS solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FixQuality {
    /// The file does not say.
    #[default]
    Unknown,
    /// Code solution without corrections.
    Single,
    /// Differential code or precise point positioning.
    Differential,
    /// Carrier phase, ambiguities not resolved.
    Float,
    /// Carrier phase, ambiguities resolved.
    Fixed,
}

/// A measurement of one number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Scalar {
    /// Time \[s\], in the same base as the inertial samples.
    pub time: f64,
    /// The number: speed [m/s] of an odometer, height \[m\] of a barometer.
    pub value: f64,
    /// Its standard deviation, in the same unit.
    pub std: f64,
}

impl Scalar {
    /// Whether its time and both numbers are finite.
    pub fn is_finite(&self) -> bool {
        [self.time, self.value, self.std]
            .iter()
            .all(|v| v.is_finite())
    }
}

/// A reference solution at one instant, at the IMU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthSample {
    /// Time \[s\], in the same base as the inertial samples.
    pub time: f64,
    /// Position of the IMU.
    pub position: Geodetic,
    /// Velocity over ground north-east-down [m/s]; absent where the file has none.
    pub v_n: Option<Vector3>,
    /// Roll, pitch, yaw \[rad\]; absent where the file has none.
    pub rpy: Option<Vector3>,
}
