//! The filter at each of its sizes, and which one holds so many states.
//!
//! The filter is generic in its number of states; a navigator is not. Each size is compiled once, and the
//! smallest that holds the states is chosen, since the time of an update grows with the square of the size: 16
//! hold navigation and one state an axis.
//!
//! What calls it: [`build`](super::build) and [`Estimator::with_lasting`], which make filters;
//! everything else holds a `Box<dyn Estimator>`. Here only three things are more than a call passed
//! on: recording and logging of updates ([`Erased::take_in`]), the observation of a window of
//! motion ([`Estimator::update_window`]), and the change of size when states are added or removed.
//!
//! Sizes and cost: an update with m numbers costs O(m N²), a prediction O(N²) for the states that
//! are in use (the navigation block has a fixed width); memory is one N × N covariance. A virtual
//! call costs nothing beside that. It may not add physics: equations belong to `undrift_nav`, so
//! that every user of the filter has the same.

use super::{Adjoint, Channel, Estimator, LogTo, Logged, LoggedUpdate};
use crate::aid::{Aiding, Observed, observe};
use alloc::boxed::Box;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use nalgebra::{DMatrix, DMatrixView, DVector, SMatrix, SVector};
use undrift_events::STAMP_ROUNDING;
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    aiding::Observation,
    covariance::{AXES, NAV, Sensors},
    earth::Geodetic,
    filter::{
        Carried, Each, Filter, FilterError, Gate, InitialStd, Lasting, Outcome, StepError, Update,
    },
    mechanisation::NavState,
    parameters::{Parameter, Parameters},
    sample::ImuSample,
    shaping::ShapingFilter,
    tape::Tape,
};

/// What a filter is made of.
///
/// Both give the same kind of filter; the second keeps what was estimated so far.
#[expect(
    clippy::large_enum_variant,
    reason = "passed on once, when a filter is made"
)]
pub(super) enum Initial<'a> {
    /// A new filter: state, its uncertainty, models, parameters.
    New(
        NavState,
        &'a InitialStd,
        &'a [ShapingFilter; AXES],
        Parameters,
    ),
    /// A filter that goes on from another one, its estimates and covariance, with the time-correlated errors as given.
    Lasting(
        Carried,
        &'a [f64],
        DMatrixView<'a, f64>,
        &'a [Option<Lasting>; 2],
    ),
}

/// A filter of the smallest size that holds so many states.
///
/// # Errors
/// [`FilterError::TooManyStates`] beyond 73 states; as [`Filter::new`] and [`Filter::with_lasting`].
pub(super) fn sized(states: usize, start: Initial) -> Result<Box<dyn Estimator>, FilterError> {
    match states {
        // Four columns go at a time: one that is left costs nearly as much.
        ..=16 => build_sized::<16>(start),
        17..=21 => build_sized::<21>(start),
        // The browser's page has no room for one more.
        #[cfg(not(target_family = "wasm"))]
        22..=24 => build_sized::<24>(start),
        22..=28 => build_sized::<28>(start),
        29..=33 => build_sized::<33>(start),
        34..=45 => build_sized::<45>(start),
        _ => build_sized::<73>(start),
    }
}

/// The filter at one size.
///
/// # Errors
/// [`FilterError::TooManyStates`] where the states exceed N; as [`sized`].
fn build_sized<const N: usize>(start: Initial) -> Result<Box<dyn Estimator>, FilterError> {
    let filter = match start {
        Initial::New(nav, std, sensors, parameters) => {
            Filter::<N>::new(nav, std, *sensors, parameters)
        }
        Initial::Lasting(carried, x, p, lasting) => {
            Filter::with_lasting(carried, x, &|i, j| p[(i, j)], lasting)
        }
    }?;
    Ok(Box::new(Erased {
        filter,
        mounting_std: Vector3::zeros(),
        tape: None,
        log: None,
    }))
}

/// A filter behind [`Estimator`], with what is recorded of it.
///
/// Tape: transitions, updates and their adjoints since it was begun (see [`Tape`]); its cost is a
/// product of N × N matrices a step, which is why it runs only for smoothers and tuning.
struct Erased<const N: usize> {
    filter: Filter<N>,
    /// As [`Estimator::mounting_std`].
    mounting_std: Vector3,
    /// Since the last call of `record`, or since the last update that was logged.
    tape: Option<Box<Tape<N>>>,
    /// Receiver of the updates; with it the tape is begun again at each update.
    log: Option<LogTo>,
}

impl<const N: usize> Erased<N> {
    /// Updates with one observation, recorded or logged as asked for.
    ///
    /// `noise` has three rows and columns; the leading M count.
    ///
    /// `channel` is for the log only. A rejected update changes neither filter nor tape.
    ///
    /// # Errors
    /// As [`Filter::update`]; the filter is then as it was.
    fn take_in<const M: usize>(
        &mut self,
        channel: Channel,
        observed: &Observation<M, N>,
        noise: &Matrix3,
        gate: &Gate,
    ) -> Result<Option<Update>, FilterError> {
        let r = noise.fixed_view::<M, M>(0, 0).into_owned();
        if self.log.is_some() {
            return self.take_in_logged(channel, observed, &r, gate).map(Some);
        }
        match self.tape.as_deref_mut() {
            Some(tape) => self.filter.update_recorded(observed, &r, gate, tape),
            None => self.filter.update(observed, &r, gate),
        }
        .map(Some)
    }

    /// Updates and gives the log the update with the transition since the one before: the tape begins again at each.
    ///
    /// The correction that is logged is P Hᵀ S⁻¹ ν with the covariance before the update, n
    /// numbers; the rotation part of it begins the new tape, since the misalignment is measured
    /// against the corrected attitude from then on.
    fn take_in_logged<const M: usize>(
        &mut self,
        channel: Channel,
        observed: &Observation<M, N>,
        r: &SMatrix<f64, M, M>,
        gate: &Gate,
    ) -> Result<Update, FilterError> {
        let before = *self.filter.covariance();
        let mut own = Tape::<N>::default();
        let done = self.filter.update_recorded(observed, r, gate, &mut own)?;
        let factor = match done.outcome {
            Outcome::Rejected => return Ok(done),
            Outcome::Used => 1.0,
            Outcome::Weakened(factor) => factor,
        };
        let correction = before * own.gradient;
        let n = self.filter.states();
        let turn = Vector3::new(correction[6], correction[7], correction[8]);
        let tape = self.tape.replace(Box::new(Tape::after(&turn)));
        let transition = tape.map_or_else(SMatrix::identity, |tape| tape.transition());
        let update = LoggedUpdate {
            time: self.filter.nav().time,
            channel,
            transition: DMatrix::from_fn(n, n, |i, j| transition[(i, j)]),
            h: DMatrix::from_fn(M, n, |i, j| observed.h[(i, j)]),
            innovation: DVector::from_column_slice(observed.innovation.as_slice()),
            noise: DMatrix::from_fn(M, M, |i, j| r[(i, j)] + observed.extra[(i, j)]),
            weakened: factor,
            correction: DVector::from_fn(n, |i, _| correction[i]),
            white: core::array::from_fn(|axis| self.filter.sensors().axis(axis).r),
        };
        if let Some(log) = &self.log {
            // Nobody listens any more: nor is it of use.
            (log.0)(Logged::Update(Box::new(update)));
        }
        Ok(done)
    }
}

impl<const N: usize> Estimator for Erased<N> {
    fn nav(&self) -> &NavState {
        self.filter.nav()
    }

    fn states(&self) -> usize {
        self.filter.states()
    }

    /// A view, not a copy: N × N, column-major, symmetric.
    fn covariance(&self) -> DMatrixView<'_, f64> {
        DMatrixView::from_slice(self.filter.covariance().as_slice(), N, N)
    }

    fn estimates(&self) -> &[f64] {
        self.filter.estimates()
    }

    fn sensors(&self) -> &Sensors {
        self.filter.sensors()
    }

    fn parameters(&self) -> &Parameters {
        self.filter.parameters()
    }

    fn parameter(&self, kind: Parameter) -> Option<([f64; 6], [f64; 6])> {
        self.filter.parameter(kind)
    }

    fn time_offset(&self, kind: Parameter) -> Option<(f64, f64)> {
        self.filter.time_offset(kind)
    }

    fn mounting_std(&self) -> Vector3 {
        self.mounting_std
    }

    fn set_mounting_std(&mut self, std: &Vector3) {
        let is_state = self.parameters().prior(Parameter::Mounting).is_some();
        self.mounting_std = match is_state {
            true => Vector3::new(std.x, 0.0, 0.0),
            false => *std,
        };
    }

    fn loosen(&mut self, nods: f64) {
        self.mounting_std.y = self.mounting_std.y.hypot(nods);
    }

    fn since_start(&self) -> f64 {
        self.filter.since_start()
    }

    fn nav_std(&self) -> [f64; NAV] {
        self.filter.nav_std()
    }

    fn sensor_error(&self) -> [f64; AXES] {
        self.filter.sensor_error()
    }

    fn sensor_error_std(&self) -> [f64; AXES] {
        self.filter.sensor_error_std()
    }

    fn omega_nb_b(&self) -> Vector3 {
        self.filter.omega_nb_b()
    }

    fn antenna_position(&self, lever_b: &Vector3) -> Geodetic {
        self.filter.antenna_position(lever_b)
    }

    fn antenna_velocity(&self, lever_b: &Vector3) -> Vector3 {
        self.filter.antenna_velocity(lever_b)
    }

    fn vehicle_velocity(&self, lever_b: &Vector3) -> Vector3 {
        self.filter.vehicle_velocity(lever_b)
    }

    fn check(&self) -> Result<(), FilterError> {
        self.filter.check()
    }

    fn sample_end(&self) -> Option<f64> {
        self.filter.sample_end()
    }

    fn reached(&self) -> f64 {
        self.filter.reached()
    }

    fn accepts_step(&self, sample: &ImuSample) -> Result<(), StepError> {
        self.filter.accepts_step(sample)
    }

    fn begin(&mut self, sample: &ImuSample) {
        self.filter.begin(sample);
    }

    /// `time` \[s\] within the sample taken up, to [`STAMP_ROUNDING`].
    fn advance(&mut self, time: Option<f64>) {
        let filter = &mut self.filter;
        match (time, self.tape.as_deref_mut()) {
            (Some(time), None) => filter.advance_to(time, STAMP_ROUNDING),
            (Some(time), Some(tape)) => filter.advance_to_recorded(time, STAMP_ROUNDING, tape),
            (None, None) => filter.advance(1.0),
            (None, Some(tape)) => filter.advance_recorded(1.0, tape),
        }
    }

    fn inflate_over_gap(&mut self, duration: f64, rate: f64, accel: f64) {
        self.filter.inflate_over_gap(duration, rate, accel);
    }

    fn inflate(&mut self, position: &Vector3, velocity: f64, tilt: f64) {
        self.filter.inflate(position, velocity, tilt);
    }

    fn set_white_noise(&mut self, variance: &[f64; AXES]) {
        self.filter.set_white_noise(variance);
    }

    fn inflate_heading(&mut self, heading: f64, gyro: f64) {
        self.filter.inflate_heading(heading, gyro);
    }

    fn inflate_time_offsets(&mut self, std: f64) {
        self.filter.inflate_time_offsets(std);
    }

    fn inflate_sensor_errors(&mut self, variance: &[f64; AXES]) {
        self.filter.inflate_sensor_errors(variance);
    }

    fn inflate_missed_motion(&mut self, turn: &Matrix3, velocity: &Matrix3) {
        self.filter.inflate_missed_motion(turn, velocity);
    }

    /// Predicted less measured; of one or two numbers the rest of the three is 0.
    fn innovation(&self, aiding: &Aiding) -> Option<Vector3> {
        Some(match observe(&self.filter, aiding)? {
            Observed::One(observed) => Vector3::new(observed.innovation[0], 0.0, 0.0),
            Observed::Two(observed) => observed.innovation.push(0.0),
            Observed::Three(observed) => observed.innovation,
        })
    }

    fn innovation_covariance(&self, aiding: &Aiding) -> Option<Matrix3> {
        match observe(&self.filter, aiding)? {
            Observed::Three(observed) => {
                let (h, p) = (observed.h, self.filter.covariance());
                Some(h * p * h.transpose() + observed.extra)
            }
            _ => None,
        }
    }

    fn update(
        &mut self,
        aiding: &Aiding,
        noise: &Matrix3,
        gate: &Gate,
    ) -> Result<Option<Update>, FilterError> {
        let channel = aiding.channel();
        match observe(&self.filter, aiding) {
            None => Ok(None),
            Some(Observed::One(observed)) => self.take_in(channel, &observed, noise, gate),
            Some(Observed::Two(observed)) => self.take_in(channel, &observed, noise, gate),
            Some(Observed::Three(observed)) => self.take_in(channel, &observed, noise, gate),
        }
    }

    /// The map from the filter's errors to those of the window: velocity changes its sign (the
    /// window has truth less estimate), misalignment about north, east, down goes to body axes by
    /// C_n^b, the sensors' states to the errors that they make by H. Measurement noise is the
    /// identity, the gate open.
    fn update_window(
        &mut self,
        rows: &SMatrix<f64, 13, 13>,
        delay: Option<Parameter>,
    ) -> Result<(), FilterError> {
        // From the filter's errors to those of the window.
        let mut map = SMatrix::<f64, 13, N>::zeros();
        let c_bn = self.nav().q_nb.to_rotation_matrix().transpose();
        map.fixed_view_mut::<3, 3>(0, 3)
            .copy_from(&-Matrix3::identity());
        map.fixed_view_mut::<3, 3>(3, 6).copy_from(c_bn.matrix());
        for axis in 0..AXES {
            let (sensor, at) = (self.sensors().axis(axis), self.sensors().start(axis));
            for i in 0..sensor.order {
                map[(6 + axis, at + i)] = sensor.h[i];
            }
        }
        if let Some(at) = delay.and_then(|kind| self.parameter_start(kind)) {
            map[(12, at)] = 1.0;
        }
        let observed = Observation {
            innovation: SVector::zeros(),
            h: rows * map,
            extra: SMatrix::zeros(),
        };
        self.filter
            .update(&observed, &SMatrix::identity(), &Gate::OPEN)
            .map(drop)
    }

    /// The order is that of the error state; a short slice leaves the states behind it as they are.
    fn apply_correction(&mut self, error: &[f64]) {
        let error = |i: usize, _| error.get(i).copied().unwrap_or(0.0);
        self.filter.apply_correction(&SVector::from_fn(error));
    }

    fn set_nav(&mut self, nav: NavState) {
        self.filter.set_nav(nav);
    }

    fn set_sensor_error(&mut self, error: &[f64; AXES]) {
        self.filter.set_sensor_error(error);
    }

    fn set_position_velocity_covariance(
        &mut self,
        position: &Matrix3,
        velocity: &Matrix3,
        correlated: &[Vector3; 2],
    ) {
        self.filter
            .set_position_velocity_covariance(position, velocity);
        self.filter
            .correlate_with_fix_errors([position, velocity], correlated.each_ref());
    }

    fn without_earth_rate(&mut self) {
        self.filter.without_earth_rate();
    }

    fn log_to(&mut self, log: LogTo) {
        let n = self.filter.states();
        let covariance = self.covariance().view((0, 0), (n, n)).into_owned();
        (log.0)(Logged::Start(self.filter.nav().time, covariance));
        self.log = Some(log);
        self.tape = Some(Box::default());
    }

    fn record(&mut self) {
        self.log = None;
        self.tape = Some(Box::default());
    }

    fn adjoint(&self) -> Option<Adjoint> {
        let tape = self.tape.as_deref()?;
        let dynamic = |m: &SMatrix<f64, N, N>| DMatrix::from_column_slice(N, N, m.as_slice());
        Some(Adjoint {
            transition: dynamic(&tape.transition()),
            gradient: DVector::from_column_slice(tape.gradient.as_slice()),
            information: dynamic(&tape.information),
        })
    }

    fn numbers(&mut self, each: &mut Each) {
        self.filter.numbers(each);
        self.mounting_std.iter_mut().for_each(each);
    }

    /// Neither tape nor log is copied: a copy is for looking ahead, or for a snapshot.
    fn boxed(&self) -> Box<dyn Estimator> {
        Box::new(Self {
            filter: self.filter.clone(),
            mounting_std: self.mounting_std,
            tape: None,
            log: None,
        })
    }

    fn turn(&mut self, q_vb: &Quaternion) {
        self.filter.turn(q_vb);
    }

    fn isolate_heading(&mut self) {
        self.filter.isolate_heading();
    }

    fn renew(&mut self, kind: Parameter, std: f64) {
        self.filter.renew(kind, std);
    }

    /// States of the correlated errors of fixes are added or removed; all other estimates and
    /// covariances are carried over.
    fn with_lasting(
        &self,
        lasting: &[Option<Lasting>; 2],
    ) -> Result<Box<dyn Estimator>, FilterError> {
        let carried = self.filter.carried();
        let states = self.sensors().states() + carried.parameters(lasting).states();
        let start = Initial::Lasting(carried, self.estimates(), self.covariance(), lasting);
        let mut filter = sized(states, start)?;
        filter.set_mounting_std(&self.mounting_std);
        Ok(filter)
    }
}
