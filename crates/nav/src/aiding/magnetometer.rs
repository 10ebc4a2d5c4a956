//! Magnetic field.

use super::Observation;
use crate::{Vector3, attitude::skew, filter::Filter, parameters::Parameter};
use nalgebra::SMatrix;

impl<const N: usize> Filter<N> {
    /// Observation of the magnetic field `measured` in body axes by what the Earth's `field`, north, east, down, and the estimated
    /// [`Parameter::HardIron`] b predict, in one unit \[T\]: `C_n^b m^n + b`.
    ///
    /// The rows are `−C_n^b [m^n×]` on ψ, and `−1` for the hard iron. The field of [`magnetic::field`](crate::magnetic::field) is that
    /// of the open air: what iron nearby adds belongs into the measurement's variance.
    ///
    /// ```
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::zeros(), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// let field = Vector3::new(20e-6, 0.0, 44e-6); // No declination.
    /// // The body points north, and the field lies 0.1 rad to its left: the body points east of where the filter has it.
    /// let (sin, cos) = 0.1f64.sin_cos();
    /// let observed = filter.observe_magnetometer(&Vector3::new(cos * 20e-6, -sin * 20e-6, 44e-6), &field);
    /// assert!((observed.innovation.y - sin * 20e-6).abs() < 1e-12);
    /// assert_eq!(observed.h[(1, 8)], 20e-6); // Times ψ = 0.1 rad, to first order: the true heading is the estimate turned by +ψ.
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn observe_magnetometer(&self, measured: &Vector3, field: &Vector3) -> Observation<3, N> {
        let c_bn = self.c_nb().transpose();
        let mut h = SMatrix::<f64, 3, N>::zeros();
        h.fixed_view_mut::<3, 3>(0, 6)
            .copy_from(&(-c_bn * skew(field)));
        let mut innovation = c_bn * field - measured;
        if let (Some(at), Some((iron, _))) = (
            self.parameter_start(Parameter::HardIron),
            self.parameter(Parameter::HardIron),
        ) {
            h.fixed_view_mut::<3, 3>(0, at).fill_with_identity();
            h.fixed_view_mut::<3, 3>(0, at).neg_mut();
            innovation += Vector3::new(iron[0], iron[1], iron[2]);
        }
        Observation {
            innovation,
            h,
            extra: SMatrix::zeros(),
        }
    }
}
