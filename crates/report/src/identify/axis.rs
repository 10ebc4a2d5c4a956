//! One axis of an identified record in all detail.

use super::{COLOURS, LEVEL, Units, figure, heading, units};
use crate::{
    Axis as PlotAxis, Block, Cell, Panel, Section, Series, Table,
    parts::{Clock, count, error, exact, get, probability, short, table, text, warnings, zip},
};
use std::f64::consts::{LN_2, PI, TAU};
use undrift::noise::order_statistics::quantile;
use undrift::results::{Axis, Number, OrderRow, Term};

/// One axis in all detail.
pub(super) fn of_axis(name: &str, axis: &Axis) -> Section {
    let unit = units(name);
    let mut blocks = Vec::from_iter(warnings(&axis.warnings));
    let reason = axis.chosen.reason.clone();
    blocks.extend(text(&[
        axis.stationarity.clone(),
        whiteness(axis),
        reason.unwrap_or_default(),
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
    blocks.extend(pandit_wu(name, axis, unit).map(Block::Table));
    blocks.extend(candidates(name, axis, unit).map(Block::Table));
    Section {
        title: heading(name),
        blocks,
    }
}

fn whiteness(axis: &Axis) -> String {
    let p = axis.ljung_box.ljung_box_p;
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
    if bars.is_empty() || sigma.is_nan() || sigma <= 0.0 {
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
    let values: Vec<f64> = points.iter().map(|p| p.1).collect();
    let (least, most) = (quantile(&values, 0.0), quantile(&values, 1.0));
    let (low, high) = (
        (1.15 * least).min(-2.0 * bound).max(-1.0),
        (1.15 * most).max(2.0 * bound).min(1.0),
    );
    let y = if low < high {
        PlotAxis::new("correlation").within(low..high)
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
    let terms = &axis.allan_terms;
    let shapes: [(&Term, &str, Shape); 5] = [
        (&terms.quantisation, "quantisation", |tau| 3f64.sqrt() / tau),
        (&terms.white, "white noise", |tau| tau.powf(-0.5)),
        (&terms.bias_instability, "bias instability", |_| {
            (2.0 * LN_2 / PI).sqrt()
        }),
        (&terms.random_walk, "random walk", |tau| (tau / 3.0).sqrt()),
        (&terms.ramp, "ramp", |tau| tau / 2f64.sqrt()),
    ];
    if let Some((first, last)) = ends {
        let (first, last) = (first.0.max(a.fit_from_s.0), last.0);
        for (at, (term, name, shape)) in shapes.into_iter().enumerate() {
            let size = term.value;
            if !term.seen || size.is_nan() || size <= 0.0 {
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
        .filter(|(tau, _)| a.fit_from_s.0.is_nan() || *tau >= a.fit_from_s.0)
        .collect();
    panel.add(Series::line("sum of the terms", 6, fitted));
    Some(panel)
}

pub(super) fn allan_panel(unit: &Units) -> Panel {
    let y = format!("Allan deviation [{}]", unit.sample);
    Panel::new(
        "Allan deviation",
        PlotAxis::logarithmic("averaging time τ [s]"),
        PlotAxis::logarithmic(&y),
    )
}

pub(super) fn psd(axis: &Axis, unit: &Units) -> Option<Panel> {
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
fn pandit_wu(name: &str, axis: &Axis, unit: &Units) -> Option<Table> {
    let mut rows = table(
        &format!("pandit-wu-{name}"),
        "Pandit and Wu's procedure, as in the source paper's Table 3. F tests each order against the one before: above its 5 % point the larger order is better. The least AIC and BIC stand out.",
        &[
            "model",
            &format!("sum of squares [{}]", unit.squares),
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
            format!("ARMA{}", row.order).into(),
            exact(row.rss.0).into(),
            Cell::number(row.aic.0, 1),
            Cell::number(row.bic.0, 1),
            if significant { f.strong() } else { f },
            Cell::number(row.f_critical.0, 2),
            Cell::number(row.f_paper.0, 2),
        ]);
    }
    for (column, of) in [(2, (|r| r.aic.0) as fn(&OrderRow) -> f64), (3, |r| r.bic.0)] {
        let orders = axis.pandit_wu.iter().map(of).enumerate();
        let least = orders
            .filter(|(_, v)| v.is_finite())
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let row = least.and_then(|(at, _)| rows.rows.get_mut(at));
        if let Some(cell) = row.and_then(|row| row.get_mut(column)) {
            *cell = cell.clone().strong();
        }
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
            probability(candidate.ljung_box_p.0).into(),
        ];
        row.extend(horizons.iter().map(|(_, key)| {
            let of = |numbers| get(numbers, key) * unit.scale;
            let text = format!(
                "{} ± {} ({})",
                short(of(&candidate.drift_score)),
                error(of(&candidate.drift_score_error)),
                short(of(&candidate.drift_predicted))
            );
            let score = Cell::from(text);
            if chosen { score.strong() } else { score }
        }));
        rows.rows.push(row);
    }
    Some(rows)
}
