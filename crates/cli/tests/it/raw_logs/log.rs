//! Drives as samples and fixes, read with drive files written by hand.

use std::{fs, path::Path};
use undrift::{
    Drive,
    nav::{Matrix3, Vector3, attitude::from_rpy, sample::Position},
};

/// GPS week that encoders with absolute times place drives in; it begins on 6 July 2025.
pub const WEEK: u32 = 2374;
/// Time of that week at which a drive's own clock is zero \[s\]: all of them end before the week does.
pub const START: f64 = 200_000.0;
/// Of GPS time less UTC in that week \[s\].
pub const LEAP: f64 = 18.0;
/// Unix time at the beginning of that week \[s\].
pub const UNIX: f64 = 315_964_800.0 + 604_800.0 * WEEK as f64 - LEAP;

/// A record of an IMU, in its own axes.
pub struct Sample {
    /// \[s\]
    pub time: f64,
    /// What it is the mean of \[s\].
    pub dt: f64,
    /// Angular rate [rad/s].
    pub gyro: Vector3,
    /// Specific force [m/s²].
    pub accel: Vector3,
}

pub struct Fix {
    /// \[s\]
    pub time: f64,
    /// Latitude and longitude \[deg\], height \[m\].
    pub place: [f64; 3],
    /// North, east, down [m/s].
    pub velocity: Option<Vector3>,
    /// Standard deviations, north, east, down \[m\], [m/s].
    pub std: [Vector3; 2],
}

impl Fix {
    /// Speed [m/s] and course \[deg\], 0 to 360.
    pub fn course(&self) -> Option<(f64, f64)> {
        let velocity = self.velocity?;
        let course = velocity.y.atan2(velocity.x).to_degrees().rem_euclid(360.0);
        Some((velocity.x.hypot(velocity.y), course))
    }
}

pub struct Log {
    pub samples: Vec<Sample>,
    pub fixes: Vec<Fix>,
}

/// What a recorder writes next.
pub enum Event<'a> {
    Sample(&'a Sample),
    Fix(&'a Fix),
}

impl Log {
    /// What a drive file reads, in the sensor's own axes and without the mounting.
    pub fn read(text: &str, data: &Path) -> Self {
        let mut table: toml::Table = text.parse().unwrap();
        table.entry("model").or_insert("mpu6050".into());
        let imu = table["imu"].as_table_mut().unwrap();
        imu.remove("axes");
        imu.remove("mounting");
        let drive = Drive::from_toml(&table.to_string(), "drive.toml", data, data).unwrap();
        let samples = drive.open_imu().unwrap().map(|sample| {
            let sample = sample.unwrap();
            Sample {
                time: sample.time,
                dt: sample.dt,
                gyro: sample.dtheta / sample.dt,
                accel: sample.dvel / sample.dt,
            }
        });
        let fixes = drive.open_gnss().unwrap().map(|fix| {
            let fix = fix.unwrap();
            let Some((Position::Geodetic(place), covariance)) = fix.position else {
                panic!("a fix without a position at {} s", fix.time);
            };
            let std = |covariance: &Matrix3| covariance.diagonal().map(f64::sqrt);
            Fix {
                time: fix.time,
                place: [place.lat.to_degrees(), place.lon.to_degrees(), place.height],
                velocity: fix.velocity.map(|(velocity, _)| velocity),
                std: [
                    std(&covariance),
                    fix.velocity.map_or(Vector3::zeros(), |(_, of)| std(&of)),
                ],
            }
        });
        Self {
            samples: samples.collect(),
            fixes: fixes.collect(),
        }
    }

    /// The same of a sensor that is turned.
    pub fn turned(&self, turn: &Matrix3) -> Vec<Sample> {
        let turned = |sample: &Sample| Sample {
            time: sample.time,
            dt: sample.dt,
            gyro: turn * sample.gyro,
            accel: turn * sample.accel,
        };
        self.samples.iter().map(turned).collect()
    }

    /// Samples and fixes in the order of their times.
    pub fn in_order(&self) -> impl Iterator<Item = Event<'_>> {
        let mut samples = self.samples.iter().peekable();
        let mut fixes = self.fixes.iter().peekable();
        std::iter::from_fn(move || {
            let next_fix = fixes.peek().map_or(f64::INFINITY, |fix| fix.time);
            match samples.next_if(|sample| sample.time <= next_fix) {
                Some(sample) => Some(Event::Sample(sample)),
                None => fixes.next().map(Event::Fix),
            }
        })
    }
}

/// Day of July 2025, hour, minute and second of UTC.
pub fn utc(time: f64) -> (u32, u32, u32, f64) {
    // To the tenth of a millisecond, so that no second is written as 60.
    let tenths = ((time + START - LEAP) * 1e4).round() as u64;
    let (minutes, rest) = (tenths / 600_000, tenths % 600_000);
    let (hours, minute) = (minutes / 60, minutes % 60);
    (
        6 + (hours / 24) as u32,
        (hours % 24) as u32,
        minute as u32,
        rest as f64 / 1e4,
    )
}

/// Milliseconds of the GPS week.
pub fn week_ms(time: f64) -> u32 {
    ((time + START) * 1e3).round() as u32
}

/// The mounting in a drive file written by hand, if it is not estimated.
pub fn mounting(text: &str) -> Option<Matrix3> {
    let table: toml::Table = text.parse().unwrap();
    rotation(table["imu"].get("mounting")?.as_str()?)
}

/// The rotation that a value of `mounting` or `axes` gives.
pub fn rotation(value: &str) -> Option<Matrix3> {
    let parts: Vec<&str> = value.trim_end_matches(" deg").split(',').collect();
    if let Ok(angles) = parts
        .iter()
        .map(|angle| angle.trim().parse::<f64>())
        .collect::<Result<Vec<_>, _>>()
    {
        let rpy = Vector3::from_row_slice(&angles).map(f64::to_radians);
        return Some(from_rpy(&rpy).to_rotation_matrix().into_inner());
    }
    let row = |axis: &&str| {
        let (sign, letter) = match axis.strip_prefix('-') {
            Some(letter) => (-1.0, letter),
            None => (1.0, *axis),
        };
        let at = "xyz".find(letter)?;
        Some(Vector3::ith(at, sign).transpose())
    };
    let rows = parts.iter().map(row).collect::<Option<Vec<_>>>()?;
    (rows.len() == 3).then(|| Matrix3::from_rows(&rows))
}

/// A file's text.
pub fn text(file: &Path) -> String {
    fs::read_to_string(file).unwrap()
}
