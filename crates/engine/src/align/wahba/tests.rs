//! The linearised window against closed forms and differences.

use super::{super::sightings::Sighting, *};
use alloc::vec;
use undrift_nav::{attitude::from_rpy, earth};

const GYRO_NOISE: f64 = 1e-6;
const ACCEL_NOISE: f64 = 1e-4;

fn problem(segments: &[Segment]) -> Problem<'_> {
    Problem {
        segments,
        reference: Vector3::zeros(),
        place: Geodetic::from_degrees(45.0, 7.0, 300.0),
        lever_arm: Vector3::zeros(),
        gyro: (Vector3::zeros(), Vector3::repeat(1e-4)),
        accel: (Vector3::zeros(), Vector3::repeat(1e-2)),
        gyro_noise: GYRO_NOISE,
        accel_noise: ACCEL_NOISE,
        by_position: false,
        late: (0.0, 0.0),
        arm: 0.0,
    }
}

fn guess(rpy: Vector3) -> Guess {
    Guess {
        q_nb: from_rpy(&rpy),
        gyro: Vector3::zeros(),
        accel: Vector3::zeros(),
    }
}

/// A level sensor at rest for twenty seconds, its velocity known at the start alone: white noise of the gyros tilts it,
/// and gravity moves what is tilted.
#[test]
fn the_sensors_noise_makes_attitude_and_velocity_wander() {
    let (dt, count, known) = (0.5, 40, 0.04);
    let up = -earth::gravity(45f64.to_radians(), 300.0);
    let mut segment = Segment::default();
    segment
        .motion
        .add(&Vector3::zeros(), &Vector3::new(0.0, 0.0, up * dt), dt);
    segment.fix.variance = Vector3::repeat(1e15);
    let mut start = Segment::default();
    start.fix.variance = Vector3::repeat(known);
    let mut segments = vec![start];
    segments.resize(count + 1, segment);
    let problem = problem(&segments);
    let at = problem.linearise::<BY_VELOCITY>(
        &guess(Vector3::zeros()),
        segments.len(),
        &Vector3::zeros(),
    );
    let duration = dt * count as f64;
    let near = |found: f64, expected: f64| {
        // The Earth has turned by a milliradian: its square.
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
    };
    for i in 3..6 {
        near(at.wander[i][i], GYRO_NOISE * duration);
    }
    near(at.wander[2][2], known + ACCEL_NOISE * duration);
    // What came in the segment j moves it in those after.
    let squares: usize = (0..count).map(|later| later * later).sum();
    let tilted = (up * dt).powi(2) * GYRO_NOISE * dt * squares as f64;
    for i in 0..2 {
        near(at.wander[i][i], known + ACCEL_NOISE * duration + tilted);
    }
    // Tilted about north it falls to the east, about east to the south: −∂v × gravity.
    let sums: usize = (0..count).sum();
    let together = up.abs() * dt * GYRO_NOISE * dt * sums as f64;
    assert!((at.wander[0][4].abs() / together - 1.0).abs() < 1e-3);
    assert!((at.wander[1][3] / at.wander[0][4] + 1.0).abs() < 1e-3);
    // Constants act as long as the window is.
    near(at.effect[3][3].abs(), duration);
    near(at.effect[8][2].abs(), duration);
}

/// A window of a sensor that turns and shakes, with velocities, or positions that hold 0.03 s late, which are not quite
/// those it makes from an attitude on.
fn shaken(mut q_nb: Quaternion, variance: Vector3) -> Vec<Segment> {
    let gravity = Vector3::new(0.0, 0.0, earth::gravity(45f64.to_radians(), 300.0));
    let (mut v, mut r) = (Vector3::new(3.0, -2.0, 0.5), Vector3::zeros());
    let mut fix = Sighting {
        v_n: v,
        variance,
        ..Sighting::default()
    };
    let mut segments = vec![Segment {
        fix,
        ..Segment::default()
    }];
    for k in 0..12 {
        let mut segment = Segment::default();
        for j in 0..5 {
            let t = f64::from(5 * k + j);
            let turn = Vector3::new(0.02 * t.sin(), 0.03 * (0.7 * t).cos(), 0.05);
            let push = Vector3::new((0.3 * t).sin(), (0.5 * t).cos(), -9.8) * 0.1;
            segment.motion.add(&turn, &push, 0.1);
            segment.omega_b = turn / 0.1;
        }
        let dt = segment.motion.dt;
        r += v * dt + q_nb * segment.motion.dpos + gravity * (0.5 * dt * dt);
        v += q_nb * segment.motion.dvel + gravity * dt;
        q_nb *= segment.motion.turn;
        let off = Vector3::new(0.1 * f64::from(k).cos(), 0.1, 0.02);
        fix.v_n = v + off;
        fix.place = r + off + v * 0.03;
        segment.fix = fix;
        segments.push(segment);
    }
    segments
}

/// ½ of the change of the cost with each unknown, against the gradient, which points down.
#[test]
fn the_gradient_is_the_slope_of_the_cost() {
    // What wanders in the attitude is taken to first order: without it the two agree.
    for (gyro_noise, tolerance) in [(1e-14, 1e-6), (GYRO_NOISE, 0.01)] {
        assert_slope::<BY_VELOCITY>(gyro_noise, tolerance, (0.0, 0.01));
        assert_slope::<BY_POSITION>(gyro_noise, tolerance, (0.0, 0.0));
    }
    // The time by which they are late is taken times the velocity at the guess, not times its slope.
    assert_slope::<BY_POSITION>(1e-14, 0.02, (0.01, 0.01));
}

fn assert_slope<const S: usize>(gyro_noise: f64, tolerance: f64, late: (f64, f64)) {
    let q_nb = from_rpy(&Vector3::new(0.1, -0.05, 0.4));
    let segments = shaken(q_nb, Vector3::new(0.01, 0.02, 0.03));
    let mut problem = problem(&segments);
    problem.gyro_noise = gyro_noise;
    (problem.by_position, problem.late) = (S == BY_POSITION, late);
    let prior = Vector3::new(1e-3, -2e-3, 1e-3);
    let start = Guess {
        q_nb,
        gyro: Vector3::new(1e-3, 2e-3, -1e-3),
        accel: Vector3::new(0.02, -0.01, 0.03),
    };
    problem.reference = start.gyro;
    let cost = |unknown: usize, by: f64| {
        let mut moved = start;
        let step = Vector3::from_fn(|i, _| if i == unknown % 3 { by } else { 0.0 });
        match unknown / 3 {
            0 => moved.q_nb *= from_rotation_vector(&step),
            1 => moved.gyro += step,
            _ => moved.accel += step,
        }
        problem.linearise::<S>(&moved, segments.len(), &prior).cost
    };
    let at = problem.linearise::<S>(&start, segments.len(), &prior);
    for unknown in 0..9 {
        let h = 1e-5;
        let slope = -0.5 * (cost(unknown, h) - cost(unknown, -h)) / (2.0 * h);
        let gradient = at.gradient[unknown];
        let scale = at.information[(unknown, unknown)].sqrt() * at.cost.sqrt();
        assert!(
            (gradient - slope).abs() < tolerance * scale,
            "{unknown}: {gradient} {slope} {scale}"
        );
    }
}

/// What the priors alone say of a guess: squared misses over their variances.
#[test]
fn a_guess_costs_what_the_priors_say() {
    let mut problem = problem(&[]);
    problem.gyro.1 = Vector3::new(1.0, 4.0, 9.0);
    problem.accel = (Vector3::new(1.0, 1.0, 1.0), Vector3::new(16.0, 25.0, 36.0));
    let at = problem.start::<BY_VELOCITY>(
        &Guess {
            gyro: Vector3::new(1.0, 2.0, 3.0),
            accel: Vector3::new(5.0, 6.0, 7.0),
            ..guess(Vector3::zeros())
        },
        &Vector3::new(3.0, 6.0, 9.0),
    );
    // Misses of 2, 4, 6 and −4, −5, −6: two standard deviations and one.
    assert!((at.cost - (3.0 * 4.0 + 3.0)).abs() < 1e-12);
    for i in 0..3 {
        let n = 1.0 + i as f64;
        assert!((at.gradient[3 + i] - 2.0 / n).abs() < 1e-12);
        assert!((at.gradient[6 + i] + 1.0 / (3.0 + n)).abs() < 1e-12);
        assert!((at.information[(3 + i, 3 + i)] - 1.0 / (n * n)).abs() < 1e-12);
        assert!((at.information[(6 + i, 6 + i)] - (3.0 + n).powi(-2)).abs() < 1e-12);
        assert_eq!((at.gradient[i], at.information[(i, i)]), (0.0, 0.0));
    }
}

#[test]
fn minima_are_the_same_where_start_and_end_are() {
    let minimum = |start: f64, end: f64| Minimum {
        guess: guess(Vector3::new(0.0, 0.0, start)),
        end: from_rpy(&Vector3::new(0.0, 0.0, end)),
        cost: 0.0,
    };
    let first = minimum(0.0, 0.0);
    assert!(first.is_near(&minimum(0.09, -0.09), 0.1));
    assert!(!first.is_near(&minimum(0.11, 0.0), 0.1) && !first.is_near(&minimum(0.0, 0.11), 0.1));
}

/// Half a minute of a vehicle that turns, speeds up and slows down, its gyros off by `gyro`; its attitude at the start.
fn driven(seed: u32, gyro: Vector3) -> (Vec<Segment>, Quaternion) {
    let phase = |k: u32| (1.7 * f64::from(seed) + 2.3 * f64::from(k)).sin() * 3.0;
    let mut q_nb = from_rpy(&Vector3::new(
        0.1 * phase(0),
        0.05 * phase(1),
        2.0 * phase(2),
    ));
    let (start, dt) = (q_nb, 0.01);
    let gravity = Vector3::new(0.0, 0.0, earth::gravity(45f64.to_radians(), 300.0));
    let mut fix = Sighting {
        v_n: Vector3::new(3.0, -2.0, 0.0),
        variance: Vector3::repeat(0.01),
        ..Sighting::default()
    };
    let mut segments = vec![Segment {
        fix,
        ..Segment::default()
    }];
    for k in 0..60 {
        let mut segment = Segment::default();
        for j in 0..50 {
            let t = f64::from(50 * k + j) * dt;
            let wave = |rate: f64, k: u32| (rate * t + phase(k)).sin();
            let [x, y, z] = [wave(0.3, 3), wave(0.41, 4), wave(0.23, 5)];
            let turn = Vector3::new(0.05 * y, 0.03 * x, 0.3 * z);
            let push = Vector3::new(1.5 * x, 2.0 * y, 0.3 * z);
            let read = (turn + gyro, q_nb.inverse() * (push - gravity));
            segment.motion.add(&(read.0 * dt), &(read.1 * dt), dt);
            segment.omega_b = read.0;
            fix.v_n += push * dt;
            q_nb *= from_rotation_vector(&(turn * dt));
        }
        segment.fix = fix;
        segments.push(segment);
    }
    (segments, start)
}

/// The axes turn by up to nine radians on the way: from the whole window alone other minima are found.
#[test]
fn a_gyro_bias_that_turns_the_window_about_is_found_from_its_beginning() {
    let std = 0.2;
    for seed in 0..16 {
        let bias = |k: u32| (3.1 * f64::from(seed) + 1.3 * f64::from(k)).sin() * 1.5 * std;
        let gyro = Vector3::new(bias(0), bias(1), bias(2));
        let (segments, start) = driven(seed, gyro);
        let mut problem = problem(&segments);
        problem.gyro.1 = Vector3::repeat(std * std);
        let found = problem.solve()[0].guess;
        // A tilt of 0.01 and one standard deviation of the accelerometer bias look alike; other minima are far off.
        let off = (found.q_nb.angle_to(&start), (found.gyro - gyro).norm());
        assert!(off.0 < 0.05 && off.1 < 5e-3, "{seed}: {off:?}");
    }
}
