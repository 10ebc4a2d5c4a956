//! Energies of the second differences at many averaging factors, in O(N log² N) for all of them.
//!
//! With x the P phases (prefix sums) less a straight line, which second differences do not see,
//!
//! `Σ_{n < P − 2m} (x[n + 2m] − 2 x[n + m] + x[n])²`
//! `  = Q(0, P − 2m) + 4 Q(m, P − m) + Q(2m, P) + 2 R(2m) − 8 R(m) + 4 (H(m) + T(m))`,
//!
//! `Q(a, b)` the sum of squares of x[a] … x[b − 1], `R(k) = Σ_n x[n] x[n + k]` over all pairs,
//! `H(m) = Σ_{n < m} x[n] x[n + m]` the pairs at lag m that no second difference has as its second and
//! third phase, and `T` those it has not as its first and second: H of the record reversed. R is
//! one correlation; H of all m a triangle of pairs, cut in halves.
//!
//! The terms are as large as Σx², and of a random walk that is up to N / m times their sum: what is
//! left is off by the rounding of Σx². Where the bound of that is more than [`TOLERANCE`] of the
//! sum, it is done again on overlapping blocks of the record, each less a line of its own, few
//! times as long as the factors that are left; the starts n of the blocks, less those of the
//! overlaps, are those of the record. What is still beyond the bound, and a handful of factors from the
//! start, is summed directly.

use super::sliding_products::Plan;
use crate::screening::record::{mean, prefix_sums, sum_of};
use rayon::prelude::*;

/// Relative error up to which an energy is taken; the deviation's is half of it.
const TOLERANCE: f64 = 1e-9;

/// Bound of the rounding of an energy by FFT, in units of ε log2(length of the FFT) Σx².
const ROUNDING: f64 = 8.0;

/// Time of the FFTs a phase and squared octave of the largest factor, in that of a term of a direct
/// sum.
const FFT_COST: f64 = 1.0;

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
        let limit = open.iter().map(|&k| factors[k]).max().unwrap_or(0);
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
    let summed: Vec<f64> = strays.par_iter().map(|&k| direct(factors[k])).collect();
    for (&k, energy) in strays.iter().zip(summed) {
        energies[k] = energy;
    }
    energies
}

/// Energies by FFT, and what bounds their errors.
struct Found {
    /// At m = 0, 1, …
    energies: Vec<f64>,
    /// Bound of the error by rounding in the FFTs.
    rounding: f64,
    /// Sum of the phases' squares before the lines were taken off.
    squares: f64,
}

impl Found {
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
        (error <= TOLERANCE * energy).then_some(energy)
    }
}

/// The energies up to `limit` of blocks of `length` phases, which overlap by what `limit` spans, less
/// those of the overlaps.
fn pass(sums: &[f64], limit: usize, length: usize) -> Found {
    let overlap = 2 * limit + 1;
    let plan = Plan::new(length, limit);
    if length >= sums.len() {
        return record(sums, &plan);
    }
    let starts: Vec<usize> = (0..sums.len() - overlap)
        .step_by(length - overlap)
        .collect();
    let one = |&start: &usize| {
        let end = sums.len().min(start + length);
        let mut found = record(&sums[start..end], &plan);
        if end < sums.len() {
            found.add(&record(&sums[end - overlap..end], &plan), -1.0);
        }
        found
    };
    let mut total = Found {
        energies: vec![0.0; limit + 1],
        rounding: 0.0,
        squares: 0.0,
    };
    let blocks: Vec<Found> = starts.par_iter().map(one).collect();
    blocks.iter().for_each(|found| total.add(found, 1.0));
    total
}

/// The energies up to `limit` of one record or block.
fn record(sums: &[f64], plan: &Plan) -> Found {
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
    Found {
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
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// Phases of white noise with a random walk and a ramp of so much a sample, in steps.
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

    #[test]
    fn measure_rounding() {
        for samples in [2000, 20_000, 100_000] {
            for (name, x) in [
                ("white", phases(samples, 1.0, 0.0, 0.0, 0.0)),
                ("walk", phases(samples, 0.0, 1.0, 0.0, 0.0)),
                ("ramp", phases(samples, 0.0, 0.0, 1.0, 0.0)),
                (
                    "mixed",
                    phases(samples, 1.0, 1e-3, 1.0 / samples as f64, 0.0),
                ),
                ("quantised", phases(samples, 0.3, 0.0, 0.0, 1.0)),
            ] {
                for length in [usize::MAX, samples / 4] {
                    let length = length.min(x.len());
                    let limit = (x.len() - 1).min(length.max(32)) / 2;
                    let limit = if length < x.len() { limit / 8 } else { limit };
                    let found = pass(&x, limit, length);
                    let (mut worst, mut first, mut at, mut open) = (0f64, 0f64, 0, 0);
                    let step = (limit / 2000).max(1);
                    for m in (1..limit + 1).step_by(step) {
                        let e = (found.energies[m] - direct(&x, m)).abs() / found.rounding;
                        if e > worst {
                            worst = e;
                            at = m;
                        }
                        if m < 20 {
                            first = first.max(e);
                        }
                        if found.energy(m).is_none() {
                            open = m;
                        }
                    }
                    println!(
                        "{samples} {name} {length} {limit}: worst {worst:.3} at {at}, open to {open}"
                    );
                }
            }
        }
    }
}
