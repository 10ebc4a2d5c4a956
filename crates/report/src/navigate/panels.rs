//! Panels over the time of a run.

use super::{BAND, COLOURS, Component};
use crate::{
    Axis, Panel, Series,
    parts::{Clock, extent, unwrapped},
};
use std::collections::BTreeMap;
use undrift::noise::order_statistics::quantile;
use undrift::results::{Curve, NavigateSeries};

/// Share of a run at its start whose values may lie beyond the axis, while the filter settles.
const SETTLING: f64 = 0.05;

/// What of a run is drawn.
pub(super) type Pick = fn(&NavigateSeries) -> &BTreeMap<String, Curve>;

/// A component of all runs over time; around zero the bounds of a single one, or its estimate's.
pub(super) fn component_panel(
    (key, name, unit, factor): &Component,
    what: &str,
    series: &[(&str, &NavigateSeries)],
    clock: Clock,
    pick: Pick,
    bounds: Option<&Curve>,
) -> Option<Panel> {
    let curves: Vec<(&str, Vec<(f64, f64)>)> = series
        .iter()
        .filter_map(|(run, s)| Some((*run, clock.points(pick(s).get(*key)?, *factor))))
        .filter(|(_, points)| !points.is_empty())
        .collect();
    if curves.is_empty() {
        return None;
    }
    let label = format!(
        "{name}{}{what} [{unit}]",
        if what.is_empty() { "" } else { " " }
    );
    let mut panel = panel_over_time(&label, clock, series);
    if let Some(bounds) = bounds {
        let bounds = clock.points(bounds, 3.0 * factor);
        let limit = limit(&curves, &bounds);
        panel = panel_within(&label, clock, series, limit);
        let band: Vec<(f64, f64, f64)> = bounds.iter().map(|(t, b)| (*t, -b, *b)).collect();
        panel.add(Series::band("±3σ", BAND, &band));
    }
    for (at, (run, points)) in curves.into_iter().enumerate() {
        let points = if *unit == "°" {
            unwrapped(points)
        } else {
            points
        };
        let colour = COLOURS[at % COLOURS.len()];
        let name = if run.is_empty() && bounds.is_some() {
            what
        } else {
            run
        };
        panel.add(Series::thin(name, colour, points));
    }
    Some(panel)
}

/// How far an axis reaches: over all curves and the bounds, but for the settling at the start.
fn limit(curves: &[(&str, Vec<(f64, f64)>)], bounds: &[(f64, f64)]) -> f64 {
    let largest = curves
        .iter()
        .flat_map(|(_, points)| settled(points))
        .map(f64::abs)
        .fold(0.0, f64::max);
    // Bounds that are wide for a while, as in an outage, do not flatten the rest.
    let bounds = settled(bounds);
    let wide = (2.0 * largest).max(1.2 * quantile(&bounds, 0.75));
    let usual = quantile(&bounds, 0.95).min(wide);
    1.1 * largest
        .max(if usual.is_finite() { usual } else { 0.0 })
        .max(1e-12)
}

/// The finite values after the settling.
fn settled(points: &[(f64, f64)]) -> Vec<f64> {
    let (first, last) = extent(points);
    let from = first + SETTLING * (last - first);
    let later = points.iter().filter(|p| p.0 >= from);
    later.map(|p| p.1).filter(|v| v.is_finite()).collect()
}

pub(super) fn panel_over_time(
    label: &str,
    clock: Clock,
    series: &[(&str, &NavigateSeries)],
) -> Panel {
    let panel = Panel::new("", Axis::new(&clock.label()), Axis::new(label));
    shaded(panel, clock, series)
}

fn panel_within(
    label: &str,
    clock: Clock,
    series: &[(&str, &NavigateSeries)],
    limit: f64,
) -> Panel {
    let y = Axis::new(label).within(-limit..limit);
    shaded(Panel::new("", Axis::new(&clock.label()), y), clock, series)
}

/// With the spans without GNSS of a single run.
pub(super) fn shaded(mut panel: Panel, clock: Clock, series: &[(&str, &NavigateSeries)]) -> Panel {
    if let [(_, only)] = series {
        for (from, to) in &only.without_gnss_s {
            panel.shade(clock.at(from.0), clock.at(to.0));
        }
    }
    panel
}

/// An estimate in its bounds.
pub(super) fn sensor_panel(
    component: &Component,
    series: &[(&str, &NavigateSeries)],
    clock: Clock,
) -> Option<Panel> {
    let (key, name, unit, factor) = component;
    let [(_, only)] = series else {
        return component_panel(component, "error", series, clock, |s| &s.sensor_error, None);
    };
    let estimate = clock.points(only.sensor_error.get(*key)?, *factor);
    let bounds = only.sensor_error_std.get(*key);
    let bounds = bounds.map_or(Vec::new(), |curve| clock.points(curve, 3.0 * factor));
    // Both are thinned, each by itself: the estimate where the bound stands is that of the last time.
    let mut later = estimate.iter().copied().peekable();
    let mut now = later.peek().copied()?;
    let band: Vec<(f64, f64, f64)> = bounds
        .iter()
        .map(|(time, bound)| {
            while let Some(next) = later.next_if(|next| next.0 <= *time) {
                now = next;
            }
            (*time, now.1 - bound, now.1 + bound)
        })
        .collect();
    let lower: Vec<(f64, f64)> = band.iter().map(|b| (b.0, b.1)).collect();
    let upper: Vec<(f64, f64)> = band.iter().map(|b| (b.0, b.2)).collect();
    let values = settled(&estimate);
    let low = quantile(&settled(&lower), 0.05).min(quantile(&values, 0.0));
    let high = quantile(&settled(&upper), 0.95).max(quantile(&values, 1.0));
    let mut y = Axis::new(&format!("{name} [{unit}]"));
    if high > low {
        let room = 0.08 * (high - low);
        y = y.within(low - room..high + room);
    }
    let panel = Panel::new("", Axis::new(&clock.label()), y);
    let mut panel = shaded(panel, clock, series);
    panel.add(Series::band("±3σ", BAND, &band));
    panel.add(Series::thin("estimate", COLOURS[0], estimate));
    Some(panel)
}
