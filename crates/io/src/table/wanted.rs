//! What is wanted of a table, and what its kinds have in common.

use std::fmt;

use undrift_nav::Vector3;

use crate::ReadError;
use crate::skipped::{SkipKind, Skipped};

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
    /// Lines at the beginning of a text that are passed over, uncounted.
    pub header_lines: u64,
    /// Hand on rows with NaN, infinity or an empty field (as NaN) instead of skipping them.
    pub keep_not_finite: bool,
    /// Pass over rows, uncounted, that have nothing in all of the columns but a time, and something in others: of another sensor.
    pub of_one_sensor: bool,
    /// The one of the columns that may have no number in a row: it is NaN there.
    pub optional: Option<usize>,
    /// Which of the columns has times, that may be text.
    pub stamp: Option<Stamp>,
    /// Which of them are latitude and longitude, that may be text or have a column N or S, E or W directly behind. Read where
    /// there are times.
    pub angles: Option<Angles>,
}

/// Columns of latitude and longitude, in degrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Angles {
    /// Place of the latitude among the wanted columns; that of the longitude is the next.
    pub place: usize,
    /// The numbers are degrees times 100 and minutes, ddmm.mmmm.
    pub minutes: bool,
}

/// Which columns of a row may be without a finite number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Keep {
    /// None.
    Finite,
    /// All: what is not finite is handed on, what is empty is NaN.
    All,
    /// The one at this place of the row read, where text is NaN too.
    One(usize),
}

impl Keep {
    pub(super) fn keeps(self, slot: usize) -> bool {
        self == Self::All || self.optional(slot)
    }

    /// Whether a column may have anything.
    pub(super) fn optional(self, slot: usize) -> bool {
        self == Self::One(slot)
    }
}

/// A column of times: numbers, dates with times of day, or times of day.
#[derive(Clone, Debug)]
pub struct Stamp {
    /// Its place among the wanted columns.
    pub place: usize,
    /// Its name, or its number.
    pub column: String,
    /// Factor from its numbers to seconds; texts are divided by it.
    pub scale: f64,
    /// The column of dates `yyyy-mm-dd` where it has times of day alone, or of GPS weeks, and the key that asks for that.
    pub date: Option<(String, Column)>,
}

impl TableOptions {
    /// Finite numbers alone, between fields as stated.
    pub(crate) fn finite(delimiter: Option<u8>) -> Self {
        Self {
            delimiter,
            ..Self::default()
        }
    }

    /// Wants more columns for a key; the place of the first of them in the row read.
    pub(crate) fn want<'a>(
        &mut self,
        key: &str,
        columns: impl IntoIterator<Item = &'a Column>,
    ) -> usize {
        let from = self.columns.len();
        let keyed = columns.into_iter().map(|c| (key.to_owned(), c.clone()));
        self.columns.extend(keyed);
        from
    }

    /// Wants the column of times, `time` of a table of the drive file, with that of dates.
    pub(crate) fn want_time(
        &mut self,
        table: &str,
        time: &Column,
        date: Option<&Column>,
        scale: f64,
    ) {
        let place = self.want(&format!("{table}.time"), [time]);
        let date = date.map(|column| (format!("{table}.date"), column.clone()));
        self.stamp = Some(Stamp {
            place,
            column: time.to_string(),
            scale,
            date,
        });
    }

    /// Latitudes and longitudes from a place of the row read on may be text, where their unit is the degree.
    pub(crate) fn want_angles(&mut self, place: usize, scale: f64, minutes: bool) {
        let of_degrees = scale == 1f64.to_radians();
        self.angles = of_degrees.then_some(Angles { place, minutes });
    }

    pub(super) fn keep(&self) -> Keep {
        match self.optional {
            _ if self.keep_not_finite => Keep::All,
            Some(place) => Keep::One(place),
            None => Keep::Finite,
        }
    }

    /// The date's column, which has no place in the row read.
    pub(super) fn date(&self) -> Option<&(String, Column)> {
        self.stamp.as_ref()?.date.as_ref()
    }
}

/// Why a row cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Defect {
    Text(String),
    TooFew {
        fields: usize,
        wanted: usize,
    },
    Empty {
        column: usize,
    },
    /// Nothing but a time: of the columns wanted this is the first.
    Blank {
        column: usize,
    },
    /// Its column's number, and its place in the row read.
    NotFinite {
        value: f64,
        column: usize,
        slot: usize,
    },
}

impl Defect {
    pub(crate) fn kind(&self) -> SkipKind {
        match self {
            Self::Text(_) => SkipKind::Text,
            Self::TooFew { .. } | Self::Empty { .. } | Self::Blank { .. } => SkipKind::MissingField,
            Self::NotFinite { .. } => SkipKind::NotFinite,
        }
    }
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => f.write_str(text),
            Self::TooFew { fields, wanted } => {
                write!(f, "{fields} fields, but column {wanted} is needed")
            }
            Self::Empty { column } | Self::Blank { column } => {
                write!(f, "column {column} is empty")
            }
            Self::NotFinite { value, column, .. } => write!(f, "{value} in column {column}"),
        }
    }
}

/// Puts numbers into a row, each with its place there and its column's index; `None` is an empty field.
pub(super) fn fill(
    out: &mut [f64],
    keep: Keep,
    numbers: impl Iterator<Item = (usize, usize, Option<f64>)>,
) -> Result<(), Defect> {
    for (slot, index, number) in numbers {
        let number = match number {
            Some(number) if number.is_finite() || keep.keeps(slot) => number,
            Some(value) => {
                let column = index + 1;
                return Err(Defect::NotFinite {
                    value,
                    column,
                    slot,
                });
            }
            None if keep.keeps(slot) => f64::NAN,
            None => return Err(Defect::Empty { column: index + 1 }),
        };
        if let Some(place) = out.get_mut(slot) {
            *place = number;
        }
    }
    Ok(())
}

/// Three numbers of a row from a place on; NaN beyond its end.
pub(crate) fn three(row: &[f64], from: usize) -> Vector3 {
    let get = |k: usize| row.get(from + k).copied().unwrap_or(f64::NAN);
    Vector3::new(get(0), get(1), get(2))
}

/// Whether a factor on a time column makes times.
///
/// # Errors
/// If it is not above zero.
pub(crate) fn check_time_scale(scale: f64, key: &str) -> Result<(), ReadError> {
    if scale.is_finite() && scale > 0.0 {
        return Ok(());
    }
    let problem = format!("invalid time scale: {scale}");
    Err(ReadError::nameless(problem).key(key))
}

/// The beginning of a table.
#[derive(Clone, Debug, Default)]
pub struct Preview {
    /// Names in the header line or, where that is data, in the comment directly before it; empty where
    /// neither names anything.
    pub header: Vec<String>,
    /// Names of the columns: those, if there are as many as columns.
    pub names: Vec<String>,
    /// The first rows, of every column; NaN where there is no number.
    pub rows: Vec<Vec<f64>>,
    /// Places of the columns whose first field is a date with a time of day, or a time of day.
    pub times: Vec<usize>,
    /// The fields of the first row as texts; none of Parquet and of columns in memory.
    pub texts: Vec<String>,
}

impl Preview {
    /// Where in the header and in a row a column is, from 0; `None` of a name that the header lacks.
    pub fn place(&self, column: &Column) -> Option<usize> {
        match column {
            Column::Number(number) => number.checked_sub(1),
            Column::Name(name) => self.header.iter().position(|known| known == name),
        }
    }
}

/// What comes next in a table.
pub(super) enum NextRow {
    /// The row with this line or number, read or not.
    Row(u64, Result<(), Defect>),
    /// A line that is too long to be a row.
    TooLong(u64),
    /// Nothing more; where and why, if the file breaks off.
    End(Option<(u64, String)>),
}

/// Whether a line is neither blank nor a comment.
#[inline]
pub(super) fn starts_a_row(line: &[u8]) -> bool {
    match line.iter().find(|byte| !matches!(byte, b' ' | b'\t')) {
        Some(b'#' | b'%') | None => false,
        Some(_) => true,
    }
}

/// Why a table without one usable row cannot be used.
pub(super) fn no_rows(seen: u64, skipped: &Skipped) -> ReadError {
    let mend = skipped.in_one_line();
    let text = skipped.iter().find(|(kind, _)| *kind == SkipKind::Text);
    let is_decimal = |text: &str| {
        let text = text.trim_matches('"');
        text.contains(',') && text.replacen(',', ".", 1).parse::<f64>().is_ok()
    };
    let (problem, mend) = match text {
        _ if seen == 0 && mend.is_empty() => (
            "no data, only a header or comments",
            "record or export it again".to_owned(),
        ),
        _ if seen == 0 => ("no row of data", mend),
        Some((_, entry)) if is_decimal(&entry.first_detail) => {
            ("decimal commas", format!("write decimal points: {mend}"))
        }
        _ => ("no row with a number in every required column", mend),
    };
    ReadError::nameless(problem).mend(mend)
}
