//! How a value of a drive file is known, in words.

use crate::numbers::short;
use undrift_results::inspect::Known;

/// How a value is known.
pub(super) fn known(known: &Known) -> String {
    match known {
        Known::Certain => "",
        Known::Name { several: false } => "from its name",
        Known::Name { several: true } => "from their names",
        Known::Numbers { several: false } => "guessed from its values",
        Known::Numbers { several: true } => "guessed from their values",
        Known::Guessed => "guessed",
        Known::StampStep => "guessed from the step of the time stamps",
        Known::NoTimes => "guessed: no time column; set the actual rate",
        Known::RowsOfFixes => "guessed: no time column, the rows over the time that the fixes last; set the actual rate",
        Known::NoNumbers => "UNKNOWN: no number in the first rows",
        Known::Gravity(median) => return format!("guessed: the median magnitude is {median:.4}"),
        Known::NotGravity(median) => {
            return format!(
                "UNKNOWN: the median magnitude is {median:.4}, which is not gravity in m/s^2, ft/s^2, g, mg or ug"
            );
        }
        Known::Increments => "guessed: the accelerometers' magnitude is gravity times the interval",
        Known::LargestRate(largest) => return format!("guessed: rates reach {largest:.1}, beyond any gyro's in rad/s"),
        Known::LargeScatter(scatter) => {
            return format!(
                "guessed: the lowest scatter is {scatter:.2e}; in rad/s it would be {:.1} deg/s",
                scatter.to_degrees()
            );
        }
        Known::SmallScatter(scatter) => {
            return format!(
                "guessed: the lowest scatter is {scatter:.2e}; in deg/s it would be too low for such a sensor"
            );
        }
        Known::Clocks {
            correlation,
            hours,
            leap,
        } => {
            let zone = (*hours != 0.0).then(|| format!("{} h, a time zone", hours.abs()));
            let leap = leap.then(|| "18 s between GPS time and UTC".to_owned());
            let parts = Vec::from_iter(zone.into_iter().chain(leap));
            let what = match parts.is_empty() {
                true => "the clocks differ".to_owned(),
                false => parts.join(" and "),
            };
            return format!(
                "from the turns of gyros and GNSS course, whose correlation is then {correlation:.2}: {what}"
            );
        }
        Known::Turns(ratio) => {
            return format!(
                "from the turns of the GNSS course: in the other unit the gyros would turn {ratio:.2} times as fast"
            );
        }
        Known::TooFew => "UNKNOWN: too few samples",
        Known::Integers => "guessed: latitude and longitude are integers of 1e-7 deg, as of a receiver that counts mm",
        Known::Thousandths => "guessed: whole numbers, too large to be m or m/s: mm or mm/s",
        Known::SmallPlaces => "guessed: no latitude exceeds pi/2 and no longitude exceeds pi",
        Known::SmallAngles => "guessed: no angle exceeds 2 pi",
        Known::NoColumns => "guessed: no such columns; set the receiver's accuracy",
        Known::GpsSeconds => {
            "one log counts GPS seconds since 1980, the other Unix time, which is without leap seconds"
        }
        Known::TimesOfDay { leap } => {
            let leap = if *leap { " and the leap seconds between GPS time and UTC" } else { "" };
            return format!(
                "guessed: the times are times of day without a date; whole days{leap} for the logs to overlap"
            );
        }
        Known::NoHeights => {
            "assumed: no height column; the heights of the solution mean nothing, and position_std has 50 m for them. Set the height of the place"
        }
        Known::NotInLog => "guessed: not in the log; set the receiver's accuracy",
        Known::NotInNmea => {
            "guessed: not in NMEA; large for the vertical speed, which NMEA lacks"
        }
        Known::FirstOf(others) => {
            return format!("the first of several; the others are {}", others.join(", "));
        }
        Known::Measures(others) => {
            return format!(
                "the first of several that measures gravity and turns; the others are {}",
                others.join(", ")
            );
        }
        Known::Apart => {
            "gyroscopes and accelerometers are apart: forces are interpolated to the times of the rates"
        }
        Known::Exchanged => {
            "from their values: the columns named as gyroscopes measure gravity, so gyroscopes and accelerometers are exchanged"
        }
        Known::Counts => "guessed: raw counts, as the accelerometers have, of the usual range of 250 deg/s",
        Known::Reversed => {
            "guessed: the gyros turn against the GNSS course unless specific force has the opposite sign"
        }
        Known::ExchangedAxes => "guessed: only with its axes in this order do samples and fixes fit together",
        Known::ReversedAxes => {
            "from the motion: only with this sign of each axis do gyroscopes, accelerometers and fixes fit together"
        }
        Known::SharedStamps { share } => {
            return format!(
                "{:.0} % of the rows share the time stamp of the row before: they are spread evenly up to the next stamp",
                100.0 * share
            );
        }
        Known::Telephone(size) => {
            return format!(
                "guessed: the mean magnitude is {size:.4}, as of an iPhone, whose accelerometers have the opposite sign"
            );
        }
        Known::PointsDown => "the z axis points down; assumes x forward and y right",
        Known::PointsUp => {
            "the z axis points up; assumes x forward and y left (if y is forward: \"y,x,-z\")"
        }
        Known::Motion { duration_s, .. } => {
            return format!(
                "estimated from {duration_s:.0} s of this drive; \"auto\" estimates it in each drive"
            );
        }
        Known::LessCertain => "one standard deviation; the vehicle's attitude is that uncertain",
        Known::Uncalibrated => {
            "one standard deviation, of accelerometers that nobody calibrated"
        }
        Known::Forces { .. } => {
            "estimated from forces, speeds and turns of this drive; \"auto\" is more accurate on a longer drive"
        }
        Known::Field(strength) => return format!("by the strength of the field, {strength:.0} uT"),
        Known::FieldTurns => "with these axes its turns fit those of the gyros",
        Known::VehicleHeading => "assumed: the message is the heading of the vehicle; set \"90 deg\" if it is the direction from the left antenna to the right one",
        Known::Withheld { spans } => {
            return format!(
                "estimated from {spans} spans of 10 s of this drive without fixes; set the receiver's accuracy if it is known"
            );
        }
        Known::Smooths { .. } => {
            "the positions lie inside the turns, as behind a filter of this time constant in the receiver"
        }
        Known::Antennas { std_deg } => return format!("from the motion, to {} deg", short(*std_deg)),
        Known::HandEye {
            correlation,
            std_deg,
        } => {
            return format!(
                "from the turns of gyros and poses, whose correlation is {correlation:.3}; ±{} deg",
                short(*std_deg)
            );
        }
        Known::TurnsOfPoses => "from the poses, which turn as far only in this unit",
        Known::Accelerations => "from the accelerations of IMU and poses",
        Known::LeverArm { std_m } => {
            return format!(
                "IMU to marker: forward, right, down; from the accelerations, ±{} m",
                short(*std_m)
            );
        }
        Known::Scatter => "from how far the turns of the poses differ from those of the gyros",
        Known::Thinned => "poses that follow at once err alike: one in each such interval is used",
        Known::Lasting => "usual: part of their error lasts; `undrift tune` finds how much",
        Known::SensorName => "from the sensor's name in the log, or in its file or folder name",
        Known::Steps => "from the quantisation steps of its values",
        Known::NoSensor => "guessed: nothing in the log shows the kind of sensor",
        Known::Tilted => "the z axis is not vertical; or set axes, such as \"z,y,-x\"",
    }
    .into()
}
