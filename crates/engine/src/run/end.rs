//! The end of the log: what is concluded from all of it.
//!
//! Findings that need the whole log are made here: what cannot be of one vehicle, signs of velocities, repeated
//! fixes, parameters whose estimates are more than five prior standard deviations from what is configured. A
//! run that never aligned ends as [`NotAligned`], with the spans of both logs and the likeliest reason why they
//! do not overlap.
//!
//! Order matters: findings of the watches first, since they hold with and without a solution; then
//! the reason why there was no alignment; then the statistics of the solution that is left. The run
//! is consumed: nothing can be pushed after it.

use super::Run;
use crate::{
    align::{Stamps, compare},
    estimator::Estimator,
    fixes::{FixStudy, FixWatch},
    health::covariance_health,
    not_aligned::NotAligned,
    observer::Observer,
    solution::Solution,
    summary::{LateSamples, Summary, velocity_offset},
    vibration::Vibration,
};
use alloc::boxed::Box;
use undrift_events::Mismatch;
use undrift_nav::parameters::Parameter;

impl Run {
    /// The end; `later` are the stamps of measurements that were never taken in.
    ///
    /// | outcome | result |
    /// |---|---|
    /// | never aligned, no restart | [`NotAligned`]: the failure, both logs' spans, what is implausible |
    /// | a solution at the end | summary with parameters, covariance health, gaps without fixes |
    /// | diverged without gating, or lost and not found again | summary whose `diverged` is the time \[s\] |
    ///
    /// Estimates of parameters are corrections to what is configured [their unit], one entry for
    /// each that is estimated, with standard deviations; those beyond [`crate::watch::FAR`] prior
    /// standard deviations are listed in `far` besides, errors of fixes excepted.
    pub(crate) fn end(
        mut self,
        later: impl Iterator<Item = f64>,
        observer: &mut dyn Observer,
    ) -> Result<Summary, Box<NotAligned>> {
        self.summary.implausible = self.plausible.findings();
        self.summary.mismatches = self.plausible.mismatches();
        self.summary.judge_signs();
        self.summary.repeated = self.queue.repeated();
        self.summary.study = self
            .fixes
            .as_ref()
            .and_then(FixWatch::study)
            .map(|study| FixStudy {
                repeated: self.summary.repeated,
                ..study
            });
        self.summary.louder = self.vibration.as_ref().and_then(Vibration::louder);
        self.summary.no_mounting = self.search.as_ref().and_then(|search| search.failure());
        if self.has_ended() {
            return Ok(self.summary);
        }
        if self.solution.is_none() && self.summary.restarts.is_empty() {
            let mut fixes = self.log.stamps;
            for time in self.queue.fixes().chain(later) {
                fixes = Some(Stamps::and(fixes, time));
            }
            let samples = self.log.first_sample.map(|first| Stamps {
                first,
                last: self.summary.ended,
                count: self.summary.align_samples,
            });
            return Err(Box::new(NotAligned {
                failure: self.alignment.aligner.failure(self.log.fixes),
                times: samples.zip(fixes).map(|(imu, gnss)| {
                    let fault = compare(&imu, &gnss);
                    ([imu, gnss], fault)
                }),
                implausible: self.summary.implausible,
            }));
        }
        if let Some(solution) = &mut self.solution {
            solution.node(self.settings.nodes, observer);
        }
        if let Some(last) = self.log.last_fix {
            self.summary.without_gnss(last, self.summary.ended);
        }
        if self.search.is_none() && self.settings.constraints.non_holonomic.is_none() {
            let aside = self.forward.finding();
            self.summary.mismatches.extend(aside);
        }
        let nods = self.rocking.most().map(Mismatch::Nods);
        self.summary.mismatches.extend(nods);
        self.streak.judge(&mut self.summary);
        self.receiver.close(&mut self.summary);
        self.headings.close(&mut self.summary);
        self.compass.close(&mut self.summary);
        let Some(Solution { filter, .. }) = &self.solution else {
            self.summary.diverged = self.summary.restarts.last().map(|last| last.time);
            return Ok(self.summary);
        };
        let summary = &mut self.summary;
        let Summary {
            mismatches,
            late_samples,
            ..
        } = summary;
        mismatches.retain_mut(|of| !is_estimated(of, &**filter, late_samples));
        self.summary.covariance = Some(covariance_health(&**filter));
        for (kind, _, prior) in filter.parameters().blocks() {
            if let Some((value, std)) = filter.parameter(kind) {
                let n = kind.width();
                let (mut value, mut std) = (value, std);
                let of_time = [Parameter::TimeOffset, Parameter::VelocityTimeOffset];
                if let Some(now) = filter.time_offset(kind).filter(|_| of_time.contains(&kind)) {
                    (value[0], std[0]) = now;
                }
                let furthest = value[..n]
                    .iter()
                    .copied()
                    .max_by(|a, b| a.abs().total_cmp(&b.abs()));
                let far = furthest.filter(|value| value.abs() > crate::watch::FAR * prior.std);
                let of_fixes = [Parameter::PositionError, Parameter::VelocityError];
                let far = far.filter(|_| !of_fixes.contains(&kind));
                self.summary
                    .far
                    .extend(far.map(|value| (kind, value, value.abs() / prior.std)));
                let (value, std) = (value[..n].to_vec(), std[..n].to_vec());
                self.summary.parameters.push((kind, value, std));
            }
        }
        Ok(self.summary)
    }
}

/// A delay of velocities is no mismatch where the filter has it to this \[s\] or three standard deviations.
const SAME_DELAY: f64 = 0.05;

/// Whether it is a delay that the filter knows; if not, what that does to positions is noted in it.
fn is_estimated(of: &mut Mismatch, filter: &dyn Estimator, moved: &LateSamples) -> bool {
    let Mismatch::LateVelocities { delay, beyond } = of else {
        return false;
    };
    *beyond = moved.beyond(moved.unknown(*delay));
    velocity_offset(filter)
        .is_some_and(|(offset, std)| (*delay + offset).abs() < SAME_DELAY.max(3.0 * std))
}
