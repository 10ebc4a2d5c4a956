//! Blocks of a Septentrio stream, found in whatever surrounds them.
//!
//! A block is the bytes `$@`, a CRC of 16 bits, number and revision, the length of the whole block, and its
//! body. The CRC (CCITT, beginning with 0) is over all behind itself.

use crate::log::frames::{Frame, Layout, to_sync};

/// Bytes before the body.
const HEAD: usize = 8;
/// Bytes before what the CRC covers.
const UNCOVERED: usize = 4;
/// Longest block that is believed \[bytes\]: twice that of raw measurements of all signals.
const MAX_BLOCK: usize = 16 * 1024;
/// \[bytes\]
const BUFFER: usize = 256 * 1024;
const SYNC: [u8; 2] = *b"$@";

/// Blocks by number.
pub(super) const LAYOUT: Layout<u16> = Layout {
    sync: SYNC,
    start: |bytes| to_sync(SYNC, bytes),
    frame,
    buffer: BUFFER,
    damaged: "no block behind $@",
};

fn frame(bytes: &[u8]) -> Frame<u16> {
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
        Some(covered) if crc(covered) == sum => {
            Frame::Message(number & 0x1fff, [HEAD, length - HEAD, 0])
        }
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
