//! What the attitude of a pose does to the solution.
//!
//! The gate is wide, four and twenty standard deviations: an innovation of attitude has no usual size that it
//! is compared with.
//!
//! The attitude is that of the marker k in the frame r of the poses, `q_rk`, with its covariance
//! \[rad²\]; `q_bk` of the settings is the marker in body axes. Without a marker in the settings
//! its axes are the body's.

use crate::{aid::Aiding, estimator::Estimator, settings::Settings, summary::Summary};
use undrift_events::Aid;
use undrift_nav::{
    filter::{FilterError, Gate, Update},
    sample::GnssFix,
};

/// NIS of three numbers from which an attitude is used with less weight, and from which it is rejected: a marker that is taken for another
/// one turns by much.
const GATE: Gate = Gate {
    weaken: 16.0,
    reject: 400.0,
};

/// Updates the filter, which is at or after the time `due` \[s\] at which the fix holds, with its attitude, where it has one.
///
/// A solution that is `settling` rejects none.
///
/// `None` of a fix without an attitude, or where the filter has nothing to compare it with. Used
/// updates and rejected ones enter [`Aid::Attitude`]'s statistics.
///
/// # Errors
/// A covariance that is no covariance, or a correction that the filter refuses.
pub(super) fn update(
    filter: &mut dyn Estimator,
    fix: &GnssFix,
    due: f64,
    settling: bool,
    settings: &Settings,
    summary: &mut Summary,
) -> Option<Result<Update, FilterError>> {
    let q_bk = settings.marker.unwrap_or_default();
    let (aiding, noise) = Aiding::attitude(fix, due, q_bk, &settings.fix_errors)?;
    let mut gate = if settings.gating { GATE } else { Gate::OPEN };
    if settling {
        gate.reject = f64::INFINITY;
    }
    let update = filter.update(&aiding, &noise, &gate).transpose()?;
    if let Ok(update) = update {
        summary.innovations[Aid::Attitude].add(update);
    }
    Some(update)
}
