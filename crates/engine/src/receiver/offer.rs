//! A fix, or a part of it, as it is handed to the filter.

use crate::estimator::Aiding;
use undrift_events::Part;
use undrift_nav::{Matrix3, aiding::Stretch};

/// When a fix holds, and of what.
pub(crate) struct Held {
    /// The part of it, where it is not all.
    pub(crate) part: Option<Part>,
    /// Time \[s\].
    pub(crate) due: f64,
    /// The motion over its mean velocity's time, where that is known.
    pub(crate) stretch: Option<Stretch>,
    /// Whether the solution has begun so lately that a pose contradicts it by the solution's fault.
    pub(crate) settling: bool,
}

/// A part of a fix, and how it is to be judged.
///
/// Lives for one update; what differs between position and velocity is in it.
pub(super) struct Offer {
    /// The measurement with its lever arm and due time.
    pub(super) aiding: Aiding,
    /// Covariance as the fix states it.
    pub(super) stated: Matrix3,
    /// Stamp of the fix \[s\].
    pub(super) time: f64,
    /// Whether it passes in any case.
    pub(super) open: bool,
    /// Whether it is used with less weight where it would be rejected.
    pub(super) settling: bool,
    /// Whether the receiver repeats itself.
    pub(super) frozen: bool,
    /// Time that fixes which agree with each other are rejected \[s\].
    pub(super) patience: f64,
    /// Whether a contradiction counts as an error of the velocity, too.
    pub(super) speed_doubted: bool,
    /// Whether it may drift slowly to one side, as a receiver's positions do.
    pub(super) leans: bool,
}
