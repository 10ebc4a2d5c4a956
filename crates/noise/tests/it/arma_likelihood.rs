//! Exact likelihoods at given coefficients against R's `arima(fixed = …)`, and the two ways the
//! crate has of computing them against each other.

use crate::common::{number, numbers, reference, series};
use undrift_noise::arma::{ArmaError, Mean, log_likelihood};

/// R and the reference write the moving-average part with the opposite sign.
fn flipped(ma: &[f64]) -> Vec<f64> {
    ma.iter().map(|v| -v).collect()
}

#[test]
fn given_coefficients_give_the_reference_likelihood() {
    let Some(reference) = reference() else { return };
    let x = series(&reference, "z100k");
    let mut compared = 0;
    for list in ["arma11_loglik_at", "arma21_loglik_at", "arma43_loglik_at"] {
        for case in reference["R_reference"]["z100k"][list].as_array().unwrap() {
            let (p, q) = (number(&case["p"]) as usize, number(&case["q"]) as usize);
            let fixed = numbers(&case["fixed"]);
            let at = log_likelihood(
                &x,
                &fixed[..p],
                &flipped(&fixed[p..p + q]),
                Mean::Known(0.0),
                false,
            )
            .unwrap();
            // R stops its filter's variance when it changes by less than 1e-2 of a tolerance of
            // its own; its digits are printed to 15: 1e-6 of 370 000 is the folder's tolerance.
            let gap = at.log_likelihood - number(&case["loglik"]);
            assert!(gap.abs() < 1e-6, "{list} {fixed:?}: {gap:e}");
            let variance = at.variance / number(&case["sigma2"]) - 1.0;
            assert!(variance.abs() < 1e-10, "{list} {fixed:?}: {variance:e}");
            compared += 1;
        }
    }
    assert_eq!(compared, 11);
}

fn noise(n: usize, seed: u64) -> Vec<f64> {
    let mut s = seed;
    (0..n)
        .map(|_| {
            s = s
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (s >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        })
        .collect()
}

fn with_a_slow_part(n: usize) -> Vec<f64> {
    let (w, v) = (noise(n, 3), noise(n, 4));
    let mut slow = 0.0;
    (0..n)
        .map(|t| {
            slow = 0.995 * slow + 0.1 * w[t];
            slow + v[t] + 2.0
        })
        .collect()
}

const CASES: [(&[f64], &[f64]); 8] = [
    (&[], &[]),
    (&[0.9], &[]),
    (&[], &[0.6, -0.3]),
    (&[0.9999], &[0.9995]),
    (&[0.999_999], &[-0.5]),
    (&[1.5, -0.7], &[0.999_999]),
    (&[0.5, 0.2, -0.1, 0.05], &[-0.3, -0.2, -0.1]),
    (&[0.2], &[0.3, 0.1, -0.4, 0.2, 0.1]),
];

/// log N(x; 0, Σ) with the best σ², from the full covariance matrix: the definition.
fn by_definition(x: &[f64], phi: &[f64], theta: &[f64]) -> f64 {
    let n = x.len();
    // ψ weights and the autocovariance, summed far enough for roots up to 0.95.
    let far = 2000;
    let mut psi = vec![0.0; far];
    for k in 0..far {
        psi[k] = if k == 0 {
            1.0
        } else {
            let ar: f64 = (1..=phi.len().min(k))
                .map(|i| phi[i - 1] * psi[k - i])
                .sum();
            ar - theta.get(k - 1).copied().unwrap_or(0.0)
        };
    }
    let gamma: Vec<f64> = (0..n)
        .map(|lag| (lag..far).map(|k| psi[k] * psi[k - lag]).sum())
        .collect();
    let mut l = vec![vec![0.0; n]; n];
    let (mut log_determinant, mut squares) = (0.0, 0.0);
    let mut y = vec![0.0; n];
    for i in 0..n {
        for j in 0..=i {
            let below: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            let value: f64 = gamma[i - j] - below;
            l[i][j] = if i == j {
                value.sqrt()
            } else {
                value / l[j][j]
            };
        }
        let before: f64 = (0..i).map(|k| l[i][k] * y[k]).sum();
        y[i] = (x[i] - before) / l[i][i];
        squares += y[i] * y[i];
        log_determinant += 2.0 * l[i][i].ln();
    }
    let m = n as f64;
    -0.5 * (m * (std::f64::consts::TAU * squares / m).ln() + m + log_determinant)
}

#[test]
fn the_likelihood_is_the_multivariate_normal_one() {
    let x = noise(60, 9);
    for (phi, theta) in [
        (&[0.9][..], &[0.5][..]),
        (&[], &[0.6, -0.3]),
        (&[1.2, -0.5], &[0.9]),
        (&[0.5, 0.2, -0.1, 0.05], &[-0.3, -0.2, -0.1]),
    ] {
        let ours = log_likelihood(&x, phi, theta, Mean::Known(0.0), false).unwrap();
        let exact = by_definition(&x, phi, theta);
        // Rounding of a 60-by-60 factorisation.
        assert!(
            (ours.log_likelihood - exact).abs() < 1e-9,
            "{phi:?} {theta:?}"
        );
    }
}

#[test]
fn a_missing_last_sample_is_a_shorter_record() {
    let x = with_a_slow_part(3000);
    let mut longer = x.clone();
    longer.push(f64::NAN);
    for (phi, theta) in CASES {
        for mean in [Mean::Known(2.0), Mean::Estimated] {
            // Without a gap: the regression form; with one: the Kalman filter.
            let fast = log_likelihood(&x, phi, theta, mean, false).unwrap();
            let filter = log_likelihood(&longer, phi, theta, mean, false).unwrap();
            // Rounding of 3000 terms; where 1 − φ is 1e-6 the start's variance has ten digits.
            let gap = fast.log_likelihood - filter.log_likelihood;
            assert!(gap.abs() < 1e-7, "{phi:?} {theta:?} {mean:?} {gap:e}");
            let error = fast.mean_standard_error - filter.mean_standard_error;
            assert!(error.abs() <= 1e-6 * filter.mean_standard_error);
            assert!((fast.mean - filter.mean).abs() <= 1e-6 * filter.mean_standard_error.max(1e-6));
        }
    }
}

#[test]
fn roots_that_crowd_at_one_keep_their_digits() {
    // AR roots 0.99995 ± 0.00016i, MA roots 0.999996, 0.9994 and 0.81: a state of huge variance, seen
    // through responses that are nearly parallel.
    let phi = [
        2.814587399694234,
        -2.6261420245828524,
        0.8085046469376097,
        0.0030499730172869107,
    ];
    let theta = [2.8140684372908704, -2.6282461089088605, 0.8141776712194314];
    for (n, tolerance) in [(3000, 1e-5), (60_000, 0.1)] {
        let x = with_a_slow_part(n);
        let mut longer = x.clone();
        longer.push(f64::NAN);
        for mean in [Mean::Known(2.0), Mean::Estimated] {
            let fast = log_likelihood(&x, &phi, &theta, mean, false).unwrap();
            let filter = log_likelihood(&longer, &phi, &theta, mean, false).unwrap();
            let gap = fast.log_likelihood - filter.log_likelihood;
            // Twelve digits of the variance of the start are lost, and more with the length.
            assert!(gap.abs() < tolerance, "{n} {mean:?} {gap:e}");
        }
    }
}

#[test]
fn missing_samples_are_integrated_out() {
    // AR(1) seen at every third sample is AR(1) with φ³: exact, and easy to say.
    let phi = 0.9f64;
    let x = noise(300, 5);
    let mut sparse = vec![f64::NAN; 3 * x.len()];
    for (t, value) in x.iter().enumerate() {
        sparse[3 * t] = *value;
    }
    let dense = log_likelihood(&x, &[phi.powi(3)], &[], Mean::Known(0.0), false).unwrap();
    let gaps = log_likelihood(&sparse, &[phi], &[], Mean::Known(0.0), false).unwrap();
    assert!((dense.log_likelihood - gaps.log_likelihood).abs() < 1e-9);
    // The innovations' variances are those of one and of three steps.
    let ratio = dense.variance / gaps.variance;
    assert!((ratio - (1.0 + phi.powi(2) + phi.powi(4))).abs() < 1e-9);
}

#[test]
fn a_unit_root_is_the_likelihood_of_the_differences() {
    let x = with_a_slow_part(2000);
    let d: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    for (rest, theta) in [
        (&[][..], &[0.7][..]),
        (&[0.5], &[0.9]),
        (&[0.3, -0.4], &[0.2, 0.1]),
    ] {
        let mut ar = rest.to_vec();
        ar.push(0.0);
        for (i, c) in rest.iter().enumerate() {
            ar[i + 1] -= c;
        }
        ar[0] += 1.0;
        let diffuse = log_likelihood(&x, &ar, theta, Mean::Known(0.0), true).unwrap();
        let differences = log_likelihood(&d, rest, theta, Mean::Known(0.0), false).unwrap();
        assert_eq!(diffuse.observations, d.len());
        let gap = diffuse.log_likelihood - differences.log_likelihood;
        assert!(gap.abs() < 1e-8, "{rest:?} {theta:?} {gap:e}");
    }
}

#[test]
fn scale_only_adds_the_logarithm_of_the_unit() {
    let x = with_a_slow_part(5000);
    let scaled: Vec<f64> = x.iter().map(|v| v * 1e-9).collect();
    let a = log_likelihood(&x, &[0.999], &[0.99], Mean::Estimated, false).unwrap();
    let b = log_likelihood(&scaled, &[0.999], &[0.99], Mean::Estimated, false).unwrap();
    let expected = a.log_likelihood + 5000.0 * 1e9f64.ln();
    assert!((b.log_likelihood - expected).abs() < 1e-7);
}

#[test]
fn bad_input_is_an_error() {
    let x = noise(50, 1);
    let at = |x: &[f64], ar: &[f64], ma: &[f64]| {
        log_likelihood(x, ar, ma, Mean::Estimated, false).unwrap_err()
    };
    assert_eq!(at(&x, &[1.0], &[]), ArmaError::NotStationary);
    assert_eq!(at(&x, &[f64::NAN], &[]), ArmaError::NotStationary);
    assert_eq!(at(&x, &[], &[1.1]), ArmaError::NotInvertible);
    assert_eq!(at(&[1.0; 50], &[0.5], &[]), ArmaError::Constant);
    assert_eq!(
        at(&[1.0, f64::INFINITY, 2.0, 3.0], &[], &[]),
        ArmaError::NotFinite
    );
    assert!(matches!(
        at(&[f64::NAN; 9], &[], &[]),
        ArmaError::TooShort { .. }
    ));
    assert!(matches!(at(&[], &[], &[]), ArmaError::TooShort { .. }));
    assert_eq!(at(&x, &[0.0; 30], &[]), ArmaError::OrderTooHigh);
    let unit = log_likelihood(&x, &[0.9], &[], Mean::Estimated, true);
    assert_eq!(unit.unwrap_err(), ArmaError::NotStationary);
}
