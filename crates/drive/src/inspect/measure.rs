//! Reads a part of a file with the keys found for it, as a drive would.

use super::{LEVEL_VELOCITY_STD, POSITION_STD, VELOCITY_STD, sensor::Steps, table};
use crate::drive::{DriveError, Logs, Section, Table, gnss, imu, tables};
use std::path::Path;
use undrift_io::{
    Key, ReadError,
    epoch::Epoch,
    format::Format,
    gaps::{Gap, GapWatch},
    gnss::{GnssReader, GnssSource},
    imu::ImuReader,
    poses::Poses,
    skipped::Skipped,
    truth::TruthReader,
};
use undrift_nav::{Vector3, earth::STANDARD_GRAVITY, sample::FixQuality};
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
mod tests {
    use super::*;
    use undrift_io::Memory;

    /// Reads a text as a part of a drive with some keys.
    fn measured(table: &'static str, keys: &[(&'static str, &str)], text: &str) -> Part {
        let mut logs = Logs::default();
        let held = Memory::Bytes(text.as_bytes().into());
        logs.memory.insert("log".into(), held);
        let values: toml::Table = keys
            .iter()
            .map(|(k, v)| format!("{k} = {v}\n"))
            .collect::<String>()
            .parse()
            .unwrap();
        let line =
            |(key, _): &(&'static str, &str)| Line::new(key, values[*key].clone(), Known::Certain);
        let mut part = Part::new(table, keys.iter().map(line).collect());
        measure(Path::new("log"), &mut logs, Format::Csv, &mut part);
        part
    }

    const IMU: [(&str, &str); 5] = [
        ("time", "1"),
        ("gyro", "[2, 3, 4]"),
        ("gyro_unit", "\"deg/s\""),
        ("accel", "[5, 6, 7]"),
        ("accel_unit", "\"g\""),
    ];

    /// Two seconds at 100 Hz of this specific force \[g\] and of gyros that stand.
    fn forces(force: [f64; 3]) -> Part {
        let [x, y, z] = force;
        let row = |k: i32| format!("{:.2},0,0,0,{x},{y},{z}\n", 0.01 * f64::from(k));
        measured("imu", &IMU, &(0..200).map(row).collect::<String>())
    }

    #[test]
    fn reading_asks_for_a_line_once() {
        let mut part = Part::new("gnss", Vec::new());
        let streams = ["/first", "/second", "/third"].map(str::to_owned);
        part.choices.push(("topic", streams.into()));
        let asks = |key: Key, format, part: &Part| {
            let error = ReadError {
                key: Some(key),
                ..ReadError::new(Path::new("log"), "")
            };
            missing(&Err(error.into()), format, part)
        };
        let position = Line::new("position_std", POSITION_STD, Known::NotInLog);
        let velocity = Line::new("velocity_std", VELOCITY_STD, Known::NotInLog);
        let of_nmea = Line::new("velocity_std", LEVEL_VELOCITY_STD, Known::NotInNmea);
        let others = ["/second", "/third"].map(str::to_owned);
        let first = Line::new("topic", "/first", Known::FirstOf(others.into()));
        let csv = Format::Csv;
        assert_eq!(asks(Key::PositionStd, csv, &part), Some(position));
        assert_eq!(asks(Key::VelocityStd, csv, &part), Some(velocity.clone()));
        assert_eq!(asks(Key::VelocityStd, Format::Nmea, &part), Some(of_nmea));
        assert_eq!(asks(Key::Topic("gnss"), csv, &part), Some(first));
        assert_eq!(asks(Key::VelocityTopic, csv, &part), None);
        assert_eq!(asks("gnss.rate".into(), csv, &part), None);
        let plain = ReadError::new(Path::new("log"), "");
        assert_eq!(missing(&Err(plain.into()), csv, &part), None);
        // Fixes are read all the same where only their velocities have no standard deviation.
        let read = |without_std: u64| {
            let mut of = Span::default().measured(&Skipped::default(), None);
            of.untold_velocities = without_std;
            Ok((of, None))
        };
        assert_eq!(missing(&read(1), csv, &part), Some(velocity.clone()));
        assert_eq!(missing(&read(0), csv, &part), None);
        part.lines.push(velocity);
        assert_eq!(missing(&read(1), csv, &part), None);
        assert_eq!(asks(Key::VelocityStd, csv, &part), None);
    }

    /// Specific force at rest points up: of axes that point down its z is negative.
    #[test]
    fn gravity_shows_how_the_sensor_sits() {
        let axes = |up: f64| {
            let part = forces([(1.0 - up * up).sqrt(), 0.0, up]);
            let line = part.lines.last().unwrap();
            (line.key, line.value.clone(), line.known.clone())
        };
        let down = ("axes", "x,y,z".into(), Known::PointsDown);
        let up = ("axes", "x,-y,-z".into(), Known::PointsUp);
        let tilted = ("mounting", "auto".into(), Known::Tilted);
        // 0.8 is a lean of 37 deg.
        for z in [-1.0, -0.81] {
            assert_eq!(axes(z), down);
            assert_eq!(axes(-z), up);
        }
        for z in [-0.79, 0.0, 0.79] {
            assert_eq!(axes(z), tilted);
        }
        // What is no gravity shows nothing.
        let part = forces([0.0, 0.0, -0.5]);
        assert_eq!(part.lines.len(), IMU.len());
        assert!(!is_gravity(&part));
        assert!(is_gravity(&forces([0.6, 0.0, 0.8])));
    }

    #[test]
    fn gravity_is_known_to_fifteen_hundredths() {
        let of = |size: f64| about_gravity([0.0, size * STANDARD_GRAVITY, 0.0]);
        assert!(of(1.149) && of(0.851) && of(-1.0));
        assert!(!of(1.151) && !of(0.849) && !of(0.0));
        // A part without a force cannot contradict, one that was not read has none.
        let mut part = Part::new("gnss", Vec::new());
        assert!(!is_gravity(&part));
        let mut of = Span::default().measured(&Skipped::default(), None);
        of.content = Some(Content::Poses {
            velocities: 0,
            attitudes: 0,
        });
        part.measured = Some(of);
        assert!(is_gravity(&part));
    }

    /// On the steps of an ADIS16470, a second missing from the third on.
    #[test]
    fn samples_are_counted_and_timed() {
        let mut text = String::new();
        for k in 0..600 {
            let time = 10.0 + 0.01 * f64::from(k) + f64::from(u8::from(k >= 300));
            let steps = f64::from(k * 7919 % 101 - 50);
            let (rate, force) = (0.1 * steps, -1.0 + 1.25e-3 * steps);
            text += &format!("{time:.2},{rate:.6},{rate:.6},{rate:.6},0,{force:.6},0\n");
        }
        let part = measured("imu", &IMU, &text);
        let of = part.measured.unwrap();
        assert_eq!((of.records, of.gaps), (600, 1));
        assert!((of.first_s - 10.0).abs() < 1e-9 && (of.last_s - 16.99).abs() < 1e-9);
        // Stamps of a hundredth are 1e-15 s off.
        assert!((of.rate_hz - 100.0).abs() < 1e-6, "{}", of.rate_hz);
        let (start, length) = of.longest_gap_s.unwrap();
        assert!((start - 12.99).abs() < 1e-9 && (length - 1.01).abs() < 1e-9);
        assert_eq!(of.steps_of, Some("adis16470"));
        let Some(Content::Force(force)) = of.content else {
            panic!("{:?}", of.content);
        };
        // 600 of steps that take all of −50 … 50 in turn: their mean is a tenth of a step.
        let mean = force.map(|x| x / STANDARD_GRAVITY);
        assert!((mean[1] + 1.0).abs() < 0.5 * 1.25e-3, "{mean:?}");
        assert_eq!((mean[0], mean[2]), (0.0, 0.0));
        // Of a single record there is no interval.
        let keys = [
            ("time", "1"),
            ("position", "[2, 3, 4]"),
            ("position_std", "\"1 m\""),
        ];
        let one = measured("gnss", &keys, "1,45,7,300\n").measured.unwrap();
        assert_eq!((one.records, one.rate_hz, one.gaps), (1, 0.0, 0));
        assert_eq!((one.first_s, one.last_s), (1.0, 1.0));
    }

    #[test]
    fn fixes_are_counted_by_their_kind() {
        let keys = [
            ("time", "1"),
            ("position", "[2, 3, 4]"),
            ("velocity", "[5, 6, 7]"),
            ("velocity_std", "\"0.1 m/s\""),
            ("position_std", "\"1 m\""),
            ("quality", "8"),
        ];
        // As RTKLIB numbers them: fixed, float, differential, single; 0 is of no kind.
        let kinds = [(1, 1), (2, 2), (4, 3), (5, 4), (0, 5)];
        let kinds = kinds.map(|(kind, count)| vec![kind; count]).concat();
        let rows = kinds.iter().enumerate().map(|(k, kind)| {
            let velocity = if k < 7 { "1,0,0" } else { ",," };
            format!("{k},45,7,300,{velocity},{kind}\n")
        });
        let part = measured("gnss", &keys, &rows.collect::<String>());
        let of = part.measured.unwrap();
        assert_eq!((of.records, of.rate_hz, of.untold_velocities), (15, 1.0, 0));
        let expected = Content::Fixes {
            kinds: [1, 2, 3, 4, 5],
            velocities: 7,
        };
        assert_eq!(of.content, Some(expected));
    }

    #[test]
    fn reference_solutions_are_counted() {
        let rows = (0..5).map(|k| format!("{k},45,7,300,1,0,0,1,2,3\n"));
        let text: String = rows.collect();
        let place = [("time", "1"), ("position", "[2, 3, 4]")];
        let velocity = [("velocity", "[5, 6, 7]")];
        let attitude = [("attitude", "[8, 9, 10]")];
        for (with_velocity, with_attitude) in
            [(false, false), (true, false), (false, true), (true, true)]
        {
            let mut keys = place.to_vec();
            keys.extend(velocity.iter().filter(|_| with_velocity));
            keys.extend(attitude.iter().filter(|_| with_attitude));
            let of = measured("truth", &keys, &text).measured.unwrap();
            assert_eq!((of.records, of.first_s, of.last_s), (5, 0.0, 4.0));
            let expected = Content::Poses {
                velocities: 5 * u64::from(with_velocity),
                attitudes: 5 * u64::from(with_attitude),
            };
            assert_eq!(of.content, Some(expected));
        }
    }

    #[test]
    fn what_cannot_be_read_says_why() {
        let part = measured(
            "gnss",
            &[("time", "1"), ("position", "[2, 3, 9]")],
            "1,2,3\n",
        );
        assert!(part.measured.is_none() && part.problem.is_some());
    }
}
