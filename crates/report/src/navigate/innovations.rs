//! Innovations over time.

use super::{
    REJECTED,
    panels::{Shown, panel_over_time},
};
use crate::{
    Block, Figure, Panel, PlotAxis, Section, Series,
    numbers::short,
    parts::{Run, broken, extent, level, prefixed, run_colour},
};
use std::collections::BTreeMap;
use undrift_results::{Curve, Navigate};

/// A run's name and its innovations of one part of the fixes.
type OfRun<'a> = (&'a str, &'a BTreeMap<String, Curve>);

/// Innovations over time, of position and velocity.
pub(super) fn innovations(runs: &[Run<'_, Navigate>], shown: &Shown<'_>) -> Option<Section> {
    let fixes = runs.iter().map(|(_, run)| run.summary.fixes).max();
    let thinned = if fixes.is_some_and(|fixes| fixes > undrift_results::series::BUCKETS as u64) {
        "; thinned to the smallest and largest of each stretch"
    } else {
        ""
    };
    let figure = |part| {
        let with: Vec<OfRun<'_>> = shown
            .series
            .iter()
            .filter_map(|(name, s)| Some((*name, s.innovations.get(part)?)))
            .filter(|(_, curves)| !curves.is_empty())
            .collect();
        if with.is_empty() {
            return None;
        }
        let panels = ["north", "east", "down"].map(|component| {
            let y = PlotAxis::new(&format!("{part} {component} [σ]"));
            panel(&with, component, y, &[-1.96, 1.96], shown)
        });
        let y = PlotAxis::logarithmic("NIS / degrees of freedom");
        let nis = panel(&with, "nis", y, &[1.0], shown);
        let caption = shown.caption(&format!(
            "Innovations of the {part} divided by their predicted standard deviations, with 95 % bounds (dashed), and NIS per degree of freedom, 1 on average if the model is correct{thinned}"
        ));
        let panels = panels.into_iter().chain([nis]);
        Figure::block(&format!("innovations-{part}"), &caption, 2, panels)
    };
    let blocks: Vec<Block> = ["position", "velocity"]
        .into_iter()
        .filter_map(figure)
        .collect();
    let parts = runs
        .iter()
        .map(|(_, run)| [run.position, run.velocity].map(|nis| short(nis.nis_per_dof.0)));
    let parts = Vec::from_iter(parts.map(|parts| parts.join(", "))).join("; ");
    let section = Section::new("Innovations", blocks)?;
    Some(section.noted(format!("NIS / dof {parts}")))
}

/// One curve of all runs with its bounds; of NIS also that of the rejected fixes.
fn panel(runs: &[OfRun<'_>], which: &str, y: PlotAxis, bounds: &[f64], shown: &Shown<'_>) -> Panel {
    // A line is no innovation where there was no fix.
    let gaps = shown.series.iter().flat_map(|(_, s)| &s.without_gnss_s);
    let gaps = gaps.map(|(from, to)| (shown.clock.at(from.0), shown.clock.at(to.0)));
    let gaps: Vec<(f64, f64)> = gaps.collect();
    let mut panel = panel_over_time(y, shown);
    let mut ends = (0.0, 1.0);
    for (at, (name, curves)) in runs.iter().enumerate() {
        let rejected = curves.get("left_out_nis").filter(|_| which == "nis");
        if let Some(curve) = curves.get(which) {
            let points = broken(shown.clock.points(curve, 1.0), &gaps);
            ends = extent(&points);
            // Beside the rejected ones the others need a name, and the cursor shows the value of what has one.
            let name = match rejected {
                Some(_) if name.is_empty() => "used",
                _ => name,
            };
            panel.add(Series::thin(name, run_colour(at), points));
        }
        if let Some(curve) = rejected {
            let single = runs.len() == 1;
            let colour = if single { REJECTED } else { run_colour(at) };
            let name = if single { "" } else { name };
            let points = shown.clock.points(curve, 1.0);
            panel.add(Series::dots(&prefixed(name, "rejected"), colour, points));
        }
    }
    for bound in bounds {
        panel.add(level("", 0, ends, *bound));
    }
    panel
}
