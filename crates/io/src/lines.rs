//! Lines of a byte stream, borrowed from one buffer of fixed size.

use std::io::{self, Read};
use std::ops::Range;

use memchr::memchr;

use crate::source::Source;

/// Longest line that is handed out \[bytes\]; longer ones are passed over without being held.
pub(crate) const MAX_LINE: usize = 64 * 1024;
/// The buffer \[bytes\]: several reads of the source and any line fit.
const BUFFER: usize = 512 * 1024;

pub(crate) struct Lines {
    source: Source,
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    number: u64,
    at_end: bool,
    failure: Option<io::Error>,
}

pub(crate) enum Step {
    /// A line without its newline; read it with [`Lines::bytes`].
    Line(Range<usize>),
    /// A line of more than [`MAX_LINE`] bytes was passed over.
    TooLong,
    /// Nothing more; [`Lines::failure`] tells whether the file broke off.
    End,
}

impl Lines {
    pub(crate) fn new(source: Source) -> Self {
        Self {
            source,
            buffer: vec![0; BUFFER],
            start: 0,
            end: 0,
            number: 0,
            at_end: false,
            failure: None,
        }
    }

    /// Number of the line last stepped to, from 1; 0 before the first step.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// The input error that ended the file before its end, if any.
    pub(crate) fn failure(&self) -> Option<&io::Error> {
        self.failure.as_ref()
    }

    #[inline]
    pub(crate) fn bytes(&self, range: Range<usize>) -> &[u8] {
        let line = self.buffer.get(range).unwrap_or_default();
        line.strip_suffix(b"\r").unwrap_or(line)
    }

    #[inline]
    pub(crate) fn step(&mut self) -> Step {
        let mut searched = self.start;
        loop {
            if let Some(length) = memchr(b'\n', &self.buffer[searched..self.end]) {
                let range = self.start..searched + length;
                self.start = range.end + 1;
                self.number += 1;
                if range.len() > MAX_LINE {
                    return Step::TooLong;
                }
                return Step::Line(range);
            }
            if self.at_end {
                return self.last_line();
            }
            if self.end - self.start > MAX_LINE {
                return self.pass_over();
            }
            let held = self.end - self.start;
            self.refill();
            searched = self.start + held;
        }
    }

    /// The rest after the last newline. After a failure it is cut at an unknown place, so that its
    /// last number may be wrong: dropped.
    fn last_line(&mut self) -> Step {
        let range = self.start..self.end;
        self.start = self.end;
        if range.is_empty() || self.failure.is_some() {
            return Step::End;
        }
        self.number += 1;
        if range.len() > MAX_LINE {
            return Step::TooLong;
        }
        Step::Line(range)
    }

    fn pass_over(&mut self) -> Step {
        self.number += 1;
        loop {
            match memchr(b'\n', &self.buffer[self.start..self.end]) {
                Some(length) => {
                    self.start += length + 1;
                    return Step::TooLong;
                }
                None if self.at_end => {
                    self.start = self.end;
                    return Step::TooLong;
                }
                None => {
                    self.start = self.end;
                    self.refill();
                }
            }
        }
    }

    /// Moves what is left to the front and reads once.
    fn refill(&mut self) {
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        match read(&mut self.source, &mut self.buffer[self.end..]) {
            Ok(0) => self.at_end = true,
            Ok(n) => self.end += n,
            Err(error) => {
                self.at_end = true;
                self.failure = Some(error);
            }
        }
    }
}

/// Reads once, whatever interrupts.
pub(crate) fn read(source: &mut Source, into: &mut [u8]) -> io::Result<usize> {
    loop {
        match source.read(into) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            other => return other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{BufReader, Cursor};

    /// Gives the bytes in pieces of the size, so that lines straddle the reads.
    struct Pieces(Cursor<Vec<u8>>, usize);

    impl Read for Pieces {
        fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
            let n = into.len().min(self.1);
            self.0.read(&mut into[..n])
        }
    }

    fn lines_of(bytes: &[u8], piece: usize) -> Vec<Option<String>> {
        let source = BufReader::with_capacity(1, Pieces(Cursor::new(bytes.to_vec()), piece));
        let mut lines = Lines::new(Box::new(source));
        let mut out = Vec::new();
        loop {
            match lines.step() {
                Step::Line(range) => out.push(Some(
                    String::from_utf8(lines.bytes(range).to_vec()).unwrap(),
                )),
                Step::TooLong => out.push(None),
                Step::End => {
                    assert_eq!(lines.number(), out.len() as u64);
                    return out;
                }
            }
        }
    }

    #[test]
    fn same_lines_whatever_the_size_of_the_reads() {
        let text = b"a,b\r\n\n1,2\nlast";
        for piece in [1, 2, 3, 7, 1000] {
            let lines: Vec<_> = lines_of(text, piece).into_iter().flatten().collect();
            assert_eq!(lines, ["a,b", "", "1,2", "last"]);
        }
        assert!(lines_of(b"", 5).is_empty());
        assert_eq!(lines_of(b"x\n", 5).len(), 1);
    }

    #[test]
    fn long_lines_are_passed_over_and_the_next_one_is_found() {
        for length in [MAX_LINE, MAX_LINE + 1, BUFFER, 3 * BUFFER + 17] {
            let text = [b"first\n".to_vec(), vec![b'7'; length], b"\nnext".to_vec()].concat();
            let lines = lines_of(&text, 50_000);
            assert_eq!(lines.len(), 3);
            assert_eq!(lines[1].is_none(), length > MAX_LINE);
            assert_eq!(lines[2].as_deref(), Some("next"));
        }
    }
}
