//! A drive's logs in memory, and the experiment on them.

use super::{
    errors::ModelOutcome,
    result::{result, track},
    run::run,
    schedule::{Schedule, ScheduleError, schedule},
};
use crate::{
    drive::{Drive, ScalarLog},
    findings::{self, Finding, Log},
    fixes::{self, FixStudy},
    mounting::Mounting,
    navigate::{
        Hindsight, NavigateError, look_ahead, resolve_ahead, scalars, scalars_read, settings,
    },
    replay::{Measurement, Outage, ReplayError, merge},
    results::{self, Outages},
};
use std::path::Path;
use undrift_io::{
    imu::{GapSummary, ThermalSummary},
    skipped::Skipped,
};
use undrift_nav::sample::{GnssFix, ImuSample, TruthSample};
use undrift_noise::BiasModel;

/// Longest span between two nodes of the smoother \[s\]: the errors are taken at nodes.
const NODE_SPAN: f64 = 0.2;

/// A drive and all that its logs hold. Every model is run on the same.
pub struct Logs {
    /// The drive, in the vehicle's axes; in the sensor's where the mounting is to be found on the way.
    pub drive: Drive,
    /// The mounting, where the drive asks for an estimate and it was looked for ahead.
    pub mounting: Option<Mounting>,
    /// Inertial samples.
    pub imu: Vec<ImuSample>,
    /// Fixes.
    pub gnss: Vec<GnssFix>,
    /// Fixes and all other measurements in order of time.
    pub aiding: Vec<Measurement>,
    /// What the fixes show of themselves.
    study: Option<FixStudy>,
    /// The reference; empty if there is none.
    pub truth: Vec<TruthSample>,
    skipped: Vec<(Log, Skipped)>,
    thermal: Option<ThermalSummary>,
    scalars: Vec<(ScalarLog, Skipped, GapSummary)>,
}

impl Logs {
    /// Reads the logs of a drive, for runs that know so much of them.
    ///
    /// # Errors
    /// A log that cannot be read; a mounting that cannot be estimated.
    pub fn load(drive: &Drive, hindsight: Hindsight) -> Result<Self, NavigateError> {
        let (drive, mounting) = resolve_ahead(drive, hindsight)?;
        let mut imu_reader = drive.open_imu()?;
        let imu = imu_reader.by_ref().collect::<Result<Vec<_>, _>>()?;
        let mut gnss_reader = drive.open_gnss()?;
        let gnss = gnss_reader.by_ref().collect::<Result<Vec<_>, _>>()?;
        let mut logs = drive.open_scalars()?;
        let aiding = merge(
            gnss.iter().copied().map(Measurement::Gnss).map(Ok),
            scalars(&mut logs),
        )
        .collect::<Result<Vec<_>, _>>()?;
        let mut skipped = vec![
            (Log::Imu, imu_reader.skipped().clone()),
            (Log::Gnss, gnss_reader.skipped().clone()),
        ];
        let mut truth = Vec::new();
        if let Some(mut reader) = drive.open_truth()? {
            truth = reader.by_ref().collect::<Result<Vec<_>, _>>()?;
            skipped.push((Log::Truth, reader.skipped().clone()));
        }
        let applied = gnss.iter().map(|fix| drive.quality.apply(fix));
        let study = fixes::study(applied);
        Ok(Self {
            drive,
            mounting,
            imu,
            gnss,
            aiding,
            study,
            truth,
            skipped,
            thermal: imu_reader.thermal(),
            scalars: scalars_read(&logs),
        })
    }

    /// What the fixes show of themselves.
    pub fn study(&self) -> Option<&FixStudy> {
        self.study.as_ref()
    }

    /// The outages of `length` \[s\] that a schedule asks for.
    ///
    /// # Errors
    /// When there is no fix, or they do not fit the fixes or the truth.
    pub fn plan(&self, plan: &Schedule, length: f64) -> Result<Vec<Outage>, ScheduleError> {
        let (Some(first), Some(last)) = (self.gnss.first(), self.gnss.last()) else {
            return Err(ScheduleError::NoFix(self.drive.gnss.0.clone()));
        };
        let cuts = schedule(plan, length, first.time, last.time)?;
        if let (Some(first), Some(last)) = (self.truth.first(), self.truth.last()) {
            let covered = |t: f64| first.time <= t && t <= last.time;
            let is_beyond = |c: &&Outage| !covered(c.start) || !covered(c.end);
            if let Some(&outage) = cuts.iter().find(is_beyond) {
                let truth = [first.time, last.time];
                return Err(ScheduleError::BeyondTruth { truth, outage });
            }
        }
        Ok(cuts)
    }

    /// Runs every bias model through the outages, on all cores; smoothed, the errors are those
    /// that are left when the fixes after an outage are known too. `done` is called with how many
    /// more samples a model has taken, of [`Logs::imu`] times the models.
    ///
    /// # Errors
    /// A drive without a model, or with one that is none at the log's rate.
    pub fn run(
        &self,
        kinds: &[BiasModel],
        cuts: &[Outage],
        hindsight: Hindsight,
        done: &(dyn Fn(u64) + Sync),
    ) -> Result<Vec<ModelOutcome>, NavigateError> {
        let models = kinds
            .iter()
            .map(|kind| {
                let mut settings = settings(&self.drive, *kind)?;
                if hindsight != Hindsight::Causal {
                    look_ahead(&mut settings, self.study.as_ref());
                }
                settings.outages = cuts.to_vec();
                settings.nodes = (hindsight == Hindsight::Smooth).then_some(NODE_SPAN);
                Ok((kind.name().to_owned(), settings))
            })
            .collect::<Result<Vec<_>, NavigateError>>()?;
        Ok(run(&self.imu, &self.aiding, &self.truth, &models, done))
    }

    /// What the errors are measured against: "truth", or "gnss" for the withheld fixes.
    pub fn reference(&self) -> &'static str {
        if self.truth.is_empty() {
            "gnss"
        } else {
            "truth"
        }
    }

    /// The way driven.
    pub fn track(&self) -> Vec<TruthSample> {
        track(&self.truth, &self.gnss)
    }

    /// What the logs and the runs show; of several models' runs, what the first one shows of the logs.
    pub fn findings(&self, results: &[ModelOutcome]) -> Vec<Finding> {
        let mut found = Vec::new();
        let mut runs = results.iter().filter_map(|(_, run)| run.as_ref().ok());
        if let Some(run) = runs.next() {
            let s = &run.summary;
            if let Some(study) = &self.study {
                found.extend(findings::of_fixes(study, &study.errors));
            }
            found.extend(findings::of_health(s));
            // One model that loses its way finds no mounting; another does.
            let finds = |(_, run): &ModelOutcome| {
                (run.as_ref()).is_ok_and(|run| run.summary.no_mounting.is_none())
            };
            if results.iter().any(finds) {
                found.retain(|of| !matches!(of, Finding::NoMounting { .. }));
            }
            found.extend(findings::of_temperature(self.thermal));
            // Among several, what one model disagrees with says nothing of the log.
            if runs.next().is_none() {
                let mounted = s.mountings.last().map(|(_, mounting)| mounting.matrix());
                let rotation = mounted.unwrap_or(self.drive.imu.1.rotation);
                found.extend(findings::with_axes(findings::of_disagreement(s), &rotation));
            }
            for (log, skipped, gaps) in &self.scalars {
                let used = &s.innovations[log.aid()];
                found.extend(findings::of_scalar(log.log(), skipped, gaps, used));
            }
        }
        let ran = results
            .iter()
            .filter_map(|(model, run)| Some((model, run.as_ref().ok()?)));
        let models: Vec<_> = ran
            .map(|(model, run)| (model.as_str(), &run.errors))
            .collect();
        found.extend(findings::of_drift(&models));
        if let (Some(sample), Some(first), Some(last), None) = (
            self.imu.last(),
            self.gnss.first(),
            self.gnss.last(),
            self.drive.logs.span,
        ) {
            found.extend(findings::of_ends(sample.time, [first.time, last.time]));
        }
        let failed = results.iter().find_map(|(_, run)| run.as_ref().err());
        found.extend(failed.into_iter().flat_map(ReplayError::findings));
        let logs: Vec<_> = self.skipped.iter().map(|(log, s)| (*log, s)).collect();
        found.extend(findings::of_skipped(&logs));
        findings::ranked(found)
    }

    /// The experiment as a result; `file` is the drive file.
    pub fn result(
        &self,
        file: &Path,
        cuts: &[Outage],
        results: &[ModelOutcome],
        hindsight: Hindsight,
    ) -> Outages {
        Outages {
            drive: results::Drive::of(file, &self.drive),
            reference: self.reference().into(),
            smooth: hindsight == Hindsight::Smooth,
            look_ahead: hindsight != Hindsight::Causal,
            findings: self.findings(results),
            ..result(cuts, results, &self.track())
        }
    }
}
