//! Text that NovAtel's Inertial Explorer and GrafNav export: some lines on the project, a line of names, one of
//! units in brackets, then rows; as reference.
//!
//! Names and units are those of the usual profiles: `GPSTime` or `UTCTime` as seconds or h:m:s, `Week`, `Date`,
//! `Latitude`, `Longitude`, `H-Ell`, `VEast`, `VNorth`, `VUp`, `Heading`, `Pitch`, `Roll`. UTC becomes GPS time
//! where there is a week or a date. Angles in degrees, minutes and seconds are refused: a profile with decimal degrees is
//! what to export.

use undrift_nav::Vector3;
use undrift_nav::earth::Geodetic;
use undrift_nav::sample::TruthSample;

use super::receiver::{Ready, by_lines, check, one_stream};
use crate::ReadError;
use crate::entry::{Entries, Stream, StreamKind, Wanted, What};
use crate::epoch::ClockSource;
use crate::fix::on_earth;
use crate::number;
use crate::skipped::{SkipKind, shown};
use crate::source::Source;
use crate::table::lines::Lines;
use crate::time::{self, WeekClock};

const STREAM: &str = "solution";
/// Lines before the names.
const HEAD: usize = 200;

/// Columns that are read, by their names.
const NAMES: [&[&str]; 12] = [
    &["GPSTime", "UTCTime"],
    &["Week", "GPSWeek"],
    &["Date", "GPSDate", "UTCDate"],
    &["Latitude"],
    &["Longitude"],
    &["H-Ell", "HEll", "EllHeight"],
    &["VNorth"],
    &["VEast"],
    &["VUp"],
    &["Roll"],
    &["Pitch"],
    &["Heading"],
];
const TIME: usize = 0;
const WEEK: usize = 1;
const DATE: usize = 2;
const LATITUDE: usize = 3;
const VELOCITY: usize = 6;
const ATTITUDE: usize = 9;

/// Whether a text has such a line of names.
pub(crate) fn detect(start: &[u8]) -> bool {
    let lines = start.split(|&byte| byte == b'\n').take(HEAD);
    // All names have a capital letter; rows of numbers are passed over quickly.
    let mut named = lines.filter(|line| line.iter().any(u8::is_ascii_uppercase));
    named.any(|line| Columns::from_names(line).is_some())
}

/// Where the columns are.
struct Columns {
    comma: bool,
    places: [Option<usize>; 12],
    utc: bool,
}

impl Columns {
    /// Of a line of names, if it is one: with a place and a height, or an attitude, as such exports call them.
    fn from_names(line: &[u8]) -> Option<Self> {
        let comma = line.contains(&b',');
        let names: Vec<&[u8]> = fields(line, comma).collect();
        let place = |known: &&[&str]| {
            let is = |name: &&[u8]| known.iter().any(|known| known.as_bytes() == *name);
            names.iter().position(is)
        };
        let places = NAMES.each_ref().map(place);
        let has = |from: usize| places.iter().skip(from).take(3).all(Option::is_some);
        let utc = places[TIME].and_then(|k| names.get(k)) == Some(&b"UTCTime".as_slice());
        // A table of one's own may have such names, but hardly H-Ell.
        let own = names.contains(&b"H-Ell".as_slice()) || has(VELOCITY);
        (places[TIME].is_some() && has(LATITUDE) && own).then_some(Self { comma, places, utc })
    }
}

fn fields(line: &[u8], comma: bool) -> impl Iterator<Item = &[u8]> {
    let ends = move |byte: &u8| {
        if comma {
            *byte == b','
        } else {
            byte.is_ascii_whitespace()
        }
    };
    let parts = line.split(ends).map(<[u8]>::trim_ascii);
    parts.filter(move |part| comma || !part.is_empty())
}

pub(super) fn entries(source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    check(
        wanted,
        "an export of Inertial Explorer",
        [&[], &[STREAM], &[]],
    )?;
    if !matches!(wanted, Wanted::Poses(_)) {
        let problem = "an export of Inertial Explorer is a solution, not a log of fixes";
        return Err(ReadError::nameless(problem).mend("use it in [truth]"));
    }
    let reader = Reader {
        columns: None,
        weeks: WeekClock::default(),
    };
    Ok(by_lines(
        wanted,
        Lines::new(source),
        Some("no line of such an export".to_owned()),
        reader,
        Reader::line,
        |_, _| Ok(()),
        |reader| reader.weeks.epoch(ClockSource::Gnss),
    ))
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    let mut messages = 0;
    for entry in entries(source, &Wanted::Poses(None))? {
        messages += u64::from(matches!(entry?.what, What::Pose(_)));
    }
    let about = "position, and velocity and attitude where exported";
    Ok(one_stream(STREAM, StreamKind::Poses, about, messages))
}

struct Reader {
    columns: Option<Columns>,
    weeks: WeekClock,
}

impl Reader {
    fn line(&mut self, at: u64, line: &[u8], ready: &mut Ready) -> Result<(), ReadError> {
        let Some(columns) = &self.columns else {
            self.columns = Columns::from_names(line);
            return Ok(());
        };
        let trimmed = line.trim_ascii();
        if trimmed.starts_with(b"(") {
            return units(trimmed).map_err(|error| error.at(at));
        }
        if trimmed.is_empty() {
            return Ok(());
        }
        let parts: Vec<&[u8]> = fields(trimmed, columns.comma).collect();
        match pose(columns, &parts, &mut self.weeks) {
            Ok(pose) => {
                if ready.usable(at, on_earth(pose.position)).is_some() {
                    ready.push(at, What::Pose(pose));
                }
            }
            Err(kind) => ready.skip(at, kind, shown(trimmed)),
        }
        Ok(())
    }
}

/// Refuses units that are not read.
fn units(line: &[u8]) -> Result<(), ReadError> {
    let text = String::from_utf8_lossy(line).to_lowercase();
    for unit in ["d m s", "dms", "ddd mm", "ft", "rad", "kn", "km"] {
        let found = text.split(['(', ')']).any(|part| {
            let part = part.trim().trim_start_matches("+/-").trim();
            part == unit || part.starts_with(&format!("{unit} "))
        });
        if found {
            let problem = format!("a column in \"{unit}\"");
            let mend =
                "export latitude and longitude in decimal degrees, lengths in m, velocities in m/s";
            return Err(ReadError::nameless(problem).mend(mend));
        }
    }
    Ok(())
}

fn pose(
    columns: &Columns,
    parts: &[&[u8]],
    weeks: &mut WeekClock,
) -> Result<TruthSample, SkipKind> {
    let part = |which: usize| -> Result<Option<&[u8]>, SkipKind> {
        let place = columns.places.get(which).copied().flatten();
        place
            .map(|place| parts.get(place).copied().ok_or(SkipKind::MissingField))
            .transpose()
    };
    let number = |which: usize| -> Result<Option<f64>, SkipKind> {
        let read = |field| {
            number::parse(field)
                .filter(|value| value.is_finite())
                .ok_or(SkipKind::Text)
        };
        part(which)?.map(read).transpose()
    };
    let three = |from: usize| -> Result<Option<Vector3>, SkipKind> {
        let [x, y, z] = [number(from)?, number(from + 1)?, number(from + 2)?];
        Ok(x.zip(y).zip(z).map(|((x, y), z)| Vector3::new(x, y, z)))
    };
    let field = part(TIME)?.ok_or(SkipKind::MissingField)?;
    let seconds = number::parse(field)
        .or_else(|| time::time_of_day(field))
        .ok_or(SkipKind::Text)?;
    let day = match (number(WEEK)?, part(DATE)?) {
        (_, Some(date)) => Some(date_of(date).ok_or(SkipKind::Text)?),
        (Some(week), None) if (0.0..10_000.0).contains(&week) => Some(week as i64 * 7),
        (Some(_), None) => return Err(SkipKind::OutOfRange),
        (None, None) => None,
    };
    let time = match day {
        // With a date, seconds beyond a day are those of the week that it is in.
        Some(day) if seconds >= 86_400.0 && columns.utc => {
            weeks.utc_day(day.div_euclid(7) * 7, seconds)
        }
        Some(day) if seconds >= 86_400.0 => weeks.gps(day.div_euclid(7) * 7, seconds),
        Some(day) if columns.utc => weeks.utc_day(day, seconds),
        Some(day) => weeks.gps(day, seconds),
        None => seconds,
    };
    let place = three(LATITUDE)?.ok_or(SkipKind::MissingField)?;
    let velocity = three(VELOCITY)?;
    Ok(TruthSample {
        time,
        position: Geodetic::from_degrees(place.x, place.y, place.z),
        v_n: velocity.map(|v| Vector3::new(v.x, v.y, -v.z)),
        rpy: three(ATTITUDE)?.map(|rpy| rpy.map(f64::to_radians)),
    })
}

/// Days from the GPS epoch to `yyyy/mm/dd`, `yyyy-mm-dd` or `mm/dd/yyyy`.
fn date_of(field: &[u8]) -> Option<i64> {
    let stroke = *field.iter().find(|byte| matches!(byte, b'/' | b'-'))?;
    time::date(field, stroke).or_else(|| {
        let (month_day, year) = field.split_at_checked(field.len().checked_sub(4)?)?;
        let month_day = month_day.strip_suffix(&[stroke])?;
        time::date(&[year, &[stroke], month_day].concat(), stroke)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::receiver::testing::{all, golden, source_of, table, try_all};

    fn poses(bytes: &[u8]) -> Vec<TruthSample> {
        let (found, _) = all(entries, bytes, &Wanted::Poses(None));
        let pose = |what: What| match what {
            What::Pose(pose) => pose,
            other => panic!("{other:?}"),
        };
        found.into_iter().map(|entry| pose(entry.what)).collect()
    }

    #[test]
    fn exports_are_references() {
        for name in ["week.txt", "date.txt", "commas.csv"] {
            let bytes = golden(&format!("explorer/{name}"));
            assert_eq!(
                crate::log::detect(&bytes),
                Some(crate::format::Format::Explorer),
                "{name}"
            );
            let (found, expected) = (poses(&bytes), table("explorer/expected.csv"));
            assert_eq!(found.len(), expected.len(), "{name}");
            for (pose, row) in found.iter().zip(&expected) {
                let get = |name: &str| row[name].unwrap();
                let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
                assert!(
                    near(pose.time, get("t_s")),
                    "{name} {} {}",
                    pose.time,
                    get("t_s")
                );
                assert!(near(pose.position.lat.to_degrees(), get("lat_deg")));
                assert!(near(pose.position.lon.to_degrees(), get("lon_deg")));
                assert!(near(pose.position.height, get("height_m")));
                let velocity = Vector3::new(get("vn"), get("ve"), -get("vu"));
                assert!((pose.v_n.unwrap() - velocity).amax() < 1e-12);
                let rpy = Vector3::from(["roll_deg", "pitch_deg", "yaw_deg"].map(get));
                assert!((pose.rpy.unwrap().map(f64::to_degrees) - rpy).amax() < 1e-9);
            }
        }
    }

    #[test]
    fn damage_of_any_kind() {
        let bytes = golden("explorer/week.txt");
        let whole = poses(&bytes);
        let text = String::from_utf8(bytes.clone()).unwrap();
        let start = text.find("345").unwrap_or(0);
        for k in start..bytes.len() {
            let mut flipped = bytes.clone();
            flipped[k] ^= 1 << (k % 8);
            let (found, _, _) = try_all(entries, source_of(&flipped), &Wanted::Poses(None));
            assert!(found.len() + 2 >= whole.len(), "byte {k}");
            let (cut, _, _) = try_all(entries, source_of(&bytes[..k]), &Wanted::Poses(None));
            assert!(cut.len() <= whole.len());
        }
        let sexagesimal = text.replacen("(deg)", "(+/-D M S)", 1);
        let (_, _, error) = try_all(
            entries,
            source_of(sexagesimal.as_bytes()),
            &Wanted::Poses(None),
        );
        assert!(error.unwrap().to_string().contains("decimal degrees"));
        for other in [
            &b"time,lat,lon,height\n1,2,3,4\n"[..],
            b"",
            b"GPSTime Latitude Longitude Height\n",
        ] {
            assert!(!detect(other));
        }
    }
}
