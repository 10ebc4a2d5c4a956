//! The solution in any format.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::frame::PoseFrame;
use super::mavlink::MavlinkWriter;
use super::mcap::McapWriter;
#[cfg(feature = "parquet")]
use super::parquet;
#[cfg(feature = "parquet")]
use super::parquet_table::ParquetTableWriter;
use super::solution::SolutionRow;
use super::text_writer::TextWriter;
use super::thinning::Thinning;
use super::tum;
use super::{PendingFile, csv, geojson, gpx, json_lines, kf_gins, kml, nmea, sbet};
use crate::epoch::Epoch;

/// A format of the navigation solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SolutionFormat {
    /// State, standard deviations and sensor errors, one row a sample.
    Csv,
    /// KF-GINS text.
    KfGins,
    /// NMEA 0183 sentences RMC, GGA, GST, HDT.
    Nmea,
    /// KML track.
    Kml,
    /// GeoJSON track.
    GeoJson,
    /// GPX track.
    Gpx,
    /// MCAP.
    Mcap,
    /// Apache Parquet.
    Parquet,
    /// SBET.
    Sbet,
    /// One JSON object a row, with the columns of CSV.
    JsonLines,
    /// MAVLink messages ODOMETRY and GPS_INPUT.
    Mavlink,
    /// TUM: the marker of a drive by poses, in their frame.
    Tum,
}

/// Formats, their names and the extensions of their files; the first is the usual one.
const FORMATS: [(SolutionFormat, &str, &[&str]); 12] = [
    (SolutionFormat::Csv, "csv", &["csv"]),
    (SolutionFormat::KfGins, "kf-gins", &["nav"]),
    (SolutionFormat::Nmea, "nmea", &["nmea"]),
    (SolutionFormat::Kml, "kml", &["kml"]),
    (SolutionFormat::GeoJson, "geojson", &["geojson", "json"]),
    (SolutionFormat::Gpx, "gpx", &["gpx"]),
    (SolutionFormat::Mcap, "mcap", &["mcap"]),
    (SolutionFormat::Parquet, "parquet", &["parquet"]),
    (SolutionFormat::Sbet, "sbet", &["sbet"]),
    (SolutionFormat::JsonLines, "jsonl", &["jsonl", "ndjson"]),
    (SolutionFormat::Mavlink, "mavlink", &["mavlink"]),
    (SolutionFormat::Tum, "tum", &["tum"]),
];

impl SolutionFormat {
    /// By the extension of a path, in any case of letters.
    pub fn from_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?;
        FORMATS
            .into_iter()
            .find(|(.., all)| all.iter().any(|one| one.eq_ignore_ascii_case(extension)))
            .map(|(format, ..)| format)
    }

    /// Its name in arguments.
    pub fn name(self) -> &'static str {
        FORMATS
            .into_iter()
            .find(|(format, ..)| *format == self)
            .map_or("csv", |(_, name, _)| name)
    }

    /// Whether it is a track on a map, of which the position is all that is needed.
    pub fn is_map(self) -> bool {
        matches!(self, Self::Kml | Self::GeoJson | Self::Gpx)
    }

    /// From one row to the next \[s\] unless asked otherwise: all rows, but ten a second on maps and
    /// in sentences.
    pub fn usual_every(self) -> f64 {
        if self.is_map() || matches!(self, Self::Nmea | Self::Mavlink) {
            0.1
        } else {
            0.0
        }
    }
}

/// A name that is no format of solutions.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "unknown format {0:?}; available: csv, kf-gins, nmea, kml, geojson, gpx, mcap, parquet, sbet, jsonl, mavlink, tum"
)]
pub struct UnknownSolutionFormat(pub String);

impl std::str::FromStr for SolutionFormat {
    type Err = UnknownSolutionFormat;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        FORMATS
            .into_iter()
            .find(|(_, of, _)| *of == name)
            .map(|(format, ..)| format)
            .ok_or_else(|| UnknownSolutionFormat(name.to_owned()))
    }
}

/// What a format may need beside the rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolutionOptions {
    /// What the times of the rows count from. Without it there are no dates, and the times are those of any
    /// clock.
    pub epoch: Option<Epoch>,
    /// What the track is called.
    pub name: String,
    /// Least time from one row to the next \[s\]; 0 for every row, without it
    /// [`SolutionFormat::usual_every`].
    pub every: Option<f64>,
    /// The frame of the poses, of a drive by poses.
    pub frame: Option<PoseFrame>,
}

/// Writes rows in a format as they come; memory does not grow.
pub struct SolutionFile<W: Write + Send = PendingFile> {
    writer: Writer<W>,
    /// Of the formats that are no text.
    thinning: Thinning,
}

/// The writer of a format.
enum Writer<W: Write + Send> {
    Text(Box<TextWriter<W>>),
    Mcap(Box<McapWriter<W>>),
    Mavlink(Box<MavlinkWriter<W>>),
    #[cfg(feature = "parquet")]
    Parquet(Box<ParquetTableWriter<W>>, Option<Epoch>),
}

impl SolutionFile<PendingFile> {
    /// Starts a file that appears under its name at [`SolutionFile::finish`].
    ///
    /// # Errors
    /// If the file cannot be created, the options are wrong or the format is not built in.
    pub fn create(
        path: &Path,
        format: SolutionFormat,
        options: &SolutionOptions,
    ) -> io::Result<Self> {
        Self::new(PendingFile::create(path)?, format, options)
    }

    /// Starts a file at each path, in `format` or else in that of its extension; standard output (`-`) as CSV.
    ///
    /// # Errors
    /// A sentence for the user when an extension names no format, a path is asked for twice or a file
    /// cannot be created.
    pub fn create_all(
        paths: &[PathBuf],
        format: Option<SolutionFormat>,
        options: &SolutionOptions,
    ) -> Result<Vec<Self>, String> {
        let mut files = Vec::new();
        for (k, path) in paths.iter().enumerate() {
            let name = path.display();
            if paths.iter().take(k).any(|other| other == path) {
                return Err(format!("{name} is requested twice"));
            }
            let format = format.or_else(|| SolutionFormat::from_path(path));
            let format = format.or_else(|| (path == Path::new("-")).then_some(SolutionFormat::Csv));
            let format = format.ok_or_else(|| {
                format!("{name}: unknown extension; use csv, nav, nmea, kml, geojson, gpx, mcap, parquet, sbet, jsonl, mavlink or tum, or set --format")
            })?;
            let file = Self::create(path, format, options);
            files.push(file.map_err(|e| format!("cannot write {name}: {e}"))?);
        }
        Ok(files)
    }

    /// Writes what is left and gives the file its name.
    ///
    /// # Errors
    /// If the file cannot be written or renamed; then there is no file of that name.
    pub fn finish(self) -> io::Result<()> {
        self.into_inner()?.finish()
    }
}

impl<W: Write + Send> SolutionFile<W> {
    /// Starts writing into any stream.
    ///
    /// # Errors
    /// If the options are wrong or the format is not built in.
    pub fn new(out: W, format: SolutionFormat, options: &SolutionOptions) -> io::Result<Self> {
        let every = options.every.unwrap_or(format.usual_every());
        if !(every >= 0.0 && every.is_finite()) {
            let message = format!("invalid row interval: {every} s");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        let (name, epoch) = (&options.name, options.epoch);
        let thinning = Thinning::new(every);
        let format = match format {
            SolutionFormat::Csv => csv::format(epoch.is_some()),
            SolutionFormat::KfGins => kf_gins::format(),
            SolutionFormat::Sbet => sbet::format(),
            SolutionFormat::Nmea => nmea::format(),
            SolutionFormat::Kml => kml::format(name),
            SolutionFormat::GeoJson => geojson::format(name),
            SolutionFormat::Gpx => gpx::format(name),
            SolutionFormat::JsonLines => json_lines::format(),
            SolutionFormat::Tum if options.frame.is_none() => {
                let message =
                    "tum is for drives by poses, which this one is not: it has no table [poses]";
                return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
            }
            SolutionFormat::Tum => tum::format(),
            SolutionFormat::Mcap => {
                let writer = McapWriter::new(out, epoch)?;
                let writer = Writer::Mcap(Box::new(writer));
                return Ok(Self { writer, thinning });
            }
            SolutionFormat::Mavlink => {
                let writer = Writer::Mavlink(Box::new(MavlinkWriter::new(out, epoch)));
                return Ok(Self { writer, thinning });
            }
            #[cfg(feature = "parquet")]
            SolutionFormat::Parquet => {
                let writer =
                    Writer::Parquet(Box::new(parquet::create(out, epoch.is_some())?), epoch);
                return Ok(Self { writer, thinning });
            }
            #[cfg(not(feature = "parquet"))]
            SolutionFormat::Parquet => {
                let message = format!("this build cannot write {}", format.name());
                return Err(io::Error::new(io::ErrorKind::Unsupported, message));
            }
        };
        let writer = Writer::Text(Box::new(
            TextWriter::new(out, format, epoch, every).in_frame(options.frame),
        ));
        Ok(Self { writer, thinning })
    }

    /// Writes one row; `outage` where no fix was used for long.
    ///
    /// # Errors
    /// If the stream does not take it.
    pub fn write(&mut self, row: &SolutionRow, outage: bool) -> io::Result<()> {
        match &mut self.writer {
            Writer::Text(writer) => writer.write(row, outage),
            _ if !self.thinning.takes(row.time) => Ok(()),
            Writer::Mcap(writer) => writer.write(row),
            Writer::Mavlink(writer) => writer.write(row),
            #[cfg(feature = "parquet")]
            Writer::Parquet(writer, epoch) => writer.write(parquet::values(row, *epoch)),
        }
    }

    /// Hands the rows so far to the stream, for whoever reads it meanwhile: of text, all of them; of the other formats what
    /// is complete.
    ///
    /// # Errors
    /// If the stream does not take it.
    pub fn flush(&mut self) -> io::Result<()> {
        match &mut self.writer {
            Writer::Text(writer) => writer.flush(),
            Writer::Mavlink(writer) => writer.flush(),
            _ => Ok(()),
        }
    }

    /// Writes what is left and gives the stream back.
    ///
    /// # Errors
    /// If the stream does not take it.
    pub fn into_inner(self) -> io::Result<W> {
        match self.writer {
            Writer::Text(writer) => writer.into_inner(),
            Writer::Mcap(writer) => writer.into_inner(),
            Writer::Mavlink(writer) => writer.into_inner(),
            #[cfg(feature = "parquet")]
            Writer::Parquet(writer, _) => writer.into_inner(),
        }
    }
}
