//! Text collected into blocks.

use std::io::{self, Write};

/// Text is collected up to this size before it is written \[bytes\].
const SIZE: usize = 64 * 1024;

/// What is to be written next, and where to.
#[derive(Debug)]
pub(super) struct Block<W: Write> {
    out: W,
    /// Append here; then [`Block::spill`].
    pub bytes: Vec<u8>,
}

impl<W: Write> Block<W> {
    pub fn new(out: W) -> Self {
        Self {
            out,
            bytes: Vec::with_capacity(SIZE + 1024),
        }
    }

    /// Writes the block if it is full.
    pub fn spill(&mut self) -> io::Result<()> {
        if self.bytes.len() >= SIZE {
            self.out.write_all(&self.bytes)?;
            self.bytes.clear();
        }
        Ok(())
    }

    /// Writes what is left and gives `out` back.
    pub fn into_inner(mut self) -> io::Result<W> {
        self.out.write_all(&self.bytes)?;
        self.out.flush()?;
        Ok(self.out)
    }
}
