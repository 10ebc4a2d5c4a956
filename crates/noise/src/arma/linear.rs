//! The stationary covariance of an ARMA state, and its factor.
//!
//! Both run at every evaluation of the likelihood for orders up to 24. Doubling takes as many steps as the
//! logarithm of the longest memory: some 25 for one of a million samples.
//!
//! The state is that of docs/theory.md, section 2, in innovations form. Closed form for (1, 1): P =
//! (φ − θ)²/(1 − φ²). Doubling rather than the linear system of r² unknowns: it needs no inverse
//! and adds only positive semi-definite terms, so P stays so.

use nalgebra::DMatrix;

/// Lower-triangular Cholesky factor of a positive semi-definite matrix; pivots at rounding level count
/// as zero and leave a zero column, where nalgebra's would give up. `None` where an entry is not finite.
///
/// `a` symmetric; its lower triangle is read. L Lᵀ = a up to the pivots dropped, each below 1e-15
/// of its diagonal.
pub(super) fn semidefinite_cholesky(a: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = a.nrows();
    let mut l = DMatrix::zeros(n, n);
    for j in 0..n {
        let mut pivot = a[(j, j)];
        for k in 0..j {
            pivot -= l[(j, k)] * l[(j, k)];
        }
        if !pivot.is_finite() {
            return None;
        }
        // Tiny pivots are kept as long as they are above the rounding of what was subtracted.
        if pivot <= 1e-15 * a[(j, j)] {
            continue;
        }
        let diagonal = pivot.sqrt();
        l[(j, j)] = diagonal;
        for i in j + 1..n {
            let mut below = a[(i, j)];
            for k in 0..j {
                below -= l[(i, k)] * l[(j, k)];
            }
            l[(i, j)] = below / diagonal;
        }
    }
    Some(l)
}

/// Coefficients with zeros after them, up to `n`.
///
/// `n` must not be less than their number: longer lists are cut.
pub(super) fn padded(coefficients: &[f64], n: usize) -> Vec<f64> {
    let mut padded = coefficients.to_vec();
    padded.resize(n, 0.0);
    padded
}

/// Stationary covariance of the innovations-form state, `P = F P Fᵀ + G Gᵀ`, in units of σ², by
/// doubling. With `unit_root` φ has one root at exactly 1: the random walk it makes starts at
/// zero and the rest stationary (the unit root's mode is projected out). `None` where φ is not
/// stationary to working precision.
///
/// r × r, r = max(p, q) ≥ 1. `phi` holds the unit root, if there is one, multiplied in.
pub(super) fn initial_covariance(
    phi: &[f64],
    theta: &[f64],
    unit_root: bool,
) -> Option<DMatrix<f64>> {
    let n = phi.len().max(theta.len());
    let (phi, theta) = (padded(phi, n), padded(theta, n));
    if n == 1 {
        let (phi, g) = if unit_root {
            (0.0, 0.0)
        } else {
            (phi[0], phi[0] - theta[0])
        };
        let p = g * g / ((1.0 - phi) * (1.0 + phi));
        return (p.is_finite() && p >= 0.0).then(|| DMatrix::repeat(1, 1, p));
    }
    // Companion matrix, φ its first column (docs/theory.md, section 2).
    let mut f = DMatrix::from_fn(n, n, |i, j| match j {
        0 => phi[i],
        _ => f64::from(i + 1 == j),
    });
    let g = |i: usize| phi[i] - theta[i];
    let mut p = DMatrix::from_fn(n, n, |i, j| g(i) * g(j));
    if unit_root {
        // Left eigenvector of F at 1: all ones. Right: 1, 1−φ1, 1−φ1−φ2, …
        let tail = |tail: &mut f64, phi: &f64| Some(std::mem::replace(tail, *tail - phi));
        let right: Vec<f64> = phi.iter().scan(1.0, tail).collect();
        let norm: f64 = right.iter().sum();
        let keep = DMatrix::from_fn(n, n, |i, j| f64::from(i == j) - right[i] / norm);
        f = &keep * f;
        p = &keep * p * keep.transpose();
    }
    let mut half = DMatrix::zeros(n, n);
    let mut step = DMatrix::zeros(n, n);
    // P ← P + F P Fᵀ, F ← F², P symmetric.
    for _ in 0..64 {
        f.mul_to(&p, &mut half);
        half.transpose_mut();
        f.mul_to(&half, &mut step);
        p += &step;
        p.fill_upper_triangle_with_lower_triangle();
        let largest = |of: &DMatrix<f64>| (0..n).map(|i| of[(i, i)].abs()).fold(0.0, f64::max);
        let size = largest(&p);
        if !size.is_finite() || size > 1e200 {
            return None;
        }
        if largest(&step) <= 1e-17 * size && f.amax() < 1e-2 {
            return Some(p);
        }
        f.mul_to(&f, &mut half);
        std::mem::swap(&mut f, &mut half);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covariance_solves_its_equation() {
        for (phi, theta, tolerance) in [
            (&[1.2, -0.5][..], &[0.3][..], 1e-14),
            (&[0.9], &[0.5, 0.2], 1e-14),
            (&[0.5, 0.2, -0.1, 0.05], &[-0.3, -0.2, -0.1], 1e-14),
            (&[1.999, -0.9992], &[0.99], 1e-11),
        ] {
            let n = phi.len().max(theta.len());
            let p = initial_covariance(phi, theta, false).unwrap();
            let (phi, theta) = (padded(phi, n), padded(theta, n));
            let f = DMatrix::from_fn(n, n, |i, j| {
                if j == 0 {
                    phi[i]
                } else {
                    f64::from(i + 1 == j)
                }
            });
            let g = DMatrix::from_fn(n, 1, |i, _| phi[i] - theta[i]);
            let off = &f * &p * f.transpose() + &g * g.transpose() - &p;
            // Rounding of the products, times the gain of the slowest pole.
            assert!(off.amax() < tolerance * p.amax());
        }
        assert!(initial_covariance(&[1.1], &[0.2], false).is_none());
        assert!(initial_covariance(&[2.1, -1.0], &[0.2], false).is_none());
    }
}
