//! What one record allows: the drift of a model of the right kind, fitted to it by restricted likelihood, over that of the true
//! model, beside a random walk fitted to the same record and the likelier of the two.
//!
//! `cargo run --release -p undrift-lab --bin known_kind [-- SERIES [FIRST_SEED]]`
//!
//! White noise under a Gauss-Markov process, of the length of the series of `identify_coverage` but at one sample a second
//! or two and a half: nothing of the slow part is lost, and a fit takes milliseconds. Fresh series of the same length, the first sixth not
//! scored, have seeds + k 10⁹, k from 1.

use undrift_nav::shaping::ShapingFilter;
use undrift_noise::{
    composite::{CompositeTerms, FitOptions, GaussMarkov, TermSet, fit},
    drift_score,
    synthesis::NoiseGenerator,
};

type Failure = Box<dyn std::error::Error>;

/// Horizons \[s\].
const HORIZONS: [f64; 4] = [1.0, 10.0, 60.0, 300.0];
const FRESH: u64 = 16;

struct Kind {
    name: &'static str,
    terms: CompositeTerms,
    interval: f64,
    samples: usize,
}

/// White noise and the process that an ARMA(1,1) is the sum of.
fn arma(phi: f64, theta: f64, sigma: f64, interval: f64) -> CompositeTerms {
    let drive = (1.0 - phi * theta) * (phi - theta) / phi * sigma * sigma;
    CompositeTerms {
        white: (theta / phi * interval).sqrt() * sigma,
        gauss_markov: [
            GaussMarkov {
                sigma: (drive / (1.0 - phi * phi)).sqrt(),
                tau_s: -interval / phi.ln(),
            },
            GaussMarkov::default(),
        ],
        ..CompositeTerms::default()
    }
}

fn kinds() -> Vec<Kind> {
    let hour = |name, tau_s: f64, at_dc: f64| {
        let sigma = (0.5 * at_dc / tau_s).sqrt();
        Kind {
            name,
            terms: CompositeTerms {
                white: 1.0,
                gauss_markov: [GaussMarkov { sigma, tau_s }, GaussMarkov::default()],
                ..CompositeTerms::default()
            },
            interval: 1.0,
            samples: 3600,
        }
    };
    vec![
        hour("gm30", 30.0, 10.0),
        hour("gm100", 100.0, 30.0),
        hour("gm1000", 1000.0, 300.0),
        Kind {
            name: "paper",
            terms: arma(0.99995, 0.9994, 0.006, 0.01),
            interval: 0.4,
            samples: 1800,
        },
    ]
}

/// Drift of models of one record over that of the true one: of the right kind, of a walk, of the likelier.
fn ratios(kind: &Kind, seed: u64) -> Result<[[f64; 4]; 3], Failure> {
    let interval = kind.interval;
    let truth = kind.terms.to_shaping(interval)?;
    let scale = 1e3 * kind.terms.white;
    let with_constant = |filter: &ShapingFilter| -> Result<ShapingFilter, Failure> {
        Ok(filter.plus(&ShapingFilter::constant(scale, interval)?)?)
    };
    let draw = |seed| {
        let mut record = vec![0.0; kind.samples];
        NoiseGenerator::new(&truth, seed).fill(&mut record);
        record
    };
    let record = draw(seed);
    let fresh: Vec<Vec<f64>> = (1..=FRESH)
        .map(|k| draw(seed + k * 1_000_000_000))
        .collect();
    let score = |filter: &ShapingFilter| -> Result<[f64; 4], Failure> {
        let filter = with_constant(filter)?;
        let scores = fresh
            .iter()
            .map(|fresh| drift_score::score(fresh, kind.samples / 6, &filter, &HORIZONS));
        let pooled = drift_score::pooled(&scores.collect::<Result<Vec<_>, _>>()?);
        Ok(std::array::from_fn(|h| pooled[h].rms))
    };
    let best = score(&truth)?;
    let white = TermSet {
        white: true,
        ..TermSet::default()
    };
    let sets = [
        TermSet {
            gauss_markov: 1,
            ..white
        },
        TermSet {
            random_walk: true,
            ..white
        },
    ];
    let [own, walk] = sets.map(|set| fit(&record, interval, set, &FitOptions::default()));
    let (own, walk) = (own?, walk?);
    let likelier = if own.aic < walk.aic { &own } else { &walk };
    let mut found = [[0.0; 4]; 3];
    for (row, fit) in found.iter_mut().zip([&own, &walk, likelier]) {
        let drift = score(&fit.to_shaping(interval)?)?;
        *row = std::array::from_fn(|h| drift[h] / best[h]);
    }
    Ok(found)
}

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |or: u64| arguments.next().map_or(Ok(or), |n| n.parse());
    let (count, first) = (number(100)?, number(1)?);
    println!(
        "{count} series each, seeds from {first}; drift over that of the true model at 1, 10, 60, 300 s (mean): right kind | random walk | the likelier"
    );
    for kind in kinds() {
        let mut sums = [[0.0; 4]; 3];
        for seed in first..first + count {
            let found = ratios(&kind, seed)?;
            for (sum, ratio) in sums.iter_mut().flatten().zip(found.iter().flatten()) {
                *sum += ratio / count as f64;
            }
        }
        let row = |of: &[f64; 4]| of.map(|mean| format!("{mean:.3}")).join(" ");
        println!("{:8} {}", kind.name, sums.each_ref().map(row).join(" | "));
    }
    Ok(())
}
