use super::*;
use crate::composite::{self, FitOptions, TermSet};
use crate::synthesis::NoiseGenerator;

const T: f64 = 0.1;
const LEVEL: f64 = 0.01;

fn walk(white: f64, random_walk: f64) -> CompositeTerms {
    CompositeTerms {
        white,
        random_walk,
        ..CompositeTerms::default()
    }
}

/// Records of the terms, compared by the terms fitted to all of them.
fn compared(terms: &[CompositeTerms], samples: usize, seed: u64) -> Compared {
    let draw = |(k, terms): (usize, &CompositeTerms)| {
        let mut record = vec![0.0; samples];
        NoiseGenerator::new(&terms.to_shaping(T).unwrap(), seed + k as u64).fill(&mut record);
        record
    };
    let records: Vec<Vec<f64>> = terms.iter().enumerate().map(draw).collect();
    let records: Vec<&[f64]> = records.iter().map(Vec::as_slice).collect();
    let set = TermSet {
        white: true,
        random_walk: true,
        ..TermSet::default()
    };
    let fit = composite::fit_several(&records, T, set, &FitOptions::default()).unwrap();
    let share = Share {
        samples,
        ..Share::default()
    };
    let mut shares = vec![share; terms.len()];
    Records::new(&records, 1, T, fit.terms).compare(&mut shares, LEVEL)
}

/// Seeds 1 to 4·60: 1 % of such pools differ by chance, more than three of 60 in 0.3 % of tests. The ratio of
/// all records is χ² where its inflation is 1: its mean is 6 or, where that divides it, less.
#[test]
fn records_of_one_process_hardly_ever_differ() {
    let pools: Vec<Compared> = (0..60)
        .map(|k| compared(&[walk(0.02, 0.001); 4], 3000, 4 * k + 1))
        .collect();
    let alarms = pools.iter().filter(|found| !found.differing.is_empty());
    assert!(alarms.count() <= 3);
    let mean = pools.iter().map(|p| p.likelihood_ratio).sum::<f64>() / 60.0;
    assert_eq!(pools[0].degrees_of_freedom, 6.0);
    // The standard error of the mean of 60 χ² of 6 degrees of freedom is 0.45.
    assert!((3.5..7.0).contains(&mean), "{mean}");
}

/// Seeds 5000 to 5079, 20 pools each: noise in 5 minutes, a walk in 20 (in 10 minutes 16 of 20 are found).
#[test]
fn a_record_of_twice_the_noise_or_thrice_the_walk_is_found() {
    let (mut loud, mut wandering) = (0, 0);
    let usual = walk(0.02, 0.001);
    for seed in (0..20).map(|k| 5000 + 4 * k) {
        let found = compared(&[usual, walk(0.04, 0.001), usual, usual], 3000, seed);
        loud += usize::from(matches!(
            found.differing[..],
            [Difference {
                record: 1,
                white: Some(1.8..2.2),
                slow: None,
                ..
            }]
        ));
        let found = compared(&[usual, usual, usual, walk(0.02, 0.003)], 12_000, seed);
        wandering += usize::from(matches!(
            found.differing[..],
            [Difference {
                record: 3,
                white: None,
                slow: Some(1.5..6.0),
                ..
            }]
        ));
    }
    assert!(loud >= 19, "{loud}");
    assert!(wandering >= 18, "{wandering}");
}

#[test]
fn of_two_records_neither_is_the_usual_one() {
    let found = compared(&[walk(0.02, 0.001), walk(0.05, 0.001)], 3000, 9000);
    let [only] = found.differing[..] else {
        panic!("{:?}", found.differing)
    };
    assert!(only.other == Some(1 - only.record));
}

#[test]
fn a_record_with_the_outliers_of_all_differs() {
    let share = |outlier_events| Share {
        samples: 1000,
        outlier_events,
        ..Share::default()
    };
    let of = |events: [usize; 4]| {
        let mut differing = Vec::new();
        outliers(&events.map(share), LEVEL / 8.0, &mut differing);
        differing
            .iter()
            .map(|d| (d.record, d.outliers))
            .collect::<Vec<_>>()
    };
    // 0.25⁶ = 2.4e-4 and 0.25⁴ = 3.9e-3 about the level of 1.25e-3.
    assert_eq!(of([0, 6, 0, 0]), [(1, Some(f64::INFINITY))]);
    assert_eq!(of([0, 4, 0, 0]), []);
    assert_eq!(of([3, 4, 3, 4]), []);
    assert_eq!(of([0, 0, 0, 0]), []);
}

/// White noise has one factor: its own test is that of the record, and twice the logarithm of the likelihood ratio is
/// Σ n ln(v/vᵢ).
#[test]
fn of_white_noise_the_factor_is_all_that_differs() {
    let draw = |sigma: f64, samples: usize, seed: u64| {
        let white = CompositeTerms {
            white: sigma * T.sqrt(),
            ..CompositeTerms::default()
        };
        let mut record = vec![0.0; samples];
        NoiseGenerator::new(&white.to_shaping(T).unwrap(), seed).fill(&mut record);
        record
    };
    let (a, b) = (draw(1.0, 2000, 1), draw(1.05, 3000, 2));
    let variance = |record: &[f64]| {
        let mean = record.iter().sum::<f64>() / record.len() as f64;
        let squares = record.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
        squares / (record.len() - 1) as f64
    };
    let (va, vb) = (variance(&a), variance(&b));
    let joint = (1999.0 * va + 2999.0 * vb) / 4998.0;
    let ratio = 1999.0 * (joint / va).ln() + 2999.0 * (joint / vb).ln();
    let terms = CompositeTerms {
        white: T.sqrt(),
        ..CompositeTerms::default()
    };
    let mut shares = [2000, 3000].map(|samples| Share {
        samples,
        ..Share::default()
    });
    let found = Records::new(&[&a, &b], 1, T, terms).compare(&mut shares, LEVEL);
    let expected = ratio / found.inflation;
    assert!(
        (found.likelihood_ratio / expected - 1.0).abs() < 1e-3,
        "{} {expected}",
        found.likelihood_ratio
    );
    assert_eq!(found.degrees_of_freedom, 1.0);
    let factor = (vb / va).sqrt();
    for (share, factor) in shares.iter().zip([1.0 / factor, factor]) {
        assert!(
            (share.white.factor / factor - 1.0).abs() < 1e-3,
            "{:?}",
            share.white
        );
        let p = upper(1.0, expected);
        assert!((1e-4..0.5).contains(&p), "{p}");
        for found in [share.p_value, share.white.p_value] {
            assert!((found / p - 1.0).abs() < 0.01, "{found} {p}");
        }
        assert!(share.slow.is_none());
    }
}

#[test]
fn slow_terms_have_the_second_factor_and_all_others_the_first() {
    let process = |sigma: f64, tau_s: f64| GaussMarkov { sigma, tau_s };
    let terms = CompositeTerms {
        white: 1.0,
        quantisation: 2.0,
        random_walk: 3.0,
        flicker: 4.0,
        gauss_markov: [process(5.0, 0.99), process(6.0, 1.0)],
    };
    let records = Records::new(&[], 1, T, terms);
    assert_eq!(records.factors, 2);
    let close = |found: CompositeTerms, expected: [f64; 6]| {
        let [first, second] = found.gauss_markov;
        let all = [
            found.white,
            found.quantisation,
            found.random_walk,
            found.flicker,
            first.sigma,
            second.sigma,
        ];
        for (found, expected) in all.into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{all:?}");
        }
        assert_eq!([first.tau_s, second.tau_s], [0.99, 1.0]);
    };
    close(
        records.scaled(&[2f64.ln(), 3f64.ln()]),
        [2.0, 4.0, 9.0, 12.0, 10.0, 18.0],
    );
    // Without a second one the slow terms are as they are.
    close(
        records.scaled(&[2f64.ln()]),
        [2.0, 4.0, 3.0, 4.0, 10.0, 6.0],
    );
    let fast = CompositeTerms {
        white: 1.0,
        gauss_markov: [process(5.0, 0.99), process(0.0, 9.0)],
        ..CompositeTerms::default()
    };
    assert_eq!(Records::new(&[], 1, T, fast).factors, 1);
}
