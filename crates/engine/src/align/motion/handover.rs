//! What a window of motion hands over to the filter: state, covariance, and what it shows of the fixes' delay.

use super::super::wahba::{DELAY, EndCovariance, Guess};
use crate::{
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

/// Standard deviation of the filter's velocity and attitude before the window determines them \[m/s, rad\].
const WIDE: f64 = 100.0;
/// Standard deviation of the time by which positions are late, in those of the filter's: logs of positions alone have
/// clocks that nothing else compares.
const LATENESS: f64 = 3.0;

/// The delay of the fixes that a window shows, of positions `alone` or of velocities, with what is known of it before \[s\], one standard
/// deviation; `None` where none is estimated.
pub(super) fn delay(settings: &Settings, alone: bool) -> Option<(Parameter, f64)> {
    let (kinds, factor): (&[Parameter], f64) = match alone {
        true => (&[Parameter::TimeOffset], LATENESS),
        false => (&[Parameter::VelocityTimeOffset, Parameter::TimeOffset], 1.0),
    };
    kinds.iter().find_map(|kind| {
        let prior = settings.parameters.prior(*kind)?;
        Some((*kind, factor * prior.std))
    })
}

/// The filter with what the window says: covariance of velocity, attitude, biases and delay, truth less estimate; the delay by which fixes are
/// `late`, and its standard deviation before \[s\].
pub(super) fn filter(
    end: &NavState,
    late: Option<(Parameter, f64, f64)>,
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
    if let Some((kind, late, std)) = late
        && let Some(at) = filter.parameter_start(kind)
    {
        filter.renew(kind, std);
        let mut error = vec![0.0; filter.states()];
        error[at] = late;
        filter.apply_correction(&error);
    }
    let velocity = Matrix3::identity() * (WIDE * WIDE);
    let correlated = [settings.fix_errors.split(&position).1, Vector3::zeros()];
    filter.set_position_velocity_covariance(&position, &velocity, &correlated);
    let (g, a) = (guess.gyro, guess.accel);
    filter.set_sensor_error(&[g.x, g.y, g.z, a.x, a.y, a.z]);

    // The window's information less the priors of biases and delay, which the filter has itself, as rows of a
    // measurement without innovation: the estimate is there already.
    let mut covariance = *covariance;
    let delay_std = late.map_or(1.0, |(.., std)| std);
    if late.is_none() {
        // Any: it is known exactly, and apart from all else.
        covariance[(DELAY, DELAY)] = delay_std * delay_std;
    }
    let mut information = covariance.try_inverse()?;
    information[(DELAY, DELAY)] -= 1.0 / (delay_std * delay_std);
    let prior = filter.sensor_error_std();
    for axis in 0..AXES {
        if prior[axis] > 0.0 {
            information[(6 + axis, 6 + axis)] -= 1.0 / (prior[axis] * prior[axis]);
        }
    }
    let eigen = ((information + information.transpose()) * 0.5).symmetric_eigen();
    let mut rows = eigen.eigenvectors.transpose();
    for i in 0..=DELAY {
        let root = eigen.eigenvalues[i].max(0.0).sqrt();
        rows.row_mut(i).scale_mut(root);
    }
    filter
        .update_window(&rows, late.map(|(kind, ..)| kind))
        .ok()?;
    filter.check().ok()?;
    Some(filter)
}
