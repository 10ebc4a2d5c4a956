//! Cells that are no plain decimal numbers, as spreadsheets, programs and microcontrollers write them: decimal commas,
//! hexadecimal counts, exponents of Fortran, several numbers in one cell, and one number or time in several.
//!
//! The beginning of a text shows which there are. Each row is then rewritten: numbers with decimal points in their
//! places, and what is put together or taken apart in columns of its own behind the last, so that the numbers of the
//! others stay as they are.

mod joined;
mod numbers;
mod vectors;

use super::fields::Delimiter;
use super::wanted::starts_a_row;
use joined::Joined;
pub(super) use joined::of_day;
use numbers::Notation;
use vectors::Vectors;

/// Rows that are looked at.
const ROWS: usize = 200;
/// Cells that look like numbers or times, for a line to be a row.
const NUMBERS: usize = 3;

/// What is to be done with the cells of each row.
pub(crate) struct Cells {
    delimiter: Delimiter,
    /// Fields of a row.
    width: usize,
    /// The line that names the columns, and the one for it.
    header: Option<(Vec<u8>, Vec<u8>)>,
    notation: Notation,
    vectors: Vectors,
    joined: Vec<Joined>,
}

/// The beginning of a table: cells of its rows, and its names.
struct Beginning {
    delimiter: Delimiter,
    rows: Vec<Vec<Vec<u8>>>,
    /// The line of names, and these; none without.
    line: Vec<u8>,
    names: Vec<String>,
}

impl Cells {
    /// What the first lines show; `None` of a table as usual.
    pub(crate) fn detect(lines: &[Vec<u8>]) -> Option<Self> {
        let table = Beginning::of_lines(lines)?;
        let notation = Notation::detect(&table);
        let vectors = Vectors::detect(&table);
        let joined = Joined::detect(&table);
        if !notation.any() && vectors.is_empty() && joined.is_empty() {
            return None;
        }
        let header = (!table.names.is_empty()).then(|| {
            let behind = vectors.names(&table.names);
            let joined = joined.iter().filter_map(Joined::name);
            let names = table.names.iter().cloned().chain(behind);
            let names = names.chain(joined.map(str::to_owned));
            let names = names.map(|name| match table.delimiter {
                Delimiter::Byte(b',') => name.into_bytes(),
                // A comma would be taken for the separator.
                _ => name.replace(", ", " ").replace(',', " ").into_bytes(),
            });
            (table.line.clone(), written(names, table.delimiter))
        });
        Some(Self {
            delimiter: table.delimiter,
            width: table.rows.first().map_or(0, Vec::len),
            header,
            notation,
            vectors,
            joined,
        })
    }

    /// A line with its cells as numbers; `None` of one that stays as it is.
    pub(crate) fn row(&self, line: &[u8]) -> Option<Vec<u8>> {
        if let Some((names, rewritten)) = &self.header
            && names == line.trim_ascii()
        {
            return Some(rewritten.clone());
        }
        let mut cells = Vec::from_iter(split(line, self.delimiter));
        if !starts_a_row(line) || cells.len() != self.width {
            return None;
        }
        let behind = self.vectors.numbers(&cells);
        for (place, cell) in cells.iter_mut().enumerate() {
            if let Some(number) = self.notation.number(place, cell) {
                *cell = number;
            }
        }
        for joined in &self.joined {
            joined.put(&mut cells);
        }
        let times = Vec::from_iter(self.joined.iter().filter_map(|joined| joined.time(&cells)));
        cells.extend(behind);
        cells.extend(times);
        Some(written(cells.into_iter(), self.delimiter))
    }
}

impl Beginning {
    fn of_lines(lines: &[Vec<u8>]) -> Option<Self> {
        let lines = Vec::from_iter(lines.iter().map(|line| line.trim_ascii()));
        let first = lines.iter().position(|line| looks_like_a_row(line))?;
        let delimiter = Delimiter::detect(lines.get(first)?);
        let cells = |line: &&[u8]| Vec::from_iter(split(line, delimiter));
        let behind = lines.iter().skip(first).filter(|line| starts_a_row(line));
        let mut rows = Vec::from_iter(behind.take(ROWS).map(cells));
        let width = rows.first().map_or(0, Vec::len);
        rows.retain(|row| row.len() == width);
        // The names may be a comment, and words or units be between them and the rows.
        let named = lines.iter().take(first).rev().find_map(|line| {
            let mut bare = *line;
            while let [b'#' | b'%', rest @ ..] = bare {
                bare = rest.trim_ascii();
            }
            let delimiters = [delimiter, Delimiter::detect(bare)];
            let names = delimiters
                .map(|delimiter| Vec::from_iter(split(bare, delimiter).map(|name| name_of(&name))));
            let names = names.into_iter().find(|names| names.len() == width)?;
            let is_name = |name: &&String| name.chars().any(char::is_alphabetic);
            (2 * names.iter().filter(is_name).count() > width).then(|| (line.to_vec(), names))
        });
        let (line, names) = named.unwrap_or_default();
        Some(Self {
            delimiter,
            rows,
            line,
            names,
        })
    }

    /// The cells of a column.
    fn column(&self, place: usize) -> impl Iterator<Item = &[u8]> + Clone {
        self.rows
            .iter()
            .filter_map(move |row| row.get(place).map(Vec::as_slice))
    }

    /// The numbers of a column, with decimal points or commas; `None` where a cell is not a number.
    fn numbers(&self, place: usize) -> Option<Vec<f64>> {
        self.column(place)
            .map(crate::number::parse_with_comma)
            .collect()
    }
}

fn looks_like_a_row(line: &[u8]) -> bool {
    if !starts_a_row(line) {
        return false;
    }
    let like_a_number = |cell: &Vec<u8>| {
        crate::number::parse_with_comma(cell).is_some()
            || numbers::hexadecimal(cell).is_some()
            || numbers::of_fortran(cell).is_some()
            || numbers::is_bare(cell)
            || super::stamps::any(&mut crate::time::WeekClock::default(), cell).is_some()
    };
    let count = |cell: Vec<u8>| {
        let several = || vectors::numbers_of(&cell).map_or(0, |(numbers, _)| numbers.len());
        if like_a_number(&cell) { 1 } else { several() }
    };
    let found: usize = split(line, Delimiter::detect(line)).map(count).sum();
    found >= NUMBERS
}

/// A name as text: UTF-8, else Latin-1.
fn name_of(name: &[u8]) -> String {
    match std::str::from_utf8(name) {
        Ok(name) => name.to_owned(),
        Err(_) => name.iter().map(|byte| char::from(*byte)).collect(),
    }
}

/// The cells of a line without their quotes; what is between brackets or quotes is one.
fn split(line: &[u8], delimiter: Delimiter) -> impl Iterator<Item = Vec<u8>> {
    let ends = move |byte: u8| match delimiter {
        Delimiter::Byte(delimiter) => byte == delimiter,
        Delimiter::Blanks => matches!(byte, b' ' | b'\t'),
    };
    let (mut cells, mut cell, mut depth, mut quoted) = (Vec::new(), Vec::new(), 0_u32, false);
    for &byte in line {
        match byte {
            b'"' => quoted = !quoted,
            b'[' | b'(' => depth += 1,
            b']' | b')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if ends(byte) && !quoted && depth == 0 {
            cells.push(std::mem::take(&mut cell));
        } else {
            cell.push(byte);
        }
    }
    cells.push(cell);
    let bare = |cell: Vec<u8>| {
        let cell = cell.trim_ascii();
        let bare = cell.strip_prefix(b"\"").and_then(|c| c.strip_suffix(b"\""));
        bare.map_or(cell, <[u8]>::trim_ascii).to_vec()
    };
    let cells = cells.into_iter().map(bare);
    cells.filter(move |cell| delimiter != Delimiter::Blanks || !cell.is_empty())
}

/// A line of cells, with quotes where they have the delimiter in them.
fn written(cells: impl Iterator<Item = Vec<u8>>, delimiter: Delimiter) -> Vec<u8> {
    let byte = match delimiter {
        Delimiter::Byte(byte) => byte,
        Delimiter::Blanks => b' ',
    };
    let mut line = Vec::new();
    for (place, cell) in cells.enumerate() {
        if place > 0 {
            line.push(byte);
        }
        let quoted = cell.contains(&byte) && !cell.contains(&b'"');
        line.extend(quoted.then_some(b'"'));
        line.extend(cell);
        line.extend(quoted.then_some(b'"'));
    }
    line
}

#[cfg(test)]
mod tests;
