//! Exports that feed a simulator: what MATLAB's `imuSensor` and Gazebo draw from the texts, sample by sample as their documentation and source
//! say, has the Allan deviation of the model.

use super::numbers;
use undrift_noise::allan::{DeviationKind, Grid, deviations, gauss_markov::gauss_markov_variance};
use undrift_noise::composite::{CompositeTerms, GaussMarkov};
use undrift_noise::synthesis::NoiseGenerator;
use undrift_noise::{AxisModel, ImuModel, ModelFormat};

const RATE_HZ: f64 = 20.0;
/// A simulation: of 20 hours the Allan deviation at 1000 s is known to 8 %.
const SAMPLES: usize = 72 * 20_000;

/// White noise of unit variance.
fn draws(seed: u64) -> impl Iterator<Item = f64> {
    let unit = CompositeTerms {
        white: 1.0,
        ..CompositeTerms::default()
    };
    NoiseGenerator::new(&unit.to_shaping(1.0).unwrap(), seed)
}

/// b ← (1 − decay) b + step · draw, beside white noise of this deviation a sample.
fn simulated(white: f64, walk: f64, [decay, step]: [f64; 2], gain: f64, seed: u64) -> Vec<f64> {
    let [mut b, mut w] = [0.0; 2];
    let mut own = draws(seed);
    let mut driving = draws(seed + 1).zip(draws(seed + 2));
    (0..SAMPLES)
        .map(|_| {
            let (process, walking) = driving.next().unwrap();
            b = (1.0 - decay) * b + step * process;
            w += walk * walking;
            white * own.next().unwrap() + gain * b + w
        })
        .collect()
}

/// Gyro x as MATLAB draws it: white noise of NoiseDensity √rate, steps of the walk of RandomWalk/√rate, white noise of
/// BiasInstability through the filter.
fn of_matlab(text: &str) -> Vec<f64> {
    let first = |key| numbers(text, key)[0];
    let root = RATE_HZ.sqrt();
    let has_process = text.contains("'BiasInstability',");
    let (gain, filter) = match has_process {
        true => {
            let filter = numbers(text, "'BiasInstabilityCoefficients',");
            (first("'BiasInstability',"), [1.0 + filter[2], filter[0]])
        }
        false => (0.0, [1.0, 0.0]),
    };
    let (white, walk) = (first("'NoiseDensity',"), first("'RandomWalk',"));
    simulated(root * white, walk / root, filter, gain, 11)
}

/// Gyro x as `GaussianNoiseModel::ApplyImpl` of gz-sensors draws it.
fn of_gazebo(text: &str) -> Vec<f64> {
    let of = |key: &str| {
        let (_, rest) = text.split_once(&format!("<{key}>")).unwrap();
        rest.split('<').next().unwrap().parse::<f64>().unwrap()
    };
    let (drive, tau) = (
        of("dynamic_bias_stddev"),
        of("dynamic_bias_correlation_time"),
    );
    let decay = (-1.0 / (RATE_HZ * tau)).exp_m1();
    let step = (-0.5 * drive * drive * tau * (-2.0 / (RATE_HZ * tau)).exp_m1()).sqrt();
    simulated(of("stddev"), 0.0, [-decay, step], 1.0, 21)
}

/// Allan variance of terms, in closed form.
fn variance(terms: &CompositeTerms, time_s: f64) -> f64 {
    let (processes, walk) = terms.slow();
    let of = |one: &GaussMarkov| gauss_markov_variance(time_s, one.sigma, one.tau_s);
    terms.white.powi(2) / time_s
        + walk * walk * time_s / 3.0
        + processes.iter().map(of).sum::<f64>()
}

/// A model of six axes like these terms.
fn model(terms: &CompositeTerms) -> ImuModel {
    let (instability, walk) = terms.slow();
    let axis = AxisModel {
        white: Some(terms.white),
        instability,
        random_walk: (walk > 0.0).then_some(walk),
        ..AxisModel::default()
    };
    let mut model = ImuModel::default();
    let axes = model.gyro.iter_mut().chain(&mut model.accel);
    axes.for_each(|slot| slot.clone_from(&axis));
    model
}

#[test]
fn what_a_simulator_draws_has_the_models_allan_deviation() {
    let process = |sigma, tau_s| GaussMarkov { sigma, tau_s };
    let white = CompositeTerms {
        white: 1.0,
        ..CompositeTerms::default()
    };
    let kinds = [
        ("white", white),
        (
            "walk",
            CompositeTerms {
                random_walk: 1.0 / 30.0,
                ..white
            },
        ),
        (
            "process",
            CompositeTerms {
                gauss_markov: [process(0.4, 100.0), GaussMarkov::default()],
                ..white
            },
        ),
        (
            "process and walk",
            CompositeTerms {
                random_walk: 0.01,
                gauss_markov: [process(0.4, 30.0), GaussMarkov::default()],
                ..white
            },
        ),
        (
            "two processes",
            CompositeTerms {
                gauss_markov: [process(0.5, 20.0), process(0.4, 300.0)],
                ..white
            },
        ),
        (
            "flicker",
            CompositeTerms {
                flicker: 0.3,
                ..white
            },
        ),
        (
            "flicker and walk",
            CompositeTerms {
                flicker: 0.15,
                random_walk: 0.01,
                ..white
            },
        ),
    ];
    for (name, terms) in kinds {
        let model = model(&terms);
        for (format, draw) in [
            (ModelFormat::Matlab, of_matlab as fn(&str) -> Vec<f64>),
            (ModelFormat::Gazebo, of_gazebo),
        ] {
            let text = model.export(format, Some(RATE_HZ)).unwrap();
            let kind = DeviationKind::Overlapping;
            let curve = deviations(&draw(&text), RATE_HZ, kind, Grid::Octave).unwrap();
            let mut points = 0;
            for point in &curve.points {
                if (0.1..=1000.0).contains(&point.tau_s) {
                    let ratio = point.deviation / variance(&terms, point.tau_s).sqrt();
                    points += 1;
                    assert!(
                        (0.8..=1.25).contains(&ratio),
                        "{name}, {}: {ratio} at {} s\n{text}",
                        format.name(),
                        point.tau_s
                    );
                }
            }
            assert_eq!(points, 14, "{:?}", curve.points);
        }
    }
}

/// Axes of other correlation times have one filter in MATLAB, and each its own process in Gazebo.
#[test]
fn axes_of_other_correlation_times_share_matlabs_filter() {
    let process = |sigma, tau_s| vec![GaussMarkov { sigma, tau_s }];
    let mut model = model(&CompositeTerms {
        white: 1.0,
        ..CompositeTerms::default()
    });
    model.gyro[0].instability = process(0.4, 80.0);
    model.gyro[1].instability = process(0.3, 200.0);
    let text = model.export(ModelFormat::Matlab, Some(RATE_HZ)).unwrap();
    assert!(text.contains("correlation time 126.491106 s"), "{text}");
    let sigmas = numbers(&text, "'BiasInstability',");
    let walks = numbers(&text, "'RandomWalk',");
    assert!(sigmas[0] > 0.3 && sigmas[1] > 0.2 && sigmas[2] == 0.0);
    assert_eq!(walks[2], 0.0);
    for (axis, tau_s, sigma) in [(0, 80.0, 0.4), (1, 200.0, 0.3)] {
        for time_s in [0.1, 10.0, 100.0, 300.0, 1000.0] {
            let beside = 1.0 / time_s + walks[axis] * walks[axis] * time_s / 3.0;
            let own = gauss_markov_variance(time_s, sigmas[axis], 126.491106) + beside;
            let exact = gauss_markov_variance(time_s, sigma, tau_s) + 1.0 / time_s;
            let ratio = (own / exact).sqrt();
            assert!((0.8..=1.25).contains(&ratio), "{axis} {time_s} s: {ratio}");
        }
    }
    assert!(text.contains("gyro_x: its bias is not what the program draws"));
    assert!(!text.contains("gyro_z: its bias"));
    let text = model.export(ModelFormat::Gazebo, Some(RATE_HZ)).unwrap();
    assert!(text.contains("<dynamic_bias_correlation_time>80.0<"));
    assert!(text.contains("<dynamic_bias_correlation_time>200.0<") && !text.contains("its bias"));
}
