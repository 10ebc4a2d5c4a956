//! How much findings weigh, and what they conclude together.

use super::{Finding, Log, Severity};
use crate::inspect::PoseFault;
use statrs::distribution::{Binomial, DiscreteCDF};
use std::ops::RangeInclusive;
use undrift_events::{ChangeOf, Contradiction, Mismatch, Part, WindowPart};

/// Prior standard deviations beyond which an estimated parameter is no parameter any more.
const VERY_FAR: f64 = 7.0;
/// Share of the innovations inside three standard deviations in the whole log from which a disagreement is one of a span.
const ELSEWHERE: f64 = 0.9;
/// A scatter this many times what is stated is a wrong unit rather than a modest receiver.
const WRONG_UNIT: f64 = 20.0;
/// Measured over true, beyond which no scale factor but a wrong unit, sign or column explains a sensor.
const RIGHT_UNIT: RangeInclusive<f64> = 0.5..=2.0;
/// An axis that holds a value for longer has a fault, and a log that has no samples \[s\].
const LONG: f64 = 1.0;
/// A scatter this many times what is stated comes before what it does to the solution.
const SCATTERS: f64 = 3.0;
/// A heading that is further off than this is that of another axis \[rad\].
const MOVED: f64 = 0.5;
/// One that stays so far off \[rad\] for so long \[s\] was wrong before or is now.
const TURNED: f64 = 0.1;
const LASTS: f64 = 60.0;
/// Velocities that are later than this \[s\] are behind a filter, of which a delay is a part.
const LAGS: f64 = 0.2;
/// An IMU that nods by more than this \[rad\] shows neither the vehicle's attitude nor where the antenna is.
const LOOSE: f64 = 0.035;
/// Accelerometers that are further from the gyros than this \[s\] turn the attitude in every manoeuvre.
const APART: f64 = 0.15;
/// Samples that came from the wrong end of the range, up to which they are treated as spikes are.
const FEW_JUMPS: u64 = 10;
/// Beyond this part of it a velocity is another quantity or in another unit.
const FAR_SCALE: f64 = 0.15;
/// Clocks that are further apart are two, and not one with a delay \[s\].
const TWO_CLOCKS: f64 = 0.6;
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

/// Steady errors of more than this \[m\] are a jump however soon the solution followed: within seconds nothing drifts as far.
const FAR: f64 = 30.0;
/// Innovations so many times their predicted size by too few samples leave no solution.
const FAR_TOO_LARGE: f64 = 10.0;

/// Whether the positions, or their heights alone, jumped and stayed where they went while nothing else did: those before and those
/// after do not fit together.
pub fn is_jump(of: &Contradiction) -> bool {
    let steady = (of.last - of.first).abs() < 0.5 * of.largest;
    let lasted = of.end - of.start > FOLLOWS;
    let moved = of.part == Part::Position && of.accepted_in_the_end && !of.frozen;
    moved && (of.height || steady && (lasted || of.largest > FAR))
}

/// A marker that turned by more than this \[deg\], or moved by more \[m\], is another one.
const OTHER_MARKER: (f64, f64) = (3.0, 0.02);

/// Poses that are away for longer \[s\] are followed.
const AWAY: f64 = 1.0;

/// How much what is wrong with poses weighs.
fn of_poses(fault: &PoseFault, mended: bool) -> Severity {
    let of_marker = |angle: f64, distance: f64| {
        let small = angle < OTHER_MARKER.0 && distance < OTHER_MARKER.1;
        match small || mended {
            true => Severity::Warning,
            false => Severity::Unusable,
        }
    };
    match fault {
        PoseFault::Slipped {
            angle_deg,
            distance_m,
            ..
        } => of_marker(*angle_deg, *distance_m),
        PoseFault::Shifted { distance_m, .. } => of_marker(0.0, *distance_m),
        PoseFault::Slid { angle_deg, .. }
        | PoseFault::Jumped {
            angle_deg,
            lasting: true,
            ..
        } => of_marker(*angle_deg, 0.0),
        // What was seen as the marker then was something else.
        PoseFault::Jumped { time, end, .. } if end - time > AWAY => Severity::Warning,
        PoseFault::Jumped { .. }
        | PoseFault::Frozen { .. }
        | PoseFault::Piece { .. }
        | PoseFault::NoAttitudes => Severity::Note,
        PoseFault::TooShort { .. }
        | PoseFault::Still { .. }
        | PoseFault::OneAxis
        | PoseFault::NoPositions => Severity::Warning,
        _ if mended => Severity::Note,
        _ => Severity::Unusable,
    }
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
            Self::WrongVelocity { mend: Some(_) } | Self::TwoReceivers { .. } => Severity::Unusable,
            Self::Constant { vertical: true, .. } => Severity::Unusable,
            Self::Poses(of) => of_poses(&of.fault, of.mended),
            // A vehicle that begins to move across its axis turns its course without its gyros.
            Self::SensorChanged(change) if change.what == ChangeOf::NoTurn => Severity::Warning,
            Self::Copied { .. } | Self::SensorChanged(_) => Severity::Unusable,
            Self::Mismatch { what } => match what {
                Mismatch::Nods(angle) if *angle > LOOSE => Severity::Unusable,
                Mismatch::LateAccelerometers(delay) if *delay > APART => Severity::Unusable,
                Mismatch::LateVelocities {
                    beyond: Some(_), ..
                } => Severity::Unusable,
                Mismatch::LateVelocities { delay, .. } if *delay <= LAGS => Severity::Note,
                Mismatch::HeldPositions(_) => Severity::Note,
                _ => Severity::Warning,
            },
            Self::Wrapped(of) if of.jumps > FEW_JUMPS => Severity::Unusable,
            Self::VelocityScale { ratio, .. } if (ratio[0] - 1.0).abs() > FAR_SCALE => {
                Severity::Unusable
            }
            // Most of what the sensors measured is missing.
            Self::SharedStamps { log: Log::Imu, .. } => Severity::Unusable,
            Self::Late { delay } if delay.abs() > TWO_CLOCKS => Severity::Unusable,
            Self::WrongGravity {
                exchanged: true, ..
            } => Severity::Unusable,
            Self::WrongGravity { ratio, .. } | Self::WrongTurnRate { ratio }
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
            Self::OutagesLeftOut(of) if of.is_all() => Severity::Unusable,
            Self::OutagesLeftOut(left) if 2 * left.outages > left.of => Severity::Warning,
            Self::SlowSamples {
                factor: Some(factor),
                ..
            } if *factor > FAR_TOO_LARGE => Severity::Unusable,
            // A lever arm is in the position as it is.
            Self::FarParameter(of) if of.parameter == "LeverArm" => Severity::Warning,
            Self::FarParameter(of) if of.sigmas > VERY_FAR => Severity::Warning,
            Self::Rejected(fixes) if is_jump(fixes) => Severity::Warning,
            Self::NoisyFixes { factor } | Self::NoisyHeights { factor } if *factor > WRONG_UNIT => {
                Severity::Warning
            }
            Self::HeadingOff { angle, .. } if angle.abs() > MOVED => Severity::Unusable,
            Self::HeadingOff {
                start, end, angle, ..
            } if angle.abs() > TURNED && end - start > LASTS => Severity::Unusable,
            Self::Held { length, .. } if *length > LONG => Severity::Warning,
            Self::NotDown { down } if down[2] < UPSIDE_DOWN => Severity::Warning,
            Self::Frozen { .. }
            | Self::Constant { .. }
            | Self::Wrapped { .. }
            | Self::VelocityScale { .. }
            | Self::OutOfOrder { .. }
            | Self::SharedStamps { .. } => Severity::Warning,
            Self::WrongGravity { .. }
            | Self::WrongTurnRate { .. }
            | Self::NoTurns
            | Self::SideSlip { .. }
            | Self::Late { .. }
            | Self::SlowSamples { .. }
            | Self::GuessedRate { .. }
            | Self::MovingAverageSign { .. }
            | Self::WrongVelocity { .. }
            | Self::Restart { .. }
            | Self::WrongSign { .. }
            | Self::LargeInnovations { .. }
            | Self::Disagreement { .. }
            | Self::VelocityBias { .. }
            | Self::HeadingOff { .. }
            | Self::RejectedHeadings { .. }
            | Self::DisturbedField(_)
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
        // What is late is late from end to end, and its heights are not.
        let elsewhere = match symptom {
            Self::Disagreement { part, overall, .. } => {
                *part == WindowPart::Height || *overall > ELSEWHERE
            }
            _ => false,
        };
        let of_offset = matches!(self, Self::LateSamples { .. });
        !of_times || innovations && !(of_offset && elsewhere)
    }

    /// Rank from cause to symptom: what is wrong with the logs and the settings comes before what that
    /// does to the solution.
    fn rank(&self) -> u8 {
        match self {
            Self::Diverged { .. }
            | Self::NotCompared { .. }
            | Self::NoOutage
            | Self::NotRun { all: true, .. } => 0,
            Self::Copied { .. } | Self::Wrapped { .. } => 1,
            Self::Poses(_) if self.severity() > Severity::Note => 1,
            Self::Mismatch { .. } => 2,
            Self::SensorChanged { .. } | Self::VelocityScale { .. } => 1,
            Self::OutagesLeftOut(of) if of.is_all() => 0,
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
            | Self::SlowSamples { .. }
            | Self::MovingAverageSign { .. }
            | Self::TwoReceivers { .. }
            | Self::WrongSign { .. } => 1,
            Self::NoisyFixes { factor } if *factor > WRONG_UNIT => 1,
            Self::LongGaps { longest, .. } if *longest > LONG => 2,
            Self::Frozen { .. }
            | Self::Held { .. }
            | Self::SetBack { .. }
            | Self::VelocityBias { .. } => 2,
            Self::NoMounting { .. } | Self::LateSamples { .. } => 2,
            Self::SideSlip { .. } => 2,
            Self::FixJitter { .. } | Self::RoundedFixes { .. } => 2,
            Self::NoisyFixes { factor } | Self::NoisyHeights { factor } if *factor > SCATTERS => 2,
            Self::Rejected(fixes) if is_jump(fixes) => 2,
            Self::OptimisticModel { .. } | Self::FarParameter { .. } => 3,
            Self::CorrelatedInnovations { .. } | Self::OptimisticDrift { .. } => 4,
            Self::CoversPart { .. } | Self::OfModel { .. } | Self::GuessedRate { .. } => 5,
            Self::Restart { .. } | Self::HeadingOff { .. } => 5,
            Self::LargeInnovations { .. } | Self::Disagreement { .. } => 5,
            Self::OneSided(_) | Self::Rejected(_) | Self::MoreRejected { .. } => 6,
            Self::RejectedHeadings { .. } => 6,
            Self::DisturbedField(_) => 7,
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
mod tests;
