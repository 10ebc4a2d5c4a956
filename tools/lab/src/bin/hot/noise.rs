//! Identification, on one record.

use std::hint::black_box;
use undrift::nav::shaping::ShapingFilter;
use undrift::noise::{
    allan::{DeviationKind, Grid, deviations},
    arma::{Mean, log_likelihood},
    correlation::autocorrelation,
    stationarity::{Deterministic, KpssLags, Lags, adf, kpss},
    synthesis::NoiseGenerator,
    whiteness::portmanteau,
};

pub fn run(task: &str, samples: u32) -> Result<(), Box<dyn std::error::Error>> {
    let samples = samples as usize;
    if task == "synthesis" {
        let filter = ShapingFilter::arma(&[0.99995], &[0.9994], 0.006, 0.01)?;
        let mut record = vec![0.0; samples];
        NoiseGenerator::new(&filter, 1).fill(&mut record);
        black_box(record);
        return Ok(());
    }
    let record = white(samples);
    let x = black_box(record.as_slice());
    let constant = Deterministic::Constant;
    let likelihood = |ar, ma| log_likelihood(x, ar, ma, Mean::Known(0.0), false);
    match task {
        // What all others do beside their task.
        "record" => {}
        "arma-1-1" => drop(black_box(likelihood(&[0.99995], &[0.9994])?)),
        "arma-2-1" => drop(black_box(likelihood(&[1.19, -0.19999], &[0.9994])?)),
        "arma-4-3" => drop(black_box(likelihood(
            &[1.2, -0.5, 0.3, -0.1],
            &[0.6, -0.2, -0.1],
        )?)),
        "allan-octave" => drop(black_box(deviations(
            x,
            100.0,
            DeviationKind::Overlapping,
            Grid::Octave,
        )?)),
        "adf-20" => drop(black_box(adf(x, constant, Lags::Fixed(20))?)),
        "kpss-40" => drop(black_box(kpss(x, constant, KpssLags::Fixed(40))?)),
        "acf-20" => drop(black_box(autocorrelation(x, 20)?)),
        "ljung-box-20" => drop(black_box(portmanteau(x, &[20], 0)?)),
        _ => return Err(format!("no task {task}").into()),
    }
    Ok(())
}

/// White noise of few instructions: Knuth's linear congruential generator.
fn white(samples: usize) -> Vec<f64> {
    let mut state = 1u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    (0..samples).map(|_| next()).collect()
}
