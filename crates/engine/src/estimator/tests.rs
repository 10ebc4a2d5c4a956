//! Every size is nav's filter and nothing else: the same numbers by the same calls, to the last bit.

use super::*;
use alloc::{boxed::Box, vec::Vec};
use nalgebra::SVector;
use std::sync::mpsc;
use undrift_nav::{
    aiding::Observation,
    filter::{Filter, Outcome},
    tape::Tape,
};
use undrift_nav::{attitude::from_rpy, parameters::Prior, sample::Position};

const T: f64 = 0.01;
const LEVER: Vector3 = Vector3::new(0.5, -0.2, -1.0);

fn start() -> NavState {
    NavState {
        time: 0.0,
        position: Geodetic::from_degrees(47.0, 8.0, 400.0),
        v_n: Vector3::new(10.0, -5.0, 1.0),
        q_nb: from_rpy(&Vector3::new(0.1, -0.2, 1.0)),
    }
}

fn std() -> InitialStd {
    InitialStd {
        position: Vector3::new(1.0, 2.0, 3.0),
        velocity: Vector3::new(0.1, 0.2, 0.3),
        attitude: Vector3::new(0.01, 0.02, 0.05),
    }
}

/// Models of so many states together with the nine of navigation; beyond what six axes hold with all parameters but those of poses, magnetometers, air and a receiver's filter.
fn models(states: usize) -> ([ShapingFilter; AXES], Parameters) {
    let axes = AXES * undrift_nav::shaping::MAX_ORDER;
    let mut parameters = Parameters::none();
    if states - NAV > axes {
        let without = [
            Parameter::MarkerRotation,
            Parameter::FrameTilt,
            Parameter::HardIron,
            Parameter::Wind,
            Parameter::TrimVelocity,
            Parameter::RotorDrag,
            Parameter::Smoothing,
        ];
        for kind in Parameter::ALL
            .into_iter()
            .filter(|kind| !without.contains(kind))
        {
            parameters = parameters.with(kind, Prior::constant(0.1));
        }
    }
    let mut left = states - NAV - parameters.states();
    let phi = [0.9, -0.2, 0.1, 0.05, 0.02, 0.01];
    let axis = |_| {
        let order = left.min(phi.len());
        left -= order;
        match order {
            0 => ShapingFilter::white(1e-3, T),
            order => ShapingFilter::arma(&phi[..order], &[], 2e-2, T),
        }
        .unwrap()
    };
    (core::array::from_fn(axis), parameters)
}

fn built(states: usize) -> Result<Box<dyn Estimator>, FilterError> {
    let (sensors, parameters) = models(states);
    build(start(), &std(), &sensors, parameters)
}

/// An estimator, and nav's filter of the size that it is to have.
fn twins<const N: usize>(states: usize) -> (Box<dyn Estimator>, Filter<N>) {
    let (sensors, parameters) = models(states);
    let filter = Filter::new(start(), &std(), sensors, parameters).unwrap();
    (built(states).unwrap(), filter)
}

fn sample(k: usize) -> ImuSample {
    let x = k as f64;
    ImuSample {
        time: T * (x + 1.0),
        dt: T,
        dtheta: Vector3::new(0.1, -0.2, 0.3 * (0.4 * x).sin()) * T,
        dvel: Vector3::new((0.3 * x).cos(), 0.5, -9.8) * T,
    }
}

fn assert_same<const N: usize>(own: &dyn Estimator, filter: &Filter<N>) {
    assert_eq!(own.nav(), filter.nav());
    assert_eq!(own.covariance(), *filter.covariance());
    assert_eq!(own.estimates(), filter.estimates());
    assert_eq!(own.states(), filter.states());
    assert_eq!(own.nav_std(), filter.nav_std());
    assert_eq!(own.sensor_error(), filter.sensor_error());
    assert_eq!(own.sensor_error_std(), filter.sensor_error_std());
    assert_eq!(own.omega_nb_b(), filter.omega_nb_b());
    assert_eq!(own.since_start(), filter.since_start());
    assert_eq!(own.sample_end(), filter.sample_end());
    for kind in Parameter::ALL {
        assert_eq!(own.parameter(kind), filter.parameter(kind));
        assert_eq!(own.time_offset(kind), filter.time_offset(kind));
    }
    assert_eq!(
        own.antenna_position(&LEVER),
        filter.antenna_position(&LEVER)
    );
    assert_eq!(
        own.antenna_velocity(&LEVER),
        filter.antenna_velocity(&LEVER)
    );
    assert_eq!(
        own.vehicle_velocity(&LEVER),
        filter.vehicle_velocity(&LEVER)
    );
    assert_eq!(own.check(), filter.check());
}

#[test]
fn the_smallest_size_that_holds_the_states_is_taken() {
    for (states, size) in [
        (9, 16),
        (16, 16),
        (17, 21),
        (21, 21),
        (22, 24),
        (24, 24),
        (25, 28),
        (28, 28),
        (29, 33),
        (33, 33),
        (34, 45),
        (45, 45),
        (46, 73),
        (73, 73),
    ] {
        let own = built(states).unwrap();
        assert_eq!((own.states(), own.covariance().nrows()), (states, size));
    }
    let refused = FilterError::TooManyStates {
        needed: 74,
        capacity: 73,
    };
    assert_eq!(built(74).err(), Some(refused));
}

/// Samples with a fix inside, then all that changes a covariance by hand.
fn same_run<const N: usize>(states: usize) {
    let (mut own, mut filter) = twins::<N>(states);
    assert_same(&*own, &filter);
    let r = Matrix3::identity() * 4.0;
    let gate = Gate {
        weaken: 3.0,
        reject: 1000.0,
    };
    for k in 0..20 {
        let sample = sample(k);
        assert_eq!(own.reached(), filter.reached());
        assert_eq!(own.accepts_step(&sample), filter.accepts_step(&sample));
        own.begin(&sample);
        filter.begin(&sample);
        let due = sample.time - 0.3 * T;
        own.advance(Some(due));
        filter.advance_to(due, STAMP_ROUNDING);
        let off = Vector3::new((k as f64).sin(), -0.5, 3.0);
        let position = Position::Geodetic(filter.nav().position.displaced(&off));
        let aiding = Aiding::Position {
            position,
            lever_arm: LEVER,
            correlated: Vector3::zeros(),
            due,
        };
        let observed = filter.observe_position(&position, &LEVER);
        assert_eq!(
            own.update(&aiding, &r, &gate).unwrap().unwrap(),
            filter.update(&observed, &r, &gate).unwrap()
        );
        own.advance(None);
        filter.advance(1.0);
    }
    assert_same(&*own, &filter);

    let white = core::array::from_fn(|axis| 2.0 * filter.sensors().axis(axis).r);
    own.set_white_noise(&white);
    filter.set_white_noise(&white);
    own.begin(&sample(20));
    own.advance(None);
    filter.predict(&sample(20));
    let (turn, velocity) = (Matrix3::identity() * 1e-4, Matrix3::identity() * 1e-2);
    own.inflate_over_gap(2.0, 0.1, 1.0);
    filter.inflate_over_gap(2.0, 0.1, 1.0);
    assert_same(&*own, &filter);
    own.inflate(&Vector3::new(1.0, 2.0, 3.0), 2.0, 0.1);
    filter.inflate(&Vector3::new(1.0, 2.0, 3.0), 2.0, 0.1);
    assert_same(&*own, &filter);
    own.inflate_heading(0.2, 0.01);
    filter.inflate_heading(0.2, 0.01);
    own.inflate_sensor_errors(&[1e-4; AXES]);
    filter.inflate_sensor_errors(&[1e-4; AXES]);
    assert_same(&*own, &filter);
    own.inflate_missed_motion(&turn, &velocity);
    filter.inflate_missed_motion(&turn, &velocity);
    assert_same(&*own, &filter);
    // States that it does not reach are right.
    own.apply_correction(&[0.5, 0.1]);
    let mut error = SVector::zeros();
    (error[0], error[1]) = (0.5, 0.1);
    filter.apply_correction(&error);
    assert_same(&*own, &filter);
    own.set_sensor_error(&[0.01; AXES]);
    filter.set_sensor_error(&[0.01; AXES]);
    assert_same(&*own, &filter);
    own.set_position_velocity_covariance(&r, &velocity, &[LEVER, -LEVER]);
    filter.set_position_velocity_covariance(&r, &velocity);
    filter.correlate_with_fix_errors([&r, &velocity], [&LEVER, &-LEVER]);
    assert_same(&*own, &filter);
    own.set_nav(start());
    filter.set_nav(start());
    assert_same(&*own, &filter);
    let (mut ours, mut navs) = (Vec::new(), Vec::new());
    own.set_mounting_std(&LEVER);
    own.numbers(&mut |number| ours.push(*number));
    filter.numbers(&mut |number| navs.push(*number));
    navs.extend(own.mounting_std().iter());
    assert_eq!(ours, navs);
}

#[test]
fn every_size_runs_as_the_filter_does() {
    same_run::<16>(9);
    same_run::<16>(15);
    same_run::<21>(18);
    same_run::<28>(27);
    same_run::<33>(30);
    same_run::<45>(45);
    same_run::<73>(60);
}

/// Both updated with the same measurement.
fn same_update<const M: usize>(
    aiding: Aiding,
    observe: impl Fn(&Filter<73>) -> Observation<M, 73>,
) {
    let (mut own, mut filter) = twins::<73>(60);
    own.begin(&sample(3));
    filter.begin(&sample(3));
    own.advance(None);
    filter.advance(1.0);
    let observed = observe(&filter);
    let innovation = own.innovation(&aiding).unwrap();
    for i in 0..3 {
        let expected = observed.innovation.get(i).copied().unwrap_or(0.0);
        assert_eq!(innovation[i], expected, "{aiding:?}");
    }
    let noise = Matrix3::new(0.4, 0.1, 0.0, 0.1, 0.5, 0.0, 0.0, 0.0, 0.6);
    let r = noise.fixed_view::<M, M>(0, 0).into_owned();
    let ours = own.update(&aiding, &noise, &Gate::OPEN).unwrap().unwrap();
    let navs = filter.update(&observed, &r, &Gate::OPEN).unwrap();
    assert_eq!((ours, ours.dof), (navs, M));
    assert_same(&*own, &filter);
}

#[test]
fn every_measurement_is_the_filters() {
    let (v_n, correlated) = (Vector3::new(9.0, -4.0, 0.0), Vector3::new(0.3, 0.2, 0.1));
    let (rate, force) = (Vector3::new(1e-3, 2e-3, 3e-3), Vector3::new(0.2, 0.1, -9.8));
    let position = Position::Geodetic(start().position);
    let due = sample(3).time;
    let of_position = Aiding::Position {
        position,
        lever_arm: LEVER,
        correlated,
        due,
    };
    same_update(of_position, |f| {
        let observed = f.observe_position(&position, &LEVER);
        f.observe_fix_error(observed, Parameter::PositionError, &correlated)
    });
    let of_velocity = Aiding::Velocity {
        v_n,
        lever_arm: LEVER,
        correlated,
        due,
    };
    same_update(of_velocity, |f| {
        let observed = f.observe_velocity(&v_n, &LEVER);
        f.observe_fix_error(observed, Parameter::VelocityError, &correlated)
    });
    same_update(Aiding::Course(0.9), |f| f.observe_course(0.9).unwrap());
    same_update(Aiding::ZeroVelocity, |f| f.observe_zero_velocity());
    same_update(Aiding::EarthRate(rate), |f| f.observe_earth_rate(&rate));
    same_update(Aiding::Level(force), |f| f.observe_level(&force));
    same_update(Aiding::NonHolonomic(LEVER), |f| {
        f.observe_non_holonomic(&LEVER)
    });
    let wheel = Aiding::Odometer {
        speed: 9.0,
        lever_arm: LEVER,
    };
    same_update(wheel, |f| f.observe_odometer(9.0, &LEVER));
    same_update(Aiding::Barometer(398.0), |f| f.observe_barometer(398.0));
}

#[test]
fn a_course_says_nothing_of_a_vehicle_that_points_up() {
    let mut own = built(15).unwrap();
    let up = from_rpy(&Vector3::new(0.0, 1.5, 0.0));
    own.set_nav(NavState {
        q_nb: up,
        ..start()
    });
    let before = own.covariance().into_owned();
    let course = Aiding::Course(0.1);
    assert_eq!(own.innovation(&course), None);
    let update = own.update(&course, &Matrix3::identity(), &Gate::OPEN);
    assert_eq!(update, Ok(None));
    assert_eq!(own.covariance(), before);
}

/// A fix that holds a while ago is compared with where the antenna was: the vehicle accelerates evenly, so it was
/// `v t − ½ a t²` behind, and `a t` slower.
#[test]
fn a_late_fix_is_compared_with_the_solution_of_its_own_time() {
    let accel = Vector3::new(8.0, 3.0, -1.0);
    let gravity = Vector3::z() * undrift_nav::earth::gravity(start().position.lat, 400.0);
    let force = start().q_nb.inverse() * (accel - gravity);
    let mut own = built(9).unwrap();
    let go = |own: &mut Box<dyn Estimator>, time: f64, dt: f64| {
        own.begin(&ImuSample {
            time,
            dt,
            dtheta: Vector3::zeros(),
            dvel: force * dt,
        });
        own.advance(None);
    };
    for k in 1..=100 {
        go(&mut own, f64::from(k) * T, T);
    }
    let due = own.nav().time;
    let position = Position::Geodetic(own.antenna_position(&LEVER));
    let v_n = own.antenna_velocity(&LEVER);
    for late in [0.0, 0.02, 0.1] {
        let mut own = own.boxed();
        if late > 0.0 {
            go(&mut own, due + late, late);
        }
        let correlated = Vector3::zeros();
        let position = Aiding::Position {
            position,
            lever_arm: LEVER,
            correlated,
            due,
        };
        let velocity = Aiding::Velocity {
            v_n,
            lever_arm: LEVER,
            correlated,
            due,
        };
        let [position, velocity] =
            [position, velocity].map(|aiding| own.innovation(&aiding).unwrap().norm());
        // Coriolis' acceleration and the Earth's turn under the attitude, 3e-3 m/s², do not count; ½ a t² is 43 mm at
        // 0.1 s and a t 0.86 m/s.
        assert!(position < 1e-8 + 3e-3 * late * late, "{late} {position}");
        assert!(velocity < 1e-8 + 3e-3 * late, "{late} {velocity}");
    }
}

#[test]
fn what_was_recorded_is_the_filters_tape() {
    let (mut own, mut filter) = twins::<28>(28);
    assert!(own.adjoint().is_none());
    own.record();
    let mut tape = Tape::<28>::default();
    own.begin(&sample(0));
    filter.begin(&sample(0));
    own.advance(None);
    filter.advance_recorded(1.0, &mut tape);
    let noise = Matrix3::identity();
    own.update(&Aiding::ZeroVelocity, &noise, &Gate::OPEN)
        .unwrap();
    let observed = filter.observe_zero_velocity();
    filter
        .update_recorded(&observed, &noise, &Gate::OPEN, &mut tape)
        .unwrap();
    let adjoint = own.adjoint().unwrap();
    assert_eq!(adjoint.transition, tape.transition());
    assert_eq!(adjoint.gradient, tape.gradient);
    assert_eq!(adjoint.information, tape.information);
    assert!(own.boxed().adjoint().is_none(), "a copy records nothing");
    own.record();
    assert_eq!(
        own.adjoint().unwrap().information.norm(),
        0.0,
        "from nothing again"
    );
}

/// With what is written down an update can be done again: `P Hᵀ S⁻¹ ν` of the covariance before it is what was taken out
/// of the solution, and the transition carries an error from the update before.
#[test]
fn the_log_of_a_run_has_every_update_that_was_made() {
    let mut own = built(16).unwrap();
    let (sender, log) = mpsc::channel();
    own.log_to(LogTo::new(move |logged| drop(sender.send(logged))));
    let (r, lever_arm) = (Matrix3::identity() * 0.01, LEVER);
    let mut expected = Vec::new();
    for k in 0..4 {
        own.begin(&sample(k));
        own.advance(None);
        let due = own.nav().time;
        let correlated = Vector3::zeros();
        let v_n = own.antenna_velocity(&LEVER) - Vector3::repeat(0.05);
        let aiding = match k {
            0 | 3 => Aiding::Velocity {
                v_n,
                lever_arm,
                correlated,
                due,
            },
            1 => Aiding::NonHolonomic(LEVER),
            _ => Aiding::Barometer(399.0),
        };
        // The last one is too far off.
        let gate = Gate {
            weaken: 1e-3,
            reject: if k == 3 { 1e-2 } else { f64::INFINITY },
        };
        let before = own.covariance().into_owned();
        let innovation = own.innovation(&aiding).unwrap();
        let update = own.update(&aiding, &r, &gate).unwrap().unwrap();
        match update.outcome {
            Outcome::Weakened(factor) => {
                expected.push((due, aiding.channel(), before, innovation, factor));
            }
            Outcome::Rejected => assert_eq!(k, 3),
            Outcome::Used => panic!("beyond the limit"),
        }
    }
    drop(own);
    let mut log = log.into_iter();
    let Some(Logged::Start(time, first)) = log.next() else {
        panic!("no start");
    };
    assert_eq!((time, first.nrows()), (0.0, 16));
    for (time, channel, before, innovation, factor) in expected {
        let Some(Logged::Update(update)) = log.next() else {
            panic!("an update is missing");
        };
        assert_eq!((update.time, update.channel), (time, channel));
        assert_eq!(update.weakened, factor);
        let components = update.h.nrows();
        assert_eq!(update.innovation, innovation.rows(0, components));
        let p = before.view((0, 0), (16, 16));
        let s = &update.h * p * update.h.transpose() + &update.noise * factor;
        let weighed = s.try_inverse().unwrap() * &update.innovation;
        let correction = p * update.h.transpose() * weighed;
        // Rounding of an inverse.
        let miss = (&correction - &update.correction).norm();
        assert!(miss < 1e-9 * correction.norm(), "{miss}");
        // Over one sample a position moves with its velocity.
        let moves = update.transition[(0, 3)];
        assert!((moves / T - 1.0).abs() < 0.05, "{moves}");
        assert_eq!(update.white[0], models(16).0[0].r);
    }
    assert!(log.next().is_none(), "a rejected one is not among them");
}

/// A window speaks of truth less estimate, attitude about body axes; the filter's errors of velocity and misalignment are
/// estimate less truth, about north, east and down.
#[test]
fn a_window_of_motion_relates_velocity_attitude_and_bias() {
    let (own_v, own_turn, own_bias, noise) = (0.04, 1e-4, 0.25, 0.01);
    let updated = |window: usize| {
        let sensor = ShapingFilter::constant(f64::sqrt(own_bias), T).unwrap();
        let std = InitialStd {
            position: Vector3::repeat(1.0),
            velocity: Vector3::repeat(f64::sqrt(own_v)),
            attitude: Vector3::repeat(f64::sqrt(own_turn)),
        };
        let nav = NavState {
            q_nb: from_rpy(&Vector3::new(0.0, 0.0, core::f64::consts::FRAC_PI_2)),
            ..start()
        };
        let mut own = build(nav, &std, &[sensor; AXES], Parameters::none()).unwrap();
        // One component plus the bias of accelerometer y is zero but for noise.
        let mut rows = SMatrix::<f64, 13, 13>::zeros();
        rows[(0, window)] = 1.0 / f64::sqrt(noise);
        rows[(0, 10)] = 1.0 / f64::sqrt(noise);
        own.update_window(&rows, None).unwrap();
        assert_eq!(own.nav(), &nav);
        own.covariance().into_owned()
    };
    // Rounding; sums of variances below.
    let near = |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-9);
    let p = updated(0);
    let s = own_v + own_bias + noise;
    near(p[(3, 13)], own_v * own_bias / s);
    near(p[(3, 3)], own_v - own_v * own_v / s);
    // A body that points east has its forward axis in the east.
    let p = updated(3);
    let s = own_turn + own_bias + noise;
    near(p[(7, 13)], -own_turn * own_bias / s);
    near(p[(7, 7)], own_turn - own_turn * own_turn / s);
    near(p[(6, 6)], own_turn);
}

/// Of a mounting that is known to some degrees, about the vehicle's axes: here forward is east.
#[test]
fn the_vehicle_is_as_uncertain_as_its_mounting() {
    let sensors = [ShapingFilter::white(1e-3, T).unwrap(); AXES];
    let east = NavState {
        q_nb: from_rpy(&Vector3::new(0.0, 0.0, core::f64::consts::FRAC_PI_2)),
        ..start()
    };
    let [roll, pitch, yaw] = [0.3, 0.2, 0.1];
    let near = |is: [f64; 3], expected: [f64; 3]| {
        let off = is.iter().zip(expected).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-12, "{is:?} {expected:?}");
    };
    let mut given = build(east, &std(), &sensors, Parameters::none()).unwrap();
    given.set_mounting_std(&Vector3::new(roll, pitch, yaw));
    let north_east_down = [(0.01, pitch), (0.02, roll), (0.05, yaw)].map(|(a, b)| f64::hypot(a, b));
    near(given.vehicle_attitude().1, north_east_down);
    near(given.boxed().vehicle_attitude().1, north_east_down);
    // Pitch and yaw are states: the rest is the roll.
    let parameters = Parameters::none().with(Parameter::Mounting, Prior::constant(0.03));
    let mut estimated = build(east, &std(), &sensors, parameters).unwrap();
    estimated.set_mounting_std(&Vector3::new(roll, pitch, yaw));
    let expected = [(0.01, 0.03), (0.02, roll), (0.05, 0.03)].map(|(a, b)| f64::hypot(a, b));
    near(estimated.vehicle_attitude().1, expected);
    let kept = estimated.with_lasting(&[None; 2]).unwrap();
    near(kept.vehicle_attitude().1, expected);
}

#[test]
fn the_vehicle_has_the_errors_of_body_and_mounting() {
    let parameters = Parameters::none().with(Parameter::Mounting, Prior::constant(0.03));
    let sensors = [ShapingFilter::white(1e-3, T).unwrap(); AXES];
    let level = NavState {
        q_nb: Quaternion::identity(),
        ..start()
    };
    let plain = build(level, &std(), &sensors, Parameters::none()).unwrap();
    assert_eq!(plain.vehicle_attitude(), (level.q_nb, [0.01, 0.02, 0.05]));
    let mut mounted = build(level, &std(), &sensors, parameters).unwrap();
    let (_, [roll, pitch, yaw]) = mounted.vehicle_attitude();
    // The mounting turns about the vehicle's pitch and yaw axes, east and down here.
    let near = |value: f64, expected: f64| assert!((value - expected).abs() < 1e-15);
    near(roll, 0.01);
    near(pitch, f64::hypot(0.02, 0.03));
    near(yaw, f64::hypot(0.05, 0.03));
    let mut error = [0.0; 11];
    error[10] = 0.2;
    mounted.apply_correction(&error);
    let (q_nv, _) = mounted.vehicle_attitude();
    assert!(q_nv.angle_to(&from_rpy(&Vector3::new(0.0, 0.0, 0.2))) < 1e-15);
}
