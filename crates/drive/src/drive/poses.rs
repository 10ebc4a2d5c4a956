//! The table `[poses]` of `DRIVE.toml`: poses in a local frame in the place of GNSS fixes.

use super::{
    Drive,
    error::{ConfigError, DriveError},
    gnss,
    imu::rotation_of_axes,
    keys,
    logs::Logs,
    tables::{read_delimiter, read_std},
};
use crate::columns;
use std::{
    f64::consts::FRAC_PI_2,
    path::{Path, PathBuf},
};
use undrift_config::Section;
use undrift_io::{
    gnss::{GnssSource, PoseFixes},
    poses::{AttitudeColumns, PoseFormat, PoseLog, PoseSource, QuaternionOrder},
    source::BytesRead,
    write::PoseFrame,
};
use undrift_nav::{
    Matrix3, Quaternion,
    attitude::from_rpy,
    earth::{Geodetic, gravity},
    parameters::{Parameter, Parameters, Prior},
    units::Quantity,
};

/// What a drive by poses has beside its log of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Poses {
    /// Axes of the marker in the body, `q_bk`.
    pub marker: Quaternion,
    /// Whether the frame's heading is north, so that the Earth's rotation is taken into account.
    pub earth_rate: bool,
    /// Whether the file says which errors of the sensors' axes are estimated, so that a tuning tries no others.
    pub axes_stated: bool,
}

/// Latitude where nothing is said of gravity \[rad\].
const LATITUDE: f64 = 45.0 * FRAC_PI_2 / 90.0;
/// How well the marker's axes are known that are stated, and those that are not, each way \[rad\].
const MARKER_STD: [f64; 2] = [0.05, 0.5];
/// How level the frame of poses is, each way \[rad\]: what a calibration with a level or gravity leaves.
const TILT_STD: f64 = 0.01;

/// Reads the table: the log, and how its poses are used.
pub(crate) fn read(
    section: &Section,
    local: &Section,
    logs: &mut Logs,
) -> Result<((PathBuf, GnssSource), Poses), DriveError> {
    let path = logs.named(section)?;
    let (format, _) = logs.format(section, &path, "time")?;
    let time_offset = section
        .quantity("time_offset", Quantity::Time)?
        .unwrap_or(0.0);
    let position_std = gnss::constant_std(section, "position_std", Quantity::Length)?;
    let attitude_std = gnss::constant_std(section, "attitude_std", Quantity::Angle)?;
    let topic = section.text("topic")?;
    let source = if format.is_log() {
        PoseSource::Log(PoseLog {
            format,
            stream: topic.map(str::to_owned),
            position_scale: section.unit("position_unit", Quantity::Length, 1.0)?,
            w_first: section.word("attitude_order", &ORDERS)?.unwrap_or(false),
            time_offset,
            span: logs.span,
        })
    } else {
        let mut columns = match section.get("time") {
            Some(_) => read_columns(section)?,
            None => known_layout(section, logs, &path, topic)?,
        };
        (columns.time_offset, columns.span) = (time_offset, logs.span);
        let position_known = position_std.is_some() || columns.position_std.is_some();
        let attitude_known = attitude_std.is_some() || columns.attitude_std.is_some();
        for (key, known) in [
            ("position_std", position_known),
            ("attitude_std", attitude_known || columns.attitude.is_none()),
        ] {
            if !known {
                let what = "how good the poses are, three numbers with their unit, such as \"1, 1, 1 mm\" or \"0.1, 0.1, 0.1 deg\"";
                return Err(section.missing(key, what).into());
            }
        }
        PoseSource::Table(Box::new(columns))
    };
    let interval = section.quantity("interval", Quantity::Time)?.unwrap_or(0.0);
    let (latitude, earth_rate) = read_local(local)?;
    let fixes = PoseFixes {
        source,
        base: Geodetic {
            lat: latitude,
            lon: 0.0,
            height: 0.0,
        },
        rotation: read_frame(section)?,
        position_std,
        attitude_std,
        interval,
    };
    let marker = section.vector("marker", Quantity::Angle)?;
    let marker = marker.map_or_else(Quaternion::identity, |rpy| from_rpy(&rpy));
    // Read elsewhere.
    let _ = [
        "lever_arm",
        "gate",
        "adapt",
        "correlation_time",
        "correlated_share",
        "std_factors",
    ]
    .map(|key| section.get(key));
    section.only_known()?;
    Ok((
        (path, GnssSource::Poses(Box::new(fixes))),
        Poses {
            marker,
            earth_rate,
            axes_stated: false,
        },
    ))
}

impl Drive {
    /// The frame of the poses, for a solution that is written in it; `None` of a drive by fixes.
    pub fn pose_frame(&self) -> Option<PoseFrame> {
        let (poses, GnssSource::Poses(fixes)) = (self.poses?, &self.gnss.1) else {
            return None;
        };
        Some(PoseFrame {
            origin: fixes.base,
            rotation: fixes.rotation,
            marker: poses.marker,
            lever_arm: self.lever_arm,
            time_offset: *fixes.source.clone().time_offset(),
        })
    }
}

/// From the frame's axes to north, east, down: `axes = "x,-y,-z"`, which is what a frame with z up needs, or `frame` as angles.
fn read_frame(section: &Section) -> Result<Quaternion, ConfigError> {
    let frame = section.vector("frame", Quantity::Angle)?;
    match (section.text("axes")?, frame) {
        (Some(_), Some(_)) => Err(section.error("frame", "set axes or frame, not both")),
        (None, Some(rpy)) => Ok(from_rpy(&rpy)),
        (axes, None) => {
            let axes = axes.unwrap_or("x,-y,-z");
            let matrix: Matrix3 =
                rotation_of_axes(axes).map_err(|message| section.error("axes", message))?;
            Ok(Quaternion::from_matrix(&matrix))
        }
    }
}

/// `[local]`: latitude by `latitude` or `gravity`, and whether the Earth's rotation counts.
fn read_local(local: &Section) -> Result<(f64, bool), ConfigError> {
    let latitude = local.quantity("latitude", Quantity::Angle)?;
    let stated = local.quantity("gravity", Quantity::Acceleration)?;
    let earth_rate = local.switch("earth_rate")?.unwrap_or(false);
    local.only_known()?;
    let latitude = match (latitude, stated) {
        (Some(_), Some(_)) => {
            return Err(local.error("gravity", "set latitude or gravity, not both"));
        }
        (Some(latitude), None) if latitude.abs() < FRAC_PI_2 - 0.01 => latitude,
        (Some(_), None) => return Err(local.error("latitude", "must lie between -89 and 89 deg")),
        (None, None) => LATITUDE,
        (None, Some(value)) => latitude_of(value).ok_or_else(|| {
            local.error(
                "gravity",
                "must lie between 9.781 and 9.832 m/s^2, as on the ground",
            )
        })?,
    };
    Ok((latitude, earth_rate))
}

/// Latitude at sea level where gravity is `value` [m/s²], by bisection.
fn latitude_of(value: f64) -> Option<f64> {
    let (mut low, mut high) = (0.0, FRAC_PI_2 - 0.01);
    if !(gravity(low, 0.0)..=gravity(high, 0.0)).contains(&value) {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match gravity(middle, 0.0) < value {
            true => low = middle,
            false => high = middle,
        }
    }
    Some(low)
}

/// Rows that are looked at for the units of columns.
const ROWS: usize = 4000;
/// The scalar part of quaternions is the first or the last of the four numbers.
const ORDERS: [(&str, bool); 2] = [("x,y,z,w", false), ("w,x,y,z", true)];

/// The poses of a table whose layout is known by its beginning (TUM, KITTI, EuRoC, Motive) or by the names of its columns, with what is
/// stated of it.
fn known_layout(
    section: &Section,
    logs: &Logs,
    path: &Path,
    topic: Option<&str>,
) -> Result<PoseFormat, DriveError> {
    let mut opened = logs.open(path, &BytesRead::default())?;
    let found = match undrift_io::poses::detect(&mut opened, topic)? {
        Some(PoseSource::Table(format)) => Some(*format),
        _ => columns::poses(&opened.preview(ROWS)?),
    };
    let Some(mut format) = found.filter(|format| format.position.is_some()) else {
        let what = "the time column: no names of columns, and neither TUM, KITTI with times, EuRoC nor Motive, so time, position and attitude have to be named";
        return Err(section.missing("time", what).into());
    };
    let order = section.word("attitude_order", &ORDERS)?;
    if let (Some(AttitudeColumns::Quaternion { w_first, .. }), Some(order)) =
        (&mut format.attitude, order)
    {
        *w_first = order;
    }
    if section.get("position_unit").is_some() {
        format.position_scale = section.unit("position_unit", Quantity::Length, 1.0)?;
    }
    Ok(format)
}

/// The poses in named columns of a table.
fn read_columns(section: &Section) -> Result<PoseFormat, DriveError> {
    let time =
        keys::column(section, "time")?.ok_or_else(|| section.missing("time", "the time column"))?;
    let position = keys::columns(section, "position")?;
    if position.is_none() {
        let what = "set position, the three columns x, y, z: attitudes alone do not show what accelerometers err by";
        return Err(section.missing("position", what).into());
    }
    let attitude = keys::four_columns(section, "attitude")?;
    let w_first = section.word("attitude_order", &ORDERS)?;
    let attitude = match (attitude, w_first) {
        (Some(columns), Some(w_first)) => Some(AttitudeColumns::Quaternion { columns, w_first }),
        (Some(_), None) => {
            let what = "\"x,y,z,w\" or \"w,x,y,z\": which of the four columns is the scalar part";
            return Err(section.missing("attitude_order", what).into());
        }
        (None, Some(_)) => {
            return Err(section
                .error("attitude_order", "needs attitude, the four columns")
                .into());
        }
        (None, None) => keys::columns(section, "euler")?
            .map(|columns| {
                section
                    .unit("euler_unit", Quantity::Angle, 1f64.to_radians())
                    .map(|scale| AttitudeColumns::Euler { columns, scale })
            })
            .transpose()?,
    };
    Ok(PoseFormat {
        date: keys::column(section, "date")?,
        time_scale: section.unit("time_unit", Quantity::Time, 1.0)?,
        position_scale: section.unit("position_unit", Quantity::Length, 1.0)?,
        position_std: keys::columns(section, "position_std_columns")?,
        attitude_std: keys::columns(section, "attitude_std_columns")?,
        attitude_std_scale: section.unit("attitude_std_unit", Quantity::Angle, 1.0)?,
        quaternion_order: QuaternionOrder::Stated,
        delimiter: read_delimiter(section)?,
        ..PoseFormat::new(time, position, attitude)
    })
}

/// Whether `[states]` says which errors of the sensors' axes are estimated.
pub(super) fn axes_stated(states: &Section) -> bool {
    ["misalignment", "scale_factor"]
        .iter()
        .any(|key| states.get(key).is_some())
}

/// The parameters that poses ask for, beside those of [`states`](super::tables::read_states); `given` where the marker's axes are stated.
pub(super) fn read_states(section: &Section, given: bool) -> Result<Parameters, ConfigError> {
    let std = |key, otherwise| read_std(section, key, Quantity::Angle, Some(otherwise));
    let marker = std("marker", MARKER_STD[usize::from(!given)])?;
    let tilt = std("frame_tilt", TILT_STD)?;
    let mut parameters = Parameters::none();
    for (kind, std) in [
        (Parameter::MarkerRotation, marker),
        (Parameter::FrameTilt, tilt),
    ] {
        if let Some(std) = std {
            parameters = parameters.with(kind, Prior::constant(std));
        }
    }
    Ok(parameters)
}

/// `parameters` as they are beside poses: nothing of a velocity, clocks that differ by an offset and a rate, and a lever arm, all without a
/// walk, since poses show them in every movement.
pub(super) fn beside_poses(parameters: Parameters) -> Parameters {
    let constant = |parameters: Parameters, kind| match parameters.prior(kind) {
        Some(prior) => parameters.with(kind, Prior::constant(prior.std)),
        None => parameters,
    };
    let parameters = parameters.without(Parameter::VelocityTimeOffset);
    constant(
        constant(parameters, Parameter::TimeOffset),
        Parameter::LeverArm,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Drive;
    use undrift_nav::Vector3;

    /// A drive of named columns with these keys beside them, and these tables behind.
    fn drive(keys: &str, tables: &str) -> Result<Drive, String> {
        let imu = "[imu]\nfile = \"imu.csv\"\ntime = 1\ngyro = [2, 3, 4]\naccel = [5, 6, 7]\n\
                   gyro_unit = \"deg/s\"\naccel_unit = \"g\"\n";
        let poses = "[poses]\nfile = \"poses.csv\"\ntime = 1\nposition = [2, 3, 4]\n";
        let none = Path::new("none");
        let text = format!("{imu}{poses}{keys}{tables}");
        Drive::from_toml(&text, "room.toml", none, none).map_err(|error| error.to_string())
    }

    const STD: &str = "position_std = \"1 mm\"\nattitude_std = \"0.1 deg\"\n";
    const ATTITUDE: &str = "attitude = [5, 6, 7, 8]\nattitude_order = \"w,x,y,z\"\n";

    fn fixes(drive: &Drive) -> &PoseFixes {
        match &drive.gnss.1 {
            GnssSource::Poses(fixes) => fixes,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_room_has_no_north_and_no_vibration_of_an_engine() {
        let room = drive(&format!("{STD}{ATTITUDE}"), "").unwrap();
        let poses = room.poses.unwrap();
        assert!(!poses.earth_rate && poses.marker == Quaternion::identity());
        assert_eq!(
            (room.vibration, room.align.heading),
            (None, crate::align::Heading::Auto)
        );
        // z is up.
        let up = fixes(&room).rotation * Vector3::z();
        assert!((up + Vector3::z()).norm() < 1e-12);
        let prior = |kind| {
            room.parameters
                .prior(kind)
                .map(|prior| (prior.std, prior.walk))
        };
        assert_eq!(prior(Parameter::MarkerRotation), Some((0.5, 0.0)));
        assert_eq!(prior(Parameter::FrameTilt), Some((0.01, 0.0)));
        assert_eq!(prior(Parameter::TimeOffset), Some((0.1, 0.0)));
        assert_eq!(prior(Parameter::VelocityTimeOffset), None);
        let stated = "marker = \"1, 2, 3 deg\"\naxes = \"x,z,-y\"\ninterval = \"50 ms\"\n";
        let states = "[states]\nframe_tilt = \"off\"\n[local]\nearth_rate = true\n";
        let room = drive(&format!("{STD}{stated}"), states).unwrap();
        assert!(room.poses.unwrap().earth_rate && fixes(&room).interval == 0.05);
        // y is up.
        let up = fixes(&room).rotation * Vector3::y();
        assert!((up + Vector3::z()).norm() < 1e-12);
        let prior = |kind| room.parameters.prior(kind).map(|prior| prior.std);
        assert_eq!(prior(Parameter::MarkerRotation), Some(0.05));
        assert_eq!(prior(Parameter::FrameTilt), None);
    }

    /// Position and attitude by the same keys, each with a factor of its own: half of the variance lasts, twice as large of
    /// the position, three times of the attitude.
    #[test]
    fn errors_of_both_last_where_that_is_said() {
        let lasting = "correlation_time = \"2 s\"\ncorrelated_share = 0.5\n\
                       std_factors = { position_correlated = 2, attitude_correlated = 3 }\n";
        let errors = |keys: &str| {
            let room = drive(&format!("{STD}{ATTITUDE}{keys}"), "").unwrap();
            crate::navigate::fix_errors(&room)
        };
        let found = errors(lasting);
        let both = [found.correlated, found.velocity_correlated].map(|part| part.unwrap());
        assert_eq!(both.map(|part| part.time), [2.0; 2]);
        assert!((both[0].share - 0.8).abs() < 1e-12 && (both[1].share - 0.9).abs() < 1e-12);
        assert!((found.velocity_factor.x - 5f64.sqrt()).abs() < 1e-12);
        let white = errors("");
        assert!(white.correlated.is_none() && white.velocity_correlated.is_none());
    }

    #[test]
    fn gravity_is_that_of_a_latitude() {
        let at =
            |local: &str| drive(STD, &format!("[local]\n{local}")).map(|room| fixes(&room).base);
        for value in [9.79, 9.806, 9.825] {
            let base = at(&format!("gravity = \"{value} m/s^2\"\n")).unwrap();
            assert!((gravity(base.lat, base.height) - value).abs() < 1e-9);
        }
        let base = at("latitude = \"-33 deg\"\n").unwrap();
        assert!((base.lat.to_degrees() + 33.0).abs() < 1e-9);
        let lunar = at("gravity = \"1.6 m/s^2\"\n").unwrap_err();
        assert!(
            lunar.contains("local.gravity: must lie between 9.781 and 9.832"),
            "{lunar}"
        );
    }

    #[test]
    fn what_is_missing_or_too_much_is_said_with_its_key() {
        for (keys, tables, said) in [
            ("", "", "poses.position_std"),
            (
                "position_std = \"1 mm\"\nattitude = [5, 6, 7, 8]\n",
                "",
                "poses.attitude_order",
            ),
            (
                &*format!("position_std = \"1 mm\"\n{ATTITUDE}"),
                "",
                "poses.attitude_std",
            ),
            (
                &*format!("{STD}attitude = [5, 6, 7]\nattitude_order = \"x,y,z,w\"\n"),
                "",
                "a list of four columns",
            ),
            (
                &*format!("{STD}velocity = [5, 6, 7]\n"),
                "",
                "poses.velocity",
            ),
            (&*format!("{STD}axes = \"x,y,-z\"\n"), "", "left-handed"),
            (
                STD,
                "[gnss]\nfile = \"g.csv\"\n",
                "set [gnss] or [poses], not both",
            ),
            (STD, "[local]\naltitude = \"3 m\"\n", "local.altitude"),
        ] {
            let error = drive(keys, tables).unwrap_err();
            assert!(
                error.contains(said) && error.contains("room.toml"),
                "{said}: {error}"
            );
        }
        let gnss = "[imu]\nfile = \"imu.csv\"\ntime = 1\ngyro = [2, 3, 4]\naccel = [5, 6, 7]\n\
                    gyro_unit = \"deg/s\"\naccel_unit = \"g\"\n[gnss]\nfile = \"g.csv\"\ntime = 1\n\
                    position = [2, 3, 4]\nposition_std = \"1 m\"\n[local]\nlatitude = \"3 deg\"\n";
        let none = Path::new("none");
        let error = Drive::from_toml(gnss, "car.toml", none, none)
            .unwrap_err()
            .to_string();
        assert!(error.contains("local.latitude"), "{error}");
    }
}
