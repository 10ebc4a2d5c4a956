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
