//! Self-describing logs consist of entries of streams.

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, MeanVelocity, Position, TruthSample};
use undrift_nav::{Matrix3, Quaternion, Vector3};

use crate::epoch::Epoch;
use crate::fix::{shown, three};
use crate::skipped::{SkipKind, Unfit};
use crate::{Key, ReadError};

/// One thing in a log.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Where: the line in a text, the message's number in anything else, the first is 1.
    pub at: u64,
    /// What.
    pub what: What,
}

/// What an entry holds.
#[derive(Clone, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "few are held at a time, and a box for each fix is an allocation"
)]
pub enum What {
    /// An inertial sample.
    Imu(ImuReading),
    /// A fix.
    Fix(Fix),
    /// A reference solution.
    Pose(TruthSample),
    /// A pose in a local frame.
    LocalPose(LocalPose),
    /// A heading by two antennas.
    Heading(Heading),
    /// A magnetic field.
    Field(FieldReading),
    /// Something that cannot be used, and why: it is counted.
    Skipped(SkipKind, String),
}

impl What {
    /// What was read, or why it cannot be used.
    pub(crate) fn from_read(read: Result<Self, Unfit>) -> Self {
        read.unwrap_or_else(|(kind, detail)| Self::Skipped(kind, detail))
    }

    /// Whether all its numbers are.
    pub(crate) fn is_finite(&self) -> bool {
        let three = |v: &Vector3| v.iter().all(|x| x.is_finite());
        match self {
            Self::Imu(reading) => {
                reading.time.is_finite() && three(&reading.gyro) && three(&reading.accel)
            }
            Self::Fix(fix) => {
                let place = match &fix.position {
                    Some((Position::Geodetic(place), _)) => place.height.is_finite(),
                    Some((Position::Baseline { ned, .. }, _)) => three(ned),
                    None => true,
                };
                fix.time.is_finite() && place && fix.velocity.is_none_or(|(v, _)| three(&v))
            }
            Self::Pose(pose) => {
                pose.time.is_finite()
                    && pose.v_n.is_none_or(|v| three(&v))
                    && pose.rpy.is_none_or(|rpy| three(&rpy))
            }
            Self::LocalPose(pose) => pose.is_finite(),
            Self::Heading(heading) => heading.time.is_finite() && heading.heading.is_finite(),
            Self::Field(reading) => reading.time.is_finite() && three(&reading.field),
            Self::Skipped(..) => true,
        }
    }

    /// Its numbers as messages show them.
    pub(crate) fn shown(&self) -> String {
        match self {
            Self::Imu(reading) => format!(
                "{} s, gyro {} rad/s, accelerometer {} m/s²",
                reading.time,
                three(&reading.gyro),
                three(&reading.accel)
            ),
            Self::Fix(fix) => {
                let position = fix.position.iter().map(|(place, _)| shown(place));
                let velocity = fix.velocity.iter().map(|(v, _)| three(v) + " m/s");
                let parts = [format!("{} s", fix.time)].into_iter();
                let parts = parts.chain(position).chain(velocity);
                Vec::from_iter(parts).join("; ")
            }
            Self::Pose(pose) => {
                let velocity = pose.v_n.iter().map(|v| three(v) + " m/s");
                let attitude = pose.rpy.iter().map(|rpy| three(rpy) + " rad");
                let parts = [format!("{} s", pose.time)].into_iter();
                let parts = parts.chain(velocity).chain(attitude);
                Vec::from_iter(parts).join("; ")
            }
            Self::LocalPose(pose) => pose.shown(),
            Self::Heading(Heading { time, heading, .. }) => {
                format!("{time} s; {} deg", heading.to_degrees())
            }
            Self::Field(FieldReading { time, field }) => {
                format!("{time} s; {} uT", three(&(field * 1e6)))
            }
            Self::Skipped(_, detail) => detail.clone(),
        }
    }
}

/// Rates over the interval since the sample before, sensor axes as in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImuReading {
    /// End of the interval \[s\].
    pub time: f64,
    /// Mean angular rate [rad/s].
    pub gyro: Vector3,
    /// Mean specific force [m/s²].
    pub accel: Vector3,
    /// Temperature of the sensor [°C]; NaN where the log has none with the sample.
    pub temperature_c: f64,
}

impl ImuReading {
    /// Without a temperature.
    pub(crate) fn new(time: f64, gyro: Vector3, accel: Vector3) -> Self {
        let temperature_c = f64::NAN;
        Self {
            time,
            gyro,
            accel,
            temperature_c,
        }
    }
}

/// A fix; the log may not state its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fix {
    /// Time of validity \[s\].
    pub time: f64,
    /// Position, and its covariance north-east-down \[m²\].
    pub position: Option<(Position, Option<Matrix3>)>,
    /// Velocity north-east-down [m/s], and its covariance [(m/s)²].
    pub velocity: Option<(Vector3, Option<Matrix3>)>,
    /// Mean velocity over the time up to it, by the carrier phase.
    pub mean_velocity: Option<MeanVelocity>,
    /// What kind of solution the receiver calls it.
    pub quality: FixQuality,
}

/// A heading of a receiver with two antennas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    /// Time of validity \[s\].
    pub time: f64,
    /// Azimuth of the second antenna as seen from the first, or of what the receiver calls the vehicle's forward axis, from north to
    /// east \[rad\].
    pub heading: f64,
    /// Standard deviation \[rad\], where the log states it.
    pub std: Option<f64>,
}

/// A magnetic field, sensor axes as in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldReading {
    /// Time of validity \[s\].
    pub time: f64,
    /// The field \[T\].
    pub field: Vector3,
}

/// A pose in the axes of the local frame of its log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalPose {
    /// Time of validity \[s\].
    pub time: f64,
    /// Position of the marker, local axes \[m\].
    pub position: Option<Vector3>,
    /// `q_wk`: turns vectors of the marker's axes into the local axes.
    pub attitude: Option<Quaternion>,
    /// Covariance of the position, local axes \[m²\], where the log states it.
    pub position_covariance: Option<Matrix3>,
    /// Covariance of the rotation error about the local axes \[rad²\], where the log states it.
    pub attitude_covariance: Option<Matrix3>,
}

impl LocalPose {
    /// Whether all its numbers are.
    pub(crate) fn is_finite(&self) -> bool {
        let position = self.position.iter().flatten();
        let attitude = self.attitude.iter().flat_map(|q| q.coords.iter());
        let covariances = [self.position_covariance, self.attitude_covariance];
        let covariances = covariances.iter().flatten().flatten();
        let mut numbers = position.chain(attitude).chain(covariances);
        self.time.is_finite() && numbers.all(|number| number.is_finite())
    }

    /// Its numbers as messages show them.
    fn shown(&self) -> String {
        let position = self.position.iter().map(|p| three(p) + " m");
        let attitude = self.attitude.iter().map(|q| {
            let [x, y, z, w] = [q.i, q.j, q.k, q.w];
            format!("quaternion x, y, z, w {x}, {y}, {z}, {w}")
        });
        let parts = [format!("{} s", self.time)].into_iter();
        let parts = parts.chain(position).chain(attitude);
        Vec::from_iter(parts).join("; ")
    }
}

/// What is wanted from a log. A stream is named as `log::streams` does; without a name, the only one of
/// its kind is meant, and more than one is an error that lists them.
#[derive(Clone, Debug, PartialEq)]
pub enum Wanted {
    /// Inertial samples of a stream.
    Imu(Option<String>),
    /// Fixes.
    Fixes {
        /// Stream of positions, or of positions with velocities.
        position: Option<String>,
        /// Stream of velocities, where they are apart.
        velocity: Option<String>,
        /// The base station of baselines.
        base: Option<Geodetic>,
        /// Whether each is given as soon as it can be, of a log that is read while it comes, rather than in order of time.
        at_once: bool,
    },
    /// Reference solutions of a stream.
    Poses(Option<String>),
    /// Poses in a local frame, of a stream.
    LocalPoses(Option<String>),
    /// Headings by two antennas, of a stream.
    Headings(Option<String>),
    /// Magnetic fields, of a stream.
    Fields(Option<String>),
}

impl Wanted {
    /// The one stream that is wanted where positions and velocities are in one: its name, what it holds,
    /// and the key that names it.
    ///
    /// # Errors
    /// If positions and velocities are asked for from different streams.
    pub(crate) fn one_stream(&self) -> Result<(&Option<String>, StreamKind, Key), ReadError> {
        match self {
            Self::Imu(name) => Ok((name, StreamKind::Imu, Key::Topic("imu"))),
            Self::Poses(name) => Ok((name, StreamKind::Poses, Key::Topic("truth"))),
            Self::LocalPoses(name) => Ok((name, StreamKind::LocalPoses, Key::Topic("poses"))),
            Self::Headings(name) => Ok((name, StreamKind::Headings, Key::Topic("heading"))),
            Self::Fields(name) => Ok((name, StreamKind::Fields, Key::Topic("magnetometer"))),
            Self::Fixes {
                position, velocity, ..
            } => {
                let both = position.iter().zip(velocity).find(|(p, v)| p != v);
                if both.is_some() {
                    return Err(
                        ReadError::nameless("positions and velocities are in one stream")
                            .key(Key::VelocityTopic)
                            .mend("omit it"),
                    );
                }
                let name = if position.is_some() {
                    position
                } else {
                    velocity
                };
                Ok((name, StreamKind::Fixes, Key::Topic("gnss")))
            }
        }
    }
}

/// What a stream holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StreamKind {
    /// Inertial samples.
    Imu,
    /// Fixes with position, velocity or both.
    Fixes,
    /// Velocities alone.
    Velocity,
    /// A reference solution.
    Poses,
    /// Poses in a local frame.
    LocalPoses,
    /// Headings by two antennas.
    Headings,
    /// Magnetic fields.
    Fields,
    /// Raw observations of satellites, which give the fixes mean velocities by the carrier phase.
    Observations,
    /// Nothing that is read here.
    Other,
}

/// One stream of a log: a topic, a kind of message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stream {
    /// Its name in the file, such as `/imu/data` or `NAV-PVT`.
    pub name: String,
    /// What it holds.
    pub kind: StreamKind,
    /// Its type and frame in a few words, such as `sensor_msgs/Imu, frame imu_link`.
    pub about: String,
    /// Number of messages.
    pub messages: u64,
}

/// The entries of a log in the order of the file. An error ends them.
pub(crate) struct Entries {
    entries: Box<dyn Iterator<Item = Result<Dated, ReadError>> + Send>,
    epoch: Option<Epoch>,
}

/// An entry, and what its time counts from as far as that is known.
type Dated = (Entry, Option<Epoch>);

impl Entries {
    /// Of entries that each tell what their times count from.
    pub(crate) fn dated(
        entries: impl Iterator<Item = Result<Dated, ReadError>> + Send + 'static,
    ) -> Self {
        Self {
            entries: Box::new(entries),
            epoch: None,
        }
    }

    /// What the times count from, as far as the entries so far tell it.
    pub(crate) fn epoch(&self) -> Option<Epoch> {
        self.epoch
    }
}

impl Iterator for Entries {
    type Item = Result<Entry, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = self.entries.next()?;
        Some(next.map(|(entry, epoch)| {
            self.epoch = self.epoch.or(epoch);
            entry
        }))
    }
}
