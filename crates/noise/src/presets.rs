//! Model files of well-known sensors, in `presets/*.toml` of this crate: copy one to start an own.

/// Names of the presets.
pub const NAMES: [&str; 5] = ["adis16405", "adis16465", "adis16488", "icm20602", "mpu6050"];

/// Text of the preset's model file.
pub fn text(name: &str) -> Option<&'static str> {
    match name {
        "adis16405" => Some(include_str!("../presets/adis16405.toml")),
        "adis16465" => Some(include_str!("../presets/adis16465.toml")),
        "adis16488" => Some(include_str!("../presets/adis16488.toml")),
        "icm20602" => Some(include_str!("../presets/icm20602.toml")),
        "mpu6050" => Some(include_str!("../presets/mpu6050.toml")),
        _ => None,
    }
}
