//! Lines and resonances that were put in, and how often they are found where none are.

use crate::common::{close, white_noise};
use std::f64::consts::{PI, TAU};
use undrift_noise::spectrum::{
    Line,
    lines::{FALSE_ALARM, remove_lines},
};

const RATE: f64 = 100.0;
const SAMPLES: usize = 72_000;

/// White noise of unit variance and an AR(1) of coefficient φ driven by `step`; φ = 1 is a random walk.
fn background(seed: u64, phi: f64, step: f64) -> Vec<f64> {
    let mut slow = 0.0;
    let drive = white_noise(seed + 1_000_000, SAMPLES);
    let sum = white_noise(seed, SAMPLES).into_iter().zip(drive);
    sum.map(|(white, drive)| {
        slow = phi * slow + step * drive;
        white + slow
    })
    .collect()
}

fn add_line(x: &mut [f64], frequency_hz: f64, amplitude: f64, phase: f64) {
    for (k, x) in x.iter_mut().enumerate() {
        *x += amplitude * (TAU * frequency_hz * k as f64 / RATE + phase).cos();
    }
}

/// A resonance at frequency and width [Hz] whose spectrum is `height` times that of white noise of unit variance.
fn resonance(seed: u64, frequency_hz: f64, width_hz: f64, height: f64) -> Vec<f64> {
    let (radius, turn) = ((-PI * width_hz / RATE).exp(), TAU * frequency_hz / RATE);
    // 1/|φ|² at its frequency: (1 − ρ)² |1 − ρ e^{−2iω}|².
    let far = 1.0 + radius * radius - 2.0 * radius * (2.0 * turn).cos();
    let drive = (height * far).sqrt() * (1.0 - radius);
    let (mut last, mut before) = (0.0, 0.0);
    let settled = 100_000;
    let values = white_noise(seed, settled + SAMPLES).into_iter().map(|w| {
        let next = 2.0 * radius * turn.cos() * last - radius * radius * before + drive * w;
        (before, last) = (last, next);
        next
    });
    values.skip(settled).collect()
}

fn mean_square(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64
}

#[test]
fn records_without_lines_show_none() {
    // 80 records at one false alarm in 1000.
    assert_eq!(FALSE_ALARM, 1e-3);
    for (phi, step) in [
        (0.0, 0.0),
        (1.0, 0.01),
        (1.0, 1.0),
        (0.999, 0.01),
        (0.9, 5.0),
    ] {
        for seed in 0..16 {
            let mut x = background(seed, phi, step);
            let before = x.clone();
            let found = remove_lines(&mut x, RATE);
            assert!(
                found.is_empty() && x == before,
                "{phi} {step} {seed} {found:?}"
            );
        }
    }
}

#[test]
fn a_line_is_estimated_to_the_cramer_rao_bound() {
    // Bounds for white noise of unit variance: √(24/N³)/(2πA T) and √(2/N).
    let n = SAMPLES as f64;
    for amplitude in [0.1, 2.0] {
        let (mut frequencies, mut amplitudes, mut phases) = (0.0, 0.0, 0.0);
        let seeds = 24;
        for seed in 0..seeds {
            let mut x = background(seed, 1.0, 0.001);
            let phase = seed as f64;
            add_line(&mut x, 7.3, amplitude, phase);
            let [line] = remove_lines(&mut x, RATE)[..] else {
                panic!("{amplitude} {seed}");
            };
            let bounds = (
                RATE / TAU * (24.0 / n).sqrt() / (amplitude * n),
                (2.0 / n).sqrt(),
            );
            frequencies += ((line.frequency_hz - 7.3) / bounds.0).powi(2);
            amplitudes += ((line.amplitude - amplitude) / bounds.1).powi(2);
            // The phase at the first sample: 8/(A²N).
            let miss = line.phase.unwrap() - phase;
            phases += (miss - TAU * (miss / TAU).round()).powi(2) / (8.0 / n) * amplitude.powi(2);
            // The errors stated are those of the noise beside the line, known from 128 bins.
            close(line.frequency_error_hz.unwrap(), bounds.0, 0.4, "error");
            close(line.amplitude_error.unwrap(), bounds.1, 0.4, "error");
            // What is left is the noise: its variance to 0.5 %.
            close(
                mean_square(&x),
                mean_square(&background(seed, 1.0, 0.001)),
                1e-3,
                "left",
            );
        }
        // χ² of 24 degrees of freedom: 99.9 % below 51, 0.1 % below 8.
        for sum in [frequencies, amplitudes, phases] {
            assert!(
                (8.0..51.0).contains(&sum),
                "{frequencies} {amplitudes} {phases}"
            );
        }
    }
}

#[test]
fn harmonics_are_found_with_missing_samples() {
    let mut x = background(3, 1.0, 0.01);
    for harmonic in 1..=6 {
        add_line(
            &mut x,
            7.3 * f64::from(harmonic),
            2.0 / f64::from(harmonic),
            1.0,
        );
    }
    x.iter_mut().step_by(97).for_each(|x| *x = f64::NAN);
    x[30_000..30_300].fill(f64::NAN);
    let missing = x.iter().filter(|x| x.is_nan()).count();
    let found = remove_lines(&mut x, RATE);
    assert_eq!(found.len(), 6, "{found:?}");
    for (line, harmonic) in found.iter().zip(1..) {
        // Of the last, the bound is 1.2e-5 Hz, and 0.0053 of each amplitude; four of them.
        assert!(
            (line.frequency_hz - 7.3 * f64::from(harmonic)).abs() < 5e-5,
            "{line:?}"
        );
        assert!(
            (line.amplitude - 2.0 / f64::from(harmonic)).abs() < 0.021,
            "{line:?}"
        );
    }
    assert_eq!(x.iter().filter(|x| x.is_nan()).count(), missing);
}

#[test]
fn a_resonance_is_one_entry_and_leaves_the_noise() {
    // Frequency, width, height; broader than the record resolves (1.4 mHz), and a line whose phase wanders.
    for (frequency, width, height) in [
        (7.3, 0.5, 10.0),
        (7.3, 0.05, 100.0),
        (30.0, 2.0, 20.0),
        (7.3, 5e-4, 1e4),
    ] {
        let put_in = resonance(77, frequency, width, height);
        let noise = background(5, 1.0, 0.001);
        let mut x: Vec<f64> = noise.iter().zip(&put_in).map(|(a, b)| a + b).collect();
        let found = remove_lines(&mut x, RATE);
        println!("{frequency} {width} {height}: {found:?}");
        let [
            Line {
                frequency_hz,
                width_hz,
                amplitude,
                ..
            },
        ] = found[..]
        else {
            panic!("{found:?}");
        };
        // Widths ±20 % from the record's few dozen periods of the envelope; one below the resolution is that.
        assert!(
            (frequency_hz - frequency).abs() < 0.1 * width.max(0.01),
            "{frequency_hz}"
        );
        let resolved = width.max(1.0 / 1440.0 * 2.0);
        assert!(
            (0.6..1.6).contains(&(width_hz / resolved)) || width < 1e-3,
            "{width_hz}"
        );
        close(
            amplitude,
            (2.0 * mean_square(&put_in)).sqrt(),
            0.2,
            "amplitude",
        );
        // A notch as deep as the resonance is high leaves the noise: 1 % of variance at the narrow ones.
        let left = mean_square(&x) / mean_square(&noise) - 1.0;
        assert!(left.abs() < 0.02 + 0.05 * width, "{left}");
    }
}

#[test]
fn lines_too_near_to_be_resolved_are_one_resonance_and_another_stays_a_line() {
    // Three steps of 1/T apart: the second shows when the first is gone.
    let step = RATE / SAMPLES as f64;
    let mut x = background(5, 0.0, 0.0);
    add_line(&mut x, 5256.0 * step, 1.0, 0.3);
    add_line(&mut x, 5259.0 * step, 0.5, 1.0);
    add_line(&mut x, 6000.0 * step, 1.0, 0.5);
    let [near, far] = remove_lines(&mut x, RATE)[..] else {
        panic!("not two");
    };
    assert!(
        (near.frequency_hz - 5257.0 * step).abs() < 3.0 * step,
        "{near:?}"
    );
    assert!(near.width_hz > 0.0 && near.phase.is_none(), "{near:?}");
    assert!(
        (far.frequency_hz - 6000.0 * step).abs() < 0.1 * step,
        "{far:?}"
    );
    assert!(
        far.width_hz == 0.0 && (far.amplitude - 1.0).abs() < 0.03,
        "{far:?}"
    );
}

#[test]
fn hostile_records_do_no_harm() {
    for samples in (0..400).step_by(7) {
        for bad in [0.0, f64::NAN, f64::INFINITY, 1e300] {
            let mut x = white_noise(samples as u64, samples);
            for frequency in [0.01, 20.0, 33.3, 49.9, 50.0] {
                add_line(&mut x, frequency, 30.0, 0.1);
            }
            x.iter_mut().step_by(50).for_each(|x| *x = bad);
            let found = remove_lines(&mut x, RATE);
            assert!(
                found.iter().all(|line| line.frequency_hz.is_finite()),
                "{samples} {bad}"
            );
        }
    }
    let mut nothing = vec![f64::NAN; 1000];
    assert!(remove_lines(&mut nothing, RATE).is_empty());
    assert!(remove_lines(&mut [0.5; 1000], RATE).is_empty());
}

#[test]
fn a_line_is_looked_for_in_128_samples_and_more() {
    for (samples, found) in [(127, false), (128, true)] {
        let mut x = white_noise(1, samples);
        add_line(&mut x, 40.0, 30.0, 0.1);
        let lines = remove_lines(&mut x, RATE);
        assert_eq!(!lines.is_empty(), found, "{samples}");
        if found {
            close(lines[0].frequency_hz, 40.0, 1e-3, "frequency");
        }
    }
}
