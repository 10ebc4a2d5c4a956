//! Pandit and Wu's tests against the reference's, and the procedure on simulated orders.

use crate::common::{number, reference, series};
use undrift_noise::arma::{ArmaError, FitOptions, fit};
use undrift_noise::pandit_wu::{
    PAPER_CRITICAL, PanditWuOptions, critical_value, f_test, pandit_wu,
};

#[test]
fn f_between_orders_is_the_reference_f() {
    let Some(reference) = reference() else { return };
    let table = &reference["global_optimum_multistart"];
    let mut compared = 0;
    for name in [
        "SeriesA",
        "SeriesF",
        "lh",
        "LakeHuron",
        "sunspot.year",
        "Nile",
        "lynx",
    ] {
        let x = series(&reference, name);
        for (smaller, larger) in [("ARMA(1,0)", "ARMA(2,1)"), ("ARMA(2,1)", "ARMA(4,3)")] {
            let of = |order: &str| {
                let entry = &table[name][order];
                let (p, q) = (number(&entry["p"]) as usize, number(&entry["q"]) as usize);
                let model = fit(&x, p, q, &FitOptions::default()).unwrap();
                let same = (model.log_likelihood - number(&entry["loglik"])).abs() < 1e-3;
                (model, same)
            };
            let ((small, found), (large, also)) = (of(smaller), of(larger));
            let expected = &table[name][larger]["pandit_wu_F"];
            let test = f_test(&small, &large, 0.05).unwrap();
            assert_eq!(test.added, number(&expected["df1"]) as usize, "{name}");
            assert_eq!(test.remaining, number(&expected["df2"]) as usize, "{name}");
            // Incomplete beta function to ten digits.
            let critical = test.critical / number(&expected["crit95"]) - 1.0;
            assert!(critical.abs() < 1e-9, "{name} {critical:e}");
            // Where our optimum is a higher one, the F of the reference is another model's.
            if !(found && also) {
                continue;
            }
            // A flat direction: 1e-3 of log-likelihood is 2e-3/N of a sum of squares, which F
            // multiplies by N/s; on the invertible boundary the two move against each other.
            let gap = test.f - number(&expected["F"]);
            assert!(
                gap.abs() < 0.02 * (1.0 + test.f),
                "{name} {larger} {} {gap}",
                test.f
            );
            compared += 1;
        }
    }
    assert!(compared >= 10, "{compared}");
}

#[test]
fn critical_values_are_the_tables() {
    // F_0.05(s, N − r) of any printed table.
    for (s, r, expected) in [(4, 60, 2.5252), (1, 120, 3.9201), (2, 10, 4.1028)] {
        let value = critical_value(s, r, 0.05).unwrap();
        assert!((value - expected).abs() <= 5e-5, "{s} {r} {value}");
    }
    // Closed form for s = 2: (ν/2)(0.05^(−2/ν) − 1), to −ln 0.05 for ν → ∞.
    for nu in [96.0f64, 2_000_000.0] {
        let exact = 0.5 * nu * (-2.0 / nu * 0.05f64.ln()).exp_m1();
        let value = critical_value(2, nu as usize, 0.05).unwrap();
        // The incomplete beta function loses digits of ln Γ(10⁶).
        assert!((value - exact).abs() < 1e-8, "{nu} {value}");
    }
    assert!((PAPER_CRITICAL + 0.05f64.ln()).abs() < 1e-15);
    assert!(critical_value(2, 10, 0.0).is_none());
}

#[test]
fn a_strong_43_is_kept_and_bic_agrees_with_a_true_21() {
    let Some(reference) = reference() else { return };
    let options = PanditWuOptions {
        n_max: 2,
        ..PanditWuOptions::default()
    };
    let table = pandit_wu(&series(&reference, "f_arma43"), &options).unwrap();
    assert!(table.n == 2 && !table.adequate, "{:?}", table.rows);
    assert_eq!(table.rows[2].order(), (4, 3));
    assert!(table.rows[2].test.unwrap().significant);
    assert_eq!(table.by_bic_step_down, (4, 3));
    // The sums of squares fall with the order in the table.
    for pair in table.rows.windows(2) {
        let sums = (
            pair[0].fit.residual_sum_of_squares,
            pair[1].fit.residual_sum_of_squares,
        );
        assert!(sums.1 <= sums.0);
    }
    // Rows beyond the choice change nothing of it, and never have the larger sum of squares.
    let longer = PanditWuOptions {
        table: 3,
        ..options
    };
    let more = pandit_wu(&series(&reference, "f_arma43"), &longer).unwrap();
    assert_eq!(
        (more.n, more.by_f, more.by_bic),
        (table.n, table.by_f, table.by_bic)
    );
    assert_eq!((more.fits.len(), more.rows.len()), (table.fits.len(), 4));
    assert_eq!(more.rows[3].order(), (6, 5));
    assert!(more.rows[3].test.unwrap().f > 0.0);
    let row = &more.rows[2];
    // Akaike's criterion without 1 + ln 2π a sample and the variance's own parameter, where σ² is A/N.
    let n = row.fit.n as f64;
    let constant = 1.0 + std::f64::consts::TAU.ln() + 2.0 / n;
    let expected = row.fit.aic / n - constant;
    // |log det| of the start's variance is in the likelihood and not in A.
    assert!((row.aic_per_sample() - expected).abs() < 0.02, "{expected}");
    let table = pandit_wu(&series(&reference, "f_arma21"), &options).unwrap();
    assert_eq!(table.by_bic, (2, 1));
    assert_eq!(table.by_bic_step_down, (2, 1));
    assert!(table.fit(table.by_f).is_some() && table.fit((1, 1)).is_some());
    assert_eq!(table.neighbours.len(), 3);
    assert_eq!(table.neighbours[0].smaller, (1, 1));
}

#[test]
fn bad_input_is_an_error() {
    let options = PanditWuOptions::default();
    assert_eq!(
        pandit_wu(&[2.0; 100], &options).unwrap_err(),
        ArmaError::Constant
    );
    assert!(matches!(
        pandit_wu(&[1.0, 2.0], &options).unwrap_err(),
        ArmaError::TooShort { .. }
    ));
    assert!(pandit_wu(&[f64::NAN; 100], &options).is_err());
    let none = PanditWuOptions {
        n_max: 0,
        ..options
    };
    assert!(pandit_wu(&[1.0, 2.0, 3.0], &none).is_err());
    // Twelve samples: as far as they go, without a panic.
    let few: Vec<f64> = (0..12).map(|k| f64::from(k * k % 7)).collect();
    let table = pandit_wu(&few, &options).unwrap();
    assert!(table.rows.len() >= 2);
}
