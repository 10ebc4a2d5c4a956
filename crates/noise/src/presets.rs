//! Model files of well-known sensors, in `presets/*.toml` of this crate: copy one to start your own.
//!
//! Their numbers are those of data sheets and publications, named in each file, not of your unit: turn-on constants and slow
//! parts differ between units of one type. A recording at rest of an hour or more ([`mod@crate::identify`]) is better.
//!
//! ```
//! use undrift_noise::{ImuModel, presets};
//! assert_eq!(presets::near("ADIS-16465"), ["adis16465"]);
//! for name in presets::NAMES {
//!     assert!(presets::text(name).is_some() && ImuModel::preset(name).is_some());
//! }
//! ```

/// The presets from their names, which are those of their files.
macro_rules! presets {
    ($($name:literal),* $(,)?) => {
        /// Names of the presets, in alphabetical order.
        pub const NAMES: &[&str] = &[$($name),*];

        /// Text of the preset's model file.
        pub fn text(name: &str) -> Option<&'static str> {
            match name {
                $($name => Some(include_str!(concat!("../presets/", $name, ".toml"))),)*
                _ => None,
            }
        }
    };
}

presets![
    "adis16405",
    "adis16465",
    "adis16470",
    "adis16488",
    "bmi055",
    "bmi088",
    "bmi160",
    "bmi270",
    "icm20602",
    "icm20948",
    "icm42688p",
    "icm45686",
    "imx5",
    "ism330dhcx",
    "lsm6dso",
    "lsm6dsv",
    "mpu6050",
    "mti1",
    "mti300",
    "mti630",
    "vn100",
];

/// Hint in messages: the command that shows the presets.
pub const LISTED: &str = "`undrift model --list` shows the presets";
/// Longest name that is compared \[bytes\].
const LONGEST: usize = 40;
/// Most names that are suggested.
const SUGGESTED: usize = 3;

/// The presets nearest to a `name` that is not a preset's, at most three: those of another spelling (`ADIS-16465`), else with the fewest
/// other characters, else those that begin with it.
///
/// ```
/// use undrift_noise::presets::near;
/// assert_eq!(near("MPU-6050"), ["mpu6050"]); // Another spelling.
/// assert!(near("bmi").contains(&"bmi088")); // The beginning of some.
/// assert!(near("an accelerometer").is_empty());
/// ```
pub fn near(name: &str) -> Vec<&'static str> {
    let letters = |c: char| c.is_ascii_alphanumeric().then(|| c.to_ascii_lowercase());
    let wanted: String = name.chars().filter_map(letters).collect();
    if wanted.len() < 3 || wanted.len() > LONGEST {
        return Vec::new();
    }
    let distance = |preset: &str| match undrift_base::nearby::edits(&wanted, preset) {
        Some(edits) if edits <= wanted.len() / 4 => Some(edits),
        _ => preset.starts_with(&wanted).then_some(wanted.len()),
    };
    let distances: Vec<_> = NAMES
        .iter()
        .filter_map(|preset| Some((distance(preset)?, *preset)))
        .collect();
    let least = distances.iter().map(|(distance, _)| *distance).min();
    let nearest = distances
        .into_iter()
        .filter(|(distance, _)| Some(*distance) == least);
    nearest.map(|(_, preset)| preset).take(SUGGESTED).collect()
}

/// Hint for an unknown preset name: names near it, and where all are.
pub(crate) fn suggestion(name: &str) -> String {
    match near(name).join(" or ") {
        none if none.is_empty() => LISTED.into(),
        names => format!("did you mean {names}? {LISTED}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_near_another() {
        for (name, presets) in [
            ("ADIS-16465", &["adis16465"][..]),
            ("adis16466", &["adis16465"]),
            ("ICM-42688-P", &["icm42688p"]),
            ("icm42688", &["icm42688p"]),
            ("mpu6500", &["mpu6050"]),
            ("vn-110", &["vn100"]),
            ("mti", &["mti1", "mti300", "mti630"]),
            ("adis", &["adis16405", "adis16465", "adis16470"]),
            ("imu.toml", &[]),
            ("ad", &[]),
            ("", &[]),
        ] {
            assert_eq!(near(name), presets, "{name}");
        }
        assert!(near(&"a".repeat(1_000_000)).is_empty());
    }
}
