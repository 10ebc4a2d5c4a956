//! UTF-16 text, as spreadsheets and editors on Windows save it, read as UTF-8.

use std::char::{REPLACEMENT_CHARACTER, decode_utf16};
use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Read};

use crate::source::{Failing, Source};

/// Of so many first characters, so many are those of ASCII in UTF-16 without its mark.
const FIRST: usize = 16;
const KNOWN: usize = 12;

/// The order of the bytes of a text of ASCII in UTF-16 without a mark.
fn unmarked(start: &[u8]) -> Option<fn([u8; 2]) -> u16> {
    let orders: [fn([u8; 2]) -> u16; 2] = [u16::from_le_bytes, u16::from_be_bytes];
    let is_text = |order: &fn([u8; 2]) -> u16| {
        let characters = start.chunks_exact(2).map(|pair| order([pair[0], pair[1]]));
        let known = characters
            .take(FIRST)
            .filter(|unit| matches!(unit, 9 | 10 | 13 | 0x20..=0x7e));
        known.count() >= KNOWN
    };
    orders.into_iter().find(is_text)
}

/// A stream that is UTF-16, by its first bytes, decoded; any other as it is. What cannot be read fails again later.
pub(crate) fn decoded(mut source: Source) -> Source {
    let order = match source.fill_buf() {
        // UTF-32 has two zeros behind the same mark.
        Ok([0xff, 0xfe, 0, 0, ..]) => return source,
        Ok([0xff, 0xfe, ..]) => u16::from_le_bytes,
        Ok([0xfe, 0xff, ..]) => u16::from_be_bytes,
        Ok(start) => match unmarked(start) {
            Some(order) => return decoder(source, order),
            None => return source,
        },
        Err(error) => return Box::new(BufReader::new(Failing(Some(error))).chain(source)),
    };
    source.consume(2);
    decoder(source, order)
}

fn decoder(source: Source, order: fn([u8; 2]) -> u16) -> Source {
    Box::new(BufReader::new(Text {
        source,
        order,
        units: Vec::new(),
        text: VecDeque::new(),
    }))
}

struct Text {
    source: Source,
    order: fn([u8; 2]) -> u16,
    /// The first half of a character, whose second half has not been read.
    units: Vec<u16>,
    /// Decoded, and not given out yet.
    text: VecDeque<u8>,
}

impl Text {
    /// Decodes what the stream has at hand; false at its end.
    fn decode(&mut self) -> io::Result<bool> {
        let buffer = self.source.fill_buf()?;
        let mut pairs = buffer
            .chunks_exact(2)
            .map(|pair| (self.order)([pair[0], pair[1]]));
        self.units.extend(&mut pairs);
        let mut passed = buffer.len() & !1;
        let mut any = passed > 0;
        if passed == 0 && !buffer.is_empty() {
            // A pair of bytes across two buffers, or a byte too many at the end.
            let mut pair = Vec::new();
            (&mut self.source).take(2).read_to_end(&mut pair)?;
            let pair: Result<[u8; 2], _> = pair.try_into();
            any = pair.is_ok();
            self.units.extend(pair.map(self.order));
            passed = 0;
        }
        self.source.consume(passed);
        let is_first_half = |unit: &u16| (0xd800..0xdc00).contains(unit);
        let at_end = !any && self.units.is_empty();
        let rest = match self.units.last() {
            Some(last) if is_first_half(last) && any => self.units.pop(),
            _ => None,
        };
        let mut bytes = [0; 4];
        for character in decode_utf16(self.units.drain(..)) {
            let character = character.unwrap_or(REPLACEMENT_CHARACTER);
            self.text
                .extend(character.encode_utf8(&mut bytes).as_bytes());
        }
        self.units.extend(rest);
        Ok(!at_end)
    }
}

impl Read for Text {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        while self.text.is_empty() {
            if !self.decode()? {
                return Ok(0);
            }
        }
        self.text.read(into)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn both_orders_whatever_the_size_of_the_reads() {
        let text = "t,gx °\n1,2 𝄞\n".repeat(50);
        let bytes = |order: fn(u16) -> [u8; 2]| -> Vec<u8> {
            let marked = format!("\u{feff}{text}");
            marked.encode_utf16().flat_map(order).collect()
        };
        let mut odd = bytes(u16::to_le_bytes);
        odd.push(7);
        let unmarked = [u16::to_le_bytes, u16::to_be_bytes].map(|order| bytes(order)[2..].to_vec());
        for bytes in [bytes(u16::to_le_bytes), bytes(u16::to_be_bytes), odd] {
            for size in [2, 3, 5, 64, 4096] {
                let stream = BufReader::with_capacity(size, Cursor::new(bytes.clone()));
                let mut read = String::new();
                let mut decoded = decoded(Box::new(stream));
                decoded.read_to_string(&mut read).unwrap();
                assert_eq!(read, text, "{size}");
            }
        }
        for bytes in unmarked {
            let mut read = String::new();
            let mut text_of = decoded(Box::new(Cursor::new(bytes)));
            text_of.read_to_string(&mut read).unwrap();
            assert_eq!(read, text);
        }
        let mut read = Vec::new();
        let mut plain = decoded(Box::new(Cursor::new(b"\xff1,2".to_vec())));
        plain.read_to_end(&mut read).unwrap();
        assert_eq!(read, b"\xff1,2");
    }
}
