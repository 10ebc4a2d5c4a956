//! Logs of one number: wheel speed or ticks, barometric height or pressure, heading by two antennas.
//!
//! A row is a time, a number and, where the file has one, its standard deviation. Read one by one;
//! rows that cannot be used are skipped and counted, and gaps are noted, as for the other logs. Headings may also be
//! messages of a log that says itself what it holds.

use std::sync::Arc;

use undrift_nav::earth::standard_height;
use undrift_nav::sample::Scalar;

use crate::ReadError;
use crate::entry::{Entry, Wanted, What};
use crate::fix::is_usable_std;
use crate::format::Format;
use crate::gaps::{Gap, GapSummary, GapWatch};
use crate::opened::Memory;
use crate::reader::{Kind, Plan, Reader, Row, TableRow, Want};
use crate::skipped::{SkipKind, Skipped};
use crate::table::{Column, TableOptions};

/// A running count says nothing of the rate in the middle of an interval longer than this \[s\].
const LONGEST_COUNT: f64 = 1.0;

/// Where the columns of a log are and what they mean.
#[derive(Clone, Debug)]
pub struct ScalarFormat {
    /// The table of the drive file that asks for it; messages name its keys.
    pub table: &'static str,
    /// Time column.
    pub time: Column,
    /// Column of dates, where that of times has times of day.
    pub date: Option<Column>,
    /// Factor from the time column to seconds.
    pub time_scale: f64,
    /// Added to the time after scaling \[s\].
    pub time_offset: f64,
    /// The key that asks for the number, and its column.
    pub value: (&'static str, Column),
    /// What the column says.
    pub reading: Reading,
    /// The key that asks for the number's standard deviation, and what that is.
    pub std: (&'static str, ScalarStd),
    /// Least and greatest number there can be, in SI.
    pub range: (f64, f64),
    /// The byte between fields; `None` finds out.
    pub delimiter: Option<u8>,
    /// First and last time \[s\] to give out, after the offset.
    pub span: Option<(f64, f64)>,
}

/// How a number is made of its column.
#[derive(Clone, Debug, PartialEq)]
pub enum Reading {
    /// The column times this factor.
    Scaled(f64),
    /// The column times this factor is a pressure \[Pa\]; the number is its height in the standard
    /// atmosphere \[m\].
    Pressure(f64),
    /// The column times this factor is a running sum; the number is its mean rate between two rows
    /// [1/s], stamped in their middle. Its standard deviation grows by that of the rounding to whole
    /// counts, `factor/(√6 dt)`.
    Count(f64),
    /// Measurements in memory, as they are.
    Held,
    /// Headings of a log of this format, of the stream with this name or of the only one.
    Log(Format, Option<String>),
}

/// Standard deviation of a number, in SI.
#[derive(Clone, Debug)]
pub enum ScalarStd {
    /// The same for every row.
    Constant(f64),
    /// A column times a factor.
    Column(Column, f64),
    /// That of the log, or this one of a record without one.
    Stated(f64),
}

/// Reads numbers.
pub type ScalarReader = Reader<Scalars>;

/// Numbers as a kind of record.
pub struct Scalars {
    format: ScalarFormat,
    gaps: GapWatch,
    /// The running sum before.
    count: Option<f64>,
}

impl Reader<Scalars> {
    /// The usual interval and the gaps of the rows met so far.
    pub fn gaps(&self) -> GapSummary {
        self.kind().gaps.summary()
    }
}

impl ScalarFormat {
    /// Headings of a log of the format `log`, of its only stream of them, that may be in `range`; of those whose accuracy it does not
    /// state the standard deviation is `std` \[rad\].
    pub fn headings(log: Format, std: f64, range: (f64, f64)) -> Self {
        Self {
            reading: Reading::Log(log, None),
            std: ("std", ScalarStd::Stated(std)),
            ..Self::scalars("heading", range)
        }
    }

    /// Measurements in memory, [`Memory::Scalars`], that may be in `range`; `table` is what messages call them.
    pub fn scalars(table: &'static str, range: (f64, f64)) -> Self {
        Self {
            table,
            time: Column::Number(1),
            date: None,
            time_scale: 1.0,
            time_offset: 0.0,
            value: ("value", Column::Number(2)),
            reading: Reading::Held,
            std: ("std", ScalarStd::Column(Column::Number(3), 1.0)),
            range,
            delimiter: None,
            span: None,
        }
    }
}

impl Kind for Scalars {
    type Options = ScalarFormat;
    /// The number and, where the file has one, its standard deviation.
    type Values = (f64, f64);
    type Record = Scalar;
    const PATIENCE: u32 = 100;

    fn plan(format: &ScalarFormat) -> Result<Plan<Self>, ReadError> {
        let key = |name: &str| format!("{}.{name}", format.table);
        let factor = match format.reading {
            Reading::Scaled(factor) | Reading::Pressure(factor) | Reading::Count(factor) => factor,
            Reading::Held | Reading::Log(..) => 1.0,
        };
        let (ScalarStd::Constant(std) | ScalarStd::Column(_, std) | ScalarStd::Stated(std)) =
            &format.std.1;
        for (name, number) in [
            ("time", format.time_scale),
            (format.value.0, factor),
            (format.std.0, *std),
        ] {
            if !(number.is_finite() && number > 0.0) {
                let problem = format!("{number} where a positive number is required");
                return Err(ReadError::nameless(problem).key(&*key(name)));
            }
        }
        let mut wanted = TableOptions::finite(format.delimiter);
        let date = format.date.as_ref();
        wanted.want_time(format.table, &format.time, date, format.time_scale);
        wanted.want(&key(format.value.0), [&format.value.1]);
        if let ScalarStd::Column(column, _) = &format.std.1 {
            wanted.want(&key(format.std.0), [column]);
        }
        Ok(Plan {
            kind: Self {
                format: format.clone(),
                gaps: GapWatch::default(),
                count: None,
            },
            source: match &format.reading {
                Reading::Held => Want::Records,
                Reading::Log(log, stream) => Want::Log(*log, Wanted::Headings(stream.clone())),
                _ => Want::Table(wanted),
            },
            span: format.span,
        })
    }

    fn of_row(&mut self, row: TableRow, _: &mut Skipped) -> Option<(f64, (f64, f64))> {
        let (&[stamp, read], std) = row.numbers.split_first_chunk()?;
        let time = stamp * self.format.time_scale + self.format.time_offset;
        Some((time, (read, std.first().copied().unwrap_or(f64::NAN))))
    }

    fn of_entry(&mut self, entry: Entry, _: &mut Skipped) -> Option<(f64, (f64, f64))> {
        let What::Heading(read) = entry.what else {
            return None;
        };
        let time = read.time + self.format.time_offset;
        Some((time, (read.heading, read.std.unwrap_or(f64::NAN))))
    }

    fn held(memory: &Memory) -> Option<Arc<[Scalar]>> {
        match memory {
            Memory::Scalars(scalars) => Some(scalars.clone()),
            _ => None,
        }
    }

    fn of_record(
        &mut self,
        scalar: &Scalar,
        number: u64,
        skipped: &mut Skipped,
    ) -> Option<(f64, (f64, f64))> {
        if !scalar.is_finite() {
            skipped.add(SkipKind::NotFinite, number, scalar.value);
            return None;
        }
        let time = scalar.time + self.format.time_offset;
        Some((time, (scalar.value, scalar.std)))
    }

    fn record(
        &mut self,
        row: &Row<(f64, f64)>,
        skipped: &mut Skipped,
    ) -> Result<Option<Scalar>, ReadError> {
        if let Some(length) = row.dt {
            self.gaps.add(Gap {
                start: row.time - length,
                length,
                line: row.line,
            });
        }
        Ok(self.scalar(row, skipped))
    }

    fn nothing(&self, _: &Skipped) -> ReadError {
        ReadError::nameless("no usable value")
    }
}

impl Scalars {
    /// The number of a row; counted where it cannot be used.
    fn scalar(&mut self, row: &Row<(f64, f64)>, skipped: &mut Skipped) -> Option<Scalar> {
        let (read, read_std) = row.values;
        let mut std = match &self.format.std.1 {
            ScalarStd::Constant(std) => *std,
            ScalarStd::Column(_, factor) => read_std * factor,
            ScalarStd::Stated(otherwise) if read_std.is_nan() => *otherwise,
            ScalarStd::Stated(_) => read_std,
        };
        let mut at = row.time;
        let value = match self.format.reading {
            Reading::Held | Reading::Log(..) => read,
            Reading::Scaled(factor) => read * factor,
            Reading::Pressure(factor) => standard_height(read * factor),
            Reading::Count(factor) => {
                let before = self.count.replace(read)?;
                let dt = row.dt.filter(|dt| *dt <= LONGEST_COUNT)?;
                at -= 0.5 * dt;
                std = std.hypot(factor / (6f64.sqrt() * dt));
                (read - before) * factor / dt
            }
        };
        let (least, greatest) = self.format.range;
        if !(least..=greatest).contains(&value) {
            skipped.add(SkipKind::OutOfRange, row.line, read);
            return None;
        }
        if !is_usable_std(std) {
            skipped.add(SkipKind::Uncertainty, row.line, std);
            return None;
        }
        Some(Scalar {
            time: at,
            value,
            std,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Opened;
    use std::io::Cursor;
    use std::path::Path;

    fn speed() -> ScalarFormat {
        ScalarFormat {
            table: "odometer",
            time: Column::Number(1),
            date: None,
            time_scale: 1.0,
            time_offset: 0.0,
            value: ("speed", Column::Number(2)),
            reading: Reading::Scaled(1.0 / 3.6),
            std: ("speed_std", ScalarStd::Constant(0.1)),
            range: (-150.0, 150.0),
            delimiter: None,
            span: None,
        }
    }

    fn open(text: &str, format: &ScalarFormat) -> Result<ScalarReader, ReadError> {
        let source = Box::new(Cursor::new(text.as_bytes().to_vec()));
        ScalarReader::new(Opened::stream(Path::new("wheel.csv"), source)?, format)
    }

    fn all(text: &str, format: &ScalarFormat) -> (Vec<Scalar>, Skipped, GapSummary) {
        let mut reader = open(text, format).unwrap();
        let scalars = reader.by_ref().map(Result::unwrap).collect();
        (scalars, reader.skipped().clone(), reader.gaps())
    }

    #[test]
    fn units_offset_span_and_a_column_of_standard_deviations() {
        let format = ScalarFormat {
            time_scale: 1e-3,
            time_offset: 10.0,
            std: (
                "speed_std_column",
                ScalarStd::Column(Column::Number(3), 1.0 / 3.6),
            ),
            span: Some((10.15, 10.35)),
            ..speed()
        };
        let (scalars, skipped, _) = all(
            "t,v,s\n100,1,1\n200,36,0.36\n300,-36,3.6\n400,1,1\n",
            &format,
        );
        assert!(skipped.is_empty());
        assert_eq!(scalars.len(), 2);
        let last = scalars[1];
        assert!((last.time - 10.3).abs() < 1e-12 && (last.value + 10.0).abs() < 1e-12);
        assert!((last.std - 1.0).abs() < 1e-12);
    }

    #[test]
    fn bad_rows_and_gaps_are_counted() {
        let text = "0,1\n1,x\n1,2\n2,nan\n2,4\n3,\n3,9999\n3.5,6\n2.5,6\n4,6\n5,6\n6,6\n9,6\n";
        let (scalars, skipped, gaps) = all(text, &speed());
        assert_eq!(scalars.len(), 8);
        assert_eq!(skipped.count(SkipKind::Text), 1);
        assert_eq!(skipped.count(SkipKind::NotFinite), 1);
        assert_eq!(skipped.count(SkipKind::MissingField), 1);
        assert_eq!(skipped.count(SkipKind::OutOfRange), 1);
        assert_eq!(skipped.count(SkipKind::TimeBackwards), 1);
        assert_eq!((gaps.count, gaps.longest.unwrap().length), (1, 3.0));
        let (_, skipped, _) = all(
            "0,1,1\n1,1,0\n2,1,-3\n",
            &ScalarFormat {
                std: (
                    "speed_std_column",
                    ScalarStd::Column(Column::Number(3), 1.0),
                ),
                ..speed()
            },
        );
        assert_eq!(skipped.count(SkipKind::Uncertainty), 2);
    }

    #[test]
    fn ticks_become_speeds_in_the_middle_of_their_interval() {
        let format = ScalarFormat {
            value: ("ticks", Column::Number(2)),
            reading: Reading::Count(1.0 / 50.0),
            std: ("speed_std", ScalarStd::Constant(0.03)),
            ..speed()
        };
        // 50 ticks a metre; a counter that starts again, a pause, and driving backwards.
        let text = "0,65000\n0.1,65050\n0.2,65110\n0.3,4\n0.4,54\n3,90\n3.1,80\n";
        let (scalars, skipped, _) = all(text, &format);
        let seen: Vec<(f64, f64)> = scalars
            .iter()
            .map(|s| ((s.time * 1e3).round(), (s.value * 1e3).round()))
            .collect();
        let expected = [(50.0, 1e4), (150.0, 1.2e4), (350.0, 1e4), (3050.0, -2e3)];
        assert_eq!(seen, expected);
        assert_eq!(skipped.count(SkipKind::OutOfRange), 1);
        // 0.02 m of one tick in 0.1 s, over √6.
        assert!((scalars[0].std - 0.03f64.hypot(0.2 / 6f64.sqrt())).abs() < 1e-9);
    }

    #[test]
    fn pressures_become_heights_and_what_is_no_pressure_is_counted() {
        let format = ScalarFormat {
            table: "barometer",
            value: ("pressure", Column::Number(2)),
            reading: Reading::Pressure(100.0),
            range: (-1000.0, 11_000.0),
            ..speed()
        };
        let (scalars, skipped, _) = all("0,1013.25\n1,898.763\n2,0\n3,-5\n4,1e9\n", &format);
        // The standard atmosphere's tables: 898.763 hPa at 1000 m.
        assert!(scalars[0].value.abs() < 1e-9 && (scalars[1].value - 1000.0).abs() < 0.02);
        assert_eq!((scalars.len(), skipped.count(SkipKind::OutOfRange)), (2, 3));
    }

    #[test]
    fn what_cannot_be_read_is_said_with_its_key() {
        let refused = |format: &ScalarFormat| open("t,v\n1,2\n", format).err().unwrap().to_string();
        let missing = ScalarFormat {
            value: ("speed", Column::Name("speed".into())),
            ..speed()
        };
        let message = refused(&missing);
        assert!(
            message.contains("no column \"speed\" (key odometer.speed)"),
            "{message}"
        );
        let zero = ScalarFormat {
            std: ("speed_std", ScalarStd::Constant(0.0)),
            ..speed()
        };
        assert!(refused(&zero).contains("odometer.speed_std"));
        let nothing = open("t,v\n1,9999\n", &speed()).unwrap().next().unwrap();
        let message = nothing.unwrap_err().to_string();
        assert!(message.contains("no usable value"), "{message}");
        let span = ScalarFormat {
            span: Some((5.0, 6.0)),
            ..speed()
        };
        let outside = open("t,v\n1,2\n", &span).unwrap().next().unwrap();
        assert!(
            outside
                .unwrap_err()
                .to_string()
                .contains("ends at 1 s, before [span] begins at 5 s")
        );
    }
}
