//! One log through the filter: samples and fixes merged in time, fixes withheld during outages.
//!
//! Streamed: nothing here grows with the log. A fix between two samples splits the interval at its
//! own time. What happens at each sample and fix is told to an [`Observer`].

mod bridge;

use crate::align::{AlignSettings, Aligner};
use bridge::Bridge;
use undrift_nav::{
    Vector3,
    covariance::{AXES, NAV},
    filter::{Filter, FilterError},
    sample::{GnssFix, ImuSample},
    shaping::ShapingFilter,
};

/// Half-open span of time without GNSS: fixes after `start` up to and including `end` are withheld.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outage {
    /// Last instant with GNSS [s], in the log's time base.
    pub start: f64,
    /// End [s].
    pub end: f64,
}

impl Outage {
    /// Whether `time` [s] lies in `(start, end]`. A microsecond of slack absorbs the rounding of stamps.
    pub fn contains(&self, time: f64) -> bool {
        time > self.start + STAMP_ROUNDING && time <= self.end + STAMP_ROUNDING
    }
}

/// Stamps closer than this [s] are the same instant.
pub const STAMP_ROUNDING: f64 = 1e-6;

/// How a log is navigated.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Noise models of gyro x, y, z and accelerometer x, y, z at the log's sample interval.
    pub sensors: [ShapingFilter; AXES],
    /// IMU → antenna, body axes [m].
    pub lever_arm: Vector3,
    /// Which parts of a fix are used. Alignment takes the position in any case.
    pub gnss_use: GnssUse,
    /// How the first position, velocity and attitude are found.
    pub align: AlignSettings,
    /// Spans without GNSS, in order.
    pub outages: Vec<Outage>,
}

/// Which parts of a fix are used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GnssUse {
    /// Position and velocity, whichever it has.
    #[default]
    Both,
    /// Position only.
    Position,
    /// Velocity only, once aligned.
    Velocity,
}

/// Told of everything that happens, in order of time.
pub trait Observer {
    /// A sample was processed, and every fix up to its end; the filter stands at the sample's end.
    fn sample<const N: usize>(&mut self, filter: &Filter<N>) -> Result<(), ReplayError>;
    /// A fix was reached; the filter stands at its time, before any update with it.
    fn fix<const N: usize>(&mut self, filter: &Filter<N>, fix: &GnssFix, withheld: bool);
}

/// Sums of the normalised innovations squared of one kind of measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Innovations {
    /// Updates made.
    pub updates: u64,
    /// Sum of NIS over them.
    pub nis_sum: f64,
    /// Sum of their degrees of freedom: what `nis_sum` is on average when the model is right.
    pub dof_sum: u64,
}

impl Innovations {
    fn add(&mut self, update: undrift_nav::filter::Update) {
        self.updates += 1;
        self.nis_sum += update.nis;
        self.dof_sum += update.dof as u64;
    }

    /// NIS per degree of freedom: 1 when the model is right. `None` without updates.
    pub fn per_dof(&self) -> Option<f64> {
        (self.dof_sum > 0).then(|| self.nis_sum / self.dof_sum as f64)
    }
}

/// What a replay was like.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// Samples processed after alignment.
    pub samples: u64,
    /// Samples used up by alignment.
    pub align_samples: u64,
    /// When navigation began [s].
    pub started: Option<f64>,
    /// How the heading was found, in words.
    pub alignment: String,
    /// Time of the last sample [s].
    pub ended: f64,
    /// Fixes used.
    pub fixes: u64,
    /// Fixes withheld by outages.
    pub withheld: u64,
    /// Fixes before the first sample or before alignment could use them.
    pub fixes_before: u64,
    /// Fixes that could not be used because their covariance is not one.
    pub bad_fixes: u64,
    /// Position updates.
    pub position: Innovations,
    /// Velocity updates.
    pub velocity: Innovations,
    /// Short gaps in the samples that were bridged by interpolation.
    pub bridged: u64,
    /// Gaps too long for that, covariance grown: their number, the first one's time [s], the longest [s].
    pub long_gaps: Option<(u64, f64, f64)>,
    /// Longest span without a fix, outages aside: start and length [s].
    pub longest_without_gnss: (f64, f64),
    /// When the solution stopped being one, if it did [s].
    pub diverged: Option<f64>,
    /// Start of the first [`SUSPECT_UPDATES`] updates on end, or fewer at the end of the log, whose
    /// innovations were far beyond their predicted size [s].
    pub suspect: Option<f64>,
}

/// NIS per degree of freedom over this many updates …
pub const SUSPECT_UPDATES: u32 = 20;
/// … and above this value makes a solution suspect of divergence.
pub const SUSPECT_NIS: f64 = 25.0;

/// Why a replay stopped without a result.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// Reading the log failed.
    #[error(transparent)]
    Read(#[from] undrift_io::ReadError),
    /// Writing the result failed.
    #[error("cannot write the result: {0}")]
    Write(#[from] std::io::Error),
    /// No alignment before the log ended.
    #[error("{0}")]
    NotAligned(String),
    /// The filter cannot be built.
    #[error(transparent)]
    Filter(#[from] FilterError),
}

/// A gap longer than this many sample intervals is not one late sample …
const GAP_INTERVALS: f64 = 1.5;
/// What a vehicle may do unseen in a long gap: acceleration [m/s²] and turn rate [rad/s], one sigma.
const GAP_ACCEL: f64 = 2.0;
const GAP_RATE: f64 = 0.2;

/// Navigates a log. The size of the filter follows the models.
pub fn replay(
    imu: impl Iterator<Item = Result<ImuSample, undrift_io::ReadError>>,
    gnss: impl Iterator<Item = Result<GnssFix, undrift_io::ReadError>>,
    settings: &Settings,
    observer: &mut impl Observer,
) -> Result<Summary, ReplayError> {
    let states = NAV + settings.sensors.iter().map(|f| f.order).sum::<usize>();
    match states {
        ..=9 => run::<9>(imu, gnss, settings, observer),
        10..=15 => run::<15>(imu, gnss, settings, observer),
        16..=21 => run::<21>(imu, gnss, settings, observer),
        22..=27 => run::<27>(imu, gnss, settings, observer),
        28..=33 => run::<33>(imu, gnss, settings, observer),
        _ => run::<45>(imu, gnss, settings, observer),
    }
}

fn run<const N: usize>(
    imu: impl Iterator<Item = Result<ImuSample, undrift_io::ReadError>>,
    gnss: impl Iterator<Item = Result<GnssFix, undrift_io::ReadError>>,
    settings: &Settings,
    observer: &mut impl Observer,
) -> Result<Summary, ReplayError> {
    let mut run = Run::<N> {
        filter: None,
        aligner: Aligner::new(settings),
        settings,
        summary: Summary::default(),
        last_fix: None,
        streak: Streak::default(),
        previous: None,
        bridge: None,
    };
    let mut gnss = gnss.peekable();
    let (mut imu_start, mut first_fix) = (None, None);
    for sample in imu {
        let sample = sample?;
        let start = sample.time - sample.dt;
        if imu_start.is_none() {
            imu_start = Some(sample.time);
            first_fix = gnss
                .peek()
                .and_then(|fix| fix.as_ref().ok())
                .map(|fix| fix.time);
            while let Some(Ok(fix)) = gnss.peek() {
                if fix.time >= start - STAMP_ROUNDING {
                    break;
                }
                run.summary.fixes_before += 1;
                gnss.next();
            }
        }
        run.begin(&sample);
        while let Some(fix) = gnss.next_if(|fix| match fix {
            Ok(fix) => fix.time <= sample.time + STAMP_ROUNDING,
            Err(_) => true,
        }) {
            run.fix(&fix?, &sample, observer)?;
            if run.summary.diverged.is_some() {
                return Ok(run.summary);
            }
        }
        run.finish(&sample, observer)?;
        if run.summary.diverged.is_some() {
            return Ok(run.summary);
        }
    }
    if run.filter.is_none() {
        let mut why = run.aligner.why_not();
        if let (Some(imu), Some(gnss)) = (imu_start, first_fix) {
            let end = run.summary.ended;
            why += &format!(
                "; the samples run from {imu:.3} s to {end:.3} s, the fixes from {gnss:.3} s on"
            );
        }
        return Err(ReplayError::NotAligned(why));
    }
    if let Some(last) = run.last_fix {
        run.note_span_without_gnss(last, run.summary.ended);
    }
    run.judge_streak();
    Ok(run.summary)
}

/// The state of a replay between samples.
struct Run<'a, const N: usize> {
    filter: Option<Filter<N>>,
    aligner: Aligner,
    settings: &'a Settings,
    summary: Summary,
    last_fix: Option<f64>,
    streak: Streak,
    previous: Option<ImuSample>,
    /// While a gap is being bridged.
    bridge: Option<Bridge>,
}

/// Updates, their NIS and degrees of freedom since the count began, and when that was [s].
#[derive(Default)]
struct Streak {
    updates: u32,
    nis: f64,
    dof: u32,
    start: f64,
}

impl<const N: usize> Run<'_, N> {
    /// Takes up a sample: the filter's, bridged where samples are missing before it, or the aligner's.
    fn begin(&mut self, sample: &ImuSample) {
        let Some(filter) = &mut self.filter else {
            return;
        };
        let interval = self.settings.sensors[0].interval;
        if sample.dt <= GAP_INTERVALS * interval {
            filter.begin(sample);
            return;
        }
        let before = self.previous.filter(|p| p.dt > 0.0);
        let mut bridge = Bridge::new(sample, before.as_ref(), interval);
        match bridge.unknown_since {
            Some(start) => {
                let (count, first, longest) = self.summary.long_gaps.unwrap_or((0, start, 0.0));
                self.summary.long_gaps = Some((count + 1, first, longest.max(sample.dt)));
            }
            None => self.summary.bridged += 1,
        }
        if let Some(first) = bridge.next() {
            filter.begin(&first);
        }
        self.bridge = Some(bridge);
    }

    /// Moves the filter to `time` [s] within the present sample.
    fn advance_to(&mut self, time: f64) {
        let Some(filter) = &mut self.filter else {
            return;
        };
        if let Some(bridge) = &mut self.bridge {
            while bridge.reached() < time - STAMP_ROUNDING
                && let Some(next) = bridge.next()
            {
                filter.advance(1.0);
                filter.begin(&next);
            }
        }
        filter.advance_to(time, STAMP_ROUNDING);
    }

    /// Grows the covariance for the part of a long gap up to `time` [s] that it has not grown for.
    fn grow_to(&mut self, time: f64) {
        if let (Some(filter), Some(bridge)) = (&mut self.filter, &mut self.bridge)
            && let Some(since) = bridge.unknown_since
        {
            filter.grow((time - since).max(0.0), GAP_RATE, GAP_ACCEL);
            bridge.unknown_since = Some(time);
        }
    }

    /// A fix within the present sample.
    fn fix(
        &mut self,
        fix: &GnssFix,
        sample: &ImuSample,
        observer: &mut impl Observer,
    ) -> Result<(), ReplayError> {
        let withheld = self.settings.outages.iter().any(|o| o.contains(fix.time));
        if self.filter.is_none() {
            if withheld {
                self.summary.withheld += 1;
                return Ok(());
            }
            self.aligner.advance(sample, fix.time);
            let fix = &match self.settings.gnss_use {
                GnssUse::Position => GnssFix {
                    velocity: None,
                    ..*fix
                },
                _ => *fix,
            };
            if let Some(aligned) = self.aligner.fix::<N>(fix, self.settings)? {
                self.summary.started = Some(fix.time);
                self.summary.alignment = aligned.how;
                self.last_fix = Some(fix.time);
                self.filter = Some(aligned.filter);
                // The rest of this sample's interval.
                let rest = sample.time - fix.time;
                if rest > STAMP_ROUNDING {
                    let part = rest / sample.dt;
                    self.begin(&ImuSample {
                        time: sample.time,
                        dt: rest,
                        dtheta: sample.dtheta * part,
                        dvel: sample.dvel * part,
                    });
                }
            } else {
                self.summary.fixes_before += 1;
            }
            return Ok(());
        }
        self.advance_to(fix.time);
        if !withheld {
            self.grow_to(fix.time);
        }
        let Some(filter) = &mut self.filter else {
            return Ok(());
        };
        observer.fix(filter, fix, withheld);
        if withheld {
            self.summary.withheld += 1;
            // An outage is no fault of the receiver's.
            self.last_fix = Some(fix.time);
            return Ok(());
        }
        let lever = &self.settings.lever_arm;
        let mut used = false;
        let mut updates = [None, None];
        if let Some((position, covariance)) = &fix.position
            && self.settings.gnss_use != GnssUse::Velocity
        {
            let observed = filter.observe_position(position, lever);
            updates[0] = Some(filter.update_with(&observed, covariance));
        }
        if let Some((v_n, covariance)) = &fix.velocity
            && self.settings.gnss_use != GnssUse::Position
        {
            let observed = filter.observe_velocity(v_n, lever);
            updates[1] = Some(filter.update_with(&observed, covariance));
        }
        let diverged = filter.check().is_err();
        for (kind, update) in updates.into_iter().enumerate() {
            match update {
                Some(Ok(update)) => {
                    used = true;
                    let sums = if kind == 0 {
                        &mut self.summary.position
                    } else {
                        &mut self.summary.velocity
                    };
                    sums.add(update);
                    self.watch(update, fix.time);
                }
                Some(Err(_)) => self.summary.bad_fixes += 1,
                None => {}
            }
        }
        if used {
            self.summary.fixes += 1;
            if let Some(last) = self.last_fix.replace(fix.time) {
                self.note_span_without_gnss(last, fix.time);
            }
        }
        if diverged {
            self.summary.diverged = Some(fix.time);
        }
        Ok(())
    }

    /// The rest of the sample, after its fixes.
    fn finish(
        &mut self,
        sample: &ImuSample,
        observer: &mut impl Observer,
    ) -> Result<(), ReplayError> {
        self.previous = Some(*sample);
        self.summary.ended = sample.time;
        self.advance_to(sample.time);
        self.grow_to(sample.time);
        self.bridge = None;
        let Some(filter) = &mut self.filter else {
            self.summary.align_samples += 1;
            self.aligner.advance(sample, sample.time);
            return Ok(());
        };
        if filter.check().is_err() {
            self.summary.diverged = Some(sample.time);
            return Ok(());
        }
        self.summary.samples += 1;
        observer.sample(filter)
    }

    /// Watches for innovations far beyond their covariance, block by block.
    fn watch(&mut self, update: undrift_nav::filter::Update, time: f64) {
        if self.streak.updates == 0 {
            self.streak.start = time;
        }
        self.streak.updates += 1;
        self.streak.nis += update.nis;
        self.streak.dof += update.dof as u32;
        if self.streak.updates == SUSPECT_UPDATES {
            self.judge_streak();
        }
    }

    fn judge_streak(&mut self) {
        let streak = std::mem::take(&mut self.streak);
        if streak.nis > SUSPECT_NIS * f64::from(streak.dof) && self.summary.suspect.is_none() {
            self.summary.suspect = Some(streak.start);
        }
    }

    fn note_span_without_gnss(&mut self, from: f64, to: f64) {
        if to - from > self.summary.longest_without_gnss.1 {
            self.summary.longest_without_gnss = (from, to - from);
        }
    }
}
