//! How the IMU sits in the vehicle: [the engine's estimate](undrift_engine::mounting) of the beginning of a log, looked
//! at before it is navigated; and what forces and turns show where there is no solution.

mod force;

pub use force::{by_force, is_force_reversed, turn_ratio};
pub use undrift_engine::mounting::{
    FLOOR_TURNING, LONGEST_PASS, Mounting, MountingError, MountingEstimator,
};

use crate::{
    estimator::Estimator,
    replay::{Measurements, Observer, ReplayError, Samples, Settings, replay},
};
use undrift_nav::Vector3;

/// Why the mounting of a log cannot be estimated.
#[derive(Debug, thiserror::Error)]
pub enum EstimateError {
    /// The driving does not show it.
    #[error(transparent)]
    Mounting(#[from] MountingError),
    /// The log could not be navigated in sensor axes.
    #[error(transparent)]
    Replay(#[from] ReplayError),
}

/// Estimates the mounting from the first [`LONGEST_PASS`] of a log in sensor axes; `settings` must not
/// take the axes for a vehicle's ([`crate::align::Heading::Auto`]).
///
/// # Errors
/// Where the log cannot be navigated, or holds too little straight driving.
pub fn estimate(
    imu: &mut Samples,
    gnss: &mut Measurements,
    settings: &Settings,
) -> Result<Mounting, EstimateError> {
    let mut watch = MountingWatch {
        estimator: MountingEstimator::default(),
        last: None,
    };
    let mut end = None;
    let mut imu = imu.take_while(|sample| match sample {
        Ok(sample) => sample.time <= *end.get_or_insert(sample.time + LONGEST_PASS),
        Err(_) => true,
    });
    replay(&mut imu, gnss, settings, &mut watch)?;
    Ok(watch.estimator.estimate()?)
}

struct MountingWatch {
    estimator: MountingEstimator,
    last: Option<f64>,
}

impl Observer for MountingWatch {
    fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
        let nav = filter.nav();
        let std = filter.nav_std();
        if let Some(last) = self.last.replace(nav.time) {
            let attitude_std = Vector3::new(std[6], std[7], std[8]);
            let dt = (nav.time - last).min(1.0);
            self.estimator
                .add(dt, &nav.q_nb, &nav.v_n, &filter.omega_nb_b(), &attitude_std);
        }
        Ok(())
    }
}
