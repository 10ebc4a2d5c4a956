//! Finds the header of a table and the places of the wanted columns.

use super::fields::{self, Delimiter, Fields};
use super::wanted::{Column, Preview, TableOptions, starts_a_row};
use crate::ReadError;
use crate::lines::{Lines, MAX_LINE, Step};
use crate::number;
use crate::skipped::{SkipKind, Skipped, shown};
use crate::source::Source;

/// Names listed in a message at most.
const NAMES_SHOWN: usize = 60;

/// How to read the rows.
pub(super) struct Layout {
    pub(super) delimiter: Delimiter,
    /// Sorted by place: (index of the column, index in the row read).
    pub(super) wanted: Vec<(usize, usize)>,
    /// The line stepped to last, if it is data.
    pub(super) first_row: Option<Vec<u8>>,
    /// Number of names in the header, where columns are found by name.
    pub(super) names: Option<usize>,
}

/// A line that may name the columns.
struct Header {
    line: u64,
    names: Vec<String>,
}

pub(super) fn find(
    lines: &mut Lines,
    options: &TableOptions,
    skipped: &mut Skipped,
) -> Result<Layout, ReadError> {
    let (first, comment) = first_line(lines, skipped)?;
    let delimiter = options
        .delimiter
        .map_or_else(|| Delimiter::detect(&first), Delimiter::of);
    let by_name = |(_, column): &(String, Column)| matches!(column, Column::Name(_));
    let named = options.columns.iter().any(by_name);

    let has_text = Fields::new(&first, delimiter).any(is_text);
    let own = has_text.then(|| Header {
        line: lines.number(),
        names: names_of(&first, delimiter),
    });
    let above = comment.filter(|_| named).map(|(line, text)| Header {
        line,
        names: comment_names(&text, options.delimiter),
    });

    let first_row = || Some(first.clone());
    match (&own, &above) {
        // Data with text in some column, under a comment that names the columns.
        (Some(own), Some(above)) if missing(own, options) && !missing(above, options) => {
            let wanted = above.places(options)?;
            layout(delimiter, wanted, first_row())
        }
        (Some(own), _) => {
            let wanted = own.places(options)?;
            // A line with a number wherever one is wanted by number is a row, not a header.
            let is_row = !named && reads_as_row(&first, delimiter, &wanted);
            let layout = layout(delimiter, wanted, first_row().filter(|_| is_row))?;
            Ok(Layout {
                names: named.then_some(own.names.len()),
                ..layout
            })
        }
        (None, Some(above)) => {
            let wanted = above.places(options)?;
            layout(delimiter, wanted, first_row())
        }
        (None, None) if named => Err(no_header(lines.number(), options)),
        (None, None) => {
            let wanted = numbered(options)?;
            layout(delimiter, wanted, first_row())
        }
    }
}

fn layout(
    delimiter: Delimiter,
    mut wanted: Vec<(usize, usize)>,
    first_row: Option<Vec<u8>>,
) -> Result<Layout, ReadError> {
    wanted.sort_unstable();
    Ok(Layout {
        delimiter,
        wanted,
        first_row,
        names: None,
    })
}

/// The first line that is neither blank nor comment, and the comment directly before it.
type FirstLine = (Vec<u8>, Option<(u64, Vec<u8>)>);

fn first_line(lines: &mut Lines, skipped: &mut Skipped) -> Result<FirstLine, ReadError> {
    let mut comment = None;
    loop {
        match lines.step() {
            Step::Line(range) => {
                let number = lines.number();
                let mut line = lines.bytes(range);
                if number == 1 {
                    if line.starts_with(&[0xff, 0xfe]) || line.starts_with(&[0xfe, 0xff]) {
                        return Err(ReadError::nameless("is UTF-16 text").mend("save it as UTF-8"));
                    }
                    line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line);
                }
                if starts_a_row(line) {
                    return Ok((line.to_vec(), comment));
                }
                if !line.trim_ascii().is_empty() {
                    comment = Some((number, line.to_vec()));
                }
            }
            Step::TooLong => {
                let detail = format_args!("over {MAX_LINE} bytes");
                skipped.add(SkipKind::TooLong, lines.number(), detail);
            }
            Step::End => {
                let problem = match lines.failure() {
                    Some(failure) => format!("cannot be read: {failure}"),
                    None if skipped.is_empty() => "no row of data".to_owned(),
                    None => format!("no row of data; {skipped}"),
                };
                return Err(ReadError::nameless(problem));
            }
        }
    }
}

fn is_text(field: &[u8]) -> bool {
    !field.is_empty() && number::parse(field).is_none()
}

fn names_of(line: &[u8], delimiter: Delimiter) -> Vec<String> {
    Fields::new(line, delimiter)
        .map(|name| String::from_utf8_lossy(name).into_owned())
        .collect()
}

/// The names in a comment line; its delimiter may be another than that of the data.
fn comment_names(comment: &[u8], delimiter: Option<u8>) -> Vec<String> {
    let mut text = comment.trim_ascii();
    while let [b'#' | b'%', rest @ ..] = text {
        text = rest;
    }
    let detected = Delimiter::detect(text);
    let asked = delimiter.filter(|byte| text.contains(byte));
    names_of(text, asked.map_or(detected, Delimiter::of))
}

fn reads_as_row(line: &[u8], delimiter: Delimiter, wanted: &[(usize, usize)]) -> bool {
    let mut sorted = wanted.to_vec();
    sorted.sort_unstable();
    let mut out = vec![0.0; wanted.len()];
    fields::parse_row(line, delimiter, &sorted, false, &mut out).is_ok()
}

fn missing(header: &Header, options: &TableOptions) -> bool {
    options.columns.iter().any(|(_, column)| match column {
        Column::Name(name) => !header.names.iter().any(|present| present == name.trim()),
        Column::Number(_) => false,
    })
}

impl Header {
    fn places(&self, options: &TableOptions) -> Result<Vec<(usize, usize)>, ReadError> {
        places(&self.names, options).map_err(|error| error.at(self.line))
    }
}

/// Every wanted column, in the order they are wanted: (index of the column, index in the row read).
pub(crate) fn places(
    names: &[String],
    options: &TableOptions,
) -> Result<Vec<(usize, usize)>, ReadError> {
    let place = |(slot, (key, column)): (usize, &(String, Column))| {
        let error = |problem: String| ReadError::nameless(problem).key(key).mend(listing(names));
        let index = match column {
            Column::Number(number) => {
                let index = index_of(key, *number)?;
                if index >= names.len() {
                    let has = names.len();
                    return Err(error(format!("no column {number}, there are {has}")));
                }
                index
            }
            Column::Name(name) => {
                let mut found = names.iter().enumerate();
                let mut found = found
                    .by_ref()
                    .filter(|(_, present)| *present == name.trim());
                match (found.next(), found.next()) {
                    (Some((index, _)), None) => index,
                    (Some((a, _)), Some((b, _))) => {
                        let (a, b) = (a + 1, b + 1);
                        let problem = format!("columns {a} and {b} are both called {column}");
                        return Err(error(problem).mend("ask for one by its number"));
                    }
                    (None, _) => return Err(error(format!("no column {column}"))),
                }
            }
        };
        Ok((index, slot))
    };
    options.columns.iter().enumerate().map(place).collect()
}

/// Wanted columns that are all given by number.
fn numbered(options: &TableOptions) -> Result<Vec<(usize, usize)>, ReadError> {
    let mut wanted = Vec::with_capacity(options.columns.len());
    for (slot, (key, column)) in options.columns.iter().enumerate() {
        if let Column::Number(number) = column {
            wanted.push((index_of(key, *number)?, slot));
        }
    }
    Ok(wanted)
}

fn index_of(key: &str, number: usize) -> Result<usize, ReadError> {
    number.checked_sub(1).ok_or_else(|| {
        ReadError::nameless("column 0 is asked for")
            .key(key)
            .mend("the first column is 1")
    })
}

fn no_header(line: u64, options: &TableOptions) -> ReadError {
    let named = options
        .columns
        .iter()
        .find_map(|(key, column)| match column {
            Column::Name(_) => Some((key, column)),
            Column::Number(_) => None,
        });
    let error = ReadError::nameless("").at(line);
    match named {
        Some((key, column)) => ReadError {
            problem: format!("no header that could name the column {column}"),
            ..error
        }
        .key(key)
        .mend("ask for columns by number, the first is 1"),
        None => error,
    }
}

fn listing(names: &[String]) -> String {
    let mut list: Vec<String> = names
        .iter()
        .take(NAMES_SHOWN)
        .map(|name| {
            let quoted = shown(name.as_bytes());
            quoted.trim_matches('"').to_owned()
        })
        .collect();
    if names.len() > NAMES_SHOWN {
        list.push(format!("… ({} columns)", names.len()));
    }
    format!("the file has: {}", list.join(", "))
}

/// The names of the columns and up to `rows` rows of all of them.
///
/// # Errors
/// If there is no line.
pub(super) fn preview(source: Source, rows: usize) -> Result<Preview, ReadError> {
    let mut lines = Lines::new(source);
    let (first, comment) = first_line(&mut lines, &mut Skipped::default())?;
    let delimiter = Delimiter::detect(&first);
    let own = names_of(&first, delimiter);
    let above = comment.map_or(Vec::new(), |(_, text)| comment_names(&text, None));
    let is_header = Fields::new(&first, delimiter).all(|field| number::parse(field).is_none());
    let has_text = Fields::new(&first, delimiter).any(is_text);
    let mut preview = Preview {
        header: if has_text { &own } else { &above }.clone(),
        names: if is_header { own } else { above },
        rows: Vec::new(),
    };
    let numbers = |line: &[u8]| -> Vec<f64> {
        let fields = Fields::new(line, delimiter);
        fields
            .map(|field| number::parse(field).unwrap_or(f64::NAN))
            .collect()
    };
    if !is_header {
        preview.rows.push(numbers(&first));
    }
    while preview.rows.len() < rows {
        match lines.step() {
            Step::Line(range) if starts_a_row(lines.bytes(range.clone())) => {
                preview.rows.push(numbers(lines.bytes(range)));
            }
            Step::Line(_) | Step::TooLong => {}
            Step::End => break,
        }
    }
    // A comment that is no header has another number of words than there are columns.
    let width = preview.rows.first().map_or(0, Vec::len);
    if preview.names.len() != width && width > 0 {
        preview.names.clear();
    }
    Ok(preview)
}
