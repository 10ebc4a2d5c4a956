//! The navigation solution as lines of JSON: an object a row, with the columns of [`super::csv`]; what is not known is null.

use std::io;

use super::fixed::write_fixed;
use super::solution::{COLUMNS, SolutionRow, UNIX_TIME, YAW};
use super::text::in_turn;
use super::text_writer::{Beside, Body, TextFormat};

pub(super) fn format() -> TextFormat {
    TextFormat {
        head: String::new(),
        body: Body::Rows(|_| true, write_row),
        tail: "",
    }
}

fn write_row(buf: &mut Vec<u8>, row: &SolutionRow, beside: &Beside) -> io::Result<()> {
    let mut values = row.values();
    values[YAW] = in_turn(values[YAW], COLUMNS[YAW].1);
    let numbers = COLUMNS.iter().zip(values);
    let mut separator = b'{';
    for (&(name, decimals), value) in numbers {
        member(buf, separator, name, value, decimals);
        separator = b',';
    }
    if let Some(epoch) = beside.epoch {
        member(buf, separator, UNIX_TIME, row.unix_time(epoch), 6);
    }
    buf.extend_from_slice(match beside.outage {
        true => b",\"without_gnss\":true}\n",
        false => b",\"without_gnss\":false}\n",
    });
    Ok(())
}

fn member(buf: &mut Vec<u8>, separator: u8, name: &str, value: f64, decimals: usize) {
    buf.push(separator);
    buf.push(b'"');
    buf.extend_from_slice(name.as_bytes());
    buf.extend_from_slice(b"\":");
    match value.is_finite() {
        true => write_fixed(buf, value, decimals),
        false => buf.extend_from_slice(b"null"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write::{SolutionFile, SolutionFormat, SolutionOptions};
    use undrift_nav::earth::Geodetic;

    #[test]
    fn each_row_is_an_object_with_the_columns_of_csv_at_once() {
        let place = Geodetic::from_degrees(40.5, -105.25, 1600.0);
        let options = SolutionOptions::default();
        let mut file = SolutionFile::new(Vec::new(), SolutionFormat::JsonLines, &options).unwrap();
        file.write(&SolutionRow::at(1.5, place), false).unwrap();
        file.write(&SolutionRow::at(2.5, place), true).unwrap();
        let text = String::from_utf8(file.into_inner().unwrap()).unwrap();
        let rows: Vec<serde_json::Value> = text
            .lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect();
        assert_eq!(rows.len(), 2);
        assert_eq!(rows[0]["lon_deg"], -105.25);
        assert_eq!(rows[0]["yaw_deg"], serde_json::Value::Null);
        assert_eq!(
            [&rows[0]["without_gnss"], &rows[1]["without_gnss"]],
            [false, true]
        );
        assert_eq!(rows[1].as_object().unwrap().len(), COLUMNS.len() + 1);
    }
}
