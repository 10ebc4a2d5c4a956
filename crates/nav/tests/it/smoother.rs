//! The tape's smoother against Rauch, Tung and Striebel's, which inverts the predicted covariance.

use nalgebra::{SMatrix, SVector};
use undrift_nav::{
    Matrix3, Vector3,
    attitude::from_rpy,
    earth::Geodetic,
    filter::{Filter, Gate, InitialStd},
    mechanisation::NavState,
    parameters::{Parameter, Parameters, Prior},
    sample::{ImuSample, Position},
    shaping::ShapingFilter,
    tape::Tape,
};

/// Nine, one Gauss-Markov state an axis, a slowly walking lever arm: noise in every state, so that the
/// predicted covariance has an inverse.
const N: usize = 18;
const DT: f64 = 0.1;

fn start() -> Filter<N> {
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
    let sensor = |white: f64, sigma: f64| {
        ShapingFilter::white(white, DT)
            .and_then(|w| w.plus(&ShapingFilter::gauss_markov(sigma, 20.0, DT)?))
            .unwrap()
    };
    let (gyro, accel) = (sensor(2e-3, 5e-3), sensor(2e-2, 0.1));
    let lever = Prior {
        std: 0.5,
        walk: 0.05,
        ..Prior::default()
    };
    let parameters = Parameters::none().with(Parameter::LeverArm, lever);
    Filter::new(
        nav,
        &std,
        [gyro, gyro, gyro, accel, accel, accel],
        parameters,
    )
    .unwrap()
}

type Square = SMatrix<f64, N, N>;
type State = SVector<f64, N>;

/// One span: the filter before and after its update, the transition up to the update, the correction
/// made by it, and the tape of it all.
struct Span {
    predicted: Square,
    updated: Square,
    transition: Square,
    /// Turn of the misalignment at the correction.
    reset: Square,
    correction: State,
    tape: Tape<N>,
}

fn run(spans: usize) -> (Square, Vec<Span>) {
    let mut filter = start();
    let first = *filter.covariance();
    let mut seen = Vec::new();
    for k in 0..spans {
        let (mut tape, mut plain) = (Tape::default(), Tape::default());
        let mut twin = filter.clone();
        for step in 0..5 {
            let time = (5 * k + step + 1) as f64 * DT;
            let rate = Vector3::new(0.1, -0.2, 0.3 * (0.4 * time).sin());
            let force = Vector3::new((0.3 * time).cos(), 0.5, -9.8);
            let sample = ImuSample {
                time,
                dt: DT,
                dtheta: rate * DT,
                dvel: force * DT,
            };
            filter.begin(&sample);
            // In two parts, as around a fix within a sample.
            filter.advance_recorded(0.3, &mut tape);
            filter.advance_recorded(1.0, &mut tape);
            twin.begin(&sample);
            twin.advance_recorded(0.3, &mut plain);
            twin.advance_recorded(1.0, &mut plain);
        }
        let predicted = *filter.covariance();
        let antenna = filter.nav().position.displaced(&Vector3::new(
            1.5 * (k as f64).sin(),
            -0.7,
            0.4 * (2.0 * k as f64).cos(),
        ));
        let observed = filter.observe_position(&Position::Geodetic(antenna), &Vector3::x());
        let r = Matrix3::identity();
        let before = *filter.nav();
        let states = *filter.estimates();
        filter
            .update_recorded(&observed, &r, &Gate::OPEN, &mut tape)
            .unwrap();
        let after = filter.nav();
        let psi = (after.q_nb * before.q_nb.inverse()).scaled_axis();
        let dr = -before.position.offset_to(&after.position);
        let dv = before.v_n - after.v_n;
        let correction = State::from_fn(|i, _| match i {
            0..3 => dr[i],
            3..6 => dv[i - 3],
            6..9 => psi[i - 6],
            _ => filter.estimates()[i] - states[i],
        });
        let mut reset = Square::identity();
        for j in 0..3 {
            let turned = psi.cross(&Vector3::ith(j, 0.5));
            for i in 0..3 {
                reset[(6 + i, 6 + j)] += turned[i];
            }
        }
        let t = plain.transition();
        seen.push(Span {
            predicted,
            updated: *filter.covariance(),
            transition: t,
            reset,
            correction,
            tape,
        });
    }
    (first, seen)
}

#[test]
fn the_tape_smooths_as_rauch_tung_and_striebel_do() {
    let (first, spans) = run(12);
    // The tape, from the end.
    let mut lambda = State::zeros();
    let mut information = Square::zeros();
    // RTS: smoothed error about the filter's corrected estimate, and its covariance.
    let mut smoothed = State::zeros();
    let mut covariance = spans[spans.len() - 1].updated;
    for k in (0..spans.len()).rev() {
        let span = &spans[k];
        let p = if k == 0 {
            &first
        } else {
            &spans[k - 1].updated
        };
        span.tape.back(&mut lambda, &mut information);
        let ours = p * lambda;
        let ours_covariance = p - p * information * p;

        // Before the correction: undo the turn, add what was taken out.
        let undo = span.reset.try_inverse().unwrap();
        let at_end = undo * smoothed + span.correction;
        let covariance_at_end = undo * covariance * undo.transpose();
        let gain = p * span.transition.transpose() * span.predicted.try_inverse().unwrap();
        smoothed = gain * at_end;
        covariance = p + gain * (covariance_at_end - span.predicted) * gain.transpose();

        for i in 0..N {
            let sigma = p[(i, i)].sqrt();
            // Rounding of an inverse with condition number about 1e8.
            assert!(
                (ours[i] - smoothed[i]).abs() < 1e-6 * sigma,
                "span {k} state {i}: {} {}",
                ours[i],
                smoothed[i]
            );
            for j in 0..N {
                let scale = sigma * p[(j, j)].sqrt();
                assert!(
                    (ours_covariance[(i, j)] - covariance[(i, j)]).abs() < 1e-6 * scale,
                    "span {k} {i} {j}"
                );
            }
        }
    }
    // It was worth something: the first position is better known than the filter knew it.
    assert!(covariance[(0, 0)] < 0.5 * first[(0, 0)]);
}
