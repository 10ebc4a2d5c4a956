//! Composite models: likelihood against its definition, fits against the simulated truth.

use crate::common::with_best_scale;
use undrift_nav::shaping::ShapingFilter;
use undrift_noise::arma::{self, Mean};
use undrift_noise::composite::{
    self, CompositeError, CompositeFit, CompositeTerms, FitOptions, Flag, GaussMarkov, Level,
    Parameter, Term, TermSet, log_likelihood,
};
use undrift_noise::synthesis::NoiseGenerator;
use undrift_noise::wavelet::{MomentFit, fit_moments, wavelet_variance};

const T: f64 = 0.01;

fn draw(terms: &CompositeTerms, n: usize, seed: u64) -> Vec<f64> {
    let mut record = vec![0.0; n];
    NoiseGenerator::new(&terms.to_shaping(T).unwrap(), seed).fill(&mut record);
    record
}

fn process(sigma: f64, tau_s: f64) -> GaussMarkov {
    GaussMarkov { sigma, tau_s }
}

fn white_and_gauss_markov() -> CompositeTerms {
    CompositeTerms {
        white: 0.002,
        gauss_markov: [process(0.003, 20.0), GaussMarkov::default()],
        ..CompositeTerms::default()
    }
}

fn white_and_walk() -> CompositeTerms {
    CompositeTerms {
        white: 0.002,
        random_walk: 0.0005,
        ..CompositeTerms::default()
    }
}

fn white_and_two() -> CompositeTerms {
    CompositeTerms {
        white: 0.002,
        gauss_markov: [process(0.01, 0.3), process(0.006, 40.0)],
        ..CompositeTerms::default()
    }
}

/// Log-density of the present samples from the model's covariance matrix, by Cholesky.
fn by_definition(record: &[f64], filter: &ShapingFilter, level: f64) -> f64 {
    let mut lags = vec![0.0; record.len()];
    filter.autocovariance(&mut lags);
    let present: Vec<usize> = (0..record.len()).filter(|&k| !record[k].is_nan()).collect();
    let n = present.len();
    let covariance = nalgebra::DMatrix::from_fn(n, n, |i, j| lags[present[i].abs_diff(present[j])]);
    let y = nalgebra::DVector::from_fn(n, |i, _| record[present[i]] - level);
    let factor = covariance.cholesky().unwrap();
    let determinant: f64 = factor.l().diagonal().iter().map(|d| 2.0 * d.ln()).sum();
    -0.5 * (n as f64 * std::f64::consts::TAU.ln() + determinant + y.dot(&factor.solve(&y)))
}

#[test]
fn likelihood_is_the_multivariate_normal_one() {
    let terms = CompositeTerms {
        quantisation: 1e-4,
        ..white_and_two()
    };
    let all = terms.to_shaping(T).unwrap();
    let arma = ShapingFilter::arma(&[0.5, 0.2, -0.1], &[-0.3, 0.4], 0.01, T).unwrap();
    let coloured = ShapingFilter::gauss_markov(0.02, 0.05, T).unwrap(); // r = 0
    let blocks = composite::block_average(&all, 5).unwrap();
    let mut record = draw(&terms, 300, 1);
    record.iter_mut().for_each(|v| *v += 0.005);
    for gaps in [false, true] {
        if gaps {
            for k in [0, 7, 8, 9, 120, 298] {
                record[k] = f64::NAN;
            }
        }
        for filter in [all, arma, coloured, blocks] {
            let ours = log_likelihood(&record, &filter, Level::Known(0.005)).unwrap();
            let exact = by_definition(&record, &filter, 0.005);
            // The matrix has a condition of about 1e4 and the sum is about 1000.
            assert!(
                (ours.log_likelihood - exact).abs() < 1e-8,
                "{} {exact}",
                ours.log_likelihood
            );
            assert_eq!(ours.observations, if gaps { 294 } else { 300 });
            // The best level is the top of the parabola that the likelihood is in it.
            let best = log_likelihood(&record, &filter, Level::Estimated).unwrap();
            let at = |level| by_definition(&record, &filter, level);
            let exact = at(best.level);
            assert!((best.log_likelihood - exact).abs() < 1e-8);
            let e = best.level_standard_error;
            let (up, down) = (exact - at(best.level + e), exact - at(best.level - e));
            assert!(
                (up - 0.5).abs() < 1e-6 && (down - 0.5).abs() < 1e-6,
                "{up} {down}"
            );
        }
    }
}

#[test]
fn arma11_and_its_decomposition_have_one_likelihood() {
    // docs/theory.md, section 1: AR(1) of driving variance S σ² plus white noise of W σ².
    for (phi, theta) in [(0.99995, 0.9994), (0.9, 0.5), (1.0, 0.9994)] {
        let sigma = 0.006f64;
        let arma = ShapingFilter::arma(&[phi], &[theta], sigma, T).unwrap();
        let white = ShapingFilter::white((theta / phi * T).sqrt() * sigma, T).unwrap();
        let drive = (1.0 - phi * theta) * (phi - theta) / phi * sigma * sigma;
        let slow = if phi == 1.0 {
            ShapingFilter::random_walk((drive / T).sqrt(), T)
        } else {
            let variance: f64 = drive / ((1.0 - phi) * (1.0 + phi));
            ShapingFilter::gauss_markov(variance.sqrt(), -T / f64::ln(phi), T)
        };
        let sum = white.plus(&slow.unwrap()).unwrap();
        let mut record = vec![0.0; 200_000];
        NoiseGenerator::new(&sum, 3).fill(&mut record);
        for gap in [false, true] {
            if gap {
                record[150_000..150_200].fill(f64::NAN);
                record[199_990] = f64::NAN;
            }
            let a = log_likelihood(&record, &arma, Level::Known(0.0)).unwrap();
            let b = log_likelihood(&record, &sum, Level::Known(0.0)).unwrap();
            let mut miss = a.log_likelihood - b.log_likelihood;
            if phi == 1.0 {
                // Both random walks start at 0 but are not the same state. With the level free they
                // are the same model: the likelihood integrated over the level, ∫ p(x|level) d level
                // = p √(2π) · (its standard error), is that of the differences.
                let free = |filter: &ShapingFilter| {
                    let best = log_likelihood(&record, filter, Level::Estimated).unwrap();
                    let width = best.level_standard_error * std::f64::consts::TAU.sqrt();
                    best.log_likelihood + width.ln()
                };
                miss = free(&arma) - free(&sum);
            }
            // 700 000 of log-likelihood in 1e-16: 1e-10 a sum, and 1 − φ is stored to 2e-12.
            assert!(miss.abs() < 1e-6, "φ {phi}, gap {gap}: {miss:e}");
            if !gap && phi < 1.0 {
                let best = arma::log_likelihood(&record, &[phi], &[theta], Mean::Known(0.0), false);
                let miss = with_best_scale(&b) - best.unwrap().log_likelihood;
                assert!(miss.abs() < 1e-6, "φ {phi}: {miss:e}");
                let best = arma::log_likelihood(&record, &[phi], &[theta], Mean::Estimated, false);
                let ours = log_likelihood(&record, &arma, Level::Estimated).unwrap();
                let best = best.unwrap();
                assert!((with_best_scale(&ours) - best.log_likelihood).abs() < 1e-6);
                assert!((ours.level - best.mean).abs() < 1e-9 * sigma);
            }
        }
    }
}

/// (name, fitted, true) of every parameter that is in the truth.
fn pairs(found: &CompositeTerms, truth: &CompositeTerms) -> Vec<(&'static str, f64, f64)> {
    let mut list = vec![
        ("white", found.white, truth.white),
        ("quantisation", found.quantisation, truth.quantisation),
        ("walk", found.random_walk, truth.random_walk),
    ];
    for i in 0..2 {
        let (f, t) = (found.gauss_markov[i], truth.gauss_markov[i]);
        list.push((["sigma 1", "sigma 2"][i], f.sigma, t.sigma));
        list.push((["tau 1", "tau 2"][i], f.tau_s, t.tau_s));
    }
    list.retain(|p| p.2 != 0.0);
    list
}

/// Deviations of the logarithms over their standard errors; prints them.
fn deviations(
    found: &CompositeTerms,
    errors: &CompositeTerms,
    truth: &CompositeTerms,
) -> Vec<(f64, f64)> {
    let sizes = pairs(errors, truth);
    let mut list = Vec::new();
    for ((name, fitted, truth), (_, error, _)) in pairs(found, truth).into_iter().zip(sizes) {
        let deviation = (fitted / truth).ln();
        println!(
            "  {name}: {fitted:.6} for {truth:.6}, {:.2} of {error:.4}",
            deviation / error
        );
        list.push((deviation / error, error));
    }
    list
}

fn likelihood_fit(record: &[f64], set: TermSet) -> CompositeFit {
    let options = FitOptions::default();
    let found = composite::fit(record, T, set, &options).unwrap();
    println!(
        "log L {}, block {}, {:?}",
        found.log_likelihood, found.block, found.flags
    );
    found
}

fn moment_fit(record: &[f64], set: TermSet) -> MomentFit {
    let curve = wavelet_variance(record, T).unwrap();
    let found = fit_moments(&curve, set, false).unwrap();
    println!(
        "deviance {} of {}",
        found.deviance, found.degrees_of_freedom
    );
    found
}

#[test]
fn likelihood_and_moments_find_the_truth() {
    // 200 000 samples in blocks of 4: 2000 s, that is 100 correlation times of the first model's
    // process, 50 of the third's slow one.
    for (name, truth, largest) in [
        ("white + Gauss-Markov", white_and_gauss_markov(), 0.25),
        ("white + random walk", white_and_walk(), 0.08),
        ("white + 2 Gauss-Markov", white_and_two(), 0.45),
    ] {
        println!("{name}");
        let record = draw(&truth, 200_000, 11);
        let found = likelihood_fit(&record, truth.set());
        let errors = found.relative_errors.expect("curvature in every direction");
        assert_eq!((found.block, found.points), (4, 50_000));
        for (deviation, error) in deviations(&found.terms, &errors, &truth) {
            // Four standard errors: one in 16 000 of a normal deviate, of which there are ten.
            assert!(deviation.abs() < 4.0, "{name}");
            // Log-normal τ of so many correlation times is known to √(2·2/100) or so.
            assert!(error > 0.0 && error < largest, "{name}: {error}");
        }
        assert!(found.flags.is_empty(), "{:?}", found.flags);
        // The white density is taken from the full rate: 200 000 samples give it to 0.2 %.
        assert_eq!(found.terms.white, found.white_full_rate);
        assert!((found.terms.white / truth.white).ln().abs() < 0.008);
        // At the optimum no parameters are better, the true ones and the moments' not either.
        let averages = composite::average_in_blocks(&record, 4).unwrap();
        for other in [truth, found.moments.terms] {
            let model = composite::block_average(&other.to_shaping(T).unwrap(), 4).unwrap();
            let at = log_likelihood(&averages, &model, Level::Estimated).unwrap();
            assert!(at.restricted() <= found.log_likelihood + 1e-3);
        }
        // Moments: as sure of themselves, less precise.
        let moments = moment_fit(&record, truth.set());
        let errors = moments
            .relative_errors
            .expect("curvature in every direction");
        for (deviation, error) in deviations(&moments.terms, &errors, &truth) {
            assert!(
                deviation.abs() < 6.0 && error < 2.0 * largest,
                "{name}: {error}"
            );
        }
    }
}

#[test]
#[ignore = "slow: 32 fits on 50 000 samples"]
fn standard_errors_are_those_of_repeated_fits() {
    // 250 correlation times: with 25 the likelihood is skewed and σ comes out 0.6 errors low.
    let truth = CompositeTerms {
        white: 0.002,
        gauss_markov: [process(0.01, 2.0), GaussMarkov::default()],
        ..CompositeTerms::default()
    };
    let (mut likelihood, mut moments, mut count) = (0.0, 0.0, 0.0);
    for seed in 0..16 {
        let record = draw(&truth, 50_000, 100 + seed);
        let found = likelihood_fit(&record, truth.set());
        for (deviation, _) in deviations(&found.terms, &found.relative_errors.unwrap(), &truth) {
            likelihood += deviation * deviation;
            count += 1.0;
        }
        let found = moment_fit(&record, truth.set());
        for (deviation, _) in deviations(&found.terms, &found.relative_errors.unwrap(), &truth) {
            moments += deviation * deviation;
        }
    }
    for (name, squares) in [("likelihood", likelihood), ("moments", moments)] {
        let rms = f64::sqrt(squares / count);
        println!("{name}: rms deviation {rms} of {count}");
        // 48 deviates, those of σ and τ correlated: as 32, 1 ± 0.125; three of these.
        assert!((0.65..1.4).contains(&rms), "{name}: {rms}");
    }
}

#[test]
fn blocks_and_the_full_rate_agree() {
    let truth = white_and_two();
    let record = draw(&truth, 100_000, 21);
    let fit_with = |max_points| {
        let options = FitOptions {
            filtered: false,
            max_points,
            start: None,
            block: None,
        };
        composite::fit(&record, T, truth.set(), &options).unwrap()
    };
    let (full, blocks) = (fit_with(100_000), fit_with(10_000));
    assert_eq!((full.block, blocks.block), (1, 10));
    let errors = blocks.relative_errors.unwrap();
    // The blocks' information is part of the full rate's: the difference is within their errors.
    for (deviation, _) in deviations(&blocks.terms, &errors, &full.terms) {
        assert!(deviation.abs() < 3.0);
    }
}

#[test]
fn quantisation_is_found_beside_white_noise() {
    // σ_Q = Q/T = 0.02 a sample beside 0.02 of white noise.
    let truth = CompositeTerms {
        quantisation: 2e-4,
        ..white_and_gauss_markov()
    };
    for n in [40_000, 200_000] {
        let record = draw(&truth, n, 31);
        let found = likelihood_fit(&record, truth.set());
        println!("{:?}", found.terms);
        // ln N and ln Q of 40 000 samples to about 1 %; four of these.
        assert!((found.terms.white / truth.white).ln().abs() < 0.04);
        assert!((found.terms.quantisation / truth.quantisation).ln().abs() < 0.04);
        assert!(
            !found
                .flags
                .iter()
                .any(|f| matches!(f, Flag::ShortMemory(_)))
        );
        let moments = moment_fit(&record, truth.set());
        assert!((moments.terms.quantisation / truth.quantisation).ln().abs() < 0.08);
    }
}

#[test]
fn a_term_too_many_is_said_not_to_be_needed() {
    let record = draw(&white_and_gauss_markov(), 100_000, 41);
    let set = TermSet {
        random_walk: true,
        ..white_and_gauss_markov().set()
    };
    let found = likelihood_fit(&record, set);
    let vanished = Flag::Vanished(Term::RandomWalk);
    let said = found.flags.contains(&Flag::NotNeeded(Term::RandomWalk));
    assert!(said || found.flags.contains(&vanished), "{:?}", found.flags);
    // A second process and quantisation where there is neither: none of them is left as a state.
    let white = CompositeTerms {
        white: 0.002,
        ..CompositeTerms::default()
    };
    let set = TermSet {
        white: true,
        quantisation: true,
        random_walk: true,
        gauss_markov: 1,
        ..TermSet::default()
    };
    let found = likelihood_fit(&draw(&white, 50_000, 1), set);
    let needed = |f: &&Flag| !matches!(f, Flag::NotNeeded(_) | Flag::Vanished(_));
    assert_eq!(found.flags.iter().find(needed), None);
    assert!(found.flags.len() == 3 && found.relative_errors.is_some());
    assert!((found.terms.white / 0.002).ln().abs() < 0.015);
    // Short memory at the full rate that blocks of 10 no longer see.
    let arma = ShapingFilter::arma(&[-0.2], &[-0.5], 0.02, T).unwrap();
    let slow = ShapingFilter::gauss_markov(0.003, 20.0, T).unwrap();
    let mut record = vec![0.0; 200_000];
    NoiseGenerator::new(&arma.plus(&slow).unwrap(), 6).fill(&mut record);
    let options = FitOptions {
        filtered: false,
        max_points: 10_000,
        start: None,
        block: None,
    };
    let found = composite::fit(&record, T, white_and_gauss_markov().set(), &options).unwrap();
    assert!(
        found
            .flags
            .iter()
            .any(|f| matches!(f, Flag::ShortMemory(_)))
    );
    // Density at frequency zero: σ (1 − θ)/(1 − φ) √T = 0.0025; 10 000 blocks give it to 1 %, and
    // the memory's end makes the blocks' white 1.5 % less.
    let density = 0.02 * 1.5 / 1.2 * T.sqrt();
    assert!(
        (found.terms.white / density).ln().abs() < 0.05,
        "{:?}",
        found.terms
    );
}

#[test]
fn missing_samples_do_not_change_the_answer_much() {
    let truth = white_and_gauss_markov();
    let mut record = draw(&truth, 100_000, 51);
    let whole = likelihood_fit(&record, truth.set());
    for k in (0..record.len()).step_by(97) {
        record[k] = f64::NAN;
    }
    record[30_000..31_000].fill(f64::NAN);
    let gaps = likelihood_fit(&record, truth.set());
    for (deviation, _) in deviations(&gaps.terms, &whole.relative_errors.unwrap(), &whole.terms) {
        // Two hundredths of the record less: a sixth of a standard error; three of these.
        assert!(deviation.abs() < 0.5);
    }
}

#[test]
fn bad_input_is_an_error() {
    let set = white_and_gauss_markov().set();
    let options = FitOptions::default();
    let wave: Vec<f64> = (0..1000).map(|k| f64::from(k % 17)).collect();
    let fit = |record: &[f64], interval, set| composite::fit(record, interval, set, &options);
    assert!(matches!(
        fit(&[], T, set),
        Err(CompositeError::TooShort { .. })
    ));
    assert!(matches!(
        fit(&[1.0, 2.0], T, set),
        Err(CompositeError::TooShort { .. })
    ));
    assert_eq!(
        fit(&[3.0; 1000], T, set).unwrap_err(),
        CompositeError::Constant
    );
    assert!(fit(&[f64::NAN; 1000], T, set).is_err());
    assert!(fit(&[f64::INFINITY; 1000], T, set).is_err());
    assert!(fit(&wave, f64::NAN, set).is_err() && fit(&wave, -1.0, set).is_err());
    assert_eq!(
        fit(&wave, T, TermSet::default()).unwrap_err(),
        CompositeError::BadTerms
    );
    let three = TermSet {
        gauss_markov: 3,
        ..set
    };
    assert_eq!(fit(&wave, T, three).unwrap_err(), CompositeError::BadTerms);
    // Huge, tiny and absurd records: an answer or an error, no panic.
    for scale in [1e300, 1e-300, 1e-160, 1e150] {
        let record: Vec<f64> = wave.iter().map(|v| v * scale).collect();
        if let Ok(found) = fit(&record, T, set) {
            assert!(found.log_likelihood.is_finite());
        }
    }
    let none = ShapingFilter::none(T).unwrap();
    let level = Level::Known(0.0);
    assert_eq!(
        log_likelihood(&wave, &none, level),
        Err(CompositeError::NoVariance)
    );
    let constant = ShapingFilter::constant(1.0, T).unwrap();
    assert_eq!(
        log_likelihood(&wave, &constant, level),
        Err(CompositeError::NoVariance)
    );
    assert!(log_likelihood(&wave, &none, Level::Known(f64::NAN)).is_err());
}

#[test]
fn profile_intervals_hold_the_truth_and_open_where_the_record_ends() {
    let with = |tau_s| CompositeTerms {
        white: 1.0,
        gauss_markov: [GaussMarkov { sigma: 0.4, tau_s }, GaussMarkov::default()],
        ..CompositeTerms::default()
    };
    let bounds = |terms: &CompositeTerms, seed| {
        let mut record = vec![0.0; 72_000];
        NoiseGenerator::new(&terms.to_shaping(0.05).unwrap(), seed).fill(&mut record);
        let found = composite::fit(&record, 0.05, terms.set(), &FitOptions::default()).unwrap();
        composite::intervals(&record, 0.05, &found, 0.95).unwrap()
    };
    // 120 correlation times: bounded, each estimate inside.
    let terms = with(30.0);
    let found = bounds(&terms, 1);
    let of = |parameter| found.iter().find(|b| b.parameter == parameter).unwrap();
    for (parameter, truth) in [
        (Parameter::White, 1.0),
        (Parameter::Sigma(0), 0.4),
        (Parameter::Tau(0), 30.0),
    ] {
        let bound = of(parameter);
        assert!(bound.is_determined(), "{bound:?}");
        assert!(bound.low < bound.estimate && bound.estimate < bound.high);
        // Seed 1 is not one of the one in twenty.
        assert!(bound.low < truth && truth < bound.high, "{bound:?}");
    }
    // From the full rate: 1.96 · ½ √(3/72 000) either side.
    let white = of(Parameter::White);
    let half = 0.5 * (white.high / white.low).ln();
    assert!((half / 0.00632 - 1.0).abs() < 0.02, "{half}");
    // A tenth of a correlation time: no upper end.
    let found = bounds(&with(36_000.0), 2);
    let tau = found
        .iter()
        .find(|b| b.parameter == Parameter::Tau(0))
        .unwrap();
    assert!(tau.low > 100.0 && tau.high.is_infinite(), "{tau:?}");
}

#[test]
fn flicker_is_one_over_f_and_its_coefficient_is_found() {
    let truth = CompositeTerms {
        flicker: 0.15,
        ..CompositeTerms::default()
    };
    // The power density of the sum, against B²/(2πf): the ripple of one process a decade.
    let (processes, walk) = composite::flicker(0.15);
    for f in [1e-5, 1e-4, 1e-3, 0.01, 0.1] {
        let omega = std::f64::consts::TAU * f;
        let process =
            |g: &GaussMarkov| 2.0 * g.sigma * g.sigma * g.tau_s / (1.0 + (omega * g.tau_s).powi(2));
        let sum = processes.iter().map(process).sum::<f64>() + (walk / omega).powi(2);
        let density = 0.15f64.powi(2) / omega;
        let ratio = sum / density;
        // Below 1/(2π 3000 s) it is a random walk, which is more.
        // At 0.1 Hz the processes faster than 1 s begin to be missed.
        let range = match f {
            ..4e-5 => 0.9..4.0,
            0.05.. => 0.9..1.0,
            _ => 0.93..1.07,
        };
        assert!(range.contains(&ratio), "{f}: {ratio}");
    }
    let with_white = CompositeTerms {
        white: 1.0,
        ..truth
    };
    let mut record = vec![0.0; 200_000];
    NoiseGenerator::new(&with_white.to_shaping(0.05).unwrap(), 3).fill(&mut record);
    let found = composite::fit(&record, 0.05, with_white.set(), &FitOptions::default()).unwrap();
    let error = found.relative_errors.unwrap().flicker;
    // Four standard errors; B of so long a record is known to some percent.
    assert!(
        error < 0.1 && (found.terms.flicker / 0.15).ln().abs() < 4.0 * error,
        "{found:?}"
    );
}

/// Of one amplitude alone, with the level integrated out, −log L = (n − 1) (x + e^(−2(x − x̂))/2) in its logarithm x.
#[test]
fn the_interval_of_an_amplitude_is_where_its_likelihood_has_fallen() {
    let quantisation = CompositeTerms {
        quantisation: 0.5,
        ..CompositeTerms::default()
    };
    let flicker = CompositeTerms {
        flicker: 0.5,
        ..CompositeTerms::default()
    };
    for samples in [20, 100, 700, 3000] {
        let steps = (samples - 1) as f64;
        let fall = |off: f64| steps * (off + 0.5 * (-2.0 * off).exp_m1());
        for (truth, parameter) in [
            (quantisation, Parameter::Quantisation),
            (flicker, Parameter::Flicker),
        ] {
            let record = draw(&truth, samples, 5);
            let found = composite::fit(&record, T, truth.set(), &FitOptions::default()).unwrap();
            for (level, z) in [(0.5, 0.67448975), (0.95, 1.959963985), (0.999, 3.290526731)] {
                let end = |sign: f64| {
                    let (mut near, mut far) = (0.0, 5.0);
                    for _ in 0..60 {
                        let middle = 0.5 * (near + far);
                        match fall(sign * middle) < 0.5 * z * z {
                            true => near = middle,
                            false => far = middle,
                        }
                    }
                    sign * near
                };
                let [of] = composite::intervals(&record, T, &found, level).unwrap()[..] else {
                    panic!("{samples}");
                };
                assert!(of.parameter == parameter && of.is_determined());
                for (found, exact) in [(of.low, end(-1.0)), (of.high, end(1.0))] {
                    let off = (found / of.estimate).ln();
                    // An end is found to a hundredth of its distance.
                    assert!(
                        (off - exact).abs() < 0.01 * exact.abs(),
                        "{parameter:?} {samples} {level}: {off} {exact}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_interval_of_white_noise_goes_by_its_kurtosis_and_the_samples_present() {
    let truth = CompositeTerms {
        white: 0.01,
        ..CompositeTerms::default()
    };
    let normal = draw(&truth, 20_000, 9);
    // A cube is heavy-tailed; a sign times one is not, and counts as normal.
    let heavy: Vec<f64> = normal.iter().map(|x| x * x.abs()).collect();
    let light: Vec<f64> = normal.iter().map(|x| 0.1 * x.signum()).collect();
    for (mut record, is_heavy) in [(heavy, true), (light, false)] {
        for missing in [false, true] {
            if missing {
                record[3000..8000].fill(f64::NAN);
            }
            let present = || record.iter().filter(|x| !x.is_nan());
            let count = present().count() as f64;
            let squares: f64 = present().map(|x| x * x).sum();
            let fourths: f64 = present().map(|x| x.powi(4)).sum();
            let kurtosis = if is_heavy {
                count * fourths / (squares * squares)
            } else {
                3.0
            };
            let found = composite::fit(&record, T, truth.set(), &FitOptions::default()).unwrap();
            let [of] = composite::intervals(&record, T, &found, 0.9).unwrap()[..] else {
                panic!("{is_heavy}");
            };
            // The variance of the logarithm of a standard deviation is (κ − 1)/(4n).
            let half = 1.644854 * 0.5 * ((kurtosis - 1.0) / count).sqrt();
            let sides = [(of.high / of.estimate).ln(), (of.estimate / of.low).ln()];
            for side in sides {
                // Of a kurtosis of 12 that of the differences scatters by some percent.
                assert!(
                    (side / half - 1.0).abs() < 0.05,
                    "{is_heavy} {missing}: {side} {half}"
                );
            }
        }
    }
}

/// White noise through a first-order filter of 50 ms with a walk, in blocks of six times that: their variance is 1 − τ/T of N²/T and next to
/// each other they are correlated by τ/2T, so that without it N is 9 % low.
#[test]
fn white_noise_behind_a_filter_is_its_density_at_frequency_zero() {
    let (sigma, tau_s, block) = (1.0, 0.05, 30);
    let fast = GaussMarkov { sigma, tau_s };
    let truth = CompositeTerms {
        random_walk: 0.01,
        gauss_markov: [fast, GaussMarkov::default()],
        ..CompositeTerms::default()
    };
    let phi = (-T / tau_s).exp();
    let density = sigma * (T * (1.0 + phi) / (1.0 - phi)).sqrt();
    let set = TermSet {
        white: true,
        random_walk: true,
        ..TermSet::default()
    };
    let options = FitOptions {
        block: Some(block),
        filtered: true,
        ..FitOptions::default()
    };
    let (mut sum, mut overlap, mut held) = (0.0, 0.0, 0);
    for seed in 1..=12 {
        let record = draw(&truth, 60_000, seed);
        let found = composite::fit(&record, T, set, &options).unwrap();
        sum += found.terms.white / density / 12.0;
        overlap += found.overlap / 12.0;
        let intervals = composite::intervals(&record, T, &found, 0.95).unwrap();
        held += i32::from((intervals[0].low..intervals[0].high).contains(&density));
    }
    // N is known to 3 % each, the overlap to 0.02.
    assert!((sum - 1.0).abs() < 0.025, "{sum}");
    let exact = 0.5 * tau_s / (block as f64 * T);
    assert!((overlap - exact).abs() < 0.02, "{overlap} {exact}");
    assert!(held >= 10, "{held}");
}
