//! What a file is, what it holds, in which units by which signs, and a first `DRIVE.toml` for it.

mod columns;
mod known;
mod measure;
mod units;

pub use known::{Content, Known, Note};
pub use measure::about_gravity;

use serde::Serialize;
use std::path::{Path, PathBuf};
use undrift_io::{
    ReadError,
    format::{self, Format},
    layouts::KF_GINS_WITH_VELOCITY,
    log::{self, StreamKind},
    table::Preview,
};

/// What a file is.
#[derive(Clone, Debug, Serialize)]
pub struct Inspection {
    /// The file, as it was given.
    pub file: PathBuf,
    /// Name of its format in a drive file.
    pub format: &'static str,
    /// What the format is called.
    pub description: &'static str,
    /// The streams of a log: name, messages, and what they are.
    pub streams: Vec<(String, u64, String)>,
    /// What of it can be read.
    pub parts: Vec<Part>,
    /// What is worth knowing.
    pub found: Vec<Note>,
    /// The same in sentences; who shows it fills them in.
    pub notes: Vec<String>,
}

/// A table of `DRIVE.toml` that reads something of the file.
#[derive(Clone, Debug, Serialize)]
pub struct Part {
    /// `imu`, `gnss` or `truth`.
    pub table: &'static str,
    /// Its keys beside `file`.
    pub lines: Vec<Line>,
    /// What was read with them.
    pub measured: Option<Measured>,
    /// Why nothing was.
    pub problem: Option<String>,
    /// The streams that a key may name, the first of each the likeliest.
    #[serde(skip)]
    pub choices: Vec<(&'static str, Vec<String>)>,
}

/// A key of a drive file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    /// The key.
    pub key: &'static str,
    /// Its value, as TOML writes it.
    pub value: String,
    /// How it is known.
    pub known: Known,
    /// The same in words, empty where it is certain; who shows it fills them in.
    pub why: String,
}

/// What a part holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Samples, fixes or reference solutions.
    pub records: u64,
    /// First time \[s\].
    pub first_s: f64,
    /// Last time \[s\].
    pub last_s: f64,
    /// 1 / the ordinary interval \[Hz\].
    pub rate_hz: f64,
    /// Intervals of more than 1.5 ordinary ones.
    pub gaps: u64,
    /// Start and length of the longest \[s\].
    pub longest_gap_s: Option<(f64, f64)>,
    /// What was left out, a line each.
    pub skipped: String,
    /// Velocities left out because the log does not tell how certain they are.
    pub untold_velocities: u64,
    /// What else it holds.
    pub content: Option<Content>,
    /// The same in sentences; who shows it fills them in.
    pub remarks: Vec<String>,
}

impl Line {
    fn new(key: &'static str, value: String, known: Known) -> Self {
        Self {
            key,
            value,
            known,
            why: String::new(),
        }
    }

    /// A text value.
    fn text(key: &'static str, value: &str, known: Known) -> Self {
        Self::new(key, quoted(value), known)
    }
}

/// A text as TOML writes it.
pub fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// Tells what a file is.
///
/// # Errors
/// If the file cannot be opened or is no log. What cannot be read of it is told in the parts.
pub fn inspect(path: &Path) -> Result<Inspection, ReadError> {
    let format = format::detect(path)?;
    let mut inspection = Inspection {
        file: path.to_path_buf(),
        format: format.name(),
        description: format.describe(),
        streams: Vec::new(),
        parts: Vec::new(),
        found: Vec::new(),
        notes: Vec::new(),
    };
    inspection.parts = match format {
        Format::Csv | Format::Parquet => columns::parts(path, &mut inspection.found)?,
        Format::Rtklib => vec![Part::new("gnss", Vec::new())],
        Format::Euroc => vec![Part::new("imu", Vec::new())],
        Format::KfGins => vec![Part::new(kf_gins(path)?, Vec::new())],
        log => {
            let streams = log::streams(path, log)?;
            let parts = of_streams(&streams);
            inspection.streams = streams
                .into_iter()
                .map(|stream| (stream.name, stream.messages, stream.about))
                .collect();
            parts
        }
    };
    for part in &mut inspection.parts {
        measure::measure(path, format, part);
    }
    if inspection.parts.is_empty() {
        inspection.found.push(Note::Nothing);
    }
    Ok(inspection)
}

/// What the names of columns alone tell: the parts that they can serve, each with the keys that no
/// number was looked at for. A unit that no name tells is left out.
pub fn by_names(names: &[String]) -> Vec<Part> {
    let table = Preview {
        names: names.to_vec(),
        rows: Vec::new(),
    };
    let mut parts = columns::parts_of(table, &mut Vec::new());
    for part in &mut parts {
        part.lines
            .retain(|line| matches!(line.known, Known::Name { .. }));
    }
    parts
}

impl Part {
    fn new(table: &'static str, lines: Vec<Line>) -> Self {
        Self {
            table,
            lines,
            measured: None,
            problem: None,
            choices: Vec::new(),
        }
    }
}

/// Which of its three texts a file of KF-GINS is.
fn kf_gins(path: &Path) -> Result<&'static str, ReadError> {
    let columns = format::columns(path)?;
    Ok(match columns {
        11 => "truth",
        KF_GINS_WITH_VELOCITY => "gnss",
        _ => {
            let mut imu = Part::new("imu", Vec::new());
            measure::measure(path, Format::KfGins, &mut imu);
            if imu.problem.is_none() && measure::is_gravity(&imu) {
                "imu"
            } else {
                "gnss"
            }
        }
    })
}

/// A part for each kind of streams that there is.
fn of_streams(streams: &[log::Stream]) -> Vec<Part> {
    let of = |kind: StreamKind| -> Vec<String> {
        let those = streams.iter().filter(|stream| stream.kind == kind);
        those.map(|stream| stream.name.clone()).collect()
    };
    let mut parts = Vec::new();
    for (table, kind) in [
        ("imu", StreamKind::Imu),
        ("gnss", StreamKind::Fixes),
        ("truth", StreamKind::Poses),
    ] {
        let names = of(kind);
        if names.is_empty() {
            continue;
        }
        let mut part = Part::new(table, Vec::new());
        part.choices.push(("topic", names));
        if kind == StreamKind::Fixes {
            let velocities = of(StreamKind::Velocity);
            part.choices.push(("velocity_topic", velocities));
        }
        parts.push(part);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_alone_tell_no_unit_that_they_do_not_say() {
        let told = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
            let parts = by_names(&names).into_iter();
            let lines = |part: Part| part.lines.into_iter().map(|l| (l.key, l.value)).collect();
            parts.map(lines).collect::<Vec<Vec<_>>>()
        };
        let imu = |gyro: &'static str, accel: &'static str| {
            let columns = |key, stem: &str| {
                let [x, y, z] = ["x", "y", "z"].map(|axis| stem.replace('?', axis));
                (key, format!("[\"{x}\", \"{y}\", \"{z}\"]"))
            };
            [columns("gyro", gyro), columns("accel", accel)]
        };
        let [gyro, accel] = imu("gyro_?", "accel_?");
        let names = [
            "gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z",
        ];
        assert_eq!(told(&names), [[gyro, accel]]);
        let [gyro, accel] = imu("g?_dps", "a?_g");
        let names = ["t_ms", "gx_dps", "gy_dps", "gz_dps", "ax_g", "ay_g", "az_g"];
        let expected = [
            ("time", "\"t_ms\"".to_owned()),
            ("time_unit", "\"ms\"".to_owned()),
            gyro,
            ("gyro_unit", "\"deg/s\"".to_owned()),
            accel,
            ("accel_unit", "\"g\"".to_owned()),
        ];
        assert_eq!(told(&names), [expected]);
        let fixes = told(&["time", "lat", "lon", "height"]);
        assert_eq!(fixes.concat().len(), 2, "time and position: {fixes:?}");
    }
}
