//! A drive's logs in memory, and the experiment on them.

use super::{
    experiment::Experiment,
    findings::of_outages,
    result::{result, track},
    schedule::{Schedule, ScheduleError, schedule},
};
use crate::{
    drive::{Drive, merged},
    findings::{self, Finding, Log},
    fixes::{self, FixStudy},
    mounting::Mounting,
    navigate::{Hindsight, NavigateError, resolve_ahead},
    replay::{Measurement, Outage, merge},
};
use std::path::Path;
use undrift_io::skipped::Skipped;
use undrift_nav::sample::{GnssFix, ImuSample, TruthSample};
use undrift_results::{self, Outages, Say, Statement};

/// A drive and all records of its logs in memory. Every model is run on the same.
pub struct Logs {
    /// The drive, in the vehicle's axes; in the sensor's where the mounting is to be found on the way.
    pub drive: Drive,
    /// The mounting, where the drive asks for an estimate and it was looked for ahead.
    pub mounting: Option<Mounting>,
    /// Inertial samples in order of time.
    pub imu: Vec<ImuSample>,
    /// Fixes in order of time.
    pub gnss: Vec<GnssFix>,
    /// Fixes and all other measurements in order of time.
    pub aiding: Vec<Measurement>,
    /// What the fixes show of themselves.
    study: Option<FixStudy>,
    /// The reference in order of time; empty without one.
    pub truth: Vec<TruthSample>,
    skipped: Vec<(Log, Skipped)>,
}

impl Logs {
    /// Reads the logs of a drive into memory, for runs with this hindsight; with [`Hindsight::LookAhead`] or
    /// [`Hindsight::Smooth`] a mounting to be estimated is found first.
    ///
    /// # Errors
    /// A log that cannot be read; a mounting that cannot be estimated.
    pub fn load(drive: &Drive, hindsight: Hindsight) -> Result<Self, NavigateError> {
        let (drive, mounting) = resolve_ahead(drive, hindsight)?;
        let mut imu_reader = drive.open_imu()?;
        let imu = imu_reader.by_ref().collect::<Result<Vec<_>, _>>()?;
        let mut gnss_reader = drive.open_gnss()?;
        let gnss = gnss_reader.by_ref().collect::<Result<Vec<_>, _>>()?;
        let mut logs = drive.open_sensors()?;
        let aiding = merge(
            gnss.iter().copied().map(Measurement::Gnss).map(Ok),
            merged(&mut logs),
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
        })
    }

    /// What the fixes show of their own errors.
    pub fn study(&self) -> Option<&FixStudy> {
        self.study.as_ref()
    }

    /// The outages of `length` \[s\] that a schedule asks for, in order of time.
    ///
    /// # Errors
    /// When there is no fix, or they do not fit the fixes or the truth.
    ///
    /// ```
    /// # use undrift_drive as undrift;
    /// use undrift::{Drive, Logs, Schedule, navigate::Hindsight};
    /// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
    /// # let log = simulate(&Trajectory::car(200.0, 1), 50.0, None, &GnssNoise::default(), 1)?;
    /// let logs = Logs::load(&Drive::from_samples(&log.imu, &log.gnss), Hindsight::Causal)?;
    /// let cuts = logs.plan(&Schedule::Every { start: 60.0, every: 30.0, count: None }, 10.0)?;
    /// assert!(cuts.len() == 5 && cuts.iter().all(|cut| (cut.end - cut.start - 10.0).abs() < 1e-9));
    /// assert_eq!(logs.reference(), "gnss"); // Without a truth the withheld fixes.
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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

    /// The outages of the schedule that is `asked` for, or else of [`Schedule::usual`], the first `start` \[s\] after the first fix.
    ///
    /// # Errors
    /// As [`Logs::plan`].
    pub fn plan_or_usual(
        &self,
        asked: Option<Schedule>,
        length: f64,
        start: Option<f64>,
    ) -> Result<Vec<Outage>, ScheduleError> {
        let ends = self.gnss.first().zip(self.gnss.last());
        let span = ends.map_or(0.0, |(first, last)| last.time - first.time);
        let plan = asked.unwrap_or_else(|| Schedule::usual(length, start, span));
        self.plan(&plan, length)
    }

    /// Name of the reference of the errors: "truth", or "gnss" for the withheld fixes.
    pub fn reference(&self) -> &'static str {
        if self.truth.is_empty() {
            "gnss"
        } else {
            "truth"
        }
    }

    /// The ground track: the reference, or the fixes without one.
    pub fn track(&self) -> Vec<TruthSample> {
        track(&self.truth, &self.gnss)
    }

    /// Findings of reading the logs.
    pub fn read_findings(&self) -> Vec<Finding> {
        let mut found = Vec::new();
        found.extend(self.ends_early());
        let logs: Vec<_> = self.skipped.iter().map(|(log, s)| (*log, s)).collect();
        found.extend(findings::of_skipped(&logs));
        findings::ranked(found)
    }

    fn ends_early(&self) -> Option<Finding> {
        let (sample, fixes) = (self.imu.last()?, self.gnss.first().zip(self.gnss.last())?);
        let whole = self.drive.logs.span.is_none();
        let ends = [fixes.0.time, fixes.1.time];
        findings::of_ends(sample.time, ends).filter(|_| whole)
    }

    /// Findings of the run without outages, as in `navigate`, and of the outages.
    pub fn findings(&self, experiment: &Experiment) -> Vec<Finding> {
        let mut found = match &experiment.uncut {
            Ok(report) => report.findings(),
            Err(error) => {
                let mut found = error.findings();
                found.extend(self.read_findings());
                found
            }
        };
        if experiment.uncut.is_ok() {
            found.extend(self.ends_early());
        }
        let cut = of_outages(experiment, &found);
        found.extend(cut);
        findings::ranked(findings::of_model(found, self.drive.model.as_ref()))
    }

    /// The experiment as a result; `file` is the drive file, `say` makes the sentences: `undrift_report::sentence`.
    pub fn result(&self, file: &Path, experiment: &Experiment, say: Say<'_>) -> Outages {
        let findings = self.findings(experiment);
        let hindsight = experiment.hindsight;
        let [withheld, rejected] = experiment.withheld;
        Outages {
            drive: self.drive.result(file),
            reference: self.reference().into(),
            smooth: hindsight == Hindsight::Smooth,
            look_ahead: hindsight != Hindsight::Causal,
            left_out: experiment.left_out.iter().map(Into::into).collect(),
            withheld,
            rejected,
            warnings: findings.iter().map(Statement::Finding).map(say).collect(),
            findings,
            noise_models: experiment.noise_models(),
            without: experiment.without_each(say),
            ..result(&experiment.cuts, &experiment.runs, &self.track(), say)
        }
    }
}
