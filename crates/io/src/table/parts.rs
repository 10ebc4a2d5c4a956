//! Several tables in one file, the sheets of a workbook or rows behind the names of their sensors, as one: rows by their
//! time, each with the columns of its own table and blanks in those of the others, or several in one row where their times are equal.
//!
//! A table whose clock is another one keeps its times in a column of its own.

use std::cmp::Reverse;

use super::halves::{plain, qualified};
use super::stamps;
use crate::number;
use crate::time::WeekClock;

/// Rows that show the column of times.
const ROWS: usize = 200;
/// Lengths of two columns of times, as powers of a thousand, that are those of one clock.
const ALIKE: f64 = 0.01;
/// Words in the names of sensors whose rows are positions.
const RECEIVERS: [&str; 5] = ["gps", "gnss", "fix", "pos", "llh"];

/// A table of several.
pub(super) struct Part {
    pub(super) name: String,
    /// Of its columns; empty where it has none.
    pub(super) names: Vec<String>,
    /// Its rows and their places in the file; cells with a comma between and none in them.
    pub(super) rows: Vec<(usize, String)>,
}

/// A table with a column of times.
struct Timed {
    part: Part,
    width: usize,
    time: usize,
    /// The columns behind it that are no times.
    behind: Vec<usize>,
    /// The times of its rows.
    stamps: Vec<f64>,
}

/// The text of the table that those with times are together; `None` without one. With rows `of_lines` of a text, empty lines
/// keep each row in the line that it had, as far as they are in order: messages have that number.
pub(super) fn joined(parts: Vec<Part>, of_lines: bool) -> Option<String> {
    let mut weeks = WeekClock::default();
    let parts = parts
        .into_iter()
        .filter_map(|part| Timed::new(part, &mut weeks));
    let mut parts = Vec::from_iter(parts);
    parts.sort_by_key(|part| Reverse(part.stamps.len()));
    let longest = parts.first()?;
    let one_clock = parts.iter().all(|part| part.overlaps(longest));
    let named = Vec::from_iter(parts.iter().map(Timed::names));
    let mut header = Vec::new();
    if one_clock {
        header.push(named[0][parts[0].time].clone());
    }
    for (k, (part, own)) in parts.iter().zip(&named).enumerate() {
        for (place, name) in own.iter().enumerate() {
            if one_clock && place == part.time {
                continue;
            }
            let others = named.iter().enumerate().filter(|(other, _)| *other != k);
            let shared = others
                .flat_map(|(_, names)| names)
                .any(|other| other.eq_ignore_ascii_case(name));
            header.push(match parts.len() {
                1 => plain(name),
                _ => qualified(&part.part.name, name, shared),
            });
        }
    }
    let mut text = header.join(",") + "\n";
    let mut order = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        let rows = part.part.rows.iter().zip(&part.stamps).enumerate();
        order.extend(rows.map(|(row, ((place, _), stamp))| (*stamp, *place, k, row)));
    }
    match one_clock {
        true => order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))),
        false => order.sort_by_key(|(_, place, ..)| *place),
    }
    let (mut at, mut lines) = (0, 1);
    while let Some(&(stamp, ..)) = order.get(at) {
        let mut line = 0;
        let mut row: Vec<Option<usize>> = vec![None; parts.len()];
        while let Some(&(other, place, part, index)) = order.get(at) {
            let together = row.iter().all(Option::is_none) || one_clock && other == stamp;
            if !together || row[part].is_some() {
                break;
            }
            row[part] = Some(index);
            line = place;
            at += 1;
        }
        if of_lines {
            text.extend((lines..line).map(|_| '\n'));
            lines = lines.max(line) + 1;
        }
        put(&mut text, &parts, &row, one_clock);
    }
    Some(text)
}

/// Adds a row of these rows of the tables.
fn put(text: &mut String, parts: &[Timed], rows: &[Option<usize>], one_clock: bool) {
    let cells = |part: &Timed, index: &Option<usize>| {
        let row = index.and_then(|index| part.part.rows.get(index));
        Vec::from_iter(
            row.map_or("", |(_, row)| row.as_str())
                .split(',')
                .map(str::to_owned),
        )
    };
    let mut all = Vec::new();
    let mut time = None;
    for (part, index) in parts.iter().zip(rows) {
        let mut own = cells(part, index);
        own.resize(part.width, String::new());
        if one_clock {
            let stamp = own.remove(part.time);
            time = time.or(Some(stamp).filter(|_| index.is_some()));
        }
        all.append(&mut own);
    }
    if one_clock {
        all.insert(0, time.unwrap_or_default());
    }
    *text += &all.join(",");
    text.push('\n');
}

impl Timed {
    /// With the first column that only grows; one that counts the rows only without another.
    fn new(part: Part, weeks: &mut WeekClock) -> Option<Self> {
        let first = part.rows.iter().take(ROWS);
        let first = Vec::from_iter(first.map(|(_, row)| Vec::from_iter(row.split(','))));
        let widths = first.iter().map(Vec::len);
        let width = widths.chain([part.names.len()]).max()?;
        let mut column = |place: usize| {
            let cells = first.iter().filter_map(|row| row.get(place));
            Vec::from_iter(cells.filter_map(|cell| time_of(cell, weeks)))
        };
        let columns = Vec::from_iter((0..width).map(&mut column));
        let grows = |stamps: &Vec<f64>| {
            2 * stamps.len() > first.len()
                && stamps.len() > 1
                && stamps.is_sorted()
                && stamps.first() < stamps.last()
        };
        let counts = |stamps: &Vec<f64>| stamps.windows(2).all(|pair| pair[1] - pair[0] == 1.0);
        let time = columns
            .iter()
            .position(|stamps| grows(stamps) && !counts(stamps))
            .or_else(|| columns.iter().position(grows))?;
        // A second time is directly behind the first, and as long in a unit of time.
        let span = |place: usize| {
            let stamps = columns.get(place).filter(|stamps| grows(stamps))?;
            Some(stamps.last()? - stamps.first()?)
        };
        let ratio = span(time + 1)
            .zip(span(time))
            .map(|(second, first)| (second / first).log10() / 3.0);
        let is_time = ratio.is_some_and(|ratio| (ratio - ratio.round()).abs() < ALIKE);
        let behind = (time + 1 + usize::from(is_time)..width).collect();
        let mut part = part;
        let stamp = |row: &str, weeks: &mut WeekClock| time_of(row.split(',').nth(time)?, weeks);
        let mut stamps = Vec::new();
        part.rows.retain(|(_, row)| {
            let stamp = stamp(row, weeks);
            stamps.extend(stamp);
            stamp.is_some()
        });
        Some(Self {
            part,
            width,
            time,
            behind,
            stamps,
        })
    }

    /// Whether its times are within those of another, or the other way round, by half of the shorter.
    fn overlaps(&self, other: &Self) -> bool {
        let span = |part: &Self| {
            let fold = |(low, high): (f64, f64), stamp: &f64| (low.min(*stamp), high.max(*stamp));
            part.stamps.iter().fold((f64::MAX, f64::MIN), fold)
        };
        let ([low, other_low], [high, other_high]) = {
            let (own, other) = (span(self), span(other));
            ([own.0, other.0], [own.1, other.1])
        };
        let both = high.min(other_high) - low.max(other_low);
        let (own, other) = (high - low, other_high - other_low);
        // Of another unit they would be within one as well, but a small part of it.
        2.0 * both >= own.min(other) && 3.0 * own.min(other) >= own.max(other)
    }

    /// The names of all columns; of a table without names those that its sensor and its numbers suggest.
    fn names(&self) -> Vec<String> {
        if !self.part.names.is_empty() {
            let mut names = self.part.names.clone();
            names.resize(self.width, String::new());
            return names;
        }
        let numbered = (0..self.width).map(|place| format!("{}_{}", self.part.name, place + 1));
        let mut names = Vec::from_iter(numbered);
        let mut name = |from: usize, words: [&str; 3]| {
            for (place, word) in self.behind.iter().skip(from).zip(words) {
                names[*place] = word.to_owned();
            }
        };
        let word = self.part.name.to_lowercase();
        let is_of_receiver = RECEIVERS.iter().any(|known| word.contains(known));
        match self.behind.len() {
            2.. if is_of_receiver && self.are_places() => name(0, ["lat", "lon", "alt"]),
            3..6 => name(0, ["x", "y", "z"]),
            6.. if word.contains("imu") || word.contains("inertial") => {
                let [first, second] = [0, 3].map(|from| self.unsteadiness(from));
                let (accel, gyro) = if first < second { (0, 3) } else { (3, 0) };
                name(accel, ["ax", "ay", "az"]);
                name(gyro, ["gx", "gy", "gz"]);
            }
            _ => {}
        }
        names[self.time] = "time".to_owned();
        names
    }

    /// The first numbers of the columns behind the times.
    fn numbers(&self) -> impl Iterator<Item = Vec<f64>> {
        let rows = self.part.rows.iter().take(ROWS);
        rows.map(|(_, row)| {
            let cells = Vec::from_iter(row.split(','));
            let number = |place: &usize| number::parse(cells.get(*place)?.as_bytes());
            let numbers = self.behind.iter().map(number);
            numbers.map(|number| number.unwrap_or(f64::NAN)).collect()
        })
    }

    /// Whether the two columns behind the times are latitudes and longitudes.
    fn are_places(&self) -> bool {
        let mut places = self.numbers().filter(|row| row.len() > 1);
        places.all(|row| {
            !row[0].is_finite()
                || row[0].abs() <= 90.0
                    && row[1].abs() <= 180.0
                    && (row[0].fract() != 0.0 || row[0] == 0.0)
        })
    }

    /// How much the size of three columns varies, over its mean: that of gravity does little.
    fn unsteadiness(&self, from: usize) -> f64 {
        let size = |row: Vec<f64>| {
            let three = row.iter().skip(from).take(3);
            three.map(|x| x * x).sum::<f64>().sqrt()
        };
        let sizes = Vec::from_iter(self.numbers().map(size).filter(|size| size.is_finite()));
        let mean = sizes.iter().sum::<f64>() / sizes.len() as f64;
        let apart = sizes.iter().map(|size| (size - mean).abs()).sum::<f64>() / sizes.len() as f64;
        apart / mean
    }
}

fn time_of(cell: &str, weeks: &mut WeekClock) -> Option<f64> {
    let cell = cell.trim().as_bytes();
    number::parse_finite(cell).or_else(|| stamps::any(weeks, cell))
}
