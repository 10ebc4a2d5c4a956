use super::*;

fn process(sigma: f64, tau_s: f64) -> GaussMarkov {
    GaussMarkov { sigma, tau_s }
}

fn all() -> CompositeTerms {
    CompositeTerms {
        white: 0.1,
        quantisation: 0.2,
        random_walk: 0.3,
        flicker: 0.4,
        gauss_markov: [process(0.5, 6.0), process(0.7, 80.0)],
    }
}

/// Every set of terms, with `all` of it.
fn sets() -> impl Iterator<Item = (TermSet, CompositeTerms)> {
    (0..48).map(|k| {
        let set = TermSet {
            white: k & 1 > 0,
            quantisation: k & 2 > 0,
            random_walk: k & 4 > 0,
            flicker: k & 8 > 0,
            gauss_markov: k / 16,
        };
        let only = |there: bool, value: f64| if there { value } else { 0.0 };
        let mut terms = all();
        terms.white = only(set.white, terms.white);
        terms.quantisation = only(set.quantisation, terms.quantisation);
        terms.random_walk = only(set.random_walk, terms.random_walk);
        terms.flicker = only(set.flicker, terms.flicker);
        terms.gauss_markov[set.gauss_markov..].fill(GaussMarkov::default());
        (set, terms)
    })
}

/// All values, in the order of the fields.
fn values(terms: &CompositeTerms) -> [f64; 8] {
    let [a, b] = terms.gauss_markov;
    let slow = [terms.random_walk, terms.flicker];
    let [walk, flicker] = slow;
    let fast = (terms.white, terms.quantisation);
    [
        fast.0, fast.1, walk, flicker, a.sigma, a.tau_s, b.sigma, b.tau_s,
    ]
}

#[test]
fn the_coordinates_lead_back_to_the_terms() {
    for (set, terms) in sets() {
        assert_eq!(terms.set(), set);
        let z = set.coordinates(&terms);
        assert_eq!(z.len(), set.parameters());
        assert_eq!(set.amplitudes(), set.parameters() - set.gauss_markov);
        for (back, exact) in values(&set.terms(&z)).into_iter().zip(values(&terms)) {
            // A logarithm and its exponential.
            assert!((back - exact).abs() <= 1e-14 * exact, "{set:?}");
        }
        assert_eq!(set.check().is_ok(), set.parameters() > 0);
    }
    let three = TermSet {
        gauss_markov: 3,
        ..TermSet::default()
    };
    assert_eq!(three.check(), Err(CompositeError::BadTerms));
}

#[test]
fn errors_are_the_covariances_roots_and_that_of_sigma_is_of_drive_and_tau_together() {
    for (set, _) in sets() {
        let count = set.parameters();
        let first = set.amplitudes() - set.gauss_markov;
        let mut covariance = DMatrix::zeros(count, count);
        for i in 0..count {
            covariance[(i, i)] = ((i + 2) * (i + 2)) as f64;
        }
        for i in 0..set.gauss_markov {
            let (drive, tau) = (first + i, first + set.gauss_markov + i);
            (covariance[(drive, tau)], covariance[(tau, drive)]) = (-1.5, -1.5);
        }
        let errors = set.relative_errors(&covariance);
        let amplitudes = [
            (set.white, errors.white),
            (set.quantisation, errors.quantisation),
            (set.random_walk, errors.random_walk),
            (set.flicker, errors.flicker),
        ];
        let mut next = 0;
        for (there, error) in amplitudes {
            let expected = if there { (next + 2) as f64 } else { 0.0 };
            assert_eq!(error, expected, "{set:?}");
            next += usize::from(there);
        }
        for i in 0..MAX_GAUSS_MARKOV {
            let (drive, tau) = (
                (first + i + 2) as f64,
                (first + set.gauss_markov + i + 2) as f64,
            );
            let expected = match i < set.gauss_markov {
                // ln σ is ln drive + ½ ln τ.
                true => process((drive * drive - 1.5 + 0.25 * tau * tau).sqrt(), tau),
                false => GaussMarkov::default(),
            };
            assert_eq!(errors.gauss_markov[i], expected, "{set:?}");
        }
    }
}

#[test]
fn a_factor_is_on_every_amplitude_and_on_no_time() {
    let exact = [0.2, 0.4, 0.6, 0.8, 1.0, 6.0, 1.4, 80.0];
    for (found, exact) in values(&all().scaled(2.0)).into_iter().zip(exact) {
        assert_eq!(found, exact);
    }
}

#[test]
fn processes_are_sorted_by_time_with_their_errors() {
    let (fast, slow, none) = (
        process(0.1, 2.0),
        process(0.2, 30.0),
        GaussMarkov::default(),
    );
    for (before, after) in [
        ([fast, slow], [fast, slow]),
        ([slow, fast], [fast, slow]),
        ([none, slow], [slow, none]),
        ([slow, none], [slow, none]),
        ([none, none], [none, none]),
    ] {
        let mut terms = CompositeTerms {
            gauss_markov: before,
            ..CompositeTerms::default()
        };
        let mut errors = terms.scaled(10.0);
        sort_processes(&mut terms, Some(&mut errors));
        assert_eq!(terms.gauss_markov, after);
        assert_eq!(errors, terms.scaled(10.0));
    }
}

#[test]
fn a_drive_is_the_walk_at_short_times() {
    // Over dt ≪ τ a process moves by 2σ²(1 − e^(−dt/τ)), a walk by K² dt.
    let (of, dt) = (process(0.3, 50.0), 1e-6);
    let moved = 2.0 * 0.09 * -f64::exp_m1(-dt / 50.0);
    assert!((of.drive().powi(2) * dt / moved - 1.0).abs() < 1e-7);
    assert_eq!(process(0.0, 0.0).drive(), 0.0);
}

#[test]
fn the_filter_of_a_sum_has_the_autocovariance_of_the_sum() {
    let interval = 0.5;
    for (_, mut terms) in sets() {
        // A walk has no autocovariance, nor has flicker noise, whose slow part is one.
        (terms.random_walk, terms.flicker) = (0.0, 0.0);
        let mut lags = [0.0; 4];
        terms
            .to_shaping(interval)
            .unwrap()
            .autocovariance(&mut lags);
        let rounding = (terms.quantisation / interval).powi(2);
        for (lag, found) in lags.into_iter().enumerate() {
            let slow = terms.gauss_markov.iter().filter(|g| g.sigma > 0.0);
            let slow = slow.map(|g| g.sigma.powi(2) * (-(lag as f64) * interval / g.tau_s).exp());
            let fast = match lag {
                0 => terms.white.powi(2) / interval + 2.0 * rounding,
                1 => -rounding,
                _ => 0.0,
            };
            let exact = slow.sum::<f64>() + fast;
            assert!(
                (found - exact).abs() < 1e-14,
                "{terms:?} {lag}: {found} {exact}"
            );
        }
    }
}

#[test]
fn flicker_and_a_walk_are_one_walk_beside_the_processes() {
    let terms = CompositeTerms {
        gauss_markov: [GaussMarkov::default(), process(0.7, 80.0)],
        ..all()
    };
    let (decades, slowest) = flicker(0.4);
    let (processes, walk) = terms.slow();
    assert_eq!(processes[0], process(0.7, 80.0));
    assert_eq!(processes[1..], decades);
    assert!((walk * walk - (0.09 + slowest * slowest)).abs() < 1e-15);
    // σ² = B² ln 10/π each; what is slower than 1000 s drives 2σ² (10⁻⁴ + 10⁻⁵ + …).
    let variance = 0.16 * 10f64.ln() / std::f64::consts::PI;
    assert!(
        decades
            .iter()
            .all(|g| (g.sigma.powi(2) / variance - 1.0).abs() < 1e-14)
    );
    let drives = (4..20).map(|k| 2.0 * variance * 0.1f64.powi(k));
    assert!((slowest * slowest / drives.sum::<f64>() - 1.0).abs() < 1e-14);
    let without = CompositeTerms {
        flicker: 0.0,
        ..terms
    };
    assert_eq!(without.slow(), (vec![process(0.7, 80.0)], 0.3));
}

#[test]
fn a_bad_quantisation_or_interval_makes_no_filter() {
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let terms = CompositeTerms {
            quantisation: bad,
            ..CompositeTerms::default()
        };
        assert!(terms.to_shaping(1.0).is_err());
        assert!(all().to_shaping(bad).is_err());
    }
    assert!(quantisation(0.0, 1.0).is_ok());
}
