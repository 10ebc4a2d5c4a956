//! Attitude of a marker, as motion capture, a camera or a laser scanner sees it.

use super::Observation;
use crate::{Matrix3, Quaternion, Vector3, attitude, filter::Filter, parameters::Parameter};
use nalgebra::SMatrix;

impl<const N: usize> Filter<N> {
    /// Predicted attitude `q_rk` of the marker against the frame r of the poses: the body's, the marker's axes in the body `q_bk` as
    /// configured with their estimated correction ([`Parameter::MarkerRotation`]), and the tilt of that frame ([`Parameter::FrameTilt`]).
    pub fn marker_attitude(&self, q_bk: &Quaternion) -> Quaternion {
        let turn = attitude::from_rotation_vector(&self.marker_turn());
        let q_nk = self.nav().q_nb * q_bk * turn;
        attitude::from_rotation_vector(&self.frame_tilt()) * q_nk
    }

    /// Observation of the attitude `q_rk` of a marker whose axes lie in the body as `q_bk` says. The innovation is the rotation vector of
    /// `q_rk q̂_rk⁻¹` in the axes of r \[rad\], which for a small error is ψ.
    ///
    /// Rows `[0, 0, C_n^r, 0]` with C_n^r by the tilt, nearly `I`; `C_k^r J_r` for the marker's rotation, the first two columns of `J_l` for the
    /// tilt (Jacobians of the estimated turns), `C_b^r ω_nb^b` for the time offset. Solà 2017 (quaternion kinematics for the error-state
    /// filter), sections 4 and 6.
    ///
    /// ```
    /// use undrift_nav::attitude;
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// // A camera whose axes are the body's sees it 0.02 rad further to the right than the filter has it.
    /// let q_bk = Quaternion::identity();
    /// let seen = attitude::from_rotation_vector(&Vector3::new(0.0, 0.0, 0.02)) * filter.marker_attitude(&q_bk);
    /// let observed = filter.observe_attitude(&seen, &q_bk);
    /// assert!((observed.innovation - Vector3::new(0.0, 0.0, 0.02)).norm() < 1e-12); // ψ, about north, east, down [rad].
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn observe_attitude(&self, q_rk: &Quaternion, q_bk: &Quaternion) -> Observation<3, N> {
        let predicted = self.marker_attitude(q_bk);
        let miss = (q_rk * predicted.inverse()).scaled_axis();
        let mut h = SMatrix::<f64, 3, N>::zeros();
        let tilt = self.frame_tilt();
        let c_nr = attitude::from_rotation_vector(&tilt).to_rotation_matrix();
        h.fixed_view_mut::<3, 3>(0, 6).copy_from(c_nr.matrix());
        if let Some(at) = self.parameter_start(Parameter::MarkerRotation) {
            let jacobian = attitude::right_jacobian(&self.marker_turn());
            h.fixed_view_mut::<3, 3>(0, at)
                .copy_from(&(predicted.to_rotation_matrix().matrix() * jacobian));
        }
        if let Some(at) = self.parameter_start(Parameter::FrameTilt) {
            let jacobian = attitude::right_jacobian(&-tilt);
            h.fixed_view_mut::<3, 2>(0, at)
                .copy_from(&jacobian.fixed_columns::<2>(0));
        }
        if let Some(at) = self.parameter_start(Parameter::TimeOffset) {
            let turn = c_nr * (self.c_nb() * self.omega_nb_b());
            self.time_columns(&mut h, at, &turn);
        }
        Observation {
            innovation: miss,
            h,
            extra: Matrix3::zeros(),
        }
    }

    /// Estimated turn of the marker against its configured axes \[rad\], as a rotation vector.
    fn marker_turn(&self) -> Vector3 {
        self.parameter(Parameter::MarkerRotation)
            .map_or_else(Vector3::zeros, |(x, _)| Vector3::new(x[0], x[1], x[2]))
    }

    /// Estimated tilt of the poses' frame about north, east \[rad\], as a rotation vector.
    pub(super) fn frame_tilt(&self) -> Vector3 {
        self.parameter(Parameter::FrameTilt)
            .map_or_else(Vector3::zeros, |(x, _)| Vector3::new(x[0], x[1], 0.0))
    }
}
