//! What a filter may be started from.

use undrift_nav::{
    Matrix3, Vector3,
    attitude::from_rpy,
    covariance::AXES,
    earth::Geodetic,
    filter::{Filter, FilterError, Gate, InitialStd},
    mechanisation::NavState,
    parameters::{Parameter, Parameters, Prior},
    sample::ImuSample,
    shaping::{MAX_ORDER, ShapingFilter},
};

#[test]
fn a_model_made_by_hand_of_more_states_than_an_axis_holds_is_refused() {
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: Vector3::zeros(),
        q_nb: from_rpy(&Vector3::zeros()),
    };
    let std = InitialStd {
        position: Vector3::repeat(1.0),
        velocity: Vector3::repeat(1.0),
        attitude: Vector3::repeat(0.1),
    };
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
    filter.advance(0.25, None);
    let mut kept = Vec::new();
    filter.numbers(&mut |number| kept.push(*number));
    // Another start, and no sample yet.
    let mut other = start(Vector3::zeros());
    let mut from = kept.iter();
    other.numbers(&mut |number| *number = *from.next().unwrap());
    assert!(from.next().is_none());
    for one in [&mut filter, &mut other] {
        let rest = one.observe_zero_velocity();
        one.update(&rest, &Matrix3::identity(), &Gate::OPEN, None)
            .unwrap();
        one.advance(1.0, None);
        one.predict(&sample(3.0));
    }
    assert_eq!(filter.nav(), other.nav());
    assert_eq!(filter.covariance(), other.covariance());
    assert_eq!(filter.estimates(), other.estimates());
}
