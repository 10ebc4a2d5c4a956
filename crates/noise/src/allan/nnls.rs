//! Least squares with non-negative coefficients, by active sets (Lawson & Hanson, Solving Least
//! Squares Problems, 1974, chapter 23), for the handful of terms of an Allan variance.
//!
//! Terms of an Allan variance are squares: N² < 0 has no meaning, and a term that least squares
//! would make negative is absent. Coefficients at zero have no standard error by this method.

use nalgebra::{DMatrix, DVector};

/// Coefficients c ≥ 0 that minimise |A c − b|, `a` row by row. Columns are scaled to unit length
/// first. A column that is zero, or depends on the others, stays at 0.
///
/// ```
/// use nalgebra::{DMatrix, DVector};
/// use undrift_noise::allan::nnls::solve;
/// // The unconstrained solution is (2, −1): the second coefficient is put to 0 and the first found again.
/// let a = DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
/// let c = solve(&a, &DVector::from_vec(vec![2.0, -1.0, 1.0]));
/// assert!((c[0] - 1.5).abs() < 1e-12 && c[1] == 0.0);
/// ```
///
/// `a` is n × k, `b` has n numbers, the result k. O(n k²) a round, at most 10 k rounds. Uniqueness
/// needs independent columns among those that end above zero.
///
/// ```
/// use nalgebra::{DMatrix, DVector};
/// use undrift_noise::allan::nnls::solve;
/// // Columns are scaled inside: one of 1e-9 counts as much as one of 1.
/// let a = DMatrix::from_row_slice(2, 3, &[1.0, 0.0, 0.0, 0.0, 1e-9, 0.0]);
/// let c = solve(&a, &DVector::from_vec(vec![3.0, 2e-9]));
/// assert!((c[0] - 3.0).abs() < 1e-9 && (c[1] - 2.0).abs() < 1e-6);
/// assert_eq!(c[2], 0.0); // A column of zeros.
/// ```
pub fn solve(a: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let columns = a.ncols();
    let mut scaled = a.clone();
    let lengths: Vec<f64> = (0..columns).map(|j| a.column(j).norm()).collect();
    for (j, &length) in lengths.iter().enumerate() {
        if length > 0.0 {
            scaled.column_mut(j).scale_mut(1.0 / length);
        }
    }
    let mut passive = vec![false; columns];
    let mut barred = vec![false; columns];
    let mut x = DVector::zeros(columns);
    let tolerance = 1e-13 * b.norm();
    // Each round frees one column; Lawson & Hanson find a few rounds a column enough.
    for _ in 0..10 * columns {
        let gradient = scaled.transpose() * (b - &scaled * &x);
        let free = (0..columns).filter(|&j| !passive[j] && !barred[j] && gradient[j] > tolerance);
        let Some(entering) = free.max_by(|&i, &j| gradient[i].total_cmp(&gradient[j])) else {
            break;
        };
        passive[entering] = true;
        for _ in 0..=columns {
            let Some(trial) = subset(&scaled, b, &passive) else {
                passive[entering] = false;
                barred[entering] = true;
                break;
            };
            if trial[entering] <= 0.0 && x[entering] == 0.0 {
                // The gradient was rounding.
                passive[entering] = false;
                barred[entering] = true;
                break;
            }
            let blocking = (0..columns).filter(|&j| passive[j] && trial[j] <= 0.0);
            let ratio = blocking
                .map(|j| x[j] / (x[j] - trial[j]))
                .fold(1.0, f64::min);
            if ratio >= 1.0 {
                x = trial;
                break;
            }
            x += (trial - &x) * ratio;
            for j in 0..columns {
                if passive[j] && x[j] <= 1e-15 * x.amax() {
                    passive[j] = false;
                    x[j] = 0.0;
                }
            }
        }
    }
    for (value, &length) in x.iter_mut().zip(&lengths) {
        *value = if length > 0.0 && value.is_finite() {
            *value / length
        } else {
            0.0
        };
    }
    x
}

/// Unconstrained solution in the chosen columns, 0 elsewhere; None where they are dependent.
///
/// By QR; dependent means a diagonal of R below 1e-10 of a unit column.
fn subset(a: &DMatrix<f64>, b: &DVector<f64>, chosen: &[bool]) -> Option<DVector<f64>> {
    let indices: Vec<usize> = (0..a.ncols()).filter(|&j| chosen[j]).collect();
    if indices.len() > a.nrows() {
        return None;
    }
    let qr = a.select_columns(&indices).qr();
    let r = qr.r();
    if (0..indices.len()).any(|i| r[(i, i)].abs() < 1e-10) {
        return None;
    }
    let solved = r.solve_upper_triangular(&(qr.q().transpose() * b))?;
    let mut x = DVector::zeros(a.ncols());
    for (&j, &value) in indices.iter().zip(solved.iter()) {
        x[j] = value;
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_optimality_conditions_hold() {
        // Deterministic, ill-scaled problems: at the optimum the gradient is 0 where c > 0 and
        // not positive where c = 0 (Karush-Kuhn-Tucker).
        let mut state = 1u64;
        let mut draw = || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        for _ in 0..200 {
            let a = DMatrix::from_fn(12, 5, |_, j| draw() * 10f64.powi(3 * j as i32 - 6));
            let b = DVector::from_fn(12, |_, _| draw());
            let c = solve(&a, &b);
            let gradient = a.transpose() * (&b - &a * &c);
            for j in 0..5 {
                let size = a.column(j).norm() * b.norm();
                assert!(c[j] >= 0.0);
                if c[j] > 0.0 {
                    assert!(
                        gradient[j].abs() < 1e-10 * size,
                        "free column {j}: {}",
                        gradient[j] / size
                    );
                } else {
                    assert!(
                        gradient[j] < 1e-10 * size,
                        "bound column {j}: {}",
                        gradient[j] / size
                    );
                }
            }
        }
    }

    #[test]
    fn exact_data_give_exact_terms_and_dependent_columns_do_no_harm() {
        let a = DMatrix::from_fn(10, 3, |i, j| [1.0, i as f64, 2.0 * i as f64][j]);
        let b = DVector::from_fn(10, |i, _| 2.0 + 3.0 * i as f64);
        let c = solve(&a, &b);
        assert!((c[0] - 2.0).abs() < 1e-12 && (c[1] + 2.0 * c[2] - 3.0).abs() < 1e-12);
    }
}
