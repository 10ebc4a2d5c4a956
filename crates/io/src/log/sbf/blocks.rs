//! What the blocks say.

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, TruthSample};
use undrift_nav::{Matrix3, Vector3};

use crate::fix::{independent, is_covariance};
use crate::log::bytes::{ByteFields, Number};

pub(super) const PVT: u16 = 4007;
pub(super) const POSITION_COVARIANCE: u16 = 5906;
pub(super) const VELOCITY_COVARIANCE: u16 = 5908;
pub(super) const END_OF_PVT: u16 = 5921;
/// The same along the axes of the Earth.
pub(super) const CARTESIAN: u16 = 4006;
pub(super) const CARTESIAN_POSITION_COVARIANCE: u16 = 5905;
pub(super) const CARTESIAN_VELOCITY_COVARIANCE: u16 = 5907;
pub(super) const SENSORS: u16 = 4050;
pub(super) const INS: u16 = 4226;
pub(super) const ATTITUDE: u16 = 5938;
pub(super) const ATTITUDE_COVARIANCE: u16 = 5939;

/// What a block has in place of a number that it does not know.
const UNKNOWN: f64 = -2e10;

/// Time of week \[ms\] and GPS week, which begin every block; `None` if the receiver does not know them.
pub(super) fn stamp(body: &[u8]) -> Option<(u32, u16)> {
    let mut fields = ByteFields::packed(body);
    let (milli, week) = (fields.u32()?, fields.u16()?);
    (milli != u32::MAX && week != u16::MAX).then_some((milli, week))
}

/// What comes behind the stamp.
fn behind(body: &[u8]) -> Option<ByteFields<'_>> {
    body.get(6..).map(ByteFields::packed)
}

fn floats<const N: usize>(fields: &mut ByteFields) -> Option<[f64; N]> {
    let mut all = [0.0; N];
    for value in &mut all {
        *value = Number::F32.read(fields.take(4)?, false)?;
    }
    Some(all)
}

/// Whether all are known and numbers.
fn known<const N: usize>(values: [f64; N]) -> Option<[f64; N]> {
    let is = |value: &f64| value.is_finite() && *value != UNKNOWN;
    values.iter().all(is).then_some(values)
}

/// The kind of a solution; `None` without one, or with that of a place that was stated.
fn quality(mode: u8) -> Option<FixQuality> {
    match mode & 15 {
        0 | 3 => None,
        1 => Some(FixQuality::Single),
        2 | 6 | 10 => Some(FixQuality::Differential),
        4 | 7 => Some(FixQuality::Fixed),
        5 | 8 => Some(FixQuality::Float),
        _ => Some(FixQuality::Unknown),
    }
}

/// A position and velocity of the receiver.
pub(super) struct Pvt {
    pub(super) quality: FixQuality,
    pub(super) position: Option<Geodetic>,
    /// By the block's own accuracies \[m²\].
    pub(super) covariance: Option<Matrix3>,
    pub(super) velocity: Option<Vector3>,
    /// From the axes of the blocks of covariances to north-east-down.
    pub(super) ned_from_axes: Matrix3,
}

/// Of PVTGeodetic: `None` if it is too short, `None` inside without a fix.
pub(super) fn pvt(body: &[u8]) -> Option<Option<Pvt>> {
    let solution = solution(body)?;
    Some(solution.map(|of| Pvt {
        quality: of.quality,
        position: (of.place.filter(|_| !of.flat)).map(|[lat, lon, height]| Geodetic {
            lat,
            lon,
            height,
        }),
        covariance: accuracies(body),
        velocity: of.velocity.map(|[n, e, u]| Vector3::new(n, e, -u)),
        ned_from_axes: Matrix3::identity(),
    }))
}

/// Of PVTCartesian: `None` if it is too short, `None` inside without a fix or a place.
pub(super) fn cartesian_pvt(body: &[u8]) -> Option<Option<Pvt>> {
    let solution = solution(body)?;
    Some(solution.and_then(|of| {
        let place = Geodetic::from_ecef(&Vector3::from(of.place?));
        let ned_from_axes = place.ned_from_ecef();
        Some(Pvt {
            quality: of.quality,
            position: (!of.flat).then_some(place),
            covariance: accuracies(body),
            velocity: of.velocity.map(|v| ned_from_axes * Vector3::from(v)),
            ned_from_axes,
        })
    }))
}

/// What both kinds of PVT have at the same places.
struct Solution {
    quality: FixQuality,
    place: Option<[f64; 3]>,
    /// Of two dimensions only: the height is an old one.
    flat: bool,
    velocity: Option<[f64; 3]>,
}

/// `None` if it is too short, `None` inside without a fix.
fn solution(body: &[u8]) -> Option<Option<Solution>> {
    let mut fields = behind(body)?;
    let (mode, error) = (fields.u8()?, fields.u8()?);
    let place = fields.array::<3>()?;
    let [_, velocity @ ..]: [f64; 4] = floats(&mut fields)?;
    let quality = quality(mode).filter(|_| error == 0);
    Some(quality.map(|quality| Solution {
        quality,
        place: known(place),
        flat: mode & 0x80 != 0,
        velocity: known(velocity),
    }))
}

/// Twice the root mean square of the horizontal distance and of the height [0.01 m], which revision 2 has.
fn accuracies(body: &[u8]) -> Option<Matrix3> {
    let mut fields = ByteFields::packed(body.get(82..)?);
    let twice = |value: u16| (value != u16::MAX).then(|| f64::from(value) * 0.01 / 2.0);
    let (horizontal, vertical) = (twice(fields.u16()?)?, twice(fields.u16()?)?);
    let each = horizontal * std::f64::consts::FRAC_1_SQRT_2;
    independent(&Vector3::new(each, each, vertical))
}

/// Of PosCovGeodetic and VelCovGeodetic, north-east-down: `None` if it is too short, `None` inside where
/// it cannot be one.
pub(super) fn covariance(body: &[u8]) -> Option<Option<Matrix3>> {
    let up_is_down = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0));
    let own = own_covariance(body)?;
    Some(own.map(|own| up_is_down * own * up_is_down))
}

/// Along the block's own axes, north-east-up or those of the Earth.
pub(super) fn own_covariance(body: &[u8]) -> Option<Option<Matrix3>> {
    let mut fields = behind(body)?;
    let error = [fields.u8()?, fields.u8()?][1];
    // Three axes, clock; then pairs.
    let [xx, yy, zz, _, xy, xz, _, yz, _, _] = floats(&mut fields)?;
    let full = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let is_known = error == 0 && known([xx, yy, zz, xy, xz, yz]).is_some();
    Some(Some(full).filter(|full| is_known && is_covariance(full)))
}

/// Rates [rad/s] and specific forces [m/s²] of a sensor.
pub(super) struct Sample {
    pub(super) gyro: Vector3,
    pub(super) accel: Vector3,
}

/// Of ExtSensorMeas, of the sensor `source` or else of the first that has some: `None` if it is too
/// short, `None` inside without both.
pub(super) fn sample(body: &[u8], source: &mut Option<u8>) -> Option<Option<Sample>> {
    let mut fields = behind(body)?;
    let (count, length) = (fields.u8()?, usize::from(fields.u8()?));
    let (mut accel, mut gyro, mut any) = (None, None, false);
    for _ in 0..count {
        let mut part = ByteFields::packed(fields.take(length)?);
        let (from, _model, kind, _) = (part.u8()?, part.u8()?, part.u8()?, part.u8()?);
        if kind > 1 || *source.get_or_insert(from) != from {
            continue;
        }
        any = true;
        let three = known(part.array::<3>()?).map(Vector3::from);
        match kind {
            0 => accel = three,
            _ => gyro = three.map(|rate| rate.map(f64::to_radians)),
        }
    }
    match (gyro, accel) {
        (Some(gyro), Some(accel)) => Some(Some(Sample { gyro, accel })),
        // Nothing but temperatures, or of another sensor.
        _ if !any => None,
        _ => Some(None),
    }
}

/// What the receiver's inertial system has computed.
pub(super) struct Ins {
    /// Without a time.
    pub(super) pose: TruthSample,
    pub(super) quality: FixQuality,
    /// Covariances north-east-down of position \[m²\] and velocity [(m/s)²].
    pub(super) covariances: [Option<Matrix3>; 2],
}

/// Of INSNavGeod: `None` if it is too short, `None` inside without a solution.
pub(super) fn ins(body: &[u8]) -> Option<Option<Ins>> {
    let mut fields = behind(body)?;
    let (mode, error) = (fields.u8()?, fields.u8()?);
    fields.take(4)?;
    let place = fields.array::<3>()?;
    fields.take(10)?;
    let parts = fields.u16()?;
    // Each part that there is has three numbers, in this order: standard deviations of the position,
    // attitude, its standard deviations, velocity, its standard deviations.
    let mut next = |bit: u32| {
        let there = parts & (1 << bit) != 0;
        there
            .then(|| floats::<3>(&mut fields))
            .map(|three| three.and_then(known))
    };
    let (position_std, attitude, _) = (next(0), next(1), next(2));
    let (velocity, velocity_std) = (next(3), next(4));
    let present = |part: Option<Option<[f64; 3]>>| part.flatten();
    let Some([lat, lon, height]) = known(place).filter(|_| error == 0) else {
        return Some(None);
    };
    // Heading, pitch, roll; east, north, up.
    let rpy =
        |[heading, pitch, roll]: [f64; 3]| Vector3::new(roll, pitch, heading).map(f64::to_radians);
    let ned = |[east, north, up]: [f64; 3]| Vector3::new(north, east, -up);
    let diagonal = |std: Vector3| independent(&std);
    Some(Some(Ins {
        pose: TruthSample {
            time: 0.0,
            position: Geodetic { lat, lon, height },
            v_n: present(velocity).map(ned),
            rpy: present(attitude).map(rpy),
        },
        quality: quality(mode).unwrap_or_default(),
        covariances: [
            present(position_std).and_then(|std| diagonal(Vector3::from(std))),
            present(velocity_std).and_then(|[e, n, u]| diagonal(Vector3::new(n, e, u))),
        ],
    }))
}

/// Heading \[rad\] of AttEuler: `None` if it is too short, `None` inside unless the antennas' vectors are ones of whole wavelengths.
pub(super) fn heading(body: &[u8]) -> Option<Option<f64>> {
    let mut fields = behind(body)?;
    let (_satellites, error, mode) = (fields.u8()?, fields.u8()?, fields.u16()?);
    fields.take(2)?;
    let [heading] = floats(&mut fields)?;
    // The error of the vector to the first auxiliary antenna, and whether attitude was asked for.
    let vouched = error & 0b1000_0011 == 0 && matches!(mode, 2 | 4);
    Some(
        known([heading])
            .filter(|_| vouched)
            .map(|[heading]| heading.to_radians()),
    )
}

/// Standard deviation \[rad\] of the heading by AttCovEuler: `None` if it is too short, `None` inside where it is not known.
pub(super) fn heading_std(body: &[u8]) -> Option<Option<f64>> {
    let mut fields = behind(body)?;
    let (_, error) = (fields.u8()?, fields.u8()?);
    let [variance] = floats(&mut fields)?;
    let variance =
        known([variance]).filter(|[variance]| error & 0b1000_0011 == 0 && *variance > 0.0);
    Some(variance.map(|[variance]| variance.sqrt().to_radians()))
}
