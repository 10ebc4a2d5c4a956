//! The model file `IMU.toml`: what is known of an IMU's random errors, per axis, with provenance.
//!
//! ```toml
//! format = "undrift-imu"
//! version = 1
//! name = "Some IMU"
//! source = "its data sheet, revision C, table 1"
//! [gyro]                            # all three axes; [gyro_x], [gyro_y], [gyro_z] override keys
//! white_noise = "2 deg/sqrt(h)"
//! bias_instability = "25 deg/h"     # standard deviation of a Gauss-Markov process
//! correlation_time = "100 s"        # … with this correlation time; both lists for several processes
//! random_walk = "6 deg/h/sqrt(h)"   # rate random walk K, beside or instead of it
//! quantisation = "0.02 arcsec"      # rounding Q of the integrated signal
//! turn_on = "3 deg/s"               # standard deviation of the turn-on constant
//! [gyro.arma]                       # x_t − Σ ar_i x_{t−i} = a_t − Σ ma_i a_{t−i}
//! rate = "200 Hz"
//! ar = [1.0]
//! ma = [0.9994]
//! sigma = "0.4714 deg/s"
//! [[gyro.line]]                     # a spectral line, kept and used by no filter
//! frequency = "7.3 Hz"
//! amplitude = "0.02 deg/s"
//! [gyro_z.temperature]              # slope·(T − reference) + quadratic·(T − reference)²
//! reference = "31 degC"
//! lowest = "24 degC"                # of the record
//! highest = "42 degC"
//! slope = "12 deg/h/K"
//! [accel]                           # the same keys
//! white_noise = "0.2 m/s/sqrt(h)"
//! ```
//!
//! `preset = "adis16405"` at the top takes that preset first and lets the file override it key by
//! key. An axis may be left out: the model then makes filters for no run, but is a base for others
//! ([`ImuModel::shaping`] names the axis). `paper_sigma` of an axis is the σ of the `paper` model. `[provenance]` (record, rate,
//! samples, sha256, program) and `[gyro_x.identification]` (free form) carry where identified
//! values come from. Every dimensional number is a string with its unit; see
//! [`undrift_nav::units`] for what is understood.

mod kalibr;
mod read;
mod reason;
#[cfg(test)]
mod tests;
mod write;

pub use reason::reason;

use crate::composite::GaussMarkov;
use crate::presets;
use crate::temperature::Temperature;
use std::io::{ErrorKind, Read};
use std::path::Path;
use undrift_config::{ConfigError, Section};
use undrift_nav::shaping::{MAX_ORDER, ShapingError};

/// Value of the key `format` of a model file.
pub const FORMAT: &str = "undrift-imu";
/// Latest `version` of the format that is understood, and the one written.
pub const VERSION: i64 = 1;
/// Names of the six axes in the order of [`ImuModel::axes`].
pub const AXES: [&str; 6] = [
    "gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z",
];
/// Most Gauss-Markov processes of an axis: with quantisation and a random walk or turn-on constant
/// they fill its states.
pub const MAX_PROCESSES: usize = MAX_ORDER - 2;

/// The random errors of an IMU, axis by axis, in body axes of the sensor.
///
/// A preset, a file, or the numbers of a data sheet in SI units:
///
/// ```
/// use undrift_noise::{AxisModel, BiasModel, GaussMarkov, ImuModel};
///
/// let preset = ImuModel::preset("adis16405").ok_or("no such preset")?;
/// let deg = f64::to_radians(1.0);
/// let gyro = AxisModel {
///     white: Some(0.15 * deg / 60.0),                                              // 0.15 deg/√h
///     instability: vec![GaussMarkov { sigma: 6.0 * deg / 3600.0, tau_s: 100.0 }],  // 6 deg/h
///     turn_on: 0.2 * deg,                                                          // 0.2 deg/s
///     ..AxisModel::default()
/// };
/// let accel = AxisModel { white: Some(1e-3), turn_on: 0.05, ..AxisModel::default() };
/// let model = ImuModel::new("my IMU", gyro, accel);
///
/// assert_eq!(ImuModel::from_toml(&model.to_toml(), "imu.toml")?.gyro[2].turn_on, 0.2 * deg);
/// // What the filter takes, at 100 Hz: white noise over a process and a constant.
/// assert_eq!(model.shaping(BiasModel::GaussMarkov, 0.01)?[0].order, 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImuModel {
    /// Name of the sensor.
    pub name: String,
    /// Source of the numbers, free text: a data sheet with its revision and table, or the recording.
    pub source: String,
    /// The record they were identified from, if they were.
    pub provenance: Provenance,
    /// Gyros x, y, z, in rad/s and s.
    pub gyro: [AxisModel; 3],
    /// Accelerometers x, y, z, in m/s² and s.
    pub accel: [AxisModel; 3],
    /// Where it was read from, which messages put before the name of an axis: `imu.toml: ` or `drive.toml: model.`; empty
    /// for a model made in code.
    pub read_from: String,
}

/// The record that an identified model comes from; every part may be unknown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// Name of the static record.
    pub record: Option<String>,
    /// Sample rate of the record \[Hz\].
    pub rate_hz: Option<f64>,
    /// Length of the record in samples.
    pub samples: Option<u64>,
    /// SHA-256 of the record's bytes in hexadecimal.
    pub sha256: Option<String>,
    /// Program and version that wrote the model.
    pub program: Option<String>,
    /// The recordings, where there are several; then `record` describes all, and `samples` is their sum.
    pub recordings: Vec<Recording>,
}

/// One of several recordings that a model was identified from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Name of the static record.
    pub record: String,
    /// Length of the record in samples.
    pub samples: Option<u64>,
    /// SHA-256 of its bytes in hexadecimal.
    pub sha256: Option<String>,
}

/// The random error of one axis in the terms of a data sheet, or as ARMA, or both. "unit" is rad/s
/// for a gyro and m/s² for an accelerometer. The default, without white noise and ARMA, is an axis of
/// which nothing is known.
///
/// Either is enough for a filter. From an ARMA(1,1) the terms follow exactly (docs/theory.md, section 1):
///
/// ```
/// use undrift_noise::{Arma, AxisModel, BiasModel};
/// // A unit root under white noise: θ σ² a sample is white, (1 − θ)² σ² a sample drives the walk.
/// let arma = Arma { ar: vec![1.0], ma: vec![0.9], sigma: 1e-3, rate_hz: 100.0 };
/// let gyro = AxisModel { arma: Some(arma), ..AxisModel::default() };
/// assert!((gyro.white_density() / (0.9_f64 * 1e-6 / 100.0).sqrt() - 1.0).abs() < 1e-12);
/// let walk = gyro.shaping(BiasModel::RandomWalk, 0.01)?;
/// assert!((walk.q[0][0] / (0.1 * 1e-3_f64).powi(2) - 1.0).abs() < 1e-12);
/// # Ok::<(), undrift_noise::ModelError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisModel {
    /// Standard deviation of the turn-on constant \[unit\]: how much the bias differs from one switch-on to the next. One record cannot
    /// show it; a data sheet or several records can.
    pub turn_on: f64,
    /// Density of the white noise N [unit·√s = unit/√Hz]: angle or velocity random walk.
    pub white: Option<f64>,
    /// Quantisation Q [unit·s], the standard deviation of the rounding of the integrated signal.
    pub quantisation: Option<f64>,
    /// Gauss-Markov parts of the bias, at most [`MAX_PROCESSES`].
    pub instability: Vec<GaussMarkov>,
    /// Random walk K of the bias [unit/√s]: rate random walk, acceleration random walk.
    pub random_walk: Option<f64>,
    /// ARMA of the whole error less its constant, beside the terms above, not added to them.
    pub arma: Option<Arma>,
    /// Spectral lines and narrow resonances beside all of the above; no filter has states for them.
    pub lines: Vec<Line>,
    /// Dependence of the bias on the temperature: removed from a drive's samples before the filter, where they have a temperature.
    pub temperature: Option<Temperature>,
    /// σ of the `paper` model \[unit\]; without it the white noise per sample is taken.
    pub paper_sigma: Option<f64>,
    /// What identification found out about the axis (chosen, runner-up, scores …), kept as it is.
    pub identification: toml::Table,
}

/// A spectral line, or with a width a narrow resonance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Line {
    /// Frequency, of a resonance its centre \[Hz\].
    pub frequency_hz: f64,
    /// Amplitude, of a resonance that of a sine with its power \[unit\].
    pub amplitude: f64,
    /// Full width of a resonance at half its power \[Hz\]; 0 of a line.
    pub width_hz: f64,
}

/// An ARMA(p, q), `x_t − ar_1 x_{t−1} − … = a_t − ma_1 a_{t−1} − …`, `a_t ~ N(0, sigma²)`: the sign of docs/theory.md, in which Matlab and
/// statsmodels write +θ.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arma {
    /// Autoregressive φ1…φp; one root may be at 1.
    pub ar: Vec<f64>,
    /// Moving-average θ1…θq, subtracted.
    pub ma: Vec<f64>,
    /// Standard deviation of the innovations \[unit\].
    pub sigma: f64,
    /// Sample rate it holds at \[Hz\].
    pub rate_hz: f64,
}

/// Why a model file cannot be read, or why there is no shaping filter or export of a model. Its text names file, line and key, and what
/// was expected.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file cannot be read.
    #[error("{file}: {}{hint}", unread(error))]
    Read {
        /// Path of the file.
        file: String,
        /// What the system says.
        error: std::io::Error,
        /// What else could have been meant, or nothing.
        hint: String,
    },
    /// The text is no TOML.
    #[error("{file} line {line}: {message}")]
    Syntax {
        /// Name of the text.
        file: String,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
    /// An entry is missing, unknown or has a wrong value.
    #[error("{}{}{key}: {message}", place(file, *line), if key.is_empty() { "" } else { ", " })]
    Entry {
        /// Name of the text.
        file: String,
        /// Line of the entry from 1, where it is known.
        line: Option<usize>,
        /// Dotted path of the key.
        key: String,
        /// What is wrong and what was expected.
        message: String,
    },
    /// Nothing is known of an axis: neither white noise nor an ARMA.
    #[error(
        "{prefix}{axis}: no noise model; give [{}] for all three axes, or [{axis}]",
        group(axis)
    )]
    NoAxis {
        /// Name of the place that the model was read from, with a colon; empty of a model made in code.
        prefix: String,
        /// The axis.
        axis: &'static str,
    },
    /// The bias model cannot be made of what is known of the axis.
    #[error("{}the {model} model needs {needs}", axis_prefix(*axis))]
    Missing {
        /// Axis, where it is known.
        axis: Option<&'static str>,
        /// The bias model asked for.
        model: &'static str,
        /// What would have to be given.
        needs: &'static str,
    },
    /// The model cannot be written in a format without a sample rate.
    #[error("{format} needs the sample rate, which the model does not have; set --rate HZ")]
    NoRate {
        /// Name of the format.
        format: &'static str,
    },
    /// The requested sample rate \[Hz\] is not positive and finite.
    #[error("invalid sample rate: {0} Hz")]
    BadRate(f64),
    /// The length of an outage \[s\] is not positive and finite.
    #[error("invalid outage: {0} s")]
    BadOutage(f64),
    /// The shaping filter cannot be made.
    #[error("{}the {model} model: {error}", axis_prefix(*axis))]
    Shaping {
        /// Axis, where it is known.
        axis: Option<&'static str>,
        /// The bias model asked for.
        model: &'static str,
        /// Why not.
        error: ShapingError,
    },
}

impl From<ConfigError> for ModelError {
    fn from(error: ConfigError) -> Self {
        let ConfigError {
            file,
            line,
            key,
            message,
        } = error;
        Self::Entry {
            file,
            line,
            key,
            message,
        }
    }
}

fn place(file: &str, line: Option<usize>) -> String {
    match line {
        Some(line) => format!("{file} line {line}"),
        None => file.to_owned(),
    }
}

/// The table that an axis shares with its two neighbours.
fn group(axis: &str) -> &str {
    axis.split('_').next().unwrap_or(axis)
}

fn axis_prefix(axis: Option<&'static str>) -> String {
    axis.map(|axis| format!("{axis}: ")).unwrap_or_default()
}

impl ImuModel {
    /// The model of a sensor whose three gyros are alike, and whose three accelerometers are, as data sheets give them.
    pub fn new(name: &str, gyro: AxisModel, accel: AxisModel) -> Self {
        Self {
            name: name.to_owned(),
            gyro: [gyro.clone(), gyro.clone(), gyro],
            accel: [accel.clone(), accel.clone(), accel],
            ..Self::default()
        }
    }

    /// Reads a model file's text; `file` is its name in messages.
    ///
    /// ```
    /// use undrift_noise::ImuModel;
    /// let text = r#"
    /// format = "undrift-imu"
    /// version = 1
    /// name = "My IMU"
    /// source = "data sheet, table 2"
    /// [gyro]
    /// white_noise = "0.3 deg/sqrt(h)"
    /// bias_instability = "8 deg/h"
    /// correlation_time = "200 s"
    /// [accel]
    /// white_noise = "60 ug/sqrt(Hz)"
    /// "#;
    /// let model = ImuModel::from_toml(text, "imu.toml")?;
    /// assert_eq!(model.gyro[0].instability[0].tau_s, 200.0);
    /// let error = ImuModel::from_toml(&text.replace("deg/h\"", "deg\""), "imu.toml").unwrap_err();
    /// assert!(error.to_string().contains("imu.toml line 8") && error.to_string().contains("gyro.bias_instability"));
    /// # Ok::<(), undrift_noise::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::Syntax`] where the text is no TOML; [`ModelError::Entry`] for a key that is missing or
    /// unknown, a value without its unit or out of its range, an unknown preset, another version.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, ModelError> {
        read::from_text(text, file)
    }

    /// Reads a model from a table of another file, e.g. an inline `model = { … }`, where `format` and `version` are optional.
    ///
    /// # Errors
    /// [`ModelError::Entry`] as [`ImuModel::from_toml`], with the file, line and dotted key of the table.
    pub fn from_section(section: &Section) -> Result<Self, ModelError> {
        read::model(section)
    }

    /// Reads the model file at `path`; errors name it.
    ///
    /// # Errors
    /// [`ModelError::Read`] where the file cannot be read or is no UTF-8, else as [`ImuModel::from_toml`].
    pub fn load(path: &Path) -> Result<Self, ModelError> {
        let file = path.display().to_string();
        match text_of(path) {
            Ok(text) => Self::from_toml(&text, &file),
            Err(error) => Err(ModelError::Read {
                file,
                error,
                hint: String::new(),
            }),
        }
    }

    /// The preset of that name, or the model file at that path relative to `base`.
    ///
    /// # Errors
    /// As [`ImuModel::load`]; where there is no such file, the message names the presets near it.
    ///
    /// ```
    /// use std::path::Path;
    /// use undrift_noise::ImuModel;
    /// let here = Path::new("/nonexistent");
    /// assert_eq!(ImuModel::resolve("adis16465", here)?.name, ImuModel::preset("adis16465").ok_or("no preset")?.name);
    /// let error = ImuModel::resolve("adis16466", here).unwrap_err();
    /// assert!(error.to_string().contains("adis16465")); // The nearest presets.
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn resolve(name_or_path: &str, base: &Path) -> Result<Self, ModelError> {
        if let Some(model) = Self::preset(name_or_path) {
            return Ok(model);
        }
        Self::load(&base.join(name_or_path)).map_err(|error| match error {
            ModelError::Read { file, error, .. } => {
                let hint = format!(
                    "; a model is a file or a preset; {}",
                    presets::suggestion(name_or_path)
                );
                ModelError::Read { file, error, hint }
            }
            other => other,
        })
    }

    /// A preset by its name, see [`presets`].
    pub fn preset(name: &str) -> Option<Self> {
        let text = presets::text(name)?;
        Self::from_toml(text, name).ok()
    }

    /// Names of the presets, in alphabetical order.
    pub fn preset_names() -> &'static [&'static str] {
        presets::NAMES
    }

    /// The text of a model file that reads back as this model.
    pub fn to_toml(&self) -> String {
        write::to_text(self)
    }

    /// The six axes with their names: gyro x, y, z, accelerometer x, y, z.
    ///
    /// ```
    /// use undrift_noise::ImuModel;
    /// let model = ImuModel::preset("adis16465").ok_or("no preset")?;
    /// let named: Vec<_> = model.axes().into_iter().filter(|(_, axis)| axis.is_known()).map(|(name, _)| name).collect();
    /// assert_eq!(named, ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"]);
    /// # Ok::<(), &str>(())
    /// ```
    pub fn axes(&self) -> [(&'static str, &AxisModel); 6] {
        std::array::from_fn(|i| {
            (
                AXES[i],
                if i < 3 {
                    &self.gyro[i]
                } else {
                    &self.accel[i - 3]
                },
            )
        })
    }

    /// All six axes, where something is known of each.
    pub(crate) fn known_axes(&self) -> Result<[(&'static str, &AxisModel); 6], ModelError> {
        let axes = self.axes();
        match axes.iter().find(|(_, axis)| !axis.is_known()) {
            None => Ok(axes),
            Some((axis, _)) => Err(ModelError::NoAxis {
                prefix: self.read_from.clone(),
                axis,
            }),
        }
    }
}

impl AxisModel {
    /// Whether anything is known of the axis: white noise or an ARMA.
    pub fn is_known(&self) -> bool {
        self.white.is_some() || self.arma.is_some()
    }
}

/// Size of a model file at most \[bytes\]; those of long ARMA models have some kB.
const MOST: u64 = 4 << 20;

fn text_of(path: &Path) -> std::io::Result<String> {
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path)?;
    file.take(MOST + 1).read_to_end(&mut bytes)?;
    let invalid = |why: String| std::io::Error::new(ErrorKind::InvalidData, why);
    if bytes.len() as u64 > MOST {
        return Err(invalid(format!(
            "larger than {} MB, so not a model file",
            MOST >> 20
        )));
    }
    String::from_utf8(bytes).map_err(|_| invalid("not UTF-8 text, so not a model file".into()))
}

/// Why a file cannot be read, without the system's number.
fn unread(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "no such file".into(),
        ErrorKind::IsADirectory => "is a folder, not a model file".into(),
        ErrorKind::PermissionDenied => "no permission to read".into(),
        _ => error.to_string(),
    }
}
