//! Two tables with times as one, `gyro.csv + accel.csv`: the rows of both by their time, each with the columns of its own and
//! blanks in those of the other, or both in one row where their times are equal.

use std::borrow::Cow;
use std::collections::VecDeque;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::fields::{Delimiter, Fields};
use super::lines::Lines;
use super::stamps;
use crate::number;
use crate::source;
use crate::time::WeekClock;
use crate::{ReadError, visible};

/// Between the names of the two files.
const PLUS: &str = " + ";
/// Rows that show the column of times.
const ROWS: usize = 200;

/// The two files that a name stands for; the second is in the folder of the first.
pub fn files(path: &Path) -> Option<[PathBuf; 2]> {
    let (first, second) = path.to_str()?.split_once(PLUS)?;
    let folder = Path::new(first).parent().unwrap_or(Path::new(""));
    (!path.exists()).then(|| [first.into(), folder.join(second)])
}

/// The name that stands for two files.
pub fn name(first: &Path, second: &Path) -> PathBuf {
    let whole = || second.canonicalize().unwrap_or(second.to_path_buf());
    let same = first.parent() == second.parent();
    let second = second
        .file_name()
        .filter(|_| same)
        .map_or_else(whole, PathBuf::from);
    format!("{}{PLUS}{}", first.display(), second.display()).into()
}

/// The text of the table that two files are.
///
/// # Errors
/// If one cannot be opened or has no column of times.
pub(crate) fn table(files: &[PathBuf; 2]) -> Result<impl Read + Send + 'static, ReadError> {
    let [first, second] = [Half::open(&files[0])?, Half::open(&files[1])?];
    let own = |half: &Half| Vec::from_iter(half.names.iter().map(|name| name.to_lowercase()));
    let shared = own(&first).iter().any(|name| own(&second).contains(name));
    let names = |half: &Half| {
        Vec::from_iter(
            half.names
                .iter()
                .map(|name| qualified(&half.stem, name, shared)),
        )
    };
    let header = [vec![first.time_name.clone()], names(&first), names(&second)].concat();
    Ok(Halves {
        held: (header.join(",") + "\n").into_bytes().into(),
        halves: [first, second],
    })
}

struct Half {
    /// The name of the file without its ending.
    stem: String,
    lines: Lines,
    delimiter: Delimiter,
    /// Place of the times, their name, and those of the other columns.
    time: usize,
    time_name: String,
    names: Vec<String>,
    weeks: WeekClock,
    /// The next row: its time, as a number and as it is, and the other cells.
    next: Option<(f64, String, String)>,
}

impl Half {
    fn open(path: &Path) -> Result<Self, ReadError> {
        let preview = super::header::preview(source::open(path)?, ROWS);
        let preview = preview.map_err(|error| error.in_log(path))?;
        let width = preview.rows.first().map_or(0, Vec::len);
        let grows = |place: &usize| {
            let stamps = preview
                .rows
                .iter()
                .filter_map(|row| row.get(*place).copied());
            let stamps = Vec::from_iter(stamps.filter(|stamp| stamp.is_finite()));
            stamps.len() > 2 && stamps.is_sorted() && stamps.first() < stamps.last()
        };
        let time = (0..width).find(grows).ok_or_else(|| {
            ReadError::new(path, "no column of times, by which it could be joined")
                .mend("log a time with each sample")
        })?;
        let mut names = match preview.names.len() == width {
            true => preview.names,
            false => (1..=width).map(|place| place.to_string()).collect(),
        };
        let stem = path.file_stem().unwrap_or_default();
        let mut lines = Lines::of_table(source::open(path)?, None);
        let first = lines.next_line().unwrap_or_default().to_vec();
        let mut half = Self {
            stem: stem
                .to_string_lossy()
                .split('.')
                .next()
                .unwrap_or_default()
                .to_owned(),
            delimiter: Delimiter::detect(&first),
            lines,
            time,
            time_name: plain(&names.remove(time)),
            names,
            weeks: WeekClock::default(),
            next: None,
        };
        half.next = half.row(&first);
        if half.next.is_none() {
            half.step();
        }
        Ok(half)
    }

    fn row(&mut self, line: &[u8]) -> Option<(f64, String, String)> {
        let mut cells =
            Vec::from_iter(Fields::new(line, self.delimiter).map(String::from_utf8_lossy));
        let text = (self.time < cells.len()).then(|| cells.remove(self.time))?;
        let stamp = || stamps::any(&mut self.weeks, text.as_bytes());
        let time = number::parse_finite(text.as_bytes()).or_else(stamp)?;
        cells.resize(self.names.len(), "".into());
        let plain = |cell: &Cow<str>| cell.replace(',', ".");
        let others = Vec::from_iter(cells.iter().map(plain)).join(",");
        Some((time, plain(&text), others))
    }

    /// To the next row with a time.
    fn step(&mut self) {
        self.next = None;
        while self.next.is_none() {
            let Some(line) = self.lines.next_line().map(<[u8]>::to_vec) else {
                return;
            };
            self.next = self.row(&line);
        }
    }
}

/// The name of a column, behind that of its table where it is the same in another or that of an axis alone.
pub(super) fn qualified(table: &str, name: &str, shared: bool) -> String {
    let axis = name.trim_start().to_lowercase();
    let mut letters = axis.chars();
    let is_axis = matches!(letters.next(), Some('x'..='z'))
        && letters.next().is_none_or(|next| !next.is_alphanumeric());
    let name = plain(name);
    match shared || is_axis {
        true => format!("{}.{name}", plain(table)),
        false => name,
    }
}

/// A name without what separates columns.
pub(super) fn plain(name: &str) -> String {
    visible(name).replace([',', '"'], " ")
}

struct Halves {
    halves: [Half; 2],
    /// What is left of the present line.
    held: VecDeque<u8>,
}

impl Read for Halves {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.held.is_empty() {
            let [first, second] = &self.halves;
            let time = |half: &Half| half.next.as_ref().map_or(f64::INFINITY, |(time, ..)| *time);
            let earliest = time(first).min(time(second));
            let now = [first, second]
                .map(|half| half.next.as_ref().filter(|(time, ..)| *time == earliest));
            let Some((_, stamp, _)) = now.iter().flatten().next() else {
                return Ok(0);
            };
            let blanks = |half: &Half| ",".repeat(half.names.len().saturating_sub(1));
            let cells =
                |k: usize| now[k].map_or_else(|| blanks(&self.halves[k]), |row| row.2.clone());
            self.held
                .extend(format!("{stamp},{},{}\n", cells(0), cells(1)).as_bytes());
            let taken = now.map(|row| row.is_some());
            for (half, taken) in self.halves.iter_mut().zip(taken) {
                if taken {
                    half.step();
                }
            }
        }
        self.held.read(into)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_tables_are_one_by_their_times() {
        let folder = std::env::temp_dir().join(format!("undrift-io-{}-halves", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let [gyro, accel] = ["gyro.csv", "accel.csv"].map(|file| folder.join(file));
        std::fs::write(&gyro, "time,x (rad/s),y\n0.1,1,2\n0.2,3,4\nend\n0.4,5,6\n").unwrap();
        std::fs::write(
            &accel,
            "n;time;x;bias y\n7;0.2;8;9\n7;0.3;10;11\n7;0.5;12;13\n",
        )
        .unwrap();
        let both = name(&gyro, &accel);
        assert_eq!(both, folder.join("gyro.csv + accel.csv"));
        assert_eq!(files(&both), Some([gyro.clone(), accel.clone()]));
        assert_eq!(files(&gyro), None);
        let mut text = String::new();
        table(&files(&both).unwrap())
            .unwrap()
            .read_to_string(&mut text)
            .unwrap();
        let expected = "time,gyro.x (rad/s),gyro.y,n,accel.x,bias y\n0.1,1,2,,,\n0.2,3,4,7,8,9\n0.3,,,7,10,11\n0.4,5,6,,,\n0.5,,,7,12,13\n";
        assert_eq!(text, expected);
        std::fs::write(&accel, "a,b\n1,2\n1,2\n1,2\n").unwrap();
        let error = table(&[gyro, accel]).err().unwrap().to_string();
        assert!(error.contains("accel.csv: no column of times"), "{error}");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
