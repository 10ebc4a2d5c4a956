//! Poses of a marker, camera or body in a local Cartesian frame: motion capture, total stations, visual odometry, SLAM.
//!
//! The attitude is `q_wk`, which turns vectors of the marker's axes `k` into those of the local frame `w`, as TUM,
//! EuRoC and the messages of ROS write it. A row without one usable number in any of its columns, as trackers write
//! when they lose the marker, is skipped. A quaternion of four zeros is no attitude: the position is used without
//! one, unless it is zero, too.

mod columns;
mod layout;
mod motive;
mod qualisys;
mod vicon;

use std::sync::Arc;

use crate::ReadError;
pub use crate::entry::LocalPose;
use crate::entry::{Entry, Wanted, What};
use crate::epoch::Epoch;
use crate::format::Format;
use crate::opened::Memory;
use crate::reader::{Kind, Plan, Reader, Row, TableRow, Want};
use crate::rotation::of_quaternion;
use crate::skipped::{SkipKind, Skipped};

use columns::PoseColumns;
pub use columns::{AttitudeColumns, PoseFormat, QuaternionOrder};
pub use layout::detect;

/// Which poses of a log.
#[derive(Clone, Debug)]
pub struct PoseLog {
    /// Format of the file.
    pub format: Format,
    /// Its stream; `None` for the only one.
    pub stream: Option<String>,
    /// Factor from its positions to metres.
    pub position_scale: f64,
    /// Whether what it calls x, y, z, w of a quaternion is w, x, y, z.
    pub w_first: bool,
    /// Added to the times \[s\].
    pub time_offset: f64,
    /// First and last time \[s\] to give out, after the offset.
    pub span: Option<(f64, f64)>,
}

impl PoseLog {
    /// The only stream of a log, as it says itself what it holds.
    pub fn new(format: Format) -> Self {
        Self {
            format,
            stream: None,
            position_scale: 1.0,
            w_first: false,
            time_offset: 0.0,
            span: None,
        }
    }
}

/// Layout of a log of poses.
#[derive(Clone, Debug)]
pub enum PoseSource {
    /// Delimited text, Parquet or columns in memory.
    Table(Box<PoseFormat>),
    /// Log that says itself what it holds.
    Log(PoseLog),
    /// Poses in memory, [`Memory::Poses`].
    Poses {
        /// Added to their times \[s\].
        time_offset: f64,
        /// First and last time \[s\] to give out, after the offset.
        span: Option<(f64, f64)>,
    },
}

impl PoseSource {
    /// What is added to the file's times \[s\].
    pub fn time_offset(&mut self) -> &mut f64 {
        match self {
            Self::Table(format) => &mut format.time_offset,
            Self::Log(log) => &mut log.time_offset,
            Self::Poses { time_offset, .. } => time_offset,
        }
    }
}

impl From<PoseFormat> for PoseSource {
    fn from(format: PoseFormat) -> Self {
        Self::Table(Box::new(format))
    }
}

impl From<PoseLog> for PoseSource {
    fn from(log: PoseLog) -> Self {
        Self::Log(log)
    }
}

/// Reads poses.
pub type PoseReader = Reader<Poses>;

/// Poses as a kind of record.
pub struct Poses(Of);

/// Boxed: one holds its options, a few hundred bytes.
enum Of {
    Columns(Box<PoseColumns>),
    /// With what is added to their times \[s\], the factor of their positions and whether w is first.
    Log(f64, f64, bool),
    /// The same in memory.
    Records(f64),
}

impl Kind for Poses {
    type Options = PoseSource;
    type Values = LocalPose;
    type Record = LocalPose;
    const PATIENCE: u32 = 100;

    fn plan(options: &PoseSource) -> Result<Plan<Self>, ReadError> {
        Ok(match options {
            PoseSource::Table(format) => {
                let (columns, wanted) = PoseColumns::new(format)?;
                Plan {
                    kind: Self(Of::Columns(Box::new(columns))),
                    source: Want::Table(wanted),
                    span: format.span,
                }
            }
            PoseSource::Log(log) => Plan {
                kind: Self(Of::Log(log.time_offset, log.position_scale, log.w_first)),
                source: Want::Log(log.format, Wanted::LocalPoses(log.stream.clone())),
                span: log.span,
            },
            PoseSource::Poses { time_offset, span } => Plan {
                kind: Self(Of::Records(*time_offset)),
                source: Want::Records,
                span: *span,
            },
        })
    }

    fn of_row(&mut self, row: TableRow, skipped: &mut Skipped) -> Option<(f64, LocalPose)> {
        let Of::Columns(columns) = &mut self.0 else {
            return None;
        };
        let oriented = columns.has_attitude();
        usable(columns.pose(row, skipped)?, oriented, row.line, skipped)
    }

    fn of_entry(&mut self, entry: Entry, skipped: &mut Skipped) -> Option<(f64, LocalPose)> {
        let (What::LocalPose(mut pose), &Of::Log(time_offset, scale, w_first)) =
            (entry.what, &self.0)
        else {
            return None;
        };
        pose.time += time_offset;
        pose.position = pose.position.map(|position| position * scale);
        pose.position_covariance = pose
            .position_covariance
            .map(|covariance| covariance * (scale * scale));
        if let (true, Some(q)) = (w_first, &mut pose.attitude) {
            *q = of_quaternion(q.i, [q.j, q.k, q.w]).ok()??;
        }
        usable(pose, true, entry.at, skipped)
    }

    fn held(memory: &Memory) -> Option<Arc<[LocalPose]>> {
        match memory {
            Memory::Poses(poses) => Some(poses.clone()),
            _ => None,
        }
    }

    fn of_record(
        &mut self,
        pose: &LocalPose,
        number: u64,
        skipped: &mut Skipped,
    ) -> Option<(f64, LocalPose)> {
        let Of::Records(time_offset) = self.0 else {
            return None;
        };
        let pose = LocalPose {
            time: pose.time + time_offset,
            ..*pose
        };
        usable(pose, false, number, skipped)
    }

    fn record(
        &mut self,
        row: &Row<LocalPose>,
        _: &mut Skipped,
    ) -> Result<Option<LocalPose>, ReadError> {
        Ok(Some(row.values))
    }

    fn epoch(&self) -> Option<Epoch> {
        let Of::Columns(columns) = &self.0 else {
            return None;
        };
        columns.weeks.epoch()
    }

    fn nothing(&self, _: &Skipped) -> ReadError {
        ReadError::nameless("no usable pose")
    }
}

/// A pose of which something can be used, all of it finite; what cannot be is counted. `oriented` is whether the log is
/// to have attitudes.
fn usable(
    pose: LocalPose,
    oriented: bool,
    at: u64,
    skipped: &mut Skipped,
) -> Option<(f64, LocalPose)> {
    if !pose.is_finite() {
        skipped.add(SkipKind::NotFinite, at, "a value is not finite");
        return None;
    }
    let is_placed = pose.position.is_some();
    let at_zero = pose.position.is_none_or(|position| position.amax() == 0.0);
    let (usable, detail) = match pose.attitude {
        Some(_) => return Some((pose.time, pose)),
        None if oriented && at_zero => (false, "position and quaternion are 0"),
        None if oriented => (true, "quaternion 0, 0, 0, 0 beside a position"),
        None if is_placed => return Some((pose.time, pose)),
        None => (false, "neither position nor attitude"),
    };
    skipped.add(SkipKind::OutOfRange, at, detail);
    usable.then_some((pose.time, pose))
}

#[cfg(test)]
mod tests;
