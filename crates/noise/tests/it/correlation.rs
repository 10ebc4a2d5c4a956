//! Correlations and portmanteau tests against statsmodels and R.

use crate::common::{close, names, near, number, numbers, reference, series, white_noise};
use undrift_noise::correlation::{
    Partial, autocorrelation, autocovariance, bartlett_bounds, partial_autocorrelation, white_bound,
};
use undrift_noise::screening::RecordError;
use undrift_noise::whiteness::portmanteau;

const SIMULATED: [&str; 7] = [
    "z100k", "f_arma21", "f_arma43", "f_ar1wn", "f_rw", "f_quant", "f_lap",
];

/// 1e-8 relative, and for values that are small by cancellation 1e-14 of the correlation at lag 0.
fn same(ours: &[f64], expected: &[f64], what: &str) {
    assert!(
        ours.len() == expected.len() && !expected.is_empty(),
        "{what}"
    );
    for (lag, (a, b)) in ours.iter().zip(expected).enumerate() {
        assert!(
            (a - b).abs() <= 1e-8 * b.abs() + 1e-14,
            "{what}, lag {lag}: {a:e} for {b:e}"
        );
    }
}

#[test]
fn correlations_are_those_of_statsmodels() {
    let Some(reference) = reference() else { return };
    for name in names() {
        let tests = if name == "z100k" {
            &reference["z100k"]["tests"]
        } else {
            &reference["classic"][name]["python_tests"]
        };
        let x = series(&reference, name);
        let expected = numbers(&tests["statsmodels.acf_adjustedFalse"]);
        same(
            &autocorrelation(&x, expected.len() - 1).unwrap(),
            &expected,
            name,
        );
        let expected = numbers(&tests["statsmodels.acovf_0_10"]);
        for (a, b) in autocovariance(&x, 10).unwrap().iter().zip(&expected) {
            close(*a, *b, 1e-8, name);
        }
        let methods = [
            (Partial::YuleWalker, "ywmle"),
            (Partial::YuleWalker, "ldbiased"),
            (Partial::YuleWalkerAdjusted, "ywadjusted"),
            (Partial::Burg, "burg"),
        ];
        for (method, key) in methods {
            let expected = numbers(&tests[format!("statsmodels.pacf_{key}")]);
            let ours = partial_autocorrelation(&x, expected.len() - 1, method).unwrap();
            same(&ours, &expected, &format!("{name} {key}"));
        }
    }
}

#[test]
fn correlations_are_those_of_r() {
    let Some(reference) = reference() else { return };
    for name in SIMULATED {
        let tests = &reference["R_reference"][name]["tests"];
        let x = series(&reference, name);
        let expected = numbers(&tests["acf"]);
        same(
            &autocorrelation(&x, expected.len() - 1).unwrap(),
            &expected,
            name,
        );
        let expected = numbers(&tests["pacf"]);
        same(
            &partial_autocorrelation(&x, expected.len(), Partial::YuleWalker).unwrap()[1..],
            &expected,
            name,
        );
    }
}

#[test]
fn many_lags_by_fft_equal_the_sums() {
    for (count, lags) in [
        (60usize, 59usize),
        (1000, 48),
        (1000, 999),
        (5000, 700),
        (70_000, 5000),
    ] {
        let x: Vec<f64> = white_noise(3, count)
            .iter()
            .scan(5.0, |s, e| {
                *s = 0.9 * *s + e;
                Some(*s + 100.0)
            })
            .collect();
        let mean = x.iter().sum::<f64>() / count as f64;
        let ours = autocovariance(&x, lags).unwrap();
        for lag in [0, 1, 2, lags / 2, lags - 1, lags] {
            let sum: f64 = (lag..count)
                .map(|t| (x[t] - mean) * (x[t - lag] - mean))
                .sum();
            near(
                ours[lag],
                sum / count as f64,
                1e-12 * ours[0],
                &format!("{count} {lag}"),
            );
        }
    }
}

#[test]
fn portmanteau_tests_are_those_of_statsmodels_and_r() {
    let Some(reference) = reference() else { return };
    for name in names() {
        let tests = if name == "z100k" {
            &reference["z100k"]["tests"]
        } else {
            &reference["classic"][name]["python_tests"]
        };
        let x = series(&reference, name);
        for (lags, expected) in tests["statsmodels.acorr_ljungbox"].as_object().unwrap() {
            let test = portmanteau(&x, &[lags.parse().unwrap()], 0).unwrap()[0];
            close(test.ljung_box, number(&expected["lb"]), 1e-8, name);
            close(test.box_pierce, number(&expected["bp"]), 1e-8, name);
            near(test.ljung_box_p, number(&expected["lb_p"]), 1e-6, name);
            near(test.box_pierce_p, number(&expected["bp_p"]), 1e-6, name);
        }
    }
    let z = series(&reference, "z100k");
    for (lags, expected) in reference["pitfalls"]["ljungbox_raw_z100k"]
        .as_object()
        .unwrap()
    {
        let test = portmanteau(&z, &[lags.parse().unwrap()], 0).unwrap()[0];
        close(test.ljung_box, number(&expected[0]), 1e-8, lags);
        near(test.ljung_box_p, number(&expected[1]), 1e-6, lags);
    }
    for name in SIMULATED {
        let tests = &reference["R_reference"][name]["tests"];
        let lags: Vec<usize> = numbers(&tests["ljung"][0])
            .iter()
            .map(|v| *v as usize)
            .collect();
        let ours = portmanteau(&series(&reference, name), &lags, 0).unwrap();
        for (k, expected) in numbers(&tests["ljung"][1]).iter().enumerate() {
            close(ours[k].ljung_box, *expected, 1e-8, name);
            near(
                ours[k].ljung_box_p,
                number(&tests["ljung"][2][k]),
                1e-6,
                name,
            );
        }
    }
}

#[test]
fn fitted_parameters_cost_degrees_of_freedom() {
    let x = white_noise(1, 500);
    let (free, fitted) = (
        portmanteau(&x, &[2, 10], 0).unwrap(),
        portmanteau(&x, &[2, 10], 2).unwrap(),
    );
    assert_eq!((free[1].freedom, fitted[1].freedom), (10, 8));
    assert!(fitted[1].ljung_box_p < free[1].ljung_box_p && fitted[0].ljung_box_p.is_nan());
    // Chi-squared with 2 degrees of freedom has the tail exp(−x/2).
    near(
        free[0].ljung_box_p,
        (-0.5 * free[0].ljung_box).exp(),
        1e-12,
        "tail",
    );
}

#[test]
fn bounds_hold_white_noise() {
    let x = white_noise(5, 20_000);
    let acf = autocorrelation(&x, 400).unwrap();
    let outside = acf[1..]
        .iter()
        .filter(|r| r.abs() > white_bound(x.len()))
        .count();
    // 5 % of 400, binomial sigma 4.4.
    assert!((7..=33).contains(&outside), "{outside}");
    let bounds = bartlett_bounds(&[1.0, 0.5, 0.0], 100);
    close(bounds[0], 0.195_996_398, 1e-8, "lag 1");
    close(bounds[1], 0.195_996_398 * 1.5f64.sqrt(), 1e-8, "lag 2");
}

#[test]
fn bad_records_are_errors() {
    assert_eq!(
        autocorrelation(&[1.0, 2.0], 5),
        Err(RecordError::TooShort { needed: 6, got: 2 })
    );
    assert_eq!(autocorrelation(&[1.0; 9], 5), Err(RecordError::Constant));
    assert!(
        autocorrelation(&[1.0, f64::NAN], 1).is_err() && autocovariance(&[], usize::MAX).is_err()
    );
    assert!(partial_autocorrelation(&[1.0; 9], 3, Partial::Burg).is_err());
    let alternating: Vec<f64> = (0..20).map(|k| f64::from(k % 2)).collect();
    for method in [
        Partial::YuleWalker,
        Partial::YuleWalkerAdjusted,
        Partial::Burg,
    ] {
        for lags in 0..20 {
            assert_eq!(
                partial_autocorrelation(&alternating, lags, method)
                    .unwrap()
                    .len(),
                lags + 1
            );
        }
    }
    assert!(portmanteau(&alternating, &[], 0).unwrap().is_empty());
    assert!(portmanteau(&alternating, &[30], 0).is_err());
}

/// An AR(2) about a mean, and its autocovariances by their sums.
fn with_sums(count: usize, lags: usize) -> (Vec<f64>, f64, Vec<f64>) {
    let (mut one, mut two) = (0.0, 0.0);
    let mut next = |drive: f64| {
        (one, two) = (0.9 * one - 0.5 * two + drive, one);
        4.0 + one
    };
    let x: Vec<f64> = white_noise(8, count).into_iter().map(&mut next).collect();
    let mean = x.iter().sum::<f64>() / count as f64;
    let sum = |lag: usize| -> f64 {
        let products = (lag..count).map(|t| (x[t] - mean) * (x[t - lag] - mean));
        products.sum()
    };
    let sums = (0..=lags).map(sum).collect();
    (x, mean, sums)
}

#[test]
fn few_lags_are_the_sums_across_the_blocks() {
    // Blocks of 2048 samples: shorter than one, whole ones, and one that the lags reach beyond.
    for (count, lags) in [(30, 29), (2048, 5), (4096, 47), (4100, 10), (5000, 0)] {
        let (x, _, sums) = with_sums(count, lags);
        let ours = autocovariance(&x, lags).unwrap();
        assert_eq!(ours.len(), lags + 1);
        for (ours, sum) in ours.iter().zip(&sums) {
            // Sums in another order.
            near(
                *ours,
                sum / count as f64,
                1e-12 * sums[0] / count as f64,
                "covariance",
            );
        }
        for (ours, sum) in autocorrelation(&x, lags).unwrap().iter().zip(&sums) {
            near(*ours, sum / sums[0], 1e-12, "correlation");
        }
    }
}

#[test]
fn partial_autocorrelations_are_the_last_coefficients_of_the_yule_walker_equations() {
    let (count, lags) = (200usize, 6);
    let (x, _, sums) = with_sums(count, lags);
    let adjusted = |lag: usize| sums[lag] / (count - lag) as f64;
    let biased = |lag: usize| sums[lag] / count as f64;
    let methods: [(Partial, &dyn Fn(usize) -> f64); 2] = [
        (Partial::YuleWalker, &biased),
        (Partial::YuleWalkerAdjusted, &adjusted),
    ];
    for (method, covariance) in methods {
        let found = partial_autocorrelation(&x, lags, method).unwrap();
        assert_eq!((found.len(), found[0]), (lags + 1, 1.0));
        for k in 1..=lags {
            let matrix = nalgebra::DMatrix::from_fn(k, k, |i, j| covariance(i.abs_diff(j)));
            let right = nalgebra::DVector::from_fn(k, |i, _| covariance(i + 1));
            let exact = matrix.lu().solve(&right).unwrap()[k - 1];
            near(found[k], exact, 1e-11, "partial");
        }
    }
}

#[test]
fn burgs_reflections_leave_the_least_errors_both_ways() {
    let (x, mean, _) = with_sums(200, 0);
    let found = partial_autocorrelation(&x, 5, Partial::Burg).unwrap();
    let mut ahead: Vec<f64> = x[1..].iter().map(|x| x - mean).collect();
    let mut back: Vec<f64> = x[..199].iter().map(|x| x - mean).collect();
    for reflection in &found[1..] {
        let pairs = || ahead.iter().zip(&back);
        let squares = |by: f64| -> f64 {
            pairs()
                .map(|(a, b)| (a - by * b).powi(2) + (b - by * a).powi(2))
                .sum()
        };
        // A parabola: its least is where it is the same on both sides.
        let sides = [-0.1, 0.1].map(|by| squares(reflection + by));
        close(sides[0], sides[1], 1e-11, "errors");
        assert!(squares(*reflection) < sides[0]);
        let next: (Vec<f64>, Vec<f64>) = pairs()
            .map(|(a, b)| (a - reflection * b, b - reflection * a))
            .unzip();
        // The error back is of one sample earlier.
        ahead = next.0[1..].to_vec();
        back = next.1[..next.1.len() - 1].to_vec();
    }
}

#[test]
fn portmanteau_statistics_are_their_sums() {
    let (x, _, sums) = with_sums(100, 6);
    let found = portmanteau(&x, &[6, 1, 3], 1).unwrap();
    for (test, lags) in found.iter().zip([6usize, 1, 3]) {
        assert_eq!((test.lags, test.freedom), (lags, lags - 1));
        let square = |k: usize| (sums[k] / sums[0]).powi(2);
        let box_pierce: f64 = (1..=lags).map(|k| 100.0 * square(k)).sum();
        let weighted = (1..=lags).map(|k| 100.0 * 102.0 * square(k) / (100.0 - k as f64));
        close(test.box_pierce, box_pierce, 1e-11, "Box-Pierce");
        close(test.ljung_box, weighted.sum(), 1e-11, "Ljung-Box");
        assert_eq!(test.ljung_box_p.is_nan(), lags == 1);
        assert_eq!(test.box_pierce_p.is_nan(), lags == 1);
        if lags == 3 {
            close(test.box_pierce_p, (-0.5 * box_pierce).exp(), 1e-9, "tail");
        }
    }
    // Bartlett's bound, by hand: 1 + 2 (¼ + 1/16).
    let bounds = bartlett_bounds(&[1.0, 0.5, -0.25, 0.1], 50);
    assert_eq!(bounds.len(), 3);
    close(
        bounds[2],
        1.959_963_984_540_054 * (1.625f64 / 50.0).sqrt(),
        1e-12,
        "bound",
    );
    close(white_bound(50), bounds[0], 1e-12, "of white noise");
}
