//! Numbers that are written with a decimal comma, in hexadecimal or with the exponent of Fortran.

use super::Beginning;
use crate::number;
use crate::table::fields::Delimiter;

/// Which notations a table has beside the usual one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Notation {
    commas: bool,
    hexadecimal: bool,
    /// Of each column, whether it has hexadecimal counts without `0x`; empty without such columns.
    bare: Vec<bool>,
    fortran: bool,
}

impl Notation {
    pub(super) fn detect(table: &Beginning) -> Self {
        let cells = || table.rows.iter().flatten().map(Vec::as_slice);
        let has_point = |cell: &[u8]| cell.contains(&b'.') && number::parse(cell).is_some();
        // `1,234` may be a number of thousands, `0,234` and `1,23` may not.
        let is_certain = |cell: &[u8]| {
            comma(cell).is_some_and(|at| {
                let digit = |byte: &&u8| byte.is_ascii_digit();
                let after = cell.iter().skip(at + 1).take_while(digit).count();
                let unsigned = cell.iter().position(u8::is_ascii_digit).unwrap_or(at);
                after != 3 || cell.get(unsigned) == Some(&b'0') || at - unsigned > 3
            })
        };
        let quoted = table.delimiter == Delimiter::Byte(b',');
        let several = |cell: &[u8]| quoted && comma(cell).is_none() && cell.contains(&b',');
        Self {
            commas: cells().any(is_certain) && !cells().any(has_point) && !cells().any(several),
            hexadecimal: cells().any(|cell| hexadecimal(cell).is_some()),
            bare: bare(table),
            fortran: cells().any(|cell| of_fortran(cell).is_some()),
        }
    }

    pub(super) fn any(&self) -> bool {
        self.commas || self.hexadecimal || self.fortran || !self.bare.is_empty()
    }

    /// A cell of a column as a decimal number; `None` of any other.
    pub(super) fn number(&self, place: usize, cell: &[u8]) -> Option<Vec<u8>> {
        if self.bare.get(place) == Some(&true) {
            return Some(count(cell)?.to_string().into_bytes());
        }
        let commas = || {
            let mut point = cell.to_vec();
            *point.get_mut(comma(cell)?)? = b'.';
            Some(point)
        };
        let of_hexadecimal = || Some(hexadecimal(cell)?.to_string().into_bytes());
        let commas = self.commas.then(commas).flatten();
        let found = commas.or_else(|| self.hexadecimal.then(of_hexadecimal).flatten());
        found.or_else(|| self.fortran.then(|| of_fortran(cell)).flatten())
    }
}

/// Where the decimal comma of a cell is; `None` where it is not one number with a comma in it.
fn comma(cell: &[u8]) -> Option<usize> {
    let at = cell.iter().position(|byte| *byte == b',')?;
    let digit = |place: Option<usize>| Some(cell.get(place?)?.is_ascii_digit());
    let between = digit(at.checked_sub(1))? && digit(Some(at + 1))?;
    (between && number::parse_with_comma(cell).is_some()).then_some(at)
}

/// A count of 16 or, with more than four digits, 32 bits, with its sign: `0xFFEB`.
pub(super) fn hexadecimal(cell: &[u8]) -> Option<i64> {
    count(cell.strip_prefix(b"0x").or(cell.strip_prefix(b"0X"))?)
}

/// The same of its digits.
fn count(digits: &[u8]) -> Option<i64> {
    let digits = std::str::from_utf8(digits).ok()?;
    let bits = match digits.len() {
        1..=4 => 16,
        5..=8 => 32,
        _ => return None,
    };
    let count = i64::from(u32::from_str_radix(digits, 16).ok()?);
    Some(if count >> (bits - 1) == 0 {
        count
    } else {
        count - (1 << bits)
    })
}

/// Columns of such counts, at least.
const COLUMNS: usize = 3;

/// Which columns have counts of four or eight digits without `0x`: all as wide, with letters in some, or with zeros in front beside columns
/// that have letters.
fn bare(table: &Beginning) -> Vec<bool> {
    let width = table.rows.first().map_or(0, Vec::len);
    let alike = |place: usize| {
        let first = table.column(place).next().map_or(0, <[u8]>::len);
        table
            .column(place)
            .all(|cell| cell.len() == first && is_bare(cell))
    };
    // `1e30` alone is a number.
    let surely = |cell: &[u8]| number::parse(cell).is_none();
    let sure = (0..width).filter(|place| alike(*place) && table.column(*place).any(surely));
    if sure.count() < COLUMNS - 1 {
        return Vec::new();
    }
    let letters = |cell: &[u8]| cell.iter().any(u8::is_ascii_alphabetic);
    let likely = |cell: &[u8]| letters(cell) || cell.first() == Some(&b'0');
    let of_counts = |place| alike(place) && table.column(place).any(likely);
    let all = Vec::from_iter((0..width).map(of_counts));
    let are_enough = all.iter().filter(|of| **of).count() >= COLUMNS;
    if are_enough { all } else { Vec::new() }
}

/// Whether a cell can be such a count.
pub(super) fn is_bare(cell: &[u8]) -> bool {
    matches!(cell.len(), 4 | 8) && cell.iter().all(u8::is_ascii_hexdigit)
}

/// A number with the exponent of a double of Fortran as others write it: `-5.4D-03`.
pub(super) fn of_fortran(cell: &[u8]) -> Option<Vec<u8>> {
    let at = cell
        .iter()
        .position(|byte| matches!(byte, b'D' | b'd'))
        .filter(|at| *at > 0)?;
    let mut usual = cell.to_vec();
    *usual.get_mut(at)? = b'e';
    number::parse(&usual).map(|_| usual)
}
