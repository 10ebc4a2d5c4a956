//! Numbers of a table: bare ones, and those with a unit.

use crate::{ConfigError, Section, Takes, Value};
use undrift_nav::{
    Vector3,
    units::{self, Quantity},
};

/// The unit that lacks its stroke: "deg/s" of "degs".
fn per_second(unit: &str, quantity: Quantity) -> Option<String> {
    let meant = format!("{}/s", unit.strip_suffix('s')?);
    units::unit_factor(&meant, quantity).ok().map(|_| meant)
}

impl Section<'_> {
    /// A bare number above zero.
    ///
    /// # Errors
    /// If the value is no number, not finite or not above zero.
    pub fn factor(&self, key: &str) -> Result<Option<f64>, ConfigError> {
        self.note(key, Takes::Positive);
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let number = value.number().filter(|x| x.is_finite() && *x > 0.0);
        let number = number.ok_or_else(|| self.error(key, "must be a positive number"));
        number.map(Some)
    }

    /// A whole number, zero or above.
    ///
    /// # Errors
    /// If the value is no whole number, negative or beyond 64 bits.
    pub fn whole(&self, key: &str) -> Result<Option<u64>, ConfigError> {
        self.note(key, Takes::Whole);
        let number = match self.get(key) {
            None => return Ok(None),
            Some(Value::Whole(digits)) => digits.parse().ok(),
            Some(_) => None,
        };
        let number = number.ok_or_else(|| self.error(key, "must be a whole number, 0 or more"));
        number.map(Some)
    }

    /// A list of finite numbers without unit; empty where it is absent.
    ///
    /// # Errors
    /// If the value is no list of such.
    pub fn numbers(&self, key: &str) -> Result<Vec<f64>, ConfigError> {
        self.note(key, Takes::Numbers);
        let finite = |item: &Value| item.number().filter(|x| x.is_finite());
        let numbers = match self.get(key) {
            None => Some(Vec::new()),
            Some(Value::List(items)) => items.iter().map(finite).collect(),
            Some(_) => None,
        };
        numbers
            .ok_or_else(|| self.error(key, "must be a list of finite numbers such as [1.0, -0.2]"))
    }

    /// A number with its unit, `"10 cm/s"`, in the SI unit of `quantity`.
    ///
    /// # Errors
    /// If the value is no string, or its text no finite number with a unit of `quantity`.
    pub fn quantity(&self, key: &str, quantity: Quantity) -> Result<Option<f64>, ConfigError> {
        self.note(key, Takes::Quantity(quantity));
        let read = self.get(key).map(|value| with_unit(&value, quantity));
        read.transpose().map_err(|message| self.error(key, message))
    }

    /// A number with its unit, not negative.
    ///
    /// # Errors
    /// As [`Section::quantity`], and for a number below zero.
    pub fn measure(&self, key: &str, quantity: Quantity) -> Result<Option<f64>, ConfigError> {
        self.note(key, Takes::Quantity(quantity));
        let read = self.get(key).map(|value| not_negative(&value, quantity));
        read.transpose().map_err(|message| self.error(key, message))
    }

    /// A number with its unit, above zero.
    ///
    /// # Errors
    /// As [`Section::quantity`], and for a number that is not above zero.
    pub fn positive(&self, key: &str, quantity: Quantity) -> Result<Option<f64>, ConfigError> {
        match self.measure(key, quantity)? {
            Some(0.0) => Err(self.error(key, "must be greater than zero")),
            value => Ok(value),
        }
    }

    /// A number with its unit, or a list of such, each at least zero; empty where it is absent.
    ///
    /// # Errors
    /// As [`Section::measure`] of one of them.
    pub fn measures(&self, key: &str, quantity: Quantity) -> Result<Vec<f64>, ConfigError> {
        self.note(key, Takes::Quantities(quantity));
        let items = match self.get(key) {
            None => Vec::new(),
            Some(Value::List(items)) => items,
            Some(one) => vec![one],
        };
        let read = items.iter().map(|item| not_negative(item, quantity));
        read.collect::<Result<_, _>>()
            .map_err(|message| self.error(key, message))
    }

    /// The factor to SI of a unit without number, `default` where the key is absent; of a velocity or an angle a
    /// minus before the unit reverses the sign.
    ///
    /// # Errors
    /// If the value is no string, or its text no unit of `quantity`.
    pub fn unit(&self, key: &str, quantity: Quantity, default: f64) -> Result<f64, ConfigError> {
        self.note(key, Takes::Unit(quantity));
        let text = self.string(key)?;
        text.map_or(Ok(default), |text| self.factor_of(key, text, quantity))
    }

    /// The factors to SI of the units of what an inertial sensor measures about x, y and z: one unit, or one of each,
    /// `"deg/s, deg/s, -deg/s"`; a minus before a unit reverses the sign. 1 where the key is absent.
    ///
    /// # Errors
    /// As [`Section::unit`]; for another number of units.
    pub fn units(&self, key: &str, quantity: Quantity) -> Result<Vector3, ConfigError> {
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

    fn factor_of(&self, key: &str, text: &str, quantity: Quantity) -> Result<f64, ConfigError> {
        use Quantity::{Acceleration, Angle, AngularRate, MagneticField, Velocity};
        let signed = matches!(
            quantity,
            Acceleration | Angle | AngularRate | MagneticField | Velocity
        );
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
    pub fn vector(&self, key: &str, quantity: Quantity) -> Result<Option<Vector3>, ConfigError> {
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

/// The number of a value with its unit in `quantity`'s SI unit; or what is wrong.
fn with_unit(value: &Value, quantity: Quantity) -> Result<f64, String> {
    match value {
        Value::Text(text) => {
            units::parse(text, quantity).map_err(|error| format!("\"{text}\": {error}"))
        }
        other => Err(needs_unit(other, quantity)),
    }
}

/// [`with_unit`], not negative.
fn not_negative(value: &Value, quantity: Quantity) -> Result<f64, String> {
    match (with_unit(value, quantity)?, value) {
        (number, Value::Text(text)) if number < 0.0 => Err(format!(
            "\"{text}\" must not be negative; remove the minus sign"
        )),
        (number, _) => Ok(number),
    }
}

/// What is wrong with a value that is no string.
fn needs_unit(value: &Value, quantity: Quantity) -> String {
    let examples = quantity.examples();
    let unit = examples.split('"').nth(1).unwrap_or_default();
    match value {
        Value::Whole(number) | Value::Decimal(number) => {
            format!("the number needs a unit: write \"{number} {unit}\"")
        }
        other => {
            let (name, kind) = (quantity.name(), other.kind());
            format!("must be {name} with its unit such as \"1 {unit}\", not {kind}")
        }
    }
}
