//! The mechanisation alone, on exact increments of an analytic drive, returns the truth.

use undrift::{
    nav::{
        attitude::from_rpy,
        earth::wrap_pi,
        mechanisation::{Increments, NavState, RawIncrements},
    },
    simulate::{self, Trajectory},
};

/// Worst error of position [m] and of roll, pitch, yaw [deg] over a drive.
fn drift(trajectory: &Trajectory, rate_hz: f64) -> (f64, f64) {
    let walk = simulate::IdealImu::new(trajectory, rate_hz);
    let start = walk.state().truth();
    let mut state = NavState {
        time: 0.0,
        position: start.position,
        v_n: start.v_n.unwrap(),
        q_nb: from_rpy(&start.rpy.unwrap()),
    };
    let mut before: Option<RawIncrements> = None;
    let (mut position, mut angle) = (0.0f64, 0.0f64);
    for (sample, truth) in walk {
        let raw = RawIncrements {
            dt: sample.dt,
            dtheta: sample.dtheta,
            dvel: sample.dvel,
        };
        state.step(&Increments::from_raw(
            raw.dt,
            raw.dtheta,
            raw.dvel,
            before.as_ref(),
        ));
        before = Some(raw);
        position = position.max(truth.position.offset_to(&state.position).norm());
        let turned = undrift::nav::attitude::to_rpy(&state.q_nb) - truth.rpy.unwrap();
        angle = angle.max(turned.map(|a| wrap_pi(a).abs().to_degrees()).max());
    }
    (position, angle)
}

#[test]
fn ten_minutes_of_driving_at_200_hz() {
    for seed in 1..=3 {
        let (position, angle) = drift(&Trajectory::car(600.0, seed), 200.0);
        println!("car, seed {seed}: {position:.5} m, {angle:.2e} deg");
        // What the project promises of its mechanisation.
        assert!(position < 0.01, "seed {seed}: {position} m");
        assert!(angle < 1e-4, "seed {seed}: {angle} deg");
    }
}

#[test]
fn halving_the_interval_shrinks_the_error() {
    // The coning and sculling terms leave an error of fourth order in the interval a second; the
    // rest of the step is of second order or better: a factor of four at least.
    let (coarse, _) = drift(&Trajectory::car(300.0, 5), 50.0);
    let (fine, _) = drift(&Trajectory::car(300.0, 5), 100.0);
    println!("50 Hz {coarse:.4} m, 100 Hz {fine:.4} m");
    assert!(fine < coarse / 3.5, "{fine} {coarse}");
}
