//! `DRIVE.toml`: which files make up a drive, what their columns mean, how the IMU sits, how to start.
//!
//! ```toml
//! model = "adis16405"              # preset, file, or a [model] table
//! [imu]
//! file = "imu.csv.gz"
//! time = "t_s"                     # column by name or number; without it, rate = "100 Hz"
//! gyro = ["gx", "gy", "gz"]
//! gyro_unit = "deg/s"
//! accel = ["fx", "fy", "fz"]
//! accel_unit = "g"
//! axes = "x,-y,-z"                 # body forward, right, down from the sensor's axes
//! [gnss]
//! file = "gnss.csv.gz"
//! time = "t_s"
//! position = ["lat_deg", "lon_deg", "height_m"]
//! position_std = "5, 5, 10 m"      # north, east, down
//! lever_arm = "0.1, 0, -1.2 m"     # IMU to antenna, forward, right, down
//! ```
//!
//! All keys are in `docs/drive-file.md`.

mod aids;
mod epoch;
mod error;
pub(crate) mod gnss;
pub(crate) mod imu;
mod keys;
mod logs;
pub(crate) mod magnetometer;
mod memory;
mod named;
pub(crate) mod poses;
mod result;
pub(crate) mod scalars;
pub(crate) mod tables;
#[cfg(test)]
mod tests;
mod text;

pub use aids::{Aids, SensorRead, SensorReader, merged};
pub use epoch::Beginning;
pub(crate) use epoch::OTHER_CLOCK;
pub use error::{ConfigError, DriveError};
pub use imu::{ImuLog, load_imu};
pub(crate) use keys::{DEGREES_MINUTES, UTM, column};
pub use keys::{columns, file_name, model};
pub use logs::Logs;
pub use named::{files_beside, files_named, log_tables};
pub use poses::Poses;
pub use scalars::{ScalarLog, Scalars};
pub(crate) use tables::AXLE_STD;
pub use tables::read_initial;
pub use text::{parse, read_text};
pub use undrift_config::{Section, Table, Value};

use crate::{
    align::{AlignSettings, Heading},
    columns::{IMU_STEP, time_unit},
    replay::{GnssUse, QualityStd},
    settings::fix_errors::{Correlation, StdFactors},
    temperature,
    vehicle::Constraints,
};
use std::path::{Path, PathBuf};
use undrift_base::number::rounded;
use undrift_io::{
    Opened, ReadError,
    epoch::Epoch,
    gnss::{GnssReader, GnssSource},
    imu::{ImuFormat, ImuReader, ImuSource},
    magnetic::MagneticFormat,
    reader::{Kind, Reader},
    source::BytesRead,
    truth::{TruthReader, TruthSource},
};
use undrift_nav::{
    Vector3,
    covariance::AXES,
    parameters::{Parameter, Parameters},
    units::Quantity,
};
use undrift_noise::ImuModel;
use undrift_results::inspect::PoseFault;

/// A drive, ready to be read: from files, [`Drive::load`], or from memory, [`Drive::from_samples`].
///
/// All that takes a drive works with either:
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::{BiasModel, Drive, ImuModel, Vector3, navigate::Wanted, navigate_drive};
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, None, &GnssNoise::default(), 1)?;
///
/// let drive = Drive {
///     model: ImuModel::preset("adis16465"),
///     adapt: true,
///     ..Drive::from_samples(&log.imu, &log.gnss)
/// }
/// .with_lever_arm(Vector3::new(0.3, 0.0, -1.2))
/// .with_truth(&log.truth);
/// let report = navigate_drive(&drive, BiasModel::Arma, Wanted::default())?;
/// assert!(report.summary.fixes > 0 && report.rmse.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Drive {
    /// Inertial log: its file, and the columns or stream, units and axes of its samples.
    pub imu: (PathBuf, ImuFormat),
    /// Bytes read of the inertial log since it was opened last, for progress bars.
    pub imu_read: BytesRead,
    /// Whether the IMU's mounting is to be estimated from the log ([`crate::mounting`]): until then
    /// body axes are the sensor's own.
    pub estimate_mounting: bool,
    /// How well it is known how the IMU sits, one standard deviation about the vehicle's axes, roll, pitch, yaw \[rad\]: the solution's attitude is
    /// so much less certain.
    pub mounting_std: Vector3,
    /// Scale factor errors of the accelerometers, one standard deviation [–], that the covariance covers where they are not estimated.
    pub accel_scale_error: f64,
    /// Where the sensors' white noise follows their vibration: the factors on its standard deviation beyond the model's [–], gyro and
    /// accelerometer x, y, z. `None`: the model's noise throughout.
    pub vibration: Option<[f64; AXES]>,
    /// GNSS log: its file, and how its fixes are read.
    pub gnss: (PathBuf, GnssSource),
    /// Marker and frame, where the fixes are poses in a local frame.
    pub poses: Option<Poses>,
    /// Logs of sensors that measure one number (a wheel speed, a height), where there are such.
    pub scalars: Scalars,
    /// Log of a magnetometer, its axes relative to the inertial sensor's, and what else is known of it.
    pub magnetometer: Option<(PathBuf, MagneticFormat)>,
    /// Errors of the magnetometer that last.
    pub magnetometer_lasting: f64,
    /// Parts of a fix that update the solution.
    pub gnss_use: GnssUse,
    /// Reference solution to compare with, if there is one; it is never used for the solution.
    pub truth: Option<(PathBuf, TruthSource)>,
    /// IMU → antenna, body axes, forward, right, down \[m\].
    pub lever_arm: Vector3,
    /// What is known of the first attitude and velocity.
    pub align: AlignSettings,
    /// Constants that are estimated beside the sensors' errors, each with its prior.
    pub parameters: Parameters,
    /// What the vehicle cannot do.
    pub constraints: Constraints,
    /// Whether fixes pass a gate and a diverged solution is re-initialised; `true` unless the drive file says otherwise.
    pub gating: bool,
    /// Whether the stated standard deviations of the fixes are corrected by the innovations.
    pub adapt: bool,
    /// Rule for the standard deviation of a position by the kind of solution.
    pub quality: QualityStd,
    /// Whether the errors of positions are treated as correlated in time.
    pub correlation: Correlation,
    /// Factors on the standard deviations of the white and the correlated part of the fixes' errors [–], as `undrift tune` finds them.
    pub std_factors: StdFactors,
    /// Noise model of the IMU, if the file names one; without it [`settings`](crate::navigate::settings) refuses the drive.
    pub model: Option<ImuModel>,
    /// Date of the zero that the times of the samples count from, where a log or the drive file states it.
    pub epoch: Option<Epoch>,
    /// Time of the first sample and interval of the inertial log.
    pub beginning: Beginning,
    /// Folder of its logs, the span that is read, and logs in memory.
    pub logs: Logs,
    /// Rate of an inertial log without times \[Hz\], where it is a guess of [`crate::inspect`].
    pub guessed_rate: Option<f64>,
    /// What [`crate::inspect`] found wrong with the poses and took into account.
    pub pose_faults: Vec<PoseFault>,
}

impl Drive {
    /// Reads `DRIVE.toml`. File names in it are relative to `data` or, without it, to its own
    /// folder; a model file always to its own folder.
    ///
    /// # Errors
    /// If the file cannot be read, or as [`Drive::from_toml`].
    pub fn load(path: &Path, data: Option<&Path>) -> Result<Self, DriveError> {
        let (text, file) = read_text(path)?;
        let home = path.parent().unwrap_or(Path::new(""));
        Self::from_toml(&text, &file, home, data.unwrap_or(home))
    }

    /// Reads the text of a `DRIVE.toml`; `file` is its name in messages, `home` the folder that a model file
    /// lies in, `data` the folder of the logs.
    ///
    /// ```
    /// # use undrift_drive as undrift;
    /// use std::path::Path;
    /// use undrift::{Drive, Vector3};
    /// let text = r#"
    /// model = "adis16405"
    /// [imu]
    /// file = "imu.csv"
    /// rate = "100 Hz"
    /// gyro = ["gx", "gy", "gz"]
    /// gyro_unit = "deg/s"
    /// accel = ["fx", "fy", "fz"]
    /// accel_unit = "g"
    /// [gnss]
    /// file = "gnss.csv"
    /// time = "t_s"
    /// position = ["lat_deg", "lon_deg", "height_m"]
    /// position_std = "5, 5, 10 m"
    /// lever_arm = "10, 0, -120 cm"
    /// "#;
    /// let here = Path::new(".");
    /// let drive = Drive::from_toml(text, "drive.toml", here, here)?;
    /// assert!((drive.lever_arm - Vector3::new(0.1, 0.0, -1.2)).norm() < 1e-12);
    /// let wrong = Drive::from_toml(&text.replace("accel_unit", "acel_unit"), "drive.toml", here, here);
    /// assert!(wrong.is_err_and(|error| error.to_string().contains("acel_unit")));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`DriveError::Config`] where the text is no TOML, or a key is missing, unknown or has a wrong value, with
    /// its line; [`DriveError::Model`] for the model; [`DriveError::Read`] where a log has to be looked into
    /// and cannot be read.
    pub fn from_toml(text: &str, file: &str, home: &Path, data: &Path) -> Result<Self, DriveError> {
        let folder = data.to_path_buf();
        let logs = Logs {
            folder,
            ..Logs::default()
        };
        Self::with_logs(text, file, home, logs)
    }

    /// Reads the text of a `DRIVE.toml` in the manner of [`Drive::from_toml`], with logs that are held already: those of a pipe or an upload,
    /// by the names that the text has for them.
    ///
    /// # Errors
    /// As [`Drive::from_toml`].
    pub fn with_logs(text: &str, file: &str, home: &Path, logs: Logs) -> Result<Self, DriveError> {
        let table = parse(text, file)?;
        Self::from_tables(&Section::top(table.get_ref(), text, file), home, logs)
    }

    /// Reads the tables of a drive file that is parsed already, in the manner of [`Drive::with_logs`].
    ///
    /// # Errors
    /// As [`Drive::from_toml`].
    pub fn from_tables(top: &Section, home: &Path, mut logs: Logs) -> Result<Self, DriveError> {
        let tables = [
            "model", "epoch", "initial", "span", "vehicle", "states", "local",
        ];
        top.only(&Vec::from_iter(tables.into_iter().chain(log_tables())))?;
        logs.span = tables::read_span(&top.section("span")?)?;
        let (gnss, posed) = fixes(top)?;
        let gnss_use = match posed {
            true => GnssUse::default(),
            false => gnss::read_use(&gnss)?,
        };
        let antenna = gnss.vector("lever_arm", Quantity::Length)?;
        let lever_arm = antenna.unwrap_or_else(Vector3::zeros);
        if lever_arm.norm() > MOST_LEVER_ARM {
            let message = format!(
                "{:.0} m is longer than any vehicle: check the unit",
                lever_arm.norm()
            );
            return Err(gnss.error("lever_arm", message).into());
        }
        let (mut constraints, parameters) = tables::read_vehicle(&top.section("vehicle")?)?;
        let of_imu = top.section("imu")?;
        let vibration_is_stated = of_imu.get("vibration").is_some();
        let (imu, options) = imu::read_imu(&of_imu, &mut logs)?;
        let states = top.section("states")?;
        let of_poses = match posed {
            true => poses::read_states(&states, gnss.get("marker").is_some())?,
            false => Parameters::none(),
        };
        let mut parameters = tables::read_states(&states, parameters, antenna.is_some())?;
        if posed {
            parameters = poses::beside_poses(parameters);
            for (kind, _, prior) in of_poses.blocks() {
                parameters = parameters.with(kind, prior);
            }
        } else if let Some(prior) = gnss::read_smoothing(&gnss)? {
            parameters = parameters.with(Parameter::Smoothing, prior);
        }
        let (scalars, parameters) = scalars::read(top, &mut logs, parameters)?;
        let (magnetometer, parameters) =
            magnetometer::read(&top.section(magnetometer::TABLE)?, &mut logs, parameters)?;
        constraints.heading_baseline = scalars::read_baseline(&top.section("heading")?)?;
        let quality = match posed {
            true => QualityStd::AsStated,
            false => gnss::read_quality(&gnss)?,
        };
        let correlation = gnss::read_correlation(&gnss)?;
        let std_factors = gnss::read_std_factors(&gnss, posed)?;
        let local = top.section("local")?;
        let (log, poses) = match posed {
            true => {
                let (log, poses) = poses::read(&gnss, &local, &mut logs)?;
                let axes_stated = poses::axes_stated(&states);
                let poses = Poses {
                    axes_stated,
                    ..poses
                };
                (log, Some(poses))
            }
            false => {
                local.only_known()?;
                (gnss::read_gnss(&gnss, &mut logs)?, None)
            }
        };
        let mut drive = Self {
            parameters,
            poses,
            scalars,
            magnetometer: magnetometer.as_ref().map(|(log, _)| log.clone()),
            magnetometer_lasting: magnetometer.map_or(0.0, |(_, lasting)| lasting),
            constraints,
            gating: gnss.switch("gate")?.unwrap_or(true),
            imu,
            imu_read: BytesRead::default(),
            estimate_mounting: options.estimate_mounting,
            mounting_std: options.mounting_std,
            accel_scale_error: options.accel_scale_error,
            // By a hand or a copter as at rest: what shakes above the band of motion is a vehicle's engine.
            vibration: options.vibration.filter(|_| !posed || vibration_is_stated),
            adapt: gnss.switch("adapt")?.unwrap_or(false),
            quality,
            correlation,
            std_factors,
            gnss: log,
            truth: tables::read_truth(&top.section("truth")?, &mut logs)?,
            gnss_use,
            lever_arm,
            align: tables::read_initial(&top.section("initial")?)?,
            model: keys::model(top, "model", home)?,
            epoch: None,
            beginning: Beginning::default(),
            guessed_rate: None,
            pose_faults: Vec::new(),
            logs,
        };
        if posed && drive.align.heading == Heading::Course {
            // A marker's course says nothing of the heading.
            drive.align.heading = Heading::Auto;
        }
        drive.date(epoch::read_epoch(top)?);
        Ok(drive)
    }

    /// Paths of the logs that the drive reads.
    pub fn logs(&self) -> Vec<&Path> {
        let scalars = self.scalars.iter().flatten().map(|(path, _)| path);
        let field = self.magnetometer.iter().map(|(path, _)| path);
        let truth = self.truth.iter().map(|(path, _)| path);
        let logs = [&self.imu.0, &self.gnss.0].into_iter();
        logs.chain(self.gnss.1.beside().iter().map(|(path, _)| path))
            .chain(scalars)
            .chain(field)
            .chain(truth)
            .map(PathBuf::as_path)
            .collect()
    }

    /// Opens the inertial log from its start; its samples are without the bias that the model has over temperature, where the log
    /// has one.
    ///
    /// # Errors
    /// If the file cannot be opened, is not of its format or lacks a column or stream.
    pub fn open_imu(&self) -> Result<ImuReader, ReadError> {
        self.read_imu(self.logs.open(&self.imu.0, &self.imu_read)?)
    }

    /// Reads what is open as the inertial log.
    ///
    /// # Errors
    /// As [`Drive::open_imu`].
    pub fn read_imu(&self, opened: Opened) -> Result<ImuReader, ReadError> {
        temperature::corrected(opened, &self.imu.1, self.model.as_ref())
    }

    /// Opens the GNSS log from its start.
    ///
    /// # Errors
    /// As [`Drive::open_imu`].
    pub fn open_gnss(&self) -> Result<GnssReader, ReadError> {
        self.logs.read(&self.gnss.0, &self.gnss.1)
    }

    /// Reads what is open as the GNSS log.
    ///
    /// # Errors
    /// As [`Drive::open_imu`].
    pub fn read_gnss(&self, opened: Opened) -> Result<GnssReader, ReadError> {
        Reader::new(opened, &self.gnss.1)
    }

    /// Opens the reference from its start, if there is one.
    ///
    /// # Errors
    /// As [`Drive::open_imu`].
    pub fn open_truth(&self) -> Result<Option<TruthReader>, ReadError> {
        self.open_optional(&self.truth)
    }

    fn open_optional<K: Kind>(
        &self,
        log: &Option<(PathBuf, K::Options)>,
    ) -> Result<Option<Reader<K>>, ReadError> {
        let log = log.as_ref();
        log.map(|(path, options)| self.logs.read(path, options))
            .transpose()
    }

    /// Sample interval of the inertial log \[s\]: stated by `imu.rate`, else the mean over its first samples,
    /// gaps not counted.
    ///
    /// # Errors
    /// If the log cannot be read, is too short, or is at another rate than stated, by a fifth or
    /// more, or at one that no IMU has.
    pub fn sample_interval(&self) -> Result<f64, ReadError> {
        let interval = self.any_interval()?;
        if INTERVALS.contains(&interval) {
            return Ok(interval);
        }
        let rate = 1.0 / interval;
        let wrong = match interval > *INTERVALS.end() {
            true => "slow",
            false => "fast",
        };
        let unit = time_unit(&[0.0, interval], IMU_STEP).filter(|(unit, _)| *unit != "s");
        let is_table = matches!(self.imu.1.source, ImuSource::Table { .. });
        let mend = match (self.imu.1.has_times(), unit) {
            _ if !is_table => "choose another log, or another topic of it".to_owned(),
            (true, Some((unit, _))) => {
                format!("the times look like {unit}: set imu.time_unit = \"{unit}\"")
            }
            (true, None) => "correct imu.time_unit".to_owned(),
            (false, _) => "correct imu.rate".to_owned(),
        };
        let problem = format!(
            "{} Hz is too {wrong} for an IMU",
            rounded(rate, RATE_DIGITS)
        );
        Err(ReadError::new(&self.imu.0, problem).mend(mend))
    }

    fn any_interval(&self) -> Result<f64, ReadError> {
        let stated = self.imu.1.rate_hz.map(|rate| 1.0 / rate);
        if let (Some(interval), false) = (stated, self.imu.1.has_times()) {
            return Ok(interval);
        }
        match (stated, self.beginning.interval) {
            (Some(stated), Some(measured)) if !(0.8..1.25).contains(&(measured / stated)) => {
                let problem = format!(
                    "the time column gives {} Hz, but imu.rate is {} Hz",
                    rounded(1.0 / measured, RATE_DIGITS),
                    rounded(1.0 / stated, RATE_DIGITS)
                );
                Err(ReadError::new(&self.imu.0, problem).mend("correct imu.rate or remove it"))
            }
            (Some(interval), _) | (None, Some(interval)) => Ok(interval),
            (None, None) => {
                // As short as it is, or as far as it can be read.
                let unreadable = self.open_imu()?.find_map(Result::err);
                let few = "has too few samples to determine the sample rate";
                Err(unreadable.unwrap_or_else(|| ReadError::new(&self.imu.0, few)))
            }
        }
    }
}

/// The table of what corrects the solution, `[gnss]` or `[poses]`, and whether it is the latter.
fn fixes<'a>(top: &Section<'a>) -> Result<(Section<'a>, bool), ConfigError> {
    let (gnss, poses) = (top.section("gnss")?, top.section("poses")?);
    match (gnss.exists(), poses.exists()) {
        (true, true) => Err(top.error("poses", "set [gnss] or [poses], not both")),
        (_, posed) => Ok((if posed { poses } else { gnss }, posed)),
    }
}

/// Longest lever arm \[m\]: the largest ships are 400 m long.
const MOST_LEVER_ARM: f64 = 100.0;

/// Sample intervals that a log of an IMU may have \[s\].
const INTERVALS: std::ops::RangeInclusive<f64> = 2e-5..=1.0;

/// Digits of a rate in a message.
const RATE_DIGITS: usize = 4;
