//! What an update says of itself, against the likelihood that it comes from.

use nalgebra::SMatrix;
use undrift_nav::{
    Matrix3, Vector3,
    aiding::Observation,
    attitude::from_rpy,
    covariance::AXES,
    earth::Geodetic,
    filter::{Filter, Gate, InitialStd},
    mechanisation::NavState,
    parameters::Parameters,
    shaping::ShapingFilter,
};

const N: usize = 9;

fn filter() -> Filter<N> {
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: Vector3::new(8.0, -3.0, 0.1),
        q_nb: from_rpy(&Vector3::new(0.02, -0.03, 1.0)),
    };
    let std = InitialStd {
        position: Vector3::new(1.5, 2.0, 3.0),
        velocity: Vector3::new(0.2, 0.3, 0.1),
        attitude: Vector3::new(0.01, 0.02, 0.05),
    };
    let sensor = ShapingFilter::white(1e-3, 0.01).unwrap();
    Filter::new(nav, &std, [sensor; AXES], Parameters::none()).unwrap()
}

/// The score is the slope of the log-likelihood `−½ (ln det S + νᵀ S⁻¹ ν)` over the logarithm of a factor on the
/// stated covariance alone, the information its expected curvature: by central differences.
#[test]
fn the_score_is_the_slope_of_the_log_likelihood_over_the_size_of_r() {
    let filter = filter();
    let r = Matrix3::new(2.0, 0.5, -0.3, 0.5, 1.0, 0.2, -0.3, 0.2, 4.0);
    let observed = Observation::<3, N> {
        innovation: Vector3::new(2.0, -1.0, 5.0),
        h: SMatrix::from_fn(|i, j| {
            if i == j {
                1.0
            } else {
                0.1 * (i as f64 - j as f64)
            }
        }),
        extra: Matrix3::from_diagonal(&Vector3::new(0.3, 0.2, 0.1)),
    };
    let covariance = |ln: f64| {
        observed.h * filter.covariance() * observed.h.transpose() + r * ln.exp() + observed.extra
    };
    let (z, right) = (observed.innovation, covariance(0.0));
    let found = filter.clone().update(&observed, &r, &Gate::OPEN).unwrap();
    let likelihood = |ln: f64| {
        let s = covariance(ln);
        -0.5 * (s.determinant().ln() + z.dot(&(s.try_inverse().unwrap() * z)))
    };
    // The mean of the same where the innovations have the covariance of no factor.
    let expected = |ln: f64| {
        let s = covariance(ln);
        -0.5 * (s.determinant().ln() + (s.try_inverse().unwrap() * right).trace())
    };
    // Differences of second order in steps of 1e-4: 1e-8, and rounding of 1e-15/1e-4, of the second difference over its square.
    let step = 1e-4;
    let slope = (likelihood(step) - likelihood(-step)) / (2.0 * step);
    assert!(
        (found.score - slope).abs() < 1e-7,
        "{} {slope}",
        found.score
    );
    let step = 1e-3;
    let curvature = (2.0 * expected(0.0) - expected(step) - expected(-step)) / (step * step);
    assert!(
        (found.information - curvature).abs() < 1e-6,
        "{} {curvature}",
        found.information
    );
}
