//! Monte Carlo of `identify` on the sensors that people have: behind filters, warm, disturbed. Each record goes through
//! [`undrift::identify`]; the model file that comes out is judged by a Kalman filter of this program on fresh series of the
//! same noise.
//!
//! `cargo run --release -p undrift-lab --bin identify_kinds [-- SERIES [FIRST_SEED [KIND …]]]`; with NOTES in the environment
//! also each series, with CANDIDATES beside it what was tried.
//!
//! Records of 10 to 20 minutes, drawn by xoshiro256++ with seeds FIRST_SEED…, the fresh series by seed + k 10⁹, k from 1.

mod judge;
mod kinds;

use judge::{Drift, System};
use kinds::{Kind, WHITE, kinds};
use rayon::prelude::*;
use std::collections::BTreeMap;
use undrift::ImuModel;

/// Horizons that are judged [s].
const HORIZONS: [f64; 3] = [10.0, 60.0, 300.0];
/// Fresh series and their length [s]; so much of each is not scored.
const FRESH: u64 = 4;
const FRESH_S: f64 = 2400.0;
const SETTLING_S: f64 = 300.0;

struct Outcome {
    name: String,
    verdict: String,
    used_share: f64,
    /// Drift over that of the true noise at each horizon, and real over predicted: by that ratio and what the true model predicts,
    /// so that the chance of the fresh series is not in it.
    drift: [f64; 3],
    predicted: [f64; 3],
    /// N over the true one.
    white: f64,
    /// A line for each candidate: AIC over the least, score of the record and true drift over the best at each horizon.
    candidates: Vec<String>,
    seconds: f64,
}

fn outcome(kind: &Kind, seed: u64, fresh: &[Vec<f64>], best: &[Drift]) -> Result<Outcome, String> {
    let (record, rate) = kind.record(seed);
    let missing = f64::NAN;
    let rows = record
        .iter()
        .map(|x| [*x + 1e-3, missing, missing, missing, missing, missing]);
    let start = std::time::Instant::now();
    let found = undrift::identify(&Vec::from_iter(rows), rate).map_err(|why| why.to_string())?;
    let seconds = start.elapsed().as_secs_f64();
    let text = found.model.to_toml();
    let file = ImuModel::from_toml(&text, "imu.toml").map_err(|why| why.to_string())?;
    let interval = 1.0 / kind.rate_hz;
    let system = System::from_file(&file.gyro[0], interval);
    let drift = drift(&system, fresh, interval);
    let axis = found
        .identified
        .axes
        .first()
        .and_then(|(_, axis)| axis.as_ref().ok());
    let axis = axis.ok_or("no axis")?;
    let least = axis
        .candidates
        .iter()
        .map(|one| one.aic)
        .fold(f64::INFINITY, f64::min);
    let wanted = std::env::var_os("CANDIDATES").is_some();
    let candidates = axis.candidates.iter().filter(|_| wanted).map(|one| {
        let real = self::drift(&System::from_file(&one.model, interval), fresh, interval);
        let ratio: [f64; 3] = std::array::from_fn(|h| real[h].real / best[h].real);
        let scores = one
            .score
            .iter()
            .map(|score| format!("{:.3e}", score.rms / WHITE));
        let scores = Vec::from_iter(scores).join(" ");
        format!(
            "{:8.1} | {scores} | {ratio:.2?} | {}{} {:?}",
            one.aic - least,
            one.name,
            if one.compared { " *" } else { "" },
            one.remarks
        )
    });
    Ok(Outcome {
        candidates: candidates.collect(),
        name: axis.recommended().name.clone(),
        verdict: found.verdict.to_string(),
        used_share: axis.samples as f64 / (kind.seconds * kind.rate_hz),
        drift: std::array::from_fn(|h| drift[h].real / best[h].real),
        predicted: std::array::from_fn(|h| {
            drift[h].real / best[h].real * best[h].predicted / drift[h].predicted
        }),
        white: file.gyro[0].white_density() / WHITE,
        seconds,
    })
}

fn drift(system: &System, fresh: &[Vec<f64>], interval: f64) -> Vec<Drift> {
    let system = system.plus(&System::constant(1e3 * WHITE));
    let settling = (SETTLING_S / interval) as usize;
    system.drift(fresh, interval, settling, &HORIZONS)
}

fn counted<'a>(of: impl Iterator<Item = &'a str>) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    of.for_each(|name| *counts.entry(name).or_default() += 1);
    let mut counts: Vec<_> = counts.into_iter().collect();
    counts.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
    let texts = counts.iter().map(|(name, n)| format!("{n} {name}"));
    Vec::from_iter(texts).join(", ")
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, default| arguments.get(at).map_or(Ok(default), |n| n.parse());
    let (count, first) = (number(0, 5)?, number(1, 1)?);
    let wanted = arguments.get(2..).unwrap_or_default();
    println!("{count} series each, seeds from {first}, at 10, 60, 300 s");
    println!(
        "| kind | drift over the best: mean | worst | real over predicted: mean | N | used | recommended | verdict | s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for kind in kinds() {
        if !wanted.is_empty() && !wanted.contains(&kind.name) {
            continue;
        }
        let interval = 1.0 / kind.rate_hz;
        let outcomes: Vec<Result<Outcome, String>> = (first..first + count)
            .into_par_iter()
            .map(|seed| {
                let length = if kind.rate_hz > 300.0 {
                    0.5 * FRESH_S
                } else {
                    FRESH_S
                };
                let fresh: Vec<Vec<f64>> = (1..=FRESH)
                    .map(|k| kind.fresh(length, seed + k * 1_000_000_000))
                    .collect();
                let best = drift(&kind.system(), &fresh, interval);
                outcome(&kind, seed, &fresh, &best)
            })
            .collect();
        let good: Vec<&Outcome> = outcomes.iter().filter_map(|o| o.as_ref().ok()).collect();
        let mean = |of: &dyn Fn(&Outcome) -> f64| {
            good.iter().map(|o| of(o)).sum::<f64>() / good.len().max(1) as f64
        };
        let worst = |h: usize| good.iter().map(|o| o.drift[h]).fold(0.0, f64::max);
        let row = |of: &dyn Fn(usize) -> f64| {
            Vec::from_iter((0..3).map(|h| format!("{:.2}", of(h)))).join(" ")
        };
        let failures = outcomes.iter().filter_map(|o| o.as_ref().err());
        let verdicts = good.iter().map(|o| o.verdict.as_str());
        println!(
            "| {} | {} | {} | {} | {:.3} | {:.2} | {} | {} | {:.1} |",
            kind.name,
            row(&|h| mean(&|o| o.drift[h])),
            row(&worst),
            row(&|h| mean(&|o| o.predicted[h])),
            mean(&|o| o.white),
            mean(&|o| o.used_share),
            counted(good.iter().map(|o| o.name.as_str())),
            counted(verdicts.chain(failures.map(String::as_str))),
            mean(&|o| o.seconds),
        );
        if std::env::var_os("NOTES").is_some() {
            for (seed, outcome) in (first..).zip(&outcomes) {
                match outcome {
                    Ok(o) => {
                        println!(
                            "  {seed} {:.2?} {:.2?} {:.3} {:.2} {} {}",
                            o.drift, o.predicted, o.white, o.used_share, o.name, o.verdict
                        );
                        o.candidates.iter().for_each(|line| println!("    {line}"));
                    }
                    Err(why) => println!("  {seed} {why}"),
                }
            }
        }
    }
    Ok(())
}
