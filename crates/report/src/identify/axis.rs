//! One axis of an identified record in all detail.

use super::orders::{adequacy, pandit_wu};
use super::{LEVEL, Units, bounds, units};
use crate::{
    Cell, Figure, Panel, PlotAxis, Section, Series, Table,
    numbers::{error, get, probability, short},
    parts::{Clock, capital, points, run_colour, text, warnings},
};
use std::f64::consts::{LN_2, PI, TAU};
use undrift_base::order_statistics::quantile;
use undrift_results::{Axis, Candidate, Number, Term};

/// One axis in all detail.
pub(super) fn of_axis(name: &str, axis: &Axis) -> Option<Section> {
    let unit = units(name);
    let figure = |what: &str, caption: &str, panels: Vec<Panel>| {
        Figure::block(&format!("{what}-{name}"), caption, 2, panels)
    };
    let found = |panels: [Option<Panel>; 2]| panels.into_iter().flatten().collect();
    let reason = axis.chosen.reason.clone().unwrap_or_default();
    let blocks = [
        warnings(&axis.warnings),
        text([axis.stationarity.clone(), whiteness(axis), reason]),
        figure(
            "record",
            "The recording over time, and the distribution of its values against a normal distribution of the same mean and standard deviation.",
            found([record(axis, unit), histogram(axis, unit)]),
        ),
        figure(
            "correlation",
            "Autocorrelation and partial autocorrelation of the recording and of a model's residuals, with 95 % bounds for white noise.",
            correlations(axis),
        ),
        figure(
            "allan",
            "Overlapping Allan deviation with its 68 % interval and the sum of the terms fitted to it, and the power spectral density.",
            found([allan(axis, unit), psd(axis, unit)]),
        ),
        pandit_wu(name, axis).block(),
        adequacy(name, axis).block(),
        candidates(name, axis, unit).block(),
        text(of_others(axis)),
        parameters(name, axis).block(),
    ];
    Section::new(&capital(&super::spoken(name)), blocks.into_iter().flatten())
}

fn whiteness(axis: &Axis) -> String {
    let p = axis.ljung_box.ljung_box_p;
    if !p.is_finite() {
        String::new()
    } else if p < LEVEL {
        "Its samples are correlated (Ljung-Box at 20 lags): white noise alone does not describe it."
            .into()
    } else {
        "Its samples are white over 20 lags (Ljung-Box).".into()
    }
}

pub(crate) fn record(axis: &Axis, unit: &Units) -> Option<Panel> {
    let points = Clock::starting(0.0).points(&axis.series.record, unit.scale);
    (!points.is_empty()).then(|| {
        let y = PlotAxis::new(&format!("sample [{}]", unit.sample));
        let panel = Panel::new("Record", PlotAxis::new("time [s]"), y);
        let mut panel = panel.over_time(0.0);
        panel.add(Series::thin("", run_colour(0), points));
        panel
    })
}

fn histogram(axis: &Axis, unit: &Units) -> Option<Panel> {
    let h = &axis.series.histogram;
    let (mean, sigma) = (h.mean.0 * unit.scale, h.sigma.0 * unit.scale);
    let bars = points(&h.centre, &h.density, 1.0).into_iter();
    let bars: Vec<_> = bars
        .map(|(x, d)| (x * unit.scale, d / unit.scale))
        .collect();
    if bars.is_empty() || sigma.is_nan() || sigma <= 0.0 {
        return None;
    }
    let normal = |k: i32| {
        let z = f64::from(k) / 20.0;
        let density = (-0.5 * z * z).exp() / (sigma * TAU.sqrt());
        (mean + z * sigma, density)
    };
    let x = PlotAxis::new(&format!("sample [{}]", unit.sample));
    let x = x.within(mean - 5.0 * sigma..mean + 5.0 * sigma);
    let y = PlotAxis::new(&format!("density [1/({})]", unit.sample));
    let mut panel = Panel::new("Distribution", x, y);
    panel.add(Series::bars("record", 3, bars));
    let normal = (-100..=100).map(normal).collect();
    panel.add(Series::line("normal", 6, normal));
    Some(panel)
}

/// Of the record and of the residuals.
fn correlations(axis: &Axis) -> Vec<Panel> {
    let s = &axis.series;
    let residuals = s.residuals.iter().map(|r| {
        let of = format!("residuals of {}", r.model);
        (of, &r.acf, &r.pacf, r.bound.0)
    });
    let record = (
        "the recording".into(),
        &axis.acf,
        &axis.pacf,
        s.correlation_bound.0,
    );
    let panels = [record]
        .into_iter()
        .chain(residuals)
        .flat_map(|(of, acf, pacf, bound)| {
            let kinds = [("Autocorrelation", acf), ("Partial autocorrelation", pacf)];
            let known = kinds.into_iter().filter(|(_, values)| values.len() > 1);
            known.map(move |(what, values)| correlation(&format!("{what} of {of}"), values, bound))
        });
    panels.collect()
}

pub(crate) fn correlation(title: &str, values: &[Number], bound: f64) -> Panel {
    let values = values.iter().skip(1).map(|v| v.0);
    let values: Vec<f64> = values.collect();
    let last = values.len() as f64;
    let (least, most) = (quantile(&values, 0.0), quantile(&values, 1.0));
    let low = (1.15 * least).min(-2.0 * bound).max(-1.0);
    let high = (1.15 * most).max(2.0 * bound).min(1.0);
    let x = PlotAxis::new("lag [samples]").within(0.0..last + 1.0);
    let y = PlotAxis::new("correlation").within(low..high);
    let mut panel = Panel::new(title, x, y);
    let band = [0.0, last + 1.0].map(|lag| (lag, -bound, bound));
    panel.add(Series::band("", 1, &band));
    let points = (1..).map(f64::from).zip(values).collect();
    panel.add(Series::bars("", run_colour(0), points));
    panel
}

/// The deviation with the curves of the terms that it shows.
fn allan(axis: &Axis, unit: &Units) -> Option<Panel> {
    let a = &axis.allan;
    let (first, last) = (a.tau_s.first()?.0, a.tau_s.last()?.0);
    let scaled = |values: &[Number]| points(&a.tau_s, values, unit.scale);
    let mut panel = allan_panel(unit);
    let upper = scaled(&a.upper).into_iter().map(|p| p.1);
    let band = scaled(&a.lower).into_iter().zip(upper);
    let band = band.map(|((tau, lower), upper)| (tau, lower, upper));
    let band = band.filter(|(_, lower, upper)| *lower > 0.0 && upper.is_finite());
    panel.add(Series::band("", run_colour(0), &Vec::from_iter(band)));
    panel.add(Series::line("record", run_colour(0), scaled(&a.adev)));
    let positive = a.adev.iter().map(|d| d.0).filter(|d| *d > 0.0);
    let least = positive.fold(f64::INFINITY, f64::min);
    let terms = &axis.allan_terms;
    type Shape = fn(f64) -> f64;
    let shapes: [(&Term, &str, usize, Shape); 5] = [
        (&terms.quantisation, "quantisation", 0, |tau| {
            3f64.sqrt() / tau
        }),
        (&terms.white, "white noise", 1, |tau| tau.powf(-0.5)),
        (&terms.bias_instability, "bias instability", 2, |_| {
            (2.0 * LN_2 / PI).sqrt()
        }),
        (&terms.random_walk, "random walk", 4, |tau| {
            (tau / 3.0).sqrt()
        }),
        (&terms.ramp, "ramp", 5, |tau| tau / 2f64.sqrt()),
    ];
    let first = first.max(a.fit_from_s.0);
    for (term, name, colour, shape) in shapes {
        let size = term.value;
        if !term.seen || size.is_nan() || size <= 0.0 {
            continue;
        }
        let taus = (0..=40).map(|k| first * (last / first).powf(f64::from(k) / 40.0));
        // Not far below the curve, where nothing is to be seen.
        let points = taus.map(|tau| (tau, size * shape(tau)));
        let points = points.filter(|(_, d)| *d > 0.3 * least);
        let points = points.map(|(tau, d)| (tau, d * unit.scale)).collect();
        panel.add(Series::dashed(name, colour, points));
    }
    let mut fitted = scaled(&a.fit);
    fitted.retain(|(tau, _)| a.fit_from_s.0.is_nan() || *tau >= a.fit_from_s.0);
    panel.add(Series::line("sum of the terms", 6, fitted));
    Some(panel)
}

/// An empty plot of Allan deviations.
pub(super) fn allan_panel(unit: &Units) -> Panel {
    let x = PlotAxis::logarithmic("averaging time τ [s]");
    let y = PlotAxis::logarithmic(&format!("Allan deviation [{}]", unit.sample));
    Panel::new("Allan deviation", x, y)
}

/// An empty plot of spectra.
pub(super) fn psd_panel(unit: &Units) -> Panel {
    let y = PlotAxis::logarithmic(&format!("root density [{}/√Hz]", unit.sample));
    Panel::new("Spectrum", PlotAxis::logarithmic("frequency [Hz]"), y)
}

/// Roots of the spectral densities.
pub(super) fn density(axis: &Axis, unit: &Units) -> Vec<(f64, f64)> {
    let psd = axis.series.psd.as_ref();
    let points = psd.map_or(Vec::new(), |psd| {
        points(&psd.frequency_hz, &psd.density, 1.0)
    });
    let root = points.into_iter().map(|(f, d)| (f, d.sqrt() * unit.scale));
    root.collect()
}

fn psd(axis: &Axis, unit: &Units) -> Option<Panel> {
    let points = density(axis, unit);
    (!points.is_empty()).then(|| {
        let mut panel = psd_panel(unit);
        panel.add(Series::thin("", run_colour(0), points));
        panel
    })
}

/// A candidate with its rank.
type Ranked<'a> = (&'a Candidate, bool);

/// The candidates by their drift, and whether each is the chosen one.
fn ranked(axis: &Axis) -> Vec<Ranked<'_>> {
    let rank = |candidate: &&Candidate| {
        let place = axis.ranking.iter().position(|name| *name == candidate.name);
        place.unwrap_or(usize::MAX)
    };
    let mut ranked: Vec<&Candidate> = axis.candidates.iter().collect();
    ranked.sort_by_key(rank);
    let chosen = |c: &Candidate| c.name == axis.chosen.name;
    ranked.into_iter().map(|c| (c, chosen(c))).collect()
}

/// Its name, with a star if it is there for comparison alone.
fn starred(candidate: &Candidate) -> String {
    let star = if candidate.compared { " *" } else { "" };
    format!("{}{star}", candidate.name)
}

/// What the star means, and which of the methods of the literature have no model, in sentences.
pub(crate) fn of_others(axis: &Axis) -> Vec<String> {
    let star = axis.candidates.iter().any(|c| c.compared);
    let star =
        star.then(|| "* as others fit or choose it, for comparison: never recommended.".to_owned());
    let missing = axis.not_fitted.iter();
    let missing = missing.map(|method| format!("No {}: {}.", method.name, method.reason));
    star.into_iter().chain(missing).collect()
}

/// Adds a column of the drift after each horizon.
fn add_drift(table: &mut Table, ranked: &[Ranked<'_>], cell: impl Fn(&Candidate, &str) -> Cell) {
    let Some((first, _)) = ranked.first() else {
        return;
    };
    let keys = first.drift_score.keys();
    let known = keys.filter_map(|key| Some((key.parse::<f64>().ok()?, key)));
    let mut horizons: Vec<(f64, &String)> = known.collect();
    horizons.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (seconds, key) in horizons {
        let cells = ranked
            .iter()
            .map(|(c, chosen)| cell(c, key).strong_if(*chosen));
        table.add(format!("after {seconds:.0} s"), cells);
    }
}

/// The candidates by their drift.
fn candidates(name: &str, axis: &Axis, unit: &Units) -> Table {
    let ranked = ranked(axis);
    let least = axis.candidates.iter().filter_map(|c| c.block_aic.get());
    let least = least.fold(f64::INFINITY, f64::min);
    let mut rows = Table::from_rows(
        &format!("candidates-{name}"),
        &format!(
            "Candidates by drift: RMS error [{}] of the predicted integral, fitted on one half of the recording and scored on the other, both ways; its standard error; in brackets the model's own prediction. AIC is above the least, from block averages of the whole recording. The recommended one is highlighted.",
            unit.drift
        ),
        &ranked,
        &[
            ("model", &|(c, chosen)| {
                Cell::from(starred(c)).strong_if(*chosen)
            }),
            ("states", &|(c, _)| c.states.into()),
            ("parameters", &|(c, _)| c.parameters.into()),
            ("AIC", &|(c, _)| Cell::number(c.block_aic.0 - least, 1)),
            ("Ljung-Box p", &|(c, _)| probability(c.ljung_box_p.0).into()),
        ],
    );
    add_drift(&mut rows, &ranked, |candidate, key| {
        let of = |numbers| get(numbers, key) * unit.scale;
        let drift = short(of(&candidate.drift_score));
        let std = error(of(&candidate.drift_score_error));
        let predicted = short(of(&candidate.drift_predicted));
        format!("{drift} ± {std} ({predicted})").into()
    });
    rows
}

/// The parameters of the recommended model with their intervals.
fn parameters(name: &str, axis: &Axis) -> Table {
    Table::from_rows(
        &format!("parameters-{name}"),
        "Parameters of the recommended model fitted to the whole recording, with the 95 % intervals of the profile likelihood.",
        &bounds(name, axis),
        &[
            ("parameter", &|b| (&b.parameter).into()),
            ("unit", &|b| b.unit.into()),
            ("estimate", &|b| short(b.estimate).into()),
            ("95 % interval", &|b| b.interval().into()),
        ],
    )
}

/// The candidates' drift alone, for a terminal.
pub(crate) fn drift_table(name: &str, axis: &Axis) -> Table {
    let unit = units(name);
    let ranked = ranked(axis);
    let head = format!("drift [{}]", unit.drift);
    let mut rows = Table::from_rows(
        "",
        "",
        &ranked,
        &[(&head, &|(c, chosen)| {
            let arrow = if *chosen { "→" } else { " " };
            Cell::from(format!("{arrow} {}", starred(c))).strong_if(*chosen)
        })],
    );
    add_drift(&mut rows, &ranked, |candidate, key| {
        short(get(&candidate.drift_score, key) * unit.scale).into()
    });
    rows
}

#[cfg(test)]
mod tests;
