//! Rows of a covariance, combined in as many lanes as the processor has.
//!
//! A covariance is carried by rows: what the model does to a state is a sum of multiples of whole rows, whose
//! columns are independent of one another. That is what vectors of four numbers are for; the order of
//! operations is fixed, so that results do not depend on them.

use crate::shaping::AxisMatrix;
use core::ops::Range;

/// Runs `step` with vectors of four lanes where the processor has them. What is inlined into it is compiled
/// once more for them: the same operations in the same order, none fused, hence the same numbers.
#[inline(always)]
pub fn four_lanes<T>(step: impl FnOnce() -> T) -> T {
    #[cfg(all(feature = "simd", target_arch = "x86_64"))]
    if let Some(avx2) = pulp::x86::V3::try_new() {
        return avx2.vectorize(step);
    }
    step()
}

/// `to ← factor · from`, in the columns that both have.
#[inline(always)]
pub(super) fn set_row<const W: usize, const N: usize>(
    to: &mut [f64; W],
    factor: f64,
    from: &[f64; N],
) {
    for k in 0..W.min(N) {
        to[k] = factor * from[k];
    }
}

/// `to ← to + factor · from`, in the columns that both have.
#[inline(always)]
pub(super) fn add_row<const W: usize, const N: usize>(
    to: &mut [f64; W],
    factor: f64,
    from: &[f64; N],
) {
    for k in 0..W.min(N) {
        to[k] += factor * from[k];
    }
}

/// F times rows of the covariance, of an axis with `K` states; of one with fewer, nothing.
#[inline(always)]
pub(super) fn step_rows_of<const K: usize, const W: usize>(
    f: &AxisMatrix,
    rows: &mut [[f64; W]],
    columns: Range<usize>,
) {
    let Some(rows) = rows.first_chunk_mut::<K>() else {
        return;
    };
    if let [row] = rows.as_mut_slice() {
        for value in &mut row[columns] {
            *value *= f[0][0];
        }
        return;
    }
    let before = *rows;
    for i in 0..K {
        let mut moved = before[0];
        for value in &mut moved {
            *value *= f[i][0];
        }
        for j in 1..K {
            // Companion forms have few others.
            if f[i][j] != 0.0 {
                add_row(&mut moved, f[i][j], &before[j]);
            }
        }
        rows[i][columns.clone()].copy_from_slice(&moved[columns.clone()]);
    }
}
