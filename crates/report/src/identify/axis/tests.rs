use super::*;
use crate::{
    figure::panel::Drawn,
    tests::{assert_points, by_name, cells, curve, legend, near, numbers, points as drawn, strong},
};
use undrift_results::{NotFitted, ParameterInterval, Psd, Residuals};

#[test]
fn correlations_are_bars_from_lag_one_with_the_bounds_of_white_noise() {
    let values = [1.0, 0.5, -0.25, 0.125].map(Number);
    let panel = correlation("of it", &values, 0.02);
    let [band, bars] = &panel.series[..] else {
        panic!("{}", panel.series.len());
    };
    assert_eq!(
        (&band.x[..], &band.y[0][..]),
        (&[0.0, 4.0][..], &[-0.02; 2][..])
    );
    assert_eq!(band.y[1], [0.02; 2]);
    assert_eq!(bars.x, [1.0, 2.0, 3.0]);
    assert_eq!(bars.y[0], [0.5, -0.25, 0.125]);
    assert_eq!(panel.x.range, Some(0.0..4.0));
    let range = panel.y.range.unwrap();
    assert!((range.start + 0.2875).abs() < 1e-12 && (range.end - 0.575).abs() < 1e-12);
    // At least the bounds, at most what a correlation can be.
    let range = |values: &[f64], bound| {
        let values: Vec<Number> = values.iter().copied().map(Number).collect();
        correlation("", &values, bound).y.range.unwrap()
    };
    assert_eq!(range(&[1.0, 0.01, 0.0], 0.02), -0.04..0.04);
    assert_eq!(range(&[1.0, 0.99, -0.99], 0.02), -1.0..1.0);
}

/// Of "°/s" in rad/s.
const DEG: f64 = PI / 180.0;

#[test]
fn samples_are_called_white_or_not_by_ljung_and_box() {
    let said = |p: f64| {
        let mut axis = Axis::default();
        axis.ljung_box.ljung_box_p = p;
        whiteness(&axis)
    };
    assert!(said(0.049).starts_with("Its samples are correlated"));
    assert!(said(0.05).starts_with("Its samples are white"));
    assert_eq!(said(f64::NAN), "");
}

#[test]
fn a_record_is_drawn_over_its_own_time() {
    let mut axis = Axis::default();
    assert!(record(&axis, units("gyro_x")).is_none());
    axis.series.record = curve(&[5000.0, 5001.0], &[DEG, -DEG]);
    let panel = record(&axis, units("gyro_x")).unwrap();
    assert_points(&panel.series[0], &[(5000.0, 1.0), (5001.0, -1.0)]);
    assert_eq!(panel.y.label, "sample [°/s]");
}

#[test]
fn a_histogram_has_the_area_of_the_normal_distribution_beside_it() {
    let mut axis = Axis::default();
    let (mean, sigma) = (2.0 * DEG, 0.5 * DEG);
    let of = &mut axis.series.histogram;
    of.mean = mean.into();
    of.sigma = sigma.into();
    of.centre = numbers(&[mean - sigma, mean + sigma]);
    // Half of the samples in each of two bars of a width of 2σ.
    of.density = numbers(&[0.25 / sigma; 2]);
    let panel = histogram(&axis, units("gyro_x")).unwrap();
    let [bars, normal] = &panel.series[..] else {
        panic!("{}", panel.series.len());
    };
    assert_points(bars, &[(1.5, 0.5), (2.5, 0.5)]);
    let range = panel.x.range.clone().unwrap();
    assert!(near(range.start, -0.5) && near(range.end, 4.5), "{range:?}");
    // Its area is one, its centre the mean, its second moment the variance.
    let normal = drawn(normal);
    assert_eq!(normal.len(), 201);
    let step = normal[1].0 - normal[0].0;
    let moment = |k: i32| -> f64 {
        let terms = normal.iter().map(|(x, d)| (x - 2.0).powi(k) * d * step);
        terms.sum()
    };
    assert!((moment(0) - 1.0).abs() < 1e-5 && moment(1).abs() < 1e-9);
    assert!((moment(2) - 0.25).abs() < 1e-5, "{}", moment(2));
    // Without a scatter, or without bars, there is nothing to show.
    for sigma in [0.0, -1.0, f64::NAN] {
        let mut axis = axis.clone();
        axis.series.histogram.sigma = sigma.into();
        assert!(histogram(&axis, units("gyro_x")).is_none(), "{sigma}");
    }
    axis.series.histogram.centre.clear();
    assert!(histogram(&axis, units("gyro_x")).is_none());
}

#[test]
fn record_and_residuals_have_both_correlations_where_they_are_known() {
    let mut axis = Axis {
        acf: numbers(&[1.0, 0.5]),
        pacf: numbers(&[1.0, 0.4]),
        ..Axis::default()
    };
    axis.series.correlation_bound = 0.1.into();
    axis.series.residuals = vec![Residuals {
        model: "AR(2)".into(),
        acf: numbers(&[1.0, 0.3]),
        // At lag 0 there is nothing to see.
        pacf: numbers(&[1.0]),
        bound: 0.2.into(),
        ..Residuals::default()
    }];
    let panels = correlations(&axis);
    let seen: Vec<(&str, f64, f64)> = panels
        .iter()
        .map(|panel| {
            let [band, bars] = &panel.series[..] else {
                panic!("{}", panel.series.len());
            };
            (&*panel.title, bars.y[0][0], band.y[1][0])
        })
        .collect();
    assert_eq!(
        seen,
        [
            ("Autocorrelation of the recording", 0.5, 0.1),
            ("Partial autocorrelation of the recording", 0.4, 0.1),
            ("Autocorrelation of residuals of AR(2)", 0.3, 0.2),
        ]
    );
}

/// An axis with the deviation of all five terms, each of which is 1 °/s at an averaging time of its own.
fn five_terms() -> Axis {
    let mut axis = Axis::default();
    let tau = [0.01, 0.1, 1.0, 10.0, 100.0];
    axis.allan.tau_s = numbers(&tau);
    axis.allan.adev = numbers(&tau.map(|tau| 2.0 * DEG * (1.0 + tau)));
    axis.allan.lower = numbers(&[DEG, DEG, 0.0, DEG, DEG]);
    axis.allan.upper = numbers(&[3.0 * DEG, 4.0 * DEG, 5.0 * DEG, f64::INFINITY, 7.0 * DEG]);
    axis.allan.fit = numbers(&tau.map(|tau| DEG * tau));
    axis.allan.fit_from_s = 0.1.into();
    let seen = |value: f64| Term {
        value,
        seen: true,
        ..Term::default()
    };
    let terms = &mut axis.allan_terms;
    // IEEE Std 952: √3 Q/τ, N/√τ, √(2 ln 2/π) B, K √(τ/3), R τ/√2.
    terms.quantisation = seen(DEG / 3f64.sqrt());
    terms.white = seen(DEG);
    terms.bias_instability = seen(DEG / 0.664_282_7);
    terms.random_walk = seen(DEG * 3f64.sqrt());
    terms.ramp = seen(DEG * 2f64.sqrt());
    axis
}

#[test]
fn an_allan_deviation_has_its_terms_by_the_standard() {
    let panel = allan(&five_terms(), units("gyro_x")).unwrap();
    assert!(panel.x.logarithmic && panel.y.logarithmic);
    assert_eq!(
        legend(&panel),
        [
            "",
            "record",
            "quantisation",
            "white noise",
            "bias instability",
            "random walk",
            "ramp",
            "sum of the terms"
        ]
    );
    // Where the interval has both ends.
    let band = &panel.series[0];
    assert_eq!(band.drawn, Drawn::Band);
    assert_eq!(band.x, [0.01, 0.1, 100.0]);
    for (found, expected) in band.y.iter().flatten().zip([1.0, 1.0, 1.0, 3.0, 4.0, 7.0]) {
        assert!(near(*found, expected), "{found} {expected}");
    }
    let record = [0.01, 0.1, 1.0, 10.0, 100.0].map(|tau| (tau, 2.0 * (1.0 + tau)));
    assert_points(&panel.series[1], &record);
    // From where on they were fitted; each is 1 °/s at 1 s.
    let slopes = [-1.0, -0.5, 0.0, 0.5, 1.0];
    for (series, slope) in panel.series[2..7].iter().zip(slopes) {
        for (tau, deviation) in drawn(series) {
            assert!((0.0999..=100.1).contains(&tau), "{}: {tau}", series.name);
            // Not below three tenths of the least deviation, 2.02 °/s.
            assert!(deviation > 0.606, "{}: {deviation}", series.name);
            let expected = tau.powf(slope);
            assert!((deviation / expected - 1.0).abs() < 1e-6, "{}", series.name);
        }
    }
    let ends = |at: usize| {
        let points = drawn(&panel.series[at]);
        (points[0].0, points[points.len() - 1].0)
    };
    // 0.606 = 1/τ at 1.65 s, √τ at 0.367 s, τ at 0.606 s; points lie 19 % apart.
    assert!(near(ends(2).0, 0.1) && (1.38..1.66).contains(&ends(2).1));
    assert!((0.36..0.44).contains(&ends(5).0) && near(ends(5).1, 100.0));
    assert!((0.60..0.73).contains(&ends(6).0));
    assert_eq!(drawn(&panel.series[4]).len(), 41);
    assert_points(
        &panel.series[7],
        &[(0.1, 0.1), (1.0, 1.0), (10.0, 10.0), (100.0, 100.0)],
    );
}

#[test]
fn a_term_that_is_not_seen_is_not_drawn() {
    let mut axis = five_terms();
    axis.allan_terms.white.seen = false;
    axis.allan_terms.ramp.value = 0.0;
    axis.allan_terms.random_walk.value = f64::NAN;
    // Fitted to the whole curve.
    axis.allan.fit_from_s = f64::NAN.into();
    let panel = allan(&axis, units("gyro_x")).unwrap();
    assert_eq!(
        legend(&panel),
        [
            "",
            "record",
            "quantisation",
            "bias instability",
            "sum of the terms"
        ]
    );
    assert_eq!(panel.series[2].x[0], 0.01);
    assert_eq!(panel.series[4].x.len(), 5);
    assert!(allan(&Axis::default(), units("gyro_x")).is_none());
}

#[test]
fn a_spectrum_is_the_root_of_the_density() {
    let mut axis = Axis::default();
    assert!(psd(&axis, units("gyro_x")).is_none() && density(&axis, units("gyro_x")).is_empty());
    axis.series.psd = Some(Psd {
        frequency_hz: numbers(&[1.0, 2.0]),
        density: numbers(&[4.0 * DEG * DEG, 9.0 * DEG * DEG]),
    });
    let panel = psd(&axis, units("gyro_x")).unwrap();
    assert_points(&panel.series[0], &[(1.0, 2.0), (2.0, 3.0)]);
    assert_eq!(panel.y.label, "root density [°/s/√Hz]");
}

/// Three candidates, of which "b" is recommended and "c" is for comparison.
fn with_candidates() -> Axis {
    let candidate = |name: &str, k: f64| Candidate {
        name: name.into(),
        states: k as u64,
        parameters: 1 + k as u64,
        block_aic: (100.0 * k).into(),
        ljung_box_p: (0.1 * k).into(),
        compared: name == "c",
        drift_score: by_name(&[("100", k * DEG), ("30", 0.5 * k * DEG), ("x", 7.0)]),
        drift_score_error: by_name(&[("100", 0.1 * k * DEG), ("30", 0.05 * k * DEG)]),
        drift_predicted: by_name(&[("100", 2.0 * k * DEG), ("30", 4.0 * k * DEG)]),
        ..Candidate::default()
    };
    let named = |name: &str| name.to_owned();
    Axis {
        candidates: vec![
            candidate("a", 3.0),
            candidate("b", 1.0),
            candidate("c", 2.0),
        ],
        ranking: ["b", "c", "a"].map(named).into(),
        chosen: candidate("b", 1.0),
        not_fitted: vec![NotFitted {
            name: "Allan".into(),
            reason: "it has no flat part".into(),
        }],
        ..Axis::default()
    }
}

#[test]
fn candidates_are_ranked_with_their_drift_by_horizon() {
    let table = candidates("gyro_x", &with_candidates(), units("gyro_x"));
    assert_eq!(table.name, "candidates-gyro_x");
    assert!(
        table
            .caption
            .contains("RMS error [°] of the predicted integral")
    );
    assert_eq!(
        table.head,
        [
            "model",
            "states",
            "parameters",
            "AIC",
            "Ljung-Box p",
            "after 30 s",
            "after 100 s"
        ]
    );
    assert_eq!(
        cells(&table),
        [
            [
                "b",
                "1",
                "2",
                "0.0",
                "0.100",
                "0.500 ± 0.050 (4.00)",
                "1.00 ± 0.10 (2.00)"
            ],
            [
                "c *",
                "2",
                "3",
                "100.0",
                "0.200",
                "1.00 ± 0.10 (8.00)",
                "2.00 ± 0.20 (4.00)"
            ],
            [
                "a",
                "3",
                "4",
                "200.0",
                "0.300",
                "1.50 ± 0.15 (12.0)",
                "3.00 ± 0.30 (6.00)"
            ],
        ]
    );
    assert_eq!(strong(&table), [(0, 0), (0, 5), (0, 6)]);
    // What has no rank comes last.
    let mut axis = with_candidates();
    axis.ranking.remove(0);
    assert_eq!(
        cells(&candidates("gyro_x", &axis, units("gyro_x")))[2][0],
        "b"
    );
    assert!(
        candidates("gyro_x", &Axis::default(), units("gyro_x"))
            .rows
            .is_empty()
    );
}

#[test]
fn a_terminal_points_to_the_recommended_candidate() {
    let table = drift_table("gyro_x", &with_candidates());
    assert_eq!(table.head, ["drift [°]", "after 30 s", "after 100 s"]);
    assert_eq!(
        cells(&table),
        [
            ["→ b", "0.500", "1.00"],
            ["  c *", "1.00", "2.00"],
            ["  a", "1.50", "3.00"],
        ]
    );
    assert_eq!(strong(&table), [(0, 0), (0, 1), (0, 2)]);
}

#[test]
fn the_star_is_explained_where_there_is_one() {
    let mut axis = with_candidates();
    assert_eq!(
        of_others(&axis),
        [
            "* as others fit or choose it, for comparison: never recommended.",
            "No Allan: it has no flat part."
        ]
    );
    axis.candidates.pop();
    assert_eq!(of_others(&axis), ["No Allan: it has no flat part."]);
}

#[test]
fn parameters_are_in_the_units_of_data_sheets() {
    let found = |parameter: &str, estimate: f64, low: f64, high: f64| ParameterInterval {
        parameter: parameter.into(),
        estimate: estimate.into(),
        low: low.into(),
        high: high.into(),
    };
    let hour = 1.0 / 3600.0;
    let none = f64::NAN;
    let axis = Axis {
        intervals: vec![
            // 1 °/√h is a 60th of a degree in a root second.
            found("N", 2.0 / 60.0 * DEG, 1.0 / 60.0 * DEG, 3.0 / 60.0 * DEG),
            found("K", 6.0 * hour / 60.0 * DEG, 0.0, 7.0 * hour / 60.0 * DEG),
            found("Q", 5.0 * hour * DEG, 4.0 * hour * DEG, none),
            found("τ", 100.0, 0.0, none),
            found("σ", 8.0 * hour * DEG, 7.0 * hour * DEG, 9.0 * hour * DEG),
            found("B", 3.0 * hour * DEG, 2.0 * hour * DEG, 4.0 * hour * DEG),
        ],
        ..Axis::default()
    };
    let table = parameters("gyro_x", &axis);
    assert_eq!(
        cells(&table),
        [
            ["N", "°/√h", "2.00", "1.00 to 3.00"],
            ["K", "°/h/√h", "6.00", "below 7.00"],
            ["Q", "arcsec", "5.00", "above 4.00"],
            ["τ", "s", "100", "not determined"],
            ["σ", "°/h", "8.00", "7.00 to 9.00"],
            ["B", "°/h", "3.00", "2.00 to 4.00"],
        ]
    );
    let g = undrift_nav::earth::STANDARD_GRAVITY;
    let accel = Axis {
        intervals: vec![
            found("N", 0.5 / 60.0, none, none),
            found("K", 2e-3 * g / 60.0, none, none),
            found("Q", 4e-3, none, none),
            found("σ", 3e-3 * g, none, none),
        ],
        ..Axis::default()
    };
    let units: Vec<Vec<&str>> = vec![
        vec!["N", "m/s/√h", "0.500", "not determined"],
        vec!["K", "mg/√h", "2.00", "not determined"],
        vec!["Q", "mm/s", "4.00", "not determined"],
        vec!["σ", "mg", "3.00", "not determined"],
    ];
    assert_eq!(cells(&parameters("accel_z", &accel)), units);
}
