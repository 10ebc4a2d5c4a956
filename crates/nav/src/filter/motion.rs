//! Motion against the Earth, or against a frame that does not turn with it.

use super::Filter;
use crate::{
    Vector3,
    earth::LocalEarth,
    parameters::{Parameter, slow_motion, smooth},
};

impl<const N: usize> Filter<N> {
    /// Angular rate of the body against the navigation frame ω_nb^b [rad/s], from the last sample.
    ///
    /// What the body turns by over ground: a body at rest has none, though its gyros read the Earth's rate.
    ///
    /// ```
    /// use undrift_nav::{earth::earth_rate_n, sample::ImuSample};
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let mut filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// let rate_in = earth_rate_n(filter.nav().position.lat);
    /// filter.set_nav(NavState { v_n: Vector3::zeros(), ..*filter.nav() });
    /// filter.begin(&ImuSample::from_rates(0.01, 0.01, rate_in, [0.0, 0.0, -9.81]));
    /// assert!(filter.omega_nb_b().norm() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn omega_nb_b(&self) -> Vector3 {
        let earth = self.earth();
        let omega_in = earth.earth_rate() + earth.transport_rate(&self.nav.v_n);
        self.omega_ib_b - self.c_nb.tr_mul(&omega_in)
    }

    /// Acceleration of the IMU over ground, north-east-down [m/s²], from the last sample; without the
    /// Coriolis term.
    ///
    /// ```
    /// use undrift_nav::sample::ImuSample;
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let mut filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// let gravity = undrift_nav::earth::gravity(filter.nav().position.lat, filter.nav().position.height);
    /// filter.begin(&ImuSample::from_rates(0.01, 0.01, [0.0; 3], [1.5, 0.0, -gravity]));
    /// assert!((filter.acceleration() - Vector3::new(1.5, 0.0, 0.0)).norm() < 1e-12); // Forward, which is north here.
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn acceleration(&self) -> Vector3 {
        let gravity = crate::earth::LocalEarth::at(&self.nav.position).gravity;
        self.c_nb * self.force_b + Vector3::new(0.0, 0.0, gravity)
    }

    /// Takes the acceleration of a sample of `dt` \[s\] into [`Filter::slow_motion`].
    pub(super) fn follow_slowly(&mut self, dt: f64) {
        if self.parameters.start(Parameter::Smoothing).is_none() {
            return;
        }
        let acceleration = self.acceleration();
        match self.previous {
            Some(_) => smooth(&mut self.slow, &acceleration, dt),
            None => self.slow = [acceleration; 2],
        }
    }

    /// Acceleration of the IMU over ground [m/s²] and its rate of change [m/s³], north-east-down, behind low-passes of 0.1 s where
    /// [`Parameter::Smoothing`] is estimated, else zero.
    pub(crate) fn slow_motion(&self) -> [Vector3; 2] {
        slow_motion(&self.slow)
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
