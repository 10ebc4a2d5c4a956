//! What the filter gives out, against closed forms. The derivatives of `aiding` do not see a wrong value.

use nalgebra::SVector;
use undrift_nav::{
    Vector3,
    attitude::from_rpy,
    covariance::AXES,
    earth::Geodetic,
    filter::{Filter, InitialStd},
    mechanisation::{MAX_LATITUDE, MAX_SPEED, NavState},
    parameters::{Parameter, Parameters, Prior},
    sample::ImuSample,
    shaping::ShapingFilter,
};

const DT: f64 = 0.1;

fn nav(v_n: Vector3) -> NavState {
    NavState {
        time: 0.0,
        position: Geodetic::from_degrees(47.0, 8.0, 400.0),
        v_n,
        q_nb: from_rpy(&Vector3::zeros()),
    }
}

fn filter<const N: usize>(sensor: ShapingFilter, parameters: Parameters) -> Filter<N> {
    // So well known that what a fix says is said about the clock.
    let std = InitialStd {
        position: Vector3::repeat(1e-3),
        velocity: Vector3::repeat(1e-5),
        attitude: Vector3::repeat(1e-7),
    };
    Filter::new(
        nav(Vector3::new(12.0, 0.0, 0.0)),
        &std,
        [sensor; AXES],
        parameters,
    )
    .unwrap()
}

/// A wheel with the scale factor error s reads (1 + s) times the speed, and that agrees with the solution.
#[test]
fn a_wheel_reads_its_scale_error_too_much() {
    let parameters = Parameters::none().with(Parameter::OdometerScale, Prior::constant(0.05));
    let white = ShapingFilter::white(1e-6, DT).unwrap();
    let mut filter: Filter<10> = filter(white, parameters);
    let at = filter.parameter_start(Parameter::OdometerScale).unwrap();
    for s in [0.0, 0.02, -0.03] {
        let now = filter.estimates()[at];
        filter.apply_correction(&SVector::ith(at, s - now));
        let observed = filter.observe_odometer(12.0 * (1.0 + s), &Vector3::zeros());
        assert!(observed.innovation[0].abs() < 1e-12, "{s}");
        let faster = filter.observe_odometer(12.0 * (1.0 + s) + 0.5, &Vector3::zeros());
        assert!((faster.innovation[0] + 0.5).abs() < 1e-12, "{s}");
    }
}

/// A sensor error that is the sum of two independent processes: its variance is the sum of theirs.
#[test]
fn the_sensor_errors_std_is_that_of_the_sum_of_its_processes() {
    let slow = ShapingFilter::gauss_markov(3e-3, 300.0, DT).unwrap();
    let quick = ShapingFilter::gauss_markov(4e-3, 5.0, DT).unwrap();
    let filter: Filter<21> = filter(slow.plus(&quick).unwrap(), Parameters::none());
    for std in filter.sensor_error_std() {
        assert!((std / 5e-3 - 1.0).abs() < 1e-12, "{std}");
    }
}

/// An offset o of the clock that grows by r a second is o + r t after t seconds; as long as both are only their
/// priors, its variance is σ_o² + σ_r² t².
#[test]
fn a_clock_offset_grows_by_its_rate() {
    let (offset, rate) = (0.03, 2e-4);
    let parameters = Parameters::none()
        .with(Parameter::TimeOffset, Prior::constant(offset))
        .with(Parameter::ClockRate, Prior::constant(rate));
    let white = ShapingFilter::white(1e-6, DT).unwrap();
    let mut filter: Filter<11> = filter(white, parameters);
    let at = |kind| filter.parameter_start(kind).unwrap();
    let (o, r) = (at(Parameter::TimeOffset), at(Parameter::ClockRate));
    filter.apply_correction(&SVector::ith(o, 0.01));
    filter.apply_correction(&SVector::ith(r, -5e-5));
    for k in 1..=1000 {
        filter.predict(&ImuSample {
            time: f64::from(k) * DT,
            dt: DT,
            dtheta: Vector3::zeros(),
            dvel: Vector3::new(0.0, 0.0, -9.81 * DT),
        });
    }
    let time = 100.0;
    let (value, std) = filter.time_offset(Parameter::TimeOffset).unwrap();
    assert!((value - (0.01 - 5e-5 * time)).abs() < 1e-12, "{value}");
    assert!(
        (std / (offset * offset + rate * rate * time * time).sqrt() - 1.0).abs() < 1e-9,
        "{std}"
    );
    // Fixes see the offset as it is now, not its two parts: that alone becomes known.
    let noise = undrift_nav::Matrix3::identity() * 1e-6;
    let (position, level) = (filter.nav().position, Vector3::zeros());
    let fix = undrift_nav::sample::Position::Geodetic(position);
    let observed = filter.observe_position(&fix, &level);
    let gate = undrift_nav::filter::Gate::OPEN;
    filter.update(&observed, &noise, &gate).unwrap();
    let p = filter.covariance();
    let variance = p[(o, o)] + 2.0 * time * p[(o, r)] + time * time * p[(r, r)];
    let (_, seen) = filter.time_offset(Parameter::TimeOffset).unwrap();
    assert!((seen / variance.sqrt() - 1.0).abs() < 1e-9, "{seen}");
    assert!(p[(o, r)] < 0.0 && seen < 0.99 * std, "{seen} {std}");
}

/// "Below 10 km/s": the limit itself is refused.
#[test]
fn a_solution_at_the_limit_of_speed_is_refused() {
    let at = |speed: f64| nav(Vector3::new(0.0, speed, 0.0));
    assert!(at(MAX_SPEED * (1.0 - 1e-12)).is_valid());
    assert!(!at(MAX_SPEED).is_valid());
}

#[test]
fn a_solution_at_the_limit_of_latitude_is_refused() {
    let at = |lat: f64| {
        let mut nav = nav(Vector3::zeros());
        nav.position.lat = lat;
        nav.is_valid()
    };
    for side in [-1.0, 1.0] {
        assert!(at(side * MAX_LATITUDE * (1.0 - 1e-12)));
        assert!(!at(side * MAX_LATITUDE));
    }
}
