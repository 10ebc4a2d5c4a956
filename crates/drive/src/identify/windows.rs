//! The axes of a record in windows of a second: whether one moves, shakes or rests.

use crate::record::Record;
use std::ops::Range;
use undrift_base::order_statistics::{MAD_TO_SIGMA, upper_median};
use undrift_noise::temperature::{self, LEAST_CHANGE_K};

/// Least samples of a window, which is a second else.
const WINDOW: f64 = 20.0;
const LONGEST: f64 = 1e6;
/// Windows in a block; it and its neighbours give the level that a window is compared with: a drift over minutes is
/// no motion.
const BLOCK: usize = 60;
/// A window moves whose mean is so far from that level: slower than a vehicle turns [rad/s], and less than it
/// accelerates or tilts [m/s²]; more than quiet noise and rounding explain.
const TURN: f64 = 0.017_453;
const FORCE: f64 = 0.2;
const NOISE: f64 = 8.0;
pub(super) const STEPS: f64 = 1.5;
/// A window rests that is no noisier than so many times the quietest tenth; it shakes beyond so many times the median.
const QUIET: f64 = 3.0;
const LOUD: f64 = 4.0;
/// Windows to either side whose median a bump does not move and a step leaves.
const BESIDE: usize = 10;

/// A window swings whose mean is so many robust standard deviations off that median.
const SWINGS: f64 = 10.0;

/// The windows to either side of one.
fn beside(window: usize) -> Range<usize> {
    window.saturating_sub(BESIDE)..window + BESIDE + 1
}

/// A record in windows, the same of all axes.
pub(super) struct Windows {
    /// Samples of a window.
    pub(super) width: usize,
    /// Number of windows.
    pub(super) count: usize,
    /// The axes by name.
    pub(super) axes: Vec<(&'static str, Levels)>,
    /// Means of the temperature [°C] where it changes, the last one where they are missing.
    pub(super) temperature: Option<Vec<f64>>,
}

impl Windows {
    /// The windows of a record at a rate \[Hz\]; NaN is a missing sample.
    pub(super) fn new(record: &Record, rate_hz: f64) -> Self {
        let present = |samples: &Vec<f64>| samples.iter().filter(|x| !x.is_nan()).count();
        let length = record.length() as f64;
        let axes = || record.axes.iter().zip(&record.samples);
        // Of a sensor that is slower than the record as many values.
        let widths = axes().map(|(_, samples)| WINDOW * length / present(samples).max(1) as f64);
        let width = widths
            .fold(rate_hz.round(), f64::max)
            .clamp(WINDOW, LONGEST) as usize;
        let least = |name: &str| match name.starts_with("gyro") {
            true => TURN,
            false => FORCE,
        };
        Self {
            width,
            count: record.length() / width,
            axes: axes()
                .map(|(name, samples)| (*name, Levels::new(samples, width, least(name))))
                .collect(),
            temperature: record
                .temperature
                .as_deref()
                .and_then(|samples| temperature(samples, width)),
        }
    }

    /// Which windows of a part have an axis whose mean is off the median of the minutes around it.
    pub(super) fn moving(&self, part: &Range<usize>) -> Vec<bool> {
        self.any(part, |levels| {
            levels.off(part, BLOCK, |k| {
                let block = k / BLOCK;
                (block * BLOCK).saturating_sub(BLOCK)..(block + 2) * BLOCK
            })
        })
    }

    /// Which windows of a part have an axis whose mean is off the median of the seconds around it.
    pub(super) fn bumped(&self, part: &Range<usize>) -> Vec<bool> {
        self.any(part, |levels| levels.off(part, 1, beside))
    }

    /// Which windows of a part have an axis whose mean is off the median of the seconds around it by more than the noise of the
    /// part explains: knocked or tilted and back, too gently to move.
    pub(super) fn swings(&self, part: &Range<usize>) -> Vec<bool> {
        self.any(part, |levels| {
            let off = levels.beside(part, 1, beside);
            let mut sizes: Vec<f64> = off.iter().copied().filter(|x| !x.is_nan()).collect();
            if sizes.is_empty() {
                return vec![false; part.len()];
            }
            let limit = SWINGS * MAD_TO_SIGMA * upper_median(&mut sizes);
            let limit = limit.max(STEPS * levels.step);
            off.iter().map(|off| *off > limit).collect()
        })
    }

    /// Which windows of a part have an axis that shakes.
    pub(super) fn loud(&self, part: &Range<usize>) -> Vec<bool> {
        self.any(part, |levels| {
            let deviations = &levels.deviations[part.clone()];
            deviations.iter().map(|one| *one > levels.loud).collect()
        })
    }

    /// Whether all axes rest in a window.
    pub(super) fn rests(&self, window: usize) -> bool {
        self.axes.iter().all(|(_, levels)| levels.rests(window))
    }

    /// Whether an axis has a sample in a window.
    pub(super) fn has(&self, window: usize) -> bool {
        let mut axes = self.axes.iter();
        axes.any(|(_, levels)| levels.means[window].is_finite())
    }

    fn any(&self, part: &Range<usize>, of: impl Fn(&Levels) -> Vec<bool>) -> Vec<bool> {
        let mut any = vec![false; part.len()];
        for (_, levels) in &self.axes {
            any.iter_mut()
                .zip(of(levels))
                .for_each(|(any, one)| *any |= one);
        }
        any
    }
}

/// An axis in windows. Each is taken without its least and its largest sample, so that a single outlier is nothing of
/// the window.
pub(super) struct Levels {
    /// Means \[unit\], NaN of a window that is missing.
    pub(super) means: Vec<f64>,
    deviations: Vec<f64>,
    /// How far a mean may be off at rest.
    limit: f64,
    /// Deviation of a window up to which it is quiet, and beyond which it shakes.
    quiet: f64,
    loud: f64,
    /// Step of the samples.
    pub(super) step: f64,
}

impl Levels {
    fn new(samples: &[f64], width: usize, least: f64) -> Self {
        let windows = samples.chunks_exact(width).map(trimmed);
        let (means, deviations): (Vec<f64>, Vec<f64>) = windows.unzip();
        let mut sorted: Vec<f64> = deviations.iter().copied().filter(|x| !x.is_nan()).collect();
        sorted.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = sorted.len().saturating_sub(1);
            sorted
                .get((share * last as f64) as usize)
                .copied()
                .unwrap_or(0.0)
        };
        let present = samples.iter().filter(|x| !x.is_nan()).count() as f64;
        let each = (present / means.len().max(1) as f64).max(1.0);
        let step = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let step = step
            .filter(|step| *step > 0.0)
            .fold(f64::INFINITY, f64::min);
        let step = if step.is_finite() { step } else { 0.0 };
        Self {
            limit: least.max(NOISE * at(0.25) / each.sqrt()).max(STEPS * step),
            quiet: QUIET * at(0.1) + step,
            loud: LOUD * at(0.5) + step,
            step,
            means,
            deviations,
        }
    }

    /// Which windows of a part are off the median of those around, by their places in the part, which are the same of `every`
    /// windows in a row.
    fn off(
        &self,
        part: &Range<usize>,
        every: usize,
        around: impl Fn(usize) -> Range<usize>,
    ) -> Vec<bool> {
        let off = self.beside(part, every, around);
        off.iter().map(|off| *off > self.limit).collect()
    }

    /// How far the windows of a part are off it.
    fn beside(
        &self,
        part: &Range<usize>,
        every: usize,
        around: impl Fn(usize) -> Range<usize>,
    ) -> Vec<f64> {
        let means = &self.means[part.clone()];
        let mut level = f64::NAN;
        let mut near = Vec::new();
        let of = |(k, mean): (usize, &f64)| {
            if k % every == 0 {
                let around = around(k);
                let around = around.start..around.end.min(means.len());
                near.clear();
                near.extend(means[around].iter().filter(|x| !x.is_nan()));
                level = match near.is_empty() {
                    true => f64::NAN,
                    false => upper_median(&mut near),
                };
            }
            (mean - level).abs()
        };
        means.iter().enumerate().map(of).collect()
    }

    fn rests(&self, window: usize) -> bool {
        let before = self.means[window.saturating_sub(1)];
        let moves = (self.means[window] - before).abs() > self.limit;
        !(moves || self.deviations[window] > self.quiet)
    }
}

/// Means of windows of a temperature; `None` where it hardly changes.
fn temperature(samples: &[f64], width: usize) -> Option<Vec<f64>> {
    let held = temperature::held(samples).ok()?;
    let means = held.chunks_exact(width);
    let means: Vec<f64> = means
        .map(|window| window.iter().sum::<f64>() / width as f64)
        .collect();
    let least = means.iter().copied().fold(f64::INFINITY, f64::min);
    let most = means.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (most - least >= LEAST_CHANGE_K).then_some(means)
}

/// Mean and standard deviation of a window without its least and its largest sample.
fn trimmed(window: &[f64]) -> (f64, f64) {
    let (mut n, mut sum, mut squares) = (0.0, 0.0, 0.0);
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    let Some(first) = window.iter().copied().find(|x| !x.is_nan()) else {
        return (f64::NAN, f64::NAN);
    };
    for x in window.iter().filter(|x| !x.is_nan()).map(|x| x - first) {
        n += 1.0;
        sum += x;
        squares += x * x;
        least = least.min(x);
        most = most.max(x);
    }
    let n = n - 2.0;
    if n < 2.0 {
        return (f64::NAN, f64::NAN);
    }
    let mean = (sum - least - most) / n;
    let squares: f64 = squares - least * least - most * most - n * mean * mean;
    (first + mean, (squares.max(0.0) / (n - 1.0)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_is_taken_without_its_least_and_its_largest_sample() {
        let of = |window: &[f64]| {
            let (mean, deviation) = trimmed(window);
            [mean, deviation]
        };
        // 1 to 5, and two of four.
        let nan = f64::NAN;
        let [mean, deviation] = of(&[5.0, -1000.0, 1.0, nan, 3.0, 2.0, 9000.0, 4.0]);
        assert!((mean - 3.0).abs() < 1e-12, "{mean}");
        // 9000² is rounded to 10⁻⁸.
        assert!((deviation - 2.5f64.sqrt()).abs() < 1e-7, "{deviation}");
        assert_eq!(of(&[nan, 1.0, 9.0, 3.0, 0.0]), [2.0, 2f64.sqrt()]);
        assert_eq!(of(&[7.0; 20]), [7.0, 0.0]);
        for few in [&[1.0, nan, 2.0, 3.0][..], &[nan; 9], &[]] {
            assert!(of(few).iter().all(|x| x.is_nan()), "{few:?}");
        }
    }
}
