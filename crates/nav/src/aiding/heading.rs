//! Heading by two antennas.

use super::{Observation, azimuth};
use crate::{Vector3, filter::Filter, parameters::Parameter};

impl<const N: usize> Filter<N> {
    /// Observation of the `heading` of a second antenna as seen from the first [rad, from north to east], which lies in the direction
    /// `baseline` in the body [rad, from forward to right] plus the estimated [`Parameter::HeadingOffset`]. The innovation is
    /// predicted less measured \[rad\], wrapped to (−π, π].
    ///
    /// With b the direction of the antennas in `n` the row is `∂azimuth/∂b [b×]` on ψ, and `−∂azimuth/∂b C_b^n (−sin β, cos β, 0)` for
    /// the offset: tilt enters as it does. `None` while the antennas are within 10° of above each other.
    ///
    /// ```
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::zeros(), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// // The second antenna is on the right; the body points north, so that it should be seen in the east.
    /// let right = 90f64.to_radians();
    /// let observed = filter.observe_heading(92f64.to_radians(), right).expect("not above each other");
    /// assert!((observed.innovation[0].to_degrees() + 2.0).abs() < 1e-9);
    /// assert_eq!(observed.h[(0, 8)], -1.0); // The true heading is the estimate turned by +ψ.
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn observe_heading(&self, heading: f64, baseline: f64) -> Option<Observation<1, N>> {
        let offset = self.parameter(Parameter::HeadingOffset);
        let (sin, cos) = libm::sincos(baseline + offset.map_or(0.0, |(x, _)| x[0]));
        let b = self.c_nb() * Vector3::new(cos, sin, 0.0);
        let (mut observed, change) = azimuth(&b, heading)?;
        if let Some(at) = self.parameter_start(Parameter::HeadingOffset) {
            observed.h[(0, at)] = -change(&(self.c_nb() * Vector3::new(-sin, cos, 0.0)));
        }
        Some(observed)
    }
}
