//! The bytes that the XML reader gets.

use std::io::{self, BufRead, Read};

use memchr::memchr_iter;

use crate::source::Source;

/// Longest tag, comment or text that is read \[bytes\]: the XML reader holds them whole.
const MAX_EVENT: usize = 1 << 20;
const BUFFER: usize = 64 * 1024;

/// A source with its lines counted, so many bytes at most to an event, and a question mark for
/// every byte that is not ASCII: names of places come in any encoding, numbers and times do not.
pub(super) struct Text {
    source: Source,
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    lines: u64,
    of_event: usize,
    begun: bool,
}

impl Text {
    pub(super) fn new(source: Source) -> Self {
        Self {
            source,
            buffer: vec![0; BUFFER],
            start: 0,
            end: 0,
            lines: 0,
            of_event: 0,
            begun: false,
        }
    }

    /// Line that has been read up to, the first is 1.
    pub(super) fn line(&self) -> u64 {
        self.lines + 1
    }

    pub(super) fn next_event(&mut self) {
        self.of_event = 0;
    }

    fn held(&self) -> &[u8] {
        self.buffer.get(self.start..self.end).unwrap_or_default()
    }
}

impl BufRead for Text {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.of_event > MAX_EVENT {
            let problem = format!("a tag or text of over {MAX_EVENT} bytes");
            return Err(io::Error::new(io::ErrorKind::InvalidData, problem));
        }
        if self.start == self.end {
            self.start = 0;
            self.end = 0;
            self.end = self.source.read(&mut self.buffer)?;
            let read = self.buffer.get_mut(..self.end).unwrap_or_default();
            // A byte order mark says nothing that matters here.
            if !std::mem::replace(&mut self.begun, true) && read.starts_with(b"\xef\xbb\xbf") {
                self.start = 3;
            }
            for byte in read {
                if !byte.is_ascii() {
                    *byte = b'?';
                }
            }
        }
        Ok(self.held())
    }

    fn consume(&mut self, amount: usize) {
        let passed = self.held().get(..amount).unwrap_or_default();
        self.lines += memchr_iter(b'\n', passed).count() as u64;
        self.of_event += amount;
        self.start = (self.start + amount).min(self.end);
    }
}

impl Read for Text {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let held = self.fill_buf()?;
        let n = held.len().min(into.len());
        let (from, to) = (
            held.get(..n).unwrap_or_default(),
            into.get_mut(..n).unwrap_or_default(),
        );
        to.copy_from_slice(from);
        self.consume(n);
        Ok(n)
    }
}
