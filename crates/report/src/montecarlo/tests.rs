use super::*;
use crate::{
    figure::panel::Drawn,
    tests::{
        assert_points, cells, figure_of, legend, names, near, numbers, points, sentences, strong,
    },
};
use undrift_results::{MonteCarloDrive, NisKind};

fn nees_group(name: &str, verdict: Option<Verdict>) -> Group {
    Group {
        name: name.into(),
        freedom: 3,
        mean_per_freedom: 1.05.into(),
        mean_standard_error: 0.021.into(),
        share_inside: 0.9.into(),
        share_above: 0.07.into(),
        share_below: 0.03.into(),
        share_standard_error: 0.012.into(),
        verdict,
        // Below what plots reach over, then 1, 2 and above.
        average: numbers(&[0.03, 3.0, 6.0, 1e9]),
        lower: numbers(&[2.4; 4]),
        upper: numbers(&[3.6; 4]),
        ..Group::default()
    }
}

fn montecarlo(verdicts: [Option<Verdict>; 2]) -> MonteCarlo {
    let [all, position] = verdicts;
    let kind = NisKind {
        name: "position".into(),
        updates: 12_345,
        nis_per_freedom: 1.004_56.into(),
        bounds: (0.99.into(), 1.01.into()),
        share_above_95: 0.05.into(),
        autocorrelation: vec![numbers(&[0.01, -0.04]), numbers(&[0.02])],
        autocorrelation_bound: 0.03.into(),
        verdict: Some(Verdict::Consistent),
        ..NisKind::default()
    };
    let model = MonteCarloModel {
        name: "arma".into(),
        diverged: 2,
        started_s: 15.0.into(),
        nees: vec![nees_group("all", all), nees_group("position", position)],
        coverage: [
            ("vn_mps".to_owned(), numbers(&[0.683, 0.954, 0.997])),
            ("psi_north_rad".to_owned(), numbers(&[0.5, 0.9])),
        ]
        .into(),
        nis: vec![kind],
    };
    MonteCarlo {
        runs: 50,
        seed: 9,
        settle_s: 60.0.into(),
        drive: MonteCarloDrive {
            duration_s: 900.0.into(),
            rate_hz: 100.0.into(),
            model: "adis16405".into(),
            drawn_as: "arma".into(),
            ..MonteCarloDrive::default()
        },
        time_s: numbers(&[10.0, 20.0, 30.0, 40.0]),
        models: vec![model],
        ..MonteCarlo::default()
    }
}

fn consistent() -> MonteCarlo {
    montecarlo([Some(Verdict::Consistent); 2])
}

#[test]
fn the_nees_is_listed_by_group_and_a_bad_verdict_stands_out() {
    let run = montecarlo([Some(Verdict::Optimistic), Some(Verdict::Consistent)]);
    let table = nees(&models(&[("a".to_owned(), &run)]));
    assert_eq!(
        cells(&table)[0],
        [
            "a: arma",
            "all",
            "3",
            "1.05 ± 0.021",
            "90.0 ± 1.2 %",
            "7.0 %",
            "3.0 %",
            "optimistic"
        ]
    );
    assert_eq!(strong(&table), [(0, 7)]);
}

#[test]
fn a_verdict_of_all_groups_is_one() {
    let said = |verdicts| {
        let run = montecarlo(verdicts);
        verdict(&models(&[(String::new(), &run)])[0])
    };
    let (consistent, optimistic) = (Some(Verdict::Consistent), Some(Verdict::Optimistic));
    assert_eq!(said([consistent; 2]), "consistent in every group of states");
    assert_eq!(
        said([optimistic, consistent]),
        "consistent in position; optimistic in all"
    );
    assert_eq!(said([None; 2]), "");
    assert_eq!(
        said([None, Some(Verdict::Pessimistic)]),
        "pessimistic in position"
    );
}

#[test]
fn shares_are_listed_by_component() {
    let run = consistent();
    let table = coverage(&models(&[(String::new(), &run)]));
    let rows = cells(&table);
    assert!(
        rows.contains(&vec![
            "arma",
            "velocity north",
            "68.3 %",
            "95.4 %",
            "99.7 %"
        ]),
        "{rows:?}"
    );
    assert!(
        rows.contains(&vec!["arma", "misalignment north", "50.0 %", "90.0 %", "–"]),
        "{rows:?}"
    );
    let spoken = ["ve_mps", "vd_mps", "north_m", "gyro_x_radps"].map(spoken);
    assert_eq!(
        spoken,
        ["velocity east", "velocity down", "north", "gyro x"]
    );
}

#[test]
fn innovations_have_the_largest_correlation_of_all_lags_and_components() {
    let run = consistent();
    let table = innovations(&models(&[(String::new(), &run)]));
    assert_eq!(
        cells(&table),
        [[
            "arma",
            "position",
            "12\u{202f}345",
            "1.0046",
            "0.9900 … 1.0100",
            "5.0 %",
            "0.040 (±0.030)",
            "consistent"
        ]]
    );
    assert_eq!(strong(&table), []);
}

#[test]
fn the_nees_over_time_is_per_degree_of_freedom_between_its_bounds() {
    let run = consistent();
    let sections = sections(&[(String::new(), &run)]);
    let figure = figure_of(&sections, "nees");
    let titles: Vec<&str> = figure.panels.iter().map(|panel| &*panel.title).collect();
    assert_eq!(titles, ["position", "all"]);
    let panel = &figure.panels[0];
    assert_eq!(legend(panel), ["arma", "", ""]);
    // Values beyond what the plot reaches over are drawn at its ends.
    let nees = points(&panel.series[0]);
    assert_eq!(nees, [(10.0, 0.1), (20.0, 1.0), (30.0, 2.0), (40.0, 1e7)]);
    assert_eq!(panel.series[0].drawn, Drawn::Thin);
    for (bound, value) in panel.series[1..].iter().zip([0.8, 1.2]) {
        assert_eq!(bound.drawn, Drawn::Dashed);
        assert_points(bound, &[10.0, 20.0, 30.0, 40.0].map(|t| (t, value)));
    }
    // From the first time until the last of the runs has settled.
    assert_eq!(panel.shades, [(10.0, 75.0)]);
    assert_eq!(panel.y.range, Some(0.1..1e7));
    // Without a large value the axis reaches to 3, and three tenths.
    let mut run = consistent();
    for group in &mut run.models[0].nees {
        group.average = numbers(&[3.0, 6.0, 3.0, 3.0]);
    }
    let sections = super::sections(&[(String::new(), &run)]);
    let range = figure_of(&sections, "nees").panels[0]
        .y
        .range
        .clone()
        .unwrap();
    assert!(near(range.end, 3.9), "{range:?}");
}

#[test]
fn a_second_run_is_dashed_and_below_the_first() {
    let (a, b) = (consistent(), consistent());
    let sections = sections(&[("a".to_owned(), &a), ("b".to_owned(), &b)]);
    let panel = &figure_of(&sections, "nees").panels[0];
    assert_eq!(legend(panel)[..2], ["b: arma", "a: arma"]);
    assert_eq!(
        (panel.series[0].drawn, panel.series[1].drawn),
        (Drawn::Dashed, Drawn::Thin)
    );
}

#[test]
fn what_was_simulated_and_which_runs_diverged_is_said() {
    let mut run = consistent();
    let section = &sections(&[(String::new(), &run)])[0];
    assert_eq!(names(section), ["nees"]);
    assert_eq!(
        sentences(section),
        [
            "arma is consistent in every group of states.",
            "Arma: 2 of 50 runs diverged.",
            "50 runs of a simulated drive of 15 min, IMU at 100 Hz, sensor errors of adis16405 drawn as arma, seed 9. Averages and shares exclude the first 60 s of navigation.",
        ]
    );
    let text = plain(&run, crate::plain::unmarked);
    assert!(
        text.starts_with("50 runs of a simulated drive of 15 min"),
        "{text}"
    );
    assert!(
        text.ends_with("arma: consistent in every group of states; 2 of 50 runs diverged."),
        "{text}"
    );
    run.models[0].diverged = 0;
    run.drive.duration_s = f64::NAN.into();
    let text = plain(&run, crate::plain::unmarked);
    assert!(
        text.starts_with("50 runs of a simulated drive, seed 9."),
        "{text}"
    );
    assert!(
        text.ends_with("arma: consistent in every group of states."),
        "{text}"
    );
}
