//! The tables of `DRIVE.toml`, one function each.

use super::{
    error::{ConfigError, DriveError},
    keys,
    logs::Logs,
};
use crate::{
    align::{AlignSettings, Heading},
    vehicle::{Air, Constraints, NonHolonomic, Profile},
};
use std::path::PathBuf;
use undrift_config::{Section, Takes, Value};
use undrift_io::{
    format::Format,
    gnss::VelocityAxes,
    layouts,
    truth::{TruthFormat, TruthLog, TruthSource},
};
use undrift_nav::{
    Vector3,
    parameters::{Parameter, Parameters, Prior},
    units::Quantity,
};

pub(super) const VELOCITY_AXES: [(&str, VelocityAxes); 3] = [
    ("north,east,down", VelocityAxes::Down),
    ("north,east,up", VelocityAxes::Up),
    ("ecef", VelocityAxes::Ecef),
];

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

pub(super) fn read_delimiter(section: &Section) -> Result<Option<u8>, ConfigError> {
    match section.text("delimiter")? {
        None => Ok(None),
        Some(text) if text.len() == 1 => Ok(text.bytes().next()),
        Some(text) => Err(section.error("delimiter", format!("\"{text}\" is not one character"))),
    }
}

pub(crate) fn read_truth(
    section: &Section,
    logs: &mut Logs,
) -> Result<Option<(PathBuf, TruthSource)>, DriveError> {
    if !section.exists() {
        return Ok(None);
    }
    let path = logs.named(section)?;
    let time_offset = section
        .quantity("time_offset", Quantity::Time)?
        .unwrap_or(0.0);
    let source = match logs.format(section, &path, "time")?.0 {
        log if log.is_log() => TruthSource::Log(TruthLog {
            format: log,
            stream: section.text("topic")?.map(str::to_owned),
            time_offset,
            span: None,
        }),
        Format::KfGins => TruthSource::Table(Box::new(TruthFormat {
            time_offset,
            ..layouts::kf_gins_truth()
        })),
        _ => TruthSource::Table(Box::new(TruthFormat {
            time_offset,
            ..read_truth_columns(section)?
        })),
    };
    section.only_known()?;
    Ok(Some((path, source)))
}

/// The reference in named columns of a table.
fn read_truth_columns(section: &Section) -> Result<TruthFormat, ConfigError> {
    let time =
        keys::column(section, "time")?.ok_or_else(|| section.missing("time", "the time column"))?;
    let (position, ecef) = match (
        keys::columns(section, "position")?,
        keys::columns(section, "ecef")?,
    ) {
        (Some(_), Some(_)) => {
            return Err(section.error("ecef", "set position or ecef, not both"));
        }
        (Some(position), None) => (position, false),
        (None, Some(ecef)) => (ecef, true),
        (None, None) => {
            let what = "the columns latitude, longitude, height, or ecef";
            return Err(section.missing("position", what));
        }
    };
    let degree = 1f64.to_radians();
    Ok(TruthFormat {
        time,
        date: keys::column(section, "date")?,
        time_scale: section.unit("time_unit", Quantity::Time, 1.0)?,
        time_offset: 0.0,
        week: None,
        position,
        ecef,
        angle_scale: section.unit("position_unit", Quantity::Angle, degree)?,
        velocity: keys::columns(section, "velocity")?,
        attitude: keys::columns(section, "attitude")?,
        attitude_scale: section.unit("attitude_unit", Quantity::Angle, degree)?,
        delimiter: read_delimiter(section)?,
        velocity_axes: section
            .word("velocity_axes", &VELOCITY_AXES)?
            .unwrap_or_default(),
        span: None,
    })
}

/// The table `[initial]`: how a solution starts.
///
/// # Errors
/// A key that it does not have, or a value that it cannot have.
pub fn read_initial(section: &Section) -> Result<AlignSettings, ConfigError> {
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

/// A standard deviation that switches something on, `"off"`, or else the one given.
pub(super) fn read_std<'a>(
    section: &Section<'a>,
    key: &'a str,
    quantity: Quantity,
    otherwise: Option<f64>,
) -> Result<Option<f64>, ConfigError> {
    // A pure number needs no quotes.
    let is_pure = quantity == Quantity::Dimensionless;
    let takes = [Takes::Quantity(quantity), Takes::Positive];
    for takes in takes.into_iter().take(1 + usize::from(is_pure)) {
        section.note(key, takes);
    }
    let std = match section.get(key) {
        Some(Value::Text("off")) => return Ok(None),
        Some(Value::Text(_)) => section.quantity(key, quantity)?,
        Some(_) if is_pure => section.factor(key)?,
        _ => section.quantity(key, quantity)?,
    };
    match std {
        Some(std) if std > 0.0 => Ok(Some(std)),
        Some(_) => Err(section.error(key, "must be a positive standard deviation, or \"off\"")),
        None => Ok(otherwise),
    }
}

/// How well a vehicle's axes are known from a mounting given by hand \[rad\], and the place of the axle
/// along it \[m\], given and not.
const MOUNTING_STD: f64 = 0.05;
const AXLE_STD_GIVEN: f64 = 0.3;
pub(crate) const AXLE_STD: f64 = 2.0;

/// Random walk of the lever arm in units of its prior standard deviation [1/√s]: what turns show of it is not white (tyres, suspension, a receiver
/// that smooths), so that no number of them shows it to the millimetre.
const LEVER_ARM_WALK: f64 = 6e-3;

/// How far fixes are from their stamps, as a rule \[s\], and how much that changes [s/√s]: clocks drift, hosts stamp late.
const TIME_OFFSET_STD: f64 = 0.1;
const TIME_OFFSET_WALK: f64 = 6e-3;
/// Rate by which a host's clock or a sensor's own is fast or slow [s/s]: crystals 50e-6, those of cheap sensors more.
const CLOCK_RATE_STD: f64 = 3e-4;
/// Where an antenna may be of which nothing is said, each way \[m\].
const LEVER_ARM_STD: f64 = 0.5;
/// How well a lever arm is measured that is stated, each way \[m\]: with a tape, from the middle of one housing to that of another.
const LEVER_ARM_STD_GIVEN: f64 = 0.05;
/// What data sheets of cheap inertial sensors allow their scale factors, one standard deviation.
const SCALE_FACTOR_STD: f64 = 0.02;
/// How much a scale factor of a gyro changes with temperature, rate and vibration [1/√s]. A constant would be believed to
/// a thousandth where vibration, not the scale, is what is wrong.
const SCALE_FACTOR_WALK: f64 = 2e-4;

/// The constraints, and the parameters that they ask for.
pub(super) fn read_vehicle(section: &Section) -> Result<(Constraints, Parameters), ConfigError> {
    let words = Profile::ALL.map(|profile| (profile.name(), profile));
    let profile = section.word("profile", &words)?.unwrap_or_default();
    let mut constraints = profile.constraints();
    let length = |key| -> Result<Vector3, ConfigError> {
        let lever = section.vector(key, Quantity::Length)?;
        Ok(lever.unwrap_or_else(Vector3::zeros))
    };
    let slip = constraints.non_holonomic.map(|rule| rule.right);
    let lever = length("axle")?;
    let down = section.quantity("non_holonomic_down", Quantity::Velocity)?;
    let side_slip = section.quantity("side_slip", Quantity::Time)?;
    for (key, value) in [("non_holonomic_down", down), ("side_slip", side_slip)] {
        if value.is_some_and(|value| value < 0.0) {
            return Err(section.error(key, "must not be negative"));
        }
    }
    let std = read_std(section, "non_holonomic", Quantity::Velocity, slip)?;
    constraints.non_holonomic = std.map(|std| NonHolonomic {
        lever,
        ..non_holonomic(std, down, side_slip)
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
    constraints.air = read_air(section, constraints.air)?;
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
    let usual = constraints.air.map(|_| Air::WIND.std);
    let wind = read_std(section, "wind_std", Quantity::Velocity, usual)?;
    if usual.is_none() && wind.is_some() {
        let problem = "has no effect without \"air_velocity\" or \"rotor_drag\"";
        return Err(section.error("wind_std", problem));
    }
    section.only_known()?;
    let parameters = of_vehicle(Parameters::none(), mounting, axle);
    let parameters = match &constraints.air {
        Some(air) => air.with_states(parameters, wind),
        None => parameters,
    };
    Ok((constraints, parameters))
}

/// What the air does to the craft: the scatter of its measurement, or off.
fn read_air(section: &Section, profile: Option<Air>) -> Result<Option<Air>, ConfigError> {
    let [wings, rotors] = match profile {
        None => [None, None],
        Some(Air::Wings(std)) => [Some(std), None],
        Some(Air::Rotors { std, .. }) => [None, Some(std)],
    };
    let wings = read_std(section, "air_velocity", Quantity::Velocity, wings)?;
    let rotors = read_std(section, "rotor_drag", Quantity::Acceleration, rotors)?;
    match (wings, rotors) {
        (Some(_), Some(_)) => {
            let problem =
                "is for copters, \"air_velocity\" for aircraft: switch one of them \"off\"";
            Err(section.error("rotor_drag", problem))
        }
        (Some(std), None) => Ok(Some(Air::Wings(std))),
        (None, Some(std)) => Ok(Some(Air::Rotors {
            std,
            drag: Air::DRAG,
        })),
        (None, None) => Ok(None),
    }
}

/// The constraint of a vehicle that slips sideways with this standard deviation [m/s]; what else is not given is a car's.
fn non_holonomic(right: f64, down: Option<f64>, slip: Option<f64>) -> NonHolonomic {
    NonHolonomic {
        right,
        down: down.unwrap_or(right * NonHolonomic::CAR.down / NonHolonomic::CAR.right),
        slip: slip.unwrap_or(NonHolonomic::CAR.slip),
        ..NonHolonomic::CAR
    }
}

fn of_vehicle(mut parameters: Parameters, mounting: Option<f64>, axle: Option<f64>) -> Parameters {
    for (kind, std) in [(Parameter::Mounting, mounting), (Parameter::Axle, axle)] {
        if let Some(std) = std {
            parameters = parameters.with(kind, Prior::constant(std));
        }
    }
    parameters
}

/// The constraints of a vehicle of which no more is known, and `parameters` with those that they ask for.
pub(super) fn vehicle_by_default(
    profile: Profile,
    parameters: Parameters,
) -> (Constraints, Parameters) {
    let mut constraints = profile.constraints();
    let rule = constraints.non_holonomic;
    constraints.non_holonomic = rule.map(|rule| non_holonomic(rule.right, None, None));
    let needed = |std: f64| rule.map(|_| std);
    let parameters = of_vehicle(parameters, needed(MOUNTING_STD), needed(AXLE_STD));
    let parameters = match &constraints.air {
        Some(air) => air.with_states(parameters, Some(Air::WIND.std)),
        None => parameters,
    };
    (constraints, parameters)
}

/// What a lever arm is known to, given or not \[m\].
fn lever_arm_std(given: bool) -> f64 {
    match given {
        true => LEVER_ARM_STD_GIVEN,
        false => LEVER_ARM_STD,
    }
}

/// The parameters with a lever arm that is given.
pub(super) fn with_given_lever_arm(parameters: Parameters) -> Parameters {
    let arm = [None, Some(lever_arm_std(true))];
    estimated(parameters, [None; 2], arm, [None; 3])
}

/// The parameters that are estimated where nothing else is said.
pub(super) fn states_by_default() -> Parameters {
    let times = [Some(TIME_OFFSET_STD), Some(CLOCK_RATE_STD), None];
    let scales = [Some(SCALE_FACTOR_STD), None];
    let constants = [None, Some(LEVER_ARM_STD)];
    estimated(Parameters::none(), scales, constants, times)
}

/// The parameters estimated beside those given, by their standard deviations; `antenna` where it is known where that is.
pub(super) fn read_states(
    section: &Section,
    parameters: Parameters,
    antenna: bool,
) -> Result<Parameters, ConfigError> {
    let std = |key, quantity, otherwise| read_std(section, key, quantity, otherwise);
    let scale = std("scale_factor", Quantity::Dimensionless, None)?;
    // Only the gyros determine the heading. Vibration makes accelerometers seem to read too much.
    let unless_given = section.get("scale_factor").is_none();
    let gyro_scale = scale.or(unless_given.then_some(SCALE_FACTOR_STD));
    let misalignment = std("misalignment", Quantity::Angle, None)?;
    let offset = std("time_offset", Quantity::Time, Some(TIME_OFFSET_STD))?;
    let delay = std("accel_delay", Quantity::Time, None)?;
    let rate = std("clock_rate", Quantity::Dimensionless, Some(CLOCK_RATE_STD))?;
    let lever_arm = std("lever_arm", Quantity::Length, Some(lever_arm_std(antenna)))?;
    section.only_known()?;
    let constants = [misalignment, lever_arm];
    Ok(estimated(
        parameters,
        [gyro_scale, scale],
        constants,
        [offset, rate, delay],
    ))
}

/// Parameters with those of these standard deviations: scale factors of gyros and accelerometers, misalignment and lever
/// arm, time offsets, clock rate.
fn estimated(
    mut parameters: Parameters,
    [gyro_scale, accel_scale]: [Option<f64>; 2],
    [misalignment, lever_arm]: [Option<f64>; 2],
    [offset, rate, delay]: [Option<f64>; 3],
) -> Parameters {
    let arm_walk = lever_arm.map_or(0.0, |std| LEVER_ARM_WALK * std);
    for (kind, std, walk) in [
        (Parameter::GyroScale, gyro_scale, SCALE_FACTOR_WALK),
        (Parameter::AccelScale, accel_scale, 0.0),
        (Parameter::GyroMisalignment, misalignment, 0.0),
        (Parameter::AccelMisalignment, misalignment, 0.0),
        (Parameter::LeverArm, lever_arm, arm_walk),
        (Parameter::TimeOffset, offset, TIME_OFFSET_WALK),
        (Parameter::VelocityTimeOffset, offset, TIME_OFFSET_WALK),
        (Parameter::AccelDelay, delay, 0.0),
        (Parameter::ClockRate, rate.filter(|_| offset.is_some()), 0.0),
    ] {
        if let Some(std) = std {
            let prior = Prior {
                walk,
                ..Prior::constant(std)
            };
            parameters = parameters.with(kind, prior);
        }
    }
    parameters
}
