//! One log through the filter: samples and fixes merged in time, fixes withheld during outages.
//!
//! Streamed: nothing here grows with the log. A fix between two samples splits the interval at its
//! own time. What happens at each sample and fix is told to an [`Observer`].

mod bridge;
mod gate;
mod measurement;
mod quality;
mod receiver;
mod rest;
mod summary;

pub use measurement::{Measurement, Scalar, merge};
pub use quality::QualityStd;
pub use summary::{
    Contradiction, Innovations, Lean, MOST_EVENTS, Part, Restart, SUSPECT_NIS, SUSPECT_UPDATES,
    Summary,
};

use crate::{
    align::{AlignSettings, Aligner, Heading},
    vehicle::Constraints,
};
use bridge::Bridge;
use measurement::Queue;
use receiver::Receiver;
use rest::RestDetector;
use summary::Streak;
use undrift_nav::{
    Matrix3, Vector3,
    covariance::{AXES, NAV},
    filter::{Filter, FilterError, Gate, Outcome},
    parameters::{Parameter, Parameters},
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
    fn sample<const N: usize>(&mut self, filter: &Filter<N>) -> Result<(), ReplayError>;
    /// A fix was reached; the filter stands at its time, before any update with it.
    fn fix<const N: usize>(&mut self, filter: &Filter<N>, fix: &GnssFix, withheld: bool);
    /// A block of samples was judged to be rest or motion; the filter stands at its end.
    fn judged<const N: usize>(&mut self, _filter: &Filter<N>, _rest: bool) {}
    /// A node of a smoother: the filter after all that happened up to now, and the adjoint of what
    /// happened since the node before; `None` at the first one.
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
    #[error("{0}")]
    NotAligned(String),
    /// The filter cannot be built.
    #[error(transparent)]
    Filter(#[from] FilterError),
}

/// A gap longer than this many sample intervals is not one late sample …
const GAP_INTERVALS: f64 = 1.5;
/// Constraints are left out where they contradict the solution far beyond both.
const CONSTRAINT_GATE: Gate = Gate {
    weaken: 9.0,
    reject: 100.0,
};
/// The speed of a fix holds for so long [s].
const SPEED_HOLDS: f64 = 1.5;
/// Why a solution is to begin anew.
const SICK: &str = "the innovations were far beyond their predicted size for half a minute";
const HOPELESS: &str = "it gave way to fixes again and again";
/// What a vehicle may do unseen in a long gap: acceleration [m/s²] and turn rate [rad/s], one sigma.
const GAP_ACCEL: f64 = 2.0;
const GAP_RATE: f64 = 0.2;

/// Navigates a log. The size of the filter follows the models.
pub fn replay(
    imu: impl Iterator<Item = Result<ImuSample, undrift_io::ReadError>>,
    aiding: impl Iterator<Item = Result<Measurement, undrift_io::ReadError>>,
    settings: &Settings,
    observer: &mut impl Observer,
) -> Result<Summary, ReplayError> {
    let sensors: usize = settings.sensors.iter().map(|f| f.order).sum();
    match NAV + sensors + settings.parameters.states() {
        ..=9 => run::<9>(imu, aiding, settings, observer),
        10..=15 => run::<15>(imu, aiding, settings, observer),
        16..=21 => run::<21>(imu, aiding, settings, observer),
        22..=27 => run::<27>(imu, aiding, settings, observer),
        28..=33 => run::<33>(imu, aiding, settings, observer),
        34..=45 => run::<45>(imu, aiding, settings, observer),
        _ => run::<73>(imu, aiding, settings, observer),
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
    for sample in imu {
        let sample = sample?;
        let start = sample.time - sample.dt;
        if imu_start.is_none() {
            imu_start = Some(sample.time);
            while let Some(before) = aiding.next_until(start - STAMP_ROUNDING, 0.0) {
                if let Measurement::Gnss(fix) = before? {
                    first_fix.get_or_insert(fix.time);
                    run.summary.fixes_before += 1;
                }
            }
        }
        run.begin(&sample);
        while let Some(measurement) =
            aiding.next_until(sample.time + STAMP_ROUNDING, run.fix_offset())
        {
            match measurement? {
                Measurement::Gnss(fix) => {
                    first_fix.get_or_insert(fix.time);
                    run.fix(&fix, &sample, observer)?;
                }
                Measurement::Odometer(speed) => run.odometer(&speed),
                Measurement::Barometer(height) => run.barometer(&height),
            }
            if run.summary.diverged.is_some() {
                return Ok(run.summary);
            }
        }
        run.finish(&sample, observer)?;
        if run.summary.diverged.is_some() {
            return Ok(run.summary);
        }
    }
    if run.filter.is_none() && run.summary.restarts.is_empty() {
        let mut why = run.aligner.why_not();
        let first_fix = first_fix.or_else(|| aiding.next_fix());
        if let (Some(imu), Some(gnss)) = (imu_start, first_fix) {
            let end = run.summary.ended;
            why += &format!(
                "; the samples run from {imu:.3} s to {end:.3} s, the fixes from {gnss:.3} s on"
            );
        }
        return Err(ReplayError::NotAligned(why));
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

/// The state of a replay between samples.
struct Run<'a, const N: usize> {
    filter: Option<Filter<N>>,
    aligner: Aligner,
    settings: &'a Settings,
    summary: Summary,
    last_fix: Option<f64>,
    /// Time of the last fix, and the least and greatest speed over ground that it leaves possible.
    last_speed: Option<(f64, (f64, f64))>,
    streak: Streak,
    /// Whether an alignment goes on beside the solution.
    anew: bool,
    previous: Option<ImuSample>,
    /// While a gap is being bridged.
    bridge: Option<Bridge>,
    receiver: Receiver,
    rest: RestDetector,
    last_constraint: f64,
    /// Since the last node, and its time.
    tape: Option<Box<Tape<N>>>,
    last_node: f64,
}

impl<'a, const N: usize> Run<'a, N> {
    fn new(settings: &'a Settings) -> Self {
        Self {
            filter: None,
            aligner: Aligner::new(settings),
            settings,
            summary: Summary::default(),
            last_fix: None,
            last_speed: None,
            streak: Streak::default(),
            anew: false,
            previous: None,
            bridge: None,
            receiver: Receiver::new(f64::NEG_INFINITY),
            rest: RestDetector::new(&settings.sensors),
            last_constraint: f64::NEG_INFINITY,
            tape: None,
            last_node: f64::NEG_INFINITY,
        }
    }

    /// By how much fixes hold later than their stamps, as estimated [s].
    fn fix_offset(&self) -> f64 {
        let filter = self.filter.as_ref();
        let offset = filter.and_then(|filter| filter.parameter(Parameter::TimeOffset));
        offset.map_or(0.0, |(value, _)| value[0])
    }

    /// The solution is none any more: it ends here, and another one begins as soon as it is aligned,
    /// without what was told of the start.
    fn give_up(&mut self, time: f64) {
        if !self.settings.gating {
            self.summary.diverged = Some(time);
            return;
        }
        self.begin_anew(
            time,
            "position, velocity or covariance left the possible range",
        );
        self.filter = None;
    }

    /// Aligns anew beside a solution that does not agree with the fixes; it goes on until that is done.
    fn begin_anew(&mut self, time: f64, why: &str) {
        if self.anew {
            return;
        }
        self.anew = true;
        self.summary.restarts.push(Restart {
            time,
            why: why.into(),
            resumed: None,
        });
        let mut settings = self.settings.clone();
        settings.align.attitude = None;
        settings.align.velocity = None;
        if let Heading::Given(..) = settings.align.heading {
            settings.align.heading = Heading::Auto;
        }
        self.aligner = Aligner::new(&settings);
    }

    /// Tells the observer of a node, if there is a smoother.
    fn node(&mut self, observer: &mut impl Observer) -> Result<(), ReplayError> {
        if let (Some(_), Some(filter)) = (self.settings.nodes, &self.filter) {
            observer.node(filter, self.tape.as_deref())?;
            self.tape = Some(Box::default());
            self.last_node = filter.nav().time;
        }
        Ok(())
    }

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
                filter.advance_recorded(1.0, self.tape.as_deref_mut());
                filter.begin(&next);
            }
        }
        filter.advance_to_recorded(time, STAMP_ROUNDING, self.tape.as_deref_mut());
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

    /// Shows the aligner a fix; whether it completes the alignment and navigation begins.
    fn align(
        &mut self,
        fix: &GnssFix,
        sample: &ImuSample,
        observer: &mut impl Observer,
    ) -> Result<bool, ReplayError> {
        self.aligner.advance(sample, fix.time);
        if self.settings.gating && !self.receiver.is_consistent(fix) {
            return Ok(false);
        }
        let fix = &match self.settings.gnss_use {
            GnssUse::Position => GnssFix {
                velocity: None,
                ..*fix
            },
            _ => *fix,
        };
        let Some(aligned) = self.aligner.fix::<N>(fix, self.settings)? else {
            return Ok(false);
        };
        match self.summary.restarts.last_mut() {
            Some(restart) => restart.resumed = Some(fix.time),
            None => {
                self.summary.started = Some(fix.time);
                self.summary.alignment = aligned.how;
            }
        }
        self.anew = false;
        self.last_fix = Some(fix.time);
        let mut filter = aligned.filter;
        if let (Some(start), true) = (&self.settings.start, self.summary.restarts.is_empty()) {
            filter.take_out(&nalgebra::SVector::from_fn(|i, _| {
                start.get(i).copied().unwrap_or(0.0)
            }));
        }
        self.filter = Some(filter);
        self.tape = None;
        self.bridge = None;
        self.streak = Streak::default();
        self.receiver.forget_solution(fix.time, &mut self.summary);
        self.node(observer)?;
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
        Ok(true)
    }

    /// A fix within the present sample.
    fn fix(
        &mut self,
        fix: &GnssFix,
        sample: &ImuSample,
        observer: &mut impl Observer,
    ) -> Result<(), ReplayError> {
        let withheld = self.settings.outages.iter().any(|o| o.contains(fix.time));
        let fix = &self.settings.quality.apply(fix);
        if self.filter.is_none() && withheld {
            self.summary.withheld += 1;
            return Ok(());
        }
        if (self.filter.is_none() || self.anew) && !withheld {
            if self.align(fix, sample, observer)? {
                return Ok(());
            }
            if self.filter.is_none() {
                self.summary.fixes_before += 1;
                return Ok(());
            }
        }
        let due = fix.time + self.fix_offset();
        self.advance_to(due);
        if !withheld {
            self.grow_to(due);
        }
        let Some(filter) = &mut self.filter else {
            return Ok(());
        };
        observer.fix(filter, fix, withheld);
        if withheld {
            self.summary.withheld += 1;
            // An outage is no fault of the receiver's.
            self.last_fix = Some(fix.time);
            return self.node(observer);
        }
        let updates = self.receiver.update(
            filter,
            fix,
            due,
            self.settings,
            self.tape.as_deref_mut(),
            &mut self.summary,
        );
        if let Some((v_n, covariance)) = &fix.velocity {
            let error = covariance.fixed_view::<2, 2>(0, 0).trace().sqrt();
            let speed = v_n.xy().norm();
            self.last_speed = Some((fix.time, ((speed - error).max(0.0), speed + error)));
            if let Some((std, min_speed)) = self.settings.constraints.course
                && v_n.xy().norm() > min_speed
                && let Some(observed) = filter.observe_course(v_n.y.atan2(v_n.x))
            {
                let noise = 0.5 * error * error / v_n.xy().norm_squared() + std * std;
                let _ = filter.update_recorded(
                    &observed,
                    &nalgebra::Matrix1::new(noise),
                    &CONSTRAINT_GATE,
                    self.tape.as_deref_mut(),
                );
            }
        }
        let diverged = filter.check().is_err();
        let mut used = false;
        for update in updates.into_iter().flatten() {
            match update {
                Ok(update) if update.outcome == Outcome::Rejected => {}
                Ok(update) => {
                    used = true;
                    self.streak.watch(update, fix.time, &mut self.summary);
                }
                Err(_) => self.summary.bad_fixes += 1,
            }
        }
        if used {
            self.summary.fixes += 1;
            if let Some(last) = self.last_fix.replace(fix.time) {
                self.note_span_without_gnss(last, fix.time);
            }
        }
        if diverged {
            self.give_up(fix.time);
        } else if self.settings.gating && self.settings.restart {
            if self.streak.is_sick(fix.time) {
                self.begin_anew(fix.time, SICK);
            } else if self.receiver.is_hopeless(fix.time) {
                self.begin_anew(fix.time, HOPELESS);
            }
        }
        self.node(observer)
    }

    /// Whether the present sample ends a gap too long to say how the vehicle moved in it.
    fn in_long_gap(&self) -> bool {
        let bridge = self.bridge.as_ref();
        bridge.is_some_and(|bridge| bridge.unknown_since.is_some())
    }

    /// A wheel speed within the present sample; none in a long gap, where the attitude is not known.
    fn odometer(&mut self, speed: &Scalar) {
        let unknown = self.in_long_gap();
        self.advance_to(speed.time);
        let Some(filter) = self.filter.as_mut().filter(|_| !unknown) else {
            return;
        };
        let observed =
            filter.observe_odometer(speed.value, &self.settings.constraints.odometer_lever);
        let variance = nalgebra::Matrix1::new(speed.std * speed.std);
        let tape = self.tape.as_deref_mut();
        if let Ok(update) = filter.update_recorded(&observed, &variance, &CONSTRAINT_GATE, tape) {
            self.summary.odometer.add(update);
        }
    }

    /// A barometric height within the present sample, as a wheel speed.
    fn barometer(&mut self, height: &Scalar) {
        let unknown = self.in_long_gap();
        self.advance_to(height.time);
        let Some(filter) = self.filter.as_mut().filter(|_| !unknown) else {
            return;
        };
        let observed = filter.observe_barometer(height.value);
        let variance = nalgebra::Matrix1::new(height.std * height.std);
        let tape = self.tape.as_deref_mut();
        if let Ok(update) = filter.update_recorded(&observed, &variance, &CONSTRAINT_GATE, tape) {
            self.summary.barometer.add(update);
        }
    }

    /// What the vehicle cannot do, at the end of a sample.
    fn constrain(&mut self, sample: &ImuSample, observer: &mut impl Observer) {
        let Some(filter) = &mut self.filter else {
            return;
        };
        let constraints = &self.settings.constraints;
        if constraints.zero_velocity.is_some() || constraints.zero_angular_rate.is_some() {
            let error = filter.sensor_error();
            let [gyro, accel] = [0, 3].map(|i| Vector3::new(error[i], error[i + 1], error[i + 2]));
            let place = &filter.nav().position;
            let earth_rate = undrift_nav::earth::earth_rate_n(place.lat);
            let up = -undrift_nav::earth::gravity(place.lat, place.height) * Vector3::z();
            let to_body = |v_n: &Vector3| filter.c_nb().tr_mul(v_n);
            let expected = (gyro + to_body(&earth_rate), accel + to_body(&up));
            let speed = self
                .last_speed
                .filter(|(time, _)| {
                    sample.time - time < SPEED_HOLDS && self.last_fix == Some(*time)
                })
                .map(|(_, speed)| speed);
            if let Some(block) = self.rest.add(sample, &expected, speed) {
                let mut rest = block.rest;
                if let Some(std) = constraints.zero_velocity.filter(|_| rest) {
                    let observed = filter.observe_zero_velocity();
                    let r = Matrix3::identity() * (std * std);
                    let tape = self.tape.as_deref_mut();
                    if let Ok(done) = filter.update_recorded(&observed, &r, &CONSTRAINT_GATE, tape)
                    {
                        // A solution that is sure to move is believed.
                        rest = done.outcome != Outcome::Rejected;
                        self.summary.zero_velocity.add(done);
                    }
                }
                if let Some(std) = constraints.zero_angular_rate.filter(|_| rest) {
                    let observed = filter.observe_earth_rate(&block.rate);
                    let noise = Vector3::from_fn(|i, _| {
                        let axis = &self.settings.sensors[i];
                        axis.r * axis.interval / block.duration + std * std
                    });
                    let r = Matrix3::from_diagonal(&noise);
                    let tape = self.tape.as_deref_mut();
                    let _ = filter.update_recorded(&observed, &r, &CONSTRAINT_GATE, tape);
                }
                observer.judged(filter, rest);
            }
        }
        if let Some(rule) = &constraints.non_holonomic
            && sample.time - self.last_constraint >= rule.interval - 0.5 * sample.dt
            && filter.vehicle_velocity(&rule.lever).x.abs() > rule.min_speed
        {
            self.last_constraint = sample.time;
            let observed = filter.observe_non_holonomic(&rule.lever);
            let lateral = (filter.vehicle_velocity(&rule.lever).x * filter.omega_nb_b().z).abs();
            let right = rule.right + rule.slip * lateral;
            let r = nalgebra::Matrix2::new(right * right, 0.0, 0.0, rule.down * rule.down);
            let tape = self.tape.as_deref_mut();
            if let Ok(done) = filter.update_recorded(&observed, &r, &CONSTRAINT_GATE, tape) {
                self.summary.non_holonomic.add(done);
            }
        }
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
        self.constrain(sample, observer);
        if self.filter.is_none() || self.anew {
            self.aligner.advance(sample, sample.time);
        }
        let Some(filter) = &self.filter else {
            self.summary.align_samples += 1;
            return Ok(());
        };
        if filter.check().is_err() {
            self.give_up(sample.time);
            return Ok(());
        }
        self.summary.samples += 1;
        observer.sample(filter)?;
        if let Some(span) = self.settings.nodes
            && sample.time - self.last_node >= span - STAMP_ROUNDING
        {
            self.node(observer)?;
        }
        Ok(())
    }

    fn note_span_without_gnss(&mut self, from: f64, to: f64) {
        if to - from > self.summary.longest_without_gnss.1 {
            self.summary.longest_without_gnss = (from, to - from);
        }
    }
}
