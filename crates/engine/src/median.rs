//! Medians. As `undrift_base::order_statistics`, which this crate may not depend on.
//!
//! Both are robust: up to half of the values may be anything. `upper_median` is for hot places, since it sorts nothing.

use alloc::vec::Vec;

/// Median, the mean of the two in the middle; ignores values that are not finite, NaN without any.
pub(crate) fn median(values: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let below = sorted.get(sorted.len().saturating_sub(1) / 2);
    let above = sorted.get(sorted.len() / 2);
    below
        .zip(above)
        .map_or(f64::NAN, |(a, b)| f64::midpoint(*a, *b))
}

/// Upper one of the two in the middle, so always one of the values; NaN without any. The values are reordered.
pub(crate) fn upper_median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(&[3.0, f64::NAN, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(&[]).is_nan());
        assert_eq!(upper_median(&mut [4.0, 1.0, 2.0, 3.0]), 3.0);
        assert!(upper_median(&mut []).is_nan());
    }
}
