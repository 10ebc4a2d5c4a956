//! Meaning of columns by their names: the words that logs of this field use.

mod poses;
mod spelled;
mod steps;
mod words;

pub use poses::poses;
pub use steps::{FIX_STEP, IMU_STEP, ordinary_step, time_unit, time_unit_of};

/// Whether the ticks of a column of times have an unknown length: by its name they are those of a clock, and by their steps of
/// no usual unit. `longest` is as in [`time_unit`].
pub fn is_of_unknown_ticks(column: &str, stamps: &[f64], longest: f64) -> bool {
    steps::is_tick_clock(&letters(column)) && time_unit_of(column, stamps, longest).is_none()
}
pub use words::RECEIVED;

use undrift_nav::units::{Quantity, unit_factor};
use words::{
    ACCELS, ACCURACIES, ANTENNAS, CLIMBS, COURSES, DATES, DIRECTIONS, ECEF_VELOCITIES, ECEFS,
    FIELDS, GRID, GYROS, HEIGHTS, LATITUDES, LONGITUDES, POSITION_STDS, SPEEDS, SUFFIXES,
    TIME_ENDINGS, TIME_UNITS, TIMES, VELOCITIES, VELOCITY_STDS,
};

/// Meaning of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// Time of the record.
    Time,
    /// Angular rate about the sensor's x, y or z (0, 1, 2).
    Gyro(usize),
    /// Specific force along the sensor's x, y or z.
    Accel(usize),
    /// Latitude.
    Latitude,
    /// Longitude.
    Longitude,
    /// Height.
    Height,
    /// Easting, northing (0, 1) of a grid such as UTM.
    Grid(usize),
    /// Zone of the grid.
    Zone,
    /// Letter of the zone's band of latitudes.
    Band,
    /// Date of a time of day.
    Date,
    /// Earth-centred, Earth-fixed x, y or z (0, 1, 2) of the position.
    Ecef(usize),
    /// Earth-centred, Earth-fixed x, y or z (0, 1, 2) of the velocity.
    EcefVelocity(usize),
    /// Velocity north, east, down (0, 1, 2).
    Velocity(usize),
    /// Velocity upwards.
    VelocityUp,
    /// Speed over ground.
    Speed,
    /// Course over ground.
    Course,
    /// Stated accuracy of the horizontal position, the height, the speed (0, 1, 2).
    Accuracy(usize),
    /// Standard deviation of the position north, east, down.
    PositionStd(usize),
    /// Standard deviation of the velocity north, east, down.
    VelocityStd(usize),
    /// Roll, pitch, yaw (0, 1, 2).
    Attitude(usize),
    /// Heading by two antennas.
    AntennaHeading,
    /// Magnetic field along the sensor's x, y or z.
    Field(usize),
    /// Temperature of the sensor.
    Temperature,
}

impl Meaning {
    /// Whether it can be in a unit.
    fn can_be_in(self, unit: &str) -> bool {
        self.quantity()
            .is_none_or(|quantity| unit_factor(unit, quantity).is_ok())
    }

    fn quantity(self) -> Option<Quantity> {
        Some(match self {
            Self::Time => Quantity::Time,
            Self::Gyro(_) => Quantity::AngularRate,
            Self::Accel(_) => Quantity::Acceleration,
            Self::Field(_) => Quantity::MagneticField,
            Self::Latitude
            | Self::Longitude
            | Self::Attitude(_)
            | Self::AntennaHeading
            | Self::Course => Quantity::Angle,
            Self::Height
            | Self::Grid(_)
            | Self::PositionStd(_)
            | Self::Ecef(_)
            | Self::Accuracy(0 | 1) => Quantity::Length,
            Self::Velocity(_)
            | Self::VelocityUp
            | Self::Speed
            | Self::Accuracy(_)
            | Self::VelocityStd(_)
            | Self::EcefVelocity(_) => Quantity::Velocity,
            Self::Temperature | Self::Date | Self::Zone | Self::Band => return None,
        })
    }
}

/// What the names of a table's columns mean beside each other, as [`meaning`] of each: where `omega` is the angular rate
/// and nothing else the specific force, `alpha` is that, as in the tables of Kalibr, in rad/s and m/s².
pub fn meanings(names: &[String]) -> Vec<Option<(Meaning, Option<String>)>> {
    let mut found: Vec<_> = names.iter().map(|name| meaning(name)).collect();
    // What is part of a time in several columns is not a time of its own.
    for part in names
        .iter()
        .flat_map(|name| name.split(" + ").skip(usize::from(!name.contains(" + "))))
    {
        for (meaning, name) in found.iter_mut().zip(names) {
            if name.trim() == part {
                *meaning = None;
            }
        }
    }
    let letters: Vec<String> = names.iter().map(|name| letters(name)).collect();
    let there = |name: &str, axis: char| letters.contains(&format!("{name}{axis}"));
    let accel = |of: &Option<(Meaning, _)>| matches!(of, Some((Meaning::Accel(_), _)));
    let all = "xyz"
        .chars()
        .all(|axis| there("omega", axis) && there("alpha", axis));
    if !all || found.iter().any(accel) {
        return found;
    }
    for (meaning, name) in found.iter_mut().zip(&letters) {
        let axis = name.chars().last().and_then(|axis| "xyz".find(axis));
        let Some(axis) = axis else { continue };
        match &name[..name.len() - 1] {
            "omega" => *meaning = Some((Meaning::Gyro(axis), Some("rad/s".into()))),
            "alpha" => *meaning = Some((Meaning::Accel(axis), Some("m/s^2".into()))),
            _ => {}
        }
    }
    found
}

/// The letters and digits of a name, small and without accents.
fn letters(name: &str) -> String {
    let plain = |c: char| match c.to_lowercase().next().unwrap_or(c) {
        'á' | 'à' | 'â' | 'ä' | 'ã' => 'a',
        'é' | 'è' | 'ê' | 'ë' => 'e',
        'í' | 'ì' | 'î' | 'ï' => 'i',
        'ó' | 'ò' | 'ô' | 'ö' | 'õ' => 'o',
        'ú' | 'ù' | 'û' | 'ü' => 'u',
        'ñ' => 'n',
        'ç' => 'c',
        other => other,
    };
    let letters = name.chars().map(plain);
    letters.filter(char::is_ascii_alphanumeric).collect()
}

/// What a column's name means, and the unit that it states in brackets or by its ending; `None` of a name that is not known.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::columns::{Meaning, meaning};
/// assert_eq!(meaning("gx_dps"), Some((Meaning::Gyro(0), Some("deg/s".into()))));
/// assert_eq!(meaning("AZ_g"), Some((Meaning::Accel(2), Some("g".into()))));
/// assert_eq!(meaning("gyro_y"), Some((Meaning::Gyro(1), None)));
/// ```
pub fn meaning(column: &str) -> Option<(Meaning, Option<String>)> {
    let name = spelled::plain(column);
    // Times in several columns, as the reader of tables names their sum.
    if name.contains(" + ") {
        return Some((Meaning::Time, None));
    }
    let known = |name: &str| {
        // What an autopilot calls its attitude has its own solution beside the samples.
        let is_sample = |(meaning, _): &(Meaning, _)| {
            !name.contains("atti:")
                || matches!(
                    meaning,
                    Meaning::Gyro(_) | Meaning::Accel(_) | Meaning::Field(_)
                )
        };
        let inner = || of_name(name).or_else(|| of_name(without_source(name)?).filter(is_sample));
        inner().or_else(|| of_receiver(name))
    };
    // `gyro[0]`, and with a unit before the index `gyro_rad[0]`.
    let axis = ["[0]", "[1]", "[2]"].iter().zip(["x", "y", "z"]);
    let mut indexed = axis.filter_map(|(index, axis)| Some((name.strip_suffix(index)?, axis)));
    let Some((stem, axis)) = indexed.next() else {
        return known(&name);
    };
    known(&format!("{stem}{axis}")).or_else(|| {
        let (stem, unit) = split_unit(stem);
        let (meaning, _) = known(&format!("{stem}{axis}"))?;
        Some((meaning, unit.filter(|unit| meaning.can_be_in(unit))))
    })
}

/// A name behind a word for the receiver, `locationLatitude` or `gps_alt`, where it is of what one has.
fn of_receiver(name: &str) -> Option<(Meaning, Option<String>)> {
    let rest = ["location", "gps", "gnss"]
        .iter()
        .find_map(|word| name.strip_prefix(word))?;
    let rest = rest.trim_start_matches(['_', ' ', '-']);
    // A letter behind it may be anything.
    let found = (letters(rest).len() > 2).then(|| of_name(rest))??;
    use Meaning as M;
    let of_fixes = matches!(
        found.0,
        M::Latitude | M::Longitude | M::Height | M::Speed | M::Course | M::Accuracy(_)
    );
    of_fixes.then_some(found)
}

/// Words before the name of a value that say where it is from.
const SOURCES: [&str; 17] = [
    "atti", "clock", "fix", "mavros", "field", "header", "imu", "raw", "scaled", "data", "msg",
    "message", "gps", "gnss", "navsat", "inertial", "sensor",
];

/// A name behind the last point, colon or stroke, where what is before it are words for a source.
fn without_source(name: &str) -> Option<&str> {
    // A unit behind it may have a stroke.
    let end = name.find(['[', '(']).unwrap_or(name.len());
    let stem = name.get(..end)?.trim_end();
    let at = stem.rfind(['.', ':', '/'])?;
    let (before, value) = (stem.get(..at)?, stem.get(at + 1..)?);
    let axis = matches!(value, "x" | "y" | "z");
    let cut = match axis {
        true => before.rfind(['.', ':', '/'])?,
        false => at,
    };
    let mut words = name.get(..cut)?.split(['.', ':', '/', '_', '-']);
    let known = |word: &str| {
        let digits = word.bytes().all(|byte| byte.is_ascii_digit());
        digits || SOURCES.iter().any(|source| word.starts_with(source))
    };
    // Whatever a topic is called, `/gps/fix/latitude`, or a file of a sensor, `GX01_GYRO.Gyroscope z`.
    let of_sensor = |word: &str| word.contains("gyr") || word.contains("acc");
    let is_source = name.starts_with('/') || words.clone().all(known) || words.any(of_sensor);
    (is_source && letters(name.get(cut + 1..)?).len() > 1).then(|| name.get(cut + 1..))?
}

fn of_name(name: &str) -> Option<(Meaning, Option<String>)> {
    let (stem, unit) = split_unit(name);
    if matches!(unit.as_deref(), Some("degC" | "K")) {
        return Some((Meaning::Temperature, unit));
    }
    let letters = letters(stem);
    if let Some(unit) = time_and_unit(&letters) {
        return Some((Meaning::Time, Some(unit.to_owned())));
    }
    let meaning = of_letters(&letters).or_else(|| of_axis(&letters, unit.as_deref()?))?;
    let unit = unit.filter(|unit| meaning.can_be_in(unit));
    // Blackbox logs of Betaflight and INAV have whole degrees per second.
    let of_blackbox = letters.starts_with("gyroadc").then(|| "deg/s".to_owned());
    Some((meaning, unit.or(of_blackbox)))
}

/// Whether a name states the unit of something that no inertial sensor measures, such as `Pitch (deg)`.
pub(crate) fn is_of_another_quantity(name: &str) -> bool {
    let name = spelled::plain(name);
    let (_, Some(unit)) = split_unit(&name) else {
        return false;
    };
    let is = |quantity| unit_factor(&unit, quantity).is_ok();
    name.contains(['[', '('])
        && !is(Quantity::AngularRate)
        && !is(Quantity::Acceleration)
        && (is(Quantity::Angle) || is(Quantity::Length) || is(Quantity::Velocity))
}

/// An axis alone with a unit that only one sensor has: `x-axis (deg/s)`.
fn of_axis(letters: &str, unit: &str) -> Option<Meaning> {
    let axis = letters.strip_suffix("axis").unwrap_or(letters);
    let axis = ["x", "y", "z"].iter().position(|name| *name == axis)?;
    let is = |quantity| unit_factor(unit, quantity).is_ok();
    if is(Quantity::AngularRate) {
        Some(Meaning::Gyro(axis))
    } else {
        is(Quantity::Acceleration).then_some(Meaning::Accel(axis))
    }
}

/// The unit in a word that is a time and its unit: `millis`, `timestampus`.
fn time_and_unit(letters: &str) -> Option<&'static str> {
    let word = TIME_UNITS.iter().find(|(word, _)| *word == letters);
    let ending = || {
        TIME_ENDINGS.iter().find(|(ending, _)| {
            let time = letters.strip_suffix(ending);
            time.is_some_and(|time| time.len() > 1 && TIMES.contains(&time))
        })
    };
    word.or_else(ending).map(|(_, unit)| *unit)
}

fn of_letters(name: &str) -> Option<Meaning> {
    let axis = |stems: &[&str]| -> Option<usize> {
        let behind = "xyz".chars().position(|axis| {
            let stem = name.strip_suffix(axis);
            stem.is_some_and(|stem| stems.contains(&stem))
        });
        // `xgyro`, but a single letter behind that of an axis is something else.
        behind.or_else(|| {
            "xyz".chars().position(|axis| {
                let stem = name.strip_prefix(axis);
                stem.is_some_and(|stem| stem.len() > 2 && stems.contains(&stem))
            })
        })
    };
    let direction = |stems: &[&str]| -> Option<usize> {
        DIRECTIONS.iter().find_map(|(word, index)| {
            let before = name.strip_suffix(word);
            let after = name.strip_prefix(word);
            let known = |rest: Option<&str>| rest.is_some_and(|rest| stems.contains(&rest));
            (known(before) || known(after)).then_some(*index)
        })
    };
    if TIMES.contains(&name) {
        Some(Meaning::Time)
    } else if DATES.contains(&name) {
        Some(Meaning::Date)
    } else if let Some(meaning) = ecef(name) {
        Some(meaning)
    } else if let Some(axis) = axis(&GYROS).or("pqr".find(name).filter(|_| name.len() == 1)) {
        Some(Meaning::Gyro(axis))
    } else if let Some(axis) = axis(&ACCELS) {
        Some(Meaning::Accel(axis))
    } else if let Some(axis) = axis(&FIELDS) {
        Some(Meaning::Field(axis))
    } else if let Some(of) = ACCURACIES.iter().position(|names| names.contains(&name)) {
        Some(Meaning::Accuracy(of))
    } else if SPEEDS.contains(&name) {
        Some(Meaning::Speed)
    } else if ANTENNAS.contains(&name) {
        Some(Meaning::AntennaHeading)
    } else if COURSES.contains(&name) {
        Some(Meaning::Course)
    } else if LATITUDES.contains(&name) {
        Some(Meaning::Latitude)
    } else if LONGITUDES.contains(&name) {
        Some(Meaning::Longitude)
    } else if HEIGHTS.contains(&name) {
        Some(Meaning::Height)
    } else if let Some(axis) = GRID.iter().position(|names| names.contains(&name)) {
        Some(Meaning::Grid(axis))
    } else if let Some(place) = direction(&VELOCITY_STDS).or_else(|| velocity_std(name)) {
        Some(Meaning::VelocityStd(place.min(2)))
    } else if CLIMBS.contains(&name) {
        Some(Meaning::VelocityUp)
    } else if let Some(place) = direction(&VELOCITIES) {
        Some(match place {
            3 => Meaning::VelocityUp,
            ned => Meaning::Velocity(ned),
        })
    } else if let Some(place) = direction(&POSITION_STDS) {
        Some(Meaning::PositionStd(place.min(2)))
    } else {
        match name {
            "roll" => Some(Meaning::Attitude(0)),
            "pitch" => Some(Meaning::Attitude(1)),
            "yaw" | "heading" | "azimuth" => Some(Meaning::Attitude(2)),
            "zone" | "utmzone" | "zonenumber" | "utmzonenumber" => Some(Meaning::Zone),
            "zoneletter" | "utmzoneletter" | "utmletter" | "band" => Some(Meaning::Band),
            "temp" | "temperature" | "board" | "imutemp" => Some(Meaning::Temperature),
            _ => None,
        }
    }
}

/// `ecef_x`, `x-ecef`, `vx_ecef`, `ecefVX`.
fn ecef(name: &str) -> Option<Meaning> {
    name.contains("ecef").then_some(())?;
    let known = |stems: &[&str]| {
        let without = |axis: char| name.replacen(axis, "", 1);
        let is = |(_, axis): &(usize, char)| {
            name.contains(*axis) && stems.contains(&without(*axis).as_str())
        };
        "xyz".chars().enumerate().find(is).map(|(place, _)| place)
    };
    let velocity = known(&ECEF_VELOCITIES).map(Meaning::EcefVelocity);
    velocity.or_else(|| known(&ECEFS).map(Meaning::Ecef))
}

/// `vnstd`, `stdve`, `sdvn`, `svn`.
fn velocity_std(name: &str) -> Option<usize> {
    let rest = ["std", "sd", "sigma"]
        .iter()
        .find_map(|word| name.strip_suffix(word).or_else(|| name.strip_prefix(word)))
        .or_else(|| name.strip_prefix('s'))?;
    let rest = rest
        .strip_prefix("vel")
        .or_else(|| rest.strip_prefix('v'))?;
    DIRECTIONS
        .iter()
        .find_map(|(word, index)| (rest == *word).then_some(*index))
}

/// `gx [deg/s]`, `gx(dps)` and `gx_dps` without and with their unit.
fn split_unit(name: &str) -> (&str, Option<String>) {
    if let Some((stem, rest)) = name.split_once(['[', '(', '{']) {
        let unit = rest.trim_end_matches([']', ')', '}']).trim();
        return match stem.trim().rsplit_once(" in ") {
            Some((stem, unit)) => (stem, Some(spelled(unit))),
            None => (stem.trim(), Some(spelled(unit))),
        };
    }
    if let Some((stem, unit)) = name.rsplit_once(" in ") {
        return (stem, Some(spelled(unit)));
    }
    let found = SUFFIXES
        .iter()
        .find_map(|(suffix, unit)| Some((name.strip_suffix(suffix)?, *unit)));
    match found {
        Some((stem, unit)) if !stem.is_empty() => (stem, Some(unit.to_owned())),
        _ => (name, None),
    }
}

/// Angles of which half a turn is 2^31, as in Garmin's FIT.
pub const SEMICIRCLES: &str = "LSB/11930464.7111 deg";

/// A unit as [`undrift_nav::units`] spells it.
fn spelled(unit: &str) -> String {
    match unit {
        "dps" | "°/s" | "degrees/s" => "deg/s".into(),
        "rad s^-1" | "rad·s^-1" | "rps" => "rad/s".into(),
        "m s^-2" | "m/s2" | "m/s²" | "mps2" | "m/s/s" => "m/s^2".into(),
        "m s^-1" | "mps" => "m/s".into(),
        "°" | "º" | "degrees" => "deg".into(),
        "1e-7 deg" | "deg*1e7" | "1e7 deg" | "dege7" | "deg e7" | "deg*10^7" => {
            "LSB/1e7 deg".into()
        }
        "semicircles" | "semicircle" => SEMICIRCLES.into(),
        "kmh" | "kph" | "km/hr" => "km/h".into(),
        "µs" | "usec" => "us".into(),
        "msec" | "millisecond" | "milliseconds" => "ms".into(),
        "microsecond" | "microseconds" => "us".into(),
        "nanosecond" | "nanoseconds" => "ns".into(),
        "sec" | "seconds" => "s".into(),
        "day" | "days" => "d".into(),
        other => other.into(),
    }
}

#[cfg(test)]
mod tests;
