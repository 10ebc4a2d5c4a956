//! The experiment: GNSS cut many times on one drive, each bias model run through it, the drift
//! reported as in the source paper's Table 4.

mod drift;
mod logs;
mod result;
mod schedule;

pub use drift::{DriftCurve, drift_curve};
pub use logs::Logs;
pub use result::{Experiment, track};
pub use schedule::{Schedule, ScheduleError, schedule};

use crate::{
    estimator::{Adjoint, Estimator, STAMP_ROUNDING},
    findings::Finding,
    reference::{self, Errors, HORIZONTAL, TruthCursor},
    replay::{Measurement, Observer, ReplayError, Settings, Summary, replay},
    smooth::{self, History},
};
use rayon::prelude::*;
use undrift_nav::sample::{GnssFix, ImuSample, TruthSample};

/// What one outage did to one model.
#[derive(Clone, Debug)]
pub struct OutageErrors {
    /// Start in the log's time base \[s\].
    pub start_s: f64,
    /// Largest magnitude inside the outage.
    pub max: Errors,
    /// Error at its end.
    pub end: Errors,
    /// Horizontal error against time since the cut: pairs of \[s\] and \[m\], at most about ten a second.
    pub drift: Vec<(f64, f64)>,
}

/// What the outages did to one model.
#[derive(Clone, Debug)]
pub struct ModelErrors {
    /// Largest magnitude over all samples inside the outages.
    pub max: Errors,
    /// Root mean square over the outages of each one's largest error.
    pub rms: Errors,
    /// Median over the outages of each one's largest error.
    pub median: Errors,
    /// Root mean square over the outages of the error at the end.
    pub end_rms: Errors,
    /// Outage by outage.
    pub per_outage: Vec<OutageErrors>,
    /// Set when the numbers cannot be trusted, and why.
    pub finding: Option<Finding>,
}

/// A model's name, its filter settings, and how its replay went.
pub struct ModelRun {
    /// Name of the bias model.
    pub name: String,
    /// The outcome.
    pub errors: ModelErrors,
    /// Counts and innovations of the replay.
    pub summary: Summary,
}

/// A model's name with what came of it.
pub type Outcome = (String, Result<ModelRun, ReplayError>);

/// Samples from one report of progress to the next.
const PROGRESS_EVERY: usize = 4096;

/// Runs every model through the outages of its settings, on all cores; outages withhold the fixes
/// only. `truth` empty: the withheld fixes are the reference. `done` is called with how many more
/// samples a model has taken, of `imu` times `models`.
pub fn run(
    imu: &[ImuSample],
    aiding: &[Measurement],
    truth: &[TruthSample],
    models: &[(String, Settings)],
    done: &(dyn Fn(u64) + Sync),
) -> Vec<Outcome> {
    models
        .par_iter()
        .map(|(name, settings)| {
            let run = run_model(imu, aiding, truth, settings, done);
            let run = run.map(|(errors, summary)| ModelRun {
                name: name.clone(),
                errors,
                summary,
            });
            (name.clone(), run)
        })
        .collect()
}

fn run_model(
    imu: &[ImuSample],
    aiding: &[Measurement],
    truth: &[TruthSample],
    settings: &Settings,
    done: &(dyn Fn(u64) + Sync),
) -> Result<(ModelErrors, Summary), ReplayError> {
    // What a model does is to be seen, not mended.
    let mut settings = Settings {
        restart: false,
        ..settings.clone()
    };
    settings.start = smooth::better_start(
        &mut imu.iter().copied().map(Ok),
        &mut aiding.iter().copied().map(Ok),
        &settings,
    )?;
    let mut watch = OutageWatch::new(&settings, truth);
    if settings.nodes.is_some() {
        watch.history = Some(History::new()?);
    }
    let mut samples = imu.chunks(PROGRESS_EVERY).flat_map(|chunk| {
        done(chunk.len() as u64);
        chunk.iter().copied().map(Ok)
    });
    let mut measurements = aiding.iter().copied().map(Ok);
    let summary = replay(&mut samples, &mut measurements, &settings, &mut watch)?;
    watch.smooth()?;
    Ok((watch.finish(&summary), summary))
}

/// Collects the errors inside the outages.
struct OutageWatch<'a> {
    settings: &'a Settings,
    truth: Option<TruthCursor<std::iter::Copied<std::slice::Iter<'a, TruthSample>>>>,
    present: usize,
    outages: Vec<OutageErrors>,
    /// With smoothing: the nodes, and which of them lie in an outage, with the fix withheld there.
    history: Option<History>,
    inside: Vec<(usize, usize, Option<GnssFix>)>,
    withheld: Option<GnssFix>,
}

/// Points of the drift curve are at least this far apart \[s\].
const DRIFT_STEP: f64 = 0.1;

impl<'a> OutageWatch<'a> {
    fn new(settings: &'a Settings, truth: &'a [TruthSample]) -> Self {
        let outages = settings
            .outages
            .iter()
            .map(|o| OutageErrors {
                start_s: o.start,
                max: Errors::UNKNOWN,
                end: Errors::UNKNOWN,
                drift: Vec::new(),
            })
            .collect();
        Self {
            settings,
            truth: (!truth.is_empty()).then(|| TruthCursor::new(truth.iter().copied())),
            present: 0,
            outages,
            history: None,
            inside: Vec::new(),
            withheld: None,
        }
    }

    /// The outage that `time` lies in; asked in order of time.
    fn outage_at(&mut self, time: f64) -> Option<usize> {
        let all = &self.settings.outages;
        while self.present < all.len() && time > all[self.present].end + STAMP_ROUNDING {
            self.present += 1;
        }
        (self.present < all.len() && all[self.present].contains(time)).then_some(self.present)
    }

    fn note(&mut self, outage: usize, time: f64, errors: Errors) {
        let o = &mut self.outages[outage];
        o.max = o.max.max_abs(errors);
        o.end = errors;
        let since = time - o.start_s;
        if o.drift
            .last()
            .is_none_or(|(last, _)| since - last >= DRIFT_STEP - 1e-6)
        {
            o.drift.push((since, errors.0[HORIZONTAL]));
        }
    }

    /// Errors of the smoothed solution at the nodes inside the outages, if there are nodes.
    fn smooth(&mut self) -> Result<(), ReplayError> {
        let Some(smoothed) = self
            .history
            .take()
            .map(History::smooth)
            .transpose()?
            .flatten()
        else {
            return Ok(());
        };
        for (index, outage, fix) in std::mem::take(&mut self.inside) {
            let node = &smoothed.nodes[index];
            let time = node.nav.time;
            let errors = match (&mut self.truth, fix) {
                (Some(truth), _) => truth.at(time).map(|t| Errors::against_truth(&node.nav, &t)),
                (None, Some(fix)) => {
                    let (position, velocity) = smoothed.antenna(node, &self.settings.lever_arm);
                    Some(Errors::of_antenna(&position, &velocity, &fix))
                }
                _ => None,
            };
            if let Some(errors) = errors {
                self.note(outage, time, errors);
            }
        }
        Ok(())
    }

    fn finish(self, summary: &Summary) -> ModelErrors {
        // A solution that ended early has no error to show for the outages after its end.
        let per_outage = self.outages;
        let largest: Vec<Errors> = per_outage.iter().map(|o| o.max).collect();
        let ends: Vec<Errors> = per_outage.iter().map(|o| o.end).collect();
        let empty = per_outage
            .iter()
            .filter(|o| o.end.0[HORIZONTAL].is_nan())
            .count();
        let finding = match (summary.diverged, summary.started) {
            (Some(time), _) => Some(Finding::Diverged { time }),
            (None, Some(time)) if empty > 0 && per_outage.iter().any(|o| o.start_s < time) => {
                Some(Finding::StartedLate { time })
            }
            _ if empty > 0 => Some(Finding::NoReference { outages: empty }),
            _ => summary
                .suspect
                .map(|start| Finding::LargeInnovations { start }),
        };
        ModelErrors {
            max: reference::max(&largest),
            rms: reference::rms(&largest),
            median: reference::median(&largest),
            end_rms: reference::rms(&ends),
            per_outage,
            finding,
        }
    }
}

impl Observer for OutageWatch<'_> {
    fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
        let time = filter.nav().time;
        if self.history.is_none()
            && self.truth.is_some()
            && let Some(outage) = self.outage_at(time)
            && let Some(truth) = self.truth.as_mut().and_then(|t| t.at(time))
        {
            self.note(outage, time, Errors::against_truth(filter.nav(), &truth));
        }
        Ok(())
    }

    fn fix(&mut self, filter: &dyn Estimator, fix: &GnssFix, withheld: bool) {
        self.withheld = (withheld && fix.position.is_some()).then_some(*fix);
        if self.history.is_none()
            && self.truth.is_none()
            && self.withheld.is_some()
            && let Some(outage) = self.outage_at(fix.time)
        {
            let errors = Errors::against_fix(filter, fix, &self.settings.lever_arm);
            self.note(outage, fix.time, errors);
        }
    }

    fn node(&mut self, filter: &dyn Estimator, since: Option<&Adjoint>) -> Result<(), ReplayError> {
        let withheld = self.withheld.take();
        let time = withheld.map_or(filter.nav().time, |fix| fix.time);
        let outage = self.outage_at(time);
        if let Some(history) = &mut self.history {
            if let Some(outage) = outage {
                self.inside.push((history.len(), outage, withheld));
            }
            history.push(filter, since)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replay::Outage;

    #[test]
    fn schedules() {
        let every = Schedule::Every {
            start: 60.0,
            every: 24.0,
            count: Some(15),
        };
        let error = |plan: &Schedule, last| schedule(plan, 10.0, 0.0, last).unwrap_err();
        let outages = schedule(&every, 10.0, 0.0, 437.2).unwrap();
        assert_eq!(outages.len(), 15);
        assert_eq!(
            outages[14],
            Outage {
                start: 396.0,
                end: 406.0
            }
        );
        let count = Schedule::Count {
            start: 60.0,
            count: 15,
        };
        let outages = schedule(&count, 10.0, 100.0, 700.0).unwrap();
        assert_eq!((outages[0].start, outages[14].end), (160.0, 700.0));
        let too_many = Schedule::Every {
            start: 60.0,
            every: 24.0,
            count: Some(17),
        };
        assert_eq!(
            error(&too_many, 437.2),
            ScheduleError::TooFew {
                fits: 16,
                count: 17
            }
        );
        assert!(schedule(&Schedule::At(vec![5.0, 8.0]), 10.0, 0.0, 100.0).is_err());
        assert!(schedule(&Schedule::At(vec![95.0]), 10.0, 0.0, 100.0).is_err());
        assert!(schedule(&Schedule::At(vec![f64::NAN]), 10.0, 0.0, 100.0).is_err());
        assert!(schedule(&count, 0.0, 0.0, 100.0).is_err());
        for start in [f64::NAN, f64::INFINITY, -1.0] {
            let late = Schedule::Every {
                start,
                every: 24.0,
                count: None,
            };
            assert!(schedule(&late, 10.0, 0.0, 100.0).is_err());
        }
        // So many that they would not fit into memory either.
        let dense = Schedule::Every {
            start: 0.0,
            every: 1e-300,
            count: None,
        };
        assert_eq!(
            error(&dense, 100.0),
            ScheduleError::Overlap {
                count: usize::MAX,
                length: 10.0
            }
        );
        let dense = Schedule::Count {
            start: 0.0,
            count: usize::MAX,
        };
        assert_eq!(error(&dense, 100.0), ScheduleError::TooMany);
        let dense = Schedule::Count {
            start: 0.0,
            count: 12,
        };
        assert_eq!(
            error(&dense, 100.0),
            ScheduleError::Overlap {
                count: 12,
                length: 10.0
            }
        );
        let none = Schedule::Every {
            start: 0.0,
            every: 20.0,
            count: Some(0),
        };
        assert!(schedule(&none, 10.0, 0.0, 100.0).is_err());
    }

    #[test]
    fn an_outage_is_open_at_its_start_and_closed_at_its_end() {
        let outage = Outage {
            start: 100.0,
            end: 110.0,
        };
        assert!(!outage.contains(100.0) && outage.contains(100.2));
        assert!(outage.contains(110.0) && !outage.contains(110.2));
    }
}
