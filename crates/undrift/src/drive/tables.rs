//! The tables of `DRIVE.toml`, one function each.

use super::{ConfigError, GnssSource, Section};
use crate::{
    align::{AlignSettings, Heading},
    replay::{GnssUse, QualityStd},
    vehicle::{Constraints, NonHolonomic, Profile},
};
use std::path::{Path, PathBuf};
use toml::de::DeValue;
use undrift_io::{
    gnss::{GnssFormat, Place, PositionFormat, Std, VelocityFormat},
    imu::ImuFormat,
    rtklib::{self, RtklibOptions},
    truth::TruthFormat,
};
use undrift_nav::{
    Matrix3, Vector3,
    attitude::from_rpy,
    earth::Geodetic,
    parameters::{Parameter, Parameters, Prior},
    units::Quantity,
};

/// Whether the third component of a velocity is up.
const VELOCITY_AXES: [(&str, bool); 2] = [("north,east,down", false), ("north,east,up", true)];

pub(super) fn read_span(section: &Section) -> Result<Option<(f64, f64)>, ConfigError> {
    let start = section.quantity("start", Quantity::Time)?;
    let end = section.quantity("end", Quantity::Time)?;
    section.only_known()?;
    if start.is_none() && end.is_none() {
        return Ok(None);
    }
    let span = (
        start.unwrap_or(f64::NEG_INFINITY),
        end.unwrap_or(f64::INFINITY),
    );
    if span.0 >= span.1 {
        return Err(section.error("end", "must be later than span.start"));
    }
    Ok(Some(span))
}

pub(super) fn read_imu(
    section: &Section,
    data: &Path,
    span: Option<(f64, f64)>,
) -> Result<((PathBuf, ImuFormat), bool), ConfigError> {
    let path = data.join(section.file("file")?);
    let need = |key, columns: Option<_>| {
        columns.ok_or_else(|| section.error(key, "missing: the three columns x, y, z"))
    };
    let gyro = need("gyro", section.columns("gyro")?)?;
    let accel = need("accel", section.columns("accel")?)?;
    let mut format = ImuFormat::new(section.column("time")?, gyro, accel);
    format.increments = section
        .word("data", &[("rates", false), ("increments", true)])?
        .unwrap_or(false);
    let (gyro_quantity, accel_quantity) = if format.increments {
        (Quantity::Angle, Quantity::Velocity)
    } else {
        (Quantity::AngularRate, Quantity::Acceleration)
    };
    // A unit wrongly taken for granted is the commonest silent error of this field: it must be said.
    for key in ["gyro_unit", "accel_unit"] {
        if section.get(key).is_none() {
            let quantity = if key == "gyro_unit" {
                gyro_quantity
            } else {
                accel_quantity
            };
            return Err(section.error(
                key,
                format!("missing: the unit of the columns, {}", quantity.examples()),
            ));
        }
    }
    format.gyro_scale = section.unit("gyro_unit", gyro_quantity, 1.0)?;
    format.accel_scale = section.unit("accel_unit", accel_quantity, 1.0)?;
    format.time_scale = section.unit("time_unit", Quantity::Time, 1.0)?;
    format.rate_hz = section.quantity("rate", Quantity::Frequency)?;
    if format.rate_hz.is_some_and(|r| r <= 0.0) {
        return Err(section.error("rate", "must be above 0 Hz"));
    }
    if format.time.is_none() && format.rate_hz.is_none() {
        return Err(section.error(
            "time",
            "missing: give the time column, or rate where there is none",
        ));
    }
    format.time_offset = section
        .quantity("time_offset", Quantity::Time)?
        .unwrap_or(0.0);
    format.delimiter = read_delimiter(section)?;
    let estimate_mounting = match section.get("mounting") {
        Some((DeValue::String(text), _)) => text.trim() == "auto",
        _ => false,
    };
    let mounting = match estimate_mounting {
        true => None,
        false => section.vector("mounting", Quantity::Angle)?,
    };
    if estimate_mounting {
        for key in ["axes", "gyro_offset", "accel_offset"] {
            if section.get(key).is_some() {
                let message = "is along body axes, which are not known before the mounting is: \
                               leave it out, or give imu.mounting as angles";
                return Err(section.error(key, message));
            }
        }
    }
    format.rotation = match (section.text("axes")?, mounting) {
        (Some(_), Some(_)) => {
            return Err(section.error("mounting", "give axes or mounting, not both"));
        }
        (Some(axes), None) => rotation_of_axes(axes).map_err(|m| section.error("axes", m))?,
        (None, Some(rpy)) => from_rpy(&rpy).to_rotation_matrix().into_inner(),
        (None, None) => Matrix3::identity(),
    };
    format.gyro_offset = section
        .vector("gyro_offset", Quantity::AngularRate)?
        .unwrap_or_else(Vector3::zeros);
    format.accel_offset = section
        .vector("accel_offset", Quantity::Acceleration)?
        .unwrap_or_else(Vector3::zeros);
    format.span = span;
    section.only_known()?;
    Ok(((path, format), estimate_mounting))
}

pub(super) fn read_delimiter(section: &Section) -> Result<Option<u8>, ConfigError> {
    match section.text("delimiter")? {
        None => Ok(None),
        Some(text) if text.len() == 1 => Ok(text.bytes().next()),
        Some(text) => Err(section.error("delimiter", format!("\"{text}\" is not one character"))),
    }
}

/// `"x,-y,-z"`: body forward, right and down, each one of the sensor's axes or its opposite.
fn rotation_of_axes(axes: &str) -> Result<Matrix3, String> {
    let wrong = || format!("\"{axes}\" is not three of x, y, z with signs, such as \"y,x,-z\"");
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
        Err(format!("\"{axes}\" names an axis twice"))
    }
}

/// `use = "position"`: which parts of a fix are taken.
pub(super) fn read_use(section: &Section) -> Result<GnssUse, ConfigError> {
    let words = [
        ("both", GnssUse::Both),
        ("position", GnssUse::Position),
        ("velocity", GnssUse::Velocity),
    ];
    Ok(section.word("use", &words)?.unwrap_or_default())
}

pub(super) fn read_gnss(
    section: &Section,
    data: &Path,
    span: Option<(f64, f64)>,
) -> Result<(PathBuf, GnssSource), ConfigError> {
    let path = data.join(section.file("file")?);
    let is_rtklib = match section.word("format", &[("csv", false), ("rtklib", true)])? {
        Some(stated) => stated,
        None => rtklib::detect(&path).unwrap_or(false),
    };
    let time_offset = section
        .quantity("time_offset", Quantity::Time)?
        .unwrap_or(0.0);
    let position_std_factor = section.factor("position_std_factor")?.unwrap_or(1.0);
    let velocity_std_factor = section.factor("velocity_std_factor")?.unwrap_or(1.0);
    let base = read_base(section)?;
    let _ = ["lever_arm", "gate", "adapt", "quality_std_factors"].map(|key| section.get(key));
    let source = if is_rtklib {
        GnssSource::Rtklib(RtklibOptions {
            time_offset,
            position_std_factor,
            velocity_std_factor,
            position_std: section
                .vector("position_std", Quantity::Length)?
                .map(|v| [v.x, v.y, v.z]),
            velocity_std: section
                .vector("velocity_std", Quantity::Velocity)?
                .map(|v| [v.x, v.y, v.z]),
            base,
            span,
        })
    } else {
        let time = section
            .column("time")?
            .ok_or_else(|| section.error("time", "missing: the time column"))?;
        let angle_scale = section.unit("position_unit", Quantity::Angle, 1f64.to_radians())?;
        let place = match (section.columns("position")?, section.columns("baseline")?) {
            (Some(_), Some(_)) => {
                return Err(section.error("baseline", "give position or baseline, not both"));
            }
            (Some([lat, lon, height]), None) => Some(Place::Geodetic {
                lat,
                lon,
                height,
                angle_scale,
            }),
            (None, Some(ned)) => Some(Place::Baseline {
                ned,
                base: base.ok_or_else(|| {
                    section.error(
                        "base",
                        "missing: the base station of the baseline, \"LAT deg, LON deg, HEIGHT m\"",
                    )
                })?,
            }),
            (None, None) => None,
        };
        let position_std = read_stds(
            section,
            "position_std",
            "position_std_columns",
            Quantity::Length,
        )?;
        let position = match place {
            None => None,
            Some(place) => Some(PositionFormat {
                place,
                std: position_std.ok_or_else(|| {
                    section.error("position_std", "missing: the file's columns (position_std_columns) or \"north, east, down m\"")
                })?,
                std_factor: position_std_factor,
            }),
        };
        let up = section
            .word("velocity_axes", &VELOCITY_AXES)?
            .unwrap_or(false);
        let velocity_std = read_stds(
            section,
            "velocity_std",
            "velocity_std_columns",
            Quantity::Velocity,
        )?;
        let velocity = match section.columns("velocity")? {
            None => None,
            Some(columns) => Some(VelocityFormat {
                columns,
                up,
                std: velocity_std.ok_or_else(|| {
                    section.error("velocity_std", "missing: the file's columns (velocity_std_columns) or \"north, east, down m/s\"")
                })?,
                std_factor: velocity_std_factor,
            }),
        };
        GnssSource::Csv(Box::new(GnssFormat {
            time,
            time_scale: section.unit("time_unit", Quantity::Time, 1.0)?,
            time_offset,
            position,
            velocity,
            quality: section.column("quality")?,
            delimiter: read_delimiter(section)?,
            span,
        }))
    };
    let asked = read_use(section)?;
    if let GnssSource::Csv(format) = &source {
        if format.position.is_none() {
            return Err(section.error("position", "missing: the columns latitude, longitude, height, or baseline; a solution starts at a position"));
        }
        if asked == GnssUse::Velocity && format.velocity.is_none() {
            return Err(section.error(
                "use",
                "\"velocity\" needs the velocity's columns: give gnss.velocity",
            ));
        }
    }
    section.only_known()?;
    Ok((path, source))
}

/// `quality_std_factors = { float = 10 }`; without it a standard deviation stated for the whole log is at
/// least the typical one of a fix's kind.
pub(super) fn read_quality(section: &Section) -> Result<QualityStd, ConfigError> {
    let factors = section.section("quality_std_factors")?;
    if !factors.exists() {
        return Ok(match section.get("position_std") {
            Some(_) => QualityStd::Typical,
            None => QualityStd::AsStated,
        });
    }
    let mut values = [1.0; 4];
    for (value, key) in values
        .iter_mut()
        .zip(["fixed", "float", "differential", "single"])
    {
        *value = factors.factor(key)?.unwrap_or(1.0);
    }
    factors.only_known()?;
    Ok(QualityStd::Factors(values))
}

/// `base = "40.0966 deg, -105.1474 deg, 1601.5 m"`.
fn read_base(section: &Section) -> Result<Option<Geodetic>, ConfigError> {
    let Some(text) = section.text("base")? else {
        return Ok(None);
    };
    let wrong = |e: &dyn std::fmt::Display| section.error("base", format!("\"{text}\": {e}"));
    let parts: Vec<&str> = text.split(',').collect();
    let [lat, lon, height] = parts.as_slice() else {
        return Err(wrong(&"expected \"LAT deg, LON deg, HEIGHT m\""));
    };
    let angle = |s: &str| undrift_nav::units::parse(s, Quantity::Angle).map_err(|e| wrong(&e));
    let base = Geodetic {
        lat: angle(lat)?,
        lon: angle(lon)?,
        height: undrift_nav::units::parse(height, Quantity::Length).map_err(|e| wrong(&e))?,
    };
    if base.is_valid() {
        Ok(Some(base))
    } else {
        Err(wrong(&"is not a place on the Earth"))
    }
}

fn read_stds<'a>(
    section: &Section<'a>,
    constant: &'a str,
    columns: &'a str,
    quantity: Quantity,
) -> Result<Option<Std>, ConfigError> {
    match (
        section.vector(constant, quantity)?,
        section.columns(columns)?,
    ) {
        (Some(_), Some(_)) => {
            Err(section.error(columns, format!("give {constant} or {columns}, not both")))
        }
        (Some(v), None) if v.iter().any(|s| *s <= 0.0) => {
            Err(section.error(constant, "standard deviations must be above zero"))
        }
        (Some(v), None) => Ok(Some(Std::Constant([v.x, v.y, v.z]))),
        (None, Some(columns)) => Ok(Some(Std::Columns(columns))),
        (None, None) => Ok(None),
    }
}

pub(super) fn read_truth(
    section: &Section,
    data: &Path,
) -> Result<Option<(PathBuf, TruthFormat)>, ConfigError> {
    if !section.exists() {
        return Ok(None);
    }
    let path = data.join(section.file("file")?);
    let time = section
        .column("time")?
        .ok_or_else(|| section.error("time", "missing: the time column"))?;
    let position = section.columns("position")?.ok_or_else(|| {
        section.error(
            "position",
            "missing: the columns latitude, longitude, height",
        )
    })?;
    let degree = 1f64.to_radians();
    let format = TruthFormat {
        time,
        time_scale: section.unit("time_unit", Quantity::Time, 1.0)?,
        time_offset: section
            .quantity("time_offset", Quantity::Time)?
            .unwrap_or(0.0),
        position,
        angle_scale: section.unit("position_unit", Quantity::Angle, degree)?,
        velocity: section.columns("velocity")?,
        attitude: section.columns("attitude")?,
        attitude_scale: section.unit("attitude_unit", Quantity::Angle, degree)?,
        delimiter: read_delimiter(section)?,
        velocity_up: section
            .word("velocity_axes", &VELOCITY_AXES)?
            .unwrap_or(false),
        span: None,
    };
    section.only_known()?;
    Ok(Some((path, format)))
}

pub(crate) fn read_initial(section: &Section) -> Result<AlignSettings, ConfigError> {
    let mut align = AlignSettings::default();
    let degrees = |d: f64| d.to_radians();
    let attitude = section.vector("attitude", Quantity::Angle)?;
    let attitude_std = section
        .vector("attitude_std", Quantity::Angle)?
        .unwrap_or_else(|| Vector3::new(degrees(1.0), degrees(1.0), degrees(3.0)));
    align.attitude = attitude.map(|a| (a, attitude_std));
    let velocity_std = section
        .vector("velocity_std", Quantity::Velocity)?
        .unwrap_or_else(|| Vector3::repeat(0.1));
    align.velocity = section
        .vector("velocity", Quantity::Velocity)?
        .map(|v| (v, velocity_std));
    let heading_std = section
        .quantity("heading_std", Quantity::Angle)?
        .unwrap_or(degrees(3.0));
    align.heading = match section.text("heading")? {
        None | Some("course") => Heading::Course,
        Some("auto") => Heading::Auto,
        Some(text) => match undrift_nav::units::parse(text, Quantity::Angle) {
            Ok(angle) => Heading::Given(angle, heading_std),
            Err(e) => {
                let message =
                    format!("\"{text}\" is neither \"course\" nor \"auto\" nor an angle: {e}");
                return Err(section.error("heading", message));
            }
        },
    };
    if let Some(speed) = section.quantity("min_speed", Quantity::Velocity)? {
        align.min_speed = speed;
    }
    if [attitude_std, velocity_std]
        .iter()
        .any(|v| v.iter().any(|s| *s < 0.0))
        || heading_std < 0.0
    {
        return Err(section.error("attitude_std", "standard deviations must not be negative"));
    }
    section.only_known()?;
    Ok(align)
}

/// `gate = true`.
pub(super) fn read_switch<'a>(
    section: &Section<'a>,
    key: &'a str,
) -> Result<Option<bool>, ConfigError> {
    match section.get(key) {
        None => Ok(None),
        Some((toml::de::DeValue::Boolean(on), _)) => Ok(Some(*on)),
        Some(_) => Err(section.error(key, "must be true or false")),
    }
}

/// A standard deviation that switches something on, `"off"`, or else the one given.
pub(super) fn read_std<'a>(
    section: &Section<'a>,
    key: &'a str,
    quantity: Quantity,
    otherwise: Option<f64>,
) -> Result<Option<f64>, ConfigError> {
    let std = match section.get(key) {
        Some((toml::de::DeValue::String(text), _)) if text == "off" => return Ok(None),
        Some((toml::de::DeValue::String(_), _)) => section.quantity(key, quantity)?,
        // A pure number needs no quotes.
        Some(_) if quantity == Quantity::Dimensionless => section.factor(key)?,
        _ => section.quantity(key, quantity)?,
    };
    match std {
        Some(std) if std > 0.0 => Ok(Some(std)),
        Some(_) => Err(section.error(key, "must be a standard deviation above zero, or \"off\"")),
        None => Ok(otherwise),
    }
}

/// How well a vehicle's axes are known from a mounting given by hand [rad], and the place of the axle
/// along it [m], given and not.
const MOUNTING_STD: f64 = 0.05;
const AXLE_STD_GIVEN: f64 = 0.3;
const AXLE_STD: f64 = 2.0;

/// How far the clocks of GNSS and IMU may be apart in a car's log [s].
const TIME_OFFSET_STD: f64 = 0.1;

/// The constraints, and the parameters that they ask for.
pub(super) fn read_vehicle(section: &Section) -> Result<(Constraints, Parameters), ConfigError> {
    let words = [
        ("none", Profile::None),
        ("car", Profile::Car),
        ("aircraft", Profile::Aircraft),
        ("pedestrian", Profile::Pedestrian),
    ];
    let profile = section.word("profile", &words)?.unwrap_or_default();
    let mut constraints = profile.constraints();
    let length = |key| -> Result<Vector3, ConfigError> {
        let lever = section.vector(key, Quantity::Length)?;
        Ok(lever.unwrap_or_else(Vector3::zeros))
    };
    let slip = constraints.non_holonomic.map(|rule| rule.right);
    let lever = length("axle")?;
    constraints.non_holonomic =
        read_std(section, "non_holonomic", Quantity::Velocity, slip)?.map(|std| NonHolonomic {
            right: std,
            down: std * NonHolonomic::CAR.down / NonHolonomic::CAR.right,
            lever,
            ..NonHolonomic::CAR
        });
    constraints.zero_velocity = read_std(
        section,
        "zero_velocity",
        Quantity::Velocity,
        constraints.zero_velocity,
    )?;
    constraints.zero_angular_rate = read_std(
        section,
        "zero_angular_rate",
        Quantity::AngularRate,
        constraints.zero_angular_rate,
    )?;
    let min_speed = section.quantity("course_min_speed", Quantity::Velocity)?;
    constraints.course = read_std(section, "course", Quantity::Angle, None)?
        .map(|std| (std, min_speed.unwrap_or(5.0)));
    constraints.odometer_lever = length("odometer_wheel")?;
    let needed = constraints.non_holonomic.is_some();
    let unless = |std: f64| needed.then_some(std);
    let mounting = read_std(
        section,
        "mounting_std",
        Quantity::Angle,
        unless(MOUNTING_STD),
    )?;
    let axle = if section.get("axle").is_some() {
        AXLE_STD_GIVEN
    } else {
        AXLE_STD
    };
    let axle = read_std(section, "axle_std", Quantity::Length, unless(axle))?;
    section.only_known()?;
    let mut parameters = Parameters::none();
    let time_offset = (profile == Profile::Car).then_some(TIME_OFFSET_STD);
    for (kind, std) in [
        (Parameter::Mounting, mounting),
        (Parameter::Axle, axle),
        (Parameter::TimeOffset, time_offset),
    ] {
        if let Some(std) = std {
            parameters = parameters.with(kind, Prior { std, walk: 0.0 });
        }
    }
    Ok((constraints, parameters))
}

/// The parameters estimated beside those given, by their standard deviations.
pub(super) fn read_states(
    section: &Section,
    mut parameters: Parameters,
) -> Result<Parameters, ConfigError> {
    let std = |key, quantity| read_std(section, key, quantity, None);
    if section.get("time_offset").is_some() {
        parameters = parameters.without(Parameter::TimeOffset);
    }
    for (kinds, std) in [
        (
            &[Parameter::GyroScale, Parameter::AccelScale][..],
            std("scale_factor", Quantity::Dimensionless)?,
        ),
        (
            &[Parameter::GyroMisalignment, Parameter::AccelMisalignment],
            std("misalignment", Quantity::Angle)?,
        ),
        (&[Parameter::LeverArm], std("lever_arm", Quantity::Length)?),
        (
            &[Parameter::TimeOffset],
            std("time_offset", Quantity::Time)?,
        ),
    ] {
        let Some(std) = std else { continue };
        for kind in kinds {
            parameters = parameters.with(*kind, Prior { std, walk: 0.0 });
        }
    }
    section.only_known()?;
    Ok(parameters)
}
