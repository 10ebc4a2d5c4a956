//! Messages of a NovAtel stream, ASCII and binary, in whatever surrounds them.
//!
//! Binary: AA 44 12 and a header of at least 28 bytes, or AA 44 13 and one of 12; the body; a CRC. ASCII:
//! `#NAMEA,…;…*` or, with the short header, `%NAMEA,…;…*`, and the CRC in hexadecimal digits. Both have
//! the CRC-32 of Ethernet's polynomial that begins with 0 and is not inverted.

use memchr::{memchr, memchr3};

use crate::log::frames::{Frame, Layout};
use crate::number;

/// Longest messages that are believed, binary and ASCII \[bytes\]: twice those of raw measurements of 200
/// signals. A length beyond it is a damaged one.
const MAX_BINARY: usize = 16 * 1024;
const MAX_ASCII: usize = 64 * 1024;
/// \[bytes\]
const BUFFER: usize = 512 * 1024;
const SYNC: [u8; 2] = [0xaa, 0x44];
const LONG: u8 = 0x12;
const SHORT: u8 = 0x13;
/// Bytes of the CRC, binary and ASCII.
const CRC: usize = 4;
const DIGITS: usize = 8;

/// Which message, when, and how it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Head {
    pub(super) kind: MessageKind,
    /// GPS week, not rolled over; 0 before the receiver knows it.
    pub(super) week: u16,
    /// Milliseconds of the week.
    pub(super) milli: u32,
    pub(super) text: bool,
}

/// Which message: binary ones have a number, ASCII ones a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum MessageKind {
    Number(u16),
    /// Without the A at its end, filled up with zeros.
    Name([u8; NAME]),
}

/// Longest name \[bytes\].
pub(super) const NAME: usize = 24;

/// Messages, ASCII and binary.
pub(super) const LAYOUT: Layout<Head> = Layout {
    sync: SYNC,
    start: to_start,
    frame,
    buffer: BUFFER,
    damaged: "no whole message",
};

/// How many bytes stand before the first that may begin a message.
fn to_start(bytes: &[u8]) -> usize {
    memchr3(SYNC[0], b'#', b'%', bytes).unwrap_or(bytes.len())
}

fn frame(bytes: &[u8]) -> Frame<Head> {
    match bytes.first() {
        Some(b'#' | b'%') => ascii(bytes),
        Some(_) => binary(bytes),
        None => Frame::Longer,
    }
}

fn binary(bytes: &[u8]) -> Frame<Head> {
    let Some(start) = bytes.first_chunk::<4>() else {
        let begins = bytes.iter().zip(SYNC).all(|(byte, sync)| *byte == sync);
        return if begins { Frame::Longer } else { Frame::Other };
    };
    let [a, b, kind, fourth] = *start;
    if [a, b] != SYNC {
        return Frame::Other;
    }
    let u16_at = |at: usize| {
        let two = bytes.get(at..at + 2).and_then(|two| two.try_into().ok());
        two.map(u16::from_le_bytes)
    };
    let u32_at = |at: usize| {
        let four = bytes.get(at..at + 4).and_then(|four| four.try_into().ok());
        four.map(u32::from_le_bytes)
    };
    let header = match kind {
        LONG if fourth >= 28 => Some((usize::from(fourth), u16_at(8), u16_at(14), u32_at(16))),
        SHORT => Some((12, Some(u16::from(fourth)), u16_at(6), u32_at(8))),
        LONG => None,
        _ => return Frame::Other,
    };
    let (before, length, week, milli) = match header {
        Some((before, Some(length), Some(week), Some(milli))) => (before, length, week, milli),
        Some(_) => return Frame::Longer,
        None => return Frame::Damaged,
    };
    let (Some(number), length) = (u16_at(4), usize::from(length)) else {
        return Frame::Longer;
    };
    let end = before + length;
    if end > MAX_BINARY {
        return Frame::Damaged;
    }
    match (bytes.get(..end), u32_at(end)) {
        (Some(covered), Some(sum)) if crc(covered) == sum => {
            let kind = MessageKind::Number(number);
            let head = Head {
                kind,
                week,
                milli,
                text: false,
            };
            Frame::Message(head, [before, length, CRC])
        }
        (Some(_), Some(_)) => Frame::Damaged,
        _ => Frame::Longer,
    }
}

fn ascii(bytes: &[u8]) -> Frame<Head> {
    // Names are in capitals: anything else is a comment, a per cent sign or a byte of another message.
    match bytes.get(1) {
        Some(first) if !first.is_ascii_uppercase() => return Frame::Other,
        Some(_) => {}
        None => return Frame::Longer,
    }
    // A message has printable characters, and the first of its kind only at its beginning.
    let line = bytes.get(1..bytes.len().min(MAX_ASCII)).unwrap_or_default();
    let inside = |byte: &u8| matches!(byte, b' '..=b'~') && !matches!(byte, b'*' | b'#' | b'%');
    let Some(length) = line.iter().position(|byte| !inside(byte)) else {
        return if line.len() + 1 < MAX_ASCII {
            Frame::Longer
        } else {
            Frame::Other
        };
    };
    if line.get(length) != Some(&b'*') {
        return Frame::Other;
    }
    let (text, star) = (line.get(..length).unwrap_or_default(), length + 1);
    let Some(digits) = bytes.get(star + 1..star + 1 + DIGITS) else {
        return Frame::Longer;
    };
    let Some(sum) = hexadecimal(digits) else {
        return Frame::Other;
    };
    let Some(body) = memchr(b';', text) else {
        return Frame::Other;
    };
    if crc(text) != sum {
        return Frame::Damaged;
    }
    let short = bytes.first() == Some(&b'%');
    let header = text.get(..body).unwrap_or_default();
    match head(header, if short { 1 } else { 5 }) {
        Some(head) => Frame::Message(head, [body + 2, text.len() - body - 1, 1 + DIGITS]),
        None => Frame::Damaged,
    }
}

/// Name, and the week and second of it in the fields `week` and the one behind.
fn head(header: &[u8], week: usize) -> Option<Head> {
    let mut fields = header.split(|&byte| byte == b',');
    let name = fields.next()?.strip_suffix(b"A")?;
    let mut filled = [0; NAME];
    filled.get_mut(..name.len())?.copy_from_slice(name);
    let mut fields = fields.skip(week - 1);
    let number = number::parse(fields.next()?).filter(|week| (0.0..65536.0).contains(week))?;
    let seconds = number::parse(fields.next()?).filter(|second| (0.0..1e6).contains(second))?;
    Some(Head {
        kind: MessageKind::Name(filled),
        week: number as u16,
        milli: (seconds * 1e3).round() as u32,
        text: true,
    })
}

fn hexadecimal(digits: &[u8]) -> Option<u32> {
    u32::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()
}

/// Remainders of the bytes.
const TABLE: [u32; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let (mut sum, mut bit) = (byte as u32, 0);
        while bit < 8 {
            sum = (sum >> 1) ^ (0xedb8_8320 * (sum & 1));
            bit += 1;
        }
        table[byte] = sum;
        byte += 1;
    }
    table
};

fn crc(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0, |sum, byte| {
        (sum >> 8) ^ TABLE[usize::from(sum as u8 ^ byte)]
    })
}
