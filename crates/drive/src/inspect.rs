//! What a file is, what it holds, in which units by which signs, and a first `DRIVE.toml` for it.

mod clocks;
mod columns;
mod file;
mod found;
mod gravity;
mod joined;
mod measure;
mod motion;
mod numbers;
mod places;
mod poses;
mod receiver;
mod sensor;
mod topics;
mod units;

pub use file::{drive_file, with_model};
pub use joined::of_two;
pub use motion::motion;
pub use sensor::model;
pub use undrift_results::inspect::{
    Comment, Content, CounterRestarts, Flight, Inspection, Known, Line, Measured, Model, Motion,
    Note, Part, PoseFault, Start, Wheels, about_gravity,
};

pub(crate) use numbers::{are_exchanged, three_of};
pub(crate) use topics::choose as choose_topic;
pub(crate) use units::rate as unit_of_rates;

use crate::drive::Logs;
use std::path::Path;
use undrift_io::{
    Memory, Opened, ReadError,
    format::Format,
    layouts::KF_GINS_WITH_VELOCITY,
    log::{Stream, StreamKind},
    source::BytesRead,
    table::Preview,
};
use undrift_results::inspect::{pose_notes, pose_piece};

/// Standard deviations to begin with where a log does not have any: a single-frequency receiver
/// under an open sky.
const POSITION_STD: &str = "3, 3, 6 m";
const VELOCITY_STD: &str = "0.2, 0.2, 0.4 m/s";
/// The same where the vertical velocity is not known: 20 m/s leave it open.
const LEVEL_VELOCITY_STD: &str = "0.2, 0.2, 20 m/s";

/// Identifies a log file: its format, columns and units.
///
/// # Errors
/// If the file cannot be opened or is not a log. Parts that cannot be read are marked in the result.
pub fn inspect(path: &Path) -> Result<Inspection, ReadError> {
    of_log(path, Opened::hold(path)?)
}

/// As [`inspect`], of a log in memory; `path` is what messages and the drive file call it.
///
/// # Errors
/// As [`inspect`].
pub fn inspect_held(path: &Path, held: Memory) -> Result<Inspection, ReadError> {
    of_log(path, Some(held))
}

fn of_log(path: &Path, held: Option<Memory>) -> Result<Inspection, ReadError> {
    let mut logs = Logs::default();
    if let Some(held) = &held {
        logs.memory.insert(path.to_path_buf(), held.clone());
    }
    let mut opened = logs.open(path, &BytesRead::default())?;
    let format = opened.format();
    let mut inspection = Inspection {
        file: path.to_path_buf(),
        format: format.name(),
        description: format.describe(),
        streams: Vec::new(),
        parts: Vec::new(),
        found: Vec::new(),
        held,
    };
    inspection.parts = match format {
        Format::Csv | Format::Parquet if poses::are_in(&mut opened) => vec![poses::part()],
        Format::Csv | Format::Parquet => columns::parts(opened, &mut inspection.found)?,
        Format::Rtklib => {
            let assumed = opened.lacks_header().then_some(Note::NoHeader);
            inspection.found.extend(assumed);
            vec![Part::new("gnss", Vec::new())]
        }
        Format::Euroc => vec![Part::new("imu", Vec::new())],
        Format::KfGins => vec![Part::new(
            kf_gins(path, opened.width(), &mut logs),
            Vec::new(),
        )],
        log => {
            let streams = opened.streams(log)?;
            let mut parts = of_streams(&streams, &mut inspection.found);
            if log == Format::Nmea {
                // The rows of a sensor may be between the sentences.
                let between = logs.open(path, &BytesRead::default())?;
                let between = columns::parts(between, &mut Vec::new()).unwrap_or_default();
                parts.extend(between.into_iter().filter(|part| part.table == "imu"));
            }
            inspection.streams = streams
                .into_iter()
                .map(|stream| (stream.name, stream.messages, stream.about))
                .collect();
            parts
        }
    };
    for part in &mut inspection.parts {
        let names = part.choices.iter().find(|(key, _)| *key == "topic");
        if let Some((_, names)) = names.filter(|(_, names)| part.table == "imu" && names.len() > 1)
        {
            let chosen = choose_topic(path, &logs, format, names);
            part.lines.extend(chosen);
        }
        measure::measure(path, &mut logs, format, part);
    }
    if inspection.parts.is_empty() {
        inspection.found.push(Note::Nothing);
    }
    Ok(inspection)
}

/// The first part of the files that is such a table, and its file.
fn first<'a>(files: &'a [Inspection], table: &str) -> Option<(&'a Inspection, &'a Part)> {
    let mut parts = files
        .iter()
        .flat_map(|file| file.parts.iter().map(move |part| (file, part)));
    parts.find(|(_, part)| part.table == table)
}

/// Keys that say how the IMU sits.
const SITS: [&str; 3] = ["axes", "mounting", "mounting_std"];

/// The table that corrects the solution: "gnss", or "poses" where the files have poses and no fixes.
pub fn fixes_table(inspections: &[Inspection]) -> &'static str {
    let has = |table| first(inspections, table).is_some();
    if has("poses") && !has("gnss") {
        "poses"
    } else {
        "gnss"
    }
}

/// The table of a drive file that reads a part of a file.
fn table(file: &Path, part: &Part) -> toml::Table {
    let lines = part.lines.iter().map(|line| (line.key, line.value.clone()));
    let file = ("file", (*file.to_string_lossy()).into());
    let keys = [file].into_iter().chain(lines);
    keys.map(|(key, value)| (key.to_owned(), value)).collect()
}

/// Rate \[Hz\] of an inertial log without times, which is a guess.
pub fn guessed_rate(inspections: &[Inspection]) -> Option<f64> {
    let (_, imu) = first(inspections, "imu")?;
    let guess = |line: &&Line| matches!(line.known, Known::NoTimes | Known::RowsOfFixes);
    let line = imu.lines.iter().find(guess)?;
    line.value.as_str()?.strip_suffix(" Hz")?.parse().ok()
}

/// What is wrong with poses, and is taken into account in the drive file of them.
pub fn pose_faults(inspections: &[Inspection]) -> Vec<PoseFault> {
    let cut = pose_piece(inspections).is_some();
    pose_notes(inspections)
        .filter(|fault| fault.is_mended(cut))
        .cloned()
        .collect()
}

/// Where the logs are: those in memory, and files relative to `folder`.
pub fn logs(inspections: &[Inspection], folder: &Path) -> Logs {
    let held = inspections.iter();
    let held = held.filter_map(|log| Some((log.file.clone(), log.held.clone()?)));
    Logs {
        memory: held.collect(),
        folder: folder.to_path_buf(),
        ..Logs::default()
    }
}

/// What the names of columns alone show: the parts that they can serve, each with the keys that no
/// number was looked at for. Units that no name states are omitted.
pub fn by_names(names: &[String]) -> Vec<Part> {
    let table = Preview {
        names: names.to_vec(),
        ..Preview::default()
    };
    let mut parts = columns::parts_of(table, &mut Vec::new());
    for part in &mut parts {
        part.lines
            .retain(|line| matches!(line.known, Known::Name { .. }));
    }
    parts
}

/// What the names of a table's columns and its first rows show: the parts that they can serve.
pub fn of_table(beginning: Preview) -> Vec<Part> {
    columns::parts_of(beginning, &mut Vec::new())
}

/// Which of its three texts a file of KF-GINS is.
fn kf_gins(path: &Path, columns: usize, logs: &mut Logs) -> &'static str {
    match columns {
        11 => "truth",
        KF_GINS_WITH_VELOCITY => "gnss",
        _ => {
            let mut imu = Part::new("imu", Vec::new());
            measure::measure(path, logs, Format::KfGins, &mut imu);
            if imu.problem.is_none() && measure::is_gravity(&imu) {
                "imu"
            } else {
                "gnss"
            }
        }
    }
}

/// A part for each kind of streams that there is; those that are declared and have no message are noted.
fn of_streams(streams: &[Stream], notes: &mut Vec<Note>) -> Vec<Part> {
    let all = |kind: StreamKind, empty: bool| -> Vec<String> {
        let those = streams.iter().filter(|stream| stream.kind == kind);
        let those = those.filter(|stream| (stream.messages == 0) == empty);
        those.map(|stream| stream.name.clone()).collect()
    };
    let of = |kind: StreamKind| all(kind, false);
    let mut parts = Vec::new();
    for (table, kind) in [
        ("imu", StreamKind::Imu),
        ("gnss", StreamKind::Fixes),
        ("truth", StreamKind::Poses),
        ("poses", StreamKind::LocalPoses),
        ("heading", StreamKind::Headings),
        ("magnetometer", StreamKind::Fields),
    ] {
        let names = of(kind);
        if names.is_empty() {
            let empty = all(kind, true);
            if !empty.is_empty() {
                notes.push(Note::Empty {
                    table: table.to_owned(),
                    streams: empty,
                });
            }
            continue;
        }
        let mut part = match kind {
            StreamKind::LocalPoses => poses::part(),
            _ => Part::new(table, Vec::new()),
        };
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
        let keys_of = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
            let parts = by_names(&names).into_iter();
            let line = |line: Line| (line.key, line.value.to_string());
            let lines = |part: Part| part.lines.into_iter().map(line).collect();
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
        assert_eq!(keys_of(&names), [[gyro, accel]]);
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
        assert_eq!(keys_of(&names), [expected]);
        let names = [
            "UTC_date",
            "UTC_time",
            "x-ecef(m)",
            "y-ecef(m)",
            "z-ecef(m)",
            "vx_ecef",
            "vy_ecef",
            "vz_ecef",
        ];
        let earth_fixed = [
            ("time", "\"UTC_time\""),
            ("date", "\"UTC_date\""),
            ("ecef", "[\"x-ecef(m)\", \"y-ecef(m)\", \"z-ecef(m)\"]"),
            ("velocity", "[\"vx_ecef\", \"vy_ecef\", \"vz_ecef\"]"),
            ("velocity_axes", "\"ecef\""),
        ];
        assert_eq!(
            keys_of(&names),
            [earth_fixed.map(|(k, v)| (k, v.to_owned()))]
        );
        let fixes = keys_of(&["time", "lat", "lon", "height"]);
        assert_eq!(fixes.concat().len(), 2, "time and position: {fixes:?}");
    }

    #[test]
    fn streams_without_a_message_are_noted_and_not_proposed() {
        let stream = |name: &str, kind, messages| Stream {
            name: name.to_owned(),
            kind,
            about: String::new(),
            messages,
        };
        let streams = [
            stream("sensor_combined.0", StreamKind::Imu, 100),
            stream("sensor_combined.1", StreamKind::Imu, 0),
            stream("vehicle_gps_position.0", StreamKind::Fixes, 0),
            stream("other", StreamKind::Other, 0),
        ];
        let mut notes = Vec::new();
        let parts = of_streams(&streams, &mut notes);
        assert_eq!(parts.len(), 1);
        let choices = vec![("topic", vec!["sensor_combined.0".to_owned()])];
        assert_eq!((parts[0].table, &parts[0].choices), ("imu", &choices));
        let empty = Note::Empty {
            table: "gnss".to_owned(),
            streams: vec!["vehicle_gps_position.0".to_owned()],
        };
        assert_eq!(notes, [empty]);
    }

    #[test]
    fn a_table_of_kalibr_has_six_axes_with_their_units() {
        let names = "timestamp omega_x omega_y omega_z alpha_x alpha_y alpha_z";
        let row = |k: u32| {
            let stamp = 1.7e18 + 1e7 * f64::from(k);
            vec![stamp, 0.001, 0.002, 0.003, 0.1, 0.2, 9.8]
        };
        let table = Preview {
            names: names.split(' ').map(str::to_owned).collect(),
            rows: (0..20).map(row).collect(),
            ..Preview::default()
        };
        let parts = of_table(table);
        let value = |key: &str| {
            let line = parts[0].lines.iter().find(|line| line.key == key);
            line.map(|line| line.value.to_string()).unwrap_or_default()
        };
        assert_eq!(value("accel"), "[\"alpha_x\", \"alpha_y\", \"alpha_z\"]");
        assert_eq!(
            (value("gyro_unit"), value("accel_unit")),
            ("\"rad/s\"".into(), "\"m/s^2\"".into())
        );
        assert_eq!(value("time_unit"), "\"ns\"");
    }
}
