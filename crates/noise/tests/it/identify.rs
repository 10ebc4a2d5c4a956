//! Identification of a whole axis, on simulated records with a known truth and on invalid ones.

use undrift_nav::shaping::ShapingFilter;
use undrift_noise::{
    BiasModel, ImuModel,
    arma::Warning,
    composite::{CompositeTerms, GaussMarkov},
    identify::{
        Axis, Detrend, FitRemark, IdentifyError, Options, RecordRemark, SHORTEST, identify,
    },
    model_file::reason,
    screening::{Hanging, RecordError, Trend},
    synthesis::NoiseGenerator,
};

const RATE: f64 = 100.0;
const OPTIONS: Options = Options {
    rate_hz: RATE,
    n_max: 1,
    trend: Trend::Constant,
    temperature: None,
};

fn simulated(white: f64, walk: f64, samples: usize, seed: u64) -> Vec<f64> {
    let filter = ShapingFilter::white(white, 1.0 / RATE)
        .and_then(|w| w.plus(&ShapingFilter::random_walk(walk, 1.0 / RATE)?))
        .unwrap();
    let mut record = vec![0.0; samples];
    NoiseGenerator::new(&filter, seed).fill(&mut record);
    record
}

#[test]
fn a_slow_bias_is_found_and_its_model_halves_the_drift() {
    // 2 deg/√h of white noise and 0.02 deg/s/√s of random walk, 2000 s: an offset added.
    let (white, walk) = (2f64.to_radians() / 60.0, 2e-2f64.to_radians());
    let mut record = simulated(white, walk, 200_000, 11);
    record.iter_mut().for_each(|x| *x += 0.05);
    let axis = identify(&record, false, &OPTIONS).unwrap();
    println!("{}", reason(&axis.reason));

    // 200 000 samples give N to 0.2 %; the fit over τ allows 2 %.
    assert!((axis.allan_terms.white.value / white - 1.0).abs() < 0.02);
    let score = |name: &str| {
        let found = axis.candidates.iter().find(|c| c.name == name).unwrap();
        found.score[1].rms
    };
    let chosen = &axis.recommended().score[1];
    assert!(
        chosen.horizon_s == 10.0 && chosen.rms < 0.5 * score("white"),
        "{} {}",
        chosen.rms,
        score("white")
    );
    // The filter's own expectation is what it does, within four standard errors.
    assert!(
        (chosen.rms - chosen.predicted_rms).abs() < 4.0 * chosen.standard_error,
        "{chosen:?}"
    );
    // It makes a filter for navigation, at the record's rate and at another.
    let model = axis.model();
    for interval in [0.01, 0.005] {
        let filter = model.shaping(BiasModel::Arma, interval).unwrap();
        assert!(filter.order >= 1 && filter.interval == interval);
    }
    let note = &model.identification;
    assert!(note.contains_key("drift_scores") && note.contains_key("runner_up"));
}

#[test]
fn white_noise_alone_is_called_white() {
    let axis = identify(&simulated(1e-3, 0.0, 100_000, 3), false, &OPTIONS).unwrap();
    println!("{}", reason(&axis.reason));
    assert_eq!(axis.recommended().name, "white");
    assert!(axis.whiteness.ljung_box_p > 0.001 && axis.normality.jarque_bera.p_value > 0.001);
}

#[test]
fn outliers_are_reported_and_do_not_move_the_white_noise() {
    let clean = simulated(1e-3, 1e-5, 60_000, 5);
    let mut dirty = clean.clone();
    for k in [100, 20_000, 20_001, 45_678] {
        dirty[k] += 1.0;
    }
    let (a, b) = (
        identify(&clean, false, &OPTIONS).unwrap(),
        identify(&dirty, false, &OPTIONS).unwrap(),
    );
    let found: Vec<usize> = b.outliers.iter().map(|o| o.index).collect();
    assert_eq!(found, [100, 20_000, 20_001, 45_678]);
    assert!((a.allan_terms.white.value / b.allan_terms.white.value - 1.0).abs() < 1e-3);
}

#[test]
fn what_is_no_record_is_refused() {
    let short = identify(&[0.1, 0.2], false, &OPTIONS);
    let expected = RecordError::TooShort {
        needed: SHORTEST,
        got: 2,
    };
    assert_eq!(short.unwrap_err(), IdentifyError::Record(expected));
    assert!(identify(&vec![0.7; 5000], false, &OPTIONS).is_err());
    assert!(identify(&vec![f64::NAN; 5000], false, &OPTIONS).is_err());
    let good = simulated(1e-3, 0.0, 5000, 1);
    for rate_hz in [0.0, -1.0, f64::NAN] {
        assert_eq!(
            identify(&good, false, &Options::at(rate_hz)).unwrap_err(),
            IdentifyError::Rate
        );
    }
    // A sensor that is turned about is said to move.
    let moving: Vec<f64> = good
        .iter()
        .enumerate()
        .map(|(k, x)| x + 0.5 * (k as f64 / 300.0).sin())
        .collect();
    let axis = identify(&moving, false, &OPTIONS).unwrap();
    assert!(
        axis.remarks
            .iter()
            .any(|of| matches!(of, RecordRemark::Moving { ratio, .. } if *ratio > 1.0)),
        "{:?}",
        axis.remarks
    );
    // A thousand samples at 1 kHz hold no horizon of a second.
    let brief = identify(&good[..1000], false, &Options::at(1000.0)).unwrap_err();
    assert!(
        brief.to_string().contains("record at least 10 s"),
        "{brief}"
    );
}

#[test]
fn missing_samples_are_left_out() {
    // An hour's walk at 20 Hz: 1 % missing here and there, a minute on end, and the first second.
    let (white, walk) = (1e-3, 1e-4);
    let whole = simulated(white, walk, 72_000, 21);
    let mut record = whole.clone();
    for k in (0..72_000).filter(|k| k * 7919 % 101 == 0 || *k < 20 || (30_000..31_200).contains(k))
    {
        record[k] = f64::NAN;
    }
    let missing = record.iter().filter(|x| x.is_nan()).count();
    let [full, less] = [&whole, &record].map(|x| identify(x, false, &OPTIONS).unwrap());
    assert!(less.outliers.is_empty() && less.samples == 72_000);
    let remark = RecordRemark::Missing {
        samples: missing,
        percent: 100.0 * missing as f64 / 72_000.0,
    };
    assert_eq!(less.remarks, [remark]);
    let walks = [&full, &less].map(|axis| {
        let sum = axis
            .candidates
            .iter()
            .find(|c| c.name == "white + random walk");
        sum.and_then(|c| c.composite()).unwrap().terms
    });
    // 3 % of the samples fewer: each within a third of its standard error.
    let errors = full
        .candidates
        .iter()
        .find(|c| c.name == "white + random walk");
    let errors = errors.and_then(|c| c.composite()?.relative_errors).unwrap();
    let near = |ours: f64, whole: f64, error: f64| {
        assert!(
            (ours / whole - 1.0).abs() < error / 3.0,
            "{ours} {whole} {error}"
        )
    };
    near(walks[1].white, walks[0].white, errors.white);
    near(
        walks[1].random_walk,
        walks[0].random_walk,
        errors.random_walk,
    );
    // Nothing but gaps is no record.
    let few = identify(&record[30_000..32_000], false, &OPTIONS);
    assert!(matches!(
        few,
        Err(IdentifyError::Record(RecordError::TooShort { .. }))
    ));
}

#[test]
fn a_trend_is_removed_where_it_is_asked_for() {
    let (white, slope) = (1e-3, 2e-5); // unit/s, 7.2e-2 an hour
    let temperature: Vec<f64> = (0..20_000)
        .map(|k| 25.0 + 3.0 * (f64::from(k) / 4000.0).sin())
        .collect();
    let noise = simulated(white, 0.0, 20_000, 8);
    let linear: Vec<f64> = noise
        .iter()
        .enumerate()
        .map(|(k, x)| x + slope * k as f64 / RATE)
        .collect();
    fn with(record: &[f64], trend: Trend, temperature: &[f64]) -> Result<Axis, IdentifyError> {
        let temperature = Some(temperature);
        let options = Options {
            trend,
            temperature,
            ..OPTIONS
        };
        identify(record, false, &options)
    }
    let removed = with(&linear, Trend::Linear, &[]).unwrap().removed;
    let Detrend::Linear {
        slope_per_hour,
        explained,
    } = removed
    else {
        panic!("{removed:?}");
    };
    // White noise of 0.01 a sample leaves the slope a standard error of 1.2e-6 unit/s.
    assert!(
        (slope_per_hour / 3600.0 - slope).abs() < 5e-6 && explained < 0.05,
        "{slope_per_hour}"
    );
    let thermal: Vec<f64> = noise
        .iter()
        .zip(&temperature)
        .map(|(x, t)| x + 0.02 * (t - 25.0))
        .collect();
    let found = with(&thermal, Trend::Temperature, &temperature).unwrap();
    assert_eq!(found.removed, Detrend::Constant);
    let stored = found.model().temperature.unwrap();
    let estimate = found.temperature.unwrap();
    let error = stored.slope - 0.02;
    // White noise of 0.01 a sample: 0.01/√20000 over the 2 K of the temperature.
    assert!(error.abs() < 2e-4 && estimate.explained > 0.9, "{stored:?}");
    assert!(error.abs() < 3.0 * stored.slope_sigma && stored.slope_sigma < 1e-4);
    assert!(stored.range_c[0] < 22.1 && stored.range_c[1] > 27.9);
    let removed = with(&noise, Trend::Constant, &[]).unwrap().removed;
    assert_eq!(removed, Detrend::Constant);
    // A temperature that is no number is not the record's fault.
    let axis = with(&noise, Trend::Temperature, &vec![f64::NAN; 20_000]).unwrap();
    let mut remarks = axis.remarks.iter();
    assert!(remarks.any(|of| matches!(of, RecordRemark::TemperatureNotUsed(_))));
    assert!(axis.temperature.is_none() && axis.model().temperature.is_none());
}

#[test]
fn two_processes_are_a_candidate_beside_the_scales() {
    // White noise, a process of 2 s and one of 300 s; 3000 s.
    let truth = CompositeTerms {
        white: 1e-3,
        gauss_markov: [(3e-3, 2.0), (5e-3, 300.0)]
            .map(|(sigma, tau_s)| GaussMarkov { sigma, tau_s }),
        ..CompositeTerms::default()
    };
    let mut record = vec![0.0; 300_000];
    NoiseGenerator::new(&truth.to_shaping(1.0 / RATE).unwrap(), 4).fill(&mut record);
    let axis = identify(&record, false, &OPTIONS).unwrap();
    let find = |name: &str| axis.candidates.iter().find(|c| c.name == name).unwrap();
    let two = find("white + two Gauss-Markov");
    // The mean of a record, its turn-on, takes a state beside them.
    assert_eq!((two.model.instability.len(), two.states), (2, 3));
    let scales = &axis.scales.as_ref().unwrap().scales;
    assert_eq!(
        scales.iter().map(|s| s.block).collect::<Vec<_>>(),
        [5, 20, 100, 500]
    );
    // One process cannot be both: over 10 s the two drift by less.
    let one = find("white + Gauss-Markov");
    assert!(two.score[1].rms < 0.7 * one.score[1].rms);
    // Wavelet moments beside the likelihood; the model goes into a file and comes back.
    let fit = two.composite().unwrap();
    assert!((fit.moments.terms.white / 1e-3 - 1.0).abs() < 0.1);
    let mut imu = ImuModel::default();
    imu.gyro[0] = two.model.clone();
    let back = ImuModel::from_toml(&imu.to_toml(), "imu.toml").unwrap();
    let (a, b) = (&back.gyro[0].instability, &two.model.instability);
    assert!(
        a.iter()
            .zip(b)
            // Six digits are written.
            .all(|(a, b)| (a.tau_s / b.tau_s - 1.0).abs() < 5.1e-6
                && (a.sigma / b.sigma - 1.0).abs() < 5.1e-6)
    );
}

#[test]
fn rounding_of_the_angle_becomes_a_term() {
    // Increments of an angle read in steps of 1e-4: three quarters of the variance of a sample.
    let truth = CompositeTerms {
        white: 2e-4,
        quantisation: 1e-4 / 12f64.sqrt(),
        random_walk: 2e-5,
        ..CompositeTerms::default()
    };
    let mut record = vec![0.0; 100_000];
    NoiseGenerator::new(&truth.to_shaping(1.0 / RATE).unwrap(), 4).fill(&mut record);
    let axis = identify(&record, false, &OPTIONS).unwrap();
    let found = axis
        .candidates
        .iter()
        .find(|c| c.name == "white + quantisation + random walk")
        .unwrap();
    let q = found.model.quantisation.unwrap();
    assert!((q / truth.quantisation - 1.0).abs() < 0.05, "{q}");
    let filter = found.model.shaping(BiasModel::Arma, 1.0 / RATE).unwrap();
    assert_eq!(filter.order, 2);
}

#[test]
fn a_saturated_or_hanging_axis_is_said_to_be_one() {
    let record = simulated(1e-3, 0.0, 10_000, 9);
    let clipped: Vec<f64> = record.iter().map(|x| x.clamp(-0.01, 0.01)).collect();
    let axis = identify(&clipped, false, &OPTIONS).unwrap();
    assert_eq!(axis.saturation.len(), 2);
    let saturated = |of: &RecordRemark| matches!(of, RecordRemark::Saturated { .. });
    assert_eq!(axis.remarks.iter().filter(|of| saturated(of)).count(), 2);
    let mut hanging = record.clone();
    hanging[5000..7000].fill(record[5000]);
    let axis = identify(&hanging, false, &OPTIONS).unwrap();
    let stretch = Hanging {
        index: 5000,
        samples: 2000,
    };
    assert_eq!(axis.hanging, [stretch]);
    let frozen = RecordRemark::Frozen {
        samples: 2000,
        from_s: 50.0,
        stretches: 1,
    };
    assert!(axis.remarks.contains(&frozen), "{:?}", axis.remarks);
    assert!(
        identify(&record, false, &OPTIONS)
            .unwrap()
            .remarks
            .is_empty()
    );
}

#[test]
fn the_grid_of_orders_and_the_remarks_on_each_candidate_are_there() {
    let axis = identify(&simulated(1e-3, 0.0, 30_000, 5), false, &OPTIONS).unwrap();
    let grid = axis.box_jenkins.as_ref().unwrap();
    assert_eq!(grid.fits.len(), 16);
    // BIC of white noise.
    assert_eq!(grid.fits[grid.by_bic].order(), (0, 0));
    let one_one = axis
        .candidates
        .iter()
        .find(|c| c.name == "ARMA(1,1)")
        .unwrap();
    assert!(
        one_one
            .remarks
            .iter()
            .any(|of| matches!(of, FitRemark::Arma(Warning::NearCancelling { .. }))),
        "{:?}",
        one_one.remarks
    );
    let rules: Vec<&str> = axis.adf_chosen.iter().map(|(rule, _)| *rule).collect();
    assert_eq!(rules, ["aic", "bic", "last_significant"]);
}

/// White noise, a walk and a line of twice the white noise: the model is that of the record without the line, and
/// so is every export.
#[test]
fn a_line_is_taken_out_and_no_export_shows_it() {
    // 0.6 deg/√h; 206 deg/h of a process of one hour is σ √(2/τ) a root second.
    let white = 0.6f64.to_radians() / 60.0;
    let walk = 206f64.to_radians() / 3600.0 * (2.0 / 3600.0f64).sqrt();
    let amplitude = 2.0 * white * RATE.sqrt();
    for seed in [21, 22] {
        let mut record = simulated(white, walk, 72_000, seed);
        for (k, x) in record.iter_mut().enumerate() {
            *x += amplitude * (std::f64::consts::TAU * 7.3 * k as f64 / RATE).cos();
        }
        let axis = identify(&record, false, &OPTIONS).unwrap();
        let [line] = axis.lines[..] else {
            panic!("{:?}", axis.lines);
        };
        // Cramér-Rao: 2e-6 Hz and 0.26 % of the amplitude; four of them.
        assert!((line.frequency_hz - 7.3).abs() < 8e-6 && line.width_hz == 0.0);
        assert!((line.amplitude / amplitude - 1.0).abs() < 0.011);
        let model = axis.model();
        assert_eq!(model.lines.len(), 1);
        let plain = undrift_noise::AxisModel {
            lines: Vec::new(),
            ..model.clone()
        };
        // The filter is the same without the entry.
        let filter = |of: &undrift_noise::AxisModel| of.shaping(BiasModel::Arma, 0.01).unwrap();
        assert_eq!(filter(&model), filter(&plain));
        let all = std::array::from_fn(|_| model.clone());
        let mut imu = ImuModel::default();
        (imu.gyro, imu.accel) = (all.clone(), all);
        let text = imu
            .export(undrift_noise::ModelFormat::KfGins, None)
            .unwrap();
        let first = |key: &str| -> f64 {
            let (_, after) = text.split_once(key).unwrap();
            after
                .split([',', '[', ' '])
                .find_map(|word| word.parse().ok())
                .unwrap()
        };
        let (arw, drive) = (
            first("arw:"),
            first("gbstd:") * (2.0 / (3600.0 * first("corrtime:"))).sqrt(),
        );
        println!(
            "{}: {arw} {drive} {}",
            axis.recommended().name,
            first("gbstd:")
        );
        // Half a record gives N to 0.4 %, terms beside it take some of it: 2 %. The walk is above the white noise from 13 s
        // on: 28 such spans in half a record give K to 20 %; three of them.
        assert!((arw / 0.6 - 1.0).abs() < 0.02, "{arw}");
        let truth = 206.0 * (2.0 / 3600.0f64).sqrt();
        assert!((0.5..1.7).contains(&(drive / truth)), "{}", drive / truth);
    }
}

/// Student's t of ν degrees of freedom and standard deviation `sigma`: z/√(χ²/ν), χ² of ν normal numbers.
fn student(freedom: usize, sigma: f64, samples: usize, seed: u64) -> Vec<f64> {
    let z = simulated(RATE.sqrt().recip(), 0.0, samples * (freedom + 1), seed);
    let scale = sigma * ((freedom - 2) as f64).sqrt();
    let of = |draws: &[f64]| {
        let squares: f64 = draws[1..].iter().map(|v| v * v).sum();
        scale * draws[0] / squares.sqrt()
    };
    z.chunks_exact(freedom + 1).map(of).collect()
}

#[test]
fn heavy_tails_are_no_outliers() {
    for (freedom, seed) in [(3, 41), (4, 43), (5, 44)] {
        let record = student(freedom, 0.01, 72_000, seed);
        let axis = identify(&record, false, &OPTIONS).unwrap();
        assert!(
            axis.outliers.is_empty(),
            "{freedom} {seed}: {:?}",
            axis.outliers
        );
        let squares: f64 = record.iter().map(|v| v * v).sum();
        let white = (squares / record.len() as f64 / RATE).sqrt();
        let found = axis.allan_terms.white.value;
        // The Allan deviation of short times, fitted: what the samples have, to the 0.5 % asked for.
        assert!(
            (found / white - 1.0).abs() < 5e-3,
            "{freedom} {seed}: {found} {white}"
        );
    }
}

#[test]
fn steps_larger_than_the_noise_leave_a_model() {
    let sigma = 0.01;
    for (seed, steps) in [(51, 3.7), (52, 5.0), (53, 10.0)] {
        // Noise of σ about a slow error that crosses twelve steps, so that it is everywhere on the grid.
        let step = steps * sigma;
        let noise = simulated(sigma / RATE.sqrt(), 0.0, 72_000, seed);
        let slow = |k: usize| 12.0 * step * k as f64 / 72_000.0;
        let record = noise
            .iter()
            .enumerate()
            .map(|(k, e)| ((e + slow(k)) / step).round() * step);
        let axis = identify(&record.collect::<Vec<f64>>(), false, &OPTIONS).unwrap();
        assert!(axis.outliers.is_empty() && axis.hanging.is_empty());
        // Mean variance of a normal variable rounded to steps far larger than it, everywhere on the grid:
        // step² ∫ Φ(1 − Φ) σ dz/step = step σ/√π; at 3.7 σ still to 1 %.
        let expected = (step * sigma / core::f64::consts::PI.sqrt() / RATE).sqrt();
        let squares: f64 = axis.allan.points[0].deviation.powi(2) / RATE;
        assert!(
            (squares.sqrt() / expected - 1.0).abs() < 0.03,
            "{steps}: {} {expected}",
            squares.sqrt()
        );
    }
    // The mean amid a step of 12 σ: two samples of 10⁹ would leave it.
    let record: Vec<f64> = simulated(sigma / RATE.sqrt(), 0.0, 72_000, 54)
        .iter()
        .enumerate()
        .map(|(k, e)| {
            if k == 7 {
                0.12
            } else {
                (e / 0.12).round() * 0.12
            }
        })
        .collect();
    let refused = identify(&record, false, &OPTIONS).unwrap_err();
    let IdentifyError::Coarse { off: 1, hidden, .. } = refused else {
        panic!("{refused}");
    };
    // 4 of 72 000 beyond edges: P(|z| > 4.03) = 5.6e-5, so σ is below 0.06/4.03.
    assert!((hidden / (0.06 / 4.03) - 1.0).abs() < 0.01, "{hidden}");
}

/// At steps of 8 σ the noise found is that of the mean's place on the grid: nothing is said of it near an edge, it is
/// doubted where an edge is 2.5 σ away, and refused at 3.1 σ.
#[test]
fn noise_that_rounding_hides_is_doubted() {
    let step = 0.08;
    let at = |edge: f64, seed: u64| {
        let noise = simulated(0.01 / RATE.sqrt(), 0.0, 72_000, seed);
        let mean = 0.5 * step - 0.01 * edge;
        let record = noise
            .iter()
            .map(|e| ((e + mean) / step).round() * step)
            .collect::<Vec<f64>>();
        identify(&record, false, &OPTIONS)
    };
    assert!(
        at(0.5, 61)
            .unwrap()
            .noise_shown
            .is_some_and(|share| share > 0.8)
    );
    let doubted = at(2.5, 62).unwrap();
    // P(z > 2.5) = 0.0062: of steps² that share, of the 0.1 that may be hidden (σ < step/5.5).
    let shown = doubted.noise_shown.unwrap();
    assert!((0.2..0.3).contains(&shown), "{shown}");
    assert!(
        doubted
            .remarks
            .iter()
            .any(|of| matches!(of, RecordRemark::HiddenNoise { .. }))
    );
    assert!(matches!(
        at(3.1, 63),
        Err(IdentifyError::Coarse { off: 40..100, .. })
    ));
}

/// White noise of density `white` [u/√Hz] through a Butterworth filter of second order (bilinear transform, Oppenheim &
/// Schafer, section 7.3) of `corner_hz`, and a random walk [u/√s] that it does not matter to.
fn behind_a_filter(white: f64, walk: f64, corner_hz: f64, samples: usize, seed: u64) -> Vec<f64> {
    let k = (std::f64::consts::PI * corner_hz / RATE).tan();
    let root = std::f64::consts::SQRT_2 * k;
    let n = 1.0 / (1.0 + root + k * k);
    let ar = [2.0 * (1.0 - k * k) * n, (root - 1.0 - k * k) * n];
    let noise = simulated(white, 0.0, samples, seed);
    let bias = simulated(1e-12, walk, samples, seed + 1);
    let (mut before, mut filtered) = ([0.0; 2], [0.0; 2]);
    let samples = noise.iter().zip(&bias).map(|(x, b)| {
        let driven = k * k * n * (x + 2.0 * before[0] + before[1]);
        let y = driven + ar[0] * filtered[0] + ar[1] * filtered[1];
        before = [*x, before[0]];
        filtered = [y, filtered[0]];
        y + b
    });
    samples.collect()
}

#[test]
fn a_walk_behind_a_low_pass_filter_is_found_and_is_no_motion() {
    // 0.3 deg/√h behind 5 Hz, and a walk that is as much after 58 s; 20 min.
    let white = 0.3f64.to_radians() / 60.0;
    let record = behind_a_filter(white, 0.03 * white, 5.0, 120_000, 3);
    let axis = identify(&record, false, &OPTIONS).unwrap();
    assert!(!axis.motion.as_ref().unwrap().moving);
    let terms = "white + random walk";
    let found = axis.candidates.iter().find(|c| c.name == terms).unwrap();
    let model = &found.model;
    let (n, k) = (model.white.unwrap(), model.random_walk.unwrap());
    // 20 min of blocks of half a second give N to 2 %, the walk to some 20 %.
    assert!((n / white - 1.0).abs() < 0.06, "{}", n / white);
    assert!((k / (0.03 * white)).ln().abs() < 0.5, "{}", k / white);
    // What drifts least says so, too, and not less than it drifts.
    let chosen = &axis.recommended().score[2];
    assert_eq!(chosen.horizon_s, 60.0);
    assert!(chosen.rms < 1.02 * found.score[2].rms, "{:?}", axis.reason);
    assert!(chosen.rms < 1.4 * chosen.predicted_rms);
}

#[test]
fn samples_lost_at_random_or_in_bursts_leave_the_model_as_it_is() {
    let white = 0.3f64.to_radians() / 60.0;
    let whole = simulated(white, 0.03 * white, 60_000, 5);
    // A multiplicative hash draws a fifth of them; half a second of 30.
    let drawn = |k: usize| (k as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
    let lost: [&dyn Fn(usize) -> bool; 2] =
        [&|k| drawn(drawn(k) as usize) % 5 == 0, &|k| k % 3000 > 2950];
    for (which, lost) in lost.iter().enumerate() {
        let mut record = whole.clone();
        for (k, x) in record.iter_mut().enumerate() {
            if lost(k) {
                *x = f64::NAN;
            }
        }
        let axis = identify(&record, false, &OPTIONS).unwrap();
        let allan = axis.allan_terms.white.value / white;
        let n = axis.recommended().model.white.map(|n| n / white);
        println!("{}: {allan}, {n:?}", axis.recommended().name);
        // Of 48 000 samples N is known to 0.4 %.
        assert!((allan - 1.0).abs() < 0.03, "{which}: {allan}");
        assert!(n.is_none_or(|n| (n - 1.0).abs() < 0.03), "{which}: {n:?}");
        let score = &axis.recommended().score[0];
        let real = score.rms / score.predicted_rms;
        assert!((0.9..1.1).contains(&real), "{which}: {real}");
    }
}

#[test]
fn a_dead_band_is_named() {
    let white = 0.3f64.to_radians() / 60.0;
    let mut record = simulated(white, 0.0, 20_000, 7);
    // One standard deviation of a sample: 68 % of them.
    let band = white * RATE.sqrt();
    for x in &mut record {
        if x.abs() < band {
            *x = 0.0;
        }
    }
    let Err(IdentifyError::DeadBand(found)) = identify(&record, false, &OPTIONS) else {
        panic!("not named");
    };
    assert!((found.share - 0.683).abs() < 0.02 && found.value == 0.0);
    assert!((found.width / band - 1.0).abs() < 0.01);
}
