use super::*;
use crate::{
    figure::panel::Drawn,
    tests::{
        assert_points, by_name, cells, curve, figure_of, legend, names, near, numbers, points,
        sentences, strong,
    },
};
use undrift_results::{Aid, Curve, Drive, NavigateSeries, Nis, Number, Parameter, Start};

/// Of "°/s" in rad/s.
const DEG: f64 = std::f64::consts::PI / 180.0;
/// A metre of the equator \[deg\].
const METRE: f64 = 1.0 / DEG / 6_378_137.0;

fn by_component(values: &[(&str, f64)]) -> std::collections::BTreeMap<String, Curve> {
    let values = values.iter();
    values
        .map(|(name, value)| {
            let times = [1000.0, 1010.0, 1020.0];
            let curve = curve(&times, &[*value, 2.0 * value, 3.0 * value]);
            ((*name).to_owned(), curve)
        })
        .collect()
}

fn fixes(east: &[f64]) -> Fixes {
    Fixes {
        time_s: (0..east.len())
            .map(|k| Number(1000.0 + 10.0 * k as f64))
            .collect(),
        lat_deg: numbers(&vec![0.0; east.len()]),
        lon_deg: east.iter().map(|m| Number(m * METRE)).collect(),
        std_north_m: numbers(&vec![0.5; east.len()]),
        std_east_m: numbers(&vec![2.0; east.len()]),
    }
}

/// Twenty seconds to the east from 1000 s on, `k` metres each ten, without GNSS from 1010 to 1020 s.
fn series(k: f64) -> NavigateSeries {
    let position = [("north_m", 0.1), ("east_m", 0.2), ("down_m", 0.3)];
    let velocity = [("vn_mps", 1.0), ("ve_mps", 2.0), ("vd_mps", 3.0)];
    let attitude = [("roll_deg", 10.0), ("pitch_deg", 20.0), ("yaw_deg", 30.0)];
    let sensors = [("gyro_x_radps", DEG), ("accel_z_mps2", 0.5)];
    let all = [position, velocity, attitude].concat();
    let motion = [velocity, attitude].concat();
    let innovations = by_component(&[
        ("north", 1.0),
        ("east", -1.0),
        ("down", 0.5),
        ("nis", 0.7),
        ("left_out_nis", 20.0),
    ]);
    NavigateSeries {
        track: Track {
            time_s: numbers(&[1000.0, 1010.0, 1020.0]),
            lat_deg: numbers(&[0.0; 3]),
            lon_deg: [0.0, k * METRE, 2.0 * k * METRE].map(Number).into(),
            height_m: numbers(&[7.0, 8.0, 9.0]),
        },
        motion: by_component(&motion),
        std: by_component(&all),
        sensor_error: by_component(&sensors),
        sensor_error_std: by_component(&sensors),
        error: by_component(&all),
        innovations: [("position".to_owned(), innovations)].into(),
        without_gnss_s: vec![(1010.0.into(), 1020.0.into())],
        disagreements_s: vec![(1005.0.into(), 1015.0.into())],
        fixes: fixes(&[0.0, k]),
        rejected_fixes: fixes(&[30.0]),
    }
}

fn run(k: f64) -> Navigate {
    let mut run = Navigate {
        bias_model: "arma".into(),
        series: Some(series(k)),
        ..Navigate::default()
    };
    run.summary.started = 1000.5.into();
    run.summary.ended = 1620.5.into();
    run.summary.fixes = 1200;
    run.summary.samples = 62_000;
    run
}

fn panel_of<'a>(sections: &'a [Section], figure: &str, at: usize) -> &'a Panel {
    &figure_of(sections, figure).panels[at]
}

#[test]
fn the_ground_track_has_fixes_spans_without_them_and_the_start() {
    let run = run(50.0);
    let sections = sections(&[(String::new(), &run)]);
    let map = panel_of(&sections, "trajectory", 0);
    assert_eq!(
        legend(map),
        [
            "fixes",
            "rejected fixes",
            "solution",
            "without GNSS",
            "start"
        ]
    );
    assert!(map.to_scale && map.clock == Some(1000.0));
    assert_eq!(map.origin, Some(Geodetic::from_degrees(0.0, 0.0, 0.0)));
    let places = |at: usize, x: &[f64], times: &[f64]| {
        let series = &map.series[at];
        assert_eq!(series.x.len(), x.len(), "{}", series.name);
        for (found, expected) in series.x.iter().zip(x) {
            assert!((found - expected).abs() < 1e-6, "{}: {found}", series.name);
        }
        assert!(series.y[0].iter().all(|north| north.abs() < 1e-6));
        assert_eq!(series.times, times, "{}", series.name);
    };
    places(0, &[0.0, 50.0], &[0.0, 10.0]);
    places(1, &[30.0], &[0.0]);
    places(2, &[0.0, 50.0, 100.0], &[0.0, 10.0, 20.0]);
    // The fix that ends the span has moved the solution already.
    places(3, &[50.0], &[10.0]);
    places(4, &[0.0], &[]);
    // East, then north, as x and y.
    assert_eq!(map.series[0].sigma, [[2.0, 0.5]; 2]);
    assert_eq!(map.series[3].drawn, Drawn::Thick);
    let caption = &figure_of(&sections, "trajectory").caption;
    assert!(caption.contains("spans without a usable fix in orange"));
    assert_points(
        &panel_of(&sections, "height", 0).series[0],
        &[(0.0, 7.0), (10.0, 8.0), (20.0, 9.0)],
    );
    let height = panel_of(&sections, "height", 0);
    assert_eq!(height.shades, [(10.0, 20.0)]);
    assert_eq!(height.alarms, [(5.0, 15.0)]);
    let caption = &figure_of(&sections, "velocity").caption;
    let shaded = "; spans without a usable fix shaded; where solution and fixes disagree in orange";
    assert!(caption.contains(shaded), "{caption}");
}

#[test]
fn two_runs_are_drawn_beside_each_other_without_their_fixes() {
    let (a, b) = (run(50.0), run(51.0));
    let sections = sections(&[("a".to_owned(), &a), ("b".to_owned(), &b)]);
    let map = panel_of(&sections, "trajectory", 0);
    assert_eq!(legend(map), ["a", "b", "start"]);
    let colours: Vec<usize> = map.series[..2].iter().map(|series| series.colour).collect();
    assert_eq!(colours, [run_colour(0), run_colour(1)]);
    assert!((map.series[1].x[2] - 102.0).abs() < 1e-6);
    // Nothing is shaded, which is a single run's.
    let velocity = panel_of(&sections, "velocity", 1);
    assert_eq!(legend(velocity), ["a", "b"]);
    assert!(velocity.shades.is_empty());
    assert!(!figure_of(&sections, "velocity").caption.contains("shaded"));
    // Of each run the first component's deviation has its name, and all its pattern.
    let deviation = panel_of(&sections, "standard-deviations", 0);
    assert_eq!(legend(deviation), ["a", "", "", "b", "", ""]);
    let patterns: Vec<usize> = deviation.series.iter().map(|series| series.dash).collect();
    assert_eq!(patterns, [0, 0, 0, 1, 1, 1]);
    // Estimates without their bounds.
    let gyro = panel_of(&sections, "gyro-errors", 0);
    assert_eq!(
        (legend(gyro), &*gyro.y.label),
        (vec!["a", "b"], "gyro x error [°/s]")
    );
    assert_points(&gyro.series[0], &[(0.0, 1.0), (10.0, 2.0), (20.0, 3.0)]);
}

#[test]
fn motion_and_deviations_are_drawn_as_they_are() {
    let run = run(50.0);
    let sections = sections(&[(String::new(), &run)]);
    for (figure, labels, first) in [
        (
            "velocity",
            [
                "velocity north [m/s]",
                "velocity east [m/s]",
                "velocity down [m/s]",
            ],
            1.0,
        ),
        ("attitude", ["roll [°]", "pitch [°]", "yaw [°]"], 10.0),
    ] {
        for (at, label) in labels.into_iter().enumerate() {
            let panel = panel_of(&sections, figure, at);
            let value = first * (at + 1) as f64;
            assert_eq!(panel.y.label, label);
            assert_eq!(panel.x.label, "time since 1000 s [s]");
            assert_eq!(panel.shades, [(10.0, 20.0)]);
            assert_points(
                &panel.series[0],
                &[(0.0, value), (10.0, 2.0 * value), (20.0, 3.0 * value)],
            );
        }
    }
    let deviations = figure_of(&sections, "standard-deviations");
    assert!(deviations.caption.ends_with(
        "; spans without a usable fix shaded; where solution and fixes disagree in orange."
    ));
    for (panel, (label, names, value)) in deviations.panels.iter().zip([
        ("σ of position [m]", ["north", "east", "down"], 0.1),
        ("σ of velocity [m/s]", ["north", "east", "down"], 1.0),
        ("σ of attitude [°]", ["roll", "pitch", "yaw"], 10.0),
    ]) {
        assert!(panel.y.logarithmic);
        assert_eq!((&*panel.y.label, legend(panel)), (label, names.to_vec()));
        for (which, series) in panel.series.iter().enumerate() {
            assert_eq!((series.dash, series.colour), (which, run_colour(which)));
            assert!(near(points(series)[0].1, value * (which + 1) as f64));
        }
    }
}

#[test]
fn errors_and_estimates_are_in_three_standard_deviations() {
    let mut run = run(50.0);
    run.rms_error = Some(by_name(&[("horizontal_m", 1.25), ("north_m", 0.5)]));
    run.compared_samples = Some(12_345);
    let sections = sections(&[(String::new(), &run)]);
    let panel = panel_of(&sections, "error-position", 1);
    assert_eq!(
        (&*panel.y.label, legend(panel)),
        ("east error [m]", vec!["±3σ", "error"])
    );
    let band = &panel.series[0];
    for (k, (low, high)) in band.y[0].iter().zip(&band.y[1]).enumerate() {
        let bound = 3.0 * 0.2 * (k + 1) as f64;
        assert!(near(*low, -bound) && near(*high, bound), "{low} {high}");
    }
    assert_points(&panel.series[1], &[(0.0, 0.2), (10.0, 0.4), (20.0, 0.6)]);
    // The settling aside the bounds go from 1.2 to 1.8; 1.77 at 95 %, and 1.2 times 1.65 of the three quarters is wider.
    let range = panel.y.range.clone().unwrap();
    assert!(
        near(range.end, 1.1 * 1.77) && near(range.start, -1.1 * 1.77),
        "{range:?}"
    );
    let gyro = panel_of(&sections, "gyro-errors", 0);
    assert_eq!(
        (&*gyro.y.label, legend(gyro)),
        ("gyro x [°/s]", vec!["±3σ", "estimate"])
    );
    assert_points(&gyro.series[1], &[(0.0, 1.0), (10.0, 2.0), (20.0, 3.0)]);
    let ends = [(1.0, 3.0), (2.0, 6.0), (3.0, 9.0)];
    for (k, (estimate, bound)) in ends.into_iter().enumerate() {
        let found = [0, 1].map(|side| gyro.series[0].y[side][k]);
        assert!(near(found[0], estimate - bound) && near(found[1], estimate + bound));
    }
    let accel = panel_of(&sections, "accelerometer-errors", 0);
    assert_eq!(accel.y.label, "accelerometer z [m/s²]");
    let errors = sections
        .iter()
        .find(|section| section.title == "Errors against the truth");
    let errors = errors.unwrap();
    assert_eq!(errors.note, "1.25 m horizontal, RMS");
    assert_eq!(
        sentences(errors),
        ["The RMS horizontal position error is 1.25 m over 12\u{202f}345 samples."]
    );
    assert_eq!(
        names(errors),
        [
            "rms-errors",
            "error-position",
            "error-velocity",
            "error-attitude"
        ]
    );
    assert_eq!(
        sentences(&sections[0])[1],
        "RMS horizontal error against the truth: 1.25 m."
    );
}

#[test]
fn the_errors_of_runs_are_ranked_by_component() {
    let (mut a, mut b) = (run(50.0), run(50.0));
    a.rms_error = Some(by_name(&[("horizontal_m", 1.0), ("east_m", 9.0)]));
    b.rms_error = Some(by_name(&[("horizontal_m", 2.0), ("east_m", 3.0)]));
    let runs = [
        ("a".to_owned(), &a),
        ("b".to_owned(), &b),
        ("c".to_owned(), &a),
    ];
    let mut none = run(50.0);
    none.rms_error = None;
    let runs = [&runs[..2], &[("none".to_owned(), &none)]].concat();
    let sections = sections(&runs);
    let section = sections
        .iter()
        .find(|section| section.title == "Errors against the truth");
    let section = section.unwrap();
    assert_eq!(section.note, "1.00, 2.00 m horizontal, RMS");
    let Some(Block::Table(table)) = section.blocks.get(2) else {
        panic!("{:?}", section.blocks);
    };
    let rows = cells(table);
    assert_eq!(
        table.head[..5],
        ["run", "N [m]", "E [m]", "D [m]", "horizontal [m]"]
    );
    assert_eq!(rows[0][..5], ["a", "–", "9.00", "–", "1.00"]);
    assert_eq!(rows[1][..5], ["b", "–", "3.00", "–", "2.00"]);
    assert_eq!(strong(table), [(0, 4), (1, 2)]);
    // Of several there are no bounds.
    assert_eq!(
        legend(panel_of(&sections, "error-position", 0)),
        ["a", "b", "none"]
    );
}

#[test]
fn the_nees_says_where_the_filter_is_optimistic() {
    let said = |position: f64, velocity: f64| {
        let mut run = run(50.0);
        run.rms_error = Some(by_name(&[("horizontal_m", 1.0)]));
        run.nees_per_dof = by_name(&[("position", position), ("velocity", velocity)]);
        let sections = sections(&[(String::new(), &run)]);
        let section = sections
            .iter()
            .find(|section| section.title == "Errors against the truth");
        let said = sentences(section.unwrap())[0].to_owned();
        said.split_once("if the covariance is correct): ")
            .map(|(_, rest)| rest.to_owned())
    };
    let after = |rest: &str| Some(rest.to_owned());
    assert_eq!(
        said(2.0, 1.2),
        after(
            "position 2.00, velocity 1.20; the errors in position are slightly larger than the filter reports."
        )
    );
    assert_eq!(
        said(2.01, 1.5),
        after("position 2.01, velocity 1.50; the filter is optimistic in position.")
    );
    assert_eq!(
        said(3.0, 4.0),
        after("position 3.00, velocity 4.00; the filter is optimistic in position, velocity.")
    );
    assert_eq!(
        said(1.2, f64::NAN),
        after("position 1.20; the errors are no larger than the filter reports.")
    );
    assert_eq!(said(f64::NAN, f64::NAN), None);
}

#[test]
fn an_axis_reaches_over_what_is_usual_after_the_settling() {
    // A hundred and one values over a hundred seconds: the first five are the settling.
    let over_time = |value: fn(f64) -> f64| -> Vec<(f64, f64)> {
        (0..=100).map(f64::from).map(|t| (t, value(t))).collect()
    };
    let limit = |error: fn(f64) -> f64, bound: fn(f64) -> f64| {
        super::panels::limit(&[("", over_time(error))], &over_time(bound))
    };
    assert!(near(limit(|_| -1.0, |_| 3.0), 3.3));
    // The errors at least, wherever they are but in the settling.
    assert!(near(
        limit(|t| if t < 5.0 { 99.0 } else { -5.0 }, |_| 3.0),
        5.5
    ));
    assert!(near(
        limit(|t| if t < 6.0 { 99.0 } else { -5.0 }, |_| 3.0),
        1.1 * 99.0
    ));
    // Bounds that are wide in an outage of a tenth: a fifth more than those of most of the time,
    assert!(near(
        limit(|_| 1.0, |t| if t > 90.0 { 100.0 } else { 3.0 }),
        1.1 * 3.6
    ));
    // or twice the errors, if they are as large.
    assert!(near(
        limit(|_| 10.0, |t| if t > 90.0 { 100.0 } else { 3.0 }),
        22.0
    ));
    assert!(near(limit(|_| f64::NAN, |_| f64::NAN), 1.1e-12));
}

#[test]
fn the_bound_of_an_estimate_is_about_its_last_value_before() {
    let mut run = run(50.0);
    let of = run.series.as_mut().unwrap();
    let times: Vec<f64> = (0..=100).map(|k| 1000.0 + f64::from(k)).collect();
    // A step at 50 s, bounds at other times.
    let step: Vec<f64> = times
        .iter()
        .map(|t| if *t < 1050.0 { 1.0 } else { 2.0 })
        .collect();
    of.sensor_error = [("accel_x_mps2".to_owned(), curve(&times, &step))].into();
    let bounds = curve(&[999.0, 1049.5, 1050.0, 1100.0], &[0.1; 4]);
    of.sensor_error_std = [("accel_x_mps2".to_owned(), bounds)].into();
    let sections = sections(&[(String::new(), &run)]);
    let panel = panel_of(&sections, "accelerometer-errors", 0);
    let band = &panel.series[0];
    for (k, estimate) in [1.0, 1.0, 2.0, 2.0].into_iter().enumerate() {
        assert!(
            near(band.y[0][k], estimate - 0.3) && near(band.y[1][k], estimate + 0.3),
            "{k}"
        );
    }
    // 5 % of the lower ends from 0.7, 1.7, 1.7 on is 0.8, below the values; of the upper 2.3.
    let range = panel.y.range.clone().unwrap();
    let room = 0.08 * (2.3 - 0.8);
    assert!(
        near(range.start, 0.8 - room) && near(range.end, 2.3 + room),
        "{range:?}"
    );
}

#[test]
fn innovations_have_the_bounds_of_two_sided_ninety_five_percent() {
    let mut run = run(50.0);
    run.summary.fixes = 1000;
    run.position.nis_per_dof = 0.9.into();
    run.velocity.nis_per_dof = 1.1.into();
    let sections = sections(&[(String::new(), &run)]);
    let section = sections
        .iter()
        .find(|section| section.title == "Innovations")
        .unwrap();
    assert_eq!(section.note, "NIS / dof 0.900, 1.10");
    // No innovations of the velocity.
    assert_eq!(names(section), ["innovations-position"]);
    let figure = figure_of(&sections, "innovations-position");
    assert!(
        figure
            .caption
            .contains("1 on average if the model is correct; spans")
    );
    let labels: Vec<&str> = figure.panels.iter().map(|panel| &*panel.y.label).collect();
    assert_eq!(
        labels,
        [
            "position north [σ]",
            "position east [σ]",
            "position down [σ]",
            "NIS / degrees of freedom"
        ]
    );
    // Broken in the middle of the span without a fix.
    for (panel, value) in figure.panels.iter().zip([1.0, -1.0, 0.5, 0.7]) {
        assert_points(
            &panel.series[0],
            &[
                (0.0, value),
                (10.0, 2.0 * value),
                (15.0, f64::NAN),
                (20.0, 3.0 * value),
            ],
        );
    }
    for panel in &figure.panels[..3] {
        let [_, lower, upper] = &panel.series[..] else {
            panic!("{}", panel.series.len());
        };
        assert_eq!((lower.drawn, upper.drawn), (Drawn::Dashed, Drawn::Dashed));
        assert_points(lower, &[(0.0, -1.96), (20.0, -1.96)]);
        assert_points(upper, &[(0.0, 1.96), (20.0, 1.96)]);
    }
    let nis = &figure.panels[3];
    assert!(nis.y.logarithmic && !figure.panels[0].y.logarithmic);
    assert_eq!(legend(nis), ["used", "rejected", ""]);
    assert_eq!(
        (nis.series[1].drawn, nis.series[1].colour),
        (Drawn::Dots, REJECTED)
    );
    assert_points(&nis.series[1], &[(0.0, 20.0), (10.0, 40.0), (20.0, 60.0)]);
    assert_points(&nis.series[2], &[(0.0, 1.0), (20.0, 1.0)]);
}

#[test]
fn innovations_of_two_runs_have_their_colours_and_of_many_fixes_that_they_are_thinned() {
    let (mut a, b) = (run(50.0), run(50.0));
    a.summary.fixes = 1000;
    let runs = [("a".to_owned(), &a), ("b".to_owned(), &b)];
    let caption = |runs: &[Run<'_, Navigate>]| {
        figure_of(&sections(runs), "innovations-position")
            .caption
            .clone()
    };
    assert!(!caption(&runs[..1]).contains("thinned"));
    assert!(caption(&runs).contains("; thinned to the smallest and largest of each stretch."));
    let sections = sections(&runs);
    let nis = panel_of(&sections, "innovations-position", 3);
    assert_eq!(legend(nis), ["a", "a: rejected", "b", "b: rejected", ""]);
    let colours: Vec<usize> = nis.series.iter().map(|series| series.colour).collect();
    assert_eq!(
        colours[..4],
        [run_colour(0), run_colour(0), run_colour(1), run_colour(1)]
    );
    let section = sections
        .iter()
        .find(|section| section.title == "Innovations")
        .unwrap();
    assert_eq!(section.note, "NIS / dof –, –; –, –");
}

#[test]
fn what_was_done_is_said_in_the_words_of_the_drive() {
    let mut run = run(50.0);
    run.drive = Drive {
        imu: Some("imu.csv".into()),
        gnss: Some("gnss.csv".into()),
        model: Some("tuned".into()),
        gnss_use: Some("position".into()),
        rate_hz: 100.0.into(),
        ..Drive::default()
    };
    run.smooth = true;
    run.summary.alignment = "attitude as specified".into();
    run.mounting = Some("roll 1 deg".into());
    let section = |run: &Navigate| sections(&[("a".to_owned(), run)]).pop().unwrap();
    let done = section(&run);
    assert_eq!(
        (&*done.title, &*done.note),
        ("What was done", "1\u{202f}200 fixes used")
    );
    assert_eq!(
        sentences(&done),
        [
            "a: imu.csv at 100 Hz was navigated with the position of gnss.csv, using the noise model \"tuned\" as arma, and smoothed: every estimate also uses the later fixes. The solution has 62\u{202f}000 samples from 1000.500 s to 1620.500 s (10 min) and used 1\u{202f}200 fixes. Start: attitude as specified. Estimated mounting: roll 1 deg."
        ]
    );
    run.smooth = false;
    run.drive.model = None;
    run.drive.gnss_use = None;
    run.summary.ended = f64::NAN.into();
    let done = section(&run);
    assert!(
        sentences(&done)[0].starts_with("a: imu.csv at 100 Hz was navigated with the fixes of gnss.csv, using a noise model as arma; every estimate uses only what came before it, as while driving. Start:"),
        "{:?}",
        sentences(&done)
    );
}

#[test]
fn innovations_are_judged_by_their_size_and_their_correlation() {
    let said = |nis: f64, correlation: f64| {
        let mut run = run(50.0);
        run.velocity = Nis {
            nis_per_dof: nis.into(),
            autocorrelation: correlation.into(),
            autocorrelation_bound: 0.1.into(),
        };
        sentences(&sections(&[(String::new(), &run)])[0])[1].to_owned()
    };
    let none = f64::NAN;
    for (nis, correlation, rest) in [
        (0.6, none, "as large as predicted."),
        (1.6, 0.1, "as large as predicted, and white."),
        (1.0, -0.1, "as large as predicted, and white."),
        (
            1.0,
            0.11,
            "as large as predicted; they are slightly correlated from fix to fix.",
        ),
        (
            1.0,
            -0.21,
            "as large as predicted; they are correlated from fix to fix.",
        ),
        (
            1.0,
            0.5,
            "as large as predicted; they are correlated from fix to fix.",
        ),
        (
            4.0,
            none,
            "2.00 times as large as predicted: the filter or the stated accuracy is optimistic.",
        ),
        (
            0.25,
            none,
            "2.00 times smaller than predicted: the stated accuracy is pessimistic.",
        ),
    ] {
        let sentence = format!("The innovations of the velocity are {rest}");
        assert_eq!(said(nis, correlation), sentence);
    }
    assert!(said(1.0, 0.51).contains("strongly correlated"));
}

#[test]
fn measurements_and_constants_are_listed_in_their_units() {
    let mut run = run(50.0);
    run.position = Nis {
        autocorrelation: 0.25.into(),
        autocorrelation_bound: 0.05.into(),
        ..Nis::default()
    };
    let s = &mut run.summary;
    s.innovations[Aid::Position].updates = 1100;
    s.innovations[Aid::Position].nis_sum = 6600.0;
    s.innovations[Aid::Position].dof_sum = 3300;
    s.innovations[Aid::Position].rejected = 5;
    s.innovations[Aid::Position].weakened = 7;
    // Of these none was used.
    s.innovations[Aid::Odometer].rejected = 2;
    s.innovations[Aid::ZeroVelocity].updates = 3;
    let parameter = |value: &[f64], std: &[f64]| Parameter {
        value: numbers(value),
        std: numbers(std),
    };
    s.parameters = [
        ("TimeOffset".to_owned(), parameter(&[-0.012], &[0.001])),
        (
            "LeverArm".to_owned(),
            parameter(&[1.0, 2.0, -3.0], &[0.1, 0.2, 0.3]),
        ),
    ]
    .into();
    let section = sections(&[("a".to_owned(), &run)]).pop().unwrap();
    let [_, Block::Table(updates), Block::Table(constants)] = &section.blocks[..] else {
        panic!("{:?}", section.blocks);
    };
    assert_eq!(
        cells(updates),
        [
            [
                "a: position",
                "1\u{202f}100",
                "2.00",
                "0.25 (±0.05)",
                "5",
                "7"
            ],
            ["a: zero velocity", "3", "–", "–", "0", "0"],
            ["a: odometer", "0", "–", "–", "2", "0"],
        ]
    );
    assert_eq!(
        cells(constants),
        [
            [
                "a: lever arm correction forward, right, down",
                "m",
                "1.00, 2.00, -3.00",
                "0.10, 0.20, 0.30"
            ],
            [
                "a: time offset of the positions (true less stamped)",
                "ms",
                "-12.0",
                "1.0"
            ],
        ]
    );
}

#[test]
fn zero_on_the_time_axis_has_its_date() {
    let mut run = run(50.0);
    // 10⁹ s of Unix time at 990 s.
    run.drive.file = Some("drive.toml".into());
    run.drive.start = Some(Start {
        time_s: 990.0.into(),
        utc: String::new(),
        unix_s: 1e9.into(),
        clock: "gnss".into(),
    });
    let both = sections(&[(String::new(), &run)]);
    assert_eq!(
        figure_of(&both, "height").caption,
        "Height above the ellipsoid; spans without a usable fix shaded; where solution and fixes disagree in orange; 0 on the time axis is 2001-09-09 01:46:50 UTC."
    );
    let done = sentences(both.last().unwrap())[0];
    assert!(
        done.contains("Date at the start: 2001-09-09 01:46:50.500 UTC (from the GNSS receiver)."),
        "{done}"
    );
    run.drive.start = None;
    let sections = sections(&[(String::new(), &run)]);
    let done = sentences(sections.last().unwrap())[0];
    assert!(
        done.contains("Date at the start: no date in the logs"),
        "{done}"
    );
}
