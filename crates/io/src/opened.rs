//! A log, opened once and passed along: what it is, its beginning, and the rest of its stream.

use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::ReadError;
use crate::detect;
use crate::entry::{LocalPose, Stream, Wanted};
use crate::foreign;
use crate::format::Format;
use crate::log::rosbag2::{self, BagFile};
use crate::log::{self, Log};
use crate::source::{self, BytesRead, Failing, Source};
use crate::table::{
    self, Columns, Preview, Table, TableOptions, TableSource, halves, json_columns, objects,
    programs, tagged,
};
use undrift_nav::sample::{GnssFix, ImuSample, MagneticField, Scalar, TruthSample};

/// Bytes that the format is detected from.
const START: usize = 64 * 1024;
/// Of records in memory that are asked for columns or another kind of record.
pub(crate) const HELD: &str = "is held as records in memory, of another kind than asked for";
/// Bytes that a row of a preview has at most, on average.
const ROW: usize = 1024;

/// A log that is open: a file, standard input, a pipe, bytes or columns in memory.
pub struct Opened {
    name: PathBuf,
    origin: Origin,
    /// Whether it is compressed as a whole.
    compressed: bool,
    /// The beginning, decompressed, and why no more of it could be read.
    start: Vec<u8>,
    failure: Option<(io::ErrorKind, String)>,
    rest: Source,
    read: BytesRead,
    /// Of a log that is read while it comes, how it began.
    shown: Option<Vec<u8>>,
    /// Records in a row behind the last accepted one that end the reading, where that is not as usual.
    pub(crate) patience: Option<u32>,
}

/// A log in memory; clones share it.
#[derive(Clone, Debug)]
pub enum Memory {
    /// The bytes of a file, plain or gzip.
    Bytes(Arc<[u8]>),
    /// The columns of a table.
    Columns(Columns),
    /// Inertial samples, read by a format of [`ImuFormat::samples`](crate::imu::ImuFormat::samples).
    Samples(Arc<[ImuSample]>),
    /// GNSS fixes, read as [`GnssSource::Fixes`](crate::gnss::GnssSource::Fixes).
    Fixes(Arc<[GnssFix]>),
    /// Measurements of one number, read by a format of [`ScalarFormat::scalars`](crate::scalar::ScalarFormat::scalars).
    Scalars(Arc<[Scalar]>),
    /// Magnetic fields, read as [`MagneticSource::Held`](crate::magnetic::MagneticSource::Held).
    Fields(Arc<[MagneticField]>),
    /// A reference solution, read as [`TruthSource::Samples`](crate::truth::TruthSource::Samples).
    Truth(Arc<[TruthSample]>),
    /// Poses in a local frame, read as [`PoseSource::Poses`](crate::poses::PoseSource::Poses).
    Poses(Arc<[LocalPose]>),
}

/// Where a log comes from.
enum Origin {
    /// A regular file, which can be opened again.
    File,
    /// A folder of files that belong together.
    Folder,
    /// A stream that is read once.
    Once,
    Columns(Columns),
    /// Records in memory.
    Records(Memory),
}

impl Opened {
    /// Opens a file or pipe, plain or compressed, or the folder of a ROS 2 bag; "-" is standard input.
    ///
    /// # Errors
    /// If the file is missing or cannot be read, or a folder has no bag.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Self::counted(path, &BytesRead::default())
    }

    /// As [`Opened::open`]; `read` counts the bytes of the file from 0.
    ///
    /// # Errors
    /// As [`Opened::open`].
    pub fn counted(path: &Path, read: &BytesRead) -> Result<Self, ReadError> {
        if path.as_os_str() == "-" {
            return Self::from_stream(Path::new("standard input"), io::stdin(), read)?.a_log();
        }
        if path.is_dir() {
            if let Some(merged) = log::sensor_logger::folder(path)? {
                return Self::from_stream(path, merged, read)?.a_log();
            }
            rosbag2::parts_of_folder(path)?;
            return Ok(Self {
                name: path.to_path_buf(),
                origin: Origin::Folder,
                ..Self::from_stream(path, io::empty(), read)?
            });
        }
        if let Some(files) = halves::files(path) {
            return Self::from_stream(path, halves::table(&files)?, read)?.a_log();
        }
        let file = source::file(path)?;
        let regular = file.metadata().is_ok_and(|about| about.is_file());
        let mut opened = Self::from_stream(path, file, read)?;
        if regular {
            opened.origin = Origin::File;
        }
        opened.a_log()
    }

    /// Reads a log from any stream, plain or gzip; `name` is what messages call it.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn stream(name: &Path, stream: impl Read + Send + 'static) -> Result<Self, ReadError> {
        Self::from_stream(name, stream, &BytesRead::default())?.a_log()
    }

    /// Reads a log while it comes: nothing waits for more than a record. `beginning` is what such a log begins with, as far as
    /// that is known; its format has to be.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn live(
        name: &Path,
        beginning: &[u8],
        stream: impl Read + Send + 'static,
    ) -> Result<Self, ReadError> {
        let opened = Self::begun(name, stream, &BytesRead::default())?;
        let shown = Some(beginning.get(..START).unwrap_or(beginning).to_vec());
        Ok(Self { shown, ..opened })
    }

    /// Ends the reading already after so many records in a row that are earlier than the last accepted one, by the error of a clock
    /// that was set back: for whoever then begins again.
    #[must_use]
    pub fn patient_for(self, records: u32) -> Self {
        let patience = Some(records);
        Self { patience, ..self }
    }

    fn from_stream(
        name: &Path,
        stream: impl Read + Send + 'static,
        read: &BytesRead,
    ) -> Result<Self, ReadError> {
        let mut opened = Self::begun(name, stream, read)?;
        opened.read_to(START as u64);
        #[cfg(feature = "xlsx")]
        if table::workbook::may_be(&opened.start) {
            opened.rewritten(table::workbook::table);
        }
        if source::has_returns_alone(&opened.start) {
            opened.rewritten(source::with_newlines);
        }
        if programs::may_be(&opened.start) {
            opened.rewritten(programs::table);
        }
        if objects::are_there(&opened.start) {
            opened.rewritten(objects::lines);
        }
        if log::sensor_logger::are_objects(&opened.start) {
            opened.rewritten(log::sensor_logger::of_objects);
        } else if json_columns::may_be(&opened.start) {
            opened.rewritten(json_columns::table);
        } else if opened.format() == Format::Csv && tagged::may_be(&opened.start) {
            opened.rewritten(tagged::table);
        }
        Ok(opened)
    }

    /// Reads it from now on as the text that is made of it and its beginning.
    fn rewritten(&mut self, text: fn(Source, &[u8]) -> Source) {
        let rest = std::mem::replace(&mut self.rest, Box::new(io::empty()));
        let start = std::mem::take(&mut self.start);
        let failure = self.failure.take();
        let whole = whole(start.clone(), failure, rest);
        self.rest = text(whole, &start);
        self.read_to(START as u64);
    }

    fn begun(
        name: &Path,
        stream: impl Read + Send + 'static,
        read: &BytesRead,
    ) -> Result<Self, ReadError> {
        read.restart();
        let (rest, compressed) = source::decompressed(name, stream, read)?;
        Ok(Self {
            name: name.to_path_buf(),
            origin: Origin::Once,
            compressed,
            start: Vec::new(),
            failure: None,
            rest,
            read: read.clone(),
            shown: None,
            patience: None,
        })
    }

    /// Refuses what is known to be no log.
    fn a_log(self) -> Result<Self, ReadError> {
        let is_lost = self.format() == Format::Csv && !self.start.contains(&b'\n');
        if let Some((_, why)) = self.failure.as_ref().filter(|_| is_lost) {
            let problem = format!("cannot be read: {why}");
            return Err(ReadError::new(&self.name, problem).mend("copy or record it again"));
        }
        // Damaged compression is reported where the log is read.
        let foreign = match self.failure.is_none() && self.format() == Format::Csv {
            true => foreign::known(&self.start),
            false => None,
        };
        foreign.map_or(Ok(()), |foreign| Err(foreign.in_place_of_a_log(&self.name)))?;
        Ok(self)
    }

    /// Reads a log in memory, called `name`; `read` counts its bytes.
    ///
    /// # Errors
    /// If it cannot be decompressed.
    pub fn memory(name: &Path, memory: Memory, read: &BytesRead) -> Result<Self, ReadError> {
        match memory {
            Memory::Bytes(bytes) => Self::from_stream(name, Cursor::new(bytes), read)?.a_log(),
            Memory::Columns(columns) => Ok(Self::held(name, Origin::Columns(columns), read)),
            records => Ok(Self::held(name, Origin::Records(records), read)),
        }
    }

    fn held(name: &Path, origin: Origin, read: &BytesRead) -> Self {
        Self {
            name: name.to_path_buf(),
            origin,
            compressed: false,
            start: Vec::new(),
            failure: None,
            rest: Box::new(io::empty()),
            read: read.clone(),
            shown: None,
            patience: None,
        }
    }

    /// The records that it is in memory; `None` of bytes and columns.
    pub(crate) fn records(&self) -> Option<&Memory> {
        match &self.origin {
            Origin::Records(records) => Some(records),
            _ => None,
        }
    }

    /// What a pipe or standard input ("-") has, to be read more than once; `None` of a file, which can be
    /// opened again, and of what is not there.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn hold(path: &Path) -> Result<Option<Memory>, ReadError> {
        let mut bytes = Vec::new();
        let is_stream = |about: std::fs::Metadata| !about.is_file() && !about.is_dir();
        let read = if path.as_os_str() == "-" {
            io::stdin().read_to_end(&mut bytes)
        } else if std::fs::metadata(path).is_ok_and(is_stream) {
            source::file(path)?.read_to_end(&mut bytes)
        } else {
            return Ok(None);
        };
        read.map_err(|error| source::cannot_open(path, error))?;
        Ok(Some(Memory::Bytes(bytes.into())))
    }

    /// The files that a log consists of: itself, or those of a ROS 2 bag in a folder.
    pub fn files(path: &Path) -> Vec<PathBuf> {
        if let Some(files) = halves::files(path) {
            return files.to_vec();
        }
        let parts = match path.is_dir() {
            true => rosbag2::parts_of_folder(path).unwrap_or_default(),
            false => return vec![path.to_path_buf()],
        };
        parts.iter().map(|part| part.name().to_path_buf()).collect()
    }

    /// What messages call it: the path as it was given.
    pub fn name(&self) -> &Path {
        &self.name
    }

    /// The regular file that it is; `None` of what can be read once only.
    pub fn file(&self) -> Option<&Path> {
        matches!(self.origin, Origin::File).then_some(&self.name)
    }

    /// Its format, by the content: [`Format::Csv`] where no other format fits.
    pub fn format(&self) -> Format {
        match self.origin {
            Origin::Folder => Format::RosBag2,
            _ => detect::format(&self.start),
        }
    }

    /// Its beginning, decompressed.
    pub(crate) fn start(&self) -> &[u8] {
        &self.start
    }

    /// Columns of the first row of a text of numbers with blanks between; 0 for any other text.
    pub fn width(&self) -> usize {
        detect::width(&self.start)
    }

    /// Whether it is an RTKLIB solution without the header that names its columns and time system.
    pub fn lacks_header(&self) -> bool {
        log::lacks_header(&self.start)
    }

    /// The names of the columns of a table and up to `rows` rows of all of them.
    ///
    /// # Errors
    /// If there is no line, or Parquet cannot be read.
    pub fn preview(&mut self, rows: usize) -> Result<Preview, ReadError> {
        self.as_rows();
        self.read_to(rows.saturating_mul(ROW) as u64);
        let source = match self.unlike_text()? {
            Some(source) => source,
            None => TableSource::Text(self.beginning(), None),
        };
        table::preview(source, rows).map_err(|error| error.in_log(&self.name))
    }

    /// The streams of a log that says itself what it holds.
    ///
    /// # Errors
    /// If it cannot be read, or is one whose columns have to be named.
    pub fn streams(self, format: Format) -> Result<Vec<Stream>, ReadError> {
        let name = self.name.clone();
        let streams = if self.is_bag(format) {
            self.into_parts().and_then(rosbag2::streams)
        } else {
            log::streams(self.into_source(), format)
        };
        streams.map_err(|error| error.in_log(&name))
    }

    /// Reads it as a table, text or Parquet, and finds the wanted columns.
    ///
    /// # Errors
    /// If it has no line, or lacks a wanted column.
    pub fn table(mut self, options: &TableOptions) -> Result<Table, ReadError> {
        let name = self.name.clone();
        self.as_rows();
        let source = match self.unlike_text()? {
            Some(source) => source,
            None => {
                let shown = self.shown.take();
                TableSource::Text(self.into_source(), shown)
            }
        };
        Table::new(&name, source, options)
    }

    /// Whether it is sentences of NMEA with the rows of an inertial sensor between them: a table where that is asked for.
    pub fn has_rows(&self) -> bool {
        self.format() == Format::Nmea && tagged::may_be(&self.start)
    }

    fn as_rows(&mut self) {
        if self.has_rows() {
            self.rewritten(tagged::between_sentences);
        }
    }

    /// Reads it as a log of the format.
    pub(crate) fn log(mut self, format: Format, wanted: &Wanted) -> Result<Log, ReadError> {
        let name = self.name.clone();
        let mut wanted = wanted.clone();
        if let Wanted::Fixes { at_once, .. } = &mut wanted {
            *at_once = self.shown.is_some();
        }
        let wanted = &wanted;
        if self.is_bag(format) {
            let read = self.read.clone();
            let parts = self.into_parts();
            let log = parts.and_then(|parts| Log::of_bag(parts, &read, wanted));
            return log.map_err(|error| error.in_log(&name));
        }
        let held: Option<Arc<[u8]>> = match self.origin {
            Origin::Once if log::reads_twice(format) => {
                self.read_to(u64::MAX);
                Some(self.start.as_slice().into())
            }
            _ => None,
        };
        let again = || match &held {
            Some(bytes) => Ok(Box::new(Cursor::new(bytes.clone())) as Source),
            None => source::open(&name),
        };
        Log::new(self.into_source(), &again, format, wanted).map_err(|error| error.in_log(&name))
    }

    /// Whether it is read as a ROS 2 bag where a format is asked for.
    fn is_bag(&self, format: Format) -> bool {
        format == Format::RosBag2 || matches!(self.origin, Origin::Folder)
    }

    /// The files of a ROS 2 bag; what can be read once only is held in memory, since its parts are in any order.
    fn into_parts(mut self) -> Result<Vec<BagFile>, ReadError> {
        match self.origin {
            Origin::Folder => rosbag2::parts_of_folder(&self.name),
            Origin::File => Ok(vec![BagFile::File(self.name)]),
            Origin::Once | Origin::Columns(_) | Origin::Records(_) => {
                self.read_to(rosbag2::MOST_HELD + 1);
                if self.start.len() as u64 > rosbag2::MOST_HELD {
                    return Err(rosbag2::too_large());
                }
                Ok(vec![BagFile::Held(self.name, self.start)])
            }
        }
    }

    /// The table that it is, where that is not text.
    ///
    /// # Errors
    /// If it is no table.
    fn unlike_text(&mut self) -> Result<Option<TableSource>, ReadError> {
        match &self.origin {
            Origin::Columns(columns) => Ok(Some(TableSource::Columns(columns.clone()))),
            Origin::Folder => {
                let problem = "is the folder of a ROS 2 bag, not a table";
                let error = ReadError::new(&self.name, problem);
                Err(error.mend("remove the columns, or give a file"))
            }
            Origin::Records(_) => Err(ReadError::new(&self.name, HELD)),
            _ if table::is_parquet(&self.start) => self.parquet().map(Some),
            _ => match foreign::not_rows(&self.start) {
                Some(foreign) => Err(foreign.in_place_of_a_log(&self.name)),
                None => Ok(None),
            },
        }
    }

    /// Reads on until the beginning has so many bytes, or all that there are.
    fn read_to(&mut self, length: u64) {
        let more = length.saturating_sub(self.start.len() as u64);
        if self.failure.is_none() {
            // Damaged compression shows again when the log is read.
            let read = (&mut self.rest).take(more).read_to_end(&mut self.start);
            self.failure = read.err().map(|error| (error.kind(), error.to_string()));
        }
    }

    /// The whole lines of the beginning.
    fn beginning(&mut self) -> Source {
        let all = self.rest.fill_buf().is_ok_and(<[u8]>::is_empty);
        let end = match self.start.iter().rposition(|byte| *byte == b'\n') {
            Some(last) if !all => last + 1,
            _ => self.start.len(),
        };
        let lines = self.start.get(..end).unwrap_or_default();
        Box::new(Cursor::new(lines.to_vec()))
    }

    fn parquet(&mut self) -> Result<TableSource, ReadError> {
        if self.compressed {
            return Err(ReadError::new(&self.name, "is compressed as a whole")
                .mend("decompress it: Parquet is read from its end, and compressed inside"));
        }
        let file = match self.origin {
            Origin::File => Some(source::file(&self.name)?),
            _ => None,
        };
        if file.is_none() {
            self.read_to(u64::MAX);
        }
        table::parquet(file, &self.start).map_err(|error| error.in_log(&self.name))
    }

    /// The whole stream, from its start.
    fn into_source(self) -> Source {
        whole(self.start, self.failure, self.rest)
    }
}

/// A stream from its beginning, of which so much was read before it failed or not.
fn whole(start: Vec<u8>, failure: Option<(io::ErrorKind, String)>, rest: Source) -> Source {
    let failure = failure.map(|(kind, why)| io::Error::new(kind, why));
    let start = Cursor::new(start).chain(BufReader::new(Failing(failure)));
    Box::new(start.chain(rest))
}
