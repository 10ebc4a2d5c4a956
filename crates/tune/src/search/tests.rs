use super::*;
use std::cell::RefCell;

type Valued = fn(&DVector<f64>) -> (f64, DVector<f64>);

/// 2 x² + x y + y².
fn bowl(z: &DVector<f64>) -> (f64, DVector<f64>) {
    let (x, y) = (z[0], z[1]);
    let slope = vec![4.0 * x + y, x + 2.0 * y];
    (2.0 * x * x + x * y + y * y, DVector::from_vec(slope))
}

/// Half of the square.
fn square(z: &DVector<f64>) -> (f64, DVector<f64>) {
    (0.5 * z.norm_squared(), z.clone())
}

/// The end, and every point that is evaluated.
fn found(of: Valued, z: &[f64], first: DMatrix<f64>, most: usize) -> (Least, Vec<DVector<f64>>) {
    let seen = RefCell::new(Vec::new());
    let function = |z: &DVector<f64>| {
        seen.borrow_mut().push(z.clone());
        of(z)
    };
    let least = minimise(
        function,
        DVector::from_column_slice(z),
        &first,
        most,
        |_| true,
    );
    let seen = seen.into_inner();
    assert_eq!(least.evaluations, seen.len());
    (least, seen)
}

#[test]
fn with_its_inverse_hessian_a_quadratic_is_done_in_one_step() {
    let first = DMatrix::from_row_slice(2, 2, &[2.0, -1.0, -1.0, 4.0]) / 7.0;
    let (least, seen) = found(bowl, &[0.3, -0.2], first, 100);
    assert!(seen[1].amax() < 1e-12 && least.z.amax() < 1e-12 && least.value < 1e-20);
    // Two steps that gain nothing end it.
    assert!(least.converged && seen.len() == 4);
}

#[test]
fn a_move_is_no_longer_than_allowed_in_any_coordinate() {
    let (least, seen) = found(square, &[2.8, -1.4], DMatrix::identity(2, 2), 100);
    for (k, exact) in [2.8, 2.1, 1.4, 0.7].into_iter().enumerate() {
        assert!(
            (seen[k][0] - exact).abs() < 1e-9 && (seen[k][1] + 0.5 * exact).abs() < 1e-9,
            "{seen:?}"
        );
    }
    assert!(least.converged && least.z.amax() < 1e-9);
    assert!((least.inverse - DMatrix::identity(2, 2)).amax() < 1e-9);
}

#[test]
fn a_move_is_halved_until_it_gains_enough_of_what_the_slope_promises() {
    // Ten times the inverse Hessian: −0.5 from 0.05, that is to −0.45, −0.2, −0.075 and −0.0125.
    let (_, seen) = found(square, &[0.05], DMatrix::from_element(1, 1, 10.0), 5);
    let exact = [0.05, -0.45, -0.2, -0.075, -0.0125];
    assert!(
        seen.iter()
            .zip(exact)
            .all(|(z, exact)| (z[0] - exact).abs() < 1e-12),
        "{seen:?}"
    );
    // A straight line that falls by a little more or less than a ten-thousandth of what it says.
    for (share, more) in [(1.2e-4, 1), (0.8e-4, HALVINGS)] {
        let seen = RefCell::new(0);
        let function = |z: &DVector<f64>| {
            *seen.borrow_mut() += 1;
            (share * z[0], DVector::from_vec(vec![1.0]))
        };
        let start = DVector::from_vec(vec![0.0]);
        minimise(
            function,
            start,
            &DMatrix::from_element(1, 1, 0.5),
            2,
            |_| true,
        );
        assert_eq!(seen.into_inner(), 1 + more, "{share}");
    }
}

#[test]
fn a_search_uphill_is_given_up_after_a_second_try_with_a_tenth_of_the_metric() {
    let wrong = |z: &DVector<f64>| (0.5 * z.norm_squared(), -z);
    let (least, seen) = found(wrong, &[0.5], DMatrix::identity(1, 1), 100);
    assert!(least.converged && least.z[0] == 0.5);
    assert_eq!(seen.len(), 1 + 2 * HALVINGS);
    assert!((seen[1][0] - 1.0).abs() < 1e-12 && (seen[2][0] - 0.75).abs() < 1e-12);
    assert!((seen[1 + HALVINGS][0] - 0.55).abs() < 1e-12);
    // No metric that points uphill outlasts a step: that to begin with takes its place.
    let (least, seen) = found(square, &[0.5], DMatrix::from_element(1, 1, -1.0), 100);
    assert!((seen[1][0] - 1.0).abs() < 1e-12 && least.z[0] == 0.5);
}

#[test]
fn a_search_ends_with_its_evaluations_or_when_it_is_stopped() {
    let start = DVector::from_vec(vec![2.8, -1.4]);
    let mut seen = Vec::new();
    let goes_on = |value: f64| {
        seen.push(value);
        seen.len() < 3
    };
    let least = minimise(
        square,
        start.clone(),
        &DMatrix::identity(2, 2),
        100,
        goes_on,
    );
    assert!(!least.converged && least.evaluations == 3);
    assert_eq!(seen.len(), 3);
    assert!((seen[0] - 4.9).abs() < 1e-12 && seen[1] < seen[0] && seen[2] == least.value);
    let (least, _) = found(square, &[2.8, -1.4], DMatrix::identity(2, 2), 1);
    assert!(!least.converged && least.evaluations == 1 && least.z == start);
}

#[test]
fn a_curved_valley_is_gone_down_to_its_end() {
    let rosenbrock = |z: &DVector<f64>| {
        let (a, b) = (1.0 - z[0], z[1] - z[0] * z[0]);
        let slope = vec![-2.0 * a - 400.0 * z[0] * b, 200.0 * b];
        (a * a + 100.0 * b * b, DVector::from_vec(slope))
    };
    let (least, _) = found(rosenbrock, &[-0.5, 0.3], DMatrix::identity(2, 2), 400);
    assert!(least.converged && least.value < GAIN, "{}", least.value);
    // The Hessian there: 802, −400; −400, 200.
    let hessian = DMatrix::from_row_slice(2, 2, &[802.0, -400.0, -400.0, 200.0]);
    let across = DVector::from_vec(vec![-2.0, 1.0]);
    let stiff = (across.transpose() * &least.inverse * &across)[(0, 0)];
    let exact = (across.transpose() * hessian.try_inverse().unwrap() * &across)[(0, 0)];
    assert!((stiff / exact).ln().abs() < 1.0, "{stiff} {exact}");
}
