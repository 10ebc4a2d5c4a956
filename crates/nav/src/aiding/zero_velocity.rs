//! Zero velocity: the body rests on the ground.

use super::Observation;
use crate::{Matrix3, filter::Filter};
use nalgebra::SMatrix;

impl<const N: usize> Filter<N> {
    /// Observation that the body rests on the ground: its velocity over ground is zero, innovation `v_n` [m/s]. Rows `[0, I, 0, 0]`. A body
    /// that rests on a ferry or a lift does not rest on the ground.
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
