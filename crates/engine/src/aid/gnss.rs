//! Positions and velocities of GNSS fixes; whether they are believed is decided by [`crate::receiver`].
//!
//! A filter may have passed the time at which a fix holds, since a latency is known only in part or the fix
//! came late. Then the prediction is taken back: by `v t − ½ a t²` for a position, by `a t` for a velocity, t
//! the time since, v the antenna's velocity and a the acceleration of the last sample. The row stays that of
//! the present state.

use undrift_events::STAMP_ROUNDING;
use undrift_nav::{
    Vector3, aiding::Observation, filter::Filter, parameters::Parameter, sample::Position,
};

/// Observation of a position that holds at `due` \[s\]; the filter is there or after it. Standard deviation `correlated` of the
/// time-correlated part of its error \[m\].
///
/// Rows are those of docs/lab/measurement-rows.md; a baseline's in the base station's frame by
/// C_n^m.
pub(super) fn observe_position<const N: usize>(
    filter: &Filter<N>,
    position: &Position,
    lever_arm: &Vector3,
    correlated: &Vector3,
    due: f64,
) -> Observation<3, N> {
    let observed = filter.observe_position(position, lever_arm);
    let mut observed = filter.observe_fix_error(observed, Parameter::PositionError, correlated);
    let late = filter.nav().time - due;
    if late > STAMP_ROUNDING {
        let c_mn = observed.h.fixed_view::<3, 3>(0, 0);
        let moved =
            filter.antenna_velocity(lever_arm) * late - filter.acceleration() * (0.5 * late * late);
        observed.innovation -= c_mn * moved;
    }
    observed
}

/// Observation of a velocity `v_n` \[m/s\], north, east, down, in the same way as [`observe_position`].
///
/// The turn of the lever arm since then is not taken back: over a latency it is small.
pub(super) fn observe_velocity<const N: usize>(
    filter: &Filter<N>,
    v_n: &Vector3,
    lever_arm: &Vector3,
    correlated: &Vector3,
    due: f64,
) -> Observation<3, N> {
    let observed = filter.observe_velocity(v_n, lever_arm);
    let mut observed = filter.observe_fix_error(observed, Parameter::VelocityError, correlated);
    let late = filter.nav().time - due;
    if late > STAMP_ROUNDING {
        observed.innovation -= filter.acceleration() * late;
    }
    observed
}
