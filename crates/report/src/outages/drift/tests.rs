use super::*;
use crate::{
    figure::panel::Drawn,
    tests::{assert_points, by_name, curve, figure, legend, names, near},
};
use undrift_results::{ModelErrors, OutageErrors};

/// Errors of three outages, from 1000.5 s on, `k` times 1, 2 and 9 m.
fn errors(k: f64) -> ModelErrors {
    let outage = |(start, max): (f64, f64)| OutageErrors {
        start_s: start.into(),
        max: by_name(&[("horizontal_m", k * max), ("north_m", 77.0)]),
        ..OutageErrors::default()
    };
    ModelErrors {
        rms: by_name(&[("horizontal_m", 5.0 * k), ("north_m", 77.0)]),
        per_outage: [(1000.5, 1.0), (1060.5, 2.0), (1120.5, 9.0)]
            .map(outage)
            .into(),
        ..ModelErrors::default()
    }
}

fn model<'a>(name: &str, key: &'a str, run: usize, errors: &'a ModelErrors, k: f64) -> Model<'a> {
    Model {
        name: name.into(),
        key,
        run,
        errors,
        drift: vec![(1.0, k), (2.0, 4.0 * k)],
        colour: 3 + run,
        usable: true,
    }
}

#[test]
fn the_section_has_the_curves_the_boxes_and_each_outage() {
    let (a, b, none) = (errors(1.0), errors(0.5), ModelErrors::default());
    let mut models = [
        model("white", "white", 0, &a, 1.0),
        model("arma", "arma", 0, &b, 0.5),
        model("ar", "ar", 0, &none, 0.1),
    ];
    let section = drift(&models).unwrap();
    assert_eq!(names(&section), ["drift", "models", "outage-by-outage"]);
    assert_eq!(section.note, "least 2.50 m, arma");
    // Nothing is concluded from what is not usable.
    models[1].usable = false;
    assert_eq!(drift(&models).unwrap().note, "least 5.00 m, white");
    models[0].usable = false;
    assert_eq!(drift(&models).unwrap().note, "");
    assert!(drift(&models[2..]).is_none());
}

#[test]
fn the_curves_are_the_drift_on_an_axis_for_where_they_end() {
    let (a, b) = (errors(1.0), errors(30.0));
    let (near_, far) = (
        model("a", "arma", 0, &a, 1.0),
        model("b", "ar", 0, &b, 31.0),
    );
    let curves_of = |models: &[&Model<'_>]| figure(curves(models));
    let both = curves_of(&[&near_, &far]);
    let panel = &both.panels[0];
    assert_eq!(legend(panel), ["a", "b"]);
    assert_points(&panel.series[1], &[(1.0, 31.0), (2.0, 124.0)]);
    // One ends at 31 times the other.
    assert!(panel.y.logarithmic);
    assert!(!curves_of(&[&near_]).panels[0].y.logarithmic);
    let mut still = model("c", "ar", 0, &a, 0.0);
    assert!(curves(&[&still]).is_none());
    still.drift.clear();
    let with = curves_of(&[&near_, &still]);
    assert_eq!(legend(&with.panels[0]), ["a"]);
}

#[test]
fn the_boxes_of_one_run_stand_above_their_models() {
    let (a, b) = (errors(1.0), errors(2.0));
    let models = [
        model("white", "white", 0, &a, 1.0),
        model("arma", "arma", 0, &b, 1.0),
    ];
    let figure = figure(spread(&[&models[0], &models[1]]));
    let panel = &figure.panels[0];
    assert_eq!(panel.x.names, ["white", "arma"]);
    assert_eq!(legend(panel), ["", "", "root mean square"]);
    for (at, k) in [(0, 1.0), (1, 2.0)] {
        let series = &panel.series[at];
        assert_eq!(
            (series.drawn, &series.x[..]),
            (Drawn::Boxes, &[at as f64][..])
        );
        assert_eq!(
            series.y.concat(),
            [1.0, 1.5, 2.0, 5.5, 9.0].map(|level| k * level)
        );
    }
    assert_points(&panel.series[2], &[(0.0, 5.0), (1.0, 10.0)]);
}

#[test]
fn the_boxes_of_several_runs_share_the_room_above_a_model() {
    let (a, b) = (errors(1.0), errors(2.0));
    let models = [
        model("x: white", "white", 0, &a, 1.0),
        model("x: arma", "arma", 0, &a, 1.0),
        model("y: white", "white", 1, &b, 1.0),
        model("y: arma", "arma", 1, &b, 1.0),
    ];
    let all: Vec<&Model<'_>> = models.iter().collect();
    let figure = figure(spread(&all));
    let panel = &figure.panels[0];
    assert_eq!(panel.x.names, ["white", "arma"]);
    assert_eq!(legend(panel), ["x", "y", "root mean square"]);
    assert_eq!(panel.series[1].x, [0.0, 1.0]);
    assert_eq!(panel.series[1].y[2], [4.0, 4.0]);
    assert_eq!(
        [0, 1].map(|at| panel.series[at].colour),
        [run_colour(0), run_colour(1)]
    );
    // The middles of the halves of 0.8.
    assert_points(
        &panel.series[2],
        &[(-0.2, 5.0), (0.8, 5.0), (0.2, 10.0), (1.2, 10.0)],
    );
}

#[test]
fn each_outage_is_drawn_at_its_start_with_a_dot() {
    let (a, b) = (errors(1.0), errors(2.0));
    let models = [
        model("white", "white", 0, &a, 1.0),
        model("arma", "arma", 1, &b, 1.0),
    ];
    let figure = figure(outage_by_outage(&[&models[0], &models[1]]));
    let panel = &figure.panels[0];
    assert_eq!(
        (panel.clock, &*panel.x.label),
        (Some(1000.0), "time since 1000 s [s]")
    );
    assert_eq!(legend(panel), ["white", "", "arma", ""]);
    let points = |k: f64| [(0.5, k), (60.5, 2.0 * k), (120.5, 9.0 * k)];
    for (at, k) in [(0, 1.0), (1, 1.0), (2, 2.0), (3, 2.0)] {
        assert_points(&panel.series[at], &points(k));
        assert_eq!(panel.series[at].drawn == Drawn::Dots, at % 2 == 1);
        assert_eq!(panel.series[at].colour, 3 + at / 2);
    }
    let none = errors(0.0);
    assert!(outage_by_outage(&[&model("a", "a", 0, &none, 1.0)]).is_none());
}

#[test]
fn results_become_models_in_their_order() {
    let mut result = undrift_results::Outages {
        order: vec!["white".into(), "gone".into()],
        ..undrift_results::Outages::default()
    };
    for (name, k) in [("ar", 3.0), ("white", 1.0)] {
        result.models.insert(name.into(), errors(k));
    }
    let drift = curve(&[1.0, 2.0], &[0.5, 0.75]);
    result.series.drift.insert(
        "white".into(),
        undrift_results::Drift {
            since_cut_s: drift.time_s,
            horizontal_rms_m: drift.value,
        },
    );
    let models = super::super::models(&[("a".to_owned(), &result), ("b".to_owned(), &result)]);
    let seen: Vec<(&str, &str, usize, bool)> = models
        .iter()
        .map(|model| (&*model.name, model.key, model.run, model.usable))
        .collect();
    assert_eq!(
        seen,
        [
            ("a: white", "white", 0, true),
            ("a: ar", "ar", 0, true),
            ("b: white", "white", 1, true),
            ("b: ar", "ar", 1, true),
        ]
    );
    assert_eq!(models[0].drift, [(1.0, 0.5), (2.0, 0.75)]);
    assert!(models[1].drift.is_empty());
    assert_eq!(models[0].largest(), [1.0, 2.0, 9.0]);
    assert!(near(models[1].rms(), 15.0));
}
