//! GNSS velocity.

use super::Observation;
use crate::{Matrix3, Vector3, attitude::skew, filter::Filter, parameters::Parameter};
use nalgebra::SMatrix;

impl<const N: usize> Filter<N> {
    /// Predicted velocity of the antenna over ground, north-east-down [m/s]: the IMU's and `C_b^n (ω_nb^b × l^b)`, `lever_b` \[m\] from the IMU
    /// in body axes as configured, with its estimated correction.
    pub fn antenna_velocity(&self, lever_b: &Vector3) -> Vector3 {
        self.nav().v_n + self.c_nb() * self.omega_nb_b().cross(&self.lever_arm(lever_b))
    }

    /// Observation of a velocity fix `v_n` [m/s, north-east-down] of the antenna at `lever_b` [m, body axes, from the IMU, as configured].
    ///
    /// Rows `[0, I, [ω_nb^n×][l^n×] − [l^n×][ω_ib^n×], −[l^n×] C_b^n H_g, 0]`: the source paper's row (eq. 10),
    /// exact in the second rate (it has ω_nb there, which leaves out the frame's own rate); `−C_b^n [ω_nb^b×]` for the lever arm, less
    /// the acceleration of the IMU for the time offset of the velocity, and its rate of change for a receiver's filter. The gyros' white noise enters through the lever
    /// arm: it is in [`Observation::extra`].
    ///
    /// ```
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// let observed = filter.observe_velocity(&Vector3::new(19.8, 0.0, 0.0), &Vector3::new(0.5, 0.0, -1.2));
    /// assert!((observed.innovation - Vector3::new(0.2, 0.0, 0.0)).norm() < 1e-3); // [m/s]
    /// assert_eq!(observed.h[(0, 3)], 1.0);
    /// // White noise of the gyros at a lever arm of 1.2 m: (1.2 m)² r, r the variance of a sample.
    /// let r = filter.sensors().axis(0).r;
    /// assert!((observed.extra[(1, 1)] - (1.2_f64.powi(2) + 0.5_f64.powi(2)) * r).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn observe_velocity(&self, v_n: &Vector3, lever_b: &Vector3) -> Observation<3, N> {
        let c = self.c_nb();
        let lever_n = c * self.lever_arm(lever_b);
        let lever = skew(&lever_n);
        let (omega_nb, omega_ib) = (
            skew(&(c * self.omega_nb_b())),
            skew(&(c * self.omega_ib_b())),
        );
        let mut h = SMatrix::<f64, 3, N>::zeros();
        h.fixed_view_mut::<3, 3>(0, 3)
            .copy_from(&Matrix3::identity());
        h.fixed_view_mut::<3, 3>(0, 6)
            .copy_from(&(omega_nb * lever - lever * omega_ib));
        let extra = self.rate_columns(&mut h, &(-lever * c));
        if let Some(at) = self.parameter_start(Parameter::LeverArm) {
            h.fixed_view_mut::<3, 3>(0, at)
                .copy_from(&(-c * skew(&self.omega_nb_b())));
        }
        let offset = self.parameter_start(Parameter::VelocityTimeOffset);
        if let Some(at) = offset.or(self.parameter_start(Parameter::TimeOffset)) {
            self.time_columns(&mut h, at, &-self.acceleration());
        }
        let mut innovation = self.antenna_velocity(lever_b) - v_n;
        if let Some(at) = self.parameter_start(Parameter::Smoothing) {
            let off = self.slow_motion()[1];
            innovation += off * self.estimates()[at + 1];
            h.fixed_view_mut::<3, 1>(0, at + 1).copy_from(&-off);
        }
        Observation {
            innovation,
            h,
            extra,
        }
    }
}
