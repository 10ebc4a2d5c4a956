//! Wheel speed.

use super::Observation;
use crate::{Vector3, filter::Filter, parameters::Parameter};
use nalgebra::{SMatrix, SVector};

impl<const N: usize> Filter<N> {
    /// Observation of a wheel `speed` [m/s, forward positive] of the wheel at `lever_b` [m, body axes, from the IMU]: it reads
    /// `(1 + s)` times the velocity along the vehicle's forward axis, s the scale factor error ([`Parameter::OdometerScale`], of tyres
    /// mostly). Row 1 of the vehicle velocity's times `1 + s`, and `−v_x` for s; innovation [m/s].
    pub fn observe_odometer(&self, speed: f64, lever_b: &Vector3) -> Observation<1, N> {
        let (rows, white) = self.vehicle_velocity_rows(lever_b);
        let forward = self.vehicle_velocity(lever_b).x;
        let gain = 1.0
            + self
                .parameter(Parameter::OdometerScale)
                .map_or(0.0, |(s, _)| s[0]);
        let mut h: SMatrix<f64, 1, N> = rows.fixed_rows::<1>(0) * gain;
        if let Some(at) = self.parameter_start(Parameter::OdometerScale) {
            h[(0, at)] = -forward;
        }
        Observation {
            innovation: SVector::<f64, 1>::new(gain * forward - speed),
            h,
            extra: SMatrix::<f64, 1, 1>::new(gain * gain * white[(0, 0)]),
        }
    }
}
