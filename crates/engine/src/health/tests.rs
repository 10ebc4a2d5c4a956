use super::*;
use crate::{
    estimator::build,
    tests::{Scenario, receiver, sensors},
};
use alloc::{boxed::Box, vec::Vec};
use undrift_nav::{
    Vector3, attitude::from_rpy, covariance::NAV, earth::Geodetic, filter::InitialStd,
    mechanisation::NavState, parameters::Parameters,
};
use undrift_simulate::Trajectory;

/// Position and velocity known to this \[m, m/s\], and free of correlation.
fn filter(position: f64, velocity: f64) -> Box<dyn Estimator> {
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: Vector3::zeros(),
        q_nb: from_rpy(&Vector3::zeros()),
    };
    let std = InitialStd {
        position: Vector3::repeat(position),
        velocity: Vector3::repeat(velocity),
        attitude: Vector3::repeat(0.1),
    };
    build(nav, &std, &sensors(), Parameters::none()).unwrap()
}

/// Changes the covariance of two states, in one of its two places.
fn set(filter: &mut dyn Estimator, (i, j): (usize, usize), value: f64) {
    // Marked, to find its place among the numbers of the filter.
    let before = filter.covariance()[(i, j)];
    let mut numbers = Vec::new();
    filter.numbers(&mut |number| numbers.push(*number));
    for place in 0..numbers.len() {
        let put = |filter: &mut dyn Estimator, value: f64| {
            let mut at = 0;
            filter.numbers(&mut |number| {
                if at == place {
                    *number = value;
                }
                at += 1;
            });
        };
        if numbers[place] == before {
            put(filter, value);
            if filter.covariance()[(i, j)] == value {
                return;
            }
            put(filter, before);
        }
    }
    panic!("the filter has no such number");
}

fn assert_near(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() < 1e-12,
        "{found} is not {expected}"
    );
}

#[test]
fn uncorrelated_states_are_the_identity_and_constants_without_variance_do_not_count() {
    let health = covariance_health(&*filter(2.0, 3.0));
    // Nine of navigation, six biases.
    assert_eq!((health.states, health.asymmetry), (15, 0.0));
    assert_near(health.least_eigenvalue, 1.0);
    // A position that is known exactly is no state of the covariance.
    assert_eq!(covariance_health(&*filter(0.0, 3.0)).states, 12);
}

#[test]
fn two_correlated_states_leave_one_less_their_correlation() {
    // Over 3 s at an unknown 2 m/s² position and velocity go wrong together, by 9 m and 6 m/s.
    let mut filter = filter(4.0, 8.0);
    filter.inflate_over_gap(3.0, 0.0, 2.0);
    let correlation = 9.0 * 6.0 / ((16.0f64 + 81.0).sqrt() * (64.0f64 + 36.0).sqrt());
    let health = covariance_health(&*filter);
    assert_eq!(health.asymmetry, 0.0);
    assert_near(health.least_eigenvalue, 1.0 - correlation);
}

#[test]
fn what_is_no_covariance_any_more_is_seen() {
    // A correlation of 1.5: as 6 m·m/s of 2 m and 2 m/s.
    let mut broken = filter(2.0, 2.0);
    set(&mut *broken, (0, 3), 6.0);
    set(&mut *broken, (3, 0), 6.0);
    let health = covariance_health(&*broken);
    assert_eq!(health.asymmetry, 0.0);
    assert_near(health.least_eigenvalue, -0.5);
    // In one of both places only.
    let mut crooked = filter(2.0, 2.0);
    set(&mut *crooked, (0, 3), 1.0);
    assert_near(covariance_health(&*crooked).asymmetry, 0.25);
}

#[test]
fn a_minute_s_drive_leaves_a_covariance() {
    let motion = Trajectory::constant_turn(10.0, 0.1, 60.0);
    let seen = Scenario::new(&motion, &receiver(), 1).navigate();
    let health = seen.summary.covariance.unwrap();
    assert_eq!(health.states, NAV + 6);
    // Rounding is 1e-16 a step, of which there are 3000; the states are correlated, hence the eigenvalue is below one.
    assert!(health.asymmetry < 1e-12, "{health:?}");
    assert!((1e-9..1.0).contains(&health.least_eigenvalue), "{health:?}");
}
