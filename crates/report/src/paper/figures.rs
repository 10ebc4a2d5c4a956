//! Figures 1, 3, 4 and 5 of the source paper, ours.

use super::{AXIS, Paper};
use crate::{
    Block, Figure, Panel, PlotAxis, Series,
    identify::{correlation, record, units},
    parts::{on_the_ground, origin, points},
};
use undrift_results::{
    Axis, Demo, PaperSolution,
    demo::{PAPER_EXACT, WHITE},
};

/// The record.
pub(super) fn figure_1(axis: &Axis) -> Option<Block> {
    let caption = "The source paper's Figure 1: the z gyro at rest; of each stretch the smallest and largest sample.";
    Figure::block("paper-figure-1", caption, 1, record(axis, units(AXIS)))
}

/// Correlations of what ARMA(1,1) leaves.
pub(super) fn figure_3(paper: &Paper) -> Option<Block> {
    let of = paper.residuals.as_ref()?;
    let panels = [
        correlation("Autocorrelation", &of.acf, of.bound.0),
        correlation("Partial autocorrelation", &of.pacf, of.bound.0),
    ];
    let caption = "The source paper's Figure 3: correlations of what ARMA(1,1) with φ = 1 leaves of the z gyro, and the 95 % bounds of white noise.";
    Figure::block("paper-figure-3", caption, 2, panels)
}

/// The two filters that the paper compares.
fn solutions(paper: &Paper) -> impl Iterator<Item = (&'static str, &PaperSolution)> {
    [WHITE, PAPER_EXACT]
        .into_iter()
        .filter_map(|name| Some((name, paper.solutions.get(name)?)))
}

fn cut(demo: &Demo, time: f64) -> bool {
    demo.cuts
        .iter()
        .any(|c| c.start_s.0 < time && time <= c.start_s.0 + c.length_s.0)
}

/// The tracks with the outages.
pub(super) fn figure_4(demo: &Demo, paper: &Paper) -> Option<Block> {
    let origin = origin(&demo.track);
    let panels = solutions(paper).map(|(name, solution)| {
        let track = on_the_ground(&solution.track, origin.as_ref());
        let x = PlotAxis::new("east [m]");
        let mut panel = Panel::new(name, x, PlotAxis::new("north [m]")).to_scale();
        let all = track.iter().map(|p| p.1).collect();
        panel.add(Series::line("solution", 1, all));
        let inside = track.iter().map(|(time, place)| match cut(demo, *time) {
            true => *place,
            false => (f64::NAN, f64::NAN),
        });
        panel.add(Series::thick("without GNSS", 6, inside.collect()));
        panel
    });
    let caption = "The source paper's Figure 4: the first drive by each of its two filters, without GNSS in orange.";
    Figure::block("paper-figure-4", caption, 2, panels)
}

/// Position errors over time.
pub(super) fn figure_5(demo: &Demo, paper: &Paper) -> Option<Block> {
    let errors = || solutions(paper).flat_map(|(_, s)| &s.error_m);
    let sizes = errors().flat_map(|c| &c.value).map(|v| v.0.abs());
    let most = 1.05 * sizes.filter(|v| v.is_finite()).fold(0.1, f64::max);
    let panels = solutions(paper).map(|(name, solution)| {
        let y = PlotAxis::new("position error [m]").within(-most..most);
        let mut panel = Panel::new(name, PlotAxis::new("time [s]"), y);
        for c in &demo.cuts {
            panel.shade(c.start_s.0, c.start_s.0 + c.length_s.0);
        }
        let named = [("north", 7), ("east", 6), ("down", 4)].into_iter();
        for ((name, colour), curve) in named.zip(&solution.error_m) {
            let points = points(&curve.time_s, &curve.value, 1.0);
            panel.add(Series::line(name, colour, points));
        }
        panel
    });
    let caption =
        "The source paper's Figure 5: position errors over the first drive, its 15 outages shaded.";
    Figure::block("paper-figure-5", caption, 1, panels)
}

/// How the literal equations fare by σ.
pub(super) fn scan(paper: &Paper) -> Option<Block> {
    let drift = paper.scan.iter().map(|p| (p.scale.0, p.horizontal_m.0));
    let drift: Vec<(f64, f64)> = drift.collect();
    if drift.is_empty() {
        return None;
    }
    let x = PlotAxis::logarithmic("σ of equation (9) over the white noise of a sample");
    let y = PlotAxis::logarithmic("horizontal error, RMS [m]");
    let mut panel = Panel::new("", x, y);
    panel.add(Series::line("", 7, drift.clone()));
    panel.add(Series::dots("", 7, drift));
    let caption = "Equations (3)-(9) to the letter, by σ: RMS over all outages of 10 s of the largest horizontal error.";
    Figure::block("paper-scan", caption, 1, [panel])
}
