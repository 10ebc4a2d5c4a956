use super::*;

/// A number between −1 and 1 that never repeats soon.
fn noise(k: usize) -> f64 {
    (k as f64 * 78.233).sin()
}

/// What is found of `windows` of a car that turns, brakes and accelerates, of which the sensors measure
/// what `sensor` makes of number, turn and horizontal forces.
fn found(
    windows: usize,
    sensor: impl Fn(usize, f64, Vector2<f64>) -> (f64, Vector2<f64>),
) -> Option<SensorChange> {
    let mut changes = Changes::default();
    for k in 0..windows {
        let t = k as f64;
        let turn = 0.3 * (0.21 * t).sin() + 0.02 * noise(k);
        let seen = Vector2::new((0.37 * t).cos(), 8.0 * turn);
        let (gyro, force) = sensor(k, turn + 0.01 * noise(k + 7), seen);
        changes.add(&Compared {
            start: t,
            end: t + 1.0,
            turn,
            noise: 1e-4,
            gyro,
            // The slope of the road.
            force: (force + Vector2::new(0.1 * noise(3 * k), 0.1 * noise(5 * k))).into(),
            seen: seen.into(),
        });
    }
    changes.finding(true)
}

/// What it is, and that it is found within two blocks of where it is.
fn what(windows: usize, at: usize, found: Option<SensorChange>) -> Option<ChangeOf> {
    let blocks = 2.0 * windows as f64 / 32.0 + 2.0 * f64::from(WINDOWS);
    found.map(|change| {
        let off = change.between[0] - at as f64;
        assert!(off.abs() < blocks, "{change:?} at {at} of {windows}");
        change.what
    })
}

#[test]
fn a_gyro_that_changes_its_unit_or_fails() {
    for (windows, at) in [(200, 100), (200, 60), (5000, 1300)] {
        let gyro = |factor: f64, other: f64| {
            let of = found(windows, |k, turn, force| match k < at {
                true => (turn, force),
                false => (factor * turn + other * noise(k * k % 9973), force),
            });
            what(windows, at, of)
        };
        for factor in [0.5, 2.0, 57.3, -1.0] {
            let Some(ChangeOf::TurnScale(ratio)) = gyro(factor, 0.0) else {
                panic!("{factor} at {at} of {windows}")
            };
            assert!((ratio / factor - 1.0).abs() < 0.1, "{ratio} for {factor}");
        }
        // The values of another axis.
        assert_eq!(gyro(0.0, 0.2), Some(ChangeOf::NoTurn));
        // What the filter has states for, and what leans into turns.
        assert_eq!((gyro(0.7, 0.0), gyro(1.5, 0.0)), (None, None));
    }
    assert_eq!(found(5000, |_, turn, force| (turn, force)), None);
    // Wrong from end to end is another finding; too few windows show nothing.
    assert_eq!(found(200, |_, turn, force| (2.0 * turn, force)), None);
    let late = |k: usize, turn: f64, force| (if k < 190 { turn } else { 2.0 * turn }, force);
    assert_eq!(found(200, late), None);
}

#[test]
fn an_imu_that_is_turned_or_changes_its_range() {
    let at = 120;
    let after = |map: Matrix2<f64>| {
        let of = found(300, |k, turn, force| {
            (turn, if k < at { force } else { map * force })
        });
        what(300, at, of)
    };
    for degrees in [30.0_f64, -90.0, 170.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        // Clockwise seen from above: what is ahead comes from the left.
        let Some(ChangeOf::Turned(angle)) = after(Matrix2::new(cos, sin, -sin, cos)) else {
            panic!("{degrees}")
        };
        assert!(
            (angle.to_degrees() - degrees).abs() < 5.0,
            "{angle} for {degrees}"
        );
    }
    for (axis, factor) in [(0, 0.5), (1, 2.0), (0, 9.81)] {
        let mut map = Matrix2::identity();
        map[(axis, axis)] = factor;
        let Some(ChangeOf::ForceScale(seen, ratio)) = after(map) else {
            panic!("{factor} along {axis}")
        };
        assert!(
            seen == axis && (ratio / factor - 1.0).abs() < 0.2,
            "{ratio}"
        );
    }
    assert_eq!(after(Matrix2::identity()), None);
    assert_eq!(after(Matrix2::identity() * 1.3), None);
    // Axes that are not level say nothing of accelerations, and axes that become others begin again.
    let mut changes = Changes::default();
    changes.turn();
    assert_eq!(changes.finding(false), None);
}
