//! Minimisation of a smooth function of a few logarithms: BFGS with central differences, its first
//! metric from the second differences that these give for nothing. Nocedal & Wright 2006, chapter 6.

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
fn metric(curvature: &[f64]) -> DMatrix<f64> {
    let n = curvature.len();
    DMatrix::from_fn(n, n, |i, j| {
        if i == j {
            1.0 / curvature[i].abs().max(0.1)
        } else {
            0.0
        }
    })
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
        let mut direction: Vec<f64> = (0..n)
            .map(|i| -(0..n).map(|j| inverse[(i, j)] * gradient[j]).sum::<f64>())
            .collect();
        let longest = direction.iter().fold(0.0f64, |m, d| m.max(d.abs()));
        if longest > LONGEST {
            direction.iter_mut().for_each(|d| *d *= LONGEST / longest);
        }
        let slope: f64 = direction.iter().zip(&gradient).map(|(d, g)| d * g).sum();
        end.converged = -0.5 * slope < tolerance;
        if end.converged {
            break;
        }
        let mut t = 1.0;
        let mut next = z.clone();
        let mut next_value = f64::INFINITY;
        for _ in 0..20 {
            for i in 0..n {
                next[i] = z[i] + t * direction[i];
            }
            next_value = f(&next);
            if next_value <= value + 1e-4 * t * slope {
                break;
            }
            let guess = -slope * t * t / (2.0 * (next_value - value - slope * t));
            t = if guess.is_finite() {
                guess.clamp(0.1 * t, 0.5 * t)
            } else {
                0.25 * t
            };
        }
        if next_value.is_nan() || next_value >= value {
            if fresh {
                break;
            }
            let (g, c) = differences(f, &z, value);
            (gradient, inverse, fresh) = (g, metric(&c), true);
            continue;
        }
        let (new_gradient, _) = differences(f, &next, next_value);
        update(&mut inverse, &z, &next, &gradient, &new_gradient);
        (z, value, gradient, fresh) = (next, next_value, new_gradient, false);
    }
    end.z = z;
    end.value = value;
    end
}

/// BFGS update of the inverse metric, left out where the curvature is not positive.
fn update(inverse: &mut DMatrix<f64>, z: &[f64], next: &[f64], old: &[f64], new: &[f64]) {
    let n = z.len();
    let s: Vec<f64> = next.iter().zip(z).map(|(a, b)| a - b).collect();
    let y: Vec<f64> = new.iter().zip(old).map(|(a, b)| a - b).collect();
    let sy: f64 = s.iter().zip(&y).map(|(a, b)| a * b).sum();
    let size: f64 = s.iter().map(|v| v * v).sum::<f64>() * y.iter().map(|v| v * v).sum::<f64>();
    if sy.is_nan() || sy <= 1e-10 * size.sqrt() {
        return;
    }
    let hy: Vec<f64> = (0..n)
        .map(|i| (0..n).map(|j| inverse[(i, j)] * y[j]).sum())
        .collect();
    let yhy: f64 = y.iter().zip(&hy).map(|(a, b)| a * b).sum();
    for i in 0..n {
        for j in 0..n {
            inverse[(i, j)] +=
                (1.0 + yhy / sy) * s[i] * s[j] / sy - (hy[i] * s[j] + s[i] * hy[j]) / sy;
        }
    }
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
