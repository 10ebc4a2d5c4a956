//! The effect of temperature beside correlated noise.

use undrift_nav::shaping::ShapingFilter;
use undrift_noise::synthesis::NoiseGenerator;
use undrift_noise::temperature::{Estimate, NORMAL_95, Regressors};

/// An hour at 10 Hz.
const INTERVAL: f64 = 0.1;
const SAMPLES: usize = 36_000;
/// 0.01 rad/√s of white noise; a walk and a process that are as large after minutes.
const WHITE: f64 = 0.01;
const WALK: f64 = 2e-4;
const SLOPE: f64 = 1e-3;

type Profile = fn(f64) -> f64;

/// Temperature [°C] at a time \[s\]: a ramp, a slow sinusoid, a warm-up.
const PROFILES: [(&str, Profile); 3] = [
    ("ramp", |t| 20.0 + t / 180.0),
    ("sinusoid", |t| 30.0 + 5.0 * (t / 200.0).sin()),
    ("warm-up", |t| 40.0 - 20.0 * (-t / 600.0).exp()),
];

fn noises() -> [(&'static str, ShapingFilter); 3] {
    let white = ShapingFilter::white(WHITE, INTERVAL).unwrap();
    let walk = ShapingFilter::random_walk(WALK, INTERVAL).unwrap();
    let process = ShapingFilter::gauss_markov(2e-3, 200.0, INTERVAL).unwrap();
    [
        ("white", white),
        ("white + walk", white.plus(&walk).unwrap()),
        ("white + Gauss-Markov", white.plus(&process).unwrap()),
    ]
}

fn estimate(profile: Profile, noise: &ShapingFilter, slope: f64, seed: u64) -> Estimate {
    let temperature: Vec<f64> = (0..SAMPLES).map(|k| profile(k as f64 * INTERVAL)).collect();
    let mut record = vec![0.0; SAMPLES];
    NoiseGenerator::new(noise, seed).fill(&mut record);
    let record = record.iter().zip(&temperature);
    let record: Vec<f64> = record.map(|(x, t)| x + slope * (t - 30.0)).collect();
    let regressors = Regressors::new(&record, &temperature, INTERVAL).unwrap();
    regressors.estimate().unwrap()
}

/// Seeds of 0…n whose interval has the true slope, and that find it determined.
fn counted(profile: Profile, noise: &ShapingFilter, slope: f64, n: u64) -> (u64, u64) {
    let (mut covered, mut determined) = (0, 0);
    for seed in 0..n {
        let found = estimate(profile, noise, slope, seed);
        let effect = found.effect;
        let error = (effect.slope - slope).abs();
        covered += u64::from(error <= NORMAL_95 * effect.slope_sigma);
        determined += u64::from(found.determined);
    }
    (covered, determined)
}

#[test]
#[ignore = "slow: 720 records"]
fn coverage_of_the_intervals() {
    for (noise, filter) in noises() {
        for (name, profile) in PROFILES {
            let with = counted(profile, &filter, SLOPE, 40);
            let without = counted(profile, &filter, 0.0, 40);
            println!(
                "{noise}, {name}: covered {} and {} of 40, determined {} with, {} without",
                with.0, without.0, with.1, without.1
            );
        }
    }
}

#[test]
#[ignore = "slow"]
fn debugging() {
    let (noise, filter) = &noises()[1];
    for (name, profile) in PROFILES {
        let mut n = 0;
        for seed in 0..150 {
            let f = estimate(profile, filter, 0.0, seed);
            if f.determined {
                n += 1;
                println!(
                    "{noise} {name} {seed}: {} t {:.1} tq {:.1} explained {:.2} sigma {:.1e}",
                    f.noise,
                    f.effect.slope / f.effect.slope_sigma,
                    f.effect.quadratic / f.effect.quadratic_sigma,
                    f.explained,
                    f.effect.slope_sigma
                );
            }
        }
        println!("{name} {n} of 150");
    }
}
