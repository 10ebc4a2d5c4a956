//! Identification of a whole axis, on simulated records with a known truth and on records that
//! are none.

use undrift_nav::shaping::ShapingFilter;
use undrift_noise::{
    BiasModel,
    identify::{IdentifyError, Options, SHORTEST, identify},
    screening::RecordError,
    synthesis::NoiseGenerator,
};

const RATE: f64 = 100.0;
const OPTIONS: Options = Options {
    rate_hz: RATE,
    n_max: 1,
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
    println!("{}: {}", axis.recommended().name, axis.reason);

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
    println!("{}: {}", axis.recommended().name, axis.reason);
    assert_eq!(axis.recommended().name, "white");
    assert!(axis.whiteness.ljung_box_p > 0.001 && axis.normality.jarque_bera_p > 0.001);
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
            identify(&good, false, &Options { rate_hz, n_max: 1 }).unwrap_err(),
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
        axis.warnings.iter().any(|w| w.contains("not static")),
        "{:?}",
        axis.warnings
    );
}
