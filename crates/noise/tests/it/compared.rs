//! The methods that the source paper compares with: against scipy and statsmodels, closed forms and simulated records.

use crate::common::{close, near, number, numbers};
use undrift_noise::{
    allan::{self, Curve, DeviationKind, Grid, Point, gauss_markov::gauss_markov_variance},
    compared::{
        Method, Unfit, allan_bound, allan_minimum, autocorrelation,
        power_spectrum::{self, Octave},
    },
    composite::{CompositeTerms, GaussMarkov},
    identify::{Options, identify},
    spectrum,
    synthesis::NoiseGenerator,
};

const RATE: f64 = 20.0;

fn uniform(mut state: u64, count: usize) -> Vec<f64> {
    let next = || {
        let value = state as f64 / 2_147_483_647.0 - 0.5;
        state = state * 16_807 % 2_147_483_647;
        value
    };
    std::iter::repeat_with(next).take(count).collect()
}

/// The series of `testdata/golden/compared.py`.
fn golden() -> (serde_json::Value, Vec<f64>) {
    let text = include_str!("../../../../testdata/golden/compared.json");
    let golden: serde_json::Value = serde_json::from_str(text).unwrap();
    let (white, drive) = (uniform(1_234_567_890, 40_000), uniform(987_654_321, 40_000));
    let mut slow = 0.0;
    let series = white.iter().zip(drive).map(|(white, drive)| {
        slow = 0.998 * slow + 0.02 * drive;
        white + slow
    });
    let series: Vec<f64> = series.collect();
    for (ours, theirs) in series.iter().zip(numbers(&golden["first"])) {
        near(*ours, theirs, 1e-15, "the series is the same");
    }
    (golden, series)
}

fn curve(record: &[f64]) -> Curve {
    allan::deviations(record, RATE, DeviationKind::Overlapping, Grid::Octave).unwrap()
}

fn simulated(terms: &CompositeTerms, samples: usize, seed: u64) -> Vec<f64> {
    let mut record = vec![0.0; samples];
    let filter = terms.to_shaping(1.0 / RATE).unwrap();
    NoiseGenerator::new(&filter, seed).fill(&mut record);
    record
}

fn white_and_process(sigma: f64, tau_s: f64) -> CompositeTerms {
    CompositeTerms {
        white: 1.0,
        gauss_markov: [GaussMarkov { sigma, tau_s }, GaussMarkov::default()],
        ..CompositeTerms::default()
    }
}

#[test]
fn the_spectrum_fit_is_that_of_scipy() {
    let (golden, series) = golden();
    let golden = &golden["power_spectrum"];
    let segment = power_spectrum::segment(series.len());
    assert_eq!(segment as u64, golden["segment"].as_u64().unwrap());
    let density = spectrum::welch(&series, RATE, segment).unwrap();
    let octaves = power_spectrum::octaves(&density, 0.1 * RATE);
    let theirs = numbers(&golden["octaves"]);
    assert_eq!(octaves.len(), theirs.len());
    for (ours, theirs) in octaves.iter().zip(&theirs) {
        close(ours.density, *theirs, 1e-9, "octave");
    }
    let found = power_spectrum::fit(&series, RATE).unwrap();
    let found = [found.white, found.flicker, found.random_walk];
    // scipy's trust region stops where the cost no longer falls: square root of its 1e-15.
    for (ours, theirs) in found.iter().zip(numbers(&golden["squares"])) {
        close(ours * ours, theirs, 1e-5, "square of a term");
    }
}

#[test]
fn the_autocorrelation_fit_is_that_of_statsmodels() {
    let (golden, series) = golden();
    let golden = &golden["autocorrelation"];
    let found = autocorrelation::fit(&series, RATE).unwrap();
    close(found.white, number(&golden["white"]), 1e-9, "N");
    let process = found.gauss_markov[0];
    close(process.sigma, number(&golden["sigma"]), 1e-9, "σ");
    close(process.tau_s, number(&golden["tau_s"]), 1e-9, "τ");
}

#[test]
fn the_bound_is_that_of_a_linear_programme() {
    let (golden, series) = golden();
    let golden = &golden["allan_bound"];
    let found = allan_bound::fit(&curve(&series)).unwrap();
    // The closed form there loses digits to cancellation, and its solver is exact to 1e-7.
    close(found.white, number(&golden["white"]), 1e-5, "N");
    let process = found.gauss_markov[0];
    close(process.sigma, number(&golden["sigma"]), 1e-5, "σ");
    close(process.tau_s, number(&golden["tau_s"]), 1e-9, "τ");
}

#[test]
fn exact_slopes_give_exact_terms() {
    let truth = [2.0, 0.3, 0.05f64];
    let octaves: Vec<Octave> = (0..8)
        .map(|i| {
            let f = 0.01 * f64::from(1 << i);
            let [n, b, k] = truth.map(|term| term * term);
            let tau = std::f64::consts::TAU;
            Octave {
                density: n + b / (tau * f) + k / (tau * tau * f * f),
                inverse: 1.0 / f,
                inverse_square: 1.0 / (f * f),
            }
        })
        .collect();
    let found = power_spectrum::fit_octaves(&octaves).unwrap();
    for (found, truth) in [found.white, found.flicker, found.random_walk]
        .iter()
        .zip(truth)
    {
        close(*found, truth, 1e-9, "term");
    }
    let too_few = power_spectrum::fit_octaves(&octaves[..3]);
    assert!(matches!(too_few, Err(Unfit::TooFew { got: 3, .. })));
}

#[test]
fn an_exact_exponential_gives_the_exact_process() {
    // Averages over 1 s: the closed forms of the module, summed here over 1000 points a second instead.
    let (sigma, tau_s, white) = (0.7f64, 8.0, 1.3f64);
    let points = 1000;
    let covariance = |lag: usize| {
        let differences = 1 - points as i64..points as i64;
        let sum: f64 = differences
            .map(|d| {
                let weight = (points as i64 - d.abs()) as f64;
                weight * (-(lag as f64 + d as f64 / points as f64).abs() / tau_s).exp()
            })
            .sum();
        sigma * sigma * sum / (points * points) as f64
    };
    let mut lags: Vec<f64> = (0..40).map(covariance).collect();
    lags[0] += white * white;
    let found = autocorrelation::process(&lags, 10_000, 1.0).unwrap();
    // The sum is off by 1/(12 points²)·(1/τ)² relatively, and at lag 0 by its kink: 1e-4/1000.
    close(found.tau_s, tau_s, 1e-6, "τ");
    close(found.sigma, sigma, 1e-6, "σ");
    let density = autocorrelation::white(lags[0], 1.0, &found).unwrap();
    close(density, white, 1e-6, "N");
    let without = autocorrelation::white(0.9 * sigma * sigma, 1.0, &found);
    assert_eq!(without, Err(Unfit::NoWhite));
}

#[test]
fn an_autocorrelation_that_is_white_or_does_not_fall_says_so() {
    let flat = autocorrelation::process(&[2.0, 1.0, 0.9, 0.8], 100, 1.0);
    assert_eq!(flat, Err(Unfit::NotFalling { longest_s: 3.0 }));
    let white = autocorrelation::process(&[1.0, 0.1, 0.0, 0.0], 100, 1.0);
    assert_eq!(white, Err(Unfit::White));
    assert!(autocorrelation::fit(&[1.0; 1000], RATE).is_err());
    assert!(autocorrelation::fit(&[], RATE).is_err());
    assert!(power_spectrum::fit(&[1.0; 1000], RATE).is_err());
    assert!(power_spectrum::fit(&[1.0, f64::NAN, 2.0, 3.0], RATE).is_err());
}

/// Medians over 20 records of an hour, seeds 1 to 20: of τ and the slow variance each method is biased by what its
/// documentation says, so the tolerances are wide; N is known from 72 000 samples to a percent or two.
#[test]
fn the_parameters_of_simulated_records_are_recovered() {
    let truth = white_and_process(0.4, 100.0);
    let mut found: [Vec<[f64; 3]>; 3] = Default::default();
    for seed in 1..=20 {
        let record = simulated(&truth, 72_000, seed);
        let curve = curve(&record);
        let fits = [
            autocorrelation::fit(&record, RATE),
            allan_bound::fit(&curve),
            allan_minimum::fit(&curve, 1.0),
        ];
        for (list, fit) in found.iter_mut().zip(fits) {
            let fit = fit.unwrap();
            let process = fit.gauss_markov[0];
            list.push([fit.white, process.sigma, process.tau_s]);
        }
    }
    let middle = |list: &[[f64; 3]], j: usize| {
        let values: Vec<f64> = list.iter().map(|v| v[j]).collect();
        undrift_base::order_statistics::median(&values)
    };
    let [by_lags, bounds, lowest] = &found;
    println!("{found:.3?}");
    near(middle(by_lags, 0), 1.0, 0.03, "N of the autocorrelation");
    near(middle(by_lags, 1), 0.4, 0.06, "σ");
    // Of one record of 36 correlation times τ scatters by a half, the median of 20 by a seventh.
    near(middle(by_lags, 2), 100.0, 40.0, "τ");
    let bounded = middle(bounds, 0);
    assert!((1.0..1.1).contains(&bounded), "{bounded}");
    assert!(middle(bounds, 1) > 0.38, "{}", middle(bounds, 1));
    // The lowest octave of the closed form before its peak, at 189 s; the record may have its neighbour.
    let variance = |tau: f64| 1.0 / tau + gauss_markov_variance(tau, 0.4, 100.0);
    let octaves = (0..12).map(|i| 0.05 * f64::from(1 << i));
    let exact = octaves.min_by(|a, b| variance(*a).total_cmp(&variance(*b)));
    let exact = exact.unwrap();
    near(
        middle(lowest, 2),
        exact,
        1.01 * exact,
        "τ of the lowest point",
    );
    close(
        middle(lowest, 1),
        variance(exact).sqrt(),
        0.1,
        "σ of the lowest point",
    );

    let walk = CompositeTerms {
        white: 1.0,
        random_walk: 1.0 / 30.0,
        ..CompositeTerms::default()
    };
    let mut driven = Vec::new();
    for seed in 1..=20 {
        let fit = power_spectrum::fit(&simulated(&walk, 72_000, seed), RATE).unwrap();
        // Every octave weighs the same: B takes up to a tenth from N.
        near(fit.white, 1.0, 0.1, "N of the spectrum");
        driven.push([fit.flicker, fit.random_walk, 0.0]);
    }
    println!("{driven:.4?}");
    // Leakage of the Hann window: the lowest octave of a walk is high by a third, K by a fifth; the median of 20 scatters by 5 %.
    let k = middle(&driven, 1);
    assert!((1.0..1.4).contains(&(30.0 * k)), "{k}");
}

#[test]
fn the_bound_is_above_every_point_and_touches() {
    let record = simulated(&white_and_process(0.4, 100.0), 72_000, 3);
    let curve = curve(&record);
    let found = allan_bound::fit(&curve).unwrap();
    let process = found.gauss_markov[0];
    let ratios = curve.points.iter().filter(|p| 9 * p.m <= curve.samples);
    let ratios = ratios.map(|p| {
        let model = found.white.powi(2) / p.tau_s
            + gauss_markov_variance(p.tau_s, process.sigma, process.tau_s);
        model / p.deviation.powi(2)
    });
    let ratios: Vec<f64> = ratios.collect();
    assert!(ratios.iter().all(|r| *r > 1.0 - 2e-9), "{ratios:?}");
    // A corner of the programme lies on two of the points.
    assert!(
        ratios.iter().filter(|r| **r < 1.0 + 1e-6).count() >= 2,
        "{ratios:?}"
    );
}

#[test]
fn they_are_candidates_and_never_recommended() {
    let options = Options {
        n_max: 1,
        ..Options::at(RATE)
    };
    let record = simulated(&white_and_process(0.4, 30.0), 20_000, 5);
    let axis = identify(&record, false, &options).unwrap();
    for method in Method::ALL {
        let name = method.candidate();
        let found = axis.candidates.iter().find(|c| c.name == name);
        let found = found.unwrap_or_else(|| panic!("{name}: {:?}", axis.not_fitted));
        assert!(found.compared && !found.score.is_empty() && found.aic.is_finite());
    }
    assert!(axis.not_fitted.is_empty() && !axis.recommended().compared);
    // Of white noise each has nothing, and says why.
    let white = CompositeTerms {
        white: 1.0,
        ..CompositeTerms::default()
    };
    let axis = identify(&simulated(&white, 20_000, 5), false, &options).unwrap();
    let names: Vec<&str> = axis.not_fitted.iter().map(|n| n.name.as_str()).collect();
    println!("{:?}", axis.not_fitted);
    assert!(
        names.contains(&Method::Autocorrelation.candidate()),
        "{names:?}"
    );
    let of_autocorrelation = axis.not_fitted.iter();
    let of_autocorrelation = of_autocorrelation
        .filter(|n| n.name == Method::Autocorrelation.candidate())
        .map(|n| &n.reason);
    assert_eq!(Vec::from_iter(of_autocorrelation), [&Unfit::White]);
}

/// Octaves of a record of so many samples whose Allan variances are exactly these.
fn exact_curve(samples: usize, octaves: u32, variance: impl Fn(f64) -> f64) -> Curve {
    let point = |octave| {
        let m = 1usize << octave;
        let tau_s = m as f64 / RATE;
        Point {
            m,
            tau_s,
            deviation: variance(tau_s).sqrt(),
            terms: samples - 2 * m + 1,
        }
    };
    Curve {
        kind: DeviationKind::Overlapping,
        rate_hz: RATE,
        samples,
        points: (0..octaves).map(point).collect(),
    }
}

#[test]
fn what_is_a_process_beside_white_noise_is_its_own_bound() {
    // Correlation times on the grid of ten an octave, the shortest, the longest and between; nine windows of the
    // longest averaging time, and no more than four of those.
    for (samples, octaves, tenths, sigma) in [
        (72, 4, 15, 3.0),
        (36_864, 13, 83, 0.4),
        (9 << 12, 13, 151, 2.0),
        (9 << 9, 10, 10, 5.0),
    ] {
        let tau_s = 2f64.powf(f64::from(tenths) / 10.0) / RATE;
        let variance = |tau: f64| 1.44 / tau + gauss_markov_variance(tau, sigma, tau_s);
        let mut curve = exact_curve(samples, octaves, variance);
        // What the record holds fewer of, or does not have, says nothing.
        let mut beyond = *curve.points.last().unwrap();
        (beyond.m, beyond.tau_s) = (2 * beyond.m, 2.0 * beyond.tau_s);
        for deviation in [1e3, f64::NAN] {
            beyond.deviation = deviation;
            curve.points.push(beyond);
        }
        let found = allan_bound::fit(&curve).unwrap();
        // Differences of nearly equal variances: half of the digits.
        close(found.white, 1.2, 1e-6, "N");
        close(found.gauss_markov[0].sigma, sigma, 1e-6, "σ");
        close(found.gauss_markov[0].tau_s, tau_s, 1e-12, "τ");
    }
    let variance = |tau: f64| 1.0 / tau + gauss_markov_variance(tau, 1.0, 0.4);
    let too_few = Unfit::TooFew {
        what: "averaging times",
        got: 3,
        needed: 4,
    };
    assert_eq!(
        allan_bound::fit(&exact_curve(71, 4, variance)),
        Err(too_few)
    );
    // What falls as τ⁻² is best bounded by white noise alone.
    let steep = exact_curve(4608, 10, |tau| 1.0 / (tau * tau));
    assert_eq!(allan_bound::fit(&steep), Err(Unfit::White));
}

#[test]
fn no_other_bound_of_a_correlation_time_is_less() {
    let shares = uniform(42, 200);
    for (case, shares) in shares.chunks_exact(10).enumerate() {
        let points: Vec<(f64, f64)> = shares
            .iter()
            .enumerate()
            .map(|(octave, share)| {
                let tau = 0.05 * f64::from(1 << octave);
                (tau, (1.0 / tau + 0.1 * tau.sqrt()) * (2.0 * share).exp())
            })
            .collect();
        for tau_s in [0.1, 3.0, 100.0] {
            let found = allan_bound::bound_at(&points, tau_s);
            let unit = |tau| gauss_markov_variance(tau, 1.0, tau_s);
            let ratios = |white: f64, process: f64| {
                let ratio = move |(tau, v): &(f64, f64)| (white / tau + process * unit(*tau)) / v;
                points.iter().map(ratio).collect::<Vec<f64>>()
            };
            let least = ratios(found.white, found.process);
            assert!(least.iter().all(|ratio| *ratio > 1.0 - 2e-9));
            close(least.iter().sum(), found.excess, 1e-12, "excess");
            assert!(found.white >= 0.0 && found.process >= 0.0);
            // For each σ² the least N²: the sum is convex in it.
            let most = points
                .iter()
                .map(|(tau, v)| v / unit(*tau))
                .fold(0.0, f64::max);
            let sum = |process: f64| {
                let white = points
                    .iter()
                    .map(|(tau, v)| tau * (v - process * unit(*tau)));
                ratios(white.fold(0.0, f64::max), process)
                    .iter()
                    .sum::<f64>()
            };
            let (mut low, mut high) = (0.0, most);
            for _ in 0..120 {
                let [left, right] = [1.0, 2.0].map(|k| low + k * (high - low) / 3.0);
                match sum(left) < sum(right) {
                    true => high = right,
                    false => low = left,
                }
            }
            // A bound may be 1e-9 of a point below it.
            close(found.excess, sum(low), 1e-7, &format!("{case} {tau_s}"));
        }
    }
    let none = allan_bound::bound_at(&[(1.0, f64::NAN)], 1.0);
    assert!(none.excess.is_infinite());
}

#[test]
fn the_lowest_of_the_dips_within_a_ninth_of_the_record_is_taken() {
    let of = |deviations: &[f64], samples| {
        let mut curve = exact_curve(samples, deviations.len() as u32, |_| 1.0);
        for (point, deviation) in curve.points.iter_mut().zip(deviations) {
            point.deviation = *deviation;
        }
        allan_minimum::fit(&curve, 0.7)
    };
    let dips = [5.0, 3.0, 4.0, 2.0, 6.0, 1.0, 7.0];
    // The last but one is a dip where the last counts: 64 samples averaged.
    for (samples, octave) in [(9 * 64, 5), (9 * 64 - 1, 3)] {
        let found = of(&dips, samples).unwrap();
        let process = found.gauss_markov[0];
        assert_eq!((process.sigma, found.white), (dips[octave], 0.7));
        assert_eq!(process.tau_s, f64::from(1 << octave) / RATE);
    }
    for (monotonic, longest) in [([4.0, 3.0, 2.0, 1.0], 8.0), ([1.0, 2.0, 3.0, 3.0], 8.0)] {
        let longest_s = longest / RATE;
        assert_eq!(of(&monotonic, 100), Err(Unfit::NoMinimum { longest_s }));
    }
    assert_eq!(
        of(&[2.0, 1.0, 2.0], 8),
        Err(Unfit::NoMinimum { longest_s: 0.0 })
    );
}
