//! What a filter may be started from.

use super::doubts::at_rest;
use undrift_nav::{
    Matrix3, Vector3,
    attitude::from_rpy,
    covariance::AXES,
    earth::Geodetic,
    filter::{Filter, FilterError, Gate, InitialStd},
    mechanisation::NavState,
    parameters::{Parameter, Parameters, Prior},
    sample::{ImuSample, Position},
    shaping::{MAX_ORDER, ShapingFilter},
};

#[test]
fn a_model_made_by_hand_of_more_states_than_an_axis_holds_is_refused() {
    let (nav, std) = at_rest();
    let start = |order: usize| {
        let mut sensors = [ShapingFilter::none(0.01).unwrap(); AXES];
        sensors[4].order = order;
        // Room for a seventh state.
        Filter::<20>::new(nav, &std, sensors, Parameters::none()).map(|filter| filter.states())
    };
    assert_eq!(start(MAX_ORDER), Ok(9 + MAX_ORDER));
    // The largest would overflow the sum of the states.
    for order in [MAX_ORDER + 1, usize::MAX] {
        let refused = FilterError::TooManyStates {
            needed: order,
            capacity: MAX_ORDER,
        };
        assert_eq!(start(order), Err(refused));
    }
}

#[test]
fn a_filter_goes_on_from_its_numbers() {
    let start = |v_n: Vector3| {
        let nav = NavState {
            time: 0.0,
            position: Geodetic::from_degrees(45.0, 7.0, 300.0),
            v_n,
            q_nb: from_rpy(&Vector3::new(0.1, -0.2, 0.3)),
        };
        let std = InitialStd {
            position: Vector3::repeat(1.0),
            velocity: Vector3::repeat(1.0),
            attitude: Vector3::repeat(0.1),
        };
        let sensor = ShapingFilter::constant(1e-3, 0.01).unwrap();
        let parameters = Parameters::none().with(Parameter::AccelScale, Prior::constant(1e-3));
        Filter::<20>::new(nav, &std, [sensor; AXES], parameters).unwrap()
    };
    let sample = |k: f64| ImuSample {
        time: 0.01 * k,
        dt: 0.01,
        dtheta: Vector3::new(1e-3, -2e-3, 3e-3),
        dvel: Vector3::new(0.01, 0.02, -0.098),
    };
    let mut filter = start(Vector3::new(1.0, 2.0, 0.0));
    filter.predict(&sample(1.0));
    filter.begin(&sample(2.0));
    filter.advance(0.25);
    let mut kept = Vec::new();
    filter.numbers(&mut |number| kept.push(*number));
    // Another start, and no sample yet.
    let mut other = start(Vector3::zeros());
    let mut from = kept.iter();
    other.numbers(&mut |number| *number = *from.next().unwrap());
    assert!(from.next().is_none());
    for one in [&mut filter, &mut other] {
        let rest = one.observe_zero_velocity();
        one.update(&rest, &Matrix3::identity(), &Gate::OPEN)
            .unwrap();
        one.advance(1.0);
        one.predict(&sample(3.0));
    }
    assert_eq!(filter.nav(), other.nav());
    assert_eq!(filter.covariance(), other.covariance());
    assert_eq!(filter.estimates(), other.estimates());
}

/// A filter in motion with a lever arm, latencies and a clock rate to find, and white sensors.
fn with_latency(v_n: Vector3) -> Filter<15> {
    let nav = NavState {
        time: 50.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n,
        q_nb: from_rpy(&Vector3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2)),
    };
    let std = InitialStd {
        position: Vector3::repeat(1.0),
        velocity: Vector3::repeat(1.0),
        attitude: Vector3::repeat(0.1),
    };
    let white = ShapingFilter::white(1e-3, 0.01).unwrap();
    let parameters = Parameters::none()
        .with(Parameter::LeverArm, Prior::constant(0.5))
        .with(Parameter::TimeOffset, Prior::constant(0.1))
        .with(Parameter::VelocityTimeOffset, Prior::constant(0.2))
        .with(Parameter::ClockRate, Prior::constant(3e-3));
    Filter::new(nav, &std, [white; AXES], parameters).unwrap()
}

/// A fix that holds τ later than stamped is `v τ` ahead of its stamp, its velocity off by what a vehicle gains meanwhile
/// at 2 m/s²; and its position is the antenna's, not the IMU's.
#[test]
fn a_start_from_a_fix_is_as_uncertain_as_fix_lever_arm_and_latency() {
    let v = Vector3::new(20.0, -10.0, 0.0);
    let mut filter = with_latency(v);
    let stated = [
        Matrix3::new(4.0, 1.0, 0.0, 1.0, 9.0, 0.0, 0.0, 0.0, 16.0),
        Matrix3::identity() * 0.01,
    ];
    filter.set_position_velocity_covariance(&stated[0], &stated[1]);
    let p = filter.covariance();
    let block = |i: usize, j: usize| -> Matrix3 { p.fixed_view::<3, 3>(i, j).into_owned() };
    // Rounding of sums; a lever arm of 0.5 m to each side, 0.1 s of the speed.
    let near = |a: &Matrix3, b: &Matrix3| assert!((a - b).norm() < 1e-12, "{a} {b}");
    let late = v * v.transpose() * 0.1 * 0.1;
    near(
        &block(0, 0),
        &(stated[0] + Matrix3::identity() * 0.25 + late),
    );
    // The velocity has a latency of its own, 0.2 s.
    let gained = (2.0 * 0.2) * (2.0 * 0.2);
    near(&block(3, 3), &(stated[1] + Matrix3::identity() * gained));
    near(&block(0, 3), &Matrix3::zeros());
    let lever = filter.parameter_start(Parameter::LeverArm).unwrap();
    near(&block(0, lever), &(filter.c_nb() * 0.25));
    near(&block(lever, 0), &(filter.c_nb().transpose() * 0.25));
    let offset = filter.parameter_start(Parameter::TimeOffset).unwrap();
    for i in 0..3 {
        assert!((p[(i, offset)] - v[i] * 0.01).abs() < 1e-12);
        assert_eq!(p[(i, offset)], p[(offset, i)]);
    }
    // A second fix that is right and late by as much says nothing new of a start that was late, too.
    let fix = Position::Geodetic(
        filter
            .nav()
            .position
            .displaced(&(filter.c_nb() * Vector3::x())),
    );
    let h = filter.observe_position(&fix, &Vector3::x()).h;
    let s = h * p * h.transpose();
    assert!((s - stated[0]).norm() < 0.01 * 2.0, "{s}");
}

/// After a while an offset is the first one and what the clock has gained since: `δ + t ρ`, with the variance of that
/// sum. Fixes determine the sum much better than its parts.
#[test]
fn the_clocks_offset_is_as_uncertain_as_its_start_and_its_rate_together() {
    let mut filter = with_latency(Vector3::new(20.0, 0.0, 0.0));
    let dt = 0.1;
    let age = 60.0;
    for k in 1..=600 {
        filter.predict(&ImuSample {
            time: 50.0 + dt * f64::from(k),
            dt,
            dtheta: Vector3::zeros(),
            dvel: Vector3::new((0.1 * f64::from(k)).cos(), 0.0, -9.8) * dt,
        });
        if k % 10 == 0 {
            let antenna = filter.antenna_position(&Vector3::x());
            let fix = Position::Geodetic(antenna.displaced(&Vector3::new(0.5, 0.0, 0.0)));
            let position = filter.observe_position(&fix, &Vector3::x());
            let v_n = filter.antenna_velocity(&Vector3::x()) + Vector3::repeat(0.01);
            let velocity = filter.observe_velocity(&v_n, &Vector3::x());
            let (r, r_v) = (Matrix3::identity() * 0.01, Matrix3::identity() * 1e-4);
            filter.update(&position, &r, &Gate::OPEN).unwrap();
            filter.update(&velocity, &r_v, &Gate::OPEN).unwrap();
        }
    }
    assert!((filter.since_start() - age).abs() < 1e-9);
    let (x, p) = (filter.estimates(), filter.covariance());
    let rate = filter.parameter_start(Parameter::ClockRate).unwrap();
    for kind in [Parameter::TimeOffset, Parameter::VelocityTimeOffset] {
        let at = filter.parameter_start(kind).unwrap();
        let (value, std) = filter.time_offset(kind).unwrap();
        assert!((value - (x[at] + age * x[rate])).abs() < 1e-12);
        let own = p[(at, at)] + age * age * p[(rate, rate)];
        let both = 2.0 * age * p[(at, rate)];
        // Rounding of three variances that nearly cancel.
        assert!((std * std - (own + both)).abs() < 1e-12 * own, "{std}");
        // The parts vary against each other: the sign is what makes the sum known.
        assert!(both < -0.1 * own, "{own} {both}");
    }
    assert_eq!(filter.time_offset(Parameter::GyroScale), None);
}
