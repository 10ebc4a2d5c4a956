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
    for kind in [
        Kind::Overlapping,
        Kind::Hadamard,
        Kind::Modified,
        Kind::Total,
    ] {
        let mut fastest = f64::INFINITY;
        for _ in 0..20 {
            let start = Instant::now();
            black_box(deviations(black_box(&record), 100.0, kind, Grid::Octave)?);
            fastest = fastest.min(start.elapsed().as_secs_f64());
        }
        println!("{kind:?}: {:.1} ms", 1e3 * fastest);
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
