//! The report of a navigated drive, or of several side by side.

mod accuracy;
mod panels;

use super::{
    Axis, Block, Cell, Corner, Figure, Panel, Section, Series, Table,
    parts::{
        Clock, broken, cell, count, error, extent, level, named, on_the_ground, origin, short,
        span, table, text, warnings,
    },
    read::{Counts, Navigate, NavigateSeries, Nis},
};
use accuracy::accuracy;
use panels::{component_panel, panel_over_time, sensor_panel, shaded};

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

/// NIS per degree of freedom that is told as right.
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 0.6..=1.6;

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

fn figure(name: &str, caption: &str, columns: usize, panels: Vec<Panel>) -> Option<Block> {
    (!panels.is_empty()).then(|| {
        Block::Figure(Figure {
            name: name.into(),
            caption: caption.into(),
            columns,
            panels,
        })
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

/// What was done and how it went, in words and counts.
fn summary(runs: &[Run<'_>]) -> Section {
    let mut blocks = Vec::new();
    let told: Vec<String> = runs
        .iter()
        .flat_map(|(name, run)| run.warnings.iter().map(|w| named(name, w)))
        .collect();
    blocks.extend(warnings(&told));
    for (name, run) in runs {
        blocks.extend(text(&what_was_done(name, run)));
    }
    let mut counts = table(
        "updates",
        "Measurements used. NIS / dof is the normalised innovation squared per degree of freedom, 1 when the model is right; the autocorrelation is that of the innovations from one fix to the next, with its 95 % bound for white ones. Left out are those far from the prediction; weakened those that were doubtful and counted less.",
        &[
            "measurement",
            "updates",
            "NIS / dof",
            "autocorrelation",
            "left out",
            "weakened",
        ],
    );
    for (name, run) in runs {
        counts.rows.extend(update_rows(name, run));
    }
    if !counts.rows.is_empty() {
        blocks.push(Block::Table(counts));
    }
    blocks.extend(parameters(runs).map(Block::Table));
    Section {
        title: "What was done".into(),
        blocks,
    }
}

fn what_was_done(name: &str, run: &Navigate) -> Vec<String> {
    let (drive, s) = (&run.drive, &run.summary);
    let mut told = Vec::new();
    let prefix = if name.is_empty() {
        String::new()
    } else {
        format!("{name}: ")
    };
    if let (Some(imu), Some(gnss)) = (&drive.imu, &drive.gnss) {
        let model = drive.model.as_deref().filter(|m| !m.is_empty());
        told.push(format!(
            "{prefix}{imu} at {} Hz was navigated with the {} of {gnss}, with {} run as {}{}.",
            short(drive.rate_hz.0),
            drive.gnss_use.as_deref().unwrap_or("fixes"),
            model.map_or("a noise model".into(), |m| format!(
                "the noise model \"{m}\""
            )),
            run.bias_model,
            if run.smooth {
                ", and smoothed: every sample knows the fixes after it too"
            } else {
                ""
            },
        ));
    }
    let (from, to) = (s.started.0, s.ended.0);
    if from.is_finite() && to.is_finite() {
        told.push(format!(
            "The solution has {} samples from {from:.3} s to {to:.3} s ({}) and used {} fixes.",
            count(s.samples),
            span(to - from),
            count(s.fixes)
        ));
    }
    if !s.alignment.is_empty() {
        told.push(format!("Start: {}.", s.alignment));
    }
    told.extend(
        run.mounting
            .as_ref()
            .map(|m| format!("Mounting estimated: {m}.")),
    );
    for (part, nis) in [("position", &run.position), ("velocity", &run.velocity)] {
        told.push(verdict(part, nis));
    }
    told
}

/// What the innovations of a part of the fixes say.
fn verdict(part: &str, nis: &Nis) -> String {
    let value = nis.nis_per_dof.0;
    let (correlation, bound) = (nis.autocorrelation.0, nis.autocorrelation_bound.0);
    let size = if !value.is_finite() {
        return String::new();
    } else if PLAUSIBLE.contains(&value) {
        format!("The innovations of the {part} are as large as predicted")
    } else if value > 1.0 {
        format!(
            "The innovations of the {part} are {} times as large as predicted: the filter or the stated accuracy is optimistic",
            short(value.sqrt())
        )
    } else {
        format!(
            "The innovations of the {part} are {} times smaller than predicted: the stated accuracy is pessimistic",
            short(value.sqrt().recip())
        )
    };
    let colour = match correlation {
        c if !c.is_finite() => "",
        c if c.abs() <= bound => ", and white",
        c if c.abs() > 0.5 => {
            "; they are strongly correlated from fix to fix, so that the errors of fixes or model last longer than the filter assumes"
        }
        c if c.abs() > 0.2 => "; they are correlated from fix to fix",
        _ => "; they are slightly correlated from fix to fix",
    };
    format!("{size}{colour}.")
}

fn update_rows(name: &str, run: &Navigate) -> Vec<Vec<Cell>> {
    let s = &run.summary;
    let none = Nis::default();
    let kinds: [(&str, &Counts, &Nis); 6] = [
        ("position", &s.position, &run.position),
        ("velocity", &s.velocity, &run.velocity),
        ("non-holonomic", &s.non_holonomic, &none),
        ("zero velocity", &s.zero_velocity, &none),
        ("odometer", &s.odometer, &none),
        ("barometer", &s.barometer, &none),
    ];
    kinds
        .into_iter()
        .filter(|(_, counts, _)| counts.updates + counts.rejected > 0)
        .map(|(kind, counts, nis)| {
            let measurement = if name.is_empty() {
                kind.to_owned()
            } else {
                format!("{name}: {kind}")
            };
            let correlation = if nis.autocorrelation.0.is_finite() {
                format!(
                    "{:.2} (±{:.2})",
                    nis.autocorrelation.0, nis.autocorrelation_bound.0
                )
            } else {
                "–".into()
            };
            vec![
                measurement.into(),
                count(counts.updates).into(),
                cell(counts.nis_sum.0 / counts.dof_sum as f64),
                correlation.into(),
                count(counts.rejected).into(),
                count(counts.weakened).into(),
            ]
        })
        .collect()
}

/// Constants that were estimated.
fn parameters(runs: &[Run<'_>]) -> Option<Table> {
    let mut estimated = table(
        "parameters",
        "Constants estimated beside the sensors' errors, with their standard deviations at the end.",
        &["constant", "unit", "estimate", "standard deviation"],
    );
    for (name, run) in runs {
        for (kind, parameter) in &run.summary.parameters {
            let (constant, unit, factor) = constant(kind);
            let list = |numbers: &[super::read::Number], text: fn(f64) -> String| -> Cell {
                let texts: Vec<String> = numbers.iter().map(|n| text(factor * n.0)).collect();
                texts.join(", ").into()
            };
            estimated.rows.push(vec![
                named(name, constant).into(),
                unit.into(),
                list(&parameter.value, short),
                list(&parameter.std, error),
            ]);
        }
    }
    (!estimated.rows.is_empty()).then_some(estimated)
}

/// A kind of [`undrift_nav::parameters::Parameter`] in words, its unit in the report, and what that is of SI.
fn constant(kind: &str) -> (&str, &'static str, f64) {
    match kind {
        "GyroScale" => ("gyro scale factors x, y, z", "%", 100.0),
        "AccelScale" => ("accelerometer scale factors x, y, z", "%", 100.0),
        "GyroMisalignment" => ("gyro axes xy, xz, yx, yz, zx, zy", "°", DEGREES),
        "AccelMisalignment" => ("accelerometer axes xy, xz, yx, yz, zx, zy", "°", DEGREES),
        "LeverArm" => (
            "lever arm forward, right, down, beyond the configured",
            "m",
            1.0,
        ),
        "TimeOffset" => ("fixes later than stamped by", "ms", 1e3),
        "Mounting" => ("vehicle against body: pitch, yaw", "°", DEGREES),
        "Axle" => ("fixed axle further forward by", "m", 1.0),
        "OdometerScale" => ("odometer scale factor", "%", 100.0),
        "BarometerBias" => ("error of the barometric height", "m", 1.0),
        other => (other, "SI", 1.0),
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
        let panel = Panel::new("", Axis::new(&clock.label()), y).legend(Corner::UpperRight);
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

/// Innovations over time.
fn innovations(
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
        let thinned = fixes.is_some_and(|fixes| fixes > crate::series::BUCKETS as u64);
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
