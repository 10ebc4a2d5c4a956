//! The logs that aid a drive, in order of time.

use super::{Drive, ScalarLog};
use crate::replay::{Measurement, merge};
use undrift_engine::{Aid, Log};
use undrift_io::{
    Opened, ReadError,
    gnss::GnssReader,
    imu::GapSummary,
    magnetic::{MagneticFormat, MagneticReader},
    reader::Reader,
    scalar::ScalarReader,
    skipped::Skipped,
};

/// The logs that aid a drive, opened by [`Drive::open_aids`](super::Drive::open_aids).
pub struct Aids {
    /// Reader of the fixes.
    pub gnss: GnssReader,
    /// Readers of the logs of other sensors, those that there are.
    pub sensors: Vec<SensorReader>,
}

/// Reader of the log of a sensor beside IMU and GNSS receiver.
pub enum SensorReader {
    /// Of one number.
    Scalar(ScalarLog, ScalarReader),
    /// Of magnetic fields.
    Magnetometer(MagneticReader),
}

/// What was read of the log of such a sensor.
#[derive(Clone, Debug)]
pub struct SensorRead {
    /// The log, as findings name it.
    pub log: Log,
    /// What its updates are counted by.
    pub aid: Aid,
    /// Records that were skipped, and why.
    pub skipped: Skipped,
    /// Usual interval and gaps.
    pub gaps: GapSummary,
}

impl SensorReader {
    /// What was read so far.
    fn read(&self) -> SensorRead {
        let (log, aid, skipped, gaps) = match self {
            Self::Scalar(log, reader) => (log.log(), log.aid(), reader.skipped(), reader.gaps()),
            Self::Magnetometer(reader) => {
                let skipped = reader.skipped();
                (Log::Magnetometer, Aid::Magnetometer, skipped, reader.gaps())
            }
        };
        SensorRead {
            log,
            aid,
            skipped: skipped.clone(),
            gaps,
        }
    }
}

impl Iterator for SensorReader {
    type Item = Result<Measurement, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        Some(match self {
            Self::Scalar(log, reader) => reader.next()?.map(|scalar| Measurement::of(*log, scalar)),
            Self::Magnetometer(reader) => reader.next()?.map(Measurement::Magnetometer),
        })
    }
}

impl Aids {
    /// Fixes and all other measurements in order of time.
    pub fn measurements(&mut self) -> impl Iterator<Item = Result<Measurement, ReadError>> {
        merge(
            self.gnss.by_ref().map(|fix| fix.map(Measurement::Gnss)),
            merged(&mut self.sensors),
        )
    }

    /// Skipped records and gaps of each log of another sensor, as far as it was read.
    pub fn sensors_read(&self) -> Vec<SensorRead> {
        self.sensors.iter().map(SensorReader::read).collect()
    }
}

/// Measurements of these logs merged in order of time; of one time in the order of the logs.
pub fn merged(
    logs: &mut [SensorReader],
) -> Box<dyn Iterator<Item = Result<Measurement, ReadError>> + '_> {
    let mut all: Box<dyn Iterator<Item = _> + '_> = Box::new(std::iter::empty());
    for reader in logs.iter_mut().rev() {
        all = Box::new(merge(reader, all));
    }
    all
}

impl Drive {
    /// Reads what is open as the log of a sensor beside IMU and GNSS receiver, by the name of its table; `None` if the drive has no such
    /// log.
    ///
    /// # Errors
    /// As [`Drive::open_imu`].
    pub fn read_sensor(
        &self,
        table: &str,
        opened: Opened,
    ) -> Result<Option<SensorReader>, ReadError> {
        if table == Log::Magnetometer.name() {
            let format = self.magnetic_format();
            let reader = format.map(|format| Reader::new(opened, &format));
            return Ok(reader.transpose()?.map(SensorReader::Magnetometer));
        }
        let log = ScalarLog::ALL.into_iter().find(|log| log.name() == table);
        let format = log.and_then(|log| Some((log, &self.scalars[log].as_ref()?.1)));
        format
            .map(|(log, format)| Ok(SensorReader::Scalar(log, Reader::new(opened, format)?)))
            .transpose()
    }

    /// Opens the logs of sensors beside IMU and GNSS receiver, those that there are, from their start.
    ///
    /// # Errors
    /// As [`Drive::open_imu`].
    pub fn open_sensors(&self) -> Result<Vec<SensorReader>, ReadError> {
        let mut opened = Vec::new();
        for log in ScalarLog::ALL {
            if let Some((path, format)) = &self.scalars[log] {
                let reader = self.logs.read(path, format)?;
                opened.push(SensorReader::Scalar(log, reader));
            }
        }
        if let (Some((path, _)), Some(format)) = (&self.magnetometer, self.magnetic_format()) {
            let reader = self.logs.read(path, &format)?;
            opened.push(SensorReader::Magnetometer(reader));
        }
        Ok(opened)
    }

    /// How magnetic fields are read, in body axes: those of the drive are relative to the inertial sensor's.
    fn magnetic_format(&self) -> Option<MagneticFormat> {
        let (_, format) = self.magnetometer.as_ref()?;
        Some(MagneticFormat {
            rotation: self.imu.1.rotation * format.rotation,
            ..format.clone()
        })
    }

    /// Opens the logs that aid it from their start: fixes and every other measurement.
    ///
    /// # Errors
    /// As [`Drive::open_imu`].
    pub fn open_aids(&self) -> Result<Aids, ReadError> {
        Ok(Aids {
            gnss: self.open_gnss()?,
            sensors: self.open_sensors()?,
        })
    }
}
