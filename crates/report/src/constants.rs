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

/// The constant of a kind of [`undrift::nav::parameters::Parameter`].
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
        "Mounting" => ("vehicle-to-body angles", "pitch, yaw", "°", DEGREES),
        "Axle" => ("forward shift of the fixed axle", "", "m", 1.0),
        "OdometerScale" => ("odometer scale factor", "", "%", 100.0),
        "BarometerBias" => ("barometric height error", "", "m", 1.0),
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
