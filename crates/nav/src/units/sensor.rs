//! Raw counts by sensor and range: `mpu6050/250dps`, `lsm6dso/16g`.

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
