//! Exact Gaussian log-likelihood of a record under any shaping filter.
//!
//! The steady-state pass ([`crate::steady`]) where the model has one, else sample by sample
//! ([`pass`]); both are exact. O(N r²), no copy of the record. Comparable between models of one
//! record only: the same samples present, the same block.

use super::CompositeError;
use super::predictor::{Predictor, dot};
pub use crate::arma::Mean as Level;
use crate::steady;
use undrift_nav::shaping::ShapingFilter;

/// Likelihood of a record under a shaping filter.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::composite::{Level, log_likelihood};
/// // Under white noise of variance V about a level of 0, −2 log L = N ln 2π V + Σ x²/V.
/// let filter = ShapingFilter::white(0.1, 0.01)?; // V = N²/T = 1.
/// let at = log_likelihood(&[1.0, -2.0, f64::NAN, 0.5], &filter, Level::Known(0.0))?;
/// assert!((at.sum_of_squares - 5.25).abs() < 1e-12 && at.observations == 3);
/// assert!((at.log_likelihood + 0.5 * (3.0 * std::f64::consts::TAU.ln() + 5.25)).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordLikelihood {
    /// Log-likelihood, constants included; at the best level where it is estimated.
    pub log_likelihood: f64,
    /// Σ v²/V, the squared one-step prediction errors over their variances: about the number of
    /// observations where the model holds.
    pub sum_of_squares: f64,
    /// Σ ln V, V the variances of the one-step predictions \[unit²\].
    pub log_determinant: f64,
    /// Number of samples present.
    pub observations: usize,
    /// Constant offset of the record, given or estimated \[unit\].
    pub level: f64,
    /// Standard error of the level \[unit\]; 0 where it is given, infinite where the record says nothing of it.
    pub level_standard_error: f64,
}

impl RecordLikelihood {
    /// The logarithm of the restricted likelihood: the level integrated out under a flat prior, not put at its
    /// best value. Unlike the profile it has a limit where a correlation time grows beyond the record, that
    /// of the random walk (Harville 1974; Chen & Deo 2009 for its tests near a unit root).
    ///
    /// The difference of two models is what a comparison needs; for one level it is log L + ½ ln(2π
    /// s²), s its standard error \[unit\]:
    ///
    /// ```
    /// use undrift_nav::shaping::ShapingFilter;
    /// use undrift_noise::composite::{Level, log_likelihood};
    /// let filter = ShapingFilter::white(1.0, 1.0)?;
    /// let at = log_likelihood(&[1.0, 2.0, 3.0, 2.0], &filter, Level::Estimated)?;
    /// assert!((at.level - 2.0).abs() < 1e-12 && (at.level_standard_error - 0.5).abs() < 1e-12); // σ/√4.
    /// let freedom = 0.5 * (std::f64::consts::TAU * 0.25).ln();
    /// assert!((at.restricted() - at.log_likelihood - freedom).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn restricted(&self) -> f64 {
        let freedom = match self.level_standard_error {
            error if error > 0.0 && error.is_finite() => {
                (error * std::f64::consts::TAU.sqrt()).ln()
            }
            _ => 0.0,
        };
        self.log_likelihood + freedom
    }
}

/// Exact log-likelihood of `record` under `filter`, started at `p0`: a random walk starts at zero
/// above the level, so with [`Level::Estimated`] its start is free (the profile of the diffuse
/// likelihood). NaN is a missing sample, exactly accounted for. O(N), no memory beyond the state.
///
/// ```
/// use undrift_noise::composite::{CompositeTerms, Level, log_likelihood};
/// use undrift_noise::synthesis::NoiseGenerator;
/// let truth = CompositeTerms { white: 0.01, random_walk: 0.01, ..CompositeTerms::default() }.to_shaping(0.1)?;
/// let white = CompositeTerms { white: 0.011, ..CompositeTerms::default() }.to_shaping(0.1)?;
/// let mut record: Vec<f64> = NoiseGenerator::new(&truth, 1).take(1000).collect();
/// record[300..400].fill(f64::NAN);
/// let right = log_likelihood(&record, &truth, Level::Estimated)?;
/// assert_eq!(right.observations, 900);
/// assert!(right.log_likelihood > log_likelihood(&record, &white, Level::Estimated)?.log_likelihood + 10.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Fewer than 3 samples present; an infinite one; a model that leaves a sample without variance.
pub fn log_likelihood(
    record: &[f64],
    filter: &ShapingFilter,
    level: Level,
) -> Result<RecordLikelihood, CompositeError> {
    let centre = match level {
        Level::Known(value) => value,
        Level::Estimated => crate::terms::present_mean(record)?.0,
    };
    if !centre.is_finite() {
        return Err(CompositeError::NotFinite);
    }
    let free = level == Level::Estimated;
    let sums = match filter.order {
        0 => sums::<0>(record, filter, centre),
        1 => sums::<1>(record, filter, centre),
        2 => sums::<2>(record, filter, centre),
        3 => sums::<3>(record, filter, centre),
        4 => sums::<4>(record, filter, centre),
        5 => sums::<5>(record, filter, centre),
        _ => sums::<6>(record, filter, centre),
    }
    .ok_or(CompositeError::NoVariance)?;
    if sums.observations < 3 {
        return Err(CompositeError::TooShort {
            present: sums.observations,
            needed: 3,
        });
    }
    let n = sums.observations as f64;
    let mut squares = sums.squares;
    let mut shift = 0.0;
    let mut error = 0.0;
    if free {
        if sums.ones_squares > 0.0 {
            shift = sums.ones_cross / sums.ones_squares;
            squares -= shift * sums.ones_cross;
            error = sums.ones_squares.sqrt().recip();
        } else {
            error = f64::INFINITY;
        }
    }
    let log_likelihood = -0.5 * (n * std::f64::consts::TAU.ln() + sums.log_determinant + squares);
    if !log_likelihood.is_finite() {
        return Err(CompositeError::NotFinite);
    }
    Ok(RecordLikelihood {
        log_likelihood,
        sum_of_squares: squares,
        log_determinant: sums.log_determinant,
        observations: sums.observations,
        level: centre + shift,
        level_standard_error: error,
    })
}

/// Of a record and of ones under one filter; see [`steady::Sums`].
struct LikelihoodSums {
    squares: f64,
    ones_cross: f64,
    ones_squares: f64,
    log_determinant: f64,
    observations: usize,
}

/// `None` where some sample has no positive variance.
fn sums<const N: usize>(
    record: &[f64],
    filter: &ShapingFilter,
    centre: f64,
) -> Option<LikelihoodSums> {
    let steady = steady::steady_state::<N>(filter).and_then(|(model, v)| {
        let p0 = std::array::from_fn(|i| std::array::from_fn(|j| filter.p0[i][j] / v));
        let sums = steady::sums(record, centre, &model, &p0)?;
        Some(LikelihoodSums {
            squares: sums.squares / v,
            ones_cross: sums.cross / v,
            ones_squares: sums.ones / v,
            log_determinant: sums.log_determinant + sums.present as f64 * v.ln(),
            observations: sums.present,
        })
    });
    steady.or_else(|| pass(record, Predictor::<N>::new(filter), centre))
}

/// One sample after the other, for a model that has no steady state.
fn pass<const N: usize>(
    record: &[f64],
    mut filter: Predictor<N>,
    centre: f64,
) -> Option<LikelihoodSums> {
    let mut sums = LikelihoodSums {
        squares: 0.0,
        ones_cross: 0.0,
        ones_squares: 0.0,
        log_determinant: 0.0,
        observations: 0,
    };
    // The same filter run over a record of ones: v of the record is linear in the level.
    let mut ones = [0.0; N];
    for &y in record {
        if y.is_nan() {
            filter.skip();
            ones = filter.advance(&ones);
            continue;
        }
        let (variance, gain) = (filter.variance, filter.gain);
        if !(variance > 0.0 && variance.is_finite()) {
            return None;
        }
        let v = filter.observe(y - centre);
        let error = 1.0 - dot(&filter.h, &ones);
        sums.squares += v * v / variance;
        sums.log_determinant += variance.ln();
        sums.observations += 1;
        sums.ones_cross += error * v / variance;
        sums.ones_squares += error * error / variance;
        ones = filter.advance(&ones);
        for i in 0..N {
            ones[i] += gain[i] * error;
        }
    }
    Some(sums)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::composite::{CompositeTerms, GaussMarkov};
    use crate::synthesis::NoiseGenerator;

    #[test]
    fn the_steady_state_changes_nothing() {
        let terms = CompositeTerms {
            white: 0.002,
            gauss_markov: [
                GaussMarkov {
                    sigma: 0.01,
                    tau_s: 0.3,
                },
                GaussMarkov {
                    sigma: 0.006,
                    tau_s: 40.0,
                },
            ],
            ..CompositeTerms::default()
        };
        let filter = terms.to_shaping(0.01).unwrap();
        let mut record = vec![0.0; 60_000];
        NoiseGenerator::new(&filter, 5).fill(&mut record);
        let found = log_likelihood(&record, &filter, Level::Known(0.0)).unwrap();
        let mut predictor = Predictor::<2>::new(&filter);
        let mut sum = 0.0;
        for &y in &record {
            predictor.settled = false;
            let variance = predictor.variance;
            let v = predictor.observe(y);
            sum += v * v / variance + variance.ln();
        }
        let n = record.len() as f64;
        let exact = -0.5 * (n * std::f64::consts::TAU.ln() + sum);
        let miss = found.log_likelihood - exact;
        // Summation of 60 000 terms; the rest of the gain's way is 1e-12 of it.
        assert!(miss.abs() < 1e-8, "{miss:e}");
    }
}
