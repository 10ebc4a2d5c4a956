//! The report of an identified record: the source paper's Figures 1 and 3, Tables 2 and 3, the Allan
//! deviation and the candidates with their drift.

mod axis;
mod bounds;
mod floor;
mod lines;
mod orders;
pub(crate) mod pool;
mod temperatures;
mod units;
mod used;
mod verdict;

use super::{
    Block, Cell, Figure, Section, Series, Table,
    numbers::{count, short, span},
    parts::{Run, capital, points, prefixed, run_colour, spoken_list, text, warnings},
};
use axis::{allan_panel, of_axis, psd_panel};
pub(crate) use axis::{correlation, drift_table, of_others, record};
pub(crate) use bounds::bounds;
pub(crate) use floor::{FLAT, floor};
pub(crate) use lines::lines;
pub(crate) use orders::{adequacy, adequacy_line, pandit_wu};
pub(crate) use temperatures::temperatures;
use undrift_noise::{model_file::AXES, normality::Test};
use undrift_results::{Axis, Identify, Term};
use units::{Unit, with_unit};
pub(crate) use units::{Units, units};
pub(crate) use verdict::is_allan;
pub use verdict::{is_usable, verdict};

/// Level of the tests.
const LEVEL: f64 = 0.05;

/// What the source paper's Table 2 compares.
const PAPER_KS: &str = "The source paper's Kolmogorov-Smirnov value, 0.4918, is the distance of its samples in rad/s from N(0, 1), without scaling: a normal distribution of 0.0061 rad/s, which its AIC implies, is 0.4915 from it. Here the samples are scaled to their own mean and standard deviation first.";

/// "gyro x" of "gyro_x".
pub(crate) fn spoken(name: &str) -> String {
    name.replace("accel_", "accelerometer_").replace('_', " ")
}

/// The sections.
pub fn sections(runs: &[Run<'_, Identify>]) -> Vec<Section> {
    // Files of others may name axes otherwise.
    let others = runs.iter().flat_map(|(_, run)| run.axes.keys());
    let mut names: Vec<&str> = Vec::new();
    for name in AXES.into_iter().chain(others.map(String::as_str)) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let of_name = |name: &str| {
        let axes: Vec<(&str, &Axis)> = runs
            .iter()
            .filter_map(|(run, result)| Some((run.as_str(), result.axes.get(name)?)))
            .filter(|(_, axis)| axis.error.is_none())
            .collect();
        match axes.as_slice() {
            [] => None,
            [(_, axis)] if runs.len() == 1 => {
                let section = of_axis(name, axis)?.folded();
                Some(section.noted(in_short(name, axis)))
            }
            several => compared(name, several),
        }
    };
    let modelled =
        |(_, run): &Run<'_, Identify>| run.axes.values().any(|axis| !axis.candidates.is_empty());
    if !runs.iter().any(modelled) {
        return allan(runs).into_iter().collect();
    }
    let axes = names.into_iter().map(of_name);
    [summary(runs)].into_iter().chain(axes).flatten().collect()
}

/// White noise, bias instability or random walk and the model of an axis, in few words.
fn in_short(name: &str, axis: &Axis) -> String {
    let (unit, terms) = (units(name), &axis.allan_terms);
    let white = format!("N {}", with_unit(terms.white.value, unit.white));
    let slow = [
        ("B", &terms.bias_instability, unit.bias),
        ("K", &terms.random_walk, unit.walk),
    ];
    let slow = slow.into_iter().filter(|(_, term, _)| term.seen);
    let slow = slow.map(|(letter, term, unit)| format!("{letter} {}", with_unit(term.value, unit)));
    let model = axis.chosen.name.clone();
    let parts = [white].into_iter().chain(slow).chain([model]);
    Vec::from_iter(parts.filter(|part| !part.is_empty())).join(", ")
}

/// Which model is recommended for which axes, in a sentence.
fn recommended(run: &Identify) -> String {
    let mut models: Vec<(&str, Vec<String>)> = Vec::new();
    for Named { label, axis, .. } in identified("", run) {
        let name = axis.chosen.name.as_str();
        match models.iter_mut().find(|(model, _)| *model == name) {
            Some((_, axes)) => axes.push(label),
            None => models.push((name, vec![label])),
        }
    }
    models.retain(|(name, _)| !name.is_empty());
    let parts = models
        .iter()
        .map(|(name, axes)| format!("{name} for {}", spoken_list(axes)));
    match Vec::from_iter(parts).join("; ") {
        parts if parts.is_empty() => parts,
        parts => format!("Recommended: {parts}."),
    }
}

/// An axis that was identified, with its name and what it is called.
pub(crate) struct Named<'a> {
    label: String,
    name: &'a str,
    axis: &'a Axis,
}

/// The axes that were identified.
pub(crate) fn identified<'a>(
    run: &'a str,
    result: &'a Identify,
) -> impl Iterator<Item = Named<'a>> {
    let known = result.in_order().filter(|(_, axis)| axis.error.is_none());
    known.map(move |(name, axis)| Named {
        label: prefixed(run, &spoken(name)),
        name,
        axis,
    })
}

/// Whether the recordings serve, what they show, and what was not identified.
fn head(runs: &[Run<'_, Identify>]) -> impl Iterator<Item = Block> {
    let failed = runs.iter().map(|(name, run)| {
        let failed = run.in_order().filter_map(|(axis, found)| {
            Some(format!(
                "{}: {}",
                prefixed(name, &spoken(axis)),
                found.error.as_ref()?
            ))
        });
        warnings(&failed.collect::<Vec<_>>())
    });
    let verdicts = runs
        .iter()
        .map(|(name, run)| Some(Block::Verdict(run.verdict(), prefixed(name, &verdict(run)))));
    let conclusions = runs.iter().map(|(name, run)| {
        let found = recommended(run);
        text([prefixed(if found.is_empty() { "" } else { name }, &found)])
    });
    let blocks = verdicts.chain(conclusions).chain(failed);
    Vec::from_iter(blocks.flatten()).into_iter()
}

/// What was recorded, and how it was fitted.
fn done(runs: &[Run<'_, Identify>]) -> impl Iterator<Item = Block> {
    let done = runs
        .iter()
        .map(|(name, run)| text(what_was_done(name, run)));
    Vec::from_iter(done.flatten()).into_iter()
}

/// Of Allan deviations alone.
fn allan(runs: &[Run<'_, Identify>]) -> Option<Section> {
    let axes = runs.iter().flat_map(|(name, run)| identified(name, run));
    let terms = Table::from_rows(
        "terms",
        "Terms of the Allan deviation of each axis.",
        axes,
        &of_allan(),
    );
    let blocks = head(runs).chain(overview(runs)).chain(terms.block());
    let blocks = blocks.chain(done(runs));
    Section::new("Allan deviation", blocks)
}

/// The Allan deviations of all axes in one figure, those of the gyros beside those of the accelerometers.
fn overview(runs: &[Run<'_, Identify>]) -> Option<Block> {
    let panels = ["gyro", "accel"].into_iter().filter_map(|sensor| {
        let unit = units(sensor);
        let axes = runs.iter().flat_map(|(name, run)| identified(name, run));
        let axes = axes.filter(|axis| axis.name.starts_with(sensor));
        let mut panel = allan_panel(unit).titled(match sensor {
            "gyro" => "Gyros",
            _ => "Accelerometers",
        });
        for (at, Named { label, axis, .. }) in axes.enumerate() {
            let deviation = points(&axis.allan.tau_s, &axis.allan.adev, unit.scale);
            panel.add(Series::line(&label, run_colour(at), deviation).pattern(at));
        }
        (!panel.series.is_empty()).then_some(panel)
    });
    Figure::block(
        "allan",
        "Overlapping Allan deviations of all axes.",
        2,
        panels,
    )
}

fn summary(runs: &[Run<'_, Identify>]) -> Option<Section> {
    let axes = || runs.iter().flat_map(|(name, run)| identified(name, run));
    let tables = [
        models(axes()),
        temperatures(axes()),
        lines(axes()),
        tests(axes()),
    ]
    .map(Table::block);
    let normality = runs
        .iter()
        .map(|(name, run)| text([prefixed(name, &normality(run))]))
        .chain([text([PAPER_KS.to_owned()])]);
    let several = runs.iter().any(|(_, run)| run.axes.len() > 1);
    let overview = several.then(|| overview(runs)).flatten();
    let blocks = head(runs).chain(overview).chain(pool::of_runs(runs));
    let blocks = blocks.chain(tables.into_iter().chain(normality).flatten());
    let blocks = blocks.chain(done(runs));
    Section::new("Static recording", blocks)
}

type Column<'a> = (&'static str, &'a dyn Fn(&Named<'a>) -> Cell);

/// The axis and the terms of its Allan deviation.
fn of_allan<'a>() -> [Column<'a>; 4] {
    [
        ("axis", &|a| (&a.label).into()),
        ("white noise", &|a| {
            with_unit(a.axis.allan_terms.white.value, units(a.name).white).into()
        }),
        ("bias instability", &|a| {
            let (unit, factor) = units(a.name).bias;
            format!("{} {unit}", floor(a.axis, factor)).into()
        }),
        ("random walk", &|a| {
            seen(&a.axis.allan_terms.random_walk, units(a.name).walk)
        }),
    ]
}

fn models<'a>(axes: impl Iterator<Item = Named<'a>>) -> Table {
    let of_model: [Column<'a>; 2] = [
        ("recommended model", &|a| (&a.axis.chosen.name).into()),
        ("outliers", &|a| (a.axis.outliers.len() as u64).into()),
    ];
    Table::from_rows(
        "models",
        "Each axis: terms of the Allan deviation, and the model recommended by its drift on halves of the recording that it was not fitted to.",
        axes,
        &Vec::from_iter(of_allan().into_iter().chain(of_model)),
    )
}

/// A term of the Allan deviation, if the record shows it.
fn seen(term: &Term, unit: Unit) -> Cell {
    if term.seen {
        with_unit(term.value, unit).into()
    } else {
        "not detected".into()
    }
}

/// Table 2.
pub(crate) fn tests<'a>(axes: impl Iterator<Item = Named<'a>>) -> Table {
    let with = |statistic: f64, critical: f64| -> Cell {
        format!("{} ({})", short(statistic), short(critical)).into()
    };
    let plain = |test: &Test| with(test.statistic, test.critical_5);
    Table::from_rows(
        "tests",
        "Tests of stationarity and normality, as in the source paper's Table 2, with their 5 % critical values in brackets. ADF rejects a unit root below its value; KPSS rejects stationarity above it; the others reject normality above theirs.",
        axes,
        &[
            ("axis", &|a| (&a.label).into()),
            ("ADF", &|a| {
                let adf = &a.axis.adf.fixed;
                with(adf.statistic, adf.critical.five)
            }),
            ("KPSS", &|a| {
                with(a.axis.kpss.statistic, a.axis.kpss.critical.five)
            }),
            ("Jarque-Bera", &|a| plain(&a.axis.jarque_bera)),
            ("Kolmogorov-Smirnov", &|a| plain(&a.axis.ks)),
            ("Lilliefors", &|a| plain(&a.axis.lilliefors)),
            ("skewness", &|a| a.axis.skewness.into()),
            ("excess kurtosis", &|a| a.axis.kurtosis_excess.into()),
        ],
    )
}

fn what_was_done(name: &str, run: &Identify) -> Vec<String> {
    let samples = run.axes.values().map(|axis| axis.samples).max();
    let samples = samples.unwrap_or(0);
    let record = match run.record.as_str() {
        "" => "A static recording",
        record => record,
    };
    let axes = match run.axes.len() {
        1 => "one axis".into(),
        n => format!("{n} axes"),
    };
    let rate = run.rate_hz.0;
    let what = format!(
        "{record}: {} samples of {axes} at {} Hz, {}.",
        count(samples),
        short(rate),
        span(samples as f64 / rate)
    );
    let skipped = match run.skipped_rows {
        0 => String::new(),
        rows => format!("{} rows were skipped.", count(rows)),
    };
    let fitted = match run.pool {
        Some(_) => "",
        None => {
            "Models were fitted to one half and judged on the other by the drift that they leave in the integral of the samples."
        }
    };
    vec![prefixed(name, &what), skipped, fitted.into()]
}

/// Which axes are not normal, and that quantisation alone may make them so.
fn normality(run: &Identify) -> String {
    let rejected = identified("", run).filter(|Named { axis, .. }| {
        axis.jarque_bera.p_value < LEVEL || axis.lilliefors.p_value < LEVEL
    });
    let rejected: Vec<Named<'_>> = rejected.collect();
    if rejected.is_empty() {
        return "No axis differs from a normal distribution at the 5 % level.".into();
    }
    let names: Vec<&str> = rejected.iter().map(|a| a.label.as_str()).collect();
    let on_a_grid = rejected.iter().any(|a| a.axis.quantisation_step.0 > 0.0);
    let grid = if on_a_grid {
        " (quantised samples are never exactly normal, which a long recording reveals)"
    } else {
        ""
    };
    format!(
        "Not normal at the 5 % level: {}{grid}. The models need second moments only; a distribution with long tails makes their errors larger than three standard deviations more often than 0.3 % of the time.",
        names.join(", ")
    )
}

/// One axis of several records.
fn compared(name: &str, axes: &[(&str, &Axis)]) -> Option<Section> {
    let unit = units(name);
    let mut allan = allan_panel(unit);
    let mut spectrum = psd_panel(unit);
    for (at, (run, axis)) in axes.iter().enumerate() {
        let deviation = points(&axis.allan.tau_s, &axis.allan.adev, unit.scale);
        allan.add(Series::line(run, run_colour(at), deviation).pattern(at));
        let density = axis::density(axis, unit);
        if !density.is_empty() {
            spectrum.add(Series::thin(run, run_colour(at), density));
        }
    }
    let spectrum = (!spectrum.series.is_empty()).then_some(spectrum);
    let rows = Table::from_rows(
        &format!("compared-{name}"),
        "Recommended models and the drift they leave after the longest horizon, on halves that they were not fitted to.",
        axes,
        &[
            ("record", &|(run, _)| (*run).into()),
            ("model", &|(_, axis)| (&axis.chosen.name).into()),
            ("drift", &|(_, axis)| last_drift(axis, unit)),
            ("outliers", &|(_, axis)| (axis.outliers.len() as u64).into()),
        ],
    );
    let figure = Figure::block(
        &format!("allan-{name}"),
        "Overlapping Allan deviations and power spectral densities.",
        2,
        [allan].into_iter().chain(spectrum),
    );
    let blocks = figure.into_iter().chain([Block::Table(rows)]);
    Section::new(&capital(&spoken(name)), blocks)
}

/// The drift that the recommended model leaves after the longest horizon.
fn last_drift(axis: &Axis, unit: &Units) -> Cell {
    let chosen = axis.candidates.iter().find(|c| c.name == axis.chosen.name);
    let scores = chosen.and_then(|chosen| {
        let scores = chosen.drift_score.iter();
        let scores = scores.filter_map(|(k, v)| Some((k.parse::<f64>().ok()?, v.0)));
        scores.max_by(|a, b| a.0.total_cmp(&b.0))
    });
    scores.map_or("–".into(), |(after, drift)| {
        let drift = short(drift * unit.scale);
        format!("{drift} {} after {after:.0} s", unit.drift).into()
    })
}

#[cfg(test)]
mod tests;
