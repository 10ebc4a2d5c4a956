//! Messages of a receiver's stream, found in whatever surrounds them.
//!
//! Where the beginning of a message is damaged the search goes on at its second byte, so that a message in what a false
//! length covered is found.

use std::ops::Range;

use memchr::memchr;

use crate::lines::Window;
use crate::source::Source;

/// What the messages of a format look like; a message has a head `H`.
pub(super) struct Layout<H> {
    /// The bytes that only a message begins with.
    pub(super) sync: [u8; 2],
    /// How many bytes stand before the first that may begin a message.
    pub(super) start: fn(&[u8]) -> usize,
    /// What some bytes from there begin with.
    pub(super) frame: fn(&[u8]) -> Frame<H>,
    /// The buffer \[bytes\]: the longest message and several reads fit.
    pub(super) buffer: usize,
}

/// What some bytes begin with.
pub(super) enum Frame<H> {
    /// A whole message: its bytes before the body, of the body, and after it.
    Message(H, [usize; 3]),
    /// A damaged message.
    Damaged,
    /// Bytes of something else.
    Other,
    /// A message that goes on behind the bytes.
    Longer,
}

pub(super) enum NextFrame<H> {
    /// A message and where its body is: read it with [`Frames::body`].
    Message(H, Range<usize>),
    /// A damaged message, or bytes that only look like the beginning of one.
    Damaged,
    /// The end; [`Frames::failure`] has the error if the file breaks off.
    End,
}

pub(super) struct Frames<H: 'static> {
    window: Window,
    number: u64,
    layout: &'static Layout<H>,
}

impl<H> Frames<H> {
    pub(super) fn new(source: Source, layout: &'static Layout<H>) -> Self {
        Self {
            window: Window::new(source, layout.buffer),
            number: 0,
            layout,
        }
    }

    /// Number of the message last stepped to, damaged ones included, the first is 1.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// The input error that ended the file before its end, if any.
    pub(super) fn failure(&self) -> Option<String> {
        self.window.failure().map(ToString::to_string)
    }

    pub(super) fn body(&self, range: Range<usize>) -> &[u8] {
        self.window.part(range)
    }

    pub(super) fn step(&mut self) -> NextFrame<H> {
        loop {
            self.window.pass((self.layout.start)(self.window.bytes()));
            let bytes = self.window.bytes();
            match (self.layout.frame)(bytes) {
                Frame::Message(head, [before, length, after]) => {
                    self.window.pass(before);
                    let body = self.window.pass(length);
                    self.window.pass(after);
                    self.number += 1;
                    return NextFrame::Message(head, body);
                }
                Frame::Longer if !self.window.at_end() => self.window.refill(),
                Frame::Longer if bytes.is_empty() => return NextFrame::End,
                Frame::Longer if !bytes.starts_with(&self.layout.sync) => {
                    self.window.pass(1);
                }
                Frame::Damaged | Frame::Longer => {
                    self.window.pass(1);
                    self.number += 1;
                    return NextFrame::Damaged;
                }
                Frame::Other => {
                    self.window.pass(1);
                }
            }
        }
    }
}

/// Whether some bytes, the first of a file, hold a whole message that is `wanted`.
pub(super) fn any<H>(bytes: &[u8], layout: &Layout<H>, wanted: impl Fn(&H) -> bool) -> bool {
    let mut from = 0;
    while let Some(rest) = bytes.get(from..).filter(|rest| !rest.is_empty()) {
        let at = (layout.start)(rest);
        from += at;
        match (layout.frame)(rest.get(at..).unwrap_or_default()) {
            Frame::Message(head, _) if wanted(&head) => return true,
            Frame::Message(_, lengths) => from += lengths.iter().sum::<usize>(),
            Frame::Damaged | Frame::Other | Frame::Longer => from += 1,
        }
    }
    false
}

/// How many bytes stand before the first sync, or before what may be its first half at the end.
pub(super) fn to_sync(sync: [u8; 2], bytes: &[u8]) -> usize {
    let mut from = 0;
    while let Some(at) = bytes.get(from..).and_then(|rest| memchr(sync[0], rest)) {
        match bytes.get(from + at + 1) {
            Some(second) if *second != sync[1] => from += at + 1,
            _ => return from + at,
        }
    }
    bytes.len()
}
