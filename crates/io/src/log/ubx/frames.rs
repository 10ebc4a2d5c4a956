//! Messages of a UBX stream, found in whatever surrounds them.
//!
//! A message is the bytes B5 62, class, identifier, length of the payload (little-endian), payload
//! and two bytes of 8-bit Fletcher checksum over all but the first two. Where the checksum is wrong
//! the search goes on behind those two, so that a message in what a false length covered is found.

use std::ops::Range;

use memchr::memchr;

use crate::lines;
use crate::source::Source;

/// Bytes before the payload.
const HEAD: usize = 6;
/// Longest payload that is believed \[bytes\]: twice that of the longest message, raw measurements of
/// 128 signals. A length beyond it is a damaged one.
const MAX_PAYLOAD: usize = 8 * 1024;
/// The buffer \[bytes\]: the longest message and several reads fit.
const BUFFER: usize = 256 * 1024;
const SYNC: [u8; 2] = [0xb5, 0x62];

pub(super) struct Frames {
    source: Source,
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    number: u64,
    at_end: bool,
    failure: Option<String>,
}

pub(super) enum Step {
    /// A message of a class and identifier; read its payload with [`Frames::payload`].
    Message([u8; 2], Range<usize>),
    /// What looked like the beginning of a message is none, or a damaged one.
    Damaged,
    /// Nothing more; [`Frames::failure`] tells whether the file broke off.
    End,
}

/// What stands at the beginning of some bytes that start with the sync.
enum Frame {
    /// A message with this many bytes of payload.
    Message(usize),
    Damaged,
    /// More bytes than there are.
    Longer,
}

impl Frames {
    pub(super) fn new(source: Source) -> Self {
        Self {
            source,
            buffer: vec![0; BUFFER],
            start: 0,
            end: 0,
            number: 0,
            at_end: false,
            failure: None,
        }
    }

    /// Number of the message last stepped to, damaged ones included, the first is 1.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// The input error that ended the file before its end, if any.
    pub(super) fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    pub(super) fn payload(&self, range: Range<usize>) -> &[u8] {
        self.buffer.get(range).unwrap_or_default()
    }

    pub(super) fn step(&mut self) -> Step {
        loop {
            let held = self.buffer.get(self.start..self.end).unwrap_or_default();
            self.start += to_sync(held);
            let held = self.buffer.get(self.start..self.end).unwrap_or_default();
            match frame(held) {
                Frame::Message(length) => {
                    let head = [held.get(2), held.get(3)].map(|byte| byte.copied().unwrap_or(0));
                    let from = self.start + HEAD;
                    self.start = from + length + 2;
                    self.number += 1;
                    return Step::Message(head, from..from + length);
                }
                Frame::Longer if !self.at_end => self.refill(),
                // At the end of the file a lone first byte of the sync is not worth a word.
                Frame::Longer if held.len() < SYNC.len() => return Step::End,
                Frame::Damaged | Frame::Longer => {
                    self.start += SYNC.len();
                    self.number += 1;
                    return Step::Damaged;
                }
            }
        }
    }

    /// Moves what is left to the front and reads once.
    fn refill(&mut self) {
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        let free = self.buffer.get_mut(self.end..).unwrap_or_default();
        match lines::read(&mut self.source, free) {
            Ok(0) => self.at_end = true,
            Ok(n) => self.end += n,
            Err(error) => {
                self.at_end = true;
                self.failure = Some(error.to_string());
            }
        }
    }
}

/// How many bytes stand before the first sync, or before what may be its first half at the end.
fn to_sync(bytes: &[u8]) -> usize {
    let mut from = 0;
    while let Some(at) = bytes.get(from..).and_then(|rest| memchr(SYNC[0], rest)) {
        match bytes.get(from + at + 1) {
            Some(second) if *second != SYNC[1] => from += at + 1,
            _ => return from + at,
        }
    }
    bytes.len()
}

fn frame(bytes: &[u8]) -> Frame {
    let Some(&[_, _, _, _, low, high]) = bytes.first_chunk::<HEAD>() else {
        return Frame::Longer;
    };
    let length = usize::from(u16::from_le_bytes([low, high]));
    if length > MAX_PAYLOAD {
        return Frame::Damaged;
    }
    let whole = HEAD + length + 2;
    match (bytes.get(2..HEAD + length), bytes.get(whole - 2..whole)) {
        (Some(covered), Some(sum)) if checksum(covered) == sum => Frame::Message(length),
        (Some(_), Some(_)) => Frame::Damaged,
        _ => Frame::Longer,
    }
}

fn checksum(bytes: &[u8]) -> [u8; 2] {
    bytes.iter().fold([0, 0], |[a, b], byte| {
        let a = byte.wrapping_add(a);
        [a, a.wrapping_add(b)]
    })
}

/// Whether some bytes, the first of a file, hold a whole message of a kind.
pub(super) fn any(mut bytes: &[u8], of_kind: impl Fn([u8; 2]) -> bool) -> bool {
    loop {
        bytes = bytes.get(to_sync(bytes)..).unwrap_or_default();
        match frame(bytes) {
            Frame::Message(_)
                if bytes
                    .get(2..)
                    .and_then(<[u8]>::first_chunk)
                    .is_some_and(|kind| of_kind(*kind)) =>
            {
                return true;
            }
            Frame::Message(length) => {
                bytes = bytes.get(HEAD + length + 2..).unwrap_or_default();
            }
            // A false length must not hide the messages that it covers.
            Frame::Damaged | Frame::Longer if bytes.len() > SYNC.len() => {
                bytes = bytes.get(SYNC.len()..).unwrap_or_default();
            }
            _ => return false,
        }
    }
}
