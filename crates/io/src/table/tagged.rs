//! A text whose rows begin with the name of their sensor, or have it behind the time: `IMU,12.01,…` and `GPS,12.2,…`. Each sensor's rows
//! are a table, and these together one, see [`parts`](super::parts).
//!
//! The names of columns are in a line of their own for each sensor or for all, or in comments; without any they are made.

use std::io::{BufReader, Cursor, Read};

use super::fields::{Delimiter, Fields};
use super::parts::{Part, joined};
use super::wanted::starts_a_row;
use crate::number;
use crate::source::{Failing, Source, without_byte_order_mark};

/// The longest text that is read so, since it is held \[bytes\].
const LONGEST: u64 = 256 << 20;
/// Places of the names in rows.
const PLACES: usize = 3;
/// Sensors in a file, and the letters of their names.
const MOST: usize = 24;
const LETTERS: usize = 40;
/// Of ten rows, so many begin with a sensor's name.
const USUAL: usize = 7;
/// Columns of a time and a sensor of three axes, with one more.
const VALUES: usize = 5;
/// Parts of the names of inertial sensors, of which one is to be there.
const INERTIAL: [&str; 4] = ["imu", "acc", "gyr", "inertial"];

/// Whether a text begins with rows of at least one sensor.
pub(crate) fn may_be(start: &[u8]) -> bool {
    let end = start.iter().rposition(|byte| *byte == b'\n');
    place_of_tags(start.get(..end.unwrap_or_default()).unwrap_or_default()).is_some()
}

/// The table as text; the text itself where it is not of several sensors.
pub(crate) fn table(source: Source, _: &[u8]) -> Source {
    let mut text = Vec::new();
    let mut source = source.take(LONGEST);
    let failure = source.read_to_end(&mut text).err();
    let rows = place_of_tags(&text).and_then(|place| joined(parts(&text, place)));
    let read = Cursor::new(rows.map_or(text, String::into_bytes));
    let rest = BufReader::new(Failing(failure)).chain(source.into_inner());
    Box::new(read.chain(rest))
}

/// Where the names of sensors are in the rows, and the delimiter.
fn place_of_tags(text: &[u8]) -> Option<(usize, Delimiter)> {
    let text = without_byte_order_mark(text);
    let rows = text.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    let rows = rows.filter(|line| starts_a_row(line)).take(5000);
    let rows = Vec::from_iter(rows);
    let delimiter = Delimiter::detect(rows.get(rows.len() / 2)?);
    (0..PLACES).find_map(|place| {
        let mut tags: Vec<&str> = Vec::new();
        let mut count = 0;
        for row in &rows {
            let Some(tag) = tag(row, place, delimiter).filter(|_| is_of_numbers(row, delimiter))
            else {
                continue;
            };
            count += 1;
            if !tags.contains(&tag) {
                tags.push(tag);
            }
        }
        let inertial = |tag: &&str| {
            let tag = tag.to_lowercase();
            INERTIAL.iter().any(|word| tag.contains(word))
        };
        let usual = count > 2 && 10 * count >= USUAL * rows.len();
        (usual && tags.len() <= MOST && tags.iter().any(inertial)).then_some((place, delimiter))
    })
}

/// The name of the sensor of a row.
fn tag(row: &[u8], place: usize, delimiter: Delimiter) -> Option<&str> {
    let tag = std::str::from_utf8(Fields::new(row, delimiter).nth(place)?).ok()?;
    let tag = tag.trim_matches(['"', ':', '[', ']', '$', ' ']);
    let is_name = tag.starts_with(char::is_alphabetic)
        && tag.len() <= LETTERS
        && tag
            .chars()
            .all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | ' ' | '/'));
    is_name.then_some(tag)
}

/// Whether a row has numbers, and not the names of columns.
fn is_of_numbers(row: &[u8], delimiter: Delimiter) -> bool {
    let numbers =
        Fields::new(row, delimiter).filter(|field| number::parse_with_comma(field).is_some());
    numbers.count() >= 2
}

/// The tables of the sensors, in the order in which they come first.
fn parts(text: &[u8], (place, delimiter): (usize, Delimiter)) -> Vec<Part> {
    let mut parts: Vec<Part> = Vec::new();
    let mut headers: Vec<(String, Vec<String>)> = Vec::new();
    let text = without_byte_order_mark(text);
    for (number, line) in text.split(|byte| *byte == b'\n').enumerate() {
        let line = without_comment(line);
        if line.is_empty() {
            continue;
        }
        let cells = |plain: fn(&str) -> String| {
            // Without the checksum of a sentence.
            let sum = line.len().saturating_sub(3);
            let line = line
                .get(..sum)
                .filter(|_| line.get(sum) == Some(&b'*'))
                .unwrap_or(line);
            let fields = Fields::new(line, delimiter).map(String::from_utf8_lossy);
            let mut cells = Vec::from_iter(fields.map(|cell| plain(&cell)));
            if place < cells.len() {
                cells.remove(place);
            }
            cells
        };
        if !is_of_numbers(line, delimiter) {
            let names = cells(|name| name.trim_matches('"').to_owned());
            if names.len() > 1 {
                let tag = tag(line, place, delimiter).unwrap_or_default();
                headers.push((tag.to_owned(), names));
            }
            continue;
        }
        let Some(tag) = tag(line, place, delimiter) else {
            continue;
        };
        let row = cells(|cell| cell.replace(',', ".")).join(",");
        let known = parts.iter().position(|part| part.name == tag);
        match known.and_then(|place| parts.get_mut(place)) {
            Some(part) => part.rows.push((number, row)),
            None => parts.push(Part {
                name: tag.to_owned(),
                names: Vec::new(),
                rows: vec![(number, row)],
            }),
        }
    }
    // Of no sensor: for all.
    let all = Vec::from_iter(parts.iter().map(|part| part.name.clone()));
    let is_common = |(tag, _): &&(String, Vec<String>)| !all.contains(tag);
    for part in &mut parts {
        let own = headers.iter().find(|(tag, _)| *tag == part.name);
        let width = part
            .rows
            .first()
            .map_or(0, |(_, row)| row.split(',').count());
        // Names for all are those of values that differ from sensor to sensor, unless there are many.
        let mut common = headers.iter().filter(is_common);
        let common = common.find(|(_, names)| names.len() == width && width > VALUES);
        part.names = own
            .or(common)
            .map_or(Vec::new(), |(_, names)| names.clone());
    }
    parts
}

/// A line without the mark of a comment; of one with a part in quotes, as the app GetSensorData writes its formats, that part.
fn without_comment(line: &[u8]) -> &[u8] {
    let mut line = line.trim_ascii();
    let whole = line;
    while let [b'#' | b'%', rest @ ..] = line {
        line = rest.trim_ascii();
    }
    let mut quoted = line.split(|byte| *byte == b'\'').skip(1);
    match quoted.next().filter(|_| line.len() < whole.len()) {
        Some(inside) if quoted.next().is_some() => inside,
        _ => line,
    }
}
