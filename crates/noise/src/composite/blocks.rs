//! Averages over blocks of samples, of a record and, exactly, of its model.

use super::CompositeError;
use undrift_nav::shaping::{AxisMatrix, AxisVector, MAX_ORDER, ShapingError, ShapingFilter};

/// Largest share of a block that may be missing.
const MISSING: usize = 10;

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
    pub(crate) fn of(filter: &ShapingFilter, k: usize) -> Self {
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
/// # Errors
/// `m` = 0, or a result that is not finite.
pub fn block_average(filter: &ShapingFilter, m: usize) -> Result<ShapingFilter, ShapingError> {
    if m == 0 {
        return Err(ShapingError::BadParameter("the block length"));
    }
    if m == 1 {
        return Ok(*filter);
    }
    let span = Span::of(filter, m);
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
/// with up to a tenth of its samples missing (NaN) has the mean of the rest, one with more is NaN.
///
/// # Errors
/// `m` = 0 or larger than the record; an infinite sample.
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
    fn missing_samples_in_blocks() {
        let mut record: Vec<f64> = (0..40).map(f64::from).collect();
        record[3] = f64::NAN;
        record[20] = f64::NAN;
        record[21] = f64::NAN;
        record[22] = f64::NAN;
        let averages = average_in_blocks(&record, 20).unwrap();
        assert!((averages[0] - (190.0 - 3.0) / 19.0).abs() < 1e-12);
        assert!(averages[1].is_nan());
        assert!(average_in_blocks(&record, 0).is_err());
        assert!(average_in_blocks(&record, 41).is_err());
        assert!(average_in_blocks(&[f64::INFINITY; 4], 2).is_err());
    }
}
