//! Navigates the raw logs of `navigation.py` with the crate sidereon-core and leaves `sidereon.f64` beside them. Built by
//! `navigation.py` in a throw-away crate.

mod raw_logs;

use raw_logs::{Failure, Logs};
use sidereon_core::astro::math::mat3::{Mat3, inline_rxr, inline_tr, mul_vec3};
use sidereon_core::frame::{ItrfPositionM, Wgs84Geodetic, geodetic_to_itrf, itrf_to_geodetic};
use sidereon_core::fusion::{ErrorStateLayout, GnssFixMeasurement, InertialFilter, InsFilterState};
use sidereon_core::inertial::{ImuSample, ImuSpec, NavState};

fn main() -> Result<(), Failure> {
    raw_logs::run("sidereon", navigate)
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
    // With no end to the time constant, what is called instability is the density of a random walk.
    let endless = f64::INFINITY;
    let spec = ImuSpec::datasheet(
        model.accel,
        model.gyro,
        model.accel_walk,
        model.gyro_walk,
        endless,
        endless,
        None,
        None,
    );
    let axes = axes_at(start[1], start[2]);
    let body = inline_rxr(&axes, &body_to_ned(start[7], start[8], start[9]));
    let velocity = mul_vec3(&axes, [start[4], start[5], start[6]]);
    let nominal = NavState::new(start[0], ecef(&start[1..4])?, velocity, body)?;
    let square = |std: f64| std * std;
    let mut covariance = vec![vec![0.0; 15]; 15];
    let attitude = turned(&axes, model.attitude.map(square));
    for k in 0..3 {
        covariance[k][k] = square(model.position);
        covariance[3 + k][3 + k] = square(0.1);
        covariance[6 + k][6..9].copy_from_slice(&attitude[k]);
        covariance[9 + k][9 + k] = square(model.accel_turn_on);
        covariance[12 + k][12 + k] = square(model.gyro_turn_on);
    }
    let state = InsFilterState::new(nominal, ErrorStateLayout::Fifteen, covariance)?;
    let mut filter = InertialFilter::new(state, spec)?;
    // As good in every direction, and so the same in all axes.
    let mut noise = vec![vec![0.0; 6]; 6];
    for k in 0..3 {
        noise[k][k] = square(model.position);
        noise[3 + k][3 + k] = square(model.velocity);
    }
    let after = |row: &&[f64]| row[0] > start[0] + 0.5 * step;
    let mut fixes = gnss.chunks_exact(7).filter(after).peekable();
    let mut solution = Vec::with_capacity(imu.len() / 7 * 10);
    for row in imu.chunks_exact(7).filter(after) {
        let (rate, force) = ([row[1], row[2], row[3]], [row[4], row[5], row[6]]);
        filter.propagate(ImuSample::rate(row[0], force, rate))?;
        if let Some(fix) = fixes.next_if(|fix| fix[0] <= row[0] + 0.5 * step) {
            let velocity = mul_vec3(&axes_at(fix[1], fix[2]), [fix[4], fix[5], fix[6]]);
            let place = ecef(&fix[1..4])?;
            let measured =
                GnssFixMeasurement::position_velocity(row[0], place, velocity, noise.clone(), 12)?;
            filter.update_loose(&measured)?;
        }
        let NavState {
            position_ecef_m: [x, y, z],
            velocity_ecef_mps: velocity,
            attitude_body_to_ecef: attitude,
            ..
        } = filter.state().nominal;
        let here = itrf_to_geodetic(ItrfPositionM::new(x, y, z)?)?;
        let down = inline_tr(&axes_at(here.lat_rad, here.lon_rad));
        let c = inline_rxr(&down, &attitude);
        solution.extend([row[0], here.lat_rad, here.lon_rad, here.height_m]);
        solution.extend(mul_vec3(&down, velocity));
        solution.extend([
            c[2][1].atan2(c[2][2]),
            -c[2][0].asin(),
            c[1][0].atan2(c[0][0]),
        ]);
    }
    Ok(solution)
}

/// From latitude, longitude \[rad\] and height \[m\].
fn ecef(place: &[f64]) -> Result<[f64; 3], Failure> {
    let place = geodetic_to_itrf(Wgs84Geodetic::new(place[0], place[1], place[2])?)?;
    Ok([place.x_m, place.y_m, place.z_m])
}

/// Takes north, east, down to ECEF.
fn axes_at(lat: f64, lon: f64) -> Mat3 {
    let ((sp, cp), (sl, cl)) = (lat.sin_cos(), lon.sin_cos());
    [
        [-sp * cl, -sl, -cp * cl],
        [-sp * sl, cl, -cp * sl],
        [cp, 0.0, -sp],
    ]
}

/// Takes body axes to north, east, down.
fn body_to_ned(roll: f64, pitch: f64, yaw: f64) -> Mat3 {
    let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(f64::sin_cos);
    [
        [cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy],
        [cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy],
        [-sp, sr * cp, cr * cp],
    ]
}

/// A covariance of independent components, in turned axes.
fn turned(axes: &Mat3, variances: [f64; 3]) -> Mat3 {
    let row = |i: usize| {
        [0, 1, 2].map(|j| {
            let terms = (0..3).map(|k| axes[i][k] * variances[k] * axes[j][k]);
            terms.sum::<f64>()
        })
    };
    [row(0), row(1), row(2)]
}
