//! Panels over the time of a run.

use super::{BAND, Component};
use crate::{
    Panel, PlotAxis, Series,
    parts::{Clock, extent, run_colour, unwrapped},
};
use std::collections::BTreeMap;
use undrift_base::order_statistics::quantile;
use undrift_results::{Curve, NavigateSeries};

/// Share of a run at its start whose values may lie beyond the axis, while the filter settles.
const SETTLING: f64 = 0.05;

/// The runs that have series, by name, and the time that they count from.
pub(super) struct Shown<'a> {
    pub clock: Clock,
    /// UTC there, of a single run with a date.
    pub zero: Option<String>,
    pub series: Vec<(&'a str, &'a NavigateSeries)>,
}

impl Shown<'_> {
    /// Whether there is one run.
    pub fn is_single(&self) -> bool {
        self.series.len() == 1
    }

    /// Whether spans without a usable fix are shaded: those of a single run.
    pub fn has_gaps(&self) -> bool {
        self.is_single() && !self.series[0].1.without_gnss_s.is_empty()
    }

    /// A caption, which says what is shaded where something is.
    pub fn caption(&self, caption: &str) -> String {
        let zero = self.zero.as_ref();
        let zero = zero.map_or(String::new(), |utc| {
            format!("; 0 on the time axis is {utc}")
        });
        let gaps = match self.has_gaps() {
            true => "; spans without a usable fix shaded",
            false => "",
        };
        let alarms = match self.series.as_slice() {
            [(_, only)] if !only.disagreements_s.is_empty() => {
                "; where solution and fixes disagree in orange"
            }
            _ => "",
        };
        format!("{caption}{gaps}{alarms}{zero}.")
    }
}

/// What of a run is drawn.
pub(super) type Pick = fn(&NavigateSeries) -> &BTreeMap<String, Curve>;

/// A component of all runs over time; around zero the bounds of a single one, or its estimate's.
pub(super) fn component_panel(
    (key, name, unit, factor): &Component,
    what: &str,
    shown: &Shown<'_>,
    pick: Pick,
    bounds: Option<&Curve>,
) -> Option<Panel> {
    let curves = shown.series.iter().filter_map(|(run, s)| {
        let points = shown.clock.points(pick(s).get(*key)?, *factor);
        (!points.is_empty()).then_some((*run, points))
    });
    let curves: Vec<(&str, Vec<(f64, f64)>)> = curves.collect();
    if curves.is_empty() {
        return None;
    }
    let label = [*name, what, &format!("[{unit}]")];
    let label = label.into_iter().filter(|word| !word.is_empty());
    let mut y = PlotAxis::new(&Vec::from_iter(label).join(" "));
    let bounds = bounds.map(|bounds| shown.clock.points(bounds, 3.0 * factor));
    if let Some(bounds) = &bounds {
        let limit = limit(&curves, bounds);
        y = y.within(-limit..limit);
    }
    let mut panel = panel_over_time(y, shown);
    if let Some(bounds) = &bounds {
        let band: Vec<(f64, f64, f64)> = bounds.iter().map(|(t, b)| (*t, -b, *b)).collect();
        panel.add(Series::band("±3σ", BAND, &band));
    }
    for (at, (run, mut points)) in curves.into_iter().enumerate() {
        if *unit == "°" {
            points = unwrapped(points);
        }
        let of_one = run.is_empty() && bounds.is_some();
        let name = if of_one { what } else { run };
        panel.add(Series::thin(name, run_colour(at), points));
    }
    Some(panel)
}

/// How far an axis reaches: over all curves and the bounds, but for the settling at the start.
pub(super) fn limit(curves: &[(&str, Vec<(f64, f64)>)], bounds: &[(f64, f64)]) -> f64 {
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

/// A panel over time, with the spans without GNSS of a single run.
pub(super) fn panel_over_time(y: PlotAxis, shown: &Shown<'_>) -> Panel {
    let x = PlotAxis::new(&shown.clock.label());
    let mut panel = Panel::new("", x, y).over_time(shown.clock.zero());
    if let [(_, only)] = shown.series.as_slice() {
        for (from, to) in &only.without_gnss_s {
            panel.shade(shown.clock.at(from.0), shown.clock.at(to.0));
        }
        for (from, to) in &only.disagreements_s {
            panel.alarm(shown.clock.at(from.0), shown.clock.at(to.0));
        }
    }
    panel
}

/// An estimate in its bounds.
pub(super) fn sensor_panel(component: &Component, shown: &Shown<'_>) -> Option<Panel> {
    let (key, name, unit, factor) = component;
    let [(_, only)] = shown.series.as_slice() else {
        return component_panel(component, "error", shown, |s| &s.sensor_error, None);
    };
    let points = |curve, factor| shown.clock.points(curve, factor);
    let estimate = points(only.sensor_error.get(*key)?, *factor);
    let bounds = only.sensor_error_std.get(*key);
    let bounds = bounds.map_or(Vec::new(), |curve| points(curve, 3.0 * factor));
    // Both are thinned, each by itself: the estimate at the bound's time is that of the last time.
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
    let room = 0.08 * (high - low);
    let y = PlotAxis::new(&format!("{name} [{unit}]")).within(low - room..high + room);
    let mut panel = panel_over_time(y, shown);
    panel.add(Series::band("±3σ", BAND, &band));
    panel.add(Series::thin("estimate", run_colour(0), estimate));
    Some(panel)
}
