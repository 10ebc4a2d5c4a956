//! ROS 1 bags, format 2.0: records with a header of named fields and data, messages in chunks that
//! may be compressed. ROS wiki, Bags/Format/2.0.

use std::ops::Range;

use super::bytes::ByteFields;
use super::ros::{self, Container, Declared, Encoding, Event, File, Packed, Records, Stop};
use crate::ReadError;
use crate::entry::{Entries, Stream, Wanted};
use crate::source::Source;

/// Kinds of record.
mod op {
    pub(super) const MESSAGE: u8 = 0x02;
    pub(super) const BAG: u8 = 0x03;
    pub(super) const CHUNK: u8 = 0x05;
    pub(super) const CHUNK_INFO: u8 = 0x06;
    pub(super) const CONNECTION: u8 = 0x07;
}

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";
/// Headers have tens of bytes; those of connections have the definition of a message \[bytes\].
const LONGEST_HEADER: u32 = 1 << 20;

/// Whether a file that starts like this is a bag, of whatever version.
pub(crate) fn detect(start: &[u8]) -> bool {
    start.starts_with(b"#ROSBAG V")
}

pub(super) fn entries(source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    ros::entries(open(source)?, wanted)
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    ros::streams(open(source)?)
}

/// The fields of a record's header that are of interest.
#[derive(Debug, Default)]
struct Header {
    op: u8,
    /// Number of the connection.
    conn: u32,
    time: (i64, u32),
    topic: String,
    compression: String,
    /// Of a chunk, decompressed \[bytes\].
    size: u32,
    /// Where the index begins; 0 while recording.
    index_pos: u64,
    chunk_count: u32,
    encryptor: String,
}

impl Header {
    /// Fields are a length and `name=value`.
    fn parse(bytes: &[u8]) -> Option<Self> {
        let mut header = Self::default();
        let mut fields = ByteFields::packed(bytes);
        while fields.at() < bytes.len() {
            let field = fields.block()?;
            let equals = memchr::memchr(b'=', field)?;
            let (name, value) = (field.get(..equals)?, field.get(equals + 1..)?);
            let mut number = ByteFields::packed(value);
            let text = || String::from_utf8_lossy(value).into_owned();
            match name {
                b"op" => header.op = number.u8()?,
                b"conn" => header.conn = number.u32()?,
                b"time" => header.time = (i64::from(number.u32()?), number.u32()?),
                b"topic" => header.topic = text(),
                b"compression" => header.compression = text(),
                b"size" => header.size = number.u32()?,
                b"index_pos" => header.index_pos = number.u64()?,
                b"chunk_count" => header.chunk_count = number.u32()?,
                b"encryptor" => header.encryptor = text(),
                _ => {}
            }
        }
        Some(header)
    }
}

/// The type that a connection's own header names.
fn type_of(bytes: &[u8]) -> Option<String> {
    let mut fields = ByteFields::packed(bytes);
    while fields.at() < bytes.len() {
        if let Some(name) = fields.block()?.strip_prefix(b"type=") {
            return Some(String::from_utf8_lossy(name).into_owned());
        }
    }
    None
}

#[derive(Default)]
struct Bag {
    /// Whether there is an index at the end, and of how many more chunks it has to tell.
    index: Option<u32>,
}

fn open(source: Source) -> Result<Container, ReadError> {
    let bag = Container::open(source, MAGIC, Bag::default());
    bag.map_err(|start| match detect(&start) {
        true => ReadError::nameless("a bag of a version other than 2.0")
            .mend("convert it by: rosbag fix"),
        false => ReadError::nameless("not a ROS bag: it does not start with #ROSBAG V2.0"),
    })
}

/// Contents of a message or connection whose data are a part of `bytes`.
fn event(header: Header, bytes: &[u8], range: Range<usize>) -> Option<Event> {
    match header.op {
        op::MESSAGE => Some(Event::Message {
            number: header.conn,
            time: header.time,
            bytes: range,
        }),
        op::CONNECTION => Some(Event::Topic(Declared {
            number: header.conn,
            name: header.topic,
            type_name: type_of(bytes.get(range)?).unwrap_or_default(),
            encoding: Some(Encoding::Ros1),
        })),
        _ => None,
    }
}

/// A length; a record begins with one and has another before its data.
fn length(file: &mut File) -> Result<u32, Stop> {
    let four = ByteFields::packed(file.header(4)?).u32();
    four.ok_or_else(|| Stop::Early(String::new()))
}

impl Bag {
    /// Keeps in mind what the bag's header and its index tell.
    fn note(&mut self, header: &Header) -> Result<(), Stop> {
        match (header.op, &mut self.index) {
            (op::BAG, _) if !header.encryptor.is_empty() => return Err(Stop::Encrypted),
            (op::BAG, index) => *index = (header.index_pos > 0).then_some(header.chunk_count),
            (op::CHUNK_INFO, Some(chunks)) => *chunks = chunks.saturating_sub(1),
            _ => {}
        }
        Ok(())
    }
}

impl Records for Bag {
    fn methods(&self) -> &'static str {
        "none, bz2 and lz4"
    }

    fn inside(&mut self, chunk: &[u8], at: usize) -> Option<(Option<Event>, usize)> {
        let mut fields = ByteFields::packed(chunk.get(at..)?);
        let header = Header::parse(fields.block()?)?;
        let n = fields.block()?.len();
        let end = at + fields.at();
        Some((event(header, chunk, end - n..end), end))
    }

    fn outside(&mut self, file: &mut File) -> Result<Option<Event>, Stop> {
        if file.at_end() {
            file.end();
            return match self.index {
                Some(0) => Ok(None),
                _ => Err(Stop::Early(
                    "the index at the end of the bag is missing".to_owned(),
                )),
            };
        }
        let n = length(file)?;
        if n > LONGEST_HEADER {
            return Err(Stop::Early(format!("damaged: a header of {n} bytes")));
        }
        let header = Header::parse(file.header(u64::from(n))?)
            .ok_or_else(|| Stop::Early("damaged: an invalid header".to_owned()))?;
        let n = u64::from(length(file)?);
        if !matches!(header.op, op::MESSAGE | op::CHUNK | op::CONNECTION) {
            self.note(&header)?;
            file.skip(n)?;
            return Ok(None);
        }
        if let Some(skipped) = file.too_large(n)? {
            return Ok(Some(skipped));
        }
        if header.op == op::CHUNK {
            let packed = |data: &[u8]| {
                Some(Packed {
                    method: header.compression,
                    bytes: 0..data.len(),
                    size: u64::from(header.size),
                    checksum: None,
                })
            };
            file.chunk(n, packed)?;
            return Ok(None);
        }
        let content = file.content(n)?;
        Ok(event(header, content, 0..content.len()))
    }
}
