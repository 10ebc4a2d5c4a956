//! The table `[gnss]` of `DRIVE.toml`.

use super::{
    error::{ConfigError, DriveError},
    keys::{self, PlaceUnit},
    logs::Logs,
    tables::{VELOCITY_AXES, read_delimiter},
};
use crate::{
    replay::{GnssUse, QualityStd},
    settings::fix_errors::{Correlated, Correlation, StdFactors},
};
use std::path::PathBuf;
use undrift_config::Section;
use undrift_io::{
    format::Format,
    gnss::{FixOptions, GnssFormat, GnssLog, GnssSource, PositionColumns, VelocityAxes},
    layouts,
    table::Column,
};
use undrift_nav::{
    earth::Geodetic,
    parameters::Prior,
    units::{self, Quantity},
};

/// `use = "position"`: which parts of a fix are taken.
pub(super) fn read_use(section: &Section) -> Result<GnssUse, ConfigError> {
    let words = [
        ("both", GnssUse::Both),
        ("position", GnssUse::Position),
        ("velocity", GnssUse::Velocity),
    ];
    Ok(section.word("use", &words)?.unwrap_or_default())
}

pub(crate) fn read_gnss(
    section: &Section,
    logs: &mut Logs,
) -> Result<(PathBuf, GnssSource), DriveError> {
    let path = logs.named(section)?;
    let span = logs.span;
    let (format, width) = logs.format(section, &path, "time")?;
    let time_offset = section
        .quantity("time_offset", Quantity::Time)?
        .unwrap_or(0.0);
    let factor = |key| Ok::<_, ConfigError>(section.factor(key)?.unwrap_or(1.0));
    let (position_std_factor, velocity_std_factor) = (
        factor("position_std_factor")?,
        factor("velocity_std_factor")?,
    );
    let _ = [
        "lever_arm",
        "gate",
        "adapt",
        "quality_std_factors",
        "correlation_time",
        "correlated_share",
        "smoothing",
        "std_factors",
    ]
    .map(|key| section.get(key));
    let observations = logs.beside(section, "observations")?;
    let fixes = || -> Result<FixOptions, ConfigError> {
        Ok(FixOptions {
            time_offset,
            position_std: constant_std(section, "position_std", Quantity::Length)?,
            velocity_std: constant_std(section, "velocity_std", Quantity::Velocity)?,
            position_std_factor,
            velocity_std_factor,
            span,
            observations: observations.clone(),
        })
    };
    let source = match format {
        log if log.is_log() => GnssSource::Log(GnssLog {
            position: section.text("topic")?.map(str::to_owned),
            velocity: section.text("velocity_topic")?.map(str::to_owned),
            base: read_base(section)?,
            fixes: fixes()?,
            ..GnssLog::new(log)
        }),
        Format::KfGins => GnssSource::Table(Box::new(GnssFormat {
            fixes: fixes()?,
            ..layouts::kf_gins_gnss(width)
        })),
        Format::Euroc => {
            return Err(section
                .error("file", "an EuRoC inertial log has no fixes")
                .into());
        }
        _ => GnssSource::Table(Box::new(read_columns(section, fixes()?)?)),
    };
    let asked = read_use(section)?;
    if let GnssSource::Table(format) = &source {
        if format.place.is_none() {
            return Err(section.missing("position", "set position (columns latitude, longitude, height), ecef or baseline; a solution needs a start position").into());
        }
        if asked == GnssUse::Velocity && format.velocity.is_none() {
            return Err(section
                .error(
                    "use",
                    "\"velocity\" needs velocity columns: set gnss.velocity",
                )
                .into());
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

/// Share of the variance where only the time is given.
const SHARE: f64 = 0.95;

/// `correlation_time = "60 s"`, `"auto"` or `"off"`, with `correlated_share = 0.95`.
pub(super) fn read_correlation(section: &Section) -> Result<Correlation, ConfigError> {
    let share = section.factor("correlated_share")?;
    if share.is_some_and(|share| share >= 1.0) {
        return Err(section.error(
            "correlated_share",
            "must be below 1: some of the error is white",
        ));
    }
    let given = match section.text("correlation_time")? {
        None | Some("auto") => Correlation::Auto,
        Some("off") => Correlation::Off,
        Some(_) => {
            let time = section.quantity("correlation_time", Quantity::Time)?;
            let time = time.filter(|time| *time > 0.0).ok_or_else(|| {
                section.error("correlation_time", "must be positive, \"auto\" or \"off\"")
            })?;
            let share = share.unwrap_or(SHARE);
            return Ok(Correlation::Given(Correlated { share, time }));
        }
    };
    match share {
        Some(_) => Err(section.error("correlated_share", "needs a correlation_time")),
        None => Ok(given),
    }
}

/// `smoothing = "0.3 s"`: about the time constant of the receiver's own filter, by the prior that it gives to
/// [`Parameter::Smoothing`](undrift_nav::parameters::Parameter::Smoothing).
pub(super) fn read_smoothing(section: &Section) -> Result<Option<Prior>, ConfigError> {
    match section.quantity("smoothing", Quantity::Time)? {
        Some(time) if time <= 0.0 => Err(section.error("smoothing", "must be positive")),
        time => Ok(time.map(|time| Prior::constant(0.5 * time * time))),
    }
}

/// `std_factors = { position = 0.8, position_correlated = 1.2 }`, what `undrift tune` writes; of poses the attitude is in the place of the
/// velocity.
pub(super) fn read_std_factors(section: &Section, poses: bool) -> Result<StdFactors, ConfigError> {
    let factors = section.section("std_factors")?;
    let factor = |key| {
        let factor = factors.factor(key)?;
        match factor {
            Some(factor) if factor <= 0.0 => Err(factors.error(key, "must be positive")),
            given => Ok(given.unwrap_or(1.0)),
        }
    };
    let read = StdFactors {
        white: [
            factor("position")?,
            factor(if poses { "attitude" } else { "velocity" })?,
        ],
        correlated: [
            factor("position_correlated")?,
            factor(if poses {
                "attitude_correlated"
            } else {
                "velocity_correlated"
            })?,
        ],
    };
    factors.only_known()?;
    Ok(read)
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
    let angle = |s: &str| units::parse(s, Quantity::Angle).map_err(|e| wrong(&e));
    let base = Geodetic {
        lat: angle(lat)?,
        lon: angle(lon)?,
        height: units::parse(height, Quantity::Length).map_err(|e| wrong(&e))?,
    };
    if base.is_valid() {
        Ok(Some(base))
    } else {
        Err(wrong(&"is not a position on Earth"))
    }
}

/// The columns of standard deviations, in whose place `stated` ones may stand.
fn read_stds<'a>(
    section: &Section<'a>,
    (constant, stated): (&'a str, Option<[f64; 3]>),
    columns: &'a str,
    unit: &str,
) -> Result<Option<[Column; 3]>, ConfigError> {
    match (stated, keys::columns(section, columns)?) {
        (Some(_), Some(_)) => {
            Err(section.error(columns, format!("set {constant} or {columns}, not both")))
        }
        (None, None) => Err(section.missing(
            constant,
            format!("the file's columns ({columns}) or \"north, east, down {unit}\""),
        )),
        (_, columns) => Ok(columns),
    }
}

/// The columns of the velocity and its axes: `velocity`, or `speed` and `course` with `vertical_velocity` or without.
fn read_velocity(section: &Section) -> Result<(Option<[Column; 3]>, VelocityAxes), ConfigError> {
    let velocity = keys::columns(section, "velocity")?;
    let axes = section.word("velocity_axes", &VELOCITY_AXES)?;
    let [speed, course, vertical] =
        ["speed", "course", "vertical_velocity"].map(|key| keys::column(section, key));
    let (speed, course, vertical) = (speed?, course?, vertical?);
    let polar = match (speed, course) {
        (None, None) if vertical.is_some() => {
            return Err(section.missing("speed", "needed with vertical_velocity"));
        }
        (None, None) => return Ok((velocity, axes.unwrap_or_default())),
        _ if velocity.is_some() => {
            return Err(section.error("speed", "set velocity, or speed and course, not both"));
        }
        (Some(_), None) => return Err(section.missing("course", "needed with speed")),
        (None, Some(_)) => return Err(section.missing("speed", "needed with course")),
        (Some(speed), Some(course)) => [speed, course],
    };
    let third = vertical.clone().unwrap_or_else(|| polar[0].clone());
    let axes = match (vertical, axes) {
        (None, None) => VelocityAxes::Course,
        (None, Some(_)) => {
            let wrong = "speed and course have no axes: remove it, or set vertical_velocity";
            return Err(section.error("velocity_axes", wrong));
        }
        (Some(_), None | Some(VelocityAxes::Down)) => VelocityAxes::CourseDown,
        (Some(_), Some(VelocityAxes::Up)) => VelocityAxes::CourseUp,
        (Some(_), Some(_)) => {
            let wrong = "a vertical velocity is \"north,east,down\" or \"north,east,up\"";
            return Err(section.error("velocity_axes", wrong));
        }
    };
    let [speed, course] = polar;
    Ok((Some([speed, course, third]), axes))
}

/// The fixes in named columns of a table.
fn read_columns(section: &Section, fixes: FixOptions) -> Result<GnssFormat, ConfigError> {
    let time =
        keys::column(section, "time")?.ok_or_else(|| section.missing("time", "the time column"))?;
    let unit = keys::place_unit(section, "position_unit")?;
    let height_scale = section.unit("height_unit", Quantity::Length, 1.0)?;
    let ecef = keys::columns(section, "ecef")?;
    let height = section.quantity("height", Quantity::Length)?;
    let position = match height {
        Some(_) => keys::two_columns(section, "position")?,
        None => keys::columns(section, "position")?,
    };
    let place = match (position, keys::columns(section, "baseline")?) {
        (Some(_), Some(_)) => {
            return Err(section.error("baseline", "set position or baseline, not both"));
        }
        (Some(_), _) | (_, Some(_)) if ecef.is_some() => {
            return Err(section.error("ecef", "set only one of position, baseline and ecef"));
        }
        (Some(columns), None) => Some(match unit {
            PlaceUnit::Utm(zone) => PositionColumns::Utm {
                columns,
                zone,
                height_scale,
                height,
            },
            PlaceUnit::Angle(_) | PlaceUnit::DegreesMinutes => PositionColumns::Geodetic {
                columns,
                angle_scale: match unit {
                    PlaceUnit::Angle(scale) => scale,
                    _ => 1f64.to_radians(),
                },
                degrees_minutes: unit == PlaceUnit::DegreesMinutes,
                height_scale,
                height,
            },
        }),
        (None, Some(ned)) => Some(PositionColumns::Baseline {
            ned,
            base: read_base(section)?.ok_or_else(|| {
                section.missing(
                    "base",
                    "the base station of the baseline, \"LAT deg, LON deg, HEIGHT m\"",
                )
            })?,
        }),
        (None, None) => ecef.map(PositionColumns::Ecef),
    };
    let (velocity, velocity_axes) = read_velocity(section)?;
    let stds = |wanted: bool, stated, columns, unit| match wanted {
        true => read_stds(section, stated, columns, unit),
        false => keys::columns(section, columns).map(|_| None),
    };
    let stated = ("position_std", fixes.position_std);
    let position_std = stds(place.is_some(), stated, "position_std_columns", "m")?;
    let stated = ("velocity_std", fixes.velocity_std);
    let velocity_std = stds(velocity.is_some(), stated, "velocity_std_columns", "m/s")?;
    Ok(GnssFormat {
        time,
        date: keys::column(section, "date")?,
        time_scale: section.unit("time_unit", Quantity::Time, 1.0)?,
        place,
        position_std,
        velocity,
        velocity_axes,
        velocity_scale: section.unit("velocity_unit", Quantity::Velocity, 1.0)?,
        velocity_std,
        quality: keys::column(section, "quality")?,
        delimiter: read_delimiter(section)?,
        fixes,
    })
}

/// Three standard deviations above zero for every fix.
pub(super) fn constant_std<'a>(
    section: &Section<'a>,
    key: &'a str,
    quantity: Quantity,
) -> Result<Option<[f64; 3]>, ConfigError> {
    match section.vector(key, quantity)? {
        Some(v) if v.iter().any(|std| *std <= 0.0) => {
            Err(section.error(key, "standard deviations must be positive"))
        }
        other => Ok(other.map(|v| [v.x, v.y, v.z])),
    }
}
