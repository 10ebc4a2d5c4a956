//! What a call came to.

use undrift_nav::{
    filter::{FilterError, StepError},
    shaping::ShapingError,
};

/// What a call came to: 0 is success.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// A pointer is null that must not be.
    NullPointer = 1,
    /// The memory or array given is too small.
    TooSmall = 2,
    /// The memory does not start at a multiple of undrift_filter_align().
    Misaligned = 3,
    /// The filter was not initialised, or its initialisation failed.
    NotInitialised = 4,
    /// A number is not finite.
    NotFinite = 5,
    /// A number lies outside of what it can be.
    OutOfRange = 6,
    /// More states than the filter or an axis holds.
    TooManyStates = 7,
    /// The autoregressive part of a noise model is unstable: its roots must lie inside the unit circle,
    /// one may be 1.
    Unstable = 8,
    /// Noise models of different sample intervals.
    IntervalsDiffer = 9,
    /// The noise model does not exist at the sample interval asked for.
    NoModelAtRate = 10,
    /// The second moments of a noise model are no covariance.
    BadSensor = 11,
    /// The measurement's covariance is not symmetric or not positive definite.
    BadMeasurement = 12,
    /// The sample does not begin where the one before ended.
    Gap = 13,
    /// The solution left the possible range or is no number; the filter must be initialised again.
    Diverged = 14,
    /// The parameter is not estimated.
    NotEstimated = 15,
    /// No allocator was set for navigators.
    NoAllocator = 16,
    /// There are navigators whose memory is that of the allocator.
    InUse = 17,
    /// The navigator has no solution yet, or none at the moment.
    NotAligned = 18,
    /// The measurement came later than the horizon and is not used.
    TooLate = 19,
    /// No event is left.
    NoEvent = 20,
}

impl From<FilterError> for Status {
    fn from(error: FilterError) -> Self {
        match error {
            FilterError::TooManyStates { .. } => Self::TooManyStates,
            FilterError::BadMeasurement => Self::BadMeasurement,
            FilterError::Diverged => Self::Diverged,
            FilterError::Implausible => Self::OutOfRange,
        }
    }
}

impl From<StepError> for Status {
    fn from(error: StepError) -> Self {
        match error {
            StepError::Invalid { time, dt } if time.is_finite() && dt.is_finite() => {
                Self::OutOfRange
            }
            StepError::Invalid { .. } | StepError::NotFinite => Self::NotFinite,
            StepError::Gap { .. } => Self::Gap,
            StepError::OutOfRange => Self::OutOfRange,
            StepError::Diverged => Self::Diverged,
        }
    }
}

impl From<ShapingError> for Status {
    fn from(error: ShapingError) -> Self {
        match error {
            ShapingError::BadParameter(_) => Self::OutOfRange,
            ShapingError::TooManyStates { .. } => Self::TooManyStates,
            ShapingError::Unstable => Self::Unstable,
            ShapingError::IntervalsDiffer => Self::IntervalsDiffer,
            ShapingError::NoRealLogarithm | ShapingError::NoModelAtRate => Self::NoModelAtRate,
        }
    }
}

/// The status of what a call does.
pub(crate) fn call(work: impl FnOnce() -> Result<(), Status>) -> Status {
    work().err().unwrap_or(Status::Ok)
}

/// One line of English about a status, never null; it lives as long as the program.
#[unsafe(no_mangle)]
pub extern "C" fn undrift_error_text(status: i32) -> *const core::ffi::c_char {
    let text = match status {
        0 => c"done",
        1 => c"a pointer is null",
        2 => c"the memory or array is too small",
        3 => c"the memory is not aligned for the filter",
        4 => c"the filter is not initialised",
        5 => c"a number is not finite",
        6 => c"a number is out of range",
        7 => c"the noise models and parameters need more states than available",
        8 => {
            c"the noise model is unstable: its roots must lie inside the unit circle, one may be 1"
        }
        9 => c"noise models of different sample intervals",
        10 => c"the noise model does not exist at this sample interval",
        11 => c"the second moments of the noise model are not a covariance",
        12 => c"the measurement's covariance is not symmetric or not positive definite",
        13 => c"the sample does not start where the previous one ended",
        14 => c"the solution diverged: initialise the filter again",
        15 => c"the parameter is not estimated",
        16 => c"no allocator is set",
        17 => c"the allocator is in use: free the navigators first",
        18 => c"the navigator is not aligned",
        19 => c"the measurement came later than the horizon",
        20 => c"no event is left",
        _ => c"no such status",
    };
    text.as_ptr()
}
