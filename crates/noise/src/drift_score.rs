//! The drift score: how far the integrated signal runs from its prediction (docs/theory.md, section 6).
//!
//! A model identified on the first part of a static record is scored on the rest: at every sample
//! there (for h of more than 32 samples, 32 times in each h; some 200 000 times in all at most) the model's Kalman filter, which has seen all before it, predicts the integral of the next h
//! seconds, `T H (I + F + … + F^{k−1}) x̂`, k = h/T; the score is the RMS of its error, an angle \[rad\]
//! or a velocity [m/s] (the record's unit times seconds). That is what an outage of h seconds leaves.
//!
//! The constant is the mean of the first part, subtracted from all: the model's turn-on. The filter
//! starts exactly (`p0`) at the record's first sample and runs through the first part unscored, so
//! the scored part begins with the state as it would be known. The state of a random walk or a constant gets the
//! variance of the first part on top of `p0`: it is estimated again, whatever the mean. A model that
//! has neither forgets towards the mean.
//!
//! One pass, O(N), beside the sums of the scored part up to each sample.
//!
//! ```
//! use undrift_nav::shaping::ShapingFilter;
//! use undrift_noise::{drift_score::score, synthesis::NoiseGenerator};
//! // White noise N = 1e-3 rad/√s integrates to an angle of N √h after h seconds: 3.2e-3 rad after 10 s.
//! let white = ShapingFilter::white(1e-3, 0.01)?;
//! let record: Vec<f64> = NoiseGenerator::new(&white, 1).take(100_000).collect();
//! let scores = score(&record, 50_000, &white, &[10.0])?;
//! assert!((scores[0].predicted_rms - 1e-3 * 10f64.sqrt()).abs() < 1e-6);
//! assert!((scores[0].rms - scores[0].predicted_rms).abs() < 4.0 * scores[0].standard_error);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod leap;
mod pass;
mod recommend;

pub(crate) use recommend::EQUAL_AIC;
pub use recommend::{Choice, Reason, Recommendation, Scored, recommend};

use crate::composite::CompositeError;
use crate::terms::present_mean;
use undrift_nav::shaping::ShapingFilter;

/// Horizons that models are scored at by default \[s\]: docs/theory.md, section 6.
pub const HORIZONS_S: [f64; 4] = [1.0, 10.0, 60.0, 300.0];

/// Largest number of batches that the origins are divided into for the sampling error.
pub const MAX_BATCHES: usize = 32;

/// Why there is no score.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::drift_score::{DriftError, score};
/// let white = ShapingFilter::white(1e-3, 0.1)?;
/// let record = vec![0.0; 1000]; // 50 s to be scored, at 10 Hz.
/// assert!(matches!(score(&record, 500, &white, &[60.0]), Err(DriftError::TooShort { horizon_s: 60.0, .. })));
/// assert_eq!(score(&record, 500, &white, &[]), Err(DriftError::BadHorizon));
/// # Ok::<(), undrift_nav::shaping::ShapingError>(())
/// ```
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

/// Drift score of a model at one horizon.
///
/// A model is right where `rms` is `predicted_rms` within a few standard errors at every horizon. `rms` above
/// it: an outage will drift farther than the filter says. Below: the filter is too cautious, and fixes after an
/// outage pull harder than they should.
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
    /// Number of origins scored; windows overlap.
    pub origins: usize,
    /// Number of windows of h that do not overlap: that many are independent at most.
    pub windows: f64,
    /// Mean squares of successive batches of origins [unit²·s²], each two horizons long or longer:
    /// the same of every model, so that models are compared batch by batch.
    pub batches: Vec<f64>,
}

/// Scores a shaping filter on `record[first_part..]`, the filter identified on `record[..first_part]`,
/// at the horizons `horizons_s` \[s\] in any order. The record \[unit\] has the interval of the filter. NaN is a missing sample; a window
/// counts where at most a third of it is missing, with the mean of the rest in its place and the white noise that this adds in what is
/// predicted.
///
/// # Errors
/// See [`DriftError`].
pub fn score(
    record: &[f64],
    first_part: usize,
    filter: &ShapingFilter,
    horizons_s: &[f64],
) -> Result<Vec<HorizonScore>, DriftError> {
    let scored = record.len().saturating_sub(first_part);
    lengths(horizons_s, scored, filter.interval)?;
    Parts::new(record, first_part)?.score(filter, horizons_s)
}

/// Horizons \[s\] in samples, which fit twice into those that are scored.
fn lengths(horizons_s: &[f64], scored: usize, interval: f64) -> Result<Vec<usize>, DriftError> {
    let length = |&horizon_s: &f64| {
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
        Ok(samples)
    };
    match horizons_s.is_empty() {
        true => Err(DriftError::BadHorizon),
        false => horizons_s.iter().map(length).collect(),
    }
}

/// A record whose second part filters are scored on, with what the scores of all of them need.
pub(crate) struct Parts<'a> {
    /// Both parts; NaN is a missing sample.
    pub(crate) record: &'a [f64],
    /// Samples of the first, and from which of them on none is missing.
    pub(crate) first_part: usize,
    unbroken_from: usize,
    /// Mean \[unit\] and variance \[unit²\] of the first.
    mean: f64,
    variance: f64,
    /// Of the second about that mean.
    sums: pass::RunningSums,
}

impl<'a> Parts<'a> {
    /// # Errors
    /// Fewer than three samples in the first part; an infinite one.
    pub(crate) fn new(record: &'a [f64], first_part: usize) -> Result<Self, DriftError> {
        let first_part = first_part.min(record.len());
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
        let last_missing = record[..first_part].iter().rposition(|v| v.is_nan());
        Ok(Self {
            record,
            first_part,
            unbroken_from: last_missing.map_or(0, |at| at + 1),
            mean,
            variance: squares / present as f64,
            sums: pass::RunningSums::new(&record[first_part..], mean),
        })
    }

    /// Does [`score`] of this record.
    ///
    /// # Errors
    /// See [`DriftError`].
    pub(crate) fn score(
        &self,
        filter: &ShapingFilter,
        horizons_s: &[f64],
    ) -> Result<Vec<HorizonScore>, DriftError> {
        let scored = self.record.len() - self.first_part;
        let lengths = lengths(horizons_s, scored, filter.interval)?;
        let started = free_start(filter, self.variance);
        let task = pass::Task {
            record: self.record,
            first_part: self.first_part,
            unbroken_from: self.unbroken_from,
            mean: self.mean,
            filter: &started,
            lengths: &lengths,
            sums: &self.sums,
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
}

/// Scores of a model on several parts of a record, or on several records, pooled horizon by horizon: mean squares weighted by
/// their origins. The horizons grow, and a part that is too short for the long ones counts for the others.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{drift_score::{pooled, score}, synthesis::NoiseGenerator};
/// let white = ShapingFilter::white(1e-3, 0.01)?;
/// let scores = |seed| {
///     let record: Vec<f64> = NoiseGenerator::new(&white, seed).take(20_000).collect();
///     score(&record, 10_000, &white, &[1.0])
/// };
/// let both = pooled(&[scores(1)?, scores(2)?]);
/// assert_eq!(both[0].origins, 2 * scores(1)?[0].origins);
/// assert!(both[0].standard_error < scores(1)?[0].standard_error * 1.2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn pooled(parts: &[Vec<HorizonScore>]) -> Vec<HorizonScore> {
    let horizons = parts.iter().map(Vec::len).max().unwrap_or(0);
    let pool = |h: usize| {
        let long = || parts.iter().filter_map(move |part| part.get(h));
        let values = |value: fn(&HorizonScore) -> f64| long().map(value);
        let origins: usize = long().map(|score| score.origins).sum();
        let mean = |value: fn(&HorizonScore) -> f64| values(value).sum::<f64>() / origins as f64;
        let rms = mean(|s| s.origins as f64 * s.rms * s.rms).sqrt();
        let windows: f64 = values(|s| s.windows).sum();
        let batches: Vec<f64> = long().flat_map(|score| score.batches.clone()).collect();
        HorizonScore {
            horizon_s: values(|s| s.horizon_s).fold(0.0, f64::max),
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

/// Standard error of a score, as [`HorizonScore::standard_error`] says.
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

    #[test]
    fn a_standard_error_is_that_of_the_batches_or_of_as_many_windows() {
        // Mean squares 1, 2, 3: the error of their mean is √(2/(3·2)); of the root half of that over it.
        let found = standard_error(2.0, 1000.0, &[1.0, 2.0, 3.0]);
        assert!((found - (1.0 / 3.0f64).sqrt() / 4.0).abs() < 1e-12);
        assert_eq!(standard_error(3.0, 18.0, &[9.0, 9.0]), 0.5);
        assert_eq!(standard_error(3.0, 0.2, &[9.0]), 3.0 / 2f64.sqrt());
        assert_eq!(standard_error(0.0, 4.0, &[0.0, 1.0]), 0.0);
    }

    #[test]
    fn walks_and_constants_of_their_own_start_as_uncertain_as_the_first_part() {
        let walk = crate::composite::CompositeTerms {
            white: 0.1,
            random_walk: 0.2,
            gauss_markov: [
                crate::composite::GaussMarkov {
                    sigma: 0.3,
                    tau_s: 5.0,
                },
                Default::default(),
            ],
            ..Default::default()
        };
        let mut filter = walk.to_shaping(0.5).unwrap();
        let is_walk = |i: usize| filter.f[i][i] == 1.0;
        let at = (0..filter.order).find(|i| is_walk(*i)).unwrap();
        assert_eq!((0..filter.order).filter(|i| is_walk(*i)).count(), 1);
        filter.h[at] = 2.0;
        let started = free_start(&filter, 12.0);
        for i in 0..filter.order {
            for j in 0..filter.order {
                // The state is half of what it adds to a sample.
                let more = if i == at && j == at { 3.0 } else { 0.0 };
                assert_eq!(started.p0[i][j], filter.p0[i][j] + more);
            }
        }
        // One that drives another, or is not seen, is not independent.
        let other = (at + 1) % filter.order;
        let mut driving = filter;
        driving.f[other][at] = 0.1;
        assert_eq!(free_start(&driving, 12.0).p0, filter.p0);
        let mut driven = filter;
        driven.f[at][other] = 0.1;
        assert_eq!(free_start(&driven, 12.0).p0, filter.p0);
        filter.h[at] = 0.0;
        assert_eq!(free_start(&filter, 12.0).p0, filter.p0);
    }

    #[test]
    fn without_a_state_the_score_is_the_integral_about_the_first_parts_mean() {
        let white = crate::composite::CompositeTerms {
            white: 0.1,
            ..Default::default()
        };
        let filter = white.to_shaping(0.5).unwrap();
        let mut record: Vec<f64> = (0..40).map(|k| f64::from(k * k * 37 % 17)).collect();
        let mean = record[..20].iter().sum::<f64>() / 20.0;
        let found = &score(&record, 20, &filter, &[2.0]).unwrap()[0];
        let error = |origin: usize| {
            let sum: f64 = record[20 + origin..24 + origin]
                .iter()
                .map(|y| y - mean)
                .sum();
            (0.5 * sum).powi(2)
        };
        // Origins 0 to 16, in two batches of eight samples at least.
        let mean_of =
            |of: std::ops::Range<usize>| of.clone().map(error).sum::<f64>() / of.len() as f64;
        assert_eq!(
            (found.horizon_s, found.origins, found.windows),
            (2.0, 17, 17.0 / 4.0)
        );
        assert!((found.rms - mean_of(0..17).sqrt()).abs() < 1e-12);
        assert_eq!(found.batches.len(), 2);
        for (batch, exact) in found.batches.iter().zip([mean_of(0..9), mean_of(9..17)]) {
            assert!((batch - exact).abs() < 1e-9);
        }
        // Four samples of N²/T, times T.
        assert!((found.predicted_rms - 0.5 * (4.0 * 0.01 / 0.5f64).sqrt()).abs() < 1e-12);
        // A window may miss a third of its samples: one of four, not the two that three windows have.
        record[30] = f64::NAN;
        assert_eq!(score(&record, 20, &filter, &[2.0]).unwrap()[0].origins, 17);
        record[31] = f64::NAN;
        assert_eq!(score(&record, 20, &filter, &[2.0]).unwrap()[0].origins, 14);
        let long = score(&record, 20, &filter, &[5.0]).unwrap();
        assert_eq!(long[0].horizon_s, 5.0);
        let too_long = Err(DriftError::TooShort {
            seconds: 10.0,
            horizon_s: 5.5,
        });
        assert_eq!(score(&record, 20, &filter, &[5.5]), too_long);
        for bad in [&[][..], &[0.2], &[f64::NAN], &[1e13]] {
            assert_eq!(
                score(&record, 20, &filter, bad),
                Err(DriftError::BadHorizon)
            );
        }
    }

    /// White noise r over a process: the sum of the next k has the variance (1 + φ + … )² P of what is known, what drives the
    /// state on the way, and k r.
    #[test]
    fn what_is_expected_follows_the_filter_through_a_gap() {
        let (interval, k) = (0.5, 6);
        let terms = crate::composite::CompositeTerms {
            white: 0.5,
            gauss_markov: [
                crate::composite::GaussMarkov {
                    sigma: 1.0,
                    tau_s: 4.0,
                },
                Default::default(),
            ],
            ..Default::default()
        };
        let filter = terms.to_shaping(interval).unwrap();
        let mut record: Vec<f64> = (0..1200)
            .map(|k| f64::from(k * k * 37 % 17) / 8.0 - 1.0)
            .collect();
        record[900..940].fill(f64::NAN);
        record[1010] = f64::NAN;
        let found = &score(&record, 600, &filter, &[k as f64 * interval]).unwrap()[0];
        let phi = (-interval / 4.0f64).exp();
        let (q, r) = (1.0 - phi * phi, 0.25 / interval);
        let sum = |n: usize| (0..n).map(|i| phi.powi(i as i32)).sum::<f64>();
        let own: f64 = (1..k).map(|n| q * sum(n).powi(2)).sum::<f64>() + k as f64 * r;
        let (mut p, mut expected, mut origins) = (1.0, 0.0, 0);
        for (at, y) in record.iter().enumerate() {
            if (600..=1200 - k).contains(&at) {
                let missing = record[at..at + k].iter().filter(|y| y.is_nan()).count();
                if 3 * missing <= k {
                    // The rest counts for what is missing: k²/m samples' white noise.
                    let m = (k - missing) as f64;
                    expected += sum(k).powi(2) * p + own + r * missing as f64 * k as f64 / m;
                    origins += 1;
                }
            }
            let known = if y.is_nan() { p } else { p * r / (p + r) };
            p = phi * phi * known + q;
        }
        assert_eq!(found.origins, origins);
        let expected = interval * (expected / f64::from(origins as u32)).sqrt();
        // Settled gains are off by 1e-5.
        assert!(
            (found.predicted_rms / expected - 1.0).abs() < 1e-5,
            "{} {expected}",
            found.predicted_rms
        );
    }

    #[test]
    fn origins_of_a_long_horizon_are_a_thirty_second_of_it_apart() {
        let filter = ShapingFilter::white(0.1, 1.0).unwrap();
        let record: Vec<f64> = (0..1000).map(|k| f64::from(k * k * 37 % 17)).collect();
        for (length, apart) in [(31, 1), (63, 1), (64, 2), (100, 3)] {
            let found = &score(&record, 400, &filter, &[f64::from(length)]).unwrap()[0];
            let last = 600 - length as usize;
            assert_eq!(found.origins, last / apart + 1, "{length}");
            let windows = found.origins as f64 * apart as f64 / f64::from(length);
            assert!((found.windows - windows).abs() < 1e-12);
            assert_eq!(
                found.batches.len(),
                ((last + 1) / (2 * length as usize)).max(1)
            );
        }
    }
}
