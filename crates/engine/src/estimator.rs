//! A filter of any size behind one set of calls, so that what drives it is compiled once.
//!
//! [`build`] picks the smallest size that holds the models' states. Replays, observers and Python use
//! [`Estimator`] only; nothing but `erased` knows the sizes.

mod erased;

use alloc::{boxed::Box, sync::Arc};
use erased::{Initial, sized};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use nalgebra::{DMatrix, DMatrixView, DVector, SMatrix};
use undrift_nav::{
    Matrix3, Quaternion, Vector3, attitude,
    covariance::{AXES, NAV, Sensors},
    earth::Geodetic,
    filter::{Each, FilterError, Gate, InitialStd, Lasting, StepError, Update},
    mechanisation::NavState,
    parameters::{Parameter, Parameters},
    sample::ImuSample,
    shaping::ShapingFilter,
};

pub use crate::aid::{Aiding, Channel};
pub use undrift_events::STAMP_ROUNDING;

/// Record of a filter's run ([`Estimator::log_to`]), one entry after the other: with it the run can be repeated under other
/// noise, as a linear filter about the solution of this one. What tuning fits noise to.
#[derive(Clone, Debug)]
pub enum Logged {
    /// Navigation began, at this time \[s\], with this covariance of the error state.
    Start(f64, DMatrix<f64>),
    /// An update was made.
    Update(Box<LoggedUpdate>),
}

/// Receiver of a filter's updates, called from wherever the filter runs.
///
/// ```
/// use std::sync::{Arc, atomic::{AtomicUsize, Ordering}};
/// use undrift_engine::{Navigator, estimator::{LogTo, Logged}, settings::Settings};
/// # use undrift_nav::shaping::ShapingFilter;
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
/// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
/// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
/// let updates = Arc::new(AtomicUsize::new(0));
/// let count = Arc::clone(&updates);
/// let log_to = LogTo::new(move |logged| {
///     if let Logged::Update(update) = logged {
///         assert_eq!(update.innovation.len(), update.h.nrows());
///         count.fetch_add(1, Ordering::Relaxed);
///     }
/// });
/// let mut navigator = Navigator::new(Settings { log: Some(log_to), ..Settings::new(sensors) });
/// for fix in &log.gnss {
///     navigator.fix(*fix)?;
/// }
/// for sample in &log.imu {
///     navigator.imu(*sample)?;
/// }
/// assert!(updates.load(Ordering::Relaxed) > 50);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct LogTo(Arc<dyn Fn(Logged) + Send + Sync>);

impl LogTo {
    /// Calls `each` with every entry, in order.
    pub fn new(each: impl Fn(Logged) + Send + Sync + 'static) -> Self {
        Self(Arc::new(each))
    }
}

impl core::fmt::Debug for LogTo {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("LogTo")
    }
}

/// An update, and the transition to it from the one before or the start. Sizes: n states of the filter, m components of the
/// measurement.
#[derive(Clone, Debug)]
pub struct LoggedUpdate {
    /// Time of the filter \[s\].
    pub time: f64,
    /// Group that the measurement belongs to.
    pub channel: Channel,
    /// Transition of the error from after the update before to before this one, n × n.
    pub transition: DMatrix<f64>,
    /// Measurement matrix H, m × n.
    pub h: DMatrix<f64>,
    /// Innovation, predicted less measured, m numbers in the measurement's unit.
    pub innovation: DVector<f64>,
    /// Covariance of the measurement before weakening, m × m.
    pub noise: DMatrix<f64>,
    /// Factor of the gate on that covariance [–]: 1 where it was used as stated.
    pub weakened: f64,
    /// Error that was removed from the solution, n numbers in the order of the error state.
    pub correction: DVector<f64>,
    /// Variance of the white noise of a sample of each axis at that time, gyro x, y, z [rad²/s²], accelerometer x, y, z [m²/s⁴].
    pub white: [f64; AXES],
}

/// Adjoint of a span of filtering, for a smoother ([`undrift_nav::tape`], with the equations): the tape of a filter of n states.
pub struct Adjoint {
    /// T, n × n: takes an error at the start of the span to what remains of it at the end.
    pub transition: DMatrix<f64>,
    /// The part of λ that the span's measurements bring, n numbers.
    pub gradient: DVector<f64>,
    /// The part of Λ that the span's measurements bring, n × n, symmetric.
    pub information: DMatrix<f64>,
}

/// Attitude of the vehicle's axes and its standard deviations about north, east, down \[rad\], from `q_nb`, the place of the mounting in
/// the error state with its estimate (pitch, yaw) where there is one, and the covariance `p(row, column)`. The mounting
/// is the vehicle's attitude against the body's as the non-holonomic constraint sees it
/// ([`undrift_nav::filter::Filter::c_bv`]), ψ + C_v^n δ its error. What no state estimates of it is known to `mounting_std` about the
/// vehicle's axes \[rad\] ([`Estimator::mounting_std`]). For whoever has a covariance without its filter, as a
/// smoother; else [`Estimator::vehicle_attitude`].
///
/// ```
/// use undrift_engine::estimator::vehicle_attitude;
/// use undrift_nav::{Quaternion, Vector3, attitude::to_rpy};
/// // The vehicle points 2° to the right of the IMU, by a mounting whose states (pitch, yaw) are 9 and 10; of its roll 0.5° is unknown.
/// let p = |i: usize, j: usize| if i == j { 1e-4 } else { 0.0 };
/// let mounted = Some((9, [0.0, 2f64.to_radians()]));
/// let unknown = Vector3::new(0.5f64.to_radians(), 0.0, 0.0);
/// let (q_nv, std) = vehicle_attitude(&Quaternion::identity(), mounted, &unknown, p);
/// assert!((to_rpy(&q_nv).z.to_degrees() - 2.0).abs() < 1e-9);
/// assert!((std[2] - 2e-4_f64.sqrt()).abs() < 1e-6); // Of the IMU's heading and of the mounting [rad].
/// assert!((std[0] - f64::hypot(0.01, unknown.x)).abs() < 1e-4); // Of the IMU's level and of the mounting's roll.
/// ```
pub fn vehicle_attitude(
    q_nb: &Quaternion,
    mounted: Option<(usize, [f64; 2])>,
    mounting_std: &Vector3,
    p: impl Fn(usize, usize) -> f64,
) -> (Quaternion, [f64; 3]) {
    let [pitch, yaw] = mounted.map_or([0.0; 2], |(_, turn)| turn);
    let q_nv = q_nb * attitude::from_rotation_vector(&Vector3::new(0.0, pitch, yaw));
    let c_vn = q_nv.to_rotation_matrix().into_inner();
    let unknown = mounting_covariance(&c_vn, mounting_std);
    let variance = |i: usize| {
        let mut sum = p(6 + i, 6 + i) + unknown[(i, i)];
        if let Some((at, _)) = mounted {
            let [a, b] = [c_vn[(i, 1)], c_vn[(i, 2)]];
            sum += a * a * p(at, at) + 2.0 * a * b * p(at, at + 1) + b * b * p(at + 1, at + 1);
            sum += 2.0 * (a * p(6 + i, at) + b * p(6 + i, at + 1));
        }
        sum.max(0.0).sqrt()
    };
    (q_nv, [0, 1, 2].map(variance))
}

/// Covariance about north, east and down \[rad²\] of what is known of a mounting to `std` about the vehicle's axes \[rad\].
pub fn mounting_covariance(c_vn: &Matrix3, std: &Vector3) -> Matrix3 {
    c_vn * Matrix3::from_diagonal(&std.component_mul(std)) * c_vn.transpose()
}

/// Below this rate \[Hz\] samples that seem early may be so: the motion between two is taken to be as the second one says.
const SLOW: f64 = 50.0;

/// The receiver's clock against the samples', as the fixes show it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReceiverClock {
    /// Time by which its stamps are earlier than the samples' \[s\].
    pub offset: f64,
    /// Standard deviation of the offset \[s\].
    pub offset_std: f64,
    /// Standard deviations of the position at a time of this clock, north, east, down \[m\]: without the doubt about the offset, which
    /// those of [`Estimator::nav_std`] contain with the speed.
    pub position_std: [f64; 3],
    /// Interval of the samples \[s\].
    pub interval: f64,
}

impl ReceiverClock {
    /// Time by which the samples seem to be late \[s\], or early where it is negative, beyond one standard deviation: data come late by
    /// filters and buffers. Fixes that come late are the receiver's delay, and the samples' clock is right; of a log below
    /// 50 Hz the samples may be early by less than an interval.
    ///
    /// ```
    /// use undrift_engine::estimator::ReceiverClock;
    /// let clock = ReceiverClock { offset: 0.08, offset_std: 0.02, position_std: [1.0; 3], interval: 0.01 };
    /// assert!((clock.lateness() - 0.06).abs() < 1e-12); // Late for sure by so much [s].
    /// // Fixes that are late do not make samples early.
    /// assert_eq!(ReceiverClock { offset: -0.08, ..clock }.lateness(), 0.0);
    /// ```
    pub fn lateness(&self) -> f64 {
        let beyond = (self.offset.abs() - self.offset_std).max(0.0);
        let is_slow = self.interval * SLOW > 1.0;
        match self.offset < 0.0 {
            true if is_slow && -self.offset < self.interval => -beyond,
            true => 0.0,
            false => beyond,
        }
    }
}

/// Standard deviations of [`ReceiverClock::position_std`] \[m\] for these parameters, the first of which is behind `behind`
/// states, of a filter that has run for `age` \[s\], at the velocity `v_n` [m/s] and the covariance `p(row, column)`. The error is
/// `δr − v (δτ + age δd)`, with the signs of the rows of a position.
pub fn position_std_on_receiver_clock(
    (parameters, behind, age): (&Parameters, usize, f64),
    v_n: &Vector3,
    p: impl Fn(usize, usize) -> f64,
) -> [f64; 3] {
    let place = |kind| Some(behind + parameters.start(kind)?);
    let [offset, rate] = [Parameter::TimeOffset, Parameter::ClockRate].map(place);
    // Covariance with the clock's error, and its variance.
    let with_clock =
        |i: usize| offset.map_or(0.0, |at| p(i, at)) + rate.map_or(0.0, |at| age * p(i, at));
    let clock = offset.map_or(0.0, with_clock) + rate.map_or(0.0, |at| age * with_clock(at));
    core::array::from_fn(|i| {
        let variance = p(i, i) + v_n[i] * (v_n[i] * clock - 2.0 * with_clock(i));
        variance.max(0.0).sqrt()
    })
}

/// An error-state filter; its methods are those of [`Filter`](undrift_nav::filter::Filter) where nothing else is said.
///
/// The error state is position δr north-east-down \[m\], velocity δv north-east-down [m/s], misalignment ψ about north, east, down
/// \[rad\], then the states of the sensors, gyro x, y, z and accelerometer x, y, z, then the parameters. The first nine are estimate
/// less truth, the sensors' states truth less estimate (docs/conventions.md, Errors).
pub trait Estimator: Send + Sync {
    /// Position, velocity and attitude of the IMU, at the filter's time.
    fn nav(&self) -> &NavState;
    /// Size of the error state in use.
    fn states(&self) -> usize;
    /// Covariance of the error state, as large as the filter's size; rows beyond [`Estimator::states`] are zero.
    fn covariance(&self) -> DMatrixView<'_, f64>;
    /// Estimated sensor states and parameters at their place in the error state; the first nine are zero.
    fn estimates(&self) -> &[f64];
    /// The sensors' shaping filters and their places in the error state.
    fn sensors(&self) -> &Sensors;
    /// The parameters that are estimated, with their priors.
    fn parameters(&self) -> &Parameters;
    /// Estimated correction of a parameter to its configured value and its standard deviations [its unit], the first
    /// [`Parameter::width`] of each; `None` where it is not estimated.
    fn parameter(&self, kind: Parameter) -> Option<([f64; 6], [f64; 6])>;
    /// Time by which positions or velocities hold later than stamped, and its standard deviation \[s\], as
    /// [`Filter::time_offset`](undrift_nav::filter::Filter::time_offset).
    fn time_offset(&self, kind: Parameter) -> Option<(f64, f64)>;
    /// Time since the filter's start \[s\].
    fn since_start(&self) -> f64;
    /// Standard deviations of position \[m\], velocity \[m/s\] and misalignment \[rad\], each north, east, down.
    fn nav_std(&self) -> [f64; NAV];
    /// Estimated errors of gyro x, y, z [rad/s] and accelerometer x, y, z [m/s²], body axes: reading less truth.
    fn sensor_error(&self) -> [f64; AXES];
    /// Standard deviations of [`Estimator::sensor_error`], without a sample's own white noise.
    fn sensor_error_std(&self) -> [f64; AXES];
    /// Angular rate of the body against the navigation frame, body axes [rad/s], from the present sample.
    fn omega_nb_b(&self) -> Vector3;
    /// Predicted position of the antenna at `lever_b` [m, body axes, from the IMU, as configured].
    fn antenna_position(&self, lever_b: &Vector3) -> Geodetic;
    /// Predicted velocity of the antenna at `lever_b` [m, body axes, from the IMU, as configured], north-east-down [m/s].
    fn antenna_velocity(&self, lever_b: &Vector3) -> Vector3;
    /// Velocity over ground of the point at `lever_b` [m, body axes, from the IMU], in vehicle axes: forward, right, down [m/s].
    fn vehicle_velocity(&self, lever_b: &Vector3) -> Vector3;
    /// Place of a parameter's first state; `None` where it is not estimated.
    fn parameter_start(&self, kind: Parameter) -> Option<usize> {
        let start = self.parameters().start(kind)?;
        Some(self.sensors().states() + start)
    }
    /// What is not known of how the IMU sits, one standard deviation about the vehicle's axes, roll, pitch, yaw \[rad\]: pitch and yaw are 0
    /// where they are states. Zero unless [`Estimator::set_mounting_std`] was called.
    fn mounting_std(&self) -> Vector3;
    /// Sets [`Estimator::mounting_std`]; of pitch and yaw that are states nothing is taken.
    fn set_mounting_std(&mut self, std: &Vector3);
    /// Makes the pitch of the mounting less certain by `nods` \[rad\] until [`Estimator::set_mounting_std`] is called.
    fn loosen(&mut self, nods: f64);
    /// Attitude of the vehicle's axes `q_nv`, and its standard deviations about north, east and down \[rad\]: the body's where
    /// the mounting is not estimated, as uncertain as that was found to be.
    fn vehicle_attitude(&self) -> (Quaternion, [f64; 3]) {
        let (q_nb, p) = (&self.nav().q_nb, self.covariance());
        let at = self.parameter_start(Parameter::Mounting);
        let mounted = at.map(|at| (at, [self.estimates()[at], self.estimates()[at + 1]]));
        vehicle_attitude(q_nb, mounted, &self.mounting_std(), |i, j| p[(i, j)])
    }
    /// The receiver's clock against the samples'; `None` where no time offset is estimated.
    fn receiver_clock(&self) -> Option<ReceiverClock> {
        let (offset, offset_std) = self.time_offset(Parameter::TimeOffset)?;
        let (sensors, p) = (self.sensors(), self.covariance());
        let parameters = (self.parameters(), sensors.states(), self.since_start());
        Some(ReceiverClock {
            offset,
            offset_std,
            position_std: position_std_on_receiver_clock(parameters, &self.nav().v_n, |i, j| {
                p[(i, j)]
            }),
            interval: sensors.axis(0).interval,
        })
    }
    /// Checks that the variances are finite and not negative and that the navigation state is possible.
    ///
    /// # Errors
    /// [`FilterError::Diverged`] where they are not.
    fn check(&self) -> Result<(), FilterError>;

    /// End of the sample taken up \[s\], while it is not done.
    fn sample_end(&self) -> Option<f64>;
    /// Start of the next sample \[s\]: the end of the one taken up, or the filter's time.
    fn reached(&self) -> f64;
    /// Whether a sample can be the next, as [`Filter::accepts_step`](undrift_nav::filter::Filter::accepts_step).
    ///
    /// # Errors
    /// [`StepError`], what is wrong with it.
    fn accepts_step(&self, sample: &ImuSample) -> Result<(), StepError>;
    /// Takes up a sample without moving yet, and without the checks of [`Estimator::accepts_step`].
    fn begin(&mut self, sample: &ImuSample);
    /// Moves to `time` \[s\] within the sample taken up; with `None` to its end.
    fn advance(&mut self, time: Option<f64>);
    /// Adds uncertainty for `duration` \[s\] without samples, one standard deviation of turn rate [rad/s] and acceleration [m/s²] each axis.
    fn inflate_over_gap(&mut self, duration: f64, rate: f64, accel: f64);
    /// Adds uncertainty to position north, east, down \[m\], velocity \[m/s\] and tilt \[rad\], one standard deviation each axis.
    fn inflate(&mut self, position: &Vector3, velocity: f64, tilt: f64);
    /// Sets the variance of the white noise of a sample from now on, gyro x, y, z [rad²/s²], accelerometer x, y, z [m²/s⁴].
    fn set_white_noise(&mut self, variance: &[f64; AXES]);
    /// Adds uncertainty to the heading \[rad\] and the error of the vertical gyro \[rad/s\], one standard deviation each.
    fn inflate_heading(&mut self, heading: f64, gyro: f64);
    /// Adds uncertainty to the time offsets of positions and velocities, the same to both \[s\], one standard deviation.
    fn inflate_time_offsets(&mut self, std: f64);
    /// Adds variance to the errors of gyro x, y, z [rad²/s²] and accelerometer x, y, z [m²/s⁴].
    fn inflate_sensor_errors(&mut self, variance: &[f64; AXES]);
    /// Adds uncertainty in the turn \[rad²\] and the change of velocity \[m²/s²\] of what was just passed, body axes.
    fn inflate_missed_motion(&mut self, turn: &Matrix3, velocity: &Matrix3);
    /// Innovation of a measurement, predicted less measured, zeros behind its components; `None`
    /// where it says nothing: a course of a vehicle that points up or down.
    fn innovation(&self, aiding: &Aiding) -> Option<Vector3>;
    /// Covariance of [`Estimator::innovation`] for a measurement of three numbers without noise of its own: `H P Hᵀ`; `None` of others.
    fn innovation_covariance(&self, aiding: &Aiding) -> Option<Matrix3>;
    /// Updates with a measurement whose covariance is the leading block of `noise`, past a gate;
    /// `None` where it says nothing.
    ///
    /// # Errors
    /// As [`Filter::update`](undrift_nav::filter::Filter::update); the filter is then as it was.
    fn update(
        &mut self,
        aiding: &Aiding,
        noise: &Matrix3,
        gate: &Gate,
    ) -> Result<Option<Update>, FilterError>;
    /// Updates with what a window of motion says: `rows` times the errors of velocity, attitude about
    /// body axes, gyro and accelerometer bias and the `delay`, a time offset, is noise of unit covariance.
    ///
    /// # Errors
    /// As [`Estimator::update`].
    fn update_window(
        &mut self,
        rows: &SMatrix<f64, 13, 13>,
        delay: Option<Parameter>,
    ) -> Result<(), FilterError>;
    /// Removes an estimated `error`, in the order of the error state; states beyond its length are taken as right.
    fn apply_correction(&mut self, error: &[f64]);
    /// Replaces the navigation state and keeps covariance and sensors' states: the end of an alignment.
    fn set_nav(&mut self, nav: NavState);
    /// Sets the estimated errors of gyro x, y, z [rad/s] and accelerometer x, y, z [m/s²]; the covariance stays.
    fn set_sensor_error(&mut self, error: &[f64; AXES]);
    /// Sets the covariance of position \[m²\] and velocity [m²/s²] to that of a fix that both were taken from, whose position and velocity
    /// have time-correlated errors of these standard deviations [m, m/s].
    fn set_position_velocity_covariance(
        &mut self,
        position: &Matrix3,
        velocity: &Matrix3,
        correlated: &[Vector3; 2],
    );

    /// Takes the navigation frame for one that does not turn with the Earth, as
    /// [`Filter::without_earth_rate`](undrift_nav::filter::Filter::without_earth_rate).
    fn without_earth_rate(&mut self);

    /// Gives each update to `log` from now on, until [`Estimator::record`] is called.
    fn log_to(&mut self, log: LogTo);
    /// Starts the recording for [`Estimator::adjoint`] afresh.
    fn record(&mut self);
    /// Adjoint of the span since [`Estimator::record`], if it was called.
    fn adjoint(&self) -> Option<Adjoint>;
    /// Calls `each` with every number that changes while the filter runs, always in the same order, as
    /// [`Filter::numbers`](undrift_nav::filter::Filter::numbers).
    fn numbers(&mut self, each: &mut Each);
    /// A copy, which records nothing and logs nowhere.
    fn boxed(&self) -> Box<dyn Estimator>;
    /// Turns the body axes by `q_vb`, as [`Filter::turn`](undrift_nav::filter::Filter::turn).
    fn turn(&mut self, q_vb: &Quaternion);
    /// Makes a parameter unknown again, with the standard deviation `std` [its unit], as [`Filter::renew`](undrift_nav::filter::Filter::renew).
    fn renew(&mut self, kind: Parameter, std: f64);
    /// Takes the errors of heading and hard iron for independent of all others, as
    /// [`Filter::isolate_heading`](undrift_nav::filter::Filter::isolate_heading).
    fn isolate_heading(&mut self);
    /// A copy, which records nothing and from now on estimates the lasting errors of position and velocity as given.
    ///
    /// # Errors
    /// As [`Filter::with_lasting`](undrift_nav::filter::Filter::with_lasting).
    fn with_lasting(
        &self,
        lasting: &[Option<Lasting>; 2],
    ) -> Result<Box<dyn Estimator>, FilterError>;
}

/// A filter of the smallest size that holds the states of `sensors` and `parameters`, at `nav` with the uncertainty `std`, as
/// [`Filter::new`](undrift_nav::filter::Filter::new).
///
/// ```
/// use undrift_engine::estimator::{Aiding, build};
/// use undrift_nav::{Matrix3, Quaternion, Vector3, earth::Geodetic, mechanisation::NavState, sample::{ImuSample, Position}};
/// use undrift_nav::{filter::{Gate, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
/// let here = Geodetic::from_degrees(47.0, 8.0, 400.0);
/// let nav = NavState { time: 0.0, position: here, v_n: Vector3::zeros(), q_nb: Quaternion::identity() };
/// let std = InitialStd { position: Vector3::repeat(5.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
/// let mut filter = build(nav, &std, &[ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
/// filter.begin(&ImuSample::from_rates(0.01, 0.01, [0.0; 3], [0.0, 0.0, -9.81]));
/// filter.advance(None);
/// let position = Aiding::Position {
///     position: Position::Geodetic(here),
///     lever_arm: Vector3::zeros(),
///     correlated: Vector3::zeros(),
///     due: 0.01,
/// };
/// let update = filter.update(&position, &Matrix3::identity(), &Gate::OPEN)?.expect("a position says something");
/// assert!(update.dof == 3 && filter.nav_std()[0] < 1.0); // [m]
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`Filter::new`](undrift_nav::filter::Filter::new).
pub fn build(
    nav: NavState,
    std: &InitialStd,
    sensors: &[ShapingFilter; AXES],
    parameters: Parameters,
) -> Result<Box<dyn Estimator>, FilterError> {
    let behind: usize = sensors.iter().map(|axis| axis.order).sum();
    let start = Initial::New(nav, std, sensors, parameters);
    sized(NAV + behind + parameters.states(), start)
}

#[cfg(test)]
mod tests;
