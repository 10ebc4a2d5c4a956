//! Monte Carlo of `identify`: series of known noise, the recommended model run over fresh noise of the same
//! sensor, its drift over that of the true model, and whether the 95 % intervals hold the truth.
//!
//! `cargo run --release -p undrift-lab --bin identify_coverage [-- SERIES [FIRST_SEED [KIND …]]]`; with CANDIDATES in the environment
//! also the mean drift ratios of every candidate, with NOTES those of the recommended one series by series, what it predicts and the
//! share of the noise that rounding leaves to be seen.
//!
//! Series of an hour at 20 Hz but the paper's ARMA(1,1), 12 minutes at 100 Hz; drawn by `NoiseGenerator` (xoshiro256++) with
//! seeds FIRST_SEED…; what is done to them beside (rounding, spikes, samples left out) and the tails by seed + 10⁶,
//! the fresh series by seed + k 10⁹, k from 1.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use std::collections::BTreeMap;
use undrift_base::order_statistics::median;
use undrift_nav::shaping::ShapingFilter;
use undrift_noise::{
    BiasModel,
    composite::{CompositeFit, CompositeTerms, GaussMarkov, Parameter, ParameterInterval},
    drift_score,
    identify::{Axis, Candidate, Options, identify},
    screening::Trend,
    synthesis::NoiseGenerator,
};

type Failure = Box<dyn std::error::Error>;

/// Horizons that are judged \[s\].
const HORIZONS: [f64; 4] = [1.0, 10.0, 60.0, 300.0];
/// Fresh series, of the length of that identified; the first sixth of each is not scored.
const FRESH: u64 = 8;
/// White noise density N of all but the ARMA models [unit·√s].
const WHITE: f64 = 1.0;
/// Random walk K [unit/√s].
const WALK: f64 = 1.0 / 30.0;

/// What is done to a series of the true model.
#[derive(Clone, Copy, PartialEq)]
enum Done {
    Nothing,
    /// White noise of Student's t with so many degrees of freedom in place of the normal.
    Tails(f64),
    /// Rounded to steps of so many standard deviations of a sample's white noise.
    Rounded(f64),
    /// A line of 7.3 Hz, its standard deviation in those of a sample's white noise.
    Line(f64),
    /// So many samples moved by 20 standard deviations.
    Spikes(usize),
    /// This share left out.
    Missing(f64),
    /// A temperature that rises by 20 K, and its multiple added.
    Ramp,
}

struct Kind {
    name: &'static str,
    terms: Option<CompositeTerms>,
    truth: ShapingFilter,
    samples: usize,
    done: Done,
}

fn process(tau_s: f64, at_dc: f64) -> GaussMarkov {
    // The power density 2 σ² τ at zero is `at_dc` times the white noise's.
    let sigma = WHITE * (0.5 * at_dc / tau_s).sqrt();
    GaussMarkov { sigma, tau_s }
}

fn kinds() -> Result<Vec<Kind>, Failure> {
    let white = CompositeTerms {
        white: WHITE,
        ..CompositeTerms::default()
    };
    let walk = CompositeTerms {
        random_walk: WALK,
        ..white
    };
    let with = |tau, at_dc| CompositeTerms {
        gauss_markov: [process(tau, at_dc), GaussMarkov::default()],
        ..white
    };
    let of = |name, terms: CompositeTerms, done| -> Result<Kind, Failure> {
        Ok(Kind {
            name,
            truth: terms.to_shaping(0.05)?,
            terms: Some(terms),
            samples: 72_000,
            done,
        })
    };
    let arma = |name, ar: &[f64], ma: &[f64], interval| -> Result<Kind, Failure> {
        Ok(Kind {
            name,
            truth: ShapingFilter::arma(ar, ma, 0.006, interval)?,
            terms: None,
            samples: 72_000,
            done: Done::Nothing,
        })
    };
    Ok(vec![
        of("walk", walk, Done::Nothing)?,
        of("gm30", with(30.0, 10.0), Done::Nothing)?,
        of("gm100", with(100.0, 30.0), Done::Nothing)?,
        of("gm1000", with(1000.0, 300.0), Done::Nothing)?,
        of(
            "flicker",
            CompositeTerms {
                flicker: 0.15,
                ..white
            },
            Done::Nothing,
        )?,
        arma("paper", &[0.99995], &[0.9994], 0.01)?,
        arma("arma21", &[1.5793, -0.5796], &[0.985], 0.05)?,
        of("t4", walk, Done::Tails(4.0))?,
        of("step1", walk, Done::Rounded(1.0))?,
        of("step4", walk, Done::Rounded(4.0))?,
        of("step8", walk, Done::Rounded(8.0))?,
        of("line", walk, Done::Line(2.0))?,
        of("spikes", walk, Done::Spikes(10))?,
        of("missing", walk, Done::Missing(0.01))?,
        of("ramp", walk, Done::Ramp)?,
    ])
}

/// A series and its temperature.
fn series(kind: &Kind, samples: usize, seed: u64) -> (Vec<f64>, Option<Vec<f64>>) {
    let deviation = WHITE / kind.truth.interval.sqrt();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed + 1_000_000);
    let mut truth = kind.truth;
    if let Done::Tails(_) = kind.done {
        truth.r = 0.0;
    }
    let mut record = vec![0.0; samples];
    NoiseGenerator::new(&truth, seed).fill(&mut record);
    let mut temperature = None;
    match kind.done {
        Done::Nothing => {}
        Done::Tails(freedom) => {
            // Bailey 1994: polar method for t, here by two uniforms; variance ν/(ν − 2).
            let scale = deviation * ((freedom - 2.0) / freedom).sqrt();
            for value in &mut record {
                let (u, v): (f64, f64) = (1.0 - rng.random::<f64>(), rng.random());
                let radius = (freedom * (u.powf(-2.0 / freedom) - 1.0)).sqrt();
                *value += scale * radius * (std::f64::consts::TAU * v).cos();
            }
        }
        Done::Rounded(step) => {
            let step = step * deviation;
            let offset = step * rng.random::<f64>();
            for value in &mut record {
                *value = ((*value + offset) / step).round() * step;
            }
        }
        Done::Line(size) => {
            let phase = std::f64::consts::TAU * rng.random::<f64>();
            let step = std::f64::consts::TAU * 7.3 * kind.truth.interval;
            for (k, value) in record.iter_mut().enumerate() {
                *value += deviation * size * 2f64.sqrt() * (step * k as f64 + phase).sin();
            }
        }
        Done::Spikes(count) => {
            for _ in 0..count {
                record[rng.random_range(0..samples)] += 20.0 * deviation;
            }
        }
        Done::Missing(share) => {
            for value in &mut record {
                if rng.random::<f64>() < share {
                    *value = f64::NAN;
                }
            }
        }
        Done::Ramp => {
            let rise = |k: usize| 20.0 * (1.0 - (-3.0 * k as f64 / samples as f64).exp());
            let kelvin: Vec<f64> = (0..samples).map(rise).collect();
            for (value, kelvin) in record.iter_mut().zip(&kelvin) {
                *value += 0.05 * deviation * kelvin;
            }
            temperature = Some(kelvin);
        }
    }
    (record, temperature)
}

struct Outcome {
    name: String,
    /// Drift over that of the true model, and predicted over real, at each horizon.
    drift: [f64; 4],
    predicted: [f64; 4],
    /// The same ratio of every candidate that makes a filter.
    candidates: Vec<(String, [f64; 4])>,
    /// The share of the noise that rounding leaves to be seen.
    noise_shown: Option<f64>,
    seconds: f64,
    inside: Vec<(&'static str, bool, bool)>,
}

/// Which intervals hold the truth, of the parameters that the recommended model shares with it; `rounding`: the density
/// of its error, white where steps are no larger than the noise (Sheppard).
fn inside(axis: &Axis, truth: &CompositeTerms, rounding: f64) -> Vec<(&'static str, bool, bool)> {
    let same = |fit: &CompositeFit| fit.terms.set() == truth.set();
    if !axis.recommended().composite().is_some_and(same) {
        return Vec::new();
    }
    let judged = |found: &ParameterInterval| {
        let (name, truth) = match found.parameter {
            Parameter::White => ("N", truth.white.hypot(rounding)),
            Parameter::RandomWalk => ("K", truth.random_walk),
            Parameter::Flicker => ("B", truth.flicker),
            Parameter::Sigma(_) => ("sigma", truth.gauss_markov[0].sigma),
            Parameter::Tau(_) => ("tau", truth.gauss_markov[0].tau_s),
            Parameter::Quantisation => return None,
        };
        Some((
            name,
            (found.low..=found.high).contains(&truth),
            found.is_determined(),
        ))
    };
    axis.intervals.iter().filter_map(judged).collect()
}

fn outcome(kind: &Kind, seed: u64) -> Result<Outcome, Failure> {
    let interval = kind.truth.interval;
    let (record, temperature) = series(kind, kind.samples, seed);
    let mut options = Options::at(1.0 / interval);
    if temperature.is_some() {
        options.trend = Trend::Temperature;
        options.temperature = temperature.as_deref();
    }
    let start = std::time::Instant::now();
    let axis = identify(&record, false, &options)?;
    let seconds = start.elapsed().as_secs_f64();
    let chosen = axis.recommended();
    let mut model = chosen.model.clone();
    model.turn_on = 1e3 * WHITE;
    let mut truth = kind
        .truth
        .plus(&ShapingFilter::constant(1e3 * WHITE, interval)?)?;
    let rounding = match kind.done {
        Done::Rounded(step) => step * WHITE / 12f64.sqrt(),
        _ => 0.0,
    };
    truth.r += rounding * rounding / interval;
    let fresh: Vec<Vec<f64>> = (1..=FRESH)
        .map(|k| {
            let (mut fresh, temperature) = series(kind, kind.samples, seed + k * 1_000_000_000);
            // Judged as what is left: the slope is the sensor's own, taken out.
            for (value, kelvin) in fresh.iter_mut().zip(temperature.iter().flatten()) {
                *value -= 0.05 * WHITE / interval.sqrt() * kelvin;
            }
            fresh
        })
        .collect();
    let score = |filter: &ShapingFilter| -> Result<_, drift_score::DriftError> {
        let scores = fresh
            .iter()
            .map(|fresh| drift_score::score(fresh, kind.samples / 6, filter, &HORIZONS));
        Ok(drift_score::pooled(&scores.collect::<Result<Vec<_>, _>>()?))
    };
    let found = score(&model.shaping(BiasModel::Arma, interval)?)?;
    let best = score(&truth)?;
    let ratio = |candidate: &Candidate| {
        let filter = candidate.model.shaping(BiasModel::Arma, interval).ok()?;
        let drift = score(&filter).ok()?;
        let ratio = std::array::from_fn(|h| drift[h].rms / best[h].rms);
        Some((candidate.name.clone(), ratio))
    };
    Ok(Outcome {
        name: chosen.name.clone(),
        drift: std::array::from_fn(|h| found[h].rms / best[h].rms),
        predicted: std::array::from_fn(|h| found[h].predicted_rms / found[h].rms),
        candidates: axis.candidates.iter().filter_map(ratio).collect(),
        noise_shown: axis.noise_shown,
        seconds,
        inside: kind
            .terms
            .map_or(Vec::new(), |truth| inside(&axis, &truth, rounding)),
    })
}

/// Mean drift ratios of each candidate, and of how many series there was one.
fn print_candidates(outcomes: &[&Outcome]) {
    let mut found: BTreeMap<&str, Vec<[f64; 4]>> = BTreeMap::new();
    for (name, drift) in outcomes.iter().flat_map(|o| &o.candidates) {
        found.entry(name).or_default().push(*drift);
    }
    for (name, ratios) in found {
        let count = ratios.len() as f64;
        let mean = |h: usize| ratios.iter().map(|r| r[h]).sum::<f64>() / count;
        let means: Vec<String> = (0..4).map(|h| format!("{:.3}", mean(h))).collect();
        println!("  {} | {} | {name}", means.join(" "), ratios.len());
    }
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, default| arguments.get(at).map_or(Ok(default), |n| n.parse());
    let (count, first) = (number(0, 20)?, number(1, 1)?);
    let wanted = arguments.get(2..).unwrap_or_default();
    println!(
        "{count} series each, seeds from {first}; drift over that of the true model at 1, 10, 60, 300 s (mean),"
    );
    println!(
        "predicted over real drift (mean), 95 % intervals that hold, of those there are (bounded both ways), median seconds, what was recommended"
    );
    for kind in kinds()? {
        if !wanted.is_empty() && !wanted.iter().any(|name| name == kind.name) {
            continue;
        }
        let outcomes: Vec<Result<Outcome, String>> = (first..first + count)
            .into_par_iter()
            .map(|seed| outcome(&kind, seed).map_err(|e| e.to_string()))
            .collect();
        let mut failures: BTreeMap<&str, usize> = BTreeMap::new();
        for failure in outcomes.iter().filter_map(|o| o.as_ref().err()) {
            *failures.entry(failure).or_default() += 1;
        }
        let good: Vec<&Outcome> = outcomes.iter().filter_map(|o| o.as_ref().ok()).collect();
        let mean = |of: &dyn Fn(&Outcome) -> f64| {
            good.iter().map(|o| of(o)).sum::<f64>() / good.len() as f64
        };
        let drift: Vec<String> = (0..4)
            .map(|h| format!("{:.3}", mean(&|o| o.drift[h])))
            .collect();
        let predicted: Vec<String> = (0..4)
            .map(|h| format!("{:.2}", mean(&|o| o.predicted[h])))
            .collect();
        let mut names: BTreeMap<&str, usize> = BTreeMap::new();
        let mut held: BTreeMap<&str, (usize, usize, usize)> = BTreeMap::new();
        for outcome in &good {
            *names.entry(&outcome.name).or_default() += 1;
            for (name, inside, determined) in &outcome.inside {
                let (yes, all, closed) = held.entry(name).or_default();
                *yes += usize::from(*inside);
                *all += 1;
                *closed += usize::from(*determined);
            }
        }
        let mut names: Vec<_> = names.into_iter().collect();
        names.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
        let seconds: Vec<f64> = good.iter().map(|o| o.seconds).collect();
        println!(
            "{:8} {} | {} | {} | {:.2} s | {}{}",
            kind.name,
            drift.join(" "),
            predicted.join(" "),
            held.iter()
                .map(|(name, (yes, all, closed))| format!("{name} {yes}/{all} ({closed})"))
                .collect::<Vec<_>>()
                .join(" "),
            median(&seconds),
            names
                .iter()
                .map(|(name, n)| format!("{n} {name}"))
                .collect::<Vec<_>>()
                .join(", "),
            failures
                .iter()
                .map(|(why, n)| format!(" | {n} failed: {why}"))
                .collect::<String>(),
        );
        if std::env::var_os("NOTES").is_some() {
            for (seed, outcome) in (first..).zip(&outcomes) {
                match outcome {
                    Ok(found) => println!(
                        "  {seed} {:.3?} {:.2?} {:.2?} {}",
                        found.drift, found.predicted, found.noise_shown, found.name
                    ),
                    Err(why) => println!("  {seed} {why}"),
                }
            }
        }
        if std::env::var_os("CANDIDATES").is_some() {
            print_candidates(&good);
        }
    }
    Ok(())
}
