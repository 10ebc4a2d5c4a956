//! Raw counts by sensor and range: `mpu6050/250dps`, `lsm6dso/16g`.
//!
//! Sensors of 16 bits give ±32768 counts for the range, except gyros of ST's LSM6 family, whose sensitivity is
//! a fixed 35 µdps of each dps of the range (data sheets, table of mechanical characteristics). What the range
//! measures says whether it is the gyro's or the accelerometer's.

use super::{
    UnitErrorKind,
    expression::{self, Unit},
};

/// Counts that the full range has.
const SIXTEEN_BITS: f64 = 32768.0;
/// Gyros of ST's LSM6 family: 35 µdps of each dps of the range.
const ST_GYRO: f64 = 1e6 / 35.0;

/// Sensors with the counts of their gyros' and accelerometers' full range, by their data sheets.
const SENSORS: [(&str, f64, f64); 10] = [
    ("mpu6050", SIXTEEN_BITS, SIXTEEN_BITS),
    ("mpu6500", SIXTEEN_BITS, SIXTEEN_BITS),
    ("mpu9250", SIXTEEN_BITS, SIXTEEN_BITS),
    ("icm20602", SIXTEEN_BITS, SIXTEEN_BITS),
    ("icm20948", SIXTEEN_BITS, SIXTEEN_BITS),
    ("icm42688", SIXTEEN_BITS, SIXTEEN_BITS),
    ("bmi160", SIXTEEN_BITS, SIXTEEN_BITS),
    ("bmi270", SIXTEEN_BITS, SIXTEEN_BITS),
    ("lsm6ds3", ST_GYRO, SIXTEEN_BITS),
    ("lsm6dso", ST_GYRO, SIXTEEN_BITS),
];

/// The unit of one count, `None` where the text does not begin with a sensor.
pub(super) fn read(text: &str) -> Option<Result<Unit, UnitErrorKind>> {
    let (name, range) = text.split_once('/')?;
    let name = name.trim();
    let (_, gyro, accel) = SENSORS
        .iter()
        .find(|(sensor, ..)| sensor.eq_ignore_ascii_case(name))?;
    let range = range.trim();
    let (number, unit) = range.split_at(expression::number_length(range));
    let Ok(number) = number.parse::<f64>() else {
        return Some(Err(UnitErrorKind::NoNumber));
    };
    if unit.trim().is_empty() {
        return Some(Err(UnitErrorKind::NoUnit));
    }
    Some(expression::read(unit.trim()).map(|unit| {
        let counts = if unit.dimension[2] == 0 { accel } else { gyro };
        Unit {
            factor: number * unit.factor / counts,
            counts: 2,
            ..unit
        }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        earth::STANDARD_GRAVITY,
        units::{Quantity, unit_factor},
    };
    use std::format;

    /// Range and sensitivity, counts per unit: of InvenSense's [dps] and everybody's [g].
    const GYRO: &[(f64, f64)] = &[
        (250.0, 131.0),
        (500.0, 65.5),
        (1000.0, 32.8),
        (2000.0, 16.4),
    ];
    const ACCEL: &[(f64, f64)] = &[(2.0, 16384.0), (4.0, 8192.0), (8.0, 4096.0), (16.0, 2048.0)];
    /// Range [dps] and sensitivity, units per count, of ST's: 4.375 to 70 mdps, 0.061 to 0.488 mg.
    const ST_GYRO: &[(f64, f64)] = &[
        (125.0, 1.0 / 4.375e-3),
        (250.0, 1.0 / 8.75e-3),
        (500.0, 1.0 / 17.5e-3),
        (1000.0, 1.0 / 35e-3),
        (2000.0, 1.0 / 70e-3),
    ];
    const ST_ACCEL: &[(f64, f64)] = &[
        (2.0, 1.0 / 0.061e-3),
        (4.0, 1.0 / 0.122e-3),
        (8.0, 1.0 / 0.244e-3),
        (16.0, 1.0 / 0.488e-3),
    ];

    type Sheet = (&'static str, &'static [(f64, f64)], &'static [(f64, f64)]);

    /// Sensitivities as the makers' data sheets have them.
    const SHEETS: [Sheet; 10] = [
        // PS-MPU-6000A-00 rev. 3.4, tables 6.1 and 6.2.
        ("mpu6050", GYRO, ACCEL),
        // PS-MPU-6500A-01 rev. 1.3, tables 1 and 2.
        ("mpu6500", GYRO, ACCEL),
        // PS-MPU-9250A-01 rev. 1.1, tables 1 and 2.
        ("mpu9250", GYRO, ACCEL),
        // DS-000176 rev. 1.0, tables 1 and 2.
        ("icm20602", GYRO, ACCEL),
        // DS-000189 rev. 1.3, tables 1 and 2.
        ("icm20948", GYRO, ACCEL),
        // DS-000347 rev. 1.6, tables 1 and 2: finer ranges, too.
        (
            "icm42688",
            &[
                (15.625, 2097.2),
                (31.25, 1048.6),
                (62.5, 524.3),
                (125.0, 262.0),
                (250.0, 131.0),
                (500.0, 65.5),
                (1000.0, 32.8),
                (2000.0, 16.4),
            ],
            ACCEL,
        ),
        // BST-BMI160-DS000, tables 3 and 4.
        (
            "bmi160",
            &[
                (125.0, 262.4),
                (250.0, 131.2),
                (500.0, 65.6),
                (1000.0, 32.8),
                (2000.0, 16.4),
            ],
            ACCEL,
        ),
        // BST-BMI270-DS000, tables 3 and 4.
        (
            "bmi270",
            &[
                (125.0, 262.144),
                (250.0, 131.072),
                (500.0, 65.536),
                (1000.0, 32.768),
                (2000.0, 16.384),
            ],
            ACCEL,
        ),
        // DocID026899 rev. 10, table 3.
        ("lsm6ds3", ST_GYRO, ST_ACCEL),
        // DS12140 rev. 6, table 2.
        ("lsm6dso", ST_GYRO, ST_ACCEL),
    ];

    #[test]
    fn a_count_of_every_sensor_is_what_its_data_sheet_says() {
        assert!(SENSORS.map(|sensor| sensor.0) == SHEETS.map(|sheet| sheet.0));
        let degree = 1f64.to_radians();
        for (sensor, gyro, accel) in SHEETS {
            for (ranges, unit, quantity, si) in [
                (gyro, "dps", Quantity::AngularRate, degree),
                (accel, "g", Quantity::Acceleration, STANDARD_GRAVITY),
            ] {
                for (range, sensitivity) in ranges {
                    let text = format!("{sensor}/{range}{unit}");
                    let count = unit_factor(&text, quantity).unwrap();
                    let ratio = count * sensitivity / si;
                    // Data sheets round to three digits: 16.4 for 16.384, 0.061 for 0.06104.
                    assert!((ratio - 1.0).abs() < 2e-3, "{text}: {ratio}");
                }
            }
        }
    }
}
