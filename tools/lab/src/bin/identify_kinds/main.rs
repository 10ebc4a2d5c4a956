//! Monte Carlo of `identify` on the sensors that people have: behind filters, warm, disturbed. Each record goes through
//! [`undrift::identify`]; the model file that comes out is judged by a Kalman filter of this program on fresh series of the
//! same noise.
//!
//! `cargo run --release -p undrift-lab --bin identify_kinds [-- SERIES [FIRST_SEED [KIND …]]]` prints the table of docs/lab/identify.md;
//! with NOTES in the environment also each series, with CANDIDATES beside it what was tried.
//!
//! Records of 10 to 60 minutes, drawn by xoshiro256++ with seeds FIRST_SEED…, the fresh series by seed + k 10⁹, k from 1.

mod judge;
mod kinds;

use judge::{Drift, System};
use kinds::{Disturbance, Kind, WHITE, kinds};
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
    /// Spans excluded and disturbances subtracted.
    said: Vec<String>,
    /// Drift over that of the true noise at each horizon, and real over predicted: by that ratio and what the true model predicts,
    /// so that the chance of the fresh series is not in it.
    drift: [f64; 3],
    predicted: [f64; 3],
    /// N over the true one.
    white: f64,
    /// Of the 95 % intervals of parameters that the recommended model shares with the truth, those that hold it, and all.
    inside: [usize; 2],
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
    let truth = kind.truth();
    let truth = truth.filter(|(name, _)| axis.recommended().name == *name);
    let parameters = truth.map_or(Vec::new(), |(_, parameters)| parameters);
    let judged = parameters.iter().filter_map(|(parameter, value)| {
        let mut intervals = axis.intervals.iter();
        let found = intervals.find(|one| one.parameter == *parameter)?;
        Some((found.low..=found.high).contains(value))
    });
    let judged = Vec::from_iter(judged);
    Ok(Outcome {
        inside: [judged.iter().filter(|held| **held).count(), judged.len()],
        candidates: candidates.collect(),
        name: axis.recommended().name.clone(),
        verdict: found.verdict.to_string(),
        said: found
            .identified
            .used
            .iter()
            .flat_map(|used| &used.left_out)
            .map(|one| format!("{:?} {:.0}-{:.0} s", one.why, one.start_s.0, one.end_s.0))
            .collect(),
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

/// What is counted over all kinds.
#[derive(Default)]
struct Total {
    kinds: usize,
    series: usize,
    /// Kinds whose mean drift and whose worst is as demanded at all horizons, and whose mean real over predicted drift is.
    mean: usize,
    worst: usize,
    predicted: usize,
    /// Sums of the kinds' means at each horizon.
    drift: [f64; 3],
    inside: [usize; 2],
    /// Series without a disturbance, those of them refused, those used with care, and those with a span excluded or a disturbance subtracted.
    honest: usize,
    refused: usize,
    warned: usize,
    less: usize,
    /// Series with one that is no noise, and those of them used whole.
    disturbed: usize,
    silent: usize,
}

fn outcomes(kind: &Kind, seeds: std::ops::Range<u64>) -> Vec<Result<Outcome, String>> {
    let interval = 1.0 / kind.rate_hz;
    let of = |seed| {
        let length = if kind.rate_hz > 300.0 {
            0.5 * FRESH_S
        } else {
            FRESH_S
        };
        let fresh: Vec<Vec<f64>> = (1..=FRESH)
            .map(|k| kind.fresh(length, seed + k * 1_000_000_000))
            .collect();
        let best = drift(&kind.system(), &fresh, interval);
        outcome(kind, seed, &fresh, &best)
    };
    seeds.into_par_iter().map(of).collect()
}

impl Total {
    /// Counts a kind; its row of the table.
    fn row(&mut self, kind: &Kind, outcomes: &[Result<Outcome, String>]) -> String {
        let good: Vec<&Outcome> = outcomes.iter().filter_map(|o| o.as_ref().ok()).collect();
        let mean = |of: &dyn Fn(&Outcome) -> f64| {
            good.iter().map(|o| of(o)).sum::<f64>() / good.len().max(1) as f64
        };
        let drift: [f64; 3] = std::array::from_fn(|h| mean(&|o| o.drift[h]));
        let worst: [f64; 3] =
            std::array::from_fn(|h| good.iter().map(|o| o.drift[h]).fold(0.0, f64::max));
        let predicted: [f64; 3] = std::array::from_fn(|h| mean(&|o| o.predicted[h]));
        let inside = good.iter().fold([0, 0], |sum, o| {
            [sum[0] + o.inside[0], sum[1] + o.inside[1]]
        });
        let most = if kind.seconds < 1000.0 { 1.5 } else { 1.3 };
        let refused = outcomes.len() - good.len();
        let warned = good.iter().filter(|o| o.verdict != "usable").count();
        let whole = good.iter().filter(|o| o.said.is_empty()).count();
        self.kinds += 1;
        self.series += outcomes.len();
        self.mean += usize::from(drift.iter().all(|x| *x <= 1.05));
        self.worst += usize::from(worst.iter().all(|x| *x <= most));
        self.predicted += usize::from(predicted.iter().all(|x| (0.8..=1.25).contains(x)));
        for h in 0..3 {
            self.drift[h] += drift[h];
        }
        self.inside = [self.inside[0] + inside[0], self.inside[1] + inside[1]];
        if matches!(kind.disturbance, Disturbance::Nothing) && kind.logger_hz.is_none() {
            self.honest += outcomes.len();
            self.refused += refused;
            self.warned += warned;
            self.less += good.len() - whole;
        } else if kind.logger_hz.is_none() && !matches!(kind.disturbance, Disturbance::Engine(_)) {
            self.disturbed += outcomes.len();
            self.silent += whole;
        }
        let failures = outcomes.iter().filter_map(|o| o.as_ref().err());
        let verdicts = good.iter().map(|o| o.verdict.as_str());
        format!(
            "| {} | {} | {} | {} | {:.3} | {} | {:.2} | {} | {} | {:.1} |",
            kind.name,
            texts(drift),
            texts(worst),
            texts(predicted),
            mean(&|o| o.white),
            match inside[1] {
                0 => "–".to_owned(),
                all => format!("{}/{all}", inside[0]),
            },
            mean(&|o| o.used_share),
            counted(good.iter().map(|o| o.name.as_str())),
            counted(verdicts.chain(failures.map(String::as_str))),
            mean(&|o| o.seconds),
        )
    }

    fn print(&self) {
        let Self { kinds, series, .. } = self;
        println!("\n{series} series of {kinds} kinds:\n");
        println!("| what | demanded | found |\n|---|---|---|");
        let mean = self.drift.map(|sum| sum / *kinds as f64);
        println!(
            "| drift over the best, mean of the kinds | | {} |",
            texts(mean)
        );
        let kinds_of = |what: &str, demanded: &str, found: usize| {
            println!("| kinds with {what} | {demanded} | {found} of {kinds} |");
        };
        kinds_of("a mean drift over the best", "at most 1.05", self.mean);
        kinds_of("a worst one", "at most 1.3; 1.5 of 10 min", self.worst);
        kinds_of("a mean real over predicted", "0.8 to 1.25", self.predicted);
        let percent = |part: usize, all: usize| 100.0 * part as f64 / all.max(1) as f64;
        let share = |what: &str, demanded: &str, part: usize, all: usize| {
            println!(
                "| {what} | {demanded} | {:.1} % ({part} of {all}) |",
                percent(part, all)
            );
        };
        let [held, all] = self.inside;
        share("95 % intervals that hold", "92 to 98 %", held, all);
        share(
            "refused, of honest noise",
            "at most 2 %",
            self.refused,
            self.honest,
        );
        share(
            "used with care, of honest noise",
            "at most 2 %",
            self.warned,
            self.honest,
        );
        share(
            "honest noise with a span excluded or a disturbance subtracted",
            "at most 2 %",
            self.less,
            self.honest,
        );
        share(
            "steps, warm-ups, cycles and bumps that were not found",
            "",
            self.silent,
            self.disturbed,
        );
    }
}

/// Three values with two decimals.
fn texts(of: [f64; 3]) -> String {
    Vec::from_iter(of.map(|x| format!("{x:.2}"))).join(" ")
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, default| arguments.get(at).map_or(Ok(default), |n| n.parse());
    let (count, first) = (number(0, 5)?, number(1, 1)?);
    let wanted = arguments.get(2..).unwrap_or_default();
    println!("{count} series each, seeds from {first}, at 10, 60, 300 s:\n");
    println!(
        "| kind | drift over the best: mean | worst | real over predicted: mean | N | intervals that hold | used | recommended | verdict | s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let mut total = Total::default();
    let mut all = kinds();
    all.retain(|kind| wanted.is_empty() || wanted.contains(&kind.name));
    let found: Vec<_> = all
        .par_iter()
        .map(|kind| outcomes(kind, first..first + count))
        .collect();
    for (kind, outcomes) in all.iter().zip(found) {
        println!("{}", total.row(kind, &outcomes));
        if std::env::var_os("NOTES").is_some() {
            for (seed, outcome) in (first..).zip(&outcomes) {
                match outcome {
                    Ok(o) => {
                        println!(
                            "  {seed} {:.2?} {:.2?} {:.3} {:.2} {} {} {:?}",
                            o.drift, o.predicted, o.white, o.used_share, o.name, o.verdict, o.said
                        );
                        o.candidates.iter().for_each(|line| println!("    {line}"));
                    }
                    Err(why) => println!("  {seed} {why}"),
                }
            }
        }
    }
    total.print();
    Ok(())
}
