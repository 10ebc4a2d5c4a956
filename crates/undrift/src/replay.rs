//! One log through the filter: samples and fixes merged in time, fixes withheld during outages.
//!
//! Streamed: nothing here grows with the log. A fix between two samples splits the interval at its
//! own time. An [`Observer`] is called at each sample and fix.

mod bridge;
mod course;
mod events;
mod fading;
mod gate;
mod health;
mod inertial;
mod measurement;
mod not_aligned;
mod observer;
mod plausible;
mod receiver;
mod rest;
mod run;
mod solution;
mod summary;
mod vehicle;
pub(crate) mod vibration;
mod watch;

pub use crate::{
    estimator::STAMP_ROUNDING,
    settings::{
        quality::QualityStd,
        replay::{Doubt, GnssUse, Outage, Settings},
    },
};
pub use events::{
    Contradiction, FixMend, HeadingOff, Implausible, Lean, Log, Part, Restart, RestartCause,
    SampleFault,
};
pub use health::CovarianceHealth;
pub(crate) use measurement::Repeats;
pub use measurement::{Measurement, Scalar, merge};
pub use not_aligned::NotAligned;
pub use observer::{Measurements, Observer, ReplayError, Samples};
pub use summary::{Innovations, MOST_EVENTS, Summary};
pub use vibration::Vibration;

use crate::estimator::Estimator;
use std::cell::RefCell;

/// Keeps the first filter that it sees.
struct First<'a>(&'a RefCell<Option<Box<dyn Estimator>>>);

impl Observer for First<'_> {
    fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
        self.0.borrow_mut().get_or_insert_with(|| filter.boxed());
        Ok(())
    }
}

/// The filter at the end of the sample in which the navigation of a log begins; `None` where it ended with that.
///
/// # Errors
/// As [`replay`].
pub(crate) fn begin(
    imu: &mut Samples,
    aiding: &mut Measurements,
    settings: &Settings,
) -> Result<Option<Box<dyn Estimator>>, ReplayError> {
    let begun = RefCell::new(None);
    let mut imu = imu.take_while(|_| begun.borrow().is_none());
    replay(&mut imu, aiding, settings, &mut First(&begun))?;
    Ok(begun.take())
}

/// Navigates a log. The size of the filter follows the models.
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
    let mut run = run::Run::new(settings);
    let mut aiding = measurement::Queue::new(aiding, settings.engine.receiver);
    for sample in imu {
        undrift_noise::interrupt::check();
        if let Some(checked) = run.check(sample?) {
            run.sample(checked, &mut aiding, observer)?;
        }
        if run.has_ended() {
            break;
        }
    }
    if let Some(checked) = run.check_last() {
        run.sample(checked, &mut aiding, observer)?;
    }
    run.end(&mut aiding, observer)
}

#[cfg(test)]
mod tests;
