//! Three small series against what statsmodels, arch, scipy and allantools make of them:
//! `testdata/golden/packages.py`. The same comparisons as with the reference file of the public data, of which these need nothing.

use crate::common::{close, near, number, numbers};
use serde_json::Value;
use undrift_noise::{
    allan::{DeviationKind, Grid, deviations},
    arma::{FitOptions, Mean, fit, log_likelihood},
    correlation::{Partial, autocorrelation, autocovariance, partial_autocorrelation},
    normality::normality,
    stationarity::{
        Deterministic, KpssLags, Lags, adf, kpss,
        mackinnon::{critical_tau, p_tau},
        phillips_perron,
    },
    whiteness::portmanteau,
};

const SAMPLES: usize = 600;

fn uniform(mut state: u64) -> Vec<f64> {
    let next = || {
        let value = state as f64 / 2_147_483_647.0 - 0.5;
        state = state * 16_807 % 2_147_483_647;
        value
    };
    std::iter::repeat_with(next).take(SAMPLES).collect()
}

/// The golden values and the series they are of, by name.
fn golden() -> (Value, [(&'static str, Vec<f64>); 3]) {
    let text = include_str!("../../../../testdata/golden/packages.json");
    let golden: Value = serde_json::from_str(text).unwrap();
    let (drive, white) = (uniform(1_234_567_890), uniform(987_654_321));
    let [mut last, mut before, mut drive_before, mut sum, mut level] = [0.0; 5];
    let [mut arma, mut walk, mut slow] = [const { Vec::new() }; 3];
    for (drive, white) in drive.into_iter().zip(white) {
        let next = 1.2 * last - 0.4 * before + drive - 0.5 * drive_before;
        (before, last, drive_before) = (last, next, drive);
        sum += drive;
        level = 0.98 * level + 0.1 * drive;
        arma.push(3.0 + next);
        walk.push(sum);
        slow.push(level + white);
    }
    let series = [("arma", arma), ("walk", walk), ("slow", slow)];
    for (name, series) in &series {
        for (ours, theirs) in series.iter().zip(numbers(&golden[*name]["first"])) {
            near(*ours, theirs, 1e-14, "the series is the same");
        }
    }
    (golden, series)
}

fn kind(name: &Value) -> Deterministic {
    match name.as_str().unwrap() {
        "n" => Deterministic::None,
        "c" => Deterministic::Constant,
        _ => Deterministic::Trend,
    }
}

fn rows(value: &Value) -> &[Value] {
    value.as_array().unwrap()
}

// The series are made with the operations in another order than theirs, 1e-14 apart, and the statistics are sums of 600 products:
// 1e-9 relative leaves room for what cancels.

#[test]
fn correlations_are_those_of_statsmodels() {
    let (golden, series) = golden();
    for (name, x) in series {
        let golden = &golden[name]["correlations"];
        let expected = numbers(&golden["acf"]);
        let ours = autocorrelation(&x, expected.len() - 1).unwrap();
        for (lag, (ours, theirs)) in ours.iter().zip(&expected).enumerate() {
            near(*ours, *theirs, 1e-11, &format!("{name} lag {lag}"));
        }
        let ours = autocovariance(&x, 4).unwrap();
        for (ours, theirs) in ours.iter().zip(numbers(&golden["acovf"])) {
            close(*ours, theirs, 1e-9, name);
        }
        for (method, key) in [
            (Partial::YuleWalker, "ywmle"),
            (Partial::YuleWalkerAdjusted, "ywadjusted"),
            (Partial::Burg, "burg"),
        ] {
            let expected = numbers(&golden["pacf"][key]);
            let ours = partial_autocorrelation(&x, expected.len() - 1, method).unwrap();
            for (ours, theirs) in ours.iter().zip(&expected) {
                near(*ours, *theirs, 1e-10, &format!("{name} {key}"));
            }
        }
    }
}

#[test]
fn portmanteau_tests_are_those_of_statsmodels() {
    let (golden, series) = golden();
    for (name, x) in series {
        for (lags, expected) in golden[name]["whiteness"].as_object().unwrap() {
            let test = portmanteau(&x, &[lags.parse().unwrap()], 0).unwrap()[0];
            let [statistic, p, pierce, pierce_p] = numbers(expected).try_into().unwrap();
            close(test.ljung_box, statistic, 1e-9, name);
            close(test.box_pierce, pierce, 1e-9, name);
            // As far as a p-value can be distinguished from 0.
            near(test.ljung_box_p, p, 1e-9, name);
            near(test.box_pierce_p, pierce_p, 1e-9, name);
        }
    }
}

#[test]
fn moments_and_normality_are_those_of_scipy() {
    let (golden, series) = golden();
    for (name, x) in series {
        let golden = &golden[name]["normality"];
        let found = normality(&x).unwrap();
        let [mean, variance, skewness, kurtosis] = numbers(&golden["moments"]).try_into().unwrap();
        close(found.mean, mean, 1e-9, name);
        close(found.deviation.powi(2), variance, 1e-9, name);
        near(found.skewness, skewness, 1e-10, name);
        near(found.kurtosis_excess, kurtosis, 1e-10, name);
        let [statistic, p] = numbers(&golden["jarque_bera"]).try_into().unwrap();
        close(found.jarque_bera.statistic, statistic, 1e-8, name);
        near(found.jarque_bera.p_value, p, 1e-9, name);
        close(found.ks.statistic, number(&golden["distance"]), 1e-9, name);
    }
}

#[test]
fn dickey_fuller_is_that_of_statsmodels() {
    let (golden, series) = golden();
    for (name, x) in series {
        for row in rows(&golden[name]["dickey_fuller"]) {
            let lags = match row[1].as_str() {
                Some("AIC") => Lags::Aic(Some(8)),
                Some("BIC") => Lags::Bic(Some(8)),
                Some(_) => Lags::LastSignificant(Some(8)),
                None => Lags::Fixed(row[1].as_u64().unwrap() as usize),
            };
            let what = format!("{name} {row}");
            let test = adf(&x, kind(&row[0]), lags).unwrap();
            close(test.statistic, number(&row[2]), 1e-8, &what);
            near(test.p_value, number(&row[3]), 1e-8, &what);
            assert_eq!(test.lags as u64, row[4].as_u64().unwrap(), "{what}");
            assert_eq!(test.observations as u64, row[5].as_u64().unwrap(), "{what}");
            close(test.critical.one, number(&row[6]), 1e-12, &what);
            close(test.critical.five, number(&row[7]), 1e-12, &what);
            close(test.critical.ten, number(&row[8]), 1e-12, &what);
        }
    }
}

/// On both sides of where the p-value changes from one polynomial to the other, and beyond the ends.
#[test]
fn mackinnon_s_tables_are_those_of_statsmodels() {
    let (golden, _) = golden();
    for (name, table) in golden["mackinnon"].as_object().unwrap() {
        let of = kind(&Value::from(name.as_str()));
        for row in rows(&table["critical"]) {
            let critical = critical_tau(of, number(&row[0]) as usize);
            let found = [critical.one, critical.five, critical.ten];
            for (ours, theirs) in found.iter().zip(&numbers(row)[1..]) {
                close(*ours, *theirs, 1e-12, name);
            }
        }
        for row in rows(&table["p"]) {
            let [tau, p] = numbers(row).try_into().unwrap();
            near(p_tau(tau, of), p, 1e-9, &format!("{name} {tau}"));
        }
    }
}

#[test]
fn kpss_is_that_of_statsmodels() {
    let (golden, series) = golden();
    for (name, x) in series {
        for row in rows(&golden[name]["kpss"]) {
            let lags = match row[1].as_str() {
                Some("auto") => KpssLags::Auto,
                Some(_) => KpssLags::Legacy,
                None => KpssLags::Fixed(row[1].as_u64().unwrap() as usize),
            };
            let what = format!("{name} {row}");
            let test = kpss(&x, kind(&row[0]), lags).unwrap();
            close(test.statistic, number(&row[2]), 1e-8, &what);
            near(test.p_value, number(&row[3]), 1e-9, &what);
            assert_eq!(test.lags as u64, row[4].as_u64().unwrap(), "{what}");
        }
    }
}

#[test]
fn phillips_perron_is_that_of_arch() {
    let (golden, series) = golden();
    for (name, x) in series {
        for row in rows(&golden[name]["perron"]) {
            let what = format!("{name} {row}");
            let test = phillips_perron(&x, kind(&row[0]), Some(10)).unwrap();
            close(test.z_tau, number(&row[1]), 1e-8, &what);
            near(test.p_value, number(&row[2]), 1e-8, &what);
            close(test.z_rho, number(&row[3]), 1e-8, &what);
        }
    }
}

#[test]
fn likelihoods_at_given_coefficients_are_those_of_statsmodels() {
    let (golden, series) = golden();
    for (name, mut x) in series {
        let Some(cases) = golden[name]["likelihoods"].as_array() else {
            continue; // A random walk has none of a stationary model.
        };
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        x.iter_mut().for_each(|value| *value -= mean);
        for case in cases {
            let (ar, ma) = (numbers(&case["ar"]), numbers(&case["ma"]));
            let at = log_likelihood(&x, &ar, &ma, Mean::Known(0.0), false).unwrap();
            let what = format!("{name} {case}");
            // Theirs stops iterating the covariance of its filter at 1e-19, ours is exact.
            near(
                at.log_likelihood,
                number(&case["log_likelihood"]),
                1e-7,
                &what,
            );
            close(at.variance, number(&case["variance"]), 1e-9, &what);
        }
    }
}

#[test]
fn fits_reach_the_optimum_of_statsmodels() {
    let (golden, series) = golden();
    for (name, x) in series {
        for expected in rows(&golden[name]["fits"]) {
            let [p, d, q] = numbers(&expected["order"]).try_into().unwrap();
            let options = FitOptions {
                unit_root: d == 1.0,
                ..FitOptions::default()
            };
            let model = fit(&x, (p + d) as usize, q as usize, &options).unwrap();
            let gap = model.log_likelihood - number(&expected["log_likelihood"]);
            // The search stops where 1e-5 is left to gain; theirs may stop lower.
            assert!((-1e-4..1e-3).contains(&gap), "{name} {expected}: {gap:e}");
            if d == 0.0 && gap < 1e-4 {
                let ours = model.ar.iter().chain(&model.ma);
                let theirs = numbers(&expected["ar"])
                    .into_iter()
                    .chain(numbers(&expected["ma"]));
                for (ours, theirs) in ours.zip(theirs) {
                    // 1e-5 of log-likelihood is √(2e-5) standard errors, of up to a half here.
                    near(*ours, theirs, 3e-3, &format!("{name} {expected}"));
                }
            }
        }
    }
}

#[test]
fn deviations_are_those_of_allantools() {
    let (golden, series) = golden();
    for (name, x) in series {
        for (kind, key) in [
            (DeviationKind::Overlapping, "oadev"),
            (DeviationKind::Modified, "mdev"),
            (DeviationKind::Hadamard, "ohdev"),
            (DeviationKind::Total, "totdev"),
        ] {
            let expected = &golden[name]["deviations"][key];
            let curve = deviations(&x, 10.0, kind, Grid::Octave).unwrap();
            let (taus, terms) = (numbers(&expected["tau"]), numbers(&expected["terms"]));
            // Theirs ends earlier for some.
            assert!(taus.len() >= 8 && taus.len() <= curve.points.len(), "{key}");
            for (k, deviation) in numbers(&expected["deviation"]).into_iter().enumerate() {
                let point = &curve.points[k];
                close(point.tau_s, taus[k], 1e-12, key);
                close(point.deviation, deviation, 1e-10, &format!("{name} {key}"));
                assert_eq!(point.terms as f64, terms[k], "{name} {key}");
            }
        }
    }
}
