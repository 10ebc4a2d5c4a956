//! The parts of records that candidates are fitted to and scored on.
//!
//! Records are scored both ways, so that one quiet half does not decide alone: a stationary normal process
//! looks the same in both directions of time, and so do the increments of a random walk.
//!
//! | records | folds |
//! |---|---|
//! | one | first half fitted, second scored; then the same of the record reversed |
//! | up to [`LEFT_OUT_SINGLY`] | each withheld in turn: fitted to the others, scored on both halves of it |
//! | more | two groups, every second record |
//!
//! The filter runs through the fitted half before it scores the other one, so its state has
//! settled.

use super::LEFT_OUT_SINGLY;
use crate::{
    allan::{self, Curve, DeviationKind, Grid, Terms},
    compared::{Method, Unfit},
    composite::{self, Averages, Blocks, CompositeTerms, Marginal, NO_MARGINAL},
    drift_score::Parts,
    screening::bridge::{bridge, inflation},
    wavelet::WaveletVariance,
};

/// Records, or half of one.
pub(super) struct TrainingSet<'a> {
    pub(super) records: Vec<&'a [f64]>,
    /// They end to end, straight lines over what is missing: of the products of samples, few are of two records.
    pub(super) end_to_end: Vec<f64>,
    /// Sample rate \[Hz\].
    pub(super) rate_hz: f64,
    /// Overlapping Allan deviation, pooled over the records.
    pub(super) curve: Curve,
    /// Its terms, the white noise corrected for bridged samples.
    pub(super) allan: Terms,
    /// Wavelet variance that sums of terms start from, pooled over the records; none that can be fitted without one.
    pub(super) wavelet: Option<WaveletVariance>,
    /// Averages of the records over the blocks; none where a record has not one.
    pub(super) averages: Option<Averages<'static>>,
    /// The blocks of the likelihood of a sum of terms: those of the whole, of a part too.
    pub(super) blocks: Blocks,
    /// What is integrated out beside the levels: of the whole the effect of temperature, of parts
    /// nothing.
    pub(super) marginal: Marginal<'a>,
}

/// What is fitted, and the records to score, the samples that come before the scored ones first; one that cannot be scored is `None`.
pub(super) struct Fold<'a> {
    pub(super) fitted: TrainingSet<'a>,
    pub(super) scored: Vec<Option<Parts<'a>>>,
}

/// Each record with straight lines over what is missing.
pub(super) fn bridged(records: &[&[f64]]) -> Vec<Vec<f64>> {
    records.iter().map(|record| bridge(record, 0.0)).collect()
}

/// Records in one.
pub(super) fn end_to_end(mut records: Vec<Vec<f64>>) -> Vec<f64> {
    match records.len() {
        1 => records.swap_remove(0),
        _ => records.concat(),
    }
}

impl<'a> TrainingSet<'a> {
    /// The Allan deviation of the records and its terms; `None` where they cannot be fitted.
    pub(super) fn new(records: Vec<&'a [f64]>, rate_hz: f64, blocks: Blocks) -> Option<Self> {
        let bridged = bridged(&records);
        let curve = |record: &Vec<f64>| {
            allan::deviations(record, rate_hz, DeviationKind::Overlapping, Grid::Octave).ok()
        };
        let curves: Option<Vec<_>> = bridged.iter().map(curve).collect();
        let curve = allan::pooled(&curves?)?;
        let inflation = inflation(&records);
        Some(Self {
            wavelet: composite::curve(&records, 1.0 / rate_hz).ok(),
            averages: blocks.averages(&records, 1.0 / rate_hz),
            records,
            end_to_end: end_to_end(bridged),
            rate_hz,
            allan: allan::fit_terms(&curve).ok()?.with_less_white(inflation),
            curve,
            blocks,
            marginal: NO_MARGINAL,
        })
    }

    /// The model of a method of the literature, of the records end to end.
    /// # Errors
    /// As [`Method::fit`].
    pub(super) fn compared(&self, method: Method) -> Result<CompositeTerms, Unfit> {
        method.fit(&self.end_to_end, &self.curve, &self.allan)
    }
}

impl<'a> Fold<'a> {
    /// Half of a record before the sample `first`, to be fitted, with the rest to be scored.
    fn from_half(record: &'a [f64], first: usize, rate_hz: f64, blocks: Blocks) -> Option<Self> {
        Some(Self {
            fitted: TrainingSet::new(vec![&record[..first]], rate_hz, blocks)?,
            scored: vec![Parts::new(record, first).ok()],
        })
    }

    /// The folds of records and the same reversed: of one its halves, of several one record after the other left
    /// out (of many every second one), whose halves are scored both ways.
    ///
    /// A fold that cannot be fitted is missing from the result.
    pub(super) fn all(
        records: &[&'a [f64]],
        reversed: &'a [Vec<f64>],
        rate_hz: f64,
        blocks: Blocks,
    ) -> Vec<Self> {
        let middle = |record: &[f64]| record.len() / 2;
        if let ([record], [backward]) = (records, reversed) {
            let halves = [
                Self::from_half(record, middle(record), rate_hz, blocks),
                Self::from_half(backward, record.len() - middle(record), rate_hz, blocks),
            ];
            return halves.into_iter().flatten().collect();
        }
        let groups = match records.len() {
            n if n <= LEFT_OUT_SINGLY => n,
            _ => 2,
        };
        let fold = |group: usize| {
            let (mut fitted, mut scored) = (Vec::new(), Vec::new());
            for (k, (record, backward)) in records.iter().zip(reversed).enumerate() {
                if k % groups == group {
                    scored.push(Parts::new(record, middle(record)).ok());
                    scored.push(Parts::new(backward, record.len() - middle(record)).ok());
                } else {
                    fitted.push(*record);
                }
            }
            let fitted = TrainingSet::new(fitted, rate_hz, blocks)?;
            Some(Self { fitted, scored })
        };
        (0..groups).filter_map(fold).collect()
    }
}
