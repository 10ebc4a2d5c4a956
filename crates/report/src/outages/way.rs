//! Where GNSS was cut.

use crate::{
    Axis, Figure, Panel, Section, Series,
    parts::{Run, on_the_ground, origin},
};
use undrift::results::Outages;

/// The ground track with its outages, one panel for each drive.
pub(crate) fn way(runs: &[Run<'_, Outages>]) -> Option<Section> {
    let mut drawn: Vec<&Run<'_, Outages>> = Vec::new();
    for run in runs {
        let (track, cuts) = (&run.1.series.track, &run.1.outages);
        let same =
            |other: &&Run<'_, Outages>| other.1.series.track == *track && other.1.outages == *cuts;
        if !track.time_s.is_empty() && !drawn.iter().any(same) {
            drawn.push(run);
        }
    }
    let panels = drawn.iter().map(|(name, run)| panel(name, run));
    let caption = "Ground track from the start, to scale; without GNSS in orange.";
    let figure = Figure::of("trajectory", caption, drawn.len().min(2), panels);
    Section::of("Where GNSS was cut", figure)
}

fn panel(name: &str, run: &Outages) -> Panel {
    let track = &run.series.track;
    let points = on_the_ground(track, origin(track).as_ref());
    let mut panel = Panel::new(name, Axis::new("east [m]"), Axis::new("north [m]")).to_scale();
    let all = points.iter().map(|p| p.1).collect();
    panel.add(Series::line("driven", 1, all));
    for (at, cut) in run.outages.iter().enumerate() {
        let (from, to) = (cut.start_s.0, cut.start_s.0 + cut.length_s.0);
        let inside = points.iter().filter(|(t, _)| from <= *t && *t <= to);
        let name = if at == 0 { "without GNSS" } else { "" };
        panel.add(Series::thick(name, 6, inside.map(|p| p.1).collect()));
    }
    let start = points.first().map(|p| p.1);
    panel.add(Series::dots("start", 0, Vec::from_iter(start)));
    panel
}
