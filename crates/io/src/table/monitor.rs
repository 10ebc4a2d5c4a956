//! Lines as a serial monitor shows what a microcontroller prints: the time of reception before each, `12:34:57.235 -> 1,2,3`
//! or `[12:34:57.235] 1,2,3`, and values behind their labels, `ax: 459 ay: -3`.
//!
//! They are made rows of a table: the time becomes the first column, `received`; the labels become the header, and each
//! value goes to the column of its label.

use super::fields::{Delimiter, Fields};
use crate::number;
use crate::time::{self, WeekClock};
use undrift_nav::units::{Quantity, unit_factor};

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

/// The labels of a line, each with a number behind it: `ax: 459 ay: -3`, `Gyro: 1, 2, 3 | Accel: 4, 5, 6`, in which three numbers
/// are those of x, y and z, and a unit behind a number goes to the label in brackets.
fn labelled(line: &[u8]) -> Option<Vec<(String, &[u8])>> {
    let mut found: Vec<Group> = Vec::new();
    let (mut rest, mut any) = (without_colours(line.trim_ascii()), false);
    while let Some((between, value, behind)) = next_number(rest) {
        let between = std::str::from_utf8(between).ok()?;
        let (unit, label) = parted(between, found.is_empty());
        if let (Some(last), Some(unit)) = (found.last_mut(), unit) {
            last.unit.get_or_insert(unit);
        }
        let colon = between.contains([':', '=']);
        any |= colon;
        match label {
            Some(label) if label.len() > LONGEST => return None,
            Some(label) => found.push(Group::new(label, value)),
            // Times and dates.
            None if colon || between.is_empty() && !found.is_empty() => return None,
            None => match found.last_mut() {
                Some(last) => last.values.push(value),
                None => found.push(Group::new(FIRST, value)),
            },
        }
        rest = behind;
    }
    let unit = std::str::from_utf8(rest).ok()?.trim_matches(BETWEEN);
    if let (Some(last), true) = (found.last_mut(), is_unit(unit)) {
        last.unit.get_or_insert(unit);
    }
    share_stems(&mut found);
    let groups = found.iter().filter(|_| any);
    let cells = Vec::from_iter(groups.flat_map(Group::cells));
    (!cells.is_empty()).then_some(cells)
}

/// Puts the word before the first axis before the others, and the unit behind the last to all.
fn share_stems(groups: &mut [Group]) {
    let is_axis = |label: &str| label.len() == 1 && label.contains(['x', 'y', 'z', 'X', 'Y', 'Z']);
    for at in 1..groups.len() {
        if !is_axis(groups[at].label) {
            continue;
        }
        let before = &mut groups[at - 1];
        let split = before.label.len().saturating_sub(1);
        if let (true, Some((stem, axis))) =
            (before.stem.is_empty(), before.label.split_at_checked(split))
            && is_axis(axis)
            && stem.ends_with([' ', '_', '.'])
        {
            (before.stem, before.label) = (stem, axis);
        }
        groups[at].stem = groups[at - 1].stem;
    }
    for at in (1..groups.len()).rev() {
        if !groups[at].stem.is_empty() && groups[at].stem == groups[at - 1].stem {
            groups[at - 1].unit = groups[at - 1].unit.or(groups[at].unit);
        }
    }
}

/// A line without the sequences that colour it in a terminal.
fn without_colours(line: &[u8]) -> &[u8] {
    let Some(coloured) = line.strip_prefix(b"\x1b[") else {
        return line;
    };
    let from = coloured.iter().position(|byte| *byte == b'm');
    let line = coloured
        .get(from.map_or(0, |at| at + 1)..)
        .unwrap_or_default();
    let to = line.iter().position(|byte| *byte == 0x1b);
    line.get(..to.unwrap_or(line.len())).unwrap_or_default()
}

/// What numbers before any label are called.
const FIRST: &str = "first";
/// Characters between labels and numbers, and around units.
const BETWEEN: &[char] = &[
    ' ', '\t', ',', ';', '|', '(', ')', '[', ']', '{', '}', '"', '\'', '>', '\r',
];

/// The numbers behind a label.
struct Group<'a> {
    /// What is before the axis of several: `Accel X: 1, Y: 2, Z: 3`.
    stem: &'a str,
    label: &'a str,
    unit: Option<&'a str>,
    values: Vec<&'a [u8]>,
}

impl<'a> Group<'a> {
    fn new(label: &'a str, value: &'a [u8]) -> Self {
        Self {
            stem: "",
            label,
            unit: None,
            values: vec![value],
        }
    }

    fn cells(&self) -> impl Iterator<Item = (String, &'a [u8])> {
        let count = self.values.len();
        self.values.iter().enumerate().map(move |(place, value)| {
            let end = match count {
                1 => String::new(),
                3 => format!("_{}", ["x", "y", "z"][place]),
                _ => format!("_{}", place + 1),
            };
            let unit = self.unit.map_or(String::new(), |unit| format!(" [{unit}]"));
            (format!("{}{}{end}{unit}", self.stem, self.label), *value)
        })
    }
}

/// What is before the next number of a line, the number, and what is behind it.
fn next_number(line: &[u8]) -> Option<(&[u8], &[u8], &[u8])> {
    let is_of_word =
        |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'^') || byte >= 0x80;
    let mut before = b' ';
    for (at, byte) in line.iter().enumerate() {
        let begins = !is_of_word(before) && matches!(byte, b'0'..=b'9' | b'-' | b'+' | b'.');
        let parsed = begins
            .then(|| number::parse_prefix(line.get(at..)?))
            .flatten();
        if let Some((_, length)) = parsed {
            let (between, rest) = line.split_at(at);
            let (value, behind) = rest.split_at_checked(length)?;
            return Some((between, value, behind));
        }
        before = *byte;
    }
    None
}

/// The unit of the number before and the label of that behind, in what is between them.
fn parted(between: &str, is_first: bool) -> (Option<&str>, Option<&str>) {
    let colon = between.trim_end_matches(BETWEEN).ends_with([':', '=']);
    let words = between.trim_matches(|c| BETWEEN.contains(&c) || matches!(c, ':' | '='));
    let (first, rest) = words.split_once(BETWEEN).unwrap_or((words, ""));
    // What is directly behind a number, or a unit before something else, is that of the number.
    let of_number = between.starts_with(|c: char| !BETWEEN.contains(&c) && !matches!(c, ':' | '='));
    let is_of_number = !is_first && (of_number || is_unit(first) && (!rest.is_empty() || !colon));
    let (unit, label) = match is_of_number {
        true => (Some(first).filter(|unit| !unit.is_empty()), rest),
        false => (None, words),
    };
    let label = label
        .rsplit([':', '=', ',', ';', '|', '\t', '"', ']', ')'])
        .next()
        .unwrap_or(label);
    let label = label.trim_matches(BETWEEN);
    (
        unit,
        Some(label).filter(|label| label.starts_with(char::is_alphabetic)),
    )
}

/// Whether a word is a unit of something that is measured.
fn is_unit(word: &str) -> bool {
    use Quantity::{Acceleration, Angle, AngularRate, Length, Time, Velocity};
    let all = [Acceleration, Angle, AngularRate, Length, Time, Velocity];
    !word.is_empty()
        && all
            .into_iter()
            .any(|quantity| unit_factor(word, quantity).is_ok())
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
        assert_eq!(
            rows(text).unwrap(),
            ["aX [g],aY [g],gX", "0.98,0.1,2", "1,0.2,3"]
        );
        // Several numbers to a label, units as words, numbers before the first label, words of a log around.
        let group = "Time: 20 | Gyro: 1, 2, 3 | Accel: 4, 5, 6\nTime: 21 | Gyro: 1, 2, 3 | Accel: 4, 5, 6\n";
        let expected = [
            "Time,Gyro_x,Gyro_y,Gyro_z,Accel_x,Accel_y,Accel_z",
            "20,1,2,3,4,5,6",
            "21,1,2,3,4,5,6",
        ];
        assert_eq!(rows(group).unwrap(), expected);
        let text = "Time: 20 ms, gx: -1 rad/s, Acc Y: 2 m/s^2\n".repeat(2);
        let expected = ["Time [ms],gx [rad/s],Acc Y [m/s^2]", "20,-1,2", "20,-1,2"];
        assert_eq!(rows(&text).unwrap(), expected);
        let text = "20\tax: 1 ay: 2\n".repeat(2);
        assert_eq!(rows(&text).unwrap(), ["first,ax,ay", "20,1,2", "20,1,2"]);
        let text = "[INFO] [1700000000.5]: gyro 1 2 3 acc 4 5 6\n".repeat(2);
        let expected = "INFO,gyro_x,gyro_y,gyro_z,acc_x,acc_y,acc_z";
        assert_eq!(
            rows(&text).unwrap()[..2],
            [expected, "1700000000.5,1,2,3,4,5,6"]
        );
        let text = "\u{1b}[0;32mI (20) IMU: 1,2,3\u{1b}[0m\n".repeat(2);
        assert!(rows(&text).unwrap()[0].ends_with("IMU_x,IMU_y,IMU_z"));
        // Axes behind the first without its word.
        let text = "Accel X: 1, Y: 2, Z: 9.8 m/s^2\nRotation X: 3, Y: 4, Z: 5 rad/s\n";
        let names = "Accel X [m/s^2],Accel Y [m/s^2],Accel Z [m/s^2],Rotation X [rad/s],Rotation Y [rad/s],Rotation Z [rad/s]";
        assert_eq!(rows(text).unwrap(), [names, "1,2,9.8,,,", ",,,3,4,5"]);
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
