//! What the time stamps of a record say: rate, jitter, gaps.
//!
//! Three kinds of logs, since the rate is wrong by up to a factor otherwise:
//!
//! | stamps | rate |
//! |---|---|
//! | near even ones, some intervals long | mean of the intervals that are no gaps |
//! | late at random, so that many intervals look long | slope of a straight line through all stamps |
//! | read in bursts from a sensor's buffer | time of whole bursts over their samples |
//!
//! Stamps are only reported on. Resampling, sorting or filling of gaps is the caller's, with
//! [`Gap::missing`] as the number of samples to fill in. Statistics that need an even rate check
//! [`Timing::even`].

use super::record::{RecordError, check};
use serde::{Deserialize, Serialize};
use undrift_base::order_statistics::upper_median;

/// Intervals longer than so many times the median are gaps.
const GAP: f64 = 1.5;

/// Jitter, as a share of the interval, above which samples do not count as evenly spaced.
const EVEN: f64 = 0.05;

/// A gap in the time stamps of a record.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Gap {
    /// Position of the sample before the gap, from 0.
    pub index: usize,
    /// Stamp of that sample \[s\].
    pub start_s: f64,
    /// Length from that sample to the next \[s\].
    pub length_s: f64,
    /// Number of samples missing, by the median interval.
    pub missing: usize,
}

/// Rate, jitter and gaps of a record's time stamps.
///
/// Stamps that a logger rounds to milliseconds give intervals a jitter of 0.4 ms, √2/√12 of the step, that the samples
/// do not have: the rate is then in the sum of all intervals, not in one of them.
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
    /// Whether there is no gap, every stamp increases and the RMS jitter is below 5 % of the
    /// interval: only then do the statistics of this crate mean what they say.
    pub even: bool,
}

/// Report on the stamps of a record \[s\]. Of samples that are read and stamped in bursts, as of a sensor's buffer, the rate is
/// that of the whole record.
///
/// ```
/// use undrift_noise::screening::timing;
/// // 100 Hz, three samples missing after the fiftieth.
/// let stamps: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(if k < 50 { k } else { k + 3 })).collect();
/// let report = timing(&stamps)?;
/// assert!((report.rate_hz - 100.0).abs() < 1e-6 && !report.even);
/// assert_eq!((report.gaps[0].index, report.gaps[0].missing), (49, 3));
/// # Ok::<(), undrift_noise::screening::RecordError>(())
/// ```
///
/// # Errors
/// Fewer than 3 stamps, one that is not finite, or [`RecordError::Argument`] where they do not increase.
///
/// The median makes the interval robust: up to half of the intervals may be gaps. O(N), with one
/// copy of the intervals.
///
/// A logger that loses every fourth sample has intervals of one and two steps: they are gaps, since
/// the median is one step, and the rate is that of the sensor, not of the log:
///
/// ```
/// use undrift_noise::screening::timing;
/// let stamps: Vec<f64> = (0..400).filter(|k| k % 4 != 3).map(|k| 0.005 * f64::from(k)).collect();
/// let report = timing(&stamps)?;
/// assert!((report.rate_hz - 200.0).abs() < 1e-6);
/// assert_eq!((stamps.len(), report.gaps.len()), (300, 99)); // One sample missing in each.
/// # Ok::<(), undrift_noise::screening::RecordError>(())
/// ```
pub fn timing(stamps_s: &[f64]) -> Result<Timing, RecordError> {
    check(stamps_s, 3)?;
    let intervals: Vec<f64> = stamps_s.windows(2).map(|w| w[1] - w[0]).collect();
    if let Some(found) = in_bursts(stamps_s, &intervals) {
        return Ok(found);
    }
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
    if jitter_rms_s > JITTER * mean
        && gaps.len() as f64 > LONG_ONES * intervals.len() as f64
        && let Some(found) = without_loss(stamps_s, &intervals, interval_s, &not_increasing)
    {
        return Ok(found);
    }
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

/// Jitter, as a share of the interval, and share of intervals that look like gaps, for these to be late samples.
const JITTER: f64 = 0.1;
const LONG_ONES: f64 = 0.01;

/// The report on stamps that are late at random, by which each may be after the next: those that are nowhere further from even
/// ones, over the whole record, than lost samples would make them. `None` where samples are missing.
///
/// The test is the RMS distance of the stamps from the best straight line: with samples lost in the
/// middle it exceeds one step, with late ones it does not.
fn without_loss(
    stamps_s: &[f64],
    intervals: &[f64],
    interval_s: f64,
    not_increasing: &[usize],
) -> Option<Timing> {
    let count = stamps_s.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let mean = stamps_s.iter().sum::<f64>() / count;
    let places = || {
        stamps_s
            .iter()
            .enumerate()
            .map(|(k, t)| (k as f64 - middle, t - mean))
    };
    let (across, along) = places().fold((0.0, 0.0), |(a, b), (k, t)| (a + k * t, b + k * k));
    let step = across / along;
    let squares: f64 = places().map(|(k, t)| (t - step * k).powi(2)).sum();
    if (squares / count).sqrt() > step {
        return None;
    }
    let apart = intervals.iter().map(|v| v - step);
    let squares: f64 = apart.clone().map(|d| d * d).sum();
    Some(Timing {
        interval_s,
        rate_hz: 1.0 / step,
        jitter_rms_s: (squares / intervals.len() as f64).sqrt(),
        jitter_max_s: apart.fold(0.0, |most, d| most.max(d.abs())),
        gaps: Vec::new(),
        not_increasing: not_increasing.to_vec(),
        even: false,
    })
}

/// An interval of so many medians is between bursts, which fill less than this share of the time.
const BETWEEN: f64 = 4.0;
const FILLED: f64 = 0.5;
/// Fewest bursts, and the share of them that is alike within a quarter.
const BURSTS: usize = 10;
const ALIKE: f64 = 0.8;
const NEAR: f64 = 0.25;

/// The report on stamps of samples that come in equal bursts at equal times; `None` of others.
///
/// A burst ends where an interval is four medians or more; the first and the last, which may be
/// incomplete, count neither for the rate nor for gaps.
fn in_bursts(stamps_s: &[f64], intervals: &[f64]) -> Option<Timing> {
    if intervals.iter().any(|v| *v < 0.0) {
        return None;
    }
    let within = upper_median(&mut intervals.to_vec());
    let starts = intervals.iter().enumerate();
    let starts = starts.filter(|(_, v)| **v > BETWEEN * within);
    let starts: Vec<usize> = starts.map(|(k, _)| k + 1).collect();
    if starts.len() < BURSTS {
        return None;
    }
    let bursts = || starts.windows(2).map(|pair| (pair[0], pair[1]));
    let usual = |of: &dyn Fn((usize, usize)) -> f64| {
        let middle = upper_median(&mut bursts().map(of).collect::<Vec<_>>());
        let near = bursts().filter(|pair| (of(*pair) - middle).abs() <= NEAR * middle);
        (near.count() as f64 >= ALIKE * (starts.len() - 1) as f64).then_some(middle)
    };
    let samples = usual(&|(from, to)| (to - from) as f64)?;
    let period = usual(&|(from, to)| stamps_s[to] - stamps_s[from])?;
    if samples < 2.0 || (samples - 1.0) * within > FILLED * period {
        return None;
    }
    let (mut count, mut time, mut gaps) = (0.0, 0.0, Vec::new());
    for (from, to) in bursts() {
        let length_s = stamps_s[to] - stamps_s[from];
        if length_s > GAP * period {
            let missing = ((length_s / period).round() - 1.0).max(1.0) * samples;
            gaps.push(Gap {
                index: to - 1,
                start_s: stamps_s[to - 1],
                length_s,
                missing: missing as usize,
            });
        } else {
            count += (to - from) as f64;
            time += length_s;
        }
    }
    let interval_s = time / count;
    let off = || intervals.iter().map(|v| (v - interval_s).abs());
    let inside = || off().filter(|v| *v <= GAP * period);
    let squares: f64 = inside().map(|v| v * v).sum();
    Some(Timing {
        interval_s,
        rate_hz: 1.0 / interval_s,
        jitter_rms_s: (squares / inside().count().max(1) as f64).sqrt(),
        jitter_max_s: inside().fold(0.0, f64::max),
        gaps,
        not_increasing: Vec::new(),
        even: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_bursts_the_rate_is_that_of_the_whole_record() {
        // A buffer of 16 samples at 200 Hz, read every 80 ms at 5 kHz, or all with the stamp of the reading.
        for apart in [0.0002, 0.0] {
            let stamp = |k: u32| 0.08 * f64::from(k / 16) + apart * f64::from(k % 16);
            let stamps: Vec<f64> = (0..16_000).map(stamp).collect();
            let found = timing(&stamps).unwrap();
            assert!((found.rate_hz / 200.0 - 1.0).abs() < 1e-9, "{found:?}");
            assert!(found.gaps.is_empty() && !found.even);
        }
        // Half a second of 30 that is lost is a gap, and a tenth of the samples lost at random are gaps.
        let lost = |k: &u32| k % 3000 < 2950;
        let stamps: Vec<f64> = (0..60_000)
            .filter(lost)
            .map(|k| 0.01 * f64::from(k))
            .collect();
        let found = timing(&stamps).unwrap();
        assert!((found.rate_hz / 100.0 - 1.0).abs() < 1e-9);
        assert_eq!(found.gaps.len(), 19);
        assert_eq!(found.gaps[0].missing, 50);
    }

    /// Delays of exponential distribution, mean `late` \[s\].
    fn delayed(late: f64, lost: impl Fn(usize) -> bool) -> Vec<f64> {
        let mut state = 5_u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            ((state >> 33) as f64 + 0.5) / 2f64.powi(31)
        };
        let stamps = (0..20_000).map(|k| (k, 0.01 * k as f64 - late * uniform().ln()));
        stamps.filter(|(k, _)| !lost(*k)).map(|(_, t)| t).collect()
    }

    #[test]
    fn late_samples_are_no_lost_ones() {
        let found = timing(&delayed(0.004, |_| false)).unwrap();
        // A mean of 20000 delays of 4 ms at either half: 4e-5 s over 100 s.
        assert!(
            (found.rate_hz / 100.0 - 1.0).abs() < 1e-5,
            "{}",
            found.rate_hz
        );
        assert!(found.gaps.is_empty() && !found.even && !found.not_increasing.is_empty());
        // The difference of two delays has twice their variance.
        assert!((found.jitter_rms_s / (2f64.sqrt() * 0.004) - 1.0).abs() < 0.05);
        // Lost ones are gaps, however late the others are.
        let lost = timing(&delayed(0.002, |k| k * 7919 % 20_011 < 1000)).unwrap();
        assert!(lost.gaps.len() > 500, "{}", lost.gaps.len());
    }

    /// Twenty bursts of five stamps 1 ms apart, every 100 ms, one period of them longer.
    fn bursts(longer: f64) -> Vec<f64> {
        let burst = |k: usize| 0.1 * k as f64 + if k >= 12 { longer } else { 0.0 };
        let of = |k: usize| (0..5).map(move |i| burst(k) + 0.001 * f64::from(i));
        (0..20).flat_map(of).collect()
    }

    #[test]
    fn a_lost_burst_is_a_gap_of_its_samples() {
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
        let whole = timing(&bursts(0.0)).unwrap();
        near(whole.rate_hz, 50.0);
        near(whole.interval_s, 0.02);
        assert!(whole.gaps.is_empty() && whole.not_increasing.is_empty() && !whole.even);
        // Four intervals of 1 ms and one of 96 ms in a burst, against 20 ms; the last burst has four.
        let (within, between) = (0.019f64.powi(2), 0.076f64.powi(2));
        near(
            whole.jitter_rms_s,
            ((80.0 * within + 19.0 * between) / 99.0).sqrt(),
        );
        near(whole.jitter_max_s, 0.076);
        let lost = timing(&bursts(0.2)).unwrap();
        near(lost.rate_hz, 50.0);
        let [gap] = lost.gaps[..] else {
            panic!("{:?}", lost.gaps)
        };
        assert_eq!((gap.index, gap.missing), (59, 10));
        near(gap.length_s, 0.3);
        near(gap.start_s, 1.104);
        // The interval at the gap is no jitter.
        near(
            lost.jitter_rms_s,
            ((80.0 * within + 18.0 * between) / 98.0).sqrt(),
        );
        near(lost.jitter_max_s, 0.076);
        // A period of half as much again is not a gap, a longer one is.
        assert!(timing(&bursts(0.0499)).unwrap().gaps.is_empty());
        assert_eq!(timing(&bursts(0.051)).unwrap().gaps[0].missing, 5);
    }

    #[test]
    fn bursts_are_ten_at_least_alike_and_fill_less_than_half_of_the_time() {
        let of = |stamps: &[f64]| {
            let intervals: Vec<f64> = stamps.windows(2).map(|w| w[1] - w[0]).collect();
            in_bursts(stamps, &intervals).is_some()
        };
        let all = bursts(0.0);
        // The first burst is before the first break: eleven have ten.
        assert!(of(&all[..55]) && !of(&all[..50]));
        let spread = |apart: f64, period: f64| {
            let burst = |k: usize| (0..9).map(move |i| period * k as f64 + apart * f64::from(i));
            (0..20).flat_map(burst).collect::<Vec<f64>>()
        };
        // Eight intervals fill half of sixteen.
        assert!(of(&spread(1.0, 16.1)) && !of(&spread(1.0, 15.9)));
        // Four intervals are between bursts, less is not.
        assert!(of(&spread(0.2, 8.0)));
        // A step back is not a gap.
        let mut back = all.clone();
        back[31] -= 0.002;
        assert!(!of(&back));
        // Four fifths of the bursts have as many samples.
        let uneven = |odd: usize| {
            let burst = |k: usize| {
                let n = if k % 19 < odd { 2 } else { 5 };
                (0..n).map(move |i| 0.1 * k as f64 + 0.001 * f64::from(i))
            };
            (0..20).flat_map(burst).collect::<Vec<f64>>()
        };
        assert!(of(&uneven(4)) && !of(&uneven(5)));
    }
}
