use super::*;

/// What is found of fixes a second apart that move by `moves` and state `stated` [m/s].
fn found(fixes: u32, moves: Vector3, stated: Vector3) -> Option<Implausible> {
    let start = Geodetic::from_degrees(47.0, 8.0, 400.0);
    let mut all = Moves::default();
    for k in 0..fixes {
        let place = start.displaced(&(moves * f64::from(k)));
        all.fix(&GnssFix::at(f64::from(k), place, [0.1; 3]), &stated);
    }
    all.finding()
}

#[test]
fn each_error_is_found_by_the_velocity_that_it_makes() {
    let v = Vector3::new(8.0, 3.0, 0.0);
    for (mend, stated) in [
        (VelocityEastNorth, Vector3::new(3.0, 8.0, 0.0)),
        (EastReversed, Vector3::new(8.0, -3.0, 0.0)),
        (NorthReversed, Vector3::new(-8.0, 3.0, 0.0)),
        (VelocityReversed, -v),
        (KilometresPerHour, v * 3.6),
        (Knots, v / 0.514_444),
        (FeetPerSecond, v / 0.3048),
        (CentimetresPerSecond, v * 100.0),
        (MillimetresPerSecond, v * 1000.0),
        (PositionInRadians, v * 57.295_78),
    ] {
        let expected = Some(Implausible::Velocity(Some(mend)));
        assert_eq!(found(40, v, stated), expected, "{stated}");
    }
    assert_eq!(found(40, v, v), None);
    // A sixth more is within the fifth that two displacements may differ by, a third is not and is no known error.
    assert_eq!(found(40, v, v * 1.17), None);
    assert_eq!(found(40, v, v * 1.4), Some(Implausible::Velocity(None)));
}

#[test]
fn eight_windows_of_two_seconds_are_judged() {
    let v = Vector3::new(8.0, 3.0, 0.0);
    assert_eq!(found(16, v, -v), None);
    assert!(found(17, v, -v).is_some());
}

#[test]
fn motion_that_noise_of_the_positions_could_make_does_not_count() {
    // 2 m and ten times the horizontal standard deviation, 0.14 m, in two seconds.
    let v = |speed: f64| Vector3::new(speed, 0.0, 0.0);
    assert_eq!(found(40, v(1.65), v(-1.65)), None);
    assert!(found(40, v(1.75), v(-1.75)).is_some());
}

#[test]
fn a_multiple_of_the_ways_is_found_to_a_thousandth() {
    let scale = |factor: f64, jump: bool, turn: f64| {
        let start = Geodetic::from_degrees(47.0, 8.0, 400.0);
        let (mut all, mut place) = (Moves::default(), Vector3::zeros());
        for k in 0..90 {
            let course = turn * f64::from(k);
            let v = Vector3::new(8.0 * course.cos(), 8.0 * course.sin(), 0.0);
            place += v;
            if jump && k == 50 {
                place += Vector3::new(500.0, 0.0, 0.0);
            }
            let fix = GnssFix::at(f64::from(k), start.displaced(&place), [0.1; 3]);
            all.fix(&fix, &(v * factor));
        }
        match all.scale() {
            Some(Implausible::VelocityScale([ratio, std])) => Some((ratio, std)),
            _ => None,
        }
    };
    for factor in [0.9, 1.05, 1.3] {
        let (ratio, std) = scale(factor, true, 0.03).unwrap();
        assert!(
            (ratio / factor - 1.0).abs() < 2e-3 && std < 5e-3,
            "{ratio} ± {std}"
        );
    }
    assert_eq!(scale(1.02, true, 0.03), None);
    // Between fixes that turn this far half the sum of their velocities is not the way.
    assert_eq!(scale(1.2, false, 0.5), None);
    // One that has a name is called by it.
    assert_eq!(scale(3.6, false, 0.03), None);
}
