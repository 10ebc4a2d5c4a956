//! Keys that drive files, fleets and simulations have beyond quantities and words: names of logs, columns of them, places, noise models.

use super::error::{ConfigError, DriveError};
use std::path::Path;
use undrift_config::{Section, Takes, Value};
use undrift_io::{table::Column, utm::UtmZone};
use undrift_nav::units::Quantity;
use undrift_noise::{ImuModel, ModelError};

/// The unit of latitudes and longitudes that are degrees times 100 and minutes, as NMEA has them.
pub(crate) const DEGREES_MINUTES: &str = "ddmm.mmmm";
/// What the unit of eastings and northings begins with, before their zone.
pub(crate) const UTM: &str = "UTM";

/// The name of a file, which must be there and not be empty.
///
/// # Errors
/// If the key or its whole table is missing, or the value is no string or empty.
pub fn file_name<'a>(section: &Section<'a>, key: &str) -> Result<&'a str, ConfigError> {
    match section.text(key)? {
        Some(name) if !name.is_empty() => Ok(name),
        Some(_) => Err(section.error(key, "the file name is empty")),
        None if section.exists() => Err(section.missing(key, "the file name")),
        None => {
            let path = &section.path;
            let table = format!("add a [{path}] table with file = \"NAME OF THE LOG\"");
            Err(section.missing(key, table))
        }
    }
}

/// A noise model: a preset, a file relative to `home`, or a table.
///
/// # Errors
/// If the value is not one of the three, there is no such preset or file, or the model cannot be read.
pub fn model(section: &Section, key: &str, home: &Path) -> Result<Option<ImuModel>, DriveError> {
    section.note(key, Takes::Model);
    match section.get(key) {
        None => Ok(None),
        Some(Value::Text(name)) => match ImuModel::resolve(name, home) {
            Ok(model) => Ok(Some(model)),
            // Not the model's fault but the name's.
            Err(e @ ModelError::Read { .. }) => Err(section.error(key, e.to_string()).into()),
            Err(other) => Err(other.into()),
        },
        Some(Value::Table(_)) => Ok(Some(ImuModel::from_section(&section.section(key)?)?)),
        Some(_) => Err(section
            .error(key, "must be a preset's name, a file, or a table")
            .into()),
    }
}

/// A column of a table by name or by number, counted from 1.
///
/// # Errors
/// If the value is neither a string nor a whole number from 1 on.
pub fn column(section: &Section, key: &str) -> Result<Option<Column>, ConfigError> {
    section.note(key, Takes::Column);
    let value = section.get(key);
    value
        .map(|value| column_of(section, key, &value))
        .transpose()
}

fn column_of(section: &Section, key: &str, value: &Value) -> Result<Column, ConfigError> {
    match value {
        Value::Text(name) => Ok(Column::Name((*name).to_owned())),
        Value::Whole(number) => match number.parse::<usize>() {
            Ok(n) if n > 0 => Ok(Column::Number(n)),
            _ => Err(section.error(key, "columns are numbered from 1")),
        },
        _ => Err(section.error(key, "must be a column's name or number")),
    }
}

/// Three columns, each by name or number.
///
/// # Errors
/// If the value is no list of three, or as [`column`] of one of them.
pub fn columns(section: &Section, key: &str) -> Result<Option<[Column; 3]>, ConfigError> {
    section.note(key, Takes::ThreeColumns);
    let wrong = "must be a list of three columns such as [\"x\", \"y\", \"z\"] or [2, 3, 4]";
    some_columns(section, key, wrong)
}

/// Four columns, each by name or number.
///
/// # Errors
/// If the value is no list of four, or as [`column`] of one of them.
pub(super) fn four_columns(
    section: &Section,
    key: &str,
) -> Result<Option<[Column; 4]>, ConfigError> {
    section.note(key, Takes::FourColumns);
    let wrong = "must be a list of four columns such as [\"qx\", \"qy\", \"qz\", \"qw\"]";
    some_columns(section, key, wrong)
}

/// Two columns, with the first as a third that nothing is taken from.
///
/// # Errors
/// If it is no list of two columns.
pub(super) fn two_columns(
    section: &Section,
    key: &str,
) -> Result<Option<[Column; 3]>, ConfigError> {
    let wrong =
        "with height it has two columns, latitude and longitude: remove the third, or height";
    let two = some_columns(section, key, wrong)?;
    Ok(two.map(|[first, second]| [first.clone(), second, first]))
}

/// So many columns; a value that is no list of them is `wrong`.
fn some_columns<const N: usize>(
    section: &Section,
    key: &str,
    wrong: &str,
) -> Result<Option<[Column; N]>, ConfigError> {
    let items = match section.get(key) {
        None => return Ok(None),
        Some(Value::List(items)) => items,
        Some(_) => return Err(section.error(key, wrong)),
    };
    let columns = items.iter().map(|item| column_of(section, key, item));
    let columns = columns.collect::<Result<Vec<_>, _>>()?;
    let columns = columns.try_into().map(Some);
    columns.map_err(|_| section.error(key, wrong))
}

/// The unit of two numbers that are a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PlaceUnit {
    /// Latitude and longitude, by their factor to radians.
    Angle(f64),
    /// The same in degrees times 100 and minutes.
    DegreesMinutes,
    /// Easting and northing \[m\].
    Utm(UtmZone),
}

/// The unit of places, degrees without one.
///
/// # Errors
/// As [`Section::unit`], and of UTM without its zone.
pub(super) fn place_unit(section: &Section, key: &str) -> Result<PlaceUnit, ConfigError> {
    let text = match section.get(key) {
        Some(Value::Text(text)) => text,
        _ => "",
    };
    if text == DEGREES_MINUTES {
        return Ok(PlaceUnit::DegreesMinutes);
    }
    if let Some(zone) = text.strip_prefix(UTM) {
        let zone = UtmZone::parse(zone.trim_start()).ok_or_else(|| {
            let mend = "UTM needs its zone and hemisphere, such as \"UTM 32N\" or \"UTM 56S\"";
            section.error(key, mend)
        })?;
        return Ok(PlaceUnit::Utm(zone));
    }
    let degree = 1f64.to_radians();
    Ok(PlaceUnit::Angle(section.unit(
        key,
        Quantity::Angle,
        degree,
    )?))
}
