//! Tables whose wanted columns are numbers: delimited text (CSV, semicolons, tabs or blanks), Parquet, or
//! columns in memory.
//!
//! Columns are asked for by name or by number. The first line that is no comment is the header if
//! it has text in it; a comment line directly before the data serves as one where names are asked
//! for. Rows that cannot be used are skipped and counted, see [`Table::skipped`].
//!
//! ```no_run
//! use undrift_io::Opened;
//! use undrift_io::table::{Column, TableOptions};
//! let options = TableOptions {
//!     columns: vec![("imu.time".into(), Column::Name("t_s".into()))],
//!     ..TableOptions::default()
//! };
//! let mut table = Opened::open("imu.csv.gz".as_ref())?.table(&options)?;
//! let mut row = [0.0];
//! while let Some(line) = table.next_row(&mut row)? {
//!     println!("line {line}: t = {} s", row[0]);
//! }
//! # Ok::<(), undrift_io::ReadError>(())
//! ```

mod cells;
mod columns;
mod counter;
mod fields;
pub mod halves;
mod header;
mod json;
pub(crate) mod json_columns;
pub(crate) mod lines;
mod monitor;
pub(crate) mod objects;
#[cfg(feature = "parquet")]
mod parquet;
mod parts;
pub(crate) mod programs;
mod rewritten;
mod stamps;
pub(crate) mod tagged;
#[cfg(test)]
mod tests;
mod text;
mod unnamed;
mod wanted;
#[cfg(feature = "xlsx")]
pub(crate) mod workbook;

use std::path::{Path, PathBuf};

pub use columns::Columns;
pub(crate) use header::has_named_numbers;
pub use wanted::{Angles, Column, Preview, Stamp, TableOptions};
pub(crate) use wanted::{check_time_scale, three};

use counter::Counter;

use crate::ReadError;
use crate::epoch::Epoch;
use crate::skipped::{SkipKind, Skipped};
use crate::source::Source;
use crate::table::lines::MAX_LINE;
use crate::time::DAY;
use wanted::{Defect, Keep, NextRow, no_rows};

/// What a table is read from.
pub(crate) enum TableSource {
    /// Delimited text, and its beginning where the text itself is read while it comes.
    Text(Source, Option<Vec<u8>>),
    /// Columns in memory.
    Columns(Columns),
    /// A file or bytes of Parquet, which is read from its end.
    #[cfg(feature = "parquet")]
    Parquet(parquet::Bytes),
}

/// Reads the wanted columns of a table row by row.
pub struct Table {
    name: PathBuf,
    rows: OpenTable,
    columns: Vec<(String, Column)>,
    /// A place in the row read without a finite number in so many rows, every one up to now.
    empty: Option<(usize, u64)>,
    keep: Keep,
    /// Rows without anything but a time, where they are no defects.
    blank: Option<Skipped>,
    rows_read: u64,
    rows_seen: u64,
    finished: bool,
    skipped: Skipped,
    stamp: Option<Stamp>,
    /// Where the times are in the row read, and what they count on past the end of their counter.
    counter: Option<(usize, Counter)>,
    /// What the times count from, found by the first row that can be used.
    epoch: Option<Epoch>,
}

/// Boxed: a reader holds its place in the file and a row.
enum OpenTable {
    Text(Box<text::TextTable>),
    Memory(columns::MemoryTable),
    #[cfg(feature = "parquet")]
    Parquet(Box<parquet::ParquetTable>),
}

impl Table {
    /// Finds the wanted columns; `name` is what messages call the table.
    ///
    /// # Errors
    /// If there is no line, or a wanted column is missing.
    pub(crate) fn new(
        name: &Path,
        source: TableSource,
        options: &TableOptions,
    ) -> Result<Self, ReadError> {
        let mut skipped = Skipped::default();
        if let (Some((key, _)), false) = (options.date(), matches!(source, TableSource::Text(..))) {
            let error = ReadError::new(name, "a column of dates is read from text alone");
            return Err(error.key(key.as_str()).mend("give times as numbers"));
        }
        let rows = match source {
            TableSource::Columns(columns) => {
                columns::MemoryTable::new(columns, options).map(OpenTable::Memory)
            }
            TableSource::Text(source, beginning) => {
                text::TextTable::new(source, beginning.as_deref(), options, &mut skipped)
                    .map(|table| OpenTable::Text(Box::new(table)))
            }
            #[cfg(feature = "parquet")]
            TableSource::Parquet(bytes) => parquet::ParquetTable::new(bytes, options)
                .map(|table| OpenTable::Parquet(Box::new(table))),
        };
        Ok(Self {
            name: name.to_path_buf(),
            rows: rows.map_err(|error| error.in_log(name))?,
            columns: options.columns.clone(),
            empty: None,
            keep: options.keep(),
            blank: options.of_one_sensor.then(Skipped::default),
            rows_read: 0,
            rows_seen: 0,
            finished: false,
            skipped,
            stamp: options.stamp.clone(),
            counter: (options.stamp.as_ref())
                .filter(|stamp| stamp.date.is_none())
                .map(|stamp| (stamp.place, Counter::new(stamp.scale))),
            epoch: None,
        })
    }

    /// Reads the next usable row into `out`, in the order of the wanted columns, and gives its
    /// line number, or that of the row in Parquet and in memory; `None` at the end.
    ///
    /// # Errors
    /// If the file ends without one usable row, or `out` has another length than there are wanted
    /// columns.
    #[inline]
    pub fn next_row(&mut self, out: &mut [f64]) -> Result<Option<u64>, ReadError> {
        if out.len() != self.columns.len() {
            let problem = format!("{} places for {} columns", out.len(), self.columns.len());
            return Err(ReadError::new(&self.name, problem));
        }
        while !self.finished {
            let step = match &mut self.rows {
                OpenTable::Text(table) => table.step(self.keep, out),
                OpenTable::Memory(table) => Ok(table.step(self.keep, out)),
                #[cfg(feature = "parquet")]
                OpenTable::Parquet(table) => Ok(table.step(self.keep, out)),
            };
            match step {
                Ok(NextRow::Row(line, Ok(()))) => {
                    self.rows_seen += 1;
                    self.rows_read += 1;
                    if let Some((place, counter)) = &mut self.counter
                        && let Some(time) = out.get_mut(*place)
                    {
                        let counted = counter.count(*time);
                        *time = counted.value;
                        if let Some(added) = counted.started {
                            self.skipped.counter_started(line, added);
                        }
                    }
                    if let Some(stamp) = self.stamp.take() {
                        self.epoch = self.epoch_by(&stamp, out);
                    }
                    return Ok(Some(line));
                }
                Ok(NextRow::Row(line, Err(defect))) => {
                    self.rows_seen += 1;
                    // A row of another sensor is no defect, unless all are.
                    if let (Defect::Blank { .. }, Some(blank)) = (&defect, &mut self.blank) {
                        blank.add(defect.kind(), line, &defect);
                        continue;
                    }
                    if let Defect::NotFinite { slot, .. } = defect {
                        let (place, rows) = self.empty.unwrap_or((slot, 0));
                        self.empty = Some((place, rows + u64::from(place == slot)));
                    }
                    self.skipped.add(defect.kind(), line, &defect);
                }
                Ok(NextRow::TooLong(line)) => {
                    self.rows_seen += 1;
                    let detail = format_args!("over {MAX_LINE} bytes");
                    self.skipped.add(SkipKind::TooLong, line, detail);
                }
                Ok(NextRow::End(failure)) => self.finish(failure)?,
                Err(error) => return Err(error.in_log(&self.name)),
            }
        }
        Ok(None)
    }

    fn finish(&mut self, failure: Option<(u64, String)>) -> Result<(), ReadError> {
        self.finished = true;
        if let Some((line, failure)) = failure {
            self.skipped.add(SkipKind::EndsEarly, line, failure);
        }
        if self.rows_read > 0 {
            return Ok(());
        }
        self.skipped.merge(&self.blank.take().unwrap_or_default());
        let error = match self.empty {
            Some((slot, rows)) if rows == self.rows_seen => self.never_a_number(slot),
            _ => None,
        };
        let error = error.unwrap_or_else(|| no_rows(self.rows_seen, &self.skipped));
        Err(error.in_log(&self.name))
    }

    /// That a wanted column has no number in any row.
    fn never_a_number(&self, slot: usize) -> Option<ReadError> {
        let (key, column) = self.columns.get(slot)?;
        let problem = format!(
            "column {column} (key {key}) is NaN or infinite in all {} rows",
            self.rows_seen
        );
        Some(ReadError::nameless(problem).mend("choose another column or export it again"))
    }

    /// What was left out so far.
    pub fn skipped(&self) -> &Skipped {
        &self.skipped
    }

    /// Rows met so far, the skipped ones included.
    pub fn rows_seen(&self) -> u64 {
        self.rows_seen
    }

    /// What the times count from, if they are dates or Unix times; known after the first row.
    pub fn epoch(&self) -> Option<Epoch> {
        self.epoch
    }

    /// The same of the first row.
    fn epoch_by(&self, stamp: &Stamp, row: &[f64]) -> Option<Epoch> {
        let by_text = match &self.rows {
            OpenTable::Text(table) => table.epoch(),
            _ => None,
        };
        let first = *row.get(stamp.place)?;
        by_text.or_else(|| match stamp.scale == DAY {
            true => Epoch::of_days(first),
            false => Epoch::of_number(first * stamp.scale, &stamp.column),
        })
    }

    pub(crate) fn skipped_mut(&mut self) -> &mut Skipped {
        &mut self.skipped
    }
}

/// The names of the columns and up to `rows` rows of all of them.
///
/// # Errors
/// If there is no line, or Parquet cannot be read.
pub(crate) fn preview(source: TableSource, rows: usize) -> Result<Preview, ReadError> {
    match source {
        TableSource::Text(source, _) => header::preview(source, rows),
        TableSource::Columns(columns) => Ok(columns.preview(rows)),
        #[cfg(feature = "parquet")]
        TableSource::Parquet(bytes) => parquet::preview(bytes, rows),
    }
}

/// Whether a file that starts so is Parquet.
pub(crate) fn is_parquet(start: &[u8]) -> bool {
    start.starts_with(b"PAR1")
}

/// Whether a text that starts so has an object of JSON in each line.
pub(crate) fn are_json_lines(start: &[u8]) -> bool {
    let end = start.iter().rposition(|byte| *byte == b'\n');
    let whole = start.get(..end.unwrap_or_default()).unwrap_or_default();
    json::JsonLines::detect(whole.split(|byte| *byte == b'\n')).is_some()
}

/// A file of Parquet, or its bytes where there is no file.
///
/// # Errors
/// Of a build that does not read Parquet.
pub(crate) fn parquet(file: Option<std::fs::File>, all: &[u8]) -> Result<TableSource, ReadError> {
    #[cfg(feature = "parquet")]
    return Ok(TableSource::Parquet(match file {
        Some(file) => parquet::Bytes::File(file.into()),
        None => parquet::Bytes::Memory(all.to_vec().into()),
    }));
    #[cfg(not(feature = "parquet"))]
    {
        let (_, _) = (file, all);
        Err(ReadError::nameless("this build cannot read Parquet")
            .mend("build with the feature parquet"))
    }
}
