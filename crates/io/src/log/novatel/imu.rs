//! Raw inertial messages: counts of velocity and angle over an interval of the sensor, by its type.
//!
//! The messages hold z, −y, x of the IMU's own axes. What a count is worth depends on the type, which
//! RAWIMUX and RAWIMUSX tell in every message and INSCONFIG once; for RAWIMU and RAWIMUS alone it has to be
//! stated. Most types count increments, which the interval between the stamps makes rates of; after a gap,
//! an interval of more than 1.5 usual ones, the usual one is what they were collected in.

use undrift_nav::Vector3;
use undrift_nav::earth::STANDARD_GRAVITY;

use super::fields::Fields;
use crate::gaps::{GAP_INTERVALS, Gap, GapWatch};
use crate::log::bytes::Number;

/// What a type is called and what its counts are worth.
pub(super) struct Type {
    pub(super) code: u32,
    /// Name in an ASCII INSCONFIG log.
    pub(super) name: &'static str,
    scale: Scale,
}

/// What one count is worth.
#[derive(Clone, Copy)]
enum Scale {
    /// Of angle \[rad\] and velocity [m/s] over the interval.
    Increments { gyro: f64, accel: f64 },
    /// Of angular rate [rad/s] and specific force [m/s²].
    Rates { gyro: f64, accel: f64 },
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const FOOT: f64 = 0.3048;

/// 2 to a power, exactly.
const fn two(exponent: u32) -> f64 {
    (1u64 << exponent) as f64
}

const fn increments(code: u32, name: &'static str, gyro: f64, accel: f64) -> Type {
    let scale = Scale::Increments { gyro, accel };
    Type { code, name, scale }
}

const fn rates(code: u32, name: &'static str, gyro: f64, accel: f64) -> Type {
    let scale = Scale::Rates { gyro, accel };
    Type { code, name, scale }
}

/// NovAtel's OEM7 documentation, log RAWIMUSX, table of raw IMU scale factors.
#[rustfmt::skip]
pub(super) const TYPES: [Type; 23] = [
    increments(1, "HONEYWELL_HG1700_AG11", 1.0 / two(33), FOOT / two(27)),
    increments(4, "HONEYWELL_HG1700_AG17", 1.0 / two(33), FOOT / two(26)),
    increments(5, "HONEYWELL_HG1900_CA29", 1.0 / two(33), FOOT / two(27)),
    increments(8, "LN200", 1.0 / two(19), 1.0 / two(14)),
    increments(11, "HONEYWELL_HG1700_AG58", 1.0 / two(33), FOOT / two(27)),
    increments(12, "HONEYWELL_HG1700_AG62", 1.0 / two(33), FOOT / two(26)),
    increments(13, "IMAR_FSAS", 0.1 / two(8) / 3600.0 * DEGREE, 0.05 / two(15)),
    increments(16, "KVH_COTS", 0.1 / (3600.0 * 256.0), 0.05 / two(15)),
    increments(20, "HONEYWELL_HG1930_AA99", 1.0 / two(33), FOOT / two(27)),
    increments(26, "ISA100C", 1e-9, 2e-8),
    increments(27, "HONEYWELL_HG1900_CA50", 1.0 / two(33), FOOT / two(27)),
    increments(28, "HONEYWELL_HG1930_CA50", 1.0 / two(33), FOOT / two(27)),
    increments(31, "ADIS16488", 720.0 / two(31) * DEGREE, 200.0 / two(31)),
    increments(32, "STIM300", DEGREE / two(21), 1.0 / two(22)),
    increments(33, "KVH_1750", 0.1 / (3600.0 * 256.0), 0.05 / two(15)),
    rates(41, "EPSON_G320", 0.008 / two(16) * DEGREE, 0.2e-3 / two(16) * STANDARD_GRAVITY),
    increments(52, "LITEF_MICROIMU", 1e-9, 2e-8),
    increments(56, "STIM300D", DEGREE / two(21), 1.0 / two(22)),
    increments(58, "HONEYWELL_HG4930_AN01", 1.0 / two(33), 1.0 / two(29)),
    rates(61, "EPSON_G370", 0.015_151_5 / two(16) * DEGREE, 0.4e-3 / two(16) * STANDARD_GRAVITY),
    rates(62, "EPSON_G320_200HZ", 0.008 / two(16) * DEGREE, 0.2e-3 / two(16) * STANDARD_GRAVITY),
    increments(68, "HONEYWELL_HG4930_AN04", 1.0 / two(33), 1.0 / two(29)),
    increments(69, "HONEYWELL_HG4930_AN04_400HZ", 1.0 / two(33), 1.0 / two(29)),
];

pub(super) fn by_code(code: u32) -> Option<&'static Type> {
    TYPES.iter().find(|known| known.code == code)
}

pub(super) fn by_name(name: &str) -> Option<&'static Type> {
    TYPES.iter().find(|known| known.name == name)
}

/// One raw message: counts along x, y, z.
pub(super) struct Raw {
    /// Of the type, where the message states it.
    pub(super) code: Option<u32>,
    /// Whether the receiver calls it damaged.
    pub(super) fault: bool,
    pub(super) week: f64,
    /// Of the week \[s\].
    pub(super) seconds: f64,
    gyro: Vector3,
    accel: Vector3,
}

impl Raw {
    /// Of RAWIMUX or RAWIMUSX if `extended`, else of RAWIMU or RAWIMUS; `None` if it is too short.
    pub(super) fn read(mut fields: Fields, extended: bool) -> Option<Self> {
        let (mut code, mut fault) = (None, false);
        let week = if extended {
            // In hexadecimal digits, where it is text.
            fault = fields.hexadecimal(Number::U8)? & 1 != 0;
            code = Some(fields.number(Number::U8)? as u32);
            fields.number(Number::U16)?
        } else {
            fields.number(Number::U32)?
        };
        let seconds = fields.number(Number::F64)?;
        fields.skip(4)?;
        let mut xyz = || {
            let [z, minus_y, x] = fields.three(Number::I32)?;
            Some(Vector3::new(x, -minus_y, z))
        };
        let (accel, gyro) = (xyz()?, xyz()?);
        Some(Self {
            code,
            fault,
            week,
            seconds,
            gyro,
            accel,
        })
    }
}

/// A sample: rates, or increments that wait for their interval.
#[derive(Clone, Copy)]
struct Held {
    at: u64,
    time: f64,
    gyro: Vector3,
    accel: Vector3,
}

/// Makes rates of counts.
#[derive(Default)]
pub(super) struct Rates {
    gaps: GapWatch,
    /// The first sample, whose interval is that of the second.
    first: Option<Held>,
    last: Option<f64>,
}

impl Rates {
    /// Rates of a message at a time \[s\], and of the first one when the second shows its interval.
    pub(super) fn add(
        &mut self,
        at: u64,
        time: f64,
        raw: &Raw,
        of: &Type,
        mut give: impl FnMut(u64, f64, Vector3, Vector3),
    ) {
        let (gyro, accel) = match of.scale {
            Scale::Rates { gyro, accel } => {
                return give(at, time, raw.gyro * gyro, raw.accel * accel);
            }
            Scale::Increments { gyro, accel } => (raw.gyro * gyro, raw.accel * accel),
        };
        let held = Held {
            at,
            time,
            gyro,
            accel,
        };
        let Some(last) = self.last else {
            (self.first, self.last) = (Some(held), Some(time));
            return;
        };
        let length = time - last;
        // Times that do not go forward are for the reader to count.
        if length <= 0.0 {
            return give(at, time, gyro, accel);
        }
        self.last = Some(time);
        let usual = self.gaps.nominal().unwrap_or(length);
        self.gaps.add(Gap {
            start: last,
            length,
            line: at,
        });
        let covered = if length > GAP_INTERVALS * usual {
            usual
        } else {
            length
        };
        if let Some(first) = self.first.take() {
            let Held { at, time, .. } = first;
            give(at, time, first.gyro / covered, first.accel / covered);
        }
        give(at, time, gyro / covered, accel / covered);
    }
}
