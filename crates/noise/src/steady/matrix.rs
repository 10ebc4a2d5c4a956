//! Small matrices of known size.
//!
//! Sums go in a fixed order and no product is left to a library, so that results are the same on every machine.
//!
//! N is 6 at most (the states of an axis). For sizes that are known at run time only, nalgebra is
//! used.

/// A square matrix by rows.
pub(crate) type Matrix<const N: usize> = [[f64; N]; N];
/// A column of a matrix.
pub(crate) type Vector<const N: usize> = [f64; N];

/// I, of order N.
pub(crate) fn identity<const N: usize>() -> Matrix<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j)))
}

/// `aᵀ b`, summed in order.
pub(crate) fn dot<const N: usize>(a: &Vector<N>, b: &Vector<N>) -> f64 {
    let mut sum = 0.0;
    for i in 0..N {
        sum += a[i] * b[i];
    }
    sum
}

/// `a x`.
pub(crate) fn apply<const N: usize>(a: &Matrix<N>, x: &Vector<N>) -> Vector<N> {
    std::array::from_fn(|i| dot(&a[i], x))
}

/// `aᵀ`.
pub(crate) fn transposed<const N: usize>(a: &Matrix<N>) -> Matrix<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// `a b`.
///
/// O(N³).
pub(crate) fn product<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    let mut out = [[0.0; N]; N];
    for i in 0..N {
        for k in 0..N {
            for j in 0..N {
                out[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    out
}

/// `a + times · b`.
///
/// Differences are sums with `times` = −1.
pub(crate) fn add<const N: usize>(a: &Matrix<N>, b: &Matrix<N>, times: f64) -> Matrix<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + times * b[i][j]))
}

/// `a⁻¹ b` by elimination with pivots, and the determinant of a; `None` where a is singular.
///
/// Gauss-Jordan with row pivots, O(N³). Singular means a pivot of exactly 0 or not finite:
/// near-singular matrices are solved, and the caller judges the determinant.
pub(crate) fn solve<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Option<(Matrix<N>, f64)> {
    let (mut a, mut b) = (*a, *b);
    let mut determinant = 1.0;
    for k in 0..N {
        let pivot = (k..N).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))?;
        if pivot != k {
            a.swap(pivot, k);
            b.swap(pivot, k);
            determinant = -determinant;
        }
        let scale = a[k][k];
        if scale == 0.0 || !scale.is_finite() {
            return None;
        }
        determinant *= scale;
        for i in 0..N {
            if i == k {
                continue;
            }
            let share = a[i][k] / scale;
            for j in 0..N {
                a[i][j] -= share * a[k][j];
                b[i][j] -= share * b[k][j];
            }
        }
    }
    for k in 0..N {
        for j in 0..N {
            b[k][j] /= a[k][k];
        }
    }
    Some((b, determinant))
}
