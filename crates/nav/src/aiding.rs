//! Aiding: what each kind of measurement predicts, its innovation and its H.
//!
//! Every innovation is predicted less measured. docs/theory.md: the source paper's equation (10), signs as
//! derived in `docs/conventions.md`, each block tested against a numerical derivative.

use crate::{
    Matrix3, Vector3,
    attitude::skew,
    earth::Geodetic,
    filter::{Filter, FilterError, Update},
    sample::Position,
};
use nalgebra::SMatrix;

/// Innovation and observation matrix of a three-component measurement.
#[derive(Clone, Copy, Debug)]
pub struct Observation<const N: usize> {
    /// Predicted less measured.
    pub innovation: Vector3,
    /// Derivative of the innovation by the error state.
    pub h: SMatrix<f64, 3, N>,
    /// Covariance that the prediction itself adds to the measurement's (the last sample's white noise).
    pub extra: Matrix3,
}

impl<const N: usize> Filter<N> {
    /// Antenna position; `lever_b` from IMU to antenna, body axes [m].
    pub fn antenna_position(&self, lever_b: &Vector3) -> Geodetic {
        let lever_n = self.c_nb() * lever_b;
        self.nav().position.displaced(&lever_n)
    }

    /// Antenna velocity over ground, north-east-down [m/s]; `lever_b` from IMU to antenna, body axes [m].
    pub fn antenna_velocity(&self, lever_b: &Vector3) -> Vector3 {
        self.nav().v_n + self.c_nb() * self.omega_nb_b().cross(lever_b)
    }

    /// What a position fix says. Rows `[C_n^m, 0, C_n^m [l^n×], 0]`, m the frame of the fix: local
    /// north-east-down, or the base station's for a baseline.
    pub fn observe_position(&self, fix: &Position, lever_b: &Vector3) -> Observation<N> {
        let lever_n = self.c_nb() * lever_b;
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
        Observation {
            innovation,
            h,
            extra: Matrix3::zeros(),
        }
    }

    /// What a velocity fix `v_n` [m/s] says. Rows
    /// `[0, I, [ω_nb^n×][l^n×] − [l^n×][ω_ib^n×], −[l^n×] C_b^n H_g, 0]`: the source paper's row,
    /// exact in the second rate (it has ω_nb there, which leaves out the frame's own rate).
    pub fn observe_velocity(&self, v_n: &Vector3, lever_b: &Vector3) -> Observation<N> {
        let c = self.c_nb();
        let lever_n = c * lever_b;
        let lever = skew(&lever_n);
        let (omega_nb, omega_ib) = (
            skew(&(c * self.omega_nb_b())),
            skew(&(c * self.omega_ib_b())),
        );
        let lever_c = lever * c;
        let mut h = SMatrix::<f64, 3, N>::zeros();
        h.fixed_view_mut::<3, 3>(0, 3)
            .copy_from(&Matrix3::identity());
        h.fixed_view_mut::<3, 3>(0, 6)
            .copy_from(&(omega_nb * lever - lever * omega_ib));
        let mut white = Matrix3::zeros();
        for axis in 0..3 {
            let (filter, at) = (self.sensors().axis(axis), self.sensors().start(axis));
            for i in 0..filter.order {
                for row in 0..3 {
                    h[(row, at + i)] = -lever_c[(row, axis)] * filter.h[i];
                }
            }
            white[(axis, axis)] = filter.r;
        }
        Observation {
            innovation: self.antenna_velocity(lever_b) - v_n,
            h,
            extra: lever_c * white * lever_c.transpose(),
        }
    }

    /// What a mean specific force at rest `f_b` [m/s²] says about level: it points up, so its
    /// north and east parts are zero. Rows (north, east) `[0, 0, [f^n×], C_b^n H_a]`; the mean's own
    /// predicted error is taken out. Groves section 5.6.2 (levelling).
    pub fn observe_level(&self, f_b: &Vector3) -> (nalgebra::Vector2<f64>, SMatrix<f64, 2, N>) {
        let error = self.sensor_error();
        let c = self.c_nb();
        let f_n = c * (f_b - Vector3::new(error[3], error[4], error[5]));
        let force = skew(&f_n);
        let mut h = SMatrix::<f64, 2, N>::zeros();
        for row in 0..2 {
            for col in 0..3 {
                h[(row, 6 + col)] = force[(row, col)];
            }
            for axis in 0..3 {
                let (filter, at) = (
                    self.sensors().axis(3 + axis),
                    self.sensors().start(3 + axis),
                );
                for i in 0..filter.order {
                    h[(row, at + i)] = c[(row, axis)] * filter.h[i];
                }
            }
        }
        (f_n.xy(), h)
    }

    /// What a mean angular rate at rest `omega_b` [rad/s] says about the gyros: it is the Earth's.
    /// Rows `[0, 0, C_n^b [ω_ie×], H_g, 0]`.
    pub fn observe_earth_rate(&self, omega_b: &Vector3) -> Observation<N> {
        let error = self.sensor_error();
        let c = self.c_nb();
        let earth_n = crate::earth::earth_rate_n(self.nav().position.lat);
        let mut h = SMatrix::<f64, 3, N>::zeros();
        h.fixed_view_mut::<3, 3>(0, 6)
            .copy_from(&(c.transpose() * skew(&earth_n)));
        for axis in 0..3 {
            let (filter, at) = (self.sensors().axis(axis), self.sensors().start(axis));
            for i in 0..filter.order {
                h[(axis, at + i)] = filter.h[i];
            }
        }
        Observation {
            innovation: omega_b - Vector3::new(error[0], error[1], error[2]) - c.tr_mul(&earth_n),
            h,
            extra: Matrix3::zeros(),
        }
    }

    /// Updates with an [`Observation`] whose measurement has covariance `r`.
    pub fn update_with(
        &mut self,
        observed: &Observation<N>,
        r: &Matrix3,
    ) -> Result<Update, FilterError> {
        self.update(&observed.innovation, &observed.h, &(r + observed.extra))
    }
}
