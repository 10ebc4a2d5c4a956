use super::*;
use crate::{
    figure::panel::Drawn,
    tests::{assert_points, cells, figure, legend, names, sentences},
};
use undrift::results::{Drive, Number, TunedVibration};

/// Of "°/s" in rad/s.
const DEG: f64 = std::f64::consts::PI / 180.0;

fn of_length(length: f64, ratio: [f64; 3]) -> TunedDrift {
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
fn the_verdict_is_of_the_drift_in_thirty_seconds() {
    let judged = |change: fn(&mut Tune)| {
        let mut tune = tune();
        change(&mut tune);
        let (severity, why) = judgement(&tune);
        assert_eq!(is_usable(&tune), severity == Severity::Note);
        assert!(verdict(&tune).ends_with(&why));
        (severity, why)
    };
    let rest = "30 s without GNSS: 4.00 m; before: 8.00 m (ratio 0.500, 95 % interval 0.400 to 0.600), over 24 held-out outages";
    assert_eq!(
        judged(|_| ()),
        (Severity::Note, format!("less drift. {rest}"))
    );
    assert_eq!(verdict(&tune()), format!("usable: less drift. {rest}"));
    assert_eq!(
        judged(|tune| tune.drift[1].after_within[1] = 0.89.into()),
        (
            Severity::Warning,
            format!("less drift, but the solution is optimistic. {rest}")
        )
    );
    let first = |tune: &mut Tune, ratio: [f64; 3], within: f64| {
        tune.drift[1] = of_length(30.0, ratio);
        tune.drift[1].after_within[1] = within.into();
    };
    for (ratio, within, severity, why) in [
        (
            [1.0, 0.9, 1.1],
            0.9,
            Severity::Note,
            "no significant change of drift. ",
        ),
        (
            [1.0, 0.9, 1.0],
            0.9,
            Severity::Note,
            "no significant change of drift. ",
        ),
        (
            [1.0, 1.0, 1.1],
            0.9,
            Severity::Note,
            "no significant change of drift. ",
        ),
        (
            [1.0, 0.9, 1.1],
            0.8,
            Severity::Warning,
            "no significant change of drift, and the solution is optimistic. ",
        ),
        (
            [2.0, 1.1, 3.0],
            0.9,
            Severity::Unusable,
            "more drift than before. ",
        ),
    ] {
        let mut tune = tune();
        first(&mut tune, ratio, within);
        let found = judgement(&tune);
        assert_eq!(found.0, severity, "{ratio:?}");
        assert!(found.1.starts_with(why), "{}", found.1);
    }
    let unfinished = judged(|tune| tune.converged = false);
    assert_eq!(unfinished.0, Severity::Warning);
    assert!(unfinished.1.starts_with("the fit has not converged. 30 s"));
    // Without outages of 30 s the longest count.
    let shorter = judged(|tune| tune.drift.truncate(1));
    assert!(
        shorter
            .1
            .starts_with("no significant change of drift. 10 s without GNSS: 7.20 m"),
        "{}",
        shorter.1
    );
    let untested = judged(|tune| tune.drift.clear());
    assert_eq!(untested.0, Severity::Warning);
    assert!(untested.1.starts_with("not tested"));
    let stopped = judged(|tune| tune.stopped = true);
    assert_eq!(stopped.0, Severity::Warning);
    assert!(stopped.1.starts_with("stopped early"));
    let unaligned = judged(|tune| tune.unaligned = vec!["a.toml".into()]);
    assert_eq!(unaligned.0, Severity::Unusable);
    assert!(unaligned.1.starts_with("a.toml cannot be aligned"));
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
        "Start: adis16405, with the noise at rest guessed from the quietest seconds of the first drive. 1 drive, 120 windows without fixes, 45 evaluations, stopped before it converged; the last 30.0 % of each held out. White noise that follows the vibration was tried and kept: 0.800 times the drift of constant white noise at 30 s (95 % interval 0.700 to 0.900)."
    );
    tune.vibration.as_mut().unwrap().kept = false;
    tune.unseen = 0.0.into();
    let text = what_was_done(&tune);
    assert!(
        text.contains("; nothing was held out. ") && text.contains("tried and rejected"),
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
            [name, unit, "1.00", "2.00 to 3.00", "4.00", "5.00 to 6.00"]
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
    assert!(sentences(&sections[0])[0].starts_with("a: Usable: less drift. 30 s"));
    assert!(sentences(&sections[0])[0].ends_with("held-out outages."));
    assert_eq!(names(&sections[1]), ["parameters"]);
    assert_eq!(
        sentences(&sections[1]),
        ["Not determined by these drives, so close to their priors: factor."]
    );
    let text = plain(&tune, crate::plain::unmarked);
    assert!(
        text.starts_with("usable: less drift. 30 s")
            && text.contains("\n\nStart: adis16405. 2 drives"),
        "{text}"
    );
    assert!(
        text.ends_with("\n\nNot determined by these drives, so close to their priors: factor."),
        "{text}"
    );
}
