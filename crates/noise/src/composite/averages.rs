//! Records as the likelihood of composite terms sees them.
//!
//! Blocks of which samples are missing are averages of fewer: the model of the averages is that of the share
//! that is present ([`block_average_of_share`]), the same for all blocks of a record.
//!
//! All searches of this module evaluate [`Averages::cost`]; a restricted likelihood, so that terms
//! that look like a level (a random walk, a τ beyond the record) are not favoured by the level they
//! fit away. Records are independent: each its own level, likelihoods multiplied.

use super::blocks::{
    Blocks, average_in_blocks, block_average_of_share, correlated_white, share_present,
};
use super::likelihood::{Level, RecordLikelihood, log_likelihood};
use super::{CompositeError, CompositeTerms, TermSet};
use crate::wavelet::{WaveletVariance, pooled, wavelet_variance};
use undrift_nav::shaping::{ShapingError, ShapingFilter};

/// What the restricted log-likelihood of all records under a model changes by where something beside their levels is
/// integrated out.
pub(crate) type Marginal<'a> = &'a (dyn Fn(&ShapingFilter) -> f64 + Sync);

/// The levels alone.
pub(crate) const NO_MARGINAL: Marginal = &|_| 0.0;

/// The overlap's search coordinate over it: a change by 1 is then no less than of a logarithm.
pub(super) const OVERLAP_COORDINATE: f64 = 10.0;

/// Standard errors of a level that are chance.
const CHANCE: f64 = 4.0;

/// The wavelet variance of all records, which each fit to them starts from.
///
/// # Errors
/// A record too short, constant or infinite; no record.
pub(crate) fn curve(records: &[&[f64]], interval: f64) -> Result<WaveletVariance, CompositeError> {
    let curves = records
        .iter()
        .map(|record| wavelet_variance(record, interval));
    let curves: Vec<WaveletVariance> = curves.collect::<Result<_, _>>()?;
    pooled(&curves).ok_or(CompositeError::TooShort {
        present: 0,
        needed: 3,
    })
}

/// Records as the likelihood sees them: averages over blocks of samples `interval` \[s\] apart.
#[derive(Clone)]
pub(crate) struct Averages<'a> {
    /// Averages \[unit\]; NaN of a block with too few samples.
    records: Vec<Vec<f64>>,
    /// Share of the samples of each that is there.
    present: Vec<f64>,
    /// Samples of a block.
    block: usize,
    /// Interval between samples \[s\].
    pub(crate) interval: f64,
    /// How much of a neighbour white noise has in it because of a filter: the covariance of two blocks next to each other over the variance of
    /// white noise over many; see [`correlated_white`].
    pub(crate) overlap: f64,
    /// Integrated out beside the levels.
    marginal: Marginal<'a>,
}

impl Blocks {
    /// Averages of records over these; none where a record has not one.
    pub(crate) fn averages(&self, records: &[&[f64]], interval: f64) -> Option<Averages<'static>> {
        Averages::new(records, self.samples.max(1), interval).ok()
    }
}

impl<'a> Averages<'a> {
    /// Blocks of `block` samples; an error where a record has not one.
    pub(crate) fn new(
        records: &[&[f64]],
        block: usize,
        interval: f64,
    ) -> Result<Self, CompositeError> {
        let averages = records
            .iter()
            .map(|record| average_in_blocks(record, block));
        let present = records.iter().map(|record| share_present(record, block));
        Ok(Self {
            records: averages.collect::<Result<_, _>>()?,
            present: present.collect(),
            block,
            interval,
            overlap: 0.0,
            marginal: NO_MARGINAL,
        })
    }

    /// Records as they are.
    pub(crate) fn from_samples(records: Vec<Vec<f64>>, interval: f64) -> Self {
        Self {
            present: vec![1.0; records.len()],
            records,
            block: 1,
            interval,
            overlap: 0.0,
            marginal: NO_MARGINAL,
        }
    }

    /// These averages with something integrated out beside the levels.
    pub(crate) fn marginal(self, marginal: Marginal<'a>) -> Self {
        Self { marginal, ..self }
    }

    /// The likelihood of each record, each with a level of its own.
    ///
    /// # Errors
    /// A filter that cannot be made of the terms, or a record without a likelihood.
    pub(crate) fn likelihoods(
        &self,
        terms: &CompositeTerms,
    ) -> Result<Vec<RecordLikelihood>, CompositeError> {
        self.of_terms(terms, self.overlap)
    }

    /// The likelihood of each record, white noise having this overlap.
    fn of_terms(
        &self,
        terms: &CompositeTerms,
        overlap: f64,
    ) -> Result<Vec<RecordLikelihood>, CompositeError> {
        if overlap == 0.0 {
            return self.under(&terms.to_shaping(self.interval)?);
        }
        let interval = self.interval * self.block as f64;
        let slow = CompositeTerms {
            white: 0.0,
            ..*terms
        };
        let slow = slow.to_shaping(self.interval)?;
        self.each(|share| {
            let variance = terms.white.powi(2) / (interval * share);
            let white = correlated_white(variance, overlap * variance, interval)?;
            block_average_of_share(&slow, self.block, share)?.plus(&white)
        })
    }

    /// Likelihood of each record's averages under a filter of the full rate.
    fn under(&self, filter: &ShapingFilter) -> Result<Vec<RecordLikelihood>, CompositeError> {
        self.each(|share| block_average_of_share(filter, self.block, share))
    }

    /// Likelihood of each record's averages under the filter of the share of its samples that is there.
    fn each(
        &self,
        filter: impl Fn(f64) -> Result<ShapingFilter, ShapingError>,
    ) -> Result<Vec<RecordLikelihood>, CompositeError> {
        let likelihood = |(record, share): (&Vec<f64>, &f64)| {
            log_likelihood(record, &filter(*share)?, Level::Estimated)
        };
        self.records
            .iter()
            .zip(&self.present)
            .map(likelihood)
            .collect()
    }

    /// The negative restricted log-likelihood, +∞ without one.
    pub(crate) fn cost(&self, terms: &CompositeTerms) -> f64 {
        self.cost_of(terms, self.overlap)
    }

    /// [`Self::cost`] at the search coordinates of a set of terms; one more than it has is ten times the overlap.
    pub(crate) fn cost_at(&self, set: TermSet, z: &[f64]) -> f64 {
        let overlap = z.get(set.parameters());
        let overlap = overlap.map_or(self.overlap, |x| x / OVERLAP_COORDINATE);
        self.cost_of(&set.terms(z), overlap)
    }

    fn cost_of(&self, terms: &CompositeTerms, overlap: f64) -> f64 {
        let likelihood = || -> Option<f64> {
            let records = self.of_terms(terms, overlap).ok()?;
            let sum: f64 = records.iter().map(RecordLikelihood::restricted).sum();
            let filter = terms.to_shaping(self.interval).ok()?;
            Some(sum + (self.marginal)(&filter))
        };
        likelihood().map_or(f64::INFINITY, |found| -found)
    }

    /// [`Self::restricted`] with the level of the noise at its best for these averages, where that is what chance makes of the filter's. White
    /// noise is known from all samples; of the averages any model fitted to them has a better level.
    pub(crate) fn restricted_at_best_level(
        &self,
        filter: &ShapingFilter,
    ) -> Result<f64, CompositeError> {
        let records = self.under(filter)?;
        let sum: f64 = records.iter().map(RecordLikelihood::restricted).sum();
        let squares: f64 = records.iter().map(|one| one.sum_of_squares).sum();
        let free: usize = records.iter().map(|one| one.observations - 1).sum();
        let free = free as f64;
        let level = squares / free;
        match level.ln().abs() < CHANCE * (2.0 / free).sqrt() {
            true => Ok(sum + 0.5 * (squares - free - free * level.ln())),
            false => Ok(sum),
        }
    }

    /// The restricted log-likelihood of all records under the filter of a sample.
    ///
    /// # Errors
    /// As [`Self::likelihoods`].
    pub(crate) fn restricted(&self, filter: &ShapingFilter) -> Result<f64, CompositeError> {
        let records = self.under(filter)?;
        Ok(records.iter().map(RecordLikelihood::restricted).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthesis::NoiseGenerator;

    #[test]
    fn the_best_level_is_that_of_the_averages_unless_it_is_far_off() {
        let white = |density: f64| ShapingFilter::white(density, 0.01).unwrap();
        let mut record = vec![0.0; 20_000];
        NoiseGenerator::new(&white(1.0), 4).fill(&mut record);
        let averages = Averages::new(&[&record], 25, 0.01).unwrap();
        let best = averages.restricted_at_best_level(&white(1.0)).unwrap();
        // The same whatever the level it begins with, and no less than at any.
        let near = averages.restricted_at_best_level(&white(1.02)).unwrap();
        assert!((near - best).abs() < 1e-9, "{near} {best}");
        let levels = (90..110).map(|k| averages.restricted(&white(f64::from(k) / 100.0)));
        let most = levels.flatten().fold(f64::NEG_INFINITY, f64::max);
        assert!(most <= best && best < most + 0.1, "{most} {best}");
        // 800 averages: their variance is known to 5 %, so 1.2 in density is no chance.
        let far = averages.restricted_at_best_level(&white(1.2)).unwrap();
        assert_eq!(far, averages.restricted(&white(1.2)).unwrap());
    }
}
