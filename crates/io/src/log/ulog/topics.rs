//! The topics that are read, as PX4's message definitions have them over the years.

use undrift_nav::Vector3;
use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position, TruthSample};

use super::layout::{Field, TopicLayout};
use crate::entry::{FieldReading, Fix, ImuReading, StreamKind, What};
use crate::fix::{self, independent, on_earth};
use crate::skipped::{SkipKind, Unfit};

/// What an accelerometer's relative time is when it gave nothing (2³¹ − 1).
const NO_SAMPLE: f64 = i32::MAX as f64;
/// Microseconds in a second.
const MICROS: f64 = 1e6;

/// Topics by what they hold, the preferred one of each kind first.
const TOPICS: [(&str, StreamKind); 8] = [
    ("vehicle_imu", StreamKind::Imu),
    ("sensor_combined", StreamKind::Imu),
    ("vehicle_magnetometer", StreamKind::Fields),
    ("sensor_mag", StreamKind::Fields),
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
        "vehicle_magnetometer" => {
            "magnetic fields with the controller's calibration, forward-right-down"
        }
        "sensor_mag" => "magnetic fields of one sensor, its axes",
        "vehicle_gps_position" => "fixes of the selected receiver",
        "sensor_gps" => "fixes of one receiver",
        "vehicle_global_position_groundtruth" => "the simulator's position",
        "vehicle_global_position" => "the controller's own position",
        _ => "not read",
    }
}

/// Makes a reference solution of a message and of the time and velocity of the last
/// `vehicle_local_position`.
type ReadPose = dyn Fn(&[u8], Option<(f64, Vector3)>) -> Result<What, Unfit> + Send;
/// Makes a sample of a message, with its time and the length of the gyro's interval \[s\] where the topic
/// states it.
type ReadSample = dyn Fn(&[u8]) -> Result<(What, Option<(f64, f64)>), Unfit> + Send;

/// Makes a fix or a magnetic field of a message.
type ReadOther = dyn Fn(&[u8]) -> Result<What, Unfit> + Send;
/// Reads time \[s\] and velocity north-east-down [m/s] of a message.
type ReadVelocity = dyn Fn(&[u8]) -> (f64, Vector3) + Send;

/// What is made of a message, by the fields of its topic.
pub(super) enum TopicReader {
    /// An inertial sample.
    Imu(Box<ReadSample>),
    /// A fix, or a magnetic field.
    Other(Box<ReadOther>),
    /// A reference solution.
    Pose(Box<ReadPose>),
    /// Time \[s\] and velocity north-east-down [m/s].
    Velocity(Box<ReadVelocity>),
}

impl TopicReader {
    /// `Err` names the field that is not there.
    pub(super) fn new(topic: &str, layout: &TopicLayout) -> Result<Self, &'static str> {
        Ok(match kind_of(topic).0 {
            StreamKind::Imu => Self::Imu(imu(topic, layout)?),
            StreamKind::Fixes => Self::Other(Box::new(gps(layout)?)),
            StreamKind::Fields => Self::Other(Box::new(field(layout)?)),
            StreamKind::Poses => Self::Pose(pose(layout)?),
            StreamKind::Velocity
            | StreamKind::LocalPoses
            | StreamKind::Headings
            | StreamKind::Observations
            | StreamKind::Other => Self::Velocity(Box::new(local_velocity(layout)?)),
        })
    }
}

fn number(layout: &TopicLayout, name: &'static str) -> Result<Field, &'static str> {
    layout.number(name).ok_or(name)
}

fn three(layout: &TopicLayout, name: &'static str) -> Result<Field, &'static str> {
    layout.three(name).ok_or(name)
}

fn together(layout: &TopicLayout, names: [&str; 3]) -> Option<[Field; 3]> {
    let [x, y, z] = names.map(|name| layout.number(name));
    Some([x?, y?, z?])
}

/// Three fields of a message, if all are finite.
fn finite(fields: [Field; 3], message: &[u8]) -> Option<Vector3> {
    fix::finite(Vector3::from(fields.map(|field| field.read(message)))).ok()
}

/// Time of a message \[s\]: `timestamp_sample`, when it was measured, where that is set, else
/// `timestamp`, when it was published; both microseconds since the start of the system.
fn time(layout: &TopicLayout) -> Result<impl Fn(&[u8]) -> f64 + use<>, &'static str> {
    let sample = layout.number("timestamp_sample");
    let published = number(layout, "timestamp")?;
    Ok(move |message: &[u8]| {
        let sampled = sample.map(|field| field.read(message));
        let micros = sampled.filter(|time| *time > 0.0);
        micros.unwrap_or_else(|| published.read(message)) / MICROS
    })
}

/// `sensor_combined`, which has mean rates, and `vehicle_imu`, which has increments.
fn imu(topic: &str, layout: &TopicLayout) -> Result<Box<ReadSample>, &'static str> {
    let time = time(layout)?;
    let increments = topic != "sensor_combined";
    let (gyro, accel) = match increments {
        true => ("delta_angle", "delta_velocity"),
        false => ("gyro_rad", "accelerometer_m_s2"),
    };
    // Lengths of the intervals of integration.
    let spans = match (layout.number("dt"), increments) {
        (Some(both), true) => Some((both, both)),
        (None, true) => Some((
            number(layout, "delta_angle_dt")?,
            number(layout, "delta_velocity_dt")?,
        )),
        (_, false) => layout
            .number("gyro_integral_dt")
            .zip(layout.number("accelerometer_integral_dt")),
    };
    let (gyro, accel) = (three(layout, gyro)?, three(layout, accel)?);
    // Time of the accelerometer relative to the gyro's.
    let relative = layout.number("accelerometer_timestamp_relative");
    let relative = relative.filter(|_| !increments);
    Ok(Box::new(move |message: &[u8]| {
        let time = time(message);
        let (mut gyro, mut accel) = (gyro.vector(message), accel.vector(message));
        if relative.is_some_and(|field| field.read(message) == NO_SAMPLE) {
            let detail = "no accelerometer sample".to_owned();
            return Err((SkipKind::MissingField, detail));
        }
        // Integers are microseconds, floats seconds.
        let seconds = |field: Field| field.scaled(message, |micros| micros / MICROS);
        let spans = spans.map(|(angle, velocity)| (seconds(angle), seconds(velocity)));
        if let (true, Some((angle_dt, velocity_dt))) = (increments, spans) {
            if !(angle_dt > 0.0 && velocity_dt > 0.0) {
                let detail = format!("increments over {angle_dt} s and {velocity_dt} s");
                return Err((SkipKind::OutOfRange, detail));
            }
            gyro /= angle_dt;
            accel /= velocity_dt;
        }
        let mut all = gyro.iter().chain(&accel).chain([&time]);
        if all.any(|value| !value.is_finite()) {
            let detail = format!("gyro {gyro:?}, accelerometer {accel:?}");
            return Err((SkipKind::NotFinite, detail));
        }
        let span = spans.map(|(gyro_span, _)| (time, gyro_span));
        Ok((What::Imu(ImuReading::new(time, gyro, accel)), span))
    }))
}

/// `vehicle_magnetometer` and `sensor_mag`, in gauss.
fn field(
    layout: &TopicLayout,
) -> Result<impl Fn(&[u8]) -> Result<What, Unfit> + use<>, &'static str> {
    let time = time(layout)?;
    let whole = layout.three("magnetometer_ga");
    let parts = together(layout, ["x", "y", "z"]);
    if whole.is_none() && parts.is_none() {
        return Err("magnetometer_ga");
    }
    Ok(move |message: &[u8]| {
        let whole = whole.map(|field| field.vector(message));
        let parts = || parts.map(|fields| Vector3::from(fields.map(|field| field.read(message))));
        let gauss = fix::finite(whole.or_else(parts).unwrap_or_default())?;
        Ok(What::Field(FieldReading {
            time: time(message),
            field: gauss * 1e-4,
        }))
    })
}

/// `vehicle_gps_position` and `sensor_gps`.
fn gps(
    layout: &TopicLayout,
) -> Result<impl Fn(&[u8]) -> Result<What, Unfit> + use<>, &'static str> {
    let (time, place) = (time(layout)?, place(layout)?);
    let std = layout.number("eph").zip(layout.number("epv"));
    let velocity = together(layout, ["vel_n_m_s", "vel_e_m_s", "vel_d_m_s"]);
    let velocity_std = layout.number("s_variance_m_s");
    let velocity_valid = layout.number("vel_ned_valid");
    let fix_type = number(layout, "fix_type")?;
    Ok(move |message: &[u8]| {
        let fix_type = fix_type.read(message);
        let quality = match fix_type {
            3.0 => FixQuality::Single,
            4.0 => FixQuality::Differential,
            5.0 => FixQuality::Float,
            6.0 => FixQuality::Fixed,
            // Below 3 there is no height, 8 is extrapolated.
            _ => {
                let detail = format!("fix type {fix_type}");
                return Err((SkipKind::OutOfRange, detail));
            }
        };
        let place = place(message)?;
        let covariance = std.and_then(|(horizontal, vertical)| {
            let (h, v) = (horizontal.read(message), vertical.read(message));
            independent(&Vector3::new(h, h, v))
        });
        let valid = velocity_valid.is_none_or(|v| v.read(message) != 0.0);
        let velocity = velocity.filter(|_| valid);
        let velocity = velocity.and_then(|fields| finite(fields, message));
        let std = velocity_std.map_or(f64::NAN, |s| s.read(message));
        Ok(What::Fix(Fix {
            mean_velocity: None,
            time: time(message),
            position: Some((Position::Geodetic(place), covariance)),
            velocity: velocity.map(|v_n| (v_n, independent(&Vector3::repeat(std)))),
            quality,
        }))
    })
}

/// `vehicle_global_position` and its ground truth; older logs have the velocity there.
fn pose(layout: &TopicLayout) -> Result<Box<ReadPose>, &'static str> {
    let (time, place) = (time(layout)?, place(layout)?);
    let velocity = together(layout, ["vel_n", "vel_e", "vel_d"]);
    let valid = ["lat_lon_valid", "alt_valid"].map(|name| layout.number(name));
    Ok(Box::new(
        move |message: &[u8], local: Option<(f64, Vector3)>| {
            let time = time(message);
            let mut valid = valid.iter().flatten();
            if valid.any(|flag| flag.read(message) == 0.0) {
                let detail = "the controller calls it invalid".to_owned();
                return Err((SkipKind::OutOfRange, detail));
            }
            let position = place(message)?;
            let local = local.filter(|(at, v_n)| *at == time && v_n.iter().all(|v| v.is_finite()));
            Ok(What::Pose(TruthSample {
                time,
                position,
                v_n: match velocity {
                    Some(fields) => finite(fields, message),
                    None => local.map(|(_, v_n)| v_n),
                },
                rpy: None,
            }))
        },
    ))
}

/// `vehicle_local_position`: its velocity goes with the position of the same time.
fn local_velocity(
    layout: &TopicLayout,
) -> Result<impl Fn(&[u8]) -> (f64, Vector3) + use<>, &'static str> {
    let time = time(layout)?;
    let velocity = together(layout, ["vx", "vy", "vz"]).ok_or("vx, vy, vz")?;
    Ok(move |message: &[u8]| {
        let velocity = velocity.map(|field| field.read(message));
        (time(message), Vector3::from(velocity))
    })
}

/// A place on Earth: doubles in degrees and metres, or integers of 10⁻⁷ degrees and millimetres.
fn place(
    layout: &TopicLayout,
) -> Result<impl Fn(&[u8]) -> Result<Geodetic, Unfit> + use<>, &'static str> {
    let any = |names: [&'static str; 2]| names.into_iter().find_map(|n| layout.number(n));
    let lat = any(["latitude_deg", "lat"]).ok_or("lat")?;
    let lon = any(["longitude_deg", "lon"]).ok_or("lon")?;
    // Above the ellipsoid, 0 where the publisher does not set it, and above mean sea level.
    let ellipsoid = any(["altitude_ellipsoid_m", "alt_ellipsoid"]);
    let sea_level = any(["altitude_msl_m", "alt"]);
    let heights = [Some(ellipsoid.or(sea_level).ok_or("alt")?), sea_level];
    Ok(move |message: &[u8]| {
        let degrees = |field: Field| field.scaled(message, |integer| integer * 1e-7);
        let (lat, lon) = (degrees(lat), degrees(lon));
        let heights = heights.iter().flatten();
        let mut heights = heights.map(|field| field.scaled(message, |integer| integer * 1e-3));
        let set = |height: &f64| height.is_finite() && *height != 0.0;
        let height = heights.find(set).unwrap_or(0.0);
        on_earth(Geodetic::from_degrees(lat, lon, height))
    })
}
