//! Non-holonomic constraint: a wheeled vehicle does not slide sideways nor leave the ground.

use super::Observation;
use crate::{Vector3, filter::Filter};

impl<const N: usize> Filter<N> {
    /// What a rolling vehicle says: at the point `lever_b` [m, body axes, from the IMU], on the axle
    /// that does not steer, the velocity along the vehicle's right and down axes is zero. Rows 2 and 3
    /// of the vehicle velocity's, see [`Filter::vehicle_velocity`]. Groves section 15.4.1; Dissanayake
    /// et al. 2001.
    pub fn observe_non_holonomic(&self, lever_b: &Vector3) -> Observation<2, N> {
        let (h, extra) = self.vehicle_velocity_rows(lever_b);
        Observation {
            innovation: self.vehicle_velocity(lever_b).yz(),
            h: h.fixed_rows::<2>(1).into(),
            extra: extra.fixed_view::<2, 2>(1, 1).into(),
        }
    }
}
