//! Time of the overlapping Allan deviation of 2 000 000 samples at octave τ, one thread.
//!
//! `cargo run --release -p undrift-noise --example allan_speed`

use std::hint::black_box;
use std::time::Instant;
use undrift_noise::allan::{Grid, Kind, deviations, fit_gauss_markov, fit_terms};
use undrift_noise::synthesis::NoiseGenerator;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let filter = undrift_nav::shaping::ShapingFilter::arma(&[0.99995], &[0.9994], 0.006, 0.01)?;
    let mut record = vec![0.0; 2_000_000];
    NoiseGenerator::new(&filter, 1).fill(&mut record);
    let allan = |kind| deviations(black_box(&record), 100.0, kind, Grid::Octave);
    let overlapping = || allan(Kind::Overlapping).map(|c| c.points.len());
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
    for kind in [Kind::Hadamard, Kind::Modified, Kind::Total] {
        let times = (0..5).map(|_| seconds(|| allan(kind)));
        println!(
            "{kind:?}: {:.1} ms",
            1e3 * times.fold(f64::INFINITY, f64::min)
        );
    }
    let curve = deviations(&record, 100.0, Kind::Overlapping, Grid::PerOctave(4))?;
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
