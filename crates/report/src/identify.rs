//! The report of an identified record: the source paper's Figures 1 and 3, Tables 2 and 3, the Allan
//! deviation and the candidates with their drift.

mod axis;

use super::{
    Block, Cell, Panel, Section, Series,
    parts::{cell, count, figure, short, span, table, text, warnings, zip},
};
use axis::{allan_panel, of_axis, psd};
use std::f64::consts::PI;
use undrift::noise::{model_file::AXES, normality::Test};
use undrift::results::{Axis, Identify, Term};

/// A record with its name; the name of a single one is empty.
pub type Run<'a> = (String, &'a Identify);

/// Colours of the runs.
const COLOURS: [usize; 6] = [7, 6, 4, 5, 2, 0];
/// Level of the tests.
const LEVEL: f64 = 0.05;

/// Units of an axis in the report.
struct Units {
    /// From SI.
    scale: f64,
    /// Of a sample.
    sample: &'static str,
    /// Of a sum of squares, SI.
    squares: &'static str,
    /// Of white noise, a root of an hour.
    white: &'static str,
    /// Of bias instability and what it is of SI.
    instability: &'static str,
    instability_scale: f64,
    /// Of a random walk's growth, the square root of an hour, and what it is of SI.
    walk: &'static str,
    walk_scale: f64,
    /// Of the integral.
    drift: &'static str,
}

const GYRO: Units = Units {
    scale: 180.0 / PI,
    sample: "°/s",
    squares: "rad²/s²",
    white: "°/√h",
    instability: "°/h",
    instability_scale: 180.0 / PI * 3600.0,
    walk: "°/h/√h",
    walk_scale: 180.0 / PI * 3600.0 * 60.0,
    drift: "°",
};
const ACCEL: Units = Units {
    scale: 1.0,
    sample: "m/s²",
    squares: "m²/s⁴",
    white: "m/s/√h",
    instability: "µg",
    instability_scale: 1e6 / 9.806_65,
    walk: "µg/√h",
    walk_scale: 1e6 / 9.806_65 * 60.0,
    drift: "m/s",
};

fn units(name: &str) -> &'static Units {
    if name.starts_with("gyro") {
        &GYRO
    } else {
        &ACCEL
    }
}

/// "Gyro x" of "gyro_x".
fn heading(name: &str) -> String {
    let name = spoken(name);
    let mut letters = name.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.chain(letters).collect()
}

/// "gyro x" of "gyro_x".
fn spoken(name: &str) -> String {
    name.replace("accel_", "accelerometer_").replace('_', " ")
}

/// The sections.
pub fn sections(runs: &[Run<'_>]) -> Vec<Section> {
    let mut sections = vec![summary(runs)];
    let mut names: Vec<&str> = AXES.to_vec();
    // Files of others may name axes otherwise.
    for (_, run) in runs {
        names.extend(run.axes.keys().map(String::as_str));
    }
    let mut seen: Vec<&str> = Vec::new();
    names.retain(|name| {
        let first = !seen.contains(name);
        seen.push(name);
        first
    });
    for name in names {
        let axes: Vec<(&str, &Axis)> = runs
            .iter()
            .filter_map(|(run, result)| Some((run.as_str(), result.axes.get(name)?)))
            .filter(|(_, axis)| axis.error.is_none())
            .collect();
        match axes.as_slice() {
            [] => {}
            [(_, axis)] if runs.len() == 1 => sections.push(of_axis(name, axis)),
            several => sections.push(compared(name, several)),
        }
    }
    sections
}

fn summary(runs: &[Run<'_>]) -> Section {
    let mut blocks = Vec::new();
    let label = |run: &str, axis: &str| match run {
        "" => spoken(axis),
        run => format!("{run}: {}", spoken(axis)),
    };
    for (name, run) in runs {
        let failed: Vec<String> = run
            .in_order()
            .filter_map(|(axis, found)| {
                Some(format!("{}: {}", label(name, axis), found.error.as_ref()?))
            })
            .collect();
        blocks.extend(warnings(&failed));
    }
    for (name, run) in runs {
        blocks.extend(text(&what_was_done(name, run)));
    }
    let mut found = table(
        "models",
        "What was found of each axis: terms of the Allan deviation, and the model recommended by its drift on the half of the record that was not fitted.",
        &[
            "axis",
            "white noise",
            "bias instability",
            "random walk",
            "recommended model",
            "outliers",
        ],
    );
    let mut tests = table(
        "tests",
        "Tests of stationarity and normality, as in the source paper's Table 2, with their 5 % points in brackets. ADF rejects a unit root below its point, KPSS rejects stationarity above it; the others reject normality above theirs.",
        &[
            "axis",
            "ADF",
            "KPSS",
            "Jarque-Bera",
            "Kolmogorov-Smirnov",
            "Lilliefors",
            "skewness",
            "excess kurtosis",
        ],
    );
    for (name, run) in runs {
        for (axis, found_of) in run.in_order().filter(|(_, axis)| axis.error.is_none()) {
            let unit = units(axis);
            let (h, long) = (60.0 * unit.scale, unit.instability_scale);
            found.rows.push(vec![
                label(name, axis).into(),
                format!(
                    "{} {}",
                    short(found_of.allan_terms.white.value * h),
                    unit.white
                )
                .into(),
                seen(
                    &found_of.allan_terms.bias_instability,
                    long,
                    unit.instability,
                )
                .into(),
                seen(
                    &found_of.allan_terms.random_walk,
                    unit.walk_scale,
                    unit.walk,
                )
                .into(),
                found_of.chosen.name.clone().into(),
                count(found_of.outliers.len() as u64).into(),
            ]);
            tests.rows.push(test_row(&label(name, axis), found_of));
        }
    }
    for table in [found, tests] {
        if !table.rows.is_empty() {
            blocks.push(Block::Table(table));
        }
    }
    for (name, run) in runs {
        let prefix = if name.is_empty() {
            String::new()
        } else {
            format!("{name}: ")
        };
        blocks.extend(text(&[prefix + &normality(run)]));
    }
    Section {
        title: "Static record".into(),
        blocks,
    }
}

fn what_was_done(name: &str, run: &Identify) -> Vec<String> {
    let samples = run
        .axes
        .values()
        .map(|axis| axis.samples)
        .max()
        .unwrap_or(0);
    let prefix = if name.is_empty() {
        String::new()
    } else {
        format!("{name}: ")
    };
    let mut told = vec![format!(
        "{prefix}{}: {} samples of {} at {} Hz, {}.",
        if run.record.is_empty() {
            "A static record"
        } else {
            &run.record
        },
        count(samples),
        if run.axes.len() == 1 {
            "one axis".into()
        } else {
            format!("{} axes", run.axes.len())
        },
        short(run.rate_hz.0),
        span(samples as f64 / run.rate_hz.0),
    )];
    if run.skipped_rows > 0 {
        told.push(format!("{} rows were left out.", count(run.skipped_rows)));
    }
    told.push("Models were fitted to one half of it and judged on the other, by the drift that they leave in the integral of the samples.".into());
    told
}

/// A term of the Allan deviation, if the record shows it.
fn seen(term: &Term, scale: f64, unit: &str) -> String {
    if term.seen {
        format!("{} {unit}", short(term.value * scale))
    } else {
        "not seen".into()
    }
}

fn test_row(label: &str, axis: &Axis) -> Vec<Cell> {
    let with = |statistic: f64, critical: f64| -> Cell {
        format!("{} ({})", short(statistic), short(critical)).into()
    };
    let plain = |test: &Test| with(test.statistic, test.critical_5);
    let (adf, kpss) = (&axis.adf.fixed, &axis.kpss);
    vec![
        label.into(),
        with(adf.statistic, adf.critical.five),
        with(kpss.statistic, kpss.critical.five),
        plain(&axis.jarque_bera),
        plain(&axis.ks),
        plain(&axis.lilliefors),
        cell(axis.skewness.0),
        cell(axis.kurtosis_excess.0),
    ]
}

/// Which axes are not normal, and that quantisation alone may make them so.
fn normality(run: &Identify) -> String {
    let known = || run.in_order().filter(|(_, axis)| axis.error.is_none());
    let rejected =
        |axis: &Axis| axis.jarque_bera.p_value < LEVEL || axis.lilliefors.p_value < LEVEL;
    let names: Vec<String> = known()
        .filter(|(_, a)| rejected(a))
        .map(|(n, _)| spoken(n))
        .collect();
    let grid = known().any(|(_, a)| rejected(a) && a.quantisation_step.0 > 0.0);
    if names.is_empty() {
        return "No axis is found to differ from a normal distribution at the 5 % level.".into();
    }
    format!(
        "Not normal at the 5 % level: {}{}. The models need second moments only; a distribution with long tails makes their errors larger than three standard deviations more often than 0.3 % of the time.",
        names.join(", "),
        if grid {
            " (samples on a grid of quantisation steps are never exactly normal, and a long record shows it)"
        } else {
            ""
        }
    )
}

/// One axis of several records.
fn compared(name: &str, axes: &[(&str, &Axis)]) -> Section {
    let unit = units(name);
    let mut panel = allan_panel(unit);
    let mut spectrum: Option<Panel> = None;
    for (at, (run, axis)) in axes.iter().enumerate() {
        let colour = COLOURS[at % COLOURS.len()];
        let deviation = zip(&axis.allan.tau_s, &axis.allan.adev);
        let points = deviation
            .into_iter()
            .map(|(t, d)| (t, d * unit.scale))
            .collect();
        panel.add(Series::line(run, colour, points));
        if let (Some(density), Some(one)) = (&axis.series.psd, psd(axis, unit)) {
            let points = zip(&density.frequency_hz, &density.density);
            let points = points
                .into_iter()
                .map(|(f, d)| (f, d.sqrt() * unit.scale))
                .collect();
            spectrum
                .get_or_insert(Panel {
                    series: Vec::new(),
                    ..one
                })
                .add(Series::thin(run, colour, points));
        }
    }
    let mut rows = table(
        &format!("compared-{name}"),
        "The recommended models, and the drift they leave after the longest horizon on the half that was not fitted.",
        &["record", "model", "drift", "outliers"],
    );
    for (run, axis) in axes {
        let chosen = axis.candidates.iter().find(|c| c.name == axis.chosen.name);
        let last = chosen.and_then(|c| {
            let scores = c
                .drift_score
                .iter()
                .filter_map(|(k, v)| Some((k.parse::<f64>().ok()?, v.0)));
            scores.max_by(|a, b| a.0.total_cmp(&b.0))
        });
        rows.rows.push(vec![
            (*run).into(),
            axis.chosen.name.clone().into(),
            last.map_or("–".into(), |(s, d)| {
                format!("{} {} after {s:.0} s", short(d * unit.scale), unit.drift)
            })
            .into(),
            count(axis.outliers.len() as u64).into(),
        ]);
    }
    let mut blocks = Vec::from_iter(figure(
        &format!("allan-{name}"),
        "Overlapping Allan deviations and power spectral densities.",
        2,
        std::iter::once(panel).chain(spectrum).collect(),
    ));
    blocks.push(Block::Table(rows));
    Section {
        title: heading(name),
        blocks,
    }
}
