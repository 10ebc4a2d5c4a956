//! Messages of a receiver's stream, found in whatever surrounds them.
//!
//! Where the beginning of a message is damaged the search goes on at its second byte, so that a message in what a false
//! length covered is found.

use std::collections::BTreeMap;
use std::ops::Range;

use memchr::memchr;

use crate::entry::{Stream, StreamKind};
use crate::source::Source;
use crate::table::lines::Window;

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
    /// What a damaged message is called.
    pub(super) damaged: &'static str,
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

/// The streams of a log, a key each and in the order of the keys; `described` says of the first head of a stream what it
/// is called, what it holds, and that in words.
pub(super) fn streams<H, K: Ord>(
    source: Source,
    layout: &'static Layout<H>,
    key: impl Fn(&H) -> K,
    described: impl Fn(&H) -> (String, (StreamKind, &'static str)),
) -> Vec<Stream> {
    let mut frames = Frames::new(source, layout);
    let mut counts = BTreeMap::<K, (H, u64)>::new();
    loop {
        match frames.step() {
            NextFrame::Message(head, _) => {
                let (_, count) = counts.entry(key(&head)).or_insert((head, 0));
                *count += 1;
            }
            NextFrame::Damaged => {}
            NextFrame::End => break,
        }
    }
    let stream = |(head, messages)| {
        let (name, (kind, about)) = described(&head);
        Stream {
            name,
            kind,
            about: about.to_owned(),
            messages,
        }
    };
    counts.into_values().map(stream).collect()
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
