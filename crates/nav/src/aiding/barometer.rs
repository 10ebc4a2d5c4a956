//! Barometric height.

use super::Observation;
use crate::{filter::Filter, parameters::Parameter};
use nalgebra::{SMatrix, SVector};

impl<const N: usize> Filter<N> {
    /// Observation of a barometric `height` \[m\] at the IMU, ellipsoidal but for its error: pressure heights are above a reference that
    /// moves with the weather, which [`Parameter::BarometerBias`] takes up (it reads height + bias). Row `[0 0 −1, 0, …]`, and
    /// `−1` for that bias. [`standard_height`](crate::earth::standard_height) makes a height of a pressure.
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
