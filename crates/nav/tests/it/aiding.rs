//! Every observation matrix against central differences of its innovation, all parameters estimated.

use nalgebra::{SMatrix, SVector};
use proptest::prelude::*;
use undrift_nav::{
    Vector3,
    aiding::Observation,
    attitude::from_rpy,
    covariance::AXES,
    earth::Geodetic,
    filter::{Filter, InitialStd},
    mechanisation::NavState,
    parameters::{Parameter, Parameters, Prior},
    sample::{ImuSample, Position},
    shaping::ShapingFilter,
};

/// Nine, one state an axis, and all parameters.
const N: usize = 9 + 6 + 35;

fn vector(scale: f64) -> impl Strategy<Value = Vector3> {
    prop::array::uniform3(-scale..scale).prop_map(Vector3::from)
}

prop_compose! {
    /// A filter in the middle of a sample, its sensor states and parameters away from zero.
    fn filter()(
        lat in -70.0..70.0, v_n in vector(40.0), rpy in vector(1.2), rate in vector(0.5),
        force in vector(15.0), small in prop::collection::vec(-1.0..1.0f64, N),
    ) -> Filter<N> {
        let nav = NavState {
            time: 0.0,
            position: Geodetic::from_degrees(lat, 11.0, 300.0),
            v_n,
            q_nb: from_rpy(&rpy),
        };
        let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(1.0), attitude: Vector3::repeat(0.1) };
        let sensor = ShapingFilter::arma(&[0.9], &[0.5], 1e-2, 0.01).unwrap();
        let prior = Prior::constant(0.1);
        let all = Parameter::ALL.into_iter().fold(Parameters::none(), |p, kind| p.with(kind, prior));
        let mut filter = Filter::new(nav, &std, [sensor; AXES], all).unwrap();
        let dt = 0.01;
        filter.begin(&ImuSample { time: dt, dt, dtheta: rate * dt, dvel: force * dt });
        filter.advance(0.3, None);
        // Mounting within what its first-order turn is good for.
        let shift = SVector::<f64, N>::from_fn(|i, _| if i < 9 { 0.0 } else { 1e-3 * small[i] });
        filter.take_out(&shift);
        filter
    }
}

/// Column by column: what an error of a state does to the innovation. The time offsets have a test of their own.
fn check<const M: usize>(
    filter: &Filter<N>,
    allowed: f64,
    observe: impl Fn(&Filter<N>) -> Observation<M, N>,
) -> Result<(), TestCaseError> {
    let h: SMatrix<f64, M, N> = observe(filter).h;
    let offsets = [
        Parameter::TimeOffset,
        Parameter::VelocityTimeOffset,
        Parameter::ClockRate,
    ]
    .map(|kind| filter.parameter_start(kind).unwrap());
    for column in (0..N).filter(|c| !offsets.contains(c)) {
        let d = match column {
            0..3 => 10.0,
            3..6 => 1e-2,
            _ => 1e-4,
        };
        let shifted = |sign: f64| {
            let mut moved = filter.clone();
            // An error e of the estimate is what taking out −e leaves behind.
            moved.take_out(&(SVector::<f64, N>::ith(column, -sign * d)));
            observe(&moved).innovation
        };
        let numeric = (shifted(1.0) - shifted(-1.0)) / (2.0 * d);
        for row in 0..M {
            let miss = (numeric[row] - h[(row, column)]).abs();
            let scale = 1.0 + h[(row, column)].abs();
            prop_assert!(
                miss < allowed * scale,
                "row {row} column {column}: {} {} miss {miss:e}",
                numeric[row],
                h[(row, column)]
            );
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    // Allowed everywhere: central differences of smooth functions with these nudges, second order
    // about 1e-6; what is left out on purpose is named.

    #[test]
    fn geodetic_position(f in filter(), lever in vector(3.0)) {
        // A metre's change of the frame under a lever arm, l tan(lat)/R.
        let fix = Position::Geodetic(f.nav().position.displaced(&Vector3::new(3.0, -2.0, 1.0)));
        check(&f, 2e-5, |f| f.observe_position(&fix, &lever))?;
    }

    #[test]
    fn baseline(f in filter(), lever in vector(3.0), baseline in vector(20_000.0)) {
        // The frame turns with the position: 20 km/R.
        let base = f.nav().position.displaced(&baseline);
        let fix = Position::Baseline { base, ned: Vector3::new(1.0, 2.0, 3.0) };
        check(&f, 1e-2, |f| f.observe_position(&fix, &lever))?;
    }

    #[test]
    fn velocity(f in filter(), lever in vector(3.0), v in vector(50.0)) {
        // ω_in by position and velocity times the lever arm, 5e-7.
        check(&f, 1e-5, |f| f.observe_velocity(&v, &lever))?;
    }

    #[test]
    fn level(f in filter(), force in vector(12.0)) {
        check(&f, 1e-5, |f| f.observe_level(&force))?;
    }

    #[test]
    fn earth_rate(f in filter(), rate in vector(0.1)) {
        check(&f, 1e-5, |f| f.observe_earth_rate(&rate))?;
    }

    #[test]
    fn zero_velocity(f in filter()) {
        check(&f, 1e-9, |f| f.observe_zero_velocity())?;
    }

    #[test]
    fn non_holonomic(f in filter(), lever in vector(3.0)) {
        // The mounting's turn is first order in the estimate: 1e-3 of up to 70 m/s.
        check(&f, 7e-2, |f| f.observe_non_holonomic(&lever))?;
    }

    #[test]
    fn odometer(f in filter(), lever in vector(3.0), speed in -30.0..30.0f64) {
        check(&f, 7e-2, |f| f.observe_odometer(speed, &lever))?;
    }

    #[test]
    fn barometer(f in filter(), height in -100.0..3000.0f64) {
        // Rounding of a height of 300 m over the nudge.
        check(&f, 1e-8, |f| f.observe_barometer(height))?;
    }

    #[test]
    fn course(f in filter(), course in -3.0..3.0f64) {
        // Away from the seam of the angle, and from the vertical where yaw changes without bound.
        if let Some(o) = f.observe_course(course)
            && o.innovation[0].abs() < 3.0
            && o.h.norm() < 3.0
        {
            check(&f, 5e-3, |f| f.observe_course(course).unwrap())?;
        }
    }

    #[test]
    fn position_with_a_correlated_error(f in filter(), place in vector(30.0), std in vector(5.0)) {
        let fix = Position::Geodetic(f.nav().position.displaced(&place));
        let lever = Vector3::new(0.5, -0.2, -1.0);
        check(&f, 2e-5, |f| f.observe_fix_error(f.observe_position(&fix, &lever), Parameter::PositionError, &std))?;
    }

    #[test]
    fn time_offset(f in filter(), v in vector(50.0)) {
        // A filter that stands later by d looks at a fix as if its stamp were d too early.
        let fix = Position::Geodetic(f.nav().position);
        let lever = Vector3::zeros();
        let [column, of_velocity] = [Parameter::TimeOffset, Parameter::VelocityTimeOffset]
            .map(|kind| f.parameter_start(kind).unwrap());
        let mut later = f.clone();
        later.advance(1.0, None);
        let d = later.nav().time - f.nav().time;
        let position = (later.observe_position(&fix, &lever).innovation
            - f.observe_position(&fix, &lever).innovation) / d;
        let velocity = (later.observe_velocity(&v, &lever).innovation
            - f.observe_velocity(&v, &lever).innovation) / d;
        for i in 0..3 {
            // Half the step's change: 15 m/s² · 5 ms, and the turn of the force within it; Coriolis 6e-3.
            let h = f.observe_position(&fix, &lever).h[(i, column)];
            prop_assert!((position[i] + h).abs() < 0.2, "{} {h}", position[i]);
            let h = f.observe_velocity(&v, &lever).h[(i, of_velocity)];
            prop_assert!((velocity[i] + h).abs() < 0.15, "{} {h}", velocity[i]);
            // The clock's rate has grown into an offset since the start.
            let rate = f.parameter_start(Parameter::ClockRate).unwrap();
            let grown = f.observe_velocity(&v, &lever).h[(i, rate)];
            prop_assert_eq!(grown, h * f.since_start());
        }
    }
}

/// A Gauss-Markov parameter keeps its variance, forgets its estimate, and is in the start that a fix gave.
#[test]
fn a_correlated_error_fades() {
    const STATES: usize = 9 + 3;
    let (tau, dt) = (60.0, 0.1);
    let prior = Prior {
        time: tau,
        ..Prior::constant(1.0)
    };
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(47.0, 8.0, 400.0),
        v_n: Vector3::zeros(),
        q_nb: from_rpy(&Vector3::zeros()),
    };
    let std = InitialStd {
        position: Vector3::repeat(1.0),
        velocity: Vector3::repeat(0.1),
        attitude: Vector3::repeat(0.01),
    };
    let white = ShapingFilter::white(1e-6, dt).unwrap();
    let parameters = Parameters::none().with(Parameter::PositionError, prior);
    let mut filter = Filter::<STATES>::new(nav, &std, [white; AXES], parameters).unwrap();
    let five = Vector3::repeat(5.0);
    let stated = undrift_nav::Matrix3::identity() * 26.0;
    filter.set_position_velocity_covariance(&stated, &(stated * 1e-4));
    filter.share_fix_errors(&five, &Vector3::zeros());
    // What the fix was off by, the start is off by: a second fix of the same error agrees to the white part.
    let observe = |filter: &Filter<STATES>| {
        let fix = Position::Geodetic(filter.nav().position);
        filter.observe_fix_error(
            filter.observe_position(&fix, &Vector3::zeros()),
            Parameter::PositionError,
            &five,
        )
    };
    let observed = observe(&filter);
    let s = observed.h * filter.covariance() * observed.h.transpose();
    assert!((s - undrift_nav::Matrix3::identity()).norm() < 1e-9, "{s}");

    filter.take_out(&SVector::ith(9, 0.8));
    let at = filter.parameter_start(Parameter::PositionError).unwrap();
    for k in 1..=600 {
        let time = f64::from(k) * dt;
        let dvel = Vector3::new(0.0, 0.0, -9.81 * dt);
        filter.predict(&ImuSample {
            time,
            dt,
            dtheta: Vector3::zeros(),
            dvel,
        });
    }
    let left = (-1.0f64).exp();
    assert!((filter.estimates()[at] - 0.8 * left).abs() < 1e-12);
    for i in 0..3 {
        assert!((filter.covariance()[(at + i, at + i)] - 1.0).abs() < 1e-12);
        // Gravity turns with the place: 1.5e-6 1/s², over a minute.
        assert!((filter.covariance()[(i, at + i)] / (5.0 * left) - 1.0).abs() < 0.01);
    }
}
