use super::*;

fn regression(points: &[(f64, f64)]) -> Regression {
    let mut sums = Regression::default();
    points.iter().for_each(|(x, y)| sums.add(*x, *y));
    sums
}

/// So many turns of `size` to either side, of which the sensors show 1/`scale`.
fn turned(count: usize, size: f64, scale: f64) -> Vec<(f64, f64)> {
    let side = |k: usize| if k.is_multiple_of(2) { size } else { -size };
    (0..count).map(|k| (side(k) / scale, side(k))).collect()
}

#[test]
fn a_regression_is_the_line_of_least_squares() {
    let near = |found: (f64, f64), exact: (f64, f64)| {
        (found.0 - exact.0).abs() < 1e-12 && (found.1 - exact.1).abs() < 1e-12
    };
    assert!(near(
        regression(&[(0.0, 1.0), (1.0, 3.0), (3.0, 7.0)]).fit(),
        (2.0, 1.0)
    ));
    let bent = regression(&[(0.0, 0.0), (1.0, 0.0), (2.0, 3.0)]);
    assert!(near(bent.fit(), (1.5, 0.75)));
    assert!((bent.power() - 6.0).abs() < 1e-12);
    assert_eq!(regression(&[(1.0, 0.0), (1.0, 3.0)]).fit(), (0.0, 0.0));
    assert_eq!(regression(&[(0.0, 2.0), (3.0, 2.0)]).fit(), (0.0, 0.0));
    assert_eq!(regression(&[]).power(), 0.0);
}

#[test]
fn turns_of_the_course_are_of_windows_of_a_second_at_speed() {
    let at =
        |speed: f64, course: f64| Vector3::new(speed * course.cos(), speed * course.sin(), 0.3);
    let mut turns = Turns::new();
    turns.velocity(10.0, &at(10.0, 3.0), 0.02);
    turns.velocity(10.8, &at(11.0, 3.1), 0.02);
    // The circle closes at π.
    turns.velocity(11.0, &at(12.0, 3.3), 0.0288);
    let window = turns.waiting.pop_front().unwrap();
    assert!(turns.waiting.is_empty());
    assert_eq!((window.start, window.end), (10.0, 11.0));
    assert!((window.turn - 0.3).abs() < 1e-12);
    assert!((window.speed - 11.0).abs() < 1e-12 && (window.faster - 2.0).abs() < 1e-12);
    // Twice the variance over the speed's square.
    assert!((turns.noise - 2.0 * 0.0288 / 144.0).abs() < 1e-15);
    let counted = |length: f64, speed: f64, turn: f64, variance: f64| {
        let mut turns = Turns::new();
        turns.velocity(0.0, &at(speed, 0.0), variance);
        turns.velocity(length, &at(speed, turn), variance);
        turns.waiting.len()
    };
    assert_eq!(
        (counted(2.4, 10.0, 0.2, 0.1), counted(2.6, 10.0, 0.2, 0.1)),
        (1, 0)
    );
    assert_eq!(
        (counted(1.0, 3.1, 0.2, 0.01), counted(1.0, 2.9, 0.2, 0.01)),
        (1, 0)
    );
    assert_eq!(
        (
            counted(1.0, 10.0, -0.98, 0.1),
            counted(1.0, 10.0, -1.02, 0.1)
        ),
        (1, 0)
    );
    // A tenth of a radian of a course at 10 m/s is a variance of 1.
    assert_eq!(
        (counted(1.0, 10.0, 0.2, 0.98), counted(1.0, 10.0, 0.2, 1.02)),
        (1, 0)
    );
}

#[test]
fn what_was_gathered_is_interpolated_in_the_history() {
    let mut turns = Turns::new();
    for k in 0..4 {
        let t = f64::from(k);
        let sums = Integrals {
            yaw: t * t,
            angle: Vector3::new(t, 2.0 * t, -t),
            velocity: Vector3::new(5.0 * t, 0.0, 1.0),
        };
        turns.history.push_back((10.0 + 2.0 * t, sums));
    }
    let at = turns.sums_at(12.5).unwrap();
    assert_eq!(
        (at.yaw, at.angle, at.velocity),
        (
            1.75,
            Vector3::new(1.25, 2.5, -1.25),
            Vector3::new(6.25, 0.0, 1.0)
        )
    );
    let mut after = 0;
    let yaws = [12.5, 12.5, 15.0].map(|time| turns.yaw_at(time, &mut after));
    assert_eq!(yaws, [Some(1.75), Some(1.75), Some(6.5)]);
    assert!(turns.sums_at(10.0).is_none() && turns.sums_at(16.1).is_none());
    assert!(turns.yaw_at(16.1, &mut after).is_none());
    // Half a second of a window: twice the differences, in the course's turn and speed.
    turns.compare(&Turn {
        start: 12.0,
        end: 12.5,
        turn: 0.1,
        noise: 0.0,
        speed: 8.0,
        faster: 2.0,
    });
    let sums = |of: &Regression| (of.n, of.x, of.y);
    assert_eq!(sums(&turns.axes[1]), (1.0, 0.5, 0.1));
    assert_eq!(sums(&turns.lags[LAGS]), (1.0, 0.75, 0.1));
    // A second later, in the next interval: from 13 to 13.5 s.
    assert_eq!(sums(&turns.lags[LAGS + 4]), (1.0, 0.75, 0.1));
    assert_eq!(sums(&turns.lags[LAGS + 8]), (1.0, 1.25, 0.1));
    assert_eq!(sums(&turns.lags[LAGS - 8]).0, 0.0);
    assert_eq!(sums(&turns.pushes[0][0]), (1.0, 2.5, 4.0));
    assert_eq!(sums(&turns.pushes[1][0]), (1.0, 2.5, 1.6));
}

#[test]
fn gyros_that_turn_as_the_course_does_are_found_right_and_others_not() {
    let down = Vector3::new(0.0, 0.0, 1.0);
    let of = |points: &[(f64, f64)], noise: f64| {
        let mut turns = Turns::new();
        turns.lags[LAGS] = regression(points);
        turns.noise = noise;
        turns.turns(&down)
    };
    assert_eq!(of(&turned(30, 0.2, 1.0), 0.0), []);
    assert_eq!(
        of(&turned(30, 0.2, 2.0), 0.0),
        [Implausible::TurnScale(2.0)]
    );
    assert_eq!(
        of(&turned(30, 0.2, -1.0), 0.0),
        [Implausible::TurnScale(-1.0)]
    );
    // Without any turn of the gyros; with less than 0.25 rad² beyond the noise, or twice the noise, nothing is said.
    let still: Vec<_> = turned(30, 0.2, 1.0)
        .iter()
        .map(|(_, y)| (0.0, *y))
        .collect();
    assert_eq!(of(&still, 0.0), [Implausible::NoTurn]);
    assert_eq!(of(&still, 0.39), [Implausible::NoTurn]);
    assert_eq!(of(&still, 0.41), []);
    assert_eq!(of(&still[..8], 0.06), [Implausible::NoTurn]);
    assert_eq!(of(&still[..8], 0.08), []);
}

#[test]
fn turns_that_another_lag_or_axis_shows_are_found_there() {
    let down = Vector3::new(0.0, 0.0, 1.0);
    let still: Vec<_> = turned(30, 0.2, 1.0)
        .iter()
        .map(|(_, y)| (0.0, *y))
        .collect();
    let mut turns = Turns::new();
    turns.lags[LAGS] = regression(&still);
    turns.lags[LAGS + 8] = regression(&turned(30, 0.2, 1.0));
    assert_eq!(turns.turns(&down), [Implausible::Late(2.0)]);
    // Nineteen windows are too few to believe it.
    turns.lags[LAGS + 8] = regression(&turned(19, 0.3, 1.0));
    assert_eq!(turns.turns(&down), [Implausible::NoTurn]);
    turns.axes[1] = regression(&turned(30, 0.2, -1.0));
    assert_eq!(turns.turns(&down), [Implausible::TurnAxis(1)]);
    // Not one that points down already, nor with another scale.
    assert_eq!(
        turns.turns(&Vector3::new(0.9, 0.31, 0.3)),
        [Implausible::NoTurn]
    );
    turns.axes[1] = regression(&turned(30, 0.2, 2.0));
    assert_eq!(turns.turns(&down), [Implausible::NoTurn]);
}

#[test]
fn pushes_are_along_forward_and_right_or_reported() {
    let strong = turned(30, 0.5, 1.0);
    let still: Vec<_> = strong.iter().map(|(_, y)| (0.0, *y)).collect();
    let reversed = turned(30, 0.5, -1.0);
    let of = |forward: [&[(f64, f64)]; 2], right: [&[(f64, f64)]; 2]| {
        let mut turns = Turns::new();
        turns.pushes = [forward.map(regression), right.map(regression)];
        turns.pushes()
    };
    let push = |forward, right| Some(Implausible::Push { forward, right });
    assert_eq!(of([&strong, &still], [&still, &strong]), None);
    assert_eq!(
        of([&reversed, &still], [&still, &strong]),
        push(Some(-1), Some(2))
    );
    assert_eq!(
        of([&still, &strong], [&reversed, &still]),
        push(Some(2), Some(-1))
    );
    assert_eq!(
        of([&still, &reversed], [&still, &reversed]),
        push(Some(-2), Some(-2))
    );
    // Ten of 0.25 m²/s⁴ are enough, nine are not; what both axes or none show says nothing.
    assert_eq!(
        of([&reversed[..10], &still[..10]], [&still, &still]),
        push(Some(-1), None)
    );
    assert_eq!(of([&reversed[..9], &still[..9]], [&still, &still]), None);
    assert_eq!(of([&reversed, &reversed], [&still, &still]), None);
}

/// What is late of a car that weaves and changes its speed, whose velocities and accelerometers are later than the gyros by so
/// much \[s\], and whose IMU is so far ahead of the axle \[m\]: velocities, accelerometers.
fn late(velocities: f64, accelerometers: f64, ahead: f64) -> [Option<f64>; 2] {
    let rate = |t: f64| 0.25 * (0.9 * t).sin() + 0.15 * (0.37 * t).cos();
    let turn = |t: f64| -0.25 / 0.9 * (0.9 * t).cos() + 0.15 / 0.37 * (0.37 * t).sin();
    let change = |t: f64| 0.25 * 0.9 * (0.9 * t).cos() - 0.15 * 0.37 * (0.37 * t).sin();
    let speed = |t: f64| 12.0 + 3.0 * (0.5 * t).sin();
    let gain = |t: f64| 1.5 * (0.5 * t).cos();
    let mut turns = Turns::new();
    let up = Some(-Vector3::z());
    for k in 1..10_000 {
        let (time, dt) = (0.02 * f64::from(k), 0.02);
        let felt = time - accelerometers;
        let side = speed(felt) * rate(felt) + ahead * change(felt);
        let dtheta = Vector3::new(0.0, 0.0, rate(time) * dt);
        let dvel = Vector3::new(gain(felt), side, -9.81) * dt;
        turns.sample(
            &ImuSample {
                time,
                dt,
                dtheta,
                dvel,
            },
            up,
        );
        if k % 10 == 0 {
            let then = time - velocities;
            let v_n = Vector3::new(turn(then).cos(), turn(then).sin(), 0.0) * speed(then);
            turns.velocity(time, &v_n, 1e-4);
        }
    }
    turns.finish();
    let mut found = [None; 2];
    for of in turns.late() {
        match of {
            Mismatch::LateVelocities { delay, .. } => found[0] = Some(delay),
            Mismatch::LateAccelerometers(delay) => found[1] = Some(delay),
            other => panic!("{other:?}"),
        }
    }
    found
}

#[test]
fn what_is_late_is_found_to_some_hundredths_of_a_second() {
    for delay in [0.12, 0.3, 0.45] {
        let [velocities, accelerometers] = late(delay, 0.0, 0.0);
        assert!(
            (velocities.unwrap() - delay).abs() < 0.04,
            "{delay}: {velocities:?}"
        );
        assert_eq!(accelerometers, None);
    }
    for delay in [0.12, 0.2, 0.35] {
        let [velocities, accelerometers] = late(0.0, delay, 0.0);
        assert!(
            (accelerometers.unwrap() - delay).abs() < 0.04,
            "{delay}: {accelerometers:?}"
        );
        assert_eq!(velocities, None);
    }
    // Both against the gyros.
    let [velocities, accelerometers] = late(0.2, 0.3, 0.0);
    assert!((velocities.unwrap() - 0.2).abs() < 0.04);
    assert!((accelerometers.unwrap() - 0.3).abs() < 0.05);
}

#[test]
fn an_imu_ahead_of_the_axle_is_not_late() {
    assert_eq!(late(0.0, 0.0, 0.0), [None; 2]);
    assert_eq!(late(0.04, 0.04, 0.0), [None; 2]);
    // As of an IMU ahead of the axle beside a speed that lags.
    assert_eq!(late(0.0, -0.2, 0.0)[1], None);
    // Two metres at 12 m/s: pushed to the side 0.17 s earlier, and not along.
    assert_eq!(late(0.0, 0.0, 2.0), [None; 2]);
    assert_eq!(late(0.0, 0.0, -2.0), [None; 2]);
}
