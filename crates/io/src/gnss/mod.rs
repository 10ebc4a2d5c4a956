//! GNSS fixes from CSV of any layout, from RTKLIB solution files, or from logs that say themselves what they hold.
//!
//! What cannot be used is left out by its part: a row without a usable position can still give
//! its velocity. A latitude and longitude of exactly 0°, 0° is what receivers write without a
//! fix, so such a row is left out as a whole.

mod csv;
mod log;
mod options;

use std::path::Path;

use undrift_nav::sample::{FixQuality, GnssFix};
use undrift_nav::{Matrix3, Vector3};

use crate::ReadError;
use crate::clock::{self, Clock, Tick};
use crate::rtklib::{RtklibOptions, RtklibRows};
use crate::skipped::{SkipKind, Skipped};
use crate::source;
use crate::table::TableSource;

use csv::CsvRows;
pub(crate) use csv::is_a_fix;
pub use csv::{GnssFormat, Place, PositionFormat, Std, VelocityFormat};
pub use log::GnssLog;
use log::LogRows;
pub use options::FixOptions;

/// Fixes in a row that must be earlier than the last accepted one to count as a clock set back.
const PATIENCE: u32 = 20;

/// Reads GNSS fixes one by one; after an error or the end it gives `None`.
pub struct GnssReader {
    rows: Rows,
    clock: Clock,
    span: Option<(f64, f64)>,
    covered: Option<(f64, f64)>,
    given: u64,
    finished: bool,
}

/// Boxed: one reader holds its row and options, a few hundred bytes.
enum Rows {
    Csv(Box<CsvRows>),
    Rtklib(Box<RtklibRows>),
    Log(Box<LogRows>),
}

impl GnssReader {
    /// Opens delimited text, plain or gzip.
    ///
    /// # Errors
    /// If the file cannot be opened, a column is missing, or the format asks for neither position
    /// nor velocity or has unusable constants.
    pub fn open_csv(path: &Path, format: &GnssFormat) -> Result<Self, ReadError> {
        Self::from_source(path, source::open(path)?, format)
    }

    /// Reads fixes from any stream of delimited text or from columns in memory; `path` is what messages
    /// call it.
    ///
    /// # Errors
    /// As [`GnssReader::open_csv`], of the columns and the format.
    pub fn from_source(
        path: &Path,
        source: impl Into<TableSource>,
        format: &GnssFormat,
    ) -> Result<Self, ReadError> {
        let rows = CsvRows::new(path, source, format)?;
        Ok(Self::new(path, Rows::Csv(Box::new(rows)), format.span))
    }

    /// Opens an RTKLIB solution file, plain or gzip.
    ///
    /// # Errors
    /// If the file cannot be opened, no header line names its columns, or it has baselines and
    /// the options no base.
    pub fn open_rtklib(path: &Path, options: &RtklibOptions) -> Result<Self, ReadError> {
        let rows = RtklibRows::new(path, source::open(path)?, options)?;
        Ok(Self::new(
            path,
            Rows::Rtklib(Box::new(rows)),
            options.fixes.span,
        ))
    }

    /// Opens a log, plain or gzip.
    ///
    /// # Errors
    /// If the file cannot be opened, is no log of its format, or lacks a stream.
    pub fn open_log(path: &Path, options: &GnssLog) -> Result<Self, ReadError> {
        let rows = LogRows::new(path, options)?;
        Ok(Self::new(
            path,
            Rows::Log(Box::new(rows)),
            options.fixes.span,
        ))
    }

    fn new(path: &Path, rows: Rows, span: Option<(f64, f64)>) -> Self {
        Self {
            rows,
            clock: Clock::new(path, PATIENCE),
            span,
            covered: None,
            given: 0,
            finished: false,
        }
    }

    /// What was left out so far.
    pub fn skipped(&self) -> &Skipped {
        match &self.rows {
            Rows::Csv(rows) => rows.skipped(),
            Rows::Rtklib(rows) => rows.skipped(),
            Rows::Log(rows) => rows.skipped(),
        }
    }

    /// Velocities left out so far because neither the log nor its options tell how certain they are.
    pub fn untold_velocities(&self) -> u64 {
        match &self.rows {
            Rows::Csv(_) | Rows::Rtklib(_) => 0,
            Rows::Log(rows) => rows.untold_velocities,
        }
    }

    fn path(&self) -> &Path {
        match &self.rows {
            Rows::Csv(rows) => rows.path(),
            Rows::Rtklib(rows) => rows.path(),
            Rows::Log(rows) => rows.path(),
        }
    }

    fn next_fix(&mut self) -> Result<Option<GnssFix>, ReadError> {
        loop {
            let (row, skipped) = match &mut self.rows {
                Rows::Csv(rows) => (rows.next_row()?, rows.skipped_mut()),
                Rows::Rtklib(rows) => (rows.next_row()?, rows.skipped_mut()),
                Rows::Log(rows) => (rows.next_row()?, rows.skipped_mut()),
            };
            let Some((line, fix)) = row else { break };
            if let Tick::Skip = self.clock.tick(fix.time, line, skipped)? {
                continue;
            }
            let start = self.covered.map_or(fix.time, |(start, _)| start);
            self.covered = Some((start, fix.time));
            if clock::past(self.span, fix.time) {
                break;
            }
            if clock::within(self.span, fix.time) {
                self.given += 1;
                return Ok(Some(fix));
            }
        }
        if self.given > 0 {
            return Ok(None);
        }
        match (self.span, self.covered) {
            (Some(span), Some(_)) => Err(clock::none_in_span(self.path(), span, self.covered)),
            _ => {
                let skipped = self.skipped();
                let mut mend = skipped.to_string().replace('\n', "; ");
                let error = ReadError::new(self.path(), "no usable fix");
                if skipped.count(SkipKind::OutOfRange) > 0 && matches!(self.rows, Rows::Csv(_)) {
                    mend += "; are the columns latitude, longitude, height in this order and in gnss.position_unit, neither ECEF nor degrees and minutes?";
                    return Err(error.key("gnss.position").mend(mend));
                }
                Err(error.mend(mend))
            }
        }
    }
}

impl Iterator for GnssReader {
    type Item = Result<GnssFix, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.finished {
            return None;
        }
        let item = self.next_fix().transpose();
        self.finished = !matches!(item, Some(Ok(_)));
        item
    }
}

/// What RTKLIB's solution status Q means: 1 fixed, 2 float, 3 SBAS, 4 differential, 5 single,
/// 6 precise point positioning; anything else is unknown.
pub fn quality_of_rtklib(q: f64) -> FixQuality {
    // The comparison is of codes that some writers print with decimals.
    match q.round() {
        1.0 => FixQuality::Fixed,
        2.0 => FixQuality::Float,
        3.0 | 4.0 | 6.0 => FixQuality::Differential,
        5.0 => FixQuality::Single,
        _ => FixQuality::Unknown,
    }
}

/// The covariance of independent components, or `None` where a standard deviation is unusable.
pub(crate) fn independent(std: &Vector3) -> Option<Matrix3> {
    let usable = |s: &f64| s.is_finite() && *s > 0.0 && (s * s).is_normal();
    let usable = std.iter().all(usable);
    usable.then(|| Matrix3::from_diagonal(&std.component_mul(std)))
}

/// The same, counted where it is `None`.
pub(crate) fn diagonal(std: &Vector3, line: u64, skipped: &mut Skipped) -> Option<Matrix3> {
    let covariance = independent(std);
    if covariance.is_none() {
        let detail = format_args!("{}, {}, {}", std.x, std.y, std.z);
        skipped.add(SkipKind::Uncertainty, line, detail);
    }
    covariance
}

/// Whether three numbers of a position or velocity are finite; counted where not.
pub(crate) fn all_finite(values: &Vector3, line: u64, skipped: &mut Skipped) -> bool {
    let finite = values.iter().all(|value| value.is_finite());
    if !finite {
        let detail = format_args!("{}, {}, {}", values.x, values.y, values.z);
        skipped.add(SkipKind::NotFinite, line, detail);
    }
    finite
}

#[cfg(test)]
mod tests;
