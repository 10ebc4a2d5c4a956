//! One log through the filter: samples and fixes merged in time, fixes withheld during outages.
//!
//! Streamed: nothing here grows with the log. A fix between two samples splits the interval at its
//! own time. What happens at each sample and fix is told to an [`Observer`].

mod bridge;
mod events;
mod gate;
mod health;
mod measurement;
mod plausible;
mod quality;
mod receiver;
mod rest;
mod run;
mod summary;

pub use events::{Contradiction, FixMend, Implausible, Lean, Log, Part, Restart, RestartCause};
pub use health::CovarianceHealth;
pub use measurement::{Measurement, Scalar, merge};
pub use quality::QualityStd;
pub use summary::{Innovations, MOST_EVENTS, SUSPECT_NIS, SUSPECT_UPDATES, Summary};

use crate::{
    align::{AlignSettings, AlignmentFailure},
    size::{AnySize, sized},
    vehicle::Constraints,
};
use measurement::Queue;
use run::Run;
use undrift_io::skipped::Skipped;
use undrift_nav::{
    Vector3,
    covariance::AXES,
    filter::{Filter, FilterError, Update},
    parameters::Parameters,
    sample::{GnssFix, ImuSample},
    shaping::ShapingFilter,
    tape::Tape,
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
    /// Constants that are estimated beside the sensors' errors.
    pub parameters: Parameters,
    /// What is known of the vehicle.
    pub constraints: Constraints,
    /// Whether fixes pass a gate, and a solution that is none any more begins anew.
    pub gating: bool,
    /// Whether a solution that does not agree with the fixes begins anew, too.
    pub restart: bool,
    /// Whether the stated standard deviations of the fixes are corrected by the innovations.
    pub adapt: bool,
    /// How the kind of solution bears on the standard deviation of a position.
    pub quality: QualityStd,
    /// Longest span between two nodes that a smoother is told of [s]; without it, none.
    pub nodes: Option<f64>,
    /// What the first attitude, sensor states and parameters after alignment are off by, as a smoother
    /// has found in a run before: taken out before navigation begins.
    pub start: Option<Vec<f64>>,
}

impl Settings {
    /// For sensors of these models: antenna at the IMU, alignment by itself, no outages, no
    /// parameters, no vehicle, fixes gated.
    pub fn new(sensors: [ShapingFilter; AXES]) -> Self {
        Self {
            sensors,
            lever_arm: Vector3::zeros(),
            gnss_use: GnssUse::Both,
            align: AlignSettings::default(),
            outages: Vec::new(),
            parameters: Parameters::none(),
            constraints: Constraints::default(),
            gating: true,
            restart: true,
            adapt: false,
            quality: QualityStd::AsStated,
            nodes: None,
            start: None,
        }
    }
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
    ///
    /// # Errors
    /// Its own; the replay ends with it.
    fn sample<const N: usize>(&mut self, filter: &Filter<N>) -> Result<(), ReplayError>;
    /// A fix was reached; the filter stands at its time, before any update with it.
    fn fix<const N: usize>(&mut self, filter: &Filter<N>, fix: &GnssFix, withheld: bool);
    /// A fix at `time` [s] went into the solution, or began it.
    fn used(&mut self, _time: f64) {}
    /// What became of the position and the velocity of the fix of this time [s], where they were
    /// shown to the filter.
    fn updated(&mut self, _time: f64, _updates: [Option<Update>; 2]) {}
    /// A block of samples was judged to be rest or motion; the filter stands at its end.
    fn judged<const N: usize>(&mut self, _filter: &Filter<N>, _rest: bool) {}
    /// A node of a smoother: the filter after all that happened up to now, and the adjoint of what
    /// happened since the node before; `None` at the first one.
    ///
    /// # Errors
    /// Its own; the replay ends with it.
    fn node<const N: usize>(
        &mut self,
        _filter: &Filter<N>,
        _since: Option<&Tape<N>>,
    ) -> Result<(), ReplayError> {
        Ok(())
    }
}

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
    #[error(transparent)]
    NotAligned(Box<NotAligned>),
    /// The filter cannot be built.
    #[error(transparent)]
    Filter(#[from] FilterError),
}

/// A log without an alignment, and what is known of why.
#[derive(Clone, Debug, thiserror::Error)]
#[error("the log could not be aligned: {failure}{}", span(*.times))]
pub struct NotAligned {
    /// What was missing.
    pub failure: AlignmentFailure,
    /// First and last sample and first fix \[s\], where there were both.
    pub times: Option<[f64; 3]>,
    /// Units, axes, signs or times that cannot be right.
    pub implausible: Vec<Implausible>,
    /// What was skipped in each log.
    pub skipped: Vec<(Log, Skipped)>,
}

/// From when to when there are samples and fixes, for [`NotAligned`].
fn span(times: Option<[f64; 3]>) -> String {
    times.map_or(String::new(), |[from, to, fixes]| {
        format!("; the samples run from {from:.3} s to {to:.3} s, the fixes from {fixes:.3} s on")
    })
}

/// Navigates a log. The size of the filter follows the models.
///
/// # Errors
/// A log that cannot be read, no alignment before its end, a filter that cannot be built, or what `observer`
/// ends it with.
pub fn replay(
    imu: impl Iterator<Item = Result<ImuSample, undrift_io::ReadError>>,
    aiding: impl Iterator<Item = Result<Measurement, undrift_io::ReadError>>,
    settings: &Settings,
    observer: &mut impl Observer,
) -> Result<Summary, ReplayError> {
    let sensors: usize = settings.sensors.iter().map(|f| f.order).sum();
    let task = Replay {
        imu,
        aiding,
        settings,
        observer,
    };
    sized(sensors + settings.parameters.states(), task)
}

struct Replay<'a, I, A, O> {
    imu: I,
    aiding: A,
    settings: &'a Settings,
    observer: &'a mut O,
}

impl<I, A, O> AnySize for Replay<'_, I, A, O>
where
    I: Iterator<Item = Result<ImuSample, undrift_io::ReadError>>,
    A: Iterator<Item = Result<Measurement, undrift_io::ReadError>>,
    O: Observer,
{
    type Output = Result<Summary, ReplayError>;

    fn with<const N: usize>(self) -> Self::Output {
        run::<N>(self.imu, self.aiding, self.settings, self.observer)
    }
}

fn run<const N: usize>(
    imu: impl Iterator<Item = Result<ImuSample, undrift_io::ReadError>>,
    aiding: impl Iterator<Item = Result<Measurement, undrift_io::ReadError>>,
    settings: &Settings,
    observer: &mut impl Observer,
) -> Result<Summary, ReplayError> {
    let mut run = Run::<N>::new(settings);
    let mut aiding = Queue::new(aiding);
    let (mut imu_start, mut first_fix) = (None, None);
    let mut fixes_within = 0;
    for sample in imu {
        let (sample, broken_off) = run.after_gap(sample?);
        let start = sample.time - sample.dt;
        if imu_start.is_none() || broken_off {
            imu_start.get_or_insert(sample.time);
            while let Some(before) = aiding.next_until(start - STAMP_ROUNDING, 0.0) {
                if let Measurement::Gnss(fix) = before? {
                    first_fix.get_or_insert(fix.time);
                    run.summary.fixes_before += 1;
                }
            }
        }
        run.plausible.sample(&sample);
        run.begin(&sample);
        while let Some(measurement) =
            aiding.next_until(sample.time + STAMP_ROUNDING, run.fix_offset())
        {
            match measurement? {
                Measurement::Gnss(fix) => {
                    first_fix.get_or_insert(fix.time);
                    fixes_within += 1;
                    run.plausible.fix(&fix);
                    run.fix(&fix, &sample, observer)?;
                }
                Measurement::Odometer(speed) => run.odometer(&speed),
                Measurement::Barometer(height) => run.barometer(&height),
            }
            if run.summary.diverged.is_some() {
                run.summary.implausible = run.plausible.findings();
                return Ok(run.summary);
            }
        }
        run.finish(&sample, observer)?;
        if run.summary.diverged.is_some() {
            run.summary.implausible = run.plausible.findings();
            return Ok(run.summary);
        }
    }
    run.summary.implausible = run.plausible.findings();
    if run.filter.is_none() && run.summary.restarts.is_empty() {
        let first_fix = first_fix.or_else(|| aiding.next_fix());
        return Err(ReplayError::NotAligned(Box::new(NotAligned {
            failure: run.aligner.failure(fixes_within),
            times: imu_start
                .zip(first_fix)
                .map(|(imu, gnss)| [imu, run.summary.ended, gnss]),
            implausible: run.summary.implausible,
            skipped: Vec::new(),
        })));
    }
    run.node(observer)?;
    if let Some(last) = run.last_fix {
        run.note_span_without_gnss(last, run.summary.ended);
    }
    run.streak.judge(&mut run.summary);
    run.receiver.close(&mut run.summary);
    run.summary.diverged = match run.summary.restarts.last() {
        Some(last) if run.filter.is_none() => Some(last.time),
        _ => None,
    };
    if let Some(filter) = &run.filter {
        run.summary.covariance = Some(CovarianceHealth::of(filter));
        for (kind, ..) in filter.parameters().blocks() {
            if let Some((value, std)) = filter.parameter(kind) {
                let n = kind.width();
                let (value, std) = (value[..n].to_vec(), std[..n].to_vec());
                run.summary.parameters.push((kind, value, std));
            }
        }
    }
    Ok(run.summary)
}
