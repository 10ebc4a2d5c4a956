//! What the time stamps of a record say: rate, jitter, gaps.

use super::record::{RecordError, check};
use crate::order_statistics::upper_median;
use serde::{Deserialize, Serialize};

/// Intervals longer than so many times the median are gaps.
const GAP: f64 = 1.5;

/// Jitter, as a share of the interval, above which samples do not count as evenly spaced.
const EVEN: f64 = 0.05;

/// A gap in a record.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Gap {
    /// Sample before the gap, from 0.
    pub index: usize,
    /// Stamp of that sample \[s\].
    pub start_s: f64,
    /// Length from that sample to the next \[s\].
    pub length_s: f64,
    /// Samples missing, by the median interval.
    pub missing: usize,
}

/// Report on time stamps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Timing {
    /// Median interval \[s\].
    pub interval_s: f64,
    /// Mean rate outside the gaps \[Hz\]: the one to use. The median interval of rounded stamps is not
    /// as exact.
    pub rate_hz: f64,
    /// RMS of the intervals outside the gaps about their mean \[s\].
    pub jitter_rms_s: f64,
    /// Largest deviation of such an interval from their mean \[s\].
    pub jitter_max_s: f64,
    /// Intervals longer than 1.5 times the median.
    pub gaps: Vec<Gap>,
    /// Positions (of the later sample) where a stamp repeats the one before or goes back.
    pub not_increasing: Vec<usize>,
    /// True where there is no gap, every stamp increases and the RMS jitter is below 5 % of the
    /// interval: only then do the statistics of this crate mean what they say.
    pub even: bool,
}

/// Report on the stamps of a record \[s\].
///
/// # Errors
/// Fewer than 3 stamps, one that is not finite, or [`RecordError::Argument`] where they do not increase.
pub fn timing(stamps_s: &[f64]) -> Result<Timing, RecordError> {
    check(stamps_s, 3)?;
    let intervals: Vec<f64> = stamps_s.windows(2).map(|w| w[1] - w[0]).collect();
    let mut positive: Vec<f64> = intervals.iter().copied().filter(|v| *v > 0.0).collect();
    if 2 * positive.len() < intervals.len() {
        return Err(RecordError::Argument("the time stamps do not increase"));
    }
    let interval_s = upper_median(&mut positive);
    let (mut gaps, mut not_increasing, mut count, mut sum) = (Vec::new(), Vec::new(), 0.0, 0.0);
    let regular = |v: f64| v > 0.0 && v <= GAP * interval_s;
    for (index, &length_s) in intervals.iter().enumerate() {
        if length_s <= 0.0 {
            not_increasing.push(index + 1);
        } else if regular(length_s) {
            count += 1.0;
            sum += length_s;
        } else {
            let missing = ((length_s / interval_s).round() - 1.0).max(1.0) as usize;
            gaps.push(Gap {
                index,
                start_s: stamps_s[index],
                length_s,
                missing,
            });
        }
    }
    let mean = sum / count;
    let (mut squares, mut jitter_max_s) = (0.0, 0.0f64);
    for &length in intervals.iter().filter(|v| regular(**v)) {
        squares += (length - mean) * (length - mean);
        jitter_max_s = jitter_max_s.max((length - mean).abs());
    }
    let jitter_rms_s = (squares / count).sqrt();
    let even = gaps.is_empty() && not_increasing.is_empty() && jitter_rms_s < EVEN * mean;
    Ok(Timing {
        interval_s,
        rate_hz: 1.0 / mean,
        jitter_rms_s,
        jitter_max_s,
        gaps,
        not_increasing,
        even,
    })
}
