//! Monte Carlo of the ARMA(1,1) fit on the source paper's case, φ = 0.99995, θ = 0.9994: whether the
//! optimum is the global one, how often 95 % profile intervals hold the truth, and the bias.
//!
//! `cargo run --release -p undrift-lab --bin arma_coverage [-- SERIES [SAMPLES [STARTS]]]`
//!
//! Series 1, 2, … are drawn by `NoiseGenerator` (xoshiro256++) with that seed. The optimum is compared
//! with the best of STARTS local searches that share only the likelihood with the crate
//! (`crates/noise/tests/it/common/random_starts.rs`), their places drawn with seed 1 000 000 + that of the series.

#[path = "../../../../crates/noise/tests/it/common/random_starts.rs"]
mod random_starts;

use rayon::prelude::*;
use undrift_base::order_statistics::median;
use undrift_nav::shaping::ShapingFilter;
use undrift_noise::arma::{
    ArmaFit, FitOptions, Mean, ProfileInterval, Root, fit, profile_interval,
};
use undrift_noise::synthesis::NoiseGenerator;

const PHI: f64 = 0.99995;
const THETA: f64 = 0.9994;
const SIGMA: f64 = 0.006;
const LEVEL: f64 = 0.95;

/// One series: the fit and the intervals for φ and θ with the mean known and with it estimated, and
/// by how much the best random start is above the fit with estimated mean.
struct Outcome {
    modes: [(ArmaFit, ProfileInterval, ProfileInterval); 2],
    above: f64,
}

fn outcome(
    seed: u64,
    samples: usize,
    starts: usize,
) -> Result<Outcome, Box<dyn std::error::Error>> {
    let filter = ShapingFilter::arma(&[PHI], &[THETA], SIGMA, 0.01)?;
    let mut record = vec![0.0; samples];
    NoiseGenerator::new(&filter, seed).fill(&mut record);
    let at = |mean: Mean| -> Result<_, Box<dyn std::error::Error>> {
        let options = FitOptions {
            mean,
            ..FitOptions::default()
        };
        let model = fit(&record, 1, 1, &options)?;
        let phi = profile_interval(&record, &model, Root::Ar, LEVEL)?;
        let theta = profile_interval(&record, &model, Root::Ma, LEVEL)?;
        Ok((model, phi, theta))
    };
    let modes = [at(Mean::Known(0.0))?, at(Mean::Estimated)?];
    let mut above = f64::NEG_INFINITY;
    if starts > 0 {
        let best = random_starts::best(&record, Mean::Estimated, starts, 1_000_000 + seed);
        above = best - modes[1].0.log_likelihood;
    }
    for (name, (model, phi, theta)) in ["known", "estimated"].iter().zip(&modes) {
        eprintln!(
            "{seed} mean {name}: log(1-phi) {:.4} in [{:.4}, {:.4}], log(1-theta) {:.4} in \
             [{:.4}, {:.4}], log L {:.4}, pair {:.2}, random above {above:.4}",
            phi.estimate,
            phi.low,
            phi.high,
            theta.estimate,
            theta.low,
            theta.high,
            model.log_likelihood,
            model.pair_likelihood_ratio.unwrap_or(f64::NAN),
        );
    }
    Ok(Outcome { modes, above })
}

fn main() {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<usize>());
    let mut next = |default| arguments.next().and_then(Result::ok).unwrap_or(default);
    let (series, samples, starts) = (next(200), next(200_000), next(50));
    let outcomes: Vec<Outcome> = (1..=series as u64)
        .into_par_iter()
        .map(|seed| outcome(seed, samples, starts).expect("a fit of every series"))
        .collect();
    let count = |test: &dyn Fn(&Outcome) -> bool| outcomes.iter().filter(|o| test(o)).count();
    println!(
        "{series} series of {samples} samples, phi {PHI}, theta {THETA}, {starts} random starts"
    );
    let highest = outcomes.iter().map(|o| o.above).fold(f64::MIN, f64::max);
    println!(
        "best random start above the fit by more than 0.01: {}; at most {highest:.6}",
        count(&|o| o.above > 0.01)
    );
    let cancelled = |o: &Outcome| o.modes[1].0.near_cancelling;
    println!(
        "flagged as cancelling: {}, of these left by a random start: {}",
        count(&cancelled),
        count(&|o| cancelled(o) && o.above > 0.01)
    );
    for (mode, name) in ["known", "estimated"].iter().enumerate() {
        println!("mean {name}:");
        for (symbol, truth, theta) in [("phi", PHI, false), ("theta", THETA, true)] {
            let of = |o: &Outcome| {
                if theta {
                    o.modes[mode].2
                } else {
                    o.modes[mode].1
                }
            };
            let true_log = (-truth).ln_1p();
            let held = count(&|o| of(o).contains(truth));
            let below = count(&|o| of(o).high < true_log);
            let above = count(&|o| of(o).low > true_log);
            let errors: Vec<f64> = outcomes.iter().map(|o| of(o).estimate - true_log).collect();
            let mean = errors.iter().sum::<f64>() / series as f64;
            let spread =
                errors.iter().map(|e| (e - mean) * (e - mean)).sum::<f64>() / series as f64;
            println!(
                "  {symbol:5}: in the interval {held} ({:.1} %), interval too near 1 {below}, too far \
                 {above}; error of log(1-{symbol}): mean {mean:+.3}, median {:+.3}, rms about the mean {:.3}; \
                 open towards 1: {}",
                100.0 * held as f64 / series as f64,
                median(&errors),
                spread.sqrt(),
                count(&|o| of(o).low == f64::NEG_INFINITY),
            );
        }
        let n = samples as f64;
        let closer = |times: f64| count(&|o| (1.0 - o.modes[mode].0.ar[0]) * n < times);
        println!(
            "  correlation time longer than the record: {}, than a tenth of it: {}",
            closer(1.0),
            closer(10.0)
        );
    }
}
