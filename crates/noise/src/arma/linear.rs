//! Small dense matrices, row-major in a `Vec`, and the stationary covariance of an ARMA state.

/// Lower-triangular Cholesky factor of a positive semi-definite n-by-n matrix; pivots at rounding
/// level count as zero and leave a zero column. `None` where an entry is not finite.
pub(super) fn semidefinite_cholesky(a: &[f64], n: usize) -> Option<Vec<f64>> {
    let mut l = vec![0.0; n * n];
    for j in 0..n {
        let mut pivot = a[j * n + j];
        for k in 0..j {
            pivot -= l[j * n + k] * l[j * n + k];
        }
        if !pivot.is_finite() {
            return None;
        }
        // Tiny pivots are kept as long as they are above the rounding of what was subtracted.
        if pivot <= 1e-15 * a[j * n + j] {
            continue;
        }
        let diagonal = pivot.sqrt();
        l[j * n + j] = diagonal;
        for i in j + 1..n {
            let mut below = a[i * n + j];
            for k in 0..j {
                below -= l[i * n + k] * l[j * n + k];
            }
            l[i * n + j] = below / diagonal;
        }
    }
    Some(l)
}

/// Lower-triangular Cholesky factor of a positive definite matrix, or `None`.
pub(super) fn cholesky(a: &[f64], n: usize) -> Option<Vec<f64>> {
    let mut l = vec![0.0; n * n];
    for j in 0..n {
        for i in j..n {
            let mut value = a[i * n + j];
            for k in 0..j {
                value -= l[i * n + k] * l[j * n + k];
            }
            if i == j {
                if !(value > 0.0 && value.is_finite()) {
                    return None;
                }
                l[j * n + j] = value.sqrt();
            } else {
                l[i * n + j] = value / l[j * n + j];
            }
        }
    }
    Some(l)
}

/// Solves `L y = b` in place.
pub(super) fn forward_solve(l: &[f64], n: usize, b: &mut [f64]) {
    for i in 0..n {
        let mut value = b[i];
        for k in 0..i {
            value -= l[i * n + k] * b[k];
        }
        b[i] = value / l[i * n + i];
    }
}

/// Solves `Lᵀ y = b` in place.
pub(super) fn backward_solve(l: &[f64], n: usize, b: &mut [f64]) {
    for i in (0..n).rev() {
        let mut value = b[i];
        for k in i + 1..n {
            value -= l[k * n + i] * b[k];
        }
        b[i] = value / l[i * n + i];
    }
}

/// Inverse of a positive definite matrix, or `None`.
pub(super) fn inverse(a: &[f64], n: usize) -> Option<Vec<f64>> {
    let l = cholesky(a, n)?;
    let mut out = vec![0.0; n * n];
    for j in 0..n {
        let mut column = vec![0.0; n];
        column[j] = 1.0;
        forward_solve(&l, n, &mut column);
        backward_solve(&l, n, &mut column);
        for i in 0..n {
            out[i * n + j] = column[i];
        }
    }
    Some(out)
}

/// Inverse of a positive definite matrix scaled to unit diagonal first, `None` where it is
/// indefinite or singular to 1e-9.
pub(super) fn scaled_inverse(h: &[f64], d: usize) -> Option<Vec<f64>> {
    if d == 0 {
        return Some(Vec::new());
    }
    let scale: Vec<f64> = (0..d).map(|i| h[i * d + i].max(0.0).sqrt()).collect();
    if scale.iter().any(|s| s.is_nan() || *s <= 1e-4) {
        return None;
    }
    let unit: Vec<f64> = (0..d * d)
        .map(|k| h[k] / (scale[k / d] * scale[k % d]))
        .collect();
    let inverted = inverse(&unit, d)?;
    let check = product(&unit, &inverted, d);
    let exact = (0..d * d).all(|k| (check[k] - f64::from(k / d == k % d)).abs() < 1e-6);
    let large = (0..d).any(|i| inverted[i * d + i] > 1e9);
    if !exact || large {
        return None;
    }
    Some(
        (0..d * d)
            .map(|k| inverted[k] / (scale[k / d] * scale[k % d]))
            .collect(),
    )
}

/// `A B`.
pub(super) fn product(a: &[f64], b: &[f64], n: usize) -> Vec<f64> {
    let mut c = vec![0.0; n * n];
    product_into(a, b, n, &mut c);
    c
}

fn product_into(a: &[f64], b: &[f64], n: usize, c: &mut [f64]) {
    c.fill(0.0);
    for i in 0..n {
        for k in 0..n {
            let scale = a[i * n + k];
            if scale != 0.0 {
                for j in 0..n {
                    c[i * n + j] += scale * b[k * n + j];
                }
            }
        }
    }
}

fn transposed(a: &[f64], n: usize) -> Vec<f64> {
    let mut t = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..n {
            t[i * n + j] = a[j * n + i];
        }
    }
    t
}

/// Companion matrix with `first` as first column and ones above the diagonal (docs/theory.md, section 2).
pub(super) fn companion(first: &[f64], n: usize) -> Vec<f64> {
    let mut f = vec![0.0; n * n];
    for i in 0..n {
        f[i * n] = first.get(i).copied().unwrap_or(0.0);
        if i + 1 < n {
            f[i * n + i + 1] = 1.0;
        }
    }
    f
}

/// Stationary covariance of the innovations-form state, `P = F P Fᵀ + G Gᵀ`, in units of σ², by
/// doubling. With `unit_root` φ has one root at exactly 1: the random walk it makes starts at
/// zero and the rest stationary (the unit root's mode is projected out). `None` where φ is not
/// stationary to working precision.
pub(super) fn initial_covariance(phi: &[f64], theta: &[f64], unit_root: bool) -> Option<Vec<f64>> {
    let n = phi.len().max(theta.len());
    let at = |of: &[f64], i: usize| of.get(i).copied().unwrap_or(0.0);
    let g: Vec<f64> = (0..n).map(|i| at(phi, i) - at(theta, i)).collect();
    if n == 1 {
        let phi = if unit_root { 0.0 } else { at(phi, 0) };
        let g = if unit_root { 0.0 } else { g[0] };
        let p = g * g / ((1.0 - phi) * (1.0 + phi));
        return (p.is_finite() && p >= 0.0).then(|| vec![p]);
    }
    let mut f = companion(phi, n);
    let mut p: Vec<f64> = (0..n * n).map(|k| g[k / n] * g[k % n]).collect();
    if unit_root {
        // Left eigenvector of F at 1: all ones. Right: 1, 1−φ1, 1−φ1−φ2, …
        let mut right = vec![0.0; n];
        let mut tail = 1.0;
        for i in 0..n {
            right[i] = tail;
            tail -= at(phi, i);
        }
        let norm: f64 = right.iter().sum();
        let keep: Vec<f64> = (0..n * n)
            .map(|k| f64::from(k / n == k % n) - right[k / n] / norm)
            .collect();
        f = product(&keep, &f, n);
        p = product(&product(&keep, &p, n), &transposed(&keep, n), n);
    }
    let mut half = vec![0.0; n * n];
    let mut square = vec![0.0; n * n];
    // P ← P + F P Fᵀ, F ← F².
    for _ in 0..64 {
        product_into(&f, &p, n, &mut half);
        let (mut change, mut size) = (0.0f64, 0.0f64);
        for i in 0..n {
            for j in 0..=i {
                let step: f64 = (0..n).map(|k| half[i * n + k] * f[j * n + k]).sum();
                square[i * n + j] = p[i * n + j] + step;
                if i == j {
                    change = change.max(step.abs());
                    size = size.max(square[i * n + i].abs());
                }
            }
        }
        for i in 0..n {
            for j in 0..=i {
                p[i * n + j] = square[i * n + j];
                p[j * n + i] = square[i * n + j];
            }
        }
        if !size.is_finite() || size > 1e200 {
            return None;
        }
        let largest = f.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        if change <= 1e-17 * size && largest < 1e-2 {
            return Some(p);
        }
        product_into(&f, &f, n, &mut square);
        core::mem::swap(&mut f, &mut square);
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
            let f = companion(phi, n);
            let again = product(&product(&f, &p, n), &transposed(&f, n), n);
            let size = p.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            for i in 0..n {
                for j in 0..n {
                    let at = |of: &[f64], i: usize| of.get(i).copied().unwrap_or(0.0);
                    let g = |i| at(phi, i) - at(theta, i);
                    let right = again[i * n + j] + g(i) * g(j);
                    // Rounding of the products, times the gain of the slowest pole.
                    assert!((p[i * n + j] - right).abs() < tolerance * size);
                }
            }
        }
        assert!(initial_covariance(&[1.1], &[0.2], false).is_none());
        assert!(initial_covariance(&[2.1, -1.0], &[0.2], false).is_none());
    }

    #[test]
    fn inverse_is_one() {
        let a = [4.0, 1.0, 0.5, 1.0, 3.0, 0.2, 0.5, 0.2, 2.0];
        let one = product(&a, &inverse(&a, 3).unwrap(), 3);
        for k in 0..9 {
            assert!((one[k] - f64::from(k / 3 == k % 3)).abs() < 1e-14);
        }
        assert!(inverse(&[1.0, 2.0, 2.0, 1.0], 2).is_none());
    }
}
