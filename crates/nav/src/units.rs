//! Units as people write them: `"2 deg/sqrt(h)"`, `"0.2 mg"`, `"5 mdps/√Hz"`, `"100 Hz"`.
//!
//! A unit is an expression of symbols with `/`, `*`, `^`, parentheses and square roots
//! (`sqrt(…)`, `√…`, `rt…`). It is read together with its dimension in time, length, angle, temperature and magnetic field, so
//! any spelling of the right dimension works and a wrong one is refused. Angle counts as a
//! dimension of its own here: `m/s` is no angular rate and `1/s` neither. `g` is standard gravity,
//! so `mg` is a thousandth of it, never a mass. A number without a unit is refused, except where
//! the quantity has none.
//!
//! Raw counts of a sensor are a unit of columns ([`unit_factor`]): `LSB/131 deg/s` (131 counts are 1 deg/s), as data sheets write it
//! `131 LSB/(deg/s)` or `8.75 mdps/LSB`, or by sensor and range `mpu6050/250dps`.
//!
//! ```
//! use undrift_nav::units::{Quantity, parse, unit_factor};
//! let density = parse("2 deg/sqrt(h)", Quantity::AngleRandomWalk)?; // [rad/√s]
//! assert!((density - 2f64.to_radians() / 60.0).abs() < 1e-18);
//! assert!(unit_factor("m/s", Quantity::AngularRate).is_err());
//! # Ok::<(), undrift_nav::units::UnitError>(())
//! ```

mod expression;
mod sensor;

use core::fmt;
use expression::Dimension;

/// What a number measures: which units it may have. Each is read into the SI unit given with it, angles in radians.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Angular rate [rad/s].
    AngularRate,
    /// Acceleration or specific force [m/s²].
    Acceleration,
    /// Angle or angle increment \[rad\].
    Angle,
    /// Length \[m\].
    Length,
    /// Time \[s\].
    Time,
    /// Frequency or sample rate \[Hz\].
    Frequency,
    /// Velocity or velocity increment [m/s].
    Velocity,
    /// Angle random walk N, the density of a gyro's white noise [rad/√s = rad/s/√Hz].
    AngleRandomWalk,
    /// Velocity random walk N, the density of an accelerometer's white noise [m/s/√s = m/s²/√Hz].
    VelocityRandomWalk,
    /// Rate random walk K of a gyro's bias [rad/s/√s].
    RateRandomWalk,
    /// Acceleration random walk K of an accelerometer's bias [m/s²/√s].
    AccelerationRandomWalk,
    /// Random walk of a length [m/√s].
    LengthRandomWalk,
    /// Change of an angular rate with temperature [rad/s/K].
    RatePerKelvin,
    /// Quadratic part of the change of an angular rate with temperature [rad/s/K²].
    RatePerKelvin2,
    /// Change of an acceleration with temperature [m/s²/K].
    AccelerationPerKelvin,
    /// Quadratic part of the change of an acceleration with temperature [m/s²/K²].
    AccelerationPerKelvin2,
    /// Magnetic flux density \[T\].
    MagneticField,
    /// Random walk of one [T/√s].
    MagneticRandomWalk,
    /// A pure number.
    Dimensionless,
}

const QUANTITIES: [(Quantity, Dimension, &str, &str); 19] = {
    use Quantity::*;
    [
        (
            AngularRate,
            [-2, 0, 2, 0, 0],
            "an angular rate",
            "\"deg/s\" or \"rad/s\"",
        ),
        (
            Acceleration,
            [-4, 2, 0, 0, 0],
            "an acceleration",
            "\"m/s^2\" or \"mg\"",
        ),
        (Angle, [0, 0, 2, 0, 0], "an angle", "\"deg\" or \"rad\""),
        (Length, [0, 2, 0, 0, 0], "a length", "\"m\" or \"cm\""),
        (Time, [2, 0, 0, 0, 0], "a time", "\"s\" or \"ms\""),
        (
            Frequency,
            [-2, 0, 0, 0, 0],
            "a frequency",
            "\"Hz\" or \"1/s\"",
        ),
        (
            Velocity,
            [-2, 2, 0, 0, 0],
            "a velocity",
            "\"m/s\" or \"km/h\"",
        ),
        (
            AngleRandomWalk,
            [-1, 0, 2, 0, 0],
            "an angle random walk",
            "\"deg/sqrt(h)\" or \"deg/s/sqrt(Hz)\"",
        ),
        (
            VelocityRandomWalk,
            [-3, 2, 0, 0, 0],
            "a velocity random walk",
            "\"m/s/sqrt(h)\" or \"ug/sqrt(Hz)\"",
        ),
        (
            RateRandomWalk,
            [-3, 0, 2, 0, 0],
            "a rate random walk",
            "\"deg/h/sqrt(h)\" or \"rad/s/sqrt(s)\"",
        ),
        (
            AccelerationRandomWalk,
            [-5, 2, 0, 0, 0],
            "an acceleration random walk",
            "\"mg/sqrt(h)\" or \"m/s^2/sqrt(s)\"",
        ),
        (
            LengthRandomWalk,
            [-1, 2, 0, 0, 0],
            "a random walk of a length",
            "\"m/sqrt(h)\" or \"m/sqrt(s)\"",
        ),
        (
            RatePerKelvin,
            [-2, 0, 2, -2, 0],
            "a change of angular rate with temperature",
            "\"deg/h/K\" or \"deg/s/degC\"",
        ),
        (
            RatePerKelvin2,
            [-2, 0, 2, -4, 0],
            "a quadratic change of angular rate with temperature",
            "\"deg/h/K^2\" or \"deg/s/K^2\"",
        ),
        (
            AccelerationPerKelvin,
            [-4, 2, 0, -2, 0],
            "a change of acceleration with temperature",
            "\"ug/K\" or \"mg/degC\"",
        ),
        (
            AccelerationPerKelvin2,
            [-4, 2, 0, -4, 0],
            "a quadratic change of acceleration with temperature",
            "\"ug/K^2\" or \"m/s^2/K^2\"",
        ),
        (
            MagneticField,
            [0, 0, 0, 0, 2],
            "a magnetic field",
            "\"uT\" or \"mG\"",
        ),
        (
            MagneticRandomWalk,
            [-1, 0, 0, 0, 2],
            "a random walk of a magnetic field",
            "\"uT/sqrt(h)\" or \"uT/sqrt(s)\"",
        ),
        (
            Dimensionless,
            [0, 0, 0, 0, 0],
            "a number without unit",
            "\"1.5\" or \"2 %\"",
        ),
    ]
};

impl Quantity {
    fn row(self) -> &'static (Quantity, Dimension, &'static str, &'static str) {
        // Every variant is in the table; the fallback is never taken.
        QUANTITIES
            .iter()
            .find(|row| row.0 == self)
            .unwrap_or(&QUANTITIES[18])
    }

    /// Its name with an article, as in "an angular rate".
    ///
    /// ```
    /// use undrift_nav::units::Quantity;
    /// let message = format!("expected {} such as {}", Quantity::AngularRate.name(), Quantity::AngularRate.examples());
    /// assert_eq!(message, "expected an angular rate such as \"deg/s\" or \"rad/s\"");
    /// ```
    pub fn name(self) -> &'static str {
        self.row().2
    }

    /// Two spellings of its unit, each in quotes: `"deg/s" or "rad/s"`.
    pub fn examples(self) -> &'static str {
        self.row().3
    }
}

/// A word of the input kept for an error's message, cut to 24 bytes at a character's boundary: no allocation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    bytes: [u8; 24],
    len: u8,
}

impl Word {
    fn new(text: &str) -> Self {
        let mut bytes = [0; 24];
        let mut len = text.len().min(bytes.len());
        while !text.is_char_boundary(len) {
            len -= 1;
        }
        bytes[..len].copy_from_slice(&text.as_bytes()[..len]);
        Self {
            bytes,
            len: len as u8,
        }
    }

    /// The word, as far as it was kept.
    pub fn as_str(&self) -> &str {
        core::str::from_utf8(&self.bytes[..usize::from(self.len)]).unwrap_or("")
    }
}

/// Why a text is not a number with a unit of the wanted quantity. Its message names the fault, then two spellings that would do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitError {
    /// Quantity that was asked for.
    pub expected: Quantity,
    /// The fault, for code that treats one kind apart.
    pub kind: UnitErrorKind,
}

/// What is wrong with a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitErrorKind {
    /// The text does not start with a finite number.
    NoNumber,
    /// There is no unit.
    NoUnit,
    /// This symbol is not a unit known here; symbols are case-sensitive.
    UnknownUnit(Word),
    /// The unit cannot be read from here on.
    Malformed(Word),
    /// The unit measures something else, named if it is one of [`Quantity`].
    WrongDimension(Option<Quantity>),
    /// Raw counts: a unit of columns, and of no quantity but those that sensors, receivers and clocks count.
    Counts,
}

impl fmt::Display for UnitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            UnitErrorKind::NoNumber => f.write_str("does not start with a finite number; ")?,
            UnitErrorKind::NoUnit => f.write_str("the unit is missing; ")?,
            UnitErrorKind::UnknownUnit(word) => write!(f, "unknown unit \"{}\"; ", word.as_str())?,
            UnitErrorKind::Malformed(word) if word.len == 0 => {
                f.write_str("the unit is incomplete; ")?
            }
            UnitErrorKind::Malformed(word) => {
                write!(f, "the unit cannot be read at \"{}\"; ", word.as_str())?
            }
            UnitErrorKind::WrongDimension(Some(found)) => {
                write!(f, "that is the unit of {}; ", found.name())?
            }
            UnitErrorKind::WrongDimension(None) => {
                f.write_str("the unit has a wrong dimension; ")?
            }
            UnitErrorKind::Counts => {
                f.write_str("raw counts (LSB) are a unit of columns of samples only; ")?
            }
        }
        write!(
            f,
            "expected {} such as {}",
            self.expected.name(),
            self.expected.examples()
        )
    }
}

impl core::error::Error for UnitError {}

/// The factor that turns a number in `unit` into SI and radians, e.g. π/180 for `"deg/s"`, and π/180/131 for
/// the raw counts of `"LSB/131 deg/s"`.
///
/// # Errors
/// No unit where the quantity has one, a unit that cannot be read, or one of another dimension.
///
/// ```
/// use undrift_nav::units::{Quantity, unit_factor};
/// let count = unit_factor("LSB/131 deg/s", Quantity::AngularRate)?; // Of a raw gyro column.
/// assert!((131.0 * count - 1f64.to_radians()).abs() < 1e-15);
/// assert_eq!(unit_factor("131 LSB/(deg/s)", Quantity::AngularRate)?, count);
/// let error = unit_factor("m/s", Quantity::Acceleration).unwrap_err();
/// assert!(error.to_string().contains("unit of a velocity"));
/// # Ok::<(), undrift_nav::units::UnitError>(())
/// ```
pub fn unit_factor(unit: &str, quantity: Quantity) -> Result<f64, UnitError> {
    factor(unit, quantity).map(|(factor, _)| factor)
}

/// The factor of a unit, and whether the unit is one of raw counts.
fn factor(unit: &str, quantity: Quantity) -> Result<(f64, bool), UnitError> {
    let error = |kind| UnitError {
        expected: quantity,
        kind,
    };
    let unit = unit.trim();
    if unit.is_empty() {
        return match quantity {
            Quantity::Dimensionless => Ok((1.0, false)),
            _ => Err(error(UnitErrorKind::NoUnit)),
        };
    }
    let mut value = match sensor::read(unit) {
        Some(of_sensor) => of_sensor.map_err(error)?,
        None => expression::read(unit).map_err(error)?,
    };
    if value.counts != 0 {
        use Quantity::{Acceleration, Angle, AngularRate, Length, Time, Velocity};
        if !matches!(
            quantity,
            AngularRate | Acceleration | Angle | Velocity | Time | Length
        ) {
            return Err(error(UnitErrorKind::Counts));
        }
        // A sensitivity, counts a unit.
        if value.counts == 2 && value.dimension == quantity.row().1.map(|exponent| -exponent) {
            value.factor = 1.0 / value.factor;
            value.dimension = quantity.row().1;
        } else if value.counts.abs() != 2 {
            return Err(error(UnitErrorKind::WrongDimension(None)));
        }
    }
    if value.dimension != quantity.row().1 {
        let found = QUANTITIES.iter().find(|row| row.1 == value.dimension);
        return Err(error(UnitErrorKind::WrongDimension(found.map(|row| row.0))));
    }
    if !(value.factor.is_finite() && value.factor > 0.0) {
        return Err(error(UnitErrorKind::Malformed(Word::new(unit))));
    }
    Ok((value.factor, value.counts != 0))
}

/// A number with its unit, in SI and radians: `parse("25 deg/h", Quantity::AngularRate)` is 1.2e-4. A true minus sign (U+2212) is
/// read, too. Raw counts are refused: they are units of columns.
///
/// # Errors
/// No finite number at the start, or as [`unit_factor`].
///
/// ```
/// use undrift_nav::units::{Quantity, UnitErrorKind, parse};
/// assert!((parse("25 deg/h", Quantity::AngularRate)? - 1.212e-4).abs() < 1e-7);
/// assert_eq!(parse("0.5 mg", Quantity::Acceleration)?, 0.5e-3 * 9.80665);
/// // The same dimension is not enough: an angle is not a pure number here.
/// let error = parse("5 1/s", Quantity::AngularRate).unwrap_err();
/// assert_eq!(error.kind, UnitErrorKind::WrongDimension(Some(Quantity::Frequency)));
/// assert_eq!(parse("5", Quantity::AngularRate).unwrap_err().kind, UnitErrorKind::NoUnit);
/// # Ok::<(), undrift_nav::units::UnitError>(())
/// ```
pub fn parse(text: &str, quantity: Quantity) -> Result<f64, UnitError> {
    let error = |kind| UnitError {
        expected: quantity,
        kind,
    };
    let text = text.trim();
    // The true minus sign, which word processors and data sheets write.
    let (negative, digits) = match text.strip_prefix('\u{2212}') {
        Some(rest) if rest.starts_with(|c: char| c.is_ascii_digit() || c == '.') => (true, rest),
        _ => (false, text),
    };
    let end = expression::number_length(digits);
    let number: f64 = digits[..end]
        .parse()
        .map_err(|_| error(UnitErrorKind::NoNumber))?;
    let value = match factor(&digits[end..], quantity)? {
        (_, true) => return Err(error(UnitErrorKind::Counts)),
        (factor, false) => number * factor,
    };
    if !value.is_finite() {
        return Err(error(UnitErrorKind::NoNumber));
    }
    Ok(if negative { -value } else { value })
}

#[cfg(test)]
mod tests;
