//! Loops over rows, compiled for the processor that there is.
//!
//! Sums are kept in [`LANES`] lanes and added up outside, in order, so that a result depends on the record and
//! on whether multiply and add are fused, never on how a compiler arranges a loop or on how many cores there
//! are.
//!
//! A loop over a record is latency-bound when each step waits for the one before, as a recursion
//! does. Running sixteen independent pieces in one row hides that latency and fills the vector
//! units; [`Task`] is how such a loop is written once and compiled for both instruction sets.

/// Numbers that are computed side by side.
pub(crate) const LANES: usize = 16;

/// One row: the same place in every piece.
pub(crate) type Row = [f64; LANES];

/// A loop that is compiled twice: for every processor, and for those with 256-bit vectors and
/// fused multiply-add, where they are found at run time. The two differ by rounding.
///
/// Implement `run` with `#[inline(always)]` and no calls that are not inlined: only code that ends
/// up inside of the outer function is compiled for the wide instructions.
pub(crate) trait Task {
    /// What the loop returns, lanes not yet added.
    type Output;
    /// `FUSED`: multiply and add with one rounding (`f64::mul_add`).
    fn run<const FUSED: bool>(self) -> Self::Output;
}

/// Runs a task with the widest instructions that the processor has. The check is cached by the
/// library; a call costs a branch, so tasks should be blocks, not rows.
pub(crate) fn vectorised<T: Task>(task: T) -> T::Output {
    #[cfg(target_arch = "x86_64")]
    {
        struct Fused<T>(T);
        impl<T: Task> pulp::NullaryFnOnce for Fused<T> {
            type Output = T::Output;
            #[inline(always)]
            fn call(self) -> T::Output {
                self.0.run::<true>()
            }
        }
        if let Some(avx2) = pulp::x86::V3::try_new() {
            return avx2.vectorize(Fused(task));
        }
    }
    // Part of the base instructions of 64-bit ARM.
    task.run::<{ cfg!(target_arch = "aarch64") }>()
}

/// Sum over the lanes. Not to be done inside a task: the compiler would arrange the lanes for it.
pub(super) fn total(row: Row) -> f64 {
    row.iter().sum()
}

/// `sum += a b`, lane by lane.
#[inline(always)]
pub(crate) fn multiply_add<const FUSED: bool, const L: usize>(
    sum: &mut [f64; L],
    a: f64,
    b: &[f64; L],
) {
    for l in 0..L {
        sum[l] = if FUSED {
            a.mul_add(b[l], sum[l])
        } else {
            sum[l] + a * b[l]
        };
    }
}

/// `sum += a ∘ b`, lane by lane.
#[inline(always)]
pub(super) fn add_products<const FUSED: bool>(sum: &mut Row, a: &Row, b: &Row) {
    for l in 0..LANES {
        sum[l] = if FUSED {
            a[l].mul_add(b[l], sum[l])
        } else {
            sum[l] + a[l] * b[l]
        };
    }
}
