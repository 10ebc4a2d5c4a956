//! Which sensor an IMU is, where its log shows that: by a name in it, or by the steps of its values.

use super::{Inspection, Known, Model, first};
use undrift_nav::{earth::STANDARD_GRAVITY, sample::ImuSample};
use undrift_noise::ImuModel;

/// Steps of the values of sensors that differ in them, by their data sheets: preset, gyro [deg/s], accelerometer \[g\].
/// 16-bit consumer sensors have the same steps: they cannot be distinguished.
const STEPS: [(&str, f64, f64); 5] = [
    ("adis16405", 0.05, 1.0 / 300.0),
    ("adis16465", 0.025, 0.25e-3),
    ("adis16465", 0.00625, 0.25e-3),
    ("adis16470", 0.1, 1.25e-3),
    ("adis16488", 0.02, 0.8e-3),
];
/// Samples that are looked at.
const LOOKED_AT: u32 = 5000;
/// Distance from a multiple of the step, as a share of it, of values that are rounded in a text.
const ROUNDED: f64 = 0.1;
/// Share of the values on the steps of the sensor that has them, at least; and on steps twice as large, at most.
const SHARES: (f64, f64) = (0.99, 0.9);
/// Preset that a drive file begins with where nothing shows the kind of sensor: a consumer's.
pub(super) const GUESS: &str = "mpu6050";

/// Counts values on the steps of each of [`STEPS`], and on steps twice as large: gyro, accelerometer.
#[derive(Default)]
pub(super) struct Steps {
    samples: u32,
    on: [[[u32; 2]; 2]; STEPS.len()],
}

impl Steps {
    pub(super) fn add(&mut self, sample: &ImuSample) {
        if self.samples == LOOKED_AT {
            return;
        }
        self.samples += 1;
        let values = [
            (sample.dtheta / sample.dt).map(f64::to_degrees),
            sample.dvel / sample.dt / STANDARD_GRAVITY,
        ];
        for ((_, gyro, accel), on) in STEPS.iter().zip(&mut self.on) {
            for ((value, step), on) in values.iter().zip([gyro, accel]).zip(on) {
                for (multiple, on) in [1.0, 2.0].into_iter().zip(on) {
                    let steps = value / (step * multiple);
                    let off = steps.map(|steps| (steps - steps.round()).abs() * multiple);
                    *on += off.iter().filter(|off| **off <= ROUNDED).count() as u32;
                }
            }
        }
    }

    /// The sensor with these steps.
    pub(super) fn sensor(&self) -> Option<&'static str> {
        let all = 3.0 * f64::from(self.samples.max(1));
        let has = |[on, on_twice]: &[u32; 2]| {
            f64::from(*on) >= SHARES.0 * all && f64::from(*on_twice) <= SHARES.1 * all
        };
        let found = STEPS.iter().zip(&self.on);
        found
            .filter(|(_, on)| on.iter().all(has))
            .map(|((name, ..), _)| *name)
            .next()
    }
}

/// The noise model of a drive file that reads the first IMU of the files.
pub fn model(inspections: &[Inspection]) -> Model {
    if let Some((file, part)) = first(inspections, "imu") {
        let streams = file.streams.iter();
        let words = streams.flat_map(|(name, _, about)| [name.as_str(), about]);
        let mut columns = part.lines.iter().map(|line| line.value.to_string());
        let path = file.file.iter().rev().take(2);
        let mut names = path.filter_map(|name| name.to_str()).chain(words);
        let preset = names.find_map(named);
        if let Some(preset) = preset.or_else(|| columns.find_map(|name| named(&name))) {
            let known = Known::SensorName;
            return Model { preset, known };
        }
        if let Some(preset) = part.measured.as_ref().and_then(|of| of.steps_of) {
            let known = Known::Steps;
            return Model { preset, known };
        }
    }
    let (preset, known) = (GUESS, Known::NoSensor);
    Model { preset, known }
}

/// The preset whose name a text holds, however that is written: `ADIS16405-run1`, `ICM-20948`, `icm42688`.
fn named(text: &str) -> Option<&'static str> {
    let letters = |c: char| c.is_ascii_alphanumeric().then(|| c.to_ascii_lowercase());
    let text: String = text.chars().filter_map(letters).collect();
    let holds = |preset: &&&str| {
        let part = preset.trim_end_matches(|c: char| c.is_ascii_alphabetic());
        text.match_indices(part).any(|(at, _)| {
            let next = text[at + part.len()..].chars().next();
            !next.is_some_and(|next| next.is_ascii_digit())
        })
    };
    ImuModel::preset_names().iter().find(holds).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::Vector3;

    #[test]
    fn names_in_any_spelling() {
        for (text, preset) in [
            ("ADIS16405-run1.csv", Some("adis16405")),
            ("/imu/icm-20948/data", Some("icm20948")),
            ("icm42688.log", Some("icm42688p")),
            ("mti1_3.csv", None),
            ("adis164051", None),
            ("imu.csv", None),
        ] {
            assert_eq!(named(text), preset, "{text}");
        }
    }

    /// Values on a grid, gyro [deg/s] and accelerometer \[g\].
    fn of(gyro: f64, accel: f64) -> Option<&'static str> {
        let mut steps = Steps::default();
        for k in 0..1000 {
            let count = f64::from(k * 7919 % 1009 - 500);
            let dt = 0.01 + 1e-5 * f64::from(k % 3);
            steps.add(&ImuSample {
                time: 0.01 * f64::from(k),
                dt,
                dtheta: Vector3::repeat((gyro * count).to_radians() * dt),
                dvel: Vector3::repeat(accel * count * STANDARD_GRAVITY * dt),
            });
        }
        steps.sensor()
    }

    #[test]
    fn steps_that_no_other_sensor_has() {
        assert_eq!(of(0.05, 1.0 / 300.0), Some("adis16405"));
        assert_eq!(of(0.025, 0.25e-3), Some("adis16465"));
        assert_eq!(of(0.1, 1.25e-3), Some("adis16470"));
        assert_eq!(of(0.02, 0.8e-3), Some("adis16488"));
        // Consumers' steps, decimals of a text, and no steps at all.
        for (gyro, accel) in [
            (1.0 / 131.0, 1.0 / 16384.0),
            (0.01, 0.001),
            (0.001, 0.001),
            (0.1, 0.01),
            (1e-7, 1e-7),
            (0.0, 0.0),
        ] {
            assert_eq!(of(gyro, accel), None, "{gyro} {accel}");
        }
    }
}
