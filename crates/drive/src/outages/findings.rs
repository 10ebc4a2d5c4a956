//! The findings of outages.

use super::{Experiment, ModelErrors, WhyLeftOut};
use crate::findings::{Finding, LeftOut};
use std::mem::discriminant;

/// Share of the errors in outages inside three standard deviations below which the model promises too much; of right ones
/// it is 0.997.
const LEAST_INSIDE: f64 = 0.9;

/// What the outages of a drive show beyond what is `known` of it without them.
pub fn of_outages(experiment: &Experiment, known: &[Finding]) -> Vec<Finding> {
    let mut found = of_left_out(experiment);
    let [of, fixes] = experiment.withheld;
    if fixes > 0 {
        found.push(Finding::RejectedReference { fixes, of });
    }
    // One reason for all of them says so itself.
    if experiment.cuts.is_empty() && found.len() != 1 {
        found.push(Finding::NoOutage);
    }
    let ran = experiment.runs.iter();
    let models: Vec<_> = ran
        .filter_map(|(model, run)| Some((model.as_str(), &run.as_ref().ok()?.errors)))
        .collect();
    let failed = experiment.runs.iter();
    let failed = failed.filter_map(|(model, run)| Some((model, run.as_ref().err()?.to_string())));
    let (failed, mut why): (Vec<_>, Vec<_>) =
        failed.map(|(model, why)| (model.clone(), why)).unzip();
    why.dedup();
    if !failed.is_empty() {
        found.push(Finding::NotRun {
            models: failed,
            all: models.is_empty(),
            why: why.pop().filter(|_| why.is_empty()),
        });
    }
    let is_new = |of: &Finding| known.iter().all(|k| discriminant(k) != discriminant(of));
    found.extend(of_models(&models).into_iter().filter(is_new));
    found.extend(of_drift(&models));
    found
}

/// Outages that were left out, reason by reason.
fn of_left_out(experiment: &Experiment) -> Vec<Finding> {
    use WhyLeftOut::{InGap, NoReference, NoSamples, NotStarted};
    let of = (experiment.cuts.len() + experiment.left_out.len()) as u64;
    let reasons = [NotStarted, NoSamples, InGap, NoReference].into_iter();
    let with = |why: WhyLeftOut| {
        let mut cuts = experiment.left_out.iter().filter(|cut| cut.1 == why);
        let (first, _) = cuts.next()?;
        Some(Finding::OutagesLeftOut(LeftOut {
            why,
            outages: 1 + cuts.count() as u64,
            of,
            first: first.start,
        }))
    };
    reasons.filter_map(with).collect()
}

/// What was found of the models' runs: of all of them if it is the same.
fn of_models(models: &[(&str, &ModelErrors)]) -> Vec<Finding> {
    let found = models
        .iter()
        .filter_map(|(model, errors)| Some((*model, errors.finding.clone()?)));
    let found: Vec<(&str, Finding)> = found.collect();
    let Some((_, first)) = found.first() else {
        return Vec::new();
    };
    let same = |of: &(&str, Finding)| discriminant(&of.1) == discriminant(first);
    if found.len() == models.len() && found.iter().all(same) {
        return vec![first.clone()];
    }
    let of_model = |(model, what): (&str, Finding)| Finding::OfModel {
        model: model.to_owned(),
        what: Box::new(what),
    };
    found.into_iter().map(of_model).collect()
}

/// Outages in which the position errors are larger than predicted by the model that covers most of them.
fn of_drift(models: &[(&str, &ModelErrors)]) -> Option<Finding> {
    let shares = models
        .iter()
        .filter_map(|(model, errors)| Some((model, errors, errors.coverage.shares(0)?[2])));
    let (model, errors, inside) = shares.max_by(|a, b| a.2.total_cmp(&b.2))?;
    let of_each = errors.per_outage.iter();
    let of_each: Vec<f64> = of_each
        .filter_map(|o| Some(o.covered.shares(0)?[2]))
        .collect();
    (inside < LEAST_INSIDE).then(|| Finding::OptimisticDrift {
        model: (*model).to_owned(),
        inside,
        outside: of_each
            .iter()
            .filter(|share| **share < LEAST_INSIDE)
            .count() as u64,
        outages: of_each.len() as u64,
        tuned: false,
    })
}

#[cfg(test)]
mod tests;
