//! Parts of a record, and its gaps as missing samples.

use super::Record;
use std::ops::Range;
use undrift_noise::screening::{Timing, timing};

/// Jitter of stamps, in intervals, up to which a long interval means that samples are missing.
const JITTER: f64 = 0.1;

impl Record {
    /// The part of a record at a rate \[Hz\] between two times after its first sample \[s\].
    pub fn within(mut self, span: (f64, f64), rate_hz: f64) -> Self {
        let length = self.length();
        let increase = |timing: &Timing| timing.not_increasing.is_empty();
        let stamps = &self.stamps;
        let (first, stamped) = (stamps.first(), self.timing.as_ref().is_some_and(increase));
        // Beyond either end is the end.
        let at = |time: f64| match first.filter(|_| stamped) {
            // Half a sample before, for rounded stamps.
            Some(first) => stamps.partition_point(|t| t - first < time - 0.5 / rate_hz),
            None => ((time * rate_hz).round() as usize).min(length),
        };
        let part = at(span.0)..at(span.1).max(at(span.0));
        self.cut(&part);
        self.timing = timing(&self.stamps).ok();
        self
    }

    /// Keeps a part of an evenly sampled record alone, in which the samples of `missing` are.
    pub(crate) fn keep(&mut self, part: &Range<usize>, missing: &[Range<usize>]) {
        for samples in &mut self.samples {
            for range in missing {
                samples[range.clone()].fill(f64::NAN);
            }
        }
        self.cut(part);
    }

    /// Cuts off what is before and after a part.
    fn cut(&mut self, part: &Range<usize>) {
        let cut = |values: &mut Vec<f64>| {
            values.truncate(part.end);
            values.drain(..part.start.min(values.len()));
        };
        self.samples.iter_mut().for_each(cut);
        self.temperature.iter_mut().for_each(cut);
        cut(&mut self.stamps);
    }

    /// The record with NaN in the gaps between its stamps, so that its samples are evenly spaced, and without the stamps; unchanged
    /// where these jitter or go back, or more is missing than present.
    pub fn with_gaps(mut self) -> Self {
        let length = self.stamps.len();
        let regular = |timing: &&Timing| {
            let missing: usize = timing.gaps.iter().map(|gap| gap.missing).sum();
            timing.not_increasing.is_empty()
                && timing.jitter_rms_s < JITTER * timing.interval_s
                && (1..=length).contains(&missing)
        };
        let Some(timing) = self.timing.as_ref().filter(regular) else {
            return self;
        };
        let spread = |values: &mut Vec<f64>| {
            let mut all = Vec::new();
            let mut from = 0;
            for gap in &timing.gaps {
                let to = (gap.index + 1).min(values.len());
                all.extend_from_slice(&values[from..to]);
                all.resize(all.len() + gap.missing, f64::NAN);
                from = to;
            }
            all.extend_from_slice(&values[from..]);
            *values = all;
        };
        self.samples.iter_mut().for_each(spread);
        self.temperature.iter_mut().for_each(spread);
        self.stamps = Vec::new();
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_become_missing_samples() {
        let of = |stamps: Vec<f64>| Record {
            samples: vec![stamps.clone()],
            timing: timing(&stamps).ok(),
            stamps,
            ..Record::default()
        };
        let stamps = || (0..100).filter(|k| !(40..43).contains(k) && *k != 70);
        let even = of(stamps().map(|k| f64::from(k) * 0.01).collect()).with_gaps();
        assert_eq!(even.samples[0].len(), 100);
        for (k, x) in even.samples[0].iter().enumerate() {
            let missing = (40..43).contains(&k) || k == 70;
            assert!(
                if missing {
                    x.is_nan()
                } else {
                    *x == k as f64 * 0.01
                },
                "{k}: {x}"
            );
        }
        // A late stamp makes the next interval short: nothing is missing.
        let late = |k| f64::from(k) * 0.01 + if k % 3 == 0 { 0.006 } else { 0.0 };
        assert_eq!(
            of((0..100).map(late).collect()).with_gaps().samples[0].len(),
            100
        );
        // A recording in bursts is no recording with gaps.
        let bursts = |k| f64::from(k) * 0.01 + if k < 50 { 0.0 } else { 10.0 };
        assert_eq!(
            of((0..100).map(bursts).collect()).with_gaps().samples[0].len(),
            100
        );
    }
}
