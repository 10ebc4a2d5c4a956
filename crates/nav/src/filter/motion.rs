//! Motion against the Earth, or against a frame that does not turn with it.

use super::Filter;
use crate::{Vector3, earth::LocalEarth};

impl<const N: usize> Filter<N> {
    /// Angular rate of the body against the navigation frame ω_nb^b [rad/s], from the last sample.
    pub fn omega_nb_b(&self) -> Vector3 {
        let earth = self.earth();
        let omega_in = earth.earth_rate() + earth.transport_rate(&self.nav.v_n);
        self.omega_ib_b - self.c_nb.tr_mul(&omega_in)
    }

    /// Acceleration of the IMU over ground, north-east-down [m/s²], from the last sample; without the
    /// Coriolis term.
    pub fn acceleration(&self) -> Vector3 {
        let gravity = crate::earth::LocalEarth::at(&self.nav.position).gravity;
        self.c_nb * self.force_b + Vector3::new(0.0, 0.0, gravity)
    }

    /// Takes the navigation frame for one that does not turn with the Earth, from now on: a room whose heading is unknown. The gyros' biases
    /// then have up to 15 °/h of it, [`EARTH_RATE`](crate::earth::EARTH_RATE).
    pub fn without_earth_rate(&mut self) {
        self.turns = false;
    }

    /// Radii, gravity and the Earth's rate at the present place.
    #[inline]
    pub(crate) fn earth(&self) -> LocalEarth {
        let mut earth = LocalEarth::at(&self.nav.position);
        if !self.turns {
            earth.rate = 0.0;
        }
        earth
    }
}
