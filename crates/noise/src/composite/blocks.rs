//! Averages over blocks of samples, of a record and, exactly, of its model.
//!
//! Averaging keeps all that drifts, and the likelihood of the averages costs m times less. It is
//! exact: a linear filter sampled every m steps, with the average as its output, is a linear filter
//! of the same order ([`block_average`]), not an approximation of one. What is lost is what happens
//! within a block.

use super::CompositeError;
use undrift_nav::shaping::{AxisMatrix, AxisVector, MAX_ORDER, ShapingError, ShapingFilter};

/// A block may miss one in so many of its samples: more than a fifth lost at random.
const MISSING: usize = 3;

/// What `k` steps of a shaping filter do from a state x: `x_k = A x + g`, sum of the k samples
/// `= row · x + d`, with the moments of g and d.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    /// F^k.
    pub(crate) a: AxisMatrix,
    /// H (I + F + … + F^{k−1}).
    pub(crate) row: AxisVector,
    /// Covariance of g.
    pub(crate) q: AxisMatrix,
    /// Covariance of g with d.
    pub(crate) s: AxisVector,
    /// Variance of d.
    pub(crate) r: f64,
}

impl Span {
    /// `k` steps by doubling: O(log k), only sums of covariances (no inverse, no closed form to cancel).
    ///
    /// `k` ≥ 1. Covariances grow only by sums of positive parts, so k may be in the millions.
    pub(crate) fn doubled(filter: &ShapingFilter, k: usize) -> Self {
        let n = filter.order;
        let mut span = Self {
            a: [[0.0; MAX_ORDER]; MAX_ORDER],
            row: [0.0; MAX_ORDER],
            q: [[0.0; MAX_ORDER]; MAX_ORDER],
            s: [0.0; MAX_ORDER],
            r: 0.0,
        };
        for i in 0..n {
            span.a[i][i] = 1.0;
        }
        let step = Self {
            a: filter.f,
            row: filter.h,
            q: filter.q,
            s: filter.s,
            r: filter.r,
        };
        for bit in (0..usize::BITS - k.leading_zeros()).rev() {
            span = span.then(&span, n);
            if k >> bit & 1 == 1 {
                span = span.then(&step, n);
            }
        }
        span
    }

    /// The steps of `next` after these, of a filter of order n.
    ///
    /// With `x_{j+k} = A₂ (A₁ x + g₁) + g₂` and the sums `row₁ x + d₁ + row₂ (A₁ x + g₁) + d₂`: moments of g
    /// and d follow from those of the parts, which are independent.
    fn then(&self, next: &Self, n: usize) -> Self {
        let mut both = *next;
        let mut carried = [[0.0; MAX_ORDER]; MAX_ORDER];
        for i in 0..n {
            let mut g = 0.0;
            for k in 0..n {
                g += self.q[i][k] * next.row[k];
            }
            both.r += next.row[i] * (2.0 * self.s[i] + g);
            both.row[i] = self.row[i];
            for j in 0..n {
                both.row[i] += next.row[j] * self.a[j][i];
                both.s[j] += next.a[j][i] * (self.s[i] + g);
                both.a[i][j] = 0.0;
                for k in 0..n {
                    both.a[i][j] += next.a[i][k] * self.a[k][j];
                    carried[i][j] += next.a[i][k] * self.q[k][j];
                }
            }
        }
        both.r += self.r;
        for i in 0..n {
            for j in 0..n {
                for k in 0..n {
                    both.q[i][j] += carried[i][k] * next.a[j][k];
                }
            }
        }
        both
    }
}

/// The model of averages over blocks of `m` samples of a shaping filter, exact: the state is that
/// before each block's first sample, the order unchanged. A Gauss-Markov process or random walk
/// gets a cross-covariance `s` on the way (its average is an ARMA(1,1)); white noise and
/// quantisation keep N and Q.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::composite::block_average;
/// let averages = block_average(&ShapingFilter::white(1e-3, 0.01)?, 100)?;
/// assert_eq!(averages.interval, 1.0);
/// let mut variance = [0.0];
/// averages.autocovariance(&mut variance);
/// assert!((variance[0] - 1e-6).abs() < 1e-12, "N²/T at T = 1 s");
/// # Ok::<(), undrift_nav::shaping::ShapingError>(())
/// ```
///
/// # Errors
/// `m` = 0, or a result that is not finite.
///
/// A random walk of density K averaged over T′ = m T: its averages differ by a variance of K² T′ ·
/// 2/3, less than K² T′, because averaging smooths:
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::composite::block_average;
/// let averages = block_average(&ShapingFilter::random_walk(1.0, 0.001)?, 1000)?;
/// // T′ = 1 s: the state moves by a variance of K² T′ from block to block,
/// assert!((averages.q[0][0] - 1.0).abs() < 1e-9);
/// // and the average lags its end: the variance of the average about its start is K² T′/3.
/// assert!((averages.r - 1.0 / 3.0).abs() < 1e-3);
/// # Ok::<(), undrift_nav::shaping::ShapingError>(())
/// ```
pub fn block_average(filter: &ShapingFilter, m: usize) -> Result<ShapingFilter, ShapingError> {
    if m == 0 {
        return Err(ShapingError::BadParameter("the block length"));
    }
    if m == 1 {
        return Ok(*filter);
    }
    let span = Span::doubled(filter, m);
    let width = m as f64;
    let blank = ShapingFilter::none(filter.interval * width)?;
    let average = ShapingFilter {
        order: filter.order,
        f: span.a,
        h: span.row.map(|v| v / width),
        q: span.q,
        s: span.s.map(|v| v / width),
        r: span.r / (width * width),
        p0: filter.p0,
        ..blank
    };
    let finite = average.r.is_finite() && average.q.iter().flatten().all(|v| v.is_finite());
    if finite {
        Ok(average)
    } else {
        Err(ShapingError::BadParameter("every moment of the model"))
    }
}

/// Averages of a record over blocks of `m` samples; a last, incomplete block is left out. A block
/// with up to a third of its samples missing (NaN) has the mean of the rest, one with more is NaN.
///
/// # Errors
/// `m` = 0 or larger than the record; an infinite sample.
///
/// ```
/// use undrift_noise::composite::average_in_blocks;
/// let record = [1.0, 2.0, 3.0, 4.0, f64::NAN, 8.0, f64::NAN, f64::NAN, 9.0, 7.0];
/// let averages = average_in_blocks(&record, 3)?;
/// assert_eq!(averages[..2], [2.0, 6.0]);
/// assert!(averages[2].is_nan() && averages.len() == 3);
/// # Ok::<(), undrift_noise::composite::CompositeError>(())
/// ```
pub fn average_in_blocks(record: &[f64], m: usize) -> Result<Vec<f64>, CompositeError> {
    if m == 0 || record.len() < m {
        return Err(CompositeError::TooShort {
            present: record.len(),
            needed: m.max(1),
        });
    }
    let mut averages = Vec::with_capacity(record.len() / m);
    for block in record.chunks_exact(m) {
        let first = block.iter().copied().find(|v| !v.is_nan()).unwrap_or(0.0);
        let (mut sum, mut missing) = (0.0, 0);
        for &value in block {
            if value.is_nan() {
                missing += 1;
            } else {
                sum += value - first;
            }
        }
        if MISSING * missing > m {
            averages.push(f64::NAN);
            continue;
        }
        let average = first + sum / (m - missing) as f64;
        if !average.is_finite() {
            return Err(CompositeError::NotFinite);
        }
        averages.push(average);
    }
    Ok(averages)
}

/// Share of the samples that is there, harmonic mean over the blocks of `m` that [`average_in_blocks`] keeps; 1 of none.
///
/// For likelihoods whose white noise is that of fewer samples a block.
pub(crate) fn share_present(record: &[f64], m: usize) -> f64 {
    let (mut blocks, mut sum) = (0.0, 0.0);
    for block in record.chunks_exact(m.max(1)) {
        let missing = block.iter().filter(|v| v.is_nan()).count();
        if MISSING * missing <= m {
            blocks += 1.0;
            sum += m as f64 / (m - missing) as f64;
        }
    }
    if blocks > 0.0 { blocks / sum } else { 1.0 }
}

/// [`block_average`] where only a `share` of the samples of each block is there: the white noise of a sample is averaged
/// over fewer of them.
pub(crate) fn block_average_of_share(
    filter: &ShapingFilter,
    m: usize,
    share: f64,
) -> Result<ShapingFilter, ShapingError> {
    let mut average = block_average(filter, m)?;
    if m > 1 {
        average.r += (1.0 / share - 1.0) * filter.r / m as f64;
    }
    Ok(average)
}

/// White noise behind a filter, of a variance of blocks that it has over many of them and a covariance of a block with each neighbour, as an
/// MA(1): blocks that are longer than the filter's memory know nothing of those beyond.
///
/// # Errors
/// A covariance that no process has: above a quarter of the variance.
pub(crate) fn correlated_white(
    variance: f64,
    covariance: f64,
    interval: f64,
) -> Result<ShapingFilter, ShapingError> {
    // The variance of one block, and θ of the innovations from c = −θ v, variance = (1 − θ)² v.
    let own = variance - 2.0 * covariance;
    let root = (own * own - 4.0 * covariance * covariance).sqrt();
    let theta = -2.0 * covariance / (own + root);
    let innovations = 0.5 * (own + root);
    ShapingFilter::arma(&[], &[theta], innovations.sqrt(), interval)
}

/// Shortest block that the slow terms are fitted to \[s\], and the longest that a memory asks for.
const BLOCK_S: [f64; 2] = [0.25, 1.0];
/// A block is so many correlation times of the fast part: beyond its neighbours it is correlated with none.
const MEMORIES: f64 = 6.0;
/// Fewest blocks of a record.
const FEWEST: usize = 1000;
/// Samples that the memory is taken from.
const PROBE: usize = 100_000;

/// The blocks that sums of terms are fitted to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Blocks {
    /// Samples to a block.
    pub(crate) samples: usize,
    /// Whether white noise is behind a filter: neighbouring blocks are correlated.
    pub(crate) filtered: bool,
}

/// Blocks over which the fast part of records has no memory but of the neighbour, from [`memory`]: a sensor behind a low-pass filter shows its
/// white noise only beyond. The same for the whole and any part of it, at least `least` samples.
pub(crate) fn blocks_beyond_memory(records: &[&[f64]], interval: f64, least: usize) -> Blocks {
    let samples: usize = records.iter().map(|record| record.len()).sum();
    let longest = records.iter().map(|record| memory(record, interval));
    let memory = longest.fold(0, usize::max);
    let block_s = (MEMORIES * memory as f64 * interval).clamp(BLOCK_S[0], BLOCK_S[1]);
    let block = (block_s / interval).round() as usize;
    Blocks {
        samples: block.min(samples / FEWEST).max(least).max(1),
        filtered: memory > 0,
    }
}

/// Correlation time of the fast part of a record \[samples\]: the first lag at which the autocorrelation about the mean of each
/// second is below 1/e; 0 where that is the first.
///
/// Removing the mean of each second hides what is slower, which is not what a block has to be
/// longer than.
fn memory(record: &[f64], interval: f64) -> usize {
    let second = ((1.0 / interval).round() as usize).max(2);
    let record = &record[..record.len().min(PROBE)];
    let mut rest = Vec::with_capacity(record.len());
    for chunk in record.chunks_exact(second) {
        let present = chunk.iter().filter(|v| !v.is_nan());
        let (sum, count) = present.fold((0.0, 0.0), |(sum, n), v| (sum + v, n + 1.0));
        rest.extend(chunk.iter().map(|v| v - sum / count));
    }
    let covariance = |lag: usize| {
        let pairs = rest.iter().zip(rest.get(lag..).unwrap_or_default());
        let products = pairs
            .map(|(a, b)| a * b)
            .filter(|product| !product.is_nan());
        let (sum, count) = products.fold((0.0, 0.0), |(sum, n), product| (sum + product, n + 1.0));
        sum / f64::max(count, 1.0)
    };
    let enough = covariance(0) / std::f64::consts::E;
    let lag = (1..second).find(|lag| covariance(*lag) <= enough);
    lag.map_or(second, |lag| lag - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn autocovariance_of_averages_is_the_double_sum() {
        let (t, m) = (0.01, 7);
        let filter = ShapingFilter::white(0.02, t)
            .unwrap()
            .plus(&ShapingFilter::arma(&[1.2, -0.5], &[0.4], 0.3, t).unwrap())
            .unwrap()
            .plus(&ShapingFilter::gauss_markov(0.3, 0.5, t).unwrap())
            .unwrap();
        let mut full = [0.0; 40];
        filter.autocovariance(&mut full);
        let mut blocks = [0.0; 4];
        let average = block_average(&filter, m).unwrap();
        average.autocovariance(&mut blocks);
        assert_eq!(average.interval, t * m as f64);
        for (lag, found) in blocks.iter().enumerate() {
            let mut sum = 0.0;
            for i in 0..m {
                for j in 0..m {
                    sum += full[(lag * m + i).abs_diff(j)];
                }
            }
            let expected = sum / (m * m) as f64;
            // Sums of a few hundred terms of size full[0].
            assert!(
                (found - expected).abs() < 1e-13 * full[0],
                "{lag}: {found} {expected}"
            );
        }
    }

    #[test]
    fn averages_of_a_random_walk_have_the_known_differences() {
        // Differences of averages of m: variance q (2m² + 1)/(3m), lag one q (m² − 1)/(6m).
        let (k, t, m) = (0.3, 0.01, 20.0);
        let walk = ShapingFilter::random_walk(k, t).unwrap();
        let average = block_average(&walk, 20).unwrap();
        let (h, q, s, r) = (average.h[0], average.q[0][0], average.s[0], average.r);
        let variance = h * h * q + 2.0 * r - 2.0 * h * s;
        let lag_one = h * s - r;
        let step = k * k * t;
        assert!((variance / (step * (2.0 * m * m + 1.0) / (3.0 * m)) - 1.0).abs() < 1e-12);
        assert!((lag_one / (step * (m * m - 1.0) / (6.0 * m)) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_block_is_six_memories_of_the_fast_part() {
        let drawn = |filter: &ShapingFilter| {
            let mut record = vec![0.0; 60_000];
            crate::synthesis::NoiseGenerator::new(filter, 1).fill(&mut record);
            record
        };
        let t = 0.01;
        // White noise has none: a quarter of a second, of 25 samples. AR(1) of 30 ms: 1/e at three samples.
        let white = drawn(&ShapingFilter::white(0.1, t).unwrap());
        let of = |record: &[f64], t, least| {
            let found = blocks_beyond_memory(&[record], t, least);
            (found.samples, found.filtered)
        };
        assert_eq!(of(&white, t, 1), (25, false));
        let ar = drawn(&ShapingFilter::gauss_markov(1.0, 0.1, t).unwrap());
        let (block, filtered) = of(&ar, t, 1);
        assert!((36..=60).contains(&block) && filtered, "{block}");
        // A thousand blocks at least, and never below what is asked for.
        assert_eq!(of(&white[..6000], t, 1), (6, false));
        assert_eq!(of(&white, t, 80), (80, false));
        assert_eq!(of(&white, 1.0, 1), (1, false));
    }

    #[test]
    fn white_noise_behind_a_filter_has_its_variance_over_many_blocks() {
        for covariance in [0.2, 0.02, -0.3] {
            let filter = correlated_white(1.0, covariance, 0.5).unwrap();
            let mut found = [0.0; 3];
            filter.autocovariance(&mut found);
            let exact = [1.0 - 2.0 * covariance, covariance, 0.0];
            let close = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-12;
            assert!(found.iter().zip(&exact).all(close), "{found:?}");
        }
        assert!(correlated_white(1.0, 0.26, 0.5).is_err());
    }

    #[test]
    fn the_white_noise_of_blocks_grows_as_their_samples_get_fewer() {
        let white = ShapingFilter::white(0.1, 0.01).unwrap();
        let all = block_average(&white, 20).unwrap();
        let half = block_average_of_share(&white, 20, 0.8).unwrap();
        assert!((half.r / all.r - 1.25).abs() < 1e-12);
        let mut record = vec![1.0; 40];
        record[..4].fill(f64::NAN);
        // One block of 16 and one of 20: the mean of 20/16 and 1, inverted.
        assert!((share_present(&record, 20) - 1.0 / 1.125).abs() < 1e-12);
        record[..7].fill(f64::NAN);
        assert_eq!(share_present(&record, 20), 1.0);
        assert_eq!(share_present(&[], 20), 1.0);
    }

    #[test]
    fn missing_samples_in_blocks() {
        let mut record: Vec<f64> = (0..40).map(f64::from).collect();
        record[3] = f64::NAN;
        record[20] = f64::NAN;
        record[21] = f64::NAN;
        for k in 22..27 {
            record[k] = f64::NAN;
        }
        let averages = average_in_blocks(&record, 20).unwrap();
        assert!((averages[0] - (190.0 - 3.0) / 19.0).abs() < 1e-12);
        assert!(averages[1].is_nan());
        assert!(average_in_blocks(&record, 0).is_err());
        assert!(average_in_blocks(&record, 41).is_err());
        assert!(average_in_blocks(&[f64::INFINITY; 4], 2).is_err());
    }
}
