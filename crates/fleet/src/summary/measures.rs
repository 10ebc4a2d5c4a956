//! The numbers that are compared between logs.

use crate::{FleetOutcome, OutcomeRow};
use undrift_nav::earth::STANDARD_GRAVITY;

/// What is compared between logs: a number for each bias model or axis.
pub(super) struct Measure {
    pub name: &'static str,
    /// What it is, in words.
    pub what: &'static str,
    pub unit: &'static str,
    /// Of which task, and of which of its parts.
    pub of: (&'static str, &'static str),
    /// Its column in the rows of an outcome, and one of that in `unit`.
    pub column: (&'static str, f64),
}

impl Measure {
    /// Root mean square over the rows of one part, if every row has the number.
    pub fn value(&self, outcome: &FleetOutcome, rows: &[&OutcomeRow]) -> Option<f64> {
        let (column, factor) = self.column;
        let square = |row: &&OutcomeRow| outcome.value(row, column).map(|v| v * v);
        let squares: Vec<f64> = rows.iter().map(square).collect::<Option<_>>()?;
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        (mean > 0.0).then(|| mean.sqrt() * factor)
    }
}

/// Seconds to hours under the root, and radians to degrees.
const ROOT_HOUR: f64 = 60.0;
const DEGREE: f64 = 180.0 / std::f64::consts::PI;

pub(super) const MEASURES: [Measure; 14] = [
    Measure {
        name: "drift",
        what: "largest horizontal error in an outage, root mean square over the outages of a log",
        unit: "m",
        of: ("outages", ""),
        column: ("max_horizontal_m", 1.0),
    },
    Measure {
        name: "error",
        what: "horizontal error against the truth, root mean square",
        unit: "m",
        of: ("navigate", ""),
        column: ("rms_horizontal_m", 1.0),
    },
    Measure {
        name: "nis_position",
        what: "normalised innovation squared of the position per degree of freedom, 1 if the model is correct",
        unit: "",
        of: ("navigate", ""),
        column: ("nis_position", 1.0),
    },
    Measure {
        name: "nis_velocity",
        what: "normalised innovation squared of the velocity per degree of freedom, 1 if the model is correct",
        unit: "",
        of: ("navigate", ""),
        column: ("nis_velocity", 1.0),
    },
    Measure {
        name: "vehicle_gyro_white_noise",
        what: "white noise of the gyros in the vehicle (angle random walk), if the drive determines it",
        unit: "deg/√h",
        of: ("tune", "gyro"),
        column: ("white_noise", DEGREE * ROOT_HOUR),
    },
    Measure {
        name: "vehicle_accel_white_noise",
        what: "white noise of the accelerometers in the vehicle (velocity random walk), if the drive determines it",
        unit: "m/s/√h",
        of: ("tune", "accel"),
        column: ("white_noise", ROOT_HOUR),
    },
    Measure {
        name: "vehicle_gyro_random_walk",
        what: "random walk of the gyros' biases in the vehicle, if the drive determines it",
        unit: "deg/h/√h",
        of: ("tune", "gyro"),
        column: ("random_walk", DEGREE * (ROOT_HOUR * ROOT_HOUR * ROOT_HOUR)),
    },
    Measure {
        name: "white_noise_ratio",
        what: "white noise in the vehicle relative to that at rest, if the drive determines it",
        unit: "",
        of: ("tune", ""),
        column: ("white_noise_ratio", 1.0),
    },
    Measure {
        name: "tuned_drift",
        what: "largest horizontal error in a held-out outage, with the noise found, root mean square",
        unit: "m",
        of: ("tune", ""),
        column: ("drift_after_m", 1.0),
    },
    Measure {
        name: "gyro_white_noise",
        what: "white noise of the gyros (angle random walk)",
        unit: "deg/√h",
        of: ("identify", "gyro"),
        column: ("white_noise", DEGREE * ROOT_HOUR),
    },
    Measure {
        name: "gyro_bias_instability",
        what: "bias instability of the gyros, if the recording shows it",
        unit: "deg/h",
        of: ("identify", "gyro"),
        column: ("bias_instability", DEGREE * ROOT_HOUR * ROOT_HOUR),
    },
    Measure {
        name: "gyro_drift",
        what: "angle that the recommended model of a gyro leaves after 10 s, root mean square",
        unit: "deg",
        of: ("identify", "gyro"),
        column: ("drift_10s", DEGREE),
    },
    Measure {
        name: "accel_white_noise",
        what: "white noise of the accelerometers (velocity random walk)",
        unit: "m/s/√h",
        of: ("identify", "accel"),
        column: ("white_noise", ROOT_HOUR),
    },
    Measure {
        name: "accel_bias_instability",
        what: "bias instability of the accelerometers, if the recording shows it",
        unit: "mg",
        of: ("identify", "accel"),
        column: ("bias_instability", 1e3 / STANDARD_GRAVITY),
    },
];
