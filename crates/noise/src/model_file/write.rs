//! Writing of model files, in the units of data sheets.

use super::{AXES, AxisModel, FORMAT, ImuModel, VERSION};
use crate::composite::GaussMarkov;
use std::fmt::Write;
use undrift_nav::units::{self, Quantity};

/// The units written: level at turn-on and in ARMA, slow bias, white noise, random walk, rounding of
/// the integrated signal.
struct Units {
    slow: (&'static str, Quantity),
    level: (&'static str, Quantity),
    noise: (&'static str, Quantity),
    walk: (&'static str, Quantity),
    rounding: (&'static str, Quantity),
}

const GYRO: Units = Units {
    level: ("deg/s", Quantity::AngularRate),
    slow: ("deg/h", Quantity::AngularRate),
    noise: ("deg/sqrt(h)", Quantity::AngleRandomWalk),
    walk: ("deg/h/sqrt(h)", Quantity::RateRandomWalk),
    rounding: ("deg", Quantity::Angle),
};
const ACCEL: Units = Units {
    level: ("mg", Quantity::Acceleration),
    slow: ("mg", Quantity::Acceleration),
    noise: ("m/s/sqrt(h)", Quantity::VelocityRandomWalk),
    walk: ("mg/sqrt(h)", Quantity::AccelerationRandomWalk),
    rounding: ("m/s", Quantity::Velocity),
};

const HERTZ: (&str, Quantity) = ("Hz", Quantity::Frequency);

pub(super) fn to_text(model: &ImuModel) -> String {
    let mut out = String::new();
    line(&mut out, "format", &quoted(FORMAT));
    line(&mut out, "version", &VERSION.to_string());
    line(&mut out, "name", &quoted(&model.name));
    line(&mut out, "source", &quoted(&model.source));
    let p = &model.provenance;
    if *p != super::Provenance::default() {
        out.push_str("\n[provenance]\n");
        let text = |text: &Option<String>| text.as_deref().map(quoted);
        let entries = [
            ("record", text(&p.record)),
            ("sha256", text(&p.sha256)),
            ("program", text(&p.program)),
            ("rate", p.rate_hz.map(|rate| measure(rate, HERTZ))),
            ("samples", p.samples.map(|samples| samples.to_string())),
        ];
        for (key, value) in entries {
            value.iter().for_each(|value| line(&mut out, key, value));
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

fn axis(out: &mut String, name: &str, axis: &AxisModel, units: &Units) {
    // Writing into a String cannot fail.
    let _ = writeln!(out, "\n[{name}]");
    let one = |value: Option<f64>, unit| value.map(|value| measure(value, unit));
    let list = |of: fn(&GaussMarkov) -> f64, unit| {
        let values: Vec<f64> = axis.instability.iter().map(of).collect();
        (!values.is_empty()).then(|| measures(&values, unit))
    };
    let entries = [
        ("turn_on", one(Some(axis.turn_on), units.level)),
        ("white_noise", one(axis.white, units.noise)),
        ("quantisation", one(axis.quantisation, units.rounding)),
        ("bias_instability", list(|p| p.sigma, units.slow)),
        ("correlation_time", list(|p| p.tau_s, ("s", Quantity::Time))),
        ("random_walk", one(axis.random_walk, units.walk)),
        ("paper_sigma", one(axis.paper_sigma, units.level)),
    ];
    for (key, value) in entries {
        value.iter().for_each(|value| line(out, key, value));
    }
    if let Some(arma) = &axis.arma {
        let _ = writeln!(out, "\n[{name}.arma]");
        line(out, "rate", &measure(arma.rate_hz, HERTZ));
        line(out, "ar", &format!("{:?}", arma.ar));
        line(out, "ma", &format!("{:?}", arma.ma));
        line(out, "sigma", &measure(arma.sigma, units.level));
    }
    if !axis.identification.is_empty() {
        let _ = writeln!(out, "\n[{name}.identification]");
        for (key, value) in &axis.identification {
            line(out, &as_key(key), &value.to_string());
        }
    }
}

fn line(out: &mut String, key: &str, value: &str) {
    let _ = writeln!(out, "{key} = {value}");
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// A key, bare where it can be; a key in quotes is never of more than one line.
fn as_key(key: &str) -> String {
    let is_bare = |b: u8| b.is_ascii_alphanumeric() || b == b'_' || b == b'-';
    if !key.is_empty() && key.bytes().all(is_bare) {
        return key.to_owned();
    }
    let mut out = String::from("\"");
    for c in key.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// One number as it is, several as a list.
fn measures(values: &[f64], unit: (&str, Quantity)) -> String {
    match values {
        [one] => measure(*one, unit),
        _ => {
            let items: Vec<String> = values.iter().map(|v| measure(*v, unit)).collect();
            format!("[{}]", items.join(", "))
        }
    }
}

/// The number in few digits: up to fifteen that read back as it to rounding, or as many as are needed
/// to have it exactly. A number that no text reads back as, since the product with the unit's factor
/// rounds, gives way to its neighbour. What is read from the text is written as the same text.
fn measure(mut value: f64, (unit, quantity): (&str, Quantity)) -> String {
    let factor = units::unit_factor(unit, quantity).unwrap_or(1.0);
    let written = |number: f64, digits: usize| {
        let rounded: f64 = format!("{number:.digits$e}").parse().unwrap_or(number);
        if rounded == 0.0 || (1e-5..1e7).contains(&rounded.abs()) {
            format!("{rounded} {unit}")
        } else {
            format!("{rounded:e} {unit}")
        }
    };
    let read = |text: &String| units::parse(text, quantity).unwrap_or(f64::NAN);
    for _ in 0..2 {
        let number = value / factor;
        // Two texts of fifteen digits are at least 1e-15 apart.
        let is_near = |text: &String| (read(text) - value).abs() <= 5e-16 * value.abs();
        let about = [number, number.next_down(), number.next_up()];
        let found = (0..15)
            .map(|digits| written(number, digits))
            .find(is_near)
            .or_else(|| {
                (15..17)
                    .flat_map(|digits| about.map(|number| written(number, digits)))
                    .find(|text| read(text) == value)
            });
        if let Some(text) = found {
            return quoted(&text);
        }
        value = read(&written(number, 16));
    }
    quoted(&written(value / factor, 16))
}
