//! The report of a navigated drive, or of several side by side.

mod accuracy;
mod innovations;
mod panels;
mod summary;

use super::{
    Block, Figure, Panel, PlotAxis, Section, Series,
    parts::{Clock, Run, on_the_ground, origin, run_colour},
};
use crate::date;
use accuracy::accuracy;
use innovations::innovations;
use panels::{Shown, component_panel, panel_over_time, sensor_panel};
use summary::{summary, verdict};
use undrift_nav::earth::Geodetic;
use undrift_results::{Fixes, Navigate, Track};

/// A component in plots: key of the JSON, name, unit, and the factor that makes the unit of the key's.
type Component = (&'static str, &'static str, &'static str, f64);

const POSITION: [Component; 3] = [
    ("north_m", "north", "m", 1.0),
    ("east_m", "east", "m", 1.0),
    ("down_m", "down", "m", 1.0),
];
const VELOCITY: [Component; 3] = [
    ("vn_mps", "velocity north", "m/s", 1.0),
    ("ve_mps", "velocity east", "m/s", 1.0),
    ("vd_mps", "velocity down", "m/s", 1.0),
];
const ATTITUDE: [Component; 3] = [
    ("roll_deg", "roll", "°", 1.0),
    ("pitch_deg", "pitch", "°", 1.0),
    ("yaw_deg", "yaw", "°", 1.0),
];
const DEGREES: f64 = 180.0 / std::f64::consts::PI;
const GYRO: [Component; 3] = [
    ("gyro_x_radps", "gyro x", "°/s", DEGREES),
    ("gyro_y_radps", "gyro y", "°/s", DEGREES),
    ("gyro_z_radps", "gyro z", "°/s", DEGREES),
];
const ACCEL: [Component; 3] = [
    ("accel_x_mps2", "accelerometer x", "m/s²", 1.0),
    ("accel_y_mps2", "accelerometer y", "m/s²", 1.0),
    ("accel_z_mps2", "accelerometer z", "m/s²", 1.0),
];

/// Colours of a band, and of what was rejected.
const BAND: usize = 7;
const REJECTED: usize = 6;

/// The sections.
pub fn sections(runs: &[Run<'_, Navigate>]) -> Vec<Section> {
    let started = runs.iter().map(|(_, run)| run.summary.started.0);
    let series = runs.iter();
    let series = series.filter_map(|(name, run)| Some((name.as_str(), run.series.as_ref()?)));
    let clock = Clock::starting(started.fold(f64::INFINITY, f64::min));
    let zero = match runs {
        [(_, only)] => date::of_axis(&only.drive, clock.zero()),
        _ => None,
    };
    let shown = Shown {
        clock,
        zero,
        series: series.collect(),
    };
    let sections = [
        verdict(runs),
        accuracy(runs, &shown),
        solution(&shown),
        deviations(&shown),
        sensors(&shown),
        innovations(runs, &shown),
        summary(runs),
    ];
    sections.into_iter().flatten().collect()
}

/// The ground track, height, velocity and attitude.
fn solution(shown: &Shown<'_>) -> Option<Section> {
    if shown.series.is_empty() {
        return None;
    }
    let start = shown.series.iter().find_map(|(_, s)| origin(&s.track));
    let ground = Panel::new("", PlotAxis::new("east [m]"), PlotAxis::new("north [m]"));
    let ground = ground.to_scale().georeferenced(start);
    let mut ground = ground.over_time(shown.clock.zero());
    let mut height = panel_over_time(PlotAxis::new("height [m]"), shown);
    let mut first = None;
    for (at, (name, run)) in shown.series.iter().enumerate() {
        let colour = run_colour(at);
        let mut track = on_the_ground(&run.track, start.as_ref());
        for (time, _) in &mut track {
            *time = shown.clock.at(*time);
        }
        let fixes = [
            ("fixes", 5, &run.fixes),
            ("rejected fixes", REJECTED, &run.rejected_fixes),
        ];
        for (what, colour, fixes) in fixes.into_iter().filter(|_| shown.is_single()) {
            ground.add(points_of(what, colour, fixes, start.as_ref(), shown.clock));
        }
        let label = if name.is_empty() { "solution" } else { name };
        ground.add(Series::line(label, colour, Vec::new()).on_map(&track));
        // Of several they would hide each other.
        let spans = run.without_gnss_s.iter().filter(|_| shown.is_single());
        for (at, (from, to)) in spans.enumerate() {
            // The fix that ends the span has moved the solution already.
            let (from, to) = (shown.clock.at(from.0), shown.clock.at(to.0));
            let inside = track.iter().filter(|(t, _)| from <= *t && *t < to);
            let way: Vec<_> = inside.copied().collect();
            let name = if at == 0 { "without GNSS" } else { "" };
            ground.add(Series::thick(name, REJECTED, Vec::new()).on_map(&way));
        }
        if at == 0 {
            first = track.first().map(|p| p.1);
        }
        let heights = run.track.time_s.iter().zip(&run.track.height_m);
        let points = heights.map(|(t, h)| (shown.clock.at(t.0), h.0)).collect();
        height.add(Series::thin(name, colour, points));
    }
    ground.series.retain(|series| !series.x.is_empty());
    ground.add(Series::dots("start", 0, Vec::from_iter(first)));
    let gaps = if shown.has_gaps() {
        "; spans without a usable fix in orange"
    } else {
        ""
    };
    let motion = |name: &str, caption: &str, components: [Component; 3]| {
        let panels = components.iter();
        let panels = panels.filter_map(|c| component_panel(c, "", shown, |s| &s.motion, None));
        Figure::block(name, &shown.caption(caption), 3, panels)
    };
    let blocks = [
        Figure::block(
            "trajectory",
            &format!(
                "Ground track from the start, to scale{gaps}; around the fixes, zoomed in, their stated standard deviations."
            ),
            1,
            [ground],
        ),
        motion("velocity", "Velocity", VELOCITY),
        motion("attitude", "Attitude", ATTITUDE),
        Figure::block(
            "height",
            &shown.caption("Height above the ellipsoid"),
            1,
            [height],
        ),
    ];
    Section::new("Solution", blocks.into_iter().flatten())
}

/// Positions of fixes on the map.
fn points_of(
    what: &str,
    colour: usize,
    fixes: &Fixes,
    origin: Option<&Geodetic>,
    clock: Clock,
) -> Series {
    let track = Track {
        time_s: fixes.time_s.clone(),
        lat_deg: fixes.lat_deg.clone(),
        lon_deg: fixes.lon_deg.clone(),
        ..Track::default()
    };
    let places = on_the_ground(&track, origin).into_iter();
    let places: Vec<_> = places.map(|(t, place)| (clock.at(t), place)).collect();
    let sigma = fixes.std_east_m.iter().zip(&fixes.std_north_m);
    let sigma = sigma.map(|(east, north)| [east.0, north.0]).collect();
    Series::points_within(what, colour, sigma).on_map(&places)
}

/// Standard deviations: a panel for each of position, velocity and attitude.
fn deviations(shown: &Shown<'_>) -> Option<Section> {
    let panel = |(label, components): (&str, [Component; 3])| {
        let y = PlotAxis::logarithmic(&format!("σ of {label}"));
        let mut panel = panel_over_time(y, shown);
        for (at, (run, s)) in shown.series.iter().enumerate() {
            for (which, (key, name, ..)) in components.iter().enumerate() {
                let Some(curve) = s.std.get(*key) else {
                    continue;
                };
                let (name, colour) = match (shown.is_single(), which) {
                    (true, _) => (name.trim_start_matches("velocity "), run_colour(which)),
                    (false, 0) => (*run, run_colour(at)),
                    (false, _) => ("", run_colour(at)),
                };
                let curve = shown.clock.points(curve, 1.0);
                let pattern = if shown.is_single() { which } else { at };
                panel.add(Series::thin(name, colour, curve).pattern(pattern));
            }
        }
        (!panel.series.is_empty()).then_some(panel)
    };
    let parts = [
        ("position [m]", POSITION),
        ("velocity [m/s]", VELOCITY),
        ("attitude [°]", ATTITUDE),
    ];
    let caption = shown.caption("Standard deviations (1σ) reported by the filter");
    let panels = parts.into_iter().filter_map(panel);
    let figure = Figure::block("standard-deviations", &caption, 3, panels);
    Section::new("Standard deviations", figure)
}

/// Estimated sensor errors.
fn sensors(shown: &Shown<'_>) -> Option<Section> {
    let figure = |(name, what, components): (&str, &str, [Component; 3])| {
        let mut caption = format!("Estimated {what} errors.");
        if shown.is_single() {
            caption = shown.caption(&format!(
                "Estimated {what} errors with ±3σ (band); the scale fits the values after settling"
            ));
        }
        let panels = components.iter().filter_map(|c| sensor_panel(c, shown));
        Figure::block(name, &caption, 3, panels)
    };
    let parts = [
        ("gyro-errors", "gyro", GYRO),
        ("accelerometer-errors", "accelerometer", ACCEL),
    ];
    let blocks: Vec<Block> = parts.into_iter().filter_map(figure).collect();
    Section::new("Estimated sensor errors", blocks)
}

#[cfg(test)]
mod tests;
