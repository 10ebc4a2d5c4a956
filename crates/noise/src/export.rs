//! A noise model as other programs read it.
//!
//! | name | what | units |
//! |---|---|---|
//! | `kalibr` | `imu.yaml` of Kalibr and the programs that take it | rad/s/√Hz, rad/s²/√Hz; m/s²/√Hz, m/s³/√Hz |
//! | `kf-gins` | `imunoise` of KF-GINS | deg/√h, m/s/√h, deg/h, mGal, ppm, h |
//! | `ros` | diagonal covariances of `sensor_msgs/Imu` | (rad/s)², (m/s²)² |
//! | `px4` | EKF2 parameters as QGroundControl loads them | rad/s, m/s², rad/s², m/s³ |
//! | `matlab` | `imuSensor` with `gyroparams`, `accelparams` | rad/s, m/s² and their densities |
//! | `vins` | noise of a configuration of VINS-Mono or VINS-Fusion | rad/s, m/s², rad/s², m/s³ |
//! | `openvins` | `kalibr_imu_chain.yaml` of OpenVINS | as `kalibr` |
//! | `basalt` | noise of Basalt's calibration | rad/s/√Hz, rad/s²/√Hz; m/s²/√Hz, m/s³/√Hz |
//! | `gtsam` | `PreintegrationCombinedParams` of GTSAM, Python | squares of those of `kalibr` |
//! | `ardupilot` | parameters of ArduPilot's EKF3 | rad/s, m/s², rad/s², m/s³ |
//! | `gazebo` | the `imu` element of a sensor in SDF | rad/s, m/s², rad/s/√s, m/s²/√s, s |
//! | `undrift` | the model file | see [`crate::model_file`] |
//!
//! Other programs know white noise and one slow process at most; comments of the
//! text and docs/export.md say what that is taken from.
//!
//! ```
//! use undrift_noise::{ImuModel, ModelFormat};
//! let imu = ImuModel::preset("adis16465").unwrap();
//! let yaml = imu.export(ModelFormat::Kalibr, Some(200.0))?;
//! assert!(yaml.contains("\nupdate_rate: 200.0\n"));
//! // The model file itself loses nothing.
//! assert_eq!(imu.export(ModelFormat::Undrift, None)?, imu.to_toml());
//! # Ok::<(), undrift_noise::ModelError>(())
//! ```

mod comments;
mod equivalent;
mod formats;
mod nearest;
mod outage;
mod poles;
mod text;

use crate::bias_model::HORIZON;
use crate::model_file::{ImuModel, ModelError};
use equivalent::Equivalent;

/// A format of noise models. Those of other programs have white noise and one slow process at most.
///
/// ```
/// use undrift_noise::ModelFormat;
/// for format in ModelFormat::ALL {
///     assert_eq!(format.name().parse(), Ok(format));
/// }
/// assert!("yaml".parse::<ModelFormat>().is_err_and(|error| error.to_string().contains("kalibr")));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ModelFormat {
    /// `imu.yaml` of Kalibr.
    Kalibr,
    /// `imunoise` of a KF-GINS configuration.
    KfGins,
    /// Covariances of `sensor_msgs/Imu`.
    Ros,
    /// PX4 parameters.
    Px4,
    /// A MATLAB script that makes an `imuSensor`.
    Matlab,
    /// Noise of a configuration of VINS-Mono or VINS-Fusion.
    Vins,
    /// `kalibr_imu_chain.yaml` of OpenVINS.
    OpenVins,
    /// Noise of Basalt's calibration, JSON.
    Basalt,
    /// Parameters of GTSAM's combined IMU factor, Python.
    Gtsam,
    /// Parameters of ArduPilot's EKF3.
    ArduPilot,
    /// Noise of an IMU in Gazebo, SDF.
    Gazebo,
    /// The model file of this project.
    Undrift,
}

impl ModelFormat {
    /// Every format, in the order of help texts.
    pub const ALL: [Self; 12] = [
        Self::Kalibr,
        Self::KfGins,
        Self::Ros,
        Self::Px4,
        Self::Matlab,
        Self::Vins,
        Self::OpenVins,
        Self::Basalt,
        Self::Gtsam,
        Self::ArduPilot,
        Self::Gazebo,
        Self::Undrift,
    ];

    /// Its name in arguments and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kalibr => "kalibr",
            Self::KfGins => "kf-gins",
            Self::Ros => "ros",
            Self::Px4 => "px4",
            Self::Matlab => "matlab",
            Self::Vins => "vins",
            Self::OpenVins => "openvins",
            Self::Basalt => "basalt",
            Self::Gtsam => "gtsam",
            Self::ArduPilot => "ardupilot",
            Self::Gazebo => "gazebo",
            Self::Undrift => "undrift",
        }
    }
}

/// A name that is not that of a format of noise models; its message lists the names.
///
/// The name as it was given.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "unknown format {0:?}; {hint}available: kalibr, kf-gins, ros, px4, matlab, vins, openvins, basalt, gtsam, ardupilot, gazebo, undrift",
    hint = taken_by(.0)
)]
pub struct UnknownModelFormat(pub String);

/// Programs by the beginnings of their names, without blanks and strokes, and the format whose numbers they take.
const TAKEN: [(&str, &str); 10] = [
    ("vins", "vins"),
    ("openvins", "openvins"),
    ("orbslam", "kalibr"),
    ("okvis", "kalibr"),
    ("kimera", "kalibr"),
    ("liosam", "kalibr"),
    ("ekf2", "px4"),
    ("pixhawk", "px4"),
    ("ekf3", "ardupilot"),
    ("arducopter", "ardupilot"),
];

/// The option for a program that takes the numbers of one of the formats.
fn taken_by(name: &str) -> String {
    let letters = name.chars().filter(char::is_ascii_alphanumeric);
    let letters = String::from_iter(letters.map(|c| c.to_ascii_lowercase()));
    let known = TAKEN
        .iter()
        .find(|(program, _)| letters.starts_with(program));
    known.map_or_else(String::new, |(_, format)| format!("try --to {format}; "))
}

impl std::str::FromStr for ModelFormat {
    type Err = UnknownModelFormat;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|format| format.name() == name)
            .ok_or_else(|| UnknownModelFormat(name.to_owned()))
    }
}

impl ImuModel {
    /// The text of this model in `format`, for outages of 30 s: [`Self::export_for`]. `rate_hz` is the rate of the samples \[Hz\], of PX4's
    /// prediction for [`ModelFormat::Px4`] (100 Hz if not given) and [`ModelFormat::ArduPilot`] (83 Hz); without it the rate of the record
    /// that the model was identified from is taken.
    ///
    /// # Errors
    /// An axis without what the format cannot do without, or no rate where it needs one.
    ///
    /// ```
    /// use undrift_noise::{ImuModel, ModelError, ModelFormat};
    /// let imu = ImuModel::preset("bmi088").unwrap(); // Of a data sheet: no record, so no rate.
    /// assert!(matches!(imu.export(ModelFormat::Ros, None), Err(ModelError::NoRate { format: "ros" })));
    /// // Variance of a sample N² · rate: four times as large at four times the rate.
    /// let variance = |rate| -> Result<f64, Box<dyn std::error::Error>> {
    ///     let text = imu.export(ModelFormat::Ros, Some(rate))?;
    ///     let (_, numbers) = text.split_once("angular_velocity_covariance: [").ok_or("no covariance")?;
    ///     Ok(numbers.split(',').next().ok_or("no number")?.parse()?)
    /// };
    /// assert!((variance(400.0)? / variance(100.0)? - 4.0).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn export(&self, format: ModelFormat, rate_hz: Option<f64>) -> Result<String, ModelError> {
        self.export_for(format, rate_hz, HORIZON)
    }

    /// Does [`Self::export`] for outages of another length \[s\]: where a program knows a random walk alone and the bias is another, it
    /// is the one whose filter drifts little over such an outage, and as it expects.
    ///
    /// # Errors
    /// As [`Self::export`]; an outage that is not positive.
    pub fn export_for(
        &self,
        format: ModelFormat,
        rate_hz: Option<f64>,
        outage_s: f64,
    ) -> Result<String, ModelError> {
        if !(outage_s > 0.0 && outage_s.is_finite()) {
            return Err(ModelError::BadOutage(outage_s));
        }
        if let Some(rate) = rate_hz.filter(|rate| !(*rate > 0.0 && rate.is_finite())) {
            return Err(ModelError::BadRate(rate));
        }
        if format == ModelFormat::Undrift {
            return Ok(self.to_toml());
        }
        let imu = Equivalent::new(self, format, outage_s)?;
        let rate = || {
            rate_hz.or(self.known_rate()).ok_or(ModelError::NoRate {
                format: format.name(),
            })
        };
        Ok(match format {
            ModelFormat::Kalibr => formats::kalibr(&imu, rate()?),
            ModelFormat::KfGins => formats::kf_gins(&imu),
            ModelFormat::Ros => formats::ros(&imu, rate()?),
            ModelFormat::Px4 => formats::px4(&imu, rate_hz.unwrap_or(formats::PX4_RATE)),
            ModelFormat::Matlab => formats::matlab(&imu, rate()?),
            ModelFormat::Vins => formats::vins(&imu, rate()?),
            ModelFormat::OpenVins => formats::openvins(&imu, rate()?),
            ModelFormat::Basalt => formats::basalt(&imu, rate()?),
            ModelFormat::Gtsam => formats::gtsam(&imu),
            ModelFormat::ArduPilot => {
                formats::ardupilot(&imu, rate_hz.unwrap_or(formats::ARDUPILOT_RATE))
            }
            ModelFormat::Gazebo => formats::gazebo(&imu, rate()?),
            ModelFormat::Undrift => self.to_toml(),
        })
    }

    /// Rate of the record or of an ARMA \[Hz\].
    fn known_rate(&self) -> Option<f64> {
        let of_arma =
            |(_, axis): (_, &crate::AxisModel)| axis.arma.as_ref().map(|arma| arma.rate_hz);
        self.provenance
            .rate_hz
            .or_else(|| self.axes().into_iter().find_map(of_arma))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_that_take_the_numbers_of_a_format() {
        let message = |name: &str| name.parse::<ModelFormat>().unwrap_err().to_string();
        assert!(message("VINS-Fusion").contains("; try --to vins; available"));
        assert!(message("ORB_SLAM3").contains("; try --to kalibr; available"));
        assert!(message("open_vins").contains("try --to openvins; "));
        assert!(message("kalibre").contains("\"kalibre\"; available"));
    }
}
