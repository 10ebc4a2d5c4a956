//! The noise of a sensor in its vehicle, identified from drives.
//!
//! A record on a table shows the table's noise; engine and road make it several times larger, axis by axis. What the
//! fixes at the end of spans without any say of it is the objective ([`objective`]): the drive is replayed once and
//! condensed ([`steps`]), the linear filter about that solution run under other noise with its exact gradient
//! ([`filter`]), the most likely noise found with a prior that knows the sensor at rest ([`mod@fit`], [`prior`]), and what
//! it buys measured on outages that the fit has not seen ([`mod@judge`]). With figures: docs/tune-lab.md.

pub mod file;
pub mod filter;
pub mod fit;
pub mod judge;
pub mod noise;
pub mod objective;
pub mod prior;
mod result;
pub mod search;
pub mod start;
pub mod steps;

use crate::{
    drive::Drive,
    estimator::Estimator,
    navigate::{NavigateError, settings, tell},
    outages::Logs,
    replay::{Observer, ReplayError, replay, vibration::densities},
    results,
    settings::{fix_errors::StdFactors, replay::Settings},
};
use fit::{Fit, Log, fit, under};
use judge::{Following, Judged, Unseen, judge};
use noise::Noise;
use prior::Prior;
use start::{Start, idle};
use std::{
    cell::Cell,
    sync::atomic::{AtomicBool, Ordering::Relaxed},
};
use undrift_nav::covariance::AXES;
use undrift_noise::{BiasModel, ImuModel};

/// What is asked for.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The sensor at rest, in place of what the drives name.
    pub start: Option<ImuModel>,
    /// Share at the end of each drive that the fit does not see. Without it the second half of what is navigated
    /// judges a fit of the first, and the noise is that of all.
    pub hold_out: Option<f64>,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Tuned {
    /// The sensor at rest.
    pub start: Start,
    /// What was known before.
    pub prior: Prior,
    /// What the drives say.
    pub fit: Fit,
    /// Share of each drive that judged.
    pub unseen: f64,
    /// Whether the noise is that of the seen part alone.
    pub held_out: bool,
    /// Drift on it.
    pub judged: Vec<Judged>,
    /// What it changes there if the white noise also follows the vibration, where it was tried.
    pub following: Option<Following>,
    /// Whether each drive can be aligned under the noise.
    pub aligns: Vec<bool>,
    /// Whether it was stopped: the noise is the best so far, and nothing was judged after that.
    pub stopped: bool,
}

impl Tuned {
    /// The sensor in the vehicle; `drives` are the names of the drives.
    pub fn model(&self, drives: &[&str]) -> ImuModel {
        let noise = &self.fit.noise;
        let mut model = self.start.model(&noise.white, &noise.walk);
        model.name = format!("{} in its vehicle", self.start.name);
        model.source = format!(
            "identified from {} by composite likelihood, with {} as the sensor at rest",
            drives.join(", "),
            self.start.name
        );
        model.provenance.program = Some(format!("undrift {}", results::VERSION));
        model
    }
}

/// How far it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stage {
    /// Logs are read.
    Reading,
    /// A fit goes on; its objective, the smaller the better.
    Fitting(f64),
    /// Outages are run.
    Judging,
}

/// Share of each drive that judges where nothing is asked for.
const HALF: f64 = 0.5;

/// When navigation begins \[s\].
fn begins(logs: &Logs, settings: &Settings) -> Result<Option<f64>, ReplayError> {
    struct Begun<'a>(&'a Cell<Option<f64>>);
    impl Observer for Begun<'_> {
        fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
            self.0.set(self.0.get().or(Some(filter.nav().time)));
            Ok(())
        }
    }
    let begun = Cell::new(None);
    let samples = logs.imu.iter().copied().map(Ok);
    let mut samples = samples.take_while(|_| begun.get().is_none());
    let aiding = &mut logs.aiding.iter().copied().map(Ok);
    match replay(&mut samples, aiding, settings, &mut Begun(&begun)) {
        Err(error) if begun.get().is_none() => Err(error),
        _ => Ok(begun.get()),
    }
}

/// Noise while the vehicle stands, of the drives' seen parts: the root mean square of those that have any. What hovers
/// or floats does not stand.
fn standing(logs: &[Log]) -> Option<[f64; AXES]> {
    let seen = |log: &Log| {
        let end = log.imu.partition_point(|s| s.time <= log.until);
        idle(&log.imu[..end], log.aiding)
    };
    let stands = |log: &&Log| log.settings.constraints.zero_velocity.is_some();
    root_mean_square(
        &logs
            .iter()
            .filter(stands)
            .filter_map(seen)
            .collect::<Vec<_>>(),
    )
}

/// White noise that the samples of the drives' seen parts show ([`crate::replay::vibration`]): the root mean square.
fn vibrating(logs: &[Log]) -> Option<[f64; AXES]> {
    let seen = |log: &Log| {
        let end = log.imu.partition_point(|s| s.time <= log.until);
        densities(&log.imu[..end], &log.settings)
    };
    root_mean_square(&logs.iter().filter_map(seen).collect::<Vec<_>>())
}

/// Of the densities of some drives, axis by axis.
fn root_mean_square(found: &[[f64; AXES]]) -> Option<[f64; AXES]> {
    let square = |i: usize| found.iter().map(|d| d[i] * d[i]).sum::<f64>() / found.len() as f64;
    (!found.is_empty()).then(|| std::array::from_fn(|i| square(i).sqrt()))
}

/// Identifies the noise that drives with the same sensor have in common. `goes_on` is asked along the way; once it
/// says no, what has been found so far is returned.
///
/// # Errors
/// A drive that cannot be read or navigated.
pub fn tune(
    drives: &[Drive],
    options: &Options,
    goes_on: &(dyn Fn(Stage) -> bool + Sync),
) -> Result<(Tuned, Vec<Logs>), NavigateError> {
    let stopped = AtomicBool::new(false);
    let goes_on = |stage| {
        stopped.fetch_or(!goes_on(stage), Relaxed);
        !stopped.load(Relaxed)
    };
    goes_on(Stage::Reading);
    let first = drives.first().ok_or(NavigateError::NoModel)?;
    let mut start = match options.start.as_ref().or(first.model.as_ref()) {
        Some(model) => Start::of_model(model, first.sample_interval()?)?,
        None => {
            let samples = first.open_imu()?.collect::<Result<Vec<_>, _>>()?;
            Start::of_samples(&samples).ok_or(NavigateError::NoModel)?
        }
    };
    let mut loaded = Vec::new();
    // The mounting is found under some noise: that of a vehicle.
    let centre = Noise::new(&Prior::new(&start, &[]).centre);
    for drive in drives {
        let drive = Drive {
            model: Some(start.model(&centre.white, &centre.walk)),
            std_factors: StdFactors::ONE,
            vibration: false,
            ..drive.clone()
        };
        loaded.push(Logs::load(&drive)?);
    }
    let unseen = options.hold_out.unwrap_or(HALF);
    let mut logs = Vec::new();
    let mut spans = Vec::new();
    for all in &loaded {
        let mut settings = settings(&all.drive, BiasModel::Arma)?;
        tell(&mut settings, &all.drive, all.study());
        let (mut first, last) = match (all.gnss.first(), all.gnss.last()) {
            (Some(first), Some(last)) => (first.time, last.time),
            _ => (0.0, 0.0),
        };
        if options.hold_out.is_none() {
            first = begins(all, &settings)?.unwrap_or(first);
        }
        let until = last - unseen * (last - first);
        spans.push((until, last));
        logs.push(Log {
            imu: &all.imu,
            aiding: &all.aiding,
            settings,
            until,
        });
    }
    start.idle = standing(&logs);
    start.vibrating = vibrating(&logs);
    let of_drives: Vec<&Settings> = logs.iter().map(|log| &log.settings).collect();
    let prior = Prior::new(&start, &of_drives);
    let (quieter, centre) = (centre, Noise::new(&prior.centre));
    let iteration = |value: f64| goes_on(Stage::Fitting(value));
    let held_out = options.hold_out.is_some();
    // Noise as loud as the samples show may be too much for an alignment of some seconds.
    let seen = fit(&logs, &start, &prior, centre, held_out, &iteration)
        .or_else(|_| fit(&logs, &start, &prior, quieter, held_out, &iteration))?;
    let judges = goes_on(Stage::Judging);
    let rest = options.start.as_ref().or(first.model.as_ref());
    let rest = rest.map_or_else(|| start.model(&start.white, &start.walk), Clone::clone);
    let of_drives = drives.iter().zip(&logs).zip(&loaded).zip(spans);
    let of_drives = of_drives.map(|(((drive, log), all), span)| {
        let before = Settings {
            vibration: drive.vibration,
            sensors: rest.shaping(BiasModel::Arma, log.settings.sensors[0].interval)?,
            ..log.settings.clone()
        };
        let after = under(&log.settings, &seen.noise, &start).map_err(ReplayError::from)?;
        Ok(Unseen {
            log,
            truth: &all.truth,
            settings: [before, after],
            span,
        })
    });
    let of_drives = of_drives.collect::<Result<Vec<_>, NavigateError>>()?;
    let (judged, following) = if judges {
        judge(&of_drives)
    } else {
        (Vec::new(), None)
    };
    let fit = if held_out || !judges {
        seen
    } else {
        for log in &mut logs {
            log.until = f64::INFINITY;
        }
        // Under what a part of the drive has found the whole of it may be too short to align.
        fit(&logs, &start, &prior, seen.noise, true, &iteration)
            .or_else(|_| fit(&logs, &start, &prior, centre, true, &iteration))
            .or_else(|_| fit(&logs, &start, &prior, quieter, true, &iteration))?
    };
    let aligns = logs.iter().zip(&loaded).map(|(log, all)| {
        let settings = under(&log.settings, &fit.noise, &start).map_err(ReplayError::from)?;
        Ok(matches!(begins(all, &settings), Ok(Some(_))))
    });
    let aligns = aligns.collect::<Result<_, NavigateError>>()?;
    drop(logs);
    let tuned = Tuned {
        start,
        prior,
        fit,
        unseen,
        held_out,
        judged,
        following,
        aligns,
        stopped: stopped.load(Relaxed),
    };
    Ok((tuned, loaded))
}
