//! The error-state Kalman filter: nine navigation errors and the states of six shaping filters.
//!
//! Closed loop: after every update the estimated error is taken out of the navigation state and
//! added to the sensors' states, so between updates the error's mean is zero. Groves 2013,
//! chapters 3 and 14. Navigation errors are estimate less truth; sensor states are what the
//! prediction still misses (truth less estimate), as in `docs/conventions.md`.

use crate::{
    Matrix3, Vector3,
    covariance::{AXES, NAV, Part, Sensors, Transition},
    mechanisation::{Increments, NavState, RawIncrements},
    sample::ImuSample,
    shaping::ShapingFilter,
};
use core::fmt;
use nalgebra::{SMatrix, SVector};

/// One standard deviation of the navigation state before the first sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialStd {
    /// Position north, east, down [m].
    pub position: Vector3,
    /// Velocity north, east, down [m/s].
    pub velocity: Vector3,
    /// Misalignment about north, east, down [rad].
    pub attitude: Vector3,
}

/// What an update did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Update {
    /// Normalised innovation squared `νᵀ S⁻¹ ν`; chi-squared with `dof` degrees of freedom when
    /// the model is right. Bar-Shalom, Li & Kirubarajan section 5.4.
    pub nis: f64,
    /// Number of scalar measurements.
    pub dof: usize,
}

/// Why the filter refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilterError {
    /// The models need more states than the filter was built for.
    TooManyStates {
        /// States needed.
        needed: usize,
        /// States there are.
        capacity: usize,
    },
    /// The innovation's covariance is not positive: the measurement's covariance is zero or not a covariance.
    BadMeasurement,
    /// A number is not finite, or the position, speed or latitude left the range a solution can have.
    Diverged,
}

impl fmt::Display for FilterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooManyStates { needed, capacity } => {
                write!(
                    f,
                    "the noise models need {needed} states, the filter holds {capacity}"
                )
            }
            Self::BadMeasurement => {
                f.write_str("the measurement's covariance is not positive definite")
            }
            Self::Diverged => f.write_str(
                "the solution diverged: position, velocity or covariance left the possible range",
            ),
        }
    }
}

impl core::error::Error for FilterError {}

/// The filter; `N` is the most states it can hold, 9 for navigation and the rest for the sensors.
#[derive(Clone, Debug)]
pub struct Filter<const N: usize> {
    nav: NavState,
    sensors: Sensors,
    /// Estimated sensor states, at their place in the error state; the first nine stay zero.
    x: [f64; N],
    p: SMatrix<f64, N, N>,
    c_nb: Matrix3,
    previous: Option<RawIncrements>,
    /// The present sample, its predicted error removed, and how much of it is done.
    current: Option<(Increments, f64)>,
    /// Where the present sample ends [s].
    end: f64,
    /// Angular rate ω_ib^b of the present sample, its predicted error removed [rad/s].
    omega_ib_b: Vector3,
}

impl<const N: usize> Filter<N> {
    /// Starts at `nav` with the given uncertainty; `sensors` in the order gyro x, y, z,
    /// accelerometer x, y, z.
    pub fn new(
        nav: NavState,
        std: &InitialStd,
        sensors: [ShapingFilter; AXES],
    ) -> Result<Self, FilterError> {
        let sensors = Sensors::new(sensors);
        if sensors.states() > N {
            return Err(FilterError::TooManyStates {
                needed: sensors.states(),
                capacity: N,
            });
        }
        if !nav.is_valid() {
            return Err(FilterError::Diverged);
        }
        let mut p = SMatrix::<f64, N, N>::zeros();
        for i in 0..3 {
            p[(i, i)] = std.position[i] * std.position[i];
            p[(3 + i, 3 + i)] = std.velocity[i] * std.velocity[i];
            p[(6 + i, 6 + i)] = std.attitude[i] * std.attitude[i];
        }
        for axis in 0..AXES {
            let (filter, at) = (sensors.axis(axis), sensors.start(axis));
            for i in 0..filter.order {
                for j in 0..filter.order {
                    p[(at + i, at + j)] = filter.p0[i][j];
                }
            }
        }
        Ok(Self {
            nav,
            sensors,
            x: [0.0; N],
            p,
            c_nb: nav.q_nb.to_rotation_matrix().into_inner(),
            previous: None,
            current: None,
            end: nav.time,
            omega_ib_b: Vector3::zeros(),
        })
    }

    /// Position, velocity and attitude of the IMU.
    pub fn nav(&self) -> &NavState {
        &self.nav
    }

    /// Covariance of the error state; rows beyond [`Filter::states`] are zero.
    pub fn covariance(&self) -> &SMatrix<f64, N, N> {
        &self.p
    }

    /// Size of the error state in use.
    pub fn states(&self) -> usize {
        self.sensors.states()
    }

    /// The sensors' shaping filters and their places in the error state.
    pub fn sensors(&self) -> &Sensors {
        &self.sensors
    }

    /// Rotation matrix C_b^n.
    pub fn c_nb(&self) -> &Matrix3 {
        &self.c_nb
    }

    /// Angular rate of the body ω_ib^b [rad/s], the last sample's less its predicted error.
    pub fn omega_ib_b(&self) -> Vector3 {
        self.omega_ib_b
    }

    /// Angular rate of the body against the navigation frame ω_nb^b [rad/s], from the last sample.
    pub fn omega_nb_b(&self) -> Vector3 {
        let earth = crate::earth::LocalEarth::at(&self.nav.position);
        let omega_in = earth.earth_rate() + earth.transport_rate(&self.nav.v_n);
        self.omega_ib_b - self.c_nb.tr_mul(&omega_in)
    }

    /// Standard deviations of `[δr; δv; ψ]` [m, m/s, rad].
    pub fn nav_std(&self) -> [f64; NAV] {
        core::array::from_fn(|i| libm::sqrt(self.p[(i, i)].max(0.0)))
    }

    /// Estimated sensor errors, gyro x, y, z [rad/s] and accelerometer x, y, z [m/s²]: what is
    /// subtracted from the next sample.
    pub fn sensor_error(&self) -> [f64; AXES] {
        self.sensors.predicted_error(&self.x)
    }

    /// Standard deviations of [`Filter::sensor_error`], without the sample's own white noise.
    pub fn sensor_error_std(&self) -> [f64; AXES] {
        core::array::from_fn(|axis| {
            let (filter, at) = (self.sensors.axis(axis), self.sensors.start(axis));
            let mut variance = 0.0;
            for i in 0..filter.order {
                for j in 0..filter.order {
                    variance += filter.h[i] * filter.h[j] * self.p[(at + i, at + j)];
                }
            }
            libm::sqrt(variance.max(0.0))
        })
    }

    /// Carries the filter over one whole sample.
    pub fn predict(&mut self, sample: &ImuSample) {
        self.begin(sample);
        self.advance(1.0);
    }

    /// Takes up a sample without moving yet; [`Filter::advance`] then moves through its interval in
    /// one or more parts, with updates between them where a fix falls inside.
    pub fn begin(&mut self, sample: &ImuSample) {
        let error = self.sensors.predicted_error(&self.x);
        let gyro = Vector3::new(error[0], error[1], error[2]);
        let accel = Vector3::new(error[3], error[4], error[5]);
        let raw = RawIncrements {
            dt: sample.dt,
            dtheta: sample.dtheta - gyro * sample.dt,
            dvel: sample.dvel - accel * sample.dt,
        };
        let increments = Increments::from_raw(raw.dt, raw.dtheta, raw.dvel, self.previous.as_ref());
        self.omega_ib_b = raw.dtheta / raw.dt;
        self.previous = Some(raw);
        self.current = Some((increments, 0.0));
        self.end = sample.time;
    }

    /// Moves to the fraction `to` (0…1) of the sample taken up; does nothing if already there.
    pub fn advance(&mut self, to: f64) {
        let Some((increments, done)) = self.current else {
            return;
        };
        let to = to.min(1.0);
        let last = to >= 1.0;
        if to > done {
            let part = increments.part(to - done);
            let c_start = self.c_nb;
            let step = self.nav.step(&part);
            self.c_nb = self.nav.q_nb.to_rotation_matrix().into_inner();
            let transition = Transition::new(&step, &((c_start + self.c_nb) * 0.5));
            let part = if last { Part::Last } else { Part::Inner };
            self.sensors
                .propagate(&mut self.p.data.0, &transition, step.dt, part);
        }
        if last {
            self.sensors.step_mean(&mut self.x);
            self.current = None;
            // The sum of many intervals would round away from the stamps.
            self.nav.time = self.end;
        } else {
            self.current = Some((increments, to));
        }
    }

    /// Moves to `time` [s] within the sample taken up; a time within `rounding` [s] of its end is
    /// the end.
    pub fn advance_to(&mut self, time: f64, rounding: f64) {
        let end = self.end;
        let Some((increments, done)) = self.current else {
            return;
        };
        if end - time <= rounding {
            self.advance(1.0);
        } else {
            let to = 1.0 - (end - time) / increments.dt;
            if (to - done) * increments.dt > rounding {
                self.advance(to);
            }
        }
    }

    /// Puts the navigation state elsewhere (another time, place, attitude), keeping the
    /// covariance and the sensors' states: the end of an alignment.
    pub fn set_nav(&mut self, nav: NavState) {
        self.nav = nav;
        self.c_nb = nav.q_nb.to_rotation_matrix().into_inner();
        self.previous = None;
        self.current = None;
    }

    /// Sets the estimated sensor errors, gyro x, y, z [rad/s] and accelerometer x, y, z [m/s²], by the
    /// states' mean given that error under their present covariance; the covariance stays.
    pub fn set_sensor_error(&mut self, error: &[f64; AXES]) {
        for axis in 0..AXES {
            let (filter, at) = (self.sensors.axis(axis), self.sensors.start(axis));
            let mut ph = [0.0; crate::shaping::MAX_ORDER];
            let mut variance = 0.0;
            for i in 0..filter.order {
                for j in 0..filter.order {
                    ph[i] += self.p[(at + i, at + j)] * filter.h[j];
                }
                variance += filter.h[i] * ph[i];
            }
            if variance > 0.0 {
                for i in 0..filter.order {
                    self.x[at + i] = ph[i] * error[axis] / variance;
                }
            }
        }
    }

    /// Sets the covariance of position and velocity [m², (m/s)²], north-east-down, free of
    /// correlation with all else.
    pub fn set_position_velocity_covariance(&mut self, position: &Matrix3, velocity: &Matrix3) {
        for i in 0..6 {
            for j in 0..N {
                self.p[(i, j)] = 0.0;
                self.p[(j, i)] = 0.0;
            }
        }
        self.p.fixed_view_mut::<3, 3>(0, 0).copy_from(position);
        self.p.fixed_view_mut::<3, 3>(3, 3).copy_from(velocity);
    }

    /// Adds uncertainty for `duration` seconds without samples in which the body may have turned
    /// with `rate` [rad/s] and accelerated with `accel` [m/s²] (one standard deviation each axis).
    pub fn grow(&mut self, duration: f64, rate: f64, accel: f64) {
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

    /// Kalman update with innovation `z` = predicted less measured, `z = h·error + noise`, noise
    /// covariance `r`. Joseph's form, in two rank-M passes.
    pub fn update<const M: usize>(
        &mut self,
        z: &SVector<f64, M>,
        h: &SMatrix<f64, M, N>,
        r: &SMatrix<f64, M, M>,
    ) -> Result<Update, FilterError> {
        let pht = self.p * h.transpose();
        let s = h * pht + r;
        let factor = nalgebra::Cholesky::new(s).ok_or(FilterError::BadMeasurement)?;
        let gain = factor.solve(&pht.transpose()).transpose();
        let nis = (z.transpose() * factor.solve(z))[(0, 0)];
        if !nis.is_finite() {
            return Err(FilterError::BadMeasurement);
        }

        // (I − K H) P (I − K H)ᵀ + K R Kᵀ
        let mut p = self.p - gain * pht.transpose();
        p -= (p * h.transpose()) * gain.transpose();
        p += gain * r * gain.transpose();
        for i in 0..N {
            for j in 0..i {
                let mean = 0.5 * (p[(i, j)] + p[(j, i)]);
                p[(i, j)] = mean;
                p[(j, i)] = mean;
            }
        }
        self.p = p;
        self.take_out(&(gain * z));
        Ok(Update { nis, dof: M })
    }

    /// Takes an estimated error out of the navigation state and adds it to the sensors' states.
    fn take_out(&mut self, error: &SVector<f64, N>) {
        let part = |at: usize| Vector3::new(error[at], error[at + 1], error[at + 2]);
        self.nav = self.nav.without_error(&part(0), &part(3), &part(6));
        self.reset_attitude(&part(6));
        self.c_nb = self.nav.q_nb.to_rotation_matrix().into_inner();
        let before = self.sensors.predicted_error(&self.x);
        for i in NAV..N {
            self.x[i] += error[i];
        }
        // The rate, and what is left of the present sample, follow the new estimate.
        let after = self.sensors.predicted_error(&self.x);
        let change: [f64; AXES] = core::array::from_fn(|i| after[i] - before[i]);
        let gyro = Vector3::new(change[0], change[1], change[2]);
        let accel = Vector3::new(change[3], change[4], change[5]);
        self.omega_ib_b -= gyro;
        if let Some((increments, _)) = &mut self.current {
            increments.rotation -= gyro * increments.dt;
            increments.dvel -= accel * increments.dt;
        }
    }

    /// Moves the misalignment's covariance to the corrected attitude: after a turn by δ the error
    /// that is left, e, becomes e + ½ δ × e. It matters while the heading is far less certain than
    /// the level. Markley & Crassidis 2014, section 6.2.
    fn reset_attitude(&mut self, delta: &Vector3) {
        let cross = |v: Vector3| v + delta.cross(&v) * 0.5;
        for j in 0..N {
            let column = cross(Vector3::new(self.p[(6, j)], self.p[(7, j)], self.p[(8, j)]));
            for i in 0..3 {
                self.p[(6 + i, j)] = column[i];
            }
        }
        for i in 0..N {
            let row = cross(Vector3::new(self.p[(i, 6)], self.p[(i, 7)], self.p[(i, 8)]));
            for j in 0..3 {
                self.p[(i, 6 + j)] = row[j];
            }
        }
        for (i, j) in [(6, 7), (6, 8), (7, 8)] {
            self.p[(i, j)] = self.p[(j, i)];
        }
    }

    /// Whether the solution is still one: finite, possible, with a covariance that is not negative
    /// on its diagonal.
    pub fn check(&self) -> Result<(), FilterError> {
        let diagonal_ok = (0..N).all(|i| self.p[(i, i)] >= 0.0 && self.p[(i, i)].is_finite());
        if diagonal_ok && self.nav.is_valid() {
            Ok(())
        } else {
            Err(FilterError::Diverged)
        }
    }
}
