//! Navigates the raw logs of `navigation.py` with the crate fusion-nav and leaves `fusion_nav.f64` beside
//! them. Built by `navigation.py` in a throw-away crate.

mod raw_logs;

use fusion_nav::prelude::*;
use raw_logs::{Failure, Logs};

fn main() -> Result<(), Failure> {
    raw_logs::run("fusion_nav", navigate)
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
    let [roll, _, yaw] = model.attitude.map(|std| std as f32);
    let (position, velocity) = (model.position as f32, model.velocity as f32);
    let place = |row: &[f64]| Geodetic::from_radians(row[1], row[2], row[3]);
    let config = Config {
        imu: ImuNoise {
            gyro_white: model.gyro as f32,
            accel_white: model.accel as f32,
            gyro_bias_walk: model.gyro_walk as f32,
            accel_bias_walk: model.accel_walk as f32,
        },
        correlation: Correlation::WHITE,
        gravity: place(start).normal_gravity(),
        hold: None,
        yaw_estimator: false,
        ..Config::default()
    };
    let mut filter = Eskf::new(config).map_err(|error| format!("{error:?}"))?;
    let state = State {
        attitude: attitude(&start[7..10]),
        position: Position::ned(0.0, 0.0, 0.0),
        velocity: Velocity::ned(0.0, 0.0, 0.0),
        accel_bias: Acceleration::body(0.0, 0.0, 0.0),
        gyro_bias: AngularRate::body(0.0, 0.0, 0.0),
        status: Status::default(),
        validity: Validity::NONE,
    };
    let mut sigmas = [position; 15];
    sigmas[3..6].fill(0.1);
    sigmas[6..9].copy_from_slice(&[roll, roll, yaw]);
    sigmas[9..12].fill(model.accel_turn_on as f32);
    sigmas[12..15].fill(model.gyro_turn_on as f32);
    let at = |row: &[f64]| Timestamp::from_secs_f64(row[0]);
    filter
        .initialize_from(state, Covariance::from_sigmas(sigmas), at(start))
        .map_err(|error| format!("{error:?}"))?;
    let position_noise = PositionNoise::horizontal_vertical(position, position);
    let velocity_noise = VelocityNoise::horizontal_vertical(velocity, velocity);
    let mut fixes = gnss.chunks_exact(7);
    let mut fix = fixes.next();
    let interval = Seconds::from_secs(step as f32);
    let mut solution = Vec::with_capacity(imu.len() / 7 * 10);
    for row in imu
        .chunks_exact(7)
        .filter(|row| row[0] > start[0] + 0.5 * step)
    {
        let single: Vec3 = [row[1] as f32, row[2] as f32, row[3] as f32];
        let force: Vec3 = [row[4] as f32, row[5] as f32, row[6] as f32];
        let sample = ImuSample::from_rates(
            at(row),
            AngularRate::body(single[0], single[1], single[2]),
            Acceleration::body(force[0], force[1], force[2]),
            interval,
        );
        // The first fix, of the start's own time, places the origin.
        while let Some(next) = fix.filter(|next| next[0] < row[0] - 0.5 * step) {
            let _ =
                filter.fuse_gnss_geodetic(at(next), place(next), position_noise, Position::zero());
            if next[0] > start[0] && next[4].is_finite() {
                let reported = Velocity::ned(next[4] as f32, next[5] as f32, next[6] as f32);
                let _ =
                    filter.fuse_gnss_velocity(at(next), reported, velocity_noise, Position::zero());
            }
            fix = fixes.next();
        }
        let _ = filter.predict(sample);
        let state = filter.state();
        let here = filter.geodetic_position().ok_or("no position")?;
        let (roll, pitch, yaw) = state.attitude.euler_angles();
        solution.extend([
            row[0],
            here.latitude_rad(),
            here.longitude_rad(),
            here.height(),
        ]);
        solution.extend(state.velocity.to_array().map(f64::from));
        solution.extend([roll, pitch, yaw].map(f64::from));
    }
    Ok(solution)
}

type Vec3 = [f32; 3];

/// From roll, pitch, yaw [rad].
fn attitude(rpy: &[f64]) -> Attitude {
    let [(sr, cr), (sp, cp), (sy, cy)] = [0, 1, 2].map(|k| (rpy[k] as f32 / 2.0).sin_cos());
    Attitude::from_body_to_ned(fusion_nav::Quaternion {
        w: cr * cp * cy + sr * sp * sy,
        x: sr * cp * cy - cr * sp * sy,
        y: cr * sp * cy + sr * cp * sy,
        z: cr * cp * sy - sr * sp * cy,
    })
}
