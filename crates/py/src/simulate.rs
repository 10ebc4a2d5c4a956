//! Simulated drives.

use crate::{
    columns::{Named, array, matrix_std, one, three},
    error::error,
    model::NoiseModel,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::io::{BufWriter, Write};
use std::path::PathBuf;
use undrift::{
    io::write::PendingFile,
    nav::{
        Vector3,
        sample::{GnssFix, Position},
    },
    simulate::{self as simulation, GnssNoise, Trajectory},
};

/// What moves how: the parameters that a trajectory does not have are not looked at.
#[derive(FromPyObject)]
pub struct Motion {
    #[pyo3(item)]
    kind: String,
    #[pyo3(item)]
    duration: f64,
    #[pyo3(item)]
    speed: f64,
    #[pyo3(item)]
    course: f64,
    #[pyo3(item)]
    turn_rate: f64,
}

impl Motion {
    fn trajectory(&self, seed: u64) -> PyResult<Trajectory> {
        let Self {
            duration,
            speed,
            course,
            turn_rate,
            ..
        } = *self;
        if !(0.0..=simulation::MAX_DURATION).contains(&duration) {
            return Err(error(format!(
                "a drive of {duration} s cannot be simulated, it may last up to {} s",
                simulation::MAX_DURATION
            )));
        }
        Ok(match self.kind.as_str() {
            "car" => Trajectory::car(duration, seed),
            "flight" => Trajectory::flight(duration, seed),
            "rest" => Trajectory::rest(duration),
            "straight" => Trajectory::straight(speed, course, duration),
            "turn" => Trajectory::constant_turn(speed, turn_rate, duration),
            other => {
                return Err(error(format!(
                    "unknown trajectory \"{other}\"; there are car, flight, rest, straight, turn"
                )));
            }
        })
    }
}

/// The receiver, by the names of `undrift.GnssReceiver`.
#[derive(FromPyObject)]
pub struct Receiver {
    #[pyo3(item)]
    position_std: [f64; 3],
    #[pyo3(item)]
    velocity_std: [f64; 3],
    #[pyo3(item)]
    noise_scale: f64,
    #[pyo3(item)]
    rate: f64,
    #[pyo3(item)]
    start: f64,
    #[pyo3(item)]
    time_offset: f64,
    #[pyo3(item)]
    lever_arm: [f64; 3],
    #[pyo3(item)]
    position: bool,
    #[pyo3(item)]
    velocity: bool,
}

/// Simulates a drive: the logs of the IMU and the receiver, and the truth, as arrays.
#[pyfunction]
pub fn simulate<'py>(
    py: Python<'py>,
    motion: Motion,
    rate: f64,
    model: Option<&NoiseModel>,
    bias_model: &str,
    receiver: Receiver,
    seed: u64,
) -> PyResult<[Bound<'py, PyDict>; 3]> {
    let filters = model
        .map(|model| model.filters(bias_model, rate))
        .transpose()?;
    let noise = GnssNoise {
        position_std: receiver.position_std,
        velocity_std: receiver.velocity_std,
        noise_scale: receiver.noise_scale,
        rate_hz: receiver.rate,
        start: receiver.start,
        time_offset: receiver.time_offset,
        lever_arm: Vector3::from(receiver.lever_arm),
        with_position: receiver.position,
        with_velocity: receiver.velocity,
    };
    let trajectory = motion.trajectory(seed)?;
    let made =
        py.detach(|| simulation::simulate(&trajectory, rate, filters.as_ref(), &noise, seed));
    let made = made.map_err(error)?;

    let imu = PyDict::new(py);
    imu.set_item("time", one(py, &made.imu, |sample| sample.time))?;
    imu.set_item("gyro", three(py, &made.imu, |s| array(&(s.dtheta / s.dt)))?)?;
    imu.set_item("accel", three(py, &made.imu, |s| array(&(s.dvel / s.dt)))?)?;

    let gnss = PyDict::new(py);
    let place = |fix: &GnssFix| match fix.position {
        Some((Position::Geodetic(place), _)) => [place.lat, place.lon, place.height],
        _ => [f64::NAN; 3],
    };
    let fixes = &made.gnss;
    let unknown = [f64::NAN; 3];
    gnss.set_item("time", one(py, fixes, |fix| fix.time))?;
    for (k, name) in ["lat", "lon", "height"].into_iter().enumerate() {
        gnss.set_item(name, one(py, fixes, |fix| place(fix)[k]))?;
    }
    gnss.set_item(
        "position_std",
        three(py, fixes, |fix| {
            fix.position.map_or(unknown, |(_, r)| matrix_std(&r))
        })?,
    )?;
    gnss.set_item(
        "velocity",
        three(py, fixes, |fix| {
            fix.velocity.map_or(unknown, |(v, _)| array(&v))
        })?,
    )?;
    gnss.set_item(
        "velocity_std",
        three(py, fixes, |fix| {
            fix.velocity.map_or(unknown, |(_, r)| matrix_std(&r))
        })?,
    )?;

    let truth = PyDict::new(py);
    truth.set_item("time", one(py, &made.truth, |at| at.time))?;
    truth.set_item("lat", one(py, &made.truth, |at| at.position.lat))?;
    truth.set_item("lon", one(py, &made.truth, |at| at.position.lon))?;
    truth.set_item("height", one(py, &made.truth, |at| at.position.height))?;
    truth.set_item(
        "velocity",
        three(py, &made.truth, |at| at.v_n.map_or(unknown, |v| array(&v)))?,
    )?;
    truth.set_item(
        "rpy",
        three(py, &made.truth, |at| at.rpy.map_or(unknown, |v| array(&v)))?,
    )?;
    Ok([imu, gnss, truth])
}

/// Writes columns as CSV, every number with the digits that it takes to read it back as it is.
#[pyfunction]
pub fn write_csv(py: Python<'_>, path: PathBuf, columns: Named<'_>) -> PyResult<()> {
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    let columns: Vec<Vec<f64>> = columns
        .iter()
        .map(|(_, values)| values.as_array().to_vec())
        .collect();
    let rows = columns.first().map_or(0, Vec::len);
    let write = || {
        let mut file = BufWriter::new(PendingFile::create(&path)?);
        writeln!(file, "{}", names.join(","))?;
        let mut line = String::new();
        for row in 0..rows {
            use std::fmt::Write as _;
            line.clear();
            for (k, column) in columns.iter().enumerate() {
                let value = column.get(row).copied().unwrap_or(f64::NAN);
                let comma = if k > 0 { "," } else { "" };
                // Writing into a String cannot fail. NaN stands for what is not there.
                let _ = match value.is_nan() {
                    true => write!(line, "{comma}"),
                    false => write!(line, "{comma}{value:?}"),
                };
            }
            writeln!(file, "{line}")?;
        }
        file.into_inner()?.finish()
    };
    py.detach(write)
        .map_err(|e: std::io::Error| error(format!("cannot write {}: {e}", path.display())))
}

/// Adds what is in this file to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(simulate, module)?)?;
    module.add_function(wrap_pyfunction!(write_csv, module)?)
}
