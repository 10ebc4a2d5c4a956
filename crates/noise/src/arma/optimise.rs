//! Minimisation of a smooth function of a few variables: BFGS with numeric gradients, Nelder-Mead where it
//! sticks, Newton's steps at the end. Nocedal & Wright 2006, chapters 3, 6 and 8; Nelder & Mead 1965.

use super::linear::scaled_inverse;
use crate::quasi_newton::{backtrack, diagonal, product, update};

/// Difference step. The search coordinates have unit scale (standard errors 1e-3 to 10), so a
/// likelihood with 1e-9 of rounding still gives gradients to 1e-5.
const STEP: f64 = 1e-4;
/// Longest move of one iteration, per coordinate.
const LONGEST: f64 = 2.0;
/// Coordinates are kept within this: further out the partial autocorrelations no longer change.
pub(super) const EDGE: f64 = 14.0;

/// A point and its value.
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub(super) z: Vec<f64>,
    pub(super) value: f64,
    /// The predicted remaining decrease was below the tolerance.
    pub(super) converged: bool,
    /// Estimate of the inverse Hessian to go on with; empty where there is none.
    pub(super) inverse: Vec<f64>,
}

impl Point {
    /// A point nothing is known about but its value.
    pub(super) fn new(z: Vec<f64>, value: f64) -> Self {
        Self {
            z,
            value,
            converged: false,
            inverse: Vec::new(),
        }
    }
}

/// A function of several points at once, which is cheaper than one after the other. Counts
/// evaluations and turns NaN into +∞.
pub(super) struct Objective<'a> {
    function: &'a dyn Fn(&[Vec<f64>]) -> Vec<f64>,
    /// Evaluations so far.
    pub(super) evaluations: usize,
}

impl<'a> Objective<'a> {
    pub(super) fn new(function: &'a dyn Fn(&[Vec<f64>]) -> Vec<f64>) -> Self {
        Self {
            function,
            evaluations: 0,
        }
    }

    pub(super) fn at_all(&mut self, z: &[Vec<f64>]) -> Vec<f64> {
        self.evaluations += z.len();
        let mut values = (self.function)(z);
        for value in &mut values {
            if value.is_nan() {
                *value = f64::INFINITY;
            }
        }
        values
    }

    pub(super) fn at(&mut self, z: &[f64]) -> f64 {
        self.at_all(&[z.to_vec()])[0]
    }

    /// Points with their values.
    pub(super) fn points(&mut self, z: Vec<Vec<f64>>) -> Vec<Point> {
        let values = self.at_all(&z);
        z.into_iter()
            .zip(values)
            .map(|(z, value)| Point::new(z, value))
            .collect()
    }

    /// Gradient by forward differences, or central ones (twice the cost, for the last steps).
    fn gradient(&mut self, z: &[f64], value: f64, central: bool, out: &mut [f64]) {
        let n = z.len();
        let moved = |by: f64| {
            (0..n).map(move |i| {
                let mut moved = z.to_vec();
                moved[i] += by;
                moved
            })
        };
        let mut around: Vec<_> = moved(STEP).collect();
        if central {
            around.extend(moved(-STEP));
        }
        let values = self.at_all(&around);
        for i in 0..n {
            out[i] = if central {
                (values[i] - values[n + i]) / (2.0 * STEP)
            } else {
                (values[i] - value) / STEP
            };
            if !out[i].is_finite() {
                out[i] = 0.0;
            }
        }
    }
}

/// BFGS from `start` until the predicted decrease is below `tolerance` or `iterations` are spent.
pub(super) fn bfgs(
    objective: &mut Objective,
    start: &Point,
    tolerance: f64,
    iterations: usize,
) -> Point {
    let n = start.z.len();
    let mut z = start.z.clone();
    let mut value = start.value;
    let stop = |z: Vec<f64>, value, converged, inverse| Point {
        z,
        value,
        converged,
        inverse,
    };
    if n == 0 || !value.is_finite() {
        return stop(z, value, n == 0, Vec::new());
    }
    let mut gradient = vec![0.0; n];
    let mut central = false;
    objective.gradient(&z, value, central, &mut gradient);
    let mut fresh = start.inverse.len() != n * n;
    let mut inverse = if fresh {
        diagonal(&vec![1.0; n])
    } else {
        start.inverse.clone()
    };
    let mut refused = 0;
    for _ in 0..iterations {
        let mut direction: Vec<f64> = product(&inverse, &gradient).iter().map(|d| -d).collect();
        let mut slope: f64 = direction.iter().zip(&gradient).map(|(d, g)| d * g).sum();
        if slope.is_nan() || slope >= 0.0 {
            inverse = diagonal(&vec![1.0; n]);
            fresh = true;
            direction = gradient.iter().map(|g| -g).collect();
            slope = -gradient.iter().map(|g| g * g).sum::<f64>();
        }
        let longest = direction.iter().fold(0.0f64, |m, d| m.max(d.abs()));
        // Before anything is known of the curvature, a short first step.
        let cap = if fresh { 0.3 } else { LONGEST };
        let scale = if longest > cap { cap / longest } else { 1.0 };
        if -slope * 0.5 < tolerance && !fresh {
            if central {
                return stop(z, value, true, inverse);
            }
            central = true;
            objective.gradient(&z, value, central, &mut gradient);
            continue;
        }
        let mut next = z.clone();
        let at = |t: f64| {
            for i in 0..n {
                next[i] = (z[i] + t * direction[i]).clamp(-EDGE, EDGE);
            }
            objective.at(&next)
        };
        let next_value = backtrack(at, value, slope, scale);
        if next_value >= value {
            refused += 1;
            if refused > 2 {
                return stop(z, value, -slope * 0.5 < 10.0 * tolerance, Vec::new());
            }
            // Start again from the steepest descent with the better gradient.
            central = true;
            inverse = diagonal(&vec![1.0; n]);
            fresh = true;
            objective.gradient(&z, value, central, &mut gradient);
            continue;
        }
        if value - next_value < 1e-2 {
            central = true;
        }
        let old_gradient = gradient.clone();
        objective.gradient(&next, next_value, central, &mut gradient);
        let s: Vec<f64> = next.iter().zip(&z).map(|(a, b)| a - b).collect();
        let y: Vec<f64> = gradient
            .iter()
            .zip(&old_gradient)
            .map(|(a, b)| a - b)
            .collect();
        update(&mut inverse, &s, &y, fresh);
        fresh = false;
        z = next;
        value = next_value;
    }
    let inverse = if fresh { Vec::new() } else { inverse };
    stop(z, value, false, inverse)
}

/// Nelder-Mead from `start` with a simplex of the given size.
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
        inverse: Vec::new(),
    }
}

/// Newton's steps from where BFGS has ended, whose estimate of the curvature may miss what is left where
/// coordinates differ in it by orders of magnitude. Gives the inverse curvature at the end, or `None`
/// where it is not positive: the edge of the region, a direction that changes nothing.
pub(super) fn newton(
    objective: &mut Objective,
    best: &mut Point,
    tolerance: f64,
) -> Option<Vec<f64>> {
    const STEPS: usize = 5;
    let n = best.z.len();
    let mut gradient = vec![0.0; n];
    for _ in 0..STEPS {
        let curvature = hessian(objective, &best.z, best.value)?;
        let inverse = scaled_inverse(&curvature, n)?;
        objective.gradient(&best.z, best.value, true, &mut gradient);
        let direction = product(&inverse, &gradient);
        let slope: f64 = -(direction.iter().zip(&gradient).map(|(d, g)| d * g)).sum::<f64>();
        if -0.5 * slope < tolerance {
            best.converged = true;
            return Some(inverse);
        }
        let longest = direction.iter().fold(0.0f64, |m, d| m.max(d.abs()));
        let mut next = best.z.clone();
        let at = |t: f64| {
            for i in 0..n {
                next[i] = (best.z[i] - t * direction[i]).clamp(-EDGE, EDGE);
            }
            objective.at(&next)
        };
        let value = backtrack(at, best.value, slope, (LONGEST / longest).min(1.0));
        let gained = best.value - value;
        if gained > 0.0 {
            (best.z, best.value) = (next, value);
        }
        // Along a direction that is nearly flat the gradient is rounding: what the values say counts.
        if gained < tolerance {
            return Some(inverse);
        }
    }
    best.converged = false;
    scaled_inverse(&hessian(objective, &best.z, best.value)?, n)
}

/// Hessian by central second differences with steps that change the function by about `rise`, or
/// `None` where it is not finite.
fn hessian(objective: &mut Objective, z: &[f64], value: f64) -> Option<Vec<f64>> {
    let n = z.len();
    let mut steps = vec![0.0; n];
    for i in 0..n {
        // Steps that raise the function by 1e-3 to 1e-1: far above rounding, near the optimum.
        let mut h = 1e-2;
        for _ in 0..12 {
            let beside = [h, -h].map(|by| {
                let mut moved = z.to_vec();
                moved[i] += by;
                moved
            });
            let rise = 0.5
                * objective
                    .at_all(&beside)
                    .iter()
                    .map(|v| v - value)
                    .sum::<f64>();
            if rise > 0.1 {
                h *= 0.3;
            } else if rise < 1e-3 && h < 0.3 {
                h *= 2.5;
            } else {
                break;
            }
        }
        steps[i] = h;
    }
    // For each pair the points (+, +), (+, −), (−, +), (−, −); both moves add up where i = j.
    const SIGNS: [(f64, f64); 4] = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let pairs: Vec<_> = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).collect();
    let corners: Vec<_> = pairs
        .iter()
        .flat_map(|&(i, j)| {
            let steps = &steps;
            SIGNS.map(move |(a, b)| {
                let mut moved = z.to_vec();
                // (±1, ±1) on the diagonal: h and −h, and twice the point itself.
                let half = if i == j { 0.5 } else { 1.0 };
                moved[i] += half * a * steps[i];
                moved[j] += half * b * steps[j];
                moved
            })
        })
        .collect();
    let mut out = vec![0.0; n * n];
    for (&(i, j), v) in pairs.iter().zip(objective.at_all(&corners).chunks(4)) {
        let scale = if i == j { 1.0 } else { 4.0 };
        let curvature = (v[0] - v[1] - v[2] + v[3]) / (scale * steps[i] * steps[j]);
        if !curvature.is_finite() {
            return None;
        }
        out[i * n + j] = curvature;
        out[j * n + i] = curvature;
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rosenbrock(z: &[Vec<f64>]) -> Vec<f64> {
        let one = |z: &Vec<f64>| (1.0 - z[0]).powi(2) + 100.0 * (z[1] - z[0] * z[0]).powi(2);
        z.iter().map(one).collect()
    }

    fn start() -> Point {
        Point::new(vec![-1.2, 1.0], 24.2)
    }

    #[test]
    fn bfgs_reaches_the_bottom_of_a_curved_valley() {
        let mut objective = Objective::new(&rosenbrock);
        let found = bfgs(&mut objective, &start(), 1e-9, 200);
        assert!(found.converged && found.value < 1e-7, "{found:?}");
    }

    #[test]
    fn newton_goes_on_where_a_search_only_believes_to_be_done() {
        let mut objective = Objective::new(&rosenbrock);
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
        assert!(newton(&mut Objective::new(&flat), &mut point, 1e-9).is_none());
        assert_eq!((point.converged, point.value), (false, 1e-6));
    }

    #[test]
    fn nelder_mead_too() {
        let mut objective = Objective::new(&rosenbrock);
        let found = nelder_mead(&mut objective, &start(), 0.3, 1e-10, 1000);
        assert!(found.value < 1e-8, "{found:?}");
    }

    #[test]
    fn curvature_of_a_quadratic_is_its_matrix() {
        let one = |z: &Vec<f64>| 2.0 * z[0] * z[0] + z[0] * z[1] + 50.0 * z[1] * z[1];
        let quadratic = |z: &[Vec<f64>]| z.iter().map(one).collect();
        let mut objective = Objective::new(&quadratic);
        let found = hessian(&mut objective, &[0.0, 0.0], 0.0).unwrap();
        for (ours, exact) in found.iter().zip([4.0, 1.0, 1.0, 100.0]) {
            assert!((ours - exact).abs() < 1e-8);
        }
    }
}
