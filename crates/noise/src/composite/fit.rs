//! Composite terms by maximum likelihood.

use super::averages::{Averages, Marginal, NO_MARGINAL, OVERLAP_COORDINATE, curve};
use super::search::covariance;
use crate::quasi_newton::{Objective, Point, best_of};
use crate::terms::{
    CompositeError, CompositeTerms, GaussMarkov, MAX_GAUSS_MARKOV, SCALES, TermSet, sort_processes,
};
use crate::wavelet::{MomentFit, WaveletVariance, fit_moments, model_variance};
use serde::{Deserialize, Serialize};
use undrift_nav::shaping::{ShapingError, ShapingFilter};

/// A term whose removal costs less log-likelihood than this is not needed: its 2Δ is below the 5 %
/// point of χ² with one degree of freedom (3.84), and at a boundary that is on the safe side.
const NEEDED: f64 = 1.92;
/// A term whose removal costs less than this is not there: it would be a state without effect.
const VANISHED: f64 = 0.01;
/// All terms, the slow ones first.
const TERMS: [Term; 4 + MAX_GAUSS_MARKOV] = [
    Term::RandomWalk,
    Term::Flicker,
    Term::GaussMarkov(1),
    Term::GaussMarkov(0),
    Term::Quantisation,
    Term::White,
];
/// Share by which the record's wavelet variance at one sample may differ from the model's.
const SHORT_MEMORY: f64 = 0.05;

/// Coordinate of the overlap that searches start at: the covariance of blocks of a dozen correlation times.
const OVERLAP_START: f64 = 0.04 * OVERLAP_COORDINATE;
/// Standard errors within which the white density of the full rate is that of the blocks.
const SAME_WHITE: f64 = 3.0;
/// Standard errors within which the variance of a scale is that of the terms.
const SAME_SCALE: f64 = 4.0;
/// Relative error above which the blocks' white density is too uncertain to be compared.
const KNOWN: f64 = 0.1;

/// Options of a fit of composite terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// Largest number of points: a longer record is averaged in blocks until that many or fewer are left.
    pub max_points: usize,
    /// Number of samples to a block, where it is to be that of another fit: of the whole record for a part of it, so that both see the
    /// same scales.
    pub block: Option<usize>,
    /// Whether white noise is behind a low-pass filter whose memory is shorter than a block: how much neighbouring blocks are correlated is then
    /// estimated beside the terms, and N is that of the noise over many blocks. Not with quantisation, of which it is the opposite.
    pub filtered: bool,
    /// Terms near which the optimum lies: the search starts there alone, which is quicker. `None`: from wavelet moments.
    pub start: Option<CompositeTerms>,
}

impl Default for FitOptions {
    /// 50 000 points.
    fn default() -> Self {
        Self {
            max_points: 50_000,
            block: None,
            filtered: false,
            start: None,
        }
    }
}

/// One term of a composite model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// White noise.
    White,
    /// Quantisation.
    Quantisation,
    /// Random walk.
    RandomWalk,
    /// Flicker noise.
    Flicker,
    /// The Gauss-Markov process of this index.
    GaussMarkov(usize),
}

/// Remark on a fit, to be read beside its numbers.
///
/// `undrift-report` has their sentences. [`Flag::ShortMemory`] and [`Flag::LongCorrelation`] are about the record,
/// not the fit: a sensor behind a low-pass filter has the first, a random walk fitted as a process the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flag {
    /// The likelihood does not want this term (removing it costs less than 0.01): it is 0 in the
    /// result. The index of a Gauss-Markov process is that before the removal.
    Vanished(Term),
    /// Without this term, all else kept, the log-likelihood falls by less than 1.92.
    NotNeeded(Term),
    /// The correlation time of this process exceeds a tenth of the record: a random walk in effect.
    LongCorrelation(usize),
    /// At one sample the record's wavelet variance is this multiple of the model's, more than 5 %
    /// off, and more than the error of the blocks' white density explains: the sensor has a short memory that blocks do not see. The white density here is that
    /// of the blocks, which is what drifts.
    ShortMemory(f64),
    /// Some direction of the parameters is not determined: no standard errors.
    Undetermined,
    /// The search stopped short of its tolerance.
    NotConverged,
}

/// Composite terms fitted to a record by maximum likelihood.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CompositeFit {
    /// The terms, Gauss-Markov processes by growing τ.
    #[serde(skip)]
    pub terms: CompositeTerms,
    /// Standard errors of the logarithm of each parameter, from the curvature of the blocks'
    /// likelihood at its optimum.
    pub relative_errors: Option<CompositeTerms>,
    /// Exact restricted log-likelihood of the block averages, at its optimum.
    pub log_likelihood: f64,
    /// `−2 log L + 2k`, the level counted as a parameter.
    pub aic: f64,
    /// `−2 log L + k ln n`.
    pub bic: f64,
    /// Number of parameters, the level included.
    #[serde(skip)]
    pub parameters: usize,
    /// Number of samples averaged to a point.
    pub block: usize,
    /// Number of points present.
    #[serde(skip)]
    pub points: usize,
    /// Covariance of neighbouring blocks of white noise over its variance over many blocks, where [`FitOptions::filtered`] estimated it; else 0.
    #[serde(skip)]
    pub overlap: f64,
    /// Constant offset of the record \[unit\].
    #[serde(skip)]
    pub level: f64,
    /// White density [unit·√s] that the full rate shows beside the other terms: from the wavelet
    /// variance at one sample; 0 where these leave none.
    #[serde(skip)]
    pub white_full_rate: f64,
    /// The wavelet moments that the search started from: those of the scales of a block and more.
    #[serde(rename = "wavelet_moments")]
    pub moments: MomentFit,
    /// Remarks to be read beside the numbers.
    #[serde(skip)]
    pub flags: Vec<Flag>,
}

impl CompositeFit {
    /// The shaping filter of the terms at a sample interval \[s\].
    ///
    /// # Errors
    /// A bad interval.
    ///
    /// The interval need not be that of the record.
    ///
    /// ```
    /// use undrift_noise::composite::{CompositeTerms, FitOptions, TermSet, fit};
    /// use undrift_noise::synthesis::NoiseGenerator;
    /// let noise = CompositeTerms { white: 0.01, ..CompositeTerms::default() }.to_shaping(0.1)?;
    /// let record: Vec<f64> = NoiseGenerator::new(&noise, 1).take(2000).collect();
    /// let found = fit(&record, 0.1, TermSet { white: true, ..TermSet::default() }, &FitOptions::default())?;
    /// // White noise has its density at any rate: a tenth of the interval, ten times the variance of a sample.
    /// let (here, there) = (found.to_shaping(0.1)?, found.to_shaping(0.01)?);
    /// assert!((there.r / here.r - 10.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn to_shaping(&self, interval: f64) -> Result<ShapingFilter, ShapingError> {
        self.terms.to_shaping(interval)
    }
}

/// Fits the terms of `set` to a record sampled every `interval` \[s\] by exact maximum likelihood of
/// its block averages, whose model is that of the terms exactly ([`block_average`](super::block_average)); NaN is a
/// missing sample. A record of `max_points` or fewer is taken as it is. Else the white density is
/// that of the full rate (`white_full_rate`) where the two agree within three standard errors and
/// no scale shorter than a block shows a short memory; and quantisation, which blocks lose sight of, is found with the white
/// noise by likelihood from the first samples at the full rate, the slow terms held.
///
/// # Errors
/// A record too short, constant or infinite; an empty set; no finite likelihood at any start.
///
/// The level is integrated out under a flat prior (the restricted likelihood), so that criteria compare sets of
/// terms of one record, never records of different lengths or blocks. Correlation times are searched between a
/// twentieth of a block and a thousand records.
pub fn fit(
    record: &[f64],
    interval: f64,
    set: TermSet,
    options: &FitOptions,
) -> Result<CompositeFit, CompositeError> {
    fit_several(&[record], interval, set, options)
}

/// Fits several independent records of one process in the manner of [`fit`]: the likelihood is the product of theirs, each with a
/// start and a level of its own. The level reported is that of the first.
///
/// ```
/// use undrift_noise::composite::{CompositeTerms, FitOptions, TermSet, fit_several};
/// use undrift_noise::synthesis::NoiseGenerator;
/// let truth = CompositeTerms { white: 0.01, random_walk: 0.01, ..CompositeTerms::default() };
/// let filter = truth.to_shaping(0.1)?;
/// // Two switch-ons of one sensor, with other constants.
/// let record = |seed, level| NoiseGenerator::new(&filter, seed).take(2000).map(move |x| x + level).collect();
/// let (first, second): (Vec<f64>, Vec<f64>) = (record(1, 0.5), record(2, -0.3));
/// let set = TermSet { white: true, random_walk: true, ..TermSet::default() };
/// let found = fit_several(&[&first, &second], 0.1, set, &FitOptions::default())?;
/// assert!((found.terms.white / 0.01).ln().abs() < 0.1 && (found.terms.random_walk / 0.01).ln().abs() < 0.3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`fit`], of any of the records; no record at all.
pub fn fit_several(
    records: &[&[f64]],
    interval: f64,
    set: TermSet,
    options: &FitOptions,
) -> Result<CompositeFit, CompositeError> {
    let curve = curve(records, interval)?;
    fit_marginal(records, &curve, None, set, options, NO_MARGINAL)
}

/// Does [`fit_several`] with something else integrated out of the records, whose [`curve`] this is, and whose averages over
/// the blocks of the options are known or not.
pub(crate) fn fit_marginal(
    records: &[&[f64]],
    curve: &WaveletVariance,
    averages: Option<&Averages<'static>>,
    set: TermSet,
    options: &FitOptions,
    marginal: Marginal,
) -> Result<CompositeFit, CompositeError> {
    set.check()?;
    let interval = curve.interval;
    let samples: usize = records.iter().map(|record| record.len()).sum();
    let block = match options.block {
        Some(block) => block.max(1),
        None => samples.div_ceil(options.max_points.max(100)),
    };
    let full = fit_moments(curve, set, false);
    let moments = match fit_moments(&coarser(curve, block), set, false) {
        Ok(found) => found,
        Err(_) => full?,
    };
    let averages = match averages {
        Some(known) => known.clone(),
        None => Averages::new(records, block, interval)?,
    };
    let mut averages = averages.marginal(marginal);
    let filtered = options.filtered && set.white && !set.quantisation;
    let longest = records.iter().map(|record| record.len()).max();
    let length_s = longest.unwrap_or(0) as f64 * interval;
    let mut starts = match &options.start {
        Some(terms) => vec![set.coordinates(terms)],
        None => starts(set, &moments, full.ok(), length_s),
    };
    if filtered {
        starts.iter_mut().for_each(|z| z.push(OVERLAP_START));
    }
    let best = search(&averages, set, starts, length_s)?;

    let mut flags = Vec::new();
    if !best.converged {
        flags.push(Flag::NotConverged);
    }
    let overlap = best.z.get(set.parameters()).copied();
    averages.overlap = overlap.map_or(0.0, |x| x / OVERLAP_COORDINATE);
    let mut terms = set.terms(&best.z);
    sort_processes(&mut terms, None);
    let found = averages.likelihoods(&terms)?;
    let log_likelihood = -averages.cost(&terms);
    terms = without_useless(terms, log_likelihood, &averages, &mut flags);
    let left = terms.set();
    let mut z = left.coordinates(&terms);
    z.extend(overlap);
    let top = Point::new(z, -log_likelihood);
    let costs = |z: &[Vec<f64>]| z.iter().map(|z| averages.cost_at(left, z)).collect();
    let relative_errors = covariance(&mut Objective::new(&costs, SCALES), &top)
        .map(|covariance| left.relative_errors(&covariance));
    if relative_errors.is_none() {
        flags.push(Flag::Undetermined);
    }
    for (i, process) in terms.gauss_markov.iter().enumerate() {
        if process.sigma > 0.0 && process.tau_s > 0.1 * length_s {
            flags.push(Flag::LongCorrelation(i));
        }
    }
    if left.quantisation && left.white && block > 1 {
        (terms.white, terms.quantisation) = fast_terms(records, interval, &terms, options);
    }
    let ratio = full_rate_ratio(curve, &terms);
    let white_full_rate = full_rate_white(curve, &terms);
    let error = relative_errors.map_or(0.0, |e| e.white);
    let blocks_know = left.white && !set.quantisation && block > 1 && error < KNOWN;
    // The white density of blocks is not known to less.
    let of_chance = if blocks_know {
        2.0 * SAME_WHITE * error
    } else {
        0.0
    };
    if (ratio - 1.0).abs() > SHORT_MEMORY.max(of_chance) {
        flags.push(Flag::ShortMemory(ratio));
    } else if blocks_know && (white_full_rate / terms.white).ln().abs() < SAME_WHITE * error {
        let of_full_rate = CompositeTerms {
            white: white_full_rate,
            ..terms
        };
        // A filter near half the rate takes little of it, but more than the blocks' white density is uncertain by.
        if is_white_within(curve, block, &of_full_rate) {
            terms = of_full_rate;
        }
    }
    let parameters = set.parameters() + usize::from(filtered) + records.len();
    let points: usize = found.iter().map(|l| l.observations).sum();
    let (k, n) = (parameters as f64, points as f64);
    Ok(CompositeFit {
        white_full_rate,
        terms,
        relative_errors,
        log_likelihood,
        aic: -2.0 * log_likelihood + 2.0 * k,
        bic: -2.0 * log_likelihood + k * n.ln(),
        parameters,
        block,
        points,
        overlap: averages.overlap,
        level: found[0].level,
        moments,
        flags,
    })
}

/// Starts about the moments of the blocks' scales and, since only they see a fast process though a short memory
/// pulls them, the moments of all scales.
fn starts(
    set: TermSet,
    moments: &MomentFit,
    full: Option<MomentFit>,
    length_s: f64,
) -> Vec<Vec<f64>> {
    let mut starts = variants(&set.coordinates(&moments.terms), set, length_s);
    starts.extend(full.map(|m| set.coordinates(&m.terms)));
    starts
}

/// The most likely terms; the first start is the centre of what is searched.
fn search(
    averages: &Averages,
    set: TermSet,
    starts: Vec<Vec<f64>>,
    length_s: f64,
) -> Result<Point, CompositeError> {
    let taus = set.amplitudes()..set.parameters();
    let tau_range = (0.05 * averages.interval).ln()..(1e3 * length_s).ln();
    let centre = starts[0].clone();
    let cost = |z: &Vec<f64>| {
        let near = z.iter().zip(&centre).all(|(a, b)| (a - b).abs() < 25.0);
        if near && z[taus.clone()].iter().all(|t| tau_range.contains(t)) {
            averages.cost_at(set, z)
        } else {
            f64::INFINITY
        }
    };
    let costs = |z: &[Vec<f64>]| z.iter().map(cost).collect();
    best_of(&mut Objective::new(&costs, SCALES), starts, 2, 1e-5, 100)
        .ok_or(CompositeError::NoOptimum)
}

/// The terms less those that the likelihood does not want; flags them, and those it hardly needs.
fn without_useless(
    mut terms: CompositeTerms,
    log_likelihood: f64,
    averages: &Averages,
    flags: &mut Vec<Flag>,
) -> CompositeTerms {
    let fall = |terms: &CompositeTerms| log_likelihood + averages.cost(terms);
    for term in TERMS {
        let without = less(&terms, term);
        if without != terms && fall(&without) < VANISHED {
            terms = without;
            flags.push(Flag::Vanished(term));
        }
    }
    sort_processes(&mut terms, None);
    for term in TERMS {
        let without = less(&terms, term);
        if without != terms && fall(&without) < NEEDED {
            flags.push(Flag::NotNeeded(term));
        }
    }
    terms
}

/// The scales of `block` samples and more.
fn coarser(curve: &WaveletVariance, block: usize) -> WaveletVariance {
    let mut part = curve.clone();
    part.points.retain(|p| p.m >= block);
    part
}

/// The moments' own start, and for each process a tenth and ten times its correlation time at the
/// same drive, and the process as a random walk as slow as the record.
fn variants(centre: &[f64], set: TermSet, length_s: f64) -> Vec<Vec<f64>> {
    let mut starts = vec![centre.to_vec()];
    for i in 0..set.gauss_markov {
        let at = set.amplitudes() + i;
        for tau in [
            centre[at] - 10f64.ln(),
            centre[at] + 10f64.ln(),
            (0.3 * length_s).ln(),
        ] {
            let mut z = centre.to_vec();
            z[at] = tau;
            starts.push(z);
        }
    }
    starts
}

/// The terms less one.
fn less(terms: &CompositeTerms, term: Term) -> CompositeTerms {
    let mut without = *terms;
    match term {
        Term::White => without.white = 0.0,
        Term::Quantisation => without.quantisation = 0.0,
        Term::RandomWalk => without.random_walk = 0.0,
        Term::Flicker => without.flicker = 0.0,
        Term::GaussMarkov(i) => without.gauss_markov[i] = GaussMarkov::default(),
    }
    without
}

/// N and Q that the first samples of each record at the full rate make most likely, the slow terms held.
fn fast_terms(
    records: &[&[f64]],
    interval: f64,
    terms: &CompositeTerms,
    options: &FitOptions,
) -> (f64, f64) {
    let most = (2 * options.max_points.max(100)).div_ceil(records.len());
    let first = |record: &&[f64]| record[..record.len().min(most)].to_vec();
    let head = Averages::from_samples(records.iter().map(first).collect(), interval);
    let with = |z: &[f64]| CompositeTerms {
        white: z[0].exp(),
        quantisation: z[1].exp(),
        ..*terms
    };
    let start = vec![terms.white.ln(), terms.quantisation.ln()];
    let cost = |z: &Vec<f64>| match z.iter().zip(&start).any(|(a, b)| (a - b).abs() > 15.0) {
        true => f64::INFINITY,
        false => head.cost(&with(z)),
    };
    let costs = |z: &[Vec<f64>]| z.iter().map(cost).collect();
    let starts = vec![start.clone()];
    best_of(&mut Objective::new(&costs, SCALES), starts, 1, 1e-4, 60).map_or(
        (terms.white, terms.quantisation),
        |best| {
            let found = with(&best.z);
            (found.white, found.quantisation)
        },
    )
}

/// Ratio of the record's wavelet variance at one sample to that of the terms.
fn full_rate_ratio(curve: &WaveletVariance, terms: &CompositeTerms) -> f64 {
    match curve.points.first() {
        Some(point) => point.variance / model_variance(terms, point.m, curve.interval),
        None => 1.0,
    }
}

/// Whether all scales shorter than a block have the variance that the terms say, but for chance.
fn is_white_within(curve: &WaveletVariance, block: usize, terms: &CompositeTerms) -> bool {
    let mut shorter = curve.points.iter().filter(|point| point.m < block);
    shorter.all(|point| {
        let ratio = point.variance / model_variance(terms, point.m, curve.interval);
        ratio.ln().abs() < SAME_SCALE * (2.0 / point.edf).sqrt()
    })
}

/// White density that the wavelet variance at one sample leaves beside the other terms [unit·√s].
fn full_rate_white(curve: &WaveletVariance, terms: &CompositeTerms) -> f64 {
    let Some(point) = curve.points.first() else {
        return 0.0;
    };
    let rest = CompositeTerms {
        white: 0.0,
        ..*terms
    };
    let left = point.variance - model_variance(&rest, point.m, curve.interval);
    (2.0 * point.scale_s * left).max(0.0).sqrt()
}

#[cfg(test)]
mod tests;
