//! Meaning of columns by their names: the words that logs of this field use.

mod steps;

pub use steps::{FIX_STEP, IMU_STEP, ordinary_step, time_unit, time_unit_of};

use undrift_nav::units::{Quantity, unit_factor};

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
    /// Temperature of the sensor.
    Temperature,
}

impl Meaning {
    fn quantity(self) -> Option<Quantity> {
        Some(match self {
            Self::Time => Quantity::Time,
            Self::Gyro(_) => Quantity::AngularRate,
            Self::Accel(_) => Quantity::Acceleration,
            Self::Latitude | Self::Longitude | Self::Attitude(_) | Self::Course => Quantity::Angle,
            Self::Height | Self::PositionStd(_) | Self::Ecef(_) | Self::Accuracy(0 | 1) => {
                Quantity::Length
            }
            Self::Velocity(_)
            | Self::VelocityUp
            | Self::Speed
            | Self::Accuracy(_)
            | Self::VelocityStd(_)
            | Self::EcefVelocity(_) => Quantity::Velocity,
            Self::Temperature | Self::Date => return None,
        })
    }
}

/// Endings of names that are units.
const SUFFIXES: [(&str, &str); 48] = [
    ("_days", "d"),
    ("_dege7", "LSB/1e7 deg"),
    ("_deg_1e7", "LSB/1e7 deg"),
    ("_1e7", "LSB/1e7 deg"),
    ("_e7", "LSB/1e7 deg"),
    ("_mm_s", "mm/s"),
    ("_mmps", "mm/s"),
    ("_cm_s", "cm/s"),
    ("_km_h", "km/h"),
    ("_kmh", "km/h"),
    ("_kph", "km/h"),
    ("_mph", "mph"),
    ("_fps", "ft/s"),
    ("_ft_s", "ft/s"),
    ("_feet", "ft"),
    ("_ft", "ft"),
    ("_kts", "kn"),
    ("_knots", "kn"),
    ("_kn", "kn"),
    ("_mm", "mm"),
    ("_cm", "cm"),
    ("_radps", "rad/s"),
    ("_rad_s", "rad/s"),
    ("_degps", "deg/s"),
    ("_deg_s", "deg/s"),
    ("_dps", "deg/s"),
    ("_mps2", "m/s^2"),
    ("_m_s2", "m/s^2"),
    ("_mps", "m/s"),
    ("_m_s", "m/s"),
    ("_mg", "mg"),
    ("_g", "g"),
    ("_deg", "deg"),
    ("_rad", "rad"),
    ("_kelvin", "K"),
    ("_celsius", "degC"),
    ("_degc", "degC"),
    ("_c", "degC"),
    ("_sec", "s"),
    ("_msec", "ms"),
    ("_usec", "us"),
    ("_nsec", "ns"),
    ("_ms", "ms"),
    ("_us", "us"),
    ("_ns", "ns"),
    ("_s", "s"),
    ("_m", "m"),
    ("_hz", "Hz"),
];

const TIMES: [&str; 28] = [
    "datenum",
    RECEIVED,
    "t",
    "ts",
    "elapsed",
    "elapsedtime",
    "secondselapsed",
    "timesincestart",
    "timesinceboot",
    "uptime",
    "systime",
    "sampletimefine",
    "time",
    "timestamp",
    "timestamps",
    "stamp",
    "tow",
    "sow",
    "gpstime",
    "gpssow",
    "utc",
    "utctime",
    "datetime",
    "utcdatetime",
    "timeofday",
    "sec",
    "secs",
    "seconds",
];
/// The time at which a line came, which a serial monitor writes before it.
pub const RECEIVED: &str = "received";
/// Words that are a time and its unit, and endings of words for a time that are its unit.
const TIME_UNITS: [(&str, &str); 6] = [
    ("millis", "ms"),
    ("milliseconds", "ms"),
    ("micros", "us"),
    ("microseconds", "us"),
    ("nanos", "ns"),
    ("nanoseconds", "ns"),
];
const TIME_ENDINGS: [(&str, &str); 6] = [
    ("msec", "ms"),
    ("usec", "us"),
    ("nsec", "ns"),
    ("ms", "ms"),
    ("us", "us"),
    ("ns", "ns"),
];
const GYROS: [&str; 12] = [
    "g",
    "gyro",
    "gyr",
    "gyros",
    "gyroscope",
    "w",
    "omega",
    "wib",
    "angularvelocity",
    "angularrate",
    "angvel",
    "wrss",
];
const ACCELS: [&str; 13] = [
    "a",
    "acc",
    "accel",
    "accelerometer",
    "acceleration",
    "f",
    "fb",
    "specificforce",
    "linearacceleration",
    "linacc",
    "accl",
    "arss",
    "force",
];
const DATES: [&str; 3] = ["date", "utcdate", "day"];
const ECEFS: [&str; 3] = ["ecef", "ecefpos", "posecef"];
const ECEF_VELOCITIES: [&str; 4] = ["ecefv", "vecef", "ecefvel", "velecef"];
const LATITUDES: [&str; 2] = ["lat", "latitude"];
const LONGITUDES: [&str; 4] = ["lon", "long", "lng", "longitude"];
const HEIGHTS: [&str; 15] = [
    "hmsl",
    "heightmsl",
    "altmsl",
    "altitudemsl",
    "mslheight",
    "height",
    "alt",
    "altitude",
    "h",
    "hgt",
    "ele",
    "elevation",
    "ellipsoidheight",
    "ellipsoidalheight",
    "hell",
];
const VELOCITIES: [&str; 4] = ["v", "vel", "velocity", "vned"];
const SPEEDS: [&str; 7] = [
    "speed",
    "gspeed",
    "gpsspeed",
    "groundspeed",
    "speedoverground",
    "sog",
    "spd",
];
const COURSES: [&str; 7] = [
    "course",
    "cog",
    "courseoverground",
    "headmot",
    "headingofmotion",
    "track",
    "bearing",
];
/// Accuracies of the horizontal position, the height, the speed.
const ACCURACIES: [&[&str]; 3] = [
    &["hacc", "horizontalaccuracy", "accuracy"],
    &["vacc", "verticalaccuracy"],
    &["sacc", "speedaccuracy"],
];
const POSITION_STDS: [&str; 7] = [
    "std",
    "sd",
    "sigma",
    "s",
    "positionstd",
    "posstd",
    "accuracy",
];
const VELOCITY_STDS: [&str; 6] = ["vstd", "velstd", "velocitystd", "stdv", "sdv", "sigmav"];

/// Directions by their letters and words: north, east, down, up.
const DIRECTIONS: [(&str, usize); 8] = [
    ("north", 0),
    ("east", 1),
    ("down", 2),
    ("up", 3),
    ("n", 0),
    ("e", 1),
    ("d", 2),
    ("u", 3),
];

/// What the names of a table's columns mean beside each other, as [`meaning`] of each: where `omega` is the angular rate
/// and nothing else the specific force, `alpha` is that, as in the tables of Kalibr, in rad/s and m/s².
pub fn meanings(names: &[String]) -> Vec<Option<(Meaning, Option<String>)>> {
    let mut found: Vec<_> = names.iter().map(|name| meaning(name)).collect();
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

/// The letters and digits of a name, small.
fn letters(name: &str) -> String {
    let letters = name.chars().filter(char::is_ascii_alphanumeric);
    letters.map(|c| c.to_ascii_lowercase()).collect()
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
    let name = column.trim().to_ascii_lowercase();
    let (stem, unit) = split_unit(&name);
    if matches!(unit.as_deref(), Some("degC" | "K")) {
        return Some((Meaning::Temperature, unit));
    }
    let letters = letters(stem);
    if let Some(unit) = time_and_unit(&letters) {
        return Some((Meaning::Time, Some(unit.to_owned())));
    }
    let meaning = of_letters(&letters)?;
    let fits = |unit: &String| {
        meaning
            .quantity()
            .is_none_or(|quantity| unit_factor(unit, quantity).is_ok())
    };
    Some((meaning, unit.filter(fits)))
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
        let axis = "xyz".find(name.chars().last()?)?;
        stems.contains(&&name[..name.len() - 1]).then_some(axis)
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
    } else if let Some(of) = ACCURACIES.iter().position(|names| names.contains(&name)) {
        Some(Meaning::Accuracy(of))
    } else if SPEEDS.contains(&name) {
        Some(Meaning::Speed)
    } else if COURSES.contains(&name) {
        Some(Meaning::Course)
    } else if LATITUDES.contains(&name) {
        Some(Meaning::Latitude)
    } else if LONGITUDES.contains(&name) {
        Some(Meaning::Longitude)
    } else if HEIGHTS.contains(&name) {
        Some(Meaning::Height)
    } else if let Some(place) = direction(&VELOCITY_STDS).or_else(|| velocity_std(name)) {
        Some(Meaning::VelocityStd(place.min(2)))
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

/// A unit as [`undrift_nav::units`] spells it.
fn spelled(unit: &str) -> String {
    match unit {
        "dps" | "°/s" | "degrees/s" => "deg/s".into(),
        "rad s^-1" | "rad·s^-1" | "rps" => "rad/s".into(),
        "m s^-2" | "m/s2" | "m/s²" | "mps2" | "m/s/s" => "m/s^2".into(),
        "m s^-1" | "mps" => "m/s".into(),
        "°" | "degrees" => "deg".into(),
        "1e-7 deg" | "deg*1e7" | "1e7 deg" | "dege7" | "deg e7" | "deg*10^7" => {
            "LSB/1e7 deg".into()
        }
        "kmh" | "kph" | "km/hr" => "km/h".into(),
        "µs" | "usec" => "us".into(),
        "msec" | "milliseconds" => "ms".into(),
        "sec" | "seconds" => "s".into(),
        "day" | "days" => "d".into(),
        other => other.into(),
    }
}

#[cfg(test)]
mod tests;
