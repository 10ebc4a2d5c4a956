//! GNSS course of a vehicle that moves where it points.

use super::{Observation, azimuth};
use crate::{Vector3, filter::Filter, parameters::Parameter};

impl<const N: usize> Filter<N> {
    /// Observation of the vehicle's heading by a `course` over ground [rad, from north to east], as if there were no side slip: the
    /// slip belongs into the measurement's variance. The innovation is heading less course \[rad\], wrapped to (−π, π].
    ///
    /// With f the vehicle's forward axis in `n` and `yaw = atan2(f_E, f_N)` the row is `∂yaw/∂f (−[ψ×] f)`, and that of a turn about
    /// the vehicle's right and down axes for the mounting. `None` while the vehicle points within 10° of up or down, where it
    /// has no heading.
    ///
    /// ```
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// // Heading north, moving 0.03 rad to the east of it.
    /// let observed = filter.observe_course(0.03).expect("level");
    /// assert!((observed.innovation[0] + 0.03).abs() < 1e-12); // Heading less course.
    /// assert_eq!(observed.h[(0, 8)], -1.0); // The true heading is the estimate turned by +ψ.
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn observe_course(&self, course: f64) -> Option<Observation<1, N>> {
        let c_vn = self.c_nb() * self.c_bv().transpose();
        let f: Vector3 = c_vn.column(0).into();
        let (mut observed, change) = azimuth(&f, course)?;
        if let Some(at) = self.parameter_start(Parameter::Mounting) {
            for i in 0..2 {
                let turned = Vector3::ith(1 + i, 1.0).cross(&Vector3::x());
                observed.h[(0, at + i)] = -change(&(c_vn * turned));
            }
        }
        Some(observed)
    }
}
