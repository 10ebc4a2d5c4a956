//! What a navigated drive shows of its logs and its solution.

use super::{Clock, NavigateError, Report};
use crate::{
    findings::{self, Finding, Log, NoError},
    fixes::LONGEST_CORRELATION,
    mounting::EstimateError,
    replay::{Part, ReplayError},
};

impl Report {
    /// Findings on the logs and the solution: its end first, causes before symptoms. Sentences of them are made by `undrift_report`.
    pub fn findings(&self) -> Vec<Finding> {
        let s = &self.summary;
        let mut found = Vec::new();
        found.extend(s.diverged.map(|time| Finding::Diverged { time }));
        found.extend(self.not_compared());
        found.extend(self.covers_part());
        found.extend(self.guessed_rate.map(|rate| Finding::GuessedRate { rate }));
        found.extend(self.pose_faults.iter().cloned());
        if let Some(study) = &self.study {
            found.extend(findings::of_fixes(study, &self.fix_errors));
        }
        found.extend(findings::of_health(s));
        found.extend(findings::of_axes(&self.axis_faults, &self.rotation));
        let interval = self.study.as_ref().map_or(0.0, |study| study.interval);
        let samples = s.samples + s.align_samples;
        let logs = [
            (
                Log::Imu,
                &self.imu_skipped,
                self.gaps.nominal_interval,
                samples,
            ),
            (Log::Gnss, &self.gnss_skipped, interval, s.fixes),
        ];
        found.extend(
            logs.into_iter()
                .flat_map(|(log, skipped, interval, accepted)| {
                    findings::of_order(log, skipped, interval, accepted)
                }),
        );
        found.extend(findings::of_temperature(self.thermal));
        let mut disagreements = findings::of_disagreement(s);
        if self.clock != Clock::Unstated {
            disagreements.retain(|of| !matches!(of, Finding::LateSamples { .. }));
        }
        found.extend(findings::with_axes(disagreements, &self.rotation));
        for read in &self.sensors {
            let used = &s.innovations[read.aid];
            found.extend(findings::of_sensor(read, used));
        }
        // With a wrong unit or axis the innovations say nothing about the accuracy.
        if s.implausible.is_empty() {
            let parts = [Part::Position, Part::Velocity].into_iter();
            let errors = &self.fix_errors;
            found.extend(parts.zip(self.std_factors).filter_map(|(part, factor)| {
                let lasting = match part {
                    Part::Position => errors.correlated,
                    Part::Velocity => errors.velocity_correlated,
                };
                // What lasts of an error is in what is stated, and was seen to be as large; the innovations have
                // only the rest.
                let seen = lasting.is_some_and(|lasting| lasting.time < LONGEST_CORRELATION);
                let factor = factor.filter(|factor| *factor > 1.0 || !seen)?;
                let found = findings::of_accuracy(part, factor, s, errors.known);
                Some(findings::of_rate(found, 1.0 / self.gaps.nominal_interval))
            }));
            let said = |of: &Finding| matches!(of, Finding::OptimisticModel { .. });
            if !found.iter().any(said) {
                found.extend(findings::of_correlation(s));
            }
        }
        found.extend(findings::of_skipped(&[
            (Log::Imu, &self.imu_skipped),
            (Log::Gnss, &self.gnss_skipped),
            (Log::Truth, &self.truth_skipped),
        ]));
        let found = findings::with_rate(one_model(found), 1.0 / self.gaps.nominal_interval);
        findings::ranked(findings::of_model(found, self.model.as_ref()))
    }

    /// The longest part of the log with a solution, where all of them together are a small part of it.
    fn covers_part(&self) -> Option<Finding> {
        let s = &self.summary;
        let (first, started) = (self.first_sample?, s.started?);
        let end = s.diverged.unwrap_or(s.ended);
        let mut parts = vec![(started, end)];
        for restart in &s.restarts {
            if let Some((_, to)) = parts.last_mut().filter(|(_, to)| *to == end) {
                *to = restart.time;
            }
            parts.extend(restart.resumed.map(|time| (time, end)));
        }
        let length = |(from, to): &(f64, f64)| to - from;
        let covered: f64 = parts.iter().map(length).sum();
        let longest = parts.iter().max_by(|a, b| length(a).total_cmp(&length(b)));
        let (from, to) = *longest?;
        (covered < LEAST_COVERED * (s.ended - first)).then_some(Finding::CoversPart {
            from,
            to,
            log: [first, s.ended],
        })
    }

    /// Why there is no error although there is a truth.
    fn not_compared(&self) -> Option<Finding> {
        let (None, Some((from, to))) = (&self.rmse, self.truth_read) else {
            return None;
        };
        let (started, ended) = (self.summary.started, self.summary.ended);
        let is_apart = started.is_some_and(|start| to < start) || from > ended;
        Some(Finding::NotCompared {
            why: if is_apart {
                NoError::NoOverlap
            } else {
                NoError::TooSparse
            },
            truth: [from, to],
            started,
            ended,
        })
    }
}

/// Share of the inertial log below which the solution covers a small part of it.
const LEAST_COVERED: f64 = 0.5;

/// Of the findings on position and velocity the one that the model predicts worse.
fn one_model(mut found: Vec<Finding>) -> Vec<Finding> {
    let factor = |of: &Finding| match of {
        Finding::OptimisticModel { factor, .. } => Some(*factor),
        _ => None,
    };
    let worst = found.iter().filter_map(factor).fold(0.0, f64::max);
    found.retain(|of| factor(of).is_none_or(|factor| factor >= worst));
    found
}

impl NavigateError {
    /// Findings on the logs from before the error ended the run.
    pub fn findings(&self) -> Vec<Finding> {
        match self {
            Self::Replay(error) | Self::Mounting(EstimateError::Replay(error)) => error.findings(),
            _ => Vec::new(),
        }
    }
}

impl ReplayError {
    /// Findings on the logs from before the error ended the run.
    pub fn findings(&self) -> Vec<Finding> {
        let Self::NotAligned(ended) = self else {
            return Vec::new();
        };
        let logs: Vec<_> = ended.skipped.iter().map(|(log, s)| (*log, s)).collect();
        let implausible = ended.why.implausible.iter().map(|what| (*what).into());
        let stamps = ended.why.times.as_ref().map(|(stamps, _)| stamps);
        let of_order = stamps
            .into_iter()
            .flatten()
            .zip(&logs)
            .flat_map(|(stamps, log)| {
                let intervals = (stamps.count as f64 - 1.0).max(1.0);
                let interval = (stamps.last - stamps.first) / intervals;
                findings::of_order(log.0, log.1, interval, stamps.count)
            });
        let skipped = findings::of_skipped(&logs);
        let slow = stamps.and_then(|[samples, _]| {
            let rate = (samples.count as f64 - 1.0) / (samples.last - samples.first);
            findings::too_slow(rate)
        });
        (of_order.chain(implausible).chain(slow).chain(skipped)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::navigate::Hindsight;
    use crate::replay::{Implausible, Summary};
    use crate::settings::fix_errors::{Correlated, FixErrors};
    use undrift_nav::Matrix3;

    fn report(std_factors: [Option<f64>; 2]) -> Report {
        Report {
            std_factors,
            summary: Summary::default(),
            hindsight: Hindsight::Causal,
            clock: Default::default(),
            study: None,
            fix_errors: FixErrors::default(),
            mounting: None,
            rotation: Matrix3::identity(),
            rmse: None,
            consistency: Default::default(),
            truth_read: None,
            imu_skipped: Default::default(),
            gnss_skipped: Default::default(),
            sensors: Vec::new(),
            truth_skipped: Default::default(),
            thermal: None,
            gaps: Default::default(),
            axis_faults: Default::default(),
            recording: None,
            rows: Vec::new(),
            rejected: Default::default(),
            first_sample: None,
            model: None,
            guessed_rate: None,
            pose_faults: Vec::new(),
        }
    }

    /// The factors that are found, with their parts.
    fn accuracies(report: &Report) -> Vec<(Part, f64)> {
        let found = report.findings().into_iter();
        found
            .filter_map(|of| match of {
                Finding::WrongAccuracy { part, factor, .. } => Some((part, factor)),
                _ => None,
            })
            .collect()
    }

    /// Of a log of ten minutes 0.9 s at its end; a half of it; a whole one in parts; two short parts.
    #[test]
    fn a_solution_of_a_small_part_of_the_log_is_said_to_be_one() {
        use crate::replay::{Restart, RestartCause};
        let part = |started: f64, restarts: &[(f64, Option<f64>)], diverged| {
            let mut report = report([None, None]);
            report.first_sample = Some(100.0);
            report.summary.started = Some(started);
            report.summary.ended = 700.0;
            report.summary.diverged = diverged;
            let restart = |(time, resumed): &(f64, Option<f64>)| Restart {
                time: *time,
                why: RestartCause::LargeInnovations,
                resumed: *resumed,
            };
            report.summary.restarts = restarts.iter().map(restart).collect();
            let found = report.findings().into_iter();
            let of_parts = found.filter_map(|of| match of {
                Finding::CoversPart { from, to, log } => Some((from, to, log)),
                _ => None,
            });
            of_parts.collect::<Vec<_>>()
        };
        let log = [100.0, 700.0];
        assert_eq!(part(699.1, &[], None), [(699.1, 700.0, log)]);
        assert_eq!(part(399.0, &[], None), []);
        assert_eq!(part(110.0, &[(300.0, Some(330.0))], None), []);
        let two = part(110.0, &[(200.0, Some(600.0))], None);
        assert_eq!(two, [(600.0, 700.0, log)]);
        assert_eq!(part(110.0, &[(200.0, None)], None), [(110.0, 200.0, log)]);
        assert_eq!(part(110.0, &[], Some(150.0)), [(110.0, 150.0, log)]);
        let only = findings::verdict(&[Finding::CoversPart {
            from: 699.1,
            to: 700.0,
            log,
        }])
        .0;
        assert_eq!(only, findings::Severity::Warning);
    }

    #[test]
    fn what_lasts_of_an_error_is_no_accuracy_that_is_too_modest() {
        let both = [(Part::Position, 2.0), (Part::Velocity, 0.5)];
        let mut found = report([Some(2.0), Some(0.5)]);
        assert_eq!(accuracies(&found), both);
        // The innovations have only what does not last: they are small.
        let lasting = |time: f64| Some(Correlated { share: 0.5, time });
        let longest = LONGEST_CORRELATION;
        found.fix_errors.velocity_correlated = lasting(0.9 * longest);
        assert_eq!(accuracies(&found), both[..1]);
        // Of the position they are too large all the same.
        found.fix_errors.correlated = lasting(0.9 * longest);
        assert_eq!(accuracies(&found), both[..1]);
        // A time at the end of what the study looks at was not seen.
        found.fix_errors.velocity_correlated = lasting(longest);
        assert_eq!(accuracies(&found), both);
        found.summary.implausible = vec![Implausible::Gravity {
            ratio: 0.1,
            exchanged: false,
        }];
        assert!(accuracies(&found).is_empty());
        assert!(accuracies(&report([None, None])).is_empty());
    }
}
