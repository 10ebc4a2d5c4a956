//! The presets of noise models as a table.

use undrift::{
    base::number::rounded,
    nav::units::{Quantity, unit_factor},
    noise::{AxisModel, ImuModel},
};

const HEADS: [[&str; 2]; 8] = [
    ["", "preset"],
    ["", "sensor"],
    ["gyro N", "deg/√h"],
    ["B", "deg/h"],
    ["on", "deg/s"],
    ["accel N", "µg/√Hz"],
    ["B", "mg"],
    ["on", "mg"],
];
/// Columns of text; the others are numbers.
const TEXTS: usize = 2;
const LEGEND: &str = "\
N: white noise. B: bias instability, σ of the Gauss-Markov process.
on: σ of the bias at switch-on. Each is the largest of the three axes.
Where the numbers are from: `undrift model PRESET --to undrift`";

/// A table at most 80 columns wide.
pub fn table(presets: &[(&str, ImuModel)]) -> String {
    let heads = [0, 1].map(|line| HEADS.map(|head| head[line].to_owned()));
    let rows: Vec<_> = heads
        .into_iter()
        .chain(presets.iter().map(|(name, model)| row(name, model)))
        .collect();
    let width = |column: usize| {
        let lengths = rows.iter().map(|row| row[column].chars().count());
        lengths.max().unwrap_or(0)
    };
    let widths: [usize; HEADS.len()] = std::array::from_fn(width);
    let mut text = String::new();
    for row in &rows {
        let mut line = String::new();
        for (column, (cell, width)) in row.iter().zip(widths).enumerate() {
            line += &match column < TEXTS {
                true => format!("{cell:width$}  "),
                false => format!("{cell:>width$} "),
            };
        }
        text += line.trim_end();
        text.push('\n');
    }
    format!("{text}\n{LEGEND}\n")
}

fn row(name: &str, model: &ImuModel) -> [String; HEADS.len()] {
    let of = |axes: &[AxisModel; 3], value: fn(&AxisModel) -> f64, unit, quantity| {
        let largest = axes.iter().map(value).fold(0.0, f64::max);
        unit_factor(unit, quantity).map_or_else(|e| e.to_string(), |factor| plain(largest / factor))
    };
    let white = |axis: &AxisModel| axis.white.unwrap_or(0.0);
    let bias = |axis: &AxisModel| {
        let variances = axis.instability.iter().map(|process| process.sigma.powi(2));
        variances.sum::<f64>().sqrt()
    };
    let turn_on = |axis: &AxisModel| axis.turn_on;
    let (rate, force) = (Quantity::AngularRate, Quantity::Acceleration);
    [
        name.to_owned(),
        model.name.clone(),
        of(&model.gyro, white, "deg/√h", Quantity::AngleRandomWalk),
        of(&model.gyro, bias, "deg/h", rate),
        of(&model.gyro, turn_on, "deg/s", rate),
        of(&model.accel, white, "µg/√Hz", Quantity::VelocityRandomWalk),
        of(&model.accel, bias, "mg", force),
        of(&model.accel, turn_on, "mg", force),
    ]
}

/// A number with three significant digits or more, without zeros behind them; a dash for zero.
fn plain(value: f64) -> String {
    if value == 0.0 {
        return "-".into();
    }
    match value.abs() < 1000.0 {
        true => rounded(value, 3).to_string(),
        false => format!("{value:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "-"),
            (0.0036, "0.0036"),
            (0.9, "0.9"),
            (20.394_32, "20.4"),
            (0.167_999_999, "0.168"),
            (400.0, "400"),
            (12_345.6, "12346"),
        ] {
            assert_eq!(plain(value), text);
        }
    }
}
