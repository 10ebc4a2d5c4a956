//! Attitudes of a marker that motion capture, a camera or a laser scanner follows.
//!
//! A pose is a fix with an attitude: its position is a baseline from the origin of the poses' frame, whose axes are taken for north, east,
//! down. Position and attitude hold at the same time and are cut together.

use super::{Aid, Aiding, STAMP_ROUNDING};
use crate::{estimator::Estimator, settings::Settings, summary::Summary};
use undrift_nav::{
    Quaternion,
    aiding::Observation,
    filter::{Filter, FilterError, Gate, Update},
    sample::GnssFix,
};

/// NIS of three numbers from which an attitude is used with less weight, and from which it is rejected: a marker that is taken for another
/// one turns by much.
const GATE: Gate = Gate {
    weaken: 16.0,
    reject: 400.0,
};

/// Observation of an attitude that holds at `due` \[s\]; the filter is there or after it.
pub(super) fn observe_attitude<const N: usize>(
    filter: &Filter<N>,
    q_rk: &Quaternion,
    q_bk: &Quaternion,
    due: f64,
) -> Observation<3, N> {
    let mut observed = filter.observe_attitude(q_rk, q_bk);
    let late = filter.nav().time - due;
    if late > STAMP_ROUNDING {
        observed.innovation += filter.c_nb() * filter.omega_nb_b() * late;
    }
    observed
}

/// Updates the filter, which is at or after the time `due` \[s\] at which the fix holds, with its attitude, where it has one.
pub(crate) fn update(
    filter: &mut dyn Estimator,
    fix: &GnssFix,
    due: f64,
    settings: &Settings,
    summary: &mut Summary,
) -> Option<Result<Update, FilterError>> {
    let (q_rk, noise) = fix.attitude?;
    let q_bk = settings.marker;
    let aiding = Aiding::Attitude { q_rk, q_bk, due };
    let gate = if settings.gating { GATE } else { Gate::OPEN };
    let update = filter.update(&aiding, &noise, &gate).transpose()?;
    if let Ok(update) = update {
        summary.innovations[Aid::Attitude].add(update);
    }
    Some(update)
}
