//! Blocks of a Septentrio stream, found in whatever surrounds them.
//!
//! A block is the bytes `$@`, a CRC of 16 bits, number and revision, the length of the whole block, and its
//! body. The CRC (CCITT, beginning with 0) is over all behind itself. Where it is wrong the search goes
//! on behind the two bytes, so that a block in what a false length covered is found.

use std::ops::Range;

use memchr::memchr;

use crate::lines::Window;
use crate::source::Source;

/// Bytes before the body.
const HEAD: usize = 8;
/// Bytes before what the CRC covers.
const UNCOVERED: usize = 4;
/// Longest block that is believed \[bytes\]: twice that of raw measurements of all signals.
const MAX_BLOCK: usize = 16 * 1024;
/// The buffer \[bytes\]: the longest block and several reads fit.
const BUFFER: usize = 256 * 1024;
const SYNC: [u8; 2] = *b"$@";

pub(super) struct Frames {
    window: Window,
    number: u64,
}

pub(super) enum NextFrame {
    /// A block with this number; read its body with [`Frames::body`].
    Block(u16, Range<usize>),
    /// What looked like the beginning of a block is none, or a damaged one.
    Damaged,
    /// Nothing more; [`Frames::failure`] tells whether the file broke off.
    End,
}

/// What stands at the beginning of some bytes that start with the sync.
enum Frame {
    /// A block with this number and length.
    Block(u16, usize),
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

    /// Number of the block last stepped to, damaged ones included, the first is 1.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// The input error that ended the file before its end, if any.
    pub(super) fn failure(&self) -> Option<String> {
        self.window.failure().map(ToString::to_string)
    }

    pub(super) fn body(&self, range: Range<usize>) -> &[u8] {
        self.window.part(range)
    }

    pub(super) fn step(&mut self) -> NextFrame {
        loop {
            self.window.pass(to_sync(self.window.bytes()));
            let bytes = self.window.bytes();
            match frame(bytes) {
                Frame::Block(number, length) => {
                    self.window.pass(HEAD);
                    let body = self.window.pass(length - HEAD);
                    self.number += 1;
                    return NextFrame::Block(number, body);
                }
                Frame::Longer if !self.window.at_end() => self.window.refill(),
                // At the end of the file a lone dollar is not worth a word.
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

/// Whether some bytes hold a whole block with a `wanted` number.
pub(super) fn any(bytes: &[u8], wanted: impl Fn(u16) -> bool) -> bool {
    let mut from = 0;
    while let Some(rest) = bytes.get(from..).filter(|rest| rest.len() >= SYNC.len()) {
        let at = to_sync(rest);
        from += at;
        match frame(rest.get(at..).unwrap_or_default()) {
            Frame::Block(number, _) if wanted(number) => return true,
            Frame::Block(_, length) => from += length,
            Frame::Damaged | Frame::Longer => from += SYNC.len(),
        }
    }
    false
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
    let Some(head) = bytes.first_chunk::<HEAD>() else {
        return Frame::Longer;
    };
    let at = |k: usize| u16::from_le_bytes([head[k], head[k + 1]]);
    let (sum, number, length) = (at(2), at(4), usize::from(at(6)));
    if !(HEAD..=MAX_BLOCK).contains(&length) || !length.is_multiple_of(4) {
        return Frame::Damaged;
    }
    match bytes.get(UNCOVERED..length) {
        // The upper three bits are the revision.
        Some(covered) if crc(covered) == sum => Frame::Block(number & 0x1fff, length),
        Some(_) => Frame::Damaged,
        None => Frame::Longer,
    }
}

/// Remainders of the bytes.
const TABLE: [u16; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let (mut sum, mut bit) = ((byte as u16) << 8, 0);
        while bit < 8 {
            sum = (sum << 1) ^ (0x1021 * (sum >> 15));
            bit += 1;
        }
        table[byte] = sum;
        byte += 1;
    }
    table
};

fn crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |sum: u16, byte| {
        (sum << 8) ^ TABLE[usize::from((sum >> 8) as u8 ^ byte)]
    })
}
