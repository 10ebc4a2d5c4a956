//! A narrow resonance: its spectrum by Whittle's likelihood, and the notch filter that takes it out.
//!
//! A second-order system that noise drives has nearly this spectrum about its centre. Its four numbers are
//! found by Fisher's scoring of Whittle's likelihood, in which each ordinate of the periodogram is exponential
//! about the spectrum.
//!
//! The notch has its zeros on the poles of the resonance and poles that are broader by √(1 + H/B), so that what
//! comes out has the level beside it. Its state begins where the start of the record varies least: no transient
//! is left in the record.

use super::Line;
use super::periodogram::{Peak, Periodogram};
use crate::screening::record::mean;
use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};
use std::f64::consts::{PI, TAU};

/// Bins on either side of the peak that are fitted, and bands that they are averaged to.
const REACH: f64 = 64.0;
const BANDS: usize = 512;
const STEPS: usize = 100;
/// How far a resonance reaches on either side: widths, and bins at least.
const WIDTHS: f64 = 3.0;
const BINS: f64 = 16.0;
/// The notch is at most this share of its frequency, and of what is left to half the sample rate, broad.
const BROADEST: f64 = 0.5;
/// The start of the record from which the filter's state is estimated [decay times].
const START: f64 = 5.0;

/// A spectrum B + H/(1 + (2(f − f₀)/w)²) about its centre, in the scale of the periodogram.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resonance {
    /// f₀, its centre \[1/sample\].
    frequency: f64,
    /// w, its full width at half its height \[1/sample\].
    width: f64,
    /// H, its height \[unit²\].
    height: f64,
    /// B, the level beside it \[unit²\].
    background: f64,
}

impl Resonance {
    /// Fits it from a peak by scoring: log S + P/S summed over the bins about it is least.
    pub(super) fn fitted(of: &Periodogram, peak: &Peak) -> Self {
        let reach = (REACH * peak.width.max(of.frequency(1.0))).min(0.5 * peak.frequency);
        let last = of.power.len() - 2;
        let from = of.bin(peak.frequency - reach).max(1);
        let to = of.bin(peak.frequency + reach).min(last);
        let each = (to - from) / BANDS + 1;
        let bands = of.power[from..=to].chunks(each).enumerate();
        let bands: Vec<(f64, f64, f64)> = bands
            .map(|(k, band)| {
                let bins = band.len() as f64;
                let centre = (from + k * each) as f64 + 0.5 * (bins - 1.0);
                (of.frequency(centre), band.iter().sum::<f64>() / bins, bins)
            })
            .collect();
        let mut best = Self {
            frequency: peak.frequency,
            width: peak.width,
            height: peak.power,
            background: peak.background,
        };
        let mut least = best.deviance(&bands);
        let (lowest, step) = (of.frequency(0.5), of.frequency(1.0));
        for _ in 0..STEPS {
            let Some(by) = best.scoring(&bands) else {
                break;
            };
            // Half of the step as long as it goes too far.
            let tried = (0..12).map(|halvings| best.moved(&by, 0.5f64.powi(halvings), lowest));
            let tried = tried.map(|next| (next.deviance(&bands), next));
            let Some((deviance, next)) = tried.into_iter().find(|(deviance, _)| *deviance < least)
            else {
                break;
            };
            let (fall, moved) = (least - deviance, (next.frequency - best.frequency).abs());
            (best, least) = (next, deviance);
            if fall < 1e-6 && moved < 1e-3 * step {
                break;
            }
        }
        best
    }

    /// Whether a peak is within it, in a record of the resolution `step` \[1/sample\].
    pub(super) fn reaches(&self, peak: &Peak, step: f64) -> bool {
        (peak.frequency - self.frequency).abs() < (WIDTHS * self.width).max(BINS * step)
    }

    /// Spectrum at a frequency \[1/sample\], \[unit²\].
    ///
    /// A Lorentzian over a level: the spectrum of a damped oscillator near its resonance.
    fn density(&self, frequency: f64) -> f64 {
        let u = 2.0 * (frequency - self.frequency) / self.width;
        self.background + self.height / (1.0 + u * u)
    }

    /// Whittle's deviance of bands of frequency, mean power and number of bins: the sum of log S + P/S.
    fn deviance(&self, bands: &[(f64, f64, f64)]) -> f64 {
        let deviance = |(f, power, bins): &(f64, f64, f64)| {
            let density = self.density(*f);
            bins * (density.ln() + power / density)
        };
        bands.iter().map(deviance).sum()
    }

    /// Fisher's scoring: the step of f₀/w, ln w, ln H and ln B.
    ///
    /// Information Σ g gᵀ, score Σ g (P/S − 1), g = ∂ ln S; positive by construction, so a step
    /// goes downhill. `None` where the information is singular, as of a height of zero.
    fn scoring(&self, bands: &[(f64, f64, f64)]) -> Option<Vector4<f64>> {
        let (mut information, mut score) = (Matrix4::zeros(), Vector4::zeros());
        for (f, power, bins) in bands {
            let u = 2.0 * (f - self.frequency) / self.width;
            let shape = 1.0 / (1.0 + u * u);
            let density = self.density(*f);
            let part = self.height * shape;
            let gradient = Vector4::new(
                4.0 * part * shape * u,
                2.0 * part * shape * u * u,
                part,
                self.background,
            ) / density;
            information += gradient * gradient.transpose() * *bins;
            score += gradient * (bins * (power / density - 1.0));
        }
        information.cholesky().map(|of| of.solve(&score))
    }

    /// The resonance after a `share` of a step, within the frequencies that a record of resolution `lowest` has.
    fn moved(&self, by: &Vector4<f64>, share: f64, lowest: f64) -> Self {
        let factor = |by: f64| (share * by).clamp(-2.0, 2.0).exp();
        let shift = (share * by[0] * self.width).clamp(-2.0 * self.width, 2.0 * self.width);
        Self {
            frequency: (self.frequency + shift).clamp(lowest, 0.5 - lowest),
            width: (self.width * factor(by[1])).max(lowest),
            height: self.height * factor(by[2]),
            background: self.background * factor(by[3]),
        }
    }

    /// Amplitude of a sine with the power 2·H·πw/2 of both peaks.
    ///
    /// `rate_hz` \[Hz\]; amplitude \[unit\] of the sine that has the power of the peak.
    pub(super) fn result(&self, rate_hz: f64) -> Line {
        Line {
            frequency_hz: self.frequency * rate_hz,
            amplitude: (TAU * self.width * self.height).sqrt(),
            width_hz: self.width * rate_hz,
            ..Line::default()
        }
    }

    /// Filters the resonance out of a whole record and stores the samples that `record` has.
    ///
    /// `whole` is the record with its gaps bridged, on which the filter runs; missing samples of
    /// `record` stay missing.
    pub(super) fn notch(&self, whole: &[f64], record: &mut [f64]) {
        let room = BROADEST * self.frequency.min(0.5 - self.frequency);
        let broad = (self.width * (1.0 + self.height / self.background).sqrt()).min(room);
        let filter = Notch::new(self.frequency, self.width.min(broad), broad);
        // About the mean of the start, which the filter passes.
        let start = ((START / (PI * broad)).ceil() as usize).clamp(1, whole.len());
        let level = mean(&whole[..start]);
        // Of the states that the record may begin with, the one after which the start varies least.
        let (mut now, mut units) = ([0.0; 2], [[1.0, 0.0], [0.0, 1.0]]);
        let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
        for x in &whole[..start] {
            let y = filter.next(&mut now, x - level);
            let row = Vector2::from(units.each_mut().map(|state| filter.next(state, 0.0)));
            normal += row * row.transpose();
            right -= row * y;
        }
        let state = normal.lu().solve(&right).unwrap_or_default();
        let mut state = [state[0], state[1]];
        for (x, slot) in whole.iter().zip(record) {
            let y = level + filter.next(&mut state, x - level);
            if slot.is_finite() {
                *slot = y;
            }
        }
    }
}

/// Zeros on the poles of a resonance, poles of a peak that is broader by √(1 + H/B): its gain is √(B/S), and 1 at
/// frequency 0.
///
/// Second order, minimum phase; frequencies \[1/sample\].
struct Notch {
    gain: f64,
    zeros: [f64; 2],
    poles: [f64; 2],
}

impl Notch {
    fn new(frequency: f64, narrow: f64, broad: f64) -> Self {
        let pair = |width: f64| {
            let radius = (-PI * width).exp();
            [-2.0 * radius * (TAU * frequency).cos(), radius * radius]
        };
        let (zeros, poles) = (pair(narrow), pair(broad));
        let gain = (1.0 + poles[0] + poles[1]) / (1.0 + zeros[0] + zeros[1]);
        Self { gain, zeros, poles }
    }

    /// The next output; the transposed second direct form.
    fn next(&self, state: &mut [f64; 2], x: f64) -> f64 {
        let x = self.gain * x;
        let y = x + state[0];
        *state = [
            state[1] + self.zeros[0] * x - self.poles[0] * y,
            self.zeros[1] * x - self.poles[1] * y,
        ];
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OF: Resonance = Resonance {
        frequency: 0.13,
        width: 0.004,
        height: 30.0,
        background: 2.0,
    };

    fn peak(frequency: f64) -> Peak {
        Peak {
            frequency,
            power: 1.0,
            background: 1.0,
            width: 0.001,
            is_broad: true,
        }
    }

    /// Power gain of a series as the response to an impulse.
    fn gain(response: &[f64], frequency: f64) -> f64 {
        let turn = |k: usize| (TAU * frequency * k as f64).sin_cos();
        let terms = response.iter().enumerate().map(|(k, h)| {
            let (sin, cos) = turn(k);
            [h * cos, h * sin]
        });
        let [re, im] = terms.fold([0.0; 2], |sum, term| [sum[0] + term[0], sum[1] + term[1]]);
        re * re + im * im
    }

    #[test]
    fn the_notch_makes_the_spectrum_flat() {
        for of in [
            OF,
            Resonance {
                frequency: 0.4,
                ..OF
            },
            Resonance { height: 1.0, ..OF },
        ] {
            let mut whole = vec![0.0; 6000];
            whole[3000] = 1.0;
            let mut record = whole.clone();
            of.notch(&whole, &mut record);
            assert!(record[..3000].iter().all(|x| *x == 0.0));
            let response = &record[3000..];
            let level: f64 = response.iter().sum();
            assert!((level - 1.0).abs() < 1e-9, "{level}");
            for off in [-3.0, -1.0, -0.5, 0.0, 0.3, 1.0, 2.0] {
                let f = of.frequency + off * of.width;
                let flat = gain(response, f) * of.density(f) / of.background;
                // The peak at −f, 0.26 and twice 0.1 away, and the width itself against f: (4 · 0.004/0.13)².
                assert!((flat - 1.0).abs() < 0.05, "{of:?} {off}: {flat}");
            }
        }
    }

    #[test]
    fn a_notch_is_no_broader_than_half_of_the_room_about_it() {
        // So high a resonance that its flat notch would be broader than 0.065.
        let resonance = Resonance { height: 1e6, ..OF };
        let mut whole = vec![0.0; 6000];
        whole[3000] = 1.0;
        let mut record = whole.clone();
        resonance.notch(&whole, &mut record);
        // The response decays as e^(−π w k): of what is left after 100 samples only the slowest, the poles.
        let energy = |from: usize| record[3000 + from..].iter().map(|x| x * x).sum::<f64>();
        let decay = 0.5 * (energy(1) / energy(101)).ln() / (100.0 * PI);
        assert!((decay / (0.5 * 0.13) - 1.0).abs() < 0.2, "{decay}");
    }

    #[test]
    fn ringing_that_the_record_begins_with_is_taken_out_from_its_first_sample_on() {
        let level = 5.0;
        let whole: Vec<f64> = (0..4000)
            .map(|k| {
                let k = f64::from(k);
                level + (-PI * OF.width * k).exp() * (TAU * OF.frequency * k + 1.0).cos()
            })
            .collect();
        let mut record = whole.clone();
        record[7] = f64::NAN;
        OF.notch(&whole, &mut record);
        assert!(record[7].is_nan());
        record[7] = level;
        // The mean of the start, which is not quite the level: a period's share of 100 samples.
        let worst = record.iter().map(|x| (x - level).abs()).fold(0.0, f64::max);
        assert!(worst < 0.05, "{worst}");
    }

    #[test]
    fn a_step_of_scoring_is_the_way_to_the_spectrum() {
        let bands: Vec<(f64, f64, f64)> = (0..400)
            .map(|k| {
                let f = 0.1 + 0.06 * f64::from(k) / 400.0;
                (f, OF.density(f), 3.0)
            })
            .collect();
        let far = 1e-3;
        let starts = [
            Resonance {
                frequency: OF.frequency - far * OF.width,
                ..OF
            },
            Resonance {
                width: OF.width * (1.0 - far),
                ..OF
            },
            Resonance {
                height: OF.height * (1.0 - far),
                ..OF
            },
            Resonance {
                background: OF.background * (1.0 - far),
                ..OF
            },
        ];
        for (at, start) in starts.into_iter().enumerate() {
            let by = start.scoring(&bands).unwrap();
            for i in 0..4 {
                let exact = if i == at { far } else { 0.0 };
                // The second order.
                assert!((by[i] - exact).abs() < 20.0 * far * far, "{at} {i}: {by}");
            }
            let there = start.moved(&by, 1.0, 1e-6);
            let half = start.moved(&by, 0.5, 1e-6);
            let least = OF.deviance(&bands);
            // A square law: a quarter is left half way, and the fourth order at the end.
            let left = [start, half, there].map(|of| of.deviance(&bands) - least);
            assert!((left[1] / left[0] - 0.25).abs() < 0.02, "{at}: {left:?}");
            assert!(left[2] < 1e-3 * left[0], "{at}: {left:?}");
        }
    }

    #[test]
    fn a_step_goes_no_farther_than_two_widths_or_two_in_a_logarithm_and_stays_in_the_band() {
        let moved = |by: [f64; 4]| OF.moved(&Vector4::from(by), 1.0, 0.01);
        let up = moved([9.0; 4]);
        assert_eq!(up.frequency, 0.13 + 2.0 * 0.004);
        assert_eq!(up.height, 30.0 * 2f64.exp());
        assert_eq!(up.background, 2.0 * 2f64.exp());
        let down = moved([-9.0; 4]);
        assert_eq!(down.frequency, 0.13 - 2.0 * 0.004);
        // No narrower than the lowest frequency.
        assert_eq!(down.width, 0.01);
        assert_eq!(down.height, 30.0 * (-2f64).exp());
        let edge = |frequency| Resonance { frequency, ..OF };
        let by = Vector4::new(9.0, 0.0, 0.0, 0.0);
        assert_eq!(edge(0.489).moved(&by, 1.0, 0.01).frequency, 0.49);
        assert_eq!(edge(0.011).moved(&-by, 1.0, 0.01).frequency, 0.01);
    }

    #[test]
    fn its_amplitude_is_that_of_a_sine_of_its_power() {
        // Both peaks, less the background, over all frequencies.
        let step = 1e-4;
        let offs = (-1_000_000..1_000_000).map(|k| (f64::from(k) + 0.5) * step);
        let power: f64 = offs
            .map(|f| 2.0 * step * OF.height / (1.0 + (2.0 * f / OF.width).powi(2)))
            .sum();
        let line = OF.result(50.0);
        // Its tails beyond 100 carry w/(π · 100) of it.
        assert!((0.5 * line.amplitude.powi(2) / power - 1.0).abs() < 1e-4);
        assert_eq!(
            (line.frequency_hz, line.width_hz),
            (0.13 * 50.0, 0.004 * 50.0)
        );
    }

    #[test]
    fn it_reaches_three_widths_and_sixteen_bins_at_least() {
        for (step, reach) in [(1e-4, 3.0 * 0.004), (1e-3, 16.0 * 1e-3)] {
            for side in [-1.0, 1.0] {
                assert!(OF.reaches(&peak(0.13 + 0.99 * side * reach), step));
                assert!(!OF.reaches(&peak(0.13 + 1.01 * side * reach), step));
            }
        }
    }
}
