//! The numbers that are compared between logs.

use crate::fleet::{FleetOutcome, Row};
use undrift_nav::earth::STANDARD_GRAVITY;

/// What is compared between logs: a number for each bias model or axis.
pub(super) struct Measure {
    pub name: &'static str,
    /// What it is, in words.
    pub what: &'static str,
    pub unit: &'static str,
    /// Of which task, and of which of its parts.
    pub task: &'static str,
    pub parts: &'static str,
    /// From the rows of one part, in `unit`.
    pub of: fn(&FleetOutcome, &[&Row]) -> Option<f64>,
}

/// A number of the only row.
fn only(outcome: &FleetOutcome, rows: &[&Row], column: &str, factor: f64) -> Option<f64> {
    let value = outcome.value(rows.first()?, column)?;
    (value > 0.0).then_some(value * factor)
}

/// Root mean square of a column over the rows, if every row has it.
fn rms(outcome: &FleetOutcome, rows: &[&Row], column: &str) -> Option<f64> {
    let square = |row: &&Row| outcome.value(row, column).map(|v| v * v);
    let squares: Vec<f64> = rows.iter().map(square).collect::<Option<_>>()?;
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// Seconds to hours under the root, and radians to degrees.
const ROOT_HOUR: f64 = 60.0;
const DEGREE: f64 = 180.0 / std::f64::consts::PI;

pub(super) const MEASURES: [Measure; 14] = [
    Measure {
        name: "drift",
        what: "largest horizontal error in an outage, root mean square over the outages of a log",
        unit: "m",
        task: "outages",
        parts: "",
        of: |o, rows| rms(o, rows, "max_horizontal_m"),
    },
    Measure {
        name: "error",
        what: "horizontal error against the truth, root mean square",
        unit: "m",
        task: "navigate",
        parts: "",
        of: |o, rows| only(o, rows, "rms_horizontal_m", 1.0),
    },
    Measure {
        name: "nis_position",
        what: "normalised innovation squared of the position per degree of freedom, 1 if the model is correct",
        unit: "",
        task: "navigate",
        parts: "",
        of: |o, rows| only(o, rows, "nis_position", 1.0),
    },
    Measure {
        name: "nis_velocity",
        what: "normalised innovation squared of the velocity per degree of freedom, 1 if the model is correct",
        unit: "",
        task: "navigate",
        parts: "",
        of: |o, rows| only(o, rows, "nis_velocity", 1.0),
    },
    Measure {
        name: "vehicle_gyro_white_noise",
        what: "white noise of the gyros in the vehicle (angle random walk), if the drive determines it",
        unit: "deg/√h",
        task: "tune",
        parts: "gyro",
        of: |o, rows| only(o, rows, "white_noise", DEGREE * ROOT_HOUR),
    },
    Measure {
        name: "vehicle_accel_white_noise",
        what: "white noise of the accelerometers in the vehicle (velocity random walk), if the drive determines it",
        unit: "m/s/√h",
        task: "tune",
        parts: "accel",
        of: |o, rows| only(o, rows, "white_noise", ROOT_HOUR),
    },
    Measure {
        name: "vehicle_gyro_random_walk",
        what: "random walk of the gyros' biases in the vehicle, if the drive determines it",
        unit: "deg/h/√h",
        task: "tune",
        parts: "gyro",
        of: |o, rows| only(o, rows, "random_walk", DEGREE * ROOT_HOUR.powi(3)),
    },
    Measure {
        name: "white_noise_ratio",
        what: "white noise in the vehicle relative to that at rest, if the drive determines it",
        unit: "",
        task: "tune",
        parts: "",
        of: |o, rows| only(o, rows, "white_noise_ratio", 1.0),
    },
    Measure {
        name: "tuned_drift",
        what: "largest horizontal error in a held-out outage, with the noise found, root mean square",
        unit: "m",
        task: "tune",
        parts: "",
        of: |o, rows| only(o, rows, "drift_after_m", 1.0),
    },
    Measure {
        name: "gyro_white_noise",
        what: "white noise of the gyros (angle random walk)",
        unit: "deg/√h",
        task: "identify",
        parts: "gyro",
        of: |o, rows| only(o, rows, "white_noise", DEGREE * ROOT_HOUR),
    },
    Measure {
        name: "gyro_bias_instability",
        what: "bias instability of the gyros, if the recording shows it",
        unit: "deg/h",
        task: "identify",
        parts: "gyro",
        of: |o, rows| only(o, rows, "bias_instability", DEGREE * ROOT_HOUR * ROOT_HOUR),
    },
    Measure {
        name: "gyro_drift",
        what: "angle that the recommended model of a gyro leaves after 10 s, root mean square",
        unit: "deg",
        task: "identify",
        parts: "gyro",
        of: |o, rows| only(o, rows, "drift_10s", DEGREE),
    },
    Measure {
        name: "accel_white_noise",
        what: "white noise of the accelerometers (velocity random walk)",
        unit: "m/s/√h",
        task: "identify",
        parts: "accel",
        of: |o, rows| only(o, rows, "white_noise", ROOT_HOUR),
    },
    Measure {
        name: "accel_bias_instability",
        what: "bias instability of the accelerometers, if the recording shows it",
        unit: "mg",
        task: "identify",
        parts: "accel",
        of: |o, rows| only(o, rows, "bias_instability", 1e3 / STANDARD_GRAVITY),
    },
];
