//! RTKLIB solution files (`.pos`), read through [`crate::gnss::GnssReader::open_rtklib`].
//!
//! The header line that starts with `%` and the time system names the columns. Understood are
//! latitude/longitude/height in degrees or degrees-minutes-seconds, ECEF coordinates and
//! east-north-up baselines; times as date or as week and second; GPST, UTC and JST. Times are
//! given out as GPS seconds of the week in which the file starts, counting on past its end.
//!
//! The files hold standard deviations and, for the covariances, the root of their size with their
//! sign (RTKLIB manual 2.4.2, appendix B.1); they come out as covariances north-east-down.

mod header;

use std::path::{Path, PathBuf};

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{GnssFix, Position};
use undrift_nav::{Matrix3, Vector3};

use crate::ReadError;
use crate::gnss::{FixOptions, all_finite, diagonal, is_a_fix, quality_of_rtklib};
use crate::lines::{Lines, MAX_LINE, Step};
use crate::number;
use crate::skipped::{SkipKind, Skipped};
use crate::source::{self, Source};
use crate::table::shown;

use crate::time::WeekClock;
use header::{Axes, Components, Layout};

/// How to read an RTKLIB solution file.
#[derive(Clone, Debug, Default)]
pub struct RtklibOptions {
    /// How certain the fixes are, and which are given out.
    pub fixes: FixOptions,
    /// The base station of east-north-up baselines.
    pub base: Option<Geodetic>,
}

/// Whether a file is an RTKLIB solution: a comment line before its first data names the columns.
///
/// # Errors
/// If the file cannot be opened.
pub fn detect(path: &Path) -> Result<bool, ReadError> {
    let mut lines = Lines::new(source::open(path)?);
    loop {
        match lines.step() {
            Step::Line(range) => {
                let line = lines.bytes(range).trim_ascii();
                if Layout::of(line).is_some() {
                    return Ok(true);
                }
                if !line.is_empty() && !line.starts_with(b"%") {
                    return Ok(false);
                }
            }
            Step::TooLong | Step::End => return Ok(false),
        }
    }
}

/// The epochs of a solution file.
pub(crate) struct RtklibRows {
    path: PathBuf,
    lines: Lines,
    layout: Layout,
    options: RtklibOptions,
    weeks: WeekClock,
    /// The fields after the time; `None` is text.
    values: Vec<Option<f64>>,
    finished: bool,
    skipped: Skipped,
}

impl RtklibRows {
    pub(crate) fn new(
        path: &Path,
        source: Source,
        options: &RtklibOptions,
    ) -> Result<Self, ReadError> {
        let mut lines = Lines::new(source);
        let layout = loop {
            let Step::Line(range) = lines.step() else {
                return Err(no_header(path));
            };
            let line = lines.bytes(range).trim_ascii();
            if let Some(layout) = Layout::of(line) {
                break layout;
            }
            if !line.is_empty() && !line.starts_with(b"%") {
                return Err(no_header(path).at(lines.number()));
            }
        };
        options.fixes.check(path)?;
        if layout.axes == Axes::Baseline && options.base.is_none() {
            return Err(ReadError::new(path, "has baselines, whose base is unknown")
                .at(lines.number())
                .key("gnss.base")
                .mend("give latitude, longitude and height of the base station"));
        }
        Ok(Self {
            path: path.to_path_buf(),
            lines,
            layout,
            options: options.clone(),
            weeks: WeekClock::default(),
            values: Vec::with_capacity(32),
            finished: false,
            skipped: Skipped::default(),
        })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn skipped(&self) -> &Skipped {
        &self.skipped
    }

    pub(crate) fn skipped_mut(&mut self) -> &mut Skipped {
        &mut self.skipped
    }

    /// The next epoch with a usable part, and its line.
    pub(crate) fn next_row(&mut self) -> Result<Option<(u64, GnssFix)>, ReadError> {
        while !self.finished {
            let range = match self.lines.step() {
                Step::Line(range) => range,
                Step::TooLong => {
                    let detail = format_args!("over {MAX_LINE} bytes");
                    self.skipped
                        .add(SkipKind::TooLong, self.lines.number(), detail);
                    continue;
                }
                Step::End => {
                    self.finished = true;
                    if let Some(failure) = self.lines.failure() {
                        self.skipped
                            .add(SkipKind::EndsEarly, self.lines.number(), failure);
                    }
                    break;
                }
            };
            let number = self.lines.number();
            let line = self.lines.bytes(range).trim_ascii();
            if line.is_empty() {
                continue;
            }
            if line.starts_with(b"%") {
                // Solutions that were put one after the other have a header each.
                self.layout = Layout::of(line).unwrap_or(self.layout);
                continue;
            }
            let mut tokens = line.split(|byte| b" \t,;".contains(byte));
            let mut tokens = tokens.by_ref().filter(|token| !token.is_empty());
            let (first, second) = (tokens.next(), tokens.next().unwrap_or_default());
            let first = first.unwrap_or_default();
            let Some(time) = self.weeks.seconds(first, second, self.layout.system) else {
                let detail = shown(line);
                self.skipped.add(SkipKind::Text, number, detail);
                continue;
            };
            self.values.clear();
            self.values.extend(tokens.map(number::parse));
            if let Some(fix) = self.fix(time + self.options.fixes.time_offset, number) {
                return Ok(Some((number, fix)));
            }
        }
        Ok(None)
    }

    fn fix(&mut self, time: f64, line: u64) -> Option<GnssFix> {
        let layout = self.layout;
        let numbers = self.three(layout.position, line)?;
        if !all_finite(&numbers, line, &mut self.skipped) {
            return None;
        }
        // Rotation from the axes of the file to north-east-down, for everything of this epoch.
        let (position, ned_from_file) = match layout.axes {
            Axes::Geodetic | Axes::GeodeticDms => {
                let place = Geodetic::from_degrees(numbers.x, numbers.y, numbers.z);
                (Position::Geodetic(place), NED_FROM_NEU)
            }
            Axes::Ecef => {
                let place = Geodetic::from_ecef(&numbers);
                (Position::Geodetic(place), place.ned_from_ecef())
            }
            Axes::Baseline => {
                let position = Position::Baseline {
                    base: self.options.base?,
                    ned: NED_FROM_ENU * numbers,
                };
                (position, NED_FROM_ENU)
            }
        };
        if let Position::Geodetic(place) = &position
            && !is_a_fix(place)
        {
            let detail = format_args!("{}, {}, {}", numbers.x, numbers.y, numbers.z);
            self.skipped.add(SkipKind::OutOfRange, line, detail);
            return None;
        }
        let (constant, factor) = (
            self.options.fixes.position_std,
            self.options.fixes.position_std_factor,
        );
        let covariance = self.covariance(layout.position_sd, constant, factor, ned_from_file, line);
        let fix = GnssFix {
            time,
            position: covariance.map(|covariance| (position, covariance)),
            velocity: self.velocity(&layout, ned_from_file, line),
            quality: layout
                .quality
                .and_then(|at| self.value(at))
                .map_or_else(Default::default, quality_of_rtklib),
        };
        (fix.position.is_some() || fix.velocity.is_some()).then_some(fix)
    }

    fn velocity(
        &mut self,
        layout: &Layout,
        ned_from_file: Matrix3,
        line: u64,
    ) -> Option<(Vector3, Matrix3)> {
        let at = layout.velocity?;
        if layout.velocity_sd.is_none() && self.options.fixes.velocity_std.is_none() {
            return None;
        }
        let velocity = self.three(at.map(|index| (index, 1)), line)?;
        if !all_finite(&velocity, line, &mut self.skipped) {
            return None;
        }
        let (constant, factor) = (
            self.options.fixes.velocity_std,
            self.options.fixes.velocity_std_factor,
        );
        let covariance =
            self.covariance(layout.velocity_sd, constant, factor, ned_from_file, line)?;
        Some((ned_from_file * velocity, covariance))
    }

    /// Covariance north-east-down of a position or velocity, or `None`, counted.
    fn covariance(
        &mut self,
        at: Option<Components>,
        constant: Option<[f64; 3]>,
        factor: f64,
        ned_from_file: Matrix3,
        line: u64,
    ) -> Option<Matrix3> {
        if let Some(std) = constant {
            return diagonal(&(Vector3::from(std) * factor), line, &mut self.skipped);
        }
        let Some(at) = at else {
            self.skipped
                .add(SkipKind::Uncertainty, line, "no standard deviations");
            return None;
        };
        let get = |index: usize| self.value(index).unwrap_or(f64::NAN);
        let std = Vector3::from(at.std.map(get)) * factor;
        let own = diagonal(&std, line, &mut self.skipped)?;
        let mut full = own;
        if let Some(cross) = at.cross {
            let places = [(0, 1), (1, 2), (2, 0)];
            for (index, (i, j)) in cross.into_iter().zip(places) {
                let root = self.value(index).unwrap_or(0.0) * factor;
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

    /// Three numbers at the places, each of one field or, in degrees-minutes-seconds, of three.
    fn three(&mut self, places: [(usize, usize); 3], line: u64) -> Option<Vector3> {
        let mut out = Vector3::zeros();
        for (k, (from, fields)) in places.into_iter().enumerate() {
            let mut parts = [0.0; 3];
            for (part, index) in parts.iter_mut().zip(from..from + fields) {
                match self.values.get(index) {
                    Some(Some(value)) => *part = *value,
                    Some(None) => {
                        let detail = format_args!("field {}", index + 3);
                        self.skipped.add(SkipKind::Text, line, detail);
                        return None;
                    }
                    None => {
                        let (has, wants) = (self.values.len() + 2, index + 3);
                        let detail = format_args!("{has} fields, field {wants} is wanted");
                        self.skipped.add(SkipKind::MissingField, line, detail);
                        return None;
                    }
                }
            }
            let [degrees, minutes, seconds] = parts;
            // The sign stands at the degrees, also at −0.
            let size = degrees.abs() + minutes / 60.0 + seconds / 3600.0;
            out[k] = size.copysign(degrees);
        }
        Some(out)
    }
}

const NED_FROM_NEU: Matrix3 = Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0);
const NED_FROM_ENU: Matrix3 = Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0);

fn no_header(path: &Path) -> ReadError {
    ReadError::new(path, "no header line that names the columns of an RTKLIB solution")
        .mend("it looks like \"%  GPST  latitude(deg) longitude(deg) …\"; write the solution with its header")
}

#[cfg(test)]
mod tests;
