//! The error-state Kalman filter: nine navigation errors, the states of six shaping filters, and
//! the parameters asked for.
//!
//! Closed loop: after every update the estimated error is taken out of the navigation state and
//! added to the sensors' states, so between updates the error's mean is zero. Groves 2013,
//! chapters 3 and 14. Navigation errors are estimate less truth; sensor states are what the
//! prediction still misses (truth less estimate), as in `docs/conventions.md`.

mod lasting;
mod motion;
mod numbers;
mod step;
mod turned;
mod uncertainty;
mod update;

pub use lasting::{Carried, Lasting};
pub use numbers::Each;
pub use step::{LONGEST_STEP, StepError};
pub use update::{Gate, Outcome, Update};

use crate::{
    Matrix3, Vector3,
    covariance::{AXES, NAV, Part, Sensors, Transition},
    mechanisation::{Increments, NavState, RawIncrements},
    parameters::{Coupling, Parameter, Parameters, jerk},
    sample::ImuSample,
    shaping::{MAX_ORDER, ShapingFilter},
    tape::Tape,
};
use core::fmt;
use nalgebra::SMatrix;

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
    /// Specific force as the sensor reads it [m/s²], behind the low-pass of [`jerk`] where its delay is estimated.
    slow_force: Vector3,
    /// Acceleration over ground [m/s²] behind one and two low-passes where [`Parameter::Smoothing`] is estimated.
    slow: [Vector3; 2],
    /// How the parameters act on the present sample's errors.
    coupling: Coupling,
    /// From when on [`Parameter::ClockRate`] lets the time offsets grow \[s\].
    start: f64,
    /// Whether the navigation frame turns with the Earth.
    turns: bool,
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
            slow_force: Vector3::zeros(),
            slow: [Vector3::zeros(); 2],
            coupling: Coupling::NONE,
            start: nav.time,
            turns: true,
        })
    }

    /// Position, velocity and attitude of the IMU, corrected by all measurements so far.
    pub fn nav(&self) -> &NavState {
        &self.nav
    }

    /// Covariance of the error state, estimate less truth for its first nine; rows beyond [`Filter::states`] are zero.
    pub fn covariance(&self) -> &SMatrix<f64, N, N> {
        &self.p
    }

    /// Size of the error state in use, at most `N`.
    pub fn states(&self) -> usize {
        self.sensors.states() + self.parameters.states()
    }

    /// The parameters that are estimated, with their priors.
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

    /// Time since the filter's start \[s\], by which [`Parameter::ClockRate`] acts.
    pub fn since_start(&self) -> f64 {
        self.nav.time - self.start
    }

    /// Estimated sensor states and parameters at their place in the error state; the first nine are zero.
    pub fn estimates(&self) -> &[f64; N] {
        &self.x
    }

    /// The sensors' shaping filters and their places in the error state.
    pub fn sensors(&self) -> &Sensors {
        &self.sensors
    }

    /// Rotation matrix C_b^n, from body axes to north-east-down: that of `nav().q_nb`.
    pub fn c_nb(&self) -> &Matrix3 {
        &self.c_nb
    }

    /// Angular rate of the body ω_ib^b [rad/s], the last sample's less its predicted error.
    pub fn omega_ib_b(&self) -> Vector3 {
        self.omega_ib_b
    }

    /// How the parameters act on the present sample's errors.
    pub(crate) fn coupling(&self) -> &Coupling {
        &self.coupling
    }

    /// Standard deviations of `[δr; δv; ψ]`, each north, east, down [m, m/s, rad].
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

    /// Carries the filter over one whole sample without any check, for tests and simulations; [`Filter::step`] checks. The sample must begin
    /// where the one before ended: of one after a gap the time is taken, but the motion within the gap is missing.
    pub fn predict(&mut self, sample: &ImuSample) {
        self.begin(sample);
        self.advance(1.0);
    }

    /// Takes up a sample without moving yet, and without the checks of [`Filter::begin_step`]; [`Filter::advance`] then
    /// moves through its interval in one or more parts, with updates between them where a fix falls inside.
    pub fn begin(&mut self, sample: &ImuSample) {
        let (rate, force) = (sample.dtheta / sample.dt, sample.dvel / sample.dt);
        let behind = self.sensors.states();
        let mut change = Vector3::zeros();
        if self.previous.is_none() || self.parameters.start(Parameter::AccelDelay).is_none() {
            self.slow_force = force;
        } else {
            change = jerk(&mut self.slow_force, &force, sample.dt);
        }
        self.coupling
            .follow(&self.parameters, behind, [&rate, &force, &change]);
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
        self.follow_slowly(sample.dt);
        self.previous = Some(raw);
        self.current = Some((increments, 0.0));
        self.end = sample.time;
    }

    /// Moves to the fraction `to` (0…1) of the sample taken up; does nothing if already there or beyond.
    pub fn advance(&mut self, to: f64) {
        self.advance_with(to, None);
    }

    /// Does [`Filter::advance`] and records the step on `tape` for a smoother.
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
            let earth = self.earth();
            let step = self.nav.step_over(&part, earth);
            self.c_nb = self.nav.q_nb.to_rotation_matrix().into_inner();
            let transition = Transition::new(&step, &((c_start + self.c_nb) * 0.5));
            let part = if last { Part::Last } else { Part::Inner };
            let coupling = &self.coupling;
            self.sensors
                .propagate(&mut self.p.data.0, &transition, coupling, step.dt, part);
            if let Some(tape) = tape {
                tape.step(&self.sensors, &transition, coupling, part);
                for (states, prior) in self.parameters.ranges(self.sensors.states()) {
                    tape.decay(states, prior.step(step.dt).0);
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

    /// Moves to `time` \[s\] within the sample taken up; a time within `rounding` \[s\] of its end is the end, so that no step of
    /// a rounding's length is made.
    pub fn advance_to(&mut self, time: f64, rounding: f64) {
        self.advance_to_with(time, rounding, None);
    }

    /// Does [`Filter::advance_to`] and records the step on `tape` for a smoother.
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

    /// Sets the variance of the white noise of a sample of each axis from now on, gyro x, y, z \[rad²/s²\] and
    /// accelerometer x, y, z \[m²/s⁴\]: of a sensor in vibration that changes. Not below that of the model, of which a
    /// cross-covariance asks for it.
    pub fn set_white_noise(&mut self, variance: &[f64; AXES]) {
        self.sensors.set_white_noise(variance);
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
