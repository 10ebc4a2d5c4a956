//! Several records of one sensor, or of sensors of one type: one model of what happens within a record, the spread of
//! the constants between them, and the record that differs.
//!
//! Within: the records are independent, with the same parameters and each with a start and a level of its own, so
//! that the log-likelihood of each candidate is the sum of theirs.

mod between;
mod homogeneity;

pub use between::Between;
pub use homogeneity::{Difference, Ratio};

use super::{Axis, Candidate, IdentifyError, Options, RecordRemark, conclude, prepare, turn_on_of};
use crate::composite::{Averages, CompositeTerms};
use homogeneity::Records;

/// Points, of all records together, that records are compared on.
const POINTS: usize = 20_000;

/// A record of one axis, and what it is identified with.
#[derive(Clone, Copy, Debug)]
pub struct Sampled<'a> {
    /// Samples in SI units, evenly spaced.
    pub samples: &'a [f64],
    /// At the same rate in all of a pool.
    pub options: Options<'a>,
}

/// Why records have no model together: the one that cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub struct PoolError {
    /// Position of the record; `None` where it is of all.
    pub record: Option<usize>,
    /// What is wrong.
    pub error: IdentifyError,
}

/// What one record adds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Share {
    /// Samples.
    pub samples: usize,
    /// Their mean \[unit\].
    pub mean: f64,
    /// The constant at its start by the pooled model, its slow error allowed for \[unit\].
    pub level: f64,
    /// Standard error of that within the record \[unit\]; NaN where the model has no likelihood.
    pub level_standard_error: f64,
    /// Samples left out as outliers.
    pub outliers: usize,
    /// Groups of them, a second and more apart.
    pub outlier_events: usize,
    /// White noise against that of the other records.
    pub white: Ratio,
    /// Slow part against that of the others; `None` where the model has none.
    pub slow: Option<Ratio>,
    /// Probability of a difference as large among records of one process.
    pub p_value: f64,
    /// What should be said with the record; of the longest the axis has it.
    pub remarks: Vec<RecordRemark>,
}

/// What records of one axis, identified together, show beyond its model.
#[derive(Clone, Debug, Default)]
pub struct Pool {
    /// The records in the order given.
    pub records: Vec<Share>,
    /// The spread of their constants.
    pub between: Between,
    /// Mean of the constants beyond gravity \[unit\], as one record's constant is taken.
    pub common: f64,
    /// Likelihood ratio of white noise and slow part of each record's own against those of all, over [`Pool::inflation`].
    pub likelihood_ratio: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: f64,
    /// How much halves of one record differ more than the model allows, at least 1.
    pub inflation: f64,
    /// Probability of a ratio as large among records of one process.
    pub p_value: f64,
    /// The records that differ.
    pub differing: Vec<Difference>,
}

/// Identifies one axis from several records of it: the model of all, with tests, spectrum and correlations of the
/// longest, and what they show beyond it. `level` is the probability of taking any of them for different though
/// all are of one process.
///
/// ```
/// use undrift_noise::{composite::CompositeTerms, identify::{Options, Sampled, identify_pool}, synthesis::NoiseGenerator};
/// // Two recordings of ten minutes at 10 Hz of a gyro whose turn-on constant differs from one to the other.
/// let noise = CompositeTerms { white: 1e-3, random_walk: 1e-5, ..CompositeTerms::default() }.to_shaping(0.1)?;
/// let record = |seed, constant| -> Vec<f64> { NoiseGenerator::new(&noise, seed).take(6000).map(|x| x + constant).collect() };
/// let records = [record(1, 0.01), record(2, -0.02)];
/// let sampled = records.each_ref().map(|samples| Sampled { samples, options: Options::at(10.0) });
/// let (axis, pool) = identify_pool(&sampled, false, 0.01).map_err(|error| error.error)?;
/// assert!(pool.differing.is_empty(), "the constants are no part of the model of what happens within a record");
/// assert!((axis.allan_terms.white.value / 1e-3 - 1.0).abs() < 0.05);
/// assert!((pool.between.scatter - 0.03 / 2f64.sqrt()).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// See [`super::identify`], with the record.
pub fn identify_pool(
    records: &[Sampled<'_>],
    accelerometer: bool,
    level: f64,
) -> Result<(Axis, Pool), PoolError> {
    let in_record = |record| move |error| PoolError { record, error };
    let longest = (0..records.len()).max_by_key(|k| (records[*k].samples.len(), records.len() - k));
    let longest = longest.ok_or(PoolError {
        record: None,
        error: IdentifyError::NoCandidate,
    })?;
    let mut prepared = Vec::with_capacity(records.len());
    for (k, record) in records.iter().enumerate() {
        let one = prepare(record.samples, &record.options).map_err(in_record(Some(k)))?;
        prepared.push(one);
    }
    let rate_hz = records[longest].options.rate_hz;
    let apart = rate_hz.ceil() as usize;
    let mut shares: Vec<Share> = Vec::new();
    for (k, one) in prepared.iter_mut().enumerate() {
        let outliers = &one.screened.outliers;
        let gaps = outliers.windows(2);
        let gaps = gaps.filter(|pair| pair[1].index - pair[0].index >= apart);
        shares.push(Share {
            samples: one.samples,
            mean: one.screened.mean,
            level: one.screened.mean,
            level_standard_error: f64::NAN,
            outliers: outliers.len(),
            outlier_events: gaps.count() + usize::from(!outliers.is_empty()),
            remarks: match k == longest {
                true => Vec::new(),
                false => std::mem::take(&mut one.remarks),
            },
            ..Share::default()
        });
    }
    prepared.swap(0, longest);
    let concluded = conclude(prepared, accelerometer, &records[longest].options);
    let (axis, mut cleaned) = concluded.map_err(in_record(None))?;
    cleaned.swap(0, longest);

    let terms = terms(&axis);
    let cleaned: Vec<&[f64]> = cleaned.iter().map(Vec::as_slice).collect();
    let block = axis.samples.div_ceil(POINTS).max(1);
    let likely = Averages::new(&cleaned, block, 1.0 / rate_hz)
        .and_then(|averages| averages.likelihoods(&terms));
    for (share, found) in shares.iter_mut().zip(likely.iter().flatten()) {
        share.level = share.mean + found.level;
        share.level_standard_error = found.level_standard_error;
    }
    let compared = Records::new(&cleaned, block, 1.0 / rate_hz, terms);
    let found = compared.compare(&mut shares, level);
    let between = Between::new(shares.iter().map(|s| (s.level, s.level_standard_error)));
    let pool = Pool {
        common: turn_on_of(between.mean, accelerometer),
        between,
        records: shares,
        likelihood_ratio: found.likelihood_ratio,
        degrees_of_freedom: found.degrees_of_freedom,
        inflation: found.inflation,
        p_value: found.p_value,
        differing: found.differing,
    };
    Ok((axis, pool))
}

/// The sum of terms that records are compared by: the recommended one, else the most likely one, else white noise.
fn terms(axis: &Axis) -> CompositeTerms {
    let chosen = axis.recommended().composite();
    let sums = axis.candidates.iter().filter(|c| c.composite().is_some());
    let likeliest = sums.min_by(|a, b| a.aic.total_cmp(&b.aic));
    let fit = chosen.or(likeliest.and_then(Candidate::composite));
    fit.map_or(
        CompositeTerms {
            white: axis.allan_terms.white.value.max(f64::MIN_POSITIVE),
            ..CompositeTerms::default()
        },
        |fit| fit.terms,
    )
}
