//! What is known of the velocity that navigation starts with, by where it comes from.

use super::*;
use undrift_nav::{
    sample::{FixQuality, Position},
    shaping::ShapingFilter,
};

const STEP: f64 = 0.01;
/// Standard deviation of each component of a position \[m\].
const POSITION: f64 = 0.5;

/// Fixes at 1 s, `every` apart, of a vehicle that moves 12 m/s north: the standard deviations of the velocity north, east
/// and down of the filter that the first alignment gives, and how many fixes that took.
fn started(
    given: Option<(Vector3, Vector3)>,
    measured: Option<Vector3>,
    every: f64,
) -> (usize, Vector3) {
    let sensor = ShapingFilter::white(1e-4, STEP).unwrap();
    let mut settings = Settings::new([sensor; 6]);
    settings.align.attitude = Some((Vector3::zeros(), Vector3::repeat(0.01)));
    settings.align.velocity = given;
    let mut aligner = Aligner::new(&settings);
    let start = Geodetic::from_degrees(47.0, 8.0, 400.0);
    for k in 0..10 {
        let time = 1.0 + every * k as f64;
        let place = start.displaced(&Vector3::new(12.0 * (time - 1.0), 0.0, 0.0));
        let variance = Matrix3::identity() * (POSITION * POSITION);
        let fix = GnssFix {
            attitude: None,
            mean_velocity: None,
            time,
            position: Some((Position::Geodetic(place), variance)),
            velocity: measured.map(|std| (Vector3::new(12.0, 0.0, 0.0), diagonal(&std))),
            quality: FixQuality::Unknown,
        };
        if let Some(aligned) = aligner.fix(&fix, &settings).unwrap() {
            let std = aligned.filter.nav_std();
            assert!((std[0] - POSITION).abs() < 1e-12);
            return (k + 1, Vector3::new(std[3], std[4], std[5]));
        }
    }
    panic!("not aligned");
}

#[test]
fn a_measured_velocity_has_the_standard_deviation_that_it_states() {
    let stated = Vector3::new(0.1, 0.2, 0.3);
    let (fixes, std) = started(None, Some(stated), 1.0);
    assert_eq!(fixes, 1);
    assert!((std - stated).norm() < 1e-12, "{std}");
}

#[test]
fn a_given_velocity_has_the_standard_deviation_that_is_given() {
    let given = Vector3::new(0.3, 0.2, 0.1);
    let velocity = Some((Vector3::new(12.0, 0.0, 0.0), given));
    for measured in [None, Some(Vector3::repeat(0.05))] {
        let (fixes, std) = started(velocity, measured, 1.0);
        assert_eq!(fixes, 1);
        assert!((std - given).norm() < 1e-12, "{std}");
    }
}

/// `√2 σ / Δt` of two positions, and what a vehicle that accelerates with 2 m/s² gains in the half interval since their
/// middle.
#[test]
fn a_velocity_from_two_positions_has_their_errors_and_an_acceleration() {
    for every in [0.5, 1.0, 2.0] {
        let (fixes, std) = started(None, None, every);
        assert_eq!(fixes, 2);
        let expected = f64::hypot(2f64.sqrt() * POSITION / every, 2.0 * 0.5 * every);
        assert!((std - Vector3::repeat(expected)).norm() < 1e-12, "{std}");
    }
}

/// An antenna ahead of and right of an IMU that turns: it is where the IMU is and moves as it does, but for the arm.
#[test]
fn the_imu_starts_where_the_antenna_is_without_its_arm() {
    let sensor = ShapingFilter::white(1e-4, STEP).unwrap();
    let mut settings = Settings::new([sensor; 6]);
    let rpy = Vector3::new(0.1, -0.2, 1.0);
    settings.align.attitude = Some((rpy, Vector3::repeat(0.01)));
    settings.lever_arm = Vector3::new(2.0, 1.0, -0.5);
    let rate = Vector3::new(0.1, -0.3, 0.5);
    let mut aligner = Aligner::new(&settings);
    let sample = ImuSample {
        time: 1.0,
        dt: STEP,
        dtheta: rate * STEP,
        dvel: Vector3::new(0.0, 0.0, -9.81) * STEP,
    };
    aligner.advance(&sample, 1.0);
    let (place, v) = (
        Geodetic::from_degrees(47.0, 8.0, 400.0),
        Vector3::new(12.0, 3.0, -1.0),
    );
    let fix = GnssFix {
        attitude: None,
        mean_velocity: None,
        time: 1.0,
        position: Some((Position::Geodetic(place), Matrix3::identity())),
        velocity: Some((v, Matrix3::identity())),
        quality: FixQuality::Unknown,
    };
    let aligned = aligner.fix(&fix, &settings).unwrap().unwrap();
    let nav = aligned.filter.nav();
    let q = from_rpy(&rpy);
    assert_eq!(nav.time, 1.0);
    assert!((nav.v_n + q * rate.cross(&settings.lever_arm) - v).norm() < 1e-12);
    // An offset of metres on the Earth rounds at a nanometre.
    let arm = nav.position.offset_to(&place);
    assert!((arm - q * settings.lever_arm).norm() < 1e-6, "{arm}");
}

fn seen(velocity: Vector3, std: f64) -> Seen {
    Seen {
        time: 1.0,
        position: (
            Geodetic::from_degrees(47.0, 8.0, 400.0),
            Matrix3::identity(),
        ),
        velocity: (velocity, Matrix3::identity() * (std * std)),
        noise: 0.0,
    }
}

#[test]
fn a_course_is_a_heading_of_a_vehicle_that_moves() {
    let sensor = ShapingFilter::white(1e-4, STEP).unwrap();
    let heading = |given: Heading, v: Vector3, std: f64| {
        let mut settings = Settings::new([sensor; 6]);
        settings.align.heading = given;
        settings.align.min_speed = 5.0;
        let mut aligner = Aligner::new(&settings);
        let seen = seen(v, std);
        aligner.note_speed(&seen);
        aligner
            .heading(&seen, &settings)
            .map(|(heading, std, _)| (heading, std))
    };
    // South-west at 5 m/s, down whatever.
    let v = Vector3::new(-4.0, -3.0, 2.0);
    let (course, std) = heading(Heading::Course, v, 0.5).unwrap();
    assert!((course - (-3f64).atan2(-4.0)).abs() < 1e-12);
    // σ/v, and side slip of 0.035 rad.
    assert!((std - 0.1f64.hypot(0.035)).abs() < 1e-12, "{std}");
    assert_eq!(heading(Heading::Course, v * 0.999, 0.5), None);
    // No more than 0.52 rad.
    let worst = 5.0 * (0.52f64.powi(2) - 0.035f64.powi(2)).sqrt();
    assert!(heading(Heading::Course, v, 0.999 * worst).is_some());
    assert!(heading(Heading::Course, v, 1.001 * worst).is_none());
    let given = heading(Heading::Given(1.5, 0.2), Vector3::zeros(), 9.0);
    assert_eq!(given, Some((1.5, 0.2)));
}

/// Above half a metre a second nothing counts as rest; a fix so fast that no vehicle got there from rest undoes it.
#[test]
fn a_fix_that_is_too_fast_undoes_a_rest() {
    let sensor = ShapingFilter::white(1e-4, STEP).unwrap();
    let settings = Settings::new([sensor; 6]);
    let rested = |stood: bool, end: f64, speed: f64| {
        let mut aligner = Aligner::new(&settings);
        aligner.rested = Some((Quaternion::identity(), Vector3::zeros(), 10.0, end));
        aligner.stood = stood;
        aligner.note_speed(&seen(Vector3::new(0.0, speed, 50.0), 0.1));
        assert_eq!((aligner.speed, aligner.fastest), (speed, speed));
        aligner.rested.is_some()
    };
    // 2 m/s, and 5 m/s² for the second since it ended.
    assert!(rested(false, 0.0, 6.99) && !rested(false, 0.0, 7.01));
    assert!(rested(true, 0.0, 7.01), "the fixes had seen it stand");
}
