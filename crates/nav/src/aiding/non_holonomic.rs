//! Non-holonomic constraint: a wheeled vehicle does not slide sideways nor leave the ground.

use super::Observation;
use crate::{Vector3, filter::Filter, parameters::Parameter};

impl<const N: usize> Filter<N> {
    /// Observation that a wheeled vehicle neither slides sideways nor leaves the ground: at the point `lever_b` [m, body axes, from the
    /// IMU], on the axle that does not steer, the velocity along the vehicle's right and down axes is zero, [m/s]. Rows 2 and 3
    /// of the vehicle velocity's, see [`Filter::vehicle_velocity`]; where the axle's place is estimated, `−C_b^v (ω_nb^b × x_b)` is its
    /// column. Groves section 15.4.1; Dissanayake et al. 2001.
    ///
    /// The covariance of the update is the tyres' slip: some hundredths of a m/s on asphalt, more in tight curves.
    ///
    /// ```
    /// use undrift_nav::attitude;
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let mut filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// // Turned by 0.05 rad to the left of where it moves, the vehicle would slide sideways with 20 m/s · sin 0.05.
    /// let q_nb = attitude::from_rpy(&Vector3::new(0.0, 0.0, -0.05));
    /// filter.set_nav(NavState { q_nb, ..*filter.nav() });
    /// let observed = filter.observe_non_holonomic(&Vector3::zeros());
    /// assert!((observed.innovation[0] - 20.0 * 0.05_f64.sin()).abs() < 1e-9); // To the right [m/s].
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn observe_non_holonomic(&self, lever_b: &Vector3) -> Observation<2, N> {
        let mut lever = *lever_b;
        if let Some((axle, _)) = self.parameter(Parameter::Axle) {
            lever.x += axle[0];
        }
        let (mut h, extra) = self.vehicle_velocity_rows(&lever);
        if let Some(at) = self.parameter_start(Parameter::Axle) {
            let sideways = self.c_bv() * self.omega_nb_b().cross(&Vector3::x());
            h.fixed_view_mut::<3, 1>(0, at).copy_from(&-sideways);
        }
        Observation {
            innovation: self.vehicle_velocity(&lever).yz(),
            h: h.fixed_rows::<2>(1).into(),
            extra: extra.fixed_view::<2, 2>(1, 1).into(),
        }
    }
}
