//! What several drives show together.

use super::*;
use undrift_drive::replay::Measurement;
use undrift_nav::{
    Vector3,
    sample::{GnssFix, ImuSample},
    shaping::ShapingFilter,
};

const DT: f64 = 0.125;

/// Seconds that alternate by `size` times one more than the axis \[unit\].
fn alternating(size: f64) -> Vec<ImuSample> {
    let rate = |k: usize, i: usize| {
        let sign = if ((k + 1) / 8).is_multiple_of(2) {
            0.5
        } else {
            -0.5
        };
        size * (i + 1) as f64 * sign
    };
    let sample = |k: usize| ImuSample {
        time: DT * (k + 1) as f64,
        dt: DT,
        dtheta: Vector3::from_fn(|i, _| DT * rate(k, i)),
        dvel: Vector3::from_fn(|i, _| DT * rate(k, 3 + i)),
    };
    (0..8 * 40).map(sample).collect()
}

/// Fixes every second at a speed \[m/s\].
fn at_speed(speed: f64) -> Vec<Measurement> {
    let fix = |k: i32| GnssFix {
        attitude: None,
        mean_velocity: None,
        time: f64::from(k),
        position: None,
        velocity: Some((Vector3::new(speed, 0.0, 0.0), Default::default())),
        quality: Default::default(),
    };
    (0..=40).map(|k| Measurement::Gnss(fix(k))).collect()
}

#[test]
fn the_noise_of_a_standing_vehicle_is_the_root_mean_square_of_the_drives_that_stand() {
    let (quiet, loud) = (alternating(1.0), alternating(7.0));
    let (at_rest, moves) = (at_speed(0.0), at_speed(5.0));
    let hovers = Settings::new([ShapingFilter::white(0.0, DT).unwrap(); AXES]);
    let mut settings = hovers.clone();
    settings.constraints.zero_velocity = Some(0.02);
    let log = |imu, aiding, settings: &Settings, until| FitLog {
        imu,
        aiding,
        settings: settings.clone(),
        until,
    };
    let one = |imu| log(imu, &at_rest[..], &settings, f64::INFINITY);
    let of = |logs: &[FitLog]| standing(logs).map(|found| found[0]);
    let quietly = of(&[one(&quiet)]).unwrap();
    // 1 and 7: of the mean of 1 and 49 the root is 5.
    let both = standing(&[one(&quiet), one(&loud)]).unwrap();
    for (i, density) in both.iter().enumerate() {
        let exact = 5.0 * (i + 1) as f64 * quietly;
        assert!((density / exact - 1.0).abs() < 1e-9, "{i}: {density}");
    }
    // What moves, hovers or is not to be seen says nothing.
    let silent = [
        log(&loud, &moves, &settings, f64::INFINITY),
        log(&loud, &at_rest, &hovers, f64::INFINITY),
        log(&loud, &at_rest, &settings, 5.0),
    ];
    assert_eq!(standing(&silent), None);
    assert_eq!(standing(&[]), None);
    let [a, b, c] = silent;
    assert_eq!(of(&[a, one(&quiet), b, c]), Some(quietly));
}
