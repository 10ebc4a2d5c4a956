//! Barometric height.

use super::Observation;
use crate::{filter::Filter, parameters::Parameter};
use nalgebra::{SMatrix, SVector};

impl<const N: usize> Filter<N> {
    /// Observation of a barometric `height` \[m\] at the IMU, ellipsoidal but for its error: pressure heights are above a reference that
    /// moves with the weather, which [`Parameter::BarometerBias`] takes up (it reads height + bias). Row `[0 0 −1, 0, …]`, and
    /// `−1` for that bias. [`standard_height`](crate::earth::standard_height) makes a height of a pressure.
    ///
    /// ```
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// let observed = filter.observe_barometer(398.0); // The filter has 400 m.
    /// assert_eq!((observed.innovation[0], observed.h[(0, 2)]), (2.0, -1.0)); // Height is up, the third error down.
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
