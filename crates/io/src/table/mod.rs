//! Delimited text whose wanted columns are numbers: CSV, semicolons, tabs or blanks.
//!
//! Columns are asked for by name or by number. The first line that is no comment is the header if
//! it has text in it; a comment line directly before the data serves as one where names are asked
//! for. Rows that cannot be used are skipped and counted, see [`Table::skipped`].
//!
//! ```no_run
//! use undrift_io::table::{Column, Table, TableOptions};
//! let options = TableOptions {
//!     columns: vec![("imu.time".into(), Column::Name("t_s".into()))],
//!     ..TableOptions::default()
//! };
//! let mut table = Table::open("imu.csv.gz".as_ref(), &options)?;
//! let mut row = [0.0];
//! while let Some(line) = table.next_row(&mut row)? {
//!     println!("line {line}: t = {} s", row[0]);
//! }
//! # Ok::<(), undrift_io::ReadError>(())
//! ```

mod fields;
mod header;
pub use header::header_names;
#[cfg(feature = "parquet")]
pub(crate) use header::places;

use std::fmt;
use std::path::{Path, PathBuf};

use crate::ReadError;
use crate::lines::{Lines, MAX_LINE, Step};
use crate::skipped::{SkipKind, Skipped};
use crate::source::{self, Source};

pub(crate) use fields::{Defect, Delimiter, shown};

/// Which column is meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Column {
    /// The one with this name in the header.
    Name(String),
    /// The one at this place, the first is 1.
    Number(usize),
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => write!(f, "\"{name}\""),
            Self::Number(number) => write!(f, "{number}"),
        }
    }
}

/// What to read from a table.
#[derive(Clone, Debug, Default)]
pub struct TableOptions {
    /// The wanted columns in the order of the row read, each with the configuration key that asks
    /// for it, which messages name.
    pub columns: Vec<(String, Column)>,
    /// The byte between fields; `None` finds out: comma, semicolon, tab, or else runs of blanks.
    pub delimiter: Option<u8>,
    /// Hand on rows with NaN, infinity or an empty field (as NaN) instead of skipping them.
    pub keep_not_finite: bool,
}

/// Reads the wanted columns of a table row by row.
pub struct Table {
    path: PathBuf,
    lines: Lines,
    delimiter: Delimiter,
    /// Wanted columns by place in the line: (index of the column, index in the row read).
    wanted: Vec<(usize, usize)>,
    width: usize,
    keep_not_finite: bool,
    /// The first line of data, found while looking for the header.
    held: Option<Vec<u8>>,
    rows_read: u64,
    rows_seen: u64,
    finished: bool,
    skipped: Skipped,
}

impl Table {
    /// Opens a table, plain or gzip, and finds the wanted columns.
    ///
    /// # Errors
    /// If the file cannot be opened, has no line, or lacks a wanted column.
    pub fn open(path: &Path, options: &TableOptions) -> Result<Self, ReadError> {
        Self::from_source(path, source::open(path)?, options)
    }

    /// Reads a table from any stream; `path` is what messages call it.
    ///
    /// # Errors
    /// If there is no line, or a wanted column is missing.
    pub fn from_source(
        path: &Path,
        source: Source,
        options: &TableOptions,
    ) -> Result<Self, ReadError> {
        let mut lines = Lines::new(source);
        let mut skipped = Skipped::default();
        let layout = header::find(path, &mut lines, options, &mut skipped)?;
        Ok(Self {
            path: path.to_path_buf(),
            lines,
            delimiter: layout.delimiter,
            wanted: layout.wanted,
            width: options.columns.len(),
            keep_not_finite: options.keep_not_finite,
            held: layout.first_row,
            rows_read: 0,
            rows_seen: 0,
            finished: false,
            skipped,
        })
    }

    /// Reads the next usable row into `out`, in the order of the wanted columns, and gives its
    /// line number; `None` at the end.
    ///
    /// # Errors
    /// If the file ends without one usable row, or `out` has another length than there are wanted
    /// columns.
    pub fn next_row(&mut self, out: &mut [f64]) -> Result<Option<u64>, ReadError> {
        if out.len() != self.width {
            return Err(ReadError::new(
                &self.path,
                format!("{} places for {} columns", out.len(), self.width),
            ));
        }
        let (delimiter, keep) = (self.delimiter, self.keep_not_finite);
        if let Some(first) = self.held.take() {
            let line = self.lines.number();
            let parsed = fields::parse_row(&first, delimiter, &self.wanted, keep, out);
            if self.accept(parsed, line) {
                return Ok(Some(line));
            }
        }
        while !self.finished {
            let range = match self.lines.step() {
                Step::Line(range) => range,
                Step::TooLong => {
                    let line = self.lines.number();
                    self.rows_seen += 1;
                    self.skipped.add(
                        SkipKind::TooLong,
                        line,
                        format_args!("over {MAX_LINE} bytes"),
                    );
                    continue;
                }
                Step::End => {
                    self.finish()?;
                    break;
                }
            };
            let line = self.lines.number();
            let bytes = self.lines.bytes(range);
            if !starts_a_row(bytes) {
                continue;
            }
            let parsed = fields::parse_row(bytes, delimiter, &self.wanted, keep, out);
            if self.accept(parsed, line) {
                return Ok(Some(line));
            }
        }
        Ok(None)
    }

    /// What was left out so far.
    pub fn skipped(&self) -> &Skipped {
        &self.skipped
    }

    /// The file as it was given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Rows met so far, the skipped ones included.
    pub fn rows_seen(&self) -> u64 {
        self.rows_seen
    }

    pub(crate) fn skipped_mut(&mut self) -> &mut Skipped {
        &mut self.skipped
    }

    /// Whether a parsed row is usable; counted where not.
    #[inline]
    fn accept(&mut self, parsed: Result<(), Defect>, line: u64) -> bool {
        self.rows_seen += 1;
        match parsed {
            Ok(()) => {
                self.rows_read += 1;
                true
            }
            Err(defect) => {
                self.skipped.add(defect.kind(), line, &defect);
                false
            }
        }
    }

    fn finish(&mut self) -> Result<(), ReadError> {
        self.finished = true;
        if let Some(failure) = self.lines.failure() {
            self.skipped
                .add(SkipKind::EndsEarly, self.lines.number(), failure);
        }
        if self.rows_read > 0 {
            return Ok(());
        }
        Err(no_rows(&self.path, self.rows_seen, &self.skipped))
    }
}

/// Why a table without one usable row cannot be used.
pub(crate) fn no_rows(path: &Path, seen: u64, skipped: &Skipped) -> ReadError {
    let problem = if seen == 0 {
        "no row of data"
    } else {
        "no row with a number in every wanted column"
    };
    ReadError::new(path, problem).mend(skipped.to_string().replace('\n', "; "))
}

/// Whether a line is neither blank nor a comment.
#[inline]
fn starts_a_row(line: &[u8]) -> bool {
    match line.iter().find(|byte| !matches!(byte, b' ' | b'\t')) {
        Some(b'#' | b'%') | None => false,
        Some(_) => true,
    }
}

#[cfg(test)]
mod tests;
