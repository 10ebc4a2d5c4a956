//! Text logs of Google's GnssLogger and of GPSTest for Android: fixes of `Fix` lines, inertial samples of
//! `UncalGyro` with `UncalAccel` lines, or of `Gyro` with `Accel`; `Raw` and all others are passed over.
//!
//! The comments at the beginning name the columns of each kind of line. All lines are put on the
//! phone's clock since boot, elapsedRealtimeNanos, which does not jump; it is tied to GPS time by the
//! first line that has UTC beside it, so that fixes and samples of a file go together, whatever the
//! phone's date is. Fixes of older versions have UTC alone. Times are GPS seconds of the week in
//! which the file starts.
//!
//! Android's axes are x to the right and y up along the screen, z out of it; its accelerometers
//! measure specific force. Accuracies are radii or intervals of 68 %: a radius is √(−2 ln 0.32) standard
//! deviations of an axis.

use std::collections::BTreeMap;

use undrift_nav::Vector3;

use super::phone::{self, Join, Location};
use super::receiver::{Ready, by_lines, check};
use crate::entry::{Entries, Stream, StreamKind, Wanted};
use crate::epoch::ClockSource;
use crate::number;
use crate::skipped::{SkipKind, shown};
use crate::source::Source;
use crate::table::lines::Lines;
use crate::time::WeekClock;
use crate::{Key, ReadError};

/// Providers of fixes: satellites, all together, cells and Wi-Fi.
const PROVIDERS: [&str; 3] = ["GPS", "FLP", "NLP"];
/// Gyroscopes, before and after the phone's own corrections, and the accelerometers with them.
const SENSORS: [[&str; 2]; 2] = [["UncalGyro", "UncalAccel"], ["Gyro", "Accel"]];
/// What the columns that are read are called, in lower case.
const COLUMNS: [(&str, &[&str]); 2] = [
    (
        "Fix",
        &[
            "provider",
            "latitude",
            "longitude",
            "altitude",
            "speed",
            "accuracy",
            "bearing",
            "unixtime",
            "speedaccuracy",
            "bearingaccuracy",
            "elapsedrealtime",
            "verticalaccuracy",
        ],
    ),
    ("", &["utctime", "elapsedrealtime", "x", "y", "z"]),
];

/// Where these stand without a comment that names them.
const FIX: [Option<usize>; 12] = {
    let mut places = [None; 12];
    let mut k = 0;
    while k < 12 {
        places[k] = Some(k + 1);
        k += 1;
    }
    places
};
const SENSOR: [Option<usize>; 5] = [Some(1), Some(2), Some(3), Some(4), Some(5)];

/// Whether a text begins with comments that name such lines, or has some.
pub(crate) fn detect(start: &[u8]) -> bool {
    let known = |line: &[u8]| {
        let bare = line
            .strip_prefix(b"#")
            .map(<[u8]>::trim_ascii_start)
            .unwrap_or(line);
        let mut fields = bare.split(|&byte| byte == b',');
        let kind = fields.next().unwrap_or_default();
        let kinds: [&[u8]; 6] = [
            b"Raw",
            b"Fix",
            b"UncalAccel",
            b"UncalGyro",
            b"Accel",
            b"Gyro",
        ];
        let named = kinds.contains(&kind) && line.starts_with(b"#") && fields.clone().count() > 4;
        let fix = kind == b"Fix"
            && fields
                .next()
                .is_some_and(|provider| provider_of(provider).is_some());
        named || fix
    };
    start.split(|&byte| byte == b'\n').take(200).any(known)
}

fn provider_of(field: &[u8]) -> Option<&'static str> {
    PROVIDERS
        .into_iter()
        .find(|known| known.as_bytes().eq_ignore_ascii_case(field))
}

pub(super) fn entries(source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    let gyros = SENSORS.map(|[gyro, _]| gyro);
    check(wanted, "a GnssLogger log", [&gyros, &PROVIDERS, &[]])?;
    let asked = match wanted {
        Wanted::Imu(name)
        | Wanted::Poses(name)
        | Wanted::LocalPoses(name)
        | Wanted::Headings(name)
        | Wanted::Fields(name) => name,
        Wanted::Fixes { position, .. } => position,
    };
    let reader = Reader {
        columns: Columns {
            fix: FIX,
            sensor: BTreeMap::new(),
        },
        weeks: WeekClock::default(),
        boot: None,
        asked: asked.clone(),
        found: None,
        others: None,
        join: matches!(wanted, Wanted::Imu(_)).then(Join::default),
    };
    Ok(by_lines(
        wanted,
        Lines::new(source),
        Some("not a line of such a log".to_owned()),
        reader,
        Reader::line,
        Reader::end,
        |reader| reader.weeks.epoch(ClockSource::Host),
    ))
}

/// Streams as they are listed: of the fixes the likeliest first.
const STREAMS: [(&str, StreamKind, &str); 8] = [
    ("Accel", StreamKind::Other, "specific forces"),
    (
        "Gyro",
        StreamKind::Imu,
        "corrected rates, with the forces of Accel",
    ),
    ("Raw", StreamKind::Other, ""),
    ("UncalAccel", StreamKind::Other, "specific forces"),
    (
        "UncalGyro",
        StreamKind::Imu,
        "rates, with the forces of UncalAccel",
    ),
    ("GPS", StreamKind::Fixes, "fixes by satellites"),
    ("FLP", StreamKind::Fixes, "fused fixes of the phone"),
    ("NLP", StreamKind::Fixes, "fixes by cells and Wi-Fi"),
];

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    Ok(phone::streams(source, &STREAMS, |line| {
        let mut fields = line.split(|&byte| byte == b',');
        match fields.next()? {
            b"Fix" => provider_of(fields.next()?),
            b"Raw" => Some("Raw"),
            sensor => sensor_of(sensor),
        }
    }))
}

fn sensor_of(kind: &[u8]) -> Option<&'static str> {
    let mut known = SENSORS.into_iter().flatten();
    known.find(|name| name.as_bytes() == kind)
}

/// Where the columns of each kind of line are.
struct Columns {
    fix: [Option<usize>; 12],
    sensor: BTreeMap<&'static str, [Option<usize>; 5]>,
}

struct Reader {
    columns: Columns,
    weeks: WeekClock,
    /// GPS time at the phone's boot \[s\].
    boot: Option<f64>,
    /// The stream that is asked for.
    asked: Option<String>,
    /// The sensors that are taken, and what else there was where nothing was asked for.
    found: Option<&'static str>,
    others: Option<&'static str>,
    join: Option<Join>,
}

impl Reader {
    fn line(&mut self, at: u64, line: &[u8], ready: &mut Ready) -> Result<(), ReadError> {
        if let Some(comment) = line.strip_prefix(b"#") {
            self.columns.name(comment.trim_ascii());
            return Ok(());
        }
        let fields: Vec<&[u8]> = line
            .split(|&byte| byte == b',')
            .map(<[u8]>::trim_ascii)
            .collect();
        let kind = fields.first().copied().unwrap_or_default();
        if kind == b"Fix" {
            let read = self.fix(at, &fields, ready);
            if read.is_none() {
                ready.skip(at, SkipKind::MissingField, shown(line));
            }
            return Ok(());
        }
        let Some(sensor) = sensor_of(kind) else {
            return Ok(());
        };
        let Some((time, value)) = self.sensor(sensor, &fields) else {
            ready.skip(at, SkipKind::MissingField, shown(line));
            return Ok(());
        };
        let [gyro, accel] = SENSORS
            .into_iter()
            .find(|pair| pair.contains(&sensor))
            .unwrap_or(SENSORS[0]);
        let Some(join) = &mut self.join else {
            return Ok(());
        };
        let asked = self.asked.as_deref();
        let taken = asked.or(self.found).unwrap_or(gyro);
        if taken != gyro {
            if asked.is_none() && sensor == gyro {
                let problem = format!("two streams of inertial samples: {taken} and {gyro}");
                return Err(ReadError::nameless(problem)
                    .key(Key::Topic("imu"))
                    .mend("choose one with topic"));
            }
            return Ok(());
        }
        if sensor == gyro {
            self.found = Some(gyro);
            return join.gyro((at, time, value), ready);
        }
        if sensor == accel && (asked.is_some() || self.found.is_some()) {
            return join.accel((at, time, value), ready);
        }
        Ok(())
    }

    /// GPS time of a time since boot, which UTC may tie to it \[s\].
    fn time(&mut self, unix_milli: Option<f64>, elapsed_nano: Option<f64>) -> Option<f64> {
        let plausible = |value: &f64| (0.0..1e19).contains(value);
        let elapsed = elapsed_nano.filter(plausible).map(|nano| nano * 1e-9);
        let unix = unix_milli.filter(plausible).map(|milli| {
            let whole = (milli * 1e-3).floor();
            let rest = (milli - whole * 1e3).clamp(0.0, 999.0);
            self.weeks.unix(whole as i64, (rest * 1e6) as u32)
        });
        if let (None, Some(unix), Some(elapsed)) = (self.boot, unix, elapsed) {
            self.boot = Some(unix - elapsed);
        }
        match (elapsed, self.boot) {
            (Some(elapsed), Some(boot)) => Some(boot + elapsed),
            _ => unix,
        }
    }

    /// Time \[s\] and value of a line of a sensor.
    fn sensor(&mut self, sensor: &'static str, fields: &[&[u8]]) -> Option<(f64, Vector3)> {
        let places = self.columns.sensor.get(sensor).unwrap_or(&SENSOR);
        let [unix, elapsed, x, y, z] = places.map(|place| number_at(fields, place));
        let time = self.time(unix, elapsed)?;
        let value = Vector3::new(x?, y?, z?);
        value.iter().all(|v| v.is_finite()).then_some((time, value))
    }

    /// `None` if a field is missing.
    fn fix(&mut self, at: u64, fields: &[&[u8]], ready: &mut Ready) -> Option<()> {
        let [provider, rest @ ..] = &self.columns.fix;
        let provider = provider
            .and_then(|place| fields.get(place))
            .and_then(|field| provider_of(field));
        let numbers = rest.map(|place| number_at(fields, place));
        let [
            lat,
            lon,
            height,
            speed,
            accuracy,
            bearing,
            unix,
            speed_std,
            bearing_std,
            elapsed,
            vertical,
        ] = numbers;
        let time = self.time(unix, elapsed)?;
        let provider = provider?;
        if self.join.is_some() {
            return Some(());
        }
        if provider != self.asked.as_deref().unwrap_or(PROVIDERS[0]) {
            self.others.get_or_insert(provider);
            return Some(());
        }
        self.found = Some(provider);
        let location = Location {
            place: [lat?, lon?, height?],
            horizontal: accuracy,
            vertical,
            speed,
            bearing,
            speed_std,
            bearing_std,
        };
        location.fix(at, time, ready);
        Some(())
    }

    /// Whether there was what is wanted.
    fn end(&mut self, _: &mut Ready) -> Result<(), ReadError> {
        match (&self.join, self.found, self.others) {
            (Some(join), Some(gyro), _) if !join.given => {
                let accel = SENSORS
                    .iter()
                    .find(|pair| pair[0] == gyro)
                    .map_or("", |pair| pair[1]);
                let problem =
                    format!("no {accel} lines beside those of {gyro}, at about the same times");
                Err(ReadError::nameless(problem).mend("switch both sensors on in the recording"))
            }
            (None, None, Some(other)) => {
                let problem = "no fixes by satellites (provider GPS) in this log";
                let mend = format!("topic = \"{other}\" takes those of another provider");
                Err(ReadError::nameless(problem)
                    .key(Key::Topic("gnss"))
                    .mend(mend))
            }
            _ => Ok(()),
        }
    }
}

impl Columns {
    /// Takes the columns of a kind of line from a comment such as `Fix,Provider,LatitudeDegrees,…`.
    fn name(&mut self, comment: &[u8]) {
        let text = String::from_utf8_lossy(comment).to_lowercase();
        let mut names = text.split(',');
        let kind = names.next().unwrap_or_default();
        let names: Vec<String> = names.map(without_unit).collect();
        let place = |wanted: &str| names.iter().position(|name| name == wanted).map(|k| k + 1);
        let [(_, of_fix), (_, of_sensor)] = COLUMNS;
        if kind == "fix" && names.len() > 4 {
            for (column, wanted) in self.fix.iter_mut().zip(of_fix) {
                *column = place(wanted);
            }
        }
        let sensor = SENSORS
            .as_flattened()
            .iter()
            .find(|name| name.to_lowercase() == kind);
        if let Some(sensor) = sensor.filter(|_| names.len() > 4) {
            let mut places = SENSOR;
            for (column, wanted) in places.iter_mut().zip(of_sensor) {
                let own = place(wanted).or_else(|| place(&format!("{kind}{wanted}")));
                *column = own;
            }
            self.sensor.insert(sensor, places);
        }
    }
}

/// The name of a column without its unit: `LatitudeDegrees` is latitude.
fn without_unit(name: &str) -> String {
    let name = name.trim().replace("(utc)timeinms", "unixtime");
    let units = [
        "degrees",
        "meters",
        "mps2",
        "mps",
        "millis",
        "nanos",
        "radpersec",
    ];
    let bare = units.iter().find_map(|unit| name.strip_suffix(unit));
    bare.unwrap_or(&name).to_owned()
}

fn number_at(fields: &[&[u8]], place: Option<usize>) -> Option<f64> {
    number::parse_finite(fields.get(place?)?)
}

#[cfg(test)]
mod tests;
