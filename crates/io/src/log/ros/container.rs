//! What bags and MCAP have in common: records, some of which are chunks of records.

use std::ops::Range;

use super::message::Encoding;
use crate::ReadError;
use crate::log::bytes::{self, MOST};
use crate::mcap_records::crc32;
use crate::skipped::SkipKind;
use crate::source::Source;

/// Contents of a container, in the order of the file.
#[derive(Debug)]
pub(crate) enum Event {
    Topic(Declared),
    /// A message: the number of its topic, when it was recorded (Unix time), where its bytes are.
    Message {
        number: u32,
        time: (i64, u32),
        bytes: Range<usize>,
    },
    /// Something that cannot be read.
    Skipped(SkipKind, String),
}

/// That there is a topic.
#[derive(Debug)]
pub(crate) struct Declared {
    /// Its messages have this number.
    pub(crate) number: u32,
    pub(crate) name: String,
    pub(crate) type_name: String,
    /// `None` where its messages cannot be read.
    pub(crate) encoding: Option<Encoding>,
}

/// How a container lays out its records.
pub(crate) trait Records: Send {
    /// Methods of compression that can be read.
    fn methods(&self) -> &'static str;

    /// Contents of the record of a chunk at `at`, and where it ends; `None` if it does not fit.
    fn inside(&mut self, chunk: &[u8], at: usize) -> Option<(Option<Event>, usize)>;

    /// Reads the next record outside of chunks and returns its contents. A chunk is unpacked.
    fn outside(&mut self, file: &mut File) -> Result<Option<Event>, Stop>;
}

/// Why reading ends.
#[derive(Debug)]
pub(crate) enum Stop {
    /// The file breaks off.
    Early(String),
    /// A compression that is not known.
    Method(String),
    /// The file is encrypted.
    Encrypted,
}

/// A file being read, and the chunk it is at.
pub(crate) struct File {
    source: Source,
    /// A record as it is in the file.
    raw: Vec<u8>,
    /// The records of a chunk, or the content of a record outside of one.
    data: Vec<u8>,
    /// Where the next record of the chunk begins.
    at: usize,
    /// What there is to tell after the chunk.
    damage: Option<(SkipKind, String)>,
    ended: bool,
}

impl File {
    /// Whether nothing is left to read.
    pub(crate) fn at_end(&mut self) -> bool {
        bytes::at_end(&mut self.source)
    }

    /// Ends the file as it should.
    pub(crate) fn end(&mut self) {
        self.ended = true;
    }

    /// Reads `n` bytes: a header.
    pub(crate) fn header(&mut self, n: u64) -> Result<&[u8], Stop> {
        bytes::read(&mut self.source, n, &mut self.raw).map_err(Stop::Early)?;
        Ok(&self.raw)
    }

    /// Reads `n` bytes: the content of a record, to be kept until the next one.
    pub(crate) fn content(&mut self, n: u64) -> Result<&[u8], Stop> {
        let whole = bytes::read(&mut self.source, n, &mut self.data);
        self.at = self.data.len();
        whole.map_err(Stop::Early)?;
        Ok(&self.data)
    }

    /// Reads past `n` bytes.
    pub(crate) fn skip(&mut self, n: u64) -> Result<(), Stop> {
        bytes::skip(&mut self.source, n).map_err(Stop::Early)
    }

    /// Reads past a record of `n` bytes that would be of use, if it is too large to be true.
    pub(crate) fn too_large(&mut self, n: u64) -> Result<Option<Event>, Stop> {
        if n <= MOST {
            return Ok(None);
        }
        self.skip(n)?;
        let detail = format!("a record of {n} bytes");
        Ok(Some(Event::Skipped(SkipKind::Damaged, detail)))
    }

    /// Reads and decompresses a chunk of `n` bytes: all of it, checked, or what there is of it at
    /// the end of the file.
    pub(crate) fn chunk(
        &mut self,
        n: u64,
        head: impl FnOnce(&[u8]) -> Option<Packed>,
    ) -> Result<(), Stop> {
        let whole = bytes::read(&mut self.source, n, &mut self.raw).map_err(Stop::Early);
        let Some(packed) = head(&self.raw) else {
            return whole.map(|()| self.damaged("a chunk too short to be one".to_owned()));
        };
        let bytes = self.raw.get(packed.bytes).unwrap_or_default();
        let unpacked = bytes::decompress(&packed.method, bytes, packed.size, &mut self.data);
        if unpacked == Err(None) {
            return Err(Stop::Method(packed.method));
        }
        whole?;
        let wrong = (packed.checksum).is_some_and(|sum| sum != crc32(&self.data));
        match unpacked {
            Err(why) => self.damaged(why.unwrap_or_default()),
            Ok(()) if wrong => self.damaged("a chunk whose checksum is wrong".to_owned()),
            Ok(()) => {}
        }
        Ok(())
    }

    /// Gives up a chunk: what came before the damage may be wrong already.
    fn damaged(&mut self, why: String) {
        self.data.clear();
        self.damage = Some((SkipKind::Damaged, why));
    }
}

/// A chunk as it is in the file.
pub(crate) struct Packed {
    pub(crate) method: String,
    /// Where its bytes are in the record.
    pub(crate) bytes: Range<usize>,
    /// Decompressed \[bytes\].
    pub(crate) size: u64,
    /// CRC-32 of what is decompressed.
    pub(crate) checksum: Option<u32>,
}

/// Contents of a recording, one entry after the other.
pub(crate) trait Events: Send {
    /// The next entry.
    fn next(&mut self) -> Result<Option<Event>, ReadError>;

    /// The bytes of the last message.
    fn bytes(&self, range: Range<usize>) -> &[u8];
}

/// A container of records and where it is read.
pub(crate) struct Container {
    file: File,
    layout: Box<dyn Records>,
}

impl Container {
    /// Begins after the magic bytes; without them the bytes that are there instead are an error.
    pub(crate) fn open(
        mut source: Source,
        magic: &[u8],
        layout: impl Records + 'static,
    ) -> Result<Self, Vec<u8>> {
        let mut raw = Vec::new();
        let whole = bytes::read(&mut source, magic.len() as u64, &mut raw);
        if whole.is_err() || raw != magic {
            return Err(raw);
        }
        Ok(Self {
            file: File {
                source,
                raw,
                data: Vec::new(),
                at: 0,
                damage: None,
                ended: false,
            },
            layout: Box::new(layout),
        })
    }
}

impl Events for Container {
    fn next(&mut self) -> Result<Option<Event>, ReadError> {
        loop {
            let file = &mut self.file;
            if file.at < file.data.len() {
                match self.layout.inside(&file.data, file.at) {
                    Some((event, end)) => {
                        file.at = end;
                        if event.is_some() {
                            return Ok(event);
                        }
                    }
                    None => {
                        file.at = file.data.len();
                        file.damage.get_or_insert_with(|| {
                            let detail = "a chunk with a record that does not fit into it";
                            (SkipKind::Damaged, detail.to_owned())
                        });
                    }
                }
                continue;
            }
            if let Some((kind, detail)) = file.damage.take() {
                return Ok(Some(Event::Skipped(kind, detail)));
            }
            if file.ended {
                return Ok(None);
            }
            file.data.clear();
            file.at = 0;
            match self.layout.outside(file) {
                Ok(Some(event)) => return Ok(Some(event)),
                Ok(None) => {}
                Err(Stop::Early(why)) => {
                    // What is left of the chunk is read first.
                    file.damage = Some((SkipKind::EndsEarly, why));
                    file.ended = true;
                }
                Err(Stop::Method(method)) => {
                    let problem = format!("a chunk is compressed by {method:?}");
                    return Err(ReadError::nameless(problem)
                        .mend(format!("{} can be read", self.layout.methods())));
                }
                Err(Stop::Encrypted) => {
                    return Err(ReadError::nameless("the file is encrypted"));
                }
            }
        }
    }

    fn bytes(&self, range: Range<usize>) -> &[u8] {
        self.file.data.get(range).unwrap_or_default()
    }
}
