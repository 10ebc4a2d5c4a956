//! Attitudes of a marker that motion capture, a camera or a laser scanner follows.
//!
//! A pose is a fix with an attitude: its position is a baseline from the origin of the poses' frame, whose axes are taken for north, east,
//! down. Position and attitude hold at the same time and are cut together.

use super::Aiding;
use undrift_events::{STAMP_ROUNDING, fix_errors::FixErrors};
use undrift_nav::{
    Matrix3, Quaternion, Vector3, aiding::Observation, filter::Filter, parameters::Parameter,
    sample::GnssFix,
};

impl Aiding {
    /// The position of a fix whose covariance has the `errors` in it, as the filter is updated with it, and the covariance of the white
    /// part of its error \[m²\].
    pub fn position(
        fix: &GnssFix,
        due: f64,
        lever_arm: Vector3,
        errors: &FixErrors,
    ) -> Option<(Self, Matrix3)> {
        let (position, noise) = fix.position?;
        let (white, correlated) = errors.split(&noise);
        let aiding = Self::Position {
            position,
            lever_arm,
            correlated,
            due,
        };
        Some((aiding, white))
    }

    /// The same of a pose's attitude, of a marker whose axes lie in the body as `q_bk` says \[rad²\].
    pub fn attitude(
        fix: &GnssFix,
        due: f64,
        q_bk: Quaternion,
        errors: &FixErrors,
    ) -> Option<(Self, Matrix3)> {
        let (q_rk, noise) = fix.attitude?;
        let (white, correlated) = errors.split_velocity(&noise);
        let aiding = Self::Attitude {
            q_rk,
            q_bk,
            correlated,
            due,
        };
        Some((aiding, white))
    }
}

/// Observation of an attitude that holds at `due` \[s\]; the filter is there or after it. Standard deviation `correlated` of the
/// time-correlated part of its error, about the axes of the poses' frame \[rad\]: a pose has no velocity, so the states are those of the
/// velocity's error, with the other sign.
pub(super) fn observe_attitude<const N: usize>(
    filter: &Filter<N>,
    q_rk: &Quaternion,
    q_bk: &Quaternion,
    correlated: &Vector3,
    due: f64,
) -> Observation<3, N> {
    let observed = filter.observe_attitude(q_rk, q_bk);
    let mut observed = filter.observe_fix_error(observed, Parameter::VelocityError, correlated);
    let late = filter.nav().time - due;
    if late > STAMP_ROUNDING {
        observed.innovation += filter.c_nb() * filter.omega_nb_b() * late;
    }
    observed
}
