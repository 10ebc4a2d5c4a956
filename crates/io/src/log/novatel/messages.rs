//! Which messages are read, and what those of positions, velocities and solutions say.

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, TruthSample};
use undrift_nav::{Matrix3, Vector3};

use super::fields::Fields;
use super::frames::MessageKind;
use crate::entry::{Heading, StreamKind};
use crate::fix::independent;
use crate::log::bytes::Number::{F32, F64, U32};

/// What a message holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    Position,
    Velocity,
    /// INSPVA and INSPVAS; INSPVAX.
    Solution,
    Extended,
    /// RAWIMU and RAWIMUS; RAWIMUX and RAWIMUSX.
    Raw,
    RawExtended,
    /// Of the receiver's inertial system: the type of the IMU.
    Setup,
    /// HEADING2 and its like.
    Heading,
    Other,
}

pub(super) struct Known {
    number: u16,
    pub(super) name: &'static str,
    pub(super) content: Content,
}

const fn known(number: u16, name: &'static str, content: Content) -> Known {
    Known {
        number,
        name,
        content,
    }
}

/// Messages by number and name; of positions and of velocities the best first.
const KNOWN: [Known; 32] = [
    known(1429, "BESTGNSSPOS", Content::Position),
    known(42, "BESTPOS", Content::Position),
    known(47, "PSRPOS", Content::Position),
    known(1430, "BESTGNSSVEL", Content::Velocity),
    known(99, "BESTVEL", Content::Velocity),
    known(100, "PSRVEL", Content::Velocity),
    known(507, "INSPVA", Content::Solution),
    known(508, "INSPVAS", Content::Solution),
    known(1465, "INSPVAX", Content::Extended),
    known(268, "RAWIMU", Content::Raw),
    known(325, "RAWIMUS", Content::Raw),
    known(1461, "RAWIMUX", Content::RawExtended),
    known(1462, "RAWIMUSX", Content::RawExtended),
    known(1945, "INSCONFIG", Content::Setup),
    known(812, "CORRIMUDATA", Content::Other),
    known(813, "CORRIMUDATAS", Content::Other),
    known(2264, "CORRIMUS", Content::Other),
    known(1362, "IMURATECORRIMUS", Content::Other),
    known(43, "RANGE", Content::Other),
    known(140, "RANGECMP", Content::Other),
    known(101, "TIME", Content::Other),
    known(174, "BESTXYZ", Content::Other),
    known(263, "INSATT", Content::Other),
    known(319, "INSATTS", Content::Other),
    known(264, "INSCOV", Content::Other),
    known(320, "INSCOVS", Content::Other),
    known(2051, "INSSTDEV", Content::Other),
    known(1335, "HEADING2", Content::Heading),
    known(2042, "DUALANTENNAHEADING", Content::Heading),
    known(971, "HEADING", Content::Heading),
    known(93, "RXSTATUS", Content::Other),
    known(37, "VERSION", Content::Other),
];

pub(super) fn find(kind: &MessageKind) -> Option<&'static Known> {
    KNOWN.iter().find(|known| match kind {
        MessageKind::Number(number) => known.number == *number,
        MessageKind::Name(name) => text(name) == known.name.as_bytes(),
    })
}

/// The names of the messages with such content, in order.
pub(super) fn names(wanted: &[Content]) -> Vec<&'static str> {
    let those = KNOWN.iter().filter(|known| wanted.contains(&known.content));
    those.map(|known| known.name).collect()
}

/// A name without what fills it up.
fn text(name: &[u8]) -> &[u8] {
    name.split(|&byte| byte == 0).next().unwrap_or_default()
}

pub(super) fn name(kind: &MessageKind) -> String {
    match (find(kind), kind) {
        (Some(known), _) => known.name.to_owned(),
        (None, MessageKind::Number(number)) => format!("message {number}"),
        (None, MessageKind::Name(name)) => String::from_utf8_lossy(text(name)).into_owned(),
    }
}

pub(super) fn described(kind: &MessageKind) -> (StreamKind, &'static str) {
    let corrected = "without gravity and the Earth's rate: no inertial samples";
    match find(kind) {
        None => (StreamKind::Other, ""),
        Some(known) => match known.content {
            Content::Position => (StreamKind::Fixes, "position"),
            Content::Velocity => (StreamKind::Velocity, "velocity"),
            Content::Solution => (StreamKind::Poses, "position, velocity and attitude"),
            Content::Extended => (
                StreamKind::Poses,
                "position, velocity and attitude with standard deviations",
            ),
            Content::Raw => (StreamKind::Imu, "counts of the IMU, without its type"),
            Content::RawExtended => (StreamKind::Imu, "counts of the IMU"),
            Content::Setup => (StreamKind::Other, "type of the IMU"),
            Content::Heading => (
                StreamKind::Headings,
                "second antenna as seen from the first",
            ),
            Content::Other if known.name.contains("CORRIMU") => (StreamKind::Other, corrected),
            Content::Other => (StreamKind::Other, ""),
        },
    }
}

const COMPUTED: (u32, &str) = (0, "SOL_COMPUTED");

/// Kinds of solution that ASCII names; what is not listed is of unknown quality.
#[rustfmt::skip]
const TYPES: [(u32, &str); 31] = [
    (0, "NONE"), (1, "FIXEDPOS"), (2, "FIXEDHEIGHT"), (8, "DOPPLER_VELOCITY"), (16, "SINGLE"),
    (17, "PSRDIFF"), (18, "WAAS"), (19, "PROPAGATED"), (20, "OMNISTAR"), (32, "L1_FLOAT"), (33, "IONOFREE_FLOAT"),
    (34, "NARROW_FLOAT"), (48, "L1_INT"), (49, "WIDE_INT"), (50, "NARROW_INT"), (51, "RTK_DIRECT_INS"),
    (52, "INS_SBAS"), (53, "INS_PSRSP"), (54, "INS_PSRDIFF"), (55, "INS_RTKFLOAT"), (56, "INS_RTKFIXED"),
    (64, "OMNISTAR_HP"), (65, "OMNISTAR_XP"), (68, "PPP_CONVERGING"), (69, "PPP"), (73, "INS_PPP_CONVERGING"),
    (74, "INS_PPP"), (77, "PPP_BASIC_CONVERGING"), (78, "PPP_BASIC"), (79, "INS_PPP_BASIC_CONVERGING"),
    (80, "INS_PPP_BASIC"),
];

/// The quality of a kind of solution; `None` for one that no satellites of the epoch made.
fn quality(code: Option<u32>) -> Option<FixQuality> {
    match code {
        Some(0 | 1 | 19) => None,
        Some(16 | 53) => Some(FixQuality::Single),
        Some(17 | 18 | 20 | 52 | 54 | 64 | 65 | 68 | 69 | 73 | 74 | 77..=80) => {
            Some(FixQuality::Differential)
        }
        Some(32..=34 | 55) => Some(FixQuality::Float),
        Some(48..=51 | 56) => Some(FixQuality::Fixed),
        _ => Some(FixQuality::Unknown),
    }
}

/// States of the inertial solution in which it is one.
const STATES: [(u32, &str); 4] = [
    (2, "INS_HIGH_VARIANCE"),
    (3, "INS_SOLUTION_GOOD"),
    (6, "INS_SOLUTION_FREE"),
    (7, "INS_ALIGNMENT_COMPLETE"),
];

fn is_solution(state: Option<u32>) -> bool {
    STATES.iter().any(|(code, _)| state == Some(*code))
}

/// A position, its covariance north-east-down where it can be one \[m²\], and its quality.
pub(super) struct BestPosition {
    pub(super) position: Geodetic,
    pub(super) covariance: Option<Matrix3>,
    pub(super) quality: FixQuality,
}

/// Of BESTPOS and its like: `None` if it is too short, `None` inside without a fix.
pub(super) fn place(mut fields: Fields) -> Option<Option<BestPosition>> {
    let status = fields.code(&[COMPUTED])?;
    let quality = quality(fields.code(&TYPES)?);
    let [lat, lon, above_sea] = fields.three(F64)?;
    let undulation = fields.number(F32)?;
    fields.skip(4)?;
    let std = Vector3::from(fields.three(F32)?);
    let computed = quality.filter(|_| status == Some(COMPUTED.0));
    Some(computed.map(|quality| BestPosition {
        position: Geodetic::from_degrees(lat, lon, above_sea + undulation),
        covariance: independent(&std),
        quality,
    }))
}

/// A velocity north-east-down [m/s] and how long before the message's time it was \[s\].
pub(super) struct Motion {
    pub(super) velocity: Vector3,
    pub(super) latency: f64,
}

/// Longest latency that is believed \[s\]: half an interval of 0.1 Hz.
const MAX_LATENCY: f64 = 5.0;

/// Of BESTVEL and its like: `None` if it is too short, `None` inside without a fix.
pub(super) fn motion(mut fields: Fields) -> Option<Option<Motion>> {
    let status = fields.code(&[COMPUTED])?;
    let made = quality(fields.code(&TYPES)?).is_some();
    let latency = fields.number(F32)?;
    fields.skip(4)?;
    let [speed, course, up] = fields.three(F64)?;
    let (east, north) = course.to_radians().sin_cos();
    let computed = made && status == Some(COMPUTED.0) && (0.0..=MAX_LATENCY).contains(&latency);
    Some(computed.then(|| Motion {
        velocity: Vector3::new(speed * north, speed * east, -up),
        latency,
    }))
}

/// What the inertial system has computed.
pub(super) struct Solution {
    /// Without a time.
    pub(super) pose: TruthSample,
    /// GPS week and second of it, where the body has them.
    pub(super) time: Option<(f64, f64)>,
    pub(super) place: BestPosition,
    /// Covariance of the velocity north-east-down [(m/s)²].
    pub(super) velocity: Option<Matrix3>,
}

/// North, east, up as down.
fn ned([north, east, up]: [f64; 3]) -> Vector3 {
    Vector3::new(north, east, -up)
}

/// Roll, pitch, azimuth, whose axes are right, forward, up: about forward, right and down the signs are
/// the same.
fn attitude(degrees: [f64; 3]) -> Vector3 {
    Vector3::from(degrees.map(f64::to_radians))
}

/// Of INSPVA and INSPVAS: `None` if it is too short, `None` inside without a solution.
pub(super) fn solution(mut fields: Fields) -> Option<Option<Solution>> {
    let time = (fields.number(U32)?, fields.number(F64)?);
    let [lat, lon, height] = fields.three(F64)?;
    let (v_n, rpy) = (ned(fields.three(F64)?), attitude(fields.three(F64)?));
    let state = fields.code(&STATES)?;
    let position = Geodetic::from_degrees(lat, lon, height);
    Some(is_solution(state).then(|| Solution {
        pose: pose(position, v_n, rpy),
        time: Some(time),
        place: BestPosition {
            position,
            covariance: None,
            quality: FixQuality::Unknown,
        },
        velocity: None,
    }))
}

/// Of INSPVAX: `None` if it is too short, `None` inside without a solution.
pub(super) fn extended(mut fields: Fields) -> Option<Option<Solution>> {
    let state = fields.code(&STATES)?;
    let quality = quality(fields.code(&TYPES)?);
    let [lat, lon, above_sea] = fields.three(F64)?;
    let position = Geodetic::from_degrees(lat, lon, above_sea + fields.number(F32)?);
    let (v_n, rpy) = (ned(fields.three(F64)?), attitude(fields.three(F64)?));
    let (place, velocity) = (fields.three(F32)?, fields.three(F32)?);
    Some(is_solution(state).then(|| Solution {
        pose: pose(position, v_n, rpy),
        time: None,
        place: BestPosition {
            position,
            covariance: independent(&Vector3::from(place)),
            quality: quality.unwrap_or_default(),
        },
        velocity: independent(&Vector3::from(velocity)),
    }))
}

fn pose(position: Geodetic, v_n: Vector3, rpy: Vector3) -> TruthSample {
    TruthSample {
        time: 0.0,
        position,
        v_n: Some(v_n),
        rpy: Some(rpy),
    }
}

/// Of HEADING2 and its like, without a time: `None` if it is too short, `None` inside without a solution of whole wavelengths.
pub(super) fn heading(mut fields: Fields) -> Option<Option<Heading>> {
    let status = fields.code(&[COMPUTED])?;
    let quality = quality(fields.code(&TYPES)?);
    let [_length, heading, _pitch] = fields.three(F32)?;
    fields.skip(4)?;
    let std = fields.number(F32)?;
    let vouched = status == Some(COMPUTED.0) && quality == Some(FixQuality::Fixed);
    Some(vouched.then(|| Heading {
        time: 0.0,
        heading: heading.to_radians(),
        std: Some(std.to_radians()).filter(|std| *std > 0.0),
    }))
}
