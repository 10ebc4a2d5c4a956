//! PX4 ULog: the format is that of PX4's developer documentation, "ULog File Format", version 1.
//!
//! Streams are topics with their instance, such as `vehicle_imu.0`; a name without a number is
//! instance 0.
//!
//! * Inertial samples: `vehicle_imu` has increments over intervals that it states, `sensor_combined`
//!   mean rates; both are forward-right-down. PX4 often logs `vehicle_imu` thinned, a short interval
//!   now and then: that gives no rates in between and is refused.
//! * Fixes: `vehicle_gps_position`, `sensor_gps`. Fix types 3 (single), 4 (differential), 5 (float)
//!   and 6 (fixed) are read. `eph` is taken for the standard deviation of north and of east each,
//!   `epv` for that of the height, `s_variance_m_s`, which is a standard deviation in spite of its name, for that of each component of
//!   the velocity; zero or not finite is unknown. The height is that above the ellipsoid where it is
//!   set, that is not 0, else that above mean sea level.
//! * Magnetic fields: `vehicle_magnetometer`, `sensor_mag`, in gauss.
//! * Positions: `vehicle_global_position` with the velocity of the `vehicle_local_position` before it
//!   that has the same time.
//!
//! Without a name, the stream of the kind that comes first in this order is taken: `vehicle_imu`,
//! `sensor_combined`; `vehicle_magnetometer`, `sensor_mag`; `vehicle_gps_position`, `sensor_gps`; the simulator's ground truth,
//! `vehicle_global_position`; lower instances first, but none that has less than half as many
//! messages as another. To find it, the file is read once more before.
//!
//! Times are seconds since the start of the system: `timestamp_sample` where it is set, else
//! `timestamp`. A fix without `timestamp_sample` has the time at which it arrived, some 0.1 s after
//! its validity; the log does not tell how much. The date of time zero is that of the receiver's
//! `time_utc_usec`.

mod date;
mod layout;
mod messages;
mod reader;
mod subscriptions;
#[cfg(test)]
mod tests;
mod topics;

use std::collections::HashMap;

use self::messages::{MAGIC, Messages, NextMessage};
use self::reader::Reader;
use self::subscriptions::{appended, data, named, subscription, topic_of};
use super::receiver::by_steps;
use crate::entry::{Entries, Stream, StreamKind, Wanted};
use crate::error::{NAMES_SHOWN, the_file_has};
use crate::source::{Again, Source};
use crate::{Key, ReadError};

/// Whether a file that starts so is a ULog.
pub(crate) fn detect(start: &[u8]) -> bool {
    start.starts_with(&MAGIC)
}

pub(super) fn entries(source: Source, again: Again, wanted: &Wanted) -> Result<Entries, ReadError> {
    let (name, kind, key) = wanted.one_stream()?;
    let stream = match name {
        Some(name) => named(name),
        None => {
            let there = streams(again()?)?;
            choose(&there, kind).ok_or_else(|| nothing(&key, &there))?
        }
    };
    let topic = topic_of(&stream);
    if topics::kind_of(topic).0 != kind {
        let problem = format!("{stream} is {}", topics::about(topic));
        let there = listing(&streams(again()?)?);
        return Err(ReadError::nameless(problem).key(key).mend(there));
    }
    let poses = kind == StreamKind::Poses;
    let mut reader = Reader::new(Messages::open(source)?, stream, key, poses);
    let epoch = date::epoch(again()?);
    Ok(by_steps(wanted, move |ready| {
        Ok((reader.step(ready)?, epoch))
    }))
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    let mut messages = Messages::open(source)?;
    let mut topics: Vec<(String, u64)> = Vec::new();
    let mut ids: HashMap<u16, usize> = HashMap::new();
    loop {
        let kind = match messages.step() {
            NextMessage::End(_) => break,
            NextMessage::Damaged(_) => continue,
            NextMessage::Message(kind) => kind,
        };
        let body = messages.body();
        match kind {
            b'A' => {
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
            b'B' => {
                let offsets = appended(body)?;
                messages.set_appended(offsets.into_iter());
            }
            b'D' => {
                let index = data(body).and_then(|(id, _)| ids.get(&id));
                if let Some((_, count)) = index.and_then(|index| topics.get_mut(*index)) {
                    *count += 1;
                }
            }
            _ => {}
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

fn nothing(key: &Key, there: &[Stream]) -> ReadError {
    let topics = match key {
        Key::Topic("imu") => "vehicle_imu or sensor_combined",
        Key::Topic("gnss") => "vehicle_gps_position or sensor_gps",
        Key::Topic("magnetometer") => "vehicle_magnetometer or sensor_mag",
        _ => "vehicle_global_position",
    };
    ReadError::nameless(format!("no {topics}"))
        .key(key.clone())
        .mend(listing(there))
}

fn listing(there: &[Stream]) -> String {
    let names: Vec<&str> = there.iter().map(|stream| stream.name.as_str()).collect();
    the_file_has(&names, NAMES_SHOWN)
}
