//! How much findings weigh, and what they conclude together.

use super::{Finding, Log, Severity};
use crate::tune;
use statrs::distribution::{Binomial, DiscreteCDF};
use std::ops::RangeInclusive;
use undrift_noise::ImuModel;

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
            Self::FarParameter { sigmas, .. } if *sigmas > VERY_FAR => Severity::Warning,
            // Heights before and after do not fit together.
            Self::Rejected(fixes) if fixes.height && fixes.gave_way => Severity::Warning,
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
            | Self::WrongVelocity { .. }
            | Self::Restart { .. }
            | Self::WrongSign { .. }
            | Self::LargeInnovations { .. }
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
            Self::NoMounting { .. } => 2,
            Self::Rejected(fixes) if fixes.height && fixes.gave_way => 2,
            Self::OptimisticModel { .. } | Self::FarParameter { .. } => 3,
            Self::CorrelatedInnovations { .. } | Self::OptimisticDrift { .. } => 4,
            Self::CoversPart { .. } | Self::OfModel { .. } => 5,
            Self::Restart { .. } | Self::HeadingOff { .. } | Self::LargeInnovations { .. } => 5,
            Self::OneSided(_) | Self::Rejected(_) | Self::MoreRejected { .. } => 6,
            // Stated too large: it costs little.
            Self::WrongAccuracy { factor, .. } if *factor < 1.0 => 8,
            Self::WrongAccuracy { .. } => 4,
            _ => 7,
        }
    }
}

/// The findings of a drive with this noise model: what was tuned on drives needs no tuning.
pub fn of_model(mut found: Vec<Finding>, model: Option<&ImuModel>) -> Vec<Finding> {
    let is_tuned = model.is_some_and(tune::is_tuned);
    for of in &mut found {
        if let Finding::OptimisticModel { tuned, .. }
        | Finding::CorrelatedInnovations { tuned, .. }
        | Finding::OptimisticDrift { tuned, .. } = of
        {
            *tuned = is_tuned;
        }
    }
    found
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
    let cause = match severity {
        Severity::Note => None,
        Severity::Unusable => {
            let mut causes = found.iter().filter(|of| of.rank() == 1);
            let surely = causes.clone().find(|of| of.severity() == severity);
            surely.or(causes.next()).or(at(severity))
        }
        Severity::Warning => {
            let worst = at(severity);
            // A fault of the sensors explains what the solution shows.
            let fault = found.iter().find(|of| of.rank() <= 2);
            match worst {
                Some(of) if of.rank() > 2 => fault.or(worst),
                _ => worst,
            }
        }
    };
    (severity, cause)
}

/// Whether any of them makes a result doubtful or ends it.
pub fn is_doubtful<'a>(findings: impl IntoIterator<Item = &'a Finding>) -> bool {
    let severe = |finding: &Finding| finding.severity() > Severity::Note;
    findings.into_iter().any(severe)
}
