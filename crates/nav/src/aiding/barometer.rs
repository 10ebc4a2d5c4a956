//! Barometric height.

use super::Observation;
use crate::{filter::Filter, parameters::Parameter};
use nalgebra::{SMatrix, SVector};

impl<const N: usize> Filter<N> {
    /// What a barometric height `height` [m, ellipsoidal but for its error] of the IMU says. Row
    /// `[0 0 −1, 0, …]`, `−1` for the barometer's own error.
    pub fn observe_barometer(&self, height: f64) -> Observation<1, N> {
        let mut h = SMatrix::<f64, 1, N>::zeros();
        h[(0, 2)] = -1.0;
        let mut predicted = self.nav().position.height;
        if let (Some(at), Some((bias, _))) = (
            self.parameter_start(Parameter::BarometerBias),
            self.parameter(Parameter::BarometerBias),
        ) {
            h[(0, at)] = -1.0;
            predicted += bias[0];
        }
        Observation {
            innovation: SVector::<f64, 1>::new(predicted - height),
            h,
            extra: SMatrix::zeros(),
        }
    }
}
