//! One log of a drive while it comes.

use super::head::Head;
use crate::{clocks::LogClock, stream::Stream};
use undrift_drive::drive::Drive;
use undrift_engine::Measurement;
use undrift_io::{
    Opened, ReadError, format::Format, gnss::GnssSource, imu::ImuSource, poses::PoseSource,
};
use undrift_nav::sample::ImuSample;

/// The table of the inertial log.
pub(super) const IMU: &str = "imu";
/// The table of the fixes, and that of poses in their place.
pub(super) const GNSS: &str = "gnss";
pub(super) const POSES: &str = "poses";
/// Records that show what a clock does: samples, and measurements.
const ENOUGH: [usize; 2] = [20, 3];

/// A record of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "passed on one by one, and not kept"
)]
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
    /// What a reader that begins again needs.
    head: Option<Head>,
}

impl LogStream {
    pub(super) fn new(table: &str, source: usize, beginning: Vec<u8>, drive: &Drive) -> Self {
        let format = match (table, &drive.imu.1.source, &drive.gnss.1) {
            (IMU, ImuSource::Log(format, _), _) => Some(*format),
            (GNSS, _, GnssSource::Log(log)) => Some(log.format),
            (POSES, _, GnssSource::Poses(fixes)) => match &fixes.source {
                PoseSource::Log(log) => Some(log.format),
                _ => None,
            },
            _ => None,
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
            head: Head::new(format),
        }
    }

    /// Hands over bytes; why the reader began again, if it had to.
    pub(super) fn feed(
        &mut self,
        bytes: &[u8],
        drive: &Drive,
        take: &mut dyn FnMut(Record),
    ) -> Option<Option<ReadError>> {
        if let Some(head) = &mut self.head {
            head.add(bytes);
        }
        let ended = self.stream.feed(bytes, take)?;
        self.stream = stream(&self.table, self.beginning.clone(), drive);
        self.clock.restart();
        if let Some(head) = &self.head {
            let _ = self.stream.feed(&head.again(bytes), take);
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
    if [GNSS, POSES].contains(&table) {
        let fixes = drive.read_gnss(opened)?;
        let measured = |fix| Record::Measured(Measurement::Gnss(fix));
        return Ok(Box::new(fixes.map(move |fix| fix.map(measured))));
    }
    let readings = drive.read_sensor(table, opened)?.into_iter().flatten();
    Ok(Box::new(
        readings.map(|reading| reading.map(Record::Measured)),
    ))
}
