//! Times one likelihood evaluation per order about a known mean, whole fits and a pair
//! of profile intervals. `cargo run --release -p undrift-lab --bin arma_speed [samples [likelihood]]`
//!
//! At steady state is what the second half of the record takes: there the response to the start is over.

use std::time::Instant;
use undrift_nav::shaping::ShapingFilter;
use undrift_noise::arma::{
    ArmaError, FitOptions, Mean, Root, fit, log_likelihood, profile_interval,
};
use undrift_noise::synthesis::NoiseGenerator;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let samples = match std::env::args().nth(1) {
        Some(text) => text.parse()?,
        None => 2_000_000,
    };
    let filter = ShapingFilter::arma(&[0.99995], &[0.9994], 0.006, 0.01)?;
    let mut record = vec![0.0; samples];
    NoiseGenerator::new(&filter, 1).fill(&mut record);
    for (name, ar, ma) in [
        ("(1,1)", &[0.99995][..], &[0.9994][..]),
        ("(2,1)", &[1.19, -0.19999], &[0.9994]),
        ("(4,3)", &[1.2, -0.5, 0.3, -0.1], &[0.6, -0.2, -0.1]),
        (
            "(6,5)",
            &[0.3, 0.2, 0.1, 0.1, 0.1, 0.1],
            &[0.1, 0.1, 0.1, 0.1, 0.1],
        ),
    ] {
        let mut value = 0.0;
        let (mut whole, mut half) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..9 {
            let mut seconds = |record: &[f64]| {
                let start = Instant::now();
                let likelihood = log_likelihood(record, ar, ma, Mean::Known(0.0), false)?;
                value = likelihood.log_likelihood;
                Ok::<_, ArmaError>(start.elapsed().as_secs_f64())
            };
            half = half.min(seconds(&record[..samples / 2])?);
            whole = whole.min(seconds(&record)?);
        }
        println!(
            "likelihood {name}: {:.2} ns/sample, {:.2} at steady state, {value:.6}",
            whole / samples as f64 * 1e9,
            (whole - half) / (samples - samples / 2) as f64 * 1e9,
        );
    }
    if std::env::args().nth(2).is_some() {
        return Ok(());
    }
    let known = FitOptions {
        mean: Mean::Known(0.0),
        ..FitOptions::default()
    };
    let start = Instant::now();
    let model = fit(&record, 1, 1, &known)?;
    let fitted = start.elapsed().as_secs_f64();
    let phi = profile_interval(&record, &model, Root::Ar, 0.95)?;
    let theta = profile_interval(&record, &model, Root::Ma, 0.95)?;
    println!(
        "fit (1,1), mean known: {fitted:.2} s; 95 % intervals for log(1 - φ) and log(1 - θ): {:.2} s, \
         [{:.3}, {:.3}] and [{:.3}, {:.3}]",
        start.elapsed().as_secs_f64() - fitted,
        phi.low,
        phi.high,
        theta.low,
        theta.high
    );
    for (p, q) in [(1, 1), (2, 1), (4, 3)] {
        let start = Instant::now();
        let model = fit(&record, p, q, &FitOptions::default())?;
        println!(
            "fit ({p},{q}): {:.2} s, log-likelihood {:.4}, φ {:?}, θ {:?}, errors {:?}, {:?}",
            start.elapsed().as_secs_f64(),
            model.log_likelihood,
            model.ar,
            model.ma,
            model.standard_errors,
            model.warnings
        );
    }
    Ok(())
}
