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
    /// filter's age for the clock's rate; `[p×]` for the tilt of a frame of poses, p the baseline. Groves section 14.3.1, the source paper's eq. 10.
    pub fn observe_position(&self, fix: &Position, lever_b: &Vector3) -> Observation<3, N> {
        let lever_n = self.c_nb() * self.lever_arm(lever_b);
        let antenna = self.antenna_position(lever_b);
        let (innovation, c_mn) = match fix {
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
