//! How regular the intervals of a log are.

/// A longer interval than the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Time of the last record before it \[s\].
    pub start: f64,
    /// Time to the next record \[s\].
    pub length: f64,
    /// Line of the first record after it, counted from 1.
    pub line: u64,
}

/// The usual interval of a log, and the gaps: intervals of more than 1.5 usual ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GapSummary {
    /// Running median of the intervals \[s\]; 0 before the first.
    pub nominal_interval: f64,
    /// Number of gaps.
    pub count: u64,
    /// The longest of them.
    pub longest: Option<Gap>,
}

/// Intervals that the first median is taken of.
const START: usize = 101;
/// An interval of more usual ones than this is a gap.
pub(crate) const GAP_INTERVALS: f64 = 1.5;
/// Slowest and first relative step of the running median. Rounded stamps (10 or 11 ms) move it
/// by these steps only.
const STEP_MIN: f64 = 1e-4;

/// Collects intervals; the median of the first ones starts a running median.
#[derive(Default)]
pub struct GapWatch {
    start: Vec<Gap>,
    seen: u64,
    summary: GapSummary,
}

impl GapWatch {
    /// Takes in the next interval.
    #[inline]
    pub fn add(&mut self, interval: Gap) {
        self.seen += 1;
        if self.start.len() < START {
            self.start.push(interval);
            if self.start.len() == START {
                self.summary = of_all(&self.start);
            }
            return;
        }
        self.summary.judge(interval);
        let nominal = self.summary.nominal_interval;
        let off = interval.length - nominal;
        // Differences of stamps are off by rounding, a millionth of the interval at most.
        if off.abs() > 1e-6 * nominal {
            let step = (1.0 / self.seen as f64).max(STEP_MIN);
            self.summary.nominal_interval += off.signum() * (step * nominal).min(off.abs());
        }
    }

    /// The usual interval so far \[s\]. Of few intervals the lower median: gaps only lengthen.
    pub(crate) fn nominal(&self) -> Option<f64> {
        if self.start.len() == START {
            return Some(self.summary.nominal_interval);
        }
        let mut lengths: Vec<f64> = self.start.iter().map(|gap| gap.length).collect();
        lengths.sort_by(f64::total_cmp);
        lengths.get(lengths.len().saturating_sub(1) / 2).copied()
    }

    /// What the intervals so far show.
    pub fn summary(&self) -> GapSummary {
        if self.start.len() < START {
            of_all(&self.start)
        } else {
            self.summary
        }
    }
}

impl GapSummary {
    #[inline]
    fn judge(&mut self, interval: Gap) {
        if interval.length > GAP_INTERVALS * self.nominal_interval {
            self.count += 1;
            if self
                .longest
                .is_none_or(|longest| interval.length > longest.length)
            {
                self.longest = Some(interval);
            }
        }
    }
}

fn of_all(intervals: &[Gap]) -> GapSummary {
    let mut lengths: Vec<f64> = intervals.iter().map(|gap| gap.length).collect();
    lengths.sort_by(f64::total_cmp);
    let mut summary = GapSummary {
        nominal_interval: lengths.get(lengths.len() / 2).copied().unwrap_or(0.0),
        ..GapSummary::default()
    };
    for &interval in intervals {
        summary.judge(interval);
    }
    summary
}

#[cfg(test)]
mod tests {
    use super::*;

    fn watch(intervals: impl IntoIterator<Item = f64>) -> GapSummary {
        let (mut watch, mut time) = (GapWatch::default(), 0.0);
        for (k, length) in intervals.into_iter().enumerate() {
            watch.add(Gap {
                start: time,
                length,
                line: k as u64,
            });
            time += length;
        }
        watch.summary()
    }

    #[test]
    fn rounded_stamps_of_a_95_hz_clock_are_no_gaps() {
        let stamps: Vec<f64> = (0..5000)
            .map(|k| (k as f64 / 95.0 * 1e3).round() / 1e3)
            .collect();
        let summary = watch(stamps.windows(2).map(|w| w[1] - w[0]));
        assert_eq!((summary.count, summary.longest), (0, None));
        // Half of the stamps are 10 and half 11 ms apart: the median is one of them, within its steps.
        assert!(
            (0.0099..0.0112).contains(&summary.nominal_interval),
            "{summary:?}"
        );
    }

    #[test]
    fn gaps_are_counted_early_and_late_and_the_longest_is_kept() {
        let mut intervals = vec![0.01; 1000];
        intervals[3] = 0.02;
        intervals[500] = 0.5;
        intervals[700] = 0.03;
        let summary = watch(intervals);
        assert_eq!(summary.count, 3);
        let longest = summary.longest.unwrap();
        assert_eq!((longest.length, longest.line), (0.5, 500));
        assert!((summary.nominal_interval - 0.01).abs() < 2e-5);
        assert_eq!(watch([0.01, 0.01, 0.1]).count, 1);
        assert_eq!(watch([]), GapSummary::default());
    }

    #[test]
    fn the_median_follows_a_change_of_rate() {
        let intervals = std::iter::repeat_n(0.02, 200).chain(std::iter::repeat_n(0.005, 20_000));
        let nominal = watch(intervals).nominal_interval;
        assert!((nominal - 0.005).abs() < 1e-5, "{nominal}");
    }
}
