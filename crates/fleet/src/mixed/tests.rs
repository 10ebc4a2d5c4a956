//! Against statsmodels and dense matrices (`testdata/golden/mixed.py`), and against closed forms.

use super::{
    Contrast, Grouping, Nested,
    fit::{quantile_95, starts, two_sided},
    sums::Sums,
};
use nalgebra::DMatrix;
use serde::Deserialize;

#[derive(Deserialize)]
struct Golden {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    unit: Vec<usize>,
    log: Vec<usize>,
    x: Vec<Vec<f64>>,
    y: Vec<f64>,
    mixedlm: MixedLm,
    variances: [f64; 3],
    beta: Vec<f64>,
    standard_error: Vec<f64>,
    freedom: Vec<f64>,
    predicted: Vec<f64>,
    prediction_variance: Vec<f64>,
}

#[derive(Deserialize)]
struct MixedLm {
    variances: [f64; 3],
    beta: Vec<f64>,
    standard_error: Vec<f64>,
}

fn golden() -> Vec<Case> {
    let text = include_str!("../../../../testdata/golden/mixed.json");
    serde_json::from_str::<Golden>(text).unwrap().cases
}

fn nested(case: &Case) -> Nested {
    let mut nested = Nested::new(case.x[0].len());
    let last = *case.unit.last().unwrap();
    for unit in 0..=last {
        let mut logs: Vec<Vec<(Vec<f64>, f64)>> = Vec::new();
        let mut open = usize::MAX;
        for k in (0..case.y.len()).filter(|k| case.unit[*k] == unit) {
            if case.log[k] != open {
                open = case.log[k];
                logs.push(Vec::new());
            }
            let row = (case.x[k].clone(), case.y[k]);
            logs.last_mut().unwrap().push(row);
        }
        nested.add(&logs);
    }
    nested
}

fn close(ours: f64, theirs: f64, tolerance: f64) {
    let scale = theirs.abs().max(1e-3);
    assert!(
        (ours - theirs).abs() < tolerance * scale,
        "{ours} is not {theirs}"
    );
}

#[test]
fn as_statsmodels_and_dense_matrices() {
    for case in golden() {
        let nested = nested(&case);
        let fit = nested.fit(None).unwrap();
        let variances = [1.0, fit.ratios[0], fit.ratios[1]].map(|ratio| fit.variance * ratio);
        // The criterion is flat at its minimum: its rounding, 1e-13 of some hundred, is 1e-5 of a variance.
        for (ours, theirs) in variances.into_iter().zip(case.variances) {
            close(ours, theirs, 1e-4);
        }
        // MixedLM ends its search there; near zero it stays on this side of it.
        for (ours, theirs) in variances.into_iter().zip(case.mixedlm.variances) {
            assert!(
                (ours - theirs).abs() < 1e-3 * theirs + 1e-4,
                "{ours} {theirs}"
            );
        }
        for k in 0..case.beta.len() {
            let found = fit.contrast(&nested, &[(k, 1.0)]).unwrap();
            close(found.estimate, case.beta[k], 1e-4);
            close(found.estimate, case.mixedlm.beta[k], 2e-3);
            close(found.standard_error, case.standard_error[k], 1e-4);
            // At a variance of zero MixedLM inverts a curvature that has no inverse.
            if case.variances[2] > 0.0 {
                close(found.standard_error, case.mixedlm.standard_error[k], 5e-3);
            }
            // By differences and the observed curvature here, by traces and the expected one there.
            let between = k == 4;
            let theirs = if between {
                case.freedom[k].min(nested.between_freedom(&fit))
            } else {
                case.freedom[k]
            };
            close(found.freedom, theirs, 0.15);
        }
        let predicted = nested.predicted(fit.ratios, &fit.profile);
        for (unit, (mean, square)) in predicted.into_iter().enumerate() {
            close(mean, case.predicted[unit], 1e-3);
            close(square, case.prediction_variance[unit], 1e-3);
        }
    }
}

/// The sums by kinds of logs against matrices of the size of the rows; what is set aside has a column of its own
/// there.
#[test]
fn sums_are_those_of_dense_matrices() {
    const UNIT: usize = 3;
    const LOG: usize = 30;
    for (case, aside) in golden()
        .iter()
        .flat_map(|case| [(case, false), (case, true)])
    {
        let mut nested = nested(case);
        nested.set_aside(Grouping::Unit, UNIT, aside);
        nested.set_aside(Grouping::Log, LOG, aside);
        let sums = Sums::of(&nested);
        let rows = case.y.len();
        let alike = |of: &[usize]| DMatrix::from_fn(rows, rows, |i, j| f64::from(of[i] == of[j]));
        let xy = DMatrix::from_fn(rows, case.x[0].len() + 1, |i, j| {
            *case.x[i].get(j).unwrap_or(&case.y[i])
        });
        let own = DMatrix::from_fn(rows, 2, |i, j| {
            f64::from([case.unit[i] == UNIT, case.log[i] == LOG][j])
        });
        for [of_log, of_unit] in [[0.0, 0.0], [0.7, 0.0], [0.0, 1.3], [0.4, 2.5], [30.0, 1e-3]] {
            let eye = DMatrix::<f64>::identity(rows, rows);
            let v = eye + of_log * alike(&case.log) + of_unit * alike(&case.unit);
            let mut determinant = v.determinant().ln();
            let mut inverse = v.try_inverse().unwrap();
            if aside {
                let inner = own.transpose() * &inverse * &own;
                determinant += inner.determinant().ln();
                let outer = &inverse * &own;
                inverse -= &outer * inner.try_inverse().unwrap() * outer.transpose();
            }
            let expected = xy.transpose() * inverse * &xy;
            let (found, of_found) = sums.weighted([of_log, of_unit]);
            close(of_found, determinant, 1e-9);
            for i in 0..xy.ncols() {
                for j in 0..=i {
                    let scale = (expected[(i, i)] * expected[(j, j)]).sqrt();
                    let error = (found[(i, j)] - expected[(i, j)]).abs();
                    assert!(error < 1e-9 * scale, "{i} {j}: {error} of {scale}");
                }
            }
        }
    }
}

/// Rows of units with the same number of logs of one row each; `y` by unit and log.
fn one_way(y: &[Vec<f64>]) -> Nested {
    let mut nested = Nested::new(1);
    for logs in y {
        let logs: Vec<_> = logs.iter().map(|y| vec![(vec![1.0], *y)]).collect();
        nested.add(&logs);
    }
    nested
}

const BALANCED: [[f64; 3]; 6] = [
    [1.1, 1.3, 0.9],
    [2.0, 1.7, 1.9],
    [0.4, 0.7, 0.2],
    [1.5, 1.2, 1.6],
    [3.0, 2.6, 3.1],
    [0.9, 1.1, 1.4],
];

/// Of balanced data REML is the analysis of variance.
#[test]
fn balanced_data_have_a_closed_form() {
    let y: Vec<Vec<f64>> = BALANCED.iter().map(|logs| logs.to_vec()).collect();
    let nested = one_way(&y);
    let fit = nested.fit(None).unwrap();
    let means: Vec<f64> = y
        .iter()
        .map(|logs| logs.iter().sum::<f64>() / 3.0)
        .collect();
    let all = means.iter().sum::<f64>() / 6.0;
    let between = 3.0 * means.iter().map(|m| (m - all).powi(2)).sum::<f64>() / 5.0;
    let inside = y.iter().zip(&means);
    let inside = inside.map(|(logs, m)| logs.iter().map(|y| (y - m).powi(2)).sum::<f64>());
    let inside = inside.sum::<f64>() / 12.0;
    // As above: the minimum is flat.
    close(fit.variance, inside, 1e-5);
    close(fit.variance * fit.ratios[1], (between - inside) / 3.0, 1e-5);
    let mean = fit.contrast(&nested, &[(0, 1.0)]).unwrap();
    close(mean.estimate, all, 1e-9);
    close(mean.standard_error, (between / 18.0).sqrt(), 1e-5);
    // Second derivatives by differences of 0.01: the next term is its square.
    close(mean.freedom, 5.0, 1e-4);
}

/// A unit set aside is compared with the others as Student's t of a new value: with the closed form, and the same as
/// from the fit that contains it.
#[test]
fn a_unit_against_the_others() {
    let y: Vec<Vec<f64>> = BALANCED.iter().map(|logs| logs.to_vec()).collect();
    let mut nested = one_way(&y);
    let within = nested.unit_shifts(&nested.fit(None).unwrap())[4].unwrap();
    nested.set_aside(Grouping::Unit, 4, true);
    let fit = nested.fit(None).unwrap();
    let without = nested.unit_shifts(&fit)[4].unwrap();
    let means: Vec<f64> = y
        .iter()
        .map(|logs| logs.iter().sum::<f64>() / 3.0)
        .collect();
    let others: Vec<f64> = [0, 1, 2, 3, 5].map(|k| means[k]).to_vec();
    let middle = others.iter().sum::<f64>() / 5.0;
    let square = others.iter().map(|m| (m - middle).powi(2)).sum::<f64>() / 4.0;
    close(without.estimate, means[4] - middle, 1e-6);
    close(without.spread, (square * 1.2).sqrt(), 1e-5);
    assert!((without.freedom - 4.0).abs() < 1e-9);
    let t = without.estimate / without.spread;
    // The variance within units is that of five there and six here; it cancels in balanced data.
    close(within.probability, without.probability, 1e-4);
    close(without.probability, super::fit::two_sided(t, 4.0), 1e-12);
}

#[test]
fn aliased_columns_are_not_estimated() {
    let mut nested = Nested::new(3);
    for unit in 0..4 {
        let rows = |log: usize| {
            let y = 1.0 + 0.1 * (unit * 7 % 5) as f64 + 0.05 * (log * 3 % 4) as f64;
            vec![(vec![1.0, 25.0, log as f64], y)]
        };
        nested.add(&(0..4).map(rows).collect::<Vec<_>>());
    }
    let fit = nested.fit(None).unwrap();
    assert_eq!(fit.contrast(&nested, &[(1, 1.0)]), None);
    assert!(fit.contrast(&nested, &[(2, 1.0)]).is_some());
    assert_eq!(fit.contrast(&nested, &[(9, 1.0)]), None);
    // Rows without scatter, or too few of them, have no variance.
    assert!(
        one_way(&[vec![1.0, 1.0], vec![1.0, 1.0]])
            .fit(None)
            .is_none()
    );
    assert!(one_way(&[vec![1.0]]).fit(None).is_none());
    assert!(Nested::new(0).fit(None).is_none());
}

#[test]
fn from_a_similar_fit_only_the_edges_are_looked_at() {
    let all = starts([true, true], false);
    assert_eq!(all.len(), 25);
    let edges = starts([true, true], true);
    assert_eq!(edges.len(), 9);
    for pair in all {
        assert_eq!(edges.contains(&pair), pair[0] == 0.0 || pair[1] == 0.0);
    }
    for near in [false, true] {
        assert_eq!(starts([false, false], near), [[0.0, 0.0]]);
        assert!(
            starts([true, false], near)
                .iter()
                .all(|pair| pair[1] == 0.0)
        );
        assert!(
            starts([false, true], near)
                .iter()
                .all(|pair| pair[0] == 0.0)
        );
        assert_eq!(starts([true, false], near).len(), 5);
        assert_eq!(starts([false, true], near).len(), 5);
    }
}

/// Of balanced data the likelihood of the ratio λ is that of two mean squares, n rows a unit and k units, and all
/// predictions are shrunk by nλ/(1 + nλ): its mean over that likelihood, here by a fine sum.
#[test]
fn predictions_are_means_over_the_likelihood_of_the_spread() {
    let y: Vec<Vec<f64>> = BALANCED.iter().map(|logs| logs.to_vec()).collect();
    let nested = one_way(&y);
    let (n, k) = (3.0, 6.0);
    let means: Vec<f64> = y.iter().map(|logs| logs.iter().sum::<f64>() / n).collect();
    let all = means.iter().sum::<f64>() / k;
    let between = n * means.iter().map(|m| (m - all).powi(2)).sum::<f64>();
    let inside = y.iter().zip(&means);
    let inside: f64 = inside
        .map(|(logs, m)| logs.iter().map(|y| (y - m).powi(2)).sum::<f64>())
        .sum();
    let squares = |grown: f64| inside + between / grown;
    let criterion = |grown: f64| (n * k - 1.0) * squares(grown).ln() + (k - 1.0) * grown.ln();
    let grown = |step: u32| 1.0 + n * (0.01 * f64::from(step)).powi(2);
    let least = (0..2000)
        .map(|step| criterion(grown(step)))
        .fold(f64::INFINITY, f64::min);
    let (mut sum, mut mean, mut square, mut own) = (0.0, 0.0, 0.0, 0.0);
    for step in 0..2000 {
        let grown = grown(step);
        let likelihood = (0.5 * (least - criterion(grown))).exp();
        let ratio = (grown - 1.0) / n;
        let shrunk = (grown - 1.0) / grown;
        let variance = squares(grown) / (n * k - 1.0);
        sum += likelihood;
        mean += likelihood * shrunk;
        square += likelihood * shrunk * shrunk;
        // Of the intercept given the mean, and by the mean.
        own += likelihood * variance * (ratio / grown + shrunk * shrunk * grown / (n * k));
    }
    let (mean, square, own) = (mean / sum, square / sum, own / sum);
    let predicted = nested.predictions(&nested.fit(None).unwrap());
    assert_eq!(predicted.len(), 6);
    for ((found, variance), unit) in predicted.into_iter().zip(&means) {
        // Sixteen steps to where a hundredth of the likelihood is left.
        close(found, mean * (unit - all), 0.01);
        let expected = own + (square - mean * mean) * (unit - all).powi(2);
        close(variance, expected, 0.05);
    }
}

/// One without a spread between units has one prediction; one set aside is its own mean.
#[test]
fn predictions_without_a_spread() {
    let mut nested = one_way(&[vec![1.0], vec![2.0], vec![4.0]]);
    let fit = nested.fit(None).unwrap();
    for (mean, variance) in nested.predictions(&fit) {
        assert_eq!((mean, variance), (0.0, 0.0));
    }
    nested.set_aside(Grouping::Unit, 2, true);
    let fit = nested.fit(None).unwrap();
    let predicted = nested.predictions(&fit);
    assert!((predicted[2].0 - 2.5).abs() < 1e-9, "{predicted:?}");
}

/// Logs of one unit are compared with each other as Student's t of a new mean, set aside or not.
#[test]
fn a_log_against_the_others() {
    let logs: Vec<Vec<(Vec<f64>, f64)>> = BALANCED
        .iter()
        .map(|rows| rows.iter().map(|y| (vec![1.0], *y)).collect())
        .collect();
    let mut nested = Nested::new(1);
    nested.add(&logs);
    assert_eq!(
        (nested.count(Grouping::Log), nested.count(Grouping::Unit)),
        (6, 1)
    );
    let within = nested.log_shifts(&nested.fit(None).unwrap());
    assert_eq!(within.len(), 6);
    let means: Vec<f64> = BALANCED.map(|rows| rows.iter().sum::<f64>() / 3.0).into();
    for k in 0..6 {
        nested.set_aside(Grouping::Log, k, true);
        let without = nested.log_shifts(&nested.fit(None).unwrap())[k].unwrap();
        nested.set_aside(Grouping::Log, k, false);
        let others: Vec<f64> = (0..6)
            .filter(|other| *other != k)
            .map(|o| means[o])
            .collect();
        let middle = others.iter().sum::<f64>() / 5.0;
        let square = others.iter().map(|m| (m - middle).powi(2)).sum::<f64>() / 4.0;
        close(without.estimate, means[k] - middle, 1e-6);
        close(without.spread, (square * 1.2).sqrt(), 1e-5);
        assert!((without.freedom - 4.0).abs() < 1e-9);
        let t = without.estimate / without.spread;
        close(without.probability, super::fit::two_sided(t, 4.0), 1e-12);
        let within = within[k].unwrap();
        close(within.estimate, without.estimate, 1e-5);
        close(within.probability, without.probability, 1e-4);
        assert!((within.freedom - 4.0).abs() < 1e-9);
    }
}

#[test]
fn quantiles_and_probabilities_of_t_are_those_of_tables() {
    for (freedom, quantile) in [(1.0, 12.706), (4.0, 2.776), (30.0, 2.042), (1e9, 1.960)] {
        assert!((quantile_95(freedom) - quantile).abs() < 5e-4, "{freedom}");
        let outside = two_sided(quantile, freedom);
        assert!((outside - 0.05).abs() < 1e-4, "{freedom} {outside}");
        assert_eq!(two_sided(-quantile, freedom), outside);
    }
    assert!((two_sided(1.0, 1.0) - 0.5).abs() < 1e-9);
    assert_eq!(two_sided(0.0, 3.0), 1.0);
    assert_eq!(two_sided(f64::NAN, 3.0), 1.0);
    let contrast = Contrast {
        estimate: -2.0,
        standard_error: 0.5,
        freedom: 4.0,
    };
    assert!((contrast.half_width() - 0.5 * 2.776).abs() < 5e-4);
    assert_eq!(contrast.probability(), two_sided(4.0, 4.0));
}

/// Against dense matrices: a column for the log beside the fixed effects, under the fitted variances.
#[test]
fn logs_of_several_units_are_compared_as_with_a_column_of_their_own() {
    for case in &golden()[..1] {
        let nested = nested(case);
        let fit = nested.fit(None).unwrap();
        let rows = case.y.len();
        let alike = |of: &[usize]| DMatrix::from_fn(rows, rows, |i, j| f64::from(of[i] == of[j]));
        let eye = DMatrix::<f64>::identity(rows, rows);
        let v = eye + fit.ratios[0] * alike(&case.log) + fit.ratios[1] * alike(&case.unit);
        let inverse = v.try_inverse().unwrap();
        let x = DMatrix::from_fn(rows, case.x[0].len(), |i, j| case.x[i][j]);
        let y = DMatrix::from_fn(rows, 1, |i, _| case.y[i]);
        let gram = (x.transpose() * &inverse * &x).try_inverse().unwrap();
        let project = &inverse - &inverse * &x * gram * x.transpose() * &inverse;
        let shifts = nested.log_shifts(&fit);
        let mut compared = 0;
        for (log, shift) in shifts.iter().enumerate() {
            let z = DMatrix::from_fn(rows, 1, |i, _| f64::from(case.log[i] == log));
            let information = (z.transpose() * &project * &z)[(0, 0)];
            let own = (z.transpose() * &inverse * &z)[(0, 0)];
            assert_eq!(shift.is_some(), information > 1e-9 * own, "{log}");
            let Some(shift) = shift else {
                continue;
            };
            compared += 1;
            let score = (z.transpose() * &project * &y)[(0, 0)];
            close(shift.estimate, score / information, 1e-7);
            close(shift.spread, (fit.variance / information).sqrt(), 1e-7);
        }
        assert!(compared > 20, "{compared}");
    }
}

/// Two levels of scatter beside that of the rows: a difference of the two logs of each unit has the degrees of freedom of
/// the analysis of variance, one less than units.
#[test]
fn a_difference_within_units_has_the_freedom_of_the_analysis_of_variance() {
    const UNIT: [f64; 6] = [1.2, -0.8, 0.4, 0.0, -1.6, 1.0];
    const LOG: [[f64; 2]; 6] = [
        [0.9, -0.6],
        [0.2, -1.1],
        [0.7, -0.3],
        [-0.8, 1.2],
        [0.5, 0.1],
        [-1.3, 0.4],
    ];
    // Half of the difference of the rows of each log.
    const ROW: [[f64; 2]; 6] = [
        [0.15, 0.13],
        [0.16, 0.09],
        [0.16, 0.15],
        [0.16, 0.10],
        [0.19, 0.07],
        [0.16, 0.09],
    ];
    let mut nested = Nested::new(2);
    let (mut rows, mut means) = (0.0, Vec::new());
    for u in 0..6 {
        let own = [0, 1].map(|l| UNIT[u] + LOG[u][l] + [-0.5, 0.5][l]);
        let log = |l: usize| {
            let x = vec![1.0, [-1.0, 1.0][l]];
            vec![(x.clone(), own[l] - ROW[u][l]), (x, own[l] + ROW[u][l])]
        };
        nested.add(&[log(0), log(1)]);
        rows += ROW[u].iter().map(|half| 2.0 * half * half).sum::<f64>() / 12.0;
        means.push([0.5 * (own[0] + own[1]), own[1] - own[0]]);
    }
    let scatter = |k: usize| {
        let mean = means.iter().map(|unit| unit[k]).sum::<f64>() / 6.0;
        let squares = means.iter().map(|unit| (unit[k] - mean).powi(2));
        (mean, squares.sum::<f64>() / 5.0)
    };
    // Mean squares: two rows to a log, four to a unit; that of a difference has twice the variance of a mean.
    let ((_, between), (difference, logs)) = (scatter(0), scatter(1));
    let between = 4.0 * between;
    let fit = nested.fit(None).unwrap();
    close(fit.variance, rows, 1e-5);
    close(fit.variance * fit.ratios[0], (logs - rows) / 2.0, 1e-4);
    close(fit.variance * fit.ratios[1], (between - logs) / 4.0, 1e-4);
    let found = fit.contrast(&nested, &[(1, 1.0)]).unwrap();
    close(found.estimate, 0.5 * difference, 1e-9);
    close(found.standard_error, (logs / 24.0).sqrt(), 1e-5);
    close(found.freedom, 5.0, 1e-3);
}
