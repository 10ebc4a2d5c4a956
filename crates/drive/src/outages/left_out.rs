//! Which outages can be judged: those that the logs leave something to measure in.

use super::Rejected;
use crate::replay::{Measurement, Outage, STAMP_ROUNDING};
use undrift_base::order_statistics::median;
use undrift_nav::sample::{GnssFix, ImuSample, TruthSample};
pub use undrift_results::findings::WhyLeftOut;

/// A gap of the fixes or references is longer than so many usual intervals …
const INTERVALS: f64 = 2.5;
/// … and than this share of the outage.
const SHARE: f64 = 0.1;
/// Samples further apart than this have a gap between them \[s\].
const NO_SAMPLES: f64 = 1.0;

/// Times \[s\], in order, and their usual interval.
struct Times {
    at: Vec<f64>,
    interval: f64,
}

impl Times {
    fn new(at: Vec<f64>) -> Self {
        let between: Vec<f64> = at.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let interval = match between.as_slice() {
            [] => 0.0,
            between => median(between),
        };
        Self { at, interval }
    }

    /// The last one until `time` \[s\].
    fn last_until(&self, time: f64) -> Option<f64> {
        let count = self.at.partition_point(|t| *t <= time + STAMP_ROUNDING);
        count.checked_sub(1).map(|last| self.at[last])
    }

    /// How long there may be none in an outage \[s\].
    fn patience(&self, cut: &Outage) -> f64 {
        (INTERVALS * self.interval).max(SHARE * (cut.end - cut.start))
    }
}

/// What the logs of a drive have to judge outages by.
pub(super) struct Coverage {
    /// Times of the fixes that are not rejected.
    fixes: Times,
    /// Times of the references.
    references: Times,
    /// First and last time of each stretch of samples without a gap \[s\].
    samples: Vec<(f64, f64)>,
    /// Start time of the run without outages \[s\]; where there is none, no outage is excluded by it.
    started: Option<f64>,
}

impl Coverage {
    pub(super) fn new(
        imu: &[ImuSample],
        aiding: &[Measurement],
        truth: &[TruthSample],
        rejected: &Rejected,
        started: Option<f64>,
    ) -> Self {
        let fixes = aiding.iter().filter_map(|m| match m {
            Measurement::Gnss(fix) => Some(rejected.rest(fix)),
            _ => None,
        });
        let has_any = |fix: &GnssFix| fix.position.is_some() || fix.velocity.is_some();
        let fixes: Vec<GnssFix> = fixes.filter(has_any).collect();
        let references = match truth {
            [] => {
                let positions = fixes.iter().filter(|fix| fix.position.is_some());
                positions.map(|fix| fix.time).collect()
            }
            truth => truth.iter().map(|sample| sample.time).collect(),
        };
        let mut samples: Vec<(f64, f64)> = Vec::new();
        for sample in imu {
            match samples.last_mut() {
                Some((_, last)) if sample.time - *last <= NO_SAMPLES => *last = sample.time,
                _ => samples.push((sample.time, sample.time)),
            }
        }
        Self {
            fixes: Times::new(fixes.iter().map(|fix| fix.time).collect()),
            references: Times::new(references),
            samples,
            started,
        }
    }

    /// Why an outage is left out, if it is.
    pub(super) fn why_left_out(&self, cut: &Outage) -> Option<WhyLeftOut> {
        if self.started.is_some_and(|time| cut.start < time) {
            return Some(WhyLeftOut::NotStarted);
        }
        let has_samples = |(first, last): &(f64, f64)| {
            *first <= cut.start + NO_SAMPLES && *last >= cut.end - NO_SAMPLES
        };
        if !self.samples.iter().any(has_samples) {
            return Some(WhyLeftOut::NoSamples);
        }
        let before = self.fixes.last_until(cut.start);
        if before.is_none_or(|time| cut.start - time > self.fixes.patience(cut)) {
            return Some(WhyLeftOut::InGap);
        }
        let earliest = cut.start.max(cut.end - self.references.patience(cut));
        let last = self.references.last_until(cut.end);
        last.is_none_or(|time| time <= earliest)
            .then_some(WhyLeftOut::NoReference)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn every(step: f64, spans: &[(f64, f64)]) -> Vec<f64> {
        let of = |(from, to): &(f64, f64)| {
            let (from, count) = (*from, ((to - from) / step).round() as usize);
            (0..=count).map(move |k| from + step * k as f64)
        };
        spans.iter().flat_map(of).collect()
    }

    fn cut(start: f64, length: f64) -> Outage {
        Outage {
            start,
            end: start + length,
        }
    }

    /// Fixes every second with a gap from 100 to 130 s, a solution from 20 s, no samples from 200 to 205 s.
    #[test]
    fn an_outage_needs_a_solution_a_fix_before_it_a_reference_at_its_end_and_samples() {
        let fixes = every(1.0, &[(0.0, 100.0), (130.0, 300.0)]);
        let mut coverage = Coverage {
            references: Times::new(fixes.clone()),
            fixes: Times::new(fixes),
            samples: vec![(0.0, 200.0), (205.0, 300.0)],
            started: Some(20.0),
        };
        for (start, why) in [
            (19.0, Some(WhyLeftOut::NotStarted)),
            (20.0, None),
            (60.5, None),
            (90.0, None),
            // Ends in the gap, at its beginning and later.
            (92.0, None),
            (95.0, Some(WhyLeftOut::NoReference)),
            (110.0, Some(WhyLeftOut::InGap)),
            (125.0, Some(WhyLeftOut::InGap)),
            (131.0, None),
            (195.0, Some(WhyLeftOut::NoSamples)),
            (201.0, Some(WhyLeftOut::NoSamples)),
            (206.0, None),
            (290.0, None),
            (292.0, Some(WhyLeftOut::NoSamples)),
        ] {
            assert_eq!(coverage.why_left_out(&cut(start, 10.0)), why, "{start}");
        }
        // A truth goes on through the gap of the fixes.
        coverage.references = Times::new(every(0.5, &[(0.0, 300.0)]));
        assert_eq!(coverage.why_left_out(&cut(95.0, 10.0)), None);
        assert_eq!(
            coverage.why_left_out(&cut(110.0, 10.0)),
            Some(WhyLeftOut::InGap)
        );
        // Of fixes far apart ten seconds are no gap.
        let far = every(30.0, &[(0.0, 300.0)]);
        (coverage.fixes, coverage.references) = (Times::new(far.clone()), Times::new(far));
        assert_eq!(coverage.why_left_out(&cut(100.0, 60.0)), None);
        // Shorter than from fix to fix, and none in it.
        assert_eq!(
            coverage.why_left_out(&cut(65.0, 10.0)),
            Some(WhyLeftOut::NoReference)
        );
    }

    #[test]
    fn what_outages_need_is_taken_from_the_logs() {
        use undrift_nav::{Matrix3, Vector3, earth::Geodetic};
        let sample = |time: f64| ImuSample {
            time,
            dt: 0.5,
            dtheta: Vector3::zeros(),
            dvel: Vector3::zeros(),
        };
        // A second apart is no gap yet.
        let imu = [0.0, 0.5, 1.5, 2.6, 3.0, 4.5].map(sample);
        let place = Geodetic::from_degrees(45.0, 7.0, 0.0);
        let fix = |time: f64| GnssFix::at(time, place, [1.0; 3]);
        let velocity = |time: f64| GnssFix {
            position: None,
            velocity: Some((Vector3::zeros(), Matrix3::identity())),
            ..fix(time)
        };
        let nothing = GnssFix {
            position: None,
            ..fix(9.0)
        };
        let aiding = [fix(0.0), velocity(2.0), fix(3.0), fix(7.0), nothing].map(Measurement::Gnss);
        let rejected = Rejected::default();
        let coverage = Coverage::new(&imu, &aiding, &[], &rejected, Some(2.0));
        assert_eq!(coverage.samples, [(0.0, 1.5), (2.6, 3.0), (4.5, 4.5)]);
        assert_eq!(
            (coverage.fixes.at, coverage.fixes.interval),
            (vec![0.0, 2.0, 3.0, 7.0], 2.0)
        );
        assert_eq!(
            (coverage.references.at, coverage.references.interval),
            (vec![0.0, 3.0, 7.0], 3.5)
        );
        assert_eq!(coverage.started, Some(2.0));
    }

    #[test]
    fn the_last_time_until_another_is_known_to_the_rounding_of_stamps() {
        let times = Times::new(vec![1.0, 2.0, 4.0]);
        for (time, last) in [
            (0.5, None),
            (1.0, Some(1.0)),
            (1.0 - 0.5 * STAMP_ROUNDING, Some(1.0)),
            (1.0 - 2.0 * STAMP_ROUNDING, None),
            (3.9, Some(2.0)),
            (9.0, Some(4.0)),
        ] {
            assert_eq!(times.last_until(time), last, "{time}");
        }
        // Two and a half intervals of 1.5 s, or a tenth of the outage.
        assert_eq!(times.patience(&cut(5.0, 10.0)), 3.75);
        assert_eq!(times.patience(&cut(5.0, 60.0)), 6.0);
        assert_eq!(Times::new(vec![1.0]).interval, 0.0);
    }
}
