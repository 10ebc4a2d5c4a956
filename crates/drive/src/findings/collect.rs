//! Findings from the counts of a run or a recording, one function for each subject, with the thresholds from which something is
//! a finding. [`crate::navigate`], [`crate::outages`], [`crate::record`] and `undrift-fleet` call them and put them in order.

use super::{Finding, Log, Severity};
use crate::{
    drive::SensorRead,
    fixes::FixStudy,
    mounting::MountingError,
    replay::{Aid, Disagreement, Innovations, Part, SampleFault, SideSlip, Summary, WindowPart},
    settings::fix_errors::{Correlated, FixErrors},
};
use undrift_engine::DisturbedField;
use undrift_io::{
    imu::ThermalSummary,
    skipped::{SetBack, SkipKind, Skipped},
};
use undrift_nav::{Matrix3, Vector3, covariance::AXES};
use undrift_noise::screening::Timing;
use undrift_results::findings::{FarParameter, LogEnd, TemperatureUse};

/// Spans without a usable fix longer than this are reported \[s\].
pub const WITHOUT_GNSS: f64 = 5.0;
/// Jitter of the stamps below which nobody has to know of it \[s\].
const LEAST_JITTER: f64 = 1e-3;
/// Relative change of the fixes' standard deviations above which it is reported.
const LEAST_CHANGE: f64 = 0.05;
/// Rate of the inertial samples below which they miss the motion between them \[Hz\].
const LEAST_RATE: f64 = 25.0;
/// Share of late positions from which it is a finding; less may be chance.
const LEAST_LATE_SHARE: f64 = 0.05;
/// A larger estimate of the samples' delay is not believed: the solution has diverged \[s\].
const MOST_DELAY: f64 = 2.0;
/// Spans of rejected fixes that are reported one by one.
const LISTED: usize = 3;
/// Rows out of time order from which on a log is unsorted; fewer are single rows that came late.
const LEAST_UNSORTED: u64 = 10;
/// Autocorrelation from one update to the next above which innovations are correlated: then it is not the accuracy of the fixes that is
/// wrong.
const CORRELATED: f64 = 0.5;
/// NIS per degree of freedom below which correlated innovations are no fault: the standard deviations contain them.
const MODEST_NIS: f64 = 0.7;
/// Fewest updates by which innovations are called correlated.
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
    let slip = summary.side_slip;
    found.extend(slip.map(|SideSlip { start, speed }| Finding::SideSlip { start, speed }));
    if summary.bad_fixes > 0 {
        let fixes = summary.bad_fixes;
        found.push(Finding::BadCovariance { fixes });
    }
    found
}

/// Samples that should have been corrected for temperature and were not, or were by extrapolation.
pub fn of_temperature(seen: Option<ThermalSummary>) -> Option<Finding> {
    let seen = seen.filter(|seen| seen.without > 0 || seen.beyond > 0);
    seen.map(|seen| {
        Finding::Temperature(TemperatureUse {
            corrected: seen.corrected,
            without: seen.without,
            without_from: seen.without_from,
            beyond: seen.beyond,
            seen_c: seen.seen_c,
        })
    })
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
/// with sign; `None` where the present axes are not sensor axes, or gravity forbids it.
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
            accepted: more.iter().filter(|c| c.accepted_in_the_end).count() as u64,
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
    let headings = &summary.rejected_headings;
    found.extend(
        (headings.iter().max_by_key(|run| run.headings)).map(|longest| Finding::RejectedHeadings {
            longest: *longest,
            more: headings.len() as u64 - 1,
        }),
    );
    let fields = &summary.disturbed_fields;
    let length = |field: &DisturbedField| field.end - field.start;
    let longest = fields.iter().max_by(|a, b| length(a).total_cmp(&length(b)));
    found.extend(longest.map(|longest| Finding::DisturbedField(*longest)));
    found.extend(summary.far.iter().map(|(parameter, value, sigmas)| {
        Finding::FarParameter(FarParameter {
            parameter: format!("{parameter:?}"),
            value: *value,
            sigmas: *sigmas,
        })
    }));
    let late = &summary.late_samples;
    // A solution that has diverged has a diverged time offset.
    let is_delay = late.delay.0.abs() < MOST_DELAY;
    if is_delay && late.behind as f64 > LEAST_LATE_SHARE * late.positions as f64 {
        found.push(Finding::LateSamples {
            delay: late.delay.into(),
            most: late.most,
        });
    }
    let mismatches = summary.mismatches.iter().copied();
    found.extend(mismatches.map(|what| Finding::Mismatch { what }));
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
    if errors.jitter > LEAST_JITTER {
        let std = errors.jitter;
        found.push(Finding::FixJitter { std });
    }
    if let Some(Correlated { share, time }) = errors.correlated {
        found.push(Finding::CorrelatedFixes { share, time });
    }
    let factor = errors.velocity_factor.x;
    if (factor - 1.0).abs() > LEAST_CHANGE {
        found.push(Finding::ModestVelocity { factor });
    }
    if errors.position_factor - 1.0 > LEAST_CHANGE {
        let factor = errors.position_factor;
        found.push(Finding::NoisyFixes { factor });
    }
    if errors.height_factor - 1.0 > LEAST_CHANGE {
        let factor = errors.position_factor * errors.height_factor;
        found.push(Finding::NoisyHeights { factor });
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

/// What was unusual about the log of a sensor beside IMU and receiver, and how it was used.
pub fn of_sensor(read: &SensorRead, used: &Innovations) -> Vec<Finding> {
    let SensorRead {
        log, skipped, gaps, ..
    } = read;
    let log = *log;
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
/// `accepted` the number of rows that were used.
pub fn of_order(log: Log, skipped: &Skipped, interval: f64, accepted: u64) -> Vec<Finding> {
    let mut found = Vec::new();
    if let (Some(behind), None) = (
        skipped.entry(SkipKind::TimeBackwards),
        skipped.largest_set_back(),
    ) && behind.count >= LEAST_UNSORTED
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
/// span. A receiver that is switched off a little after the sensor is no finding.
pub fn of_ends(end: f64, fixes: [f64; 2]) -> Option<Finding> {
    let [first, last] = fixes;
    let missing = last - end;
    let long = missing > WITHOUT_GNSS.max(0.1 * (last - first));
    long.then_some(Finding::EndsEarly(LogEnd { end, missing }))
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

/// Stamps of a static recording that are not evenly spaced; what starts again is said of its sessions.
pub fn of_timing(timing: Option<&Timing>) -> Option<Finding> {
    let uneven = |of: &&Timing| !of.gaps.is_empty() || of.jitter_rms_s > 1e-3 * of.interval_s;
    let uneven = timing.filter(|timing| !timing.even).filter(uneven)?;
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

/// Replaces a noise model that seems too optimistic by too few samples a second as the cause, if `rate` \[Hz\] is that low.
pub fn of_rate(found: Finding, rate: f64) -> Finding {
    match found {
        Finding::OptimisticModel { factor, .. } if rate < LEAST_RATE => {
            let factor = Some(factor);
            Finding::SlowSamples { rate, factor }
        }
        other => other,
    }
}

/// The findings, with too few samples a second before them if `rate` \[Hz\] is that low and a finding shows a disagreement other than in
/// the size of the innovations.
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
        // First: a cause comes before its symptoms.
        found.insert(0, slow);
    }
    found
}

/// Too few samples a second, if `rate` \[Hz\] is below the least.
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
mod tests;
