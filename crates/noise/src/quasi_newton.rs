//! The pieces of a BFGS minimiser. Nocedal & Wright 2006, chapters 3 and 6. What metric it starts from
//! and which differences make its gradients is for each search to know: [`crate::arma`] evaluates
//! many points at once, [`crate::composite`] gets curvatures for nothing.

/// Longest backtracking.
const TRIES: usize = 25;
/// Sufficient decrease of the step that is taken, as a share of the slope's.
const SUFFICIENT: f64 = 1e-4;

/// Shortens the step along a direction of `slope` below zero until the function is sufficiently below
/// `value`, by quadratic interpolation kept within a tenth and a half; gives the last value tried.
/// `at` moves to a fraction of the direction and evaluates.
pub(crate) fn backtrack(
    mut at: impl FnMut(f64) -> f64,
    value: f64,
    slope: f64,
    longest: f64,
) -> f64 {
    let mut t = longest;
    let mut next = f64::INFINITY;
    for _ in 0..TRIES {
        next = at(t);
        if next <= value + SUFFICIENT * t * slope {
            break;
        }
        let guess = -slope * t * t / (2.0 * (next - value - slope * t));
        t = if guess.is_finite() {
            guess.clamp(0.1 * t, 0.5 * t)
        } else {
            0.2 * t
        };
    }
    next
}

/// BFGS update of an inverse Hessian, n × n, for a step `s` along which the gradient changed by `y`;
/// left out where the curvature is not positive. With `scale`, what is known so far is first scaled to
/// the curvature along the step (Nocedal & Wright, equation 6.20).
pub(crate) fn update(inverse: &mut [f64], s: &[f64], y: &[f64], scale: bool) {
    let n = s.len();
    let sy: f64 = s.iter().zip(y).map(|(a, b)| a * b).sum();
    let yy: f64 = y.iter().map(|v| v * v).sum();
    let ss: f64 = s.iter().map(|v| v * v).sum();
    if sy.is_nan() || sy <= 1e-10 * (ss * yy).sqrt() {
        return;
    }
    if scale {
        inverse.iter_mut().for_each(|v| *v *= sy / yy);
    }
    let hy = product(inverse, y);
    let yhy: f64 = y.iter().zip(&hy).map(|(a, b)| a * b).sum();
    for i in 0..n {
        for j in 0..n {
            inverse[i * n + j] +=
                (1.0 + yhy / sy) * s[i] * s[j] / sy - (hy[i] * s[j] + s[i] * hy[j]) / sy;
        }
    }
}

/// An n × n matrix times a vector.
pub(crate) fn product(matrix: &[f64], vector: &[f64]) -> Vec<f64> {
    matrix
        .chunks(vector.len().max(1))
        .map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum())
        .collect()
}

/// A diagonal n × n matrix.
pub(crate) fn diagonal(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let mut matrix = vec![0.0; n * n];
    for (k, value) in values.iter().enumerate() {
        matrix[k * n + k] = *value;
    }
    matrix
}
