//! MCAP: records of a kind and a length, messages in chunks that may be compressed, as ROS 2 (and
//! tools of ROS 1) record them. MCAP format specification, version 0.

use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::ros::{self, Container, Encoding, Event, Fields, MOST};
use super::{Entries, Stream, Wanted};
use crate::ReadError;
use crate::skipped::SkipKind;
use crate::source::Source;

/// Kinds of record.
mod op {
    pub(super) const FOOTER: u8 = 0x02;
    pub(super) const SCHEMA: u8 = 0x03;
    pub(super) const CHANNEL: u8 = 0x04;
    pub(super) const MESSAGE: u8 = 0x05;
    pub(super) const CHUNK: u8 = 0x06;
}

/// Whether a file that starts like this is MCAP, of whatever version.
pub(crate) fn detect(start: &[u8]) -> bool {
    start.starts_with(b"\x89MCAP")
}

pub(super) fn entries(path: &Path, source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    ros::entries(path, Box::new(Mcap::open(path, source)?), wanted)
}

pub(super) fn streams(path: &Path, source: Source) -> Result<Vec<Stream>, ReadError> {
    ros::streams(Box::new(Mcap::open(path, source)?))
}

struct Mcap {
    path: PathBuf,
    source: Source,
    /// A record as it is in the file.
    raw: Vec<u8>,
    /// The records of a chunk, or the content of a record outside of one.
    data: Vec<u8>,
    /// Where the next record of the chunk begins.
    at: usize,
    /// Why the chunk is not whole.
    damage: Option<(SkipKind, String)>,
    /// Names of the types by number.
    schemas: HashMap<u16, String>,
    ended: bool,
}

/// Why reading ends.
enum Stop {
    /// The file breaks off.
    Early(String),
    /// An unknown compression.
    Unknown(String),
}

impl Mcap {
    fn open(path: &Path, mut source: Source) -> Result<Self, ReadError> {
        let mut raw = Vec::new();
        // A file too short to be MCAP shows by what it starts with.
        let _ = ros::read(&mut source, ::mcap::MAGIC.len() as u64, &mut raw);
        if raw != ::mcap::MAGIC {
            return Err(ReadError::new(
                path,
                match detect(&raw) {
                    true => "MCAP of a version other than 0",
                    false => "not an MCAP file: it does not start with its magic bytes",
                },
            ));
        }
        Ok(Self {
            path: path.to_path_buf(),
            source,
            raw,
            data: Vec::new(),
            at: 0,
            damage: None,
            schemas: HashMap::new(),
            ended: false,
        })
    }

    /// The next record of the chunk. What does not fit into it ends the chunk.
    fn in_chunk(&mut self) -> Option<Event> {
        let rest = self.data.get(self.at..).unwrap_or_default();
        let mut fields = Fields::packed(rest);
        let mut record = || {
            let kind = fields.u8()?;
            let n = usize::try_from(fields.u64()?).ok()?;
            fields.take(n)?;
            let end = self.at + fields.at();
            Some((kind, end - n..end))
        };
        let Some((kind, range)) = record() else {
            self.at = self.data.len();
            self.damage.get_or_insert_with(|| {
                let detail = "a chunk with a record that does not fit into it";
                (SkipKind::Damaged, detail.to_owned())
            });
            return None;
        };
        self.at = range.end;
        self.event(kind, range)
    }

    /// What a schema, channel or message tells.
    fn event(&mut self, kind: u8, range: Range<usize>) -> Option<Event> {
        let content = self.data.get(range.clone()).unwrap_or_default();
        let mut fields = Fields::packed(content);
        let event = match kind {
            op::SCHEMA => schema(&mut fields).map(|(number, name)| {
                self.schemas.insert(number, name);
                None
            }),
            op::CHANNEL => channel(&mut fields, &self.schemas).map(Some),
            op::MESSAGE => message(&mut fields, range).map(Some),
            _ => Some(None),
        };
        event.unwrap_or_else(|| {
            let detail = format!("a record of kind {kind} that is too short");
            Some(Event::Skipped(SkipKind::Damaged, detail))
        })
    }

    /// The next record outside of chunks, the beginning of a chunk being one.
    fn outside(&mut self) -> Result<Option<Event>, Stop> {
        (self.data.clear(), self.at = 0);
        ros::read(&mut self.source, 9, &mut self.raw).map_err(Stop::Early)?;
        let mut fields = Fields::packed(&self.raw);
        let (Some(kind), Some(length)) = (fields.u8(), fields.u64()) else {
            return Ok(None);
        };
        let kept = matches!(kind, op::SCHEMA | op::CHANNEL | op::MESSAGE | op::CHUNK);
        if !kept || length > MOST {
            ros::skip(&mut self.source, length).map_err(Stop::Early)?;
            if kind == op::FOOTER {
                self.ended = true;
                // The magic bytes once more.
                let end = ros::read(&mut self.source, ::mcap::MAGIC.len() as u64, &mut self.raw);
                end.map_err(Stop::Early)?;
            }
            return Ok(kept.then(|| {
                let detail = format!("a record of {length} bytes");
                Event::Skipped(SkipKind::Damaged, detail)
            }));
        }
        if kind == op::CHUNK {
            let whole = ros::read(&mut self.source, length, &mut self.raw);
            self.chunk(whole)?;
            return Ok(None);
        }
        let whole = ros::read(&mut self.source, length, &mut self.data);
        self.at = self.data.len();
        whole.map_err(Stop::Early)?;
        Ok(self.event(kind, 0..self.data.len()))
    }

    /// Decompresses a chunk: all of it, checked, or what there is of it at the end of the file.
    fn chunk(&mut self, whole: Result<(), String>) -> Result<(), Stop> {
        let mut fields = Fields::packed(&self.raw);
        let mut head = || {
            // The times of the first and last message come first.
            fields.take(16)?;
            let size = fields.u64()?;
            let checksum = fields.u32()?;
            let method = fields.text()?.into_owned();
            let packed = usize::try_from(fields.u64()?).ok()?;
            let rest = self.raw.get(fields.at()..)?;
            Some((size, checksum, method, packed, rest))
        };
        let Some((size, checksum, method, packed, rest)) = head() else {
            let why = "a chunk too short to be one".to_owned();
            return match whole {
                Ok(()) => {
                    self.damage = Some((SkipKind::Damaged, why));
                    Ok(())
                }
                Err(why) => Err(Stop::Early(why)),
            };
        };
        let packed = rest.get(..packed).unwrap_or(rest);
        let unpacked = ros::decompress(&method, packed, size, &mut self.data);
        match (whole, unpacked) {
            (_, Err(None)) => return Err(Stop::Unknown(method)),
            (Err(why), _) => return Err(Stop::Early(why)),
            (Ok(()), Err(Some(why))) => {
                // What came before the damage may be wrong already.
                self.data.clear();
                self.damage = Some((SkipKind::Damaged, why));
            }
            (Ok(()), Ok(())) => {}
        }
        // Zero stands for none. Nothing of a chunk that fails it can be trusted.
        let mut crc = flate2::Crc::new();
        crc.update(&self.data);
        if self.damage.is_none() && checksum != 0 && crc.sum() != checksum {
            self.data.clear();
            let why = "a chunk whose checksum is wrong".to_owned();
            self.damage = Some((SkipKind::Damaged, why));
        }
        Ok(())
    }
}

/// The number and name of a type.
fn schema(fields: &mut Fields) -> Option<(u16, String)> {
    Some((fields.u16()?, fields.text()?.into_owned()))
}

fn channel(fields: &mut Fields, schemas: &HashMap<u16, String>) -> Option<Event> {
    let number = u32::from(fields.u16()?);
    let type_name = schemas.get(&fields.u16()?).cloned().unwrap_or_default();
    let name = fields.text()?.into_owned();
    let encoding = match &*fields.text()? {
        "ros1" => Some(Encoding::Ros1),
        "cdr" => Some(Encoding::Cdr),
        _ => None,
    };
    Some(Event::Topic {
        number,
        name,
        type_name,
        encoding,
    })
}

/// A message whose record is at `range`.
fn message(fields: &mut Fields, range: Range<usize>) -> Option<Event> {
    const SECOND: u64 = 1_000_000_000;
    let number = u32::from(fields.u16()?);
    let _sequence = fields.u32()?;
    let recorded = fields.u64()?;
    let _published = fields.u64()?;
    Some(Event::Message {
        number,
        // Both fit: a 64-bit number of nanoseconds has less than 2e10 seconds.
        time: ((recorded / SECOND) as i64, (recorded % SECOND) as u32),
        bytes: range.start + fields.at()..range.end,
    })
}

impl Container for Mcap {
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
                Err(Stop::Early(why)) => {
                    self.damage = Some((SkipKind::EndsEarly, why));
                    self.ended = true;
                }
                Err(Stop::Unknown(method)) => {
                    return Err(ReadError::new(
                        &self.path,
                        format!("a chunk is compressed by {method:?}"),
                    )
                    .mend("none, lz4 and zstd can be read"));
                }
            }
        }
    }

    fn bytes(&self, range: Range<usize>) -> &[u8] {
        self.data.get(range).unwrap_or_default()
    }
}
