//! Attitudes of a marker that motion capture, a camera or a laser scanner follows.
//!
//! A pose is a fix with an attitude: its position is a baseline from the origin of the poses' frame, whose axes are taken for north, east,
//! down. Position and attitude hold at the same time and are cut together.

use undrift_events::STAMP_ROUNDING;
use undrift_nav::{Quaternion, aiding::Observation, filter::Filter};

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
