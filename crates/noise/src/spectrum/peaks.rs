//! Peaks of a density that stand out of the local median.

use super::welch::Density;
use undrift_base::order_statistics::upper_median;

/// Bins on either side of the one looked at that the median is taken over.
const REACH: usize = 25;

/// Bins on either side of a peak that a Hann window spreads a sine over.
const LOBE: usize = 2;

/// A peak of a density.
///
/// Its density alone says little: a sine's grows with the length of a segment, noise's does not. Its power, and
/// so the amplitude, is the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Frequency \[Hz\], the power-weighted mean over the peak.
    pub frequency_hz: f64,
    /// Amplitude of a sine with the peak's power \[unit\].
    pub amplitude: f64,
    /// Density of the peak over the local median [–].
    pub over_median: f64,
}

/// The peaks above `factor` times the median of the 51 bins around them, strongest first. The average
/// of n segments scatters by 1/√n about its mean, so a factor of 5 is plenty from 10 segments on;
/// bins 0 to 2 are left out (the mean, and what leaks of a drift). For a test with a stated false-alarm probability see
/// [`remove_lines`](super::remove_lines).
///
/// ```
/// use undrift_noise::spectrum::{peaks, welch};
/// // A fan of 30 Hz in noise, at 200 Hz.
/// let states = std::iter::successors(Some(1_u32), |s| Some(s.wrapping_mul(1_664_525).wrapping_add(1_013_904_223)));
/// let noise = states.map(|s| f64::from(s) / f64::from(u32::MAX) - 0.5);
/// let x: Vec<f64> = (0..8192).zip(noise).map(|(k, noise)| 0.3 * (0.3 * std::f64::consts::PI * f64::from(k)).sin() + noise).collect();
/// let found = peaks(&welch(&x, 200.0, 1024)?, 8.0);
/// assert!((found[0].frequency_hz - 30.0).abs() < 0.2 && (found[0].amplitude - 0.3).abs() < 0.05);
/// # Ok::<(), undrift_noise::screening::RecordError>(())
/// ```
pub fn peaks(density: &Density, factor: f64) -> Vec<Peak> {
    let power = &density.density;
    let mut found = Vec::new();
    let mut around = Vec::with_capacity(2 * REACH + 1);
    for k in LOBE + 1..power.len().saturating_sub(1) {
        let peak = power[k] > power[k - 1] && power[k] >= power[k + 1];
        if !peak {
            continue;
        }
        around.clear();
        around.extend_from_slice(
            &power[k.saturating_sub(REACH).max(1)..(k + REACH + 1).min(power.len())],
        );
        let median = upper_median(&mut around);
        if !(power[k] > factor * median && median > 0.0) {
            continue;
        }
        let (mut sum, mut moment) = (0.0, 0.0);
        for j in k - LOBE..=(k + LOBE).min(power.len() - 1) {
            let excess = (power[j] - median).max(0.0);
            sum += excess;
            moment += excess * density.frequency_hz[j];
        }
        found.push(Peak {
            frequency_hz: moment / sum,
            amplitude: (2.0 * sum * density.resolution_hz()).sqrt(),
            over_median: power[k] / median,
        });
    }
    found.sort_by(|a, b| b.over_median.total_cmp(&a.over_median));
    found
}
