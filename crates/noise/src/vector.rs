//! Loops over rows, compiled for the processor that there is.
//!
//! Sums are kept in [`LANES`] lanes and added up outside, in order, so that a result depends on the record and
//! on whether multiply and add are fused, never on how a compiler arranges a loop or on how many cores there
//! are.

/// Numbers that are computed side by side.
pub(crate) const LANES: usize = 16;

/// One row: the same place in every piece.
pub(crate) type Row = [f64; LANES];

/// A loop that is compiled twice: for every processor, and for those with 256-bit vectors and
/// fused multiply-add, where they are found at run time. The two differ by rounding.
pub(crate) trait Task {
    type Output;
    fn run<const FUSED: bool>(self) -> Self::Output;
}

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
