use super::*;
use undrift_results::{Number, OutageErrors};

#[test]
fn the_least_stands_out() {
    let errors = |e: f64| ModelErrors {
        rms: Numbers::from([(HORIZONTAL.to_owned(), Number(e))]),
        ..ModelErrors::default()
    };
    let (a, b) = (errors(2.0), errors(1.0));
    let model = |name: &str, errors| Model {
        name: name.into(),
        key: "",
        run: 0,
        errors,
        drift: Vec::new(),
        colour: 0,
        usable: true,
    };
    // Built in place: models borrow their errors.
    let models = [model("a", &a), model("b", &b)];
    let table = table_of("rms", "", &[&models[0], &models[1]], |m| &m.rms).unwrap();
    assert!(!table.rows[0][1].strong && table.rows[1][1].strong);
    assert!(findings(&models)[0].contains(": b with 1.00 m"));

    // Nothing is concluded from a run with the wrong axes.
    let models = models.map(|m| Model { usable: false, ..m });
    let table = table_of("rms", "", &[&models[0], &models[1]], |m| &m.rms).unwrap();
    assert!(table.rows.iter().flatten().all(|cell| !cell.strong));
    assert_eq!(
        findings(&models),
        ["No conclusion: the result is not usable."]
    );
}

/// The number of a statistic (1 to 4) of a component and a model: no two are equal.
fn number(statistic: usize, component: usize, model: usize) -> f64 {
    (1000 * statistic + 100 * model + 10 * component) as f64
}

const MAXIMUM: usize = 1;
const RMS: usize = 2;
const MEDIAN: usize = 3;
const AT_THE_END: usize = 4;

/// Two models, every number of which is another.
fn result() -> Outages {
    let numbers = |statistic: usize, model: usize| -> Numbers {
        let components = COMPONENTS.iter().enumerate();
        components
            .map(|(at, (key, _))| ((*key).to_owned(), number(statistic, at, model).into()))
            .collect()
    };
    let groups = ["position", "velocity", "attitude"];
    let errors = |model: usize| ModelErrors {
        max: numbers(MAXIMUM, model),
        rms: numbers(RMS, model),
        median: numbers(MEDIAN, model),
        end_rms: numbers(AT_THE_END, model),
        nees: (1..)
            .zip(groups)
            .map(|(at, group)| {
                (
                    group.to_owned(),
                    (f64::from(at) + 0.01 * model as f64).into(),
                )
            })
            .collect(),
        inside_sigma: (1..)
            .zip(groups)
            .map(|(at, group)| {
                let share = |sigmas: i32| {
                    Number(0.1 * f64::from(at) + 0.01 * f64::from(sigmas) + 1e-3 * model as f64)
                };
                (group.to_owned(), [1, 2, 3].map(share))
            })
            .collect(),
        per_outage: vec![OutageErrors {
            max: numbers(MAXIMUM, model),
            end: numbers(AT_THE_END, model),
            ..OutageErrors::default()
        }],
        ..ModelErrors::default()
    };
    let names = ["white", "arma"].map(String::from);
    Outages {
        models: names.iter().cloned().zip([errors(0), errors(1)]).collect(),
        order: names.into(),
        reference: "truth".into(),
        ..Outages::default()
    }
}

/// The cells of a statistic's row of a model.
fn row(statistic: usize, model: usize) -> Vec<String> {
    let name = ["white", "arma"][model].to_owned();
    let numbers = (0..COMPONENTS.len()).map(|at| number(statistic, at, model).to_string());
    [name].into_iter().chain(numbers).collect()
}

/// The cells of a model's row of the table of consistency.
fn covered(model: usize) -> Vec<String> {
    let mut cells = vec![["white", "arma"][model].to_owned()];
    for group in 1..=3 {
        for sigmas in 1..=3 {
            // Shares of 0.11, 0.12, 0.13 of the position, 0.21 … of the velocity, and 0.001 more of the second model.
            cells.push(format!("{}.{model}", 10 * group + sigmas));
        }
        cells.push(format!("{group}.0{model}"));
    }
    cells
}

#[test]
fn each_table_of_a_terminal_has_the_statistic_of_its_head() {
    let text = plain(&result(), crate::plain::unmarked);
    let (_, tables) = text.split_once("Errors inside the outages:\n\n").unwrap();
    let lines: Vec<&str> = tables.lines().collect();
    let words = |at: usize| {
        lines[at]
            .split_whitespace()
            .map(String::from)
            .collect::<Vec<_>>()
    };
    let heads = [("maximum", MAXIMUM), ("RMS", RMS), ("median", MEDIAN)];
    for (k, (head, statistic)) in heads.into_iter().enumerate() {
        // A head, two models, an empty line.
        let at = 4 * k;
        let columns = COMPONENTS
            .iter()
            .flat_map(|(_, head)| head.split_whitespace());
        assert_eq!(
            words(at),
            [head].into_iter().chain(columns).collect::<Vec<_>>()
        );
        assert_eq!(words(at + 1), row(statistic, 0));
        assert_eq!(words(at + 2), row(statistic, 1));
    }
    assert_eq!(lines[12], COVERED);
    let groups = ["position", "velocity", "attitude"];
    let head = groups
        .map(|group| format!("{group} 1σ  {group} 2σ  {group} 3σ  NEES"))
        .join("  ");
    assert_eq!(
        words(13),
        format!("model  {head}")
            .split_whitespace()
            .collect::<Vec<_>>()
    );
    assert_eq!(words(14), covered(0));
    assert_eq!(words(15), covered(1));
}

#[test]
fn each_table_of_a_report_has_the_statistic_of_its_name() {
    let result = result();
    let sections = sections(&[(String::new(), &result)]);
    let tables = sections.iter().flat_map(|section| &section.blocks);
    let tables = tables.filter_map(|block| match block {
        Block::Table(table) => Some(table),
        _ => None,
    });
    let tables: Vec<&Table> = tables.collect();
    let names: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "errors-rms",
            "errors-maximum",
            "errors-median",
            "errors-at-the-end",
            "consistency"
        ]
    );
    let statistics = [
        (RMS, "RMS over the outages of the largest error of each."),
        (MAXIMUM, "Largest error in any outage."),
        (
            MEDIAN,
            "Median over the outages of the largest error of each.",
        ),
        (AT_THE_END, "RMS over the outages of the error at the end."),
    ];
    let cells = |table: &Table, model: usize| {
        table.rows[model]
            .iter()
            .map(|cell| cell.text.clone())
            .collect::<Vec<_>>()
    };
    for (table, (statistic, caption)) in tables.iter().zip(statistics) {
        assert_eq!(table.caption, caption);
        assert_eq!(table.head[1..], COMPONENTS.map(|(_, head)| head));
        for model in [0, 1] {
            assert_eq!(cells(table, model), row(statistic, model), "{}", table.name);
        }
    }
    for model in [0, 1] {
        assert_eq!(cells(tables[4], model), covered(model));
    }
    // The sentences compare the RMS.
    let horizontal = COMPONENTS
        .iter()
        .position(|(key, _)| *key == HORIZONTAL)
        .unwrap();
    let least = format!("white with {} m", number(RMS, horizontal, 0));
    let said = sections[0].blocks.iter().any(|block| match block {
        Block::Text(text) => text.contains(&least),
        _ => false,
    });
    assert!(said, "{least}");
}

#[test]
fn a_drift_is_a_line_under_the_name_of_each_model_that_has_it() {
    let errors = ModelErrors::default();
    let model = |name: &str, run, colour, drift: &[(f64, f64)]| Model {
        name: name.into(),
        key: "arma",
        run,
        errors: &errors,
        drift: drift.to_vec(),
        colour,
        usable: true,
    };
    let grown = |k: f64| [(1.0, k), (2.0, 4.0 * k)];
    let models = [
        model("a", 0, 1, &grown(1.0)),
        model("b", 0, 2, &grown(1.5)),
        // Within a hundredth of the first.
        model("c", 1, 3, &grown(1.002)),
    ];
    let drawn: Vec<_> = models.iter().map(|m| (m, m.drift.clone())).collect();
    let lines = drift::lines(&drawn);
    let seen: Vec<_> = lines
        .iter()
        .map(|line| (line.name.as_str(), line.colour, &line.x[..], &line.y[0][..]))
        .collect();
    let expected: [(&str, usize, &[f64], &[f64]); 2] = [
        ("a = c", 3, &[1.0, 2.0], &[1.002, 4.008]),
        ("b", 2, &[1.0, 2.0], &[1.5, 6.0]),
    ];
    assert_eq!(seen, expected);
    // The line of another run is thin.
    assert_eq!(lines[0].drawn, crate::Series::thin("", 0, Vec::new()).drawn);
    assert_eq!(lines[1].drawn, crate::Series::line("", 0, Vec::new()).drawn);
}

#[test]
fn the_least_is_compared_with_the_next_and_the_most() {
    let errors = |rms: f64, largest: &[f64]| ModelErrors {
        rms: Numbers::from([(HORIZONTAL.to_owned(), Number(rms))]),
        per_outage: largest
            .iter()
            .map(|error| OutageErrors {
                max: Numbers::from([(HORIZONTAL.to_owned(), Number(*error))]),
                ..OutageErrors::default()
            })
            .collect(),
        ..ModelErrors::default()
    };
    let said = |all: &[(&str, &ModelErrors)]| {
        let models: Vec<Model<'_>> = all
            .iter()
            .map(|(name, errors)| Model {
                name: (*name).into(),
                key: "",
                run: 0,
                errors,
                drift: Vec::new(),
                colour: 0,
                usable: true,
            })
            .collect();
        findings(&models)
    };
    // Six of six, and one in which both are the same.
    let best = errors(2.0, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    let next = errors(3.0, &[1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.0]);
    let most = errors(8.0, &[9.0; 7]);
    assert_eq!(
        said(&[("far", &most), ("a, b", &best), ("next", &next)]),
        [
            "Least horizontal drift: \"a, b\" with 2.00 m (RMS over the outages of the largest error of each).",
            "Next is next with 3.00 m; \"a, b\" drifted less in 6 of 6 outages, more than expected by chance.",
            "Most: far with 8.00 m, 4.00 times the least.",
        ]
    );
    // Four of six are chance. Of two there is no most.
    let close = errors(2.1, &[0.5, 1.5, 3.5, 4.5, 5.5, 6.5, 7.0]);
    assert_eq!(
        said(&[("a", &best), ("b", &close)])[1..],
        [
            "Next is b with 2.10 m; a drifted less in 4 of 6 outages, no more than expected by chance."
        ]
    );
    // Within a hundredth they are equal.
    let equal = errors(2.02, &[1.0; 7]);
    assert_eq!(
        said(&[("a", &best), ("b", &equal)]),
        [
            "Least horizontal drift: a and b, equal within 1 %, with 2.00 m (RMS over the outages of the largest error of each)."
        ]
    );
    assert_eq!(
        said(&[("a", &best)]),
        ["Horizontal drift: a has 2.00 m (RMS over the outages of the largest error of each)."]
    );
    let none = errors(f64::NAN, &[]);
    assert_eq!(
        said(&[("a", &none)]),
        ["No model has an error inside every outage."]
    );
    assert_eq!(said(&[("a", &none), ("b", &best)]).len(), 1);
}

#[test]
fn what_was_done_names_the_drive_the_outages_and_the_reference() {
    use undrift_results::{Cut, Start};
    let cut = |start: f64, length: f64| Cut {
        start_s: start.into(),
        length_s: length.into(),
    };
    let mut run = result();
    run.outages = vec![cut(300.0, 30.0), cut(400.0, 30.04)];
    assert_eq!(
        what_was_done("", &run),
        "On the drive, GNSS was cut 2 times for 30 s. During the outages the solution, of what came before each instant only, was compared with the truth."
    );
    run.look_ahead = true;
    let ahead = "the solution, which knew the errors of all fixes from the start, was compared";
    assert!(what_was_done("", &run).contains(ahead));
    run.drive.imu = Some("imu.csv".into());
    run.drive.gnss = Some("gnss.csv".into());
    run.drive.rate_hz = 100.0.into();
    run.drive.model = Some("tuned".into());
    run.reference = "gnss".into();
    run.smooth = true;
    run.outages.push(cut(500.0, 45.5));
    assert_eq!(
        what_was_done("a", &run),
        "a: on imu.csv at 100 Hz with gnss.csv, GNSS was cut 3 times for 30 to 45.5 s. During the outages the smoothed solution was compared with the withheld fixes; the noise model is \"tuned\", run in 2 forms."
    );
    run.drive.simulated = Some("a car".into());
    run.drive.model = Some("the one of the simulation".into());
    run.drive.file = Some("drive.toml".into());
    run.drive.start = Some(Start {
        time_s: 0.0.into(),
        utc: String::new(),
        unix_s: 1e9.into(),
        clock: "gnss".into(),
    });
    let text = what_was_done("", &run);
    assert!(
        text.starts_with("On a car, simulated (imu.csv at 100 Hz, gnss.csv), GNSS was cut"),
        "{text}"
    );
    assert!(
        text.ends_with("; the noise model is the one of the simulation, run in 2 forms. Start of the first: 2001-09-09 01:51:40.000 UTC (from the GNSS receiver)."),
        "{text}"
    );
}

/// One conclusion, in the terminal as in the report; excluded outages and rejected fixes are counted in both.
#[test]
fn the_terminal_concludes_as_the_report_does() {
    use undrift_results::{Cut, LeftOutCut, findings::WhyLeftOut};
    let mut run = result();
    let (start_s, length_s) = (Number(300.0), Number(30.0));
    run.outages = vec![Cut { start_s, length_s }; 2];
    let why = WhyLeftOut::InGap;
    run.left_out = vec![LeftOutCut {
        start_s,
        length_s,
        why,
    }];
    run.reference = "gnss".into();
    (run.withheld, run.rejected) = (60, 3);
    let runs = [(String::new(), &run)];
    let text = plain(&run, crate::plain::unmarked);
    let reference = "the withheld fixes but for 3 of 60 that the run without outages rejects";
    assert!(
        text.starts_with(&format!("2 of 3 outages of 30 s, reference: {reference}\n")),
        "{text}"
    );
    assert!(what_was_done("", &run).contains(reference));
    let concluded = findings(&models(&runs));
    assert!(!concluded.is_empty());
    let section = &sections(&runs)[0];
    let report = crate::tests::sentences(section);
    for sentence in &concluded {
        assert!(text.contains(&format!("{sentence}\n")), "{text}");
        assert!(
            report.iter().any(|said| said.contains(sentence.as_str())),
            "{report:?}"
        );
    }
    // Nothing ran.
    run.outages.clear();
    run.models.clear();
    run.order.clear();
    assert_eq!(plain(&run, crate::plain::unmarked), "");
}

#[test]
fn warnings_name_the_model_that_they_are_of() {
    let mut run = result();
    run.failed.insert("ar".into(), "it diverged".into());
    run.models.get_mut("arma").unwrap().warning = Some("the gyro is frozen".into());
    run.warnings = vec!["IMU log: late".into()];
    let section = &sections(&[(String::new(), &run)])[0];
    let warned = crate::tests::sentences(section);
    assert_eq!(
        warned[2..5],
        [
            "Ar could not be run: it diverged.",
            "Run as arma, the gyro is frozen.",
            "IMU log: late.",
        ]
    );
    let twice = [("x".to_owned(), &run), ("y".to_owned(), &run)];
    let section = &sections(&twice)[0];
    let warned = crate::tests::sentences(section);
    assert!(
        warned.contains(&"In y: run as arma, the gyro is frozen."),
        "{warned:?}"
    );
}

/// With a constraint the drift of each of eight outages is half as large, with a sensor it is now more, now less.
#[test]
fn what_each_constraint_saves_is_in_a_table_and_beyond_chance_in_a_sentence() {
    let errors = |largest: &dyn Fn(usize) -> f64| {
        let outage = |k: usize| OutageErrors {
            max: Numbers::from([(HORIZONTAL.to_owned(), Number(largest(k)))]),
            ..OutageErrors::default()
        };
        let per_outage = Vec::from_iter((0..8).map(outage));
        let squares = per_outage.iter().map(|o| get(&o.max, HORIZONTAL).powi(2));
        let rms = (squares.sum::<f64>() / 8.0).sqrt();
        ModelErrors {
            rms: Numbers::from([(HORIZONTAL.to_owned(), Number(rms))]),
            per_outage,
            ..ModelErrors::default()
        }
    };
    let run = Outages {
        order: vec!["white".into(), "arma".into()],
        models: [("white", 9.0), ("arma", 3.0)]
            .map(|(name, m)| (name.to_owned(), errors(&|_| m)))
            .into(),
        without: [
            ("non_holonomic".to_owned(), errors(&|_| 6.0)),
            (
                "barometer".to_owned(),
                errors(&|k| if k % 2 == 0 { 2.0 } else { 4.0 }),
            ),
        ]
        .into(),
        ..Outages::default()
    };
    let table = without::table("", &run).unwrap();
    assert_eq!(
        table.head,
        ["model", "horizontal [m]", "ratio", "less with it"]
    );
    let rows: Vec<Vec<&str>> = table
        .rows
        .iter()
        .map(|row| row.iter().map(|c| c.text.as_str()).collect())
        .collect();
    assert_eq!(rows[0], ["arma", "3.00", "–", "–"]);
    assert_eq!(rows[1], ["without non-holonomic", "6.00", "0.50", "8 of 8"]);
    assert_eq!(rows[2], ["without barometer", "3.16", "0.95", "4 of 8"]);
    assert_eq!(
        without::sentences("", &run),
        ["Non-holonomic: 0.500 times the horizontal drift without it, less in 8 of 8 outages."]
    );
    assert!(without::table("", &result()).is_none());
}
