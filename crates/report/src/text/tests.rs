use super::*;
use crate::tests::{by_name, numbers};
use undrift_noise::{GaussMarkov, allan::Term, spectrum::Line};
use undrift_results::{
    Aid, Axis, BoxJenkins, Candidate, Detrend, Identify, Navigate, Order, OrderTest, Parameter,
    ParameterInterval, findings::Finding,
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

/// A gyro with a model of white noise and two Gauss-Markov processes.
fn gyro() -> Axis {
    let process = |sigma: f64, tau_s: f64| GaussMarkov {
        sigma: sigma / 3600.0 * DEG,
        tau_s,
    };
    let candidate = Candidate {
        name: "composite".into(),
        white: (2.0 / 60.0 * DEG).into(),
        random_walk: (6.0 / 3600.0 / 60.0 * DEG).into(),
        quantisation: (5.0 / 3600.0 * DEG).into(),
        turn_on: (0.5 * DEG).into(),
        gauss_markov: vec![process(7.0, 100.0), process(3.0, 20.0)],
        drift_score: by_name(&[("30", DEG)]),
        reason: Some("it drifts least.".into()),
        ..Candidate::default()
    };
    let mut axis = Axis {
        samples: 90_000,
        chosen: candidate.clone(),
        candidates: vec![candidate],
        stationarity: "It is stationary.".into(),
        skewness: 0.1.into(),
        kurtosis_excess: (-0.2).into(),
        ..Axis::default()
    };
    let terms = &mut axis.allan_terms;
    terms.white = term(2.5 / 60.0 * DEG, true);
    terms.random_walk = term(8.0 / 3600.0 / 60.0 * DEG, true);
    terms.quantisation = term(9.0 / 3600.0 * DEG, false);
    axis.allan.adev = numbers(&[2.0, 0.664 * 1.2, 1.5].map(|of| of / 3600.0 * DEG));
    axis
}

fn identified(axes: &[(&str, Axis)]) -> Identify {
    let axes = axes.iter();
    Identify {
        rate_hz: 100.0.into(),
        axes: axes
            .map(|(name, axis)| ((*name).to_owned(), axis.clone()))
            .collect(),
        ..Identify::default()
    }
}

/// Words of the line that begins with a text.
fn line<'a>(text: &'a str, begins: &str) -> Vec<&'a str> {
    let line = text
        .lines()
        .find(|line| line.trim_start().starts_with(begins));
    line.unwrap_or_else(|| panic!("{begins}: {text}"))
        .split_whitespace()
        .collect()
}

#[test]
fn the_terms_of_a_model_stand_below_their_units() {
    let mut accel = gyro();
    let g = 9.80665;
    accel.chosen.white = (0.5 / 60.0).into();
    accel.chosen.random_walk = 0.0.into();
    accel.chosen.quantisation = 4e-3.into();
    accel.chosen.turn_on = (3e-3 * g).into();
    accel.chosen.gauss_markov = vec![GaussMarkov {
        sigma: 2e-3 * g,
        tau_s: 50.0,
    }];
    let result = identified(&[("gyro_x", gyro()), ("accel_z", accel)]);
    let text = identify(&result, false, unmarked);
    assert_eq!(
        line(&text, "axis"),
        ["axis", "N", "B", "σ", "τ", "K", "Q", "turn-on"]
    );
    assert_eq!(
        line(&text, "°/√h"),
        ["°/√h", "°/h", "°/h", "s", "°/h/√h", "arcsec", "°/s"]
    );
    assert_eq!(
        line(&text, "gyro x"),
        [
            "gyro", "x", "2.00", "1.20", "7.00,", "3.00", "100,", "20.0", "6.00", "5.00", "0.500"
        ]
    );
    assert_eq!(
        line(&text, "m/s/√h"),
        ["m/s/√h", "mg", "mg", "s", "mg/√h", "mm/s", "mg"]
    );
    assert_eq!(
        line(&text, "accelerometer z"),
        [
            "accelerometer",
            "z",
            "0.500",
            "5.93e-4",
            "2.00",
            "50.0",
            "–",
            "4.00",
            "3.00"
        ]
    );
    assert!(!text.contains("* terms"), "{text}");
}

#[test]
fn an_arma_has_the_terms_of_the_allan_deviation_that_are_seen() {
    let mut axis = gyro();
    axis.chosen.white = f64::NAN.into();
    axis.chosen.gauss_markov.clear();
    let text = identify(&identified(&[("gyro_x", axis.clone())]), false, unmarked);
    // Of the deviation the quantisation is not seen.
    assert_eq!(
        line(&text, "gyro x *"),
        [
            "gyro", "x", "*", "2.50", "1.20", "–", "–", "8.00", "–", "0.500"
        ]
    );
    assert!(
        text.ends_with("* terms of the Allan deviation: the model recommended is an ARMA"),
        "{text}"
    );
    // Of Allan deviations alone that is no news.
    axis.candidates.clear();
    let text = identify(&identified(&[("gyro_x", axis)]), false, unmarked);
    assert!(
        text.contains("gyro x *") && !text.contains("* terms"),
        "{text}"
    );
}

#[test]
fn flicker_noise_stands_for_its_processes() {
    let mut axis = gyro();
    let flicker = 4.0 / 3600.0 * DEG;
    axis.chosen.flicker = flicker.into();
    let text = identify(&identified(&[("gyro_x", axis)]), false, unmarked);
    assert_eq!(
        line(&text, "gyro x"),
        [
            "gyro", "x", "2.00", "1.20", "–", "1/f", "5.16", "5.00", "0.500"
        ]
    );
}

#[test]
fn the_walk_beside_flicker_noise_is_its_own_and_fast_processes_are_white_noise() {
    let mut axis = gyro();
    let flicker = 4.0 / 3600.0 * DEG;
    axis.chosen.flicker = flicker.into();
    // Its own slow part alone is no random walk.
    let own = undrift_noise::composite::flicker(flicker).1;
    axis.chosen.random_walk = own.into();
    let shown = |axis: &Axis| {
        let text = identify(&identified(&[("gyro_x", axis.clone())]), false, unmarked);
        line(&text, "gyro x").join(" ")
    };
    assert_eq!(shown(&axis), "gyro x 2.00 1.20 – 1/f – 5.00 0.500");
    axis.chosen.random_walk = own.hypot(2.0 / 3600.0 / 60.0 * DEG).into();
    assert_eq!(shown(&axis), "gyro x 2.00 1.20 – 1/f 2.00 5.00 0.500");
    // N² + 2σ²τ: 2² of white noise and 1.5² of a process.
    let mut axis = gyro();
    let sigma = 1.5 / 60.0 * DEG / f64::sqrt(2.0 * 0.5);
    let process = |tau_s| vec![GaussMarkov { sigma, tau_s }];
    axis.chosen.gauss_markov = process(0.5);
    assert!(
        shown(&axis).starts_with("gyro x 2.50 1.20 "),
        "{}",
        shown(&axis)
    );
    axis.chosen.gauss_markov = process(1.5);
    assert!(
        shown(&axis).starts_with("gyro x 2.00 1.20 "),
        "{}",
        shown(&axis)
    );
}

#[test]
fn details_are_of_each_axis_before_the_terms() {
    let mut axis = gyro();
    axis.detrend = Detrend::Linear {
        slope_per_hour: 0.01 * DEG,
        explained: 0.125,
    };
    axis.box_jenkins = Some(BoxJenkins {
        samples: 5000,
        p_max: 4,
        by_aicc: Order { p: 2, q: 1 },
        by_bic: Order { p: 1, q: 1 },
        ..BoxJenkins::default()
    });
    axis.adequacy = vec![OrderTest {
        smaller: Order { p: 1, q: 1 },
        larger: Order { p: 2, q: 1 },
        f: 0.5.into(),
        f_critical: 3.0.into(),
        ..OrderTest::default()
    }];
    axis.intervals = vec![ParameterInterval {
        parameter: "N".into(),
        estimate: (2.0 / 60.0 * DEG).into(),
        low: (1.0 / 60.0 * DEG).into(),
        high: (3.0 / 60.0 * DEG).into(),
    }];
    axis.warnings = vec!["the record is short".into()];
    axis.lines = vec![Line {
        frequency_hz: 7.0,
        amplitude: 0.2 * DEG,
        ..Line::default()
    }];
    let text = identify(&identified(&[("gyro_x", axis)]), true, unmarked);
    let expected = "\
gyro_x: 90000 samples at 100 Hz
  Removed: a slope of 1.000e-2 °/s an hour, 12.50 % of the variance
  It is stationary.
  Allan: white noise 2.5000 °/√h; skewness 0.100, excess kurtosis -0.200
  ARMA(1,1) is adequate: F 0.50 against (2,1) (5 %: 3.00)
  Box-Jenkins, p, q ≤ 4, first 5000 samples: ARMA(2,1) by AICc, (1,1) by BIC
";
    assert!(text.contains(expected), "{text}");
    assert!(
        text.contains("→ composite") && text.contains("  it drifts least.\n"),
        "{text}"
    );
    assert!(
        text.contains(
            "  N: 1.00 to 3.00 °/√h with a probability of 95 %\n  Note: the record is short.\n"
        ),
        "{text}"
    );
    assert!(
        text.contains("\nLines and narrow resonances, not in the terms above:\naxis"),
        "{text}"
    );
    let constant = identify(&identified(&[("gyro_x", gyro())]), true, unmarked);
    assert!(
        !constant.contains("Removed") && !constant.contains("Lines"),
        "{constant}"
    );
}

#[test]
fn a_verdict_is_broken_into_lines_of_eighty() {
    let result = identified(&[
        ("gyro_x", gyro()),
        (
            "gyro_y",
            Axis {
                error: Some("a b c d e f g h i j ".repeat(8)),
                ..Axis::default()
            },
        ),
    ]);
    let text = identify(&result, false, unmarked);
    let lines: Vec<&str> = text.lines().take(3).collect();
    assert!(
        lines[0].starts_with("Usable with care: gyro y: a b c"),
        "{text}"
    );
    assert!(
        lines[1].starts_with("  ") && !lines[1].starts_with("   "),
        "{text}"
    );
    for line in lines {
        let length = line.chars().count();
        assert!(length <= 79, "{length}: {line}");
    }
    // The next word, of a letter or two, would not have gone on the line.
    assert!(text.lines().next().unwrap().chars().count() >= 77, "{text}");
}

#[test]
fn correlations_are_lines_by_lag() {
    let mut axis = Axis {
        acf: numbers(&[1.0, 0.5]),
        pacf: numbers(&[1.0, -0.25]),
        ..Axis::default()
    };
    axis.series.correlation_bound = 0.01.into();
    let result = identified(&[("gyro_x", axis)]);
    assert_eq!(
        correlation_csv(&result, "gyro_x"),
        "lag,acf,pacf,bound\n0,1.000000,1.000000,0.010000\n1,0.500000,-0.250000,0.010000\n"
    );
    assert_eq!(correlation_csv(&result, "gyro_y"), "lag,acf,pacf,bound\n");
}

#[test]
fn a_drive_is_line_by_line() {
    let mut result = Navigate {
        bias_model: "arma".into(),
        mounting: Some("roll 1 deg".into()),
        findings: vec![Finding::Diverged { time: 9.0 }],
        rms_error: Some(by_name(&[("horizontal_m", 1.5), ("north_m", 0.25)])),
        compared_samples: Some(100),
        nees_per_dof: by_name(&[("gyro_bias", 1.25), ("position", 0.5)]),
        ..Navigate::default()
    };
    let s = &mut result.summary;
    s.alignment = "attitude as specified".into();
    s.samples = 1000;
    s.started = 1.5.into();
    s.ended = 11.5.into();
    s.align_samples = 50;
    s.fixes_before = 2;
    s.fixes = 10;
    s.innovations[Aid::Position].updates = 10;
    s.innovations[Aid::Position].nis_sum = 60.0;
    s.innovations[Aid::Position].dof_sum = 30;
    s.innovations[Aid::Position].rejected = 1;
    s.innovations[Aid::Position].weakened = 3;
    // All of the velocities were rejected.
    s.innovations[Aid::Velocity].rejected = 4;
    s.innovations[Aid::Barometer].updates = 5;
    s.innovations[Aid::Barometer].nis_sum = 2.5;
    s.innovations[Aid::Barometer].dof_sum = 5;
    s.innovations[Aid::Odometer].rejected = 5;
    s.louder = Some([1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(Into::into));
    s.parameters = [(
        "OdometerScale".to_owned(),
        Parameter {
            value: numbers(&[0.02]),
            std: numbers(&[0.001]),
        },
    )]
    .into();
    assert_eq!(
        navigate(&result),
        "not usable: the solution diverged at 9 s and ends there
causal: each instant uses only what came before it, as while driving
estimated mounting: roll 1 deg
bias model arma; attitude as specified
navigated 1000 samples from 1.500 s to 11.500 s, after 50 samples and 2 fixes for alignment
10 fixes used
position: NIS per degree of freedom 2.00 (1 if the model is correct); 1 rejected, 3 down-weighted
velocity: NIS per degree of freedom none (1 if the model is correct); 4 rejected, 0 down-weighted
barometer: 5 updates, NIS per degree of freedom 0.50
white noise above the band of motion: gyro x, y, z 1.00, 2.00, 3.00, accelerometer 4.00, 5.00, 6.00 times the model's; the filter uses it
odometer scale factor: 2.00 ± 0.10 %
RMS error against the truth at 100 samples: north_m 0.2500, horizontal_m 1.5000
NEES per degree of freedom against the truth, once a second (1 if the covariance is correct): position 0.50, gyro bias 1.25"
    );
    let empty = navigate(&Navigate::default());
    assert!(
        !empty.contains("position") && !empty.contains("NEES"),
        "{empty}"
    );
}
