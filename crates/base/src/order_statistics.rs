//! Medians and quantiles of a sample.

/// Median absolute deviation of a standard normal distribution, inverted.
pub const MAD_TO_SIGMA: f64 = 1.482_602_218_505_602;

/// Median, the mean of the two in the middle; NaN of none. What is not finite is left out.
pub fn median(values: &[f64]) -> f64 {
    let sorted = finite_sorted(values);
    let below = sorted.get(sorted.len().saturating_sub(1) / 2);
    let above = sorted.get(sorted.len() / 2);
    below
        .zip(above)
        .map_or(f64::NAN, |(a, b)| f64::midpoint(*a, *b))
}

/// Upper one of the two in the middle, so always one of the values; NaN of none. The values are reordered.
pub fn upper_median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Value below which a share of them lies, straight between neighbours (Hyndman & Fan 1996, definition 7);
/// NaN of none. What is not finite is left out.
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let sorted = finite_sorted(values);
    let at = share * sorted.len().saturating_sub(1) as f64;
    let (low, part) = (at.floor() as usize, at.fract());
    let Some(&below) = sorted.get(low) else {
        return f64::NAN;
    };
    let above = sorted.get(low + 1).copied().unwrap_or(below);
    below + part * (above - below)
}

fn finite_sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(&[3.0, f64::NAN, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), 2.5);
        assert_eq!(median(&[7.0]), 7.0);
        assert!(median(&[]).is_nan());
    }

    #[test]
    fn upper_medians() {
        assert_eq!(upper_median(&mut [4.0, 1.0, 2.0, 3.0]), 3.0);
        assert_eq!(upper_median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert!(upper_median(&mut []).is_nan());
    }

    #[test]
    fn quantiles_between_values() {
        let values = [4.0, 1.0, 2.0, 3.0, f64::NAN];
        assert_eq!(quantile(&values, 0.5), 2.5);
        assert_eq!(quantile(&values, 0.25), 1.75);
        assert_eq!(quantile(&values, 1.0), 4.0);
        assert!(quantile(&[], 0.5).is_nan());
    }
}
