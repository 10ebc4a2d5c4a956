//! Minimisation of a smooth function of a few logarithms: BFGS with central differences, its first
//! metric from the second differences that these give for nothing. Nocedal & Wright 2006, chapter 6.

use crate::quasi_newton::{backtrack, diagonal, product, update};
use nalgebra::DMatrix;

/// Difference step. Functions are log-likelihoods of logarithms, with curvatures 0.1 to 1e6.
const STEP: f64 = 1e-3;
/// Longest move of one iteration in a coordinate.
const LONGEST: f64 = 1.5;

/// Where a search ended.
#[derive(Clone, Debug)]
pub(crate) struct Minimum {
    pub(crate) z: Vec<f64>,
    pub(crate) value: f64,
    /// The decrease predicted to be left is below the tolerance.
    pub(crate) converged: bool,
}

/// Gradient and curvature along each coordinate; a direction into an invalid region counts as flat.
fn differences(f: &mut dyn FnMut(&[f64]) -> f64, z: &[f64], value: f64) -> (Vec<f64>, Vec<f64>) {
    let mut moved = z.to_vec();
    let (mut gradient, mut curvature) = (vec![0.0; z.len()], vec![0.0; z.len()]);
    for i in 0..z.len() {
        moved[i] = z[i] + STEP;
        let above = f(&moved);
        moved[i] = z[i] - STEP;
        let below = f(&moved);
        moved[i] = z[i];
        if above.is_finite() && below.is_finite() {
            gradient[i] = (above - below) / (2.0 * STEP);
            curvature[i] = (above + below - 2.0 * value) / (STEP * STEP);
        }
    }
    (gradient, curvature)
}

/// Diagonal inverse metric.
fn metric(curvature: &[f64]) -> Vec<f64> {
    let scales: Vec<f64> = curvature.iter().map(|c| 1.0 / c.abs().max(0.1)).collect();
    diagonal(&scales)
}

/// Minimises `f` from `start` until the decrease to expect is below `tolerance`.
pub(crate) fn minimise(
    f: &mut dyn FnMut(&[f64]) -> f64,
    start: &[f64],
    tolerance: f64,
    iterations: usize,
) -> Minimum {
    let n = start.len();
    let mut z = start.to_vec();
    let mut value = f(&z);
    let mut end = Minimum {
        z: z.clone(),
        value,
        converged: n == 0,
    };
    if n == 0 || !value.is_finite() {
        return end;
    }
    let (mut gradient, curvature) = differences(f, &z, value);
    let mut inverse = metric(&curvature);
    let mut fresh = true;
    for _ in 0..iterations {
        let mut direction: Vec<f64> = product(&inverse, &gradient).iter().map(|d| -d).collect();
        let longest = direction.iter().fold(0.0f64, |m, d| m.max(d.abs()));
        if longest > LONGEST {
            direction.iter_mut().for_each(|d| *d *= LONGEST / longest);
        }
        let slope: f64 = direction.iter().zip(&gradient).map(|(d, g)| d * g).sum();
        end.converged = -0.5 * slope < tolerance;
        if end.converged {
            break;
        }
        let mut next = z.clone();
        let at = |t: f64| {
            for i in 0..n {
                next[i] = z[i] + t * direction[i];
            }
            f(&next)
        };
        let next_value = backtrack(at, value, slope, 1.0);
        if next_value.is_nan() || next_value >= value {
            if fresh {
                break;
            }
            let (g, c) = differences(f, &z, value);
            (gradient, inverse, fresh) = (g, metric(&c), true);
            continue;
        }
        let (new_gradient, _) = differences(f, &next, next_value);
        let s: Vec<f64> = next.iter().zip(&z).map(|(a, b)| a - b).collect();
        let changed = new_gradient.iter().zip(&gradient);
        let y: Vec<f64> = changed.map(|(a, b)| a - b).collect();
        update(&mut inverse, &s, &y, false);
        (z, value, gradient, fresh) = (next, next_value, new_gradient, false);
    }
    end.z = z;
    end.value = value;
    end
}

/// Covariance at a minimum of a negative log-likelihood, row-major: the inverse of its second
/// differences, with steps that raise the function by about a tenth. None where it is not curved
/// upwards in every direction.
pub(crate) fn covariance(f: &mut dyn FnMut(&[f64]) -> f64, least: &Minimum) -> Option<Vec<f64>> {
    let (z, value) = (&least.z, least.value);
    let n = z.len();
    let (_, curvature) = differences(f, z, value);
    let steps: Vec<f64> = curvature
        .iter()
        .map(|c| (0.2 / c.max(1e-9)).sqrt().min(0.3))
        .collect();
    let mut hessian = DMatrix::zeros(n, n);
    let mut moved = z.clone();
    for i in 0..n {
        for j in 0..=i {
            let mut corner = |a: f64, b: f64| {
                moved.copy_from_slice(z);
                moved[i] += a * steps[i];
                moved[j] += b * steps[j];
                f(&moved)
            };
            let second = if i == j {
                (corner(1.0, 0.0) - 2.0 * value + corner(-1.0, 0.0)) / (steps[i] * steps[i])
            } else {
                (corner(1.0, 1.0) - corner(1.0, -1.0) - corner(-1.0, 1.0) + corner(-1.0, -1.0))
                    / (4.0 * steps[i] * steps[j])
            };
            if !second.is_finite() {
                return None;
            }
            hessian[(i, j)] = second;
            hessian[(j, i)] = second;
        }
    }
    let inverse = hessian.cholesky()?.inverse();
    Some(inverse.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curved_valley_and_its_covariance() {
        let mut rosenbrock =
            |z: &[f64]| (1.0 - z[0]).powi(2) + 100.0 * (z[1] - z[0] * z[0]).powi(2);
        let least = minimise(&mut rosenbrock, &[-1.2, 1.0], 1e-9, 200);
        assert!(least.converged && least.value < 1e-7, "{least:?}");
        let mut quadratic = |z: &[f64]| 2.0 * z[0] * z[0] + z[0] * z[1] + 50.0 * z[1] * z[1];
        let least = minimise(&mut quadratic, &[1.0, -1.0], 1e-12, 50);
        // Inverse of [[4, 1], [1, 100]].
        let found = covariance(&mut quadratic, &least).unwrap();
        for (ours, exact) in found.iter().zip([100.0, -1.0, -1.0, 4.0]) {
            assert!((ours - exact / 399.0).abs() < 1e-8, "{found:?}");
        }
    }

    #[test]
    fn walls_are_kept_away_from() {
        let mut walled = |z: &[f64]| {
            if z[0] < 0.5 {
                f64::INFINITY
            } else {
                z[0] * z[0]
            }
        };
        let least = minimise(&mut walled, &[2.0], 1e-9, 100);
        assert!(least.value.is_finite() && least.z[0] >= 0.5 && least.z[0] < 0.6);
    }
}
