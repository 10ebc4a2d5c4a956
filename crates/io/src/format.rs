//! The formats of logs.

/// A format of logs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Delimited text whose columns have to be named.
    Csv,
    /// KF-GINS: text without header; time and increments, fixes, or a solution.
    KfGins,
    /// EuRoC MAV data set: CSV with a header of its own.
    Euroc,
    /// RTKLIB solution.
    Rtklib,
    /// Text that Inertial Explorer exports.
    Explorer,
    /// Smoothed best estimate of trajectory (SBET).
    Sbet,
    /// NMEA 0183 sentences.
    Nmea,
    /// u-blox UBX.
    Ubx,
    /// NovAtel OEM, ASCII and binary.
    Novatel,
    /// Septentrio Binary Format.
    Sbf,
    /// MAVLink, as it comes or as a .tlog.
    Mavlink,
    /// ROS 1 bag.
    RosBag,
    /// MCAP, as ROS 2 writes it.
    Mcap,
    /// ROS 2 bag: a SQLite database, or a folder of such or of MCAP files.
    RosBag2,
    /// PX4 ULog.
    ULog,
    /// ArduPilot DataFlash, binary or text.
    DataFlash,
    /// NaveGo's structures in a MATLAB file.
    NaveGo,
    /// GPX track.
    Gpx,
    /// A folder of the app Sensor Logger.
    SensorLogger,
    /// GnssLogger's text, of Android.
    GnssLogger,
    /// Apache Parquet, whose columns have to be named.
    Parquet,
}

/// Formats by the name that configuration files give them, and what they are called.
pub const FORMATS: [(&str, Format, &str); 21] = [
    ("csv", Format::Csv, "delimited text"),
    ("kf-gins", Format::KfGins, "KF-GINS text"),
    ("euroc", Format::Euroc, "EuRoC CSV"),
    ("rtklib", Format::Rtklib, "an RTKLIB solution"),
    (
        "inertial-explorer",
        Format::Explorer,
        "an Inertial Explorer export",
    ),
    ("sbet", Format::Sbet, "SBET"),
    ("nmea", Format::Nmea, "NMEA 0183"),
    ("ubx", Format::Ubx, "u-blox UBX"),
    ("novatel", Format::Novatel, "a NovAtel log"),
    ("sbf", Format::Sbf, "Septentrio SBF"),
    ("mavlink", Format::Mavlink, "MAVLink"),
    ("rosbag", Format::RosBag, "a ROS 1 bag"),
    ("mcap", Format::Mcap, "MCAP"),
    ("rosbag2", Format::RosBag2, "a ROS 2 bag"),
    ("ulog", Format::ULog, "PX4 ULog"),
    ("dataflash", Format::DataFlash, "ArduPilot DataFlash"),
    ("navego", Format::NaveGo, "a NaveGo MATLAB file"),
    ("gpx", Format::Gpx, "GPX"),
    (
        "sensor-logger",
        Format::SensorLogger,
        "a folder of Sensor Logger",
    ),
    ("gnsslogger", Format::GnssLogger, "a GnssLogger log"),
    ("parquet", Format::Parquet, "Parquet"),
];

impl Format {
    /// Its name in configuration files.
    pub fn name(self) -> &'static str {
        self.entry().0
    }

    /// What it is called.
    pub fn describe(self) -> &'static str {
        self.entry().2
    }

    /// Whether files of the format say themselves what they hold.
    pub fn is_log(self) -> bool {
        !matches!(self, Self::Csv | Self::Parquet | Self::KfGins | Self::Euroc)
    }

    fn entry(self) -> (&'static str, Format, &'static str) {
        FORMATS
            .into_iter()
            .find(|(_, format, _)| *format == self)
            .unwrap_or(FORMATS[0])
    }
}
