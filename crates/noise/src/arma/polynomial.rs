//! Polynomials `1 − c1 B − … − cn Bⁿ`: partial autocorrelations, roots, products.
//!
//! Every stationary (invertible) polynomial corresponds to exactly one vector of n partial
//! autocorrelations in (−1, 1): Barndorff-Nielsen & Schou 1973; Monahan 1984. They are searched as
//! `z = artanh κ = ½ log((1+κ)/(1−κ))`, which near ±1 is the logarithm of the distance to it.
//!
//! Signs: a coefficient is subtracted, as in docs/theory.md, for φ and θ alike. So "inverse roots"
//! ρ satisfy 1 − c1/ρ − … − cn/ρⁿ = 0, and stable means |ρ| < 1. Recursions are O(n²); n is at most
//! a few dozen.
//!
//! | c | κ (partial autocorrelations) | inverse roots |
//! |---|---|---|
//! | φ1 | φ1 | φ1 |
//! | φ1, φ2 | φ1/(1 − φ2), φ2 | (φ1 ± √(φ1² + 4φ2))/2 |

use crate::prediction::Predictor;
use realfft::num_complex::Complex64;

/// Largest |z| of the search: |κ| stays below 1 − 1e-12.
const Z_LIMIT: f64 = 14.16;

/// Coefficients c of the polynomial with partial autocorrelations `tanh z` (Durbin-Levinson).
///
/// Any z gives a stable polynomial: the search needs no constraints.
pub(super) fn from_search(z: &[f64]) -> Vec<f64> {
    let mut predictor = Predictor::new(1.0);
    for z in z {
        predictor.extend(z.clamp(-Z_LIMIT, Z_LIMIT).tanh());
    }
    predictor.phi
}

/// Derivatives by the search coordinates, of a function whose derivatives by the coefficients are these.
///
/// The reverse mode of [`from_search`]: from the last step of Durbin's recursion to the first, O(n²). A
/// coordinate at its limit has the derivative 0.
pub(super) fn by_search(z: &[f64], by_coefficients: &[f64]) -> Vec<f64> {
    let mut predictor = Predictor::new(1.0);
    let mut below = Vec::with_capacity(z.len());
    for z in z {
        below.push(predictor.phi.clone());
        predictor.extend(z.clamp(-Z_LIMIT, Z_LIMIT).tanh());
    }
    let mut by = by_coefficients.to_vec();
    for (k, below) in below.iter().enumerate().rev() {
        // Durbin's step c_j = d_j − κ d_{k−1−j}, c_k = κ, backwards.
        let crossed: f64 = by[..k]
            .iter()
            .zip(below.iter().rev())
            .map(|(by, d)| by * d)
            .sum();
        let kappa = z[k].clamp(-Z_LIMIT, Z_LIMIT).tanh();
        let turned: Vec<f64> = by[..k].iter().rev().copied().collect();
        for (by, turned) in by.iter_mut().zip(turned) {
            *by -= kappa * turned;
        }
        by[k] = match z[k].abs() < Z_LIMIT {
            true => (by[k] - crossed) / z[k].cosh().powi(2),
            false => 0.0,
        };
    }
    by
}

/// Durbin's step back: the polynomial of one order less from one whose last partial autocorrelation is `kappa`.
///
/// Inverse of [`Predictor::extend`]; ill-conditioned for |κ| near 1, where it divides by 1 − κ².
fn step_down(c: &mut Vec<f64>, kappa: f64) {
    c.pop();
    let turned: Vec<f64> = c.iter().rev().copied().collect();
    for (c, turned) in c.iter_mut().zip(turned) {
        *c = (*c + kappa * turned) / ((1.0 - kappa) * (1.0 + kappa));
    }
}

/// Search coordinates of a polynomial. Partial autocorrelations outside (−1, 1), or closer to ±1
/// than `margin`, are drawn in to `1 − margin`: the nearest admissible start, not the same polynomial.
///
/// `margin` is between 0 and 1. With 0 the result is exact up to rounding for a stable polynomial.
pub(super) fn to_search(c: &[f64], margin: f64) -> Vec<f64> {
    let mut c = c.to_vec();
    let mut z = vec![0.0; c.len()];
    let limit = 1.0 - margin;
    for k in (0..c.len()).rev() {
        let kappa = if c[k].is_finite() {
            c[k].clamp(-limit, limit)
        } else {
            0.0
        };
        z[k] = kappa.atanh().clamp(-Z_LIMIT, Z_LIMIT);
        step_down(&mut c, kappa);
    }
    z
}

/// Whether all partial autocorrelations lie inside (−1, 1): stationary or invertible.
///
/// Schur and Cohn's criterion, in the order of Durbin's recursion backwards; on the circle it is false.
pub(super) fn is_stable(c: &[f64]) -> bool {
    let mut c = c.to_vec();
    while let Some(&kappa) = c.last() {
        let inside = (1.0 - kappa) * (1.0 + kappa) > 0.0;
        if !inside {
            return false;
        }
        step_down(&mut c, kappa);
    }
    true
}

/// Coefficients of `(1 − a1 B − …)(1 − b1 B − …)`.
///
/// Of degree `a.len() + b.len()`; the inverse roots of both together.
pub(super) fn multiply(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut c = vec![0.0; a.len() + b.len()];
    for (i, a) in a.iter().enumerate() {
        c[i] += a;
    }
    for (j, b) in b.iter().enumerate() {
        c[j] += b;
    }
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            c[i + j + 1] -= a * b;
        }
    }
    c
}

/// A polynomial with the factor (1 − B) divided out: d_k = φ_{k+1} + d_{k+1} from the end, tail sums with minus sign.
///
/// One coefficient fewer. Exact only if the coefficients sum to 1, that is, if 1 is a root.
pub(super) fn less_unit_root(c: &[f64]) -> Vec<f64> {
    (1..c.len()).map(|k| -c[k..].iter().sum::<f64>()).collect()
}

/// Inverse roots ρ of the polynomial, `∏(1 − ρ_i B)`: all inside the unit circle when it is stable.
/// Aberth's simultaneous iteration; zeros for trailing zero coefficients.
///
/// They are the poles (of φ) and zeros (of θ) of the process in the z plane: a real one ρ near 1 has the
/// correlation time −1/ln ρ samples, a complex one the frequency of its argument.
///
/// As many as coefficients, in no particular order, complex ones in conjugate pairs to rounding.
/// Multiple roots are found to about the square root of the working precision only.
pub(crate) fn inverse_roots(c: &[f64]) -> Vec<Complex64> {
    let degree = c.iter().rposition(|v| *v != 0.0).map_or(0, |k| k + 1);
    let start = |k: usize| Complex64::from_polar(0.8, 2.4 * k as f64 + 0.4);
    let mut roots: Vec<Complex64> = (0..degree).map(start).collect();
    for _ in 0..200 {
        let mut change = 0.0f64;
        for k in 0..degree {
            let z = roots[k];
            let (mut value, mut slope) = (Complex64::ONE, Complex64::ZERO);
            for coefficient in &c[..degree] {
                slope = slope * z + value;
                value = value * z - coefficient;
            }
            if value == Complex64::ZERO {
                continue;
            }
            let newton = value / slope;
            let others = roots
                .iter()
                .enumerate()
                .filter(|(j, other)| *j != k && **other != z);
            let repulsion: Complex64 = others.map(|(_, other)| (z - other).inv()).sum();
            let step = newton / (1.0 - newton * repulsion);
            if step.is_finite() {
                roots[k] = z - step;
                change = change.max(step.norm());
            }
        }
        if change < 1e-15 {
            break;
        }
    }
    roots.resize(c.len(), Complex64::ZERO);
    roots
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::{ProptestConfig, prop_assert, prop_assert_eq};
    use proptest::test_runner::RngSeed;

    #[test]
    fn partial_autocorrelations_go_both_ways() {
        let c = multiply(&[0.99995], &multiply(&[1.2, -0.72], &[-0.3]));
        assert!(is_stable(&c));
        let back = from_search(&to_search(&c, 0.0));
        for (a, b) in c.iter().zip(&back) {
            // The map's condition is 1/(1 − κ²): four digits of sixteen.
            assert!((a - b).abs() < 1e-11, "{a} {b}");
        }
        assert!(!is_stable(&[1.0]));
        assert!(!is_stable(&[0.5, 0.6]));
        assert!(!is_stable(&[f64::NAN]));
        assert!(is_stable(&from_search(&to_search(
            &[3.0, f64::NAN, 2.0],
            0.05
        ))));
    }

    #[test]
    fn roots_are_those_multiplied_in() {
        let c = multiply(&[0.9999], &multiply(&[1.2, -0.72], &[-0.3]));
        let mut roots = inverse_roots(&c);
        roots.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
        for (root, exact) in roots
            .iter()
            .zip([(-0.3, 0.0), (0.6, -0.6), (0.6, 0.6), (0.9999, 0.0)])
        {
            assert!(
                (root - Complex64::new(exact.0, exact.1)).norm() < 1e-12,
                "{root:?}"
            );
        }
        assert_eq!(inverse_roots(&[0.0, 0.0]), [Complex64::ZERO; 2]);
    }

    /// `∏(1 − ρ_i B)`, which is real for roots in conjugate pairs.
    fn from_roots(roots: &[Complex64]) -> Vec<f64> {
        let mut product = vec![Complex64::ONE];
        for root in roots {
            product.push(Complex64::ZERO);
            for k in (1..product.len()).rev() {
                let term = product[k - 1] * root;
                product[k] -= term;
            }
        }
        product[1..].iter().map(|c| -c.re).collect()
    }

    proptest::proptest! {
        #![proptest_config(ProptestConfig {
            rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..ProptestConfig::default()
        })]

        #[test]
        fn every_point_of_the_search_is_a_stable_polynomial_and_the_way_back(
            z in proptest::collection::vec(-3.0..3.0f64, 0..9),
        ) {
            let c = from_search(&z);
            prop_assert!(is_stable(&c));
            // The condition of Durbin's recursion, Cybenko 1980.
            let lost: f64 = z.iter().map(|z| (2.0 * z.abs()).exp()).product();
            for (a, b) in to_search(&c, 0.0).iter().zip(&z) {
                prop_assert!((a.tanh() - b.tanh()).abs() < 1e-14 * lost, "{a} {b}");
            }
            for (a, b) in from_search(&to_search(&c, 0.0)).iter().zip(&c) {
                prop_assert!((a - b).abs() < 1e-14 * lost, "{a} {b}");
            }
        }

        #[test]
        fn derivatives_by_the_search_coordinates_are_those_of_the_coefficients(
            z in proptest::collection::vec(-1.5..1.5f64, 1..7), weights in proptest::collection::vec(-1.0..1.0f64, 6),
        ) {
            let sum = |z: &[f64]| -> f64 { from_search(z).iter().zip(&weights).map(|(c, w)| c * w).sum() };
            let by = by_search(&z, &weights[..z.len()]);
            for (i, by) in by.iter().enumerate() {
                let moved = |step: f64| {
                    let mut z = z.clone();
                    z[i] += step;
                    sum(&z)
                };
                // Third derivatives of some tens times the step's square.
                let numeric = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                prop_assert!((numeric - by).abs() < 1e-7, "{i}: {numeric} {by}");
            }
        }

        #[test]
        fn stable_means_all_roots_within_the_circle_and_the_roots_make_the_polynomial(
            c in proptest::collection::vec(-1.5..1.5f64, 1..7),
        ) {
            let roots = inverse_roots(&c);
            let size: f64 = c.iter().map(|c| c.abs()).sum::<f64>() + 1.0;
            for (made, c) in from_roots(&roots).iter().zip(&c) {
                // Roots of up to 2.5, six of them multiplied.
                prop_assert!((made - c).abs() < 1e-9 * size, "{made} {c} {roots:?}");
            }
            let largest = roots.iter().map(|r| r.norm()).fold(0.0, f64::max);
            // On the circle itself, rounding decides.
            proptest::prop_assume!((largest - 1.0).abs() > 1e-6);
            prop_assert_eq!(is_stable(&c), largest < 1.0, "{:?}", roots);
        }

        #[test]
        fn a_product_of_polynomials_has_the_product_of_their_values(
            a in proptest::collection::vec(-2.0..2.0f64, 0..6), b in proptest::collection::vec(-2.0..2.0f64, 0..6),
            at in -1.0..1.0f64,
        ) {
            let value = |c: &[f64]| c.iter().rev().fold(0.0, |sum, c| (sum + c) * at);
            let exact = (1.0 - value(&a)) * (1.0 - value(&b));
            prop_assert!((1.0 - value(&multiply(&a, &b)) - exact).abs() < 1e-12);
        }
    }
}
