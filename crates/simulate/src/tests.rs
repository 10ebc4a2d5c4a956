use super::*;
use undrift_nav::earth::{self, EARTH_RATE, Geodetic};
use undrift_nav::{Matrix3, Vector3, attitude};

/// Motions, and when they begin to turn: the tests look at the time from then on.
fn scenarios() -> [(Trajectory, f64); 3] {
    [
        Trajectory::car(200.0, 11),
        Trajectory::flight(400.0, 12),
        Trajectory::constant_turn(20.0, 0.3, 90.0),
    ]
    .map(|trajectory| {
        let turning = trajectory.turn_rate.knots().fold(f64::INFINITY, f64::min);
        let from = if turning.is_finite() {
            turning.floor() - 8.0
        } else {
            3.0
        };
        assert!(from + 60.0 < trajectory.duration);
        (trajectory, from)
    })
}

/// Noise-free samples of a whole trajectory with the truth at their ends.
fn run(trajectory: &Trajectory, rate_hz: f64) -> Simulation {
    simulate(trajectory, rate_hz, None, &GnssNoise::default(), 0).unwrap()
}

#[test]
fn parts_of_an_interval_add_up_to_it() {
    for (trajectory, from) in scenarios() {
        // Powers of two: no time is rounded. 32 and 1 Hz are cut into panels, 4 and 100 of them.
        for (rate, parts) in [(128.0, 2), (32.0, 8), (1.0, 256)] {
            let mut coarse = Stepper::new(&trajectory);
            coarse.advance_to(from);
            let mut fine = coarse.clone();
            let mut largest = 0.0f64;
            for _ in 0..(30.0 * rate) as usize {
                let (mut dtheta, mut dvel) = coarse.increments(1.0 / rate);
                largest = largest.max(dtheta.norm() * rate);
                for _ in 0..parts {
                    let (turn, push) = fine.increments(1.0 / rate / f64::from(parts));
                    dtheta -= turn;
                    dvel -= push;
                }
                // Quadrature of 25 Hz motion in panels of 5 ms: 1e-14 of 0.03 rad/s and 10 m/s²;
                // rounding of 10 m/s² · 1 s in 256 parts, 1e-15 each.
                let t = coarse.state().time;
                assert!(dtheta.norm() < 1e-13, "{rate} {t} {dtheta}");
                assert!(dvel.norm() < 1e-13, "{rate} {t} {dvel}");
            }
            assert!(largest > 0.15, "{largest}");
            let (a, b) = (coarse.state().position, fine.state().position);
            // 6000 roundings of 3e-10 m (latitude) and 2e-9 m (longitude).
            assert!(a.offset_to(&b).norm() < 5e-7);
        }
    }
}

#[test]
fn samples_at_200_hz_add_up_to_those_at_100_hz() {
    let car = Trajectory::car(120.0, 11);
    let (whole, fine) = (run(&car, 100.0), run(&car, 200.0));
    assert_eq!((whole.imu.len(), fine.imu.len()), (12_000, 24_000));
    for (sum, half) in whole.imu.iter().zip(fine.imu.chunks_exact(2)) {
        assert_eq!(sum.time, half[1].time);
        // Rounding of 0.1 m/s is 1e-17, of the nodes' times 1e-14 s.
        assert!((sum.dtheta - half[0].dtheta - half[1].dtheta).norm() < 1e-14);
        assert!((sum.dvel - half[0].dvel - half[1].dvel).norm() < 1e-13);
    }
}

/// Strapdown in the Earth-centred frame with fourth-order Runge-Kutta over pairs of increments, the
/// rate linear in each pair: shares neither frame nor Coriolis terms with what it tests.
fn strapdown_ecef(stepper: &mut Stepper, length: f64) -> (Geodetic, Vector3, Vector3) {
    let h = 1.0 / 2000.0;
    let start = stepper.state().truth();
    let ecef_from_ned = start.position.ned_from_ecef().transpose();
    let body = attitude::from_rpy(&start.rpy.unwrap()).to_rotation_matrix();
    let mut c: Matrix3 = ecef_from_ned * body.matrix();
    let mut v: Vector3 = ecef_from_ned * start.v_n.unwrap();
    let mut r = start.position.to_ecef();
    let earth_rate = Vector3::new(0.0, 0.0, EARTH_RATE);
    let slope = |c: &Matrix3, v: &Vector3, r: &Vector3, omega: &Vector3, f: &Vector3| {
        let here = Geodetic::from_ecef(r);
        let down = -Vector3::new(
            here.lat.cos() * here.lon.cos(),
            here.lat.cos() * here.lon.sin(),
            here.lat.sin(),
        );
        let gravity = down * earth::gravity(here.lat, here.height);
        (
            c * attitude::skew(omega) - attitude::skew(&earth_rate) * c,
            c * f + gravity - 2.0 * earth_rate.cross(v),
            *v,
        )
    };
    for _ in 0..(length / h).round() as usize {
        let (first, second) = (stepper.increments(h / 2.0), stepper.increments(h / 2.0));
        // From the means of both halves to the start, the middle and the end.
        let line = |a: Vector3, b: Vector3| [3.0 * a - b, a + b, 3.0 * b - a].map(|x| x / h);
        let w = line(first.0, second.0);
        let f = line(first.1, second.1);
        let k1 = slope(&c, &v, &r, &w[0], &f[0]);
        let at = |k: &(Matrix3, Vector3, Vector3), s: f64| (c + k.0 * s, v + k.1 * s, r + k.2 * s);
        let (c2, v2, r2) = at(&k1, h / 2.0);
        let k2 = slope(&c2, &v2, &r2, &w[1], &f[1]);
        let (c3, v3, r3) = at(&k2, h / 2.0);
        let k3 = slope(&c3, &v3, &r3, &w[1], &f[1]);
        let (c4, v4, r4) = at(&k3, h);
        let k4 = slope(&c4, &v4, &r4, &w[2], &f[2]);
        c += (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0) * (h / 6.0);
        v += (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1) * (h / 6.0);
        r += (k1.2 + 2.0 * k2.2 + 2.0 * k3.2 + k4.2) * (h / 6.0);
    }
    let position = Geodetic::from_ecef(&r);
    let ned = position.ned_from_ecef();
    let body = nalgebra::Rotation3::from_matrix_unchecked(ned * c);
    let q = undrift_nav::Quaternion::from_rotation_matrix(&body);
    (position, ned * v, attitude::to_rpy(&q))
}

#[test]
fn independent_strapdown_returns_the_truth() {
    for (trajectory, from) in scenarios() {
        let mut stepper = Stepper::new(&trajectory);
        stepper.advance_to(from);
        let start = stepper.state();
        let (position, v_n, rpy) = strapdown_ecef(&mut stepper, 60.0);
        let end = stepper.state().truth();
        let miss = end.position.offset_to(&position);
        // Runge-Kutta with 25 Hz motion at 0.5 ms is 1e-6 m off (measured), and rounding of 6e6 m in
        // 120000 steps as much; a term forgotten, e.g. transport rate in the Coriolis force, is cm.
        assert!(miss.norm() < 1e-5, "{miss}");
        assert!((v_n - end.v_n.unwrap()).norm() < 5e-8, "{v_n}");
        let turned = (rpy - end.rpy.unwrap()).map(earth::wrap_pi);
        assert!(turned.norm() < 1e-9, "{turned}");
        // It went somewhere.
        assert!(start.position.offset_to(&position).norm() > 50.0);
    }
}

#[test]
fn at_rest_the_sensors_feel_gravity_and_the_earth() {
    let trajectory = Trajectory::rest(10.0);
    let log = run(&trajectory, 50.0);
    let here = trajectory.start;
    let up = -earth::gravity(here.lat, here.height);
    for sample in &log.imu {
        let omega = sample.dtheta / sample.dt;
        let force = sample.dvel / sample.dt;
        assert!((omega - earth::earth_rate_n(here.lat)).norm() < 1e-18);
        assert!((force - Vector3::new(0.0, 0.0, up)).norm() < 1e-13);
    }
    assert!(log.truth.iter().all(|t| t.position == here));
    let (omega, force) = Stepper::new(&trajectory).state().felt();
    assert_eq!((omega, force.z), (earth::earth_rate_n(here.lat), up));
}

#[test]
fn position_does_not_depend_on_the_steps() {
    let trajectory = Trajectory::car(200.0, 4);
    let log = run(&trajectory, 200.0);
    let mut stepper = Stepper::new(&trajectory);
    for k in (0..log.truth.len()).step_by(1733) {
        let truth = &log.truth[k];
        // By way of a time that is no epoch.
        stepper.advance_to(truth.time - 0.0123);
        stepper.advance_to(truth.time);
        stepper.advance_to(truth.time - 5.0); // backwards: nothing
        let state = stepper.state();
        assert_eq!(state.time, truth.time);
        // 40000 roundings of 2e-9 m, at random.
        assert!(state.position.offset_to(&truth.position).norm() < 2e-6);
        assert!((state.motion.v_n - truth.v_n.unwrap()).norm() < 1e-13);
    }
}

#[test]
fn antenna_velocity_is_the_rate_of_its_position() {
    let arm = Vector3::new(0.8, -0.5, -1.2);
    for (trajectory, from) in scenarios() {
        let h = 1e-3;
        let mut reach = 0.0f64;
        let mut stepper = Stepper::new(&trajectory);
        for k in 0..60 {
            let t = from + f64::from(k) * 0.97;
            let [a, b, (here, v_n), d, e] = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|i| {
                stepper.advance_to(t + i * h);
                antenna(&stepper.state(), &arm)
            });
            let ecef = |p: &(Geodetic, Vector3)| p.0.to_ecef();
            let difference = (8.0 * (ecef(&d) - ecef(&b)) - (ecef(&e) - ecef(&a))) / (12.0 * h);
            // ECEF rounds at 1e-9 m: over 1 ms 2e-6 m/s. Truncation h⁴/30 · x⁽⁵⁾ of two waves with
            // x⁽⁵⁾ = 2e-4 m · (150 rad/s)⁵ is 1e-6.
            let miss = here.ned_from_ecef() * difference - v_n;
            assert!(miss.norm() < 1e-5, "{t} {miss}");
            reach = reach.max((v_n - trajectory.velocity(t)).norm());
        }
        // The arm's own motion is in it.
        assert!(reach > 0.1, "{reach}");
    }
    let still = Stepper::new(&Trajectory::rest(1.0)).state();
    let (position, v_n) = antenna(&still, &arm);
    // Level and heading north: the arm is its own north-east-down offset.
    assert!((still.position.ned_to(&position) - arm).norm() < 1e-8);
    assert!(v_n.norm() < 1e-18);
}

#[test]
fn seeds() {
    let filter = ShapingFilter::white(1e-3, 0.02)
        .and_then(|w| w.plus(&ShapingFilter::constant(0.1, 0.02)?))
        .unwrap();
    let filters = [filter; 6];
    let gnss = GnssNoise::default();
    let with = |drive, seed| {
        simulate(
            &Trajectory::car(130.0, drive),
            50.0,
            Some(&filters),
            &gnss,
            seed,
        )
        .unwrap()
    };
    let bytes = |s: &Simulation| format!("{s:?}");
    assert_eq!(bytes(&with(1, 1)), bytes(&with(1, 1)));
    let (a, b, c) = (with(1, 1), with(1, 2), with(2, 1));
    assert_eq!(a.truth, b.truth);
    assert!(a.imu[0] != b.imu[0] && a.gnss[0] != b.gnss[0]);
    assert_ne!(a.truth.last(), c.truth.last());
    assert_ne!(Trajectory::flight(200.0, 1), Trajectory::flight(200.0, 2));
}

/// Extremes of a trajectory, sampled at 20 Hz.
#[derive(Default)]
struct Extremes {
    speed: f64,
    turn_rate: f64,
    force: f64,
    roll: f64,
    height: f64,
    last_height: f64,
    resting: f64,
}

fn extremes(trajectory: &Trajectory) -> Extremes {
    let mut found = Extremes::default();
    let mut stepper = Stepper::new(trajectory);
    for k in 0..(20.0 * trajectory.duration) as u32 {
        stepper.advance_to(f64::from(k) / 20.0);
        let state = stepper.state();
        let (m, truth) = (state.motion, state.truth());
        found.speed = found.speed.max(m.v_n.norm());
        let turn = trajectory.turn_rate.at(truth.time).value;
        found.turn_rate = found.turn_rate.max(turn.abs());
        found.force = found.force.max(m.dv_n.norm());
        found.roll = found.roll.max(truth.rpy.unwrap().x.abs());
        let climbed = truth.position.height - trajectory.start.height;
        found.height = found.height.max(climbed.abs());
        found.last_height = climbed;
        found.resting += if m.v_n.norm() == 0.0 { 0.05 } else { 0.0 };
    }
    found
}

#[test]
fn cars_drive_like_cars() {
    for seed in 0..12 {
        let car = Trajectory::car(600.0, seed);
        let e = extremes(&car);
        assert!((7.0..=17.0).contains(&e.speed), "{seed} {}", e.speed);
        let fastest_turn = e.turn_rate.to_degrees();
        assert!((10.0..27.0).contains(&fastest_turn), "{fastest_turn}");
        // Lateral 6.5 m/s · 26°/s = 3 m/s².
        assert!((1.0..4.0).contains(&e.force), "{seed} {}", e.force);
        assert!(e.roll.to_degrees() < 6.0 && e.height < 60.0, "{seed}");
        // At rest for 60 s, then at lights, and at the end.
        assert!((64.0..250.0).contains(&e.resting), "{seed} {}", e.resting);
        assert_eq!(car.velocity(REST_BEFORE), Vector3::zeros());
        assert_eq!(car.velocity(car.duration - 5.0), Vector3::zeros());
        assert!(car.knots().last().unwrap() <= &(car.duration - 4.999_999));
        // The wheels never roll back.
        assert!((0..6000).all(|i| car.speed.at(f64::from(i) / 10.0).value >= -1e-12));
    }
}

#[test]
fn flights_fly_like_aeroplanes() {
    for seed in 0..12 {
        let flight = Trajectory::flight(900.0, seed);
        let e = extremes(&flight);
        assert!((40.0..=60.1).contains(&e.speed), "{seed} {}", e.speed);
        assert!((200.0..1100.0).contains(&e.height), "{seed} {}", e.height);
        let bank = e.roll.to_degrees();
        assert!((20.0..48.0).contains(&bank), "{seed} {bank}");
        assert!((59.9..61.0).contains(&e.resting), "{seed} {}", e.resting);
        assert!(e.last_height > 100.0, "{seed} {}", e.last_height);
    }
}

#[test]
fn odd_input_is_refused_or_harmless() {
    let rest = Trajectory::rest(10.0);
    let gnss = GnssNoise::default();
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(
            simulate(&rest, rate, None, &gnss, 0),
            Err(SimulationError::Rate)
        );
        assert!(IdealImu::new(&rest, rate).next().is_none());
    }
    let pole = Trajectory {
        start: Geodetic::from_degrees(90.0, 0.0, 0.0),
        ..rest.clone()
    };
    assert_eq!(
        simulate(&pole, 10.0, None, &gnss, 0),
        Err(SimulationError::Start)
    );
    assert_eq!(
        simulate(&rest, 1e12, None, &gnss, 0),
        Err(SimulationError::TooLong)
    );
    let often = GnssNoise {
        rate_hz: 1e300,
        ..gnss
    };
    assert_eq!(
        simulate(&rest, 10.0, None, &often, 0),
        Err(SimulationError::TooLong)
    );
    for duration in [f64::NAN, -3.0, 0.0, 0.05] {
        let log = run(&Trajectory::car(duration, 1), 10.0);
        assert_eq!((log.imu.len(), log.truth.len()), (0, 1));
    }
    // A duration set by hand, longer than a walk may be; a wave too fast to follow.
    let mut endless = Trajectory::straight(1.0, 0.0, 1.0);
    endless.duration = f64::INFINITY;
    endless.roll.waves.push(Wave {
        amplitude: 0.0,
        period: 1e-300,
        phase: 0.0,
    });
    assert_eq!(IdealImu::new(&endless, 1.0).take(3).count(), 3);
    let mut stepper = Stepper::new(&rest);
    stepper.advance_to(f64::NAN);
    assert_eq!(stepper.increments(f64::INFINITY).0, Vector3::zeros());
    assert_eq!(stepper.state().time, 0.0);
}

/// A turn: its start, end and length of its rounding \[s\], and its angle \[rad\].
#[derive(Clone, Copy, Debug)]
struct Turned {
    start: f64,
    end: f64,
    rounding: f64,
    angle: f64,
}

/// The turns of a trajectory: each is a step to its rate and one back to zero.
fn turns(trajectory: &Trajectory) -> Vec<Turned> {
    let profile = &trajectory.turn_rate;
    let knots: Vec<f64> = profile.knots().collect();
    let turns = knots.chunks_exact(4).map(|k| Turned {
        start: k[0],
        end: k[3],
        rounding: k[1] - k[0],
        angle: profile.at(k[3]).integral - profile.at(k[0]).integral,
    });
    turns.collect()
}

/// Rounding of the car's turns \[s\].
const CAR_TURN: f64 = 1.2;

#[test]
fn cars_turn_while_their_speed_is_constant() {
    let (mut bends, mut pairs, mut corners) = (0, 0, 0);
    for seed in 0..100 {
        let car = Trajectory::car(600.0, seed);
        for turn in turns(&car) {
            for time in [turn.start, turn.end] {
                let rate = car.speed.at(time).rate;
                // Rounding of 1 m/s² in 600 s.
                assert!(rate.abs() < 1e-9, "{seed} {time}: {rate}");
            }
        }
        for time in car.speed.knots() {
            let rate = car.turn_rate.at(time).value;
            assert!(rate.abs() < 1e-9, "{seed} {time}: {rate}");
        }
        let turns = turns(&car);
        for (k, turn) in turns.iter().enumerate() {
            let (angle, length) = (turn.angle.abs().to_degrees(), turn.end - turn.start);
            let speed = car.speed.at(turn.start).value;
            if angle > 40.0 {
                corners += 1;
                assert!((70.0..100.0).contains(&angle), "{seed} {angle}");
                assert!((5.0..7.0).contains(&length), "{seed} {length}");
                assert!((4.0..6.5).contains(&speed), "{seed} {speed}");
                continue;
            }
            bends += 1;
            assert!((4.0 - 1e-9..15.0).contains(&angle), "{seed} {angle}");
            assert!((7.0..17.0).contains(&speed), "{seed} {speed}");
            // At 2 to 4 deg/s but for the rounding.
            let rate = angle / (length - CAR_TURN);
            assert!((2.0 - 1e-9..4.0 + 1e-9).contains(&rate), "{seed} {rate}");
            // One that follows at once leads back.
            let next = turns.get(k + 1).filter(|next| next.start == turn.end);
            if let Some(next) = next {
                pairs += 1;
                assert!((next.angle + turn.angle).abs() < 1e-12, "{seed} {turn:?}");
            }
        }
    }
    println!("{bends} bends, {pairs} of them with one back, {corners} corners");
    assert!(bends > 300 && pairs > 100 && corners > 600);
}

#[test]
fn cars_speed_up_and_brake_as_they_should() {
    let (mut stops, mut shortest, mut longest) = (0, f64::INFINITY, 0.0f64);
    for seed in 0..100 {
        let car = Trajectory::car(600.0, seed);
        let knots: Vec<f64> = car.speed.knots().collect();
        for (from, to) in knots.iter().zip(&knots[1..]) {
            let (from_to, middle) = ([*from, *to], 0.5 * (from + to));
            let [before, after] = from_to.map(|time| car.speed.at(time).value);
            let accel = car.speed.at(middle).rate.abs();
            // Speeds up at 0.8 to 1.8 m/s², brakes at 2 m/s² at most.
            assert!(
                accel < if after > before { 1.8 } else { 2.0 } + 1e-9,
                "{seed}"
            );
            if before == 0.0 && after == 0.0 && *to > *from {
                stops += 1;
                (shortest, longest) = (shortest.min(to - from), longest.max(to - from));
            }
        }
        assert_eq!(knots[0], REST_BEFORE);
    }
    // Two in ten corners or so: 5 to 20 s each.
    println!("{stops} stops of {shortest} to {longest} s");
    assert!(stops > 100);
    assert!((5.0 - 1e-9..7.0).contains(&shortest) && (18.0..20.0 + 1e-9).contains(&longest));
}

#[test]
fn aeroplanes_roll_into_coordinated_turns_at_a_limited_rate() {
    let (mut banks, mut angles) = (Vec::new(), Vec::new());
    for seed in 0..40 {
        let flight = Trajectory::flight(900.0, seed);
        for turn in turns(&flight) {
            let middle = 0.5 * (turn.start + turn.end);
            let rate = flight.turn_rate.at(middle).value.abs();
            let speed = flight.speed.at(middle).value;
            let bank = (rate * speed / earth::STANDARD_GRAVITY).atan();
            angles.push(turn.angle.abs().to_degrees());
            // One that is too small for its bank goes straight from rolling in to rolling out.
            if turn.end - turn.start - 2.0 * turn.rounding > 1e-6 {
                banks.push(bank.to_degrees());
                let fastest = 2.1875 * bank / turn.rounding;
                assert!(
                    (fastest.to_degrees() - 15.0).abs() < 1e-6,
                    "{seed} {turn:?}"
                );
            }
            assert!(
                turn.end < flight.duration + turn.rounding,
                "{seed} {turn:?}"
            );
        }
    }
    let ends = |values: &[f64]| {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        (least, values.iter().copied().fold(0.0, f64::max))
    };
    // Of some hundred draws the extremes come near to the ends: within a fiftieth of the range.
    let (least, most) = ends(&angles);
    assert!((60.0 - 1e-9..64.0).contains(&least) && (266.0..270.0 + 1e-9).contains(&most));
    let (least, most) = ends(&banks);
    assert!((20.0 - 1e-9..22.0).contains(&least) && (43.0..45.0 + 1e-9).contains(&most));
}

#[test]
fn aeroplanes_lift_off_and_climb_to_their_height() {
    let mut tops = Vec::new();
    for seed in 0..40 {
        let flight = Trajectory::flight(300.0, seed);
        let climb = &flight.climb.profile;
        let knots: Vec<f64> = climb.knots().take(4).collect();
        let [start, climbing, top, level] = knots[..] else {
            panic!("{knots:?}");
        };
        let speed_at = |time: f64| flight.speed.at(time).value;
        let speed = speed_at(climbing + 20.0);
        // The climb begins at 70 % of the speed, and the nose has come up by then.
        assert!((speed_at(start) / speed - 0.7).abs() < 1e-9, "{seed}");
        let pitch = &flight.pitch.profile;
        assert_eq!(pitch.at(start - 1.5).value, 0.0);
        assert!((pitch.at(start + 1.5).value.to_degrees() - 3.0).abs() < 1e-9);
        let slope = climb.at(climbing).value;
        assert!((4.0..7.0).contains(&slope.to_degrees()), "{seed} {slope}");
        assert!((level - top - 5.0).abs() < 1e-9 && (climbing - start - 5.0).abs() < 1e-9);
        assert_eq!(climb.at(level).value, 0.0);
        tops.push(speed * slope.sin() * (top - climbing));
    }
    let least = tops.iter().copied().fold(f64::INFINITY, f64::min);
    let most = tops.iter().copied().fold(0.0, f64::max);
    // 250 to 500 m; of forty draws the extremes within a tenth of the range.
    assert!((250.0..275.0).contains(&least), "{least}");
    assert!((475.0..500.0).contains(&most), "{most}");
}

#[test]
fn cars_stand_for_the_last_five_seconds() {
    let mut late = Vec::new();
    // Of the first few thousand the two that turn last.
    for seed in (0..300u32).chain([936, 2154]) {
        let duration = 120.0 + f64::from(seed % 400);
        let car = Trajectory::car(duration, seed.into());
        let end = car.knots().into_iter().fold(0.0, f64::max);
        // Rounding of some hundred seconds.
        if end > duration - 5.0 + 1e-9 {
            late.push((seed, end - duration + 5.0));
        }
    }
    assert!(late.is_empty(), "{late:?}");
}

#[test]
fn aeroplanes_climb_when_low_and_descend_when_high() {
    let (mut low, mut high) = (0, 0);
    for seed in 0..40 {
        let flight = Trajectory::flight(6000.0, seed);
        let climb = &flight.climb.profile;
        let knots: Vec<f64> = climb.knots().collect();
        let (mut time, mut height) = (0.0, 0.0);
        let step = 0.5;
        // Each change of height is a step to its slope and one back; the first is the climb.
        for change in knots.chunks_exact(4).skip(1) {
            while time < change[0] {
                let slope: f64 = climb.at(time).value;
                height += flight.speed.at(time).value * slope.sin() * step;
                time += step;
            }
            let slope = climb.at(change[1]).value;
            // The drawn height is without the roundings of the first climb, 5 s at 7° and 60 m/s at most.
            if height < 195.0 {
                low += 1;
                assert!(slope > 0.0, "{seed}: {height}");
            }
            if height > 840.0 {
                high += 1;
                assert!(slope < 0.0, "{seed}: {height}");
            }
        }
    }
    println!("{low} low, {high} high");
    assert!(low > 10 && high > 5);
}

#[test]
fn cars_that_are_late_brake_no_harder_than_it_takes_to_stand_in_time() {
    let mut late = 0;
    for seed in (0..300u32).chain([936, 2154]) {
        let duration = 120.0 + f64::from(seed % 400);
        let car = Trajectory::car(duration, seed.into());
        let knots: Vec<f64> = car.speed.knots().collect();
        let in_time = (knots.last().unwrap() - (duration - 5.0)).abs() < 1e-9;
        let rates = knots.windows(2).rev().take(3).map(|pair| {
            let middle = 0.5 * (pair[0] + pair[1]);
            -car.speed.at(middle).rate
        });
        let brakes = rates.fold(0.0, f64::max);
        // Home at 1.5 m/s² or a little harder, at lights at 1.8 m/s² at most.
        assert!(brakes < 1.8, "{seed}: {brakes}");
        late += i32::from(in_time && brakes > 1.5 + 1e-6);
    }
    assert!(late > 0);
}
