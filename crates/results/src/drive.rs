//! What was navigated.

use super::{Key, Keyed, Number};
use serde::{Deserialize, Serialize};
use std::path::Path;
use undrift_events::{GnssUse, ScalarLog};
use undrift_io::epoch::{ClockSource, Epoch};

impl Key for ScalarLog {
    const ALL: &'static [Self] = &Self::ALL;

    fn key(self) -> String {
        self.name().to_owned()
    }

    fn describe(self) -> &'static str {
        self.described()
    }
}

/// A drive, logged or simulated. Files go by their names without folders.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Drive {
    /// What was simulated, if it is no log.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulated: Option<String>,
    /// The drive file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The inertial log, or the model of a simulated IMU.
    pub imu: Option<String>,
    /// The log of GNSS fixes, or what a simulated receiver is like.
    pub gnss: Option<String>,
    /// Whether that is a log of poses in a local frame.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub posed: bool,
    /// The reference trajectory.
    pub truth: Option<String>,
    /// The logs of sensors that measure one number, each under its own name.
    #[serde(flatten)]
    pub scalars: Keyed<ScalarLog, Option<String>>,
    /// The log of a magnetometer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub magnetometer: Option<String>,
    /// When it starts; missing where no log has a date.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<Start>,
    /// Inertial samples a second \[Hz\].
    pub rate_hz: Number,
    /// Noise model of the IMU.
    pub model: Option<String>,
    /// From the IMU to the antenna, body axes \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lever_arm_m: Option<[Number; 3]>,
    /// Which parts of the fixes are used.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gnss_use: Option<String>,
    /// Whether outlying fixes are rejected.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gating: Option<bool>,
    /// Whether the stated standard deviations of the fixes are adapted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adapt: Option<bool>,
}

/// When a drive starts. From there its times go on as GPS time does, without leap seconds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Start {
    /// Time of the first inertial sample \[s\].
    pub time_s: Number,
    /// UTC then, `yyyy-mm-ddThh:mm:ss.sssZ`, rounded.
    pub utc: String,
    /// Unix time then \[s\].
    pub unix_s: Number,
    /// Source of the date: "gnss", a receiver; "utc", dates of UTC or Unix times; "host", the clock of the recording
    /// computer or telephone; "receipt", that clock when the records came; "no-zone", dates without a time zone
    /// read as UTC; "stated", the drive file.
    pub clock: String,
}

impl Start {
    /// Of a drive with a date, whose samples can be read.
    /// UTC at a time \[s\], `yyyy-mm-ddThh:mm:ss.sssZ`.
    pub fn at(&self, time: f64) -> Option<String> {
        let start = Epoch::of_unix(self.unix_s.0, self.time_s.0, ClockSource::Stated)?;
        time.is_finite().then(|| start.iso(time))
    }
}

/// The parts of a fix that are used, in words.
pub fn parts_used(used: GnssUse) -> &'static str {
    match used {
        GnssUse::Both => "position and velocity",
        GnssUse::Position => "position",
        GnssUse::Velocity => "velocity",
    }
}

/// What several records together are called.
pub fn names(names: &[&str]) -> String {
    const LISTED: usize = 3;
    match names {
        [first, .., _] if names.len() > LISTED => format!("{first} and {} others", names.len() - 1),
        _ => names.join(", "),
    }
}

/// A file's name without its folders.
pub fn name(path: &Path) -> String {
    path.file_name()
        .map_or(String::new(), |name| name.to_string_lossy().into_owned())
}
