//! Distance between the empirical distribution of samples and a normal one, without sorting them all.
//!
//! Samples are counted in bins. The bin's count and its least and largest sample bound the distance inside it from
//! above, and are distances that occur; only bins that may hold a larger one than all of these are sorted.
//! The result is that of sorting everything.

use crate::stationarity::mackinnon::normal_cdf;

/// Bins, and samples to a bin at least.
const BINS: usize = 1 << 16;
const EACH: usize = 16;

/// Samples of one bin.
#[derive(Clone, Copy)]
struct Bin {
    count: usize,
    least: f64,
    largest: f64,
}

/// Largest distance between the empirical distribution and the normal one of this `mean` and `deviation` \[unit\].
/// Equal samples are evaluated once.
///
/// `x` must be finite and not constant.
pub(super) fn distance(x: &[f64], mean: f64, deviation: f64) -> f64 {
    let count = x.len() as f64;
    let expected = |value: f64| normal_cdf((value - mean) / deviation);
    let (low, high) = x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |of, v| {
        (of.0.min(*v), of.1.max(*v))
    });
    let number = (x.len() / EACH).clamp(1, BINS);
    let scale = number as f64 / (high - low);
    // Grows with the sample, whatever the rounding.
    let bin_of = |value: f64| (((value - low) * scale) as usize).min(number - 1);
    let empty = Bin {
        count: 0,
        least: f64::INFINITY,
        largest: f64::NEG_INFINITY,
    };
    let mut bins = vec![empty; number];
    for &value in x {
        let bin = &mut bins[bin_of(value)];
        bin.count += 1;
        bin.least = bin.least.min(value);
        bin.largest = bin.largest.max(value);
    }
    let (mut distance, mut below) = (0.0f64, 0);
    // Samples below each bin, and the most that the distance inside it may be.
    let mut bounds = Vec::with_capacity(number);
    for bin in bins.iter().filter(|bin| bin.count > 0) {
        let (start, end) = (below as f64 / count, (below + bin.count) as f64 / count);
        let (first, last) = (expected(bin.least), expected(bin.largest));
        distance = distance.max(first - start).max(end - last);
        bounds.push((bin_of(bin.least), below, (last - start).max(end - first)));
        below += bin.count;
    }
    let mut starts = vec![None; number];
    for (bin, below, _) in bounds.iter().filter(|of| of.2 > distance) {
        starts[*bin] = Some(*below);
    }
    let may_be = |value: &f64| starts[bin_of(*value)].is_some();
    let mut sorted: Vec<f64> = x.iter().copied().filter(may_be).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let (mut at, mut inside) = (0, (number, 0));
    while at < sorted.len() {
        let value = sorted[at];
        let equal = sorted[at..].iter().take_while(|v| **v == value).count();
        let bin = bin_of(value);
        if inside.0 != bin {
            inside = (bin, starts[bin].unwrap_or_default());
        }
        let (start, end) = (inside.1, inside.1 + equal);
        let expected = expected(value);
        distance = distance
            .max(expected - start as f64 / count)
            .max(end as f64 / count - expected);
        inside.1 = end;
        at += equal;
    }
    distance
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// By the definition: every sample, in order.
    fn of_all(x: &[f64], mean: f64, deviation: f64) -> f64 {
        let mut sorted = x.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let share = |part: usize| part as f64 / x.len() as f64;
        let distances = sorted.iter().map(|value| {
            let below = sorted.partition_point(|other| other < value);
            let up_to = sorted.partition_point(|other| other <= value);
            let expected = normal_cdf((value - mean) / deviation);
            (expected - share(below)).max(share(up_to) - expected)
        });
        distances.fold(0.0, f64::max)
    }

    #[test]
    fn it_is_that_of_all_samples_sorted() {
        let mut generator = Xoshiro256PlusPlus::seed_from_u64(1);
        let mut uniform = || generator.random::<f64>();
        for samples in [5, 31, 33, 1000, 20_000] {
            let sum: Vec<f64> = (0..samples)
                .map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0)
                .collect();
            let rounded = sum.iter().map(|x| (2.0 * x).round()).collect();
            let cubed = sum.iter().map(|x| x.powi(3)).collect();
            let mut apart = sum.clone();
            apart[0] = 1e9;
            for x in [sum, rounded, cubed, apart] {
                for (mean, deviation) in [(0.0, 1.0), (0.3, 2.0)] {
                    let found = distance(&x, mean, deviation);
                    assert_eq!(found, of_all(&x, mean, deviation), "{samples} {mean}");
                }
            }
        }
    }
}
