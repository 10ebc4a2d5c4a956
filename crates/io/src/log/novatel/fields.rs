//! The fields of a message's body, the same in ASCII and in binary but for how they are written.

use crate::log::bytes::{ByteFields, Number};
use crate::number;

pub(super) enum Fields<'a> {
    Text(std::slice::Split<'a, u8, fn(&u8) -> bool>),
    Binary(ByteFields<'a>),
}

impl<'a> Fields<'a> {
    pub(super) fn new(body: &'a [u8], text: bool) -> Self {
        if text {
            Self::Text(body.split(|&byte| byte == b','))
        } else {
            Self::Binary(ByteFields::packed(body))
        }
    }

    pub(super) fn number(&mut self, kind: Number) -> Option<f64> {
        match self {
            Self::Text(fields) => number::parse(fields.next()?),
            Self::Binary(bytes) => kind.read(bytes.take(kind.size())?, false),
        }
    }

    /// Bits, which ASCII has in hexadecimal digits.
    pub(super) fn hexadecimal(&mut self, kind: Number) -> Option<u32> {
        match self {
            Self::Text(fields) => {
                let digits = std::str::from_utf8(fields.next()?).ok()?;
                u32::from_str_radix(digits, 16).ok()
            }
            Self::Binary(_) => self.number(kind).map(|bits| bits as u32),
        }
    }

    pub(super) fn three(&mut self, kind: Number) -> Option<[f64; 3]> {
        Some([self.number(kind)?, self.number(kind)?, self.number(kind)?])
    }

    /// Passes over a field with so many bytes in binary.
    pub(super) fn skip(&mut self, bytes: usize) -> Option<()> {
        match self {
            Self::Text(fields) => fields.next().map(|_| ()),
            Self::Binary(all) => all.take(bytes).map(|_| ()),
        }
    }

    /// An enumeration: a number in binary, a name in ASCII; that of a name which is not listed is
    /// `None` inside.
    pub(super) fn code(&mut self, names: &[(u32, &str)]) -> Option<Option<u32>> {
        match self {
            Self::Binary(bytes) => bytes.u32().map(Some),
            Self::Text(fields) => {
                let field = fields.next()?;
                let found = names.iter().find(|(_, name)| name.as_bytes() == field);
                Some(found.map(|(code, _)| *code))
            }
        }
    }
}
