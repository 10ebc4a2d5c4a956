//! Several records of one sensor: joint likelihoods against their parts, pooled fits and spreads against the simulated truth.

use undrift_nav::shaping::ShapingFilter;
use undrift_noise::arma::{self, FitOptions, Mean};
use undrift_noise::composite::{
    self, CompositeTerms, GaussMarkov, Level, Parameter, ParameterInterval, TermSet,
};
use undrift_noise::identify::{Axis, IdentifyError, Options, Pool, Sampled, identify_pool};
use undrift_noise::synthesis::NoiseGenerator;

const RATE: f64 = 10.0;
const WHITE: f64 = 0.002;
const LEVEL: f64 = 0.01;

fn draw(filter: &ShapingFilter, n: usize, seed: u64) -> Vec<f64> {
    let mut record = vec![0.0; n];
    NoiseGenerator::new(filter, seed).fill(&mut record);
    record
}

fn terms() -> CompositeTerms {
    let slow = GaussMarkov {
        sigma: 0.002,
        tau_s: 20.0,
    };
    CompositeTerms {
        white: WHITE,
        gauss_markov: [slow, GaussMarkov::default()],
        ..CompositeTerms::default()
    }
}

fn set() -> TermSet {
    TermSet {
        white: true,
        gauss_markov: 1,
        ..TermSet::default()
    }
}

fn filter(terms: &CompositeTerms) -> ShapingFilter {
    terms.to_shaping(1.0 / RATE).unwrap()
}

fn slices(records: &[Vec<f64>]) -> Vec<&[f64]> {
    records.iter().map(Vec::as_slice).collect()
}

#[test]
fn the_joint_arma_likelihood_is_that_of_its_parts_with_one_variance() {
    let process = ShapingFilter::arma(&[0.95], &[0.6], 0.3, 1.0).unwrap();
    let mut records = vec![
        draw(&process, 3000, 1),
        draw(&process, 1500, 2),
        draw(&process, 700, 3),
    ];
    // Own means, and missing samples in one of them.
    records[1].iter_mut().for_each(|x| *x += 40.0);
    records[2][100] = f64::NAN;
    for unit_root in [false, true] {
        let options = FitOptions {
            unit_root,
            effort: 0.1,
            ..FitOptions::default()
        };
        let joint = |ar: &[f64], ma: &[f64]| {
            let (mut n, mut squares, mut determinant) = (0.0, 0.0, 0.0);
            for record in &records {
                let one = arma::log_likelihood(record, ar, ma, Mean::Estimated, unit_root).unwrap();
                let m = one.observations as f64;
                n += m;
                squares += one.sum_of_squares;
                determinant -= 2.0 * one.log_likelihood
                    + m * (std::f64::consts::TAU * one.sum_of_squares / m).ln()
                    + m;
            }
            -0.5 * (n * (std::f64::consts::TAU * squares / n).ln() + n + determinant)
        };
        let found = arma::fit_several(&slices(&records), 1, 1, &options, &[]).unwrap();
        // Sums of 5200 terms.
        assert!((joint(&found.ar, &found.ma) - found.log_likelihood).abs() < 1e-6);
        assert_eq!(found.n, 5199 - if unit_root { 3 } else { 0 });
        let own = arma::fit(&records[0], 1, 1, &options).unwrap();
        assert!(joint(&own.ar, &own.ma) <= found.log_likelihood + 1e-5);
        if !unit_root {
            // Standard errors about 0.006 and 0.015.
            assert!((found.ar[0] - 0.95).abs() < 0.02, "{:?}", found.ar);
            assert!((found.ma[0] - 0.6).abs() < 0.05, "{:?}", found.ma);
        }
    }
}

#[test]
fn a_unit_root_of_unbroken_records_is_fitted_to_their_differences() {
    let process = ShapingFilter::random_walk(0.1, 1.0)
        .unwrap()
        .plus(&ShapingFilter::white(1.0, 1.0).unwrap())
        .unwrap();
    let records = [draw(&process, 2000, 4), draw(&process, 3000, 5)];
    let options = FitOptions {
        unit_root: true,
        effort: 0.1,
        ..FitOptions::default()
    };
    let found = arma::fit_several(&slices(&records), 1, 1, &options, &[]).unwrap();
    assert_eq!((found.n, found.ar[0]), (4998, 1.0));
    // θ of white noise 1 and steps 0.1: θ + 1/θ = 2 + 0.01; its standard error is 0.006.
    let theta = 1.005 - (1.005f64 * 1.005 - 1.0).sqrt();
    assert!(
        (found.ma[0] - theta).abs() < 0.025,
        "{:?} {theta}",
        found.ma
    );
}

#[test]
fn the_joint_likelihood_of_terms_is_the_sum_of_the_records() {
    let filter = filter(&terms());
    let records = [draw(&filter, 4000, 1), draw(&filter, 2500, 2)];
    let options = composite::FitOptions::default();
    let found = composite::fit_several(&slices(&records), 1.0 / RATE, set(), &options).unwrap();
    let at = found.to_shaping(1.0 / RATE).unwrap();
    let one = |record: &Vec<f64>| {
        composite::log_likelihood(record, &at, Level::Estimated)
            .unwrap()
            .restricted()
    };
    let sum: f64 = records.iter().map(one).sum();
    assert!((sum - found.log_likelihood).abs() < 1e-9 * sum.abs());
    assert_eq!((found.points, found.parameters), (6500, 5));
    let alone = composite::fit(&records[0], 1.0 / RATE, set(), &options).unwrap();
    let at = alone.to_shaping(1.0 / RATE).unwrap();
    let other: f64 = records
        .iter()
        .map(|r| {
            composite::log_likelihood(r, &at, Level::Estimated)
                .unwrap()
                .restricted()
        })
        .sum();
    assert!(other < found.log_likelihood + 1e-4);
}

/// Intervals of N, σ and τ of records fitted together.
fn intervals(records: &[&[f64]]) -> Option<Vec<ParameterInterval>> {
    let options = composite::FitOptions::default();
    let fit = composite::fit_several(records, 1.0 / RATE, set(), &options).unwrap();
    let found = composite::intervals_of_several(records, 1.0 / RATE, &fit, 0.95).unwrap();
    (found.len() == 3).then_some(found)
}

/// Seeds 1000 to 1039: of 40 pools of four records each 95 % interval covers the truth in 34 or more (by chance fewer in
/// 1.4 % of such tests), and is narrower than that of the first record alone, half as wide on average.
#[test]
fn pooled_intervals_are_narrower_and_cover() {
    let truth = [WHITE, 0.002, 20.0];
    let (mut covered, mut shrunk) = ([0; 3], [0.0; 3]);
    let filter = filter(&terms());
    for pool in 0..40 {
        let records: Vec<Vec<f64>> = (0..4)
            .map(|k| draw(&filter, 3000, 1000 + 40 * k + pool))
            .collect();
        let records = slices(&records);
        let together = intervals(&records).unwrap();
        let alone = intervals(&records[..1]);
        for (k, found) in together.iter().enumerate() {
            covered[k] += usize::from(found.low <= truth[k] && truth[k] <= found.high);
            let width = |i: &ParameterInterval| (i.high / i.low).ln();
            let of_one = alone
                .as_ref()
                .map_or(f64::INFINITY, |alone| width(&alone[k]));
            shrunk[k] += (width(found) / of_one) / 40.0;
        }
        assert_eq!(together[2].parameter, Parameter::Tau(0));
    }
    assert!(covered.iter().all(|c| *c >= 34), "{covered:?}");
    // 1/√4 for the white noise; the others' are wider than their asymptotes in one record.
    assert!(shrunk.iter().all(|s| *s < 0.56), "{shrunk:?}");
}

/// A pool of records of the terms, each about a constant of its own.
fn pool(terms: &[CompositeTerms], constants: &[f64], n: usize, seed: u64) -> (Axis, Pool) {
    let draw = |(k, (terms, constant)): (usize, (&CompositeTerms, &f64))| -> Vec<f64> {
        let record = draw(&filter(terms), n - 10 * k, seed + k as u64);
        record.iter().map(|x| x + constant).collect()
    };
    let records: Vec<Vec<f64>> = terms.iter().zip(constants).enumerate().map(draw).collect();
    let options = Options {
        n_max: 1,
        ..Options::at(RATE)
    };
    let sampled = slices(&records).into_iter();
    let sampled: Vec<Sampled<'_>> = sampled
        .map(|samples| Sampled { samples, options })
        .collect();
    identify_pool(&sampled, false, LEVEL).unwrap()
}

#[test]
fn a_pool_has_one_model_and_the_spread_of_its_constants() {
    let constants = [0.01, -0.02, 0.03, 0.0];
    let (axis, found) = pool(&[terms(); 4], &constants, 6000, 7);
    assert_eq!(axis.samples, 4 * 6000 - 60);
    let chosen = &axis.recommended().model;
    // Its standard error is 0.5 %.
    assert!(
        (chosen.white.unwrap() / WHITE - 1.0).abs() < 0.03,
        "{chosen:?}"
    );
    for (share, constant) in found.records.iter().zip(constants) {
        // σ √(2τ/T) of a mean: 0.002 √(40/600) = 5e-4.
        assert!((share.level - constant).abs() < 2e-3, "{share:?}");
        assert!(
            (2e-4..1e-3).contains(&share.level_standard_error),
            "{share:?}"
        );
    }
    // s of the constants is 0.0208.
    assert!(
        (found.between.sigma / 0.0208 - 1.0).abs() < 0.1,
        "{:?}",
        found.between
    );
    assert!(found.differing.is_empty(), "{:?}", found.differing);
}

#[test]
fn a_noisier_record_is_found_and_how_it_differs() {
    let loud = CompositeTerms {
        white: 2.0 * WHITE,
        ..terms()
    };
    let (_, found) = pool(&[terms(), terms(), loud, terms()], &[0.0; 4], 6000, 11);
    let [only] = found.differing[..] else {
        panic!("{:?}", found.differing)
    };
    assert_eq!((only.record, only.slow, only.outliers), (2, None, None));
    assert!((only.white.unwrap() - 2.0).abs() < 0.1, "{only:?}");
}

#[test]
fn a_record_that_cannot_be_used_is_named() {
    let options = Options::at(RATE);
    let good = draw(&filter(&terms()), 2000, 1);
    let brief = draw(&filter(&terms()), 500, 2);
    let sampled = [&good, &brief].map(|samples| Sampled { samples, options });
    let error = identify_pool(&sampled, false, LEVEL).unwrap_err();
    assert_eq!(error.record, Some(1));
    assert!(matches!(error.error, IdentifyError::Record(_)));
    assert!(identify_pool(&[], false, LEVEL).is_err());
}
