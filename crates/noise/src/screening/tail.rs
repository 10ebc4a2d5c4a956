//! How far the noise itself reaches: the tail of Student's t that the bulk of the samples follows.
//!
//! Ratios of quantiles to the median give the degrees of freedom, the lightest tail of all counts, and the
//! bound is where that distribution leaves a thousandth of a sample of the whole record. Normal noise keeps the
//! caller's threshold.
//!
//! Why: a rule of eight robust standard deviations, the default, takes samples of heavy-tailed noise
//! for outliers, 3 in 1000 of a t distribution with 3 degrees of freedom, and the white noise that is
//! then fitted is too small. Outliers do not pass for a tail: a few of them reach the outer
//! quantiles only, and the lightest of the four tails counts.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Shares of the samples beyond the quantiles that are looked at. Outliers reach the outer ones only, so that
/// the lightest tail of all counts: heavy tails show at each.
const SHARES: [f64; 4] = [0.1, 0.03, 0.01, 0.003];
/// Fewest samples beyond a quantile.
const FEWEST: f64 = 30.0;
/// Samples beyond the bound that are expected of a whole record.
const EXPECTED: f64 = 1e-3;
/// 1/ν below which a tail is that of normal noise, and the largest tried.
const LIGHT: f64 = 0.02;
const HEAVY: f64 = 0.5;

/// The distance from the median that noise of these absolute distances does not reach, `least` or more.
///
/// `distances` are |x − median| \[unit\] and are reordered; `least` \[unit\] is the caller's
/// threshold and what is returned for normal noise, few samples, or a median distance of zero.
pub(super) fn bound(mut distances: Vec<f64>, least: f64) -> f64 {
    if distances.is_empty() {
        return least;
    }
    let n = distances.len() as f64;
    let mut quantile = |beyond: f64| {
        let at = (distances.len() - 1).min((n * (1.0 - beyond)) as usize);
        *distances.select_nth_unstable_by(at, f64::total_cmp).1
    };
    let median = quantile(0.5);
    if median.is_nan() || median <= 0.0 {
        return least;
    }
    let mut lightest = HEAVY;
    for share in SHARES.into_iter().filter(|share| share * n >= FEWEST) {
        lightest = lightest.min(inverse_freedom(quantile(share) / median, share));
        if lightest <= LIGHT {
            return least;
        }
    }
    let scale = median / quantile_of(lightest, 0.5);
    least.max(scale * quantile_of(lightest, EXPECTED / n))
}

/// 1/ν of the t distribution in which the quantile that `share` lie beyond is `ratio` times the median.
///
/// Bisection on 1/ν from 0 (normal) to 1/2, to 20 binary digits.
fn inverse_freedom(ratio: f64, share: f64) -> f64 {
    let ratio_of = |inverse: f64| quantile_of(inverse, share) / quantile_of(inverse, 0.5);
    let (mut low, mut high) = (0.0, HEAVY);
    if ratio <= ratio_of(LIGHT) {
        return 0.0;
    }
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if ratio_of(middle) < ratio {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The absolute value that a t variable of ν = 1/`inverse` exceeds with probability `beyond`.
fn quantile_of(inverse: f64, beyond: f64) -> f64 {
    if inverse < 1e-4 {
        return -Normal::standard().inverse_cdf(0.5 * beyond);
    }
    let Ok(t) = StudentsT::new(0.0, 1.0, 1.0 / inverse) else {
        return f64::INFINITY;
    };
    // By bisection of the tail's logarithm: the library's own inverse loses the far tail.
    let (mut low, mut high) = (1e-3f64.ln(), 1e15f64.ln());
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if 2.0 * t.sf(middle.exp()) > beyond {
            low = middle;
        } else {
            high = middle;
        }
    }
    (0.5 * (low + high)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The quantiles of a t distribution in place of a sample of it: what is estimated is then exact but for the grid.
    fn ideal(freedom: f64, n: usize) -> Vec<f64> {
        let at = |k: usize| quantile_of(1.0 / freedom, (k as f64 + 0.5) / n as f64);
        (0..n).map(at).collect()
    }

    #[test]
    fn the_bound_is_the_quantile_of_the_tail() {
        // ν = 2: t = 2u √(2/(1 − 4u²)), u = ½ − p/2 (closed form), P(|t| > 2.92) = 0.1.
        let closed = |p: f64| {
            let u = 0.5 - 0.5 * p;
            2.0 * u * (2.0 / (1.0 - 4.0 * u * u)).sqrt()
        };
        for p in [0.5, 0.1, 1e-6] {
            assert!((quantile_of(0.5, p) / closed(p) - 1.0).abs() < 1e-6);
        }
        for freedom in [3.0, 5.0] {
            let n = 2000;
            let expected = quantile_of(1.0 / freedom, EXPECTED / n as f64);
            let found = bound(ideal(freedom, n), 8.0);
            // One place of 60 at the outermost quantile moves it by 1/(60 ν), and the bound by the tail's ten times that.
            assert!(
                (found / expected).ln().abs() < 0.2,
                "{freedom}: {found} {expected}"
            );
        }
        // Normal noise, a hundredth of it outliers or not.
        let mut normal: Vec<f64> = (0..2000)
            .map(|k| quantile_of(0.0, (k as f64 + 0.5) / 2000.0))
            .collect();
        assert_eq!(bound(normal.clone(), 8.0), 8.0);
        normal[..20].fill(1e3);
        assert_eq!(bound(normal, 8.0), 8.0);
        assert_eq!(bound(vec![0.0; 100], 8.0), 8.0);
        assert_eq!(bound(Vec::new(), 8.0), 8.0);
    }

    #[test]
    fn the_freedom_of_a_tail_is_found_back() {
        for share in SHARES {
            for inverse in [0.05, 0.1, 0.25, 0.45] {
                let ratio = quantile_of(inverse, share) / quantile_of(inverse, 0.5);
                // Twenty halvings of ½.
                assert!((inverse_freedom(ratio, share) - inverse).abs() < 1e-6);
            }
            let ratio_of = |inverse| quantile_of(inverse, share) / quantile_of(inverse, 0.5);
            assert_eq!(inverse_freedom(ratio_of(0.99 * LIGHT), share), 0.0);
            assert!(inverse_freedom(ratio_of(1.01 * LIGHT), share) > LIGHT);
            assert!((inverse_freedom(1e6, share) - HEAVY).abs() < 1e-6);
        }
    }

    #[test]
    fn the_bound_scales_with_the_samples_and_grows_with_their_number_and_weight() {
        let of = |freedom, n, scale: f64| {
            let distances = ideal(freedom, n).into_iter().map(|x| scale * x);
            bound(distances.collect(), 0.0)
        };
        for freedom in [2.5, 4.0] {
            assert!((of(freedom, 2000, 7.0) / of(freedom, 2000, 1.0) - 7.0).abs() < 1e-6);
        }
        assert!(of(2.5, 2000, 1.0) > of(4.0, 2000, 1.0));
        assert!(of(4.0, 4000, 1.0) > of(4.0, 2000, 1.0));
        // Too few samples beyond any quantile: as heavy as may be.
        let few = ideal(4.0, 299);
        let heaviest = few.iter().copied().fold(0.0, f64::max);
        assert!(bound(few, 0.0) > 20.0 * heaviest);
        assert_eq!(bound(ideal(3.0, 2000), 1e9), 1e9);
    }
}
