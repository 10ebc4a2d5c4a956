//! What a measurement says of the error state: below [`crate::filter`], which uses it, and
//! [`crate::aiding`], which makes it.

use nalgebra::{SMatrix, SVector};

/// Innovation and observation matrix of a measurement of `M` components, for a filter of `N` states.
///
/// For the measurements of this crate the `observe_…` functions of [`Filter`](crate::filter::Filter) make it; one of your own is made by its fields:
///
/// ```
/// use undrift_nav::{Matrix3, Quaternion, Vector3, aiding::Observation, earth::Geodetic};
/// use undrift_nav::{filter::{Filter, Gate, InitialStd}, mechanisation::NavState};
/// use undrift_nav::{parameters::Parameters, shaping::ShapingFilter};
/// use nalgebra::{SMatrix, SVector};
///
/// let nav = NavState {
///     time: 0.0,
///     position: Geodetic::from_degrees(47.0, 8.0, 400.0),
///     v_n: Vector3::zeros(),
///     q_nb: Quaternion::identity(),
/// };
/// let std = InitialStd { position: Vector3::repeat(9.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
/// let sensors = [ShapingFilter::white(1e-4, 0.01)?; 6];
/// let mut filter = Filter::<9>::new(nav, &std, sensors, Parameters::none())?;
///
/// // A laser above a lake reads a height of 402.5 m. Height is minus the third position error: δr is down.
/// let mut h = SMatrix::<f64, 1, 9>::zeros();
/// h[(0, 2)] = -1.0;
/// let height = Observation {
///     innovation: SVector::<f64, 1>::new(filter.nav().position.height - 402.5),
///     h,
///     extra: SMatrix::zeros(),
/// };
/// filter.update(&height, &SMatrix::<f64, 1, 1>::new(0.1 * 0.1), &Gate::OPEN)?;
/// assert!((filter.nav().position.height - 402.5).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Observation<const M: usize, const N: usize> {
    /// Predicted less measured, in the measurement's own frame and unit (\[m\], [m/s], \[rad\] …).
    pub innovation: SVector<f64, M>,
    /// Derivative H of the innovation by the error state, a row for each component.
    /// Its sign follows from errors that are estimate less truth: with `x` the error, `innovation = h · x + noise`.
    pub h: SMatrix<f64, M, N>,
    /// Covariance that the prediction itself adds to the measurement's, in squares of the innovation's unit: that of the present
    /// sample's white noise where a rate enters the prediction, else zero.
    pub extra: SMatrix<f64, M, M>,
}
