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

mod section;

pub use section::{ConfigError, Section};

use crate::align::{AlignSettings, Heading};
use section::line_at;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};
use undrift_io::{
    ReadError,
    gnss::{GnssFormat, GnssReader, Place, PositionFormat, Std, VelocityFormat},
    imu::{ImuFormat, ImuReader},
    rtklib::{self, RtklibOptions},
    truth::{TruthFormat, TruthReader},
};
use undrift_nav::{
    Matrix3, Vector3,
    attitude::from_rpy,
    earth::Geodetic,
    sample::{GnssFix, ImuSample},
    units::Quantity,
};
use undrift_noise::{ImuModel, ModelError};

/// A drive, ready to be read.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Inertial log.
    pub imu: (PathBuf, ImuFormat),
    /// GNSS log.
    pub gnss: (PathBuf, GnssSource),
    /// Whether the positions and the velocities of the fixes are used.
    pub gnss_use: (bool, bool),
    /// Reference solution, if there is one.
    pub truth: Option<(PathBuf, TruthFormat)>,
    /// IMU → antenna, body axes [m].
    pub lever_arm: Vector3,
    /// How to start.
    pub align: AlignSettings,
    /// Noise model of the IMU, if the file names one.
    pub model: Option<ImuModel>,
}

/// Layout of the GNSS log.
#[derive(Clone, Debug)]
pub enum GnssSource {
    /// Delimited text.
    Csv(GnssFormat),
    /// RTKLIB solution file.
    Rtklib(RtklibOptions),
}

/// Why a drive cannot be set up.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// `DRIVE.toml` says something it cannot.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A log cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The model cannot be read.
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl Drive {
    /// Reads `DRIVE.toml`. File names in it are relative to `data` or, without it, to its own
    /// folder; a model file always to its own folder.
    pub fn load(path: &Path, data: Option<&Path>) -> Result<Self, DriveError> {
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|e| ConfigError {
            file: file.clone(),
            line: None,
            key: String::new(),
            message: format!("cannot be read: {e}"),
        })?;
        let home = path.parent().unwrap_or(Path::new(""));
        Self::from_toml(&text, &file, home, data.unwrap_or(home))
    }

    /// Reads the text of a `DRIVE.toml`; `file` is what messages call it, `home` where a model file
    /// lies, `data` where the logs lie.
    pub fn from_toml(text: &str, file: &str, home: &Path, data: &Path) -> Result<Self, DriveError> {
        let table = DeTable::parse(text).map_err(|e| ConfigError {
            file: file.to_owned(),
            line: e.span().map(|s| line_at(text, s.start)),
            key: String::new(),
            message: e.message().to_owned(),
        })?;
        let top = Section::top(table.get_ref(), text, file);
        let span = read_span(&top.section("span")?)?;
        let gnss = top.section("gnss")?;
        let gnss_use = read_use(&gnss)?;
        let lever_arm = gnss.vector("lever_arm", Quantity::Length)?.unwrap_or_else(Vector3::zeros);
        let drive = Self {
            imu: read_imu(&top.section("imu")?, data, span)?,
            gnss: read_gnss(&gnss, data, span)?,
            truth: read_truth(&top.section("truth")?, data)?,
            gnss_use,
            lever_arm,
            align: read_initial(&top.section("initial")?)?,
            model: match top.get("model") {
                None => None,
                Some((DeValue::String(name), _)) => Some(ImuModel::resolve(name, home)?),
                Some((DeValue::Table(table), _)) => Some(ImuModel::from_spanned(table, text, file, "model")?),
                Some(_) => return Err(top.error("model", "must be a preset's name, a file, or a table").into()),
            },
        };
        top.only_known()?;
        Ok(drive)
    }

    /// Opens the inertial log from its start.
    pub fn open_imu(&self) -> Result<ImuReader, ReadError> {
        ImuReader::open(&self.imu.0, &self.imu.1)
    }

    /// Opens the GNSS log from its start.
    pub fn open_gnss(&self) -> Result<GnssReader, ReadError> {
        match &self.gnss.1 {
            GnssSource::Csv(format) => GnssReader::open_csv(&self.gnss.0, format),
            GnssSource::Rtklib(options) => GnssReader::open_rtklib(&self.gnss.0, options),
        }
    }

    /// The parts of a fix that the drive file wants used.
    pub fn used(&self, fix: GnssFix) -> GnssFix {
        GnssFix {
            position: fix.position.filter(|_| self.gnss_use.0),
            velocity: fix.velocity.filter(|_| self.gnss_use.1),
            ..fix
        }
    }

    /// Opens the reference from its start, if there is one.
    pub fn open_truth(&self) -> Result<Option<TruthReader>, ReadError> {
        self.truth
            .as_ref()
            .map(|(path, format)| TruthReader::open(path, format))
            .transpose()
    }

    /// The log's sample interval [s]: stated by `imu.rate`, else the mean over its first samples,
    /// gaps left out.
    pub fn sample_interval(&self) -> Result<f64, ReadError> {
        if let Some(rate) = self.imu.1.rate_hz {
            return Ok(1.0 / rate);
        }
        let first: Vec<f64> = self
            .open_imu()?
            .take(PROBE)
            .map(|s| s.map(|s: ImuSample| s.dt))
            .collect::<Result<_, _>>()?;
        mean_interval(&first).ok_or_else(|| ReadError::new(&self.imu.0, "has no two samples to take a sample rate from"))
    }
}

/// Whether the third component of a velocity is up.
const VELOCITY_AXES: [(&str, bool); 2] = [("north,east,down", false), ("north,east,up", true)];

/// Samples looked at for the rate.
const PROBE: usize = 2000;

/// Mean of the intervals that are no gaps: up to 1.5 times the median.
fn mean_interval(intervals: &[f64]) -> Option<f64> {
    let mut sorted = intervals.to_vec();
    sorted.sort_by(f64::total_cmp);
    let median = *sorted.get(sorted.len() / 2)?;
    let regular: Vec<f64> = sorted.into_iter().filter(|dt| *dt <= 1.5 * median).collect();
    Some(regular.iter().sum::<f64>() / regular.len() as f64)
}

fn read_span(section: &Section) -> Result<Option<(f64, f64)>, ConfigError> {
    let start = section.quantity("start", Quantity::Time)?;
    let end = section.quantity("end", Quantity::Time)?;
    section.only_known()?;
    if start.is_none() && end.is_none() {
        return Ok(None);
    }
    let span = (start.unwrap_or(f64::NEG_INFINITY), end.unwrap_or(f64::INFINITY));
    if span.0 >= span.1 {
        return Err(section.error("end", "must be later than span.start"));
    }
    Ok(Some(span))
}

fn read_imu(section: &Section, data: &Path, span: Option<(f64, f64)>) -> Result<(PathBuf, ImuFormat), ConfigError> {
    let path = data.join(section.required_text("file")?);
    let need = |key, columns: Option<_>| columns.ok_or_else(|| section.error(key, "missing: the three columns x, y, z"));
    let gyro = need("gyro", section.columns("gyro")?)?;
    let accel = need("accel", section.columns("accel")?)?;
    let mut format = ImuFormat::new(section.column("time")?, gyro, accel);
    format.increments = section
        .word("data", &[("rates", false), ("increments", true)])?
        .unwrap_or(false);
    let (gyro_quantity, accel_quantity) = if format.increments {
        (Quantity::Angle, Quantity::Velocity)
    } else {
        (Quantity::AngularRate, Quantity::Acceleration)
    };
    // A unit wrongly taken for granted is the commonest silent error of this field: it must be said.
    for key in ["gyro_unit", "accel_unit"] {
        if section.get(key).is_none() {
            let quantity = if key == "gyro_unit" { gyro_quantity } else { accel_quantity };
            return Err(section.error(key, format!("missing: the unit of the columns, {}", quantity.examples())));
        }
    }
    format.gyro_scale = section.unit("gyro_unit", gyro_quantity, 1.0)?;
    format.accel_scale = section.unit("accel_unit", accel_quantity, 1.0)?;
    format.time_scale = section.unit("time_unit", Quantity::Time, 1.0)?;
    format.rate_hz = section.quantity("rate", Quantity::Frequency)?;
    if format.rate_hz.is_some_and(|r| r <= 0.0) {
        return Err(section.error("rate", "must be above 0 Hz"));
    }
    if format.time.is_none() && format.rate_hz.is_none() {
        return Err(section.error("time", "missing: give the time column, or rate where there is none"));
    }
    format.time_offset = section.quantity("time_offset", Quantity::Time)?.unwrap_or(0.0);
    format.delimiter = read_delimiter(section)?;
    format.rotation = match (section.text("axes")?, section.vector("mounting", Quantity::Angle)?) {
        (Some(_), Some(_)) => return Err(section.error("mounting", "give axes or mounting, not both")),
        (Some(axes), None) => rotation_of_axes(axes).map_err(|m| section.error("axes", m))?,
        (None, Some(rpy)) => from_rpy(&rpy).to_rotation_matrix().into_inner(),
        (None, None) => Matrix3::identity(),
    };
    format.gyro_offset = section.vector("gyro_offset", Quantity::AngularRate)?.unwrap_or_else(Vector3::zeros);
    format.accel_offset = section.vector("accel_offset", Quantity::Acceleration)?.unwrap_or_else(Vector3::zeros);
    format.span = span;
    section.only_known()?;
    Ok((path, format))
}

fn read_delimiter(section: &Section) -> Result<Option<u8>, ConfigError> {
    match section.text("delimiter")? {
        None => Ok(None),
        Some(text) if text.len() == 1 => Ok(text.bytes().next()),
        Some(text) => Err(section.error("delimiter", format!("\"{text}\" is not one character"))),
    }
}

/// `"x,-y,-z"`: body forward, right and down, each one of the sensor's axes or its opposite.
fn rotation_of_axes(axes: &str) -> Result<Matrix3, String> {
    let wrong = || format!("\"{axes}\" is not three of x, y, z with signs, such as \"y,x,-z\"");
    let mut rotation = Matrix3::zeros();
    let parts: Vec<&str> = axes.split(',').map(str::trim).collect();
    if parts.len() != 3 {
        return Err(wrong());
    }
    for (row, part) in parts.iter().enumerate() {
        let (sign, name) = match part.strip_prefix('-') {
            Some(rest) => (-1.0, rest.trim()),
            None => (1.0, part.strip_prefix('+').unwrap_or(part)),
        };
        let column = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return Err(wrong()),
        };
        rotation[(row, column)] = sign;
    }
    let det = rotation.determinant();
    if det == 1.0 {
        Ok(rotation)
    } else if det == -1.0 {
        Err(format!("\"{axes}\" is left-handed: one sign is wrong or two axes are swapped"))
    } else {
        Err(format!("\"{axes}\" names an axis twice"))
    }
}

/// `use = "position"`: which parts of a fix are taken, position and velocity.
fn read_use(section: &Section) -> Result<(bool, bool), ConfigError> {
    let words = [("both", (true, true)), ("position", (true, false)), ("velocity", (false, true))];
    Ok(section.word("use", &words)?.unwrap_or((true, true)))
}

fn read_gnss(section: &Section, data: &Path, span: Option<(f64, f64)>) -> Result<(PathBuf, GnssSource), ConfigError> {
    let path = data.join(section.required_text("file")?);
    let is_rtklib = match section.word("format", &[("csv", false), ("rtklib", true)])? {
        Some(stated) => stated,
        None => rtklib::detect(&path).unwrap_or(false),
    };
    let time_offset = section.quantity("time_offset", Quantity::Time)?.unwrap_or(0.0);
    let position_std_factor = section.factor("position_std_factor")?.unwrap_or(1.0);
    let velocity_std_factor = section.factor("velocity_std_factor")?.unwrap_or(1.0);
    let base = read_base(section)?;
    let _ = section.get("lever_arm");
    let source = if is_rtklib {
        GnssSource::Rtklib(RtklibOptions {
            time_offset,
            position_std_factor,
            velocity_std_factor,
            position_std: section.vector("position_std", Quantity::Length)?.map(|v| [v.x, v.y, v.z]),
            velocity_std: section.vector("velocity_std", Quantity::Velocity)?.map(|v| [v.x, v.y, v.z]),
            base,
            span,
        })
    } else {
        let time = section
            .column("time")?
            .ok_or_else(|| section.error("time", "missing: the time column"))?;
        let angle_scale = section.unit("position_unit", Quantity::Angle, 1f64.to_radians())?;
        let place = match (section.columns("position")?, section.columns("baseline")?) {
            (Some(_), Some(_)) => return Err(section.error("baseline", "give position or baseline, not both")),
            (Some([lat, lon, height]), None) => Some(Place::Geodetic { lat, lon, height, angle_scale }),
            (None, Some(ned)) => Some(Place::Baseline {
                ned,
                base: base.ok_or_else(|| section.error("base", "missing: the base station of the baseline, \"lat, lon deg, height m\""))?,
            }),
            (None, None) => None,
        };
        let position_std = read_std(section, "position_std", "position_std_columns", Quantity::Length)?;
        let position = match place {
            None => None,
            Some(place) => Some(PositionFormat {
                place,
                std: position_std.ok_or_else(|| {
                    section.error("position_std", "missing: the file's columns (position_std_columns) or \"north, east, down m\"")
                })?,
                std_factor: position_std_factor,
            }),
        };
        let up = section.word("velocity_axes", &VELOCITY_AXES)?.unwrap_or(false);
        let velocity_std = read_std(section, "velocity_std", "velocity_std_columns", Quantity::Velocity)?;
        let velocity = match section.columns("velocity")? {
            None => None,
            Some(columns) => Some(VelocityFormat {
                columns,
                up,
                std: velocity_std.ok_or_else(|| {
                    section.error("velocity_std", "missing: the file's columns (velocity_std_columns) or \"north, east, down m/s\"")
                })?,
                std_factor: velocity_std_factor,
            }),
        };
        GnssSource::Csv(GnssFormat {
            time,
            time_scale: section.unit("time_unit", Quantity::Time, 1.0)?,
            time_offset,
            position,
            velocity,
            quality: section.column("quality")?,
            delimiter: read_delimiter(section)?,
            span,
        })
    };
    section.only_known()?;
    Ok((path, source))
}

/// `base = "40.0966 deg, -105.1474 deg, 1601.5 m"`.
fn read_base(section: &Section) -> Result<Option<Geodetic>, ConfigError> {
    let Some(text) = section.text("base")? else { return Ok(None) };
    let wrong = |e: &dyn std::fmt::Display| section.error("base", format!("\"{text}\": {e}"));
    let parts: Vec<&str> = text.split(',').collect();
    let [lat, lon, height] = parts.as_slice() else {
        return Err(wrong(&"expected \"LAT deg, LON deg, HEIGHT m\""));
    };
    let angle = |s: &str| undrift_nav::units::parse(s, Quantity::Angle).map_err(|e| wrong(&e));
    let base = Geodetic {
        lat: angle(lat)?,
        lon: angle(lon)?,
        height: undrift_nav::units::parse(height, Quantity::Length).map_err(|e| wrong(&e))?,
    };
    if base.is_valid() { Ok(Some(base)) } else { Err(wrong(&"is not a place on the Earth")) }
}

fn read_std<'a>(section: &Section<'a>, constant: &'a str, columns: &'a str, quantity: Quantity) -> Result<Option<Std>, ConfigError> {
    match (section.vector(constant, quantity)?, section.columns(columns)?) {
        (Some(_), Some(_)) => Err(section.error(columns, format!("give {constant} or {columns}, not both"))),
        (Some(v), None) if v.iter().any(|s| *s <= 0.0) => Err(section.error(constant, "standard deviations must be above zero")),
        (Some(v), None) => Ok(Some(Std::Constant([v.x, v.y, v.z]))),
        (None, Some(columns)) => Ok(Some(Std::Columns(columns))),
        (None, None) => Ok(None),
    }
}

fn read_truth(section: &Section, data: &Path) -> Result<Option<(PathBuf, TruthFormat)>, ConfigError> {
    if !section.exists() {
        return Ok(None);
    }
    let path = data.join(section.required_text("file")?);
    let time = section
        .column("time")?
        .ok_or_else(|| section.error("time", "missing: the time column"))?;
    let position = section
        .columns("position")?
        .ok_or_else(|| section.error("position", "missing: the columns latitude, longitude, height"))?;
    let degree = 1f64.to_radians();
    let format = TruthFormat {
        time,
        time_scale: section.unit("time_unit", Quantity::Time, 1.0)?,
        time_offset: section.quantity("time_offset", Quantity::Time)?.unwrap_or(0.0),
        position,
        angle_scale: section.unit("position_unit", Quantity::Angle, degree)?,
        velocity: section.columns("velocity")?,
        attitude: section.columns("attitude")?,
        attitude_scale: section.unit("attitude_unit", Quantity::Angle, degree)?,
        delimiter: read_delimiter(section)?,
        velocity_up: section.word("velocity_axes", &VELOCITY_AXES)?.unwrap_or(false),
        span: None,
    };
    section.only_known()?;
    Ok(Some((path, format)))
}

fn read_initial(section: &Section) -> Result<AlignSettings, ConfigError> {
    let mut align = AlignSettings::default();
    let degrees = |d: f64| d.to_radians();
    let attitude = section.vector("attitude", Quantity::Angle)?;
    let attitude_std = section
        .vector("attitude_std", Quantity::Angle)?
        .unwrap_or_else(|| Vector3::new(degrees(1.0), degrees(1.0), degrees(3.0)));
    align.attitude = attitude.map(|a| (a, attitude_std));
    let velocity_std = section.vector("velocity_std", Quantity::Velocity)?.unwrap_or_else(|| Vector3::repeat(0.1));
    align.velocity = section.vector("velocity", Quantity::Velocity)?.map(|v| (v, velocity_std));
    let heading_std = section.quantity("heading_std", Quantity::Angle)?.unwrap_or(degrees(3.0));
    align.heading = match section.text("heading")? {
        None | Some("course") => Heading::Course,
        Some("velocity-matching") => Heading::VelocityMatching,
        Some(text) => match undrift_nav::units::parse(text, Quantity::Angle) {
            Ok(angle) => Heading::Given(angle, heading_std),
            Err(e) => {
                let message = format!("\"{text}\" is neither \"course\" nor \"velocity-matching\" nor an angle: {e}");
                return Err(section.error("heading", message));
            }
        },
    };
    if let Some(speed) = section.quantity("min_speed", Quantity::Velocity)? {
        align.min_speed = speed;
    }
    if [attitude_std, velocity_std].iter().any(|v| v.iter().any(|s| *s < 0.0)) || heading_std < 0.0 {
        return Err(section.error("attitude_std", "standard deviations must not be negative"));
    }
    section.only_known()?;
    Ok(align)
}
