//! Sentences of how a solution starts, or why it does not.

use super::{all, words::at};
use crate::numbers::short;
use std::error::Error;
use undrift_events::{Alignment, AttitudeSource, HeadingSource, Mounting};
use undrift_results::findings::Finding;

/// How the first attitude was found.
pub fn alignment(alignment: &Alignment) -> String {
    let how = match alignment.source {
        AttitudeSource::Given => return "attitude as specified".into(),
        AttitudeSource::Pose => "attitude from the first pose".to_owned(),
        AttitudeSource::Rest { duration, heading } => {
            let heading = match heading {
                HeadingSource::Given => "heading as specified",
                HeadingSource::Course => "heading from the GNSS course",
                HeadingSource::Antennas => "heading from two antennas",
                HeadingSource::Magnetometer => "heading from the magnetometer",
            };
            format!("levelled during {duration:.1} s of rest, {heading}")
        }
        AttitudeSource::Motion {
            duration,
            bias_at_rest,
        } => {
            let bias = if bias_at_rest {
                ", gyro bias from rest"
            } else {
                ""
            };
            format!("attitude from {duration:.0} s of motion{bias}")
        }
    };
    let [level, heading, bias] = [
        alignment.level_std,
        alignment.heading_std,
        alignment.gyro_bias_std,
    ]
    .map(f64::to_degrees);
    format!("{how}; level ±{level:.2} deg, heading ±{heading:.1} deg, gyro bias ±{bias:.3} deg/s")
}

/// How the IMU sits in the vehicle.
pub fn mounting(mounting: &Mounting) -> String {
    let [rpy, std] = [mounting.rpy(), mounting.std].map(|angles| angles.map(f64::to_degrees));
    format!(
        "roll {:.2}, pitch {:.2}, yaw {:.2} deg; ±{:.2} about forward, ±{:.2} about right, ±{:.2} deg about down; from {:.0} s of {}driving",
        rpy.x,
        rpy.y,
        rpy.z,
        std.x,
        std.y,
        std.z,
        mounting.duration,
        if mounting.straight { "straight " } else { "" }
    )
}

/// The last of the mountings found on the way, and since when the solution is in the vehicle's axes.
pub fn found(mountings: &[(f64, Mounting)]) -> Option<String> {
    let (since, _) = mountings.first()?;
    let (_, last) = mountings.last()?;
    Some(mounted(last, Some(*since)))
}

/// How the IMU sits in the vehicle, and since when the solution is in the vehicle's axes where that was found on the way.
pub(crate) fn mounted(of: &Mounting, since: Option<f64>) -> String {
    let found = mounting(of);
    match since.map(at) {
        Some(since) => format!("{found}; the solution is in vehicle axes from {since} s on"),
        None => found,
    }
}

pub(super) fn unexplained_force(excess: f64) -> String {
    let size = short(excess.abs());
    let by = if excess > 0.0 { "more" } else { "less" };
    format!(
        "at rest the specific force is {size} m/s² {by} than gravity, beyond the accelerometers' noise model: the filter starts with constant errors of {size} m/s²; state them as accel.turn_on in the model"
    )
}

/// Why no mounting was found on the way.
pub(super) fn no_mounting(driving: Option<f64>, wander: Option<f64>, std: Option<f64>) -> String {
    let why = match (driving, wander, std) {
        (Some(driving), ..) => {
            format!(
                "only {driving:.0} s of driving above 0.7 m/s with a known heading, 30 s are needed"
            )
        }
        (_, Some(wander), _) => format!(
            "the direction of motion varies by {:.0} deg in sensor axes",
            wander.to_degrees()
        ),
        (_, _, std) => format!(
            "its pitch and yaw were not known to better than {:.1} deg",
            std.unwrap_or(f64::NAN).to_degrees()
        ),
    };
    format!(
        "the mounting was not found: {why}; the solution is in the sensor's axes, and no constraint of the vehicle was applied: set imu.mounting or imu.axes"
    )
}

/// The note of a mounting that was estimated, as [`mounting`] gives it.
pub fn estimated(mounting: &str) -> String {
    format!("estimated mounting: {mounting}")
}

/// Why a drive has no solution: what is wrong with its logs, where that was found out, before the error that came of it.
pub fn unsolved(
    found: Vec<Finding>,
    error: impl Error + Send + Sync + 'static,
) -> Box<dyn Error + Send + Sync> {
    let is_cause = |found: &Finding| {
        matches!(
            found,
            Finding::WrongGravity { .. }
                | Finding::WrongTurnRate { .. }
                | Finding::WrongTurnAxis { .. }
                | Finding::WrongAxes { .. }
                | Finding::WrongVelocity { .. }
        )
    };
    let (causes, rest): (Vec<_>, Vec<_>) = found.into_iter().partition(is_cause);
    if causes.is_empty() && rest.is_empty() {
        return error.into();
    }
    let mut said = all(&causes);
    said.push(error.to_string());
    said.extend(all(&rest));
    said.join("; ").into()
}
