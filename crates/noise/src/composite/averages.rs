//! Records as the likelihood of composite terms sees them.

use super::blocks::{average_in_blocks, block_average_of_share, share_present};
use super::likelihood::{Level, RecordLikelihood, log_likelihood};
use super::{CompositeError, CompositeTerms};
use undrift_nav::shaping::ShapingFilter;

/// What the restricted log-likelihood of all records under a model changes by where something beside their levels is
/// integrated out.
pub(crate) type Beside<'a> = &'a (dyn Fn(&ShapingFilter) -> f64 + Sync);

/// The levels alone.
pub(crate) const NOTHING: Beside = &|_| 0.0;

/// Records as the likelihood sees them: averages over blocks of samples `interval` \[s\] apart.
pub(crate) struct Averages<'a> {
    records: Vec<Vec<f64>>,
    /// Share of the samples of each that is there.
    present: Vec<f64>,
    block: usize,
    pub(crate) interval: f64,
    beside: Beside<'a>,
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
            beside: NOTHING,
        })
    }

    /// Records as they are.
    pub(crate) fn of_samples(records: Vec<Vec<f64>>, interval: f64) -> Self {
        Self {
            present: vec![1.0; records.len()],
            records,
            block: 1,
            interval,
            beside: NOTHING,
        }
    }

    /// With something integrated out beside the levels.
    pub(crate) fn beside(self, beside: Beside<'a>) -> Self {
        Self { beside, ..self }
    }

    /// The likelihood of each record, each with a level of its own.
    pub(crate) fn likelihoods(
        &self,
        terms: &CompositeTerms,
    ) -> Result<Vec<RecordLikelihood>, CompositeError> {
        self.under(&terms.to_shaping(self.interval)?)
    }

    fn under(&self, filter: &ShapingFilter) -> Result<Vec<RecordLikelihood>, CompositeError> {
        let of = |(record, present): (&Vec<f64>, &f64)| {
            let filter = block_average_of_share(filter, self.block, *present)?;
            log_likelihood(record, &filter, Level::Estimated)
        };
        self.records.iter().zip(&self.present).map(of).collect()
    }

    /// The negative restricted log-likelihood, +∞ without one.
    pub(crate) fn cost(&self, terms: &CompositeTerms) -> f64 {
        let likelihood = || -> Option<f64> {
            let filter = terms.to_shaping(self.interval).ok()?;
            Some(self.restricted(&filter).ok()? + (self.beside)(&filter))
        };
        likelihood().map_or(f64::INFINITY, |found| -found)
    }

    /// The restricted log-likelihood of all records under the filter of a sample.
    pub(crate) fn restricted(&self, filter: &ShapingFilter) -> Result<f64, CompositeError> {
        let records = self.under(filter)?;
        Ok(records.iter().map(RecordLikelihood::restricted).sum())
    }
}
