//! Values of a table that have a unit, and columns of a log.

#[cfg(test)]
use super::Takes;
use super::{DEGREES_MINUTES, Section, UTM, Value};
use crate::drive::error::ConfigError;
use undrift_io::{table::Column, utm::UtmZone};
use undrift_nav::{
    Vector3,
    units::{self, Quantity},
};

/// The unit that lacks its stroke: "deg/s" of "degs".
fn per_second(unit: &str, quantity: Quantity) -> Option<String> {
    let meant = format!("{}/s", unit.strip_suffix('s')?);
    units::unit_factor(&meant, quantity).ok().map(|_| meant)
}

/// The unit of two numbers that are a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaceUnit {
    /// Latitude and longitude, by their factor to radians.
    Angle(f64),
    /// The same in degrees times 100 and minutes.
    DegreesMinutes,
    /// Easting and northing \[m\].
    Utm(UtmZone),
}

impl<'a> Section<'a> {
    /// A bare number above zero.
    ///
    /// # Errors
    /// If the value is no number, not finite or not above zero.
    pub fn factor(&self, key: &'a str) -> Result<Option<f64>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Positive);
        let number = match self.get(key) {
            None => return Ok(None),
            Some(Value::Whole(x) | Value::Decimal(x)) => x.replace('_', "").parse().ok(),
            Some(_) => None,
        };
        match number.filter(|x: &f64| x.is_finite() && *x > 0.0) {
            Some(x) => Ok(Some(x)),
            None => Err(self.error(key, "must be a positive number")),
        }
    }

    /// A column of a table by name or by number, counted from 1.
    ///
    /// # Errors
    /// If the value is neither a string nor a whole number from 1 on.
    pub fn column(&self, key: &'a str) -> Result<Option<Column>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Column);
        self.get(key)
            .map(|value| self.column_of(key, &value))
            .transpose()
    }

    fn column_of(&self, key: &str, value: &Value) -> Result<Column, ConfigError> {
        match value {
            Value::Text(name) => Ok(Column::Name((*name).to_owned())),
            Value::Whole(number) => match number.parse::<usize>() {
                Ok(n) if n > 0 => Ok(Column::Number(n)),
                _ => Err(self.error(key, "columns are numbered from 1")),
            },
            _ => Err(self.error(key, "must be a column's name or number")),
        }
    }

    /// Three columns, each by name or number.
    ///
    /// # Errors
    /// If the value is no list of three, or as [`Section::column`] of one of them.
    pub fn columns(&self, key: &'a str) -> Result<Option<[Column; 3]>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::ThreeColumns);
        let wrong = "must be a list of three columns such as [\"x\", \"y\", \"z\"] or [2, 3, 4]";
        self.some_columns(key, wrong)
    }

    /// Four columns, each by name or number.
    ///
    /// # Errors
    /// If the value is no list of four, or as [`Section::column`] of one of them.
    pub fn four_columns(&self, key: &'a str) -> Result<Option<[Column; 4]>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::FourColumns);
        let wrong = "must be a list of four columns such as [\"qx\", \"qy\", \"qz\", \"qw\"]";
        self.some_columns(key, wrong)
    }

    /// Two columns, with the first as a third that nothing is taken from.
    ///
    /// # Errors
    /// If it is no list of two columns.
    pub fn two_columns(&self, key: &'a str) -> Result<Option<[Column; 3]>, ConfigError> {
        let wrong =
            "with height it has two columns, latitude and longitude: remove the third, or height";
        let two = self.some_columns(key, wrong)?;
        Ok(two.map(|[first, second]| [first.clone(), second, first]))
    }

    /// So many columns; a value that is no list of them is `wrong`.
    fn some_columns<const N: usize>(
        &self,
        key: &'a str,
        wrong: &str,
    ) -> Result<Option<[Column; N]>, ConfigError> {
        let items = match self.get(key) {
            None => return Ok(None),
            Some(Value::List(items)) => items,
            Some(_) => return Err(self.error(key, wrong)),
        };
        let columns = items.iter().map(|item| self.column_of(key, item));
        let columns = columns.collect::<Result<Vec<_>, _>>()?;
        let columns = columns.try_into().map(Some);
        columns.map_err(|_| self.error(key, wrong))
    }

    /// A number with its unit, `"10 cm/s"`, in the SI unit of `quantity`.
    ///
    /// # Errors
    /// If the value is no string, or its text no finite number with a unit of `quantity`.
    pub fn quantity(&self, key: &'a str, quantity: Quantity) -> Result<Option<f64>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Quantity(quantity));
        match self.get(key) {
            None => Ok(None),
            Some(Value::Text(text)) => units::parse(text, quantity)
                .map(Some)
                .map_err(|e| self.error(key, format!("\"{text}\": {e}"))),
            Some(value) => Err(self.error(key, needs_unit(&value, quantity))),
        }
    }

    /// The unit of places, degrees without one.
    ///
    /// # Errors
    /// As [`Section::unit`], and of UTM without its zone.
    pub fn place_unit(&self, key: &'a str) -> Result<PlaceUnit, ConfigError> {
        let degree = 1f64.to_radians();
        if self.string(key)? == Some(DEGREES_MINUTES) {
            return Ok(PlaceUnit::DegreesMinutes);
        }
        if let Some(zone) = self.string(key)?.and_then(|text| text.strip_prefix(UTM)) {
            let zone = UtmZone::parse(zone.trim_start()).ok_or_else(|| {
                let mend = "UTM needs its zone and hemisphere, such as \"UTM 32N\" or \"UTM 56S\"";
                self.error(key, mend)
            })?;
            return Ok(PlaceUnit::Utm(zone));
        }
        Ok(PlaceUnit::Angle(self.unit(key, Quantity::Angle, degree)?))
    }

    /// The factor to SI of a unit without number, `default` where the key is absent; of a velocity or an angle a
    /// minus before the unit reverses the sign.
    ///
    /// # Errors
    /// If the value is no string, or its text no unit of `quantity`.
    pub fn unit(&self, key: &'a str, quantity: Quantity, default: f64) -> Result<f64, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Unit(quantity));
        let text = self.string(key)?;
        text.map_or(Ok(default), |text| self.factor_of(key, text, quantity))
    }

    /// The factors to SI of the units of what an inertial sensor measures about x, y and z: one unit, or one of each,
    /// `"deg/s, deg/s, -deg/s"`; a minus before a unit reverses the sign. 1 where the key is absent.
    ///
    /// # Errors
    /// As [`Section::unit`]; for another number of units.
    pub fn units(&self, key: &'a str, quantity: Quantity) -> Result<Vector3, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Unit(quantity));
        let Some(text) = self.string(key)? else {
            return Ok(Vector3::repeat(1.0));
        };
        let factor = |unit: &str| self.factor_of(key, unit.trim(), quantity);
        match *text.split(',').collect::<Vec<_>>() {
            [all] => Ok(Vector3::repeat(factor(all)?)),
            [x, y, z] => Ok(Vector3::new(factor(x)?, factor(y)?, factor(z)?)),
            _ => Err(self.error(
                key,
                format!(
                    "\"{text}\" is neither one unit nor three of x, y, z with commas between them"
                ),
            )),
        }
    }

    fn factor_of(&self, key: &'a str, text: &str, quantity: Quantity) -> Result<f64, ConfigError> {
        use Quantity::{Acceleration, Angle, AngularRate, Velocity};
        let signed = matches!(quantity, Acceleration | Angle | AngularRate | Velocity);
        let minus = text.trim_start().strip_prefix(['-', '\u{2212}']);
        let (unit, sign) = match minus.filter(|_| signed) {
            Some(unit) => (unit.trim_start(), -1.0),
            None => (text, 1.0),
        };
        let factor = units::unit_factor(unit, quantity).map_err(|e| {
            let message = match per_second(unit, quantity) {
                Some(meant) => format!(
                    "\"{unit}\" is not {}; did you mean \"{meant}\"?",
                    quantity.name()
                ),
                None => format!("\"{unit}\": {e}"),
            };
            self.error(key, message)
        })?;
        Ok(sign * factor)
    }

    /// Three numbers with one unit, `"0.1, -0.3, 0 m"`, in the SI unit of `quantity`; one number means it for all three.
    ///
    /// # Errors
    /// If the value is no string, or its text neither one nor three finite numbers with a unit of `quantity`.
    pub fn vector(&self, key: &'a str, quantity: Quantity) -> Result<Option<Vector3>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Vector(quantity));
        let text = match self.get(key) {
            None => return Ok(None),
            Some(Value::Text(text)) => text,
            Some(value) => {
                return Err(self.error(key, needs_unit(&value, quantity)));
            }
        };
        let wrong = |e: &dyn std::fmt::Display| self.error(key, format!("\"{text}\": {e}"));
        let parts: Vec<&str> = text.split(',').map(str::trim).collect();
        match parts.as_slice() {
            [one] => Ok(Some(Vector3::repeat(
                units::parse(one, quantity).map_err(|e| wrong(&e))?,
            ))),
            [x, y, z] => {
                let end = z
                    .find(|c: char| !(c.is_ascii_digit() || ".+-eE\u{2212}".contains(c)))
                    .unwrap_or(z.len());
                let unit = &z[end..];
                let number = |n: &str| {
                    // A unit of its own, or the last one's.
                    let own = !n.ends_with(|c: char| c.is_ascii_digit() || c == '.');
                    let text = if own {
                        n.to_owned()
                    } else {
                        format!("{n}{unit}")
                    };
                    units::parse(&text, quantity).map_err(|e| wrong(&e))
                };
                Ok(Some(Vector3::new(
                    number(x)?,
                    number(y)?,
                    number(&z[..end])?,
                )))
            }
            _ => Err(wrong(
                &"expected one number, or three with commas between them, and a unit",
            )),
        }
    }
}

fn needs_unit(value: &Value, quantity: Quantity) -> String {
    let number = match value {
        Value::Whole(number) | Value::Decimal(number) => number,
        _ => "1",
    };
    let examples = quantity.examples();
    let unit = examples.split('"').nth(1).unwrap_or_default();
    format!("the number needs a unit: write \"{number} {unit}\"")
}
