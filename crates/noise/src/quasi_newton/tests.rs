use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// A Hessian with eigenvalues from 0.2, and a gradient at zero.
fn quadratic() -> impl Strategy<Value = (DMatrix<f64>, DVector<f64>)> {
    (1usize..6).prop_flat_map(|n| {
        let number = || -1.0..1.0f64;
        let hessian = prop::collection::vec(number(), n * n).prop_map(move |root| {
            let root = DMatrix::from_row_slice(n, n, &root);
            &root * root.transpose() + 0.2 * DMatrix::identity(n, n)
        });
        (
            hessian,
            prop::collection::vec(number(), n).prop_map(DVector::from_vec),
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig {
        rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..ProptestConfig::default()
    })]

    /// Nocedal & Wright 2006, theorem 6.4: with exact line searches, n steps to the minimum of a
    /// quadratic of n variables, and then the inverse Hessian is known.
    #[test]
    fn a_quadratic_is_done_in_as_many_steps_as_it_has_variables((hessian, start) in quadratic()) {
        let n = start.len();
        let mut inverse = DMatrix::identity(n, n);
        let mut gradient = start.clone();
        let mut steps = 0;
        while gradient.norm() > 1e-10 && steps < n {
            let direction = -(&inverse * &gradient);
            let turned = &hessian * &direction;
            let slope = gradient.dot(&direction);
            prop_assert!(slope < 0.0);
            let t = -slope / direction.dot(&turned);
            let (s, y) = (t * direction, t * turned);
            update(&mut inverse, &s, &y, false);
            // The secant condition.
            prop_assert!((&inverse * &y - &s).amax() < 1e-9 * s.norm().max(1e-3), "{inverse}");
            gradient += y;
            steps += 1;
        }
        // Rounding over the least eigenvalue, a few steps long.
        prop_assert!(gradient.norm() < 1e-8, "{gradient}");
        if steps == n {
            prop_assert!((&inverse * &hessian - DMatrix::identity(n, n)).amax() < 1e-6, "{inverse}");
        }
    }

    #[test]
    fn backtracking_ends_lower((hessian, start) in quadratic(), longest in 0.1..100.0f64) {
        let (slope, turned) = (-start.norm_squared(), start.dot(&(&hessian * &start)));
        prop_assume!(slope < -1e-12);
        let mut last = 0.0;
        let found = backtrack(
            |t| {
                last = t;
                7.0 + slope * t + 0.5 * turned * t * t
            },
            7.0,
            slope,
            longest,
        );
        prop_assert!(last > 0.0 && last <= longest);
        prop_assert!(found <= 7.0 + SUFFICIENT * last * slope, "{found} at {last}");
    }
}

const FORWARD: Scales = Scales {
    step: 1e-3,
    longest: 0.5,
    edge: 10.0,
    curved: false,
};
const CURVED: Scales = Scales {
    curved: true,
    ..FORWARD
};

/// 5 + 2 (x − 1)² + ½ (y + 2)² + 3 (x − 1)(y + 2): slopes and curvatures by hand.
fn bowl(z: &[f64]) -> f64 {
    let (x, y) = (z[0] - 1.0, z[1] + 2.0);
    5.0 + 2.0 * x * x + 0.5 * y * y + 3.0 * x * y
}

fn each(of: impl Fn(&[f64]) -> f64) -> impl Fn(&[Vec<f64>]) -> Vec<f64> {
    move |points| points.iter().map(|z| of(z)).collect()
}

#[test]
fn central_differences_of_a_quadratic_are_exact_and_forward_ones_half_a_step_off() {
    let objective = each(bowl);
    let step = 0.25;
    let z = [0.5, -1.0];
    // x − 1 = −0.5, y + 2 = 1: 4 · −0.5 + 3 and 1 − 1.5.
    let exact = [1.0, -0.5];
    let mut central = Objective::new(&objective, Scales { step, ..CURVED });
    let (gradient, metric) = central.differences(&z, bowl(&z), true);
    assert_eq!(central.evaluations, 4);
    assert_eq!(gradient.as_slice(), exact);
    // One over the curvatures 4 and 1.
    assert_eq!(
        metric,
        DMatrix::from_row_slice(2, 2, &[0.25, 0.0, 0.0, 1.0])
    );
    let mut forward = Objective::new(&objective, Scales { step, ..FORWARD });
    let (gradient, metric) = forward.differences(&z, bowl(&z), false);
    assert_eq!(forward.evaluations, 2);
    assert_eq!(gradient.as_slice(), [exact[0] + 0.5, exact[1] + 0.125]);
    assert_eq!(metric, DMatrix::identity(2, 2));
    let (gradient, metric) = forward.differences(&z, bowl(&z), true);
    assert_eq!(gradient.as_slice(), exact);
    assert_eq!(metric, DMatrix::identity(2, 2));
}

#[test]
fn the_first_metric_takes_a_curvature_without_its_sign_and_a_tenth_at_least() {
    let objective = each(|z: &[f64]| -z[0] * z[0] + 0.01 * z[1] * z[1]);
    let mut objective = Objective::new(&objective, CURVED);
    let (_, metric) = objective.differences(&[0.0, 0.0], 0.0, true);
    assert!((metric[(0, 0)] - 0.5).abs() < 1e-9, "{metric}");
    assert_eq!(metric[(1, 1)], 10.0);
}

#[test]
fn a_direction_into_an_invalid_region_counts_as_flat() {
    let objective = each(|z: &[f64]| if z[0] > 0.0 { f64::NAN } else { 3.0 * z[1] });
    let mut objective = Objective::new(&objective, CURVED);
    let (gradient, metric) = objective.differences(&[0.0, 0.0], 0.0, true);
    assert_eq!(gradient[0], 0.0);
    assert!((gradient[1] - 3.0).abs() < 1e-9);
    assert_eq!(metric[(0, 0)], 10.0);
    // Not a number is the worst that can be.
    assert_eq!(objective.at(&[1.0, 0.0]), f64::INFINITY);
    assert_eq!(objective.evaluations, 5);
    let points = objective.points(vec![vec![-1.0, 2.0], vec![1.0, 1.0]]);
    assert_eq!(objective.evaluations, 7);
    assert_eq!((&points[0].z[..], points[0].value), (&[-1.0, 2.0][..], 6.0));
    assert_eq!(points[1].value, f64::INFINITY);
    assert!(
        points
            .iter()
            .all(|point| !point.converged && point.inverse.is_none())
    );
}

#[test]
fn a_gradient_that_is_known_is_taken_and_differences_where_it_is_not() {
    let objective = each(bowl);
    let known = |z: &[f64]| (z[0] < 1.0).then(|| vec![7.0, 8.0]);
    let mut objective = Objective::new(&objective, FORWARD).with_gradient(&known);
    let here = [0.5, -1.0];
    assert_eq!(
        objective.gradient(&here, bowl(&here), true).as_slice(),
        [7.0, 8.0]
    );
    assert_eq!(objective.evaluations, 0);
    let there = [2.0, -1.0];
    let found = objective.gradient(&there, bowl(&there), true);
    assert!((found - DVector::from_vec(vec![7.0, 4.0])).amax() < 1e-9);
    assert_eq!(objective.evaluations, 4);
}

#[test]
fn second_differences_of_a_quadratic_are_its_hessian_at_any_step() {
    let objective =
        each(|z: &[f64]| bowl(z) + 1.5 * z[2] * z[2] - 0.5 * z[0] * z[2] + 2.0 * z[1] * z[2]);
    let exact = [4.0, 3.0, -0.5, 3.0, 1.0, 2.0, -0.5, 2.0, 3.0];
    let (z, steps) = ([0.5, -1.0, 0.25], [0.5, 0.25, 2.0]);
    let mut objective = Objective::new(&objective, FORWARD);
    let value = objective.at(&z);
    let beside: Vec<[f64; 2]> = (0..3)
        .map(|i| [1.0, -1.0].map(|sign| objective.at(&moved(&z, i, sign * steps[i]))))
        .collect();
    let before = objective.evaluations;
    let found = objective
        .second_differences(&z, value, &steps, &beside)
        .unwrap();
    assert_eq!(objective.evaluations - before, 6);
    assert_eq!(found, DMatrix::from_row_slice(3, 3, &exact));
    let invalid = [[f64::INFINITY, 1.0], beside[1], beside[2]];
    assert!(
        objective
            .second_differences(&z, value, &steps, &invalid)
            .is_none()
    );
}

#[test]
fn a_line_goes_a_share_of_its_direction_and_stays_within_the_edges() {
    let objective = each(|z: &[f64]| z[0] + z[1]);
    let mut objective = Objective::new(&objective, FORWARD);
    let here = Point::new(vec![1.0, 9.0], 10.0);
    let line = |objective: &mut Objective, direction: [f64; 2], share| {
        objective.line(&here, &DVector::from(direction.to_vec()), -1.0, share)
    };
    assert_eq!(
        line(&mut objective, [-4.0, 2.0], 0.25),
        (vec![0.0, 9.5], 9.5)
    );
    assert_eq!(
        line(&mut objective, [-40.0, 2.0], 1.0),
        (vec![-10.0, 10.0], 0.0)
    );
    // No coordinate moves by more than half.
    for (direction, share) in [([0.1, -2.0], 0.25), ([4.0, 1.0], 0.125), ([0.1, 0.2], 1.0)] {
        assert_eq!(objective.share(&DVector::from(direction.to_vec())), share);
    }
}

/// Fractions that are tried, and the value that is given back.
fn tries(longest: f64, slope: f64, of: impl Fn(f64) -> f64) -> (Vec<f64>, f64) {
    let mut tried = Vec::new();
    let at = |t| {
        tried.push(t);
        of(t)
    };
    let value = backtrack(at, 7.0, slope, longest);
    (tried, value)
}

#[test]
fn backtracking_goes_to_the_minimum_of_the_parabola_within_a_tenth_and_a_half() {
    let near = |found: &[f64], exact: &[f64]| {
        let off = found.iter().zip(exact).map(|(a, b)| (a / b - 1.0).abs());
        found.len() == exact.len() && off.fold(0.0, f64::max) < 1e-9
    };
    // Its minimum is at −slope / (2 · 5) = 0.2 of a unit.
    for longest in [0.5, 1.0, 1.5] {
        let (tried, value) = tries(longest, -2.0, |t| 7.0 - 2.0 * t + 5.0 * t * t);
        assert!(near(&tried, &[longest, 0.2]), "{tried:?}");
        assert!((value - 6.8).abs() < 1e-12);
    }
    // At 0.02: no less than a tenth at a time.
    let (tried, _) = tries(1.0, -2.0, |t| 7.0 - 2.0 * t + 50.0 * t * t);
    assert!(near(&tried, &[1.0, 0.1, 0.02]), "{tried:?}");
    // A cubic just too high at 1 has a parabola's minimum beyond the half.
    let (tried, _) = tries(2.0, -2.0, |t| 7.0 - 2.0 * t + 0.5 * t * t * t - 1e-5);
    assert!(near(&tried, &[2.0, 1.0]), "{tried:?}");
    // Invalid regions are left by a tenth each time, and given up after 25.
    let (tried, value) = tries(1.0, -2.0, |_| f64::INFINITY);
    assert_eq!((tried.len(), value), (25, f64::INFINITY));
    assert!(near(&tried[..3], &[1.0, 0.1, 0.01]), "{tried:?}");
    // Without a slope a fifth each time.
    let (tried, _) = tries(1.0, f64::NAN, |_| 1.0);
    assert!(near(&tried[..3], &[1.0, 0.2, 0.04]), "{tried:?}");
}

#[test]
fn a_step_is_taken_from_a_ten_thousandth_of_the_decrease_of_its_slope_on() {
    for (share, once) in [(1.1e-4, true), (0.9e-4, false)] {
        let (tried, value) = tries(0.5, -2.0, |t| 7.0 - 2.0 * t * share);
        assert_eq!(tried.len() == 1, once, "{tried:?}");
        assert!(!once || value == 7.0 - share);
    }
}

#[test]
fn an_update_scales_what_is_not_along_the_step_to_the_curvature_along_it() {
    let (s, y) = (
        DVector::from_vec(vec![1.0, 0.0]),
        DVector::from_vec(vec![2.0, 0.0]),
    );
    for (scale, beside) in [(true, 2.0), (false, 4.0)] {
        let mut inverse = 4.0 * DMatrix::identity(2, 2);
        update(&mut inverse, &s, &y, scale);
        // Along the step what makes y of s, one half; across it 4, or 4 · sᵀy / yᵀy.
        let exact = DMatrix::from_row_slice(2, 2, &[0.5, 0.0, 0.0, beside]);
        assert!((inverse - exact).amax() < 1e-12);
    }
}

#[test]
fn an_update_without_curvature_along_its_step_is_left_out() {
    // sᵀy against 1e-10 |s| |y| = 3e-10, |y| = 1.
    for (first, left_out) in [
        (0.9e-10, true),
        (1.1e-10, false),
        (-1.0, true),
        (f64::NAN, true),
    ] {
        let mut inverse = DMatrix::identity(2, 2);
        let s = DVector::from_vec(vec![3.0, 0.0]);
        update(&mut inverse, &s, &DVector::from_vec(vec![first, 1.0]), true);
        assert_eq!(inverse == DMatrix::identity(2, 2), left_out, "{first}");
    }
}

/// Every point that a search evaluates, and its end.
fn searched(
    scales: Scales,
    start: &Point,
    of: impl Fn(&[f64]) -> f64,
    gradient: Option<&Gradient>,
    limits: (f64, usize),
) -> (Vec<Vec<f64>>, Point) {
    let seen = std::cell::RefCell::new(Vec::new());
    let all = |points: &[Vec<f64>]| {
        seen.borrow_mut().extend(points.iter().cloned());
        points.iter().map(|z| of(z)).collect()
    };
    let mut objective = Objective::new(&all, scales);
    objective.gradient = gradient;
    let end = bfgs(&mut objective, start, limits.0, limits.1);
    assert_eq!(objective.evaluations, seen.borrow().len());
    (seen.into_inner(), end)
}

#[test]
fn with_its_inverse_hessian_a_quadratic_is_done_in_one_step() {
    // The Hessian 4, 1; 1, 2 about (0.2, −0.1).
    let function = |z: &[f64]| {
        let (x, y) = (z[0] - 0.2, z[1] + 0.1);
        2.0 * x * x + x * y + y * y
    };
    let inverse = DMatrix::from_row_slice(2, 2, &[2.0, -1.0, -1.0, 4.0]) / 7.0;
    let start = Point {
        inverse: Some(inverse.clone()),
        ..Point::new(vec![0.0, 0.0], function(&[0.0, 0.0]))
    };
    let (seen, end) = searched(CURVED, &start, function, None, (1e-12, 20));
    // Central differences, the step, and differences there.
    assert_eq!(seen.len(), 4 + 1 + 4);
    assert!(end.converged);
    assert!((end.z[0] - 0.2).abs() < 1e-9 && (end.z[1] + 0.1).abs() < 1e-9);
    assert!((end.inverse.unwrap() - &inverse).amax() < 1e-6);
    // A metric of another size is no start.
    let other = Point {
        inverse: Some(DMatrix::zeros(3, 3)),
        ..start.clone()
    };
    let plain = Point::new(start.z.clone(), start.value);
    let ends = [other, plain].map(|start| searched(CURVED, &start, function, None, (1e-12, 50)).0);
    assert_eq!(ends[0], ends[1]);
}

#[test]
fn a_search_with_forward_differences_begins_with_a_short_step() {
    let function = |z: &[f64]| 0.5 * (z[0] * z[0] + z[1] * z[1]);
    let start = Point::new(vec![3.0, 1.0], 5.0);
    let (seen, end) = searched(FORWARD, &start, function, None, (1e-10, 100));
    let near = |found: &[f64], exact: [f64; 2]| {
        (found[0] - exact[0]).abs() < 1e-9 && (found[1] - exact[1]).abs() < 1e-3
    };
    assert!(near(&seen[0], [3.001, 1.0]) && near(&seen[1], [3.0, 1.001]));
    // 0.3 in the longest coordinate, then the differences there.
    assert!(
        near(&seen[2], [2.7, 0.9]) && near(&seen[3], [2.701, 0.9]),
        "{seen:?}"
    );
    // As long as allowed once the curvature is known.
    assert!(near(&seen[5], [2.2, 0.9 - 0.5 / 3.0]), "{seen:?}");
    assert!(end.converged && end.z.iter().all(|x| x.abs() < 1e-5));
    assert!(end.value < 1e-10);
    // Six more steps, the last with central differences, which find no slope.
    assert!(seen.len() < 35, "{}", seen.len());
    // With the gradient known nothing else is evaluated than the steps.
    let known = |z: &[f64]| Some(z.to_vec());
    let (seen, end) = searched(FORWARD, &start, function, Some(&known), (1e-10, 100));
    assert!(near(&seen[0], [2.7, 0.9]) && near(&seen[1], [2.2, 2.2 / 3.0]));
    assert!(end.converged && seen.len() == 7, "{seen:?}");
    assert!((end.inverse.unwrap() - DMatrix::identity(2, 2)).amax() < 1e-9);
}

#[test]
fn a_search_along_a_gradient_that_is_wrong_is_given_up_at_the_third_step() {
    for (slope, tolerance, converged) in [(3.0, 1e-8, false), (3.0, 0.46, true), (3.0, 0.44, false)]
    {
        let wrong = |z: &[f64]| Some(vec![-slope * z[0].signum()]);
        let start = Point::new(vec![1.0], slope);
        let function = |z: &[f64]| slope * z[0].abs();
        let (seen, end) = searched(FORWARD, &start, function, Some(&wrong), (tolerance, 100));
        // Predicted is half of the squared slope, 4.5: ten times the tolerance or not.
        assert_eq!(
            (seen.len(), end.converged),
            (3 * TRIES, converged),
            "{tolerance}"
        );
        assert_eq!((end.z, end.value), (vec![1.0], slope));
        // With a metric of the first differences there is nothing to begin again with.
        let kinked = |z: &[f64]| if z[0] == 1.0 { 0.0 } else { 1.0 + z[0] };
        let start = Point::new(vec![1.0], 0.0);
        let (seen, end) = searched(CURVED, &start, kinked, None, (1e-8, 100));
        assert_eq!((seen.len(), end.converged), (2 + TRIES, false));
    }
}

#[test]
fn a_search_does_nothing_without_variables_a_value_or_an_iteration() {
    let function = |z: &[f64]| z.iter().map(|x| x * x).sum();
    let (seen, end) = searched(FORWARD, &Point::new(vec![], 1.0), function, None, (1e-8, 9));
    assert!(seen.is_empty() && end.converged);
    let infinite = Point::new(vec![1.0], f64::INFINITY);
    let (seen, end) = searched(FORWARD, &infinite, function, None, (1e-8, 9));
    assert!(seen.is_empty() && !end.converged);
    let (seen, end) = searched(
        FORWARD,
        &Point::new(vec![1.0], 1.0),
        function,
        None,
        (1e-8, 0),
    );
    assert!(seen.len() == 1 && !end.converged && end.inverse.is_none());
    let (_, end) = searched(
        FORWARD,
        &Point::new(vec![1.0], 1.0),
        function,
        None,
        (1e-8, 1),
    );
    assert!(!end.converged && end.inverse.is_some() && (end.z[0] - 0.7).abs() < 1e-9);
}

#[test]
fn the_metric_begins_again_where_it_points_uphill() {
    let function = |z: &[f64]| z[0] * z[0] + z[1] * z[1];
    let start = Point {
        inverse: Some(-DMatrix::identity(2, 2)),
        ..Point::new(vec![2.0, 1.0], 5.0)
    };
    let (seen, end) = searched(FORWARD, &start, function, None, (1e-10, 100));
    // Down the slope (4, 2), 0.3 in the longest coordinate.
    assert!(
        (seen[2][0] - 1.7).abs() < 1e-9 && (seen[2][1] - 0.85).abs() < 1e-3,
        "{seen:?}"
    );
    assert!(end.converged && end.value < 1e-10);
}

#[test]
fn a_curved_valley_is_gone_down_to_its_end() {
    let rosenbrock = |z: &[f64]| (1.0 - z[0]).powi(2) + 100.0 * (z[1] - z[0] * z[0]).powi(2);
    for (scales, most) in [(FORWARD, 400), (CURVED, 400)] {
        let start = Point::new(vec![-1.2, 1.0], rosenbrock(&[-1.2, 1.0]));
        let scales = Scales {
            step: 1e-5,
            ..scales
        };
        let (seen, end) = searched(scales, &start, rosenbrock, None, (1e-10, 200));
        assert!(end.converged && end.value < 1e-8, "{end:?}");
        assert!(
            (end.z[0] - 1.0).abs() < 1e-3 && seen.len() < most,
            "{}",
            seen.len()
        );
        // The Hessian there is 802, −400; −400, 200.
        let hessian = DMatrix::from_row_slice(2, 2, &[802.0, -400.0, -400.0, 200.0]);
        let product = end.inverse.unwrap() * hessian;
        assert!((product - DMatrix::identity(2, 2)).amax() < 0.3);
    }
}

#[test]
fn the_best_end_is_of_the_best_starts_alone() {
    // Minima 0 at −3 and −1 at 3.
    let objective = each(|z: &[f64]| {
        if z[0] < 0.0 {
            (z[0] + 3.0).powi(2)
        } else {
            (z[0] - 3.0).powi(2) - 1.0
        }
    });
    let best = |starts: &[f64], count| {
        let mut objective = Objective::new(&objective, FORWARD);
        let starts = starts.iter().map(|x| vec![*x]).collect();
        best_of(&mut objective, starts, count, 1e-10, 100)
    };
    // 1 at −2 is better than 3 at 5.
    let one = best(&[5.0, -2.0], 1).unwrap();
    assert!((one.z[0] + 3.0).abs() < 1e-5, "{one:?}");
    let two = best(&[5.0, -2.0], 2).unwrap();
    assert!((two.z[0] - 3.0).abs() < 1e-5 && (two.value + 1.0).abs() < 1e-9);
    assert!(best(&[f64::NAN], 3).is_none());
    assert!(best(&[-2.0, f64::NAN], 1).is_some());
}
