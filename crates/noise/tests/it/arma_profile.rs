//! Profile-likelihood intervals against those of scipy (`arma_profile.py`) and their limits.

use undrift_noise::arma::{ArmaError, FitOptions, Mean, Root, fit, profile_interval};

fn uniform(seed: u64) -> impl FnMut() -> f64 {
    let mut s = seed;
    move || {
        s = s
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (s >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }
}

fn slow_under_white(n: usize) -> Vec<f64> {
    let (mut slow, mut next) = (0.0, uniform(1));
    (0..n)
        .map(|_| {
            slow = 0.98 * slow + 0.3 * next();
            slow + next()
        })
        .collect()
}

fn zero_mean() -> FitOptions {
    FitOptions {
        mean: Mean::Known(0.0),
        ..FitOptions::default()
    }
}

#[test]
fn intervals_are_those_of_scipy() {
    let record = slow_under_white(500);
    let model = fit(&record, 1, 1, &zero_mean()).unwrap();
    assert!((model.log_likelihood + 157.332243980).abs() < 1e-5);
    for (root, estimate, low, high) in [
        (Root::Ar, -3.049845, -4.095624, -2.387052),
        (Root::Ma, -1.418446, -1.743162, -1.112130),
    ] {
        let found = profile_interval(&record, &model, root, 0.95).unwrap();
        // The fit stops within 1e-5 of the top: √(2e-5) standard errors.
        assert!((found.estimate - estimate).abs() < 0.005, "{found:?}");
        // A thousandth of the depth wanted.
        assert!((found.low - low).abs() < 0.003, "{found:?}");
        assert!((found.high - high).abs() < 0.003, "{found:?}");
        let c = 1.0 - estimate.exp();
        assert!(found.contains(c) && !found.contains(-0.9));
        // A surer interval is longer.
        let surer = profile_interval(&record, &model, root, 0.99).unwrap();
        assert!(surer.low < found.low && surer.high > found.high);
    }
}

#[test]
fn at_the_ends_the_likelihood_has_fallen_by_half_the_chi_square_point() {
    // Over θ by brute force.
    let record = slow_under_white(3000);
    let model = fit(&record, 1, 1, &FitOptions::default()).unwrap();
    let interval = profile_interval(&record, &model, Root::Ar, 0.95).unwrap();
    for end in [interval.low, interval.high] {
        let phi = -end.exp_m1();
        let best = (1..4000)
            .map(|k| f64::from(k) * 0.00025)
            .filter_map(|theta| {
                undrift_noise::arma::log_likelihood(
                    &record,
                    &[phi],
                    &[theta],
                    Mean::Estimated,
                    false,
                )
                .ok()
            })
            .fold(f64::NEG_INFINITY, |best, at| best.max(at.log_likelihood));
        let fallen = model.log_likelihood - best;
        // χ²(1) at 95 % is 3.841459; a thousandth of its root is allowed for.
        assert!((fallen - 0.5 * 3.841_459).abs() < 0.006, "{fallen}");
    }
}

#[test]
fn what_is_not_contradicted_is_open() {
    // The differences of white noise: θ = 1 is the truth.
    let mut next = uniform(5);
    let white: Vec<f64> = (0..401).map(|_| next()).collect();
    let record: Vec<f64> = white.windows(2).map(|w| w[1] - w[0]).collect();
    let model = fit(&record, 1, 1, &zero_mean()).unwrap();
    let theta = profile_interval(&record, &model, Root::Ma, 0.95).unwrap();
    assert_eq!(theta.low, f64::NEG_INFINITY);
    assert!(theta.contains(1.0 - 1e-9) && theta.high < -1.0, "{theta:?}");
    // White noise whose best pair is worth less than the χ²(1) point: φ = θ may be anywhere.
    let (record, model) = (1..20)
        .find_map(|seed| {
            let mut next = uniform(seed);
            let record: Vec<f64> = (0..400).map(|_| next()).collect();
            let model = fit(&record, 1, 1, &zero_mean()).unwrap();
            (model.pair_likelihood_ratio? < 3.8).then_some((record, model))
        })
        .unwrap();
    let phi = profile_interval(&record, &model, Root::Ar, 0.95).unwrap();
    assert_eq!((phi.low, phi.high), (f64::NEG_INFINITY, 2f64.ln()));
}

#[test]
fn missing_samples_are_taken() {
    let mut record = slow_under_white(600);
    for t in (0..600).step_by(10) {
        record[t] = f64::NAN;
    }
    let model = fit(&record, 1, 1, &FitOptions::default()).unwrap();
    let found = profile_interval(&record, &model, Root::Ar, 0.95).unwrap();
    assert!(found.contains(0.98) && !found.contains(0.2), "{found:?}");
}

#[test]
fn bad_input_is_an_error() {
    let record = slow_under_white(300);
    let model = fit(&record, 1, 1, &FitOptions::default()).unwrap();
    let bad = |level: f64| profile_interval(&record, &model, Root::Ar, level).unwrap_err();
    assert!(matches!(bad(0.0), ArmaError::BadOption(_)));
    assert!(matches!(bad(f64::NAN), ArmaError::BadOption(_)));
    let other = profile_interval(&record[1..], &model, Root::Ar, 0.95);
    assert!(matches!(other, Err(ArmaError::BadOption(_))));
    let higher = fit(&record, 2, 1, &FitOptions::default()).unwrap();
    assert!(profile_interval(&record, &higher, Root::Ar, 0.95).is_err());
}
