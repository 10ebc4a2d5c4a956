use super::*;
use crate::{
    figure::panel::Drawn,
    tests::{
        assert_points, by_name, cells, figure, figure_of, legend, names, numbers, sentences, strong,
    },
};
use undrift_results::{Cut, Drift};

fn of(value: f64, low: f64, high: f64) -> Estimate {
    Estimate {
        value: value.into(),
        interval: [low.into(), high.into()],
    }
}

/// Errors of a model: `k` metres, so many times less than white noise, and more than the least.
fn pooled(k: f64, less: Estimate, over: Estimate) -> PooledErrors {
    PooledErrors {
        rms: by_name(&[("north_m", k), ("yaw_deg", 10.0 * k)]),
        horizontal_m: of(k, 0.9 * k, 1.1 * k),
        less_than_white: less,
        over_least: over,
        largest_m: numbers(&[k, 2.0 * k, 3.0 * k, 4.0 * k, 5.0 * k]),
        drift: Drift {
            since_cut_s: numbers(&[1.0, 2.0]),
            horizontal_rms_m: numbers(&[k, 4.0 * k]),
        },
        ..PooledErrors::default()
    }
}

/// Outages of 10 and 30 s. The recommended model is the best, in 10 s with the data sheet's within chance.
fn demo() -> Demo {
    let model = |name: &str| DemoModel {
        name: name.into(),
        bound: name == BOUND,
        ..DemoModel::default()
    };
    let length = |length: f64, near: Estimate| CutLength {
        length_s: length.into(),
        cuts: 45,
        models: [
            (WHITE, pooled(6.0, of(1.0, 1.0, 1.0), of(3.0, 2.0, 4.0))),
            (
                PAPER,
                pooled(60.0, of(0.1, 0.05, 0.2), of(30.0, 20.0, 40.0)),
            ),
            ("data sheet", pooled(2.5, of(2.4, 2.0, 3.0), near)),
            (
                RECOMMENDED,
                pooled(2.0, of(3.0, 2.5, 3.5), of(1.0, 1.0, 1.0)),
            ),
            (BOUND, pooled(1.0, of(6.0, 5.0, 7.0), of(0.5, 0.4, 1.2))),
        ]
        .map(|(name, errors)| (name.to_owned(), errors))
        .into(),
    };
    Demo {
        seed: 7,
        drives: 3,
        models: [WHITE, PAPER, "data sheet", RECOMMENDED, BOUND]
            .map(model)
            .into(),
        lengths: vec![
            length(10.0, of(1.1, 0.95, 1.25)),
            length(30.0, of(1.2, 1.1, 1.3)),
        ],
        cuts: vec![Cut {
            start_s: 200.0.into(),
            length_s: 10.0.into(),
        }],
        conclusion: "It drifts less.".into(),
        ..Demo::default()
    }
}

#[test]
fn the_drift_of_each_model_stands_beside_how_much_less_it_is() {
    let demo = demo();
    let table = drifts(&demo, &demo.lengths[0]);
    assert_eq!(table.name, "drift-10");
    assert_eq!(
        table.caption,
        format!("Outages of 10 s, 45 in all. {CAPTION}")
    );
    assert_eq!(
        cells(&table),
        [
            ["white", "6.00 (5.40 to 6.60)", "", ""],
            [
                "paper literal",
                "60.0 (54.0 to 66.0)",
                "0.100 (0.0500 to 0.200)",
                ""
            ],
            [
                "data sheet",
                "2.50 (2.25 to 2.75)",
                "2.40 (2.00 to 3.00)",
                "≈"
            ],
            [
                "recommended",
                "2.00 (1.80 to 2.20)",
                "3.00 (2.50 to 3.50)",
                "≈"
            ],
        ]
    );
    // Two are within chance of the least: none is marked.
    assert_eq!(strong(&table), []);
    let longer = drifts(&demo, &demo.lengths[1]);
    assert_eq!(longer.caption, "Outages of 30 s, 45 in all. As above.");
    assert_eq!(strong(&longer), [(3, 1)]);
    assert_eq!(longer.rows[2][3].text, "");
}

#[test]
fn a_bound_is_no_model_to_choose() {
    let mut demo = demo();
    let table = bounds(&demo);
    assert_eq!(table.head, ["model", "10 s: drift [m]", "30 s: drift [m]"]);
    assert_eq!(
        cells(&table),
        [["bound", "1.00 (0.900 to 1.10)", "1.00 (0.900 to 1.10)"]]
    );
    demo.lengths[1].models.remove(BOUND);
    assert_eq!(cells(&bounds(&demo))[0][2], "–");
}

#[test]
fn an_estimate_that_is_missing_is_a_dash() {
    assert_eq!(estimate(of(1.9, 1.62, 2.2)), "1.90 (1.62 to 2.20)");
    assert_eq!(estimate(of(f64::NAN, 1.0, 2.0)), "–");
}

#[test]
fn the_conclusion_compares_with_white_noise_by_length() {
    let mut demo = demo();
    let less = |demo: &mut Demo, at: usize, estimate| {
        let models = &mut demo.lengths[at].models;
        models.get_mut(RECOMMENDED).unwrap().less_than_white = estimate;
    };
    let rest = ": 3 drives, with noise as real recordings have it, both on samples less their mean error over 60 s of rest.";
    let start = "Without GNSS the recommended noise model drifts, compared with white noise, ";
    assert_eq!(
        conclusion(&demo),
        format!(
            "{start}3.00 times less in 10 s (95 %: 2.50 to 3.50) and 3.00 times less in 30 s (95 %: 2.50 to 3.50){rest}"
        )
    );
    less(&mut demo, 0, of(1.1, 0.9, 1.3));
    less(&mut demo, 1, of(0.5, 0.4, 0.6));
    assert_eq!(
        conclusion(&demo),
        format!(
            "{start}as far in 10 s (1.10 times less, 95 %: 0.900 to 1.30) and farther in 30 s (0.500 times less, 95 %: 0.400 to 0.600){rest}"
        )
    );
    demo.recorded = true;
    demo.drives = 1;
    let recorded = conclusion(&demo);
    assert!(
        recorded.contains(": 1 drive, with the noise of a real recording, both"),
        "{recorded}"
    );
}

#[test]
fn what_is_within_chance_of_the_least_is_said() {
    let mut demo = demo();
    demo.models[2].without = vec!["gyro_x".into(), "accel_z".into()];
    let models = &mut demo.lengths[1].models;
    models.get_mut("data sheet").unwrap().failed = Some("too few samples".into());
    assert_eq!(
        not_better(&demo),
        [
            "Not better than others: within chance of the least drift are, beside the recommended model, in 10 s: data sheet; in 30 s: none.",
            "White noise alone where the method has no model: data sheet (gyro x, accelerometer z).",
            "data sheet could not be run: too few samples.",
        ]
    );
    // The recommended model may be beyond chance itself.
    let models = &mut demo.lengths[1].models;
    models.get_mut(RECOMMENDED).unwrap().over_least = of(1.5, 1.2, 1.9);
    assert!(not_better(&demo)[0].ends_with(
        "; in 30 s: the recommended model itself is not, it drifts 1.50 (1.20 to 1.90) times the least."
    ));
}

#[test]
fn the_drift_is_drawn_of_all_but_the_literal_equations() {
    let demo = demo();
    let figure = figure(curves(&demo, &demo.lengths[1]));
    assert_eq!(
        figure.caption,
        "Horizontal error since the cut, RMS over the 45 outages of 30 s; the bound, no model to choose, in grey. Not drawn: the source paper's equations to the letter, 60.0 m."
    );
    let panel = &figure.panels[0];
    assert_eq!(
        legend(panel),
        ["white", "other methods", "recommended", "bound"]
    );
    for (series, (k, drawn)) in panel.series.iter().zip([
        (6.0, Drawn::Line),
        (2.5, Drawn::Thin),
        (2.0, Drawn::Thick),
        (1.0, Drawn::Dashed),
    ]) {
        assert_eq!(series.drawn, drawn, "{}", series.name);
        assert_points(series, &[(1.0, k), (2.0, 4.0 * k)]);
    }
}

#[test]
fn the_largest_errors_of_the_models_to_choose_are_boxes() {
    let demo = demo();
    let figure = figure(spread(&demo, &demo.lengths[0]));
    let panel = &figure.panels[0];
    assert_eq!(panel.x.names, [WHITE, "data sheet", RECOMMENDED]);
    let series = &panel.series[0];
    assert_eq!(series.x, [0.0, 1.0, 2.0]);
    for (level, share) in series.y.iter().zip([1.0, 2.0, 3.0, 4.0, 5.0]) {
        assert_eq!(*level, [6.0 * share, 2.5 * share, 2.0 * share]);
    }
}

#[test]
fn the_report_begins_with_the_conclusion_and_ends_with_the_recording() {
    let mut demo = demo();
    demo.identification.record = "rest.csv".into();
    demo.track.time_s = numbers(&[199.0, 205.0]);
    demo.track.lat_deg = numbers(&[0.0; 2]);
    demo.track.lon_deg = numbers(&[0.0, 1e-3]);
    let sections = sections(&[("d".to_owned(), &demo)]);
    let titles: Vec<&str> = sections.iter().map(|section| &*section.title).collect();
    assert_eq!(
        titles[..3],
        [
            "d: How much less drift",
            "d: Drift without GNSS",
            "d: Errors inside the outages"
        ]
    );
    assert_eq!(
        names(&sections[0]),
        ["drift-10", "drift-30", "bound", "rows"]
    );
    let said = sentences(&sections[0]);
    assert_eq!(said[0], "It drifts less.");
    assert!(
        said[2].contains("three real recordings of an ADIS16405")
            && said[2].contains("3 drives of 15 min with fixes of centimetres at 5 Hz, seed 7,"),
        "{said:?}"
    );
    // What each model of the demo is, and no other.
    let Some(Block::Table(about)) = sections[0].blocks.last() else {
        panic!("no table");
    };
    let rows: Vec<&str> = about.rows.iter().map(|row| &*row[0].text).collect();
    assert_eq!(rows, [WHITE, PAPER, "data sheet", RECOMMENDED, BOUND]);
    // A simulated drive was nowhere; the longest outages are drawn.
    assert_eq!(names(&sections[1]), ["trajectory", "drift", "spread"]);
    assert_eq!(figure_of(&sections, "trajectory").panels[0].origin, None);
    assert!(
        figure_of(&sections, "drift")
            .caption
            .contains("outages of 30 s")
    );
    let Block::Table(errors) = &sections[2].blocks[1] else {
        panic!("no table");
    };
    assert_eq!(errors.name, "errors-30");
    assert_eq!(
        errors.caption,
        "Outages of 30 s: RMS over all 45 of the largest error of each."
    );
    let rows = cells(errors);
    assert_eq!(rows[0][..3], [WHITE, "6.00", "–"]);
    assert_eq!(rows[0][10], "60.0");
    demo.recorded = true;
    let recorded = super::sections(&[(String::new(), &demo)]);
    assert!(
        sentences(&recorded[0])[2]
            .starts_with("The sensor's errors are stretches of a real static recording")
    );
}

#[test]
fn a_terminal_has_a_table_for_each_length_and_the_bounds() {
    let mut demo = demo();
    let text = plain(&demo, crate::plain::unmarked);
    assert!(
        text.starts_with(&format!(
            "It drifts less.\n\n{CAPTION}\n\n10 s, 45 outages "
        )),
        "{text}"
    );
    assert!(
        text.contains("\n30 s, 45 outages ") && text.contains(&format!("\n{BOUNDS}\nmodel")),
        "{text}"
    );
    assert!(text.ends_with("in 30 s: none."), "{text}");
    for model in &mut demo.models {
        model.bound = false;
    }
    assert!(!plain(&demo, crate::plain::unmarked).contains(BOUNDS));
}
