//! Small matrices of one axis: products, Cholesky factor, inverse, square root, logarithm, exponential.
//! Higham 2008, Functions of Matrices, chapters 6, 10 and 11. Only the leading n × n block counts.
//!
//! Sizes are at most [`MAX_ORDER`], so plain loops over arrays do: no allocation, and every function
//! gives a result or `None`.

use super::{AxisMatrix, AxisVector, MAX_ORDER};
use libm::sqrt;

const ZERO: AxisMatrix = [[0.0; MAX_ORDER]; MAX_ORDER];

/// The n × n identity.
pub(super) fn identity(n: usize) -> AxisMatrix {
    let mut one = ZERO;
    for i in 0..n {
        one[i][i] = 1.0;
    }
    one
}

/// `scale_a · a + scale_b · b`.
pub(super) fn combine(scale_a: f64, a: &AxisMatrix, scale_b: f64, b: &AxisMatrix) -> AxisMatrix {
    let mut c = ZERO;
    for i in 0..MAX_ORDER {
        for j in 0..MAX_ORDER {
            c[i][j] = scale_a * a[i][j] + scale_b * b[i][j];
        }
    }
    c
}

/// Largest row sum of magnitudes; NaN where an entry is NaN.
pub(super) fn norm(a: &AxisMatrix) -> f64 {
    let mut largest = 0.0;
    for row in a {
        let sum: f64 = row.iter().map(|x| x.abs()).sum();
        if sum > largest || sum.is_nan() {
            largest = sum;
        }
    }
    largest
}

/// Solves `a x = b` by elimination with partial pivoting; none if `a` is singular.
/// `b` may have any columns: each is a right-hand side.
pub(super) fn solve(a: &AxisMatrix, b: &AxisMatrix, n: usize) -> Option<AxisMatrix> {
    let (mut a, mut x) = (*a, *b);
    for column in 0..n {
        let mut best = column;
        for row in column + 1..n {
            if a[row][column].abs() > a[best][column].abs() {
                best = row;
            }
        }
        a.swap(column, best);
        x.swap(column, best);
        let pivot = a[column][column];
        if !(pivot.abs() > 0.0 && pivot.is_finite()) {
            return None;
        }
        for row in 0..n {
            let factor = a[row][column] / pivot;
            if row == column || factor == 0.0 {
                continue;
            }
            for j in 0..n {
                a[row][j] -= factor * a[column][j];
                x[row][j] -= factor * x[column][j];
            }
        }
    }
    for i in 0..n {
        for j in 0..n {
            x[i][j] /= a[i][i];
        }
    }
    Some(x)
}

/// Principal square root by the product form of the Denman-Beavers iteration. None where there is
/// no real one: an eigenvalue that is zero or negative keeps it from settling.
fn square_root(a: &AxisMatrix, n: usize) -> Option<AxisMatrix> {
    let one = identity(n);
    let (mut m, mut x) = (*a, *a);
    let mut last = f64::INFINITY;
    for _ in 0..100 {
        let inverse = solve(&m, &one, n)?;
        x = combine(0.5, &x, 0.5, &product(&x, &inverse, n));
        m = combine(0.5, &one, 0.25, &combine(1.0, &m, 1.0, &inverse));
        let miss = norm(&combine(1.0, &m, -1.0, &one));
        if !miss.is_finite() {
            return None;
        }
        // Quadratic convergence: once small, it is over when it no longer falls.
        if miss < 1e-8 && (miss >= last || miss < 1e-15) {
            return Some(x);
        }
        last = miss;
    }
    None
}

/// Principal logarithm by square roots until near 1, then the series of 2 artanh. None where
/// there is no real one.
///
/// Each root halves the logarithm; what the series gives is multiplied by two for each at the end (inverse
/// scaling and squaring, Higham 2008, chapter 11).
pub(super) fn logarithm(a: &AxisMatrix, n: usize) -> Option<AxisMatrix> {
    let one = identity(n);
    let mut near = *a;
    let mut doublings = 0;
    while norm(&combine(1.0, &near, -1.0, &one)) > 0.1 {
        if doublings == 60 {
            return None;
        }
        near = square_root(&near, n)?;
        doublings += 1;
    }
    // (X − I)(X + I)⁻¹ has norm below 0.053: fourteen odd powers reach rounding.
    let difference = combine(1.0, &near, -1.0, &one);
    let z = solve(&combine(1.0, &near, 1.0, &one), &difference, n)?;
    let square = product(&z, &z, n);
    let mut power = z;
    let mut log = ZERO;
    for k in 0..14 {
        log = combine(1.0, &log, 2.0 / (2 * k + 1) as f64, &power);
        power = product(&power, &square, n);
    }
    let log = combine(libm::ldexp(1.0, doublings), &log, 0.0, &ZERO);
    // A root that crossed the cut, or an ill-conditioned one, shows here.
    let back = exponential(&log, n)?;
    let miss = norm(&combine(1.0, &back, -1.0, a));
    (miss <= 1e-9 * norm(a)).then_some(log)
}

/// How often `a` must be halved for its norm to fall below one half; none if it is not finite or
/// too large for its exponential to mean anything.
pub(super) fn halvings(a: &AxisMatrix) -> Option<i32> {
    let size = norm(a);
    if size.is_nan() || size > 1e15 {
        return None;
    }
    let mut count = 0;
    while libm::ldexp(size, -count) > 0.5 {
        count += 1;
    }
    Some(count)
}

/// Exponential by Taylor's series and squaring. None if `a` is not finite.
pub(super) fn exponential(a: &AxisMatrix, n: usize) -> Option<AxisMatrix> {
    let count = halvings(a)?;
    let small = combine(libm::ldexp(1.0, -count), a, 0.0, &ZERO);
    let mut term = identity(n);
    let mut sum = term;
    // 0.5^17/17! is far below rounding.
    for k in 1..17 {
        term = combine(1.0 / k as f64, &product(&term, &small, n), 0.0, &ZERO);
        sum = combine(1.0, &sum, 1.0, &term);
    }
    for _ in 0..count {
        sum = product(&sum, &sum, n);
    }
    norm(&sum).is_finite().then_some(sum)
}

/// Cholesky factor of a positive semi-definite leading block; pivots at rounding level count as zero.
pub(super) fn semidefinite_cholesky<const M: usize>(a: &[[f64; M]; M], n: usize) -> [[f64; M]; M] {
    let mut l = [[0.0; M]; M];
    for j in 0..n {
        let mut pivot = a[j][j];
        for k in 0..j {
            pivot -= l[j][k] * l[j][k];
        }
        if pivot <= 1e-13 * a[j][j] {
            continue;
        }
        l[j][j] = sqrt(pivot);
        for i in j + 1..n {
            let mut below = a[i][j];
            for k in 0..j {
                below -= l[i][k] * l[j][k];
            }
            l[i][j] = below / l[j][j];
        }
    }
    l
}

/// `a b` of the leading blocks.
pub(super) fn product(a: &AxisMatrix, b: &AxisMatrix, n: usize) -> AxisMatrix {
    let mut c = [[0.0; MAX_ORDER]; MAX_ORDER];
    for i in 0..n {
        for k in 0..n {
            for j in 0..n {
                c[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    c
}

/// `aᵀ` of the leading block.
pub(super) fn transpose(a: &AxisMatrix, n: usize) -> AxisMatrix {
    let mut t = [[0.0; MAX_ORDER]; MAX_ORDER];
    for i in 0..n {
        for j in 0..n {
            t[i][j] = a[j][i];
        }
    }
    t
}

/// `a x` of the leading blocks.
pub(super) fn apply(a: &AxisMatrix, x: &AxisVector, n: usize) -> AxisVector {
    let mut y = [0.0; MAX_ORDER];
    for i in 0..n {
        y[i] = dot(&a[i], x, n);
    }
    y
}

/// `a · b` of the leading entries.
pub(super) fn dot(a: &AxisVector, b: &AxisVector, n: usize) -> f64 {
    (0..n).map(|i| a[i] * b[i]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(rows: &[&[f64]]) -> AxisMatrix {
        let mut a = ZERO;
        for (i, row) in rows.iter().enumerate() {
            a[i][..row.len()].copy_from_slice(row);
        }
        a
    }

    #[test]
    fn logarithm_of_a_rotation_is_its_angle() {
        let (s, c) = libm::sincos(0.7);
        let log = logarithm(&filled(&[&[0.9 * c, -0.9 * s], &[0.9 * s, 0.9 * c]]), 2).unwrap();
        let expected = filled(&[&[libm::log(0.9), -0.7], &[0.7, libm::log(0.9)]]);
        assert!(norm(&combine(1.0, &log, -1.0, &expected)) < 1e-14);
    }

    #[test]
    fn logarithm_of_a_jordan_block() {
        let log = logarithm(&filled(&[&[0.5, 1.0], &[0.0, 0.5]]), 2).unwrap();
        let expected = filled(&[&[libm::log(0.5), 2.0], &[0.0, libm::log(0.5)]]);
        assert!(norm(&combine(1.0, &log, -1.0, &expected)) < 1e-13);
    }

    #[test]
    fn a_diagonal_one_stays_exactly_one() {
        let a = filled(&[&[1.0, 0.0], &[0.0, 0.3]]);
        let log = logarithm(&a, 2).unwrap();
        assert_eq!((log[0][0], log[0][1], log[1][0]), (0.0, 0.0, 0.0));
        assert!((log[1][1] - libm::log(0.3)).abs() < 1e-15);
    }

    #[test]
    fn no_real_logarithm() {
        for a in [
            &[&[-0.5][..]][..],
            &[&[0.0]],
            &[&[-0.5, 0.0], &[0.0, 0.5]],
            &[&[0.3, 1.0], &[0.1, 0.0]],
            &[&[f64::NAN]],
        ] {
            assert_eq!(logarithm(&filled(a), a.len()), None, "{a:?}");
        }
    }
}
