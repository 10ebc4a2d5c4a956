//! Messages of a UBX stream, found in whatever surrounds them.
//!
//! A message is the bytes B5 62, class, identifier, length of the payload (little-endian), payload
//! and two bytes of 8-bit Fletcher checksum over all but the first two. Where the checksum is wrong
//! the search goes on behind those two, so that a message in what a false length covered is found.

use std::ops::Range;

use memchr::memchr;

use crate::lines::Window;
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
    window: Window,
    number: u64,
}

pub(super) enum NextFrame {
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
            window: Window::new(source, BUFFER),
            number: 0,
        }
    }

    /// Number of the message last stepped to, damaged ones included, the first is 1.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// The input error that ended the file before its end, if any.
    pub(super) fn failure(&self) -> Option<String> {
        self.window.failure().map(ToString::to_string)
    }

    pub(super) fn payload(&self, range: Range<usize>) -> &[u8] {
        self.window.part(range)
    }

    pub(super) fn step(&mut self) -> NextFrame {
        loop {
            self.window.pass(to_sync(self.window.bytes()));
            let bytes = self.window.bytes();
            match frame(bytes) {
                Frame::Message(length) => {
                    let kind = [bytes.get(2), bytes.get(3)].map(|byte| byte.copied().unwrap_or(0));
                    self.window.pass(HEAD);
                    let payload = self.window.pass(length);
                    self.window.pass(2);
                    self.number += 1;
                    return NextFrame::Message(kind, payload);
                }
                Frame::Longer if !self.window.at_end() => self.window.refill(),
                // At the end of the file a lone first byte of the sync is not worth a word.
                Frame::Longer if bytes.len() < SYNC.len() => return NextFrame::End,
                Frame::Damaged | Frame::Longer => {
                    self.window.pass(SYNC.len());
                    self.number += 1;
                    return NextFrame::Damaged;
                }
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
