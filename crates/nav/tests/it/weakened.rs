//! What an update says of its measurement's covariance, and what a gate does with that.

use undrift_nav::{
    Matrix3, Vector3,
    attitude::from_rpy,
    covariance::AXES,
    earth::Geodetic,
    filter::{Filter, Gate, InitialStd, Outcome},
    mechanisation::NavState,
    parameters::Parameters,
    sample::Position,
    shaping::ShapingFilter,
};

/// Variance of each component of the position, and of the fixes [m²].
const OWN: f64 = 4.0;
const FIX: f64 = 5.0;

fn filter() -> Filter<9> {
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: Vector3::zeros(),
        q_nb: from_rpy(&Vector3::zeros()),
    };
    let std = InitialStd {
        position: Vector3::repeat(OWN.sqrt()),
        velocity: Vector3::repeat(0.1),
        attitude: Vector3::repeat(0.01),
    };
    let white = ShapingFilter::white(1e-4, 0.01).unwrap();
    Filter::new(nav, &std, [white; AXES], Parameters::none()).unwrap()
}

/// Updates with a fix so far north \[m\] of the solution: the outcome, how far the solution went along, and its variance.
fn shown(north: f64, gate: &Gate, factor: f64) -> (Outcome, f64, f64) {
    let mut filter = filter();
    let start = filter.nav().position;
    let fix = Position::Geodetic(start.displaced(&Vector3::new(north, 0.0, 0.0)));
    let observed = filter.observe_position(&fix, &Vector3::zeros());
    let r = Matrix3::identity() * FIX * factor;
    let update = filter.update(&observed, &r, gate).unwrap();
    let moved = start.offset_to(&filter.nav().position).x;
    (update.outcome, moved, filter.covariance()[(0, 0)])
}

#[test]
fn beyond_the_limit_a_measurement_counts_as_much_less_as_it_is_beyond() {
    let gate = Gate {
        weaken: 9.0,
        reject: 100.0,
    };
    // NIS is north² / (OWN + FIX): 4 and 16 standard deviations squared of 3 m.
    let (used, moved, variance) = shown(6.0, &gate, 1.0);
    assert_eq!(used, Outcome::Used);
    // P (P + R)⁻¹ of the innovation; the Earth is round by 1e-6 m over ten metres.
    assert!((moved - 6.0 * OWN / (OWN + FIX)).abs() < 1e-6, "{moved}");
    assert!((variance - OWN * FIX / (OWN + FIX)).abs() < 1e-12);

    let (outcome, moved, variance) = shown(12.0, &gate, 1.0);
    let Outcome::Weakened(factor) = outcome else {
        panic!("{outcome:?}");
    };
    // Huber's weight: the limit over the square, here 9 over 16.
    assert!((factor - 16.0 / 9.0).abs() < 1e-6, "{factor}");
    let r = FIX * factor;
    assert!((moved - 12.0 * OWN / (OWN + r)).abs() < 1e-6, "{moved}");
    assert!((variance - OWN * r / (OWN + r)).abs() < 1e-12);
    // As a fix that states so much.
    assert_eq!((moved, variance), {
        let (outcome, moved, variance) = shown(12.0, &Gate::OPEN, factor);
        assert_eq!(outcome, Outcome::Used);
        (moved, variance)
    });

    // 33 m: NIS 121.
    assert_eq!(shown(33.0, &gate, 1.0), (Outcome::Rejected, 0.0, OWN));
}

/// The score is the derivative of the log-likelihood `−½ (log det S + νᵀ S⁻¹ ν)` by the logarithm of a factor on R.
#[test]
fn the_score_is_the_derivative_of_the_likelihood() {
    let filter = filter();
    let off = Vector3::new(4.0, -3.0, 1.0);
    let fix = Position::Geodetic(filter.nav().position.displaced(&off));
    let observed = filter.observe_position(&fix, &Vector3::zeros());
    let r = Matrix3::new(5.0, 1.0, 0.0, 1.0, 7.0, 2.0, 0.0, 2.0, 9.0);
    let done = filter.clone().update(&observed, &r, &Gate::OPEN);
    let done = done.unwrap();
    let s = |log: f64| Matrix3::identity() * OWN + r * log.exp();
    let nu = observed.innovation;
    let likelihood = |log: f64| {
        let s = s(log);
        -0.5 * (s.determinant().ln() + nu.dot(&(s.try_inverse().unwrap() * nu)))
    };
    let d = 1e-3;
    let slope = (likelihood(d) - likelihood(-d)) / (2.0 * d);
    // Third derivatives times d²/6.
    assert!((done.score - slope).abs() < 1e-6, "{} {slope}", done.score);
    // Fisher's: minus the expected second derivative.
    let share = s(0.0).try_inverse().unwrap() * r;
    let expected = 0.5 * (share * share).trace();
    assert!((done.information - expected).abs() < 1e-12);
    let whitened = Vector3::from(done.whitened).norm_squared();
    assert!((done.nis - whitened).abs() < 1e-12);
}
