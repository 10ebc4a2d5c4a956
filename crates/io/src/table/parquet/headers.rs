//! Whether the headers of a Parquet file are what they say, before the crate that reads them believes them.
//!
//! They are structures in Thrift's compact protocol. The crate walks over an unknown list as far as its
//! length goes, which is up to 2³¹ elements, and over booleans without taking a byte each: a few bytes
//! would hold it up for minutes. No header of Parquet has lists or maps of booleans.

use bytes::Bytes;
use parquet::errors::ParquetError;
use parquet::file::reader::ChunkReader;

/// Structures, lists and maps within each other.
const DEEPEST: u32 = 32;
/// A page header is a few dozen bytes long, unless it carries long statistics.
const USUAL: u64 = 1024;
/// The length of the footer and the magic bytes.
const TAIL: u64 = 8;

/// Whether the footer of a file is a structure that ends within its length; a file too short for one
/// is left to the reader.
pub(super) fn footer_is_sound(file: &impl ChunkReader) -> Result<bool, ParquetError> {
    let Some(end) = file.len().checked_sub(TAIL) else {
        return Ok(true);
    };
    let size = part(file, end, 4)?;
    let size = size
        .first_chunk()
        .map_or(0, |size| u32::from_le_bytes(*size));
    let Some(start) = end.checked_sub(u64::from(size)) else {
        return Ok(true);
    };
    let footer = part(file, start, end - start)?;
    Ok(Header::read(&footer).is_some())
}

/// Whether all page headers between two places of a file \[bytes\] are structures that end before the second,
/// and lead from one to the next.
pub(super) fn pages_are_sound(
    file: &impl ChunkReader,
    start: u64,
    end: u64,
) -> Result<bool, ParquetError> {
    let mut at = start;
    while at < end {
        let left = end - at;
        let mut header = Header::read(&part(file, at, left.min(USUAL))?);
        if header.is_none() && left > USUAL {
            header = Header::read(&part(file, at, left)?);
        }
        let Some(page) = header.and_then(Header::with_page) else {
            return Ok(false);
        };
        at = at.saturating_add(page);
    }
    Ok(true)
}

/// As many bytes as there are of those asked for.
fn part(file: &impl ChunkReader, start: u64, length: u64) -> Result<Bytes, ParquetError> {
    let length = length.min(file.len().saturating_sub(start));
    file.get_bytes(start.min(file.len()), usize::try_from(length).unwrap_or(0))
}

/// What is asked of a structure.
struct Header {
    /// Its length \[bytes\].
    length: u64,
    /// Its third field, of a page header the size of the page that follows \[bytes\].
    third: Option<u64>,
}

impl Header {
    /// Of the structure that the bytes begin with; `None` if it does not end within them or cannot be one.
    fn read(bytes: &[u8]) -> Option<Self> {
        let mut walk = Walk { bytes, at: 0 };
        let third = walk.structure(0)?;
        Some(Self {
            length: walk.at as u64,
            third: third.and_then(|value| value.try_into().ok()),
        })
    }

    /// Length of header and page \[bytes\].
    fn with_page(self) -> Option<u64> {
        self.length.checked_add(self.third?)
    }
}

struct Walk<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Walk<'_> {
    fn byte(&mut self) -> Option<u8> {
        let byte = self.bytes.get(self.at)?;
        self.at += 1;
        Some(*byte)
    }

    fn skip(&mut self, count: u64) -> Option<()> {
        let end = self.at.checked_add(count.try_into().ok()?)?;
        self.at = end;
        (end <= self.bytes.len()).then_some(())
    }

    /// A number of seven bits a byte, the lowest first.
    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    /// A number whose lowest bit is its sign.
    fn zigzag(&mut self) -> Option<i64> {
        let value = self.varint()?;
        Some((value >> 1).cast_signed() ^ -(value & 1).cast_signed())
    }

    /// A structure, with its third field if that is a number.
    fn structure(&mut self, depth: u32) -> Option<Option<i64>> {
        let (mut field, mut third) = (0i64, None);
        loop {
            let head = self.byte()?;
            let kind = head & 0x0f;
            if kind == 0 {
                return Some(third);
            }
            field = match head >> 4 {
                0 => self.zigzag()?,
                step => field.checked_add(i64::from(step))?,
            };
            match kind {
                // A boolean is its kind.
                1 | 2 => {}
                4..=6 if field == 3 => third = Some(self.zigzag()?),
                _ => self.value(kind, depth)?,
            }
        }
    }

    /// A value that takes a byte at least.
    fn value(&mut self, kind: u8, depth: u32) -> Option<()> {
        // Before what is inside: a megabyte of heads of lists would be as many calls deep.
        if depth > DEEPEST {
            return None;
        }
        match kind {
            3 => self.skip(1),
            4..=6 => self.varint().map(drop),
            7 => self.skip(8),
            8 => {
                let length = self.varint()?;
                self.skip(length)
            }
            9 | 10 => {
                let head = self.byte()?;
                let count = match head >> 4 {
                    15 => self.varint()?,
                    count => u64::from(count),
                };
                for _ in 0..count {
                    self.value(head & 0x0f, depth + 1)?;
                }
                Some(())
            }
            11 => {
                let count = self.varint()?;
                let kinds = if count > 0 { self.byte()? } else { 0 };
                for _ in 0..count {
                    self.value(kinds >> 4, depth + 1)?;
                    self.value(kinds & 0x0f, depth + 1)?;
                }
                Some(())
            }
            12 => self.structure(depth + 1).map(drop),
            13 => self.skip(16),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_header_leads_to_the_next() {
        // 1: i32 0, 2: i32 100, 3: i32 40, 5: { 1: i32 7 }, the end; zigzag doubles.
        let bytes = [0x15, 0, 0x15, 200, 1, 0x15, 80, 0x2c, 0x15, 14, 0, 0, 0xff];
        let header = Header::read(&bytes).unwrap();
        assert_eq!((header.length, header.third), (12, Some(40)));
        assert_eq!(header.with_page(), Some(52));
        for cut in 0..12 {
            assert!(Header::read(&bytes[..cut]).is_none(), "{cut}");
        }
        // A size below zero is invalid.
        assert!(Header::read(&[0x35, 1, 0]).unwrap().with_page().is_none());
    }

    #[test]
    fn lists_are_no_longer_than_their_bytes() {
        // 1: a list of 2³¹ − 1 booleans, of structures that end at once, of numbers.
        for kind in [1, 2, 12, 5] {
            let head = [0x19, 0xf0 | kind, 0xff, 0xff, 0xff, 0xff, 0x07];
            let bytes = [&head[..], &[0; 100]].concat();
            assert!(Header::read(&bytes).is_none(), "{kind}");
        }
        // Three short numbers and three texts.
        assert!(Header::read(&[0x19, 0x34, 1, 2, 3, 0x19, 0x38, 1, 9, 0, 0, 0]).is_some());
        // Lists within lists, structures within structures, maps within maps without an end to it; the
        // stack of a thread ends before they do.
        for head in [&[0x19][..], &[0x1c], &[0x1b, 1, 0xbb]] {
            assert!(Header::read(&head.repeat(1_000_000)).is_none(), "{head:?}");
        }
    }
}
