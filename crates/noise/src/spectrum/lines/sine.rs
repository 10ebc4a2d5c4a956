//! A sine of unknown frequency by least squares.
//!
//! For a given frequency the coefficients of sine and cosine are linear least squares; the frequency follows by
//! Gauss and Newton's method from within the main lobe of the periodogram, where there is one minimum. Time
//! runs from the middle of the record: frequency and phase are then uncorrelated.
//!
//! Assumes one frequency for the whole record: a line that wanders by more than a bin is a
//! resonance ([`super::resonance`]). Neighbouring lines are fitted one after the other by the
//! caller, which adds and removes them by [`Sine::add_to`]. O(N) a step.

use super::Line;
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use std::f64::consts::TAU;

/// Gauss-Newton iterations; from an interpolated peak two are enough.
const STEPS: usize = 6;
/// Samples from one exact sine and cosine to the next; the rotation between them loses a digit.
const RESTART: usize = 256;

/// a cos(2πf(k − c)) + b sin(2πf(k − c)), c the middle of the record.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sine {
    /// Frequency f \[1/sample\].
    pub(super) frequency: f64,
    /// Coefficient a of the cosine \[unit\].
    cosine: f64,
    /// Coefficient b of the sine \[unit\].
    sine: f64,
    /// Variance of the white noise, from the power near the line \[unit²\].
    pub(super) background: f64,
}

impl Sine {
    /// Least-squares fit to the samples that are not missing, from a frequency \[1/sample\] within half a step of 1/(length).
    pub(super) fn fit(record: &[f64], frequency: f64, background: f64) -> Self {
        let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
        for_each_present(record, frequency, |x, _, c, s| {
            normal += Matrix2::new(c * c, c * s, c * s, s * s);
            right += Vector2::new(c * x, s * x);
        });
        let start = normal.lu().solve(&right).unwrap_or_default();
        let mut fit = Self {
            frequency,
            cosine: start[0],
            sine: start[1],
            background,
        };
        // Within the lobe: no step goes beyond it.
        let max_step = 0.5 / record.len() as f64;
        for _ in 0..STEPS {
            let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
            let scale = record.len() as f64;
            for_each_present(record, fit.frequency, |x, time, c, s| {
                let slope = time / scale * (fit.sine * c - fit.cosine * s);
                let row = Vector3::new(c, s, slope);
                normal += row * row.transpose();
                right += row * (x - fit.cosine * c - fit.sine * s);
            });
            let Some(step) = normal.cholesky().map(|normal| normal.solve(&right)) else {
                break;
            };
            let by = (step[2] / (TAU * scale)).clamp(-max_step, max_step);
            fit.frequency += by;
            fit.cosine += step[0];
            fit.sine += step[1];
            if by.abs() < 1e-6 * max_step {
                break;
            }
        }
        fit
    }

    /// Amplitude √(a² + b²) \[unit\].
    fn amplitude(&self) -> f64 {
        self.cosine.hypot(self.sine)
    }

    /// Adds a multiple of it to a record.
    ///
    /// −1 removes it.
    pub(super) fn add_to(&self, record: &mut [f64], factor: f64) {
        let (a, b) = (factor * self.cosine, factor * self.sine);
        for_each_phasor(record.len(), self.frequency, |k, _, c, s| {
            record[k] += a * c + b * s
        });
    }

    /// The line, with the Cramér-Rao bounds of its amplitude and frequency: var A = 2σ²/N, var ω = 24σ²/(A²N³) (Rife & Boorstyn 1974).
    ///
    /// `samples` are those of the whole record; the bounds assume white noise of the variance
    /// beside the line. The phase is that of a cosine at the first sample \[rad\], within ±π.
    pub(super) fn to_line(self, samples: usize, rate_hz: f64) -> Line {
        let (n, amplitude) = (samples as f64, self.amplitude());
        let sigma = self.background.sqrt();
        let middle = 0.5 * (n - 1.0);
        let phase = -self.sine.atan2(self.cosine) - TAU * (self.frequency * middle).fract();
        Line {
            frequency_hz: self.frequency * rate_hz,
            amplitude,
            width_hz: 0.0,
            phase: Some(phase - TAU * (phase / TAU).round()),
            frequency_error_hz: Some(rate_hz / TAU * (24.0 / n).sqrt() * sigma / (amplitude * n)),
            amplitude_error: Some((2.0 / n).sqrt() * sigma),
        }
    }
}

/// Calls `with(x, t, cos 2πft, sin 2πft)` for each sample that is not missing, t from the middle of the record \[samples\].
fn for_each_present(record: &[f64], frequency: f64, mut with: impl FnMut(f64, f64, f64, f64)) {
    for_each_phasor(record.len(), frequency, |k, time, c, s| {
        let x = record[k];
        if x.is_finite() {
            with(x, time, c, s);
        }
    });
}

/// Calls `with(k, t, cos 2πft, sin 2πft)` for k = 0 to `samples` − 1, t = k less the middle.
fn for_each_phasor(samples: usize, frequency: f64, mut with: impl FnMut(usize, f64, f64, f64)) {
    let middle = 0.5 * (samples as f64 - 1.0);
    let (turn_s, turn_c) = (TAU * frequency).sin_cos();
    for start in (0..samples).step_by(RESTART) {
        let (mut s, mut c) = (TAU * (frequency * (start as f64 - middle)).fract()).sin_cos();
        for k in start..samples.min(start + RESTART) {
            with(k, k as f64 - middle, c, s);
            (c, s) = (c * turn_c - s * turn_s, s * turn_c + c * turn_s);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(samples: usize, frequency: f64, amplitude: f64, phase: f64) -> Vec<f64> {
        let sample = |k: usize| amplitude * (TAU * frequency * k as f64 + phase).cos();
        (0..samples).map(sample).collect()
    }

    #[test]
    fn a_sine_is_found_from_within_half_a_step_and_nothing_is_left() {
        for samples in [200, 1001] {
            for off in [-0.45, 0.0, 0.2, 0.45] {
                for phase in [-2.5, 0.0, 1.0, 3.0] {
                    let (frequency, amplitude) = (0.2345, 3.0);
                    let mut record = sine(samples, frequency, amplitude, phase);
                    record[17..40].fill(f64::NAN);
                    let fit = Sine::fit(&record, frequency + off / samples as f64, 4.0);
                    let line = fit.to_line(samples, 50.0);
                    // Newton's steps end at 1e-6 of a step.
                    assert!(
                        (line.frequency_hz - 50.0 * frequency).abs() < 1e-8,
                        "{off} {phase}"
                    );
                    assert!((line.amplitude - amplitude).abs() < 1e-6);
                    let turn = (line.phase.unwrap() - phase) / TAU;
                    assert!((turn - turn.round()).abs() < 1e-6);
                    assert!(line.phase.unwrap().abs() <= 0.5 * TAU);
                    // Bounds of white noise of the variance 4.
                    let n = samples as f64;
                    let omega = (24.0 * 4.0 / (9.0 * n.powi(3))).sqrt();
                    let error = line.frequency_error_hz.unwrap() / (50.0 * omega / TAU);
                    assert!((error - 1.0).abs() < 1e-6);
                    assert!((line.amplitude_error.unwrap() - (8.0 / n).sqrt()).abs() < 1e-12);
                    let twice = sine(samples, frequency, 2.0 * amplitude, phase);
                    let mut added = sine(samples, frequency, amplitude, phase);
                    fit.add_to(&mut added, 1.0);
                    fit.add_to(&mut record, -1.0);
                    for k in 0..samples {
                        assert!((added[k] - twice[k]).abs() < 1e-5);
                        assert!(record[k].is_nan() || record[k].abs() < 1e-5);
                    }
                    assert_eq!(record.iter().filter(|x| x.is_nan()).count(), 23);
                }
            }
        }
    }

    #[test]
    fn no_step_leaves_the_lobe() {
        // A sine five steps away is no part of this one.
        let record = sine(400, 0.2 + 5.0 / 400.0, 1.0, 0.3);
        let fit = Sine::fit(&record, 0.2, 1.0);
        assert!((fit.frequency - 0.2).abs() <= STEPS as f64 * 0.5 / 400.0 + 1e-12);
    }
}
