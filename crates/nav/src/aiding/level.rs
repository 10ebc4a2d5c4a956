//! Level from gravity, at rest.

use super::Observation;
use crate::{Vector3, attitude::skew, filter::Filter, parameters::Coupling};
use nalgebra::SMatrix;

impl<const N: usize> Filter<N> {
    /// Observation of level by `f_b`, the mean specific force at rest [m/s², body axes]: it points up, so its north and east parts
    /// are zero. Rows (north, east) `[0, 0, [f^n×], C_b^n H_a]`, innovation [m/s²]; the mean's own predicted error is removed.
    /// Roll, pitch and the level accelerometers' errors cannot be separated by it alone. Groves section 5.6.2 (levelling).
    ///
    /// ```
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// // At rest the force points up. The filter takes itself for level, so 0.0981 m/s² forward are a pitch of 0.01 rad.
    /// let observed = filter.observe_level(&Vector3::new(0.0981, 0.0, -9.81));
    /// assert!((observed.innovation.x / observed.h[(0, 7)] - 0.01).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn observe_level(&self, f_b: &Vector3) -> Observation<2, N> {
        let coupling = Coupling::new(
            self.parameters(),
            self.sensors().states(),
            [&Vector3::zeros(), f_b, &Vector3::zeros()],
        );
        let error = self.sensors().predicted_error(self.estimates(), &coupling);
        let c = self.c_nb();
        let f_n = c * (f_b - Vector3::new(error[3], error[4], error[5]));
        let force = skew(&f_n);
        let mut h = SMatrix::<f64, 2, N>::zeros();
        h.fixed_view_mut::<2, 3>(0, 6)
            .copy_from(&force.fixed_rows::<2>(0));
        for axis in 0..3 {
            let column = c.column(axis).xy();
            self.error_columns(&mut h, 3 + axis, &column, &coupling);
        }
        Observation {
            innovation: f_n.xy(),
            h,
            extra: SMatrix::zeros(),
        }
    }
}
