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

mod columns;
mod fields;
mod header;
mod text;
pub use columns::Columns;
use columns::MemoryTable;
pub(crate) use header::places;

use std::fmt;
use std::io::BufRead;
use std::path::Path;

use crate::ReadError;
#[cfg(feature = "parquet")]
use crate::parquet::ParquetTable;
use crate::skipped::{SkipKind, Skipped};
use crate::source::{self, Source};
use text::TextTable;

pub(crate) use fields::{Defect, shown};

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

/// What a table is read from.
pub enum TableSource {
    /// A stream of delimited text, or a file that begins as Parquet does.
    Stream(Source),
    /// Columns in memory.
    Columns(Columns),
}

impl<R: BufRead + Send + 'static> From<R> for TableSource {
    fn from(stream: R) -> Self {
        Self::Stream(Box::new(stream))
    }
}

impl From<Columns> for TableSource {
    fn from(columns: Columns) -> Self {
        Self::Columns(columns)
    }
}

/// Reads the wanted columns of a table row by row.
pub struct Table {
    rows: Rows,
}

/// Boxed: a reader holds its place in the file and a row.
enum Rows {
    Text(Box<TextTable>),
    Memory(Box<MemoryTable>),
    #[cfg(feature = "parquet")]
    Parquet(Box<ParquetTable>),
}

impl Table {
    /// Opens a table, text plain or gzip, or Parquet, and finds the wanted columns.
    ///
    /// # Errors
    /// If the file cannot be opened, has no line, or lacks a wanted column.
    pub fn open(path: &Path, options: &TableOptions) -> Result<Self, ReadError> {
        Self::from_source(path, source::open(path)?, options)
    }

    /// Reads a table from any stream of text or from columns in memory; `path` is what messages call it,
    /// and where Parquet, which is read from its end, is opened.
    ///
    /// # Errors
    /// If there is no line, or a wanted column is missing.
    pub fn from_source(
        path: &Path,
        source: impl Into<TableSource>,
        options: &TableOptions,
    ) -> Result<Self, ReadError> {
        let rows = match source.into() {
            TableSource::Columns(columns) => {
                Rows::Memory(Box::new(MemoryTable::new(path, columns, options)?))
            }
            TableSource::Stream(mut source) => match begins_as_parquet(&mut source) {
                true => parquet_rows(path, options)?,
                false => Rows::Text(Box::new(TextTable::from_source(path, source, options)?)),
            },
        };
        Ok(Self { rows })
    }

    /// Reads the next usable row into `out`, in the order of the wanted columns, and gives its
    /// line number, or that of the row in Parquet and in memory; `None` at the end.
    ///
    /// # Errors
    /// If the file ends without one usable row, or `out` has another length than there are wanted
    /// columns.
    #[inline]
    pub fn next_row(&mut self, out: &mut [f64]) -> Result<Option<u64>, ReadError> {
        match &mut self.rows {
            Rows::Text(table) => table.next_row(out),
            Rows::Memory(table) => table.next_row(out),
            #[cfg(feature = "parquet")]
            Rows::Parquet(table) => table.next_row(out),
        }
    }

    /// What was left out so far.
    pub fn skipped(&self) -> &Skipped {
        match &self.rows {
            Rows::Text(table) => table.skipped(),
            Rows::Memory(table) => table.skipped(),
            #[cfg(feature = "parquet")]
            Rows::Parquet(table) => table.skipped(),
        }
    }

    /// The file as it was given, or what columns in memory are called.
    pub fn path(&self) -> &Path {
        match &self.rows {
            Rows::Text(table) => table.path(),
            Rows::Memory(table) => table.path(),
            #[cfg(feature = "parquet")]
            Rows::Parquet(table) => table.path(),
        }
    }

    /// Rows met so far, the skipped ones included.
    pub fn rows_seen(&self) -> u64 {
        match &self.rows {
            Rows::Text(table) => table.rows_seen(),
            Rows::Memory(table) => table.rows_seen(),
            #[cfg(feature = "parquet")]
            Rows::Parquet(table) => table.rows_seen(),
        }
    }

    pub(crate) fn skipped_mut(&mut self) -> &mut Skipped {
        match &mut self.rows {
            Rows::Text(table) => table.skipped_mut(),
            Rows::Memory(table) => table.skipped_mut(),
            #[cfg(feature = "parquet")]
            Rows::Parquet(table) => table.skipped_mut(),
        }
    }
}

/// Whether a file that starts so is Parquet.
pub(crate) fn is_parquet(start: &[u8]) -> bool {
    start.starts_with(b"PAR1")
}

/// Whether a stream begins as Parquet does; what cannot be read shows when it is.
fn begins_as_parquet(source: &mut Source) -> bool {
    source.fill_buf().is_ok_and(is_parquet)
}

#[cfg(feature = "parquet")]
fn parquet_rows(path: &Path, options: &TableOptions) -> Result<Rows, ReadError> {
    ParquetTable::open(path, options).map(|table| Rows::Parquet(Box::new(table)))
}

#[cfg(not(feature = "parquet"))]
fn parquet_rows(path: &Path, _options: &TableOptions) -> Result<Rows, ReadError> {
    Err(no_parquet(path))
}

/// The error of a build without Parquet.
#[cfg(not(feature = "parquet"))]
fn no_parquet(path: &Path) -> ReadError {
    ReadError::new(path, "this build does not read Parquet").mend("build with the feature parquet")
}

/// Names of the columns of a table: of its header line or, where that is data, the comment directly
/// before it, or of Parquet's schema; empty where nothing names them.
///
/// # Errors
/// If the file cannot be opened or has no line.
pub fn header_names(path: &Path) -> Result<Vec<String>, ReadError> {
    if begins_as_parquet(&mut source::open(path)?) {
        #[cfg(feature = "parquet")]
        return crate::parquet::column_names(path);
        #[cfg(not(feature = "parquet"))]
        return Err(no_parquet(path));
    }
    header::header_names(path)
}

/// The beginning of a table.
#[derive(Clone, Debug, Default)]
pub struct Preview {
    /// Names of the columns; empty where nothing names them.
    pub names: Vec<String>,
    /// The first rows, of every column; NaN where there is no number.
    pub rows: Vec<Vec<f64>>,
}

/// The names of the columns and up to `rows` rows of all of them.
///
/// # Errors
/// If the file cannot be opened or has no line.
pub fn preview(path: &Path, rows: usize) -> Result<Preview, ReadError> {
    if begins_as_parquet(&mut source::open(path)?) {
        #[cfg(feature = "parquet")]
        return crate::parquet::preview(path, rows);
        #[cfg(not(feature = "parquet"))]
        return Err(no_parquet(path));
    }
    header::preview(path, rows)
}

/// Why a table without one usable row cannot be used.
pub(crate) fn no_rows(path: &Path, seen: u64, skipped: &Skipped) -> ReadError {
    let problem = if seen == 0 {
        "no row of data"
    } else {
        "no row with a number in every wanted column"
    };
    let mut mend = skipped.to_string().replace('\n', "; ");
    let text = skipped.iter().find(|(kind, _)| *kind == SkipKind::Text);
    let is_decimal = |text: &str| {
        let text = text.trim_matches('"');
        text.contains(',') && text.replacen(',', ".", 1).parse::<f64>().is_ok()
    };
    if text.is_some_and(|(_, entry)| is_decimal(&entry.first_detail)) {
        mend += "; write numbers with decimal points";
    }
    ReadError::new(path, problem).mend(mend)
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
