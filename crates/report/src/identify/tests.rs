use super::*;
use crate::tests::{
    assert_points, by_name, cells, curve, figure_of, legend, names, near, numbers, sentences,
    strong,
};
use undrift_noise::{screening::Outlier, stationarity::Critical};
use undrift_results::{
    AxisPool, Candidate, Differing, Pool, PooledRecord, Psd, RecordShare, TurnOn,
};

/// Of "°/s" in rad/s.
const DEG: f64 = std::f64::consts::PI / 180.0;

fn term(value: f64, seen: bool) -> Term {
    Term {
        value,
        seen,
        ..Term::default()
    }
}

/// A gyro with 2 °/√h of white noise, 3 °/h of bias instability and 6 °/h/√h of random walk, `k` times all of them.
fn gyro(k: f64) -> Axis {
    let mut axis = Axis {
        samples: 90_000,
        ..Axis::default()
    };
    let terms = &mut axis.allan_terms;
    terms.white = term(k * 2.0 / 60.0 * DEG, true);
    terms.bias_instability = term(k * 3.0 / 3600.0 * DEG, true);
    terms.random_walk = term(k * 6.0 / 3600.0 / 60.0 * DEG, false);
    axis.allan.tau_s = numbers(&[0.1, 1.0]);
    axis.allan.adev = numbers(&[k * DEG, 0.5 * k * DEG]);
    axis.series.psd = Some(Psd {
        frequency_hz: numbers(&[10.0]),
        density: numbers(&[k * k * DEG * DEG]),
    });
    axis.series.record = curve(&[0.0, 1.0], &[DEG, DEG]);
    let candidate = Candidate {
        name: "white + random walk".into(),
        drift_score: by_name(&[("30", k * DEG), ("100", 2.0 * k * DEG)]),
        ..Candidate::default()
    };
    axis.candidates = vec![candidate.clone()];
    axis.chosen = candidate;
    axis
}

fn identify(axes: &[(&str, Axis)]) -> Identify {
    let axes = axes.iter();
    Identify {
        rate_hz: 100.0.into(),
        axes: axes
            .map(|(name, axis)| ((*name).to_owned(), axis.clone()))
            .collect(),
        ..Identify::default()
    }
}

#[test]
fn an_axis_in_few_words_has_the_terms_that_are_seen() {
    let mut axis = gyro(1.0);
    assert_eq!(
        in_short("gyro_x", &axis),
        "N 2.00 °/√h, B 3.00 °/h, white + random walk"
    );
    axis.allan_terms.bias_instability.seen = false;
    axis.allan_terms.random_walk.seen = true;
    axis.chosen.name.clear();
    assert_eq!(in_short("gyro_x", &axis), "N 2.00 °/√h, K 6.00 °/h/√h");
}

#[test]
fn each_model_is_recommended_for_its_axes() {
    let named = |name: &str| {
        let mut axis = gyro(1.0);
        axis.chosen.name = name.into();
        axis
    };
    let run = identify(&[
        ("gyro_x", named("AR(2)")),
        ("gyro_y", named("white")),
        ("gyro_z", named("AR(2)")),
        ("accel_x", named("AR(2)")),
        ("accel_y", named("")),
    ]);
    assert_eq!(
        recommended(&run),
        "Recommended: AR(2) for gyro x, gyro z and accelerometer x; white for gyro y."
    );
    assert_eq!(recommended(&identify(&[("gyro_x", named(""))])), "");
}

#[test]
fn the_terms_are_a_row_for_each_axis() {
    let mut accel = gyro(1.0);
    let g = undrift_nav::earth::STANDARD_GRAVITY;
    accel.allan_terms.white = term(0.5 / 60.0, true);
    accel.allan_terms.bias_instability = term(0.03e-3 * g, false);
    accel.allan_terms.random_walk = term(2e-3 / 60.0 * g, true);
    accel.outliers = vec![
        Outlier {
            index: 1,
            value: 1.0,
            sigmas: 9.0
        };
        3
    ];
    let run = identify(&[("accel_x", accel), ("gyro_x", gyro(1.0))]);
    let table = models(identified("a", &run));
    assert_eq!(
        cells(&table),
        [
            [
                "a: gyro x",
                "2.00 °/√h",
                "<2711 °/h",
                "not detected",
                "white + random walk",
                "0"
            ],
            [
                "a: accelerometer x",
                "0.500 m/s/√h",
                "<1.34 mg",
                "2.00 mg/√h",
                "white + random walk",
                "3"
            ],
        ]
    );
}

#[test]
fn each_test_stands_under_its_name() {
    let critical = |five: f64| Critical {
        one: 9.0,
        five,
        ten: 8.0,
    };
    let test = |statistic: f64, critical_5: f64| Test {
        statistic,
        critical_5,
        p_value: 0.5,
    };
    let mut axis = gyro(1.0);
    axis.adf.fixed.statistic = -50.0;
    axis.adf.fixed.critical = critical(-2.86);
    axis.kpss.statistic = 1.5;
    axis.kpss.critical = critical(0.463);
    axis.jarque_bera = test(4.0, 5.99);
    axis.ks = test(0.01, 0.02);
    axis.lilliefors = test(0.03, 0.04);
    axis.skewness = 0.5.into();
    axis.kurtosis_excess = (-0.25).into();
    let run = identify(&[("gyro_x", axis)]);
    let table = tests(identified("", &run));
    assert_eq!(
        table.head,
        [
            "axis",
            "ADF",
            "KPSS",
            "Jarque-Bera",
            "Kolmogorov-Smirnov",
            "Lilliefors",
            "skewness",
            "excess kurtosis"
        ]
    );
    assert_eq!(
        cells(&table),
        [[
            "gyro x",
            "-50.0 (-2.86)",
            "1.50 (0.463)",
            "4.00 (5.99)",
            "0.0100 (0.0200)",
            "0.0300 (0.0400)",
            "0.500",
            "-0.250"
        ]]
    );
}

#[test]
fn what_was_recorded_is_counted_and_timed() {
    let mut run = identify(&[("gyro_x", gyro(1.0))]);
    assert_eq!(
        what_was_done("", &run),
        [
            "A static recording: 90\u{202f}000 samples of one axis at 100 Hz, 15 min.",
            "",
            "Models were fitted to one half and judged on the other by the drift that they leave in the integral of the samples."
        ]
    );
    run.record = "rest.csv".into();
    run.skipped_rows = 1234;
    run.axes.insert("gyro_y".into(), gyro(1.0));
    run.pool = Some(Pool::default());
    assert_eq!(
        what_was_done("a", &run),
        [
            "a: rest.csv: 90\u{202f}000 samples of 2 axes at 100 Hz, 15 min.",
            "1\u{202f}234 rows were skipped.",
            ""
        ]
    );
}

#[test]
fn an_axis_is_not_normal_if_either_test_rejects_it() {
    let with = |jarque_bera: f64, lilliefors: f64, step: f64| {
        let mut axis = gyro(1.0);
        axis.jarque_bera.p_value = jarque_bera;
        axis.lilliefors.p_value = lilliefors;
        axis.quantisation_step = step.into();
        axis
    };
    let said = |x: Axis, y: Axis| normality(&identify(&[("gyro_x", x), ("gyro_y", y)]));
    assert_eq!(
        said(with(0.05, 0.05, 0.1), with(0.5, 0.5, 0.1)),
        "No axis differs from a normal distribution at the 5 % level."
    );
    let both = said(with(0.04, 0.5, 0.0), with(0.5, 0.04, 0.0));
    assert!(
        both.starts_with("Not normal at the 5 % level: gyro x, gyro y. "),
        "{both}"
    );
    // The grid of an axis that is normal explains nothing.
    let one = said(with(0.04, 0.5, 0.0), with(0.5, 0.5, 0.1));
    assert!(
        one.starts_with("Not normal at the 5 % level: gyro x. "),
        "{one}"
    );
    let grid = said(with(0.5, 0.5, 0.0), with(0.04, 0.5, 0.1));
    assert!(
        grid.starts_with("Not normal at the 5 % level: gyro y (quantised samples"),
        "{grid}"
    );
}

#[test]
fn one_recording_has_a_folded_section_for_each_axis_that_was_identified() {
    let failed = Axis {
        error: Some("too short".into()),
        ..Axis::default()
    };
    let run = identify(&[
        ("gyro_x", gyro(1.0)),
        ("gyro_y", failed),
        ("accel_x", gyro(2.0)),
    ]);
    let sections = sections(&[(String::new(), &run)]);
    let titles: Vec<(&str, bool)> = sections.iter().map(|s| (&*s.title, s.folded)).collect();
    assert_eq!(
        titles,
        [
            ("Static recording", false),
            ("Gyro x", true),
            ("Accelerometer x", true)
        ]
    );
    assert_eq!(sections[1].note, in_short("gyro_x", &gyro(1.0)));
    assert_eq!(names(&sections[0]), ["allan", "models", "tests"]);
    assert!(
        sentences(&sections[0]).contains(&"Gyro y: too short."),
        "{:?}",
        sentences(&sections[0])
    );
    assert_eq!(
        names(&sections[1]),
        ["record-gyro_x", "allan-gyro_x", "candidates-gyro_x"]
    );
    // All deviations in one figure: the gyros', then the accelerometers'.
    let figure = figure_of(&sections, "allan");
    let panels = figure.panels.iter();
    let seen: Vec<(&str, Vec<&str>)> = panels.map(|panel| (&*panel.title, legend(panel))).collect();
    assert_eq!(
        seen,
        [
            ("Gyros", vec!["gyro x"]),
            ("Accelerometers", vec!["accelerometer x"])
        ]
    );
    assert_points(&figure.panels[0].series[0], &[(0.1, 1.0), (1.0, 0.5)]);
    assert_points(&figure.panels[1].series[0], &[(0.1, 2.0 * DEG), (1.0, DEG)]);
    // A single axis has its own.
    let single = identify(&[("gyro_x", gyro(1.0))]);
    let sections = super::sections(&[(String::new(), &single)]);
    assert_eq!(names(&sections[0]), ["models", "tests"]);
}

#[test]
fn axes_of_several_recordings_are_compared() {
    let mut second = gyro(3.0);
    second.chosen.name = "gone".into();
    second.outliers = vec![
        Outlier {
            index: 1,
            value: 1.0,
            sigmas: 9.0
        };
        2
    ];
    let runs = [
        identify(&[("gyro_x", gyro(1.0))]),
        identify(&[("gyro_x", second)]),
    ];
    let runs = [("a".to_owned(), &runs[0]), ("b".to_owned(), &runs[1])];
    let sections = sections(&runs);
    assert_eq!(sections.len(), 2);
    let section = &sections[1];
    assert!(!section.folded && section.title == "Gyro x");
    let [Block::Figure(figure), Block::Table(table)] = &section.blocks[..] else {
        panic!("{:?}", section.blocks);
    };
    assert_eq!(figure.name, "allan-gyro_x");
    for (panel, points) in figure
        .panels
        .iter()
        .zip([[(0.1, 3.0), (1.0, 1.5)].as_slice(), &[(10.0, 3.0)]])
    {
        assert_eq!(legend(panel), ["a", "b"]);
        assert_points(&panel.series[1], points);
    }
    // The longest horizon, of the model that is recommended.
    assert_eq!(
        cells(table),
        [
            ["a", "white + random walk", "2.00 ° after 100 s", "0"],
            ["b", "gone", "–", "2"],
        ]
    );
}

#[test]
fn without_models_there_is_the_allan_deviation_alone() {
    let mut axis = gyro(1.0);
    axis.candidates.clear();
    axis.chosen = Candidate::default();
    let run = identify(&[("gyro_x", axis)]);
    let sections = sections(&[("a".to_owned(), &run)]);
    assert_eq!(sections.len(), 1);
    assert_eq!(names(&sections[0]), ["allan", "terms"]);
    let said = sentences(&sections[0]);
    assert!(
        said[0].starts_with("a: Usable: 1 axis, 15 min at 100 Hz."),
        "{said:?}"
    );
    assert!(
        said.last()
            .unwrap()
            .starts_with("a: A static recording: 90"),
        "{said:?}"
    );
}

/// Two axes of three recordings, of which the last differs.
fn pool() -> Pool {
    let share = |k: f64| RecordShare {
        constant: (k * DEG).into(),
        white: (1.0 + k).into(),
        slow: (2.0 + k).into(),
        p_value: (0.1 * k).into(),
        outliers: 10 * k as u64,
        ..RecordShare::default()
    };
    let differs = Differing {
        record: "c".into(),
        white: 2.0.into(),
        slow: 3.0.into(),
        outliers: (-1.0).into(),
        ..Differing::default()
    };
    let turn_on = TurnOn {
        records: 3,
        degrees_of_freedom: 2,
        sigma: DEG.into(),
        low: (0.5 * DEG).into(),
        high: (4.0 * DEG).into(),
        common: (-0.25 * DEG).into(),
        within: (7.0 * DEG).into(),
        for_filter: (5.0 * DEG).into(),
    };
    let axis = AxisPool {
        turn_on: Some(turn_on),
        records: [1.0, 2.0, 3.0].map(share).into(),
        differing: vec![differs],
        ..AxisPool::default()
    };
    let record = |name: &str| PooledRecord {
        record: name.into(),
        samples: 1,
    };
    Pool {
        records: ["a", "b", "c"].map(record).into(),
        false_alarm: 0.01.into(),
        axes: [("gyro_x".to_owned(), axis)].into(),
        ..Pool::default()
    }
}

#[test]
fn turn_on_constants_are_in_the_units_of_a_sensor() {
    let mut pool = pool();
    let mut accel = pool.axes["gyro_x"].clone();
    let g = undrift_nav::earth::STANDARD_GRAVITY;
    if let Some(turn_on) = &mut accel.turn_on {
        turn_on.sigma = (2e-3 * g).into();
    }
    accel.records[0].constant = (5e-3 * g).into();
    pool.axes.insert("accel_z".into(), accel);
    let table = pool::turn_on("a", &pool);
    let rows = cells(&table);
    assert_eq!(
        rows[0],
        [
            "a: gyro x",
            "°/s",
            "1.00",
            "0.500",
            "4.00",
            "2",
            "-0.250",
            "5.00"
        ]
    );
    assert_eq!(rows[1][..3], ["a: accelerometer z", "mg", "2.00"]);
    let table = pool::records("", &pool);
    assert_eq!(table.rows.len(), 6);
    let rows = cells(&table);
    assert_eq!(
        rows[0],
        ["gyro x", "a", "2.00", "3.00", "0.100", "1.00 °/s", "10"]
    );
    assert_eq!(
        rows[2],
        ["gyro x", "c", "4.00", "5.00", "0.300", "3.00 °/s", "30"]
    );
    assert_eq!(rows[3][5], "5.00 mg");
    // The one that differs is marked.
    assert_eq!(strong(&table), [(2, 1), (5, 1)]);
}

#[test]
fn recordings_that_differ_are_listed_with_how() {
    let mut pool = pool();
    assert_eq!(
        pool::not_one(&pool).as_deref(),
        Some(
            "Not one sensor: c (gyro x white noise 2.00 times, slow part 3.00 times, outliers only there) differs from the others."
        )
    );
    // On a second axis, and another recording.
    let mut accel = pool.axes["gyro_x"].clone();
    accel.differing[0].slow = f64::NAN.into();
    accel.differing[0].outliers = 4.0.into();
    accel.differing.push(Differing {
        record: "a".into(),
        slow: 0.5.into(),
        ..Differing::default()
    });
    pool.axes.insert("accel_x".into(), accel);
    assert_eq!(
        pool::not_one(&pool).as_deref(),
        Some(
            "Not one sensor: c (gyro x white noise 2.00 times, slow part 3.00 times, outliers only there; accelerometer x white noise 2.00 times, outliers 4.00 times), a (accelerometer x slow part 0.500 times) differ from the others."
        )
    );
    // Of two either may be the unusual one.
    pool.records.pop();
    pool.axes.remove("accel_x");
    pool.axes.get_mut("gyro_x").unwrap().differing[0].other = Some("a".into());
    assert_eq!(
        pool::not_one(&pool).as_deref(),
        Some(
            "Not one sensor: c (gyro x white noise 2.00 times, slow part 3.00 times, outliers only there of a) differs."
        )
    );
    pool.axes.get_mut("gyro_x").unwrap().differing.clear();
    assert_eq!(pool::not_one(&pool), None);
}

#[test]
fn what_bounds_the_constants_is_said() {
    let mut pool = pool();
    let few = "3 switch-ons bound the turn-on σ poorly";
    let said = pool::of_constants(&pool);
    assert!(said.len() == 1 && said[0].starts_with(few), "{said:?}");
    pool.axes.insert("accel_x".into(), AxisPool::default());
    let said = pool::of_constants(&pool);
    assert!(
        said.len() == 2 && said[0].contains("cannot be distinguished from a tilt"),
        "{said:?}"
    );
    pool.moved = Some(true);
    pool.tilt = (2.0 * DEG).into();
    let said = pool::of_constants(&pool);
    assert!(
        said[0].ends_with("laid down differently, by up to 2.00°."),
        "{said:?}"
    );
    pool.moved = Some(false);
    if let Some(turn_on) = &mut pool.axes.get_mut("gyro_x").unwrap().turn_on {
        turn_on.records = 4;
    }
    assert!(pool::of_constants(&pool).is_empty());
}

#[test]
fn several_recordings_have_their_blocks_in_the_report() {
    let mut run = identify(&[("gyro_x", gyro(1.0))]);
    assert!(pool::of_runs(&[(String::new(), &run)]).is_empty());
    run.pool = Some(pool());
    let sections = sections(&[(String::new(), &run)]);
    assert_eq!(
        names(&sections[0]),
        ["turn-on", "records", "models", "tests"]
    );
    let said = sentences(&sections[0]);
    let what = "One model of 3 recordings: a, b, c. ";
    let what = said.iter().find(|text| text.starts_with(what));
    assert!(
        what.unwrap()
            .ends_with("with a probability of 1.00 % in all."),
        "{said:?}"
    );
    assert!(
        said.iter()
            .any(|text| text.starts_with("Not one sensor: c")),
        "{said:?}"
    );
}

#[test]
fn a_recording_serves_as_far_as_its_axes_and_its_length_do() {
    let mut run = identify(&[("gyro_x", gyro(1.0)), ("gyro_y", gyro(1.0))]);
    assert_eq!(verdict(&run), "Usable: 2 axes, 15 min at 100 Hz.");
    assert!(is_usable(&run));
    // The longest horizon of the first axis, in seconds.
    let scores = &mut run.axes.get_mut("gyro_x").unwrap().chosen.drift_score;
    scores.remove("100");
    assert_eq!(
        verdict(&run),
        "Usable: 2 axes, 15 min at 100 Hz. It is too short to judge drifts beyond 30 s."
    );
    scores_of(&mut run).insert("60".into(), 1.0.into());
    assert_eq!(verdict(&run), "Usable: 2 axes, 15 min at 100 Hz.");
    run.axes.get_mut("gyro_y").unwrap().moving = Some(true);
    assert_eq!(
        verdict(&run),
        "Usable with care: gyro y: the recording is not static (2 axes, 15 min at 100 Hz)."
    );
    assert!(!is_usable(&run));
    run.axes.get_mut("gyro_y").unwrap().error = Some("too short".into());
    assert_eq!(
        verdict(&run),
        "Usable with care: gyro y: too short (1 of 2 axes, 15 min at 100 Hz)."
    );
    run.axes.remove("gyro_x");
    assert_eq!(verdict(&run), "Not usable: gyro y: too short.");
    // Recordings of different sensors are no model of one.
    let mut run = identify(&[("gyro_x", gyro(1.0))]);
    run.pool = Some(pool());
    assert_eq!(
        verdict(&run),
        "Usable: 1 axis, 15 min in 3 recordings at 100 Hz."
    );
    assert!(!is_usable(&run));
    run.pool.as_mut().unwrap().homogeneous = true;
    assert!(is_usable(&run));
}

fn scores_of(run: &mut Identify) -> &mut undrift_results::Numbers {
    &mut run.axes.get_mut("gyro_x").unwrap().chosen.drift_score
}

#[test]
fn units_of_data_sheets_are_those_of_the_si_by_definition() {
    let (gyro, accel) = (units("gyro_y"), units("accel_y"));
    let g = 9.80665;
    let cases = [
        (gyro.white, "°/√h", 1.0 / 60.0 * DEG),
        (gyro.bias, "°/h", 1.0 / 3600.0 * DEG),
        (gyro.walk, "°/h/√h", 1.0 / 3600.0 / 60.0 * DEG),
        (gyro.rounding, "arcsec", 1.0 / 3600.0 * DEG),
        (gyro.constant, "°/s", DEG),
        ((gyro.sample, gyro.scale), "°/s", DEG),
        ((gyro.drift, gyro.scale), "°", DEG),
        (accel.white, "m/s/√h", 1.0 / 60.0),
        (accel.bias, "mg", 1e-3 * g),
        (accel.walk, "mg/√h", 1e-3 * g / 60.0),
        (accel.rounding, "mm/s", 1e-3),
        (accel.constant, "mg", 1e-3 * g),
        ((accel.sample, accel.scale), "m/s²", 1.0),
        ((accel.drift, accel.scale), "m/s", 1.0),
    ];
    for ((unit, factor), name, si) in cases {
        assert_eq!(unit, name);
        assert!(near(factor * si, 1.0), "{name}: {factor}");
        assert_eq!(with_unit(2.0 * si, (unit, factor)), format!("2.00 {name}"));
    }
}
