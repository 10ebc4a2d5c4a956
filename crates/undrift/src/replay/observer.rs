//! Who watches a replay, and why one stops.

use super::{measurement::Measurement, not_aligned::NotAligned};
use crate::estimator::{Adjoint, Estimator};
use undrift_io::ReadError;
use undrift_nav::{
    filter::{FilterError, Update},
    sample::{GnssFix, ImuSample},
};

/// Inertial samples in order of time.
pub type Samples<'a> = dyn Iterator<Item = Result<ImuSample, ReadError>> + 'a;
/// Measurements in order of time.
pub type Measurements<'a> = dyn Iterator<Item = Result<Measurement, ReadError>> + 'a;

/// Called with everything that happens, in order of time; what is not implemented is not looked at.
pub trait Observer {
    /// A sample was processed, and every fix up to its end; the filter stands at the sample's end.
    ///
    /// # Errors
    /// Its own; the replay ends with it.
    fn sample(&mut self, _filter: &dyn Estimator) -> Result<(), ReplayError> {
        Ok(())
    }
    /// A fix was reached; the filter stands at its time, before any update with it.
    fn fix(&mut self, _filter: &dyn Estimator, _fix: &GnssFix, _withheld: bool) {}
    /// A fix at `time` \[s\] went into the solution, or began it.
    fn used(&mut self, _time: f64) {}
    /// What became of the position and the velocity of the fix of this time \[s\], where they were
    /// shown to the filter.
    fn updated(&mut self, _time: f64, _updates: [Option<Update>; 2]) {}
    /// A block of samples was judged to be rest or motion; the filter stands at its end.
    fn judged(&mut self, _filter: &dyn Estimator, _rest: bool) {}
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

/// Watches nothing.
impl Observer for () {}

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
}
