use super::*;
use crate::{
    figure::panel::Drawn,
    tests::{assert_points, by_name, cells, figure, legend, names, points, strong},
};
use undrift_results::Bin;
use undrift_results::{Effect, FleetEffects, FleetLabel, LeftOut};

fn log(name: &str, temperature: f64, arma: f64, white: f64) -> Log {
    Log {
        log: name.into(),
        temperature_c: temperature.into(),
        values: [(
            "drift".to_owned(),
            by_name(&[("arma", arma), ("white", white)]),
        )]
        .into(),
        ..Log::default()
    }
}

fn part(name: &str, logs: u64, median: f64) -> Part {
    Part {
        part: name.into(),
        logs,
        median: median.into(),
        level: Some(Level {
            value: (2.0 * median).into(),
            low: median.into(),
            high: (4.0 * median).into(),
        }),
        temperature: vec![
            Bin {
                from_c: 10.0.into(),
                to_c: 20.0.into(),
                logs,
                median: median.into(),
            },
            Bin {
                from_c: 20.0.into(),
                to_c: 30.0.into(),
                logs,
                median: (3.0 * median).into(),
            },
        ],
    }
}

fn effect(times: f64, found: bool) -> Option<Effect> {
    Some(Effect {
        times: times.into(),
        low: (0.5 * times).into(),
        high: (2.0 * times).into(),
        p: 0.002.into(),
        found,
        ..Effect::default()
    })
}

/// The drift of two bias models on four logs, one without a temperature, one without a value of "white".
fn fleet() -> (Fleet, Measure) {
    let run = Fleet {
        logs: vec![
            log("a", 12.0, 1.0, 10.0),
            log("b", f64::NAN, 2.0, 20.0),
            log("c", 25.0, 3.0, f64::NAN),
            log("d", 28.0, 4.0, 50.0),
        ],
        ..Fleet::default()
    };
    let measure = Measure {
        name: "drift".into(),
        what: "RMS drift in outages of 30 s, horizontal".into(),
        unit: "m".into(),
        parts: vec![part("arma", 4, 2.5), part("white", 3, 20.0)],
        best: [("arma".to_owned(), 3), ("white".to_owned(), 1)].into(),
        ..Measure::default()
    };
    (run, measure)
}

#[test]
fn what_the_numbers_say_is_of_the_least_median() {
    let (_, mut measure) = fleet();
    assert_eq!(
        findings(&measure, true),
        [
            "RMS drift in outages of 30 s, median over the logs: arma 2.50 m, white 20.0 m.",
            "arma has the least and is best on 3 of the 4 logs run with all models."
        ]
    );
    // Of one model there is no best, nor of axes.
    let mut single = measure.clone();
    single.parts.pop();
    assert_eq!(findings(&single, true).len(), 1);
    measure.name = "white_noise".into();
    measure.unit.clear();
    assert_eq!(
        findings(&measure, true),
        ["RMS drift in outages of 30 s, median over the logs: arma 2.50, white 20.0."]
    );
    // The answers of later measures come first.
    measure.effects = Some(FleetEffects::default());
    measure.by_unit = vec![group("u", 1, 1.0, effect(1.0, false))];
    assert_eq!(findings(&measure, true).len(), 1);
    assert_eq!(
        findings(&measure, false)[0],
        "None of 1 unit stands out in white noise."
    );
}

fn outlier(name: &str, times: f64) -> Outlier {
    Outlier {
        log: name.into(),
        unit: Some("u".into()),
        report: Some(format!("{name}.html")),
        temperature_c: 21.25.into(),
        effect: effect(times, true).unwrap(),
    }
}

#[test]
fn logs_that_stand_out_are_named_and_listed() {
    let (_, mut measure) = fleet();
    assert_eq!(of_outliers(&measure), None);
    measure.outliers = vec![outlier("c", 3.0)];
    assert_eq!(
        of_outliers(&measure).unwrap(),
        "1 log stands out of the rest: c (3.00 (1.50 to 6.00))."
    );
    measure.outliers.push(outlier("d", 0.5));
    assert_eq!(
        of_outliers(&measure).unwrap(),
        "2 logs stand out of the rest: c (3.00 (1.50 to 6.00)), d (0.500 (0.250 to 1.00))."
    );
    measure.task = "outages".into();
    let Some(Block::Table(table)) = outliers(&measure) else {
        panic!("no table");
    };
    assert!(
        table
            .caption
            .ends_with("A log's own report: undrift outages LOG --report FILE.html.")
    );
    assert_eq!(
        cells(&table)[1],
        ["d", "u", "21.2", "0.500 (0.250 to 1.00)", "0.00200"]
    );
    assert_eq!(table.rows[1][0].link.as_deref(), Some("d.html"));
    measure.outliers = vec![outlier("c", 3.0); ROWS + 1];
    let Some(Block::Table(table)) = outliers(&measure) else {
        panic!("no table");
    };
    assert_eq!(table.rows.len(), ROWS);
    assert!(
        table.caption.ends_with("The first 200 of 201."),
        "{}",
        table.caption
    );
}

#[test]
fn the_parts_stand_side_by_side_with_their_quantiles() {
    let (run, mut measure) = fleet();
    let table = overview(&run, &measure);
    assert_eq!(
        table.head,
        [
            "model",
            "logs",
            "median [m]",
            "90 % [m]",
            "largest [m]",
            "level [m]",
            "best on"
        ]
    );
    // 90 % of 1, 2, 3, 4 is three tenths below the last; of 10, 20, 50 six.
    assert_eq!(
        cells(&table),
        [
            [
                "arma",
                "4",
                "2.50",
                "3.70",
                "4.00",
                "5.00 (2.50 to 10.0)",
                "3"
            ],
            [
                "white",
                "3",
                "20.0",
                "44.0",
                "50.0",
                "40.0 (20.0 to 80.0)",
                "1"
            ],
        ]
    );
    assert_eq!(strong(&table), [(0, 2)]);
    assert_eq!(
        table.caption,
        "The RMS drift in outages of 30 s, horizontal. Level: geometric mean over units with its 95 % interval."
    );
    // Axes are not rivals.
    measure.name = "white_noise".into();
    measure.parts[0].level = None;
    let table = overview(&run, &measure);
    assert_eq!((&*table.head[0], table.head.len()), ("of", 6));
    assert_eq!(table.rows[0][5].text, "–");
    assert_eq!(strong(&table), []);
}

#[test]
fn the_logs_of_a_part_are_a_box() {
    let (run, measure) = fleet();
    let figure = figure(spread(&run, &measure));
    let panel = &figure.panels[0];
    assert_eq!(panel.x.names, ["arma", "white"]);
    // From 1 to 50 is more than a decade and a half.
    assert!(panel.y.logarithmic);
    assert_eq!(panel.y.label, "drift [m]");
    let boxes = [
        (0.0, [1.0, 1.75, 2.5, 3.25, 4.0]),
        (1.0, [10.0, 15.0, 20.0, 35.0, 50.0]),
    ];
    for (series, (x, levels)) in panel.series.iter().zip(boxes) {
        assert_eq!((series.drawn, &series.x[..]), (Drawn::Boxes, &[x][..]));
        assert_eq!(series.y.concat(), levels);
    }
}

#[test]
fn each_log_is_drawn_at_its_temperature() {
    let (run, mut measure) = fleet();
    let figure = figure(temperature(&run, &measure));
    assert!(
        figure
            .caption
            .starts_with("Each log at its temperature (dots)")
    );
    let [panel] = &figure.panels[..] else {
        panic!("{}", figure.panels.len());
    };
    assert_eq!(legend(panel), ["", "arma", "", "white"]);
    let colours: Vec<usize> = panel.series.iter().map(|series| series.colour).collect();
    let (arma, white) = (model_colour("arma", 0), model_colour("white", 1));
    assert_eq!(colours, [arma, arma, white, white]);
    assert_points(&panel.series[0], &[(12.0, 1.0), (25.0, 3.0), (28.0, 4.0)]);
    // The medians of bins in their middles.
    assert_points(&panel.series[1], &[(15.0, 2.5), (25.0, 7.5)]);
    assert_points(&panel.series[2], &[(12.0, 10.0), (28.0, 50.0)]);
    assert_points(&panel.series[3], &[(15.0, 20.0), (25.0, 60.0)]);
    assert_eq!(panel.x.label, "temperature [°C]");
    // A part without a temperature is not drawn; without any there is no figure.
    measure.parts[1].part = "other".into();
    let with = crate::tests::figure(temperature(&run, &measure));
    assert_eq!(legend(&with.panels[0]), ["", "arma"]);
    measure.parts.remove(0);
    assert!(temperature(&run, &measure).is_none());
}

#[test]
fn beyond_a_thousand_logs_density_is_drawn() {
    let (mut run, measure) = fleet();
    let many = |logs: usize| -> Vec<Log> {
        let each = (0..logs).map(|k| {
            let k = k as f64;
            log("x", 10.0 + 0.01 * k, 1.0 + 0.001 * k, f64::NAN)
        });
        each.collect()
    };
    run.logs = many(DOTS);
    let single = figure(temperature(&run, &measure));
    assert_eq!(single.panels[0].series[0].drawn, Drawn::Dots);
    assert_eq!(single.panels[0].series[0].x.len(), DOTS);
    run.logs = many(DOTS + 1);
    let shaded = crate::tests::figure(temperature(&run, &measure));
    assert!(
        shaded
            .caption
            .starts_with("The logs at their temperatures: the darker")
    );
    // A panel for each part.
    assert_eq!((shaded.panels.len(), &*shaded.panels[0].title), (1, "arma"));
    let series = &shaded.panels[0].series;
    assert!(series.iter().any(|series| series.drawn == Drawn::Band));
    let last = series.last().unwrap();
    assert_eq!((&*last.name, last.drawn), ("median", Drawn::Thick));
    assert_points(last, &[(15.0, 2.5), (25.0, 7.5)]);
}

fn group(name: &str, logs: u64, arma: f64, effect: Option<Effect>) -> Group {
    Group {
        name: name.into(),
        logs,
        median: by_name(&[("arma", arma), ("white", 10.0 * arma)]),
        effect,
    }
}

#[test]
fn groups_that_stand_out_come_first_then_the_largest() {
    let (_, measure) = fleet();
    let all = [
        group("small", 1, 1.0, None),
        group("large", 2, 9.0, effect(3.0, false)),
        group("found", 3, 2.0, effect(0.25, true)),
        group("middle", 4, 4.0, None),
    ];
    let blocks = groups(&measure, "unit", &all);
    let [Block::Figure(figure), Block::Table(table)] = &blocks[..] else {
        panic!("{blocks:?}");
    };
    assert_eq!(
        (&*figure.name, &*table.name),
        ("drift-by-units", "drift-by-unit")
    );
    assert!(table.caption.contains("sorted by arma, largest first"));
    assert_eq!(
        table.head,
        [
            "unit",
            "logs",
            "times the others (95 %)",
            "p",
            "arma [m]",
            "white [m]"
        ]
    );
    assert_eq!(
        cells(table),
        [
            [
                "found",
                "3",
                "0.250 (0.125 to 0.500)",
                "0.00200",
                "2.00",
                "20.0"
            ],
            [
                "large",
                "2",
                "3.00 (1.50 to 6.00)",
                "0.00200",
                "9.00",
                "90.0"
            ],
            ["middle", "4", "–", "–", "4.00", "40.0"],
            ["small", "1", "–", "–", "1.00", "10.0"],
        ]
    );
    assert_eq!(strong(table), [(0, 2)]);
    let panel = &figure.panels[0];
    assert_eq!(panel.x.names, ["found", "large", "middle", "small"]);
    assert_eq!(legend(panel), ["arma", "white"]);
    assert_points(
        &panel.series[0],
        &[(0.0, 2.0), (1.0, 9.0), (2.0, 4.0), (3.0, 1.0)],
    );
    assert_points(
        &panel.series[1],
        &[(0.0, 20.0), (1.0, 90.0), (2.0, 40.0), (3.0, 10.0)],
    );
    assert!(groups(&measure, "unit", &[]).is_empty());
}

#[test]
fn of_many_groups_every_few_are_drawn_without_their_names() {
    let (_, measure) = fleet();
    let many = |n: u32| -> Vec<Group> {
        (0..n)
            .map(|k| group("u", 1, f64::from(n - k), None))
            .collect()
    };
    let panel = |n: u32| {
        let blocks = groups(&measure, "unit", &many(n));
        match &blocks[0] {
            Block::Figure(figure) => figure.panels[0].clone(),
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(panel(NAMED as u32).x.names.len(), NAMED);
    let without = panel(NAMED as u32 + 1);
    assert!(without.x.names.is_empty());
    assert_eq!(without.x.label, "units, the largest of arma first");
    assert_eq!(
        points(&panel(1000).series[0])[..2],
        [(0.0, 1000.0), (1.0, 999.0)]
    );
    // Of 2500 every third.
    let few = panel(2500);
    assert_eq!(
        points(&few.series[0])[..3],
        [(0.0, 2500.0), (3.0, 2497.0), (6.0, 2494.0)]
    );
    assert_eq!(few.series[0].x.len(), 834);
}

#[test]
fn a_measure_has_its_blocks_in_order() {
    let (run, mut measure) = fleet();
    measure.outliers = vec![outlier("c", 3.0)];
    measure.by_unit = vec![group("u", 1, 1.0, None)];
    measure.by_sensor = vec![group("s", 1, 1.0, None)];
    let label = |name: &str, left_out, by_value| FleetLabel {
        label: name.into(),
        left_out,
        by_value,
    };
    measure.by_label = vec![
        label("firmware", None, vec![group("v1", 1, 1.0, None)]),
        label("place", Some(LeftOut::Unique), Vec::new()),
    ];
    let section = section(&run, &measure).unwrap();
    assert_eq!(section.title, "Drift");
    // A single sensor is not compared.
    assert_eq!(
        names(&section),
        [
            "drift",
            "drift-spread",
            "drift-outliers",
            "drift-temperature",
            "drift-by-units",
            "drift-by-unit",
            "drift-by-firmwares",
            "drift-by-firmware"
        ]
    );
    assert_eq!(
        crate::tests::sentences(&section),
        ["Labels not compared: place (different in each log)."]
    );
    measure.by_sensor.push(group("t", 1, 1.0, None));
    let section = super::section(&run, &measure).unwrap();
    assert_eq!(
        names(&section)[6..8],
        ["drift-by-sensors", "drift-by-sensor"]
    );
}
