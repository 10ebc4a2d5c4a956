//! Unit-root and stationarity tests against statsmodels, arch and R.

use crate::common::{close, names, near, number, numbers, reference, series, white_noise};
use undrift_noise::screening::RecordError;
use undrift_noise::stationarity::mackinnon::{critical_tau, p_tau};
use undrift_noise::stationarity::{
    Conclusion, Deterministic, KpssLags, Lags, adf, kpss, phillips_perron, verdict,
};

const KINDS: [(Deterministic, &str); 3] = [
    (Deterministic::None, "n"),
    (Deterministic::Constant, "c"),
    (Deterministic::Trend, "ct"),
];

fn tests<'a>(reference: &'a serde_json::Value, name: &str) -> &'a serde_json::Value {
    if name == "z100k" {
        &reference["z100k"]["tests"]
    } else {
        &reference["classic"][name]["python_tests"]
    }
}

#[test]
fn dickey_fuller_is_that_of_statsmodels() {
    let Some(reference) = reference() else { return };
    let mut compared = 0;
    for name in names() {
        let x = series(&reference, name);
        for (key, expected) in tests(&reference, name)["statsmodels.adfuller"]
            .as_object()
            .unwrap()
        {
            let mut parts = key.split([',', '=']);
            let kind = parts.next().unwrap();
            let (kind, _) = KINDS.iter().find(|k| k.1 == kind).unwrap();
            let rest: Vec<&str> = parts.collect();
            let lags = match rest[..] {
                ["lag", lag] => Lags::Fixed(lag.parse().unwrap()),
                ["autolag", rule, "maxlag", max] => {
                    let max = Some(max.parse().unwrap());
                    match rule {
                        "AIC" => Lags::Aic(max),
                        "BIC" => Lags::Bic(max),
                        _ => Lags::LastSignificant(max),
                    }
                }
                _ => panic!("{key}"),
            };
            let test = adf(&x, *kind, lags).unwrap();
            let what = format!("{name} {key}");
            close(test.statistic, number(&expected["stat"]), 1e-8, &what);
            near(test.p_value, number(&expected["p"]), 1e-6, &what);
            assert_eq!(
                test.observations,
                expected["nobs"].as_u64().unwrap() as usize,
                "{what}"
            );
            if let Some(used) = expected["usedlag"].as_u64() {
                assert_eq!(test.lags, used as usize, "{what}");
                close(
                    test.criterion.unwrap(),
                    number(&expected["icbest"]),
                    1e-8,
                    &what,
                );
            }
            let critical = &expected["crit"];
            close(test.critical.one, number(&critical["1%"]), 1e-12, &what);
            close(test.critical.five, number(&critical["5%"]), 1e-12, &what);
            close(test.critical.ten, number(&critical["10%"]), 1e-12, &what);
            compared += 1;
        }
    }
    assert!(compared >= 100, "{compared}");
}

#[test]
fn dickey_fuller_is_that_of_urca() {
    let Some(reference) = reference() else { return };
    for name in [
        "f_arma21", "f_arma43", "f_ar1wn", "f_rw", "f_quant", "f_lap", "z100k",
    ] {
        let x = series(&reference, name);
        for (kind, key) in [
            (Deterministic::None, "none"),
            (Deterministic::Constant, "drift"),
            (Deterministic::Trend, "trend"),
        ] {
            for lag in [0, 1, 5, 20] {
                let value =
                    &reference["R_reference"][name]["tests"]["urdf"][key][format!("l{lag}")];
                let expected = value.as_f64().unwrap_or_else(|| number(&value[0]));
                let test = adf(&x, kind, Lags::Fixed(lag)).unwrap();
                close(
                    test.statistic,
                    expected,
                    1e-8,
                    &format!("{name} {key} {lag}"),
                );
            }
        }
    }
}

#[test]
fn mackinnon_tables() {
    let Some(reference) = reference() else { return };
    for (kind, name) in KINDS {
        for rows in [25, 50, 100, 250, 500, 1000, 100_000, 2_000_000] {
            let expected = numbers(&reference["mackinnon2010"][name][rows.to_string()]);
            let critical = critical_tau(kind, rows);
            close(critical.one, expected[0], 1e-12, name);
            close(critical.five, expected[1], 1e-12, name);
            close(critical.ten, expected[2], 1e-12, name);
        }
        for (tau, p) in reference["mackinnon2010"][name]["pvalue_at"]
            .as_object()
            .unwrap()
        {
            near(
                p_tau(tau.parse().unwrap(), kind),
                number(p),
                1e-9,
                &format!("{name} {tau}"),
            );
        }
    }
}

/// Critical values and p on both sides of the switch between the two polynomials, from `testdata/golden/mackinnon.py`.
#[test]
fn mackinnon_is_that_of_statsmodels() {
    let text = include_str!("../../../../testdata/golden/mackinnon.json");
    let golden: serde_json::Value = serde_json::from_str(text).unwrap();
    for (kind, name) in KINDS {
        let expected = &golden["regressions"][name];
        for surface in expected["critical"].as_array().unwrap() {
            let rows = surface["rows"].as_u64().unwrap() as usize;
            let critical = critical_tau(kind, rows);
            let ours = [critical.one, critical.five, critical.ten];
            for (ours, theirs) in ours.into_iter().zip(numbers(&surface["values"])) {
                // Rounding of four sums.
                close(ours, theirs, 1e-13, &format!("{name}, {rows} rows"));
            }
        }
        for at in expected["p"].as_array().unwrap() {
            let (tau, p) = (number(&at["tau"]), number(&at["p"]));
            // Rounding of z of some 10 in a normal tail of 1e-30 is 1e-12 of it.
            close(p_tau(tau, kind), p, 1e-11, &format!("{name} {tau}"));
        }
    }
}

/// What the tables have to be by themselves: p grows with τ and hardly jumps where the polynomials meet, and the
/// asymptotic critical values of 2010 have the p of 1994 that they are of.
#[test]
fn p_is_continuous_and_agrees_with_the_critical_values() {
    for (kind, switch) in [
        (Deterministic::None, -1.04),
        (Deterministic::Constant, -1.61),
        (Deterministic::Trend, -2.89),
    ] {
        // MacKinnon fitted each polynomial to its side alone: they meet to 0.0039, 0.0006 and 0.0004.
        let jump = p_tau(switch + 1e-9, kind) - p_tau(switch, kind);
        assert!((0.0..0.004).contains(&jump), "{kind:?}: {jump}");
        let taus = (-180..=10).map(|k| 0.1 * f64::from(k));
        let p = taus.map(|tau| p_tau(tau, kind)).collect::<Vec<_>>();
        assert!(p.windows(2).all(|pair| pair[0] <= pair[1]), "{kind:?}");
        let critical = critical_tau(kind, usize::MAX);
        for (tau, level) in [
            (critical.one, 0.01),
            (critical.five, 0.05),
            (critical.ten, 0.1),
        ] {
            // Both come from simulations of that precision.
            near(p_tau(tau, kind), level, 2e-4, &format!("{kind:?}, {level}"));
        }
    }
}

#[test]
fn kpss_is_that_of_statsmodels_and_r() {
    let Some(reference) = reference() else { return };
    for name in names() {
        let x = series(&reference, name);
        for (key, expected) in tests(&reference, name)["statsmodels.kpss"]
            .as_object()
            .unwrap()
        {
            let (kind, lags) = key.split_once(",nlags=").unwrap();
            let kind = if kind == "c" {
                Deterministic::Constant
            } else {
                Deterministic::Trend
            };
            let lags = match lags {
                "legacy" => KpssLags::Legacy,
                "auto" => KpssLags::Auto,
                count => KpssLags::Fixed(count.parse().unwrap()),
            };
            let test = kpss(&x, kind, lags).unwrap();
            let what = format!("{name} {key}");
            assert_eq!(
                test.lags,
                expected["lags"].as_u64().unwrap() as usize,
                "{what}"
            );
            close(test.statistic, number(&expected["stat"]), 1e-8, &what);
            // Linear interpolation: as exact as the statistic.
            near(test.p_value, number(&expected["p"]), 1e-9, &what);
        }
    }
    for name in [
        "f_arma21", "f_arma43", "f_ar1wn", "f_rw", "f_quant", "f_lap", "z100k",
    ] {
        let x = series(&reference, name);
        let table = &reference["R_reference"][name]["tests"]["urkpss"];
        for (kind, key) in [
            (Deterministic::Constant, "mu"),
            (Deterministic::Trend, "tau"),
        ] {
            for (lags, rule) in [
                (KpssLags::Short, "short"),
                (KpssLags::Long, "long"),
                (KpssLags::Fixed(0), "nil"),
            ] {
                let test = kpss(&x, kind, lags).unwrap();
                let expected = numbers(&table[key][rule]);
                let what = format!("{name} {key} {rule}");
                close(test.statistic, expected[0], 1e-8, &what);
                assert_eq!(test.lags, expected[1] as usize, "{what}");
            }
        }
    }
}

#[test]
fn phillips_perron_is_that_of_arch() {
    let Some(reference) = reference() else { return };
    for name in names() {
        let x = series(&reference, name);
        let table = &tests(&reference, name)["arch.PhillipsPerron"];
        for (kind, key) in KINDS {
            let test = phillips_perron(&x, kind, Some(10)).unwrap();
            let tau = &table[format!("{key},tau,lags=10")];
            let rho = &table[format!("{key},rho,lags=10")];
            close(
                test.z_tau,
                number(&tau["stat"]),
                1e-8,
                &format!("{name} {key} tau"),
            );
            near(
                test.p_value,
                number(&tau["p"]),
                1e-6,
                &format!("{name} {key} p"),
            );
            close(
                test.z_rho,
                number(&rho["stat"]),
                1e-8,
                &format!("{name} {key} rho"),
            );
        }
    }
}

#[test]
fn all_regressions_equal_plain_least_squares() {
    // Normal equations built from shifted products against the regression written out, with a mean
    // 10 000 times the noise.
    let x: Vec<f64> = white_noise(1, 400)
        .iter()
        .scan(1e4, |s, e| {
            *s += e;
            Some(*s)
        })
        .collect();
    for (kind, _) in KINDS {
        for lags in [0usize, 1, 7] {
            let rows: Vec<usize> = (lags + 1..400).collect();
            let columns = 1 + lags + extra_columns(kind);
            let a = nalgebra::DMatrix::from_fn(rows.len(), columns, |i, j| {
                let t = rows[i];
                match j {
                    0 => x[t - 1],
                    j if j <= lags => x[t - j] - x[t - j - 1],
                    j if j == lags + 1 => 1.0,
                    _ => i as f64 / 400.0,
                }
            });
            let b = nalgebra::DVector::from_fn(rows.len(), |i, _| x[rows[i]] - x[rows[i] - 1]);
            let svd = a.clone().svd(true, true);
            let coefficients = svd.solve(&b, 1e-14).unwrap();
            let residual = (&b - &a * &coefficients).norm_squared() / (rows.len() - columns) as f64;
            let v = svd.v_t.unwrap();
            let error: f64 = (0..columns)
                .map(|k| (v[(k, 0)] / svd.singular_values[k]).powi(2))
                .sum();
            let expected = coefficients[0] / (residual * error).sqrt();
            let test = adf(&x, kind, Lags::Fixed(lags)).unwrap();
            // The singular values span 1e4·√400 to 1: 1e-16 · 1e6.
            close(test.statistic, expected, 1e-9, "t");
        }
    }
}

/// Columns of the deterministic part of the regression written out above.
fn extra_columns(kind: Deterministic) -> usize {
    match kind {
        Deterministic::None => 0,
        Deterministic::Constant => 1,
        Deterministic::Trend => 2,
    }
}

#[test]
#[ignore = "slow: 1000 random walks"]
fn sizes_under_the_null_are_nominal() {
    // Random walks of 500 steps: 5 % rejected, binomial sigma 0.7 % of 1000.
    let (mut dickey, mut perron, mut level) = (0, 0, 0);
    for seed in 0..1000 {
        let white = white_noise(seed, 500);
        let walk: Vec<f64> = white
            .iter()
            .scan(0.0, |s, e| {
                *s += e;
                Some(*s)
            })
            .collect();
        let test = adf(&walk, Deterministic::Constant, Lags::Fixed(1)).unwrap();
        dickey += i32::from(test.p_value < 0.05);
        perron += i32::from(
            phillips_perron(&walk, Deterministic::Constant, Some(2))
                .unwrap()
                .p_value
                < 0.05,
        );
        level += i32::from(
            kpss(&white, Deterministic::Constant, KpssLags::Short)
                .unwrap()
                .p_value
                < 0.05,
        );
    }
    for (count, name) in [(dickey, "ADF"), (perron, "PP"), (level, "KPSS")] {
        assert!((28..=74).contains(&count), "{name}: {count} of 1000");
    }
}

#[test]
fn bad_records_are_errors() {
    let fixed = |x: &[f64]| adf(x, Deterministic::Trend, Lags::Fixed(1)).map(|_| ());
    assert!(matches!(
        fixed(&[1.0, 2.0]),
        Err(RecordError::TooShort { .. })
    ));
    assert_eq!(fixed(&[0.3; 50]), Err(RecordError::Constant));
    let mut x = white_noise(1, 50);
    x[7] = f64::NAN;
    assert_eq!(fixed(&x), Err(RecordError::NotFinite { index: 7 }));
    let line: Vec<f64> = (0..50).map(|k| 0.1 * f64::from(k)).collect();
    let square: Vec<f64> = (0..50).map(|k| f64::from(k % 2)).collect();
    for (kind, _) in KINDS {
        for x in [&line, &square] {
            for rule in [
                Lags::Fixed(0),
                Lags::Fixed(3),
                Lags::Aic(None),
                Lags::Bic(Some(60)),
                Lags::LastSignificant(None),
            ] {
                if let Ok(test) = adf(x, kind, rule) {
                    assert!(test.statistic.is_finite(), "{kind:?} {rule:?}");
                }
            }
            let _ = (
                kpss(x, kind, KpssLags::Auto),
                phillips_perron(x, kind, None),
            );
        }
        for count in 0..14 {
            let x = white_noise(3, count);
            for lags in 0..count + 3 {
                let _ = adf(&x, kind, Lags::Fixed(lags));
                let _ = adf(&x, kind, Lags::Aic(Some(lags)));
                let _ = adf(&x, kind, Lags::LastSignificant(Some(lags)));
                let _ = kpss(&x, kind, KpssLags::Fixed(lags));
                let _ = phillips_perron(&x, kind, Some(lags));
            }
        }
        let _ = adf(&white_noise(3, 20), kind, Lags::Fixed(usize::MAX));
        let _ = kpss(&white_noise(3, 20), kind, KpssLags::Fixed(usize::MAX));
        let _ = phillips_perron(&white_noise(3, 20), kind, Some(usize::MAX));
        let huge = [1e200, -1e200, 1e199, 3e200, 1e180, -1e200, 2e200];
        assert!(adf(&huge, kind, Lags::Fixed(0)).is_err());
    }
    assert!(kpss(&white_noise(1, 50), Deterministic::None, KpssLags::Auto).is_err());
    assert_eq!(
        kpss(&line, Deterministic::Trend, KpssLags::Auto).map(|_| ()),
        Err(RecordError::Constant)
    );
}

#[test]
fn the_verdict_knows_when_the_unit_root_tests_are_worthless() {
    let judge = |x: &[f64], root| {
        let dickey = adf(x, Deterministic::Constant, Lags::Aic(None)).unwrap();
        let level = kpss(x, Deterministic::Constant, KpssLags::Auto).unwrap();
        let perron = phillips_perron(x, Deterministic::Constant, None).unwrap();
        verdict(&dickey, &level, &perron, root)
    };
    let white = white_noise(11, 20_000);
    let walk: Vec<f64> = white
        .iter()
        .scan(0.0, |s, e| {
            *s += e;
            Some(*s)
        })
        .collect();
    assert_eq!(judge(&white, None).conclusion, Conclusion::Stationary);
    assert_eq!(judge(&walk, None).conclusion, Conclusion::UnitRoot);
    // The paper's case with a true unit root: a random walk far below white noise.
    let bias: Vec<f64> = white_noise(12, 100_000)
        .iter()
        .scan(0.0, |s, e| {
            *s += 6e-4 * e;
            Some(*s)
        })
        .collect();
    let gyro: Vec<f64> = white_noise(13, 100_000)
        .iter()
        .zip(&bias)
        .map(|(w, b)| w + b)
        .collect();
    assert_eq!(judge(&gyro, None).conclusion, Conclusion::Conflict);
    let informed = judge(&gyro, Some(0.9994));
    assert_eq!(informed.conclusion, Conclusion::SlowPartSeen);
    assert_eq!(informed.ma_root, Some(0.9994));
    assert_eq!(
        judge(&white, Some(0.9994)).conclusion,
        Conclusion::NothingSlowSeen
    );
}
