//! How much findings weigh, and what they conclude together.

use super::{Finding, Log, Severity};
use statrs::distribution::{Binomial, DiscreteCDF};
use std::ops::RangeInclusive;
use undrift_engine::{Contradiction, Part};

/// Prior standard deviations beyond which an estimated parameter is no parameter any more.
const VERY_FAR: f64 = 7.0;
/// A scatter this many times what is stated is a wrong unit rather than a modest receiver.
const WRONG_UNIT: f64 = 20.0;
/// Measured over true, beyond which no scale factor but a wrong unit, sign or column explains a sensor.
const RIGHT_UNIT: RangeInclusive<f64> = 0.5..=2.0;
/// An axis that holds a value for longer has a fault, and a log that has no samples \[s\].
const LONG: f64 = 1.0;
/// Clocks that are further apart are two, and not one with a delay \[s\].
const TWO_CLOCKS: f64 = 3.0;
/// Gravity along body up, by its component along body down.
const UPSIDE_DOWN: f64 = -0.5;
/// Share of rejected references beyond which the errors in outages say too little.
const MANY: f64 = 0.1;
/// Share of outages that may lie outside of what the model predicts, and how unlikely more of them are by chance.
const OUTSIDE: (f64, f64) = (0.2, 0.05);

/// Share of the innovations inside three standard deviations below which the solution says too little of its errors.
const COVERED: f64 = 0.8;

/// Positions that are rejected for longer than this \[s\] were so although nothing else showed an error: the solution follows sooner
/// where the velocities contradict it, too, or are missing.
const FOLLOWS: f64 = 5.0;

/// Whether the positions, or their heights alone, jumped and stayed where they went while nothing else did: those before and those
/// after do not fit together.
pub fn is_jump(of: &Contradiction) -> bool {
    let steady = (of.last - of.first).abs() < 0.5 * of.largest;
    let lasted = of.end - of.start > FOLLOWS;
    let moved = of.part == Part::Position && of.gave_way && !of.frozen;
    moved && (of.height || lasted && steady)
}

/// Whether so many outages of so many outside of their predicted size are more than a fifth, beyond chance.
fn is_beyond_chance(outside: u64, outages: u64) -> bool {
    let (share, chance) = OUTSIDE;
    let more = |of: Binomial| outside > 0 && of.sf(outside - 1) < chance;
    Binomial::new(share, outages).is_ok_and(more)
}

impl Finding {
    /// How much it weighs.
    pub fn severity(&self) -> Severity {
        match self {
            Self::Diverged { .. } => Severity::Unusable,
            // Whatever is concluded is about another vehicle or another sensor.
            Self::WrongAxes { .. } | Self::WrongTurnAxis { .. } => Severity::Unusable,
            Self::WrongVelocity { mend: Some(_) } => Severity::Unusable,
            Self::Constant { vertical: true, .. } => Severity::Unusable,
            // Most of what the sensors measured is missing.
            Self::SharedStamps { log: Log::Imu, .. } => Severity::Unusable,
            Self::Late { delay } if delay.abs() > TWO_CLOCKS => Severity::Unusable,
            Self::WrongGravity { ratio } | Self::WrongTurnRate { ratio }
                if !RIGHT_UNIT.contains(ratio) =>
            {
                Severity::Unusable
            }
            Self::NoOutage | Self::NotRun { all: true, .. } => Severity::Unusable,
            Self::Disagreement { overall, .. } if *overall < COVERED => Severity::Unusable,
            Self::OptimisticDrift {
                outside, outages, ..
            } if is_beyond_chance(*outside, *outages) => Severity::Unusable,
            // That one of several models is worse than the others is what they are compared for.
            Self::OfModel { what, .. } if what.severity() == Severity::Unusable => {
                Severity::Warning
            }
            Self::RejectedReference { fixes, of } if *fixes as f64 > MANY * *of as f64 => {
                Severity::Warning
            }
            Self::OutagesLeftOut { outages, of, .. } if 2 * outages > *of => Severity::Warning,
            // A lever arm is in the position as it is.
            Self::FarParameter { parameter, .. } if parameter == "LeverArm" => Severity::Warning,
            Self::FarParameter { sigmas, .. } if *sigmas > VERY_FAR => Severity::Warning,
            Self::Rejected(fixes) if is_jump(fixes) => Severity::Warning,
            Self::NoisyFixes { factor } if *factor > WRONG_UNIT => Severity::Warning,
            Self::Held { length, .. } if *length > LONG => Severity::Warning,
            Self::NotDown { down } if down[2] < UPSIDE_DOWN => Severity::Warning,
            Self::Frozen { .. }
            | Self::Constant { .. }
            | Self::OutOfOrder { .. }
            | Self::SharedStamps { .. } => Severity::Warning,
            Self::WrongGravity { .. }
            | Self::WrongTurnRate { .. }
            | Self::NoTurns
            | Self::Late { .. }
            | Self::SlowSamples { .. }
            | Self::WrongVelocity { .. }
            | Self::Restart { .. }
            | Self::WrongSign { .. }
            | Self::LargeInnovations { .. }
            | Self::Disagreement { .. }
            | Self::VelocityBias { .. }
            | Self::HeadingOff { .. }
            | Self::OptimisticModel { .. }
            | Self::CorrelatedInnovations { .. }
            | Self::OptimisticDrift { .. }
            | Self::SetBack { .. }
            | Self::StartedLate { .. }
            | Self::EndsEarly { .. }
            | Self::NoMounting { .. }
            | Self::NotRun { .. }
            | Self::CoversPart { .. }
            | Self::NoReference { .. } => Severity::Warning,
            _ => Severity::Note,
        }
    }

    /// Whether this may be why a symptom is found. Times that are wrong make innovations large; they are in the standard deviations,
    /// and move neither the heading nor the antenna.
    fn explains(&self, symptom: &Self) -> bool {
        let of_times = matches!(
            self,
            Self::LateSamples { .. } | Self::FixJitter { .. } | Self::RoundedFixes { .. }
        );
        let innovations = matches!(
            symptom,
            Self::OptimisticModel { .. }
                | Self::CorrelatedInnovations { .. }
                | Self::Disagreement { .. }
                | Self::LargeInnovations { .. }
        );
        !of_times || innovations
    }

    /// Where it stands between cause and symptom: what is wrong with the logs and the settings comes before what that
    /// does to the solution.
    fn rank(&self) -> u8 {
        match self {
            Self::Diverged { .. }
            | Self::NotCompared { .. }
            | Self::NoOutage
            | Self::NotRun { all: true, .. } => 0,
            Self::Constant { .. }
            | Self::OutOfOrder { .. }
            | Self::SharedStamps { .. }
            | Self::WrongGravity { .. }
            | Self::NotDown { .. }
            | Self::WrongTurnRate { .. }
            | Self::WrongTurnAxis { .. }
            | Self::NoTurns
            | Self::Late { .. }
            | Self::WrongAxes { .. }
            | Self::WrongVelocity { .. }
            | Self::WrongSign { .. } => 1,
            Self::NoisyFixes { factor } if *factor > WRONG_UNIT => 1,
            Self::LongGaps { longest, .. } if *longest > LONG => 2,
            Self::Frozen { .. }
            | Self::Held { .. }
            | Self::SetBack { .. }
            | Self::VelocityBias { .. } => 2,
            Self::NoMounting { .. } | Self::LateSamples { .. } | Self::SlowSamples { .. } => 2,
            Self::FixJitter { .. } | Self::RoundedFixes { .. } => 2,
            Self::Rejected(fixes) if is_jump(fixes) => 2,
            Self::OptimisticModel { .. } | Self::FarParameter { .. } => 3,
            Self::CorrelatedInnovations { .. } | Self::OptimisticDrift { .. } => 4,
            Self::CoversPart { .. } | Self::OfModel { .. } => 5,
            Self::Restart { .. } | Self::HeadingOff { .. } => 5,
            Self::LargeInnovations { .. } | Self::Disagreement { .. } => 5,
            Self::OneSided(_) | Self::Rejected(_) | Self::MoreRejected { .. } => 6,
            // Stated too large: it costs little.
            Self::WrongAccuracy { factor, .. } if *factor < 1.0 => 8,
            Self::WrongAccuracy { .. } => 4,
            _ => 7,
        }
    }
}

/// Causes before symptoms; what ends a solution first of all.
pub fn ranked(mut found: Vec<Finding>) -> Vec<Finding> {
    found.sort_by_key(Finding::rank);
    found
}

/// How far a result can be trusted, and the likeliest cause where not: of ranked findings.
pub fn verdict(found: &[Finding]) -> (Severity, Option<&Finding>) {
    let severity = found.iter().map(Finding::severity).max();
    let severity = severity.unwrap_or(Severity::Note);
    let at = |level| found.iter().find(|of| of.severity() >= level);
    let worst = at(severity);
    let cause = match severity {
        Severity::Note => None,
        Severity::Unusable => {
            let mut causes = found.iter().filter(|of| of.rank() == 1);
            let surely = causes.clone().find(|of| of.severity() == severity);
            surely.or(causes.next()).or(explained(found, worst))
        }
        Severity::Warning => explained(found, worst),
    };
    (severity, cause)
}

/// What explains a finding: a fault of the logs or the settings where there is one, of what is found of the sensors or the fixes the
/// first that is doubtful itself; else the finding.
fn explained<'a>(found: &'a [Finding], worst: Option<&'a Finding>) -> Option<&'a Finding> {
    let symptom = worst?;
    let is_cause = |of: &&Finding| {
        let before = of.rank() < symptom.rank();
        let fault = of.rank() <= 2 || of.severity() > Severity::Note;
        before && fault && of.explains(symptom)
    };
    match symptom.rank() {
        0..=2 => worst,
        _ => found.iter().find(is_cause).or(worst),
    }
}

/// Whether any of them makes a result doubtful or ends it.
pub fn is_doubtful<'a>(findings: impl IntoIterator<Item = &'a Finding>) -> bool {
    let severe = |finding: &Finding| finding.severity() > Severity::Note;
    findings.into_iter().any(severe)
}

#[cfg(test)]
mod tests {
    use super::*;

    use Severity::{Note, Unusable, Warning};
    use undrift_engine::FixMend;

    fn late(delay: f64) -> Finding {
        Finding::Late { delay }
    }

    fn rejected(height: bool, gave_way: bool) -> Finding {
        Finding::Rejected(Contradiction {
            part: Part::Position,
            height,
            start: 1.0,
            end: 2.0,
            fixes: 5,
            first: 1.0,
            last: 1.0,
            growth: 0.0,
            largest: 1.0,
            frozen: false,
            gave_way,
        })
    }

    fn accuracy(factor: f64) -> Finding {
        Finding::WrongAccuracy {
            part: Part::Position,
            factor,
            adapted: false,
            correlated: false,
        }
    }

    fn held(length: f64) -> Finding {
        Finding::Held {
            axis: 1,
            value: 0.0,
            start: 0.0,
            length,
            samples: 100,
            saturated: false,
        }
    }

    fn constant(vertical: bool) -> Finding {
        Finding::Constant {
            axis: 1,
            value: 0.0,
            samples: 100,
            vertical,
        }
    }

    fn far(sigmas: f64) -> Finding {
        Finding::FarParameter {
            parameter: "lever_arm".to_owned(),
            value: 1.0,
            sigmas,
        }
    }

    fn gaps(longest: f64) -> Finding {
        Finding::LongGaps {
            gaps: 1,
            first: 0.0,
            longest,
        }
    }

    fn disagreement(overall: f64) -> Finding {
        Finding::Disagreement {
            part: undrift_engine::WindowPart::Position,
            start: 60.0,
            end: 90.0,
            inside: 0.5,
            rms: 4.0,
            overall,
            more: 0,
        }
    }

    fn not_run(all: bool) -> Finding {
        Finding::NotRun {
            models: vec!["white".to_owned()],
            all,
        }
    }

    fn drift(outside: u64, outages: u64) -> Finding {
        Finding::OptimisticDrift {
            model: "arma".to_owned(),
            inside: 0.8,
            outside,
            outages,
            tuned: false,
        }
    }

    fn of_model(what: Finding) -> Finding {
        Finding::OfModel {
            model: "white".to_owned(),
            what: Box::new(what),
        }
    }

    /// Each with its severity and its place between cause and symptom.
    #[test]
    fn a_finding_weighs_as_much_as_it_spoils_and_ranks_by_what_it_explains() {
        let axes = Finding::WrongAxes {
            forward: None,
            right: None,
            axes: None,
        };
        let out_of_order = Finding::OutOfOrder {
            log: Log::Imu,
            rows: 3,
            line: 9,
        };
        let set_back = Finding::SetBack {
            log: Log::Imu,
            line: 9,
            step: 1.0,
        };
        let left_out = |outages, of| Finding::OutagesLeftOut {
            why: crate::findings::WhyLeftOut::InGap,
            outages,
            of,
            first: 0.0,
        };
        let reference = |fixes, of| Finding::RejectedReference { fixes, of };
        let down = |z| Finding::NotDown {
            down: [0.0, 0.0, z],
        };
        let velocity = |mend| Finding::WrongVelocity { mend };
        let gravity = |ratio| Finding::WrongGravity { ratio };
        let turns = |ratio| Finding::WrongTurnRate { ratio };
        let noisy = |factor| Finding::NoisyFixes { factor };
        for (k, (finding, severity, rank)) in [
            (Finding::Diverged { time: 1.0 }, Unusable, 0),
            (Finding::NoOutage, Unusable, 0),
            (not_run(true), Unusable, 0),
            (not_run(false), Warning, 7),
            (axes, Unusable, 1),
            (Finding::WrongTurnAxis { axis: 0 }, Unusable, 1),
            (velocity(Some(FixMend::VelocityEastNorth)), Unusable, 1),
            (velocity(None), Warning, 1),
            (constant(true), Unusable, 1),
            (constant(false), Warning, 1),
            (late(3.1), Unusable, 1),
            (late(-3.1), Unusable, 1),
            (late(3.0), Warning, 1),
            (gravity(0.49), Unusable, 1),
            (gravity(2.01), Unusable, 1),
            (gravity(0.5), Warning, 1),
            (turns(2.0), Warning, 1),
            (turns(2.01), Unusable, 1),
            (down(-0.51), Warning, 1),
            (down(-0.49), Note, 1),
            (out_of_order, Warning, 1),
            (Finding::NoTurns, Warning, 1),
            (Finding::WrongSign { axis: 2 }, Warning, 1),
            (noisy(20.1), Warning, 1),
            (noisy(20.0), Note, 7),
            (gaps(1.1), Note, 2),
            (gaps(1.0), Note, 7),
            (held(1.1), Warning, 2),
            (held(1.0), Note, 2),
            (set_back, Warning, 2),
            (Finding::VelocityBias { bias: [0.0; 3] }, Warning, 2),
            (rejected(true, true), Warning, 2),
            (rejected(true, false), Note, 6),
            (rejected(false, true), Note, 6),
            (far(7.1), Warning, 3),
            (far(7.0), Note, 3),
            (
                Finding::OptimisticModel {
                    factor: 2.0,
                    tuned: false,
                },
                Warning,
                3,
            ),
            (drift(0, 20), Warning, 4),
            (drift(20, 20), Unusable, 4),
            (Finding::LargeInnovations { start: 0.0 }, Warning, 5),
            (disagreement(0.8), Warning, 5),
            (disagreement(0.79), Unusable, 5),
            (Finding::FixJitter { std: 0.02 }, Note, 2),
            (Finding::RoundedFixes { step: 1.0 }, Note, 2),
            (Finding::NoVerticalVelocity { start: 1.0 }, Note, 7),
            (of_model(late(9.0)), Warning, 5),
            (of_model(late(1.0)), Note, 5),
            (accuracy(1.5), Note, 4),
            (accuracy(1.0), Note, 4),
            (accuracy(0.9), Note, 8),
            (reference(11, 100), Warning, 7),
            (reference(10, 100), Note, 7),
            (left_out(6, 11), Warning, 7),
            (left_out(5, 10), Note, 7),
            (Finding::Bridged { gaps: 1 }, Note, 7),
            (Finding::StartedLate { time: 1.0 }, Warning, 7),
        ]
        .into_iter()
        .enumerate()
        {
            assert_eq!(finding.severity(), severity, "{k}: {finding:?}");
            assert_eq!(finding.rank(), rank, "{k}: {finding:?}");
        }
    }

    /// P(X ≥ k) of a binomial of 20 and 0.2, tables: 0.0867 for 7, 0.0321 for 8.
    #[test]
    fn more_than_a_fifth_outside_is_beyond_chance_below_a_twentieth() {
        assert!(!is_beyond_chance(7, 20) && is_beyond_chance(8, 20));
        assert!(!is_beyond_chance(0, 20) && !is_beyond_chance(0, 0));
        // Of two both: 0.04.
        assert!(is_beyond_chance(2, 2) && !is_beyond_chance(1, 2));
    }

    #[test]
    fn a_verdict_is_the_worst_severity_and_names_what_explains_it() {
        let cause = |found: &[Finding]| {
            let (severity, cause) = verdict(found);
            let cause =
                cause.map(|cause| found.iter().position(|of| std::ptr::eq(of, cause)).unwrap());
            (severity, cause)
        };
        assert_eq!(cause(&[]), (Note, None));
        assert_eq!(cause(&[gaps(5.0), accuracy(2.0)]), (Note, None));
        // A fault of the sensors explains what the solution shows, whatever it weighs itself.
        let large = Finding::LargeInnovations { start: 0.0 };
        assert_eq!(cause(&[gaps(5.0), large.clone()]), (Warning, Some(0)));
        assert_eq!(cause(&[far(9.0), large.clone()]), (Warning, Some(0)));
        assert_eq!(cause(&[far(5.0), large.clone()]), (Warning, Some(1)));
        assert_eq!(
            cause(&[gaps(5.0), held(5.0), large.clone()]),
            (Warning, Some(1))
        );
        // Late samples make innovations large; they turn no heading and move no antenna.
        let late_samples = Finding::LateSamples {
            delay: [0.1, 0.01],
            most: 1.0,
        };
        let off = Finding::HeadingOff {
            start: 1.0,
            end: 2.0,
            angle: 0.2,
            more: 0,
        };
        assert_eq!(
            cause(&[late_samples.clone(), large.clone()]),
            (Warning, Some(0))
        );
        assert_eq!(
            cause(&[late_samples.clone(), far(9.0), off.clone()]),
            (Warning, Some(1))
        );
        assert_eq!(cause(&[late_samples.clone(), off]), (Warning, Some(1)));
        // A solution that disagrees with the fixes for most of the log has a cause, too: what is doubtful itself, of the sensors or
        // the fixes.
        let ends = disagreement(0.5);
        assert_eq!(cause(std::slice::from_ref(&ends)), (Unusable, Some(0)));
        assert_eq!(
            cause(&[far(5.0), accuracy(2.0), ends.clone()]),
            (Unusable, Some(2))
        );
        assert_eq!(cause(&[far(9.0), ends.clone()]), (Unusable, Some(0)));
        assert_eq!(
            cause(&[Finding::FixJitter { std: 0.1 }, far(9.0), ends]),
            (Unusable, Some(0))
        );
        // What ends a solution is explained by a wrong setting: surely one that spoils all, else any.
        let end = Finding::Diverged { time: 1.0 };
        assert_eq!(cause(&[end.clone(), large.clone()]), (Unusable, Some(0)));
        assert_eq!(
            cause(&[end.clone(), late(1.0), large.clone()]),
            (Unusable, Some(1))
        );
        assert_eq!(
            cause(&[end.clone(), late(1.0), constant(true)]),
            (Unusable, Some(2))
        );
        let sorted = ranked(vec![
            accuracy(0.5),
            large.clone(),
            late(1.0),
            end.clone(),
            held(2.0),
        ]);
        assert_eq!(sorted, [end, late(1.0), held(2.0), large, accuracy(0.5)]);
        assert!(is_doubtful(&[gaps(5.0), late(1.0)]) && !is_doubtful(&[gaps(5.0)]));
    }

    /// Half a metre for six seconds, then accepted.
    fn jump() -> Contradiction {
        Contradiction {
            part: Part::Position,
            height: false,
            start: 100.0,
            end: 106.0,
            fixes: 7,
            first: 0.5,
            last: 0.6,
            growth: 0.017,
            largest: 0.6,
            frozen: false,
            gave_way: true,
        }
    }

    #[test]
    fn a_jump_lasts_stays_and_is_of_the_positions_alone() {
        let with = |change: fn(&mut Contradiction)| {
            let mut of = jump();
            change(&mut of);
            is_jump(&of)
        };
        assert!(with(|_| {}));
        // It came back, or the solution followed as where more than the positions contradicts it.
        assert!(!with(|of| of.gave_way = false));
        assert!(!with(|of| of.end = 105.0));
        // A solution that drifts away.
        assert!(!with(|of| of.last = 0.9));
        assert!(!with(|of| of.frozen = true));
        assert!(!with(|of| of.part = Part::Velocity));
        // Of a height the gate itself sees to that.
        assert!(with(|of| (of.height, of.end) = (true, 100.0)));
    }
}
