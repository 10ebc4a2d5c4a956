//! A filter whose body axes turn is the same solution in other axes.

use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    attitude::from_rpy,
    covariance::{AXES, NAV},
    earth::Geodetic,
    filter::{Filter, Gate, InitialStd},
    mechanisation::NavState,
    parameters::{Parameter, Parameters, Prior},
    sample::{ImuSample, Position},
    shaping::ShapingFilter,
};

const N: usize = 45;
const DT: f64 = 0.02;

fn white(density: f64) -> ShapingFilter {
    ShapingFilter::white(density, DT).unwrap()
}

/// White noise, a walk and a constant of the turn-on.
fn lasting(density: f64, turn_on: f64) -> ShapingFilter {
    let walk = ShapingFilter::random_walk(0.01 * density, DT).unwrap();
    let constant = ShapingFilter::constant(turn_on, DT).unwrap();
    white(density).plus(&walk).unwrap().plus(&constant).unwrap()
}

fn triads(gyro: ShapingFilter, accel: ShapingFilter) -> [ShapingFilter; AXES] {
    [gyro, gyro, gyro, accel, accel, accel]
}

fn turn() -> Quaternion {
    from_rpy(&Vector3::new(2.0, -0.4, 1.1))
}

/// Ten seconds of a drive in bends, in the axes of the sensor.
fn samples() -> Vec<ImuSample> {
    let back = turn().inverse();
    let sample = |k: u32| {
        let time = DT * f64::from(k);
        let rate = Vector3::new(0.02 * (3.0 * time).sin(), 0.03 * (2.0 * time).cos(), 0.3);
        let force = Vector3::new(0.5 * time.sin(), 3.0, -9.8 + 0.3 * (5.0 * time).sin());
        ImuSample {
            time,
            dt: DT,
            dtheta: back * rate * DT,
            dvel: back * force * DT,
        }
    };
    (1..=500).map(sample).collect()
}

fn turned(sample: &ImuSample) -> ImuSample {
    ImuSample {
        dtheta: turn() * sample.dtheta,
        dvel: turn() * sample.dvel,
        ..*sample
    }
}

fn filter(sensors: [ShapingFilter; AXES], parameters: Parameters) -> Filter<N> {
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(47.0, 8.0, 400.0),
        v_n: Vector3::new(10.0, 1.0, 0.0),
        q_nb: from_rpy(&Vector3::new(0.02, 0.01, 1.0)) * turn(),
    };
    let std = InitialStd {
        position: Vector3::repeat(1.0),
        velocity: Vector3::repeat(0.1),
        attitude: Vector3::repeat(0.02),
    };
    Filter::new(nav, &std, sensors, parameters).unwrap()
}

/// A position somewhat off the solution.
fn fix(filter: &mut Filter<N>, lever: &Vector3) {
    let off = Vector3::new(0.3, -0.2, 0.1);
    let place = Position::Geodetic(filter.antenna_position(lever).displaced(&off));
    let observed = filter.observe_position(&place, lever);
    let noise = Matrix3::identity() * 0.25;
    filter.update(&observed, &noise, &Gate::OPEN).unwrap();
}

/// Runs samples, with a fix after every fiftieth.
fn run(filter: &mut Filter<N>, samples: impl Iterator<Item = ImuSample>, lever: &Vector3) {
    for (k, sample) in samples.enumerate() {
        filter.predict(&sample);
        if k % 50 == 49 {
            fix(filter, lever);
        }
    }
}

/// All that acts on the sensors' errors, and the lever arm.
fn parameters() -> Parameters {
    let priors = [
        (Parameter::GyroScale, 0.01),
        (Parameter::GyroMisalignment, 0.01),
        (Parameter::AccelScale, 0.02),
        (Parameter::AccelMisalignment, 0.02),
        (Parameter::LeverArm, 0.5),
    ];
    let with = |all: Parameters, (kind, std)| all.with(kind, Prior::constant(std));
    priors.into_iter().fold(Parameters::none(), with)
}

/// Largest difference of two filters' covariances and estimates, each by the standard deviations.
fn apart(a: &Filter<N>, b: &Filter<N>, states: usize) -> f64 {
    let (p, q) = (a.covariance(), b.covariance());
    let std = |i: usize| p[(i, i)].sqrt();
    let covariances = (0..states)
        .flat_map(|i| (0..states).map(move |j| (i, j)))
        .map(|(i, j)| (p[(i, j)] - q[(i, j)]).abs() / (std(i) * std(j)));
    let estimates = (NAV..states).map(|i| (a.estimates()[i] - b.estimates()[i]).abs() / std(i));
    covariances.chain(estimates).fold(0.0, f64::max)
}

#[test]
fn there_and_back_is_where_it_was() {
    let sensors = triads(lasting(1e-3, 3e-3), lasting(3e-3, 0.1));
    let mut filter = filter(sensors, parameters());
    run(&mut filter, samples().into_iter(), &Vector3::zeros());
    let before = filter.clone();
    filter.turn(&turn());
    assert!(apart(&before, &filter, before.states()) > 0.1, "turned");
    filter.turn(&turn().inverse());
    let off = apart(&before, &filter, before.states());
    assert!(off < 1e-12, "{off}");
    assert!(filter.nav().q_nb.angle_to(&before.nav().q_nb) < 1e-12);
    assert!((filter.omega_ib_b() - before.omega_ib_b()).norm() < 1e-12);
    let mut ends = [before, filter];
    for filter in &mut ends {
        filter.predict(&samples()[0]);
    }
    let [a, b] = ends.map(|filter| *filter.nav());
    assert!((a.v_n - b.v_n).norm() < 1e-12 && a.position.offset_to(&b.position).norm() < 1e-8);
}

#[test]
fn the_solution_and_its_covariance_stay_and_the_sensors_error_turns() {
    let sensors = triads(lasting(1e-3, 3e-3), lasting(3e-3, 0.1));
    let mut filter = filter(sensors, parameters());
    run(&mut filter, samples().into_iter(), &Vector3::zeros());
    let before = filter.clone();
    filter.turn(&turn());
    let (was, is) = (before.nav(), filter.nav());
    assert_eq!(
        (was.time, was.position, was.v_n),
        (is.time, is.position, is.v_n)
    );
    assert!((was.q_nb * turn().inverse()).angle_to(&is.q_nb) < 1e-14);
    for (i, j) in (0..NAV).flat_map(|i| (0..NAV).map(move |j| (i, j))) {
        assert_eq!(before.covariance()[(i, j)], filter.covariance()[(i, j)]);
    }
    let (was, is) = (before.sensor_error(), filter.sensor_error());
    for triad in [0, 3] {
        let vector = |of: &[f64; AXES]| Vector3::from_column_slice(&of[triad..triad + 3]);
        assert!(vector(&was).norm() > 1e-6, "estimated");
        assert!((turn() * vector(&was) - vector(&is)).norm() < 1e-15);
    }
}

/// Turned or not, samples and fixes of the same drive give the same solution.
fn stays_the_same(sensors: [ShapingFilter; AXES], parameters: Parameters, tolerance: f64) {
    let lever = Vector3::new(0.3, -0.5, 1.0);
    let mut straight = filter(sensors, parameters);
    let mut first = samples();
    let second = first.split_off(260);
    run(&mut straight, first.into_iter(), &lever);
    let mut other = straight.clone();
    other.turn(&turn());
    run(&mut straight, second.clone().into_iter(), &lever);
    run(&mut other, second.iter().map(turned), &(turn() * lever));
    let (a, b) = (straight.nav(), other.nav());
    let off = a.position.offset_to(&b.position).norm();
    assert!(off < tolerance, "{off} m");
    assert!((a.v_n - b.v_n).norm() < tolerance);
    assert!((a.q_nb * turn().inverse()).angle_to(&b.q_nb) < tolerance);
    let off = apart(&straight, &other, NAV);
    // Relative, after 240 steps and five updates.
    assert!(off < 1e-9, "{off}");
}

#[test]
fn of_white_sensors_nothing_depends_on_the_axes() {
    // Positions are rounded to 1e-9 m in a latitude.
    stays_the_same(triads(white(1e-3), white(3e-3)), Parameters::none(), 1e-9);
}

#[test]
fn of_sensors_with_three_equal_axes_nothing_depends_on_them() {
    let sensors = triads(lasting(1e-3, 3e-3), lasting(3e-3, 0.1));
    stays_the_same(sensors, Parameters::none(), 1e-8);
    // The whole matrix of scale factors and misalignment; what acts on a sample is known to rounding.
    stays_the_same(sensors, parameters(), 1e-8);
}

#[test]
fn axes_with_states_of_another_meaning_begin_again_with_the_error_they_had() {
    let mut sensors = triads(lasting(1e-3, 3e-3), lasting(3e-3, 0.1));
    let slow = ShapingFilter::gauss_markov(1e-3, 100.0, DT).unwrap();
    sensors[1] = sensors[1].plus(&slow).unwrap();
    let mut filter = filter(sensors, Parameters::none());
    run(&mut filter, samples().into_iter(), &Vector3::zeros());
    let before = filter.clone();
    filter.turn(&turn());
    let gyro = |of: &Filter<N>| Vector3::from_column_slice(&of.sensor_error()[..3]);
    assert!((turn() * gyro(&before) - gyro(&filter)).norm() < 1e-15);
    for axis in 0..3 {
        let (sensor, at) = (sensors[axis], filter.sensors().start(axis));
        for k in 0..sensor.order {
            for j in 0..filter.states() {
                let own = (at..at + sensor.order).contains(&j);
                let expected = if own { sensor.p0[k][j - at] } else { 0.0 };
                assert_eq!(filter.covariance()[(at + k, j)], expected);
            }
        }
    }
    // The accelerometers are alike.
    let place = filter.sensors().start(3);
    assert!(filter.covariance()[(0, place)] != 0.0);
}

#[test]
fn scale_factors_alone_keep_what_they_can() {
    let only = |kind| Parameters::none().with(kind, Prior::constant(0.02));
    let mut known = filter(triads(white(1e-3), white(3e-3)), only(Parameter::GyroScale));
    let unknown = known.clone();
    run(&mut known, samples().into_iter(), &Vector3::zeros());
    let at = known.parameter_start(Parameter::GyroScale).unwrap();
    // A quarter turn puts x in the place of y.
    let before = known.clone();
    known.turn(&from_rpy(&Vector3::new(
        0.0,
        0.0,
        core::f64::consts::FRAC_PI_2,
    )));
    for (now, was) in [(0, 1), (1, 0), (2, 2)] {
        let variance = |filter: &Filter<N>, i: usize| filter.covariance()[(at + i, at + i)];
        assert!((variance(&known, now) - variance(&before, was)).abs() < 1e-15);
        assert!((known.estimates()[at + now] - before.estimates()[at + was]).abs() < 1e-15);
    }
    // Of which nothing is known nothing is known in other axes.
    let mut other = unknown.clone();
    other.turn(&turn());
    for i in 0..3 {
        let variance = other.covariance()[(at + i, at + i)];
        assert!((variance - 4e-4).abs() < 1e-15, "{variance}");
    }
}

#[test]
fn a_parameter_begins_again() {
    let mut filter = filter(triads(white(1e-3), white(3e-3)), parameters());
    run(&mut filter, samples().into_iter(), &Vector3::zeros());
    let at = filter.parameter_start(Parameter::LeverArm).unwrap();
    assert!(filter.estimates()[at] != 0.0 && filter.covariance()[(0, at)] != 0.0);
    filter.renew(Parameter::LeverArm, 0.7);
    for i in at..at + 3 {
        assert_eq!(filter.estimates()[i], 0.0);
        for j in 0..filter.states() {
            let expected = if i == j { 0.7 * 0.7 } else { 0.0 };
            assert_eq!(filter.covariance()[(i, j)], expected);
        }
    }
    filter.renew(Parameter::Axle, 1.0);
}
