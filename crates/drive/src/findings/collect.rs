//! The findings of a run, from its counts.

use super::{Finding, Log, Severity};
use crate::{
    fixes::FixStudy,
    mounting::MountingError,
    replay::{Aid, Disagreement, Innovations, Part, SampleFault, Summary, WindowPart},
    settings::fix_errors::{Correlated, FixErrors},
};
use undrift_io::{
    held::Held,
    imu::{GapSummary, ThermalSummary},
    skipped::{SetBack, SkipKind, Skipped},
};
use undrift_nav::{Matrix3, Vector3, covariance::AXES};
use undrift_noise::screening::Timing;

/// Spans without a usable fix longer than this are reported \[s\].
pub const WITHOUT_GNSS: f64 = 5.0;
/// Change of the fixes' standard deviations above which it is reported.
const WORTH_REPORTING: f64 = 0.05;
/// Below so many samples a second the motion between them is missed \[Hz\].
const LEAST_RATE: f64 = 25.0;
/// Share of the fixes from which what they show is no chance.
const SOMETIMES: f64 = 0.05;
/// Samples that seem to be later than this are not late \[s\].
const MOST_DELAY: f64 = 2.0;
/// Spans of rejected fixes that are reported one by one.
const LISTED: usize = 3;
/// Autocorrelation of innovations above which it is not the accuracy of the fixes that is wrong.
const CORRELATED: f64 = 0.5;
/// NIS per degree of freedom below which correlated innovations are smaller than predicted by enough.
const MODEST_NIS: f64 = 0.7;
/// Updates that these two need.
const LEAST_UPDATES: u64 = 100;

/// What was unusual about the logs.
pub fn of_health(summary: &Summary) -> Vec<Finding> {
    let mut found = Vec::new();
    if summary.bridged > 0 {
        let gaps = summary.bridged;
        found.push(Finding::Bridged { gaps });
    }
    if let Some((gaps, first, longest)) = summary.long_gaps {
        found.push(Finding::LongGaps {
            gaps,
            first,
            longest,
        });
    }
    found.extend(summary.no_mounting.map(|why| {
        let (mut driving, mut wander, mut std) = (None, None, None);
        match why {
            MountingError::TooLittle { found } => driving = Some(found),
            MountingError::Wanders { wander: of } => wander = Some(of),
            MountingError::Unsure { std: of } => std = Some(of),
        }
        Finding::NoMounting {
            driving,
            wander,
            std,
        }
    }));
    let (start, length) = summary.longest_without_gnss;
    if length > WITHOUT_GNSS {
        found.push(Finding::WithoutGnss { start, length });
    }
    found.extend(of_samples(summary));
    let excess = summary.alignment.and_then(|how| how.force_excess);
    found.extend(excess.map(|excess| Finding::UnexplainedForce { excess }));
    let vertical = summary.no_vertical_velocity;
    found.extend(vertical.map(|start| Finding::NoVerticalVelocity { start }));
    if summary.bad_fixes > 0 {
        let fixes = summary.bad_fixes;
        found.push(Finding::BadCovariance { fixes });
    }
    found
}

/// So many rows out of order are a log that was written so, rather than single ones that were overtaken.
const DISORDER: u64 = 10;
/// Share of the vertical in the axis of the gyro that is nearest to it.
const VERTICAL: f64 = 0.7;

/// Samples that should have been corrected for temperature and were not, or were by extrapolation.
pub fn of_temperature(seen: Option<ThermalSummary>) -> Option<Finding> {
    let seen = seen.filter(|seen| seen.without > 0 || seen.beyond > 0);
    seen.map(|seen| Finding::Temperature {
        corrected: seen.corrected,
        without: seen.without,
        without_from: seen.without_from,
        beyond: seen.beyond,
        seen_c: seen.seen_c,
    })
}

/// Axes of the IMU that held a value, where `rotation` is from the sensor's axes to the body's; a frozen log is one finding.
pub fn of_held(held: &[Held], rotation: &Matrix3) -> Vec<Finding> {
    match held {
        [first, _, _, _, _, _]
            if held
                .iter()
                .all(|of| of.start == first.start && !of.saturated) =>
        {
            vec![Finding::Frozen {
                start: first.start,
                length: first.length,
                samples: first.samples,
            }]
        }
        _ => held
            .iter()
            .map(|of| match of.constant {
                true => Finding::Constant {
                    axis: of.axis,
                    value: of.value,
                    samples: of.samples,
                    vertical: of.axis < 3 && rotation[(2, of.axis)].abs() > VERTICAL,
                },
                false => Finding::Held {
                    axis: of.axis,
                    value: of.value,
                    start: of.start,
                    length: of.length,
                    samples: of.samples,
                    saturated: of.saturated,
                },
            })
            .collect(),
    }
}

/// The findings with what mends wrong axes, where `rotation` is from the sensor's axes to the body's.
pub fn with_axes(mut found: Vec<Finding>, rotation: &Matrix3) -> Vec<Finding> {
    for one in &mut found {
        if let Finding::WrongAxes {
            forward,
            right,
            axes,
        } = one
        {
            *axes = mended_axes(rotation, *forward, *right);
        }
    }
    found
}

/// The value of `imu.axes` whose forward and right are these axes of the present body, 1 forward, 2 right,
/// with sign; `None` where the present axes are none of the sensor's own, or gravity forbids it.
fn mended_axes(rotation: &Matrix3, forward: Option<i8>, right: Option<i8>) -> Option<String> {
    let forward = forward?;
    let right = right.unwrap_or(match forward {
        1 => 2,
        -1 => -2,
        2 => -1,
        _ => 1,
    });
    let axis = |number: i8| {
        let row = rotation.row(usize::from(number.unsigned_abs()) - 1);
        row.transpose() * f64::from(number.signum())
    };
    let (forward, right) = (axis(forward), axis(right));
    let down = forward.cross(&right);
    if down != rotation.row(2).transpose() {
        return None;
    }
    let name = |axis: Vector3| {
        let of = axis.iter().position(|x| x.abs() == 1.0)?;
        let sign = if axis[of] < 0.0 { "-" } else { "" };
        Some(format!("{sign}{}", ["x", "y", "z"][of]))
    };
    Some([name(forward)?, name(right)?, name(down)?].join(","))
}

/// Where the solution and the fixes disagreed: the receiver's fault or the model's.
pub fn of_disagreement(summary: &Summary) -> Vec<Finding> {
    let mut found: Vec<Finding> = summary.implausible.iter().map(|of| (*of).into()).collect();
    found.extend(summary.restarts.iter().map(|restart| Finding::Restart {
        time: restart.time,
        why: restart.why,
        resumed: restart.resumed,
    }));
    let rejected = &summary.contradictions;
    found.extend(rejected.iter().take(LISTED).copied().map(Finding::Rejected));
    if rejected.len() > LISTED {
        let more = &rejected[LISTED..];
        found.push(Finding::MoreRejected {
            spans: more.len() as u64 + summary.more_contradictions,
            accepted: more.iter().filter(|c| c.gave_way).count() as u64,
        });
    }
    if let Some(worst) = summary
        .heading_off
        .iter()
        .max_by(|a, b| a.angle.abs().total_cmp(&b.angle.abs()))
    {
        found.push(Finding::HeadingOff {
            start: worst.start,
            end: worst.end,
            angle: worst.angle,
            more: summary.heading_off.len() as u64 - 1,
        });
    }
    found.extend(
        summary
            .far
            .iter()
            .map(|(parameter, value, sigmas)| Finding::FarParameter {
                parameter: format!("{parameter:?}"),
                value: *value,
                sigmas: *sigmas,
            }),
    );
    let late = &summary.late_samples;
    // Of a solution that has gone astray the time offset has, too.
    let is_delay = late.delay.0.abs() < MOST_DELAY;
    if is_delay && late.behind as f64 > SOMETIMES * late.positions as f64 {
        found.push(Finding::LateSamples {
            delay: late.delay.into(),
            most: late.most,
        });
    }
    found.extend(summary.leans.iter().copied().map(Finding::OneSided));
    found.extend(
        summary
            .wrong_signs
            .iter()
            .map(|axis| Finding::WrongSign { axis: *axis }),
    );
    let innovations = of_windows(summary);
    let large = || {
        Some(Finding::LargeInnovations {
            start: summary.suspect?,
        })
    };
    found.extend(innovations.or_else(large));
    found
}

/// The span in which the solution and the fixes disagree most.
fn of_windows(summary: &Summary) -> Option<Finding> {
    let spans = WindowPart::ALL.map(|part| summary.windows.disagreements(part));
    let spans: Vec<Disagreement> = spans.into_iter().flatten().collect();
    let outside = |of: &Disagreement| of.agreement.innovations - of.agreement.inside;
    let worst = spans.iter().max_by_key(|of| outside(of))?;
    Some(Finding::Disagreement {
        part: worst.part,
        start: worst.start,
        end: worst.end,
        inside: worst.agreement.share()?,
        rms: worst.agreement.rms(),
        overall: summary.windows.overall(worst.part).share()?,
        more: spans.len() as u64 - 1,
    })
}

/// What the fixes show of themselves.
pub fn of_fixes(study: &FixStudy, errors: &FixErrors) -> Vec<Finding> {
    let mut found = Vec::new();
    if study.repeated > 0 {
        found.push(Finding::RepeatedFixes {
            fixes: study.repeated,
            interval: study.interval,
        });
    }
    if errors.velocity_bias != Vector3::zeros() {
        let bias = errors.velocity_bias.into();
        found.push(Finding::VelocityBias { bias });
    }
    if errors.step.max() > 0.0 {
        let step = errors.step.max();
        found.push(Finding::RoundedFixes { step });
    }
    if errors.jitter > 0.0 {
        let std = errors.jitter;
        found.push(Finding::FixJitter { std });
    }
    if let Some(Correlated { share, time }) = errors.correlated {
        found.push(Finding::CorrelatedFixes { share, time });
    }
    let factor = errors.velocity_factor.x;
    if (factor - 1.0).abs() > WORTH_REPORTING {
        found.push(Finding::ModestVelocity { factor });
    }
    if errors.position_factor - 1.0 > WORTH_REPORTING {
        let factor = errors.position_factor;
        found.push(Finding::NoisyFixes { factor });
    }
    found
}

/// Samples that were replaced, axis by axis.
fn of_samples(summary: &Summary) -> Vec<Finding> {
    let of_axis = |axis| {
        let is = |fault: &&SampleFault| fault.axis == axis && !fault.stuck;
        let mut spikes = summary.sample_faults.iter().filter(is);
        let first = spikes.next()?;
        Some(Finding::Spikes {
            axis,
            samples: 1 + spikes.count() as u64,
            start: first.start,
        })
    };
    (0..AXES).filter_map(of_axis).collect()
}

/// What was unusual about a log of scalars, and how it was used.
pub fn of_scalar(
    log: Log,
    skipped: &Skipped,
    gaps: &GapSummary,
    used: &Innovations,
) -> Vec<Finding> {
    let mut found = of_skipped(&[(log, skipped)]);
    if let Some(longest) = gaps.longest {
        found.push(Finding::Gaps {
            log,
            gaps: gaps.count,
            start: longest.start,
            length: longest.length,
        });
    }
    if used.updates == 0 {
        found.push(Finding::Unused { log });
    }
    let (rejected, weakened) = (used.rejected, used.weakened);
    if rejected + weakened > 0 {
        found.push(Finding::Outliers {
            log,
            rejected,
            weakened,
        });
    }
    found
}

/// Rows of a log out of the order of time, or under a time stamp that they share; `interval` is the usual one \[s\],
/// and so many records were accepted.
pub fn of_order(log: Log, skipped: &Skipped, interval: f64, accepted: u64) -> Vec<Finding> {
    let mut found = Vec::new();
    if let (Some(behind), None) = (
        skipped.entry(SkipKind::TimeBackwards),
        skipped.largest_set_back(),
    ) && behind.count >= DISORDER
    {
        found.push(Finding::OutOfOrder {
            log,
            rows: behind.count,
            line: behind.first_line,
        });
    }
    let shared = skipped.count(SkipKind::DuplicateTime);
    if shared > accepted {
        found.push(Finding::SharedStamps {
            log,
            rows: shared,
            interval,
        });
    }
    found
}

/// An inertial log whose last sample, at `end` \[s\], is before the last fix by more than a tenth of what the fixes
/// span. A receiver that is switched off some time after the sensor is none.
pub fn of_ends(end: f64, fixes: [f64; 2]) -> Option<Finding> {
    let [first, last] = fixes;
    let missing = last - end;
    let long = missing > WITHOUT_GNSS.max(0.1 * (last - first));
    long.then_some(Finding::EndsEarly { end, missing })
}

/// What was skipped in each log.
pub fn of_skipped(logs: &[(Log, &Skipped)]) -> Vec<Finding> {
    let any = logs.iter().filter(|(_, skipped)| !skipped.is_empty());
    let set_back = logs.iter().filter_map(|(log, skipped)| {
        let SetBack { line, step } = skipped.largest_set_back()?;
        Some(Finding::SetBack {
            log: *log,
            line,
            step,
        })
    });
    any.map(|(log, skipped)| Finding::Skipped {
        log: *log,
        records: skipped.total(),
        kinds: skipped.to_string(),
    })
    .chain(set_back)
    .collect()
}

/// Stamps of a static recording that are not evenly spaced.
pub fn of_timing(timing: Option<&Timing>) -> Option<Finding> {
    let uneven = timing.filter(|timing| !timing.even)?;
    Some(Finding::Uneven {
        gaps: uneven.gaps.len(),
        jitter_rms: uneven.jitter_rms_s,
        interval: uneven.interval_s,
    })
}

/// A stated accuracy of a part of the fixes that does not fit the innovations by a factor: it is wrong, or, where the
/// fixes are `known` to be as good as they state, the noise model of the sensors is.
pub fn of_accuracy(part: Part, factor: f64, summary: &Summary, known: bool) -> Finding {
    let correlated = [Aid::Position, Aid::Velocity]
        .map(|aid| &summary.innovations[aid])
        .iter()
        .any(|sums| sums.autocorrelation().is_some_and(|(c, _)| c > CORRELATED));
    if known && factor > 1.0 {
        return Finding::OptimisticModel {
            factor,
            tuned: false,
        };
    }
    Finding::WrongAccuracy {
        part,
        factor,
        adapted: summary.adapted.iter().any(Option::is_some),
        correlated,
    }
}

/// The same of a log with so many samples a second \[Hz\].
pub fn of_rate(found: Finding, rate: f64) -> Finding {
    match found {
        Finding::OptimisticModel { factor, .. } if rate < LEAST_RATE => {
            let factor = Some(factor);
            Finding::SlowSamples { rate, factor }
        }
        other => other,
    }
}

/// The findings of a log with so many samples a second \[Hz\]: where they are few, and solution and fixes do not go together in
/// another way than by their size, it is they.
pub fn with_rate(mut found: Vec<Finding>, rate: f64) -> Vec<Finding> {
    let is_said = |of: &Finding| matches!(of, Finding::SlowSamples { .. });
    let is_symptom = |of: &Finding| {
        let kind = matches!(
            of,
            Finding::Disagreement { .. }
                | Finding::CorrelatedInnovations { .. }
                | Finding::FarParameter { .. }
        );
        kind && of.severity() > Severity::Note
    };
    if found.iter().any(is_symptom)
        && !found.iter().any(is_said)
        && let Some(slow) = too_slow(rate)
    {
        // Before what else they make of the times.
        found.insert(0, slow);
    }
    found
}

/// That so many samples a second \[Hz\] miss the motion between them, if they do.
pub fn too_slow(rate: f64) -> Option<Finding> {
    let factor = None;
    (rate < LEAST_RATE).then_some(Finding::SlowSamples { rate, factor })
}

/// Innovations of position or velocity that last from fix to fix and are not smaller than predicted: errors of attitude
/// and sensors are larger than the covariance has them.
pub fn of_correlation(summary: &Summary) -> Option<Finding> {
    let parts = [
        (Part::Velocity, &summary.innovations[Aid::Velocity]),
        (Part::Position, &summary.innovations[Aid::Position]),
    ];
    parts.into_iter().find_map(|(part, sums)| {
        let (correlation, _) = sums.autocorrelation()?;
        let lasts = correlation > CORRELATED && sums.updates >= LEAST_UPDATES;
        let covered = sums.per_dof()? < MODEST_NIS;
        (lasts && !covered).then_some(Finding::CorrelatedInnovations {
            part,
            correlation,
            tuned: false,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::Severity;

    #[test]
    fn rows_out_of_order_and_stamps_that_are_shared() {
        let mut skipped = Skipped::default();
        let none = |skipped: &Skipped| of_order(Log::Imu, skipped, 1.0, 10).is_empty();
        (0..10).for_each(|k| skipped.add(SkipKind::DuplicateTime, 3 + k, ""));
        assert!(none(&skipped));
        skipped.add(SkipKind::DuplicateTime, 20, "");
        assert_eq!(
            of_order(Log::Imu, &skipped, 1.0, 10),
            [Finding::SharedStamps {
                log: Log::Imu,
                rows: 11,
                interval: 1.0
            }]
        );
        let mut skipped = Skipped::default();
        (0..9).for_each(|k| skipped.add(SkipKind::TimeBackwards, 7 + 2 * k, ""));
        assert!(none(&skipped));
        skipped.add(SkipKind::TimeBackwards, 99, "");
        assert_eq!(
            of_order(Log::Gnss, &skipped, 1.0, 10),
            [Finding::OutOfOrder {
                log: Log::Gnss,
                rows: DISORDER,
                line: 7
            }]
        );
    }

    #[test]
    fn a_constant_axis_is_not_one_that_held_its_value_for_a_while() {
        let held = |constant| Held {
            axis: 2,
            value: 0.5,
            start: 1.0,
            length: 9.0,
            samples: 900,
            saturated: false,
            constant,
        };
        let constant = |vertical| Finding::Constant {
            axis: 2,
            value: 0.5,
            samples: 900,
            vertical,
        };
        assert_eq!(constant(true).severity(), Severity::Unusable);
        assert_eq!(constant(false).severity(), Severity::Warning);
        let level = Matrix3::identity();
        assert_eq!(of_held(&[held(true)], &level), [constant(true)]);
        let upright = Matrix3::new(0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0);
        assert_eq!(of_held(&[held(true)], &upright), [constant(false)]);
        assert!(matches!(
            of_held(&[held(false)], &level)[..],
            [Finding::Held { .. }]
        ));
    }

    #[test]
    fn axes_that_mend_a_turned_sensor() {
        // x forward, y left, z up.
        let present = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
        let mend = |forward, right| mended_axes(&present, forward, right);
        assert_eq!(mend(Some(-1), Some(-2)).as_deref(), Some("-x,y,-z"));
        assert_eq!(mend(Some(-1), None).as_deref(), Some("-x,y,-z"));
        assert_eq!(mend(Some(2), Some(-1)).as_deref(), Some("-y,-x,-z"));
        assert_eq!(mend(Some(-2), None).as_deref(), Some("y,x,-z"));
        // Left-handed, not seen, or at an angle.
        assert_eq!(mend(Some(2), Some(1)), None);
        assert_eq!(mend(None, Some(1)), None);
        let (sin, cos) = 0.3_f64.sin_cos();
        let turned = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
        assert_eq!(mended_axes(&turned, Some(-1), None), None);
    }

    #[test]
    fn what_fixes_show_is_told_beyond_its_threshold() {
        let study = |repeated: u64| FixStudy {
            interval: 0.25,
            repeated,
            velocity_late: None,
            errors: FixErrors::default(),
        };
        let plain = FixErrors::default();
        assert_eq!(of_fixes(&study(0), &plain), []);
        let repeated = Finding::RepeatedFixes {
            fixes: 1,
            interval: 0.25,
        };
        assert_eq!(of_fixes(&study(1), &plain), [repeated]);
        let told = |errors: FixErrors| of_fixes(&study(0), &errors);
        // A twentieth of a standard deviation, more or less; of positions only more.
        for factor in [0.94, 1.06] {
            let modest = FixErrors {
                velocity_factor: undrift_nav::Vector3::repeat(factor),
                ..plain
            };
            assert_eq!(told(modest), [Finding::ModestVelocity { factor }]);
        }
        for factor in [0.96, 1.04] {
            let usual = FixErrors {
                velocity_factor: undrift_nav::Vector3::repeat(factor),
                position_factor: factor,
                ..plain
            };
            assert_eq!(told(usual), []);
        }
        let position = |factor: f64| FixErrors {
            position_factor: factor,
            ..plain
        };
        assert_eq!(told(position(0.5)), []);
        assert_eq!(told(position(1.06)), [Finding::NoisyFixes { factor: 1.06 }]);
        let all = FixErrors {
            velocity_bias: Vector3::new(0.0, -0.5, 0.0),
            step: Vector3::new(0.0, 1.0, 2.0),
            jitter: 0.01,
            correlated: Some(Correlated {
                share: 0.9,
                time: 30.0,
            }),
            ..plain
        };
        let expected = [
            Finding::VelocityBias {
                bias: [0.0, -0.5, 0.0],
            },
            Finding::RoundedFixes { step: 2.0 },
            Finding::FixJitter { std: 0.01 },
            Finding::CorrelatedFixes {
                share: 0.9,
                time: 30.0,
            },
        ];
        assert_eq!(told(all), expected);
    }

    /// Missing is more than a tenth of what the fixes span, and more than a short loss.
    #[test]
    fn a_log_ends_early_by_a_tenth_of_the_fixes() {
        let none = |end: f64, fixes| of_ends(end, fixes).is_none();
        assert!(none(990.0, [900.0, 1000.0]));
        let missing = of_ends(989.0, [900.0, 1000.0]);
        let expected = Finding::EndsEarly {
            end: 989.0,
            missing: 11.0,
        };
        assert_eq!(missing, Some(expected));
        assert!(none(1010.0, [900.0, 1000.0]));
        assert!(none(10.0, [0.0, 10.0 + WITHOUT_GNSS]));
        assert!(!none(10.0, [0.0, 10.5 + WITHOUT_GNSS]));
    }

    #[test]
    fn rejected_spans_are_listed_up_to_three() {
        use crate::replay::Contradiction;
        let summary = |count: usize, more: u64| {
            let mut summary = Summary::default();
            summary.more_contradictions = more;
            summary.contradictions = (0..count)
                .map(|k| Contradiction {
                    part: Part::Position,
                    height: false,
                    start: 1.0,
                    end: 2.0,
                    fixes: 3,
                    first: 4.0,
                    last: 5.0,
                    growth: 6.0,
                    largest: 7.0,
                    frozen: false,
                    gave_way: k % 2 == 0,
                })
                .collect();
            summary
        };
        let more = |count, more| {
            let found = of_disagreement(&summary(count, more));
            let listed = found.iter().filter(|of| matches!(of, Finding::Rejected(_)));
            assert_eq!(listed.count(), count.min(3));
            found.into_iter().find_map(|of| match of {
                Finding::MoreRejected { spans, accepted } => Some((spans, accepted)),
                _ => None,
            })
        };
        assert_eq!(more(3, 0), None);
        // Of runs four to seven, the solution was reset to the fixes after five and seven.
        assert_eq!(more(4, 0), Some((1, 0)));
        assert_eq!(more(7, 10), Some((14, 2)));
    }

    /// Thirty positions of which a part is four standard deviations off, north; ten minutes of good ones before.
    #[test]
    fn the_worst_span_is_found_with_the_share_of_the_whole_log() {
        let of = |off: usize| {
            let mut summary = Summary::default();
            for k in 0..630 {
                let north = if k >= 600 && k < 600 + off { 4.0 } else { 0.0 };
                let update = undrift_nav::filter::Update {
                    nis: north * north,
                    dof: 2,
                    whitened: [north, 0.0, 0.0],
                    score: 0.0,
                    information: 1.0,
                    outcome: undrift_nav::filter::Outcome::Used,
                };
                summary.windows.add(Part::Position, k as f64, &update);
            }
            of_disagreement(&summary)
        };
        assert!(of(6).is_empty());
        let expected = Finding::Disagreement {
            part: WindowPart::Position,
            start: 600.0,
            end: 629.0,
            inside: 20.0 / 30.0,
            rms: (8.0f64 * 10.0 / 30.0).sqrt(),
            overall: 620.0 / 630.0,
            more: 0,
        };
        assert_eq!(of(10), [expected]);
    }

    #[test]
    fn few_samples_are_why_solution_and_fixes_do_not_go_together() {
        let far = |sigmas| Finding::FarParameter {
            parameter: "GyroScale".into(),
            value: 0.2,
            sigmas,
        };
        let slow = |factor| Finding::SlowSamples { rate: 20.0, factor };
        assert_eq!(too_slow(20.0), Some(slow(None)));
        assert_eq!(too_slow(25.0), None);
        let doubtful = vec![far(9.0)];
        assert_eq!(with_rate(doubtful.clone(), 20.0), [slow(None), far(9.0)]);
        assert_eq!(with_rate(doubtful.clone(), 25.0), doubtful);
        assert_eq!(with_rate(vec![far(5.0)], 20.0), [far(5.0)]);
        let said = vec![slow(Some(2.0)), far(9.0)];
        assert_eq!(with_rate(said.clone(), 20.0), said);
    }

    /// Two updates whose whitened innovations are 1 and x have the autocorrelation 2x/(1 + x²): a half at 2 − √3.
    fn correlated(x: f64) -> Summary {
        let mut summary = Summary::default();
        for value in [1.0, x] {
            summary.innovations[Aid::Velocity].add(undrift_nav::filter::Update {
                nis: value * value,
                dof: 1,
                whitened: [value, 0.0, 0.0],
                score: 0.0,
                information: 1.0,
                outcome: undrift_nav::filter::Outcome::Used,
            });
        }
        summary
    }

    #[test]
    fn innovations_are_correlated_from_a_half_on() {
        let half = 2.0 - 3f64.sqrt();
        for (x, expected) in [
            (0.99 * half, false),
            (1.01 * half, true),
            (-1.01 * half, false),
        ] {
            let found = of_accuracy(Part::Position, 2.0, &correlated(x), false);
            let Finding::WrongAccuracy {
                part,
                factor,
                adapted,
                correlated,
            } = found
            else {
                panic!("{found:?}");
            };
            assert_eq!(
                (part, factor, adapted, correlated),
                (Part::Position, 2.0, false, expected),
                "{x}"
            );
        }
        let mut adapted = correlated(0.0);
        adapted.adapted = [None, Some(1.0)];
        assert!(matches!(
            of_accuracy(Part::Velocity, 0.5, &adapted, true),
            Finding::WrongAccuracy {
                adapted: true,
                correlated: false,
                ..
            }
        ));
        // Of fixes that are as good as they state the model is to blame, if they seem worse; or a log too slow.
        let found = of_accuracy(Part::Velocity, 1.5, &adapted, true);
        let (rate, factor) = (24.0, 1.5);
        assert_eq!(
            of_rate(found.clone(), rate),
            Finding::SlowSamples {
                rate,
                factor: Some(factor)
            }
        );
        assert_eq!(of_rate(found.clone(), 25.0), found);
        assert_eq!(
            of_accuracy(Part::Velocity, 1.5, &adapted, true),
            Finding::OptimisticModel {
                factor: 1.5,
                tuned: false
            }
        );
    }
}
