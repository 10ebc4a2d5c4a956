//! The messages of a ULog stream one after another.

use std::io::{self, BufRead, Read};

use crate::ReadError;
use crate::source::Source;

/// Start of every ULog file: "ULog", 0x01, 0x12, 0x35.
pub(super) const MAGIC: [u8; 7] = *b"ULog\x01\x12\x35";
/// Header of the file \[bytes\]: magic, version, time of the start.
const HEADER: usize = 16;
/// A whole synchronisation message: its length, its type and its fixed content.
const SYNC: [u8; 11] = *b"\x08\x00S\x2f\x73\x13\x20\x25\x0c\xbb\x12";

/// What comes next in the stream.
pub(super) enum NextMessage {
    /// A message of this type; its content is [`Messages::body`].
    Message(u8),
    /// Bytes that are no message were passed over.
    Damaged(String),
    /// Nothing more; why, if the file broke off.
    End(Option<String>),
}

/// Cuts a stream into messages: two bytes of length, one of type, then the content.
pub(super) struct Messages {
    source: Source,
    /// Bytes read so far.
    position: u64,
    /// Messages met so far.
    number: u64,
    body: Vec<u8>,
    /// Where data was appended later, ascending: a message before it may be cut off there.
    appended: Vec<u64>,
    ended: bool,
}

impl Messages {
    /// Reads the header of the file.
    pub(super) fn open(mut source: Source) -> Result<Self, ReadError> {
        let mut header = [0; HEADER];
        let read = fill(&mut source, &mut header)
            .map_err(|error| ReadError::nameless(format!("cannot be read: {error}")))?;
        if read == 0 {
            return Err(ReadError::nameless("is empty"));
        }
        if read < HEADER || !header.starts_with(&MAGIC) {
            return Err(ReadError::nameless("is not a ULog file"));
        }
        Ok(Self {
            source,
            position: HEADER as u64,
            number: 0,
            body: Vec::new(),
            appended: Vec::new(),
            ended: false,
        })
    }

    /// Content of the message stepped to last.
    pub(super) fn body(&self) -> &[u8] {
        &self.body
    }

    /// Number of the message stepped to last, the first is 1.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Sets where data was appended, as the flags message says; 0: absent.
    pub(super) fn set_appended(&mut self, offsets: impl Iterator<Item = u64>) {
        self.appended = offsets.filter(|at| *at > self.position).collect();
        self.appended.sort_unstable();
    }

    /// Goes to the next message.
    pub(super) fn step(&mut self) -> NextMessage {
        if self.ended {
            return NextMessage::End(None);
        }
        match self.try_step() {
            Ok(step) => step,
            Err(error) => self.end(Some(error.to_string())),
        }
    }

    fn try_step(&mut self) -> io::Result<NextMessage> {
        let mut head = [0; 3];
        loop {
            let edge = self.appended.first().copied().unwrap_or(u64::MAX);
            if !self.room(3, edge)? {
                continue;
            }
            let read = fill(&mut self.source, &mut head)?;
            self.position += read as u64;
            match read {
                0 => return Ok(self.end(None)),
                3 => {}
                _ => return Ok(self.end(Some("in the middle of a message".into()))),
            }
            let [low, high, kind] = head;
            let length = u16::from_le_bytes([low, high]);
            // Types are capital letters, and one that is not known may be passed over.
            if !kind.is_ascii_uppercase() || length == 0 {
                return self.resynchronise();
            }
            if !self.room(u64::from(length), edge)? {
                continue;
            }
            self.body.resize(usize::from(length), 0);
            let read = fill(&mut self.source, &mut self.body)?;
            self.position += read as u64;
            if read < self.body.len() {
                return Ok(self.end(Some("in the middle of a message".into())));
            }
            self.number += 1;
            return Ok(NextMessage::Message(kind));
        }
    }

    /// Whether so many bytes are left before appended data; goes to where that starts if not.
    fn room(&mut self, bytes: u64, edge: u64) -> io::Result<bool> {
        if self.position.saturating_add(bytes) <= edge {
            return Ok(true);
        }
        let rest = edge.saturating_sub(self.position);
        self.position += io::copy(&mut self.source.by_ref().take(rest), &mut io::sink())?;
        self.appended.remove(0);
        Ok(false)
    }

    /// Passes over bytes up to the end of the next synchronisation message.
    fn resynchronise(&mut self) -> io::Result<NextMessage> {
        let from = self.position - 3;
        let mut matched = 0;
        loop {
            let buffer = self.source.fill_buf()?;
            if buffer.is_empty() {
                return Ok(self.end(Some(format!("no message from byte {from} on"))));
            }
            let mut used = 0;
            for &byte in buffer {
                used += 1;
                // The pattern's first byte occurs nowhere else in it.
                matched = match SYNC.get(matched) {
                    Some(&wanted) if wanted == byte => matched + 1,
                    _ => usize::from(byte == SYNC[0]),
                };
                if matched == SYNC.len() {
                    break;
                }
            }
            self.source.consume(used);
            self.position += used as u64;
            if matched == SYNC.len() {
                self.appended.retain(|at| *at >= self.position);
                let to = self.position;
                let text = format!("bytes {from} to {to} hold no message");
                return Ok(NextMessage::Damaged(text));
            }
        }
    }

    fn end(&mut self, why: Option<String>) -> NextMessage {
        self.ended = true;
        NextMessage::End(why)
    }
}

/// Reads until the buffer is full or the stream ends.
fn fill(source: &mut Source, buffer: &mut [u8]) -> io::Result<usize> {
    let mut read = 0;
    while let Some(rest) = buffer.get_mut(read..).filter(|rest| !rest.is_empty()) {
        match source.read(rest) {
            Ok(0) => break,
            Ok(n) => read += n,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(read)
}
