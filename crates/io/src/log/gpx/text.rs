//! The bytes that the XML reader gets.

use std::io::{self, BufRead, BufReader, Read, Take};

use memchr::memchr_iter;

use crate::source::Source;

/// Longest tag, comment or text that is read \[bytes\]: the XML reader holds them whole.
const MAX_EVENT: u64 = 1 << 20;

/// A question mark for every byte that is not ASCII: names of places come in any encoding, numbers and
/// times do not.
struct Ascii(Source);

impl Read for Ascii {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let n = self.0.read(into)?;
        for byte in into.iter_mut().take(n).filter(|byte| !byte.is_ascii()) {
            *byte = b'?';
        }
        Ok(n)
    }
}

/// A source with its lines counted, and so many bytes at most to an event.
pub(super) struct Text {
    source: Take<BufReader<Ascii>>,
    lines: u64,
}

impl Text {
    pub(super) fn new(source: Source) -> Self {
        Self {
            source: BufReader::new(Ascii(source)).take(MAX_EVENT),
            lines: 0,
        }
    }

    /// Line that has been read up to, the first is 1.
    pub(super) fn line(&self) -> u64 {
        self.lines + 1
    }

    pub(super) fn next_event(&mut self) {
        self.source.set_limit(MAX_EVENT);
    }
}

impl BufRead for Text {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.source.limit() == 0 {
            let problem = format!("a tag or text of over {MAX_EVENT} bytes");
            return Err(io::Error::new(io::ErrorKind::InvalidData, problem));
        }
        self.source.fill_buf()
    }

    fn consume(&mut self, amount: usize) {
        let held = self.source.fill_buf().unwrap_or_default();
        let passed = held.get(..amount).unwrap_or_default();
        self.lines += memchr_iter(b'\n', passed).count() as u64;
        self.source.consume(amount);
    }
}

impl Read for Text {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let n = self.fill_buf()?.read(into)?;
        self.consume(n);
        Ok(n)
    }
}
