//! Why there is no alignment.

use crate::align::{AlignmentFailure, ClockFault, Stamps};
use alloc::vec::Vec;
use undrift_events::Implausible;

/// No alignment before the samples ended, and what is known of why.
///
/// ```
/// use undrift_engine::{EndError, Navigator, align::AlignmentFailure, settings::Settings};
/// use undrift_nav::{sample::ImuSample, shaping::ShapingFilter};
/// let mut navigator = Navigator::new(Settings::new([ShapingFilter::white(1e-3, 0.01)?; 6]));
/// for k in 1..1000 {
///     navigator.imu(ImuSample::from_rates(0.01 * f64::from(k), 0.01, [0.0; 3], [0.0, 0.0, -9.81]))?;
/// }
/// // Samples, but no fix: where on the Earth is not known.
/// let Err(EndError::NotAligned(why)) = navigator.end(std::iter::empty(), &mut ()) else { panic!("aligned") };
/// assert!(matches!(why.failure, AlignmentFailure::NoOverlap) && why.times.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct NotAligned {
    /// The step at which the alignment stopped, with what was missing.
    pub failure: AlignmentFailure,
    /// Stamps of samples and of fixes (in this order), where there were both, and how their clocks differ if they do not overlap.
    pub times: Option<([Stamps; 2], ClockFault)>,
    /// Units, axes, signs or times that cannot be right.
    pub implausible: Vec<Implausible>,
}
