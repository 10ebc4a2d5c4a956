//! The filter, step by step.

mod kept;
mod measured;

use crate::{
    columns,
    drive::Drive,
    error::error,
    model::{self, NoiseModel},
    work,
};
use measured::{Measured, stated};
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, MutexGuard, PoisonError};
use undrift::{
    estimator::{self, Estimator, STAMP_ROUNDING},
    io::write::solution::SolutionRow,
    nav::{
        Vector3,
        attitude::from_rpy,
        earth::Geodetic,
        filter::{Gate, InitialStd, Update},
        mechanisation::NavState,
        parameters::{Parameter, Parameters, Prior},
        sample::ImuSample,
    },
    navigate::{self, solution_row},
    noise::interrupt,
    replay::Vibration,
    settings::fix_errors::FixErrors,
};
use undrift_report::say;

/// The parameters that can be estimated; what fixes are wrong by is asked for in another way, and poses are a drive's.
pub(crate) fn estimable() -> impl Iterator<Item = Parameter> {
    let of_poses = [Parameter::MarkerRotation, Parameter::FrameTilt];
    shown().filter(move |kind| !of_poses.contains(kind))
}

/// The parameters that a state shows.
fn shown() -> impl Iterator<Item = Parameter> {
    let of_fixes = [Parameter::PositionError, Parameter::VelocityError];
    Parameter::ALL
        .into_iter()
        .filter(move |kind| !of_fixes.contains(kind))
}

/// The filter; `undrift.Filter` wraps it.
#[pyclass(frozen, module = "undrift._undrift")]
pub struct Filter(Mutex<Held>);

/// What a filter holds.
struct Held {
    estimator: Box<dyn Estimator>,
    /// Whether a sample was taken up.
    begun: bool,
    /// What the fixes are wrong by.
    fix_errors: FixErrors,
    /// What the samples show of their noise, where the filter follows it.
    vibration: Option<Vibration>,
}

impl Held {
    /// Takes up a sample that begins at the filter's time, after the rest of the one before.
    fn begin(&mut self, sample: &ImuSample) -> Result<(), String> {
        let filter = &mut self.estimator;
        filter
            .accepts_step(sample)
            .map_err(|problem| problem.to_string())?;
        filter.advance(None);
        let noise = self.vibration.as_mut().and_then(|v| v.next(sample));
        if let Some(variances) = noise {
            filter.set_white_noise(&variances);
        }
        filter.begin(sample);
        self.begun = true;
        Ok(())
    }

    /// Moves to a time within the sample taken up, or to its end.
    fn advance(&mut self, to: Option<f64>) -> Result<(), String> {
        let filter = &mut self.estimator;
        let now = filter.nav().time;
        if let Some(to) = to {
            let end = filter.sample_end().unwrap_or(now);
            if !(now - STAMP_ROUNDING..=end + STAMP_ROUNDING).contains(&to) {
                return Err(format!(
                    "cannot advance to {to} s: the filter is at {now} s and the sample taken up ends at {end} s"
                ));
            }
        } else if !self.begun {
            return Err("nothing to advance: call begin() first".into());
        }
        filter.advance(to);
        filter.check().map_err(|problem| problem.to_string())
    }
}

fn row(filter: &dyn Estimator) -> SolutionRow {
    let (error, std) = (filter.sensor_error(), filter.sensor_error_std());
    solution_row(filter.nav(), filter.nav_std(), error, std)
}

/// The start of a filter.
#[derive(FromPyObject)]
pub struct Start {
    #[pyo3(item)]
    time: f64,
    #[pyo3(item)]
    position: [f64; 3],
    #[pyo3(item)]
    velocity: [f64; 3],
    #[pyo3(item)]
    rpy: [f64; 3],
    #[pyo3(item)]
    position_cov: [[f64; 3]; 3],
    #[pyo3(item)]
    velocity_cov: [[f64; 3]; 3],
    #[pyo3(item)]
    attitude_std: [f64; 3],
}

fn geodetic([lat, lon, height]: [f64; 3]) -> Geodetic {
    Geodetic { lat, lon, height }
}

/// A sample of rates, or of increments.
fn sample(time: f64, dt: f64, gyro: [f64; 3], accel: [f64; 3], increments: bool) -> ImuSample {
    let (gyro, accel) = (Vector3::from(gyro), Vector3::from(accel));
    let factor = if increments { 1.0 } else { dt };
    ImuSample {
        time,
        dt,
        dtheta: gyro * factor,
        dvel: accel * factor,
    }
}

#[pymethods]
impl Filter {
    #[new]
    fn new(
        model: &NoiseModel,
        bias_model: &str,
        rate: f64,
        start: Start,
        parameters: Vec<(String, f64, f64)>,
    ) -> PyResult<Self> {
        let sensors = model.filters(bias_model, rate)?;
        let mut asked = Parameters::none();
        for (name, std, walk) in parameters {
            let Some(kind) = estimable().find(|kind| kind.name() == name) else {
                let names = Vec::from_iter(estimable().map(Parameter::name)).join(", ");
                return Err(error(format!(
                    "unknown parameter \"{name}\"; available: {names}"
                )));
            };
            if !(std > 0.0 && std.is_finite() && walk >= 0.0 && walk.is_finite()) {
                return Err(error(format!("{name}: invalid standard deviation {std}")));
            }
            asked = asked.with(
                kind,
                Prior {
                    std,
                    walk,
                    ..Prior::default()
                },
            );
        }
        let nav = NavState {
            time: start.time,
            position: geodetic(start.position),
            v_n: Vector3::from(start.velocity),
            q_nb: from_rpy(&Vector3::from(start.rpy)),
        };
        let std = InitialStd {
            position: Vector3::repeat(1.0),
            velocity: Vector3::repeat(1.0),
            attitude: Vector3::from(start.attitude_std),
        };
        let mut filter = estimator::build(nav, &std, &sensors, asked).map_err(error)?;
        filter.set_position_velocity_covariance(
            &columns::matrix(start.position_cov),
            &columns::matrix(start.velocity_cov),
            &[Vector3::zeros(); 2],
        );
        filter.check().map_err(error)?;
        Ok(Self(Mutex::new(Held {
            estimator: filter,
            begun: false,
            fix_errors: FixErrors::default(),
            vibration: None,
        })))
    }

    /// The filter of a drive where its navigation begins, its lever arm and sample interval [s].
    #[staticmethod]
    fn from_drive(
        py: Python<'_>,
        drive: &Drive,
        bias_model: &str,
    ) -> PyResult<(Self, [f64; 3], f64)> {
        let kind = model::bias_model(bias_model)?;
        let started = work::run(py, || {
            navigate::start(&drive.drive, kind)
                .map_err(|error| say::unsolved(error.findings(), error))
        })?;
        let started = started.map_err(error)?;
        let settings = started.settings;
        let held = Held {
            estimator: started.filter,
            begun: true,
            fix_errors: settings.fix_errors,
            vibration: started.vibration,
        };
        let lever_arm = columns::array(&settings.lever_arm);
        Ok((
            Self(Mutex::new(held)),
            lever_arm,
            settings.sensors[0].interval,
        ))
    }

    /// A filter in the same state.
    fn copy(&self, py: Python<'_>) -> Self {
        self.locked(py, |held| {
            Self(Mutex::new(Held {
                estimator: held.estimator.boxed(),
                begun: held.begun,
                fix_errors: held.fix_errors,
                vibration: held.vibration.clone(),
            }))
        })
    }

    /// Models, parameters and state as numbers.
    fn numbers(&self, py: Python<'_>) -> Vec<f64> {
        self.locked(py, |held| kept::numbers(held))
    }

    /// From [`Filter::numbers`].
    #[staticmethod]
    fn from_numbers(numbers: Vec<f64>) -> PyResult<Self> {
        let held = kept::held(numbers).map_err(error)?;
        Ok(Self(Mutex::new(held)))
    }

    /// Takes up a sample of `dt` seconds that ends at `time` [s], by default now, without moving yet.
    fn begin(
        &self,
        py: Python<'_>,
        time: Option<f64>,
        dt: f64,
        gyro: [f64; 3],
        accel: [f64; 3],
        increments: bool,
    ) -> PyResult<()> {
        self.locked(py, |held| {
            let time = time.unwrap_or(held.estimator.reached() + dt);
            held.begin(&sample(time, dt, gyro, accel, increments))
                .map_err(error)
        })
    }

    /// Takes up a sample and moves to its end, as one step for other threads.
    fn predict(
        &self,
        py: Python<'_>,
        time: Option<f64>,
        dt: f64,
        gyro: [f64; 3],
        accel: [f64; 3],
        increments: bool,
    ) -> PyResult<()> {
        self.locked(py, |held| {
            let time = time.unwrap_or(held.estimator.reached() + dt);
            held.begin(&sample(time, dt, gyro, accel, increments))
                .and_then(|()| held.advance(None))
                .map_err(error)
        })
    }

    /// Moves to a time [s] within the sample taken up, or to its end.
    fn advance(&self, py: Python<'_>, to: Option<f64>) -> PyResult<()> {
        self.locked(py, |held| held.advance(to)).map_err(error)
    }

    /// Carries the filter over samples of `dt` seconds each or, with their ends `times` [s], over the first
    /// of `dt` seconds and the others since the one before; the solution after each as arrays.
    fn predict_many<'py>(
        &self,
        py: Python<'py>,
        times: Option<PyReadonlyArray1<'py, f64>>,
        dt: f64,
        gyro: PyReadonlyArray2<'py, f64>,
        accel: PyReadonlyArray2<'py, f64>,
        increments: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let times = times.as_ref().map(|times| times.as_array());
        let (gyro, accel) = (gyro.as_array(), accel.as_array());
        let count = times.map_or(gyro.nrows(), |times| times.len());
        if gyro.shape() != [count, 3] || accel.shape() != [count, 3] {
            return Err(error(format!(
                "gyro and accel must have {count} rows of 3, not {:?} and {:?}",
                gyro.shape(),
                accel.shape()
            )));
        }
        let rows = work::run(py, || {
            let mut held = self.lock();
            let mut moved = Held {
                estimator: held.estimator.boxed(),
                begun: true,
                fix_errors: held.fix_errors,
                vibration: held.vibration.clone(),
            };
            let mut rows = Vec::with_capacity(count);
            let mut before = None;
            for (k, (rate, force)) in gyro.rows().into_iter().zip(accel.rows()).enumerate() {
                interrupt::check();
                let time = times.map_or(moved.estimator.reached() + dt, |times| times[k]);
                let dt = match before {
                    Some(before) if times.is_some() => time - before,
                    _ => dt,
                };
                before = Some(time);
                let [rate, force] = [rate, force].map(|of| [of[0], of[1], of[2]]);
                moved
                    .begin(&sample(time, dt, rate, force, increments))
                    .and_then(|()| moved.advance(None))
                    .map_err(|problem| error(format!("sample {k} (from 0): {problem}")))?;
                rows.push(row(&*moved.estimator));
            }
            *held = moved;
            Ok::<_, PyErr>(rows)
        })??;
        columns::solution(py, &rows)
    }

    /// Updates with measurements one after the other, with all of them or with none: of each that says something,
    /// kind, innovation, NIS, degrees of freedom, whitened innovation, outcome and factor on the covariance.
    fn update(
        &self,
        py: Python<'_>,
        measurements: Vec<Measured>,
        gate: Option<(f64, f64)>,
    ) -> PyResult<Vec<Updated>> {
        let gate = gate.map_or(Gate::OPEN, |(weaken, reject)| Gate { weaken, reject });
        self.locked(py, |held| {
            let mut filter = held.estimator.boxed();
            let mut done = Vec::new();
            for measured in stated(measurements, &held.fix_errors) {
                let kind = measured.kind.clone();
                let (aiding, noise) = measured.aiding(filter.nav().time, &held.fix_errors)?;
                let innovation = filter.innovation(&aiding);
                let update = filter.update(&aiding, &noise, &gate);
                let update = update.map_err(|problem| error(format!("{kind}: {problem}")))?;
                let both = innovation.zip(update);
                done.extend(both.map(|(innovation, update)| updated(kind, &innovation, update)));
            }
            held.estimator = filter;
            Ok(done)
        })
    }

    /// The state by the names of `undrift.Solution`, each an array of one row.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let row = self.locked(py, |held| row(&*held.estimator));
        columns::solution(py, &[row])
    }

    /// Time that the filter has reached [s].
    #[getter]
    fn time(&self, py: Python<'_>) -> f64 {
        self.locked(py, |held| held.estimator.nav().time)
    }

    /// Covariance of the error state.
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (n, numbers) = self.locked(py, |held| {
            let (n, p) = (held.estimator.states(), held.estimator.covariance());
            (n, (0..n * n).map(|k| p[(k / n, k % n)]).collect())
        });
        columns::table(py, numbers, n)
    }

    /// Estimated parameters: name, values and standard deviations.
    fn parameters(&self, py: Python<'_>) -> Vec<(&'static str, Vec<f64>, Vec<f64>)> {
        self.locked(py, |held| {
            shown()
                .filter_map(|kind| {
                    let (value, std) = held.estimator.parameter(kind)?;
                    let n = kind.width();
                    Some((kind.name(), value[..n].to_vec(), std[..n].to_vec()))
                })
                .collect()
        })
    }
}

impl Filter {
    fn lock(&self) -> MutexGuard<'_, Held> {
        // What a call changes is put in place at its end.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Works on the filter while no other thread does, without the interpreter's lock.
    fn locked<T: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut Held) -> T + Send) -> T {
        py.detach(|| work(&mut self.lock()))
    }
}

/// As [`Filter::update`] gives it.
pub type Updated = (String, Vec<f64>, f64, usize, Vec<f64>, &'static str, f64);

fn updated(kind: String, innovation: &Vector3, update: Update) -> Updated {
    let seen = |of: &[f64]| of[..update.dof].to_vec();
    let (innovation, whitened) = (seen(innovation.as_slice()), seen(&update.whitened));
    let (outcome, factor) = (update.outcome.name(), update.outcome.factor());
    (
        kind, innovation, update.nis, update.dof, whitened, outcome, factor,
    )
}
