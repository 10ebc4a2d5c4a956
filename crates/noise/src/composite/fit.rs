//! Composite terms by maximum likelihood.

use super::blocks::{average_in_blocks, block_average};
use super::likelihood::{Level, log_likelihood};
use super::search::{Minimum, covariance, minimise};
use super::{
    CompositeError, CompositeTerms, GaussMarkov, MAX_GAUSS_MARKOV, TermSet, sort_processes,
};
use crate::wavelet::{MomentFit, WaveletVariance, fit_moments, model_variance, wavelet_variance};
use undrift_nav::shaping::{ShapingError, ShapingFilter};

/// A term whose removal costs less log-likelihood than this is not needed: its 2Δ is below the 5 %
/// point of χ² with one degree of freedom (3.84), and at a boundary that is on the safe side.
const NEEDED: f64 = 1.92;
/// A term whose removal costs less than this is not there: it would be a state without effect.
const VANISHED: f64 = 0.01;
/// All terms, the slow ones first.
const TERMS: [Term; 3 + MAX_GAUSS_MARKOV] = [
    Term::RandomWalk,
    Term::GaussMarkov(1),
    Term::GaussMarkov(0),
    Term::Quantisation,
    Term::White,
];
/// Share by which the record's wavelet variance at one sample may differ from the model's.
const SHORT_MEMORY: f64 = 0.05;

/// Standard errors within which the white density of the full rate is that of the blocks.
const SAME_WHITE: f64 = 3.0;
/// Relative error above which the blocks' white density is too uncertain to be compared.
const KNOWN: f64 = 0.1;

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FitOptions {
    /// A longer record is averaged in blocks until so many points or fewer are left.
    pub max_points: usize,
}

impl Default for FitOptions {
    /// 50 000 points.
    fn default() -> Self {
        Self { max_points: 50_000 }
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
    /// The Gauss-Markov process of this index.
    GaussMarkov(usize),
}

/// What should be said with a fit.
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
    /// off: the sensor has a short memory that blocks do not see. The white density here is that
    /// of the blocks, which is what drifts.
    ShortMemory(f64),
    /// Some direction of the parameters is not determined: no standard errors.
    Undetermined,
    /// The search stopped short of its tolerance.
    NotConverged,
}

/// Composite terms fitted to a record by maximum likelihood.
#[derive(Clone, Debug, PartialEq)]
pub struct CompositeFit {
    /// The terms, Gauss-Markov processes by growing τ.
    pub terms: CompositeTerms,
    /// Standard errors of the logarithm of each parameter, from the curvature of the blocks'
    /// likelihood at its optimum.
    pub relative_errors: Option<CompositeTerms>,
    /// Exact log-likelihood of the block averages, at its optimum.
    pub log_likelihood: f64,
    /// `−2 log L + 2k`, the level counted as a parameter.
    pub aic: f64,
    /// `−2 log L + k ln n`.
    pub bic: f64,
    /// Parameters, the level included.
    pub parameters: usize,
    /// Samples averaged to a point.
    pub block: usize,
    /// Points present.
    pub points: usize,
    /// Constant that the record stands on [unit].
    pub level: f64,
    /// White density [unit·√s] that the full rate shows beside the other terms: from the wavelet
    /// variance at one sample; 0 where these leave none.
    pub white_full_rate: f64,
    /// The wavelet moments that the search started from: those of the scales of a block and more.
    pub moments: MomentFit,
    /// What should be said with it.
    pub flags: Vec<Flag>,
}

impl CompositeFit {
    /// The shaping filter at a sample interval \[s\].
    ///
    /// # Errors
    /// A bad interval.
    pub fn to_shaping(&self, interval: f64) -> Result<ShapingFilter, ShapingError> {
        self.terms.to_shaping(interval)
    }
}

/// Fits the terms of `set` to a record sampled every `interval` \[s\] by exact maximum likelihood of
/// its block averages, whose model is that of the terms exactly ([`block_average`]); NaN is a
/// missing sample. A record of `max_points` or fewer is taken as it is. Else the white density is
/// that of the full rate (`white_full_rate`) where the two agree within three standard errors and
/// no short memory shows; and quantisation, which blocks lose sight of, is found with the white
/// noise by likelihood from the first samples at the full rate, the slow terms held.
///
/// # Errors
/// A record too short, constant or infinite; an empty set; no finite likelihood at any start.
pub fn fit(
    record: &[f64],
    interval: f64,
    set: TermSet,
    options: &FitOptions,
) -> Result<CompositeFit, CompositeError> {
    set.check()?;
    let curve = wavelet_variance(record, interval)?;
    let block = record.len().div_ceil(options.max_points.max(100));
    let full = fit_moments(&curve, set, false);
    let moments = match fit_moments(&coarser(&curve, block), set, false) {
        Ok(found) => found,
        Err(_) => full?,
    };
    let averages = average_in_blocks(record, block)?;
    let length_s = record.len() as f64 * interval;

    let count = set.parameters();
    let first_tau = set.amplitudes();
    let tau_range = (0.05 * interval).ln()..(1e3 * length_s).ln();
    let centre = set.coordinates(&moments.terms);
    let allowed = |z: &[f64]| {
        let near = z.iter().zip(&centre).all(|(a, b)| (a - b).abs() < 25.0);
        near && z[first_tau..].iter().all(|t| tau_range.contains(t))
    };
    let at = |terms: &CompositeTerms| {
        let filter = block_average(&terms.to_shaping(interval)?, block)?;
        log_likelihood(&averages, &filter, Level::Estimated)
    };
    let negative = |z: &[f64]| -> f64 {
        if !allowed(z) {
            return f64::INFINITY;
        }
        at(&set.terms(z)).map_or(f64::INFINITY, |l| -l.log_likelihood)
    };
    let mut objective = |z: &[f64]| negative(z);
    // All scales' moments too: a short memory pulls them, but only they see a fast process.
    let other = full.ok().map(|m| set.coordinates(&m.terms));
    let mut starts: Vec<(Vec<f64>, f64)> = variants(&centre, set, length_s)
        .into_iter()
        .chain(other)
        .map(|z| {
            let value = objective(&z);
            (z, value)
        })
        .collect();
    starts.sort_by(|a, b| a.1.total_cmp(&b.1));
    let best = starts
        .iter()
        .take(2)
        .map(|(z, _)| minimise(&mut objective, z, 1e-5, 100))
        .min_by(|a: &Minimum, b| a.value.total_cmp(&b.value))
        .filter(|least| least.value.is_finite())
        .ok_or(CompositeError::NoOptimum)?;

    let mut flags = Vec::new();
    if !best.converged {
        flags.push(Flag::NotConverged);
    }
    let mut terms = set.terms(&best.z);
    sort_processes(&mut terms, None);
    let found = at(&terms)?;
    let fall = |terms: &CompositeTerms| {
        at(terms).map_or(f64::INFINITY, |l| found.log_likelihood - l.log_likelihood)
    };
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
    let left = terms.set();
    let top = Minimum {
        z: left.coordinates(&terms),
        value: -found.log_likelihood,
        converged: true,
    };
    let mut around = |z: &[f64]| at(&left.terms(z)).map_or(f64::INFINITY, |l| -l.log_likelihood);
    let relative_errors = covariance(&mut around, &top).map(|all| left.relative_errors(&all));
    if relative_errors.is_none() {
        flags.push(Flag::Undetermined);
    }
    for (i, process) in terms.gauss_markov.iter().enumerate() {
        if process.sigma > 0.0 && process.tau_s > 0.1 * length_s {
            flags.push(Flag::LongCorrelation(i));
        }
    }
    if left.quantisation && left.white && block > 1 {
        (terms.white, terms.quantisation) = fast_terms(record, interval, &terms, options);
    }
    let ratio = full_rate_ratio(&curve, &terms);
    let white_full_rate = full_rate_white(&curve, &terms);
    if (ratio - 1.0).abs() > SHORT_MEMORY {
        flags.push(Flag::ShortMemory(ratio));
    } else if left.white && !set.quantisation && block > 1 {
        let error = relative_errors.map_or(0.0, |e| e.white);
        let known = error < KNOWN;
        if known && (white_full_rate / terms.white).ln().abs() < SAME_WHITE * error {
            terms.white = white_full_rate;
        }
    }
    let parameters = count + 1;
    let (k, n) = (parameters as f64, found.observations as f64);
    Ok(CompositeFit {
        white_full_rate,
        terms,
        relative_errors,
        log_likelihood: found.log_likelihood,
        aic: -2.0 * found.log_likelihood + 2.0 * k,
        bic: -2.0 * found.log_likelihood + k * n.ln(),
        parameters,
        block,
        points: found.observations,
        level: found.level,
        moments,
        flags,
    })
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
        Term::GaussMarkov(i) => without.gauss_markov[i] = GaussMarkov::default(),
    }
    without
}

/// N and Q that the first samples at the full rate make most likely, the slow terms held.
fn fast_terms(
    record: &[f64],
    interval: f64,
    terms: &CompositeTerms,
    options: &FitOptions,
) -> (f64, f64) {
    let head = &record[..record.len().min(2 * options.max_points.max(100))];
    let with = |z: &[f64]| CompositeTerms {
        white: z[0].exp(),
        quantisation: z[1].exp(),
        ..*terms
    };
    let start = [terms.white.ln(), terms.quantisation.ln()];
    let mut objective = |z: &[f64]| {
        if z.iter().zip(&start).any(|(a, b)| (a - b).abs() > 15.0) {
            return f64::INFINITY;
        }
        with(z)
            .to_shaping(interval)
            .map_err(CompositeError::from)
            .and_then(|filter| log_likelihood(head, &filter, Level::Estimated))
            .map_or(f64::INFINITY, |l| -l.log_likelihood)
    };
    let best = minimise(&mut objective, &start, 1e-4, 60);
    let found = with(&best.z);
    (found.white, found.quantisation)
}

fn full_rate_ratio(curve: &WaveletVariance, terms: &CompositeTerms) -> f64 {
    match curve.points.first() {
        Some(point) => point.variance / model_variance(terms, point.m, curve.interval),
        None => 1.0,
    }
}

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
