//! Every block of Φ and Γ against central differences of the code it linearises, and the structured
//! covariance step against the dense one. (H: `aiding.rs`.)

use nalgebra::{SMatrix, Vector3};
use proptest::prelude::*;
use undrift_nav::{
    Matrix3, Vector3 as V3,
    attitude::{from_rotation_vector, from_rpy},
    covariance::{AXES, NAV, Part, Sensors, Transition},
    earth::Geodetic,
    filter::{Filter, Gate, InitialStd},
    mechanisation::{Increments, NavState},
    parameters::{Coupling, Parameter, Parameters, Prior},
    sample::{ImuSample, Position},
    shaping::ShapingFilter,
};

const JOINT: usize = NAV + AXES;
type Dense = SMatrix<f64, 60, 60>;

fn vector(scale: f64) -> impl Strategy<Value = V3> {
    prop::array::uniform3(-scale..scale).prop_map(V3::from)
}

prop_compose! {
    /// A vehicle anywhere but near the poles, from a parked car to a jet.
    fn state()(
        lat in -80.0..80.0, lon in -180.0..180.0, height in -100.0..12_000.0,
        v_n in vector(150.0), rpy in vector(3.0),
    ) -> NavState {
        NavState {
            time: 0.0,
            position: Geodetic::from_degrees(lat, lon, height),
            v_n,
            q_nb: from_rpy(&Vector3::new(rpy.x, rpy.y / 2.0, rpy.z)),
        }
    }
}

prop_compose! {
    fn increments()(rate in vector(1.0), force in vector(20.0), dt in 0.002..0.02) -> Increments {
        Increments { dt, rotation: rate * dt, dvel: force * dt }
    }
}

/// The state that an error `e` (estimate less truth) turns `truth` into.
fn with_error(truth: &NavState, e: &[f64]) -> NavState {
    let at = |i: usize| V3::new(-e[i], -e[i + 1], -e[i + 2]);
    truth.without_error(&at(0), &at(3), &at(6))
}

/// Error of `estimate` against `truth`.
fn error_of(estimate: &NavState, truth: &NavState) -> [f64; NAV] {
    let dr = truth.position.offset_to(&estimate.position);
    let dv = estimate.v_n - truth.v_n;
    let psi = -(estimate.q_nb * truth.q_nb.inverse()).scaled_axis();
    [dr.x, dr.y, dr.z, dv.x, dv.y, dv.z, psi.x, psi.y, psi.z]
}

/// Size of the perturbation and of what is expected back, by kind: metres, metres a second, radians.
const NUDGE: [f64; 5] = [10.0, 0.01, 1e-4, 1e-3, 1e-2];

fn sensors(orders: [usize; AXES]) -> Sensors {
    Sensors::new(orders.map(|order| {
        let phi = [0.95, -0.2, 0.1, 0.05, -0.04, 0.02];
        let theta = [0.5, 0.1, -0.2, 0.1, 0.05];
        match order {
            0 => ShapingFilter::white(1e-3, 0.01).unwrap(),
            n => ShapingFilter::arma(&phi[..n], &theta[..n - 1], 2e-2, 0.01).unwrap(),
        }
    }))
}

/// `[Φ Γ]`, column by column.
fn whole(transition: &Transition) -> [[f64; JOINT]; NAV] {
    let unit = |row: usize| core::array::from_fn(|column| f64::from(row == column));
    let mut rows = core::array::from_fn(unit);
    transition.carry(&mut rows, &core::array::from_fn(|axis| unit(NAV + axis)));
    rows
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn transition_is_the_derivative_of_the_mechanisation(truth in state(), inc in increments()) {
        let mut nominal = truth;
        let step = nominal.step(&inc);
        let c_mid = (truth.q_nb.to_rotation_matrix().into_inner()
            + nominal.q_nb.to_rotation_matrix().into_inner()) * 0.5;
        let transition = Transition::new(&step, &c_mid);
        let analytic = whole(&transition);

        for column in 0..JOINT {
            let d = NUDGE[column / 3];
            let moved = |sign: f64| {
                let mut e = [0.0; JOINT];
                e[column] = sign * d;
                let mut state = with_error(&truth, &e[..NAV]);
                let mut inc = inc;
                inc.rotation += V3::new(e[9], e[10], e[11]) * inc.dt;
                inc.dvel += V3::new(e[12], e[13], e[14]) * inc.dt;
                state.step(&inc);
                error_of(&state, &nominal)
            };
            let (plus, minus) = (moved(1.0), moved(-1.0));
            for row in 0..NAV {
                let numeric = (plus[row] - minus[row]) / (2.0 * d);
                // Terms left out: gravity's change with latitude (8e-9 1/s² a metre), the radii's
                // with latitude, and second order in the step: (ω dt)² and dt² relative to dt for
                // the sensor columns. Rounding of a position is 2e-9 m over the nudge of 10 m.
                let scale = match (row / 3, column / 3) {
                    (0, 0) => 1e-9 + 1e-7 * inc.dt,
                    (1, 0) => 2e-8 * inc.dt,
                    (2, 0) => 2e-12 * inc.dt + 1e-16,
                    (0, 1) => 2e-6 * inc.dt + 1e-6,
                    (1, 1) => 1e-6 * inc.dt + 1e-9,
                    (2, 1) => 1e-9 * inc.dt + 1e-13,
                    (0, 2) => 1e-3 * inc.dt + 2e-5,
                    (1, 2) => 2e-4 * inc.dt + 1e-8,
                    (2, 2) => 1e-7,
                    (0, _) => 1e-2 * inc.dt * inc.dt + 2e-6,
                    (1, 3) => 0.2 * inc.dt * inc.dt,
                    _ => 3e-4 * inc.dt,
                };
                let miss = (numeric - analytic[row][column]).abs();
                prop_assert!(miss < scale, "row {row} column {column}: {numeric} {} miss {miss:e} allowed {scale:e}", analytic[row][column]);
            }
        }
    }

    #[test]
    fn structured_step_is_the_dense_step(
        truth in state(), inc in increments(), orders in prop::array::uniform6(0usize..=6),
        seed in prop::collection::vec(-1.0..1.0f64, 60 * 60), last in any::<bool>(),
        wanted in prop::array::uniform4(any::<bool>()),
    ) {
        const N: usize = 60;
        let sensors = sensors(orders);
        let mut parameters = Parameters::none();
        for (kind, wanted) in [Parameter::GyroScale, Parameter::AccelScale, Parameter::GyroMisalignment, Parameter::LeverArm].into_iter().zip(wanted) {
            if wanted { parameters = parameters.with(kind, Prior::default()); }
        }
        let behind = sensors.states();
        let n = behind + parameters.states();
        let coupling = Coupling::new(&parameters, behind, [&(inc.rotation / inc.dt), &(inc.dvel / inc.dt), &Vector3::new(1.0, -0.5, 2.0)]);
        let mut nominal = truth;
        let step = nominal.step(&inc);
        let c_mid = truth.q_nb.to_rotation_matrix().into_inner();
        let transition = Transition::new(&step, &c_mid);

        let a = Dense::from_fn(|i, j| if i < n && j < n { seed[i * N + j] } else { 0.0 });
        let p0 = a * a.transpose();
        let mut p = [[0.0; N]; N];
        for i in 0..n { for j in 0..n { p[i][j] = p0[(i, j)]; } }

        let part = if last { Part::Last } else { Part::Inner };
        sensors.propagate(&mut p, &transition, &coupling, inc.dt, part);

        // Dense: the whole matrices, with w ~ N(0, I) in the form G w, D w.
        let map = whole(&transition);
        let mut phi = Dense::zeros();
        let mut q = Dense::zeros();
        for i in 0..NAV { for j in 0..NAV { phi[(i, j)] = map[i][j]; } }
        for axis in 0..AXES {
            let (filter, at) = (sensors.axis(axis), sensors.start(axis));
            let white = filter.r * filter.interval / inc.dt;
            for i in 0..NAV {
                for j in 0..NAV { q[(i, j)] += map[i][NAV + axis] * white * map[j][NAV + axis]; }
                for j in 0..filter.order { phi[(i, at + j)] = map[i][NAV + axis] * filter.h[j]; }
                for (index, factor) in coupling.axis(axis) { phi[(i, *index)] += map[i][NAV + axis] * factor; }
            }
            for i in 0..filter.order {
                for j in 0..filter.order {
                    phi[(at + i, at + j)] = if last { filter.f[i][j] } else { f64::from(i == j) };
                    if last { q[(at + i, at + j)] += filter.q[i][j]; }
                }
                if last {
                    for row in 0..NAV {
                        q[(row, at + i)] += map[row][NAV + axis] * filter.s[i];
                        q[(at + i, row)] += map[row][NAV + axis] * filter.s[i];
                    }
                }
            }
        }
        for i in behind..n { phi[(i, i)] = 1.0; }
        let dense = phi * p0 * phi.transpose() + q;
        // The smoother's product of transitions.
        let mut m = [[0.0; N]; N];
        for i in 0..n { for j in 0..n { m[i][j] = a[(i, j)]; } }
        sensors.carry(&mut m, &transition, &coupling, part);
        let carried = phi * a;
        for i in 0..n {
            for j in 0..n {
                let size: f64 = (0..n).map(|k| (phi[(i, k)] * a[(k, j)]).abs()).sum();
                prop_assert!((m[i][j] - carried[(i, j)]).abs() <= 1e-14 * size, "{i} {j}");
            }
        }
        for i in 0..n {
            for j in 0..n {
                prop_assert_eq!(p[i][j], p[j][i]);
                // Rounding of sums of some hundred terms, relative to the two variances.
                let allowed = 1e-13 * (dense[(i, i)] * dense[(j, j)]).sqrt();
                prop_assert!((p[i][j] - dense[(i, j)]).abs() <= allowed, "{i} {j} {} {}", p[i][j], dense[(i, j)]);
            }
        }
    }
}

#[test]
fn covariance_stays_symmetric_and_positive_through_a_day_of_updates() {
    const N: usize = 21;
    let dt = 0.02;
    let gyro = ShapingFilter::white(5e-4, dt)
        .and_then(|w| w.plus(&ShapingFilter::gauss_markov(1e-4, 100.0, dt)?))
        .and_then(|w| w.plus(&ShapingFilter::constant(5e-2, dt)?))
        .unwrap();
    let accel = ShapingFilter::white(3e-3, dt)
        .and_then(|w| w.plus(&ShapingFilter::gauss_markov(2e-3, 100.0, dt)?))
        .and_then(|w| w.plus(&ShapingFilter::constant(0.5, dt)?))
        .unwrap();
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: V3::zeros(),
        q_nb: from_rotation_vector(&V3::zeros()),
    };
    let std = InitialStd {
        position: V3::repeat(100.0),
        velocity: V3::repeat(10.0),
        attitude: V3::new(0.3, 0.3, 3.0),
    };
    let mut filter = Filter::<N>::new(
        nav,
        &std,
        [gyro, gyro, gyro, accel, accel, accel],
        Parameters::none(),
    )
    .unwrap();
    let earth = undrift_nav::earth::LocalEarth::at(&nav.position);
    for k in 0..400_000u32 {
        filter.predict(&ImuSample {
            time: f64::from(k) * dt,
            dt,
            dtheta: earth.earth_rate() * dt,
            dvel: V3::new(0.0, 0.0, -earth.gravity * dt),
        });
        if k % 10 == 0 {
            // Millimetres against a start of hundreds of metres: ten orders of magnitude of variance.
            let fix = Position::Geodetic(nav.position);
            let observed = filter.observe_position(&fix, &V3::zeros());
            filter
                .update(&observed, &(Matrix3::identity() * 1e-6), &Gate::OPEN)
                .unwrap();
        }
    }
    filter.check().unwrap();
    let p = filter.covariance();
    assert_eq!(*p, p.transpose());
    // Scaled to unit diagonal, so that units do not decide.
    let scale = p.diagonal().map(|v| 1.0 / v.sqrt());
    let unit = SMatrix::<f64, N, N>::from_fn(|i, j| p[(i, j)] * scale[i] * scale[j]);
    let least = unit.symmetric_eigenvalues().min();
    // A covariance that lost positivity has an eigenvalue well below zero; rounding leaves ±1e-12.
    assert!(least > -1e-12, "{least}");
    // From 100 m to the level of the fixes and of what the accelerometers add between two of them.
    assert!(filter.nav_std()[0] < 2e-3, "{:?}", filter.nav_std());
}
