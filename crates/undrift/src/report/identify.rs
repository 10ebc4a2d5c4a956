//! The report of an identified record: the source paper's Figures 1 and 3, Tables 2 and 3, the Allan
//! deviation and the candidates with their drift.

use super::{
    Axis as PlotAxis, Block, Cell, Corner, Figure, Panel, Section, Series, Table,
    parts::{
        Clock, cell, count, exact, get, mark_least, percent, short, span, table, text, warnings,
        zip,
    },
    read::{Axis, Identify, Number, OrderRow},
};
use std::f64::consts::{LN_2, PI, TAU};
use undrift_noise::model_file::AXES;

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
    let mut letters = name.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    spoken(&first.chain(letters).collect::<String>())
}

/// "gyro x" of "gyro_x".
fn spoken(name: &str) -> String {
    name.replace('_', " ")
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

/// Axes in the order of a sensor.
fn in_order<'a>(run: &'a Identify) -> impl Iterator<Item = (&'a str, &'a Axis)> {
    let known = AXES.iter().filter_map(|name| {
        let (name, axis) = run.axes.get_key_value(*name)?;
        Some((name.as_str(), axis))
    });
    let others = run.axes.iter().map(|(name, axis)| (name.as_str(), axis));
    known.chain(others.filter(|(name, _)| !AXES.contains(name)))
}

fn summary(runs: &[Run<'_>]) -> Section {
    let mut blocks = Vec::new();
    let label = |run: &str, axis: &str| match run {
        "" => spoken(axis),
        run => format!("{run}: {}", spoken(axis)),
    };
    for (name, run) in runs {
        let failed: Vec<String> = in_order(run)
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
        for (axis, found_of) in in_order(run).filter(|(_, axis)| axis.error.is_none()) {
            let unit = units(axis);
            let (h, long) = (60.0 * unit.scale, unit.instability_scale);
            found.rows.push(vec![
                label(name, axis).into(),
                format!("{} {}", short(term(found_of, "white") * h), unit.white).into(),
                seen(found_of, "bias_instability", long, unit.instability).into(),
                seen(found_of, "random_walk", unit.walk_scale, unit.walk).into(),
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
    told
}

/// A term of the Allan deviation, SI.
fn term(axis: &Axis, name: &str) -> f64 {
    let value = axis.allan_terms.get(name).and_then(|t| t.get("value"));
    value
        .and_then(serde_json::Value::as_f64)
        .unwrap_or(f64::NAN)
}

/// Whether the record shows the term.
fn is_seen(axis: &Axis, name: &str) -> bool {
    let seen = axis.allan_terms.get(name).and_then(|t| t.get("seen"));
    seen.and_then(serde_json::Value::as_bool).unwrap_or(false)
}

fn seen(axis: &Axis, name: &str, scale: f64, unit: &str) -> String {
    if is_seen(axis, name) {
        format!("{} {unit}", short(term(axis, name) * scale))
    } else {
        "not seen".into()
    }
}

fn test_row(label: &str, axis: &Axis) -> Vec<Cell> {
    let with = |statistic: f64, critical: f64| -> Cell {
        format!("{} ({})", short(statistic), short(critical)).into()
    };
    let unit_root = |test: &super::read::Test| with(test.statistic.0, get(&test.critical, "5%"));
    let plain = |test: &super::read::Test| with(test.statistic.0, test.critical_5.0);
    vec![
        label.into(),
        unit_root(&axis.adf),
        unit_root(&axis.kpss),
        plain(&axis.jarque_bera),
        plain(&axis.ks),
        plain(&axis.lilliefors),
        cell(axis.skewness.0),
        cell(axis.kurtosis_excess.0),
    ]
}

/// Which axes are not normal, and that quantisation alone may make them so.
fn normality(run: &Identify) -> String {
    let known = || in_order(run).filter(|(_, axis)| axis.error.is_none());
    let rejected =
        |axis: &Axis| axis.jarque_bera.p_value.0 < LEVEL || axis.lilliefors.p_value.0 < LEVEL;
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

fn figure(name: &str, caption: &str, columns: usize, panels: Vec<Panel>) -> Option<Block> {
    (!panels.is_empty()).then(|| {
        Block::Figure(Figure {
            name: name.into(),
            caption: caption.into(),
            columns,
            panels,
        })
    })
}

/// One axis in all detail.
fn of_axis(name: &str, axis: &Axis) -> Section {
    let unit = units(name);
    let mut blocks = warnings(&axis.warnings);
    let reason = &axis.chosen.reason;
    blocks.extend(text(&[
        axis.stationarity.clone(),
        whiteness(axis),
        reason.clone(),
    ]));
    blocks.extend(figure(
        &format!("record-{name}"),
        "The record over time, and how its values are distributed beside a normal distribution of the same mean and standard deviation.",
        2,
        [record(axis, unit), histogram(axis, unit)].into_iter().flatten().collect(),
    ));
    blocks.extend(figure(
        &format!("correlation-{name}"),
        "Autocorrelation and partial autocorrelation of the record, and of what a model leaves of it, with their 95 % bounds for white noise.",
        2,
        correlations(axis),
    ));
    blocks.extend(figure(
        &format!("allan-{name}"),
        "Overlapping Allan deviation with its 68 % interval and the sum of the terms fitted to it, and the power spectral density.",
        2,
        [allan(axis, unit), psd(axis, unit)].into_iter().flatten().collect(),
    ));
    blocks.extend(pandit_wu(name, axis).map(Block::Table));
    blocks.extend(candidates(name, axis, unit).map(Block::Table));
    Section {
        title: heading(name),
        blocks,
    }
}

fn whiteness(axis: &Axis) -> String {
    let p = axis.ljung_box.p_value.0;
    if !p.is_finite() {
        String::new()
    } else if p < LEVEL {
        "Its samples are correlated (Ljung-Box at 20 lags): white noise alone does not describe it."
            .into()
    } else {
        "Its samples are white as far as 20 lags tell (Ljung-Box).".into()
    }
}

fn record(axis: &Axis, unit: &Units) -> Option<Panel> {
    let points = Clock::starting(0.0).points(&axis.series.record, unit.scale);
    (!points.is_empty()).then(|| {
        let y = format!("sample [{}]", unit.sample);
        let mut panel = Panel::new("Record", PlotAxis::new("time [s]"), PlotAxis::new(&y));
        panel.add(Series::thin("", COLOURS[0], points));
        panel
    })
}

fn histogram(axis: &Axis, unit: &Units) -> Option<Panel> {
    let h = &axis.series.histogram;
    let (mean, sigma) = (h.mean.0 * unit.scale, h.sigma.0 * unit.scale);
    let bars: Vec<(f64, f64)> = zip(&h.centre, &h.density)
        .into_iter()
        .map(|(x, d)| (x * unit.scale, d / unit.scale))
        .collect();
    if bars.is_empty() || !(sigma > 0.0) {
        return None;
    }
    let normal = |k: i32| {
        let z = f64::from(k) / 20.0;
        (
            mean + z * sigma,
            (-0.5 * z * z).exp() / (sigma * TAU.sqrt()),
        )
    };
    let x = PlotAxis::new(&format!("sample [{}]", unit.sample))
        .within(mean - 5.0 * sigma..mean + 5.0 * sigma);
    let mut panel = Panel::new(
        "Distribution",
        x,
        PlotAxis::new(&format!("density [1/({})]", unit.sample)),
    );
    panel.add(Series::bars("record", 3, bars));
    panel.add(Series::line(
        "normal",
        6,
        (-100..=100).map(normal).collect(),
    ));
    Some(panel)
}

/// Of the record and of the residuals.
fn correlations(axis: &Axis) -> Vec<Panel> {
    let s = &axis.series;
    let mut panels = Vec::new();
    let mut add = |what: &str, of: &str, values: &[Number], bound: f64| {
        if values.len() > 1 {
            panels.push(correlation(&format!("{what} of {of}"), values, bound));
        }
    };
    add(
        "Autocorrelation",
        "the record",
        &axis.acf,
        s.correlation_bound.0,
    );
    add(
        "Partial autocorrelation",
        "the record",
        &axis.pacf,
        s.correlation_bound.0,
    );
    for r in &s.residuals {
        let of = format!("what {} leaves", r.model);
        add("Autocorrelation", &of, &r.acf, r.bound.0);
        add("Partial autocorrelation", &of, &r.pacf, r.bound.0);
    }
    panels
}

fn correlation(title: &str, values: &[Number], bound: f64) -> Panel {
    let points: Vec<(f64, f64)> = (1..)
        .zip(values.get(1..).unwrap_or_default())
        .map(|(lag, v): (u32, _)| (f64::from(lag), v.0))
        .collect();
    let last = points.len() as f64;
    let largest = points
        .iter()
        .map(|p| p.1.abs())
        .filter(|v| v.is_finite())
        .fold(0.0, f64::max);
    let limit = (1.15 * largest).max(3.0 * bound).min(1.0);
    let y = if limit > 0.0 {
        PlotAxis::new("correlation").within(-limit..limit)
    } else {
        PlotAxis::new("correlation")
    };
    let mut panel = Panel::new(
        title,
        PlotAxis::new("lag [samples]").within(0.0..last + 1.0),
        y,
    );
    panel.add(Series::band(
        "",
        1,
        &[(0.0, -bound, bound), (last + 1.0, -bound, bound)],
    ));
    panel.add(Series::bars("", COLOURS[0], points));
    panel
}

/// The deviation with the curves of the terms that it shows.
fn allan(axis: &Axis, unit: &Units) -> Option<Panel> {
    let a = &axis.allan;
    if a.tau_s.is_empty() {
        return None;
    }
    let scaled = |values: &[Number]| -> Vec<(f64, f64)> {
        zip(&a.tau_s, values)
            .into_iter()
            .map(|(t, v)| (t, v * unit.scale))
            .collect()
    };
    let mut panel = allan_panel(unit);
    let band: Vec<(f64, f64, f64)> = scaled(&a.lower)
        .into_iter()
        .zip(scaled(&a.upper))
        .map(|((t, lower), (_, upper))| (t, lower, upper))
        .filter(|(_, lower, upper)| *lower > 0.0 && upper.is_finite())
        .collect();
    panel.add(Series::band("", COLOURS[0], &band));
    panel.add(Series::line("record", COLOURS[0], scaled(&a.adev)));
    let ends = a.tau_s.first().zip(a.tau_s.last());
    let least = a
        .adev
        .iter()
        .map(|d| d.0)
        .filter(|d| *d > 0.0)
        .fold(f64::INFINITY, f64::min);
    type Shape = fn(f64) -> f64;
    let shapes: [(&str, &str, Shape); 5] = [
        ("quantisation", "quantisation", |tau| 3f64.sqrt() / tau),
        ("white", "white noise", |tau| tau.powf(-0.5)),
        ("bias_instability", "bias instability", |_| {
            (2.0 * LN_2 / PI).sqrt()
        }),
        ("random_walk", "random walk", |tau| (tau / 3.0).sqrt()),
        ("ramp", "ramp", |tau| tau / 2f64.sqrt()),
    ];
    if let Some((first, last)) = ends {
        let (first, last) = (first.0.max(a.fit_from_s.0), last.0);
        for (at, (key, name, shape)) in shapes.into_iter().enumerate() {
            let size = term(axis, key);
            if !is_seen(axis, key) || !(size > 0.0) {
                continue;
            }
            let points: Vec<(f64, f64)> = (0..=40)
                .map(|k| first * (last / first).powf(f64::from(k) / 40.0))
                .map(|tau| (tau, size * shape(tau)))
                // Not far below the curve, where nothing is to be seen.
                .filter(|(_, d)| *d > 0.3 * least)
                .map(|(tau, d)| (tau, d * unit.scale))
                .collect();
            panel.add(Series::dashed(name, [0, 1, 2, 4, 5][at], points));
        }
    }
    let fitted = scaled(&a.fit)
        .into_iter()
        .filter(|(tau, _)| !(*tau < a.fit_from_s.0))
        .collect();
    panel.add(Series::line("sum of the terms", 6, fitted));
    Some(panel)
}

fn allan_panel(unit: &Units) -> Panel {
    let y = format!("Allan deviation [{}]", unit.sample);
    Panel::new(
        "Allan deviation",
        PlotAxis::logarithmic("averaging time τ [s]"),
        PlotAxis::logarithmic(&y),
    )
    .legend(Corner::LowerLeft)
}

fn psd(axis: &Axis, unit: &Units) -> Option<Panel> {
    let psd = axis.series.psd.as_ref()?;
    let points: Vec<(f64, f64)> = zip(&psd.frequency_hz, &psd.density)
        .into_iter()
        .map(|(f, d)| (f, d.sqrt() * unit.scale))
        .collect();
    (!points.is_empty()).then(|| {
        let y = format!("root density [{}/√Hz]", unit.sample);
        let mut panel = Panel::new(
            "Spectrum",
            PlotAxis::logarithmic("frequency [Hz]"),
            PlotAxis::logarithmic(&y),
        );
        panel.add(Series::thin("", COLOURS[0], points));
        panel
    })
}

/// Table 3.
fn pandit_wu(name: &str, axis: &Axis) -> Option<Table> {
    let mut rows = table(
        &format!("pandit-wu-{name}"),
        "Pandit and Wu's procedure, as in the source paper's Table 3. F tests each order against the one before: above its 5 % point the larger order is better.",
        &[
            "model",
            "sum of squares",
            "AIC",
            "BIC",
            "F",
            "5 % point",
            "paper's point",
        ],
    );
    for row in &axis.pandit_wu {
        let f = Cell::number(row.f.0, 2);
        let significant = row.f.0 > row.f_critical.0;
        rows.rows.push(vec![
            format!("ARMA({},{})", row.p, row.q).into(),
            exact(row.rss.0).into(),
            Cell::number(row.aic.0, 1),
            Cell::number(row.bic.0, 1),
            if significant { f.strong() } else { f },
            Cell::number(row.f_critical.0, 2),
            Cell::number(row.f_paper.0, 2),
        ]);
    }
    for (column, of) in [(2, (|r| r.aic.0) as fn(&OrderRow) -> f64), (3, |r| r.bic.0)] {
        let values: Vec<f64> = axis.pandit_wu.iter().map(of).collect();
        mark_least(&mut rows, column, &values);
    }
    (!rows.rows.is_empty()).then_some(rows)
}

/// The candidates by their drift.
fn candidates(name: &str, axis: &Axis, unit: &Units) -> Option<Table> {
    let rank = |name: &str| {
        axis.ranking
            .iter()
            .position(|r| r == name)
            .unwrap_or(usize::MAX)
    };
    let mut ranked: Vec<_> = axis.candidates.iter().collect();
    ranked.sort_by_key(|c| rank(&c.name));
    let mut horizons: Vec<(f64, &String)> = ranked
        .first()?
        .drift_score
        .keys()
        .filter_map(|key| Some((key.parse().ok()?, key)))
        .collect();
    horizons.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut rows = table(
        &format!("candidates-{name}"),
        &format!(
            "Candidates by their drift: root mean square error [{}] of the predicted integral on the half that was not fitted, its standard error, and in brackets what the model expects of itself. The recommended one stands out.",
            unit.drift
        ),
        &["model", "states", "parameters", "Ljung-Box p"],
    );
    rows.head
        .extend(horizons.iter().map(|(s, _)| format!("after {s:.0} s")));
    for candidate in ranked {
        let chosen = candidate.name == axis.chosen.name;
        let label = Cell::from(candidate.name.clone());
        let mut row = vec![
            if chosen { label.strong() } else { label },
            count(candidate.states).into(),
            count(candidate.parameters).into(),
            cell(candidate.ljung_box_p.0),
        ];
        row.extend(horizons.iter().map(|(_, key)| {
            let of = |numbers| get(numbers, key) * unit.scale;
            let text = format!(
                "{} ± {} ({})",
                short(of(&candidate.drift_score)),
                short(of(&candidate.drift_score_error)),
                short(of(&candidate.drift_predicted))
            );
            let score = Cell::from(text);
            if chosen { score.strong() } else { score }
        }));
        rows.rows.push(row);
    }
    Some(rows)
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
            percent(axis.outliers.len() as f64 / axis.samples as f64).into(),
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
