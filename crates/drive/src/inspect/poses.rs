//! How poses lie against the IMU, by the motion that both have in common.

use super::{
    Inspection, Known, Line, Note, Part, SITS,
    found::GRID,
    logs,
    numbers::three_of,
    table,
    units::{Force, force},
};
use crate::{
    drive::{Drive, DriveError, Logs, Section, Table},
    hand_eye::{HandEye, INTERVAL, hand_eye},
};
use std::{f64::consts::PI, path::Path};
use undrift_io::{
    Opened,
    gnss::GnssSource,
    poses::{LocalPose, PoseFormat, Poses},
    table::Preview,
};
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    attitude::to_rpy,
    sample::ImuSample,
    units::{Quantity, unit_factor},
};
use undrift_results::inspect::PoseFault;

/// Standard deviations where nothing shows them: of a camera or a laser scanner.
const POSITION_STD: &str = "10, 10, 10 mm";
const ATTITUDE_STD: &str = "0.5, 0.5, 0.5 deg";
/// Least standard deviations that poses are taken to have \[m, rad\]: mounts bend, and stamps jitter.
const LEAST: [f64; 2] = [5e-4, 8.7e-4];
/// How long errors of poses last, of a mount that gives or a map that drifts \[s\], and their share of the variance: `tune` finds how large
/// they are.
const LASTING: (&str, f64) = ("2 s", 0.5);
/// An axis of the frame that gravity is nearer to than this \[rad\] is taken for the vertical: a tilt is estimated.
const UPRIGHT: f64 = 0.02;

/// Whether a table is of poses in a layout that is known by its beginning.
pub(super) fn are_in(opened: &mut Opened) -> bool {
    // Several bodies of Motive are poses, too: reading them says so.
    !matches!(undrift_io::poses::detect(opened, None), Ok(None))
}

/// Poses of which only the log is known.
pub(super) fn part() -> Part {
    let std = |key, value: &str| Line::new(key, value, Known::NotInLog);
    Part::new(
        "poses",
        vec![
            std("position_std", POSITION_STD),
            std("attitude_std", ATTITUDE_STD),
        ],
    )
}

/// Standard deviations of positions alone where nothing shows them: of radio ranges, or a receiver's fixed solution.
const POSITIONS_STD: &str = "0.1, 0.1, 0.1 m";

/// Positions in a local frame without attitudes, of which only the log is known.
pub(super) fn part_of_positions() -> Part {
    let std = Line::new("position_std", POSITIONS_STD, Known::NotInLog);
    Part::new("poses", vec![std])
}

/// How much less a path changes its direction from row to row than it is wide, at most.
const SMOOTH: f64 = 0.1;

/// Whether the positions of a table follow a path, as the values of a sensor do not.
pub(super) fn is_path(table: &Preview, format: &PoseFormat) -> bool {
    let places = format.position.as_ref().map(|of| of.each_ref());
    let places = places.map(|of| of.map(|column| table.place(column)));
    let Some([Some(x), Some(y), Some(z)]) = places else {
        return false;
    };
    let rows = three_of(&table.rows, [x, y, z]);
    if rows.iter().flatten().any(|along| along.abs() > GRID) {
        return false;
    }
    let mean =
        rows.iter().map(|row| Vector3::from(*row)).sum::<Vector3>() / rows.len().max(1) as f64;
    let apart = |row: &[f64; 3]| (Vector3::from(*row) - mean).norm_squared();
    let bent = |three: &[[f64; 3]]| {
        let [a, b, c] = [0, 1, 2].map(|k| Vector3::from(three[k]));
        (a - 2.0 * b + c).norm_squared()
    };
    let width: f64 = rows.iter().map(apart).sum();
    let turns: f64 = rows.windows(3).map(bent).sum();
    rows.len() > 10
        && turns < SMOOTH * SMOOTH * width
        && !matches!(force(&rows, None), Force::Rates(_))
}

/// Looks at an IMU and at poses, each a file and a part of it, and writes marker, lever arm, frame, clock and accuracy into the part of the
/// poses, or why not into the file's notes.
pub(super) fn motion(inspections: &mut [Inspection], imu: (usize, usize), at: (usize, usize)) {
    let logs = logs(inspections, Path::new(""));
    let of =
        |(file, part): (usize, usize)| (&*inspections[file].file, &inspections[file].parts[part]);
    let found = compared(of(imu), of(at), logs.clone());
    // The body's axes are the sensor's: a marker says how it lies, not a vehicle.
    let of_imu = &mut inspections[imu.0].parts[imu.1];
    of_imu.lines.retain(|line| !SITS.contains(&line.key));
    let found = match found {
        Ok(Some(Err(PoseFault::GyroUnit { ratio }))) if other_unit(of_imu, ratio) => {
            let of = |(file, part): (usize, usize)| {
                (&*inspections[file].file, &inspections[file].parts[part])
            };
            compared(of(imu), of(at), logs)
        }
        found => found,
    };
    let file = &mut inspections[at.0];
    match found {
        Ok(Some(Ok(found))) => {
            // No key of a drive file turns quaternions round, so none would hold.
            if !found.faults.contains(&PoseFault::Inverse) {
                write(&mut file.parts[at.1], &found);
            }
            let duration_s = file.parts[at.1]
                .measured
                .as_ref()
                .map(|of| of.last_s - of.first_s);
            let short = duration_s.filter(|of| *of < SHORT);
            let short = short.map(|duration_s| PoseFault::TooShort { duration_s });
            file.found
                .extend(found.faults.into_iter().chain(short).map(Note::Poses));
        }
        Ok(Some(Err(fault))) => file.found.push(Note::Poses(fault)),
        Ok(None) => file.found.push(Note::Poses(PoseFault::NoAttitudes)),
        Err(error) => file.found.push(Note::NoMounting(error.to_string())),
    }
}

/// Poses for a shorter time show marker and clock, and little of the noise \[s\].
const SHORT: f64 = 40.0;

/// Units of gyros.
const UNITS: [&str; 4] = ["rad/s", "deg/s", "mrad/s", "mdps"];
/// How near to one of them the turns have to be, as a share.
const NEAR_UNIT: f64 = 0.1;

/// Takes the unit in which the gyros turn `ratio` times as far; whether there is one.
fn other_unit(imu: &mut Part, ratio: f64) -> bool {
    let factor = |unit: &str| unit_factor(unit, Quantity::AngularRate).ok();
    let line = imu.lines.iter_mut().find(|line| line.key == "gyro_unit");
    let Some((line, now)) = line.and_then(|line| {
        let now = factor(line.value.as_str()?)?;
        Some((line, now))
    }) else {
        return false;
    };
    let is_it = |unit: &&str| {
        factor(unit).is_some_and(|factor| (factor / (now * ratio) - 1.0).abs() < NEAR_UNIT)
    };
    let Some(unit) = UNITS.into_iter().find(|unit| is_it(unit)) else {
        return false;
    };
    *line = Line::new("gyro_unit", unit, Known::TurnsOfPoses);
    true
}

/// What samples and poses show of each other; `None` of poses without an attitude.
fn compared(
    imu: (&Path, &Part),
    poses: (&Path, &Part),
    logs: Logs,
) -> Result<Option<Result<HandEye, PoseFault>>, DriveError> {
    let (samples, poses) = records(imu, poses, logs)?;
    let oriented = poses.iter().any(|pose| pose.attitude.is_some());
    Ok(oriented.then(|| hand_eye(&samples, &poses)))
}

/// The samples and the poses as their files have them.
fn records(
    imu: (&Path, &Part),
    poses: (&Path, &Part),
    logs: Logs,
) -> Result<(Vec<ImuSample>, Vec<LocalPose>), DriveError> {
    let mut of_imu = table(imu.0, imu.1);
    // The body's axes are the sensor's.
    for key in SITS {
        of_imu.remove(key);
    }
    let tables = [
        ("imu", of_imu.into()),
        ("poses", table(poses.0, poses.1).into()),
    ];
    let tables = tables.map(|(key, value): (&str, toml::Value)| (key.to_owned(), value));
    let tables = toml::Table::from_iter(tables);
    let top = Section::values(Table::Values(&tables), "");
    let drive = Drive::from_tables(&top, Path::new(""), logs)?;
    let samples = drive.open_imu()?.collect::<Result<Vec<_>, _>>()?;
    let GnssSource::Poses(fixes) = &drive.gnss.1 else {
        return Ok((samples, Vec::new()));
    };
    let poses = drive.logs.read::<Poses>(&drive.gnss.0, &fixes.source)?;
    Ok((samples, poses.collect::<Result<Vec<_>, _>>()?))
}

/// Writes what was found into the part of the poses.
fn write(part: &mut Part, found: &HandEye) {
    let mut put = |key: &'static str, value: String, known: Known| {
        part.lines.retain(|line| line.key != key);
        part.lines.push(Line::new(key, value, known));
    };
    let of_turns = Known::HandEye {
        correlation: found.correlation,
        std_deg: found.marker_std.to_degrees(),
    };
    for fault in &found.faults {
        match fault {
            PoseFault::ScalarFirst => put("attitude_order", "w,x,y,z".into(), of_turns.clone()),
            PoseFault::Unit(unit) => put("position_unit", unit.clone(), Known::Accelerations),
            _ => {}
        }
    }
    if found.clock.abs() > 5e-4 {
        put(
            "time_offset",
            format!("{:.4} s", found.clock),
            of_turns.clone(),
        );
    }
    let [roll, pitch, yaw] = degrees(&found.marker);
    put(
        "marker",
        format!("{roll:.2}, {pitch:.2}, {yaw:.2} deg"),
        of_turns,
    );
    let [x, y, z] = found.lever_arm.into();
    put(
        "lever_arm",
        format!("{x:.3}, {y:.3}, {z:.3} m"),
        Known::LeverArm {
            std_m: found.lever_arm_std,
        },
    );
    let (key, value) = frame(&found.gravity);
    put(key, value, Known::Accelerations);
    // The scatter from one pose to the next is that of the part that does not last.
    let all = 1.0 / (1.0 - LASTING.1).sqrt();
    let position = digits(1e3 * LEAST[0].max(all * found.position_std));
    put(
        "position_std",
        format!("{position}, {position}, {position} mm"),
        Known::Accelerations,
    );
    let attitude = digits(LEAST[1].max(all * found.attitude_std).to_degrees());
    put(
        "attitude_std",
        format!("{attitude}, {attitude}, {attitude} deg"),
        Known::Scatter,
    );
    put("interval", format!("{INTERVAL} s"), Known::Thinned);
    put("correlation_time", LASTING.0.into(), Known::Lasting);
    part.lines
        .push(Line::new("correlated_share", LASTING.1, Known::Lasting));
}

fn degrees(of: &Quaternion) -> [f64; 3] {
    // Without the sign of a zero.
    to_rpy(of)
        .map(|angle| (100.0 * angle.to_degrees()).round() / 100.0 + 0.0)
        .into()
}

/// A positive number to two digits.
fn digits(value: f64) -> String {
    let places = (1.0 - value.log10().floor()).max(0.0) as usize;
    format!("{value:.places$}")
}

/// The key and its value that level a frame with this gravity: signed axes where one is vertical, else angles.
fn frame(gravity: &Vector3) -> (&'static str, String) {
    let down = gravity.normalize();
    let k = down.iamax();
    let sign = down[k].signum();
    let third = Vector3::ith(k, sign);
    let first = Vector3::ith(usize::from(k == 0), 1.0);
    let second = third.cross(&first);
    let c_rw = Matrix3::from_rows(&[first.transpose(), second.transpose(), third.transpose()]);
    if down.angle(&third) < UPRIGHT {
        let name = |row: usize| {
            let axis = c_rw.row(row).transpose();
            let at = axis.iamax();
            let minus = if axis[at] < 0.0 { "-" } else { "" };
            format!("{minus}{}", ["x", "y", "z"][at])
        };
        return ("axes", [0, 1, 2].map(name).join(","));
    }
    let level = Quaternion::rotation_between(&(c_rw * down), &Vector3::z())
        .unwrap_or_else(|| Quaternion::from_scaled_axis(Vector3::x() * PI));
    let [roll, pitch, yaw] = degrees(&(level * Quaternion::from_matrix(&c_rw)));
    ("frame", format!("{roll:.2}, {pitch:.2}, {yaw:.2} deg"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::attitude::from_rpy;

    #[test]
    fn a_frame_is_levelled_by_axes_or_angles() {
        for (gravity, axes) in [
            ([0.0, 0.0, -9.8], "x,-y,-z"),
            ([0.0, 0.0, 9.8], "x,y,z"),
            ([0.0, -9.8, 0.0], "x,z,-y"),
            ([9.8, 0.05, 0.0], "y,z,x"),
        ] {
            assert_eq!(frame(&gravity.into()), ("axes", axes.to_owned()));
        }
        let gravity = Vector3::new(3.0, -2.0, -9.0);
        let (key, value) = frame(&gravity);
        assert_eq!(key, "frame");
        let angles = value.trim_end_matches(" deg").split(", ");
        let angles: Vec<f64> = angles
            .map(|a| a.parse::<f64>().unwrap().to_radians())
            .collect();
        let down = from_rpy(&Vector3::from_row_slice(&angles)) * gravity.normalize();
        // To a hundredth of a degree in each angle.
        assert!((down - Vector3::z()).norm() < 3e-4, "{down}");
    }

    #[test]
    fn positions_alone_are_those_of_a_path() {
        let table = |names: &str, row: &dyn Fn(f64) -> [f64; 3]| {
            let rows = (0..200).map(|k| {
                let t = 0.2 * f64::from(k);
                [&[t], &row(t)[..]].concat()
            });
            let names = Vec::from_iter(names.split(',').map(str::to_owned));
            let table = Preview {
                header: names.clone(),
                names,
                rows: rows.collect(),
                ..Preview::default()
            };
            let parts = super::super::of_table(table);
            parts.iter().map(|part| part.table).collect::<Vec<_>>()
        };
        let path = |t: f64| [20.0 * (0.1 * t).cos(), 10.0 * (0.1 * t).sin(), 0.2];
        for names in ["t,x,y,z", "time,east,north,up"] {
            assert_eq!(table(names, &path), ["poses"], "{names}");
        }
        // Accelerometers, and what changes from row to row as gyros do.
        let gravity = |t: f64| [0.1 * (0.1 * t).cos(), 0.1 * (0.1 * t).sin(), 9.8];
        let noise = |t: f64| [(91.0 * t).sin(), (57.0 * t).cos(), (33.0 * t).sin()];
        assert!(table("t,x,y,z", &gravity).is_empty());
        assert!(table("t,x,y,z", &noise).is_empty());
        // Far from their origin they are of a grid of the Earth.
        let far = |t: f64| [686_000.0 + t, 5_330_000.0 + t, 500.0];
        assert_eq!(table("time,east,north,up", &far), ["gnss"]);
    }
}
