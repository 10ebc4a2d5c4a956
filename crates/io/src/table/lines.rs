//! Lines of a byte stream, borrowed from one buffer of fixed size.

use std::io::{self, Read};
use std::ops::Range;

use memchr::memchr;

use crate::source::Source;
use crate::table::rewritten::Rewritten;

/// Longest line that is handed out \[bytes\]; longer ones are passed over without being held.
pub(crate) const MAX_LINE: usize = 64 * 1024;
/// The buffer \[bytes\]: several reads of the source and any line fit.
const BUFFER: usize = 512 * 1024;

/// The part of a stream that is held, at the beginning of what is left.
pub(crate) struct Window {
    source: Source,
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    at_end: bool,
    failure: Option<io::Error>,
}

impl Window {
    /// Holds up to so many bytes.
    pub(crate) fn new(source: Source, size: usize) -> Self {
        Self {
            source,
            buffer: vec![0; size],
            start: 0,
            end: 0,
            at_end: false,
            failure: None,
        }
    }

    /// What is held and left.
    #[inline]
    pub(crate) fn bytes(&self) -> &[u8] {
        self.buffer.get(self.start..self.end).unwrap_or_default()
    }

    /// A part of what is held, or was before the next [`Window::refill`].
    #[inline]
    pub(crate) fn part(&self, range: Range<usize>) -> &[u8] {
        self.buffer.get(range).unwrap_or_default()
    }

    /// Passes over so many bytes; where they are.
    #[inline]
    pub(crate) fn pass(&mut self, length: usize) -> Range<usize> {
        let from = self.start;
        self.start = (from + length).min(self.end);
        from..self.start
    }

    /// Whether the stream has no more than what is held.
    #[inline]
    pub(crate) fn at_end(&self) -> bool {
        self.at_end
    }

    /// The input error that ended the stream before its end, if any.
    pub(crate) fn failure(&self) -> Option<&io::Error> {
        self.failure.as_ref()
    }

    /// Moves what is left to the front and reads once, whatever interrupts.
    pub(crate) fn refill(&mut self) {
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        let free = self.buffer.get_mut(self.end..).unwrap_or_default();
        let read = loop {
            match self.source.read(free) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                other => break other,
            }
        };
        match read {
            Ok(0) => self.at_end = true,
            Ok(n) => self.end += n,
            Err(error) => {
                self.at_end = true;
                self.failure = Some(error);
            }
        }
    }
}

pub(crate) struct Lines {
    window: Window,
    number: u64,
    /// What makes rows of lines of another layout, the last such row, and the header before the first.
    rewritten: Option<Rewritten>,
    row: Vec<u8>,
    header: Option<Vec<u8>>,
}

pub(crate) enum NextLine {
    /// A line without its newline; read it with [`Lines::bytes`].
    Line(Range<usize>),
    /// A line of more than [`MAX_LINE`] bytes was passed over.
    TooLong,
    /// Nothing more; [`Lines::failure`] says whether the file broke off.
    End,
}

impl Lines {
    pub(crate) fn new(source: Source) -> Self {
        Self {
            window: Window::new(source, BUFFER),
            number: 0,
            rewritten: None,
            row: Vec::new(),
            header: None,
        }
    }

    /// Of a table, whose lines may have to be made rows: its beginning shows that, which is read first where it is not given.
    pub(crate) fn of_table(source: Source, beginning: Option<&[u8]>) -> Self {
        let mut lines = Self::new(source);
        let to_read = beginning.map_or(MAX_LINE, |_| 0);
        while lines.window.bytes().len() < to_read && !lines.window.at_end() {
            lines.window.refill();
        }
        let start = beginning.unwrap_or(lines.window.bytes());
        lines.rewritten = Rewritten::detect(start.get(..MAX_LINE).unwrap_or(start));
        lines.header = lines.rewritten.as_ref().and_then(Rewritten::header);
        lines
    }

    /// Number of the line last stepped to, from 1; 0 before the first step.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// The input error that ended the file before its end, if any.
    pub(crate) fn failure(&self) -> Option<&io::Error> {
        self.window.failure()
    }

    #[inline]
    pub(crate) fn bytes(&self, range: Range<usize>) -> &[u8] {
        let line = match self.rewritten {
            Some(_) => &self.row,
            None => self.window.part(range),
        };
        line.strip_suffix(b"\r").unwrap_or(line)
    }

    /// The next line that is not too long.
    pub(crate) fn next_line(&mut self) -> Option<&[u8]> {
        loop {
            match self.step() {
                NextLine::Line(range) => return Some(self.bytes(range)),
                NextLine::TooLong => {}
                NextLine::End => return None,
            }
        }
    }

    #[inline]
    pub(crate) fn step(&mut self) -> NextLine {
        match self.rewritten {
            None => self.next(),
            Some(_) => self.step_to_row(),
        }
    }

    /// The header, which is no line of the text; then the lines as rows.
    #[cold]
    fn step_to_row(&mut self) -> NextLine {
        if let Some(header) = self.header.take() {
            self.row = header;
            return NextLine::Line(0..0);
        }
        let next = self.next();
        if let (NextLine::Line(range), Some(rewritten)) = (&next, &self.rewritten) {
            self.row = rewritten.row(self.window.part(range.clone()));
        }
        next
    }

    #[inline]
    fn next(&mut self) -> NextLine {
        let mut searched = 0;
        loop {
            let window = &mut self.window;
            let from = window.start;
            if let Some(length) = memchr(b'\n', &window.buffer[from + searched..window.end]) {
                let end = from + searched + length;
                window.start = end + 1;
                return self.line(from..end);
            }
            searched = window.end - from;
            if self.window.at_end() {
                return self.last_line();
            }
            if searched > MAX_LINE {
                return self.pass_over();
            }
            self.window.refill();
        }
    }

    #[inline]
    fn line(&mut self, range: Range<usize>) -> NextLine {
        self.number += 1;
        match range.len() > MAX_LINE {
            true => NextLine::TooLong,
            false => NextLine::Line(range),
        }
    }

    /// The rest after the last newline. After a failure it is cut at an unknown place, so that its
    /// last number may be wrong: dropped.
    fn last_line(&mut self) -> NextLine {
        let range = self.window.pass(self.window.bytes().len());
        if range.is_empty() || self.window.failure().is_some() {
            return NextLine::End;
        }
        self.line(range)
    }

    fn pass_over(&mut self) -> NextLine {
        self.number += 1;
        loop {
            let found = memchr(b'\n', self.window.bytes());
            let end = found.map_or(self.window.bytes().len(), |length| length + 1);
            self.window.pass(end);
            if found.is_some() || self.window.at_end() {
                return NextLine::TooLong;
            }
            self.window.refill();
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
                NextLine::Line(range) => out.push(Some(
                    String::from_utf8(lines.bytes(range).to_vec()).unwrap(),
                )),
                NextLine::TooLong => out.push(None),
                NextLine::End => {
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
