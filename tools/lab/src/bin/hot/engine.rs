//! The navigator.

use std::hint::black_box;
use undrift::{
    engine::{Navigator, settings::Settings},
    nav::{
        Matrix3, Vector3,
        earth::Geodetic,
        sample::{FixQuality, GnssFix, ImuSample, Position},
        shaping::ShapingFilter,
    },
};

const DT: f64 = 0.005;

pub fn run(task: &str, count: u32) -> Result<(), Box<dyn std::error::Error>> {
    match task {
        // A fix a second.
        "navigator-15" => samples(count, 0.0, 0),
        // With the snapshots of two seconds, every fix in time.
        "navigator-15-horizon" => samples(count, 2.0, 0),
        // Fixes that come a second late.
        "late-fix" => samples(200 * count, 2.0, 200),
        _ => Err(format!("no task {task}").into()),
    }
}

/// One state an axis.
fn sensors() -> Result<[ShapingFilter; 6], Box<dyn std::error::Error>> {
    let axis = |phi: f64, white: f64| ShapingFilter::arma(&[phi], &[0.9], white, DT);
    let (gyro, accel) = (axis(0.999, 5e-4)?, axis(0.999, 5e-3)?);
    Ok([gyro, gyro, gyro, accel, accel, accel])
}

/// So many samples of a vehicle that goes straight on, and a fix each second that comes `late` samples late.
fn samples(count: u32, horizon: f64, late: u32) -> Result<(), Box<dyn std::error::Error>> {
    let mut settings = Settings::new(sensors()?);
    settings.align.attitude = Some((Vector3::zeros(), Vector3::repeat(0.01)));
    let mut navigator = Navigator::new(settings).with_horizon(horizon);
    for k in 1..=count {
        if k % 200 == 100 && k > late {
            navigator.fix(fix(DT * f64::from(k - late)))?;
        }
        navigator.imu(black_box(ImuSample {
            time: DT * f64::from(k),
            dt: DT,
            dtheta: Vector3::zeros(),
            dvel: Vector3::new(0.0, 0.0, -9.806 * DT),
        }))?;
    }
    black_box(navigator.filter().map(|filter| filter.nav_std()));
    Ok(())
}

fn fix(time: f64) -> GnssFix {
    let place = Geodetic::from_degrees(45.0, 7.0, 300.0);
    GnssFix {
        attitude: None,
        mean_velocity: None,
        time,
        position: Some((Position::Geodetic(place), Matrix3::identity())),
        velocity: Some((Vector3::zeros(), Matrix3::identity() * 0.01)),
        quality: FixQuality::Unknown,
    }
}
