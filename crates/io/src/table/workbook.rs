//! Workbooks of spreadsheets, `.xlsx` and the older `.xls`, as text: the sheets that are tables of numbers, several of them with times as one
//! table, see [`parts`](super::parts).
//!
//! A date is written as such, a time of day as h:m:s, a duration in seconds.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use calamine::{Data, ExcelDateTime, ExcelDateTimeType, Reader, Xls, Xlsx};

use super::parts::{Part, joined};
use crate::number;
use crate::source::{LONGEST_HELD, Source, converted};

/// Columns of a sheet.
const COLUMNS: u32 = 1024;
/// Rows that show whether a sheet is a table, and numbers in one of them.
const ROWS: usize = 200;
const NUMBERS: usize = 2;

/// Whether a file begins as a workbook may.
pub(crate) fn may_be(start: &[u8]) -> bool {
    start.starts_with(b"PK\x03\x04") || start.starts_with(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1")
}

/// The table as text; the file itself where it is no workbook or has no table.
pub(crate) fn table(source: Source, _: &[u8]) -> Source {
    converted(source, |bytes| {
        // Damaged files can make the crate panic.
        let read = || text_of(bytes);
        catch_unwind(AssertUnwindSafe(read)).ok().flatten()
    })
}

fn text_of(bytes: &[u8]) -> Option<String> {
    let sheets = match bytes.starts_with(b"PK") {
        true => of_xlsx(bytes)?,
        false => of_xls(bytes)?,
    };
    let tables = Vec::from_iter(sheets.into_iter().filter_map(Sheet::table));
    let first = tables.first()?;
    let names = first.names.join(",");
    let rows = first.rows.iter().map(|(_, row)| row.as_str());
    let lines = Some(names.as_str()).filter(|names| !names.is_empty());
    let alone: String = lines
        .into_iter()
        .chain(rows)
        .flat_map(|line| [line, "\n"])
        .collect();
    Some(joined(tables, false).unwrap_or(alone))
}

/// A sheet: its rows, as cells.
struct Sheet {
    name: String,
    rows: Vec<Vec<String>>,
    /// The row that is being read, and the bytes of all.
    row: u32,
    bytes: usize,
}

impl Sheet {
    fn new(name: &str) -> Self {
        let (rows, row, bytes) = (vec![Vec::new()], 0, 0);
        Self {
            name: name.to_owned(),
            rows,
            row,
            bytes,
        }
    }

    /// Puts a cell; whether there is room for more.
    fn put(&mut self, (row, column): (u32, u32), text: String) -> bool {
        if row != self.row {
            self.row = row;
            self.rows.push(Vec::new());
        }
        if let (Some(cells), true) = (self.rows.last_mut(), column < COLUMNS && !text.is_empty()) {
            self.bytes += text.len() + 1;
            if cells.len() <= column as usize {
                cells.resize(column as usize + 1, String::new());
            }
            cells[column as usize] = text;
        }
        self.bytes < LONGEST_HELD as usize
    }

    /// The table that it is, if most of its rows have numbers: what is above them are words, and the last of it names.
    fn table(mut self) -> Option<Part> {
        self.rows.retain(|row| !row.is_empty());
        let numbers = |row: &Vec<String>| {
            let is_number = |cell: &&String| {
                number::parse(cell.as_bytes()).is_some()
                    || cell.starts_with(|c: char| c.is_ascii_digit())
            };
            row.iter().filter(is_number).count()
        };
        let first = self.rows.iter().position(|row| numbers(row) >= NUMBERS)?;
        let rows = self.rows.split_off(first);
        let shown = rows.iter().take(ROWS);
        let of_numbers = shown.clone().filter(|row| numbers(row) >= NUMBERS).count();
        if of_numbers < 2 || 2 * of_numbers < shown.count() {
            return None;
        }
        let names = self.rows.pop().filter(|names| names.len() > 1);
        let rows = rows.into_iter().map(|row| row.join(","));
        Some(Part {
            name: self.name,
            names: names.unwrap_or_default(),
            rows: rows.enumerate().collect(),
        })
    }
}

fn of_xlsx(bytes: &[u8]) -> Option<Vec<Sheet>> {
    let mut book = Xlsx::new(Cursor::new(bytes)).ok()?;
    let later = book.has_1904_epoch();
    let sheets = book.sheet_names().into_iter().filter_map(|name| {
        let mut cells = book.worksheet_cells_reader(&name).ok()?;
        let mut sheet = Sheet::new(&name);
        // What is before a damage is read.
        while let Ok(Some(cell)) = cells.next_cell() {
            let text = text_of_cell(&Data::from(cell.get_value().clone()), later);
            if !sheet.put(cell.get_position(), text) {
                break;
            }
        }
        Some(sheet)
    });
    Some(sheets.collect())
}

fn of_xls(bytes: &[u8]) -> Option<Vec<Sheet>> {
    let mut book = Xls::new(Cursor::new(bytes)).ok()?;
    let sheets = book.worksheets().into_iter().map(|(name, range)| {
        let mut sheet = Sheet::new(&name);
        for (row, column, value) in range.used_cells() {
            let place = (row as u32, column as u32);
            if !sheet.put(place, text_of_cell(value, false)) {
                break;
            }
        }
        sheet
    });
    Some(sheets.collect())
}

/// What a cell is as text without commas.
fn text_of_cell(value: &Data, later: bool) -> String {
    match value {
        Data::Int(number) => number.to_string(),
        Data::Float(number) => number.to_string(),
        Data::Bool(yes) => u8::from(*yes).to_string(),
        Data::DateTime(time) => text_of_time(time, later),
        Data::String(text) | Data::DateTimeIso(text) | Data::DurationIso(text) => plain(text),
        Data::Error(_) | Data::Empty => String::new(),
    }
}

/// A text in one line; a comma in a number is its decimal mark.
fn plain(text: &str) -> String {
    let text = text.replace(['\n', '\r', '"'], " ");
    let with_point = text.replace(',', ".");
    match number::parse(with_point.as_bytes()) {
        Some(_) => with_point,
        None => text.replace(',', " "),
    }
}

/// Days from 1 January 1904 to 30 December 1899, from which days are counted.
const LATER: f64 = 1462.0;
const MICROS: f64 = 86_400e6;

fn text_of_time(time: &ExcelDateTime, later: bool) -> String {
    let days = time.as_f64();
    if time.is_duration() {
        return ((days * MICROS).round() / 1e6).to_string();
    }
    // As fine as days of this century are counted.
    let micros = 10.0 * (days * MICROS / 10.0).round();
    let of_day = micros.rem_euclid(MICROS);
    let seconds = (of_day / 1e6).floor();
    let [hour, minute, second] =
        [seconds / 3600.0, seconds / 60.0 % 60.0, seconds % 60.0].map(f64::floor);
    let clock = format!(
        "{hour:02}:{minute:02}:{second:02}.{:06}",
        of_day - 1e6 * seconds
    );
    let day = (micros / MICROS).floor() + if later { LATER } else { 0.0 };
    let (year, month, date, ..) =
        ExcelDateTime::new(day, ExcelDateTimeType::DateTime, false).to_ymd_hms_milli();
    match (days < 1.0, of_day == 0.0) {
        (true, _) => clock,
        (false, true) => format!("{year:04}-{month:02}-{date:02}"),
        (false, false) => format!("{year:04}-{month:02}-{date:02}T{clock}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;
    use std::path::Path;

    fn golden(name: &str) -> Vec<u8> {
        let folder =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/golden/formats/workbook");
        std::fs::read(folder.join(name)).unwrap()
    }

    fn lines(name: &str) -> Vec<String> {
        let text = text_of(&golden(name)).unwrap();
        text.lines().map(str::to_owned).collect()
    }

    /// As the script beside the files writes them.
    #[test]
    fn sheets_with_times_are_one_table() {
        let lines = lines("sheets.xlsx");
        assert_eq!(
            lines[0],
            "Time (s),Gyroscope x (rad/s),Gyroscope y (rad/s),Gyroscope z (rad/s),Accelerometer x (m/s^2),Accelerometer y (m/s^2),Accelerometer z (m/s^2),Latitude (°),Longitude (°),Height (m)"
        );
        assert_eq!(
            lines[1..4],
            [
                "0.01,0.5,1.5,2.5,9,10,11,,,",
                "0.03,0.625,1.625,2.625,,,,,,",
                "0.05,0.75,1.75,2.75,9.125,10.125,11.125,48.125,11.5,520.25",
            ]
        );
        assert_eq!(lines.len(), 1 + 12);
        assert_eq!(
            lines[11],
            "0.21,1.75,2.75,3.75,9.625,10.625,11.625,48.25,11.625,521"
        );
    }

    #[test]
    fn dates_durations_and_texts_are_as_in_a_csv() {
        for name in ["dates.xlsx", "later.xlsx"] {
            assert_eq!(
                lines(name),
                [
                    "date,time,elapsed,lat,note,on",
                    "2025-07-08T23:59:59.000000,23:59:59.000000,90000,48.125,,1",
                    "2025-07-08T23:59:59.625000,23:59:59.625000,90001,49.125,a  b,0",
                    "2025-07-09T00:00:00.250000,00:00:00.250000,90002,50.125,a  b,1",
                    "2025-07-09T00:00:00.875000,00:00:00.875000,90003,51.125,a  b,0",
                ],
                "{name}"
            );
        }
        assert_eq!(lines("old.xls")[..2], ["t,x,y,z", "0.01,1,2,3"]);
    }

    /// Damaged ones are read or left as they are.
    #[test]
    fn damage_of_any_kind() {
        let whole = golden("sheets.xlsx");
        for at in (0..whole.len()).step_by(7) {
            let mut flipped = whole.clone();
            flipped[at] ^= 1 << (at % 8);
            let cut = whole[..at].to_vec();
            for bytes in [flipped, cut] {
                let mut read = Vec::new();
                let source: Source = Box::new(Cursor::new(bytes.clone()));
                table(source, &[]).read_to_end(&mut read).unwrap();
                let is_text = || std::str::from_utf8(&read).is_ok();
                assert!(read == bytes || is_text(), "byte {at}");
            }
        }
        assert!(!may_be(b"t,a\n1,2\n"));
    }
}
