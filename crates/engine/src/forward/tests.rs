use super::*;
use crate::tests::{DEG, driving_north};
use undrift_nav::attitude::from_rpy;

/// What is found of `count` seconds at this speed [m/s], with an IMU that sits so in the vehicle, which points up to `sway` \[deg\] off its course.
fn found(count: u32, speed: f64, mounting: [f64; 3], sway: f64) -> Option<Mismatch> {
    let mut filter = driving_north(speed);
    let mut watch = ForwardWatch::default();
    for k in 0..count {
        let mut nav = *filter.nav();
        let course = Vector3::new(0.0, 0.0, sway * DEG * f64::from(k).sin());
        nav.q_nb = from_rpy(&course) * from_rpy(&(Vector3::from(mounting) * DEG)).inverse();
        nav.time = f64::from(k);
        filter.set_nav(nav);
        watch.fix(&*filter);
    }
    watch.finding()
}

#[test]
fn an_imu_that_faces_elsewhere_shows_by_how_much() {
    for (mounting, angle) in [
        ([0.0, 0.0, 180.0], 180.0),
        ([180.0, 0.0, -90.0], 90.0),
        ([0.0, 90.0, 0.0], 90.0),
        ([0.0, 0.0, 25.0], 25.0),
    ] {
        let Some(Mismatch::MovesAside(found)) = found(40, 10.0, mounting, 3.0) else {
            panic!("{mounting:?}");
        };
        assert!(
            (found / DEG - angle).abs() < 1.0,
            "{mounting:?}: {}",
            found / DEG
        );
    }
}

#[test]
fn one_that_faces_forward_or_moves_any_way_or_hardly_shows_nothing() {
    let backward = [0.0, 0.0, 180.0];
    assert_eq!(found(40, 10.0, [0.0, 0.0, 15.0], 0.0), None);
    assert_eq!(found(40, 10.0, backward, 30.0), None);
    assert_eq!(found(40, 3.9, backward, 0.0), None);
    assert_eq!(found(29, 10.0, backward, 0.0), None);
}
