//! Messages of ROS 2 as MCAP while they come: records outside of chunks, so that a reader has each as soon as it is there.

use super::container::{Fields, channel, schema};
use crate::mcap_records::{MAGIC, op};

/// A stream of messages.
#[derive(Debug, Default)]
pub struct Stream {
    channels: u16,
}

impl Stream {
    /// What the stream begins with.
    pub fn head() -> Vec<u8> {
        let library = concat!("undrift ", env!("CARGO_PKG_VERSION"));
        let header = Fields::default()
            .text("ros2")
            .text(library)
            .record(op::HEADER);
        [&MAGIC[..], &header].concat()
    }

    /// Adds a topic of messages of a type, `sensor_msgs/msg/Imu`: its number, and the records that declare it.
    pub fn topic(&mut self, topic: &str, type_name: &str) -> (u16, Vec<u8>) {
        let number = self.channels;
        self.channels += 1;
        // Zero means no schema.
        let schema_number = number + 1;
        let mut records = schema(schema_number, type_name, "");
        records.extend(channel(number, schema_number, topic, "cdr"));
        (number, records)
    }

    /// The record of a message, with its encapsulation, that came at a Unix time \[ns\].
    pub fn message(number: u16, time: u64, content: &[u8]) -> Vec<u8> {
        Fields::default()
            .u16(number)
            .u32(0)
            .u64(time)
            .u64(time)
            .bytes(content)
            .record(op::MESSAGE)
    }
}

/// Longest record outside of chunks that is kept \[bytes\]; and the most of declarations.
const MOST: usize = 16 << 20;
const MOST_DECLARED: usize = 64 << 10;
/// Kind and length.
const HEAD: usize = 9;

/// What a reader needs that begins in the middle of a stream: its magic bytes and the channels outside of chunks.
#[derive(Debug, Default)]
pub struct Declarations {
    head: Vec<u8>,
    /// The record that has begun, as far as it has come.
    record: Vec<u8>,
}

impl Declarations {
    /// Takes the next bytes of the stream.
    pub fn add(&mut self, mut bytes: &[u8]) {
        while !bytes.is_empty() {
            let is_begun = self.head.len() >= MAGIC.len();
            let part = match is_begun {
                true => &mut self.record,
                false => &mut self.head,
            };
            let whole = match (is_begun, part.first_chunk::<HEAD>()) {
                (false, _) => MAGIC.len(),
                (true, None) => HEAD,
                (true, Some([_, length @ ..])) => {
                    let length = usize::try_from(u64::from_le_bytes(*length));
                    HEAD.saturating_add(length.unwrap_or(usize::MAX))
                }
            };
            let missing = whole.saturating_sub(part.len()).min(bytes.len());
            let (now, rest) = bytes.split_at(missing);
            part.extend(now);
            bytes = rest;
            self.end_of_record();
        }
    }

    /// Keeps a record that is whole if it declares something.
    fn end_of_record(&mut self) {
        let Some([kind, length @ ..]) = self.record.first_chunk::<HEAD>() else {
            return;
        };
        let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
        if length > MOST {
            // No reader begins again in it: what follows is taken for its end.
            self.record.truncate(0);
        } else if self.record.len() >= HEAD + length {
            let declares = matches!(*kind, op::SCHEMA | op::CHANNEL);
            if declares && self.head.len() + self.record.len() <= MOST_DECLARED {
                self.head.append(&mut self.record);
            }
            self.record.clear();
        }
    }

    /// What a reader is given first: what was declared, and the record that has begun.
    pub fn again(&self) -> Vec<u8> {
        [&self.head[..], &self.record].concat()
    }
}
