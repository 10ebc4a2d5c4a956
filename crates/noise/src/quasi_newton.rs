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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    fn dot(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    /// A Hessian with eigenvalues from 0.2, and a gradient at zero.
    fn quadratic() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
        (1usize..6).prop_flat_map(|n| {
            let number = || -1.0..1.0f64;
            let hessian = prop::collection::vec(number(), n * n).prop_map(move |root| {
                let row = |i: usize| &root[i * n..(i + 1) * n];
                let entry = |i, j| dot(row(i), row(j)) + 0.2 * f64::from(u8::from(i == j));
                (0..n * n).map(|k| entry(k / n, k % n)).collect()
            });
            (hessian, prop::collection::vec(number(), n))
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
            let mut inverse = diagonal(&vec![1.0; n]);
            let mut gradient = start.clone();
            let mut steps = 0;
            while dot(&gradient, &gradient).sqrt() > 1e-10 && steps < n {
                let direction: Vec<f64> = product(&inverse, &gradient).iter().map(|v| -v).collect();
                let turned = product(&hessian, &direction);
                let slope = dot(&gradient, &direction);
                prop_assert!(slope < 0.0);
                let t = -slope / dot(&direction, &turned);
                let s: Vec<f64> = direction.iter().map(|v| t * v).collect();
                let y: Vec<f64> = turned.iter().map(|v| t * v).collect();
                update(&mut inverse, &s, &y, false);
                // The secant condition.
                for (a, b) in product(&inverse, &y).iter().zip(&s) {
                    prop_assert!((a - b).abs() < 1e-9 * dot(&s, &s).sqrt().max(1e-3), "{a} {b}");
                }
                gradient.iter_mut().zip(&y).for_each(|(g, y)| *g += y);
                steps += 1;
            }
            // Rounding over the least eigenvalue, a few steps long.
            prop_assert!(dot(&gradient, &gradient).sqrt() < 1e-8, "{gradient:?}");
            if steps == n {
                for i in 0..n {
                    let column: Vec<f64> = (0..n).map(|k| hessian[k * n + i]).collect();
                    for (j, value) in product(&inverse, &column).iter().enumerate() {
                        prop_assert!((value - f64::from(u8::from(i == j))).abs() < 1e-6, "{inverse:?}");
                    }
                }
            }
        }

        #[test]
        fn backtracking_ends_lower((hessian, start) in quadratic(), longest in 0.1..100.0f64) {
            let direction: Vec<f64> = start.iter().map(|v| -v).collect();
            let (slope, turned) = (-dot(&start, &start), dot(&direction, &product(&hessian, &direction)));
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
}
