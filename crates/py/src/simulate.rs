//! Simulated drives.

use crate::{
    columns::{Arrays, Named, array, coordinates, matrix_std, table},
    error::error,
    model::NoiseModel,
    work,
};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::io::{BufWriter, Write};
use std::path::PathBuf;
use undrift::{
    io::write::PendingFile,
    nav::{
        Vector3,
        attitude::from_rpy,
        earth::Geodetic,
        sample::{Position, TruthSample},
    },
    simulate::{self as simulation, GnssNoise, PoseNoise, Trajectory},
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
    #[pyo3(item)]
    swing: f64,
}

impl Motion {
    fn trajectory(&self, seed: u64) -> PyResult<Trajectory> {
        let Self {
            duration,
            speed,
            course,
            turn_rate,
            swing,
            ..
        } = *self;
        if !(0.0..=simulation::MAX_DURATION).contains(&duration) {
            return Err(error(format!(
                "cannot simulate a drive of {duration} s; the maximum is {} s",
                simulation::MAX_DURATION
            )));
        }
        Ok(match self.kind.as_str() {
            "car" => Trajectory::car(duration, seed),
            "flight" => Trajectory::flight(duration, seed),
            "handheld" => Trajectory::handheld(duration, swing, seed),
            "rest" => Trajectory::rest(duration),
            "straight" => Trajectory::straight(speed, course, duration),
            "turn" => Trajectory::constant_turn(speed, turn_rate, duration),
            other => {
                return Err(error(format!(
                    "unknown trajectory \"{other}\"; available: car, flight, handheld, rest, straight, turn"
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
    let made = work::run(py, || {
        simulation::simulate(&trajectory, rate, filters.as_ref(), &noise, seed)
    });
    let made = made?.map_err(error)?;

    let imu = Arrays::new(py, &made.imu)
        .one("time", |sample| sample.time)?
        .three("gyro", |sample| array(&(sample.dtheta / sample.dt)))?
        .three("accel", |sample| array(&(sample.dvel / sample.dt)))?;
    let unknown = [f64::NAN; 3];
    let gnss = Arrays::new(py, &made.gnss)
        .one("time", |fix| fix.time)?
        .place(|fix| match fix.position {
            Some((Position::Geodetic(place), _)) => coordinates(&place),
            _ => unknown,
        })?
        .three("position_std", |fix| {
            fix.position.map_or(unknown, |(_, r)| matrix_std(&r))
        })?
        .three("velocity", |fix| {
            fix.velocity.map_or(unknown, |(v, _)| array(&v))
        })?
        .three("velocity_std", |fix| {
            fix.velocity.map_or(unknown, |(_, r)| matrix_std(&r))
        })?;
    let truth = Arrays::new(py, &made.truth)
        .one("time", |at| at.time)?
        .place(|at| coordinates(&at.position))?
        .three("velocity", |at| at.v_n.map_or(unknown, |v| array(&v)))?
        .three("rpy", |at| at.rpy.map_or(unknown, |v| array(&v)))?;
    Ok([imu.dict(), gnss.dict(), truth.dict()])
}

/// A marker and how it is seen.
#[derive(FromPyObject)]
pub struct Marker {
    #[pyo3(item)]
    position_std: f64,
    #[pyo3(item)]
    attitude_std: f64,
    #[pyo3(item)]
    marker: [f64; 3],
    #[pyo3(item)]
    lever_arm: [f64; 3],
    #[pyo3(item)]
    time_offset: f64,
}

/// Poses of a marker by the truth at the IMU: times, places [rad, m] and roll, pitch, yaw [rad]; the frame begins at the first place, x
/// north, z up.
#[pyfunction]
pub fn simulate_poses<'py>(
    py: Python<'py>,
    times: PyReadonlyArray1<'py, f64>,
    places: PyReadonlyArray2<'py, f64>,
    rpy: PyReadonlyArray2<'py, f64>,
    marker: Marker,
    seed: u64,
) -> PyResult<Bound<'py, PyDict>> {
    let (times, places, rpy) = (times.as_array(), places.as_array(), rpy.as_array());
    let truth = (0..times.len()).map(|k| TruthSample {
        time: times[k],
        position: Geodetic {
            lat: places[(k, 0)],
            lon: places[(k, 1)],
            height: places[(k, 2)],
        },
        v_n: None,
        rpy: Some(Vector3::new(rpy[(k, 0)], rpy[(k, 1)], rpy[(k, 2)])),
    });
    let truth: Vec<TruthSample> = truth.collect();
    let seen = PoseNoise {
        position_std: marker.position_std,
        attitude_std: marker.attitude_std,
        marker: from_rpy(&Vector3::from(marker.marker)),
        lever_arm: Vector3::from(marker.lever_arm),
        clock: marker.time_offset,
        ..PoseNoise::default()
    };
    let origin = truth.first().map(|first| first.position);
    let poses = origin.map_or_else(Vec::new, |origin| seen.measure(truth, &origin, seed));
    let attitudes = poses
        .iter()
        .flat_map(|pose| <[f64; 4]>::from(pose.attitude.coords));
    let attitudes = table(py, attitudes.collect(), 4)?;
    let arrays = Arrays::new(py, &poses)
        .one("time", |pose| pose.time)?
        .three("position", |pose| array(&pose.position))?;
    let poses = arrays.dict();
    poses.set_item("attitude", attitudes)?;
    Ok(poses)
}

/// Writes columns as CSV, every number with the digits that it takes to read it back as it is.
#[pyfunction]
pub fn write_csv(py: Python<'_>, path: PathBuf, columns: Named<'_>) -> PyResult<()> {
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    let head = names.join(",");
    let columns = columns.iter().map(|(_, values)| values.as_array().to_vec());
    let columns: Vec<Vec<f64>> = columns.collect();
    let rows = columns.first().map_or(0, Vec::len);
    let write = || {
        let mut file = BufWriter::new(PendingFile::create(&path)?);
        writeln!(file, "{head}")?;
        for row in 0..rows {
            for (k, column) in columns.iter().enumerate() {
                let comma = if k > 0 { "," } else { "" };
                // A missing value is an empty cell.
                match column.get(row).copied().filter(|value| !value.is_nan()) {
                    None => write!(file, "{comma}")?,
                    Some(value) => write!(file, "{comma}{value:?}")?,
                }
            }
            writeln!(file)?;
        }
        file.into_inner()?.finish()
    };
    py.detach(write)
        .map_err(|e: std::io::Error| error(format!("cannot write {}: {e}", path.display())))
}
