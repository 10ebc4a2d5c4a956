//! What the filter takes in: inertial increments, GNSS fixes, measurements of one number, and magnetic fields.
//!
//! All times are seconds of one time base, the log's own; whoever reads a log brings its clocks together first. Frames and
//! letters: docs/conventions.md.

use crate::{Matrix3, Quaternion, Vector3, earth::Geodetic};

/// Sensor axes of an inertial unit: gyro x, y, z, then accelerometer x, y, z. Every array of this length in the workspace has
/// that order.
pub const AXES: usize = 6;

/// One inertial sample as increments over the interval `(time − dt, time]`, body axes `b`: forward, right, down.
///
/// Increments rather than rates, since that is what the mechanisation integrates: a rate of a sensor is the mean over its
/// interval, so that `Δθ = ω dt` ([`ImuSample::from_rates`]). A sensor at rest and level reads an upward specific force, about
/// `dvel = (0, 0, −9.8) · dt`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ImuSample {
    /// End of the interval \[s\], in the log's time base.
    pub time: f64,
    /// Length of the interval \[s\].
    /// Above 0 and at most [`LONGEST_STEP`](crate::filter::LONGEST_STEP).
    pub dt: f64,
    /// Integrated angular rate ∫ω_ib^b dt \[rad\].
    /// Positive by the right-hand rule: a right turn has a positive z.
    pub dtheta: Vector3,
    /// Integrated specific force ∫f^b dt [m/s].
    /// Gravity is not part of it: free fall reads zero.
    pub dvel: Vector3,
}

impl ImuSample {
    /// The sample of a sensor that gives rates: angular rate [rad/s] and specific force [m/s²], body axes, that hold over the
    /// `dt` \[s\] up to `time` \[s\].
    ///
    /// ```
    /// use undrift_nav::{Vector3, sample::ImuSample};
    /// // At rest and level, the reading over the 10 ms up to 3 s.
    /// let sample = ImuSample::from_rates(3.0, 0.01, [0.0, 0.0, 7e-5], [0.0, 0.0, -9.81]);
    /// assert!((sample.dvel - Vector3::new(0.0, 0.0, -0.0981)).norm() < 1e-15);
    /// ```
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

/// Place of the antenna in a position fix, and the frame `m` in which its error is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Position {
    /// Antenna on the WGS-84 ellipsoid; errors are north, east, down at the antenna \[m\].
    Geodetic(Geodetic),
    /// Antenna relative to a base station, as RTK receivers give it: north, east, down of the base \[m\]. Over a baseline of
    /// some kilometres these axes differ from those at the antenna, which the filter takes into account.
    Baseline {
        /// Place of the base station on the ellipsoid.
        base: Geodetic,
        /// Baseline base → antenna \[m\], north-east-down of the base.
        ned: Vector3,
    },
}

/// One GNSS epoch of the antenna: position, velocity, or both; or one pose of a marker, which has an attitude, too.
///
/// Covariances are what the filter weighs a fix by: symmetric and positive definite, with variances that are not zero. Made
/// with [`GnssFix::at`] and [`GnssFix::with_velocity`] from standard deviations, or field by field with full matrices.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GnssFix {
    /// Time of validity \[s\], in the same base as the inertial samples.
    /// Receivers stamp fixes late by up to a few tenths of a second; the filter can estimate that offset
    /// ([`Parameter::TimeOffset`](crate::parameters::Parameter::TimeOffset)).
    pub time: f64,
    /// Position with its covariance \[m²\]: north-east-down at the antenna, or of the base for a baseline.
    pub position: Option<(Position, Matrix3)>,
    /// Velocity over ground north-east-down [m/s] with its covariance [(m/s)²].
    /// It is the antenna's velocity: in a turn the lever arm moves it against the IMU's.
    pub velocity: Option<(Vector3, Matrix3)>,
    /// Mean velocity of the antenna over the time up to the fix, by the carrier phase, where the receiver's observations give one. A filter
    /// that knows the way since the fix before uses it in place of `velocity` ([`Filter::observe_mean_velocity`](crate::filter::Filter::observe_mean_velocity)).
    pub mean_velocity: Option<MeanVelocity>,
    /// Attitude of the marker, `q_nk`, which turns vectors of the marker's axes into north, east, down, and the covariance of its
    /// error as a small rotation about north, east, down \[rad²\]. Motion capture, visual and laser odometry have one; how the marker's
    /// axes lie in the body is stated where it is used ([`Filter::observe_attitude`](crate::filter::Filter::observe_attitude)).
    pub attitude: Option<(Quaternion, Matrix3)>,
    /// Kind of solution as the receiver states it. The filter weighs a fix by its covariances alone; a navigator may be set to
    /// replace them by what is usual of the kind.
    pub quality: FixQuality,
}

impl GnssFix {
    /// A position of the antenna at `time` \[s\], with standard deviations north, east, down \[m\].
    ///
    /// ```
    /// use undrift_nav::{earth::Geodetic, sample::GnssFix};
    /// let place = Geodetic::from_degrees(47.3769, 8.5417, 408.0);
    /// let fix = GnssFix::at(12.0, place, [1.5, 1.5, 3.0]).with_velocity([9.8, 0.3, 0.0], [0.1, 0.1, 0.2]);
    /// let (_, covariance) = fix.position.unwrap();
    /// assert_eq!(covariance[(2, 2)], 9.0); // [m²]
    /// assert!(fix.is_finite());
    /// ```
    pub fn at(time: f64, place: Geodetic, std: impl Into<Vector3>) -> Self {
        Self {
            time,
            position: Some((Position::Geodetic(place), variances(std.into()))),
            velocity: None,
            mean_velocity: None,
            attitude: None,
            quality: FixQuality::Unknown,
        }
    }

    /// This fix with an attitude `q_nk` of the marker and its standard deviations about north, east, down \[rad\]. An attitude it had is
    /// replaced.
    ///
    /// ```
    /// use undrift_nav::{Quaternion, earth::Geodetic, sample::GnssFix};
    /// // Motion capture: a millimetre and a tenth of a degree.
    /// let std = [0.1_f64.to_radians(); 3];
    /// let pose = GnssFix::at(3.0, Geodetic::default(), [1e-3; 3]).with_attitude(Quaternion::identity(), std);
    /// let (_, covariance) = pose.attitude.unwrap();
    /// assert_eq!(covariance[(0, 0)], std[0] * std[0]); // [rad²]
    /// ```
    pub fn with_attitude(self, q_nk: Quaternion, std: impl Into<Vector3>) -> Self {
        Self {
            attitude: Some((q_nk, variances(std.into()))),
            ..self
        }
    }

    /// This fix with a velocity of the antenna over ground [m/s], north, east, down, and its standard deviations in the same
    /// order [m/s]. A velocity it had is replaced.
    pub fn with_velocity(self, v_n: impl Into<Vector3>, std: impl Into<Vector3>) -> Self {
        Self {
            velocity: Some((v_n.into(), variances(std.into()))),
            ..self
        }
    }

    /// Whether its time, and every component and covariance that it has, is finite. A fix for which this is false must not reach a filter.
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
        let of_attitude = |(q, r): &(Quaternion, Matrix3)| {
            let mut numbers = q.coords.iter().chain(r.iter());
            numbers.all(|v| v.is_finite())
        };
        let of_mean = |mean: &MeanVelocity| {
            of_velocity(&(mean.v_n, mean.covariance)) && mean.over.is_finite() && mean.over > 0.0
        };
        self.time.is_finite()
            && self.position.as_ref().is_none_or(of_position)
            && self.mean_velocity.as_ref().is_none_or(of_mean)
            && self.velocity.as_ref().is_none_or(of_velocity)
            && self.attitude.as_ref().is_none_or(of_attitude)
    }
}

fn variances(std: Vector3) -> Matrix3 {
    Matrix3::from_diagonal(&std.component_mul(&std))
}

/// Way of the antenna over a time that ends with a fix, divided by that time.
///
/// Its error is white from one to the next only nearly: neighbours share an epoch, whose noise enters them with opposite signs. To take them as
/// independent overstates the error of the way over several.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MeanVelocity {
    /// Length of the time \[s\], above 0.
    pub over: f64,
    /// Mean velocity over ground, north, east, down [m/s].
    pub v_n: Vector3,
    /// Its covariance [(m/s)²]: some 1e4 along a direction that few satellites do not show.
    pub covariance: Matrix3,
    /// Place of the antenna for which it was found.
    pub place: Geodetic,
    /// By how much it changes with that place, north, east, down of both [1/s]: satellites turn as seen from the Earth.
    pub by_place: Matrix3,
}

impl MeanVelocity {
    /// Directions that it shows, north, east, down, whose errors are independent, with their variances [(m/s)²].
    pub fn directions(&self) -> impl Iterator<Item = (Vector3, f64)> {
        let split = self.covariance.symmetric_eigen();
        (0..3)
            .map(move |k| {
                (
                    split.eigenvectors.column(k).into_owned(),
                    split.eigenvalues[k],
                )
            })
            .filter(|(_, variance)| *variance < SHOWN * SHOWN)
    }
}

/// Standard deviation up to which a direction counts as shown by satellites [m/s].
const SHOWN: f64 = 10.0;

/// Kind of GNSS solution, from the coarsest to the finest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FixQuality {
    /// The file does not say.
    #[default]
    Unknown,
    /// Code solution without corrections: some metres.
    Single,
    /// Differential code, a satellite-based augmentation, or precise point positioning: from some decimetres to a metre.
    Differential,
    /// Carrier phase with ambiguities not resolved to integers: decimetres.
    Float,
    /// Carrier phase with ambiguities resolved: centimetres, unless they were resolved wrongly.
    Fixed,
}

/// A measurement of one number: a wheel speed [m/s], a barometric height \[m\]. What it is, and its unit, follows from the function that takes it.
///
/// ```
/// use undrift_nav::{earth::standard_height, sample::Scalar};
/// // A pressure sensor: 12 Pa are a metre near the ground.
/// let height = Scalar { time: 7.25, value: standard_height(98_000.0), std: 1.0 };
/// assert!(height.is_finite() && (270.0..290.0).contains(&height.value));
/// assert!(!Scalar { std: f64::NAN, ..height }.is_finite());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Scalar {
    /// Time \[s\], in the same base as the inertial samples.
    pub time: f64,
    /// The number, in the SI unit of the quantity.
    pub value: f64,
    /// Its standard deviation, in the unit of `value`; above 0.
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

/// What a magnetometer measures: the Earth's field and what the vehicle adds to it.
///
/// ```
/// use undrift_nav::{Vector3, sample::MagneticField};
/// // Level and facing magnetic north in Europe, a reading of 0.5 µT: the field is steep.
/// let reading = MagneticField { time: 7.25, field: Vector3::new(20e-6, 0.0, 44e-6), std: 0.5e-6 };
/// assert!(reading.is_finite() && !MagneticField { time: f64::NAN, ..reading }.is_finite());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MagneticField {
    /// Time \[s\], in the same base as the inertial samples.
    pub time: f64,
    /// The field, body axes \[T\].
    pub field: Vector3,
    /// Standard deviation of the white noise of each axis \[T\]; above 0.
    pub std: f64,
}

impl MagneticField {
    /// Whether its time and its numbers are finite.
    pub fn is_finite(&self) -> bool {
        let mut numbers = self.field.iter().chain([&self.time, &self.std]);
        numbers.all(|v| v.is_finite())
    }
}

/// A reference solution at one instant, at the IMU: what a solution is compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthSample {
    /// Time \[s\], in the same base as the inertial samples.
    pub time: f64,
    /// Position of the IMU, not of an antenna.
    pub position: Geodetic,
    /// Velocity over ground north-east-down [m/s]; absent where the file has none.
    pub v_n: Option<Vector3>,
    /// Roll, pitch, yaw \[rad\]; absent where the file has none.
    /// Of the body axes, [`attitude::to_rpy`](crate::attitude::to_rpy).
    pub rpy: Option<Vector3>,
}
