//! Which power law an averaging time shows, by the lag-1 autocorrelation of the averages.
//!
//! Riley & Greenhall, "Power law noise identification using the lag 1 autocorrelation" (18th EFTF,
//! 2004), NIST SP 1065 section 5.5.6. At octaves the averages of each are sums of pairs of the one
//! below: 2N samples are looked at in all.
//!
//! Why: the confidence of an Allan deviation depends on the noise that dominates at that averaging
//! time, and this says which without a fit. It names one power law a scale, so that a mixture gives
//! the stronger one, or a type between.
//!
//! With r₁ of averages (or of their d-th differences), δ = r₁/(1 + r₁) and α = −2 (δ + d): white
//! noise has r₁ = 0; its first difference has r₁ = −½ and δ = −1, so that quantisation has α = 2.

use crate::screening::record::{RecordError, check, mean, prefix_sums};

/// Averages that the identification needs.
const AVERAGES: usize = 30;

/// Share of a sum of squares that must be left when its mean is taken off, lest rounding speak.
const LEFT: f64 = 1e-6;

/// Noise type at each averaging factor, from the lag-1 autocorrelation of the averages (differenced
/// until it looks stationary). Where fewer than 30 averages are left, the last type found goes on.
///
/// The type is the exponent α of the rate's spectral density, S(f) ∝ f^α: 2 quantisation, 0 white, −1 flicker, −2 random
/// walk; −3 and −4 steeper than that.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{allan::noise_types, synthesis::NoiseGenerator};
/// let white: Vec<f64> = NoiseGenerator::new(&ShapingFilter::white(1e-3, 0.01)?, 1).take(10_000).collect();
/// let walk: Vec<f64> = white.iter().scan(0.0, |sum, x| { *sum += x; Some(*sum) }).collect();
/// assert_eq!(noise_types(&white, &[1, 8, 64])?, [0, 0, 0]);
/// assert_eq!(noise_types(&walk, &[1, 8, 64])?, [-2, -2, -2]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Fewer than 3 samples, a sample that is not finite.
///
/// The types have the order of `factors`. O(N) for growing powers of two, else O(N) for sums and
/// O(N/m) a factor; a short record of 30 averages gives the type to about ±½, so a single odd one
/// between equal neighbours is chance.
///
/// Quantisation of the integrated signal, the differences of white noise:
///
/// ```
/// use undrift_noise::allan::noise_types;
/// // Alternating rates: every sample undoes the one before.
/// let rates: Vec<f64> = (0..100).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
/// assert_eq!(noise_types(&rates, &[1])?, [2]);
/// # Ok::<(), undrift_noise::screening::RecordError>(())
/// ```
pub fn noise_types(rates: &[f64], factors: &[usize]) -> Result<Vec<i32>, RecordError> {
    check(rates, 3)?;
    let growing = factors.windows(2).all(|pair| pair[0] <= pair[1]);
    if growing && factors.iter().all(|m| m.is_power_of_two()) {
        return Ok(at_octaves(rates, factors));
    }
    let sums = prefix_sums(rates, mean(rates));
    let mut last = 0;
    let mut types = Vec::with_capacity(factors.len());
    for &m in factors {
        let m = m.max(1);
        if rates.len() / m >= AVERAGES {
            let ends: Vec<f64> = sums.iter().step_by(m).copied().collect();
            let averages: Vec<f64> = ends.windows(2).map(|pair| pair[1] - pair[0]).collect();
            last = type_of(&averages, 0.0);
        }
        types.push(last);
    }
    Ok(types)
}

/// Noise types at growing powers of two, each from the averages of the one before.
///
/// One copy of half the record, then in place.
fn at_octaves(rates: &[f64], factors: &[usize]) -> Vec<i32> {
    let centre = mean(rates);
    let mut sums: Vec<f64> = Vec::new();
    let (mut width, mut last) = (1, 0);
    let mut types = Vec::with_capacity(factors.len());
    for &m in factors {
        if rates.len() / m < AVERAGES {
            types.push(last);
            continue;
        }
        while width < m {
            if width == 1 {
                let pairs = rates.chunks_exact(2);
                sums = pairs
                    .map(|pair| (pair[0] - centre) + (pair[1] - centre))
                    .collect();
            } else {
                let half = sums.len() / 2;
                for k in 0..half {
                    sums[k] = sums[2 * k] + sums[2 * k + 1];
                }
                sums.truncate(half);
            }
            width *= 2;
        }
        last = if width == 1 {
            type_of(rates, centre)
        } else {
            type_of(&sums, 0.0)
        };
        types.push(last);
    }
    types
}

/// α = −2 (δ + differences taken), rounded, δ = r₁ / (1 + r₁), of averages whose mean is `near` a number.
///
/// Differences are taken while δ ≥ ¼, twice at most.
fn type_of(averages: &[f64], near: f64) -> i32 {
    let mut differences = Vec::new();
    for taken in 0..3 {
        let (x, near) = if taken == 0 {
            (averages, near)
        } else {
            (&differences[..], 0.0)
        };
        let Some(r1) = lag_one(x, near) else {
            return 0;
        };
        let delta = r1 / (1.0 + r1).max(f64::MIN_POSITIVE);
        if delta < 0.25 || taken == 2 {
            return (-2.0 * (delta + f64::from(taken))).round().clamp(-4.0, 2.0) as i32;
        }
        differences = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    0
}

/// Lag-1 autocorrelation of samples whose mean is `near` a number; none of a constant.
fn lag_one(x: &[f64], near: f64) -> Option<f64> {
    let about = LagOneSums::about(x, near);
    if about.squared() > LEFT * about.squares {
        return Some(about.lagged() / about.squared());
    }
    let about = LagOneSums::about(x, near + about.mean());
    (about.squared() > LEFT * about.squares).then(|| about.lagged() / about.squared())
}

/// Sums over samples less a number: of themselves, their squares and the products of neighbours.
struct LagOneSums {
    count: f64,
    /// Σ x.
    total: f64,
    /// Σ x².
    squares: f64,
    /// Σ x_t x_{t+1}.
    products: f64,
    /// First and last together.
    ends: f64,
}

impl LagOneSums {
    /// Sums over `x` less `near`.
    fn about(x: &[f64], near: f64) -> Self {
        let (Some((&last, early)), Some(&first)) = (x.split_last(), x.first()) else {
            return Self {
                count: 1.0,
                total: 0.0,
                squares: 0.0,
                products: 0.0,
                ends: 0.0,
            };
        };
        let (early8, early_tail) = early.as_chunks::<8>();
        let (late8, late_tail) = x[1..].as_chunks::<8>();
        let (mut total, mut squares, mut products) = ([0.0; 8], [0.0; 8], [0.0; 8]);
        for (early, late) in early8.iter().zip(late8) {
            for i in 0..8 {
                let (a, b) = (early[i] - near, late[i] - near);
                total[i] += a;
                squares[i] += a * a;
                products[i] += a * b;
            }
        }
        let mut sums = Self {
            count: x.len() as f64,
            total: total.iter().sum::<f64>() + (last - near),
            squares: squares.iter().sum::<f64>() + (last - near) * (last - near),
            products: products.iter().sum(),
            ends: (first - near) + (last - near),
        };
        for (early, late) in early_tail.iter().zip(late_tail) {
            let (a, b) = (early - near, late - near);
            sums.total += a;
            sums.squares += a * a;
            sums.products += a * b;
        }
        sums
    }

    /// About the number subtracted.
    fn mean(&self) -> f64 {
        self.total / self.count
    }

    /// Σ (x − mean)².
    fn squared(&self) -> f64 {
        self.squares - self.total * self.mean()
    }

    /// Σ (x_t − mean)(x_{t+1} − mean).
    fn lagged(&self) -> f64 {
        let mean = self.mean();
        self.products - mean * (2.0 * self.total - self.ends) + (self.count - 1.0) * mean * mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_about_a_number_give_the_autocorrelation_about_the_mean() {
        for length in [2usize, 3, 8, 9, 17, 100] {
            let x: Vec<f64> = (0..length).map(|k| (k * 7919 % 101) as f64).collect();
            let centre = x.iter().sum::<f64>() / length as f64;
            let squared: f64 = x.iter().map(|v| (v - centre).powi(2)).sum();
            let pairs = x.windows(2).map(|w| (w[0] - centre) * (w[1] - centre));
            let expected = pairs.sum::<f64>() / squared;
            for near in [centre, 0.0, 50.0, 1e6] {
                let found = lag_one(&x, near).unwrap();
                // About 1e6 the squares are 1e9 times too large, before the second look.
                assert!(
                    (found - expected).abs() < 1e-6,
                    "{length}, {near}: {found} {expected}"
                );
            }
        }
        assert_eq!(lag_one(&[0.1; 100], 0.3), None);
        assert_eq!(lag_one(&[], 0.0), None);
    }

    #[test]
    fn octaves_and_any_factors_agree() {
        let mut seed = 1u64;
        let mut walk = 0.0;
        let rates: Vec<f64> = (0..20_001)
            .map(|_| {
                seed = seed
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                let white = (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
                walk += 0.02 * white;
                seed = seed
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                1e3 + walk + (seed >> 11) as f64 / (1u64 << 53) as f64
            })
            .collect();
        let octaves: Vec<usize> = (0..14).map(|k| 1 << k).collect();
        let alone = noise_types(&rates, &octaves).unwrap();
        // An invalid factor takes the other way.
        let mixed: Vec<usize> = [3].into_iter().chain(octaves).collect();
        assert_eq!(noise_types(&rates, &mixed).unwrap()[1..], alone);
        assert_eq!((alone[0], alone[9]), (0, -2));
        assert_eq!(noise_types(&[5.0; 100], &[1, 2]), Ok(vec![0, 0]));
        assert_eq!(
            noise_types(&[1.0, f64::NAN, 2.0], &[1]),
            Err(RecordError::NotFinite { index: 1 })
        );
    }
}
