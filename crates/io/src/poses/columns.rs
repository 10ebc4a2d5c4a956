//! Rows of a table as poses.

use undrift_nav::{Matrix3, Quaternion, attitude};

use super::LocalPose;
use crate::ReadError;
use crate::epoch::Weeks;
use crate::fix::diagonal;
use crate::reader::TableRow;
use crate::rotation::{of_matrix, of_quaternion};
use crate::skipped::{Skipped, Unfit};
use crate::table::{Column, TableOptions, check_time_scale, three};

/// Where the columns of poses are and what they mean.
#[derive(Clone, Debug)]
pub struct PoseFormat {
    /// Time column.
    pub time: Column,
    /// Column of dates, where that of times has times of day.
    pub date: Option<Column>,
    /// Factor from the time column to seconds.
    pub time_scale: f64,
    /// Added to the time after scaling \[s\].
    pub time_offset: f64,
    /// GPS week, where the time is the second of it: times count on from the week of the first row.
    pub week: Option<Column>,
    /// Position x, y, z along the axes of the local frame.
    pub position: Option<[Column; 3]>,
    /// Factor from its columns and those of its standard deviations to metres.
    pub position_scale: f64,
    /// Standard deviations of the position along these axes.
    pub position_std: Option<[Column; 3]>,
    /// Attitude of the marker in the local frame.
    pub attitude: Option<AttitudeColumns>,
    /// Whether the order of its quaternion is known.
    pub quaternion_order: QuaternionOrder,
    /// Standard deviations of the rotation error about the axes of the local frame.
    pub attitude_std: Option<[Column; 3]>,
    /// Factor from its columns to radians.
    pub attitude_std_scale: f64,
    /// Lines at the beginning of a text that are no rows, where columns go by number.
    pub header_lines: u64,
    /// The byte between fields; `None` finds out.
    pub delimiter: Option<u8>,
    /// First and last time \[s\] to give out, after the offset.
    pub span: Option<(f64, f64)>,
}

/// How an attitude is written: what turns vectors of the marker's axes into the local ones.
#[derive(Clone, Debug, PartialEq)]
pub enum AttitudeColumns {
    /// Hamilton quaternion.
    Quaternion {
        /// Its columns in their order.
        columns: [Column; 4],
        /// The first is the scalar part w, else the last.
        w_first: bool,
    },
    /// Angles: yaw about z first, then pitch about the new y, then roll about the new x.
    Euler {
        /// Columns of roll, pitch, yaw.
        columns: [Column; 3],
        /// Factor from them to radians.
        scale: f64,
    },
    /// Rotation vector: along the axis, as long as the angle.
    RotationVector {
        /// Its columns x, y, z.
        columns: [Column; 3],
        /// Factor from them to radians.
        scale: f64,
    },
    /// Rotation matrix, row by row.
    Matrix([Column; 9]),
}

/// Whether it is known which of the four columns of a quaternion is the scalar part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum QuaternionOrder {
    /// By the names of the columns or the format, or by the user.
    #[default]
    Stated,
    /// By the numbers alone: the other order fits as well, and whoever reads it should say so.
    Guessed,
}

impl PoseFormat {
    /// Times in seconds, positions in metres, without uncertainties.
    pub fn new(
        time: Column,
        position: Option<[Column; 3]>,
        attitude: Option<AttitudeColumns>,
    ) -> Self {
        Self {
            time,
            date: None,
            time_scale: 1.0,
            time_offset: 0.0,
            week: None,
            position,
            position_scale: 1.0,
            position_std: None,
            attitude,
            quaternion_order: QuaternionOrder::Stated,
            attitude_std: None,
            attitude_std_scale: 1.0,
            header_lines: 0,
            delimiter: None,
            span: None,
        }
    }
}

impl AttitudeColumns {
    fn columns(&self) -> &[Column] {
        match self {
            Self::Quaternion { columns, .. } => columns,
            Self::Euler { columns, .. } | Self::RotationVector { columns, .. } => columns,
            Self::Matrix(columns) => columns,
        }
    }
}

/// Makes poses of rows.
pub(super) struct PoseColumns {
    format: PoseFormat,
    /// Places in the row read.
    position: Option<usize>,
    position_std: Option<usize>,
    attitude: Option<usize>,
    attitude_std: Option<usize>,
    pub(super) weeks: Weeks,
}

impl PoseColumns {
    /// With what is wanted of the table.
    pub(super) fn new(format: &PoseFormat) -> Result<(Self, TableOptions), ReadError> {
        check_time_scale(format.time_scale, "poses.time")?;
        let angle_scale = match format.attitude {
            Some(
                AttitudeColumns::Euler { scale, .. }
                | AttitudeColumns::RotationVector { scale, .. },
            ) => scale,
            _ => 1.0,
        };
        for (scale, key) in [
            (format.position_scale, "poses.position"),
            (format.attitude_std_scale, "poses.attitude_std"),
            (angle_scale, "poses.attitude"),
        ] {
            if !(scale.is_finite() && scale > 0.0) {
                return Err(ReadError::nameless(format!("invalid scale: {scale}")).key(key));
            }
        }
        if format.position.is_none() && format.attitude.is_none() {
            let problem = "neither position nor attitude requested";
            return Err(ReadError::nameless(problem).key("poses"));
        }
        let mut wanted = TableOptions {
            header_lines: format.header_lines,
            ..TableOptions::finite(format.delimiter)
        };
        wanted.want_time(
            "poses",
            &format.time,
            format.date.as_ref(),
            format.time_scale,
        );
        let mut want = |name: &str, columns: Option<&[Column]>| {
            columns.map(|columns| wanted.want(&format!("poses.{name}"), columns))
        };
        let position_std = format
            .position_std
            .as_ref()
            .filter(|_| format.position.is_some());
        let attitude_std = format
            .attitude_std
            .as_ref()
            .filter(|_| format.attitude.is_some());
        let columns = Self {
            position: want("position", format.position.as_ref().map(|c| &c[..])),
            position_std: want("position_std", position_std.map(|c| &c[..])),
            attitude: want(
                "attitude",
                format.attitude.as_ref().map(AttitudeColumns::columns),
            ),
            attitude_std: want("attitude_std", attitude_std.map(|c| &c[..])),
            weeks: Weeks::default(),
            format: format.clone(),
        };
        wanted.want("poses.week", &format.week);
        Ok((columns, wanted))
    }

    pub(super) fn has_attitude(&self) -> bool {
        self.attitude.is_some()
    }

    /// The pose of a row, whose numbers are finite; `None`, counted, where it has none that can be used.
    pub(super) fn pose(&mut self, row: TableRow, skipped: &mut Skipped) -> Option<LocalPose> {
        let numbers = row.numbers;
        let format = &self.format;
        let attitude = match self.attitude.map(|from| self.rotation(numbers, from)) {
            Some(Ok(attitude)) => attitude,
            Some(Err((kind, detail))) => {
                skipped.add(kind, row.line, detail);
                return None;
            }
            None => None,
        };
        let mut covariance = |place: Option<usize>, scale: f64| match place {
            Some(from) => diagonal(&(three(numbers, from) * scale), row.line, skipped).map(Some),
            None => Some(None),
        };
        let position_covariance = covariance(self.position_std, format.position_scale)?;
        let attitude_covariance = covariance(self.attitude_std, format.attitude_std_scale)?;
        let stamp = numbers.first().copied().unwrap_or(f64::NAN);
        let week = format.week.as_ref().and(numbers.last().copied());
        let weeks = self.weeks.since_first(week);
        Some(LocalPose {
            time: stamp * format.time_scale + weeks + format.time_offset,
            position: self
                .position
                .map(|from| three(numbers, from) * format.position_scale),
            attitude,
            position_covariance,
            attitude_covariance,
        })
    }

    /// The attitude whose numbers are from a place of the row on.
    fn rotation(&self, numbers: &[f64], from: usize) -> Result<Option<Quaternion>, Unfit> {
        let [first, second, third] = [0, 3, 6].map(|k| three(numbers, from + k));
        match &self.format.attitude {
            Some(AttitudeColumns::Quaternion { w_first, .. }) => match w_first {
                true => of_quaternion(first.x, [first.y, first.z, second.x]),
                false => of_quaternion(second.x, first.into()),
            },
            Some(AttitudeColumns::Euler { scale, .. }) => {
                Ok(Some(attitude::from_rpy(&(first * *scale))))
            }
            Some(AttitudeColumns::RotationVector { scale, .. }) => {
                Ok(Some(attitude::from_rotation_vector(&(first * *scale))))
            }
            Some(AttitudeColumns::Matrix(_)) => {
                let rows = [first, second, third].map(|row| row.transpose());
                of_matrix(&Matrix3::from_rows(&rows)).map(Some)
            }
            None => Ok(None),
        }
    }
}
