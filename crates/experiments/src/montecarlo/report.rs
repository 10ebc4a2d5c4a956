//! Sums over runs, and what they say.

use undrift_drive::{
    consistency::{
        COMPONENT_NAMES, COMPONENTS, Consistency, GROUP, GROUPS, InnovationStatistics, LAGS,
        average_bounds,
    },
    replay::STAMP_ROUNDING,
};
use undrift_nav::sample::TruthSample;
use undrift_results::{Group, MonteCarloModel, NisKind, Number, Verdict, by_name, numbers};

/// What one run of one model leaves behind.
#[derive(Default)]
pub(super) struct RunOutcome {
    /// When navigation began \[s\]; `None` until then.
    pub(super) started: Option<f64>,
    pub(super) diverged: bool,
    /// NEES at every epoch, NaN without a solution.
    pub(super) nees: Vec<[f64; GROUPS]>,
    /// Degrees of freedom of it.
    pub(super) freedom: [usize; GROUPS],
    /// After the settling.
    pub(super) settled: Consistency,
    /// NIS of position and velocity at every fix, NaN without an update.
    pub(super) nis: Vec<[f64; 2]>,
    /// Innovations of position and velocity after the settling.
    pub(super) innovations: [InnovationStatistics; 2],
}

/// Running sums over the runs.
pub(super) struct RunSums {
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

impl RunSums {
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

    pub(super) fn add(&mut self, run: &RunOutcome) {
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
    ) -> MonteCarloModel {
        let from = self.started + settle - STAMP_ROUNDING;
        let first_epoch = truth.partition_point(|t| t.time < from);
        let first_fix = fix_times.partition_point(|t| *t < from);
        let coverage = (0..COMPONENTS)
            .filter_map(|i| Some((COMPONENT_NAMES[i], numbers(self.settled.coverage(i)?))));
        MonteCarloModel {
            name,
            diverged: self.diverged as u64,
            started_s: self.started.into(),
            nees: (0..GROUPS)
                .filter(|group| self.freedom[*group] > 0)
                .map(|group| self.group(group, first_epoch))
                .collect(),
            coverage: by_name(coverage),
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
        let (mut inside, mut above, mut below, mut variance, mut n) = (0, 0, 0, 0.0, 0u32);
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
            name: GROUP[group].0.into(),
            freedom: freedom as u64,
            mean_per_freedom: mean.into(),
            mean_standard_error: Number(
                (runs.variance() / runs.count.max(1) as f64).sqrt() / freedom as f64,
            ),
            share_inside: share(inside).into(),
            share_above: share(above).into(),
            share_below: share(below).into(),
            epochs: n.into(),
            effective_epochs: effective.into(),
            share_standard_error: share_error.into(),
            verdict: Some(verdict),
            average: series.iter().map(|m| m.mean().into()).collect(),
            lower: bounds.iter().map(|b| b.map(|b| b.0).into()).collect(),
            upper: bounds.iter().map(|b| b.map(|b| b.1).into()).collect(),
        }
    }

    fn kind(&self, name: &str, kind: usize, first: usize) -> NisKind {
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
        NisKind {
            name: name.into(),
            updates: statistics.updates(),
            nis_per_freedom: nis.into(),
            bounds: (bounds.0.into(), bounds.1.into()),
            share_above_95: statistics.share_above_95().into(),
            share_inside: (inside as f64 / n.max(1) as f64).into(),
            autocorrelation: (0..components)
                .map(|c| {
                    let lags = 1..=LAGS;
                    numbers(lags.filter_map(|lag| statistics.autocorrelation(c, lag)))
                })
                .collect(),
            autocorrelation_bound: statistics.white_bound(0).into(),
            verdict: Some(if nis > bounds.1 {
                Verdict::Optimistic
            } else if nis < bounds.0 {
                Verdict::Pessimistic
            } else {
                Verdict::Consistent
            }),
            average: series.iter().map(|m| m.mean().into()).collect(),
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

#[cfg(test)]
mod tests;
