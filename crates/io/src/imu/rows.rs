//! The rows of an inertial log, as they are in the file.

use std::path::Path;

use undrift_nav::Vector3;

use crate::ReadError;
use crate::log::{Log, What};
use crate::skipped::Skipped;
use crate::table::Table;

pub(super) enum Rows {
    Table {
        table: Box<Table>,
        /// Time (where there is a column), gyro x y z, accel x y z.
        row: [f64; 7],
    },
    Log(Log),
}

impl Rows {
    pub(super) fn path(&self) -> &Path {
        match self {
            Self::Table { table, .. } => table.path(),
            Self::Log(log) => log.path(),
        }
    }

    pub(super) fn skipped(&self) -> &Skipped {
        match self {
            Self::Table { table, .. } => table.skipped(),
            Self::Log(log) => log.skipped(),
        }
    }

    /// The next row: its line, stamp (the number of rows before it where there is none), gyro and
    /// accelerometer.
    #[inline]
    pub(super) fn next(
        &mut self,
        has_times: bool,
    ) -> Result<Option<(u64, f64, Vector3, Vector3)>, ReadError> {
        match self {
            Self::Table { table, row } => {
                let Some(line) = table.next_row(&mut row[usize::from(!has_times)..])? else {
                    return Ok(None);
                };
                let [stamp, gx, gy, gz, ax, ay, az] = *row;
                let stamp = match has_times {
                    true => stamp,
                    false => (table.rows_seen() - 1) as f64,
                };
                let (gyro, accel) = (Vector3::new(gx, gy, gz), Vector3::new(ax, ay, az));
                Ok(Some((line, stamp, gyro, accel)))
            }
            Self::Log(log) => {
                while let Some(entry) = log.next()? {
                    if let What::Imu(reading) = entry.what {
                        return Ok(Some((entry.at, reading.time, reading.gyro, reading.accel)));
                    }
                }
                Ok(None)
            }
        }
    }

    pub(super) fn skipped_mut(&mut self) -> &mut Skipped {
        match self {
            Self::Table { table, .. } => table.skipped_mut(),
            Self::Log(log) => log.skipped_mut(),
        }
    }
}
