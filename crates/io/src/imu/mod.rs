//! Inertial samples from a table of rates or increments, or from a log that says itself what it holds.
//!
//! A sample stamped t covers the interval since the sample before, (t_prev, t]. A rate is taken
//! as the mean over that interval, so the increment is rate · dt. After a gap the interval is the
//! real difference of the stamps; whoever integrates decides how to bridge it.
//!
//! A row of increments holds what its own nominal interval collected, also after a gap. There, where
//! dt is beyond 1.5 nominal intervals, the increments are scaled by dt / nominal: then increment / dt
//! is the mean rate, as it is for a log of rates. The nominal interval is 1 / `rate_hz`, else the
//! running median of the intervals. Where the increments of one row after another would have to be
//! scaled, the rate is another than was thought, and the file is refused.

mod format;
mod rows;

pub use format::{ImuFormat, ImuSource};

use std::path::Path;

use undrift_nav::Vector3;
use undrift_nav::sample::ImuSample;

use crate::ReadError;
use crate::clock::{self, Clock, Tick};
use crate::gaps::{GAP_INTERVALS, GapWatch};
pub use crate::gaps::{Gap, GapSummary};
use crate::held::{Held, HeldWatch};
use crate::log::{Log, Wanted};
use crate::skipped::{SkipKind, Skipped};
use crate::source::{self, BytesRead};
use crate::table::{Table, TableOptions, TableSource};
use rows::Rows;

/// Samples in a row that must be earlier than the last accepted one to count as a clock set back.
const PATIENCE: u32 = 100;

/// Values beyond this are none of a sensor, in SI, rates or increments: they would overflow on the way.
const MAX_VALUE: f64 = 1e9;

/// Gaps in a row that mean another sampling rate, in a log of increments.
const GAPS_IN_A_ROW: u32 = 100;

/// Reads inertial samples one by one; after an error or the end it gives `None`.
pub struct ImuReader {
    rows: Rows,
    format: ImuFormat,
    clock: Clock,
    gaps: GapWatch,
    held_values: HeldWatch,
    /// The second sample, read for the interval of the first.
    held: Option<Raw>,
    /// First and last time of the file up to here \[s\].
    covered: Option<(f64, f64)>,
    given: u64,
    gaps_in_a_row: u32,
    finished: bool,
}

/// A row in order of time, its values as in the file.
#[derive(Clone, Copy)]
struct Raw {
    time: f64,
    /// Since the sample before; `None` for the first of the file.
    dt: Option<f64>,
    line: u64,
    gyro: Vector3,
    accel: Vector3,
}

impl ImuReader {
    /// Opens an inertial log, plain or gzip.
    ///
    /// # Errors
    /// If the file cannot be opened, a column or a stream is missing, or the format has neither a
    /// time column nor a rate.
    pub fn open(path: &Path, format: &ImuFormat) -> Result<Self, ReadError> {
        Self::open_counted(path, format, &BytesRead::default())
    }

    /// As [`ImuReader::open`]; `read` counts the bytes of the file from 0.
    ///
    /// # Errors
    /// As [`ImuReader::open`].
    pub fn open_counted(
        path: &Path,
        format: &ImuFormat,
        read: &BytesRead,
    ) -> Result<Self, ReadError> {
        format.check(path)?;
        let source = source::open_counted(path, read)?;
        let rows = match &format.source {
            ImuSource::Table { .. } => return Self::from_source(path, source, format),
            ImuSource::Log(kind, stream) => {
                let wanted = Wanted::Imu(stream.clone());
                Rows::Log(Log::from_source(path, source, *kind, &wanted)?)
            }
        };
        Ok(Self::new(path, rows, format))
    }

    /// Reads an inertial log from any stream of delimited text or from columns in memory; `path` is what
    /// messages call it.
    ///
    /// # Errors
    /// If a column is missing, the format has neither a time column nor a rate, or is no table's.
    pub fn from_source(
        path: &Path,
        source: impl Into<TableSource>,
        format: &ImuFormat,
    ) -> Result<Self, ReadError> {
        format.check(path)?;
        let ImuSource::Table {
            time,
            gyro,
            accel,
            delimiter,
        } = &format.source
        else {
            return Err(ReadError::new(path, "only tables are read from a stream"));
        };
        let mut columns = Vec::with_capacity(7);
        if let Some(time) = time {
            columns.push(("imu.time".to_owned(), time.clone()));
        }
        for column in gyro {
            columns.push(("imu.gyro".to_owned(), column.clone()));
        }
        for column in accel {
            columns.push(("imu.accel".to_owned(), column.clone()));
        }
        let options = TableOptions {
            columns,
            delimiter: *delimiter,
            keep_not_finite: false,
        };
        let rows = Rows::Table {
            table: Box::new(Table::from_source(path, source, &options)?),
            row: [0.0; 7],
        };
        Ok(Self::new(path, rows, format))
    }

    fn new(path: &Path, rows: Rows, format: &ImuFormat) -> Self {
        Self {
            rows,
            format: format.clone(),
            clock: Clock::new(path, PATIENCE),
            gaps: GapWatch::default(),
            held_values: HeldWatch::default(),
            held: None,
            covered: None,
            given: 0,
            gaps_in_a_row: 0,
            finished: false,
        }
    }

    /// What was left out so far.
    pub fn skipped(&self) -> &Skipped {
        self.rows.skipped()
    }

    /// The usual interval and the gaps of the samples given out so far.
    pub fn gaps(&self) -> GapSummary {
        self.gaps.summary()
    }

    /// The axes that held a value for long among the samples given out so far.
    pub fn held(&self) -> Vec<Held> {
        self.held_values.held()
    }

    /// The next row whose time goes forward.
    fn next_raw(&mut self) -> Result<Option<Raw>, ReadError> {
        let has_times = self.format.has_times();
        loop {
            let Some((line, stamp, gyro, accel)) = self.rows.next(has_times)? else {
                return Ok(None);
            };
            let largest =
                (gyro.amax() * self.format.gyro_scale).max(accel.amax() * self.format.accel_scale);
            if largest > MAX_VALUE {
                let skipped = self.rows.skipped_mut();
                skipped.add(SkipKind::OutOfRange, line, largest);
                continue;
            }
            let time = match self.format.rate_hz {
                Some(rate) if !has_times => stamp / rate,
                _ => stamp * self.format.time_scale,
            } + self.format.time_offset;
            if let Tick::Forward(dt) = self.clock.tick(time, line, self.rows.skipped_mut())? {
                return Ok(Some(Raw {
                    time,
                    dt,
                    line,
                    gyro,
                    accel,
                }));
            }
        }
    }

    /// The next row with its interval \[s\].
    fn next_with_interval(&mut self) -> Result<Option<(Raw, f64)>, ReadError> {
        let raw = match self.held.take() {
            Some(held) => held,
            None => match self.next_raw()? {
                Some(raw) => raw,
                None => return Ok(None),
            },
        };
        if let Some(dt) = raw.dt {
            return Ok(Some((raw, dt)));
        }
        if let Some(rate) = self.format.rate_hz {
            return Ok(Some((raw, 1.0 / rate)));
        }
        self.held = self.next_raw()?;
        match self.held.as_ref().and_then(|second| second.dt) {
            Some(dt) => Ok(Some((raw, dt))),
            None => Err(ReadError::new(
                self.rows.path(),
                "only one sample, so its interval is unknown",
            )
            .at(raw.line)
            .key("imu.rate")
            .mend("give the rate")),
        }
    }

    /// The next sample inside the span.
    fn next_sample(&mut self) -> Result<Option<ImuSample>, ReadError> {
        let span = self.format.span;
        while let Some((raw, dt)) = self.next_with_interval()? {
            let start = self.covered.map_or(raw.time, |(start, _)| start);
            self.covered = Some((start, raw.time));
            if clock::past(span, raw.time) {
                break;
            }
            if !clock::within(span, raw.time) {
                continue;
            }
            let covered = self.covered_by_increments(&raw, dt)?;
            // The first interval given out is either made up or reaches back before the span.
            if self.given > 0 {
                self.gaps.add(Gap {
                    start: raw.time - dt,
                    length: dt,
                    line: raw.line,
                });
            }
            let sample = self.sample(&raw, dt, covered);
            // Increments that were collected in next to no time cannot be scaled to a gap.
            let values = sample.dtheta.iter().chain(&sample.dvel);
            if values.copied().any(|value| !value.is_finite()) {
                let skipped = self.rows.skipped_mut();
                skipped.add(SkipKind::OutOfRange, raw.line, format_args!("{dt} s"));
                continue;
            }
            self.given += 1;
            let [gx, gy, gz] = raw.gyro.into();
            let [ax, ay, az] = raw.accel.into();
            self.held_values.add(raw.time, [gx, gy, gz, ax, ay, az]);
            return Ok(Some(sample));
        }
        match (span, self.covered) {
            (Some(span), _) if self.given == 0 => {
                Err(clock::none_in_span(self.rows.path(), span, self.covered))
            }
            (None, _) if self.given == 0 => Err(ReadError::new(
                self.rows.path(),
                "no usable inertial sample",
            )
            .mend(self.rows.skipped().to_string().replace('\n', "; "))),
            _ => Ok(None),
        }
    }

    /// The part of the interval `dt` \[s\] that the increments of a row were collected in \[s\]: the
    /// nominal interval after a gap, else all of it.
    ///
    /// # Errors
    /// After [`GAPS_IN_A_ROW`] of them.
    fn covered_by_increments(&mut self, raw: &Raw, dt: f64) -> Result<f64, ReadError> {
        if !self.format.increments {
            return Ok(dt);
        }
        let stated = self.format.rate_hz.map(|rate| 1.0 / rate);
        let Some(nominal) = stated.or_else(|| self.gaps.nominal()) else {
            return Ok(dt);
        };
        if dt <= GAP_INTERVALS * nominal {
            self.gaps_in_a_row = 0;
            return Ok(dt);
        }
        self.gaps_in_a_row += 1;
        if self.gaps_in_a_row < GAPS_IN_A_ROW {
            return Ok(nominal);
        }
        let problem = format!(
            "increments {dt:.4} s apart, {GAPS_IN_A_ROW} in a row, where the rate is {:.2} Hz: what they cover is unknown",
            1.0 / nominal
        );
        Err(ReadError::new(self.rows.path(), problem)
            .at(raw.line)
            .key("imu.rate")
            .mend("correct the rate, or split the file where the rate changes"))
    }

    /// The sample of a row whose increments, if it has increments, were collected in `covered` \[s\].
    fn sample(&self, raw: &Raw, dt: f64, covered: f64) -> ImuSample {
        let format = &self.format;
        let length = if format.increments { dt / covered } else { dt };
        let body = |value: &Vector3, scale: f64, offset: &Vector3| {
            format.rotation * value * (scale * length) - offset * dt
        };
        ImuSample {
            time: raw.time,
            dt,
            dtheta: body(&raw.gyro, format.gyro_scale, &format.gyro_offset),
            dvel: body(&raw.accel, format.accel_scale, &format.accel_offset),
        }
    }
}

impl Iterator for ImuReader {
    type Item = Result<ImuSample, ReadError>;

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
mod tests;
