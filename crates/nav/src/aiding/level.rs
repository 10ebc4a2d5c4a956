//! Level from gravity, at rest.

use super::Observation;
use crate::{Vector3, attitude::skew, filter::Filter, parameters::Coupling};
use nalgebra::SMatrix;

impl<const N: usize> Filter<N> {
    /// Observation of level by `f_b`, the mean specific force at rest [m/s², body axes]: it points up, so its north and east parts
    /// are zero. Rows (north, east) `[0, 0, [f^n×], C_b^n H_a]`, innovation [m/s²]; the mean's own predicted error is removed.
    /// Roll, pitch and the level accelerometers' errors cannot be separated by it alone. Groves section 5.6.2 (levelling).
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
