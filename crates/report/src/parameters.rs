//! What each parameter that the filter may estimate is called in words, and in which unit.

use undrift_nav::parameters::Parameter;

const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// A parameter in words.
pub(crate) struct Wording<'a> {
    pub name: &'a str,
    /// Names of its components in their order, or a remark in brackets; may be empty.
    pub detail: &'static str,
    pub unit: &'static str,
    /// One SI unit in that unit.
    pub factor: f64,
}

impl Wording<'_> {
    /// The name with the detail.
    pub fn named(&self) -> String {
        format!("{} {}", self.name, self.detail)
            .trim_end()
            .to_owned()
    }
}

/// The wording of a parameter by the key that results have for it, [`Parameter`]'s variant: `GyroScale`.
pub(crate) fn wording(key: &str) -> Wording<'_> {
    let mut all = Parameter::ALL.into_iter();
    match all.find(|parameter| format!("{parameter:?}") == key) {
        Some(parameter) => of(parameter),
        // Results of another version.
        None => Wording {
            name: key,
            detail: "",
            unit: "SI",
            factor: 1.0,
        },
    }
}

fn of(parameter: Parameter) -> Wording<'static> {
    const TURNS: &str = "xy, xz, yx, yz, zx, zy";
    let (name, detail, unit, factor) = match parameter {
        Parameter::GyroScale => ("gyro scale factors", "x, y, z", "%", 100.0),
        Parameter::AccelScale => ("accelerometer scale factors", "x, y, z", "%", 100.0),
        Parameter::GyroMisalignment => ("gyro misalignment", TURNS, "°", DEGREES),
        Parameter::AccelMisalignment => ("accelerometer misalignment", TURNS, "°", DEGREES),
        Parameter::LeverArm => ("lever arm correction", "forward, right, down", "m", 1.0),
        Parameter::TimeOffset => (
            "time offset of the positions",
            "(true less stamped)",
            "ms",
            1e3,
        ),
        Parameter::VelocityTimeOffset => (
            "time offset of the velocities",
            "(true less stamped)",
            "ms",
            1e3,
        ),
        Parameter::ClockRate => (
            "rate of the fixes' clock",
            "(growth of the time offsets)",
            "ppm",
            1e6,
        ),
        Parameter::AccelDelay => (
            "delay of the accelerometers",
            "(against the gyros)",
            "ms",
            1e3,
        ),
        Parameter::Mounting => ("vehicle-to-body angles", "pitch, yaw", "°", DEGREES),
        Parameter::Axle => ("forward shift of the fixed axle", "", "m", 1.0),
        Parameter::OdometerScale => ("odometer scale factor", "", "%", 100.0),
        Parameter::BarometerBias => ("barometric height error", "", "m", 1.0),
        Parameter::HeadingOffset => (
            "direction of the second antenna",
            "(beyond the configured)",
            "°",
            DEGREES,
        ),
        Parameter::HardIron => ("hard iron of the magnetometer", "x, y, z", "µT", 1e6),
        Parameter::Wind => ("wind", "to north, to east", "m/s", 1.0),
        Parameter::TrimVelocity => ("velocity in trim", "forward, right, down", "m/s", 1.0),
        Parameter::RotorDrag => ("drag of the rotors", "(beyond the configured)", "1/s", 1.0),
        Parameter::Smoothing => (
            "smoothing by the receiver",
            "of positions, of velocities",
            "s²",
            1.0,
        ),
        Parameter::MarkerRotation => ("turn of the marker's axes", "x, y, z", "°", DEGREES),
        Parameter::FrameTilt => ("tilt of the poses' frame", "north, east", "°", DEGREES),
        Parameter::PositionError => ("correlated position error", "north, east, down", "σ", 1.0),
        Parameter::VelocityError => ("correlated velocity error", "north, east, down", "σ", 1.0),
    };
    Wording {
        name,
        detail,
        unit,
        factor,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Under the key of its results, with a name of its own, as many components as states, and the factor of its unit.
    #[test]
    fn each_parameter_is_in_a_unit_of_data_sheets() {
        let mut names = BTreeSet::new();
        for parameter in Parameter::ALL {
            let key = format!("{parameter:?}");
            let wording = wording(&key);
            let one = match wording.unit {
                "%" => 0.01,
                "°" => std::f64::consts::PI / 180.0,
                "ms" => 1e-3,
                "ppm" | "µT" => 1e-6,
                "m" | "m/s" | "1/s" | "s²" | "σ" => 1.0,
                unit => panic!("{key} in {unit}"),
            };
            assert!((wording.factor * one - 1.0).abs() < 1e-12, "{key}");
            let components = match wording.detail {
                "" => 1,
                remark if remark.starts_with('(') => 1,
                list => list.split(", ").count(),
            };
            assert_eq!(components, parameter.width(), "{key}");
            assert!(names.insert(wording.name.to_owned()), "{key}");
        }
        let other = wording("New");
        assert_eq!((&*other.named(), other.unit), ("New", "SI"));
        let clock = wording("ClockRate").named();
        assert_eq!(
            clock,
            "rate of the fixes' clock (growth of the time offsets)"
        );
    }
}
