//! What every statistic asks of a record first: length, finite values, mean and variance.
//!
//! Sums are made in eight lanes of blocks of 64 samples, and blocks are added with Neumaier's compensation: the
//! error of a mean or a variance is a few units in the last place whatever the length of the record, and the
//! same on every machine.
//!
//! Everything here treats NaN as an error: records with missing samples are bridged first
//! (`screening::bridge`) or go to the likelihoods, which know gaps. Cost O(N) each, no copies except
//! `prefix_sums`.

/// Why a statistic cannot be computed from a record.
///
/// ```
/// use undrift_noise::{allan::{DeviationKind, Grid, deviations}, screening::RecordError};
/// let curve = |x: &[f64]| deviations(x, 100.0, DeviationKind::Overlapping, Grid::Octave);
/// assert_eq!(curve(&[1.0]), Err(RecordError::TooShort { needed: 2, got: 1 }));
/// assert_eq!(curve(&[1.0, 2.0, f64::NAN]), Err(RecordError::NotFinite { index: 2 }));
/// assert!(matches!(deviations(&[1.0, 2.0], 0.0, DeviationKind::Overlapping, Grid::Octave), Err(RecordError::Argument(_))));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RecordError {
    /// Fewer samples than the statistic needs.
    #[error("too short: {got} samples, but at least {needed} are needed; record for longer")]
    TooShort {
        /// Number of samples needed.
        needed: usize,
        /// Number of samples of the record.
        got: usize,
    },
    /// A sample is NaN or infinite.
    #[error("sample {index} (from 0) is not a finite number")]
    NotFinite {
        /// Position of the first such sample, from 0.
        index: usize,
    },
    /// All samples are the same, to rounding.
    #[error("the recording is constant")]
    Constant,
    /// An argument other than the record is out of its range.
    #[error("{0}")]
    Argument(&'static str),
}

/// Length of the blocks whose sums are added up with compensation.
const BLOCK: usize = 64;

/// A running sum with Neumaier's compensation (Z. angew. Math. Mech. 54, 1974).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Compensated {
    /// The sum as rounded so far.
    sum: f64,
    /// What rounding has lost, added at the end.
    rest: f64,
}

impl Compensated {
    /// Adds one term.
    pub(crate) fn add(&mut self, term: f64) {
        let sum = self.sum + term;
        self.rest += if self.sum.abs() >= term.abs() {
            (self.sum - sum) + term
        } else {
            (term - sum) + self.sum
        };
        self.sum = sum;
    }

    /// The sum.
    pub(crate) fn value(self) -> f64 {
        self.sum + self.rest
    }
}

/// Sum of `f` over the samples, in eight lanes of short blocks: exact to a few units in the last
/// place of Σ|f|, whatever the length.
///
/// The bound of a plain loop is N ε of Σ|f|: 1e-9 for 10⁷ samples.
pub(crate) fn sum_of(x: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    let mut total = Compensated::default();
    for block in x.chunks(BLOCK) {
        let (eights, tail) = block.as_chunks::<8>();
        let mut lanes = [0.0; 8];
        for eight in eights {
            for (lane, &value) in lanes.iter_mut().zip(eight) {
                *lane += f(value);
            }
        }
        total.add(lanes.iter().sum::<f64>() + tail.iter().map(|&v| f(v)).sum::<f64>());
    }
    total.value()
}

/// Dot product in eight lanes, of slices of one length.
///
/// Without compensation: for short slices.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a8, a_tail), (b8, b_tail)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut lanes = [0.0; 8];
    for (a, b) in a8.iter().zip(b8) {
        for i in 0..8 {
            lanes[i] += a[i] * b[i];
        }
    }
    lanes.iter().sum::<f64>() + a_tail.iter().zip(b_tail).map(|(a, b)| a * b).sum::<f64>()
}

/// Mean of a record [its unit]; 0 of an empty one.
pub(crate) fn mean(x: &[f64]) -> f64 {
    if x.is_empty() {
        0.0
    } else {
        sum_of(x, |v| v) / x.len() as f64
    }
}

/// Mean and sum of squared deviations from it [unit, unit²].
///
/// Two passes, so that a record far from zero loses no digits in its variance.
pub(crate) fn mean_and_squares(x: &[f64]) -> (f64, f64) {
    let centre = mean(x);
    let squares = sum_of(x, |v| (v - centre) * (v - centre));
    (centre, squares)
}

/// Ok where the record has `needed` samples, all of them finite.
///
/// # Errors
/// [`RecordError::TooShort`] before [`RecordError::NotFinite`], which gives the first such sample.
pub(crate) fn check(x: &[f64], needed: usize) -> Result<(), RecordError> {
    if x.len() < needed {
        return Err(RecordError::TooShort {
            needed,
            got: x.len(),
        });
    }
    match x.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(RecordError::NotFinite { index }),
        None => Ok(()),
    }
}

/// Ok where a sample rate \[Hz\] is one.
///
/// # Errors
/// [`RecordError::Argument`] for zero, negative, infinite or NaN.
pub(crate) fn check_rate(rate_hz: f64) -> Result<(), RecordError> {
    if rate_hz > 0.0 && rate_hz.is_finite() {
        return Ok(());
    }
    Err(RecordError::Argument(
        "the sample rate must be a positive number",
    ))
}

/// Does [`check`], and the record must vary by more than the rounding of its mean.
/// Gives the mean and the sum of squared deviations [unit, unit²].
///
/// # Errors
/// As [`check`]; [`RecordError::Constant`] where the standard deviation is below four roundings of
/// the mean; [`RecordError::Argument`] where squares overflow.
pub(crate) fn check_varying(x: &[f64], needed: usize) -> Result<(f64, f64), RecordError> {
    check(x, needed)?;
    let (centre, squares) = mean_and_squares(x);
    if !squares.is_finite() || !centre.is_finite() {
        return Err(RecordError::Argument("the samples are too large to square"));
    }
    let rounding = 4.0 * f64::EPSILON * centre.abs();
    if squares <= rounding * rounding * x.len() as f64 {
        return Err(RecordError::Constant);
    }
    Ok((centre, squares))
}

/// Prefix sums of the deviations from `centre`: n + 1 values, the first 0 [its unit]. Blocks are
/// summed on their own and joined with compensation, so that the error of a sum does not grow with
/// its position.
///
/// The sum of samples i to j − 1 is the difference of two entries; a mean over any window costs
/// O(1).
pub(crate) fn prefix_sums(x: &[f64], centre: f64) -> Vec<f64> {
    let mut sums = vec![0.0; x.len() + 1];
    let mut base = Compensated::default();
    for (block, out) in x.chunks(BLOCK).zip(sums[1..].chunks_mut(BLOCK)) {
        let start = base.value();
        let mut local = 0.0;
        for (slot, &value) in out.iter_mut().zip(block) {
            local += value - centre;
            *slot = start + local;
        }
        base.add(local);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_ill_conditioned_records_keep_their_digits() {
        // One large value and many small ones: a naive sum loses each of them.
        let mut x = vec![1e-3; 1_000_001];
        x[0] = 1e13;
        x.push(-1e13);
        // 1e6 · 1e-3 exactly; each of the ten-odd blocks next to the large value may round by 1e-3.
        assert!((sum_of(&x, |v| v) - 1000.0).abs() < 0.1);
    }

    #[test]
    fn prefix_sums_match_exact_integers() {
        let x: Vec<f64> = (0..1000).map(|i| f64::from(i % 17)).collect();
        let sums = prefix_sums(&x, 3.0);
        let mut exact = 0.0;
        for (i, value) in x.iter().enumerate() {
            assert_eq!(sums[i], exact);
            exact += value - 3.0;
        }
        assert_eq!(sums[1000], exact);
    }

    #[test]
    fn bad_records_are_named() {
        assert_eq!(
            check(&[1.0], 2),
            Err(RecordError::TooShort { needed: 2, got: 1 })
        );
        assert_eq!(
            check(&[1.0, f64::NAN], 2),
            Err(RecordError::NotFinite { index: 1 })
        );
        assert_eq!(check_varying(&[0.1; 100], 2), Err(RecordError::Constant));
        assert!(check_varying(&[0.1, 0.2], 2).is_ok());
    }
}
