//! The noise of a sensor in its vehicle, identified from drives.
//!
//! A record on a table shows the table's noise; engine and road make it several times larger, axis by axis. What the
//! fixes at the end of spans without any say of it is the objective ([`objective`]): the drive is replayed once and
//! condensed ([`steps`]), the linear filter about that solution run under other noise with its exact gradient
//! ([`filter`]), the most likely noise found with a prior that knows the sensor at rest ([`mod@fit`], [`prior`]), and what
//! it buys measured on outages that the fit has not seen ([`mod@judge`]). With figures: docs/lab/tune.md.

mod axes;
pub mod file;
pub mod filter;
pub mod fit;
pub mod judge;
pub mod noise;
pub mod objective;
pub mod prior;
pub mod rest_noise;
mod result;
pub mod search;
pub mod steps;

pub use axes::Axes;
use fit::{Fit, FitLog, fit, under, unseen_likelihood};
use judge::{Following, Judged, Judgement, Unseen, judge};
use noise::Noise;
use prior::Prior;
use rest_noise::{RestNoise, idle};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
pub use undrift_drive::findings::is_tuned;
use undrift_drive::{
    drive::Drive,
    findings::{Finding, IN_VEHICLE},
    navigate::{Hindsight, NavigateError, look_ahead, pose_faults, settings},
    outages::Logs,
    replay::{ReplayError, begin, vibration::densities},
};
use undrift_engine::settings::{Settings, fix_errors::StdFactors};
use undrift_nav::covariance::AXES;
use undrift_noise::{BiasModel, ImuModel};
use undrift_results as results;

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
    pub start: RestNoise,
    /// What was known before.
    pub prior: Prior,
    /// What the drives say.
    pub fit: Fit,
    /// Whether the white noise follows the vibration: then it is that at rest and, beside it, what the samples show
    /// above the band of motion, multiplied by the factors found in its place.
    pub follows: bool,
    /// Share of each drive that judged.
    pub unseen: f64,
    /// Whether the noise is that of the seen part alone.
    pub held_out: bool,
    /// Drift on it.
    pub judged: Vec<Judged>,
    /// What errors of the sensors' axes change that are estimated beside the noise, where they were tried.
    pub axes: Option<Axes>,
    /// What it changes there if the white noise also follows the vibration, where it was tried.
    pub following: Option<Following>,
    /// Positions of the unseen parts, and how many of them are no reference as they are rejected under every noise.
    pub withheld: [u64; 2],
    /// Whether each drive can be aligned under the noise.
    pub aligns: Vec<bool>,
    /// Whether the drives are by poses.
    pub posed: bool,
    /// What is wrong with the poses.
    pub pose_faults: Vec<Finding>,
    /// Whether it was stopped: the noise is the best so far, and nothing was judged after that.
    pub stopped: bool,
}

impl Tuned {
    /// Factors on the noise that the samples show, where it is followed.
    pub fn factors(&self) -> Option<[f64; AXES]> {
        self.follows.then_some(self.fit.noise.white)
    }

    /// The sensor in the vehicle; `drives` are the names of the drives.
    pub fn model(&self, drives: &[&str]) -> ImuModel {
        let noise = &self.fit.noise;
        let white = match self.follows {
            true => &self.start.white,
            false => &noise.white,
        };
        self.named(self.start.model(white, &noise.walk), drives)
    }

    /// The same with one density of the white noise for the whole drive also where it follows the vibration: for a filter
    /// whose noise does not.
    pub fn steady_model(&self, drives: &[&str]) -> ImuModel {
        let walk = &self.fit.noise.walk;
        self.named(self.start.model(&self.densities(), walk), drives)
    }

    /// Density of the white noise of each axis [unit·√s], the root mean square over the drives.
    pub fn densities(&self) -> [f64; AXES] {
        let (found, rest) = (&self.fit.noise.white, &self.start.white);
        match self.start.vibrating.filter(|_| self.follows) {
            Some(vibrating) => std::array::from_fn(|i| {
                let beyond = (vibrating[i].powi(2) - rest[i].powi(2)).max(0.0);
                (rest[i].powi(2) + found[i].powi(2) * beyond).sqrt()
            }),
            None => *found,
        }
    }

    fn named(&self, mut model: ImuModel, drives: &[&str]) -> ImuModel {
        model.name = format!("{} in its vehicle", self.start.name);
        model.source = format!(
            "identified from {} {IN_VEHICLE}, with {} as the sensor at rest",
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

/// The drives under one kind of white noise, and what they say of it.
struct Way<'a> {
    logs: Vec<FitLog<'a>>,
    prior: Prior,
    fit: Fit,
}

/// The first of fits that begin with these that can be made: under what is found on a part of a drive, and under noise as
/// loud as the samples show, an alignment of some seconds may not succeed.
fn first_of(
    from: &[Noise],
    logs: &[FitLog],
    start: &RestNoise,
    prior: &Prior,
    sure: bool,
    goes_on: &dyn Fn(f64) -> bool,
) -> Result<Fit, ReplayError> {
    let (last, others) = from.split_last().expect("a noise to begin with");
    for from in others {
        if let Ok(fit) = fit(logs, start, prior, *from, sure, goes_on) {
            return Ok(fit);
        }
    }
    fit(logs, start, prior, *last, sure, goes_on)
}

/// What is known before the drives.
fn prior_of(logs: &[FitLog], start: &RestNoise) -> Prior {
    let of_drives: Vec<&Settings> = logs.iter().map(|log| &log.settings).collect();
    Prior::new(start, &of_drives)
}

/// When navigation begins \[s\].
fn begins(logs: &Logs, settings: &Settings) -> Result<Option<f64>, ReplayError> {
    let imu = &mut logs.imu.iter().copied().map(Ok);
    let aiding = &mut logs.aiding.iter().copied().map(Ok);
    Ok(begin(imu, aiding, settings)?.map(|filter| filter.nav().time))
}

/// Noise while the vehicle is at rest, of the drives' seen parts: the root mean square of those that have any. Vehicles
/// that hover or float are never at rest.
fn standing(logs: &[FitLog]) -> Option<[f64; AXES]> {
    let seen = |log: &FitLog| {
        let end = log.imu.partition_point(|s| s.time <= log.until);
        idle(&log.imu[..end], log.aiding)
    };
    let comes_to_rest = |log: &&FitLog| log.settings.constraints.zero_velocity.is_some();
    root_mean_square(
        &logs
            .iter()
            .filter(comes_to_rest)
            .filter_map(seen)
            .collect::<Vec<_>>(),
    )
}

/// White noise that the samples of the drives' seen parts show ([`undrift_drive::replay::Vibration`]): the root mean square.
/// `None` of logs too slow to look.
pub fn vibrating(logs: &[FitLog]) -> Option<[f64; AXES]> {
    let seen = |log: &FitLog| {
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

/// The sensor at rest: what is asked for, else what the first drive names or shows.
fn at_rest(first: &Drive, options: &Options) -> Result<RestNoise, NavigateError> {
    match options.start.as_ref().or(first.model.as_ref()) {
        Some(model) => Ok(RestNoise::from_model(model, first.sample_interval()?)?),
        None => {
            let samples = first.open_imu()?.collect::<Result<Vec<_>, _>>()?;
            RestNoise::from_samples(&samples).ok_or(NavigateError::NoModel)
        }
    }
}

/// The logs of the drives, with the mounting found under a noise.
fn load(drives: &[Drive], start: &RestNoise, noise: &Noise) -> Result<Vec<Logs>, NavigateError> {
    let load = |drive: &Drive| {
        let drive = Drive {
            model: Some(start.model(&noise.white, &noise.walk)),
            std_factors: StdFactors::ONE,
            vibration: None,
            ..drive.clone()
        };
        Logs::load(&drive, Hindsight::LookAhead)
    };
    drives.iter().map(load).collect()
}

/// The share of a drive that the fit sees, and from when to when the fixes lie that it does not see \[s\].
fn split(all: &Logs, hold_out: Option<f64>) -> Result<(FitLog<'_>, (f64, f64)), NavigateError> {
    let mut settings = settings(&all.drive, BiasModel::Arma)?;
    look_ahead(&mut settings, all.study());
    let (mut first, last) = match (all.gnss.first(), all.gnss.last()) {
        (Some(first), Some(last)) => (first.time, last.time),
        _ => (0.0, 0.0),
    };
    if hold_out.is_none() {
        first = begins(all, &settings)?.unwrap_or(first);
    }
    let until = last - hold_out.unwrap_or(HALF) * (last - first);
    let log = FitLog {
        imu: &all.imu,
        aiding: &all.aiding,
        settings,
        until,
    };
    Ok((log, (until, last)))
}

/// The same drives with white noise that follows the vibration; `None` where they cannot be navigated so.
fn following<'a>(
    steady: &Way<'a>,
    start: &RestNoise,
    sure: bool,
    goes_on: &dyn Fn(f64) -> bool,
) -> Option<Way<'a>> {
    let logs = steady.logs.iter().map(|log| FitLog {
        settings: Settings {
            vibration: Some([1.0; AXES]),
            ..log.settings.clone()
        },
        ..*log
    });
    let logs: Vec<FitLog> = logs.collect();
    let prior = prior_of(&logs, start);
    let centre = Noise::new(&prior.centre);
    let from = Noise {
        white: centre.white,
        ..steady.fit.noise
    };
    let fit = first_of(&[from, centre], &logs, start, &prior, sure, goes_on).ok()?;
    Some(Way { logs, prior, fit })
}

/// The settings to judge a drive by: with the sensor at rest, and as each of the ways has found it.
fn before_and_after(
    (k, drive, before): (usize, &Drive, &Settings),
    ways: &[Way],
    start: &RestNoise,
    rest: &ImuModel,
) -> Result<Vec<Settings>, NavigateError> {
    let mut settings = vec![Settings {
        vibration: drive.vibration,
        sensors: rest.shaping(BiasModel::Arma, before.sensors[0].interval)?,
        ..before.clone()
    }];
    for way in ways {
        let after = under(&way.logs[k].settings, &way.fit.noise, start);
        settings.push(after.map_err(ReplayError::from)?);
    }
    Ok(settings)
}

/// Identifies the noise that drives with the same sensor have in common.
///
/// ```
/// # mod undrift {
/// #     pub use undrift_drive::{BiasModel, Drive, ImuModel};
/// #     pub use undrift_tune as tune;
/// # }
/// use undrift::{Drive, ImuModel, tune};
/// # use undrift::BiasModel;
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let model = ImuModel::preset("adis16465").ok_or("no such preset")?;
/// # let noise = model.shaping(BiasModel::GaussMarkov, 0.04)?;
/// # let log = simulate(&Trajectory::car(180.0, 1), 25.0, Some(&noise), &GnssNoise::default(), 1)?;
/// # let (imu, fixes) = (&log.imu, &log.gnss);
///
/// let drive = Drive {
///     model: ImuModel::preset("adis16465"),
///     ..Drive::from_samples(imu, fixes)
/// };
/// let (tuned, _) = tune::tune(&[drive], &tune::Options::default(), &|_stage| true)?;
/// let in_the_vehicle = tuned.model(&["monday"]);
/// assert!(in_the_vehicle.gyro[0].white > Some(0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// `goes_on` is asked along the way; once it
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
    let mut faults = Vec::new();
    for drive in drives {
        faults.extend(pose_faults(drive)?);
    }
    let mut start = at_rest(first, options)?;
    // The mounting is found under some noise: that of a vehicle.
    let quieter = Noise::new(&Prior::new(&start, &[]).centre);
    let loaded = load(drives, &start, &quieter)?;
    let seen = loaded.iter().map(|all| split(all, options.hold_out));
    let (logs, spans): (Vec<_>, Vec<_>) = seen.collect::<Result<_, _>>()?;
    start.idle = standing(&logs);
    start.vibrating = vibrating(&logs);
    let iteration = |value: f64| goes_on(Stage::Fitting(value));
    let sure = options.hold_out.is_some();
    let prior = prior_of(&logs, &start);
    let from = [Noise::new(&prior.centre), quieter];
    let fit = first_of(&from, &logs, &start, &prior, sure, &iteration)?;
    let before = Vec::from_iter(logs.iter().map(|log| log.settings.clone()));
    let mut way = Way { logs, prior, fit };
    let mut axes = None;
    let unstated = |drive: &Drive| drive.poses.is_some_and(|poses| !poses.axes_stated);
    if drives.iter().all(unstated) {
        (way, axes) = axes::tried(way, &start, &from, &spans, sure, &iteration);
    }
    let mut ways = vec![way];
    let follow = drives.iter().all(|drive| drive.vibration.is_some());
    if follow && (0..AXES).any(|axis| start.shakes(axis)) {
        ways.extend(following(&ways[0], &start, sure, &iteration));
    }
    let judges = goes_on(Stage::Judging);
    let rest = options.start.as_ref().or(first.model.as_ref());
    let rest = rest.map_or_else(|| start.model(&start.white, &start.walk), Clone::clone);
    let mut unseen = Vec::new();
    for (k, drive) in drives.iter().enumerate() {
        unseen.push(Unseen {
            log: &ways[0].logs[k],
            truth: &loaded[k].truth,
            settings: before_and_after((k, drive, &before[k]), &ways, &start, &rest)?,
            span: spans[k],
        });
    }
    // Of noise under which a drive cannot be navigated from its start to its end nothing is likely.
    let likelihood = |way: &Way| {
        let unseen = unseen_likelihood(&way.logs, &start, &way.fit.noise, &spans);
        unseen.unwrap_or(f64::NEG_INFINITY)
    };
    // Not a number where neither can be.
    let gain = match ways.as_slice() {
        [steady, following] if judges => Some(likelihood(following) - likelihood(steady)),
        _ => None,
    };
    let follows = gain.is_some_and(|gain| gain >= 0.0);
    let judgement = match judges {
        true => judge(&unseen, gain),
        false => Judgement::default(),
    };
    drop(unseen);
    let mut way = ways.swap_remove(usize::from(follows));
    if !sure && judges {
        for log in &mut way.logs {
            log.until = f64::INFINITY;
        }
        let from = [way.fit.noise, Noise::new(&way.prior.centre), quieter];
        let from = &from[..if follows { 2 } else { 3 }];
        way.fit = first_of(from, &way.logs, &start, &way.prior, true, &iteration)?;
    }
    let Way { logs, prior, fit } = way;
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
        follows,
        unseen: options.hold_out.unwrap_or(HALF),
        held_out: sure,
        judged: judgement.judged,
        axes,
        following: judgement.following,
        withheld: judgement.withheld,
        aligns,
        posed: drives.iter().any(|drive| drive.poses.is_some()),
        pose_faults: faults,
        stopped: stopped.load(Relaxed),
    };
    Ok((tuned, loaded))
}

#[cfg(test)]
mod tests;
