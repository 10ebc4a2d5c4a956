//! Wheel speed.

use super::Observation;
use crate::{Vector3, filter::Filter, parameters::Parameter};
use nalgebra::{SMatrix, SVector};

impl<const N: usize> Filter<N> {
    /// Observation of a wheel `speed` [m/s, forward positive] of the wheel at `lever_b` [m, body axes, from the IMU]: it reads
    /// `(1 + s)` times the velocity along the vehicle's forward axis, s the scale factor error ([`Parameter::OdometerScale`], of tyres
    /// mostly). Row 1 of the vehicle velocity's times `1 + s`, and `−v_x` for s; innovation [m/s].
    ///
    /// ```
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// let wheel = Vector3::new(-1.2, 0.7, 0.4); // Of the rear axle, right [m].
    /// let observed = filter.observe_odometer(19.5, &wheel);
    /// assert!((observed.innovation[0] - 0.5).abs() < 1e-3); // 20 m/s forward are predicted.
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
