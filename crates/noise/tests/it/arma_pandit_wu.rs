//! Pandit and Wu's tests against the reference's, and the procedure on simulated orders.

use crate::common::{close, number, reference, series, white_noise};
use undrift_noise::arma::{ArmaError, ArmaFit, FitOptions, fit};
use undrift_noise::pandit_wu::{
    OrderRow, PAPER_CRITICAL, PanditWu, PanditWuOptions, critical_value, f_test, pandit_wu,
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

/// A fit of which only what the F test takes is known.
fn of_sum(p: usize, q: usize, n: usize, sum: f64) -> ArmaFit {
    ArmaFit {
        ar: vec![0.0; p],
        ma: vec![0.0; q],
        n,
        // φ, θ, σ² and the mean.
        parameters: p + q + 2,
        residual_sum_of_squares: sum,
        ..ArmaFit::default()
    }
}

#[test]
fn an_f_of_two_more_parameters_has_the_closed_tail() {
    // s = 2 and ν = N − r = 101 − 5; on both sides of the paper's critical value 2.996 and of the exact 3.091.
    for (f, significant, in_paper) in [
        (-1.0, false, false),
        (0.5, false, false),
        (2.98, false, false),
        (3.05, false, true),
        (3.11, true, true),
        (40.0, true, true),
    ] {
        let larger = of_sum(2, 2, 101, 7.0);
        let smaller = of_sum(1, 1, 101, 7.0 * (1.0 + 2.0 * f / 96.0));
        let test = f_test(&smaller, &larger, 0.05).unwrap();
        assert_eq!((test.smaller, test.larger), ((1, 1), (2, 2)));
        assert_eq!((test.added, test.remaining), (2, 96));
        assert_eq!(
            (test.sum_smaller, test.sum_larger),
            (smaller.residual_sum_of_squares, 7.0)
        );
        close(test.f, f, 1e-12, "F");
        let tail = (1.0 + 2.0 * f64::max(f, 0.0) / 96.0).powi(-48);
        // The incomplete beta function to ten digits.
        close(test.p_value, tail, 1e-9, "tail");
        close(
            test.critical,
            48.0 * (0.05f64.powf(-1.0 / 48.0) - 1.0),
            1e-9,
            "critical",
        );
        assert_eq!(test.significant, significant, "{f}");
        assert_eq!(test.significant_in_paper, in_paper, "{f}");
        assert_eq!(test.significant, test.p_value < 0.05);
    }
}

#[test]
fn there_is_no_f_without_parameters_more_or_samples_left() {
    let of = |smaller: (usize, usize), larger: (usize, usize), n| {
        let (a, b) = (
            of_sum(smaller.0, smaller.1, n, 2.0),
            of_sum(larger.0, larger.1, n, 1.0),
        );
        f_test(&a, &b, 0.05).map(|test| (test.added, test.remaining))
    };
    assert_eq!(of((1, 1), (1, 1), 50), None);
    assert_eq!(of((2, 1), (1, 1), 50), None);
    assert_eq!(of((1, 1), (2, 1), 50), Some((1, 46)));
    assert_eq!(of((1, 1), (2, 1), 5), Some((1, 1)));
    assert_eq!(of((1, 1), (2, 1), 4), None);
    assert_eq!(of((1, 1), (2, 1), 3), None);
    for level in [0.0, 1.0, -0.1, f64::NAN] {
        let (a, b) = (of_sum(1, 1, 50, 2.0), of_sum(2, 1, 50, 1.0));
        assert_eq!(f_test(&a, &b, level), None);
        assert_eq!(critical_value(1, 46, level), None);
    }
}

#[test]
fn a_level_or_an_order_out_of_range_is_an_error() {
    let x = white_noise(1, 50);
    for level in [0.0, 1.0, -0.1, 1.5, f64::NAN] {
        let options = PanditWuOptions {
            level,
            ..PanditWuOptions::default()
        };
        let found = pandit_wu(&x, &options).unwrap_err();
        assert_eq!(found, ArmaError::BadOption("the level of the tests"));
    }
    for n_max in [0, 13] {
        let options = PanditWuOptions {
            n_max,
            ..PanditWuOptions::default()
        };
        assert_eq!(pandit_wu(&x, &options), Err(ArmaError::BadOption("n_max")));
    }
}

/// The choices as the module says them, from the fits that were made.
fn assert_as_described(found: &PanditWu, options: &PanditWuOptions) {
    let test = |smaller: &ArmaFit, larger: &ArmaFit| f_test(smaller, larger, options.level);
    let needed = |smaller: &ArmaFit, larger: &ArmaFit| {
        test(smaller, larger).is_some_and(|test| test.significant)
    };
    let made = |p: usize, q: usize| found.fit((p, q)).unwrap();
    assert_eq!((found.rows[0].order(), found.rows[0].n), ((1, 1), 0));
    assert_eq!(found.rows[0].test, None);
    for (n, pair) in found.rows.windows(2).enumerate() {
        assert_eq!(
            (pair[1].n, pair[1].order()),
            (n + 1, (2 * n + 2, 2 * n + 1))
        );
        assert_eq!(pair[1].test, test(&pair[0].fit, &pair[1].fit));
    }
    // Up: ARMA(2,1) is taken for granted.
    let mut n = 1;
    let mut adequate = false;
    while n < options.n_max && !adequate {
        let (larger, smaller) = (made(2 * n + 2, 2 * n + 1), made(2 * n, 2 * n - 1));
        adequate = !needed(smaller, larger);
        n += usize::from(!adequate);
    }
    assert_eq!((found.n, found.adequate), (n, adequate));
    assert_eq!(
        found.rows.len(),
        1 + options.table.max(n + usize::from(adequate))
    );
    // Down, while it costs nothing.
    let way = || (1..2 * n).rev().map(|p| (p, (p - 1).max(1)));
    let (mut chosen, mut step_down) = (made(2 * n, 2 * n - 1), Vec::new());
    for (p, q) in way() {
        step_down.extend(test(made(p, q), chosen));
        if needed(made(p, q), chosen) {
            break;
        }
        chosen = made(p, q);
    }
    assert_eq!((found.by_f, &found.step_down), (chosen.order(), &step_down));
    let all = way().chain([(2 * n, 2 * n - 1)]).map(|(p, q)| made(p, q));
    let least = all.min_by(|a, b| a.bic.total_cmp(&b.bic)).unwrap();
    assert_eq!(found.by_bic_step_down, least.order());
    for (by, score) in [
        (found.by_aic, (|fit| fit.aic) as fn(&ArmaFit) -> f64),
        (found.by_bic, |fit| fit.bic),
    ] {
        let chosen = score(found.fit(by).unwrap());
        assert!(found.fits.iter().all(|fit| score(fit) >= chosen));
    }
    let neighbours = [((1, 1), (2, 1)), ((2, 1), (3, 2)), ((1, 1), (3, 2))];
    let neighbours = neighbours.map(|(a, b)| test(made(a.0, a.1), made(b.0, b.1)).unwrap());
    assert_eq!(found.neighbours, neighbours);
}

#[test]
fn the_procedure_goes_up_and_down_as_described() {
    let options = PanditWuOptions {
        n_max: 2,
        table: 4,
        fit: FitOptions {
            effort: 0.01,
            ..FitOptions::default()
        },
        ..PanditWuOptions::default()
    };
    // White noise; two resonances, which need ARMA(4,3); one of them; a slow part beside white noise.
    let models = [
        [0.0; 4],
        [-0.1, -0.1, 0.1, -0.9],
        [1.2, -0.8, 0.0, 0.0],
        [0.95, 0.0, 0.0, 0.0],
    ];
    let mut chosen = Vec::new();
    for (seed, phi) in (1..).zip(models) {
        let mut x: Vec<f64> = vec![0.0; 4];
        for (drive, beside) in white_noise(seed, 160)
            .into_iter()
            .zip(white_noise(seed + 9, 160))
        {
            let ahead: f64 = phi.iter().zip(x.iter().rev()).map(|(phi, x)| phi * x).sum();
            x.push(ahead + drive + if seed == 4 { 0.3 * beside } else { 0.0 });
        }
        let found = pandit_wu(&x[4..], &options).unwrap();
        assert_as_described(&found, &options);
        assert!(found.fits.iter().all(|fit| fit.order().0 <= 4));
        chosen.push((found.n, found.adequate));
    }
    // Both ends of the way up are among them.
    assert!(
        chosen.contains(&(2, false)) && chosen.contains(&(1, true)),
        "{chosen:?}"
    );
}

#[test]
fn akaikes_criterion_of_a_sample_counts_the_coefficients_and_the_mean() {
    // ln(A/N) = 2, and 2 · (2 + 1 + 1)/100.
    let row = OrderRow {
        n: 1,
        fit: of_sum(2, 1, 100, 100.0 * 2f64.exp()),
        test: None,
    };
    close(row.aic_per_sample(), 2.08, 1e-14, "AIC");
    assert_eq!(row.order(), (2, 1));
}
