//! GNSS position.

use super::Observation;
use crate::{
    Matrix3, Vector3, attitude::skew, earth::Geodetic, filter::Filter, parameters::Parameter,
    sample::Position,
};
use nalgebra::SMatrix;

impl<const N: usize> Filter<N> {
    /// Antenna position; `lever_b` from IMU to antenna as configured, body axes \[m\].
    pub fn antenna_position(&self, lever_b: &Vector3) -> Geodetic {
        let lever_n = self.c_nb() * self.lever_arm(lever_b);
        self.nav().position.displaced(&lever_n)
    }

    /// What a position fix says. Rows `[C_n^m, 0, C_n^m [l^n×], 0]`, m the frame of the fix: local
    /// north-east-down, or the base station's for a baseline; `−C_n^m C_b^n` for the lever arm,
    /// `−C_n^m v^n` for the time offset, times the filter's age for the clock's rate.
    pub fn observe_position(&self, fix: &Position, lever_b: &Vector3) -> Observation<3, N> {
        let lever_n = self.c_nb() * self.lever_arm(lever_b);
        let antenna = self.antenna_position(lever_b);
        let (innovation, c_mn) = match fix {
            Position::Geodetic(measured) => (measured.offset_to(&antenna), Matrix3::identity()),
            Position::Baseline { base, ned } => {
                let c_mn = base.ned_from_ecef() * antenna.ned_from_ecef().transpose();
                (base.ned_to(&antenna) - ned, c_mn)
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
