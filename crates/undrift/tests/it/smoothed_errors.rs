//! The smoother where every error is drawn from what it believes: its covariance to 5 %, and its clock.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift::{
    estimator::{self, Adjoint, Aiding},
    nav::{
        Matrix3, Vector3,
        attitude::from_rpy,
        earth::Geodetic,
        filter::{Gate, InitialStd},
        mechanisation::{Increments, NavState, RawIncrements},
        parameters::{Parameter, Parameters, Prior},
        sample::{ImuSample, Position},
        shaping::ShapingFilter,
    },
    smooth::History,
};

/// Sample interval of the short drives \[s\].
const STEP: f64 = 0.1;

/// White noise and a Gauss-Markov bias: one state.
fn biased(white: f64, sigma: f64) -> ShapingFilter {
    ShapingFilter::white(white, STEP)
        .and_then(|w| w.plus(&ShapingFilter::gauss_markov(sigma, 20.0, STEP)?))
        .unwrap()
}

/// Twelve seconds of a filter of 15 states whose start, sensors and fixes err as it believes, a fix each second but for
/// five in the middle: the normalised squares of the smoothed errors of position, velocity and attitude at each second.
fn smoothed_squares(seed: u64) -> Vec<[f64; 3]> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let (gyro, accel) = (biased(1e-3, 2e-3), biased(1e-2, 0.05));
    let models = [gyro, gyro, gyro, accel, accel, accel];
    let std = InitialStd {
        position: Vector3::repeat(1.0),
        velocity: Vector3::repeat(0.3),
        attitude: Vector3::repeat(0.01),
    };
    let mut truth = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: Vector3::new(8.0, -3.0, 0.5),
        q_nb: from_rpy(&Vector3::new(0.1, -0.2, 1.0)),
    };
    let mut drawn = |std: &Vector3| std.map(|std| std * normal());
    let [dr, dv, psi] = [&std.position, &std.velocity, &std.attitude].map(&mut drawn);
    let start = truth.without_error(&dr, &dv, &psi);
    let mut filter = estimator::build(start, &std, &models, Parameters::none()).unwrap();
    let mut bias = models.map(|model| model.p0[0][0].sqrt() * normal());

    let mut history = History::new().unwrap();
    history.push(&*filter, None).unwrap();
    filter.record();
    let mut truths = vec![truth];
    let mut previous = None;
    for k in 0..120 {
        let time = STEP * f64::from(k + 1);
        let rate = Vector3::new(0.1, -0.2, 0.3 * (0.4 * time).sin());
        let force = Vector3::new((0.3 * time).cos(), 0.5, -9.8);
        let raw = RawIncrements {
            dt: STEP,
            dtheta: rate * STEP,
            dvel: force * STEP,
        };
        let increments =
            Increments::from_raw(raw.dt, raw.dtheta, raw.dvel, previous.replace(raw).as_ref());
        truth.step(&increments);
        truth.time = time;
        let mut reads = |axis: usize| {
            let error = bias[axis] + models[axis].r.sqrt() * normal();
            bias[axis] = models[axis].f[0][0] * bias[axis] + models[axis].q[0][0].sqrt() * normal();
            error * STEP
        };
        let dtheta = raw.dtheta + Vector3::from_fn(|i, _| reads(i));
        let dvel = raw.dvel + Vector3::from_fn(|i, _| reads(3 + i));
        filter.begin(&ImuSample {
            time,
            dt: STEP,
            dtheta,
            dvel,
        });
        filter.advance(None);
        if (k + 1) % 10 > 0 {
            continue;
        }
        if !(4.5..9.5).contains(&time) {
            let off = Vector3::from_fn(|_, _| normal());
            let fix = Aiding::Position {
                position: Position::Geodetic(truth.position.displaced(&off)),
                lever_arm: Vector3::zeros(),
                correlated: Vector3::zeros(),
                due: time,
            };
            filter
                .update(&fix, &Matrix3::identity(), &Gate::OPEN)
                .unwrap();
        }
        history.push(&*filter, filter.adjoint().as_ref()).unwrap();
        filter.record();
        truths.push(truth);
    }
    let smoothed = history.smooth().unwrap().unwrap();
    let squares = smoothed.nodes.iter().zip(&truths).map(|(node, truth)| {
        let turn = truth.q_nb * node.nav.q_nb.inverse();
        let errors = [
            truth.position.offset_to(&node.nav.position),
            node.nav.v_n - truth.v_n,
            turn.scaled_axis(),
        ];
        std::array::from_fn(|group| {
            let inverse = node.predicted.0[group].try_inverse().unwrap();
            errors[group].dot(&(inverse * errors[group])) / 3.0
        })
    });
    squares.collect()
}

#[test]
fn smoothed_errors_have_the_covariance_that_is_stated() {
    const SEEDS: u64 = 4300;
    let runs: Vec<Vec<[f64; 3]>> = (0..SEEDS).map(smoothed_squares).collect();
    // At the start, at the last fix before the outage, within it, after it.
    for second in [0, 4, 6, 8, 10] {
        for (group, name) in ["position", "velocity", "attitude"].into_iter().enumerate() {
            let mean = runs.iter().map(|run| run[second][group]).sum::<f64>() / SEEDS as f64;
            println!("{name} at {second} s: {mean:.3}");
            // χ² of three over three has a variance of 2/3: the mean of 4300 seeds one of 1.25 % squared, four of which are 5 %.
            assert!((mean - 1.0).abs() < 0.05, "{name} at {second} s: {mean}");
        }
    }
}

/// The fixes' clock gains on the samples': what smoothing finds of offset and rate together moves the antenna along.
#[test]
fn a_node_made_for_a_fix_is_late_by_the_offset_and_by_what_the_clock_has_gained() {
    let (offset, rate) = (0.1, 1e-3);
    let parameters = Parameters::none()
        .with(Parameter::TimeOffset, Prior::constant(offset))
        .with(Parameter::ClockRate, Prior::constant(rate));
    let speed = Vector3::new(20.0, 0.0, 0.0);
    let start = NavState {
        time: 100.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: speed,
        q_nb: from_rpy(&Vector3::zeros()),
    };
    let std = InitialStd {
        position: Vector3::repeat(1.0),
        velocity: Vector3::repeat(0.1),
        attitude: Vector3::repeat(0.01),
    };
    let white = ShapingFilter::white(1e-4, STEP).unwrap();
    let mut filter = estimator::build(start, &std, &[white; 6], parameters).unwrap();
    let age = 5.0;
    for k in 1..=50 {
        filter.begin(&ImuSample {
            time: 100.0 + STEP * f64::from(k),
            dt: STEP,
            dtheta: Vector3::zeros(),
            dvel: Vector3::new(0.0, 0.0, -9.8) * STEP,
        });
        filter.advance(None);
    }
    let mut history = History::new().unwrap();
    history.push(&*filter, None).unwrap();
    // What comes later says that the offset is 0.02 s larger than believed, the rate 0.3e-3: P λ, nothing being correlated.
    let (later, faster) = (0.02, 0.3e-3);
    let mut gradient = DVector::zeros(11);
    gradient[9] = later / (offset * offset);
    gradient[10] = faster / (rate * rate);
    let since = Adjoint {
        transition: DMatrix::identity(11, 11),
        gradient,
        information: DMatrix::zeros(11, 11),
    };
    history.push(&*filter, Some(&since)).unwrap();
    let smoothed = history.smooth().unwrap().unwrap();
    let (antenna, velocity) = smoothed.antenna(&smoothed.nodes[0], &Vector3::zeros());
    let ahead = smoothed.nodes[0].nav.position.offset_to(&antenna);
    let expected = velocity * (later + faster * age);
    // Rounding of a place on the Earth.
    assert!((ahead - expected).norm() < 1e-8, "{ahead} {expected}");
    assert!((expected.x - 20.0 * 0.0215).abs() < 0.01);
}
