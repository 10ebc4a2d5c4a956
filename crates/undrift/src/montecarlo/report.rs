//! Sums over runs, and what they say.

use super::{Outcome, Spec};
use crate::{
    consistency::{
        COMPONENT_NAMES, COMPONENTS, Consistency, GROUP, GROUPS, InnovationStatistics, LAGS,
        average_bounds,
    },
    replay::STAMP_ROUNDING,
    results::{Kind as ResultKind, with_head},
};
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::fmt;
use undrift_nav::sample::TruthSample;

/// What a Monte Carlo says.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Runs.
    pub runs: usize,
    /// Seed they were drawn from.
    pub seed: u64,
    /// Beginning of the navigation that is left out of averages and shares [s].
    pub settle_s: f64,
    /// Times of the NEES series [s].
    pub time_s: Vec<f64>,
    /// Times of the NIS series [s].
    pub fix_time_s: Vec<f64>,
    /// Model by model.
    pub models: Vec<ModelReport>,
}

impl Report {
    /// Everything as JSON, with what was simulated.
    pub fn json(&self, spec: &Spec) -> Value {
        let mut result = with_head(ResultKind::MonteCarlo, json!(self));
        result["drive"] = json!({
            "duration_s": spec.trajectory.duration,
            "rate_hz": spec.rate_hz,
            "drawn_as": spec.bias_model.name(),
            "model": spec.model.name,
            "filter_model": spec.filter_model.name,
            "every_s": spec.every,
        });
        result
    }
}

/// What it says of one bias model.
#[derive(Clone, Debug, Serialize)]
pub struct ModelReport {
    /// Its name.
    pub name: String,
    /// Runs whose solution diverged; they count as long as they lasted.
    pub diverged: usize,
    /// When the last of the runs began to navigate [s].
    pub started_s: f64,
    /// NEES, group by group.
    pub nees: Vec<Group>,
    /// Shares of all epochs and runs after the settling within 1, 2 and 3 standard deviations, by
    /// component: 0.683, 0.954 and 0.997 when the filter is right.
    pub coverage: Map<String, Value>,
    /// NIS of position and velocity.
    pub nis: Vec<Kind>,
}

/// What the filter says of itself against what it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// As good as it says.
    Consistent,
    /// Worse than it says.
    Optimistic,
    /// Better than it says.
    Pessimistic,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Consistent => "consistent",
            Self::Optimistic => "optimistic",
            Self::Pessimistic => "pessimistic",
        })
    }
}

/// NEES of one group of states.
#[derive(Clone, Debug, Serialize)]
pub struct Group {
    /// Name of the group.
    pub name: &'static str,
    /// Degrees of freedom of one run.
    pub freedom: usize,
    /// Average over epochs and runs after the settling, per degree of freedom …
    pub mean_per_freedom: f64,
    /// … and its standard error, from the scatter of the runs' own averages.
    pub mean_standard_error: f64,
    /// Share of the epochs after the settling whose average over the runs is within its bounds …
    pub share_inside: f64,
    /// … above …
    pub share_above: f64,
    /// … and below them.
    pub share_below: f64,
    /// Epochs after the settling.
    pub epochs: usize,
    /// How many independent ones they are worth, at most: their correlation lets the share of a
    /// perfect filter scatter about 0.95 …
    pub effective_epochs: f64,
    /// … with this standard deviation, at most.
    pub share_standard_error: f64,
    /// What it comes to.
    pub verdict: Verdict,
    /// Average over the runs at each epoch.
    pub average: Vec<Option<f64>>,
    /// Two-sided 95 % bounds of it.
    pub lower: Vec<Option<f64>>,
    /// Two-sided 95 % bounds of it.
    pub upper: Vec<Option<f64>>,
}

/// Innovations of one kind of measurement after the settling, all runs together.
#[derive(Clone, Debug, Serialize)]
pub struct Kind {
    /// Position or velocity.
    pub name: &'static str,
    /// Updates.
    pub updates: u64,
    /// NIS per degree of freedom …
    pub nis_per_freedom: f64,
    /// … and its two-sided 95 % bounds.
    pub bounds: (f64, f64),
    /// Share of the updates above the 95 % point.
    pub share_above_95: f64,
    /// Share of the fixes whose average NIS over the runs is within its two-sided 95 % bounds.
    pub share_inside: f64,
    /// Autocorrelation at lags 1 to 10, by component.
    pub autocorrelation: Vec<Vec<f64>>,
    /// 95 % bound of it.
    pub autocorrelation_bound: f64,
    /// What it comes to: whether NIS per degree of freedom is within its bounds.
    pub verdict: Verdict,
    /// Average over the runs at each fix.
    pub average: Vec<Option<f64>>,
}

/// Running sums over the runs.
pub(super) struct Sums {
    diverged: usize,
    started: f64,
    freedom: [usize; GROUPS],
    epochs: Vec<[Moments; GROUPS]>,
    fixes: Vec<[Moments; 2]>,
    settled: Consistency,
    /// Each run's own average after the settling.
    averages: [Moments; GROUPS],
    innovations: [InnovationStatistics; 2],
}

/// Count, sum and sum of squares.
#[derive(Clone, Copy, Default)]
struct Moments {
    count: usize,
    sum: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.count += 1;
            self.sum += value;
            self.squares += value * value;
        }
    }

    fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }

    /// With divisor n − 1; zero for fewer than two.
    fn variance(&self) -> f64 {
        if self.count < 2 {
            return 0.0;
        }
        let n = self.count as f64;
        ((self.squares - self.sum * self.sum / n) / (n - 1.0)).max(0.0)
    }
}

impl Sums {
    pub(super) fn new(epochs: usize, fixes: usize) -> Self {
        Self {
            diverged: 0,
            started: 0.0,
            freedom: [0; GROUPS],
            epochs: vec![[Moments::default(); GROUPS]; epochs],
            fixes: vec![[Moments::default(); 2]; fixes],
            settled: Consistency::default(),
            averages: [Moments::default(); GROUPS],
            innovations: Default::default(),
        }
    }

    pub(super) fn add(&mut self, run: &Outcome) {
        self.diverged += usize::from(run.diverged);
        self.started = self.started.max(run.started.unwrap_or(0.0));
        for (epoch, values) in self.epochs.iter_mut().zip(&run.nees) {
            for (moments, value) in epoch.iter_mut().zip(values) {
                moments.add(*value);
            }
        }
        for (fix, values) in self.fixes.iter_mut().zip(&run.nis) {
            for (moments, value) in fix.iter_mut().zip(values) {
                moments.add(*value);
            }
        }
        for group in 0..GROUPS {
            self.freedom[group] = self.freedom[group].max(run.freedom[group]);
            let mean = &run.settled.nees[group];
            if mean.count > 0 {
                self.averages[group].add(mean.sum / mean.count as f64);
            }
        }
        self.settled.merge(&run.settled);
        for (sums, more) in self.innovations.iter_mut().zip(&run.innovations) {
            sums.merge(more);
        }
    }

    pub(super) fn report(
        &self,
        name: String,
        truth: &[TruthSample],
        fix_times: &[f64],
        settle: f64,
    ) -> ModelReport {
        let from = self.started + settle - STAMP_ROUNDING;
        let first_epoch = truth.partition_point(|t| t.time < from);
        let first_fix = fix_times.partition_point(|t| *t < from);
        let coverage = (0..COMPONENTS)
            .filter_map(|i| Some((COMPONENT_NAMES[i].into(), json!(self.settled.coverage(i)?))));
        ModelReport {
            name,
            diverged: self.diverged,
            started_s: self.started,
            nees: (0..GROUPS)
                .filter(|group| self.freedom[*group] > 0)
                .map(|group| self.group(group, first_epoch))
                .collect(),
            coverage: coverage.collect(),
            nis: ["position", "velocity"]
                .into_iter()
                .enumerate()
                .filter(|(kind, _)| self.innovations[*kind].updates() > 0)
                .map(|(kind, name)| self.kind(name, kind, first_fix))
                .collect(),
        }
    }

    fn group(&self, group: usize, first: usize) -> Group {
        let freedom = self.freedom[group];
        let series: Vec<Moments> = self.epochs.iter().map(|e| e[group]).collect();
        let bounds = bounds(&series, freedom);
        let (mut inside, mut above, mut below, mut variance, mut n) = (0, 0, 0, 0.0, 0);
        for (moments, bounds) in series.iter().zip(&bounds).skip(first) {
            let (Some(mean), Some((lower, upper))) = (moments.mean(), *bounds) else {
                continue;
            };
            n += 1;
            variance += moments.variance();
            above += usize::from(mean > upper);
            below += usize::from(mean < lower);
            inside += usize::from((lower..=upper).contains(&mean));
        }
        let share = |k: usize| k as f64 / f64::from(n.max(1));
        // A run's own average scatters as if it had so many independent epochs.
        let runs = &self.averages[group];
        let independent = variance / f64::from(n.max(1)) / runs.variance();
        let effective = if independent.is_finite() {
            independent.clamp(1.0, f64::from(n.max(1)))
        } else {
            1.0
        };
        let share_error = (0.95 * 0.05 / effective).sqrt();
        let mean = runs.mean().unwrap_or(f64::NAN) / freedom as f64;
        let verdict = if share(inside) >= 0.95 - 2.0 * share_error {
            Verdict::Consistent
        } else if mean > 1.0 {
            Verdict::Optimistic
        } else {
            Verdict::Pessimistic
        };
        Group {
            name: GROUP[group].0,
            freedom,
            mean_per_freedom: mean,
            mean_standard_error: (runs.variance() / runs.count.max(1) as f64).sqrt()
                / freedom as f64,
            share_inside: share(inside),
            share_above: share(above),
            share_below: share(below),
            epochs: n as usize,
            effective_epochs: effective,
            share_standard_error: share_error,
            verdict,
            average: series.iter().map(Moments::mean).collect(),
            lower: bounds.iter().map(|b| b.map(|b| b.0)).collect(),
            upper: bounds.iter().map(|b| b.map(|b| b.1)).collect(),
        }
    }

    fn kind(&self, name: &'static str, kind: usize, first: usize) -> Kind {
        let statistics = &self.innovations[kind];
        let series: Vec<Moments> = self.fixes.iter().map(|f| f[kind]).collect();
        let bounds_of_series = bounds(&series, 3);
        let (mut inside, mut n) = (0, 0usize);
        for (moments, bounds) in series.iter().zip(&bounds_of_series).skip(first) {
            if let (Some(mean), Some((lower, upper))) = (moments.mean(), *bounds) {
                n += 1;
                inside += usize::from((lower..=upper).contains(&mean));
            }
        }
        let nis = statistics.per_freedom().unwrap_or(f64::NAN);
        let bounds = statistics.bounds();
        let components = statistics.components();
        Kind {
            name,
            updates: statistics.updates(),
            nis_per_freedom: nis,
            bounds,
            share_above_95: statistics.share_above_95().unwrap_or(f64::NAN),
            share_inside: inside as f64 / n.max(1) as f64,
            autocorrelation: (0..components)
                .map(|c| {
                    (1..=LAGS)
                        .filter_map(|lag| statistics.autocorrelation(c, lag))
                        .collect()
                })
                .collect(),
            autocorrelation_bound: statistics.white_bound(0).unwrap_or(f64::NAN),
            verdict: if nis > bounds.1 {
                Verdict::Optimistic
            } else if nis < bounds.0 {
                Verdict::Pessimistic
            } else {
                Verdict::Consistent
            },
            average: series.iter().map(Moments::mean).collect(),
        }
    }
}

/// The bounds at each epoch of an average over the runs that there are.
fn bounds(series: &[Moments], freedom: usize) -> Vec<Option<(f64, f64)>> {
    let mut last = (0, None);
    series
        .iter()
        .map(|moments| {
            if moments.count != last.0 {
                let bounds = (moments.count > 0).then(|| average_bounds(freedom, moments.count));
                last = (moments.count, bounds);
            }
            last.1
        })
        .collect()
}
