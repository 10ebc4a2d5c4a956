//! The experiment on the logs of a drive: a run without outages first, then every model through the outages.

use super::{
    Logs,
    compared::ComparedModel,
    errors::ModelOutcome,
    left_out::{Needs, WhyLeftOut},
    run::run_one,
};
use crate::rejected::{Reference, Rejected, withheld};
use crate::{
    navigate::{self, Hindsight, NavigateError, Report, Wanted, look_ahead, settings},
    replay::{Outage, ReplayError},
};
use std::collections::BTreeMap;
use undrift_base::parallel;
use undrift_noise::BiasModel;
use undrift_results::NoiseModelRun;

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
}

/// The model of the run without outages: that of `navigate`.
pub const UNCUT: BiasModel = BiasModel::Arma;

impl Logs {
    /// Samples that a run of this many models processes in all, for progress.
    pub fn samples(&self, models: usize) -> u64 {
        (self.imu.len() * (models + 1)) as u64
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
        self.compare(&compared, cuts, hindsight, done)
    }

    /// Navigates the drive, with its own noise model, without outages, then runs every model through the outages, on all
    /// cores; smoothed, the errors are those that are left when the fixes after an outage are known too. What the run without
    /// outages rejects is no reference, and an outage without one is left out: all models have the same outages and the same
    /// reference. `done` is called with how many more samples were taken, of [`Logs::samples`].
    ///
    /// # Errors
    /// A drive without a model, or a model that makes no filter at the log's rate; logs that cannot be read again.
    pub fn compare(
        &self,
        compared: &[ComparedModel],
        cuts: &[Outage],
        hindsight: Hindsight,
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
        let needs = Needs::new(&self.imu, &self.aiding, &self.truth, rejected, started);
        let (mut counted, mut left_out) = (Vec::new(), Vec::new());
        for cut in cuts {
            match needs.lacks(cut) {
                Some(why) => left_out.push((*cut, why)),
                None => counted.push(*cut),
            }
        }
        let models = compared
            .iter()
            .map(|one| {
                let drive = one.with_model(&self.drive);
                let mut settings = settings(&drive, one.kind)?;
                if hindsight != Hindsight::Causal {
                    look_ahead(&mut settings, self.study());
                }
                settings.outages = counted.clone();
                settings.nodes = (hindsight == Hindsight::Smooth).then_some(NODE_SPAN);
                Ok((one.name.as_str(), settings, self.samples_of(&drive)?))
            })
            .collect::<Result<Vec<_>, NavigateError>>()?;
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
        let runs = match counted.is_empty() {
            true => Vec::new(),
            false => parallel::map(models.len(), |k| {
                let (name, settings, imu) = &models[k];
                run_one(imu, &self.aiding, reference, name, settings, done)
            }),
        };
        Ok(Experiment {
            hindsight,
            compared: compared.to_vec(),
            cuts: counted,
            left_out,
            withheld,
            uncut,
            runs,
        })
    }
}
