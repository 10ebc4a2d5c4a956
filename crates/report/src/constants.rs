//! The constants that the filter may estimate beside the sensors' errors, in words.

const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// What a constant is called, and its unit in texts.
pub(crate) struct Constant<'a> {
    pub name: &'a str,
    /// Its components in their order; empty where it is one number.
    pub components: &'static str,
    pub unit: &'static str,
    /// One SI unit in that unit.
    pub factor: f64,
}

impl Constant<'_> {
    /// The name with the components.
    pub fn named(&self) -> String {
        format!("{} {}", self.name, self.components)
            .trim_end()
            .to_owned()
    }
}

/// The constant of a kind of [`undrift_nav::parameters::Parameter`].
pub(crate) fn constant(kind: &str) -> Constant<'_> {
    let (name, components, unit, factor) = match kind {
        "GyroScale" => ("gyro scale factors", "x, y, z", "%", 100.0),
        "AccelScale" => ("accelerometer scale factors", "x, y, z", "%", 100.0),
        "GyroMisalignment" => ("gyro misalignment", "xy, xz, yx, yz, zx, zy", "°", DEGREES),
        "AccelMisalignment" => (
            "accelerometer misalignment",
            "xy, xz, yx, yz, zx, zy",
            "°",
            DEGREES,
        ),
        "LeverArm" => ("lever arm correction", "forward, right, down", "m", 1.0),
        "TimeOffset" => (
            "time offset of the positions",
            "(true less stamped)",
            "ms",
            1e3,
        ),
        "VelocityTimeOffset" => (
            "time offset of the velocities",
            "(true less stamped)",
            "ms",
            1e3,
        ),
        "ClockRate" => ("rate of the fixes' clock", "(offset grows)", "ppm", 1e6),
        "AccelDelay" => (
            "delay of the accelerometers",
            "(against the gyros)",
            "ms",
            1e3,
        ),
        "Mounting" => ("vehicle-to-body angles", "pitch, yaw", "°", DEGREES),
        "Axle" => ("forward shift of the fixed axle", "", "m", 1.0),
        "OdometerScale" => ("odometer scale factor", "", "%", 100.0),
        "BarometerBias" => ("barometric height error", "", "m", 1.0),
        "HeadingOffset" => (
            "direction of the second antenna",
            "(beyond the configured)",
            "°",
            DEGREES,
        ),
        "HardIron" => ("hard iron of the magnetometer", "x, y, z", "µT", 1e6),
        "Wind" => ("wind", "to north, to east", "m/s", 1.0),
        "TrimVelocity" => ("velocity in trim", "forward, right, down", "m/s", 1.0),
        "RotorDrag" => ("drag of the rotors", "(beyond the configured)", "1/s", 1.0),
        "Smoothing" => (
            "smoothing by the receiver",
            "positions, velocities",
            "s²",
            1.0,
        ),
        "MarkerRotation" => ("turn of the marker's axes", "x, y, z", "°", DEGREES),
        "FrameTilt" => ("tilt of the poses' frame", "north, east", "°", DEGREES),
        "PositionError" => ("correlated position error", "north, east, down", "σ", 1.0),
        "VelocityError" => ("correlated velocity error", "north, east, down", "σ", 1.0),
        other => (other, "", "SI", 1.0),
    };
    Constant {
        name,
        components,
        unit,
        factor,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_constant_is_in_a_unit_of_data_sheets() {
        const DEG: f64 = std::f64::consts::PI / 180.0;
        for (kind, named, unit, one) in [
            ("GyroScale", "gyro scale factors x, y, z", "%", 0.01),
            (
                "AccelScale",
                "accelerometer scale factors x, y, z",
                "%",
                0.01,
            ),
            (
                "GyroMisalignment",
                "gyro misalignment xy, xz, yx, yz, zx, zy",
                "°",
                DEG,
            ),
            (
                "AccelMisalignment",
                "accelerometer misalignment xy, xz, yx, yz, zx, zy",
                "°",
                DEG,
            ),
            (
                "LeverArm",
                "lever arm correction forward, right, down",
                "m",
                1.0,
            ),
            (
                "TimeOffset",
                "time offset of the positions (true less stamped)",
                "ms",
                1e-3,
            ),
            (
                "VelocityTimeOffset",
                "time offset of the velocities (true less stamped)",
                "ms",
                1e-3,
            ),
            (
                "ClockRate",
                "rate of the fixes' clock (offset grows)",
                "ppm",
                1e-6,
            ),
            (
                "AccelDelay",
                "delay of the accelerometers (against the gyros)",
                "ms",
                1e-3,
            ),
            ("Mounting", "vehicle-to-body angles pitch, yaw", "°", DEG),
            ("Axle", "forward shift of the fixed axle", "m", 1.0),
            ("OdometerScale", "odometer scale factor", "%", 0.01),
            ("BarometerBias", "barometric height error", "m", 1.0),
            (
                "Smoothing",
                "smoothing by the receiver positions, velocities",
                "s²",
                1.0,
            ),
            (
                "MarkerRotation",
                "turn of the marker's axes x, y, z",
                "°",
                DEG,
            ),
            (
                "FrameTilt",
                "tilt of the poses' frame north, east",
                "°",
                DEG,
            ),
            (
                "PositionError",
                "correlated position error north, east, down",
                "σ",
                1.0,
            ),
            (
                "VelocityError",
                "correlated velocity error north, east, down",
                "σ",
                1.0,
            ),
            ("New", "New", "SI", 1.0),
        ] {
            let constant = constant(kind);
            assert_eq!((&*constant.named(), constant.unit), (named, unit));
            assert!((constant.factor * one - 1.0).abs() < 1e-12, "{kind}");
        }
    }
}
