//! Messages of MAVLink's common set: their layouts, fields in order of size as on the wire.

use crate::log::bytes::Number;
use undrift_nav::{Vector3, earth::Geodetic, earth::STANDARD_GRAVITY, sample::FixQuality};

pub(super) const SYSTEM_TIME: u32 = 2;
pub(super) const GPS_RAW_INT: u32 = 24;
pub(super) const SCALED_IMU: u32 = 26;
pub(super) const RAW_IMU: u32 = 27;
pub(super) const HIGHRES_IMU: u32 = 105;
pub(super) const SCALED_IMU2: u32 = 116;
pub(super) const GPS2_RAW: u32 = 124;
pub(super) const SCALED_IMU3: u32 = 129;

/// Messages that logs often have: number, the byte of the definition in the CRC, name.
const KNOWN: [(u32, u8, &str); 18] = [
    (0, 50, "HEARTBEAT"),
    (1, 124, "SYS_STATUS"),
    (SYSTEM_TIME, 137, "SYSTEM_TIME"),
    (GPS_RAW_INT, 24, "GPS_RAW_INT"),
    (SCALED_IMU, 170, "SCALED_IMU"),
    (RAW_IMU, 144, "RAW_IMU"),
    (29, 115, "SCALED_PRESSURE"),
    (30, 39, "ATTITUDE"),
    (31, 246, "ATTITUDE_QUATERNION"),
    (32, 185, "LOCAL_POSITION_NED"),
    (33, 104, "GLOBAL_POSITION_INT"),
    (74, 20, "VFR_HUD"),
    (HIGHRES_IMU, 93, "HIGHRES_IMU"),
    (SCALED_IMU2, 76, "SCALED_IMU2"),
    (GPS2_RAW, 87, "GPS2_RAW"),
    (SCALED_IMU3, 46, "SCALED_IMU3"),
    (232, 151, "GPS_INPUT"),
    (331, 91, "ODOMETRY"),
];

/// The byte of a message's definition in its CRC, where that is known.
pub(super) fn crc_extra(number: u32) -> Option<u8> {
    let known = KNOWN.iter().find(|(known, ..)| *known == number);
    known.map(|(_, extra, _)| *extra)
}

/// A message's name.
pub(super) fn name(number: u32) -> &'static str {
    let known = KNOWN.iter().find(|(known, ..)| *known == number);
    known.map_or("", |(.., name)| name)
}

/// A stamp: of 64 bits \[µs\], or of 32 bits that begin again \[ms\].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stamp {
    Micro(u64),
    Milli(u32),
}

/// A body, whose zeros at the end may be missing.
struct Body<'a>(&'a [u8]);

impl Body<'_> {
    fn bytes<const N: usize>(&self, at: usize) -> [u8; N] {
        std::array::from_fn(|k| self.0.get(at + k).copied().unwrap_or(0))
    }

    fn number(&self, at: usize, number: Number) -> f64 {
        number.read(&self.bytes::<8>(at), false).unwrap_or_default()
    }

    fn three(&self, at: usize, number: Number) -> Vector3 {
        let size = number.size();
        Vector3::from_fn(|k, _| self.number(at + k * size, number))
    }

    fn micro(&self) -> Stamp {
        Stamp::Micro(u64::from_le_bytes(self.bytes(0)))
    }
}

/// An inertial sample.
pub(super) struct Sample {
    pub(super) stamp: Stamp,
    pub(super) gyro: Vector3,
    pub(super) accel: Vector3,
    /// [°C]
    pub(super) temperature: f64,
}

/// The sample of a message; `None` of any other. RAW_IMU has the units of SCALED_IMU, as autopilots send it.
pub(super) fn sample(number: u32, body: &[u8]) -> Option<Sample> {
    let body = Body(body);
    // [0.01 °C], 0 where it is not known.
    let centi = |at: usize| Some(body.number(at, Number::I16)).filter(|t| *t != 0.0);
    let (stamp, accel, unit, temperature) = match number {
        HIGHRES_IMU => {
            let temperature = body.number(56, Number::F32);
            return Some(Sample {
                stamp: body.micro(),
                accel: body.three(8, Number::F32),
                gyro: body.three(20, Number::F32),
                // The last of its flags: whether there is one.
                temperature: match u16::from_le_bytes(body.bytes(60)) & 0x1000 {
                    0 => f64::NAN,
                    _ => temperature,
                },
            });
        }
        RAW_IMU => (body.micro(), 8, Number::I16, centi(27)),
        SCALED_IMU | SCALED_IMU2 | SCALED_IMU3 => {
            let milli = u32::from_le_bytes(body.bytes(0));
            (Stamp::Milli(milli), 4, Number::I16, centi(22))
        }
        _ => return None,
    };
    Some(Sample {
        stamp,
        accel: body.three(accel, unit) * (1e-3 * STANDARD_GRAVITY),
        gyro: body.three(accel + 6, unit) * 1e-3,
        temperature: temperature.map_or(f64::NAN, |centi| centi * 1e-2),
    })
}

/// A fix.
pub(super) struct Gps {
    pub(super) stamp: Stamp,
    pub(super) place: Geodetic,
    /// Whether there is a position in three dimensions.
    pub(super) has_position: bool,
    pub(super) quality: FixQuality,
    /// Speed over ground [m/s] and course \[rad\].
    pub(super) motion: Option<[f64; 2]>,
    /// Uncertainties of the horizontal position and the height \[m\] and of the speed [m/s], where they are stated.
    pub(super) std: [Option<f64>; 3],
}

/// Where the fields of a fix are: the type of fix, eph (with epv, speed and course behind it), height above the ellipsoid (with the
/// uncertainties behind it).
const GPS_FIELDS: [(u32, [usize; 3]); 2] = [
    (GPS_RAW_INT, [28, 20, 30]),
    // Behind the yaw of 16 bits.
    (GPS2_RAW, [32, 24, 37]),
];

/// The fix of a message; `None` of any other, and inside without a fix.
pub(super) fn gps(number: u32, body: &[u8]) -> Option<Option<Gps>> {
    let (_, [kind, eph, ellipsoid]) = *GPS_FIELDS.iter().find(|(known, _)| *known == number)?;
    let body = Body(body);
    let quality = match body.number(kind, Number::U8) as u8 {
        2 | 3 => FixQuality::Single,
        4 | 8 => FixQuality::Differential,
        5 => FixQuality::Float,
        6 | 7 => FixQuality::Fixed,
        _ => return Some(None),
    };
    let degrees = |at: usize| (body.number(at, Number::I32) * 1e-7).to_radians();
    let height = |at: usize| body.number(at, Number::I32) * 1e-3;
    let above_ellipsoid = height(ellipsoid);
    let unknown = f64::from(u16::MAX);
    let [speed, course] = [4, 6].map(|at| body.number(eph + at, Number::U16));
    let motion =
        (speed < unknown && course < unknown).then(|| [speed * 1e-2, (course * 1e-2).to_radians()]);
    let std = [4, 8, 12].map(|at| {
        let milli = body.number(ellipsoid + at, Number::U32);
        (milli > 0.0).then_some(milli * 1e-3)
    });
    Some(Some(Gps {
        stamp: body.micro(),
        place: Geodetic {
            lat: degrees(8),
            lon: degrees(12),
            // Old messages have that above the sea alone.
            height: match above_ellipsoid == 0.0 {
                true => height(16),
                false => above_ellipsoid,
            },
        },
        has_position: body.number(kind, Number::U8) > 2.0,
        quality,
        motion,
        std,
    }))
}

/// Unix time \[µs\] and time since the start \[ms\] of SYSTEM_TIME, where the former is known.
pub(super) fn system_time(body: &[u8]) -> Option<(u64, u32)> {
    let body = Body(body);
    let unix = u64::from_le_bytes(body.bytes(0));
    let boot = u32::from_le_bytes(body.bytes(8));
    (unix > 0).then_some((unix, boot))
}
