//! One log through the navigator: samples and measurements read in order of time and pushed in.
//!
//! Streamed: nothing here grows with the log. An [`Observer`] is called at each sample and fix.

mod not_aligned;

pub use crate::settings::{Doubt, GnssUse, Outage, Settings, quality::QualityStd};
pub use not_aligned::NotAligned;
pub use undrift_engine::{
    Aid, ByAid, Contradiction, CovarianceHealth, Disagreement, FixMend, HeadingOff, Implausible,
    Innovations, LateSamples, Lean, Log, MOST_EVENTS, Measurement, Part, Restart, RestartCause,
    SampleFault, Scalar, SideSlip, Summary, Window, WindowPart, Windows,
    estimator::STAMP_ROUNDING,
    vibration::{self, Vibration},
};

use crate::estimator::{Adjoint, Estimator};
use std::cell::RefCell;
use undrift_engine::{EndError, Navigator, PushError, mounting::Mounting};
use undrift_io::ReadError;
use undrift_nav::{
    filter::{FilterError, Update},
    sample::{GnssFix, ImuSample},
};

/// Inertial samples in order of time, as a reader gives them.
pub type Samples<'a> = dyn Iterator<Item = Result<ImuSample, ReadError>> + 'a;
/// Measurements in order of time, as a reader gives them.
pub type Measurements<'a> = dyn Iterator<Item = Result<Measurement, ReadError>> + 'a;

/// The observer of [`undrift_engine::Observer`] with methods that may fail: the replay ends with the first error.
pub trait Observer {
    /// A sample was processed, and every fix up to its end; the filter is at the sample's end.
    ///
    /// # Errors
    /// Its own; the replay ends with it.
    fn sample(&mut self, _filter: &dyn Estimator) -> Result<(), ReplayError> {
        Ok(())
    }
    /// A fix was reached; the filter is at its time, before any update with it.
    fn fix(&mut self, _filter: &dyn Estimator, _fix: &GnssFix, _withheld: bool) {}
    /// A fix stamped `time` \[s\] went into the solution, or began it.
    fn used(&mut self, _time: f64) {}
    /// Whether position and velocity of the fix at this time \[s\] were used, down-weighted or
    /// rejected, where they were shown to the filter.
    fn updated(&mut self, _time: f64, _updates: [Option<Update>; 2]) {}
    /// A block of samples was judged to be rest or motion; the filter is at its end.
    fn judged(&mut self, _filter: &dyn Estimator, _rest: bool) {}
    /// The mounting was found, or found better: from the next sample on body axes are the vehicle's.
    fn mounted(&mut self, _mounting: &Mounting) {}
    /// A node of a smoother: the filter after all that happened up to now, and the adjoint of what
    /// happened since the node before; `None` at the first one.
    ///
    /// # Errors
    /// Its own; the replay ends with it.
    fn node(
        &mut self,
        _filter: &dyn Estimator,
        _since: Option<&Adjoint>,
    ) -> Result<(), ReplayError> {
        Ok(())
    }
}

/// Observes nothing.
impl Observer for () {}

/// An observer until it fails.
struct Watched<'a> {
    observer: &'a mut dyn Observer,
    failed: Option<ReplayError>,
}

impl Watched<'_> {
    fn done(&mut self) -> Result<(), ReplayError> {
        self.failed.take().map_or(Ok(()), Err)
    }
}

impl undrift_engine::Observer for Watched<'_> {
    fn sample(&mut self, filter: &dyn Estimator) {
        if self.failed.is_none() {
            self.failed = self.observer.sample(filter).err();
        }
    }

    fn fix(&mut self, filter: &dyn Estimator, fix: &GnssFix, withheld: bool) {
        self.observer.fix(filter, fix, withheld);
    }

    fn used(&mut self, time: f64) {
        self.observer.used(time);
    }

    fn updated(&mut self, time: f64, updates: [Option<Update>; 2]) {
        self.observer.updated(time, updates);
    }

    fn judged(&mut self, filter: &dyn Estimator, rest: bool) {
        self.observer.judged(filter, rest);
    }

    fn mounted(&mut self, mounting: &Mounting) {
        self.observer.mounted(mounting);
    }

    fn node(&mut self, filter: &dyn Estimator, since: Option<&Adjoint>) {
        if self.failed.is_none() {
            self.failed = self.observer.node(filter, since).err();
        }
    }
}

/// Why a replay stopped without a result.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// Reading the log failed.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Writing the result failed.
    #[error("cannot write the result: {0}")]
    Write(#[from] std::io::Error),
    /// No alignment before the log ended.
    #[error(transparent)]
    NotAligned(Box<NotAligned>),
    /// The filter cannot be built.
    #[error(transparent)]
    Filter(#[from] FilterError),
    /// A sample or measurement was refused.
    #[error(transparent)]
    Push(PushError),
}

impl From<PushError> for ReplayError {
    fn from(error: PushError) -> Self {
        match error {
            PushError::Filter(error) => Self::Filter(error),
            other => Self::Push(other),
        }
    }
}

/// Merges two streams, each in order of time; of one time the first comes first. Errors are passed on in place.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::{nav::{earth::Geodetic, sample::GnssFix}, replay::{Measurement, Scalar, merge}};
/// let speed = |time: f64| Ok::<_, ()>(Measurement::Odometer(Scalar { time, value: 5.0, std: 0.1 }));
/// let fix = |time: f64| Ok(Measurement::Gnss(GnssFix::at(time, Geodetic::from_degrees(47.0, 8.0, 400.0), [1.0; 3])));
/// let merged = merge([0.0, 1.0].map(speed).into_iter(), [0.5, 1.0].map(fix).into_iter());
/// let times: Vec<f64> = merged.map(|measurement| measurement.map_or(f64::NAN, |m| m.time())).collect();
/// assert_eq!(times, [0.0, 0.5, 1.0, 1.0]);
/// ```
pub fn merge<E>(
    first: impl Iterator<Item = Result<Measurement, E>>,
    second: impl Iterator<Item = Result<Measurement, E>>,
) -> impl Iterator<Item = Result<Measurement, E>> {
    let (mut first, mut second) = (first.peekable(), second.peekable());
    std::iter::from_fn(move || match (first.peek(), second.peek()) {
        (Some(Ok(a)), Some(Ok(b))) if b.time() < a.time() => second.next(),
        (None, Some(_)) | (Some(Ok(_)), Some(Err(_))) => second.next(),
        _ => first.next(),
    })
}

/// Keeps the first filter that it sees.
struct First<'a>(&'a RefCell<Option<Box<dyn Estimator>>>);

impl Observer for First<'_> {
    fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
        self.0.borrow_mut().get_or_insert_with(|| filter.boxed());
        Ok(())
    }
}

/// Navigates a log up to the end of the sample in which its navigation begins, and returns the filter; `None` where the log ended
/// before.
///
/// # Errors
/// As [`replay`].
pub fn begin(
    imu: &mut Samples,
    aiding: &mut Measurements,
    settings: &Settings,
) -> Result<Option<Box<dyn Estimator>>, ReplayError> {
    let begun = RefCell::new(None);
    let mut imu = imu.take_while(|_| begun.borrow().is_none());
    replay(&mut imu, aiding, settings, &mut First(&begun))?;
    Ok(begun.take())
}

/// Navigates a log: each sample is pushed after the measurements up to its end, each stream in order of time. The size of the
/// filter follows the models. [`crate::navigate::navigate`] is this with files, findings and a smoother.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::replay::{Measurement, Settings, replay};
/// # use undrift::nav::shaping::ShapingFilter;
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
/// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
/// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
/// let mut imu = log.imu.iter().map(|sample| Ok(*sample));
/// let mut fixes = log.gnss.iter().map(|fix| Ok(Measurement::Gnss(*fix)));
/// let summary = replay(&mut imu, &mut fixes, &Settings::new(sensors), &mut ())?;
/// assert!(summary.fixes > 50 && summary.diverged.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A log that cannot be read, no alignment before its end, a filter that cannot be built, or what `observer`
/// ends it with.
pub fn replay(
    imu: &mut Samples,
    aiding: &mut Measurements,
    settings: &Settings,
    observer: &mut dyn Observer,
) -> Result<Summary, ReplayError> {
    let mut navigator = Navigator::new(settings.clone());
    let mut observer = Watched {
        observer,
        failed: None,
    };
    let mut aiding = aiding.fuse().peekable();
    for sample in imu {
        undrift_base::interrupt::check();
        let sample = sample?;
        let until = sample.time + navigator.ahead() + STAMP_ROUNDING;
        let is_due = |m: &Result<Measurement, ReadError>| match m {
            Ok(m) => m.time() <= until,
            Err(_) => true,
        };
        while aiding.peek().is_some_and(is_due) {
            if let Some(measurement) = aiding.next() {
                navigator.measure(measurement?)?;
            }
        }
        navigator.imu_watched(sample, &mut observer)?;
        observer.done()?;
        if navigator.has_ended() {
            break;
        }
    }
    // Of a log that was never aligned, the stamps tell why.
    let later = aiding.filter_map(|m| match m {
        Ok(Measurement::Gnss(fix)) => Some(fix.time),
        _ => None,
    });
    let summary = navigator.end(later, &mut observer);
    observer.done()?;
    summary.map_err(|error| match error {
        EndError::NotAligned(why) => ReplayError::NotAligned(Box::new(NotAligned {
            why: *why,
            finds_mounting: settings.find_mounting,
            skipped: Vec::new(),
        })),
        EndError::Filter(error) => ReplayError::Filter(error),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn merged_in_time() {
        let at = |time| {
            Ok::<_, ()>(Measurement::Odometer(Scalar {
                time,
                value: 0.0,
                std: 1.0,
            }))
        };
        let times = |items: Vec<Result<Measurement, ()>>| -> Vec<f64> {
            items
                .into_iter()
                .map(|m| m.map_or(-1.0, |m| m.time()))
                .collect()
        };
        let both = merge(
            [1.0, 2.0, 5.0].map(at).into_iter(),
            [0.5, 2.0, 3.0, 7.0].map(at).into_iter(),
        );
        assert_eq!(times(both.collect()), [0.5, 1.0, 2.0, 2.0, 3.0, 5.0, 7.0]);
        let broken = merge(
            [at(1.0), Err(())].into_iter(),
            [at(0.0), at(4.0)].into_iter(),
        );
        assert_eq!(times(broken.collect()), [0.0, 1.0, -1.0, 4.0]);
    }

    /// Fails at a sample, counted from 1.
    struct Full {
        at: usize,
        samples: usize,
    }

    impl Observer for Full {
        fn sample(&mut self, _: &dyn Estimator) -> Result<(), ReplayError> {
            self.samples += 1;
            match self.samples == self.at {
                true => Err(std::io::Error::other("disk full").into()),
                false => Ok(()),
            }
        }
    }

    #[test]
    fn an_observer_that_fails_ends_the_replay_with_its_error() {
        use undrift_simulate::{GnssNoise, Trajectory, simulate};
        let model = undrift_noise::ImuModel::preset("mpu6050").unwrap();
        let shaping = model.shaping(undrift_noise::BiasModel::GaussMarkov, 0.02);
        let settings = Settings::new(shaping.unwrap());
        let car = Trajectory::car(150.0, 1);
        let log = simulate(&car, 50.0, None, &GnssNoise::default(), 1).unwrap();
        let run = |at: usize| {
            let mut observer = Full { at, samples: 0 };
            let mut imu = log.imu.iter().copied().map(Ok);
            let mut fixes = log.gnss.iter().copied().map(Measurement::Gnss).map(Ok);
            let ended = replay(&mut imu, &mut fixes, &settings, &mut observer);
            (ended, observer.samples, imu.len())
        };
        let (ended, all, left) = run(usize::MAX);
        assert!(ended.is_ok() && all > 10, "{all}: {ended:?}");
        assert_eq!(left, 0);
        for at in [1, all / 2, all] {
            let (ended, samples, left) = run(at);
            let message = ended.unwrap_err().to_string();
            assert_eq!(message, "cannot write the result: disk full");
            assert_eq!(samples, at);
            // A sample is taken when the one after it has come.
            assert!(left + 1 >= all - at, "{at}: {left} of {all}");
        }
    }
}
