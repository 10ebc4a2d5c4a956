//! The tables of sensors that measure one number, and all that is different from one such sensor to the other.

use super::{
    Drive,
    error::{ConfigError, DriveError},
    keys,
    logs::Logs,
    tables::{read_delimiter, read_std},
};
use std::{
    f64::consts::TAU,
    ops::{Index, IndexMut},
    path::PathBuf,
};
use undrift_config::Section;
pub use undrift_engine::ScalarLog;
use undrift_io::{
    scalar::{Reading, ScalarFormat, ScalarStd},
    table::Column,
};
use undrift_nav::{
    parameters::{Parameter, Parameters, Prior},
    sample::Scalar,
    units::Quantity,
};

/// Standard deviation of a wheel speed beyond its scale factor [m/s], and of the scale factor [–].
const SPEED_STD: f64 = 0.1;
const SCALE_STD: f64 = 0.03;
/// Speeds that a wheel can have [m/s].
const SPEEDS: (f64, f64) = (-150.0, 150.0);
/// Standard deviation of a barometric height \[m\]: gusts, doors, ventilation.
const HEIGHT_STD: f64 = 1.0;
/// Weather and the geoid's height make an error of this size \[m\] …
const BIAS_STD: f64 = 100.0;
/// … and weather and the air's temperature on slopes change it by this [m/√s].
const BIAS_WALK: f64 = 0.1;
/// Heights of the standard atmosphere's lowest layer \[m\].
const HEIGHTS: (f64, f64) = (-1000.0, 11_000.0);
/// Standard deviation of a heading by two antennas whose receiver states none \[rad\]: 0.5°, as of half a metre.
const HEADING_STD: f64 = 0.0087;
/// How well a stated direction of the antennas is known \[rad\]: 1°, as by eye; and one that is not stated, which may be any.
const BASELINE_STD: f64 = 0.0175;
const ANY: f64 = 1.8;
/// Headings, of whatever turn \[rad\].
const HEADINGS: (f64, f64) = (-TAU, TAU);

/// A log of one number: its file, and the columns or stream and units of it.
pub type Source = (PathBuf, ScalarFormat);

/// Reads a log's table of the drive file.
type ReadSection = fn(&Section, &mut Logs, Parameters) -> Result<(Source, Parameters), DriveError>;

/// All that is different in drive files from one to the other.
pub(super) struct About {
    /// Numbers that it can have, in SI units.
    pub(super) range: (f64, f64),
    read: ReadSection,
    /// The parameters with the one that it asks for where no more is known of it.
    pub(super) by_default: fn(Parameters) -> Parameters,
}

/// What is different of a sensor; its table in a drive file has the sensor's name.
pub(super) fn about(log: ScalarLog) -> About {
    match log {
        ScalarLog::Odometer => About {
            range: SPEEDS,
            read: read_odometer,
            by_default: |parameters| of_odometer(parameters, SCALE_STD),
        },
        ScalarLog::Barometer => About {
            range: HEIGHTS,
            read: read_barometer,
            by_default: |parameters| of_barometer(parameters, BIAS_STD, BIAS_WALK),
        },
        ScalarLog::Heading => About {
            range: HEADINGS,
            read: read_heading,
            by_default: |parameters| of_heading(parameters, ANY),
        },
    }
}

/// The logs of a drive by sensor: `scalars[ScalarLog::Odometer]`, `None` where the drive has no such log.
#[derive(Clone, Debug, Default)]
pub struct Scalars([Option<Source>; ScalarLog::ALL.len()]);

impl Scalars {
    /// The logs of all sensors, in the order of [`ScalarLog::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = &Option<Source>> {
        self.0.iter()
    }

    /// The logs of all sensors, in the order of [`ScalarLog::ALL`], to be changed.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut Option<Source>> {
        self.0.iter_mut()
    }
}

impl Index<ScalarLog> for Scalars {
    type Output = Option<Source>;

    fn index(&self, log: ScalarLog) -> &Option<Source> {
        &self.0[log as usize]
    }
}

impl IndexMut<ScalarLog> for Scalars {
    fn index_mut(&mut self, log: ScalarLog) -> &mut Option<Source> {
        &mut self.0[log as usize]
    }
}

impl Drive {
    /// This drive with wheel speeds in memory, forward positive \[m/s\], in order of time; the wheel at the IMU unless
    /// [`Constraints::odometer_lever`](crate::vehicle::Constraints::odometer_lever) is set.
    pub fn with_odometer(self, speeds: &[Scalar]) -> Self {
        self.with_scalars(ScalarLog::Odometer, speeds)
    }

    /// This drive with barometric heights in memory, up positive \[m\], in order of time.
    ///
    /// ```
    /// # use undrift_drive as undrift;
    /// use undrift::{Drive, drive::ScalarLog, nav::parameters::Parameter, replay::Scalar};
    /// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
    /// # let log = simulate(&Trajectory::car(5.0, 1), 50.0, None, &GnssNoise::default(), 1)?;
    /// let heights: Vec<Scalar> = (0..50).map(|k| Scalar { time: 0.1 * f64::from(k), value: 412.0, std: 1.0 }).collect();
    /// let drive = Drive::from_samples(&log.imu, &log.gnss).with_barometer(&heights);
    /// // Its offset to the ellipsoid is estimated.
    /// assert!(drive.scalars[ScalarLog::Barometer].is_some() && drive.parameters.prior(Parameter::BarometerBias).is_some());
    /// # Ok::<(), undrift_simulate::SimulationError>(())
    /// ```
    pub fn with_barometer(self, heights: &[Scalar]) -> Self {
        self.with_scalars(ScalarLog::Barometer, heights)
    }

    /// This drive with headings by two antennas in memory, from north to east \[rad\], in order of time; the second is seen from the first
    /// in the direction `baseline` in the body, from forward to right \[rad\], to 1°. Without it that is estimated in motion.
    ///
    /// ```
    /// # use undrift_drive as undrift;
    /// use undrift::{Drive, navigate::{Wanted, navigate}};
    /// # use undrift_noise::{BiasModel, ImuModel};
    /// # use undrift_simulate::{DualAntenna, GnssNoise, Trajectory, simulate};
    /// # let model = ImuModel::preset("adis16465").expect("a preset");
    /// # let sensors = model.shaping(BiasModel::GaussMarkov, 0.02)?;
    /// # let car = Trajectory::rest(20.0);
    /// # let log = simulate(&car, 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
    /// # let headings: Vec<_> = DualAntenna { baseline: 1.57, ..DualAntenna::default() }.measure(&car, 1)?.collect();
    /// // A car that is parked, the second antenna on the right.
    /// let drive = Drive { model: Some(model), ..Drive::from_samples(&log.imu, &log.gnss) };
    /// let drive = drive.with_heading(&headings, Some(90f64.to_radians()));
    /// let summary = navigate(&drive, BiasModel::GaussMarkov, Wanted::default())?.summary;
    /// assert!(summary.started.expect("aligned") <= 5.0 && summary.alignment.expect("so").heading_std < 0.03);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_heading(mut self, headings: &[Scalar], baseline: Option<f64>) -> Self {
        self = self.with_scalars(ScalarLog::Heading, headings);
        if let Some(baseline) = baseline {
            self.constraints.heading_baseline = baseline;
            self.parameters = of_heading(self.parameters, BASELINE_STD);
        }
        self
    }
}

/// The tables that there are, and the parameters with those that they ask for.
pub(super) fn read(
    top: &Section,
    logs: &mut Logs,
    mut parameters: Parameters,
) -> Result<(Scalars, Parameters), DriveError> {
    let mut scalars = Scalars::default();
    for log in ScalarLog::ALL {
        let section = top.section(log.name())?;
        if section.exists() {
            let (source, asked) = (about(log).read)(&section, logs, parameters)?;
            scalars[log] = Some(source);
            parameters = asked;
        }
    }
    Ok((scalars, parameters))
}

/// `[odometer]`, and the parameters with the one that it asks for.
fn read_odometer(
    section: &Section,
    logs: &mut Logs,
    mut parameters: Parameters,
) -> Result<(Source, Parameters), DriveError> {
    let path = logs.named(section)?;
    let per_metre = section.factor("ticks_per_metre")?;
    let unit = section.unit("speed_unit", Quantity::Velocity, 1.0)?;
    let (value, reading, std_unit) = match (
        keys::column(section, "speed")?,
        keys::column(section, "ticks")?,
    ) {
        (Some(_), Some(_)) => {
            return Err(section
                .error("ticks", "set speed or ticks, not both")
                .into());
        }
        (None, None) => {
            let what = "the column of the wheel's speed, or ticks for a running count";
            return Err(section.missing("speed", what).into());
        }
        (Some(speed), None) => {
            if section.get("speed_unit").is_none() {
                let examples = Quantity::Velocity.examples();
                let what = format!("the unit of the column, {examples}");
                return Err(section.missing("speed_unit", what).into());
            }
            (("speed", speed), Reading::Scaled(unit), unit)
        }
        (None, Some(ticks)) => {
            let per_metre =
                per_metre.ok_or_else(|| section.missing("ticks_per_metre", "ticks per metre"))?;
            (("ticks", ticks), Reading::Count(1.0 / per_metre), 1.0)
        }
    };
    let keys = ("speed_std", "speed_std_column");
    let std = read_scalar_std(section, keys, Quantity::Velocity, SPEED_STD, std_unit)?;
    let format = read_format(section, "odometer", value, reading, std, SPEEDS, logs.span)?;
    let scale = read_std(
        section,
        "scale_std",
        Quantity::Dimensionless,
        Some(SCALE_STD),
    )?;
    if let Some(std) = scale {
        parameters = of_odometer(parameters, std);
    }
    section.only_known()?;
    Ok(((path, format), parameters))
}

/// `[barometer]`, and the parameters with the one that it asks for.
fn read_barometer(
    section: &Section,
    logs: &mut Logs,
    mut parameters: Parameters,
) -> Result<(Source, Parameters), DriveError> {
    let path = logs.named(section)?;
    let units = [("hPa", 100.0), ("mbar", 100.0), ("kPa", 1e3), ("Pa", 1.0)];
    let pressure_unit = section.word("pressure_unit", &units)?.unwrap_or(100.0);
    let height_unit = section.unit("height_unit", Quantity::Length, 1.0)?;
    let (value, reading, std_unit) = match (
        keys::column(section, "height")?,
        keys::column(section, "pressure")?,
    ) {
        (Some(_), Some(_)) => {
            return Err(section
                .error("pressure", "set height or pressure, not both")
                .into());
        }
        (None, None) => {
            let what = "the column of the height, or pressure for air pressure";
            return Err(section.missing("height", what).into());
        }
        (Some(height), None) => (
            ("height", height),
            Reading::Scaled(height_unit),
            height_unit,
        ),
        (None, Some(pressure)) => (
            ("pressure", pressure),
            Reading::Pressure(pressure_unit),
            1.0,
        ),
    };
    let keys = ("std", "std_column");
    let std = read_scalar_std(section, keys, Quantity::Length, HEIGHT_STD, std_unit)?;
    let format = read_format(
        section,
        "barometer",
        value,
        reading,
        std,
        HEIGHTS,
        logs.span,
    )?;
    let bias = read_std(section, "bias_std", Quantity::Length, Some(BIAS_STD))?;
    let walk = read_std(
        section,
        "bias_walk",
        Quantity::LengthRandomWalk,
        Some(BIAS_WALK),
    )?;
    if let Some(std) = bias {
        parameters = of_barometer(parameters, std, walk.unwrap_or(0.0));
    } else if section.get("bias_walk").is_some() {
        return Err(section
            .error("bias_walk", "has no effect while bias_std is \"off\"")
            .into());
    }
    section.only_known()?;
    Ok(((path, format), parameters))
}

/// `[heading]`, and the parameters with the one that it asks for; where the antennas are is read by [`read_baseline`].
pub(crate) fn read_heading(
    section: &Section,
    logs: &mut Logs,
    mut parameters: Parameters,
) -> Result<(Source, Parameters), DriveError> {
    let path = logs.named(section)?;
    let (format, _) = logs.format(section, &path, "time")?;
    let keys = ("std", "std_column");
    let source = if format.is_log() {
        let stated = section.quantity("std", Quantity::Angle)?;
        if stated.is_some_and(|std| std <= 0.0) {
            return Err(section
                .error("std", "must be a positive standard deviation")
                .into());
        }
        let mut source = ScalarFormat::headings(format, HEADING_STD, HEADINGS);
        let stream = section.text("topic")?.map(str::to_owned);
        source.reading = Reading::Log(format, stream);
        if let Some(std) = stated {
            source.std = ("std", ScalarStd::Constant(std));
        }
        source.time_offset = time_offset(section)?;
        source.span = logs.span;
        source
    } else {
        let column = keys::column(section, "heading")?;
        let column =
            column.ok_or_else(|| section.missing("heading", "the column of the heading"))?;
        let unit = section.unit("heading_unit", Quantity::Angle, 1f64.to_radians())?;
        let std = read_scalar_std(section, keys, Quantity::Angle, HEADING_STD, unit)?;
        let value = ("heading", column);
        let reading = Reading::Scaled(unit);
        read_format(section, "heading", value, reading, std, HEADINGS, logs.span)?
    };
    let otherwise = match section.get("baseline") {
        Some(_) => BASELINE_STD,
        None => ANY,
    };
    let std = read_std(section, "baseline_std", Quantity::Angle, Some(otherwise))?;
    match std {
        Some(std) => parameters = of_heading(parameters, std),
        None if section.get("baseline").is_none() => {
            return Err(section
                .error("baseline_std", "\"off\" needs the direction: set baseline")
                .into());
        }
        None => {}
    }
    read_baseline(section)?;
    section.only_known()?;
    Ok(((path, source), parameters))
}

/// `baseline = "90 deg"`: direction of the second antenna as seen from the first in the body, from forward to right \[rad\].
pub(super) fn read_baseline(section: &Section) -> Result<f64, ConfigError> {
    Ok(section
        .quantity("baseline", Quantity::Angle)?
        .unwrap_or(0.0))
}

fn of_heading(parameters: Parameters, std: f64) -> Parameters {
    parameters.with(Parameter::HeadingOffset, Prior::constant(std))
}

fn of_odometer(parameters: Parameters, scale_std: f64) -> Parameters {
    parameters.with(Parameter::OdometerScale, Prior::constant(scale_std))
}

fn of_barometer(parameters: Parameters, std: f64, walk: f64) -> Parameters {
    let prior = Prior {
        walk,
        ..Prior::constant(std)
    };
    parameters.with(Parameter::BarometerBias, prior)
}

/// A standard deviation by the keys `constant` or `column`, else `default`; a column's times `unit`.
fn read_scalar_std<'a>(
    section: &Section<'a>,
    (constant, column): (&'static str, &'static str),
    quantity: Quantity,
    default: f64,
    unit: f64,
) -> Result<(&'static str, ScalarStd), ConfigError> {
    match (
        section.quantity(constant, quantity)?,
        keys::column(section, column)?,
    ) {
        (Some(_), Some(_)) => {
            Err(section.error(column, format!("set {constant} or {column}, not both")))
        }
        (Some(std), None) if std <= 0.0 => {
            Err(section.error(constant, "must be a positive standard deviation"))
        }
        (std, None) => Ok((constant, ScalarStd::Constant(std.unwrap_or(default)))),
        (None, Some(at)) => Ok((column, ScalarStd::Column(at, unit))),
    }
}

fn time_offset(section: &Section) -> Result<f64, ConfigError> {
    let offset = section.quantity("time_offset", Quantity::Time)?;
    Ok(offset.unwrap_or(0.0))
}

fn read_format(
    section: &Section,
    table: &'static str,
    value: (&'static str, Column),
    reading: Reading,
    std: (&'static str, ScalarStd),
    range: (f64, f64),
    span: Option<(f64, f64)>,
) -> Result<ScalarFormat, ConfigError> {
    Ok(ScalarFormat {
        table,
        time: keys::column(section, "time")?
            .ok_or_else(|| section.missing("time", "the time column"))?,
        date: keys::column(section, "date")?,
        time_scale: section.unit("time_unit", Quantity::Time, 1.0)?,
        time_offset: time_offset(section)?,
        value,
        reading,
        std,
        range,
        delimiter: read_delimiter(section)?,
        span,
    })
}
