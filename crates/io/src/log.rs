//! Logs that say themselves what they hold: receivers' protocols, recordings of robots and flight
//! controllers, MATLAB structures. Each format is a file of its own below, which makes of its bytes an
//! iterator of [`Entry`]; the readers of [`crate::imu`], [`crate::gnss`] and [`crate::truth`] take
//! what they want from it.
//!
//! Times are seconds: of the GPS week in which the file starts where the format has absolute times,
//! else of the clock that it has (since boot). Axes are the file's own.

mod bag;
mod gpx;
mod mcap;
mod navego;
mod nmea;
mod receiver;
mod ros;
mod ubx;
mod ulog;

use std::path::{Path, PathBuf};

use undrift_nav::sample::{FixQuality, Position, TruthSample};
use undrift_nav::{Matrix3, Vector3};

use crate::ReadError;
use crate::format::Format;
use crate::skipped::{SkipKind, Skipped};
use crate::source::{self, Source};

/// One thing that a log says.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Where: the line in a text, the message's number in anything else, the first is 1.
    pub at: u64,
    /// What.
    pub what: What,
}

/// What an entry holds.
#[derive(Clone, Debug)]
pub enum What {
    /// An inertial sample.
    Imu(ImuReading),
    /// A fix.
    Fix(Fix),
    /// A reference solution.
    Pose(TruthSample),
    /// Something that cannot be used, and why: it is counted.
    Skipped(SkipKind, String),
}

impl What {
    /// Whether all its numbers are.
    fn is_finite(&self) -> bool {
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
            Self::Skipped(..) => true,
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
}

/// A fix whose uncertainty the log may not tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fix {
    /// Time of validity \[s\].
    pub time: f64,
    /// Position, and its covariance north-east-down \[m²\].
    pub position: Option<(Position, Option<Matrix3>)>,
    /// Velocity north-east-down [m/s], and its covariance [(m/s)²].
    pub velocity: Option<(Vector3, Option<Matrix3>)>,
    /// What kind of solution the receiver calls it.
    pub quality: FixQuality,
}

/// What is wanted from a log. A stream is named as [`streams`] does; without a name, the only one of
/// its kind is meant, and more than one is an error that lists them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Inertial samples of a stream.
    Imu(Option<String>),
    /// Fixes.
    Fixes {
        /// Stream of positions, or of positions with velocities.
        position: Option<String>,
        /// Stream of velocities, where they are apart.
        velocity: Option<String>,
    },
    /// Reference solutions of a stream.
    Poses(Option<String>),
}

impl Format {
    /// Whether files of the format say themselves what they hold.
    pub fn is_log(self) -> bool {
        matches!(
            self,
            Self::Nmea
                | Self::Ubx
                | Self::RosBag
                | Self::Mcap
                | Self::ULog
                | Self::NaveGo
                | Self::Gpx
        )
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
pub(crate) type Entries = Box<dyn Iterator<Item = Result<Entry, ReadError>> + Send>;

/// A log being read for one purpose.
pub(crate) struct Log {
    path: PathBuf,
    entries: Entries,
    skipped: Skipped,
}

impl Log {
    /// Opens a log, plain or gzip.
    pub(crate) fn open(path: &Path, format: Format, wanted: &Wanted) -> Result<Self, ReadError> {
        Self::from_source(path, source::open(path)?, format, wanted)
    }

    /// Reads a log from an open stream; `path` is what messages call it.
    pub(crate) fn from_source(
        path: &Path,
        source: Source,
        format: Format,
        wanted: &Wanted,
    ) -> Result<Self, ReadError> {
        Ok(Self {
            path: path.to_path_buf(),
            entries: entries(path, source, format, wanted)?,
            skipped: match format {
                Format::Nmea | Format::Gpx => Skipped::default(),
                _ => Skipped::of_messages(),
            },
        })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn skipped(&self) -> &Skipped {
        &self.skipped
    }

    pub(crate) fn skipped_mut(&mut self) -> &mut Skipped {
        &mut self.skipped
    }

    /// The next entry that can be used.
    pub(crate) fn next(&mut self) -> Result<Option<Entry>, ReadError> {
        for entry in self.entries.by_ref() {
            let entry = entry?;
            match &entry.what {
                What::Skipped(kind, detail) => self.skipped.add(*kind, entry.at, detail),
                what if what.is_finite() => return Ok(Some(entry)),
                what => {
                    let detail = format!("{what:?}");
                    self.skipped.add(SkipKind::NotFinite, entry.at, detail);
                }
            }
        }
        Ok(None)
    }
}

/// The format of a log by the start of its content: those with a mark at their beginning first, then
/// text that may hold stray bytes of others.
pub(crate) fn detect(start: &[u8]) -> Option<Format> {
    let formats = [
        (Format::RosBag, bag::detect(start)),
        (Format::Mcap, mcap::detect(start)),
        (Format::ULog, ulog::detect(start)),
        (Format::NaveGo, navego::detect(start)),
        (Format::Gpx, gpx::detect(start)),
        (Format::Nmea, nmea::detect(start)),
        (Format::Ubx, ubx::detect(start)),
    ];
    let found = formats.into_iter().find(|(_, is)| *is);
    found.map(|(format, _)| format)
}

fn entries(
    path: &Path,
    source: Source,
    format: Format,
    wanted: &Wanted,
) -> Result<Entries, ReadError> {
    match format {
        Format::Nmea => nmea::entries(path, source, wanted),
        Format::Ubx => ubx::entries(path, source, wanted),
        Format::RosBag => bag::entries(path, source, wanted),
        Format::Mcap => mcap::entries(path, source, wanted),
        Format::ULog => ulog::entries(path, source, wanted),
        Format::NaveGo => navego::entries(path, source, wanted),
        Format::Gpx => gpx::entries(path, source, wanted),
        _ => Err(not_a_log(path, format)),
    }
}

/// The streams of a log.
///
/// # Errors
/// If the file cannot be opened, is no log of the format, or is one whose columns have to be named.
pub fn streams(path: &Path, format: Format) -> Result<Vec<Stream>, ReadError> {
    let source = source::open(path)?;
    match format {
        Format::Nmea => nmea::streams(path, source),
        Format::Ubx => ubx::streams(path, source),
        Format::RosBag => bag::streams(path, source),
        Format::Mcap => mcap::streams(path, source),
        Format::ULog => ulog::streams(path, source),
        Format::NaveGo => navego::streams(path, source),
        Format::Gpx => gpx::streams(path, source),
        _ => Err(not_a_log(path, format)),
    }
}

fn not_a_log(path: &Path, format: Format) -> ReadError {
    ReadError::new(
        path,
        format!(
            "{} is a table: its columns have to be named",
            format.describe()
        ),
    )
}
