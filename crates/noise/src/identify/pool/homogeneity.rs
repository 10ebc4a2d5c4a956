//! Whether records share one model, and which does not.
//!
//! Of each record the pooled terms are scaled: white noise, quantisation and processes too fast to drift by one factor, the slow terms by another. The
//! statistic of a record is the likelihood ratio of own factors against those of the others, which has a χ² distribution with as many
//! degrees of freedom as factors. Long real records are never exactly of the model, and then differ from themselves:
//! the same ratio between the halves of each record, over its degrees of freedom and at least 1, divides it (the scale of
//! an overdispersed likelihood, McCullagh & Nelder 1989, section 4.5). Since the smallest difference is significant in a record that is long
//! enough, a factor has to be large besides. Outliers are compared by groups a second apart: given how many there are in all,
//! those of one record are binomial in its share of the time.
//!
//! The record that differs most is set aside and the others are compared again, else it would make all of them differ.
//!
//! The order of the factors: the first scales white noise, quantisation and processes with τ < 1 s;
//! the second random walk, flicker and slower processes, and exists only where the pooled model has
//! such terms. All standard deviations, so a factor of 2 is four times the variance.
//!
//! What it cannot do: with two records it cannot say which of them is unusual, and it does not
//! refit the model: a record with another *kind* of noise shows as a factor, not as another model.

use super::Share;
use crate::composite::{Averages, CompositeTerms, GaussMarkov};
use crate::quasi_newton::{Objective, Point, bfgs};
use crate::terms::SCALES;
use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF};

/// Factors that matter.
const WHITE: f64 = 1.25;
const SLOW: f64 = 1.5;
/// Correlation time below which a process counts with the white noise, from which a record may not tell it \[s\]: the
/// shortest horizon of drift.
const SLOW_S: f64 = 1.0;
/// Share of the outliers' rate of the others.
///
/// A rate of outliers below three times that of the others is not reported.
const OUTLIERS: f64 = 3.0;
/// Level at which a factor itself has to differ.
const ITSELF: f64 = 0.01;
/// Largest logarithm of a factor.
const FURTHEST: f64 = 12.0;
/// Predicted decrease of the negative log-likelihood at which a search for factors ends.
const TOLERANCE: f64 = 1e-4;

/// A factor by which one record differs from the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// The factor on the standard deviation [–].
    pub factor: f64,
    /// Probability of one as far from 1 in records of one process; 1 where it was not looked at.
    pub p_value: f64,
}

impl Default for Ratio {
    fn default() -> Self {
        Self {
            factor: 1.0,
            p_value: 1.0,
        }
    }
}

/// A record that differs from the others of its sensor, and in what.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Position of the record.
    pub record: usize,
    /// Position of the other record where there are only two: which of them is unusual cannot be decided.
    pub other: Option<usize>,
    /// White noise in multiples of that of the others [–].
    pub white: Option<f64>,
    /// Slow part in multiples of that of the others [–].
    pub slow: Option<f64>,
    /// Rate of outliers in multiples of that of the others [–]; infinite where they have none.
    pub outliers: Option<f64>,
    /// Probability of such a difference, or a larger one, in records of one process.
    pub p_value: f64,
}

/// What the records show together.
pub(super) struct Compared {
    /// 2 (Σ log L of own factors − log L of common ones), divided by the inflation [–].
    pub(super) likelihood_ratio: f64,
    /// Factors times (records − 1).
    pub(super) degrees_of_freedom: f64,
    /// Scale by which likelihood ratios were divided, 1 or more [–].
    pub(super) inflation: f64,
    /// Probability of as large a ratio in records of one process.
    pub(super) p_value: f64,
    /// The records set aside, in the order in which they were.
    pub(super) differing: Vec<Difference>,
}

/// Records and the terms that are scaled.
pub(super) struct Records {
    /// Block averages of each record; `None` of one that is too short.
    whole: Vec<Option<Averages<'static>>>,
    /// Of its first and second half.
    halves: Vec<[Option<Averages<'static>>; 2]>,
    /// The pooled model.
    terms: CompositeTerms,
    /// 1, or 2 with slow terms.
    factors: usize,
}

/// A most likely pair of factors, in logarithms, and the negative log-likelihood there.
struct Best {
    at: Vec<f64>,
    cost: f64,
}

impl Records {
    /// `interval` \[s\] between samples, `block` samples to an average: those that the pooled model
    /// was fitted with.
    pub(super) fn new(
        records: &[&[f64]],
        block: usize,
        interval: f64,
        terms: CompositeTerms,
    ) -> Self {
        let averages = |record: &[f64]| Averages::new(&[record], block, interval).ok();
        let set = terms.set();
        let processes = || terms.gauss_markov.iter().filter(|g| g.sigma > 0.0);
        let is_slow = set.random_walk || set.flicker || processes().any(|g| g.tau_s >= SLOW_S);
        let halves = |record: &&[f64]| {
            let (first, second) = record.split_at(record.len() / 2);
            [averages(first), averages(second)]
        };
        Self {
            whole: records.iter().map(|record| averages(record)).collect(),
            halves: records.iter().map(halves).collect(),
            terms,
            factors: 1 + usize::from(is_slow),
        }
    }

    /// The terms with their factors, in logarithms; without a second one the slow terms as they are.
    fn scaled(&self, at: &[f64]) -> CompositeTerms {
        let slow = at.get(1).copied().unwrap_or(0.0).exp();
        let fast = at[0].exp();
        CompositeTerms {
            white: self.terms.white * fast,
            quantisation: self.terms.quantisation * fast,
            gauss_markov: self.terms.gauss_markov.map(|process| {
                let factor = if process.tau_s < SLOW_S { fast } else { slow };
                GaussMarkov {
                    sigma: process.sigma * factor,
                    ..process
                }
            }),
            ..self.terms.scaled(slow)
        }
    }

    /// Negative log-likelihood of some averages where the terms have these factors, in logarithms.
    ///
    /// +∞ beyond e^12 either way, where a factor has left any meaning.
    fn cost(&self, of: &[&Averages], at: &[f64]) -> f64 {
        if at.iter().any(|z| z.abs() > FURTHEST) {
            return f64::INFINITY;
        }
        let terms = self.scaled(at);
        of.iter().map(|averages| averages.cost(&terms)).sum()
    }

    /// The least of `cost` from a start, by BFGS.
    fn least(cost: &dyn Fn(&[f64]) -> f64, start: Vec<f64>) -> Best {
        let all = |z: &[Vec<f64>]| z.iter().map(|z| cost(z)).collect();
        let value = cost(&start);
        let start = Point::new(start, value);
        let best = bfgs(&mut Objective::new(&all, SCALES), &start, TOLERANCE, 60);
        Best {
            at: best.z,
            cost: best.value,
        }
    }

    /// The most likely factors of some averages.
    /// From factors of 1, by BFGS in their logarithms.
    fn best(&self, of: &[&Averages]) -> Best {
        Self::least(&|at| self.cost(of, at), vec![0.0; self.factors])
    }

    /// The likelihood ratio of one factor that differs between the sets, the other one of each its own.
    ///
    /// Both of a set's other factors stay free: the ratio is of this factor alone, with one degree
    /// of freedom.
    fn ratio_of(&self, factor: usize, a: (&[&Averages], &Best), b: (&[&Averages], &Best)) -> f64 {
        let with = |shared: f64, own: Option<&f64>| -> Vec<f64> {
            let mut factors = vec![shared; self.factors];
            if let (Some(own), Some(slot)) = (own, factors.get_mut(1 - factor)) {
                *slot = *own;
            }
            factors
        };
        let cost = |at: &[f64]| {
            self.cost(a.0, &with(at[0], at.get(1))) + self.cost(b.0, &with(at[0], at.get(2)))
        };
        // Where a term vanished the likelihood is flat: from either optimum.
        let from = |shared: &Best| {
            let mut start = vec![shared.at[factor]];
            start.extend(
                [a, b]
                    .iter()
                    .filter_map(|(_, best)| best.at.get(1 - factor)),
            );
            Self::least(&cost, start).cost
        };
        finite(2.0 * (from(a.1).min(from(b.1)) - a.1.cost - b.1.cost))
    }

    /// How much the halves of a record differ, over what the model allows.
    /// The mean of the halves' likelihood ratios over their degrees of freedom, at least 1.
    fn inflation(&self) -> f64 {
        let ratios = self.halves.iter().filter_map(|halves| match halves {
            [Some(first), Some(second)] => {
                let joint = self.best(&[first, second]).cost;
                let own = self.best(&[first]).cost + self.best(&[second]).cost;
                Some(finite(2.0 * (joint - own)))
            }
            _ => None,
        });
        let ratios: Vec<f64> = ratios.collect();
        let freedom = (self.factors * ratios.len()).max(1) as f64;
        (ratios.iter().sum::<f64>() / freedom).max(1.0)
    }

    /// Compares every record with the others, fills in what was found of each, and returns those that differ, at a level
    /// for all of them together.
    ///
    /// `level` is the probability of a false difference in all records and both kinds of test
    /// together (Bonferroni). O(records²) fits of one or two factors each.
    pub(super) fn compare(&self, shares: &mut [Share], level: f64) -> Compared {
        let inflation = self.inflation();
        let all = self.whole.iter().enumerate();
        let mut left: Vec<(usize, &Averages)> = all
            .filter_map(|(k, record)| Some((k, record.as_ref()?)))
            .collect();
        let records: Vec<&Averages> = left.iter().map(|(_, record)| *record).collect();
        let own: Vec<Best> = records.iter().map(|record| self.best(&[record])).collect();
        let separate: f64 = own.iter().map(|best| best.cost).sum();
        let likelihood_ratio = finite(2.0 * (self.best(&records).cost - separate)) / inflation;
        let degrees_of_freedom = (self.factors * records.len().saturating_sub(1)) as f64;
        // Noise and outliers of every record.
        let each = level / (2.0 * shares.len().max(1) as f64);
        let mut differing: Vec<Difference> = Vec::new();
        while left.len() > 1 {
            let Some(worst) = self.worst(&left, inflation, each, shares) else {
                break;
            };
            left.retain(|(k, _)| *k != worst.record);
            differing.push(worst);
            if worst.other.is_some() {
                break;
            }
        }
        outliers(shares, each, &mut differing);
        Compared {
            likelihood_ratio,
            degrees_of_freedom,
            inflation,
            p_value: upper(degrees_of_freedom, likelihood_ratio),
            differing,
        }
    }

    /// The record of those left that differs most from the others, if it does; fills in what was found of each.
    ///
    /// A record has to pass three conditions: its p value below the level for each, a factor above
    /// [`WHITE`] or [`SLOW`] either way, and that factor itself significant at 1 %.
    fn worst(
        &self,
        left: &[(usize, &Averages)],
        inflation: f64,
        each: f64,
        shares: &mut [Share],
    ) -> Option<Difference> {
        let records: Vec<&Averages> = left.iter().map(|(_, record)| *record).collect();
        let joint = self.best(&records).cost;
        let mut worst: Option<(f64, Difference)> = None;
        for (at, (k, record)) in left.iter().enumerate() {
            let others: Vec<&Averages> = [&records[..at], &records[at + 1..]].concat();
            let mine = [*record];
            let (best, theirs) = (self.best(&mine), self.best(&others));
            let ratio = finite(2.0 * (joint - best.cost - theirs.cost)) / inflation;
            let factor = |factor: usize| {
                let ratio = self.ratio_of(factor, (&mine, &best), (&others, &theirs));
                Ratio {
                    factor: (best.at[factor] - theirs.at[factor]).exp(),
                    p_value: upper(1.0, ratio / inflation),
                }
            };
            let (white, slow) = (factor(0), (self.factors > 1).then(|| factor(1)));
            let p_value = upper(self.factors as f64, ratio);
            shares[*k].white = white;
            shares[*k].slow = slow;
            shares[*k].p_value = p_value;
            let large = |ratio: Ratio, least: f64| {
                let is_large = ratio.factor.ln().abs() > least.ln() && ratio.p_value < ITSELF;
                is_large.then_some(ratio.factor)
            };
            let difference = Difference {
                record: *k,
                other: (left.len() == 2).then(|| left[1 - at].0),
                white: large(white, WHITE),
                slow: slow.and_then(|slow| large(slow, SLOW)),
                outliers: None,
                p_value,
            };
            let differs = p_value < each && difference.white.or(difference.slow).is_some();
            if differs && worst.as_ref().is_none_or(|(most, _)| ratio > *most) {
                worst = Some((ratio, difference));
            }
        }
        worst.map(|(_, difference)| difference)
    }
}

/// Adds the records with more groups of outliers than their share of the time explains.
///
/// Needs at least one group of outliers in the record; others' rate of zero gives an infinite
/// factor.
fn outliers(shares: &[Share], each: f64, differing: &mut Vec<Difference>) {
    let events: usize = shares.iter().map(|share| share.outlier_events).sum();
    let samples: usize = shares.iter().map(|share| share.samples).sum();
    for (record, share) in shares.iter().enumerate() {
        let (own, time) = (share.outlier_events, share.samples as f64 / samples as f64);
        let rate_of_others = (events - own) as f64 / (1.0 - time);
        let factor = own as f64 / time / rate_of_others;
        let Some(before) = own.checked_sub(1).filter(|_| factor > OUTLIERS) else {
            continue;
        };
        let binomial = Binomial::new(time, events as u64);
        let p_value = binomial.map_or(1.0, |binomial| binomial.sf(before as u64));
        if p_value >= each {
            continue;
        }
        if let Some(known) = differing.iter_mut().find(|known| known.record == record) {
            known.outliers = Some(factor);
        } else {
            differing.push(Difference {
                record,
                other: None,
                white: None,
                slow: None,
                outliers: Some(factor),
                p_value,
            });
        }
    }
}

/// P(χ² > x).
fn upper(freedom: f64, x: f64) -> f64 {
    ChiSquared::new(freedom).map_or(1.0, |chi| chi.sf(x))
}

/// A likelihood ratio: not below 0, and 0 where there is no likelihood.
fn finite(ratio: f64) -> f64 {
    if ratio.is_finite() {
        ratio.max(0.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests;
