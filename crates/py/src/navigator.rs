//! The navigator, pushed sample by sample while the vehicle drives.

use crate::{columns, drive::Drive, error::error, model, work};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, PoisonError};
use undrift::{
    engine::{self, Event, Measurement, Scalar, ScalarLog},
    io::write::solution::SolutionRow,
    nav::{
        Vector3,
        earth::Geodetic,
        parameters::Parameter,
        sample::{FixQuality, GnssFix, ImuSample, MagneticField, Position},
    },
    navigate::{Clock, Rows, settings},
    noise::interrupt,
};
use undrift_report::say;

/// The navigator; `undrift.Navigator` wraps it.
#[pyclass(frozen, module = "undrift._undrift")]
pub struct Navigator {
    running: Mutex<Running>,
    /// Interval of the samples [s].
    interval: f64,
}

struct Running {
    navigator: engine::Navigator,
    rows: Rows,
    /// The solution at the end of the sample before the newest.
    row: Option<SolutionRow>,
    /// Time of the newest sample [s].
    newest: Option<f64>,
}

/// Position, or velocity, with its covariance as rows.
type Part = Option<([f64; 3], [[f64; 3]; 3])>;

#[pymethods]
impl Navigator {
    /// With the settings of a drive; measurements may come up to `horizon` [s] late.
    #[new]
    fn new(
        py: Python<'_>,
        drive: &Drive,
        bias_model: &str,
        horizon: f64,
        clock: Option<&str>,
    ) -> PyResult<Self> {
        let kind = model::bias_model(bias_model)?;
        let clock: Option<Clock> = clock.map(str::parse).transpose().map_err(error)?;
        let settings = py.detach(|| settings(&drive.drive, kind)).map_err(error)?;
        Ok(Self {
            interval: settings.sensors[0].interval,
            running: Mutex::new(Running {
                navigator: engine::Navigator::new(settings).with_horizon(horizon),
                rows: Rows::new(clock.unwrap_or_default()),
                row: None,
                newest: None,
            }),
        })
    }

    /// Pushes a sample that ends at `time` [s]: whether there is a new solution.
    fn imu(
        &self,
        py: Python<'_>,
        time: f64,
        dt: Option<f64>,
        gyro: [f64; 3],
        accel: [f64; 3],
        increments: bool,
    ) -> PyResult<bool> {
        self.locked(py, |running| {
            let row = running.imu(time, dt, self.interval, [gyro, accel], increments)?;
            Ok::<_, engine::PushError>(row.is_some())
        })
        .map_err(error)
    }

    /// Pushes samples that end at `times` [s]; the solution after each that has one, as arrays. Samples before one that is
    /// refused are pushed.
    fn imu_many<'py>(
        &self,
        py: Python<'py>,
        times: PyReadonlyArray1<'py, f64>,
        gyro: PyReadonlyArray2<'py, f64>,
        accel: PyReadonlyArray2<'py, f64>,
        increments: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (times, gyro, accel) = (times.as_array(), gyro.as_array(), accel.as_array());
        let count = times.len();
        if gyro.shape() != [count, 3] || accel.shape() != [count, 3] {
            return Err(error(format!(
                "gyro and accel must have {count} rows of 3, not {:?} and {:?}",
                gyro.shape(),
                accel.shape()
            )));
        }
        let rows = work::run(py, || {
            let mut running = self.running.lock().unwrap_or_else(PoisonError::into_inner);
            let mut rows = Vec::with_capacity(count);
            for k in 0..count {
                interrupt::check();
                let both = [&gyro, &accel].map(|all| [0, 1, 2].map(|i| all[(k, i)]));
                let pushed = running.imu(times[k], None, self.interval, both, increments);
                let row =
                    pushed.map_err(|problem| error(format!("sample {k} (from 0): {problem}")))?;
                rows.extend(row);
            }
            Ok::<_, PyErr>(rows)
        })??;
        columns::solution(py, &rows)
    }

    /// Pushes a fix: whether it came within the horizon.
    fn fix(&self, py: Python<'_>, time: f64, position: Part, velocity: Part) -> PyResult<bool> {
        let fix = GnssFix {
            attitude: None,
            mean_velocity: None,
            time,
            position: position.map(|([lat, lon, height], covariance)| {
                let place = Position::Geodetic(Geodetic { lat, lon, height });
                (place, columns::matrix(covariance))
            }),
            velocity: velocity
                .map(|(v_n, covariance)| (Vector3::from(v_n), columns::matrix(covariance))),
            quality: FixQuality::Unknown,
        };
        self.measure(py, Measurement::Gnss(fix))
    }

    /// Pushes a measurement of one number by its name: whether it came within the horizon.
    fn scalar(
        &self,
        py: Python<'_>,
        name: &str,
        time: f64,
        value: f64,
        std: f64,
    ) -> PyResult<bool> {
        let known = ScalarLog::ALL.into_iter().find(|log| log.name() == name);
        let known = known.ok_or_else(|| error(format!("unknown measurement \"{name}\"")))?;
        self.measure(py, Measurement::of(known, Scalar { time, value, std }))
    }

    /// Pushes a magnetic field in body axes [T]: whether it came within the horizon.
    fn magnetometer(&self, py: Python<'_>, time: f64, field: [f64; 3], std: f64) -> PyResult<bool> {
        let field = Vector3::from(field);
        self.measure(
            py,
            Measurement::Magnetometer(MagneticField { time, field, std }),
        )
    }

    /// The events since the last call: time [s], kind and sentence.
    fn events(&self, py: Python<'_>) -> Vec<(f64, &'static str, String)> {
        let events = self.locked(py, |running| running.navigator.events());
        let said = |event: &Event| (event.time(), kind(event), say::event(event));
        events.iter().map(said).collect()
    }

    /// The solution by the names of `undrift.Solution`, each an array of one row; `None` before the alignment.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let row = self.locked(py, |running| running.row);
        row.map(|row| columns::solution(py, &[row])).transpose()
    }

    /// Estimated parameters: name, values and standard deviations.
    fn parameters(&self, py: Python<'_>) -> Vec<(&'static str, Vec<f64>, Vec<f64>)> {
        self.locked(py, |running| {
            let Some(filter) = running.navigator.filter() else {
                return Vec::new();
            };
            let stated = |kind: Parameter| {
                let (value, std) = filter.parameter(kind)?;
                let n = kind.width();
                Some((kind.name(), value[..n].to_vec(), std[..n].to_vec()))
            };
            crate::filter::estimable().filter_map(stated).collect()
        })
    }

    /// Measurements that came too late for the horizon.
    #[getter]
    fn too_late(&self, py: Python<'_>) -> u64 {
        self.locked(py, |running| running.navigator.too_late())
    }

    /// Time beyond a sample's end up to which fixes may be stamped that hold within it [s].
    #[getter]
    fn ahead(&self, py: Python<'_>) -> f64 {
        self.locked(py, |running| running.navigator.ahead())
    }
}

impl Navigator {
    fn measure(&self, py: Python<'_>, measurement: Measurement) -> PyResult<bool> {
        self.locked(py, |running| running.navigator.measure(measurement))
            .map_err(error)
    }

    /// Works on the navigator while no other thread does, without the interpreter's lock.
    fn locked<T: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut Running) -> T + Send) -> T {
        py.detach(|| work(&mut self.running.lock().unwrap_or_else(PoisonError::into_inner)))
    }
}

impl Running {
    /// Pushes a sample of rates, or increments; its length is by default the time since the one before. The solution where there is a
    /// new one.
    fn imu(
        &mut self,
        time: f64,
        dt: Option<f64>,
        interval: f64,
        [gyro, accel]: [[f64; 3]; 2],
        increments: bool,
    ) -> Result<Option<SolutionRow>, engine::PushError> {
        let since = self.newest.map_or(interval, |newest| time - newest);
        // What does not go on is refused by the navigator, whatever its length.
        let dt = dt.unwrap_or(if since > 0.0 { since } else { interval });
        let factor = if increments { 1.0 } else { dt };
        self.navigator.imu(ImuSample {
            time,
            dt,
            dtheta: Vector3::from(gyro) * factor,
            dvel: Vector3::from(accel) * factor,
        })?;
        self.newest = Some(time);
        let filter = self.navigator.filter();
        let row = filter.and_then(|filter| self.rows.row(filter));
        self.row = row.or(self.row.filter(|_| filter.is_some()));
        Ok(row)
    }
}

/// The name of an event's kind.
fn kind(event: &Event) -> &'static str {
    match event {
        Event::Started(..) => "started",
        Event::SampleFault(_) => "sample_fault",
        Event::Rejected(_) => "rejected",
        Event::Doubted(_) => "accepted_in_the_end",
        Event::HeadingOff(_) => "heading_off",
        Event::HeadingsRejected(_) => "headings_rejected",
        Event::FieldDisturbed(_) => "field_disturbed",
        Event::Leant(_) => "one_sided",
        Event::AlignsAgain(..) => "aligns_again",
        Event::FixErrors(..) => "fix_errors",
        Event::Mounting(..) => "mounting",
        Event::Resumed(_) => "resumed",
        Event::Diverged(_) => "diverged",
        Event::TooLate(_) => "too_late",
    }
}
