//! Folders that the app Sensor Logger exports, unpacked: a file for each sensor, with columns
//! `time,seconds_elapsed,z,y,x`, and `Location.csv`.
//!
//! [`folder`] makes one text of those that are read, in the order of their times, each row behind the name of
//! its file; so all else reads it as any log. `time` is Unix time in nanoseconds. A sample is a rate of
//! Gyroscope or GyroscopeUncalibrated, with the force of TotalAcceleration or AccelerometerUncalibrated on the
//! straight line at its time; without these two the sum of Accelerometer, from which the app has taken gravity, and Gravity.
//! Accelerometer alone is refused. [`of_objects`] makes the same text of its JSON.

mod objects;

use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use undrift_nav::Vector3;

use super::phone::{self, Join, Location};
use super::receiver::{Ready, by_lines, check, check_name};
use crate::ReadError;
use crate::entry::{Entries, Entry, FieldReading, Stream, StreamKind, Wanted, What};
use crate::epoch::ClockSource;
use crate::number;
use crate::skipped::{SkipKind, shown};
use crate::source::{self, Source};
use crate::table::lines::{Lines, MAX_LINE};
use crate::time::WeekClock;

pub(crate) use objects::{are_objects, of_objects};

/// The first line of the text that is made of a folder.
const MARK: &str = "# Sensor Logger";
/// Gyroscopes, accelerometers and places; of each the first that is there.
const GYROS: [&str; 2] = ["Gyroscope", "GyroscopeUncalibrated"];
const ACCELS: [&str; 2] = ["TotalAcceleration", "AccelerometerUncalibrated"];
const PLACES: [&str; 2] = ["LocationGps", "Location"];
/// Magnetometers in microtesla, the first that is there.
const FIELDS: [&str; 2] = ["Magnetometer", "MagnetometerUncalibrated"];
/// Without gravity.
const LINEAR: &str = "Accelerometer";
/// What was taken out of it.
const GRAVITY: &str = "Gravity";
const AXES: [&str; 4] = ["time", "x", "y", "z"];
const PLACE: [&str; 10] = [
    "time",
    "latitude",
    "longitude",
    "altitude",
    "horizontalAccuracy",
    "verticalAccuracy",
    "speed",
    "bearing",
    "speedAccuracy",
    "bearingAccuracy",
];

/// The text of a folder; `None` if no such file is in it.
///
/// # Errors
/// If a file cannot be read.
pub(crate) fn folder(path: &Path) -> Result<Option<Source>, ReadError> {
    let mut text = format!("{MARK}\n");
    let mut files = Vec::new();
    let sensors = chosen(|name| file(path, name).is_some());
    for name in sensors.names {
        let mut rows = SensorFile::open(path, name)?;
        text += &format!("# {name},{}\n", rows.header);
        rows.step()
            .map_err(|error| source::cannot_open(path, error))?;
        files.push(rows);
    }
    if sensors.linear {
        text += &format!("# {LINEAR}\n");
    }
    if files.is_empty() {
        return Ok(None);
    }
    let merged = Merged {
        files,
        held: text.into_bytes(),
        at: 0,
    };
    Ok(Some(Box::new(BufReader::new(merged))))
}

/// Which sensors are read.
struct Chosen {
    names: Vec<&'static str>,
    /// Whether there are accelerations without gravity that are not.
    linear: bool,
}

/// Those of the sensors that are there.
fn chosen(is_there: impl Fn(&str) -> bool) -> Chosen {
    let first = |names: [&'static str; 2]| names.into_iter().find(|name| is_there(name));
    let summands = match first(ACCELS) {
        Some(whole) => vec![whole],
        None if is_there(GRAVITY) && is_there(LINEAR) => vec![GRAVITY, LINEAR],
        None => Vec::new(),
    };
    let linear = is_there(LINEAR) && !summands.contains(&LINEAR);
    let sensors = first(GYROS).into_iter().chain(summands);
    Chosen {
        names: sensors.chain(first(FIELDS)).chain(first(PLACES)).collect(),
        linear,
    }
}

/// The file of a sensor, plain or compressed.
fn file(folder: &Path, name: &str) -> Option<PathBuf> {
    let files = ["csv", "csv.gz", "csv.zst"].map(|kind| folder.join(format!("{name}.{kind}")));
    files.into_iter().find(|file| file.is_file())
}

/// The rows of one file.
struct SensorFile {
    name: &'static str,
    header: String,
    lines: Source,
    /// The next row and its time.
    next: Option<(f64, String)>,
}

impl SensorFile {
    fn open(folder: &Path, name: &'static str) -> Result<Self, ReadError> {
        let path = file(folder, name).unwrap_or_default();
        let mut rows = Self {
            name,
            header: String::new(),
            lines: source::open(&path)?,
            next: None,
        };
        let header = rows
            .line()
            .map_err(|error| source::cannot_open(&path, error))?;
        rows.header = header.unwrap_or_default();
        Ok(rows)
    }

    /// The next line, of no more bytes than a line may have.
    fn line(&mut self) -> io::Result<Option<String>> {
        let mut bytes = Vec::new();
        (&mut self.lines)
            .take(MAX_LINE as u64)
            .read_until(b'\n', &mut bytes)?;
        let text = String::from_utf8_lossy(bytes.trim_ascii()).into_owned();
        Ok((!bytes.is_empty()).then_some(text))
    }

    fn step(&mut self) -> io::Result<()> {
        let before = self.next.take().map_or(f64::MIN, |(time, _)| time);
        if let Some(line) = self.line()? {
            let time = line
                .split(',')
                .next()
                .and_then(|field| number::parse(field.trim().as_bytes()));
            // One that has no time comes at once.
            self.next = Some((time.unwrap_or(before), line));
        }
        Ok(())
    }
}

/// The rows of all files in the order of their times.
struct Merged {
    files: Vec<SensorFile>,
    held: Vec<u8>,
    at: usize,
}

impl Read for Merged {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.at == self.held.len() {
            let time =
                |rows: &SensorFile| rows.next.as_ref().map_or(f64::INFINITY, |(time, _)| *time);
            let with_row = self.files.iter_mut().filter(|rows| rows.next.is_some());
            let Some(rows) = with_row.min_by(|a, b| time(a).total_cmp(&time(b))) else {
                return Ok(0);
            };
            let (_, row) = rows.next.as_ref().unwrap_or(&(0.0, String::new())).clone();
            (self.held, self.at) = (format!("{},{row}\n", rows.name).into_bytes(), 0);
            rows.step()?;
        }
        let rest = self.held.get(self.at..).unwrap_or_default();
        let n = rest.len().min(into.len());
        into.iter_mut().zip(rest).for_each(|(to, from)| *to = *from);
        self.at += n;
        Ok(n)
    }
}

/// Whether a text is one of [`folder`].
pub(crate) fn detect(start: &[u8]) -> bool {
    start.starts_with(MARK.as_bytes())
}

pub(super) fn entries(source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    check(wanted, "a folder of Sensor Logger", [&GYROS, &PLACES, &[]])?;
    if let Wanted::Fields(name) = wanted {
        check_name(name, "a folder of Sensor Logger", &FIELDS, "magnetometer")?;
    }
    let reader = Reader {
        sensors: Vec::new(),
        place: None,
        weeks: WeekClock::default(),
        linear: false,
        of_field: matches!(wanted, Wanted::Fields(_)),
        join: matches!(wanted, Wanted::Imu(_)).then(Join::default),
        sum: Join::default(),
        sums: Ready::default(),
    };
    Ok(by_lines(
        wanted,
        Lines::new(source),
        Some("no row of such a file".to_owned()),
        reader,
        Reader::line,
        Reader::end,
        |reader| reader.weeks.epoch(ClockSource::Host),
    ))
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    let rates = "rates, with the forces of the accelerometers";
    let known = [
        GYROS.map(|name| (name, StreamKind::Imu, rates)),
        FIELDS.map(|name| (name, StreamKind::Fields, "magnetic fields")),
        ACCELS.map(|name| (name, StreamKind::Other, "specific forces")),
        [LINEAR, GRAVITY].map(|name| (name, StreamKind::Other, "a part of the specific forces")),
        PLACES.map(|name| (name, StreamKind::Fixes, "fixes")),
    ];
    Ok(phone::streams(source, known.as_flattened(), |line| {
        let name = line.split(|&byte| byte == b',').next()?;
        std::str::from_utf8(name).ok()
    }))
}

struct Reader {
    /// Sensors that are there, and where their columns are.
    sensors: Vec<(String, [Option<usize>; 4])>,
    place: Option<[Option<usize>; 10]>,
    weeks: WeekClock,
    /// Whether there are accelerations without gravity.
    linear: bool,
    /// Whether the magnetic fields are wanted.
    of_field: bool,
    join: Option<Join>,
    /// The specific forces that are the sum of two sensors.
    sum: Join,
    sums: Ready,
}

impl Reader {
    fn line(&mut self, at: u64, line: &[u8], ready: &mut Ready) -> Result<(), ReadError> {
        let line = String::from_utf8_lossy(line);
        match line.strip_prefix("# ") {
            Some(header) => self.header(header),
            None => self.row(at, &line, ready)?,
        }
        Ok(())
    }

    fn header(&mut self, header: &str) {
        let mut names = header.split(',');
        let file = names.next().unwrap_or_default();
        let names: Vec<&str> = names.map(str::trim).collect();
        let place = |wanted: &str| names.iter().position(|name| *name == wanted).map(|k| k + 1);
        if PLACES.contains(&file) {
            self.place = Some(PLACE.map(place));
        } else if !names.is_empty() {
            self.sensors.push((file.to_owned(), AXES.map(place)));
        }
        self.linear |= header == LINEAR;
    }

    fn row(&mut self, at: u64, line: &str, ready: &mut Ready) -> Result<(), ReadError> {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let file = fields.first().copied().unwrap_or_default();
        let number = |place: Option<usize>| number::parse_finite(fields.get(place?)?.as_bytes());
        let is_place = PLACES.contains(&file);
        let places = match is_place {
            true => self.place.and_then(|places| places[0]),
            false => self
                .sensors
                .iter()
                .find(|(name, _)| name == file)
                .and_then(|(_, places)| places[0]),
        };
        let stamp = places.and_then(|place| fields.get(place)?.parse::<i64>().ok());
        let Some(stamp) = stamp else {
            ready.skip(at, SkipKind::Text, shown(line.as_bytes()));
            return Ok(());
        };
        let nanos = u32::try_from(stamp.rem_euclid(1_000_000_000)).unwrap_or_default();
        let time = self.weeks.unix(stamp.div_euclid(1_000_000_000), nanos);
        let missing =
            |ready: &mut Ready| ready.skip(at, SkipKind::MissingField, shown(line.as_bytes()));
        let of_field = FIELDS.contains(&file);
        if of_field != self.of_field {
            return Ok(());
        }
        match (&mut self.join, is_place) {
            (None, false) if of_field => {
                let sensor = self.sensors.iter().find(|(name, _)| name == file);
                let [_, x, y, z] = sensor.map_or([None; 4], |(_, places)| *places).map(number);
                let (Some(x), Some(y), Some(z)) = (x, y, z) else {
                    missing(ready);
                    return Ok(());
                };
                let field = Vector3::new(x, y, z) * 1e-6;
                ready.push(at, What::Field(FieldReading { time, field }));
            }
            (None, true) => {
                let [_, lat, lon, height, rest @ ..] = self.place.unwrap_or_default();
                let [horizontal, vertical, speed, bearing, speed_std, bearing_std] =
                    rest.map(number);
                let (Some(lat), Some(lon), Some(height)) =
                    (number(lat), number(lon), number(height))
                else {
                    missing(ready);
                    return Ok(());
                };
                let place = [lat, lon, height];
                let location = Location {
                    place,
                    horizontal,
                    vertical,
                    speed,
                    bearing,
                    speed_std,
                    bearing_std,
                };
                location.fix(at, time, ready);
            }
            (Some(join), false) => {
                let places = self
                    .sensors
                    .iter()
                    .find(|(name, _)| name == file)
                    .map(|(_, places)| *places);
                let [_, x, y, z] = places.unwrap_or_default().map(number);
                let (Some(x), Some(y), Some(z)) = (x, y, z) else {
                    missing(ready);
                    return Ok(());
                };
                let value = (at, time, Vector3::new(x, y, z));
                match file {
                    LINEAR => self.sum.gyro(value, &mut self.sums)?,
                    GRAVITY => self.sum.accel(value, &mut self.sums)?,
                    _ if GYROS.contains(&file) => join.gyro(value, ready)?,
                    _ => join.accel(value, ready)?,
                }
                for Entry { at, what } in self.sums.take() {
                    match what {
                        What::Imu(both) => {
                            join.accel((at, both.time, both.gyro + both.accel), ready)?;
                        }
                        other => ready.push(at, other),
                    }
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Whether there was what is wanted.
    fn end(&mut self, _: &mut Ready) -> Result<(), ReadError> {
        let has = |names: &[&str]| {
            self.sensors
                .iter()
                .any(|(name, _)| names.contains(&name.as_str()))
        };
        let has_force = has(&ACCELS) || has(&[LINEAR]) && has(&[GRAVITY]);
        match &self.join {
            Some(join) if !join.given => {
                let problem = match (has(&GYROS), has_force) {
                    (true, false) if self.linear => {
                        "Accelerometer is without gravity, which an inertial solution needs"
                    }
                    (true, false) => "no accelerometers in this recording",
                    (false, _) => "no gyroscopes in this recording",
                    (true, true) => "gyroscopes and accelerometers at no common time",
                };
                let mend = "record Gyroscope, and Total Acceleration, Accelerometer Uncalibrated, or Accelerometer and Gravity";
                Err(ReadError::nameless(problem).mend(mend))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests;
