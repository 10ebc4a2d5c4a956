//! The findings of a run, from its counts.

use super::{Finding, Log};
use crate::replay::{Implausible, Innovations, Part, Summary};
use undrift_io::{held::Held, imu::GapSummary, skipped::Skipped};
use undrift_nav::{Matrix3, Vector3};
use undrift_noise::screening::Timing;

/// Spans without a usable fix longer than this are reported \[s\].
pub const WITHOUT_GNSS: f64 = 5.0;
/// Spans of rejected fixes that are reported one by one.
const LISTED: usize = 12;
/// Autocorrelation of innovations above which it is not the accuracy of the fixes that is wrong.
const CORRELATED: f64 = 0.5;

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
    let (start, length) = summary.longest_without_gnss;
    if length > WITHOUT_GNSS {
        found.push(Finding::WithoutGnss { start, length });
    }
    if summary.bad_fixes > 0 {
        let fixes = summary.bad_fixes;
        found.push(Finding::BadCovariance { fixes });
    }
    found
}

/// Axes of the IMU that held a value; a frozen log is one finding.
pub fn of_held(held: &[Held]) -> Vec<Finding> {
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
            .map(|of| Finding::Held {
                axis: of.axis,
                value: of.value,
                start: of.start,
                length: of.length,
                samples: of.samples,
                saturated: of.saturated,
            })
            .collect(),
    }
}

impl From<Implausible> for Finding {
    fn from(what: Implausible) -> Self {
        match what {
            Implausible::Gravity(ratio) => Self::WrongGravity { ratio },
            Implausible::Down(down) => Self::NotDown { down },
            Implausible::TurnScale(ratio) => Self::WrongTurnRate { ratio },
            Implausible::TurnAxis(axis) => Self::WrongTurnAxis { axis },
            Implausible::NoTurn => Self::NoTurns,
            Implausible::Late(delay) => Self::Late { delay },
            Implausible::Push { forward, right } => Self::WrongAxes {
                forward,
                right,
                axes: None,
            },
            Implausible::Velocity(mend) => Self::WrongVelocity { mend },
        }
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
    found.extend(summary.leans.iter().copied().map(Finding::OneSided));
    found.extend(
        summary
            .wrong_signs()
            .map(|axis| Finding::WrongSign { axis }),
    );
    found.extend(
        summary
            .suspect
            .map(|start| Finding::LargeInnovations { start }),
    );
    found
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

/// What was skipped in each log.
pub fn of_skipped(logs: &[(Log, &Skipped)]) -> Vec<Finding> {
    let any = logs.iter().filter(|(_, skipped)| !skipped.is_empty());
    any.map(|(log, skipped)| Finding::Skipped {
        log: *log,
        records: skipped.total(),
        kinds: skipped.to_string(),
    })
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

/// A stated accuracy of a part of the fixes that is wrong by a factor.
pub fn of_accuracy(part: Part, factor: f64, summary: &Summary) -> Finding {
    let correlated = [&summary.position, &summary.velocity]
        .iter()
        .any(|sums| sums.autocorrelation().is_some_and(|(c, _)| c > CORRELATED));
    Finding::WrongAccuracy {
        part,
        factor,
        adapted: summary.adapted.iter().any(Option::is_some),
        correlated,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
