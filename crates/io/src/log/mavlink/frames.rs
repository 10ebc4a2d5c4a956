//! Frames of MAVLink, versions 1 and 2, found in whatever surrounds them: what a .tlog puts before each, other bytes on the line.
//!
//! A frame is its mark, the length of its body, a sequence number, system and component, the message's number, its body, and a CRC
//! of 16 bits (MCRF4XX, beginning with 0xFFFF) over all behind the mark and a byte of the message's definition, so that only
//! messages whose definition is known can be checked. Version 2 leaves zeros at the end of a body out.

use super::messages;
use crate::log::frames::{Frame, Layout};
use memchr::memchr2;

/// Marks of versions 1 and 2.
const MARKS: [u8; 2] = [0xfe, 0xfd];
/// Bytes before the body.
const HEADS: [usize; 2] = [6, 10];
/// Bytes behind it: the CRC, and a signature where the first flag says so.
const CRC: usize = 2;
const SIGNATURE: usize = 13;
/// Bytes of the time before each frame of a .tlog.
const TIME: usize = 8;
/// \[bytes\]
const BUFFER: usize = 64 * 1024;

/// What is known of a message before its body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Head {
    /// Its number.
    pub(super) number: u32,
    /// Who sends it: system and component.
    pub(super) sender: [u8; 2],
}

/// Messages by number.
pub(super) const LAYOUT: Layout<Head> = Layout {
    // No two bytes begin every frame: what the file breaks off in is passed over.
    sync: [0xfd, 0xfe],
    start: |bytes| memchr2(MARKS[0], MARKS[1], bytes).unwrap_or(bytes.len()),
    frame,
    buffer: BUFFER,
    damaged: "a frame whose checksum is wrong",
};

fn frame(bytes: &[u8]) -> Frame<Head> {
    let Some(version) = MARKS.iter().position(|mark| bytes.first() == Some(mark)) else {
        return match bytes.is_empty() {
            true => Frame::Longer,
            false => Frame::Other,
        };
    };
    let Some(head) = bytes.get(..HEADS[version]) else {
        return Frame::Longer;
    };
    let length = usize::from(head[1]);
    let (number, sender, after) = match version {
        0 => (u32::from(head[5]), [head[3], head[4]], CRC),
        _ => {
            let number = u32::from_le_bytes([head[7], head[8], head[9], 0]);
            let signed = head[2] & 1 == 1;
            let after = CRC + if signed { SIGNATURE } else { 0 };
            (number, [head[5], head[6]], after)
        }
    };
    let end = head.len() + length;
    let lengths = [head.len(), length, after];
    let Some([low, high]) = bytes.get(end..).and_then(<[u8]>::first_chunk::<CRC>) else {
        return Frame::Longer;
    };
    // Of a message whose definition is not known nothing shows where it ends: the search goes on in it.
    let Some(extra) = messages::crc_extra(number) else {
        return Frame::Other;
    };
    let covered = bytes.get(1..end).unwrap_or_default();
    if crc(covered, extra) == u16::from_le_bytes([*low, *high]) {
        return match bytes.len() < end + after {
            true => Frame::Longer,
            false => Frame::Message(Head { number, sender }, lengths),
        };
    }
    // Damaged, or bytes of something else: what follows a frame is another, or the time before it.
    let next = |at: usize| bytes.get(end + after + at);
    match (next(0), next(TIME)) {
        (Some(mark), _) | (_, Some(mark)) if MARKS.contains(mark) => Frame::Damaged,
        (_, Some(_)) => Frame::Other,
        (_, None) => Frame::Longer,
    }
}

/// The CRC of what is covered and the byte of the message's definition.
pub(crate) fn crc(covered: &[u8], extra: u8) -> u16 {
    covered.iter().chain([&extra]).fold(0xffff, |sum, byte| {
        let mut low = byte ^ (sum & 0xff) as u8;
        low ^= low << 4;
        let low = u16::from(low);
        (sum >> 8) ^ (low << 8) ^ (low << 3) ^ (low >> 4)
    })
}
