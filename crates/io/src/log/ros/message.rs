//! The messages that are read, in the serialisation of ROS 1 and in the CDR of ROS 2. Their fields
//! are those of the definitions in the packages `sensor_msgs`, `geometry_msgs` and `nav_msgs`.

use std::borrow::Cow;

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::FixQuality;
use undrift_nav::{Matrix3, Vector3};

use crate::entry::{LocalPose, StreamKind};
use crate::fix::{finite, is_covariance, on_earth};
use crate::log::bytes::ByteFields;
use crate::rotation::of_quaternion;
use crate::skipped::{SkipKind, Unfit};

/// How messages are serialised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Encoding {
    Ros1,
    Cdr,
}

/// A type of message that is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    Imu,
    MagneticField,
    NavSatFix,
    TwistStamped,
    TwistWithCovarianceStamped,
    PoseStamped,
    PoseWithCovarianceStamped,
    TransformStamped,
    Odometry,
    /// Several [`Type::TransformStamped`] in a message.
    Transforms,
}

impl Type {
    /// By its name of ROS 1, `package/Type`.
    pub(super) fn named(name: &str) -> Option<Self> {
        match name {
            "sensor_msgs/Imu" => Some(Self::Imu),
            "sensor_msgs/MagneticField" => Some(Self::MagneticField),
            "sensor_msgs/NavSatFix" => Some(Self::NavSatFix),
            "geometry_msgs/TwistStamped" => Some(Self::TwistStamped),
            "geometry_msgs/TwistWithCovarianceStamped" => Some(Self::TwistWithCovarianceStamped),
            "geometry_msgs/PoseStamped" => Some(Self::PoseStamped),
            "geometry_msgs/PoseWithCovarianceStamped" => Some(Self::PoseWithCovarianceStamped),
            "geometry_msgs/TransformStamped" => Some(Self::TransformStamped),
            "nav_msgs/Odometry" => Some(Self::Odometry),
            "tf2_msgs/TFMessage" | "tf/tfMessage" => Some(Self::Transforms),
            _ => None,
        }
    }

    pub(super) fn kind(self) -> StreamKind {
        match self {
            Self::Imu => StreamKind::Imu,
            Self::MagneticField => StreamKind::Fields,
            Self::NavSatFix => StreamKind::Fixes,
            Self::TwistStamped | Self::TwistWithCovarianceStamped => StreamKind::Velocity,
            Self::PoseStamped
            | Self::PoseWithCovarianceStamped
            | Self::TransformStamped
            | Self::Odometry => StreamKind::LocalPoses,
            Self::Transforms => StreamKind::Other,
        }
    }

    /// Whether the name of the frame that is posed comes behind the header.
    fn names_child(self) -> bool {
        matches!(self, Self::TransformStamped | Self::Odometry)
    }
}

/// The name of a type as ROS 1 writes it, `package/Type`.
pub(super) fn of_ros1(type_name: &str) -> String {
    type_name.replacen("/msg/", "/", 1)
}

/// What every one of them starts with.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header<'a> {
    /// Seconds and nanoseconds of Unix time; both zero where it is not set.
    pub(super) stamp: (i64, u32),
    /// The frame that the data are in.
    pub(super) frame: Cow<'a, str>,
}

/// The fields of a message after its header, and the header.
pub(super) fn header(encoding: Encoding, bytes: &[u8]) -> Option<(Header<'_>, ByteFields<'_>)> {
    let mut fields = fields(encoding, bytes)?;
    Some((header_of(encoding, &mut fields)?, fields))
}

/// The fields of a message from its start.
pub(super) fn fields(encoding: Encoding, bytes: &[u8]) -> Option<ByteFields<'_>> {
    match encoding {
        Encoding::Ros1 => Some(ByteFields::packed(bytes)),
        Encoding::Cdr => ByteFields::cdr(bytes),
    }
}

/// The header that comes next.
pub(super) fn header_of<'a>(encoding: Encoding, fields: &mut ByteFields<'a>) -> Option<Header<'a>> {
    let seconds = match encoding {
        Encoding::Ros1 => {
            // A sequence number comes first.
            fields.u32()?;
            i64::from(fields.u32()?)
        }
        Encoding::Cdr => i64::from(fields.u32()?.cast_signed()),
    };
    let stamp = (seconds, fields.u32()?);
    let frame = fields.text()?;
    Some(Header { stamp, frame })
}

/// The name of the frame that a pose is of, where messages of a type have it; read before [`pose`].
pub(super) fn child<'a>(kind: Type, fields: &mut ByteFields<'a>) -> Option<Cow<'a, str>> {
    kind.names_child().then(|| fields.text()).flatten()
}

/// The pose of a message at a time \[s\]: what turns vectors of the frame that is posed into those of the header's. The covariance is
/// that of the position and of the rotation about the header's axes; a block of it that is no covariance, such as zeros
/// or with −1 in front, is not stated.
pub(super) fn pose(time: f64, kind: Type, fields: &mut ByteFields) -> Result<LocalPose, Unfit> {
    let [x, y, z, qx, qy, qz, qw] = fields.array::<7>().ok_or_else(too_short)?;
    let vector = finite(Vector3::new(qx, qy, qz))?;
    let attitude = of_quaternion(finite(Vector3::repeat(qw))?.x, vector.into())?;
    let covariance = match kind {
        Type::PoseWithCovarianceStamped | Type::Odometry => {
            Some(fields.array::<36>().ok_or_else(too_short)?)
        }
        _ => None,
    };
    let block = |from: usize| {
        let all = covariance?;
        let number = |row: usize, column: usize| all.get(6 * (from + row) + from + column).copied();
        let full = Matrix3::from_fn(|row, column| number(row, column).unwrap_or(f64::NAN));
        Some((full + full.transpose()) / 2.0).filter(is_covariance)
    };
    Ok(LocalPose {
        time,
        position: Some(finite(Vector3::new(x, y, z))?),
        attitude,
        position_covariance: block(0),
        attitude_covariance: block(3),
    })
}

/// Angular rate [rad/s] and specific force [m/s²] of sensor_msgs/Imu, axes of its frame.
///
/// A first covariance element of −1 says that the quantity is not given.
pub(super) fn imu(fields: &mut ByteFields) -> Result<(Vector3, Vector3), Unfit> {
    let mut read = || {
        fields.array::<13>()?;
        let rate = fields.array::<12>()?;
        let force = fields.array::<12>()?;
        Some((rate, force))
    };
    let (rate, force) = read().ok_or_else(too_short)?;
    for (quantity, [_, _, _, first, ..]) in [("angular rate", rate), ("acceleration", force)] {
        if first == -1.0 {
            return Err((SkipKind::MissingField, format!("no {quantity}")));
        }
    }
    Ok((finite(vector(&rate))?, finite(vector(&force))?))
}

/// Field \[T\] of sensor_msgs/MagneticField, axes of its frame.
pub(super) fn field(fields: &mut ByteFields) -> Result<Vector3, Unfit> {
    let field = fields.array::<3>().ok_or_else(too_short)?;
    finite(Vector3::from(field))
}

/// Position, its covariance north-east-down \[m²\] and the quality of sensor_msgs/NavSatFix.
///
/// Status 0 is a fix without, 1 one with satellite-based corrections. Status 2, ground-based
/// corrections, covers everything from differential code to resolved ambiguities, so it says
/// nothing. The covariance is east-north-up, of type 0 where it is unknown; an invalid one, such
/// as all zero, counts as unknown.
pub(super) fn fix(
    fields: &mut ByteFields,
) -> Result<(Geodetic, Option<Matrix3>, FixQuality), Unfit> {
    let mut read = || {
        let status = fields.u8()?.cast_signed();
        fields.u16()?;
        Some((
            status,
            fields.array::<3>()?,
            fields.array::<9>()?,
            fields.u8()?,
        ))
    };
    let (status, place, covariance, kind) = read().ok_or_else(too_short)?;
    if status < 0 {
        return Err((SkipKind::OutOfRange, format!("status {status}, no fix")));
    }
    let place = finite(Vector3::from(place))?;
    let position = on_earth(Geodetic::from_degrees(place.x, place.y, place.z))?;
    let covariance = match kind {
        0 => None,
        // Only the diagonal is known.
        2 => ned_covariance(Matrix3::from_diagonal(
            &Matrix3::from_row_slice(&covariance).diagonal(),
        )),
        _ => ned_covariance(Matrix3::from_row_slice(&covariance)),
    };
    let quality = match status {
        0 => FixQuality::Single,
        1 => FixQuality::Differential,
        _ => FixQuality::Unknown,
    };
    Ok((position, covariance, quality))
}

/// Velocity north-east-down [m/s] and its covariance [(m/s)²] of geometry_msgs/TwistStamped or
/// TwistWithCovarianceStamped, which are east-north-up (REP-103).
pub(super) fn velocity(
    fields: &mut ByteFields,
    with_covariance: bool,
) -> Result<(Vector3, Option<Matrix3>), Unfit> {
    let twist = fields.array::<6>().ok_or_else(too_short)?;
    let v_n = ned(&finite(vector(&twist))?);
    if !with_covariance {
        return Ok((v_n, None));
    }
    let all = fields.array::<36>().ok_or_else(too_short)?;
    let linear = Matrix3::from_fn(|row, column| all.get(6 * row + column).copied().unwrap_or(0.0));
    Ok((v_n, ned_covariance(linear)))
}

/// North-east-down of east-north-up, and the reverse.
fn ned(enu: &Vector3) -> Vector3 {
    Vector3::new(enu.y, enu.x, -enu.z)
}

/// A covariance north-east-down of one east-north-up; `None` if it is invalid: not finite, not
/// positive definite.
fn ned_covariance(enu: Matrix3) -> Option<Matrix3> {
    let turn = Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0);
    let ned = turn * ((enu + enu.transpose()) / 2.0) * turn;
    Some(ned).filter(is_covariance)
}

/// The first three of an array.
fn vector<const N: usize>(array: &[f64; N]) -> Vector3 {
    Vector3::from_iterator(array.iter().copied().chain(std::iter::repeat(0.0)))
}

pub(super) fn too_short() -> Unfit {
    (SkipKind::MissingField, "a message too short".to_owned())
}
