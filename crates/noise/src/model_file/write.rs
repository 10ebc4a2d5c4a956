//! Writing of model files, in the units of data sheets and in as few digits as carry what is known.
//!
//! What [`super::read`] reads gives the same model to six digits, and written again the same text. Units are
//! those of data sheets: deg/√h, deg/h, mg, m/s/√h. Coefficients of an ARMA get as many digits as their roots
//! need ([`round`]). Three axes that are alike are one table.
//!
//! Six digits are those of the unit that is written, not of SI: else a number that is read back and
//! written again could change its last digit. Coefficients are the exception since with φ and θ near
//! 1 the sixth digit of φ moves the correlation time.
//!
//! Called by [`ImuModel::to_toml`]. Free text goes through [`text`], which quotes and escapes it.

mod round;
mod value;

use super::{AXES, AxisModel, FORMAT, ImuModel, VERSION};
use crate::composite::GaussMarkov;
use round::{coefficients, six_digits};
use std::fmt::Write;
use undrift_nav::units::{self, Quantity};
use value::{as_key, filled, text};

/// The units written: level at turn-on and in ARMA, slow bias, white noise, random walk, rounding of
/// the integrated signal, slope and quadratic over temperature.
struct Units {
    /// Standard deviation of a Gauss-Markov process.
    slow: (&'static str, Quantity),
    /// Turn-on constant, amplitude of a line, σ of an ARMA.
    level: (&'static str, Quantity),
    /// Density N of the white noise.
    noise: (&'static str, Quantity),
    /// Random walk K of the bias.
    walk: (&'static str, Quantity),
    /// Quantisation Q of the integrated signal.
    rounding: (&'static str, Quantity),
    /// Linear part over temperature.
    slope: (&'static str, Quantity),
    /// Quadratic part over temperature.
    quadratic: (&'static str, Quantity),
}

/// Units of gyro axes, as their data sheets give them.
const GYRO: Units = Units {
    level: ("deg/s", Quantity::AngularRate),
    slow: ("deg/h", Quantity::AngularRate),
    noise: ("deg/sqrt(h)", Quantity::AngleRandomWalk),
    walk: ("deg/h/sqrt(h)", Quantity::RateRandomWalk),
    rounding: ("deg", Quantity::Angle),
    slope: ("deg/h/K", Quantity::RatePerKelvin),
    quadratic: ("deg/h/K^2", Quantity::RatePerKelvin2),
};
/// Units of accelerometer axes.
const ACCEL: Units = Units {
    level: ("mg", Quantity::Acceleration),
    slow: ("mg", Quantity::Acceleration),
    noise: ("m/s/sqrt(h)", Quantity::VelocityRandomWalk),
    walk: ("mg/sqrt(h)", Quantity::AccelerationRandomWalk),
    rounding: ("m/s", Quantity::Velocity),
    slope: ("ug/K", Quantity::AccelerationPerKelvin),
    quadratic: ("ug/K^2", Quantity::AccelerationPerKelvin2),
};

/// Unit of rates and frequencies.
const HERTZ: (&str, Quantity) = ("Hz", Quantity::Frequency);
/// Unit of correlation times.
const SECONDS: (&str, Quantity) = ("s", Quantity::Time);

/// The text of a model file.
///
/// The order is that of the documentation: head, provenance, gyros, accelerometers. Axes without a model
/// are not written.
///
/// `[provenance]` is written only where something of it is known. Three equal axes become `[gyro]`
/// or `[accel]`; otherwise each known axis has its own table.
pub(super) fn to_text(model: &ImuModel) -> String {
    let mut out = String::new();
    line(&mut out, "format", &text("format", FORMAT));
    line(&mut out, "version", &VERSION.to_string());
    line(&mut out, "name", &text("name", &model.name));
    line(&mut out, "source", &text("source", &model.source));
    let p = &model.provenance;
    if *p != super::Provenance::default() {
        out.push_str("\n[provenance]\n");
        let known = |key, value: &Option<String>| value.as_deref().map(|value| text(key, value));
        let entries = [
            ("record", known("record", &p.record)),
            ("sha256", known("sha256", &p.sha256)),
            ("program", known("program", &p.program)),
            ("rate", p.rate_hz.map(|rate| measure(rate, HERTZ))),
            ("samples", p.samples.map(|samples| samples.to_string())),
        ];
        for (key, value) in entries {
            value.iter().for_each(|value| line(&mut out, key, value));
        }
        for recording in &p.recordings {
            out.push_str("\n[[provenance.recording]]\n");
            line(&mut out, "record", &text("record", &recording.record));
            let samples = recording.samples.map(|samples| samples.to_string());
            let entries = [
                ("sha256", known("sha256", &recording.sha256)),
                ("samples", samples),
            ];
            for (key, value) in entries {
                value.iter().for_each(|value| line(&mut out, key, value));
            }
        }
    }
    for (group, axes, units, names) in [
        ("gyro", &model.gyro, &GYRO, &AXES[..3]),
        ("accel", &model.accel, &ACCEL, &AXES[3..]),
    ] {
        if !axes.iter().any(AxisModel::is_known) {
            continue;
        }
        if axes[0] == axes[1] && axes[0] == axes[2] {
            axis(&mut out, group, &axes[0], units);
        } else {
            for (name, model) in names.iter().zip(axes) {
                if model.is_known() {
                    axis(&mut out, name, model, units);
                }
            }
        }
    }
    out
}

/// Writes one axis, or a group of three that are alike, under its name.
///
/// The turn-on constant is written even where it is 0, so that a reader sees that there is none.
///
/// Terms that are `None` or empty are not written. Order: terms of the data sheet, `arma`, `line`,
/// `temperature`, `identification`.
fn axis(out: &mut String, name: &str, axis: &AxisModel, units: &Units) {
    // Writing into a String cannot fail.
    let _ = writeln!(out, "\n[{name}]");
    let one = |value: Option<f64>, unit| value.map(|value| measure(value, unit));
    let list = |of: fn(&GaussMarkov) -> f64, unit| {
        let values = axis.instability.iter().map(|p| measure(of(p), unit));
        let values: Vec<String> = values.collect();
        match values.as_slice() {
            [] => None,
            [one] => Some(one.clone()),
            several => Some(format!("[{}]", several.join(", "))),
        }
    };
    let entries = [
        ("turn_on", one(Some(axis.turn_on), units.level)),
        ("white_noise", one(axis.white, units.noise)),
        ("quantisation", one(axis.quantisation, units.rounding)),
        ("bias_instability", list(|p| p.sigma, units.slow)),
        ("correlation_time", list(|p| p.tau_s, SECONDS)),
        ("random_walk", one(axis.random_walk, units.walk)),
        ("paper_sigma", one(axis.paper_sigma, units.level)),
    ];
    for (key, value) in entries {
        value.iter().for_each(|value| line(out, key, value));
    }
    if let Some(arma) = &axis.arma {
        let _ = writeln!(out, "\n[{name}.arma]");
        line(out, "rate", &measure(arma.rate_hz, HERTZ));
        let [ar, ma] = coefficients(arma);
        line(out, "ar", &numbers("ar", &ar));
        line(out, "ma", &numbers("ma", &ma));
        line(out, "sigma", &measure(arma.sigma, units.level));
    }
    for of in &axis.lines {
        let _ = writeln!(out, "\n[[{name}.line]]");
        line(out, "frequency", &measure(of.frequency_hz, HERTZ));
        line(out, "amplitude", &measure(of.amplitude, units.level));
        if of.width_hz > 0.0 {
            line(out, "width", &measure(of.width_hz, HERTZ));
        }
    }
    if let Some(of) = &axis.temperature {
        let _ = writeln!(out, "\n[{name}.temperature]");
        let celsius = |value| format!("\"{} degC\"", six_digits(value));
        line(out, "reference", &celsius(of.reference_c));
        line(out, "lowest", &celsius(of.range_c[0]));
        line(out, "highest", &celsius(of.range_c[1]));
        line(out, "slope", &measure(of.slope, units.slope));
        let entries = [
            ("slope_sigma", of.slope_sigma, units.slope),
            ("quadratic", of.quadratic, units.quadratic),
            ("quadratic_sigma", of.quadratic_sigma, units.quadratic),
        ];
        for (key, value, unit) in entries.into_iter().filter(|(_, value, _)| *value != 0.0) {
            line(out, key, &measure(value, unit));
        }
        if of.body_axes {
            line(out, "axes", &text("axes", "body"));
        }
    }
    if !axis.identification.is_empty() {
        table(out, &format!("{name}.identification"), &axis.identification);
    }
}

/// A table and the tables in it, each with a head of its own.
///
/// Values first, then tables, as TOML requires: a key after `[a.b]` would belong to it.
fn table(out: &mut String, path: &str, entries: &toml::Table) {
    let _ = writeln!(out, "\n[{path}]");
    for (key, value) in entries.iter().filter(|(_, value)| !value.is_table()) {
        let key = as_key(key);
        let value = match value {
            toml::Value::String(one) => text(&key, one),
            toml::Value::Array(items) => filled(&key, items.iter().map(ToString::to_string)),
            other => other.to_string(),
        };
        line(out, &key, &value);
    }
    for (key, value) in entries {
        if let Some(entries) = value.as_table() {
            table(out, &format!("{path}.{}", as_key(key)), entries);
        }
    }
}

/// One `key = value`, the value already in TOML's syntax.
fn line(out: &mut String, key: &str, value: &str) {
    let _ = writeln!(out, "{key} = {value}");
}

/// A key with a list of numbers.
fn numbers(key: &str, values: &[f64]) -> String {
    filled(key, values.iter().map(|value| format!("{value:?}")))
}

/// The number in six digits: what is read from the text is written as the same text.
///
/// Between 1e-5 and 1e7 in positional notation, outside in scientific notation.
fn measure(value: f64, (unit, quantity): (&str, Quantity)) -> String {
    let number = six_digits(value / units::unit_factor(unit, quantity).unwrap_or(1.0));
    if number == 0.0 || (1e-5..1e7).contains(&number.abs()) {
        format!("\"{number} {unit}\"")
    } else {
        format!("\"{number:e} {unit}\"")
    }
}
