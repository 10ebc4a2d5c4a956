use super::*;
use crate::{
    Block,
    figure::panel::Drawn,
    tests::{assert_points, by_name, cells, curve, figure, legend, near, numbers, strong},
};
use undrift_noise::{normality::Test, stationarity::Critical};
use undrift_results::{
    Curve, Cut, CutLength, DemoModel, Estimate, Number, OneOne, Order, OrderRow, OrderTest,
    PaperSolution, PooledErrors, Residuals, ScanPoint, Track, demo::PAPER,
};

/// Of "°/s" in rad/s.
const DEG: f64 = std::f64::consts::PI / 180.0;

#[test]
fn the_papers_ratios_are_those_it_prints() {
    // Its Table 4, last row: 4.5, 2.9, 3.5, 6.5, 3.4, 4.4, 6.6, 11.4, 1.4.
    let printed = [4.5, 2.9, 3.5, 6.5, 3.4, 4.4, 6.6, 11.4, 1.4];
    let table = table_4(&Demo::default(), &Paper::default());
    for (cell, printed) in table.rows[2][1..].iter().zip(printed) {
        let ratio: f64 = cell.text.parse().unwrap();
        assert!((ratio - printed).abs() < 0.051, "{ratio} {printed}");
    }
}

/// A gyro that is just what the source paper's data sheet says, of 3 °/s, 0.007 °/s and 2 °/√h.
fn gyro() -> Axis {
    let mut axis = Axis {
        mean: (-3.0 * DEG).into(),
        ..Axis::default()
    };
    axis.allan.adev = numbers(&[0.1 * DEG, 0.664 * 0.007 * DEG, 0.05 * DEG]);
    axis.allan_terms.white.value = 2.0 / 60.0 * DEG;
    axis
}

/// And an accelerometer of 50 mg, 0.2 mg and 0.2 m/s/√h, which looks down.
fn accelerometer() -> Axis {
    let g = STANDARD_GRAVITY;
    let mut axis = Axis {
        mean: (-1.05 * g).into(),
        ..Axis::default()
    };
    axis.allan.adev = numbers(&[1.0, 0.664 * 2e-4 * g]);
    axis.allan_terms.white.value = 0.2 / 60.0;
    axis
}

fn demo() -> Demo {
    let mut demo = Demo::default();
    let axes = [("gyro_z", gyro()), ("accel_z", accelerometer())];
    for (name, axis) in axes {
        demo.identification.axes.insert(name.into(), axis);
    }
    demo
}

#[test]
fn table_1_is_in_the_units_of_the_data_sheet() {
    let ours = |demo: &Demo| -> Vec<String> {
        let table = table_1(demo);
        assert_eq!(table.head, ["quantity", "paper", "ours"]);
        table.rows.iter().map(|row| row[2].text.clone()).collect()
    };
    let table = table_1(&demo());
    assert_eq!(
        cells(&table),
        [
            ["gyro bias [°/s]", "3.0", "3.00"],
            ["gyro bias instability [°/s]", "0.007", "0.00700"],
            ["gyro random walk [°/√h]", "2.0", "2.00"],
            ["accelerometer bias [mg]", "50", "50.0"],
            ["accelerometer bias instability [mg]", "0.2", "0.200"],
            ["accelerometer random walk [m/s/√h]", "0.2", "0.200"],
        ]
    );
    // Too little of gravity is a bias as well as too much, whichever way the axis looks.
    for share in [0.95, -0.95, 1.05] {
        let mut demo = demo();
        let axis = demo.identification.axes.get_mut("accel_z").unwrap();
        axis.mean = (share * STANDARD_GRAVITY).into();
        assert_eq!(ours(&demo)[3], "50.0", "{share}");
    }
    assert_eq!(ours(&Demo::default()), ["–"; 6]);
}

fn test(statistic: f64, critical_5: f64) -> Test {
    Test {
        statistic,
        critical_5,
        p_value: 0.5,
    }
}

fn critical(five: f64) -> Critical {
    Critical {
        one: 10.0 * five,
        five,
        ten: 0.1 * five,
    }
}

/// An axis whose tests have these statistics and 5 % critical values.
fn tested(adf: [f64; 2], kpss: [f64; 2], jarque_bera: [f64; 2]) -> Axis {
    let mut axis = Axis::default();
    axis.adf.fixed.statistic = adf[0];
    axis.adf.fixed.critical = critical(adf[1]);
    axis.kpss.statistic = kpss[0];
    axis.kpss.critical = critical(kpss[1]);
    axis.jarque_bera = test(jarque_bera[0], jarque_bera[1]);
    axis.ks = test(0.01, 0.02);
    axis.lilliefors = test(0.03, 0.04);
    axis
}

#[test]
fn table_2_has_each_test_with_its_five_percent_value() {
    let table = table_2(&tested([-50.0, -2.86], [1.5, 0.463], [4.0, 5.99]));
    let ours: Vec<Vec<&str>> = cells(&table)
        .into_iter()
        .map(|row| row[3..].to_vec())
        .collect();
    assert_eq!(
        ours,
        [
            ["-50.0", "-2.86"],
            ["1.50", "0.463"],
            ["4.00", "5.99"],
            ["0.0100", "0.0200"],
            ["0.0300", "0.0400"],
        ]
    );
}

/// The two fits of equation 2.
fn one_one() -> Vec<OneOne> {
    let fit = |unit_root, phi: f64, theta: f64| OneOne {
        unit_root,
        phi: phi.into(),
        theta: theta.into(),
        sigma: 0.005.into(),
    };
    vec![fit(false, 0.999_99, 0.9985), fit(true, 1.0, 0.9)]
}

#[test]
fn equation_2_has_the_papers_and_both_of_ours() {
    let paper = Paper {
        one_one: one_one(),
        ..Paper::default()
    };
    let table = equation_2(&paper);
    assert_eq!(
        cells(&table),
        [
            ["paper", "1.0000", "0.9994", "0.0061 by its AIC"],
            [
                "ours, likeliest at the full rate",
                "0.99999",
                "0.99850",
                "0.00500"
            ],
            ["ours, φ held at 1", "1.00000", "0.90000", "0.00500"],
        ]
    );
}

/// Errors by component, `k` times 1 to 10 in the order of [`COMPONENTS`].
fn errors(k: f64) -> Numbers {
    let pairs = (1..).map(f64::from).zip(COMPONENTS);
    let pairs: Vec<(&str, f64)> = pairs.map(|(n, (key, _))| (key, k * n)).collect();
    by_name(&pairs)
}

fn models(names: &[&str]) -> Vec<DemoModel> {
    let model = |name: &&str| DemoModel {
        name: (*name).into(),
        ..DemoModel::default()
    };
    names.iter().map(model).collect()
}

#[test]
fn table_4_has_our_errors_below_the_papers_and_the_ratio_last() {
    let demo = Demo {
        models: models(&[WHITE, "not run", PAPER_EXACT]),
        ..Demo::default()
    };
    let mut paper = Paper::default();
    for (name, k) in [(WHITE, 4.0), (PAPER_EXACT, 0.5)] {
        paper.largest.insert(name.into(), errors(k));
    }
    let table = table_4(&demo, &paper);
    let rows = cells(&table);
    // Without the fourth, which the paper has not.
    assert_eq!(table.head.len(), 10);
    assert!(!table.head.contains(&"horizontal [m]".to_owned()));
    assert_eq!(
        rows[3],
        [
            WHITE, "4.00", "8.00", "12.0", "20.0", "24.0", "28.0", "32.0", "36.0", "40.0"
        ]
    );
    assert_eq!(rows[4][..4], [PAPER_EXACT, "0.500", "1.00", "1.50"]);
    assert_eq!(rows[5][0], "white / paper exact");
    assert_eq!(rows[5][1..], ["8.00"; 9]);
    assert_eq!(rows.len(), 6);
}

#[test]
fn errors_by_component_are_in_their_columns() {
    let known = errors(1.0);
    let rows = [("a", Some(&known)), ("b", None)];
    let table = components("n", "c", rows.into_iter());
    assert_eq!((&*table.name, &*table.caption), ("n", "c"));
    assert_eq!(table.head[1..], COMPONENTS.map(|(_, head)| head));
    let rows = cells(&table);
    assert_eq!(
        rows[0],
        [
            "a", "1.00", "2.00", "3.00", "4.00", "5.00", "6.00", "7.00", "8.00", "9.00", "10.0"
        ]
    );
    assert_eq!(rows[1][1..], ["–"; 10]);
    assert_eq!(strong(&table), []);
}

/// A row of the table of orders.
fn row((p, q): (u64, u64), aic_per_sample: f64, f: f64) -> OrderRow {
    OrderRow {
        order: Order { p, q },
        aic_per_sample: aic_per_sample.into(),
        f: f.into(),
        ..OrderRow::default()
    }
}

fn adequate(f: f64, f_critical: f64) -> Vec<OrderTest> {
    vec![OrderTest {
        f: f.into(),
        f_critical: f_critical.into(),
        ..OrderTest::default()
    }]
}

fn orders() -> Paper {
    Paper {
        orders: vec![
            row((1, 1), -10.0, f64::NAN),
            row((2, 1), -10.5, 3.0),
            row((4, 3), f64::NAN, f64::NAN),
            row((6, 5), -10.2, -0.5),
        ],
        adequacy: adequate(3.0, 3.84),
        ..Paper::default()
    }
}

fn said(demo: &Demo, axis: &Axis, paper: &Paper, wanted: &str) -> bool {
    agreement(demo, axis, paper).join("\n").contains(wanted)
}

#[test]
fn the_tests_reject_below_or_above_their_critical_values() {
    let demo = Demo::default();
    let first = |axis: &Axis| agreement(&demo, axis, &Paper::default()).remove(0);
    let both = first(&tested([-50.0, -2.86], [1.5, 0.463], [4.0, 5.99]));
    assert!(
        both.starts_with(
            "Tests: ADF rejects a unit root, as in the paper, and KPSS rejects stationarity"
        ),
        "{both}"
    );
    assert!(both.contains("Jarque-Bera does not reject normality where the paper's record does: the simulated noise is normal."));
    let neither = first(&tested([-2.0, -2.86], [0.1, 0.463], [11.0, 5.99]));
    assert!(neither.starts_with("Tests: ADF does not reject a unit root, as in the paper, and KPSS does not reject stationarity"));
    assert!(neither.contains("Jarque-Bera rejects normality, as in the paper."));
}

#[test]
fn the_orders_are_compared_by_f_and_aic() {
    let (demo, axis) = (Demo::default(), Axis::default());
    let said = |demo: &Demo, paper: &Paper, wanted: &str| said(demo, &axis, paper, wanted);
    let paper = orders();
    assert!(said(
        &demo,
        &paper,
        "Orders: (1,1) against (2,1) is adequate, as in the paper, F = 3.00 where 3.84 is critical. AIC per sample falls by 0.2000 from (1,1) to (8,7), the paper's by 0.0028; least at (2,1). The simulated noise is an ARMA(1,1) exactly"
    ));
    // F of an optimum that was not reached is far below zero; a half is chance.
    let reached = "leaves no such values here";
    assert!(said(&demo, &paper, reached));
    let mut missed = orders();
    missed.orders[3].f = (-10.0).into();
    assert!(!said(&demo, &missed, reached));
    let not = Paper {
        adequacy: adequate(4.0, 3.84),
        ..orders()
    };
    assert!(said(
        &demo,
        &not,
        "(1,1) against (2,1) is not adequate, F = 4.00"
    ));
    let at = Paper {
        adequacy: adequate(3.84, 3.84),
        ..orders()
    };
    assert!(said(&demo, &at, "(1,1) against (2,1) is adequate"));
    let recorded = Demo {
        recorded: true,
        ..Demo::default()
    };
    assert!(!said(&recorded, &paper, "ARMA(1,1) exactly"));
    // Without a table of orders there is nothing to compare.
    assert!(!said(&demo, &Paper::default(), "Orders"));
}

#[test]
fn equation_2_holds_where_phi_is_one_to_a_hundredth() {
    let (demo, axis) = (Demo::default(), Axis::default());
    let with = |phi: f64| Paper {
        one_one: vec![OneOne {
            phi: phi.into(),
            theta: 0.9985.into(),
            ..OneOne::default()
        }],
        ..Paper::default()
    };
    for phi in [0.995, 1.005] {
        let sentence = format!(
            "Equation 2: the likeliest ARMA(1,1) has φ = {phi:.5} and θ = 0.99850: a slow bias"
        );
        assert!(said(&demo, &axis, &with(phi), &sentence), "{phi}");
    }
    for phi in [0.5, 1.5, -0.995] {
        let sentence = format!(
            "Equation 2 does not hold on this record: at the full rate the likeliest ARMA(1,1) has φ = {phi:.3} and θ = 0.999"
        );
        assert!(said(&demo, &axis, &with(phi), &sentence), "{phi}");
    }
    // The one that is held at 1 shows nothing of it.
    let mut held = with(1.0);
    held.one_one[0].unit_root = true;
    assert!(!said(&demo, &axis, &held, "Equation 2"));
}

fn residuals() -> Residuals {
    let acf = [1.0, 0.03, -0.03, 0.01, -0.01];
    let acf = acf.into_iter().cycle().take(41);
    Residuals {
        acf: acf.map(Number).collect(),
        pacf: numbers(&[1.0, -0.04, 0.02]),
        bound: 0.02.into(),
        ..Residuals::default()
    }
}

#[test]
fn correlations_beyond_their_bounds_are_counted_without_lag_zero() {
    let paper = Paper {
        residuals: Some(residuals()),
        ..Paper::default()
    };
    // Of each five lags three: 1, 0.03 and -0.03; but the first 1 is at lag 0, and the last lag is 40.
    assert!(said(
        &Demo::default(),
        &Axis::default(),
        &paper,
        "Figure 3: of 40 autocorrelations of what ARMA(1,1) leaves 24 lie beyond the 95 % bounds, where white noise has 2; the paper's lie inside."
    ));
}

fn estimate(value: f64, low: f64, high: f64) -> Estimate {
    Estimate {
        value: value.into(),
        interval: [low.into(), high.into()],
    }
}

#[test]
fn the_ratios_of_table_4_are_of_the_horizontal_error() {
    let less = |estimate| PooledErrors {
        less_than_white: estimate,
        ..PooledErrors::default()
    };
    let ten = CutLength {
        length_s: 10.0.into(),
        cuts: 45,
        models: [
            (PAPER_EXACT.to_owned(), less(estimate(1.25, 1.1, 1.5))),
            (PAPER.to_owned(), less(estimate(0.04, 0.03, 0.05))),
        ]
        .into(),
    };
    let demo = Demo {
        lengths: vec![ten],
        ..Demo::default()
    };
    let mut paper = Paper::default();
    let ground = |north, east| by_name(&[("north_m", north), ("east_m", east), ("down_m", 77.0)]);
    paper.largest.insert(WHITE.into(), ground(6.0, -8.0));
    paper.largest.insert(PAPER_EXACT.into(), ground(3.0, 4.0));
    // The paper's: √(16.54² + 19.25²) / √(3.65² + 6.61²) = 25.38 / 7.55.
    assert!(said(
        &demo,
        &Axis::default(),
        &paper,
        "Outages: the paper's ARMA(1,1) leaves 3.36 times less than white noise (north and east of its Table 4 together), ours on the first drive 2.00 times, over all 45 outages of 10 s 1.25 times (95 %: 1.10 to 1.50)."
    ));
    assert!(said(
        &demo,
        &Axis::default(),
        &paper,
        "Its equations to the letter leave 25.0 times more than white noise here."
    ));
}

fn scan() -> Vec<ScanPoint> {
    let point = |scale: f64, horizontal: f64| ScanPoint {
        scale: scale.into(),
        horizontal_m: horizontal.into(),
    };
    vec![
        point(1.0, 80.0),
        point(0.01, f64::NAN),
        point(0.1, 5.0),
        point(0.001, 9.0),
    ]
}

#[test]
fn the_literal_equations_drive_the_bias_by_what_cancels() {
    let paper = Paper {
        one_one: one_one(),
        scan: scan(),
        ..Paper::default()
    };
    // (1 + 0.9²) / (1 − 0.9)² = 181, of the fit with φ held at 1.
    let text = literal(&paper).unwrap();
    assert!(
        text.contains("With θ = 0.90000 the bias is driven 181 times too hard in variance"),
        "{text}"
    );
    assert!(
        text.contains("the best is 0.100 times the white noise of a sample, 5.00 m."),
        "{text}"
    );
    assert_eq!(
        literal(&Paper {
            scan: Vec::new(),
            ..paper.clone()
        }),
        None
    );
    assert_eq!(
        literal(&Paper {
            one_one: Vec::new(),
            ..paper
        }),
        None
    );
}

#[test]
fn the_scan_is_drawn_as_it_is_on_two_logarithmic_axes() {
    let all = Paper {
        scan: vec![scan()[0], scan()[2]],
        ..Paper::default()
    };
    let figure = figure(figures::scan(&all));
    let panel = &figure.panels[0];
    assert!(panel.x.logarithmic && panel.y.logarithmic);
    for (series, drawn) in panel.series.iter().zip([Drawn::Line, Drawn::Dots]) {
        assert_eq!(series.drawn, drawn);
        assert_points(series, &[(1.0, 80.0), (0.1, 5.0)]);
    }
    assert_eq!(panel.series.len(), 2);
    assert!(figures::scan(&Paper::default()).is_none());
}

#[test]
fn the_first_figure_is_the_record_in_degrees_a_second() {
    let mut axis = gyro();
    axis.series.record = curve(&[0.0, 1.0], &[DEG, -2.0 * DEG]);
    let figure = figure(figures::figure_1(&axis));
    assert_points(&figure.panels[0].series[0], &[(0.0, 1.0), (1.0, -2.0)]);
}

#[test]
fn the_third_figure_has_both_correlations_of_the_residuals() {
    let paper = Paper {
        residuals: Some(residuals()),
        ..Paper::default()
    };
    let figure = figure(figures::figure_3(&paper));
    let titles: Vec<&str> = figure.panels.iter().map(|panel| &*panel.title).collect();
    assert_eq!(titles, ["Autocorrelation", "Partial autocorrelation"]);
    let bars = |panel: usize| &figure.panels[panel].series[1];
    assert_eq!(bars(0).x.len(), 40);
    assert_eq!(bars(0).y[0][..3], [0.03, -0.03, 0.01]);
    assert_points(bars(1), &[(1.0, -0.04), (2.0, 0.02)]);
}

/// A demo with one outage from 2 to 4 s, and the drive of both filters in it, to the east.
fn driven() -> (Demo, Paper) {
    let times = [1.0, 2.0, 3.0, 4.0, 5.0];
    let track = Track {
        time_s: numbers(&times),
        lat_deg: numbers(&[0.0; 5]),
        lon_deg: times.map(|t| Number(t / DEG / 6_378_137.0)).into(),
        height_m: Vec::new(),
    };
    let cut = Cut {
        start_s: 2.0.into(),
        length_s: 2.0.into(),
    };
    let demo = Demo {
        cuts: vec![cut],
        track: track.clone(),
        ..Demo::default()
    };
    let mut paper = Paper::default();
    for (name, k) in [(WHITE, 2.0), (PAPER_EXACT, 1.0)] {
        let errors = |f: f64| curve(&[1.0, 5.0], &[f * k, -3.0 * f * k]);
        let solution = PaperSolution {
            track: track.clone(),
            error_m: [1.0, 2.0, 4.0].map(errors),
        };
        paper.solutions.insert(name.into(), solution);
    }
    (demo, paper)
}

#[test]
fn the_fourth_figure_marks_the_way_without_gnss() {
    let (demo, paper) = driven();
    let figure = figure(figures::figure_4(&demo, &paper));
    let titles: Vec<&str> = figure.panels.iter().map(|panel| &*panel.title).collect();
    assert_eq!(titles, [WHITE, PAPER_EXACT]);
    for panel in &figure.panels {
        assert!(panel.to_scale);
        assert_eq!(legend(panel), ["solution", "without GNSS"]);
        // A metre of the equator in a second, from where the drive begins.
        let way = [0.0, 1.0, 2.0, 3.0, 4.0];
        for (x, expected) in panel.series[0].x.iter().zip(way) {
            assert!((x - expected).abs() < 1e-6, "{x} {expected}");
        }
        assert!(panel.series[0].y[0].iter().all(|north| north.abs() < 1e-6));
        // Cut after 2 s until 4 s.
        let cut: Vec<bool> = panel.series[1].x.iter().map(|x| x.is_finite()).collect();
        assert_eq!(cut, [false, false, true, true, false]);
    }
}

#[test]
fn the_fifth_figure_has_the_three_errors_over_time_on_one_scale() {
    let (demo, paper) = driven();
    let figure = figure(figures::figure_5(&demo, &paper));
    assert_eq!(figure.panels.len(), 2);
    for (panel, k) in figure.panels.iter().zip([2.0, 1.0]) {
        assert_eq!(panel.shades, [(2.0, 4.0)]);
        assert_eq!(legend(panel), ["north", "east", "down"]);
        for (series, f) in panel.series.iter().zip([1.0, 2.0, 4.0]) {
            assert_points(series, &[(1.0, f * k), (5.0, -3.0 * f * k)]);
        }
        // The largest of all, 24 m, and a twentieth.
        let range = panel.y.range.clone().unwrap();
        assert!(
            near(range.start, -25.2) && near(range.end, 25.2),
            "{range:?}"
        );
    }
    // A drive without errors is not drawn flat.
    let mut still = Paper::default();
    let none = [Curve::default(), Curve::default(), Curve::default()];
    still.solutions.insert(
        WHITE.into(),
        PaperSolution {
            error_m: none,
            ..PaperSolution::default()
        },
    );
    let figure = crate::tests::figure(figures::figure_5(&demo, &still));
    let range = figure.panels[0].y.range.clone().unwrap();
    assert!(near(range.end, 0.105), "{range:?}");
}

#[test]
fn the_section_has_the_tables_in_the_papers_order_and_a_terminal_the_same() {
    let (driven, solutions) = driven();
    let demo = Demo {
        paper: Some(Paper {
            residuals: Some(residuals()),
            one_one: one_one(),
            scan: scan(),
            ..Paper {
                solutions: solutions.solutions,
                ..orders()
            }
        }),
        cuts: driven.cuts,
        track: driven.track,
        conclusion: "It drifts less.".into(),
        ..demo()
    };
    let section = section(&demo).unwrap();
    assert_eq!(
        crate::tests::names(&section),
        [
            "paper-1",
            "paper-2",
            "pandit-wu-gyro_z",
            "adequacy-gyro_z",
            "paper-equation-2",
            "paper-figure-3",
            "paper-figure-4",
            "paper-figure-5",
            "paper-4",
            "paper-scan",
        ]
    );
    assert!(matches!(&section.blocks[0], Block::Text(text) if text == words::INTRODUCTION));
    // The orders are those of the paper's part, not of the axis, which was searched less far.
    let table = tables(
        &demo,
        &demo.identification.axes[AXIS],
        demo.paper.as_ref().unwrap(),
    );
    assert_eq!(cells(&table[2])[3][0], "ARMA(6,5)");
    assert!(
        table[2]
            .caption
            .starts_with("The source paper's Table 3, z gyro, first 50 000 samples. ")
    );
    let text = plain(&demo, crate::plain::unmarked);
    assert!(text.starts_with("It drifts less.\n\nThe source paper's Table 1, data of the ADIS16405; beside it the static recording's z axes\n"), "{text}");
    for caption in [
        "Table 2, z gyro",
        "Table 3, z gyro",
        "adequacy of (1,1)",
        "equation 2",
        "Table 4:",
    ] {
        assert!(text.contains(caption), "{caption}: {text}");
    }
    assert!(text.contains("Figure 3: of 40") && text.contains("Why equations (3)-(9)"));
    assert_eq!(plain(&Demo::default(), crate::plain::unmarked), "");
}
