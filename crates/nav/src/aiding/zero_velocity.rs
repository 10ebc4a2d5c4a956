//! Zero velocity: the body rests on the ground.

use super::Observation;
use crate::{Matrix3, filter::Filter};
use nalgebra::SMatrix;

impl<const N: usize> Filter<N> {
    /// Observation that the body rests on the ground: its velocity over ground is zero, innovation `v_n` [m/s]. Rows `[0, I, 0, 0]`. A body
    /// that rests on a ferry or a lift does not rest on the ground.
    ///
    /// ```
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// assert_eq!(filter.observe_zero_velocity().innovation, Vector3::new(20.0, 0.0, 0.0)); // [m/s]
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn observe_zero_velocity(&self) -> Observation<3, N> {
        let mut h = SMatrix::<f64, 3, N>::zeros();
        h.fixed_view_mut::<3, 3>(0, 3)
            .copy_from(&Matrix3::identity());
        Observation {
            innovation: self.nav().v_n,
            h,
            extra: Matrix3::zeros(),
        }
    }
}
