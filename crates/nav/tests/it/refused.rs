//! What a filter refuses leaves it as it was.

use undrift_nav::{
    Matrix3, Vector3,
    attitude::from_rpy,
    covariance::AXES,
    earth::Geodetic,
    filter::{Filter, FilterError, Gate, InitialStd},
    mechanisation::NavState,
    parameters::Parameters,
    sample::{ImuSample, Position},
    shaping::ShapingFilter,
};

const T: f64 = 0.01;

fn filter() -> Filter<15> {
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: Vector3::zeros(),
        q_nb: from_rpy(&Vector3::zeros()),
    };
    let std = InitialStd {
        position: Vector3::repeat(1.0),
        velocity: Vector3::repeat(0.1),
        attitude: Vector3::repeat(0.1),
    };
    let sensor = ShapingFilter::constant(1e-3, T).unwrap();
    Filter::new(nav, &std, [sensor; AXES], Parameters::none()).unwrap()
}

fn sample(time: f64, dt: f64, dvel: f64) -> ImuSample {
    ImuSample {
        time,
        dt,
        dtheta: Vector3::new(1e-4, 0.0, 0.0),
        dvel: Vector3::new(dvel, 0.0, -9.8 * dt),
    }
}

#[test]
fn a_measurement_that_throws_the_solution_off_the_earth() {
    let mut filter = filter();
    filter.predict(&sample(T, T, 0.0));
    let before = filter.clone();
    // Degrees where radians belong: 44 rad further north.
    let place = Position::Geodetic(Geodetic {
        lat: 45.0,
        lon: 7.0,
        height: 300.0,
    });
    let far = filter.observe_position(&place, &Vector3::zeros());
    let fast = filter.observe_velocity(&Vector3::new(1e9, 0.0, 0.0), &Vector3::zeros());
    for observed in [far, fast] {
        let refused = filter.update(&observed, &Matrix3::identity(), &Gate::OPEN, None);
        assert_eq!(refused, Err(FilterError::Implausible));
    }
    let mut none = filter.observe_zero_velocity();
    none.innovation.x = f64::NAN;
    let refused = filter.update(&none, &Matrix3::identity(), &Gate::OPEN, None);
    assert_eq!(refused, Err(FilterError::BadMeasurement));
    assert_eq!(filter.nav(), before.nav());
    assert_eq!(filter.covariance(), before.covariance());
    assert_eq!(filter.estimates(), before.estimates());
    // It goes on.
    let rest = filter.observe_zero_velocity();
    filter
        .update(&rest, &Matrix3::identity(), &Gate::OPEN, None)
        .unwrap();
}

#[test]
fn a_sample_after_which_there_is_no_solution() {
    let mut filter = filter();
    assert!(filter.bears(&sample(T, T, 0.01)));
    for (time, dt, dvel) in [
        (T, T, 1e5),
        (T, T, f64::NAN),
        (T, 0.0, 0.0),
        (T, -T, 0.0),
        (T, f64::NAN, 0.0),
        (f64::INFINITY, T, 0.0),
    ] {
        assert!(!filter.bears(&sample(time, dt, dvel)), "{time} {dt} {dvel}");
    }
    assert_eq!(filter.sample_end(), None);
    filter.begin(&sample(T, T, 0.0));
    filter.advance(0.5, None);
    assert_eq!(filter.sample_end(), Some(T));
    filter.advance(1.0, None);
    assert_eq!(filter.sample_end(), None);
}
