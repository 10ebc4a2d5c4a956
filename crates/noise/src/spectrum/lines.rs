//! Spectral lines and narrow resonances of a record: found by a test with a stated false-alarm probability,
//! estimated, and taken out.
//!
//! A peak of the periodogram (Hann window, the whole record) counts where its ratio to the medians of its
//! neighbours on both sides exceeds what the F distribution allows in [`FALSE_ALARM`] of all records,
//! whatever frequency it has. A line is then a sine by least squares, frequency included. What
//! is broader than the record resolves, or lies beside a line because its phase or amplitude
//! wanders, is a narrow resonance: a process of the spectrum H/(1 + (2(f − f₀)/w)²) on a flat background, which a
//! notch filter with the resonance's damped pair of poles as its zeros makes flat again.
//!
//! ```
//! use undrift_noise::spectrum;
//! // Uniform noise, σ = 0.29, of a linear congruential generator.
//! let states = std::iter::successors(Some(1_u32), |s| Some(s.wrapping_mul(1_664_525).wrapping_add(1_013_904_223)));
//! let noise = states.map(|s| f64::from(s) / f64::from(u32::MAX) - 0.5);
//! let mut x = Vec::from_iter((0..4096).zip(noise).map(|(k, noise)| 0.5 * (0.5 * f64::from(k)).sin() + noise));
//! let lines = spectrum::remove_lines(&mut x, 100.0);
//! assert!((lines[0].frequency_hz - 0.5 * 100.0 / std::f64::consts::TAU).abs() < 1e-3);
//! assert!((lines[0].amplitude - 0.5).abs() < 0.03 && lines[0].width_hz == 0.0);
//! ```

mod periodogram;
mod resonance;
mod sine;

use crate::screening::bridge::bridge;
use periodogram::{Peak, Periodogram};
use resonance::Resonance;
use serde::{Deserialize, Serialize};
use sine::Sine;

/// Probability that a record without lines shows one, over all frequencies and widths looked at.
pub const FALSE_ALARM: f64 = 1e-3;
/// Number of lines and resonances that are looked for in a record at most.
pub const MOST: usize = 20;
/// Shortest record that has room for a peak and what is beside it \[samples\].
const FEWEST: usize = 128;
/// Looks at a record: each sees what the ones before have left.
const ROUNDS: usize = 12;
/// A peak this near to a line that was taken out belongs to it [steps of 1/(length of the record)].
const BESIDE: f64 = 8.0;
/// Lines this near to a resonance are part of it [the same].
const PART: f64 = 64.0;

/// A spectral line, or a narrow resonance: of an engine, a fan, the mains, or the sensor's own structure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Line {
    /// Frequency, of a resonance its centre \[Hz\].
    pub frequency_hz: f64,
    /// Amplitude of a line's sine, of a resonance that of a sine with its power \[unit\].
    pub amplitude: f64,
    /// Full width of a resonance at half its power \[Hz\]; 0 of a line.
    pub width_hz: f64,
    /// Phase φ of A cos(2πft + φ), t from the first sample on \[rad\]; a resonance has none.
    pub phase: Option<f64>,
    /// Standard error of a line's frequency \[Hz\].
    pub frequency_error_hz: Option<f64>,
    /// Standard error of a line's amplitude \[unit\].
    pub amplitude_error: Option<f64>,
}

/// Takes lines and narrow resonances out of a record sampled at `rate_hz` \[Hz\], NaN where a sample is missing,
/// and returns them by growing frequency. One FFT of the record where there are none, at most a dozen where there are.
///
/// A record shorter than 128 samples is left as it is. What is removed is returned: a line may be added again
/// from its frequency, amplitude and phase, a resonance may not.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{spectrum::remove_lines, synthesis::NoiseGenerator};
/// // White noise shows a line in one record of a thousand.
/// let mut noise: Vec<f64> = NoiseGenerator::new(&ShapingFilter::white(0.1, 0.01)?, 1).take(4096).collect();
/// assert!(remove_lines(&mut noise, 100.0).is_empty());
/// # Ok::<(), undrift_nav::shaping::ShapingError>(())
/// ```
pub fn remove_lines(record: &mut [f64], rate_hz: f64) -> Vec<Line> {
    if record.len() < FEWEST {
        return Vec::new();
    }
    let step = 1.0 / record.len() as f64;
    let (mut lines, mut resonances): (Vec<Sine>, Vec<Resonance>) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        let room = MOST.saturating_sub(lines.len() + resonances.len());
        let periodogram = match record.iter().any(|x| x.is_nan()) {
            true => Periodogram::new(&bridge(record, 0.0)),
            false => Periodogram::new(record),
        };
        let mut peaks = periodogram.peaks(FALSE_ALARM);
        // What the fit of a resonance has left of it is no line.
        peaks.retain(|peak| peak.is_broad || !resonances.iter().any(|of| of.reaches(peak, step)));
        if peaks.is_empty() || room == 0 {
            break;
        }
        let is_beside = |peak: &&Peak| {
            let near = |line: &Sine| (line.frequency - peak.frequency).abs() < BESIDE * step;
            peak.is_broad || lines.iter().any(near)
        };
        if let Some(peak) = peaks.iter().find(is_beside) {
            let is_part = |line: &mut Sine| (line.frequency - peak.frequency).abs() < PART * step;
            for line in lines.extract_if(.., is_part) {
                line.add_to(record, 1.0);
            }
            let whole = bridge(record, 0.0);
            let resonance = Resonance::fitted(&Periodogram::new(&whole), peak);
            resonance.notch(&whole, record);
            resonances.push(resonance);
        } else {
            let first = lines.len();
            for peak in peaks.iter().take(room) {
                let line = Sine::fit(record, peak.frequency, peak.background);
                line.add_to(record, -1.0);
                lines.push(line);
            }
            // Again, without the others of this round.
            if peaks.len() > 1 {
                for line in &mut lines[first..] {
                    line.add_to(record, 1.0);
                    *line = Sine::fit(record, line.frequency, line.background);
                    line.add_to(record, -1.0);
                }
            }
        }
    }
    let lines = lines.iter().map(|line| line.to_line(record.len(), rate_hz));
    let resonances = resonances.iter().map(|of| of.result(rate_hz));
    let mut all: Vec<Line> = lines.chain(resonances).collect();
    all.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    all
}
