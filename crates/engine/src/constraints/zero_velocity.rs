//! A vehicle at rest: no velocity, and no rate but the Earth's.
//!
//! A vehicle that starts so softly that its sensors stay quiet is the case that hurts: a rest that GNSS does
//! not confirm has ten times the standard deviation, and one after which the solution already moves by more
//! than chance (χ² of three at 10⁻⁴) is taken for a start and not used.
//!
//! Two observations a block: v_n = 0, three numbers with the configured standard deviation [m/s];
//! and the mean rate of the block, which is the Earth's plus the gyros' errors, with σ² =
//! N²/T_block + the configured one squared [rad²/s²]. The first ties velocity and tilt, the second
//! the gyro bias.

use super::{constrain, isotropic};
use crate::{
    aid::Aiding, estimator::Estimator, rest::RestBlock, settings::Settings, summary::Summary,
};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::Aid;
use undrift_nav::{Matrix3, Vector3, earth::EARTH_RATE, filter::Outcome, parameters::Parameter};

/// What the standard deviation of a rest is multiplied by that only the sensors see: a soft start has begun before it
/// shows.
const REST_UNCONFIRMED: f64 = 10.0;
/// Standard deviation of the heading up to which the Earth's rate corrects it \[rad\].
const MOST_HEADING: f64 = 0.1;
/// NIS from which a rest that only the sensors confirm is a start: χ² of three at p = 10⁻⁴.
const REJECT_REST: f64 = 21.1;

/// What the sensors should read at rest: rate \[rad/s\] and specific force \[m/s²\].
///
/// Their predicted errors, the Earth's rate, and the reaction to gravity in the attitude of the solution.
///
/// Rate in body axes: predicted gyro error + C_n^b ω_ie; force: predicted accelerometer error −
/// C_n^b g.
pub(crate) fn readings(filter: &dyn Estimator) -> (Vector3, Vector3) {
    let error = filter.sensor_error();
    let [gyro, accel] = [0, 3].map(|i| Vector3::new(error[i], error[i + 1], error[i + 2]));
    let place = &filter.nav().position;
    let earth_rate = undrift_nav::earth::earth_rate_n(place.lat);
    let up = -undrift_nav::earth::gravity(place.lat, place.height) * Vector3::z();
    let c_nb = filter.nav().q_nb.to_rotation_matrix().into_inner();
    (gyro + c_nb.tr_mul(&earth_rate), accel + c_nb.tr_mul(&up))
}

/// Normalised innovation squared of a rest, by the diagonal of the velocity's covariance.
///
/// Without correlations between axes: a rough test, three degrees of freedom.
pub(crate) fn nis_of_rest(filter: &dyn Estimator, std: f64) -> f64 {
    let (v_n, sigma) = (&filter.nav().v_n, filter.nav_std());
    let term = |i: usize| v_n[i].powi(2) / (sigma[3 + i].powi(2) + std * std);
    (0..3).map(term).sum()
}

/// Updates at the end of a block; whether the vehicle stood.
///
/// `stood` is whether the block before was a rest that was used at full weight. A start that is
/// recognised keeps it set, so that the next block is judged as strictly.
pub(crate) fn update(
    filter: &mut dyn Estimator,
    block: &RestBlock,
    stood: &mut bool,
    settings: &Settings,
    summary: &mut Summary,
) -> bool {
    let mut rest = block.rest;
    // A bias that wanders by more than modelled would turn the heading of a magnetometer.
    let by_field = filter.parameters().prior(Parameter::HardIron).is_some();
    let unknown = by_field && filter.nav_std()[8] > MOST_HEADING;
    // A velocity that has come up since it stood is a start.
    let starts = *stood && rest && !block.confirmed;
    *stood = false;
    if let Some(std) = settings.constraints.zero_velocity.filter(|_| rest) {
        if starts && nis_of_rest(filter, std) > REJECT_REST {
            *stood = true;
            return false;
        }
        // What only the sensors see may be a start so soft that it does not show yet.
        let unsure = if block.confirmed {
            1.0
        } else {
            REST_UNCONFIRMED
        };
        let noise = isotropic(std * unsure);
        if let Some(done) = constrain(filter, &Aiding::ZeroVelocity, &noise) {
            // A solution that is sure to move is believed.
            rest = done.outcome != Outcome::Rejected;
            // One that is weakened had not detected the rest before.
            *stood = done.outcome == Outcome::Used;
            summary.innovations[Aid::ZeroVelocity].add(done);
        }
    }
    if let Some(std) = settings.constraints.zero_angular_rate.filter(|_| rest) {
        let (aiding, unknown) = match unknown {
            true => (Aiding::NoTurn(block.rate), EARTH_RATE),
            false => (Aiding::EarthRate(block.rate), 0.0),
        };
        let noise = Vector3::from_fn(|i, _| {
            let axis = &settings.sensors[i];
            axis.r * axis.interval / block.duration + std * std + unknown * unknown
        });
        let _ = constrain(filter, &aiding, &Matrix3::from_diagonal(&noise));
    }
    rest
}
