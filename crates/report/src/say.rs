//! Sentences of findings: one place for terminal, report and Python.
//!
//! A sentence begins with a small letter and has no full stop, so that it can stand after a name.

mod cut;
mod event;
mod fixes;
mod logs;
mod noise;
pub(crate) mod poses;
mod recording;
mod sensors;
mod solution;
mod start;
pub(crate) mod words;

pub use event::event;
pub use noise::{arma, stationarity};
pub(crate) use noise::{fit, record};
pub use recording::{guessed, refused, repeated, slower, stamps};
pub(crate) use solution::usable;
pub use solution::{cause, ended, hindsight, verdict, verdict_of};
pub(crate) use start::mounted;
pub use start::{alignment, estimated, found, mounting, unsolved};

use undrift_results::findings::Finding;

/// Why an experiment with outages has no result, where there is an outage.
pub const NO_MODEL: &str = "no model could be run";

/// Why an experiment with outages has no result.
pub fn no_result(findings: &[Finding]) -> String {
    let is_why = |of: &&Finding| match of {
        Finding::NoOutage | Finding::NotRun { all: true, .. } => true,
        Finding::OutagesLeftOut(of) => of.is_all(),
        _ => false,
    };
    let why = findings.iter().find(is_why);
    why.map_or_else(|| cut::NO_OUTAGE.into(), say)
}

/// What is wrong with the share of each drive that a tuning holds out, by the name of its option.
pub fn hold_out(option: &str, share: Option<f64>) -> Option<String> {
    let share = share.filter(|share| !(0.0..=0.9).contains(share))?;
    Some(format!(
        "{option} {share}: must be 0 to 0.9, a share of each drive"
    ))
}

/// The sentences of findings.
pub fn all(findings: &[Finding]) -> Vec<String> {
    findings.iter().map(say).collect()
}

/// The sentence of a finding.
pub fn say(finding: &Finding) -> String {
    use Finding as F;
    match finding {
        F::Diverged { time } => solution::diverged(*time),
        F::NotCompared {
            why,
            truth,
            started,
            ended,
        } => solution::not_compared(*why, *truth, *started, *ended),
        F::Bridged { gaps } => solution::bridged(*gaps),
        F::Temperature(of) => sensors::temperature(of),
        F::LongGaps {
            gaps,
            first,
            longest,
        } => solution::long_gaps(*gaps, *first, *longest),
        F::NoMounting {
            driving,
            wander,
            std,
        } => start::no_mounting(*driving, *wander, *std),
        F::WithoutGnss { start, length } => solution::without_gnss(*start, *length),
        F::EndsEarly(of) => solution::ends_early(of.end, of.missing),
        F::Restart { time, why, resumed } => solution::restart(*time, *why, *resumed),
        F::LargeInnovations { start } => solution::large_innovations(*start),
        F::Disagreement {
            part,
            start,
            end,
            inside,
            rms,
            more,
            ..
        } => solution::disagreement(*part, [*start, *end], [*inside, *rms], *more),
        F::StartedLate { time } => solution::started_late(*time),
        F::NoReference { outages } => solution::no_reference(*outages),
        F::Frozen { .. } | F::Held { .. } | F::Constant { .. } => sensors::still(finding),
        F::Copied { axes } => sensors::copied(*axes),
        F::Wrapped(of) => sensors::wrapped(of),
        F::SensorChanged(change) => sensors::changed(change),
        F::Mismatch { what } => sensors::mismatch(what),
        F::NoisyHeights { factor } => fixes::noisy_heights(*factor),
        F::VelocityScale { ratio } => fixes::velocity_scale(*ratio),
        F::WrongGravity { ratio, exchanged } => sensors::wrong_gravity(*ratio, *exchanged),
        F::Poses(of) => poses::fault(&of.fault, of.mended),
        F::NotDown { down } => sensors::not_down(*down),
        F::WrongTurnRate { ratio } => sensors::wrong_turn_rate(*ratio),
        F::WrongTurnAxis { axis } => sensors::wrong_turn_axis(*axis),
        F::NoTurns => sensors::NO_TURNS.into(),
        F::Late { delay } => sensors::late(*delay),
        F::WrongAxes {
            forward,
            right,
            axes,
        } => sensors::wrong_axes(*forward, *right, axes.as_deref()),
        F::Spikes {
            axis,
            samples,
            start,
        } => sensors::spikes(*axis, *samples, *start),
        F::MovingAverageSign { axes } => sensors::moving_average_sign(axes),
        F::GuessedRate { rate } => sensors::guessed_rate(*rate),
        F::SlowSamples { rate, factor } => sensors::slow_samples(*rate, *factor),
        F::LateSamples { delay, most } => sensors::late_samples(*delay, *most),
        F::RejectedHeadings { longest, more } => sensors::rejected_headings(longest, *more),
        F::DisturbedField(field) => sensors::disturbed_field(field),
        F::HeadingOff {
            start,
            end,
            angle,
            more,
        } => sensors::heading_off([*start, *end], *angle, *more),
        F::OptimisticModel { factor, tuned } => sensors::optimistic_model(*factor, *tuned),
        F::OptimisticDrift {
            model,
            inside,
            outside,
            outages,
            tuned,
        } => sensors::optimistic_drift(model, *inside, [*outside, *outages], *tuned),
        F::RejectedReference { fixes, of } => cut::rejected_reference(*fixes, *of),
        F::OutagesLeftOut(of) => cut::left_out(of),
        F::NoOutage => cut::NO_OUTAGE.into(),
        F::NotRun { models, all, why } => cut::not_run(models, *all, why.as_deref()),
        F::OfModel { model, what } => format!("{model}: {}", say(what)),
        F::CoversPart { from, to, log } => solution::covers_part([*from, *to], *log),
        F::CorrelatedInnovations {
            part,
            correlation,
            tuned,
        } => fixes::correlated_innovations(*part, *correlation, *tuned),
        F::FarParameter(of) => sensors::far_parameter(&of.parameter, of.value, of.sigmas),
        F::RepeatedFixes { fixes, interval } => fixes::repeated(*fixes, *interval),
        F::RoundedFixes { step } => fixes::rounded(*step),
        F::FixJitter { std } => fixes::jitter(*std),
        F::CorrelatedFixes { share, time } => fixes::correlated(*share, *time),
        F::NoisyFixes { factor } => fixes::noisy(*factor),
        F::UnexplainedForce { excess } => start::unexplained_force(*excess),
        F::NoVerticalVelocity { start } => fixes::no_vertical_velocity(*start),
        F::SideSlip { start, speed } => fixes::side_slip(*start, *speed),
        F::ModestVelocity { factor } => fixes::modest_velocity(*factor),
        F::VelocityBias { bias } => fixes::velocity_bias(*bias),
        F::BadCovariance { fixes } => fixes::bad_covariance(*fixes),
        F::WrongVelocity { mend } => fixes::wrong_velocity(*mend),
        F::TwoReceivers { distance } => fixes::two_receivers(*distance),
        F::Rejected(fixes) => fixes::rejected(fixes),
        F::MoreRejected { spans, accepted } => fixes::more_rejected(*spans, *accepted),
        F::OneSided(lean) => fixes::one_sided(lean),
        F::WrongSign { axis } => fixes::wrong_sign(*axis),
        F::WrongAccuracy {
            part,
            factor,
            adapted,
            correlated,
        } => fixes::wrong_accuracy(*part, *factor, *adapted, *correlated),
        F::Skipped { log, .. }
        | F::OutOfOrder { log, .. }
        | F::SharedStamps { log, .. }
        | F::SetBack { log, .. }
        | F::Gaps { log, .. }
        | F::Unused { log }
        | F::Outliers { log, .. } => logs::sentence(*log, finding),
        F::Uneven {
            gaps,
            jitter_rms,
            interval,
        } => logs::uneven(*gaps, *jitter_rms, *interval),
    }
}

#[cfg(test)]
mod tests;
