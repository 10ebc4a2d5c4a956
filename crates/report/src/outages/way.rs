//! Where GNSS was cut.

use super::Run;
use crate::{
    Axis, Block, Figure, Panel, Section, Series,
    parts::{on_the_ground, origin},
};
use undrift::results::Outages;

/// The way driven with its outages, one panel for each drive.
pub(super) fn way(runs: &[Run<'_>]) -> Option<Section> {
    let mut panels: Vec<Panel> = Vec::new();
    let mut drawn: Vec<&Run<'_>> = Vec::new();
    for run in runs {
        let (name, result) = run;
        let track = &result.series.track;
        let same = |other: &&Run<'_>| {
            let starts = |r: &Outages| {
                r.outages
                    .iter()
                    .map(|o| o.start_s.0.to_bits())
                    .collect::<Vec<_>>()
            };
            let ways = |r: &Outages| {
                r.series
                    .track
                    .lat_deg
                    .iter()
                    .map(|n| n.0.to_bits())
                    .collect::<Vec<_>>()
            };
            starts(other.1) == starts(result) && ways(other.1) == ways(result)
        };
        if track.time_s.is_empty() || drawn.iter().any(same) {
            continue;
        }
        drawn.push(run);
        let points = on_the_ground(track, origin(track).as_ref());
        let mut panel = Panel::new(name, Axis::new("east [m]"), Axis::new("north [m]")).to_scale();
        panel.add(Series::line(
            "driven",
            1,
            points.iter().map(|p| p.1).collect(),
        ));
        let start = points.first().map(|p| p.1);
        for (at, cut) in result.outages.iter().enumerate() {
            let (from, to) = (cut.start_s.0, cut.start_s.0 + cut.length_s.0);
            let inside = points.iter().filter(|(t, _)| from <= *t && *t <= to);
            let name = if at == 0 { "without GNSS" } else { "" };
            panel.add(Series::thick(name, 6, inside.map(|p| p.1).collect()));
        }
        panel.add(Series::dots("start", 0, Vec::from_iter(start)));
        panels.push(panel);
    }
    (!panels.is_empty()).then(|| Section {
        title: "Where GNSS was cut".into(),
        blocks: vec![Block::Figure(Figure {
            name: "trajectory".into(),
            caption: "The way driven, to scale, from its start; without GNSS in orange.".into(),
            columns: panels.len().min(2),
            panels,
        })],
    })
}
