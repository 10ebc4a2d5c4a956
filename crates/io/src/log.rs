//! Logs that say themselves what they hold: receivers' protocols, recordings of robots and flight
//! controllers, MATLAB structures. Each format is a file of its own below, which makes of its bytes an
//! iterator of [`Entry`]; the readers of [`crate::imu`], [`crate::gnss`] and [`crate::truth`] take
//! what they want from it.
//!
//! Times are seconds: of the GPS week in which the file starts where the format has absolute times,
//! else of the clock that it has (since boot). Axes are the file's own.

mod bag;
mod bytes;
mod dataflash;
mod explorer;
mod frames;
mod gnsslogger;
mod gpx;
mod mcap;
mod navego;
mod nmea;
mod novatel;
mod phone;
mod receiver;
mod ros;
pub(crate) mod rosbag2;
mod rtklib;
mod sbet;
mod sbf;
pub(crate) mod sensor_logger;
mod ubx;
mod ulog;

use crate::ReadError;
use crate::entry::Entries;
pub use crate::entry::{Entry, Fix, ImuReading, Stream, StreamKind, Wanted, What};
use crate::epoch::Epoch;
use crate::format::Format;
use crate::skipped::{SkipKind, Skipped};
use crate::source::{Again, BytesRead, Source};

/// Whether a log that begins so is of a format.
type Detect = fn(&[u8]) -> bool;

/// Formats and how they are known, in the order in which they are looked for: those with a mark at their
/// beginning first, then text that may hold stray bytes of others.
const FORMATS: [(Format, Detect); 16] = [
    (Format::RosBag, bag::detect),
    (Format::Mcap, mcap::detect),
    (Format::RosBag2, rosbag2::detect),
    (Format::ULog, ulog::detect),
    (Format::DataFlash, dataflash::detect),
    (Format::NaveGo, navego::detect),
    (Format::Gpx, gpx::detect),
    (Format::GnssLogger, gnsslogger::detect),
    (Format::SensorLogger, sensor_logger::detect),
    (Format::Novatel, novatel::detect),
    (Format::Sbf, sbf::detect),
    (Format::Nmea, is_nmea),
    (Format::Ubx, ubx::detect),
    (Format::Rtklib, rtklib::detect),
    (Format::Explorer, explorer::detect),
    (Format::Sbet, sbet::detect),
];

/// Sentences without UBX messages that have more to say.
fn is_nmea(start: &[u8]) -> bool {
    nmea::detect(start) && !ubx::has_data(start)
}

/// The format of a log that begins so.
pub(crate) fn detect(start: &[u8]) -> Option<Format> {
    let found = FORMATS.iter().find(|(_, begins)| begins(start));
    found.map(|(format, _)| *format)
}

fn entries(
    source: Source,
    again: Again,
    format: Format,
    wanted: &Wanted,
) -> Result<Entries, ReadError> {
    match format {
        Format::RosBag => bag::entries(source, wanted),
        Format::Mcap => mcap::entries(source, wanted),
        Format::ULog => ulog::entries(source, again, wanted),
        Format::DataFlash => dataflash::entries(source, again, wanted),
        Format::NaveGo => navego::entries(source, wanted),
        Format::Gpx => gpx::entries(source, wanted),
        Format::GnssLogger => gnsslogger::entries(source, wanted),
        Format::Nmea => nmea::entries(source, wanted),
        Format::Ubx => ubx::entries(source, wanted),
        Format::Novatel => novatel::entries(source, wanted),
        Format::Sbf => sbf::entries(source, wanted),
        Format::Rtklib => rtklib::entries(source, wanted),
        Format::SensorLogger => sensor_logger::entries(source, wanted),
        Format::Explorer => explorer::entries(source, wanted),
        Format::Sbet => sbet::entries(source, wanted),
        table => Err(is_table(table)),
    }
}

/// The streams of a log.
pub(crate) fn streams(source: Source, format: Format) -> Result<Vec<Stream>, ReadError> {
    match format {
        Format::RosBag => bag::streams(source),
        Format::Mcap => mcap::streams(source),
        Format::ULog => ulog::streams(source),
        Format::DataFlash => dataflash::streams(source),
        Format::NaveGo => navego::streams(source),
        Format::Gpx => gpx::streams(source),
        Format::GnssLogger => gnsslogger::streams(source),
        Format::Nmea => nmea::streams(source),
        Format::Ubx => ubx::streams(source),
        Format::Novatel => novatel::streams(source),
        Format::Sbf => sbf::streams(source),
        Format::Rtklib => rtklib::streams(source),
        Format::SensorLogger => sensor_logger::streams(source),
        Format::Explorer => explorer::streams(source),
        Format::Sbet => sbet::streams(source),
        table => Err(is_table(table)),
    }
}

fn is_table(format: Format) -> ReadError {
    let what = format.describe();
    ReadError::nameless(format!("{what} is a table: specify its columns"))
}

/// Whether a log has to be read once more before: only the end of these shows which streams they have.
pub(crate) fn reads_twice(format: Format) -> bool {
    matches!(format, Format::ULog | Format::DataFlash)
}

/// A log being read for one purpose.
pub(crate) struct Log {
    entries: Entries,
    skipped: Skipped,
}

impl Log {
    /// Reads a ROS 2 bag, which is not one stream.
    pub(crate) fn of_bag(
        parts: Vec<rosbag2::BagFile>,
        read: &BytesRead,
        wanted: &Wanted,
    ) -> Result<Self, ReadError> {
        Ok(Self {
            entries: rosbag2::entries(parts, read, wanted)?,
            skipped: Skipped::of_messages(),
        })
    }

    /// Reads a log for what is wanted of it.
    pub(crate) fn new(
        source: Source,
        again: Again,
        format: Format,
        wanted: &Wanted,
    ) -> Result<Self, ReadError> {
        Ok(Self {
            entries: entries(source, again, format, wanted)?,
            skipped: match format {
                Format::Nmea
                | Format::Gpx
                | Format::Rtklib
                | Format::GnssLogger
                | Format::Explorer => Skipped::default(),
                _ => Skipped::of_messages(),
            },
        })
    }

    pub(crate) fn skipped(&self) -> &Skipped {
        &self.skipped
    }

    pub(crate) fn skipped_mut(&mut self) -> &mut Skipped {
        &mut self.skipped
    }

    /// What the times count from, where the entries so far tell it.
    pub(crate) fn epoch(&self) -> Option<Epoch> {
        self.entries.epoch()
    }

    /// The next entry that can be used.
    pub(crate) fn next(&mut self) -> Result<Option<Entry>, ReadError> {
        for entry in self.entries.by_ref() {
            let entry = entry?;
            match &entry.what {
                What::Skipped(kind, detail) => self.skipped.add(*kind, entry.at, detail),
                what if what.is_finite() => return Ok(Some(entry)),
                what => {
                    self.skipped
                        .add(SkipKind::NotFinite, entry.at, what.shown());
                }
            }
        }
        Ok(None)
    }
}
