//! What files are, in words.

mod known;

use crate::{
    date,
    numbers::short,
    say::{poses, usable},
    shown::Shown,
};
use known::known;
use serde::Serialize;
use std::path::Path;
use undrift_io::visible;
use undrift_results::findings::{Finding, PosesApart};
use undrift_results::inspect::{
    Comment, Content, CounterRestarts, Flight, Inspection, Known, Measured, Model, Motion, Note,
    Part, PoseFault, Start, Wheels, about_gravity, pose_notes, pose_piece,
};

/// An inspection with its sentences, for JSON.
pub fn shown(inspection: &Inspection) -> impl Serialize {
    let part = |part: &Part| {
        let lines = part.lines.iter().cloned();
        let measured = part.measured.clone();
        Part {
            table: part.table,
            lines: Vec::from_iter(lines.map(|line| Shown::new("why", known(&line.known), line))),
            measured: measured.map(|of| Shown::new("remarks", remarks(&of), of)),
            problem: part.problem.clone(),
            choices: Vec::new(),
        }
    };
    let file = Inspection {
        file: inspection.file.clone(),
        format: inspection.format,
        description: inspection.description,
        streams: inspection.streams.clone(),
        parts: inspection.parts.iter().map(part).collect(),
        found: inspection.found.clone(),
        held: None,
    };
    Shown::new("notes", notes(inspection), file)
}

fn notes(inspection: &Inspection) -> Vec<String> {
    let cut = pose_piece(std::slice::from_ref(inspection)).is_some();
    let notes = inspection.found.iter();
    notes.map(|of| note(of, cut)).collect()
}

fn remarks(measured: &Measured) -> Vec<String> {
    let counter = measured.counter.iter().map(counter);
    counter
        .chain(measured.content.iter().map(content))
        .collect()
}

/// What is written where the motion is that of wheels, and why.
const PROFILE: &str = "vehicle.profile = \"car\"";
const WHEELS: &str = "no side slip beyond the solution's own error: the motion is that of wheels, which greatly reduces the drift without GNSS; remove it where they slide";

/// What is written where something flies, and why.
fn flies(flight: Flight) -> &'static str {
    match flight {
        Flight::Copter => {
            "leans into its accelerations, and with the drag of its rotors drifts less where fixes were withheld"
        }
        Flight::Aircraft => {
            "leans into its accelerations, and with a steady velocity through the air drifts less where fixes were withheld"
        }
    }
}

/// The line of the profile that is written, and why; `None` where none is.
fn profile(motion: Motion) -> Option<(&'static str, &'static str)> {
    match (motion.wheels, motion.flight) {
        (Wheels::Shown, _) => Some((PROFILE, WHEELS)),
        (_, Some(flight @ Flight::Copter)) => Some(("vehicle.profile = \"copter\"", flies(flight))),
        (_, Some(flight @ Flight::Aircraft)) => {
            Some(("vehicle.profile = \"aircraft\"", flies(flight)))
        }
        _ => None,
    }
}

/// A comment of a drive file.
pub fn comment(of: Comment) -> String {
    match of {
        Comment::Known(how) => return known(how),
        Comment::Top => {
            "A starter drive file. Check what is marked \"guessed\".\nAll keys: docs/drive-file.md"
        }
        Comment::Model => {
            "Noise model of the IMU at rest: a preset, or better the file that `undrift identify` writes\n\
             from a static recording of the sensor. `undrift tune` estimates the noise in the vehicle\n\
             from this drive."
        }
        Comment::Missing(table) => return format!("Missing: a file with the {table} data."),
        Comment::Piece => "the longest part in which the marker does not move against the IMU",
        Comment::Heading => "from changes of velocity, which suffice in this drive",
        Comment::Wheels(Wheels::Shown) => WHEELS,
        Comment::Flight(flight) => flies(flight),
        Comment::Wheels(_) => {
            "Whether the motion is that of wheels does not show: it is too short, too straight or too slow, or\n\
             the start is too uncertain. For a wheeled vehicle these lines greatly reduce the drift without GNSS."
        }
        Comment::Baseline => "direction of the second antenna, which a start at rest needs",
        Comment::LeverArm => {
            "from the IMU to the antenna: forward, right, down; measured beats estimated"
        }
    }
    .into()
}

fn note(note: &Note, cut: bool) -> String {
    match note {
        Note::UnknownColumns => {
            "no header, and the columns cannot be identified from their values".into()
        }
        Note::Columns(names) => format!("columns: {}", names.join(", ")),
        Note::NoTimes => "no time column found".into(),
        Note::NoHeader => {
            "no header line: assumes RTKLIB's columns, and GPS time (GPST) rather than UTC, which is 18 s behind".into()
        }
        Note::UnitBySize {
            named,
            size,
            median,
        } => format!(
            "the column names specify accelerations in {named}, but their median magnitude is {median:.4}, as in {size}, which is used"
        ),
        Note::NoMagnetometer { turned_deg } => {
            let why = match *turned_deg < 360.0 {
                true => "the drive turns too little to show how its axes lie in the IMU's",
                false => "its field does not turn as the gyros do, whatever its axes: disturbed, or on another clock",
            };
            format!("a magnetometer that is not proposed: {why}; [magnetometer] of a drive file reads it all the same")
        }
        Note::NoWheels => {
            "the IMU has no fixed direction of motion: not a wheeled vehicle, or the IMU is not fixed to it; assumes x forward".into()
        }
        Note::Flies => {
            "it flies, as it leans into its accelerations, but with neither profile of what flies it drifts clearly less where fixes were withheld; no [vehicle] profile".into()
        }
        Note::Slips { right_ms, down_ms } => format!(
            "no wheeled vehicle: moves by {} m/s to the side and {} m/s up and down beyond the solution's own error (RMS); no [vehicle] profile",
            short(*right_ms),
            short(*down_ms)
        ),
        Note::Apart { offset_s } => format!(
            "the logs do not overlap; if both begin at the same moment, set time_offset = \"{offset_s:.2} s\" in [gnss]"
        ),
        Note::NoGravity { ratio } => format!(
            "the mean specific force is {ratio:.2} times gravity: gravity seems to be removed, as from a \"linear acceleration\"; log the accelerometers with gravity"
        ),
        Note::Poses(fault) => poses::fault(fault, fault.is_mended(cut)),
        Note::NoMounting(why) => format!("axes guessed from gravity alone: {why}"),
        Note::Empty { table, streams } => {
            let what = match table.as_str() {
                "imu" => "inertial samples",
                "gnss" => "fixes",
                "poses" => "poses",
                "heading" => "headings",
                "magnetometer" => "magnetic fields",
                _ => "reference solutions",
            };
            let verb = if streams.len() == 1 { "was" } else { "were" };
            format!("no {what}: {} {verb} never written", streams.join(", "))
        }
        Note::Nothing => {
            "nothing usable: neither positions nor angular rates with specific forces".into()
        }
    }
}

/// Why a drive cannot be navigated whose accelerometers have no gravity, and their file.
pub fn without_gravity(inspections: &[Inspection]) -> Option<String> {
    let of = |file: &Inspection| {
        let mut notes = file.found.iter();
        let found = notes.find(|found| matches!(found, Note::NoGravity { .. }))?;
        Some(format!("{}: {}", file.file.display(), note(found, false)))
    };
    inspections.iter().find_map(of)
}

fn counter(counter: &CounterRestarts) -> String {
    let CounterRestarts {
        line,
        count,
        length,
    } = counter;
    let times = match count {
        1 => String::new(),
        count => format!("{count} times, first "),
    };
    format!(
        "the time counter starts again {times}at line {line}: {length} is added to the later times"
    )
}

fn content(content: &Content) -> String {
    match content {
        Content::Force(force) => {
            let [x, y, z] = *force;
            let shown = format!("mean specific force {x:.2}, {y:.2}, {z:.2} m/s^2");
            if about_gravity(*force) {
                return shown;
            }
            let size = (x * x + y * y + z * z).sqrt();
            format!("{shown}: its magnitude of {size:.3} m/s^2 is not gravity; check the unit")
        }
        Content::Fixes { kinds, velocities } => {
            let names = [
                "fixed",
                "float",
                "differential",
                "single",
                "of unknown kind",
            ];
            let shares = kinds.iter().zip(names).filter(|(count, _)| **count > 0);
            let shares: Vec<String> = shares.map(|(n, name)| format!("{n} {name}")).collect();
            format!("fixes: {}; {velocities} with a velocity", shares.join(", "))
        }
        Content::Poses {
            velocities,
            attitudes,
        } => format!("{velocities} with a velocity, {attitudes} with an attitude"),
    }
}

/// The first line: what is wrong with poses, and whether they can be used all the same.
pub fn lead(inspections: &[Inspection]) -> Option<String> {
    let cut = pose_piece(inspections).is_some();
    let finding = |fault: &PoseFault| {
        Finding::Poses(PosesApart {
            mended: fault.is_mended(cut),
            fault: fault.clone(),
        })
    };
    let all = Vec::from_iter(pose_notes(inspections).map(finding));
    let worst = all.iter().map(|of| of.severity()).max()?;
    let cause = all.iter().find(|of| of.severity() == worst)?;
    Some(format!("{}: {}", usable(worst), crate::say::say(cause)))
}

/// An inspection for a terminal.
pub fn text(inspection: &Inspection) -> String {
    let (file, what) = (inspection.file.display(), &inspection.description);
    let mut lines = vec![format!("{file}: {what}")];
    let streams = inspection.streams.iter();
    lines.extend(streams.map(|(name, n, about)| format!("  {name}: {n} messages, {about}")));
    for part in &inspection.parts {
        let measured = part.measured.as_ref();
        lines.push(format!(
            "  [{}]{}",
            part.table,
            measured.map_or(String::new(), rate_and_gaps)
        ));
        let width = part.lines.iter().map(|line| line.key.len()).max();
        let width = width.unwrap_or(0);
        lines.extend(part.lines.iter().map(|line| {
            let (key, value, why) = (line.key, &line.value, known(&line.known));
            let entry = format!("    {key:width$} = {value}   # {why}");
            entry.trim_end_matches("   # ").to_owned()
        }));
        if let Some(measured) = measured {
            let skipped = measured.skipped.lines().map(str::to_owned);
            let start = [start(measured.start.as_ref())].into_iter();
            let remarks = start.chain(remarks(measured)).chain(skipped);
            lines.extend(remarks.map(|remark| format!("    {remark}")));
        }
        let problem = part.problem.as_ref();
        lines.extend(problem.map(|problem| format!("    cannot be read: {problem}")));
    }
    let notes = notes(inspection);
    lines.extend(notes.iter().map(|note| format!("  note: {note}")));
    let lines = lines.iter().map(|line| visible(line));
    Vec::from_iter(lines).join("\n")
}

/// When a part starts.
fn start(start: Option<&Start>) -> String {
    let Some(start) = start else {
        return "no date: times are those of the log's own clock".into();
    };
    format!(
        "starts {} ({}; GPS time is {} s ahead)",
        date::utc(&start.utc),
        date::clock(start.clock),
        start.leap_seconds
    )
}

fn rate_and_gaps(m: &Measured) -> String {
    // To the fourth decimal, without the zeros at its end.
    let rate = (m.rate_hz * 1e4).round() / 1e4;
    let gaps = m.longest_gap_s.map_or("no gaps".into(), |(start, length)| {
        format!(
            "gaps: {}, the longest {length:.3} s from {start:.3} s",
            m.gaps
        )
    });
    format!(
        " {} records at {rate} Hz, {:.3} s to {:.3} s; {gaps}",
        m.records, m.first_s, m.last_s
    )
}

/// The key `model` that a drive file begins with, for a terminal, and what to do next; `drive` is the drive file's name.
pub fn next(model: &Model, motion: Motion, drive: &Path) -> String {
    let file = drive.to_string_lossy();
    let file = visible(&file);
    let vehicle = profile(motion).map_or(String::new(), |(key, why)| format!("{key}   # {why}\n"));
    format!(
        "{vehicle}model = {model}   # {}\nnext: undrift tune {file} -o tuned.toml   # the noise of the sensor in its vehicle",
        known(&model.known)
    )
}

/// What to do about logs of which one shows nothing, where a drive needs such a table; `None` where all are known.
pub fn unknown_log(inspections: &[Inspection], table: &str) -> Option<String> {
    let log = inspections.iter().find(|log| log.parts.is_empty())?;
    let name = log.file.to_string_lossy();
    let name = visible(&name);
    let (wanted, named) = match table {
        "imu" => ("t, gx, gy, gz, ax, ay, az", "gyro and accel"),
        _ => (
            "t, lat, lon, height or t, ecef_x, ecef_y, ecef_z, or of poses t, x, y, z, qx, qy, qz, qw",
            "position or ecef",
        ),
    };
    if let Some(fault) = pose_notes(std::slice::from_ref(log)).next() {
        return Some(poses::fault(fault, false));
    }
    let has = log.found.iter().find_map(|note| match note {
        Note::Columns(names) => Some(format!(
            "the columns of {name} are not known ({})",
            visible(&names.join(", "))
        )),
        Note::UnknownColumns => Some(format!(
            "{name} has no header, and its numbers do not show its columns"
        )),
        _ => None,
    })?;
    Some(format!(
        "{has}: name them {wanted} in its header, or write [{table}] by hand with file, time and {named}"
    ))
}

/// What is guessed in the drive file, a line each.
pub fn guesses(model: &Model, motion: Motion, inspections: &[Inspection]) -> Vec<String> {
    let mut lines = vec![format!("  model = {model}: {}", known(&model.known))];
    let mut tables = Vec::new();
    let parts = inspections.iter().flat_map(|file| {
        let parts = file.parts.iter().map(move |part| (file, Some(part)));
        parts.chain(file.parts.is_empty().then_some((file, None)))
    });
    for (file, part) in parts {
        let Some(part) = part.filter(|part| !tables.contains(&part.table)) else {
            let (name, what) = (file.file.display().to_string(), part.map(|part| part.table));
            let why = what.map_or("nothing of a drive is known in it".into(), |table| {
                format!("[{table}] is that of another file")
            });
            lines.push(format!("  {} is not used: {why}", visible(&name)));
            continue;
        };
        tables.push(part.table);
        let guessed = part.lines.iter().filter(|line| {
            let certain = matches!(line.known, Known::Certain | Known::Name { .. });
            !certain
        });
        lines.extend(guessed.map(|line| {
            let (key, value, why) = (line.key, &line.value, known(&line.known));
            let entry = format!("  {}.{key} = {value}: {why}", part.table);
            visible(&entry).into_owned()
        }));
    }
    if let Some((key, why)) = profile(motion) {
        lines.push(format!("  {key}: {why}"));
    }
    lines
}

#[cfg(test)]
mod tests;
