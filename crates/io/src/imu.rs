//! Inertial samples from a table of rates or increments.
//!
//! A sample stamped t covers the interval since the sample before, (t_prev, t]. A rate is taken
//! as the mean over that interval, so the increment is rate · dt. After a gap the interval is the
//! real difference of the stamps; whoever integrates decides how to bridge it.

use std::path::Path;

use undrift_nav::sample::ImuSample;
use undrift_nav::{Matrix3, Vector3};

use crate::ReadError;
use crate::clock::{self, Clock, Tick};
use crate::gaps::GapWatch;
pub use crate::gaps::{Gap, GapSummary};
use crate::skipped::Skipped;
use crate::source::{self, Source};
use crate::table::{Column, Table, TableOptions};

/// Samples in a row that must be earlier than the last accepted one to count as a clock set back.
const PATIENCE: u32 = 100;

/// Where the columns of an inertial log are and what they mean.
#[derive(Clone, Debug)]
pub struct ImuFormat {
    /// Time column; without one, row k (from 0, skipped rows count) is at k / `rate_hz`.
    pub time: Option<Column>,
    /// Angular rates or increments, the sensor's x, y, z.
    pub gyro: [Column; 3],
    /// Specific forces or velocity increments, the sensor's x, y, z.
    pub accel: [Column; 3],
    /// The byte between fields; `None` finds out.
    pub delimiter: Option<u8>,
    /// Factor from the time column to seconds.
    pub time_scale: f64,
    /// Factor from the gyro columns to rad/s, or to rad for increments.
    pub gyro_scale: f64,
    /// Factor from the accelerometer columns to m/s², or to m/s for increments.
    pub accel_scale: f64,
    /// The columns are increments over the interval rather than rates.
    pub increments: bool,
    /// Sampling rate [Hz]: makes the times where there is no time column, and the interval of the
    /// first sample, which is otherwise taken from the second one.
    pub rate_hz: Option<f64>,
    /// Added to the time after scaling [s].
    pub time_offset: f64,
    /// Rotation from sensor axes to body axes.
    pub rotation: Matrix3,
    /// Known constant of the gyros, body axes [rad/s], subtracted.
    pub gyro_offset: Vector3,
    /// Known constant of the accelerometers, body axes [m/s²], subtracted.
    pub accel_offset: Vector3,
    /// First and last time [s] to give out, after the offset; the samples outside are passed over.
    pub span: Option<(f64, f64)>,
}

impl ImuFormat {
    /// Rates in SI units along the body axes, times in seconds.
    pub fn new(time: Option<Column>, gyro: [Column; 3], accel: [Column; 3]) -> Self {
        Self {
            time,
            gyro,
            accel,
            delimiter: None,
            time_scale: 1.0,
            gyro_scale: 1.0,
            accel_scale: 1.0,
            increments: false,
            rate_hz: None,
            time_offset: 0.0,
            rotation: Matrix3::identity(),
            gyro_offset: Vector3::zeros(),
            accel_offset: Vector3::zeros(),
            span: None,
        }
    }

    fn check(&self, path: &Path) -> Result<(), ReadError> {
        if let Some(rate) = self.rate_hz {
            if !(rate.is_finite() && rate > 0.0) {
                let problem = format!("a rate of {rate} Hz makes no times");
                return Err(ReadError::new(path, problem).key("imu.rate_hz"));
            }
        } else if self.time.is_none() {
            return Err(
                ReadError::new(path, "neither a time column nor a rate is given")
                    .key("imu.time")
                    .mend("give imu.time or imu.rate_hz"),
            );
        }
        if !(self.time_scale.is_finite() && self.time_scale > 0.0) {
            let problem = format!("a time scale of {} makes no times", self.time_scale);
            return Err(ReadError::new(path, problem).key("imu.time"));
        }
        Ok(())
    }
}

/// Reads inertial samples one by one; after an error or the end it gives `None`.
pub struct ImuReader {
    table: Table,
    format: ImuFormat,
    /// Time (where there is a column), gyro x y z, accel x y z.
    row: [f64; 7],
    clock: Clock,
    gaps: GapWatch,
    /// The second sample, read for the interval of the first.
    held: Option<Raw>,
    /// First and last time of the file up to here [s].
    covered: Option<(f64, f64)>,
    given: u64,
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
    /// If the file cannot be opened, a column is missing, or the format has neither a time column
    /// nor a rate.
    pub fn open(path: &Path, format: &ImuFormat) -> Result<Self, ReadError> {
        Self::from_source(path, source::open(path)?, format)
    }

    /// Reads an inertial log from any stream; `path` is what messages call it.
    ///
    /// # Errors
    /// If a column is missing, or the format has neither a time column nor a rate.
    pub fn from_source(path: &Path, source: Source, format: &ImuFormat) -> Result<Self, ReadError> {
        format.check(path)?;
        let mut columns = Vec::with_capacity(7);
        if let Some(time) = &format.time {
            columns.push(("imu.time".to_owned(), time.clone()));
        }
        for column in &format.gyro {
            columns.push(("imu.gyro".to_owned(), column.clone()));
        }
        for column in &format.accel {
            columns.push(("imu.accel".to_owned(), column.clone()));
        }
        let options = TableOptions {
            columns,
            delimiter: format.delimiter,
            keep_not_finite: false,
        };
        Ok(Self {
            table: Table::from_source(path, source, &options)?,
            format: format.clone(),
            row: [0.0; 7],
            clock: Clock::new(path, PATIENCE),
            gaps: GapWatch::default(),
            held: None,
            covered: None,
            given: 0,
            finished: false,
        })
    }

    /// What was left out so far.
    pub fn skipped(&self) -> &Skipped {
        self.table.skipped()
    }

    /// The usual interval and the gaps of the samples given out so far.
    pub fn gaps(&self) -> GapSummary {
        self.gaps.summary()
    }

    /// The next row whose time goes forward.
    fn next_raw(&mut self) -> Result<Option<Raw>, ReadError> {
        let without_time = self.format.time.is_none();
        loop {
            let row = &mut self.row[usize::from(without_time)..];
            let Some(line) = self.table.next_row(row)? else {
                return Ok(None);
            };
            let [stamp, gx, gy, gz, ax, ay, az] = self.row;
            let time = match self.format.rate_hz {
                Some(rate) if without_time => (self.table.rows_seen() - 1) as f64 / rate,
                _ => stamp * self.format.time_scale,
            } + self.format.time_offset;
            if let Tick::Forward(dt) = self.clock.tick(time, line, self.table.skipped_mut())? {
                return Ok(Some(Raw {
                    time,
                    dt,
                    line,
                    gyro: Vector3::new(gx, gy, gz),
                    accel: Vector3::new(ax, ay, az),
                }));
            }
        }
    }

    /// The next row with its interval [s].
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
                self.table.path(),
                "only one sample, so its interval is unknown",
            )
            .at(raw.line)
            .key("imu.rate_hz")
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
            // The first interval given out is either made up or reaches back before the span.
            if self.given > 0 {
                self.gaps.add(Gap {
                    start: raw.time - dt,
                    length: dt,
                    line: raw.line,
                });
            }
            self.given += 1;
            return Ok(Some(self.sample(&raw, dt)));
        }
        match span {
            Some(span) if self.given == 0 => {
                Err(clock::none_in_span(self.table.path(), span, self.covered))
            }
            _ => Ok(None),
        }
    }

    fn sample(&self, raw: &Raw, dt: f64) -> ImuSample {
        let format = &self.format;
        let length = if format.increments { 1.0 } else { dt };
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
mod tests {
    use super::*;
    use crate::skipped::SkipKind;
    use std::io::Cursor;

    fn format() -> ImuFormat {
        let column = |n| Column::Number(n);
        ImuFormat::new(
            Some(column(1)),
            [column(2), column(3), column(4)],
            [column(5), column(6), column(7)],
        )
    }

    fn reader(text: &str, format: &ImuFormat) -> ImuReader {
        let source = Box::new(Cursor::new(text.as_bytes().to_vec()));
        ImuReader::from_source(Path::new("imu.csv"), source, format).unwrap()
    }

    fn all(text: &str, format: &ImuFormat) -> Vec<ImuSample> {
        reader(text, format).map(Result::unwrap).collect()
    }

    /// A few roundings of numbers of order one.
    const ROUNDING: f64 = 1e-14;

    #[test]
    fn rates_become_increments_over_the_real_interval() {
        let text = "0,1,2,3,4,5,6\n0.5,1,2,3,4,5,6\n1.5,1,2,3,4,5,6\n";
        let samples = all(text, &format());
        let intervals: Vec<f64> = samples.iter().map(|s| s.dt).collect();
        assert_eq!(intervals, [0.5, 0.5, 1.0]);
        assert_eq!(samples[1].dtheta, Vector3::new(0.5, 1.0, 1.5));
        assert_eq!(samples[2].dvel, Vector3::new(4.0, 5.0, 6.0));
        let rated = ImuFormat {
            rate_hz: Some(4.0),
            ..format()
        };
        assert_eq!(all(text, &rated)[0].dt, 0.25);
    }

    #[test]
    fn scale_rotation_and_offset() {
        // Sensor x is body y, sensor y is body x, sensor z is up.
        let mounted = ImuFormat {
            time_scale: 1e-3,
            time_offset: 100.0,
            gyro_scale: 2.0,
            accel_scale: 10.0,
            rotation: Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0),
            gyro_offset: Vector3::new(0.5, 0.0, 0.0),
            accel_offset: Vector3::new(0.0, 0.0, 1.0),
            ..format()
        };
        let text = "0,1,2,3,4,5,6\n500,1,2,3,4,5,6\n";
        let rates = all(text, &mounted)[1];
        assert_eq!(rates.time, 100.5);
        assert!((rates.dtheta - Vector3::new(3.5, 2.0, -6.0) * 0.5).norm() < ROUNDING);
        assert!((rates.dvel - Vector3::new(50.0, 40.0, -61.0) * 0.5).norm() < ROUNDING);
        let increments = ImuFormat {
            increments: true,
            ..mounted
        };
        let increment = all(text, &increments)[1];
        assert!((increment.dtheta - Vector3::new(3.75, 2.0, -6.0)).norm() < ROUNDING);
        assert!((increment.dvel - Vector3::new(50.0, 40.0, -60.5)).norm() < ROUNDING);
    }

    #[test]
    fn without_a_time_column_a_bad_row_still_takes_its_time() {
        let column = |n| Column::Number(n);
        let rated = ImuFormat {
            rate_hz: Some(10.0),
            ..ImuFormat::new(
                None,
                [column(1), column(2), column(3)],
                [column(4), column(5), column(6)],
            )
        };
        let samples = all("1,1,1,1,1,1\n1,1,bad,1,1,1\n1,1,1,1,1,1\n", &rated);
        assert_eq!(samples.len(), 2);
        assert_eq!((samples[0].time, samples[0].dt), (0.0, 0.1));
        assert_eq!((samples[1].time, samples[1].dt), (0.2, 0.2));
    }

    #[test]
    fn one_sample_without_a_rate_is_an_error_and_only_once() {
        let mut reader = reader("0,1,2,3,4,5,6\n", &format());
        assert!(
            reader
                .next()
                .unwrap()
                .unwrap_err()
                .to_string()
                .contains("rate")
        );
        assert!(reader.next().is_none());
    }

    #[test]
    fn formats_that_make_no_times() {
        for bad in [
            ImuFormat {
                time: None,
                ..format()
            },
            ImuFormat {
                rate_hz: Some(0.0),
                ..format()
            },
            ImuFormat {
                time_scale: f64::NAN,
                ..format()
            },
        ] {
            let source = Box::new(Cursor::new(b"1,1,1,1,1,1,1\n".to_vec()));
            assert!(ImuReader::from_source(Path::new("x"), source, &bad).is_err());
        }
    }

    #[test]
    fn duplicates_are_skipped_and_a_reset_clock_is_an_error() {
        let row = |t: f64| format!("{t},0,0,0,0,0,0\n");
        let mut text: String = (0..50).map(|k| row(k as f64 * 0.01)).collect();
        text += &row(0.49);
        text += &row(0.2);
        text += &row(0.5);
        let mut good = reader(&text, &format());
        assert_eq!(good.by_ref().filter(Result::is_ok).count(), 51);
        assert_eq!(good.skipped().count(SkipKind::DuplicateTime), 1);
        assert_eq!(good.skipped().count(SkipKind::TimeBackwards), 1);

        text.extend((0..200).map(|k| row(k as f64 * 1e-3)));
        let last = reader(&text, &format()).last().unwrap();
        let error = last.unwrap_err();
        assert_eq!(error.line, Some(54));
        assert!(error.to_string().contains("jumps back"), "{error}");
    }

    #[test]
    fn span_keeps_the_interval_of_its_first_sample_and_names_what_there_is() {
        let text: String = (0..10).map(|k| format!("{k},0,0,0,0,0,0\n")).collect();
        let part = |span| ImuFormat {
            span: Some(span),
            ..format()
        };
        let samples = all(&text, &part((3.0, 5.0)));
        let times: Vec<f64> = samples.iter().map(|s| s.time).collect();
        assert_eq!(times, [3.0, 4.0, 5.0]);
        assert_eq!(samples[0].dt, 1.0);
        let mut outside = reader(&text, &part((30.0, 50.0)));
        let error = outside.next().unwrap().unwrap_err().to_string();
        assert!(error.contains("0 s to 9 s"), "{error}");
    }

    #[test]
    fn gaps_keep_their_length() {
        let mut text: String = (0..200).map(|k| format!("{k},0,0,0,0,0,0\n")).collect();
        text += "207,0,0,0,0,0,0\n";
        let mut reader = reader(&text, &format());
        assert_eq!(reader.by_ref().last().unwrap().unwrap().dt, 8.0);
        let gap = Gap {
            start: 199.0,
            length: 8.0,
            line: 201,
        };
        assert_eq!(reader.gaps().count, 1);
        assert_eq!(reader.gaps().longest, Some(gap));
    }
}
