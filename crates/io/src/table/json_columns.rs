//! A text of JSON that has its values column by column, `{"t": [...], "gyro": {"x": [...], ...}}`, as a table: arrays of numbers or of
//! vectors under the names around them, and what pandas writes: `{"t": {"0": ...}}`, `{"columns": [...], "data": [[...], ...]}`,
//! rows of arrays or by their index.

use std::collections::HashMap;

use serde_json::Value;

use super::json;
use crate::source::{Source, converted, without_byte_order_mark};

/// Whether a text begins as such a one, but has no objects that are rows.
pub(crate) fn may_be(start: &[u8]) -> bool {
    let text = without_byte_order_mark(start).trim_ascii_start();
    let inner = match text {
        [b'{', ..] => return !super::are_json_lines(start),
        [b'[', rest @ ..] => rest.trim_ascii_start(),
        _ => return false,
    };
    inner.starts_with(b"[")
}

/// The table as text; the text itself where it has no columns.
pub(crate) fn table(source: Source, _: &[u8]) -> Source {
    converted(source, rows_of)
}

fn rows_of(text: &[u8]) -> Option<String> {
    let text = std::str::from_utf8(without_byte_order_mark(text)).ok()?;
    // As Python writes what is no number.
    let plain = |text: &str| serde_json::from_str(text).ok();
    let value: Value = plain(text).or_else(|| plain(&text.replace("NaN", "null")))?;
    let mut columns = Vec::new();
    collect(value, "", &mut columns);
    let mut lengths: HashMap<usize, usize> = HashMap::new();
    for (_, cells) in &columns {
        *lengths.entry(cells.len()).or_default() += cells.len();
    }
    // Of the longest in sum; others are of something else.
    let (rows, _) = lengths.into_iter().max_by_key(|(_, values)| *values)?;
    columns.retain(|(_, cells)| cells.len() == rows);
    let cells = |row: usize| Vec::from_iter(columns.iter().map(|(_, cells)| cells[row].as_str()));
    let lines = (0..rows).map(|row| cells(row).join(",") + "\n");
    let named = columns.iter().any(|(name, _)| !name.is_empty());
    let names = Vec::from_iter(
        columns
            .iter()
            .map(|(name, _)| name.replace([',', '"'], " ")),
    );
    let header = named.then(|| names.join(",") + "\n");
    (columns.len() > 1 && rows > 1).then(|| header.into_iter().chain(lines).collect())
}

/// The columns in a value, each under the names around it.
fn collect(value: Value, name: &str, columns: &mut Vec<(String, Vec<String>)>) {
    match value {
        Value::Array(values) => put(values, name, &[], columns),
        Value::Object(mut members) => {
            let index = members.keys().map(|key| key.parse::<usize>().ok());
            if let Some(index) = index
                .collect::<Option<Vec<_>>>()
                .filter(|all| all.len() > 1)
            {
                let mut values =
                    Vec::from_iter(index.into_iter().zip(members.into_iter().map(|m| m.1)));
                values.sort_by_key(|(place, _)| *place);
                let values = values.into_iter().map(|(_, value)| value);
                return put(values.collect(), name, &[], columns);
            }
            let texts = |names: &Value| {
                let names = names.as_array()?.iter();
                names.map(|name| name.as_str().map(str::to_owned)).collect()
            };
            let names: Option<Vec<String>> = members.get("columns").and_then(texts);
            if let (Some(names), Some(Value::Array(rows))) = (names, members.remove("data")) {
                return put(rows, name, &names, columns);
            }
            for (member, value) in members {
                collect(value, &json::inner(name, &member), columns);
            }
        }
        _ => {}
    }
}

/// The column or columns of an array: of numbers, of arrays with these names, or of objects.
fn put(values: Vec<Value>, name: &str, names: &[String], columns: &mut Vec<(String, Vec<String>)>) {
    let rows = values.len();
    let mut own: Vec<(String, Vec<String>)> = Vec::new();
    let mut places = HashMap::new();
    for (row, value) in values.iter().enumerate() {
        let mut cells = Vec::new();
        json::put(value, name, &mut cells);
        for (place, (member, cell)) in cells.into_iter().enumerate() {
            let member = names.get(place).cloned().unwrap_or(member);
            let place = *places.entry(member.clone()).or_insert_with(|| {
                own.push((member, vec![String::new(); rows]));
                own.len() - 1
            });
            own[place].1[row] = cell;
        }
    }
    // Rows without names have none.
    if name.is_empty() && names.is_empty() && values.iter().all(Value::is_array) {
        own.iter_mut().for_each(|(name, _)| name.clear());
    }
    columns.append(&mut own);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Cursor, Read};

    #[test]
    fn columns_of_every_layout_are_a_table() {
        let rows = |text: &str| {
            assert!(may_be(text.as_bytes()), "{text}");
            rows_of(text.as_bytes()).map(|rows| Vec::from_iter(rows.lines().map(str::to_owned)))
        };
        let expected = ["a,t", "3,1", "-4.5,2"];
        for text in [
            r#"{"fs": 50, "lever": [0, 0, 1], "a": [3, -4.5], "t": [1, 2], "note": "x"}"#,
            r#"{"a": {"0": 3, "1": -4.5}, "t": {"0": 1, "1": 2}}"#,
            r#"{"columns": ["a", "t"], "index": [0, 1], "data": [[3, 1], [-4.5, 2]]}"#,
            "{\"0\": {\"a\": 3, \"t\": 1},\n\"1\": {\"a\": -4.5, \"t\": 2}}",
        ] {
            assert_eq!(
                rows(text).as_deref(),
                Some(expected.map(String::from).as_slice()),
                "{text}"
            );
        }
        let nested = r#"{"imu": {"t": [1, 2], "g": {"x": [3, 4], "y": [5, NaN]}, "f": [[1, 2, 3], [4, 5, 6]]}}"#;
        let expected = [
            "imu.f.x,imu.f.y,imu.f.z,imu.g.x,imu.g.y,imu.t",
            "1,2,3,3,5,1",
            "4,5,6,4,,2",
        ];
        assert_eq!(rows(nested).unwrap(), expected);
        assert_eq!(rows("[[1, 2], [3, 4]]").unwrap(), ["1,2", "3,4"]);
        // Numbers of an index go by their size.
        let long = Vec::from_iter((0..12).map(|k| format!("\"{k}\": {k}")));
        let table = rows(&format!(
            "{{\"t\": {{{0}}}, \"u\": {{{0}}}}}",
            long.join(",")
        ))
        .unwrap();
        assert_eq!((table[3].as_str(), table[12].as_str()), ("2,2", "11,11"));
        for text in [
            "{",
            "{}",
            r#"{"a": 1}"#,
            r#"{"a": [1, 2]}"#,
            r#"{"a": [1], "b": [2]}"#,
            "[[]]",
        ] {
            assert_eq!(rows(text), None, "{text}");
        }
    }

    #[test]
    fn what_is_no_table_stays_as_it_is() {
        let mut read = String::new();
        table(Box::new(Cursor::new(b"{\"a\": 1}".to_vec())), b"")
            .read_to_string(&mut read)
            .unwrap();
        assert_eq!(read, "{\"a\": 1}");
        assert!(
            !may_be(b"t,a\n1,2\n")
                && !may_be(b"{\"t\":1}\n{\"t\":2}\n{\"t\":3}\n")
                && !may_be(b"[imu]\n")
        );
    }
}
