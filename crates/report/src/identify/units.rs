//! Units of a sensor's numbers, as its data sheet gives them.

use crate::numbers::short;
use std::f64::consts::PI;

/// A unit and its factor from SI.
pub(crate) type Unit = (&'static str, f64);

/// Units of a gyro or an accelerometer.
pub(crate) struct Units {
    /// From SI, of samples and their integral.
    pub scale: f64,
    pub sample: &'static str,
    /// Of a sum of squares, SI.
    pub squares: &'static str,
    /// Of the integral.
    pub drift: &'static str,
    pub white: Unit,
    /// Of a bias that varies.
    pub bias: Unit,
    pub walk: Unit,
    /// Of quantisation.
    pub rounding: Unit,
    /// Of turn-on constants.
    pub constant: Unit,
}

const DEG: f64 = 180.0 / PI;
const GYRO: Units = Units {
    scale: DEG,
    sample: "°/s",
    squares: "rad²/s²",
    drift: "°",
    white: ("°/√h", DEG * 60.0),
    bias: ("°/h", DEG * 3600.0),
    walk: ("°/h/√h", DEG * 3600.0 * 60.0),
    rounding: ("arcsec", DEG * 3600.0),
    constant: ("°/s", DEG),
};
const MILLI_G: f64 = 1e3 / undrift_nav::earth::STANDARD_GRAVITY;
const ACCEL: Units = Units {
    scale: 1.0,
    sample: "m/s²",
    squares: "m²/s⁴",
    drift: "m/s",
    white: ("m/s/√h", 60.0),
    bias: ("mg", MILLI_G),
    walk: ("mg/√h", MILLI_G * 60.0),
    rounding: ("mm/s", 1e3),
    constant: ("mg", MILLI_G),
};

/// The units of an axis by its name.
pub(crate) fn units(name: &str) -> &'static Units {
    if name.starts_with("gyro") {
        &GYRO
    } else {
        &ACCEL
    }
}

/// A value, SI, in its unit.
pub(super) fn with_unit(value: f64, (unit, factor): Unit) -> String {
    format!("{} {unit}", short(value * factor))
}
