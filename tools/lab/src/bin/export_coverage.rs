//! Monte Carlo of the exports: models identified from series of known noise and written for each program, the white
//! noise N and the random walk K that the program reads in them, over those of the true model written in the same way.
//!
//! `cargo run --release -p undrift-lab --bin export_coverage [-- SERIES [FIRST_SEED [KIND …]]]`
//!
//! The series of `identify_coverage` of these kinds: an hour at 20 Hz, drawn by `NoiseGenerator` with seeds FIRST_SEED….
//! K is that of the bias over times short against its correlation time, as each program takes it: with a correlation time beside it,
//! σ √(2/τ).

use rayon::prelude::*;
use undrift_base::order_statistics::median;
use undrift_noise::{
    AxisModel, ImuModel, ModelFormat,
    composite::{CompositeFit, CompositeTerms, GaussMarkov, Parameter},
    identify::{Axis, Options, identify},
    synthesis::NoiseGenerator,
};

type Failure = Box<dyn std::error::Error>;

const RATE_HZ: f64 = 20.0;
const SAMPLES: usize = 72_000;
const FORMATS: [ModelFormat; 11] = [
    ModelFormat::Kalibr,
    ModelFormat::Vins,
    ModelFormat::OpenVins,
    ModelFormat::Basalt,
    ModelFormat::Px4,
    ModelFormat::Ros,
    ModelFormat::KfGins,
    ModelFormat::Matlab,
    ModelFormat::Gtsam,
    ModelFormat::ArduPilot,
    ModelFormat::Gazebo,
];
/// Shares of the true value that a number is to be within.
const NEAR: [f64; 2] = [0.1, 0.25];

fn kinds() -> [(&'static str, CompositeTerms); 3] {
    let white = CompositeTerms {
        white: 1.0,
        ..CompositeTerms::default()
    };
    let process = GaussMarkov {
        sigma: 0.15f64.sqrt(),
        tau_s: 100.0,
    };
    [
        (
            "walk",
            CompositeTerms {
                random_walk: 1.0 / 30.0,
                ..white
            },
        ),
        (
            "gm100",
            CompositeTerms {
                gauss_markov: [process, GaussMarkov::default()],
                ..white
            },
        ),
        (
            "flicker",
            CompositeTerms {
                flicker: 0.15,
                ..white
            },
        ),
    ]
}

/// White noise [unit·√s] and random walk [unit/√s] that a program reads.
struct Read {
    white: f64,
    walk: Option<f64>,
}

/// The number after a key, past brackets and blanks.
fn after(text: &str, key: &str) -> Result<f64, Failure> {
    let (_, rest) = text.split_once(key).ok_or(format!("no {key}"))?;
    let rest = rest.trim_start_matches(|c: char| c == '[' || c.is_whitespace());
    let is_of_number = |c: char| c.is_ascii_digit() || ".+-eE".contains(c);
    let end = rest.find(|c| !is_of_number(c)).unwrap_or(rest.len());
    Ok(rest[..end].parse()?)
}

/// What a program reads in a model of six axes like this one.
fn read(axis: &AxisModel, format: ModelFormat) -> Result<Read, Failure> {
    let mut model = ImuModel::default();
    let axes = model.gyro.iter_mut().chain(&mut model.accel);
    axes.for_each(|slot| slot.clone_from(axis));
    model.provenance.rate_hz = Some(RATE_HZ);
    model.provenance.samples = Some(SAMPLES as u64);
    let text = model.export(format, Some(RATE_HZ))?;
    let of = |key| after(&text, key);
    let (root, degree) = (RATE_HZ.sqrt(), 1f64.to_radians());
    Ok(match format {
        ModelFormat::Kalibr | ModelFormat::OpenVins => Read {
            white: of("gyroscope_noise_density:")?,
            walk: Some(of("gyroscope_random_walk:")?),
        },
        // A step adds (noise dt)²/2 and (bias noise dt)².
        ModelFormat::Vins => Read {
            white: of("gyr_n:")? / (2.0 * RATE_HZ).sqrt(),
            walk: Some(of("gyr_w:")? / root),
        },
        ModelFormat::Basalt => Read {
            white: of("\"gyro_noise_std\":")?,
            walk: Some(of("\"gyro_bias_std\":")?),
        },
        ModelFormat::Px4 => Read {
            white: of("\tEKF2_GYR_NOISE\t")? / root,
            walk: Some(of("\tEKF2_GYR_B_NOISE\t")? / root),
        },
        ModelFormat::Gtsam => Read {
            white: of("setGyroscopeCovariance(np.diag(")?.sqrt(),
            walk: Some(of("setBiasOmegaCovariance(np.diag(")?.sqrt()),
        },
        ModelFormat::ArduPilot => Read {
            white: of("EK3_GYRO_P_NSE,")? / root,
            walk: Some(of("EK3_GBIAS_P_NSE,")? / root),
        },
        ModelFormat::Gazebo => Read {
            white: of("<stddev>")? / root,
            walk: Some(of("<dynamic_bias_stddev>")?),
        },
        ModelFormat::KfGins => {
            let tau = of("corrtime:")? * 3600.0;
            Read {
                white: of("arw:")? * degree / 60.0,
                walk: Some(of("gbstd:")? * degree / 3600.0 * (2.0 / tau).sqrt()),
            }
        }
        ModelFormat::Matlab => {
            let walk = of("'RandomWalk',")?;
            let process = match text.contains("'BiasInstability',") {
                true => {
                    let phi = -of("'Denominator', [1.0,")?;
                    let tau = -1.0 / (RATE_HZ * phi.ln());
                    of("'BiasInstability',")? * (2.0 / tau).sqrt()
                }
                false => 0.0,
            };
            Read {
                white: of("'NoiseDensity',")?,
                walk: Some(walk.hypot(process)),
            }
        }
        _ => Read {
            white: of("angular_velocity_stdev:")? / root,
            walk: None,
        },
    })
}

/// Of the interval of a parameter its ends over the estimate, where the model has the truth's terms and the parameter is
/// determined.
fn ends(axis: &Axis, truth: &CompositeTerms, of: Parameter) -> Option<[f64; 2]> {
    let same = |fit: &&CompositeFit| fit.terms.set() == truth.set();
    axis.recommended().composite().filter(same)?;
    let mut found = axis.intervals.iter();
    let found = found.find(|found| found.parameter == of && found.is_determined())?;
    Some([found.low, found.high].map(|end| end / found.estimate))
}

/// A number over the true one, and whether its interval has the true one, if it has an interval.
type Judged = (f64, Option<bool>);

/// N, and K where the format has one, of each format.
fn judged(truth: &CompositeTerms, seed: u64) -> Result<Vec<[Option<Judged>; 2]>, Failure> {
    let mut record = vec![0.0; SAMPLES];
    NoiseGenerator::new(&truth.to_shaping(1.0 / RATE_HZ)?, seed).fill(&mut record);
    let axis = identify(&record, false, &Options::at(RATE_HZ))?;
    let found = AxisModel {
        turn_on: 0.0,
        ..axis.model()
    };
    let (instability, walk) = truth.slow();
    let true_model = AxisModel {
        white: Some(truth.white),
        instability,
        random_walk: (walk > 0.0).then_some(walk),
        ..AxisModel::default()
    };
    let of_white = ends(&axis, truth, Parameter::White);
    // One parameter alone that all of the bias goes with.
    let of_walk = [Parameter::RandomWalk, Parameter::Flicker];
    let of_walk = of_walk.into_iter().find_map(|of| ends(&axis, truth, of));
    let judge = |found: f64, truth: f64, ends: Option<[f64; 2]>| {
        let holds = |[low, high]: [f64; 2]| (found * low..=found * high).contains(&truth);
        (found / truth, ends.map(holds))
    };
    let of_format = |format| {
        let (found, truth) = (read(&found, format)?, read(&true_model, format)?);
        let walk = found.walk.zip(truth.walk);
        Ok([
            Some(judge(found.white, truth.white, of_white)),
            walk.map(|(found, truth)| judge(found, truth, of_walk)),
        ])
    };
    FORMATS.into_iter().map(of_format).collect()
}

/// Median, numbers within the shares of the truth, intervals that hold.
fn summary(of: &[Judged]) -> String {
    let ratios: Vec<f64> = of.iter().map(|(ratio, _)| *ratio).collect();
    let near = NEAR.map(|share| ratios.iter().filter(|r| (*r - 1.0).abs() <= share).count());
    let intervals: Vec<bool> = of.iter().filter_map(|(_, holds)| *holds).collect();
    let hold = intervals.iter().filter(|holds| **holds).count();
    format!(
        "{:.3}, {} and {} of {}, {hold} of {}",
        median(&ratios),
        near[0],
        near[1],
        ratios.len(),
        intervals.len()
    )
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, default| arguments.get(at).map_or(Ok(default), |n| n.parse());
    let (count, first) = (number(0, 20)?, number(1, 1)?);
    let wanted = arguments.get(2..).unwrap_or_default();
    println!(
        "{count} series each, seeds from {first}; of N and of K: median over the true one, within 10 and 25 % of it, intervals that have it"
    );
    for (name, truth) in kinds() {
        if !wanted.is_empty() && !wanted.iter().any(|one| one == name) {
            continue;
        }
        let found: Vec<_> = (first..first + count)
            .into_par_iter()
            .map(|seed| judged(&truth, seed).map_err(|e| e.to_string()))
            .collect::<Result<_, String>>()?;
        for (at, format) in FORMATS.into_iter().enumerate() {
            let of = |what: usize| -> Vec<Judged> {
                found.iter().filter_map(|series| series[at][what]).collect()
            };
            println!(
                "{name:8} {:8} | {} | {}",
                format.name(),
                summary(&of(0)),
                match of(1) {
                    none if none.is_empty() => "none".to_owned(),
                    some => summary(&some),
                }
            );
        }
    }
    Ok(())
}
