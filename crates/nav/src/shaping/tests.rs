use super::*;
use libm::sqrt;
const T: f64 = 0.01;

#[test]
fn arma11_autocovariance_is_the_closed_form() {
    // Box, Jenkins & Reinsel eq. 3.4.7.
    let (phi, theta, sigma) = (0.9, 0.5, 2.0);
    let filter = ShapingFilter::arma(&[phi], &[theta], sigma, T).unwrap();
    let mut acov = [0.0; 4];
    filter.autocovariance(&mut acov);
    let g0 = (1.0 + theta * theta - 2.0 * phi * theta) / (1.0 - phi * phi) * sigma * sigma;
    let g1 = (1.0 - phi * theta) * (phi - theta) / (1.0 - phi * phi) * sigma * sigma;
    for (ours, exact) in acov.iter().zip([g0, g1, phi * g1, phi * phi * g1]) {
        assert!((ours - exact).abs() < 1e-12 * g0, "{ours} {exact}");
    }
}

#[test]
fn arma11_is_ar1_plus_white() {
    // docs/theory.md: driving variance S σ² and white variance W σ², S = (1−φθ)(φ−θ)/φ, W = θ/φ.
    let (phi, theta, sigma) = (0.999, 0.98, 0.3);
    let arma = ShapingFilter::arma(&[phi], &[theta], sigma, T).unwrap();
    let variance = (1.0 - phi * theta) * (phi - theta) / phi * sigma * sigma;
    let stationary = variance / (1.0 - phi * phi);
    let coloured = ShapingFilter::gauss_markov(sqrt(stationary), -T / libm::log(phi), T).unwrap();
    let white = ShapingFilter::white(sigma * sqrt(theta / phi * T), T).unwrap();
    let (mut a, mut b) = ([0.0; 50], [0.0; 50]);
    arma.autocovariance(&mut a);
    white.plus(&coloured).unwrap().autocovariance(&mut b);
    for (x, y) in a.iter().zip(b) {
        // 1−φ loses three digits of sixteen.
        assert!((x - y).abs() < 1e-12 * a[0], "{x} {y}");
    }
}

#[test]
fn ar2_stationary_variance_is_the_closed_form() {
    let (p1, p2) = (1.2, -0.5);
    let filter = ShapingFilter::ar(&[p1, p2], 1.0, T).unwrap();
    let mut acov = [0.0; 3];
    filter.autocovariance(&mut acov);
    let g0 = (1.0 - p2) / ((1.0 + p2) * ((1.0 - p2) * (1.0 - p2) - p1 * p1));
    assert!((acov[0] - g0).abs() < 1e-12 * g0);
    assert!((acov[1] - g0 * p1 / (1.0 - p2)).abs() < 1e-12 * g0);
}

#[test]
fn unit_root_starts_at_zero_with_its_stable_part_stationary() {
    let filter = ShapingFilter::arma(&[1.0], &[0.9994], 1.0, T).unwrap();
    assert_eq!(filter.p0[0][0], 0.0);
    // (1 − B)(1 − 0.5 B): the projected stable mode has pole 0.5.
    let filter = ShapingFilter::arma(&[1.5, -0.5], &[0.9], 1.0, T).unwrap();
    assert!(filter.p0[0][0] > 0.0 && filter.p0[0][0] < 10.0);
}

#[test]
fn instability_is_refused() {
    for phi in [
        &[1.000_001][..],
        &[-1.1],
        &[2.0, -1.0],
        &[0.0, 1.1],
        &[-1.0],
    ] {
        let made = ShapingFilter::arma(phi, &[0.3], 1.0, T);
        assert_eq!(made, Err(ShapingError::Unstable), "{phi:?}");
    }
    // Without noise nothing grows, and it is no more a model for that.
    let silent = ShapingFilter::arma(&[1.1], &[], 0.0, T);
    assert_eq!(silent, Err(ShapingError::Unstable));
    assert!(ShapingFilter::white(f64::NAN, T).is_err());
    assert!(ShapingFilter::white(-1.0, T).is_err());
    assert!(ShapingFilter::white(1.0, 0.0).is_err());
    assert!(ShapingFilter::arma(&[0.1; 7], &[], 1.0, T).is_err());
}

#[test]
fn constant_and_random_walk_share_a_state() {
    let sum = ShapingFilter::random_walk(2.0, T)
        .unwrap()
        .plus(&ShapingFilter::constant(3.0, T).unwrap())
        .unwrap();
    assert_eq!((sum.order, sum.p0[0][0], sum.q[0][0]), (1, 9.0, 4.0 * T));
}

#[test]
fn noise_factor_reproduces_the_moments() {
    let filter = ShapingFilter::arma(&[0.9, -0.2, 0.1], &[0.5, 0.1], 0.7, T).unwrap();
    let l = filter.noise_factor();
    let entry = |i: usize, j: usize| (0..=3).map(|k| l[i][k] * l[j][k]).sum::<f64>();
    assert!((entry(0, 0) - filter.r).abs() < 1e-15);
    for i in 0..3 {
        assert!((entry(i + 1, 0) - filter.s[i]).abs() < 1e-15);
        for j in 0..3 {
            assert!((entry(i + 1, j + 1) - filter.q[i][j]).abs() < 1e-15);
        }
    }
}
