//! What each doubt adds to the covariance, in closed form: nothing less and nothing beside it.

use nalgebra::SMatrix;
use undrift_nav::{
    Matrix3, Vector3,
    attitude::from_rpy,
    covariance::AXES,
    earth::Geodetic,
    filter::{Filter, Gate, InitialStd},
    mechanisation::NavState,
    parameters::{Parameter, Parameters, Prior},
    sample::{ImuSample, Position},
    shaping::ShapingFilter,
};

/// Nine, gyros of one, one and two states, accelerometers of one, a lever arm.
const N: usize = 19;
const DT: f64 = 0.1;
/// Rounding of sums of products of numbers up to 100.
const EXACT: f64 = 1e-12;

fn sample(k: usize) -> ImuSample {
    let time = (k + 1) as f64 * DT;
    ImuSample {
        time,
        dt: DT,
        dtheta: Vector3::new(0.1, -0.2, 0.3 * (0.4 * time).sin()) * DT,
        dvel: Vector3::new((0.3 * time).cos(), 0.5, -9.8) * DT,
    }
}

/// Level and at rest, and what is known of it: 1 m, 1 m/s, 0.1 rad.
pub(super) fn at_rest() -> (NavState, InitialStd) {
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
    (nav, std)
}

/// A filter that has been aided for five seconds: every block of its covariance is full.
fn aided() -> Filter<N> {
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: Vector3::new(8.0, -3.0, 0.5),
        q_nb: from_rpy(&Vector3::new(0.1, -0.2, 1.0)),
    };
    let std = InitialStd {
        position: Vector3::repeat(2.0),
        velocity: Vector3::repeat(0.5),
        attitude: Vector3::repeat(0.05),
    };
    let constant = |sigma: f64| ShapingFilter::constant(sigma, DT).unwrap();
    let slow = ShapingFilter::gauss_markov(5e-3, 20.0, DT).unwrap();
    let gyro = constant(1e-2);
    let sensors = [
        gyro,
        gyro,
        gyro.plus(&slow).unwrap(),
        constant(0.1),
        constant(0.1),
        constant(0.1),
    ];
    let lever = Parameters::none().with(Parameter::LeverArm, Prior::constant(0.5));
    let mut filter = Filter::new(nav, &std, sensors, lever).unwrap();
    for k in 0..50 {
        filter.predict(&sample(k));
        if k % 10 == 9 {
            let antenna = filter
                .nav()
                .position
                .displaced(&Vector3::new(0.3, -0.2, 0.1));
            let seen = filter.observe_position(&Position::Geodetic(antenna), &Vector3::x());
            filter
                .update(&seen, &Matrix3::identity(), &Gate::OPEN)
                .unwrap();
            let turn = filter.observe_earth_rate(&(sample(k).dtheta / DT));
            filter
                .update(&turn, &(Matrix3::identity() * 1e-6), &Gate::OPEN)
                .unwrap();
        }
    }
    filter
}

/// What `doubt` adds to the covariance.
fn added(filter: &mut Filter<N>, doubt: impl FnOnce(&mut Filter<N>)) -> SMatrix<f64, N, N> {
    let before = *filter.covariance();
    doubt(filter);
    filter.covariance() - before
}

#[track_caller]
fn assert_is(added: &SMatrix<f64, N, N>, expected: &SMatrix<f64, N, N>) {
    let off = (added - expected).amax();
    assert!(off < EXACT, "off by {off:e}: {added:.3e} {expected:.3e}");
}

#[test]
fn a_heading_in_doubt_takes_its_gyro_with_it() {
    // Level, upside down, nose up, and on its side.
    for (roll, pitch, upright) in [(0.1, -0.2, 2), (3.0, 0.1, 2), (0.0, 1.3, 0), (-1.4, 0.1, 1)] {
        let mut filter = aided();
        filter.set_nav(NavState {
            q_nb: from_rpy(&Vector3::new(roll, pitch, 1.0)),
            ..*filter.nav()
        });
        let gyros = |filter: &Filter<N>| filter.sensor_error_std().map(|std| std * std);
        let before = gyros(&filter);
        let (heading, gyro) = (0.2, 0.03);
        let added = added(&mut filter, |filter| filter.inflate_heading(heading, gyro));
        let mut expected = SMatrix::zeros();
        expected[(8, 8)] = heading * heading;
        // Of two states the one that lasts takes it, here the first: the other would forget what it has learned.
        let at = filter.sensors().start(upright);
        expected[(at, at)] = gyro * gyro;
        assert_is(&added, &expected);
        let after = gyros(&filter);
        for axis in 0..AXES {
            let more = if axis == upright { gyro * gyro } else { 0.0 };
            assert!((after[axis] - before[axis] - more).abs() < EXACT, "{axis}");
        }
    }
}

#[test]
fn unseen_motion_is_a_constant_acceleration_and_turn_rate() {
    let mut filter = aided();
    let (time, rate, accel) = (3.0, 0.2, 2.0);
    let added = added(&mut filter, |filter| {
        filter.inflate_over_gap(time, rate, accel)
    });
    // δr = ½ a t² and δv = a t of the same a: fully correlated.
    let (r, v) = (0.5 * accel * time * time, accel * time);
    let mut expected = SMatrix::zeros();
    for i in 0..3 {
        expected[(i, i)] = r * r;
        expected[(3 + i, 3 + i)] = v * v;
        expected[(i, 3 + i)] = r * v;
        expected[(3 + i, i)] = r * v;
        expected[(6 + i, 6 + i)] = (rate * time) * (rate * time);
    }
    assert_is(&added, &expected);
    // The next sample has no predecessor to be combined with.
    let mut alone = filter.clone();
    alone.set_nav(*filter.nav());
    alone.predict(&sample(80));
    filter.predict(&sample(80));
    assert_eq!(filter.nav(), alone.nav());
}

#[test]
fn a_contradicted_solution_doubts_position_velocity_and_level_but_not_its_heading() {
    let mut filter = aided();
    let added = added(&mut filter, |filter| {
        filter.inflate(&Vector3::new(20.0, 21.0, 22.0), 3.0, 0.05)
    });
    let mut expected = SMatrix::zeros();
    for i in 0..3 {
        expected[(i, i)] = [400.0, 441.0, 484.0][i];
        expected[(3 + i, 3 + i)] = 9.0;
    }
    for i in 6..8 {
        expected[(i, i)] = 0.0025;
    }
    assert_is(&added, &expected);
}

#[test]
fn a_doubted_sample_is_turned_from_the_body_to_north_east_down() {
    let mut filter = aided();
    // Facing east, level: forward is east, right is south.
    filter.set_nav(NavState {
        q_nb: from_rpy(&Vector3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2)),
        ..*filter.nav()
    });
    let turn = Matrix3::from_diagonal(&Vector3::new(0.04, 0.01, 0.09));
    let velocity = Matrix3::from_diagonal(&Vector3::new(4.0, 1.0, 9.0));
    let added = added(&mut filter, |filter| {
        filter.inflate_missed_motion(&turn, &velocity)
    });
    let mut expected = SMatrix::zeros();
    for (i, (velocity, turn)) in [(1.0, 0.01), (4.0, 0.04), (9.0, 0.09)]
        .into_iter()
        .enumerate()
    {
        expected[(3 + i, 3 + i)] = velocity;
        expected[(6 + i, 6 + i)] = turn;
    }
    assert_is(&added, &expected);
}

/// A heading in doubt says nothing of a gyro whose states its error does not contain.
#[test]
fn a_gyro_whose_error_has_no_state_stays_as_it_was() {
    let known = ShapingFilter::constant(1e-2, DT).unwrap();
    let unseen = ShapingFilter {
        h: Default::default(),
        ..known
    };
    let (nav, std) = at_rest();
    let sensors = [known, known, unseen, known, known, known];
    let mut filter = Filter::<15>::new(nav, &std, sensors, Parameters::none()).unwrap();
    let before = *filter.covariance();
    filter.inflate_heading(0.2, 0.03);
    let mut expected = SMatrix::<f64, 15, 15>::zeros();
    expected[(8, 8)] = 0.2 * 0.2;
    let off = (filter.covariance() - before - expected).amax();
    assert!(off < EXACT, "{off:e}");
}

#[test]
fn a_delay_that_has_changed_is_that_of_both_parts_of_a_fix() {
    let (nav, std) = at_rest();
    let white = ShapingFilter::white(1e-3, DT).unwrap();
    let offset = Prior::constant(0.1);
    let kinds = [Parameter::TimeOffset, Parameter::VelocityTimeOffset];
    // Both, one, none.
    for estimated in [&kinds[..], &kinds[..1], &[]] {
        let of = |parameters: Parameters, kind: &Parameter| parameters.with(*kind, offset);
        let parameters = estimated.iter().fold(Parameters::none(), of);
        let mut filter = Filter::<11>::new(nav, &std, [white; 6], parameters).unwrap();
        let before = *filter.covariance();
        filter.inflate_time_offsets(0.03);
        let mut expected = SMatrix::<f64, 11, 11>::zeros();
        let n = 9 + estimated.len();
        expected.view_mut((9, 9), (n - 9, n - 9)).fill(9e-4);
        let off = (filter.covariance() - before - expected).amax();
        assert!(off < EXACT, "{off:e}");
    }
}
