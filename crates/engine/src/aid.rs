//! What aids the solution besides the inertial samples.
//!
//! Here are the names by which updates are counted, what is pushed, and what a filter is updated with. The rows
//! themselves are those of [`undrift_nav::filter::Filter`]. Fixes are judged by [`crate::receiver`], what is known of a
//! vehicle's motion is used when [`crate::constraints`] says so. How to add one: `docs/lab/add-a-measurement.md`.

mod gnss;

use alloc::{string::String, vec::Vec};
use core::ops::{Index, IndexMut};
use undrift_nav::{
    Vector3,
    aiding::Observation,
    filter::Filter,
    sample::{GnssFix, Position, Scalar},
};

/// Stamps closer than this \[s\] are the same instant.
pub const STAMP_ROUNDING: f64 = 1e-6;

/// A kind of measurement, as updates are counted ([`Summary::innovations`](crate::Summary::innovations)).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aid {
    /// Positions of fixes.
    Position,
    /// Velocities of fixes.
    Velocity,
    /// Non-holonomic constraint: no velocity across or through the road.
    NonHolonomic,
    /// Zero-velocity updates at rest, with those of the angular rate.
    ZeroVelocity,
    /// Wheel speeds.
    Odometer,
    /// Heights.
    Barometer,
}

impl Aid {
    /// All of them, in the order in which they are reported.
    pub const ALL: [Self; 6] = [
        Self::Position,
        Self::Velocity,
        Self::NonHolonomic,
        Self::ZeroVelocity,
        Self::Odometer,
        Self::Barometer,
    ];
    /// How many there are.
    pub const COUNT: usize = Self::ALL.len();

    /// What it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::NonHolonomic => "non-holonomic",
            Self::ZeroVelocity => "zero velocity",
            Self::Odometer => "odometer",
            Self::Barometer => "barometer",
        }
    }

    /// Its field in results: the name with underscores.
    pub fn key(self) -> String {
        self.name().replace([' ', '-'], "_")
    }

    /// What is counted of it.
    pub const fn counted(self) -> &'static str {
        match self {
            Self::Position => "Position updates.",
            Self::Velocity => "Velocity updates.",
            Self::NonHolonomic => "Non-holonomic constraints.",
            Self::ZeroVelocity => "Zero-velocity updates.",
            Self::Odometer => "Odometer updates.",
            Self::Barometer => "Barometer updates.",
        }
    }
}

/// A value for each [`Aid`], read and written as `table[aid]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct ByAid<T>(pub [T; Aid::COUNT]);

impl<T> Index<Aid> for ByAid<T> {
    type Output = T;

    fn index(&self, aid: Aid) -> &T {
        &self.0[aid as usize]
    }
}

impl<T> IndexMut<Aid> for ByAid<T> {
    fn index_mut(&mut self, aid: Aid) -> &mut T {
        &mut self.0[aid as usize]
    }
}

/// A log of a drive, or a static recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Log {
    /// Inertial samples.
    Imu,
    /// Fixes.
    Gnss,
    /// The reference.
    Truth,
    /// Speeds.
    Odometer,
    /// Heights.
    Barometer,
    /// A static recording.
    Recording,
}

impl Log {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Imu => "IMU",
            Self::Gnss => "GNSS",
            Self::Truth => "truth",
            Self::Odometer => "odometer",
            Self::Barometer => "barometer",
            Self::Recording => "recording",
        }
    }
}

/// A sensor that measures one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScalarLog {
    /// Speeds of a wheel, forward positive \[m/s\].
    Odometer,
    /// Heights \[m\].
    Barometer,
}

impl ScalarLog {
    /// All of them, in the order in which they are read.
    pub const ALL: [Self; 2] = [Self::Odometer, Self::Barometer];

    /// What it is called.
    pub fn name(self) -> &'static str {
        self.log().name()
    }

    /// What it is a log of, as a sentence.
    pub fn described(self) -> &'static str {
        match self {
            Self::Odometer => "The log of wheel speeds.",
            Self::Barometer => "The log of heights.",
        }
    }

    /// The log that findings name.
    pub fn log(self) -> Log {
        match self {
            Self::Odometer => Log::Odometer,
            Self::Barometer => Log::Barometer,
        }
    }

    /// What its updates are counted by.
    pub fn aid(self) -> Aid {
        match self {
            Self::Odometer => Aid::Odometer,
            Self::Barometer => Aid::Barometer,
        }
    }

    /// A number of it as the navigator takes it.
    pub fn measurement(self, scalar: Scalar) -> Measurement {
        match self {
            Self::Odometer => Measurement::Odometer(scalar),
            Self::Barometer => Measurement::Barometer(scalar),
        }
    }
}

/// One measurement, as it is pushed into a [`Navigator`](crate::Navigator).
///
/// ```
/// use undrift_engine::{Aid, Measurement, Navigator, Scalar, settings::Settings, vehicle::Profile};
/// # use undrift_nav::shaping::ShapingFilter;
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
/// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
/// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
/// let constraints = Profile::Car.constraints();
/// let mut navigator = Navigator::new(Settings { constraints, ..Settings::new(sensors) });
/// let mut measurements = Measurement::of_fixes(&log.gnss);
/// for row in log.truth.iter().step_by(25) {
///     let speed = row.v_n.expect("simulated").norm(); // A car that drives forward.
///     measurements.push(Measurement::Odometer(Scalar { time: row.time, value: speed, std: 0.1 }));
/// }
/// for measurement in measurements {
///     navigator.measure(measurement)?; // Each waits until the samples reach its time.
/// }
/// for sample in log.imu {
///     navigator.imu(sample)?;
/// }
/// let odometer = navigator.summary().innovations[Aid::Odometer];
/// assert!(odometer.updates > 50 && odometer.rejected == 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
#[expect(
    clippy::large_enum_variant,
    reason = "passed on one by one; in memory most are fixes"
)]
pub enum Measurement {
    /// A GNSS fix.
    Gnss(GnssFix),
    /// Speed of a wheel, forward positive [m/s].
    Odometer(Scalar),
    /// Height by the barometer \[m\].
    Barometer(Scalar),
}

impl Measurement {
    /// Fixes as measurements.
    pub fn of_fixes(fixes: &[GnssFix]) -> Vec<Self> {
        fixes.iter().copied().map(Self::Gnss).collect()
    }

    /// Time as stamped \[s\].
    pub fn time(&self) -> f64 {
        match self {
            Self::Gnss(fix) => fix.time,
            Self::Odometer(s) | Self::Barometer(s) => s.time,
        }
    }

    /// What it is, where a time or a value of it is not finite.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        let (what, finite) = match self {
            Self::Gnss(fix) => ("fix", fix.is_finite()),
            Self::Odometer(speed) => ("wheel speed", speed.is_finite()),
            Self::Barometer(height) => ("height", height.is_finite()),
        };
        (!finite).then_some(what)
    }

    /// Whether it says nothing before the mounting is known.
    pub(crate) fn needs_vehicle_axes(&self) -> bool {
        matches!(self, Self::Odometer(_))
    }

    /// A measurement of one number, what it is counted as and how the filter takes it; the odometer's wheel is at
    /// `odometer_lever` [m, body axes]. Fixes are judged by their receiver.
    pub(crate) fn scalar(&self, odometer_lever: &Vector3) -> Option<(Scalar, Aid, Aiding)> {
        Some(match *self {
            Self::Gnss(_) => return None,
            Self::Odometer(speed) => {
                let aiding = Aiding::Odometer {
                    speed: speed.value,
                    lever_arm: *odometer_lever,
                };
                (speed, Aid::Odometer, aiding)
            }
            Self::Barometer(height) => (height, Aid::Barometer, Aiding::Barometer(height.value)),
        })
    }

    /// Its place among those of one time: fixes come first.
    pub(crate) fn rank(&self) -> u8 {
        match self {
            Self::Gnss(_) => 0,
            Self::Odometer(_) => 1,
            Self::Barometer(_) => 2,
        }
    }
}

/// A measurement that a filter is updated with: [`Estimator::innovation`](crate::estimator::Estimator::innovation) and
/// [`Estimator::update`](crate::estimator::Estimator::update) take it with its covariance. Rows and signs of each:
/// docs/lab/measurement-rows.md.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aiding {
    /// GNSS position.
    Position {
        /// As measured.
        position: Position,
        /// IMU → antenna, body axes \[m\].
        lever_arm: Vector3,
        /// Standard deviation of the time-correlated part of its error, in its own axes \[m\].
        correlated: Vector3,
        /// When it holds \[s\]: the filter is there or after it.
        due: f64,
    },
    /// GNSS velocity.
    Velocity {
        /// North-east-down \[m/s\].
        v_n: Vector3,
        /// IMU → antenna, body axes \[m\].
        lever_arm: Vector3,
        /// Standard deviation of the time-correlated part of its error \[m/s\].
        correlated: Vector3,
        /// When it holds \[s\]: the filter is there or after it.
        due: f64,
    },
    /// Heading by the course over ground \[rad\].
    Course(f64),
    /// The vehicle is at rest.
    ZeroVelocity,
    /// The body turns with the Earth: angular rate as read \[rad/s\].
    EarthRate(Vector3),
    /// The body is at rest: specific force as read \[m/s²\].
    Level(Vector3),
    /// No velocity across the vehicle at this point, IMU → axle, body axes \[m\].
    NonHolonomic(Vector3),
    /// Speed of a wheel.
    Odometer {
        /// Forward positive \[m/s\].
        speed: f64,
        /// IMU → wheel, body axes \[m\].
        lever_arm: Vector3,
    },
    /// Height by a barometer \[m\].
    Barometer(f64),
}

/// What an update belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// GNSS position.
    Position,
    /// GNSS velocity.
    Velocity,
    /// No velocity across the vehicle.
    NonHolonomic,
    /// Any other.
    Other,
}

impl Aiding {
    /// A measurement of one number by its name, in SI units, of the sensor at `lever_arm` [m, body axes] where that matters.
    pub fn scalar(name: &str, value: f64, lever_arm: Vector3) -> Option<Self> {
        Some(match name {
            "course" => Self::Course(value),
            "odometer" => Self::Odometer {
                speed: value,
                lever_arm,
            },
            "barometer" => Self::Barometer(value),
            _ => return None,
        })
    }

    pub(crate) fn channel(&self) -> Channel {
        match self {
            Self::Position { .. } => Channel::Position,
            Self::Velocity { .. } => Channel::Velocity,
            Self::NonHolonomic(_) => Channel::NonHolonomic,
            _ => Channel::Other,
        }
    }
}

/// A measurement as the filter takes it, by the number of its components.
pub(crate) enum Observed<const N: usize> {
    One(Observation<1, N>),
    Two(Observation<2, N>),
    Three(Observation<3, N>),
}

/// What a measurement says to a filter; `None` where it says nothing.
pub(crate) fn observe<const N: usize>(filter: &Filter<N>, aiding: &Aiding) -> Option<Observed<N>> {
    Some(match aiding {
        Aiding::Position {
            position,
            lever_arm,
            correlated,
            due,
        } => Observed::Three(gnss::observe_position(
            filter, position, lever_arm, correlated, *due,
        )),
        Aiding::Velocity {
            v_n,
            lever_arm,
            correlated,
            due,
        } => Observed::Three(gnss::observe_velocity(
            filter, v_n, lever_arm, correlated, *due,
        )),
        Aiding::Course(course) => Observed::One(filter.observe_course(*course)?),
        Aiding::ZeroVelocity => Observed::Three(filter.observe_zero_velocity()),
        Aiding::EarthRate(rate) => Observed::Three(filter.observe_earth_rate(rate)),
        Aiding::Level(force) => Observed::Two(filter.observe_level(force)),
        Aiding::NonHolonomic(axle) => Observed::Two(filter.observe_non_holonomic(axle)),
        Aiding::Odometer { speed, lever_arm } => {
            Observed::One(filter.observe_odometer(*speed, lever_arm))
        }
        Aiding::Barometer(height) => Observed::One(filter.observe_barometer(*height)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_by_their_names() {
        let lever_arm = Vector3::new(1.0, 2.0, 3.0);
        let of = |name| Aiding::scalar(name, 4.0, lever_arm);
        assert_eq!(of("course"), Some(Aiding::Course(4.0)));
        let speed = 4.0;
        assert_eq!(of("odometer"), Some(Aiding::Odometer { speed, lever_arm }));
        assert_eq!(of("barometer"), Some(Aiding::Barometer(4.0)));
        assert_eq!(of("position"), None);
    }
}
