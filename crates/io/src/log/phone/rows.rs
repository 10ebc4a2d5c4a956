//! Rows of a table whose gyroscopes and accelerometers have values in rows of their own.

use undrift_nav::Vector3;

use super::Join;
use crate::ReadError;
use crate::entry::{Entry, ImuReading, What};
use crate::log::receiver::Ready;
use crate::skipped::{SkipKind, Skipped};

/// Joins the rows: a sample is one of the gyroscopes, with the force on the straight line at its time.
pub(crate) struct JoinedRows {
    join: Join,
    ready: Ready,
    error: Option<ReadError>,
}

impl JoinedRows {
    pub(crate) fn new() -> Self {
        Self {
            join: Join::slower(),
            ready: Ready::default(),
            error: None,
        }
    }

    /// Takes a row at a line and time \[s\]: a value of the gyroscopes, of the accelerometers or both.
    pub(crate) fn row(&mut self, line: u64, time: f64, gyro: Vector3, accel: Vector3) {
        let there = |value: &Vector3| value.iter().all(|x| x.is_finite());
        let (has_gyro, has_accel) = (there(&gyro), there(&accel));
        if !has_gyro && !has_accel {
            let detail = "neither gyroscopes nor accelerometers";
            self.ready.skip(line, SkipKind::MissingField, detail);
        }
        let mut added = Ok(());
        if has_accel {
            added = self.join.accel((line, time, accel), &mut self.ready);
        }
        if has_gyro && added.is_ok() {
            added = self.join.gyro((line, time, gyro), &mut self.ready);
        }
        self.error = self.error.take().or(added.err());
    }

    /// The next sample; what cannot be used is counted.
    pub(crate) fn next(&mut self, skipped: &mut Skipped) -> Option<ImuReading> {
        while let Some(Entry { at, what }) = self.ready.next() {
            match what {
                What::Imu(reading) => return Some(reading),
                What::Skipped(kind, detail) => skipped.add(kind, at, detail),
                _ => {}
            }
        }
        None
    }

    /// Why the rows cannot be joined, once.
    pub(crate) fn error(&mut self) -> Option<ReadError> {
        self.error.take()
    }
}
