//! What aids the solution besides the inertial samples.
//!
//! Here are the names by which updates are counted, what is pushed, and what a filter is updated with. The rows
//! themselves are those of [`undrift_nav::filter::Filter`]. Fixes are judged by [`crate::receiver`], what is known of a
//! vehicle's motion is used when [`crate::constraints`] says so. How to add one: `docs/lab/add-a-measurement.md`.

mod by_aid;
mod channel;
mod gnss;
mod pose;
mod rest;

pub use by_aid::ByAid;
pub use channel::Channel;

use crate::vehicle::Constraints;
use alloc::vec::Vec;
use undrift_events::{Aid, ScalarLog};
use undrift_nav::{
    Quaternion, Vector3,
    aiding::{Observation, Stretch},
    filter::Filter,
    sample::{GnssFix, MagneticField, MeanVelocity, Position, Scalar},
};

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
/// let mut measurements = Measurement::from_fixes(&log.gnss);
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
    /// A GNSS fix of the antenna: position, velocity or both.
    Gnss(GnssFix),
    /// Speed of a wheel, forward positive [m/s], at [`Constraints::odometer_lever`]. One without sign is right only while the vehicle
    /// drives forward.
    Odometer(Scalar),
    /// Height by the barometer, up positive \[m\]: an ellipsoidal height, but for an offset that
    /// [`Parameter::BarometerBias`](undrift_nav::parameters::Parameter::BarometerBias) estimates.
    Barometer(Scalar),
    /// Azimuth of a second antenna as seen from the first, from north to east \[rad\]. Its direction in the body is
    /// [`Constraints::heading_baseline`], and [`Parameter::HeadingOffset`](undrift_nav::parameters::Parameter::HeadingOffset) where
    /// that is not exact. At rest it gives the first heading.
    Heading(Scalar),
    /// Field by a magnetometer, body axes \[T\].
    Magnetometer(MagneticField),
}

impl Measurement {
    /// `scalar`, in SI units, of this sensor.
    ///
    /// ```
    /// use undrift_engine::{Measurement, Scalar, ScalarLog};
    /// let row = Scalar { time: 3.0, value: 412.0, std: 1.0 };
    /// assert_eq!(Measurement::of(ScalarLog::Barometer, row).time(), 3.0);
    /// ```
    pub fn of(log: ScalarLog, scalar: Scalar) -> Self {
        match log {
            ScalarLog::Odometer => Self::Odometer(scalar),
            ScalarLog::Barometer => Self::Barometer(scalar),
            ScalarLog::Heading => Self::Heading(scalar),
        }
    }

    /// Each fix as a measurement, in the same order.
    pub fn from_fixes(fixes: &[GnssFix]) -> Vec<Self> {
        fixes.iter().copied().map(Self::Gnss).collect()
    }

    /// Its stamp \[s\], in the time base of the samples.
    pub fn time(&self) -> f64 {
        match self {
            Self::Gnss(fix) => fix.time,
            Self::Odometer(s) | Self::Barometer(s) | Self::Heading(s) => s.time,
            Self::Magnetometer(reading) => reading.time,
        }
    }

    /// The same measurement with another stamp \[s\], as of a clock that is mapped onto that of the samples.
    #[must_use]
    pub fn at(mut self, time: f64) -> Self {
        match &mut self {
            Self::Gnss(fix) => fix.time = time,
            Self::Odometer(s) | Self::Barometer(s) | Self::Heading(s) => s.time = time,
            Self::Magnetometer(reading) => reading.time = time,
        }
        self
    }

    /// Whether it is a measurement of this kind, by which its updates are counted.
    ///
    /// ```
    /// use undrift_engine::{Aid, Measurement, Scalar};
    /// let height = Measurement::Barometer(Scalar { time: 3.0, value: 412.0, std: 1.0 });
    /// assert!(height.is(Aid::Barometer) && !height.is(Aid::Odometer));
    /// ```
    pub fn is(&self, aid: Aid) -> bool {
        match self {
            Self::Gnss(_) => matches!(aid, Aid::Position | Aid::Velocity | Aid::Attitude),
            Self::Odometer(_) => aid == Aid::Odometer,
            Self::Barometer(_) => aid == Aid::Barometer,
            Self::Heading(_) => aid == Aid::Heading,
            Self::Magnetometer(_) => aid == Aid::Magnetometer,
        }
    }

    /// Its name for a message, where a time or a value of it is not finite.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        let (what, finite) = match self {
            Self::Gnss(fix) => ("fix", fix.is_finite()),
            Self::Odometer(speed) => ("wheel speed", speed.is_finite()),
            Self::Barometer(height) => ("height", height.is_finite()),
            Self::Heading(heading) => ("heading", heading.is_finite()),
            Self::Magnetometer(reading) => ("magnetic field", reading.is_finite()),
        };
        (!finite).then_some(what)
    }

    /// Whether it says nothing before the mounting is known.
    pub(crate) fn needs_vehicle_axes(&self) -> bool {
        !matches!(self, Self::Gnss(_) | Self::Barometer(_))
    }

    /// A measurement of one number, what it is counted as and how the filter takes it. Fixes are judged by their receiver.
    pub(crate) fn scalar(&self, constraints: &Constraints) -> Option<(Scalar, Aid, Aiding)> {
        Some(match *self {
            Self::Gnss(_) | Self::Magnetometer(_) => return None,
            Self::Odometer(speed) => {
                let aiding = Aiding::Odometer {
                    speed: speed.value,
                    lever_arm: constraints.odometer_lever,
                };
                (speed, Aid::Odometer, aiding)
            }
            Self::Barometer(height) => (height, Aid::Barometer, Aiding::Barometer(height.value)),
            Self::Heading(heading) => {
                let aiding = Aiding::Heading {
                    heading: heading.value,
                    baseline: constraints.heading_baseline,
                };
                (heading, Aid::Heading, aiding)
            }
        })
    }

    /// Its order among measurements of the same time: fixes come first.
    pub(crate) fn rank(&self) -> u8 {
        match self {
            Self::Gnss(_) => 0,
            Self::Odometer(_) => 1,
            Self::Barometer(_) => 2,
            Self::Heading(_) => 3,
            Self::Magnetometer(_) => 4,
        }
    }
}

/// A measurement that a filter is updated with: [`Estimator::innovation`](crate::estimator::Estimator::innovation) and
/// [`Estimator::update`](crate::estimator::Estimator::update) use it with its covariance. Rows and signs of each:
/// docs/lab/measurement-rows.md.
///
/// ```
/// use undrift_engine::{Navigator, estimator::Aiding, settings::Settings};
/// use undrift_nav::Vector3;
/// # use undrift_nav::shaping::ShapingFilter;
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
/// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
/// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
/// # let mut navigator = Navigator::new(Settings::new(sensors));
/// # for fix in &log.gnss {
/// #     navigator.fix(*fix)?;
/// # }
/// # for sample in &log.imu {
/// #     navigator.imu(*sample)?;
/// # }
/// let filter = navigator.filter().expect("aligned");
/// // What a wheel at the IMU that reads 2 m/s more than the solution has would say: predicted less measured.
/// let speed = filter.vehicle_velocity(&Vector3::zeros()).x + 2.0;
/// let wheel = Aiding::Odometer { speed, lever_arm: Vector3::zeros() };
/// assert!((filter.innovation(&wheel).expect("one number").x + 2.0).abs() < 1e-9); // [m/s]
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aiding {
    /// GNSS position.
    Position {
        /// Position of the antenna, as measured.
        position: Position,
        /// IMU → antenna, body axes, as configured \[m\].
        lever_arm: Vector3,
        /// Standard deviation of the time-correlated part of its error, in the axes of the fix \[m\]; 0 where it is white. The covariance of the update is then
        /// that of the rest.
        correlated: Vector3,
        /// Time at which it holds \[s\]; the filter is there or after it.
        due: f64,
    },
    /// GNSS velocity.
    Velocity {
        /// Velocity of the antenna over ground, north, east, down \[m/s\].
        v_n: Vector3,
        /// IMU → antenna, body axes, as configured \[m\].
        lever_arm: Vector3,
        /// Standard deviation of the time-correlated part of its error, north, east, down \[m/s\]; 0 where it is white.
        correlated: Vector3,
        /// Time at which it holds \[s\]; the filter is there or after it.
        due: f64,
    },
    /// Mean GNSS velocity since a fix, by the carrier phase.
    MeanVelocity {
        /// Mean velocity of the antenna over ground, north, east, down \[m/s\].
        v_n: Vector3,
        /// IMU → antenna, body axes, as configured \[m\].
        lever_arm: Vector3,
        /// What the samples say of the time; the filter is at its end.
        stretch: Stretch,
    },
    /// The same along one direction, by few satellites.
    MeanVelocityAlong {
        /// North, east, down.
        direction: Vector3,
        /// What the satellites say.
        mean: MeanVelocity,
        /// IMU → antenna, body axes, as configured \[m\].
        lever_arm: Vector3,
        /// What the samples say of the time; the filter is at its end.
        stretch: Stretch,
    },
    /// Heading by the course over ground, from north to east \[rad\].
    Course(f64),
    /// The vehicle is at rest: no velocity, three numbers \[m/s\].
    ZeroVelocity,
    /// The body turns with the Earth: mean angular rate as the gyros read it, body axes \[rad/s\].
    EarthRate(Vector3),
    /// The same, and nothing is learnt of the attitude.
    NoTurn(Vector3),
    /// The body is at rest: mean specific force as the accelerometers read it, body axes \[m/s²\].
    Level(Vector3),
    /// No velocity to the right or down at this point, IMU → axle, body axes \[m\]; two numbers \[m/s\].
    NonHolonomic(Vector3),
    /// An aircraft keeps its velocity through the air in body axes; three numbers \[m/s\].
    AirVelocity,
    /// Drag of rotors, two numbers \[m/s²\].
    RotorDrag {
        /// Mean specific force as the accelerometers read it, body axes \[m/s²\].
        force: Vector3,
        /// Drag over mass, as configured [1/s].
        drag: f64,
    },
    /// Speed of a wheel along the vehicle's forward axis.
    Odometer {
        /// Speed, forward positive \[m/s\].
        speed: f64,
        /// IMU → wheel, body axes \[m\].
        lever_arm: Vector3,
    },
    /// Height by a barometer, up positive \[m\].
    Barometer(f64),
    /// Heading by two antennas.
    Heading {
        /// Azimuth of the second antenna as seen from the first, from north to east \[rad\].
        heading: f64,
        /// Direction of the second antenna in the body, from forward to right, as configured \[rad\].
        baseline: f64,
    },
    /// Magnetic field.
    Magnetometer {
        /// As measured, body axes \[T\].
        measured: Vector3,
        /// The Earth's, north, east, down \[T\].
        field: Vector3,
    },
    /// Attitude of a marker.
    Attitude {
        /// Attitude against the frame of the poses, `q_rk`, as measured.
        q_rk: Quaternion,
        /// The marker's axes in the body, as configured.
        q_bk: Quaternion,
        /// Standard deviation of the time-correlated part of its error, about the frame's axes \[rad\]; 0 where it is white.
        correlated: Vector3,
        /// Time at which it holds \[s\]; the filter is there or after it.
        due: f64,
    },
}

impl Aiding {
    /// The measurement of one number by its name: `"course"` \[rad\], `"odometer"` [m/s], `"barometer"` \[m\] or `"heading"` \[rad\], the wheel at
    /// `lever_arm` [m, body axes], the second antenna ahead. `None` for any other name.
    pub fn scalar(name: &str, value: f64, lever_arm: Vector3) -> Option<Self> {
        Some(match name {
            "course" => Self::Course(value),
            "odometer" => Self::Odometer {
                speed: value,
                lever_arm,
            },
            "barometer" => Self::Barometer(value),
            "heading" => Self::Heading {
                heading: value,
                baseline: 0.0,
            },
            _ => return None,
        })
    }
}

/// An observation for the filter, by the number of its components.
pub(crate) enum Observed<const N: usize> {
    One(Observation<1, N>),
    Two(Observation<2, N>),
    Three(Observation<3, N>),
}

/// Observation of a measurement by a filter; `None` where it says nothing.
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
        Aiding::MeanVelocity {
            v_n,
            lever_arm,
            stretch,
        } => Observed::Three(filter.observe_mean_velocity(v_n, lever_arm, stretch)),
        Aiding::MeanVelocityAlong {
            direction,
            mean,
            lever_arm,
            stretch,
        } => Observed::One(filter.observe_mean_velocity_along(direction, mean, lever_arm, stretch)),
        Aiding::Course(course) => Observed::One(filter.observe_course(*course)?),
        Aiding::ZeroVelocity => Observed::Three(filter.observe_zero_velocity()),
        Aiding::EarthRate(rate) => Observed::Three(filter.observe_earth_rate(rate)),
        Aiding::NoTurn(rate) => Observed::Three(rest::observe_no_turn(filter, rate)),
        Aiding::Level(force) => Observed::Two(filter.observe_level(force)),
        Aiding::NonHolonomic(axle) => Observed::Two(filter.observe_non_holonomic(axle)),
        Aiding::AirVelocity => Observed::Three(filter.observe_air_velocity()),
        Aiding::RotorDrag { force, drag } => Observed::Two(filter.observe_rotor_drag(force, *drag)),
        Aiding::Odometer { speed, lever_arm } => {
            Observed::One(filter.observe_odometer(*speed, lever_arm))
        }
        Aiding::Barometer(height) => Observed::One(filter.observe_barometer(*height)),
        Aiding::Heading { heading, baseline } => {
            Observed::One(filter.observe_heading(*heading, *baseline)?)
        }
        Aiding::Magnetometer { measured, field } => {
            Observed::Three(filter.observe_magnetometer(measured, field))
        }
        Aiding::Attitude {
            q_rk,
            q_bk,
            correlated,
            due,
        } => Observed::Three(pose::observe_attitude(filter, q_rk, q_bk, correlated, *due)),
    })
}

#[cfg(test)]
mod tests;
