//! One log of a drive while it comes.

use crate::{clocks::LogClock, stream::Stream};
use undrift_drive::drive::{Drive, ScalarLog};
use undrift_engine::Measurement;
use undrift_io::{Opened, ReadError, format::Format, gnss::GnssSource, imu::ImuSource};
use undrift_nav::sample::ImuSample;

/// The table of the inertial log.
pub(super) const IMU: &str = "imu";
/// The table of the fixes.
pub(super) const GNSS: &str = "gnss";
/// Records that show what a clock does: samples, and measurements.
const ENOUGH: [usize; 2] = [20, 3];

/// A record of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Record {
    /// An inertial sample.
    Sample(ImuSample),
    /// What aids.
    Measured(Measurement),
}

impl Record {
    /// As stamped \[s\].
    pub fn time(&self) -> f64 {
        match self {
            Self::Sample(sample) => sample.time,
            Self::Measured(measurement) => measurement.time(),
        }
    }

    /// The record with another time \[s\].
    pub(super) fn at(self, time: f64) -> Self {
        match self {
            Self::Sample(sample) => Self::Sample(ImuSample { time, ..sample }),
            Self::Measured(measurement) => Self::Measured(measurement.at(time)),
        }
    }
}

/// A log of the drive: its reader and its clock.
pub(super) struct LogStream {
    pub(super) table: String,
    pub(super) source: usize,
    pub(super) clock: LogClock<Record>,
    stream: Stream<Record>,
    /// Whether a record is complete only when the next begins, as the epochs of receivers: it came with the bytes before.
    pub(super) ends_with_the_next: bool,
    /// When the last bytes came, on the clock of the samples \[s\].
    pub(super) before: Option<f64>,
    /// How the log begins.
    beginning: Vec<u8>,
    /// Of a table of text, the lines before its first row: a reader that begins again needs them.
    header: Option<Header>,
}

/// The lines before the first row.
#[derive(Default)]
struct Header {
    lines: Vec<u8>,
    complete: bool,
}

/// Longest header \[bytes\].
const HEADER: usize = 64 * 1024;

impl Header {
    fn add(&mut self, bytes: &[u8]) {
        if self.complete {
            return;
        }
        self.lines.extend_from_slice(bytes);
        let mut end = 0;
        for line in self.lines.split_inclusive(|byte| *byte == b'\n') {
            let is_row = line
                .trim_ascii_start()
                .first()
                .is_some_and(|byte| matches!(byte, b'0'..=b'9' | b'-' | b'+' | b'.'));
            self.complete = is_row || end > HEADER;
            if self.complete || !line.ends_with(b"\n") {
                break;
            }
            end += line.len();
        }
        if self.complete {
            self.lines.truncate(end);
        }
    }
}

impl LogStream {
    pub(super) fn new(table: &str, source: usize, beginning: Vec<u8>, drive: &Drive) -> Self {
        let is_text = match table {
            IMU => matches!(drive.imu.1.source, ImuSource::Table { .. }),
            GNSS => matches!(drive.gnss.1, GnssSource::Table(_)),
            _ => true,
        };
        let enough = ENOUGH[usize::from(table != IMU)];
        Self {
            table: table.to_owned(),
            source,
            clock: LogClock::new(enough, table == IMU),
            stream: stream(table, beginning.clone(), drive),
            ends_with_the_next: table == GNSS && ends_with_the_next(&drive.gnss.1),
            before: None,
            beginning,
            header: is_text.then(Header::default),
        }
    }

    /// Hands over bytes; why the reader began again, if it had to.
    pub(super) fn feed(
        &mut self,
        bytes: &[u8],
        drive: &Drive,
        take: &mut dyn FnMut(Record),
    ) -> Option<Option<ReadError>> {
        if let Some(header) = &mut self.header {
            header.add(bytes);
        }
        let ended = self.stream.feed(bytes, take)?;
        self.stream = stream(&self.table, self.beginning.clone(), drive);
        self.clock.restart();
        if let Some(header) = &self.header {
            let whole = bytes
                .iter()
                .position(|byte| *byte == b'\n')
                .map_or(bytes.len(), |end| end + 1);
            let again = [&header.lines, bytes.get(whole..).unwrap_or_default()].concat();
            let _ = self.stream.feed(&again, take);
        }
        Some(ended)
    }
}

/// Whether a fix is complete only when the next begins: messages of ROS are complete in themselves.
fn ends_with_the_next(source: &GnssSource) -> bool {
    let whole = [Format::Mcap, Format::RosBag];
    matches!(source, GnssSource::Log(log) if !whole.contains(&log.format))
}

/// Records in a row behind the last one by which a clock was set back: more than overtake others.
const SET_BACK: u32 = 10;

/// The reader of a log while it comes.
fn stream(table: &str, beginning: Vec<u8>, drive: &Drive) -> Stream<Record> {
    let (drive, table) = (drive.clone(), table.to_owned());
    Stream::new(table.clone(), beginning, move |opened| {
        records(&drive, &table, opened.patient_for(SET_BACK))
    })
}

/// The records of the log of a table, in what is open.
///
/// # Errors
/// As those of [`Drive::read_imu`].
pub(crate) fn records(
    drive: &Drive,
    table: &str,
    opened: Opened,
) -> Result<Box<dyn Iterator<Item = Result<Record, ReadError>>>, ReadError> {
    if table == IMU {
        let samples = drive.read_imu(opened)?;
        return Ok(Box::new(samples.map(|sample| sample.map(Record::Sample))));
    }
    if table == GNSS {
        let fixes = drive.read_gnss(opened)?;
        let measured = |fix| Record::Measured(Measurement::Gnss(fix));
        return Ok(Box::new(fixes.map(move |fix| fix.map(measured))));
    }
    let Some(log) = ScalarLog::ALL.into_iter().find(|log| log.name() == table) else {
        return Ok(Box::new(std::iter::empty()));
    };
    let scalars = drive.read_scalars(log, opened)?.into_iter().flatten();
    let measured = move |scalar| Record::Measured(log.measurement(scalar));
    Ok(Box::new(scalars.map(move |scalar| scalar.map(measured))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_is_what_comes_before_the_first_row() {
        let mut header = Header::default();
        for piece in ["# log", "ger\nt,g", "x\n", "0.1,2\n0.2,3\n"] {
            header.add(piece.as_bytes());
        }
        assert_eq!(header.lines, b"# logger\nt,gx\n");
        let mut header = Header::default();
        header.add(b"0,1\n");
        assert_eq!(header.lines, b"");
    }
}
