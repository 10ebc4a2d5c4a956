//! What was done and how it went, in words and counts.

use super::{DEGREES, Run};
use crate::{
    Block, Cell, Section, Table,
    parts::{cell, count, error, named, short, span, table, text, warnings},
};
use undrift::results::{Innovations, Navigate, Nis, Number};

/// NIS per degree of freedom that is told as right.
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 0.6..=1.6;

/// What was done and how it went, in words and counts.
pub(super) fn summary(runs: &[Run<'_>]) -> Section {
    let mut blocks = Vec::new();
    let told: Vec<String> = runs
        .iter()
        .flat_map(|(name, run)| {
            run.warnings.iter().map(move |w| {
                if name.is_empty() {
                    w.clone()
                } else {
                    format!("in {name}: {w}")
                }
            })
        })
        .collect();
    blocks.extend(warnings(&told));
    for (name, run) in runs {
        blocks.extend(text(&what_was_done(name, run)));
    }
    let mut counts = table(
        "updates",
        "Measurements used. NIS / dof is the normalised innovation squared per degree of freedom, 1 when the model is right; the autocorrelation is that of the innovations from one fix to the next, with its 95 % bound for white ones. Left out are those far from the prediction; weakened those that were doubtful and counted less.",
        &[
            "measurement",
            "updates",
            "NIS / dof",
            "autocorrelation",
            "left out",
            "weakened",
        ],
    );
    for (name, run) in runs {
        counts.rows.extend(update_rows(name, run));
    }
    if !counts.rows.is_empty() {
        blocks.push(Block::Table(counts));
    }
    blocks.extend(parameters(runs).map(Block::Table));
    Section {
        title: "What was done".into(),
        blocks,
    }
}

fn what_was_done(name: &str, run: &Navigate) -> Vec<String> {
    let (drive, s) = (&run.drive, &run.summary);
    let mut told = Vec::new();
    let prefix = if name.is_empty() {
        String::new()
    } else {
        format!("{name}: ")
    };
    if let (Some(imu), Some(gnss)) = (&drive.imu, &drive.gnss) {
        let model = drive.model.as_deref().filter(|m| !m.is_empty());
        told.push(format!(
            "{prefix}{imu} at {} Hz was navigated with the {} of {gnss}, with {} run as {}{}.",
            short(drive.rate_hz.0),
            drive.gnss_use.as_deref().unwrap_or("fixes"),
            model.map_or("a noise model".into(), |m| format!(
                "the noise model \"{m}\""
            )),
            run.bias_model,
            if run.smooth {
                ", and smoothed: every sample knows the fixes after it too"
            } else {
                ""
            },
        ));
    }
    let (from, to) = (s.started.0, s.ended.0);
    if from.is_finite() && to.is_finite() {
        told.push(format!(
            "The solution has {} samples from {from:.3} s to {to:.3} s ({}) and used {} fixes.",
            count(s.samples),
            span(to - from),
            count(s.fixes)
        ));
    }
    if !s.alignment.is_empty() {
        told.push(format!("Start: {}.", s.alignment));
    }
    told.extend(
        run.mounting
            .as_ref()
            .map(|m| format!("Mounting estimated: {m}.")),
    );
    for (part, nis) in [("position", &run.position), ("velocity", &run.velocity)] {
        told.push(verdict(part, nis));
    }
    told
}

/// What the innovations of a part of the fixes say.
fn verdict(part: &str, nis: &Nis) -> String {
    let value = nis.nis_per_dof.0;
    let (correlation, bound) = (nis.autocorrelation.0, nis.autocorrelation_bound.0);
    let size = if !value.is_finite() {
        return String::new();
    } else if PLAUSIBLE.contains(&value) {
        format!("The innovations of the {part} are as large as predicted")
    } else if value > 1.0 {
        format!(
            "The innovations of the {part} are {} times as large as predicted: the filter or the stated accuracy is optimistic",
            short(value.sqrt())
        )
    } else {
        format!(
            "The innovations of the {part} are {} times smaller than predicted: the stated accuracy is pessimistic",
            short(value.sqrt().recip())
        )
    };
    let colour = match correlation {
        c if !c.is_finite() => "",
        c if c.abs() <= bound => ", and white",
        c if c.abs() > 0.5 => {
            "; they are strongly correlated from fix to fix, so that the errors of fixes or model last longer than the filter assumes"
        }
        c if c.abs() > 0.2 => "; they are correlated from fix to fix",
        _ => "; they are slightly correlated from fix to fix",
    };
    format!("{size}{colour}.")
}

fn update_rows(name: &str, run: &Navigate) -> Vec<Vec<Cell>> {
    let s = &run.summary;
    let none = Nis::default();
    let kinds: [(&str, &Innovations, &Nis); 6] = [
        ("position", &s.position, &run.position),
        ("velocity", &s.velocity, &run.velocity),
        ("non-holonomic", &s.non_holonomic, &none),
        ("zero velocity", &s.zero_velocity, &none),
        ("odometer", &s.odometer, &none),
        ("barometer", &s.barometer, &none),
    ];
    kinds
        .into_iter()
        .filter(|(_, counts, _)| counts.updates + counts.rejected > 0)
        .map(|(kind, counts, nis)| {
            let measurement = if name.is_empty() {
                kind.to_owned()
            } else {
                format!("{name}: {kind}")
            };
            let correlation = if nis.autocorrelation.0.is_finite() {
                format!(
                    "{:.2} (±{:.2})",
                    nis.autocorrelation.0, nis.autocorrelation_bound.0
                )
            } else {
                "–".into()
            };
            vec![
                measurement.into(),
                count(counts.updates).into(),
                cell(counts.per_dof().unwrap_or(f64::NAN)),
                correlation.into(),
                count(counts.rejected).into(),
                count(counts.weakened).into(),
            ]
        })
        .collect()
}

/// Constants that were estimated.
fn parameters(runs: &[Run<'_>]) -> Option<Table> {
    let mut estimated = table(
        "parameters",
        "Constants estimated beside the sensors' errors, with their standard deviations at the end.",
        &["constant", "unit", "estimate", "standard deviation"],
    );
    for (name, run) in runs {
        for (kind, parameter) in &run.summary.parameters {
            let (constant, unit, factor) = constant(kind);
            let list = |numbers: &[Number], text: fn(f64) -> String| -> Cell {
                let texts: Vec<String> = numbers.iter().map(|n| text(factor * n.0)).collect();
                texts.join(", ").into()
            };
            estimated.rows.push(vec![
                named(name, constant).into(),
                unit.into(),
                list(&parameter.value, short),
                list(&parameter.std, error),
            ]);
        }
    }
    (!estimated.rows.is_empty()).then_some(estimated)
}

/// A kind of [`undrift::nav::parameters::Parameter`] in words, its unit in the report, and what that is of SI.
fn constant(kind: &str) -> (&str, &'static str, f64) {
    match kind {
        "GyroScale" => ("gyro scale factors x, y, z", "%", 100.0),
        "AccelScale" => ("accelerometer scale factors x, y, z", "%", 100.0),
        "GyroMisalignment" => ("gyro axes xy, xz, yx, yz, zx, zy", "°", DEGREES),
        "AccelMisalignment" => ("accelerometer axes xy, xz, yx, yz, zx, zy", "°", DEGREES),
        "LeverArm" => (
            "lever arm forward, right, down, beyond the configured",
            "m",
            1.0,
        ),
        "TimeOffset" => ("fixes later than stamped by", "ms", 1e3),
        "Mounting" => ("vehicle against body: pitch, yaw", "°", DEGREES),
        "Axle" => ("fixed axle further forward by", "m", 1.0),
        "OdometerScale" => ("odometer scale factor", "%", 100.0),
        "BarometerBias" => ("error of the barometric height", "m", 1.0),
        other => (other, "SI", 1.0),
    }
}
