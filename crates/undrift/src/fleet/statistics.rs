//! Numbers of many logs against each other, robust to a few that are far off.

use undrift_noise::order_statistics::median;

/// A value is an outlier from so many robust standard deviations of the logarithm above the median …
pub const OUTLIER_DEVIATIONS: f64 = 5.0;
/// … if it is above the median by this share too, …
pub const OUTLIER_SHARE: f64 = 0.1;
/// … among so many values or more: of fewer the median absolute deviation tells little.
pub const OUTLIER_LEAST: usize = 8;
/// Standard deviation of a normal distribution over its median absolute deviation.
const NORMAL: f64 = 1.4826;

/// Value above which one is an outlier. Drifts and noises scatter by factors rather than by sums, so the
/// rule is on their logarithms: the median plus [`OUTLIER_DEVIATIONS`] × 1.4826 median absolute deviations,
/// or [`OUTLIER_SHARE`] above the median where that is more. What is not positive is left out; `None` of
/// fewer than [`OUTLIER_LEAST`] values.
pub fn outlier_limit(values: &[f64]) -> Option<f64> {
    let positive = values.iter().filter(|v| v.is_finite() && **v > 0.0);
    let logarithms: Vec<f64> = positive.map(|v| v.ln()).collect();
    if logarithms.len() < OUTLIER_LEAST {
        return None;
    }
    let middle = median(&logarithms);
    let deviations: Vec<f64> = logarithms.iter().map(|v| (v - middle).abs()).collect();
    let robust = NORMAL * median(&deviations);
    Some((middle + (OUTLIER_DEVIATIONS * robust).max(OUTLIER_SHARE.ln_1p())).exp())
}

/// Spearman's rank correlation of pairs, and what its magnitude stays below 19 times out of 20 where
/// there is none, 1.96/√(n − 1). `None` of fewer than [`OUTLIER_LEAST`] pairs, or where one never changes.
pub fn rank_correlation(pairs: &[(f64, f64)]) -> Option<(f64, f64)> {
    if pairs.len() < OUTLIER_LEAST {
        return None;
    }
    let (x, y): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
    let (x, y) = (ranks(&x), ranks(&y));
    let middle = 0.5 * (pairs.len() as f64 + 1.0);
    let sum = |a: &[f64], b: &[f64]| -> f64 {
        let products = a.iter().zip(b).map(|(a, b)| (a - middle) * (b - middle));
        products.sum()
    };
    let squares = sum(&x, &x) * sum(&y, &y);
    let bound = 1.96 / (pairs.len() as f64 - 1.0).sqrt();
    (squares > 0.0).then(|| (sum(&x, &y) / squares.sqrt(), bound))
}

/// Ranks from 1; equal values share theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = |value: &f64| {
        let below = sorted.partition_point(|v| v.total_cmp(value).is_lt());
        let up_to = sorted.partition_point(|v| v.total_cmp(value).is_le());
        0.5 * (below + 1 + up_to) as f64
    };
    values.iter().map(rank).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outliers_stand_out_of_the_rest() {
        // Logarithms 1 to 9: median 5, median absolute deviation 2, limit 5 + 5·1.4826·2.
        let mut values: Vec<f64> = (1..10).map(|k| f64::from(k).exp()).collect();
        let limit = outlier_limit(&values).unwrap();
        // A few roundings of the logarithm and the exponential.
        assert!((limit.ln() - 19.826).abs() < 1e-12, "{limit}");
        // However far off one is, the limit stays.
        values[8] = 1e300;
        assert_eq!(outlier_limit(&values), Some(limit));
        // What is no number or not positive does not count.
        values.extend([f64::NAN, 0.0, -1.0]);
        assert_eq!(outlier_limit(&values), Some(limit));
        // Equal values: a tenth more is another.
        assert!((outlier_limit(&[2.0; 8]).unwrap() - 2.2).abs() < 1e-12);
        assert_eq!(outlier_limit(&[2.0; 7]), None);
        assert_eq!(outlier_limit(&[f64::NAN; 20]), None);
    }

    #[test]
    fn correlation_of_ranks() {
        // From scipy.stats.spearmanr, 1.17.1.
        let x = [20.1, 25.0, 25.0, 31.2, 38.4, 44.9, 50.3, 60.0];
        let y = [1.1, 0.9, 1.3, 1.2, 1.9, 1.9, 1.7, 2.6];
        let pairs: Vec<_> = x.into_iter().zip(y).collect();
        let (correlation, bound) = rank_correlation(&pairs).unwrap();
        assert!(
            (correlation - 0.843_373_493_975_903_7).abs() < 1e-12,
            "{correlation}"
        );
        assert!((bound - 1.96 / 7f64.sqrt()).abs() < 1e-15);
        assert_eq!(rank_correlation(&pairs[1..]), None);
        let flat: Vec<_> = y.into_iter().map(|y| (25.0, y)).collect();
        assert_eq!(rank_correlation(&flat), None);
    }
}
