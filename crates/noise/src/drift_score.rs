//! The drift score: how far the integrated signal runs from its prediction (docs/theory.md, section 6).
//!
//! A model identified on the first part of a static record is scored on the rest: at every sample
//! there (for h of more than 32 samples, 32 times in each h) the model's Kalman filter, which has seen all before it, predicts the integral of the next h
//! seconds, `T H (I + F + … + F^{k−1}) x̂`, k = h/T; the score is the RMS of its error, an angle \[rad\]
//! or a velocity [m/s] (the record's unit times seconds). That is what an outage of h seconds leaves.
//!
//! The constant is the mean of the first part, subtracted from all: the model's turn-on. The filter
//! starts exactly (`p0`) at the record's first sample and runs through the first part unscored, so
//! the scored part begins with the state as it would be known. The state of a random walk or a constant gets the
//! variance of the first part on top of `p0`: it is estimated anew, whatever the mean. A model that
//! has neither forgets towards the mean.
//!
//! One pass, O(N), beside the sums of the scored part up to each sample.

mod pass;
mod recommend;

pub use recommend::{Recommendation, Scored, recommend};

use crate::composite::{CompositeError, present_mean};
use undrift_nav::shaping::ShapingFilter;

/// Horizons of docs/theory.md, section 6 \[s\].
pub const HORIZONS_S: [f64; 4] = [1.0, 10.0, 60.0, 300.0];

/// Most batches that the origins are divided into for the sampling error.
pub const MAX_BATCHES: usize = 32;

/// Why there is no score.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DriftError {
    /// The part to be scored holds fewer than two windows of the longest horizon.
    #[error("{seconds} s are too short to score a horizon of {horizon_s} s")]
    TooShort {
        /// Length of the scored part \[s\].
        seconds: f64,
        /// The horizon \[s\].
        horizon_s: f64,
    },
    /// A horizon is shorter than a sample, or not finite; or there is none.
    #[error("every horizon must be at least one sample long")]
    BadHorizon,
    /// Too much is missing: no window is whole.
    #[error("no window of the scored part is complete enough")]
    NoWindow,
    /// The record or the model cannot be filtered.
    #[error(transparent)]
    Record(#[from] CompositeError),
}

/// The score at one horizon.
#[derive(Clone, Debug, PartialEq)]
pub struct HorizonScore {
    /// Horizon h \[s\], rounded to whole samples.
    pub horizon_s: f64,
    /// RMS of the prediction error of the integral over h [unit·s: rad or m/s].
    pub rms: f64,
    /// Standard error of `rms` [unit·s]: the larger of that from the scatter of the batches (which
    /// holds for a wrong model, with errors that stay correlated) and rms/√(2 windows), that of as
    /// many independent ones.
    pub standard_error: f64,
    /// RMS that the model itself expects, from the filter's covariance [unit·s].
    pub predicted_rms: f64,
    /// Origins scored.
    pub origins: usize,
    /// Windows of h that do not overlap.
    pub windows: f64,
    /// Mean squares of successive batches of origins [unit²·s²], each two horizons long or longer:
    /// the same of every model, so that models are compared batch by batch.
    pub batches: Vec<f64>,
}

/// Scores a shaping filter on `record[first_part..]`, the filter identified on `record[..first_part]`,
/// at horizons \[s\] in growing order or any other. NaN is a missing sample; a window counts where at
/// most a hundredth of it is missing, with the mean of the rest in its place.
///
/// # Errors
/// See [`DriftError`].
pub fn score(
    record: &[f64],
    first_part: usize,
    filter: &ShapingFilter,
    horizons_s: &[f64],
) -> Result<Vec<HorizonScore>, DriftError> {
    let first_part = first_part.min(record.len());
    let scored = record.len() - first_part;
    let interval = filter.interval;
    let mut lengths = Vec::with_capacity(horizons_s.len());
    for &horizon_s in horizons_s {
        let samples = (horizon_s / interval).round();
        if !(1.0..1e12).contains(&samples) {
            return Err(DriftError::BadHorizon);
        }
        let samples = samples as usize;
        if samples > scored / 2 {
            return Err(DriftError::TooShort {
                seconds: scored as f64 * interval,
                horizon_s,
            });
        }
        lengths.push(samples);
    }
    if lengths.is_empty() {
        return Err(DriftError::BadHorizon);
    }
    let (mean, present) = present_mean(&record[..first_part])?;
    if present < 3 {
        return Err(DriftError::Record(CompositeError::TooShort {
            present,
            needed: 3,
        }));
    }
    let squares: f64 = record[..first_part]
        .iter()
        .filter(|v| !v.is_nan())
        .map(|v| (v - mean) * (v - mean))
        .sum();
    let started = free_start(filter, squares / present as f64);
    let sums = pass::RunningSums::of(&record[first_part..], mean);
    let task = pass::Task {
        record,
        first_part,
        mean,
        filter: &started,
        lengths: &lengths,
        sums: &sums,
    };
    match filter.order {
        0 => task.run::<0>(),
        1 => task.run::<1>(),
        2 => task.run::<2>(),
        3 => task.run::<3>(),
        4 => task.run::<4>(),
        5 => task.run::<5>(),
        _ => task.run::<6>(),
    }
}

/// Scores of a model on several parts of a record, or on several records, pooled horizon by horizon; the horizons grow,
/// and a part that is too short for the long ones counts for the others.
pub fn pooled(parts: &[Vec<HorizonScore>]) -> Vec<HorizonScore> {
    let horizons = parts.iter().map(Vec::len).max().unwrap_or(0);
    let pool = |h: usize| {
        let long = || parts.iter().filter_map(move |part| part.get(h));
        let of = |value: fn(&HorizonScore) -> f64| long().map(value);
        let origins: usize = long().map(|score| score.origins).sum();
        let mean = |value: fn(&HorizonScore) -> f64| of(value).sum::<f64>() / origins as f64;
        let rms = mean(|s| s.origins as f64 * s.rms * s.rms).sqrt();
        let windows: f64 = of(|s| s.windows).sum();
        let batches: Vec<f64> = long().flat_map(|score| score.batches.clone()).collect();
        HorizonScore {
            horizon_s: of(|s| s.horizon_s).fold(0.0, f64::max),
            rms,
            standard_error: standard_error(rms, windows, &batches),
            predicted_rms: mean(|s| s.origins as f64 * s.predicted_rms * s.predicted_rms).sqrt(),
            origins,
            windows,
            batches,
        }
    };
    (0..horizons).map(pool).collect()
}

/// See [`HorizonScore::standard_error`].
fn standard_error(rms: f64, windows: f64, batches: &[f64]) -> f64 {
    // d rms = d(rms²) / (2 rms)
    let from_batches = match rms > 0.0 {
        true => recommend::standard_error(batches) / (2.0 * rms),
        false => 0.0,
    };
    from_batches.max(rms / (2.0 * windows.max(1.0)).sqrt())
}

/// The filter with `variance` \[unit²\] added to the start of every state that is a random walk or a
/// constant of its own.
fn free_start(filter: &ShapingFilter, variance: f64) -> ShapingFilter {
    let mut started = *filter;
    let n = filter.order;
    for i in 0..n {
        let alone = (0..n).all(|j| {
            let expected = f64::from(i == j);
            filter.f[i][j] == expected && filter.f[j][i] == expected
        });
        if alone && filter.h[i] != 0.0 {
            started.p0[i][i] += variance / (filter.h[i] * filter.h[i]);
        }
    }
    started
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pooled_scores_weigh_by_origins() {
        let part = |rms: f64, origins: usize| {
            vec![HorizonScore {
                horizon_s: 1.0,
                rms,
                standard_error: 0.1,
                predicted_rms: 2.0 * rms,
                origins,
                windows: origins as f64 / 10.0,
                batches: vec![rms * rms; 4],
            }]
        };
        let pooled = &pooled(&[part(1.0, 300), part(3.0, 100)])[0];
        // (300 · 1 + 100 · 9) / 400.
        assert!((pooled.rms - 3f64.sqrt()).abs() < 1e-12);
        assert!((pooled.predicted_rms - 12f64.sqrt()).abs() < 1e-12);
        assert_eq!((pooled.origins, pooled.windows), (400, 40.0));
        // Eight batches of 1 and 9: their scatter is above that of forty independent windows.
        let from_batches = (128.0 / 56.0f64).sqrt() / (2.0 * 3f64.sqrt());
        assert!((pooled.standard_error - from_batches).abs() < 1e-12);
    }
}
