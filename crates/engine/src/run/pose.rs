//! What the attitude of a pose does to the solution.
//!
//! The gate is wide, four and twenty standard deviations: an innovation of attitude has no usual size that it
//! is compared with.

use crate::{
    aid::{Aid, Aiding},
    estimator::Estimator,
    settings::Settings,
    summary::Summary,
};
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
pub(super) fn update(
    filter: &mut dyn Estimator,
    fix: &GnssFix,
    due: f64,
    settings: &Settings,
    summary: &mut Summary,
) -> Option<Result<Update, FilterError>> {
    let (q_rk, noise) = fix.attitude?;
    let q_bk = settings.marker.unwrap_or_default();
    let aiding = Aiding::Attitude { q_rk, q_bk, due };
    let gate = if settings.gating { GATE } else { Gate::OPEN };
    let update = filter.update(&aiding, &noise, &gate).transpose()?;
    if let Ok(update) = update {
        summary.innovations[Aid::Attitude].add(update);
    }
    Some(update)
}
