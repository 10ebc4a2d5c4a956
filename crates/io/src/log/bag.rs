//! ROS 1 bags, format 2.0: records with a header of named fields and data, messages in chunks that
//! may be compressed. ROS wiki, Bags/Format/2.0.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::ros::{self, Container, Encoding, Event, Fields, MOST};
use super::{Entries, Stream, Wanted};
use crate::ReadError;
use crate::skipped::SkipKind;
use crate::source::Source;

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";
/// Headers have tens of bytes; those of connections have the definition of a message [bytes].
const LONGEST_HEADER: u32 = 1 << 20;

/// Whether a file that starts like this is a bag, of whatever version.
pub(crate) fn detect(start: &[u8]) -> bool {
    start.starts_with(b"#ROSBAG V")
}

pub(super) fn entries(path: &Path, source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    ros::entries(path, Box::new(Bag::open(path, source)?), wanted)
}

pub(super) fn streams(path: &Path, source: Source) -> Result<Vec<Stream>, ReadError> {
    ros::streams(Box::new(Bag::open(path, source)?))
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
    /// Of a chunk, decompressed [bytes].
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
        let mut fields = Fields::packed(bytes);
        while fields.at() < bytes.len() {
            let field = fields.block()?;
            let equals = memchr::memchr(b'=', field)?;
            let (name, value) = (field.get(..equals)?, field.get(equals + 1..)?);
            let mut number = Fields::packed(value);
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
    let mut fields = Fields::packed(bytes);
    while fields.at() < bytes.len() {
        if let Some(name) = fields.block()?.strip_prefix(b"type=") {
            return Some(String::from_utf8_lossy(name).into_owned());
        }
    }
    None
}

struct Bag {
    path: PathBuf,
    source: Source,
    /// A header, or a chunk as it is in the file.
    raw: Vec<u8>,
    /// The records of a chunk, or the data of a record outside of one.
    data: Vec<u8>,
    /// Where the next record of the chunk begins.
    at: usize,
    /// Why the chunk is not whole.
    damage: Option<(SkipKind, String)>,
    /// Whether there is an index at the end, and how many chunks it will tell of.
    index: Option<u32>,
    ended: bool,
}

impl Bag {
    fn open(path: &Path, mut source: Source) -> Result<Self, ReadError> {
        let mut raw = Vec::new();
        // A file too short to be a bag shows by what it starts with.
        let _ = ros::read(&mut source, MAGIC.len() as u64, &mut raw);
        if raw != MAGIC {
            return Err(match detect(&raw) {
                true => ReadError::new(path, "a bag of a version other than 2.0")
                    .mend("convert it by: rosbag fix"),
                false => ReadError::new(path, "not a ROS bag: it does not start with #ROSBAG V2.0"),
            });
        }
        Ok(Self {
            path: path.to_path_buf(),
            source,
            raw,
            data: Vec::new(),
            at: 0,
            damage: None,
            index: None,
            ended: false,
        })
    }

    /// Ends the file; what is left of the chunk is read first.
    fn breaks_off(&mut self, why: String) {
        self.damage = Some((SkipKind::EndsEarly, why));
        self.ended = true;
    }

    /// The next record of the chunk. What does not fit into it ends the chunk.
    fn in_chunk(&mut self) -> Option<Event> {
        let rest = self.data.get(self.at..).unwrap_or_default();
        let mut fields = Fields::packed(rest);
        let mut record = || {
            let header = Header::parse(fields.block()?)?;
            let n = fields.block()?.len();
            let end = self.at + fields.at();
            Some((header, end - n..end))
        };
        let Some((header, range)) = record() else {
            self.at = self.data.len();
            self.damage.get_or_insert_with(|| {
                let detail = "a chunk with a record that does not fit into it";
                (SkipKind::Damaged, detail.to_owned())
            });
            return None;
        };
        self.at = range.end;
        self.event(header, range)
    }

    /// What a message or connection tells.
    fn event(&self, header: Header, range: Range<usize>) -> Option<Event> {
        match header.op {
            0x02 => Some(Event::Message {
                number: header.conn,
                time: header.time,
                bytes: range,
            }),
            0x07 => Some(Event::Topic {
                number: header.conn,
                name: header.topic,
                type_name: type_of(self.bytes(range)).unwrap_or_default(),
                encoding: Some(Encoding::Ros1),
            }),
            _ => None,
        }
    }

    /// The next record outside of chunks, the beginning of a chunk being one.
    ///
    /// # Errors
    /// What breaks off the file, and which error that is.
    fn outside(&mut self) -> Result<Option<Event>, Stop> {
        (self.data.clear(), self.at = 0);
        if ros::at_end(&mut self.source) {
            self.ended = true;
            return match self.index {
                Some(0) => Ok(None),
                _ => Err(Stop::Early(
                    "without the index that closes a bag".to_owned(),
                )),
            };
        }
        let length = self.length()?;
        if length > LONGEST_HEADER {
            return Err(Stop::Early(format!("damaged: a header of {length} bytes")));
        }
        ros::read(&mut self.source, u64::from(length), &mut self.raw).map_err(Stop::Early)?;
        let Some(header) = Header::parse(&self.raw) else {
            return Err(Stop::Early("damaged: no record's header".to_owned()));
        };
        let length = u64::from(self.length()?);
        let kept = matches!(header.op, 0x02 | 0x05 | 0x07);
        if !kept || length > MOST {
            self.note(&header)?;
            ros::skip(&mut self.source, length).map_err(Stop::Early)?;
            return Ok(kept.then(|| {
                let detail = format!("a record of {length} bytes");
                Event::Skipped(SkipKind::Damaged, detail)
            }));
        }
        if header.op != 0x05 {
            let whole = ros::read(&mut self.source, length, &mut self.data);
            self.at = self.data.len();
            whole.map_err(Stop::Early)?;
            return Ok(self.event(header, 0..self.data.len()));
        }
        let whole = ros::read(&mut self.source, length, &mut self.raw);
        let size = u64::from(header.size);
        let unpacked = ros::decompress(&header.compression, &self.raw, size, &mut self.data);
        match (whole, unpacked) {
            (_, Err(None)) => return Err(Stop::Unknown(header.compression)),
            (Err(why), _) => return Err(Stop::Early(why)),
            (Ok(()), Err(Some(why))) => {
                // What came before the damage may be wrong already.
                self.data.clear();
                self.damage = Some((SkipKind::Damaged, why));
            }
            (Ok(()), Ok(())) => {}
        }
        Ok(None)
    }

    /// A length; the records of the file begin and go on with one.
    fn length(&mut self) -> Result<u32, Stop> {
        let mut four = Vec::with_capacity(4);
        ros::read(&mut self.source, 4, &mut four).map_err(Stop::Early)?;
        Fields::packed(&four)
            .u32()
            .ok_or_else(|| Stop::Early(String::new()))
    }

    /// Keeps in mind what the bag's header and its index tell.
    fn note(&mut self, header: &Header) -> Result<(), Stop> {
        match (header.op, self.index) {
            (0x03, _) if !header.encryptor.is_empty() => Err(Stop::Encrypted),
            (0x03, _) => {
                self.index = (header.index_pos > 0).then_some(header.chunk_count);
                Ok(())
            }
            (0x06, Some(chunks)) => {
                self.index = Some(chunks.saturating_sub(1));
                Ok(())
            }
            _ => Ok(()),
        }
    }
}

/// Why reading ends.
enum Stop {
    /// The file breaks off.
    Early(String),
    /// An unknown compression.
    Unknown(String),
    Encrypted,
}

impl Container for Bag {
    fn next(&mut self) -> Result<Option<Event>, ReadError> {
        loop {
            if self.at < self.data.len() {
                match self.in_chunk() {
                    Some(event) => return Ok(Some(event)),
                    None => continue,
                }
            }
            if let Some((kind, detail)) = self.damage.take() {
                return Ok(Some(Event::Skipped(kind, detail)));
            }
            if self.ended {
                return Ok(None);
            }
            match self.outside() {
                Ok(Some(event)) => return Ok(Some(event)),
                Ok(None) => {}
                Err(Stop::Early(why)) => self.breaks_off(why),
                Err(Stop::Unknown(method)) => {
                    return Err(ReadError::new(
                        &self.path,
                        format!("a chunk is compressed by {method:?}"),
                    )
                    .mend("none, bz2 and lz4 can be read"));
                }
                Err(Stop::Encrypted) => {
                    return Err(ReadError::new(&self.path, "the bag is encrypted"));
                }
            }
        }
    }

    fn bytes(&self, range: Range<usize>) -> &[u8] {
        self.data.get(range).unwrap_or_default()
    }
}
