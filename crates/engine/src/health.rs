//! Whether the covariance of a filter is still symmetric and positive definite after a long log.

use crate::estimator::Estimator;
use alloc::vec::Vec;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use nalgebra::DMatrix;
use undrift_events::CovarianceHealth;

/// State of a filter's present covariance. Costs the eigenvalues of a matrix of its states: for the end of a run, not for every step.
///
/// ```
/// use undrift_engine::{Navigator, covariance_health, settings::Settings};
/// # use undrift_nav::shaping::ShapingFilter;
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
/// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
/// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
/// # let mut navigator = Navigator::new(Settings::new(sensors));
/// # for fix in &log.gnss {
/// #     navigator.fix(*fix)?;
/// # }
/// # for sample in &log.imu {
/// #     navigator.imu(*sample)?;
/// # }
/// let health = covariance_health(navigator.filter().expect("aligned"));
/// assert_eq!(health.states, 9); // White noise alone: no states of sensors.
/// assert!(health.asymmetry < 1e-12 && health.least_eigenvalue > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn covariance_health(filter: &dyn Estimator) -> CovarianceHealth {
    let p = filter.covariance();
    let kept: Vec<usize> = (0..filter.states()).filter(|i| p[(*i, *i)] > 0.0).collect();
    let scaled = DMatrix::from_fn(kept.len(), kept.len(), |i, j| {
        let (i, j) = (kept[i], kept[j]);
        p[(i, j)] / (p[(i, i)].sqrt() * p[(j, j)].sqrt())
    });
    let asymmetry = (&scaled - scaled.transpose()).amax();
    let eigenvalues = scaled.symmetric_eigenvalues();
    CovarianceHealth {
        states: kept.len(),
        asymmetry,
        least_eigenvalue: eigenvalues.min(),
    }
}

#[cfg(test)]
mod tests;
