//! Navigates the raw logs of `navigation.py` with the crate fusion-nav and leaves `fusion_nav.f64` beside
//! them; prints CPU time and memory as the other tasks do. Built by `navigation.py` in a throw-away crate.

use fusion_nav::prelude::*;
use std::{error::Error, fs, path::Path, time::Duration};

type Failure = Box<dyn Error>;

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("give the folder of the logs")?;
    let repeats: usize = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let folder = Path::new(&folder);
    let read = |name: &str| read(&folder.join(name));
    let (imu, gnss) = (read("imu.f64")?, read("gnss.f64")?);
    let (start, model) = (read("start.f64")?, read("model.f64")?);
    let before = peak_kib()?;
    let mut fastest = f64::INFINITY;
    let mut solution = Vec::new();
    for _ in 0..repeats.max(1) {
        let since = cpu_seconds()?;
        solution = navigate(&imu, &gnss, &start, &model)?;
        fastest = fastest.min(cpu_seconds()? - since);
    }
    let bytes: Vec<u8> = solution.iter().flat_map(|value| value.to_le_bytes()).collect();
    fs::write(folder.join("fusion_nav.f64"), bytes)?;
    println!(
        "{{\"values\":[{}],\"cpu_s\":{fastest:?},\"peak_kib\":{},\"before_kib\":{before}}}",
        solution.len() / 10,
        peak_kib()?
    );
    Ok(())
}

/// Rows of time, latitude, longitude, height, velocity, roll, pitch, yaw at every sample after the start.
fn navigate(imu: &[f64], gnss: &[f64], start: &[f64], model: &[f64]) -> Result<Vec<f64>, Failure> {
    let model: Vec<f32> = model.iter().map(|&value| value as f32).collect();
    let [gyro, gyro_walk, gyro_turn_on, accel, walk, turn_on, position, velocity, tilt, _, yaw] = model[..] else {
        return Err("the model has other numbers".into());
    };
    let place = |row: &[f64]| Geodetic::from_radians(row[1], row[2], row[3]);
    let config = Config {
        imu: ImuNoise {
            gyro_white: gyro,
            accel_white: accel,
            gyro_bias_walk: gyro_walk,
            accel_bias_walk: walk,
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
    sigmas[6..9].copy_from_slice(&[tilt, tilt, yaw]);
    sigmas[9..12].fill(turn_on);
    sigmas[12..15].fill(gyro_turn_on);
    let at = |row: &[f64]| Timestamp::from_secs_f64(row[0]);
    filter
        .initialize_from(state, Covariance::from_sigmas(sigmas), at(start))
        .map_err(|error| format!("{error:?}"))?;
    let position_noise = PositionNoise::horizontal_vertical(position, position);
    let velocity_noise = VelocityNoise::horizontal_vertical(velocity, velocity);
    let mut fixes = gnss.chunks_exact(7);
    let mut fix = fixes.next();
    let interval = Seconds::from_secs(0.01);
    let mut solution = Vec::with_capacity(imu.len() / 7 * 10);
    for row in imu.chunks_exact(7).filter(|row| row[0] > start[0] + 0.005) {
        let single: Vec3 = [row[1] as f32, row[2] as f32, row[3] as f32];
        let force: Vec3 = [row[4] as f32, row[5] as f32, row[6] as f32];
        let sample = ImuSample::from_rates(
            at(row),
            AngularRate::body(single[0], single[1], single[2]),
            Acceleration::body(force[0], force[1], force[2]),
            interval,
        );
        // The first fix, of the start's own time, places the origin.
        while let Some(next) = fix.filter(|next| next[0] < row[0] - 0.005) {
            let _ = filter.fuse_gnss_geodetic(at(next), place(next), position_noise, Position::zero());
            if next[0] > start[0] {
                let reported = Velocity::ned(next[4] as f32, next[5] as f32, next[6] as f32);
                let _ = filter.fuse_gnss_velocity(at(next), reported, velocity_noise, Position::zero());
            }
            fix = fixes.next();
        }
        let _ = filter.predict(sample);
        let state = filter.state();
        let here = filter.geodetic_position().ok_or("no position")?;
        let (roll, pitch, yaw) = state.attitude.euler_angles();
        solution.extend([row[0], here.latitude_rad(), here.longitude_rad(), here.height()]);
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

fn read(path: &Path) -> Result<Vec<f64>, Failure> {
    let bytes = fs::read(path)?;
    let (numbers, _) = bytes.as_chunks::<8>();
    Ok(numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect())
}

/// CPU time so far [s], brought up to date by the nap.
fn cpu_seconds() -> Result<f64, Failure> {
    std::thread::sleep(Duration::from_millis(2));
    let text = fs::read_to_string("/proc/self/schedstat")?;
    let first = text.split_whitespace().next();
    Ok(first.ok_or("/proc has no CPU times")?.parse::<f64>()? * 1e-9)
}

/// Largest resident memory so far [KiB].
fn peak_kib() -> Result<u64, Failure> {
    let status = fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let size = line.and_then(|rest| rest.split_whitespace().next());
    Ok(size.ok_or("/proc has no peak memory")?.parse()?)
}
