//! MCAP: records of a kind and a length, messages in chunks that may be compressed, as ROS 2 (and
//! tools of ROS 1) record them. MCAP format specification, version 0.

use std::collections::HashMap;
use std::ops::Range;

use super::bytes::ByteFields;
use super::ros::{self, Container, Declared, Encoding, Event, File, Packed, Records, Stop};
use crate::ReadError;
use crate::entry::{Entries, Stream, Wanted};
use crate::mcap_records::{MAGIC, op};
use crate::skipped::SkipKind;
use crate::source::Source;

/// Whether a file that starts like this is MCAP, of whatever version.
pub(crate) fn detect(start: &[u8]) -> bool {
    start.starts_with(b"\x89MCAP")
}

pub(super) fn entries(source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    ros::entries(open(source)?, wanted)
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    ros::streams(open(source)?)
}

#[derive(Default)]
struct Mcap {
    /// Names of the types by number.
    schemas: HashMap<u16, String>,
}

pub(crate) fn open(source: Source) -> Result<Container, ReadError> {
    let mcap = Container::open(source, &MAGIC, Mcap::default());
    mcap.map_err(|start| {
        let problem = match detect(&start) {
            true => "MCAP of a version other than 0",
            false => "not an MCAP file: it does not start with its magic bytes",
        };
        ReadError::nameless(problem)
    })
}

impl Mcap {
    /// What is in a schema, channel or message whose content is a part of `bytes`.
    fn event(&mut self, kind: u8, bytes: &[u8], range: Range<usize>) -> Option<Event> {
        let content = bytes.get(range.clone()).unwrap_or_default();
        let mut fields = ByteFields::packed(content);
        let event = match kind {
            op::SCHEMA => fields.u16().zip(fields.text()).map(|(number, name)| {
                self.schemas.insert(number, name.into_owned());
                None
            }),
            op::CHANNEL => channel(&mut fields, &self.schemas).map(Some),
            op::MESSAGE => message(&mut fields, &range).map(Some),
            _ => Some(None),
        };
        event.unwrap_or_else(|| {
            let detail = format!("a record of kind {kind} that is too short");
            Some(Event::Skipped(SkipKind::Damaged, detail))
        })
    }
}

impl Records for Mcap {
    fn methods(&self) -> &'static str {
        "none, lz4 and zstd"
    }

    fn inside(&mut self, chunk: &[u8], at: usize) -> Option<(Option<Event>, usize)> {
        let mut fields = ByteFields::packed(chunk.get(at..)?);
        let kind = fields.u8()?;
        let n = usize::try_from(fields.u64()?).ok()?;
        fields.take(n)?;
        let end = at + fields.at();
        Some((self.event(kind, chunk, end - n..end), end))
    }

    fn outside(&mut self, file: &mut File) -> Result<Option<Event>, Stop> {
        let mut fields = ByteFields::packed(file.header(9)?);
        let (Some(kind), Some(n)) = (fields.u8(), fields.u64()) else {
            return Err(Stop::Early(String::new()));
        };
        if !matches!(kind, op::SCHEMA | op::CHANNEL | op::MESSAGE | op::CHUNK) {
            file.skip(n)?;
            if kind == op::FOOTER {
                file.end();
                // The magic bytes once more.
                file.skip(MAGIC.len() as u64)?;
            }
            return Ok(None);
        }
        if let Some(skipped) = file.too_large(n)? {
            return Ok(Some(skipped));
        }
        if kind == op::CHUNK {
            file.chunk(n, packed)?;
            return Ok(None);
        }
        let content = file.content(n)?;
        Ok(self.event(kind, content, 0..content.len()))
    }
}

/// The chunk that a record holds, as far as it is there.
fn packed(record: &[u8]) -> Option<Packed> {
    let mut fields = ByteFields::packed(record);
    // The times of the first and last message come first.
    fields.take(16)?;
    let size = fields.u64()?;
    let checksum = fields.u32()?;
    let method = fields.text()?.into_owned();
    let n = usize::try_from(fields.u64()?).ok()?;
    let start = fields.at();
    Some(Packed {
        method,
        // As much as there is at the end of a file that breaks off.
        bytes: start..start.saturating_add(n).min(record.len()),
        size,
        // Zero means no checksum.
        checksum: (checksum != 0).then_some(checksum),
    })
}

fn channel(fields: &mut ByteFields, schemas: &HashMap<u16, String>) -> Option<Event> {
    let number = u32::from(fields.u16()?);
    let type_name = schemas.get(&fields.u16()?).cloned().unwrap_or_default();
    let name = fields.text()?.into_owned();
    let encoding = match &*fields.text()? {
        "ros1" => Some(Encoding::Ros1),
        "cdr" => Some(Encoding::Cdr),
        _ => None,
    };
    Some(Event::Topic(Declared {
        number,
        name,
        type_name,
        encoding,
    }))
}

/// A message whose record is at `range`.
fn message(fields: &mut ByteFields, range: &Range<usize>) -> Option<Event> {
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
