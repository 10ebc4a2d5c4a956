//! What is called while the navigator runs: to write a solution, to compare it with a reference, to smooth it.

use crate::estimator::{Adjoint, Estimator};
use crate::mounting::Mounting;
use undrift_nav::{filter::Update, sample::GnssFix};

/// Called with everything that happens, in order of time; methods that are not implemented do nothing. With a horizon
/// ([`Navigator::with_horizon`](crate::Navigator::with_horizon)), what is done again for a late measurement is not observed again.
///
/// ```
/// use undrift_engine::{Navigator, Observer, estimator::Estimator, settings::Settings};
/// /// Time [s] and horizontal standard deviation [m] at each sample.
/// struct Accuracy(Vec<(f64, f64)>);
/// impl Observer for Accuracy {
///     fn sample(&mut self, filter: &dyn Estimator) {
///         let [north, east, ..] = filter.nav_std();
///         self.0.push((filter.nav().time, north.hypot(east)));
///     }
/// }
/// # use undrift_nav::shaping::ShapingFilter;
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
/// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
/// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
/// let mut navigator = Navigator::new(Settings::new(sensors));
/// for fix in log.gnss {
///     navigator.fix(fix)?;
/// }
/// let mut accuracy = Accuracy(Vec::new());
/// for sample in log.imu {
///     navigator.imu_watched(sample, &mut accuracy)?;
/// }
/// assert!(accuracy.0.len() > 1000 && accuracy.0.iter().all(|(_, std)| *std < 1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Observer {
    /// A sample was processed, and every fix up to its end; the filter is at the sample's end.
    fn sample(&mut self, _filter: &dyn Estimator) {}
    /// A fix was reached; the filter is at its time, before any update with it.
    fn fix(&mut self, _filter: &dyn Estimator, _fix: &GnssFix, _withheld: bool) {}
    /// A fix stamped `time` \[s\] went into the solution, or began it.
    fn used(&mut self, _time: f64) {}
    /// Position and velocity of the fix stamped `time` \[s\] were shown to the filter: the update with each (in this order) says whether it was
    /// used, weakened or rejected; `None` for a part that the fix does not have or that is not used.
    fn updated(&mut self, _time: f64, _updates: [Option<Update>; 2]) {}
    /// A block of samples was judged to be rest or motion; the filter is at its end.
    fn judged(&mut self, _filter: &dyn Estimator, _rest: bool) {}
    /// The mounting was found, or found better: from the next sample on body axes are the vehicle's.
    fn mounted(&mut self, _mounting: &Mounting) {}
    /// A node of a smoother ([`Settings::nodes`](crate::settings::Settings::nodes)): the filter after all that happened up to now, and the
    /// adjoint of what happened since the node before; `None` at the first one.
    fn node(&mut self, _filter: &dyn Estimator, _since: Option<&Adjoint>) {}
}

/// Observes nothing.
impl Observer for () {}
