//! Delimited text, row by row.

use std::collections::VecDeque;

use super::fields::{self, Delimiter};
use super::header;
use super::stamps::Stamps;
use super::wanted::{Keep, NextRow, TableOptions, starts_a_row};
use crate::ReadError;
use crate::epoch::Epoch;
use crate::skipped::Skipped;
use crate::source::Source;
use crate::table::lines::{self, Lines};

/// Reads the wanted columns of a text.
pub(super) struct TextTable {
    lines: Lines,
    delimiter: Delimiter,
    /// Wanted columns by place in the line: (index of the column, index in the row read).
    wanted: Vec<(usize, usize)>,
    /// The first lines of data, found while looking for the header, with their numbers.
    held: VecDeque<(u64, Vec<u8>)>,
    /// Number of names in the header, until a row was compared with it.
    names: Option<usize>,
    /// Makes times of texts.
    stamps: Option<Stamps>,
}

impl TextTable {
    /// Finds the wanted columns of a stream; without its beginning, so much of it is read first.
    ///
    /// # Errors
    /// If there is no line, or a wanted column is missing.
    pub(super) fn new(
        source: Source,
        beginning: Option<&[u8]>,
        options: &TableOptions,
        skipped: &mut Skipped,
    ) -> Result<Self, ReadError> {
        let mut lines = Lines::of_table(source, beginning);
        let layout = header::find(&mut lines, options, skipped)?;
        let mut stamps = Stamps::from_options(options);
        if let Some(stamps) = &mut stamps {
            stamps.hemispheres = layout.hemispheres;
        }
        Ok(Self {
            lines,
            delimiter: layout.delimiter,
            wanted: layout.wanted,
            held: layout.rows,
            names: layout.names,
            stamps,
        })
    }

    /// What the dates read so far count from.
    pub(super) fn epoch(&self) -> Option<Epoch> {
        self.stamps.as_ref()?.epoch()
    }

    /// Reads the next row into `out`, in the order of the wanted columns.
    ///
    /// # Errors
    /// If the first row has more fields than the header has names.
    #[inline]
    pub(super) fn step(&mut self, keep: Keep, out: &mut [f64]) -> Result<NextRow, ReadError> {
        let delimiter = self.delimiter;
        if let Some((line, first)) = self.held.pop_front() {
            if let Some(names) = self.names.take() {
                fits(&first, delimiter, names).map_err(|error| error.at(line))?;
            }
            let parsed = fields::parse_row(
                &first,
                delimiter,
                &self.wanted,
                keep,
                self.stamps.as_mut(),
                out,
            );
            return Ok(NextRow::Row(line, parsed));
        }
        loop {
            let range = match self.lines.step() {
                lines::NextLine::Line(range) => range,
                lines::NextLine::TooLong => return Ok(NextRow::TooLong(self.lines.number())),
                lines::NextLine::End => {
                    let failure = self.lines.failure().map(ToString::to_string);
                    return Ok(NextRow::End(failure.map(|why| (self.lines.number(), why))));
                }
            };
            let line = self.lines.number();
            let bytes = self.lines.bytes(range);
            if !starts_a_row(bytes) {
                continue;
            }
            if let Some(names) = self.names.take() {
                fits(bytes, delimiter, names).map_err(|error| error.at(line))?;
            }
            let parsed = fields::parse_row(
                bytes,
                delimiter,
                &self.wanted,
                keep,
                self.stamps.as_mut(),
                out,
            );
            return Ok(NextRow::Row(line, parsed));
        }
    }
}

/// Whether a row has no more fields than its header names; empty ones at the end do not count.
fn fits(row: &[u8], delimiter: Delimiter, names: usize) -> Result<(), ReadError> {
    let last = fields::Fields::new(row, delimiter)
        .enumerate()
        .filter(|(_, field)| !field.is_empty())
        .last();
    let Some(fields) = last.map(|(k, _)| k + 1).filter(|fields| *fields > names) else {
        return Ok(());
    };
    if fields == 2 * names && matches!(delimiter, Delimiter::Byte(b',')) {
        let problem = format!("{fields} fields, twice the header's {names}");
        let mend = "commas are both separators and decimal marks: export with decimal points";
        return Err(ReadError::nameless(problem).mend(mend));
    }
    let problem = format!(
        "{fields} fields, but the header has {names}: decimal commas, or an unnamed column"
    );
    let mend = "export with decimal points, or specify columns by number";
    Err(ReadError::nameless(problem).mend(mend))
}
