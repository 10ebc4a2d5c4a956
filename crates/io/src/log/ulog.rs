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
mod subscriptions;
#[cfg(test)]
mod tests;
mod topics;

use std::collections::HashMap;

use self::messages::{MAGIC, Messages, Step};
use self::reader::Reader;
use self::subscriptions::{appended, data, listing, named, subscription, topic_of};
use crate::ReadError;
use crate::entry::{Entries, Stream, StreamKind, Wanted};
use crate::source::{Again, Source};

/// Whether a file that starts so is a ULog.
pub(crate) fn detect(start: &[u8]) -> bool {
    start.starts_with(&MAGIC)
}

pub(super) fn entries(source: Source, again: Again, wanted: &Wanted) -> Result<Entries, ReadError> {
    let (name, kind, key) = match wanted {
        Wanted::Imu(name) => (name, StreamKind::Imu, "imu.topic"),
        Wanted::Fixes {
            position, velocity, ..
        } => {
            let mut both = position.iter().zip(velocity.iter());
            if both.any(|(position, velocity)| named(position) != named(velocity)) {
                return Err(
                    ReadError::nameless("positions and velocities are one topic")
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
            let there = streams(again()?)?;
            choose(&there, kind).ok_or_else(|| nothing(key, &there))?
        }
    };
    let topic = topic_of(&wanted);
    if topics::kind_of(topic).0 != kind {
        let problem = format!("{wanted} is {}", topics::about(topic));
        let there = streams(again()?)?;
        return Err(ReadError::nameless(problem).key(key).mend(listing(&there)));
    }
    let messages = Messages::open(source)?;
    let poses = kind == StreamKind::Poses;
    Ok(Box::new(Reader::new(messages, wanted, key, poses)))
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    let mut messages = Messages::open(source)?;
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
                let offsets = appended(body)?;
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

/// The stream that is meant where none is named.
fn choose(there: &[Stream], kind: StreamKind) -> Option<String> {
    let of_kind = || there.iter().filter(|s| s.kind == kind && s.messages > 0);
    let most = of_kind().map(|stream| stream.messages).max()?;
    of_kind()
        .filter(|stream| stream.messages >= most.div_ceil(2))
        .min_by_key(|stream| (topics::kind_of(topic_of(&stream.name)).1, &stream.name))
        .map(|stream| stream.name.clone())
}

fn nothing(key: &str, there: &[Stream]) -> ReadError {
    let topics = match key {
        "imu.topic" => "vehicle_imu or sensor_combined",
        "gnss.topic" => "vehicle_gps_position or sensor_gps",
        _ => "vehicle_global_position",
    };
    ReadError::nameless(format!("no {topics}"))
        .key(key)
        .mend(listing(there))
}
