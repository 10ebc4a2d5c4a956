//! The pass over the record.

use super::{DriftError, HorizonScore, MAX_BATCHES};
use crate::composite::predictor::{Predictor, dot};
use crate::composite::{CompositeError, Span};
use undrift_nav::shaping::ShapingFilter;

/// A window may miss one in so many samples.
const WHOLE: usize = 100;
/// Windows begin this share of their length apart: what lies between two tells nothing more.
const OVERLAP: usize = 32;
/// Change of the gains below which the filter counts as settled. Their error is that times their memory, at most
/// some thousand samples' worth, and the score's is its square.
const SETTLED: f64 = 1e-7;

pub(super) struct Task<'a> {
    pub(super) record: &'a [f64],
    pub(super) first_part: usize,
    pub(super) mean: f64,
    pub(super) filter: &'a ShapingFilter,
    pub(super) lengths: &'a [usize],
}

#[derive(Clone, Default)]
struct Batch {
    squares: f64,
    count: usize,
}

/// One horizon while the pass runs.
pub(super) struct Horizon<const N: usize> {
    /// Samples.
    length: usize,
    /// H (I + F + … + F^{k−1}).
    row: [f64; N],
    /// Variance of the sum that no past predicts.
    own: f64,
    /// Sum and number missing of the samples ahead.
    ahead: f64,
    missing: usize,
    /// Samples from one origin to the next that is scored.
    apart: usize,
    /// Origins to a batch.
    stride: usize,
    seen: usize,
    origin: usize,
    batch: usize,
    batches: Vec<Batch>,
    predicted: f64,
    /// row P rowᵀ once the filter has settled.
    settled: Option<f64>,
}

impl Task<'_> {
    /// Runs the filter over the record and scores the second part.
    pub(super) fn run<const N: usize>(&self) -> Result<Vec<HorizonScore>, DriftError> {
        let mut predictor = Predictor::<N>::settling(self.filter, SETTLED);
        let value = |y: f64| y - self.mean;
        let (first, second) = self.record.split_at(self.first_part);
        for &y in first {
            take_in(&mut predictor, value(y))?;
        }
        let mut horizons: Vec<Horizon<N>> = self
            .lengths
            .iter()
            .map(|&length| Horizon::new(self.filter, length, second, self.mean))
            .collect();
        for (k, &y) in second.iter().enumerate() {
            for horizon in &mut horizons {
                if k + horizon.length <= second.len() {
                    if k.is_multiple_of(horizon.apart) {
                        horizon.score(&predictor);
                    }
                    horizon.slide(value(y), second.get(k + horizon.length).map(|&v| value(v)));
                }
            }
            take_in(&mut predictor, value(y))?;
        }
        let scores = horizons.iter().map(|h| h.finish(self.filter.interval));
        scores
            .map(|score| score.ok_or(DriftError::NoWindow))
            .collect()
    }
}

fn take_in<const N: usize>(predictor: &mut Predictor<N>, y: f64) -> Result<(), DriftError> {
    if y.is_nan() {
        predictor.skip();
        return Ok(());
    }
    if !(predictor.variance > 0.0 && predictor.variance.is_finite()) {
        return Err(DriftError::Record(CompositeError::NoVariance));
    }
    if !y.is_finite() {
        return Err(DriftError::Record(CompositeError::NotFinite));
    }
    predictor.observe(y);
    Ok(())
}

impl<const N: usize> Horizon<N> {
    fn new(filter: &ShapingFilter, length: usize, second: &[f64], mean: f64) -> Self {
        let span = Span::of(filter, length);
        let origins = second.len() + 1 - length;
        // Batches of two horizons at least.
        let batches = (origins / (2 * length)).clamp(1, MAX_BATCHES);
        let mut horizon = Self {
            length,
            row: std::array::from_fn(|i| span.row[i]),
            own: span.r,
            ahead: 0.0,
            missing: 0,
            apart: (length / OVERLAP).max(1),
            stride: origins.div_ceil(batches),
            seen: 0,
            origin: 0,
            batch: 0,
            batches: vec![Batch::default(); batches],
            predicted: 0.0,
            settled: None,
        };
        for &y in &second[..length] {
            horizon.enter(y - mean, 1.0);
        }
        horizon
    }

    fn enter(&mut self, y: f64, sign: f64) {
        if y.is_nan() {
            if sign > 0.0 {
                self.missing += 1;
            } else {
                self.missing -= 1;
            }
        } else {
            self.ahead += sign * y;
        }
    }

    /// One sample leaves the window ahead, the next one enters.
    fn slide(&mut self, out: f64, into: Option<f64>) {
        self.enter(out, -1.0);
        if let Some(y) = into {
            self.enter(y, 1.0);
        }
        self.origin += 1;
        if self.origin == self.stride {
            self.origin = 0;
            self.batch = (self.batch + 1).min(self.batches.len() - 1);
        }
    }

    fn score(&mut self, predictor: &Predictor<N>) {
        let mut actual = self.ahead;
        if self.missing > 0 {
            if WHOLE * self.missing > self.length {
                return;
            }
            actual *= self.length as f64 / (self.length - self.missing) as f64;
        }
        let error = actual - dot(&self.row, &predictor.x);
        let batch = &mut self.batches[self.batch];
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
        self.predicted += known + self.own;
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
