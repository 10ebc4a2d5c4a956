//! GNSS position.

use super::Observation;
use crate::{
    Matrix3, Vector3,
    attitude::{from_rotation_vector, right_jacobian, skew},
    earth::Geodetic,
    filter::Filter,
    parameters::Parameter,
    sample::Position,
};
use nalgebra::SMatrix;

impl<const N: usize> Filter<N> {
    /// Predicted position of the antenna, `lever_b` \[m\] from the IMU in body axes as configured; an estimated correction of the lever arm is
    /// added to it.
    pub fn antenna_position(&self, lever_b: &Vector3) -> Geodetic {
        let lever_n = self.c_nb() * self.lever_arm(lever_b);
        self.nav().position.displaced(&lever_n)
    }

    /// Observation of a position fix of the antenna at `lever_b` [m, body axes, from the IMU, as configured]. The innovation is
    /// predicted less measured in the frame m of the fix \[m\]: north-east-down at the antenna, or of the base station for a baseline.
    ///
    /// Rows `[C_n^m, 0, C_n^m [l^n×], 0]`; `−C_n^m C_b^n` for the lever arm, `−C_n^m v^n` of the antenna for the time offset, times the
    /// filter's age for the clock's rate; less `C_n^m` times the acceleration of the IMU for a receiver's filter; `[p×]` for the tilt of a frame of poses, p the baseline. Groves section 14.3.1, the source paper's eq. 10.
    ///
    /// ```
    /// use undrift_nav::sample::Position;
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// // Northwards at 20 m/s; the antenna half a metre ahead of the IMU and 1.2 m above it. The fix is 3 m north of where it should be.
    /// let lever = Vector3::new(0.5, 0.0, -1.2);
    /// let fix = filter.antenna_position(&lever).displaced(&Vector3::new(3.0, 0.0, 0.0));
    /// let observed = filter.observe_position(&Position::Geodetic(fix), &lever);
    /// assert!((observed.innovation - Vector3::new(-3.0, 0.0, 0.0)).norm() < 1e-6); // Predicted less measured [m].
    /// assert!((observed.h[(1, 8)] + 0.5).abs() < 1e-12, "a yaw error moves the antenna by its distance ahead");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn observe_position(&self, fix: &Position, lever_b: &Vector3) -> Observation<3, N> {
        let lever_n = self.c_nb() * self.lever_arm(lever_b);
        let antenna = self.antenna_position(lever_b);
        let (mut innovation, c_mn) = match fix {
            Position::Geodetic(measured) => (measured.offset_to(&antenna), Matrix3::identity()),
            Position::Baseline { base, ned } => {
                let c_mn = base.ned_from_ecef() * antenna.ned_from_ecef().transpose();
                let from_base = base.ned_to(&antenna);
                let tilt = from_rotation_vector(&self.frame_tilt());
                let c_mr = tilt.to_rotation_matrix().into_inner();
                (c_mr * from_base - ned, c_mr * c_mn)
            }
        };
        let mut h = SMatrix::<f64, 3, N>::zeros();
        h.fixed_view_mut::<3, 3>(0, 0).copy_from(&c_mn);
        h.fixed_view_mut::<3, 3>(0, 6)
            .copy_from(&(c_mn * skew(&lever_n)));
        if let Some(at) = self.parameter_start(Parameter::LeverArm) {
            h.fixed_view_mut::<3, 3>(0, at)
                .copy_from(&(-c_mn * self.c_nb()));
        }
        if let Some(at) = self.parameter_start(Parameter::Smoothing) {
            let off = c_mn * self.slow_motion()[0];
            innovation += off * self.estimates()[at];
            h.fixed_view_mut::<3, 1>(0, at).copy_from(&-off);
        }
        if let (Some(at), Position::Baseline { ned, .. }) =
            (self.parameter_start(Parameter::FrameTilt), fix)
        {
            // Of the predicted baseline, in the frame's axes.
            let turned = skew(&(innovation + ned)) * right_jacobian(&-self.frame_tilt());
            h.fixed_view_mut::<3, 2>(0, at)
                .copy_from(&turned.fixed_columns::<2>(0));
        }
        if let Some(at) = self.parameter_start(Parameter::TimeOffset) {
            self.time_columns(&mut h, at, &(-c_mn * self.antenna_velocity(lever_b)));
        }
        Observation {
            innovation,
            h,
            extra: Matrix3::zeros(),
        }
    }
}
