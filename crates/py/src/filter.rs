//! The filter, step by step.

use crate::{columns, error::error, model::NoiseModel};
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use undrift::{
    estimator::{self, Aiding, Estimator},
    io::write::solution::SolutionRow,
    nav::{
        Matrix3, Vector3,
        attitude::from_rpy,
        earth::Geodetic,
        filter::{Gate, InitialStd, Outcome, Update},
        mechanisation::NavState,
        parameters::{Parameter, Parameters, Prior},
        sample::{ImuSample, Position},
    },
    navigate::solution_row,
};

/// The parameters that can be estimated, by their names.
const PARAMETERS: [(&str, Parameter); 11] = [
    ("gyro_scale", Parameter::GyroScale),
    ("accel_scale", Parameter::AccelScale),
    ("gyro_misalignment", Parameter::GyroMisalignment),
    ("accel_misalignment", Parameter::AccelMisalignment),
    ("lever_arm", Parameter::LeverArm),
    ("time_offset", Parameter::TimeOffset),
    ("mounting", Parameter::Mounting),
    ("axle", Parameter::Axle),
    ("odometer_scale", Parameter::OdometerScale),
    ("barometer_bias", Parameter::BarometerBias),
    ("velocity_time_offset", Parameter::VelocityTimeOffset),
];

/// The filter; `undrift.Filter` wraps it.
#[pyclass(module = "undrift._undrift")]
pub struct Filter(Box<dyn Estimator>);

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
fn sample(
    time: f64,
    dt: f64,
    gyro: [f64; 3],
    accel: [f64; 3],
    increments: bool,
) -> PyResult<ImuSample> {
    if !(dt > 0.0 && dt.is_finite() && time.is_finite()) {
        return Err(error(format!(
            "invalid sample: dt = {dt} s at t = {time} s"
        )));
    }
    let (gyro, accel) = (Vector3::from(gyro), Vector3::from(accel));
    if gyro.iter().chain(&accel).any(|value| !value.is_finite()) {
        return Err(error("a sample has a value that is not finite"));
    }
    let factor = if increments { 1.0 } else { dt };
    Ok(ImuSample {
        time,
        dt,
        dtheta: gyro * factor,
        dvel: accel * factor,
    })
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
            let known = PARAMETERS.iter().find(|(other, _)| *other == name);
            let Some((_, kind)) = known else {
                let names = PARAMETERS.map(|(name, _)| name).join(", ");
                return Err(error(format!(
                    "unknown parameter \"{name}\"; available: {names}"
                )));
            };
            if !(std > 0.0 && std.is_finite() && walk >= 0.0 && walk.is_finite()) {
                return Err(error(format!("{name}: invalid standard deviation {std}")));
            }
            asked = asked.with(
                *kind,
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
        Ok(Self(filter))
    }

    /// Takes up a sample of `dt` seconds that ends at `time` [s] without moving yet.
    fn begin(
        &mut self,
        time: f64,
        dt: f64,
        gyro: [f64; 3],
        accel: [f64; 3],
        increments: bool,
    ) -> PyResult<()> {
        self.0.begin(&sample(time, dt, gyro, accel, increments)?);
        Ok(())
    }

    /// Moves to a time [s] within the sample taken up, or to its end.
    fn advance(&mut self, to: Option<f64>) {
        self.0.advance(to);
    }

    /// Carries the filter over samples of `dt` seconds each or, with their ends `times` [s], over the first
    /// of `dt` seconds and the others since the one before; the solution after each as arrays.
    fn predict_many<'py>(
        &mut self,
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
        let filter = &mut self.0;
        let rows = py.detach(|| {
            let mut rows = Vec::with_capacity(count);
            let (mut before, mut dt) = (None, dt);
            for (k, (rate, force)) in gyro.rows().into_iter().zip(accel.rows()).enumerate() {
                let time = match times {
                    Some(times) => times[k],
                    None => filter.nav().time + dt,
                };
                if let (Some(before), Some(_)) = (before, times) {
                    dt = time - before;
                }
                before = Some(time);
                let [rate, force] = [rate, force].map(|of| [of[0], of[1], of[2]]);
                filter.begin(&sample(time, dt, rate, force, increments)?);
                filter.advance(None);
                rows.push(row(&**filter));
            }
            filter.check().map_err(error)?;
            Ok::<_, PyErr>(rows)
        })?;
        columns::solution(py, &rows)
    }

    /// Updates with a measurement, `None` if it says nothing: innovation, NIS, degrees of freedom,
    /// whitened innovation, outcome and factor on the covariance.
    #[pyo3(signature = (kind, value, std=0.0, lever_arm=[0.0; 3], covariance=None, gate=None))]
    fn update(
        &mut self,
        kind: &str,
        value: [f64; 3],
        std: f64,
        lever_arm: [f64; 3],
        covariance: Option<[[f64; 3]; 3]>,
        gate: Option<(f64, f64)>,
    ) -> PyResult<Option<Updated>> {
        let numbers = value.iter().chain(&lever_arm).chain([&std]);
        if numbers
            .chain(covariance.iter().flatten().flatten())
            .any(|x| !x.is_finite())
        {
            return Err(error(format!("{kind}: a number is not finite")));
        }
        let (lever_arm, due) = (Vector3::from(lever_arm), self.0.nav().time);
        let mut noise =
            covariance.map_or_else(|| Matrix3::identity() * (std * std), columns::matrix);
        let aiding = match kind {
            "position" => Aiding::Position {
                position: Position::Geodetic(geodetic(value)),
                lever_arm,
                correlated: Vector3::zeros(),
                due,
            },
            "velocity" => Aiding::Velocity {
                v_n: Vector3::from(value),
                lever_arm,
                correlated: Vector3::zeros(),
                due,
            },
            "zero velocity" => Aiding::ZeroVelocity,
            "earth rate" => Aiding::EarthRate(Vector3::from(value)),
            "level" => Aiding::Level(Vector3::from(value)),
            "non-holonomic" => {
                let [right, down, _] = value;
                noise = Matrix3::from_diagonal(&Vector3::new(right * right, down * down, 0.0));
                Aiding::NonHolonomic(lever_arm)
            }
            "odometer" => Aiding::Odometer {
                speed: value[0],
                lever_arm,
            },
            "barometer" => Aiding::Barometer(value[0]),
            "course" => Aiding::Course(value[0]),
            other => return Err(error(format!("unknown measurement \"{other}\""))),
        };
        let gate = gate.map_or(Gate::OPEN, |(weaken, reject)| Gate { weaken, reject });
        let innovation = self.0.innovation(&aiding);
        let update = self.0.update(&aiding, &noise, &gate).map_err(error)?;
        self.0.check().map_err(error)?;
        Ok(innovation
            .zip(update)
            .map(|(innovation, update)| updated(&innovation, update)))
    }

    /// The state by the names of `undrift.Solution`, each an array of one row.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        columns::solution(py, &[row(&*self.0)])
    }

    /// Time that the filter has reached [s].
    #[getter]
    fn time(&self) -> f64 {
        self.0.nav().time
    }

    /// Covariance of the error state.
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (n, p) = (self.0.states(), self.0.covariance());
        let numbers = (0..n * n).map(|k| p[(k / n, k % n)]).collect();
        columns::table(py, numbers, n)
    }

    /// Estimated parameters: name, values and standard deviations.
    fn parameters(&self) -> Vec<(&'static str, Vec<f64>, Vec<f64>)> {
        let all = PARAMETERS.iter();
        all.filter_map(|(name, kind)| {
            let (value, std) = self.0.parameter(*kind)?;
            let n = kind.width();
            Some((*name, value[..n].to_vec(), std[..n].to_vec()))
        })
        .collect()
    }
}

/// As [`Filter::update`] gives it.
pub type Updated = (Vec<f64>, f64, usize, Vec<f64>, &'static str, f64);

fn updated(innovation: &Vector3, update: Update) -> Updated {
    let (outcome, factor) = match update.outcome {
        Outcome::Used => ("used", 1.0),
        Outcome::Weakened(factor) => ("weakened", factor),
        Outcome::Rejected => ("rejected", f64::INFINITY),
    };
    let seen = |of: &[f64]| of[..update.dof].to_vec();
    let (innovation, whitened) = (seen(innovation.as_slice()), seen(&update.whitened));
    (
        innovation, update.nis, update.dof, whitened, outcome, factor,
    )
}
