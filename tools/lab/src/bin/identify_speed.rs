//! Times the identification of one axis: white noise under a Gauss-Markov process of 60 s, 100 Hz, with outliers.
//! `cargo run --release -p undrift-lab --bin identify_speed [samples [outliers]]`
//!
//! The time is that of the CPU, all threads.

#[path = "../../../../benches/peers/process.rs"]
mod process;

use process::measured;
use undrift_noise::composite::{CompositeTerms, GaussMarkov};
use undrift_noise::identify::{Options, identify};
use undrift_noise::synthesis::NoiseGenerator;

const RATE_HZ: f64 = 100.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |or: usize| arguments.next().map_or(Ok(or), |text| text.parse());
    let (samples, outliers) = (number(72_000)?, number(0)?);
    let process = GaussMarkov {
        sigma: 0.01f64.to_radians(),
        tau_s: 60.0,
    };
    let terms = CompositeTerms {
        white: 2f64.to_radians() / 60.0,
        gauss_markov: [process, GaussMarkov::default()],
        ..CompositeTerms::default()
    };
    let mut record = vec![0.0; samples];
    NoiseGenerator::new(&terms.to_shaping(1.0 / RATE_HZ)?, 1).fill(&mut record);
    for k in 0..outliers {
        if let Some(value) = record.get_mut((k * 55_433 + 1234) % samples) {
            *value += 1.0;
        }
    }
    let (axis, took) = measured(1, || Ok(identify(&record, false, &Options::at(RATE_HZ))?))?;
    println!(
        "{samples} samples, {} outliers: {:.2} s of CPU, peak {} MiB, {}",
        axis.outliers.len(),
        took.cpu_s,
        took.peak_kib / 1024,
        axis.recommended().name
    );
    Ok(())
}
