//! Bytes of a stream whose lengths are not to be trusted, and the numbers in them.

use std::borrow::Cow;
use std::io::{self, BufRead, Read};

use crate::{source::Source, zstandard};

/// No chunk or message is larger than this \[bytes\]: recorders make chunks of about a megabyte, and
/// clouds of points have tens of them.
pub(super) const MOST: u64 = 256 << 20;

/// Reads `n` bytes in place of what is in `into`. Memory grows with what is there, not with `n`.
///
/// # Errors
/// Why there are fewer; those that are there have been read.
pub(super) fn read(source: &mut Source, n: u64, into: &mut Vec<u8>) -> Result<(), String> {
    into.clear();
    let ended = source.by_ref().take(n).read_to_end(into);
    enough(ended.map(|_| into.len() as u64), n)
}

/// Reads past `n` bytes.
///
/// # Errors
/// Why there are fewer.
pub(super) fn skip(source: &mut Source, n: u64) -> Result<(), String> {
    enough(io::copy(&mut source.by_ref().take(n), &mut io::sink()), n)
}

/// Whether nothing is left.
pub(super) fn at_end(source: &mut Source) -> bool {
    source.fill_buf().is_ok_and(<[u8]>::is_empty)
}

fn enough(got: io::Result<u64>, wanted: u64) -> Result<(), String> {
    match got {
        Ok(got) if got == wanted => Ok(()),
        Ok(_) => Err("the file ends within a record".to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

/// Decompresses a chunk of `size` bytes in place of what is in `into`.
///
/// # Errors
/// Why it cannot be; `None` for an unknown method. What came before the damage is in `into`.
pub(super) fn decompress(
    method: &str,
    packed: &[u8],
    size: u64,
    into: &mut Vec<u8>,
) -> Result<(), Option<String>> {
    into.clear();
    if size > MOST {
        return Err(Some(format!("a chunk of {size} bytes")));
    }
    let done = match method {
        "" | "none" => packed.take(size).read_to_end(into),
        "bz2" => bzip2::bufread::BzDecoder::new(packed)
            .take(size)
            .read_to_end(into),
        "lz4" => lz4_flex::frame::FrameDecoder::new(packed)
            .take(size)
            .read_to_end(into),
        "zstd" => {
            zstandard::decoder(packed).and_then(|decoder| decoder.take(size).read_to_end(into))
        }
        _ => return Err(None),
    };
    match done {
        Ok(_) if into.len() as u64 == size => Ok(()),
        Ok(_) => Err(Some(format!(
            "a chunk of {} bytes where {size} are announced",
            into.len()
        ))),
        Err(error) => Err(Some(format!("a chunk cannot be decompressed: {error}"))),
    }
}

/// Decompresses a message of zstd that does not tell its size.
///
/// # Errors
/// Why it cannot be.
pub(super) fn unpack(packed: &[u8]) -> Result<Vec<u8>, String> {
    let mut unpacked = Vec::new();
    let done = zstandard::decoder(packed)
        .and_then(|decoder| decoder.take(MOST + 1).read_to_end(&mut unpacked));
    match done {
        Ok(n) if n as u64 > MOST => Err(format!("a message of more than {MOST} bytes")),
        Ok(_) => Ok(unpacked),
        Err(error) => Err(format!("a message cannot be decompressed: {error}")),
    }
}

/// Reads numbers and texts one after the other.
#[derive(Clone, Debug)]
pub(super) struct ByteFields<'a> {
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
    /// Numbers begin at a multiple of their size, which is at most this \[bytes\].
    alignment: usize,
}

impl<'a> ByteFields<'a> {
    /// Little-endian and without gaps.
    pub(super) fn packed(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            at: 0,
            big_endian: false,
            alignment: 1,
        }
    }

    /// Without gaps.
    pub(super) fn ordered(bytes: &'a [u8], big_endian: bool) -> Self {
        Self {
            big_endian,
            ..Self::packed(bytes)
        }
    }

    /// Some bytes in the same order.
    pub(super) fn within(&self, bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            at: 0,
            ..*self
        }
    }

    /// Common data representation: the first four bytes tell which. OMG DDSI-RTPS 2.5,
    /// section 10.2 and table 10.3; OMG DDS-XTYPES 1.3, section 7.4.
    pub(super) fn cdr(bytes: &'a [u8]) -> Option<Self> {
        let (head, bytes) = bytes.split_at_checked(4)?;
        let (big_endian, alignment) = match head {
            [0, 0, ..] => (true, 8),
            [0, 1, ..] => (false, 8),
            [0, 6, ..] => (true, 4),
            [0, 7, ..] => (false, 4),
            _ => return None,
        };
        Some(Self {
            bytes,
            at: 0,
            big_endian,
            alignment,
        })
    }

    pub(super) fn is_big_endian(&self) -> bool {
        self.big_endian
    }

    /// Where the next field begins, before alignment.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    pub(super) fn take(&mut self, n: usize) -> Option<&'a [u8]> {
        let taken = self.bytes.get(self.at..)?.get(..n)?;
        self.at += n;
        Some(taken)
    }

    fn number<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.at = self.at.next_multiple_of(N.min(self.alignment));
        lowest_first(self.take(N)?, self.big_endian)
    }

    pub(super) fn u8(&mut self) -> Option<u8> {
        self.number().map(u8::from_le_bytes)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.number().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.number().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.number().map(u64::from_le_bytes)
    }

    pub(super) fn f64(&mut self) -> Option<f64> {
        self.number().map(f64::from_le_bytes)
    }

    pub(super) fn array<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut array = [0.0; N];
        for value in &mut array {
            *value = self.f64()?;
        }
        Some(array)
    }

    /// Bytes after their number in 32 bits.
    pub(super) fn block(&mut self) -> Option<&'a [u8]> {
        let n = self.u32()?;
        self.take(usize::try_from(n).ok()?)
    }

    /// A text after its length, with or without a zero at its end.
    pub(super) fn text(&mut self) -> Option<Cow<'a, str>> {
        let bytes = self.block()?;
        Some(String::from_utf8_lossy(
            bytes.strip_suffix(&[0]).unwrap_or(bytes),
        ))
    }
}

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Number {
    /// \[bytes\]
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The number that some bytes begin with; those beyond 2⁵³ are rounded.
    pub(super) fn read(self, bytes: &[u8], big_endian: bool) -> Option<f64> {
        Some(match self {
            Self::I8 => f64::from(i8::from_le_bytes(lowest_first(bytes, big_endian)?)),
            Self::U8 => f64::from(u8::from_le_bytes(lowest_first(bytes, big_endian)?)),
            Self::I16 => f64::from(i16::from_le_bytes(lowest_first(bytes, big_endian)?)),
            Self::U16 => f64::from(u16::from_le_bytes(lowest_first(bytes, big_endian)?)),
            Self::I32 => f64::from(i32::from_le_bytes(lowest_first(bytes, big_endian)?)),
            Self::U32 => f64::from(u32::from_le_bytes(lowest_first(bytes, big_endian)?)),
            Self::I64 => i64::from_le_bytes(lowest_first(bytes, big_endian)?) as f64,
            Self::U64 => u64::from_le_bytes(lowest_first(bytes, big_endian)?) as f64,
            Self::F32 => f64::from(f32::from_le_bytes(lowest_first(bytes, big_endian)?)),
            Self::F64 => f64::from_le_bytes(lowest_first(bytes, big_endian)?),
        })
    }
}

/// The first bytes, the lowest of the number first.
fn lowest_first<const N: usize>(bytes: &[u8], big_endian: bool) -> Option<[u8; N]> {
    let mut bytes: [u8; N] = *bytes.first_chunk()?;
    if big_endian {
        bytes.reverse();
    }
    Some(bytes)
}
