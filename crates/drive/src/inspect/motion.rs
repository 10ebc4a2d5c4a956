//! How the IMU sits in its vehicle, by how it moves against the fixes.

mod accuracy;
mod antennas;
mod axes;
mod compass;
mod flight;
mod smoothing;
mod wheels;

use super::{
    Content, Inspection, Known, Line, Measured, Motion, Note, Part, SITS, Wheels, clocks,
    gravity::removed_gravity, logs, sensor::GUESS, table, units::COUNTS_OF_RATE,
};
use crate::{
    align::Heading,
    drive::{AXLE_STD, Drive, DriveError, Logs, OTHER_CLOCK, Section, Table},
    engine::derived::with_velocities,
    mounting::{
        EstimateError, FLOOR_TURNING, MountingError, by_force, is_force_reversed, turn_ratio,
    },
    navigate::{NavigateError, Wanted, navigate, resolve_mounting},
    vehicle::Profile,
};
use axes::{beginning, exchanged_axes, is_fitting, reversed_axes};
use std::path::Path;
use undrift_nav::{
    Vector3,
    attitude::{from_rotation_vector, from_rpy, to_rpy},
    parameters::{Parameter, Prior},
    sample::{GnssFix, ImuSample},
    units::{Quantity, unit_factor},
};
use undrift_noise::BiasModel;
use wheels::{LONGEST, Slip, is_held, side_slip};

/// Joins an IMU in two files, looks at the first IMU and the first fixes of the files, and says how the IMU sits where a vehicle's motion shows it:
/// in its part's lines, or why not in its notes. Positions that do not say how accurate they are get what the motion shows of it.
pub fn motion(inspections: &mut [Inspection]) -> Motion {
    super::joined::join(inspections);
    super::joined::forget_guesses(inspections);
    let readable = |table: &str| {
        inspections.iter().enumerate().find_map(|(at, file)| {
            let part = file.parts.iter().position(|part| part.table == table)?;
            let problem = file.parts[part].problem.is_some();
            (!problem).then_some((at, part))
        })
    };
    let beside = ["heading", "magnetometer"].map(readable);
    let (Some(imu), Some(gnss)) = (readable("imu"), readable("gnss")) else {
        if let Some((imu, poses)) = readable("imu").zip(readable("poses")) {
            super::poses::motion(inspections, imu, poses);
        }
        return Motion::default();
    };
    let logs = logs(inspections, Path::new(""));
    let mut found = in_vehicle(inspections, &logs, imu, gnss, beside);
    accuracy::write(inspections, [imu, gnss], logs.clone(), found);
    smoothing::write(inspections, [imu, gnss], logs.clone(), found);
    if removed_gravity(&inspections[imu.0].parts[imu.1]).is_none() {
        found.flight = flight::found(inspections, [imu, gnss], logs, found);
    }
    let lines = &mut inspections[imu.0].parts[imu.1].lines;
    let scale = Line::new("accel_scale_error", SCALE_ERROR, Known::Uncalibrated);
    lines.push(scale);
    found
}

/// Scale factor errors of accelerometers that nobody calibrated, one standard deviation [–]: of the order of a per cent (Groves 2013, section
/// 4.4.2), and they count as white over five seconds.
const SCALE_ERROR: f64 = 0.007;

/// A part by its file and its place there.
type At = (usize, usize);

/// Says how the IMU sits in its vehicle, and how two antennas and a magnetometer sit where there are such, as far as the motion shows it.
fn in_vehicle(
    inspections: &mut [Inspection],
    logs: &Logs,
    imu: At,
    gnss: At,
    [antennas, field]: [Option<At>; 2],
) -> Motion {
    let fixes = inspections[gnss.0].parts[gnss.1].measured.clone();
    if let Some(fixes) = fixes {
        rate_of_rows(&mut inspections[imu.0].parts[imu.1], &fixes);
    }
    let read_parts = |inspections: &[Inspection], parts: &[At]| {
        let of = |(file, part): &At| (&*inspections[*file].file, &inspections[*file].parts[*part]);
        let parts: Vec<_> = parts.iter().map(of).collect();
        drive_of(&parts, logs.clone(), Some("auto"))
    };
    let read = |inspections: &[Inspection]| read_parts(inspections, &[imu, gnss]);
    if let Some((file, part)) = field {
        let with_field = read_parts(inspections, &[imu, gnss, (file, part)]);
        let note = match with_field {
            Ok(drive) => compass::write(&mut inspections[file].parts[part], &drive),
            Err(_) => None,
        };
        if let Some(note) = note {
            // It is the last of its file: what else was found keeps its place.
            inspections[file].parts.remove(part);
            inspections[file].found.push(note);
        }
    }
    if let Some(ratio) = removed_gravity(&inspections[imu.0].parts[imu.1]) {
        inspections[imu.0].found.push(Note::NoGravity { ratio });
        return Motion::default();
    }
    let mut found = read(inspections);
    let [of_imu, of_gnss] = [imu, gnss].map(|(file, part)| &inspections[file].parts[part]);
    if let Some(line) = other_day(of_imu, of_gnss) {
        inspections[gnss.0].parts[gnss.1].lines.push(line);
        found = read(inspections);
    }
    if let Ok(drive_so_far) = &found
        && let Some(note) = other_clock(&mut inspections[gnss.0].parts[gnss.1], drive_so_far)
    {
        inspections[gnss.0].found.extend(note);
        found = read(inspections);
    }
    if let Ok(drive_so_far) = &found
        && other_unit(&mut inspections[imu.0].parts[imu.1], drive_so_far)
    {
        found = read(inspections);
    }
    if let Ok(drive_so_far) = &found
        && other_sign(&mut inspections[imu.0].parts[imu.1], drive_so_far)
    {
        found = read(inspections);
    }
    let fixes = &inspections[gnss.0].parts[gnss.1].measured;
    let fixes = fixes.as_ref().and_then(|fixes| fixes.content.as_ref());
    let heading = matches!(
        fixes,
        Some(Content::Fixes {
            velocities: 1..,
            ..
        })
    );
    let file = &mut inspections[imu.0];
    let drive = match found {
        Ok(drive) => drive,
        Err(error) => {
            file.found.push(Note::NoMounting(error.to_string()));
            return Motion::default();
        }
    };
    let resolved = resolve_mounting(&drive);
    let by_force = match &resolved {
        Ok(_) => None,
        Err(_) => records(&drive).and_then(|(imu, fixes)| by_force(&imu, &fixes)),
    };
    let fits = by_force.is_some() || resolved.as_ref().is_ok_and(|of| is_fitting(of.clone()));
    let reversed = match fits {
        true => None,
        false => {
            let part = &mut file.parts[imu.1];
            reversed_axes(part, &drive).or_else(|| exchanged_axes(part, &drive))
        }
    };
    let found = match reversed {
        Some(mounting) => Ok(Some(mounting)),
        None => resolved.map(|(_, mounting)| mounting),
    };
    let (rotation, heading) = match found {
        Ok(None) => return Motion::default(),
        Ok(Some(mounting)) => {
            let degrees = |angles: Vector3| angles.map(f64::to_degrees).into();
            let known = Known::Motion {
                rpy_deg: degrees(mounting.rpy()),
                std_deg: degrees(mounting.std),
                duration_s: mounting.duration,
            };
            // A hundredth of a degree is far below what is known of it.
            let value = angles(&mounting.rpy(), 2);
            sits(&mut file.parts[imu.1], &value, &mounting.std, known);
            (mounting.matrix(), heading)
        }
        Err(NavigateError::Mounting(EstimateError::Mounting(MountingError::Wanders {
            ..
        }))) => {
            file.found.push(Note::NoWheels);
            let wheels = Wheels::No;
            return Motion {
                wheels,
                heading,
                flight: None,
            };
        }
        Err(error) => {
            let Some((rpy, std)) = by_force else {
                file.found.push(Note::NoMounting(error.to_string()));
                return Motion::default();
            };
            let (rpy, std) = refined(drive, &rpy, std).unwrap_or((rpy, std));
            let value = angles(&rpy, 1);
            let std_deg = std.to_degrees();
            // The level is that of the mean force: no better than the rest.
            let std = Vector3::repeat(std);
            sits(
                &mut file.parts[imu.1],
                &value,
                &std,
                Known::Forces { std_deg },
            );
            (from_rpy(&rpy).to_rotation_matrix().into_inner(), false)
        }
    };
    let placed = |mut drive: Drive| {
        drive.estimate_mounting = false;
        drive.imu.1.rotation = rotation;
        if heading {
            drive.align.heading = Heading::Auto;
        }
        beginning(drive, LONGEST)
    };
    if let Some(at) = antennas {
        let with_headings = read_parts(inspections, &[imu, gnss, at]);
        if let Some(drive) = with_headings.ok().and_then(placed) {
            antennas::write(&mut inspections[at.0].parts[at.1], drive);
        }
    }
    let mounted = read(inspections).ok().and_then(placed);
    let held = || mounted.as_ref().is_some_and(is_held);
    let wheels = match mounted.as_ref().and_then(side_slip) {
        None => Wheels::Likely,
        Some(slip) if slip.is_of_wheels() && held() => Wheels::Shown,
        Some(slip) if slip.is_of_wheels() => Wheels::Likely,
        Some(Slip { right, down }) => {
            let (right_ms, down_ms) = (right, down);
            let note = Note::Slips { right_ms, down_ms };
            inspections[imu.0].found.push(note);
            Wheels::No
        }
    };
    Motion {
        wheels,
        heading,
        flight: None,
    }
}

/// Usual rates of inertial logs \[Hz\], and how near to one, as a share, a rate is that one.
const RATES: [f64; 24] = [
    5.0, 10.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0, 62.5, 75.0, 80.0, 100.0, 104.0, 120.0, 125.0,
    150.0, 200.0, 208.0, 250.0, 300.0, 400.0, 500.0, 800.0, 1000.0,
];
const NEAR_RATE: f64 = 0.02;
/// Fixes that show how long a log lasts, at least.
const FIXES: u64 = 10;

/// Takes the rate of a log without times from the fixes, which last as long.
fn rate_of_rows(imu: &mut Part, fixes: &Measured) {
    let guess = imu
        .lines
        .iter_mut()
        .find(|line| line.known == Known::NoTimes);
    let Some((line, measured)) = guess.zip(imu.measured.as_mut()) else {
        return;
    };
    let rate = measured.records.saturating_sub(1) as f64 / (fixes.last_s - fixes.first_s);
    let plausible = RATES[0]..=5.0 * RATES[RATES.len() - 1];
    if fixes.records < FIXES || !plausible.contains(&rate) || measured.rate_hz <= 0.0 {
        return;
    }
    let usual = RATES
        .iter()
        .min_by(|a, b| (*a / rate).ln().abs().total_cmp(&(*b / rate).ln().abs()));
    let usual = usual.filter(|usual| (*usual / rate - 1.0).abs() < NEAR_RATE);
    let rate = usual.copied().unwrap_or((10.0 * rate).round() / 10.0);
    *line = Line::new("rate", format!("{rate} Hz"), Known::RowsOfFixes);
    // The times are the rows over the rate.
    let longer = measured.rate_hz / rate;
    measured.first_s *= longer;
    measured.last_s *= longer;
    measured.rate_hz = rate;
}

/// Roll, pitch and yaw \[rad\] as a drive file has them, in degrees of so many digits.
fn angles(rpy: &Vector3, digits: usize) -> String {
    let unit = 10f64.powi(digits as i32);
    // Without the sign of a zero.
    let degrees = rpy.map(|angle| (unit * angle.to_degrees()).round() / unit + 0.0);
    let [roll, pitch, yaw] = degrees.into();
    format!("{roll:.digits$}, {pitch:.digits$}, {yaw:.digits$} deg")
}

const MOUNTING: &str = "mounting";

/// Writes how the IMU sits, and how well that is known \[rad\], into its part.
fn sits(imu: &mut Part, mounting: &str, std: &Vector3, known: Known) {
    imu.lines.retain(|line| !SITS.contains(&line.key));
    imu.lines.push(Line::new(MOUNTING, mounting, known));
    let std = Line::new("mounting_std", angles(std, 1), Known::LessCertain);
    imu.lines.push(std);
}

/// The drive of an IMU and fixes, and of what else is given; with a `mounting` in place of how the IMU is said to sit.
fn drive_of(
    parts: &[(&Path, &Part)],
    logs: Logs,
    mounting: Option<&str>,
) -> Result<Drive, DriveError> {
    let mut tables = toml::Table::from_iter([("model".to_owned(), GUESS.into())]);
    for (file, part) in parts {
        let mut keys = table(file, part);
        if let Some(mounting) = mounting.filter(|_| part.table == "imu") {
            keys.retain(|key, _| !SITS.contains(&key));
            keys.insert(MOUNTING.into(), mounting.into());
        }
        tables.insert(part.table.to_owned(), keys.into());
    }
    Drive::from_tables(
        &Section::values(Table::Values(&tables), ""),
        Path::new(""),
        logs,
    )
}

/// Standard deviation of the mounting while the filter refines it \[rad\]: it does not get what the
/// forces have shown a second time.
const LOOSE: f64 = 0.12;

/// Roll, pitch and yaw of the sensor in the vehicle and the standard deviation of the yaw \[rad\]: what the filter makes
/// of the mounting as it is about, where it drives as a car does. `None` where it knows it no better or contradicts.
fn refined(mut drive: Drive, rpy: &Vector3, std: f64) -> Option<(Vector3, f64)> {
    let about = from_rpy(rpy);
    drive.estimate_mounting = false;
    drive.imu.1.rotation = about.to_rotation_matrix().into_inner();
    drive.constraints = Profile::Car.constraints();
    for (kind, std) in [(Parameter::Mounting, LOOSE), (Parameter::Axle, AXLE_STD)] {
        drive.parameters = drive.parameters.with(kind, Prior::constant(std));
    }
    let report = navigate(&drive, BiasModel::Arma, Wanted::default()).ok()?;
    let mut estimated = report.summary.parameters.into_iter();
    let (_, turn, of_turn) = estimated.find(|(kind, ..)| *kind == Parameter::Mounting)?;
    let known = of_turn[1].hypot(FLOOR_TURNING);
    let q_vb = from_rotation_vector(&-Vector3::new(0.0, turn[0], turn[1])) * about;
    (known < std && turn[1].abs() < 3.0 * std).then(|| (to_rpy(&q_vb), known))
}

/// Samples, and fixes with velocities.
fn records(drive: &Drive) -> Option<(Vec<ImuSample>, Vec<GnssFix>)> {
    let imu = drive.open_imu().ok()?.collect::<Result<Vec<_>, _>>().ok()?;
    let fixes = drive
        .open_gnss()
        .ok()?
        .collect::<Result<Vec<_>, _>>()
        .ok()?;
    Some((imu, with_velocities(fixes)))
}

/// Unix times of this century \[s\] are beyond this; seconds of a GPS week are below.
const UNIX: f64 = 1e9;
const WEEK: f64 = 604_800.0;

/// Moves fixes that have times of day and no date to the day of the IMU.
fn other_day(imu: &Part, gnss: &Part) -> Option<Line> {
    let (imu, fixes) = (imu.measured.as_ref()?, gnss.measured.as_ref()?);
    let leap = match &imu.start {
        Some(_) if imu.first_s > UNIX => 0.0,
        Some(start) => start.leap_seconds,
        None if imu.last_s < WEEK => clocks::LEAP,
        None => return None,
    };
    let spans = [imu, fixes].map(|of| (of.first_s, of.last_s));
    let offset = clocks::days(spans[0], spans[1], leap).filter(|_| fixes.start.is_none())?;
    let known = Known::TimesOfDay { leap: leap != 0.0 };
    Some(Line::new("time_offset", format!("{offset:.0} s"), known))
}

/// Moves the fixes onto the clock of the IMU where the turns of both show by how much; what to note where the logs have no
/// time in common. `None` where nothing is changed.
fn other_clock(gnss: &mut Part, drive: &Drive) -> Option<Option<Note>> {
    let (samples, fixes) = records(drive)?;
    let (first, last) = (samples.first()?.time, samples.last()?.time);
    let (begin, end) = (fixes.first()?.time, fixes.last()?.time);
    if let Some(offset) = clocks::gps_epoch((first, last), (begin, end)) {
        let line = Line::new("time_offset", format!("{offset:.0} s"), Known::GpsSeconds);
        gnss.lines.push(line);
        return Some(None);
    }
    let Some((offset, known)) = clocks::offset(&samples, &fixes) else {
        let offset_s = first - begin;
        return (begin > last || end < first).then_some(Some(Note::Apart { offset_s }));
    };
    // Beyond an hour the dates of the log do not count.
    let dated = *drive.gnss.1.clone().time_offset();
    let offset = match offset.abs() < OTHER_CLOCK {
        true => offset,
        false => dated + offset,
    };
    gnss.lines
        .push(Line::new("time_offset", format!("{offset:.2} s"), known));
    Some(None)
}

/// Counts of the most usual range per deg/s.
const COUNTED: f64 = 131.0;

/// Reverses the specific force where only so it fits the turns and the motion.
fn other_sign(imu: &mut Part, drive: &Drive) -> bool {
    let unit = imu.lines.iter_mut().find(|line| line.key == "accel_unit");
    let Some((line, (samples, fixes))) = unit.zip(records(drive)) else {
        return false;
    };
    let unit = line.value.as_str().unwrap_or_default();
    if unit.starts_with('-') || !is_force_reversed(&samples, &fixes) {
        return false;
    }
    *line = Line::new("accel_unit", format!("-{unit}"), Known::Reversed);
    true
}

/// Units of gyros of which people know no more than the numbers.
const THOUSANDTHS: [&str; 2] = ["mrad/s", "mdps"];

/// Takes the other unit of the gyros where theirs was guessed by their scatter and they turn 57 times as fast or as
/// slowly as the course.
fn other_unit(imu: &mut Part, drive: &Drive) -> bool {
    let guessed = imu.lines.iter_mut().find(|line| {
        let guess = matches!(
            line.known,
            Known::LargestRate(_)
                | Known::LargeScatter(_)
                | Known::SmallScatter(_)
                | Known::Counts
                | Known::Name { .. }
        );
        line.key == "gyro_unit" && guess
    });
    let Some((line, (samples, fixes))) = guessed.zip(records(drive)) else {
        return false;
    };
    let degree = 1f64.to_radians();
    let Some(ratio) = turn_ratio(&samples, &fixes) else {
        return false;
    };
    if line.known == Known::Counts {
        // Of the usual ranges, which differ by factors of two.
        let wanted = ratio * COUNTED;
        let scale = |unit: &&&str| {
            unit_factor(unit, Quantity::AngularRate).map_or(f64::INFINITY, |factor| {
                (degree / factor / wanted).ln().abs()
            })
        };
        let nearest = COUNTS_OF_RATE
            .iter()
            .min_by(|a, b| scale(a).total_cmp(&scale(b)));
        let Some(unit) = nearest.filter(|unit| **unit != COUNTS_OF_RATE[0]) else {
            return false;
        };
        *line = Line::new("gyro_unit", *unit, Known::Turns(ratio));
        return true;
    }
    // Thousandths, as microcontrollers and autopilots count.
    let factor = |unit: &str| unit_factor(unit, Quantity::AngularRate).ok();
    let fits_as = |unit: &&&str| {
        let of = line.value.as_str().and_then(factor).zip(factor(unit));
        of.is_some_and(|(now, then)| (0.7..1.4).contains(&(ratio * then / now)))
    };
    if let Some(unit) = THOUSANDTHS.iter().find(fits_as) {
        *line = Line::new("gyro_unit", *unit, Known::Turns(ratio));
        return true;
    }
    // A name is taken at its word unless the other unit fits.
    let named = matches!(line.known, Known::Name { .. });
    let fits = |turns: f64| (0.7..1.4).contains(&turns);
    if named && !fits(ratio * degree) && !fits(ratio / degree) {
        return false;
    }
    // Nearer to the other unit than to this one.
    let other = match line.value.as_str().unwrap_or_default() {
        "rad/s" if ratio * degree.sqrt() > 1.0 => "deg/s",
        "rad" if ratio * degree.sqrt() > 1.0 => "deg",
        "deg/s" if ratio < degree.sqrt() => "rad/s",
        "deg" if ratio < degree.sqrt() => "rad",
        _ => return false,
    };
    *line = Line::new("gyro_unit", other, Known::Turns(ratio));
    true
}

#[cfg(test)]
mod tests;
