//! The topics of a recording, and which of them is meant.

use std::collections::HashMap;

use super::container::Declared;
use super::message::{Encoding, Type, of_ros1};
use crate::entry::{Stream, StreamKind};
use crate::error::the_file_has;
use crate::{Key, ReadError};

/// A topic with messages of one type.
#[derive(Debug)]
pub(super) struct Topic {
    pub(super) name: String,
    /// Name of the type as ROS 1 writes it, `package/Type`.
    type_name: String,
    pub(super) kind: Option<Type>,
    /// Frame of the first message.
    pub(super) frame: Option<String>,
    /// Of poses, the frame that the first is of.
    pub(super) child: Option<String>,
    messages: u64,
}

impl Topic {
    pub(super) fn stream_kind(&self) -> StreamKind {
        self.kind.map_or(StreamKind::Other, Type::kind)
    }
}

/// All topics that a recording has named so far.
#[derive(Debug, Default)]
pub(super) struct Topics {
    list: Vec<Topic>,
    by_name: HashMap<(String, String), usize>,
    /// Several publishers of a topic have each a number of their own.
    by_number: HashMap<u32, (usize, Option<Encoding>)>,
}

impl Topics {
    /// Hears of a topic.
    pub(super) fn declare(&mut self, topic: Declared) {
        let Declared {
            number,
            name,
            type_name,
            encoding,
        } = topic;
        let type_name = of_ros1(&type_name);
        let key = (name, type_name);
        let index = match self.by_name.get(&key) {
            Some(&index) => index,
            None => {
                self.list.push(Topic {
                    kind: encoding.and_then(|_| Type::named(&key.1)),
                    name: key.0.clone(),
                    type_name: key.1.clone(),
                    frame: None,
                    child: None,
                    messages: 0,
                });
                self.by_name.insert(key, self.list.len() - 1);
                self.list.len() - 1
            }
        };
        self.by_number.insert(number, (index, encoding));
    }

    /// The topic of a message's number, and its place in the list.
    pub(super) fn topic(&self, number: u32) -> Option<(usize, &Topic)> {
        let &(index, _) = self.by_number.get(&number)?;
        Some((index, self.list.get(index)?))
    }

    /// Counts a message: the place of its topic in the list, the topic and the encoding.
    pub(super) fn count(&mut self, number: u32) -> Option<(usize, &mut Topic, Option<Encoding>)> {
        let &(index, encoding) = self.by_number.get(&number)?;
        let topic = self.list.get_mut(index)?;
        topic.messages += 1;
        Some((index, topic, encoding))
    }

    /// Counts a transform of a topic as a message of its pair of frames; the place of that in the list.
    pub(super) fn pair(&mut self, number: u32, frame: &str, child: &str) -> Option<usize> {
        let (_, topic) = self.topic(number)?;
        let name = format!("{}: {frame} -> {child}", topic.name);
        let key = (name, topic.type_name.clone());
        let index = self.by_name.get(&key).copied().unwrap_or_else(|| {
            self.list.push(Topic {
                name: key.0.clone(),
                type_name: key.1.clone(),
                kind: Some(Type::TransformStamped),
                frame: Some(frame.to_owned()),
                child: Some(child.to_owned()),
                messages: 0,
            });
            self.by_name.insert(key, self.list.len() - 1);
            self.list.len() - 1
        });
        self.list.get_mut(index)?.messages += 1;
        Some(index)
    }

    /// A topic by its place in the list.
    pub(super) fn at(&self, index: usize) -> Option<&Topic> {
        self.list.get(index)
    }

    /// The streams in the order of their names, pairs of frames last.
    pub(super) fn streams(mut self) -> Vec<Stream> {
        let is_pair = |topic: &Topic| topic.name.contains(" -> ");
        self.list
            .sort_by(|a, b| (is_pair(a), &a.name).cmp(&(is_pair(b), &b.name)));
        self.list.into_iter().map(stream).collect()
    }

    /// The names of topics, those of one kind if there are any.
    fn offer(&self, kind: StreamKind) -> String {
        /// A robot may have hundreds of topics.
        const MOST: usize = 12;
        let of_kind = |topic: &&Topic| topic.messages > 0 && topic.stream_kind() == kind;
        let mut names: Vec<String> = self
            .list
            .iter()
            .filter(of_kind)
            .map(|topic| topic.name.clone())
            .collect();
        if names.is_empty() {
            let with_type = |topic: &Topic| format!("{} ({})", topic.name, topic.type_name);
            names = self.list.iter().map(with_type).collect();
        }
        names.sort();
        names.dedup();
        match names.is_empty() {
            true => "the file has no topics".to_owned(),
            false => the_file_has(&names, MOST),
        }
    }
}

fn stream(topic: Topic) -> Stream {
    let note = match topic.kind {
        Some(Type::Imu) => "; by REP-103 x is forward, y left, z up",
        Some(Type::TwistStamped | Type::TwistWithCovarianceStamped) => "; taken as east, north, up",
        Some(kind) if kind.kind() == StreamKind::LocalPoses => "; poses in a local frame",
        _ => "",
    };
    let frame = match topic.frame.as_deref() {
        Some("") => ", no frame".to_owned(),
        Some(frame) => format!(", frame {frame}"),
        None => String::new(),
    };
    let child = topic.child.iter().map(|child| format!(" to {child}"));
    let frame = frame + &child.collect::<String>();
    Stream {
        kind: topic.stream_kind(),
        about: format!("{}{frame}{note}", topic.type_name),
        name: topic.name,
        messages: topic.messages,
    }
}

/// Which topic of a kind is meant: the one of a name, or the only one that has messages.
#[derive(Debug)]
pub(super) struct Choice {
    /// The key that names it.
    key: Key,
    kind: StreamKind,
    named: Option<String>,
    taken: Option<usize>,
    several: bool,
}

impl Choice {
    pub(super) fn new(key: Key, kind: StreamKind, named: &Option<String>) -> Self {
        Self {
            key,
            kind,
            named: named.clone(),
            taken: None,
            several: false,
        }
    }

    pub(super) fn kind(&self) -> StreamKind {
        self.kind
    }

    /// Whether a transform of a pair of frames is meant: only by its name, since many robots have some beside other poses.
    pub(super) fn takes_pair(&mut self, index: usize, pair: &Topic) -> bool {
        self.is_named() && self.takes(index, pair)
    }

    pub(super) fn is_named(&self) -> bool {
        self.named.is_some()
    }

    /// Whether a message of it has come.
    pub(super) fn is_found(&self) -> bool {
        self.taken.is_some()
    }

    /// Whether a message of a topic is meant.
    pub(super) fn takes(&mut self, index: usize, topic: &Topic) -> bool {
        if topic.stream_kind() != self.kind {
            return false;
        }
        if let Some(named) = &self.named {
            let meant = *named == topic.name;
            if meant {
                self.taken = Some(index);
            }
            return meant;
        }
        let only = *self.taken.get_or_insert(index) == index;
        self.several |= !only;
        only
    }

    /// Whether there is more than one and none is named: nothing else needs to be read.
    pub(super) fn is_ambiguous(&self) -> bool {
        self.several
    }

    /// What there is to say at the end of the file.
    ///
    /// # Errors
    /// If several topics could be meant, or none was there that has to be.
    pub(super) fn verdict(&self, topics: &Topics, required: bool) -> Result<(), ReadError> {
        let what = match self.kind {
            StreamKind::Imu => "of sensor_msgs/Imu",
            StreamKind::Fixes => "of sensor_msgs/NavSatFix",
            StreamKind::Fields => "of sensor_msgs/MagneticField",
            StreamKind::LocalPoses => {
                "of nav_msgs/Odometry, geometry_msgs/PoseStamped, TransformStamped or tf2_msgs/TFMessage"
            }
            _ => "of geometry_msgs/TwistStamped",
        };
        let problem = match (&self.named, self.taken) {
            _ if self.several => format!("more than one topic {what}"),
            (Some(name), None) => format!("no messages {what} on topic {name}"),
            (None, None) if required => format!("no messages {what}"),
            _ => return Ok(()),
        };
        Err(ReadError::nameless(problem)
            .key(self.key.clone())
            .mend(topics.offer(self.kind)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn publishers_of_one_topic_are_one_topic() {
        let mut topics = Topics::default();
        for (number, name, type_name) in [
            (4, "/imu", "sensor_msgs/Imu"),
            (7, "/imu", "sensor_msgs/msg/Imu"),
            (8, "/imu2", "sensor_msgs/Imu"),
        ] {
            topics.declare(Declared {
                number,
                name: name.to_owned(),
                type_name: type_name.to_owned(),
                encoding: Some(Encoding::Ros1),
            });
        }
        let mut choice = Choice::new(Key::Topic("imu"), StreamKind::Imu, &None);
        for number in [4, 7] {
            let (index, topic, _) = topics.count(number).unwrap();
            assert!(choice.takes(index, topic));
        }
        // A topic that is declared but has no messages is not in the way.
        assert!(choice.verdict(&topics, true).is_ok());
        let (index, topic, _) = topics.count(8).unwrap();
        assert!(!choice.takes(index, topic) && choice.is_ambiguous());
        assert!(topics.count(9).is_none());
        let messages: Vec<u64> = topics.streams().iter().map(|s| s.messages).collect();
        assert_eq!(messages, [2, 1]);
    }
}
