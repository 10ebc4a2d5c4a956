//! Zero angular rate: a body that does not turn against the Earth turns with it.

use super::Observation;
use crate::{Matrix3, Vector3, attitude::skew, filter::Filter, parameters::Coupling};
use nalgebra::SMatrix;

impl<const N: usize> Filter<N> {
    /// Observation of the gyros by `omega_b`, their mean reading at rest [rad/s, body axes]: what it differs from the Earth's rate by
    /// is their error. Rows `[0, 0, C_n^b [ω_ie×], H_g, 0]`; the innovation is the reading less its predicted error and less the
    /// Earth's rate. To be used only where the body rests on the ground: a constant slow turn reads the same.
    ///
    /// ```
    /// use undrift_nav::earth::earth_rate_n;
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// // The reading of a gyro with a bias of 1e-4 rad/s about down, at rest.
    /// let reading = earth_rate_n(filter.nav().position.lat) + Vector3::new(0.0, 0.0, 1e-4);
    /// let observed = filter.observe_earth_rate(&reading);
    /// assert!((observed.innovation - Vector3::new(0.0, 0.0, 1e-4)).norm() < 1e-15); // [rad/s]
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn observe_earth_rate(&self, omega_b: &Vector3) -> Observation<3, N> {
        let coupling = Coupling::new(
            self.parameters(),
            self.sensors().states(),
            [omega_b, &Vector3::zeros(), &Vector3::zeros()],
        );
        let error = self.sensors().predicted_error(self.estimates(), &coupling);
        let c = self.c_nb();
        let earth_n = self.earth().earth_rate();
        let mut h = SMatrix::<f64, 3, N>::zeros();
        h.fixed_view_mut::<3, 3>(0, 6)
            .copy_from(&(c.transpose() * skew(&earth_n)));
        for axis in 0..3 {
            self.error_columns(&mut h, axis, &Vector3::ith(axis, 1.0), &coupling);
        }
        Observation {
            innovation: omega_b - Vector3::new(error[0], error[1], error[2]) - c.tr_mul(&earth_n),
            h,
            extra: Matrix3::zeros(),
        }
    }
}
