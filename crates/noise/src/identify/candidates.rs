//! The candidate models of an axis: fitted on the whole of its record, scored crosswise on its halves.
//!
//! A candidate's drift is honest where the scored half has not been fitted: each is fitted on the first half
//! and scored on the second, and the other way round, on the record reversed in time (the models are normal
//! processes, which look the same in either direction). Fitted on the whole, it is the model that is given out.
//! Several records of one sensor are fitted together, and what is scored is a record that has not been fitted at all.
//!
//! Flow: [`candidates`] fits every recipe of [`recipes`] to the whole, then [`Task::candidate`]
//! fits it to each fold and scores it there. A recipe whose fit fails, or that makes no shaping
//! filter at this rate, is dropped; the methods of the literature are listed with the reason
//! ([`NotFitted`]). Candidates run in parallel and come back in the order of the recipes, so the
//! result does not depend on the number of cores.
//!
//! The search over orders sees a prefix of the first record, an ARMA of p > 1 at most
//! [`HIGH_ORDER_SAMPLES`](super::HIGH_ORDER_SAMPLES) of all; sums of terms see block averages; AR
//! and ARMA(1,1) see every sample.

mod average;
mod folds;
mod recipe;

use super::{
    Candidate, GRID_ORDER, NotFitted, Origin, SEARCH_SAMPLES, horizons, recommended, remarks,
};
use crate::{
    allan::{Curve, Terms},
    arma::{self, ArmaFit, Selection},
    compared::Method,
    composite::{self, Averages, Blocks, CompositeTerms, ParameterInterval, TermSet},
    drift_score::{self, Choice, HorizonScore, Reason},
    model_file::AxisModel,
    pandit_wu::{self, PanditWu, PanditWuOptions},
    scales::{self, Scales},
    screening::bridge::bridge,
    temperature::Regressors,
    whiteness,
};
use folds::{Fold, TrainingSet, bridged, end_to_end};
use recipe::{Fitted, Recipe, arma_of, in_terms, with_effort};
use std::sync::OnceLock;
use undrift_base::parallel;
use undrift_nav::shaping::ShapingFilter;

/// Effort of the search over orders.
const SEARCH_EFFORT: f64 = 0.2;
/// Up to so many samples the table of orders goes on to twice the n that is searched, (8,7) for n up to 2: that takes a
/// second or two, and grows with the samples.
const TABLE_SAMPLES: usize = 10_000;
/// Effort of fitting an order again to the whole record.
const REFINE_EFFORT: f64 = 0.2;
/// Effort of each fit of the grid of orders: each starts from its neighbours' optima besides.
const GRID_EFFORT: f64 = 0.03;
/// Effort of each fit of block averages.
const SCALE_EFFORT: f64 = 0.1;
/// Highest order of the autoregressive candidate: with the turn-on constant it fills an axis.
const MOST_AR: usize = 5;
/// Up to so many records each is left out of a fit in turn.
const LEFT_OUT_SINGLY: usize = 6;
/// Probability of the intervals of the recommended candidate's parameters.
const PROBABILITY: f64 = 0.95;
/// Block averages that the candidates' likelihoods are compared on, at most…
const COMPARED: usize = 20_000;
/// …each at least so long \[s\], and as long as the blocks that sums of terms are fitted to: a fourth of the shortest horizon that
/// decides. What is faster, a filter's memory or a line, would outweigh what drifts by hundreds.
const COMPARED_S: f64 = 2.5;
/// Fewest of them, for which they are shorter.
const FEWEST_COMPARED: usize = 100;

/// The records and how they are judged.
pub(super) struct Task<'a> {
    /// Screened records about their means, NaN where a sample was left out; the longest first.
    pub(super) records: Vec<&'a [f64]>,
    /// Sample rate \[Hz\].
    pub(super) rate_hz: f64,
    /// Overlapping Allan deviation of the records.
    pub(super) curve: &'a Curve,
    /// Its terms.
    pub(super) allan: Terms,
    /// Standard deviation of the turn-on constant \[unit\].
    pub(super) turn_on: f64,
    /// Quantisation is large enough to be a term.
    pub(super) quantised: bool,
    /// Largest n of ARMA(2n, 2n−1).
    pub(super) n_max: usize,
    /// The temperature of the records, where its effect is estimated, and whether a quadratic is in it.
    pub(super) temperatures: Vec<(Regressors, bool)>,
    /// Block averages that the candidates' likelihoods are compared on, once they are made.
    pub(super) compared: OnceLock<Option<Averages<'static>>>,
}

/// All that was tried.
pub(super) struct Tried {
    /// Table of ARMA(2n, 2n−1).
    pub(super) pandit_wu: Option<PanditWu>,
    /// Grid of orders by AIC and BIC.
    pub(super) box_jenkins: Option<Selection>,
    /// Block averages: the slow part at several scales.
    pub(super) scales: Option<Scales>,
    /// Those that could be fitted and scored, in the order of tables.
    pub(super) candidates: Vec<Candidate>,
    /// Position of the recommended one, and why.
    pub(super) chosen: Option<(usize, Reason)>,
    /// Methods of the literature that make nothing of this record.
    pub(super) not_fitted: Vec<NotFitted>,
}

impl Task<'_> {
    /// The part of the first record that a search over orders sees.
    /// A prefix of [`SEARCH_SAMPLES`], for time.
    fn searched(&self) -> &[f64] {
        let first = self.records[0];
        &first[..first.len().min(SEARCH_SAMPLES)]
    }

    /// The blocks of the likelihood of a sum of terms.
    ///
    /// The same for all candidates and folds: likelihoods of different blocks are not comparable.
    fn blocks(&self) -> Blocks {
        let samples: usize = self.records.iter().map(|record| record.len()).sum();
        let least = samples.div_ceil(composite::FitOptions::default().max_points);
        composite::blocks_beyond_memory(&self.records, 1.0 / self.rate_hz, least)
    }

    /// The candidate of a fit of the whole, scored on the halves; `None` where it makes no filter or cannot
    /// be fitted to each half. Also the sums of terms that it is, of the whole and of each fold.
    fn candidate(
        &self,
        recipe: Recipe,
        whole: Fitted,
        folds: &[Fold],
    ) -> Option<(Candidate, Vec<CompositeTerms>)> {
        whole.shaping(self.turn_on, self.rate_hz)?;
        let fit = |fold: &Fold| recipe.fit(&fold.fitted, Some(&whole), &[]);
        let fits = folds.iter().map(fit).collect::<Option<Vec<Fitted>>>()?;
        let score = self.score(&fits, folds)?;
        let all = std::iter::once(&whole).chain(&fits).map(Fitted::sum);
        let sums = all.collect::<Option<Vec<_>>>().unwrap_or_default();
        Some((self.scored(recipe, whole, score)?, sums))
    }

    /// The average of the candidates that are likely sums of terms, where they do not expect what the one chosen does; and how many
    /// they are. White noise stays what it is; of several records the common model is one of their sums.
    fn average(
        &self,
        candidates: &[Candidate],
        sums: &[Vec<CompositeTerms>],
        chosen: usize,
        folds: &[Fold],
    ) -> Option<(Candidate, usize)> {
        candidates[chosen].composite()?;
        let &[record] = self.records.as_slice() else {
            return None;
        };
        let all = || candidates.iter().zip(sums);
        let sums = || all().filter(|(of, sums)| !of.compared && !sums.is_empty());
        let weights = average::weights(&Vec::from_iter(sums().map(|(of, _)| of.aic)));
        let interval = 1.0 / self.rate_hz;
        let mean = |at: usize| {
            let weighed = weights.iter().zip(sums());
            let weighed = Vec::from_iter(weighed.map(|(weight, (_, sums))| (*weight, sums[at])));
            average::mean(&weighed, interval, record.len())
        };
        let whole = mean(0);
        if !average::differs(&whole, all().nth(chosen)?.1.first()?) {
            return None;
        }
        let fitted = |curve| {
            let terms = average::terms(&curve)?;
            Some(Recipe::Average.fitted((in_terms(&terms), Origin::Average)))
        };
        let parts = (1..=folds.len()).map(|at| fitted(mean(at)));
        let score = self.score(&parts.collect::<Option<Vec<_>>>()?, folds)?;
        let models = weights.iter().filter(|weight| **weight > 0.0).count();
        Some((self.scored(Recipe::Average, fitted(whole)?, score)?, models))
    }

    /// The drift of what was fitted to each fold, on what it withholds, by horizon. A candidate that cannot be scored on one fold has
    /// no score at all.
    fn score(&self, fits: &[Fitted], folds: &[Fold]) -> Option<Vec<HorizonScore>> {
        let mut scores: Vec<Vec<HorizonScore>> = Vec::new();
        for (found, fold) in fits.iter().zip(folds) {
            let filter = found.shaping(self.turn_on, self.rate_hz)?;
            for parts in &fold.scored {
                let parts = parts.as_ref()?;
                let horizons = horizons(parts.record.len(), self.rate_hz).ok()?;
                scores.push(parts.score(&filter, &horizons).ok()?);
            }
        }
        Some(drift_score::pooled(&scores))
    }

    /// A fit of the whole with its score.
    fn scored(&self, recipe: Recipe, whole: Fitted, score: Vec<HorizonScore>) -> Option<Candidate> {
        let filter = whole.shaping(self.turn_on, self.rate_hz)?;
        let remarks = match &whole.origin {
            Origin::Allan | Origin::Burg | Origin::Compared(_) | Origin::Average => Vec::new(),
            Origin::Arma(fit) => remarks::of_arma(fit),
            Origin::Composite(fit) => remarks::of_composite(fit),
        };
        let ljung_box_p = match &whole.origin {
            Origin::Arma(fit) => self.ljung_box(fit),
            _ => None,
        };
        Some(Candidate {
            name: recipe.name(),
            compared: recipe.is_compared(),
            states: filter.order,
            parameters: whole.parameters,
            aic: self.aic(&whole, recipe),
            ljung_box_p,
            score,
            remarks,
            model: AxisModel {
                turn_on: self.turn_on,
                ..whole.model
            },
            origin: whole.origin,
        })
    }

    /// What integrating the effects of temperature out changes a model's restricted log-likelihood by, of all records.
    fn marginal(&self, filter: &ShapingFilter) -> f64 {
        let of = |(record, with_quadratic): &(Regressors, bool)| {
            record.restriction(filter, *with_quadratic)
        };
        self.temperatures.iter().map(of).sum()
    }

    /// Block averages of the records, the same for every candidate.
    ///
    /// The block is 2.5 s or more where the record is long enough, so that likelihoods compare what drifts and not
    /// what a filter does inside a second.
    fn compared(&self) -> Option<Averages<'static>> {
        let shortest = (COMPARED_S * self.rate_hz).round() as usize;
        let shortest = self.blocks().samples.max(shortest);
        let samples: usize = self.records.iter().map(|record| record.len()).sum();
        let most = samples / FEWEST_COMPARED;
        let block = samples.div_ceil(COMPARED).max(shortest.min(most)).max(1);
        Averages::new(&self.records, block, 1.0 / self.rate_hz).ok()
    }

    /// Akaike's criterion of block averages of the record; infinite without one.
    ///
    /// 2k − 2 log L with k the parameters beside the level.
    fn aic(&self, fitted: &Fitted, recipe: Recipe) -> f64 {
        let likelihood = || -> Option<f64> {
            let filter = fitted.shaping(0.0, self.rate_hz)?;
            let averages = self.compared.get_or_init(|| self.compared()).as_ref()?;
            let sum = match recipe {
                Recipe::White => averages.restricted_at_best_level(&filter),
                _ => averages.restricted(&filter),
            };
            Some(sum.ok()? + self.marginal(&filter))
        };
        let parameters = recipe.parameters() as f64;
        likelihood().map_or(f64::INFINITY, |sum| 2.0 * parameters - 2.0 * sum)
    }

    /// Of the samples that the search over orders saw; `None` where the residuals cannot be computed.
    ///
    /// p of the first 20 lags, degrees of freedom less p + q (Ljung & Box 1978).
    fn ljung_box(&self, fit: &ArmaFit) -> Option<f64> {
        let residuals = fit.residuals(self.searched()).ok()?;
        let present: Vec<f64> = residuals.into_iter().filter(|r| r.is_finite()).collect();
        let test = whiteness::portmanteau(&present, &[20], fit.ar.len() + fit.ma.len());
        Some(test.ok()?[0].ljung_box_p)
    }
}

/// The n to which the table of orders goes on, of so many samples.
fn last_row(samples: usize, n_max: usize) -> usize {
    match samples <= TABLE_SAMPLES {
        true => 2 * n_max,
        false => n_max,
    }
}

/// All candidates.
pub(super) fn candidates(task: &Task) -> Tried {
    let search = PanditWuOptions {
        n_max: task.n_max,
        table: last_row(task.searched().len(), task.n_max),
        fit: with_effort(SEARCH_EFFORT),
        ..PanditWuOptions::default()
    };
    let pandit_wu = pandit_wu::pandit_wu(task.searched(), &search).ok();
    // The averages of one sample are the ARMA(1,1) of the full rate.
    let blocks = &scales::BLOCKS[1..];
    let marginal = |filter: &ShapingFilter| task.marginal(filter);
    let blocks_of_terms = task.blocks();
    let whole = TrainingSet {
        end_to_end: end_to_end(bridged(&task.records)),
        records: task.records.clone(),
        wavelet: composite::curve(&task.records, 1.0 / task.rate_hz).ok(),
        averages: blocks_of_terms.averages(&task.records, 1.0 / task.rate_hz),
        rate_hz: task.rate_hz,
        curve: task.curve.clone(),
        allan: task.allan,
        blocks: blocks_of_terms,
        marginal: &marginal,
    };
    let scales = scales::identify(task.records[0], 1.0 / task.rate_hz, blocks, SCALE_EFFORT).ok();
    let known = |(p, q)| {
        let fit = pandit_wu.as_ref().and_then(|table| table.fit((p, q)));
        let known = fit.iter().map(|fit| (fit.ar.clone(), fit.ma.clone()));
        known.collect::<Vec<_>>()
    };
    // The search over orders may have seen all there is.
    let all_searched = task.records.len() == 1 && task.searched().len() == task.records[0].len();
    let searched = |order| {
        let table = pandit_wu.as_ref().filter(|_| all_searched)?;
        table.fit(order).cloned()
    };
    let fit = |recipe: Recipe| match recipe {
        Recipe::Arma(p, q) | Recipe::ArmaByTest(p, q) => match searched((p, q)) {
            Some(fit) => Some(recipe.fitted(arma_of(fit, task.rate_hz))),
            None => recipe.fit(&whole, None, &known((p, q))),
        },
        _ => recipe.fit(&whole, None, &[]),
    };
    let backward = |record: &&[f64]| record.iter().rev().copied().collect();
    let reversed: Vec<Vec<f64>> = task.records.iter().map(backward).collect();
    let folds = Fold::all(&task.records, &reversed, task.rate_hz, whole.blocks);
    let recipes = recipes(task, pandit_wu.as_ref());
    let candidate = |k: usize| task.candidate(recipes[k], fit(recipes[k])?, &folds);
    let candidates = parallel::map(recipes.len(), candidate);
    let (mut candidates, sums): (Vec<Candidate>, Vec<_>) = candidates.into_iter().flatten().unzip();
    let mut chosen = recommended(&candidates);
    if let Some((at, reason)) = &mut chosen
        && let Some((average, models)) = task.average(&candidates, &sums, *at, &folds)
    {
        *at = candidates.len();
        reason.name = average.name.clone();
        (reason.states, reason.parameters) = (average.states, average.parameters);
        reason.choice = Choice::Average { models };
        candidates.push(average);
    }
    let missing = Method::ALL.into_iter().filter(|method| {
        let name = method.candidate();
        candidates.iter().all(|candidate| candidate.name != name)
    });
    let not_fitted = missing.filter_map(|method| {
        let reason = whole.compared(method).err()?;
        let name = method.candidate().to_owned();
        Some(NotFitted { name, reason })
    });
    let grid = with_effort(GRID_EFFORT);
    Tried {
        box_jenkins: arma::select_with_starts(
            task.searched(),
            GRID_ORDER,
            GRID_ORDER,
            &grid,
            pandit_wu.as_ref().map_or(&[], |table| &table.fits),
        )
        .ok(),
        pandit_wu,
        scales,
        not_fitted: not_fitted.collect(),
        chosen,
        candidates,
    }
}

/// Intervals of a candidate's parameters; none of one that is not a sum of terms.
///
/// 95 % profile intervals; empty where they cannot be computed.
pub(super) fn intervals(task: &Task, of: &Candidate) -> Vec<ParameterInterval> {
    let (interval, marginal) = (1.0 / task.rate_hz, |filter: &ShapingFilter| {
        task.marginal(filter)
    });
    let found = of.composite().map(|fit| {
        composite::intervals_marginal(&task.records, interval, fit, PROBABILITY, &marginal)
    });
    found.and_then(Result::ok).unwrap_or_default()
}

/// What is tried, in the order of tables.
fn recipes(task: &Task, table: Option<&PanditWu>) -> Vec<Recipe> {
    let mut list = vec![Recipe::White];
    let plain = [(0, true), (1, false), (1, true), (2, false), (2, true)];
    let rounded = [(0, true), (1, false)];
    let rounded = rounded.iter().filter(|_| task.quantised);
    let sets = plain.iter().map(|of| (false, of));
    let sets = sets.chain(rounded.map(|of| (true, of)));
    list.extend(sets.map(|(quantisation, &(gauss_markov, random_walk))| {
        Recipe::Terms(TermSet {
            white: true,
            quantisation,
            random_walk,
            gauss_markov,
            ..TermSet::default()
        })
    }));
    list.extend([false, true].map(|random_walk| {
        Recipe::Terms(TermSet {
            white: true,
            flicker: true,
            random_walk,
            ..TermSet::default()
        })
    }));
    list.extend([Recipe::AllanWalk, Recipe::Arma(1, 1), Recipe::Arma(2, 1)]);
    let arma = |(p, q)| Recipe::Arma(p, q);
    let by_test = |(p, q)| Recipe::ArmaByTest(p, q);
    let orders = |t: &PanditWu| [arma(t.by_bic), by_test(t.by_f), by_test(t.by_aic)];
    for recipe in table.iter().flat_map(|t| orders(t)) {
        if list.iter().all(|other| other.name() != recipe.name()) {
            list.push(recipe);
        }
    }
    list.push(Recipe::UnitRoot);
    let bridged = bridge(task.searched(), 0.0);
    if let Ok(p) = arma::order_by_aicc(&bridged, MOST_AR) {
        list.push(Recipe::Burg(p.max(1)));
    }
    list.extend(Method::ALL.map(Recipe::Compared));
    list
}

#[cfg(test)]
mod tests;
