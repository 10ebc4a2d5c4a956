//! Identified models in the terms of a data sheet.

use crate::{
    Cell, Table,
    identify::{Units, floor, is_allan, spoken, units},
    numbers::short,
    plain::{Mark, plain_table},
};
use undrift_results::{Axis, Identify, Number};

/// A row for each axis below one of units for its sensor.
pub(super) fn table(result: &Identify, mark: Mark) -> Option<String> {
    let known = || result.in_order().filter(|(_, axis)| axis.error.is_none());
    let mut rows: Vec<[String; 8]> = Vec::new();
    for sensor in ["gyro", "accel"] {
        let units = units(sensor);
        let axes: Vec<_> = known()
            .filter(|(name, _)| name.starts_with(sensor))
            .collect();
        if axes.is_empty() {
            continue;
        }
        let heads = [
            units.white,
            units.bias,
            units.bias,
            ("s", 1.0),
            units.walk,
            units.rounding,
            units.constant,
        ];
        let mut head = heads.map(|(unit, _)| unit.to_owned()).to_vec();
        head.insert(0, String::new());
        rows.extend(<[String; 8]>::try_from(head));
        rows.extend(axes.into_iter().map(|(name, axis)| row(name, axis, units)));
    }
    if rows.is_empty() {
        return None;
    }
    let heads = ["axis", "N", "B", "σ", "τ", "K", "Q", "turn-on"];
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
        true => "* terms of the Allan deviation: the model recommended is an ARMA",
        false => "",
    };
    Some(format!("{text}{LEGEND}{note}"))
}

/// What the letters are.
const LEGEND: &str = "\
N: angle or velocity random walk, with processes below 1 s. B: bias instability,
  the floor of the Allan deviation over 0.664 (below: no floor yet). σ, τ: Gauss-Markov
  processes. K: rate random walk. Q: quantisation. turn-on: size of the mean
";

/// A process of a shorter correlation time \[s\] is white noise to whoever takes N.
const FAST_S: f64 = 1.0;
/// The random walk K [unit/√s] beside flicker noise, whose own slow part is one, too.
fn walk_beside(flicker: f64, walk: f64) -> f64 {
    let own = undrift_noise::composite::flicker(flicker).1;
    let square = walk * walk - own * own;
    // What rounding leaves does not count.
    if square > 1e-6 * walk * walk {
        square.sqrt()
    } else {
        0.0
    }
}

/// Whether the recommended model has no terms.
fn is_arma(axis: &Axis) -> bool {
    axis.chosen.white.get().is_none()
}

fn row(name: &str, axis: &Axis, units: &Units) -> [String; 8] {
    let chosen = &axis.chosen;
    let scaled = |number: Number, (_, factor): (&str, f64)| match number.get() {
        Some(value) if value > 0.0 => short(value * factor),
        _ => "–".to_owned(),
    };
    let allan = &axis.allan_terms;
    let seen = |term: &undrift_results::Term| if term.seen { term.value } else { f64::NAN };
    let (white, walk, rounding) = match is_arma(axis) {
        true => (
            allan.white.value.into(),
            seen(&allan.random_walk).into(),
            seen(&allan.quantisation).into(),
        ),
        false => (chosen.white, chosen.random_walk, chosen.quantisation),
    };
    let processes = |of: fn(&undrift_noise::GaussMarkov) -> f64, factor: f64| {
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
    let mut walk = walk;
    if let Some(flicker) = chosen.flicker.get() {
        // The processes that approximate flicker noise are not listed.
        processes = ["–".to_owned(), "1/f".to_owned()];
        walk = walk.get().map(|walk| walk_beside(flicker, walk)).into();
    }
    let fast = chosen.gauss_markov.iter().filter(|of| of.tau_s < FAST_S);
    let fast: f64 = fast.map(|of| 2.0 * of.sigma * of.sigma * of.tau_s).sum();
    let white = white.get().map(|white| (white * white + fast).sqrt());
    let bias = floor(axis, units.bias.1);
    let [sigma, tau] = processes;
    let label = if is_arma(axis) {
        format!("{} *", spoken(name))
    } else {
        spoken(name)
    };
    [
        label,
        scaled(white.into(), units.white),
        bias,
        sigma,
        tau,
        scaled(walk, units.walk),
        scaled(rounding, units.rounding),
        scaled(chosen.turn_on, units.constant),
    ]
}
