//! The messages of a DataFlash log one after another, binary or text.

use std::collections::HashMap;
use std::io::{BufRead, Read};

use super::formats::{Format, MessageKind, Values};
use crate::ReadError;
use crate::source::Source;

/// Every binary message begins with these and its type.
const HEAD: [u8; 2] = [0xa3, 0x95];
/// Types of the messages that define formats, and the length of the first \[bytes\].
const FMT: u8 = 128;
const FMT_LENGTH: usize = 89;
/// Longest message \[bytes\]: its length is in one byte.
const LONGEST: usize = 255;
/// Bytes that are read at a time.
const BLOCK: usize = 64 * 1024;
/// Longest line of a text \[bytes\].
const LONGEST_LINE: u64 = 4096;
/// The first words of a text.
const TEXT: &[u8] = b"FMT, 128, 89, FMT";

pub(super) fn is_binary(start: &[u8]) -> bool {
    start.starts_with(&[HEAD[0], HEAD[1], FMT])
}

pub(super) fn is_text(start: &[u8]) -> bool {
    // Old ones begin with lines of the parameters.
    let start = start.get(..start.len().min(BLOCK)).unwrap_or_default();
    start.starts_with(TEXT) || memchr::memmem::find(start, b"\nFMT, 128, 89, FMT").is_some()
}

/// What comes next.
#[derive(Debug)]
pub(super) enum Next {
    /// A message that is read: its kind, instance and fields.
    Message(MessageKind, u8, Values),
    /// Any other, by its name.
    Other(String),
    /// Bytes that are no message were passed over.
    Damaged(String),
    /// Nothing more; why, if the file broke off.
    End(Option<String>),
}

/// Cuts a log into messages.
pub(super) struct Messages {
    source: Source,
    /// Formats by type.
    formats: HashMap<u8, Format>,
    /// Types by name, for texts.
    types: HashMap<String, u8>,
    text: bool,
    number: u64,
    /// What was read of the file and not taken yet begins at `at`, which is `offset` in the file.
    buffer: Vec<u8>,
    at: usize,
    offset: u64,
    /// Where bytes begin that are no message.
    lost: Option<u64>,
    failure: Option<String>,
    ended: bool,
}

impl Messages {
    pub(super) fn open(mut source: Source) -> Result<Self, ReadError> {
        let start = source.fill_buf();
        let start = start.map_err(|e| ReadError::nameless(format!("cannot be read: {e}")))?;
        if start.is_empty() {
            return Err(ReadError::nameless("is empty"));
        }
        let text = !is_binary(start) && is_text(start);
        let own = Format::new(
            "FMT",
            FMT_LENGTH,
            "BBnNZ",
            "Type,Length,Name,Format,Columns",
        );
        Ok(Self {
            source,
            formats: own.map(|own| (FMT, own)).into_iter().collect(),
            types: HashMap::from([("FMT".to_owned(), FMT)]),
            text,
            number: 0,
            buffer: Vec::new(),
            at: 0,
            offset: 0,
            lost: None,
            failure: None,
            ended: false,
        })
    }

    /// Number of the last message, the first is 1.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    pub(super) fn next(&mut self) -> Next {
        if self.ended {
            return Next::End(None);
        }
        if self.text {
            return self.line();
        }
        loop {
            let there = self.fill(LONGEST + HEAD.len());
            let here = self.buffer.get(self.at..).unwrap_or_default();
            let format = match here {
                [first, second, kind, ..] if [*first, *second] == HEAD => self.formats.get(kind),
                _ => None,
            };
            let length = format.map_or(0, |format| format.length);
            let after = here.get(length..).unwrap_or_default();
            // A head or the end must follow a message: lost or wrong bytes show here.
            let fits = length > 0 && length <= here.len();
            if fits && HEAD.starts_with(&after[..after.len().min(2)]) {
                if let Some(from) = self.lost.take() {
                    return Next::Damaged(format!(
                        "bytes {from} to {} hold no message",
                        self.offset
                    ));
                }
                self.number += 1;
                let next = self.message(length);
                self.take(length);
                return next;
            }
            if !there && here.len() < 3 || here.is_empty() || (length > here.len()) {
                return self.end(length > here.len() || !here.is_empty());
            }
            self.lost.get_or_insert(self.offset);
            let next = here.get(1..).unwrap_or_default();
            let skipped = memchr::memchr(HEAD[0], next).map_or(here.len(), |at| at + 1);
            self.take(skipped);
        }
    }

    /// Ends the log; `within`: inside a message, or in bytes that are not one.
    fn end(&mut self, within: bool) -> Next {
        self.ended = true;
        let from = self.lost.take();
        Next::End(match (self.failure.take(), from) {
            (Some(failure), _) => Some(failure),
            (None, Some(from)) => Some(format!("no message from byte {from} on")),
            (None, None) => within.then(|| "in the middle of a message".to_owned()),
        })
    }

    /// Reads on until there are `n` bytes; false at the end of the file.
    fn fill(&mut self, n: usize) -> bool {
        if self.buffer.len() - self.at >= n {
            return true;
        }
        self.buffer.drain(..self.at);
        self.at = 0;
        if self.failure.is_none() {
            let block = (&mut self.source).take(BLOCK as u64);
            let read = { block }.read_to_end(&mut self.buffer);
            self.failure = read.err().map(|error| error.to_string());
        }
        self.buffer.len() >= n
    }

    fn take(&mut self, n: usize) {
        self.at += n;
        self.offset += n as u64;
    }

    /// What the message of this length says.
    fn message(&mut self, length: usize) -> Next {
        let bytes = self.buffer.get(self.at..self.at + length);
        let Some((&[_, _, kind], body)) = bytes.and_then(|bytes| bytes.split_first_chunk()) else {
            return Next::End(None);
        };
        let Some(format) = self.formats.get(&kind) else {
            return Next::End(None);
        };
        let text = |bytes: &[u8]| {
            let end = bytes.iter().position(|byte| *byte == 0);
            String::from_utf8_lossy(&bytes[..end.unwrap_or(bytes.len())]).into_owned()
        };
        let name = format.name.clone();
        match (name.as_str(), body) {
            ("FMT", [kind, length, rest @ ..]) if rest.len() == 84 => {
                let [name, letters, labels] = [&rest[..4], &rest[4..20], &rest[20..]].map(text);
                self.define(
                    *kind,
                    Format::new(&name, usize::from(*length), &letters, &labels),
                );
            }
            // Time, type, units, multipliers.
            ("FMTU", [_, _, _, _, _, _, _, _, kind, rest @ ..]) if rest.len() == 32 => {
                let multipliers = text(&rest[16..]);
                if let Some(format) = self.formats.get_mut(kind) {
                    format.scale(&multipliers);
                }
            }
            _ => {
                if let Some((kind, instance, values)) = format.read(body) {
                    return Next::Message(kind, instance, values);
                }
            }
        }
        Next::Other(name)
    }

    fn define(&mut self, kind: u8, format: Option<Format>) {
        // The format of formats is fixed.
        if let Some(format) = format.filter(|_| kind != FMT) {
            self.types.insert(format.name.clone(), kind);
            self.formats.insert(kind, format);
        }
    }

    /// The next line of a text: the name of a message and its fields.
    fn line(&mut self) -> Next {
        let mut line = Vec::new();
        let read = (&mut self.source)
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut line);
        self.number += 1;
        match read {
            Ok(0) => return self.end(false),
            Err(error) => {
                self.failure = Some(error.to_string());
                return self.end(false);
            }
            Ok(_) => {}
        }
        let fields: Vec<&[u8]> = line
            .split(|byte| *byte == b',')
            .map(<[u8]>::trim_ascii)
            .collect();
        let [name, fields @ ..] = &fields[..] else {
            return Next::Other(String::new());
        };
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let name = text(name);
        match (name.as_str(), fields) {
            ("FMT", [kind, length, defined, letters, labels @ ..]) => {
                let labels = text(&labels.join(&b','));
                if let (Ok(kind), Ok(length)) = (text(kind).parse(), text(length).parse()) {
                    let format = Format::new(&text(defined), length, &text(letters), &labels);
                    self.define(kind, format);
                }
                return Next::Other(name);
            }
            ("FMTU", [_, kind, _, multipliers]) => {
                let kind = text(kind).parse().unwrap_or(FMT);
                if let Some(format) = self.formats.get_mut(&kind) {
                    format.scale(&text(multipliers));
                }
                return Next::Other(name);
            }
            _ => {}
        }
        let format = self
            .types
            .get(&name)
            .and_then(|kind| self.formats.get(kind));
        match format.map(|format| format.read_text(fields)) {
            Some(Some((kind, instance, values))) => Next::Message(kind, instance, values),
            Some(None) => Next::Other(name),
            None => Next::Damaged(format!("line {}", crate::skipped::shown(line.trim_ascii()))),
        }
    }
}
