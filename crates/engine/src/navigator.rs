//! The navigator as its user sees it, and how a measurement that comes late finds its place.

use crate::{
    aid::Measurement,
    estimator::Estimator,
    measurement::Measured,
    not_aligned::NotAligned,
    observer::Observer,
    run::Run,
    settings::Settings,
    summary::{MOST_EVENTS, Summary},
};
use alloc::{boxed::Box, collections::VecDeque, vec::Vec};
use undrift_events::{Event, ScalarLog};
use undrift_nav::{
    filter::FilterError,
    parameters::Parameter,
    sample::{GnssFix, ImuSample, MagneticField, Scalar},
};

/// Time between two snapshots \[s\]: a late measurement runs at most this much more again than it is late by.
const SNAPSHOT_SPAN: f64 = 0.2;

/// Why a sample or a measurement was refused. Nothing of it is used, and the navigator may be pushed the next one, but after
/// [`PushError::Filter`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PushError {
    /// A time or a value is not finite, or the sample's length is not positive.
    #[error("the {what} at {time} s has a value that is not finite, or no length")]
    NotFinite {
        /// Sample, fix, wheel speed, height, heading or magnetic field.
        what: &'static str,
        /// Its stamp \[s\].
        time: f64,
    },
    /// A sample does not follow the one before.
    #[error("the sample at {time} s does not follow the one at {before} s")]
    NotInOrder {
        /// Its stamp \[s\].
        time: f64,
        /// Stamp of the sample before it \[s\].
        before: f64,
    },
    /// The alignment is complete and no filter of the settings can be built: more states than there are sizes for. Every
    /// later sample ends so, too.
    #[error(transparent)]
    Filter(#[from] FilterError),
}

/// Why [`Navigator::end`] has no summary.
#[derive(Clone, Debug, thiserror::Error)]
pub enum EndError {
    /// There never was a solution; what is known of the reason is inside.
    #[error("no alignment before the samples ended: {}", .0.failure)]
    NotAligned(Box<NotAligned>),
    /// The filter cannot be built.
    #[error(transparent)]
    Filter(#[from] FilterError),
}

/// The whole state before a sample, to continue from when a measurement comes late.
pub(crate) struct Snapshot {
    pub(crate) run: Run,
    /// The number of the first sample behind it.
    pub(crate) next: u64,
    /// End of the sample before it \[s\].
    pub(crate) time: f64,
}

/// Samples and measurements in, a solution out.
///
/// In real time, with fixes that come late and events as they happen:
///
/// ```
/// use undrift_engine::{Navigator, settings::Settings};
/// # use undrift_nav::shaping::ShapingFilter;
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
/// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
/// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
/// # let mut fixes = log.gnss.iter().peekable();
///
/// // `sensors`: the noise models of gyro x, y, z and accelerometer x, y, z at the interval of the samples.
/// let mut navigator = Navigator::new(Settings::new(sensors)).with_horizon(0.5);
/// for sample in log.imu {
///     navigator.imu(sample)?;
///     // A fix of 0.2 s ago counts from when it holds: the solution is as if it had come in time.
///     while let Some(fix) = fixes.next_if(|fix| fix.time + 0.2 <= sample.time) {
///         assert!(navigator.fix(*fix)?, "within the horizon");
///     }
///     for event in navigator.events() {
///         println!("{event:?}");
///     }
/// }
/// assert!(navigator.filter().is_some_and(|filter| filter.nav_std()[0] < 5.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Navigator {
    pub(crate) run: Run,
    pub(crate) measured: Measured,
    /// How far from the IMU's time base a fix may be stamped late \[s\]: see [`Navigator::ahead`].
    ahead: f64,
    /// Longest delay with which a measurement is accepted \[s\].
    pub(crate) horizon: f64,
    /// Samples within the horizon, and how many went before them.
    pub(crate) samples: VecDeque<ImuSample>,
    pub(crate) gone: u64,
    pub(crate) past: VecDeque<Snapshot>,
    /// End of the last sample \[s\].
    pub(crate) last: Option<f64>,
    pub(crate) too_late: u64,
    /// Those, until they are handed out as events.
    pub(crate) rejected: Vec<Event>,
    /// Events that were handed out.
    pub(crate) handed_out: Vec<Event>,
}

impl Navigator {
    /// A navigator without data; late measurements are rejected ([`Navigator::with_horizon`]). Nothing is checked here: settings that
    /// cannot be used show when the alignment is complete.
    pub fn new(settings: Settings) -> Self {
        let most = crate::solution::MOST_LATE;
        let offset = |kind| {
            let prior = settings.parameters.prior(kind);
            prior.map_or(0.0, |prior| most * prior.std)
        };
        let ahead = offset(Parameter::TimeOffset).max(offset(Parameter::VelocityTimeOffset));
        Self {
            run: Run::new(settings),
            measured: Measured::default(),
            ahead,
            horizon: 0.0,
            samples: VecDeque::new(),
            gone: 0,
            past: VecDeque::new(),
            last: None,
            too_late: 0,
            rejected: Vec::new(),
            handed_out: Vec::new(),
        }
    }

    /// Accepts measurements that come up to `horizon` \[s\] late as if they had come in time: what was done since is done
    /// again. Memory: a snapshot of 15 to 60 kB for each fifth of a second. Time: the steps since the measurement's own time,
    /// once more for each late one. The default is 0; so is a horizon that is negative or not a number.
    pub fn with_horizon(mut self, horizon: f64) -> Self {
        self.horizon = if horizon > 0.0 { horizon } else { 0.0 };
        self
    }

    /// Time beyond a sample's end that fixes which hold within it may be stamped \[s\]: with an estimated latency a stamp may
    /// be late by up to this. From a log, push fixes that are stamped up to this much later before the sample. Ten prior
    /// standard deviations of the time offset; 0 where none is estimated.
    ///
    /// ```
    /// use undrift_engine::{Navigator, settings::Settings};
    /// use undrift_nav::{parameters::{Parameter, Parameters, Prior}, shaping::ShapingFilter};
    /// let settings = Settings {
    ///     parameters: Parameters::none().with(Parameter::TimeOffset, Prior::constant(0.05)), // [s]
    ///     ..Settings::new([ShapingFilter::white(1e-3, 0.01)?; 6])
    /// };
    /// // From a log, push the fixes stamped up to half a second after a sample before that sample.
    /// assert_eq!(Navigator::new(settings).ahead(), 0.5);
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub fn ahead(&self) -> f64 {
        self.ahead
    }

    /// Pushes a sample: increments in body axes over the `dt` up to its time, in order of time. The solution goes to the end
    /// of the sample before this one, since only the next sample shows whether one can be right; [`Navigator::end`] processes the
    /// last one. Gaps are bridged or widen the covariance; more than a minute without samples starts a new alignment.
    ///
    /// # Errors
    /// [`PushError::NotFinite`] and [`PushError::NotInOrder`], of which nothing is taken in; [`PushError::Filter`] where the
    /// alignment is complete and its filter cannot be built.
    pub fn imu(&mut self, sample: ImuSample) -> Result<(), PushError> {
        self.imu_watched(sample, &mut ())
    }

    /// Does [`Navigator::imu`] with an observer that is called at each sample and fix on the way.
    ///
    /// # Errors
    /// As [`Navigator::imu`].
    pub fn imu_watched(
        &mut self,
        sample: ImuSample,
        observer: &mut dyn Observer,
    ) -> Result<(), PushError> {
        let values = sample.dtheta.iter().chain(sample.dvel.iter());
        let time = sample.time;
        let mut numbers = [time, sample.dt].into_iter().chain(values.copied());
        if !numbers.all(f64::is_finite) || sample.dt <= 0.0 {
            let what = "sample";
            return Err(PushError::NotFinite { what, time });
        }
        if let Some(before) = self.last.filter(|before| time <= *before) {
            return Err(PushError::NotInOrder { time, before });
        }
        if self.horizon > 0.0 {
            self.keep(sample);
        }
        self.last = Some(time);
        self.step(sample, observer)?;
        if self.horizon == 0.0 {
            self.measured.forget(self.run.taken());
        }
        Ok(())
    }

    /// Pushes a fix of the antenna, stamped in the time base of the samples. It is used when the samples reach its time, so it
    /// may be pushed early. Returns whether it came within the horizon; later ones are counted and rejected. Whether a fix
    /// passes the gate shows in [`Navigator::events`] and [`Summary::innovations`], not here.
    ///
    /// # Errors
    /// [`PushError::NotFinite`], of which nothing is taken in; [`PushError::Filter`] where a late fix completes the alignment and
    /// the filter cannot be built.
    pub fn fix(&mut self, fix: GnssFix) -> Result<bool, PushError> {
        self.measure(Measurement::Gnss(fix))
    }

    /// Pushes what a sensor measures that gives one number, in the same way as [`Navigator::fix`]. What it is, in which unit and
    /// with which sign: [`Measurement`].
    ///
    /// # Errors
    /// As [`Navigator::fix`].
    ///
    /// ```
    /// use undrift_engine::{Aid, Navigator, Scalar, ScalarLog, settings::Settings, vehicle::Profile};
    /// # use undrift_nav::shaping::ShapingFilter;
    /// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
    /// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
    /// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
    /// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
    /// let mut navigator = Navigator::new(Settings { constraints: Profile::Car.constraints(), ..Settings::new(sensors) });
    /// for fix in &log.gnss {
    ///     navigator.fix(*fix)?;
    /// }
    /// // `log.truth` has the speed that a wheel would read, ten times a second.
    /// for row in log.truth.iter().step_by(5) {
    ///     let value = row.v_n.expect("simulated").norm();
    ///     navigator.scalar(ScalarLog::Odometer, Scalar { time: row.time, value, std: 0.1 })?;
    /// }
    /// for sample in &log.imu {
    ///     navigator.imu(*sample)?;
    /// }
    /// assert!(navigator.summary().innovations[Aid::Odometer].updates > 100);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn scalar(&mut self, sensor: ScalarLog, measured: Scalar) -> Result<bool, PushError> {
        self.measure(Measurement::of(sensor, measured))
    }

    /// Pushes a magnetic field in body axes \[T\], in the same way as [`Navigator::fix`]. Its hard iron is [`Parameter::HardIron`] among the
    /// settings' parameters, all else that is known of it [`Settings::magnetometer`]. At rest it gives the first heading.
    ///
    /// # Errors
    /// As [`Navigator::fix`].
    pub fn magnetometer(&mut self, reading: MagneticField) -> Result<bool, PushError> {
        self.measure(Measurement::Magnetometer(reading))
    }

    /// Pushes a measurement of any kind, in the same way as [`Navigator::fix`].
    ///
    /// # Errors
    /// As [`Navigator::fix`].
    pub fn measure(&mut self, measurement: Measurement) -> Result<bool, PushError> {
        let time = measurement.time();
        if let Some(what) = measurement.unusable() {
            return Err(PushError::NotFinite { what, time });
        }
        // Without a horizon a fix that was looked for too early counts as soon as it is there.
        let passed = match self.horizon > 0.0 {
            true => self.run.asked(),
            false => self.run.reached(),
        };
        if time > passed {
            self.measured.insert(measurement);
            return Ok(true);
        }
        let since = self
            .past
            .iter()
            .rposition(|snapshot| snapshot.run.asked() < time);
        let Some(since) = since else {
            self.too_late += 1;
            if self.rejected.len() < MOST_EVENTS {
                self.rejected.push(Event::TooLate(time));
            }
            return Ok(false);
        };
        self.measured.insert(measurement);
        self.again(since)?;
        Ok(true)
    }

    /// The filter, once there is a solution: state, standard deviations and estimated sensor errors at the end of the sample
    /// before the last one pushed. `None` before the alignment and between a restart and the next alignment.
    pub fn filter(&self) -> Option<&dyn Estimator> {
        self.run.filter()
    }

    /// Counts, statistics and events so far; what only the end shows is not in it yet.
    ///
    /// ```
    /// use undrift_engine::{Aid, Navigator, settings::Settings};
    /// # use undrift_nav::shaping::ShapingFilter;
    /// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
    /// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
    /// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
    /// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
    /// let mut navigator = Navigator::new(Settings::new(sensors));
    /// for fix in &log.gnss {
    ///     navigator.fix(*fix)?;
    /// }
    /// for sample in &log.imu {
    ///     navigator.imu(*sample)?;
    /// }
    /// let summary = navigator.summary();
    /// assert!(summary.started.is_some() && summary.diverged.is_none());
    /// let positions = summary.innovations[Aid::Position];
    /// // About 1 where the stated standard deviations are right.
    /// let nis = positions.per_dof().expect("some were used");
    /// assert!((0.7..1.3).contains(&nis) && positions.rejected == 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn summary(&self) -> &Summary {
        self.run.summary()
    }

    /// The events since the last call, in order of time. A late measurement may undo or change earlier ones: new events are
    /// handed out, none is retracted.
    ///
    /// Fixes that are suddenly 100 m off are rejected, and the solution does not follow them:
    ///
    /// ```
    /// use undrift_engine::{Event, Navigator, Part, settings::Settings};
    /// use undrift_nav::sample::Position;
    /// # use undrift_nav::shaping::ShapingFilter;
    /// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
    /// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
    /// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
    /// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
    /// let mut navigator = Navigator::new(Settings::new(sensors));
    /// for mut fix in log.gnss {
    ///     if let Some((Position::Geodetic(place), _)) = &mut fix.position
    ///         && (90.0..95.0).contains(&fix.time)
    ///     {
    ///         place.lat += 100.0 / 6.37e6; // North.
    ///     }
    ///     navigator.fix(fix)?;
    /// }
    /// for sample in log.imu {
    ///     navigator.imu(sample)?;
    /// }
    /// let rejected = navigator.events().into_iter().find_map(|event| match event {
    ///     Event::Rejected(run) if run.part == Part::Position => Some(run),
    ///     _ => None,
    /// });
    /// let rejected = rejected.expect("the gate");
    /// assert_eq!((rejected.start, rejected.fixes, rejected.accepted_in_the_end), (90.0, 5, false));
    /// assert!((rejected.first - 100.0).abs() < 2.0, "its distance from the solution [m]");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn events(&mut self) -> Vec<Event> {
        let before = &self.handed_out;
        let is_new = |event: &Event| !before.iter().any(|before| before.is_same(event));
        let mut new: Vec<Event> = self.run.summary().events().filter(is_new).collect();
        self.handed_out.extend_from_slice(&new);
        new.append(&mut self.rejected);
        new.sort_by(|a, b| a.time().total_cmp(&b.time()));
        new
    }

    /// Number of measurements that came too late for the horizon.
    pub fn too_late(&self) -> u64 {
        self.too_late
    }

    /// Whether the solution diverged and no other is to begin ([`Settings::gating`] is off): samples are then ignored.
    pub fn has_ended(&self) -> bool {
        self.run.has_ended()
    }

    /// Ends the run: processes the last sample and returns the summary. `later` are stamps \[s\] of fixes that were not pushed:
    /// where there was no alignment, they show whether the two clocks overlap at all.
    ///
    /// # Errors
    /// [`EndError::NotAligned`] with what was missing; [`EndError::Filter`].
    ///
    /// ```
    /// use undrift_engine::{Navigator, settings::Settings};
    /// # use undrift_nav::shaping::ShapingFilter;
    /// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
    /// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
    /// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
    /// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
    /// let mut navigator = Navigator::new(Settings::new(sensors));
    /// for fix in &log.gnss {
    ///     navigator.fix(*fix)?;
    /// }
    /// for sample in &log.imu {
    ///     navigator.imu(*sample)?;
    /// }
    /// // All fixes were pushed, and nobody observes the last sample.
    /// let summary = navigator.end(std::iter::empty(), &mut ())?;
    /// assert!(summary.restarts.is_empty() && summary.sample_faults.is_empty());
    /// assert!(summary.covariance.is_some_and(|health| health.least_eigenvalue > 0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn end(
        mut self,
        later: impl Iterator<Item = f64>,
        observer: &mut dyn Observer,
    ) -> Result<Summary, EndError> {
        if let Some(checked) = self.run.check_last() {
            self.run.sample(checked, &self.measured, observer)?;
        }
        let left = self.measured.fixes_from(self.run.taken());
        let ended = self.run.end(left.chain(later), observer);
        ended.map_err(EndError::NotAligned)
    }

    /// Processes a sample that is the next in order.
    fn step(&mut self, sample: ImuSample, observer: &mut dyn Observer) -> Result<(), FilterError> {
        if self.run.has_ended() {
            return Ok(());
        }
        match self.run.check(sample) {
            Some(checked) => self.run.sample(checked, &self.measured, observer),
            None => Ok(()),
        }
    }

    /// Keeps a sample, and the state before it where that is due; drops what is beyond the horizon.
    fn keep(&mut self, sample: ImuSample) {
        self.snapshot_before(&sample, self.gone + self.samples.len() as u64);
        self.samples.push_back(sample);
        // The last snapshot that is older than the horizon stays: from it what is just within can be done again.
        while self.past.len() > 1 && self.past[1].time < sample.time - self.horizon {
            self.past.pop_front();
        }
        if let Some(oldest) = self.past.front() {
            self.measured.forget(oldest.run.taken());
            while self.gone < oldest.next {
                self.samples.pop_front();
                self.gone += 1;
            }
        }
    }

    /// Keeps the state before the sample of this number, where the last snapshot is old enough.
    fn snapshot_before(&mut self, sample: &ImuSample, next: u64) {
        let time = sample.time - sample.dt;
        let newest = self.past.back();
        if newest.is_none_or(|newest| time - newest.time >= SNAPSHOT_SPAN) {
            let run = self.run.clone();
            self.past.push_back(Snapshot { run, next, time });
        }
    }

    /// Repeats what was done since the snapshot of this index.
    pub(crate) fn again(&mut self, since: usize) -> Result<(), FilterError> {
        self.past.truncate(since + 1);
        let Some(snapshot) = self.past.back() else {
            return Ok(());
        };
        self.run = snapshot.run.clone();
        let from = (snapshot.next - self.gone) as usize;
        for at in from..self.samples.len() {
            let sample = self.samples[at];
            self.snapshot_before(&sample, self.gone + at as u64);
            self.step(sample, &mut ())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
