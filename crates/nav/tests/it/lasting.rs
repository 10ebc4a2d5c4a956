//! Lasting errors of the fixes, estimated from some time on.

use nalgebra::SVector;
use undrift_nav::{
    Matrix3, Vector3,
    attitude::from_rpy,
    covariance::AXES,
    earth::Geodetic,
    filter::{Filter, FilterError, InitialStd, Lasting},
    mechanisation::NavState,
    parameters::{Parameter, Parameters, Prior},
    sample::{ImuSample, Position},
    shaping::ShapingFilter,
};

const STD: Vector3 = Vector3::new(5.0, 6.0, 8.0);

fn lasting(grown: f64) -> Lasting {
    Lasting {
        prior: Prior {
            time: 60.0,
            ..Prior::constant(1.0)
        },
        grown: Vector3::repeat(grown),
        shared: STD,
    }
}

/// A filter that has moved for a second, with an axle to estimate.
fn filter() -> Filter<16> {
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(47.0, 8.0, 400.0),
        v_n: Vector3::new(3.0, 1.0, 0.0),
        q_nb: from_rpy(&Vector3::new(0.1, 0.0, 1.0)),
    };
    let std = InitialStd {
        position: Vector3::repeat(1.0),
        velocity: Vector3::repeat(0.1),
        attitude: Vector3::repeat(0.01),
    };
    let white = ShapingFilter::white(1e-4, 0.1).unwrap();
    let parameters = Parameters::none().with(Parameter::Axle, Prior::constant(0.3));
    let mut filter = Filter::new(nav, &std, [white; AXES], parameters).unwrap();
    for k in 1..=10 {
        filter.predict(&ImuSample {
            time: 0.1 * f64::from(k),
            dt: 0.1,
            dtheta: Vector3::new(0.0, 0.0, 0.01),
            dvel: Vector3::new(0.02, 0.0, -0.981),
        });
    }
    filter
}

fn with<const N: usize, const M: usize>(
    filter: &Filter<N>,
    both: [Option<Lasting>; 2],
) -> Result<Filter<M>, FilterError> {
    let p = filter.covariance();
    Filter::with_lasting(
        filter.carried(),
        filter.estimates(),
        &|i, j| p[(i, j)],
        &both,
    )
}

/// Innovation covariance of a second fix with the same error as those before.
fn again<const N: usize>(filter: &Filter<N>) -> Matrix3 {
    let here = Position::Geodetic(filter.nav().position);
    let observed = filter.observe_position(&here, &Vector3::zeros());
    let observed = filter.observe_fix_error(observed, Parameter::PositionError, &STD);
    observed.h * filter.covariance() * observed.h.transpose()
}

#[test]
fn what_the_fixes_were_wrong_by_the_solution_is_too() {
    let before = filter();
    let after: Filter<21> = with(&before, [Some(lasting(1.0)), None]).unwrap();
    let at = after.parameter_start(Parameter::PositionError).unwrap();
    assert_eq!((at, after.states()), (10, 13));
    let own = |p: f64, i: usize| p + STD[i] * STD[i];
    for i in 0..3 {
        let (was, is) = (before.covariance()[(i, i)], after.covariance()[(i, i)]);
        assert!((is - own(was, i)).abs() < 1e-12);
    }
    // A fix with the same error is as far from the solution as it was before.
    let was = before.covariance().fixed_view::<3, 3>(0, 0).into_owned();
    assert!((again(&after) - was).norm() < 1e-9);
    // All else is as it was.
    assert_eq!(before.nav(), after.nav());
    for (i, j) in (3..10).flat_map(|i| (3..10).map(move |j| (i, j))) {
        assert_eq!(before.covariance()[(i, j)], after.covariance()[(i, j)]);
    }
    assert_eq!(before.covariance()[(0, 4)], after.covariance()[(0, 4)]);
}

#[test]
fn an_error_that_is_estimated_already_keeps_its_value_in_metres() {
    let mut first: Filter<21> = with(&filter(), [Some(lasting(1.0)), Some(lasting(1.0))]).unwrap();
    let at = first.parameter_start(Parameter::PositionError).unwrap();
    first.apply_correction(&SVector::from_fn(|i, _| if i >= at { 0.8 } else { 0.0 }));
    let second: Filter<21> = with(&first, [Some(lasting(2.0)), Some(lasting(1.0))]).unwrap();
    for i in 0..3 {
        assert!((2.0 * second.estimates()[at + i] - first.estimates()[at + i]).abs() < 1e-15);
        assert_eq!(
            second.estimates()[at + 3 + i],
            first.estimates()[at + 3 + i]
        );
    }
    let (a, b) = (first.covariance(), second.covariance());
    assert!((4.0 * b[(at, at)] - a[(at, at)]).abs() < 1e-15);
    assert!((2.0 * b[(0, at)] - a[(0, at)]).abs() < 1e-12);
    assert_eq!((b[(0, 0)], b[(0, at + 3)]), (a[(0, 0)], a[(0, at + 3)]));
    // The velocity's alone: the position's is gone, and the other moves up.
    let third: Filter<16> = with(&second, [None, Some(lasting(1.0))]).unwrap();
    assert_eq!(third.parameter_start(Parameter::VelocityError), Some(at));
    assert_eq!(third.estimates()[at], second.estimates()[at + 3]);
    assert_eq!(third.covariance()[(at, at)], b[(at + 3, at + 3)]);
}

#[test]
fn a_filter_that_goes_on_in_another_size_moves_as_before() {
    let mut before = filter();
    let mut after: Filter<45> = with(&before, [None, None]).unwrap();
    let next = ImuSample {
        time: 1.1,
        dt: 0.1,
        dtheta: Vector3::new(0.002, 0.0, -0.01),
        dvel: Vector3::new(0.05, 0.01, -0.99),
    };
    before.predict(&next);
    after.predict(&next);
    assert_eq!(before.nav(), after.nav());
    for (i, j) in (0..10).flat_map(|i| (0..10).map(move |j| (i, j))) {
        assert_eq!(before.covariance()[(i, j)], after.covariance()[(i, j)]);
    }
    let refused = with::<16, 12>(&before, [Some(lasting(1.0)), None]).err();
    let (needed, capacity) = (13, 12);
    assert_eq!(
        refused,
        Some(FilterError::TooManyStates { needed, capacity })
    );
}

/// Of a start from a fix with correlations between axes, as RTKLIB states them: against a second fix of the same error only the white part
/// is left, and the whole covariance is positive definite.
#[test]
fn a_start_from_a_fix_whose_axes_are_correlated_is_positive_definite() {
    let prior = lasting(1.0).prior;
    let parameters = Parameters::none().with(Parameter::PositionError, prior);
    let white = ShapingFilter::white(1e-4, 0.1).unwrap();
    let std = InitialStd {
        position: Vector3::repeat(1.0),
        velocity: Vector3::repeat(0.1),
        attitude: Vector3::repeat(0.01),
    };
    let nav = *filter().nav();
    let mut started = Filter::<12>::new(nav, &std, [white; AXES], parameters).unwrap();
    let share = 0.99;
    let variances = STD.component_mul(&STD) / share;
    let mut stated = Matrix3::from_diagonal(&variances);
    for (i, j, correlation) in [(0, 1, 0.5), (0, 2, -0.3), (1, 2, 0.4)] {
        stated[(i, j)] = correlation * (variances[i] * variances[j]).sqrt();
        stated[(j, i)] = stated[(i, j)];
    }
    let of_velocity = Matrix3::identity();
    started.set_position_velocity_covariance(&stated, &of_velocity);
    started.correlate_with_fix_errors([&stated, &of_velocity], [&STD, &Vector3::zeros()]);
    assert!((again(&started) - stated * (1.0 - share)).norm() < 1e-9);
    assert!(started.covariance().cholesky().is_some());
    // As far off as it is stated to be.
    for i in 0..3 {
        assert_eq!(started.covariance()[(i, i)], stated[(i, i)]);
    }
}
