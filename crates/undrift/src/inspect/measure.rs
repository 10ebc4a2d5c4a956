//! Reads a part of a file with the keys found for it, as a drive would.

use super::sensor::Steps;
use super::{
    known::{Content, Known},
    parts::{Line, Measured, Part, Start, quoted},
};
use crate::drive::{DriveError, Logs, Section, gnss, imu, parse, tables};
use std::path::Path;
use undrift_io::{
    ReadError,
    epoch::Epoch,
    format::Format,
    gaps::{Gap, GapWatch},
    gnss::GnssReader,
    imu::ImuReader,
    skipped::Skipped,
    truth::TruthReader,
};
use undrift_nav::{Vector3, earth::STANDARD_GRAVITY, sample::FixQuality};

/// Standard deviations to begin with where a log does not tell any: a single-frequency receiver
/// under an open sky.
const POSITION_STD: &str = "3, 3, 6 m";
const VELOCITY_STD: &str = "0.2, 0.2, 0.4 m/s";
/// NMEA has no vertical speed: 20 m/s leave it open.
const NMEA_VELOCITY_STD: &str = "0.2, 0.2, 20 m/s";

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
                part.lines.extend(axes);
                part.measured = Some(measured);
            }
            Err(error) => part.problem = Some(error.to_string()),
        }
        return;
    }
}

/// The line that reading asked for, if it is not there yet.
fn missing(
    result: &Result<(Measured, Option<Line>), DriveError>,
    format: Format,
    part: &Part,
) -> Option<Line> {
    let key = match result {
        Err(DriveError::Read(error)) => error.key.as_deref()?.split('.').nth(1)?,
        Ok((measured, _)) if measured.untold_velocities > 0 => "velocity_std",
        _ => return None,
    };
    if part.lines.iter().any(|line| line.key == key) {
        return None;
    }
    match key {
        "position_std" => Some(Line::text("position_std", POSITION_STD, Known::NotInLog)),
        "velocity_std" if format == Format::Nmea => Some(Line::text(
            "velocity_std",
            NMEA_VELOCITY_STD,
            Known::NotInNmea,
        )),
        "velocity_std" => Some(Line::text("velocity_std", VELOCITY_STD, Known::NotInLog)),
        _ => {
            let (key, names) = part.choices.iter().find(|(choice, _)| *choice == key)?;
            let (first, others) = names.split_first()?;
            Some(Line::text(key, first, Known::FirstOf(others.to_vec())))
        }
    }
}

fn read(path: &Path, logs: &mut Logs, part: &Part) -> Result<(Measured, Option<Line>), DriveError> {
    let mut text = format!(
        "[{}]\nfile = {}\n",
        part.table,
        quoted(&path.to_string_lossy())
    );
    for line in &part.lines {
        text += &format!("{} = {}\n", line.key, line.value);
    }
    let parsed = parse(&text, "guessed keys")?;
    let top = Section::top(parsed.get_ref(), &text, "guessed keys");
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

/// Whether a mean specific force \[m/s²\] is about gravity, as it is of an ordinary drive.
pub fn about_gravity(force: [f64; 3]) -> bool {
    (Vector3::from(force).norm() / STANDARD_GRAVITY - 1.0).abs() <= 0.15
}

/// Counts, and how the sensor sits by where gravity points.
fn samples(mut reader: ImuReader) -> Result<(Measured, Option<Line>), ReadError> {
    let mut span = Span::default();
    let mut force = Vector3::zeros();
    let mut steps = Steps::default();
    for sample in reader.by_ref() {
        let sample = sample?;
        steps.add(&sample);
        span.add(sample.time);
        force += sample.dvel / sample.dt;
    }
    let force = force / span.records.max(1) as f64;
    let mut axes = None;
    if about_gravity(force.into()) {
        // Specific force at rest points up.
        let up = force.z / force.norm();
        axes = Some(if up < -0.8 {
            Line::text("axes", "x,y,z", Known::PointsDown)
        } else if up > 0.8 {
            Line::text("axes", "x,-y,-z", Known::PointsUp)
        } else {
            Line::text("mounting", "auto", Known::Tilted)
        });
    }
    let mut measured = span.measured(reader.skipped(), reader.epoch());
    measured.steps_of = steps.sensor();
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
                line: self.records + 1,
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
            untold_velocities: 0,
            steps_of: None,
            content: None,
            remarks: Vec::new(),
        }
    }
}
