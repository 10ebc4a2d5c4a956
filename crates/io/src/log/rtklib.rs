//! RTKLIB solution files (`.pos`).
//!
//! The header line that starts with `%` and the time system names the columns; rows without one, as receivers log
//! them, have RTKLIB's columns in their order, in GPST. Understood are
//! latitude/longitude/height in degrees or degrees-minutes-seconds, ECEF coordinates and
//! east-north-up baselines; times as date or as week and second; GPST, UTC and JST. Times are
//! given out as GPS seconds of the week in which the file starts, counting on past its end.
//!
//! The files hold standard deviations and, for the covariances, the root of their size with their
//! sign (RTKLIB manual 2.4.2, appendix B.1); they come out as covariances north-east-down.

mod header;

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::Position;
use undrift_nav::{Matrix3, Vector3};

use super::receiver::{Ready, by_lines, check};
use crate::entry::{Entries, Fix, Stream, StreamKind, Wanted};
use crate::epoch::ClockSource;
use crate::fix::{finite, independent, on_earth, quality_of_rtklib};
use crate::skipped::{SkipKind, shown};
use crate::source::Source;
use crate::source::without_byte_order_mark;
use crate::table::lines::{Lines, MAX_LINE, NextLine};
use crate::time::WeekClock;
use crate::{ReadError, number};
use header::{Axes, Components, Layout};

const STREAM: &str = "solution";

/// Whether a comment line before the first data names the columns of a solution, or the first rows have RTKLIB's.
pub(crate) fn detect(start: &[u8]) -> bool {
    layout(start).is_some()
}

/// Whether rows that begin so have no header that names their columns.
pub(crate) fn lacks_header(start: &[u8]) -> bool {
    layout(start).is_some_and(|(_, named)| !named)
}

/// Rows without a header that have to look like a solution.
const ROWS: usize = 3;

/// The columns of rows that begin so, and whether a header names them.
fn layout(start: &[u8]) -> Option<(Layout, bool)> {
    let start = without_byte_order_mark(start);
    let complete = start.iter().rposition(|byte| *byte == b'\n')?;
    let lines = start.get(..complete)?.split(|byte| *byte == b'\n');
    let mut rows = 0;
    let mut of_rows = None;
    for line in lines
        .map(<[u8]>::trim_ascii)
        .filter(|line| !line.is_empty())
    {
        if line.starts_with(b"%") {
            match Layout::from_line(line) {
                Some(named) if rows == 0 => return Some((named, true)),
                _ => continue,
            }
        }
        let layout = Layout::of_row(line)?;
        of_rows = of_rows.or(Some((layout, false)));
        rows += 1;
        if rows == ROWS {
            break;
        }
    }
    of_rows
}

pub(super) fn entries(source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    check(wanted, "an RTKLIB solution", [&[], &[STREAM], &[]])?;
    let mut lines = Lines::new(source);
    let (layout, first_row) = loop {
        let NextLine::Line(range) = lines.step() else {
            return Err(no_header());
        };
        let line = lines.bytes(range).trim_ascii();
        if let Some(layout) = Layout::from_line(line) {
            break (layout, None);
        }
        if !line.is_empty() && !line.starts_with(b"%") {
            match Layout::of_row(line) {
                Some(layout) => break (layout, Some((lines.number(), line.to_vec()))),
                None => return Err(no_header().at(lines.number())),
            }
        }
    };
    let base = match wanted {
        Wanted::Fixes { base, .. } => *base,
        _ => None,
    };
    if layout.axes == Axes::Baseline && base.is_none() {
        return Err(ReadError::nameless("has baselines, whose base is unknown")
            .at(lines.number())
            .key("gnss.base")
            .mend("give latitude, longitude and height of the base station"));
    }
    let reader = Reader {
        layout,
        base,
        weeks: WeekClock::default(),
        values: Vec::with_capacity(32),
        first_row,
    };
    let too_long = format!("over {MAX_LINE} bytes");
    Ok(by_lines(
        wanted,
        lines,
        Some(too_long),
        reader,
        Reader::line,
        |reader, ready| {
            reader.first(ready);
            Ok(())
        },
        |reader| reader.weeks.epoch(ClockSource::Gnss),
    ))
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    let mut lines = Lines::new(source);
    let mut messages = 0;
    while let Some(line) = lines.next_line() {
        let line = line.trim_ascii();
        messages += u64::from(!line.is_empty() && !line.starts_with(b"%"));
    }
    Ok(vec![Stream {
        name: STREAM.to_owned(),
        kind: StreamKind::Fixes,
        about: "epochs".to_owned(),
        messages,
    }])
}

struct Reader {
    layout: Layout,
    base: Option<Geodetic>,
    weeks: WeekClock,
    /// The fields after the time; `None` is text.
    values: Vec<Option<f64>>,
    /// The row that showed the columns, and its number.
    first_row: Option<(u64, Vec<u8>)>,
}

impl Reader {
    fn line(&mut self, at: u64, line: &[u8], ready: &mut Ready) -> Result<(), ReadError> {
        self.first(ready);
        self.row(at, line, ready);
        Ok(())
    }

    /// Reads the row that showed the columns.
    fn first(&mut self, ready: &mut Ready) {
        if let Some((at, row)) = self.first_row.take() {
            self.row(at, &row, ready);
        }
    }

    fn row(&mut self, at: u64, line: &[u8], ready: &mut Ready) {
        let line = line.trim_ascii();
        if line.starts_with(b"%") {
            // Solutions that were put one after the other have a header each.
            self.layout = Layout::from_line(line).unwrap_or(self.layout);
        } else if !line.is_empty() {
            let mut tokens = line.split(|byte| b" \t,;".contains(byte));
            let mut tokens = tokens.by_ref().filter(|token| !token.is_empty());
            let (first, second) = (tokens.next(), tokens.next().unwrap_or_default());
            let first = first.unwrap_or_default();
            match self.weeks.seconds(first, second, self.layout.system) {
                Some(time) => {
                    self.values.clear();
                    self.values.extend(tokens.map(number::parse));
                    if let Some(fix) = self.fix(time, at, ready) {
                        ready.fix(at, fix);
                    }
                }
                None => ready.skip(at, SkipKind::Text, shown(line)),
            }
        }
    }

    fn fix(&self, time: f64, at: u64, ready: &mut Ready) -> Option<Fix> {
        let numbers = self.three(self.layout.position, at, ready)?;
        // Rotation from the axes of the file to north-east-down, for everything of this epoch.
        let (position, ned_from_file) = match self.layout.axes {
            Axes::Geodetic | Axes::GeodeticDms => {
                let place = Geodetic::from_degrees(numbers.x, numbers.y, numbers.z);
                (Position::Geodetic(place), NED_FROM_NEU)
            }
            Axes::Ecef => {
                let place = Geodetic::from_ecef(&numbers);
                (Position::Geodetic(place), place.ned_from_ecef())
            }
            Axes::Baseline => {
                let base = self.base?;
                let ned = NED_FROM_ENU * numbers;
                (Position::Baseline { base, ned }, NED_FROM_ENU)
            }
        };
        if let Position::Geodetic(place) = position {
            ready.usable(at, on_earth(place))?;
        }
        let velocity = self.layout.velocity.and_then(|places| {
            let velocity = self.three(places.map(|index| (index, 1)), at, ready)?;
            let covariance = self.covariance(self.layout.velocity_sd, ned_from_file);
            Some((ned_from_file * velocity, covariance))
        });
        let quality = self.layout.quality.and_then(|at| self.value(at));
        Some(Fix {
            mean_velocity: None,
            time,
            position: Some((
                position,
                self.covariance(self.layout.position_sd, ned_from_file),
            )),
            velocity,
            quality: quality.map_or_else(Default::default, quality_of_rtklib),
        })
    }

    /// Covariance north-east-down of a position or velocity, zero where a standard deviation is unusable;
    /// `None` where the file has none.
    fn covariance(&self, at: Option<Components>, ned_from_file: Matrix3) -> Option<Matrix3> {
        let at = at?;
        let get = |index: usize| self.value(index).unwrap_or(f64::NAN);
        let own = independent(&Vector3::from(at.std.map(get))).unwrap_or_else(Matrix3::zeros);
        let mut full = own;
        if let Some(cross) = at.cross {
            let places = [(0, 1), (1, 2), (2, 0)];
            for (index, (i, j)) in cross.into_iter().zip(places) {
                let root = self.value(index).unwrap_or(0.0);
                full[(i, j)] = root * root.abs();
                full[(j, i)] = full[(i, j)];
            }
        }
        // Printed to four decimals, small covariances can come out impossible.
        let possible = (full - own * 1e-6).cholesky().is_some();
        let in_file = if possible { full } else { own };
        Some(ned_from_file * in_file * ned_from_file.transpose())
    }

    fn value(&self, at: usize) -> Option<f64> {
        self.values.get(at).copied().flatten()
    }

    /// Three finite numbers at the places, each of one field or, in degrees-minutes-seconds, of three.
    fn three(&self, places: [(usize, usize); 3], at: u64, ready: &mut Ready) -> Option<Vector3> {
        let mut out = Vector3::zeros();
        for (k, (from, fields)) in places.into_iter().enumerate() {
            let mut parts = [0.0; 3];
            for (part, index) in parts.iter_mut().zip(from..from + fields) {
                match self.values.get(index) {
                    Some(Some(value)) => *part = *value,
                    Some(None) => {
                        ready.skip(at, SkipKind::Text, format!("field {}", index + 3));
                        return None;
                    }
                    None => {
                        let (has, wants) = (self.values.len() + 2, index + 3);
                        let detail = format!("{has} fields, field {wants} is wanted");
                        ready.skip(at, SkipKind::MissingField, detail);
                        return None;
                    }
                }
            }
            let [degrees, minutes, seconds] = parts;
            // The sign is at the degrees, also at −0.
            let size = degrees.abs() + minutes / 60.0 + seconds / 3600.0;
            out[k] = size.copysign(degrees);
        }
        ready.usable(at, finite(out))
    }
}

const NED_FROM_NEU: Matrix3 = Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0);
const NED_FROM_ENU: Matrix3 = Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0);

fn no_header() -> ReadError {
    ReadError::nameless("no header line that names the columns of an RTKLIB solution")
        .mend("it looks like \"%  GPST  latitude(deg) longitude(deg) …\"; write the solution with its header")
}

#[cfg(test)]
mod tests;
