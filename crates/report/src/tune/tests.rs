use super::*;
use crate::{
    figure::panel::Drawn,
    tests::{assert_points, cells, figure, legend, names, sentences},
};
use undrift_results::{Drive, Number, TunedVibration};

/// Of "°/s" in rad/s.
const DEG: f64 = std::f64::consts::PI / 180.0;

pub(super) fn of_length(length: f64, ratio: [f64; 3]) -> TunedDrift {
    TunedDrift {
        length_s: length.into(),
        outages: 24,
        before_m: 8.0.into(),
        after_m: (8.0 * ratio[0]).into(),
        ratio: ratio[0].into(),
        ratio_low: ratio[1].into(),
        ratio_high: ratio[2].into(),
        before_within: [0.5, 0.8, 0.9].map(Number),
        after_within: [0.7, 0.95, 0.99].map(Number),
        nees: Vec::new(),
    }
}

fn parameter(name: &str, unit: &str, one: f64, determined: bool) -> TunedParameter {
    TunedParameter {
        name: name.into(),
        unit: unit.into(),
        start: one.into(),
        prior: (9.0 * one).into(),
        prior_low: (2.0 * one).into(),
        prior_high: (3.0 * one).into(),
        value: (4.0 * one).into(),
        low: (5.0 * one).into(),
        high: (6.0 * one).into(),
        determined,
    }
}

fn tune() -> Tune {
    Tune {
        drives: vec![Drive::default(); 2],
        start: "adis16405".into(),
        unseen: 0.3.into(),
        windows: 120,
        evaluations: 45,
        converged: true,
        parameters: vec![
            parameter("gyro_white", "rad/s/√Hz", 1e-3 * DEG, true),
            parameter("factor", "", 1.0, false),
        ],
        drift: vec![
            of_length(10.0, [0.9, 0.8, 1.1]),
            of_length(30.0, [0.5, 0.4, 0.6]),
        ],
        ..Tune::default()
    }
}

#[test]
fn what_was_done_is_counted() {
    let mut tune = tune();
    assert_eq!(
        what_was_done(&tune),
        "Start: adis16405. 2 drives, 120 windows without fixes, 45 evaluations, converged; the drift is that of a fit without the last 30.0 % of each."
    );
    tune.guessed = true;
    tune.drives.pop();
    tune.held_out = true;
    tune.converged = false;
    let tried = TunedVibration {
        length_s: 30.0.into(),
        ratio: 0.8.into(),
        ratio_low: 0.7.into(),
        ratio_high: 0.9.into(),
        kept: true,
        ..TunedVibration::default()
    };
    tune.vibration = Some(tried);
    assert_eq!(
        what_was_done(&tune),
        "Start: adis16405, with the noise at rest guessed from the quietest seconds of the first drive. 1 drive, 120 windows without fixes, 45 evaluations, stopped before it converged; the last 30.0 % of each held out. White noise that follows the vibration was kept: the held-out fixes are more likely with it; 0.800 times the drift of constant white noise at 30 s (95 % interval 0.700 to 0.900)."
    );
    (tune.withheld, tune.rejected) = (600, 12);
    let text = what_was_done(&tune);
    let rejected = " 12 of the 600 positions there are rejected before and after, so they are no reference. White";
    assert!(text.contains(rejected), "{text}");
    tune.vibration.as_mut().unwrap().kept = false;
    tune.unseen = 0.0.into();
    let text = what_was_done(&tune);
    assert!(
        text.contains("; nothing was held out. ")
            && text.contains("was rejected: the held-out fixes are less likely"),
        "{text}"
    );
}

#[test]
fn the_drift_before_and_after_is_listed_by_length() {
    assert_eq!(
        cells(&drift(&tune())),
        [
            [
                "10 s",
                "24",
                "8.00",
                "7.20",
                "0.900 (0.800 to 1.10)",
                "50.0 / 80.0 / 90.0 %",
                "70.0 / 95.0 / 99.0 %"
            ],
            [
                "30 s",
                "24",
                "8.00",
                "4.00",
                "0.500 (0.400 to 0.600)",
                "50.0 / 80.0 / 90.0 %",
                "70.0 / 95.0 / 99.0 %"
            ],
        ]
    );
}

#[test]
fn parameters_are_in_the_units_of_data_sheets() {
    let g = 9.80665;
    let mut tune = tune();
    tune.parameters = vec![
        parameter("a", "rad/s/√Hz", 1e-3 * DEG, true),
        parameter("b", "m/s²/√Hz", 1e-6 * g, true),
        parameter("c", "rad/s/√s", 1e-3 * DEG, true),
        parameter("d", "m/s²/√s", 1e-6 * g, true),
        parameter("e", "m", 1.0, true),
    ];
    let table = parameters(&tune);
    let units = ["mdps/√Hz", "µg/√Hz", "mdps/√s", "µg/√s", "m"];
    for ((row, unit), name) in cells(&table)
        .into_iter()
        .zip(units)
        .zip(["a", "b", "c", "d", "e"])
    {
        assert_eq!(
            row,
            [
                name,
                unit,
                "1.00",
                "2.00 to 3.00",
                "4.00",
                "4.00",
                "5.00 to 6.00"
            ]
        );
    }
}

#[test]
fn shares_inside_are_drawn_against_those_of_a_normal_distribution() {
    let figure = figure(calibration(&tune()));
    let titles: Vec<&str> = figure.panels.iter().map(|panel| &*panel.title).collect();
    assert_eq!(titles, ["10 s", "30 s"]);
    let panel = &figure.panels[1];
    assert_eq!(legend(panel), ["a correct σ", "before", "after"]);
    let drawn: Vec<Drawn> = panel.series.iter().map(|series| series.drawn).collect();
    assert_eq!(drawn, [Drawn::Dashed, Drawn::Line, Drawn::Thick]);
    // 2Φ(k) − 1.
    let normal = [0.6827, 0.9545, 0.9973];
    for (series, shares) in panel
        .series
        .iter()
        .zip([normal, [0.5, 0.8, 0.9], [0.7, 0.95, 0.99]])
    {
        let points: Vec<(f64, f64)> = normal.into_iter().zip(shares).collect();
        assert_points(series, &points);
    }
}

#[test]
fn the_sections_have_the_drift_and_the_noise() {
    let tune = tune();
    let sections = sections(&[("a".to_owned(), &tune)]);
    let titles: Vec<&str> = sections.iter().map(|section| &*section.title).collect();
    assert_eq!(
        titles,
        ["a: Drift before and after", "a: Noise in the vehicle"]
    );
    assert_eq!(names(&sections[0]), ["drift", "calibration"]);
    assert!(
        sentences(&sections[0])[0].starts_with("a: Usable: use the noise found, less drift. 30 s")
    );
    assert!(sentences(&sections[0])[0].ends_with("held-out outages."));
    assert_eq!(names(&sections[1]), ["parameters"]);
    let open = "Not determined, and towards an end of what was expected, or beyond it: factor (4.00, expected 2.00 to 3.00).";
    assert_eq!(sentences(&sections[1]), [open]);
    let text = plain(&tune, crate::plain::unmarked);
    assert!(
        text.starts_with("usable: use the noise found, less drift. 30 s")
            && text.contains("\n\nStart: adis16405. 2 drives"),
        "{text}"
    );
    assert!(text.ends_with(&format!("\n\n{open}")), "{text}");
}

/// What the drives do not determine may all the same be found far away from what was expected, by chance.
#[test]
fn what_is_not_determined_is_close_to_what_was_expected_or_not() {
    let open = |value: f64| {
        let mut p = parameter("p", "", 1.0, false);
        (p.prior, p.prior_low, p.prior_high) = (1.0.into(), 0.25.into(), 16.0.into());
        p.value = value.into();
        p
    };
    let said = |values: &[f64]| {
        undetermined(&Tune {
            parameters: values.iter().map(|value| open(*value)).collect(),
            ..Tune::default()
        })
    };
    // Half of the way to the bounds of 1/4 and 16, by the logarithm.
    let near = "Not determined by these drives, so close to what was expected: p.";
    for value in [0.51, 1.0, 3.9] {
        assert_eq!(said(&[value]), near);
    }
    assert_eq!(
        said(&[0.49]),
        "Not determined, and towards an end of what was expected, or beyond it: p (0.490, expected 0.250 to 16.0)."
    );
    assert_eq!(
        said(&[1.0, 4.1]),
        format!(
            "{near} Not determined, and towards an end of what was expected, or beyond it: p (4.10, expected 0.250 to 16.0)."
        )
    );
    assert_eq!(said(&[]), "");
}

/// Each row has its length, its part, and before and after in their columns; a drive without poses has no table.
#[test]
fn nees_of_poses_is_a_row_of_each_length_and_part() {
    let of = |of: &str, before: f64| undrift_results::TunedNees {
        of: of.into(),
        before: [before, before - 0.5, before + 0.5].map(Number),
        after: [1.0, 0.75, 1.25].map(Number),
    };
    let drift = |length, nees| TunedDrift {
        nees,
        ..of_length(length, [0.5, 0.4, 0.6])
    };
    let posed = Tune {
        drift: vec![
            drift(1.0, vec![of("position", 2.0), of("attitude", 3.0)]),
            drift(10.0, vec![of("position", 4.0)]),
        ],
        ..Tune::default()
    };
    let table = nees(&posed).unwrap();
    let rows = table.rows.iter();
    let rows = rows.map(|row| Vec::from_iter(row.iter().map(|cell| cell.text.as_str())));
    let after = "1.00 (0.750 to 1.25)";
    assert_eq!(
        Vec::from_iter(rows),
        [
            ["1 s", "position", "2.00 (1.50 to 2.50)", after],
            ["1 s", "attitude", "3.00 (2.50 to 3.50)", after],
            ["10 s", "position", "4.00 (3.50 to 4.50)", after],
        ]
    );
    let unposed = Tune {
        drift: vec![of_length(1.0, [1.0; 3])],
        ..Tune::default()
    };
    assert!(nees(&unposed).is_none());
}
