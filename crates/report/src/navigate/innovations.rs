//! Innovations over time.

use super::{
    COLOURS, LEFT_OUT, Run, figure, has_gaps,
    panels::{panel_over_time, shaded},
    section,
};
use crate::{
    Axis, Panel, Section, Series,
    parts::{Clock, broken, extent, level},
};
use undrift::results::NavigateSeries;

/// Innovations over time, of position and velocity.
pub(super) fn innovations(
    runs: &[Run<'_>],
    series: &[(&str, &NavigateSeries)],
    clock: Clock,
) -> Option<Section> {
    let mut blocks = Vec::new();
    // A line is no innovation where there was no fix.
    let gaps: Vec<(f64, f64)> = series
        .iter()
        .flat_map(|(_, s)| &s.without_gnss_s)
        .map(|(from, to)| (clock.at(from.0), clock.at(to.0)))
        .collect();
    let without_gaps = |points| broken(points, &gaps);
    for part in ["position", "velocity"] {
        let with: Vec<_> = series
            .iter()
            .filter_map(|(name, s)| Some((*name, s.innovations.get(part)?)))
            .filter(|(_, curves)| !curves.is_empty())
            .collect();
        if with.is_empty() {
            continue;
        }
        let mut panels = Vec::new();
        for component in ["north", "east", "down"] {
            let label = format!("{part} {component} [σ]");
            let mut panel = panel_over_time(&label, clock, series);
            let mut ends = (0.0, 1.0);
            for (at, (name, curves)) in with.iter().enumerate() {
                let Some(curve) = curves.get(component) else {
                    continue;
                };
                let points = without_gaps(clock.points(curve, 1.0));
                ends = extent(&points);
                panel.add(Series::thin(name, COLOURS[at % COLOURS.len()], points));
            }
            for bound in [-1.96, 1.96] {
                panel.add(level("", 0, ends, bound));
            }
            panels.push(panel);
        }
        let y = Axis::logarithmic("NIS / degrees of freedom");
        let mut nis = shaded(Panel::new("", Axis::new(&clock.label()), y), clock, series);
        let mut ends = (0.0, 1.0);
        for (at, (name, curves)) in with.iter().enumerate() {
            if let Some(curve) = curves.get("nis") {
                let points = without_gaps(clock.points(curve, 1.0));
                ends = extent(&points);
                nis.add(Series::thin(name, COLOURS[at % COLOURS.len()], points));
            }
            if let Some(curve) = curves.get("left_out_nis") {
                let (name, colour) = if with.len() == 1 {
                    ("left out".to_owned(), LEFT_OUT)
                } else {
                    (format!("{name}: left out"), COLOURS[at % COLOURS.len()])
                };
                nis.add(Series::dots(&name, colour, clock.points(curve, 1.0)));
            }
        }
        nis.add(level("", 0, ends, 1.0));
        panels.push(nis);
        let fixes = runs.iter().map(|(_, run)| run.summary.fixes).max();
        let thinned = fixes.is_some_and(|fixes| fixes > undrift::series::BUCKETS as u64);
        let caption = format!(
            "Innovations of the {part} over their predicted standard deviations, with 95 % bounds (dashed), and NIS per degree of freedom, 1 on average when the model is right{}{}.",
            if thinned {
                "; of each stretch its smallest and largest"
            } else {
                ""
            },
            if has_gaps(series) && series.len() == 1 {
                "; spans without a usable fix shaded"
            } else {
                ""
            }
        );
        blocks.extend(figure(&format!("innovations-{part}"), &caption, 2, panels));
    }
    section("Innovations", blocks)
}
