//! Lines as a serial monitor shows what a microcontroller prints: the time of reception before each, `12:34:57.235 -> 1,2,3`
//! or `[12:34:57.235] 1,2,3`, and values behind their labels, `ax: 459 ay: -3`.
//!
//! They are made rows of a table: the time becomes the first column, `received`; the labels become the header, and each
//! value goes to the column of its label.

use super::fields::{Delimiter, Fields};
use crate::number;
use crate::time::{self, WeekClock};

/// Lines that are looked at.
const LINES: usize = 200;
/// Of ten lines, so many are like the others.
const MOST: usize = 8;
/// Labels that make a table.
const LABELS: usize = 3;
/// Bytes of a time before a line, and of a label.
const LONGEST: usize = 40;
/// Name of the column of times of reception.
const RECEIVED: &[u8] = b"received";

/// What is to be done with each line.
pub(super) struct Monitor {
    /// Each line begins with a time.
    timed: bool,
    /// The labels, in the order in which they come first; empty without.
    labels: Vec<String>,
}

impl Monitor {
    /// What the beginning of a text shows; `None` of a table as usual.
    pub(super) fn detect(start: &[u8]) -> Option<Self> {
        let end = start.iter().rposition(|byte| *byte == b'\n')?;
        let lines = start.get(..end)?.split(|byte| *byte == b'\n');
        let lines = lines
            .map(<[u8]>::trim_ascii)
            .filter(|line| !line.is_empty());
        let mut lines = Vec::from_iter(lines.take(LINES));
        let most = |count: usize, all: usize| count > 1 && 10 * count >= MOST * all;
        let count = lines.iter().filter(|line| timed(line).is_some()).count();
        let timed = most(count, lines.len());
        if timed {
            lines = lines
                .iter()
                .filter_map(|line| Some(self::timed(line)?.1))
                .collect();
            lines.retain(|line| !line.is_empty());
        }
        let labelled = Vec::from_iter(lines.iter().filter_map(|line| labelled(line)));
        let mut labels: Vec<String> = Vec::new();
        if most(labelled.len(), lines.len()) {
            for (label, _) in labelled.into_iter().flatten() {
                if !labels.contains(&label) {
                    labels.push(label);
                }
            }
        }
        if labels.len() < LABELS {
            labels.clear();
        }
        (timed || !labels.is_empty()).then_some(Self { timed, labels })
    }

    /// The header that labels make.
    pub(super) fn header(&self) -> Option<Vec<u8>> {
        if self.labels.is_empty() {
            return None;
        }
        let mut names = self.labels.clone();
        if self.timed {
            names.insert(0, String::from_utf8_lossy(RECEIVED).into_owned());
        }
        Some(names.join(",").into_bytes())
    }

    /// A line as a row; one that is unlike the others as it is.
    pub(super) fn row(&self, line: &[u8]) -> Vec<u8> {
        let (stamp, rest) = match timed(line).filter(|_| self.timed) {
            Some((stamp, rest)) => (Some(stamp), rest),
            None => (None, line),
        };
        let values = labelled(rest).filter(|_| !self.labels.is_empty());
        let (rest, delimiter) = match values {
            Some(values) => {
                let value = |label: &String| {
                    let found = values.iter().find(|(name, _)| name == label);
                    found.map_or(b"".as_slice(), |(_, value)| value)
                };
                let values = Vec::from_iter(self.labels.iter().map(value));
                (values.join(&b','), b',')
            }
            None => match Delimiter::detect(rest) {
                Delimiter::Byte(byte) => (rest.to_vec(), byte),
                Delimiter::Blanks => (rest.to_vec(), b' '),
            },
        };
        let Some(stamp) = stamp.filter(|_| !rest.is_empty()) else {
            return rest;
        };
        let is_number = |field: &[u8]| number::parse(field).is_some();
        let of_data = Fields::new(&rest, Delimiter::from_byte(delimiter)).any(is_number);
        let mut row = match of_data {
            // A blank or a comma would end the field.
            true => stamp
                .iter()
                .map(|byte| match byte {
                    b' ' => b'T',
                    b',' => b'.',
                    other => *other,
                })
                .collect(),
            false => RECEIVED.to_vec(),
        };
        row.push(delimiter);
        row.extend(rest);
        row
    }
}

/// The time before a line, and the line.
fn timed(line: &[u8]) -> Option<(&[u8], &[u8])> {
    let line = line.trim_ascii();
    let end = line
        .iter()
        .take(LONGEST)
        .position(|byte| matches!(byte, b'>' | b']'))?;
    let (stamp, rest) = line.split_at(end);
    let stamp = stamp.strip_prefix(b"[").unwrap_or(stamp);
    let stamp = stamp.strip_suffix(b"-").unwrap_or(stamp).trim_ascii();
    let is_time =
        time::time_of_day(stamp).is_some() || WeekClock::default().date_time(stamp).is_some();
    is_time.then(|| (stamp, rest.get(1..).unwrap_or_default().trim_ascii()))
}

/// The labels of a line, each with the number behind it.
fn labelled(line: &[u8]) -> Option<Vec<(String, &[u8])>> {
    let mut rest = line.trim_ascii();
    let mut found = Vec::new();
    while !rest.is_empty() {
        let end = rest.iter().position(|byte| matches!(byte, b':' | b'='))?;
        let (label, behind) = rest.split_at(end);
        let label = std::str::from_utf8(label).ok()?.trim();
        let is_label = label.starts_with(|c: char| c.is_alphabetic()) && label.len() <= LONGEST;
        let behind = behind.get(1..)?.trim_ascii_start();
        let (_, length) = number::parse_prefix(behind).filter(|_| is_label)?;
        let (value, behind) = behind.split_at_checked(length)?;
        // A unit directly behind the number.
        let ends = |byte: &u8| matches!(byte, b' ' | b'\t' | b',' | b';' | b'|');
        let end = behind.iter().position(ends).unwrap_or(behind.len());
        let (unit, behind) = behind.split_at(end);
        let is_unit = |unit: &[u8]| {
            unit.iter()
                .all(|byte| !matches!(byte, b':' | b'=' | b'.' | b'-'))
        };
        if !is_unit(unit) {
            return None;
        }
        let label = label
            .rsplit([',', ';', '|', '\t', '"'])
            .next()
            .unwrap_or(label)
            .trim();
        found.push((label.to_owned(), value));
        let skip = |byte: &u8| ends(byte) || *byte == b'\r';
        let from = behind
            .iter()
            .position(|byte| !skip(byte))
            .unwrap_or(behind.len());
        rest = behind.get(from..).unwrap_or_default();
    }
    (!found.is_empty()).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rows that a text becomes, the header before them.
    fn rows(text: &str) -> Option<Vec<String>> {
        let monitor = Monitor::detect(text.as_bytes())?;
        let lines = text.lines().map(|line| monitor.row(line.as_bytes()));
        let rows = monitor.header().into_iter().chain(lines);
        Some(rows.map(|row| String::from_utf8(row).unwrap()).collect())
    }

    #[test]
    fn times_of_reception_become_a_column() {
        let text = "12:34:57.235 -> ax,ay\n12:34:57.245 -> 1,-2.5\n12:34:57.255 -> 3,4\n";
        let expected = ["received,ax,ay", "12:34:57.245,1,-2.5", "12:34:57.255,3,4"];
        assert_eq!(rows(text).unwrap(), expected);
        let text = "[2024-05-06 12:34:57] 1 2\n[2024-05-06 12:34:58] 3 4\n";
        let expected = ["2024-05-06T12:34:57 1 2", "2024-05-06T12:34:58 3 4"];
        assert_eq!(rows(text).unwrap(), expected);
        let text = "12:34:57,235 -> 1,2\n12:34:57,245 -> 3,4\n";
        assert_eq!(
            rows(text).unwrap(),
            ["12:34:57.235,1,2", "12:34:57.245,3,4"]
        );
        let text = "12:34:57.235 > 1;2\n12:34:57.245 > 3;4\n";
        assert_eq!(
            rows(text).unwrap(),
            ["12:34:57.235;1;2", "12:34:57.245;3;4"]
        );
    }

    #[test]
    fn labels_become_the_header() {
        let text = "ax: 459 ay: -3 az: 1.5e3\nax: 1 ay: 2 az: 3\n";
        assert_eq!(rows(text).unwrap(), ["ax,ay,az", "459,-3,1.5e3", "1,2,3"]);
        let text = "aX = 0.98g, aY = 0.1g | gX = 2\naX = 1g, aY = 0.2g | gX = 3\n";
        assert_eq!(rows(text).unwrap(), ["aX,aY,gX", "0.98,0.1,2", "1,0.2,3"]);
        // In lines of their own.
        let text = "ax:1,ay:2\ngx:3,gy:4\nax:5,ay:6\n";
        assert_eq!(
            rows(text).unwrap(),
            ["ax,ay,gx,gy", "1,2,,", ",,3,4", "5,6,,"]
        );
        let text = "01:02:03.5 -> a:1 b:2 c:3\n01:02:03.6 -> a:4 b:5 c:6\n";
        let expected = ["received,a,b,c", "01:02:03.5,1,2,3", "01:02:03.6,4,5,6"];
        assert_eq!(rows(text).unwrap(), expected);
    }

    #[test]
    fn tables_stay_as_they_are() {
        for text in [
            "t,a,b\n12:34:56.1,1,2\n12:34:56.2,3,4\n",
            "1,2,3\n4,5,6\n",
            "{\"a\": 1, \"b\": 2}\n{\"a\": 3, \"b\": 4}\n",
            "$GPGGA,1:2\n$GPGGA,1:3\n",
            "date: 2024-01-02 a: 1\ndate: 2024-01-02 a: 2\n",
            "",
        ] {
            assert_eq!(rows(text), None, "{text}");
        }
    }
}
