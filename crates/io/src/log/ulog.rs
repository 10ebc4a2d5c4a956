//! PX4 ULog: the format is that of PX4's developer documentation, "ULog File Format", version 1.
//!
//! Streams are topics with their instance, such as `vehicle_imu.0`; a name without a number is
//! instance 0.
//!
//! * Inertial samples: `vehicle_imu` has increments over intervals that it tells, `sensor_combined`
//!   mean rates; both are forward-right-down. PX4 often logs `vehicle_imu` thinned, a short interval
//!   now and then: that gives no rates in between and is refused.
//! * Fixes: `vehicle_gps_position`, `sensor_gps`. Fix types 3 (single), 4 (differential), 5 (float)
//!   and 6 (fixed) are read. `eph` is taken for the standard deviation of north and of east each,
//!   `epv` for that of the height, `s_variance_m_s`, which is none, for that of each component of
//!   the velocity; zero or not finite is unknown. The height is that above the ellipsoid where it is
//!   set, that is not 0, else that above mean sea level.
//! * Positions: `vehicle_global_position` with the velocity of the `vehicle_local_position` before it
//!   that has the same time.
//!
//! Without a name, the stream of the kind that comes first in this order is taken: `vehicle_imu`,
//! `sensor_combined`; `vehicle_gps_position`, `sensor_gps`; the simulator's ground truth,
//! `vehicle_global_position`; lower instances first, but none that has less than half as many
//! messages as another. To find it, the file is read once more before.
//!
//! Times are seconds since the start of the system: `timestamp_sample` where it is set, else
//! `timestamp`. A fix without `timestamp_sample` has the time at which it arrived, some 0.1 s after
//! its validity; the log does not tell how much. `timestamp_time_relative` is about the time of UTC
//! and not used.

mod layout;
mod messages;
mod reader;
#[cfg(test)]
mod tests;
mod topics;

use std::collections::HashMap;
use std::path::Path;

use self::messages::{MAGIC, Messages, Step};
use self::reader::Reader;
use super::{Entries, Stream, StreamKind, Wanted};
use crate::ReadError;
use crate::source::{self, Source};

/// Names that a message lists at most.
const NAMES_SHOWN: usize = 60;

/// Whether a file that starts so is a ULog.
pub(crate) fn detect(start: &[u8]) -> bool {
    start.starts_with(&MAGIC)
}

pub(super) fn entries(path: &Path, source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    let (name, kind, key) = match wanted {
        Wanted::Imu(name) => (name, StreamKind::Imu, "imu.topic"),
        Wanted::Fixes { position, velocity } => {
            let mut both = position.iter().zip(velocity.iter());
            if both.any(|(position, velocity)| named(position) != named(velocity)) {
                return Err(
                    ReadError::new(path, "positions and velocities are one topic")
                        .key("gnss.velocity_topic")
                        .mend("leave the velocity's out"),
                );
            }
            (
                if position.is_some() {
                    position
                } else {
                    velocity
                },
                StreamKind::Fixes,
                "gnss.topic",
            )
        }
        Wanted::Poses(name) => (name, StreamKind::Poses, "truth.topic"),
    };
    let wanted = match name {
        Some(name) => named(name),
        None => {
            let there = streams(path, source::open(path)?)?;
            choose(&there, kind).ok_or_else(|| nothing(path, key, &there))?
        }
    };
    let topic = topic_of(&wanted);
    if topics::kind_of(topic).0 != kind {
        let problem = format!("{wanted} is {}", topics::about(topic));
        let there = streams(path, source::open(path)?)?;
        return Err(ReadError::new(path, problem).key(key).mend(listing(&there)));
    }
    let messages = Messages::open(path, source)?;
    let poses = kind == StreamKind::Poses;
    Ok(Box::new(Reader::new(path, messages, wanted, key, poses)))
}

pub(super) fn streams(path: &Path, source: Source) -> Result<Vec<Stream>, ReadError> {
    let mut messages = Messages::open(path, source)?;
    let mut topics: Vec<(String, u64)> = Vec::new();
    let mut ids: HashMap<u16, usize> = HashMap::new();
    loop {
        let body = match messages.step() {
            Step::End(_) => break,
            Step::Damaged(_) => continue,
            Step::Message(kind @ (b'A' | b'B' | b'D')) => (kind, messages.body()),
            Step::Message(_) => continue,
        };
        match body {
            (b'A', body) => {
                let Some((id, name)) = subscription(body) else {
                    continue;
                };
                let known = topics.iter().position(|(topic, _)| *topic == name);
                let index = known.unwrap_or_else(|| {
                    topics.push((name, 0));
                    topics.len() - 1
                });
                ids.insert(id, index);
            }
            (b'B', body) => {
                let offsets = appended(path, body)?;
                messages.set_appended(offsets.into_iter());
            }
            (_, body) => {
                let index = data(body).and_then(|(id, _)| ids.get(&id));
                if let Some((_, count)) = index.and_then(|index| topics.get_mut(*index)) {
                    *count += 1;
                }
            }
        }
    }
    let stream = |(name, messages): (String, u64)| Stream {
        kind: topics::kind_of(topic_of(&name)).0,
        about: topics::about(topic_of(&name)).to_owned(),
        name,
        messages,
    };
    Ok(topics.into_iter().map(stream).collect())
}

/// The name of a stream with its instance.
fn named(name: &str) -> String {
    match name.rsplit_once('.') {
        Some((_, instance)) if instance.parse::<u8>().is_ok() => name.to_owned(),
        _ => format!("{name}.0"),
    }
}

fn topic_of(stream: &str) -> &str {
    stream.rsplit_once('.').map_or(stream, |(topic, _)| topic)
}

/// The stream that is meant where none is named.
fn choose(there: &[Stream], kind: StreamKind) -> Option<String> {
    let of_kind = || there.iter().filter(|s| s.kind == kind && s.messages > 0);
    let most = of_kind().map(|stream| stream.messages).max()?;
    of_kind()
        .filter(|stream| stream.messages >= most.div_ceil(2))
        .min_by_key(|stream| (topics::kind_of(topic_of(&stream.name)).1, &stream.name))
        .map(|stream| stream.name.clone())
}

fn listing(there: &[Stream]) -> String {
    let names: Vec<&str> = there.iter().map(|stream| stream.name.as_str()).collect();
    let shown = names.get(..NAMES_SHOWN).unwrap_or(&names).join(", ");
    let more = if names.len() > NAMES_SHOWN {
        ", …"
    } else {
        ""
    };
    format!("the log has: {shown}{more}")
}

fn nothing(path: &Path, key: &str, there: &[Stream]) -> ReadError {
    let topics = match key {
        "imu.topic" => "vehicle_imu or sensor_combined",
        "gnss.topic" => "vehicle_gps_position or sensor_gps",
        _ => "vehicle_global_position",
    };
    ReadError::new(path, format!("no {topics}"))
        .key(key)
        .mend(listing(there))
}

/// Number and stream of a subscription: instance, number, topic.
fn subscription(body: &[u8]) -> Option<(u16, String)> {
    let (&[instance, low, high], topic) = body.split_first_chunk()?;
    let topic = std::str::from_utf8(topic).ok()?;
    let id = u16::from_le_bytes([low, high]);
    Some((id, format!("{topic}.{instance}")))
}

/// Number of the subscription and content of a data message.
fn data(body: &[u8]) -> Option<(u16, &[u8])> {
    let (id, content) = body.split_first_chunk()?;
    Some((u16::from_le_bytes(*id), content))
}

/// Where data was appended. Flags that a reader has to know and that are not known are an error.
fn appended(path: &Path, flags: &[u8]) -> Result<Vec<u64>, ReadError> {
    let incompatible = flags.get(8..16).unwrap_or_default();
    let [first, rest @ ..] = incompatible else {
        return Ok(Vec::new());
    };
    if first & !1 != 0 || rest.iter().any(|byte| *byte != 0) {
        return Err(ReadError::new(path, "uses a ULog of an unknown kind")
            .mend("its flags ask for a later reader"));
    }
    let offsets = flags.get(16..40).unwrap_or_default().chunks_exact(8);
    let offset = |bytes: &[u8]| bytes.first_chunk().map(|b| u64::from_le_bytes(*b));
    Ok(offsets.filter_map(offset).collect())
}
