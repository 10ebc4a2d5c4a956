//! Finds the header of a table and the places of the wanted columns.

use std::collections::VecDeque;

use super::fields::{self, Delimiter, Fields};
use super::stamps::{self, HEMISPHERES};
use super::wanted::{Column, Keep, Preview, TableOptions, starts_a_row};
use crate::error::{NAMES_SHOWN, the_file_has};
use crate::number;
use crate::skipped::{SkipKind, Skipped, shown};
use crate::source::{Source, without_byte_order_mark};
use crate::table::lines::{Lines, MAX_LINE, NextLine};
use crate::time::WeekClock;
use crate::{ReadError, angle, visible};
use undrift_base::nearby;

/// How to read the rows.
pub(super) struct TextLayout {
    pub(super) delimiter: Delimiter,
    /// Sorted by place: (index of the column, index in the row read).
    pub(super) wanted: Vec<(usize, usize)>,
    /// The lines read so far that are data, with their numbers.
    pub(super) rows: VecDeque<(u64, Vec<u8>)>,
    /// Number of names in the header, where columns are found by name.
    pub(super) names: Option<usize>,
    /// Whether latitude and longitude have columns of hemispheres behind them, which are wanted, too.
    pub(super) hemispheres: [bool; 2],
}

/// A line that may name the columns.
struct Header {
    line: u64,
    names: Vec<String>,
}

/// Columns with a number in them, beside text, for a text to be a table.
const NUMBERS: usize = 3;

/// Whether a text begins with a line of names, and the row below has a field for each of them and some numbers.
pub(crate) fn has_named_numbers(start: &[u8]) -> bool {
    let lines = start.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    let mut lines = lines.filter(|line| starts_a_row(line) && separator(line).is_none());
    let (Some(names), Some(row)) = (lines.next(), lines.next()) else {
        return false;
    };
    let delimiter = Delimiter::detect(names);
    let fields = |line| Fields::new(line, delimiter);
    let is_number = |field: &[u8]| number::parse(field).is_some();
    // A sentence without quotes is many fields.
    let before = |field: &&[u8]| !field.starts_with(b"$") || field.contains(&b',');
    !fields(names).any(is_number)
        && fields(names).count() <= fields(row).count()
        && fields(row)
            .take_while(before)
            .filter(|field| is_number(field))
            .count()
            >= NUMBERS
        && !fields(names).any(|name| name.starts_with(b"$"))
}

/// The separator that a first line `sep=;` names, as spreadsheets write it.
fn separator(line: &[u8]) -> Option<u8> {
    let line = line.trim_ascii();
    let line = line.strip_prefix(b"\"").unwrap_or(line);
    let (name, value) = line.split_at_checked(4)?;
    match value {
        [byte] | [byte, b'"', ..] if name.eq_ignore_ascii_case(b"sep=") => Some(*byte),
        // Behind it the fields of a table that was saved once more.
        [byte, rest @ ..] if name.eq_ignore_ascii_case(b"sep=") => {
            rest.iter().all(|other| other == byte).then_some(*byte)
        }
        // A tab, trimmed away.
        [] if name.eq_ignore_ascii_case(b"sep=") => Some(b'\t'),
        _ => None,
    }
}

pub(super) fn find(
    lines: &mut Lines,
    options: &TableOptions,
    skipped: &mut Skipped,
) -> Result<TextLayout, ReadError> {
    let FirstLine {
        number,
        line: first,
        comment,
        separator,
        mut rows,
    } = first_line(lines, options.header_lines, skipped)?;
    let delimiter = options
        .delimiter
        .or(separator)
        .map_or_else(|| Delimiter::detect(&first), Delimiter::from_byte);
    let by_name = |(_, column): &(String, Column)| matches!(column, Column::Name(_));
    let named = options.columns.iter().chain(options.date()).any(by_name);
    let has_text = Fields::new(&first, delimiter).any(is_text);
    let own = has_text.then(|| Header {
        line: number,
        names: names_of(&first, delimiter),
    });
    let above = comment.filter(|_| named).map(|(line, text)| Header {
        line,
        names: comment_names(&text, options.delimiter),
    });
    // Data with text in some column may stand under a comment that names the columns.
    let above = above.filter(|above| {
        own.as_ref()
            .is_none_or(|own| missing(own, options) && !missing(above, options))
    });
    let (mut wanted, is_row, names) = match (above, own) {
        (Some(above), _) => (above.places(options)?, true, None),
        (None, Some(own)) => {
            let wanted = own.places(options)?;
            // A line with a number wherever one is wanted by number is a row, not a header.
            let is_row = !named && reads_as_row(&first, delimiter, &wanted, options);
            (wanted, is_row, named.then_some(own.names.len()))
        }
        (None, None) => {
            let wanted = places(None, options).map_err(|error| error.at(number))?;
            (wanted, true, None)
        }
    };
    if is_row {
        rows.push_front((number, first));
    }
    let hemispheres = hemispheres(&mut wanted, options, delimiter, &rows);
    Ok(TextLayout {
        delimiter,
        wanted,
        rows,
        names,
        hemispheres,
    })
}

/// Whether the columns directly behind latitude and longitude are N or S, E or W in one of the first rows: wanted then, too.
fn hemispheres(
    wanted: &mut Vec<(usize, usize)>,
    options: &TableOptions,
    delimiter: Delimiter,
    rows: &VecDeque<(u64, Vec<u8>)>,
) -> [bool; 2] {
    let places = options.angles.map(|angles| angles.places());
    let mut places = places.into_iter().flatten();
    let behind = HEMISPHERES.map(|slot| {
        let place = places.next()?;
        let (column, _) = wanted.iter().find(|(_, other)| *other == place)?;
        let is_letter = |(_, row): &(u64, Vec<u8>)| {
            let field = Fields::new(row, delimiter).nth(column + 1);
            field.is_some_and(|field| angle::hemisphere(field).is_some())
        };
        rows.iter().any(is_letter).then_some((column + 1, slot))
    });
    wanted.extend(behind.into_iter().flatten());
    wanted.sort_unstable();
    behind.map(|column| column.is_some())
}

/// The first line that is neither blank nor comment.
struct FirstLine {
    number: u64,
    line: Vec<u8>,
    /// The comment directly before it, and its number.
    comment: Option<(u64, Vec<u8>)>,
    /// The separator that a line before it names.
    separator: Option<u8>,
    /// The lines behind it that were read.
    rows: VecDeque<(u64, Vec<u8>)>,
}

/// Lines before the first row of numbers that may be words: what a program says when it starts.
const WORDS: usize = 50;

/// Finds the first line behind so many. Lines of words before the header or the first row of numbers are passed over and counted.
fn first_line(
    lines: &mut Lines,
    behind: u64,
    skipped: &mut Skipped,
) -> Result<FirstLine, ReadError> {
    let mut comment = None;
    let mut named = None;
    let mut above: VecDeque<(u64, Vec<u8>)> = VecDeque::new();
    loop {
        match lines.step() {
            // A header that is made of the rows has the number 0.
            NextLine::Line(_) if (1..=behind).contains(&lines.number()) => {}
            NextLine::Line(range) => {
                let number = lines.number();
                let mut line = lines.bytes(range);
                if number == 1 {
                    line = without_byte_order_mark(line);
                }
                if let (None, true, Some(byte)) = (named, above.is_empty(), separator(line)) {
                    named = Some(byte);
                    continue;
                }
                if starts_a_row(line) {
                    above.push_back((number, line.to_vec()));
                    let delimiter =
                        named.map_or_else(|| Delimiter::detect(line), Delimiter::from_byte);
                    let is_number = |field: &&[u8]| number::parse(field).is_some();
                    let fields = |line| Fields::new(line, delimiter);
                    let is_row = fields(line).filter(is_number).count() >= NUMBERS;
                    if !is_row && above.len() < WORDS {
                        continue;
                    }
                    let width = if is_row { fields(line).count() } else { 0 };
                    let words = words(&above, delimiter, width);
                    for (number, line) in above.drain(..words) {
                        skipped.add(SkipKind::Text, number, shown(&line));
                    }
                    break;
                }
                // Comments below the first line are no names.
                if !line.trim_ascii().is_empty() && above.is_empty() {
                    comment = Some((number, line.to_vec()));
                }
            }
            NextLine::TooLong => {
                let detail = format_args!("over {MAX_LINE} bytes");
                skipped.add(SkipKind::TooLong, lines.number(), detail);
            }
            NextLine::End if !above.is_empty() => break,
            NextLine::End => {
                let problem = match lines.failure() {
                    Some(failure) => format!("cannot be read: {failure}"),
                    None if skipped.is_empty() => "no data".to_owned(),
                    None => {
                        let error = ReadError::nameless(format!("no row of data; {skipped}"));
                        return Err(error.mend("end each row with a line feed (LF or CR LF)"));
                    }
                };
                return Err(ReadError::nameless(problem));
            }
        }
    }
    let (number, line) = above.pop_front().unwrap_or_default();
    Ok(FirstLine {
        number,
        line,
        comment,
        separator: named,
        rows: above,
    })
}

/// How many of the lines above a row of so many fields are words: those before the first with as many fields; without one
/// those that have less than half.
fn words(above: &VecDeque<(u64, Vec<u8>)>, delimiter: Delimiter, width: usize) -> usize {
    let fields = |(_, line): &(u64, Vec<u8>)| Fields::new(line, delimiter).count();
    let before = above.len().saturating_sub(1);
    let header = above
        .iter()
        .take(before)
        .position(|line| fields(line) == width);
    header.unwrap_or_else(|| {
        above
            .iter()
            .take_while(|line| 2 * fields(line) < width)
            .count()
    })
}

fn is_text(field: &[u8]) -> bool {
    !field.is_empty() && number::parse(field).is_none()
}

fn names_of(line: &[u8], delimiter: Delimiter) -> Vec<String> {
    Fields::new(line, delimiter).map(name_of).collect()
}

/// A name as text: UTF-8, else Latin-1.
fn name_of(name: &[u8]) -> String {
    match std::str::from_utf8(name) {
        Ok(name) => name.to_owned(),
        Err(_) => name.iter().map(|byte| char::from(*byte)).collect(),
    }
}

/// The names in a comment line; its delimiter may be another than that of the data.
fn comment_names(comment: &[u8], delimiter: Option<u8>) -> Vec<String> {
    let mut text = comment.trim_ascii();
    while let [b'#' | b'%', rest @ ..] = text {
        text = rest;
    }
    let detected = Delimiter::detect(text);
    let asked = delimiter.filter(|byte| text.contains(byte));
    names_of(text, asked.map_or(detected, Delimiter::from_byte))
}

fn reads_as_row(
    line: &[u8],
    delimiter: Delimiter,
    wanted: &[(usize, usize)],
    options: &TableOptions,
) -> bool {
    let mut out = vec![0.0; options.columns.len()];
    let mut stamps = stamps::Stamps::from_options(options);
    let keep = options.optional.map_or(Keep::Finite, Keep::One);
    fields::parse_row(line, delimiter, wanted, keep, stamps.as_mut(), &mut out).is_ok()
}

fn missing(header: &Header, options: &TableOptions) -> bool {
    let mut all = options.columns.iter().chain(options.date());
    all.any(|(_, column)| match column {
        Column::Name(name) => !header.names.iter().any(|present| present == name.trim()),
        Column::Number(_) => false,
    })
}

impl Header {
    fn places(&self, options: &TableOptions) -> Result<Vec<(usize, usize)>, ReadError> {
        places(Some(&self.names), options).map_err(|error| error.at(self.line))
    }
}

/// Every wanted column, sorted by place: (index of the column, index in the row read).
pub(crate) fn places(
    names: Option<&[String]>,
    options: &TableOptions,
) -> Result<Vec<(usize, usize)>, ReadError> {
    let place = |(slot, (key, column)): (usize, &(String, Column))| {
        let error = |problem: String, mend: String| {
            let error = ReadError::nameless(problem);
            Err(error.key(key.as_str()).mend(mend))
        };
        let index = match (column, names) {
            (Column::Number(0), _) => {
                let problem = "column 0 requested".to_owned();
                return error(problem, "the first column is 1".to_owned());
            }
            (Column::Number(number), Some(names)) if *number > names.len() => {
                let problem = format!("no column {number}, there are {}", names.len());
                return error(problem, listing(names));
            }
            (Column::Number(number), _) => number - 1,
            (Column::Name(_), None) => {
                let problem = format!("no header, so there is no column {column}");
                let mend = "specify columns by number; the first is 1";
                return error(problem, mend.to_owned());
            }
            (Column::Name(name), Some(names)) => {
                let found = names.iter().enumerate();
                let mut found = found.filter(|(_, present)| *present == name.trim());
                match (found.next(), found.next()) {
                    (Some((index, _)), None) => index,
                    (Some((a, _)), Some((b, _))) => {
                        let (a, b) = (a + 1, b + 1);
                        let problem = format!("columns {a} and {b} are both called {column}");
                        return error(problem, "specify one by its number".to_owned());
                    }
                    (None, _) => {
                        let near = nearby::known(name.trim(), names.iter().map(String::as_str));
                        let near =
                            near.map_or(String::new(), |near| visible(&near).into_owned() + " ");
                        return error(format!("no column {column}"), near + &listing(names));
                    }
                }
            }
        };
        Ok((index, slot))
    };
    let all = options.columns.iter().chain(options.date());
    let places = all.enumerate().map(place);
    let mut places = places.collect::<Result<Vec<_>, _>>()?;
    places.sort_unstable();
    Ok(places)
}

fn listing(names: &[String]) -> String {
    let escaped = |name: &String| shown(name.as_bytes()).trim_matches('"').to_owned();
    let names: Vec<String> = names.iter().map(escaped).collect();
    the_file_has(&names, NAMES_SHOWN)
}

/// The names of the columns and up to `rows` rows of all of them.
///
/// # Errors
/// If there is no line.
pub(super) fn preview(source: Source, rows: usize) -> Result<Preview, ReadError> {
    let mut lines = Lines::of_table(source, None);
    let FirstLine {
        line: first,
        comment,
        separator,
        rows: behind,
        ..
    } = first_line(&mut lines, 0, &mut Skipped::default())?;
    let delimiter = separator.map_or_else(|| Delimiter::detect(&first), Delimiter::from_byte);
    let own = names_of(&first, delimiter);
    let above = comment.map_or(Vec::new(), |(_, text)| comment_names(&text, None));
    let of_time = |field: &[u8]| stamps::any(&mut WeekClock::default(), field);
    let is_number = |field: &[u8]| number::parse(field).or_else(|| of_time(field)).is_some();
    let is_header = !Fields::new(&first, delimiter).any(is_number);
    let has_text =
        Fields::new(&first, delimiter).any(|field| is_text(field) && of_time(field).is_none());
    let mut preview = Preview {
        header: if has_text { &own } else { &above }.clone(),
        names: if is_header { own } else { above },
        rows: Vec::new(),
        times: Vec::new(),
        texts: Vec::new(),
    };
    let mut weeks = WeekClock::default();
    let is_angle = |name: &String| {
        let name = name.to_ascii_lowercase();
        ["lat", "lon", "lng"]
            .iter()
            .any(|word| name.starts_with(word))
    };
    let angles: Vec<bool> = preview.names.iter().map(is_angle).collect();
    let mut numbers = |line: &[u8]| -> Vec<f64> {
        let mut number = |(place, field): (usize, &[u8])| {
            let degrees = || Some(angle::degrees(field)?.0);
            let parsed = number::parse(field).or_else(|| match angles.get(place) {
                Some(true) => degrees(),
                _ => stamps::any(&mut weeks, field).or_else(degrees),
            });
            parsed.unwrap_or(f64::NAN)
        };
        Fields::new(line, delimiter)
            .enumerate()
            .map(&mut number)
            .collect()
    };
    if !is_header {
        preview.rows.push(numbers(&first));
    }
    for (_, row) in &behind {
        preview.rows.push(numbers(row));
    }
    while preview.rows.len() < rows {
        match lines.step() {
            NextLine::Line(range) if starts_a_row(lines.bytes(range.clone())) => {
                preview.rows.push(numbers(lines.bytes(range)));
            }
            NextLine::Line(_) | NextLine::TooLong => {}
            NextLine::End => break,
        }
    }
    let row = if is_header {
        behind.back().map(|(_, row)| row)
    } else {
        Some(&first)
    };
    preview.texts = row.map_or(Vec::new(), |row| names_of(row, delimiter));
    let texts = row
        .into_iter()
        .flat_map(|row| Fields::new(row, delimiter).enumerate());
    let is_time = |(place, field): &(usize, &[u8])| {
        let text = number::parse(field).is_none() && angles.get(*place) != Some(&true);
        text && of_time(field).is_some()
    };
    preview.times = texts.filter(is_time).map(|(place, _)| place).collect();
    // A comment that is no header has another number of words than there are columns.
    let mut widths = preview.rows.iter().map(Vec::len);
    if !preview.rows.is_empty() && !widths.any(|width| width == preview.names.len()) {
        preview.names.clear();
    }
    Ok(preview)
}
