//! The pass over the record.
//!
//! The filter goes through the record once. At every origin its state gives what the integral over each horizon
//! will be, and the running sums what it is. Origins are a 32nd of a horizon apart: closer ones would share
//! their windows. A window in which samples are missing counts with the mean of the others, up to a third of
//! it.
//!
//! The quantity: with T the interval, the integral of the error over the next k samples is T Σ ε;
//! its prediction is T H (I + F + … + F^{k−1}) x̂, and the score of the horizon the root mean
//! square of the difference, in rad for a gyro, m/s for an accelerometer. White noise alone
//! contributes N √(k T) at any model.
//!
//! O(r³) a sample until the filter has settled; after that, O(r) a sample, up to [`LEAP`] at once, and of what is not
//! scored only as many samples as the state remembers. The running sums take 12 bytes a sample.

use super::leap::{LEAP, Leap, STEP, Step, about, is_finite};
use super::{DriftError, HorizonScore, MAX_BATCHES};
use crate::composite::predictor::{Predictor, dot};
use crate::composite::{CompositeError, Span};
use undrift_nav::shaping::ShapingFilter;

/// A window may miss one in so many samples: what a logger that loses a fifth of them at random leaves of a second.
const WHOLE: usize = 3;
/// Windows begin this share of their length apart: more of them would add no information.
const OVERLAP: usize = 32;
/// Origins of a horizon, about: so many know the score to 0.3 %, though but two overlap.
const MOST_ORIGINS: usize = 200_000;
/// Samples between two looks whether the filter has settled where nothing is scored.
const STRETCH: usize = 1024;
/// Change of the gains over 64 samples below which the filter counts as settled. Their error is that times their
/// memory over 64, at most some hundreds, and the score's is its square.
const SETTLED: f64 = 1e-5;

pub(super) struct Task<'a> {
    /// Both parts; NaN is a missing sample.
    pub(super) record: &'a [f64],
    /// Samples that the filter only runs through.
    pub(super) first_part: usize,
    /// From this one on none of them is missing.
    pub(super) unbroken_from: usize,
    /// Level that is taken off \[unit\].
    pub(super) mean: f64,
    /// The candidate.
    pub(super) filter: &'a ShapingFilter,
    /// Horizons \[samples\].
    pub(super) lengths: &'a [usize],
    /// Of this record about this mean.
    pub(super) sums: &'a RunningSums,
}

/// Sums of a record about its constant, up to each sample.
pub(super) struct RunningSums {
    /// Sum before each sample \[unit\], one more than samples.
    values: Vec<f64>,
    /// Samples missing before each; empty where none is.
    missing: Vec<u32>,
}

impl RunningSums {
    /// Missing samples add nothing; [`Self::over`] corrects for them.
    pub(super) fn new(record: &[f64], mean: f64) -> Self {
        let mut sum = 0.0;
        let mut values = Vec::with_capacity(record.len() + 1);
        values.push(sum);
        values.extend(record.iter().map(|y| {
            sum += if y.is_nan() { 0.0 } else { y - mean };
            sum
        }));
        let mut missing = Vec::new();
        if record.iter().any(|y| y.is_nan()) {
            let mut absent = 0;
            missing.push(absent);
            missing.extend(record.iter().map(|y| {
                absent += u32::from(y.is_nan());
                absent
            }));
        }
        Self { values, missing }
    }

    /// Sum over a window, what is missing at the mean of the rest, and by how many samples' white noise that adds to it;
    /// none where too much is missing.
    fn over(&self, from: usize, length: usize) -> Option<(f64, f64)> {
        let before = |sample: usize| self.missing.get(sample).map_or(0, |before| *before);
        let missing = (before(from + length) - before(from)) as usize;
        let sum = self.values[from + length] - self.values[from];
        // Of n samples the m that are there count n/m times: the variance of white noise is n²/m samples', not n.
        let factor = length as f64 / (length - missing).max(1) as f64;
        (WHOLE * missing <= length).then_some((sum * factor, missing as f64 * factor))
    }
}

/// Squares of the errors of neighbouring origins; the scatter of batches gives the standard error
/// of a score.
#[derive(Clone, Default)]
struct Batch {
    squares: f64,
    count: usize,
}

/// One horizon while the pass runs.
pub(super) struct Horizon<const N: usize> {
    /// Samples to the horizon.
    length: usize,
    /// H (I + F + … + F^{k−1}).
    row: [f64; N],
    /// Variance of the sum that no past predicts, and of a sample's white noise.
    own: f64,
    white: f64,
    /// Samples from one origin to the next.
    apart: usize,
    /// The next origin, and the last.
    next: usize,
    last: usize,
    /// Origins to a batch.
    stride: usize,
    seen: usize,
    batches: Vec<Batch>,
    /// Sum of the variances that the model itself expects \[unit²\].
    predicted: f64,
    /// row P rowᵀ once the filter has settled.
    settled: Option<f64>,
}

impl Task<'_> {
    /// Runs the filter over the record and scores the second part.
    ///
    /// N must be the filter's order. Origins of each horizon begin at the first sample of the
    /// second part.
    ///
    /// # Errors
    /// A sample that is infinite, a model without variance, a horizon without one complete window.
    pub(super) fn run<const N: usize>(&self) -> Result<Vec<HorizonScore>, DriftError> {
        let (first, second) = self.record.split_at(self.first_part);
        let mut run = Run::<N> {
            predictor: Predictor::settling(self.filter, SETTLED),
            mean: self.mean,
            leap: None,
            step: None,
        };
        run.through(first, self.unbroken_from)?;
        let mut horizons: Vec<Horizon<N>> = self
            .lengths
            .iter()
            .map(|&length| Horizon::new(self.filter, length, second.len()))
            .collect();
        let mut at = 0;
        while at < second.len() {
            for horizon in horizons.iter_mut().filter(|h| h.next == at) {
                horizon.score(&run.predictor, self.sums);
            }
            let next = horizons.iter().map(|h| h.next).min();
            let next = next.unwrap_or(usize::MAX).min(second.len());
            run.over(&second[at..next])?;
            at = next;
        }
        let scores = horizons.iter().map(|h| h.finish(self.filter.interval));
        scores
            .map(|score| score.ok_or(DriftError::NoWindow))
            .collect()
    }
}

/// A filter on its way through the record.
struct Run<const N: usize> {
    predictor: Predictor<N>,
    /// Level that is taken off \[unit\].
    mean: f64,
    /// Where the filter has settled.
    leap: Option<Leap<N>>,
    /// Until it has, where it keeps its gains for a while.
    step: Option<Step<N>>,
}

impl<const N: usize> Run<N> {
    /// Goes through what is not scored, none of which is missing from `unbroken_from` on: of a settled filter
    /// only as much as its state remembers.
    fn through(&mut self, samples: &[f64], unbroken_from: usize) -> Result<(), DriftError> {
        let (broken, mut rest) = samples.split_at(unbroken_from.min(samples.len()));
        self.over(broken)?;
        while !self.predictor.settled && !rest.is_empty() {
            let (next, after) = rest.split_at(STRETCH.min(rest.len()));
            self.over(next)?;
            rest = after;
        }
        if self.predictor.settled {
            let leap = self.leap.get_or_insert_with(|| Leap::new(&self.predictor));
            if let Some(memory) = leap.memory(rest.len()) {
                self.predictor.x = [0.0; N];
                rest = &rest[rest.len() - memory..];
            }
        }
        self.over(rest)
    }

    /// Takes in samples, or predicts over missing ones.
    fn over(&mut self, mut samples: &[f64]) -> Result<(), DriftError> {
        while !samples.is_empty() {
            let taken = self.take_in_some(samples);
            if taken == 0 {
                self.take_in(samples[0] - self.mean)?;
            }
            samples = &samples[taken.max(1)..];
        }
        Ok(())
    }

    /// Takes in several samples at once where the gains do not change and no sample is missing; returns how many, or 0.
    fn take_in_some(&mut self, samples: &[f64]) -> usize {
        if self.predictor.settled {
            let count = samples.len().min(LEAP);
            let about = about(&samples[..count], self.mean);
            if !is_finite(&about) {
                return 0;
            }
            let leap = self.leap.get_or_insert_with(|| Leap::new(&self.predictor));
            self.predictor.x = leap.after(&self.predictor.x, &about, count);
            return count;
        }
        let Some(next) = samples.first_chunk::<STEP>() else {
            return 0;
        };
        let about = next.map(|y| y - self.mean);
        if self.predictor.kept() < STEP || !is_finite(&about) {
            return 0;
        }
        let step = self.step.get_or_insert_with(|| Step::new(&self.predictor));
        self.predictor.x = step.after(&self.predictor.x, &about);
        if self.predictor.pass(STEP) {
            self.step = None;
        }
        STEP
    }

    /// Observes a sample, or predicts over a missing one.
    fn take_in(&mut self, y: f64) -> Result<(), DriftError> {
        if y.is_nan() {
            self.predictor.skip();
            (self.leap, self.step) = (None, None);
            return Ok(());
        }
        let variance = self.predictor.variance;
        if !(variance > 0.0 && variance.is_finite()) {
            return Err(DriftError::Record(CompositeError::NoVariance));
        }
        if !y.is_finite() {
            return Err(DriftError::Record(CompositeError::NotFinite));
        }
        let kept = self.predictor.kept();
        self.predictor.observe(y);
        if self.predictor.kept() >= kept {
            self.step = None;
        }
        Ok(())
    }
}

impl<const N: usize> Horizon<N> {
    /// A horizon of `length` samples in a scored part of `scored` samples.
    ///
    /// `scored` must be at least `length`.
    fn new(filter: &ShapingFilter, length: usize, scored: usize) -> Self {
        let span = Span::doubled(filter, length);
        let origins = scored + 1 - length;
        // Batches of two horizons at least.
        let batches = (origins / (2 * length)).clamp(1, MAX_BATCHES);
        Self {
            length,
            row: std::array::from_fn(|i| span.row[i]),
            own: span.r,
            white: filter.r,
            apart: (length / OVERLAP).max(origins / MOST_ORIGINS).max(1),
            next: 0,
            last: scored - length,
            stride: origins.div_ceil(batches),
            seen: 0,
            batches: vec![Batch::default(); batches],
            predicted: 0.0,
            settled: None,
        }
    }

    /// Scores the window at the next origin, before the filter has seen its first sample.
    /// What the model expects is kept beside it: the variance that no past predicts, of missing samples too,
    /// and that of the state.
    fn score(&mut self, predictor: &Predictor<N>, sums: &RunningSums) {
        let origin = self.next;
        self.next = match origin + self.apart {
            next if next <= self.last => next,
            _ => usize::MAX,
        };
        let Some((actual, added)) = sums.over(origin, self.length) else {
            return;
        };
        let error = actual - dot(&self.row, &predictor.x);
        let last = self.batches.len() - 1;
        let batch = &mut self.batches[(origin / self.stride).min(last)];
        batch.squares += error * error;
        batch.count += 1;
        self.seen += 1;
        let known = match self.settled {
            Some(value) if predictor.settled => value,
            _ => {
                let mut sum = 0.0;
                for i in 0..N {
                    sum += self.row[i] * dot(&predictor.p[i], &self.row);
                }
                self.settled = predictor.settled.then_some(sum);
                sum
            }
        };
        self.predicted += known + self.own + added * self.white;
    }

    /// The score, times the interval \[s\]; none without a complete window.
    fn finish(&self, interval: f64) -> Option<HorizonScore> {
        let origins = self.seen as f64;
        let squares: f64 = self.batches.iter().map(|b| b.squares).sum();
        let scale = interval * interval;
        let mean_square = scale * squares / origins;
        if self.seen == 0 || !mean_square.is_finite() {
            return None;
        }
        let mean_of = |batch: &Batch| match batch.count {
            0 => f64::NAN,
            count => scale * batch.squares / count as f64,
        };
        let batches: Vec<f64> = self.batches.iter().map(mean_of).collect();
        let rms = mean_square.sqrt();
        let windows = origins * self.apart as f64 / self.length as f64;
        Some(HorizonScore {
            horizon_s: self.length as f64 * interval,
            rms,
            standard_error: super::standard_error(rms, windows, &batches),
            predicted_rms: (scale * self.predicted / origins).max(0.0).sqrt(),
            origins: self.seen,
            windows,
            batches,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::composite::{CompositeTerms, GaussMarkov};

    fn filter() -> ShapingFilter {
        let process = GaussMarkov {
            sigma: 0.5,
            tau_s: 20.0,
        };
        let terms = CompositeTerms {
            white: 1.0,
            random_walk: 0.1,
            gauss_markov: [process, GaussMarkov::default()],
            ..CompositeTerms::default()
        };
        terms.to_shaping(1.0).unwrap()
    }

    fn run() -> Run<2> {
        Run {
            predictor: Predictor::settling(&filter(), SETTLED),
            mean: 0.25,
            leap: None,
            step: None,
        }
    }

    #[test]
    fn samples_at_once_are_as_many_one_by_one() {
        let mut record: Vec<f64> = (0..5007)
            .map(|k| f64::from(k * k * 37 % 1009) / 500.0 - 1.0)
            .collect();
        record[2500] = f64::NAN;
        let (mut leaps, mut steps) = (run(), run());
        for part in [&record[..2000], &record[2000..2600], &record[2600..]] {
            leaps.over(part).unwrap();
            part.iter().for_each(|y| steps.take_in(y - 0.25).unwrap());
            for (a, b) in leaps.predictor.x.iter().zip(steps.predictor.x) {
                assert!((a - b).abs() < 1e-12, "{a} {b}");
            }
            // A missing sample unsettles it.
            assert_eq!(leaps.leap.is_some(), part.len() != 600);
        }
        // A few at a time are the same, too.
        for part in record[2600..].chunks(7) {
            leaps.over(part).unwrap();
            part.iter().for_each(|y| steps.take_in(y - 0.25).unwrap());
        }
        let (a, b) = (leaps.predictor.x, steps.predictor.x);
        assert!(
            a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12),
            "{a:?} {b:?}"
        );
        record[4990] = f64::INFINITY;
        assert_eq!(
            leaps.over(&record[4900..]),
            Err(DriftError::Record(CompositeError::NotFinite))
        );
    }

    /// What is skipped is forgotten; what comes before a missing sample is not skipped.
    #[test]
    fn a_settled_filter_needs_what_its_state_remembers() {
        let mut record: Vec<f64> = (0..60_000)
            .map(|k| f64::from(k * k % 1009) / 500.0 + f64::from(k % 7919) / 1e3)
            .collect();
        record[3000] = f64::NAN;
        let (mut skipping, mut steps) = (run(), run());
        skipping.through(&record, 3001).unwrap();
        steps.over(&record).unwrap();
        let memory = skipping.leap.as_ref().unwrap().memory(record.len());
        assert!(
            memory.is_some_and(|samples| (64..8192).contains(&samples)),
            "{memory:?}"
        );
        for (a, b) in skipping.predictor.x.iter().zip(steps.predictor.x) {
            assert!((a - b).abs() < 1e-12 * b.abs().max(1.0), "{a} {b}");
        }
        // Without its last samples it is another state.
        steps.over(&[1e3]).unwrap();
        assert!((skipping.predictor.x[0] - steps.predictor.x[0]).abs() > 1e-3);
        // A constant remembers for ever.
        let mut constant = run();
        let filter = ShapingFilter {
            f: std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j && i < 2))),
            q: [[0.0; 6]; 6],
            ..filter()
        };
        constant.predictor = Predictor::settling(&filter, 0.1);
        constant.through(&record, 3001).unwrap();
        assert!(constant.predictor.settled);
        assert_eq!(constant.leap.unwrap().memory(record.len()), None);
    }

    #[test]
    fn windows_are_some_200_000_at_most() {
        let apart = |scored| Horizon::<2>::new(&filter(), 100, scored).apart;
        assert_eq!(
            (
                apart(10_000),
                apart(800_098),
                apart(800_099),
                apart(2_000_099)
            ),
            (3, 3, 4, 10)
        );
    }
}
