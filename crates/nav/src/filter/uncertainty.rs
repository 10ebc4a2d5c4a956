//! Uncertainty that is set or added from outside of the model: starts, gaps, contradicted solutions.

use super::Filter;
use crate::{Matrix3, Vector3, covariance::AXES, parameters::Parameter};

/// What a vehicle accelerates at its start [m/s²], one standard deviation.
const START_ACCEL: f64 = 2.0;

impl<const N: usize> Filter<N> {
    /// Sets the covariance of position \[m²\] and velocity \[m²/s²\], north-east-down, to that of a fix that they
    /// were taken from: free of correlation with all else but the lever arm and the time offset, where
    /// these are estimated. A start taken from a fix that holds `τ` later is `v τ` ahead, and its
    /// velocity off by what the vehicle accelerates meanwhile.
    pub fn set_position_velocity_covariance(&mut self, position: &Matrix3, velocity: &Matrix3) {
        for i in 0..6 {
            for j in 0..N {
                self.p[(i, j)] = 0.0;
                self.p[(j, i)] = 0.0;
            }
        }
        self.p.fixed_view_mut::<3, 3>(0, 0).copy_from(position);
        self.p.fixed_view_mut::<3, 3>(3, 3).copy_from(velocity);
        if let Some(at) = self.parameter_start(Parameter::LeverArm) {
            let across = self.c_nb * self.p.fixed_view::<3, 3>(at, at);
            let mut own = self.p.fixed_view_mut::<3, 3>(0, 0);
            own += across * self.c_nb.transpose();
            self.p.fixed_view_mut::<3, 3>(0, at).copy_from(&across);
            let across = across.transpose();
            self.p.fixed_view_mut::<3, 3>(at, 0).copy_from(&across);
        }
        if let Some(at) = self.parameter_start(Parameter::TimeOffset) {
            let variance = self.p[(at, at)];
            let v = self.nav.v_n;
            for i in 0..3 {
                for j in 0..3 {
                    self.p[(i, j)] += v[i] * v[j] * variance;
                }
                self.p[(i, at)] = v[i] * variance;
                self.p[(at, i)] = v[i] * variance;
            }
        }
        let offset = self.parameter_start(Parameter::VelocityTimeOffset);
        if let Some(at) = offset.or(self.parameter_start(Parameter::TimeOffset)) {
            for i in 3..6 {
                self.p[(i, i)] += START_ACCEL * START_ACCEL * self.p[(at, at)];
            }
        }
    }

    /// States that position and velocity were taken from a fix whose errors have time-correlated parts: the solution then has those
    /// errors, too. Of position and velocity the `stated` covariance, with which [`Filter::set_position_velocity_covariance`] was
    /// called before [m², m²/s²], and the standard deviations `std` of the correlated parts north, east, down [m, m/s]. It does
    /// nothing where [`Parameter::PositionError`] and [`Parameter::VelocityError`] are not estimated.
    ///
    /// The correlated parts of the axes are independent: of a stated correlation between axes the white parts' share is left, or
    /// the covariance of axes and parts together would not be positive definite.
    pub fn correlate_with_fix_errors(&mut self, stated: [&Matrix3; 2], std: [&Vector3; 2]) {
        let kinds = [Parameter::PositionError, Parameter::VelocityError];
        for (k, (kind, (stated, std))) in kinds
            .into_iter()
            .zip(stated.into_iter().zip(std))
            .enumerate()
        {
            let Some(at) = self.parameter_start(kind) else {
                continue;
            };
            let white: [f64; 3] = core::array::from_fn(|i| {
                let lasting = std[i] * std[i] * self.p[(at + i, at + i)];
                libm::sqrt((1.0 - lasting / stated[(i, i)]).max(0.0))
            });
            for i in 0..3 {
                for j in (0..3).filter(|j| *j != i) {
                    self.p[(3 * k + i, 3 * k + j)] += (white[i] * white[j] - 1.0) * stated[(i, j)];
                }
                let across = std[i] * self.p[(at + i, at + i)];
                self.p[(3 * k + i, at + i)] = across;
                self.p[(at + i, 3 * k + i)] = across;
            }
        }
    }

    /// Adds uncertainty to position [m, north-east-down], velocity [m/s] and tilt \[rad\], one standard deviation each axis:
    /// for a solution that fixes have contradicted for a while. The heading stays as certain as it was
    /// ([`Filter::inflate_heading`]).
    ///
    /// ```
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let mut filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// filter.inflate(&Vector3::new(3.0, 4.0, 0.0), 0.0, 0.02);
    /// let std = filter.nav_std();
    /// assert!((std[0] - 10f64.sqrt()).abs() < 1e-12, "1 m and 3 m, in squares");
    /// assert_eq!((std[2], std[8]), (1.0, 0.01)); // Down and heading as they were.
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn inflate(&mut self, position: &Vector3, velocity: f64, tilt: f64) {
        for i in 0..3 {
            self.p[(i, i)] += position[i] * position[i];
            self.p[(3 + i, 3 + i)] += velocity * velocity;
        }
        for i in 6..8 {
            self.p[(i, i)] += tilt * tilt;
        }
    }

    /// Adds uncertainty to the heading \[rad\] and to the error of the gyro whose axis is next to the vertical [rad/s], one standard
    /// deviation each: for a heading that the course over ground contradicts. The gyro's part enters as in
    /// [`Filter::inflate_sensor_errors`].
    pub fn inflate_heading(&mut self, heading: f64, gyro: f64) {
        self.p[(8, 8)] += heading * heading;
        let upright = |axis: &usize| self.c_nb[(2, *axis)].abs();
        let vertical = (0..3).max_by(|a, b| upright(a).total_cmp(&upright(b)));
        let mut variance = [0.0; AXES];
        if let Some(axis) = vertical {
            variance[axis] = gyro * gyro;
        }
        self.inflate_sensor_errors(&variance);
    }

    /// Adds uncertainty to the time offsets of positions and velocities, the same to both \[s\], one standard deviation: for stamps
    /// whose delay has changed. Without effect where none is estimated.
    pub fn inflate_time_offsets(&mut self, std: f64) {
        let kinds = [Parameter::TimeOffset, Parameter::VelocityTimeOffset];
        let places = kinds.map(|kind| self.parameter_start(kind));
        for i in places.into_iter().flatten() {
            for j in places.into_iter().flatten() {
                self.p[(i, j)] += std * std;
            }
        }
    }

    /// Adds variance to the errors of the sensors, gyro x, y, z [rad²/s²] and accelerometer x, y, z [m²/s⁴]: for a bias that
    /// is no longer what it was. It enters by the state that lasts longest, since another one would take back what it has learned of
    /// an error that stays; an axis without states keeps its error.
    ///
    /// ```
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::zeros(), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// let sensor = ShapingFilter::constant(3e-3, 0.01)?;
    /// let mut filter = Filter::<15>::new(nav, &std, [sensor; 6], Parameters::none())?;
    /// filter.inflate_sensor_errors(&[16e-6, 0.0, 0.0, 0.0, 0.0, 0.0]);
    /// let std = filter.sensor_error_std();
    /// assert!((std[0] - 5e-3).abs() < 1e-12 && (std[1] - 3e-3).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn inflate_sensor_errors(&mut self, variance: &[f64; AXES]) {
        for (axis, variance) in variance.iter().enumerate() {
            let (sensor, at) = (self.sensors.axis(axis), self.sensors.start(axis));
            let seen = (0..sensor.order).filter(|i| sensor.h[*i] != 0.0);
            let longest = seen.max_by(|a, b| sensor.f[*a][*a].total_cmp(&sensor.f[*b][*b]));
            if let Some(i) = longest {
                self.p[(at + i, at + i)] += variance / (sensor.h[i] * sensor.h[i]);
            }
        }
    }

    /// Adds uncertainty for `duration` \[s\] without samples in which the body may have turned with `rate` [rad/s] and accelerated with
    /// `accel` [m/s²], one standard deviation each axis: angle `rate · T`, velocity `accel · T`, position `½ accel · T²`, the last two
    /// fully correlated. The next sample has no coning or sculling with the one before the gap.
    ///
    /// ```
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::zeros(), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::zeros(), velocity: Vector3::zeros(), attitude: Vector3::zeros() };
    /// # let mut filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// // Four seconds in which the vehicle may have braked with 2 m/s² and turned with 0.2 rad/s.
    /// filter.inflate_over_gap(4.0, 0.2, 2.0);
    /// let std = filter.nav_std();
    /// assert_eq!((std[0], std[3]), (16.0, 8.0)); // [m], [m/s]
    /// assert!((std[8] - 0.8).abs() < 1e-12); // [rad]
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn inflate_over_gap(&mut self, duration: f64, rate: f64, accel: f64) {
        let (v, a) = (accel * duration, rate * duration);
        let r = 0.5 * v * duration;
        for i in 0..3 {
            self.p[(i, i)] += r * r;
            self.p[(3 + i, 3 + i)] += v * v;
            self.p[(i, 3 + i)] += r * v;
            self.p[(3 + i, i)] += r * v;
            self.p[(6 + i, 6 + i)] += a * a;
        }
        self.previous = None;
    }

    /// Adds the covariance of a turn \[rad²\] and of a change of velocity \[m²/s²\], body axes, that the samples just
    /// passed may have missed.
    pub fn inflate_missed_motion(&mut self, turn: &Matrix3, velocity: &Matrix3) {
        for (at, covariance) in [(3, velocity), (6, turn)] {
            let turned = self.c_nb * covariance * self.c_nb.transpose();
            let mut own = self.p.fixed_view_mut::<3, 3>(at, at);
            own += turned;
        }
    }
}
