//! What the search for an ARMA adds to BFGS: Nelder-Mead where it sticks, Newton's steps at the end. Nocedal &
//! Wright 2006, chapters 3 and 8; Nelder & Mead 1965.
//!
//! Division of labour: BFGS ([`crate::quasi_newton`]) goes nearly all of the way; [`nelder_mead`]
//! needs no derivatives and leaves an edge where BFGS has stuck; [`newton`] ends a fit, since its
//! curvature is the observed information, whose inverse is the covariance of the estimates in
//! search coordinates.

use crate::quasi_newton::{Objective, Point, Scales, moved};
use nalgebra::DMatrix;

/// Coordinates are kept within this: further out the partial autocorrelations no longer change.
pub(super) const EDGE: f64 = 14.0;

/// The search coordinates have unit scale (standard errors 1e-3 to 10), so with this step a
/// likelihood with 1e-9 of rounding still gives gradients to 1e-5.
pub(super) const SCALES: Scales = Scales {
    step: 1e-4,
    longest: 2.0,
    edge: EDGE,
    curved: false,
};

/// Nelder-Mead from `start` with a simplex of the given size.
///
/// Reflection by 1, expansion by 2, contraction and shrinking by ½, as its authors have them. It ends where the
/// values of the simplex differ by less than `tolerance`, or after `evaluations`.
///
/// `size` is the length of the edges along each coordinate. Cost: one or two evaluations an
/// iteration, n + 1 to begin with and n more at a shrinking. The point returned is never worse than
/// `start`.
pub(super) fn nelder_mead(
    objective: &mut Objective,
    start: &Point,
    size: f64,
    tolerance: f64,
    evaluations: usize,
) -> Point {
    let n = start.z.len();
    let last = objective.evaluations + evaluations;
    let mut simplex = vec![(start.z.clone(), start.value)];
    for i in 0..n {
        let mut z = start.z.clone();
        z[i] += if z[i] > 0.0 { -size } else { size };
        let value = objective.at(&z);
        simplex.push((z, value));
    }
    while n > 0 && objective.evaluations < last {
        simplex.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (best, worst) = (simplex[0].1, simplex[n].1);
        if worst - best < tolerance {
            break;
        }
        let centre: Vec<f64> = (0..n)
            .map(|i| simplex[..n].iter().map(|v| v.0[i]).sum::<f64>() / n as f64)
            .collect();
        let along = |t: f64| -> Vec<f64> {
            (0..n)
                .map(|i| (centre[i] + t * (simplex[n].0[i] - centre[i])).clamp(-EDGE, EDGE))
                .collect()
        };
        let reflected = along(-1.0);
        let value = objective.at(&reflected);
        let replacement = if value < best {
            let expanded = along(-2.0);
            let further = objective.at(&expanded);
            if further < value {
                (expanded, further)
            } else {
                (reflected, value)
            }
        } else if value < simplex[n - 1].1 {
            (reflected, value)
        } else {
            let contracted = along(if value < worst { -0.5 } else { 0.5 });
            let inner = objective.at(&contracted);
            if inner < value.min(worst) {
                (contracted, inner)
            } else {
                for k in 1..=n {
                    for i in 0..n {
                        simplex[k].0[i] = 0.5 * (simplex[0].0[i] + simplex[k].0[i]);
                    }
                    simplex[k].1 = objective.at(&simplex[k].0);
                }
                continue;
            }
        };
        simplex[n] = replacement;
    }
    simplex.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (z, value) = simplex.swap_remove(0);
    Point {
        z,
        value,
        converged: start.converged,
        inverse: None,
    }
}

/// Newton's steps from where BFGS has ended, whose estimate of the curvature may miss what is left where
/// coordinates differ in it by orders of magnitude. Gives the inverse curvature at the end, or `None`
/// where it is not positive: the edge of the region, a direction that changes nothing.
///
/// At most five steps. `best.converged` is set where the predicted gain ½ gᵀH⁻¹g is below
/// `tolerance`, and cleared where five steps have not got there; a step that gains less than
/// `tolerance` ends it as well.
pub(super) fn newton(
    objective: &mut Objective,
    best: &mut Point,
    tolerance: f64,
) -> Option<DMatrix<f64>> {
    const STEPS: usize = 5;
    let mut known = best.inverse.take();
    for _ in 0..STEPS {
        let curvature = hessian(objective, &best.z, best.value, known.as_ref())?;
        let inverse = scaled_inverse(&curvature)?;
        let gradient = objective.gradient(&best.z, best.value, true);
        let direction = -(&inverse * &gradient);
        let slope = direction.dot(&gradient);
        if -0.5 * slope < tolerance {
            best.converged = true;
            return Some(inverse);
        }
        let (next, value) = objective.line(best, &direction, slope, objective.share(&direction));
        let gained = best.value - value;
        if gained > 0.0 {
            (best.z, best.value) = (next, value);
        }
        // Along a direction that is nearly flat the gradient is rounding: what the values say counts.
        if gained < tolerance {
            return Some(inverse);
        }
        known = Some(inverse);
    }
    best.converged = false;
    let curvature = hessian(objective, &best.z, best.value, known.as_ref())?;
    scaled_inverse(&curvature)
}

/// Inverse of a positive definite matrix scaled to unit diagonal first, `None` where it is
/// indefinite or singular to 1e-9.
///
/// Scaling makes the test of singularity independent of how coordinates are measured; the inverse
/// is multiplied back and compared with the identity to 1e-6 before it is trusted.
fn scaled_inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = matrix.nrows();
    let scale = matrix.diagonal().map(|value| value.max(0.0).sqrt());
    if scale.iter().any(|s| s.is_nan() || *s <= 1e-4) {
        return None;
    }
    let scales = &scale * scale.transpose();
    let unit = matrix.component_div(&scales);
    let inverse = unit.clone().cholesky()?.inverse();
    let off = &unit * &inverse - DMatrix::identity(n, n);
    let exact = off.iter().all(|value| value.abs() < 1e-6);
    let large = inverse.diagonal().iter().any(|value| *value > 1e9);
    (exact && !large).then(|| inverse.component_div(&scales))
}

/// Hessian by central second differences with steps that change the function by about 1e-2, or `None` where it is
/// not finite. `inverse`: what is known of its inverse.
///
/// Smaller steps see rounding, larger ones the third derivative; each coordinate gets its own.
///
/// 2 evaluations a coordinate and try, then n(n−1) for the mixed derivatives. A rise between 1e-3
/// and 1e-1 of the log-likelihood is the target: at 1e-9 of rounding that leaves six digits.
fn hessian(
    objective: &mut Objective,
    z: &[f64],
    value: f64,
    inverse: Option<&DMatrix<f64>>,
) -> Option<DMatrix<f64>> {
    let n = z.len();
    let known = inverse.filter(|inverse| inverse.nrows() == n);
    let (mut steps, mut beside) = (vec![0.0; n], vec![[value; 2]; n]);
    for i in 0..n {
        // Steps that raise the function by 1e-3 to 1e-1: far above rounding, near the optimum.
        let about = known.map_or(1e-2, |inverse| (2e-2 * inverse[(i, i)]).sqrt());
        let mut h = if about.is_finite() {
            about.clamp(1e-5, 0.3)
        } else {
            1e-2
        };
        for _ in 0..12 {
            steps[i] = h;
            let around = objective.at_all(&[h, -h].map(|by| moved(z, i, by)));
            beside[i] = [around[0], around[1]];
            let rise = 0.5 * around.iter().map(|v| v - value).sum::<f64>();
            if rise > 0.1 {
                h *= 0.3;
            } else if rise < 1e-3 && h < 0.3 {
                h *= 2.5;
            } else {
                break;
            }
        }
    }
    objective.second_differences(z, value, &steps, &beside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quasi_newton::bfgs;

    fn rosenbrock(z: &[Vec<f64>]) -> Vec<f64> {
        let one = |z: &Vec<f64>| (1.0 - z[0]).powi(2) + 100.0 * (z[1] - z[0] * z[0]).powi(2);
        z.iter().map(one).collect()
    }

    fn start() -> Point {
        Point::new(vec![-1.2, 1.0], 24.2)
    }

    #[test]
    fn bfgs_reaches_the_bottom_of_a_curved_valley() {
        let mut objective = Objective::new(&rosenbrock, SCALES);
        let found = bfgs(&mut objective, &start(), 1e-9, 200);
        assert!(found.converged && found.value < 1e-7, "{found:?}");
    }

    #[test]
    fn newton_goes_on_where_a_search_only_believes_to_be_done() {
        let mut objective = Objective::new(&rosenbrock, SCALES);
        // In the valley, 0.01 above its bottom, where the gradient is small across it.
        let mut point = Point::new(vec![0.9, 0.81], 0.01);
        point.converged = true;
        let inverse = newton(&mut objective, &mut point, 1e-9).unwrap();
        assert!(point.converged && point.value < 1e-9, "{point:?}");
        // [802, -400; -400, 200] inverted; steps that raise the function by 0.1 see its quartic term, 1 %.
        for (found, exact) in inverse.iter().zip([0.5, 1.0, 1.0, 2.005]) {
            assert!((found / exact - 1.0).abs() < 0.02, "{inverse:?}");
        }
        // No bottom along the second coordinate: nothing is claimed.
        let flat = |z: &[Vec<f64>]| z.iter().map(|z| z[0] * z[0]).collect();
        let mut point = Point::new(vec![1e-3, 0.0], 1e-6);
        assert!(newton(&mut Objective::new(&flat, SCALES), &mut point, 1e-9).is_none());
        assert_eq!((point.converged, point.value), (false, 1e-6));
    }

    #[test]
    fn nelder_mead_too() {
        let mut objective = Objective::new(&rosenbrock, SCALES);
        let found = nelder_mead(&mut objective, &start(), 0.3, 1e-10, 1000);
        assert!(found.value < 1e-8, "{found:?}");
    }

    #[test]
    fn curvature_of_a_quadratic_is_its_matrix() {
        let one = |z: &Vec<f64>| 2.0 * z[0] * z[0] + z[0] * z[1] + 50.0 * z[1] * z[1];
        let quadratic = |z: &[Vec<f64>]| z.iter().map(one).collect();
        let mut objective = Objective::new(&quadratic, SCALES);
        let found = hessian(&mut objective, &[0.0, 0.0], 0.0, None).unwrap();
        for (ours, exact) in found.iter().zip([4.0, 1.0, 1.0, 100.0]) {
            assert!((ours - exact).abs() < 1e-8);
        }
    }

    #[test]
    fn a_matrix_is_singular_where_its_inverse_scaled_exceeds_a_thousand_million() {
        // Unit diagonal and 1 − h beside it: the inverse is 1/(2h) and −1/(2h) but for h/2, in powers of two without rounding.
        let of = |h: f64| {
            let beside = 4.0 * (1.0 - h);
            scaled_inverse(&DMatrix::from_row_slice(2, 2, &[1.0, beside, beside, 16.0]))
        };
        let h = 2f64.powi(-29);
        let inverse = of(h).unwrap();
        for (found, exact) in inverse.iter().zip([1.0, -0.25, -0.25, 1.0 / 16.0]) {
            assert!((found * 2.0 * h / exact - 1.0).abs() < 1e-8, "{inverse}");
        }
        // 2³⁰.
        assert_eq!(of(2f64.powi(-31)), None);
        assert_eq!(of(0.0), None);
        assert_eq!(of(-0.1), None);
    }

    #[test]
    fn where_nothing_is_better_the_simplex_halves_towards_its_best() {
        let seen = std::cell::RefCell::new(Vec::new());
        let needle = |z: &[Vec<f64>]| {
            seen.borrow_mut().extend_from_slice(z);
            let one = |z: &Vec<f64>| f64::from(u8::from(*z != [2.0, -3.0]));
            z.iter().map(one).collect()
        };
        let mut objective = Objective::new(&needle, SCALES);
        let start = Point::new(vec![2.0, -3.0], 0.0);
        // The two other corners, a reflection, a contraction, and the two corners again.
        let found = nelder_mead(&mut objective, &start, 0.5, 1e-10, 5);
        assert_eq!((found.z, found.value), (vec![2.0, -3.0], 0.0));
        let seen = seen.borrow();
        assert_eq!(seen[..2], [[1.5, -3.0], [2.0, -2.5]]);
        assert_eq!(seen[4..], [[1.75, -3.0], [2.0, -2.75]]);
    }
}
