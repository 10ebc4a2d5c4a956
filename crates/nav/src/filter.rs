//! The error-state Kalman filter: nine navigation errors, the states of six shaping filters, and
//! the parameters asked for.
//!
//! Closed loop: after every update the estimated error is taken out of the navigation state and
//! added to the sensors' states, so between updates the error's mean is zero. Groves 2013,
//! chapters 3 and 14. Navigation errors are estimate less truth; sensor states are what the
//! prediction still misses (truth less estimate), as in `docs/conventions.md`.

mod lasting;
mod numbers;
mod step;
mod turned;

pub use lasting::{Carried, Lasting};
pub use numbers::Each;
pub use step::{LONGEST_STEP, StepError};

use crate::{
    Matrix3, Vector3,
    covariance::{AXES, NAV, Part, Sensors, Transition},
    mechanisation::{Increments, NavState, RawIncrements},
    observation::Observation,
    parameters::{Coupling, Parameter, Parameters},
    sample::ImuSample,
    shaping::{MAX_ORDER, ShapingFilter},
    tape::{Tape, turn_rows},
};
use core::fmt;
use nalgebra::{SMatrix, SVector};

/// One standard deviation of the navigation state before the first sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialStd {
    /// Position north, east, down \[m\].
    pub position: Vector3,
    /// Velocity north, east, down [m/s].
    pub velocity: Vector3,
    /// Misalignment about north, east, down \[rad\].
    pub attitude: Vector3,
}

/// What an update did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Update {
    /// Normalised innovation squared `νᵀ S⁻¹ ν`, of the measurement at its stated covariance;
    /// chi-squared with `dof` degrees of freedom when the model is right. Bar-Shalom, Li &
    /// Kirubarajan section 5.4.
    pub nis: f64,
    /// Number of scalar measurements.
    pub dof: usize,
    /// The first three of the whitened innovation `L⁻¹ ν`, S = L Lᵀ: as many as there are measurements
    /// are independent and standard normal when the model is right.
    pub whitened: [f64; 3],
    /// Derivative of the log-likelihood by the logarithm of a common factor on the measurement's
    /// covariance R: `½ (νᵀ S⁻¹ R S⁻¹ ν − tr S⁻¹ R)`. On average zero when R is right.
    pub score: f64,
    /// Variance of the score when the model is right, what it tells of that factor: `½ tr (S⁻¹ R)²`.
    pub information: f64,
    /// Whether it was used, down-weighted or rejected.
    pub outcome: Outcome,
}

/// What a [`Gate`] made of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// Used as it was.
    Used,
    /// Used with its covariance multiplied by this factor.
    Weakened(f64),
    /// Not used.
    Rejected,
}

impl Outcome {
    /// Factor on the measurement's covariance: 1 of one used as it was, above 1 of one down-weighted, infinite of one
    /// rejected, which counts as if it had not been made.
    pub fn factor(self) -> f64 {
        match self {
            Self::Used => 1.0,
            Self::Weakened(factor) => factor,
            Self::Rejected => f64::INFINITY,
        }
    }

    /// "used", "weakened" or "rejected".
    pub fn name(self) -> &'static str {
        match self {
            Self::Used => "used",
            Self::Weakened(_) => "weakened",
            Self::Rejected => "rejected",
        }
    }
}

/// Limits of the normalised innovation squared. Up to `weaken` a measurement is used as it is;
/// above, its covariance grows in proportion to how far it is above; above `reject` it is not used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gate {
    /// NIS from which the covariance is enlarged, to NIS/limit times itself (Huber's weights; Zhang 1997).
    pub weaken: f64,
    /// NIS from which the measurement is left out.
    pub reject: f64,
}

impl Gate {
    /// Everything passes.
    pub const OPEN: Self = Self {
        weaken: f64::INFINITY,
        reject: f64::INFINITY,
    };
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
    /// With the measurement the position, speed or latitude would leave the range a solution can have.
    Implausible,
}

impl fmt::Display for FilterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooManyStates { needed, capacity } => {
                write!(
                    f,
                    "the noise models need {needed} states, the filter has {capacity}"
                )
            }
            Self::BadMeasurement => {
                f.write_str("the measurement's covariance is not positive definite")
            }
            Self::Diverged => {
                f.write_str("the solution diverged: position, velocity or covariance out of range")
            }
            Self::Implausible => {
                f.write_str("the measurement would move the solution out of range: check its units")
            }
        }
    }
}

impl core::error::Error for FilterError {}

/// What a vehicle accelerates at its start [m/s²], one standard deviation.
const START_ACCEL: f64 = 2.0;

/// The filter; `N` is the most states it can hold, 9 for navigation and the rest for the sensors.
///
/// [`Filter::step`] carries it over a sample, an `observe_…` makes a measurement's row, [`Filter::update`] takes it in:
///
/// ```
/// use undrift_nav::{Matrix3, Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
/// use undrift_nav::{filter::{Filter, Gate, InitialStd}, parameters::Parameters};
/// use undrift_nav::{sample::{ImuSample, Position}, shaping::ShapingFilter};
///
/// let dt = 0.01;
/// let here = Geodetic::from_degrees(47.0, 8.0, 400.0);
/// let start = NavState { time: 0.0, position: here, v_n: Vector3::zeros(), q_nb: Quaternion::identity() };
/// let std = InitialStd {
///     position: Vector3::repeat(5.0),
///     velocity: Vector3::repeat(0.1),
///     attitude: Vector3::new(0.01, 0.01, 0.1),
/// };
/// // White noise of 1e-4 rad/√s and 1e-3 m/s/√s over a bias known to 1e-4 rad/s and 0.05 m/s².
/// let gyro = ShapingFilter::white(1e-4, dt)?.plus(&ShapingFilter::constant(1e-4, dt)?)?;
/// let accel = ShapingFilter::white(1e-3, dt)?.plus(&ShapingFilter::constant(0.05, dt)?)?;
/// let sensors = [gyro, gyro, gyro, accel, accel, accel];
/// let mut filter = Filter::<15>::new(start, &std, sensors, Parameters::none())?;
///
/// let (rate, force) = (Vector3::zeros(), Vector3::new(0.0, 0.0, -9.81));
/// for k in 1..=100 {
///     filter.step(&ImuSample { time: k as f64 * dt, dt, dtheta: rate * dt, dvel: force * dt })?;
/// }
/// let fix = filter.observe_position(&Position::Geodetic(here), &Vector3::zeros());
/// let update = filter.update(&fix, &Matrix3::identity(), &Gate::OPEN)?;
/// assert!(update.nis < 16.0 && filter.nav_std()[0] < 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Filter<const N: usize> {
    nav: NavState,
    sensors: Sensors,
    parameters: Parameters,
    /// Estimated sensor states and parameters, at their place in the error state; the first nine stay zero.
    x: [f64; N],
    p: SMatrix<f64, N, N>,
    c_nb: Matrix3,
    previous: Option<RawIncrements>,
    /// The present sample, its predicted error removed, and how much of it is done.
    current: Option<(Increments, f64)>,
    /// Where the present sample ends \[s\].
    end: f64,
    /// Angular rate ω_ib^b of the present sample, its predicted error removed [rad/s].
    omega_ib_b: Vector3,
    /// Specific force of the present sample, its predicted error removed [m/s²].
    force_b: Vector3,
    /// How the parameters act on the present sample's errors.
    coupling: Coupling,
    /// From when on [`Parameter::ClockRate`] lets the time offsets grow \[s\].
    start: f64,
}

impl<const N: usize> Filter<N> {
    /// Starts at `nav` with the given uncertainty; `sensors` in the order gyro x, y, z,
    /// accelerometer x, y, z.
    ///
    /// # Errors
    /// More states than `N`, or of one axis than [`MAX_ORDER`]; a start that is no place on the Earth.
    pub fn new(
        nav: NavState,
        std: &InitialStd,
        sensors: [ShapingFilter; AXES],
        parameters: Parameters,
    ) -> Result<Self, FilterError> {
        // The fields of a shaping filter are public: it may be made by hand.
        if let Some(axis) = sensors.iter().find(|axis| axis.order > MAX_ORDER) {
            return Err(FilterError::TooManyStates {
                needed: axis.order,
                capacity: MAX_ORDER,
            });
        }
        let sensors = Sensors::new(sensors);
        let behind = sensors.states();
        let needed = behind + parameters.states();
        if needed > N {
            return Err(FilterError::TooManyStates {
                needed,
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
        for (kind, at, prior) in parameters.blocks() {
            for i in behind + at..behind + at + kind.width() {
                p[(i, i)] = prior.std * prior.std;
            }
        }
        Ok(Self {
            nav,
            sensors,
            parameters,
            x: [0.0; N],
            p,
            c_nb: nav.q_nb.to_rotation_matrix().into_inner(),
            previous: None,
            current: None,
            end: nav.time,
            omega_ib_b: Vector3::zeros(),
            force_b: Vector3::zeros(),
            coupling: Coupling::NONE,
            start: nav.time,
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
        self.sensors.states() + self.parameters.states()
    }

    /// The parameters that are estimated.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Place of a parameter's first state in the error state, if it is estimated.
    pub fn parameter_start(&self, kind: Parameter) -> Option<usize> {
        Some(self.sensors.states() + self.parameters.start(kind)?)
    }

    /// Estimated correction of a parameter to its configured value, and its standard deviations; the
    /// first `kind.width()` of each.
    pub fn parameter(&self, kind: Parameter) -> Option<([f64; 6], [f64; 6])> {
        let at = self.parameter_start(kind)?;
        let (mut value, mut std) = ([0.0; 6], [0.0; 6]);
        for i in 0..kind.width() {
            value[i] = self.x[at + i];
            std[i] = libm::sqrt(self.p[(at + i, at + i)].max(0.0));
        }
        Some((value, std))
    }

    /// By how much the fixes' positions ([`Parameter::TimeOffset`]) or velocities ([`Parameter::VelocityTimeOffset`]) now
    /// hold later than their stamps say, as estimated, and its standard deviation \[s\]: the state is that of the
    /// filter's start.
    pub fn time_offset(&self, kind: Parameter) -> Option<(f64, f64)> {
        let at = self.parameter_start(kind)?;
        let (mut value, mut variance) = (self.x[at], self.p[(at, at)]);
        if let Some(rate) = self.parameter_start(Parameter::ClockRate) {
            let time = self.since_start();
            value += time * self.x[rate];
            variance += time * (2.0 * self.p[(at, rate)] + time * self.p[(rate, rate)]);
        }
        Some((value, libm::sqrt(variance.max(0.0))))
    }

    /// How long the filter has run \[s\].
    pub fn since_start(&self) -> f64 {
        self.nav.time - self.start
    }

    /// Estimated sensor states and parameters at their place in the error state.
    pub fn estimates(&self) -> &[f64; N] {
        &self.x
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

    /// Acceleration of the IMU over ground, north-east-down [m/s²], from the last sample; without the
    /// Coriolis term.
    pub fn acceleration(&self) -> Vector3 {
        let gravity = crate::earth::LocalEarth::at(&self.nav.position).gravity;
        self.c_nb * self.force_b + Vector3::new(0.0, 0.0, gravity)
    }

    /// How the parameters act on the present sample's errors.
    pub(crate) fn coupling(&self) -> &Coupling {
        &self.coupling
    }

    /// Standard deviations of `[δr; δv; ψ]` [m, m/s, rad].
    pub fn nav_std(&self) -> [f64; NAV] {
        core::array::from_fn(|i| libm::sqrt(self.p[(i, i)].max(0.0)))
    }

    /// Estimated sensor errors, gyro x, y, z [rad/s] and accelerometer x, y, z [m/s²]: what is
    /// subtracted from the next sample, but for scale factors and axis misalignment.
    pub fn sensor_error(&self) -> [f64; AXES] {
        self.sensors.predicted_error(&self.x, &Coupling::NONE)
    }

    /// Standard deviations of [`Filter::sensor_error`], without the sample's own white noise.
    pub fn sensor_error_std(&self) -> [f64; AXES] {
        self.sensors.error_std(|i, j| self.p[(i, j)])
    }

    /// Where the sample taken up ends \[s\], if it is not done.
    pub fn sample_end(&self) -> Option<f64> {
        self.current.map(|_| self.end)
    }

    /// As [`Filter::step`] without any check. The sample must begin where the one before ended: of one after a gap
    /// the time is taken, but the motion within the gap is missing.
    pub fn predict(&mut self, sample: &ImuSample) {
        self.begin(sample);
        self.advance(1.0);
    }

    /// As [`Filter::begin_step`] without any check: takes up a sample without moving yet; [`Filter::advance`] then
    /// moves through its interval in one or more parts, with updates between them where a fix falls inside.
    pub fn begin(&mut self, sample: &ImuSample) {
        let (rate, force) = (sample.dtheta / sample.dt, sample.dvel / sample.dt);
        let behind = self.sensors.states();
        self.coupling
            .follow(&self.parameters, behind, &rate, &force);
        let error = self.sensors.predicted_error(&self.x, &self.coupling);
        let gyro = Vector3::new(error[0], error[1], error[2]);
        let accel = Vector3::new(error[3], error[4], error[5]);
        let raw = RawIncrements {
            dt: sample.dt,
            dtheta: sample.dtheta - gyro * sample.dt,
            dvel: sample.dvel - accel * sample.dt,
        };
        let increments = Increments::from_raw(raw.dt, raw.dtheta, raw.dvel, self.previous.as_ref());
        self.omega_ib_b = raw.dtheta / raw.dt;
        self.force_b = raw.dvel / raw.dt;
        self.previous = Some(raw);
        self.current = Some((increments, 0.0));
        self.end = sample.time;
    }

    /// Moves to the fraction `to` (0…1) of the sample taken up; does nothing if already there.
    pub fn advance(&mut self, to: f64) {
        self.advance_with(to, None);
    }

    /// As [`Filter::advance`], the step recorded on `tape` for a smoother.
    pub fn advance_recorded(&mut self, to: f64, tape: &mut Tape<N>) {
        self.advance_with(to, Some(tape));
    }

    fn advance_with(&mut self, to: f64, tape: Option<&mut Tape<N>>) {
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
            let coupling = &self.coupling;
            self.sensors
                .propagate(&mut self.p.data.0, &transition, coupling, step.dt, part);
            if let Some(tape) = tape {
                tape.step(&self.sensors, &transition, coupling, part);
                for (states, prior) in self.parameters.ranges(self.sensors.states()) {
                    tape.fade(states, prior.step(step.dt).0);
                }
            }
            for (states, prior) in self.parameters.ranges(self.sensors.states()) {
                if prior.is_constant() {
                    continue;
                }
                let (left, variance) = prior.step(step.dt);
                for i in states {
                    if left != 1.0 {
                        self.x[i] *= left;
                        for j in 0..N {
                            self.p[(i, j)] *= left;
                            self.p[(j, i)] *= left;
                        }
                    }
                    self.p[(i, i)] += variance;
                }
            }
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

    /// As [`Filter::advance`] to `time` \[s\] within the sample taken up; a time within `rounding` \[s\] of its
    /// end is the end.
    pub fn advance_to(&mut self, time: f64, rounding: f64) {
        self.advance_to_with(time, rounding, None);
    }

    /// As [`Filter::advance_to`], the step recorded on `tape` for a smoother.
    pub fn advance_to_recorded(&mut self, time: f64, rounding: f64, tape: &mut Tape<N>) {
        self.advance_to_with(time, rounding, Some(tape));
    }

    fn advance_to_with(&mut self, time: f64, rounding: f64, tape: Option<&mut Tape<N>>) {
        let end = self.end;
        let Some((increments, done)) = self.current else {
            return;
        };
        if end - time <= rounding {
            self.advance_with(1.0, tape);
        } else {
            let to = 1.0 - (end - time) / increments.dt;
            if (to - done) * increments.dt > rounding {
                self.advance_with(to, tape);
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

    /// Sets the covariance of position and velocity [m², (m/s)²], north-east-down, as of a fix that they
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

    /// Position and velocity were taken from a fix whose errors have time-correlated parts, of these standard
    /// deviations north, east, down [m, m/s]: they have those parts, too. To be called after
    /// [`Filter::set_position_velocity_covariance`]; it does nothing where [`Parameter::PositionError`] and
    /// [`Parameter::VelocityError`] are not estimated.
    pub fn share_fix_errors(&mut self, position: &Vector3, velocity: &Vector3) {
        let kinds = [Parameter::PositionError, Parameter::VelocityError];
        for (k, (kind, std)) in kinds.into_iter().zip([position, velocity]).enumerate() {
            let Some(at) = self.parameter_start(kind) else {
                continue;
            };
            for i in 0..3 {
                let across = std[i] * self.p[(at + i, at + i)];
                self.p[(3 * k + i, at + i)] = across;
                self.p[(at + i, 3 * k + i)] = across;
            }
        }
    }

    /// Adds uncertainty to position \[m\], velocity [m/s] and tilt \[rad\], one standard deviation each axis:
    /// for a solution that fixes have contradicted for a while.
    pub fn doubt(&mut self, position: &Vector3, velocity: f64, tilt: f64) {
        for i in 0..3 {
            self.p[(i, i)] += position[i] * position[i];
            self.p[(3 + i, 3 + i)] += velocity * velocity;
        }
        for i in 6..8 {
            self.p[(i, i)] += tilt * tilt;
        }
    }

    /// Adds uncertainty to the heading \[rad\] and to the error of gyro z [rad/s], one standard deviation: for a
    /// heading that the course contradicts.
    pub fn doubt_heading(&mut self, heading: f64, gyro: f64) {
        self.p[(8, 8)] += heading * heading;
        let (sensor, at) = (self.sensors.axis(2), self.sensors.start(2));
        let size: f64 = sensor.h[..sensor.order].iter().map(|h| h * h).sum();
        if size > 0.0 {
            for i in 0..sensor.order {
                for j in 0..sensor.order {
                    self.p[(at + i, at + j)] +=
                        gyro * gyro * sensor.h[i] * sensor.h[j] / (size * size);
                }
            }
        }
    }

    /// Sets the variance of the white noise of a sample of each axis from now on, gyro x, y, z \[rad²/s²\] and
    /// accelerometer x, y, z \[m²/s⁴\]: of a sensor in vibration that changes. Not below that of the model, of which a
    /// cross-covariance asks for it.
    pub fn set_white_noise(&mut self, variance: &[f64; AXES]) {
        self.sensors.set_white_noise(variance);
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

    /// Adds the covariance of a turn \[rad²\] and of a change of velocity \[m²/s²\], body axes, that the samples just
    /// passed may have missed.
    pub fn widen(&mut self, turn: &Matrix3, velocity: &Matrix3) {
        for (at, covariance) in [(3, velocity), (6, turn)] {
            let turned = self.c_nb * covariance * self.c_nb.transpose();
            let mut own = self.p.fixed_view_mut::<3, 3>(at, at);
            own += turned;
        }
    }

    /// Kalman update with a measurement of covariance `r`: innovation ν = predicted less measured,
    /// `ν = h·error + noise`, past a gate ([`Gate::OPEN`]: every one is used). Joseph's form, in two rank-M passes.
    ///
    /// # Errors
    /// A covariance of the innovation that is not positive, or a correction after which there is no solution; the
    /// filter is then as it was.
    pub fn update<const M: usize>(
        &mut self,
        observed: &Observation<M, N>,
        r: &SMatrix<f64, M, M>,
        gate: &Gate,
    ) -> Result<Update, FilterError> {
        self.update_with(observed, r, gate, None)
    }

    /// As [`Filter::update`], recorded on `tape` for a smoother.
    ///
    /// # Errors
    /// As [`Filter::update`].
    pub fn update_recorded<const M: usize>(
        &mut self,
        observed: &Observation<M, N>,
        r: &SMatrix<f64, M, M>,
        gate: &Gate,
        tape: &mut Tape<N>,
    ) -> Result<Update, FilterError> {
        self.update_with(observed, r, gate, Some(tape))
    }

    fn update_with<const M: usize>(
        &mut self,
        observed: &Observation<M, N>,
        r: &SMatrix<f64, M, M>,
        gate: &Gate,
        tape: Option<&mut Tape<N>>,
    ) -> Result<Update, FilterError> {
        let (h, z) = (&observed.h, &observed.innovation);
        let stated = r;
        let mut r = r + observed.extra;
        let pht = self.p * h.transpose();
        let mut s = h * pht + r;
        let mut factor = nalgebra::Cholesky::new(s).ok_or(FilterError::BadMeasurement)?;
        let white = factor
            .l_dirty()
            .solve_lower_triangular(z)
            .ok_or(FilterError::BadMeasurement)?;
        let nis = white.norm_squared();
        if !nis.is_finite() {
            return Err(FilterError::BadMeasurement);
        }
        let mut whitened = [0.0; 3];
        for (slot, value) in whitened.iter_mut().zip(white.iter()) {
            *slot = *value;
        }
        let inverse = factor.inverse();
        let (weighted, share) = (inverse * z, inverse * stated);
        let mut update = Update {
            nis,
            dof: M,
            whitened,
            score: 0.5 * ((stated * weighted).dot(&weighted) - share.trace()),
            information: 0.5 * (share * share).trace(),
            outcome: Outcome::Used,
        };
        if nis > gate.reject {
            update.outcome = Outcome::Rejected;
            return Ok(update);
        }
        if nis > gate.weaken {
            let factor_of_r = nis / gate.weaken;
            update.outcome = Outcome::Weakened(factor_of_r);
            r *= factor_of_r;
            s = h * pht + r;
            factor = nalgebra::Cholesky::new(s).ok_or(FilterError::BadMeasurement)?;
        }
        let gain = factor.solve(&pht.transpose()).transpose();
        let error = gain * z;
        let corrected = self.without_error(&error);
        if !(corrected.is_valid() && error.iter().all(|number| number.is_finite())) {
            return Err(FilterError::Implausible);
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
        if let Some(tape) = tape {
            let turn = Vector3::new(error[6], error[7], error[8]);
            tape.update(h, &factor.inverse(), &factor.solve(z), &gain, &turn);
        }
        self.correct(corrected, &error);
        Ok(update)
    }

    fn without_error(&self, error: &SVector<f64, N>) -> NavState {
        let part = |at: usize| Vector3::new(error[at], error[at + 1], error[at + 2]);
        self.nav.without_error(&part(0), &part(3), &part(6))
    }

    /// Takes an estimated error out of the navigation state and adds it to the sensors' states and the
    /// parameters; the covariance stays, turned to the corrected attitude.
    pub fn take_out(&mut self, error: &SVector<f64, N>) {
        self.correct(self.without_error(error), error);
    }

    fn correct(&mut self, nav: NavState, error: &SVector<f64, N>) {
        self.nav = nav;
        self.reset_attitude(&Vector3::new(error[6], error[7], error[8]));
        self.c_nb = self.nav.q_nb.to_rotation_matrix().into_inner();
        let before = self.sensors.predicted_error(&self.x, &self.coupling);
        for i in NAV..N {
            self.x[i] += error[i];
        }
        // The rate, and what is left of the present sample, follow the new estimate.
        let after = self.sensors.predicted_error(&self.x, &self.coupling);
        let change: [f64; AXES] = core::array::from_fn(|i| after[i] - before[i]);
        let gyro = Vector3::new(change[0], change[1], change[2]);
        let accel = Vector3::new(change[3], change[4], change[5]);
        self.omega_ib_b -= gyro;
        self.force_b -= accel;
        if let Some((increments, _)) = &mut self.current {
            increments.rotation -= gyro * increments.dt;
            increments.dvel -= accel * increments.dt;
        }
    }

    /// Moves the misalignment's covariance to the corrected attitude. It matters while the heading is
    /// far less certain than the level.
    fn reset_attitude(&mut self, delta: &Vector3) {
        turn_rows(&mut self.p, delta);
        self.p.transpose_mut();
        turn_rows(&mut self.p, delta);
        for (i, j) in [(6, 7), (6, 8), (7, 8)] {
            self.p[(i, j)] = self.p[(j, i)];
        }
    }

    /// Whether the solution is still one: finite, possible, with a covariance that is not negative
    /// on its diagonal.
    ///
    /// # Errors
    /// [`FilterError::Diverged`] if it is not.
    pub fn check(&self) -> Result<(), FilterError> {
        let columns = self.p.data.0.iter().enumerate();
        let mut diagonal = columns.map(|(i, column)| column[i]);
        if diagonal.all(|variance| (0.0..=f64::MAX).contains(&variance)) && self.nav.is_valid() {
            Ok(())
        } else {
            Err(FilterError::Diverged)
        }
    }
}
