//! Navigates the raw logs of `navigation.py` with the crate strapdown-core and leaves `strapdown_core.f64`
//! beside them. Built by `navigation.py` in a throw-away crate.

mod raw_logs;

use nalgebra::{DMatrix, DVector, Vector3};
use raw_logs::{Failure, Logs};
use strapdown::kalman::{InitialState, UnscentedKalmanFilter};
use strapdown::measurements::{GPSPositionMeasurement, GPSVelocityMeasurement};
use strapdown::{IMUData, NavigationFilter};

/// α, β, κ of the unscented transform, as in the crate's own simulations. Points so close together also
/// seldom lie on both sides of ±180°, where the crate averages headings as plain numbers.
const SPREAD: [f64; 3] = [1e-3, 2.0, 0.0];

fn main() -> Result<(), Failure> {
    raw_logs::run("strapdown_core", navigate)
}

/// Rows of time, latitude, longitude, height, velocity, roll, pitch, yaw at every sample after the start.
fn navigate(logs: &Logs) -> Result<Vec<f64>, Failure> {
    let Logs {
        imu,
        gnss,
        start,
        model,
    } = logs;
    let step = raw_logs::interval(imu);
    let (position, velocity) = (model.position, model.velocity);
    let [alpha, beta, kappa] = SPREAD;
    let degrees = |k: usize| start[k].to_degrees();
    // North-east-down: its altitude grows with the vertical velocity, so that it is minus the height.
    let state = InitialState::new(
        degrees(1),
        degrees(2),
        -start[3],
        start[4],
        start[5],
        start[6],
        degrees(7),
        degrees(8),
        degrees(9),
        true,
        Some(false),
    );
    // States are latitude and longitude [rad], height, velocity, Euler angles, biases of accelerometers and gyros.
    let radians = position / 6.37e6;
    let sigmas = [
        [radians, radians / start[1].cos(), position],
        [0.1; 3],
        model.attitude,
        [model.accel_turn_on; 3],
        [model.gyro_turn_on; 3],
    ];
    // What it adds at every step, whatever the step's length: a density times the step.
    let walks = [
        0.0,
        model.accel,
        model.gyro,
        model.accel_walk,
        model.gyro_walk,
    ]
    .map(|density| [density * step.sqrt(); 3]);
    let squares = |sigmas: [[f64; 3]; 5]| -> Vec<f64> {
        sigmas.iter().flatten().map(|sigma| sigma * sigma).collect()
    };
    let mut filter = UnscentedKalmanFilter::new(
        state,
        vec![0.0; 6],
        None,
        squares(sigmas),
        DMatrix::from_diagonal(&DVector::from_vec(squares(walks))),
        alpha,
        beta,
        kappa,
    );
    // The first fix is the start.
    let mut fixes = gnss.chunks_exact(7).skip(1);
    let mut fix = fixes.next();
    let mut solution = Vec::with_capacity(imu.len() / 7 * 10);
    for row in imu
        .chunks_exact(7)
        .filter(|row| row[0] > start[0] + 0.5 * step)
    {
        while let Some(next) = fix.filter(|next| next[0] < row[0] - 0.5 * step) {
            filter.update(&GPSPositionMeasurement {
                latitude: next[1].to_degrees(),
                longitude: next[2].to_degrees(),
                altitude: -next[3],
                horizontal_noise_std: position,
                vertical_noise_std: position,
            });
            if next[4].is_finite() {
                filter.update(&GPSVelocityMeasurement {
                    northward_velocity: next[4],
                    eastward_velocity: next[5],
                    vertical_velocity: next[6],
                    horizontal_noise_std: velocity,
                    vertical_noise_std: velocity,
                });
            }
            fix = fixes.next();
        }
        let sample = IMUData {
            gyro: Vector3::new(row[1], row[2], row[3]),
            accel: Vector3::new(row[4], row[5], row[6]),
        };
        filter.predict(&sample, step);
        let state = filter.get_estimate();
        solution.extend([row[0], state[0], state[1], -state[2]]);
        solution.extend(state.iter().skip(3).take(6));
    }
    Ok(solution)
}
