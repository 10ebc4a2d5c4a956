//! Motion through the air: rotors are dragged by it, wings keep a velocity through it.

use super::Observation;
use crate::{Matrix3, Vector3, attitude::skew, filter::Filter, parameters::Parameter};
use nalgebra::SMatrix;

impl<const N: usize> Filter<N> {
    /// Velocity through the air beyond that in trim, body axes [m/s]: `C_n^b (v − w) − u`, with the wind w
    /// ([`Parameter::Wind`]) and the velocity in trim u ([`Parameter::TrimVelocity`]), each zero where it is not estimated.
    ///
    /// ```
    /// use undrift_nav::parameters::{Parameter, Parameters, Prior};
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// let estimated = Parameters::none().with(Parameter::Wind, Prior::constant(8.0));
    /// let filter = Filter::<11>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], estimated)?;
    /// assert_eq!(filter.air_velocity(), filter.nav().v_n); // It points north, and of wind nothing is known yet.
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn air_velocity(&self) -> Vector3 {
        let through_air = self.c_nb().tr_mul(&self.through_air());
        match self.parameter(Parameter::TrimVelocity) {
            Some((u, _)) => through_air - Vector3::new(u[0], u[1], u[2]),
            None => through_air,
        }
    }

    /// Velocity through the air, north, east, down [m/s].
    fn through_air(&self) -> Vector3 {
        let wind = self.parameter(Parameter::Wind);
        self.nav().v_n - wind.map_or(Vector3::zeros(), |(w, _)| Vector3::new(w[0], w[1], 0.0))
    }

    /// Derivative of [`Filter::air_velocity`] by the error state: `[0, C_n^b, −C_n^b [(v − w)×], …, C_n^b (north, east), 1]`,
    /// the last two for wind and trim.
    fn air_velocity_rows(&self) -> SMatrix<f64, 3, N> {
        let c_bn = self.c_nb().transpose();
        let mut h = SMatrix::<f64, 3, N>::zeros();
        h.fixed_view_mut::<3, 3>(0, 3).copy_from(&c_bn);
        h.fixed_view_mut::<3, 3>(0, 6)
            .copy_from(&(-c_bn * skew(&self.through_air())));
        if let Some(at) = self.parameter_start(Parameter::Wind) {
            h.fixed_view_mut::<3, 2>(0, at)
                .copy_from(&c_bn.fixed_columns::<2>(0));
        }
        if let Some(at) = self.parameter_start(Parameter::TrimVelocity) {
            h.fixed_view_mut::<3, 3>(0, at).fill_with_identity();
        }
        h
    }

    /// Observation that an aircraft keeps its velocity through the air in its own axes: [`Filter::air_velocity`] is zero, [m/s]. It
    /// flies where it points, neither sideways nor faster than a moment ago, in any wind.
    ///
    /// The covariance of the update is what angles of attack and side slip, throttle and gusts make of it.
    pub fn observe_air_velocity(&self) -> Observation<3, N> {
        Observation {
            innovation: self.air_velocity(),
            h: self.air_velocity_rows(),
            extra: SMatrix::zeros(),
        }
    }

    /// Observation of the drag of rotors by the mean specific force `f_b` as the accelerometers read it [m/s², body axes, z along the
    /// thrust]: across the thrust it is `−(k₀ + k) (C_n^b (v − w) − u)`, with the drag k₀ over mass as configured [1/s] and k its
    /// correction ([`Parameter::RotorDrag`]); two components, x and y. Martin & Salaün 2010; Leishman et al. 2014.
    ///
    /// The rows are `−(k₀ + k)` times those of the air's velocity, `−H_a` for the accelerometers' errors, and the
    /// velocity itself for k. The product of the errors of k and of the velocity, which no row has, is in `extra`.
    pub fn observe_rotor_drag(&self, f_b: &Vector3, drag: f64) -> Observation<2, N> {
        let k = drag
            + self
                .parameter(Parameter::RotorDrag)
                .map_or(0.0, |(k, _)| k[0]);
        let velocity = self.air_velocity();
        let rows = self.air_velocity_rows();
        let mut all: SMatrix<f64, 3, N> = rows * -k;
        for axis in 0..3 {
            self.error_columns(
                &mut all,
                3 + axis,
                &-Vector3::ith(axis, 1.0),
                self.coupling(),
            );
        }
        let mut h: SMatrix<f64, 2, N> = all.fixed_rows::<2>(0).into();
        let mut extra = SMatrix::zeros();
        if let Some(at) = self.parameter_start(Parameter::RotorDrag) {
            h.fixed_view_mut::<2, 1>(0, at).copy_from(&velocity.xy());
            let known: Matrix3 = rows * self.covariance() * rows.transpose();
            extra = known.fixed_view::<2, 2>(0, 0) * self.covariance()[(at, at)];
        }
        let error = self
            .sensors()
            .predicted_error(self.estimates(), self.coupling());
        let accel = Vector3::new(error[3], error[4], error[5]);
        Observation {
            innovation: (velocity * -k + accel - f_b).xy(),
            h,
            extra,
        }
    }
}
