//! The values in a row of a SQLite table, and the names of a table's columns. "Database File
//! Format", section 2.1 (record format).

use std::borrow::Cow;

/// A number of one to nine bytes, seven bits each, the highest first; and what comes after it.
pub(super) fn varint(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let mut number = 0;
    for (k, &byte) in bytes.iter().take(9).enumerate() {
        if k == 8 {
            return Some((number << 8 | u64::from(byte), bytes.get(9..)?));
        }
        number = number << 7 | u64::from(byte & 0x7f);
        if byte < 0x80 {
            return Some((number, bytes.get(k + 1..)?));
        }
    }
    None
}

/// A column of a row: its type, and where its bytes are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Field {
    kind: u64,
    pub(super) start: usize,
    pub(super) length: usize,
}

/// Columns up to the wanted one; `None` if the row does not have so many. The bytes may end within them.
pub(super) fn field(row: &[u8], column: usize) -> Option<Field> {
    let (header, types) = varint(row)?;
    let header = usize::try_from(header).ok()?;
    let mut types = types.get(..header.checked_sub(row.len() - types.len())?)?;
    let mut start = header;
    for _ in 0..column {
        let (kind, rest) = varint(types)?;
        start = start.checked_add(length(kind)?)?;
        types = rest;
    }
    let (kind, _) = varint(types)?;
    Some(Field {
        kind,
        start,
        length: length(kind)?,
    })
}

/// Of a value \[bytes\].
fn length(kind: u64) -> Option<usize> {
    match kind {
        0 | 8 | 9 => Some(0),
        1..=4 => Some(kind as usize),
        5 => Some(6),
        6 | 7 => Some(8),
        10 | 11 => None,
        _ => usize::try_from((kind - 12) / 2).ok(),
    }
}

/// The bytes of a value in a row.
fn bytes(row: &[u8], field: Field) -> Option<&[u8]> {
    row.get(field.start..)?.get(..field.length)
}

/// A whole number in a column. The column that is the number of the row is stored as NULL: then `None`.
pub(super) fn integer(row: &[u8], column: usize) -> Option<i64> {
    let field = field(row, column)?;
    let bytes = bytes(row, field)?;
    match field.kind {
        8 => Some(0),
        9 => Some(1),
        1..=6 => {
            // The sign is that of the first byte.
            let negative = bytes.first()? & 0x80 != 0;
            let first = if negative { -1 } else { 0 };
            let add = |number: i64, byte: &u8| number << 8 | i64::from(*byte);
            Some(bytes.iter().fold(first, add))
        }
        _ => None,
    }
}

/// A text in a column.
pub(super) fn text(row: &[u8], column: usize) -> Option<Cow<'_, str>> {
    let field = field(row, column)?;
    let is_text = field.kind >= 13 && field.kind % 2 == 1;
    let bytes = bytes(row, field).filter(|_| is_text)?;
    Some(String::from_utf8_lossy(bytes))
}

/// The names of the columns that a `CREATE TABLE` declares, in lower case.
pub(super) fn columns(sql: &str) -> Vec<String> {
    let Some((_, declared)) = sql.split_once('(') else {
        return Vec::new();
    };
    let (mut columns, mut depth, mut quoted) = (vec![String::new()], 0, None);
    for letter in declared.chars() {
        match (quoted, letter) {
            (Some(end), _) if letter == end => quoted = None,
            (None, '"' | '\'' | '`') => quoted = Some(letter),
            (None, '[') => quoted = Some(']'),
            (None, '(') => depth += 1,
            (None, ')') if depth == 0 => break,
            (None, ')') => depth -= 1,
            (None, ',') if depth == 0 => {
                columns.push(String::new());
                continue;
            }
            _ => {}
        }
        if let Some(last) = columns.last_mut() {
            last.push(letter);
        }
    }
    let marks = ['"', '\'', '`', '[', ']'];
    let name = |declared: &String| {
        let first = declared.split_whitespace().next().unwrap_or_default();
        first.trim_matches(marks).to_ascii_lowercase()
    };
    columns.iter().map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_any_length() {
        // From the examples of SQLite's documentation of its format, and the ends of each length.
        for (bytes, number) in [
            (&[0x00][..], 0),
            (&[0x7f], 127),
            (&[0x81, 0x00], 128),
            (&[0xff, 0x7f], 16_383),
            (&[0x81, 0x80, 0x00], 16_384),
            (&[0xff; 9], u64::MAX),
            (&[0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 5], 5),
        ] {
            let (found, rest) = varint(bytes).unwrap();
            assert_eq!((found, rest.len()), (number, 0));
            assert!(varint(&bytes[..bytes.len() - 1]).is_none());
        }
    }

    #[test]
    fn values_of_a_row() {
        // Header of 8 bytes: NULL, -2 in one byte, 1, -3 in six bytes, "hi", 0x0102 in two, a blob of 1000.
        let mut row = vec![9, 0, 1, 9, 5, 17, 2, 0x8f, 0x5c];
        row.extend([0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfd, b'h', b'i', 1, 2]);
        let numbers: Vec<_> = (0..8).map(|k| integer(&row, k)).collect();
        let expected = [
            None,
            Some(-2),
            Some(1),
            Some(-3),
            None,
            Some(258),
            None,
            None,
        ];
        assert_eq!(numbers, expected);
        assert_eq!(text(&row, 4).unwrap(), "hi");
        assert_eq!(text(&row, 5), None);
        // The blob is announced but not there.
        let blob = field(&row, 6).unwrap();
        assert_eq!((blob.start, blob.length), (20, 1000));
        assert_eq!(bytes(&row, blob), None);
        for n in 0..row.len() {
            for column in 0..8 {
                let _ = (integer(&row[..n], column), text(&row[..n], column));
            }
        }
    }

    #[test]
    fn columns_as_they_are_declared() {
        let columns = |sql: &str| columns(sql).join(" ");
        assert_eq!(
            columns(
                "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, data BLOB NOT NULL)"
            ),
            "id topic_id timestamp data"
        );
        assert_eq!(
            columns(
                "create table t (\n \"Data, raw\" BLOB, [id] INTEGER DEFAULT (1, 2),\n`b` DECIMAL(4,2) CHECK (b > ')') )"
            ),
            "data, id b"
        );
        assert_eq!(columns("CREATE TABLE"), "");
    }
}
