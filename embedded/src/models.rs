//! Two models of the recorded sensors' errors.

use undrift_nav::shaping::{ShapingError, ShapingFilter};

/// States of the filter with [`random_walk`]: 9 for navigation and one an axis.
pub const RANDOM_WALK_STATES: usize = 15;
/// States of the filter with [`arma`]: 9 for navigation and three an axis.
pub const ARMA_STATES: usize = 27;

/// Gyro x, y, z [rad/s] and accelerometer x, y, z [m/s²].
pub type Sensors = [ShapingFilter; 6];

/// White noise and a bias that wanders from its turn-on value: one state an axis.
///
/// # Errors
/// An interval [s] that is not positive.
pub fn random_walk(interval: f64) -> Result<Sensors, ShapingError> {
    let sensor = |white: f64, walk: f64, turn_on: f64| {
        ShapingFilter::white(white, interval)?
            .plus(&ShapingFilter::random_walk(walk, interval)?)?
            .plus(&ShapingFilter::constant(turn_on, interval)?)
    };
    let (gyro, accel) = (sensor(1e-4, 4e-4, 1.7e-3)?, sensor(5e-4, 2e-3, 0.05)?);
    Ok([gyro, gyro, gyro, accel, accel, accel])
}

/// ARMA(2,2) and a turn-on constant, three states an axis: what the record was simulated with.
///
/// # Errors
/// An interval [s] that is not positive.
pub fn arma(interval: f64) -> Result<Sensors, ShapingError> {
    let sensor = |sigma: f64, turn_on: f64| {
        ShapingFilter::arma(&[1.8087, -0.81058], &[1.65, -0.665], sigma, interval)?
            .plus(&ShapingFilter::constant(turn_on, interval)?)
    };
    let (gyro, accel) = (sensor(1e-3, 1.7e-3)?, sensor(5e-3, 0.05)?);
    Ok([gyro, gyro, gyro, accel, accel, accel])
}
