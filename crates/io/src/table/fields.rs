//! One line, field by field.

use super::stamps::Stamps;
use super::wanted::{Defect, Keep};
use crate::number;
use crate::skipped::shown;

/// The separator of fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Delimiter {
    /// One byte; fields may be empty.
    Byte(u8),
    /// Runs of blanks and tabs.
    Blanks,
}

impl Delimiter {
    /// The likeliest one of a line. Commas that are decimal marks within fields do not count.
    pub(crate) fn detect(line: &[u8]) -> Self {
        let others = [Self::Byte(b';'), Self::Byte(b'\t'), Self::Blanks];
        if let Some(other) = others
            .into_iter()
            .find(|other| has_decimal_commas(line, *other))
        {
            return other;
        }
        let usual = [b',', b';', b'\t'];
        // `t; 48.1, 11.5; 520`: commas within fields.
        let count = |of: u8| line.iter().filter(|byte| **byte == of).count();
        if count(b';') >= FIELDS - 1 && count(b',') < count(b';') {
            return Self::Byte(b';');
        }
        let bars = line.split(|byte| *byte == b'|');
        let bars = bars.filter(|field| !field.trim_ascii().is_empty()).count();
        match usual.into_iter().find(|byte| line.contains(byte)) {
            Some(byte) => Self::Byte(byte),
            None if bars >= FIELDS => Self::Byte(b'|'),
            None => Self::Blanks,
        }
    }

    pub(crate) fn from_byte(byte: u8) -> Self {
        if byte == b' ' {
            Self::Blanks
        } else {
            Self::Byte(byte)
        }
    }

    #[inline]
    fn ends(self, byte: u8) -> bool {
        match self {
            Self::Byte(delimiter) => byte == delimiter,
            Self::Blanks => matches!(byte, b' ' | b'\t'),
        }
    }

    /// What begins with a field: without the rest of a run of blanks.
    #[inline]
    fn without_run(self, mut bytes: &[u8]) -> &[u8] {
        while let (Self::Blanks, [b' ' | b'\t', rest @ ..]) = (self, bytes) {
            bytes = rest;
        }
        bytes
    }

    /// Whether the byte is padding inside a field's bounds.
    #[inline]
    fn pads(self, byte: u8) -> bool {
        byte == b' ' || (byte == b'\t' && !self.ends(byte))
    }
}

/// Walks along the fields of a line.
#[derive(Clone)]
pub(crate) struct Fields<'a> {
    line: &'a [u8],
    at: usize,
    delimiter: Delimiter,
    /// The last field has been given.
    done: bool,
}

impl<'a> Fields<'a> {
    #[inline]
    pub(crate) fn new(line: &'a [u8], delimiter: Delimiter) -> Self {
        Self {
            line,
            at: 0,
            delimiter,
            done: false,
        }
    }

    /// Goes to the first byte of the next field that is no padding; false if there is no field.
    #[inline]
    fn start(&mut self) -> bool {
        if self.done {
            return false;
        }
        while let Some(&byte) = self.line.get(self.at) {
            if byte > b' ' || !matches!(byte, b' ' | b'\t') {
                break;
            }
            if byte == b'\t' && self.delimiter == Delimiter::Byte(b'\t') {
                break;
            }
            self.at += 1;
        }
        if self.delimiter == Delimiter::Blanks && self.at >= self.line.len() {
            self.done = true;
            return false;
        }
        true
    }

    /// Steps over the delimiter at `end`.
    #[inline]
    fn leave(&mut self, end: usize) {
        self.done = end >= self.line.len();
        self.at = end + 1;
    }

    /// End of the field that starts at `at`: the next delimiter outside quotes.
    #[inline]
    fn end_of_field(&self) -> usize {
        let mut end = self.at;
        if self.line.get(end) == Some(&b'"')
            && let Some(length) = self.line[end + 1..].iter().position(|&byte| byte == b'"')
        {
            end += 1 + length;
        }
        while let Some(&byte) = self.line.get(end) {
            if self.delimiter.ends(byte) {
                break;
            }
            end += 1;
        }
        end
    }

    /// Passes over a field; false if there is none.
    #[inline]
    fn pass(&mut self) -> bool {
        if !self.start() {
            return false;
        }
        let end = self.end_of_field();
        self.leave(end);
        true
    }

    /// The number in the next field: `None` if there is no field, `Err` with the field's text if
    /// it is no number.
    #[inline]
    fn number(&mut self) -> Option<Result<f64, &'a [u8]>> {
        if !self.start() {
            return None;
        }
        let rest = self.line.get(self.at..).unwrap_or_default();
        if let Some((value, length)) = number::parse_prefix(rest) {
            let mut end = self.at + length;
            while let Some(&byte) = self.line.get(end) {
                if self.delimiter.ends(byte) {
                    break;
                }
                if !self.delimiter.pads(byte) {
                    return Some(self.unusual());
                }
                end += 1;
            }
            self.leave(end);
            return Some(Ok(value));
        }
        Some(self.unusual())
    }

    /// A field that is quoted, text, empty or not finite.
    #[cold]
    fn unusual(&mut self) -> Result<f64, &'a [u8]> {
        let text = self.next().unwrap_or_default();
        number::parse(text).ok_or(text)
    }
}

/// The fields' text, trimmed and without quotes.
impl<'a> Iterator for Fields<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        if !self.start() {
            return None;
        }
        let end = self.end_of_field();
        let text = self.line.get(self.at..end).unwrap_or_default();
        self.leave(end);
        let text = text.trim_ascii();
        let bare = text.strip_prefix(b"\"").and_then(|t| t.strip_suffix(b"\""));
        Some(bare.map_or(text, <[u8]>::trim_ascii))
    }
}

/// Fields of a line whose commas are decimal marks, at least.
const FIELDS: usize = 3;

/// Whether a line has commas, no field between these delimiters more than one, and each between digits.
fn has_decimal_commas(line: &[u8], delimiter: Delimiter) -> bool {
    let is_decimal = |field: &[u8]| {
        let mut parts = field.split(|byte| *byte == b',');
        let (whole, fraction) = (parts.next().unwrap_or_default(), parts.next());
        let digit = |byte: Option<&u8>| byte.is_some_and(u8::is_ascii_digit);
        let is = |fraction: &[u8]| digit(whole.last()) && digit(fraction.first());
        parts.next().is_none() && fraction.is_none_or(is)
    };
    line.contains(&b',')
        && Fields::new(line, delimiter).count() >= FIELDS
        && Fields::new(line, delimiter).all(is_decimal)
}

/// Reads the wanted columns, which are sorted by place, of one line.
#[inline]
pub(crate) fn parse_row(
    line: &[u8],
    delimiter: Delimiter,
    wanted: &[(usize, usize)],
    keep: Keep,
    stamps: Option<&mut Stamps>,
    out: &mut [f64],
) -> Result<(), Defect> {
    if parse_plain_row(line, delimiter, wanted, out) {
        return Ok(());
    }
    parse_any_row(line, delimiter, wanted, keep, stamps, out)
}

/// The usual row: finite numbers without padding or quotes. False if it is not one, or lacks a
/// column; `out` is then filled in part.
#[inline]
fn parse_plain_row(
    line: &[u8],
    delimiter: Delimiter,
    wanted: &[(usize, usize)],
    out: &mut [f64],
) -> bool {
    let mut rest = delimiter.without_run(line);
    let mut column = 0;
    let mut last = 0.0;
    for &(target, slot) in wanted {
        while column < target {
            let is_end = |&byte: &u8| delimiter.ends(byte) || byte == b'"';
            match rest.iter().position(is_end) {
                Some(end) if rest[end] != b'"' => rest = delimiter.without_run(&rest[end + 1..]),
                _ => return false,
            }
            column += 1;
        }
        if column == target {
            let Some((value, length)) = number::parse_prefix(rest) else {
                return false;
            };
            rest = match rest.get(length..) {
                Some([byte, rest @ ..]) if delimiter.ends(*byte) => delimiter.without_run(rest),
                Some([]) => &[],
                _ => return false,
            };
            if !value.is_finite() {
                return false;
            }
            last = value;
            column += 1;
        }
        match out.get_mut(slot) {
            Some(place) => *place = last,
            None => return false,
        }
    }
    true
}

/// Any row, whatever is wrong with it.
fn parse_any_row(
    line: &[u8],
    delimiter: Delimiter,
    wanted: &[(usize, usize)],
    keep: Keep,
    mut stamps: Option<&mut Stamps>,
    out: &mut [f64],
) -> Result<(), Defect> {
    let mut fields = Fields::new(line, delimiter);
    let mut column = 0;
    let mut last = f64::NAN;
    let mut any = false;
    if let Some(stamps) = stamps.as_mut() {
        stamps.start();
    }
    for &(target, slot) in wanted {
        while column < target {
            if !fields.pass() {
                return Err(too_few(column, target));
            }
            column += 1;
        }
        // A column that is wanted twice has been read already.
        if column == target {
            last = match fields.number() {
                Some(Ok(value)) if value.is_finite() || keep.keeps(slot) => {
                    if let Some(stamps) = stamps.as_mut() {
                        stamps.number(slot, value);
                    }
                    value
                }
                Some(Ok(value)) => {
                    let column = target + 1;
                    return Err(Defect::NotFinite {
                        value,
                        column,
                        slot,
                    });
                }
                Some(Err(b"")) if !any && is_blank(line, delimiter, wanted, stamps.as_deref()) => {
                    return Err(Defect::Blank { column: target + 1 });
                }
                Some(Err(b"")) if keep.keeps(slot) => f64::NAN,
                Some(Err(b"")) => return Err(Defect::Empty { column: target + 1 }),
                Some(Err(_)) if keep.optional(slot) => f64::NAN,
                Some(Err(text)) => {
                    let time = stamps.as_mut().and_then(|stamps| stamps.read(slot, text));
                    time.ok_or_else(|| Defect::Text(shown(text)))?
                }
                None => return Err(too_few(column, target)),
            };
            any |= !last.is_nan() && !stamps.as_ref().is_some_and(|stamps| stamps.is_time(slot));
            column += 1;
        }
        if let Some(place) = out.get_mut(slot) {
            *place = last;
        }
    }
    stamps.map_or(Ok(()), |stamps| stamps.finish(out))
}

/// Whether a row has nothing in all wanted columns but the times, and something in others: it is of another sensor in the same table.
#[cold]
fn is_blank(
    line: &[u8],
    delimiter: Delimiter,
    wanted: &[(usize, usize)],
    stamps: Option<&Stamps>,
) -> bool {
    let is_time = |slot| stamps.is_some_and(|stamps| stamps.is_time(slot));
    let mut wanted = wanted.iter().peekable();
    let mut others = false;
    for (column, field) in Fields::new(line, delimiter).enumerate() {
        let mut is_other = true;
        while let Some((_, slot)) = wanted.next_if(|(target, _)| *target == column) {
            is_other = false;
            if !field.is_empty() && !is_time(*slot) {
                return false;
            }
        }
        others |= is_other && !field.is_empty();
    }
    others && wanted.next().is_none()
}

#[cold]
fn too_few(fields: usize, target: usize) -> Defect {
    Defect::TooFew {
        fields,
        wanted: target + 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skipped::SkipKind;

    fn texts(line: &str, delimiter: Delimiter) -> Vec<&str> {
        Fields::new(line.as_bytes(), delimiter)
            .map(|field| std::str::from_utf8(field).unwrap())
            .collect()
    }

    #[test]
    fn splitting() {
        let comma = Delimiter::Byte(b',');
        assert_eq!(texts("a, b ,,\"c,d\",", comma), ["a", "b", "", "c,d", ""]);
        assert_eq!(texts("\"open,1", comma), ["\"open", "1"]);
        assert_eq!(texts("  1 2\t 3  ", Delimiter::Blanks), ["1", "2", "3"]);
        assert_eq!(
            texts("\t1\t\t2", Delimiter::Byte(b'\t')),
            ["", "1", "", "2"]
        );
        assert_eq!(Delimiter::detect(b"1;2"), Delimiter::Byte(b';'));
        assert_eq!(Delimiter::detect(b"1 2"), Delimiter::Blanks);
        // Decimal commas, and commas between fields.
        for (line, expected) in [
            ("2025-07-08T19:34:18,749;40.1;-105.1", Delimiter::Byte(b';')),
            ("1,5;2,5;3", Delimiter::Byte(b';')),
            ("19:34:18,749\t1\t2", Delimiter::Byte(b'\t')),
            ("19:34:18,749 1 2", Delimiter::Blanks),
            ("2025-07-08 19:34:18,1,2,3", comma),
            ("1;48.1, 11.5;520", Delimiter::Byte(b';')),
            ("1,2;x,y;z", comma),
            ("1, 2, 3", comma),
            ("1,2 3,4", comma),
            ("\"19:34:18,749\",1,2", comma),
        ] {
            assert_eq!(Delimiter::detect(line.as_bytes()), expected, "{line}");
        }
    }

    #[test]
    fn rows_and_their_defects() {
        let comma = Delimiter::Byte(b',');
        let wanted = [(0, 1), (2, 0), (2, 2)];
        let row = |line: &str, keep| {
            let mut out = [0.0; 3];
            parse_row(line.as_bytes(), comma, &wanted, keep, None, &mut out).map(|()| out)
        };
        assert_eq!(row("1,x,-2.5e1,z", Keep::Finite), Ok([-25.0, 1.0, -25.0]));
        assert_eq!(row(" 1 ,x,\" 3 \"", Keep::Finite), Ok([3.0, 1.0, 3.0]));
        assert_eq!(
            row("1,x,3y", Keep::Finite),
            Err(Defect::Text("\"3y\"".into()))
        );
        assert_eq!(row("1,x,", Keep::Finite), Err(Defect::Empty { column: 3 }));
        assert_eq!(
            row("1,x", Keep::Finite),
            Err(Defect::TooFew {
                fields: 2,
                wanted: 3
            })
        );
        assert_eq!(
            row("1,x,inf", Keep::Finite),
            Err(Defect::NotFinite {
                value: f64::INFINITY,
                column: 3,
                slot: 0
            })
        );
        assert_eq!(
            row("1,x,1e999", Keep::Finite).unwrap_err().kind(),
            SkipKind::NotFinite
        );
        assert!(row("1,x,", Keep::All).unwrap()[0].is_nan());
        assert!(row("nan,x,4", Keep::All).unwrap()[1].is_nan());
    }

    #[test]
    fn the_short_way_agrees_with_the_long_one() {
        let pieces = [
            "1.5", "-2e3", "7", "8.", "", " ", "4 ", "\"5\"", "\"a,b\"", "x", "nan", "1e999", "\"",
            "\t6",
        ];
        let wanted = [(0, 2), (2, 0), (2, 3), (3, 1)];
        for (delimiter, between) in [(Delimiter::Byte(b','), ','), (Delimiter::Blanks, ' ')] {
            let (mut state, mut plain) = (1u64, 0);
            for _ in 0..100_000 {
                let mut line = String::new();
                for k in 0..6 {
                    state = state
                        .wrapping_mul(6_364_136_223_846_793_005)
                        .wrapping_add(1);
                    if k > 0 {
                        line.push(between);
                    }
                    line += pieces[(state >> 33) as usize % pieces.len()];
                }
                let (mut short, mut long) = ([0.0; 4], [0.0; 4]);
                let bytes = line.as_bytes();
                if parse_plain_row(bytes, delimiter, &wanted, &mut short) {
                    let other =
                        parse_any_row(bytes, delimiter, &wanted, Keep::Finite, None, &mut long);
                    assert_eq!((other, short), (Ok(()), long), "{line}");
                    plain += 1;
                }
            }
            assert!(plain > 1000, "{delimiter:?}: {plain}");
        }
    }
}
