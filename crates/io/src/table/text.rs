//! Delimited text, row by row.

use std::path::{Path, PathBuf};

use super::fields::{self, Defect, Delimiter};
use super::{TableOptions, header, no_rows, starts_a_row};
use crate::ReadError;
use crate::lines::{Lines, MAX_LINE, Step};
use crate::skipped::{SkipKind, Skipped};
use crate::source::Source;

/// Reads the wanted columns of a text.
pub(super) struct TextTable {
    path: PathBuf,
    lines: Lines,
    delimiter: Delimiter,
    /// Wanted columns by place in the line: (index of the column, index in the row read).
    wanted: Vec<(usize, usize)>,
    pub(super) width: usize,
    keep_not_finite: bool,
    /// The first line of data, found while looking for the header.
    held: Option<Vec<u8>>,
    /// Number of names in the header, until a row was compared with it.
    names: Option<usize>,
    rows_read: u64,
    rows_seen: u64,
    finished: bool,
    skipped: Skipped,
}

impl TextTable {
    /// Reads a table from any stream; `path` is what messages call it.
    ///
    /// # Errors
    /// If there is no line, or a wanted column is missing.
    pub(super) fn from_source(
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
            names: layout.names,
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
    pub(super) fn next_row(&mut self, out: &mut [f64]) -> Result<Option<u64>, ReadError> {
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
            if let Some(names) = self.names.take() {
                fits(bytes, delimiter, names).map_err(|problem| {
                    let error = ReadError::new(&self.path, problem).at(line);
                    error.mend("write numbers with points, or ask for columns by number")
                })?;
            }
            let parsed = fields::parse_row(bytes, delimiter, &self.wanted, keep, out);
            if self.accept(parsed, line) {
                return Ok(Some(line));
            }
        }
        Ok(None)
    }

    /// What was left out so far.
    pub(super) fn skipped(&self) -> &Skipped {
        &self.skipped
    }

    /// The file as it was given.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Rows met so far, the skipped ones included.
    pub(super) fn rows_seen(&self) -> u64 {
        self.rows_seen
    }

    pub(super) fn skipped_mut(&mut self) -> &mut Skipped {
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

/// Whether a row has no more fields than its header names; empty ones at the end do not count.
fn fits(row: &[u8], delimiter: Delimiter, names: usize) -> Result<(), String> {
    let last = fields::Fields::new(row, delimiter)
        .enumerate()
        .filter(|(_, field)| !field.is_empty())
        .last();
    match last {
        Some((k, _)) if k >= names => Err(format!(
            "the row has {} fields, the header names {names}: decimal commas, or a column without a name",
            k + 1
        )),
        _ => Ok(()),
    }
}
