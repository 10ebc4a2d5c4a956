//! Every observation matrix against the derivative of its innovation to 1e-6, all parameters estimated; what a row
//! omits by design is added in closed form.

use nalgebra::{SMatrix, SVector};
use proptest::prelude::*;
use undrift_nav::{
    Matrix3, Vector3,
    aiding::Observation,
    attitude::{from_rpy, skew},
    covariance::AXES,
    earth::{Geodetic, LocalEarth},
    filter::{Filter, Gate, InitialStd},
    mechanisation::NavState,
    parameters::{Parameter, Parameters, Prior},
    sample::{ImuSample, MeanVelocity, Position},
    shaping::ShapingFilter,
};

/// Nine, one state an axis, and all parameters.
const N: usize = 9 + 6 + 53;

fn vector(scale: f64) -> impl Strategy<Value = Vector3> {
    prop::array::uniform3(-scale..scale).prop_map(Vector3::from)
}

/// Of a derivative, relative to one more than its size: rounding of a place on the Earth, 2e-9 m over the least nudge
/// of 0.015 rad, and the curvature of the Earth under a lever arm of 1.7 m and 45° of latitude, `l tan(lat) / R`, both
/// below 4e-7. Truncation of the differences is below 1e-8.
const ALLOWED: f64 = 1e-6;

prop_compose! {
    /// A filter in the middle of a sample, its sensor states and parameters away from zero.
    fn filter()(
        lat in -45.0..45.0, v_n in vector(40.0), rpy in vector(1.2), rate in vector(0.5),
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
        let dt = 0.1;
        filter.begin(&ImuSample { time: dt, dt, dtheta: rate * dt, dvel: force * dt });
        filter.advance(0.3);
        let shift = SVector::<f64, N>::from_fn(|i, _| if i < 9 { 0.0 } else { 0.03 * small[i] });
        filter.apply_correction(&shift);
        filter
    }
}

/// Derivative of a smooth function at zero by central differences over `nudge`, its half and its quarter, extrapolated
/// to none (Romberg; Stoer & Bulirsch 2002, section 3.5): the sixth order is left.
fn derivative<const M: usize>(
    nudge: f64,
    value: impl Fn(f64) -> SVector<f64, M>,
) -> SVector<f64, M> {
    let central = |d: f64| (value(d) - value(-d)) / (2.0 * d);
    let [whole, half, quarter] = [1.0, 0.5, 0.25].map(|part| central(part * nudge));
    let [coarse, fine] = [(half * 4.0 - whole) / 3.0, (quarter * 4.0 - half) / 3.0];
    (fine * 16.0 - coarse) / 15.0
}

/// Column by column: what an error of a state does to the innovation is the row, and what that omits by design.
/// The time offsets have a test of their own.
fn check<const M: usize>(
    filter: &Filter<N>,
    omitted: &SMatrix<f64, M, N>,
    observe: impl Fn(&Filter<N>) -> Observation<M, N>,
) -> Result<(), TestCaseError> {
    let h: SMatrix<f64, M, N> = observe(filter).h + omitted;
    let offsets = [
        Parameter::TimeOffset,
        Parameter::VelocityTimeOffset,
        Parameter::ClockRate,
    ]
    .map(|kind| filter.parameter_start(kind).unwrap());
    for column in (0..N).filter(|c| !offsets.contains(c)) {
        let nudge = match column {
            0..3 => 40.0,
            3..6 => 0.5,
            _ => 0.06,
        };
        let numeric = derivative(nudge, |d| {
            let mut moved = filter.clone();
            // An error e of the estimate is what taking out −e leaves behind.
            moved.apply_correction(&(SVector::<f64, N>::ith(column, -d)));
            observe(&moved).innovation
        });
        for row in 0..M {
            let miss = (numeric[row] - h[(row, column)]).abs();
            let scale = 1.0 + h[(row, column)].abs();
            prop_assert!(
                miss < ALLOWED * scale,
                "row {row} column {column}: {} {} miss {miss:e}",
                numeric[row],
                h[(row, column)]
            );
        }
    }
    Ok(())
}

/// Nothing.
fn nothing<const M: usize>() -> SMatrix<f64, M, N> {
    SMatrix::zeros()
}

/// Rate of the navigation frame [rad/s].
fn omega_in(filter: &Filter<N>) -> Vector3 {
    let earth = LocalEarth::at(&filter.nav().position);
    earth.earth_rate() + earth.transport_rate(&filter.nav().v_n)
}

/// `J_r(m) − 1` of the mounting m, what its columns omit: they take the estimated turn for a small one. The right
/// Jacobian of SO(3), `1 − (1 − cos θ)/θ² [m×] + (θ − sin θ)/θ³ [m×]²` (Chirikjian 2012, section 10.6).
fn beyond_small_turns(filter: &Filter<N>) -> Matrix3 {
    let ([pitch, yaw, ..], _) = filter.parameter(Parameter::Mounting).unwrap();
    let m = Vector3::new(0.0, pitch, yaw);
    let (theta, cross) = (m.norm(), skew(&m));
    // Of no turn the limits.
    let (first, second) = match theta > 0.0 {
        true => (
            (1.0 - theta.cos()) / theta.powi(2),
            (theta - theta.sin()) / theta.powi(3),
        ),
        false => (0.5, 1.0 / 6.0),
    };
    cross * cross * second - cross * first
}

/// What the rows of the velocity of a point of the vehicle omit: with the attitude turns the rate of the frame in
/// ω_nb^b, `−C_b^v [l×] C_n^b [ω_in×]`, some 1e-4 m/s/rad; and the mounting's, `−[v^v×] (J_r − 1)`.
fn omitted_of_vehicle_velocity(filter: &Filter<N>, lever: &Vector3) -> SMatrix<f64, 3, N> {
    let mut omitted = nothing::<3>();
    let of_frame =
        filter.c_bv() * skew(lever) * filter.c_nb().transpose() * skew(&omega_in(filter));
    omitted.fixed_view_mut::<3, 3>(0, 6).copy_from(&-of_frame);
    let at = filter.parameter_start(Parameter::Mounting).unwrap();
    let turned = skew(&filter.vehicle_velocity(lever)) * beyond_small_turns(filter);
    omitted
        .fixed_view_mut::<3, 2>(0, at)
        .copy_from(&-turned.fixed_columns::<2>(1));
    omitted
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn geodetic_position(f in filter(), lever in vector(1.0)) {
        let fix = Position::Geodetic(f.nav().position.displaced(&Vector3::new(0.6, -0.4, 0.2)));
        check(&f, &nothing(), |f| f.observe_position(&fix, &lever))?;
    }

    #[test]
    fn baseline(f in filter(), lever in vector(1.0), baseline in vector(20_000.0)) {
        let base = f.nav().position.displaced(&baseline);
        let fix = Position::Baseline { base, ned: Vector3::new(1.0, 2.0, 3.0) };
        check(&f, &nothing(), |f| f.observe_position(&fix, &lever))?;
    }

    #[test]
    fn attitude_of_a_marker(f in filter(), axes in vector(3.0)) {
        let q_bk = from_rpy(&axes);
        // At the innovation of zero; elsewhere the rows miss its own Jacobian.
        let q_rk = f.marker_attitude(&q_bk);
        check(&f, &nothing(), |f| f.observe_attitude(&q_rk, &q_bk))?;
    }

    #[test]
    fn velocity(f in filter(), lever in vector(1.0), v in vector(50.0)) {
        check(&f, &nothing(), |f| f.observe_velocity(&v, &lever))?;
    }

    #[test]
    fn level(f in filter(), force in vector(12.0)) {
        check(&f, &nothing(), |f| f.observe_level(&force))?;
    }

    #[test]
    fn earth_rate(f in filter(), rate in vector(0.1)) {
        check(&f, &nothing(), |f| f.observe_earth_rate(&rate))?;
    }

    #[test]
    fn zero_velocity(f in filter()) {
        check(&f, &nothing(), |f| f.observe_zero_velocity())?;
    }

    #[test]
    fn non_holonomic(f in filter(), lever in vector(1.0)) {
        let mut axle = lever;
        axle.x += f.parameter(Parameter::Axle).unwrap().0[0];
        let omitted = omitted_of_vehicle_velocity(&f, &axle).fixed_rows::<2>(1).into_owned();
        check(&f, &omitted, |f| f.observe_non_holonomic(&lever))?;
    }

    #[test]
    fn odometer(f in filter(), lever in vector(1.0), speed in -30.0..30.0f64) {
        let gain = 1.0 + f.parameter(Parameter::OdometerScale).unwrap().0[0];
        let omitted = omitted_of_vehicle_velocity(&f, &lever).fixed_rows::<1>(0) * gain;
        check(&f, &omitted, |f| f.observe_odometer(speed, &lever))?;
    }

    #[test]
    fn barometer(f in filter(), height in -100.0..3000.0f64) {
        check(&f, &nothing(), |f| f.observe_barometer(height))?;
    }

    #[test]
    fn heading_by_two_antennas(f in filter(), heading in -3.0..3.0f64, baseline in -3.0..3.0f64) {
        // As of the course.
        if let Some(o) = f.observe_heading(heading, baseline)
            && o.innovation[0].abs() < 3.0
            && o.h.norm() < 3.0
        {
            check(&f, &nothing(), |f| f.observe_heading(heading, baseline).unwrap())?;
        }
    }

    #[test]
    fn air_velocity(f in filter()) {
        check(&f, &nothing(), |f| f.observe_air_velocity())?;
    }

    #[test]
    fn rotor_drag(f in filter(), force in vector(10.0), drag in 0.1..0.4f64) {
        check(&f, &nothing(), |f| f.observe_rotor_drag(&force, drag))?;
    }

    #[test]
    fn magnetometer(f in filter(), measured in vector(1.0), field in vector(1.0)) {
        check(&f, &nothing(), |f| f.observe_magnetometer(&measured, &field))?;
    }

    #[test]
    fn course(f in filter(), course in -3.0..3.0f64) {
        // Away from the seam of the angle, and from the vertical where yaw changes without bound.
        if let Some(o) = f.observe_course(course)
            && o.innovation[0].abs() < 3.0
            && o.h.norm() < 3.0
        {
            // Of the mounting's columns that the turn is no small one: `−∂yaw/∂f C_v^n ((J_r − 1) e_i × x)`.
            let c_vn = f.c_nb() * f.c_bv().transpose();
            let forward: Vector3 = c_vn.column(0).into();
            let yaw = |df: &Vector3| forward.xy().perp(&df.xy()) / forward.xy().norm_squared();
            let (at, beyond) = (f.parameter_start(Parameter::Mounting).unwrap(), beyond_small_turns(&f));
            let mut omitted = nothing::<1>();
            for i in 0..2 {
                let turn: Vector3 = beyond.column(1 + i).into();
                omitted[(0, at + i)] = -yaw(&(c_vn * turn.cross(&Vector3::x())));
            }
            check(&f, &omitted, |f| f.observe_course(course).unwrap())?;
        }
    }

    #[test]
    fn position_with_a_correlated_error(f in filter(), std in vector(5.0)) {
        let fix = Position::Geodetic(f.nav().position);
        let lever = Vector3::new(0.5, -0.2, -1.0);
        check(&f, &nothing(), |f| f.observe_fix_error(f.observe_position(&fix, &lever), Parameter::PositionError, &std))?;
    }

    #[test]
    fn time_offset(f in filter(), v in vector(50.0), lever in vector(1.0)) {
        // A filter that is later by d looks at a fix as if its stamp were d too early. The filter moves forwards
        // only: differences over a step, its half, quarter and eighth, extrapolated to none, leave the fourth order.
        let fix = Position::Geodetic(f.nav().position);
        let q_bk = from_rpy(&v);
        let q_rk = f.marker_attitude(&q_bk);
        let ahead = |part: f64| {
            let mut later = f.clone();
            later.advance(0.3 + 0.6 * part);
            let d = later.nav().time - f.nav().time;
            let position = later.observe_position(&fix, &lever).innovation
                - f.observe_position(&fix, &lever).innovation;
            let velocity = later.observe_velocity(&v, &lever).innovation
                - f.observe_velocity(&v, &lever).innovation;
            let attitude = later.observe_attitude(&q_rk, &q_bk).innovation;
            SMatrix::<f64, 3, 3>::from_columns(&[position / d, velocity / d, attitude / d])
        };
        let mut slopes = [1.0, 0.5, 0.25, 0.125].map(ahead);
        for order in 1..4 {
            let finer = f64::from(1 << order);
            for k in 0..4 - order as usize {
                slopes[k] = (slopes[k + 1] * finer - slopes[k]) / (finer - 1.0);
            }
        }
        // The velocity's column is the acceleration of the IMU: it omits Coriolis', and how the antenna's velocity
        // about the IMU turns: with the body, with the frame against the body, and with the transport rate.
        let (c, omega, accel) = (f.c_nb(), f.omega_nb_b(), f.acceleration());
        let earth = LocalEarth::at(&f.nav().position);
        let coriolis = (omega_in(&f) + earth.earth_rate()).cross(&f.nav().v_n);
        let lever_b = f.lever_arm(&lever);
        let frame = omega.cross(&c.tr_mul(&omega_in(&f))) - c.tr_mul(&earth.transport_rate(&accel));
        let omitted = coriolis - c * (omega.cross(&omega.cross(&lever_b)) + frame.cross(&lever_b));

        let [column, of_velocity, rate] = [Parameter::TimeOffset, Parameter::VelocityTimeOffset, Parameter::ClockRate]
            .map(|kind| f.parameter_start(kind).unwrap());
        let [position, velocity] = [f.observe_position(&fix, &lever).h, f.observe_velocity(&v, &lever).h];
        for (slope, h, by_design) in [
            (slopes[0].column(0), position.column(column).into_owned(), Vector3::zeros()),
            (slopes[0].column(1), velocity.column(of_velocity).into_owned(), omitted),
            (slopes[0].column(2), f.observe_attitude(&q_rk, &q_bk).h.column(column).into_owned(), Vector3::zeros()),
        ] {
            // A place over the least step of 7 ms, three times by the extrapolation: 1e-6 of a speed of a few m/s.
            let miss = (slope + h + by_design).norm();
            prop_assert!(miss < ALLOWED * (3.0 + h.norm()), "{slope} {h} miss {miss:e}");
        }
        // The clock's rate has grown into an offset since the start.
        prop_assert_eq!(velocity.column(rate), velocity.column(of_velocity) * f.since_start());
        prop_assert_eq!(position.column(rate), position.column(column) * f.since_start());
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
    let of_velocity = stated * 1e-4;
    filter.set_position_velocity_covariance(&stated, &of_velocity);
    filter.correlate_with_fix_errors([&stated, &of_velocity], [&five, &Vector3::zeros()]);
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

    filter.apply_correction(&SVector::ith(9, 0.8));
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

/// White noise of the gyros moves a point about the IMU: over a lever arm l by l² times its variance across, not along.
#[test]
fn white_noise_of_the_gyros_reaches_the_end_of_a_lever_arm() {
    let (dt, density) = (0.01, 1e-3);
    let of_rate = density * density / dt;
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(47.0, 8.0, 400.0),
        v_n: Vector3::new(5.0, 0.0, 0.0),
        q_nb: from_rpy(&Vector3::zeros()),
    };
    // Nothing else is uncertain.
    let std = InitialStd {
        position: Vector3::zeros(),
        velocity: Vector3::zeros(),
        attitude: Vector3::zeros(),
    };
    let white = ShapingFilter::white(density, dt).unwrap();
    let mut filter = Filter::<9>::new(nav, &std, [white; AXES], Parameters::none()).unwrap();
    filter.begin(&ImuSample {
        time: dt,
        dt,
        dtheta: Vector3::zeros(),
        dvel: Vector3::new(0.0, 0.0, -9.81 * dt),
    });
    let stated = 1e-4;
    let r = Matrix3::identity() * stated;
    let ahead = Vector3::new(2.0, 0.0, 0.0);
    let off = Vector3::repeat(0.1);

    let measured = filter.antenna_velocity(&ahead) - off;
    let velocity = filter.observe_velocity(&measured, &ahead);
    let nis = filter.clone().update(&velocity, &r, &Gate::OPEN);
    let expected = 0.01 / stated + 2.0 * 0.01 / (stated + 4.0 * of_rate);
    // Rounding.
    assert!((nis.unwrap().nis / expected - 1.0).abs() < 1e-12);

    let axle = filter.observe_non_holonomic(&ahead);
    let r = r.fixed_view::<2, 2>(0, 0).into_owned();
    let nis = filter.clone().update(&axle, &r, &Gate::OPEN);
    let expected = axle.innovation.norm_squared() / (stated + 4.0 * of_rate);
    assert!((nis.unwrap().nis / expected - 1.0).abs() < 1e-12);

    // Pitch moves a wheel below the IMU forwards.
    let wheel = filter.observe_odometer(4.0, &Vector3::new(0.0, 0.0, 1.5));
    let r = SMatrix::<f64, 1, 1>::new(stated);
    let nis = filter.clone().update(&wheel, &r, &Gate::OPEN);
    let expected = wheel.innovation.norm_squared() / (stated + 2.25 * of_rate);
    assert!((nis.unwrap().nis / expected - 1.0).abs() < 1e-12);
}

/// A wheel below the IMU whose reading is 25 % too large: the white noise of the gyros reaches it times the arm, and the
/// reading times 1.25.
#[test]
fn white_noise_in_a_wheel_is_read_with_its_scale() {
    let (dt, density) = (0.01, 2e-3);
    let white = ShapingFilter::white(density, dt).unwrap();
    let parameters = Parameters::none().with(Parameter::OdometerScale, Prior::constant(0.05));
    let still = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(48.0, 11.0, 500.0),
        v_n: Vector3::zeros(),
        q_nb: from_rpy(&Vector3::zeros()),
    };
    let std = InitialStd {
        position: Vector3::repeat(1e-6),
        velocity: Vector3::repeat(1e-6),
        attitude: Vector3::repeat(1e-6),
    };
    let mut filter: Filter<10> = Filter::new(still, &std, [white; AXES], parameters).unwrap();
    let at = filter.parameter_start(Parameter::OdometerScale).unwrap();
    let lever = Vector3::new(0.0, 0.0, 2.0);
    let extra = |filter: &Filter<10>| filter.observe_odometer(4.0, &lever).extra[(0, 0)];
    let plain = extra(&filter);
    // A rate of white noise over one sample.
    assert!((plain / (4.0 * density * density / dt) - 1.0).abs() < 1e-12);
    filter.apply_correction(&SVector::ith(at, 0.25));
    assert!((extra(&filter) / plain - 1.25 * 1.25).abs() < 1e-12);
}

mod mean_velocity {
    use super::*;
    use undrift_nav::aiding::Stretch;

    const DT: f64 = 0.01;

    /// What a filter goes through: 0.4 s of turns and forces that change.
    fn stretch(filter: &mut Filter<15>) -> Stretch {
        let mut stretch = Stretch::new(filter.nav());
        for k in 1..=40 {
            let t = DT * f64::from(k);
            let rate = Vector3::new(0.2 * t, -0.3, 0.8 - t);
            let force = Vector3::new(2.0 - 9.0 * t, 3.0 * t, -9.8 + 4.0 * t * t);
            let before = *filter.nav();
            filter
                .step(&ImuSample::from_rates(t, DT, rate, force))
                .unwrap();
            stretch.add(&before, filter.nav());
        }
        stretch
    }

    fn path(filter: &mut Filter<15>, lever: &Vector3, measured: &Vector3) -> Observation<3, 15> {
        let stretch = stretch(filter);
        filter.observe_mean_velocity(measured, lever, &stretch)
    }

    fn start() -> Filter<15> {
        let nav = NavState {
            time: 0.0,
            position: Geodetic::from_degrees(47.0, 8.0, 400.0),
            v_n: Vector3::new(8.0, -3.0, 0.4),
            q_nb: from_rpy(&Vector3::new(0.2, -0.1, 1.1)),
        };
        let std = InitialStd {
            position: Vector3::repeat(1.0),
            velocity: Vector3::repeat(1.0),
            attitude: Vector3::repeat(0.1),
        };
        let sensor = ShapingFilter::constant(0.1, DT).unwrap();
        let sensor = sensor
            .plus(&ShapingFilter::white(2e-3, DT).unwrap())
            .unwrap();
        Filter::new(nav, &std, [sensor; AXES], Parameters::none()).unwrap()
    }

    #[test]
    fn the_prediction_is_the_way_of_the_antenna_over_its_time() {
        let lever = Vector3::new(0.4, -0.2, -1.3);
        let mut filter = start();
        let from = filter.antenna_position(&lever);
        let observed = path(&mut filter, &lever, &Vector3::zeros());
        let way = from.offset_to(&filter.antenna_position(&lever)) / 0.4;
        // Trapezoids of 10 ms, the Earth's curvature under the way.
        assert!(
            (observed.innovation - way).amax() < 2e-4,
            "{}",
            observed.innovation
        );
        // White noise N of each accelerometer over T: N² T / 3.
        let white = observed.extra.trace() / 3.0;
        assert!((white / (4e-6 * 0.4 / 3.0) - 1.0).abs() < 1e-9, "{white}");
    }

    /// Along a direction: the row's part of the three, and what a mean velocity changes with the place.
    #[test]
    fn along_a_direction_the_place_counts() {
        let lever = Vector3::new(0.4, -0.2, -1.3);
        let direction = Vector3::new(0.6, -0.64, 0.48);
        let mean = MeanVelocity {
            over: 0.4,
            v_n: Vector3::new(7.0, -2.0, 0.0),
            covariance: Matrix3::identity(),
            place: start()
                .nav()
                .position
                .displaced(&Vector3::new(300.0, -200.0, 40.0)),
            by_place: Matrix3::new(1.1, 0.3, -0.8, 0.2, -0.7, 0.5, 0.9, 0.4, -1.3) * 1e-4,
        };
        let with = |error: SVector<f64, 15>| {
            let mut filter = start();
            filter.apply_correction(&error);
            let stretch = stretch(&mut filter);
            let along = filter.observe_mean_velocity_along(&direction, &mean, &lever, &stretch);
            let all = filter.observe_mean_velocity(&mean.v_n, &lever, &stretch);
            (filter, along, all)
        };
        let (filter, along, all) = with(SVector::zeros());
        let off = mean.place.offset_to(&filter.antenna_position(&lever));
        let expected = direction.dot(&(all.innovation - mean.by_place * off));
        assert!(off.norm() > 300.0 && (along.innovation[0] - expected).abs() < 1e-12);
        let rest = (direction.transpose() * all.h - along.h)
            .columns(3, 12)
            .amax();
        assert!(rest < 1e-12);
        assert!((along.extra[0] - direction.dot(&(all.extra * direction))).abs() < 1e-18);
        for axis in 0..3 {
            let ((plus, high, _), (minus, low, _)) = (
                with(SVector::ith(axis, 5.0)),
                with(SVector::ith(axis, -5.0)),
            );
            let moved = minus.nav().position.offset_to(&plus.nav().position);
            let said = along.h.fixed_columns::<3>(0) * moved;
            let made = high.innovation - low.innovation;
            assert!((made - said).amax() < 1e-5, "{axis}: {made} {said}");
            assert!(made.amax() > 1e-4);
        }
    }

    /// Rank two: two directions, with their variances.
    #[test]
    fn directions_are_those_that_satellites_show() {
        let open = Vector3::new(0.6, 0.0, 0.8);
        let covariance = Matrix3::identity() * 4e-4 + open * open.transpose() * 1e4;
        let mean = MeanVelocity {
            over: 1.0,
            v_n: Vector3::zeros(),
            covariance,
            place: start().nav().position,
            by_place: Matrix3::zeros(),
        };
        let shown: Vec<_> = mean.directions().collect();
        assert_eq!(shown.len(), 2);
        for (direction, variance) in shown {
            assert!(direction.dot(&open).abs() < 1e-9 && (direction.norm() - 1.0).abs() < 1e-12);
            assert!((variance / 4e-4 - 1.0).abs() < 1e-6);
        }
    }

    /// An error at the start goes through the mechanisation; the row, on what has come of it, gives the same innovation.
    #[test]
    fn rows_are_what_errors_before_the_stretch_make() {
        let lever = Vector3::new(0.4, -0.2, -1.3);
        let measured = Vector3::new(7.0, -2.0, 0.0);
        for column in 3..15 {
            let nudge = [0.0, 0.1, 1e-4, 1e-4, 1e-3][column / 3];
            let with = |sign: f64| {
                let mut filter = start();
                let mut error = SVector::<f64, 15>::zeros();
                error[column] = sign * nudge;
                filter.apply_correction(&error);
                let observed = path(&mut filter, &lever, &measured);
                (filter, observed)
            };
            let ((plus, high), (minus, low)) = (with(1.0), with(-1.0));
            let mut error = SVector::<f64, 15>::zeros();
            let dv = plus.nav().v_n - minus.nav().v_n;
            let psi = -(plus.nav().q_nb * minus.nav().q_nb.inverse()).scaled_axis();
            for i in 0..3 {
                error[3 + i] = dv[i];
                error[6 + i] = psi[i];
            }
            for i in 9..15 {
                // Truth less estimate.
                error[i] = minus.estimates()[i] - plus.estimates()[i];
            }
            let made = high.innovation - low.innovation;
            let said = (high.h + low.h) * 0.5 * error;
            // Left out: what a gyro's error turns within T, f T²/6 of it, and the body's turn within T for the accelerometers.
            let allowed = match column {
                0..9 => 2e-3 * made.amax().max(error.amax() * 1e-3),
                9..12 => 0.35 * error.amax(),
                _ => 0.2 * made.amax(),
            };
            assert!((made - said).amax() < allowed, "{column}: {made} {said}");
            assert!(made.amax() > 1e-6, "{column}");
        }
    }
}
