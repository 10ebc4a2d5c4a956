//! Messages of a UBX stream, found in whatever surrounds them.
//!
//! A message is the bytes B5 62, class, identifier, length of the payload (little-endian), payload
//! and two bytes of 8-bit Fletcher checksum over all but the first two.

use crate::log::frames::{Frame, Layout, to_sync};

/// Bytes before the payload.
const HEAD: usize = 6;
/// Longest payload that is believed \[bytes\]: twice that of the longest message, raw measurements of
/// 128 signals. A length beyond it is a damaged one.
const MAX_PAYLOAD: usize = 8 * 1024;
/// \[bytes\]
const BUFFER: usize = 256 * 1024;
const SYNC: [u8; 2] = [0xb5, 0x62];

/// Messages by class and identifier.
pub(super) const LAYOUT: Layout<[u8; 2]> = Layout {
    sync: SYNC,
    start: |bytes| to_sync(SYNC, bytes),
    frame,
    buffer: BUFFER,
    damaged: "no message behind B5 62",
};

fn frame(bytes: &[u8]) -> Frame<[u8; 2]> {
    let Some(&[_, _, class, identifier, low, high]) = bytes.first_chunk::<HEAD>() else {
        return Frame::Longer;
    };
    let length = usize::from(u16::from_le_bytes([low, high]));
    if length > MAX_PAYLOAD {
        return Frame::Damaged;
    }
    let whole = HEAD + length + 2;
    match (bytes.get(2..HEAD + length), bytes.get(whole - 2..whole)) {
        (Some(covered), Some(sum)) if checksum(covered) == sum => {
            Frame::Message([class, identifier], [HEAD, length, 2])
        }
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
