//! Identified models in the terms of a data sheet.

use crate::{
    Cell, Table,
    identify::spoken,
    numbers::{short, span},
    plain::{Mark, plain_table},
};
use std::f64::consts::PI;
use undrift::{
    noise::screening::{RecordError, rounding::MOSTLY_SHOWN},
    results::{Axis, Identify, Number, ParameterInterval},
};

/// Units of a sensor's terms, and their factors from SI.
struct Units {
    white: (&'static str, f64),
    bias: (&'static str, f64),
    walk: (&'static str, f64),
    rounding: (&'static str, f64),
    constant: (&'static str, f64),
}

const DEG: f64 = 180.0 / PI;
const GYRO: Units = Units {
    white: ("°/√h", DEG * 60.0),
    bias: ("°/h", DEG * 3600.0),
    walk: ("°/h/√h", DEG * 3600.0 * 60.0),
    rounding: ("arcsec", DEG * 3600.0),
    constant: ("°/s", DEG),
};
const MILLI_G: f64 = 1e3 / undrift::nav::earth::STANDARD_GRAVITY;
const ACCEL: Units = Units {
    white: ("m/s/√h", 60.0),
    bias: ("mg", MILLI_G),
    walk: ("mg/√h", MILLI_G * 60.0),
    rounding: ("mm/s", 1e3),
    constant: ("mg", MILLI_G),
};

/// Whether the record serves, and why not.
pub(crate) fn verdict(result: &Identify) -> String {
    let axes: Vec<(&str, &Axis)> = result.in_order().collect();
    let known = axes.iter().filter(|(_, axis)| axis.error.is_none());
    let known: Vec<_> = known.collect();
    let doubts: Vec<String> = axes
        .iter()
        .filter_map(|(name, axis)| doubt(name, axis))
        .collect();
    let doubts = doubts.join("; ");
    let Some((_, first)) = known.first() else {
        return format!("Not usable: {doubts}.");
    };
    let rate = result.rate_hz.0;
    let of = match known.len() {
        n if n < axes.len() => format!("{n} of {} axes", axes.len()),
        1 => "1 axis".to_owned(),
        n => format!("{n} axes"),
    };
    let recordings = match &result.pool {
        Some(pool) => format!(" in {} recordings", pool.records.len()),
        None => String::new(),
    };
    let record = format!(
        "{of}, {}{recordings} at {} Hz",
        span(first.samples as f64 / rate),
        short(rate)
    );
    let horizon = first.chosen.drift_score.keys();
    let longest = horizon
        .filter_map(|key| key.parse::<f64>().ok())
        .fold(0.0, f64::max);
    let brief = match longest {
        _ if is_allan(result) => " Allan deviations alone: no models.".to_owned(),
        60.0.. => String::new(),
        s => format!(" It is too short to judge drifts beyond {s} s."),
    };
    match doubts.as_str() {
        "" => format!("Usable: {record}.{brief}"),
        doubts => format!("Usable with care: {doubts} ({record}).{brief}"),
    }
}

/// Why an axis is not to be trusted.
fn doubt(name: &str, axis: &Axis) -> Option<String> {
    let why = match &axis.error {
        Some(error) if *error == RecordError::Constant.to_string() => {
            let name = spoken(name);
            return Some(format!(
                "{name} is constant and was left out; check its column or the sensor"
            ));
        }
        Some(error) => error.as_str(),
        None if axis.moving == Some(true) => "the recording is not static",
        None if !axis.saturation.is_empty() => "the axis is saturated",
        None if !axis.hanging.is_empty() => "the sensor is frozen",
        None if axis.noise_shown.is_some_and(|share| share.0 < MOSTLY_SHOWN) => {
            "rounding hides most of the noise"
        }
        None => return None,
    };
    Some(format!("{}: {why}", spoken(name)))
}

/// A row for each axis below one of units for its sensor.
pub(super) fn table(result: &Identify, mark: Mark) -> String {
    let known = || result.in_order().filter(|(_, axis)| axis.error.is_none());
    let mut rows: Vec<[String; 7]> = Vec::new();
    for (sensor, units) in [("gyro", &GYRO), ("accel", &ACCEL)] {
        let axes: Vec<_> = known()
            .filter(|(name, _)| name.starts_with(sensor))
            .collect();
        if axes.is_empty() {
            continue;
        }
        let heads = [
            units.white,
            units.bias,
            ("s", 1.0),
            units.walk,
            units.rounding,
            units.constant,
        ];
        let mut head = heads.map(|(unit, _)| unit.to_owned()).to_vec();
        head.insert(0, String::new());
        rows.extend(<[String; 7]>::try_from(head));
        rows.extend(axes.into_iter().map(|(name, axis)| row(name, axis, units)));
    }
    if rows.is_empty() {
        return String::new();
    }
    let heads = ["axis", "N", "B", "τ", "K", "Q", "turn-on"];
    let table = Table {
        name: String::new(),
        caption: String::new(),
        head: heads.map(str::to_owned).to_vec(),
        rows: rows
            .into_iter()
            .map(|row| row.map(Cell::from).to_vec())
            .collect(),
    };
    let text = plain_table(&table, mark);
    let of_allan = !is_allan(result) && known().any(|(_, axis)| is_arma(axis));
    let note = match of_allan {
        true => "* terms of the Allan deviation: the model recommended is an ARMA\n",
        false => "",
    };
    format!("{text}{note}")
}

/// Whether the result is of the Allan deviations alone.
fn is_allan(result: &Identify) -> bool {
    result.axes.values().all(|axis| axis.candidates.is_empty())
}

/// Whether the recommended model has no terms.
fn is_arma(axis: &Axis) -> bool {
    axis.chosen.white.get().is_none()
}

/// What the record says of the parameters of an axis' model, each with its unit and factor from SI.
pub(crate) fn bounds(name: &str, axis: &Axis) -> Vec<Bound> {
    let units = if name.starts_with("gyro") {
        &GYRO
    } else {
        &ACCEL
    };
    let bound = |found: &ParameterInterval| {
        let (unit, factor) = match found.parameter.chars().next() {
            Some('N') => units.white,
            Some('K') => units.walk,
            Some('Q') => units.rounding,
            Some('τ') => ("s", 1.0),
            _ => units.bias,
        };
        let end = |end: Number| end.get().filter(|end| *end > 0.0).map(|end| end * factor);
        Bound {
            parameter: found.parameter.clone(),
            unit,
            estimate: found.estimate.0 * factor,
            low: end(found.low),
            high: end(found.high),
        }
    };
    axis.intervals.iter().map(bound).collect()
}

/// A parameter and its 95 % interval; an end that is missing is not bounded by the record.
pub(crate) struct Bound {
    pub parameter: String,
    pub unit: &'static str,
    pub estimate: f64,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

impl Bound {
    /// "1.2 to 3.4", "above 1.2", "below 3.4" or "anything".
    pub(crate) fn interval(&self) -> String {
        match (self.low, self.high) {
            (Some(low), Some(high)) => format!("{} to {}", short(low), short(high)),
            (Some(low), None) => format!("above {}", short(low)),
            (None, Some(high)) => format!("below {}", short(high)),
            (None, None) => "not determined".to_owned(),
        }
    }
}

fn row(name: &str, axis: &Axis, units: &Units) -> [String; 7] {
    let chosen = &axis.chosen;
    let scaled = |number: Number, (_, factor): (&str, f64)| match number.get() {
        Some(value) if value > 0.0 => short(value * factor),
        _ => "–".to_owned(),
    };
    let allan = &axis.allan_terms;
    let seen = |term: &undrift::results::Term| if term.seen { term.value } else { f64::NAN };
    let (white, walk, rounding) = match is_arma(axis) {
        true => (
            allan.white.value.into(),
            seen(&allan.random_walk).into(),
            seen(&allan.quantisation).into(),
        ),
        false => (chosen.white, chosen.random_walk, chosen.quantisation),
    };
    let processes = |of: fn(&undrift::noise::GaussMarkov) -> f64, factor: f64| {
        let values = chosen
            .gauss_markov
            .iter()
            .map(|process| short(of(process) * factor));
        match Vec::from_iter(values).join(", ") {
            none if none.is_empty() => "–".to_owned(),
            values => values,
        }
    };
    let mut processes = [
        processes(|process| process.sigma, units.bias.1),
        processes(|process| process.tau_s, 1.0),
    ];
    let mut walk = scaled(walk, units.walk);
    if chosen.flicker.get().is_some() {
        // What stands for it is no finding of its own.
        processes = [scaled(chosen.flicker, units.bias), "1/f".to_owned()];
        walk = "–".to_owned();
    }
    let [bias, tau] = processes;
    let label = if is_arma(axis) {
        format!("{} *", spoken(name))
    } else {
        spoken(name)
    };
    [
        label,
        scaled(white, units.white),
        bias,
        tau,
        walk,
        scaled(rounding, units.rounding),
        scaled(chosen.turn_on, units.constant),
    ]
}
