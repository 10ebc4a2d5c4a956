//! Transforms of tf2_msgs/TFMessage, of which each message has several: each pair of frames is a stream of its own, `/tf: odom -> base_link`.

use std::ops::Range;

use super::Recording;
use super::message::{self, Encoding, Header, Type};
use super::topics::Topics;
use crate::entry::{LocalPose, StreamKind, What};
use crate::epoch::ClockSource;
use crate::log::receiver::Ready;
use crate::skipped::{SkipKind, Unfit};

/// One of them: its header, the frame that is posed, and its pose at time 0.
type Transform<'a> = (Header<'a>, String, Result<LocalPose, Unfit>);

/// The transforms of a message; `None` of one that is cut.
fn of_message(encoding: Encoding, bytes: &[u8]) -> Option<Vec<Transform<'_>>> {
    let mut fields = message::fields(encoding, bytes)?;
    let count = fields.u32()?;
    let mut transforms = Vec::new();
    for _ in 0..count {
        let header = message::header_of(encoding, &mut fields)?;
        let child = message::child(Type::TransformStamped, &mut fields)?.into_owned();
        let pose = message::pose(0.0, Type::TransformStamped, &mut fields);
        if matches!(pose, Err((SkipKind::MissingField, _))) {
            return None;
        }
        transforms.push((header, child, pose));
    }
    Some(transforms)
}

/// Counts the transforms of a message as messages of their pairs.
pub(super) fn count(topics: &mut Topics, number: u32, encoding: Encoding, bytes: &[u8]) {
    for (header, child, _) in of_message(encoding, bytes).into_iter().flatten() {
        topics.pair(number, &header.frame, &child);
    }
}

impl Recording {
    /// Takes a message of transforms; false of any other.
    pub(super) fn of_transforms(
        &mut self,
        number: u32,
        recorded: (i64, u32),
        range: Range<usize>,
        ready: &mut Ready,
    ) -> bool {
        let topic = self.topics.topic(number);
        if !topic.is_some_and(|(_, topic)| topic.kind == Some(Type::Transforms)) {
            return false;
        }
        let Some((.., Some(encoding))) = self.topics.count(number) else {
            return true;
        };
        if self.wanted.main.kind() != StreamKind::LocalPoses {
            return true;
        }
        let at = self.messages;
        let Some(transforms) = of_message(encoding, self.events.bytes(range)) else {
            if self.wanted.main.is_named() {
                ready.push(at, What::from_read(Err(message::too_short())));
            }
            return true;
        };
        for (header, child, pose) in transforms {
            let index = self.topics.pair(number, &header.frame, &child);
            let Some(topic) = index.and_then(|index| Some((index, self.topics.at(index)?))) else {
                continue;
            };
            if !self.wanted.main.takes_pair(topic.0, topic.1) {
                continue;
            }
            let ((seconds, nanoseconds), clock) = match header.stamp {
                (0, 0) => (recorded, ClockSource::Receipt),
                stamp => (stamp, ClockSource::Host),
            };
            let time = self.weeks.unix(seconds, nanoseconds.min(999_999_999));
            self.clock.get_or_insert(clock);
            let pose = pose.map(|pose| What::LocalPose(LocalPose { time, ..pose }));
            ready.push(at, What::from_read(pose));
        }
        true
    }
}
