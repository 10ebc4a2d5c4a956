//! The shaping filters that a model file makes, against the closed forms.

use undrift_nav::shaping::ShapingFilter;
use undrift_noise::bias_model::UNIT_ROOT_TAU;
use undrift_noise::{Arma, AxisModel, BiasModel, GaussMarkov, ImuModel, ModelError};

const T: f64 = 0.005;
const WHITE: f64 = 5.8e-4;
const SIGMA: f64 = 1.2e-4;
const TAU: f64 = 100.0;

fn gauss_markov_axis() -> AxisModel {
    AxisModel {
        turn_on: 0.05,
        white: Some(WHITE),
        instability: vec![GaussMarkov {
            sigma: SIGMA,
            tau_s: TAU,
        }],
        ..AxisModel::default()
    }
}

fn arma_axis(ar: &[f64], ma: &[f64]) -> AxisModel {
    let arma = Arma {
        ar: ar.to_vec(),
        ma: ma.to_vec(),
        sigma: 0.008,
        rate_hz: 1.0 / T,
    };
    AxisModel {
        arma: Some(arma),
        ..AxisModel::default()
    }
}

fn lags<const N: usize>(filter: &ShapingFilter) -> [f64; N] {
    let mut lags = [0.0; N];
    filter.autocovariance(&mut lags);
    lags
}

#[track_caller]
fn near(a: f64, b: f64, relative: f64) {
    assert!((a - b).abs() <= relative * b.abs(), "{a} {b}");
}

#[test]
fn names_go_both_ways() {
    for model in BiasModel::ALL {
        assert_eq!(model.name().parse(), Ok(model));
    }
    assert!(
        "kalman"
            .parse::<BiasModel>()
            .unwrap_err()
            .to_string()
            .contains("gauss-markov")
    );
    assert_eq!(format!("{:>8}|", BiasModel::Ar), "      ar|");
}

#[test]
fn white_plus_gauss_markov_is_exactly_arma11() {
    let axis = AxisModel {
        turn_on: 0.0,
        ..gauss_markov_axis()
    };
    let sum: [f64; 100] = lags(&axis.shaping(BiasModel::GaussMarkov, T).unwrap());
    let arma = axis.shaping(BiasModel::Arma, T).unwrap();
    assert_eq!(arma.order, 1);
    // One noise: q r = s².
    near(arma.q[0][0] * arma.r, arma.s[0] * arma.s[0], 1e-14);
    for (ours, exact) in lags::<100>(&arma).into_iter().zip(sum) {
        near(ours, exact, 1e-10);
    }
    // The same by the Riccati recursion of the filters' own module.
    let riccati = axis
        .shaping(BiasModel::GaussMarkov, T)
        .unwrap()
        .innovations_form()
        .unwrap();
    near(arma.s[0], riccati.s[0], 1e-9);
    near(arma.r, riccati.r, 1e-13);
}

#[test]
fn innovations_keep_their_digits_for_a_very_slow_weak_bias() {
    // q/r = 1e-17: φ − θ is below rounding, the gain is not. Gain² ≈ q/r, gain = √q/r for a walk.
    let axis = AxisModel {
        white: Some(1.0),
        random_walk: Some(1e-8 / T.sqrt()),
        ..AxisModel::default()
    };
    let arma = axis.shaping(BiasModel::Arma, T).unwrap();
    let (q, r): (f64, f64) = (1e-16, 1.0 / T);
    near(arma.s[0] / arma.r, (q / r).sqrt(), 1e-6);
    let axis = AxisModel {
        random_walk: None,
        instability: vec![GaussMarkov {
            sigma: 1e-9,
            tau_s: 1e3,
        }],
        ..axis
    };
    let arma = axis.shaping(BiasModel::Arma, T).unwrap();
    // Far below the white noise: p is nearly Σ, gain Σ/r.
    near(arma.s[0] / arma.r, 1e-18 / r, 1e-4);
}

#[test]
fn white_plus_random_walk_has_a_unit_root_and_starts_at_the_turn_on() {
    let k = 3e-6;
    let axis = AxisModel {
        turn_on: 0.05,
        white: Some(WHITE),
        random_walk: Some(k),
        ..AxisModel::default()
    };
    let arma = axis.shaping(BiasModel::Arma, T).unwrap();
    assert_eq!(
        (arma.order, arma.f[0][0], arma.p0[0][0]),
        (1, 1.0, 0.05 * 0.05)
    );
    let theta = 1.0 - arma.s[0] / arma.r;
    // docs/theory.md: q = (1 − θ)²σ², r = θσ².
    near((1.0 - theta).powi(2) * arma.r, k * k * T, 1e-10);
    near(theta * arma.r, WHITE * WHITE / T, 1e-12);
    let walk = axis.shaping(BiasModel::RandomWalk, T).unwrap();
    assert_eq!(
        (walk.order, walk.s[0], walk.p0[0][0]),
        (1, 0.0, 0.05 * 0.05)
    );
    near(walk.q[0][0], k * k * T, 1e-14);
}

#[test]
fn three_terms_stay_a_sum() {
    let axis = AxisModel {
        random_walk: Some(1e-6),
        ..gauss_markov_axis()
    };
    let arma = axis.shaping(BiasModel::Arma, T).unwrap();
    // Gauss-Markov, and a random walk that carries the turn-on constant.
    assert_eq!(
        (arma.order, arma.f[1][1], arma.p0[1][1]),
        (2, 1.0, 0.05 * 0.05)
    );
    let walk = axis.shaping(BiasModel::RandomWalk, T).unwrap();
    near(walk.q[0][0], (1e-12 + 2.0 * SIGMA * SIGMA / TAU) * T, 1e-13);
}

#[test]
fn gauss_markov_has_a_constant_of_its_own() {
    let filter = gauss_markov_axis()
        .shaping(BiasModel::GaussMarkov, T)
        .unwrap();
    assert_eq!(
        (filter.order, filter.f[1][1], filter.p0[1][1]),
        (2, 1.0, 0.05 * 0.05)
    );
    near(filter.p0[0][0], SIGMA * SIGMA, 1e-14);
    near(filter.r, WHITE * WHITE / T, 1e-14);
    let white = gauss_markov_axis().shaping(BiasModel::White, T).unwrap();
    assert_eq!((white.order, white.r), (0, filter.r));
}

#[test]
fn terms_come_out_of_an_arma11() {
    // The ARMA of known terms gives the terms back.
    let known = AxisModel {
        turn_on: 0.0,
        ..gauss_markov_axis()
    };
    let arma = known
        .shaping(BiasModel::Arma, T)
        .unwrap()
        .arma_coefficients()
        .unwrap();
    let axis = AxisModel {
        arma: Some(Arma {
            ar: vec![arma.phi[0]],
            ma: vec![arma.theta[0]],
            sigma: arma.sigma,
            rate_hz: 1.0 / T,
        }),
        ..AxisModel::default()
    };
    // φ − θ = 5e-6 is stored to 2e-11, 1 − φ to 1e-12.
    near(axis.white_density(), WHITE, 1e-9);
    let (ours, exact) = (
        axis.shaping(BiasModel::GaussMarkov, T).unwrap(),
        known.shaping(BiasModel::GaussMarkov, T).unwrap(),
    );
    near(ours.q[0][0], exact.q[0][0], 1e-9);
    near(ours.f[0][0], exact.f[0][0], 1e-15);
    let walk = axis.shaping(BiasModel::RandomWalk, T).unwrap();
    near(walk.q[0][0], 2.0 * SIGMA * SIGMA / TAU * T, 1e-9);
    // At another rate: the white density and the process stay.
    let slow = axis.shaping(BiasModel::Arma, 4.0 * T).unwrap();
    let direct: [f64; 50] = lags(&known.shaping(BiasModel::GaussMarkov, 4.0 * T).unwrap());
    for (ours, exact) in lags::<50>(&slow).into_iter().zip(direct) {
        near(ours, exact, 1e-8);
    }
}

#[test]
fn a_unit_root_gives_the_random_walk() {
    let axis = arma_axis(&[1.0], &[0.9994]);
    let walk = axis.shaping(BiasModel::RandomWalk, T).unwrap();
    near(walk.q[0][0], (0.0006f64 * 0.008).powi(2), 1e-11);
    near(walk.r, 0.9994 * 0.008 * 0.008, 1e-14);
    // It has no correlation time: gauss-markov is the random walk too.
    assert_eq!(axis.shaping(BiasModel::GaussMarkov, T).unwrap(), walk);
}

#[test]
fn paper_is_its_equations_to_the_letter() {
    let axis = AxisModel {
        turn_on: 0.05,
        paper_sigma: Some(1e-4),
        ..arma_axis(&[1.0], &[0.9994])
    };
    let paper = axis.shaping(BiasModel::Paper, T).unwrap();
    assert_eq!(
        (paper.order, paper.f[0][0], paper.h[0], paper.r, paper.s[0]),
        (1, 1.0, 1.0, 0.0, 0.0)
    );
    near(paper.q[0][0], (1.0 + 0.9994 * 0.9994) * 1e-8, 1e-14);
    near(paper.p0[0][0], 0.0025, 1e-14);
    // σ is the white noise per sample where none is given.
    let axis = AxisModel {
        paper_sigma: None,
        white: Some(WHITE),
        ..axis
    };
    let paper = axis.shaping(BiasModel::Paper, T).unwrap();
    near(
        paper.q[0][0],
        (1.0 + 0.9994 * 0.9994) * WHITE * WHITE / T,
        1e-14,
    );
    // From the terms: φ = exp(−T/τ), and θ from the gain of the exact model.
    let paper = gauss_markov_axis().shaping(BiasModel::Paper, T).unwrap();
    let arma = AxisModel {
        turn_on: 0.0,
        ..gauss_markov_axis()
    }
    .shaping(BiasModel::Arma, T)
    .unwrap();
    let theta = arma.f[0][0] - arma.s[0] / arma.r;
    near(paper.f[0][0], (-T / TAU).exp(), 1e-15);
    near(
        paper.q[0][0],
        (1.0 + theta * theta) * WHITE * WHITE / T,
        1e-9,
    );
    // A higher order keeps its companion matrix.
    let paper = arma_axis(&[1.2, -0.4], &[0.5])
        .shaping(BiasModel::Paper, T)
        .unwrap();
    assert_eq!(
        (paper.order, paper.f[0][0], paper.f[1][0], paper.f[0][1]),
        (2, 1.2, -0.4, 1.0)
    );
    near(paper.q[0][0], 1.25 * 0.008 * 0.008, 1e-13);
}

#[test]
fn ar_is_the_best_linear_predictor() {
    // An AR(2) is its own.
    let own = arma_axis(&[1.2, -0.4], &[])
        .shaping(BiasModel::Ar, T)
        .unwrap();
    near(own.f[0][0], 1.2, 1e-12);
    near(own.f[1][0], -0.4, 1e-12);
    near(own.r, 0.008 * 0.008, 1e-12);
    // White plus Gauss-Markov by hand: R φ = ρ of order two.
    let axis = gauss_markov_axis();
    let g: [f64; 3] = lags(
        &AxisModel {
            turn_on: 0.0,
            ..axis.clone()
        }
        .shaping(BiasModel::GaussMarkov, T)
        .unwrap(),
    );
    let det = g[0] * g[0] - g[1] * g[1];
    let ar = axis.shaping(BiasModel::Ar, T).unwrap();
    assert_eq!(ar.order, 3);
    near(ar.f[0][0], g[1] * (g[0] - g[2]) / det, 1e-10);
    near(ar.f[1][0], (g[0] * g[2] - g[1] * g[1]) / det, 1e-10);
    // A random walk counts as a Gauss-Markov process over an hour, of whatever order it comes.
    let k = 3e-6;
    let walk = AxisModel {
        white: Some(WHITE),
        random_walk: Some(k),
        ..AxisModel::default()
    };
    let hour = GaussMarkov {
        sigma: k * (UNIT_ROOT_TAU / 2.0).sqrt(),
        tau_s: UNIT_ROOT_TAU,
    };
    let same = AxisModel {
        random_walk: None,
        instability: vec![hour],
        ..walk.clone()
    };
    assert_eq!(
        walk.shaping(BiasModel::Ar, T).unwrap(),
        same.shaping(BiasModel::Ar, T).unwrap()
    );
    let unit_root = arma_axis(&[1.5, -0.5], &[0.9])
        .shaping(BiasModel::Ar, T)
        .unwrap();
    assert!(unit_root.f[0][0].is_finite() && unit_root.r > 0.0);
}

#[test]
fn what_cannot_be_made_is_an_error() {
    // The short memory of a real gyro at 100 Hz: no slow part in it.
    let axis = arma_axis(&[-0.19], &[-0.51]);
    for model in [BiasModel::GaussMarkov, BiasModel::RandomWalk] {
        let error = axis.shaping(model, T).unwrap_err();
        assert!(
            matches!(error, ModelError::Missing { .. })
                && error.to_string().contains("bias_instability"),
            "{error}"
        );
    }
    assert_eq!(axis.shaping(BiasModel::Arma, T).unwrap().order, 1);
    assert!(
        axis.shaping(BiasModel::Arma, 2.0 * T)
            .unwrap_err()
            .to_string()
            .contains("another sample rate")
    );
    // Time stamps give the rate to 0.1 % at best: that is the same rate.
    assert!(axis.shaping(BiasModel::Arma, T * 1.0002).is_ok());
    let mut imu = ImuModel::preset("adis16405").unwrap();
    imu.accel[1] = axis;
    let error = imu
        .shaping(BiasModel::RandomWalk, T)
        .unwrap_err()
        .to_string();
    assert!(
        error.starts_with("accel_y: the random-walk model needs"),
        "{error}"
    );
    for interval in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for model in BiasModel::ALL {
            assert!(imu.shaping(model, interval).is_err());
        }
    }
    // White noise alone makes every model.
    let white = AxisModel {
        white: Some(WHITE),
        ..AxisModel::default()
    };
    for model in BiasModel::ALL {
        let filter = white.shaping(model, T).unwrap();
        near(
            lags::<1>(&filter)[0].max(filter.q[0][0]),
            WHITE * WHITE / T,
            1e-14,
        );
    }
}

#[test]
fn every_preset_makes_every_model() {
    for name in ImuModel::preset_names() {
        let imu = ImuModel::preset(name).unwrap();
        for model in BiasModel::ALL {
            for rate in [50.0, 100.0, 200.0, 1000.0] {
                let filters = imu.shaping(model, 1.0 / rate).unwrap();
                assert!(
                    filters
                        .iter()
                        .all(|f| f.interval == 1.0 / rate && f.q[0][0] >= 0.0)
                );
            }
        }
    }
}
