//! The experiment on the logs of a drive: a run without outages first, then every model through the outages.

use super::{
    Logs,
    compared::ComparedModel,
    errors::ModelOutcome,
    left_out::{Coverage, WhyLeftOut},
    run::run_one,
};
use crate::rejected::{Reference, Rejected, withheld};
use crate::{
    drive::ScalarLog,
    navigate::{self, Hindsight, NavigateError, Report, Wanted, look_ahead, settings},
    replay::{Aid, Measurement, Outage, ReplayError, Settings},
    vehicle::Constraints,
};
use std::{borrow::Cow, collections::BTreeMap};
use undrift_base::parallel;
use undrift_nav::sample::ImuSample;
use undrift_noise::BiasModel;
use undrift_results::{ModelErrors, NoiseModelRun, Say};

/// Longest span between two nodes of the smoother \[s\]: the errors are taken at nodes.
const NODE_SPAN: f64 = 0.2;

/// The experiment on a drive: models, outages, and the errors of each model in them.
#[derive(Debug)]
pub struct Experiment {
    /// How much of the log the solutions know at each instant.
    pub hindsight: Hindsight,
    /// Models that were compared.
    pub compared: Vec<ComparedModel>,
    /// Outages that were judged.
    pub cuts: Vec<Outage>,
    /// Outages that were asked for and are not among them, and why.
    pub left_out: Vec<(Outage, WhyLeftOut)>,
    /// The run without outages: what `navigate` makes of the drive.
    pub uncut: Result<Report, ReplayError>,
    /// Withheld fixes with a position, and how many of them the run without outages rejects: they are no reference. None
    /// of both where there is a truth.
    pub withheld: [u64; 2],
    /// Outcome of every model.
    pub runs: Vec<ModelOutcome>,
    /// Outcome of the last model without one kind of measurement beside GNSS at a time, where that was asked for: constraints of
    /// the vehicle and sensors that the run without outages used.
    pub without: Vec<(Aid, ModelOutcome)>,
}

impl Experiment {
    /// The noise models that were compared, by their names in the tables; none of bias models of the drive's own.
    pub(super) fn noise_models(&self) -> BTreeMap<String, NoiseModelRun> {
        let of = |one: &ComparedModel| {
            let run = NoiseModelRun {
                model: one.model.as_ref()?.name.clone(),
                bias_model: one.kind.name().into(),
            };
            Some((one.name.clone(), run))
        };
        self.compared.iter().filter_map(of).collect()
    }

    /// Errors without one kind of measurement at a time, by its key, as a result; `say` makes the sentences.
    pub(super) fn without_each(&self, say: Say<'_>) -> BTreeMap<String, ModelErrors> {
        let run = |(aid, (_, run)): &(Aid, ModelOutcome)| {
            let run = run.as_ref().ok()?;
            Some((aid.key(), run.errors.result(say)))
        };
        self.without.iter().filter_map(run).collect()
    }
}

/// The model of the run without outages: that of `navigate`.
pub const UNCUT: BiasModel = BiasModel::Arma;

impl Logs {
    /// Samples that a run of this many models processes in all, for progress; `without` as for [`Logs::compare`].
    pub fn samples(&self, models: usize, without: bool) -> u64 {
        let without = if without { self.aids().len() } else { 0 };
        (self.imu.len() * (models + 1 + without)) as u64
    }

    /// Does [`Logs::compare`] with bias models of the drive's noise model.
    ///
    /// # Errors
    /// As [`Logs::compare`].
    pub fn run(
        &self,
        kinds: &[BiasModel],
        cuts: &[Outage],
        hindsight: Hindsight,
        done: &(dyn Fn(u64) + Sync),
    ) -> Result<Experiment, NavigateError> {
        let compared: Vec<ComparedModel> = kinds.iter().copied().map(Into::into).collect();
        self.compare(&compared, cuts, hindsight, false, done)
    }

    /// Navigates the drive, with its own noise model, without outages, then runs every model through the outages, on all
    /// cores; smoothed, the errors are those that are left when the fixes after an outage are known too. What the run without
    /// outages rejects is no reference, and an outage without one is left out: all models have the same outages and the same
    /// reference. With `without` the last of the models goes through them again without each constraint and sensor beside GNSS.
    /// `done` is called with how many more samples were taken, of [`Logs::samples`].
    ///
    /// # Errors
    /// A drive without a model, or a model that makes no filter at the log's rate; logs that cannot be read again.
    pub fn compare(
        &self,
        compared: &[ComparedModel],
        cuts: &[Outage],
        hindsight: Hindsight,
        without: bool,
        done: &(dyn Fn(u64) + Sync),
    ) -> Result<Experiment, NavigateError> {
        let wanted = Wanted {
            hindsight,
            rejected: true,
            ..Wanted::default()
        };
        let uncut = match navigate::navigate(&self.drive, UNCUT, wanted) {
            Ok(report) => Ok(report),
            Err(NavigateError::Replay(error)) => Err(error),
            Err(error) => return Err(error),
        };
        done(self.imu.len() as u64);
        let none = Rejected::default();
        let rejected = uncut.as_ref().map_or(&none, |report| &report.rejected);
        let started = uncut
            .as_ref()
            .ok()
            .and_then(|report| report.summary.started);
        let coverage = Coverage::new(&self.imu, &self.aiding, &self.truth, rejected, started);
        let (mut counted, mut left_out) = (Vec::new(), Vec::new());
        for cut in cuts {
            match coverage.why_left_out(cut) {
                Some(why) => left_out.push((*cut, why)),
                None => counted.push(*cut),
            }
        }
        let mut jobs = compared
            .iter()
            .map(|one| self.job(one, &counted, hindsight))
            .collect::<Result<Vec<_>, NavigateError>>()?;
        let used = |aid: &Aid| {
            let report = uncut.as_ref().ok();
            report.is_some_and(|report| report.summary.innovations[*aid].updates > 0)
        };
        let aids: Vec<Aid> = self.aids().into_iter().filter(used).collect();
        let aids = if without { aids } else { Vec::new() };
        if let Some(last) = jobs.last().cloned() {
            jobs.extend(aids.iter().map(|aid| last.without(*aid)));
        }
        let reference = Reference {
            truth: &self.truth,
            rejected,
        };
        let withheld = match self.truth.is_empty() {
            true => withheld(&self.aiding, rejected, |time| {
                let next = counted.partition_point(|cut| !cut.contains(time) && cut.end < time);
                counted.get(next).is_some_and(|cut| cut.contains(time))
            }),
            false => [0; 2],
        };
        let mut runs = match counted.is_empty() {
            true => Vec::new(),
            false => parallel::map(jobs.len(), |k| {
                let job = &jobs[k];
                run_one(
                    &job.imu,
                    &job.aiding,
                    reference,
                    job.name,
                    &job.settings,
                    done,
                )
            }),
        };
        let of_aids = runs.split_off(compared.len().min(runs.len()));
        Ok(Experiment {
            hindsight,
            compared: compared.to_vec(),
            cuts: counted,
            left_out,
            withheld,
            uncut,
            runs,
            without: aids.into_iter().zip(of_aids).collect(),
        })
    }

    /// Kinds of measurements beside GNSS that the drive has: constraints of its vehicle and sensors.
    fn aids(&self) -> Vec<Aid> {
        let Constraints {
            non_holonomic,
            zero_velocity,
            air,
            ..
        } = &self.drive.constraints;
        let constraints = [
            (Aid::NonHolonomic, non_holonomic.is_some()),
            (Aid::Air, air.is_some()),
            (Aid::ZeroVelocity, zero_velocity.is_some()),
            (Aid::Magnetometer, self.drive.magnetometer.is_some()),
        ];
        let sensors = ScalarLog::ALL.map(|log| (log.aid(), self.drive.scalars[log].is_some()));
        let all = constraints.into_iter().chain(sensors);
        all.filter_map(|(aid, has)| has.then_some(aid)).collect()
    }

    /// A model to be run through the outages.
    fn job<'a>(
        &'a self,
        one: &'a ComparedModel,
        cuts: &[Outage],
        hindsight: Hindsight,
    ) -> Result<Job<'a>, NavigateError> {
        let drive = one.with_model(&self.drive);
        let mut settings = settings(&drive, one.kind)?;
        if hindsight != Hindsight::Causal {
            look_ahead(&mut settings, self.study());
        }
        settings.outages = cuts.to_vec();
        settings.nodes = (hindsight == Hindsight::Smooth).then_some(NODE_SPAN);
        Ok(Job {
            name: &one.name,
            settings,
            imu: self.samples_of(&drive)?,
            aiding: Cow::Borrowed(&self.aiding),
        })
    }
}

/// One run through the outages.
#[derive(Clone)]
struct Job<'a> {
    name: &'a str,
    settings: Settings,
    imu: Cow<'a, [ImuSample]>,
    aiding: Cow<'a, [Measurement]>,
}

impl Job<'_> {
    /// The same run without one kind of measurement.
    fn without(&self, aid: Aid) -> Self {
        let mut job = self.clone();
        job.settings.constraints = job.settings.constraints.without(aid);
        if job.aiding.iter().any(|measured| measured.is(aid)) {
            job.aiding.to_mut().retain(|measured| !measured.is(aid));
        }
        job
    }
}
