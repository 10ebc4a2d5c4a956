//! Who watches the navigator.

use crate::estimator::{Adjoint, Estimator};
use crate::mounting::Mounting;
use undrift_nav::{filter::Update, sample::GnssFix};

/// Called with everything that happens, in order of time; what is not implemented is not looked at.
pub trait Observer {
    /// A sample was processed, and every fix up to its end; the filter is at the sample's end.
    fn sample(&mut self, _filter: &dyn Estimator) {}
    /// A fix was reached; the filter is at its time, before any update with it.
    fn fix(&mut self, _filter: &dyn Estimator, _fix: &GnssFix, _withheld: bool) {}
    /// A fix at `time` \[s\] went into the solution, or began it.
    fn used(&mut self, _time: f64) {}
    /// Whether position and velocity of the fix at `time` \[s\] were used, weakened or rejected, where they were
    /// shown to the filter.
    fn updated(&mut self, _time: f64, _updates: [Option<Update>; 2]) {}
    /// A block of samples was judged to be rest or motion; the filter is at its end.
    fn judged(&mut self, _filter: &dyn Estimator, _rest: bool) {}
    /// The mounting was found, or found better: from the next sample on body axes are the vehicle's.
    fn mounted(&mut self, _mounting: &Mounting) {}
    /// A node of a smoother: the filter after all that happened up to now, and the adjoint of what
    /// happened since the node before; `None` at the first one.
    fn node(&mut self, _filter: &dyn Estimator, _since: Option<&Adjoint>) {}
}

/// Watches nothing.
impl Observer for () {}
