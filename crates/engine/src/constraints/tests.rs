//! What is known of a vehicle, in closed form.

use super::{zero_velocity::nis_of_rest, *};
use crate::{
    estimator::build,
    rest::RestBlock,
    tests::{driving_north, sensors},
    vehicle::{Air, NonHolonomic},
};
use alloc::boxed::Box;
use undrift_events::Aid;
use undrift_nav::{
    Matrix3, Vector3,
    attitude::from_rpy,
    earth::{Geodetic, earth_rate_n, gravity},
    filter::InitialStd,
    mechanisation::NavState,
    parameters::Parameters,
    sample::FixQuality,
};

/// Level, with this velocity and standard deviations of it.
fn moving(v_n: Vector3, std: Vector3) -> Box<dyn Estimator> {
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n,
        q_nb: from_rpy(&Vector3::zeros()),
    };
    let std = InitialStd {
        position: Vector3::repeat(0.5),
        velocity: std,
        attitude: Vector3::repeat(0.01),
    };
    build(nav, &std, &sensors(), Parameters::none()).unwrap()
}

#[test]
fn a_velocity_at_rest_is_compared_with_its_own_and_the_rests_variance() {
    let v = Vector3::new(0.3, -0.8, 0.5);
    let std = Vector3::new(0.3, 0.4, 1.2);
    let filter = moving(v, std);
    let expected = 0.09 / (0.09 + 0.25) + 0.64 / (0.16 + 0.25) + 0.25 / (1.44 + 0.25);
    assert!((nis_of_rest(&*filter, 0.5) - expected).abs() < 1e-12);
}

#[test]
fn a_sensor_at_rest_reads_the_earth_and_gravity_and_its_own_error() {
    let rpy = Vector3::new(0.1, -0.2, 2.0);
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: Vector3::zeros(),
        q_nb: from_rpy(&rpy),
    };
    let std = InitialStd {
        position: Vector3::repeat(1.0),
        velocity: Vector3::repeat(1.0),
        attitude: Vector3::repeat(0.1),
    };
    let mut filter = build(nav, &std, &sensors(), Parameters::none()).unwrap();
    let error = [1e-3, 2e-3, 3e-3, 0.1, 0.2, 0.3];
    filter.set_sensor_error(&error);
    let (rate, force) = zero_velocity::readings(&*filter);
    let to_body = nav.q_nb.inverse();
    let place = &nav.position;
    let earth = to_body * earth_rate_n(place.lat);
    let up = to_body * Vector3::new(0.0, 0.0, -gravity(place.lat, place.height));
    assert!((rate - earth - Vector3::new(1e-3, 2e-3, 3e-3)).norm() < 1e-12);
    assert!((force - up - Vector3::new(0.1, 0.2, 0.3)).norm() < 1e-12);
}

fn block(confirmed: bool) -> RestBlock {
    RestBlock {
        rest: true,
        confirmed,
        rate: Vector3::zeros(),
        duration: 1.0,
    }
}

/// Applies a block's zero-velocity update: whether the vehicle is at rest, whether that was known before, and the speed \[m/s\].
fn rest_by_speed(speed: f64, stood: bool, block: &RestBlock) -> (bool, bool, f64) {
    let mut settings = Settings::new(sensors());
    settings.constraints.zero_velocity = Some(0.05);
    let mut filter = moving(Vector3::new(speed, 0.0, 0.0), Vector3::repeat(0.05));
    let (mut stood, mut summary) = (stood, Summary::default());
    let rest = zero_velocity::update(&mut *filter, block, &mut stood, &settings, &mut summary);
    (rest, stood, filter.nav().v_n.x)
}

#[test]
fn a_start_after_a_rest_is_no_rest() {
    // NIS of v²/(0.05² + 0.05²), 21.1 at the limit.
    let limit = (21.1f64 * 2.0 * 0.05 * 0.05).sqrt();
    let unseen = block(false);
    let (rest, stood, speed) = rest_by_speed(1.001 * limit, true, &unseen);
    assert!(!rest && stood && speed == 1.001 * limit);
    let (rest, _, speed) = rest_by_speed(0.999 * limit, true, &unseen);
    assert!(rest && speed < 0.999 * limit);
    // Before it stood, or where the fixes confirm it, there is no start: it is held.
    assert!(rest_by_speed(1.001 * limit, false, &unseen).2 < 1.001 * limit);
    assert!(rest_by_speed(1.001 * limit, true, &block(true)).2 < 0.9 * limit);
    let moves = RestBlock {
        rest: false,
        ..block(true)
    };
    assert_eq!(rest_by_speed(0.1, true, &moves), (false, false, 0.1));
}

#[test]
fn what_only_the_sensors_see_holds_the_velocity_less() {
    let speed = 0.01;
    // Equal variances halve it; ten times the standard deviation takes a hundred and first part away.
    let (rest, stood, held) = rest_by_speed(speed, false, &block(true));
    assert!(rest && stood && (held / speed - 0.5).abs() < 1e-9, "{held}");
    let (rest, stood, held) = rest_by_speed(speed, false, &block(false));
    assert!(
        rest && stood && (held / speed - 100.0 / 101.0).abs() < 1e-9,
        "{held}"
    );
    // A solution that is sure to move: rejected beyond a NIS of 100.
    let sure = (101.0f64 * 2.0 * 0.05 * 0.05).sqrt();
    assert_eq!(
        rest_by_speed(sure, false, &block(true)),
        (false, false, sure)
    );
    // One that is weakened had not detected the rest.
    let weakened = (50.0f64 * 2.0 * 0.05 * 0.05).sqrt();
    let (rest, stood, _) = rest_by_speed(weakened, false, &block(true));
    assert!(rest && !stood);
}

/// A fix with a velocity whose standard deviations are `std` north and east.
fn fix(time: f64, v_n: Vector3, std: f64) -> GnssFix {
    GnssFix {
        attitude: None,
        mean_velocity: None,
        time,
        position: None,
        velocity: Some((v_n, Matrix3::identity() * (std * std))),
        quality: FixQuality::Unknown,
    }
}

#[test]
fn a_fix_leaves_speeds_within_its_error() {
    let settings = Settings::new(sensors());
    let mut vehicle = Vehicle::new(&settings);
    let mut filter = driving_north(5.0);
    let error = 2f64.sqrt() * 0.5;
    for (v, least) in [((3.0, 4.0), 5.0 - error), ((0.3, 0.4), 0.0)] {
        let v = Vector3::new(v.0, v.1, -9.0);
        vehicle.fix(&mut *filter, &fix(7.0, v, 0.5), &settings);
        let (time, (low, high)) = vehicle.last_speed.unwrap();
        assert_eq!(time, 7.0);
        assert!((low - least).abs() < 1e-12, "{low}");
        assert!((high - v.xy().norm() - error).abs() < 1e-12, "{high}");
    }
    // A position alone says nothing of the speed at first.
    let none = GnssFix {
        velocity: None,
        ..fix(8.0, Vector3::zeros(), 0.5)
    };
    vehicle.fix(&mut *filter, &none, &settings);
    let moves = MOVES;
    assert_eq!(vehicle.last_speed, Some((8.0, (moves, f64::INFINITY))));
}

/// A course of 0.02 rad against a heading of 0 that is known to σ₀: its share of the whole is σ₀²/(σ₀² + R).
#[test]
fn a_course_has_the_noise_of_its_speed_and_of_its_slip() {
    let heading = |min_speed: f64, speed: f64| {
        let mut settings = Settings::new(sensors());
        settings.constraints.course = Some((0.03, min_speed));
        let mut filter = moving(
            Vector3::new(speed, 0.02 * speed, 0.0),
            Vector3::repeat(1e-9),
        );
        let v = Vector3::new(speed * 0.02f64.cos(), speed * 0.02f64.sin(), 0.0);
        Vehicle::new(&settings).fix(&mut *filter, &fix(1.0, v, 0.2), &settings);
        undrift_nav::attitude::to_rpy(&filter.nav().q_nb).z
    };
    let r = 0.2f64.powi(2) / 100.0 + 0.03 * 0.03;
    let expected = 0.02 * 1e-4 / (1e-4 + r);
    // To the second order of 0.02.
    assert!(
        (heading(9.0, 10.0) / expected - 1.0).abs() < 1e-3,
        "{}",
        heading(9.0, 10.0)
    );
    assert_eq!(heading(10.5, 10.0), 0.0);
}

/// A velocity of 0.1 m/s to the right is taken back by its share.
#[test]
fn wheels_hold_a_velocity_to_the_right_and_down() {
    let rule = NonHolonomic {
        right: 0.2,
        down: 0.4,
        slip: 0.0,
        interval: 1.0,
        lever: Vector3::zeros(),
        min_speed: 1.0,
    };
    let mut settings = Settings::new(sensors());
    settings.constraints.non_holonomic = Some(rule);
    // The attitude cannot be to blame: it is known to a millionth.
    let nav = NavState {
        v_n: Vector3::new(10.0, 0.1, 0.2),
        ..*moving(Vector3::zeros(), Vector3::repeat(1.0)).nav()
    };
    let std = InitialStd {
        position: Vector3::repeat(0.5),
        velocity: Vector3::repeat(0.2),
        attitude: Vector3::repeat(1e-6),
    };
    let built = || build(nav, &std, &sensors(), Parameters::none()).unwrap();
    let mut filter = built();
    let update = constrained(&mut *filter, &rule).unwrap();
    assert_eq!(update.dof, 2);
    let v = filter.nav().v_n;
    // Equal variances to the right, a fifth of the whole down.
    assert!(
        (v.y - 0.05).abs() < 1e-5 && (v.z - 0.2 * 0.8).abs() < 1e-5,
        "{v}"
    );
    assert!(
        (update.nis - (0.01 / 0.08 + 0.04 / 0.2)).abs() < 1e-6,
        "{}",
        update.nis
    );
    // At the end of a sample, once an interval, and above its least speed.
    let mut vehicle = Vehicle::new(&settings);
    let mut summary = Summary::default();
    let mut filter = built();
    let mut applied = |time: f64, settings: &Settings| {
        let sample = ImuSample {
            time,
            dt: 0.02,
            dtheta: Vector3::zeros(),
            dvel: Vector3::zeros(),
        };
        let before = summary.innovations[Aid::NonHolonomic].updates;
        vehicle.end_sample(&mut *filter, &sample, None, settings, &mut summary, &mut ());
        summary.innovations[Aid::NonHolonomic].updates - before
    };
    let mut slow = settings.clone();
    slow.constraints.non_holonomic = Some(NonHolonomic {
        min_speed: 10.5,
        ..rule
    });
    assert_eq!(applied(4.0, &slow), 0);
    // Half a sample early is as near as it comes.
    let times = [5.0, 5.02, 5.98, 5.992, 6.98, 6.99];
    assert_eq!(
        times.map(|time| applied(time, &settings)),
        [1, 0, 0, 1, 0, 1]
    );
}

/// A turn of 0.5 rad/s at 10 m/s is 5 m/s² to the side: with a slip of 0.02 s the wheels slide by 0.1 m/s more.
#[test]
fn wheels_slip_with_the_force_to_the_side() {
    let after = |turn: f64, right: f64, slip: f64| {
        let rule = NonHolonomic {
            right,
            down: 0.4,
            slip,
            interval: 1.0,
            lever: Vector3::zeros(),
            min_speed: 1.0,
        };
        let nav = NavState {
            v_n: Vector3::new(10.0, 0.1, 0.0),
            ..*moving(Vector3::zeros(), Vector3::repeat(1.0)).nav()
        };
        let std = InitialStd {
            position: Vector3::repeat(0.5),
            velocity: Vector3::repeat(0.2),
            attitude: Vector3::repeat(1e-6),
        };
        let mut filter = build(nav, &std, &sensors(), Parameters::none()).unwrap();
        filter.begin(&ImuSample {
            time: 0.01,
            dt: 0.01,
            dtheta: Vector3::new(0.0, 0.0, turn * 0.01),
            // It goes the way that it looks.
            dvel: Vector3::new(0.0, 10.0 * turn * 0.01, -0.0981),
        });
        filter.advance(None);
        constrained(&mut *filter, &rule).unwrap();
        filter.nav().v_n.y
    };
    for turn in [0.5, -0.5] {
        let (slipping, wider) = (after(turn, 0.2, 0.02), after(turn, 0.3, 0.0));
        // The Earth and the way over it turn by 1e-4 rad/s.
        assert!((slipping - wider).abs() < 1e-5, "{slipping} {wider}");
        assert!((slipping - after(turn, 0.2, 0.0)).abs() > 0.01);
    }
    assert!((after(0.0, 0.2, 0.02) - after(0.0, 0.2, 0.0)).abs() < 1e-5);
}

/// The mean of the gyros over a rest of 4 s has the white noise of 5e-3 °/√s over two and the rule's own.
#[test]
fn a_rest_measures_the_gyros_with_the_noise_of_its_mean() {
    let own = 2e-3f64.to_radians();
    let white = 5e-3f64.to_radians() / 2.0;
    let off = [4e-3, -6e-3, 5e-3].map(f64::to_radians);
    let mut settings = Settings::new(sensors());
    settings.constraints.zero_angular_rate = Some(own);
    let nav = *moving(Vector3::zeros(), Vector3::repeat(1.0)).nav();
    let std = InitialStd {
        position: Vector3::repeat(0.5),
        velocity: Vector3::repeat(0.2),
        attitude: Vector3::repeat(1e-9),
    };
    let mut filter = build(nav, &std, &sensors(), Parameters::none()).unwrap();
    let known = filter.sensor_error_std();
    let rest = RestBlock {
        rate: earth_rate_n(nav.position.lat) + Vector3::from(off),
        duration: 4.0,
        ..block(true)
    };
    let (mut stood, mut summary) = (false, Summary::default());
    let at_rest =
        |filter: &mut dyn Estimator, rest: &RestBlock, stood: &mut bool, summary: &mut Summary| {
            zero_velocity::update(filter, rest, stood, &settings, summary)
        };
    let moves = RestBlock {
        rest: false,
        ..rest
    };
    assert!(!at_rest(&mut *filter, &moves, &mut stood, &mut summary));
    assert_eq!(filter.sensor_error()[0], 0.0);
    assert!(at_rest(&mut *filter, &rest, &mut stood, &mut summary));
    let found = filter.sensor_error();
    for axis in 0..3 {
        let variance = known[axis] * known[axis];
        let expected = off[axis] * variance / (variance + white * white + own * own);
        let error = found[axis] - expected;
        assert!(
            error.abs() < 1e-6 * off[0],
            "{axis}: {} {expected}",
            found[axis]
        );
    }
}

/// One update of a vehicle that has not slipped so far.
fn constrained(filter: &mut dyn Estimator, rule: &NonHolonomic) -> Option<Update> {
    let (mut slip, mut summary) = (Slip::default(), Summary::default());
    non_holonomic::update(filter, rule, &mut slip, false, &mut summary)
}

/// A velocity to the right of 0.6 m/s, which the filter is sure of, is three standard deviations: NIS 9 for one of two components.
#[test]
fn a_vehicle_that_slips_is_held_less_where_fixes_show_it() {
    let rule = NonHolonomic {
        slip: 0.0,
        ..NonHolonomic::CAR
    };
    let sure = || {
        let nav = NavState {
            v_n: Vector3::new(10.0, 0.6, 0.0),
            ..*moving(Vector3::zeros(), Vector3::repeat(1.0)).nav()
        };
        let std = InitialStd {
            position: Vector3::repeat(0.5),
            velocity: Vector3::repeat(1e-4),
            attitude: Vector3::repeat(1e-6),
        };
        build(nav, &std, &sensors(), Parameters::none()).unwrap()
    };
    let after = |updates: usize, aided: bool| {
        let (mut slip, mut summary) = (Slip::default(), Summary::default());
        let mut last = 0.0;
        for _ in 0..updates {
            let update = non_holonomic::update(&mut *sure(), &rule, &mut slip, aided, &mut summary);
            last = update.unwrap().nis;
        }
        (last, summary.side_slip)
    };
    let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 0.02;
    assert!(near(after(1, true).0, 9.0) && near(after(900, false).0, 9.0));
    // The mean of both components is 4.5 variances, 90 times that of wheels.
    let (nis, seen) = after(900, true);
    assert!(near(nis, 9.0 / 90.0), "{nis}");
    let seen = seen.unwrap();
    assert!(near(seen.speed, 0.2 * 4.5f64.sqrt()), "{seen:?}");
    assert_eq!(after(900, false).1, None);
    // Of a minute that begins, nothing is said.
    assert_eq!(after(250, true).1, None);
}

/// Flying north at `speed` [m/s] for `seconds` in steps of 20 ms, with fixes or without: how many updates by the air.
fn flown(air: Air, speed: f64, seconds: f64, aided: bool, parameters: Parameters) -> u64 {
    let nav = *moving(Vector3::new(speed, 0.0, 0.0), Vector3::zeros()).nav();
    let std = InitialStd {
        position: Vector3::repeat(0.5),
        velocity: Vector3::repeat(0.2),
        attitude: Vector3::repeat(1e-3),
    };
    let mut filter = build(nav, &std, &sensors(), parameters).unwrap();
    let (mut flight, mut summary) = (Flight::default(), Summary::default());
    for k in 1..=(seconds / 0.02).round() as u32 {
        let sample = ImuSample {
            time: 0.02 * f64::from(k),
            dt: 0.02,
            dtheta: Vector3::zeros(),
            dvel: Vector3::new(0.0, 0.0, -0.02 * 9.8),
        };
        flight.sample(&mut *filter, (&air, &sample), aided, &mut summary);
    }
    summary.innovations[Aid::Air].updates
}

/// Five updates a second in flight; none on the ground, of a copter that has not been seen to take off, or without the states that it takes.
#[test]
fn the_air_counts_in_flight() {
    let states = |air: Air| air.with_states(Parameters::none(), Some(6.0));
    let (wings, rotors) = (Air::WINGS, Air::ROTORS);
    assert_eq!(flown(wings, 15.0, 2.0, true, states(wings)), 10);
    assert_eq!(flown(wings, 15.0, 2.0, false, states(wings)), 10);
    assert_eq!(flown(wings, 5.0, 2.0, true, states(wings)), 0);
    assert_eq!(flown(wings, 15.0, 2.0, true, Parameters::none()), 0);
    assert_eq!(flown(rotors, 5.0, 2.0, true, states(rotors)), 10);
    assert_eq!(flown(rotors, 5.0, 2.0, false, states(rotors)), 0);
    assert_eq!(flown(rotors, 2.5, 2.0, true, states(rotors)), 0);
}
