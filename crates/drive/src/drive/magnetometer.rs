//! The table `[magnetometer]` of `DRIVE.toml`.

use super::{
    Drive,
    error::{ConfigError, DriveError},
    imu::rotation_of_axes,
    keys,
    logs::Logs,
    tables::{read_delimiter, read_std},
};
use crate::settings::magnetometer::Magnetometer;
use std::path::PathBuf;
use undrift_config::Section;
use undrift_io::{
    Memory,
    magnetic::{MagneticFormat, MagneticSource},
};
use undrift_nav::{
    parameters::{Parameter, Parameters, Prior},
    sample::MagneticField,
    units::Quantity,
};

/// Name of the table.
pub(crate) const TABLE: &str = "magnetometer";
/// White noise of a reading, each axis \[T\]: chips of telephones and flight controllers.
const STD: f64 = 0.5e-6;

/// A log, and the standard deviation of errors that last \[T\].
type Read = ((PathBuf, MagneticFormat), f64);

/// `[magnetometer]`, and the parameters with the hard iron that it asks for.
pub(crate) fn read(
    section: &Section,
    logs: &mut Logs,
    mut parameters: Parameters,
) -> Result<(Option<Read>, Parameters), DriveError> {
    if !section.exists() {
        return Ok((None, parameters));
    }
    let path = logs.named(section)?;
    let (log, _) = logs.format(section, &path, "time")?;
    let source = match log.is_log() {
        true => MagneticSource::Log(log, section.text("topic")?.map(str::to_owned)),
        false => columns(section)?,
    };
    let std = positive(section, "std", STD)?;
    let mut format = MagneticFormat::new(source, std);
    format.scale = section.units("field_unit", Quantity::MagneticField)?;
    format.time_offset = section
        .quantity("time_offset", Quantity::Time)?
        .unwrap_or(0.0);
    if let Some(axes) = section.text("axes")? {
        format.rotation = rotation_of_axes(axes).map_err(|m| section.error("axes", m))?;
    }
    format.span = logs.span;
    let usual = Magnetometer::HARD_IRON;
    let field = Quantity::MagneticField;
    let hard_iron = read_std(section, "hard_iron_std", field, Some(usual.std))?;
    let walk = Quantity::MagneticRandomWalk;
    let walk = read_std(section, "hard_iron_walk", walk, Some(usual.walk))?;
    match hard_iron {
        Some(std) => {
            let walk = walk.unwrap_or(0.0);
            let prior = Prior {
                walk,
                ..Prior::constant(std)
            };
            parameters = parameters.with(Parameter::HardIron, prior);
        }
        None if section.get("hard_iron_walk").is_some() => {
            let problem = "has no effect while hard_iron_std is \"off\"";
            return Err(section.error("hard_iron_walk", problem).into());
        }
        None => {}
    }
    let lasting = positive(section, "lasting_std", Magnetometer::default().lasting)?;
    section.only_known()?;
    Ok((Some(((path, format), lasting)), parameters))
}

/// The fields in named columns of a table.
fn columns(section: &Section) -> Result<MagneticSource, ConfigError> {
    let field = keys::columns(section, "field")?
        .ok_or_else(|| section.missing("field", "the three columns x, y, z"))?;
    if section.get("field_unit").is_none() {
        let examples = Quantity::MagneticField.examples();
        let what = format!("the unit of the columns, {examples}");
        return Err(section.missing("field_unit", what));
    }
    Ok(MagneticSource::Table {
        time: keys::column(section, "time")?
            .ok_or_else(|| section.missing("time", "the time column"))?,
        date: keys::column(section, "date")?,
        time_scale: section.unit("time_unit", Quantity::Time, 1.0)?,
        field,
        delimiter: read_delimiter(section)?,
    })
}

/// A standard deviation above zero.
fn positive(section: &Section, key: &'static str, otherwise: f64) -> Result<f64, ConfigError> {
    let std = section.quantity(key, Quantity::MagneticField)?;
    match std {
        Some(std) if std <= 0.0 => Err(section.error(key, "must be a positive standard deviation")),
        std => Ok(std.unwrap_or(otherwise)),
    }
}

impl Drive {
    /// This drive with magnetic fields in memory, body axes \[T\], in order of time; hard iron of 5 µT is estimated.
    ///
    /// ```
    /// # use undrift_drive as undrift;
    /// use undrift::{Drive, navigate::{Wanted, navigate}};
    /// # use undrift_noise::{BiasModel, ImuModel};
    /// # use undrift_simulate::{GnssNoise, Magnetometer, Trajectory, simulate};
    /// # let model = ImuModel::preset("adis16465").expect("a preset");
    /// # let sensors = model.shaping(BiasModel::GaussMarkov, 0.02)?;
    /// # let car = Trajectory::rest(20.0);
    /// # let log = simulate(&car, 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
    /// # let fields: Vec<_> = Magnetometer::default().measure(&car, 1)?.collect();
    /// // A car that is parked has a heading, known to 15 deg or so.
    /// let drive = Drive { model: Some(model), ..Drive::from_samples(&log.imu, &log.gnss) };
    /// let summary = navigate(&drive.with_magnetometer(&fields), BiasModel::GaussMarkov, Wanted::default())?.summary;
    /// assert!((0.1..0.4).contains(&summary.alignment.expect("at rest").heading_std)); // [rad]
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_magnetometer(mut self, fields: &[MagneticField]) -> Self {
        let path = self.hold("<magnetometer>", Memory::Fields(fields.into()));
        let format = MagneticFormat::new(MagneticSource::Held, STD);
        self.magnetometer = Some((path, format));
        self.magnetometer_lasting = Magnetometer::default().lasting;
        self.parameters = self
            .parameters
            .with(Parameter::HardIron, Magnetometer::HARD_IRON);
        self
    }

    /// What is known of the magnetometer beside its hard iron.
    pub(crate) fn magnetometer_known(&self) -> Magnetometer {
        let (epoch, start) = (self.epoch, self.beginning.time.unwrap_or(0.0));
        Magnetometer {
            lasting: self.magnetometer_lasting,
            year: epoch.map(|epoch| 1970.0 + epoch.unix(start) / YEAR),
        }
    }
}

/// Mean length of a year \[s\].
const YEAR: f64 = 365.2425 * 86_400.0;
