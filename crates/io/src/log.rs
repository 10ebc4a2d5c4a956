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
mod rtklib;
mod ubx;
mod ulog;

use crate::ReadError;
use crate::entry::Entries;
pub use crate::entry::{Entry, Fix, ImuReading, Stream, StreamKind, Wanted, What};
use crate::format::Format;
use crate::skipped::{SkipKind, Skipped};
use crate::source::{Again, Source};

/// A format: how it is known, and its readers.
struct Reading {
    format: Format,
    detect: fn(&[u8]) -> bool,
    entries: fn(Source, Again, &Wanted) -> Result<Entries, ReadError>,
    streams: fn(Source) -> Result<Vec<Stream>, ReadError>,
}

/// In the order in which they are looked for: those with a mark at their beginning first, then text that
/// may hold stray bytes of others.
const FORMATS: [Reading; 8] = [
    Reading {
        format: Format::RosBag,
        detect: bag::detect,
        entries: |source, _, wanted| bag::entries(source, wanted),
        streams: bag::streams,
    },
    Reading {
        format: Format::Mcap,
        detect: mcap::detect,
        entries: |source, _, wanted| mcap::entries(source, wanted),
        streams: mcap::streams,
    },
    Reading {
        format: Format::ULog,
        detect: ulog::detect,
        entries: ulog::entries,
        streams: ulog::streams,
    },
    Reading {
        format: Format::NaveGo,
        detect: navego::detect,
        entries: |source, _, wanted| navego::entries(source, wanted),
        streams: navego::streams,
    },
    Reading {
        format: Format::Gpx,
        detect: gpx::detect,
        entries: |source, _, wanted| gpx::entries(source, wanted),
        streams: gpx::streams,
    },
    Reading {
        format: Format::Nmea,
        detect: |start| nmea::detect(start) && !ubx::has_data(start),
        entries: |source, _, wanted| nmea::entries(source, wanted),
        streams: nmea::streams,
    },
    Reading {
        format: Format::Ubx,
        detect: ubx::detect,
        entries: |source, _, wanted| ubx::entries(source, wanted),
        streams: ubx::streams,
    },
    Reading {
        format: Format::Rtklib,
        detect: rtklib::detect,
        entries: |source, _, wanted| rtklib::entries(source, wanted),
        streams: rtklib::streams,
    },
];

/// The format of a log that begins so.
pub(crate) fn detect(start: &[u8]) -> Option<Format> {
    let found = FORMATS.iter().find(|reading| (reading.detect)(start));
    found.map(|reading| reading.format)
}

fn reading(format: Format) -> Result<&'static Reading, ReadError> {
    let found = FORMATS.iter().find(|reading| reading.format == format);
    found.ok_or_else(|| {
        let what = format.describe();
        ReadError::nameless(format!("{what} is a table: its columns have to be named"))
    })
}

/// Whether a log has to be read once more before: a ULog tells at its end only which streams it has.
pub(crate) fn reads_twice(format: Format) -> bool {
    format == Format::ULog
}

/// The streams of a log.
pub(crate) fn streams(source: Source, format: Format) -> Result<Vec<Stream>, ReadError> {
    (reading(format)?.streams)(source)
}

/// A log being read for one purpose.
pub(crate) struct Log {
    entries: Entries,
    skipped: Skipped,
}

impl Log {
    /// Reads a log for what is wanted of it.
    pub(crate) fn new(
        source: Source,
        again: Again,
        format: Format,
        wanted: &Wanted,
    ) -> Result<Self, ReadError> {
        Ok(Self {
            entries: (reading(format)?.entries)(source, again, wanted)?,
            skipped: match format {
                Format::Nmea | Format::Gpx | Format::Rtklib => Skipped::default(),
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
