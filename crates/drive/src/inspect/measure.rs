//! Reads a part of a file with the keys found for it, as a drive would.

use super::{LEVEL_VELOCITY_STD, POSITION_STD, VELOCITY_STD, sensor::Steps, table};
use crate::drive::{DriveError, Logs, Section, Table, gnss, imu, magnetometer, scalars, tables};
use std::path::Path;
use undrift_io::{
    Key, ReadError,
    epoch::Epoch,
    format::Format,
    gaps::{Gap, GapWatch},
    gnss::{GnssReader, GnssSource},
    imu::ImuReader,
    magnetic::MagneticReader,
    poses::Poses,
    scalar::ScalarReader,
    skipped::Skipped,
    truth::TruthReader,
};
use undrift_nav::{Vector3, earth::STANDARD_GRAVITY, parameters::Parameters, sample::FixQuality};
use undrift_results::inspect::{
    Content, CounterRestarts, Known, Line, Measured, Part, Start, about_gravity,
};

/// Reads the part; what was found, or why not, goes into it. What has to be said is said: the stream
/// where there are several, the uncertainty that a log does not tell.
pub(super) fn measure(path: &Path, logs: &mut Logs, format: Format, part: &mut Part) {
    loop {
        let result = read(path, logs, part);
        if let Some(line) = missing(&result, format, part) {
            part.lines.push(line);
            continue;
        }
        match result {
            Ok((measured, axes)) => {
                if let Some(unit) = unit_of_force(&measured, format, part) {
                    part.lines.push(unit);
                    continue;
                }
                part.lines.extend(axes);
                part.lines.extend(vehicle_heading(part));
                part.measured = Some(measured);
            }
            Err(error) => part.problem = Some(error.to_string()),
        }
        return;
    }
}

/// The unit of the forces of a log that should have them in m/s², where gravity shows that it has another. A telephone that
/// has them in g is an iPhone, whose signs are opposite.
fn unit_of_force(measured: &Measured, format: Format, part: &Part) -> Option<Line> {
    let stated = part.lines.iter().any(|line| line.key == "accel_unit");
    // Of each sample: on average over an IMU that turns the forces point nowhere.
    let size = measured.size_of_force.filter(|_| !stated)?;
    let units = [("g", 1.0), ("mg", 1000.0)];
    let (unit, _) = units
        .into_iter()
        .find(|(_, gravity)| about_gravity([0.0, 0.0, size / gravity * STANDARD_GRAVITY]))?;
    match format {
        _ if !format.is_log() => None,
        Format::SensorLogger => Some(Line::new(
            "accel_unit",
            format!("-{unit}"),
            Known::Telephone(size),
        )),
        _ => Some(Line::new("accel_unit", unit, Known::Gravity(size))),
    }
}

/// Messages whose heading is the vehicle's, as the receiver is set up, and not that of two antennas.
const OF_VEHICLE: [&str; 4] = ["AttEuler", "HDT", "THS", "PASHR"];

/// Where a heading is that of the vehicle.
fn vehicle_heading(part: &Part) -> Option<Line> {
    let topic = part.lines.iter().find(|line| line.key == "topic");
    let topic = topic.and_then(|line| line.value.as_str());
    let (_, names) = part.choices.iter().find(|(key, _)| *key == "topic")?;
    let name = topic.or(names.first().map(String::as_str))?;
    let of_vehicle = part.table == "heading" && OF_VEHICLE.contains(&name);
    of_vehicle.then(|| Line::new("baseline", "0 deg", Known::VehicleHeading))
}

/// The line that reading asked for, if it is not there yet.
fn missing(
    result: &Result<(Measured, Option<Line>), DriveError>,
    format: Format,
    part: &Part,
) -> Option<Line> {
    let key = match result {
        Err(DriveError::Read(error)) => error.key.as_ref()?,
        Ok((measured, _)) if measured.untold_velocities > 0 => &Key::VelocityStd,
        _ => return None,
    };
    let of_stream = |key: &'static str| {
        let (_, names) = part.choices.iter().find(|(choice, _)| *choice == key)?;
        let (first, others) = names.split_first()?;
        Some(Line::new(key, &**first, Known::FirstOf(others.to_vec())))
    };
    let line = match key {
        Key::PositionStd => Line::new("position_std", POSITION_STD, Known::NotInLog),
        Key::VelocityStd if format == Format::Nmea => {
            Line::new("velocity_std", LEVEL_VELOCITY_STD, Known::NotInNmea)
        }
        Key::VelocityStd => Line::new("velocity_std", VELOCITY_STD, Known::NotInLog),
        Key::Topic(_) => of_stream("topic")?,
        Key::VelocityTopic => of_stream("velocity_topic")?,
        Key::Other(_) => return None,
    };
    let is_there = part.lines.iter().any(|there| there.key == line.key);
    (!is_there).then_some(line)
}

fn read(path: &Path, logs: &mut Logs, part: &Part) -> Result<(Measured, Option<Line>), DriveError> {
    let tables = toml::Table::from_iter([(part.table.to_owned(), table(path, part).into())]);
    let top = Section::values(Table::Values(&tables), "guessed keys");
    let section = top.section(part.table)?;
    match part.table {
        "imu" => {
            let ((path, format), _) = imu::read_imu(&section, logs)?;
            Ok(samples(logs.read(&path, &format)?)?)
        }
        "gnss" => {
            let (path, source) = gnss::read_gnss(&section, logs)?;
            Ok((fixes(logs.read(&path, &source)?)?, None))
        }
        "poses" => {
            let local = top.section("local")?;
            let ((path, source), _) = crate::drive::poses::read(&section, &local, logs)?;
            Ok((local_poses(logs, &path, &source)?, None))
        }
        "heading" => {
            let ((path, format), _) = scalars::read_heading(&section, logs, Parameters::none())?;
            Ok((headings(logs.read(&path, &format)?)?, None))
        }
        magnetometer::TABLE => {
            let (read, _) = magnetometer::read(&section, logs, Parameters::none())?;
            match read {
                Some(((path, format), _)) => Ok((fields(logs.read(&path, &format)?)?, None)),
                None => Err(section.error("file", "missing").into()),
            }
        }
        _ => match tables::read_truth(&section, logs)? {
            Some((path, source)) => Ok((poses(logs.read(&path, &source)?)?, None)),
            None => Err(section.error("file", "missing").into()),
        },
    }
}

/// Whether the mean specific force that was measured is about gravity.
pub(super) fn is_gravity(part: &Part) -> bool {
    part.measured.as_ref().is_some_and(|of| match of.content {
        Some(Content::Force(force)) => about_gravity(force),
        _ => true,
    })
}

/// Counts, and how the sensor sits by where gravity points.
fn samples(mut reader: ImuReader) -> Result<(Measured, Option<Line>), ReadError> {
    let mut span = Span::default();
    let mut force = Vector3::zeros();
    let mut size = 0.0;
    let mut steps = Steps::default();
    for sample in reader.by_ref() {
        let sample = sample?;
        steps.add(&sample);
        span.add(sample.time);
        force += sample.dvel / sample.dt;
        size += sample.dvel.norm() / sample.dt;
    }
    let records = span.records.max(1) as f64;
    let force = force / records;
    let mut axes = None;
    if about_gravity(force.into()) {
        // Specific force at rest points up.
        let up = force.z / force.norm();
        axes = Some(if up < -0.8 {
            Line::new("axes", "x,y,z", Known::PointsDown)
        } else if up > 0.8 {
            Line::new("axes", "x,-y,-z", Known::PointsUp)
        } else {
            Line::new("mounting", "auto", Known::Tilted)
        });
    }
    let mut measured = span.measured(reader.skipped(), reader.epoch());
    measured.steps_of = steps.sensor();
    measured.size_of_force = Some(size / records);
    measured.content = Some(Content::Force(force.into()));
    Ok((measured, axes))
}

fn fixes(mut reader: GnssReader) -> Result<Measured, ReadError> {
    let mut span = Span::default();
    const KINDS: [FixQuality; 5] = [
        FixQuality::Fixed,
        FixQuality::Float,
        FixQuality::Differential,
        FixQuality::Single,
        FixQuality::Unknown,
    ];
    let mut kinds = [0u64; 5];
    let mut velocities = 0u64;
    for fix in reader.by_ref() {
        let fix = fix?;
        span.add(fix.time);
        velocities += u64::from(fix.velocity.is_some());
        for (count, kind) in kinds.iter_mut().zip(KINDS) {
            *count += u64::from(fix.quality == kind);
        }
    }
    let mut measured = span.measured(reader.skipped(), reader.epoch());
    measured.content = Some(Content::Fixes { kinds, velocities });
    measured.untold_velocities = reader.untold_velocities();
    Ok(measured)
}

fn headings(mut reader: ScalarReader) -> Result<Measured, ReadError> {
    let mut span = Span::default();
    for heading in reader.by_ref() {
        span.add(heading?.time);
    }
    Ok(span.measured(reader.skipped(), reader.epoch()))
}

fn fields(mut reader: MagneticReader) -> Result<Measured, ReadError> {
    let mut span = Span::default();
    for reading in reader.by_ref() {
        span.add(reading?.time);
    }
    Ok(span.measured(reader.skipped(), reader.epoch()))
}

fn poses(mut reader: TruthReader) -> Result<Measured, ReadError> {
    let mut span = Span::default();
    let (mut velocities, mut attitudes) = (0u64, 0u64);
    for sample in reader.by_ref() {
        let sample = sample?;
        span.add(sample.time);
        velocities += u64::from(sample.v_n.is_some());
        attitudes += u64::from(sample.rpy.is_some());
    }
    let mut measured = span.measured(reader.skipped(), reader.epoch());
    measured.content = Some(Content::Poses {
        velocities,
        attitudes,
    });
    Ok(measured)
}

fn local_poses(logs: &Logs, path: &Path, source: &GnssSource) -> Result<Measured, ReadError> {
    let GnssSource::Poses(fixes) = source else {
        return Ok(Measured::default());
    };
    let mut reader = logs.read::<Poses>(path, &fixes.source)?;
    let (mut span, mut attitudes) = (Span::default(), 0u64);
    for pose in reader.by_ref() {
        let pose = pose?;
        span.add(pose.time);
        attitudes += u64::from(pose.attitude.is_some());
    }
    let mut measured = span.measured(reader.skipped(), reader.epoch());
    measured.content = Some(Content::Poses {
        velocities: 0,
        attitudes,
    });
    Ok(measured)
}

/// Times as they come.
#[derive(Default)]
struct Span {
    records: u64,
    first: f64,
    last: f64,
    gaps: GapWatch,
}

impl Span {
    fn add(&mut self, time: f64) {
        if self.records == 0 {
            self.first = time;
        } else {
            self.gaps.add(Gap {
                start: self.last,
                length: time - self.last,
                line: 0, // unknown
            });
        }
        self.records += 1;
        self.last = time;
    }

    fn measured(&self, skipped: &Skipped, epoch: Option<Epoch>) -> Measured {
        let gaps = self.gaps.summary();
        Measured {
            records: self.records,
            start: epoch.map(|epoch| Start {
                utc: epoch.iso(self.first),
                leap_seconds: epoch.leap_seconds(self.first),
                clock: epoch.clock.name(),
            }),
            first_s: self.first,
            last_s: self.last,
            rate_hz: match gaps.nominal_interval {
                0.0 => 0.0,
                interval => 1.0 / interval,
            },
            gaps: gaps.count,
            longest_gap_s: gaps.longest.map(|gap| (gap.start, gap.length)),
            skipped: skipped.to_string(),
            counter: skipped.restarts().map(|restarts| CounterRestarts {
                line: restarts.line,
                count: restarts.count,
                length: restarts.length,
            }),
            ..Measured::default()
        }
    }
}

#[cfg(test)]
mod tests;
