//! The topics that are read, as PX4's message definitions have them over the years.

use undrift_nav::Vector3;
use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position, TruthSample};

use super::layout::{Layout, Place};
use crate::entry::{Fix, ImuReading, StreamKind, What};
use crate::fix::{independent, is_a_fix};
use crate::skipped::SkipKind;

/// What an accelerometer's relative time is when it gave nothing (2³¹ − 1).
const NO_SAMPLE: f64 = i32::MAX as f64;
/// Microseconds in a second.
const MICROS: f64 = 1e6;

/// Topics by what they hold, the preferred one of each kind first.
const TOPICS: [(&str, StreamKind); 6] = [
    ("vehicle_imu", StreamKind::Imu),
    ("sensor_combined", StreamKind::Imu),
    ("vehicle_gps_position", StreamKind::Fixes),
    ("sensor_gps", StreamKind::Fixes),
    ("vehicle_global_position_groundtruth", StreamKind::Poses),
    ("vehicle_global_position", StreamKind::Poses),
];

/// What a topic holds, and its place in the order of preference.
pub(super) fn kind_of(topic: &str) -> (StreamKind, usize) {
    TOPICS
        .iter()
        .enumerate()
        .find(|(_, (name, _))| *name == topic)
        .map_or((StreamKind::Other, TOPICS.len()), |(rank, (_, kind))| {
            (*kind, rank)
        })
}

/// What is said of a topic in a list.
pub(super) fn about(topic: &str) -> &'static str {
    match topic {
        "vehicle_imu" => "increments, sensor axes forward-right-down",
        "sensor_combined" => "mean rates of the selected sensors, forward-right-down",
        "vehicle_gps_position" => "fixes of the selected receiver",
        "sensor_gps" => "fixes of one receiver",
        "vehicle_global_position_groundtruth" => "the simulator's position",
        "vehicle_global_position" => "the controller's own position",
        _ => "not read",
    }
}

/// How a topic is read.
pub(super) enum Reading {
    Imu(Imu),
    Gps(Box<Gps>),
    Pose(Box<Pose>),
    Velocity(Velocity),
}

impl Reading {
    /// `Err` names the field that is not there.
    pub(super) fn new(topic: &str, layout: &Layout) -> Result<Self, &'static str> {
        match kind_of(topic).0 {
            StreamKind::Imu => Imu::new(topic, layout).map(Self::Imu),
            StreamKind::Fixes => Gps::new(layout).map(|gps| Self::Gps(Box::new(gps))),
            StreamKind::Poses => Pose::new(layout).map(|pose| Self::Pose(Box::new(pose))),
            StreamKind::Velocity | StreamKind::Other => Velocity::new(layout).map(Self::Velocity),
        }
    }
}

fn number(layout: &Layout, name: &'static str) -> Result<Place, &'static str> {
    layout.number(name).ok_or(name)
}

fn three(layout: &Layout, name: &'static str) -> Result<Place, &'static str> {
    layout.three(name).ok_or(name)
}

/// Time of a message: `timestamp_sample`, when it was measured, where that is set, else
/// `timestamp`, when it was published; both microseconds since the start of the system.
struct Time {
    sample: Option<Place>,
    published: Place,
}

impl Time {
    fn new(layout: &Layout) -> Result<Self, &'static str> {
        Ok(Self {
            sample: layout.number("timestamp_sample"),
            published: number(layout, "timestamp")?,
        })
    }

    /// \[s\]
    fn read(&self, message: &[u8]) -> f64 {
        let sampled = self.sample.map(|place| place.read(message));
        let micros = sampled.filter(|time| *time > 0.0);
        micros.unwrap_or_else(|| self.published.read(message)) / MICROS
    }
}

/// `sensor_combined` and `vehicle_imu`.
pub(super) struct Imu {
    time: Time,
    gyro: Place,
    accel: Place,
    /// Lengths of the intervals of integration.
    spans: Option<[Place; 2]>,
    /// The vectors are increments, not mean rates.
    increments: bool,
    /// Time of the accelerometer relative to the gyro's.
    relative: Option<Place>,
}

impl Imu {
    fn new(topic: &str, layout: &Layout) -> Result<Self, &'static str> {
        let time = Time::new(layout)?;
        if topic == "sensor_combined" {
            let spans = layout
                .number("gyro_integral_dt")
                .zip(layout.number("accelerometer_integral_dt"));
            return Ok(Self {
                time,
                gyro: three(layout, "gyro_rad")?,
                accel: three(layout, "accelerometer_m_s2")?,
                spans: spans.map(|(gyro, accel)| [gyro, accel]),
                increments: false,
                relative: layout.number("accelerometer_timestamp_relative"),
            });
        }
        let spans = match layout.number("dt") {
            Some(both) => [both, both],
            None => [
                number(layout, "delta_angle_dt")?,
                number(layout, "delta_velocity_dt")?,
            ],
        };
        Ok(Self {
            time,
            gyro: three(layout, "delta_angle")?,
            accel: three(layout, "delta_velocity")?,
            spans: Some(spans),
            increments: true,
            relative: None,
        })
    }

    /// The sample, and the length of the gyro's interval \[s\] where the topic tells it.
    pub(super) fn read(&self, message: &[u8]) -> (What, Option<(f64, f64)>) {
        let time = self.time.read(message);
        let (mut gyro, mut accel) = (self.gyro.vector(message), self.accel.vector(message));
        let absent = |place: Place| place.read(message) == NO_SAMPLE;
        if self.relative.is_some_and(absent) {
            let detail = "no accelerometer sample".to_owned();
            return (What::Skipped(SkipKind::MissingField, detail), None);
        }
        // Integers are microseconds, floats seconds.
        let seconds = |place: Place| {
            let scale = if place.is_integer() { MICROS } else { 1.0 };
            place.read(message) / scale
        };
        let spans = self.spans.map(|spans| spans.map(seconds));
        if let (true, Some([angle_dt, velocity_dt])) = (self.increments, spans) {
            if !(angle_dt > 0.0 && velocity_dt > 0.0) {
                let detail = format!("increments over {angle_dt} s and {velocity_dt} s");
                return (What::Skipped(SkipKind::OutOfRange, detail), None);
            }
            gyro /= angle_dt;
            accel /= velocity_dt;
        }
        let all = [&gyro, &accel].into_iter().flat_map(|v| v.iter());
        if !time.is_finite() || all.into_iter().any(|value| !value.is_finite()) {
            let detail = format!("gyro {gyro:?}, accelerometer {accel:?}");
            return (What::Skipped(SkipKind::NotFinite, detail), None);
        }
        let span = spans.map(|[gyro_span, _]| (time, gyro_span));
        (What::Imu(ImuReading { time, gyro, accel }), span)
    }
}

/// `vehicle_gps_position` and `sensor_gps`.
pub(super) struct Gps {
    time: Time,
    place: Place3,
    /// Standard deviations horizontal and vertical.
    std: Option<[Place; 2]>,
    velocity: Option<[Place; 3]>,
    velocity_std: Option<Place>,
    velocity_valid: Option<Place>,
    fix_type: Place,
}

impl Gps {
    fn new(layout: &Layout) -> Result<Self, &'static str> {
        let std = layout.number("eph").zip(layout.number("epv"));
        Ok(Self {
            time: Time::new(layout)?,
            place: Place3::new(layout)?,
            std: std.map(|(horizontal, vertical)| [horizontal, vertical]),
            velocity: together(layout, ["vel_n_m_s", "vel_e_m_s", "vel_d_m_s"]),
            velocity_std: layout.number("s_variance_m_s"),
            velocity_valid: layout.number("vel_ned_valid"),
            fix_type: number(layout, "fix_type")?,
        })
    }

    pub(super) fn read(&self, message: &[u8]) -> What {
        let fix_type = self.fix_type.read(message);
        let quality = match fix_type {
            3.0 => FixQuality::Single,
            4.0 => FixQuality::Differential,
            5.0 => FixQuality::Float,
            6.0 => FixQuality::Fixed,
            // Below 3 there is no height, 8 is extrapolated.
            _ => {
                let detail = format!("fix type {fix_type}");
                return What::Skipped(SkipKind::OutOfRange, detail);
            }
        };
        let place = match self.place.read(message) {
            Ok(place) => place,
            Err(detail) => return What::Skipped(SkipKind::OutOfRange, detail),
        };
        let covariance = self.std.and_then(|[horizontal, vertical]| {
            let (h, v) = (horizontal.read(message), vertical.read(message));
            independent(&Vector3::new(h, h, v))
        });
        let valid = self.velocity_valid.is_none_or(|v| v.read(message) != 0.0);
        let velocity = self
            .velocity
            .filter(|_| valid)
            .map(|places| Vector3::from(places.map(|place| place.read(message))))
            .filter(|velocity| velocity.iter().all(|v| v.is_finite()))
            .map(|velocity| {
                let std = self.velocity_std.map_or(f64::NAN, |s| s.read(message));
                (velocity, independent(&Vector3::repeat(std)))
            });
        What::Fix(Fix {
            time: self.time.read(message),
            position: Some((Position::Geodetic(place), covariance)),
            velocity,
            quality,
        })
    }
}

/// `vehicle_global_position` and its ground truth.
pub(super) struct Pose {
    time: Time,
    place: Place3,
    /// Older logs have the velocity here.
    velocity: Option<[Place; 3]>,
    valid: [Option<Place>; 2],
}

impl Pose {
    fn new(layout: &Layout) -> Result<Self, &'static str> {
        Ok(Self {
            time: Time::new(layout)?,
            place: Place3::new(layout)?,
            velocity: together(layout, ["vel_n", "vel_e", "vel_d"]),
            valid: ["lat_lon_valid", "alt_valid"].map(|name| layout.number(name)),
        })
    }

    /// `local` is the time and velocity of the last `vehicle_local_position`.
    pub(super) fn read(&self, message: &[u8], local: Option<(f64, Vector3)>) -> What {
        let time = self.time.read(message);
        let mut valid = self.valid.iter().flatten();
        if valid.any(|flag| flag.read(message) == 0.0) {
            let detail = "the controller calls it invalid".to_owned();
            return What::Skipped(SkipKind::OutOfRange, detail);
        }
        let position = match self.place.read(message) {
            Ok(place) => place,
            Err(detail) => return What::Skipped(SkipKind::OutOfRange, detail),
        };
        let v_n = match self.velocity {
            Some(places) => Some(Vector3::from(places.map(|place| place.read(message)))),
            None => local.filter(|(at, _)| *at == time).map(|(_, v_n)| v_n),
        };
        What::Pose(TruthSample {
            time,
            position,
            v_n: v_n.filter(|v_n| v_n.iter().all(|v| v.is_finite())),
            rpy: None,
        })
    }
}

/// `vehicle_local_position`: its velocity goes with the position of the same time.
pub(super) struct Velocity {
    time: Time,
    velocity: [Place; 3],
}

impl Velocity {
    fn new(layout: &Layout) -> Result<Self, &'static str> {
        Ok(Self {
            time: Time::new(layout)?,
            velocity: together(layout, ["vx", "vy", "vz"]).ok_or("vx, vy, vz")?,
        })
    }

    /// Time \[s\] and velocity north-east-down [m/s].
    pub(super) fn read(&self, message: &[u8]) -> (f64, Vector3) {
        let velocity = self.velocity.map(|place| place.read(message));
        (self.time.read(message), Vector3::from(velocity))
    }
}

/// A place on Earth: doubles in degrees and metres, or integers of 10⁻⁷ degrees and millimetres.
struct Place3 {
    lat: Place,
    lon: Place,
    /// Height above the ellipsoid, 0 where the publisher does not set it, and above mean sea level.
    heights: [Option<Place>; 2],
}

impl Place3 {
    fn new(layout: &Layout) -> Result<Self, &'static str> {
        let any = |names: [&'static str; 2]| names.into_iter().find_map(|n| layout.number(n));
        let ellipsoid = any(["altitude_ellipsoid_m", "alt_ellipsoid"]);
        let sea_level = any(["altitude_msl_m", "alt"]);
        Ok(Self {
            lat: any(["latitude_deg", "lat"]).ok_or("lat")?,
            lon: any(["longitude_deg", "lon"]).ok_or("lon")?,
            heights: [Some(ellipsoid.or(sea_level).ok_or("alt")?), sea_level],
        })
    }

    /// `Err` says what stands there instead of a place.
    fn read(&self, message: &[u8]) -> Result<Geodetic, String> {
        let scaled = |place: Place, unit: f64| {
            let value = place.read(message);
            if place.is_integer() {
                value * unit
            } else {
                value
            }
        };
        let (lat, lon) = (scaled(self.lat, 1e-7), scaled(self.lon, 1e-7));
        let heights = self.heights.iter().flatten();
        let mut heights = heights.map(|place| scaled(*place, 1e-3));
        let set = |height: &f64| height.is_finite() && *height != 0.0;
        let height = heights.find(set).unwrap_or(0.0);
        let place = Geodetic::from_degrees(lat, lon, height);
        if is_a_fix(&place) {
            Ok(place)
        } else {
            Err(format!("{lat}°, {lon}°, {height} m"))
        }
    }
}

fn together(layout: &Layout, names: [&str; 3]) -> Option<[Place; 3]> {
    let [x, y, z] = names.map(|name| layout.number(name));
    Some([x?, y?, z?])
}
