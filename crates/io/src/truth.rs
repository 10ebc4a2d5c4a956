//! Reference trajectories from delimited text, or from logs that say themselves what they hold.

use std::path::Path;

use undrift_nav::Vector3;
use undrift_nav::earth::Geodetic;
use undrift_nav::sample::TruthSample;

use crate::ReadError;
use crate::clock::{self, Clock, Tick};
use crate::format::Format;
use crate::gnss::is_a_fix;
use crate::log::{Log, Wanted, What};
use crate::skipped::{SkipKind, Skipped};
use crate::source;
use crate::table::{Column, Table, TableOptions, TableSource};

/// Samples in a row that must be earlier than the last accepted one to count as a clock set back.
const PATIENCE: u32 = 100;

/// Where the columns of a reference trajectory are and what they mean.
#[derive(Clone, Debug)]
pub struct TruthFormat {
    /// Time column.
    pub time: Column,
    /// Factor from the time column to seconds.
    pub time_scale: f64,
    /// Added to the time after scaling \[s\].
    pub time_offset: f64,
    /// GPS week, where the time is the second of it: times count on from the week of the first row.
    pub week: Option<Column>,
    /// Latitude, longitude, and height above the ellipsoid \[m\].
    pub position: [Column; 3],
    /// Factor from the columns of latitude and longitude to radians.
    pub angle_scale: f64,
    /// Velocity north, east, down [m/s].
    pub velocity: Option<[Column; 3]>,
    /// The third component of the velocity is up.
    pub velocity_up: bool,
    /// Roll, pitch, yaw.
    pub attitude: Option<[Column; 3]>,
    /// Factor from the columns of the attitude to radians.
    pub attitude_scale: f64,
    /// The byte between fields; `None` finds out.
    pub delimiter: Option<u8>,
    /// First and last time \[s\] to give out, after the offset.
    pub span: Option<(f64, f64)>,
}

impl TruthFormat {
    /// Time in seconds, angles in degrees, position only.
    pub fn degrees(time: Column, position: [Column; 3]) -> Self {
        let radians = 1f64.to_radians();
        Self {
            time,
            time_scale: 1.0,
            time_offset: 0.0,
            week: None,
            position,
            angle_scale: radians,
            velocity: None,
            velocity_up: false,
            attitude: None,
            attitude_scale: radians,
            delimiter: None,
            span: None,
        }
    }
}

/// Which reference solution of a log.
#[derive(Clone, Debug)]
pub struct TruthLog {
    /// Format of the file.
    pub format: Format,
    /// Its stream; `None` for the only one.
    pub stream: Option<String>,
    /// Added to the times \[s\].
    pub time_offset: f64,
    /// First and last time \[s\] to give out, after the offset.
    pub span: Option<(f64, f64)>,
}

/// Reads reference samples one by one; after an error or the end it gives `None`.
pub struct TruthReader {
    rows: Rows,
    span: Option<(f64, f64)>,
    clock: Clock,
    covered: Option<(f64, f64)>,
    given: u64,
    finished: bool,
}

enum Rows {
    Table(Box<TableRows>),
    Log(Log, f64),
}

struct TableRows {
    table: Table,
    format: TruthFormat,
    /// Time, position, then velocity, attitude and week where asked for.
    row: Vec<f64>,
    /// Of the first row.
    week: Option<f64>,
}

impl Rows {
    fn path(&self) -> &Path {
        match self {
            Self::Table(rows) => rows.table.path(),
            Self::Log(log, _) => log.path(),
        }
    }

    fn skipped(&self) -> &Skipped {
        match self {
            Self::Table(rows) => rows.table.skipped(),
            Self::Log(log, _) => log.skipped(),
        }
    }

    fn skipped_mut(&mut self) -> &mut Skipped {
        match self {
            Self::Table(rows) => rows.table.skipped_mut(),
            Self::Log(log, _) => log.skipped_mut(),
        }
    }

    fn next(&mut self) -> Result<Option<(u64, TruthSample)>, ReadError> {
        match self {
            Self::Table(rows) => {
                let line = rows.table.next_row(&mut rows.row)?;
                Ok(line.map(|line| (line, rows.sample())))
            }
            Self::Log(log, offset) => {
                while let Some(entry) = log.next()? {
                    if let What::Pose(mut pose) = entry.what {
                        pose.time += *offset;
                        return Ok(Some((entry.at, pose)));
                    }
                }
                Ok(None)
            }
        }
    }
}

impl TruthReader {
    /// Opens a log, plain or gzip.
    ///
    /// # Errors
    /// If the file cannot be opened, is no log of its format, or lacks the stream.
    pub fn open_log(path: &Path, log: &TruthLog) -> Result<Self, ReadError> {
        let wanted = Wanted::Poses(log.stream.clone());
        let rows = Rows::Log(Log::open(path, log.format, &wanted)?, log.time_offset);
        Ok(Self::new(path, rows, log.span))
    }

    /// Opens a reference trajectory, plain or gzip.
    ///
    /// # Errors
    /// If the file cannot be opened, a column is missing or the time scale is not positive.
    pub fn open(path: &Path, format: &TruthFormat) -> Result<Self, ReadError> {
        Self::from_source(path, source::open(path)?, format)
    }

    /// Reads a reference trajectory from any stream or from columns in memory; `path` is what messages
    /// call it.
    ///
    /// # Errors
    /// If a column is missing or the time scale is not positive.
    pub fn from_source(
        path: &Path,
        source: impl Into<TableSource>,
        format: &TruthFormat,
    ) -> Result<Self, ReadError> {
        if !(format.time_scale.is_finite() && format.time_scale > 0.0) {
            let problem = format!("a time scale of {} makes no times", format.time_scale);
            return Err(ReadError::new(path, problem).key("truth.time"));
        }
        let mut columns = vec![("truth.time".to_owned(), format.time.clone())];
        let groups = [
            ("truth.position", Some(&format.position)),
            ("truth.velocity", format.velocity.as_ref()),
            ("truth.attitude", format.attitude.as_ref()),
        ];
        for (key, group) in groups {
            for column in group.into_iter().flatten() {
                columns.push((key.to_owned(), column.clone()));
            }
        }
        if let Some(week) = &format.week {
            columns.push(("truth.week".to_owned(), week.clone()));
        }
        let options = TableOptions {
            columns,
            delimiter: format.delimiter,
            keep_not_finite: false,
        };
        let rows = Rows::Table(Box::new(TableRows {
            row: vec![0.0; options.columns.len()],
            table: Table::from_source(path, source, &options)?,
            format: format.clone(),
            week: None,
        }));
        Ok(Self::new(path, rows, format.span))
    }

    fn new(path: &Path, rows: Rows, span: Option<(f64, f64)>) -> Self {
        Self {
            rows,
            span,
            clock: Clock::new(path, PATIENCE),
            covered: None,
            given: 0,
            finished: false,
        }
    }

    /// What was left out so far.
    pub fn skipped(&self) -> &Skipped {
        self.rows.skipped()
    }

    fn next_sample(&mut self) -> Result<Option<TruthSample>, ReadError> {
        while let Some((line, sample)) = self.rows.next()? {
            let skipped = self.rows.skipped_mut();
            if !is_a_fix(&sample.position) {
                let place = sample.position;
                let (lat_deg, lon_deg) = (place.lat.to_degrees(), place.lon.to_degrees());
                let detail = format_args!("{lat_deg}°, {lon_deg}°, {} m", place.height);
                skipped.add(SkipKind::OutOfRange, line, detail);
                continue;
            }
            if let Tick::Skip = self.clock.tick(sample.time, line, skipped)? {
                continue;
            }
            let start = self.covered.map_or(sample.time, |(start, _)| start);
            self.covered = Some((start, sample.time));
            if clock::past(self.span, sample.time) {
                break;
            }
            if clock::within(self.span, sample.time) {
                self.given += 1;
                return Ok(Some(sample));
            }
        }
        if self.given > 0 {
            return Ok(None);
        }
        match (self.span, self.covered) {
            (Some(span), Some(_)) => Err(clock::none_in_span(self.rows.path(), span, self.covered)),
            _ => Err(ReadError::new(self.rows.path(), "no usable sample")
                .mend(self.skipped().to_string().replace('\n', "; "))),
        }
    }
}

impl TableRows {
    fn sample(&mut self) -> TruthSample {
        let week = self.format.week.as_ref().and(self.row.last().copied());
        let first = *self.week.get_or_insert(week.unwrap_or(0.0));
        let weeks = 604_800.0 * (week.unwrap_or(first) - first);
        let format = &self.format;
        let three = |from: usize| {
            let get = |k: usize| self.row.get(from + k).copied().unwrap_or(f64::NAN);
            Vector3::new(get(0), get(1), get(2))
        };
        let position = three(1);
        let v_n = format.velocity.as_ref().map(|_| {
            let v = three(4);
            Vector3::new(v.x, v.y, if format.velocity_up { -v.z } else { v.z })
        });
        let attitude_at = if v_n.is_some() { 7 } else { 4 };
        TruthSample {
            time: three(0).x * format.time_scale + weeks + format.time_offset,
            position: Geodetic {
                lat: position.x * format.angle_scale,
                lon: position.y * format.angle_scale,
                height: position.z,
            },
            v_n,
            rpy: format
                .attitude
                .as_ref()
                .map(|_| three(attitude_at) * format.attitude_scale),
        }
    }
}

impl Iterator for TruthReader {
    type Item = Result<TruthSample, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.finished {
            return None;
        }
        let item = self.next_sample().transpose();
        self.finished = !matches!(item, Some(Ok(_)));
        item
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn group(from: usize) -> [Column; 3] {
        [0, 1, 2].map(|k| Column::Number(from + k))
    }

    fn all(text: &str, format: &TruthFormat) -> (Vec<TruthSample>, Skipped) {
        let source = Box::new(Cursor::new(text.as_bytes().to_vec()));
        let mut reader = TruthReader::from_source(Path::new("truth.csv"), source, format).unwrap();
        let samples = reader.by_ref().map(Result::unwrap).collect();
        (samples, reader.skipped().clone())
    }

    #[test]
    fn optional_groups_and_units() {
        let position_only = TruthFormat::degrees(Column::Number(1), group(2));
        let text = "1,45,90,7,1,2,3,10,20,180\n2,0,0,0,1,2,3,0,0,0\n2,46,90,7,1,2,3,10,20,180\n";
        let (samples, skipped) = all(text, &position_only);
        assert_eq!((samples.len(), skipped.count(SkipKind::OutOfRange)), (2, 1));
        assert_eq!(samples[0].position, Geodetic::from_degrees(45.0, 90.0, 7.0));
        assert_eq!((samples[0].v_n, samples[0].rpy), (None, None));
        let full = TruthFormat {
            velocity: Some(group(5)),
            velocity_up: true,
            attitude: Some(group(8)),
            time_offset: 10.0,
            ..position_only.clone()
        };
        let (samples, _) = all(text, &full);
        assert_eq!(samples[1].time, 12.0);
        assert_eq!(samples[1].v_n, Some(Vector3::new(1.0, 2.0, -3.0)));
        let rpy = samples[1].rpy.unwrap();
        // One rounding of the factor π/180 and one of the product.
        assert!((rpy.z - std::f64::consts::PI).abs() < 1e-15 * 4.0);
        let attitude_only = TruthFormat {
            attitude: Some(group(8)),
            ..position_only
        };
        assert_eq!(all(text, &attitude_only).0[1].rpy, Some(rpy));
    }
}
