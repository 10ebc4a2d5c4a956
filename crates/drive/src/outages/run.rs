//! Each model through the outages.

use super::errors::{ModelErrors, ModelOutcome, ModelRun, OutageErrors};
use crate::rejected::{Reference, Rejected};
use crate::{
    estimator::{Adjoint, Aiding, Estimator, STAMP_ROUNDING},
    findings::Finding,
    mounting::Mounting,
    reference::{self, Coverage, Errors, HORIZONTAL, Predicted, TruthCursor},
    replay::{Measurement, Observer, ReplayError, Settings, Summary, replay},
    smooth::{self, History},
};
use undrift_base::parallel;
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    mechanisation::NavState,
    sample::{GnssFix, ImuSample, TruthSample},
};

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
) -> Vec<ModelOutcome> {
    let rejected = &Rejected::default();
    let reference = Reference { truth, rejected };
    run_against(imu, aiding, reference, models, done)
}

/// Does [`run`] with a reference in which some of the withheld fixes may be excluded.
pub fn run_against(
    imu: &[ImuSample],
    aiding: &[Measurement],
    reference: Reference,
    models: &[(String, Settings)],
    done: &(dyn Fn(u64) + Sync),
) -> Vec<ModelOutcome> {
    parallel::map(models.len(), |k| {
        let (name, settings) = &models[k];
        run_one(imu, aiding, reference, name, settings, done)
    })
}

/// One model of [`run_against`].
pub(super) fn run_one(
    imu: &[ImuSample],
    aiding: &[Measurement],
    reference: Reference,
    name: &str,
    settings: &Settings,
    done: &(dyn Fn(u64) + Sync),
) -> ModelOutcome {
    let run = run_model(imu, aiding, reference, settings, done);
    let run = run.map(|(errors, summary)| ModelRun {
        name: name.to_owned(),
        errors,
        summary,
    });
    (name.to_owned(), run)
}

fn run_model(
    imu: &[ImuSample],
    aiding: &[Measurement],
    reference: Reference,
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
    settings.doubts = smooth::doubts(
        &mut imu.iter().copied().map(Ok),
        &mut aiding.iter().copied().map(Ok),
        &settings,
    )?;
    let mut watch = OutageWatch::new(&settings, reference);
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
    /// IMU → antenna in the axes of the filter \[m\], and whether those are the vehicle's.
    lever_arm: Vector3,
    mounted: bool,
    truth: Option<TruthCursor<std::iter::Copied<std::slice::Iter<'a, TruthSample>>>>,
    rejected: &'a Rejected,
    present: usize,
    outages: Vec<OutageErrors>,
    coverage: Coverage,
    /// With smoothing: the nodes, and which of them lie in an outage, with the fix withheld there.
    history: Option<History>,
    inside: Vec<(usize, usize, Option<GnssFix>)>,
    withheld: Option<GnssFix>,
}

/// Points of the drift curve are at least this far apart \[s\].
const DRIFT_STEP: f64 = 0.1;

impl<'a> OutageWatch<'a> {
    fn new(settings: &'a Settings, reference: Reference<'a>) -> Self {
        let truth = reference.truth;
        let outages = settings
            .outages
            .iter()
            .map(|o| OutageErrors {
                start_s: o.start,
                max: Errors::UNKNOWN,
                end: Errors::UNKNOWN,
                sigma: Errors::UNKNOWN,
                nees: [f64::NAN; 3],
                covered: Coverage::default(),
                drift: Vec::new(),
                way: Vec::new(),
            })
            .collect();
        let mounted = !settings.find_mounting;
        Self {
            settings,
            lever_arm: if mounted {
                settings.lever_arm
            } else {
                Vector3::zeros()
            },
            mounted,
            truth: (!truth.is_empty()).then(|| TruthCursor::new(truth.iter().copied())),
            rejected: reference.rejected,
            present: 0,
            outages,
            coverage: Coverage::default(),
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

    /// Errors against a withheld pose of a marker with the axes `q_bk`, and their covariances: with the marker, the lever arm and the frame
    /// that are estimated, and the pose's own errors, less what of them lasts and is known.
    fn by_pose(
        &self,
        filter: &dyn Estimator,
        fix: &GnssFix,
        q_bk: Quaternion,
    ) -> Option<(Errors, Predicted)> {
        let (due, own) = (filter.nav().time, &self.settings.fix_errors);
        let seen = |(aiding, white): (Aiding, Matrix3)| {
            let covariance = filter.innovation_covariance(&aiding)? + white;
            Some((filter.innovation(&aiding)?, covariance))
        };
        let (off, covariance) = seen(Aiding::position(fix, due, self.lever_arm, own)?)?;
        let attitude = Aiding::attitude(fix, due, q_bk, own).and_then(seen);
        let mut predicted = Predicted::from_filter(filter);
        predicted.0[0] = covariance;
        if let Some((_, covariance)) = &attitude {
            predicted.0[2] = *covariance;
        }
        let turn = attitude.as_ref().map(|(turn, _)| turn);
        let errors = Errors::of_pose(&off, turn, &filter.nav().q_nb);
        Some((errors, predicted))
    }

    /// Notes errors inside an outage, with the covariance that the solution gives them.
    fn note(&mut self, outage: usize, nav: &NavState, errors: Errors, predicted: &Predicted) {
        let o = &mut self.outages[outage];
        o.max = o.max.max_abs(errors);
        let sigma = predicted.std(&nav.q_nb);
        let nees = predicted.nees(&nav.q_nb, &errors);
        // What the last reference does not have is that of the one before.
        o.end = errors.or(o.end);
        o.sigma = sigma.or(o.sigma);
        for (last, nees) in o.nees.iter_mut().zip(nees) {
            *last = if nees.is_finite() { nees } else { *last };
        }
        o.covered.add(&errors, &sigma);
        self.coverage.add(&errors, &sigma);
        let time = nav.time;
        let since = time - o.start_s;
        if o.drift
            .last()
            .is_none_or(|(last, _)| since - last >= DRIFT_STEP - 1e-6)
        {
            o.drift.push((since, errors.0[HORIZONTAL]));
            o.way.push([time, nav.position.lat, nav.position.lon]);
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
            let seen = match (&mut self.truth, fix) {
                (Some(truth), _) => truth
                    .at(time)
                    .map(|t| (Errors::against_truth(&node.nav, &t), node.predicted)),
                (None, Some(fix)) => {
                    let (position, velocity) = smoothed.antenna(node, &self.settings.lever_arm);
                    let errors = Errors::of_antenna(&position, &velocity, &fix);
                    Some((errors, node.predicted.against_fix(&fix)))
                }
                _ => None,
            };
            if let Some((errors, predicted)) = seen {
                self.note(outage, &node.nav, errors, &predicted);
            }
        }
        Ok(())
    }

    fn finish(self, summary: &Summary) -> ModelErrors {
        // A solution that ended early has no error to show for the outages after its end; one that began
        // late is judged by the outages after its start.
        let began = |o: &&OutageErrors| summary.started.is_none_or(|time| o.start_s >= time);
        let counted: Vec<&OutageErrors> = self.outages.iter().filter(began).collect();
        let largest: Vec<Errors> = counted.iter().map(|o| o.max).collect();
        let ends: Vec<Errors> = counted.iter().map(|o| o.end).collect();
        // An outage without a reference spoils no other; of a solution that has ended the others say too little.
        let of = |values: &[Errors], statistic: fn(&[Errors]) -> Errors| match summary.diverged {
            Some(_) => statistic(values),
            None => reference::where_known(values, statistic),
        };
        let nees = std::array::from_fn(|group| {
            let all = counted.iter().map(|o| o.nees[group]);
            let known: Vec<f64> = all
                .filter(|nees| summary.diverged.is_some() || nees.is_finite())
                .collect();
            known.iter().sum::<f64>() / known.len() as f64
        });
        let left_out = self.outages.len() - counted.len();
        let empty = ends.iter().filter(|e| e.0[HORIZONTAL].is_nan()).count();
        let finding = match (summary.diverged, summary.started) {
            (Some(time), _) => Some(Finding::Diverged { time }),
            (None, Some(time)) if left_out > 0 => Some(Finding::StartedLate { time }),
            _ if empty > 0 => Some(Finding::NoReference { outages: empty }),
            _ => summary
                .suspect
                .map(|start| Finding::LargeInnovations { start }),
        };
        ModelErrors {
            max: of(&largest, reference::max),
            rms: of(&largest, reference::rms),
            median: of(&largest, reference::median),
            end_rms: of(&ends, reference::rms),
            nees,
            coverage: self.coverage,
            left_out,
            per_outage: self.outages,
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
            let truth = match self.mounted {
                true => truth,
                false => TruthSample { rpy: None, ..truth },
            };
            let errors = Errors::against_truth(filter.nav(), &truth);
            self.note(
                outage,
                filter.nav(),
                errors,
                &Predicted::from_filter(filter),
            );
        }
        Ok(())
    }

    fn fix(&mut self, filter: &dyn Estimator, fix: &GnssFix, withheld: bool) {
        let reference = withheld.then(|| self.rejected.rest(fix));
        self.withheld = reference.filter(|fix| fix.position.is_some());
        if self.history.is_none()
            && self.truth.is_none()
            && let Some(fix) = self.withheld
            && let Some(outage) = self.outage_at(fix.time)
        {
            let of_pose = self
                .settings
                .marker
                .and_then(|q_bk| self.by_pose(filter, &fix, q_bk));
            let (errors, predicted) = of_pose.unwrap_or_else(|| {
                let errors = Errors::against_fix(filter, &fix, &self.lever_arm);
                (errors, Predicted::from_filter(filter).against_fix(&fix))
            });
            self.note(outage, filter.nav(), errors, &predicted);
        }
    }

    fn mounted(&mut self, _mounting: &Mounting) {
        self.lever_arm = self.settings.lever_arm;
        self.mounted = true;
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
mod tests;
