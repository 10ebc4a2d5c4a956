//! What a measurement says of the error state: below [`crate::filter`], which takes it in, and
//! [`crate::aiding`], which makes it.

use nalgebra::{SMatrix, SVector};

/// Innovation and observation matrix of a measurement of `M` components.
#[derive(Clone, Copy, Debug)]
pub struct Observation<const M: usize, const N: usize> {
    /// Predicted less measured, in the measurement's own frame and unit (\[m\], [m/s], \[rad\] …).
    pub innovation: SVector<f64, M>,
    /// Derivative H of the innovation by the error state, a row for each component.
    pub h: SMatrix<f64, M, N>,
    /// Covariance that the prediction itself adds to the measurement's (the last sample's white noise),
    /// in squares of the innovation's unit.
    pub extra: SMatrix<f64, M, M>,
}
