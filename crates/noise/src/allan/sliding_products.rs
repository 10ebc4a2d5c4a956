//! Sums of products of a record with itself at every lag, by FFT.
//!
//! The one operation is a correlation of a short stretch with one twice as long: of `2L` circular
//! outputs the first `L` see no wrap. Longer stretches are cut into blocks whose spectra are added up,
//! so that no FFT is longer than [`LONGEST`]. The order of every sum is fixed by the lengths alone.
//!
//! Called by the Allan deviation at every averaging factor ([`super::deviations`] with a long list
//! of factors), with the phases (the integrated record) as x: the sums of squared second differences
//! follow from R(k) of the whole and H(m) of its heads by additions. Cost O(N log² N), memory of a
//! few blocks beside the record. Rounding is that of an FFT, relative to the mean square of x, so
//! that the caller takes a straight line off the phases first.

use crate::screening::record::dot;
use crate::transform::{Room, Transform, ZERO, add_product};
use rayon::prelude::*;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex64;

/// Longest FFT. Half of it is a fifth slower at 20 million samples, twice takes more room.
const LONGEST: usize = 1 << 20;

/// Triangles up to this width are summed directly.
const LEAF: usize = 256;

/// Samples below which work is not split between the cores.
const SHARE: usize = 1 << 14;

/// The spectra of so many parts.
///
/// In parallel; each core has a room of its own.
fn spectra<'a>(
    of: &Transform,
    count: usize,
    part: impl Fn(usize) -> &'a [f64] + Sync,
) -> Vec<Vec<Complex64>> {
    let one = |room: &mut Room, k| {
        let mut spectrum = of.empty();
        of.spectrum(part(k), room, &mut spectrum);
        spectrum
    };
    let all = (0..count).into_par_iter();
    all.map_init(|| of.room(), one).collect()
}

/// `out[j] += Σ_{i<count} x[short + i] x[long + i + j]`, zeros after the end of x; spread over the
/// cores.
fn slide(of: &Transform, x: &[f64], short: usize, count: usize, long: usize, out: &mut [f64]) {
    let block = of.block;
    let shorts = spectra(of, count.div_ceil(block), |k| {
        part(x, short + k * block, block.min(count - k * block))
    });
    let reached = x.len().saturating_sub(long).div_ceil(block);
    let longs = shorts.len() + out.len().div_ceil(block) - 1;
    let longs = spectra(of, longs.min(reached), |k| {
        part(x, long + k * block, 2 * block)
    });
    let outs = out.par_chunks_mut(block).enumerate();
    outs.for_each_init(
        || (of.room(), of.empty()),
        |(room, sum), (k, out)| {
            sum.fill(ZERO);
            for (short, long) in shorts.iter().zip(longs.iter().skip(k)) {
                add_product(sum, short, long);
            }
            of.add_samples(sum, room, out);
        },
    );
}

/// The samples from `start` on, at most `count`, as far as there are.
fn part(x: &[f64], start: usize, count: usize) -> &[f64] {
    let start = start.min(x.len());
    &x[start..(start + count).min(x.len())]
}

/// The transforms by which records are summed to one lag.
pub(super) struct Plan {
    /// Longest head, in lags.
    largest: usize,
    /// For products of the whole record.
    whole: Transform,
    /// Transforms of the levels of the triangle, the widest nodes first.
    nodes: Vec<Transform>,
    /// Width of the whole triangle, a power of two times that of its leaves.
    width: usize,
}

impl Plan {
    /// Transforms for records of `length`, heads to lag `largest`, products of the whole to twice that, which is
    /// below `length`.
    pub(super) fn new(length: usize, largest: usize) -> Self {
        Self::with_longest(length, largest, LONGEST)
    }

    /// `longest` is [`LONGEST`] but in tests, which cut small records into many blocks.
    fn with_longest(length: usize, largest: usize, longest: usize) -> Self {
        // Blocks, a power of two of them, into which a stretch is cut.
        let pieces = |length: usize| length.div_ceil(longest / 2).next_power_of_two();
        let mut planner = RealFftPlanner::new();
        let lags = (2 * largest + 1).min(length);
        let whole = Transform::new(smooth(lags.div_ceil(pieces(lags))), &mut planner);
        let width = smooth(largest + 1);
        let halves = std::iter::successors(Some(width), |w| Some(w / 2));
        let nodes = halves
            .take_while(|&w| w > LEAF)
            .map(|w| Transform::new(w / 2 / pieces(w / 2), &mut planner))
            .collect();
        Self {
            largest,
            whole,
            nodes,
            width,
        }
    }

    /// The longest FFT \[samples\].
    pub(super) fn longest(&self) -> usize {
        let nodes = self.nodes.iter().map(|t| t.block).max();
        2 * self.whole.block.max(nodes.unwrap_or(0))
    }

    /// `R(k) = Σ_n x[n] x[n + k]`, k = 0 … 2 · largest.
    ///
    /// Autocovariances times N \[unit²\], without the mean removed here.
    pub(super) fn whole(&self, x: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; 2 * self.largest + 1];
        slide(&self.whole, x, 0, x.len(), 0, &mut sums);
        sums
    }

    /// Adds `H(m) = Σ_{n<m} x[n] x[n + m]` to `sums[m]`, m = 0 … largest.
    ///
    /// The pairs n < m fill a triangle. A node of it, n and m in a … a + 2L, has a square n < a + L ≤ m,
    /// one correlation, and two nodes of half the width.
    pub(super) fn heads(&self, x: &[f64], sums: &mut Vec<f64>) {
        sums.resize(self.width, 0.0);
        let mut width = self.width;
        for transform in &self.nodes {
            let half = width / 2;
            if half > transform.block {
                for (a, node) in (0..).step_by(width).zip(sums.chunks_mut(width)) {
                    if a + half <= self.largest {
                        slide(transform, x, a, half, 2 * a + half, &mut node[half..]);
                    }
                }
            } else {
                let room = || (transform.room(), transform.empty(), transform.empty());
                let nodes = sums.par_chunks_mut(width).enumerate();
                let nodes = nodes.with_min_len(SHARE.div_ceil(width));
                nodes.for_each_init(room, |(room, short, long), (k, node)| {
                    let a = k * width;
                    if a + half <= self.largest {
                        transform.spectrum(part(x, a, half), room, short);
                        transform.spectrum(part(x, 2 * a + half, width), room, long);
                        for (long, short) in long.iter_mut().zip(&*short) {
                            *long *= short.conj();
                        }
                        transform.add_samples(long, room, &mut node[half..]);
                    }
                });
            }
            width = half;
        }
        let leaf = |(k, leaf): (usize, &mut [f64])| {
            let a = k * width;
            let reached = (self.largest + 1).saturating_sub(a);
            for (i, sum) in leaf.iter_mut().enumerate().take(reached) {
                *sum += dot(part(x, a, i), part(x, 2 * a + i, i));
            }
        };
        let leaves = sums.par_chunks_mut(width).enumerate();
        leaves.with_min_len(SHARE / width).for_each(leaf);
        sums.truncate(self.largest + 1);
    }
}

/// The next length, at most an eighth above and 64 at least, of many twos and few threes and fives.
///
/// FFTs of such lengths are fast; the next power of two would cost up to twice as much.
fn smooth(length: usize) -> usize {
    let shift = length.max(64).ilog2() - 6;
    let steps = [64, 72, 80, 90, 96, 108, 120, 128].map(|step| step << shift);
    let found = steps.into_iter().find(|&step| step >= length);
    found.unwrap_or(128 << shift)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_lag_of_whole_numbers_is_exact_after_rounding() {
        for (length, largest) in [
            (3, 1),
            (4, 1),
            (5, 2),
            (64, 20),
            (257, 128),
            (1031, 515),
            (1500, 700),
            (4999, 77),
            (5001, 700),
            // The last lag is the first of a square, of nodes of 288.
            (5000, 2160),
            (5001, 2160),
            (8000, 4000 - 1),
            (7919, 3959),
        ] {
            let x: Vec<f64> = (0..length).map(|k| (k * 7919 % 23) as f64 - 11.0).collect();
            // Both as one FFT and as many blocks.
            let longest = [LONGEST, 256][length % 2];
            let plan = Plan::with_longest(length, largest, longest);
            let whole = plan.whole(&x);
            let mut heads = Vec::new();
            plan.heads(&x, &mut heads);
            assert_eq!((whole.len(), heads.len()), (2 * largest + 1, largest + 1));
            // Sums below 1e6 are off by 1e-9 at most: rounding gives the whole number.
            for (k, value) in whole.iter().enumerate() {
                let exact: f64 = x.iter().zip(&x[k..]).map(|(a, b)| a * b).sum();
                assert!((value - exact).abs() < 1e-7, "{length}, lag {k}");
            }
            for (m, value) in heads.iter().enumerate() {
                let exact: f64 = (0..m).map(|n| x[n] * x[n + m]).sum();
                assert!(
                    (value - exact).abs() < 1e-7,
                    "{length}, head {m}: {value} for {exact}"
                );
            }
        }
    }

    #[test]
    fn lengths_grow_by_an_eighth_at_most() {
        for length in 1..5000 {
            let found = smooth(length);
            assert!(
                found >= length && (found == 64 || found * 8 <= length * 9 + 8),
                "{length}"
            );
        }
    }

    #[test]
    fn no_transform_is_longer_than_the_longest_allowed() {
        // 201 lags in one piece: 216 is the next length of few factors, and a transform is twice a block.
        assert_eq!(Plan::with_longest(8000, 100, LONGEST).longest(), 432);
        // 7919 lags in 64 pieces of 124, that is 128.
        assert_eq!(Plan::with_longest(7919, 3959, 256).longest(), 256);
        assert_eq!(part(&[1.0, 2.0, 3.0], 1, 1), [2.0]);
        assert_eq!(part(&[1.0, 2.0, 3.0], 2, 9), [3.0]);
        assert!(part(&[1.0, 2.0, 3.0], 7, 9).is_empty());
    }

    #[test]
    fn blocks_are_as_long_as_a_transform_may_be() {
        // Of a triangle of 4096 the squares are 2048, 1024, 512 and 256 wide.
        let blocks = |longest| {
            let plan = Plan::with_longest(7919, 3959, longest);
            assert_eq!(plan.width, 4096);
            plan.nodes.iter().map(|t| t.block).collect::<Vec<_>>()
        };
        assert_eq!(blocks(LONGEST), [2048, 1024, 512, 256]);
        assert_eq!(blocks(1024), [512, 512, 512, 256]);
        assert_eq!(blocks(256), [128; 4]);
    }
}
