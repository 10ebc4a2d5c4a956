//! Energies of the second differences at many averaging factors, all m in O(N log² N).
//!
//! With x the P phases (prefix sums) less a straight line, which second differences do not see,
//!
//! ```text
//! Σ_{n < P − 2m} (x[n + 2m] − 2 x[n + m] + x[n])²
//!     = Q(0, P − 2m) + 4 Q(m, P − m) + Q(2m, P) + 2 R(2m) − 8 R(m) + 4 (H(m) + T(m)),
//! ```
//!
//! `Q(a, b)` the sum of squares of x\[a\] … x[b − 1], `R(k) = Σ_n x[n] x[n + k]` over all pairs,
//! `H(m) = Σ_{n < m} x[n] x[n + m]` the pairs at lag m that are no difference's last two phases, and `T`
//! those that are no difference's first two: `H` of the record reversed. R is one correlation, H of
//! all m a triangle of pairs that is halved.
//!
//! The terms are as large as Σx², up to N / m times what is left of a random walk and worse with a
//! drifting rate: the rounding of Σx² is the error. Factors at which its bound is more than
//! [`TOLERANCE`] are short ones, and taken again on blocks of the record a few times as long as they, each
//! less a line of its own. The blocks overlap by what the longest of the factors spans, so that the starts n of
//! the blocks less those of the overlaps are those of the record. Once few are left they are
//! summed directly. So is what cannot be had otherwise: records that repeat exactly have no second
//! differences at their period, and where that is short, half of all factors are such.

use super::sliding_products::Plan;
use crate::screening::record::{mean, prefix_sums, sum_of};
use undrift_base::parallel;

/// Relative error up to which an energy is taken. The deviation has half of it, of which a record's
/// chance is at least 1 / √(2N): 10⁵ times as much at 10⁸ samples.
const TOLERANCE: f64 = 1e-9;

/// Bound of the rounding of an energy, in units of ε log2(length of the FFT) Σx². An FFT of a power of
/// two is in the mean over its outputs off by at most 3.4 ε log2(length) of their norm (Higham, Accuracy
/// and Stability of Numerical Algorithms, 2nd edition, theorem 24.2, with twiddles to the last place),
/// three follow one another, and what is seen is far less, for errors have either sign. This is 3.4 times
/// the largest error of any factor of the records in the tests below, mostly that of the sums of squares;
/// the same records of 8 million samples have a third of that.
const ROUNDING: f64 = 8.0;

/// Time of the FFTs for a phase and squared octave of the largest factor, in that of a term of a
/// direct sum: 0.7 to 2 were measured from 100 000 to 20 million samples.
const FFT_COST: f64 = 1.5;

/// Length of the blocks in their largest factor.
const BLOCK: usize = 16;

/// The energies that the phases `sums` have at `factors`, all with 1 ≤ m and 2m < phases; `direct`
/// gives one of them. Whatever is cheaper, within [`TOLERANCE`].
pub(super) fn energies(
    sums: &[f64],
    factors: &[usize],
    direct: impl Fn(usize) -> f64 + Sync,
) -> Vec<f64> {
    let mut energies = vec![0.0; factors.len()];
    let mut open: Vec<usize> = (0..factors.len()).collect();
    let mut strays = Vec::new();
    let mut longest = usize::MAX;
    loop {
        let limit = open.iter().map(|&k| factors[k]).max().unwrap_or(1);
        let terms: f64 = open
            .iter()
            .map(|&k| (sums.len() - 2 * factors[k]) as f64)
            .sum();
        if terms <= FFT_COST * sums.len() as f64 * (2.0 * limit as f64).log2().powi(2) {
            break;
        }
        longest = (BLOCK * limit).min(longest).min(sums.len());
        let found = pass(sums, limit, longest);
        open.retain(|&k| {
            let m = factors[k];
            let energy = found.energy(m);
            if let Some(energy) = energy {
                energies[k] = energy;
            } else if 2 * BLOCK * m > longest {
                strays.push(k);
                return false;
            }
            energy.is_none()
        });
    }
    strays.append(&mut open);
    let summed = parallel::map(strays.len(), |k| direct(factors[strays[k]]));
    for (&k, energy) in strays.iter().zip(summed) {
        energies[k] = energy;
    }
    energies
}

/// Energies by FFT, and what bounds their errors.
struct Energies {
    /// Energies at m = 0, 1, …
    energies: Vec<f64>,
    /// Bound of the error by rounding in the FFTs.
    rounding: f64,
    /// Sum of the phases' squares before the lines were taken off.
    squares: f64,
}

impl Energies {
    /// Adds `sign` times the energies of other blocks, and their bounds.
    fn add(&mut self, other: &Self, sign: f64) {
        for (sum, energy) in self.energies.iter_mut().zip(&other.energies) {
            *sum += sign * energy;
        }
        self.rounding += other.rounding;
        self.squares += other.squares;
    }

    /// The energy at m where it is within the tolerance.
    fn energy(&self, m: usize) -> Option<f64> {
        let energy = *self.energies.get(m)?;
        // Taking off a line rounds each phase thrice, e together: Σ (a + b)² − Σ a² where b, the second
        // differences of e, is 4 |e| at most.
        let line = 2.0 * f64::EPSILON * self.squares.sqrt();
        let error = self.rounding + 8.0 * line * energy.max(0.0).sqrt();
        // Outside, squares underflow or overflow.
        let sound = (1e-300..1e280).contains(&self.rounding);
        (sound && error <= TOLERANCE * energy).then_some(energy)
    }
}

/// The energies up to `limit` of blocks of `length` phases, which overlap by what `limit` spans, less
/// those of the overlaps.
fn pass(sums: &[f64], limit: usize, length: usize) -> Energies {
    let overlap = 2 * limit + 1;
    let plan = Plan::new(length, limit);
    if length >= sums.len() {
        return record(sums, &plan);
    }
    let starts: Vec<usize> = (0..sums.len() - overlap)
        .step_by(length - overlap)
        .collect();
    let one = |k: usize| {
        let start = starts[k];
        let end = sums.len().min(start + length);
        let mut found = record(&sums[start..end], &plan);
        if end < sums.len() {
            found.add(&record(&sums[end - overlap..end], &plan), -1.0);
        }
        found
    };
    let mut total = Energies {
        energies: vec![0.0; limit + 1],
        rounding: 0.0,
        squares: 0.0,
    };
    let blocks = parallel::map(starts.len(), one);
    blocks.iter().for_each(|found| total.add(found, 1.0));
    total
}

/// The energies up to `limit` of one record or block.
fn record(sums: &[f64], plan: &Plan) -> Energies {
    undrift_base::interrupt::check();
    let (mut x, squares) = less_line(sums);
    let whole = plan.whole(&x);
    let mut ends = Vec::new();
    plan.heads(&x, &mut ends);
    x.reverse();
    plan.heads(&x, &mut ends);
    x.iter_mut().for_each(|x| *x *= *x);
    // Of the reversed record: the squares stand alike at both ends.
    let squared = prefix_sums(&x, 0.0);
    let last = x.len();
    let mut energies = ends;
    for (m, energy) in energies.iter_mut().enumerate() {
        let outer = squared[last - 2 * m] + (squared[last] - squared[2 * m]);
        let inner = squared[last - m] - squared[m];
        *energy = outer + 2.0 * whole[2 * m] + 4.0 * (inner - 2.0 * whole[m] + *energy);
    }
    let octaves = (plan.longest() as f64).log2();
    Energies {
        energies,
        rounding: ROUNDING * f64::EPSILON * octaves * squared[last],
        squares,
    }
}

/// The phases less the straight line of least squares, and the sum of squares about their mean.
fn less_line(sums: &[f64]) -> (Vec<f64>, f64) {
    let centre = mean(sums);
    let mut x: Vec<f64> = sums.iter().map(|x| x - centre).collect();
    let squares = sum_of(&x, |x| x * x);
    let middle = 0.5 * (x.len() - 1) as f64;
    let (mut above, mut below) = (0.0, 0.0);
    for (i, x) in x.iter().enumerate() {
        let t = i as f64 - middle;
        above += t * x;
        below += t * t;
    }
    let slope = above / below;
    for (i, x) in x.iter_mut().enumerate() {
        *x -= slope * (i as f64 - middle);
    }
    (x, squares)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Phases of white noise, a random walk and a ramp, of so much a sample, in steps.
    fn phases(samples: usize, white: f64, walk: f64, ramp: f64, step: f64) -> Vec<f64> {
        let mut generator = Xoshiro256PlusPlus::seed_from_u64(7);
        let mut normal = || -> f64 { StandardNormal.sample(&mut generator) };
        let mut bias = 0.0;
        let mut rates = vec![0.0; samples];
        for (k, rate) in rates.iter_mut().enumerate() {
            bias += walk * normal() + ramp;
            *rate = bias + white * normal() + 1e-3 * (k as f64 * 0.1).sin();
            if step > 0.0 {
                *rate = (*rate / step).round() * step;
            }
        }
        prefix_sums(&rates, mean(&rates))
    }

    fn direct(x: &[f64], m: usize) -> f64 {
        let second = |n: usize| (x[n + 2 * m] - x[n + m]) - (x[n + m] - x[n]);
        let seconds: Vec<f64> = (0..x.len() - 2 * m).map(second).collect();
        sum_of(&seconds, |d| d * d)
    }

    fn kinds(samples: usize) -> [(&'static str, Vec<f64>); 5] {
        let slope = 1.0 / samples as f64;
        [
            ("white", phases(samples, 1.0, 0.0, 0.0, 0.0)),
            ("walk", phases(samples, 0.0, 1.0, 0.0, 0.0)),
            ("ramp", phases(samples, 0.0, 0.0, 1.0, 0.0)),
            ("mixed", phases(samples, 1.0, 1e-3, slope, 0.0)),
            ("quantised", phases(samples, 0.3, 0.0, 0.0, 1.0)),
        ]
    }

    #[test]
    fn rounding_stays_below_a_third_of_its_bound() {
        for samples in [2, 3, 4, 5, 64, 257, 1031, 2000, 20_011] {
            for (name, x) in kinds(samples) {
                let mut ways = vec![(samples / 2, x.len())];
                // Blocks, the last of them of every kind of length.
                if samples > 1000 {
                    ways.extend([1, 2, 3, 4, 5].map(|k| (30 + k, samples / 4 - 7 * k)));
                }
                for (limit, length) in ways {
                    let found = pass(&x, limit, length);
                    for m in (1..=limit).step_by(1 + limit / 1000) {
                        let error = (found.energies[m] - direct(&x, m)).abs();
                        // 0.29 at most here; the reference has some of it.
                        assert!(
                            error <= 0.34 * found.rounding,
                            "{samples} {name}, {length}, {m}: {} of the bound",
                            error / found.rounding
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn every_factor_is_within_the_tolerance_and_hardly_any_is_summed_directly() {
        let samples = 20_000;
        let factors: Vec<usize> = (1..=samples / 2).collect();
        for (name, x) in kinds(samples) {
            let calls = AtomicUsize::new(0);
            let found = energies(&x, &factors, |m| {
                calls.fetch_add(1, Ordering::Relaxed);
                direct(&x, m)
            });
            for (&m, energy) in factors.iter().zip(found).step_by(7) {
                let exact = direct(&x, m);
                let error = (energy - exact).abs() / exact;
                assert!(error <= TOLERANCE, "{name}, {m}: {error}");
            }
            // By FFT over the whole record a ramp would have 2 % of them, 200, summed directly.
            let calls = calls.into_inner();
            assert!(calls <= 150, "{name}: {calls} of them directly");
            if name == "ramp" {
                assert!(pass(&x, samples / 2, x.len()).energy(100).is_none());
                assert!(calls > 0);
            }
        }
    }

    #[test]
    fn what_repeats_has_its_exact_zeros_and_large_and_small_units_their_values() {
        let rates: Vec<f64> = (0..4000).map(|k| f64::from(k % 2)).collect();
        let x = prefix_sums(&rates, 0.5);
        let factors: Vec<usize> = (1..=2000).collect();
        let found = energies(&x, &factors, |m| direct(&x, m));
        for (&m, &energy) in factors.iter().zip(&found) {
            // e_m(t + m) − e_m(t) is 0 at even m, ±1 at odd ones.
            let exact = if m % 2 == 0 {
                0.0
            } else {
                (4001 - 2 * m) as f64
            };
            assert!((energy - exact).abs() <= TOLERANCE * exact, "{m}: {energy}");
        }
        for scale in [1e-170, 1e-150, 1e140, 1e148] {
            let scaled: Vec<f64> = phases(4000, scale, 0.0, 0.0, 0.0);
            let found = energies(&scaled, &factors, |m| direct(&scaled, m));
            for (&m, energy) in factors.iter().zip(found) {
                let exact = direct(&scaled, m);
                let same = energy == exact || (energy - exact).abs() <= TOLERANCE * exact;
                assert!(same, "{scale}, {m}: {energy} for {exact}");
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn any_record_and_list_of_factors_is_within_the_tolerance(
            rates in proptest::collection::vec(-1.0..1.0f64, 1000..3000),
            drift in -1.0..1.0f64,
            stride in 1..3usize,
        ) {
            let drifting = rates.iter().enumerate().map(|(k, rate)| rate + drift * k as f64);
            let rates: Vec<f64> = drifting.collect();
            let x = prefix_sums(&rates, mean(&rates));
            let factors: Vec<usize> = (1..=rates.len() / 2).rev().step_by(stride).collect();
            let found = energies(&x, &factors, |m| direct(&x, m));
            for (&m, energy) in factors.iter().zip(found) {
                let exact = direct(&x, m);
                prop_assert!((energy - exact).abs() <= TOLERANCE * exact, "{}: {} for {}", m, energy, exact);
            }
        }
    }
}
