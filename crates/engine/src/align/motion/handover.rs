//! The filter that goes on from a window.

use super::WIDE;
use crate::{
    align::wahba::{EndCovariance, Guess},
    estimator::{self, Estimator},
    settings::Settings,
};
use alloc::{boxed::Box, vec};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{
    Matrix3, Vector3, covariance::AXES, filter::InitialStd, mechanisation::NavState,
    parameters::Parameter, sample::GnssFix,
};

/// The filter with what the window says: covariance of velocity, attitude and biases, truth less estimate, and by how much
/// fixes are late with its standard deviation \[s\].
pub(super) fn filter(
    end: &NavState,
    late: Option<(f64, f64)>,
    fix: &GnssFix,
    guess: &Guess,
    covariance: &EndCovariance,
    settings: &Settings,
) -> Option<Box<dyn Estimator>> {
    let (_, position) = fix.position?;
    let std = InitialStd {
        position: Vector3::repeat(1.0),
        velocity: Vector3::repeat(WIDE),
        attitude: Vector3::repeat(WIDE),
    };
    let parameters = settings.worthwhile(&position);
    let mut filter = estimator::build(*end, &std, &settings.sensors, parameters).ok()?;
    if let (Some((late, std)), Some(at)) = (late, parameters.start(Parameter::TimeOffset)) {
        filter.renew(Parameter::TimeOffset, std);
        let mut error = vec![0.0; filter.states()];
        error[filter.sensors().states() + at] = late;
        filter.apply_correction(&error);
    }
    let velocity = Matrix3::identity() * (WIDE * WIDE);
    let correlated = [settings.fix_errors.split(&position).1, Vector3::zeros()];
    filter.set_position_velocity_covariance(&position, &velocity, &correlated);
    let (g, a) = (guess.gyro, guess.accel);
    filter.set_sensor_error(&[g.x, g.y, g.z, a.x, a.y, a.z]);

    // The window's information less the prior of the biases, which the filter has itself, as rows of a
    // measurement without innovation: the estimate is there already.
    let mut information = covariance.try_inverse()?;
    let prior = filter.sensor_error_std();
    for axis in 0..AXES {
        if prior[axis] > 0.0 {
            information[(6 + axis, 6 + axis)] -= 1.0 / (prior[axis] * prior[axis]);
        }
    }
    let eigen = ((information + information.transpose()) * 0.5).symmetric_eigen();
    let mut rows = eigen.eigenvectors.transpose();
    for i in 0..12 {
        let root = eigen.eigenvalues[i].max(0.0).sqrt();
        rows.row_mut(i).scale_mut(root);
    }
    filter.update_window(&rows).ok()?;
    filter.check().ok()?;
    Some(filter)
}
