//! GNSS fixes from tables of any layout, or from logs that say themselves what they hold.
//!
//! What cannot be used is skipped part by part: a row without a usable position can still give
//! its velocity. A latitude and longitude of exactly 0°, 0° is what receivers write without a
//! fix, so such a row is skipped as a whole.

mod columns;
mod log;
mod options;
mod poses;

use std::sync::Arc;

use undrift_nav::sample::{GnssFix, Position};

use crate::ReadError;
use crate::angle::are_degrees_minutes;
use crate::entry::{Entry, Wanted, What};
use crate::fix::on_earth;
pub use crate::fix::{VelocityAxes, quality_of_rtklib};
use crate::opened::Memory;
use crate::poses::Poses;
use crate::reader::{Kind, Plan, Reader, Row, TableRow, Want};
use crate::rinex::Rinex;
pub use crate::rinex::RinexFile;
use crate::skipped::{SkipEntry, SkipKind, Skipped};

use columns::FixColumns;
pub use columns::{GnssFormat, PositionColumns};
pub use log::GnssLog;
use log::LogFixes;
pub use options::FixOptions;
use poses::Placed;
pub use poses::PoseFixes;

/// Layout of a GNSS log.
#[derive(Clone, Debug)]
pub enum GnssSource {
    /// Delimited text, Parquet or columns in memory.
    Table(Box<GnssFormat>),
    /// Log that says itself what it holds.
    Log(GnssLog),
    /// Poses in a local frame.
    Poses(Box<PoseFixes>),
    /// Fixes in memory, [`Memory::Fixes`].
    Fixes {
        /// Added to their times \[s\].
        time_offset: f64,
        /// First and last time \[s\] to give out, after the offset.
        span: Option<(f64, f64)>,
    },
}

impl GnssSource {
    /// What is added to the file's times \[s\].
    pub fn time_offset(&mut self) -> &mut f64 {
        match self {
            Self::Table(format) => &mut format.fixes.time_offset,
            Self::Log(log) => &mut log.fixes.time_offset,
            Self::Poses(poses) => poses.source.time_offset(),
            Self::Fixes { time_offset, .. } => time_offset,
        }
    }
}

impl GnssSource {
    /// The RINEX files beside the log.
    pub fn beside(&self) -> &[RinexFile] {
        match self {
            Self::Table(format) => &format.fixes.observations,
            Self::Log(log) => &log.fixes.observations,
            Self::Poses(_) | Self::Fixes { .. } => &[],
        }
    }

    /// Leaves the RINEX files out, as of a log that is read while it comes.
    pub fn clear_beside(&mut self) {
        match self {
            Self::Table(format) => format.fixes.observations.clear(),
            Self::Log(log) => log.fixes.observations.clear(),
            Self::Poses(_) | Self::Fixes { .. } => {}
        }
    }
}

impl From<GnssFormat> for GnssSource {
    fn from(format: GnssFormat) -> Self {
        Self::Table(Box::new(format))
    }
}

impl From<GnssLog> for GnssSource {
    fn from(log: GnssLog) -> Self {
        Self::Log(log)
    }
}

/// Reads GNSS fixes.
pub type GnssReader = Reader<Fixes>;

/// Fixes as a kind of record.
pub struct Fixes {
    of: Of,
    rinex: Option<Box<Rinex>>,
    /// What is added to the file's times \[s\].
    time_offset: f64,
}

/// Boxed: one holds its options, a few hundred bytes.
enum Of {
    Columns(Box<FixColumns>),
    Log(Box<LogFixes>),
    Poses(Box<Placed>),
    /// In memory, with what is added to their times \[s\].
    Records(f64),
}

impl Fixes {
    fn alone(of: Of) -> Self {
        Self {
            of,
            rinex: None,
            time_offset: 0.0,
        }
    }

    /// With the observations beside the fixes.
    fn with(of: Of, options: &FixOptions) -> Result<Self, ReadError> {
        let rinex = match options.observations.as_slice() {
            [] => None,
            files => Some(Box::new(Rinex::open(files)?)),
        };
        Ok(Self {
            of,
            rinex,
            time_offset: options.time_offset,
        })
    }
}

impl Reader<Fixes> {
    /// Velocities skipped so far because neither the log nor its options tell how certain they are.
    pub fn untold_velocities(&self) -> u64 {
        match &self.kind().of {
            Of::Columns(_) | Of::Poses(_) | Of::Records(_) => 0,
            Of::Log(log) => log.untold_velocities,
        }
    }
}

impl Kind for Fixes {
    type Options = GnssSource;
    type Values = GnssFix;
    type Record = GnssFix;
    const PATIENCE: u32 = 20;

    fn plan(options: &GnssSource) -> Result<Plan<Self>, ReadError> {
        Ok(match options {
            GnssSource::Table(format) => {
                let (columns, wanted) = FixColumns::new(format)?;
                Plan {
                    kind: Self::with(Of::Columns(Box::new(columns)), &format.fixes)?,
                    source: Want::Table(wanted),
                    span: format.fixes.span,
                }
            }
            GnssSource::Log(log) => {
                log.fixes.check()?;
                let wanted = Wanted::Fixes {
                    position: log.position.clone(),
                    velocity: log.velocity.clone(),
                    base: log.base,
                    at_once: false,
                };
                Plan {
                    kind: Self::with(Of::Log(Box::new(LogFixes::new(log))), &log.fixes)?,
                    source: Want::Log(log.format, wanted),
                    span: log.fixes.span,
                }
            }
            GnssSource::Poses(fixes) => {
                let Plan { kind, source, span } = Poses::plan(&fixes.source)?;
                let kind = Self::alone(Of::Poses(Box::new(Placed::new(kind, fixes))));
                Plan { kind, source, span }
            }
            GnssSource::Fixes { time_offset, span } => Plan {
                kind: Self::alone(Of::Records(*time_offset)),
                source: Want::Records,
                span: *span,
            },
        })
    }

    fn of_row(&mut self, row: TableRow, skipped: &mut Skipped) -> Option<(f64, GnssFix)> {
        match &mut self.of {
            Of::Columns(columns) => usable(columns.fix(row, skipped)?),
            Of::Poses(placed) => {
                let pose = placed.poses.of_row(row, skipped)?;
                placed.fix(pose)
            }
            Of::Log(_) | Of::Records(_) => None,
        }
    }

    fn of_entry(&mut self, entry: Entry, skipped: &mut Skipped) -> Option<(f64, GnssFix)> {
        match (&mut self.of, &entry.what) {
            (Of::Log(log), What::Fix(fix)) => usable(log.fix(entry.at, fix, skipped)),
            (Of::Poses(placed), _) => {
                let pose = placed.poses.of_entry(entry, skipped)?;
                placed.fix(pose)
            }
            _ => None,
        }
    }

    fn held(memory: &Memory) -> Option<Arc<[GnssFix]>> {
        match memory {
            Memory::Fixes(fixes) => Some(fixes.clone()),
            _ => None,
        }
    }

    fn of_record(
        &mut self,
        fix: &GnssFix,
        number: u64,
        skipped: &mut Skipped,
    ) -> Option<(f64, GnssFix)> {
        let Of::Records(time_offset) = self.of else {
            return None;
        };
        if !fix.is_finite() {
            skipped.add(SkipKind::NotFinite, number, "a value is not finite");
            return None;
        }
        let mut fix = GnssFix {
            time: fix.time + time_offset,
            ..*fix
        };
        if let Some((Position::Geodetic(place), _)) = fix.position
            && let Err((kind, detail)) = on_earth(place)
        {
            skipped.add(kind, number, detail);
            fix.position = None;
        }
        usable(fix)
    }

    fn record(
        &mut self,
        row: &Row<GnssFix>,
        _: &mut Skipped,
    ) -> Result<Option<GnssFix>, ReadError> {
        let mut fix = row.values;
        if let Some(rinex) = &mut self.rinex {
            rinex.add(&mut fix, row.time - self.time_offset)?;
        }
        Ok(Some(fix))
    }

    fn epoch(&self) -> Option<crate::epoch::Epoch> {
        match &self.of {
            Of::Poses(placed) => placed.poses.epoch(),
            _ => None,
        }
    }

    fn end(&self) -> Result<(), ReadError> {
        if let Some(rinex) = &self.rinex {
            rinex.end()?;
        }
        match &self.of {
            Of::Columns(_) | Of::Poses(_) | Of::Records(_) => Ok(()),
            Of::Log(log) => log.end(),
        }
    }

    fn nothing(&self, skipped: &Skipped) -> ReadError {
        if let Of::Poses(placed) = &self.of {
            return placed.poses.nothing(skipped);
        }
        let of_columns = matches!(self.of, Of::Columns(_));
        let mut entries = skipped.iter();
        let first = entries.find(|(kind, _)| *kind == SkipKind::OutOfRange && of_columns);
        let cause = first.and_then(|(_, entry)| cause(entry));
        let error = ReadError::nameless("no usable fix");
        match (cause, first) {
            (Some(cause), _) => cause,
            (None, Some(_)) => {
                let mend = format!("{}; {POSITIONS}", skipped.in_one_line());
                error.key("gnss.position").mend(mend)
            }
            (None, None) => error,
        }
    }
}

const POSITIONS: &str = "check that the columns are latitude, longitude, height in gnss.position_unit, not ECEF or degrees and minutes";

/// What explains positions that are out of range, by the first of them as it was counted: three numbers.
fn cause(out: &SkipEntry) -> Option<ReadError> {
    let numbers = out.first_detail.split(", ").map(str::parse);
    let numbers = numbers.collect::<Result<Vec<f64>, _>>().ok()?;
    let [a, b, _] = *numbers.as_slice() else {
        return None;
    };
    let at = format!("(line {}: {a:.2}, {b:.2})", out.first_line);
    let (problem, mend) = if a == 0.0 && b == 0.0 {
        let rows = match out.count {
            1 => String::new(),
            count => format!("{count} rows such as "),
        };
        let problem = format!(
            "the receiver never had a fix ({rows}line {}: 0, 0)",
            out.first_line
        );
        (problem, "record again with a clear view of the sky")
    } else if (90.0..=180.0).contains(&a.abs()) && b.abs() < 90.0 {
        let problem = format!("latitude and longitude are exchanged {at}");
        (problem, "list the latitude first in gnss.position")
    } else if are_degrees_minutes(a, b) {
        let problem = format!("latitude and longitude are degrees and minutes, ddmm.mmmm {at}");
        (problem, "set gnss.position_unit = \"ddmm.mmmm\"")
    } else if a.abs() <= 90e6 && b.abs() <= 180e6 && a.abs().max(b.abs()) > 1e7 {
        let problem = format!("latitude and longitude are in 1e-6 or 1e-7 deg {at}");
        let mend = "set gnss.position_unit = \"LSB/1e6 deg\" or \"LSB/1e7 deg\"";
        (problem, mend)
    } else if a.abs().max(b.abs()) > 1e8 {
        let problem = format!("latitude and longitude are in 1e-7 deg {at}");
        let mend = "set gnss.position_unit = \"LSB/1e7 deg\"";
        (problem, mend)
    } else {
        return None;
    };
    Some(ReadError::nameless(problem).mend(mend))
}

/// A fix of which something can be used.
fn usable(fix: GnssFix) -> Option<(f64, GnssFix)> {
    let something = fix.position.is_some() || fix.velocity.is_some() || fix.mean_velocity.is_some();
    something.then_some((fix.time, fix))
}

#[cfg(test)]
mod tests;
