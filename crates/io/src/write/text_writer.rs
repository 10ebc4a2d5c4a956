//! One writer for all formats of text: the format gives the text before, between and after the rows.

use std::io::{self, Write};

use super::ellipses::Ellipses;
use super::frame::PoseFrame;
use super::solution::SolutionRow;
use super::spans::{Piece, Spans};
use super::thinning::Thinning;
use crate::epoch::Epoch;

/// Text is collected up to this size before it is written \[bytes\].
const BLOCK: usize = 64 * 1024;

/// A format of text.
pub(super) struct TextFormat {
    /// Before the rows.
    pub head: String,
    /// What is made of the rows.
    pub body: Body,
    /// After them.
    pub tail: &'static str,
}

/// Appends a row to a text.
type WriteRow = fn(&mut Vec<u8>, &SolutionRow, &Beside) -> io::Result<()>;

/// What belongs to a row beside its numbers.
#[derive(Clone, Copy)]
pub(super) struct Beside {
    /// What the times count from, where that is known.
    pub epoch: Option<Epoch>,
    /// Time of the first row \[s\].
    pub start: f64,
    /// Whether it is without GNSS.
    pub outage: bool,
    /// The frame of the poses, where there is one.
    pub frame: Option<PoseFrame>,
}

/// What is made of rows.
pub(super) enum Body {
    /// Each row by itself, of those that have what the format needs.
    Rows(fn(&SolutionRow) -> bool, WriteRow),
    /// Lines with and without GNSS.
    Lines(fn(&mut Vec<u8>, Piece<'_>, &mut Aside) -> io::Result<()>),
}

/// What belongs to a line beside its points.
#[derive(Default)]
pub(super) struct Aside {
    /// What the times count from, where that is known.
    pub epoch: Option<Epoch>,
    /// Text that comes later, and of how many points.
    pub later: Vec<u8>,
    pub points: usize,
    /// What is drawn of the standard deviations.
    pub ellipses: Ellipses,
}

impl Aside {
    fn pass(&mut self, piece: &Piece<'_>) {
        if let Piece::Begin { row, .. } | Piece::Point(row) = piece {
            self.ellipses.pass(row);
        }
    }
}

/// Writes solution rows as text. They are collected into blocks here; `out` needs no buffer.
pub struct TextWriter<W: Write> {
    out: W,
    block: Vec<u8>,
    body: Body,
    tail: &'static str,
    aside: Aside,
    frame: Option<PoseFrame>,
    start: Option<f64>,
    thinning: Thinning,
    spans: Spans,
}

impl<W: Write> TextWriter<W> {
    /// Starts with the head of a format; `every` \[s\] is the least time from one row to the next.
    pub(super) fn new(out: W, format: TextFormat, epoch: Option<Epoch>, every: f64) -> Self {
        let mut block = Vec::with_capacity(BLOCK + 1024);
        block.extend_from_slice(format.head.as_bytes());
        Self {
            out,
            block,
            body: format.body,
            tail: format.tail,
            aside: Aside {
                epoch,
                ..Aside::default()
            },
            frame: None,
            start: None,
            thinning: Thinning::new(every),
            spans: Spans::new(every),
        }
    }

    /// With the frame of the poses of the drive.
    pub(super) fn in_frame(self, frame: Option<PoseFrame>) -> Self {
        Self { frame, ..self }
    }

    /// Writes one row; `outage` where no fix was used for long.
    ///
    /// # Errors
    /// If `out` does not take it.
    pub fn write(&mut self, row: &SolutionRow, outage: bool) -> io::Result<()> {
        match self.body {
            Body::Rows(usable, write) => {
                if usable(row) && self.thinning.takes(row.time) {
                    let start = *self.start.get_or_insert(row.time);
                    let beside = Beside {
                        epoch: self.aside.epoch,
                        start,
                        outage,
                        frame: self.frame,
                    };
                    write(&mut self.block, row, &beside)?;
                }
            }
            Body::Lines(write) => {
                let (block, aside) = (&mut self.block, &mut self.aside);
                self.spans.push(row, outage, |piece| {
                    aside.pass(&piece);
                    write(block, piece, aside)
                })?;
            }
        }
        match self.block.len() >= BLOCK {
            true => self.hand_over(),
            false => Ok(()),
        }
    }

    /// Writes the rows so far.
    ///
    /// # Errors
    /// If `out` does not take them.
    pub fn flush(&mut self) -> io::Result<()> {
        if !self.block.is_empty() {
            self.hand_over()?;
        }
        self.out.flush()
    }

    fn hand_over(&mut self) -> io::Result<()> {
        self.out.write_all(&self.block)?;
        self.block.clear();
        Ok(())
    }

    /// Writes what is left and gives `out` back.
    ///
    /// # Errors
    /// If `out` does not take it.
    pub fn into_inner(mut self) -> io::Result<W> {
        if let Body::Lines(write) = self.body {
            let (block, aside) = (&mut self.block, &mut self.aside);
            self.spans.finish(|piece| {
                aside.pass(&piece);
                write(block, piece, aside)
            })?;
        }
        self.block.extend_from_slice(self.tail.as_bytes());
        self.out.write_all(&self.block)?;
        self.out.flush()?;
        Ok(self.out)
    }
}
