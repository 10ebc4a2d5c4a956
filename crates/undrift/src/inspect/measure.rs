//! Reads a part of a file with the keys found for it, as a drive would.

use super::{Line, Measured, Part, quoted};
use crate::drive::{DriveError, Memory, Section, gnss, imu, parse, tables};
use std::path::Path;
use undrift_io::{
    ReadError,
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
pub(super) fn measure(path: &Path, format: Format, part: &mut Part) {
    loop {
        let result = read(path, part);
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
    let why = "guessed: the log does not tell; set what fits the receiver";
    match key {
        "position_std" => Some(Line::text("position_std", POSITION_STD, why)),
        "velocity_std" if format == Format::Nmea => {
            let why = "guessed: NMEA does not tell; large for the vertical speed, which it lacks";
            Some(Line::text("velocity_std", NMEA_VELOCITY_STD, why))
        }
        "velocity_std" => Some(Line::text("velocity_std", VELOCITY_STD, why)),
        _ => {
            let (key, names) = part.choices.iter().find(|(choice, _)| *choice == key)?;
            let (first, others) = names.split_first()?;
            let why = format!("the first of several; the others: {}", others.join(", "));
            Some(Line::text(key, first, why))
        }
    }
}

fn read(path: &Path, part: &Part) -> Result<(Measured, Option<Line>), DriveError> {
    let mut text = format!(
        "[{}]\nfile = {}\n",
        part.table,
        quoted(&path.to_string_lossy())
    );
    for line in &part.lines {
        text += &format!("{} = {}\n", line.key, line.value);
    }
    let parsed = parse(&text, "the guessed keys")?;
    let top = Section::top(parsed.get_ref(), &text, "the guessed keys");
    let section = top.section(part.table)?;
    let here = Path::new("");
    match part.table {
        "imu" => {
            let ((path, format), _) = imu::read_imu(&section, here, None)?;
            Ok(samples(ImuReader::open(&path, &format)?)?)
        }
        "gnss" => {
            let (path, source) = gnss::read_gnss(&section, here, None)?;
            Ok((fixes(source.open(&path, &Memory::new())?)?, None))
        }
        _ => match tables::read_truth(&section, here)? {
            Some((path, source)) => Ok((poses(source.open(&path, &Memory::new())?)?, None)),
            None => Err(section.error("file", "is not there").into()),
        },
    }
}

/// Whether the mean specific force that was measured is about gravity.
pub(super) fn is_gravity(part: &Part) -> bool {
    let suspicious = |measured: &Measured| measured.remarks.iter().any(|r| r.contains(NOT_GRAVITY));
    part.measured
        .as_ref()
        .is_some_and(|measured| !suspicious(measured))
}

const NOT_GRAVITY: &str = "which is not gravity's";

/// Counts, and how the sensor sits by where gravity points.
fn samples(mut reader: ImuReader) -> Result<(Measured, Option<Line>), ReadError> {
    let mut span = Span::default();
    let mut force = Vector3::zeros();
    for sample in reader.by_ref() {
        let sample = sample?;
        span.add(sample.time);
        force += sample.dvel / sample.dt;
    }
    let force = force / span.records.max(1) as f64;
    let size = force.norm();
    let mut remarks = Vec::new();
    let mut axes = None;
    let shown = format!(
        "mean specific force {:.2}, {:.2}, {:.2} m/s^2",
        force.x, force.y, force.z
    );
    if (size / STANDARD_GRAVITY - 1.0).abs() > 0.15 {
        remarks.push(format!("{shown}: of magnitude {size:.3} m/s^2, {NOT_GRAVITY}: is the unit wrong, or was it no ordinary drive?"));
    } else {
        // Specific force at rest points up.
        let up = force / size;
        let (value, why) = if up.z < -0.8 {
            (
                "x,y,z",
                "the z axis points down; x forward and y right are assumed",
            )
        } else if up.z > 0.8 {
            (
                "x,-y,-z",
                "the z axis points up; x forward and y left are assumed; with y forward, \"y,x,-z\"",
            )
        } else {
            (
                "",
                "the z axis is not vertical; or give axes, such as \"z,y,-x\"",
            )
        };
        axes = Some(match value {
            "" => Line::text("mounting", "auto", why),
            axes => Line::text("axes", axes, why),
        });
        remarks.push(shown);
    }
    let mut measured = span.measured(reader.skipped());
    measured.remarks = remarks;
    Ok((measured, axes))
}

fn fixes(mut reader: GnssReader) -> Result<Measured, ReadError> {
    let mut span = Span::default();
    let kinds = [
        (FixQuality::Fixed, "fixed"),
        (FixQuality::Float, "float"),
        (FixQuality::Differential, "differential"),
        (FixQuality::Single, "single"),
        (FixQuality::Unknown, "of unknown kind"),
    ];
    let mut counts = [0u64; 5];
    let mut velocities = 0u64;
    for fix in reader.by_ref() {
        let fix = fix?;
        span.add(fix.time);
        velocities += u64::from(fix.velocity.is_some());
        for (count, (kind, _)) in counts.iter_mut().zip(kinds) {
            *count += u64::from(fix.quality == kind);
        }
    }
    let mut remarks: Vec<String> = Vec::new();
    let shares: Vec<String> = counts
        .iter()
        .zip(kinds)
        .filter(|(count, _)| **count > 0)
        .map(|(count, (_, name))| format!("{count} {name}"))
        .collect();
    remarks.push(format!(
        "fixes: {}; {velocities} with a velocity",
        shares.join(", ")
    ));
    let mut measured = span.measured(reader.skipped());
    measured.remarks = remarks;
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
    let mut measured = span.measured(reader.skipped());
    measured.remarks = vec![format!(
        "{velocities} with a velocity, {attitudes} with an attitude"
    )];
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

    fn measured(&self, skipped: &Skipped) -> Measured {
        let gaps = self.gaps.summary();
        Measured {
            records: self.records,
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
            remarks: Vec::new(),
        }
    }
}
