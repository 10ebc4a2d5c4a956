//! The report of a navigated drive, or of several side by side.

mod accuracy;
mod innovations;
mod panels;
mod summary;

use super::{
    Axis, Block, Panel, Section, Series,
    parts::{Clock, figure, on_the_ground, origin},
};
use accuracy::accuracy;
use innovations::innovations;
use panels::{component_panel, panel_over_time, sensor_panel, shaded};
use summary::summary;
use undrift::results::{Navigate, NavigateSeries};

/// A run with its name; the name of a single one is empty.
pub type Run<'a> = (String, &'a Navigate);

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

/// Colours of the runs, of a band, and of what was left out.
const COLOURS: [usize; 6] = [7, 6, 4, 5, 2, 0];
const BAND: usize = 7;
const LEFT_OUT: usize = 6;

/// The sections.
pub fn sections(runs: &[Run<'_>]) -> Vec<Section> {
    let clock = Clock::starting(
        runs.iter()
            .map(|(_, run)| run.summary.started.0)
            .fold(f64::INFINITY, f64::min),
    );
    let series: Vec<(&str, &NavigateSeries)> = runs
        .iter()
        .filter_map(|(name, run)| Some((name.as_str(), run.series.as_ref()?)))
        .collect();
    let mut sections = vec![summary(runs)];
    sections.extend(accuracy(runs, &series, clock));
    if !series.is_empty() {
        sections.extend(solution(&series, clock));
        sections.extend(deviations(&series, clock));
        sections.extend(sensors(&series, clock));
        sections.extend(innovations(runs, &series, clock));
    }
    sections
}

fn section(title: &str, blocks: Vec<Block>) -> Option<Section> {
    (!blocks.is_empty()).then(|| Section {
        title: title.into(),
        blocks,
    })
}

fn has_gaps(series: &[(&str, &NavigateSeries)]) -> bool {
    series.iter().any(|(_, s)| !s.without_gnss_s.is_empty())
}

/// A caption, which says what is shaded where something is.
fn with_gaps(caption: &str, series: &[(&str, &NavigateSeries)]) -> String {
    if series.len() == 1 && has_gaps(series) {
        format!("{caption}; spans without a usable fix shaded.")
    } else {
        format!("{caption}.")
    }
}

/// The way driven, height, velocity and attitude.
fn solution(series: &[(&str, &NavigateSeries)], clock: Clock) -> Option<Section> {
    let mut blocks = Vec::new();
    let start = series.iter().find_map(|(_, s)| origin(&s.track));
    let mut first = None;
    let mut ground = Panel::new("", Axis::new("east [m]"), Axis::new("north [m]")).to_scale();
    let mut height = panel_over_time("height [m]", clock, series);
    for (at, (name, run)) in series.iter().enumerate() {
        let colour = COLOURS[at % COLOURS.len()];
        let track = on_the_ground(&run.track, start.as_ref());
        ground.add(Series::line(
            name,
            colour,
            track.iter().map(|p| p.1).collect(),
        ));
        // Of several they would hide each other.
        let spans = run.without_gnss_s.iter().filter(|_| series.len() == 1);
        for (at, (from, to)) in spans.enumerate() {
            // The fix that ends the span has moved the solution already.
            let inside = track.iter().filter(|(t, _)| from.0 <= *t && *t < to.0);
            let points: Vec<_> = inside.map(|p| p.1).collect();
            let name = if at == 0 { "without GNSS" } else { "" };
            ground.add(Series::thick(name, LEFT_OUT, points));
        }
        if at == 0 {
            first = track.first().map(|p| p.1);
        }
        let heights = run.track.time_s.iter().zip(&run.track.height_m);
        let points = heights.map(|(t, h)| (clock.at(t.0), h.0)).collect();
        height.add(Series::thin(name, colour, points));
    }
    ground.add(Series::dots("start", 0, Vec::from_iter(first)));
    let gaps = has_gaps(series);
    let caption = if gaps && series.len() == 1 {
        "The way driven, to scale, from its start; spans without a usable fix in orange."
    } else {
        "The way driven, to scale, from its start."
    };
    blocks.extend(figure("trajectory", caption, 1, vec![ground]));
    let of = |components: [Component; 3]| -> Vec<Panel> {
        components
            .iter()
            .filter_map(|c| component_panel(c, "", series, clock, |s| &s.motion, None))
            .collect()
    };
    blocks.extend(figure(
        "velocity",
        &with_gaps("Velocity", series),
        3,
        of(VELOCITY),
    ));
    let attitude: Vec<Panel> = of(ATTITUDE);
    blocks.extend(figure(
        "attitude",
        &with_gaps("Attitude", series),
        3,
        attitude,
    ));
    blocks.extend(figure(
        "height",
        &with_gaps("Height above the ellipsoid", series),
        1,
        vec![height],
    ));
    section("Solution", blocks)
}

/// Standard deviations: a panel for each of position, velocity and attitude.
fn deviations(series: &[(&str, &NavigateSeries)], clock: Clock) -> Option<Section> {
    let single = series.len() == 1;
    let panels: Vec<Panel> = [
        ("position [m]", POSITION),
        ("velocity [m/s]", VELOCITY),
        ("attitude [°]", ATTITUDE),
    ]
    .into_iter()
    .filter_map(|(label, components)| {
        let y = Axis::logarithmic(&format!("σ of {label}"));
        let panel = Panel::new("", Axis::new(&clock.label()), y);
        let mut panel = shaded(panel, clock, series);
        let mut any = false;
        for (at, (run, s)) in series.iter().enumerate() {
            for (which, (key, name, ..)) in components.iter().enumerate() {
                let Some(curve) = s.std.get(*key) else {
                    continue;
                };
                any = true;
                let short = name.trim_start_matches("velocity ");
                let (name, colour) = if single {
                    (short, COLOURS[which])
                } else {
                    (
                        if which == 0 { *run } else { "" },
                        COLOURS[at % COLOURS.len()],
                    )
                };
                panel.add(Series::thin(name, colour, clock.points(curve, 1.0)));
            }
        }
        any.then_some(panel)
    })
    .collect();
    let caption = with_gaps("Standard deviations (1σ) as the filter states them", series);
    let blocks = figure("standard-deviations", &caption, 3, panels);
    section("Standard deviations", blocks.into_iter().collect())
}

/// Estimated sensor errors.
fn sensors(series: &[(&str, &NavigateSeries)], clock: Clock) -> Option<Section> {
    let single = series.len() == 1;
    let mut blocks = Vec::new();
    for (name, what, components) in [
        ("gyro-errors", "gyro", GYRO),
        ("accelerometer-errors", "accelerometer", ACCEL),
    ] {
        let panels: Vec<Panel> = components
            .iter()
            .filter_map(|c| sensor_panel(c, series, clock))
            .collect();
        let caption = if single {
            with_gaps(
                &format!(
                    "Estimated {what} errors, with three standard deviations to either side (band); the scale is that after settling"
                ),
                series,
            )
        } else {
            format!("Estimated {what} errors.")
        };
        blocks.extend(figure(name, &caption, 3, panels));
    }
    section("Estimated sensor errors", blocks)
}
