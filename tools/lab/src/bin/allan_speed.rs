//! Time of the overlapping Allan deviation of 2 000 000 samples at octave τ, one thread; or, with a
//! number of samples, at all τ, of the record and of the same with a drift: CPU time of all threads and
//! peak memory (Linux only).
//!
//! `cargo run --release -p undrift-lab --bin allan_speed [SAMPLES]`

#[path = "../../../../benches/peers/process.rs"]
mod process;

use process::measured;
use std::hint::black_box;
use std::time::Instant;
use undrift_noise::allan::{DeviationKind, Grid, deviations, fit_gauss_markov, fit_terms};
use undrift_noise::synthesis::NoiseGenerator;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    if let Some(samples) = std::env::args().nth(1) {
        return all(samples.parse()?);
    }
    let record = record(2_000_000)?;
    let allan = |kind| deviations(black_box(&record), 100.0, kind, Grid::Octave);
    let overlapping = || allan(DeviationKind::Overlapping).map(|c| c.points.len());
    // In turns, so that a busy machine slows both alike.
    let (mut fastest, mut plain) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..20 {
        fastest = fastest.min(seconds(overlapping));
        plain = plain.min(seconds(|| strided_passes(black_box(&record))));
    }
    println!(
        "Overlapping: {:.1} ms; {:.2} of a plain prefix sum and a strided pass per τ, {:.1} ms",
        1e3 * fastest,
        fastest / plain,
        1e3 * plain
    );
    for kind in [
        DeviationKind::Hadamard,
        DeviationKind::Modified,
        DeviationKind::Total,
    ] {
        let times = (0..5).map(|_| seconds(|| allan(kind)));
        println!(
            "{kind:?}: {:.1} ms",
            1e3 * times.fold(f64::INFINITY, f64::min)
        );
    }
    let curve = deviations(
        &record,
        100.0,
        DeviationKind::Overlapping,
        Grid::PerOctave(4),
    )?;
    let start = Instant::now();
    let terms = fit_terms(&curve)?;
    println!(
        "fit of the terms: {:.1} ms, N {:.4e}, K {:.4e}",
        1e3 * start.elapsed().as_secs_f64(),
        terms.white.value,
        terms.random_walk.value
    );
    let start = Instant::now();
    let fit = fit_gauss_markov(&curve)?;
    println!(
        "fit of Gauss-Markov: {:.1} ms, N {:.4e}, σ {:.4e}, τc {:.1} s",
        1e3 * start.elapsed().as_secs_f64(),
        fit.white,
        fit.sigma,
        fit.tau_c_s
    );
    Ok(())
}

/// White noise and a first-order Gauss-Markov process.
fn record(samples: usize) -> Result<Vec<f64>, Box<dyn std::error::Error>> {
    let filter = undrift_nav::shaping::ShapingFilter::arma(&[0.99995], &[0.9994], 0.006, 0.01)?;
    let mut record = vec![0.0; samples];
    NoiseGenerator::new(&filter, 1).fill(&mut record);
    Ok(record)
}

/// All τ of the record, and with a drift a hundred times its noise.
fn all(samples: usize) -> Result<(), Box<dyn std::error::Error>> {
    let mut record = record(samples)?;
    for drift in [0.0, 1.0] {
        for (k, rate) in record.iter_mut().enumerate() {
            *rate += drift * k as f64 / samples as f64;
        }
        let start = Instant::now();
        let all = || {
            Ok(deviations(
                black_box(&record),
                100.0,
                DeviationKind::Overlapping,
                Grid::All,
            )?)
        };
        let (curve, taken) = measured(1, all)?;
        println!(
            "{samples} samples, drift {drift}: {} τ, {:.2} s of CPU, {:.2} s, peak {} MiB",
            curve.points.len(),
            taken.cpu_s,
            start.elapsed().as_secs_f64(),
            taken.peak_kib / 1024
        );
    }
    Ok(())
}

/// Time of one call [s].
fn seconds<T>(call: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    black_box(call());
    start.elapsed().as_secs_f64()
}

/// The yardstick: one pass of prefix sum and one strided pass per octave, as one would write them.
fn strided_passes(record: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0];
    sums.extend(record.iter().scan(0.0, |sum, rate| {
        *sum += rate;
        Some(*sum)
    }));
    let octaves = std::iter::successors(Some(1), |m| Some(2 * m));
    octaves
        .take_while(|m| 2 * m <= record.len())
        .map(|m| {
            let phases = sums.iter().zip(&sums[m..]).zip(&sums[2 * m..]);
            phases.map(|((a, b), c)| (c - 2.0 * b + a).powi(2)).sum()
        })
        .collect()
}
