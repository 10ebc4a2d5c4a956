//! Where the samples of an inertial log are and what they mean.

use undrift_nav::{Matrix3, Vector3};

use super::thermal::Thermal;
use crate::ReadError;
use crate::format::Format;
use crate::table::{Column, check_time_scale};

/// Where the samples of an inertial log are.
#[derive(Clone, Debug)]
pub enum ImuSource {
    /// In columns of a table.
    Table {
        /// Time column; without one, row k (from 0, skipped rows count) is at k / `rate_hz`.
        time: Option<Column>,
        /// Angular rates or increments, the sensor's x, y, z.
        gyro: [Column; 3],
        /// Specific forces or velocity increments, the sensor's x, y, z.
        accel: [Column; 3],
        /// The byte between fields; `None` finds out.
        delimiter: Option<u8>,
    },
    /// In a stream of a log, named as `log::streams` does; `None` for the only one.
    Log(Format, Option<String>),
    /// Samples in memory.
    Samples,
}

/// The column of a table that has the sensor's temperature.
#[derive(Clone, Debug, PartialEq)]
pub struct TemperatureColumn {
    /// Which.
    pub column: Column,
    /// What its unit has at 0 °C.
    pub zero: f64,
}

/// Where the samples of an inertial log are and what they mean.
#[derive(Clone, Debug)]
pub struct ImuFormat {
    /// Where they are.
    pub source: ImuSource,
    /// Column of dates, where that of times has times of day.
    pub date: Option<Column>,
    /// Factor from the time column to seconds; 1 for a log.
    pub time_scale: f64,
    /// Gyros and accelerometers have values in rows of their own, and blanks in the others': a sample is a row of the gyros,
    /// with the force interpolated to its time.
    pub apart: bool,
    /// Rows of a table that share a stamp, while their values differ, are spread evenly over the time to the next stamp; else all
    /// but the first are left out.
    pub spread_shared_stamps: bool,
    /// Factors from the gyros' x, y, z to rad/s, or to rad for increments; 1 for a log in order, negative for an axis that is
    /// reversed.
    pub gyro_scale: Vector3,
    /// The same of the accelerometers to m/s², or to m/s for increments.
    pub accel_scale: Vector3,
    /// The columns are increments over the interval rather than rates.
    pub increments: bool,
    /// Sampling rate \[Hz\]: makes the times where there is no time column, the interval of the first
    /// sample, which is otherwise taken from the second one, and the interval that a row of
    /// increments covers.
    pub rate_hz: Option<f64>,
    /// Added to the time after scaling \[s\].
    pub time_offset: f64,
    /// Rotation from sensor axes to body axes.
    pub rotation: Matrix3,
    /// Known constant of the gyros, body axes [rad/s], subtracted.
    pub gyro_offset: Vector3,
    /// Known constant of the accelerometers, body axes [m/s²], subtracted.
    pub accel_offset: Vector3,
    /// The temperature of a table's rows; a log's is read where its samples have one.
    pub temperature: Option<TemperatureColumn>,
    /// The bias over temperature, which is subtracted.
    pub thermal: Option<Thermal>,
    /// First and last time \[s\] to give out, after the offset; the samples outside are passed over.
    pub span: Option<(f64, f64)>,
}

impl ImuFormat {
    /// Rates in SI units along the body axes, times in seconds.
    pub fn new(time: Option<Column>, gyro: [Column; 3], accel: [Column; 3]) -> Self {
        Self::from_source(ImuSource::Table {
            time,
            gyro,
            accel,
            delimiter: None,
        })
    }

    /// The byte between the fields of a table; `None` finds out.
    pub fn delimited_by(mut self, byte: Option<u8>) -> Self {
        if let ImuSource::Table { delimiter, .. } = &mut self.source {
            *delimiter = byte;
        }
        self
    }

    /// The samples of a log's stream, along the body axes.
    pub fn log(format: Format, stream: Option<String>) -> Self {
        Self::from_source(ImuSource::Log(format, stream))
    }

    /// Samples in memory, along the body axes: [`Memory::Samples`](crate::Memory::Samples).
    pub fn samples() -> Self {
        Self::from_source(ImuSource::Samples)
    }

    fn from_source(source: ImuSource) -> Self {
        Self {
            source,
            date: None,
            time_scale: 1.0,
            apart: false,
            spread_shared_stamps: false,
            gyro_scale: Vector3::repeat(1.0),
            accel_scale: Vector3::repeat(1.0),
            increments: false,
            rate_hz: None,
            time_offset: 0.0,
            rotation: Matrix3::identity(),
            gyro_offset: Vector3::zeros(),
            accel_offset: Vector3::zeros(),
            temperature: None,
            thermal: None,
            span: None,
        }
    }

    /// Whether the samples have stamps: else their times are made from the rate.
    pub fn has_times(&self) -> bool {
        !matches!(self.source, ImuSource::Table { time: None, .. })
    }

    pub(super) fn check(&self) -> Result<(), ReadError> {
        if let Some(rate) = self.rate_hz {
            if !(rate.is_normal() && rate > 0.0) {
                let problem = format!("invalid rate: {rate} Hz");
                return Err(ReadError::nameless(problem).key("imu.rate"));
            }
        } else if !self.has_times() {
            return Err(ReadError::nameless("no time column and no rate")
                .key("imu.time")
                .mend("set imu.time or imu.rate"));
        }
        check_time_scale(self.time_scale, "imu.time")
    }
}
