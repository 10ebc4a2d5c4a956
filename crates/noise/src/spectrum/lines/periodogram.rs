//! The periodogram of a whole record, and the peaks of it that chance does not make.
//!
//! White noise gives bins that are exponential, so the ratio of one to the mean of others has an F distribution
//! with 2 and twice their number degrees of freedom. Medians in place of means are blind to a second line
//! nearby, at the price of some efficiency, which counts as fewer neighbours. The level is divided by the
//! number of all bins and bands that are looked at (Bonferroni), so that the false-alarm probability is one of
//! the whole record.
//!
//! Frequencies are in cycles per sample throughout, ½ the Nyquist frequency. A Hann window keeps a
//! slow bias from leaking over the record; its main lobe is four bins wide, which is why neighbours
//! next to a peak do not count as background. O(N log N), and a median a bin that passes a quick
//! look.

use crate::screening::record::mean;
use realfft::RealFftPlanner;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use undrift_base::order_statistics::upper_median;

/// Bins of a band at each width looked at: each fits a resonance about as broad.
const BANDS: [usize; 6] = [1, 4, 16, 64, 256, 1024];
/// Neighbours on either side that the background is taken from, at least and at most: of single bins, and of bands.
const FEWEST: usize = 6;
const BINS: usize = 64;
const NEIGHBOURS: usize = 16;
/// The neighbours reach over this share of the frequency: farther off the spectrum is another.
const REACH: f64 = 0.2;
/// Neighbours next to a peak that are part of it: of single bins, whose lobe has two bins on either side, and of bands.
const LOBE: usize = 3;
const NEXT: usize = 1;
/// Variance of the mean of many bins over that of independent ones: 1 + 2 (4/9 + 1/36), from the correlations of a Hann
/// window's neighbouring bins.
const CORRELATED: f64 = 35.0 / 18.0;
/// Efficiency of the median against the mean, of exponential and of nearly normal variables.
const MEDIAN_OF_BINS: f64 = 0.48;
const MEDIAN_OF_BANDS: f64 = 0.64;
/// A band this much above its neighbours is a resonance, however sure less is: a smooth spectrum has curves too.
const PROMINENT: f64 = 2.0;
/// Bins beside a peak that show whether it is on top of a broader one, and the ratio to the background from which on it does.
const PEDESTAL: std::ops::RangeInclusive<usize> = 5..=14;
const ON_PEDESTAL: f64 = 3.0;

/// Power of the bins 0 … n/2 over the variance of white noise: |X|²/Σw².
pub(super) struct Periodogram {
    /// Bins 0 … n/2 \[unit²\]; bin 0 stays 0.
    pub(super) power: Vec<f64>,
    /// Samples of the record, n; a bin is 1/n.
    samples: usize,
}

/// A peak that is significant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peak {
    /// Frequency \[1/sample\].
    pub(super) frequency: f64,
    /// Power \[unit²\], the mean over its band.
    pub(super) power: f64,
    /// Power beside it \[unit²\].
    pub(super) background: f64,
    /// Width of its band \[1/sample\].
    pub(super) width: f64,
    /// It is broader than a line.
    pub(super) is_broad: bool,
}

impl Periodogram {
    /// The periodogram of a record less the straight line from its beginning to its end, with a Hann window.
    ///
    /// The line through the ends, not the least-squares one: it makes the record periodic, which is
    /// what a transform takes it to be.
    pub(super) fn new(x: &[f64]) -> Self {
        let n = x.len();
        let end = (n / 10).clamp(1, 100);
        let (first, last) = (mean(&x[..end]), mean(&x[n - end..]));
        let slope = (last - first) / (n - end).max(1) as f64;
        let mut time: Vec<f64> = x
            .iter()
            .enumerate()
            .map(|(k, x)| x - first - slope * k as f64)
            .collect();
        let plan = RealFftPlanner::<f64>::new().plan_fft_forward(n);
        let mut spectrum = plan.make_output_vec();
        // The buffers have the plan's own sizes: this cannot fail.
        let _ = plan.process(&mut time, &mut spectrum);
        // The window as a convolution: ½ − ½ cos.
        let mut power = vec![0.0; spectrum.len()];
        for (k, power) in power.iter_mut().enumerate().skip(1) {
            // Beyond half the sample rate the spectrum goes back.
            let after = spectrum.get(k + 1).copied();
            let after = after.unwrap_or_else(|| spectrum[n - k - 1].conj());
            let windowed = 0.5 * spectrum[k] - 0.25 * (spectrum[k - 1] + after);
            *power = windowed.norm_sqr() / (0.375 * n as f64);
        }
        Self { power, samples: n }
    }

    /// Frequency of a bin \[1/sample\].
    pub(super) fn frequency(&self, bin: f64) -> f64 {
        bin / self.samples as f64
    }

    /// The bin that a frequency \[1/sample\] is in.
    pub(super) fn bin(&self, frequency: f64) -> usize {
        (frequency * self.samples as f64).round() as usize
    }

    /// Peaks that a record without any shows with the probability `false_alarm` in all, the strongest first: single bins,
    /// or where there are none of those, bands.
    pub(super) fn peaks(&self, false_alarm: f64) -> Vec<Peak> {
        let bands: Vec<(usize, Vec<f64>)> =
            BANDS.iter().map(|&bins| (bins, self.bands(bins))).collect();
        let tests: usize = bands.iter().map(|(_, power)| power.len()).sum();
        let level = false_alarm / tests as f64;
        let mut peaks = Vec::new();
        for (bins, power) in &bands {
            let found = (0..power.len()).filter_map(|k| self.peak(power, *bins, k, level));
            peaks.extend(found);
            if *bins == 1 && !peaks.is_empty() {
                break;
            }
        }
        peaks.sort_by(|a, b| (b.power / b.background).total_cmp(&(a.power / a.background)));
        self.without_lobes(peaks)
    }

    /// Means of bands from bin 1 on; those of bins 1 are the bins themselves, up to half the sample rate.
    fn bands(&self, bins: usize) -> Vec<f64> {
        let end = self.samples.div_ceil(2);
        self.power[1..end]
            .chunks_exact(bins)
            .map(|band| band.iter().sum::<f64>() / bins as f64)
            .collect()
    }

    /// The band at `at`, if it is a peak and its F is beyond the level.
    ///
    /// F = power over background, with 2 degrees of freedom a bin and as many a neighbour, less for
    /// the correlation of bins and the efficiency of the median. Bins whose neighbours would reach
    /// below frequency 0 are not looked at.
    fn peak(&self, power: &[f64], bins: usize, at: usize, level: f64) -> Option<Peak> {
        let here = power[at];
        let (before, after) = (at.checked_sub(1)?, power.get(at + 1)?);
        if !(here > power[before] && here >= *after) {
            return None;
        }
        let (skip, most) = if bins == 1 {
            (LOBE, BINS)
        } else {
            (NEXT, NEIGHBOURS)
        };
        let count = ((at as f64 * REACH) as usize)
            .saturating_sub(skip)
            .min(most);
        if count < FEWEST {
            return None;
        }
        // What is quickly seen to be no peak.
        let rough: f64 = power[at - skip - FEWEST..at - skip].iter().sum::<f64>() / FEWEST as f64;
        if here < PROMINENT * rough {
            return None;
        }
        let end = power.len().min(at + skip + 1 + count);
        let sides = [
            &power[at - skip - count..at - skip],
            power.get(at + skip + 1..end).unwrap_or(&[]),
        ];
        let freedom = 2.0 * bins as f64 / if bins == 1 { 1.0 } else { CORRELATED };
        // Wilson & Hilferty: median of χ² over its mean.
        let to_mean = (1.0 - 2.0 / (9.0 * freedom)).powi(-3);
        let sides = sides.map(|side| (side.len(), upper_median(&mut side.to_vec())));
        let used = sides.iter().filter(|(count, _)| *count >= FEWEST);
        // Of a slope or a step the higher side.
        let background = to_mean * used.clone().map(|(_, median)| *median).fold(0.0, f64::max);
        let neighbours: usize = used.map(|(count, _)| count).sum();
        let independent = neighbours as f64
            * if bins == 1 {
                MEDIAN_OF_BINS / CORRELATED
            } else {
                MEDIAN_OF_BANDS
            };
        let f = here / background;
        let floor = if bins == 1 { 1.0 } else { PROMINENT };
        if f.is_nan() || f < floor {
            return None;
        }
        let distribution = FisherSnedecor::new(freedom, freedom * independent).ok()?;
        if distribution.sf(f) > level {
            return None;
        }
        let centre = 1.0 + (at * bins) as f64 + 0.5 * (bins - 1) as f64;
        Some(Peak {
            frequency: self.frequency(if bins == 1 {
                centre + self.offset(at + 1)
            } else {
                centre
            }),
            power: here,
            background,
            width: self.frequency(bins as f64),
            is_broad: bins > 1 || self.pedestal(at + 1) > ON_PEDESTAL * background,
        })
    }

    /// Where between its neighbours a bin's peak is, by the parabola through the logarithms of three \[bins\].
    fn offset(&self, bin: usize) -> f64 {
        let [a, b, c] = [bin - 1, bin, bin + 1].map(|k| self.power[k].max(f64::MIN_POSITIVE).ln());
        let bend = a - 2.0 * b + c;
        if bend < 0.0 {
            (0.5 * (a - c) / bend).clamp(-0.5, 0.5)
        } else {
            0.0
        }
    }

    /// Mean power beside a peak less what a sine's own lobes have there.
    fn pedestal(&self, bin: usize) -> f64 {
        let beside = |distance: usize| {
            let sides = [bin.checked_sub(distance), Some(bin + distance)];
            let sides = sides
                .into_iter()
                .flatten()
                .filter_map(|k| self.power.get(k));
            let lobe = lobe(self.power[bin], distance as f64);
            sides.map(move |power| (power - lobe).max(0.0))
        };
        let powers: Vec<f64> = PEDESTAL.flat_map(beside).collect();
        mean(&powers)
    }

    /// Peaks, the strongest first, without those that may be lobes of a stronger one or part of it.
    fn without_lobes(&self, peaks: Vec<Peak>) -> Vec<Peak> {
        let mut kept: Vec<Peak> = Vec::new();
        for peak in peaks {
            let is_lobe = |other: &Peak| {
                let distance = (other.frequency - peak.frequency).abs() * self.samples as f64;
                distance < super::BESIDE || peak.power < 4.0 * lobe(other.power, distance)
            };
            if !kept.iter().any(is_lobe) {
                kept.push(peak);
            }
        }
        kept
    }
}

/// Most power of a sine at a distance \[bins\] from its peak, of the peak's: a Hann window's lobes fall as
/// 1/(π d³), and between two bins the peak itself is 0.85 of its height.
fn lobe(peak: f64, distance: f64) -> f64 {
    0.15 * peak / distance.powi(6)
}

#[cfg(test)]
mod tests;
