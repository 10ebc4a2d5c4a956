//! What a filter may be started from.

use undrift_nav::{
    Vector3,
    attitude::from_rpy,
    covariance::AXES,
    earth::Geodetic,
    filter::{Filter, FilterError, InitialStd},
    mechanisation::NavState,
    parameters::Parameters,
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
