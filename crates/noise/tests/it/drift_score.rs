//! Drift score and identification at several scales: against definition, simulated truth and a real gyro.

use crate::common;
use std::time::Instant;
use undrift_nav::shaping::ShapingFilter;
use undrift_noise::composite::{self, CompositeTerms, FitOptions, GaussMarkov, TermSet};
use undrift_noise::drift_score::{DriftError, HORIZONS_S, HorizonScore, Scored, recommend, score};
use undrift_noise::model_file::reason;
use undrift_noise::scales::{self, BLOCKS, Flag, Scales};
use undrift_noise::synthesis::NoiseGenerator;

const T: f64 = 0.01;

fn process(sigma: f64, tau_s: f64) -> GaussMarkov {
    GaussMarkov { sigma, tau_s }
}

fn terms(white: f64, processes: &[GaussMarkov], random_walk: f64) -> CompositeTerms {
    let mut gauss_markov = [GaussMarkov::default(); 2];
    gauss_markov[..processes.len()].copy_from_slice(processes);
    CompositeTerms {
        white,
        random_walk,
        gauss_markov,
        ..CompositeTerms::default()
    }
}

fn draw(terms: &CompositeTerms, n: usize, seed: u64) -> Vec<f64> {
    let mut record = vec![0.0; n];
    NoiseGenerator::new(&terms.to_shaping(T).unwrap(), seed).fill(&mut record);
    record
}

#[test]
fn score_is_the_error_of_the_conditional_mean() {
    // The prediction is E[sum of the next k | all before], from the covariance matrix.
    let arma = ShapingFilter::arma(&[0.9, -0.2], &[0.3], 0.02, T).unwrap();
    let sum = terms(0.002, &[process(0.03, 0.2), process(0.01, 2.0)], 0.0)
        .to_shaping(T)
        .unwrap();
    for filter in [arma, sum] {
        let (n, first, k) = (140, 60, 7);
        let mut record = vec![0.0; n];
        NoiseGenerator::new(&filter, 4).fill(&mut record);
        let mean = record[..first].iter().sum::<f64>() / first as f64;
        let mut lags = vec![0.0; n];
        filter.autocovariance(&mut lags);
        let (mut squares, mut expected) = (0.0, 0.0);
        for origin in first..=n - k {
            let past = nalgebra::DMatrix::from_fn(origin, origin, |i, j| lags[i.abs_diff(j)]);
            let ahead = nalgebra::DVector::from_fn(origin, |i, _| {
                (0..k).map(|j| lags[origin + j - i]).sum::<f64>()
            });
            let weights = past.cholesky().unwrap().solve(&ahead);
            let predicted: f64 = (0..origin).map(|i| weights[i] * (record[i] - mean)).sum();
            let actual: f64 = record[origin..origin + k].iter().map(|v| v - mean).sum();
            squares += (T * (actual - predicted)).powi(2);
            let own: f64 = (0..k * k).map(|ij| lags[(ij / k).abs_diff(ij % k)]).sum();
            expected += T * T * (own - weights.dot(&ahead));
        }
        let count = (n - k - first + 1) as f64;
        let found = &score(&record, first, &filter, &[k as f64 * T]).unwrap()[0];
        assert_eq!(found.origins as f64, count);
        let (rms, predicted) = ((squares / count).sqrt(), (expected / count).sqrt());
        // The matrix has a condition of 1e4.
        assert!((found.rms / rms - 1.0).abs() < 1e-10, "{} {rms}", found.rms);
        assert!((found.predicted_rms / predicted - 1.0).abs() < 1e-10);
    }
}

#[test]
#[ignore = "slow: fits and scores on 400 000 samples"]
fn the_true_model_drifts_as_it_says_and_no_wrong_one_less() {
    let truth_of = [
        (
            "white + Gauss-Markov",
            terms(0.002, &[process(0.003, 20.0)], 0.0),
        ),
        ("white + random walk", terms(0.002, &[], 0.0005)),
        (
            "white + 2 Gauss-Markov",
            terms(0.002, &[process(0.01, 0.3), process(0.006, 40.0)], 0.0),
        ),
    ];
    for (name, truth) in truth_of {
        println!("{name}");
        let record = draw(&truth, 400_000, 7);
        let first = record.len() / 2;
        let run = |terms: &CompositeTerms| {
            // Of 300 s there are seven windows, too few to judge by.
            score(
                &record,
                first,
                &terms.to_shaping(T).unwrap(),
                &HORIZONS_S[..3],
            )
            .unwrap()
        };
        let own = run(&truth);
        for h in &own {
            println!(
                "  {} s: {:.4e} ± {:.1e}, expected {:.4e}, {} windows",
                h.horizon_s, h.rms, h.standard_error, h.predicted_rms, h.windows
            );
            assert!(h.rms > 0.0 && h.standard_error < 0.25 * h.rms);
            assert!((h.rms - h.predicted_rms).abs() < 3.0 * h.standard_error);
        }
        let slower = truth
            .gauss_markov
            .map(|g| process(g.sigma, 100.0 * g.tau_s));
        let wrong = [
            ("white alone", terms(truth.white, &[], 0.0)),
            (
                "Gauss-Markov, far too fast",
                terms(truth.white, &[process(0.01, 0.5)], 0.0),
            ),
            ("walk, 5 times", terms(truth.white, &[], 0.005)),
            ("walk, a fiftieth", terms(truth.white, &[], 2e-5)),
            (
                "τ 100 times, white double",
                terms(2.0 * truth.white, &slower, 0.3 * truth.random_walk),
            ),
        ];
        for (wrong_name, wrong) in wrong {
            let other = run(&wrong);
            for (a, b) in own.iter().zip(&other) {
                println!(
                    "  {wrong_name}, {} s: {:.3} of the true",
                    a.horizon_s,
                    b.rms / a.rms
                );
                // Paired over the same record the difference is known better than either score.
                assert!(
                    a.rms < b.rms + b.standard_error.min(0.02 * b.rms),
                    "{wrong_name}"
                );
            }
            assert!(
                other[2].rms > 1.04 * own[2].rms,
                "{wrong_name} must be seen to be wrong at 60 s"
            );
        }
    }
}

fn candidates(record: &[f64], first: usize, sets: &[(&str, TermSet)]) -> Vec<Scored> {
    sets.iter()
        .map(|&(name, set)| {
            let found = composite::fit(&record[..first], T, set, &FitOptions::default()).unwrap();
            let filter = found.to_shaping(T).unwrap();
            Scored {
                name: name.into(),
                states: filter.order,
                parameters: set.parameters(),
                aic: f64::INFINITY,
                horizons: score(record, first, &filter, &HORIZONS_S).unwrap(),
            }
        })
        .collect()
}

const SETS: [(&str, TermSet); 4] = [
    ("white", set(0, false)),
    ("white + random walk", set(0, true)),
    ("white + Gauss-Markov", set(1, false)),
    ("white + 2 Gauss-Markov", set(2, false)),
];

const fn set(gauss_markov: usize, random_walk: bool) -> TermSet {
    TermSet {
        white: true,
        quantisation: false,
        flicker: false,
        random_walk,
        gauss_markov,
    }
}

fn print(list: &[Scored]) {
    for candidate in list {
        let show = |h: &HorizonScore| {
            format!(
                "{:.4e} ± {:.1e} ({:.4e})",
                h.rms, h.standard_error, h.predicted_rms
            )
        };
        let scores: Vec<String> = candidate.horizons.iter().map(show).collect();
        println!("  {}: {}", candidate.name, scores.join("; "));
    }
}

#[test]
fn the_simplest_sufficient_model_is_recommended() {
    for (truth, expected) in [
        (terms(0.002, &[], 0.0), 0),
        (terms(0.002, &[], 0.0005), 1),
        // τ = 6 s: by 60 s a random walk is clearly wrong.
        (terms(0.002, &[process(0.006, 6.0)], 0.0), 2),
        (
            terms(0.002, &[process(0.02, 0.5), process(0.006, 60.0)], 0.0),
            3,
        ),
    ] {
        let record = draw(&truth, 400_000, 17);
        let list = candidates(&record, record.len() / 2, &SETS);
        print(&list);
        let choice = recommend(&list).unwrap();
        println!("{}", reason(&choice.reason));
        assert_eq!(choice.index, expected, "{:?}", choice.reason);
        assert_eq!(choice.reason.name, SETS[expected].0);
    }
}

#[test]
fn missing_samples_and_the_constant() {
    let truth = terms(0.002, &[process(0.003, 20.0)], 0.0);
    let filter = truth.to_shaping(T).unwrap();
    let record = draw(&truth, 200_000, 27);
    let plain = score(&record, 100_000, &filter, &HORIZONS_S).unwrap();
    // A turn-on bias a thousand times the noise goes with the mean.
    let shifted: Vec<f64> = record.iter().map(|v| v + 20.0).collect();
    for (a, b) in plain
        .iter()
        .zip(score(&shifted, 100_000, &filter, &HORIZONS_S).unwrap())
    {
        // Rounding of 20 + 1e-3: 4e-15 a sample, in errors of 1e-3.
        assert!((a.rms / b.rms - 1.0).abs() < 1e-9, "{} {}", a.rms, b.rms);
    }
    // One sample in 211 missing: every window is short of up to a hundredth.
    let mut gaps = record.clone();
    for k in (0..gaps.len()).step_by(211) {
        gaps[k] = f64::NAN;
    }
    for (a, b) in plain
        .iter()
        .zip(score(&gaps, 100_000, &filter, &HORIZONS_S).unwrap())
    {
        // Where k = 100 a window with one missing just counts. White noise of 0.02 a sample, 1 in
        // 211: the integral changes by 5 % of its white part, the RMS far less.
        assert!((a.rms / b.rms - 1.0).abs() < 0.02, "{} {}", a.rms, b.rms);
        assert_eq!(a.origins, b.origins);
    }
    // A hole of 50 s in the scored part: windows in it are left out, those around it are not.
    gaps = record.clone();
    gaps[150_000..155_000].fill(f64::NAN);
    let holed = score(&gaps, 100_000, &filter, &HORIZONS_S).unwrap();
    // A window of k may reach into the hole by a third of k, on either side; of 100 every third is scored.
    let lost = (plain[0].origins - holed[0].origins) as f64;
    assert!(
        (lost - (5_000.0 + 99.0 - 66.0) / 3.0).abs() <= 1.0,
        "{lost}"
    );
    assert!((holed[2].rms / plain[2].rms - 1.0).abs() < 0.15);
}

#[test]
fn bad_input_is_an_error() {
    let filter = terms(0.002, &[process(0.003, 20.0)], 0.0)
        .to_shaping(T)
        .unwrap();
    let record = vec![0.5; 1000];
    let run = |record: &[f64], first, horizons: &[f64]| score(record, first, &filter, horizons);
    assert!(matches!(
        run(&record, 500, &[60.0]),
        Err(DriftError::TooShort { .. })
    ));
    assert!(matches!(
        run(&[], 0, &[1.0]),
        Err(DriftError::TooShort { .. })
    ));
    assert_eq!(run(&record, 500, &[]), Err(DriftError::BadHorizon));
    for horizon in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9] {
        assert_eq!(run(&record, 500, &[horizon]), Err(DriftError::BadHorizon));
    }
    assert!(run(&record, 0, &[1.0]).is_err() && run(&record, 5000, &[1.0]).is_err());
    assert!(run(&[f64::NAN; 1000], 500, &[1.0]).is_err());
    assert!(run(&[f64::INFINITY; 1000], 500, &[1.0]).is_err());
    let mut half = record.clone();
    half[500..].fill(f64::NAN);
    assert_eq!(run(&half, 500, &[1.0]), Err(DriftError::NoWindow));
    let none = ShapingFilter::none(T).unwrap();
    assert!(score(&record, 500, &none, &[1.0]).is_err());
    // A constant record under a good model: no drift at all.
    assert!(run(&record, 500, &[1.0]).unwrap()[0].rms < 1e-12);
    assert!(scales::identify(&record, T, &BLOCKS, 0.1).is_ok());
    assert!(scales::identify(&[], T, &BLOCKS, 0.1).is_err());
    assert!(scales::identify(&[f64::INFINITY; 1000], T, &BLOCKS, 0.1).is_err());
    assert!(scales::identify(&record, -T, &BLOCKS, 0.1).is_err());
}

fn print_scales(found: &Scales) {
    for scale in &found.scales {
        println!(
            "  block {}: φ {:.6} θ {:.6}, {:?}, errors {:?}, {:?}",
            scale.block, scale.phi, scale.theta, scale.lifted, scale.relative_errors, scale.flags
        );
    }
    println!("  chosen {:?}, agreeing {}", found.chosen, found.agreeing);
}

#[test]
fn scales_lift_back_to_the_truth() {
    for truth in [
        terms(0.002, &[process(0.003, 20.0)], 0.0),
        terms(0.002, &[], 0.0005),
    ] {
        let record = draw(&truth, 200_000, 37);
        let found = scales::identify(&record, T, &BLOCKS, 0.1).unwrap();
        print_scales(&found);
        let drive = truth.gauss_markov[0].drive() + truth.random_walk;
        for scale in &found.scales {
            let (lifted, errors) = (scale.lifted.unwrap(), scale.relative_errors);
            // White noise in n blocks is known to 1/√(2n), at 500 beside a process that is no longer
            // slow to it; three and a half errors of 15 figures.
            for (name, value, truth, error) in [
                ("white", lifted.white, truth.white, errors.white),
                ("drive", lifted.drive, drive, errors.drive),
            ] {
                let miss = (value / truth).ln();
                assert!(
                    miss.abs() < 3.5 * error,
                    "{} {name}: {value} {error}",
                    scale.block
                );
                assert!(error < 0.6, "{} {name}: {error}", scale.block);
            }
            if truth.random_walk == 0.0 {
                let miss = (lifted.tau_s / 20.0).ln();
                assert!(
                    miss.abs() < 3.5 * errors.tau_s && errors.tau_s < 0.5,
                    "{miss}"
                );
            }
            assert_eq!(scale.filter.unwrap().interval, T);
        }
        assert_eq!((found.chosen, found.agreeing), (Some(0), 5));
    }
    // A short memory over the slow part: the full rate sees only that, the blocks the slow part.
    let short = ShapingFilter::arma(&[-0.19], &[-0.51], 0.02, T).unwrap();
    let slow = ShapingFilter::gauss_markov(0.0015, 40.0, T).unwrap();
    let mut record = vec![0.0; 400_000];
    NoiseGenerator::new(&short.plus(&slow).unwrap(), 47).fill(&mut record);
    let found = scales::identify(&record, T, &BLOCKS, 0.1).unwrap();
    print_scales(&found);
    assert!(found.scales[0].flags.contains(&Flag::NoSlowPart));
    assert!(found.chosen.unwrap() >= 1 && found.agreeing >= 3);
    let chosen = &found.scales[found.chosen.unwrap()];
    let (lifted, errors) = (chosen.lifted.unwrap(), chosen.relative_errors);
    // White density of the short memory: σ √T (1 − θ)/(1 − φ).
    let density = 0.02 * T.sqrt() * 1.51 / 1.19;
    assert!((lifted.white / density).ln().abs() < 0.03, "{lifted:?}");
    assert!(
        (lifted.sigma / 0.0015).ln().abs() < 3.5 * errors.sigma,
        "{lifted:?}"
    );
}

#[test]
#[ignore = "slow: fits on a recording of hours"]
fn the_slow_bias_of_a_real_gyro() {
    let Some(mut axes) = common::record("adis16405-static/run2.csv.gz") else {
        return;
    };
    // z gyro [deg/s] at nominally 100 Hz, 1 000 000 samples.
    let mut record = axes.swap_remove(2);
    record.iter_mut().for_each(|v| *v = v.to_radians());
    let clock = Instant::now();
    let found = scales::identify(&record, T, &BLOCKS, 0.1).unwrap();
    println!(
        "scales of run2, z gyro [rad, s], in {:.1} s",
        clock.elapsed().as_secs_f64()
    );
    print_scales(&found);
    let clock = Instant::now();
    let mut list = candidates(&record, record.len() / 2, &SETS);
    println!(
        "fits on the first half and scores in {:.1} s",
        clock.elapsed().as_secs_f64()
    );
    for (name, block) in [("scale 1", 0), ("scale 100", 3), ("scale 500", 4)] {
        let half = scales::identify(&record[..500_000], T, &BLOCKS[block..=block], 0.1).unwrap();
        if let Some(filter) = half.scales[0].filter {
            list.push(Scored {
                name: name.into(),
                states: filter.order,
                parameters: 3,
                aic: f64::INFINITY,
                horizons: score(&record, 500_000, &filter, &HORIZONS_S).unwrap(),
            });
        }
    }
    print(&list);
    let choice = recommend(&list).unwrap();
    println!("{}", reason(&choice.reason));
    // One-step likelihood at the full rate sees the sensor's short memory and no bias.
    assert!(found.scales[0].flags.contains(&Flag::NoSlowPart));
    for scale in &found.scales[3..] {
        let lifted = scale.lifted.unwrap();
        assert!(scale.seen, "block {}", scale.block);
        // Blocks of run1 give σ 4.4e-4 rad/s and N 6.6e-4 … 6.8e-4 rad/√s. N is the sensor's and known
        // to 2 %; σ of another run may be half as much again.
        assert!((6.3e-4..7.1e-4).contains(&lifted.white), "{lifted:?}");
        assert!((2.9e-4..6.6e-4).contains(&lifted.sigma), "{lifted:?}");
        // τ is known to 30 % from one record; run1 has 470 … 540 s.
        assert!((130.0..700.0).contains(&lifted.tau_s), "{lifted:?}");
    }
    assert!(found.scales[3].agrees_with(&found.scales[4]));
    assert!(found.scales[found.chosen.unwrap()].block <= 100 && found.agreeing >= 3);
    // A bias of 4e-4 rad/s over 60 s is 0.026 rad beside 0.005 rad of white noise.
    let (white, chosen) = (&list[0].horizons[2], &list[choice.index].horizons[2]);
    assert!(white.rms > 2.0 * chosen.rms && list[choice.index].states > 0);
}
