//! The table `[imu]` of `DRIVE.toml`.

use super::{
    error::{ConfigError, DriveError},
    keys,
    logs::Logs,
    tables::{read_delimiter, read_span},
    text::{parse, read_text},
};
use std::path::{Path, PathBuf};
use undrift_config::{Section, Value};
use undrift_io::{format::Format, imu::ImuFormat, layouts};
use undrift_nav::{Matrix3, Vector3, attitude::from_rpy, covariance::AXES, units::Quantity};
use undrift_noise::model_file;

/// The inertial log of a drive file, without the rest of the drive.
pub struct ImuLog {
    /// Folder of the log, and the span of it that is read.
    pub logs: Logs,
    /// File of the log.
    pub path: PathBuf,
    /// Columns or stream, units and axes of the samples.
    pub format: ImuFormat,
    /// Units of gyro and accelerometer columns, as stated; of increments and logs `None`.
    pub units: Option<(String, String)>,
}

/// Reads the tables `[imu]` and `[span]` of the drive file `path`; the others may be missing: for static recordings and descriptions of
/// logs.
///
/// # Errors
/// As [`Drive::load`](super::Drive::load), for those tables.
pub fn load_imu(path: &Path) -> Result<ImuLog, DriveError> {
    let (text, file) = read_text(path)?;
    let table = parse(&text, &file)?;
    let top = Section::top(table.get_ref(), &text, &file);
    let mut logs = Logs {
        folder: path.parent().unwrap_or(Path::new("")).to_path_buf(),
        span: read_span(&top.section("span")?)?,
        ..Logs::default()
    };
    let section = top.section("imu")?;
    let ((path, format), _) = read_imu(&section, &mut logs)?;
    // Of x: a record has one unit, and its sign does not matter.
    let of_x = |text: &str| text.split(',').next().unwrap_or(text).trim().to_owned();
    let unit = |key| Ok::<_, ConfigError>(section.text(key)?.map(of_x));
    let units = unit("gyro_unit")?.zip(unit("accel_unit")?);
    Ok(ImuLog {
        logs,
        path,
        units: units.filter(|_| !format.increments),
        format,
    })
}

/// Accelerometers that read another tenth too much or too little are broken, or in another unit.
const MOST_SCALE_ERROR: f64 = 0.1;

/// What the table `[imu]` says beside where the samples are.
pub(crate) struct ImuOptions {
    pub(crate) estimate_mounting: bool,
    /// Roll, pitch, yaw \[rad\].
    pub(crate) mounting_std: Vector3,
    pub(crate) accel_scale_error: f64,
    pub(crate) vibration: Option<[f64; AXES]>,
}

pub(crate) fn read_imu(
    section: &Section,
    logs: &mut Logs,
) -> Result<((PathBuf, ImuFormat), ImuOptions), DriveError> {
    let path = logs.named(section)?;
    let mut format = match logs.format(section, &path, "gyro")?.0 {
        Format::KfGins => with_units(section, layouts::kf_gins_imu())?,
        Format::Euroc => with_units(section, layouts::euroc_imu())?,
        log if log.is_log() => {
            let topic = section.text("topic")?.map(str::to_owned);
            with_units(section, ImuFormat::log(log, topic))?
        }
        _ => read_columns(section)?,
    };
    format.rate_hz = section.quantity("rate", Quantity::Frequency)?;
    if format.rate_hz.is_some_and(|r| r <= 0.0) {
        return Err(section.error("rate", "must be above 0 Hz").into());
    }
    if !format.has_times() && format.rate_hz.is_none() {
        let what = "set the time column, or rate for a log without times";
        return Err(section.missing("time", what).into());
    }
    format.time_offset = section
        .quantity("time_offset", Quantity::Time)?
        .unwrap_or(0.0);
    let estimate_mounting = match section.get("mounting") {
        Some(Value::Text(text)) => text.trim() == "auto",
        _ => false,
    };
    let mounting = match estimate_mounting {
        true => None,
        false => section.vector("mounting", Quantity::Angle)?,
    };
    if estimate_mounting {
        for key in ["axes", "gyro_offset", "accel_offset"] {
            if section.get(key).is_some() {
                let message = "refers to body axes, which are unknown until the mounting is estimated: \
                               omit it, or set imu.mounting as angles";
                return Err(section.error(key, message).into());
            }
        }
    }
    format.rotation = match (section.text("axes")?, mounting) {
        (Some(_), Some(_)) => {
            return Err(section
                .error("mounting", "set axes or mounting, not both")
                .into());
        }
        (Some(axes), None) => rotation_of_axes(axes).map_err(|m| section.error("axes", m))?,
        (None, Some(rpy)) => from_rpy(&rpy).to_rotation_matrix().into_inner(),
        (None, None) => Matrix3::identity(),
    };
    let mounting_std = section.vector("mounting_std", Quantity::Angle)?;
    if mounting_std.is_some_and(|std| std.min() < 0.0) {
        return Err(section.error("mounting_std", "must not be negative").into());
    }
    if estimate_mounting && mounting_std.is_some() {
        let message = "has no effect beside mounting = \"auto\", which finds it, too";
        return Err(section.error("mounting_std", message).into());
    }
    let accel_scale_error = section.factor("accel_scale_error")?.unwrap_or(0.0);
    if !(0.0..=MOST_SCALE_ERROR).contains(&accel_scale_error) {
        let message = format!("must be between 0 and {MOST_SCALE_ERROR}, as 0.007 for 0.7 %");
        return Err(section.error("accel_scale_error", message).into());
    }
    format.gyro_offset = section
        .vector("gyro_offset", Quantity::AngularRate)?
        .unwrap_or_else(Vector3::zeros);
    format.accel_offset = section
        .vector("accel_offset", Quantity::Acceleration)?
        .unwrap_or_else(Vector3::zeros);
    format.span = logs.span;
    let vibration = read_vibration(section)?;
    section.only_known()?;
    let options = ImuOptions {
        estimate_mounting,
        mounting_std: mounting_std.unwrap_or_else(Vector3::zeros),
        accel_scale_error,
        vibration,
    };
    Ok(((path, format), options))
}

/// `vibration = "auto"` or `"off"`, and `vibration_factors = { gyro_x = 0.5, accel_z = 0.6 }`, what `undrift tune` writes.
fn read_vibration(section: &Section) -> Result<Option<[f64; AXES]>, ConfigError> {
    let follows = section.word("vibration", &[("auto", true), ("off", false)])?;
    let follows = follows.unwrap_or(true);
    let given = section.section("vibration_factors")?;
    if given.exists() && !follows {
        return Err(section.error("vibration_factors", "needs vibration = \"auto\""));
    }
    let mut factors = [1.0; AXES];
    for (slot, axis) in factors.iter_mut().zip(model_file::AXES) {
        *slot = given.factor(axis)?.unwrap_or(1.0);
    }
    given.only_known()?;
    Ok(follows.then_some(factors))
}

/// The format with the units that its numbers are in, where these are stated instead of SI.
fn with_units(section: &Section, mut format: ImuFormat) -> Result<ImuFormat, ConfigError> {
    let (gyro, accel) = quantities(&format);
    format.gyro_scale = section.units("gyro_unit", gyro)?;
    format.accel_scale = section.units("accel_unit", accel)?;
    Ok(format)
}

/// What the numbers of gyros and accelerometers measure.
fn quantities(format: &ImuFormat) -> (Quantity, Quantity) {
    match format.increments {
        true => (Quantity::Angle, Quantity::Velocity),
        false => (Quantity::AngularRate, Quantity::Acceleration),
    }
}

/// The samples in named columns of a table.
fn read_columns(section: &Section) -> Result<ImuFormat, ConfigError> {
    let need = |key, columns: Option<_>| {
        columns.ok_or_else(|| section.missing(key, "the three columns x, y, z"))
    };
    let gyro = need("gyro", keys::columns(section, "gyro")?)?;
    let accel = need("accel", keys::columns(section, "accel")?)?;
    let mut format = ImuFormat::new(keys::column(section, "time")?, gyro, accel)
        .delimited_by(read_delimiter(section)?);
    format.increments = section
        .word("data", &[("rates", false), ("increments", true)])?
        .unwrap_or(false);
    let (gyro_quantity, accel_quantity) = quantities(&format);
    // A unit wrongly taken for granted is the commonest silent error of this field: it must be said.
    for key in ["gyro_unit", "accel_unit"] {
        if section.get(key).is_none() {
            let quantity = if key == "gyro_unit" {
                gyro_quantity
            } else {
                accel_quantity
            };
            let what = format!("the unit of the columns, {}", quantity.examples());
            return Err(section.missing(key, what));
        }
    }
    let mut format = with_units(section, format)?;
    format.time_scale = section.unit("time_unit", Quantity::Time, 1.0)?;
    format.date = keys::column(section, "date")?;
    let blanks = section.word("blanks", &[("skip", false), ("interpolate", true)])?;
    format.apart = blanks.unwrap_or(false);
    let shared = section.word("shared_stamps", &[("skip", false), ("spread", true)])?;
    format.spread_shared_stamps = shared.unwrap_or(false);
    if format.apart && format.spread_shared_stamps {
        return Err(section.error(
            "shared_stamps",
            "cannot be \"spread\" beside blanks = \"interpolate\": omit one",
        ));
    }
    Ok(format)
}

/// `"x,-y,-z"`: body forward, right and down, each one of the sensor's axes or its opposite.
pub(crate) fn rotation_of_axes(axes: &str) -> Result<Matrix3, String> {
    let wrong = || format!("\"{axes}\" is not three signed axes, such as \"y,x,-z\"");
    let mut rotation = Matrix3::zeros();
    let parts: Vec<&str> = axes.split(',').map(str::trim).collect();
    if parts.len() != 3 {
        return Err(wrong());
    }
    for (row, part) in parts.iter().enumerate() {
        let (sign, name) = match part.strip_prefix('-') {
            Some(rest) => (-1.0, rest.trim()),
            None => (1.0, part.strip_prefix('+').unwrap_or(part)),
        };
        let column = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return Err(wrong()),
        };
        rotation[(row, column)] = sign;
    }
    let det = rotation.determinant();
    if det == 1.0 {
        Ok(rotation)
    } else if det == -1.0 {
        Err(format!(
            "\"{axes}\" is left-handed: one sign is wrong or two axes are swapped"
        ))
    } else {
        Err(format!("\"{axes}\" contains an axis twice"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(keys: &str) -> Result<ImuFormat, String> {
        let text = format!("[imu]\nfile = \"log\"\n{keys}");
        let parsed = parse(&text, "drive.toml").unwrap();
        let top = Section::top(parsed.get_ref(), &text, "drive.toml");
        let section = top.section("imu").unwrap();
        let read = read_imu(&section, &mut Logs::default());
        read.map(|((_, format), _)| format)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn units_of_logs_that_describe_themselves_may_be_stated() {
        for format in ["ubx", "rosbag", "ulog", "sensor-logger", "sbf"] {
            let of = read(&format!(
                "format = \"{format}\"\ngyro_unit = \"deg/s\"\naccel_unit = \"-g\"\n"
            ));
            let of = of.unwrap();
            assert_eq!(
                of.gyro_scale,
                Vector3::repeat(1f64.to_radians()),
                "{format}"
            );
            assert_eq!(of.accel_scale, Vector3::repeat(-9.806_65), "{format}");
            let si = read(&format!("format = \"{format}\"\n")).unwrap();
            let one = Vector3::repeat(1.0);
            assert_eq!((si.gyro_scale, si.accel_scale), (one, one), "{format}");
        }
        let euroc = read("format = \"euroc\"\naccel_unit = \"g\"\n").unwrap();
        assert_eq!(euroc.accel_scale, Vector3::repeat(9.806_65));
        let wrong = read("format = \"ubx\"\naccel_unit = \"deg/s\"\n").unwrap_err();
        assert!(
            wrong.starts_with("drive.toml line 4, imu.accel_unit: "),
            "{wrong}"
        );
    }

    #[test]
    fn only_what_a_sensor_measures_may_be_reversed() {
        let columns = "time = 1\ngyro = [2, 3, 4]\naccel = [5, 6, 7]\ngyro_unit = \"rad/s\"\n";
        let of = read(&format!("{columns}accel_unit = \"- m/s^2\"\n")).unwrap();
        let one = Vector3::repeat(1.0);
        assert_eq!((of.gyro_scale, of.accel_scale), (one, -one));
        let each = columns.replace("rad/s", "rad/s, -rad/s, mrad/s");
        let of = read(&format!("{each}accel_unit = \"g\"\n")).unwrap();
        assert_eq!(of.gyro_scale, Vector3::new(1.0, -1.0, 1e-3));
        let two = columns.replace("rad/s", "rad/s, -rad/s");
        let wrong = read(&format!("{two}accel_unit = \"g\"\n")).unwrap_err();
        assert_eq!(
            wrong,
            "drive.toml line 6, imu.gyro_unit: \"rad/s, -rad/s\" is neither one unit nor three of x, y, z with commas between them"
        );
        assert!(
            read(&format!(
                "{columns}accel_unit = \"g\"\ntime_unit = \"-s\"\n"
            ))
            .is_err()
        );
        let ticks = read(&format!(
            "{columns}accel_unit = \"g\"\ntime_unit = \"0.1 ms/LSB\"\n"
        ));
        assert!((ticks.unwrap().time_scale - 1e-4).abs() < 1e-18);
    }
}
