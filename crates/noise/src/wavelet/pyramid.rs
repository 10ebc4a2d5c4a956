//! One pass over a record: running sums kept at strides 1, 2, 4, …, the last 65 of each.
//!
//! The coefficient at the scale of m samples is a second difference of the running sum over m: from sums at
//! every sample up to m = 32, above that at every m/32-th, which are 32 coefficients to a scale's length still.
//! Each stride needs the last 65 of its own sums, so the memory is that of the scales, not of the record.
//!
//! O(N) time: 6 differences a sample at the finest stride, half a difference at the next, a quarter
//! … . Up to a factor, the differences are the coefficients of the maximal-overlap Haar transform
//! up to m = 32, and of its subsampled form beyond.

/// Means at the finest stride go up to this many samples; at stride 2^k the scale is this times 2^k.
const WIDTH: usize = 32;
/// Sums kept at a stride, a power of two above 2 · WIDTH.
const RING: usize = 128;

/// Squares of one scale.
pub(super) struct Energy {
    /// Samples to a mean.
    pub(super) m: usize,
    /// Σ of squared second differences of the running sum.
    pub(super) squares: f64,
    /// Number of squares.
    pub(super) coefficients: usize,
}

/// A ring of sums at one stride: 2⁰ = every sample, 2ᵏ = every 2ᵏ-th.
struct Level {
    /// Newest at (count − 1) mod [`RING`].
    sums: [f64; RING],
    /// Samples missing so far.
    missing: [u32; RING],
    /// Sums pushed so far.
    ///
    /// Sums pushed so far, the zero before the record included.
    count: usize,
}

impl Level {
    /// The sum after so many samples, and how many of these were missing.
    ///
    /// `missing` counts from the start of the record.
    fn push(&mut self, sum: f64, missing: u32) {
        self.sums[self.count % RING] = sum;
        self.missing[self.count % RING] = missing;
        self.count += 1;
    }

    /// Second difference over `width` entries, the newest last, if few enough of its samples
    /// (`stride` to an entry) are missing.
    ///
    /// More than a tenth of its samples missing makes it `None`.
    fn difference(&self, width: usize, stride: usize) -> Option<f64> {
        if self.count <= 2 * width {
            return None;
        }
        let at = |back: usize| (self.count - 1 - back) % RING;
        let (a, b, c) = (at(2 * width), at(width), at(0));
        let missing = (self.missing[c] - self.missing[a]) as usize;
        if missing > 0 && 10 * missing > 2 * width * stride {
            return None;
        }
        Some((self.sums[c] - self.sums[b]) - (self.sums[b] - self.sums[a]))
    }
}

/// Squares of all octave scales up to a quarter of the record, growing.
///
/// `centre` \[unit\] keeps the sums small. A missing sample is replaced by the mean of the 32
/// before it.
pub(super) fn energies(record: &[f64], centre: f64) -> Vec<Energy> {
    let largest = record.len() / 4;
    let scales = largest.checked_ilog2().map_or(0, |l| l as usize + 1);
    let mut energies: Vec<Energy> = (0..scales)
        .map(|j| Energy {
            m: 1 << j,
            squares: 0.0,
            coefficients: 0,
        })
        .collect();
    let short = WIDTH.ilog2() as usize; // scales 0..=short stand at stride 1
    let mut levels: Vec<Level> = (0..scales.saturating_sub(short).max(1))
        .map(|_| Level {
            sums: [0.0; RING],
            missing: [0; RING],
            count: 0,
        })
        .collect();
    for level in &mut levels {
        level.push(0.0, 0);
    }
    let (mut sum, mut missing) = (0.0, 0u32);
    for (index, &sample) in record.iter().enumerate() {
        if sample.is_nan() {
            missing = missing.saturating_add(1);
            // The mean of the last samples, so that the sum goes on as it went.
            let first = &levels[0];
            if first.count > WIDTH {
                let before = first.sums[(first.count - 1 - WIDTH) % RING];
                sum += (sum - before) / WIDTH as f64;
            }
        } else {
            sum += sample - centre;
        }
        levels[0].push(sum, missing);
        for (j, energy) in energies.iter_mut().enumerate().take(short + 1) {
            if let Some(difference) = levels[0].difference(1 << j, 1) {
                energy.squares += difference * difference;
                energy.coefficients += 1;
            }
        }
        let samples = index + 1;
        for k in 1..levels.len() {
            let stride = 1usize << k;
            if !samples.is_multiple_of(stride) {
                break;
            }
            levels[k].push(sum, missing);
            if let Some(difference) = levels[k].difference(WIDTH, stride) {
                energies[short + k].squares += difference * difference;
                energies[short + k].coefficients += 1;
            }
        }
    }
    energies
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the definition: second differences of a running sum in which a missing sample counts with the mean of the last 32,
    /// unless more than a tenth of a coefficient's samples is missing; beyond 32 samples every 32nd of a mean.
    fn plainly(record: &[f64], centre: f64, m: usize) -> (f64, usize) {
        let mut sums = vec![0.0];
        for (k, x) in record.iter().enumerate() {
            let last = sums[k];
            sums.push(match x.is_nan() {
                true if k >= WIDTH => last + (last - sums[k - WIDTH]) / WIDTH as f64,
                true => last,
                false => last + x - centre,
            });
        }
        let (mut squares, mut count) = (0.0, 0);
        for end in 2 * m..sums.len() {
            let missing = record[end - 2 * m..end]
                .iter()
                .filter(|x| x.is_nan())
                .count();
            if end % (m / WIDTH).max(1) == 0 && 10 * missing <= 2 * m {
                let second = sums[end] - 2.0 * sums[end - m] + sums[end - 2 * m];
                squares += second * second;
                count += 1;
            }
        }
        (squares, count)
    }

    #[test]
    fn every_scale_is_the_sum_over_its_second_differences() {
        let whole: Vec<f64> = (0..700_i64).map(|k| (k * k * 7919 % 101) as f64).collect();
        let mut gaps = whole.clone();
        for missing in [3..5, 40..41, 100..104, 300..313, 500..521, 699..700] {
            gaps[missing].fill(f64::NAN);
        }
        for record in [&whole[..], &gaps, &gaps[..128], &whole[..4]] {
            let found = energies(record, 40.0);
            assert_eq!(found.len(), (record.len() / 4).ilog2() as usize + 1);
            for (j, energy) in found.iter().enumerate() {
                assert_eq!(energy.m, 1 << j);
                let (squares, coefficients) = plainly(record, 40.0, energy.m);
                assert_eq!(energy.coefficients, coefficients, "{}", energy.m);
                assert!(
                    (energy.squares - squares).abs() <= 1e-9 * squares,
                    "{}",
                    energy.m
                );
            }
        }
        assert!(energies(&whole[..3], 0.0).is_empty());
    }
}
