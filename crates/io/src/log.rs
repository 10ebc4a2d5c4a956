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
pub(crate) mod mavlink;
pub(crate) mod mcap;
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
pub use crate::entry::{
    Entry, FieldReading, Fix, Heading, ImuReading, LocalPose, Stream, StreamKind, Wanted, What,
};
use crate::epoch::Epoch;
use crate::format::Format;
use crate::skipped::{SkipKind, Skipped};
use crate::source::{Again, BytesRead, Source};
use crate::table;
pub(crate) use phone::JoinedRows;
pub use ros::AND;
pub(crate) use ros::{Container, Event, Events};
pub(crate) use rtklib::lacks_header;

/// How the entries of a format are read.
#[derive(Clone, Copy)]
enum ReadEntries {
    /// Messages.
    Messages(fn(Source, &Wanted) -> Result<Entries, ReadError>),
    /// Lines of text.
    Lines(fn(Source, &Wanted) -> Result<Entries, ReadError>),
    /// Messages of a log that is read once more before: only its end shows which streams it has.
    Twice(fn(Source, Again, &Wanted) -> Result<Entries, ReadError>),
}

use ReadEntries::{Lines, Messages, Twice};

/// A format: whether a log that begins so is of it, its entries, its streams.
type LogFormat = (
    Format,
    fn(&[u8]) -> bool,
    ReadEntries,
    fn(Source) -> Result<Vec<Stream>, ReadError>,
);

/// The formats that are one stream, in the order in which they are looked for: those with a mark at their
/// beginning first, then text that may hold stray bytes of others.
#[rustfmt::skip]
const FORMATS: [LogFormat; 16] = [
    (Format::RosBag, bag::detect, Messages(bag::entries), bag::streams),
    (Format::Mcap, mcap::detect, Messages(mcap::entries), mcap::streams),
    (Format::ULog, ulog::detect, Twice(ulog::entries), ulog::streams),
    (Format::DataFlash, dataflash::detect, Twice(dataflash::entries), dataflash::streams),
    (Format::NaveGo, navego::detect, Messages(navego::entries), navego::streams),
    (Format::Gpx, gpx::detect, Lines(gpx::entries), gpx::streams),
    (Format::GnssLogger, gnsslogger::detect, Lines(gnsslogger::entries), gnsslogger::streams),
    (Format::SensorLogger, sensor_logger::detect, Messages(sensor_logger::entries), sensor_logger::streams),
    (Format::Novatel, novatel::detect, Messages(novatel::entries), novatel::streams),
    (Format::Sbf, sbf::detect, Messages(sbf::entries), sbf::streams),
    (Format::Mavlink, mavlink::detect, Messages(mavlink::entries), mavlink::streams),
    (Format::Nmea, is_nmea, Lines(nmea::entries), nmea::streams),
    (Format::Ubx, ubx::detect, Messages(ubx::entries), ubx::streams),
    (Format::Rtklib, rtklib::detect, Lines(rtklib::entries), rtklib::streams),
    (Format::Explorer, explorer::detect, Lines(explorer::entries), explorer::streams),
    (Format::Sbet, sbet::detect, Messages(sbet::entries), sbet::streams),
];

/// Sentences without UBX messages that have more to say.
fn is_nmea(start: &[u8]) -> bool {
    nmea::detect(start) && !ubx::has_data(start)
}

/// The format of a log that begins so.
pub(crate) fn detect(start: &[u8]) -> Option<Format> {
    if rosbag2::detect(start) {
        return Some(Format::RosBag2);
    }
    let found = FORMATS.iter().find(|(_, begins, ..)| begins(start));
    let format = found.map(|(format, ..)| *format)?;
    // A table may hold the sentences that it was made of in a column.
    let sentences = matches!(format, Format::Nmea | Format::Novatel);
    (!sentences || !table::has_named_numbers(start)).then_some(format)
}

/// How a format is read.
///
/// # Errors
/// If it is one whose columns have to be named.
fn known(format: Format) -> Result<&'static LogFormat, ReadError> {
    let found = FORMATS.iter().find(|(known, ..)| *known == format);
    found.ok_or_else(|| {
        let what = format.describe();
        ReadError::nameless(format!("{what} is a table: specify its columns"))
    })
}

/// The streams of a log.
pub(crate) fn streams(source: Source, format: Format) -> Result<Vec<Stream>, ReadError> {
    let (.., streams) = known(format)?;
    streams(source)
}

/// Whether a log has to be read once more before.
pub(crate) fn reads_twice(format: Format) -> bool {
    matches!(known(format), Ok((_, _, Twice(_), _)))
}

/// Whether logs of the format can have poses in a local frame.
fn has_local_poses(format: Format) -> bool {
    matches!(format, Format::RosBag | Format::Mcap | Format::RosBag2)
}

/// Whether logs of the format can have headings by two antennas.
fn has_headings(format: Format) -> bool {
    use Format::{Nmea, Novatel, Sbf, Ubx};
    matches!(format, Nmea | Novatel | Sbf | Ubx)
}

/// Whether logs of the format can have magnetic fields.
fn has_fields(format: Format) -> bool {
    use Format::{DataFlash, Mcap, RosBag, RosBag2, SensorLogger, ULog};
    matches!(
        format,
        DataFlash | Mcap | RosBag | RosBag2 | SensorLogger | ULog
    )
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
        let lacks = match wanted {
            Wanted::LocalPoses(_) if !has_local_poses(format) => {
                Some(("poses in a local frame", "poses.file"))
            }
            Wanted::Headings(_) if !has_headings(format) => {
                Some(("headings by two antennas", "heading.file"))
            }
            Wanted::Fields(_) if !has_fields(format) => {
                Some(("magnetic fields", "magnetometer.file"))
            }
            _ => None,
        };
        if let Some((what, key)) = lacks {
            let error = ReadError::nameless(format!("{} has no {what}", format.describe()));
            return Err(error.key(key));
        }
        let (entries, skipped) = match known(format)?.2 {
            Messages(read) => (read(source, wanted)?, Skipped::of_messages()),
            Lines(read) => (read(source, wanted)?, Skipped::default()),
            Twice(read) => (read(source, again, wanted)?, Skipped::of_messages()),
        };
        Ok(Self { entries, skipped })
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
